!> Everything that the executable prints, and the only place where it stops.
!>
!> Diagnostics go to standard error, what was asked for goes to standard output.
module lopin_terminal
   use, intrinsic :: iso_c_binding, only : c_int, c_long_long
   use lopin_block, only : deck_type
   use lopin_checked_file, only : write_all, has_left, is_closed, reason_of
   use lopin_error, only : error_type, error_code, log_type, diagnostic_type, severity
   use lopin_job, only : refuse_warnings
   use lopin_live, only : clear_line
   use lopin_render, only : render, render_json, json_string
   use lopin_safe_text, only : printable
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_recorder_json, only : json_schema
   implicit none
   private
   public :: terminal_type, new_terminal

   integer(c_int), parameter :: output_stream = 1, error_stream = 2
   character(len=1), parameter :: nl = achar(10)

   !> How this run speaks to its user.
   type :: terminal_type
      logical :: colour = .false.
      logical :: json = .false.
      logical :: quiet = .false.
      logical :: strict = .false.
      logical :: line = .false.                     !! a line of the run stands on the terminal
      logical :: jsonl = .false.                    !! standard output has one JSON object a line
      type(log_type) :: said                        !! what was shown so far, for --json
      type(deck_type) :: deck                       !! whose lines are shown
      integer(c_int), private :: lost = 0           !! errno of what could not be written
   contains
      procedure :: say
      procedure :: end_line
      procedure :: tell
      procedure :: show_log
      procedure :: stop_on
      procedure :: finish
   end type terminal_type

   interface
      !> Whether a file descriptor is a terminal.
      integer(c_int) function isatty(descriptor) bind(c)
         import :: c_int
         integer(c_int), value :: descriptor
      end function isatty

      !> An end that does not come from here is told too, in the form that was asked for.
      subroutine lopin_hear_the_end() bind(c)
      end subroutine lopin_hear_the_end

      subroutine lopin_end_as_json() bind(c)
      end subroutine lopin_end_as_json

      !> The end of the process.
      subroutine lopin_end(code) bind(c)
         import :: c_int
         integer(c_int), value :: code
      end subroutine lopin_end
   end interface

contains

   subroutine new_terminal(self, colour, json, quiet, strict)
      type(terminal_type), intent(out) :: self
      logical, intent(in) :: colour, json, quiet, strict
      integer :: length
      integer(c_int) :: stderr_is_terminal

      call lopin_hear_the_end()
      if (json) call lopin_end_as_json()
      call get_environment_variable('NO_COLOR', length=length)
      stderr_is_terminal = isatty(2_c_int)
      self%colour = colour .and. length == 0 .and. stderr_is_terminal == 1
      self%json = json
      self%quiet = quiet
      self%strict = strict
   end subroutine new_terminal

   !> Lines that accompany a run; a line end is added.
   subroutine say(self, text)
      class(terminal_type), intent(inout) :: self
      character(len=*), intent(in) :: text

      if (self%quiet .or. self%json .or. self%jsonl) return
      call self%tell(printable(text)//nl)
   end subroutine say

   !> What stands on the terminal of a run goes.
   subroutine end_line(self)
      class(terminal_type), intent(inout) :: self

      if (self%line) call complain(self, clear_line)
      self%line = .false.
   end subroutine end_line

   !> What was asked for, on standard output as it is.
   subroutine tell(self, text)
      class(terminal_type), intent(inout) :: self
      character(len=*), intent(in) :: text

      integer(c_int) :: status

      if (self%lost /= 0) return
      status = write_all(output_stream, text, len(text, kind=c_long_long))
      if (.not. is_closed(status)) self%lost = status
   end subroutine tell

   !> Diagnostics; if nobody reads them, the exit code still tells.
   subroutine complain(self, text)
      class(terminal_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      integer(c_int) :: status

      status = write_all(error_stream, text, len(text, kind=c_long_long))
      if (has_left(status)) return
      if (is_closed(status)) return
      if (self%lost == 0) self%lost = status
   end subroutine complain

   !> Show the notes and warnings of a log; errors come with `stop_on`. With --strict, warnings end
   !> the run.
   subroutine show_log(self, log)
      class(terminal_type), intent(inout) :: self
      type(log_type), intent(in) :: log
      type(error_type), allocatable :: error
      integer :: i

      do i = 1, log%n
         if (log%item(i)%severity == severity%error) cycle
         if (self%quiet .and. log%item(i)%severity == severity%note) cycle
         call show(self, log%item(i))
      end do
      if (self%strict) call refuse_warnings(log, error)
      call self%stop_on(error)
   end subroutine show_log

   !> Show an error and stop with its code; nothing happens without one.
   subroutine stop_on(self, error)
      class(terminal_type), intent(inout) :: self
      type(error_type), allocatable, intent(in) :: error
      integer :: i

      if (.not. allocated(error)) return
      do i = 1, size(error%item)
         call show(self, error%item(i))
      end do
      if (size(error%item) > 1 .and. .not. self%json) &
         & call complain(self, plural(size(error%item), 'error')//nl)
      if (error%code == error_code%internal) call complain(self, &
         & 'this is a defect of Lopin: please report the deck and this message'//nl)
      call self%finish(error%code, '')
   end subroutine stop_on

   subroutine show(self, item)
      class(terminal_type), intent(inout) :: self
      type(diagnostic_type), intent(in) :: item

      call self%said%say(item%severity, item%id, item%message, item%at, item%label, item%note, &
         & item%help)
      if (.not. self%json) call complain(self, render(item, self%deck, self%colour))
   end subroutine show

   !> The end of the program: the JSON object if it is wanted, the last line of a good run, the
   !> exit code. What was asked for and could not be written is a failure of its own.
   subroutine finish(self, code, last_line)
      class(terminal_type), intent(inout) :: self
      integer, intent(in) :: code                !! error_code%..., 0 for success
      character(len=*), intent(in) :: last_line  !! on standard output; '' for none
      integer :: final

      if (self%json) then
         call put_json(self, code)
      else if (self%jsonl) then
         call self%tell('{"event": "end", "status": '//json_string(trim(merge('ok    ', &
            & 'failed', code == 0)))//', "exit_code": '//to_text(code)//'}'//nl)
      else if (len(last_line) > 0) then
         call self%say(last_line)
      end if
      final = code
      if (self%lost /= 0) then
         if (code == 0) final = error_code%resource
         if (.not. has_left(self%lost)) call complain(self, &
            & 'error[E0608]: cannot write to the standard streams: '//reason_of(self%lost)//nl)
      end if
      call lopin_end(int(final, c_int))
      stop final, quiet=.true.
   end subroutine finish

   subroutine put_json(self, code)
      class(terminal_type), intent(inout) :: self
      integer, intent(in) :: code
      integer :: i

      call self%tell('{"schema": "'//json_schema//'", "status": '// &
         & json_string(trim(merge('finished', 'failed  ', code == 0)))//', "exit_code": '// &
         & to_text(code)//','//nl//' "diagnostics": ['//nl)
      do i = 1, self%said%n
         call self%tell('  '//render_json(self%said%item(i), self%deck)// &
            & trim(merge(',', ' ', i < self%said%n))//nl)
      end do
      call self%tell(' ]}'//nl)
   end subroutine put_json
end module lopin_terminal
