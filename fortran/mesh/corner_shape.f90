!> How near an element is to folding: the scaled Jacobian at its corners.
!>
!> At a corner it is the determinant of the unit vectors along the edges that meet there: 1 at a
!> right corner, the sine of the angle in 2D, 0 where the corner is flat, negative where it is
!> folded. It is lost at a corner before the determinant is lost at a Gauss point.
module lopin_corner_shape
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_type
   implicit none
   private
   public :: worst_corner

contains

   !> The least scaled Jacobian of a cell, in [-1, 1], and its corner; lines have 1.
   pure subroutine worst_corner(cell, x, value, corner)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)        !! (ndim, >= ncorner) coordinates [length]
      real(wp), intent(out) :: value
      integer, intent(out) :: corner
      real(wp) :: here
      integer :: a

      value = 1.0_wp
      corner = 1
      if (cell%ndim < 2) return
      do a = 1, cell%ncorner
         here = at_corner(cell, a, x)*sign(1.0_wp, at_corner(cell, a, cell%xi(:cell%ndim, :)))
         if (.not. here < value) cycle
         value = here
         corner = a
      end do
   end subroutine worst_corner

   !> Determinant of the unit edges that leave a corner, in the order of the cell's list; an edge
   !> without length counts as flat.
   pure real(wp) function at_corner(cell, a, x) result(value)
      type(cell_type), intent(in) :: cell
      integer, intent(in) :: a
      real(wp), intent(in) :: x(:, :)
      real(wp) :: e(3, 3), long
      integer :: k, n

      value = 0.0_wp
      e = 0.0_wp
      n = 0
      do k = 1, size(cell%edge, 2)
         if (.not. any(cell%edge(:, k) == a) .or. n == cell%ndim) cycle
         n = n + 1
         e(:cell%ndim, n) = x(:cell%ndim, sum(cell%edge(:, k)) - a) - x(:cell%ndim, a)
         long = norm2(e(:, n))
         if (.not. long > 0.0_wp) return
         e(:, n) = e(:, n)/long
      end do
      if (cell%ndim == 2) e(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
      value = dot_product(e(:, 1), cross(e(:, 2), e(:, 3)))
   end function at_corner
end module lopin_corner_shape
