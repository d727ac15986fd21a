!> The straight line of a run, the same for the executable and for callers in one process:
!> deck, model, recorders, analysis.
module lopin_job
   use, intrinsic :: iso_c_binding, only : c_int
   use lopin_build_model, only : new_model
   use lopin_clock, only : clock_type, phase
   use lopin_deck, only : deck_type
   use lopin_error, only : error_type, error_code, log_type, severity, raise
   use lopin_interrupt, only : borrow_interrupt, return_interrupt
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_recorder_factory, only : new_recorders, append_memory
   use lopin_atomic_file, only : make_folder
   use lopin_checkpoint_file, only : checkpoint_file_type, new_checkpoint_file
   use lopin_checksum, only : checksum_type
   use lopin_run_type, only : run_type
   use lopin_run_analysis, only : open_run, advance_run, close_run
   use lopin_run_state, only : run_state, forget_workspace
   use lopin_stream, only : stream_type
   use lopin_blas_threads, only : set_blas_threads, blas_threads
   use lopin_report, only : summary_type
   use lopin_shared_work, only : set_threads_of_run
   use lopin_plural, only : plural
   use lopin_text, only : to_text, upper
   use lopin_version, only : version
   use lopin_watcher, only : watcher_type
   use omp_lib, only : omp_get_max_threads
   implicit none
   private
   public :: job_type, outcome_type, running_type, open_job, run_job, refuse_warnings, stem_of
   public :: begin_job, advance_job, job_state, forget_job, end_job

   !> What a caller may ask for beyond the deck.
   type :: job_type
      character(len=:), allocatable :: folder   !! of the result files; '' for none
      character(len=:), allocatable :: stem     !! of their names
      character(len=:), allocatable :: solver   !! '': as the deck says
      integer :: threads = 0                    !! 0: as the environment says
      logical :: deterministic = .false.        !! of earlier versions: it is always so
      logical :: strict = .false.               !! warnings are errors
      logical :: in_memory = .false.            !! the last recorder keeps everything
      logical :: resume = .false.               !! go on from the checkpoint, if there is one
      logical :: overwrite = .false.            !! replace the unfinished run of another deck
      logical :: interruptible = .false.        !! Ctrl-C in a process that is not ours
      logical :: stepwise = .false.             !! whose it is again between increments
   end type job_type

   type :: outcome_type
      type(clock_type) :: clock                 !! started by the caller, before the deck was read
      type(recorder_holder_type), allocatable :: recorder(:)
      type(summary_type) :: summary
      type(log_type) :: log                     !! notes and warnings of the analysis
      class(watcher_type), allocatable :: watcher  !! of the run, which takes it over
   end type outcome_type

   !> A run that goes on increment by increment, and what the process did before.
   type :: running_type
      class(run_type), allocatable :: run      !! through a pointer to its own clean-up
      type(checkpoint_file_type), allocatable :: checkpoint
      logical :: opened = .false.               !! and not ended
      logical, private :: borrowed = .false.    !! the answer to Ctrl-C
      integer, private :: blas = 0                    !! threads of the BLAS without the run
      integer, private :: own_team = 0                !! threads of the run; 0: not yet chosen
   end type running_type

   !> Fewer are assembled (3 us each) before a second thread has woken up and gone to sleep again.
   integer, parameter :: enough_elements = 10000
   integer, parameter :: most_threads = 1024

   interface
      subroutine lopin_watch_processors() bind(c)
      end subroutine lopin_watch_processors
      integer(c_int) function lopin_idle_processors() bind(c)
         import :: c_int
      end function lopin_idle_processors
      integer(c_int) function lopin_threads_that_start(n) bind(c)
         import :: c_int
         integer(c_int), value :: n
      end function lopin_threads_that_start
   end interface

contains

   !> The model of a deck; its notes and warnings are in `model%log`.
   subroutine open_job(self, deck, model, error)
      type(job_type), intent(in) :: self
      type(deck_type), intent(in) :: deck
      type(model_type), intent(out) :: model
      type(error_type), allocatable, intent(out) :: error

      call lopin_watch_processors()
      if (self%threads > most_threads) call raise(error, error_code%usage, 'E0801', &
         & to_text(self%threads)//' threads: at most '//to_text(most_threads)//' can be had')
      if (.not. allocated(error)) call new_model(model, deck, error)
      if (allocated(error)) return
      if (len(self%solver) > 0) model%solver = upper(self%solver)
   end subroutine open_job

   !> Run all steps; what was accepted before an error stays recorded.
   subroutine run_job(self, deck, model, outcome, error)
      type(job_type), intent(in) :: self
      type(deck_type), intent(in) :: deck       !! names the files of messages
      type(model_type), intent(inout) :: model
      type(outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error
      type(running_type) :: running
      logical :: more

      call begin_job(self, running, deck, model, outcome, error)
      more = .not. allocated(error)
      do while (more)
         call advance_job(self, running, model, outcome, more, error)
      end do
      call end_job(self, running, model, outcome, error)
   end subroutine run_job

   !> Lock the folder and open the run; `state` is one to go on from.
   subroutine begin_job(self, running, deck, model, outcome, error, state)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(deck_type), intent(in) :: deck       !! names the files of messages
      type(model_type), intent(inout) :: model
      type(outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error
      type(stream_type), intent(inout), optional :: state

      call outcome%clock%stop_in(phase%model)
      outcome%summary%plan = ''
      if (present(state)) call refuse_other(state, deck, model, error)
      if (allocated(error)) return
      if (len(self%folder) > 0) call take_folder(self, running, deck, model, outcome, error)
      if (allocated(error)) return
      if (self%in_memory) call append_memory(outcome%recorder, names_of(deck))
      call enter(self, running, model, outcome%log)
      ! What is not allocated is absent.
      allocate (run_type :: running%run)
      call open_run(running%run, model, outcome%recorder, outcome%clock, outcome%log, error, &
         & running%checkpoint, state)
      running%opened = .true.
      if (allocated(running%run%scene)) call move_alloc(outcome%watcher, &
         & running%run%scene%watcher)
      call leave(self, running, error)
   end subroutine begin_job

   !> The lock, the checkpoint and the files of a run.
   subroutine take_folder(self, running, deck, model, outcome, error)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(deck_type), intent(in) :: deck
      type(model_type), intent(in) :: model
      type(outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error

      call make_folder(self%folder, error)
      if (allocated(error)) return
      allocate (running%checkpoint)
      associate (checkpoint => running%checkpoint)
         call new_checkpoint_file(checkpoint, self%folder//'/'//self%stem//'.rst', &
            & fingerprint_of(deck, model), deck%source(1)%name, self%resume, self%overwrite, error)
         if (self%resume .and. .not. allocated(error) .and. .not. allocated(checkpoint%found)) &
            & call outcome%log%say(severity%note, 'N0604', 'there is no checkpoint in '// &
            & self%folder//': the run starts from its beginning')
         if (.not. allocated(error)) call new_recorders(outcome%recorder, model, self%folder, &
            & self%stem, error, names_of(deck))
         if (allocated(error)) then
            call checkpoint%lock%give()
            return
         end if
         call checkpoint%lock%sign()
      end associate
   end subroutine take_folder

   !> What a run holds between two increments, for `begin_job` of the same deck.
   subroutine job_state(running, deck, model, state, error)
      type(running_type), intent(inout) :: running
      type(deck_type), intent(in) :: deck
      type(model_type), intent(in) :: model
      type(stream_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: mark

      mark = mark_of(deck, model)
      call state%pass(mark)
      call run_state(running%run, model, state, error)
   end subroutine job_state

   !> Throw the workspace away and make it again from the model and the state: to the same bits.
   subroutine forget_job(self, running, model, outcome, error)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(model_type), intent(inout) :: model
      type(outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error

      call enter(self, running, model, outcome%log)
      call forget_workspace(running%run, model, error)
      call leave(self, running, error)
   end subroutine forget_job

   subroutine refuse_other(state, deck, model, error)
      type(stream_type), intent(inout) :: state
      type(deck_type), intent(in) :: deck
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: mark

      state%reading = .true.
      mark = ''
      call state%pass(mark)
      if (state%broken .or. mark /= mark_of(deck, model)) call raise(error, &
         & error_code%resource, 'E0604', 'the state is of another deck or of another version', &
         & help='give a state that this version took out of the same deck and files')
   end subroutine refuse_other

   function mark_of(deck, model) result(mark)
      type(deck_type), intent(in) :: deck
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: mark
      type(checksum_type) :: sum

      sum = fingerprint_of(deck, model)
      mark = 'Lopin state 1, '//version//', '//sum%text()
   end function mark_of

   !> One accepted increment; `more` is false at the end of the run and after an error.
   subroutine advance_job(self, running, model, outcome, more, error)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(model_type), intent(in) :: model
      type(outcome_type), intent(inout) :: outcome
      logical, intent(out) :: more
      type(error_type), allocatable, intent(out) :: error

      call enter(self, running, model, outcome%log)
      call advance_run(running%run, model, outcome%recorder, more, error, running%checkpoint)
      call leave(self, running, error)
   end subroutine advance_job

   !> Files to their end, the folder to others; also after an error, and before the end of the run.
   subroutine end_job(self, running, model, outcome, error)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(model_type), intent(in) :: model
      type(outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(inout) :: error

      if (.not. running%opened) return
      call close_run(running%run, model, outcome%recorder, outcome%log, error, running%checkpoint)
      outcome%summary = running%run%summary
      call give_back(running, error)
      if (allocated(running%checkpoint)) call running%checkpoint%lock%give()
      running%opened = .false.
      associate (unused => self)
      end associate
   end subroutine end_job

   !> The answer to Ctrl-C, to the process.
   subroutine give_back(running, error)
      type(running_type), intent(inout) :: running
      type(error_type), allocatable, intent(in) :: error
      integer(c_int) :: answered

      if (.not. running%borrowed) return
      answered = 0
      if (allocated(error)) answered = merge(1_c_int, 0_c_int, &
         & error%code == error_code%interrupted)
      call return_interrupt(answered)
      running%borrowed = .false.
   end subroutine give_back

   !> Threads, and the answer to Ctrl-C, are those of the run while it computes.
   subroutine enter(self, running, model, log)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(model_type), intent(in) :: model
      type(log_type), intent(inout) :: log
      logical :: done

      running%blas = blas_threads()
      if (running%own_team == 0) call choose_threads(self, model, running%own_team, log)
      call set_threads_of_run(running%own_team)
      done = set_blas_threads(1)
      associate (unused => done)
      end associate
      if (self%interruptible .and. .not. running%borrowed) call borrow_interrupt()
      running%borrowed = self%interruptible
   end subroutine enter

   !> The process may go on with other work.
   subroutine leave(self, running, error)
      type(job_type), intent(in) :: self
      type(running_type), intent(inout) :: running
      type(error_type), allocatable, intent(in) :: error
      logical :: done

      if (self%stepwise) call give_back(running, error)
      call set_threads_of_run(1)
      done = running%blas == 0
      if (.not. done) done = set_blas_threads(running%blas)
   end subroutine leave

   !> Of all that decides what a run computes: the deck with the files that it includes, STL files,
   !> the solver.
   function fingerprint_of(deck, model) result(sum)
      type(deck_type), intent(in) :: deck
      type(model_type), intent(in) :: model
      type(checksum_type) :: sum
      integer :: i

      sum = model%outside
      do i = 1, size(deck%source)
         call sum%add_text(deck%source(i)%text)
      end do
      call sum%add_text(model%solver)
   end function fingerprint_of

   !> With `strict`, a warning ends the run.
   subroutine refuse_warnings(log, error)
      type(log_type), intent(in) :: log
      type(error_type), allocatable, intent(out) :: error

      if (log%count_of(severity%warning) > 0) call raise(error, error_code%deck, 'E0803', &
         & plural(log%count_of(severity%warning), 'warning')//' with --strict')
   end subroutine refuse_warnings

   !> Threads of the assembly and of factorisations, where there is enough to share out. What other
   !> processes compute on is left to them: a second thread beside them would make the run wait. The
   !> number changes no bit.
   subroutine choose_threads(self, model, started, log)
      type(job_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(out) :: started
      type(log_type), intent(inout) :: log
      integer :: wanted, unsaid

      wanted = min(omp_get_max_threads(), most_threads)
      if (model%mesh%nelement < enough_elements) wanted = 1
      call get_environment_variable('OMP_NUM_THREADS', status=unsaid)
      if (wanted > 1 .and. unsaid /= 0) wanted = min(wanted, max(1, int(lopin_idle_processors())))
      if (self%threads > 0) wanted = self%threads
      started = 1
      if (wanted > 1) started = lopin_threads_that_start(int(wanted, c_int))
      if (started < wanted) call log%say(severity%note, 'N0706', 'the run has '// &
         & plural(started, 'thread')//' instead of '//to_text(wanted)// &
         & ': the system starts no more')
   end subroutine choose_threads

   !> Name of the deck without its folder and its .inp.
   pure function stem_of(path) result(stem)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: stem
      integer :: dot

      stem = path(index(path, '/', back=.true.) + 1:)
      dot = index(stem, '.', back=.true.)
      if (dot > 1) stem = stem(:dot - 1)
   end function stem_of

   function names_of(deck) result(names)
      type(deck_type), intent(in) :: deck
      character(len=200), allocatable :: names(:)
      integer :: i

      allocate (names(size(deck%source)))
      do i = 1, size(names)
         names(i) = deck%source(i)%name
      end do
   end function names_of
end module lopin_job
