!> The closing lines of a run: contact, verdict, warnings by kind, time and memory, where the
!> results are and which commands show them.
module lopin_closing
   use lopin_error, only : error_type, error_code, log_type, severity
   use lopin_job, only : job_type, outcome_type
   use lopin_json_verdict, only : verdict_line
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_progress_text, only : clock_text
   use lopin_recorder_json, only : json_recorder_type
   use lopin_report, only : summary_type
   use lopin_terminal, only : terminal_type
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   implicit none
   private
   public :: tell_end

contains

   !> Of a run that ended, or that failed once it had begun.
   subroutine tell_end(job, model, outcome, failure, terminal)
      type(job_type), intent(in) :: job
      type(model_type), intent(in) :: model
      type(outcome_type), intent(in) :: outcome
      type(error_type), allocatable, intent(in) :: failure
      type(terminal_type), intent(inout) :: terminal
      integer :: i, k, increments
      logical :: failed, has_frame, refused

      increments = 0
      if (allocated(outcome%summary%step)) increments = sum(outcome%summary%step%increments)
      if (.not. allocated(outcome%recorder)) return
      failed = allocated(failure)
      has_frame = .false.
      refused = .false.
      do k = 1, size(outcome%recorder)
         select type (recorder => outcome%recorder(k)%recorder)
         type is (json_recorder_type)
            has_frame = len(verdict_line(recorder%judgement)) > 0
            refused = recorder%judgement%certificate%verdict == 2
            if (failed .and. .not. has_frame) exit
            do i = 1, size(model%pair)
               call terminal%say(recorder%told(model, i))
            end do
            if (has_frame) call terminal%say(verdict_line(recorder%judgement))
         end select
      end do
      if (failed .and. .not. has_frame) then
         ! Of a deck that cannot be run its error says all.
         if (failure%code /= error_code%not_converged) return
      end if
      if (terminal%said%count_of(severity%warning) > 0) &
         & call terminal%say(warnings_by_kind(terminal%said))
      call terminal%say(cost_of(outcome%summary, increments))
      if (failed .and. .not. has_frame) then
         call terminal%say('no increment was found; its iterations are in '//job%folder//'/'// &
            & job%stem//'.cvg')
         return
      else if (failed) then
         call terminal%say(found_of(outcome%summary, increments, refused)//' in '//job%folder//'/')
      else
         call terminal%say('results in '//job%folder//'/')
      end if
      call terminal%say('to see them: lopin report '//job%folder//' (Python package), paraview '// &
         & job%folder//'/'//job%stem//'.pvd')
   end subroutine tell_end

   !> 3 warnings: W0504, W0311 twice.
   function warnings_by_kind(log) result(text)
      type(log_type), intent(in) :: log
      character(len=:), allocatable :: text
      integer :: i, k, times

      text = plural(log%count_of(severity%warning), 'warning')//' (lopin explain CODE): '
      do i = 1, log%n
         if (log%item(i)%severity /= severity%warning) cycle
         times = 0
         do k = 1, log%n
            if (log%item(k)%severity /= severity%warning) cycle
            if (log%item(k)%id /= log%item(i)%id) cycle
            if (k < i) exit
            times = times + 1
         end do
         if (times == 0) cycle
         if (text(len(text):) /= ' ') text = text//', '
         text = text//log%item(i)%id
         if (times > 1) text = text//' ('//to_text(times)//')'
      end do
   end function warnings_by_kind

   !> Time, memory and work.
   function cost_of(summary, increments) result(text)
      type(summary_type), intent(in) :: summary
      integer, intent(in) :: increments
      character(len=:), allocatable :: text
      character(len=24) :: seconds

      write (seconds, '(f8.1, a)') summary%clock%total(), ' s'
      text = trim(adjustl(seconds))
      if (summary%clock%total() >= 100.0_wp) text = clock_text(summary%clock%total())
      text = text//', '//to_text(nint(summary%peak_memory))//' MiB'
      if (summary%threads > 1) text = text//', '//plural(summary%threads, 'thread')
      text = text//'; '// &
         & plural(increments, 'increment')//', '// &
         & plural(sum(summary%step%counter%iterations), 'iteration')
      if (len(summary%reason) > 0) text = text//', '// &
         & plural(sum(summary%step%counter%factorisations), 'factorisation')//' by '// &
         & summary%solver//' ('//summary%reason//')'
   end function cost_of

   !> What of a failed run is kept.
   function found_of(summary, increments, refused) result(text)
      type(summary_type), intent(in) :: summary
      integer, intent(in) :: increments        !! accepted
      logical, intent(in) :: refused           !! one more was found, and fails its certificate
      character(len=:), allocatable :: text

      if (increments == 0) then
         text = 'the increment that was refused is'
      else
         text = 'results up to '//last_of(summary)
         if (refused) text = text//', and the increment that was refused,'
      end if
   end function found_of

   !> The last step that has increments.
   function last_of(summary) result(text)
      type(summary_type), intent(in) :: summary
      character(len=:), allocatable :: text
      integer :: step

      step = findloc(summary%step%increments > 0, .true., dim=1, back=.true.)
      text = 'step '//to_text(step)//', increment '//to_text(summary%step(step)%increments)
   end function last_of
end module lopin_closing
