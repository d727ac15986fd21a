!> One factorised stiffness with the equations that contact touches kept last.
!>
!> The trailing block of the factor is the exact condensation of everything else, so that contact is
!> solved on it, and one forward and one backward pass a load are all that the whole system sees.
!> Equations that contact turns out to touch later join them by one pass each, without a new factor.
module lopin_linear_system
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_clock, only : clock_type, counter_type, phase
   use lopin_csc, only : csc_type
   use lopin_blas, only : dtrsv
   use lopin_dense, only : cholesky, lower_solve
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_solver_factory, only : new_solver, choose_solver
   use lopin_text, only : lower
   use lopin_constraints, only : constraints_type
   use lopin_reduce_matrix, only : reduce_matrix
   implicit none
   private
   public :: linear_system_type, new_linear_system, factorise_system, condense_load, &
      & recover, recover_kept, widen_system, joins_cheaply

   type :: linear_system_type
      class(linear_solver_type), allocatable :: solver
      integer :: n = 0, nlast = 0
      integer, allocatable :: number(:)   !! (neq) row in the factorised matrix; 0: supported
                                          !! artificially
      integer, allocatable :: equation(:)      !! (n) the reverse
      integer, allocatable :: place(:)   !! (neq) place among the equations kept last; 0: not kept
      logical :: splits = .true.               !! the solver has forward and backward passes
      real(wp), allocatable :: l(:, :)         !! (nlast, nlast) factor of the condensation
      integer, allocatable :: late(:)          !! (nlate) free equations that joined, placed first
      real(wp), allocatable :: own(:, :)   !! (nlate, nlate) their compliance with the others kept
                                           !! last held [length/force]
      real(wp), allocatable :: pass(:, :)      !! (nlast - nlate, nlate) ends of their passes
      character(len=:), allocatable :: reason  !! why this solver
      real(wp), allocatable :: forward(:)      !! (n) pass that is still to go backward; else none
   end type linear_system_type

contains

   !> Rows of the equations in the matrix to be factorised.
   subroutine new_linear_system(self, neq, support, retained)
      type(linear_system_type), intent(out) :: self
      integer, intent(in) :: neq
      integer, intent(in) :: support(:)             !! equations left out
      integer, intent(in) :: retained(:)            !! free equations kept last
      integer :: i

      allocate (self%number(neq), self%place(neq), source=0)
      self%number = 1
      self%number(support) = 0
      self%equation = pack([(i, i=1, neq)], self%number == 1)
      self%n = size(self%equation)
      self%number(self%equation) = [(i, i=1, self%n)]
      self%nlast = size(retained)
      self%place(retained) = [(i, i=1, self%nlast)]
   end subroutine new_linear_system

   !> Factorise the stiffness.
   subroutine factorise_system(self, k, constraints, wish, clock, counter, bad, error)
      type(linear_system_type), intent(inout) :: self   !! of new_linear_system
      type(csc_type), intent(in) :: k
      type(constraints_type), intent(in) :: constraints
      character(len=*), intent(in) :: wish          !! AUTO or a solver's word
      type(clock_type), intent(inout) :: clock
      type(counter_type), intent(inout) :: counter
      integer, intent(out) :: bad                   !! free equation that failed; 0: none
      type(error_type), allocatable, intent(out) :: error
      type(csc_type) :: reduced
      integer :: last(self%nlast), i
      character(len=:), allocatable :: name

      bad = 0
      do i = 1, size(self%place)
         if (self%place(i) > 0) last(self%place(i)) = self%number(i)
      end do
      call reduce_matrix(k, constraints, self%number, self%n, reduced)
      call clock%stop_in(phase%assemble)
      name = lower(wish)
      self%reason = 'as asked'
      if (name == 'auto') call choose_solver(reduced, matrix_class%positive_definite, last, name, &
         & self%reason)
      call new_solver(self%solver, name, error)
      if (allocated(error)) return
      self%splits = self%solver%can_condense(matrix_class%positive_definite)
      if (name == 'multigrid' .or. (.not. self%splits .and. self%nlast > 0)) then
         call refuse_to_condense(name, error)
         return
      end if
      call self%solver%analyse(reduced, matrix_class%positive_definite, last, error)
      call clock%stop_in(phase%analyse)
      if (allocated(error)) return
      call self%solver%factorise(reduced, bad, error)
      counter%factorisations = counter%factorisations + 1
      if (bad > 0) bad = self%equation(bad)
      if (allocated(error)) return
      allocate (self%l(self%nlast, self%nlast), self%late(0), self%own(0, 0))
      allocate (self%pass(self%nlast, 0))
      if (self%nlast > 0) call self%solver%trailing_factor(self%l, error)
      call clock%stop_in(phase%factorise)
   end subroutine factorise_system

   !> To let `number` more equations join costs less than to factorise again with them kept last.
   pure logical function joins_cheaply(self, number)
      type(linear_system_type), intent(in) :: self
      integer, intent(in) :: number
      !> Passes read the factor from memory; factorising works in blocks, so many times faster.
      real(wp), parameter :: slower = 10.0_wp
      real(wp) :: again

      joins_cheaply = .not. self%solver%flops > 0.0_wp
      if (joins_cheaply) return
      again = self%solver%flops + real(self%nlast + number, wp)**3/3.0_wp
      joins_cheaply = 4.0_wp*slower*number*real(self%solver%factor_entries, wp) <= again
   end function joins_cheaply

   !> Keep more free equations last, ahead of the others: two half passes each, no factorisation.
   !>
   !> With the factor K = [L11 0; L21 L][...]^T, y1 = L11^-1 e and y2 = -L^-1 L21 y1 of a load e
   !> on each, the condensation on both is A = (y1^T y1)^-1 and B = -L y2 A beside L L^T: its factor
   !> is [L_A 0; -L y2 L_A, L].
   subroutine widen_system(self, added, counter, error)
      type(linear_system_type), intent(inout) :: self
      integer, intent(in) :: added(:)          !! free equations not kept so far
      type(counter_type), intent(inout) :: counter
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: own(:, :), pass(:, :), l(:, :), y(:), x(:), b(:)
      integer :: j, k, before, m, n

      if (size(added) == 0) return
      if (.not. self%splits) then
         call refuse_to_condense(self%solver%name(), error)
         return
      end if
      before = size(self%late)
      n = before + size(added)
      m = self%nlast - before
      self%late = [self%late, added]
      allocate (own(n, n), pass(m, n), y(self%n), x(self%n), b(self%n), source=0.0_wp)
      own(:before, :before) = self%own
      pass(:, :before) = self%pass
      do j = before + 1, n
         b(self%number(self%late(j))) = 1.0_wp
         call self%solver%forward(b, y)
         b(self%number(self%late(j))) = 0.0_wp
         pass(:, j) = y(self%n - m + 1:)
         y(self%n - m + 1:) = 0.0_wp
         call self%solver%backward(y, x)
         do k = 1, j
            own(k, j) = x(self%number(self%late(k)))
            own(j, k) = own(k, j)
         end do
      end do
      counter%back_solves = counter%back_solves + size(added)
      allocate (l(m + n, m + n), source=0.0_wp)
      l(n + 1:, n + 1:) = self%l(before + 1:, before + 1:)
      call factor_of_inverse(own, l(:n, :n), error)
      if (allocated(error)) return
      l(n + 1:, :n) = -matmul(matmul(l(n + 1:, n + 1:), pass), l(:n, :n))
      where (self%place > 0) self%place = self%place + size(added)
      self%place(self%late) = [(j, j=1, n)]
      self%nlast = m + n
      call move_alloc(l, self%l)
      call move_alloc(own, self%own)
      call move_alloc(pass, self%pass)
   end subroutine widen_system

   !> Lower L with L L^T = A^-1: with the order turned round A = U U^T, and L = U^-T.
   subroutine factor_of_inverse(a, l, error)
      real(wp), intent(in) :: a(:, :)          !! (n, n) positive definite
      real(wp), intent(out) :: l(:, :)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: turned(:, :), inverse(:, :)
      integer :: i, n, status

      n = size(a, 1)
      allocate (turned, source=a(n:1:-1, n:1:-1))
      call cholesky(turned, status)
      if (status /= 0) then
         call raise(error, error_code%singular, 'E0310', &
            & 'the equations that contact came to touch depend on each other', &
            & help='look for a constraint stated twice')
         return
      end if
      allocate (inverse(n, n), source=0.0_wp)
      do i = 1, n
         inverse(i, i) = 1.0_wp
      end do
      call lower_solve(turned, inverse)
      l = transpose(inverse(n:1:-1, n:1:-1))
   end subroutine factor_of_inverse

   subroutine refuse_to_condense(name, error)
      character(len=*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error

      call raise(error, error_code%usage, 'E0705', 'solver '//name// &
         & ' cannot keep the contact equations last', &
         & help='use skyline, cholmod or dense, or *LOPIN, PATH=NEWTON, which does not condense')
   end subroutine refuse_to_condense

   !> Forward pass of a load; what it does on the equations kept last is `l` times the end of `y`
   !> (and of a part of the equations that joined).
   subroutine condense_load(self, right, y, load)
      type(linear_system_type), intent(inout) :: self
      real(wp), intent(in) :: right(:)               !! (neq) [force]
      real(wp), allocatable, intent(out) :: y(:)     !! (n)
      real(wp), allocatable, intent(out) :: load(:)  !! (nlast) condensed load [force]
      real(wp), allocatable :: b(:), tail(:)
      integer :: j

      allocate (b(self%n), y(self%n), load(self%nlast))
      b(:) = right(self%equation)
      load = 0.0_wp
      if (.not. self%splits) then
         y = b
         return
      end if
      call self%solver%forward(b, y)
      allocate (tail(self%nlast))
      call late_part(self, y, tail(:size(self%late)))
      tail(size(self%late) + 1:) = y(self%n - self%nlast + size(self%late) + 1:)
      do j = 1, self%nlast
         load(j:) = load(j:) + self%l(j:, j)*tail(j)
      end do
   end subroutine condense_load

   !> What a forward pass means for the equations that joined: L_A^T u, u their displacements while
   !> the others kept last are held.
   subroutine late_part(self, y, part)
      type(linear_system_type), intent(inout) :: self
      real(wp), intent(in) :: y(:)             !! (n)
      real(wp), intent(out) :: part(:)         !! (nlate)
      real(wp), allocatable :: z(:), x(:)
      integer :: m, n

      n = size(self%late)
      if (n == 0) return
      m = self%nlast - n
      allocate (z, source=y)
      z(self%n - m + 1:) = 0.0_wp
      allocate (x(self%n))
      call self%solver%backward(z, x)
      part = matmul(x(self%number(self%late)), self%l(:n, :n))
   end subroutine late_part

   !> The end of a backward pass with contact forces added: the equations kept last alone, where
   !> none has joined late.
   subroutine recover_kept(self, y, pushed, v)
      type(linear_system_type), intent(in) :: self
      real(wp), intent(in) :: y(:)             !! (n)
      real(wp), intent(in) :: pushed(:)        !! (nlast) contact forces [force]
      real(wp), intent(out) :: v(:)            !! (neq), zero elsewhere
      real(wp) :: tail(self%nlast)
      integer :: i

      tail = pushed
      if (self%nlast > 0) then
         call dtrsv('L', 'N', 'N', self%nlast, self%l, self%nlast, tail, 1)
         tail = tail + y(self%n - self%nlast + 1:)
         call dtrsv('L', 'T', 'N', self%nlast, self%l, self%nlast, tail, 1)
      end if
      v = 0.0_wp
      do i = 1, size(self%place)
         if (self%place(i) > 0) v(i) = tail(self%place(i))
      end do
   end subroutine recover_kept

   !> Backward pass with contact forces added on the equations kept last.
   subroutine recover(self, y, pushed, v)
      type(linear_system_type), intent(inout) :: self
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: pushed(:)              !! (nlast) contact forces [force]
      real(wp), intent(out) :: v(:)                  !! (neq), zero at artificial supports
      real(wp), allocatable :: z(:), tail(:), x(:), whole(:, :)
      integer :: j, n

      v = 0.0_wp
      if (.not. self%splits) then
         allocate (whole(self%n, 1))
         whole(:, 1) = y
         call self%solver%solve(whole)
         v(self%equation) = whole(:, 1)
         return
      end if
      n = size(self%late)
      allocate (z, source=y)
      allocate (x(self%n))
      if (n > 0) then
         x = 0.0_wp
         x(self%number(self%late)) = pushed(:n)
         block
            real(wp), allocatable :: more(:)
            allocate (more(self%n))
            call self%solver%forward(x, more)
            z = z + more
         end block
      end if
      allocate (tail, source=pushed(n + 1:))
      associate (l => self%l(n + 1:, n + 1:))
         do j = 1, size(tail)
            tail(j) = tail(j)/l(j, j)
            tail(j + 1:) = tail(j + 1:) - l(j + 1:, j)*tail(j)
         end do
      end associate
      z(self%n - size(tail) + 1:) = z(self%n - size(tail) + 1:) + tail
      call self%solver%backward(z, x)
      v(self%equation) = x
   end subroutine recover
end module lopin_linear_system
