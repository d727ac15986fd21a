!> One Newton step of contact with friction: the linear system on the closed rows, its residual, its
!> line search.
module lopin_friction_step
   use lopin_kinds, only : wp
   use lopin_blas, only : dgetrf, dgetrs
   use lopin_condensed, only : condensed_type
   use lopin_friction_rows, only : friction_points_type, equations_type, form_equations
   implicit none
   private
   public :: trial_type, work_type, friction_controls_type, step_of_all_rows, check, search_line
   public :: no_pivot

   integer, parameter :: halvings = 5
   !> Pivots below this share of their column are dependent rows.
   real(wp), parameter :: no_pivot = 1.0e-14_wp

   !> A state, and what one solve carries around.
   type :: trial_type
      real(wp), allocatable :: force(:), gap(:), q(:)
   end type trial_type

   !> What an atlas of failures turns off; the defaults are what every run has.
   type :: friction_controls_type
      real(wp) :: scaling = 0.0_wp   !! c_t times the mean nodal S_tt; 0: the collective rule [-]
      logical :: line_search = .true.
      logical :: predict = .true.                  !! first step with the states accepted last
      logical :: ladder = .true.                   !! fallbacks where states repeat
   end type friction_controls_type

   type :: work_type
      type(equations_type) :: equations
      type(friction_controls_type) :: controls
      real(wp), allocatable :: free_gap(:), moving(:), q_scale(:)
      real(wp), allocatable :: nodal(:)           !! (nrow) scaling of each row alone [force/length]
      real(wp), allocatable :: old_gap(:)          !! (nrow) accepted last [length]
      real(wp) :: gap_scale = 0.0_wp
      logical :: predict = .false.                 !! first step with the states accepted last
      logical :: cold = .false.                    !! there are none: these press and stick
      logical, allocatable :: touching(:)          !! (nrow) rows without a gap before loading
      logical :: one_by_one = .false.
      logical :: singular = .false.
      integer :: sign_of_determinant = 1, dependent = 0
      integer :: cure = 1                          !! fallback%... in use
      integer :: iterations = 0, single_pivots = 0 !! of all fallbacks
      real(wp), allocatable :: norms(:)            !! residuals of Newton, last run [force]
      integer, allocatable :: changing(:)          !! points that changed in its last step
   end type work_type

contains

   !> The state that the equations linearised at x ask for, by one system of all closed rows.
   subroutine step_of_all_rows(self, points, work, x, next)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      type(trial_type), intent(out) :: next
      real(wp), allocatable :: a(:, :), right(:)
      integer, allocatable :: rows(:), place(:)
      integer :: i, m

      rows = pack([(i, i=1, self%nrow)], work%equations%closed)
      m = size(rows)
      allocate (place(self%nrow), source=0)
      place(rows) = [(i, i=1, m)]
      allocate (a(m + self%nq, m + self%nq), right(m + self%nq), source=0.0_wp)
      call fill_matrix(self, points, work, x, rows, place, a, right)
      call solve_matrix(self, work, x, rows, a, right)
      allocate (next%force(self%nrow), source=0.0_wp)
      next%force(rows) = right(:m)
      next%q = right(m + 1:)
      next%gap = work%free_gap
      do i = 1, m
         next%gap = next%gap + self%s(:, rows(i))*right(i)
      end do
      if (self%nq > 0) next%gap = next%gap + matmul(self%c, next%q)
   end subroutine step_of_all_rows

   !> Rows P force + Q gap = P force_x + Q gap_x - residual with gap = free_gap + S force + C q, and
   !> the balance of the floating motions.
   subroutine fill_matrix(self, points, work, x, rows, place, a, right)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(in) :: work
      type(trial_type), intent(in) :: x
      integer, intent(in) :: rows(:), place(:)
      real(wp), intent(inout) :: a(:, :), right(:)
      integer :: i, j, k, m, row, other, from

      m = size(rows)
      associate (e => work%equations)
         do i = 1, m
            row = rows(i)
            right(i) = -e%residual(row)
            if (e%group(row) == 0) cycle
            a(i, i) = e%diagonal(row)
            right(i) = right(i) + e%diagonal(row)*x%force(row)
            call add_gap(i, row, e%gap_diagonal(row))
         end do
         do k = 1, points%n
            from = points%tangent(k)
            if (place(from) == 0) cycle
            do i = 1, points%nt
               row = place(from + i - 1)
               do j = 0, points%nt
                  other = from + j - 1
                  if (j == 0) other = points%normal(k)
                  a(row, place(other)) = a(row, place(other)) + e%p(i, j, k)
                  right(row) = right(row) + e%p(i, j, k)*x%force(other)
                  if (abs(e%q(i, j, k)) > 0.0_wp) call add_gap(row, other, e%q(i, j, k))
               end do
            end do
         end do
      end associate
      do i = 1, self%nq
         a(m + i, :m) = self%c(rows, i)*work%q_scale(i)
         right(m + i) = -work%moving(i)*work%q_scale(i)
      end do

   contains

      !> factor*gap(of) in equation i.
      subroutine add_gap(i, of, factor)
         integer, intent(in) :: i, of
         real(wp), intent(in) :: factor

         a(i, :m) = a(i, :m) + factor*self%s(rows, of)
         a(i, m + 1:) = a(i, m + 1:) + factor*self%c(of, :)
         right(i) = right(i) + factor*(x%gap(of) - work%free_gap(of))
      end subroutine add_gap
   end subroutine fill_matrix

   !> Solve, or, where rows depend on each other or motions are not held, the nearest problem that
   !> has one answer: rows yield a trace, motions stay near those of x.
   subroutine solve_matrix(self, work, x, rows, a, right)
      type(condensed_type), intent(in) :: self
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      integer, intent(in) :: rows(:)
      real(wp), intent(in) :: a(:, :)
      real(wp), intent(inout) :: right(:)
      real(wp), allocatable :: lu(:, :), moved(:)
      integer :: pivot(size(right)), i, m, n, status
      real(wp) :: ground

      m = size(rows)
      n = size(right)
      work%singular = .false.
      if (n == 0) return
      lu = a
      call dgetrf(n, n, lu, n, pivot, status)
      moved = [(maxval([0.0_wp, abs(self%c(rows, i))*work%equations%c(rows)]), i=1, self%nq)]
      if (status /= 0 .or. lost(lu, a, moved)) then
         ! First those along the faces alone: where normals of two pairs meet at a node, they bear.
         call yield_rows(a, work%equations%group(rows) == 0, lu)
         call dgetrf(n, n, lu, n, pivot, status)
         if (status /= 0 .or. lost(lu, a, moved)) then
            call yield_rows(a, spread(.true., 1, m), lu)
            call dgetrf(n, n, lu, n, pivot, status)
         end if
         work%singular = self%nq > 0 .and. (status /= 0 .or. lost(lu, a, moved))
         if (work%singular) then
            call yield_rows(a, spread(.true., 1, m), lu)
            do i = 1, self%nq
               ground = sum((self%c(rows, i)*work%q_scale(i))**2*work%equations%c(rows))
               if (.not. ground > 0.0_wp) ground = 1.0_wp
               ground = 1.0e-2_wp*ground/work%q_scale(i)
               lu(m + i, m + i) = lu(m + i, m + i) - ground
               right(m + i) = right(m + i) - ground*x%q(i)
            end do
            call dgetrf(n, n, lu, n, pivot, status)
         else
            ! The motions are held: rows of one node, or of several, say the same.
            work%dependent = max(work%dependent, 1)
         end if
      end if
      work%sign_of_determinant = 1
      do i = 1, n
         if (pivot(i) /= i) work%sign_of_determinant = -work%sign_of_determinant
         if (lu(i, i) < 0.0_wp) work%sign_of_determinant = -work%sign_of_determinant
      end do
      if (mod(self%nq, 2) == 1) work%sign_of_determinant = -work%sign_of_determinant
      if (status /= 0) then
         right = [x%force(rows), x%q]
         return
      end if
      call dgetrs('N', n, 1, lu, n, pivot, right, n, status)
   end subroutine solve_matrix

   !> Equations of rows give way by a trace of what the stiffest of them does.
   pure subroutine yield_rows(a, which, yielding)
      real(wp), intent(in) :: a(:, :)
      logical, intent(in) :: which(:)          !! (closed rows)
      real(wp), intent(inout) :: yielding(:, :)
      real(wp) :: most
      integer :: i

      yielding = a
      most = 0.0_wp
      do i = 1, size(which)
         most = max(most, abs(a(i, i)))
      end do
      do i = 1, size(which)
         if (which(i)) yielding(i, i) = yielding(i, i) + 1.0e-11_wp*most
      end do
   end subroutine yield_rows

   !> A pivot lost all the digits of its column; those of the motions also beside what they would do
   !> to rows that stick.
   pure logical function lost(lu, a, moved)
      real(wp), intent(in) :: lu(:, :), a(:, :), moved(:)
      real(wp) :: most
      integer :: i, m

      lost = .false.
      m = size(lu, 1) - size(moved)
      do i = 1, size(lu, 1)
         most = maxval(abs(a(:, i)))
         if (i > m) most = max(most, moved(i - m))
         lost = lost .or. .not. abs(lu(i, i)) > no_pivot*most
      end do
   end function lost

   !> Natural residual of a state, in force.
   subroutine check(self, points, work, x, norm)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      real(wp), intent(out) :: norm

      call form_equations(work%equations, self, points, x%force, x%gap)
      norm = norm2(work%equations%residual)
      if (self%nq > 0) norm = hypot(norm, norm2(work%q_scale*(matmul(x%force, self%c) &
         & + work%moving)))
   end subroutine check

   !> The longest of the steps 1, 1/2 ... that lowers the residual below the worst of the last few.
   subroutine search_line(self, points, work, x, next, worst, norm)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      type(trial_type), intent(in) :: next
      real(wp), intent(in) :: worst
      real(wp), intent(out) :: norm
      type(trial_type) :: trial
      real(wp) :: step, best, best_step
      integer :: i

      step = 1.0_wp
      best = huge(1.0_wp)
      best_step = 1.0_wp
      do i = 0, halvings
         call on_the_way(step, trial)
         call check(self, points, work, trial, norm)
         if (norm <= (1.0_wp - 1.0e-4_wp*step)*worst) exit
         if (norm < best) then
            best = norm
            best_step = step
         end if
         step = 0.5_wp*step
      end do
      if (i > halvings) then
         call on_the_way(best_step, trial)
         call check(self, points, work, trial, norm)
      end if
      x = trial

   contains

      subroutine on_the_way(share, trial)
         real(wp), intent(in) :: share
         type(trial_type), intent(out) :: trial

         trial = next
         if (share >= 1.0_wp) return
         trial%force = x%force + share*(next%force - x%force)
         trial%gap = x%gap + share*(next%gap - x%gap)
         trial%q = x%q + share*(next%q - x%q)
      end subroutine on_the_way
   end subroutine search_line
end module lopin_friction_step
