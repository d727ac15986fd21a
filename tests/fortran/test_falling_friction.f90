!> Coefficients of friction that change with the speed of slip, read from the trial itself.
program test_falling_friction
   use lopin_kinds, only : wp
   use lopin_friction, only : friction_type, condition_type, law_names, regularization_names, &
      & by_rate
   use lopin_friction_return, only : return_to_disc, regularised_traction
   use check, only : test, close_to, finish
   use friction_cases, only : law_with, scene, slope_of
   implicit none

   call speed_of_the_trial()
   call finish()

contains

   !> Coefficients that fall or rise with the speed of the trial itself: the law's own equation, and
   !> slopes, for every law; those that read no speed are as ever.
   subroutine speed_of_the_trial()
      real(wp), parameter :: trial(4) = [5.0_wp, 33.0_wp, 62.0_wp, 400.0_wp]
      real(wp), parameter :: pressure(3) = [30.0_wp, 100.0_wp, 4.0e5_wp]
      real(wp), parameter :: static(2) = [0.6_wp, 0.1_wp], cap(2) = [huge(1.0_wp), 35.0_wp]
      type(friction_type) :: law
      type(condition_type) :: at
      integer :: i, j, k, l, m

      at = scene()
      at%of_trial = .true.
      do i = 1, size(law_names)
         call test('slopes by the speed of the trial of '//trim(law_names(i)))
         do j = 1, size(trial)
            do k = 1, size(pressure)
               do l = 1, size(static)
                  do m = 1, size(cap)
                     law = law_with(i)
                     law%mu_static = static(l)
                     law%decay = 0.03_wp
                     law%tau_max = cap(m)
                     call check_return(law, trial(j), pressure(k), at)
                     call check_speed(law, trial(j), pressure(k), at)
                     call check_drawn(law, trial(j), pressure(k), at)
                  end do
               end do
            end do
         end do
      end do
   end subroutine speed_of_the_trial

   !> With the speed that its own traction leaves, the law as it reads a speed from without.
   subroutine check_speed(law, q, p, at)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: q, p
      type(condition_type), intent(in) :: at
      real(wp), parameter :: ct = 40.0_wp
      type(condition_type) :: given
      real(wp) :: f, again, dq, dp

      call return_to_disc(law, q, ct, p, at, f, dq, dp)
      given = at
      given%of_trial = .false.
      given%speed = (q - f)/(ct*at%dt)
      call return_to_disc(law, q, ct, p, given, again, dq, dp)
      call close_to('the law at its own speed', again/f, 1.0_wp, 1.0e-12_wp)
   end subroutine check_speed

   !> Regularised by a slip whose anchor is drawn along, and by a speed: both slopes.
   subroutine check_drawn(law, q, p, at)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: q, p
      type(condition_type), intent(in) :: at
      type(friction_type) :: curve
      real(wp) :: f(-2:2), h, ds, dp, unused, other
      integer :: k, r

      do r = 2, size(regularization_names)
         curve = law_with(law%law, r)
         curve%mu_static = law%mu_static
         curve%decay = law%decay
         h = 1.0e-3_wp*q
         do k = -2, 2
            call regularised_traction(curve, 0.1_wp, p, at, f(k), unused, other, q + k*h)
         end do
         call regularised_traction(curve, 0.1_wp, p, at, unused, ds, dp, q)
         if (.not. by_rate(curve)) call close_to('as the anchor is drawn', ds, slope_of(f, h), &
            & 1.0e-8_wp)
         curve%v0 = 20.0_wp
         do k = -2, 2
            call regularised_traction(curve, q + k*h, p, at, f(k), unused, other)
         end do
         call regularised_traction(curve, q, p, at, unused, ds, dp)
         call close_to('by the speed', q*ds/f(0), q*slope_of(f, h)/f(0), 1.0e-8_wp)
      end do
   end subroutine check_drawn

   subroutine check_return(law, q, p, at)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: q, p
      type(condition_type), intent(in) :: at
      real(wp), parameter :: ct = 40.0_wp
      real(wp) :: f(-2:2), hq, hp, dq, dp, unused, other
      integer :: k

      hq = 1.0e-3_wp*q
      hp = 1.0e-3_wp*p
      do k = -2, 2
         call return_to_disc(law, q + k*hq, ct, p, at, f(k), unused, other)
      end do
      call return_to_disc(law, q, ct, p, at, unused, dq, dp)
      call close_to('in the trial', dq, slope_of(f, hq), 1.0e-8_wp)
      do k = -2, 2
         call return_to_disc(law, q, ct, p + k*hp, at, f(k), unused, other)
      end do
      call close_to('in the pressure', dp, slope_of(f, hp), 1.0e-8_wp)
   end subroutine check_return

end program test_falling_friction
