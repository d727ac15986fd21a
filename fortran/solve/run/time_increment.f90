!> The length of increments: cut where one fails, grown where few iterations did, ended at the
!> points of amplitudes. The loop over attempts is `advance` of lopin_run_analysis.
module lopin_time_increment
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code
   use lopin_text, only : to_text
   use lopin_interrupt, only : is_interrupted, answer_interrupt
   use lopin_model, only : model_type, step_type
   use lopin_report, only : frame_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_plan, only : plan_type, path_of
   use lopin_turning_points, only : next_turn, same_time
   use lopin_repeated_messages, only : note_once
   use lopin_refuse_passage, only : passage_id
   use lopin_refuse_turn, only : turn_id, most_turn
   use lopin_torn_ties, only : torn_id
   use lopin_held_points, only : held_id
   use lopin_first_increment, only : first_id
   use lopin_lagged_friction, only : reads_lagged
   use lopin_limit_increment, only : transfer_id
   use lopin_refuse_lost_rows, only : lost_row_id
   use lopin_driven_flow, only : driven_id
   use lopin_falling_power, only : part_by_power
   use lopin_touch_order, only : order_id, parts_of_touch
   use lopin_scene, only : scene_type
   use lopin_contact_friction, only : slides_with_friction
   use lopin_run_type, only : run_type
   use lopin_state, only : clock_state_type
   use lopin_tell_watcher, only : tell_of_attempt, tell_of_cut
   use lopin_increment, only : reject, say
   implicit none
   private
   public :: attempt_type, first_attempt, set_attempt, cut_increment, end_attempts, grow

   !> An increment that Newton does not end is cut to the first share, and where it fails again, or
   !> is refused, to the second; one that took few iterations grows, up to what was usual lately
   !> faster than beyond; none is smaller than the last, beside the period, unless the deck says
   !> otherwise.
   real(wp), parameter :: first_cut = 0.5_wp, cut = 0.25_wp, smallest = 1.0e-6_wp
   real(wp), parameter :: growth = 1.5_wp, regrowth = 3.0_wp
   character(len=*), parameter :: vain_ids(2) = ['E0510', 'E0511']
   integer, parameter :: few_iterations = 8
   !> Increments below this share of the period grow after more: hundreds of them cost more than an
   !> attempt that fails.
   real(wp), parameter :: short = 0.01_wp
   integer, parameter :: some_iterations = 15
   !> What friction reads of the last iteration converges by a factor an iteration.
   integer, parameter :: few_of_lagged = 24
   !> Increments that were large once count for less, the longer ago that is.
   real(wp), parameter :: fading = 0.8_wp
   !> Plastic strain that increments grow up to.
   real(wp), parameter :: steady_flow = 0.1_wp
   !> Angle of tools that slide, beside the largest, that increments grow up to.
   real(wp), parameter :: steady_turn = 0.95_wp

   !> What the attempts at one increment share.
   type :: attempt_type
      real(wp) :: turn = 0.0_wp                !! next point of an amplitude, in the step [time]
      real(wp) :: wanted = 0.0_wp              !! length before that point cut it [time]
      logical :: turns = .false.               !! it ends there
   end type attempt_type

contains

   !> Before the first attempt at an increment.
   subroutine first_attempt(self, run, model)
      type(attempt_type), intent(out) :: self
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model

      associate (clock => run%scene%accepted%clock, step => model%step(run%scene%step))
         run%frame%attempt = 1
         run%scene%newton%sized = 0
         self%turn = next_turn(model, run%plan, step, clock%start, clock%time)
         ! Where the way to the first touch was cut, increments go there first.
         if (clock%time < clock%parts_from - same_time*step%period) then
            clock%increment = min(clock%increment, clock%parts_from - clock%time)
         else if (clock%time < clock%parts_until - same_time*step%period) then
            clock%increment = min(clock%increment, clock%part)
         end if
      end associate
   end subroutine first_attempt

   !> The end of the increment, from its length and the points of amplitudes; told to the frame and
   !> to what solves it.
   subroutine set_attempt(self, run, model)
      type(attempt_type), intent(inout) :: self
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      real(wp) :: target_time

      associate (scene => run%scene, frame => run%frame, clock => run%scene%accepted%clock, &
         & step => model%step(run%scene%step), &
         & time => run%scene%accepted%clock%time, increment => run%scene%accepted%clock%increment)
         self%wanted = increment
         target_time = time + increment
         self%turns = self%turn < target_time - same_time*step%period
         if (self%turns) target_time = self%turn
         if (target_time + 1.0e-9_wp*increment >= step%period) target_time = step%period
         increment = target_time - time
         frame%step = scene%step
         frame%step_time = target_time
         frame%total_time = clock%start + target_time
         frame%time_increment = increment
         frame%last_of_step = .not. target_time < step%period
         scene%may_part = .not. (step%direct .or. time < clock%parts_until &
            & - same_time*step%period)
         scene%least_part = max(merge(0.0_wp, step%smallest, step%direct), &
            & smallest*step%period)/increment
         scene%may_cut = .not. step%direct .and. cut*increment >= max(step%smallest, &
            & smallest*step%period)
         scene%newton%dt = increment
         scene%newton%time = target_time
         scene%newton%attempt = frame%attempt - scene%newton%sized
         call tell_of_attempt(scene, model, frame)
      end associate
   end subroutine set_attempt

   !> After an attempt that has failed: the error goes where a shorter one may be tried; it stays
   !> where the increment cannot be cut, or was solved and is refused by its certificate.
   subroutine cut_increment(run, model, recorders, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(inout) :: error
      character(len=:), allocatable :: begin
      real(wp) :: part

      associate (scene => run%scene, frame => run%frame, clock => run%scene%accepted%clock)
         if (is_interrupted()) call answer_interrupt(error)
         if (frame%certificate%verdict == 2) return
         if (.not. may_cut(run%plan, scene, error)) return
         call reject(scene)
         call tell_of_cut(scene, model, frame, error%item(1)%message)
         if (scene%newton%in_vain) then
            clock%vain_motions = clock%vain_motions + 1
            clock%vain = max(clock%vain, clock%increment)
         end if
         begin = 'step '//to_text(scene%step)//', increment '//to_text(frame%increment)
         if (error%item(1)%id == order_id) then
            call go_by_parts(clock, scene%first_touch)
            call say(recorders, begin//': by parts, because '//error%item(1)%message)
            deallocate (error)
            return
         end if
         part = merge(first_cut, cut, scene%newton%attempt == 1 .and. &
            & any(error%item(1)%id == vain_ids))
         if (error%item(1)%id == first_id) then
            part = max(scene%newton%fit, model%step(scene%step)%smallest/clock%increment)
            scene%newton%sized = scene%newton%sized + 1
         end if
         if (error%item(1)%id == transfer_id) then
            part = scene%newton%fit
            if (.not. clock%time < clock%refused%until .or. clock%refused%pair &
               & /= scene%newton%refused%pair) clock%refused = scene%newton%refused
         end if
         if (any(error%item(1)%id == [lost_row_id, driven_id])) part = scene%newton%fit
         if (error%item(1)%id == turn_id) part = steady_turn*most_turn/scene%turned
         call say(recorders, begin//', attempt '//to_text(frame%attempt)//': cut to '// &
            & to_text(part*clock%increment, 4)//', because '//error%item(1)%message)
         if (any(error%item(1)%id == [passage_id, turn_id])) call note_once(scene%log, &
            & 'N0551', 'step '//to_text(scene%step)//' takes smaller increments: '// &
            & error%item(1)%message, model%step(scene%step)%at)
         deallocate (error)
         clock%increment = part*clock%increment
         frame%attempt = frame%attempt + 1
      end associate
   end subroutine cut_increment

   !> After the attempt that was accepted: what the next increment starts from.
   subroutine end_attempts(self, run, model)
      type(attempt_type), intent(in) :: self
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model

      associate (scene => run%scene, frame => run%frame, clock => run%scene%accepted%clock, &
         & step => model%step(run%scene%step))
         clock%usual = max(clock%increment, fading*clock%usual)
         if (scene%newton%jumped .or. .not. clock%increment < clock%vain) then
            clock%vain_motions = 0
            clock%vain = 0.0_wp
         end if
         if (self%turns) clock%increment = self%wanted
         if (step%direct) clock%increment = step%initial
         if (step%direct .and. self%turns .and. .not. frame%last_of_step) then
            ! Fixed increments go on in their places.
            clock%increment = self%wanted - frame%time_increment
            call note_once(scene%log, 'N0550', 'step '//to_text(scene%step)//': DIRECT '// &
               & 'increments also end at the points of amplitudes, first at time '// &
               & to_text(frame%step_time, 4)//', because the answer depends on the way', step%at)
         end if
      end associate
   end subroutine end_attempts

   !> The increment ends where contact begins; what is left of it is done in parts.
   pure subroutine go_by_parts(clock, first)
      type(clock_state_type), intent(inout) :: clock
      real(wp), intent(in) :: first            !! share of the increment before the touch

      clock%parts_from = clock%time + first*clock%increment
      clock%parts_until = clock%time + clock%increment
      clock%part = (1.0_wp - first)*clock%increment/parts_of_touch
      clock%increment = clock%part
      if (first*parts_of_touch > 1.0e-3_wp) clock%increment = first*(clock%parts_until - clock%time)
   end subroutine go_by_parts

   !> The next increment: larger after few iterations, up to what was usual faster than beyond, as
   !> long as the metal flows little in it, and does not end to flow at times that it cannot know.
   subroutine grow(increment, step, plan, frame, scene)
      real(wp), intent(inout) :: increment
      type(step_type), intent(in) :: step
      type(plan_type), intent(in) :: plan
      type(frame_type), intent(in) :: frame    !! of the last increment
      type(scene_type), intent(in) :: scene
      real(wp) :: flow                         !! largest plastic strain in it
      real(wp) :: turned                       !! tools against sliding points in it [rad]

      flow = scene%accepted%solids%most_strain
      turned = scene%turned
      ! The iterations of slow motion say nothing of the increment.
      if (.not. step%direct .and. (plan%path /= path_of%nonlinear .or. scene%newton%jumped &
         & .or. frame%iterations <= enough_iterations(scene, step, increment))) &
         & increment = max(growth*increment, min(regrowth*increment, &
         & scene%accepted%clock%usual))
      ! Behind a jump increments are what they were before it.
      if (scene%newton%passes) increment = max(increment, scene%accepted%clock%refused%length)
      if (.not. step%direct .and. flow > 0.0_wp) &
         & increment = min(increment, frame%time_increment*steady_flow/flow)
      if (.not. step%direct .and. turned > 0.0_wp) &
         & increment = min(increment, frame%time_increment*steady_turn*most_turn/turned)
      if (.not. step%direct) &
         & increment = min(increment, frame%time_increment*part_by_power(scene%accepted))
      if (step%largest > 0.0_wp) increment = min(increment, step%largest)
   end subroutine grow

   !> Iterations up to which the next increment may be longer.
   integer function enough_iterations(scene, step, increment) result(enough)
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: increment        !! the last [time]

      enough = merge(some_iterations, few_iterations, increment < short*step%period)
      if (reads_lagged(scene)) enough = max(enough, few_of_lagged)
   end function enough_iterations

   !> What did not converge may do so in smaller increments, where the path depends on them.
   logical function may_cut(plan, scene, error)
      type(plan_type), intent(in) :: plan
      type(scene_type), intent(in) :: scene
      type(error_type), intent(in) :: error

      may_cut = (plan%path == path_of%nonlinear .or. slides_with_friction(scene) &
         & .or. error%item(1)%id == passage_id) &
         & .and. error%code == error_code%not_converged &
         & .and. error%item(1)%id /= torn_id .and. error%item(1)%id /= held_id &
         & .and. scene%may_cut
   end function may_cut
end module lopin_time_increment
