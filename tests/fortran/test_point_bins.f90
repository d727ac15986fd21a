!> Points in bins: what lies near is found, whatever the cubes, once each and in the same order.
program test_point_bins
   use lopin_kinds, only : wp
   use lopin_point_bins, only : point_bins_type
   use check, only : test, is_true, finish
   implicit none

   type(point_bins_type) :: bins
   real(wp) :: x(3, 200)
   integer, allocatable :: found(:)
   integer :: i, j, k, missed, twice
   real(wp), parameter :: sides(4) = [1.0e-9_wp, 0.05_wp, 0.3_wp, 5.0_wp]

   do j = 1, 200
      do i = 1, 3
         x(i, j) = modulo(0.618_wp*real(j*(i + 1), wp)*real(i, wp)**2, 1.0_wp)
      end do
   end do
   x(3, 101:) = 0.0_wp
   call test('points near a place')
   do k = 1, size(sides)
      call bins%fill(x, sides(k))
      missed = 0
      twice = 0
      do j = 1, 200
         call bins%near(x(:, j), found)
         do i = 1, 200
            if (norm2(x(:, i) - x(:, j)) < sides(k) .and. .not. any(found == i)) missed = missed + 1
            if (count(found == i) > 1) twice = twice + 1
         end do
      end do
      call is_true('all that are near are found', missed == 0)
      call is_true('each once', twice == 0)
   end do
   call bins%fill(x(:, :1), 1.0_wp)
   call bins%near(x(:, 1), found)
   call is_true('a single point finds itself', size(found) == 1)
   call bins%fill(spread(x(:, 1), 2, 5), 0.0_wp)
   call bins%near(x(:, 1), found)
   call is_true('points in one place', size(found) == 5)
   call finish()
end program test_point_bins
