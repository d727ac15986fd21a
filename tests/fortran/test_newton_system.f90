!> Tests of lopin_newton_system: GMRES on the positive definite factor against UMFPACK on the whole.
program test_newton_system
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_clock, only : clock_type, counter_type
   use lopin_csc, only : csc_type
   use lopin_constraints, only : constraints_type
   use lopin_local_matrix, only : local_matrix_type
   use lopin_newton_system, only : newton_system_type, set_tangent, solve_step, solve_whole
   use check, only : test, close_to, is_true, finish
   use matrices, only : elastic_block, uniform
   implicit none
   integer :: seed = 11

   call agrees_with_the_whole('closed, no friction', mu=0.0_wp, slips=.false., stiffness=10.0_wp)
   call agrees_with_the_whole('stick', mu=0.5_wp, slips=.false., stiffness=10.0_wp)
   call agrees_with_the_whole('slip, mu = 0.3', mu=0.3_wp, slips=.true., stiffness=10.0_wp)
   call agrees_with_the_whole('slip, mu = 1', mu=1.0_wp, slips=.true., stiffness=10.0_wp)
   call agrees_with_the_whole('slip, hard springs', mu=0.3_wp, slips=.true., stiffness=1.0e4_wp)
   call agrees_with_the_whole('soft springs made firm, no friction', 0.0_wp, .false., 0.1_wp, 7)
   call agrees_with_the_whole('soft springs made firm, stick', 0.5_wp, .false., 0.1_wp, 9)
   call agrees_with_the_whole('soft springs made firm, slip', 0.3_wp, .true., 0.1_wp, 13)
   call agrees_with_the_whole('slip by a bound that follows the solids', 0.3_wp, .true., 10.0_wp, &
      & follows=.true.)
   call keeps_a_factor()
   call finish()

contains

   !> The factor of an earlier tangent serves one that is near, not one that is far.
   subroutine keeps_a_factor()
      type(newton_system_type) :: system
      type(constraints_type) :: constraints
      type(csc_type) :: k
      type(local_matrix_type) :: local(0)
      type(clock_type) :: clock
      type(counter_type) :: counter
      type(error_type), allocatable :: error
      integer, allocatable :: top(:)
      real(wp), allocatable :: right(:), step(:), whole(:)
      integer, parameter :: factors(4) = [1, 1, 2, 3]
      integer :: bad, i, turn

      call elastic_block([12, 9], .true., k, top)
      call free_constraints(constraints, k%n)
      allocate (right(k%n), step(k%n), whole(k%n))
      right = [(uniform(seed) - 0.5_wp, i=1, k%n)]
      system%wish = 'cholmod'
      call clock%start()
      do turn = 1, 4
         call test('a factor is kept for a near tangent alone')
         if (turn == 2) k%value = 1.01_wp*k%value
         if (turn == 3) then
            do i = 1, k%n
               associate (diagonal => k%value(k%colptr(i) + 1))
                  diagonal = diagonal*(1.0_wp + 1.0e4_wp*uniform(seed)**4)
               end associate
            end do
         end if
         system%lag%may = turn > 1
         call set_tangent(system, k, constraints, 0, local, [real(wp) ::], [real(wp) ::], .false.)
         call solve_step(system, right, 1.0e-10_wp, step, clock, counter, bad, error)
         call is_true('no error', .not. allocated(error) .and. bad == 0)
         call is_true('factors', counter%factorisations == factors(turn))
         call is_true('lags', system%lag%at_hand .eqv. turn == 2)
         call is_true('badly', system%lag%failed .eqv. turn > 2)
      end do
      call solve_whole(system, right, whole, clock, counter, bad, error)
      call close_to('step', step/maxval(abs(whole)), whole/maxval(abs(whole)), 1.0e-8_wp)
   end subroutine keeps_a_factor

   !> A block whose top nodes press on a rigid floor by unknown tractions; springs c and c.
   subroutine agrees_with_the_whole(name, mu, slips, stiffness, firm, follows)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: mu, stiffness    !! springs beside the block's own stiffness
      logical, intent(in) :: slips
      integer, intent(in), optional :: firm    !! springs are made firm: products at most
      logical, intent(in), optional :: follows !! bounds of shear read dofs of the solids
      type(newton_system_type) :: system
      type(constraints_type) :: constraints
      type(csc_type) :: k
      type(local_matrix_type), allocatable :: local(:)
      type(clock_type) :: clock
      type(counter_type) :: counter
      type(error_type), allocatable :: error
      integer, allocatable :: top(:)
      real(wp), allocatable :: right(:), step(:), whole(:), diagonal(:)
      real(wp) :: c
      integer :: i, n, m, bad, most

      call test('step with '//name//' is that of the whole matrix')
      call elastic_block([6, 5], .true., k, top)
      n = k%n
      call free_constraints(constraints, n)
      allocate (diagonal(n))
      call k%diagonal(diagonal)
      c = stiffness*maxval(diagonal)
      m = size(top)/2
      allocate (local(m), right(n + 2*m), step(n + 2*m), whole(n + 2*m))
      do i = 1, m
         call press(local(i), top(2*i - 1:2*i), n + [2*i - 1, 2*i], c, mu, slips)
         if (present(firm)) call make_firm(local(i), c, mu, slips)
         if (present(follows)) call follow(local(i), n, c)
      end do
      do i = 1, n + 2*m
         right(i) = uniform(seed) - 0.5_wp
      end do
      call clock%start()
      call set_tangent(system, k, constraints, m, local, spread(c, 1, 2*m), &
         & spread(1.0_wp, 1, 2*m), .false.)
      system%wish = 'cholmod'
      call solve_step(system, right, 1.0e-12_wp, step, clock, counter, bad, error)
      call is_true('no error', .not. allocated(error) .and. bad == 0)
      call is_true('by GMRES', .not. system%direct)
      most = 30
      if (present(firm)) most = firm
      call is_true('few products', system%krylov%last <= most)
      call solve_whole(system, right, whole, clock, counter, bad, error)
      call close_to('step', step/maxval(abs(whole)), whole/maxval(abs(whole)), 1.0e-8_wp)
   end subroutine agrees_with_the_whole

   !> Every dof is free.
   subroutine free_constraints(self, n)
      type(constraints_type), intent(out) :: self
      integer, intent(in) :: n
      integer :: i

      self%ndof = n
      self%neq = n
      self%first = [(i, i=1, n + 1)]
      self%equation = [(i, i=1, n)]
      self%coefficient = spread(1.0_wp, 1, n)
      self%pfirst = spread(1, 1, n + 1)
      allocate (self%prescribed(0), self%pcoefficient(0))
   end subroutine free_constraints

   !> A point closed along y: z_y = l - c g; along x it sticks, or slips with z_x = mu z_y.
   subroutine press(local, dof, row, c, mu, slips)
      type(local_matrix_type), intent(out) :: local
      integer, intent(in) :: dof(2), row(2)
      real(wp), intent(in) :: c, mu
      logical, intent(in) :: slips
      real(wp) :: z(2, 4)

      ! Slopes of the traction (x, y) by u_x, u_y, l_x, l_y.
      z = 0.0_wp
      z(2, 2) = -c
      z(2, 4) = 1.0_wp
      if (slips) then
         z(1, :) = mu*z(2, :)
      else if (mu > 0.0_wp) then
         z(1, 1) = -c
         z(1, 3) = 1.0_wp
      end if
      local%dof = [dof, row]
      local%nu = 2
      allocate (local%k(4, 4), local%spring(2, 2))
      local%k(:2, :) = -z
      local%k(3:, :) = -z/c
      local%k(3, 3) = local%k(3, 3) + 1.0_wp/c
      local%k(4, 4) = local%k(4, 4) + 1.0_wp/c
      local%spring = 0.0_wp
      local%spring(2, 2) = c
      if (.not. slips .and. mu > 0.0_wp) local%spring(1, 1) = c
   end subroutine press

   !> The bound reads some dofs, one of them twice.
   subroutine follow(local, n, c)
      type(local_matrix_type), intent(inout) :: local
      integer, intent(in) :: n
      real(wp), intent(in) :: c

      local%by_bound = [0.1_wp*c, 0.0_wp, 0.1_wp, 0.0_wp]
      local%read_dof = [1 + int(uniform(seed)*n), 1 + int(uniform(seed)*n), local%dof(1), &
         & local%dof(1)]
      local%read_slope = [0.5_wp, -0.3_wp, 0.4_wp, 0.2_wp]
   end subroutine follow

   !> The point goes as its dofs do; where it is held, its unknown traction alone holds it.
   subroutine make_firm(local, c, mu, slips)
      type(local_matrix_type), intent(inout) :: local
      real(wp), intent(in) :: c, mu
      logical, intent(in) :: slips

      allocate (local%reach(2, 2), local%stiff(2, 2), local%firm(2, 2), source=0.0_wp)
      local%reach(1, 1) = 1.0_wp
      local%reach(2, 2) = 1.0_wp
      local%firm(2, 2) = c
      if (mu > 0.0_wp .and. .not. slips) local%firm(1, 1) = c
      local%stiff = local%firm
   end subroutine make_firm
end program test_newton_system
