!> Creases of a surface, and the walls that a point meets in a concave one.
!>
!> In a concave corner one closest point is not enough: the point must stay in front of both walls,
!> each continued beyond the crease (the rule of the single minimal gap fails exactly there).
module lopin_crease
   use lopin_kinds, only : wp
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal, edge_ends
   use lopin_facet_basis, only : facet_point_of, shape_values
   use lopin_cells, only : cell_family
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type
   implicit none
   private
   public :: crease_type, find_creases, meet_walls, most_walls

   !> Facets that meet at a larger angle form a crease: 18 degrees, less than the two sides of a
   !> roof of 10 degrees make, more than the joints of a circle of 20 facets.
   real(wp), parameter :: crease_cosine = 0.95105651629515357_wp
   real(wp), parameter :: beyond = 0.5_wp     !! part of a facet by which a wall goes on past it
   real(wp), parameter :: flat = 1.0e-6_wp    !! of a facet: less is rounding
   integer, parameter :: most_walls = 3
   integer, parameter :: most_tried = 24
   integer, parameter :: most_hops = 4        !! from the crease to the foot

   type :: crease_type
      logical, allocatable :: concave(:, :)   !! (4, n) edge is a concave crease
      logical, allocatable :: near(:)         !! (n) such an edge starts at a corner of the facet
      logical, allocatable :: bent(:)   !! (n) a point may have feet inside it and a neighbour
      integer, allocatable :: patch(:)        !! (n) facets joined without crease have the same
   end type crease_type

contains

   !> Creases of the present shape.
   subroutine find_creases(self, surface)
      type(crease_type), intent(out) :: self
      type(surface_type), intent(in) :: surface
      logical, dimension(4, surface%facets%n) :: sharp, bent
      real(wp) :: rise
      integer :: i, k, n

      n = surface%facets%n
      allocate (self%concave(4, n), self%patch(n))
      self%concave = .false.
      sharp = .false.
      bent = .false.
      do i = 1, n
         do k = 1, surface%basis%ncorner(surface%facets%cell(i))
            if (surface%neighbour(k, i) == 0) cycle
            call judge_edge(surface, i, k, sharp(k, i), rise)
            self%concave(k, i) = sharp(k, i) .and. rise > 0.0_wp
            bent(k, i) = abs(rise) > flat .or. any(abs(surface%coefficient(:, 4:, i)) > &
               & flat*surface%size(i))
         end do
      end do
      self%near = around(surface, self%concave)
      self%bent = around(surface, bent)
      call join_patches(self, surface, sharp)
   end subroutine find_creases

   pure subroutine judge_edge(surface, facet, edge, sharp, rise)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet, edge
      logical, intent(out) :: sharp
      real(wp), intent(out) :: rise         !! of the other side in front of this one, relative
      real(wp) :: xi(2), n1(3), n2(3)
      integer :: other, cell, cell2

      other = surface%neighbour(edge, facet)
      cell = surface%facets%cell(facet)
      cell2 = surface%facets%cell(other)
      xi = edge_ends(surface%basis%family(cell), edge, 0.5_wp)
      n1 = facet_unit_normal(surface%coefficient(:, :, facet), surface%basis%family(cell), xi)
      n2 = facet_unit_normal(surface%coefficient(:, :, other), surface%basis%family(cell2), &
         & edge_ends(surface%basis%family(cell2), surface%twin(edge, facet), 0.5_wp))
      sharp = dot_product(n1, n2) < crease_cosine
      rise = dot_product(n1, facet_point_of(surface%coefficient(:, :, other), &
         & surface%basis%centre(:, cell2)) - facet_point_of(surface%coefficient(:, :, facet), &
         & xi))/surface%size(facet)
   end subroutine judge_edge

   !> Facets that have a corner where a marked edge starts.
   pure function around(surface, marked) result(near)
      type(surface_type), intent(in) :: surface
      logical, intent(in) :: marked(:, :)       !! (4, n) edges
      logical :: near(surface%facets%n)
      logical :: node(surface%nnode)
      integer :: i, k, n

      node = .false.
      do i = 1, surface%facets%n
         n = surface%basis%ncorner(surface%facets%cell(i))
         do k = 1, n
            if (.not. marked(k, i)) cycle
            node(surface%local(k, i)) = .true.
            if (n > 2) node(surface%local(1 + mod(k, n), i)) = .true.
         end do
      end do
      do i = 1, surface%facets%n
         n = surface%basis%ncorner(surface%facets%cell(i))
         near(i) = any(node(surface%local(:n, i)))
      end do
   end function around

   subroutine join_patches(self, surface, sharp)
      type(crease_type), intent(inout) :: self
      type(surface_type), intent(in) :: surface
      logical, intent(in) :: sharp(:, :)
      integer :: stack(surface%facets%n), i, k, f, g, top, patch

      self%patch = 0
      patch = 0
      do i = 1, surface%facets%n
         if (self%patch(i) > 0) cycle
         patch = patch + 1
         self%patch(i) = patch
         stack(1) = i
         top = 1
         do while (top > 0)
            f = stack(top)
            top = top - 1
            do k = 1, 4
               g = surface%neighbour(k, f)
               if (g == 0 .or. sharp(k, f)) cycle
               if (self%patch(g) > 0) cycle
               self%patch(g) = patch
               top = top + 1
               stack(top) = g
            end do
         end do
      end do
   end subroutine join_patches

   !> All walls that a point meets near its closest foot: `wall(1)` is that foot on entry.
   !>
   !> A foot on a concave crease is replaced by those on the walls themselves, continued; the
   !> nearest comes first. Walls farther than `reach` are left out.
   pure subroutine meet_walls(self, surface, x, n_slave, limits, reach, wall, nwall, tried)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)              !! [length]
      real(wp), intent(in) :: n_slave(3)        !! 0: any side
      type(limits_type), intent(in) :: limits
      real(wp), intent(in) :: reach             !! [length]
      type(projection_type), intent(inout) :: wall(:)   !! behind `nwall`: no facet
      integer, intent(out) :: nwall
      integer, intent(out) :: tried             !! projections made
      type(projection_type) :: first, one
      integer :: facet(most_tried), n, i

      nwall = min(wall(1)%facet, 1)
      tried = 0
      wall(2:) = projection_type()
      if (nwall == 0 .or. size(wall) == 1) return
      if (.not. self%near(wall(1)%facet)) return
      first = wall(1)
      call gather(self, surface, first, facet, n)
      if (n == 0) return
      if (replaceable(self, surface, first)) nwall = 0
      do i = 1, n
         if (nwall > 0 .and. facet(i) == first%facet) cycle
         tried = tried + 1
         call foot_on_wall(self, surface, facet(i), x, n_slave, limits, one)
         if (one%facet == 0 .or. one%gap > reach) cycle
         call insert(self, one, nwall > 0 .and. wall(1)%facet == first%facet .and. &
            & .not. replaceable(self, surface, first), wall, nwall)
      end do
      if (nwall > 0) return
      wall(1) = first
      nwall = 1
   end subroutine meet_walls

   !> Facets at the foot, and those across concave creases from them.
   pure subroutine gather(self, surface, foot, facet, n)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      type(projection_type), intent(in) :: foot
      integer, intent(out) :: facet(most_tried), n
      integer :: i, j, k, m, node

      facet(1) = foot%facet
      n = 1
      if (foot%kind == place%edge) then
         call add(surface%neighbour(foot%feature, foot%facet), facet, n)
      else if (foot%kind == place%vertex) then
         node = surface%local(foot%feature, foot%facet)
         do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
            call add(surface%ring(i), facet, n)
         end do
      end if
      m = n
      do i = 1, m
         do k = 1, surface%basis%ncorner(surface%facets%cell(facet(i)))
            node = surface%local(k, facet(i))
            do j = surface%ring_first(node), surface%ring_first(node + 1) - 1
               if (self%patch(surface%ring(j)) == self%patch(facet(i))) call cross(self, surface, &
                  & surface%ring(j), facet, n)
            end do
         end do
      end do
      if (n == m .and. .not. any(self%concave(:, facet(:m)))) n = 0
   end subroutine gather

   !> The facets across the concave creases of one.
   pure subroutine cross(self, surface, from, facet, n)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: from
      integer, intent(inout) :: facet(most_tried), n
      integer :: k

      do k = 1, 4
         if (self%concave(k, from)) call add(surface%neighbour(k, from), facet, n)
      end do
   end subroutine cross

   pure subroutine add(f, facet, n)
      integer, intent(in) :: f
      integer, intent(inout) :: facet(most_tried), n

      if (f == 0 .or. n == most_tried) return
      if (any(facet(:n) == f)) return
      n = n + 1
      facet(n) = f
   end subroutine add

   !> A foot on a concave crease, or where only concave creases meet, stands for its walls.
   pure logical function replaceable(self, surface, foot)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      type(projection_type), intent(in) :: foot
      integer :: i, f, node, k, n

      replaceable = .false.
      if (foot%kind == place%edge) replaceable = self%concave(foot%feature, foot%facet)
      if (foot%kind /= place%vertex) return
      node = surface%local(foot%feature, foot%facet)
      replaceable = foot%gap <= 0.0_wp
      do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
         f = surface%ring(i)
         n = surface%basis%ncorner(surface%facets%cell(f))
         do k = 1, n
            if (surface%local(k, f) /= node .or. n > 2) cycle
            replaceable = self%concave(k, f)
         end do
      end do
   end function replaceable

   !> Foot on the wall of a facet, which goes on beyond its concave creases; the foot may lie a few
   !> facets further on the wall.
   pure subroutine foot_on_wall(self, surface, start, x, n_slave, limits, foot)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: start
      real(wp), intent(in) :: x(3), n_slave(3)
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(out) :: foot
      type(closest_type) :: trial
      integer :: cell, facet, hop

      facet = start
      do hop = 1, most_hops
         call project_continued(self, surface, facet, x, trial)
         if (trial%place /= place%edge) exit
         if (self%concave(trial%feature, facet)) return
         if (surface%neighbour(trial%feature, facet) == 0) return
         facet = surface%neighbour(trial%feature, facet)
         if (self%patch(facet) /= self%patch(start)) return
      end do
      if (trial%place == place%vertex) call look_around(self, surface, x, facet, trial)
      if (trial%place /= place%inside) return
      cell = surface%facets%cell(facet)
      foot%normal = facet_unit_normal(surface%coefficient(:, :, facet), &
         & surface%basis%family(cell), trial%xi)
      if (dot_product(foot%normal, n_slave) > limits%cosine .and. any(abs(n_slave) > 0.0_wp)) return
      foot%gap = dot_product(x - trial%point, foot%normal)
      if (foot%gap < -limits%depth) return
      foot%facet = facet
      foot%place = place%inside
      foot%kind = place%inside
      foot%xi = trial%xi
      foot%point = trial%point
      foot%shape = shape_values(surface%basis, cell, trial%xi)
   end subroutine foot_on_wall

   pure subroutine project_continued(self, surface, facet, x, trial)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      real(wp), intent(in) :: x(3)
      type(closest_type), intent(out) :: trial
      real(wp) :: slack(4)
      integer :: cell, family

      cell = surface%facets%cell(facet)
      family = surface%basis%family(cell)
      slack = 0.0_wp
      where (self%concave(:, facet)) slack = beyond
      if (family /= cell_family%triangle) slack = 2.0_wp*slack
      call project_on_facet(surface%coefficient(:, :, facet), family, &
         & surface%basis%centre(:, cell), slack, x, trial)
   end subroutine project_continued

   !> A foot on a vertex: whether a facet of the same wall around it has one inside.
   pure subroutine look_around(self, surface, x, facet, trial)
      type(crease_type), intent(in) :: self
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)
      integer, intent(inout) :: facet
      type(closest_type), intent(inout) :: trial
      integer :: i, node, patch

      node = surface%local(trial%feature, facet)
      patch = self%patch(facet)
      do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
         if (self%patch(surface%ring(i)) /= patch) cycle
         facet = surface%ring(i)
         call project_continued(self, surface, facet, x, trial)
         if (trial%place == place%inside) return
      end do
   end subroutine look_around

   !> One foot for each patch, the nearest of it; patches by distance, after a first that is kept.
   pure subroutine insert(self, one, keep_first, wall, nwall)
      type(crease_type), intent(in) :: self
      type(projection_type), intent(in) :: one
      logical, intent(in) :: keep_first
      type(projection_type), intent(inout) :: wall(:)
      integer, intent(inout) :: nwall
      integer :: i, j, low

      low = merge(2, 1, keep_first)
      do i = 1, nwall
         if (self%patch(wall(i)%facet) /= self%patch(one%facet)) cycle
         if (i < low .or. abs(wall(i)%gap) <= abs(one%gap)) return
         wall(i:nwall - 1) = wall(i + 1:nwall)
         wall(nwall) = projection_type()
         nwall = nwall - 1
         exit
      end do
      do i = low, min(nwall, size(wall))
         if (abs(one%gap) < abs(wall(i)%gap)) exit
      end do
      if (i > size(wall)) return
      do j = min(nwall + 1, size(wall)), i + 1, -1
         wall(j) = wall(j - 1)
      end do
      wall(i) = one
      nwall = min(nwall + 1, size(wall))
   end subroutine insert
end module lopin_crease
