!> Files that are either whole or absent: written beside their place, then renamed.
!>
!> Logs grow by whole lines, flushed after each call, so that a killed run leaves no torn line.
module lopin_atomic_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only : int8
   use lopin_error, only : error_type, error_code, raise
   implicit none
   private
   public :: write_atomically, make_folder, remove_file, file_exists, read_text, log_file_type
   public :: written_mark, is_foreign

   !> Stands in the first lines of XML files of ours, which may therefore be replaced.
   character(len=*), parameter :: written_mark = '<!-- written by Lopin -->'

   !> A file that grows by whole lines.
   type :: log_file_type
      character(len=:), allocatable :: path
      integer :: unit = 0
      logical :: is_open = .false.
   contains
      procedure :: open => open_log
      procedure :: append
      procedure :: close => close_log
   end type log_file_type

   interface
      function c_rename(old, new) bind(c, name='rename') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: old(*), new(*)
         integer(c_int) :: status
      end function c_rename

      function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_mkdir

      function c_access(path, mode) bind(c, name='access') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_access

      function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_unlink
   end interface

contains

   !> Write text, then bytes, then a tail; the file appears under its name only when it is complete.
   subroutine write_atomically(path, text, error, bytes, tail)
      character(len=*), intent(in) :: path, text
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: bytes(:)
      character(len=*), intent(in), optional :: tail
      integer :: unit, status, closing

      open (newunit=unit, file=path//'.part', access='stream', form='unformatted', &
         & status='replace', action='write', iostat=status)
      if (status /= 0) then
         call cannot_write(path, error)
         return
      end if
      write (unit, iostat=status) text
      if (present(bytes) .and. status == 0) write (unit, iostat=status) bytes
      if (present(tail) .and. status == 0) write (unit, iostat=status) tail
      close (unit, iostat=closing)
      if (status == 0) status = closing
      if (status == 0) status = c_rename(path//'.part'//c_null_char, path//c_null_char)
      if (status /= 0) then
         call remove_file(path//'.part')
         call cannot_write(path, error)
      end if
   end subroutine write_atomically

   !> Make a folder and those above it; nothing to do if it is there.
   subroutine make_folder(path, error)
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      integer :: i, ignored

      do i = 2, len(path)
         if (path(i:i) == '/') ignored = c_mkdir(path(:i - 1)//c_null_char, int(o'777', c_int))
      end do
      ignored = c_mkdir(path//c_null_char, int(o'777', c_int))
      if (.not. file_exists(path//'/.')) call raise(error, error_code%resource, 'E0601', &
         & "cannot make the folder '"//path//"'", help='choose another folder with -o')
   end subroutine make_folder

   subroutine remove_file(path)
      character(len=*), intent(in) :: path
      integer(c_int) :: ignored
      ignored = c_unlink(path//c_null_char)
   end subroutine remove_file

   logical function file_exists(path)
      character(len=*), intent(in) :: path
      file_exists = c_access(path//c_null_char, 0_c_int) == 0
   end function file_exists

   !> All of a file; empty if it cannot be read.
   subroutine read_text(path, text)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text
      integer :: unit, status, length

      text = ''
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
         & action='read', iostat=status)
      if (status /= 0) return
      inquire (unit=unit, size=length)
      if (length > 0) then
         deallocate (text)
         allocate (character(len=length) :: text)
         read (unit, iostat=status) text
         if (status /= 0) text = ''
      end if
      close (unit)
   end subroutine read_text

   !> Does a file exist that has no mark of ours in its first lines?
   logical function is_foreign(path)
      character(len=*), intent(in) :: path
      character(len=128) :: start
      integer :: unit, status

      is_foreign = file_exists(path)
      if (.not. is_foreign) return
      start = ''
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
         & action='read', iostat=status)
      if (status /= 0) return
      read (unit, iostat=status) start
      close (unit)
      is_foreign = index(start, written_mark) == 0
   end function is_foreign

   !> Replace a log by its first lines; what follows is appended.
   subroutine open_log(self, path, header, error)
      class(log_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: header     !! whole lines, or nothing
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      call self%close()
      call write_atomically(path, header, error)
      if (allocated(error)) return
      self%path = path
      open (newunit=self%unit, file=path, access='stream', form='unformatted', status='old', &
         & position='append', action='write', iostat=status)
      self%is_open = status == 0
      if (.not. self%is_open) call cannot_write(path, error)
   end subroutine open_log

   subroutine append(self, lines, error)
      class(log_file_type), intent(inout) :: self
      character(len=*), intent(in) :: lines      !! whole lines
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      if (.not. self%is_open) return
      write (self%unit, iostat=status) lines
      if (status == 0) flush (self%unit, iostat=status)
      if (status /= 0) call cannot_write(self%path, error)
   end subroutine append

   subroutine close_log(self)
      class(log_file_type), intent(inout) :: self
      integer :: ignored

      if (self%is_open) close (self%unit, iostat=ignored)
      self%is_open = .false.
   end subroutine close_log

   subroutine cannot_write(path, error)
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      call raise(error, error_code%resource, 'E0602', "cannot write '"//path//"'", &
         & help='see that the folder exists, is writable and that the disk is not full')
   end subroutine cannot_write
end module lopin_atomic_file
