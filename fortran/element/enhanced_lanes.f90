!> Amplitudes of the internal modes of a batch of enhanced bricks: module solid_enhanced, in the
!> same operations, with the element as the fastest index. Compiled three times, see module
!> batch_kernel.
!>
!> A lane whose amplitudes are found keeps them while others go on: what is computed again at the
!> same amplitudes is the same. A batch in which an element turns or whose step must be shortened is
!> left to module solid_enhanced.
module lopin_enhanced_lanes
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, lanes, points
   use lopin_enhanced_modes, only : solve_small, most_modes
   use lopin_enhanced_lane_motion, only : modes_lanes_type, enhanced_change, mode_rows
   use lopin_hyperelastic, only : solid_law_type
   use lopin_batch_law, only : law_lanes_type, respond_in_lanes, frame_lanes_type, find_frames
   use lopin_batch_motion, only : trial_change, volume_change
   use lopin_batch_stiffness, only : velocity_form_in_lanes
   implicit none
   private
   public :: relaxed_lanes_type, relax_lanes, whole_pivot, products, tensor_of

   !> Answer of the material at a point.
   type :: answer_lanes_type
      real(wp) :: inverse(lanes, 3, 3)           !! of the enhanced F
      real(wp) :: stress(lanes, 6)               !! Kirchhoff
      real(wp) :: a(lanes, 9, 9)                 !! form on velocity gradients, times volume
      real(wp) :: energy(lanes)
   end type answer_lanes_type

   !> Amplitudes on their way to where the energy is stationary.
   type :: relaxed_lanes_type
      real(wp) :: alpha(lanes, most_modes)
      type(answer_lanes_type) :: answer(points)          !! at alpha
      real(wp) :: force(lanes, most_modes)               !! on the amplitudes there
      real(wp) :: pivot(lanes, most_modes, most_modes)   !! its slopes: the part below the diagonal
      real(wp) :: rest(lanes, most_modes)                !! last, small step: alpha - rest balances
   end type relaxed_lanes_type

contains

   !> Amplitudes that make the energy stationary, but for a last step.
   pure subroutine relax_lanes(element, law, batch, motion, relaxed, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(modes_lanes_type), intent(in) :: motion
      type(relaxed_lanes_type), intent(inout) :: relaxed
      logical, intent(out) :: done               !! without a step that had to be shortened
      real(wp) :: step(lanes, element%nmode), along(lanes), size_of
      logical :: active(lanes)
      integer, parameter :: most_sweeps = 60
      real(wp), parameter :: small = 1.0e-6_wp   ! its square is left out
      integer :: l, m, sweep

      m = element%nmode
      relaxed%alpha(:, :m) = batch%amplitude(:, :m)
      active = .true.
      call balance(element, law, batch, motion, relaxed, done)
      do sweep = 1, most_sweeps
         if (.not. done) return
         do l = 1, lanes
            if (.not. active(l)) cycle
            call find_step(element, relaxed, l, step(l, :), done)
            if (.not. done) return
            size_of = max(maxval(abs(motion%h(l, :, :, :element%ngauss))), &
               & strained(element, batch, l))
            active(l) = maxval(abs(step(l, :))) > small*maxval(abs(relaxed%alpha(l, :m) &
               & - step(l, :))) + 1.0e-14_wp*size_of
            if (.not. active(l)) relaxed%rest(l, :m) = step(l, :)
         end do
         if (.not. any(active)) return
         do l = 1, lanes
            along(l) = dot_product(relaxed%force(l, :m), step(l, :))
            if (active(l)) relaxed%alpha(l, :m) = relaxed%alpha(l, :m) - step(l, :)
         end do
         call balance(element, law, batch, motion, relaxed, done)
         if (.not. done) return
         do l = 1, lanes
            if (active(l)) done = done .and. (along(l) <= 0.0_wp .or. dot_product(relaxed%force(l, &
               & :m), step(l, :)) >= -0.2_wp*along(l))
         end do
      end do
      done = .false.
   end subroutine relax_lanes

   !> The Newton step of a lane.
   pure subroutine find_step(element, relaxed, l, step, regular)
      type(element_type), intent(in) :: element
      type(relaxed_lanes_type), intent(in) :: relaxed
      integer, intent(in) :: l                   !! the lane
      real(wp), intent(out) :: step(element%nmode)
      logical, intent(out) :: regular
      real(wp) :: pivot(element%nmode, element%nmode), right(element%nmode, 1)

      pivot = whole_pivot(element, relaxed, l)
      right(:, 1) = relaxed%force(l, :element%nmode)
      call solve_small(pivot, right, regular)
      step = right(:, 1)
   end subroutine find_step

   !> The stiffness of the amplitudes of a lane from its part below the diagonal.
   pure function whole_pivot(element, relaxed, l) result(pivot)
      type(element_type), intent(in) :: element
      type(relaxed_lanes_type), intent(in) :: relaxed
      integer, intent(in) :: l                   !! the lane
      real(wp) :: pivot(element%nmode, element%nmode)
      integer :: m

      do m = 1, element%nmode
         pivot(m:, m) = relaxed%pivot(l, m:element%nmode, m)
         pivot(m, m:) = relaxed%pivot(l, m:element%nmode, m)
      end do
   end function whole_pivot

   !> Size of the strains that the points of a lane remember.
   pure real(wp) function strained(element, batch, l)
      type(element_type), intent(in) :: element
      type(batch_type), intent(in) :: batch
      integer, intent(in) :: l                   !! the lane

      strained = max(maxval(abs(batch%metric(l, :, :element%ngauss))), &
         & maxval(abs(batch%offset(l, :element%ngauss))))
   end function strained

   !> Answers of the points, forces on the amplitudes and their slopes.
   pure subroutine balance(element, law, batch, motion, relaxed, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(modes_lanes_type), intent(in) :: motion
      type(relaxed_lanes_type), intent(inout) :: relaxed
      logical, intent(out) :: done               !! no element is turned inside out
      real(wp) :: own(lanes, element%ngauss), change(lanes, 3, 3, element%ngauss)
      real(wp) :: l(lanes, 9, element%nmode), al(lanes, 9, element%nmode), s(lanes, 3, 3)
      type(frame_lanes_type) :: frame(element%ngauss)
      type(law_lanes_type) :: answer
      integer :: j, k, m, n

      call deform_points(element, batch, motion, relaxed, own, change, done)
      if (.not. done) return
      call find_frames(element%ngauss, change, frame)
      n = element%nmode
      relaxed%pivot(:, :n, :n) = 0.0_wp
      relaxed%force(:, :n) = 0.0_wp
      do k = 1, element%ngauss
         call respond_in_lanes(law, frame(k), own(:, k), batch%strain(:, k), batch%offset(:, k), &
            & batch%dt, .true., answer)
         relaxed%answer(k)%stress = answer%stress
         relaxed%answer(k)%energy = motion%weight(:, k)*answer%energy
         call velocity_form_in_lanes(answer%stress, answer%tangent, spread(0.0_wp, 1, lanes), &
            & motion%weight(:, k), relaxed%answer(k)%a)
         call mode_rows(element, motion, k, relaxed%answer(k)%inverse, l)
         s = tensor_of(motion%weight(:, k), answer%stress)
         call products(element, relaxed%answer(k)%a, l, al)
         call add_products(element, al, l, relaxed%pivot)
         do m = 1, n
            do j = 1, 9
               relaxed%force(:, m) = relaxed%force(:, m) + l(:, j, m)*s(:, 1 + mod(j - 1, 3), &
                  & 1 + (j - 1)/3)
            end do
         end do
      end do
   end subroutine balance

   !> Enhanced deformation of the points at the amplitudes, and the inverse of its gradient.
   pure subroutine deform_points(element, batch, motion, relaxed, own, change, done)
      type(element_type), intent(in) :: element
      type(batch_type), intent(in) :: batch
      type(modes_lanes_type), intent(in) :: motion
      type(relaxed_lanes_type), intent(inout) :: relaxed
      real(wp), intent(out) :: own(lanes, element%ngauss)            !! J - 1
      real(wp), intent(out) :: change(lanes, 3, 3, element%ngauss)   !! b - 1 if nothing flowed
      logical, intent(out) :: done
      real(wp), dimension(lanes, 3, 3) :: h, f
      integer :: i, j, k, p, q

      do k = 1, element%ngauss
         call enhanced_change(element, motion, k, relaxed%alpha, h)
         call volume_change(h, own(:, k))
         done = all(1.0_wp + own(:, k) > 0.0_wp)
         if (.not. done) return
         f = h
         do i = 1, 3
            f(:, i, i) = f(:, i, i) + 1.0_wp
         end do
         associate (inverse => relaxed%answer(k)%inverse)
            do i = 1, 3
               p = 1 + mod(i, 3)
               q = 1 + mod(i + 1, 3)
               inverse(:, i, 1) = f(:, 2, p)*f(:, 3, q) - f(:, 3, p)*f(:, 2, q)
               inverse(:, i, 2) = f(:, 3, p)*f(:, 1, q) - f(:, 1, p)*f(:, 3, q)
               inverse(:, i, 3) = f(:, 1, p)*f(:, 2, q) - f(:, 2, p)*f(:, 1, q)
               do j = 1, 3
                  inverse(:, i, j) = inverse(:, i, j)/(1.0_wp + own(:, k))
               end do
            end do
         end associate
         call trial_change(h, batch%metric(:, :, k), change(:, :, :, k))
      end do
   end subroutine deform_points

   !> Quadratic form times the gradients of the amplitudes.
   pure subroutine products(element, a, l, al)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: a(lanes, 9, 9)                 !! [stress length^3]
      real(wp), intent(in) :: l(lanes, 9, element%nmode)     !! velocity gradients [-]
      real(wp), intent(out) :: al(lanes, 9, element%nmode)   !! [stress length^3]
      real(wp) :: c(lanes)
      integer :: i, j, m

      do m = 1, element%nmode
         do j = 1, 9
            c = 0.0_wp
            do i = 1, 9
               c = c + l(:, i, m)*a(:, i, j)
            end do
            al(:, j, m) = c
         end do
      end do
   end subroutine products

   !> Stiffness of the amplitudes, its part below the diagonal.
   pure subroutine add_products(element, al, l, own)
      type(element_type), intent(in) :: element
      real(wp), dimension(lanes, 9, element%nmode), intent(in) :: al, l
      real(wp), intent(inout) :: own(lanes, most_modes, most_modes)
      real(wp) :: c(lanes)
      integer :: i, j, m

      do m = 1, element%nmode
         do i = m, element%nmode
            c = own(:, i, m)
            do j = 1, 9
               c = c + al(:, j, i)*l(:, j, m)
            end do
            own(:, i, m) = c
         end do
      end do
   end subroutine add_products

   !> The tensor of stresses in the order xx yy zz xy xz yz, times a volume.
   pure function tensor_of(weight, stress) result(s)
      real(wp), intent(in) :: weight(lanes)                  !! [length^3]
      real(wp), intent(in) :: stress(lanes, 6)               !! [stress]
      real(wp) :: s(lanes, 3, 3)
      integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
      integer :: r

      do r = 1, 6
         s(:, row(r), column(r)) = weight*stress(:, r)
         s(:, column(r), row(r)) = s(:, row(r), column(r))
      end do
   end function tensor_of
end module lopin_enhanced_lanes
