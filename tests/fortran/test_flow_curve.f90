!> Hardening laws by rate laws: slopes, the equation of an increment, and the radial return.
program test_flow_curve
   use lopin_kinds, only : wp
   use lopin_flow_curve, only : flow_type, flow_stress, flow_step, table_flow, swift_flow, &
      & hollomon_flow, voce_flow, linear_flow, give_viscosity, is_viscous, least_slope, table_end
   use lopin_radial_return, only : return_type, return_radially
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: shear = 80.0e3_wp
   character(len=8), parameter :: hardening(6) = [character(len=8) :: 'none', 'table', 'swift', &
      & 'hollomon', 'voce', 'linear']
   character(len=8), parameter :: rates(4) = [character(len=8) :: 'none', 'power', 'norton', 'both']
   type(flow_type) :: flow
   integer :: h, r

   do h = 1, size(hardening)
      do r = 1, size(rates)
         if (h == 1 .and. rates(r) /= 'norton') cycle
         flow = law(hardening(h), rates(r))
         call slopes_are_those_of_the_stress()
         call an_increment_solves_its_equation()
         call the_return_has_the_slope_of_its_stress()
         if (is_viscous(flow)) call time_has_no_unit()
      end do
   end do
   call closed_forms()
   call rigid_solids_flow_from_the_first_strain()
   call what_a_deck_is_warned_of()
   call finish()

contains

   function law(hard, rate) result(flow)
      character(len=*), intent(in) :: hard, rate
      type(flow_type) :: flow

      select case (hard)
      case ('table')
         flow = table_flow([0.0_wp, 0.05_wp, 0.5_wp, 4.0_wp], &
            & [200.0_wp, 260.0_wp, 400.0_wp, 600.0_wp])
      case ('swift')
         flow = swift_flow(550.0_wp, 0.01_wp, 0.22_wp)
      case ('hollomon')
         flow = hollomon_flow(550.0_wp, 0.22_wp, 194.0_wp)
      case ('voce')
         flow = voce_flow(400.0_wp, 200.0_wp, 7.0_wp, 30.0_wp)
      case ('linear')
         flow = linear_flow(700.0_wp, 300.0_wp)
      end select
      if (rate == 'power' .or. rate == 'both') then
         flow%rate = 40.0_wp
         flow%power = 5.0_wp
      end if
      if (rate == 'norton' .or. rate == 'both') call give_viscosity(flow, 100.0_wp, 0.2_wp)
   end function law

   function name() result(text)
      character(len=:), allocatable :: text
      text = trim(hardening(h))//', rate '//trim(rates(r))
   end function name

   pure real(wp) function stress_at(strain, rate) result(stress)
      real(wp), intent(in) :: strain, rate
      real(wp) :: slope, rate_slope
      call flow_stress(flow, strain, rate, stress, slope, rate_slope)
   end function stress_at

   subroutine slopes_are_those_of_the_stress()
      real(wp), parameter :: strain(3) = [0.02_wp, 0.3_wp, 1.7_wp], rate(2) = [0.01_wp, 3.0_wp]
      real(wp) :: stress, slope, rate_slope, step
      integer :: i, k

      call test('slopes of the flow stress: '//name())
      do i = 1, size(strain)
         do k = 1, size(rate)
            call flow_stress(flow, strain(i), rate(k), stress, slope, rate_slope)
            step = 1.0e-3_wp*strain(i)
            call close_to('strain', slope/stress, (8.0_wp*(stress_at(strain(i) + step, rate(k)) &
               & - stress_at(strain(i) - step, rate(k))) - stress_at(strain(i) + 2.0_wp*step, &
               & rate(k)) + stress_at(strain(i) - 2.0_wp*step, rate(k)))/(12.0_wp*step*stress), &
               & 1.0e-8_wp)
            step = 1.0e-3_wp*rate(k)
            call close_to('rate', rate_slope/stress, (8.0_wp*(stress_at(strain(i), rate(k) + step) &
               & - stress_at(strain(i), rate(k) - step)) - stress_at(strain(i), rate(k) &
               & + 2.0_wp*step) + stress_at(strain(i), rate(k) - 2.0_wp*step))/(12.0_wp*step &
               & *stress), 1.0e-8_wp)
         end do
      end do
   end subroutine slopes_are_those_of_the_stress

   !> Against a bisection that knows nothing of slopes.
   subroutine an_increment_solves_its_equation()
      real(wp), parameter :: trial(4) = [201.0_wp, 1.0e3_wp, 3.0e4_wp, 1.0e6_wp]
      real(wp), parameter :: before(2) = [0.0_wp, 0.4_wp], dt(2) = [1.0e-3_wp, 20.0_wp]
      real(wp) :: step, stress, slope, low, high, middle
      integer :: a, b, c, k

      call test('the plastic strain of an increment: '//name())
      do a = 1, size(trial)
         do b = 1, size(before)
            do c = 1, size(dt)
               call flow_step(flow, shear, trial(a), before(b), dt(c), step, stress, slope)
               low = 0.0_wp
               high = trial(a)/(3.0_wp*shear)
               do k = 1, 200
                  middle = 0.5_wp*(low + high)
                  if (trial(a) - 3.0_wp*shear*middle > stress_at(before(b) + middle, &
                     & middle/dt(c))) then
                     low = middle
                  else
                     high = middle
                  end if
               end do
               if (.not. trial(a) > stress_at(before(b), 0.0_wp)) middle = 0.0_wp
               call close_to('step', step/(trial(a)/shear), middle/(trial(a)/shear), 1.0e-14_wp)
               if (.not. step > 0.0_wp) cycle
               call close_to('stress', stress/trial(a), stress_at(before(b) + step, step/dt(c)) &
                  & /trial(a), 1.0e-12_wp)
            end do
         end do
      end do
   end subroutine an_increment_solves_its_equation

   subroutine the_return_has_the_slope_of_its_stress()
      real(wp), parameter :: size_of(3) = [0.02_wp, 0.1_wp, 0.7_wp], dt(2) = [0.01_wp, 5.0_wp]
      type(return_type) :: back
      real(wp) :: step, slope
      integer :: i, k

      call test('the slope of the return: '//name())
      do i = 1, size(size_of)
         do k = 1, size(dt)
            back = return_radially(flow, shear, size_of(i), 0.1_wp, dt(k))
            call is_true('flows', back%step > 0.0_wp)
            call close_to('stress', back%secant*size_of(i)*sqrt(1.5_wp)/back%stress, 1.0_wp, &
               & 1.0e-13_wp)
            call close_to('share kept', back%stress/(sqrt(6.0_wp)*shear*size_of(i)), back%kept, &
               & 1.0e-13_wp)
            call close_to('strain', back%kept*size_of(i) + sqrt(1.5_wp)*back%step, size_of(i), &
               & 1.0e-13_wp)
            step = 1.0e-3_wp*size_of(i)
            slope = (8.0_wp*(along(size_of(i) + step, dt(k)) - along(size_of(i) - step, dt(k))) &
               & - along(size_of(i) + 2.0_wp*step, dt(k)) &
               & + along(size_of(i) - 2.0_wp*step, dt(k)))/(12.0_wp*step)
            call close_to('slope', (back%secant + back%along)/(2.0_wp*shear), &
               & slope/(2.0_wp*shear), 1.0e-8_wp)
         end do
      end do
   end subroutine the_return_has_the_slope_of_its_stress

   !> Size of the deviator of stress.
   real(wp) function along(size_of, dt)
      real(wp), intent(in) :: size_of, dt
      type(return_type) :: back
      back = return_radially(flow, shear, size_of, 0.1_wp, dt)
      along = back%secant*size_of
   end function along

   !> Minutes instead of seconds.
   subroutine time_has_no_unit()
      type(flow_type) :: other
      type(return_type) :: back, same
      real(wp), parameter :: unit = 1.0_wp/60.0_wp

      call test('time has no unit: '//name())
      other = flow
      other%rate = flow%rate/unit
      other%consistency = flow%consistency*unit**flow%sensitivity
      back = return_radially(flow, shear, 0.1_wp, 0.2_wp, 3.0_wp)
      same = return_radially(other, shear, 0.1_wp, 0.2_wp, 3.0_wp*unit)
      call close_to('stress', same%stress/back%stress, 1.0_wp, 1.0e-13_wp)
   end subroutine time_has_no_unit

   subroutine closed_forms()
      real(wp) :: step, stress, slope
      type(flow_type) :: thin

      call test('linear hardening returns by trial - Y over 3 G + H')
      call flow_step(linear_flow(700.0_wp, 300.0_wp), shear, 5.0e3_wp, 0.0_wp, 1.0_wp, step, &
         & stress, slope)
      call close_to('step', step, 4.3e3_wp/(3.0_wp*shear + 300.0_wp), 1.0e-16_wp)
      call close_to('slope', slope, 300.0_wp, 1.0e-9_wp)
      call test('a linear fluid without threshold')
      call give_viscosity(thin, 100.0_wp, 1.0_wp)
      call flow_step(thin, shear, 5.0e3_wp, 0.0_wp, 0.1_wp, step, stress, slope)
      call close_to('step', step, 5.0e3_wp/(3.0_wp*shear + 3.0e3_wp), 1.0e-16_wp)
      call test('Norton and Hoff in tension: K sqrt(3)^(m+1) rate^m (benchmark E4)')
      flow = law('none', 'norton')
      call close_to('stress', stress_at(0.0_wp, 1.0_wp), 193.318205_wp, 1.0e-6_wp)
      call test("Hollomon's curve begins at its yield stress and is K e^n of the total strain")
      flow = law('hollomon', 'none')
      call close_to('yield', stress_at(0.0_wp, 0.0_wp), 194.0_wp, 1.0e-11_wp)
      call close_to('beyond', stress_at(0.2_wp, 0.0_wp), 550.0_wp*(0.2_wp + (194.0_wp/550.0_wp) &
         & **(1.0_wp/0.22_wp))**0.22_wp, 1.0e-11_wp)
      call test('a table is constant beyond its end')
      flow = law('table', 'none')
      call close_to('stress', stress_at(9.0_wp, 0.0_wp), 600.0_wp, 0.0_wp)
   end subroutine closed_forms

   !> Stress of the rate, linear in rates below `slowest`; slopes everywhere.
   subroutine rigid_solids_flow_from_the_first_strain()
      type(return_type) :: back
      real(wp), parameter :: size_of(4) = [1.0e-9_wp, 1.0e-6_wp, 1.0e-3_wp, 0.3_wp], dt = 0.5_wp
      real(wp) :: step, slope
      integer :: i

      flow = law('none', 'norton')
      flow%rigid = .true.
      flow%usual = 1.0_wp
      call test('a rigid solid has the stress of its rate')
      back = return_radially(flow, shear, 0.3_wp, 0.0_wp, dt)
      step = sqrt(2.0_wp/3.0_wp)*0.3_wp
      call close_to('stress', back%stress/stress_at(step, step/dt), 1.0_wp, 1.0e-10_wp)
      call close_to('no elastic share', back%kept, 0.0_wp, 0.0_wp)
      call test('and the slope of it, also where it hardly flows')
      do i = 1, size(size_of)
         back = return_radially(flow, shear, size_of(i), 0.1_wp, dt)
         step = 1.0e-3_wp*size_of(i)
         slope = (8.0_wp*(along(size_of(i) + step, dt) - along(size_of(i) - step, dt)) &
            & - along(size_of(i) + 2.0_wp*step, dt) + along(size_of(i) - 2.0_wp*step, dt)) &
            & /(12.0_wp*step)
         call close_to('slope', (back%secant + back%along)/slope, 1.0_wp, 1.0e-8_wp)
      end do
      back = return_radially(flow, shear, 0.0_wp, 0.1_wp, dt)
      call is_true('at rest', back%secant > 0.0_wp .and. back%secant < huge(1.0_wp) &
         & .and. abs(back%along) <= 0.0_wp)
   end subroutine rigid_solids_flow_from_the_first_strain

   subroutine what_a_deck_is_warned_of()
      call test('curves that fall, and tables that end')
      call close_to('rises', least_slope(law('voce', 'none')), 0.0_wp, 0.0_wp)
      call close_to('falls', least_slope(table_flow([0.0_wp, 0.5_wp], [300.0_wp, 250.0_wp])), &
         & -100.0_wp, 1.0e-12_wp)
      call close_to('falls', least_slope(voce_flow(200.0_wp, 300.0_wp, 2.0_wp, 50.0_wp)), &
         & -150.0_wp, 1.0e-12_wp)
      call close_to('end', table_end(law('table', 'none')), 4.0_wp, 0.0_wp)
      call is_true('perfect plasticity has no end', &
         & table_end(table_flow([0.0_wp], [300.0_wp])) >= huge(1.0_wp))
   end subroutine what_a_deck_is_warned_of
end program test_flow_curve
