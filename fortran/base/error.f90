!> Errors, warnings and notes as values: code, message, place in the deck, and remedy.
!>
!> Nothing below `app/` stops or prints. A fallible procedure ends with
!> `type(error_type), allocatable, intent(out) :: error`; unallocated means success.
!> Warnings and notes that must reach the user travel in a `log_type`.
module lopin_error
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: location_type, diagnostic_type, error_type, log_type
   public :: error_code, severity, raise, raise_all, nowhere, keep_log

   !> A span of one line of one file of the deck; `file = 0` means "nowhere in the deck".
   type :: location_type
      integer :: file = 0    !! index into the deck's list of files
      integer :: line = 0    !! 1-based line
      integer :: first = 0   !! 1-based first column
      integer :: last = 0    !! last column
   end type location_type

   type(location_type), parameter :: nowhere = location_type()

   type :: severities
      integer :: note = 0, warning = 1, error = 2
   end type severities
   type(severities), parameter :: severity = severities()

   !> Exit codes of the executable, and the classes of Python exceptions.
   type :: error_codes
      integer :: deck = 1           !! the deck is wrong (also the model that it describes)
      integer :: usage = 2          !! the command line is wrong
      integer :: not_converged = 3  !! results up to the last good increment are kept
      integer :: singular = 4       !! rigid motion, mechanism, singular system
      integer :: resource = 5       !! memory, disk, file
      integer :: internal = 70      !! a defect of Lopin
      integer :: interrupted = 130
   end type error_codes
   type(error_codes), parameter :: error_code = error_codes()

   !> One thing said to the user.
   type :: diagnostic_type
      integer :: severity = 2
      character(len=:), allocatable :: id        !! E0101, W0311, N0001 ...
      character(len=:), allocatable :: message   !! one sentence with the offending value
      type(location_type) :: at
      character(len=:), allocatable :: label   !! short text beside the caret, e.g. "did you mean
                                               !! *FRICTION ?"
      character(len=:), allocatable :: note      !! why
      character(len=:), allocatable :: help      !! what to do
      integer :: element = 0                     !! mesh index: its place is meant
      integer :: again = 0                       !! times that it held again and was not said
   end type diagnostic_type

   !> A failure: its class and the one or more diagnostics that explain it.
   type :: error_type
      integer :: code = 70
      type(diagnostic_type), allocatable :: item(:)
   contains
      procedure :: text => error_text
   end type error_type

   !> Warnings and notes in the order in which they were said.
   type :: log_type
      integer :: n = 0
      type(diagnostic_type), allocatable :: item(:)
   contains
      procedure :: say
      procedure :: count_of
   end type log_type

contains

   !> Make an error of one diagnostic.
   subroutine raise(error, code, id, message, at, label, note, help)
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in) :: code
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in), optional :: at
      character(len=*), intent(in), optional :: label, note, help

      allocate (error)
      error%code = code
      allocate (error%item(1))
      call fill(error%item(1), severity%error, id, message, at, label, note, help)
   end subroutine raise

   !> Make an error of all diagnostics of severity error in a log; unallocated when there is none.
   subroutine raise_all(error, code, log)
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in) :: code
      type(log_type), intent(in) :: log
      integer :: i, k

      if (log%count_of(severity%error) == 0) return
      allocate (error)
      error%code = code
      allocate (error%item(log%count_of(severity%error)))
      k = 0
      do i = 1, log%n
         if (log%item(i)%severity /= severity%error) cycle
         k = k + 1
         error%item(k) = log%item(i)
      end do
   end subroutine raise_all

   !> Add a diagnostic to a log, unless it is a warning or note that stands there word for word.
   subroutine say(self, level, id, message, at, label, note, help)
      class(log_type), intent(inout) :: self
      integer, intent(in) :: level                  !! severity%note, %warning or %error
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in), optional :: at
      character(len=*), intent(in), optional :: label, note, help
      type(diagnostic_type), allocatable :: grown(:)
      integer :: i

      if (.not. allocated(self%item)) allocate (self%item(16))
      if (level < severity%error) then
         do i = 1, self%n
            if (self%item(i)%id /= id .or. self%item(i)%message /= message) cycle
            if (present(at)) then
               if (self%item(i)%at%file /= at%file .or. self%item(i)%at%line /= at%line) cycle
            end if
            return
         end do
      end if
      if (self%n == size(self%item)) then
         allocate (grown(2*self%n))
         grown(:self%n) = self%item
         call move_alloc(grown, self%item)
      end if
      self%n = self%n + 1
      call fill(self%item(self%n), level, id, message, at, label, note, help)
   end subroutine say

   !> What was said, to a stream or back.
   subroutine keep_log(self, stream)
      type(log_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i, n

      n = self%n
      call stream%pass(n)
      if (stream%broken) return
      if (stream%reading) then
         if (allocated(self%item)) deallocate (self%item)
         allocate (self%item(max(16, n)))
         self%n = n
      end if
      do i = 1, n
         associate (d => self%item(i))
            call stream%pass(d%severity)
            call stream%pass(d%id)
            call stream%pass(d%message)
            call stream%pass(d%at%file)
            call stream%pass(d%at%line)
            call stream%pass(d%at%first)
            call stream%pass(d%at%last)
            call stream%pass(d%label)
            call stream%pass(d%note)
            call stream%pass(d%help)
            call stream%pass(d%again)
         end associate
      end do
   end subroutine keep_log

   pure integer function count_of(self, level)
      class(log_type), intent(in) :: self
      integer, intent(in) :: level
      integer :: i

      count_of = 0
      do i = 1, self%n
         if (self%item(i)%severity == level) count_of = count_of + 1
      end do
   end function count_of

   !> The messages alone, one a line: what a caller without the deck's text can show.
   function error_text(self) result(text)
      class(error_type), intent(in) :: self
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      if (.not. allocated(self%item)) return
      do i = 1, size(self%item)
         if (i > 1) text = text//new_line('a')
         text = text//self%item(i)%id//': '//self%item(i)%message
         if (len(self%item(i)%help) > 0) text = text//new_line('a')//'  help: '//self%item(i)%help
      end do
   end function error_text

   subroutine fill(item, level, id, message, at, label, note, help)
      type(diagnostic_type), intent(out) :: item
      integer, intent(in) :: level
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in), optional :: at
      character(len=*), intent(in), optional :: label, note, help

      item%severity = level
      item%id = id
      item%message = message
      if (present(at)) item%at = at
      item%label = ''
      item%note = ''
      item%help = ''
      if (present(label)) item%label = label
      if (present(note)) item%note = note
      if (present(help)) item%help = help
   end subroutine fill
end module lopin_error
