!> CRC-32 against published values, in parts as in one.
program test_crc32
   use, intrinsic :: iso_fortran_env, only : int8, int32
   use lopin_crc32, only : crc32, hexadecimal
   use check, only : test, is_true, finish
   implicit none

   integer(int8) :: bytes(1000), other(1000)
   integer :: i, cut

   call test('published values')
   call is_true('nothing', hexadecimal(crc32(0_int32, [integer(int8) ::])) == '00000000')
   ! The check value of the catalogue of parametrised CRC algorithms, CRC-32/ISO-HDLC.
   call is_true('123456789', hexadecimal(crc32(0_int32, transfer('123456789', [0_int8]))) &
      & == 'cbf43926')
   call is_true('a pangram', hexadecimal(crc32(0_int32, transfer('The quick brown fox jumps '// &
      & 'over the lazy dog', [0_int8]))) == '414fa339')
   call test('parts go on from each other')
   bytes = [(int(mod(37*i*i + 11*i, 251) - 125, int8), i=1, 1000)]
   do cut = 0, 40
      call is_true('cut', crc32(crc32(0_int32, bytes(:cut)), bytes(cut + 1:)) &
         & == crc32(0_int32, bytes))
   end do
   call test('one bit is enough')
   do i = 1, 1000
      other = bytes
      other(i) = ieor(other(i), 4_int8)
      call is_true('flipped', crc32(0_int32, other) /= crc32(0_int32, bytes))
   end do
   call finish()
end program test_crc32
