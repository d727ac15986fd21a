!> The compliance of contact along its faces while the rows across them stay closed.
!>
!> Closed rows of contact with friction, N across the faces and T along them, and motions q:
!>
!>    (S_NN + D) l_N + S_NT l_T + C_N q = r_N.
!>
!> With B = [S_NT, C_N] and F F^T = S_NN + D what is left is h = [S_TT, C_T; C_T^T, 0]
!> - B^T (F F^T)^-1 B. It depends on which rows are closed alone, not on stick and slip: Newton
!> factorises rows along the faces only, half of all rows in the plane, two thirds in space, and
!> nothing else until rows close or open.
module lopin_eliminated_normals
   use lopin_kinds, only : wp
   use lopin_blas, only : dsyrk, dtrsm
   use lopin_dense, only : cholesky, lower_solve
   implicit none
   private
   public :: eliminated_type, eliminate_normals

   type :: eliminated_type
      logical :: regular = .false.             !! rows across the faces do not depend on each other
      integer, allocatable :: normal(:), tangent(:)   !! closed rows
      real(wp), allocatable :: give(:)         !! (normals) D [length/force]
      real(wp), allocatable :: factor(:, :)    !! F
      real(wp), allocatable :: follow(:, :)    !! (tangents + nq, normals) ((F F^T)^-1 B)^T
      real(wp), allocatable :: h(:, :)         !! (tangents + nq)^2
      real(wp), allocatable :: most(:)         !! (tangents) largest entry of a column of S
   end type eliminated_type

   !> Pivots below this share of the largest compliance cost half of the digits.
   real(wp), parameter :: small = 1.0e-8_wp

contains

   !> Eliminate closed rows across the faces; nothing is done again for the rows of last time.
   subroutine eliminate_normals(self, s, c, normal, tangent, give)
      type(eliminated_type), intent(inout) :: self
      real(wp), intent(in) :: s(:, :)          !! (nrow, nrow) compliance
      real(wp), intent(in) :: c(:, :)          !! (nrow, nq)
      integer, intent(in) :: normal(:), tangent(:)   !! closed rows
      real(wp), intent(in) :: give(:)          !! (normals) D [length/force]
      real(wp), allocatable :: v(:, :)
      integer :: i, m, n

      if (is_of(self, normal, tangent, give)) return
      n = size(normal)
      m = size(tangent) + size(c, 2)
      self%normal = normal
      self%tangent = tangent
      self%give = give
      call factorise(self, s)
      if (.not. self%regular) return
      allocate (v(n, m))
      v(:, :size(tangent)) = s(normal, tangent)
      v(:, size(tangent) + 1:) = c(normal, :)
      call lower_solve(self%factor, v)
      call form_rest(self, s, c, v)
      if (m > 0 .and. n > 0) call dtrsm('L', 'L', 'T', 'N', n, m, 1.0_wp, self%factor, n, v, n)
      self%follow = transpose(v)
      self%most = [(max(maxval(abs(s(normal, tangent(i)))), maxval(abs(s(tangent, tangent(i))))), &
         & i=1, size(tangent))]
   end subroutine eliminate_normals

   !> F of the closed rows across the faces, if no pivot is small beside the others: a row that
   !> nothing deforms is better taken together with the motions that it holds.
   subroutine factorise(self, s)
      type(eliminated_type), intent(inout) :: self
      real(wp), intent(in) :: s(:, :)
      real(wp) :: most
      integer :: i, n, status

      n = size(self%normal)
      self%factor = s(self%normal, self%normal)
      do i = 1, n
         self%factor(i, i) = self%factor(i, i) + self%give(i)
      end do
      most = maxval([0.0_wp, (self%factor(i, i), i=1, n)])
      call cholesky(self%factor, status)
      self%regular = status == 0
      if (.not. self%regular) return
      self%regular = all([(self%factor(i, i)**2 > small*most, i=1, n)])
   end subroutine factorise

   !> What is left of the compliance of the tangential rows and of the motions.
   subroutine form_rest(self, s, c, v)
      type(eliminated_type), intent(inout) :: self
      real(wp), intent(in) :: s(:, :), c(:, :)
      real(wp), contiguous, intent(in) :: v(:, :)   !! F^-1 B
      integer :: i, m, t

      t = size(self%tangent)
      m = size(v, 2)
      if (allocated(self%h)) deallocate (self%h)
      allocate (self%h(m, m), source=0.0_wp)
      self%h(:t, :t) = s(self%tangent, self%tangent)
      self%h(t + 1:, :t) = transpose(c(self%tangent, :))
      if (size(v) > 0) call dsyrk('L', 'T', m, size(v, 1), -1.0_wp, v, size(v, 1), 1.0_wp, self%h, &
         & m)
      do i = 1, m
         self%h(i, i + 1:) = self%h(i + 1:, i)
      end do
   end subroutine form_rest

   !> The same rows as last time.
   pure logical function is_of(self, normal, tangent, give)
      type(eliminated_type), intent(in) :: self
      integer, intent(in) :: normal(:), tangent(:)
      real(wp), intent(in) :: give(:)

      is_of = allocated(self%normal)
      if (is_of) is_of = size(self%normal) == size(normal) .and. size(self%tangent) == size(tangent)
      if (is_of) is_of = all(self%normal == normal) .and. all(self%tangent == tangent)
      if (is_of) is_of = .not. any(abs(self%give - give) > 0.0_wp)
   end function is_of
end module lopin_eliminated_normals
