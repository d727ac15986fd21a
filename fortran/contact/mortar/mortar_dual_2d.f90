!> Dual functions and areas of one slave facet in the plane, in dual numbers.
module lopin_mortar_dual_2d
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, operator(+), operator(-), operator(*), operator(/), &
      & assignment(=)
   use lopin_mortar_cells_2d, only : line_shape
   implicit none
   private
   public :: transform, whole, dual_function

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Integrals of line3 in the transformed basis.
   subroutine transform(share, me, d)
      real(wp), intent(in) :: share
      type(dual_type), intent(inout) :: me(3, 3), d(3)
      real(wp) :: inner
      integer :: k

      if (.not. share > 0.0_wp) return
      inner = 1.0_wp - 2.0_wp*share
      do k = 1, 2
         d(k) = d(k) + share*d(3)
      end do
      d(3) = inner*d(3)
      do k = 1, 3
         me(1, k) = me(1, k) + share*me(3, k)
         me(2, k) = me(2, k) + share*me(3, k)
         me(3, k) = inner*me(3, k)
      end do
      do k = 1, 3
         me(k, 1) = me(k, 1) + share*me(k, 3)
         me(k, 2) = me(k, 2) + share*me(k, 3)
         me(k, 3) = inner*me(k, 3)
      end do
   end subroutine transform

   !> Area of a whole facet.
   real(wp) function whole(x, axisymmetric, thickness) result(area)
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness
      real(wp), parameter :: at(3) = [-sqrt(0.6_wp), 0.0_wp, sqrt(0.6_wp)]
      real(wp), parameter :: weight(3) = [5.0_wp, 8.0_wp, 5.0_wp]/9.0_wp
      type(dual_type) :: n(3), dn(3)
      real(wp) :: length
      integer :: k

      area = 0.0_wp
      do k = 1, 3
         call line_shape(size(x, 2), constant(at(k)), n, dn)
         length = weight(k)*norm2(matmul(x, dn(:size(x, 2))%v))
         if (axisymmetric) then
            area = area + 2.0_wp*pi*dot_product(x(1, :), n(:size(x, 2))%v)*length
         else
            area = area + thickness*length
         end if
      end do
   end function whole

   !> Add row j of diag(d) me^-1: Gauss elimination of a positive matrix.
   subroutine dual_function(me, d, j, sum_)
      type(dual_type), intent(in) :: me(:, :), d
      integer, intent(in) :: j
      type(dual_type), intent(inout) :: sum_(:)
      type(dual_type) :: m(3, 3), a(3), factor
      integer :: i, k, l, n

      n = size(sum_)
      m(:n, :n) = me
      a(j) = d
      do k = 1, n
         do i = k + 1, n
            factor = m(i, k)/m(k, k)
            do l = k, n
               m(i, l) = m(i, l) - factor*m(k, l)
            end do
            a(i) = a(i) - factor*a(k)
         end do
      end do
      do k = n, 1, -1
         do l = k + 1, n
            a(k) = a(k) - m(k, l)*a(l)
         end do
         a(k) = a(k)/m(k, k)
      end do
      sum_ = sum_ + a(:n)
   end subroutine dual_function
end module lopin_mortar_dual_2d
