!> The linear system of one Newton step with contact: exact operator, positive definite factor.
!>
!>    [ K + A   C ] [du]   [f]      A, C, R, D: sums of the exact local matrices of the contact
!>    [   R     D ] [dl] = [h]      points, unsymmetric where friction slips
!>
!> Factorised is K plus the springs of the contact points (no coupling of pressure into friction, no
!> curvature): symmetric, positive definite, of the size of K whatever the method. GMRES on the
!> exact operator corrects for what the factor leaves out (design: the dropped coupling, not the
!> symmetric part, makes a good preconditioner of slip). Springs of points whose tractions are
!> unknowns are firm (lopin_firm_springs), so that what is left for the multipliers is known point
!> by point; that is the second block of the preconditioner. Near the solution the factor of
!> an earlier tangent of the same iteration does as well (`lag`): the operator stays exact, and
!> where GMRES needs many more iterations than before, the factor is made. Of an indefinite tangent
!> (a bad trial, metal that softens) it keeps the signs of its pivots. Where it does not exist or
!> the iterations stall, the whole matrix is factorised by UMFPACK.
module lopin_newton_system
   use lopin_kinds, only : wp, ik
   use lopin_error, only : error_type
   use lopin_text, only : lower
   use lopin_clock, only : clock_type, counter_type, phase
   use lopin_csc, only : csc_type, storage
   use lopin_csc_sum, only : sum_of, widen
   use lopin_gmres, only : operator_type, gmres
   use lopin_linear_solver, only : linear_solver_type, vertices_type, matrix_class
   use lopin_solver_factory, only : new_solver, choose_preconditioner, general_solver
   use lopin_constraints, only : constraints_type
   use lopin_reduce_matrix, only : reduce_matrix
   use lopin_local_matrix, only : local_matrix_type
   use lopin_lagged_factor, only : lagged_factor_type, limit_of, note_solution
   use lopin_contact_block, only : block_type, reduce_block, add_up_springs, entries_of, &
      & put_entries
   use lopin_firm_springs, only : set_firm, push_back, give_back
   implicit none
   private
   public :: newton_system_type, set_tangent, add_ground_springs, solve_step, solve_whole

   !> Corrections of tractions give way so much, beside c, where the whole matrix is factorised: a
   !> traction that works on supports alone (shear on the axis) is then none, and not undetermined.
   real(wp), parameter :: give = 1.0e-11_wp
   !> Entries of a row below which nothing can meet it.
   real(wp), parameter :: counts = 1.0e-6_wp

   type, extends(operator_type) :: newton_system_type
      integer :: neq = 0, n = 0                !! equations; with multipliers
      type(csc_type) :: k                      !! reduced K
      type(block_type), allocatable :: block(:)
      real(wp), allocatable :: scale(:)        !! (n - neq) turns row residuals into forces
      real(wp), allocatable :: area(:)         !! (n - neq) turns multipliers into forces
      type(csc_type) :: matrix                 !! what is factorised: K + springs
      type(vertices_type) :: vertices          !! of the equations, for solvers with coarse levels
      character(len=:), allocatable :: wish    !! AUTO or a solver's word
      class(linear_solver_type), allocatable :: solver
      class(linear_solver_type), allocatable :: whole
      character(len=:), allocatable :: reason  !! why this solver
      logical :: firm = .true.                 !! springs of contacts are firm in the factor, which
                                               !! takes a digit from tractions
      logical :: factorised = .false.
      type(lagged_factor_type) :: lag          !! the factor of an earlier tangent, if it does
      logical :: direct = .false.              !! the whole matrix is factorised
      integer :: krylov = 0                    !! iterations of the last step
      integer :: most_krylov = 0               !! largest number in the run
      integer :: whole_factors = 0             !! times the whole matrix was factorised in the run
   contains
      procedure :: multiply
      procedure :: precondition
   end type newton_system_type

contains

   !> Take a tangent; nothing is factorised yet.
   subroutine set_tangent(self, k, constraints, nlocal, local, stiffness, area, flat)
      type(newton_system_type), intent(inout) :: self
      type(csc_type), intent(in) :: k                    !! (ndof) solids, lower triangle
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: nlocal
      type(local_matrix_type), intent(in) :: local(:)    !! nlocal of them
      real(wp), intent(in) :: stiffness(:)   !! (nmultiplier) c of its row [stress/length]
      real(wp), intent(in) :: area(:)                    !! (nmultiplier) of its point [length^2]
      logical, intent(in) :: flat             !! forces by the springs alone, as if normals stood
                                              !! still: where pressures are still guesses
      real(wp) :: diagonal(constraints%neq)
      integer :: i

      self%neq = constraints%neq
      self%n = self%neq + size(area)
      self%scale = stiffness*area
      self%area = area
      call reduce_matrix(k, constraints, [(i, i=1, self%neq)], self%neq, self%k)
      call self%k%diagonal(diagonal)
      if (allocated(self%block)) deallocate (self%block)
      allocate (self%block(nlocal))
      do i = 1, nlocal
         call reduce_block(self%block(i), local(i), constraints, flat)
         if (self%firm .and. allocated(self%block(i)%reach)) call set_firm(self%block(i), &
            & local(i), self%neq, self%scale, self%area, diagonal)
      end do
      self%lag%at_hand = self%lag%may .and. .not. (self%lag%failed .or. self%direct) &
         & .and. (self%factorised .or. self%lag%at_hand)
      self%lag%may = .false.
      self%factorised = .false.
      self%direct = .false.
   end subroutine set_tangent

   !> Soft springs to the ground at some equations, for bodies that nothing holds yet. As blocks: a
   !> tool that only contact holds has no place in K.
   subroutine add_ground_springs(self, equation, stiffness)
      type(newton_system_type), intent(inout) :: self
      integer, intent(in) :: equation(:)
      real(wp), intent(in) :: stiffness          !! beside the largest of the diagonal
      real(wp), allocatable :: diagonal(:)
      type(block_type) :: spring(size(equation))
      integer :: i

      allocate (diagonal(self%neq))
      call self%k%diagonal(diagonal)
      do i = 1, size(equation)
         spring(i)%at = equation(i:i)
         spring(i)%nu = 1
         allocate (spring(i)%k(1, 1), source=stiffness*maxval(diagonal))
         allocate (spring(i)%spring, source=spring(i)%k)
      end do
      self%block = [self%block, spring]
      self%factorised = .false.
      self%lag%at_hand = .false.
      self%direct = .false.
   end subroutine add_ground_springs

   !> Solve the Newton step. `bad` > 0: the matrix is singular (equation).
   subroutine solve_step(self, right, tolerance, step, clock, counter, bad, error)
      type(newton_system_type), intent(inout) :: self
      real(wp), intent(in) :: right(:)           !! (n)
      real(wp), intent(in) :: tolerance          !! of GMRES, relative
      real(wp), intent(out) :: step(:)           !! (n)
      type(clock_type), intent(inout) :: clock
      type(counter_type), intent(inout) :: counter
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: ratio

      bad = 0
      call clock%stop_in(phase%contact)
      if (.not. (self%factorised .or. self%direct .or. self%lag%at_hand)) &
         & call factorise_springs(self, clock, counter, bad, error)
      if (allocated(error)) return
      do while (bad == 0 .and. .not. self%direct)
         call gmres(self, as_forces(self, right), tolerance, limit_of(self%lag, self%krylov, &
            & tolerance, self%solver%most_iterations), step, self%krylov, ratio)
         counter%back_solves = counter%back_solves + self%krylov
         self%most_krylov = max(self%most_krylov, self%krylov)
         call clock%stop_in(phase%solve)
         if (self%lag%at_hand .and. .not. ratio <= tolerance) then
            self%lag%at_hand = .false.
            self%lag%failed = .true.
            call factorise_springs(self, clock, counter, bad, error)
            if (allocated(error)) return
            cycle
         end if
         call note_solution(self%lag, ratio)
         if (ratio <= max(10.0_wp*tolerance, 1.0e-3_wp)) return
         if (self%solver%is_exact()) exit
         ! A factor of single precision may be what iterations cannot mend.
         call self%solver%factorise_exactly(self%matrix, bad, error)
         if (allocated(error) .and. bad == 0) return
         counter%factorisations = counter%factorisations + 1
         call clock%stop_in(phase%factorise)
      end do
      if (allocated(error)) deallocate (error)
      call solve_whole(self, right, step, clock, counter, bad, error)
   end subroutine solve_step

   !> All rows as forces.
   pure function as_forces(self, right) result(b)
      type(newton_system_type), intent(in) :: self
      real(wp), intent(in) :: right(:)
      real(wp) :: b(size(right))
      b = right
      b(self%neq + 1:) = self%scale*right(self%neq + 1:)
   end function as_forces

   subroutine factorise_springs(self, clock, counter, bad, error)
      type(newton_system_type), intent(inout) :: self
      type(clock_type), intent(inout) :: clock
      type(counter_type), intent(inout) :: counter
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      type(csc_type) :: springs
      integer(ik), allocatable :: row(:), colptr(:)
      character(len=:), allocatable :: name
      logical :: same

      call add_up_springs(self%block, self%neq, springs)
      if (allocated(self%matrix%row)) then
         call move_alloc(self%matrix%row, row)
         call move_alloc(self%matrix%colptr, colptr)
      end if
      call sum_of(self%k, springs, self%matrix)
      same = allocated(self%solver) .and. allocated(row)
      if (same) same = size(row) == size(self%matrix%row) &
         & .and. size(colptr) == size(self%matrix%colptr)
      if (same) same = all(row == self%matrix%row) .and. all(colptr == self%matrix%colptr) &
         & .and. .not. self%solver%orders_by_values()
      call clock%stop_in(phase%assemble)
      if (.not. same) then
         if (.not. allocated(self%solver)) then
            name = lower(self%wish)
            self%reason = 'as asked'
            if (name == 'auto') call choose_preconditioner(self%matrix, name, self%reason)
            call new_solver(self%solver, name, error)
            if (allocated(error)) return
         end if
         self%solver%vertices = self%vertices
         call self%solver%analyse(self%matrix, matrix_class%positive_definite, [integer ::], error)
         if (allocated(error)) return
         call clock%stop_in(phase%analyse)
      end if
      self%solver%keeps_signs = .true.
      call self%solver%factorise(self%matrix, bad, error)
      if (allocated(error) .and. bad > 0) deallocate (error)
      self%factorised = bad == 0 .and. .not. allocated(error)
      self%lag%at_hand = .false.
      counter%factorisations = counter%factorisations + 1
      call clock%stop_in(phase%factorise)
   end subroutine factorise_springs

   !> Exact product, all rows as forces.
   subroutine multiply(self, x, y)
      class(newton_system_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: b, i, j

      call self%k%multiply(x(:self%neq), y(:self%neq))
      y(self%neq + 1:) = 0.0_wp
      do b = 1, size(self%block)
         associate (at => self%block(b)%at, k => self%block(b)%k)
            do j = 1, size(at)
               do i = 1, size(at)
                  y(at(i)) = y(at(i)) + k(i, j)*x(at(j))
               end do
            end do
            if (allocated(self%block(b)%by_bound)) y(at) = y(at) + self%block(b)%by_bound &
               & *dot_product(self%block(b)%read_slope, x(self%block(b)%read_at))
         end associate
      end do
      y(self%neq + 1:) = self%scale*y(self%neq + 1:)
   end subroutine multiply

   !> An upper block triangular inverse: dl by what the rows of each point see of the springs, then
   !> du = (K + springs)^-1 (x - C dl), then what firm springs have taken of dl.
   subroutine precondition(self, x, y)
      class(newton_system_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      real(wp), allocatable :: du(:, :)
      integer :: b

      allocate (du(self%neq, 1))
      du(:, 1) = x(:self%neq)
      y(self%neq + 1:) = x(self%neq + 1:)/self%area
      do b = 1, size(self%block)
         call push_back(self%block(b), du(:, 1), y)
      end do
      call self%solver%solve(du)
      y(:self%neq) = du(:, 1)
      if (self%n == self%neq) return
      do b = 1, size(self%block)
         call give_back(self%block(b), self%neq, self%scale, self%area, y)
      end do
   end subroutine precondition

   !> The whole unsymmetric matrix, factorised.
   subroutine solve_whole(self, right, step, clock, counter, bad, error)
      type(newton_system_type), intent(inout) :: self
      real(wp), intent(in) :: right(:)
      real(wp), intent(out) :: step(:)
      type(clock_type), intent(inout) :: clock
      type(counter_type), intent(inout) :: counter
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: x(:, :)

      bad = 0
      if (.not. self%direct) then
         call factorise_whole(self, clock, counter, bad, error)
         if (bad > 0 .or. allocated(error)) return
      end if
      allocate (x(self%n, 1))
      x(:, 1) = as_forces(self, right)
      call self%whole%solve(x)
      step = x(:, 1)
      counter%back_solves = counter%back_solves + 1
      call clock%stop_in(phase%solve)
   end subroutine solve_whole

   subroutine factorise_whole(self, clock, counter, bad, error)
      type(newton_system_type), intent(inout) :: self
      type(clock_type), intent(inout) :: clock
      type(counter_type), intent(inout) :: counter
      integer, intent(out) :: bad              !! a pivot that vanished; 0: none
      type(error_type), allocatable, intent(out) :: error
      type(csc_type) :: contacts, solids, matrix, general
      integer, allocatable :: source(:)

      bad = 0
      call add_up_contacts(self, contacts)
      call self%k%to_general(general, source)
      call widen(general, self%n, solids)
      call sum_of(solids, contacts, matrix)
      if (allocated(self%whole)) deallocate (self%whole)
      call new_solver(self%whole, general_solver('auto'), error)
      if (allocated(error)) return
      call clock%stop_in(phase%assemble)
      call self%whole%analyse(matrix, matrix_class%general, [integer ::], error)
      if (allocated(error)) return
      call clock%stop_in(phase%analyse)
      call self%whole%factorise(matrix, bad, error)
      counter%factorisations = counter%factorisations + 1
      self%whole_factors = self%whole_factors + 1
      call clock%stop_in(phase%factorise)
      if (bad > 0 .and. allocated(error)) deallocate (error)
      self%direct = .not. (bad > 0 .or. allocated(error))
   end subroutine factorise_whole

   !> All contacts, and the little by which tractions give way.
   subroutine add_up_contacts(self, contacts)
      type(newton_system_type), intent(in) :: self
      type(csc_type), intent(out) :: contacts
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
      logical, allocatable :: acts(:)
      integer :: total, b, i

      total = 0
      do b = 1, size(self%block)
         total = total + entries_of(self%block(b))
      end do
      total = total + self%n - self%neq
      allocate (row(total), column(total), value(total))
      acts = acting_rows(self)
      total = 0
      do i = self%neq + 1, self%n
         total = total + 1
         row(total) = i
         column(total) = i
         value(total) = self%area(i - self%neq)
         if (acts(i - self%neq)) value(total) = give*value(total)
      end do
      do b = 1, size(self%block)
         i = total + entries_of(self%block(b))
         call put_entries(self%block(b), row(total + 1:i), column(total + 1:i), value(total + 1:i))
         total = i
      end do
      do i = self%n - self%neq + 1, total
         if (row(i) > self%neq) value(i) = value(i)*self%scale(row(i) - self%neq)
      end do
      call contacts%new_from_triplets(self%n, storage%general, row, column, value)
   end subroutine add_up_contacts

   !> Rows that a free motion or a traction of their own can meet. That of a node which supports
   !> hold on a tool that stands still is none: its pressure goes by its penetration, c of it.
   pure function acting_rows(self) result(acts)
      type(newton_system_type), intent(in) :: self
      logical, allocatable :: acts(:)
      real(wp) :: most(self%n - self%neq), part
      integer :: b, i, j, row

      most = 0.0_wp
      do b = 1, size(self%block)
         associate (at => self%block(b)%at, k => self%block(b)%k, nu => self%block(b)%nu)
            do i = nu + 1, nu + self%block(b)%nrow
               row = at(i) - self%neq
               do j = 1, size(at)
                  part = abs(k(i, j))
                  if (at(j) > self%neq) part = part*self%scale(row)/self%area(row)
                  most(row) = max(most(row), part)
               end do
            end do
         end associate
      end do
      acts = most > counts
   end function acting_rows
end module lopin_newton_system
