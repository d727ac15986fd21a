!> Where a row of contact samples its gap: gap = sum c g(place), sum c = 1.
!>
!> Weights, gaps and slips of a slave node stand in one basis. Where the displacements of a face are
!> those of its nodes the row has one sample, the node. Where a mid-side function gives a share `a`
!> of itself to each end of its edge (Popp, Wohlmuth, Gee, Wall 2012) the row of the mid-side node
!> has three: the node by 1/(1 - 2a), the ends by -a/(1 - 2a) each. Weights times rows are then the
!> consistent loads of a uniform pressure.
module lopin_row_samples
   use lopin_kinds, only : wp
   use lopin_contact_points, only : contact_points_type
   implicit none
   private
   public :: sample_type, most_samples, find_samples, row_value, basis_of, one_patch

   integer, parameter :: most_samples = 3
   !> Feet whose normals have a smaller cosine do not lie on one smooth patch of the tool.
   real(wp), parameter :: one_patch = 0.866025403784439_wp

   !> One place of a row.
   type :: sample_type
      real(wp) :: c = 1.0_wp              !! its part of the row
      integer :: point = 0                !! the contact point there
      integer :: node = 0
      real(wp) :: normal(3) = 0.0_wp      !! out of the master, as the gap grows
      real(wp) :: foot(3) = 0.0_wp        !! [length]
      real(wp) :: gap = 0.0_wp            !! geometric [length]
   end type sample_type

contains

   !> Coefficients of a mid-side node and of each end of its edge.
   pure function basis_of(share) result(c)
      real(wp), intent(in) :: share            !! of the function that each end gets
      real(wp) :: c(2)
      c = [1.0_wp, -share]/(1.0_wp - 2.0_wp*share)
   end function basis_of

   !> The samples of the row of a point.
   pure subroutine find_samples(points, i, x, sample, n)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) places of the projection [length]
      type(sample_type), intent(out) :: sample(most_samples)
      integer, intent(out) :: n
      real(wp) :: c(2)
      integer :: k, other

      n = 1
      sample(1) = sample_type(1.0_wp, i, points%node(i), points%normal(:, i), points%foot(:, i), &
         & points%gap(i))
      if (.not. points%share(i) > 0.0_wp) return
      n = 3
      c = basis_of(points%share(i))
      sample(1)%c = c(1)
      do k = 1, 2
         other = met_alike(points, i, points%corner(k, i))
         if (other > 0) then
            sample(1 + k) = sample_type(c(2), other, points%node(other), points%normal(:, other), &
               & points%foot(:, other), points%gap(other))
            cycle
         end if
         ! The end meets another patch or none: the patch of the middle is continued.
         sample(1 + k) = sample(1)
         associate (s => sample(1 + k), d => size(x, 1))
            s%c = c(2)
            s%point = points%corner(k, i)
            s%node = points%node(s%point)
            s%gap = dot_product(s%normal(:d), x(:, s%node) - s%foot(:d))
            s%foot(:d) = x(:, s%node) - s%gap*s%normal(:d)
         end associate
      end do
   end subroutine find_samples

   !> The point of a node that meets the same patch as point i, from the node's first; 0: none.
   pure integer function met_alike(points, i, first) result(other)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i, first
      real(wp) :: cosine, best
      integer :: k

      other = 0
      best = one_patch
      k = first
      do while (k < points%first(points%pair(i) + 1))
         if (points%node(k) /= points%node(first)) exit
         cosine = dot_product(points%normal(:, k), points%normal(:, i))
         if (points%facet(k) > 0 .and. cosine >= best) then
            other = k
            best = cosine
         end if
         k = k + 1
      end do
   end function met_alike

   !> What a row makes of values that its points have.
   pure real(wp) function row_value(sample, value) result(total)
      type(sample_type), intent(in) :: sample(:)
      real(wp), intent(in) :: value(:)         !! (npoint)

      total = dot_product(sample%c, value(sample%point))
      if (size(sample) == 1) total = value(sample(1)%point)
   end function row_value
end module lopin_row_samples
