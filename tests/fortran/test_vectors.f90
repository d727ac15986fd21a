!> Short vectors.
program test_vectors
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan, ieee_is_nan
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use check, only : test, is_true, finish
   implicit none
   real(wp) :: x(3), longer(11)
   integer :: i

   call test('the largest size of an entry')
   x = [1.0_wp, -3.0_wp, 2.0_wp]
   call is_true('by size', abs(largest(x) - 3.0_wp) < 1.0e-15_wp)
   call is_true('of none', .not. largest(x(:0)) > 0.0_wp)

   call test('what is no number is not passed over')
   x(2) = ieee_value(1.0_wp, ieee_quiet_nan)
   call is_true('one entry', ieee_is_nan(largest(x)))
   longer = [(real(i, wp), i=1, 11)]
   do i = 1, 11
      longer(i) = -20.0_wp
      call is_true('wherever it stands', abs(largest(longer) - 20.0_wp) < 1.0e-15_wp)
      longer(i) = ieee_value(1.0_wp, ieee_quiet_nan)
      call is_true('wherever NaN stands', ieee_is_nan(largest(longer)))
      longer(i) = real(i, wp)
   end do
   call is_true('of a part with steps', abs(largest(longer(1:10:3)) - 10.0_wp) < 1.0e-15_wp)
   call finish()
end program test_vectors
