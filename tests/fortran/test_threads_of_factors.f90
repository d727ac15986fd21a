!> Factors by several threads: the same bits whatever their number, on both precisions.
program test_threads_of_factors
   use, intrinsic :: iso_c_binding, only : c_int, c_double, c_ptr
   use lopin_shared_work, only : set_threads_of_run, threads_of_run
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type, storage
   use lopin_linear_solver, only : matrix_class
   use lopin_solver_cholmod, only : solver_cholmod_type
   use lopin_solver_mixed, only : solver_mixed_type
   use check, only : test, close_to, is_true, finish
   implicit none

   !> Cells along each edge of a block; its widest supernode has more columns than a tile.
   integer, parameter :: m = 22, n = m**3
   integer, parameter :: teams(4) = [1, 2, 3, 5]
   type(csc_type) :: a
   integer :: before, i

   interface
      !> Defined in far_factor.c.
      integer(c_int) function far_factor_solve(handle, p, i, a, threads, columns, x) bind(c)
         import :: c_int, c_double, c_ptr
         type(c_ptr), value :: handle
         integer(c_int), intent(in) :: p(*), i(*)
         real(c_double), intent(in) :: a(*)
         integer(c_int), value :: threads, columns
         real(c_double), intent(inout) :: x(*)
      end function far_factor_solve
   end interface

   before = threads_of_run()
   a = block_of_springs(1.0e-2_wp)
   call try_double([integer ::])
   call try_double([(n - 700 + i, i=1, 700)])
   call try_single(a, .false.)
   call try_single(with_negative_springs(), .true.)
   call try_far()
   call try_singular()
   call set_threads_of_run(before)
   call finish()

contains

   subroutine try_double(last)
      integer, intent(in) :: last(:)      !! equations kept last
      type(solver_cholmod_type) :: solver
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), first(:, :), r(:)
      integer :: k, bad

      call test('double precision, '//merge('some equations last', 'all as they come   ', &
         & size(last) > 0))
      call solver%analyse(a, matrix_class%positive_definite, last, error)
      call is_true('analysed', .not. allocated(error))
      do k = 1, size(teams)
         call set_threads_of_run(teams(k))
         call solver%factorise(a, bad, error)
         call is_true('factorised', bad == 0 .and. .not. allocated(error))
         x = reshape([(sin(1.3_wp*i), i=1, n)], [n, 1])
         r = x(:, 1)
         call solver%solve(x)
         if (k == 1) first = x
         call is_true('the same bits', all(abs(x - first) <= 0.0_wp))
      end do
      call close_to('solves', off(a, x(:, 1), r), 0.0_wp, 1.0e-12_wp)
   end subroutine try_double

   !> Places in the factor beyond what short integers count.
   subroutine try_far()
      type(solver_cholmod_type) :: solver
      type(error_type), allocatable :: error
      real(wp) :: x(n, 3), near(n, 3)
      integer :: k, bad, status

      call test('a factor of more than 2**32 entries')
      call solver%analyse(a, matrix_class%positive_definite, [integer ::], error)
      call solver%factorise(a, bad, error)
      near = reshape([(cos(0.7_wp*i), i=1, 3*n)], [n, 3])
      call solver%solve(near)
      do k = 1, 2
         x = reshape([(cos(0.7_wp*i), i=1, 3*n)], [n, 3])
         status = far_factor_solve(solver%symbolic(), a%colptr, a%row, a%value, k, 3, x)
         if (status < 0) return   ! the system does not promise so much memory
         call is_true('solved', status == 0)
         call is_true('the same bits', all(abs(x - near) <= 0.0_wp))
      end do
   end subroutine try_far

   subroutine try_single(matrix, negative)
      type(csc_type), intent(in) :: matrix
      logical, intent(in) :: negative
      type(solver_mixed_type) :: solver
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), first(:, :), r(:)
      integer :: k, bad

      call test('single precision, '//merge('negative pivots too', 'positive definite  ', &
         & negative))
      solver%least_entries = 0
      solver%keeps_signs = negative
      call solver%analyse(matrix, matrix_class%positive_definite, [integer ::], error)
      do k = 1, size(teams)
         call set_threads_of_run(teams(k))
         call solver%factorise(matrix, bad, error)
         call is_true('single', bad == 0 .and. .not. solver%is_exact())
         call is_true('signs', (solver%negative > 0) .eqv. negative)
         x = reshape([(sin(1.3_wp*i), i=1, n)], [n, 1])
         r = x(:, 1)
         call solver%solve(x)
         if (k == 1) first = x
         call is_true('the same bits', all(abs(x - first) <= 0.0_wp))
      end do
      call close_to('solves', off(matrix, x(:, 1), r), 0.0_wp, 1.0e-2_wp)
   end subroutine try_single

   !> A pivot fails in many subtrees at once: the same one is named by any team.
   subroutine try_singular()
      type(solver_cholmod_type) :: solver
      type(error_type), allocatable :: error
      integer :: k, bad, first

      call test('the equation that fails')
      a = with_negative_springs()
      call solver%analyse(a, matrix_class%positive_definite, [integer ::], error)
      do k = 1, size(teams)
         call set_threads_of_run(teams(k))
         if (allocated(error)) deallocate (error)
         call solver%factorise(a, bad, error)
         if (k == 1) first = bad
         call is_true('named', bad > 0 .and. bad == first .and. allocated(error))
      end do
   end subroutine try_singular

   !> Every fiftieth diagonal entry against its sign.
   function with_negative_springs() result(b)
      type(csc_type) :: b
      integer :: k

      b = block_of_springs(1.0e-2_wp)
      do k = 1, n, 50
         b%value(b%colptr(k) + 1) = -0.5_wp*b%value(b%colptr(k) + 1)
      end do
   end function with_negative_springs

   !> Springs between neighbours of a grid along edges and two diagonals; `hold` to the ground.
   function block_of_springs(hold) result(b)
      real(wp), intent(in) :: hold
      type(csc_type) :: b
      integer, parameter :: step(3, 5) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1, 1], &
         & [3, 5])
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
      real(wp) :: diagonal(n)
      integer :: place(3), j, k, count

      allocate (row(6*n), column(6*n), value(6*n))
      diagonal = hold
      count = 0
      do j = 1, n
         place = [mod(j - 1, m), mod((j - 1)/m, m), (j - 1)/m**2]
         do k = 1, size(step, 2)
            if (any(place + step(:, k) >= m)) cycle
            count = count + 1
            row(count) = j + dot_product(step(:, k), [1, m, m*m])
            column(count) = j
            value(count) = -1.0_wp - 0.3_wp*sin(1.0_wp*count)
            diagonal([j, row(count)]) = diagonal([j, row(count)]) - value(count)
         end do
      end do
      row(count + 1:count + n) = [(j, j=1, n)]
      column(count + 1:count + n) = row(count + 1:count + n)
      value(count + 1:count + n) = diagonal
      count = count + n
      call b%new_from_triplets(n, storage%symmetric_lower, row(:count), column(:count), &
         & value(:count))
   end function block_of_springs

   !> The residual beside the right-hand side.
   real(wp) function off(matrix, x, b)
      type(csc_type), intent(in) :: matrix
      real(wp), intent(in) :: x(:), b(:)
      real(wp) :: r(size(b))

      call matrix%multiply(x, r)
      off = norm2(r - b)/norm2(b)
   end function off
end program test_threads_of_factors
