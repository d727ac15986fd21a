!> The feet of slave points on a surface that moves, from increment to increment.
!>
!> `begin` searches globally from the accepted state and notes for each point the facets that it
!> may reach; `track` projects again on the last facet, walks over edges, and asks those facets
!> whether one came nearer. Only when the motion since `begin` passes the pad is the tree asked
!> again. In a concave crease a point has one foot on each wall. Histories change with `commit`.
module lopin_tracker
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_facets, only : facets_type
   use lopin_projection, only : closest_type, place, facet_unit_normal
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type, settle
   use lopin_search, only : tree_type, cost_type, build_tree, refit_tree, find_projection, &
      & find_near, disc_distance2
   use lopin_crease, only : crease_type, find_creases, meet_walls
   use lopin_follow, only : follow_foot, foot_on, share_node
   implicit none
   private
   public :: tracker_type, new_tracker, begin, track, commit, restore

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
      logical, private :: fresh = .true.    !! there is no tree yet
      logical, private :: asleep = .false.
      real(wp), private :: pad = 0.0_wp     !! motion that the notes allow [length]
      real(wp), allocatable :: node_start(:, :)   !! (3, nnode) at the search [length]
      real(wp), private, allocatable :: start(:, :)        !! (3, n) points at the search [length]
      real(wp), private, allocatable :: distance(:)        !! (n) found by it [length]
      integer, private, allocatable :: near(:, :)          !! (most_near, n) facets noted
      integer, allocatable :: nnear(:)            !! (n)
   end type tracker_type

contains

   subroutine new_tracker(self, ndim, facets, n, limits, nwall)
      type(tracker_type), intent(out) :: self
      integer, intent(in) :: ndim                 !! 2 or 3
      type(facets_type), intent(in) :: facets     !! of the master, outward
      integer, intent(in) :: n                    !! slave points
      type(limits_type), intent(in) :: limits
      integer, intent(in) :: nwall                !! feet of one point, 1..3

      call new_surface(self%surface, ndim, facets)
      self%limits = limits
      self%n = n
      self%nwall = nwall
      allocate (self%memory%facet(nwall, n), source=0)
      allocate (self%memory%xi(2, n), source=0.0_wp)
      allocate (self%memory%first(n), source=1)
      self%committed = self%memory
      allocate (self%node_start(3, self%surface%nnode), self%start(3, n), source=0.0_wp)
      allocate (self%distance(n), source=0.0_wp)
      allocate (self%near(most_near, n), self%nnear(n), source=0)
   end subroutine new_tracker

   !> Keep where the feet are now; `restore` and `begin` go back to it.
   subroutine commit(self)
      type(tracker_type), intent(inout) :: self
      self%committed = self%memory
   end subroutine commit

   subroutine restore(self)
      type(tracker_type), intent(inout) :: self
      self%memory = self%committed
   end subroutine restore

   !> Search all feet in the accepted state, for an increment that may travel so far.
   subroutine begin(self, x, x_slave, n_slave, travel, result, error)
      type(tracker_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, all mesh nodes) present [length]
      real(wp), intent(in) :: x_slave(:, :)    !! (ndim, n) [length]
      real(wp), intent(in) :: n_slave(:, :)    !! (ndim, n) outward unit normals; 0: any side
      real(wp), intent(in) :: travel           !! expected in the increment, either body [length]
      type(projection_type), intent(out) :: result(:, :)   !! (nwall, n)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: mean

      call restore(self)
      call update_surface(self%surface, x, error)
      if (allocated(error)) return
      call find_creases(self%crease, self%surface)
      mean = sum(self%surface%size)/real(max(1, self%surface%facets%n), wp)
      self%pad = max(mean, 2.0_wp*travel)
      call search_all(self, x, x_slave, n_slave, result)
   end subroutine begin

   !> Feet of the same points in a trial state.
   subroutine track(self, x, x_slave, n_slave, result, error)
      type(tracker_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, all mesh nodes) present [length]
      real(wp), intent(in) :: x_slave(:, :)    !! (ndim, n) [length]
      real(wp), intent(in) :: n_slave(:, :)    !! (ndim, n) outward unit normals; 0: any side
      type(projection_type), intent(out) :: result(:, :)   !! (nwall, n)
      type(error_type), allocatable, intent(out) :: error
      logical :: done(self%n)
      real(wp) :: motion
      integer(lk) :: hops, projections
      integer :: i, k, m

      motion = node_motion(self, x) + point_motion(self, x_slave)
      if (self%asleep .and. motion <= self%pad) then
         self%counts%asleep = self%counts%asleep + 1
         return
      end if
      call update_surface(self%surface, x, error)
      if (allocated(error)) return
      if (motion > self%pad) then
         call search_all(self, x, x_slave, n_slave, result)
         return
      end if
      hops = 0
      projections = 0
      !$omp parallel do schedule(static, 64) default(shared) private(i, k, m) &
      !$omp & reduction(+: hops, projections)
      do i = 1, self%n
         call track_point(self, i, padded(x_slave(:, i)), padded(n_slave(:, i)), motion, &
            & result(:, i), k, m, done(i))
         hops = hops + k
         projections = projections + m
      end do
      !$omp end parallel do
      self%counts%hops = self%counts%hops + hops
      self%counts%projection = self%counts%projection + projections
      self%counts%tracked = self%counts%tracked + count(done)
      if (all(done)) return
      call refit_tree(self%tree, self%surface%low, self%surface%high)
      call search_points(self, x_slave, n_slave, .not. done, .false., result)
   end subroutine track

   pure function padded(x) result(y)
      real(wp), intent(in) :: x(:)
      real(wp) :: y(3)
      y = 0.0_wp
      y(:size(x)) = x
   end function padded

   !> Farthest that a node of the surface has moved since the search.
   pure real(wp) function node_motion(self, x) result(motion)
      type(tracker_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)
      integer :: i

      motion = 0.0_wp
      do i = 1, self%surface%nnode
         motion = max(motion, sum((padded(x(:, self%surface%node(i))) - self%node_start(:, i))**2))
      end do
      motion = sqrt(motion)
   end function node_motion

   pure real(wp) function point_motion(self, x_slave) result(motion)
      type(tracker_type), intent(in) :: self
      real(wp), intent(in) :: x_slave(:, :)
      integer :: i

      motion = 0.0_wp
      do i = 1, self%n
         motion = max(motion, sum((padded(x_slave(:, i)) - self%start(:, i))**2))
      end do
      motion = sqrt(motion)
   end function point_motion

   !> Ask the tree for every point, unless the whole surface is too far from all of them.
   subroutine search_all(self, x, x_slave, n_slave, result)
      type(tracker_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :), x_slave(:, :), n_slave(:, :)
      type(projection_type), intent(out) :: result(:, :)
      logical :: every(self%n)
      integer :: i

      do i = 1, self%surface%nnode
         self%node_start(:, i) = padded(x(:, self%surface%node(i)))
      end do
      do i = 1, self%n
         self%start(:, i) = padded(x_slave(:, i))
      end do
      self%counts%box = self%counts%box + 1
      self%asleep = self%n == 0 .or. self%surface%facets%n == 0
      if (.not. self%asleep) self%asleep = box_gap(self) > 2.0_wp*self%pad
      if (self%asleep) then
         self%counts%asleep = self%counts%asleep + 1
         self%memory%facet = 0
         return
      end if
      if (self%fresh) then
         call build_tree(self%tree, self%surface%low, self%surface%high)
      else
         call refit_tree(self%tree, self%surface%low, self%surface%high)
      end if
      self%fresh = .false.
      every = .true.
      call search_points(self, x_slave, n_slave, every, .true., result)
   end subroutine search_all

   !> Distance between the box of the points and that of the surface.
   pure real(wp) function box_gap(self)
      type(tracker_type), intent(in) :: self

      box_gap = norm2(max(0.0_wp, &
         & minval(self%start, dim=2) - maxval(self%surface%high, dim=2), &
         & minval(self%surface%low, dim=2) - maxval(self%start, dim=2)))
   end function box_gap

   subroutine search_points(self, x_slave, n_slave, wanted, note, result)
      type(tracker_type), intent(inout) :: self
      real(wp), intent(in) :: x_slave(:, :), n_slave(:, :)
      logical, intent(in) :: wanted(:)
      logical, intent(in) :: note              !! also the facets that may be reached
      type(projection_type), intent(inout) :: result(:, :)
      integer(lk) :: boxes, projections, queries
      type(cost_type) :: cost
      integer :: i

      boxes = 0
      projections = 0
      queries = 0
      !$omp parallel do schedule(dynamic, 64) default(shared) private(i, cost) &
      !$omp & reduction(+: boxes, projections, queries)
      do i = 1, self%n
         if (.not. wanted(i)) cycle
         cost = cost_type()
         call search_point(self, i, padded(x_slave(:, i)), padded(n_slave(:, i)), note, &
            & result(:, i), cost)
         boxes = boxes + cost%box
         projections = projections + cost%projection
         queries = queries + cost%query
      end do
      !$omp end parallel do
      self%counts%box = self%counts%box + boxes
      self%counts%projection = self%counts%projection + projections
      self%counts%query = self%counts%query + queries
   end subroutine search_points

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
      call find_projection(self%surface, self%tree, x, n_slave, self%limits, found, cost=cost)
      if (found%facet > 0 .and. found%gap < 0.0_wp .and. .not. known) &
         & call refuse_from_behind(self, x, found, cost)
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
      if (lost .or. .not. faces(self, facet, closest, n_slave)) return
      if (sqrt(closest%distance2) > (self%distance(i) + motion)*(1.0_wp + 1.0e-9_wp)) return
      call settle(self%surface, facet, closest, x, sided, self%limits, result(1))
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
         if (f == facet) cycle
         if (disc_distance2(self%surface%disc(:, f), x) >= closest%distance2) cycle
         if (.not. self%crease%bent(facet)) then
            if (share_node(self%surface, f, facet)) cycle
         end if
         call foot_on(self%surface, f, x, 0.0_wp, &
            & self%surface%basis%centre(:, self%surface%facets%cell(f)), trial)
         projections = projections + 1
         found = trial%place /= place%none .and. trial%distance2 < closest%distance2
         if (found) found = faces(self, f, trial, n_slave)
         if (.not. found) cycle
         facet = f
         xi = trial%xi
         return
      end do
   end subroutine look_for_nearer

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
      call meet_walls(self%crease, self%surface, x, n_slave, self%limits, self%pad, wall, nwall, &
         & tried)
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
end module lopin_tracker
