!> The only loop a reader must understand: steps, increments, solve, certify, accept, record.
module lopin_run_analysis
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_text, only : to_text
   use lopin_clock, only : clock_type, counter_type
   use lopin_blas_threads, only : ready_blas
   use lopin_memory, only : peak_memory
   use lopin_model, only : model_type
   use lopin_state, only : frame_type, summary_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_follower_loading, only : new_followers
   use lopin_loading, only : new_loading, carry_loads
   use lopin_plan, only : plan_type, new_plan
   use lopin_scene, only : scene_type, new_scene, set_supports
   use lopin_uneven_pressure, only : warn_of_uneven_pressure
   use lopin_reach, only : choose_reach
   use lopin_bodies, only : describe_motion
   use lopin_finite_start, only : start_step
   use lopin_release, only : held_type, remember_held, let_go
   use lopin_after_step, only : judge_step
   use lopin_artificial_work, only : judge_artificial
   use lopin_judge_drift, only : judge_drift
   use lopin_judge_flow, only : judge_flow
   use lopin_judge_mesh, only : refuse_folded
   use lopin_judge_yield, only : judge_yield
   use lopin_increment, only : progress_type, prepare, say
   use lopin_say_once, only : say_again
   use lopin_keeper, only : keeper_type
   use lopin_checkpoint, only : march_type
   use lopin_turning_points, only : turns_within
   use lopin_time_increment, only : advance, grow
   use lopin_keep_state, only : keep_state, go_back
   implicit none
   private
   public :: run_analysis

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
      integer :: i

      scene%clock = clock
      call scene%clock%start()
      summary%status = 'finished'
      summary%plan = ''
      summary%path = ''
      summary%solver = ''
      summary%checksum = ''
      allocate (summary%step(size(model%step)))
      call ready_blas(error)
      if (.not. allocated(error)) call begin_all(recorders, model, error, keeper)
      if (.not. allocated(error)) call new_plan(plan, model, error)
      if (.not. allocated(error)) call new_scene(scene, model, error)
      if (.not. allocated(error)) call warn_of_uneven_pressure(scene, model)
      if (.not. allocated(error)) call refuse_folded(scene, model, error)
      if (.not. allocated(error)) call choose_reach(scene, model)
      if (.not. allocated(error)) call run_steps(scene, model, plan, recorders, summary, log, &
         & error, keeper)
      call say_again(scene%log)
      do i = 1, scene%log%n
         associate (d => scene%log%item(i))
            call log%say(d%severity, d%id, d%message, d%at, d%label, d%note, d%help)
         end associate
      end do
      summary%clock = scene%clock
      summary%log = scene%log
      summary%peak_memory = peak_memory()
      call finish_all(recorders, model, summary, error, keeper)
      if (present(keeper) .and. .not. allocated(error)) call keeper%forget()
   end subroutine run_analysis

   !> Files are closed and on the disk before the summary says how the run ended.
   subroutine finish_all(recorders, model, summary, error, keeper)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(inout) :: error
      class(keeper_type), intent(inout), optional :: keeper
      type(error_type), allocatable :: trouble
      integer :: i

      if (present(keeper)) call keeper%settle(trouble)
      if (.not. allocated(error)) call move_alloc(trouble, error)
      do i = 1, size(recorders)
         call recorders(i)%recorder%close(trouble)
         if (.not. allocated(error)) call move_alloc(trouble, error)
      end do
      if (allocated(error)) then
         summary%status = 'failed'
         if (error%code == error_code%not_converged) summary%status = 'not converged'
         if (error%code == error_code%interrupted) summary%status = 'interrupted'
         summary%exit_code = error%code
         if (present(keeper)) call say_what_survives(error, keeper)
      end if
      do i = 1, size(recorders)
         call recorders(i)%recorder%finish(model, summary, error, trouble)
         if (.not. allocated(trouble)) cycle
         if (present(keeper)) call say_what_survives(trouble, keeper)
         if (.not. allocated(error)) call move_alloc(trouble, error)
      end do
   end subroutine finish_all

   !> Where memory or a disk ended the run: what is whole.
   subroutine say_what_survives(error, keeper)
      type(error_type), intent(inout) :: error
      class(keeper_type), intent(in) :: keeper

      associate (id => error%item(1)%id)
         if (id /= 'E0602' .and. id(:3) /= 'E07') return
      end associate
      error%item(1)%note = 'no file is torn; no checkpoint is there yet'
      if (allocated(keeper%kept)) error%item(1)%note = 'no file is torn, and the checkpoint after '// &
         & keeper%kept//' is whole'
   end subroutine say_what_survives

   !> The files of an earlier run, its checkpoint included, stay until those of this run are begun.
   subroutine begin_all(recorders, model, error, keeper)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      class(keeper_type), intent(inout), optional :: keeper
      logical :: resumes
      integer :: i

      resumes = .false.
      if (present(keeper)) resumes = allocated(keeper%found)
      do i = 1, size(recorders)
         recorders(i)%recorder%resumes = resumes
         call recorders(i)%recorder%begin(model, error)
         if (allocated(error)) return
      end do
      do i = 1, size(recorders)
         call recorders(i)%recorder%commit(error)
         if (allocated(error)) return
         ! The first file that is replaced ends the earlier run.
         if (i == 1 .and. present(keeper) .and. .not. resumes) call keeper%forget()
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
         keeper%kept = 'increment '//to_text(march%number)//' of step '//to_text(scene%step)
         call log%say(severity%note, 'N0604', 'goes on after '//keeper%kept)
         first = scene%step + 1
         call run_step(scene, model, plan, progress, march, recorders, summary, error, keeper)
         summary%step(scene%step)%counter = scene%counter
         if (allocated(error)) return
      end if
      do step = first, size(model%step)
         scene%counter = counter_type()
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
      integer :: number, most

      associate (step => model%step(scene%step))
         most = step%max_increments + turns_within(model, plan, step, progress%time)
         do number = march%number + 1, most
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
               & to_text(most)// &
               & ' increments that INC= allows', step%at, &
               & help='raise INC= on *STEP, or the increments on *STATIC')
         end if
         progress%time = progress%time + march%time
         if (scene%step < size(model%step)) call carry_loads(march%loading, model, scene%dofs, &
            & scene%constraints, &
            & scene%solids, step, model%step(scene%step + 1), progress%steady)
         call judge_step(scene, model, progress%seen, march%energy)
         if (scene%step < size(model%step)) return
         call judge_drift(progress%drift, scene, model)
         call judge_artificial(progress%artificial, scene, model, march%energy)
      end associate
   end subroutine run_step
end module lopin_run_analysis
