!> One factorised stiffness with the equations that contact touches kept last.
!>
!> The trailing block of the factor is the exact condensation of everything else, so that contact is
!> solved on it, and one forward and one backward pass a load are all that the whole system sees.
module lopin_linear_system
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_clock, only : clock_type, counter_type, phase
   use lopin_csc, only : csc_type
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_solver_factory, only : new_solver, choose_solver
   use lopin_text, only : lower
   use lopin_constraints, only : constraints_type
   use lopin_reduce_matrix, only : reduce_matrix
   implicit none
   private
   public :: linear_system_type, new_linear_system, condense_load, recover

   type :: linear_system_type
      class(linear_solver_type), allocatable :: solver
      integer :: n = 0, nlast = 0
      integer, allocatable :: number(:)   !! (neq) row in the factorised matrix; 0: supported
                                          !! artificially
      integer, allocatable :: equation(:)      !! (n) the reverse
      integer, allocatable :: place(:)   !! (neq) place among the equations kept last; 0: not kept
      logical :: splits = .true.               !! the solver has forward and backward passes
      real(wp), allocatable :: l(:, :)         !! (nlast, nlast) factor of the condensation
      character(len=:), allocatable :: reason  !! why this solver
   end type linear_system_type

contains

   !> Factorise. `retained` are the free equations kept last, `support` those left out.
   subroutine new_linear_system(self, k, constraints, support, retained, wish, clock, counter, &
      & bad, error)
      type(linear_system_type), intent(out) :: self
      type(csc_type), intent(in) :: k
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: support(:), retained(:)
      character(len=*), intent(in) :: wish          !! AUTO or a solver's word
      type(clock_type), intent(inout) :: clock
      type(counter_type), intent(inout) :: counter
      integer, intent(out) :: bad                   !! free equation that failed; 0: none
      type(error_type), allocatable, intent(out) :: error
      type(csc_type) :: reduced
      integer :: i
      character(len=:), allocatable :: name

      bad = 0
      allocate (self%number(constraints%neq), self%place(constraints%neq), source=0)
      self%number = 1
      self%number(support) = 0
      self%equation = pack([(i, i=1, constraints%neq)], self%number == 1)
      self%n = size(self%equation)
      self%number(self%equation) = [(i, i=1, self%n)]
      self%nlast = size(retained)
      self%place(retained) = [(i, i=1, self%nlast)]
      call reduce_matrix(k, constraints, self%number, self%n, reduced)
      call clock%stop_in(phase%assemble)
      name = lower(wish)
      self%reason = 'as asked'
      if (name == 'auto') call choose_solver(reduced, matrix_class%positive_definite, &
         & self%number(retained), &
         & name, self%reason)
      call new_solver(self%solver, name, error)
      if (allocated(error)) return
      self%splits = self%solver%can_condense(matrix_class%positive_definite)
      if (.not. self%splits .and. self%nlast > 0) then
         call raise(error, error_code%usage, 'E0705', 'solver '//name// &
            & ' cannot keep the contact equations last', &
            & help='use skyline, cholmod or dense, or *LOPIN, PATH=NEWTON, which does not condense')
         return
      end if
      call self%solver%analyse(reduced, matrix_class%positive_definite, self%number(retained), &
         & error)
      call clock%stop_in(phase%analyse)
      if (allocated(error)) return
      call self%solver%factorise(reduced, bad, error)
      counter%factorisations = counter%factorisations + 1
      if (bad > 0) bad = self%equation(bad)
      if (allocated(error)) return
      allocate (self%l(self%nlast, self%nlast))
      if (self%nlast > 0) call self%solver%trailing_factor(self%l, error)
      call clock%stop_in(phase%factorise)
   end subroutine new_linear_system

   !> Forward pass of a load; what it does on the equations kept last is `l` times the end of `y`.
   subroutine condense_load(self, right, y, load)
      type(linear_system_type), intent(inout) :: self
      real(wp), intent(in) :: right(:)               !! (neq) [force]
      real(wp), allocatable, intent(out) :: y(:)     !! (n)
      real(wp), allocatable, intent(out) :: load(:)  !! (nlast) condensed load [force]
      real(wp), allocatable :: b(:)
      integer :: j

      allocate (b(self%n), y(self%n), load(self%nlast))
      b(:) = right(self%equation)
      load = 0.0_wp
      if (.not. self%splits) then
         y = b
         return
      end if
      call self%solver%forward(b, y)
      associate (tail => y(self%n - self%nlast + 1:))
         do j = 1, self%nlast
            load(j:) = load(j:) + self%l(j:, j)*tail(j)
         end do
      end associate
   end subroutine condense_load

   !> Backward pass with contact forces added on the equations kept last.
   subroutine recover(self, y, pushed, v)
      type(linear_system_type), intent(inout) :: self
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: pushed(:)              !! (nlast) contact forces [force]
      real(wp), intent(out) :: v(:)                  !! (neq), zero at artificial supports
      real(wp), allocatable :: z(:), tail(:), x(:), whole(:, :)
      integer :: j

      allocate (z, source=y)
      allocate (tail, source=pushed)
      do j = 1, self%nlast
         tail(j) = tail(j)/self%l(j, j)
         tail(j + 1:) = tail(j + 1:) - self%l(j + 1:, j)*tail(j)
      end do
      z(self%n - self%nlast + 1:) = z(self%n - self%nlast + 1:) + tail
      v = 0.0_wp
      if (.not. self%splits) then
         allocate (whole(self%n, 1))
         whole(:, 1) = y
         call self%solver%solve(whole)
         v(self%equation) = whole(:, 1)
         return
      end if
      allocate (x(self%n))
      call self%solver%backward(z, x)
      v(self%equation) = x
   end subroutine recover
end module lopin_linear_system
