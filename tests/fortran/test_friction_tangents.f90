!> Rows of points have the slopes of their differences; steps on the rows along the faces alone, and
!> on all closed rows: the same states.
program test_friction_tangents
   use lopin_kinds, only : wp
   use check, only : test, close_to, is_true, finish
   use lopin_condensed, only : condensed_type, form_compliance
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_dense, only : cholesky
   use lopin_friction, only : law_of, law_names
   use friction_cases, only : law_with, scene
   use lopin_friction_rows, only : friction_points_type, new_equations, form_equations
   use lopin_friction_step, only : trial_type, work_type, step_of_all_rows
   use lopin_friction_tangents, only : step_to
   use lopin_eliminated_normals, only : eliminated_type, eliminate_normals
   implicit none
   integer :: law, nt

   call what_is_left()
   call rows_that_depend()
   call steps(1, 0)
   call steps(2, 0)
   call steps(1, 1)
   call steps(2, 2)
   do law = 1, size(law_names)
      do nt = 1, 2
         call slopes(law, nt, 0.0_wp, 0.0_wp)
         call slopes(law, nt, 0.2_wp, 0.0_wp)
         call slopes(law, nt, 0.0_wp, 3.0_wp)
      end do
   end do
   call finish()

contains

   !> S = [2, 1; 1, 3], D = 0.5: 3 - 1/2.5 = 2.6, and a force along the face takes 0.4 of itself from
   !> that across.
   subroutine what_is_left()
      type(eliminated_type) :: held
      real(wp), parameter :: s(2, 2) = reshape([2.0_wp, 1.0_wp, 1.0_wp, 3.0_wp], [2, 2])
      real(wp) :: c(2, 0)

      call test('one closed row across leaves 3 - 1/2.5 along')
      call eliminate_normals(held, s, c, [1], [2], [0.5_wp])
      call is_true('regular', held%regular)
      call close_to('left', held%h(1, 1), 2.6_wp, 1.0e-14_wp)
      call close_to('follows', held%follow(1, 1), 0.4_wp, 1.0e-14_wp)
   end subroutine what_is_left

   subroutine rows_that_depend()
      type(eliminated_type) :: held
      real(wp) :: s(3, 3), c(3, 0)

      call test('rows across that say the same are told')
      s = 1.0_wp
      s(3, 3) = 2.0_wp
      call eliminate_normals(held, s, c, [1, 2], [3], [0.0_wp, 0.0_wp])
      call is_true('not regular', .not. held%regular)
   end subroutine rows_that_depend

   !> Twelve points of a random compliance, some open, stick and slip, some motions that float.
   subroutine steps(nt, nq)
      integer, intent(in) :: nt, nq
      integer, parameter :: n = 12
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(work_type) :: work, again
      type(trial_type) :: x, one, other
      integer :: trial, i

      call test('steps of points with tangents and motions: one way and the other')
      call random_problem(problem, points, n, nt, nq)
      do trial = 1, 5
         work = work_type()
         work%free_gap = random(problem%nrow)
         work%free_gap(:n) = -1.0_wp - work%free_gap(:n)
         work%moving = 0.3_wp*random(nq)
         work%q_scale = [(1.0_wp, i=1, nq)]
         call new_equations(work%equations, problem, points)
         x%force = random(problem%nrow)
         x%force(:n) = x%force(:n) + 1.0_wp
         x%force(trial) = -4.0_wp
         x%q = random(nq)
         x%gap = work%free_gap + matmul(problem%s, x%force) + matmul(problem%c, x%q)
         x%gap(:n) = 0.2_wp*random(n)
         call form_equations(work%equations, problem, points, x%force, x%gap)
         again = work
         call step_of_all_rows(problem, points, work, x, one)
         call step_to(problem, points, again, x, other)
         call is_true('rows were eliminated', problem%eliminated%regular)
         call close_to('forces', other%force, one%force, 1.0e-10_wp*maxval(abs(one%force)))
         call close_to('gaps', other%gap, one%gap, 1.0e-10_wp*maxval(abs(one%gap)))
         if (nq > 0) call close_to('motions', other%q, one%q, 1.0e-10_wp*maxval(abs(one%q)))
         call is_true('sign', again%sign_of_determinant == work%sign_of_determinant)
      end do
   end subroutine steps

   !> Rows along the faces by fourth-order differences along ways in all forces and gaps: exact
   !> stick, elastic slip, a stiffness of stick.
   subroutine slopes(law, nt, elastic_slip, stiffness)
      integer, intent(in) :: law, nt
      real(wp), intent(in) :: elastic_slip, stiffness
      integer, parameter :: n = 12, nway = 4
      real(wp), parameter :: h = 1.0e-5_wp, far(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp], &
         & share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      type(condensed_type) :: problem
      type(friction_points_type) :: points
      type(work_type) :: work
      real(wp), allocatable :: force(:), gap(:), dforce(:), dgap(:), rate(:), slope(:)
      integer :: status(n), trial, way, i, j, k
      integer :: kept(n)                       !! state before and behind differences is the same

      call test('slopes of points: '//trim(law_names(law)))
      call random_problem(problem, points, n, nt, 0)
      points%law = law_with(law)
      points%at = scene()
      points%elastic_slip = elastic_slip
      points%stiffness = stiffness
      do trial = 1, nway
         call new_equations(work%equations, problem, points)
         force = random(problem%nrow)
         gap = 0.3_wp*random(problem%nrow)
         force(:n) = force(:n) + 1.5_wp
         dforce = random(problem%nrow)
         dgap = random(problem%nrow)
         kept = 1
         allocate (rate(problem%nrow), slope(problem%nrow), source=0.0_wp)
         call form_equations(work%equations, problem, points, force, gap)
         status = work%equations%status
         do way = 1, 4
            call form_equations(work%equations, problem, points, force + far(way)*h*dforce, gap &
               & + far(way)*h*dgap)
            rate = rate + share(way)/h*work%equations%residual
            where (work%equations%status /= status) kept = 0
         end do
         call form_equations(work%equations, problem, points, force, gap)
         call is_true('most states stay', sum(kept) > n/2)
         do k = 1, n
            associate (from => points%tangent(k), e => work%equations)
               if (status(k) == 0 .or. kept(k) == 0) cycle
               do i = 1, nt
                  slope(from + i - 1) = e%p(i, 0, k)*dforce(k) + e%q(i, 0, k)*dgap(k)
                  do j = 1, nt
                     slope(from + i - 1) = slope(from + i - 1) + e%p(i, j, k)*dforce(from + j - 1) &
                        & + e%q(i, j, k)*dgap(from + j - 1)
                  end do
               end do
               call close_to('slope', slope(from:from + nt - 1), rate(from:from + nt - 1), &
                  & 1.0e-7_wp*(1.0_wp + maxval(abs(rate(from:from + nt - 1)))))
            end associate
         end do
         deallocate (rate, slope)
      end do
   end subroutine slopes

   subroutine random_problem(problem, points, n, nt, nq)
      type(condensed_type), intent(out) :: problem
      type(friction_points_type), intent(out) :: points
      integer, intent(in) :: n, nt, nq
      integer :: i, row, status, m

      m = n*(1 + nt)
      problem%n = m
      problem%nrow = m
      problem%nq = nq
      problem%ngroup = 1
      problem%l = 0.2_wp*reshape(random(m*m), [m, m])
      problem%l = matmul(problem%l, transpose(problem%l))
      do i = 1, m
         problem%l(i, i) = problem%l(i, i) + 1.0_wp
      end do
      call cholesky(problem%l, status)
      problem%first = [(row, row=1, m + 1)]
      problem%column = [(row, row=1, m)]
      problem%value = spread(1.0_wp, 1, m)
      problem%c = reshape(random(m*nq), [m, nq])
      problem%bilateral = spread(.false., 1, m)
      problem%alpha = spread(0.0_wp, 1, m)
      problem%group_first = [1, n + 1]
      problem%max_augmentations = [0]
      problem%penetration = [0.0_wp]
      allocate (problem%group(1))
      call new_enforcement(problem%group(1)%method, 'lagrange')
      call form_compliance(problem)
      points%n = n
      points%nt = nt
      points%normal = [(i, i=1, n)]
      points%tangent = [(n + 1 + (i - 1)*nt, i=1, n)]
      allocate (points%law(n), points%at(n))
      points%law%law = law_of%coulomb
      points%law%mu = 0.3_wp
      points%weight = spread(1.0_wp, 1, n)
      points%stiffness = spread(0.0_wp, 1, n)
      points%elastic_slip = spread(0.0_wp, 1, n)
      points%augmented = spread(.false., 1, n)
      allocate (points%traction(nt, n), points%start(nt, n), points%anchor(nt, n), &
         & points%elastic(nt, n), source=0.0_wp)
   end subroutine random_problem

   !> Numbers between -1 and 1, the same in every run.
   function random(n) result(x)
      integer, intent(in) :: n
      real(wp) :: x(n)
      integer, save :: seed = 7
      integer :: i

      do i = 1, n
         seed = mod(16807*mod(seed, 127773) - 2836*(seed/127773), 2147483647)
         if (seed <= 0) seed = seed + 2147483647
         x(i) = 2.0_wp*seed/2147483647.0_wp - 1.0_wp
      end do
   end function random
end program test_friction_tangents
