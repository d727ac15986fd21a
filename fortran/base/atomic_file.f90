!> Files that are either whole or absent: written beside their place, then renamed.
!>
!> Logs grow by whole lines, so that neither a killed run nor a full disk leaves a torn one.
module lopin_atomic_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_long_long, c_null_char
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use lopin_checked_file, only : file_begin, file_end, file_rename, file_append, file_go_on, &
      & file_kind, file_is_there, file_read, cannot_write, has_shrunk
   use lopin_error, only : error_type, error_code, raise
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: write_atomically, make_folder, remove_file, file_exists, read_text, log_file_type
   public :: written_mark, is_foreign, has_lost

   !> Stands in the first lines of XML files of ours, which may therefore be replaced.
   character(len=*), parameter :: written_mark = '<!-- written by Lopin -->'
   character(len=*), parameter :: part = '.part'

   !> A file that grows by whole lines. It is made beside its place, and `commit` gives it its name.
   type :: log_file_type
      character(len=:), allocatable :: path
      logical :: is_open = .false.
      logical, private :: in_place = .false.   !! it has its name
      integer(c_int), private :: file = -1
      integer(int64), private :: length = 0    !! bytes written
   contains
      procedure :: open => open_log
      procedure :: commit => commit_log
      procedure :: keep => keep_log
      procedure :: append
      procedure :: close => close_log
   end type log_file_type

   interface
      function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_mkdir

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
      integer(int8), intent(in), optional, target, contiguous :: bytes(:)
      character(len=*), intent(in), optional :: tail
      logical, intent(in), optional :: lasting   !! on the disk before it takes its name
      integer(c_int) :: file, status, closing, wait
      integer(int64) :: length

      wait = 0
      if (present(lasting)) wait = merge(1_c_int, 0_c_int, lasting)
      length = 0
      status = file_begin(path//part//c_null_char, file)
      if (status == 0) then
         call add(text, len(text, kind=int64))
         if (present(bytes)) call add_bytes(bytes)
         if (present(tail)) call add(tail, len(tail, kind=int64))
         closing = file_end(file, int(length, c_long_long), wait)
         if (status == 0) status = closing
      end if
      if (status == 0) status = file_rename(path//part//c_null_char, path//c_null_char)
      if (status == 0) return
      call remove_file(path//part)
      call cannot_write(path, status, error)
   contains
      subroutine add(piece, n)
         character(kind=c_char), intent(in) :: piece(*)
         integer(int64), intent(in) :: n

         if (status == 0) status = file_append(file, int(length, c_long_long), piece, &
            & int(n, c_long_long))
         length = length + n
      end subroutine add

      subroutine add_bytes(list)
         use, intrinsic :: iso_c_binding, only : c_loc, c_f_pointer
         integer(int8), intent(in), target, contiguous :: list(:)
         character(kind=c_char), pointer :: view(:)

         if (size(list) == 0) return
         call c_f_pointer(c_loc(list), view, [size(list, kind=int64)])
         call add(view, size(list, kind=int64))
      end subroutine add_bytes
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

   !> Take a name away; nothing happens where there is none.
   subroutine remove_file(path)
      character(len=*), intent(in) :: path
      integer(c_int) :: ignored
      ignored = c_unlink(path//c_null_char)
   end subroutine remove_file

   !> Something has this name, be it a symbolic link that leads nowhere.
   logical function file_exists(path)
      character(len=*), intent(in) :: path
      file_exists = file_is_there(path)
   end function file_exists

   !> All of a file; empty if it cannot be read.
   subroutine read_text(path, text)
      character(len=*), intent(in) :: path
      character(len=:), allocatable, intent(out) :: text
      integer :: kind, status
      integer(int64) :: length

      call file_kind(path, kind, length)
      if (kind /= 0) length = 0
      allocate (character(len=length) :: text, stat=status)
      if (status /= 0) then
         text = ''
      else if (length > 0) then
         if (file_read(path//c_null_char, text, int(length, c_long_long)) /= 0) text = ''
      end if
   end subroutine read_text

   !> Does a file exist that has no mark of ours in its first lines?
   logical function is_foreign(path)
      character(len=*), intent(in) :: path
      character(len=128) :: start
      integer :: kind
      integer(int64) :: length

      is_foreign = file_exists(path)
      if (.not. is_foreign) return
      call file_kind(path, kind, length)
      if (kind /= 0) return
      start = ''
      length = min(length, len(start, kind=int64))
      if (file_read(path//c_null_char, start, int(length, c_long_long)) /= 0) return
      is_foreign = index(start, written_mark) == 0
   end function is_foreign

   !> Begin a new log beside its place with its first lines. A log that goes on is left as it is
   !> until `keep` says how far it counts.
   subroutine open_log(self, path, header, error, goes_on)
      class(log_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: header     !! whole lines, or nothing
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: goes_on
      type(error_type), allocatable :: ignored
      integer(c_int) :: status

      call self%close(ignored)
      self%path = path
      self%length = 0
      self%in_place = goes_on
      if (goes_on) return
      status = file_begin(path//part//c_null_char, self%file)
      self%is_open = status == 0
      if (self%is_open) then
         call self%append(header, error)
      else
         call cannot_write(path, status, error)
      end if
   end subroutine open_log

   !> The log takes its place; what stood there is gone.
   subroutine commit_log(self, error)
      class(log_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      if (.not. self%is_open .or. self%in_place) return
      status = file_rename(self%path//part//c_null_char, self%path//c_null_char)
      self%in_place = status == 0
      if (status /= 0) call cannot_write(self%path, status, error)
   end subroutine commit_log

   !> The length to a stream, or back: the file is cut to it.
   subroutine keep_log(self, stream, error)
      class(log_file_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      call stream%pass(self%length)
      if (.not. stream%reading .or. stream%broken) return
      status = file_go_on(self%path//c_null_char, int(self%length, c_long_long), self%file)
      self%is_open = status == 0
      if (has_shrunk(status)) then
         call has_lost(self%path, error)
      else if (status /= 0) then
         call cannot_write(self%path, status, error)
      end if
   end subroutine keep_log

   !> A file that a run goes on with is not what it was.
   subroutine has_lost(path, error)
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error
      call raise(error, error_code%resource, 'E0606', "'"//path//"' has lost what was "// &
         & 'written before the checkpoint', help='run the deck without --resume')
   end subroutine has_lost

   !> All of the lines or, with an error, none.
   subroutine append(self, lines, error)
      class(log_file_type), intent(inout) :: self
      character(len=*), intent(in) :: lines      !! whole lines
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      if (.not. self%is_open) return
      status = file_append(self%file, int(self%length, c_long_long), lines, &
         & len(lines, kind=c_long_long))
      if (status == 0) then
         self%length = self%length + len(lines, kind=int64)
      else
         call cannot_write(self%path, status, error)
      end if
   end subroutine append

   !> Nothing more comes; the log is on the disk. One without a place is given up.
   subroutine close_log(self, error)
      class(log_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      if (.not. self%is_open) return
      self%is_open = .false.
      status = file_end(self%file, int(self%length, c_long_long), 1_c_int)
      if (.not. self%in_place) call remove_file(self%path//part)
      if (status /= 0) call cannot_write(self%path, status, error)
   end subroutine close_log
end module lopin_atomic_file
