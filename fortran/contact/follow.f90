!> Follow a foot from its last facet: project there, walk on over edges while it gets nearer.
module lopin_follow
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_projection, only : closest_type, place, project_on_facet
   use lopin_surface, only : surface_type
   implicit none
   private
   public :: follow_foot, foot_on, share_node, hysteresis

   integer, parameter :: most_hops = 5
   !> Reference units by which a foot may pass the edge of its facet without changing it.
   real(wp), parameter :: hysteresis = 1.0e-6_wp
   real(wp), parameter :: nearer = 1.0e-12_wp !! relative: what a hop must gain, squared distance

contains

   !> The closest point on the surface near a facet; `lost` when the walk does not end.
   pure subroutine follow_foot(surface, x, facet, xi, closest, hops, projections, lost)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)              !! [length]
      integer, intent(inout) :: facet           !! in: where it was; out: where it is
      real(wp), intent(in) :: xi(2)             !! where it was on that facet
      type(closest_type), intent(out) :: closest
      integer, intent(out) :: hops
      integer, intent(inout) :: projections
      logical, intent(out) :: lost
      type(closest_type) :: best
      integer :: next

      lost = .false.
      hops = 0
      call foot_on(surface, facet, x, hysteresis, xi, closest)
      projections = projections + 1
      if (closest%place == place%inside) return
      call foot_on(surface, facet, x, 0.0_wp, xi, closest)
      projections = projections + 1
      do
         if (closest%place == place%none) lost = .true.
         if (closest%place == place%none .or. closest%place == place%inside) return
         call nearest_around(surface, x, facet, closest, next, best, projections)
         if (next == 0) return
         hops = hops + 1
         facet = next
         closest = best
         lost = hops > most_hops
         if (lost) return
      end do
   end subroutine follow_foot

   !> The best foot on the facets across the edge, or around the vertex, where a foot lies.
   pure subroutine nearest_around(surface, x, facet, closest, next, best, projections)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      integer, intent(out) :: next              !! 0: none is nearer
      type(closest_type), intent(out) :: best
      integer, intent(inout) :: projections
      integer :: node, i

      next = 0
      best%distance2 = (1.0_wp - nearer)*closest%distance2
      if (closest%place == place%edge) then
         call try_facet(surface, x, surface%neighbour(closest%feature, facet), facet, next, best, &
            & projections)
         return
      end if
      node = surface%local(closest%feature, facet)
      do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
         call try_facet(surface, x, surface%ring(i), facet, next, best, projections)
      end do
   end subroutine nearest_around

   pure subroutine try_facet(surface, x, f, old, next, best, projections)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)
      integer, intent(in) :: f, old
      integer, intent(inout) :: next
      type(closest_type), intent(inout) :: best
      integer, intent(inout) :: projections
      type(closest_type) :: trial

      if (f == 0 .or. f == old) return
      call foot_on(surface, f, x, 0.0_wp, surface%basis%centre(:, surface%facets%cell(f)), trial)
      projections = projections + 1
      if (trial%place == place%none .or. trial%distance2 >= best%distance2) return
      next = f
      best = trial
   end subroutine try_facet

   !> Closest point of one facet whose bounds are moved outward by `slack` [reference units].
   pure subroutine foot_on(surface, facet, x, slack, start, closest)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: x(3), slack, start(2)
      type(closest_type), intent(out) :: closest
      real(wp) :: bounds(4), first(2)
      integer :: cell, family

      cell = surface%facets%cell(facet)
      family = surface%basis%family(cell)
      bounds = slack
      first = start
      if (family == cell_family%triangle) then
         if (min(first(1), first(2), 1.0_wp - first(1) - first(2)) < 0.0_wp) &
            & first = surface%basis%centre(:, cell)
      else
         first = min(max(first, -1.0_wp), 1.0_wp)
      end if
      call project_on_facet(surface%coefficient(:, :, facet), family, first, bounds, x, closest)
   end subroutine foot_on

   !> Whether two facets have a corner in common.
   pure logical function share_node(surface, one, two)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: one, two
      integer :: k

      share_node = .false.
      do k = 1, surface%basis%ncorner(surface%facets%cell(one))
         share_node = share_node .or. any(surface%local(:surface%basis%ncorner( &
            & surface%facets%cell(two)), two) == surface%local(k, one))
      end do
   end function share_node
end module lopin_follow
