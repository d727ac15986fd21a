program test_active_set
   use lopin_kinds, only : wp
   use lopin_condensed, only : condensed_type, form_compliance
   use lopin_dense, only : cholesky
   use lopin_active_set, only : contact_result_type, solve_contact, outcome
   use lopin_enforcement_factory, only : new_enforcement, method_names
   use check, only : test, close_to, is_true, finish
   implicit none

   call bar_with_a_gap()
   call two_springs_and_masses()
   call cycling_matrix()
   call beams_on_a_floor()
   call ill_conditioned_problems()
   call floating_mass_is_held_by_contact()
   call floating_mass_that_flies_is_named()
   call random_problems()
   call augmentations_contract_as_predicted()
   call augmentations_that_stop_early_know_their_error()
   call uzawa_converges_below_its_bound()
   call finish()

contains

   !> Benchmark A1: k = 21000, gap 0.1, F = 10000.
   subroutine bar_with_a_gap()
      real(wp), parameter :: k = 21.0e3_wp, f = 1.0e4_wp, g0 = 0.1_wp
      real(wp) :: alpha, expected
      type(contact_result_type) :: result
      integer :: method

      do method = 1, size(method_names)
         call test('bar with a gap by '//trim(method_names(method)))
         alpha = 10.0_wp*k
         expected = f - k*g0
         if (method == 2 .or. method == 3) expected = alpha*(f - k*g0)/(k + alpha)
         call one_spring(method, k, g0, f, alpha, result)
         call close_to('force', result%force(1), expected, 1.0e-10_wp)
         if (method == 4) call is_true('10 augmentations', result%augmentations == 10)
         call one_spring(method, k, g0, 2000.0_wp, alpha, result)
         call close_to('open', result%force(1), 0.0_wp, 1.0e-14_wp)
         call one_spring(method, k, g0, k*g0, alpha, result)
         call close_to('grazing', result%force(1), 0.0_wp, 1.0e-8_wp)
         call is_true('grazing settles at once', result%iterations <= 2)
      end do
      call one_spring(4, k, g0, f, k, result)
      call is_true('34 augmentations at alpha = k', result%augmentations == 34)
   end subroutine bar_with_a_gap

   subroutine one_spring(method, k, g0, f, alpha, result)
      integer, intent(in) :: method
      real(wp), intent(in) :: k, g0, f, alpha
      type(contact_result_type), intent(out) :: result
      type(condensed_type) :: problem

      call new_problem(problem, reshape([sqrt(k)], [1, 1]), reshape([-1.0_wp], [1, 1]), method, &
         & alpha)
      call solve_contact(problem, [g0], [f], [real(wp) ::], result)
   end subroutine one_spring

   !> A dense problem from L and B (rows in order).
   subroutine new_problem(problem, l, b, method, alpha)
      type(condensed_type), intent(out) :: problem
      real(wp), intent(in) :: l(:, :), b(:, :), alpha
      integer, intent(in) :: method
      integer :: row, i

      problem%n = size(l, 1)
      problem%nrow = size(b, 1)
      problem%ngroup = 1
      problem%l = l
      problem%first = [(1 + (row - 1)*problem%n, row=1, problem%nrow + 1)]
      problem%column = [((i, i=1, problem%n), row=1, problem%nrow)]
      problem%value = reshape(transpose(b), [size(b)])
      allocate (problem%c(problem%nrow, 0))
      problem%bilateral = spread(.false., 1, problem%nrow)
      problem%alpha = spread(alpha, 1, problem%nrow)
      problem%group_first = [1, problem%nrow + 1]
      problem%max_augmentations = [merge(60, 0, method == 4)]
      problem%penetration = [0.0_wp]
      allocate (problem%group(1))
      call new_enforcement(problem%group(1)%method, trim(method_names(method)))
   end subroutine new_problem

   !> Benchmark A2: springs 1000 and 500, gap 0.2, F = 800.
   subroutine two_springs_and_masses()
      type(condensed_type) :: problem
      type(contact_result_type) :: result
      real(wp) :: l(2, 2)

      call test('two springs and masses')
      l = reshape([sqrt(1000.0_wp), 0.0_wp, 0.0_wp, sqrt(500.0_wp)], [2, 2])
      call new_problem(problem, l, reshape([-1.0_wp, 1.0_wp], [1, 2]), 1, 0.0_wp)
      call solve_contact(problem, [0.2_wp], [800.0_wp, 0.0_wp], [real(wp) ::], result)
      call close_to('Lagrange', result%force(1), 200.0_wp, 1.0e-12_wp)
      call new_problem(problem, l, reshape([-1.0_wp, 1.0_wp], [1, 2]), 2, 1.0e4_wp)
      call solve_contact(problem, [0.2_wp], [800.0_wp, 0.0_wp], [real(wp) ::], result)
      call close_to('penalty', result%force(1), 193.54838709677419_wp, 1.0e-12_wp)
   end subroutine two_springs_and_masses

   !> Benchmark F5: a definite matrix on which the plain active set cycles.
   subroutine cycling_matrix()
      type(condensed_type) :: problem
      type(contact_result_type) :: result
      real(wp), parameter :: m(3, 3) = reshape([9.0_wp, -13.0_wp, -16.0_wp, -13.0_wp, 22.0_wp, &
         & 28.0_wp, &
         & -16.0_wp, 28.0_wp, 36.0_wp], [3, 3])
      real(wp) :: l(3, 3), unit(3, 3)

      call test('the active set that cycles')
      l = 0.0_wp
      l(1, 1) = 1.0_wp
      l(2, 2) = 1.0_wp
      l(3, 3) = 1.0_wp
      unit = l
      call new_problem(problem, l, unit, 1, 0.0_wp)
      problem%s = m
      result%active = [.true., .false., .false.]
      result%multiplier = [0.0_wp, 0.0_wp, 0.0_wp]
      call solve_contact(problem, [-9.0_wp, 9.0_wp, 2.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], &
         & [real(wp) ::], result)
      call is_true('solved', result%outcome == outcome%solved)
      call is_true('one at a time', result%single_pivots > 0)
      call close_to('force', result%force, [4.2941176470588234_wp, 0.0_wp, 1.8529411764705883_wp], &
         & 1.0e-10_wp)
   end subroutine cycling_matrix

   !> A beam (EI = 1, length 100) clamped at one end, guided at the other, pressed down on a floor
   !> under it: free over l = 60 if the floor is q l^4/72 below; it bears q (100 - l) + q l/3. The
   !> compliance is so ill-conditioned that changing all wrong rows at once makes no progress, and
   !> changing the last wrong row alone (Murty) takes 140 701 pivots for 80 rows.
   subroutine beams_on_a_floor()
      integer, parameter :: rows(3) = [20, 40, 80]
      real(wp), parameter :: long = 100.0_wp, free = 60.0_wp, q = 1.0_wp
      real(wp), allocatable :: s(:, :), gap(:), x(:)
      type(contact_result_type) :: result
      integer :: i, j, k, n, method

      do k = 1, size(rows)
         n = rows(k)
         x = [(long*i/n, i=1, n)]
         gap = q*free**4/72.0_wp - q*x**2*(2.0_wp*long - x)**2/24.0_wp
         allocate (s(n, n))
         do j = 1, n
            do i = 1, n
               associate (a => min(x(i), x(j)), b => max(x(i), x(j)))
                  s(i, j) = a**2*(3.0_wp*b - a)/6.0_wp - (x(i)*x(j))**2/(4.0_wp*long)
               end associate
            end do
         end do
         do method = 1, 4, 3
            if (method == 4 .and. n > 40) cycle
            call test('a beam of '//char(48 + n/10)//'0 rows by '//trim(method_names(method)))
            call solve_rows(s, gap, method, .false., result)
            call is_true('solved', result%outcome == outcome%solved)
            call close_to('force', sum(result%force), q*(long - free + free/3.0_wp), &
               & 1.0e-4_wp)
            call close_to('no other force', minval(result%force), 0.0_wp, 1.0e-10_wp)
            if (method == 1) call is_true('as many pivots as rows', result%iterations <= 2*n)
         end do
         deallocate (s)
      end do
   end subroutine beams_on_a_floor

   !> The rows of a compliance of its own: K_c = I, B B^T = S.
   subroutine solve_rows(s, gap, method, held, result)
      real(wp), intent(in) :: s(:, :), gap(:)
      integer, intent(in) :: method
      logical, intent(in) :: held              !! every fifth row is held both ways
      type(contact_result_type), intent(out) :: result
      type(condensed_type) :: problem
      real(wp) :: unit(size(gap), size(gap)), b(size(gap), size(gap)), mean
      integer :: i, j, n, status

      n = size(gap)
      unit = 0.0_wp
      mean = 0.0_wp
      do i = 1, n
         unit(i, i) = 1.0_wp
         mean = mean + s(i, i)/n
      end do
      b = s
      call cholesky(b, status)
      call is_true('definite', status == 0)
      do j = 2, n
         b(:j - 1, j) = 0.0_wp
      end do
      call new_problem(problem, unit, b, method, 1.0e6_wp/mean)
      if (held) problem%bilateral(::5) = .true.
      call solve_contact(problem, gap, 0.0_wp*gap, [real(wp) ::], result)
   end subroutine solve_rows

   !> Gram matrices of smooth functions: most sets are wrong in most rows. Complementarity, with rows
   !> held both ways among them, and penalty = perturbed Lagrange.
   subroutine ill_conditioned_problems()
      integer, parameter :: n = 60
      integer :: trial, i, j
      real(wp) :: s(n, n), gap(n), wide, off
      type(contact_result_type) :: result, softer
      logical :: held(n)

      held = .false.
      held(::5) = .true.
      do trial = 1, 40
         call test('ill-conditioned problems')
         call random_number(gap)
         gap = gap - 0.7_wp
         wide = 0.1_wp*trial
         do j = 1, n
            do i = 1, n
               s(i, j) = exp(-abs(i - j)/wide) + exp(-(real(i - j, wp)/wide)**2)
            end do
         end do
         call solve_rows(s, gap, 1, mod(trial, 2) == 0, result)
         call is_true('solved', result%outcome == outcome%solved)
         call is_true('as many pivots as rows', result%iterations <= 3*n)
         off = maxval(abs(min(result%force, result%gap)), mask=.not. held)
         if (mod(trial, 2) == 0) off = max(off, maxval(abs(result%gap), mask=held))
         if (mod(trial, 2) == 1) off = maxval(abs(min(result%force, result%gap)))
         call close_to('complementarity', off, 0.0_wp, 1.0e-9_wp)
         call solve_rows(s, gap, 2, mod(trial, 2) == 0, result)
         call solve_rows(s, gap, 3, mod(trial, 2) == 0, softer)
         call close_to('penalty = perturbed', softer%force, result%force, 1.0e-7_wp)
      end do
   end subroutine ill_conditioned_problems

   !> A rigid mass between two walls, pushed against one: K_c has no part in it.
   subroutine floating_mass_is_held_by_contact()
      type(contact_result_type) :: result
      integer :: method

      do method = 1, size(method_names)
         call test('a floating mass is held by contact, '//trim(method_names(method)))
         call floating(method, 3.0_wp, result)
         call is_true('solved', result%outcome == outcome%solved)
         call close_to('force', result%force, [3.0_wp, 0.0_wp], 1.0e-10_wp)
      end do
   end subroutine floating_mass_is_held_by_contact

   subroutine floating_mass_that_flies_is_named()
      type(contact_result_type) :: result
      integer :: method

      do method = 1, size(method_names)
         call test('a mass pushed away from its only wall is not held, '// &
            & trim(method_names(method)))
         call floating(method, -3.0_wp, result, walls=1)
         call is_true('not held', result%outcome == outcome%not_held)
      end do
   end subroutine floating_mass_that_flies_is_named

   !> Gaps: wall 1 ahead, on a spring of stiffness 50; wall 2 behind, stiff.
   subroutine floating(method, push, result, walls)
      integer, intent(in) :: method
      real(wp), intent(in) :: push
      type(contact_result_type), intent(out) :: result
      integer, intent(in), optional :: walls
      type(condensed_type) :: problem
      real(wp) :: b(2, 2), l(2, 2)
      real(wp), parameter :: gaps(2) = [0.1_wp, 0.2_wp]
      integer :: n

      n = 2
      if (present(walls)) n = walls
      l = reshape([sqrt(50.0_wp), 0.0_wp, 0.0_wp, sqrt(80.0_wp)], [2, 2])
      b = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      call new_problem(problem, l, b(:n, :), method, 1000.0_wp)
      problem%nq = 1
      deallocate (problem%c)
      allocate (problem%c(n, 1))
      problem%c(1, 1) = -1.0_wp
      if (n == 2) problem%c(2, 1) = 1.0_wp
      call solve_contact(problem, gaps(:n), [0.0_wp, 0.0_wp], [push], result)
   end subroutine floating

   !> 200 random definite problems: complementarity to round-off, all methods that are exact agree.
   subroutine random_problems()
      integer, parameter :: n = 12
      integer :: trial, j, i
      real(wp) :: l(n, n), b(n, n), gap(n), force(n), worst
      type(condensed_type) :: problem
      type(contact_result_type) :: result, softer

      call test('random problems')
      worst = 0.0_wp
      do trial = 1, 200
         call random_number(l)
         do j = 1, n
            do i = 1, j - 1
               l(i, j) = 0.0_wp
            end do
            l(j, j) = 1.0_wp + l(j, j)
         end do
         call random_number(b)
         b = b - 0.5_wp
         call random_number(gap)
         call random_number(force)
         gap = gap - 0.5_wp
         call new_problem(problem, l, b, 1, 0.0_wp)
         result = contact_result_type()
         call solve_contact(problem, gap, 5.0_wp*(force - 0.5_wp), [real(wp) ::], result)
         call is_true('solved', result%outcome == outcome%solved)
         worst = max(worst, maxval(abs(min(result%force, result%gap)))/maxval(abs(result%force) &
            & + 1.0_wp))
         call new_problem(problem, l, b, 2, 1.0e3_wp)
         result = contact_result_type()
         call solve_contact(problem, gap, force, [real(wp) ::], result)
         call new_problem(problem, l, b, 3, 1.0e3_wp)
         softer = contact_result_type()
         call solve_contact(problem, gap, force, [real(wp) ::], softer)
         call close_to('penalty = perturbed', softer%force, result%force, 1.0e-9_wp)
      end do
      call close_to('complementarity', worst, 0.0_wp, 1.0e-9_wp)
   end subroutine random_problems

   !> Benchmark F4: with the step alpha every alpha > 0 converges, by 1/(1 + alpha s_min) a pass.
   subroutine augmentations_contract_as_predicted()
      real(wp), parameter :: s_min = (5.0_wp - sqrt(5.0_wp))/10.0_wp
      real(wp), parameter :: alpha(7) = [0.1_wp, 0.5_wp, 1.0_wp, 3.0_wp, 10.0_wp, 1.0e3_wp, &
         & 1.0e6_wp]
      type(condensed_type) :: problem
      type(contact_result_type) :: result, exact
      real(wp) :: l(2, 2)
      integer :: i

      ! K = [3 -1; -1 2], both springs pushed on their walls.
      l = reshape([sqrt(3.0_wp), -1.0_wp/sqrt(3.0_wp), 0.0_wp, sqrt(5.0_wp/3.0_wp)], [2, 2])
      call test('Lagrange on two coupled springs')
      call new_problem(problem, l, -reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), 1, 1.0_wp)
      call solve_contact(problem, [0.1_wp, 0.2_wp], [2.0_wp, 3.0_wp], [real(wp) ::], exact)
      call close_to('forces', exact%force, [1.9_wp, 2.7_wp], 1.0e-13_wp)
      do i = 1, size(alpha)
         call test('augmentations contract by 1/(1 + alpha s)')
         call new_problem(problem, l, -reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), 4, &
            & alpha(i))
         problem%max_augmentations = [2000]
         call solve_contact(problem, [0.1_wp, 0.2_wp], [2.0_wp, 3.0_wp], [real(wp) ::], result)
         call is_true('converges', result%outcome == outcome%solved)
         call close_to('forces', result%force, exact%force, 1.0e-9_wp)
         if (alpha(i) > 100.0_wp) cycle
         call close_to('rate', result%rate, 1.0_wp/(1.0_wp + alpha(i)*s_min), 1.0e-3_wp)
      end do
      call close_to('rate at alpha = 1', 1.0_wp/(1.0_wp + s_min), 0.783458_wp, 1.0e-6_wp)
   end subroutine augmentations_contract_as_predicted

   !> One spring: after n passes the force is short by 1/(1 + alpha/k)^n; one more pass shows all
   !> but that share of it.
   subroutine augmentations_that_stop_early_know_their_error()
      real(wp), parameter :: k = 100.0_wp, alpha = 100.0_wp, push = 10.0_wp
      real(wp), parameter :: accepted(3) = [1.0_wp, 0.03_wp, 0.001_wp]
      type(condensed_type) :: problem
      type(contact_result_type) :: result
      real(wp) :: short
      integer :: i

      do i = 1, size(accepted)
         call test('augmentations that stop at a penetration know their error')
         call new_problem(problem, reshape([sqrt(k)], [1, 1]), reshape([-1.0_wp], [1, 1]), 4, alpha)
         problem%penetration = accepted(i)
         if (allocated(result%active)) deallocate (result%active)
         call solve_contact(problem, [0.0_wp], [push], [real(wp) ::], result)
         short = 0.5_wp**result%augmentations
         call close_to('force', result%force(1), push*(1.0_wp - short), 1.0e-12_wp)
         call close_to('estimate', result%soft_error, 0.5_wp*short/(1.0_wp - short), 1.0e-12_wp)
      end do
   end subroutine augmentations_that_stop_early_know_their_error

   !> Benchmark F4: multipliers moved by rho times the gap, without a spring or beside one of
   !> stiffness alpha, converge for rho < 2/s_max and rho < 2 (alpha + 1/s_max), s the code's own
   !> compliance.
   subroutine uzawa_converges_below_its_bound()
      real(wp), parameter :: k(2, 2) = reshape([3.0_wp, -1.0_wp, -1.0_wp, 2.0_wp], [2, 2])
      real(wp), parameter :: bound(2) = [2.763932022500210_wp, 4.763932022500210_wp]
      type(condensed_type) :: problem
      real(wp) :: l(2, 2), alpha
      integer :: i

      call test('Uzawa converges below its bound and diverges above')
      do i = 1, 2
         alpha = real(i - 1, wp)
         l = k
         l(1, 1) = sqrt(k(1, 1) + alpha)
         l(2, 1) = k(2, 1)/l(1, 1)
         l(1, 2) = 0.0_wp
         l(2, 2) = sqrt(k(2, 2) + alpha - l(2, 1)**2)
         call new_problem(problem, l, reshape([-1.0_wp, 0.0_wp, 0.0_wp, -1.0_wp], [2, 2]), 1, &
            & 0.0_wp)
         if (allocated(problem%s)) deallocate (problem%s)
         call form_compliance(problem)
         call is_true('below', uzawa_gap(problem%s, 0.99_wp*bound(i)) < 1.0e-6_wp)
         call is_true('above', uzawa_gap(problem%s, 1.01_wp*bound(i)) > 1.0e2_wp)
      end do
   end subroutine uzawa_converges_below_its_bound

   !> Largest gap after 1000 passes from no force, both points held (bilateral).
   real(wp) function uzawa_gap(s, rho)
      real(wp), intent(in) :: s(:, :), rho
      real(wp) :: force(2), gap(2)
      integer :: pass

      force = 0.0_wp
      do pass = 1, 1000
         gap = [-1.0_wp, 0.5_wp] + matmul(s, force)
         force = force - rho*gap
      end do
      uzawa_gap = maxval(abs(gap))
   end function uzawa_gap
end program test_active_set
