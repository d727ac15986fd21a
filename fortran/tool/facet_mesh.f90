!> A surface of triangles made whole: points welded, neighbours found, sides agreed, holes named.
module lopin_facet_mesh
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_weld, only : weld_points
   implicit none
   private
   public :: facet_mesh_type, facet_flaws_type, new_facet_mesh, edge_of

   !> Points nearer than this fraction of the size are one point.
   real(wp), parameter :: weld = 1.0e-6_wp

   !> Triangles with the outward normal by the right-hand rule of their vertices.
   type :: facet_mesh_type
      integer :: nvertex = 0
      integer :: nfacet = 0
      real(wp) :: size = 0.0_wp                     !! diagonal of the box around it [length]
      real(wp), allocatable :: x(:, :)              !! (3, nvertex) [length]
      integer, allocatable :: vertex(:, :)          !! (3, nfacet); edge k: vertices k, k + 1
      integer, allocatable :: neighbour(:, :)       !! (3, nfacet) beyond edge k; 0: the perimeter
      real(wp), allocatable :: normal(:, :)         !! (3, nfacet) unit, outward
      real(wp), allocatable :: vertex_normal(:, :)  !! (3, nvertex) angle-weighted, unit
      logical, allocatable :: on_perimeter(:)       !! (nvertex)
      integer, allocatable :: ring_first(:), ring(:)   !! facets around vertex i
   end type facet_mesh_type

   !> What was found wrong, each with one place of it.
   type :: facet_flaws_type
      integer :: degenerate = 0             !! facets without area, dropped
      integer :: hole = 0                   !! edges of one facet
      integer :: crowded = 0                !! edges of three or more facets
      integer :: against = 0                !! facets whose side contradicts that of the others
      integer :: loop = 0                   !! facets of a surface with one side only
      real(wp) :: hole_at(3) = 0.0_wp, crowded_at(3) = 0.0_wp, against_at(3) = 0.0_wp   !! [length]
   end type facet_flaws_type

contains

   !> Facets that look the wrong way are turned to the side of the greater area of their piece and
   !> counted in `flaws%against`: it is for the caller to accept that.
   pure subroutine new_facet_mesh(self, corner, flaws)
      type(facet_mesh_type), intent(out) :: self
      real(wp), intent(in) :: corner(:, :, :)       !! (3, 3, n): coordinate, corner, facet [length]
      type(facet_flaws_type), intent(out) :: flaws
      integer, allocatable :: kept(:), which(:), order(:)
      real(wp), allocatable :: x(:, :)
      integer :: i, n

      n = size(corner, 3)
      if (n == 0) return
      x = reshape(corner, [3, 3*n])
      self%size = norm2(maxval(x, dim=2) - minval(x, dim=2))
      call weld_points(x, max(weld*self%size, tiny(1.0_wp)), kept, which)
      self%nvertex = size(kept)
      self%x = x(:, kept)
      self%vertex = reshape(which, [3, n])
      order = pack([(i, i=1, n)], self%vertex(1, :) /= self%vertex(2, :) .and. self%vertex(2, :) &
         & /= self%vertex(3, :) .and. self%vertex(3, :) /= self%vertex(1, :))
      flaws%degenerate = n - size(order)
      self%nfacet = size(order)
      self%vertex = self%vertex(:, order)
      allocate (self%neighbour(3, self%nfacet), source=0)
      call find_rings(self)
      call find_neighbours(self, flaws)
      call agree_on_sides(self, flaws)
      call find_normals(self)
   end subroutine new_facet_mesh

   pure subroutine find_rings(self)
      type(facet_mesh_type), intent(inout) :: self
      integer, allocatable :: filled(:)
      integer :: f, k

      allocate (self%ring_first(self%nvertex + 1), source=0)
      allocate (self%ring(3*self%nfacet), filled(self%nvertex))
      do f = 1, self%nfacet
         do k = 1, 3
            associate (v => self%vertex(k, f))
               self%ring_first(v + 1) = self%ring_first(v + 1) + 1
            end associate
         end do
      end do
      self%ring_first(1) = 1
      do k = 1, self%nvertex
         self%ring_first(k + 1) = self%ring_first(k + 1) + self%ring_first(k)
      end do
      filled = self%ring_first(:self%nvertex)
      do f = 1, self%nfacet
         do k = 1, 3
            associate (v => self%vertex(k, f))
               self%ring(filled(v)) = f
               filled(v) = filled(v) + 1
            end associate
         end do
      end do
   end subroutine find_rings

   !> Edges are shared by two facets; fewer make holes, more make no surface.
   pure subroutine find_neighbours(self, flaws)
      type(facet_mesh_type), intent(inout) :: self
      type(facet_flaws_type), intent(inout) :: flaws
      integer :: f, k, i, a, b, nother, other, least

      do f = 1, self%nfacet
         do k = 1, 3
            a = self%vertex(k, f)
            b = self%vertex(1 + mod(k, 3), f)
            nother = 0
            other = 0
            least = f
            do i = self%ring_first(a), self%ring_first(a + 1) - 1
               associate (g => self%ring(i))
                  if (g == f .or. .not. any(self%vertex(:, g) == b)) cycle
                  nother = nother + 1
                  other = g
                  least = min(least, g)
               end associate
            end do
            select case (nother)
            case (0)
               if (flaws%hole == 0) flaws%hole_at = 0.5_wp*(self%x(:, a) + self%x(:, b))
               flaws%hole = flaws%hole + 1
            case (1)
               self%neighbour(k, f) = other
            case default
               if (flaws%crowded == 0) flaws%crowded_at = 0.5_wp*(self%x(:, a) + self%x(:, b))
               if (least == f) flaws%crowded = flaws%crowded + 1
            end select
         end do
      end do
   end subroutine find_neighbours

   !> Piece by piece: walk over the edges, and turn what contradicts the greater area.
   pure subroutine agree_on_sides(self, flaws)
      type(facet_mesh_type), intent(inout) :: self
      type(facet_flaws_type), intent(inout) :: flaws
      integer, allocatable :: sign_of(:), stack(:)
      integer :: first, n, i, k, f, g, same, turned
      real(wp) :: balance

      allocate (sign_of(self%nfacet), stack(self%nfacet), source=0)
      do first = 1, self%nfacet
         if (sign_of(first) /= 0) cycle
         sign_of(first) = 1
         stack(1) = first
         n = 1
         i = 0
         balance = 0.0_wp
         do while (i < n)
            i = i + 1
            f = stack(i)
            balance = balance + real(sign_of(f), wp)*norm2(area_vector(self, f))
            do k = 1, 3
               g = self%neighbour(k, f)
               if (g == 0) cycle
               same = merge(1, -1, runs_from(self%vertex(:, g), self%vertex(1 + mod(k, 3), f), &
                  & self%vertex(k, f)))
               if (sign_of(g) == 0) then
                  n = n + 1
                  stack(n) = g
                  sign_of(g) = same*sign_of(f)
               else if (sign_of(g) /= same*sign_of(f)) then
                  flaws%loop = flaws%loop + 1
               end if
            end do
         end do
         turned = merge(-1, 1, balance >= 0.0_wp)
         do i = 1, n
            f = stack(i)
            if (sign_of(f) /= turned) cycle
            if (flaws%against == 0) flaws%against_at = sum(self%x(:, self%vertex(:, f)), &
               & dim=2)/3.0_wp
            flaws%against = flaws%against + 1
            self%vertex(2:3, f) = self%vertex([3, 2], f)
            self%neighbour([1, 3], f) = self%neighbour([3, 1], f)
         end do
      end do
   end subroutine agree_on_sides

   pure logical function runs_from(vertex, a, b)
      integer, intent(in) :: vertex(3), a, b
      integer :: k

      k = findloc(vertex, a, dim=1)
      runs_from = vertex(1 + mod(k, 3)) == b
   end function runs_from

   pure function area_vector(self, f) result(a)
      type(facet_mesh_type), intent(in) :: self
      integer, intent(in) :: f
      real(wp) :: a(3)

      associate (v => self%vertex(:, f))
         a = 0.5_wp*cross(self%x(:, v(2)) - self%x(:, v(1)), self%x(:, v(3)) - self%x(:, v(1)))
      end associate
   end function area_vector

   !> A facet that is a line takes the normal of a neighbour that is not.
   pure subroutine find_normals(self)
      type(facet_mesh_type), intent(inout) :: self
      real(wp) :: a(3), longest
      logical :: thin(self%nfacet)
      integer :: f, k, g

      allocate (self%normal(3, self%nfacet), self%vertex_normal(3, self%nvertex), source=0.0_wp)
      allocate (self%on_perimeter(self%nvertex), source=.false.)
      do f = 1, self%nfacet
         a = area_vector(self, f)
         longest = 0.0_wp
         do k = 1, 3
            longest = max(longest, norm2(edge_of(self, f, k)))
         end do
         thin(f) = norm2(a) <= 0.5_wp*weld*longest**2
         if (norm2(a) > 0.0_wp) self%normal(:, f) = a/norm2(a)
      end do
      do f = 1, self%nfacet
         do k = 1, 3
            g = self%neighbour(k, f)
            if (g == 0) then
               self%on_perimeter(self%vertex([k, 1 + mod(k, 3)], f)) = .true.
            else if (thin(f) .and. .not. thin(max(1, g))) then
               self%normal(:, f) = self%normal(:, g)
            end if
         end do
      end do
      do f = 1, self%nfacet
         do k = 1, 3
            associate (n => self%vertex_normal(:, self%vertex(k, f)))
               n = n + angle_at(self, f, k)*self%normal(:, f)
            end associate
         end do
      end do
      do k = 1, self%nvertex
         if (norm2(self%vertex_normal(:, k)) > 0.0_wp) self%vertex_normal(:, k) = &
            & self%vertex_normal(:, k)/norm2(self%vertex_normal(:, k))
      end do
   end subroutine find_normals

   !> Edge k of facet f, from its vertex k on.
   pure function edge_of(self, f, k) result(e)
      type(facet_mesh_type), intent(in) :: self
      integer, intent(in) :: f, k
      real(wp) :: e(3)
      e = self%x(:, self%vertex(1 + mod(k, 3), f)) - self%x(:, self%vertex(k, f))
   end function edge_of

   pure real(wp) function angle_at(self, f, k)
      type(facet_mesh_type), intent(in) :: self
      integer, intent(in) :: f, k
      real(wp) :: a(3), b(3)

      a = edge_of(self, f, k)
      b = -edge_of(self, f, 1 + mod(k + 1, 3))
      angle_at = atan2(norm2(cross(a, b)), dot_product(a, b))
   end function angle_at
end module lopin_facet_mesh
