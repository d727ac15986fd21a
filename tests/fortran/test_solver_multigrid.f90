!> A matrix with multigrid, for iterations.
module coarse_system
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_gmres, only : operator_type
   use lopin_solver_multigrid, only : solver_multigrid_type
   implicit none
   private
   public :: system_type

   !> A matrix with its solver.
   type, extends(operator_type) :: system_type
      type(csc_type) :: a
      type(solver_multigrid_type) :: solver
   contains
      procedure :: multiply
      procedure :: precondition
   end type system_type

contains

   subroutine multiply(self, x, y)
      class(system_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      call self%a%multiply(x, y)
   end subroutine multiply

   subroutine precondition(self, x, y)
      class(system_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      real(wp) :: z(size(x), 1)

      z(:, 1) = x
      call self%solver%solve(z)
      y = z(:, 1)
   end subroutine precondition
end module coarse_system

!> Iterations by multigrid: as good as a factor for GMRES on any mesh; refused where the build has
!> none.
program test_solver_multigrid
   use lopin_kinds, only : wp, ik
   use lopin_error, only : error_type
   use lopin_gmres, only : gmres
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_solver_factory, only : new_solver, prefers_levels
   use lopin_solver_multigrid, only : is_present
   use coarse_system, only : system_type
   use check, only : test, is_true, finish
   use matrices, only : elastic_block
   implicit none
   integer :: small, large

   if (is_present()) then
      call test('iterations on bricks, and hardly more on a finer mesh')
      call solve_block([4, 4, 4], small)
      call solve_block([12, 12, 12], large)
      call is_true('few', small <= 15)
      call is_true('hardly more', large <= small + 8)
      call solve_exactly()
   else
      call test('a build without PETSc says so')
      call refuse()
   end if
   call dear_factors()
   call finish()

contains

   !> Levels take the place of a factor of many operations for each entry, where there are any.
   subroutine dear_factors()
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error

      call test('factors that cost too much')
      call new_solver(solver, 'cholmod', error)
      solver%flops = 3.0e8_wp
      call is_true('a cube', prefers_levels(solver, 1000_ik) .eqv. is_present())
      call is_true('a sheet', .not. prefers_levels(solver, 10000_ik))
   end subroutine dear_factors

   !> A clamped block by GMRES, its nodes as vertices with rigid motions.
   subroutine solve_block(cells, iterations)
      integer, intent(in) :: cells(3)
      integer, intent(out) :: iterations
      type(system_type) :: system
      type(error_type), allocatable :: error
      real(wp), allocatable :: b(:), y(:), r(:)
      real(wp) :: ratio
      integer :: bad, i

      call make_system(system, cells, bad, error)
      call is_true('levels', bad == 0 .and. .not. allocated(error))
      call is_true('not exact', .not. system%solver%is_exact())
      b = [(sin(1.7_wp*i), i=1, system%a%n)]
      allocate (y(size(b)), r(size(b)))
      call gmres(system, b, 1.0e-10_wp, 60, y, iterations, ratio)
      call system%a%multiply(y, r)
      call is_true('solved', norm2(r - b) <= 1.0e-9_wp*norm2(b))
   end subroutine solve_block

   subroutine solve_exactly()
      type(system_type) :: system
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :), r(:)
      integer :: bad

      call test('iterations until nothing is left')
      call make_system(system, [6, 6, 6], bad, error)
      call system%solver%factorise_exactly(system%a, bad, error)
      call is_true('exact', system%solver%is_exact() .and. bad == 0)
      allocate (x(system%a%n, 1), source=1.0_wp)
      allocate (r(system%a%n))
      call system%solver%solve(x)
      call system%a%multiply(x(:, 1), r)
      call is_true('solved', norm2(r - 1.0_wp) <= 1.0e-10_wp*norm2(0.0_wp*r + 1.0_wp))
   end subroutine solve_exactly

   !> Bricks of unit size, the face x = 0 held, with their nodes and rigid motions.
   subroutine make_system(system, cells, bad, error)
      type(system_type), intent(out) :: system
      integer, intent(in) :: cells(3)
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: top(:)
      integer :: i, node, c
      real(wp) :: x(3), axis(3)

      call elastic_block(cells, .true., system%a, top)
      associate (v => system%solver%vertices, nodes => cells + 1)
         v%places = 3
         allocate (v%of(system%a%n), v%motion(system%a%n, 6))
         do i = 1, system%a%n
            v%of(i) = (i - 1)/3 + 1
            c = mod(i - 1, 3) + 1
            ! Nodes of the held face have no equations.
            node = v%of(i) - 1
            x = real([mod(node, cells(1)) + 1, mod(node/cells(1), nodes(2)), &
               & node/(cells(1)*nodes(2))], wp)
            axis = 0.0_wp
            axis(c) = 1.0_wp
            v%motion(i, :3) = axis
            v%motion(i, 4:) = [axis(3)*x(2) - axis(2)*x(3), axis(1)*x(3) - axis(3)*x(1), &
               & axis(2)*x(1) - axis(1)*x(2)]
         end do
      end associate
      bad = -1
      call system%solver%analyse(system%a, matrix_class%positive_definite, [integer ::], error)
      if (allocated(error)) return
      call system%solver%factorise(system%a, bad, error)
   end subroutine make_system

   subroutine refuse()
      type(system_type) :: system
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      integer :: bad

      call make_system(system, [2, 2, 2], bad, error)
      call is_true('analysis', allocated(error))
      call new_solver(solver, 'multigrid', error)
      call is_true('by name', allocated(error))
   end subroutine refuse
end program test_solver_multigrid
