!> The closest point of a triangle, and which feature of it that is.
module lopin_triangle
   use lopin_kinds, only : wp
   implicit none
   private
   public :: closest_on_triangle

contains

   !> By the Voronoi regions of corners, edges and inside (Ericson 2005, 5.1.5).
   pure subroutine closest_on_triangle(a, b, c, x, point, feature)
      real(wp), intent(in) :: a(3), b(3), c(3), x(3)   !! [length]
      real(wp), intent(out) :: point(3)                !! [length]
      integer, intent(out) :: feature     !! 0 inside; 1..3 edges ab, bc, ca; 4..6 corners a, b, c
      real(wp) :: ab(3), ac(3), d1, d2, d3, d4, d5, d6, va, vb, vc

      ab = b - a
      ac = c - a
      d1 = dot_product(ab, x - a)
      d2 = dot_product(ac, x - a)
      d3 = dot_product(ab, x - b)
      d4 = dot_product(ac, x - b)
      d5 = dot_product(ab, x - c)
      d6 = dot_product(ac, x - c)
      va = d3*d6 - d5*d4
      vb = d5*d2 - d1*d6
      vc = d1*d4 - d3*d2
      if (d1 <= 0.0_wp .and. d2 <= 0.0_wp) then
         feature = 4
         point = a
      else if (d3 >= 0.0_wp .and. d4 <= d3) then
         feature = 5
         point = b
      else if (d6 >= 0.0_wp .and. d5 <= d6) then
         feature = 6
         point = c
      else if (vc <= 0.0_wp .and. d1 >= 0.0_wp .and. d3 <= 0.0_wp) then
         feature = 1
         point = a + d1/(d1 - d3)*ab
      else if (va <= 0.0_wp .and. d4 - d3 >= 0.0_wp .and. d5 - d6 >= 0.0_wp) then
         feature = 2
         point = b + (d4 - d3)/((d4 - d3) + (d5 - d6))*(c - b)
      else if (vb <= 0.0_wp .and. d2 >= 0.0_wp .and. d6 <= 0.0_wp) then
         feature = 3
         point = a + d2/(d2 - d6)*ac
      else
         feature = 0
         point = a + (vb*ab + vc*ac)/(va + vb + vc)
      end if
   end subroutine closest_on_triangle
end module lopin_triangle
