!> One description of a state for both directions: to bytes and back.
!>
!> A procedure that says `call stream%pass(x)` for every number that it keeps serves writing and
!> reading alike, so that the two cannot drift apart. Every entry carries its kind and shape; what
!> does not fit on reading sets `broken`, and from then on nothing is changed any more.
module lopin_stream
   use, intrinsic :: iso_c_binding, only : c_ptr, c_loc, c_f_pointer
   use, intrinsic :: iso_fortran_env, only : int8, int32, int64
   use lopin_kinds, only : wp
   implicit none
   private
   public :: stream_type

   type :: stream_type
      logical :: reading = .false.
      logical :: broken = .false.          !! on reading: the bytes are not of this description
      integer(int64) :: n = 0              !! bytes in use
      integer(int8), allocatable :: bytes(:)   !! what stands behind `n` is room to grow
      integer(int64), private :: at = 0    !! bytes read
   contains
      generic :: pass => pass_integer, pass_long, pass_real, pass_logical, pass_text, &
         & pass_integers, pass_integer_table, pass_reals, pass_real_table, pass_real_block, &
         & pass_logicals
      generic :: pass_within => integers_within, reals_within
      procedure :: ended
      procedure, private :: pass_integer, pass_long, pass_real, pass_logical, pass_text
      procedure, private :: pass_integers, pass_integer_table, pass_reals, pass_real_table
      procedure, private :: pass_real_block, pass_logicals, integers_within, reals_within
   end type stream_type

   !> What an entry is, times ten, plus its rank.
   integer(int32), parameter :: integers = 10, longs = 20, reals = 30, logicals = 40, texts = 50
   !> Bytes of one number of each.
   integer(int64), parameter :: four = 4, eight = 8
   !> In the place of a shape: not allocated.
   integer(int64), parameter :: absent = -1

contains

   !> All bytes were read.
   pure logical function ended(self)
      class(stream_type), intent(in) :: self
      ended = self%at == self%n
   end function ended

   subroutine pass_integer(self, x)
      class(stream_type), intent(inout) :: self
      integer, intent(inout), target :: x

      call head(self, integers)
      call move(self, c_loc(x), four)
   end subroutine pass_integer

   subroutine pass_long(self, x)
      class(stream_type), intent(inout) :: self
      integer(int64), intent(inout), target :: x

      call head(self, longs)
      call move(self, c_loc(x), eight)
   end subroutine pass_long

   subroutine pass_real(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), intent(inout), target :: x

      call head(self, reals)
      call move(self, c_loc(x), eight)
   end subroutine pass_real

   subroutine pass_logical(self, x)
      class(stream_type), intent(inout) :: self
      logical, intent(inout) :: x
      integer :: flag

      flag = merge(1, 0, x)
      call self%pass(flag)
      if (self%reading .and. .not. self%broken) x = flag == 1
   end subroutine pass_logical

   subroutine pass_text(self, x)
      class(stream_type), intent(inout) :: self
      character(len=:), allocatable, intent(inout), target :: x
      integer(int64) :: length(1)

      length = absent
      if (allocated(x)) length = len(x)
      call head(self, texts, length)
      if (self%broken) return
      if (self%reading) then
         if (allocated(x)) deallocate (x)
         if (length(1) > absent) allocate (character(len=length(1)) :: x)
      end if
      if (length(1) > 0) call move(self, c_loc(x), length(1))
   end subroutine pass_text

   subroutine pass_integers(self, x)
      class(stream_type), intent(inout) :: self
      integer, allocatable, intent(inout), target :: x(:)
      integer(int64) :: extent(1)

      extent = absent
      if (allocated(x)) extent = shape(x)
      call head(self, integers, extent)
      if (self%broken) return
      if (self%reading) then
         if (allocated(x)) deallocate (x)
         if (extent(1) > absent) allocate (x(extent(1)))
      end if
      if (extent(1) > 0) call move(self, c_loc(x), four*extent(1))
   end subroutine pass_integers

   subroutine pass_integer_table(self, x)
      class(stream_type), intent(inout) :: self
      integer, allocatable, intent(inout), target :: x(:, :)
      integer(int64) :: extent(2)

      extent = absent
      if (allocated(x)) extent = shape(x)
      call head(self, integers, extent)
      if (self%broken) return
      if (self%reading) then
         if (allocated(x)) deallocate (x)
         if (extent(1) > absent) allocate (x(extent(1), extent(2)))
      end if
      if (all(extent > 0)) call move(self, c_loc(x), four*product(extent))
   end subroutine pass_integer_table

   subroutine pass_reals(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), allocatable, intent(inout), target :: x(:)
      integer(int64) :: extent(1)

      extent = absent
      if (allocated(x)) extent = shape(x)
      call head(self, reals, extent)
      if (self%broken) return
      if (self%reading) then
         if (allocated(x)) deallocate (x)
         if (extent(1) > absent) allocate (x(extent(1)))
      end if
      if (extent(1) > 0) call move(self, c_loc(x), eight*extent(1))
   end subroutine pass_reals

   subroutine pass_real_table(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), allocatable, intent(inout), target :: x(:, :)
      integer(int64) :: extent(2)

      extent = absent
      if (allocated(x)) extent = shape(x)
      call head(self, reals, extent)
      if (self%broken) return
      if (self%reading) then
         if (allocated(x)) deallocate (x)
         if (extent(1) > absent) allocate (x(extent(1), extent(2)))
      end if
      if (all(extent > 0)) call move(self, c_loc(x), eight*product(extent))
   end subroutine pass_real_table

   subroutine pass_real_block(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), allocatable, intent(inout), target :: x(:, :, :)
      integer(int64) :: extent(3)

      extent = absent
      if (allocated(x)) extent = shape(x)
      call head(self, reals, extent)
      if (self%broken) return
      if (self%reading) then
         if (allocated(x)) deallocate (x)
         if (extent(1) > absent) allocate (x(extent(1), extent(2), extent(3)))
      end if
      if (all(extent > 0)) call move(self, c_loc(x), eight*product(extent))
   end subroutine pass_real_block

   subroutine pass_logicals(self, x)
      class(stream_type), intent(inout) :: self
      logical, allocatable, intent(inout) :: x(:)
      integer, allocatable :: flag(:)

      if (allocated(x)) flag = merge(1, 0, x)
      call self%pass(flag)
      if (self%broken .or. .not. self%reading) return
      if (allocated(x)) deallocate (x)
      if (.not. allocated(flag)) return
      allocate (x(size(flag)))
      x = flag == 1
   end subroutine pass_logicals

   !> An array whose shape is known beforehand and does not change.
   subroutine integers_within(self, x)
      class(stream_type), intent(inout) :: self
      integer, intent(inout) :: x(:)
      integer, allocatable :: list(:)

      allocate (list, source=x)
      call self%pass(list)
      if (.not. self%reading .or. self%broken) return
      self%broken = .not. allocated(list)
      if (self%broken) return
      self%broken = size(list) /= size(x)
      if (.not. self%broken) x = list
   end subroutine integers_within

   !> An array whose shape is known beforehand and does not change.
   subroutine reals_within(self, x)
      class(stream_type), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp), allocatable :: list(:)

      allocate (list, source=x)
      call self%pass(list)
      if (.not. self%reading .or. self%broken) return
      self%broken = .not. allocated(list)
      if (self%broken) return
      self%broken = size(list) /= size(x)
      if (.not. self%broken) x = list
   end subroutine reals_within

   !> Kind and shape of the entry to come; on reading the kind must be the expected one.
   subroutine head(self, kind, extent)
      class(stream_type), intent(inout) :: self
      integer(int32), intent(in) :: kind
      integer(int64), intent(inout), optional, target :: extent(:)
      integer(int32), target :: mark
      integer(int32) :: expected

      mark = kind
      if (present(extent)) mark = kind + size(extent)
      expected = mark
      call move(self, c_loc(mark), four)
      self%broken = self%broken .or. mark /= expected
      if (.not. present(extent) .or. self%broken) return
      call move(self, c_loc(extent), eight*size(extent))
      if (.not. self%reading) return
      ! No array is longer than the bytes that are left.
      self%broken = self%broken .or. any(extent < absent .or. extent > self%n) &
         & .or. product(real(extent, wp)) > real(self%n, wp)
   end subroutine head

   !> Move the bytes of one entry.
   subroutine move(self, where_to, count)
      class(stream_type), intent(inout) :: self
      type(c_ptr), intent(in) :: where_to
      integer(int64), intent(in) :: count
      integer(int8), pointer, contiguous :: view(:)

      if (self%broken) return
      call c_f_pointer(where_to, view, [count])
      if (self%reading) then
         self%broken = self%at + count > self%n
         if (self%broken) return
         view = self%bytes(self%at + 1:self%at + count)
         self%at = self%at + count
      else
         call reserve(self, count)
         self%bytes(self%n + 1:self%n + count) = view
         self%n = self%n + count
      end if
   end subroutine move

   subroutine reserve(self, count)
      class(stream_type), intent(inout) :: self
      integer(int64), intent(in) :: count
      integer(int8), allocatable :: longer(:)

      if (.not. allocated(self%bytes)) allocate (self%bytes(65536))
      if (self%n + count <= size(self%bytes, kind=int64)) return
      allocate (longer(max(2*size(self%bytes, kind=int64), self%n + count)))
      longer(:self%n) = self%bytes(:self%n)
      call move_alloc(longer, self%bytes)
   end subroutine reserve
end module lopin_stream
