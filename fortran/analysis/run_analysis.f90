!> The only loop a reader must understand: steps, increments, solve, certify, accept, record.
module lopin_run_analysis
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_interrupt, only : is_interrupted
   use lopin_stream, only : stream_type
   use lopin_text, only : to_text
   use lopin_clock, only : clock_type, phase
   use lopin_memory, only : peak_memory
   use lopin_model, only : model_type, step_type
   use lopin_state, only : frame_type, summary_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_follower_loading, only : new_followers
   use lopin_loading, only : new_loading, add_ended_loads
   use lopin_plan, only : plan_type, new_plan, path_of
   use lopin_scene, only : scene_type, new_scene, set_supports
   use lopin_reach, only : choose_reach
   use lopin_bodies, only : describe_motion
   use lopin_path_finite, only : start_step
   use lopin_release, only : held_type, remember_held, let_go
   use lopin_contact_friction, only : slides_with_friction
   use lopin_after_step, only : judge_step
   use lopin_judge_flow, only : judge_flow
   use lopin_judge_yield, only : judge_yield
   use lopin_increment, only : progress_type, solve_increment, reject, prepare, say
   use lopin_keeper, only : keeper_type
   use lopin_checkpoint, only : march_type, keep_run
   implicit none
   private
   public :: run_analysis

   !> A failed increment is cut to this share; one that took few iterations grows; none is smaller
   !> than the last, beside the period, unless the deck says otherwise.
   real(wp), parameter :: cut = 0.25_wp, growth = 1.5_wp, smallest = 1.0e-6_wp
   integer, parameter :: few_iterations = 8
   !> Plastic strain that increments grow up to.
   real(wp), parameter :: steady_flow = 0.1_wp

contains

   !> Run all steps. `log` gets the warnings of the run; `error` what ended it. With a keeper the
   !> state is kept after increments, and a run that was broken off goes on from it.
   subroutine run_analysis(model, recorders, clock, summary, log, error, keeper)
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(clock_type), intent(in) :: clock              !! with the time spent so far
      type(summary_type), intent(out) :: summary
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      class(keeper_type), intent(inout), optional :: keeper
      type(scene_type) :: scene
      type(plan_type) :: plan
      type(error_type), allocatable :: trouble
      integer :: i

      scene%clock = clock
      call scene%clock%start()
      summary%status = 'finished'
      summary%plan = ''
      summary%path = ''
      summary%solver = ''
      summary%checksum = ''
      allocate (summary%step(size(model%step)))
      call begin_all(recorders, model, error, keeper)
      if (.not. allocated(error)) call new_plan(plan, model, error)
      if (.not. allocated(error)) call new_scene(scene, model, error)
      if (.not. allocated(error)) call choose_reach(scene, model)
      if (.not. allocated(error)) call run_steps(scene, model, plan, recorders, summary, log, &
         & error, keeper)
      do i = 1, scene%log%n
         associate (d => scene%log%item(i))
            call log%say(d%severity, d%id, d%message, d%at, d%label, d%note, d%help)
         end associate
      end do
      if (allocated(error)) then
         summary%status = 'failed'
         if (error%code == error_code%not_converged) summary%status = 'not converged'
         if (error%code == error_code%interrupted) summary%status = 'interrupted'
         summary%exit_code = error%code
      end if
      summary%clock = scene%clock
      summary%log = scene%log
      summary%peak_memory = peak_memory()
      do i = 1, size(recorders)
         call recorders(i)%recorder%finish(model, summary, error, trouble)
         if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
      end do
      if (present(keeper) .and. .not. allocated(error)) call keeper%forget()
   end subroutine run_analysis

   subroutine begin_all(recorders, model, error, keeper)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      class(keeper_type), intent(inout), optional :: keeper
      logical :: resumes
      integer :: i

      resumes = .false.
      if (present(keeper)) then
         resumes = allocated(keeper%found)
         if (.not. resumes) call keeper%forget()
      end if
      do i = 1, size(recorders)
         recorders(i)%recorder%resumes = resumes
         call recorders(i)%recorder%begin(model, error)
         if (allocated(error)) return
      end do
   end subroutine begin_all

   subroutine run_steps(scene, model, plan, recorders, summary, log, error, keeper)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      class(keeper_type), intent(inout), optional :: keeper
      type(progress_type) :: progress
      type(march_type) :: march
      type(held_type) :: held
      integer :: step, first
      logical :: same, resumes

      allocate (progress%steady(scene%dofs%n), progress%f(scene%dofs%n), &
         & progress%residual(scene%dofs%n), &
         & progress%f_before(scene%dofs%n), progress%u_before(scene%dofs%n), &
         & progress%r_before(scene%dofs%n), &
         & source=0.0_wp)
      first = 1
      resumes = .false.
      if (present(keeper)) resumes = allocated(keeper%found)
      if (resumes) then
         call go_back(keeper%found, model, scene, plan, progress, march, recorders, summary, error)
         if (allocated(error)) return
         call log%say(severity%note, 'N0604', 'goes on after increment '// &
            & to_text(march%number)//' of step '//to_text(scene%step))
         first = scene%step + 1
         call run_step(scene, model, plan, progress, march, recorders, summary, error, keeper)
         summary%step(scene%step)%counter = scene%counter
         if (allocated(error)) return
      end if
      do step = first, size(model%step)
         scene%counter%factorisations = 0
         scene%counter%back_solves = 0
         scene%counter%iterations = 0
         scene%counter%augmentations = 0
         if (step > 1) call remember_held(held, scene)
         call set_supports(scene, model, step, same, error)
         if (allocated(error)) return
         if (.not. same) then
            call check_supports(scene, model, error)
            if (allocated(error)) return
            call prepare(scene, model, plan, recorders, summary, error)
            if (allocated(error)) return
         end if
         call start_march(march, scene, model, progress)
         if (step > 1) call let_go(held, scene, model, progress%residual, march%loading%before, &
            & progress%f_before, error)
         if (allocated(error)) return
         call run_step(scene, model, plan, progress, march, recorders, summary, error, keeper)
         summary%step(step)%counter = scene%counter
         if (allocated(error)) return
      end do
   end subroutine run_steps

   !> To the state that an earlier run kept; its files are cut to what they were then.
   subroutine go_back(stream, model, scene, plan, progress, march, recorders, summary, error)
      type(stream_type), intent(inout) :: stream
      type(model_type), intent(in) :: model
      type(scene_type), intent(inout) :: scene
      type(plan_type), intent(inout) :: plan
      type(progress_type), intent(inout) :: progress
      type(march_type), intent(inout) :: march
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error

      stream%reading = .true.
      call keep_run(stream, model, scene, plan, progress, march, summary, error)
      if (.not. allocated(error)) call keep_recorders(recorders, stream, error)
      if (allocated(error)) return
      if (stream%broken .or. .not. stream%ended()) call raise(error, error_code%resource, &
         & 'E0604', 'the checkpoint does not hold what this build of Lopin keeps', &
         & help='run the deck without --resume')
   end subroutine go_back

   subroutine keep_recorders(recorders, stream, error)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(recorders)
         call recorders(i)%recorder%keep(stream, error)
         if (allocated(error)) return
      end do
   end subroutine keep_recorders

   !> Keep the state if it is due, or if the run is to end here; then that is the error.
   subroutine keep_state(scene, model, plan, progress, march, recorders, summary, error, keeper)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(progress_type), intent(inout) :: progress
      type(march_type), intent(inout) :: march
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      class(keeper_type), intent(inout), optional :: keeper
      type(stream_type) :: stream
      logical :: ends, due

      if (.not. present(keeper)) return
      if (march%at_end .and. scene%step == size(model%step)) return
      ends = is_interrupted()
      associate (every => model%step(scene%step)%checkpoint)
         due = every > 0
         if (due) due = march%at_end .or. mod(march%number, every) == 0
      end associate
      if (.not. (due .or. ends)) return
      call keep_run(stream, model, scene, plan, progress, march, summary, error)
      if (.not. allocated(error)) call keep_recorders(recorders, stream, error)
      if (.not. allocated(error)) call keeper%save(stream, error)
      call scene%clock%stop_in(phase%output)
      if (allocated(error) .or. .not. ends) return
      call raise(error, error_code%interrupted, 'E0605', 'interrupted after increment '// &
         & to_text(march%number)//' of step '//to_text(scene%step)//', which is kept', &
         & help='the same command with --resume goes on from there')
   end subroutine keep_state

   !> From rest to the step in force.
   subroutine start_march(march, scene, model, progress)
      type(march_type), intent(out) :: march
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(progress_type), intent(in) :: progress

      associate (step => model%step(scene%step))
         call new_loading(march%loading, model, scene%dofs, scene%constraints, scene%solids, &
            & step, progress%time, progress%steady, scene%accepted)
         march%increment = min(step%initial, step%period)
         call start_step(scene, model)
         if (step%nlgeom) call new_followers(scene%finite%follower, step, progress%time, &
            & scene%dofs%n)
      end associate
   end subroutine start_march

   !> Without contact nothing may float.
   subroutine check_supports(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: q(:)

      if (scene%bodies%nq == 0 .or. any(scene%points%facet(:scene%points%n) > 0)) return
      allocate (q(scene%bodies%nq), source=0.0_wp)
      q(1) = 1.0_wp
      call raise(error, error_code%singular, 'E0310', describe_motion(scene%bodies, model, q)// &
         & ': nothing holds it', &
         & model%step(scene%step)%at, note=to_text(scene%bodies%nq)//' rigid motions are free', &
         & help='fix degrees of freedom by *BOUNDARY, or add the contact that holds the body')
   end subroutine check_supports

   !> The increments of a step that are still to be done.
   subroutine run_step(scene, model, plan, progress, march, recorders, summary, error, keeper)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(progress_type), intent(inout) :: progress
      type(march_type), intent(inout) :: march
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      class(keeper_type), intent(inout), optional :: keeper
      type(frame_type) :: frame
      integer :: number

      associate (step => model%step(scene%step))
         do number = march%number + 1, step%max_increments
            if (march%at_end) exit
            frame%increment = number
            call advance(scene, model, plan, march, progress, recorders, summary, frame, error)
            if (allocated(error)) return
            call judge_yield(scene, model, frame%u)
            call judge_flow(scene, model)
            summary%step(scene%step)%increments = number
            march%number = number
            march%at_end = frame%last_of_step
            march%energy = frame%energy
            if (.not. march%at_end) call grow(march%increment, step, plan, &
               & frame, scene%finite%memory%most_strain)
            call keep_state(scene, model, plan, progress, march, recorders, summary, error, keeper)
            if (allocated(error)) return
         end do
         if (.not. march%at_end) then
            call raise(error, error_code%not_converged, 'E0503', 'step '//to_text(scene%step)// &
               & ' reached time '// &
               & to_text(march%time)//' of '//to_text(step%period)//' in the '// &
               & to_text(step%max_increments)// &
               & ' increments that INC= allows', step%at, &
               & help='raise INC= on *STEP, or the increments on *STATIC')
         end if
         progress%time = progress%time + march%time
         if (scene%step < size(model%step)) call add_ended_loads(march%loading, model, scene%dofs, &
            & scene%constraints, &
            & scene%solids, step, model%step(scene%step + 1), progress%steady)
         call judge_step(scene, model, progress%seen, march%energy)
      end associate
   end subroutine run_step

   !> One increment from `time`: tried, cut and tried again until it is accepted or cannot be cut.
   subroutine advance(scene, model, plan, march, progress, recorders, summary, frame, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(march_type), intent(inout) :: march
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(frame_type), intent(inout) :: frame
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: target_time

      associate (step => model%step(scene%step), time => march%time, &
         & increment => march%increment)
         frame%attempt = 1
         do
            target_time = time + increment
            if (scene%finite%memory%in_use .and. .not. step%direct) target_time = min(target_time, &
               & next_turn(model, step, progress%time, time))
            if (target_time + 1.0e-9_wp*increment >= step%period) target_time = step%period
            increment = target_time - time
            frame%step = scene%step
            frame%step_time = target_time
            frame%total_time = progress%time + target_time
            frame%time_increment = increment
            frame%last_of_step = .not. target_time < step%period
            scene%finite%dt = increment
            scene%finite%time = target_time
            call solve_increment(scene, model, plan, march%loading, progress, recorders, &
               & summary, frame, error)
            if (.not. allocated(error)) exit
            if (frame%certificate%verdict == 2) return
            if (.not. may_cut(plan, scene, step, increment, error)) return
            call reject(scene)
            call say(recorders, 'step '//to_text(scene%step)//', increment '// &
               & to_text(frame%increment)//', attempt '//to_text(frame%attempt)//': cut to '// &
               & to_text(cut*increment, 4)//', because '//error%item(1)%message)
            deallocate (error)
            increment = cut*increment
            frame%attempt = frame%attempt + 1
         end do
         time = target_time
      end associate
   end subroutine advance

   !> The next point of an amplitude in use, in step time: what flows remembers each of them.
   pure real(wp) function next_turn(model, step, start, time) result(turn)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: start            !! total time where the step begins [time]
      real(wp), intent(in) :: time             !! in the step [time]
      real(wp), allocatable :: point(:)
      integer :: a

      turn = step%period
      do a = 1, size(model%amplitude)
         if (.not. (any(step%prescribed%amplitude == a) .or. any(step%point_load%amplitude == a) &
            & .or. any(step%face_load%amplitude == a) .or. any(step%body_load%amplitude == a))) cycle
         allocate (point, source=model%amplitude(a)%time)
         if (model%amplitude(a)%total_time) point = point - start
         point = pack(point, point > time + 1.0e-9_wp*step%period)
         if (size(point) > 0) turn = min(turn, minval(point))
         deallocate (point)
      end do
   end function next_turn

   !> The next increment: larger after few iterations, as long as the metal flows little in it.
   subroutine grow(increment, step, plan, frame, flow)
      real(wp), intent(inout) :: increment
      type(step_type), intent(in) :: step
      type(plan_type), intent(in) :: plan
      type(frame_type), intent(in) :: frame    !! of the last increment
      real(wp), intent(in) :: flow             !! largest plastic strain in it

      if (.not. step%direct .and. (plan%path /= path_of%finite &
         & .or. frame%iterations <= few_iterations)) increment = growth*increment
      if (.not. step%direct .and. flow > 0.0_wp) &
         & increment = min(increment, frame%time_increment*steady_flow/flow)
      if (step%largest > 0.0_wp) increment = min(increment, step%largest)
   end subroutine grow

   !> What did not converge may do so in smaller increments, where the path depends on them.
   logical function may_cut(plan, scene, step, increment, error)
      type(plan_type), intent(in) :: plan
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: increment
      type(error_type), intent(in) :: error

      may_cut = (plan%path == path_of%finite .or. slides_with_friction(scene)) &
         & .and. error%code == error_code%not_converged &
         & .and. .not. step%direct &
         & .and. cut*increment >= max(step%smallest, smallest*step%period)
   end function may_cut

end module lopin_run_analysis
