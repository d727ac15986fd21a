!> The mortar row of one node in dual numbers: values as the coupling's, slopes as differences.
program test_mortar_node
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable, constant
   use lopin_facets, only : facets_type, facet_rule_type, new_facet_rules
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type, build_tree
   use lopin_error, only : error_type
   use lopin_mortar_overlap, only : overlap_list_type, overlap_limits_type, area_measure_type
   use lopin_mortar_overlaps_2d, only : find_overlaps_2d
   use lopin_slave_pieces, only : split_slave, piece_normals, whole_weights
   use lopin_mortar_cover, only : cover_type, new_cover, taken_over
   use lopin_mortar, only : mortar_coupling_type, couple
   use lopin_mortar_patch_2d, only : patch_type, basis_functions_type, new_patch
   use lopin_mortar_node_2d, only : mortar_row_type, mortar_row
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: facing = -0.2_wp
   type(facet_rule_type) :: rules(6)
   type(surface_type) :: slave, master
   type(overlap_list_type) :: list
   type(mortar_coupling_type) :: coupling
   type(cover_type) :: cover
   real(wp), allocatable :: x(:, :)
   integer :: nnode, i
   logical :: axisymmetric

   call new_facet_rules(rules)
   do nnode = 2, 3
      do i = 1, 2
         axisymmetric = i == 2
         call two_curves()
         call values_are_the_couplings()
         call slopes_are_differences()
      end do
   end do
   call finish()

contains

   !> A bent slave on a bent master whose facets do not match; it passes the slave's ends.
   subroutine two_curves()
      type(facets_type) :: facets
      type(error_type), allocatable :: error
      type(tree_type) :: tree
      integer, allocatable :: piece(:)
      real(wp), allocatable :: normal(:, :), full(:), thickness(:)
      type(area_measure_type) :: measure
      real(wp) :: share(7)

      list = overlap_list_type()
      if (allocated(x)) deallocate (x)
      allocate (x(2, 0))
      call add_curve(facets, 5, 2.0_wp, 9.0_wp, 0.0_wp, .true.)
      call new_surface(master, 2, facets)
      call add_curve(facets, 7, 3.0_wp, 8.0_wp, 0.1_wp, .false.)
      call new_surface(slave, 2, facets)
      call update_surface(master, x, error)
      call is_true('no error', .not. allocated(error))
      call update_surface(slave, x, error)
      thickness = spread(0.7_wp, 1, slave%facets%n)
      if (axisymmetric) thickness = 1.0_wp
      call split_slave(slave, rules, x, piece)
      allocate (normal(2, slave%nnode), full(slave%nnode))
      call piece_normals(slave, rules, x, axisymmetric, normal)
      call whole_weights(slave, rules, x, axisymmetric, thickness, full, share)
      call new_cover(cover, full, share, .false.)
      call build_tree(tree, master%low, master%high)
      measure = area_measure_type(axisymmetric, thickness)
      call find_overlaps_2d(slave, normal, master, tree, x, measure, &
         & overlap_limits_type(5.0_wp, facing), list)
      call couple(coupling, rules, slave, master, x, measure, list, cover)
   end subroutine two_curves

   subroutine add_curve(facets, n, from, to, height, up)
      type(facets_type), intent(out) :: facets
      integer, intent(in) :: n
      real(wp), intent(in) :: from, to, height
      logical, intent(in) :: up
      integer :: k, first, node(8)
      real(wp) :: at

      first = size(x, 2)
      do k = 0, n*(nnode - 1)
         at = from + (to - from)*k/(n*(nnode - 1))
         x = reshape([x, [at, height + 0.1_wp*sin(at) + 0.01_wp*sin(7.0_wp*k + n)]], [2, size(x, &
            & 2) + 1])
      end do
      facets%n = n
      facets%element = [(k, k=1, n)]
      facets%face = spread(1, 1, n)
      facets%cell = spread(nnode - 1, 1, n)
      facets%nnode = spread(nnode, 1, n)
      allocate (facets%node(8, n))
      do k = 1, n
         node = 0
         node(:2) = first + (nnode - 1)*[k - 1, k] + 1
         if (up) node(:2) = node([2, 1])
         if (nnode == 3) node(3) = first + 2*k
         facets%node(:, k) = node
      end do
   end subroutine add_curve

   subroutine row_at(patch, place, input, row)
      type(patch_type), intent(in) :: patch
      real(wp), intent(in) :: place(:, :)
      integer, intent(in) :: input                !! along which slopes are asked; 0: none
      type(mortar_row_type), intent(out) :: row
      type(dual_type) :: at(2, size(place, 2))
      integer :: k, m

      do m = 1, size(place, 2)
         do k = 1, 2
            at(k, m) = variable(place(k, m), merge(1, 0, 2*(m - 1) + k == input))
         end do
      end do
      call mortar_row(row, patch, at, axisymmetric, 0.7_wp)
   end subroutine row_at

   subroutine values_are_the_couplings()
      type(patch_type) :: patch
      type(mortar_row_type) :: row
      real(wp) :: p(size(x, 2)), q(size(x, 2))
      integer :: j, k

      call test('the row of a node in dual numbers has the values of the coupling')
      call is_true('all nodes', coupling%n == slave%nnode)
      do j = 1, coupling%n
         call new_patch(patch, slave, master, list, basis_functions_type([coupling%node(j)], &
            & [1.0_wp], [1]), middle=cover%share)
         call row_at(patch, x(:, patch%node), 0, row)
         call close_to('weight', row%weight%v, coupling%weight(j), 1.0e-13_wp)
         call close_to('gap', row%gap%v, coupling%gap(j), 1.0e-13_wp)
         call close_to('normal', row%normal%v, coupling%normal(:2, j), 1.0e-14_wp)
         call close_to('sum', sum(row%coefficient%v), 0.0_wp, 1.0e-12_wp)
         p = 0.0_wp
         q = 0.0_wp
         do k = coupling%first(j), coupling%first(j + 1) - 1
            p(coupling%other(k)) = coupling%p(k)
         end do
         do k = 2, size(patch%node)
            q(patch%node(k)) = -row%coefficient(k)%v/row%weight%v
         end do
         call close_to('P', q, p, 1.0e-12_wp)
      end do
   end subroutine values_are_the_couplings

   subroutine slopes_are_differences()
      type(patch_type) :: patch
      type(mortar_row_type) :: row, moved
      real(wp), parameter :: h = 1.0e-4_wp, factor(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      integer, parameter :: step(4) = [-2, -1, 1, 2]
      real(wp), allocatable :: place(:, :), slope(:), found(:)
      integer :: j, i, k, m, s

      call test('slopes of weight, normal, gap and coefficients are their differences')
      do j = 1, coupling%n, 2
         call new_patch(patch, slave, master, list, basis_functions_type([coupling%node(j)], &
            & [1.0_wp], [1]), middle=cover%share)
         place = x(:, patch%node)
         do m = 1, size(place, 2)
            do k = 1, 2
               i = 2*(m - 1) + k
               call row_at(patch, place, i, row)
               found = [row%weight%d(1), row%normal%d(1), row%gap%d(1), row%coefficient%d(1)]
               slope = 0.0_wp*found
               do s = 1, 4
                  place(k, m) = x(k, patch%node(m)) + step(s)*h
                  call row_at(patch, place, 0, moved)
                  slope = slope + factor(s)/h*[moved%weight%v, moved%normal%v, moved%gap%v, &
                     & moved%coefficient%v]
               end do
               place(k, m) = x(k, patch%node(m))
               call close_to('slope', found, slope, 1.0e-8_wp)
            end do
         end do
      end do
   end subroutine slopes_are_differences
end program test_mortar_node
