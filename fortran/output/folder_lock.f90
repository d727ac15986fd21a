!> A second run in the folder of one that is going on is refused by name (E0607).
module lopin_folder_lock
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_long_long, c_null_char
   use lopin_checked_file, only : cannot_write
   use lopin_error, only : error_type, error_code, raise
   implicit none
   private
   public :: folder_lock_type

   type :: folder_lock_type
      character(len=:), allocatable :: path
      integer(c_int) :: file = -1            !! descriptor; < 0: not held
      logical, private :: signed = .false., was_there = .false.
   contains
      procedure :: take
      procedure :: sign => sign_lock
      procedure :: give
   end type folder_lock_type

   interface
      integer(c_int) function lopin_lock_take(path, file, old, process, machine, n) bind(c)
         import :: c_char, c_int, c_long_long
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(out) :: file, old
         integer(c_long_long), intent(out) :: process
         character(kind=c_char), intent(inout) :: machine(*)
         integer(c_int), value :: n
      end function lopin_lock_take

      subroutine lopin_lock_sign(file) bind(c)
         import :: c_int
         integer(c_int), value :: file
      end subroutine lopin_lock_sign

      subroutine lopin_lock_give(path, file) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: file
      end subroutine lopin_lock_give
   end interface

contains

   !> Lock the files of a job, or say who has.
   subroutine take(self, path, error)
      class(folder_lock_type), intent(inout) :: self
      character(len=*), intent(in) :: path       !! of the lock's own file
      type(error_type), allocatable, intent(out) :: error
      character(len=64) :: machine
      character(len=24) :: number
      character(len=:), allocatable :: who
      integer(c_long_long) :: process
      integer(c_int) :: status, old

      machine = ''
      self%path = path
      status = lopin_lock_take(path//c_null_char, self%file, old, process, machine, 64_c_int)
      self%was_there = old /= 0
      self%signed = .false.
      if (status == 0) return
      self%file = -1
      if (status > 0) then
         call cannot_write(path, status, error)
         return
      end if
      who = 'another run'
      write (number, '(i0)') process
      if (process > 0) who = 'process '//trim(number)//' on '//trim(machine)
      call raise(error, error_code%resource, 'E0607', who//" is writing into '"// &
         & path(:index(path, '/', back=.true.))//"': "//path(index(path, '/', back=.true.) + 1:)// &
         & ' is held', help='wait until it has ended, or choose another folder with -o')
   end subroutine take

   !> The run begins: from now on the file says who holds it.
   subroutine sign_lock(self)
      class(folder_lock_type), intent(inout) :: self

      if (self%file < 0) return
      call lopin_lock_sign(self%file)
      self%signed = .true.
   end subroutine sign_lock

   !> Give it back. A run that was refused before it began leaves what it found.
   subroutine give(self)
      class(folder_lock_type), intent(inout) :: self

      if (self%file < 0) return
      if (self%signed .or. .not. self%was_there) then
         call lopin_lock_give(self%path//c_null_char, self%file)
      else
         call lopin_lock_give(c_null_char, self%file)
      end if
      self%file = -1
   end subroutine give
end module lopin_folder_lock
