!> Wall thickness behind a surface: the depth beyond which a penetration belongs to the opposite
!> skin.
!>
!> The skin of a thin sheet looks both ways: from its upper side the under side of what lies below
!> seems to be entered by both thicknesses. Half the way to the other side of one's own wall bounds
!> what counts as penetration: the way straight back to where it leaves the body, measured square to
!> the side there. The nearest facet that looks the other way may be far beside it, or none may own
!> the point, as at the ends of a body that has walls at right angles.
module lopin_wall_depth
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_facet_basis, only : facet_point_of
   use lopin_surface, only : surface_type
   use lopin_search, only : tree_type, build_tree, leaf_span, deepest
   implicit none
   private
   public :: depths_of_nodes, depths_of_facets

   !> Sine below which a way runs along a facet; share of a facet by which a way may pass it.
   real(wp), parameter :: grazing = 1.0e-2_wp, beside = 1.0e-6_wp

contains

   !> Half the thickness behind each node; huge where the surface has no other side.
   subroutine depths_of_nodes(surface, x, normal, depth)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) [length]
      real(wp), intent(in) :: normal(:, :)     !! (ndim, surface%nnode) outward unit normals
      real(wp), intent(out) :: depth(:)        !! (surface%nnode) [length]
      type(tree_type) :: tree
      integer :: i

      depth = huge(1.0_wp)
      if (.not. looks_back(surface)) return
      call build_tree(tree, surface%low, surface%high)
      do i = 1, surface%nnode
         call look(surface, tree, x(:, surface%node(i)), normal(:, i), depth(i))
      end do
   end subroutine depths_of_nodes

   !> The same from the middles of the facets.
   subroutine depths_of_facets(surface, depth)
      type(surface_type), intent(in) :: surface
      real(wp), intent(out) :: depth(:)        !! (facets) [length]
      type(tree_type) :: tree
      integer :: i

      depth = huge(1.0_wp)
      if (.not. looks_back(surface)) return
      call build_tree(tree, surface%low, surface%high)
      do i = 1, surface%facets%n
         call look(surface, tree, surface%disc(:3, i), surface%disc(4:6, i), depth(i))
      end do
   end subroutine depths_of_facets

   !> Some of its facets look the other way than others: cheap to ask.
   pure logical function looks_back(surface)
      type(surface_type), intent(in) :: surface
      real(wp) :: low(3), high(3)

      low = minval(surface%disc(4:6, :), dim=2)
      high = maxval(surface%disc(4:6, :), dim=2)
      looks_back = any(low < -0.2_wp .and. high > 0.2_wp)
   end function looks_back

   !> Half the way straight back from a point of the skin to where it leaves the body.
   pure subroutine look(surface, tree, x, normal, depth)
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:), normal(:)
      real(wp), intent(inout) :: depth         !! [length]
      real(wp) :: from(3), way(3), margin, far, wall
      integer :: stack(deepest), top, k, j, last

      if (tree%n == 0 .or. .not. norm2(normal) > 0.0_wp) return
      from = 0.0_wp
      from(:size(x)) = x
      way = 0.0_wp
      way(:size(normal)) = -normal/norm2(normal)
      margin = beside*norm2(tree%high(:, 1) - tree%low(:, 1))
      far = huge(1.0_wp)
      top = 1
      stack(1) = 1
      do while (top > 0)
         k = stack(top)
         top = top - 1
         if (.not. meets_box(tree%low(:, k) - margin, tree%high(:, k) + margin, from, way, far)) &
            & cycle
         if (k < tree%nleaf) then
            stack(top + 1:top + 2) = [2*k + 1, 2*k]
            top = top + 2
            cycle
         end if
         call leaf_span(tree, k - tree%nleaf + 1, j, last)
         do j = j, last
            call find_way_out(surface, tree%facet(j), from, way, far, wall)
         end do
      end do
      if (far < huge(1.0_wp)) depth = 0.5_wp*wall
   end subroutine look

   !> Whether a way meets a box before it has gone far.
   pure logical function meets_box(low, high, from, way, far)
      real(wp), intent(in) :: low(3), high(3), from(3), way(3), far
      real(wp) :: enter, leave, a, b
      integer :: k

      meets_box = .false.
      enter = 0.0_wp
      leave = far
      do k = 1, 3
         if (abs(way(k)) > 1.0e-12_wp) then
            a = (low(k) - from(k))/way(k)
            b = (high(k) - from(k))/way(k)
            enter = max(enter, min(a, b))
            leave = min(leave, max(a, b))
         else if (from(k) < low(k) .or. from(k) > high(k)) then
            return
         end if
      end do
      meets_box = enter <= leave
   end function meets_box

   !> Where a way leaves the body through a facet, if it does so nearer than it did so far. Curved
   !> facets count as those of their corners.
   pure subroutine find_way_out(surface, facet, from, way, far, wall)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: from(3), way(3)
      real(wp), intent(inout) :: far           !! along the way [length]
      real(wp), intent(inout) :: wall          !! square to the facet there [length]
      real(wp) :: corner(3, 4)
      integer :: k, n

      associate (cell => surface%facets%cell(facet))
         n = surface%basis%ncorner(cell)
         do k = 1, n
            corner(:, k) = facet_point_of(surface%coefficient(:, :, facet), &
               & surface%basis%xi(:, k, cell))
         end do
      end associate
      if (n == 2) then
         ! In the plane: a wall that stands on both sides of it.
         corner(3, :2) = -surface%size(facet)
         corner(:, 3:4) = corner(:, [2, 1])
         corner(3, 3:4) = surface%size(facet)
         n = 4
      end if
      do k = 2, n - 1
         call leave_through(corner(:, [1, k, k + 1]), from, way, beside*surface%size(facet), far, &
            & wall)
      end do
   end subroutine find_way_out

   !> The same of a triangle that looks the way its corners turn.
   pure subroutine leave_through(corner, from, way, least, far, wall)
      real(wp), intent(in) :: corner(3, 3), from(3), way(3)
      real(wp), intent(in) :: least            !! nearer is where the way began [length]
      real(wp), intent(inout) :: far, wall     !! [length]
      real(wp) :: n(3), along, t
      integer :: k

      n = cross(corner(:, 2) - corner(:, 1), corner(:, 3) - corner(:, 1))
      along = dot_product(way, n)
      if (along <= grazing*norm2(n)) return
      t = dot_product(corner(:, 1) - from, n)/along
      if (t <= least .or. t >= far) return
      do k = 1, 3
         associate (a => corner(:, k), b => corner(:, 1 + mod(k, 3)))
            if (dot_product(cross(b - a, from + t*way - a), n) < -beside*dot_product(n, n)) return
         end associate
      end do
      far = t
      wall = t*along/norm2(n)
   end subroutine leave_through
end module lopin_wall_depth
