!> Tests of what is special to lopin_solver_cholmod; what all solvers share is in test_solvers.
program test_cholmod
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_error, only : error_type
   use lopin_linear_solver, only : matrix_class
   use lopin_solver_cholmod, only : solver_cholmod_type
   use check, only : test, close_to, is_true, finish
   use matrices, only : elastic_block, uniform
   implicit none

   call orders_big_solids_by_dissection()
   call separate_bodies_keep_their_order()
   call a_large_free_plate_is_singular()
   call finish()

contains

   subroutine orders_big_solids_by_dissection()
      type(csc_type) :: a
      type(solver_cholmod_type) :: solver
      type(error_type), allocatable :: error
      integer, allocatable :: top(:)
      real(wp), allocatable :: x(:, :), y(:), f(:)
      integer :: bad, seed, i

      call test('a solid is ordered by nested dissection, a plate by minimum degree; both solve')
      call elastic_block([14, 14, 14], .true., a, top)
      call solver%analyse(a, matrix_class%positive_definite, top(:50), error)
      call is_true('analysed', .not. allocated(error))
      call is_true('dissection', solver%ordering == 'METIS')
      call solver%factorise(a, bad, error)
      call is_true('factorised', .not. allocated(error))
      seed = 3
      allocate (x(a%n, 2), y(a%n), f(a%n))
      do i = 1, a%n
         x(i, :) = [uniform(seed), 1.0_wp]
      end do
      call a%multiply(x(:, 1), f)
      y = x(:, 1)
      x(:, 1) = f
      call solver%solve(x)
      call close_to('solution', x(:, 1), y, 1.0e-9_wp)
      call elastic_block([60, 60], .true., a, top)
      call solver%analyse(a, matrix_class%positive_definite, top(:0), error)
      call is_true('analysed again', .not. allocated(error))
      call is_true('minimum degree', solver%ordering == 'AMD')
      call solver%factorise(a, bad, error)
      call is_true('factorised again', .not. allocated(error) .and. solver%flops > 0.0_wp)
   end subroutine orders_big_solids_by_dissection

   subroutine separate_bodies_keep_their_order()
      type(csc_type) :: one, a
      type(solver_cholmod_type) :: solver
      type(error_type), allocatable :: error
      integer, allocatable :: top(:), last(:)
      real(wp), allocatable :: l(:, :), dense(:, :), part(:, :)
      integer :: bad, n, m

      call test('last equations of two bodies, taken in turns, give the factor of each body')
      call elastic_block([8, 5], .true., one, top)
      n = one%n
      m = size(top)
      allocate (last(2*m), l(2*m, 2*m), part(m, m), dense(2*m, 2*m))
      last(1::2) = top
      last(2::2) = top + n
      a%n = 2*n
      a%colptr = [one%colptr, one%colptr(n + 1) + one%colptr(2:)]
      a%row = [one%row, one%row + n]
      a%value = [one%value, 4.0_wp*one%value]
      call solver%analyse(a, matrix_class%positive_definite, last, error)
      call solver%factorise(a, bad, error)
      call solver%trailing_factor(l, error)
      call is_true('factor', .not. allocated(error))
      call solver%analyse(one, matrix_class%positive_definite, top, error)
      call solver%factorise(one, bad, error)
      call solver%trailing_factor(part, error)
      dense = 0.0_wp
      dense(1::2, 1::2) = part
      dense(2::2, 2::2) = 2.0_wp*part
      call close_to('factor', l, dense, 1.0e-12_wp)
   end subroutine separate_bodies_keep_their_order

   !> Rounding leaves its last pivots positive: only their relative size tells.
   subroutine a_large_free_plate_is_singular()
      type(csc_type) :: a
      type(solver_cholmod_type) :: solver
      type(error_type), allocatable :: error
      integer, allocatable :: top(:)
      integer :: bad

      call test('a large plate that nothing holds is singular, a long cantilever is not')
      call elastic_block([120, 120], .false., a, top)
      call solver%analyse(a, matrix_class%positive_definite, top(:0), error)
      call solver%factorise(a, bad, error)
      call is_true('plate', allocated(error) .and. bad > 0)
      call elastic_block([3000, 1], .true., a, top)
      call solver%analyse(a, matrix_class%positive_definite, top(:0), error)
      call solver%factorise(a, bad, error)
      call is_true('cantilever', .not. allocated(error) .and. bad == 0)
   end subroutine a_large_free_plate_is_singular
end program test_cholmod
