!> Laws of friction where they end: laws that become others, caps, nothing at all, units.
program test_friction_limits
   use lopin_kinds, only : wp
   use lopin_friction, only : friction_type, condition_type, law_of, regularization_of, &
      & law_names, regularization_names, by_rate, reads_yield, depends_on_time, coefficient, &
      & friction_radius
   use lopin_friction_return, only : return_to_disc, regularised_traction
   use check, only : test, close_to, is_true, finish
   use friction_cases, only : law_with, scene
   implicit none

   real(wp), parameter :: pi = acos(-1.0_wp)

   call seed_repairs()
   call regularised_limits()
   call creep()
   call decay()
   call caps_and_rough()
   call nothing_gives_no_nan()
   call dissipation()
   call units()
   call finish()

contains

   subroutine seed_repairs()
      real(wp) :: traction, dq, dp
      integer :: i, r

      call test('lecture E2, E4: no shear without pressure, and stick has an inequality')
      do i = 1, size(law_names)
         call return_to_disc(law_with(i), 7.0_wp, 3.0_wp, 0.0_wp, scene(), traction, dq, dp)
         call is_true(trim(law_names(i))//' at p = 0', max(traction, dq, dp) <= 0.0_wp)
         call return_to_disc(law_with(i), 7.0_wp, 3.0_wp, -50.0_wp, scene(), traction, dq, dp)
         call is_true(trim(law_names(i))//' in tension', max(traction, dq, dp) <= 0.0_wp)
         do r = 2, size(regularization_names)
            call regularised_traction(law_with(i, r), 0.1_wp, -1.0_wp, scene(), traction, dq, dp)
            call is_true(trim(law_names(i))//' regularised', max(traction, dq, dp) <= 0.0_wp)
         end do
         if (i == law_of%norton_hoff) cycle
         call return_to_disc(law_with(i), 7.0_wp, 3.0_wp, 100.0_wp, scene(), traction, dq, dp)
         call close_to(trim(law_names(i))//' sticks inside the disc', traction, 7.0_wp, 0.0_wp)
         call is_true('and does not slip', traction >= 7.0_wp .and. dp <= 0.0_wp)
      end do
   end subroutine seed_repairs

   subroutine regularised_limits()
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp), parameter :: rise(4) = [0.0_wp, 2.0_wp/pi, 1.0_wp, 1.0_wp]
      real(wp) :: traction, radius, slope, ds, dp
      integer :: i, r

      at = scene()
      do r = 2, size(regularization_names)
         call test('limits of '//trim(regularization_names(r)))
         do i = 1, size(law_names)
            law = law_with(i, r)
            if (i == law_of%norton_hoff) then
               call regularised_traction(law, 1.0e4_wp*at%dt, 100.0_wp, at, traction, ds, dp)
               call close_to('fast', traction, law%alpha*1.0e4_wp**law%q, 1.0e-5_wp)
               cycle
            end if
            call friction_radius(law, 100.0_wp, at, radius, slope)
            call regularised_traction(law, 1.0e6_wp*law%elastic_slip, 100.0_wp, at, traction, ds, &
               & dp)
            call close_to('far', traction, radius, 1.0e-6_wp)
            call is_true('never above', traction <= radius)
            call regularised_traction(law, 0.0_wp, 100.0_wp, at, traction, ds, dp)
            call close_to('first slope', ds, rise(r)*radius/law%elastic_slip, 1.0e-12_wp)
         end do
      end do

      call test('the square root of Norton-Hoff is alpha (v^2 + v0^2)^((q-1)/2) v')
      law = law_with(law_of%norton_hoff, regularization_of%sqrt)
      call regularised_traction(law, 0.3_wp*at%dt, 1.0_wp, at, traction, ds, dp)
      call close_to('traction', traction, law%alpha*(0.09_wp + law%v0**2)**(-0.4_wp)*0.3_wp, &
         & 1.0e-12_wp)
   end subroutine regularised_limits

   !> A traction T below mu p makes the arctangent slip by u0 tan(pi T/(2 mu p)), where the exact
   !> law holds.
   subroutine creep()
      type(friction_type) :: law
      real(wp) :: traction, ds, dp, slip
      integer :: k

      call test('lecture E6: creep of the arctangent under T < mu N is u0 tan(pi T/(2 mu N))')
      law = law_with(law_of%coulomb, regularization_of%arctan)
      do k = 1, 9
         slip = law%elastic_slip*tan(0.5_wp*pi*0.1_wp*k)
         call regularised_traction(law, slip, 100.0_wp, scene(), traction, ds, dp)
         call close_to('share of mu N', traction/30.0_wp, 0.1_wp*k, 1.0e-13_wp)
      end do

      call test('lecture E6: the argument is no slip per increment: two halves are the whole')
      law%v0 = 0.2_wp
      call is_true('a rate', by_rate(law))
      call regularised_traction(law, 0.04_wp, 100.0_wp, condition_type(dt=0.4_wp), traction, ds, dp)
      slip = traction
      call regularised_traction(law, 0.02_wp, 100.0_wp, condition_type(dt=0.2_wp), traction, ds, dp)
      call close_to('the same traction', traction, slip, 1.0e-14_wp)
   end subroutine creep

   subroutine decay()
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp) :: radius, slope

      call test('the coefficient decays from static to kinetic with the speed')
      law%law = law_of%coulomb
      law%mu = 0.2_wp
      law%mu_static = 0.5_wp
      law%decay = 3.0_wp
      at%speed = 0.0_wp
      call friction_radius(law, 10.0_wp, at, radius, slope)
      call close_to('at rest', radius, 5.0_wp, 1.0e-14_wp)
      at%speed = log(2.0_wp)/3.0_wp
      call close_to('half way', coefficient(law, at), 0.35_wp, 1.0e-14_wp)
      call friction_radius(law, 10.0_wp, at, radius, slope)
      call close_to('slope', slope, 0.35_wp, 1.0e-14_wp)
      at%speed = 1.0e6_wp
      call close_to('fast', coefficient(law, at), 0.2_wp, 1.0e-14_wp)
      call is_true('time matters', depends_on_time(law))
   end subroutine decay

   subroutine caps_and_rough()
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp) :: traction, dq, dp
      integer :: i

      call test('TAUMAX bounds every law; alone it is a law without a material')
      do i = 1, size(law_names)
         law = law_with(i)
         law%tau_max = 1.0_wp
         call return_to_disc(law, 400.0_wp, 3.0_wp, 100.0_wp, scene(), traction, dq, dp)
         call close_to(trim(law_names(i)), traction, 1.0_wp, 0.0_wp)
         call close_to('no slope in p', dp, 0.0_wp, 0.0_wp)
      end do
      law = law_with(law_of%tresca)
      law%tau_max = 60.0_wp
      call return_to_disc(law, 400.0_wp, 3.0_wp, 9.0_wp, condition_type(), traction, dq, dp)
      call close_to('no yield stress', traction, 60.0_wp, 0.0_wp)
      law%has_m = .false.
      call return_to_disc(law, 400.0_wp, 3.0_wp, 9.0_wp, scene(), traction, dq, dp)
      call close_to('no shear factor', traction, 60.0_wp, 0.0_wp)
      call is_true('reads no yield stress', .not. reads_yield(law))

      call test('ROUGH never slips while it touches, or while it is held')
      do i = 0, size(law_names)
         law = law_with(i)
         law%rough = .true.
         call return_to_disc(law, 1.0e9_wp, 3.0_wp, 1.0e-6_wp, scene(), traction, dq, dp)
         call close_to('sticks', traction, 1.0e9_wp, 0.0_wp)
         call is_true('and does not slip', traction >= 1.0e9_wp)
         call return_to_disc(law, 1.0e9_wp, 3.0_wp, -1.0_wp, scene(), traction, dq, dp)
         call close_to('open', traction, 0.0_wp, 0.0_wp)
         at%held = .true.
         call return_to_disc(law, 1.0e9_wp, 3.0_wp, -1.0_wp, at, traction, dq, dp)
         call close_to('held', traction, 1.0e9_wp, 0.0_wp)
      end do
   end subroutine caps_and_rough

   !> F14: near-zero pressure, no trial, no slip.
   subroutine nothing_gives_no_nan()
      real(wp), parameter :: pressure(4) = [0.0_wp, tiny(1.0_wp), 1.0e-300_wp, 1.0e-12_wp]
      real(wp), parameter :: trial(4) = [0.0_wp, tiny(1.0_wp), 1.0e-300_wp, 1.0e-8_wp]
      real(wp) :: value(3)
      integer :: i, r, j, k

      call test('F14: near-zero pressure, trial and slip give no NaN')
      do i = 0, size(law_names)
         do j = 1, size(pressure)
            do k = 1, size(trial)
               call return_to_disc(law_with(i), trial(k), 40.0_wp, pressure(j), scene(), value(1), &
                  & value(2), value(3))
               call is_true('exact', all(value >= 0.0_wp) .and. all(value <= huge(1.0_wp)) &
                  & .and. value(1) <= trial(k))
               do r = 2, size(regularization_names)
                  if (i == 0) cycle
                  call regularised_traction(law_with(i, r), trial(k), pressure(j), scene(), &
                     & value(1), value(2), value(3))
                  call is_true('regularised', all(value >= 0.0_wp) .and. all(value < 1.0e9_wp))
               end do
            end do
         end do
      end do
      call return_to_disc(law_with(law_of%coulomb), 0.0_wp, 40.0_wp, 1.0_wp, scene(), value(1), &
         & value(2), value(3))
      call close_to('pure normal first step: exactly nothing', value(1), 0.0_wp, 0.0_wp)
   end subroutine nothing_gives_no_nan

   !> Random walks in the plane of tangents: the slip does work on every return.
   subroutine dissipation()
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp), parameter :: ct = 40.0_wp
      real(wp) :: t(2), trial(2), step(2), q, traction, dq, dp, work, elastic, last(2), total
      integer :: i, n
      integer, allocatable :: seed(:)

      call random_seed(size=n)
      allocate (seed(n), source=4711)
      call random_seed(put=seed)
      at = scene()
      do i = 1, size(law_names)
         call test('dissipation of '//trim(law_names(i))//' is not negative')
         law = law_with(i)
         t = 0.0_wp
         work = 0.0_wp
         total = 0.0_wp
         do n = 1, 500
            call random_number(step)
            step = 4.0_wp*(step - 0.5_wp)
            last = t
            trial = t - ct*step
            q = norm2(trial)
            call return_to_disc(law, q, ct, 60.0_wp, at, traction, dq, dp)
            t = trial/q*traction
            ! Slip is what the stiffness did not take.
            elastic = dot_product(t, step + (t - last)/ct)
            total = total - elastic
            work = min(work, -elastic)
            call is_true('inside the disc', norm2(t) <= q*(1.0_wp + 1.0e-14_wp))
         end do
         call is_true('of no step', work >= -1.0e-12_wp*total)
         call is_true('positive in all', total > 0.0_wp)
      end do
   end subroutine dissipation

   !> The same in Pa and m, and with another unit of time.
   subroutine units()
      real(wp), parameter :: stress = 1.0e6_wp, length = 1.0e-3_wp, time = 60.0_wp
      type(friction_type) :: law, other
      type(condition_type) :: at, there
      real(wp) :: one(3), two(3)
      integer :: i, r

      at = scene()
      there = condition_type(at%yield*stress, at%mises*stress, at%dt*time, at%speed*length/time)
      do i = 1, size(law_names)
         do r = 1, size(regularization_names)
            call test('units of '//trim(law_names(i))//' by '//trim(regularization_names(r)))
            law = law_with(i, r)
            law%tau_max = 17.5_wp
            other = law
            other%tau_max = law%tau_max*stress
            other%elastic_slip = law%elastic_slip*length
            other%v0 = law%v0*length/time
            other%alpha = law%alpha*stress*(time/length)**law%q
            if (r == regularization_of%linear) then
               call return_to_disc(law, 40.0_wp, 9.0_wp, 77.0_wp, at, one(1), one(2), one(3))
               call return_to_disc(other, 40.0_wp*stress, 9.0_wp*stress/length, 77.0_wp*stress, &
                  & there, two(1), two(2), two(3))
            else
               call regularised_traction(law, 0.017_wp, 77.0_wp, at, one(1), one(2), one(3))
               call regularised_traction(other, 0.017_wp*length, 77.0_wp*stress, there, two(1), &
                  & two(2), two(3))
               two(2) = two(2)*length/stress
            end if
            two(1) = two(1)/stress
            call close_to('the same', two, one, 1.0e-12_wp)
         end do
      end do
   end subroutine units
end program test_friction_limits
