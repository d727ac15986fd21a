!> A matrix with its factor, for iterations.
module mixed_system
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_gmres, only : operator_type
   use lopin_solver_mixed, only : solver_mixed_type
   implicit none
   private
   public :: system_type

   !> A matrix with its factor.
   type, extends(operator_type) :: system_type
      type(csc_type) :: a
      type(solver_mixed_type) :: solver
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
end module mixed_system

!> Factors of single precision: how good, when they are refused, and that iterations mend them.
program test_solver_mixed
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : storage
   use lopin_gmres, only : gmres
   use lopin_linear_solver, only : matrix_class
   use mixed_system, only : system_type
   use check, only : test, is_true, finish
   implicit none

   integer, parameter :: m = 9, n = m**3
   real(wp), parameter :: held = 1.0e-2_wp
   type(system_type) :: system
   type(error_type), allocatable :: error
   real(wp) :: x(n, 1), b(n), y(n), ratio
   integer :: bad, iterations, i

   call test('a single factor is a preconditioner in any units')
   b = [(sin(1.7_wp*i)*unit_of(i), i=1, n)]
   call factor(held, 0)
   call is_true('single', .not. system%solver%is_exact() .and. bad == 0)
   call is_true('pivots count from a unit diagonal', system%solver%pivot_ratio > 1.0e-3_wp &
      & .and. system%solver%pivot_ratio < 1.0_wp)
   x(:, 1) = b
   call system%solver%solve(x)
   call is_true('to single precision', off(x(:, 1)) < 1.0e-4_wp .and. off(x(:, 1)) > 1.0e-12_wp)
   call gmres(system, b, 1.0e-12_wp, 20, y, iterations, ratio)
   call is_true('and iterations mend it', ratio <= 1.0e-12_wp .and. iterations <= 5)

   call test('it is exact where that is asked for')
   call system%solver%factorise_exactly(system%a, bad, error)
   call is_true('exact', system%solver%is_exact() .and. bad == 0)
   x(:, 1) = b
   call system%solver%solve(x)
   call is_true('to rounding', off(x(:, 1)) < 1.0e-12_wp)

   call test('what single precision does not bear is factorised in double')
   call factor(1.0e-9_wp, 0)
   call is_true('a body that hardly anything holds', system%solver%is_exact() .and. bad == 0)
   call factor(-1.0_wp, 0)
   call is_true('no factor of what is not positive definite', bad > 0)
   call factor_signed(0)
   call factor_signed(huge(1))
   call factor(held, huge(1))
   call is_true('a small one', system%solver%is_exact() .and. bad == 0)
   call finish()

contains

   !> Springs that are negative at some points, so that a few pivots are.
   subroutine factor_signed(least)
      integer, intent(in) :: least             !! entries of single factors
      integer :: k

      call test('an indefinite matrix keeps the signs of its pivots where that is wanted')
      call factor(held, least)
      do k = 1, n
         if (mod(k, 50) /= 1) cycle
         associate (j => system%a%colptr(k))
            system%a%value(j + 1) = -0.5_wp*system%a%value(j + 1)
         end associate
      end do
      call system%solver%factorise(system%a, bad, error)
      call is_true('none unless it is', bad > 0)
      system%solver%keeps_signs = .true.
      call system%solver%factorise(system%a, bad, error)
      call is_true('single', .not. system%solver%is_exact() .and. bad == 0)
      call is_true('of negative pivots', system%solver%negative > 5)
      x(:, 1) = b
      call system%solver%solve(x)
      call is_true('to single precision', off(x(:, 1)) < 1.0e-3_wp)
      call gmres(system, b, 1.0e-12_wp, 20, y, iterations, ratio)
      call is_true('and iterations mend it', ratio <= 1.0e-12_wp .and. iterations <= 6)
      system%solver%keeps_signs = .false.
   end subroutine factor_signed

   !> Stiffnesses of parts in other units than their neighbours.
   pure real(wp) function unit_of(i)
      integer, intent(in) :: i
      unit_of = merge(1.0e9_wp, 1.0e-9_wp, mod(i, 2) == 0)
   end function unit_of

   !> Springs between the points of a grid, `hold` of each to the ground.
   subroutine factor(hold, least)
      real(wp), intent(in) :: hold
      integer, intent(in) :: least             !! entries of single factors
      integer :: row(4*n), column(4*n), k, j, way(3), count
      real(wp) :: value(4*n), diagonal(n)

      way = [1, m, m*m]
      diagonal = hold
      count = 0
      do j = 1, n
         do k = 1, 3
            if (mod((j - 1)/way(k), m) == m - 1) cycle
            count = count + 1
            row(count) = j + way(k)
            column(count) = j
            value(count) = -unit_of(j)*unit_of(j + way(k))
            diagonal([j, j + way(k)]) = diagonal([j, j + way(k)]) + 1.0_wp
         end do
      end do
      do j = 1, n
         row(count + j) = j
         column(count + j) = j
         value(count + j) = diagonal(j)*unit_of(j)**2
      end do
      call system%a%new_from_triplets(n, storage%symmetric_lower, row(:count + n), &
         & column(:count + n), value(:count + n))
      system%solver%least_entries = least
      call system%solver%analyse(system%a, matrix_class%positive_definite, [integer ::], error)
      call system%solver%factorise(system%a, bad, error)
   end subroutine factor

   !> The residual beside the right-hand side, equation by equation of its unit.
   real(wp) function off(x)
      real(wp), intent(in) :: x(:)
      real(wp) :: r(n)
      integer :: j

      call system%a%multiply(x, r)
      off = norm2([((r(j) - b(j))/unit_of(j), j=1, n)])/norm2([(b(j)/unit_of(j), j=1, n)])
   end function off
end program test_solver_mixed
