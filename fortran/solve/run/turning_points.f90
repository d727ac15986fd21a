!> The points of the amplitudes of a step: increments of what has a history end there.
!>
!> Friction, flow and contact that sticks remember the way; a straight line from the start of an
!> increment to its end forgets what an amplitude did between. A linear scene without history is the
!> same at the end whatever lies between.
module lopin_turning_points
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, step_type
   use lopin_flow_curve, only : flows
   use lopin_pair_friction, only : pair_slides_with_friction
   use lopin_plan, only : plan_type, path_of
   implicit none
   private
   public :: next_turn, turns_within, same_time

   !> Times nearer than this share of the period are one.
   real(wp), parameter :: same_time = 1.0e-9_wp

contains

   !> Whether the answer depends on the way.
   logical function has_history(model, plan)
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      integer :: pair, i

      has_history = plan%path == path_of%nonlinear
      do pair = 1, size(model%pair)
         if (has_history) return
         has_history = pair_slides_with_friction(model, pair) &
            & .or. model%interaction(model%pair(pair)%interaction)%no_separation
      end do
      do i = 1, size(model%material)
         has_history = has_history .or. flows(model%material(i)%flow)
      end do
   end function has_history

   !> The next point of an amplitude in use after `time`, in step time; the end if there is none.
   real(wp) function next_turn(model, plan, step, start, time) result(turn)
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: start            !! total time where the step begins [time]
      real(wp), intent(in) :: time             !! in the step [time]
      real(wp), allocatable :: point(:)

      turn = step%period
      call list_points(model, plan, step, start, point)
      point = pack(point, point > time + same_time*step%period)
      if (size(point) > 0) turn = min(turn, minval(point))
   end function next_turn

   !> How many there are within the step: increments that INC= does not count.
   integer function turns_within(model, plan, step, start) result(n)
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: start            !! total time where the step begins [time]
      real(wp), allocatable :: point(:)

      call list_points(model, plan, step, start, point)
      n = count(point > same_time*step%period .and. point < (1.0_wp - same_time)*step%period)
   end function turns_within

   !> Times of the points of all amplitudes in use, before, in and after the step.
   subroutine list_points(model, plan, step, start, point)
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: start
      real(wp), allocatable, intent(out) :: point(:)   !! in step time [time]
      integer :: a

      allocate (point(0))
      if (size(model%amplitude) == 0) return
      if (.not. has_history(model, plan)) return
      do a = 1, size(model%amplitude)
         if (.not. uses(step, a)) cycle
         point = [point, model%amplitude(a)%time - merge(start, 0.0_wp, &
            & model%amplitude(a)%total_time)]
      end do
   end subroutine list_points

   pure logical function uses(step, amplitude)
      type(step_type), intent(in) :: step
      integer, intent(in) :: amplitude

      uses = any(step%prescribed%amplitude == amplitude) &
         & .or. any(step%point_load%amplitude == amplitude) &
         & .or. any(step%face_load%amplitude == amplitude) &
         & .or. any(step%body_load%amplitude == amplitude)
      if (allocated(step%temperature)) uses = uses .or. any(step%temperature%amplitude == amplitude)
   end function uses
end module lopin_turning_points
