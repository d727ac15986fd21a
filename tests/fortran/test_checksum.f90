!> The fingerprint of real numbers.
program test_checksum
   use lopin_kinds, only : wp
   use lopin_checksum, only : checksum_type
   use check, only : test, is_true, equal_text, finish
   implicit none
   type(checksum_type) :: whole, parts
   real(wp) :: x(3, 4)
   integer :: i

   call test('the checksum is FNV-1a of the bytes')
   call equal_text('of nothing', whole%text(), 'CBF29CE484222325')
   call whole%add(reshape([0.0_wp], [1, 1]))
   call equal_text('of eight zero bytes', whole%text(), 'A8C7F832281A39C5')

   call test('it goes on from part to part and sees the last bit')
   whole = checksum_type()
   x = reshape([(1.0_wp/real(i, wp), i=1, 12)], [3, 4])
   call whole%add(x)
   call parts%add(x(:, :2))
   call parts%add(x(:, 3:))
   call equal_text('in parts', parts%text(), whole%text())
   x(2, 3) = nearest(x(2, 3), 1.0_wp)
   parts = checksum_type()
   call parts%add(x)
   call is_true('another bit', parts%text() /= whole%text())

   call test('zeros count as they do one by one')
   whole = checksum_type()
   parts = checksum_type()
   x = 0.0_wp
   x(:2, :) = 1.0_wp
   call whole%add(x)
   do i = 1, 4
      call parts%add(x(:2, i:i))
      call parts%add_text(repeat(achar(0), 8))
   end do
   call equal_text('as eight bytes', parts%text(), whole%text())
   call finish()
end program test_checksum
