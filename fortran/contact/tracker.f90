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
   use lopin_surface, only : new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : cost_type, build_tree, refit_tree
   use lopin_crease, only : find_creases
   use lopin_self_contact, only : new_self_contact, measure_thickness
   use lopin_track_point, only : tracker_type, search_point, track_point, most_near
   implicit none
   private
   public :: tracker_type, new_tracker, begin, track, commit, restore

contains

   subroutine new_tracker(self, ndim, facets, n, limits, nwall, smooth, own_node)
      type(tracker_type), intent(out) :: self
      integer, intent(in) :: ndim                 !! 2 or 3
      type(facets_type), intent(in) :: facets     !! of the master, outward
      integer, intent(in) :: n                    !! slave points
      type(limits_type), intent(in) :: limits
      integer, intent(in) :: nwall                !! feet of one point, 1..3
      logical, intent(in), optional :: smooth     !! curve linear facets by averaged normals
      integer, intent(in), optional :: own_node(:) !! (n) points are these nodes of the surface: it
                                                  !! meets itself

      call new_surface(self%surface, ndim, facets, smooth)
      self%against_itself = present(own_node)
      if (self%against_itself) call new_self_contact(self%itself, self%surface, own_node)
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
         if (self%against_itself) call measure_thickness(self%itself, self%surface, self%tree, &
            & x_slave, n_slave, self%limits%cosine)
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

end module lopin_tracker
