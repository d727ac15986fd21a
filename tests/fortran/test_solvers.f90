!> Tests of what all linear solvers share, by a loop over their names.
program test_solvers
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code
   use lopin_csc, only : csc_type, storage
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_solver_factory, only : choose_preconditioner, choose_solver, &
      & new_solver, solver_names
   use lopin_blas_threads, only : set_blas_threads
   use check, only : test, close_to, is_true, finish
   use matrices, only : chain, elastic_block, random_general, random_spd, saddle_point, to_csc, &
      & uniform
   implicit none

   integer, parameter :: number_of_cases = 6
   integer :: which

   do which = 1, size(solver_names)
      call positive_definite_systems(trim(solver_names(which)))
      call condensation(trim(solver_names(which)))
      call saddle_points(trim(solver_names(which)))
      call unsymmetric_systems(trim(solver_names(which)))
      call singular_systems(trim(solver_names(which)))
      call indefinite_taken_for_definite(trim(solver_names(which)))
      call pivot_orders(trim(solver_names(which)))
      call penalty_chains(trim(solver_names(which)))
      call tiny_systems(trim(solver_names(which)))
      call values_change(trim(solver_names(which)))
   end do
   call same_bits_on_two_threads()
   call unknown_names()
   call choices()
   call choices_of_iterations()
   call finish()

contains

   subroutine make_case(which, a)
      integer, intent(in) :: which
      type(csc_type), intent(out) :: a
      integer, allocatable :: top(:)
      integer :: seed

      seed = 100 + which
      select case (which)
      case (1)
         call elastic_block([9, 7], .true., a, top)
      case (2)
         call elastic_block([4, 3, 3], .true., a, top)
      case (3)
         call elastic_block([30, 2], .true., a, top)
      case (4)
         call elastic_block([12, 1, 1], .true., a, top)
      case (5)
         call random_spd(60, 4, seed, a)
      case (6)
         call random_spd(150, 2, seed, a)   ! falls into separate parts
      end select
   end subroutine make_case

   !> Relative to the largest entry.
   subroutine near(what, actual, expected, tolerance)
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: actual(:, :), expected(:, :), tolerance
      call close_to(what, actual/maxval(abs(expected)), expected/maxval(abs(expected)), tolerance)
   end subroutine near

   subroutine fill(x)
      real(wp), intent(out) :: x(:, :)
      integer :: i, j, seed

      seed = 77
      do j = 1, size(x, 2)
         do i = 1, size(x, 1)
            x(i, j) = uniform(seed) - 0.5_wp
         end do
      end do
   end subroutine fill

   !> Analyse and factorise without trouble; false and a failed test otherwise.
   logical function ready(solver, a, class_of, last)
      class(linear_solver_type), intent(inout) :: solver
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of, last(:)
      type(error_type), allocatable :: error
      integer :: bad

      call solver%analyse(a, class_of, last, error)
      if (.not. allocated(error)) call solver%factorise(a, bad, error)
      ready = .not. allocated(error)
      if (ready) then
         call is_true('no bad equation', bad == 0)
      else
         call is_true('factorised: '//error%text(), .false.)
      end if
   end function ready

   subroutine positive_definite_systems(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      real(wp), allocatable :: exact(:, :), x(:, :)
      integer :: c, j

      call test(name//' solves positive definite systems of one and several columns')
      do c = 1, number_of_cases
         call new_solver(solver, name, error)
         call make_case(c, a)
         if (.not. ready(solver, a, matrix_class%positive_definite, [integer ::])) cycle
         allocate (exact(a%n, 3), x(a%n, 3))
         call fill(exact)
         do j = 1, 3
            call a%multiply(exact(:, j), x(:, j))
         end do
         call solver%solve(x(:, 2:2))
         call near('one column', x(:, 2:2), exact(:, 2:2), 1.0e-10_wp)
         call a%multiply(exact(:, 2), x(:, 2))
         call solver%solve(x)
         call near('three columns', x, exact, 1.0e-10_wp)
         call is_true('counts', solver%factor_entries >= a%n .and. solver%flops > 0.0_wp)
         call is_true('pivots', solver%pivot_ratio > 0.0_wp)
         deallocate (exact, x)
      end do
   end subroutine positive_definite_systems

   subroutine condensation(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      integer, allocatable :: last(:)
      integer :: c, k, seed, share

      call test(name//' gives the factor of the matrix condensed onto the last equations')
      call new_solver(solver, name, error)
      if (.not. solver%can_condense(matrix_class%positive_definite)) then
         call make_case(1, a)
         call solver%analyse(a, matrix_class%positive_definite, [3, 1], error)
         call is_true('refused', allocated(error))
         return
      end if
      seed = 9
      do c = 1, number_of_cases
         call make_case(c, a)
         do share = 0, 4   ! none, some, all
            k = (a%n*share)/4
            if (share == 1) k = 1
            call shuffled(a%n, k, seed, last)
            call one_condensation(solver, a, last)
         end do
      end do
   end subroutine condensation

   subroutine one_condensation(solver, a, last)
      class(linear_solver_type), intent(inout) :: solver
      type(csc_type), intent(in) :: a
      integer, intent(in) :: last(:)
      class(linear_solver_type), allocatable :: reference
      type(error_type), allocatable :: error
      real(wp), allocatable :: dense(:, :), schur(:, :), l(:, :), b(:, :), y(:), x(:), columns(:, :)
      integer, allocatable :: others(:)
      integer :: m, i

      m = size(last)
      if (.not. ready(solver, a, matrix_class%positive_definite, last)) return
      allocate (dense(a%n, a%n), l(m, m), b(a%n, 1), y(a%n), x(a%n))
      call a%to_dense(dense)
      others = pack([(i, i=1, a%n)], [(all(last /= i), i=1, a%n)])
      schur = dense(last, last)
      if (size(others) > 0 .and. m > 0) then
         call new_solver(reference, 'dense', error)
         columns = dense(others, last)
         block
            type(csc_type) :: inside
            call to_csc(dense(others, others), storage%symmetric_lower, inside)
            if (.not. ready(reference, inside, matrix_class%positive_definite, [integer ::])) return
         end block
         call reference%solve(columns)
         schur = schur - matmul(dense(last, others), columns)
      end if
      call solver%trailing_factor(l, error)
      call is_true('given', .not. allocated(error))
      if (m > 0) call near('condensed', matmul(l, transpose(l)), schur, 1.0e-10_wp)
      call is_true('lower', all([(maxval(abs(l(:i - 1, i))) <= 0.0_wp .or. i == 1, i=1, m)]))
      call fill(b)
      call solver%forward(b(:, 1), y)
      call solver%backward(y, x)
      call close_to('the halves make the norm', dot_product(y, y)/dot_product(b(:, 1), x), &
         & 1.0_wp, 1.0e-10_wp)
      call solver%solve(b)
      call near('two halves make a solve', reshape(x, [a%n, 1]), b, 1.0e-10_wp)
      y = 0.0_wp
      y(a%n - m + 1:) = [(real(i, wp), i=1, m)]
      call solver%backward(y, x)
      if (m > 0) call near('the last ones alone: L^T x = y', reshape(matmul(transpose(l), &
         & x(last)), [m, 1]), &
         & reshape(y(a%n - m + 1:), [m, 1]), 1.0e-10_wp)
   end subroutine one_condensation

   !> k distinct numbers of 1..n in random order.
   subroutine shuffled(n, k, seed, list)
      integer, intent(in) :: n, k
      integer, intent(inout) :: seed
      integer, allocatable, intent(out) :: list(:)
      integer :: all_of(n), i, j, v

      all_of = [(i, i=1, n)]
      do i = 1, k
         j = i + int(uniform(seed)*(n - i + 1))
         v = all_of(i)
         all_of(i) = all_of(j)
         all_of(j) = v
      end do
      list = all_of(:k)
   end subroutine shuffled

   subroutine saddle_points(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: k, a
      integer, allocatable :: top(:)
      real(wp), allocatable :: exact(:, :), x(:, :)
      integer :: seed, c, m

      call test(name//' solves saddle points, or refuses them by name')
      call new_solver(solver, name, error)
      do c = 1, 3
         if (c == 1) call elastic_block([8, 6], .true., k, top)
         if (c == 2) call elastic_block([4, 3, 3], .true., k, top)
         if (c == 3) call elastic_block([30, 2], .true., k, top)
         seed = 4
         m = size(top)/2
         call saddle_point(k, top, m, seed, a)
         if (solver%accepts(matrix_class%symmetric_indefinite) /= '') then
            call is_true('names itself', index(solver%accepts(matrix_class%symmetric_indefinite), &
               & name) > 0)
            call solver%analyse(a, matrix_class%symmetric_indefinite, top(:0), error)
            call is_true('refused', allocated(error))
            cycle
         end if
         if (.not. ready(solver, a, matrix_class%symmetric_indefinite, top(:0))) cycle
         if (solver%negative >= 0) call is_true('inertia', solver%negative == m)
         allocate (exact(a%n, 1), x(a%n, 1))
         call fill(exact)
         call a%multiply(exact(:, 1), x(:, 1))
         call solver%solve(x)
         call near('solution', x, exact, 1.0e-10_wp)
         deallocate (exact, x)
      end do
   end subroutine saddle_points

   subroutine unsymmetric_systems(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      real(wp) :: exact(80, 2), x(80, 2)
      integer :: seed, j

      call test(name//' solves unsymmetric systems, or refuses them by name')
      call new_solver(solver, name, error)
      seed = 21
      call random_general(80, 5, seed, a)
      if (solver%accepts(matrix_class%general) /= '') then
         call solver%analyse(a, matrix_class%general, [integer ::], error)
         call is_true('refused', allocated(error))
         call is_true('names itself', index(error%text(), name) > 0)
         return
      end if
      if (.not. ready(solver, a, matrix_class%general, [integer ::])) return
      call fill(exact)
      do j = 1, 2
         call a%multiply(exact(:, j), x(:, j))
      end do
      call solver%solve(x)
      call near('solution', x, exact, 1.0e-10_wp)
   end subroutine unsymmetric_systems

   !> A clamped block and a free one in one matrix: the bad equation is one of the free block.
   subroutine singular_systems(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: held, free, a
      integer, allocatable :: top(:)
      integer :: c, bad, last

      call test(name//' finds an equation of the body that nothing holds')
      do c = 1, 4
         call new_solver(solver, name, error)
         if (c == 1) then
            call elastic_block([6, 5], .true., held, top)
            call elastic_block([7, 6], .false., free, top)
         else if (c == 2) then
            call elastic_block([3, 3, 3], .true., held, top)
            call elastic_block([4, 3, 3], .false., free, top)
         else if (c == 3) then
            call elastic_block([40, 2], .true., held, top)
            call elastic_block([300, 2], .false., free, top)
            if (name == 'dense') cycle
         else
            call chain(50, 1.0_wp, held)
            call chain(50, 0.0_wp, free)
            free%value(1) = 1.0_wp   ! let go of the wall
            top = [1, 7, 53, 100, 60]
         end if
         a%n = held%n + free%n
         a%colptr = [held%colptr, held%colptr(held%n + 1) + free%colptr(2:)]
         a%row = [held%row, free%row + held%n]
         a%value = [held%value, free%value]
         do last = 0, 1
            if (last == 1 .and. .not. solver%can_condense(matrix_class%positive_definite)) cycle
            call solver%analyse(a, matrix_class%positive_definite, [top(:5*last)], error)
            call is_true('analysed', .not. allocated(error))
            call solver%factorise(a, bad, error)
            call is_true('singular', allocated(error))
            if (.not. allocated(error)) cycle
            call is_true('code', error%code == error_code%singular)
            call is_true('equation', bad > held%n .and. bad <= a%n)
         end do
      end do
   end subroutine singular_systems

   subroutine indefinite_taken_for_definite(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      integer, allocatable :: top(:)
      integer :: bad, j

      call test(name//' does not pass an indefinite matrix as positive definite')
      call new_solver(solver, name, error)
      if (name == 'umfpack') return   ! LU needs no sign, its answer is right
      call elastic_block([9, 7], .true., a, top)
      do j = 1, a%n   ! shifted into the spectrum
         a%value(a%slot(j, j)) = a%value(a%slot(j, j)) - 0.4_wp
      end do
      call solver%analyse(a, matrix_class%positive_definite, top(:0), error)
      call solver%factorise(a, bad, error)
      call is_true('refused', allocated(error))
      call is_true('equation', bad > 0)
   end subroutine indefinite_taken_for_definite

   !> [[k, 1], [1, 0]]: a multiplier eliminated first has no pivot. Any numbering must do.
   subroutine pivot_orders(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: k, a, permuted
      integer, allocatable :: top(:), order(:)
      real(wp), allocatable :: dense(:, :), x(:, :), reference(:, :)
      integer :: seed, trial

      call new_solver(solver, name, error)
      if (solver%accepts(matrix_class%symmetric_indefinite) /= '') return
      call test(name//' solves a saddle point in any numbering')
      call a%new_from_triplets(2, storage%symmetric_lower, [1, 2], [2, 2], [1.0_wp, 5.0_wp])
      if (.not. ready(solver, a, matrix_class%symmetric_indefinite, [integer ::])) return
      x = reshape([2.0_wp, 3.0_wp], [2, 1])
      call solver%solve(x)
      call close_to('multiplier first', x(:, 1), [-7.0_wp, 2.0_wp], 1.0e-14_wp)
      call elastic_block([5, 4], .true., k, top)
      seed = 8
      call saddle_point(k, top, 4, seed, a)
      allocate (dense(a%n, a%n), reference(a%n, 1))
      call a%to_dense(dense)
      do trial = 0, 5
         call shuffled(a%n, a%n, seed, order)
         if (trial == 0) order = [(a%n + 1 - trial, trial=1, a%n)]
         call to_csc(dense(order, order), storage%symmetric_lower, permuted)
         call new_solver(solver, name, error)
         if (.not. ready(solver, permuted, matrix_class%symmetric_indefinite, [integer ::])) cycle
         call fill(reference)
         x = matmul(dense(order, order), reference)
         call solver%solve(x)
         call near('random numbering', x, reference, 1.0e-10_wp)
      end do
   end subroutine pivot_orders

   !> Twenty springs and a stiff one at the tip: u_i = i u_20/20, exact for any penalty.
   subroutine penalty_chains(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      real(wp) :: x(20, 1), alpha
      integer :: i, p

      call test(name//' keeps the digits of a chain pushed onto a penalty spring')
      call new_solver(solver, name, error)
      do p = 0, 12, 3
         alpha = 10.0_wp**p
         call chain(20, alpha, a)
         if (.not. ready(solver, a, matrix_class%positive_definite, [integer ::])) cycle
         x = 0.0_wp
         x(20, 1) = 1.0_wp + alpha
         call solver%solve(x)
         call close_to('displacement', x(:, 1), [(i/20.0_wp*(1.0_wp + alpha)/(0.05_wp + alpha), &
            & i=1, 20)], 1.0e-12_wp)
      end do
   end subroutine penalty_chains

   subroutine tiny_systems(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      real(wp) :: x(1, 1), none(0, 1)

      call test(name//' takes systems of one equation and of none')
      call new_solver(solver, name, error)
      call a%new_from_triplets(1, storage%symmetric_lower, [1], [1], [4.0_wp])
      if (ready(solver, a, matrix_class%positive_definite, [integer ::])) then
         x = 2.0_wp
         call solver%solve(x)
         call close_to('half', x(1, 1), 0.5_wp, 1.0e-15_wp)
      end if
      call a%new_from_triplets(0, storage%symmetric_lower, [integer ::], [integer ::], &
         & [real(wp) ::])
      if (ready(solver, a, matrix_class%positive_definite, [integer ::])) call solver%solve(none)
      call solver%analyse(a, matrix_class%positive_definite, [1], error)
      call is_true('no such equation', allocated(error))
   end subroutine tiny_systems

   subroutine values_change(name)
      character(len=*), intent(in) :: name
      class(linear_solver_type), allocatable :: solver, other
      type(error_type), allocatable :: error
      type(csc_type) :: a, b
      real(wp), allocatable :: x(:, :), y(:, :)
      integer :: bad

      call test(name//' factorises new values in an old pattern, and serves two matrices at once')
      call new_solver(solver, name, error)
      call new_solver(other, name, error)
      call make_case(1, a)
      call make_case(2, b)
      if (.not. ready(solver, a, matrix_class%positive_definite, [integer ::])) return
      if (.not. ready(other, b, matrix_class%positive_definite, [integer ::])) return
      allocate (x(a%n, 1), y(b%n, 1))
      x = 1.0_wp
      y = 1.0_wp
      call solver%solve(x)
      call other%solve(y)
      a%value = 4.0_wp*a%value
      b%value = 0.5_wp*b%value
      call solver%factorise(a, bad, error)
      call other%factorise(b, bad, error)
      x = 4.0_wp*x
      y = 0.5_wp*y
      call solver%solve(x)
      call other%solve(y)
      call solver%solve(x)
      x = 4.0_wp*x
      block
         real(wp) :: z(a%n, 1)
         z = 1.0_wp
         call solver%solve(z)
         call solver%solve(z)
         call solver%solve(z)
         call near('three solves', x, 64.0_wp*z, 1.0e-10_wp)
      end block
   end subroutine values_change

   subroutine same_bits_on_two_threads()
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      type(csc_type) :: a
      integer, allocatable :: top(:)
      real(wp), allocatable :: x(:, :, :)
      integer :: threads

      call test('skyline gives the same bits on one thread and on two')
      call elastic_block([9, 8, 8], .true., a, top)
      allocate (x(a%n, 2, 2))
      x = 1.0_wp
      do threads = 1, 2
         if (.not. set_blas_threads(threads)) return
         call new_solver(solver, 'skyline', error)
         if (ready(solver, a, matrix_class%positive_definite, &
            & [integer ::])) call solver%solve(x(:, :, threads))
      end do
      call close_to('bits', x(:, :, 2), x(:, :, 1), 0.0_wp)
      if (.not. set_blas_threads(1)) return
   end subroutine same_bits_on_two_threads

   subroutine unknown_names()
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error

      call test('an unknown solver is refused with the names of the known ones')
      call new_solver(solver, 'magic', error)
      call is_true('refused', allocated(error) .and. .not. allocated(solver))
      call is_true('names them', index(error%text(), 'cholmod') > 0 .and. index(error%text(), &
         & 'dense') > 0)
   end subroutine unknown_names

   subroutine choices()
      type(csc_type) :: a
      integer, allocatable :: top(:)
      character(len=:), allocatable :: name, reason

      call test('slender bodies go to skyline, thick ones to cholmod, others to umfpack')
      call elastic_block([300, 4], .true., a, top)
      call choose_solver(a, matrix_class%positive_definite, top(:0), name, reason)
      call is_true('strip: '//reason, name == 'skyline')
      call choose_solver(a, matrix_class%positive_definite, top, name, reason)
      call is_true('strip in contact all along: '//reason, name == 'cholmod')
      call elastic_block([13, 13, 13], .true., a, top)
      call choose_solver(a, matrix_class%positive_definite, top(:0), name, reason)
      call is_true('cube: '//reason, name == 'cholmod')
      call choose_solver(a, matrix_class%general, top(:0), name, reason)
      call is_true('unsymmetric: '//reason, name == 'umfpack')
   end subroutine choices

   !> A factor of single precision pays from half the band on that one of double precision needs.
   subroutine choices_of_iterations()
      call test('iterations change to single precision at their own break-even')
      call is_true('small square', preconditioner([28, 28]) == 'skyline skyline')
      call is_true('square', preconditioner([50, 50]) == 'mixed skyline')
      call is_true('large square', preconditioner([100, 100]) == 'mixed cholmod')
      call is_true('strip of any length', preconditioner([400, 4]) == 'skyline skyline')
      call is_true('small cube', preconditioner([4, 4, 4]) == 'skyline skyline')
      call is_true('cube', preconditioner([8, 8, 8]) == 'mixed skyline')
      call is_true('large cube', preconditioner([13, 13, 13]) == 'mixed cholmod')
   end subroutine choices_of_iterations

   !> What a block gets for iterations, and for one solution.
   function preconditioner(cells) result(names)
      integer, intent(in) :: cells(:)
      character(len=:), allocatable :: names, name, once, reason
      type(csc_type) :: a
      integer, allocatable :: top(:)

      call elastic_block(cells, .true., a, top)
      call choose_preconditioner(a, name, reason)
      call choose_solver(a, matrix_class%positive_definite, top(:0), once, reason)
      names = name//' '//once
   end function preconditioner
end program test_solvers
