!> Files that are either whole or absent: written beside their place, then renamed.
!>
!> Logs grow by whole lines, flushed after each call, so that a killed run leaves no torn line.
module lopin_atomic_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_long_long, c_null_char
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use lopin_error, only : error_type, error_code, raise
   use lopin_stream, only : stream_type
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
      integer(int64), private :: length = 0    !! bytes written
   contains
      procedure :: open => open_log
      procedure :: keep => keep_log
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

      function lopin_sync_file(path) bind(c) result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function lopin_sync_file

      function lopin_cut_file(path, length) bind(c) result(status)
         import :: c_char, c_int, c_long_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long_long), value :: length
         integer(c_int) :: status
      end function lopin_cut_file

      function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_unlink
   end interface

contains

   !> Write text, then bytes, then a tail; the file appears under its name only when it is complete.
   subroutine write_atomically(path, text, error, bytes, tail, lasting)
      character(len=*), intent(in) :: path, text
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: bytes(:)
      character(len=*), intent(in), optional :: tail
      logical, intent(in), optional :: lasting   !! on the disk before it takes its name
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
      if (present(lasting) .and. status == 0) then
         if (lasting) status = lopin_sync_file(path//'.part'//c_null_char)
      end if
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

   !> Replace a log by its first lines; what follows is appended. A log that goes on is left as it
   !> is until `keep` says how far it counts.
   subroutine open_log(self, path, header, error, goes_on)
      class(log_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: header     !! whole lines, or nothing
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: goes_on

      call self%close()
      self%path = path
      if (goes_on) return
      call write_atomically(path, header, error)
      if (allocated(error)) return
      self%length = len(header)
      call open_at_end(self, error)
   end subroutine open_log

   !> The length to a stream, or back: the file is cut to it.
   subroutine keep_log(self, stream, error)
      class(log_file_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: there
      integer :: status

      call stream%pass(self%length)
      if (.not. stream%reading .or. stream%broken) return
      inquire (file=self%path, size=there)
      if (there < self%length) then
         call raise(error, error_code%resource, 'E0606', "'"//self%path//"' has lost what was "// &
            & 'written before the checkpoint', help='run the deck without --resume')
         return
      end if
      status = lopin_cut_file(self%path//c_null_char, int(self%length, c_long_long))
      if (status /= 0) then
         call cannot_write(self%path, error)
         return
      end if
      call open_at_end(self, error)
   end subroutine keep_log

   subroutine open_at_end(self, error)
      class(log_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      open (newunit=self%unit, file=self%path, access='stream', form='unformatted', status='old', &
         & position='append', action='write', iostat=status)
      self%is_open = status == 0
      if (.not. self%is_open) call cannot_write(self%path, error)
   end subroutine open_at_end

   subroutine append(self, lines, error)
      class(log_file_type), intent(inout) :: self
      character(len=*), intent(in) :: lines      !! whole lines
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      if (.not. self%is_open) return
      write (self%unit, iostat=status) lines
      if (status == 0) flush (self%unit, iostat=status)
      self%length = self%length + len(lines)
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
