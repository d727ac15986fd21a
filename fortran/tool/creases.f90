!> Edges between two facets: concave corners, and creases that mean a curved surface.
module lopin_creases
   use lopin_kinds, only : wp
   use lopin_facet_mesh, only : facet_mesh_type, edge_of
   use lopin_tool, only : one_plane
   implicit none
   private
   public :: is_hollow, chord_of, rise_of, turn_at, edge_to, stays, stands_alone, turn_beyond

   !> 30 degrees: two walls, not one.
   real(wp), parameter, public :: sharp = cos(acos(-1.0_wp)/6.0_wp)

   !> The next crease of a curved surface turns by so much of the last or its inverse, about an axis
   !> within so much of parallel [-].
   real(wp), parameter :: least_turn = 0.2_wp, parallel = 0.25_wp

contains

   !> The two facets of edge k meet in a concave corner.
   pure logical function is_hollow(mesh, f, k)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      integer :: g

      g = mesh%neighbour(k, f)
      is_hollow = g > 0
      if (.not. is_hollow) return
      is_hollow = dot_product(mesh%normal(:, f), mesh%normal(:, g)) < sharp .and. &
         & dot_product(mesh%normal(:, f), sum(mesh%x(:, mesh%vertex(:, g)), dim=2)/3.0_wp &
         & - mesh%x(:, mesh%vertex(k, f))) > 0.0_wp
   end function is_hollow

   !> Facets that meet at less than 30 degrees mean a curved surface, which is that far off them.
   pure real(wp) function chord_of(mesh, f, k)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      integer :: g

      chord_of = 0.0_wp
      g = mesh%neighbour(k, f)
      if (g == 0) return
      if (dot_product(mesh%normal(:, f), mesh%normal(:, g)) >= sharp) chord_of = rise_of(mesh, f, k)
   end function chord_of

   !> Height of an edge over the curved surface that its facets mean: of radius r = c/angle, with c
   !> between the middles of the facets. Equal sides have their corners at c from the middle: the
   !> surface rises c**2/(2 r) = c*angle/2 above a disc of that radius.
   pure real(wp) function rise_of(mesh, f, k) result(rise)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp) :: along(3), across(3)
      integer :: g

      rise = 0.0_wp
      g = mesh%neighbour(k, f)
      if (g == 0) return
      along = edge_of(mesh, f, k)
      across = (sum(mesh%x(:, mesh%vertex(:, f)), dim=2) - sum(mesh%x(:, mesh%vertex(:, g)), &
         & dim=2))/3.0_wp
      across = across - dot_product(across, along)/dot_product(along, along)*along
      rise = 0.5_wp*norm2(across)*abs(turn_at(mesh, f, k))
   end function rise_of

   !> The edge of a facet beyond which another lies.
   pure integer function edge_to(mesh, f, other) result(k)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, other
      k = findloc(mesh%neighbour(:, f), other, dim=1)
   end function edge_to

   !> Turn of the surface across an edge, > 0 over a ridge [rad].
   pure real(wp) function turn_at(mesh, f, k) result(turn)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      integer :: g

      g = mesh%neighbour(k, f)
      turn = 2.0_wp*asin(min(1.0_wp, 0.5_wp*norm2(mesh%normal(:, f) - mesh%normal(:, g))))
      if (dot_product(mesh%normal(:, f), sum(mesh%x(:, mesh%vertex(:, g)), dim=2)/3.0_wp &
         & - mesh%x(:, mesh%vertex(k, f))) > 0.0_wp) turn = -turn
   end function turn_at

   !> An edge that is sharp, or a crease that stands alone.
   pure logical function stays(mesh, f, k)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp) :: cosine

      cosine = dot_product(mesh%normal(:, f), mesh%normal(:, mesh%neighbour(k, f)))
      stays = cosine < sharp
      if (.not. stays .and. cosine < one_plane) stays = stands_alone(mesh, f, k)
   end function stays

   !> On neither side the surface turns on, the same way and about as much.
   pure logical function stands_alone(mesh, f, k)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp) :: along(3), turn
      integer :: g

      g = mesh%neighbour(k, f)
      along = edge_of(mesh, f, k)
      turn = turn_at(mesh, f, k)
      stands_alone = .not. (turns_on(mesh, f, k, along, turn) &
         & .or. turns_on(mesh, g, edge_to(mesh, g, f), along, turn))
   end function stands_alone

   !> Beyond a facet, on the way from its edge k, the surface turns on.
   pure logical function turns_on(mesh, f, k, along, turn)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp), intent(in) :: along(3), turn   !! the crease, and by how much it turns [rad]

      turns_on = turn_beyond(mesh, f, k, along, turn) > 0.0_wp
   end function turns_on

   !> Turn of the next crease beyond a facet, on the way from its edge k, over the turn there; 0
   !> where the surface does not turn on. An edge that turns far less, as between the halves of a
   !> rectangle, is passed over, once.
   pure real(wp) function turn_beyond(mesh, f, k, along, turn) result(next)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp), intent(in) :: along(3), turn   !! the crease, and by how much it turns [rad]
      integer :: i, j, g, back

      next = 0.0_wp
      do i = 1, 3
         g = mesh%neighbour(i, f)
         if (i == k .or. g == 0) cycle
         next = max(next, turn_with(mesh, f, i, along, turn))
         if (abs(turn_at(mesh, f, i)) > least_turn*abs(turn)) cycle
         back = edge_to(mesh, g, f)
         do j = 1, 3
            if (j == back .or. mesh%neighbour(j, g) == 0) cycle
            next = max(next, turn_with(mesh, g, j, along, turn))
         end do
      end do
   end function turn_beyond

   !> Turn of this edge over that of the crease, where it turns the surface the same way and about
   !> as much; else 0.
   pure real(wp) function turn_with(mesh, f, k, along, turn) result(next)
      type(facet_mesh_type), intent(in) :: mesh
      integer, intent(in) :: f, k
      real(wp), intent(in) :: along(3), turn
      real(wp) :: edge(3)

      edge = edge_of(mesh, f, k)
      next = turn_at(mesh, f, k)/turn
      if (.not. (next > least_turn .and. next < 1.0_wp/least_turn .and. &
         & abs(dot_product(edge, along)) > parallel*norm2(edge)*norm2(along))) next = 0.0_wp
   end function turn_with
end module lopin_creases
