!> The only loop a reader must understand: steps, increments, solve, certify, accept, record.
module lopin_run_analysis
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type
   use lopin_text, only : to_text
   use lopin_clock, only : clock_type
   use lopin_memory, only : peak_memory
   use lopin_model, only : model_type, step_type
   use lopin_state, only : frame_type, summary_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_follower_loading, only : new_followers
   use lopin_loading, only : loading_type, new_loading, add_ended_loads
   use lopin_plan, only : plan_type, new_plan, path_of
   use lopin_scene, only : scene_type, new_scene, set_supports
   use lopin_bodies, only : describe_motion
   use lopin_path_finite, only : start_step
   use lopin_contact_friction, only : slides_with_friction
   use lopin_after_step, only : judge_step
   use lopin_judge_yield, only : judge_yield
   use lopin_increment, only : progress_type, solve_increment, reject, prepare, say
   implicit none
   private
   public :: run_analysis

   !> A failed increment is cut to this share; one that took few iterations grows; none is smaller
   !> than the last, beside the period, unless the deck says otherwise.
   real(wp), parameter :: cut = 0.25_wp, growth = 1.5_wp, smallest = 1.0e-6_wp
   integer, parameter :: few_iterations = 8

contains

   !> Run all steps. `log` gets the warnings of the run; `error` what ended it.
   subroutine run_analysis(model, recorders, clock, summary, log, error)
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(clock_type), intent(in) :: clock              !! with the time spent so far
      type(summary_type), intent(out) :: summary
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
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
      call begin_all(recorders, model, error)
      if (.not. allocated(error)) call new_plan(plan, model, error)
      if (.not. allocated(error)) call new_scene(scene, model, error)
      if (.not. allocated(error)) call run_steps(scene, model, plan, recorders, summary, error)
      do i = 1, scene%log%n
         associate (d => scene%log%item(i))
            call log%say(d%severity, d%id, d%message, d%at, d%label, d%note, d%help)
         end associate
      end do
      if (allocated(error)) then
         summary%status = 'failed'
         if (error%code == error_code%not_converged) summary%status = 'not converged'
         summary%exit_code = error%code
      end if
      summary%clock = scene%clock
      summary%log = scene%log
      summary%peak_memory = peak_memory()
      do i = 1, size(recorders)
         call recorders(i)%recorder%finish(model, summary, error, trouble)
         if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
      end do
   end subroutine run_analysis

   subroutine begin_all(recorders, model, error)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(recorders)
         call recorders(i)%recorder%begin(model, error)
         if (allocated(error)) return
      end do
   end subroutine begin_all

   subroutine run_steps(scene, model, plan, recorders, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(progress_type) :: progress
      integer :: step
      logical :: same

      allocate (progress%steady(scene%dofs%n), progress%f(scene%dofs%n), &
         & progress%residual(scene%dofs%n), &
         & progress%f_before(scene%dofs%n), progress%u_before(scene%dofs%n), &
         & progress%r_before(scene%dofs%n), &
         & source=0.0_wp)
      do step = 1, size(model%step)
         scene%counter%factorisations = 0
         scene%counter%back_solves = 0
         scene%counter%iterations = 0
         scene%counter%augmentations = 0
         call set_supports(scene, model, step, same, error)
         if (allocated(error)) return
         if (.not. same) then
            call check_supports(scene, model, error)
            if (allocated(error)) return
            call prepare(scene, model, plan, recorders, summary, error)
            if (allocated(error)) return
         end if
         call run_step(scene, model, plan, progress, recorders, summary, error)
         summary%step(step)%counter = scene%counter
         if (allocated(error)) return
      end do
   end subroutine run_steps

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

   subroutine run_step(scene, model, plan, progress, recorders, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(loading_type) :: loading
      type(frame_type) :: frame
      real(wp) :: time, increment
      integer :: number

      frame%last_of_step = .false.
      associate (step => model%step(scene%step))
         call new_loading(loading, model, scene%dofs, scene%constraints, scene%solids, step, &
            & progress%time, &
            & progress%steady, scene%accepted)
         time = 0.0_wp
         increment = min(step%initial, step%period)
         call start_step(scene, model)
         if (step%nlgeom) call new_followers(scene%finite%follower, step, progress%time, &
            & scene%dofs%n)
         do number = 1, step%max_increments
            frame%increment = number
            call advance(scene, model, plan, loading, progress, recorders, summary, time, &
               & increment, frame, error)
            if (allocated(error)) return
            call judge_yield(scene, model, frame%u)
            summary%step(scene%step)%increments = number
            if (frame%last_of_step) exit
            if (.not. step%direct .and. (plan%path /= path_of%finite &
               & .or. frame%iterations <= few_iterations)) increment = growth*increment
            if (step%largest > 0.0_wp) increment = min(increment, step%largest)
         end do
         if (.not. frame%last_of_step) then
            call raise(error, error_code%not_converged, 'E0503', 'step '//to_text(scene%step)// &
               & ' reached time '// &
               & to_text(time)//' of '//to_text(step%period)//' in the '// &
               & to_text(step%max_increments)// &
               & ' increments that INC= allows', step%at, &
               & help='raise INC= on *STEP, or the increments on *STATIC')
         end if
         progress%time = progress%time + time
         if (scene%step < size(model%step)) call add_ended_loads(loading, model, scene%dofs, &
            & scene%constraints, &
            & scene%solids, step, model%step(scene%step + 1), progress%steady)
         call judge_step(scene, model, progress%seen)
      end associate
   end subroutine run_step

   !> One increment from `time`: tried, cut and tried again until it is accepted or cannot be cut.
   subroutine advance(scene, model, plan, loading, progress, recorders, summary, time, increment, &
      & frame, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(loading_type), intent(in) :: loading
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      real(wp), intent(inout) :: time, increment
      type(frame_type), intent(inout) :: frame
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: target_time

      associate (step => model%step(scene%step))
         frame%attempt = 1
         do
            target_time = time + increment
            if (time + increment*(1.0_wp + 1.0e-9_wp) >= step%period) target_time = step%period
            increment = target_time - time
            frame%step = scene%step
            frame%step_time = target_time
            frame%total_time = progress%time + target_time
            frame%time_increment = increment
            frame%last_of_step = .not. target_time < step%period
            scene%finite%dt = increment
            call solve_increment(scene, model, plan, loading, progress, recorders, summary, frame, &
               & error)
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
