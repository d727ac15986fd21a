!> Dual mortar coupling of two surfaces: what each slave node meets, on average over its share.
!>
!> A dual function Phi_j belongs to every slave node: the integral of Phi_j N_k is 0 for k /= j, so
!> that each node has a gap of its own (Wohlmuth 2000). On every slave facet Phi = A N with
!> A = diag(integral of N) (integral of N N^T)^-1, both over the part that the master covers
!> (Cichosz and Bischoff 2011). With D_j = integral of Phi_j, M_jl = integral of Phi_j N_l:
!>
!>    gap_j = n_j.(x_j - sum_l P_jl x_l),   P_jl = M_jl/D_j,   sum_l P_jl = 1.
!>
!> Facets quad8 and triangle6 are dualised in a transformed basis with positive integrals: their
!> mid-side rows have terms at the slave's own corners (Popp, Wohlmuth, Gee, Wall 2012).
module lopin_mortar
   use lopin_kinds, only : wp
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_cells, only : cell_id
   use lopin_facets, only : facet_rule_type, facet_point
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type
   implicit none
   private
   public :: mortar_coupling_type, couple, dual_matrix, take_blend, thin

   !> gap = n.(x_node - sum p x_other); forces: weight p n on the node, the opposite on the others.
   type :: mortar_coupling_type
      integer :: n = 0
      integer, allocatable :: node(:)        !! (n) slave nodes that have a function, increasing
      real(wp), allocatable :: weight(:)     !! (n) D_j > 0 [area]
      real(wp), allocatable :: normal(:, :)  !! (3, n) unit, out of the master: minus the slave's
      real(wp), allocatable :: gap(:)        !! (n) mean of the gap by Phi_j, >= 0 open [length]
      real(wp), allocatable :: covered(:)    !! (n) D_j over that of the whole facets [-]
      integer, allocatable :: facet(:)       !! (n) master facet opposite most of it
      integer, allocatable :: first(:)       !! (n+1) rows of P
      integer, allocatable :: other(:)       !! mesh nodes: masters, own of transformed bases
      real(wp), allocatable :: p(:)          !! sum over a row is 1
   end type mortar_coupling_type

   !> A row while it grows: sum value*x(node) is the weighted gap vector.
   type :: row_type
      integer :: n = 0
      integer, allocatable :: node(:)
      real(wp), allocatable :: value(:)
      real(wp) :: weight = 0.0_wp            !! D [area]
      real(wp) :: gap = 0.0_wp               !! weighted [area length]
      real(wp) :: full = 0.0_wp              !! D if all its facets were covered [area]
      real(wp) :: largest = 0.0_wp           !! share of one master facet [area]
      integer :: facet = 0
   end type row_type

   !> A facet of which less is covered keeps the standard basis: positive, and constant pressures
   !> pass exactly; the dual one grows like the inverse of the share.
   real(wp), parameter :: thin = 0.1_wp
   !> A node covered less than this share of its best neighbour has no function of its own: its
   !> neighbours take its basis over, so that the functions still sum to one.
   real(wp), parameter :: weak = 0.05_wp
   !> Of a facet: less is rounding.
   real(wp), parameter :: nothing = 1.0e-10_wp

contains

   !> Rows of all slave nodes from the overlaps of the facets.
   subroutine couple(self, rules, slave, normal, master, x, axisymmetric, thickness, list)
      type(mortar_coupling_type), intent(out) :: self
      type(facet_rule_type), intent(in) :: rules(:)   !! from new_facet_rules
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: normal(:, :)            !! (3, slave%nnode) outward unit normals
      real(wp), intent(in) :: x(:, :)                 !! (ndim, all mesh nodes) [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness(:)            !! (slave facets) ones unless plane [length]
      type(overlap_list_type), intent(in) :: list
      type(row_type), allocatable :: row(:)
      real(wp) :: full(8), area
      integer :: i, k, n, from, to

      allocate (row(slave%nnode))
      from = 1
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         call whole_facet(rules(slave%facets%cell(i)), x(:, slave%facets%node(:n, i)), &
            & axisymmetric, thickness(i), full(:n), area)
         do k = 1, n
            row(slave%local(k, i))%full = row(slave%local(k, i))%full + full(k)
         end do
         to = from - 1
         do while (to < list%n)
            if (list%item(to + 1)%slave /= i) exit
            to = to + 1
         end do
         if (to >= from) call add_facet(row, slave, master, rules(slave%facets%cell(i)), i, area, &
            & list%item(from:to))
         from = to + 1
      end do
      call share_weak(row, slave)
      call take_rows(self, row, slave, normal)
   end subroutine couple

   !> Integrals of the basis over a whole facet, and its area.
   pure subroutine whole_facet(rule, x, axisymmetric, thickness, full, area)
      type(facet_rule_type), intent(in) :: rule
      real(wp), intent(in) :: x(:, :)               !! (ndim, nnode) [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness
      real(wp), intent(out) :: full(:), area
      real(wp) :: normal(3), own, blend(8, 8), plain(8)
      integer :: k, n

      n = size(full)
      plain = 0.0_wp
      area = 0.0_wp
      do k = 1, rule%npoint
         call facet_point(rule, k, x, axisymmetric, normal(:size(x, 1)), own)
         plain(:n) = plain(:n) + thickness*own*rule%n(:n, k)
         area = area + thickness*own
      end do
      call take_blend(rule, blend(:n, :n))
      full = matmul(blend(:n, :n), plain(:n))
   end subroutine whole_facet

   !> The transformed basis of quad8 and triangle6 = blend * standard basis; unity for the others.
   pure subroutine take_blend(rule, blend)
      type(facet_rule_type), intent(in) :: rule
      real(wp), intent(out) :: blend(:, :)
      integer :: k, n

      n = rule%cell%nnode
      blend = 0.0_wp
      do k = 1, n
         blend(k, k) = 1.0_wp
      end do
      if (transformed(rule)) blend = rule%blend(:n, :n)
   end subroutine take_blend

   pure logical function transformed(rule)
      type(facet_rule_type), intent(in) :: rule
      transformed = rule%cell%quadratic .and. rule%cell%id /= cell_id%line3
   end function transformed

   !> A of Phi = A N from integrals over the covered part; unity if they are singular.
   subroutine dual_matrix(me, d, a)
      real(wp), intent(in) :: me(:, :)         !! integral of N N^T [area]
      real(wp), intent(in) :: d(:)             !! integral of N [area]
      real(wp), intent(out) :: a(:, :)
      real(wp) :: l(size(d), size(d)), column(size(d))
      integer :: k, status

      a = 0.0_wp
      l = me
      call cholesky(l, status)
      do k = 1, size(d)
         a(k, k) = 1.0_wp
         if (status /= 0) cycle
         column = 0.0_wp
         column(k) = d(k)
         call cholesky_solve(l, column)
         a(k, :) = column
      end do
   end subroutine dual_matrix

   !> What one slave facet adds to the rows of its nodes.
   subroutine add_facet(row, slave, master, rule, facet, area, item)
      type(row_type), intent(inout) :: row(:)
      type(surface_type), intent(in) :: slave, master
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: facet
      real(wp), intent(in) :: area                    !! of the whole facet [area]
      type(overlap_type), intent(in) :: item(:)       !! all of this slave facet
      real(wp) :: me(rule%cell%nnode, rule%cell%nnode), d(rule%cell%nnode), &
         & blend(rule%cell%nnode, rule%cell%nnode), a(rule%cell%nnode, rule%cell%nnode), &
         & m(rule%cell%nnode, 8), gap(rule%cell%nnode), covered
      integer :: i, j, l, n

      n = rule%cell%nnode
      covered = sum(item%area)/area
      if (.not. covered > nothing) return
      call take_blend(rule, blend)
      me = 0.0_wp
      d = 0.0_wp
      do i = 1, size(item)
         me = me + item(i)%me(:n, :n)
         d = d + item(i)%d(:n)
      end do
      d = matmul(blend, d)
      a = blend
      if (covered >= thin) then
         me = matmul(blend, matmul(me, transpose(blend)))
         call dual_matrix(me, d, a)
         a = matmul(a, blend)
      end if
      do i = 1, size(item)
         m = matmul(a, item(i)%b(:n, :))
         gap = matmul(a, item(i)%gap(:n))
         do j = 1, n
            associate (own => row(slave%local(j, facet)))
               own%gap = own%gap + gap(j)
               do l = 1, master%facets%nnode(item(i)%master)
                  call add_term(own, master%facets%node(l, item(i)%master), -m(j, l))
               end do
               if (item(i)%area > own%largest) then
                  own%largest = item(i)%area
                  own%facet = item(i)%master
               end if
            end associate
         end do
      end do
      do j = 1, n
         associate (own => row(slave%local(j, facet)))
            own%weight = own%weight + d(j)
            call add_own(own, slave, rule, facet, j, d(j))
         end associate
      end do
   end subroutine add_facet

   !> The slave's side of a row, d times the coefficient of Phi_j: in a transformed basis that of a
   !> mid-side node is (u_mid - share*(u_1 + u_2))/(1 - 2 share).
   pure subroutine add_own(row, slave, rule, facet, j, d)
      type(row_type), intent(inout) :: row
      type(surface_type), intent(in) :: slave
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: facet, j
      real(wp), intent(in) :: d
      real(wp) :: share
      integer :: k

      if (.not. transformed(rule) .or. j <= rule%cell%ncorner) then
         call add_term(row, slave%facets%node(j, facet), d)
         return
      end if
      share = 0.5_wp*(1.0_wp - rule%blend(j, j))
      call add_term(row, slave%facets%node(j, facet), d/rule%blend(j, j))
      do k = 1, 2
         call add_term(row, slave%facets%node(rule%cell%edge(k, j - rule%cell%ncorner), facet), &
            & -d*share/rule%blend(j, j))
      end do
   end subroutine add_own

   pure subroutine add_term(row, node, value)
      type(row_type), intent(inout) :: row
      integer, intent(in) :: node
      real(wp), intent(in) :: value
      integer, allocatable :: nodes(:)
      real(wp), allocatable :: values(:)
      integer :: k

      if (.not. allocated(row%node)) allocate (row%node(16), row%value(16))
      do k = 1, row%n
         if (row%node(k) /= node) cycle
         row%value(k) = row%value(k) + value
         return
      end do
      if (row%n == size(row%node)) then
         allocate (nodes(2*row%n), values(2*row%n))
         nodes(:row%n) = row%node
         values(:row%n) = row%value
         call move_alloc(nodes, row%node)
         call move_alloc(values, row%value)
      end if
      row%n = row%n + 1
      row%node(row%n) = node
      row%value(row%n) = value
   end subroutine add_term

   !> Nodes that are hardly covered hand their functions to the neighbours that are covered more,
   !> the least covered first.
   subroutine share_weak(row, slave)
      type(row_type), intent(inout) :: row(:)
      type(surface_type), intent(in) :: slave
      real(wp) :: ratio(size(row)), best(size(row))
      logical :: open(size(row))
      integer, allocatable :: facets(:, :)
      integer :: i, j, n

      ratio = 0.0_wp
      do i = 1, size(row)
         if (row(i)%full > 0.0_wp) ratio(i) = row(i)%weight/row(i)%full
         ! line3 on the axis: the integral of its end's function vanishes.
         if (.not. row(i)%full > nothing*maxval(row%full)) ratio(i) = 0.0_wp
      end do
      best = ratio
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         associate (own => slave%local(:n, i))
            best(own) = max(best(own), maxval(ratio(own)))
         end associate
      end do
      open = row%n > 0 .and. .not. ratio > weak*best
      call facets_of_nodes(slave, facets)
      do while (any(open))
         j = minloc(ratio, dim=1, mask=open)
         open(j) = .false.
         call hand_over(row, slave, facets(:, j), ratio, weak*best, j)
      end do
   end subroutine share_weak

   !> The facets of each node, zeros behind the last.
   pure subroutine facets_of_nodes(slave, facets)
      type(surface_type), intent(in) :: slave
      integer, allocatable, intent(out) :: facets(:, :)
      integer :: number(slave%nnode)
      integer :: i, k, pass

      do pass = 1, 2
         number = 0
         do i = 1, slave%facets%n
            do k = 1, slave%facets%nnode(i)
               associate (node => slave%local(k, i))
                  number(node) = number(node) + 1
                  if (pass == 2) facets(number(node), node) = i
               end associate
            end do
         end do
         if (pass == 1) allocate (facets(max(1, maxval(number)), slave%nnode), source=0)
      end do
   end subroutine facets_of_nodes

   !> Add row j to the strong neighbours' in equal parts; without any, to the best neighbour's.
   subroutine hand_over(row, slave, facets, ratio, limit, j)
      type(row_type), intent(inout) :: row(:)
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: facets(:)        !! of node j
      real(wp), intent(in) :: ratio(:), limit(:)
      integer, intent(in) :: j
      integer, allocatable :: heir(:)
      integer :: i, k, best

      allocate (heir(0))
      best = 0
      do i = 1, size(facets)
         if (facets(i) == 0) exit
         do k = 1, slave%facets%nnode(facets(i))
            associate (node => slave%local(k, facets(i)))
               if (.not. ratio(node) > ratio(j) .or. any(heir == node)) cycle
               if (ratio(node) > limit(node)) heir = [heir, node]
               if (best == 0) best = node
               if (ratio(node) > ratio(best)) best = node
            end associate
         end do
      end do
      if (size(heir) == 0 .and. best > 0) heir = [best]
      do i = 1, size(heir)
         associate (to => row(heir(i)), share => 1.0_wp/real(size(heir), wp))
            do k = 1, row(j)%n
               call add_term(to, row(j)%node(k), share*row(j)%value(k))
            end do
            to%weight = to%weight + share*row(j)%weight
            to%gap = to%gap + share*row(j)%gap
         end associate
      end do
      row(j)%n = 0
   end subroutine hand_over

   !> Divide the rows by their weights.
   subroutine take_rows(self, row, slave, normal)
      type(mortar_coupling_type), intent(inout) :: self
      type(row_type), intent(in) :: row(:)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: normal(:, :)
      integer :: i, k, n, terms
      real(wp) :: p

      n = count(row%n > 0 .and. row%weight > 0.0_wp)
      allocate (self%node(n), self%weight(n), self%normal(3, n), self%gap(n), self%covered(n), &
         & self%facet(n), self%first(n + 1), self%other(sum(row%n)), self%p(sum(row%n)))
      self%normal = 0.0_wp
      self%first(1) = 1
      terms = 0
      do i = 1, size(row)
         if (row(i)%n == 0 .or. .not. row(i)%weight > 0.0_wp) cycle
         self%n = self%n + 1
         self%node(self%n) = slave%node(i)
         self%weight(self%n) = row(i)%weight
         self%normal(:size(normal, 1), self%n) = -normal(:, i)
         self%gap(self%n) = row(i)%gap/row(i)%weight
         self%covered(self%n) = min(1.0_wp, row(i)%weight/max(tiny(1.0_wp), row(i)%full))
         self%facet(self%n) = row(i)%facet
         do k = 1, row(i)%n
            p = -row(i)%value(k)/row(i)%weight
            if (row(i)%node(k) == slave%node(i)) p = p + 1.0_wp
            if (abs(p) <= 4.0_wp*epsilon(1.0_wp)) cycle
            terms = terms + 1
            self%other(terms) = row(i)%node(k)
            self%p(terms) = p
         end do
         self%first(self%n + 1) = terms + 1
      end do
      self%other = self%other(:terms)
      self%p = self%p(:terms)
   end subroutine take_rows
end module lopin_mortar
