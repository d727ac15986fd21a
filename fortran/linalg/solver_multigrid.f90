!> Conjugate gradients preconditioned by algebraic multigrid (smoothed aggregation, PETSc's GAMG),
!> as the preconditioner of the iterations in double precision: for solids whose factor takes more
!> time or memory than there is. Optional: `is_present` says whether PETSc was found when Lopin was
!> built.
!>
!> A solution here is a few iterations, good for a digit or two: GMRES on the exact matrix with
!> contact is outside (lopin_gmres). Levels are made anew for each matrix, so that nothing is
!> remembered from one factorisation to the next.
module lopin_solver_multigrid
   use, intrinsic :: iso_c_binding, only : c_ptr, c_null_ptr, c_int, c_double, c_associated
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_linear_solver, only : linear_solver_type, matrix_class, class_name, raise_refused, &
      & raise_no_memory, raise_failed
   implicit none
   private
   public :: solver_multigrid_type, is_present

   !> Residual that one solution leaves, and iterations in it; and those of GMRES outside.
   real(wp), parameter :: rough = 0.1_wp, fine = 1.0e-12_wp
   integer, parameter :: most_rough = 60, most_fine = 1000, most_outside = 200

   type :: codes
      integer :: ok = 0, absent = 1, no_memory = 2
   end type codes
   type(codes), parameter :: code = codes()

   type, extends(linear_solver_type) :: solver_multigrid_type
      private
      type(c_ptr) :: handle = c_null_ptr
      integer :: nvertex = 0
      integer(c_int), allocatable :: place(:)   !! (n) 0-based place among those of all vertices
      logical :: to_the_end = .false.           !! iterations until nothing is left
      integer, public :: iterations = 0         !! of all solutions
   contains
      procedure :: name => multigrid_name
      procedure :: accepts => multigrid_accepts
      procedure :: can_condense => never
      procedure :: is_exact
      procedure :: factorise_exactly
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      final :: destroy
   end type solver_multigrid_type

   interface
      pure integer(c_int) function lopin_multigrid_present() bind(c)
         import :: c_int
      end function lopin_multigrid_present
      integer(c_int) function lopin_multigrid_create(handle, n, vertices, block, place, modes, &
         & motion, p, i, x) bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), intent(out) :: handle
         integer(c_int), value :: n, vertices, block, modes
         integer(c_int), intent(in) :: place(*), p(*), i(*)
         real(c_double), intent(in) :: motion(*), x(*)
      end function lopin_multigrid_create
      subroutine lopin_multigrid_free(handle) bind(c)
         import :: c_ptr
         type(c_ptr), intent(inout) :: handle
      end subroutine lopin_multigrid_free
      integer(c_int) function lopin_multigrid_solve(handle, tolerance, most, x, iterations) bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), value :: handle
         real(c_double), value :: tolerance
         integer(c_int), value :: most
         real(c_double), intent(inout) :: x(*)
         integer(c_int), intent(out) :: iterations
      end function lopin_multigrid_solve
   end interface

contains

   !> PETSc was found when Lopin was built.
   pure logical function is_present()
      is_present = lopin_multigrid_present() /= 0
   end function is_present

   function multigrid_name(self) result(name)
      class(solver_multigrid_type), intent(in) :: self
      character(len=:), allocatable :: name
      associate (unused => self)
         name = 'multigrid'
      end associate
   end function multigrid_name

   function multigrid_accepts(self, class_of) result(reason)
      class(solver_multigrid_type), intent(in) :: self
      integer, intent(in) :: class_of
      character(len=:), allocatable :: reason

      associate (unused => self)
         reason = ''
         if (class_of /= matrix_class%positive_definite) reason = &
            & 'is for positive definite matrices, not '//class_name(class_of)//' ones'
         if (.not. is_present()) reason = 'is not in this build (PETSc)'
      end associate
   end function multigrid_accepts

   pure logical function never(self, class_of)
      class(solver_multigrid_type), intent(in) :: self
      integer, intent(in) :: class_of
      associate (unused => self, unused_too => class_of)
         never = .false.
      end associate
   end function never

   pure logical function is_exact(self)
      class(solver_multigrid_type), intent(in) :: self
      is_exact = self%to_the_end
   end function is_exact

   !> Places of the equations: those of a vertex stand together.
   subroutine analyse(self, a, class_of, last, error)
      class(solver_multigrid_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, filled

      self%most_iterations = most_outside
      call self%begin_analysis(a, class_of, last, .true., error)
      if (allocated(error)) return
      if (size(last) > 0) then
         call raise_refused(error, self%name(), 'keeps no equations last')
         return
      end if
      if (.not. allocated(self%vertices%of)) then
         self%vertices%of = [(i, i=1, a%n)]
         allocate (self%vertices%motion(a%n, 1), source=1.0_wp)
      end if
      if (allocated(self%place)) deallocate (self%place)
      allocate (self%place(a%n))
      self%nvertex = 0
      filled = 0
      do i = 1, a%n
         if (i > 1) then
            if (self%vertices%of(i) == self%vertices%of(i - 1) &
               & .and. filled < self%vertices%places) then
               self%place(i) = self%place(i - 1) + 1
               filled = filled + 1
               cycle
            end if
         end if
         self%place(i) = self%nvertex*self%vertices%places
         self%nvertex = self%nvertex + 1
         filled = 1
      end do
   end subroutine analyse

   subroutine factorise(self, a, bad, error)
      class(solver_multigrid_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      bad = 0
      self%to_the_end = .false.
      call lopin_multigrid_free(self%handle)
      status = lopin_multigrid_create(self%handle, self%n, self%nvertex, self%vertices%places, &
         & self%place, size(self%vertices%motion, 2), self%vertices%motion, a%colptr, a%row, &
         & a%value)
      if (status == code%ok) return
      if (status == code%no_memory) then
         call raise_no_memory(error, self%name(), self%n)
      else
         call raise_failed(error, self%name(), self%n, status)
      end if
   end subroutine factorise

   !> The levels stand; only solutions go on for longer.
   subroutine factorise_exactly(self, a, bad, error)
      class(solver_multigrid_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error

      bad = 0
      if (.not. c_associated(self%handle)) call self%factorise(a, bad, error)
      self%to_the_end = .true.
   end subroutine factorise_exactly

   !> What iterations cannot do (the matrix is not positive definite) leaves x as it was: no worse
   !> than no preconditioner.
   subroutine solve(self, x)
      class(solver_multigrid_type), intent(inout) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)
      real(wp) :: before(size(x, 1))
      integer :: k, iterations, status

      do k = 1, size(x, 2)
         before = x(:, k)
         status = lopin_multigrid_solve(self%handle, merge(fine, rough, self%to_the_end), &
            & merge(most_fine, most_rough, self%to_the_end), x(:, k), iterations)
         self%iterations = self%iterations + iterations
         if (status /= code%ok) x(:, k) = before
      end do
   end subroutine solve

   subroutine destroy(self)
      type(solver_multigrid_type), intent(inout) :: self
      call lopin_multigrid_free(self%handle)
   end subroutine destroy
end module lopin_solver_multigrid
