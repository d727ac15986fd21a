!> The contract of linear solvers: analyse a pattern once, factorise values, solve, and give the
!> exact condensation onto the equations that were ordered last. A solver that is not exact is the
!> preconditioner of iterations (lopin_gmres).
!>
!> To add one: a file `solver_<name>.f90` that extends this type by `name`, `accepts`, `analyse`,
!> `factorise` and `solve`, and a `case` in the factory. One that condenses also overrides
!> `can_condense`, `trailing_factor`, `forward` and `backward`; a preconditioner overrides
!> `is_exact` and `factorise_exactly`.
module lopin_linear_solver
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_csc, only : csc_type, storage
   use lopin_graph, only : number_interior
   implicit none
   private
   public :: linear_solver_type, vertices_type, matrix_class, class_name
   public :: pivot_tolerance, raise_singular, raise_refused, raise_no_memory, raise_failed
   public :: refuse_unknown_class

   !> What is known of a matrix; a solver refuses by name what it cannot take.
   type :: matrix_classes
      integer :: positive_definite = 1, symmetric_indefinite = 2, general = 3
   end type matrix_classes
   type(matrix_classes), parameter :: matrix_class = matrix_classes()

   !> What solvers with coarse levels know of the equations.
   type :: vertices_type
      integer :: places = 1                    !! equations of a vertex at most
      integer, allocatable :: of(:)            !! (n) vertex of each; those of one stand together
      real(wp), allocatable :: motion(:, :)    !! (n, nmotion) without strain
   end type vertices_type

   type, abstract :: linear_solver_type
      integer :: n = 0                    !! equations
      integer :: nlast = 0                !! equations kept last
      integer :: class_of = 0             !! matrix_class%... of the matrix analysed
      integer(lk) :: factor_entries = 0   !! numbers stored in the factor
      real(wp) :: flops = 0.0_wp          !! of the last factorisation; 0 if unknown
      integer :: negative = -1   !! negative pivots of the last factorisation; -1 if unknown
      integer :: most_iterations = 60     !! of GMRES by what `solve` gives, before something else
                                          !! is tried
      logical :: keeps_signs = .false.    !! set before `factorise`: a matrix announced as positive
                                          !! definite that is not gets a factor with negative pivots
                                          !! from solvers that can, for iterations
      type(vertices_type) :: vertices     !! set before `analyse` where known
      real(wp) :: pivot_ratio = 0.0_wp    !! smallest pivot over the terms that formed it; 0 unknown
   contains
      procedure(name_if), deferred :: name
      procedure(accepts_if), deferred :: accepts
      procedure :: can_condense
      procedure :: orders_by_values
      procedure :: is_exact
      procedure :: factorise_exactly
      procedure(analyse_if), deferred :: analyse
      procedure(factorise_if), deferred :: factorise
      procedure(solve_if), deferred :: solve
      procedure :: trailing_factor
      procedure :: forward => half_solve
      procedure :: backward => half_solve
      procedure :: begin_analysis
   end type linear_solver_type

   abstract interface
      !> The word that selects it: skyline, cholmod, umfpack, dense.
      function name_if(self) result(name)
         import :: linear_solver_type
         class(linear_solver_type), intent(in) :: self
         character(len=:), allocatable :: name
      end function name_if

      !> Empty if matrices of this class (matrix_class%...) are accepted, else the reason.
      function accepts_if(self, class_of) result(reason)
         import :: linear_solver_type
         class(linear_solver_type), intent(in) :: self
         integer, intent(in) :: class_of
         character(len=:), allocatable :: reason
      end function accepts_if

      !> Order and analyse the pattern of `a`; equations `last` (1-based) come last, in this order.
      subroutine analyse_if(self, a, class_of, last, error)
         import :: linear_solver_type, csc_type, error_type
         class(linear_solver_type), intent(inout) :: self
         type(csc_type), intent(in) :: a
         integer, intent(in) :: class_of
         integer, intent(in) :: last(:)
         type(error_type), allocatable, intent(out) :: error
      end subroutine analyse_if

      !> Factorise the values of `a`. If singular, `bad` is the equation (1-based); else 0.
      subroutine factorise_if(self, a, bad, error)
         import :: linear_solver_type, csc_type, error_type
         class(linear_solver_type), intent(inout) :: self
         type(csc_type), intent(in) :: a
         integer, intent(out) :: bad
         type(error_type), allocatable, intent(out) :: error
      end subroutine factorise_if

      !> x <- A^-1 x for all columns.
      subroutine solve_if(self, x)
         import :: linear_solver_type, wp
         class(linear_solver_type), intent(inout) :: self
         real(wp), contiguous, intent(inout) :: x(:, :)   !! (n, nrhs)
      end subroutine solve_if
   end interface

contains

   !> True if trailing_factor, forward and backward work for matrices of this class: a solver whose
   !> factors are each other's transposes has them where the matrix is positive definite.
   pure logical function can_condense(self, class_of)
      class(linear_solver_type), intent(in) :: self
      integer, intent(in) :: class_of
      associate (unused => self)
         can_condense = class_of == matrix_class%positive_definite
      end associate
   end function can_condense

   !> True if `analyse` looks at values too, so that the same pattern may be ordered in two ways.
   pure logical function orders_by_values(self)
      class(linear_solver_type), intent(in) :: self
      associate (unused => self)
         orders_by_values = .false.
      end associate
   end function orders_by_values

   !> The factor at hand solves to rounding; where not, it is good for a preconditioner.
   pure logical function is_exact(self)
      class(linear_solver_type), intent(in) :: self
      associate (unused => self)
         is_exact = .true.
      end associate
   end function is_exact

   !> `factorise`, but exact this time, whatever the solver would choose.
   subroutine factorise_exactly(self, a, bad, error)
      class(linear_solver_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      call self%factorise(a, bad, error)
   end subroutine factorise_exactly

   !> Dense lower L with L L^T = Schur complement on the equations kept last, in their order. A
   !> solver that cannot condense refuses.
   subroutine trailing_factor(self, l, error)
      class(linear_solver_type), intent(inout) :: self
      real(wp), intent(out) :: l(:, :)                 !! (nlast, nlast), zero above the diagonal
      type(error_type), allocatable, intent(out) :: error

      l = 0.0_wp
      call raise_refused(error, self%name(), 'has no factor of a condensed matrix')
   end subroutine trailing_factor

   !> One half of a solve, A = (P^T L)(L^T P). forward: y = L^-1 P b; backward: x = P^T L^-T y.
   !> The last nlast entries of y belong to the equations kept last, in their order. Not a number
   !> from a solver that cannot condense.
   subroutine half_solve(self, b, y)
      class(linear_solver_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)         !! (n)
      real(wp), contiguous, intent(out) :: y(:)        !! (n)

      y = 0.0_wp*b(:self%n)
      y = ieee_value(1.0_wp, ieee_quiet_nan)
   end subroutine half_solve

   !> What a matrix class is called in a message.
   pure function class_name(class_of) result(name)
      integer, intent(in) :: class_of
      character(len=:), allocatable :: name

      select case (class_of)
      case (matrix_class%positive_definite)
         name = 'positive definite'
      case (matrix_class%symmetric_indefinite)
         name = 'symmetric indefinite'
      case default
         name = 'unsymmetric'
      end select
   end function class_name

   !> Why a solver of every class refuses a number that is no class; empty if it is one.
   pure function refuse_unknown_class(class_of) result(reason)
      integer, intent(in) :: class_of
      character(len=:), allocatable :: reason

      reason = ''
      if (all(class_of /= [matrix_class%positive_definite, matrix_class%symmetric_indefinite, &
         & matrix_class%general])) reason = 'does not know this class of matrices'
   end function refuse_unknown_class

   !> Where every `analyse` begins: refuse a matrix of a class, or stored in a way, that this solver
   !> cannot take, and equations that cannot be kept last; else note the sizes of the problem.
   subroutine begin_analysis(self, a, class_of, last, needs_lower, error)
      class(linear_solver_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of        !! matrix_class%...
      integer, intent(in) :: last(:)         !! equations to keep last, 1-based
      logical, intent(in) :: needs_lower     !! the solver reads a lower triangle only
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: local(:)
      integer :: m
      logical :: distinct

      call number_interior(a%n, last, local, m, distinct)
      if (self%accepts(class_of) /= '') then
         call raise_refused(error, self%name(), self%accepts(class_of))
      else if (needs_lower .and. a%kind /= storage%symmetric_lower) then
         call raise_refused(error, self%name(), 'the matrix must be stored by its lower triangle')
      else if (.not. distinct) then
         call raise_refused(error, self%name(), &
            & 'the equations kept last are not distinct equations')
      end if
      if (allocated(error)) return
      self%n = a%n
      self%nlast = size(last)
      self%class_of = class_of
   end subroutine begin_analysis

   !> A pivot smaller than this times the terms that cancelled in it is zero but for rounding.
   !>
   !> Rounding errors of the n eliminations add like a random walk. On 22 free bodies of up to 60000
   !> equations the last pivot was negative or below 4.2 eps sqrt(n); a clamped strip of 3000
   !> elements in a row, the worst sound case tried, has 570 eps sqrt(n).
   pure real(wp) function pivot_tolerance(n)
      integer, intent(in) :: n
      pivot_tolerance = 16.0_wp*epsilon(1.0_wp)*sqrt(real(max(n, 1), wp))
   end function pivot_tolerance

   !> The error of a matrix without a usable pivot at an equation.
   subroutine raise_singular(error, solver, equation, ratio, what)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: solver
      integer, intent(in) :: equation        !! 1-based; 0 if unknown
      real(wp), intent(in) :: ratio          !! pivot over the terms that formed it
      character(len=*), intent(in) :: what   !! e.g. 'singular', 'not positive definite'
      character(len=12) :: value

      write (value, '(es9.2)') ratio
      call raise(error, error_code%singular, 'E0310', 'the matrix is '//what//' at equation '// &
         & to_text(equation)//' (relative pivot '//trim(adjustl(value))//', solver '//solver//')', &
         & help='look for a part that can move freely, or for a constraint stated twice')
   end subroutine raise_singular

   !> The error of a solver asked for what it cannot do.
   subroutine raise_refused(error, solver, reason)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: solver, reason

      call raise(error, error_code%internal, 'E0701', 'solver '//solver//': '//reason)
   end subroutine raise_refused

   !> The error of a factor that does not fit into the memory.
   subroutine raise_no_memory(error, solver, n)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: solver
      integer, intent(in) :: n               !! equations

      call raise(error, error_code%resource, 'E0702', 'not enough memory to factorise '// &
         & to_text(n)//' equations with '//solver)
   end subroutine raise_no_memory

   !> The error of a library that gives up for a reason of its own.
   subroutine raise_failed(error, solver, n, status)
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in) :: solver
      integer, intent(in) :: n               !! equations
      integer, intent(in) :: status          !! what the library returned

      call raise(error, error_code%internal, 'E0703', solver//' could not treat '//to_text(n)// &
         & ' equations (status '//to_text(status)//')')
   end subroutine raise_failed
end module lopin_linear_solver
