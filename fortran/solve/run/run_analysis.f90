!> The only loop a reader must understand: steps, increments, attempts; each attempt is solved,
!> certified, accepted and recorded by `solve_increment` (lopin_increment).
module lopin_run_analysis
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_clock, only : clock_type, phase, counter_type
   use lopin_blas_threads, only : ready_blas
   use lopin_memory, only : peak_memory
   use lopin_model, only : model_type, step_type
   use lopin_report, only : frame_type, summary_type, new_summary
   use lopin_recorder, only : recorder_holder_type
   use lopin_follower_loading, only : follow_steps, new_followers, leave_followers
   use lopin_loading, only : loading_type, new_loading, carry_loads
   use lopin_plan, only : new_plan
   use lopin_run_type, only : run_type
   use lopin_state, only : state_type, clock_state_type, begin, begin_step_of
   use lopin_scene, only : scene_type, set_supports
   use lopin_body_words, only : describe_motion
   use lopin_nonlinear_start, only : start_step
   use lopin_released_forces, only : supports_type, record_supports, release_pairs, &
      & add_released_forces, releases_support
   use lopin_end_of_step, only : check_end_of_step
   use lopin_check_flow_curves, only : check_flow_curves
   use lopin_check_yield, only : check_yield
   use lopin_failure_advice, only : advise
   use lopin_solve_path, only : note_solver
   use lopin_increment, only : solve_increment, prepare, reject
   use lopin_repeated_messages, only : report_repeats
   use lopin_stream, only : stream_type
   use lopin_checkpoint_store, only : checkpoint_store_type
   use lopin_turning_points, only : turns_within
   use lopin_falling_power, only : note_power
   use lopin_time_increment, only : attempt_type, first_attempt, set_attempt, cut_increment, &
      & end_attempts, grow
   use lopin_checkpointing, only : save_checkpoint, keep_for_resume
   use lopin_run_files, only : begin_files, finish_files
   use lopin_run_state, only : run_state, resume_run, make_workspace
   implicit none
   private
   public :: open_run, advance_run, close_run, run_analysis

contains

   !> Run all steps. `log` gets the warnings of the run; `error` what ended it. With a store the
   !> state is kept after increments, and a run that was broken off resumes from it.
   subroutine run_analysis(model, recorders, clock, summary, log, error, store)
      type(model_type), intent(inout) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(clock_type), intent(in) :: clock              !! with the time spent so far
      type(summary_type), intent(out) :: summary
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      class(run_type), allocatable :: run
      logical :: more

      allocate (run_type :: run)
      call open_run(run, model, recorders, clock, log, error, store)
      more = .not. allocated(error)
      do while (more)
         call advance_run(run, model, recorders, more, error, store)
      end do
      call close_run(run, model, recorders, log, error, store)
      summary = run%summary
   end subroutine run_analysis

   !> Begin the files of a run that was just allocated, and make what the model needs. The run goes
   !> on from a state that the store found, or from `state`, of the same deck, in new files.
   subroutine open_run(self, model, recorders, clock, log, error, store, state)
      class(run_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(clock_type), intent(in) :: clock              !! with the time spent so far
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      type(stream_type), intent(inout), optional :: state   !! of `run_state`

      allocate (self%scene)
      self%scene%clock = clock
      call self%scene%clock%start()
      call new_summary(self%summary, size(model%step))
      call ready_blas(error)
      if (.not. allocated(error)) call refuse_remeshing(model, error)
      if (.not. allocated(error)) call begin_files(recorders, model, error, store)
      call self%scene%clock%stop_in(phase%output)
      if (.not. allocated(error)) call new_plan(self%plan, model, error)
      call self%scene%clock%stop_in(phase%model)
      if (.not. allocated(error)) call make_workspace(self%scene, model, self%plan, error)
      if (allocated(error)) return
      if (present(state)) then
         call run_state(self, model, state, error)
      else if (present(store)) then
         if (allocated(store%found)) call resume_run(self, model, recorders, log, store, error)
      end if
      if (allocated(error)) return
      if (model%start%step > 0 .and. self%scene%step == 0) call begin_midway(self, model, &
         & recorders, error)
      self%may_step = .not. allocated(error)
   end subroutine open_run

   !> Go to the next accepted increment, into the next step if need be. Where the run is at its end
   !> nothing is done, and `more` is false.
   subroutine advance_run(self, model, recorders, more, error, store)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      logical, intent(out) :: more             !! an increment was accepted
      type(error_type), allocatable, intent(out) :: error
      class(checkpoint_store_type), intent(inout), optional :: store

      more = .false.
      if (.not. self%in_step) then
         if (self%scene%step == size(model%step)) return
         call begin_step(self, model, recorders, error)
      end if
      if (.not. allocated(error)) call next_increment(self, model, recorders, error, store)
      if (self%scene%step > 0) self%summary%step(self%scene%step)%counter = self%scene%counter
      more = .not. allocated(error)
      self%may_step = more
      if (more) return
      if (error%code /= error_code%interrupted) return
      ! The increment in hand is given up; what was accepted may go on.
      call reject(self%scene)
      self%may_step = .true.
      if (present(store)) call keep_for_resume(store, error)
   end subroutine advance_run

   !> Warnings to the log, files to their end, also after an error. A run that was left before its
   !> end is `stopped`, and its checkpoint stays.
   subroutine close_run(self, model, recorders, log, error, store)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(inout) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      integer :: i
      logical :: done

      done = .not. self%in_step .and. self%scene%step == size(model%step)
      if (.not. done) self%summary%status = 'stopped'
      call report_repeats(self%scene%log)
      do i = 1, self%scene%log%n
         associate (d => self%scene%log%item(i))
            call log%say(d%severity, d%id, d%message, d%at, d%label, d%note, d%help)
         end associate
      end do
      call note_solver(self%scene, self%summary)
      self%summary%clock = self%scene%clock
      self%summary%log = self%scene%log
      self%summary%peak_memory = peak_memory()
      call finish_files(recorders, model, self%summary, error, store)
      if (present(store) .and. done .and. .not. allocated(error)) call store%forget()
      self%may_step = .false.
   end subroutine close_run

   !> Supports, loads and, where supports change, the factors of the step that follows.
   subroutine begin_step(self, model, recorders, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      type(supports_type) :: held
      integer :: step
      logical :: same

      associate (scene => self%scene)
         step = scene%step + 1
         scene%counter = counter_type()
         if (step > 1) call record_supports(held, scene)
         call set_supports(scene, model, step, same, error)
         if (allocated(error)) return
         self%in_step = .true.
         self%frame = frame_type()
         if (.not. same) then
            call check_supports(scene, model, error)
            if (allocated(error)) return
            call prepare(self, model, recorders, error)
            if (allocated(error)) return
         end if
         call start_loading(self%loading, scene, model)
         if (step > 1) self%watch%balance%springs_back = releases_support(held, scene)
         if (step > 1) call add_released_forces(held, scene, model, &
            & self%loading%before)
         scene%accepted%loads%before = self%loading%before
         scene%accepted%loads%from = self%loading%from
      end associate
   end subroutine begin_step

   !> The executable has no mesher.
   subroutine refuse_remeshing(model, error)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      integer :: i

      do i = 1, size(model%material)
         if (model%remeshes .or. .not. allocated(model%material(i)%damage)) cycle
         if (.not. any(model%material(i)%damage%critical > 0.0_wp)) cycle
         call raise(error, error_code%deck, 'E0620', 'material '//model%material(i)%name// &
            & ' separates (*DAMAGE, CRITICAL), and that is done with *REMESH', &
            & model%material(i)%at, help='add *REMESH, ELSET= and run the deck by `lopin run` '// &
            & 'of the Python package; or leave CRITICAL out')
         return
      end do
      if (.not. model%remeshes) return
      call raise(error, error_code%deck, 'E0620', '*REMESH needs the command of the Python '// &
         & 'package', model%remesh_at, help='run the deck by `lopin run` of the package with '// &
         & "lopin[remesh] installed; the parts of a run that was remeshed are decks of their own")
   end subroutine refuse_remeshing

   !> Into the middle of a step, where the part of the run before has ended.
   subroutine begin_midway(self, model, recorders, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      logical :: same
      integer :: i, id

      associate (scene => self%scene, accepted => self%scene%accepted, start => model%start)
         call set_supports(scene, model, start%step, same, error)
         if (allocated(error)) return
         self%in_step = .true.
         accepted%clock%start = start%begun
         do i = 1, size(start%displaced)
            id = scene%dofs%id(start%displaced(i)%dof, start%displaced(i)%node)
            if (id == 0) cycle
            accepted%motion%u(id) = start%displaced(i)%begun
            accepted%loads%steady(id) = start%displaced(i)%force
         end do
         call prepare(self, model, recorders, error)
         if (allocated(error)) return
         call follow_steps(scene%newton%follower, model, start%step - 1, scene%dofs%n)
         call start_loading(self%loading, scene, model)
         accepted%loads%before = self%loading%before
         accepted%loads%from = self%loading%from
         do i = 1, size(start%displaced)
            id = scene%dofs%id(start%displaced(i)%dof, start%displaced(i)%node)
            if (id > 0) accepted%motion%u(id) = start%displaced(i)%now
         end do
         accepted%clock%time = start%time
         accepted%clock%increment = start%rest
         call begin(scene%trial, accepted)
      end associate
   end subroutine begin_midway

   !> After the increment at rest: what moved in it says nothing of the next.
   subroutine leave_rest(accepted, increment)
      type(state_type), intent(inout) :: accepted
      real(wp), intent(in) :: increment        !! the next [time]

      accepted%clock%increment = increment
      accepted%clock%usual = 0.0_wp
      accepted%motion%last_dt = 0.0_wp
      accepted%motion%dt_before = 0.0_wp
      accepted%contact%speed = 0.0_wp
   end subroutine leave_rest

   !> From what was accepted to the step in force.
   subroutine start_loading(loading, scene, model)
      type(loading_type), intent(inout) :: loading
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      associate (step => model%step(scene%step), accepted => scene%accepted)
         accepted%clock = clock_state_type(start=accepted%clock%start, &
            & increment=min(step%initial, step%period))
         call new_loading(loading, model, scene%dofs, scene%constraints, scene%solids, step, &
            & accepted)
         call start_step(scene, model)
         call begin_step_of(accepted, step%nlgeom)
         if (step%nlgeom) call new_followers(scene%newton%follower, step, accepted%clock%start, &
            & scene%dofs%n)
      end associate
   end subroutine start_loading

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
         & model%step(scene%step)%at, note=plural(scene%bodies%nq, 'free rigid motion'), &
         & help='fix degrees of freedom by *BOUNDARY, or add the contact that holds the body')
   end subroutine check_supports

   !> One increment, judged and kept.
   subroutine next_increment(self, model, recorders, error, store)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      integer :: number, most

      associate (scene => self%scene, clock => self%scene%accepted%clock, frame => self%frame, &
         & step => model%step(self%scene%step))
         number = clock%number + 1
         most = step%max_increments + turns_within(model, self%plan, step, clock%start)
         if (number > most) then
            call refuse_more(clock, scene, step, most, error)
            return
         end if
         frame%increment = number
         call advance(self, model, recorders, error)
         if (allocated(error)) return
         call check_yield(scene, model, frame%u)
         call check_flow_curves(scene, model)
         self%summary%step(scene%step)%increments = number
         call note_power(scene%accepted, frame%time_increment)
         if (.not. clock%at_end) call grow(clock%increment, step, self%plan, frame, scene)
         if (number == 1 .and. scene%step == model%start%step) call leave_rest(scene%accepted, &
            & model%start%increment)
         self%summary%step(scene%step)%counter = scene%counter
         if (clock%at_end) call end_step(self, model, error)
         if (allocated(error)) return
         call save_checkpoint(self, model, recorders, error, store)
      end associate
   end subroutine next_increment

   !> One increment: tried, cut and tried again until it is accepted or cannot be cut.
   subroutine advance(self, model, recorders, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      type(attempt_type) :: attempt

      call first_attempt(attempt, self, model)
      do
         call set_attempt(attempt, self, model)
         call solve_increment(self, model, recorders, error)
         if (.not. allocated(error)) exit
         call cut_increment(self, model, recorders, error)
         if (.not. allocated(error)) cycle
         call advise(self, model, error)
         return
      end do
      call end_attempts(attempt, self, model)
   end subroutine advance

   !> More increments than the step allows.
   subroutine refuse_more(clock, scene, step, most, error)
      type(clock_state_type), intent(in) :: clock
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      integer, intent(in) :: most
      type(error_type), allocatable, intent(out) :: error

      call raise(error, error_code%not_converged, 'E0503', 'step '//to_text(scene%step)// &
         & ' reached time '//to_text(clock%time, 6)//' of '//to_text(step%period)//' in the '// &
         & to_text(most)//' increments that INC= allows', step%at, &
         & help='raise INC= on *STEP, or the increments on *STATIC')
   end subroutine refuse_more

   !> What the step leaves to the next, and what its end says of it.
   subroutine end_step(self, model, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (scene => self%scene, clock => self%scene%accepted%clock, &
         & step => model%step(self%scene%step))
         clock%start = clock%start + clock%time
         if (scene%step < size(model%step)) call carry_loads(self%loading, model, scene%dofs, &
            & scene%constraints, scene%solids, step, model%step(scene%step + 1), &
            & scene%accepted%loads%steady)
         call leave_followers(scene%newton%follower, scene%accepted%loads%followers)
         call check_end_of_step(self%watch, scene, model, self%frame)
         call release_pairs(scene, model, error)
      end associate
      self%in_step = .false.
   end subroutine end_step
end module lopin_run_analysis
