!> LAPACK on the full matrix: a reference for the others, and for small systems of any class.
module lopin_solver_dense
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_graph, only : number_interior
   use lopin_blas, only : dgetrf, dgetrs, dpotrf, dpotrs, dsytrf, dsytrs, dtrsm
   use lopin_linear_solver, only : linear_solver_type, matrix_class, pivot_tolerance, &
      & raise_singular, raise_refused, refuse_unknown_class
   implicit none
   private
   public :: solver_dense_type

   !> Columns that LAPACK treats together.
   integer, parameter :: block_of_columns = 64

   type, extends(linear_solver_type) :: solver_dense_type
      private
      integer, allocatable :: order(:)       !! (n) place -> equation
      integer, allocatable :: exchange(:)    !! (n) of LAPACK
      real(wp), allocatable :: factor(:, :)  !! (n, n)
   contains
      procedure :: name => dense_name
      procedure :: accepts
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      procedure :: trailing_factor
      procedure :: forward
      procedure :: backward
   end type solver_dense_type

contains

   function dense_name(self) result(name)
      class(solver_dense_type), intent(in) :: self
      character(len=:), allocatable :: name
      associate (unused => self)
         name = 'dense'
      end associate
   end function dense_name

   function accepts(self, class_of) result(reason)
      class(solver_dense_type), intent(in) :: self
      integer, intent(in) :: class_of
      character(len=:), allocatable :: reason

      reason = refuse_unknown_class(class_of)
      if (reason /= '') reason = self%name()//' '//reason
   end function accepts

   subroutine analyse(self, a, class_of, last, error)
      class(solver_dense_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: local(:)
      integer :: m, i
      logical :: distinct

      call self%begin_analysis(a, class_of, last, .false., error)
      if (allocated(error)) return
      call number_interior(a%n, last, local, m, distinct)
      self%order = [pack([(i, i=1, a%n)], local > 0), last]
      self%factor_entries = int(a%n, lk)**2
      self%flops = real(a%n, wp)**3*merge(2.0_wp, 1.0_wp, class_of == matrix_class%general)/3.0_wp
   end subroutine analyse

   subroutine factorise(self, a, bad, error)
      class(solver_dense_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: size_of(self%n)
      integer :: i, info

      bad = 0
      self%negative = -1
      self%pivot_ratio = 0.0_wp
      call load(self, a)
      select case (self%class_of)
      case (matrix_class%positive_definite)
         size_of = [(self%factor(i, i), i=1, self%n)]
         call dpotrf('L', self%n, self%factor, max(1, self%n), info)
         if (info > 0) then
            bad = self%order(info)
            call raise_singular(error, self%name(), bad, self%pivot_ratio, 'not positive definite')
            return
         end if
         self%negative = 0
         call check(self, [(self%factor(i, i)**2, i=1, self%n)], size_of, bad)
      case (matrix_class%symmetric_indefinite)
         size_of = maxval(abs(self%factor), 1)
         call factorise_indefinite(self, size_of, bad)
      case default
         size_of = maxval(abs(self%factor), 1)
         call dgetrf(self%n, self%n, self%factor, max(1, self%n), self%exchange, info)
         call check(self, [(self%factor(i, i), i=1, self%n)], size_of, bad)
      end select
      if (bad > 0) call raise_singular(error, self%name(), bad, self%pivot_ratio, 'singular')
   end subroutine factorise

   !> Put the reordered full matrix into `factor`.
   subroutine load(self, a)
      class(solver_dense_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      real(wp), allocatable :: full(:, :)

      allocate (full(self%n, self%n))
      call a%to_dense(full)
      self%factor = full(self%order, self%order)
      if (allocated(self%exchange)) deallocate (self%exchange)
      allocate (self%exchange(self%n))
   end subroutine load

   !> Bunch and Kaufman: pivots of one or two rows; counts the negative ones.
   subroutine factorise_indefinite(self, size_of, bad)
      class(solver_dense_type), intent(inout) :: self
      real(wp), intent(in) :: size_of(:)
      integer, intent(out) :: bad
      real(wp) :: work(block_of_columns*max(1, self%n)), pivot(self%n), determinant, norm
      integer :: i, info

      call dsytrf('L', self%n, self%factor, max(1, self%n), self%exchange, work, size(work), info)
      self%negative = 0
      i = 1
      do while (i <= self%n)
         pivot(i) = self%factor(i, i)
         if (self%exchange(i) > 0) then
            if (pivot(i) < 0.0_wp) self%negative = self%negative + 1
            i = i + 1
         else   ! a pivot of two rows has one eigenvalue of each sign; the smaller one counts
            norm = abs(self%factor(i, i)) + abs(self%factor(i + 1, i)) + abs(self%factor(i + 1, &
               & i + 1))
            determinant = self%factor(i, i)*self%factor(i + 1, i + 1) - self%factor(i + 1, i)**2
            pivot(i:i + 1) = abs(determinant)/norm
            self%negative = self%negative + 1
            i = i + 2
         end if
      end do
      call check(self, pivot, size_of, bad)
   end subroutine factorise_indefinite

   !> The weakest pivot; `bad` is its equation when it is zero but for rounding.
   subroutine check(self, pivot, size_of, bad)
      class(solver_dense_type), intent(inout) :: self
      real(wp), intent(in) :: pivot(:), size_of(:)
      integer, intent(out) :: bad
      real(wp) :: ratio(self%n)

      bad = 0
      if (self%n == 0) return
      ratio = 0.0_wp
      where (size_of > 0.0_wp) ratio = abs(pivot)/size_of
      self%pivot_ratio = minval(ratio)
      if (.not. self%pivot_ratio > pivot_tolerance(self%n)) bad = self%order(minloc(ratio, 1))
   end subroutine check

   subroutine solve(self, x)
      class(solver_dense_type), intent(inout) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)
      real(wp), allocatable :: y(:, :)
      integer :: info, lead

      lead = max(1, self%n)
      allocate (y(self%n, size(x, 2)))
      y = x(self%order, :)
      select case (self%class_of)
      case (matrix_class%positive_definite)
         call dpotrs('L', self%n, size(y, 2), self%factor, lead, y, lead, info)
      case (matrix_class%symmetric_indefinite)
         call dsytrs('L', self%n, size(y, 2), self%factor, lead, self%exchange, y, lead, info)
      case default
         call dgetrs('N', self%n, size(y, 2), self%factor, lead, self%exchange, y, lead, info)
      end select
      x(self%order, :) = y
   end subroutine solve

   subroutine trailing_factor(self, l, error)
      class(solver_dense_type), intent(inout) :: self
      real(wp), intent(out) :: l(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer :: j, m

      l = 0.0_wp
      if (.not. self%can_condense(self%class_of)) then
         call raise_refused(error, self%name(), 'condenses positive definite matrices only')
         return
      end if
      m = self%n - self%nlast
      do j = 1, self%nlast
         l(j:, j) = self%factor(m + j:, m + j)
      end do
   end subroutine trailing_factor

   subroutine forward(self, b, y)
      class(solver_dense_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)
      real(wp), contiguous, intent(out) :: y(:)

      y = b(self%order)
      call half(self, 'N', y)
   end subroutine forward

   subroutine backward(self, b, y)
      class(solver_dense_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)
      real(wp), contiguous, intent(out) :: y(:)
      real(wp) :: inner(self%n)

      inner = b
      call half(self, 'T', inner)
      y(self%order) = inner
   end subroutine backward

   !> y <- L^-1 y ('N') or L^-T y ('T').
   subroutine half(self, how, y)
      class(solver_dense_type), intent(in) :: self
      character, intent(in) :: how
      real(wp), intent(inout) :: y(self%n, 1)

      call dtrsm('L', 'L', how, 'N', self%n, 1, 1.0_wp, self%factor, max(1, self%n), y, max(1, &
         & self%n))
   end subroutine half
end module lopin_solver_dense
