!> Profile solver of Lopin's own: L D L^T without exchanges, best for small and slender bodies.
module lopin_solver_skyline
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_ordering, only : profile_order, row_starts, profile_cost
   use lopin_skyline, only : skyline_type
   use lopin_linear_solver, only : linear_solver_type, matrix_class, class_name, pivot_tolerance, &
      & raise_singular, raise_refused
   implicit none
   private
   public :: solver_skyline_type

   !> Without exchanges an indefinite matrix is safe only while pivots keep half of their digits.
   real(wp), parameter :: indefinite_tolerance = sqrt(epsilon(1.0_wp))

   type, extends(linear_solver_type) :: solver_skyline_type
      private
      integer, allocatable :: order(:)         !! (n) place in the profile -> equation
      integer(lk), allocatable :: target(:)    !! (nnz) place in the profile of each entry
      type(skyline_type) :: profile
   contains
      procedure :: name => skyline_name
      procedure :: accepts
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      procedure :: trailing_factor
      procedure :: forward
      procedure :: backward
   end type solver_skyline_type

contains

   function skyline_name(self) result(name)
      class(solver_skyline_type), intent(in) :: self
      character(len=:), allocatable :: name
      associate (unused => self)
         name = 'skyline'
      end associate
   end function skyline_name

   function accepts(self, class_of) result(reason)
      class(solver_skyline_type), intent(in) :: self
      integer, intent(in) :: class_of
      character(len=:), allocatable :: reason

      reason = ''
      if (class_of == matrix_class%general) reason = self%name()// &
         & ' factorises symmetric matrices only, this one is '//class_name(class_of)
   end function accepts

   subroutine analyse(self, a, class_of, last, error)
      class(solver_skyline_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: first(:), at(:)
      real(wp) :: diagonal(a%n)
      integer :: i, j, k
      logical :: distinct

      call self%begin_analysis(a, class_of, last, .true., error)
      if (allocated(error)) return
      if (class_of == matrix_class%symmetric_indefinite .and. allocated(a%value)) then
         call a%diagonal(diagonal)
         call profile_order(a, last, self%order, distinct, .not. diagonal > 0.0_wp)
      else
         call profile_order(a, last, self%order, distinct)
      end if
      first = row_starts(a, self%order)
      call self%profile%new(first, a%n - self%nlast + 1)
      self%factor_entries = size(self%profile%value, kind=lk)
      self%flops = profile_cost(first)
      allocate (at(a%n))
      at(self%order) = [(i, i=1, a%n)]
      if (allocated(self%target)) deallocate (self%target)
      allocate (self%target(size(a%row)))
      do j = 1, a%n
         do k = a%colptr(j) + 1, a%colptr(j + 1)
            i = at(a%row(k) + 1)
            self%target(k) = self%profile%place(max(i, at(j)), min(i, at(j)))
         end do
      end do
   end subroutine analyse

   subroutine factorise(self, a, bad, error)
      class(solver_skyline_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: tolerance
      integer :: row

      bad = 0
      self%negative = -1
      self%profile%value = 0.0_wp
      self%profile%value(self%target) = a%value
      tolerance = pivot_tolerance(self%n)
      if (self%class_of == matrix_class%symmetric_indefinite) tolerance = indefinite_tolerance
      call self%profile%factorise(tolerance, row, self%pivot_ratio)
      if (row > 0) then
         bad = self%order(row)
         if (self%class_of == matrix_class%positive_definite) then
            call raise_singular(error, self%name(), bad, self%pivot_ratio, 'singular')
         else
            call raise_singular(error, self%name(), bad, self%pivot_ratio, &
               & 'singular, or in need of exchanges,')
         end if
         return
      end if
      self%negative = count(self%profile%pivot < 0.0_wp)
      if (self%negative == 0 .or. self%class_of /= matrix_class%positive_definite) return
      row = findloc(self%profile%pivot < 0.0_wp, .true., 1)
      bad = self%order(row)
      call raise_singular(error, self%name(), bad, -self%pivot_ratio, 'not positive definite')
   end subroutine factorise

   subroutine solve(self, x)
      class(solver_skyline_type), intent(inout) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)
      real(wp), allocatable :: y(:, :)
      integer :: i

      allocate (y(self%n, size(x, 2)))
      y = x(self%order, :)
      call self%profile%forward(size(y, 2), y)
      do i = 1, size(y, 2)
         y(:, i) = y(:, i)/self%profile%pivot
      end do
      call self%profile%backward(size(y, 2), y)
      x(self%order, :) = y
   end subroutine solve

   subroutine trailing_factor(self, l, error)
      class(solver_skyline_type), intent(inout) :: self
      real(wp), intent(out) :: l(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j, m

      l = 0.0_wp
      m = self%n - self%nlast
      if (any(self%profile%pivot(m + 1:) < 0.0_wp)) then
         call raise_refused(error, self%name(), 'the condensed matrix is not positive definite')
         return
      end if
      do j = 1, self%nlast
         l(j, j) = sqrt(self%profile%pivot(m + j))
         do i = j + 1, self%nlast
            l(i, j) = self%profile%entry_of(m + i, m + j)*l(j, j)
         end do
      end do
   end subroutine trailing_factor

   subroutine forward(self, b, y)
      class(solver_skyline_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)
      real(wp), contiguous, intent(out) :: y(:)
      real(wp) :: inner(self%n, 1)

      inner(:, 1) = b(self%order)
      call self%profile%forward(1, inner)
      y = inner(:, 1)/sqrt(self%profile%pivot)
   end subroutine forward

   subroutine backward(self, b, y)
      class(solver_skyline_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)
      real(wp), contiguous, intent(out) :: y(:)
      real(wp) :: inner(self%n, 1)

      inner(:, 1) = b/sqrt(self%profile%pivot)
      call self%profile%backward(1, inner)
      y(self%order) = inner(:, 1)
   end subroutine backward
end module lopin_solver_skyline
