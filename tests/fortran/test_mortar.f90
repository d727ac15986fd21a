!> The dual mortar: the kernel of the plane against brute force and differences, and what its rows
!> must fulfil on any pair of meshes.
program test_mortar
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable, constant
   use lopin_facets, only : facets_type, facet_rule_type, new_facet_rules, nodal_normals
   use lopin_cells, only : cell_id
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type, build_tree
   use lopin_error, only : error_type
   use lopin_mortar_cells_2d, only : segment_type, integrate_segment, find_least
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type, add_overlap, &
      & overlap_limits_type, area_measure_type
   use lopin_mortar_overlaps_2d, only : find_overlaps_2d
   use lopin_slave_pieces, only : split_slave, piece_normals, whole_weights
   use lopin_mortar_cover, only : cover_type, new_cover
   use lopin_mortar, only : mortar_coupling_type, couple, dual_matrix, take_blend
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: facing = -0.2_wp, pi = acos(-1.0_wp)
   type(facet_rule_type) :: rules(6)
   integer :: nodes(2), i, k

   call new_facet_rules(rules)
   do i = 1, 4
      nodes = [2 + mod(i, 2), 2 + i/3]
      do k = 1, 2
         call kernel_is_brute_force(nodes(1), nodes(2), k == 2)
         call slopes_are_differences(nodes(1), nodes(2), k == 2)
      end do
   end do
   do i = 1, 6
      call dual_functions_are_biorthogonal(i)
   end do
   do k = 2, 3
      call rows_reproduce(k, .false.)
      call rows_reproduce(k, .true.)
   end do
   call the_least_gap_is_along_the_master()
   call uncovered_nodes_are_shared()
   call the_nearest_layer_is_met()
   call positive_rows_of_transformed_bases(cell_id%quad8)
   call positive_rows_of_transformed_bases(cell_id%triangle6)
   call finish()

contains

   !> The deeper of two nodes is the nearest place, however much the slave turns away at the other.
   subroutine the_least_gap_is_along_the_master()
      type(segment_type) :: segment
      type(dual_type) :: x(2, 2), normal(2, 2), y(2, 2)

      x(1, :) = constant([0.0_wp, 1.0_wp])
      x(2, :) = constant([-0.01_wp, -0.009_wp])
      normal(:, 1) = constant([0.0_wp, -1.0_wp])
      normal(:, 2) = constant([0.9_wp, -sqrt(0.19_wp)])
      y(1, :) = constant([3.0_wp, -1.0_wp])
      y(2, :) = constant([0.0_wp, 0.0_wp])
      call integrate_segment(x, normal, y, .false., 1.0_wp, segment)
      call find_least(x%v, normal%v, y%v, segment)
      call test('the least gap is along the normal of the master')
      call close_to('its value', segment%least%gap, -0.01_wp, 1.0e-14_wp)
      call close_to('its place', segment%least%n(1), 1.0_wp, 1.0e-14_wp)
   end subroutine the_least_gap_is_along_the_master

   !> A repeatable disturbance between -1 and 1.
   pure real(wp) function noise(k)
      integer, intent(in) :: k
      noise = sin(12.9898_wp*real(k, wp) + 4.1_wp*real(k, wp)**2)
   end function noise

   !> Two facets, one partly over the other, bent if they have three nodes.
   subroutine two_facets(ns, nm, seed, x, normal, y)
      integer, intent(in) :: ns, nm, seed
      real(wp), intent(out) :: x(2, ns), normal(2, ns), y(2, nm)
      integer :: k

      x(:, 1) = [3.0_wp, 1.0_wp]
      x(:, 2) = [5.0_wp, 1.2_wp]
      if (ns == 3) x(:, 3) = [4.05_wp, 1.02_wp]
      y(:, 1) = [5.6_wp, 0.9_wp]
      y(:, 2) = [3.7_wp, 0.8_wp]
      if (nm == 3) y(:, 3) = [4.7_wp, 0.95_wp]
      do k = 1, ns
         x(:, k) = x(:, k) + 0.05_wp*[noise(seed + k), noise(seed + k + 10)]
         normal(:, k) = [0.1_wp*noise(seed + k + 20), -1.0_wp]
         normal(:, k) = normal(:, k)/norm2(normal(:, k))
      end do
      do k = 1, nm
         y(:, k) = y(:, k) + 0.05_wp*[noise(seed + k + 30), noise(seed + k + 40)]
      end do
   end subroutine two_facets

   !> All results of the kernel in one list.
   subroutine kernel(ns, nm, input, axisymmetric, output)
      integer, intent(in) :: ns, nm
      type(dual_type), intent(in) :: input(:)
      logical, intent(in) :: axisymmetric
      type(dual_type), intent(out) :: output(25)
      type(segment_type) :: s

      call integrate_segment(reshape(input(:2*ns), [2, ns]), reshape(input(2*ns + 1:4*ns), &
         & [2, ns]), reshape(input(4*ns + 1:), [2, nm]), axisymmetric, 0.7_wp, s)
      call is_true('overlaps', s%overlaps)
      output(:9) = reshape(s%me, [9])
      output(10:12) = s%d
      output(13:21) = reshape(s%b, [9])
      output(22:24) = s%gap
      output(25) = s%area
   end subroutine kernel

   subroutine slopes_are_differences(ns, nm, axisymmetric)
      integer, intent(in) :: ns, nm
      logical, intent(in) :: axisymmetric
      real(wp) :: x(2, ns), normal(2, ns), y(2, nm), slope(25), at(4*ns + 2*nm)
      real(wp), parameter :: h = 1.0e-3_wp
      type(dual_type) :: input(4*ns + 2*nm), output(25), moved(25, -2:2)
      integer :: i, j, n, m

      call test('slopes of the segment integrals are their differences')
      n = 4*ns + 2*nm
      call two_facets(ns, nm, 7*ns + nm, x, normal, y)
      at = [reshape(x, [2*ns]), reshape(normal, [2*ns]), reshape(y, [2*nm])]
      do i = 1, n
         do j = 1, n
            input(j) = variable(at(j), merge(1, 0, j == i))
         end do
         call kernel(ns, nm, input, axisymmetric, output)
         do m = -2, 2
            if (m == 0) cycle
            input = constant(at)
            input(i) = constant(at(i) + m*h)
            call kernel(ns, nm, input, axisymmetric, moved(:, m))
         end do
         slope = (8.0_wp*(moved(:, 1)%v - moved(:, -1)%v) - (moved(:, 2)%v - moved(:, -2)%v)) &
            & /(12.0_wp*h)
         call close_to('slope', output%d(1), slope, 2.0e-9_wp)
      end do
   end subroutine slopes_are_differences

   !> A midpoint sum over the whole slave facet that asks point by point whether the ray meets.
   subroutine kernel_is_brute_force(ns, nm, axisymmetric)
      integer, intent(in) :: ns, nm
      logical, intent(in) :: axisymmetric
      integer, parameter :: npoint = 100000
      real(wp) :: x(2, ns), normal(2, ns), y(2, nm), n(3), dn(3), m(3), dm(3), place(2), nu(2), &
         & tangent(2), eta, xi, area, d(3), b(3, 3), gap(3)
      type(segment_type) :: s
      integer :: i, j, l, step

      call test('a segment integral is the sum over all rays that meet the master')
      call two_facets(ns, nm, 5*ns + nm, x, normal, y)
      call integrate_segment(constant(x), constant(normal), constant(y), axisymmetric, 0.7_wp, &
         & s)
      d = 0.0_wp
      b = 0.0_wp
      gap = 0.0_wp
      do i = 1, npoint
         xi = -1.0_wp + (2.0_wp*i - 1.0_wp)/npoint
         call shape_of(ns, xi, n, dn)
         place = matmul(x, n(:ns))
         nu = matmul(normal, n(:ns))
         tangent = matmul(x, dn(:ns))
         eta = 0.0_wp
         do step = 1, 8
            call shape_of(nm, eta, m, dm)
            eta = eta - cross_of(matmul(y, m(:nm)) - place, nu)/cross_of(matmul(y, dm(:nm)), nu)
         end do
         if (abs(eta) > 1.0_wp) cycle
         call shape_of(nm, eta, m, dm)
         area = norm2(tangent)*2.0_wp/npoint*merge(2.0_wp*pi*place(1), 0.7_wp, axisymmetric)
         d = d + area*n
         gap = gap + area*n*dot_product(matmul(y, m(:nm)) - place, nu)/norm2(nu)
         do l = 1, nm
            b(:, l) = b(:, l) + area*n*m(l)
         end do
      end do
      call close_to('d', s%d%v, d, 5.0e-5_wp*s%area%v)
      call close_to('gap', s%gap%v, gap, 5.0e-5_wp*s%area%v)
      do j = 1, nm
         call close_to('b', s%b(:, j)%v, b(:, j), 5.0e-5_wp*s%area%v)
      end do
   end subroutine kernel_is_brute_force

   pure real(wp) function cross_of(a, b)
      real(wp), intent(in) :: a(2), b(2)
      cross_of = a(1)*b(2) - a(2)*b(1)
   end function cross_of

   pure subroutine shape_of(nnode, xi, n, dn)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: xi
      real(wp), intent(out) :: n(3), dn(3)

      n = [0.5_wp*(1.0_wp - xi), 0.5_wp*(1.0_wp + xi), 0.0_wp]
      dn = [-0.5_wp, 0.5_wp, 0.0_wp]
      if (nnode == 2) return
      n = [0.5_wp*xi*(xi - 1.0_wp), 0.5_wp*xi*(xi + 1.0_wp), 1.0_wp - xi*xi]
      dn = [xi - 0.5_wp, xi + 0.5_wp, -2.0_wp*xi]
   end subroutine shape_of

   subroutine dual_functions_are_biorthogonal(id)
      integer, intent(in) :: id
      real(wp) :: me(8, 8), d(8), a(8, 8), blend(8, 8), unit(8, 8)
      integer :: k, j, n

      associate (rule => rules(id))
         n = rule%cell%nnode
         call test('dual functions are orthogonal to all but their own: '//rule%cell%name)
         me = 0.0_wp
         d = 0.0_wp
         do k = 1, rule%npoint
            do j = 1, n
               me(:n, j) = me(:n, j) + rule%weight(k)*rule%n(:n, k)*rule%n(j, k)
            end do
            d(:n) = d(:n) + rule%weight(k)*rule%n(:n, k)
         end do
         call take_blend(rule, merge(0.0_wp, 1.0_wp, rule%cell%nnode < 4), blend(:n, :n))
         me(:n, :n) = matmul(blend(:n, :n), matmul(me(:n, :n), transpose(blend(:n, :n))))
         d(:n) = matmul(blend(:n, :n), d(:n))
         call is_true('weights are positive', all(d(:n) > 0.0_wp))
         call dual_matrix(me(:n, :n), d(:n), a(:n, :n))
         unit = 0.0_wp
         do k = 1, n
            unit(k, k) = d(k)
         end do
         call close_to('A M', matmul(a(:n, :n), me(:n, :n)), unit(:n, :n), 1.0e-13_wp)
         call close_to('sum is one', sum(a(:n, :n), 1), spread(1.0_wp, 1, n), 1.0e-12_wp)
         if (id == cell_id%line2) call close_to('line2', a(:2, 1), [2.0_wp, -1.0_wp], 1.0e-13_wp)
         if (id == cell_id%line3) call close_to('line3', a(:3, 1), [1.5_wp, 0.5_wp, -1.0_wp], &
            & 1.0e-13_wp)
      end associate
   end subroutine dual_functions_are_biorthogonal

   !> A slave line above a master line, both with n facets of unequal lengths; nodes of the master
   !> first. `x` and the surfaces come back.
   subroutine two_lines(nnode, master_from, master_to, layers, x, slave, master)
      integer, intent(in) :: nnode               !! of a facet
      real(wp), intent(in) :: master_from, master_to
      integer, intent(in) :: layers              !! lines of the master, one below the other
      real(wp), allocatable, intent(out) :: x(:, :)
      type(surface_type), intent(out) :: slave, master
      type(facets_type) :: facets
      type(error_type), allocatable :: error
      real(wp), allocatable :: place(:, :)
      integer :: layer

      allocate (x(2, 0))
      call new_line(facets)
      do layer = 1, layers
         call add_line(nnode, 7, master_from, master_to, 1.0_wp - layer, .true., x, facets)
      end do
      call new_surface(master, 2, facets)
      call new_line(facets)
      call add_line(nnode, 10, 0.0_wp, 10.0_wp, 0.0_wp, .false., x, facets)
      call new_surface(slave, 2, facets)
      call move_alloc(x, place)
      x = place
      call update_surface(master, x, error)
      call is_true('no error', .not. allocated(error))
      call update_surface(slave, x, error)
      call is_true('no error', .not. allocated(error))
   end subroutine two_lines

   subroutine new_line(facets)
      type(facets_type), intent(inout) :: facets
      facets%n = 0
      facets%element = [integer ::]
      facets%face = [integer ::]
      facets%cell = [integer ::]
      facets%nnode = [integer ::]
      if (allocated(facets%node)) deallocate (facets%node)
      allocate (facets%node(8, 0))
   end subroutine new_line

   !> Normals up if `up`: the way goes to the left.
   subroutine add_line(nnode, n, from, to, height, up, x, facets)
      integer, intent(in) :: nnode, n
      real(wp), intent(in) :: from, to, height
      logical, intent(in) :: up
      real(wp), allocatable, intent(inout) :: x(:, :)
      type(facets_type), intent(inout) :: facets
      integer :: i, first, node(8)
      real(wp) :: tick(0:n)

      first = size(x, 2)
      do i = 0, n
         tick(i) = from + (to - from)*i/n
         if (i > 0 .and. i < n) tick(i) = tick(i) + 0.3_wp*(to - from)/n*noise(i + n)
      end do
      do i = 0, n
         x = reshape([x, [tick(i), height]], [2, size(x, 2) + 1])
      end do
      do i = 1, n
         if (nnode == 3) x = reshape([x, [0.5_wp*(tick(i - 1) + tick(i)), height]], [2, size(x, 2) &
            & + 1])
      end do
      do i = 1, n
         node = 0
         node(:2) = first + [i, i + 1]
         if (up) node(:2) = first + [i + 1, i]
         if (nnode == 3) node(3) = first + n + 1 + i
         facets%node = reshape([facets%node, node], [8, facets%n + 1])
         facets%n = facets%n + 1
         facets%element = [facets%element, facets%n]
         facets%face = [facets%face, 1]
         facets%cell = [facets%cell, nnode - 1]
         facets%nnode = [facets%nnode, nnode]
      end do
   end subroutine add_line

   subroutine couple_lines(slave, master, x, axisymmetric, coupling)
      type(surface_type), intent(inout) :: slave
      type(surface_type), intent(in) :: master
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: axisymmetric
      type(mortar_coupling_type), intent(out) :: coupling
      type(tree_type) :: tree
      type(overlap_list_type) :: list
      type(cover_type) :: cover
      integer, allocatable :: piece(:)
      real(wp), allocatable :: normal(:, :), full(:)
      real(wp) :: thickness(slave%facets%n), share(slave%facets%n)
      type(area_measure_type) :: measure

      thickness = 1.0_wp
      call split_slave(slave, rules, x, piece)
      allocate (normal(2, slave%nnode), full(slave%nnode))
      call piece_normals(slave, rules, x, axisymmetric, normal)
      call whole_weights(slave, rules, x, axisymmetric, thickness, full, share)
      call new_cover(cover, full, share, .false.)
      call build_tree(tree, master%low, master%high)
      measure = area_measure_type(axisymmetric, thickness)
      call find_overlaps_2d(slave, normal, master, tree, x, measure, &
         & overlap_limits_type(20.0_wp, facing), list)
      call couple(coupling, rules, slave, master, x, measure, list, cover)
   end subroutine couple_lines

   subroutine rows_reproduce(nnode, axisymmetric)
      integer, intent(in) :: nnode
      logical, intent(in) :: axisymmetric
      type(surface_type) :: slave, master
      type(mortar_coupling_type) :: c
      real(wp), allocatable :: x(:, :)
      integer :: j, from, to, degree

      call test('rows sum to one and reproduce what the facets can; weights are the area')
      call two_lines(nnode, 0.0_wp, 10.0_wp, 1, x, slave, master)
      call couple_lines(slave, master, x, axisymmetric, c)
      call is_true('covered', all(abs(c%covered - 1.0_wp) < 1.0e-12_wp .or. axisymmetric))
      call close_to('area', sum(c%weight), merge(100.0_wp*pi, 10.0_wp, axisymmetric), 1.0e-12_wp)
      call is_true('positive', all(c%weight > 0.0_wp))
      do j = 1, c%n
         from = c%first(j)
         to = c%first(j + 1) - 1
         call close_to('gap', c%gap(j), 0.0_wp, 1.0e-14_wp)
         call close_to('normal', c%normal(:, j), [0.0_wp, 1.0_wp, 0.0_wp], 1.0e-14_wp)
         do degree = 0, nnode - 1
            call close_to('polynomial', dot_product(c%p(from:to), x(1, c%other(from:to))**degree), &
               & x(1, c%node(j))**degree, 1.0e-11_wp)
         end do
      end do
   end subroutine rows_reproduce

   !> Whatever end the master has, the rows act on the covered part only, with positive weights.
   subroutine uncovered_nodes_are_shared()
      type(surface_type) :: slave, master
      type(mortar_coupling_type) :: c
      real(wp), allocatable :: x(:, :), force(:)
      integer :: j, k, nnode, i
      real(wp) :: end

      call test('partly covered facets: positive weights, area and moment of a uniform pressure')
      do nnode = 2, 3
         do i = 0, 40
            end = 6.0_wp + 0.05_wp*i + 1.0e-3_wp*noise(i)
            call two_lines(nnode, 1.37_wp, end, 1, x, slave, master)
            call couple_lines(slave, master, x, .false., c)
            call is_true('positive', all(c%weight > 0.0_wp))
            allocate (force(size(x, 2)), source=0.0_wp)
            do j = 1, c%n
               force(c%node(j)) = force(c%node(j)) + c%weight(j)
               do k = c%first(j), c%first(j + 1) - 1
                  force(c%other(k)) = force(c%other(k)) - c%weight(j)*c%p(k)
               end do
            end do
            call close_to('no resultant', sum(force), 0.0_wp, 1.0e-12_wp)
            call close_to('no moment', dot_product(force, x(1, :)), 0.0_wp, 1.0e-11_wp)
            call close_to('area', sum(force(slave%node)), end - 1.37_wp, 1.0e-11_wp)
            call close_to('moment', dot_product(force(slave%node), x(1, slave%node)), &
               & 0.5_wp*(end**2 - 1.37_wp**2), 1.0e-11_wp)
            deallocate (force)
         end do
      end do
   end subroutine uncovered_nodes_are_shared

   subroutine the_nearest_layer_is_met()
      type(surface_type) :: slave, master
      type(mortar_coupling_type) :: c
      real(wp), allocatable :: x(:, :)

      call test('of two layers behind each other the slave meets the nearer one')
      call two_lines(2, -1.0_wp, 11.0_wp, 2, x, slave, master)
      call couple_lines(slave, master, x, .false., c)
      call close_to('area', sum(c%weight), 10.0_wp, 1.0e-12_wp)
      call close_to('gap', c%gap, spread(0.0_wp, 1, c%n), 1.0e-14_wp)
   end subroutine the_nearest_layer_is_met

   !> One facet over itself: the rows are unity although the mid-side ones have own corner terms.
   subroutine positive_rows_of_transformed_bases(id)
      integer, intent(in) :: id
      type(surface_type) :: slave, master
      type(facets_type) :: facets
      type(mortar_coupling_type) :: c
      type(overlap_list_type) :: list
      type(overlap_type) :: item
      type(error_type), allocatable :: error
      real(wp) :: x(3, 16), row(16), full(8), share(1)
      type(cover_type) :: cover
      integer :: k, j, n

      associate (rule => rules(id))
         n = rule%cell%nnode
         call test('a transformed basis has positive weights and exact rows: '//rule%cell%name)
         x = 0.0_wp
         x(:2, :n) = rule%cell%xi(:2, :n)
         x(:2, n + 1:2*n) = rule%cell%xi(:2, :n)
         call new_line(facets)
         facets%n = 1
         facets%element = [1]
         facets%face = [1]
         facets%cell = [id]
         facets%nnode = [n]
         facets%node = reshape([(k, k=1, n), (0, k=n + 1, 8)], [8, 1])
         call new_surface(slave, 3, facets)
         facets%node(:n, 1) = facets%node(:n, 1) + n
         call new_surface(master, 3, facets)
         call update_surface(slave, x, error)
         call update_surface(master, x, error)
         item%slave = 1
         item%master = 1
         do k = 1, rule%npoint
            item%area = item%area + rule%weight(k)
            item%d(:n) = item%d(:n) + rule%weight(k)*rule%n(:n, k)
            do j = 1, n
               item%me(:n, j) = item%me(:n, j) + rule%weight(k)*rule%n(:n, k)*rule%n(j, k)
            end do
         end do
         item%b = item%me
         call add_overlap(list, item)
         call whole_weights(slave, rules, x, .false., [1.0_wp], full(:n), share)
         call new_cover(cover, full(:n), share, .false.)
         call couple(c, rules, slave, master, x, area_measure_type(.false., [1.0_wp]), list, cover)
         call is_true('all nodes, positive', c%n == n .and. all(c%weight > 0.0_wp))
         do j = 1, c%n
            row = 0.0_wp
            row(c%node(j)) = -1.0_wp
            do k = c%first(j), c%first(j + 1) - 1
               row(c%other(k)) = row(c%other(k)) + c%p(k)
            end do
            call close_to('sum', sum(row), 0.0_wp, 1.0e-13_wp)
            call close_to('one over the other', row(:n) + row(n + 1:2*n), spread(0.0_wp, 1, n), &
               & 1.0e-12_wp)
         end do
      end associate
   end subroutine positive_rows_of_transformed_bases
end program test_mortar
