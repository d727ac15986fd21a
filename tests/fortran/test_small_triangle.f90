!> Solutions with the triangle of a supernode: every size, beside products with it.
program test_small_triangle
   use, intrinsic :: iso_c_binding, only : c_int, c_float
   use lopin_kinds, only : wp
   use check, only : test, close_to, is_true, finish
   implicit none

   interface
      subroutine solve_forward(l, n, rows, inverse, y) bind(c, name='lopin_solve_forward')
         import :: c_int, c_float
         integer(c_int), value :: n, rows
         real(c_float), intent(in) :: l(*), inverse(*)
         real(c_float), intent(inout) :: y(*)
      end subroutine solve_forward
      subroutine solve_backward(l, n, rows, inverse, y) bind(c, name='lopin_solve_backward')
         import :: c_int, c_float
         integer(c_int), value :: n, rows
         real(c_float), intent(in) :: l(*), inverse(*)
         real(c_float), intent(inout) :: y(*)
      end subroutine solve_backward
   end interface
   integer, parameter :: most = 45
   integer :: n, below, i, j
   real(wp) :: a(most, most), x(most)
   real(c_float) :: y(most + 3)
   real(c_float), allocatable :: l(:, :)

   do n = 1, most
      do below = 0, 2
         call test('a triangle and its transpose, solved')
         call random_number(a)
         call random_number(x)
         allocate (l(n + below, n), source=huge(1.0_c_float))
         do j = 1, n
            do i = j, n
               l(i, j) = real(a(i, j)/n, c_float)
            end do
            l(j, j) = real(0.5_wp + a(j, j), c_float)
            a(:j - 1, j) = 0.0_wp
            a(j:n, j) = real(l(j:n, j), wp)
         end do
         y = -1.0_c_float
         y(:n) = real(matmul(a(:n, :n), x(:n)), c_float)
         call solve_forward(l, n, n + below, [(1.0_c_float/l(i, i), i=1, n)], y)
         call close_to('forward', real(y(:n), wp), x(:n), 2.0e-5_wp)
         y(:n) = real(matmul(transpose(a(:n, :n)), x(:n)), c_float)
         call solve_backward(l, n, n + below, [(1.0_c_float/l(i, i), i=1, n)], y)
         call close_to('backward', real(y(:n), wp), x(:n), 2.0e-5_wp)
         call is_true('nothing else is written', all(y(n + 1:) < 0.0_c_float))
         deallocate (l)
      end do
   end do
   call finish()
end program test_small_triangle
