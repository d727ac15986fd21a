!> A fingerprint of real numbers: two runs agree to the last bit if their fingerprints do.
!>
!> FNV-1a with 64 bits over the bytes of the numbers, least significant byte first.
module lopin_checksum
   use, intrinsic :: iso_fortran_env, only : int8, int32, int64
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

contains

   !> Go on with more numbers, in array element order.
   pure subroutine add(self, values)
      class(checksum_type), intent(inout) :: self
      real(wp), intent(in) :: values(:, :)
      integer(int64) :: bits
      integer :: i, j, k

      do j = 1, size(values, 2)
         do i = 1, size(values, 1)
            bits = transfer(values(i, j), bits)
            do k = 0, 56, 8
               call add_word(self, ibits(bits, k, 8))
            end do
         end do
      end do
   end subroutine add

   !> Go on with many bytes, four at a time, and what is left one by one.
   pure subroutine add_bytes(self, bytes)
      class(checksum_type), intent(inout) :: self
      integer(int8), contiguous, intent(in) :: bytes(:)
      integer(int64) :: i, n

      n = 4*(size(bytes, kind=int64)/4)
      do i = 1, n, 4
         call add_word(self, iand(int(transfer(bytes(i:i + 3), 0_int32), int64), lower_half))
      end do
      do i = n + 1, size(bytes, kind=int64)
         call add_word(self, iand(int(bytes(i), int64), 255_int64))
      end do
   end subroutine add_bytes

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
