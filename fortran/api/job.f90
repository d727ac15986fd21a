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
   use lopin_run_analysis, only : run_analysis
   use lopin_blas_threads, only : set_blas_threads, blas_threads
   use lopin_state, only : summary_type
   use lopin_text, only : plural, to_text, upper
   use omp_lib, only : omp_set_num_threads, omp_get_max_threads
   implicit none
   private
   public :: job_type, outcome_type, open_job, run_job, refuse_warnings, stem_of

   !> What a caller may ask for beyond the deck.
   type :: job_type
      character(len=:), allocatable :: folder   !! of the result files; '' for none
      character(len=:), allocatable :: stem     !! of their names
      character(len=:), allocatable :: solver   !! '': as the deck says
      integer :: threads = 0                    !! 0: as the environment says
      logical :: deterministic = .false.        !! the same bits for any number of threads
      logical :: strict = .false.               !! warnings are errors
      logical :: in_memory = .false.            !! the last recorder keeps everything
      logical :: resume = .false.               !! go on from the checkpoint, if there is one
      logical :: overwrite = .false.            !! replace the unfinished run of another deck
      logical :: interruptible = .false.        !! Ctrl-C in a process that is not ours
   end type job_type

   type :: outcome_type
      type(clock_type) :: clock                 !! started by the caller, before the deck was read
      type(recorder_holder_type), allocatable :: recorder(:)
      type(summary_type) :: summary
      type(log_type) :: log                     !! notes and warnings of the analysis
   end type outcome_type

   !> Fewer are assembled (3 us each) before a second thread has woken up and gone to sleep again.
   integer, parameter :: enough_elements = 10000
   integer, parameter :: most_threads = 1024

   interface
      integer(c_int) function lopin_threads_that_start(n) bind(c)
         import :: c_int
         integer(c_int), value :: n
      end function lopin_threads_that_start

      subroutine lopin_survive_forks() bind(c)
      end subroutine lopin_survive_forks
   end interface

contains

   !> The model of a deck; its notes and warnings are in `model%log`.
   subroutine open_job(self, deck, model, error)
      type(job_type), intent(in) :: self
      type(deck_type), intent(in) :: deck
      type(model_type), intent(out) :: model
      type(error_type), allocatable, intent(out) :: error

      if (self%threads > most_threads) call raise(error, error_code%usage, 'E0801', &
         & to_text(self%threads)//' threads: at most '//to_text(most_threads)//' can be had')
      if (.not. allocated(error)) call new_model(model, deck, error)
      if (allocated(error)) return
      if (len(self%solver) > 0) model%solver = upper(self%solver)
      model%blas_threads = max(1, blas_threads())
      if (self%threads > 0) model%blas_threads = self%threads
      if (self%deterministic) model%blas_threads = 1
   end subroutine open_job

   !> Run all steps; what was accepted before an error stays recorded.
   subroutine run_job(self, deck, model, outcome, error)
      type(job_type), intent(in) :: self
      type(deck_type), intent(in) :: deck       !! names the files of messages
      type(model_type), intent(in) :: model
      type(outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error
      type(checkpoint_file_type), allocatable :: checkpoint
      integer :: before, team
      logical :: done

      call outcome%clock%stop_in(phase%model)
      outcome%summary%plan = ''
      if (len(self%folder) > 0) then
         call make_folder(self%folder, error)
         if (allocated(error)) return
         allocate (checkpoint)
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
      end if
      if (self%in_memory) call append_memory(outcome%recorder, names_of(deck))
      before = blas_threads()
      team = omp_get_max_threads()
      call set_threads(self, model, outcome%log)
      if (self%interruptible) call borrow_interrupt()
      ! What is not allocated is absent.
      call run_analysis(model, outcome%recorder, outcome%clock, outcome%summary, outcome%log, &
         & error, checkpoint)
      if (self%interruptible) call return_interrupt(merge(1_c_int, 0_c_int, &
         & outcome%summary%exit_code == error_code%interrupted))
      if (allocated(checkpoint)) call checkpoint%lock%give()
      ! The process may go on with other work.
      call omp_set_num_threads(team)
      done = before == 0
      if (.not. done) done = set_blas_threads(before)
   end subroutine run_job

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

   !> Threads of the assembly, where there is enough to share out; the BLAS starts on one, and a
   !> large system may raise it (lopin_blas_threads says when).
   subroutine set_threads(self, model, log)
      type(job_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(log_type), intent(inout) :: log
      integer :: wanted, started
      logical :: done

      wanted = min(omp_get_max_threads(), most_threads)
      if (model%mesh%nelement < enough_elements) wanted = 1
      if (self%threads > 0) wanted = self%threads
      started = 1
      if (wanted > 1) then
         started = lopin_threads_that_start(int(wanted, c_int))
         call lopin_survive_forks()
      end if
      if (started < wanted) call log%say(severity%note, 'N0706', 'the run has '// &
         & plural(started, 'thread')//' instead of '//to_text(wanted)// &
         & ': the system starts no more')
      call omp_set_num_threads(started)
      done = set_blas_threads(1)
      associate (unused => done)
      end associate
   end subroutine set_threads

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
