!> CRC-32 of bytes, as zlib, gzip and PNG have it (polynomial z'EDB88320', reflected): by it readers
!> find a flipped bit.
module lopin_crc32
   use, intrinsic :: iso_fortran_env, only : int8, int32, int64
   implicit none
   private
   public :: crc32, hexadecimal

   integer(int32), parameter :: polynomial = not(int(z'12477cdf', int32))   !! z'edb88320'

contains

   !> Eight bytes at a time by eight tables ("slicing by 8", Kounavis and Berry 2005); what is left
   !> one by one.
   pure integer(int32) function crc32(before, bytes) result(after)
      integer(int32), intent(in) :: before     !! of the bytes that went before; 0: none
      integer(int8), contiguous, intent(in) :: bytes(:)
      integer(int32) :: t(0:255, 0:7), c, d
      integer(int64) :: i, n

      t = tables()
      c = not(before)
      n = 8*(size(bytes, kind=int64)/8)
      do i = 1, n, 8
         c = ieor(c, transfer(bytes(i:i + 3), 0_int32))
         d = transfer(bytes(i + 4:i + 7), 0_int32)
         c = ieor(ieor(ieor(t(ibits(c, 0, 8), 7), t(ibits(c, 8, 8), 6)), &
            & ieor(t(ibits(c, 16, 8), 5), t(ibits(c, 24, 8), 4))), &
            & ieor(ieor(t(ibits(d, 0, 8), 3), t(ibits(d, 8, 8), 2)), &
            & ieor(t(ibits(d, 16, 8), 1), t(ibits(d, 24, 8), 0))))
      end do
      do i = n + 1, size(bytes, kind=int64)
         c = ieor(ishft(c, -8), t(iand(ieor(c, int(bytes(i), int32)), 255), 0))
      end do
      after = not(c)
   end function crc32

   !> Table k: what a byte becomes after k more zero bytes.
   pure function tables() result(t)
      integer(int32) :: t(0:255, 0:7), c
      integer :: i, k

      do i = 0, 255
         c = int(i, int32)
         do k = 1, 8
            c = ieor(ishft(c, -1), merge(polynomial, 0_int32, btest(c, 0)))
         end do
         t(i, 0) = c
      end do
      do k = 1, 7
         do i = 0, 255
            t(i, k) = ieor(ishft(t(i, k - 1), -8), t(iand(t(i, k - 1), 255), 0))
         end do
      end do
   end function tables

   !> Eight hexadecimal digits.
   pure character(len=8) function hexadecimal(number) result(text)
      integer(int32), intent(in) :: number
      character(len=16), parameter :: digits = '0123456789abcdef'
      integer :: k, d

      do k = 1, 8
         d = ibits(number, 32 - 4*k, 4)
         text(k:k) = digits(d + 1:d + 1)
      end do
   end function hexadecimal
end module lopin_crc32
