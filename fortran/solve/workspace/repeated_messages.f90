!> Warnings and notes that are given once per place of the deck, and how often each recurred.
module lopin_repeated_messages
   use lopin_error, only : location_type, log_type, severity
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   implicit none
   private
   public :: warn_once, note_once, report_repeats

contains

   !> Warn, unless the same was said at the same place before.
   subroutine warn_once(log, id, message, at, help)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in) :: at
      character(len=*), intent(in), optional :: help

      if (.not. is_repeated(log, id, at)) call log%say(severity%warning, id, message, at, help=help)
   end subroutine warn_once

   !> The same as a note.
   subroutine note_once(log, id, message, at, help)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in) :: at
      character(len=*), intent(in), optional :: help

      if (.not. is_repeated(log, id, at)) call log%say(severity%note, id, message, at, help=help)
   end subroutine note_once

   !> It was said at the same place before: then it is counted.
   logical function is_repeated(log, id, at)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id
      type(location_type), intent(in) :: at
      integer :: i

      is_repeated = .false.
      do i = 1, log%n
         if (log%item(i)%id /= id .or. log%item(i)%at%line /= at%line &
            & .or. log%item(i)%at%file /= at%file) cycle
         log%item(i)%again = log%item(i)%again + 1
         is_repeated = .true.
         return
      end do
   end function is_repeated

   !> At the end of a run: the warnings that held again after they were said, and how often.
   subroutine report_repeats(log)
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: text, at
      integer :: i, number

      text = ''
      number = 0
      do i = 1, log%n
         if (log%item(i)%severity /= severity%warning .or. log%item(i)%again == 0) cycle
         number = number + 1
         at = ''
         if (log%item(i)%at%line > 0) at = ' of line '//to_text(log%item(i)%at%line)
         if (number > 1) text = text//', '
         text = text//log%item(i)%id//at//' '//plural(log%item(i)%again, 'time')
      end do
      if (number > 0) call log%say(severity%note, 'N0505', 'warnings that held again in later '// &
         & 'increments are said once: '//text)
   end subroutine report_repeats
end module lopin_repeated_messages
