program test_facets
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_cells, only : cell_type, cell_id, ncell, new_cell_of, new_sided_cell
   use lopin_facets, only : facets_type, facet_rule_type, new_facets, boundary_facets, &
      & new_facet_rules, &
      & facet_point, facet_weights, nodal_weights, nodal_normals, middle_share
   use lopin_area_slopes, only : weight_slopes
   use blocks, only : new_block
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: pi = acos(-1.0_wp)
   type(facet_rule_type) :: rules(6)
   integer :: id

   call new_facet_rules(rules)
   do id = cell_id%triangle, ncell
      call skin_of_a_block_is_its_surface(id)
      call half_a_block_shares_its_cut(id)
   end do
   call axis_weights_are_right()
   call quadratic_weights_are_positive()
   call slopes_of_weights_are_differences()
   call edges_on_the_axis_are_left_out()
   call normals_of_a_polygon_are_radial()
   call rigid_elements_give_their_positive_side()
   call finish()

contains

   subroutine skin_of_a_block_is_its_surface(id)
      integer, intent(in) :: id
      type(cell_type) :: cell
      type(mesh_type) :: mesh
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      real(wp), allocatable :: weight(:), normal(:, :)
      real(wp) :: own(3), area, total(3)
      real(wp), parameter :: centre(3) = [1.5_wp, 0.5_wp, 1.0_wp]
      integer :: i, k, d, m

      call new_cell_of(cell, id)
      d = cell%ndim
      call new_block(mesh, cell, [3, 2, 2], [0.0_wp, 0.0_wp, 0.0_wp], [3.0_wp, 1.0_wp, 2.0_wp], &
         & 0.2_wp)
      call boundary_facets(facets, mesh, [cell], mesh%element_label, .false., shared)
      call test('the skin of a block has its area and is closed, weights are positive: '//cell%name)
      call is_true('none shared', .not. any(shared))
      total = 0.0_wp
      do i = 1, facets%n
         m = facets%nnode(i)
         do k = 1, rules(facets%cell(i))%npoint
            call facet_point(rules(facets%cell(i)), k, mesh%x(:, facets%node(:m, i)), .false., &
               & own(:d), area)
            total(:d) = total(:d) + area*own(:d)
         end do
      end do
      call close_to('closed', total, [0.0_wp, 0.0_wp, 0.0_wp], 1.0e-13_wp)
      allocate (weight(mesh%nnode), normal(d, mesh%nnode))
      call nodal_weights(facets, rules, mesh%x, .false., spread(1.0_wp, 1, facets%n), weight)
      call close_to('area', sum(weight), merge(8.0_wp, 22.0_wp, d == 2), 1.0e-13_wp)
      call is_true('positive', all(weight >= 0.0_wp))
      call nodal_normals(facets, rules, mesh%x, .false., normal)
      do i = 1, facets%n
         call is_true('positive', all(weight(facets%node(:facets%nnode(i), i)) > 0.0_wp))
      end do
      do i = 1, mesh%nnode
         if (weight(i) > 0.0_wp) call close_to('unit', norm2(normal(:, i)), 1.0_wp, 1.0e-13_wp)
         if (weight(i) > 0.0_wp) call is_true('outward', dot_product(normal(:, i), mesh%x(:, i) &
            & - centre(:d)) > 0.0_wp)
      end do
   end subroutine skin_of_a_block_is_its_surface

   subroutine half_a_block_shares_its_cut(id)
      integer, intent(in) :: id
      type(cell_type) :: cell
      type(mesh_type) :: mesh
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      integer, allocatable :: lower(:)
      real(wp) :: area, weight(8)
      integer :: i, m

      call new_cell_of(cell, id)
      call test('faces of half a block that the other half has as well are shared: '//cell%name)
      call new_block(mesh, cell, [2, 2, 2], [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 1.0_wp, 1.0_wp], &
         & 0.0_wp)
      lower = [(i, i=1, mesh%nelement/2)]
      call boundary_facets(facets, mesh, [cell], lower, .false., shared)
      area = 0.0_wp
      do i = 1, facets%n
         if (.not. shared(i)) cycle
         m = facets%nnode(i)
         call facet_weights(rules(facets%cell(i)), mesh%x(:, facets%node(:m, i)), .false., weight)
         area = area + sum(weight(:m))
         call close_to('in the cut', mesh%x(cell%ndim, facets%node(:m, i)), &
            & spread(0.5_wp, 1, m), 1.0e-14_wp)
      end do
      call close_to('area of the cut', area, 1.0_wp, 1.0e-14_wp)
   end subroutine half_a_block_shares_its_cut

   subroutine axis_weights_are_right()
      real(wp), parameter :: h = 0.3_wp
      real(wp) :: w(3), x(2, 3)
      call test('a segment on the axis gives pi h**2/3 to the axis and twice that to its end')
      x = reshape([0.0_wp, 0.0_wp, h, 0.0_wp, 0.5_wp*h, 0.0_wp], [2, 3])
      call facet_weights(rules(cell_id%line2), x(:, :2), .true., w(:2))
      call close_to('w', w(:2), pi*h**2*[1.0_wp, 2.0_wp]/3.0_wp, 1.0e-14_wp)
      call test('a quadratic segment on the axis has positive weights with the right sum')
      call facet_weights(rules(cell_id%line3), x, .true., w)
      call is_true('positive', all(w > 0.0_wp))
      call close_to('sum', sum(w), pi*h**2, 1.0e-14_wp)
      call test('a quadratic segment off the axis has Simpson''s weights')
      call facet_weights(rules(cell_id%line3), x, .false., w)
      call close_to('w', w, h*[1.0_wp, 1.0_wp, 4.0_wp]/6.0_wp, 1.0e-14_wp)
   end subroutine axis_weights_are_right

   subroutine quadratic_weights_are_positive()
      real(wp) :: w(8), x(3, 8)
      call test('flat quadratic facets give a fifth of the mid-side integrals to each corner')
      x = 0.0_wp
      x(:2, :8) = rules(cell_id%quad8)%cell%xi(:2, :8)
      call facet_weights(rules(cell_id%quad8), x, .false., w)
      call close_to('quad8', w, [spread(0.2_wp, 1, 4), spread(0.8_wp, 1, 4)], 1.0e-14_wp)
      x(:2, :6) = rules(cell_id%triangle6)%cell%xi(:2, :6)
      call facet_weights(rules(cell_id%triangle6), x(:, :6), .false., w(:6))
      call close_to('triangle6', w(:6), [spread(1.0_wp/15.0_wp, 1, 3), spread(0.1_wp, 1, 3)], &
         & 1.0e-14_wp)
   end subroutine quadratic_weights_are_positive

   subroutine slopes_of_weights_are_differences()
      real(wp), parameter :: h = 1.0e-4_wp
      real(wp) :: x(3, 8), moved(3, 8), slope(3, 8), side(3, 8), up(8), down(8), share
      integer :: id, i, k, j, m, d
      logical :: axisymmetric

      call test('slopes of the areas of nodes are those of differences')
      do id = 1, 6
         m = rules(id)%cell%nnode
         d = rules(id)%cell%ndim + 1
         do k = 1, m
            axisymmetric = d == 2 .and. k > 1
            call random_number(x)
            x(:d - 1, :m) = rules(id)%cell%xi(:d - 1, :m) + 0.1_wp*x(:d - 1, :m)
            if (axisymmetric) x(1, :m) = x(1, :m) + 1.2_wp
            share = middle_share(rules(id), x(:d, :m), axisymmetric)
            call weight_slopes(rules(id), x(:d, :m), axisymmetric, share, k, slope(:d, :m))
            do i = 1, m
               do j = 1, d
                  moved = x
                  moved(j, i) = x(j, i) + h
                  call facet_weights(rules(id), moved(:d, :m), axisymmetric, up, share)
                  moved(j, i) = x(j, i) - h
                  call facet_weights(rules(id), moved(:d, :m), axisymmetric, down, share)
                  side(j, i) = (up(k) - down(k))/(2.0_wp*h)
               end do
            end do
            call close_to(rules(id)%cell%name, slope(:d, :m), side(:d, :m), 1.0e-6_wp)
         end do
      end do
   end subroutine slopes_of_weights_are_differences

   subroutine edges_on_the_axis_are_left_out()
      type(cell_type) :: cell
      type(mesh_type) :: mesh
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      real(wp), allocatable :: weight(:), normal(:, :)

      call test('the skin of a cylinder has no facet on the axis, and its end normals are axial')
      call new_cell_of(cell, cell_id%quad)
      call new_block(mesh, cell, [4, 3], [0.0_wp, 0.0_wp], [2.0_wp, 5.0_wp], 0.1_wp)
      call boundary_facets(facets, mesh, [cell], mesh%element_label, .true., shared)
      allocate (weight(mesh%nnode), normal(2, mesh%nnode))
      call is_true('number', facets%n == 11)
      call nodal_weights(facets, rules, mesh%x, .true., spread(1.0_wp, 1, facets%n), weight)
      call close_to('area', sum(weight), 2.0_wp*pi*4.0_wp + 2.0_wp*pi*2.0_wp*5.0_wp, 1.0e-13_wp)
      call nodal_normals(facets, rules, mesh%x, .true., normal)
      call close_to('bottom', normal(:, 1), [0.0_wp, -1.0_wp], 1.0e-14_wp)
   end subroutine edges_on_the_axis_are_left_out

   subroutine normals_of_a_polygon_are_radial()
      integer, parameter :: n = 12
      type(mesh_type) :: mesh
      type(cell_type) :: cell
      type(facets_type) :: facets
      real(wp) :: normal(2, 2*n), angle
      integer :: i

      call test('normals at the nodes of a regular ring are radial')
      call new_cell_of(cell, cell_id%quad)
      mesh%ndim = 2
      mesh%nnode = 2*n
      mesh%nelement = n
      allocate (mesh%x(2, 2*n), mesh%conn(20, n))
      mesh%etype = spread(1, 1, n)
      do i = 1, n
         angle = 2.0_wp*pi*real(i, wp)/real(n, wp)
         mesh%x(:, i) = [cos(angle), sin(angle)]
         mesh%x(:, n + i) = 2.0_wp*mesh%x(:, i)
         mesh%conn(:4, i) = [i, n + i, n + mod(i, n) + 1, mod(i, n) + 1]
      end do
      call new_facets(facets, mesh, [cell], [(i, i=1, n)], spread(2, 1, n))
      call nodal_normals(facets, rules, mesh%x, .false., normal)
      call close_to('normal', normal(:, n + 1:), 0.5_wp*mesh%x(:, n + 1:), 1.0e-14_wp)
      call close_to('no normal inside', normal(:, :n), 0.0_wp*mesh%x(:, :n), 0.0_wp)
   end subroutine normals_of_a_polygon_are_radial

   subroutine rigid_elements_give_their_positive_side()
      type(mesh_type) :: mesh
      type(cell_type) :: cell
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      logical :: found

      call test('a rigid line gives the side to its left')
      call new_sided_cell(cell, 'line2', found)
      mesh%ndim = 2
      mesh%nnode = 2
      mesh%nelement = 1
      mesh%x = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [2, 2])
      allocate (mesh%conn(20, 1))
      mesh%conn(:2, 1) = [1, 2]
      mesh%etype = [1]
      call boundary_facets(facets, mesh, [cell], [1], .false., shared)
      call is_true('one facet, turned', facets%n == 1 .and. all(facets%node(:2, 1) == [2, 1]))
      call is_true('not shared', .not. shared(1))
   end subroutine rigid_elements_give_their_positive_side
end program test_facets
