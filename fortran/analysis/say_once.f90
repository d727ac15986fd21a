!> Warnings that are given once at a place of the deck.
module lopin_say_once
   use lopin_error, only : location_type, log_type, severity
   implicit none
   private
   public :: say_once

contains

   !> Warn, unless the same was said at the same place before.
   subroutine say_once(log, id, message, at, help)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in) :: at
      character(len=*), intent(in), optional :: help
      integer :: i

      do i = 1, log%n
         if (log%item(i)%id == id .and. log%item(i)%at%line == at%line &
            & .and. log%item(i)%at%file == at%file) return
      end do
      call log%say(severity%warning, id, message, at, help=help)
   end subroutine say_once
end module lopin_say_once
