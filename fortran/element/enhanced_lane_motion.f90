!> What nodes and internal modes do at the points of a batch of enhanced bricks: modules
!> enhanced_modes and enhanced_motion, in the same operations, with the element as the fastest
!> index. Compiled three times, see module batch_kernel.
module lopin_enhanced_lane_motion
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, lanes, most, points
   use lopin_enhanced_modes, only : most_modes, edge_of
   use lopin_batch_motion, only : cross, jacobian, gradients, displacement_gradient
   implicit none
   private
   public :: modes_lanes_type, move_lanes, enhanced_change, mode_gradient, mode_rows

   !> What the nodes do, and the modes.
   type :: modes_lanes_type
      real(wp) :: mode(lanes, 3, 3, most_modes, points)   !! [-]
      real(wp) :: carried(lanes, 3, 3, most_modes, points)   !! F0 times the modes
      real(wp) :: g(lanes, 3, most, points)      !! reference slopes [1/length]
      real(wp) :: at_centre(lanes, 3, most)      !! the same at the centre [1/length]
      real(wp) :: weight(lanes, points)          !! reference volume
      real(wp) :: h(lanes, 3, 3, points)         !! F - 1
      real(wp) :: centre(lanes, 3, 3)            !! F0
   end type modes_lanes_type

contains

   !> Displacement gradients of the nodes, and the modes.
   pure subroutine move_lanes(element, batch, motion, done)
      type(element_type), intent(in) :: element
      type(batch_type), intent(in) :: batch
      type(modes_lanes_type), intent(inout) :: motion
      logical, intent(out) :: done               !! no element is inside out in its reference shape
      real(wp) :: inverse(lanes, 3, 3), centre(lanes), total(lanes)
      integer :: i, k

      call set_centre(element, batch, motion, inverse, centre)
      done = all(centre > 0.0_wp)
      if (.not. done) return
      do k = 1, element%ngauss
         call gradients(element%nnode, batch%x, element%dn(:, :, k), motion%g(:, :, :, k), total)
         done = all(total > 0.0_wp)
         if (.not. done) return
         call fill(element, inverse, centre/total, element%xi(:, k), motion%mode(:, :, :, :, k))
         motion%weight(:, k) = element%weight(k)*total
         call displacement_gradient(element%nnode, batch%u, motion%g(:, :, :, k), &
            & motion%h(:, :, :, k))
      end do
      call displacement_gradient(element%nnode, batch%u, motion%at_centre, motion%centre)
      do i = 1, 3
         motion%centre(:, i, i) = motion%centre(:, i, i) + 1.0_wp
      end do
      call carry(element, motion)
   end subroutine move_lanes

   !> Slopes at the centre, and what its Jacobian makes of the modes.
   pure subroutine set_centre(element, batch, motion, inverse, centre)
      type(element_type), intent(in) :: element
      type(batch_type), intent(in) :: batch
      type(modes_lanes_type), intent(inout) :: motion
      real(wp), intent(out) :: inverse(lanes, 3, 3)   !! times the edge of a cube as large [-]
      real(wp), intent(out) :: centre(lanes)          !! det J; nothing else is set unless > 0
      real(wp) :: size_of(lanes)
      integer :: a, i, k, l

      call invert(element%nnode, batch%x, element%dn0, inverse, centre)
      if (.not. all(centre > 0.0_wp)) return
      do a = 1, element%nnode
         do i = 1, 3
            motion%at_centre(:, i, a) = inverse(:, 1, i)*element%dn0(1, a) &
               & + inverse(:, 2, i)*element%dn0(2, a) + inverse(:, 3, i)*element%dn0(3, a)
         end do
      end do
      do l = 1, lanes
         size_of(l) = edge_of(centre(l), element%ndim)
      end do
      do k = 1, 3
         do i = 1, 3
            inverse(:, i, k) = size_of*inverse(:, i, k)
         end do
      end do
   end subroutine set_centre

   !> Inverse and determinant of the Jacobian.
   pure subroutine invert(nnode, x, dn, inverse, determinant)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: x(lanes, 3, nnode), dn(3, nnode)
      real(wp), intent(out) :: inverse(lanes, 3, 3), determinant(lanes)
      real(wp) :: j(lanes, 3, 3)
      integer :: i, k

      call jacobian(nnode, x, dn, j)
      call cross(j(:, :, 2), j(:, :, 3), inverse(:, 1, :))
      call cross(j(:, :, 3), j(:, :, 1), inverse(:, 2, :))
      call cross(j(:, :, 1), j(:, :, 2), inverse(:, 3, :))
      determinant = inverse(:, 1, 1)*j(:, 1, 1) + inverse(:, 1, 2)*j(:, 2, 1) &
         & + inverse(:, 1, 3)*j(:, 3, 1)
      if (.not. all(determinant > 0.0_wp)) return
      do k = 1, 3
         do i = 1, 3
            inverse(:, i, k) = inverse(:, i, k)/determinant
         end do
      end do
   end subroutine invert

   pure subroutine fill(element, inverse, scale, xi, mode)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: inverse(lanes, 3, 3), scale(lanes), xi(3)
      real(wp), intent(inout) :: mode(lanes, 3, 3, most_modes)
      real(wp), parameter :: third = 1.0_wp/3.0_wp
      integer :: i, j, m, p

      m = 0
      do j = 1, 3
         do i = 1, 3
            m = m + 1
            call put(scale*xi(i), inverse(:, i, :), inverse(:, j, :), mode(:, :, :, m))
         end do
      end do
      do i = 1, 3
         if (element%layers(i) /= 1) cycle
         m = m + 2
         call put(scale*(xi(i)**2 - third), inverse(:, i, :), inverse(:, i, :), &
            & mode(:, :, :, m - 1))
         call put(scale*xi(i)**3, inverse(:, i, :), inverse(:, i, :), mode(:, :, :, m))
      end do
      do j = 2, 3
         do i = 1, j - 1
            m = m + 1
            mode(:, :, :, m) = 0.0_wp
            do p = 1, 3
               mode(:, p, p, m) = scale*xi(i)*xi(j)
            end do
         end do
      end do
   end subroutine fill

   pure subroutine put(scale, first, second, mode)
      real(wp), intent(in) :: scale(lanes), first(lanes, 3), second(lanes, 3)
      real(wp), intent(out) :: mode(lanes, 3, 3)
      integer :: p, q

      do q = 1, 3
         do p = 1, 3
            mode(:, p, q) = scale*first(:, p)*second(:, q)
         end do
      end do
   end subroutine put

   !> F0 times the modes.
   pure subroutine carry(element, motion)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(inout) :: motion
      integer :: d, i, k, m

      do k = 1, element%ngauss
         do m = 1, element%nmode
            do d = 1, 3
               do i = 1, 3
                  motion%carried(:, i, d, m, k) = &
                     & motion%centre(:, i, 1)*motion%mode(:, 1, d, m, k) &
                     & + motion%centre(:, i, 2)*motion%mode(:, 2, d, m, k) &
                     & + motion%centre(:, i, 3)*motion%mode(:, 3, d, m, k)
               end do
            end do
         end do
      end do
   end subroutine carry

   !> Enhanced F - 1 of a point.
   pure subroutine enhanced_change(element, motion, k, alpha, h)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(lanes, most_modes)       !! amplitudes [-]
      real(wp), intent(out) :: h(lanes, 3, 3)                !! [-]
      real(wp) :: e(lanes, 3, 3)
      integer :: i, j

      call mode_gradient(element, motion, k, alpha, e)
      do j = 1, 3
         do i = 1, 3
            h(:, i, j) = motion%h(:, i, j, k) + (motion%centre(:, i, 1)*e(:, 1, j) &
               & + motion%centre(:, i, 2)*e(:, 2, j) + motion%centre(:, i, 3)*e(:, 3, j))
         end do
      end do
   end subroutine enhanced_change

   !> E(alpha) of a point, in the reference shape.
   pure subroutine mode_gradient(element, motion, k, alpha, e)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: alpha(lanes, most_modes)       !! amplitudes [-]
      real(wp), intent(out) :: e(lanes, 3, 3)                !! [-]
      integer :: i, j, m

      do j = 1, 3
         do i = 1, 3
            e(:, i, j) = 0.0_wp
            do m = 1, element%nmode
               e(:, i, j) = e(:, i, j) + alpha(:, m)*motion%mode(:, i, j, m, k)
            end do
         end do
      end do
   end subroutine mode_gradient

   !> Velocity gradients of the amplitudes, listed as in module velocity_form.
   pure subroutine mode_rows(element, motion, k, inverse, l)
      type(element_type), intent(in) :: element
      type(modes_lanes_type), intent(in) :: motion
      integer, intent(in) :: k
      real(wp), intent(in) :: inverse(lanes, 3, 3)           !! of the enhanced F
      real(wp), intent(out) :: l(lanes, 9, element%nmode)    !! [-]
      integer :: i, j, m

      do m = 1, element%nmode
         do j = 1, 3
            do i = 1, 3
               l(:, i + 3*j - 3, m) = motion%carried(:, i, 1, m, k)*inverse(:, 1, j) &
                  & + motion%carried(:, i, 2, m, k)*inverse(:, 2, j) &
                  & + motion%carried(:, i, 3, m, k)*inverse(:, 3, j)
            end do
         end do
      end do
   end subroutine mode_rows
end module lopin_enhanced_lane_motion
