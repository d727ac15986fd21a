!> All overlaps of two surfaces in space.
module lopin_mortar_overlaps_3d
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_id
   use lopin_surface, only : surface_type
   use lopin_search, only : tree_type
   use lopin_box_query, only : facets_in_box
   use lopin_mortar_overlap, only : overlap_list_type, add_overlap, cosine_between
   use lopin_mortar_cells_3d, only : mortar_kernel_type, mortar_sums_type, integrate_overlap
   implicit none
   private
   public :: find_overlaps_3d

   !> A slave facet is covered once this share of it is: what lies behind is not met.
   real(wp), parameter :: whole = 1.0_wp - 1.0e-6_wp

contains

   !> The tree is that of the master's boxes. Masters are looked for within the size of the slave
   !> facet first, and as far as `reach` only if those do not cover it.
   subroutine find_overlaps_3d(kernel, slave, normal, master, tree, x, reach, facing, list, lost, &
      & depth)
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: normal(:, :)        !! (3, slave%nnode) outward unit normals
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)             !! (3, all mesh nodes) [length]
      real(wp), intent(in) :: reach               !! [length]
      real(wp), intent(in) :: facing              !! n_slave.n_master must be below this
      type(overlap_list_type), intent(inout) :: list
      integer, intent(out) :: lost                !! a slave facet with points lost; 0: none
      real(wp), intent(in), optional :: depth(:)  !! (slave facets) deeper is no contact [length]
      type(mortar_sums_type), allocatable :: found(:)
      integer :: i, pass, n
      real(wp) :: area, far

      lost = 0
      do i = 1, slave%facets%n
         area = seen_area(kernel, slave, normal, x, i)
         do pass = 1, 2
            far = merge(min(2.0_wp*slave%size(i), reach), reach, pass == 1)
            call overlaps_of_facet(kernel, slave, normal, master, tree, x, far, facing, i, found, n)
            if (present(depth)) call drop_deep(found, n, depth(i))
            if (sum(found(:n)%area) >= whole*area) exit
         end do
         if (any(found(:n)%nlost > 0)) lost = i
         call take_nearest(found(:n), area, list)
      end do
   end subroutine find_overlaps_3d

   !> Leave out what lies deeper than a wall is thick.
   pure subroutine drop_deep(found, n, depth)
      type(mortar_sums_type), intent(inout) :: found(:)
      integer, intent(inout) :: n
      real(wp), intent(in) :: depth             !! [length]
      integer :: k, kept

      kept = 0
      do k = 1, n
         if (sum(found(k)%gap)/found(k)%area < -depth) cycle
         kept = kept + 1
         if (kept < k) found(kept) = found(k)
      end do
      n = kept
   end subroutine drop_deep

   !> Area of a slave facet in the planes of its pieces: its overlap with its own other side.
   function seen_area(kernel, slave, normal, x, i) result(area)
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: normal(:, :), x(:, :)
      integer, intent(in) :: i
      real(wp) :: area, own(3, 8), square(3, 4), centre(3), axis(3), e(3), f(3)
      type(mortar_sums_type) :: sums
      integer :: n

      n = slave%facets%nnode(i)
      own(:, :n) = x(:, slave%facets%node(:n, i))
      axis = slave%disc(4:6, i)
      centre = slave%disc(:3, i)
      e = 0.0_wp
      e(minloc(abs(axis), dim=1)) = 1.0_wp
      e = e - dot_product(e, axis)*axis
      e = 4.0_wp*slave%disc(7, i)*e/norm2(e)
      f = [axis(2)*e(3) - axis(3)*e(2), axis(3)*e(1) - axis(1)*e(3), axis(1)*e(2) - axis(2)*e(1)]
      square(:, 1) = centre + e
      square(:, 2) = centre - f
      square(:, 3) = centre - e
      square(:, 4) = centre + f
      call integrate_overlap(kernel, slave%facets%cell(i), own(:, :n), &
         & normal(:3, slave%local(:n, i)), cell_id%quad, square, sums)
      area = sums%area
   end function seen_area

   !> The masters that share something with one slave facet.
   subroutine overlaps_of_facet(kernel, slave, normal, master, tree, x, reach, facing, i, found, n)
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: normal(:, :), x(:, :), reach, facing
      type(tree_type), intent(in) :: tree
      integer, intent(in) :: i
      type(mortar_sums_type), allocatable, intent(out) :: found(:)
      integer, intent(out) :: n
      real(wp) :: own(3, 8), nu(3, 8), other(3, 8)
      integer, allocatable :: candidate(:)
      integer :: k, ns, nm

      ns = slave%facets%nnode(i)
      own(:, :ns) = x(:, slave%facets%node(:ns, i))
      nu(:, :ns) = normal(:3, slave%local(:ns, i))
      call facets_along(tree, master, slave%low(:, i), slave%high(:, i), slave%disc(4:6, i), &
         & reach, 4.0_wp*slave%size(i), candidate)
      allocate (found(size(candidate)))
      n = 0
      do k = 1, size(candidate)
         associate (j => candidate(k))
            nm = master%facets%nnode(j)
            if (.not. cosine_between(slave, i, master, j) < facing) cycle
            if (beside(slave%disc(:, i), master%disc(:, j))) cycle
            if (same_nodes(slave%facets%node(:3, i), master%facets%node(:nm, j))) cycle
            other(:, :nm) = x(:, master%facets%node(:nm, j))
            call integrate_overlap(kernel, slave%facets%cell(i), own(:, :ns), nu(:, :ns), &
               & master%facets%cell(j), other(:, :nm), found(n + 1))
            if (found(n + 1)%ncell == 0) cycle
            n = n + 1
            found(n)%slave = i
            found(n)%master = j
         end associate
      end do
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
