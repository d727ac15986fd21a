!> A fingerprint of real numbers: two runs agree to the last bit if their fingerprints do.
!>
!> FNV-1a with 64 bits over the bytes of the numbers, least significant byte first.
module lopin_checksum
   use, intrinsic :: iso_fortran_env, only : int64
   use lopin_kinds, only : wp
   implicit none
   private
   public :: checksum_type

   integer(int64), parameter :: half = 2_int64**32

   !> The 64 bits in two halves, so that no product overflows.
   type :: checksum_type
      integer(int64), private :: high = int(z'cbf29ce4', int64), low = int(z'84222325', int64)
   contains
      procedure :: add
      procedure :: text
   end type checksum_type

contains

   !> Go on with more numbers, in array element order.
   pure subroutine add(self, values)
      class(checksum_type), intent(inout) :: self
      real(wp), intent(in) :: values(:, :)
      integer(int64) :: bits, product
      integer :: i, j, k

      do j = 1, size(values, 2)
         do i = 1, size(values, 1)
            bits = transfer(values(i, j), bits)
            do k = 0, 56, 8
               self%low = ieor(self%low, ibits(bits, k, 8))
               ! The prime is 2**40 + 435.
               product = 435*self%low
               self%high = modulo(435*self%high + 256*self%low + product/half, half)
               self%low = modulo(product, half)
            end do
         end do
      end do
   end subroutine add

   !> Sixteen hexadecimal digits.
   pure function text(self)
      class(checksum_type), intent(in) :: self
      character(len=16) :: text
      write (text, '(2z8.8)') self%high, self%low
   end function text
end module lopin_checksum
