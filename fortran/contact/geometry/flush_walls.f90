!> Walls: where a facet that a slave faces ends, because the surface goes on round a sharp edge to a
!> side that the slave does not face.
module lopin_flush_walls
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal
   use lopin_smooth_facet, only : feature_cosine
   use lopin_surface, only : surface_type, slack_of, edge_normal
   implicit none
   private
   public :: ends_at_wall, slack_beyond, ask_walls, find_faced, touches_hardly

   real(wp), parameter :: touching = 1.0e-9_wp   !! of a facet: lengths below are rounding
   !> Cosines of normals of a wall that is hardly faced, and of a facet that is well.
   real(wp), parameter :: hardly = -0.5_wp, well = -0.7_wp
   !> Of a facet: what is nearer to a wall is flush with it; what is in the facet beside the wall by
   !> more is not known to belong there.
   real(wp), parameter :: flush = 1.0e-2_wp, shallow = 0.05_wp

contains

   !> Whether facets at an edge or corner that face a slave end there, at a wall that does not.
   pure logical function ends_at_wall(surface, facet, closest, n_slave, cosine) result(ends)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: n_slave(3)
      real(wp), intent(in) :: cosine               !! beyond, a facet is not faced [-]
      integer :: i, k, n, node

      if (closest%place == place%edge) then
         ends = is_wall(surface, facet, closest%feature, n_slave, cosine)
         return
      end if
      ends = .false.
      node = surface%local(closest%feature, facet)
      do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
         associate (f => surface%ring(i))
            n = surface%basis%ncorner(surface%facets%cell(f))
            if (dot_product(n_slave, surface%disc(4:6, f)) > cosine) cycle
            do k = 1, n
               if (all(surface%local([k, merge(k, 1 + mod(k, n), n == 2)], f) /= node)) cycle
               ends = ends .or. is_wall(surface, f, k, n_slave, cosine)
            end do
         end associate
      end do
   end function ends_at_wall

   !> Whether the neighbour across an edge of a facet is a wall to the slave: round a sharp edge,
   !> and not opposite.
   pure logical function is_wall(surface, facet, edge, n_slave, cosine)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet, edge
      real(wp), intent(in) :: n_slave(3)
      real(wp), intent(in) :: cosine               !! beyond, a facet is not faced [-]
      real(wp) :: n(3)

      is_wall = .false.
      associate (other => surface%neighbour(edge, facet))
         if (other == 0) return
         n = edge_normal(surface, other, surface%twin(edge, facet))
         if (.not. dot_product(n_slave, n) > cosine) return
         is_wall = dot_product(n, edge_normal(surface, facet, edge)) < feature_cosine
      end associate
   end function is_wall

   !> How far the edges of a facet may be moved outward, in reference units: those on the perimeter,
   !> and those at walls of a slave that has a side.
   pure function slack_beyond(surface, facet, n_slave, cosine, extension) result(slack)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: n_slave(3)
      real(wp), intent(in) :: cosine               !! beyond, a facet is not faced [-]
      real(wp), intent(in) :: extension            !! fraction of the facet
      real(wp) :: slack(4)
      integer :: k

      slack = slack_of(surface, facet, extension)
      if (.not. any(abs(n_slave) > 0.0_wp)) return
      do k = 1, surface%basis%ncorner(surface%facets%cell(facet))
         if (is_wall(surface, facet, k, n_slave, cosine)) slack(k) = merge(1.0_wp, 2.0_wp, &
            & surface%basis%family(surface%facets%cell(facet)) == cell_family%triangle) &
            & *(extension)
      end do
   end function slack_beyond

   !> Whether a foot on an edge or corner is really the closest one, also among the facets around it
   !> that were refused for their side. If not, the point is beside the body, opposite nothing;
   !> but a wall that the point is behind is only nearer than the facets that it ends.
   pure subroutine ask_walls(surface, closest, x, facet, owned, entered)
      type(surface_type), intent(in) :: surface
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3)
      integer, intent(in) :: facet
      logical, intent(out) :: owned
      logical, intent(out) :: entered              !! a wall is nearer, and the point behind it
      type(closest_type) :: trial
      real(wp), parameter :: none(4) = 0.0_wp
      real(wp) :: n(3)
      integer :: i, k, f, corner

      owned = .true.
      entered = .false.
      corner = closest%feature
      do k = 1, merge(2, 1, closest%place == place%edge)
         if (k == 2) corner = 1 + mod(closest%feature, &
            & surface%basis%ncorner(surface%facets%cell(facet)))
         associate (node => surface%local(corner, facet))
            do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
               f = surface%ring(i)
               associate (cell => surface%facets%cell(f), c => surface%coefficient(:, :, f))
                  call project_on_facet(c, surface%basis%family(cell), &
                     & surface%basis%centre(:, cell), none, x, trial)
                  if (.not. sqrt(trial%distance2) < sqrt(closest%distance2) - &
                     & touching*surface%size(f)) cycle
                  n = facet_unit_normal(c, surface%basis%family(cell), trial%xi)
               end associate
               if (dot_product(n, surface%disc(4:6, facet)) < feature_cosine .and. &
                  & dot_product(x - trial%point, n) <= touching*surface%size(f)) then
                  entered = .true.
               else
                  owned = .false.
               end if
            end do
         end associate
      end do
   end subroutine ask_walls

   !> Beside a wall that a point touches but hardly faces: the facet round an edge that it faces and
   !> is in, 0 for none. So are nodes of a slope that ends flush with a wall.
   pure subroutine find_faced(surface, x, n_slave, wall, cosine, other, foot)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)                 !! [length]
      real(wp), intent(in) :: n_slave(3)
      integer, intent(in) :: wall                  !! facet
      real(wp), intent(in) :: cosine               !! beyond, a facet is not faced [-]
      integer, intent(out) :: other
      type(closest_type), intent(out) :: foot      !! on the other facet
      type(closest_type) :: trial
      real(wp) :: slack(4), gap, best
      integer :: k, f

      other = 0
      best = shallow
      do k = 1, surface%basis%ncorner(surface%facets%cell(wall))
         f = surface%neighbour(k, wall)
         if (f == 0) cycle
         if (dot_product(n_slave, surface%disc(4:6, f)) > well) cycle
         if (dot_product(edge_normal(surface, f, surface%twin(k, wall)), &
            & edge_normal(surface, wall, k)) >= feature_cosine) cycle
         associate (cell => surface%facets%cell(f), c => surface%coefficient(:, :, f))
            slack = slack_beyond(surface, f, n_slave, cosine, flush)
            slack(surface%twin(k, wall)) = 2.0_wp*flush
            call project_on_facet(c, surface%basis%family(cell), surface%basis%centre(:, cell), &
               & slack, x, trial)
            if (trial%place /= place%inside) cycle
            gap = dot_product(x - trial%point, facet_unit_normal(c, surface%basis%family(cell), &
               & trial%xi))/surface%size(f)
         end associate
         if (gap > flush .or. -gap > shallow .or. abs(gap) > best) cycle
         best = abs(gap)
         other = f
         foot = trial
      end do
   end subroutine find_faced

   !> Whether a point touches a facet that it hardly faces.
   pure logical function touches_hardly(surface, facet, n_slave, normal, gap) result(hardly_faced)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: n_slave(3), normal(3)
      real(wp), intent(in) :: gap                  !! [length]

      hardly_faced = dot_product(n_slave, normal) > hardly &
         & .and. abs(gap) <= flush*surface%size(facet)
   end function touches_hardly
end module lopin_flush_walls
