!> The places that the row of a contact point samples on a tool, and their feet, by dual numbers.
module lopin_finite_places
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, dual_width, constant, dual_dot, operator(+), operator(-), &
      & operator(*), assignment(=)
   use lopin_tool, only : foot_type
   use lopin_contact_foot, only : tool_foot, turned, turned_back
   use lopin_finite_opposite, only : sample_foot_type, inner_foot_type
   use lopin_finite_inputs, only : inputs_type, inputs_of
   implicit none
   private
   public :: place_type, find_foot, mean_place, place_inner, find_inner_foot

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

   !> Places inside facets from the nodes of these.
   pure subroutine place_inner(self, opposite, inputs, x, from)
      type(place_type), intent(inout) :: self(:)
      type(inner_foot_type), intent(in) :: opposite(:)
      type(inputs_type), intent(in) :: inputs
      real(wp), intent(in) :: x(:, :)                !! (ndim, nnode) [length]
      integer, intent(in) :: from                    !! slopes along inputs from + 1 and on
      integer :: m, j, k, input(3)

      do m = 1, size(opposite)
         self(m)%c = opposite(m)%c
         self(m)%x = 0.0_wp
         do j = 1, opposite(m)%nnode
            input = inputs_of(inputs, opposite(m)%node(j))
            do k = 1, size(x, 1)
               associate (place => self(m)%x(k), at => input(k) - from)
                  place%v = place%v + opposite(m)%shape(j)*x(k, opposite(m)%node(j))
                  if (at >= 1 .and. at <= dual_width) place%d(at) = place%d(at) &
                     & + opposite(m)%shape(j)
               end associate
            end do
         end do
      end do
   end subroutine place_inner

   pure subroutine find_inner_foot(self, foot, rotation, reference, origin)
      type(place_type), intent(inout) :: self
      type(foot_type), intent(in) :: foot
      type(dual_type), intent(in) :: rotation(3, 3), reference(3)
      real(wp), intent(in) :: origin(3)              !! reference of the tool at rest [length]
      type(dual_type) :: y(3), normal(3)

      y = self%x - reference
      y = constant(origin) + turned_back(rotation, y)
      call tool_foot(foot, y, self%gap, normal)
      self%normal = turned(rotation, normal)
   end subroutine find_inner_foot

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
end module lopin_finite_places
