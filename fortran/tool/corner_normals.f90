!> Normals at the corners of triangles that mean a curved surface.
!>
!> They are the means of the facets around a corner by angle times area, but for where a wide facet
!> meets the narrow ones of a fillet: a plane, a cone or a wall that a fillet is tangent to goes on
!> flat to where that begins. A mean would curve it: the land of a flash of 5 mm beside one chord of
!> a fillet of 0.5 mm stood up by 0.08 mm.
module lopin_corner_normals
   use lopin_kinds, only : wp
   use lopin_facet_mesh, only : facet_mesh_type, edge_of
   use lopin_vectors, only : cross
   use lopin_creases, only : turn_at, edge_to, turn_beyond
   implicit none
   private
   public :: corner_normal

   !> A facet of a surface of one curvature is not so many times as wide as the next.
   real(wp), parameter :: much_wider = 3.0_wp
   !> A fillet of equal chords turns twice as much from chord to chord as from the wall, which it is
   !> tangent to, to the first; facets of one curvature turn by as much as they are wide, half of
   !> each: beyond a narrow one no more than at the wide one before it.
   real(wp), parameter :: fillet_turn = 1.4_wp
   !> Below 3 degrees it does not matter which of two facets a normal leans to.
   real(wp), parameter :: slight = 0.05_wp

contains

   !> The unit normal of the surface at corner k of facet f, among facets that no kept edge parts.
   pure function corner_normal(mesh, kept, f, k) result(normal)
      type(facet_mesh_type), intent(in) :: mesh
      logical, intent(in) :: kept(:, :)      !! (3, nfacet) edges that stay as they are
      integer, intent(in) :: f, k
      real(wp) :: normal(3)
      integer, allocatable :: list(:)
      logical, allocatable :: wide(:)
      integer :: v, i

      v = mesh%vertex(k, f)
      call find_fan(mesh, kept, f, v, list)
      allocate (wide(size(list)))
      do i = 1, size(list)
         wide(i) = is_wide(mesh, kept, list(i), v)
      end do
      if (any(wide)) then
         call add_halves(mesh, list, wide)
      else
         wide = .true.
      end if
      normal = 0.0_wp
      do i = 1, size(list)
         if (wide(i)) normal = normal + weight_of(mesh, list(i), v)*mesh%normal(:, list(i))
      end do
      normal = normal/norm2(normal)
   end function corner_normal

   !> Facets around a vertex, from facet f on, as far as no kept edge parts them from it.
   pure subroutine find_fan(mesh, kept, f, v, list)
      type(facet_mesh_type), intent(in) :: mesh
      logical, intent(in) :: kept(:, :)
      integer, intent(in) :: f, v
      integer, allocatable, intent(out) :: list(:)
      integer :: found(mesh%ring_first(v + 1) - mesh%ring_first(v))
      integer :: n, i, h, c, side

      found(1) = f
      n = 1
      i = 0
      do while (i < n)
         i = i + 1
         c = findloc(mesh%vertex(:, found(i)), v, dim=1)
         do side = 1, 2
            ! The edges that begin and end at the corner.
            h = merge(c, 1 + mod(c + 1, 3), side == 1)
            if (kept(h, found(i))) cycle
            h = mesh%neighbour(h, found(i))
            if (h == 0) cycle
            if (any(found(:n) == h) .or. n == size(found)) cycle
            n = n + 1
            found(n) = h
         end do
      end do
      list = found(:n)
   end subroutine find_fan

   !> Over an edge at this vertex a fillet begins: what lies there is narrow, and turns on by more.
   pure logical function is_wide(mesh, kept, f, v)
      type(facet_mesh_type), intent(in) :: mesh
      logical, intent(in) :: kept(:, :)
      integer, intent(in) :: f, v
      integer :: k, g, back
      real(wp) :: turn

      is_wide = .false.
      do k = 1, 3
         g = mesh%neighbour(k, f)
         if (g == 0 .or. kept(k, f)) cycle
         if (all(mesh%vertex([k, 1 + mod(k, 3)], f) /= v)) cycle
         turn = turn_at(mesh, f, k)
         if (abs(turn) < slight) cycle
         back = edge_to(mesh, g, f)
         if (width_of(mesh, f, k) < much_wider*width_of(mesh, g, back)) cycle
         is_wide = turn_beyond(mesh, g, back, edge_of(mesh, f, k), turn) > fillet_turn
         if (is_wide) return
      end do
   end function is_wide

   !> The other triangles of a wide face, which touch the fillet at a corner alone.
   pure subroutine add_halves(mesh, list, wide)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: list(:)         !! facets around a vertex
      logical, intent(inout) :: wide(:)
      logical :: before(size(list))
      integer :: i, k, at

      do
         before = wide
         do i = 1, size(list)
            if (.not. before(i)) cycle
            do k = 1, 3
               at = findloc(list, mesh%neighbour(k, list(i)), dim=1)
               if (at == 0) cycle
               if (abs(turn_at(mesh, list(i), k)) < slight) wide(at) = .true.
            end do
         end do
         if (all(wide .eqv. before)) return
      end do
   end subroutine add_halves

   !> Height of a facet over its edge k.
   pure real(wp) function width_of(mesh, f, k) result(width)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp) :: along(3)

      along = edge_of(mesh, f, k)
      width = norm2(cross(along, edge_of(mesh, f, 1 + mod(k, 3))))/norm2(along)
   end function width_of

   !> Angle at the vertex times area: a plane keeps its direction beside the facets of a fillet.
   pure real(wp) function weight_of(mesh, f, v)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, v
      real(wp) :: a(3), b(3), c(3)
      integer :: k

      k = findloc(mesh%vertex(:, f), v, dim=1)
      a = edge_of(mesh, f, k)
      b = -edge_of(mesh, f, 1 + mod(k + 1, 3))
      c = cross(a, b)
      weight_of = max(norm2(c)*atan2(norm2(c), dot_product(a, b)), tiny(1.0_wp))
   end function weight_of
end module lopin_corner_normals
