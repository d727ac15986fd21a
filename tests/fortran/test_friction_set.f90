!> Friction on the dense compliance: Klarbring's node, a matrix that cycles, points without
!> pressure.
program test_friction_set
   use lopin_kinds, only : wp
   use check, only : test, close_to, is_true, finish
   use lopin_condensed, only : condensed_type
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_dense, only : cholesky
   use lopin_active_set, only : contact_result_type, outcome, solve_contact
   use lopin_friction, only : law_of
   use lopin_friction_rows, only : friction_points_type
   use lopin_friction_set, only : solve_friction, friction_result_type
   use lopin_state, only : state_type, begin, accept, reject
   use lopin_friction_state, only : new_friction_history
   use lopin_friction_limits, only : find_wedging
   implicit none

   call klarbring()
   call klarbring_by_steps()
   call cycling_matrix()
   call no_pressure()
   call random_scenes()
   call increments_given_up()
   call finish()

contains

   !> Rows B on the factor of K; the first `nnormal` rows press, the rest are tangential.
   subroutine new_problem(problem, points, k, b, nnormal, mu, nt)
      type(condensed_type), intent(out) :: problem
      type(friction_points_type), intent(out) :: points
      real(wp), intent(in) :: k(:, :), b(:, :), mu
      integer, intent(in) :: nnormal, nt
      integer :: row, i, status

      problem%n = size(k, 1)
      problem%nrow = size(b, 1)
      problem%ngroup = 1
      problem%l = k
      call cholesky(problem%l, status)
      problem%first = [(1 + (row - 1)*problem%n, row=1, problem%nrow + 1)]
      problem%column = [((i, i=1, problem%n), row=1, problem%nrow)]
      problem%value = reshape(transpose(b), [size(b)])
      allocate (problem%c(problem%nrow, 0))
      problem%bilateral = spread(.false., 1, problem%nrow)
      problem%alpha = spread(0.0_wp, 1, problem%nrow)
      problem%group_first = [1, nnormal + 1]
      problem%max_augmentations = [0]
      problem%penetration = [0.0_wp]
      allocate (problem%group(1))
      call new_enforcement(problem%group(1)%method, 'lagrange')
      associate (n => nnormal)
         points%n = n
         points%nt = nt
         points%normal = [(i, i=1, n)]
         points%tangent = [(n + 1 + (i - 1)*nt, i=1, n)]
         allocate (points%law(n), points%at(n))
         points%law%law = law_of%coulomb
         points%law%mu = mu
         points%weight = spread(1.0_wp, 1, n)
         points%stiffness = spread(0.0_wp, 1, n)
         points%elastic_slip = spread(0.0_wp, 1, n)
         points%augmented = spread(.false., 1, n)
         allocate (points%traction(nt, n), points%start(nt, n), points%anchor(nt, n), &
            & points%elastic(nt, n), source=0.0_wp)
      end associate
   end subroutine new_problem

   !> Benchmark C3: K = [4, 1.6; 1.6, 1], unique below mu = K_tt/|K_nt| = 0.625.
   subroutine klarbring()
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(contact_result_type) :: result
      type(friction_result_type) :: friction
      real(wp), parameter :: k(2, 2) = reshape([4.0_wp, 1.6_wp, 1.6_wp, 1.0_wp], [2, 2])
      real(wp), parameter :: b(2, 2) = reshape([-1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      real(wp) :: coefficient, critical, force
      integer :: worst
      logical :: known

      call test('one node of Klarbring')
      call new_problem(problem, points, k, b, 1, 0.3_wp, 1)
      call solve_friction(problem, points, [0.0_wp, 0.0_wp], [1.0_wp, 0.9_wp], [real(wp) ::], &
         & result, friction)
      call is_true('solved', result%outcome == outcome%solved)
      call close_to('free', result%gap, [0.305555555555556_wp, 1.38888888888889_wp], 1.0e-12_wp)
      call find_wedging(problem%s, points, friction%status, worst, coefficient, critical)
      call is_true('unique', worst == 0)
      call new_problem(problem, points, k, b, 1, 1.0_wp, 1)
      call solve_friction(problem, points, [0.0_wp, 0.0_wp], [1.0_wp, 0.9_wp], [real(wp) ::], &
         & result, friction)
      call is_true('solved beyond', result%outcome == outcome%solved)
      force = result%force(1)
      known = abs(force) < 1.0e-12_wp .or. abs(force - 1.0_wp) < 1.0e-12_wp &
         & .or. abs(force - 0.733333333333333_wp) < 1.0e-12_wp
      call is_true('one of the three', known)
      call find_wedging(problem%s, points, friction%status, worst, coefficient, critical)
      call is_true('several', worst == 1)
      call close_to('critical', critical, 0.625_wp, 1.0e-12_wp)
   end subroutine klarbring

   !> Loaded in proportion from nothing, the node stays on the branch that sticks.
   subroutine klarbring_by_steps()
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(contact_result_type) :: result
      type(friction_result_type) :: friction
      real(wp), parameter :: k(2, 2) = reshape([4.0_wp, 1.6_wp, 1.6_wp, 1.0_wp], [2, 2])
      real(wp), parameter :: b(2, 2) = reshape([-1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      integer :: i

      call test('one node of Klarbring by steps')
      call new_problem(problem, points, k, b, 1, 1.0_wp, 1)
      do i = 1, 10
         call solve_friction(problem, points, [0.0_wp, 0.0_wp], 0.1_wp*i*[1.0_wp, 0.9_wp], &
            & [real(wp) ::], result, friction)
         call is_true('solved', result%outcome == outcome%solved)
         points%traction(1, 1) = result%force(2)
         points%start(1, 1) = result%gap(2)
      end do
      call close_to('stick', result%force, [1.0_wp, -0.9_wp], 1.0e-12_wp)
      call is_true('sticks', friction%status(1) == 1)
   end subroutine klarbring_by_steps

   !> Benchmark F5: a definite matrix on which the plain active set cycles.
   subroutine cycling_matrix()
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(contact_result_type) :: result
      type(friction_result_type) :: friction
      real(wp), parameter :: m(3, 3) = reshape([9.0_wp, -13.0_wp, -16.0_wp, -13.0_wp, 22.0_wp, &
         & 28.0_wp, -16.0_wp, 28.0_wp, 36.0_wp], [3, 3])
      real(wp) :: unit(3, 3)
      integer :: i

      call test('a matrix that cycles')
      unit = 0.0_wp
      do i = 1, 3
         unit(i, i) = 1.0_wp
      end do
      call new_problem(problem, points, unit, unit, 3, 0.0_wp, 1)
      points%n = 0
      points%normal = [integer ::]
      deallocate (points%law, points%at)
      allocate (points%law(0), points%at(0))
      problem%s = m
      do i = 0, 3
         result%force = [0.0_wp, 0.0_wp, 0.0_wp]
         if (i > 0) result%force(i) = 1.0_wp
         result%q = [real(wp) ::]
         call solve_friction(problem, points, [-9.0_wp, 9.0_wp, 2.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], &
            & [real(wp) ::], result, friction)
         call is_true('solved', result%outcome == outcome%solved)
         call close_to('force', result%force, [4.2941176470588234_wp, 0.0_wp, &
            & 1.8529411764705883_wp], 1.0e-10_wp)
         call is_true('few iterations', result%iterations <= 26)
      end do
   end subroutine cycling_matrix

   !> Benchmark F14: the tip of the cone.
   subroutine no_pressure()
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(contact_result_type) :: result
      type(friction_result_type) :: friction
      real(wp), parameter :: k(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
         & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])

      call test('points without pressure')
      call new_problem(problem, points, k, k, 1, 0.3_wp, 2)
      call solve_friction(problem, points, spread(0.0_wp, 1, 3), [-1.0_wp, 0.0_wp, 0.0_wp], &
         & [real(wp) ::], result, friction)
      call close_to('pressed only', result%force, [1.0_wp, 0.0_wp, 0.0_wp], 1.0e-15_wp)
      call solve_friction(problem, points, spread(0.0_wp, 1, 3), [1.0e-3_wp, 1.0e-8_wp, 0.0_wp], &
         & [real(wp) ::], result, friction)
      call is_true('solved', result%outcome == outcome%solved .and. all(result%force == 0.0_wp))
      call solve_friction(problem, points, spread(0.0_wp, 1, 3), [0.0_wp, 1.0e-8_wp, 0.0_wp], &
         & [real(wp) ::], result, friction)
      call is_true('grazing', result%outcome == outcome%solved &
         & .and. all(abs(result%force) < 1.0e-15_wp))
   end subroutine no_pressure

   !> Random stiffnesses and loads in three dimensions: solved, inside the cone, opposing slip; with
   !> mu = 0 the frictionless answer.
   subroutine random_scenes()
      type(condensed_type) :: problem, smooth
      type(friction_points_type) :: points
      type(contact_result_type) :: result, frictionless
      type(friction_result_type) :: friction
      integer, parameter :: n = 12
      real(wp) :: a(3*n, 3*n), k(3*n, 3*n), b(3*n, 3*n), load(3*n), mu, tangential, worst
      integer :: trial, i, most
      logical :: solved, inside, opposes

      call test('random scenes')
      b = 0.0_wp
      do i = 1, 3*n
         b(i, i) = 1.0_wp
      end do
      solved = .true.
      inside = .true.
      opposes = .true.
      most = 0
      worst = 0.0_wp
      call random_seed(put=spread(7, 1, 64))
      do trial = 1, 60
         call random_number(a)
         call random_number(load)
         a = a - 0.5_wp
         k = matmul(transpose(a), a)
         do i = 1, 3*n
            k(i, i) = k(i, i) + 1.0_wp
         end do
         load = 2.0_wp*(load - 0.5_wp)
         load(:n) = load(:n) - 0.5_wp
         mu = 0.3_wp
         if (mod(trial, 4) == 0) mu = 0.0_wp
         if (allocated(result%force)) deallocate (result%force)
         call new_problem(problem, points, k, b, n, mu, 2)
         call solve_friction(problem, points, spread(0.0_wp, 1, 3*n), load, [real(wp) ::], result, &
            & friction)
         solved = solved .and. result%outcome == outcome%solved
         most = max(most, result%iterations)
         do i = 1, n
            associate (t => result%force(points%tangent(i):points%tangent(i) + 1), &
               & s => result%gap(points%tangent(i):points%tangent(i) + 1))
               tangential = norm2(t)
               inside = inside .and. tangential <= mu*result%force(i) + 1.0e-10_wp
               opposes = opposes .and. dot_product(t, s) <= 1.0e-10_wp
            end associate
         end do
         if (mu > 0.0_wp) cycle
         call new_problem(smooth, points, k, b(:n, :), n, mu, 2)
         call solve_contact(smooth, spread(0.0_wp, 1, n), load, [real(wp) ::], frictionless)
         worst = max(worst, maxval(abs(frictionless%force - result%force(:n))))
         deallocate (frictionless%active)
      end do
      call is_true('solved', solved)
      call is_true('inside the cone', inside)
      call is_true('opposes the slip', opposes)
      call is_true('without friction', worst < 1.0e-11_wp)
      call is_true('few iterations', most <= 20)
   end subroutine random_scenes

   !> An increment that is given up leaves nothing behind: the same increment again, the same bits.
   subroutine increments_given_up()
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(contact_result_type) :: result, again
      type(friction_result_type) :: friction
      type(state_type) :: accepted, trial
      real(wp) :: k(6, 6), b(6, 6), load(6)
      integer :: i

      call test('increments that are given up')
      k = 0.1_wp
      b = 0.0_wp
      do i = 1, 6
         k(i, i) = 1.0_wp + 0.1_wp*i
         b(i, i) = 1.0_wp
      end do
      call new_problem(problem, points, k, b, 2, 0.3_wp, 2)
      call new_friction_history(accepted%friction, [.false., .false.])
      call begin(trial, accepted)
      load = [-1.0_wp, -0.7_wp, 0.2_wp, 0.1_wp, 0.3_wp, -0.1_wp]
      call solve_friction(problem, points, spread(0.0_wp, 1, 6), load, [real(wp) ::], result, &
         & friction)
      trial%friction%force = result%force
      trial%friction%gap = result%gap
      trial%friction%q = result%q
      call accept(accepted, trial)
      call run(problem, points, accepted, 1.5_wp*load, result)
      ! Another increment in between, and it is given up.
      call run(problem, points, accepted, -3.0_wp*load, again)
      trial%friction%force = again%force
      trial%friction%gap = again%gap
      call reject(trial, accepted)
      call is_true('nothing of it is left', all(trial%friction%force == accepted%friction%force))
      call run(problem, points, accepted, 1.5_wp*load, again)
      call is_true('the same bits', all(again%force == result%force) &
         & .and. all(again%gap == result%gap))

   end subroutine increments_given_up

   !> An increment from the accepted state.
   subroutine run(problem, points, accepted, load, answer)
      type(condensed_type), intent(inout) :: problem
      type(friction_points_type), intent(inout) :: points
      type(state_type), intent(in) :: accepted
      real(wp), intent(in) :: load(:)
      type(contact_result_type), intent(out) :: answer
      type(friction_result_type) :: friction

      answer%force = accepted%friction%force
      answer%gap = accepted%friction%gap
      answer%q = accepted%friction%q
      points%traction = reshape(accepted%friction%force(3:), [2, 2])
      points%start = reshape(accepted%friction%gap(3:), [2, 2])
      call solve_friction(problem, points, spread(0.0_wp, 1, 6), load, [real(wp) ::], answer, &
         & friction)
   end subroutine run
end program test_friction_set
