!> CHOLMOD's order and analysis with factors of single precision, for iterations in double.
!>
!> A large factor in single precision costs half the memory and time, to make and to use, and leaves
!> what iterations mend (lopin_gmres): `is_exact` says which kind is at hand. What single precision
!> does not bear, and factors that fit into the caches, are factorised in double precision. Nothing
!> is remembered from one factorisation to the next: a run that goes on from a checkpoint chooses
!> what it would have chosen.
module lopin_solver_mixed
   use, intrinsic :: iso_c_binding, only : c_ptr, c_null_ptr, c_int, c_double, c_associated
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_solver_cholmod, only : solver_cholmod_type
   implicit none
   private
   public :: solver_mixed_type

   !> Entries of a factor from which on single precision pays (docs/solvers.md).
   integer, parameter :: worth_it = 500000
   !> What is left of a pivot must be more than this times the rounding of n eliminations.
   real(wp), parameter :: safe = 8.0_wp*epsilon(1.0)

   type, extends(solver_cholmod_type) :: solver_mixed_type
      private
      type(c_ptr) :: factor = c_null_ptr
      integer, public :: least_entries = worth_it   !! smaller factors are of double precision
      logical :: single = .false.     !! the factor at hand is of single precision
   contains
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      procedure :: is_exact
      procedure :: factorise_exactly
      final :: destroy
   end type solver_mixed_type

   interface
      integer(c_int) function lopin_single_create(factor, handle, p, i) bind(c)
         import :: c_int, c_ptr
         type(c_ptr), intent(out) :: factor
         type(c_ptr), value :: handle
         integer(c_int), intent(in) :: p(*), i(*)
      end function lopin_single_create
      subroutine lopin_single_free(factor) bind(c)
         import :: c_ptr
         type(c_ptr), intent(inout) :: factor
      end subroutine lopin_single_free
      integer(c_int) function lopin_single_factorise(factor, p, i, x, signed, ratio, negative) &
         & bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), value :: factor
         integer(c_int), intent(in) :: p(*), i(*)
         real(c_double), intent(in) :: x(*)
         integer(c_int), value :: signed
         real(c_double), intent(out) :: ratio
         integer(c_int), intent(out) :: negative
      end function lopin_single_factorise
      subroutine lopin_single_solve(factor, x) bind(c)
         import :: c_ptr, c_double
         type(c_ptr), value :: factor
         real(c_double), intent(inout) :: x(*)
      end subroutine lopin_single_solve
   end interface

contains

   subroutine analyse(self, a, class_of, last, error)
      class(solver_mixed_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error

      call lopin_single_free(self%factor)
      self%single = .false.
      call self%solver_cholmod_type%analyse(a, class_of, last, error)
   end subroutine analyse

   subroutine factorise(self, a, bad, error)
      class(solver_mixed_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error

      bad = 0
      self%single = .false.
      if (self%factor_entries >= self%least_entries) call factorise_single(self, a)
      if (self%single) return
      call self%solver_cholmod_type%factorise(a, bad, error)
      if (bad == 0 .or. .not. self%keeps_signs) return
      if (self%factor_entries < self%least_entries) call factorise_single(self, a)
      if (.not. self%single) return
      bad = 0
      if (allocated(error)) deallocate (error)
   end subroutine factorise

   !> Try single precision.
   subroutine factorise_single(self, a)
      type(solver_mixed_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      real(wp) :: ratio
      integer(c_int) :: negative

      if (self%nlast > 0) return
      if (.not. c_associated(self%factor)) then
         if (lopin_single_create(self%factor, self%symbolic(), a%colptr, a%row) /= 0) return
      end if
      if (lopin_single_factorise(self%factor, a%colptr, a%row, a%value, merge(1_c_int, 0_c_int, &
         & self%keeps_signs), ratio, negative) /= 0) return
      if (.not. ratio > safe*sqrt(real(self%n, wp))) return
      self%pivot_ratio = ratio
      self%negative = negative
      self%single = .true.
   end subroutine factorise_single

   subroutine solve(self, x)
      class(solver_mixed_type), intent(inout) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)
      integer :: k

      if (.not. self%single) then
         call self%solver_cholmod_type%solve(x)
         return
      end if
      do k = 1, size(x, 2)
         call lopin_single_solve(self%factor, x(:, k))
      end do
   end subroutine solve

   pure logical function is_exact(self)
      class(solver_mixed_type), intent(in) :: self
      is_exact = .not. self%single
   end function is_exact

   subroutine factorise_exactly(self, a, bad, error)
      class(solver_mixed_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error

      self%single = .false.
      call self%solver_cholmod_type%factorise(a, bad, error)
   end subroutine factorise_exactly

   subroutine destroy(self)
      type(solver_mixed_type), intent(inout) :: self
      call lopin_single_free(self%factor)
   end subroutine destroy
end module lopin_solver_mixed
