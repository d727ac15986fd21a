!> Small dense solves on LAPACK: definite, semi-definite, and bordered by equilibrium conditions.
module lopin_dense
   use lopin_kinds, only : wp
   use lopin_blas, only : dpotrf, dpotrs, dtrsm, dtrsv, dsyev
   implicit none
   private
   public :: cholesky, cholesky_solve, lower_solve, bordered_solve, symmetric_eigen

   interface cholesky_solve
      module procedure cholesky_solve_one, cholesky_solve_many
   end interface cholesky_solve

   !> Eigenvalues below this share of the largest count as zero.
   real(wp), parameter :: rank_tolerance = 1.0e-13_wp

contains

   !> a <- lower Cholesky factor; status > 0 if `a` is not positive definite.
   subroutine cholesky(a, status)
      real(wp), contiguous, intent(inout) :: a(:, :)
      integer, intent(out) :: status

      status = 0
      if (size(a, 1) > 0) call dpotrf('L', size(a, 1), a, size(a, 1), status)
   end subroutine cholesky

   !> x <- (L L^T)^-1 x. Of one column dpotrs would copy the whole triangle into blocks first.
   subroutine cholesky_solve_one(l, x)
      real(wp), contiguous, intent(in) :: l(:, :)
      real(wp), contiguous, intent(inout) :: x(:)

      if (size(x) == 0) return
      call dtrsv('L', 'N', 'N', size(x), l, size(x), x, 1)
      call dtrsv('L', 'T', 'N', size(x), l, size(x), x, 1)
   end subroutine cholesky_solve_one

   subroutine cholesky_solve_many(l, x)
      real(wp), contiguous, intent(in) :: l(:, :)
      real(wp), contiguous, intent(inout) :: x(:, :)
      integer :: n, status

      n = size(x, 1)
      if (size(x) > 0) call dpotrs('L', n, size(x, 2), l, n, x, n, status)
   end subroutine cholesky_solve_many

   !> x <- L^-1 x.
   subroutine lower_solve(l, x)
      real(wp), contiguous, intent(in) :: l(:, :)
      real(wp), contiguous, intent(inout) :: x(:, :)

      if (size(x) > 0) call dtrsm('L', 'L', 'N', 'N', size(x, 1), size(x, 2), 1.0_wp, l, &
         & size(l, 1), x, size(x, 1))
   end subroutine lower_solve

   !> a <- eigenvectors of symmetric `a`, ascending eigenvalues.
   subroutine symmetric_eigen(a, value, status)
      real(wp), contiguous, intent(inout) :: a(:, :)
      real(wp), intent(out) :: value(:)
      integer, intent(out) :: status
      real(wp), allocatable :: work(:)
      integer :: n

      n = size(a, 1)
      status = 0
      if (n == 0) return
      allocate (work(max(1, 34*n)))
      call dsyev('V', 'L', n, a, n, value, work, size(work), status)
   end subroutine symmetric_eigen

   !> Solve S x + C q = f, C^T x - H q = h in the place of f and h; S symmetric, semi-definite, and
   !> H >= 0 (absent: 0).
   !>
   !> Without q this is Cholesky, or, where rows depend on each other, the solution of least norm.
   !> status /= 0: some combination of q is not determined (a body is not held by these rows).
   subroutine bordered_solve(s, c, x, q, dependent, status, held)
      real(wp), contiguous, intent(in) :: s(:, :)   !! (m, m)
      real(wp), intent(in) :: c(:, :)               !! (m, nq)
      real(wp), intent(inout) :: x(:)               !! (m) f, then x
      real(wp), intent(inout) :: q(:)               !! (nq) h, then q
      integer, intent(inout) :: dependent   !! rows found to depend on others: largest count so far
      integer, intent(out) :: status
      real(wp), intent(in), optional :: held(:, :)  !! (nq, nq)
      real(wp), allocatable :: a(:, :), right(:), scale(:), value(:)
      integer :: m, nq, i, nzero

      m = size(x)
      nq = size(q)
      status = 0
      if (m + nq == 0) return
      if (nq == 0) then
         a = s
         call cholesky(a, status)
         if (status == 0 .and. well_pivoted(a, s)) then
            call cholesky_solve(a, x)
            return
         end if
         deallocate (a)
      end if
      allocate (a(m + nq, m + nq), right(m + nq), scale(m + nq), value(m + nq))
      a(:m, :m) = s
      a(:m, m + 1:) = c
      a(m + 1:, :m) = transpose(c)
      a(m + 1:, m + 1:) = 0.0_wp
      if (present(held)) a(m + 1:, m + 1:) = -held
      right = [x, q]
      call equilibrate(a, m, scale)
      right = right*scale
      call symmetric_eigen(a, value, status)
      if (status /= 0) return
      nzero = 0
      right = matmul(right, a)
      do i = 1, m + nq
         if (abs(value(i)) > rank_tolerance*maxval(abs(value))) then
            right(i) = right(i)/value(i)
         else
            right(i) = 0.0_wp
            nzero = nzero + 1
            if (nq > 0) then
               if (maxval(abs(a(m + 1:, i))) > 1.0e-6_wp) status = 1
            end if
         end if
      end do
      dependent = max(dependent, nzero)
      right = matmul(a, right)*scale
      x = right(:m)
      q = right(m + 1:)
   end subroutine bordered_solve

   !> No pivot of the factor lost all its digits to the rows before it.
   pure logical function well_pivoted(l, s)
      real(wp), intent(in) :: l(:, :), s(:, :)
      integer :: i

      well_pivoted = .true.
      do i = 1, size(s, 1)
         if (l(i, i)**2 <= rank_tolerance*s(i, i)) well_pivoted = .false.
      end do
   end function well_pivoted

   !> Scale a bordered matrix symmetrically: unit diagonal of S, then columns of C of unit length.
   pure subroutine equilibrate(a, m, scale)
      real(wp), intent(inout) :: a(:, :)
      integer, intent(in) :: m
      real(wp), intent(out) :: scale(:)
      real(wp) :: largest, length
      integer :: i

      largest = 0.0_wp
      do i = 1, m
         largest = max(largest, a(i, i))
      end do
      scale = 1.0_wp
      if (largest > 0.0_wp) then
         do i = 1, m
            scale(i) = 1.0_wp/sqrt(max(a(i, i), 1.0e-3_wp*largest))
         end do
      end if
      do i = m + 1, size(a, 1)
         length = sqrt(sum((a(:m, i)*scale(:m))**2))
         if (length <= 0.0_wp) length = sqrt(max(abs(a(i, i)), tiny(1.0_wp)))
         scale(i) = 1.0_wp/length
      end do
      do i = 1, size(a, 1)
         a(:, i) = a(:, i)*scale*scale(i)
      end do
   end subroutine equilibrate
end module lopin_dense
