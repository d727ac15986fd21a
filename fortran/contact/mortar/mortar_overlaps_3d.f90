!> All overlaps of two surfaces in space.
module lopin_mortar_overlaps_3d
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_search, only : tree_type
   use lopin_box_query, only : facets_in_box
   use lopin_mortar_overlap, only : overlap_list_type, add_overlap, cosine_between, &
      & overlap_limits_type
   use lopin_mortar_cells_3d, only : mortar_kernel_type, mortar_sums_type, integrate_overlap, &
      & area_in_pieces
   implicit none
   private
   public :: find_overlaps_3d

   !> A slave facet is covered once this share of it is: what lies behind is not met.
   real(wp), parameter :: whole = 1.0_wp - 1.0e-6_wp

   !> A slave facet: its nodes' places and normals.
   type :: facet_view_type
      integer :: number = 0                       !! of the facet
      integer :: n = 0                            !! nodes
      real(wp) :: x(3, 8) = 0.0_wp                !! [length]
      real(wp) :: normal(3, 8) = 0.0_wp           !! outward unit normals
   end type facet_view_type

   !> The masters that share something with one slave facet.
   type :: found_type
      integer :: n = 0
      type(mortar_sums_type), allocatable :: item(:)   !! the first n count
   end type found_type

contains

   !> The tree is that of the master's boxes. Masters are looked for within the size of the slave
   !> facet first, and as far as `reach` only if those do not cover it.
   subroutine find_overlaps_3d(kernel, slave, normal, master, tree, x, limits, list)
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: normal(:, :)        !! (3, slave%nnode) outward unit normals
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)             !! (3, all mesh nodes) [length]
      type(overlap_limits_type), intent(in) :: limits
      type(overlap_list_type), intent(inout) :: list
      type(facet_view_type) :: facet
      type(found_type) :: found
      integer :: i, pass
      real(wp) :: area, far

      list%lost = 0
      do i = 1, slave%facets%n
         call view_facet(facet, slave, normal, x, i)
         area = area_in_pieces(kernel, slave%facets%cell(i), facet%x(:, :facet%n))
         do pass = 1, 2
            far = merge(min(2.0_wp*slave%size(i), limits%reach), limits%reach, pass == 1)
            call overlaps_of_facet(kernel, slave, facet, master, tree, x, &
               & overlap_limits_type(far, limits%facing), found)
            if (allocated(limits%depth)) call drop_deep(found, limits%depth(i))
            if (sum(found%item(:found%n)%area) >= whole*area) exit
         end do
         if (any(found%item(:found%n)%nlost > 0)) list%lost = i
         call take_nearest(found%item(:found%n), area, list)
      end do
   end subroutine find_overlaps_3d

   pure subroutine view_facet(self, slave, normal, x, i)
      type(facet_view_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: normal(:, :), x(:, :)
      integer, intent(in) :: i

      self%number = i
      self%n = slave%facets%nnode(i)
      self%x(:, :self%n) = x(:, slave%facets%node(:self%n, i))
      self%normal(:, :self%n) = normal(:3, slave%local(:self%n, i))
   end subroutine view_facet

   !> Leave out what lies deeper than a wall is thick.
   pure subroutine drop_deep(found, depth)
      type(found_type), intent(inout) :: found
      real(wp), intent(in) :: depth             !! [length]
      integer :: k, kept

      kept = 0
      do k = 1, found%n
         if (sum(found%item(k)%gap)/found%item(k)%area < -depth) cycle
         kept = kept + 1
         if (kept < k) found%item(kept) = found%item(k)
      end do
      found%n = kept
   end subroutine drop_deep

   !> The masters that share something with one slave facet.
   subroutine overlaps_of_facet(kernel, slave, facet, master, tree, x, limits, found)
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave, master
      type(facet_view_type), intent(in) :: facet         !! of the slave
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)                    !! (3, all mesh nodes) [length]
      type(overlap_limits_type), intent(in) :: limits
      type(found_type), intent(out) :: found
      real(wp) :: other(3, 8)
      integer, allocatable :: candidate(:)
      integer :: k, nm

      associate (i => facet%number, ns => facet%n, n => found%n)
         call facets_along(tree, master, slave%low(:, i), slave%high(:, i), slave%disc(4:6, i), &
            & limits%reach, 4.0_wp*slave%size(i), candidate)
         allocate (found%item(size(candidate)))
         do k = 1, size(candidate)
            associate (j => candidate(k))
               nm = master%facets%nnode(j)
               if (.not. cosine_between(slave, i, master, j) < limits%facing) cycle
               if (beside(slave%disc(:, i), master%disc(:, j))) cycle
               if (same_nodes(slave%facets%node(:3, i), master%facets%node(:nm, j))) cycle
               other(:, :nm) = x(:, master%facets%node(:nm, j))
               call integrate_overlap(kernel, slave%facets%cell(i), facet%x(:, :ns), &
                  & facet%normal(:, :ns), master%facets%cell(j), other(:, :nm), found%item(n + 1))
               if (found%item(n + 1)%ncell == 0) cycle
               n = n + 1
               found%item(n)%slave = i
               found%item(n)%master = j
            end associate
         end do
      end associate
   end subroutine overlaps_of_facet

   !> The masters whose boxes meet a box on its way along an axis, both ways as far as `reach`.
   !>
   !> The way is cut into steps, so that a slanting one does not meet the box around all of it; it
   !> begins and ends with the box of the whole master.
   subroutine facets_along(tree, master, low, high, axis, reach, step, found)
      type(tree_type), intent(in) :: tree
      type(surface_type), intent(in) :: master
      real(wp), intent(in) :: low(3), high(3), axis(3)
      real(wp), intent(in) :: reach, step             !! [length]
      integer, allocatable, intent(out) :: found(:)
      integer, allocatable :: some(:)
      logical, allocatable :: new(:)
      real(wp) :: from, to, t, next, a, b
      integer :: k

      allocate (found(0))
      from = -reach
      to = reach
      do k = 1, 3
         a = tree%low(k, 1) - high(k)
         b = tree%high(k, 1) - low(k)
         if (abs(axis(k)) > 1.0e-12_wp) then
            from = max(from, min(a/axis(k), b/axis(k)))
            to = min(to, max(a/axis(k), b/axis(k)))
         else if (a > 0.0_wp .or. b < 0.0_wp) then
            return
         end if
      end do
      t = from
      do while (t <= to)
         next = min(t + step, to)
         call facets_in_box(tree, master%low, master%high, low + min(t*axis, next*axis), &
            & high + max(t*axis, next*axis), some)
         new = [(.not. any(found == some(k)), k=1, size(some))]
         found = [found, pack(some, new)]
         if (.not. next < to) exit
         t = next
      end do
   end subroutine facets_along

   !> A master facet that is surely not met along the slave's axis: its ball is off the cylinder.
   pure logical function beside(slave, master)
      real(wp), intent(in) :: slave(8), master(8)     !! discs: centre, axis, radius, half height
      real(wp) :: arm(3), along

      arm = master(:3) - slave(:3)
      along = dot_product(arm, slave(4:6))
      ! The pieces of a curved facet look a little elsewhere than the whole.
      beside = norm2(arm - along*slave(4:6)) > slave(7) + norm2(master(7:8)) &
         & + 8.0_wp*slave(8)/slave(7)*abs(along)
   end function beside

   !> The two sides of one element face are no pair.
   pure logical function same_nodes(a, b)
      integer, intent(in) :: a(:), b(:)
      integer :: k

      same_nodes = .true.
      do k = 1, size(a)
         same_nodes = same_nodes .and. any(b == a(k))
      end do
   end function same_nodes

   !> Nearest first, until the slave facet is covered: of facets behind each other the first is met.
   subroutine take_nearest(found, area, list)
      type(mortar_sums_type), intent(inout) :: found(:)
      real(wp), intent(in) :: area                     !! of the slave facet [length^2]
      type(overlap_list_type), intent(inout) :: list
      real(wp) :: distance(size(found)), covered
      logical :: left(size(found)), all_of_them
      integer :: k, i

      all_of_them = sum(found%area) <= area*(2.0_wp - whole)
      do k = 1, size(found)
         distance(k) = abs(sum(found(k)%gap))/found(k)%area
      end do
      left = .true.
      covered = 0.0_wp
      do i = 1, size(found)
         k = i
         if (.not. all_of_them) k = minloc(distance, dim=1, mask=left)
         left(k) = .false.
         if (.not. all_of_them .and. covered + found(k)%area > area*(2.0_wp - whole)) cycle
         covered = covered + found(k)%area
         found(k)%part = found(k)%area/area
         call add_overlap(list, found(k)%overlap_type)
      end do
   end subroutine take_nearest
end module lopin_mortar_overlaps_3d
