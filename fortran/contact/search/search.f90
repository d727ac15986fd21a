!> Contact search: the facet that each slave point may meet.
!>
!> A tree of boxes over the facets (Morton order, implicit binary tree, leaves of four) gives the
!> facets near a point; the nearest foot among those that face the point wins, ties go to the
!> lowest facet.
module lopin_search
   use lopin_kinds, only : wp, lk
   use lopin_shared_work, only : shared_work_type, share_out
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type, settle
   implicit none
   private
   public :: tree_type, cost_type, build_tree, refit_tree, find_projection, find_projections
   public :: find_near, disc_distance2, box_distance2, leaf_span, deepest

   integer, parameter :: leaf = 4
   integer, parameter :: deepest = 64        !! entries of the stack; the tree has at most 31 levels
   real(wp), parameter :: turned = 0.5_wp  !! n_slave.axis above which no point of a facet faces it
   real(wp), parameter :: tie = 1.0e-12_wp !! relative rounding of squared distances

   !> Boxes in heap order: children of node k are 2k and 2k+1; the leaves are the last half.
   type :: tree_type
      integer :: n = 0                        !! facets
      integer :: nleaf = 0                    !! power of two
      integer, allocatable :: facet(:)        !! (n) facets in Morton order
      real(wp), allocatable :: low(:, :)      !! (3, 2*nleaf - 1) [length]
      real(wp), allocatable :: high(:, :)     !! the same
   end type tree_type

   !> What a search did, for benchmarks and tests.
   type :: cost_type
      integer(lk) :: query = 0                !! walks through the tree
      integer(lk) :: box = 0                  !! distances to boxes
      integer(lk) :: projection = 0           !! closest points of one facet
   end type cost_type

   !> One point on its way through the tree.
   type :: query_type
      real(wp) :: x(3) = 0.0_wp
      real(wp) :: normal(3) = 0.0_wp
      logical :: sided = .false.
      integer :: facet = 0                    !! the best so far
      type(closest_type) :: best
      integer :: top = 0
      integer :: stack(deepest)
      real(wp) :: distance2(deepest)
      type(cost_type) :: cost
   end type query_type

   type, extends(shared_work_type) :: projections_work_type
      type(surface_type), pointer :: surface => null()
      type(tree_type), pointer :: tree => null()
      real(wp), pointer :: x(:, :) => null(), n_slave(:, :) => null()
      type(limits_type) :: limits
      type(projection_type), pointer :: result(:) => null()
   contains
      procedure :: do_part => project_one
   end type projections_work_type

contains

   !> A tree of the boxes of facets.
   subroutine build_tree(self, low, high)
      type(tree_type), intent(out) :: self
      real(wp), intent(in) :: low(:, :), high(:, :)   !! (3, n) boxes of the facets [length]
      integer(lk), allocatable :: key(:)
      real(wp) :: origin(3), span
      integer :: i

      self%n = size(low, 2)
      self%nleaf = 1
      do while (self%nleaf*leaf < self%n)
         self%nleaf = 2*self%nleaf
      end do
      allocate (self%low(3, 2*self%nleaf - 1), self%high(3, 2*self%nleaf - 1))
      allocate (key(self%n), self%facet(self%n))
      origin = minval(low, dim=2)
      span = maxval(maxval(high, dim=2) - origin)
      if (.not. span > 0.0_wp) span = 1.0_wp
      do i = 1, self%n
         self%facet(i) = i
         key(i) = morton(0.5_wp*(low(:, i) + high(:, i)) - origin, span)
      end do
      call sort_by_key(key, self%facet)
      call refit_tree(self, low, high)
   end subroutine build_tree

   !> Interleave 20 bits of each coordinate.
   pure integer(lk) function morton(x, span)
      real(wp), intent(in) :: x(3)      !! >= 0, <= span [length]
      real(wp), intent(in) :: span
      integer(lk) :: cell(3)
      integer :: bit, k

      cell = int(min(max(x/span, 0.0_wp), 1.0_wp)*1048575.0_wp, lk)
      morton = 0
      do bit = 0, 19
         do k = 1, 3
            if (btest(cell(k), bit)) morton = ibset(morton, 3*bit + k - 1)
         end do
      end do
   end function morton

   !> Merge sort, stable: equal keys keep the order of the facets.
   pure recursive subroutine sort_by_key(key, item)
      integer(lk), intent(inout) :: key(:)
      integer, intent(inout) :: item(:)
      integer(lk), allocatable :: merged_key(:)
      integer, allocatable :: merged(:)
      integer :: n, half, i, j, k, from

      n = size(key)
      if (n < 2) return
      half = n/2
      call sort_by_key(key(:half), item(:half))
      call sort_by_key(key(half + 1:), item(half + 1:))
      if (key(half) <= key(half + 1)) return
      allocate (merged_key(n), merged(n))
      i = 1
      j = half + 1
      do k = 1, n
         if (i > half) then
            from = j
         else if (j > n) then
            from = i
         else
            from = merge(i, j, key(i) <= key(j))
         end if
         merged_key(k) = key(from)
         merged(k) = item(from)
         if (from == i) then
            i = i + 1
         else
            j = j + 1
         end if
      end do
      key = merged_key
      item = merged
   end subroutine sort_by_key

   !> New boxes, same order: enough while facets keep their neighbourhood.
   pure subroutine refit_tree(self, low, high)
      type(tree_type), intent(inout) :: self
      real(wp), intent(in) :: low(:, :), high(:, :)   !! (3, n) [length]
      integer :: i, k, first

      do i = 1, self%nleaf
         k = self%nleaf - 1 + i
         self%low(:, k) = huge(1.0_wp)
         self%high(:, k) = -huge(1.0_wp)
         call leaf_span(self, i, first, k)
         do first = first, k
            self%low(:, self%nleaf - 1 + i) = min(self%low(:, self%nleaf - 1 + i), low(:, &
               & self%facet(first)))
            self%high(:, self%nleaf - 1 + i) = max(self%high(:, self%nleaf - 1 + i), high(:, &
               & self%facet(first)))
         end do
      end do
      do k = self%nleaf - 1, 1, -1
         self%low(:, k) = min(self%low(:, 2*k), self%low(:, 2*k + 1))
         self%high(:, k) = max(self%high(:, 2*k), self%high(:, 2*k + 1))
      end do
   end subroutine refit_tree

   !> Facets of leaf i, spread evenly: self%facet(first:last).
   pure subroutine leaf_span(self, i, first, last)
      type(tree_type), intent(in) :: self
      integer, intent(in) :: i
      integer, intent(out) :: first, last

      first = 1 + int(int(i - 1, lk)*int(self%n, lk)/int(self%nleaf, lk))
      last = int(int(i, lk)*int(self%n, lk)/int(self%nleaf, lk))
   end subroutine leaf_span

   !> The projection of one point; `result%facet` = 0 when nothing is opposite.
   !>
   !> The facets must have been updated (`update_surface`) and the tree built or refitted since.
   pure subroutine find_projection(surface, tree, x, n_slave, limits, result, excluded, cost)
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:)                !! (ndim) [length]
      real(wp), intent(in) :: n_slave(:) !! (ndim) outward unit normal of the slave; 0: any side
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(out) :: result
      integer, intent(in), optional :: excluded(:)   !! facets that do not count
      type(cost_type), intent(inout), optional :: cost
      type(query_type) :: query
      integer :: k

      query%x(:size(x)) = x
      query%normal(:size(n_slave)) = n_slave
      query%sided = any(abs(n_slave) > 0.0_wp)
      query%best%distance2 = 0.25_wp*huge(1.0_wp)
      if (limits%reach < sqrt(query%best%distance2)) query%best%distance2 = limits%reach**2
      if (tree%n > 0) call push(query, tree, 1)
      do while (query%top > 0)
         k = query%stack(query%top)
         query%top = query%top - 1
         if (query%distance2(query%top + 1) > query%best%distance2*(1.0_wp + tie)) cycle
         if (k >= tree%nleaf) then
            call try_leaf(query, surface, tree, k - tree%nleaf + 1, limits, excluded)
         else
            call push_children(query, tree, 2*k, 2*k + 1)
         end if
      end do
      if (query%facet > 0) call settle(surface, query%facet, query%best, query%x, query%normal, &
         & limits, result)
      if (present(cost)) then
         cost%query = cost%query + 1
         cost%box = cost%box + query%cost%box
         cost%projection = cost%projection + query%cost%projection
      end if
   end subroutine find_projection

   pure subroutine push(query, tree, node)
      type(query_type), intent(inout) :: query
      type(tree_type), intent(in) :: tree
      integer, intent(in) :: node

      query%cost%box = query%cost%box + 1
      query%top = query%top + 1
      query%stack(query%top) = node
      query%distance2(query%top) = box_distance2(tree%low(:, node), tree%high(:, node), query%x)
   end subroutine push

   !> The nearer child comes on top.
   pure subroutine push_children(query, tree, one, two)
      type(query_type), intent(inout) :: query
      type(tree_type), intent(in) :: tree
      integer, intent(in) :: one, two
      real(wp) :: d1, d2

      query%cost%box = query%cost%box + 2
      d1 = box_distance2(tree%low(:, one), tree%high(:, one), query%x)
      d2 = box_distance2(tree%low(:, two), tree%high(:, two), query%x)
      query%stack(query%top + 1) = merge(two, one, d1 <= d2)
      query%distance2(query%top + 1) = max(d1, d2)
      query%stack(query%top + 2) = merge(one, two, d1 <= d2)
      query%distance2(query%top + 2) = min(d1, d2)
      query%top = query%top + 2
   end subroutine push_children

   pure subroutine try_leaf(query, surface, tree, i, limits, excluded)
      type(query_type), intent(inout) :: query
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      integer, intent(in) :: i                   !! leaf
      type(limits_type), intent(in) :: limits
      integer, intent(in), optional :: excluded(:)
      integer :: first, last, j, n, next
      real(wp) :: bound(leaf)

      call leaf_span(tree, i, first, last)
      n = last - first + 1
      do j = 1, n
         bound(j) = disc_distance2(surface%disc(:, tree%facet(first + j - 1)), query%x)
      end do
      do j = 1, n
         next = minloc(bound(:n), dim=1)
         if (bound(next) > query%best%distance2*(1.0_wp + tie)) return
         call try_facet(query, surface, tree%facet(first + next - 1), limits, excluded)
         bound(next) = huge(1.0_wp)
      end do
   end subroutine try_leaf

   pure subroutine try_facet(query, surface, f, limits, excluded)
      type(query_type), intent(inout) :: query
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: f
      type(limits_type), intent(in) :: limits
      integer, intent(in), optional :: excluded(:)
      type(closest_type) :: trial
      type(projection_type) :: settled
      integer :: family
      real(wp) :: n(3), cosine
      real(wp), parameter :: none(4) = 0.0_wp

      if (present(excluded)) then
         if (any(excluded == f)) return
      end if
      cosine = dot_product(surface%disc(4:6, f), query%normal)
      if (cosine > turned) return
      if (surface%flat(f) .and. query%sided .and. cosine > limits%cosine) return
      family = surface%basis%family(surface%facets%cell(f))
      query%cost%projection = query%cost%projection + 1
      call project_on_facet(surface%coefficient(:, :, f), family, &
         & surface%basis%centre(:, surface%facets%cell(f)), none, query%x, trial)
      if (trial%place == place%none) return
      if (trial%distance2 > query%best%distance2*(1.0_wp + tie)) return
      if (trial%distance2 >= query%best%distance2*(1.0_wp - tie) .and. query%facet > 0 &
         & .and. f > query%facet) return
      n = facet_unit_normal(surface%coefficient(:, :, f), family, trial%xi)
      if (query%sided .and. dot_product(query%normal, n) > limits%cosine) return
      if (dot_product(query%x - trial%point, n) < -limits%depth) return
      if (limits%behind) then
         if (dot_product(query%x - trial%point, n) >= -limits%shallow) return
         if (trial%place /= place%inside) then
            ! Which side of an edge or a corner is told by all the facets around it.
            call settle(surface, f, trial, query%x, query%normal, limits, settled)
            if (settled%facet == 0 .or. settled%gap >= -limits%shallow) return
         end if
      end if
      query%best = trial
      query%facet = f
   end subroutine try_facet

   !> Squared distance of a point to a box, 0 inside [length^2].
   pure real(wp) function box_distance2(low, high, x)
      real(wp), intent(in) :: low(3), high(3), x(3)
      real(wp) :: d(3)

      d = max(low - x, x - high, 0.0_wp)
      box_distance2 = d(1)*d(1) + d(2)*d(2) + d(3)*d(3)
   end function box_distance2

   !> Squared distance to the disc that holds a facet: a lower bound of that to the facet.
   pure real(wp) function disc_distance2(disc, x)
      real(wp), intent(in) :: disc(8), x(3)
      real(wp) :: arm(3), height, beside

      arm = x - disc(1:3)
      height = arm(1)*disc(4) + arm(2)*disc(5) + arm(3)*disc(6)
      beside = sqrt(max(arm(1)*arm(1) + arm(2)*arm(2) + arm(3)*arm(3) - height*height, 0.0_wp))
      disc_distance2 = max(abs(height) - disc(8), 0.0_wp)**2 + max(beside - disc(7), 0.0_wp)**2
   end function disc_distance2

   !> Facets whose discs come within a radius of a point, on the side that the slave may face.
   pure subroutine find_near(surface, tree, x, n_slave, radius, list, n, cost)
      type(surface_type), intent(in) :: surface
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(3)                !! [length]
      real(wp), intent(in) :: n_slave(3)          !! unit; 0: any side
      real(wp), intent(in) :: radius              !! [length]
      integer, intent(out) :: list(:)             !! the first ones, in the order of the tree
      integer, intent(out) :: n                   !! how many there are, perhaps more than fit
      type(cost_type), intent(inout) :: cost
      integer :: stack(deepest), top, k, j, last, f

      n = 0
      top = min(tree%n, 1)
      stack(1) = 1
      do while (top > 0)
         k = stack(top)
         top = top - 1
         cost%box = cost%box + 1
         if (box_distance2(tree%low(:, k), tree%high(:, k), x) > radius**2) cycle
         if (k < tree%nleaf) then
            stack(top + 1:top + 2) = [2*k + 1, 2*k]
            top = top + 2
            cycle
         end if
         call leaf_span(tree, k - tree%nleaf + 1, j, last)
         do j = j, last
            f = tree%facet(j)
            if (disc_distance2(surface%disc(:, f), x) > radius**2) cycle
            if (dot_product(surface%disc(4:6, f), n_slave) > turned) cycle
            n = n + 1
            if (n <= size(list)) list(n) = f
         end do
      end do
   end subroutine find_near

   !> The projections of many points, in parallel; the answers do not depend on the number of
   !> threads.
   subroutine find_projections(surface, tree, x, n_slave, limits, result)
      type(surface_type), intent(in), target :: surface
      type(tree_type), intent(in), target :: tree
      real(wp), intent(in), target :: x(:, :)      !! (ndim, n) [length]
      real(wp), intent(in), target :: n_slave(:, :)   !! (ndim, n) outward unit normals; 0: any
                                                      !! side
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(out), target :: result(:)   !! (n)
      type(projections_work_type) :: work

      work%surface => surface
      work%tree => tree
      work%x => x
      work%n_slave => n_slave
      work%limits = limits
      work%result => result
      call share_out(work, [1, size(x, 2) + 1])
   end subroutine find_projections

   subroutine project_one(self, k)
      class(projections_work_type), intent(inout) :: self
      integer, intent(in) :: k             !! the point

      call find_projection(self%surface, self%tree, self%x(:, k), self%n_slave(:, k), &
         & self%limits, self%result(k))
   end subroutine project_one
end module lopin_search
