!> Graphs of symmetric matrices: neighbours, indistinguishable vertices, elimination forests.
!>
!> Vertices are 1-based; vertex v has the neighbours `adjacent(ptr(v):ptr(v + 1) - 1)`, itself not
!> among them. Degrees of freedom of one node have equal neighbours, so that a graph is first
!> compressed into groups (nodes), ordered, and expanded: ordering is several times cheaper.
module lopin_graph
   use lopin_kinds, only : ik, lk
   use lopin_csc, only : csc_type
   implicit none
   private
   public :: node_graph_type, number_interior, neighbours, expand, postorder

   !> The graph of some equations of a matrix, and the same by groups of equal neighbours.
   type :: node_graph_type
      integer, allocatable :: equation(:)                 !! (m) vertex -> equation
      integer, allocatable :: ptr(:), adjacent(:)         !! graph of the equations
      integer :: ngroup = 0
      integer, allocatable :: group(:)                    !! (m) vertex -> group
      integer, allocatable :: group_ptr(:), group_adjacent(:), weight(:)   !! graph of the groups
   contains
      procedure :: new => new_node_graph
      procedure :: equations_by
   end type node_graph_type

contains

   !> Graph of the equations numbered in `local` (1..m, ascending), 0 for those left out.
   subroutine new_node_graph(self, a, local, m)
      class(node_graph_type), intent(out) :: self
      type(csc_type), intent(in) :: a      !! symmetric_lower
      integer, intent(in) :: local(:)      !! (n)
      integer, intent(in) :: m
      integer :: i

      self%equation = pack([(i, i=1, a%n)], local > 0)
      call neighbours(a, local, m, self%ptr, self%adjacent)
      call compress(self%ptr, self%adjacent, self%group, self%ngroup)
      call quotient(self%ptr, self%adjacent, self%group, self%ngroup, self%group_ptr, &
         & self%group_adjacent, self%weight)
   end subroutine new_node_graph

   !> The equations in an order of the groups.
   pure function equations_by(self, group_order) result(order)
      class(node_graph_type), intent(in) :: self
      integer, intent(in) :: group_order(:)   !! (ngroup) new -> old
      integer :: order(size(self%group))      !! (m) new -> equation

      call expand(self%group, group_order, order)
      order = self%equation(order)
   end function equations_by

   !> Number the equations not in `last`: local(i) = 1..m in ascending order, 0 for the last ones.
   pure subroutine number_interior(n, last, local, m, valid)
      integer, intent(in) :: n
      integer, intent(in) :: last(:)                !! 1-based, distinct
      integer, allocatable, intent(out) :: local(:) !! (n)
      integer, intent(out) :: m
      logical, intent(out) :: valid                 !! every one of `last` in range and named once
      integer :: i

      allocate (local(n), source=1)
      valid = all(last >= 1 .and. last <= n)
      m = 0
      if (.not. valid) return
      local(last) = 0
      valid = count(local == 0) == size(last)
      do i = 1, n
         if (local(i) == 0) cycle
         m = m + 1
         local(i) = m
      end do
   end subroutine number_interior

   !> Adjacency of the m equations numbered in `local`, from a lower triangle.
   pure subroutine neighbours(a, local, m, ptr, adjacent)
      type(csc_type), intent(in) :: a               !! symmetric_lower
      integer, intent(in) :: local(:)               !! (n) 1..m, or 0 for equations left out
      integer, intent(in) :: m
      integer, allocatable, intent(out) :: ptr(:)   !! (m+1)
      integer, allocatable, intent(out) :: adjacent(:)
      integer, allocatable :: at(:)
      integer :: i, j, k, column

      allocate (ptr(m + 1), at(m + 1))
      at = 0
      do column = 1, a%n
         j = local(column)
         if (j == 0) cycle
         do k = a%colptr(column) + 1, a%colptr(column + 1)
            i = local(a%row(k) + 1)
            if (i == 0 .or. i == j) cycle
            at(i) = at(i) + 1
            at(j) = at(j) + 1
         end do
      end do
      ptr(1) = 1
      do i = 1, m
         ptr(i + 1) = ptr(i) + at(i)
         at(i) = ptr(i)
      end do
      allocate (adjacent(ptr(m + 1) - 1))
      do column = 1, a%n
         j = local(column)
         if (j == 0) cycle
         do k = a%colptr(column) + 1, a%colptr(column + 1)
            i = local(a%row(k) + 1)
            if (i == 0 .or. i == j) cycle
            adjacent(at(i)) = j
            at(i) = at(i) + 1
            adjacent(at(j)) = i
            at(j) = at(j) + 1
         end do
      end do
   end subroutine neighbours

   !> Group the vertices whose closed neighbourhoods are equal.
   pure subroutine compress(ptr, adjacent, group, ngroup)
      integer, intent(in) :: ptr(:), adjacent(:)
      integer, allocatable, intent(out) :: group(:) !! (m) 1..ngroup, ascending by first member
      integer, intent(out) :: ngroup
      integer, allocatable :: first(:), next(:), stamp(:)
      integer(lk), allocatable :: hash(:)
      integer :: m, v, r, k, bucket
      logical :: equal

      m = size(ptr) - 1
      allocate (group(m), next(m), stamp(m), hash(m), first(max(1, m)))
      group = 0
      stamp = 0
      first = 0
      ngroup = 0
      do v = 1, m
         hash(v) = mixed(v)
         do k = ptr(v), ptr(v + 1) - 1
            hash(v) = hash(v) + mixed(adjacent(k))
         end do
         bucket = int(mod(hash(v), int(m, lk))) + 1
         r = first(bucket)
         do while (r /= 0)
            equal = hash(r) == hash(v)
            if (equal) call compare(ptr, adjacent, r, v, stamp, equal)
            if (equal) exit
            r = next(r)
         end do
         if (r /= 0) then
            group(v) = group(r)
            cycle
         end if
         ngroup = ngroup + 1
         group(v) = ngroup
         next(v) = first(bucket)
         first(bucket) = v
      end do
   end subroutine compress

   !> Spreads vertex numbers, so that sums over neighbourhoods seldom collide.
   elemental integer(lk) function mixed(i)
      integer, intent(in) :: i
      mixed = mod(int(i, lk)*2654435761_lk, 2147483647_lk)
   end function mixed

   !> Equal degrees, and the closed neighbourhood of r (stamped with v) is that of v.
   pure subroutine compare(ptr, adjacent, r, v, stamp, equal)
      integer, intent(in) :: ptr(:), adjacent(:), r, v
      integer, intent(inout) :: stamp(:)
      logical, intent(out) :: equal

      equal = ptr(r + 1) - ptr(r) == ptr(v + 1) - ptr(v)
      if (.not. equal) return
      if (stamp(v) /= v) then
         stamp(v) = v
         stamp(adjacent(ptr(v):ptr(v + 1) - 1)) = v
      end if
      equal = stamp(r) == v
      if (equal) equal = all(stamp(adjacent(ptr(r):ptr(r + 1) - 1)) == v)
   end subroutine compare

   !> The graph of the groups and the number of members of each.
   pure subroutine quotient(ptr, adjacent, group, ngroup, qptr, qadjacent, weight)
      integer, intent(in) :: ptr(:), adjacent(:), group(:)
      integer, intent(in) :: ngroup
      integer, allocatable, intent(out) :: qptr(:), qadjacent(:)
      integer, allocatable, intent(out) :: weight(:)   !! (ngroup)
      integer, allocatable :: stamp(:), member(:)
      integer :: v, g, k, h, n

      allocate (qptr(ngroup + 1), qadjacent(size(adjacent)), weight(ngroup), stamp(ngroup), &
         & member(ngroup))
      weight = 0
      stamp = 0
      do v = 1, size(group)
         if (weight(group(v)) == 0) member(group(v)) = v
         weight(group(v)) = weight(group(v)) + 1
      end do
      n = 0
      qptr(1) = 1
      do g = 1, ngroup
         stamp(g) = g
         do k = ptr(member(g)), ptr(member(g) + 1) - 1
            h = group(adjacent(k))
            if (stamp(h) == g) cycle
            stamp(h) = g
            n = n + 1
            qadjacent(n) = h
         end do
         qptr(g + 1) = n + 1
      end do
      qadjacent = qadjacent(:n)
   end subroutine quotient

   !> Order of the vertices from an order of their groups; members in ascending order.
   pure subroutine expand(group, group_order, order)
      integer, intent(in) :: group(:)        !! (m)
      integer, intent(in) :: group_order(:)  !! (ngroup) new -> old
      integer, intent(out) :: order(:)       !! (m) new -> old
      integer :: start(size(group_order) + 1), g, k, v

      start = 0
      do v = 1, size(group)
         start(group(v)) = start(group(v)) + 1
      end do
      k = 1
      do g = 1, size(group_order)
         v = start(group_order(g))
         start(group_order(g)) = k
         k = k + v
      end do
      do v = 1, size(group)
         order(start(group(v))) = v
         start(group(v)) = start(group(v)) + 1
      end do
   end subroutine expand

   !> Postorder of an elimination forest whose vertices beyond `n_interior` stay behind the others.
   !>
   !> Such an order leaves the factor the same but for the numbering, and makes columns of equal
   !> structure consecutive. The child with the longest column comes last, next to its parent.
   pure subroutine postorder(parent, column_count, n_interior, order)
      integer(ik), intent(in) :: parent(:)        !! (n) 1-based, parent(v) > v, 0 at a root
      integer(ik), intent(in) :: column_count(:)  !! (n)
      integer, intent(in) :: n_interior
      integer, intent(out) :: order(:)            !! (n) new -> old
      integer :: heavy(size(parent)), child(size(parent)), sibling(size(parent)), &
         & stack(size(parent))
      integer :: n, v, p, k, depth

      n = size(parent)
      heavy = 0
      child = 0
      sibling = 0
      do v = 1, n
         p = parent(v)
         if (p == 0) cycle
         if (heavy(p) == 0) heavy(p) = v
         if (column_count(v) >= column_count(heavy(p))) heavy(p) = v
      end do
      do p = 1, n
         v = heavy(p)
         if (v == 0) cycle
         if (is_root(v)) cycle
         child(p) = v
      end do
      do v = n, 1, -1
         p = parent(v)
         if (is_root(v)) cycle
         if (heavy(p) == v) cycle
         sibling(v) = child(p)
         child(p) = v
      end do
      k = 0
      do v = 1, n
         if (.not. is_root(v)) cycle
         depth = 1
         stack(1) = v
         do while (depth > 0)
            p = stack(depth)
            if (child(p) /= 0) then
               depth = depth + 1
               stack(depth) = child(p)
               child(p) = sibling(child(p))
            else
               k = k + 1
               order(k) = p
               depth = depth - 1
            end if
         end do
      end do

   contains

      pure logical function is_root(v)
         integer, intent(in) :: v
         is_root = parent(v) == 0
         if (.not. is_root) is_root = v <= n_interior .and. parent(v) > n_interior
      end function is_root
   end subroutine postorder
end module lopin_graph
