!> A Newton step of contact with friction on the rows along the faces alone.
!>
!> The rows across them are eliminated once for a set of closed rows (lopin_eliminated_normals).
!> Where they depend on each other, have a law without a slope, or a pivot loses its digits, all
!> closed rows are solved together (lopin_friction_step), which finds what yields.
module lopin_friction_tangents
   use lopin_kinds, only : wp
   use lopin_blas, only : dgetrf, dgetrs
   use lopin_dense, only : cholesky_solve
   use lopin_condensed, only : condensed_type
   use lopin_eliminated_normals, only : eliminated_type, eliminate_normals
   use lopin_friction_rows, only : friction_points_type
   use lopin_friction_step, only : trial_type, work_type, step_of_all_rows, no_pivot
   implicit none
   private
   public :: step_to

contains

   !> The state that the equations linearised at x ask for.
   subroutine step_to(self, points, work, x, next)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      type(trial_type), intent(out) :: next
      real(wp), allocatable :: a(:, :), right(:), normal(:)
      logical :: solved

      call eliminate(self, work, solved)
      if (solved) then
         call fill_tangents(self, self%eliminated, points, work, x, a, right, normal)
         call solve_tangents(self, self%eliminated, work, a, right, solved)
      end if
      if (.not. solved) then
         call step_of_all_rows(self, points, work, x, next)
         return
      end if
      call take_state(self, self%eliminated, work, right, normal, next)
   end subroutine step_to

   !> Eliminate the closed rows across the faces; .false. if that cannot be.
   subroutine eliminate(self, work, can)
      type(condensed_type), intent(inout) :: self
      type(work_type), intent(in) :: work
      logical, intent(out) :: can
      integer, allocatable :: normal(:), tangent(:)
      integer :: i

      associate (e => work%equations)
         normal = pack([(i, i=1, self%nrow)], e%closed .and. e%group > 0)
         tangent = pack([(i, i=1, self%nrow)], e%closed .and. e%group == 0)
         can = size(tangent) > 0 .and. .not. any(e%gap_diagonal(normal) <= 0.0_wp)
         if (.not. can) return
         call eliminate_normals(self%eliminated, self%s, self%c, normal, tangent, &
            & e%diagonal(normal)/e%gap_diagonal(normal))
         can = self%eliminated%regular
      end associate
   end subroutine eliminate

   !> The transposed matrix of the rows along the faces and of the balance of motions; the right
   !> side, and the forces across the faces where those along them and the motions are zero.
   subroutine fill_tangents(self, held, points, work, x, a, right, normal)
      type(condensed_type), intent(in) :: self
      type(eliminated_type), intent(in) :: held
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(in) :: work
      type(trial_type), intent(in) :: x
      real(wp), allocatable, intent(out) :: a(:, :)    !! (tangents + nq)^2
      real(wp), allocatable, intent(out) :: right(:), normal(:)
      real(wp), allocatable :: along(:), given(:)
      integer :: place(self%nrow), i, k, t

      t = size(held%tangent)
      place = 0
      place(held%tangent) = [(i, i=1, t)]
      place(held%normal) = [(i, i=1, size(held%normal))]
      call press_alone(self, held, work, x, given, normal, along)
      associate (e => work%equations)
         allocate (a(t + self%nq, t + self%nq), right(t + self%nq), source=0.0_wp)
         do k = 1, points%n
            if (place(points%tangent(k)) == 0) cycle
            if (.not. e%closed(points%tangent(k))) cycle
            call fill_point(k, place(points%tangent(k)), place(points%normal(k)))
         end do
      end associate
      do i = 1, self%nq
         a(:, t + i) = held%h(:, t + i)*work%q_scale(i)
         right(t + i) = -(work%moving(i) + along(t + i))*work%q_scale(i)
      end do

   contains

      !> Rows of a point: P force + Q gap.
      subroutine fill_point(k, from, across)
         integer, intent(in) :: k
         integer, intent(in) :: from, across   !! place of its first tangential, of its normal row
         integer :: i, j, row, tangent
         real(wp) :: push

         associate (e => work%equations)
            do i = 1, points%nt
               row = from + i - 1
               right(row) = -e%residual(points%tangent(k) + i - 1) &
                  & + e%p(i, 0, k)*x%force(points%normal(k)) + e%q(i, 0, k)* &
                  & (x%gap(points%normal(k)) - work%free_gap(points%normal(k)) - given(across))
               push = e%p(i, 0, k) - e%q(i, 0, k)*held%give(across)
               right(row) = right(row) - push*normal(across)
               if (abs(push) > 0.0_wp) a(:, row) = a(:, row) - push*held%follow(:, across)
               do j = 1, points%nt
                  tangent = points%tangent(k) + j - 1
                  a(from + j - 1, row) = a(from + j - 1, row) + e%p(i, j, k)
                  right(row) = right(row) + e%p(i, j, k)*x%force(tangent) + e%q(i, j, k)* &
                     & (x%gap(tangent) - work%free_gap(tangent) - along(from + j - 1))
                  if (abs(e%q(i, j, k)) > 0.0_wp) a(:, row) = a(:, row) + e%q(i, j, k) &
                     & *held%h(:, from + j - 1)
               end do
            end do
         end associate
      end subroutine fill_point
   end subroutine fill_tangents

   !> Forces across the faces where those along them and the motions are zero, and what they do.
   subroutine press_alone(self, held, work, x, given, normal, along)
      type(condensed_type), intent(in) :: self
      type(eliminated_type), intent(in) :: held
      type(work_type), intent(in) :: work
      type(trial_type), intent(in) :: x
      real(wp), allocatable, intent(out) :: given(:)    !! (normals) S force + D force [length]
      real(wp), allocatable, intent(out) :: normal(:)   !! (normals) [force]
      real(wp), allocatable, intent(out) :: along(:)    !! (tangents + nq) to gaps and the balance
      integer :: i, t

      t = size(held%tangent)
      associate (e => work%equations, n => held%normal)
         given = (e%diagonal(n)*x%force(n) - e%residual(n))/e%gap_diagonal(n) + x%gap(n) &
            & - work%free_gap(n)
         normal = given
         call cholesky_solve(held%factor, normal)
         allocate (along(t + self%nq), source=0.0_wp)
         do i = 1, size(n)
            along(:t) = along(:t) + self%s(held%tangent, n(i))*normal(i)
         end do
         along(t + 1:) = matmul(normal, self%c(n, :))
      end associate
   end subroutine press_alone

   !> Solve; .false. where a pivot lost its digits beside those of all closed rows.
   subroutine solve_tangents(self, held, work, a, right, solved)
      type(condensed_type), intent(in) :: self
      type(eliminated_type), intent(in) :: held
      type(work_type), intent(inout) :: work
      real(wp), intent(inout) :: a(:, :), right(:)
      logical, intent(out) :: solved
      real(wp) :: most(size(right))
      integer :: pivot(size(right)), i, n, t, status, sign_

      n = size(right)
      t = n - self%nq
      most = 0.0_wp
      do i = 1, n
         most = max(most, abs(a(:, i)))
      end do
      most(:t) = max(most(:t), work%equations%c(held%tangent)*held%most)
      do i = 1, self%nq
         most(t + i) = max(most(t + i), maxval(abs(self%c(held%normal, i)) &
            & *work%equations%c(held%normal)), maxval(abs(self%c(held%tangent, i)) &
            & *work%equations%c(held%tangent)))
      end do
      call dgetrf(n, n, a, n, pivot, status)
      solved = status == 0
      sign_ = 1
      do i = 1, n
         if (pivot(i) /= i) sign_ = -sign_
         if (a(i, i) < 0.0_wp) sign_ = -sign_
         solved = solved .and. abs(a(i, i)) > no_pivot*most(i)
      end do
      if (.not. solved) return
      if (mod(self%nq, 2) == 1) sign_ = -sign_
      work%sign_of_determinant = sign_
      work%singular = .false.
      call dgetrs('T', n, 1, a, n, pivot, right, n, status)
   end subroutine solve_tangents

   !> All forces, gaps and motions from those along the faces.
   subroutine take_state(self, held, work, along, normal, next)
      type(condensed_type), intent(in) :: self
      type(eliminated_type), intent(in) :: held
      type(work_type), intent(in) :: work
      real(wp), intent(in) :: along(:)         !! tangential forces, then motions
      real(wp), intent(in) :: normal(:)        !! forces across where `along` is zero
      type(trial_type), intent(out) :: next
      integer :: row

      allocate (next%force(self%nrow), source=0.0_wp)
      next%force(held%normal) = normal - matmul(along, held%follow)
      next%force(held%tangent) = along(:size(held%tangent))
      next%q = along(size(held%tangent) + 1:)
      next%gap = work%free_gap
      do row = 1, self%nrow
         if (abs(next%force(row)) > 0.0_wp) next%gap = next%gap + self%s(:, row)*next%force(row)
      end do
      if (self%nq > 0) next%gap = next%gap + matmul(self%c, next%q)
   end subroutine take_state
end module lopin_friction_tangents
