!> Convex polygons in a plane and what two of them share.
!>
!> The overlap remembers the two lines that meet in each of its vertices, so that its motion can be
!> told from the motion of the polygons (see `vertex_slopes`). Sutherland and Hodgman (1974): one
!> polygon is cut by the lines of the other; a vertex within the tolerance of a line is on it and
!> is never cut twice.
module lopin_polygon
   use lopin_kinds, only : wp
   implicit none
   private
   public :: polygon_type, common_type, most_vertices, most_corners
   public :: polygon_area, common_part, vertex_slopes

   integer, parameter :: most_corners = 4
   integer, parameter :: most_vertices = 12   !! 8 in exact arithmetic

   !> Corners in counterclockwise order; line k runs from corner k to the next.
   type :: polygon_type
      integer :: n = 0
      integer :: vertex(most_corners) = 0          !! where the corner comes from, for the caller
      real(wp) :: y(2, most_corners) = 0.0_wp      !! [length]
   end type polygon_type

   !> Lines 1..a%n are those of the first polygon, a%n + 1.. those of the second.
   type :: common_type
      integer :: n = 0
      real(wp) :: area = 0.0_wp                    !! [length^2]
      real(wp) :: y(2, most_vertices) = 0.0_wp     !! [length]
      integer :: line(2, most_vertices) = 0        !! the two lines through each vertex
      integer :: out(most_vertices) = 0            !! the line along which the border goes on
   end type common_type

contains

   !> Positive if the order is counterclockwise.
   pure real(wp) function polygon_area(y) result(area)
      real(wp), intent(in) :: y(:, :)      !! (2, n) [length]
      real(wp) :: a(2), b(2)
      integer :: k

      area = 0.0_wp
      do k = 2, size(y, 2) - 1
         a = y(:, k) - y(:, 1)
         b = y(:, k + 1) - y(:, 1)
         area = area + 0.5_wp*(a(1)*b(2) - a(2)*b(1))
      end do
   end function polygon_area

   !> The common part of two convex polygons; n = 0 if there is none.
   pure subroutine common_part(a, b, tolerance, c)
      type(polygon_type), intent(in) :: a, b
      real(wp), intent(in) :: tolerance        !! a point this near to a line is on it [length]
      type(common_type), intent(out) :: c
      integer :: k

      if (any(maxval(a%y(:, :a%n), dim=2) <= minval(b%y(:, :b%n), dim=2) + tolerance)) return
      if (any(maxval(b%y(:, :b%n), dim=2) <= minval(a%y(:, :a%n), dim=2) + tolerance)) return
      c%n = a%n
      c%y(:, :a%n) = a%y(:, :a%n)
      do k = 1, a%n
         c%line(:, k) = [1 + modulo(k - 2, a%n), k]
         c%out(k) = k
      end do
      do k = 1, b%n
         call cut(a%n, b, k, tolerance, c)
         if (c%n < 3) exit
      end do
      if (c%n < 3) c%n = 0
      c%area = polygon_area(c%y(:, :c%n))
   end subroutine common_part

   !> Keep what is to the left of a line of b.
   pure subroutine cut(offset, b, k, tolerance, c)
      integer, intent(in) :: offset            !! number of lines before those of b
      type(polygon_type), intent(in) :: b
      integer, intent(in) :: k                 !! the line
      real(wp), intent(in) :: tolerance
      type(common_type), intent(inout) :: c
      type(common_type) :: kept
      real(wp) :: t(2), s(most_vertices)
      integer :: i, next

      t = b%y(:, 1 + mod(k, b%n)) - b%y(:, k)
      t = t/norm2(t)
      do i = 1, c%n
         s(i) = t(1)*(c%y(2, i) - b%y(2, k)) - t(2)*(c%y(1, i) - b%y(1, k))
      end do
      if (all(s(:c%n) >= -tolerance)) return
      kept%n = 0
      do i = 1, c%n
         next = 1 + mod(i, c%n)
         if (s(i) >= -tolerance) then
            call append(kept, c%y(:, i), c%line(:, i), c%out(i))
            if (s(next) >= -tolerance) cycle
            if (s(i) > tolerance) then
               call append(kept, crossing(i, next), [c%out(i), offset + k], offset + k)
            else
               kept%out(kept%n) = offset + k
            end if
         else if (s(next) > tolerance) then
            call append(kept, crossing(i, next), [offset + k, c%out(i)], c%out(i))
         end if
      end do
      c = kept

   contains

      !> Where the border from i to j meets the line; a corner of b is taken as it is.
      pure function crossing(i, j) result(y)
         integer, intent(in) :: i, j
         real(wp) :: y(2)
         integer :: other

         y = c%y(:, i) + s(i)/(s(i) - s(j))*(c%y(:, j) - c%y(:, i))
         other = c%out(i) - offset
         if (other <= 0) return
         if (k == 1 + mod(other, b%n)) y = b%y(:, k)
         if (other == 1 + mod(k, b%n)) y = b%y(:, other)
      end function crossing
   end subroutine cut

   pure subroutine append(c, y, line, out)
      type(common_type), intent(inout) :: c
      real(wp), intent(in) :: y(2)
      integer, intent(in) :: line(2), out

      if (c%n == most_vertices) return
      c%n = c%n + 1
      c%y(:, c%n) = y
      c%line(:, c%n) = line
      c%out(c%n) = out
   end subroutine append

   !> How a vertex of the overlap follows the ends of its two lines: dy = sum by_end(:, :, k) dp_k.
   !>
   !> A corner of one of the polygons is itself an end. Lines that are nearly parallel give the
   !> motion of the first alone: there the overlap has no derivative.
   pure subroutine vertex_slopes(a, b, c, i, end, by_end)
      type(polygon_type), intent(in) :: a, b
      type(common_type), intent(in) :: c
      integer, intent(in) :: i                     !! vertex of c
      integer, intent(out) :: end(4)               !! corners: of a, and a%n + those of b; 0: unused
      real(wp), intent(out) :: by_end(2, 2, 4)
      real(wp) :: p(2, 4), normal(2, 2), t(2), across(2, 2), det, e(2)
      integer :: k

      by_end = 0.0_wp
      end = 0
      do k = 1, 2
         call ends_of(a%n, b%n, c%line(k, i), end(2*k - 1:2*k))
      end do
      do k = 1, 4
         if (count(end == end(k)) < 2) cycle
         end = [end(k), 0, 0, 0]
         by_end(:, :, 1) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
         return
      end do
      do k = 1, 4
         if (end(k) <= a%n) p(:, k) = a%y(:, end(k))
         if (end(k) > a%n) p(:, k) = b%y(:, end(k) - a%n)
      end do
      do k = 1, 2
         e = p(:, 2*k) - p(:, 2*k - 1)
         t(k) = dot_product(c%y(:, i) - p(:, 2*k - 1), e)/dot_product(e, e)
         normal(:, k) = [-e(2), e(1)]/norm2(e)
      end do
      det = normal(1, 1)*normal(2, 2) - normal(2, 1)*normal(1, 2)
      if (abs(det) < 1.0e-9_wp) then
         by_end(1, 1, 1:2) = [1.0_wp - t(1), t(1)]
         by_end(2, 2, 1:2) = by_end(1, 1, 1:2)
         return
      end if
      across(:, 1) = [normal(2, 2), -normal(1, 2)]/det
      across(:, 2) = [-normal(2, 1), normal(1, 1)]/det
      do k = 1, 2
         e = [1.0_wp - t(k), t(k)]
         by_end(:, 1, 2*k - 1) = across(:, k)*normal(1, k)*e(1)
         by_end(:, 2, 2*k - 1) = across(:, k)*normal(2, k)*e(1)
         by_end(:, 1, 2*k) = across(:, k)*normal(1, k)*e(2)
         by_end(:, 2, 2*k) = across(:, k)*normal(2, k)*e(2)
      end do
   end subroutine vertex_slopes

   pure subroutine ends_of(na, nb, line, end)
      integer, intent(in) :: na, nb, line
      integer, intent(out) :: end(2)

      if (line <= na) then
         end = [line, 1 + mod(line, na)]
      else
         end = [line, na + 1 + mod(line - na, nb)]
      end if
   end subroutine ends_of
end module lopin_polygon
