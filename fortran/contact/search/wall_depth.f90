!> Wall thickness behind a surface: the depth beyond which a penetration belongs to the opposite
!> skin.
!>
!> The skin of a thin sheet looks both ways: from its upper side the under side of what lies below
!> seems to be entered by both thicknesses. Half the way to the other side of one's own wall bounds
!> what counts as penetration.
module lopin_wall_depth
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection
   implicit none
   private
   public :: depths_of_nodes, depths_of_facets

contains

   !> Half the thickness behind each node; huge where the surface has no other side.
   subroutine depths_of_nodes(surface, x, normal, cosine, depth)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) [length]
      real(wp), intent(in) :: normal(:, :)     !! (ndim, surface%nnode) outward unit normals
      real(wp), intent(in) :: cosine           !! normals of both sides must be below [-]
      real(wp), intent(out) :: depth(:)        !! (surface%nnode) [length]
      type(tree_type) :: tree
      integer :: i

      depth = huge(1.0_wp)
      if (.not. looks_back(surface)) return
      call build_tree(tree, surface%low, surface%high)
      do i = 1, surface%nnode
         call look(surface, tree, x(:, surface%node(i)), normal(:, i), cosine, &
            & surface%ring(surface%ring_first(i):surface%ring_first(i + 1) - 1), depth(i))
      end do
   end subroutine depths_of_nodes

   !> The same from the middles of the facets.
   subroutine depths_of_facets(surface, cosine, depth)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: cosine
      real(wp), intent(out) :: depth(:)        !! (facets) [length]
      type(tree_type) :: tree
      integer :: i

      depth = huge(1.0_wp)
      if (.not. looks_back(surface)) return
      call build_tree(tree, surface%low, surface%high)
      do i = 1, surface%facets%n
         call look(surface, tree, surface%disc(:surface%ndim, i), &
            & surface%disc(4:3 + surface%ndim, i), cosine, [i], depth(i))
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

   subroutine look(surface, tree, x, normal, cosine, own, depth)
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:), normal(:), cosine
      integer, intent(in) :: own(:)            !! facets that do not count
      real(wp), intent(inout) :: depth
      type(limits_type) :: limits
      type(projection_type) :: found

      if (.not. norm2(normal) > 0.0_wp) return
      limits%cosine = cosine
      limits%behind = .true.
      call find_projection(surface, tree, x, normal, limits, found, own)
      if (found%facet > 0) depth = 0.5_wp*abs(found%gap)
   end subroutine look
end module lopin_wall_depth
