!> Tests of lopin_contraction on Newton's method for equations with known roots, and of the guess of
!> lopin_predictor on motions that it must continue exactly.
program test_contraction
   use lopin_kinds, only : wp
   use lopin_contraction, only : contraction_type, by_old_tangent, evaluate_without_tangent, &
      & note_step, gets_nowhere
   use lopin_state, only : motion_type
   use lopin_predictor, only : record_motion, extrapolated_motion
   use check, only : test, is_true, close_to, finish
   implicit none

   call forecasts_hold()
   call kinks_are_not_trusted()
   call stagnation_is_seen()
   call trends_go_on()
   call finish()

contains

   !> x exp(x) = a by Newton from many starts: where the last step may use the old tangent, it does
   !> reach what was wanted; and where a look was foreseen to need no tangent, none was needed.
   subroutine forecasts_hold()
      real(wp), parameter :: wanted = 1.0e-8_wp
      type(contraction_type) :: newton
      real(wp) :: x, old, a, r, before, correction
      integer :: start, it, used, foreseen
      logical :: blind

      call test('forecasts of Newton')
      used = 0
      foreseen = 0
      do start = 1, 200
         a = 0.02_wp*real(start, wp)
         x = 1.0_wp + 0.01_wp*real(start, wp)
         r = abs(f(x, a))
         newton%rate = 1.0_wp
         newton%exact = .false.
         do it = 1, 30
            if (r < wanted) exit
            if (it > 1) then
               if (by_old_tangent(newton, r, correction, wanted, 1.0e-6_wp)) then
                  used = used + 1
                  x = x - f(x, a)/slope(old)
                  call is_true('a foreseen last step is the last', abs(f(x, a)) < wanted)
                  exit
               end if
            end if
            blind = evaluate_without_tangent(newton, r, .true., wanted)
            old = x
            before = r
            correction = abs(f(x, a)/slope(x))
            x = x - f(x, a)/slope(x)
            r = abs(f(x, a))
            call note_step(newton, before, r, .true.)
            if (blind) then
               foreseen = foreseen + 1
               call is_true('a look without tangent', r < wanted .or. by_old_tangent(newton, r, &
                  & correction, wanted, huge(1.0_wp)))
            end if
         end do
         call is_true('Newton ends', it < 30)
      end do
      call is_true('old tangents are used', used > 50)
      call is_true('looks are foreseen', foreseen > 50)
   end subroutine forecasts_hold

   real(wp) function f(x, a)
      real(wp), intent(in) :: x, a
      f = x*exp(x) - a
   end function f

   real(wp) function slope(x)
      real(wp), intent(in) :: x
      slope = (1.0_wp + x)*exp(x)
   end function slope

   !> Steps that were cut short or changed the contact tell nothing of the next one.
   subroutine kinks_are_not_trusted()
      type(contraction_type) :: newton

      call test('steps that tell nothing')
      call note_step(newton, 1.0e-3_wp, 1.0e-6_wp, .false.)
      call is_true('no old tangent after a kink', .not. by_old_tangent(newton, 1.0e-6_wp, &
         & 1.0e-9_wp, 1.0e-8_wp, 1.0e-6_wp))
      call is_true('no forecast without experience', .not. evaluate_without_tangent(newton, &
         & 1.0e-6_wp, .true., 1.0e-8_wp))
      call note_step(newton, 1.0e-3_wp, 1.0e-4_wp, .true.)
      call is_true('slow steps are not near', .not. by_old_tangent(newton, 1.0e-9_wp, 1.0e-9_wp, &
         & 1.0e-8_wp, 1.0e-6_wp))
   end subroutine kinks_are_not_trusted

   subroutine stagnation_is_seen()
      real(wp), parameter :: noise(10) = [0.2_wp, 0.3_wp, 0.25_wp, 0.4_wp, 0.21_wp, 0.5_wp, 0.3_wp, &
         & 0.22_wp, 0.6_wp, 0.3_wp]
      integer :: i

      call test('stagnation')
      call is_true('noise gets nowhere', gets_nowhere(noise))
      call is_true('a short run may', .not. gets_nowhere(noise(:7)))
      call is_true('a slow fall goes on', .not. gets_nowhere([(0.95_wp**i, i=1, 30)]))
   end subroutine stagnation_is_seen

   !> Increments of uneven length: a steady motion is continued from one, a motion with a steady
   !> acceleration from two; a kink puts the trend out of use, and smooth motion brings it back.
   subroutine trends_go_on()
      type(motion_type) :: state
      real(wp), parameter :: time(5) = [0.0_wp, 1.0_wp, 1.5_wp, 3.5_wp, 4.0_wp]
      real(wp) :: kink
      integer :: i

      call test('the trend of motion')
      do i = 1, 3
         call record_motion(state, place(time(i + 1)) - place(time(i)), time(i + 1) - time(i), &
            & .false.)
      end do
      call is_true('the trend tells more', state%curved)
      call close_to('a steady acceleration', extrapolated_motion(state, 0.5_wp, .true.), &
         & place(4.0_wp) - place(3.5_wp), 1.0e-13_wp)
      kink = 1.0_wp
      call record_motion(state, place(4.0_wp) - place(3.5_wp) + [kink, 0.0_wp, 0.0_wp], 0.5_wp, &
         & .false.)
      call is_true('a kink is not continued', .not. state%curved)
      call record_motion(state, place(4.5_wp) - place(4.0_wp), 0.5_wp, .true.)
      call is_true('a body springs back once', .not. state%last_dt > 0.0_wp)
   end subroutine trends_go_on

   pure function place(t) result(x)
      real(wp), intent(in) :: t
      real(wp) :: x(3)
      x = [1.0_wp + 2.0_wp*t + 0.3_wp*t**2, -t**2, 4.0_wp*t - 0.1_wp*t**2]
   end function place
end program test_contraction
