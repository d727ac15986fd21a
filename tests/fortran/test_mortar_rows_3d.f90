!> Mortar rows at any shape in space: sums, rigid motions, and their slopes by all coordinates.
program test_mortar_rows_3d
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_cells, only : cell_names
   use lopin_facets, only : facets_type, facet_rule_type, new_facet_rules
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type, build_tree
   use lopin_mortar_overlap, only : overlap_list_type, overlap_limits_type, area_measure_type
   use lopin_mortar_cells_3d, only : mortar_kernel_type, new_mortar_kernel
   use lopin_mortar_overlaps_3d, only : find_overlaps_3d
   use lopin_mortar_rows_3d, only : mortar_row_type, new_mortar_rows, close_rows
   use lopin_mortar_traction_3d, only : slip_of_row, forces_of_row
   use lopin_mortar, only : mortar_coupling_type, couple
   use lopin_slave_pieces, only : whole_weights
   use lopin_mortar_cover, only : cover_type, new_cover
   use lopin_rigid_motion, only : rotation_matrix
   use check, only : test, close_to, is_true, finish
   implicit none

   type(mortar_kernel_type) :: kernel
   type(facet_rule_type) :: rules(6)
   type(surface_type) :: slave, master
   type(overlap_list_type) :: list
   real(wp), allocatable :: x(:, :)
   real(wp) :: worst
   integer :: i, j, tried

   call random_init(.true., .false.)
   call new_mortar_kernel(kernel, 0)
   call new_facet_rules(rules)
   worst = 0.0_wp
   tried = 0
   do i = 3, 6
      do j = 3, 6
         call set_scene(i, j)
         call rows_close(trim(cell_names(i))//' on '//trim(cell_names(j)))
         call slopes_equal_differences(trim(cell_names(i))//' on '//trim(cell_names(j)))
         call forces_follow(trim(cell_names(i))//' on '//trim(cell_names(j)))
      end do
   end do
   call is_true('most directions stay clear of kinks', tried > 100)
   print '("   largest difference of slopes ",es9.1)', worst
   call finish()

contains

   !> Two bent surfaces that do not match: the slave above looks down, the master up.
   subroutine set_scene(slave_cell, master_cell)
      integer, intent(in) :: slave_cell, master_cell
      type(facets_type) :: facets
      real(wp) :: turn(3, 3), shake(3)
      integer :: k

      if (allocated(x)) deallocate (x)
      allocate (x(3, 9 + 25))
      call lattice(x(:, :9), 1, 0.4_wp, 0.02_wp)
      call lattice(x(:, 10:), 2, 0.73_wp, 0.0_wp)
      do k = 1, size(x, 2)
         call random_number(shake)
         x(:, k) = x(:, k) + 0.03_wp*(shake - 0.5_wp)
      end do
      turn = rotation_matrix([0.4_wp, -0.7_wp, 0.3_wp])
      x = matmul(turn, x)
      call tile(facets, slave_cell, 1, 0, .true.)
      call new_surface(slave, 3, facets)
      call tile(facets, master_cell, 2, 9, .false.)
      call new_surface(master, 3, facets)
   end subroutine set_scene

   !> The overlaps at the places x, and the rows.
   subroutine find_rows(row, with_slopes, before)
      type(mortar_row_type), allocatable, intent(out) :: row(:)
      logical, intent(in) :: with_slopes
      type(mortar_row_type), intent(in), optional :: before(:)
      type(error_type), allocatable :: error
      type(tree_type) :: tree
      real(wp), allocatable :: normal(:, :)

      call update_surface(slave, x, error)
      call update_surface(master, x, error)
      call build_tree(tree, master%low, master%high)
      allocate (normal(3, slave%nnode))
      normal = spread(slave%disc(4:6, 1), 2, slave%nnode)
      list%n = 0
      call find_overlaps_3d(kernel, slave, normal, master, tree, x, &
         & overlap_limits_type(1.0_wp, -0.2_wp), list)
      call is_true('no point is lost', list%lost == 0)
      call new_mortar_rows(row, kernel, slave, master, x, list, with_slopes, before)
      call close_rows(row, x)
   end subroutine find_rows

   !> Places of (2 n + 1)^2 nodes on a bent sheet.
   subroutine lattice(place, n, size, height)
      real(wp), intent(out) :: place(:, :)
      integer, intent(in) :: n
      real(wp), intent(in) :: size, height
      integer :: a, b
      real(wp) :: u(2)

      do b = 0, 2*n
         do a = 0, 2*n
            u = size*(real([a, b], wp)/real(n, wp) - 1.0_wp)
            place(:, 1 + a + (2*n + 1)*b) = [u(1), u(2), &
               & height - 0.1_wp*u(1)**2 + 0.07_wp*u(1)*u(2)]
         end do
      end do
   end subroutine lattice

   !> Facets on the lattice; `down`: their normals.
   subroutine tile(facets, cell, n, offset, down)
      type(facets_type), intent(out) :: facets
      integer, intent(in) :: cell, n, offset
      logical, intent(in) :: down
      integer, parameter :: quad(2, 8) = reshape([0, 0, 2, 0, 2, 2, 0, 2, 1, 0, 2, 1, 1, 2, 0, 1], &
         & [2, 8])
      integer, parameter :: first(2, 6) = reshape([0, 0, 2, 0, 2, 2, 1, 0, 2, 1, 1, 1], [2, 6])
      integer, parameter :: second(2, 6) = reshape([0, 0, 2, 2, 0, 2, 1, 1, 1, 2, 0, 1], [2, 6])
      integer :: a, b, k, corner, nodes(3:6)

      nodes = [3, 6, 4, 8]
      facets%n = merge(2, 1, cell < 5)*n*n
      allocate (facets%element(facets%n), facets%face(facets%n), facets%cell(facets%n), &
         & facets%nnode(facets%n), facets%node(8, facets%n))
      facets%element = [(k, k=1, facets%n)]
      facets%face = 1
      facets%cell = cell
      facets%nnode = nodes(cell)
      facets%node = 0
      k = 0
      do b = 0, n - 1
         do a = 0, n - 1
            corner = offset + 1 + 2*a + (2*n + 1)*2*b
            if (cell < 5) then
               call add(facets, k, first(:, :nodes(cell)), corner, 2*n + 1, down)
               call add(facets, k, second(:, :nodes(cell)), corner, 2*n + 1, down)
            else
               call add(facets, k, quad(:, :nodes(cell)), corner, 2*n + 1, down)
            end if
         end do
      end do
   end subroutine tile

   !> One more facet: `step` are its nodes on the lattice from its first corner.
   subroutine add(facets, k, step, corner, row, down)
      type(facets_type), intent(inout) :: facets
      integer, intent(inout) :: k
      integer, intent(in) :: step(:, :), corner
      integer, intent(in) :: row                 !! nodes in a row of the lattice
      logical, intent(in) :: down
      integer :: m

      k = k + 1
      m = size(step, 2)
      facets%node(:m, k) = corner + step(1, :) + row*step(2, :)
      if (.not. down) return
      select case (m)
      case (3)
         facets%node(:3, k) = facets%node([1, 3, 2], k)
      case (4)
         facets%node(:4, k) = facets%node([1, 4, 3, 2], k)
      case (6)
         facets%node(:6, k) = facets%node([1, 3, 2, 6, 5, 4], k)
      case (8)
         facets%node(:8, k) = facets%node([1, 4, 3, 2, 8, 7, 6, 5], k)
      end select
   end subroutine add

   !> Sums, positive weights, the same as the coupling of small sliding, rigid motion.
   subroutine rows_close(name)
      character(len=*), intent(in) :: name
      type(mortar_row_type), allocatable :: row(:), value(:)
      type(mortar_coupling_type) :: small
      real(wp) :: full(slave%nnode), share(slave%facets%n), still(3), axis(3)
      type(cover_type) :: cover
      integer :: k, m

      call test(name//': rows close')
      call find_rows(value, .false.)
      call find_rows(row, .true.)
      do k = 1, size(row)
         call is_true('values are the same without slopes', .not. allocated(value(k)%c_slope) &
            & .and. all(same([value(k)%c, value(k)%weight, value(k)%gap, value(k)%normal], &
            & [row(k)%c, row(k)%weight, row(k)%gap, row(k)%normal])))
         call close_to('forces in equilibrium', sum(row(k)%c), 0.0_wp, 1.0e-14_wp)
         call is_true('positive weight', row(k)%weight > 0.0_wp)
      end do
      call whole_weights(slave, rules, x, .false., spread(1.0_wp, 1, slave%facets%n), full, share)
      call new_cover(cover, full, share, .false.)
      call couple(small, rules, slave, master, x, area_measure_type(.false., &
         & spread(1.0_wp, 1, slave%facets%n)), list, cover)
      call close_to('weights of small sliding', row(small_index(small))%weight, small%weight, &
         & 1.0e-12_wp)
      axis = [0.3_wp, -0.5_wp, 0.2_wp]
      do k = 1, size(row)
         still = 0.0_wp
         do m = 1, 3
            still(m) = sum(row(k)%gap_slope(m::3))
         end do
         call close_to('a translation keeps the gap', still, spread(0.0_wp, 1, 3), 1.0e-11_wp)
         still(1) = 0.0_wp
         do m = 1, size(row(k)%of)
            still(1) = still(1) + dot_product(row(k)%gap_slope(3*m - 2:3*m), &
               & cross(axis, x(:, row(k)%of(m))))
         end do
         call close_to('a rotation keeps the gap', still(1), 0.0_wp, 1.0e-11_wp)
      end do
   end subroutine rows_close

   elemental logical function same(a, b)
      real(wp), intent(in) :: a, b
      same = .not. abs(a - b) > 0.0_wp
   end function same

   !> Where the rows of the small-sliding coupling stand among the slave nodes.
   function small_index(small) result(index)
      type(mortar_coupling_type), intent(in) :: small
      integer :: index(small%n), k

      do k = 1, small%n
         index(k) = findloc(slave%node, small%node(k), dim=1)
      end do
   end function small_index

   subroutine slopes_equal_differences(name)
      character(len=*), intent(in) :: name
      type(mortar_row_type), allocatable :: row(:)
      type(mortar_row_type), allocatable :: at(:)
      real(wp), parameter :: w(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      real(wp), parameter :: h = 5.0e-5_wp
      real(wp), allocatable :: c(:, :), g(:), d(:), n(:, :)
      real(wp) :: off, free
      integer :: node, a, q, k, direction, trial

      call test(name//': slopes equal differences')
      call find_rows(row, .true.)
      do trial = 1, 6
         call random_number(free)
         node = 1 + int(free*size(slave%node))
         if (mod(trial, 2) == 1) then
            node = slave%node(node)
         else
            call random_number(free)
            node = master%node(1 + int(free*size(master%node)))
         end if
         a = 1 + mod(trial, 3)
         allocate (c(size(x, 2), size(row)), source=0.0_wp)
         allocate (g(size(row)), d(size(row)), n(3, size(row)), source=0.0_wp)
         do q = 1, 4
            x(a, node) = x(a, node) + h*real(merge(q - 3, q - 2, q < 3), wp)
            call find_rows(at, .false.)
            x(a, node) = x(a, node) - h*real(merge(q - 3, q - 2, q < 3), wp)
            do k = 1, size(row)
               c(at(k)%of, k) = c(at(k)%of, k) + w(q)/h*at(k)%c
               g(k) = g(k) + w(q)/h*at(k)%gap
               d(k) = d(k) + w(q)/h*at(k)%weight
               n(:, k) = n(:, k) + w(q)/h*at(k)%normal
            end do
         end do
         do k = 1, size(row)
            direction = 3*(findloc(row(k)%of, node, dim=1) - 1) + a
            if (direction < 1) then
               off = max(maxval(abs(c(:, k))), abs(g(k)), abs(d(k)))
            else
               off = max(maxval(abs(c(row(k)%of, k) - row(k)%c_slope(direction, :))), &
                  & abs(g(k) - row(k)%gap_slope(direction)), &
                  & abs(d(k) - row(k)%weight_slope(direction)), &
                  & maxval(abs(n(:, k) - row(k)%normal_slope(:, direction))))
            end if
            worst = max(worst, off)
            call close_to('row', off, 0.0_wp, 1.0e-8_wp)
         end do
         deallocate (c, g, d, n)
      end do
   end subroutine slopes_equal_differences

   !> Springs along the normal and along the slip of all rows: forces, their sum, their tangent.
   subroutine forces_follow(name)
      character(len=*), intent(in) :: name
      type(mortar_row_type), allocatable :: before(:), row(:), moved(:)
      real(wp), parameter :: w(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      real(wp), parameter :: h = 5.0e-5_wp
      real(wp), allocatable :: force(:), k(:, :), slope(:, :), difference(:)
      real(wp) :: slip(3), turn(3, 3), way(3), start(3, size(x, 2))
      integer, allocatable :: topology(:)
      integer :: a, at, i, m, n, q
      logical :: kink

      call test(name//': slip and forces')
      call find_rows(before, .true.)
      start = x
      turn = rotation_matrix([0.2_wp, 0.9_wp, -0.4_wp])
      x = matmul(turn, x) + 0.3_wp
      call find_rows(row, .true., before)
      m = (size(row) + 1)/2
      allocate (slope(3, 3*size(row(m)%of)))
      call slip_of_row(row(m), before(m), x, slip, slope)
      call close_to('a rigid motion slips nowhere', slip, spread(0.0_wp, 1, 3), 1.0e-12_wp)
      x = start
      way = 0.01_wp*cross(before(m)%normal, [0.3_wp, 0.5_wp, 0.9_wp])
      x(:, slave%node) = x(:, slave%node) + spread(way, 2, slave%nnode)
      call find_rows(row, .true., before)
      call slip_of_row(row(m), before(m), x, slip, slope)
      call close_to('the slip of the slave', slip/norm2(way), way/norm2(way), 0.2_wp)
      n = 3*size(x, 2)
      allocate (force(n), k(n, n), difference(n))
      call press(row, before, force, k)
      call find_rows(moved, .false., before)
      topology = moved%topology
      do a = 1, 3
         call close_to('equilibrium', sum(force(a::3)), 0.0_wp, 1.0e-12_wp)
      end do
      do a = 1, 3*size(row(m)%of), 10
         difference = 0.0_wp
         kink = .false.
         at = row(m)%of((a + 2)/3)
         i = 1 + mod(a - 1, 3)
         do q = 1, 4
            x(i, at) = x(i, at) + h*real(merge(q - 3, q - 2, q < 3), wp)
            call find_rows(moved, .false., before)
            call press(moved, before, force)
            x(i, at) = x(i, at) - h*real(merge(q - 3, q - 2, q < 3), wp)
            difference = difference - w(q)/h*force
            kink = kink .or. any(moved%topology /= topology)
         end do
         if (kink) cycle
         tried = tried + 1
         worst = max(worst, maxval(abs(difference - k(:, 3*at - 3 + i))))
         call close_to('tangent', difference, k(:, 3*at - 3 + i), 1.0e-8_wp)
      end do
      x = start
   end subroutine forces_follow

   !> A normal and a tangential spring at every row: forces at all nodes, and their tangent, for which
   !> rows have slopes.
   subroutine press(row, before, force, k)
      type(mortar_row_type), intent(in) :: row(:), before(:)
      real(wp), intent(out) :: force(:)
      real(wp), intent(out), optional :: k(:, :)
      real(wp), allocatable :: f(:), df(:, :), slope(:, :)
      real(wp) :: slip(3), traction(3)
      integer, allocatable :: dof(:)
      integer :: r, a, n

      force = 0.0_wp
      if (present(k)) k = 0.0_wp
      do r = 1, size(row)
         n = 3*size(row(r)%of)
         if (.not. present(k)) then
            allocate (slope(3, n))
            call slip_of_row(row(r), before(r), x, slip, slope)
            deallocate (slope)
            traction = (0.4_wp - row(r)%gap)*row(r)%normal - 2.0_wp*slip
            do a = 1, n
               associate (at => 3*row(r)%of((a + 2)/3) - 2 + mod(a - 1, 3))
                  force(at) = force(at) + row(r)%c((a + 2)/3)*traction(1 + mod(a - 1, 3))
               end associate
            end do
            cycle
         end if
         allocate (f(n), df(n, n), slope(3, n))
         dof = [(3*row(r)%of((a + 2)/3) - 2 + mod(a - 1, 3), a=1, n)]
         call slip_of_row(row(r), before(r), x, slip, slope)
         traction = (0.4_wp - row(r)%gap)*row(r)%normal - 2.0_wp*slip
         call forces_of_row(row(r), traction, &
            & (0.4_wp - row(r)%gap)*row(r)%normal_slope - spread(row(r)%normal, 2, n) &
            & *spread(row(r)%gap_slope, 1, 3) - 2.0_wp*slope, f, df)
         force(dof) = force(dof) + f
         k(dof, dof) = k(dof, dof) + df
         deallocate (f, df, slope)
      end do
   end subroutine press

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross
end program test_mortar_rows_3d
