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
   use lopin_clock, only : clock_type, counter_type, phase
   use lopin_csc, only : csc_type
   use lopin_csc_sum, only : sum_of, widen
   use lopin_gmres, only : operator_type, gmres
   use lopin_linear_solver, only : linear_solver_type, vertices_type, matrix_class
   use lopin_solver_factory, only : new_solver, general_solver
   use lopin_iteration_solver, only : analyse_for_iterations
   use lopin_constraints, only : constraints_type
   use lopin_reduce_matrix, only : reduce_matrix
   use lopin_local_matrix, only : local_matrix_type
   use lopin_lagged_factor, only : lagged_factor_type, limit_of, note_solution
   use lopin_contact_block, only : block_type, reduce_block, set_spring, add_product, &
      & add_up_springs
   use lopin_firm_springs, only : set_firm, push_back, give_back
   use lopin_packed_blocks, only : packed_blocks_type, pack_blocks, add_packed, push_packed, &
      & give_packed
   use lopin_contact_sum, only : add_up_contacts
   use lopin_tied_equations, only : tied_equations_type, find_tied, take_out, give_own, &
      & gather_kept, find_tied_forces, vertices_of_kept
   implicit none
   private
   public :: newton_system_type, set_tangent, add_ground_springs, solve_step, solve_whole

   !> What the linear systems of a run took.
   type :: krylov_counts_type
      integer :: last = 0                      !! iterations of the last step
      integer :: most = 0                      !! largest number in the run
      integer :: whole_factors = 0             !! times the whole matrix was factorised in the run
   end type krylov_counts_type

   type, extends(operator_type) :: newton_system_type
      integer :: neq = 0, n = 0                !! equations; with multipliers
      type(csc_type) :: k                      !! reduced K
      type(block_type), allocatable :: block(:)
      type(packed_blocks_type) :: packed       !! the small ones
      real(wp), allocatable :: scale(:)        !! (n - neq) turns row residuals into forces
      real(wp), allocatable :: area(:)         !! (n - neq) turns multipliers into forces
      type(csc_type) :: matrix                 !! what is factorised: K + springs, without ties
      type(tied_equations_type) :: tied        !! equations that the factor does without
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
      type(krylov_counts_type) :: krylov
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
      end do
      call take_ties(self)
      do i = 1, nlocal
         if (allocated(self%block(i)%glue)) then
            call set_spring(self%block(i))
            if (.not. allocated(self%block(i)%spring)) cycle
         end if
         if (self%firm .and. allocated(self%block(i)%reach)) call set_firm(self%block(i), &
            & local(i), self%neq, self%scale, self%area, diagonal)
      end do
      call pack_blocks(self%packed, self%block, self%neq, self%scale, self%area)
      self%lag%at_hand = self%lag%may .and. .not. (self%lag%failed .or. self%direct) &
         & .and. (self%factorised .or. self%lag%at_hand)
      self%lag%may = .false.
      self%factorised = .false.
      self%direct = .false.
   end subroutine set_tangent

   !> Which equations the factor does without; the factor at hand is of no use to others.
   subroutine take_ties(self)
      type(newton_system_type), intent(inout) :: self
      integer, allocatable :: before(:)

      allocate (before(self%tied%n))
      if (self%tied%n > 0) before(:) = self%tied%own
      call find_tied(self%tied, self%block, self%neq)
      if (size(before) == self%tied%n) then
         if (self%tied%n == 0) return
         if (all(before == self%tied%own)) return
      end if
      self%lag%at_hand = .false.
      self%factorised = .false.
   end subroutine take_ties

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
      call pack_blocks(self%packed, self%block, self%neq, self%scale, self%area)
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
         call gmres(self, as_forces(self, right), tolerance, limit_of(self%lag, self%krylov%last, &
            & tolerance, self%solver%most_iterations), step, self%krylov%last, ratio)
         counter%back_solves = counter%back_solves + self%krylov%last
         self%krylov%most = max(self%krylov%most, self%krylov%last)
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
      type(csc_type) :: springs, whole
      integer(ik), allocatable :: row(:), colptr(:)
      logical :: same

      call add_up_springs(self%block, self%neq, springs)
      if (allocated(self%matrix%row)) then
         call move_alloc(self%matrix%row, row)
         call move_alloc(self%matrix%colptr, colptr)
      end if
      if (self%tied%n > 0) then
         call sum_of(self%k, springs, whole)
         call take_out(self%tied, whole, self%matrix)
         deallocate (whole%row, whole%value)
      else
         call sum_of(self%k, springs, self%matrix)
      end if
      same = allocated(self%solver) .and. allocated(row)
      if (same) same = size(row) == size(self%matrix%row) &
         & .and. size(colptr) == size(self%matrix%colptr)
      if (same) same = all(row == self%matrix%row) .and. all(colptr == self%matrix%colptr) &
         & .and. .not. self%solver%orders_by_values()
      call clock%stop_in(phase%assemble)
      if (.not. same) then
         call analyse_for_iterations(self%solver, self%reason, self%wish, self%matrix, &
            & vertices_of_kept(self%tied, self%vertices), error)
         if (allocated(error)) return
         call clock%stop_in(phase%analyse)
      end if
      self%solver%keeps_signs = .true.
      call self%solver%factorise(self%matrix, bad, error)
      if (allocated(error) .and. bad > 0) deallocate (error)
      if (bad > 0 .and. self%tied%n > 0) bad = self%tied%kept(bad)
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
      integer :: b

      call self%k%multiply(x(:self%neq), y(:self%neq))
      y(self%neq + 1:) = 0.0_wp
      call add_packed(self%packed, x, y)
      do b = 1, size(self%packed%large)
         call add_product(self%block(self%packed%large(b)), x, y)
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

      y(self%neq + 1:) = x(self%neq + 1:)/self%area
      if (self%tied%n > 0) y(self%tied%row) = 0.0_wp
      y(:self%neq) = x(:self%neq)
      call push_packed(self%packed, y)
      do b = 1, size(self%packed%large)
         call push_back(self%block(self%packed%large(b)), y(:self%neq), y)
      end do
      if (self%tied%n > 0) then
         call solve_tied(self, x, y)
      else
         du = reshape(y(:self%neq), [self%neq, 1])
         call self%solver%solve(du)
         y(:self%neq) = du(:, 1)
      end if
      if (self%n == self%neq) return
      call give_packed(self%packed, y)
      do b = 1, size(self%packed%large)
         call give_back(self%block(self%packed%large(b)), self%neq, self%scale, self%area, y)
      end do
      if (self%tied%n > 0) call find_tie_forces(self, x, y)
   end subroutine precondition

   !> Displacements with ties: the forces in y become displacements.
   subroutine solve_tied(self, x, y)
      type(newton_system_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(inout) :: y(:)
      real(wp) :: right(self%tied%n), own(self%n), force(self%n)
      real(wp), allocatable :: kept(:, :)

      right = x(self%tied%row)/self%scale(self%tied%row - self%neq)
      if (any(abs(right) > 0.0_wp)) then
         own = 0.0_wp
         call give_own(self%tied, right, own(:self%neq))
         call self%multiply(own, force)
         y(:self%neq) = y(:self%neq) - force(:self%neq)
      end if
      allocate (kept(size(self%tied%kept), 1))
      call gather_kept(self%tied, y(:self%neq), kept(:, 1))
      call self%solver%solve(kept)
      y(self%tied%kept) = kept(:, 1)
      call give_own(self%tied, right, y(:self%neq))
   end subroutine solve_tied

   !> Multipliers of ties: what all others leave at their own equations.
   subroutine find_tie_forces(self, x, y)
      type(newton_system_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(inout) :: y(:)
      real(wp) :: left(self%n), force(self%tied%n)

      y(self%tied%row) = 0.0_wp
      call self%multiply(y, left)
      left(:self%neq) = x(:self%neq) - left(:self%neq)
      call find_tied_forces(self%tied, left(:self%neq), self%area(self%tied%row - self%neq), &
         & force)
      y(self%tied%row) = force
   end subroutine find_tie_forces

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
      call add_up_contacts(self%block, self%neq, self%scale, self%area, contacts)
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
      self%krylov%whole_factors = self%krylov%whole_factors + 1
      call clock%stop_in(phase%factorise)
      if (bad > 0 .and. allocated(error)) deallocate (error)
      self%direct = .not. (bad > 0 .or. allocated(error))
   end subroutine factorise_whole
end module lopin_newton_system
