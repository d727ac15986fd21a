!> Facets as flat convex pieces: what is clipped where faces are warped or curved.
!>
!> A triangle and a quad are one piece, a triangle6 four triangles, a quad8 four quads about its
!> centre (Puso, Laursen, Solberg 2008). Vertices 1..8 are the nodes, vertex 9 is the centre.
module lopin_facet_pieces
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_id
   use lopin_polygon, only : polygon_type, polygon_area
   implicit none
   private
   public :: npiece, piece, ncorner_of_piece, vertex_weights, most_vertex, piece_polygons

   integer, parameter :: most_vertex = 9
   !> How many pieces a facet cell has, by its id.
   integer, parameter :: npiece(6) = [0, 0, 1, 4, 1, 4]
   integer, parameter :: ncorner_of_piece(6) = [0, 0, 3, 3, 4, 4]
   integer, parameter :: one(4, 4) = reshape([1, 2, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], &
      & [4, 4])
   integer, parameter :: four_triangles(4, 4) = reshape([1, 4, 6, 0, 4, 2, 5, 0, 6, 5, 3, 0, &
      & 4, 5, 6, 0], [4, 4])
   integer, parameter :: four_quads(4, 4) = reshape([1, 5, 9, 8, 5, 2, 6, 9, 9, 6, 3, 7, &
      & 8, 9, 7, 4], [4, 4])
   !> Vertices of each piece: (corner, piece, cell id).
   integer, parameter :: piece(4, 4, 6) = reshape([one, one, one, four_triangles, one, &
      & four_quads], [4, 4, 6])

contains

   !> A vertex as a mean of the nodes.
   pure function vertex_weights(cell, vertex) result(weight)
      integer, intent(in) :: cell, vertex
      real(wp) :: weight(8)

      weight = 0.0_wp
      if (vertex <= 8) then
         weight(vertex) = 1.0_wp
      else if (cell == cell_id%quad8) then
         weight = [-0.25_wp, -0.25_wp, -0.25_wp, -0.25_wp, 0.5_wp, 0.5_wp, 0.5_wp, 0.5_wp]
      end if
   end function vertex_weights

   !> The polygons of a piece as seen in a plane: one, or two triangles where it is not convex.
   !>
   !> Corners that coincide count once. What shows its other side gives none.
   pure subroutine piece_polygons(vertex, y, sense, tolerance, polygon, n)
      integer, intent(in) :: vertex(:)          !! 3 or 4 vertices
      real(wp), intent(in) :: y(:, :)           !! (2, all vertices) places in the plane [length]
      integer, intent(in) :: sense              !! 1: counterclockwise wanted, -1: clockwise
      real(wp), intent(in) :: tolerance         !! of a length [length]
      type(polygon_type), intent(out) :: polygon(2)
      integer, intent(out) :: n
      integer :: corner(4), m, k, previous, next

      n = 0
      m = 0
      do k = 1, size(vertex)
         previous = vertex(1 + modulo(k - 2, size(vertex)))
         if (norm2(y(:, vertex(k)) - y(:, previous)) <= tolerance) cycle
         m = m + 1
         corner(m) = vertex(k)
      end do
      if (m < 3) return
      if (sense < 0) corner(:m) = corner(m:1:-1)
      if (polygon_area(y(:, corner(:m))) <= tolerance**2) return
      do k = 1, m
         previous = 1 + modulo(k - 2, m)
         next = 1 + mod(k, m)
         if (polygon_area(y(:, corner([previous, k, next]))) > 0.0_wp .or. m == 3) cycle
         call add([corner(k), corner(next), corner(1 + mod(next, m))], y, tolerance**2, polygon, n)
         call add([corner(k), corner(1 + mod(next, m)), corner(previous)], &
            & y, tolerance**2, polygon, n)
         return
      end do
      call add(corner(:m), y, tolerance**2, polygon, n)
   end subroutine piece_polygons

   !> One more polygon, unless it has no area.
   pure subroutine add(chosen, y, least, polygon, n)
      integer, intent(in) :: chosen(:)
      real(wp), intent(in) :: y(:, :)
      real(wp), intent(in) :: least             !! [length^2]
      type(polygon_type), intent(inout) :: polygon(2)
      integer, intent(inout) :: n

      if (polygon_area(y(:, chosen)) <= least) return
      n = n + 1
      polygon(n)%n = size(chosen)
      polygon(n)%vertex(:size(chosen)) = chosen
      polygon(n)%y(:, :size(chosen)) = y(:, chosen)
   end subroutine add
end module lopin_facet_pieces
