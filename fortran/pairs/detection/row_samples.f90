!> Where a row of contact samples its gap: gap = sum c g(place), sum c = 1.
!>
!> Weights, gaps and slips of a slave node stand in one basis. Where the displacements of a face are
!> those of its nodes the row has one sample, the node. Where a mid-side function gives a share `a`
!> of itself to each end of its edge (Popp, Wohlmuth, Gee, Wall 2012) the row of the mid-side node
!> has three: the node by 1/(1 - 2a), the ends by -a/(1 - 2a) each. Weights times rows are then the
!> consistent loads of a uniform pressure.
module lopin_row_samples
   use lopin_kinds, only : wp
   use lopin_contact_points, only : contact_points_type, sample_type, own_sample
   implicit none
   private
   public :: sample_type, find_samples, base_samples, has_samples, has_inner, row_value, basis_of
   public :: one_patch, frame_of

   !> Feet whose normals have a smaller cosine do not lie on one smooth patch of the tool.
   real(wp), parameter :: one_patch = 0.866025403784439_wp

contains

   !> Coefficients of a mid-side node and of each end of its edge.
   pure function basis_of(share) result(c)
      real(wp), intent(in) :: share            !! of the function that each end gets
      real(wp) :: c(2)
      c = [1.0_wp, -share]/(1.0_wp - 2.0_wp*share)
   end function basis_of

   !> The row of a point has more places than its node.
   pure logical function has_samples(points, i)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i

      has_samples = points%share(i) > 0.0_wp .or. has_inner(points, i)
   end function has_samples

   !> Points inside its facets count in the row of a point.
   pure logical function has_inner(points, i)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i

      has_inner = .false.
      if (.not. allocated(points%inner)) return
      if (i <= size(points%inner)) has_inner = allocated(points%inner(i)%sample)
   end function has_inner

   !> The samples of the row of a point.
   pure subroutine find_samples(points, i, x, sample)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) places of the projection [length]
      type(sample_type), allocatable, intent(out) :: sample(:)

      if (has_inner(points, i)) then
         sample = points%inner(i)%sample
      else
         call base_samples(points, i, x, sample)
      end if
   end subroutine find_samples

   !> The samples of a row without points inside facets.
   pure subroutine base_samples(points, i, x, sample)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) places of the projection [length]
      type(sample_type), allocatable, intent(out) :: sample(:)
      real(wp) :: c(2)
      integer :: k, other

      if (.not. points%share(i) > 0.0_wp) then
         sample = [own_sample(points, i)]
         return
      end if
      allocate (sample(3))
      sample(1) = own_sample(points, i)
      c = basis_of(points%share(i))
      sample(1)%c = c(1)
      do k = 1, 2
         other = met_alike(points, i, points%corner(k, i))
         if (other > 0) then
            sample(1 + k) = own_sample(points, other)
            sample(1 + k)%c = c(2)
            cycle
         end if
         ! The end meets another patch or none: the patch of the middle is continued.
         sample(1 + k) = sample(1)
         associate (s => sample(1 + k), d => size(x, 1))
            s%c = c(2)
            s%point = points%corner(k, i)
            s%node(1) = points%node(s%point)
            s%gap = dot_product(s%normal(:d), x(:, s%node(1)) - s%foot(:d))
            s%foot(:d) = x(:, s%node(1)) - s%gap*s%normal(:d)
         end associate
      end do
   end subroutine base_samples

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

   !> What a row makes of values that its points have; points inside facets weigh out to the row
   !> without them.
   pure real(wp) function row_value(points, sample, value) result(total)
      type(contact_points_type), intent(in) :: points
      type(sample_type), intent(in) :: sample(:)
      real(wp), intent(in) :: value(:)         !! (npoint)
      real(wp) :: c(2)

      total = value(sample(1)%point)
      if (.not. points%share(sample(1)%point) > 0.0_wp) return
      c = basis_of(points%share(sample(1)%point))
      total = dot_product([c(1), c(2), c(2)], value(sample(:3)%point))
   end function row_value

   !> Unit normal and tangents, as columns.
   pure subroutine frame_of(normal, ndim, frame)
      real(wp), intent(in) :: normal(3)
      integer, intent(in) :: ndim
      real(wp), intent(out) :: frame(3, 3)
      integer :: least

      frame(:, 1) = normal
      if (ndim == 2) then
         frame(:, 2) = [-normal(2), normal(1), 0.0_wp]
         frame(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
         return
      end if
      least = minloc(abs(normal), 1)
      frame(:, 2) = -normal*normal(least)
      frame(least, 2) = frame(least, 2) + 1.0_wp
      frame(:, 2) = frame(:, 2)/norm2(frame(:, 2))
      frame(:, 3) = [normal(2)*frame(3, 2) - normal(3)*frame(2, 2), normal(3)*frame(1, 2) &
         & - normal(1)*frame(3, 2), &
         & normal(1)*frame(2, 2) - normal(2)*frame(1, 2)]
   end subroutine frame_of
end module lopin_row_samples
