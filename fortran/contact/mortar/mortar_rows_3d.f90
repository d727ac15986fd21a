!> Mortar rows of slave nodes at any shape in space, with their exact slopes where a tangent needs
!> them: for finite sliding.
!>
!> Row j: weighted gap vector G = sum_i c_i x_i (c: the slave's side positive, -M_jl on masters,
!> sum 0), D_j, normal n out of the master (its mean over the node's share, as lopin_mortar), gap
!> g = n.G/D. A traction t of node j puts c_i t on node i. Slopes by the coordinates of all nodes
!> on which the row depends: the moving edges of the cells, the planes of the pieces and the
!> normals included; the topology of the cells is held.
module lopin_mortar_rows_3d
   use lopin_kinds, only : wp
   use lopin_facets, only : facet_rule_type
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type
   use lopin_mortar_least, only : least_of_nodes, lift_of_row
   use lopin_mortar_cells_3d, only : mortar_kernel_type
   use lopin_mortar_cover, only : cover_type
   use lopin_mortar_row_3d, only : mortar_row_type, join, make_room, hand_row_over
   use lopin_mortar_facet_3d, only : facet_coupling_type, couple_facet
   implicit none
   private
   public :: mortar_row_type, new_mortar_rows, close_rows, find_lifts

contains

   !> Sums of all slave nodes; the overlaps are those found at x. With the rows of the last
   !> increment, those nodes count as well (for lopin_mortar_traction_3d). `close_rows` ends them.
   subroutine new_mortar_rows(row, kernel, slave, master, x, list, with_slopes, before)
      type(mortar_row_type), allocatable, intent(out) :: row(:)   !! (slave%nnode)
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)                   !! (3, all mesh nodes) [length]
      type(overlap_list_type), intent(in) :: list
      logical, intent(in) :: with_slopes
      type(mortar_row_type), intent(in), optional :: before(:)    !! (slave%nnode)
      type(facet_coupling_type) :: facet
      integer :: from, to, i

      allocate (row(slave%nnode))
      call reserve_rows(row, slave, master, list, with_slopes, before)
      from = 1
      do while (from <= list%n)
         to = from
         do while (to < list%n)
            if (list%item(to + 1)%slave /= list%item(from)%slave) exit
            to = to + 1
         end do
         i = list%item(from)%slave
         call couple_facet(facet, kernel, slave, master, x, list%item(from:to), with_slopes)
         call add_facet(row, kernel%facet_rule(slave%facets%cell(i)), slave, i, facet)
         from = to + 1
      end do
   end subroutine new_mortar_rows

   !> Normals and gaps. With a planned `cover`, nodes without a row of their own hand it over.
   subroutine close_rows(row, x, cover)
      type(mortar_row_type), intent(inout) :: row(:)      !! (slave nodes)
      real(wp), intent(in) :: x(:, :)                     !! (3, all mesh nodes) [length]
      type(cover_type), intent(in), optional :: cover     !! by plan_rows
      integer :: i

      if (present(cover)) then
         do i = 1, size(cover%giver)
            if (row(cover%giver(i))%node > 0) call hand_row_over(row, cover%giver(i), &
               & cover%gift(cover%giver(i))%heir)
         end do
      end if
      do i = 1, size(row)
         if (row(i)%node > 0) call close_row(row(i), x)
      end do
   end subroutine close_rows

   !> What the least gap over the facets of each node is above the mean of its row:
   !> lopin_mortar_least.
   subroutine find_lifts(lift, row, lifts, slave, master, x, list)
      real(wp), intent(out) :: lift(:)                  !! (slave%nnode) >= 0 [length]
      type(mortar_row_type), intent(in) :: row(:)       !! (slave%nnode) closed
      logical, intent(in) :: lifts(:)                   !! (slave%nnode) others keep their mean
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)                   !! (3, all mesh nodes) [length]
      type(overlap_list_type), intent(in) :: list
      integer :: best(slave%nnode), j

      lift = 0.0_wp
      if (.not. any(lifts)) return
      call least_of_nodes(slave, list, best)
      do j = 1, size(row)
         if (best(j) == 0 .or. row(j)%node == 0 .or. .not. lifts(j)) cycle
         if (.not. row(j)%weight > 0.0_wp) cycle
         lift(j) = lift_of_row(list%item(best(j)), slave, master, x, row(j)%normal, row(j)%gap)
      end do
   end subroutine find_lifts

   !> The nodes of each row: all of its facets, and of the masters that those meet.
   subroutine reserve_rows(row, slave, master, list, with_slopes, before)
      type(mortar_row_type), intent(inout) :: row(:)
      type(surface_type), intent(in) :: slave, master
      type(overlap_list_type), intent(in) :: list
      logical, intent(in) :: with_slopes
      type(mortar_row_type), intent(in), optional :: before(:)
      integer :: i, j, k

      do i = 1, list%n
         associate (s => list%item(i)%slave, m => list%item(i)%master)
            do k = 1, slave%facets%nnode(s)
               j = slave%local(k, s)
               row(j)%node = slave%node(j)
               call join(row(j)%of, master%facets%node(:master%facets%nnode(m), m))
            end do
         end associate
      end do
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            j = slave%local(k, i)
            if (row(j)%node > 0) call join(row(j)%of, &
               & slave%facets%node(:slave%facets%nnode(i), i))
         end do
      end do
      do j = 1, size(row)
         if (row(j)%node == 0) cycle
         if (present(before)) then
            if (before(j)%node > 0) call join(row(j)%of, before(j)%of)
         end if
         call make_room(row(j), with_slopes)
      end do
   end subroutine reserve_rows

   !> What a facet adds to the rows of its nodes.
   subroutine add_facet(row, rule, slave, number, facet)
      type(mortar_row_type), intent(inout) :: row(:)
      type(facet_rule_type), intent(in) :: rule
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: number
      type(facet_coupling_type), intent(in) :: facet
      integer :: at(size(facet%node)), end(3)
      real(wp) :: factor(3)
      integer :: j, k

      do j = 1, facet%ns
         associate (r => row(slave%local(j, number)))
            do k = 1, size(at)
               at(k) = findloc(r%of, facet%node(k), dim=1)
            end do
            r%topology = mod(31*r%topology + facet%topology, 1000003)
            r%weight = r%weight + facet%d(j)
            r%normal = r%normal + facet%side(:, j)
            call own_terms(rule, j, end, factor)
            do k = 1, 3
               if (end(k) == 0) cycle
               r%c(at(end(k))) = r%c(at(end(k))) + factor(k)*facet%d(j)
            end do
            do k = 1, facet%nm
               r%c(at(facet%ns + k)) = r%c(at(facet%ns + k)) - facet%m(j, k)
            end do
            if (allocated(facet%d_slope)) call add_slopes_of_facet(r, facet, j, at, end, factor)
         end associate
      end do
   end subroutine add_facet

   !> What it adds to the slopes of the row of its node j.
   pure subroutine add_slopes_of_facet(row, facet, j, at, end, factor)
      type(mortar_row_type), intent(inout) :: row
      type(facet_coupling_type), intent(in) :: facet
      integer, intent(in) :: j
      integer, intent(in) :: at(:)             !! places of the facet's nodes in the row
      integer, intent(in) :: end(3)            !! nodes of the basis function, by own_terms
      real(wp), intent(in) :: factor(3)
      integer :: way(3*size(at)), k

      do k = 1, size(at)
         way(3*k - 2:3*k) = 3*at(k) + [-2, -1, 0]
      end do
      row%weight_slope(way) = row%weight_slope(way) + facet%d_slope(:, j)
      row%normal_slope(:, way) = row%normal_slope(:, way) + facet%side_slope(:, :, j)
      do k = 1, 3
         if (end(k) == 0) cycle
         associate (l => at(end(k)))
            row%c_slope(way, l) = row%c_slope(way, l) + factor(k)*facet%d_slope(:, j)
         end associate
      end do
      do k = 1, facet%nm
         associate (l => at(facet%ns + k))
            row%c_slope(way, l) = row%c_slope(way, l) - facet%m_slope(:, j, k)
         end associate
      end do
   end subroutine add_slopes_of_facet

   !> The coefficient of Phi_j by the slave's nodes: itself, or in a transformed basis
   !> (u_mid - share (u_1 + u_2))/(1 - 2 share).
   pure subroutine own_terms(rule, j, node, factor)
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: j
      integer, intent(out) :: node(3)
      real(wp), intent(out) :: factor(3)

      node = [j, 0, 0]
      factor = [1.0_wp, 0.0_wp, 0.0_wp]
      if (.not. rule%cell%quadratic .or. j <= rule%cell%ncorner) return
      node(2:) = rule%cell%edge(:, j - rule%cell%ncorner)
      factor(1) = 1.0_wp/rule%blend(j, j)
      factor(2:) = 0.5_wp*(1.0_wp - factor(1))
   end subroutine own_terms

   !> Unit normal, gap, and their slopes.
   subroutine close_row(row, x)
      type(mortar_row_type), intent(inout) :: row
      real(wp), intent(in) :: x(:, :)
      real(wp) :: length, mean(3), place(3, size(row%of))
      integer :: i

      length = norm2(row%normal)
      if (length > 0.0_wp) then
         row%normal = row%normal/length
         if (allocated(row%normal_slope)) row%normal_slope = matmul(unity() &
            & - spread(row%normal, 2, 3)*spread(row%normal, 1, 3), row%normal_slope)/length
      end if
      if (.not. row%weight > 0.0_wp) return
      ! About the node: far coordinates lose no digits.
      place = x(:, row%of) - spread(x(:, row%node), 2, size(row%of))
      mean = matmul(place, row%c)/row%weight
      row%gap = dot_product(row%normal, mean)
      if (.not. allocated(row%gap_slope)) return
      row%gap_slope = matmul(mean, row%normal_slope) &
         & + (matmul(row%c_slope, matmul(row%normal, place)) &
         & - row%gap*row%weight_slope)/row%weight
      do i = 1, size(row%of)
         row%gap_slope(3*i - 2:3*i) = row%gap_slope(3*i - 2:3*i) &
            & + row%c(i)/row%weight*row%normal
      end do
   end subroutine close_row

   pure function unity() result(i)
      real(wp) :: i(3, 3)
      i = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
   end function unity
end module lopin_mortar_rows_3d
