!> A fingerprint of real numbers: two runs agree to the last bit if their fingerprints do.
!>
!> FNV-1a with 64 bits over the bytes of the numbers, least significant byte first.
module lopin_checksum
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use, intrinsic :: iso_c_binding, only : c_int8_t, c_int64_t, c_double
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: checksum_type

   integer(int64), parameter :: lower_half = 2_int64**32 - 1

   !> The 64 bits in two halves, so that no product overflows.
   type :: checksum_type
      integer(int64), private :: high = int(z'cbf29ce4', int64), low = int(z'84222325', int64)
   contains
      procedure :: add
      procedure :: add_bytes
      procedure :: add_text
      procedure :: text
      procedure :: keep
   end type checksum_type

   interface
      pure integer(c_int64_t) function lopin_hash_reals(hash, x, n) bind(c)
         import :: c_int64_t, c_double
         integer(c_int64_t), value :: hash, n
         real(c_double), intent(in) :: x(*)
      end function lopin_hash_reals
      pure integer(c_int64_t) function lopin_hash_bytes(hash, bytes, n) bind(c)
         import :: c_int64_t, c_int8_t
         integer(c_int64_t), value :: hash, n
         integer(c_int8_t), intent(in) :: bytes(*)
      end function lopin_hash_bytes
   end interface

contains

   !> Go on with more numbers, in array element order.
   pure subroutine add(self, values)
      class(checksum_type), intent(inout) :: self
      real(wp), intent(in) :: values(:, :)
      integer, parameter :: columns = 64
      real(wp) :: part(size(values, 1), columns)
      integer :: j, n

      do j = 1, size(values, 2), columns
         n = min(columns, size(values, 2) - j + 1)
         part(:, :n) = values(:, j:j + n - 1)
         call set(self, lopin_hash_reals(hash_of(self), part, size(values, 1, int64)*n))
      end do
   end subroutine add

   !> Go on with many bytes, four at a time, and what is left one by one.
   pure subroutine add_bytes(self, bytes)
      class(checksum_type), intent(inout) :: self
      integer(int8), contiguous, intent(in) :: bytes(:)

      call set(self, lopin_hash_bytes(hash_of(self), bytes, size(bytes, kind=int64)))
   end subroutine add_bytes

   !> The 64 bits together.
   pure integer(int64) function hash_of(self)
      class(checksum_type), intent(in) :: self
      hash_of = ior(shiftl(self%high, 32), self%low)
   end function hash_of

   pure subroutine set(self, hash)
      class(checksum_type), intent(inout) :: self
      integer(int64), intent(in) :: hash

      self%high = shiftr(hash, 32)
      self%low = iand(hash, lower_half)
   end subroutine set

   !> Go on with the bytes of a text.
   pure subroutine add_text(self, text)
      class(checksum_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      integer :: i

      do i = 1, len(text)
         call add_word(self, int(ichar(text(i:i)), int64))
      end do
   end subroutine add_text

   pure subroutine add_word(self, word)
      class(checksum_type), intent(inout) :: self
      integer(int64), intent(in) :: word       !! >= 0, below 2**32; FNV-1a takes bytes
      integer(int64) :: product

      self%low = ieor(self%low, word)
      ! The prime is 2**40 + 435.
      product = 435*self%low
      self%high = iand(435*self%high + 256*self%low + shiftr(product, 32), lower_half)
      self%low = iand(product, lower_half)
   end subroutine add_word

   !> The fingerprint so far, to a stream or back.
   subroutine keep(self, stream)
      class(checksum_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%high)
      call stream%pass(self%low)
   end subroutine keep

   !> Sixteen hexadecimal digits.
   pure function text(self)
      class(checksum_type), intent(in) :: self
      character(len=16) :: text
      write (text, '(2z8.8)') self%high, self%low
   end function text
end module lopin_checksum
