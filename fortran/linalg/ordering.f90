!> Orders with a small profile: reverse Cuthill-McKee, chosen equations last.
module lopin_ordering
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_graph, only : node_graph_type, number_interior, expand
   implicit none
   private
   public :: profile_order, row_starts, profile_cost, reverse_cuthill_mckee, delay

contains

   !> Order of the equations of a lower triangle for a profile solver; `last` keep their order.
   !>
   !> Two numberings compete: reverse Cuthill-McKee, which is best for the bodies themselves, and
   !> levels counted from the equations kept last, which keeps the rows of these short.
   subroutine profile_order(a, last, order, valid, delayed)
      type(csc_type), intent(in) :: a
      integer, intent(in) :: last(:)                !! 1-based equations
      integer, allocatable, intent(out) :: order(:) !! (n) new -> old
      logical, intent(out) :: valid                 !! false if `last` are not distinct equations
      logical, intent(in), optional :: delayed(:)   !! (n) to stand behind their neighbours
      type(node_graph_type) :: graph
      integer, allocatable :: local(:), interior(:), by_group(:), rival(:)
      logical, allocatable :: late(:)
      integer :: m, attempt

      call number_interior(a%n, last, local, m, valid)
      if (.not. valid) return
      call graph%new(a, local, m)
      allocate (by_group(graph%ngroup), interior(m))
      allocate (late(m), source=.false.)
      if (present(delayed)) late = delayed(graph%equation)
      do attempt = 1, merge(1, 2, size(last) == 0)
         if (attempt == 1) then
            call reverse_cuthill_mckee(graph%group_ptr, graph%group_adjacent, by_group)
         else
            call reverse_cuthill_mckee(graph%group_ptr, graph%group_adjacent, by_group, &
               & groups_beside_last(a, local, graph%group, graph%ngroup))
         end if
         call expand(graph%group, by_group, interior)
         if (any(late)) call delay(graph%ptr, graph%adjacent, late, interior)
         rival = [graph%equation(interior), last]
         if (attempt == 2) then
            if (profile_cost(row_starts(a, rival)) >= profile_cost(row_starts(a, order))) exit
         end if
         call move_alloc(rival, order)
      end do
   end subroutine profile_order

   !> The groups with an entry in a row or column of the equations kept last.
   pure function groups_beside_last(a, local, group, ngroup) result(beside)
      type(csc_type), intent(in) :: a
      integer, intent(in) :: local(:), group(:), ngroup
      integer, allocatable :: beside(:)
      logical :: seen(ngroup)
      integer :: j, k, r, c, i

      seen = .false.
      do j = 1, a%n
         c = local(j)
         do k = a%colptr(j) + 1, a%colptr(j + 1)
            r = local(a%row(k) + 1)
            if (r == 0 .and. c > 0) seen(group(c)) = .true.
            if (c == 0 .and. r > 0) seen(group(r)) = .true.
         end do
      end do
      beside = pack([(i, i=1, ngroup)], seen)
   end function groups_beside_last

   !> Column of the first entry of each row of the reordered lower triangle.
   pure function row_starts(a, order) result(first)
      type(csc_type), intent(in) :: a
      integer, intent(in) :: order(:)   !! (n) new -> old
      integer :: first(size(order))     !! (n)
      integer :: at(size(order)), i, j, k

      do i = 1, a%n
         at(order(i)) = i
         first(i) = i
      end do
      do j = 1, a%n
         do k = a%colptr(j) + 1, a%colptr(j + 1)
            i = max(at(j), at(a%row(k) + 1))
            first(i) = min(first(i), at(j), at(a%row(k) + 1))
         end do
      end do
   end function row_starts

   !> Operations of a profile factorisation: the sum of the squared row lengths.
   pure real(wp) function profile_cost(first) result(cost)
      integer, intent(in) :: first(:)   !! (n)
      integer :: i

      cost = 0.0_wp
      do i = 1, size(first)
         cost = cost + real(i - first(i) + 1, wp)**2
      end do
   end function profile_cost

   !> Reverse Cuthill-McKee numbering of all components of a graph.
   !>
   !> Without `roots` each component starts at an end of a longest path found by repeated
   !> level structures (George and Liu). With `roots` these make the first level, so the
   !> last numbers.
   pure subroutine reverse_cuthill_mckee(ptr, adjacent, order, roots)
      integer, intent(in) :: ptr(:), adjacent(:)
      integer, intent(out) :: order(:)              !! (n) new -> old
      integer, intent(in), optional :: roots(:)
      logical :: seen(size(order))
      integer :: n, v, from

      seen = .false.
      n = 0
      if (present(roots)) then
         n = size(roots)
         order(:n) = roots
         seen(roots) = .true.
         call spread_out(ptr, adjacent, 1, n, order, seen)
      end if
      do v = 1, size(order)
         if (seen(v)) cycle
         from = n + 1
         call far_end(ptr, adjacent, v, order(from:), seen)
         n = from
         seen(order(from)) = .true.
         call spread_out(ptr, adjacent, from, n, order, seen)
      end do
      order = order(size(order):1:-1)
   end subroutine reverse_cuthill_mckee

   !> Breadth first from order(from:n), neighbours by ascending degree; n grows to the end reached.
   pure subroutine spread_out(ptr, adjacent, from, n, order, seen)
      integer, intent(in) :: ptr(:), adjacent(:), from
      integer, intent(inout) :: n, order(:)
      logical, intent(inout) :: seen(:)
      integer :: head, v, k, w, start, i

      head = from
      do while (head <= n)
         v = order(head)
         head = head + 1
         start = n + 1
         do k = ptr(v), ptr(v + 1) - 1
            w = adjacent(k)
            if (seen(w)) cycle
            seen(w) = .true.
            n = n + 1
            i = n
            do while (i > start)
               if (degree(order(i - 1)) <= degree(w)) exit
               order(i) = order(i - 1)
               i = i - 1
            end do
            order(i) = w
         end do
      end do

   contains

      pure integer function degree(v)
         integer, intent(in) :: v
         degree = ptr(v + 1) - ptr(v)
      end function degree
   end subroutine spread_out

   !> Put into work(1) a vertex at an end of the component of v; `seen` is unchanged.
   pure subroutine far_end(ptr, adjacent, v, work, seen)
      integer, intent(in) :: ptr(:), adjacent(:), v
      integer, intent(inout) :: work(:)
      logical, intent(inout) :: seen(:)
      integer :: start, best, depth, deepest, n, from, till, k

      start = v
      deepest = -1
      do
         work(1) = start
         seen(start) = .true.
         n = 1
         from = 1
         till = 1
         depth = 0
         do
            call next_level(ptr, adjacent, from, till, n, work, seen)
            if (n == till) exit
            depth = depth + 1
            from = till + 1
            till = n
         end do
         best = work(from)
         do k = from + 1, till
            if (ptr(work(k) + 1) - ptr(work(k)) < ptr(best + 1) - ptr(best)) best = work(k)
         end do
         seen(work(:n)) = .false.
         if (depth <= deepest) exit
         deepest = depth
         start = best
      end do
      work(1) = start
   end subroutine far_end

   pure subroutine next_level(ptr, adjacent, from, till, n, work, seen)
      integer, intent(in) :: ptr(:), adjacent(:), from, till
      integer, intent(inout) :: n, work(:)
      logical, intent(inout) :: seen(:)
      integer :: h, k

      do h = from, till
         do k = ptr(work(h)), ptr(work(h) + 1) - 1
            if (seen(adjacent(k))) cycle
            seen(adjacent(k)) = .true.
            n = n + 1
            work(n) = adjacent(k)
         end do
      end do
   end subroutine next_level

   !> Move vertices without stiffness of their own (multipliers) just behind their last other
   !> neighbour, where elimination has given them a pivot.
   pure subroutine delay(ptr, adjacent, late, order)
      integer, intent(in) :: ptr(:), adjacent(:)
      logical, intent(in) :: late(:)        !! (n)
      integer, intent(inout) :: order(:)    !! (n) new -> old
      integer :: at(size(order)), next(size(order)), head(0:size(order)), moved(size(order))
      integer :: i, k, v, n, behind

      n = size(order)
      do i = 1, n
         at(order(i)) = i
      end do
      head = 0
      do i = n, 1, -1
         v = order(i)
         if (.not. late(v)) cycle
         behind = 0
         do k = ptr(v), ptr(v + 1) - 1
            if (.not. late(adjacent(k))) behind = max(behind, at(adjacent(k)))
         end do
         next(v) = head(behind)
         head(behind) = v
      end do
      k = 0
      v = head(0)
      do i = 1, n + 1
         do while (v /= 0)
            k = k + 1
            moved(k) = v
            v = next(v)
         end do
         if (i > n) exit
         v = head(i)
         if (late(order(i))) cycle
         k = k + 1
         moved(k) = order(i)
      end do
      order = moved
   end subroutine delay
end module lopin_ordering
