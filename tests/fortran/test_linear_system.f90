!> Equations kept last, also those that join after the factorisation, against dense algebra.
program test_linear_system
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_clock, only : clock_type, counter_type
   use lopin_csc, only : csc_type
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_constraints, only : constraints_type
   use lopin_linear_system, only : linear_system_type, new_linear_system, factorise_system, &
      & widen_system, condense_load, recover
   use matrices, only : elastic_block, uniform
   use check, only : test, close_to, is_true, finish
   implicit none

   real(wp), parameter :: digits = 1.0e-12_wp
   character(len=8), parameter :: solver(3) = [character(len=8) :: 'skyline', 'cholmod', 'dense']
   type(csc_type) :: k
   type(constraints_type) :: constraints
   integer, allocatable :: top(:)
   integer :: i, seed = 7

   call elastic_block([5, 4], .true., k, top)
   call one_equation_a_dof(constraints, k%n)
   do i = 1, size(solver)
      call test('equations join a factor of '//trim(solver(i)))
      call compare(trim(solver(i)))
   end do
   call finish()

contains

   subroutine one_equation_a_dof(c, n)
      type(constraints_type), intent(out) :: c
      integer, intent(in) :: n
      integer :: i

      c%ndof = n
      c%neq = n
      c%first = [(i, i=1, n + 1)]
      c%equation = [(i, i=1, n)]
      c%dof_of_equation = c%equation
      c%coefficient = spread(1.0_wp, 1, n)
   end subroutine one_equation_a_dof

   !> Retained, then two groups that join; one equation is left out, as an artificial support is.
   subroutine compare(name)
      character(len=*), intent(in) :: name
      type(linear_system_type) :: system
      type(clock_type) :: clock
      type(counter_type) :: counter
      type(error_type), allocatable :: error
      integer :: bad

      call new_linear_system(system, constraints%neq, [7], top(:4))
      call factorise_system(system, k, constraints, name, clock, counter, bad, error)
      call is_true('a factor', .not. allocated(error))
      call same_as_dense(system, top(:4))
      call widen_system(system, [3, 20, 11], counter, error)
      call same_as_dense(system, [3, 20, 11, top(:4)])
      call widen_system(system, [top(6), 1], counter, error)
      call same_as_dense(system, [3, 20, 11, top(6), 1, top(:4)])
      call is_true('no factor is made for them', counter%factorisations == 1)
      call is_true('one solve each', counter%back_solves == 5)
   end subroutine compare

   subroutine same_as_dense(system, kept)
      type(linear_system_type), intent(inout) :: system
      integer, intent(in) :: kept(:)           !! in the order of their places
      real(wp), allocatable :: a(:, :), inverse(:, :), right(:), pushed(:), load(:), y(:), v(:), &
         & x(:)
      integer :: i, n, status

      n = k%n
      allocate (a(n, n))
      call k%to_dense(a)
      a(7, :) = 0.0_wp
      a(:, 7) = 0.0_wp
      a(7, 7) = 1.0_wp
      call cholesky(a, status)
      allocate (inverse(n, n), source=0.0_wp)
      do i = 1, n
         inverse(i, i) = 1.0_wp
      end do
      call cholesky_solve(a, inverse)
      call is_true('as many kept', system%nlast == size(kept))
      call is_true('places', all(system%place(kept) == [(i, i=1, size(kept))]))
      ! The condensation's inverse is the compliance of what is kept.
      call close_to('condensation', matmul(matmul(system%l, transpose(system%l)), &
         & inverse(kept, kept)), identity(size(kept)), digits)
      allocate (right(n), pushed(size(kept)), v(n))
      do i = 1, n
         right(i) = uniform(seed) - 0.5_wp
      end do
      right(7) = 0.0_wp
      pushed = [(sin(3.0_wp*i), i=1, size(kept))]
      call condense_load(system, right, y, load)
      call close_to('condensed load', matmul(inverse(kept, kept), load), &
         & matmul(inverse(kept, :), right), digits)
      call recover(system, y, pushed, v)
      x = matmul(inverse, right) + matmul(inverse(:, kept), pushed)
      call close_to('displacements', v, x, digits*maxval(abs(x)))
   end subroutine same_as_dense

   pure function identity(n) result(a)
      integer, intent(in) :: n
      real(wp) :: a(n, n)
      integer :: i

      a = 0.0_wp
      do i = 1, n
         a(i, i) = 1.0_wp
      end do
   end function identity
end program test_linear_system
