!> How bytes reach the disk: `checked_file.c` for Fortran, and its failures as errors (E0602).
module lopin_checked_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_long_long, c_null_char
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_error, only : error_type, error_code, raise
   implicit none
   private
   public :: file_begin, file_end, file_rename, file_append, file_new_end, file_go_on
   public :: write_all, sync_folder, file_kind, file_is_there, file_read
   public :: summary_is, summary_failed, cannot_write, reason_of, kind_word
   public :: has_left, is_closed, has_shrunk

   interface
      !> Text to a descriptor; 0 or an errno.
      integer(c_int) function write_all(file, text, n) bind(c, name='lopin_write_all')
         import :: c_char, c_int, c_long_long
         integer(c_int), value :: file
         character(kind=c_char), intent(in) :: text(*)
         integer(c_long_long), value :: n
      end function write_all

      integer(c_int) function file_begin(part, file) bind(c, name='lopin_file_begin')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: part(*)
         integer(c_int), intent(out) :: file
      end function file_begin

      integer(c_int) function file_end(file, length, lasting) bind(c, name='lopin_file_end')
         import :: c_int, c_long_long
         integer(c_int), value :: file, lasting
         integer(c_long_long), value :: length
      end function file_end

      integer(c_int) function file_rename(part, path) bind(c, name='lopin_file_rename')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: part(*), path(*)
      end function file_rename

      integer(c_int) function file_append(file, length, text, n) bind(c, name='lopin_file_append')
         import :: c_char, c_int, c_long_long
         integer(c_int), value :: file
         integer(c_long_long), value :: length, n
         character(kind=c_char), intent(in) :: text(*)
      end function file_append

      !> Replace what follows `at` in a file of `length` bytes by a longer text.
      integer(c_int) function file_new_end(file, at, length, text, n) &
         & bind(c, name='lopin_file_new_end')
         import :: c_char, c_int, c_long_long
         integer(c_int), value :: file
         integer(c_long_long), value :: at, length, n
         character(kind=c_char), intent(in) :: text(*)
      end function file_new_end

      integer(c_int) function file_go_on(path, length, file) bind(c, name='lopin_file_go_on')
         import :: c_char, c_int, c_long_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long_long), value :: length
         integer(c_int), intent(out) :: file
      end function file_go_on

      integer(c_int) function sync_folder(file) bind(c, name='lopin_sync_folder')
         import :: c_int
         integer(c_int), value :: file
      end function sync_folder

      integer(c_int) function c_file_kind(path, length) bind(c, name='lopin_file_kind')
         import :: c_char, c_int, c_long_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_long_long), intent(out) :: length
      end function c_file_kind

      integer(c_int) function c_is_there(path) bind(c, name='lopin_file_is_there')
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
      end function c_is_there

      integer(c_int) function file_read(path, text, n) bind(c, name='lopin_file_read')
         import :: c_char, c_int, c_long_long
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(inout) :: text(*)
         integer(c_long_long), value :: n
      end function file_read

      !> What a summary says if the process must end at once; without a path nothing.
      subroutine summary_is(path, text) bind(c, name='lopin_summary_is')
         import :: c_char
         character(kind=c_char), intent(in) :: path(*), text(*)
      end subroutine summary_is

      !> The run has failed, and nothing longer can be written.
      subroutine summary_failed(code) bind(c, name='lopin_summary_failed')
         import :: c_int
         integer(c_int), value :: code         !! of the exit
      end subroutine summary_failed

      integer(c_int) function c_reason(status, text, n) bind(c, name='lopin_reason')
         import :: c_char, c_int
         integer(c_int), value :: status, n
         character(kind=c_char), intent(out) :: text(*)
      end function c_reason
   end interface

   !> Classes of `lopin_reason`.
   integer(c_int), parameter :: full = 1, too_long = 2, forbidden = 3, link = 4, left = 5, &
      & shorter = 6, unopened = 7

contains

   !> Is there something with this name, a link that leads nowhere included?
   logical function file_is_there(path)
      character(len=*), intent(in) :: path
      file_is_there = c_is_there(path//c_null_char) /= 0
   end function file_is_there

   !> 0: a file that can be read; else see `kind_word`.
   subroutine file_kind(path, kind, length)
      character(len=*), intent(in) :: path
      integer, intent(out) :: kind
      integer(int64), intent(out) :: length      !! bytes
      integer(c_long_long) :: n

      kind = int(c_file_kind(path//c_null_char, n))
      length = int(n, int64)
   end subroutine file_kind

   !> Why something cannot be read as a file.
   pure function kind_word(kind) result(text)
      integer, intent(in) :: kind                !! of `file_kind`
      character(len=:), allocatable :: text

      select case (kind)
      case (1)
         text = 'there is no such file'
      case (2)
         text = 'it is a folder'
      case (3)
         text = 'it is a pipe (FIFO), and only files are read'
      case (4)
         text = 'it is a device or a socket, and only files are read'
      case default
         text = 'its rights do not allow it to be read'
      end select
   end function kind_word

   !> The words of the system for a failure.
   function reason_of(status) result(text)
      integer(c_int), intent(in) :: status       !! errno
      character(len=:), allocatable :: text
      character(len=80) :: said
      integer(c_int) :: ignored

      said = ''
      ignored = c_reason(status, said, int(len(said), c_int))
      text = trim(said)
   end function reason_of

   !> Whoever read a stream has left.
   logical function has_left(status)
      integer(c_int), intent(in) :: status       !! errno
      character(len=1) :: unused
      has_left = c_reason(status, unused, 1_c_int) == left
   end function has_left

   !> A stream that whoever started us has closed: nobody asks for what goes there.
   logical function is_closed(status)
      integer(c_int), intent(in) :: status       !! errno
      character(len=1) :: unused
      is_closed = c_reason(status, unused, 1_c_int) == unopened
   end function is_closed

   !> `file_go_on` found a file that is gone or shorter than it was.
   logical function has_shrunk(status)
      integer(c_int), intent(in) :: status       !! errno
      character(len=1) :: unused
      has_shrunk = c_reason(status, unused, 1_c_int) == shorter
   end function has_shrunk

   !> The error of a file that cannot be written, with what helps against its cause.
   subroutine cannot_write(path, status, error)
      character(len=*), intent(in) :: path
      integer(c_int), intent(in) :: status       !! errno
      type(error_type), allocatable, intent(out) :: error
      character(len=1) :: unused
      character(len=:), allocatable :: help

      select case (c_reason(status, unused, 1_c_int))
      case (full)
         help = 'free space on that disk, then'
      case (too_long)
         help = 'raise the limit of file sizes (ulimit -f), then'
      case (forbidden)
         help = 'make the folder and its files writable, then'
      case (link)
         help = 'remove the symbolic link, which Lopin does not follow, then'
      case default
         help = 'see to the disk, then'
      end select
      call raise(error, error_code%resource, 'E0602', "cannot write '"//path//"': "// &
         & reason_of(status), help=help//' the same command with --resume goes on from the '// &
         & 'last checkpoint, if there is one')
   end subroutine cannot_write
end module lopin_checked_file
