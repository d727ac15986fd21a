!> A rigid tool of triangles, as an STL file brings it.
!>
!> Inside a facet the gap is along its normal. On an edge or a corner the point belongs to its
!> Voronoi region: the normal is the direction to the point, and the angle-weighted normal of the
!> feature says on which side it is (Baerentzen and Aanaes 2005).
module lopin_tool_facets
   use lopin_kinds, only : wp
   use lopin_facet_mesh, only : facet_mesh_type
   use lopin_facet_tree, only : facet_tree_type, new_facet_tree, box_distance2, deepest
   use lopin_tool, only : tool_type, foot_type, coincidence, one_plane, outer_product
   use lopin_creases, only : sharp, is_hollow, chord_of
   use lopin_triangle, only : closest_on_triangle
   implicit none
   private
   public :: facets_tool_type, new_facets_tool, nearest_type, settle_flat, goes_through

   real(wp), parameter :: tie = 1.0e-12_wp   !! relative: of equal distances the least facet wins
   !> How much deeper behind a wall than far from the surface a point may be: curved facets.
   real(wp), parameter :: deeper = 2.0_wp

   type, extends(tool_type) :: facets_tool_type
      type(facet_mesh_type) :: mesh
      type(facet_tree_type) :: tree
      logical, allocatable :: hollow(:, :)   !! (3, nfacet) edges that are concave corners of two
                                             !! walls
      logical :: hollow_edges = .false.   !! there are some
   contains
      procedure :: project
      procedure :: project_all => project_walls
      procedure :: settle => settle_flat
      procedure :: is_other_wall => is_other_flat
      procedure :: tessellate
      procedure :: describe
      procedure :: has_creases => has_edges
      procedure :: is_creased => is_bent
   end type facets_tool_type

   !> The closest point found so far.
   type :: nearest_type
      integer :: facet = 0
      integer :: feature = 0
      real(wp) :: distance2 = huge(1.0_wp)   !! [length**2]
      real(wp) :: point(3) = 0.0_wp          !! [length]
      logical :: of_other = .false.          !! on a second wall, which it does not leave
   end type nearest_type

contains

   !> A tool of flat triangles.
   subroutine new_facets_tool(self, mesh)
      type(facets_tool_type), intent(out) :: self
      type(facet_mesh_type), intent(in) :: mesh
      real(wp), allocatable :: low(:, :), high(:, :)
      integer :: f, k

      self%ndim = 3
      self%name = 'facets'
      self%size = mesh%size
      self%mesh = mesh
      allocate (low(3, mesh%nfacet), high(3, mesh%nfacet))
      allocate (self%chord(mesh%nfacet), source=0.0_wp)
      allocate (self%hollow(3, mesh%nfacet))
      do f = 1, mesh%nfacet
         low(:, f) = minval(mesh%x(:, mesh%vertex(:, f)), dim=2)
         high(:, f) = maxval(mesh%x(:, mesh%vertex(:, f)), dim=2)
         do k = 1, 3
            self%hollow(k, f) = is_hollow(mesh, f, k)
            self%chord(f) = max(self%chord(f), chord_of(mesh, f, k))
         end do
      end do
      self%hollow_edges = any(self%hollow)
      call new_facet_tree(self%tree, low, high)
   end subroutine new_facets_tool

   !> A facet belongs to another wall than a foot.
   pure logical function is_other_flat(self, f, foot) result(is_other)
      class(facets_tool_type), intent(in) :: self
      integer, intent(in) :: f
      type(foot_type), intent(in) :: foot
      is_other = dot_product(self%mesh%normal(:, f), foot%normal) <= sharp
   end function is_other_flat

   !> Some facets meet at an angle.
   pure logical function has_edges(self)
      class(facets_tool_type), intent(in) :: self
      integer :: f, k

      has_edges = .false.
      do f = 1, self%mesh%nfacet
         do k = 1, 3
            if (self%mesh%neighbour(k, f) == 0) cycle
            has_edges = has_edges .or. self%is_creased(f, self%mesh%neighbour(k, f))
         end do
      end do
   end function has_edges

   pure logical function is_bent(self, a, b)
      class(facets_tool_type), intent(in) :: self
      integer, intent(in) :: a, b
      is_bent = dot_product(self%mesh%normal(:, a), self%mesh%normal(:, b)) < one_plane
   end function is_bent

   pure subroutine project(self, x, foot)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      type(nearest_type) :: nearest

      call find_nearest(self, x, nearest)
      if (nearest%facet > 0) call self%settle(x, nearest, foot)
   end subroutine project

   !> Near a concave corner the other wall counts too: the nearest facet within reach that looks
   !> elsewhere, and is met inside and faces the first, or goes on behind it from their corner.
   pure subroutine project_walls(self, x, reach, feet, nfeet)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(:), reach
      type(foot_type), intent(out) :: feet(2)
      integer, intent(out) :: nfeet
      type(nearest_type) :: other

      call add_wall(self, x, reach, feet, nfeet, other)
      if (other%facet == 0) return
      other%of_other = .true.
      call self%settle(x, other, feet(2))
      ! Where a crease ends both ways may lead to one place.
      if (feet(2)%segment == feet(1)%segment) return
      ! What is behind both walls of a corner is no nearer to the surface than it is deep: deeper
      ! behind one, it stands before the corner of a sliver in a surface that goes on.
      if (feet(2)%gap < -deeper*norm2(x - feet(1)%point)) return
      nfeet = 2
      if (feet(2)%gap < feet(1)%gap) feet = feet([2, 1])
   end subroutine project_walls

   !> The first foot, and where the other wall is; its facet is 0 where there is none.
   pure subroutine add_wall(self, x, reach, feet, nfeet, other)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(:), reach
      type(foot_type), intent(inout) :: feet(2)
      integer, intent(out) :: nfeet
      type(nearest_type), intent(out) :: other

      nfeet = 0
      if (reach < 0.0_wp) return
      call self%project(x, feet(1))
      if (.not. feet(1)%found) return
      nfeet = 1
      if (.not. self%hollow_edges) return
      if (reach >= huge(1.0_wp)) then
         ! Room is asked for, not a place.
         feet(2) = feet(1)
         nfeet = 2
         return
      end if
      if (feet(1)%corner) return
      other%distance2 = min(reach, sqrt(huge(1.0_wp)))**2
      call find_nearest(self, x, other, feet(1))
   end subroutine add_wall

   !> Nearest of all facets, or of those that make a concave corner with the wall of a foot.
   pure subroutine find_nearest(self, x, nearest, wall)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      type(nearest_type), intent(inout) :: nearest   !! distance2: how far to look
      type(foot_type), intent(in), optional :: wall
      integer :: stack(deepest), top, k, i, near, far
      real(wp) :: bound(deepest), d(2)

      top = merge(1, 0, self%tree%nnode > 0)
      stack(1) = 1
      bound(1) = 0.0_wp
      associate (tree => self%tree)
         do while (top > 0)
            k = stack(top)
            top = top - 1
            if (bound(top + 1)*(1.0_wp - tie) > nearest%distance2) cycle
            if (tree%second(k) == 0) then
               do i = tree%first(k), tree%last(k)
                  call try_facet(self, tree%facet(i), x, nearest, wall)
               end do
               cycle
            end if
            near = k + 1
            far = tree%second(k)
            d(1) = box_distance2(tree%low(:, near), tree%high(:, near), x)
            d(2) = box_distance2(tree%low(:, far), tree%high(:, far), x)
            if (d(2) < d(1)) then
               near = far
               far = k + 1
               d = d([2, 1])
            end if
            stack(top + 1:top + 2) = [far, near]
            bound(top + 1:top + 2) = d([2, 1])
            top = top + 2
         end do
      end associate
   end subroutine find_nearest

   pure subroutine try_facet(self, f, x, nearest, wall)
      class(facets_tool_type), intent(in) :: self
      integer, intent(in) :: f
      real(wp), intent(in) :: x(3)
      type(nearest_type), intent(inout) :: nearest
      type(foot_type), intent(in), optional :: wall
      real(wp) :: point(3), distance2, arm(3)
      integer :: feature

      if (present(wall)) then
         if (.not. self%is_other_wall(f, wall)) then
            if (.not. (self%curved .and. any(self%hollow(:, f)))) return
         end if
      end if
      associate (v => self%mesh%vertex(:, f), mesh => self%mesh)
         call closest_on_triangle(mesh%x(:, v(1)), mesh%x(:, v(2)), mesh%x(:, v(3)), x, point, &
            & feature)
      end associate
      arm = x - point
      distance2 = arm(1)*arm(1) + arm(2)*arm(2) + arm(3)*arm(3)
      if (distance2*(1.0_wp - tie) > nearest%distance2) return
      if (distance2 >= nearest%distance2*(1.0_wp - tie) .and. nearest%facet > 0 .and. f > &
         & nearest%facet) return
      if (present(wall)) then
         if (.not. makes_corner(self, f, feature, point, wall)) return
      end if
      nearest = nearest_type(f, feature, distance2, point)
   end subroutine try_facet

   !> A facet that is met inside and the wall of a foot face each other; one that is met at its edge
   !> ends in that wall.
   pure logical function makes_corner(self, f, feature, point, wall)
      class(facets_tool_type), intent(in) :: self
      integer, intent(in) :: f, feature
      real(wp), intent(in) :: point(3)         !! where it is met [length]
      type(foot_type), intent(in) :: wall
      integer :: k, g

      if (.not. self%is_other_wall(f, wall)) then
         makes_corner = lies_beyond(self, f, feature, wall)
         if (feature > 0 .or. .not. makes_corner) return
      end if
      if (feature == 0) then
         makes_corner = dot_product(point - wall%point, wall%normal) >= 0.0_wp .and. &
            & dot_product(wall%point - point, self%mesh%normal(:, f)) >= 0.0_wp
         return
      end if
      makes_corner = .false.
      do k = 1, 3
         if (.not. (self%hollow(k, f) .and. meets_edge(feature, k))) cycle
         g = self%mesh%neighbour(k, f)
         makes_corner = makes_corner .or. g == wall%segment .or. .not. self%is_other_wall(g, wall)
      end do
   end function makes_corner

   !> A facet of the wall itself lies beyond a concave crease that ends in that wall: across it, the
   !> wall looks more as at the foot.
   pure logical function lies_beyond(self, f, feature, wall)
      class(facets_tool_type), intent(in) :: self
      integer, intent(in) :: f, feature
      type(foot_type), intent(in) :: wall
      integer :: k

      lies_beyond = .false.
      do k = 1, 3
         if (.not. self%hollow(k, f)) cycle
         if (feature > 0 .and. .not. meets_edge(feature, k)) cycle
         lies_beyond = lies_beyond .or. dot_product(wall%normal, self%mesh%normal(:, &
            & self%mesh%neighbour(k, f)) - self%mesh%normal(:, f)) > 0.0_wp
      end do
   end function lies_beyond

   !> A feature of a facet is its edge k or an end of it.
   pure logical function meets_edge(feature, k)
      integer, intent(in) :: feature, k
      meets_edge = any(feature == [k, 3 + k, 4 + mod(k, 3)])
   end function meets_edge

   !> A point whose closest place is on a concave corner has gone through the wall of the facet.
   pure logical function goes_through(self, x, nearest)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      type(nearest_type), intent(in) :: nearest
      integer :: k

      goes_through = .false.
      do k = 1, 3
         if (meets_edge(nearest%feature, k)) goes_through = goes_through .or. &
            & self%hollow(k, nearest%facet)
      end do
      if (nearest%feature > 3 .and. .not. nearest%of_other) goes_through = goes_through .and. &
         & dot_product(x - nearest%point, self%mesh%normal(:, nearest%facet)) <= 0.0_wp
   end function goes_through

   pure subroutine settle_flat(self, x, nearest, foot)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      type(nearest_type), intent(in) :: nearest
      type(foot_type), intent(out) :: foot
      real(wp) :: pseudo(3)
      logical :: perimeter
      integer :: k, g

      foot%found = .true.
      foot%segment = nearest%facet
      foot%point = nearest%point
      foot%normal = self%mesh%normal(:, nearest%facet)
      if (nearest%feature > 0 .and. .not. goes_through(self, x, nearest)) then
         k = nearest%feature
         if (k <= 3) then
            g = self%mesh%neighbour(k, nearest%facet)
            perimeter = g == 0
            if (.not. perimeter) then
               pseudo = foot%normal + self%mesh%normal(:, g)
               if (norm2(pseudo) > 0.0_wp) pseudo = pseudo/norm2(pseudo)
            end if
         else
            associate (v => self%mesh%vertex(k - 3, nearest%facet))
               perimeter = self%mesh%on_perimeter(v)
               pseudo = self%mesh%vertex_normal(:, v)
            end associate
         end if
         if (.not. perimeter) then
            call take_direction(self, x, nearest, pseudo, foot)
            return
         end if
         pseudo = x - foot%point
         foot%overhang = norm2(pseudo - dot_product(pseudo, foot%normal)*foot%normal)
      end if
      foot%gap = dot_product(x - foot%point, foot%normal)
   end subroutine settle_flat

   !> The normal is the direction to the point, unless that lies on the feature itself.
   pure subroutine take_direction(self, x, nearest, pseudo, foot)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3), pseudo(3)
      type(nearest_type), intent(in) :: nearest
      type(foot_type), intent(inout) :: foot
      real(wp) :: distance, side, along(3)
      integer :: k, i, v

      distance = sqrt(nearest%distance2)
      side = sign(1.0_wp, dot_product(x - foot%point, pseudo))
      k = nearest%feature
      associate (mesh => self%mesh)
         v = mesh%vertex(merge(k, k - 3, k <= 3), nearest%facet)
         if (distance <= coincidence*self%size) then
            foot%normal = pseudo
            foot%gap = dot_product(x - foot%point, pseudo)
            if (k <= 3) then
               foot%cone = dot_product(pseudo, mesh%normal(:, nearest%facet))
            else
               do i = mesh%ring_first(v), mesh%ring_first(v + 1) - 1
                  foot%cone = min(foot%cone, dot_product(pseudo, mesh%normal(:, mesh%ring(i))))
               end do
            end if
            foot%corner = foot%cone < sharp
            return
         end if
         foot%normal = side*(x - foot%point)/distance
         foot%gap = side*distance
         foot%corner = dot_product(foot%normal, mesh%normal(:, nearest%facet)) < sharp
         foot%hessian = -outer_product(foot%normal, foot%normal)
         do i = 1, 3
            foot%hessian(i, i) = foot%hessian(i, i) + 1.0_wp
         end do
         if (k <= 3) then
            along = mesh%x(:, mesh%vertex(1 + mod(k, 3), nearest%facet)) - mesh%x(:, v)
            foot%hessian = foot%hessian - outer_product(along, along)/dot_product(along, along)
         end if
         foot%hessian = foot%hessian*side/distance
      end associate
   end subroutine take_direction

   pure subroutine tessellate(self, box, points, cells)
      class(facets_tool_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)

      points = self%mesh%x(:size(box, 1), :)
      allocate (cells(4, self%mesh%nfacet), source=0)
      cells(:3, :) = self%mesh%vertex
   end subroutine tessellate

   function describe(self) result(text)
      class(facets_tool_type), intent(in) :: self
      character(len=:), allocatable :: text
      character(len=20) :: buffer

      write (buffer, '(i0)') self%mesh%nfacet
      text = trim(buffer)//' triangles'
      if (any(self%mesh%on_perimeter)) text = text//', open'
   end function describe
end module lopin_tool_facets
