!> How near an element is to folding: the scaled Jacobian at its corners.
!>
!> At a corner it is the determinant of the unit vectors along the edges that meet there: 1 at a
!> right corner, the sine of the angle in 2D, 0 where the corner is flat, negative where it is
!> folded. It is lost at a corner before the determinant is lost at a Gauss point. Edges with a node
!> amid them leave along their tangents.
module lopin_corner_shape
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   implicit none
   private
   public :: corners_type, new_corners, worst_corner, turns_over, shortest_side

   !> The corners of a cell and what leaves them.
   type :: corners_type
      integer :: ndim = 0
      integer :: n = 0                          !! corners; 0: a line
      integer :: end(3, 8) = 0                  !! (ndim, n) other ends of the edges of each corner
      integer :: middle(3, 8) = 0               !! (ndim, n) nodes amid these edges; 0: none
      real(wp) :: sense(8) = 1.0_wp             !! (n) sign of the determinant in the reference cell
   end type corners_type

   interface worst_corner
      procedure worst_of_cell, worst_of_corners
   end interface worst_corner

contains

   !> The edges that leave each corner, in the order of the cell's list.
   pure subroutine new_corners(self, cell)
      type(corners_type), intent(out) :: self
      type(cell_type), intent(in) :: cell
      integer :: a, k, m

      if (cell%ndim < 2) return
      self%ndim = cell%ndim
      self%n = cell%ncorner
      do a = 1, self%n
         m = 0
         do k = 1, size(cell%edge, 2)
            if (.not. any(cell%edge(:, k) == a) .or. m == cell%ndim) cycle
            m = m + 1
            self%end(m, a) = sum(cell%edge(:, k)) - a
            if (cell%quadratic) self%middle(m, a) = cell%ncorner + k
         end do
         self%sense(a) = sign(1.0_wp, at_corner(self, a, cell%xi(:cell%ndim, :)))
      end do
   end subroutine new_corners

   !> The least scaled Jacobian of a cell, in [-1, 1], and its corner; lines have 1.
   pure subroutine worst_of_cell(cell, x, value, corner)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      real(wp), intent(out) :: value
      integer, intent(out) :: corner
      type(corners_type) :: corners

      call new_corners(corners, cell)
      call worst_of_corners(corners, x, value, corner)
   end subroutine worst_of_cell

   !> The same where the corners of the cell are known.
   pure subroutine worst_of_corners(self, x, value, corner)
      type(corners_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      real(wp), intent(out) :: value
      integer, intent(out) :: corner
      real(wp) :: here
      integer :: a

      value = 1.0_wp
      corner = 1
      do a = 1, self%n
         here = at_corner(self, a, x)*self%sense(a)
         if (.not. here < value) cycle
         value = here
         corner = a
      end do
   end subroutine worst_of_corners

   !> Some corner of a cell is inside out, by the sign alone.
   pure logical function turns_over(self, x)
      type(corners_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      real(wp) :: one(2), other(2)
      integer :: a

      turns_over = .true.
      do a = 1, self%n
         if (self%ndim == 2 .and. self%middle(1, a) == 0) then
            one = x(:2, self%end(1, a)) - x(:2, a)
            other = x(:2, self%end(2, a)) - x(:2, a)
            if ((one(1)*other(2) - one(2)*other(1))*self%sense(a) < 0.0_wp) return
         else
            if (at_corner(self, a, x)*self%sense(a) < 0.0_wp) return
         end if
      end do
      turns_over = .false.
   end function turns_over

   !> Shortest edge as it leaves a corner, along its tangent where a node is amid it; without
   !> corners a number whose square can be told.
   pure real(wp) function shortest_side(self, x) result(shortest)
      type(corners_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      integer :: a, m

      shortest = sqrt(huge(1.0_wp))
      do a = 1, self%n
         do m = 1, self%ndim
            associate (p => x(:self%ndim, a), q => x(:self%ndim, self%end(m, a)))
               if (self%middle(m, a) > 0) then
                  shortest = min(shortest, norm2(4.0_wp*x(:self%ndim, self%middle(m, a)) &
                     & - 3.0_wp*p - q))
               else
                  shortest = min(shortest, norm2(q - p))
               end if
            end associate
         end do
      end do
   end function shortest_side

   !> Determinant of the unit edges that leave a corner; an edge without length counts as flat.
   pure real(wp) function at_corner(self, a, x) result(value)
      type(corners_type), intent(in) :: self
      integer, intent(in) :: a
      real(wp), intent(in) :: x(:, :)
      real(wp) :: e(3, 3), volume
      integer :: k, m

      e = 0.0_wp
      e(3, 3) = 1.0_wp
      volume = 1.0_wp
      do m = 1, self%ndim
         do k = 1, self%ndim
            e(k, m) = x(k, self%end(m, a)) - x(k, a)
            if (self%middle(m, a) > 0) e(k, m) = 4.0_wp*x(k, self%middle(m, a)) - 3.0_wp*x(k, a) &
               & - x(k, self%end(m, a))
         end do
         volume = volume*sqrt(e(1, m)**2 + e(2, m)**2 + e(3, m)**2)
      end do
      value = 0.0_wp
      if (.not. volume > 0.0_wp) return
      value = e(1, 1)*(e(2, 2)*e(3, 3) - e(3, 2)*e(2, 3)) &
         & + e(2, 1)*(e(3, 2)*e(1, 3) - e(1, 2)*e(3, 3)) &
         & + e(3, 1)*(e(1, 2)*e(2, 3) - e(2, 2)*e(1, 3))
      value = value/volume
   end function at_corner
end module lopin_corner_shape
