!> `job.pvd`: the list of outputs. It grows at its end, by the same work for each output, and it is
!> valid XML after each.
module lopin_collection_file
   use, intrinsic :: iso_c_binding, only : c_int, c_long_long, c_null_char
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_atomic_file, only : write_atomically, remove_file, written_mark, has_lost
   use lopin_checked_file, only : file_begin, file_end, file_rename, file_append, file_new_end, &
      & file_go_on, file_kind, file_read, cannot_write
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: collection_file_type

   character(len=1), parameter :: newline = achar(10)
   character(len=*), parameter :: part = '.part'
   character(len=*), parameter :: head = '<?xml version="1.0"?>'//newline//written_mark//newline// &
      & '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">'//newline// &
      & '<Collection>'//newline
   character(len=*), parameter :: tail = '</Collection>'//newline//'</VTKFile>'//newline

   type :: collection_file_type
      private
      character(len=:), allocatable :: path
      logical :: is_open = .false., in_place = .false.
      integer(c_int) :: file = -1
      integer(int64) :: length = 0    !! bytes in front of the tail
   contains
      procedure :: open => open_collection
      procedure :: commit
      procedure :: add
      procedure :: keep
      procedure :: close => close_collection
   end type collection_file_type

contains

   !> Begin an empty list beside its place; one that goes on is left as it is until `keep`.
   subroutine open_collection(self, path, error, goes_on)
      class(collection_file_type), intent(inout) :: self
      character(len=*), intent(in) :: path
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
      if (status == 0) status = file_append(self%file, 0_c_long_long, head//tail, &
         & len(head//tail, kind=c_long_long))
      if (status == 0) then
         self%length = len(head)
      else
         call cannot_write(path, status, error)
      end if
   end subroutine open_collection

   !> The list takes its place; what stood there is gone.
   subroutine commit(self, error)
      class(collection_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      if (.not. self%is_open .or. self%in_place) return
      status = file_rename(self%path//part//c_null_char, self%path//c_null_char)
      self%in_place = status == 0
      if (status /= 0) call cannot_write(self%path, status, error)
   end subroutine commit

   !> All of the lines or, with an error, none.
   subroutine add(self, lines, error)
      class(collection_file_type), intent(inout) :: self
      character(len=*), intent(in) :: lines      !! whole lines
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      status = file_new_end(self%file, int(self%length, c_long_long), &
         & int(self%length + len(tail), c_long_long), lines//tail, &
         & len(lines, kind=c_long_long) + len(tail))
      if (status == 0) then
         self%length = self%length + len(lines, kind=int64)
      else
         call cannot_write(self%path, status, error)
      end if
   end subroutine add

   !> The length to a stream, or back: outputs that came later are taken from the list.
   subroutine keep(self, stream, error)
      class(collection_file_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      integer(c_int) :: status
      integer(int64) :: there
      integer :: kind

      call stream%pass(self%length)
      if (.not. stream%reading .or. stream%broken) return
      call file_kind(self%path, kind, there)
      if (kind /= 0 .or. there < self%length + len(tail)) then
         call has_lost(self%path, error)
         return
      end if
      allocate (character(len=self%length) :: text)
      status = file_read(self%path//c_null_char, text, int(self%length, c_long_long))
      if (status == 0 .and. index(text, head) == 1) then
         call write_atomically(self%path, text//tail, error)
         if (allocated(error)) return
         status = file_go_on(self%path//c_null_char, int(self%length + len(tail), c_long_long), &
            & self%file)
         self%is_open = status == 0
         if (status /= 0) call cannot_write(self%path, status, error)
      else
         call has_lost(self%path, error)
      end if
   end subroutine keep

   !> Nothing more comes; the list is on the disk. One without a place is given up.
   subroutine close_collection(self, error)
      class(collection_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      if (.not. self%is_open) return
      self%is_open = .false.
      status = file_end(self%file, int(self%length + len(tail), c_long_long), 1_c_int)
      if (.not. self%in_place) call remove_file(self%path//part)
      if (status /= 0) call cannot_write(self%path, status, error)
   end subroutine close_collection
end module lopin_collection_file
