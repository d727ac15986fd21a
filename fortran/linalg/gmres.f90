!> Restart-free GMRES with a preconditioner on the right (Saad and Schultz 1986), its results kept
!> (flexible, Saad 1993): no application more at the end, and the rounding of a factor of single
!> precision does not matter.
!>
!> The residual that is minimised is the true one, so that a rough preconditioner costs products,
!> never accuracy.
module lopin_gmres
   use lopin_kinds, only : wp
   use lopin_blas, only : dgemv
   implicit none
   private
   public :: operator_type, gmres

   !> A vector that keeps this much of its length is orthogonal to rounding.
   real(wp), parameter :: little = 0.5_wp

   !> A matrix by what it does, with a cheap approximate inverse.
   type, abstract :: operator_type
   contains
      procedure(apply_if), deferred :: multiply       !! y = A x
      procedure(apply_if), deferred :: precondition   !! y ~ A^-1 x
   end type operator_type

   abstract interface
      subroutine apply_if(self, x, y)
         import :: operator_type, wp
         class(operator_type), intent(inout) :: self
         real(wp), intent(in) :: x(:)
         real(wp), intent(out) :: y(:)
      end subroutine apply_if
   end interface

contains

   !> Solve A x = b from x = 0 until |b - A x| <= tolerance |b|.
   subroutine gmres(a, b, tolerance, most, x, iterations, ratio)
      class(operator_type), intent(inout) :: a
      real(wp), intent(in) :: b(:)
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: most              !! iterations at most
      real(wp), intent(out) :: x(:)
      integer, intent(out) :: iterations
      real(wp), intent(out) :: ratio           !! |b - A x|/|b| reached, as the recurrence has it
      real(wp), allocatable :: v(:, :), z(:, :), h(:, :), g(:), c(:), s(:)
      real(wp) :: start, swap
      integer :: i, j

      iterations = 0
      x = 0.0_wp
      ratio = 0.0_wp
      start = norm2(b)
      if (.not. start > 0.0_wp) then
         ! Zero solves it, unless b is no number: then nothing does, and nor is the ratio one.
         ratio = start
         return
      end if
      allocate (v(size(b), most + 1), z(size(b), most), h(most + 1, most))
      allocate (g(most + 1), c(most), s(most))
      g = 0.0_wp
      g(1) = start
      v(:, 1) = b/start
      ratio = 1.0_wp
      do j = 1, most
         call a%precondition(v(:, j), z(:, j))
         call a%multiply(z(:, j), v(:, j + 1))
         call make_orthogonal(size(b), j, v, v(:, j + 1), h(:, j))
         if (h(j + 1, j) > 0.0_wp) v(:, j + 1) = v(:, j + 1)/h(j + 1, j)
         do i = 1, j - 1
            swap = c(i)*h(i, j) + s(i)*h(i + 1, j)
            h(i + 1, j) = c(i)*h(i + 1, j) - s(i)*h(i, j)
            h(i, j) = swap
         end do
         swap = hypot(h(j, j), h(j + 1, j))
         if (.not. swap > 0.0_wp) exit
         c(j) = h(j, j)/swap
         s(j) = h(j + 1, j)/swap
         h(j, j) = swap
         g(j + 1) = -s(j)*g(j)
         g(j) = c(j)*g(j)
         iterations = j
         ratio = abs(g(j + 1))/start
         if (.not. ratio > tolerance) exit
      end do
      call combine(iterations, h, g, z, x)
   end subroutine gmres

   !> Take from w what lies along the basis: h are its parts, and the length of what is left. Twice
   !> is enough (Kahan), and once where little was taken (Daniel et al. 1976).
   subroutine make_orthogonal(n, j, v, w, h)
      integer, intent(in) :: n, j
      real(wp), intent(in) :: v(n, j)          !! orthonormal
      real(wp), intent(inout) :: w(n)
      real(wp), intent(out) :: h(j + 1)
      real(wp) :: part(j), before
      integer :: pass

      h(:j) = 0.0_wp
      h(j + 1) = sqrt(dot_product(w, w))
      do pass = 1, 2
         before = h(j + 1)
         call dgemv('T', n, j, 1.0_wp, v, n, w, 1, 0.0_wp, part, 1)
         call dgemv('N', n, j, -1.0_wp, v, n, part, 1, 1.0_wp, w, 1)
         h(:j) = h(:j) + part
         h(j + 1) = sqrt(dot_product(w, w))
         if (h(j + 1) > little*before) exit
      end do
   end subroutine make_orthogonal

   !> The combination of vectors that the triangular system gives.
   pure subroutine combine(n, h, g, z, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: h(:, :), g(:), z(:, :)
      real(wp), intent(out) :: x(:)
      real(wp) :: y(n)
      integer :: i

      x = 0.0_wp
      do i = n, 1, -1
         y(i) = (g(i) - dot_product(h(i, i + 1:n), y(i + 1:n)))/h(i, i)
      end do
      do i = 1, n
         x = x + y(i)*z(:, i)
      end do
   end subroutine combine
end module lopin_gmres
