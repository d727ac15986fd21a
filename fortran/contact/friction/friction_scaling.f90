!> The scaling that decides stick and slip, and when a state is the answer.
!>
!> Two scalings of one residual: Newton looks at all closed points together (collective), the answer
!> is judged point by point (nodal), each row beside its own rounding. The collective one alone
!> would call a wrong slip small where the bodies are soft together and stiff one by one, as strips
!> are.
module lopin_friction_scaling
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_blas, only : dgetrf, dgetrs
   use lopin_condensed, only : condensed_type
   use lopin_eliminated_normals, only : eliminate_normals
   use lopin_friction_rows, only : friction_points_type, form_equations, no_deformation
   use lopin_friction_step, only : trial_type, work_type
   implicit none
   private
   public :: scale_tangents, fits, noise_of

   !> Digits that a sum of terms loses, beside the sum of their magnitudes.
   real(wp), parameter :: rounding = 1.0e-14_wp
   !> Rounding beyond this share of the largest force hides what the certificate asks for.
   real(wp), parameter :: most_rounding = 1.0e-7_wp
   !> What is left of a compliance below this share of it is rounding.
   real(wp), parameter :: no_digits = 1.0e-12_wp

contains

   !> c_t of all tangential rows: one over the collective compliance of the closed points while
   !> their normal rows stay closed, c_t = 1/lambda_max(S_tt - S_tn S_nn^-1 S_nt). Its diagonal
   !> scales the points one by one. Without the normal rows a strip would bend freely. If told, a
   !> multiple of one over the mean nodal compliance.
   subroutine scale_tangents(self, work)
      type(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      integer, parameter :: powers = 8
      logical :: wanted(self%nrow)
      real(wp), allocatable :: v(:), held(:, :)
      integer, allocatable :: t(:)
      integer :: i
      real(wp) :: size_

      wanted = work%equations%group == 0
      if (work%controls%scaling > 0.0_wp) then
         where (wanted) work%equations%c = work%controls%scaling*count(wanted) &
            & /sum([(self%s(i, i), i=1, self%nrow)], mask=wanted)
         return
      end if
      wanted = work%equations%closed
      if (.not. any(wanted .and. work%equations%group == 0)) wanted = .true.
      t = pack([(i, i=1, self%nrow)], wanted .and. work%equations%group == 0)
      if (size(t) == 0) return
      call take_normals(self, work, pack([(i, i=1, self%nrow)], wanted &
         & .and. work%equations%group > 0), t, held)
      do i = 1, size(t)
         if (work%equations%extra(t(i)) > 0.0_wp) cycle
         if (held(i, i) > no_digits*self%s(t(i), t(i))) work%nodal(t(i)) = 1.0_wp/held(i, i)
      end do
      ! Rows move together; the rest keeps the vector off every symmetry.
      v = [(1.0_wp + 0.25_wp*modulo(0.618_wp*i, 1.0_wp), i=1, size(t))]
      size_ = 0.0_wp
      do i = 1, powers
         v = matmul(held, v/norm2(v))
         size_ = norm2(v)
         if (.not. size_ > 0.0_wp) exit
      end do
      if (size_ > 0.0_wp) then
         where (work%equations%group == 0) work%equations%c = 1.0_wp/size_
      else
         where (work%equations%group == 0) work%equations%c = maxval(work%nodal(t))
      end if
      ! Rows that nothing deforms keep the same pivot whatever the scaling.
      where (work%equations%group == 0 .and. work%equations%extra > 0.0_wp) &
         & work%equations%extra = no_deformation/work%equations%c
   end subroutine scale_tangents

   !> What is left of the compliance of rows t where normal rows n stay closed; motions that float
   !> are held by springs of the rows.
   subroutine take_normals(self, work, n, t, held)
      type(condensed_type), intent(inout) :: self
      type(work_type), intent(in) :: work
      integer, intent(in) :: n(:), t(:)
      real(wp), allocatable, intent(out) :: held(:, :)   !! (size(t), size(t)) [length/force]
      real(wp), allocatable :: a(:, :), across(:, :)
      integer :: pivot(self%nq), i, m, status

      m = size(t)
      if (size(n) + self%nq == 0) then
         held = self%s(t, t)
         return
      end if
      call eliminate_normals(self%eliminated, self%s, self%c, n, t, work%equations%compliance(n) &
         & + work%equations%extra(n))
      if (.not. self%eliminated%regular) then
         held = self%s(t, t)
         call take_together(self, work, n, t, held)
         return
      end if
      associate (h => self%eliminated%h)
         if (self%nq > 0) then
            a = h(m + 1:, m + 1:)
            do i = 1, self%nq
               a(i, i) = a(i, i) - max(sum(self%c(:, i)**2*work%nodal), tiny(1.0_wp))
            end do
            across = h(m + 1:, :m)
            call dgetrf(self%nq, self%nq, a, self%nq, pivot, status)
            if (status /= 0) then
               held = self%s(t, t)
               return
            end if
            call dgetrs('N', self%nq, m, a, self%nq, pivot, across, self%nq, status)
            held = h(:m, :m) - matmul(h(:m, m + 1:), across)
         else
            held = h(:m, :m)
         end if
      end associate
   end subroutine take_normals

   !> The same by one system of normal rows and motions: where some of those rows depend on each
   !> other, or are not deformed.
   subroutine take_together(self, work, n, t, held)
      type(condensed_type), intent(in) :: self
      type(work_type), intent(in) :: work
      integer, intent(in) :: n(:), t(:)
      real(wp), intent(inout) :: held(:, :)
      real(wp), allocatable :: a(:, :), b(:, :), solved(:, :)
      integer, allocatable :: pivot(:)
      integer :: i, m, order, status

      m = size(n)
      order = m + self%nq
      if (order == 0) return
      allocate (a(order, order), b(order, size(t)), source=0.0_wp)
      allocate (pivot(order))
      a(:m, :m) = self%s(n, n)
      a(:m, m + 1:) = self%c(n, :)
      a(m + 1:, :m) = transpose(self%c(n, :))
      do i = 1, m
         a(i, i) = a(i, i) + work%equations%compliance(n(i)) + work%equations%extra(n(i))
      end do
      do i = 1, self%nq
         a(m + i, m + i) = -max(sum(self%c(:, i)**2*work%nodal), tiny(1.0_wp))
      end do
      b(:m, :) = self%s(n, t)
      b(m + 1:, :) = transpose(self%c(t, :))
      solved = b
      call dgetrf(order, order, a, order, pivot, status)
      if (status /= 0) return
      call dgetrs('N', order, size(t), a, order, pivot, solved, order, status)
      held = held - matmul(transpose(b), solved)
   end subroutine take_together

   !> Every row fits: below `limit` of the largest force, or below what rounding of its gap makes.
   !> The bounds of friction are those in force.
   logical function fits(self, points, work, x, limit)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      real(wp), intent(in) :: limit
      real(wp) :: collective(self%nrow), noise(self%nrow), size_
      integer :: i

      size_ = largest(x%force)
      collective = work%equations%c
      work%equations%c = work%nodal
      call form_equations(work%equations, self, points, x%force, x%gap)
      fits = all(abs(work%equations%residual) <= limit*size_ + most_noise(self, work, x) &
         & *work%nodal)
      if (fits) then
         ! A body that has flown away leaves no digits to tell by.
         noise = min(noise_of(self, work, x)*work%nodal, most_rounding*size_)
         fits = all(abs(work%equations%residual) <= limit*size_ + noise)
      end if
      work%equations%c = collective
      call form_equations(work%equations, self, points, x%force, x%gap)
      do i = 1, self%nq
         fits = fits .and. work%q_scale(i)*abs(dot_product(x%force, self%c(:, i)) &
            & + work%moving(i)) <= limit*size_ + rounding*work%q_scale(i)*(dot_product( &
            & abs(x%force), abs(self%c(:, i))) + abs(work%moving(i)))
      end do
   end function fits

   !> A bound of `noise_of` for all rows, at a fraction of its cost [length].
   pure real(wp) function most_noise(self, work, x) result(noise)
      type(condensed_type), intent(in) :: self
      type(work_type), intent(in) :: work
      type(trial_type), intent(in) :: x
      real(wp) :: softest
      integer :: i, q

      ! A positive matrix has its largest entry on its diagonal.
      softest = maxval([0.0_wp, (self%s(i, i), i=1, self%nrow)])
      noise = largest(work%free_gap) + softest*sum(abs(x%force))
      do q = 1, self%nq
         noise = noise + largest(self%c(:, q))*abs(x%q(q))
      end do
      noise = 1.1_wp*rounding*noise
   end function most_noise

   !> What rounding makes of each gap, from the terms of its sum [length].
   function noise_of(self, work, x) result(noise)
      type(condensed_type), intent(in) :: self
      type(work_type), intent(in) :: work
      type(trial_type), intent(in) :: x
      real(wp) :: noise(self%nrow)
      integer :: i, q

      noise = abs(work%free_gap)
      do i = 1, self%nrow
         if (abs(x%force(i)) > 0.0_wp) noise = noise + abs(self%s(:, i)*x%force(i))
      end do
      do q = 1, self%nq
         noise = noise + abs(self%c(:, q)*x%q(q))
      end do
      noise = rounding*noise
   end function noise_of
end module lopin_friction_scaling
