!> The places that the row of a contact point samples on a tool, and their feet, by dual numbers.
module lopin_tool_samples
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable, constant, dual_dot, exp, log, operator(+), &
      & operator(-), operator(*), operator(/), assignment(=)
   use lopin_contact_foot, only : tool_foot, turned, turned_back
   use lopin_closest_feature, only : sample_foot_type, inner_foot_type, inner_row_type
   use lopin_contact_inputs, only : inputs_type
   implicit none
   private
   public :: place_type, find_foot, mean_place, place_inner, place_planes, soft_least

   !> A place that a row samples.
   type :: place_type
      real(wp) :: c = 0.0_wp                   !! its part of the row
      type(dual_type) :: x(3), normal(3), gap
      integer :: input(3) = 0                  !! of its node
   end type place_type

contains

   !> The foot of one more place of a row.
   pure subroutine find_foot(self, sample, own, rotation, reference, origin)
      type(place_type), intent(inout) :: self
      type(sample_foot_type), intent(in) :: sample
      type(place_type), intent(in) :: own            !! the point's
      type(dual_type), intent(in) :: rotation(3, 3), reference(3)
      real(wp), intent(in) :: origin(3)              !! reference of the tool at rest [length]
      type(dual_type) :: y(3), normal(3)

      if (sample%continued) then
         self%normal = own%normal
         self%gap = own%gap + dual_dot(own%normal, self%x - own%x)
         return
      end if
      y = self%x - reference
      y = constant(origin) + turned_back(rotation, y)
      call tool_foot(sample%foot, y, self%gap, normal)
      self%normal = turned(rotation, normal)
   end subroutine find_foot

   !> The nodes around a point, and the gap of its points on planes: each node has its part of their
   !> normals, and no gap of its own.
   pure subroutine place_planes(self, gap, row, inputs, x, rotation, reference, from)
      type(place_type), intent(out) :: self(:)
      type(dual_type), intent(out) :: gap
      type(inner_row_type), intent(in) :: row
      type(inputs_type), intent(in) :: inputs
      real(wp), intent(in) :: x(:, :)                !! (ndim, nnode) [length]
      type(dual_type), intent(in) :: rotation(3, 3), reference(3)
      integer, intent(in) :: from                    !! slopes along inputs from + 1 and on
      integer :: j, k

      gap = 0.0_wp
      do j = 1, size(self)
         self(j)%input = inputs%near(:, j)
         do k = 1, size(x, 1)
            self(j)%x(k) = variable(x(k, row%node(j)), inputs%near(k, j) - from)
         end do
         self(j)%normal = rotation(:, 1)*row%normal(1, j) + rotation(:, 2)*row%normal(2, j) &
            & + rotation(:, 3)*row%normal(3, j)
         gap = gap + dual_dot(self(j)%normal, self(j)%x - reference)
      end do
      gap%v = row%gap
   end subroutine place_planes

   !> A place inside a facet from its nodes, and its foot.
   pure subroutine place_inner(self, foot, around, rotation, reference, origin)
      type(place_type), intent(inout) :: self
      type(inner_foot_type), intent(in) :: foot
      type(place_type), intent(in) :: around(:)      !! the nodes of the row
      type(dual_type), intent(in) :: rotation(3, 3), reference(3)
      real(wp), intent(in) :: origin(3)              !! reference of the tool at rest [length]
      type(dual_type) :: y(3), normal(3)
      integer :: j

      self%c = foot%c
      self%x = 0.0_wp
      do j = 1, foot%nnode
         self%x = self%x + foot%shape(j)*around(foot%at(j))%x
      end do
      y = self%x - reference
      y = constant(origin) + turned_back(rotation, y)
      call tool_foot(foot%foot, y, self%gap, normal)
      self%normal = turned(rotation, normal)
   end subroutine place_inner

   !> The soft least gap of points inside facets, and the shares by which they bear.
   pure subroutine soft_least(inner, row, gap, share)
      type(place_type), intent(in) :: inner(:)
      type(inner_row_type), intent(in) :: row
      type(dual_type), intent(out) :: gap            !! their part of the row's
      type(dual_type), intent(out) :: share(:)
      type(dual_type) :: total
      real(wp) :: least
      integer :: m

      least = minval([(inner(m)%gap%v, m=1, size(inner))])
      total = constant(0.0_wp)
      do m = 1, size(inner)
         share(m) = (inner(m)%c/row%c)*exp((inner(m)%gap - least)*(-1.0_wp/row%soft))
         total = total + share(m)
      end do
      do m = 1, size(inner)
         share(m) = row%c*share(m)/total
      end do
      gap = row%c*(least - row%soft*log(total))
   end subroutine soft_least

   !> Gap of a row from those of its places, and the way of its mean place added to its point's.
   pure subroutine mean_place(there, gap, way)
      type(place_type), intent(in) :: there(:)       !! the point's first
      type(dual_type), intent(out) :: gap
      type(dual_type), intent(inout) :: way(3)
      integer :: m

      gap = there(1)%c*there(1)%gap
      do m = 2, size(there)
         gap = gap + there(m)%c*there(m)%gap
         way = way + there(m)%c*(there(m)%x - there(1)%x)
      end do
   end subroutine mean_place
end module lopin_tool_samples
