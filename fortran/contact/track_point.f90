!> One slave point of a tracker: searched through the tree, or followed from its last facet.
module lopin_track_point
   use lopin_kinds, only : wp, lk
   use lopin_projection, only : closest_type, place, facet_unit_normal
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type, settle
   use lopin_search, only : tree_type, cost_type, find_projection, find_near, disc_distance2
   use lopin_crease, only : crease_type, meet_walls
   use lopin_self_contact, only : self_contact_type
   use lopin_follow, only : follow_foot, foot_on, share_node
   implicit none
   private
   public :: tracker_type, search_point, track_point, most_near

   integer, parameter :: most_turns = 4     !! walks from one foot, each from a nearer facet
   integer, parameter :: most_near = 128    !! facets noted for one point; more: the tree is asked

   !> What the tracker did since it was made.
   type :: counts_type
      integer(lk) :: asleep = 0             !! calls of a pair too far apart to look at its points
      integer(lk) :: tracked = 0            !! points answered from their last facet
      integer(lk) :: hops = 0               !! facets walked over
      integer(lk) :: query = 0              !! points answered by the tree
      integer(lk) :: projection = 0         !! closest points of one facet
      integer(lk) :: box = 0                !! distances to boxes
   end type counts_type

   !> Where the feet of all points were.
   type :: memory_type
      integer, allocatable :: facet(:, :)   !! (nwall, n) 0: none
      real(wp), allocatable :: xi(:, :)     !! (2, n) on the facet of the first foot
      integer, allocatable :: first(:)      !! (n) which of them is the closest one
   end type memory_type

   type :: tracker_type
      type(surface_type) :: surface
      type(tree_type) :: tree
      type(crease_type) :: crease
      type(limits_type) :: limits
      type(counts_type) :: counts
      integer :: n = 0                      !! slave points
      integer :: nwall = 1                  !! feet of one point
      type(memory_type) :: memory           !! of the trial state
      type(memory_type) :: committed
      logical :: against_itself = .false.
      type(self_contact_type) :: itself
      logical :: fresh = .true.    !! there is no tree yet
      logical :: asleep = .false.
      real(wp) :: pad = 0.0_wp     !! motion that the notes allow [length]
      real(wp), allocatable :: node_start(:, :)   !! (3, nnode) at the search [length]
      real(wp), allocatable :: start(:, :)        !! (3, n) points at the search [length]
      real(wp), allocatable :: distance(:)        !! (n) found by it [length]
      integer, allocatable :: near(:, :)          !! (most_near, n) facets noted
      integer, allocatable :: nnear(:)            !! (n)
   end type tracker_type

contains

   subroutine search_point(self, i, x, n_slave, note, result, cost)
      type(tracker_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: x(3), n_slave(3)
      logical, intent(in) :: note
      type(projection_type), intent(out) :: result(:)
      type(cost_type), intent(inout) :: cost
      type(projection_type) :: found
      integer :: tried
      logical :: known

      known = any(self%committed%facet(:, i) > 0)
      if (self%against_itself) then
         call find_projection(self%surface, self%tree, x, n_slave, limits_of(self, i), found, &
            & self%itself%neighbour(self%itself%first(i):self%itself%first(i + 1) - 1), cost)
      else
         call find_projection(self%surface, self%tree, x, n_slave, self%limits, found, cost=cost)
         if (found%facet > 0 .and. found%gap < 0.0_wp .and. .not. known) &
            & call refuse_from_behind(self, x, found, cost)
      end if
      result(1) = found
      if (note) then
         self%nnear(i) = 0
         self%distance(i) = huge(1.0_wp)
         if (found%facet > 0) then
            self%distance(i) = norm2(x - found%point)
            if (self%distance(i) <= self%pad) call find_near(self%surface, self%tree, x, &
               & n_slave, self%distance(i) + 2.0_wp*self%pad, self%near(:, i), self%nnear(i), cost)
         end if
      end if
      call take_walls(self, i, x, n_slave, result, tried)
      cost%projection = cost%projection + tried
   end subroutine search_point

   !> Against itself no point may enter deeper than half of its own wall.
   pure type(limits_type) function limits_of(self, i) result(limits)
      type(tracker_type), intent(in) :: self
      integer, intent(in) :: i

      limits = self%limits
      if (self%against_itself) limits%depth = min(limits%depth, self%itself%depth(i))
   end function limits_of

   !> Facets that a point cannot meet: those that hold it.
   pure logical function holds(self, i, facet)
      type(tracker_type), intent(in) :: self
      integer, intent(in) :: i, facet

      holds = .false.
      if (self%against_itself) holds = any(self%itself%neighbour(self%itself%first(i): &
         & self%itself%first(i + 1) - 1) == facet)
   end function holds

   !> A point first seen behind a face counts as penetrating only if it is inside the body: the
   !> nearest face of any side must also be in front of it.
   pure subroutine refuse_from_behind(self, x, found, cost)
      type(tracker_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      type(projection_type), intent(inout) :: found
      type(cost_type), intent(inout) :: cost
      type(projection_type) :: any_side
      real(wp), parameter :: none(3) = 0.0_wp

      call find_projection(self%surface, self%tree, x, none, self%limits, any_side, cost=cost)
      if (any_side%facet == 0 .or. any_side%gap <= 0.0_wp) return
      found = projection_type()
   end subroutine refuse_from_behind

   !> Project again on the last facet, walk, and compare with the facets noted; `done` is false
   !> when only the tree can tell.
   subroutine track_point(self, i, x, n_slave, motion, result, hops, projections, done)
      type(tracker_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: x(3), n_slave(3), motion
      type(projection_type), intent(inout) :: result(:)
      integer, intent(out) :: hops, projections
      logical, intent(out) :: done
      type(closest_type) :: closest
      real(wp) :: xi(2)
      integer :: facet, tried, k, turn
      logical :: lost, sided

      hops = 0
      projections = 0
      done = .false.
      facet = self%memory%facet(self%memory%first(i), i)
      if (facet == 0 .or. self%nnear(i) > most_near) return
      sided = any(abs(n_slave) > 0.0_wp)
      xi = self%memory%xi(:, i)
      do turn = 1, most_turns
         call follow_foot(self%surface, x, facet, xi, closest, k, projections, lost)
         hops = hops + k
         if (lost) return
         call look_for_nearer(self, i, x, n_slave, facet, closest, xi, projections, lost)
         if (.not. lost) exit
      end do
      if (lost .or. holds(self, i, facet) .or. .not. faces(self, facet, closest, n_slave)) return
      if (sqrt(closest%distance2)*(1.0_wp - 1.0e-9_wp) > self%distance(i) + motion) return
      call settle(self%surface, facet, closest, x, sided, limits_of(self, i), result(1))
      if (result(1)%facet == 0) return
      call take_walls(self, i, x, n_slave, result, tried)
      projections = projections + tried
      done = .true.
   end subroutine track_point

   pure logical function faces(self, facet, closest, n_slave)
      type(tracker_type), intent(in) :: self
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: n_slave(3)

      associate (surface => self%surface)
         faces = dot_product(n_slave, facet_unit_normal(surface%coefficient(:, :, facet), &
            & surface%basis%family(surface%facets%cell(facet)), closest%xi)) <= self%limits%cosine
      end associate
      faces = faces .or. .not. any(abs(n_slave) > 0.0_wp)
   end function faces

   !> Whether another facet noted for the point came nearer, and where; on a flat or convex ring
   !> the walk has seen it.
   pure subroutine look_for_nearer(self, i, x, n_slave, facet, closest, xi, projections, &
      & found)
      type(tracker_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: x(3), n_slave(3)
      integer, intent(inout) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(inout) :: xi(2)
      integer, intent(inout) :: projections
      logical, intent(out) :: found
      type(closest_type) :: trial
      integer :: k, f

      found = .false.
      do k = 1, self%nnear(i)
         f = self%near(k, i)
         if (f == facet .or. holds(self, i, f)) cycle
         if (disc_distance2(self%surface%disc(:, f), x) >= closest%distance2) cycle
         if (.not. self%crease%bent(facet)) then
            if (share_node(self%surface, f, facet)) cycle
         end if
         call foot_on(self%surface, f, x, 0.0_wp, &
            & self%surface%basis%centre(:, self%surface%facets%cell(f)), trial)
         projections = projections + 1
         found = trial%place /= place%none .and. trial%distance2 < closest%distance2
         if (found) found = faces(self, f, trial, n_slave)
         if (found .and. self%against_itself) found = not_through(self, i, f, x, trial)
         if (.not. found) cycle
         facet = f
         xi = trial%xi
         return
      end do
   end subroutine look_for_nearer

   !> The point is not deeper behind the facet than half of its own wall.
   pure logical function not_through(self, i, facet, x, closest)
      type(tracker_type), intent(in) :: self
      integer, intent(in) :: i, facet
      real(wp), intent(in) :: x(3)
      type(closest_type), intent(in) :: closest

      not_through = dot_product(x - closest%point, &
         & facet_unit_normal(self%surface%coefficient(:, :, facet), &
         & self%surface%basis%family(self%surface%facets%cell(facet)), closest%xi)) >= &
         & -self%itself%depth(i)
   end function not_through

   !> The other walls of a crease, each in the place where its patch was before.
   subroutine take_walls(self, i, x, n_slave, result, tried)
      type(tracker_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: x(3), n_slave(3)
      type(projection_type), intent(inout) :: result(:)
      integer, intent(out) :: tried
      type(projection_type) :: wall(self%nwall)
      integer :: nwall, k, place_of(self%nwall)

      wall = projection_type()
      wall(1) = result(1)
      nwall = merge(1, self%nwall, self%against_itself)
      call meet_walls(self%crease, self%surface, x, n_slave, self%limits, self%pad, &
         & wall(:nwall), nwall, tried)
      result = projection_type()
      if (nwall == 0) then
         self%memory%facet(:, i) = 0
         self%memory%first(i) = 1
         return
      end if
      call keep_places(self, i, wall, nwall, place_of)
      do k = 1, nwall
         result(place_of(k)) = wall(k)
      end do
      self%memory%facet(:, i) = result%facet
      self%memory%first(i) = place_of(1)
      self%memory%xi(:, i) = wall(1)%xi
   end subroutine take_walls

   pure subroutine keep_places(self, i, wall, nwall, place_of)
      type(tracker_type), intent(in) :: self
      integer, intent(in) :: i, nwall
      type(projection_type), intent(in) :: wall(:)
      integer, intent(out) :: place_of(:)
      integer :: k, j, before

      place_of = 0
      do k = 1, nwall
         do j = 1, self%nwall
            before = self%memory%facet(j, i)
            if (before == 0 .or. any(place_of == j)) cycle
            if (self%crease%patch(before) /= self%crease%patch(wall(k)%facet)) cycle
            place_of(k) = j
            exit
         end do
      end do
      do k = 1, nwall
         if (place_of(k) > 0) cycle
         do j = 1, self%nwall
            if (any(place_of == j)) cycle
            place_of(k) = j
            exit
         end do
      end do
   end subroutine keep_places
end module lopin_track_point
