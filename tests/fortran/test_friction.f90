!> Laws of friction: every law with every regularisation, by loops over their names.
program test_friction
   use lopin_kinds, only : wp
   use lopin_friction, only : friction_type, condition_type, law_of, regularization_of, &
      & law_names, regularization_names, law_number, regularization_number, has_friction, &
      & is_regularised, reads_yield, reads_mises, depends_on_time, friction_radius, &
      & lost_at_touch
   use lopin_friction_return, only : return_to_disc, regularised_traction
   use check, only : test, close_to, is_true, finish
   use friction_cases, only : law_with, scene, slope_of
   implicit none

   real(wp), parameter :: root_3 = sqrt(3.0_wp)

   call names()
   call law_zoo()
   call slopes_of_the_return()
   call slopes_of_the_regularised()
   call no_friction()
   call norton_becomes_tresca()
   call norton_and_its_speed()
   call orowan_switches()
   call cristescu_at_yield()
   call bounds_rise()
   call finish()

contains

   subroutine names()
      integer :: i

      call test('every law and regularisation has a word, and the word its number')
      do i = 1, size(law_names)
         call is_true(trim(law_names(i)), law_number(trim(law_names(i))) == i)
         call is_true('a law is friction', has_friction(law_with(i)))
      end do
      do i = 1, size(regularization_names)
         call is_true(trim(regularization_names(i)), &
            & regularization_number(trim(regularization_names(i))) == i)
         call is_true('or not', is_regularised(law_with(1, i)) .neqv. i == 1)
      end do
      call is_true('orowan', law_number('Coulomb-Orowan') == law_of%orowan)
      call is_true('auto', law_number('auto') == law_of%automatic)
      call is_true('unknown', law_number('ARCHARD') == law_of%none)
      call is_true('no law is no friction', .not. has_friction(friction_type()))
      do i = 1, size(law_names)
         call test('what a law says that it reads is what changes its radius: '//law_names(i))
         call is_true('yield stress', reads_yield(law_with(i)) .eqv. differs(i, 'yield'))
         call is_true('von Mises stress', reads_mises(law_with(i)) .eqv. differs(i, 'mises'))
         call is_true('time', depends_on_time(law_with(i)) .eqv. differs(i, 'speed'))
      end do
   end subroutine names

   !> Whether the shear of a slipping point changes with a condition, at some of these pressures.
   logical function differs(law, what)
      integer, intent(in) :: law
      character(len=*), intent(in) :: what
      real(wp), parameter :: pressure(3) = [1.0e-2_wp, 1.0e2_wp, 1.0e5_wp]
      type(condition_type) :: at, other
      real(wp) :: lost, one, two
      integer :: i

      at = scene()
      at%mises = 0.5_wp*at%yield
      differs = .false.
      do i = 1, size(pressure)
         other = at
         if (what == 'yield') other%yield = 0.3_wp*at%yield
         if (what == 'mises') other%mises = 0.8_wp*at%mises
         if (what == 'speed') other%speed = 2.0_wp*at%speed
         call lost_at_touch(law_with(law), pressure(i), at, lost, one)
         call lost_at_touch(law_with(law), pressure(i), other, lost, two)
         differs = differs .or. abs(one - two) > 1.0e-9_wp*one
      end do
   end function differs

   !> C9: p = 100, mu = .3, m = .2, sigma_y = 200, sigma_vm = 150, alpha = 5, v = 2, q = .2.
   subroutine law_zoo()
      real(wp), parameter :: expected(size(law_names)) = [30.0_wp, 23.0940107675850_wp, &
         & 23.0940107675850_wp, 17.3205080756888_wp, 5.743491774985175_wp]
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp) :: traction, dq, dp, q
      real(wp), parameter :: ct = 1.0e3_wp
      integer :: i

      at = scene()
      do i = 1, size(law_names)
         call test('C9 by '//trim(law_names(i)))
         law = law_with(i)
         ! The trial of a slip of v dt: what the law carries and what the stiffness would add.
         q = expected(i) + ct*2.0_wp*at%dt
         call return_to_disc(law, q, ct, 100.0_wp, at, traction, dq, dp)
         call close_to('traction', traction, expected(i), 1.0e-12_wp)
         call is_true('slips', traction < q)
         law = law_with(i, regularization_of%arctan)
         if (i == law_of%norton_hoff) cycle
         call regularised_traction(law, law%elastic_slip, 100.0_wp, at, traction, dq, dp)
         call close_to('half of it at u0', traction, 0.5_wp*expected(i), 1.0e-12_wp)
         law%v0 = 2.0_wp
         call regularised_traction(law, 2.0_wp*at%dt, 100.0_wp, at, traction, dq, dp)
         call close_to('half of it at v0', traction, 0.5_wp*expected(i), 1.0e-12_wp)
      end do
   end subroutine law_zoo

   subroutine slopes_of_the_return()
      real(wp), parameter :: trial(4) = [3.0_wp, 12.0_wp, 35.0_wp, 180.0_wp]
      real(wp), parameter :: pressure(4) = [0.02_wp, 30.0_wp, 100.0_wp, 4.0e5_wp]
      real(wp), parameter :: exponent(4) = [0.05_wp, 0.2_wp, 0.7_wp, 1.0_wp]
      type(friction_type) :: law
      integer :: i, j, k, l

      do i = 1, size(law_names)
         call test('slopes of the return to the disc of '//trim(law_names(i)))
         do j = 1, size(trial)
            do k = 1, size(pressure)
               do l = 1, merge(size(exponent), 1, i == law_of%norton_hoff)
                  law = law_with(i)
                  law%q = exponent(l)
                  call check_return(law, trial(j), pressure(k), scene())
                  law%tau_max = 20.0_wp
                  call check_return(law, trial(j), pressure(k), scene())
               end do
            end do
         end do
      end do
   end subroutine slopes_of_the_return

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

   subroutine slopes_of_the_regularised()
      real(wp), parameter :: slip(4) = [1.0e-4_wp, 3.0e-3_wp, 0.013_wp, 0.4_wp]
      real(wp), parameter :: pressure(3) = [0.02_wp, 30.0_wp, 400.0_wp]
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp) :: f(-2:2), h, ds, dp, unused, other, scale
      integer :: i, r, j, l, k

      at = scene()
      do i = 1, size(law_names)
         do r = 2, size(regularization_names)
            call test('slopes of '//trim(law_names(i))//' by '//trim(regularization_names(r)))
            law = law_with(i, r)
            do j = 1, size(slip)
               do l = 1, size(pressure)
                  h = 1.0e-3_wp*slip(j)
                  do k = -2, 2
                     call regularised_traction(law, slip(j) + k*h, pressure(l), at, f(k), unused, &
                        & other)
                  end do
                  call regularised_traction(law, slip(j), pressure(l), at, unused, ds, dp)
                  scale = max(ds, f(0)/slip(j))
                  call close_to('in the slip', ds/scale, slope_of(f, h)/scale, 1.0e-8_wp)
                  h = 1.0e-3_wp*pressure(l)
                  do k = -2, 2
                     call regularised_traction(law, slip(j), pressure(l) + k*h, at, f(k), unused, &
                        & other)
                  end do
                  call close_to('in the pressure', dp, slope_of(f, h), 1.0e-8_wp)
               end do
            end do
            call regularised_traction(law, 0.0_wp, 50.0_wp, at, f(0), ds, dp)
            call regularised_traction(law, 1.0e-9_wp, 50.0_wp, at, f(1), unused, other)
            call close_to('nothing at rest', f(0), 0.0_wp, 0.0_wp)
            call close_to('traction/slip near rest', f(1)/1.0e-9_wp/ds, 1.0_wp, 1.0e-8_wp)
         end do
      end do
   end subroutine slopes_of_the_regularised

   subroutine no_friction()
      type(friction_type) :: law
      real(wp) :: radius, slope, traction, dq, dp

      call test('mu = 0 is the radius of no friction, bit by bit')
      law%law = law_of%coulomb
      call friction_radius(law, 100.0_wp, scene(), radius, slope)
      call is_true('radius and slope are 0', radius + slope <= 0.0_wp)
      call return_to_disc(law, 7.0_wp, 3.0_wp, 100.0_wp, scene(), traction, dq, dp)
      call is_true('traction and slopes are 0', max(traction, dq, dp) <= 0.0_wp)
      call return_to_disc(friction_type(), 7.0_wp, 3.0_wp, 100.0_wp, scene(), traction, dq, dp)
      call is_true('as without a law', max(traction, dq, dp) <= 0.0_wp)
   end subroutine no_friction

   subroutine norton_becomes_tresca()
      real(wp), parameter :: trial(3) = [5.0_wp, 23.0_wp, 400.0_wp]
      type(friction_type) :: norton, tresca
      real(wp) :: a, b, dqa, dqb, dpa, dpb
      integer :: j

      call test('Norton-Hoff with q -> 0 and alpha = m sigma_y/sqrt 3 is Tresca')
      norton = law_with(law_of%norton_hoff)
      tresca = law_with(law_of%tresca)
      norton%alpha = tresca%m*200.0_wp/root_3
      do j = 1, size(trial)
         call return_to_disc(tresca, trial(j), 40.0_wp, 100.0_wp, scene(), a, dqa, dpa)
         norton%q = 0.0_wp
         call return_to_disc(norton, trial(j), 40.0_wp, 100.0_wp, scene(), b, dqb, dpb)
         call is_true('q = 0: the same bits', max(abs(a - b), abs(dqa - dqb), abs(dpa - dpb)) &
            & <= 0.0_wp)
         norton%q = 1.0e-10_wp
         call return_to_disc(norton, trial(j), 40.0_wp, 100.0_wp, scene(), b, dqb, dpb)
         call close_to('q = 1e-10', b, a, 1.0e-8_wp)
         call close_to('its slope', dqb, dqa, 1.0e-8_wp)
      end do
   end subroutine norton_becomes_tresca

   subroutine norton_and_its_speed()
      real(wp), parameter :: exponent(5) = [1.0e-3_wp, 0.1_wp, 0.5_wp, 0.9_wp, 1.0_wp]
      real(wp), parameter :: trial(4) = [1.0e-12_wp, 1.0e-3_wp, 7.0_wp, 1.0e6_wp]
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp) :: traction, dq, dp, speed
      !> Pressed so hard that the bound has risen to what the law says.
      real(wp), parameter :: ct = 40.0_wp, p = 1.0e9_wp
      integer :: i, j

      call test('lecture E5, "R_t = alpha |v|^q": the return solves q - c_t dgamma = alpha v^q')
      at = scene()
      law = law_with(law_of%norton_hoff)
      do i = 1, size(exponent)
         law%q = exponent(i)
         do j = 1, size(trial)
            call return_to_disc(law, trial(j), ct, p, at, traction, dq, dp)
            call is_true('between 0 and the trial', traction >= 0.0_wp .and. traction <= trial(j))
            speed = (traction/law%alpha)**(1.0_wp/law%q)
            call close_to('residual', (traction + ct*at%dt*speed)/trial(j), 1.0_wp, 1.0e-10_wp)
         end do
      end do
      law%q = 1.0_wp
      call return_to_disc(law, 7.0_wp, ct, p, at, traction, dq, dp)
      call close_to('q = 1 is linear', traction, 7.0_wp/(1.0_wp + ct*at%dt/law%alpha), 1.0e-14_wp)
   end subroutine norton_and_its_speed

   subroutine orowan_switches()
      type(friction_type) :: law
      real(wp) :: radius(3), slope(3), switch
      integer :: i

      call test('lecture E3, "min(mu p, m sigma_y/sqrt 3)" of two numbers: Coulomb, then Tresca')
      law = law_with(law_of%orowan)
      switch = law%m*200.0_wp/(law%mu*root_3)
      call friction_radius(law, 1.0e-3_wp*switch, scene(), radius(1), slope(1))
      call close_to('Coulomb when p is small', radius(1), law%mu*1.0e-3_wp*switch, 1.0e-14_wp)
      call close_to('its slope', slope(1), law%mu, 1.0e-14_wp)
      call friction_radius(law, 1.0e3_wp*switch, scene(), radius(1), slope(1))
      call close_to('Tresca when p is large', radius(1), law%m*200.0_wp/root_3, 1.0e-14_wp)
      call close_to('no slope', slope(1), 0.0_wp, 0.0_wp)
      do i = 1, 3
         call friction_radius(law, switch*(1.0_wp + (i - 2)*1.0e-12_wp), scene(), radius(i), &
            & slope(i))
      end do
      call close_to('continuous at the switch', maxval(radius) - minval(radius), 0.0_wp, 1.0e-10_wp)
      call is_true('where the slope jumps', slope(1) > 0.0_wp .and. slope(3) <= 0.0_wp)
   end subroutine orowan_switches

   subroutine cristescu_at_yield()
      type(condition_type) :: at
      real(wp) :: one, two, slope

      call test('lecture E4, "Critescu": Tresca where the body yields, less where it does not')
      at = scene()
      call friction_radius(law_with(law_of%tresca), 100.0_wp, at, one, slope)
      at%mises = at%yield
      call friction_radius(law_with(law_of%cristescu), 100.0_wp, at, two, slope)
      call is_true('the same bits', abs(one - two) <= 0.0_wp)
      at%mises = 1.7_wp*at%yield
      call friction_radius(law_with(law_of%cristescu), 100.0_wp, at, two, slope)
      call is_true('capped', abs(one - two) <= 0.0_wp)
      at%yield = 0.0_wp
      call friction_radius(law_with(law_of%cristescu), 100.0_wp, at, two, slope)
      call close_to('not capped by what is unknown', two, 1.7_wp*one, 1.0e-14_wp)
      at%mises = 0.0_wp
      call friction_radius(law_with(law_of%cristescu), 100.0_wp, at, two, slope)
      call is_true('at first touch the disc has a radius', two > 0.0_wp .and. two < 0.02_wp)
      call close_to('that grows with p', slope, two/100.0_wp, 1.0e-14_wp)
   end subroutine cristescu_at_yield

   subroutine bounds_rise()
      type(friction_type) :: law
      type(condition_type) :: eased
      real(wp) :: p, radius, slope, lost, whole

      call test('a bound that is a stress rises as ten times p, or as the coefficient of AUTO')
      law = law_with(law_of%tresca)
      p = law%m*200.0_wp/root_3/40.0_wp
      call friction_radius(law, p, scene(), radius, slope)
      call close_to('a quarter of it', radius, 10.0_wp*p, 1.0e-14_wp)
      call close_to('its slope', slope, 10.0_wp, 0.0_wp)
      call lost_at_touch(law, p, scene(), lost, whole)
      call close_to('three quarters are lost', lost, 30.0_wp*p, 1.0e-13_wp)
      call close_to('of all', whole, 40.0_wp*p, 1.0e-13_wp)
      call lost_at_touch(law, 5.0_wp*p, scene(), lost, whole)
      call close_to('nothing where it is whole', lost, 0.0_wp, 0.0_wp)
      law%rise = 0.1_wp
      call friction_radius(law, p, scene(), radius, slope)
      call close_to('a coefficient', radius, 0.1_wp*p, 1.0e-14_wp)
      call lost_at_touch(law, p, scene(), lost, whole)
      call close_to('which is the law: nothing is lost', lost, 0.0_wp, 0.0_wp)
      eased = scene()
      eased%eased = 0.5_wp
      call friction_radius(law, p, eased, radius, slope)
      call close_to('eased, half of it', radius, 0.05_wp*p, 1.0e-14_wp)
      call lost_at_touch(law, p, eased, lost, whole)
      call close_to('and half of it is lost', lost, 0.05_wp*p, 1.0e-13_wp)
      law%rise = 10.0_wp
      call friction_radius(law, p, eased, radius, slope)
      call close_to('a jump eased', radius, 5.0_wp*p, 1.0e-14_wp)
      call close_to('and its slope', slope, 5.0_wp, 0.0_wp)
      call lost_at_touch(law, p, eased, lost, whole)
      call close_to('the rest is lost', lost, 35.0_wp*p, 1.0e-13_wp)
      call friction_radius(law, 10.0_wp*p, eased, radius, slope)
      call close_to('nothing where it is reached', radius, 40.0_wp*p, 1.0e-13_wp)
   end subroutine bounds_rise
end program test_friction
