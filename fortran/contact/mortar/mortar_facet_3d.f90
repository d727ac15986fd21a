!> The dual coupling of one slave facet with the masters that it meets, and, if wanted, its exact
!> slopes.
!>
!> D_j = integral of the basis, M = diag(D) (integral of N N^T)^-1 (integral of N M^T), all over the
!> part that is covered: as lopin_mortar, but with derivatives by all coordinates. The topology of
!> the cells is held.
module lopin_mortar_facet_3d
   use lopin_kinds, only : wp
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_facets, only : facet_rule_type, facet_point
   use lopin_surface, only : surface_type
   use lopin_cells, only : cell_type
   use lopin_facet_sides, only : facet_sides
   use lopin_mortar, only : take_blend, thin
   use lopin_mortar_overlap, only : overlap_type
   use lopin_mortar_cells_3d, only : mortar_kernel_type, mortar_sums_type, integrate_overlap
   use lopin_mortar_slopes_3d, only : slope_sums_type
   implicit none
   private
   public :: facet_coupling_type, couple_facet

   !> Directions: x, y, z of node 1, of node 2, ...
   type :: facet_coupling_type
      integer :: ns = 0                              !! nodes of the slave facet
      integer :: nm = 0                              !! different nodes of its masters
      integer :: topology = 0                        !! changes where the slopes jump
      integer, allocatable :: node(:)                !! (ns + nm) mesh nodes, the slave's first
      real(wp), allocatable :: d(:)                  !! (ns) [length^2]
      real(wp), allocatable :: m(:, :)               !! (ns, nm) [length^2]
      real(wp), allocatable :: d_slope(:, :)         !! (3(ns + nm), ns), if wanted [length]
      real(wp), allocatable :: m_slope(:, :, :)      !! (3(ns + nm), ns, nm), likewise [length]
      real(wp), allocatable :: side(:, :)            !! (3, ns) normal of the master by the basis
                                                     !! [length^2]
      real(wp), allocatable :: side_slope(:, :, :)   !! (3, 3(ns + nm), ns), likewise [length]
   end type facet_coupling_type

   !> Integrals of the (transformed) basis over all masters.
   type :: integrals_type
      real(wp), allocatable :: me(:, :), me_slope(:, :, :)
   end type integrals_type

contains

   !> `item`: the overlaps of this facet, as lopin_mortar_overlaps_3d finds them at the places x.
   !> Their integrals are the values; slopes take the cells once more.
   subroutine couple_facet(self, kernel, slave, master, x, item, with_slopes)
      type(facet_coupling_type), intent(out) :: self
      type(mortar_kernel_type), intent(in) :: kernel
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)                 !! (3, all mesh nodes) [length]
      type(overlap_type), intent(in) :: item(:)       !! at least one
      logical, intent(in) :: with_slopes
      type(integrals_type) :: sums
      integer :: i, k, n

      self%ns = slave%facets%nnode(item(1)%slave)
      self%node = slave%facets%node(:self%ns, item(1)%slave)
      do i = 1, size(item)
         do k = 1, master%facets%nnode(item(i)%master)
            associate (node => master%facets%node(k, item(i)%master))
               if (any(self%node(self%ns + 1:) == node)) cycle
               self%node = [self%node, node]
            end associate
         end do
      end do
      n = size(self%node)
      self%nm = n - self%ns
      allocate (self%d(self%ns), self%m(self%ns, self%nm), self%side(3, self%ns), &
         & sums%me(self%ns, self%ns), source=0.0_wp)
      if (with_slopes) allocate (self%d_slope(3*n, self%ns), self%m_slope(3*n, self%ns, self%nm), &
         & self%side_slope(3, 3*n, self%ns), sums%me_slope(3*n, self%ns, self%ns), source=0.0_wp)
      do i = 1, size(item)
         associate (cell => kernel%facet_rule(master%facets%cell(item(i)%master))%cell, &
            & node => master%facets%node(:master%facets%nnode(item(i)%master), item(i)%master))
            call add_values(self, sums, item(i), cell, x, node)
            if (with_slopes) call add_slopes(self, sums, kernel, item(i), slave%facets%cell( &
               & item(i)%slave), cell, x, node)
         end associate
      end do
      associate (rule => kernel%facet_rule(slave%facets%cell(item(1)%slave)))
         call transform(self, sums, rule)
         if (sum(self%d) >= thin*area_of(rule, x(:, self%node(:self%ns)))) call dualise(self, sums)
      end associate
   end subroutine couple_facet

   !> Integrals with one master; `node` are its mesh nodes.
   subroutine add_values(self, sums, item, master, x, node)
      type(facet_coupling_type), intent(inout) :: self
      type(integrals_type), intent(inout) :: sums
      type(overlap_type), intent(in) :: item
      type(cell_type), intent(in) :: master
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: node(:)
      real(wp) :: side(3, size(node))
      integer :: j, k, at

      call facet_sides(master, x(:, node), side)
      sums%me = sums%me + item%me(:self%ns, :self%ns)
      self%d = self%d + item%d(:self%ns)
      do k = 1, size(node)
         at = findloc(self%node(self%ns + 1:), node(k), dim=1)
         do j = 1, self%ns
            self%m(j, at) = self%m(j, at) + item%b(j, k)
            self%side(:, j) = self%side(:, j) + item%b(j, k)*side(:, k)
         end do
      end do
   end subroutine add_values

   !> Their slopes.
   subroutine add_slopes(self, sums, kernel, item, slave, master, x, node)
      type(facet_coupling_type), intent(inout) :: self
      type(integrals_type), intent(inout) :: sums
      type(mortar_kernel_type), intent(in) :: kernel
      type(overlap_type), intent(in) :: item
      integer, intent(in) :: slave             !! cell id
      type(cell_type), intent(in) :: master
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: node(:)
      type(mortar_sums_type) :: own
      type(slope_sums_type) :: slopes
      real(wp) :: normal(3, 8), side(3, size(node)), side_slope(3, 3*size(node), size(node))
      integer :: at(size(node)), way(3*(self%ns + size(node)))
      integer :: j, k, q, ns, n

      ns = self%ns
      normal = 0.0_wp
      do k = 1, size(node)
         at(k) = findloc(self%node(ns + 1:), node(k), dim=1)
      end do
      way(:3*ns) = [(k, k=1, 3*ns)]
      do k = 1, size(node)
         way(3*(ns + k) - 2:3*(ns + k)) = 3*(ns + at(k)) + [-2, -1, 0]
      end do
      n = size(way)
      call integrate_overlap(kernel, slave, x(:, self%node(:ns)), normal(:, :ns), master%id, &
         & x(:, node), own, slopes)
      call facet_sides(master, x(:, node), side, side_slope)
      self%topology = mod(31*self%topology + own%topology, 1000003)
      do j = 1, ns
         self%d_slope(way, j) = self%d_slope(way, j) + slopes%d(:n, j)
         do k = 1, ns
            sums%me_slope(way, j, k) = sums%me_slope(way, j, k) + slopes%me(:n, j, k)
         end do
         do k = 1, size(node)
            self%m_slope(way, j, at(k)) = self%m_slope(way, j, at(k)) + slopes%b(:n, j, k)
            do q = 1, 3
               self%side_slope(q, way, j) = self%side_slope(q, way, j) &
                  & + side(q, k)*slopes%b(:n, j, k)
            end do
            self%side_slope(:, way(3*ns + 1:), j) = self%side_slope(:, way(3*ns + 1:), j) &
               & + item%b(j, k)*side_slope(:, :, k)
         end do
      end do
   end subroutine add_slopes

   !> To the basis with positive integrals.
   subroutine transform(self, sums, rule)
      type(facet_coupling_type), intent(inout) :: self
      type(integrals_type), intent(inout) :: sums
      type(facet_rule_type), intent(in) :: rule
      real(wp) :: blend(self%ns, self%ns)
      integer :: k

      if (.not. rule%cell%quadratic) return
      call take_blend(rule, 1.0_wp, blend)
      self%d = matmul(blend, self%d)
      self%m = matmul(blend, self%m)
      sums%me = matmul(blend, matmul(sums%me, transpose(blend)))
      self%side = matmul(self%side, transpose(blend))
      if (.not. allocated(self%d_slope)) return
      self%d_slope = matmul(self%d_slope, transpose(blend))
      do k = 1, 3
         self%side_slope(k, :, :) = matmul(self%side_slope(k, :, :), transpose(blend))
      end do
      do k = 1, self%nm
         self%m_slope(:, :, k) = matmul(self%m_slope(:, :, k), transpose(blend))
      end do
      do k = 1, self%ns
         sums%me_slope(:, :, k) = matmul(sums%me_slope(:, :, k), transpose(blend))
      end do
      do k = 1, size(sums%me_slope, 1)
         sums%me_slope(k, :, :) = matmul(sums%me_slope(k, :, :), transpose(blend))
      end do
   end subroutine transform

   !> M = diag(D) X with me X = b; dM = diag(dD) X + diag(D) me^-1 (db - dme X).
   subroutine dualise(self, sums)
      type(facet_coupling_type), intent(inout) :: self
      type(integrals_type), intent(in) :: sums
      real(wp) :: l(self%ns, self%ns), inverse(self%ns, self%ns), way(self%ns, self%nm), &
         & rest(3*size(self%node), self%ns)
      integer :: i, j, k, status

      l = sums%me
      call cholesky(l, status)
      if (status /= 0) return
      inverse = 0.0_wp
      do k = 1, self%ns
         inverse(k, k) = 1.0_wp
         call cholesky_solve(l, inverse(:, k))
      end do
      way = matmul(inverse, self%m)
      do k = 1, merge(self%nm, 0, allocated(self%m_slope))
         do i = 1, self%ns
            rest(:, i) = self%m_slope(:, i, k)
            do j = 1, self%ns
               rest(:, i) = rest(:, i) - way(j, k)*sums%me_slope(:, i, j)
            end do
         end do
         do j = 1, self%ns
            self%m_slope(:, j, k) = way(j, k)*self%d_slope(:, j)
            do i = 1, self%ns
               self%m_slope(:, j, k) = self%m_slope(:, j, k) + (self%d(j)*inverse(j, i))*rest(:, i)
            end do
         end do
      end do
      do j = 1, self%ns
         self%m(j, :) = self%d(j)*way(j, :)
      end do
   end subroutine dualise

   pure function area_of(rule, x) result(area)
      type(facet_rule_type), intent(in) :: rule
      real(wp), intent(in) :: x(:, :)
      real(wp) :: area, own, normal(3)
      integer :: k

      area = 0.0_wp
      do k = 1, rule%npoint
         call facet_point(rule, k, x, .false., normal, own)
         area = area + own
      end do
   end function area_of
end module lopin_mortar_facet_3d
