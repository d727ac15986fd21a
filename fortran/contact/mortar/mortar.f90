!> Dual mortar coupling of two surfaces: gaps and normals of each slave node, averaged by its dual
!> function.
!>
!> A dual function Phi_j belongs to every slave node: the integral of Phi_j N_k is 0 for k /= j, so
!> that each node has a gap of its own (Wohlmuth 2000). On every slave facet Phi = A N with
!> A = diag(integral of N) (integral of N N^T)^-1, both over the part that the master covers
!> (Cichosz and Bischoff 2011). With D_j = integral of Phi_j, M_jl = integral of Phi_j N_l:
!>
!>    gap_j = n_j.(x_j - sum_l P_jl x_l),   P_jl = M_jl/D_j,   sum_l P_jl = 1.
!>
!> n_j is the mean normal of the master over the share of the node: the slave's own, a mean over
!> its edges, would hold the node sideways. Facets quad8 and triangle6, and line3 on the axis, are
!> dualised in a transformed basis with positive integrals: their mid-side rows have terms at the
!> slave's own corners (Popp, Wohlmuth, Gee, Wall 2012).
module lopin_mortar
   use lopin_kinds, only : wp
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_cells, only : cell_id
   use lopin_facets, only : facet_rule_type, facet_point
   use lopin_surface, only : surface_type
   use lopin_facet_sides, only : facet_sides
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type, area_measure_type
   use lopin_mortar_least, only : least_of_nodes, lift_of_row
   use lopin_mortar_cover, only : cover_type, plan_cover, has_row
   implicit none
   private
   public :: mortar_coupling_type, couple, plan_rows, dual_matrix, take_blend, thin

   !> gap = n.(x_node - sum p x_other); forces: weight p n on the node, the opposite on the others.
   type :: mortar_coupling_type
      integer :: n = 0
      integer, allocatable :: node(:)        !! (n) slave nodes that have a row, not decreasing
      integer, allocatable :: place(:)       !! (n) their numbers on the slave, increasing
      real(wp), allocatable :: weight(:)     !! (n) D_j > 0 [area]
      real(wp), allocatable :: normal(:, :)  !! (3, n) unit, out of the master
      real(wp), allocatable :: gap(:)        !! (n) mean of the gap by Phi_j, >= 0 open [length]
      real(wp), allocatable :: above(:)      !! (n) >= 0: the least gap over its facets, above the
                                             !! mean [length]
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
      real(wp) :: largest = 0.0_wp           !! share of one master facet [area]
      integer :: facet = 0
   end type row_type

   !> A facet of which less is covered keeps the standard basis: positive, and constant pressures
   !> pass exactly; the dual one grows like the inverse of the share.
   real(wp), parameter :: thin = 0.1_wp
   !> Of a facet: less is rounding.
   real(wp), parameter :: nothing = 1.0e-10_wp

contains

   !> Rows of all slave nodes from the overlaps of the facets; `cover` is new, or planned before.
   subroutine couple(self, rules, slave, master, x, measure, list, cover)
      type(mortar_coupling_type), intent(out) :: self
      type(facet_rule_type), intent(in) :: rules(:)   !! from new_facet_rules
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)                 !! (ndim, all mesh nodes) [length]
      type(area_measure_type), intent(in) :: measure
      type(overlap_list_type), intent(in) :: list
      type(cover_type), intent(inout) :: cover        !! from new_cover
      type(row_type), allocatable :: row(:)
      real(wp) :: direction(3, slave%nnode)
      integer :: i, from, to

      allocate (row(slave%nnode))
      call plan_rows(cover, rules, slave, master, x, list, .true., direction)
      from = 1
      do i = 1, slave%facets%n
         to = from - 1
         do while (to < list%n)
            if (list%item(to + 1)%slave /= i) exit
            to = to + 1
         end do
         if (to >= from) call add_facet(row, slave, master, rules(slave%facets%cell(i)), i, &
            & whole_area(rules(slave%facets%cell(i)), &
            & x(:, slave%facets%node(:slave%facets%nnode(i), i)), measure%axisymmetric, &
            & measure%thickness(i)), cover%share(i), list%item(from:to))
         from = to + 1
      end do
      do i = 1, size(cover%giver)
         call hand_over(row, direction, cover%giver(i), cover%gift(cover%giver(i))%heir)
      end do
      if (measure%axisymmetric) call straighten(direction, slave, x)
      call take_rows(self, row, slave, direction, x, cover)
      call find_above(self, slave, master, x, list, cover)
   end subroutine couple

   !> Weights and mean master normals of all functions; from them who has a row.
   subroutine plan_rows(cover, rules, slave, master, x, list, start, direction)
      type(cover_type), intent(inout) :: cover
      type(facet_rule_type), intent(in) :: rules(:)
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      type(overlap_list_type), intent(in) :: list
      logical, intent(in) :: start                    !! of an increment
      real(wp), intent(out) :: direction(3, slave%nnode)   !! times weight [area]
      real(wp) :: weight(slave%nnode), side(size(x, 1), 8), blend(8, 8), unit(3, slave%nnode), most
      integer :: i, k, n, m

      weight = 0.0_wp
      direction = 0.0_wp
      do i = 1, list%n
         associate (o => list%item(i), f => slave%facets, g => master%facets)
            n = f%nnode(o%slave)
            m = g%nnode(o%master)
            call facet_sides(rules(g%cell(o%master))%cell, x(:, g%node(:m, o%master)), side(:, :m))
            call take_blend(rules(f%cell(o%slave)), cover%share(o%slave), blend(:n, :n))
            associate (at => slave%local(:n, o%slave), d => size(x, 1))
               weight(at) = weight(at) + matmul(blend(:n, :n), o%d(:n))
               direction(:d, at) = direction(:d, at) &
                  & + matmul(side(:, :m), transpose(matmul(blend(:n, :n), o%b(:n, :m))))
            end associate
         end associate
      end do
      unit = 0.0_wp
      do k = 1, slave%nnode
         most = norm2(direction(:, k))
         if (most > 0.0_wp) unit(:, k) = direction(:, k)/most
      end do
      call plan_cover(cover, slave, list, weight, unit, start)
   end subroutine plan_rows

   !> On the axis the radial part of a normal vanishes by symmetry.
   pure subroutine straighten(direction, slave, x)
      real(wp), intent(inout) :: direction(:, :)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: x(:, :)
      integer :: i

      do i = 1, slave%nnode
         if (abs(x(1, slave%node(i))) > 1.0e-10_wp*maxval(abs(x(1, :)))) cycle
         if (abs(direction(2, i)) > 0.0_wp) direction(1, i) = 0.0_wp
      end do
   end subroutine straighten

   pure real(wp) function whole_area(rule, x, axisymmetric, thickness) result(area)
      type(facet_rule_type), intent(in) :: rule
      real(wp), intent(in) :: x(:, :)               !! (ndim, nnode) [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness
      real(wp) :: normal(3), own
      integer :: k

      area = 0.0_wp
      do k = 1, rule%npoint
         call facet_point(rule, k, x, axisymmetric, normal(:size(x, 1)), own)
         area = area + thickness*own
      end do
   end function whole_area

   !> The transformed basis = blend * standard basis.
   pure subroutine take_blend(rule, share, blend)
      type(facet_rule_type), intent(in) :: rule
      real(wp), intent(in) :: share             !! middle_share: 0 keeps the standard basis
      real(wp), intent(out) :: blend(:, :)
      integer :: k, n

      n = rule%cell%nnode
      blend = 0.0_wp
      do k = 1, n
         blend(k, k) = 1.0_wp
      end do
      if (share > 0.0_wp) blend = rule%blend(:n, :n)
   end subroutine take_blend

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
   subroutine add_facet(row, slave, master, rule, facet, area, share, item)
      type(row_type), intent(inout) :: row(:)
      type(surface_type), intent(in) :: slave, master
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: facet
      real(wp), intent(in) :: area                    !! of the whole facet [area]
      real(wp), intent(in) :: share                   !! of the transformed basis
      type(overlap_type), intent(in) :: item(:)       !! all of this slave facet
      real(wp) :: me(rule%cell%nnode, rule%cell%nnode), d(rule%cell%nnode), &
         & blend(rule%cell%nnode, rule%cell%nnode), a(rule%cell%nnode, rule%cell%nnode), &
         & m(rule%cell%nnode, 8), covered
      integer :: i, j, l, n

      n = rule%cell%nnode
      covered = sum(item%area)/area
      if (.not. covered > nothing) return
      call take_blend(rule, share, blend)
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
         do j = 1, n
            associate (own => row(slave%local(j, facet)))
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
            call add_own(own, slave, rule, facet, j, d(j), share)
         end associate
      end do
   end subroutine add_facet

   !> The slave's side of a row, d times the coefficient of Phi_j: in a transformed basis that of a
   !> mid-side node is (u_mid - share*(u_1 + u_2))/(1 - 2 share).
   pure subroutine add_own(row, slave, rule, facet, j, d, share)
      type(row_type), intent(inout) :: row
      type(surface_type), intent(in) :: slave
      type(facet_rule_type), intent(in) :: rule
      integer, intent(in) :: facet, j
      real(wp), intent(in) :: d, share
      integer :: k

      if (.not. share > 0.0_wp .or. j <= rule%cell%ncorner) then
         call add_term(row, slave%facets%node(j, facet), d)
         return
      end if
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

   !> Add row j to those of its heirs in equal parts.
   subroutine hand_over(row, direction, j, heir)
      type(row_type), intent(inout) :: row(:)
      real(wp), intent(inout) :: direction(:, :)
      integer, intent(in) :: j, heir(:)
      real(wp) :: share
      integer :: i, k

      share = 1.0_wp/real(size(heir), wp)
      do i = 1, size(heir)
         associate (to => row(heir(i)))
            do k = 1, row(j)%n
               call add_term(to, row(j)%node(k), share*row(j)%value(k))
            end do
            to%weight = to%weight + share*row(j)%weight
            direction(:, heir(i)) = direction(:, heir(i)) + share*direction(:, j)
         end associate
      end do
      row(j)%n = 0
   end subroutine hand_over

   !> Divide the rows by their weights; gaps about the node, so that far coordinates lose no digits.
   subroutine take_rows(self, row, slave, direction, x, cover)
      type(mortar_coupling_type), intent(inout) :: self
      type(row_type), intent(in) :: row(:)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: direction(:, :), x(:, :)
      type(cover_type), intent(in) :: cover
      integer :: i, k, n, terms
      real(wp) :: p

      n = count([(row(i)%n > 0 .and. row(i)%weight > 0.0_wp .and. has_row(cover, i), &
         & i=1, size(row))])
      allocate (self%node(n), self%place(n), self%weight(n), self%normal(3, n), self%gap(n), &
         & self%covered(n), self%facet(n), self%first(n + 1), self%other(sum(row%n)), &
         & self%p(sum(row%n)))
      self%first(1) = 1
      terms = 0
      do i = 1, size(row)
         if (row(i)%n == 0 .or. .not. row(i)%weight > 0.0_wp .or. .not. has_row(cover, i)) cycle
         self%n = self%n + 1
         self%node(self%n) = slave%node(i)
         self%place(self%n) = i
         self%weight(self%n) = row(i)%weight
         self%normal(:, self%n) = direction(:, i)/max(tiny(1.0_wp), norm2(direction(:, i)))
         self%gap(self%n) = gap_of(row(i), self%normal(:size(x, 1), self%n), x, slave%node(i))
         self%covered(self%n) = min(1.0_wp, row(i)%weight/max(tiny(1.0_wp), cover%full(i)))
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

   !> Where the least gap over the facets of a node is more than its mean.
   subroutine find_above(self, slave, master, x, list, cover)
      type(mortar_coupling_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      type(overlap_list_type), intent(in) :: list
      type(cover_type), intent(in) :: cover
      integer :: best(slave%nnode), i

      allocate (self%above(self%n), source=0.0_wp)
      if (cover%tied) return
      call least_of_nodes(slave, list, best)
      do i = 1, self%n
         if (best(self%place(i)) == 0) cycle
         self%above(i) = lift_of_row(list%item(best(self%place(i))), slave, master, x, &
            & self%normal(:, i), self%gap(i))
      end do
   end subroutine find_above

   pure real(wp) function gap_of(row, normal, x, node) result(gap)
      type(row_type), intent(in) :: row
      real(wp), intent(in) :: normal(:), x(:, :)
      integer, intent(in) :: node
      integer :: k

      gap = 0.0_wp
      do k = 1, row%n
         gap = gap + row%value(k)*dot_product(normal, x(:, row%node(k)) - x(:, node))
      end do
      gap = gap/row%weight
   end function gap_of
end module lopin_mortar
