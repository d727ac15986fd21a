!> Reads a whole file, or returns the reason why not.
module lopin_whole_text
   use, intrinsic :: iso_c_binding, only : c_int, c_long_long, c_null_char
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_checked_file, only : file_kind, file_read, kind_word, reason_of
   use lopin_text, only : to_text
   implicit none
   private
   public :: read_whole, file_is_missing

   !> Places in a text are counted by default integers.
   integer(int64), parameter :: longest = huge(1) - 1

contains

   !> `reason` is '' when all is well.
   subroutine read_whole(path, text, reason)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text, reason
      integer(int64) :: length
      integer(c_int) :: status
      integer :: kind, refused
      character(len=24) :: number

      reason = ''
      text = ''
      call file_kind(path, kind, length)
      if (kind /= 0) then
         reason = kind_word(kind)
      else if (length > longest) then
         write (number, '(f0.1)') real(length)/1.0e9
         reason = 'it has '//trim(number)//' GB, and at most 2.1 GB are read'
      end if
      if (len(reason) > 0) return
      deallocate (text)
      allocate (character(len=length) :: text, stat=refused)
      if (refused /= 0) then
         text = ''
         reason = 'there is no memory for its '//to_text(int(length))//' bytes'
      else if (length > 0) then
         status = file_read(path//c_null_char, text, int(length, c_long_long))
         if (status /= 0) reason = reason_of(status)
      end if
   end subroutine read_whole

   !> Nothing that could be read has this name.
   logical function file_is_missing(path)
      character(len=*), intent(in) :: path
      integer(int64) :: length
      integer :: kind

      call file_kind(path, kind, length)
      file_is_missing = kind == 1 .or. kind == 2
   end function file_is_missing
end module lopin_whole_text
