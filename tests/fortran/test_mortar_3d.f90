!> Overlaps of facets in space: integrals, their slopes, and what degenerates.
program test_mortar_3d
   use lopin_kinds, only : wp, lk
   use lopin_cells, only : cell_names, cell_id, cell_family
   use lopin_facet_basis, only : shape_values
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_quadrature, only : rule_type, new_rule
   use lopin_polygon, only : polygon_type, common_type, common_part
   use lopin_mortar, only : dual_matrix, take_blend
   use lopin_mortar_cells_3d, only : mortar_kernel_type, mortar_sums_type, new_mortar_kernel, &
      & integrate_overlap, area_in_pieces
   use lopin_mortar_slopes_3d, only : slope_sums_type
   use lopin_rigid_motion, only : rotation_matrix
   use check, only : test, close_to, is_true, finish
   implicit none

   integer, parameter :: faces(4) = [3, 4, 5, 6]    ! triangle, triangle6, quad, quad8
   type(mortar_kernel_type) :: kernel

   call random_init(.true., .false.)
   call new_mortar_kernel(kernel, 0)
   call flat_parallelograms_are_exact()
   call shifted_rectangles_have_their_integrals()
   call parts_of_a_slave_add_up()
   call a_brute_force_sum_agrees()
   call degree_removes_the_rest()
   call slopes_equal_differences()
   call motion_and_numbering_change_nothing()
   call touching_facets_share_nothing()
   call the_gap_is_along_the_normal()
   call dual_weights_are_positive()
   call measure()
   call finish()

contains

   !> A facet of about unit size in the plane z = height, its outward normal up, or down.
   function flat_facet(cell, up, distortion, height) result(x)
      integer, intent(in) :: cell
      logical, intent(in) :: up
      real(wp), intent(in) :: distortion, height
      real(wp) :: x(3, 8), move(3, 8)
      integer :: n

      n = kernel%basis%nnode(cell)
      call random_number(move)
      x = height
      x(:2, :) = kernel%basis%xi(:, :, cell)
      if (.not. up) x(:2, :n) = x(2:1:-1, :n)
      x = x + distortion*(2.0_wp*move - 1.0_wp)
      x(:, n + 1:) = 0.0_wp
   end function flat_facet

   !> The same affine map for both facets of a pair.
   subroutine move(x, y, turned)
      real(wp), intent(inout) :: x(3, 8), y(3, 8)
      logical, intent(in) :: turned           !! by a rotation, else by any plane map as well
      real(wp) :: r(3, 3), map(3, 3), w(3)

      call random_number(w)
      r = rotation_matrix(3.0_wp*w)
      map = 0.0_wp
      map(3, 3) = 1.0_wp
      map(:2, :2) = reshape([1.3_wp, 0.2_wp, -0.4_wp, 0.8_wp], [2, 2])
      if (.not. turned) r = matmul(r, map)
      x = matmul(r, x) + spread(w, 2, 8)
      y = matmul(r, y) + spread(w, 2, 8)
   end subroutine move

   subroutine integrate(slave, master, x, y, sums, slopes)
      integer, intent(in) :: slave, master
      real(wp), intent(in) :: x(3, 8), y(3, 8)
      type(mortar_sums_type), intent(out) :: sums
      type(slope_sums_type), intent(inout), optional :: slopes
      real(wp) :: normal(3, 8), n(3)

      n = cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))
      normal = spread(n/norm2(n), 2, 8)
      call integrate_overlap(kernel, slave, x(:, :kernel%basis%nnode(slave)), &
         & normal(:, :kernel%basis%nnode(slave)), master, y(:, :kernel%basis%nnode(master)), sums, &
         & slopes)
   end subroutine integrate

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> Both sides reproduce linear fields, so that b f(master) = me f(slave); all sums close.
   subroutine flat_parallelograms_are_exact()
      type(mortar_sums_type) :: s
      real(wp) :: x(3, 8), y(3, 8), shift(2), f(8), g(8), a(3), mass(8, 8), n(8)
      type(rule_type) :: rule
      integer :: i, j, k, t

      call test('parallelograms and triangles are integrated exactly')
      do i = 1, 4
         do j = 1, 4
            do t = 1, 20
               x = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
               y = flat_facet(faces(j), .false., 0.0_wp, 0.0_wp)
               call random_number(shift)
               y(:2, :) = (0.6_wp + shift(1))*matmul(reshape([0.8_wp, 0.6_wp, -0.6_wp, 0.8_wp], &
                  & [2, 2]), y(:2, :)) + 0.4_wp*spread(shift, 2, 8)
               call move(x, y, .false.)
               call integrate(faces(i), faces(j), x, y, s)
               if (s%area < 1.0e-6_wp) cycle
               call random_number(a)
               f = matmul(a, x) + 0.3_wp
               g = matmul(a, y) + 0.3_wp
               call close_to(trim(cell_names(faces(i)))//trim(cell_names(faces(j))), &
                  & matmul(s%b, g), matmul(s%me, f), 1.0e-13_wp)
               call close_to('sum of N_j', sum(s%d), s%area, 1.0e-13_wp)
               call close_to('momentum', sum(s%b, dim=2), s%d, 1.0e-13_wp)
               call close_to('mass rows', sum(s%me, dim=2), s%d, 1.0e-13_wp)
               call close_to('symmetry', s%me, transpose(s%me), 1.0e-14_wp)
               call is_true('nothing lost', s%nlost == 0)
            end do
         end do
         x = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
         y = 5.0_wp*flat_facet(cell_id%quad, .false., 0.0_wp, 0.0_wp)
         call integrate(faces(i), cell_id%quad, x, y, s)
         call new_rule(rule, kernel%basis%family(faces(i)), 8)
         mass = 0.0_wp
         do k = 1, rule%npoint
            n = shape_values(kernel%basis, faces(i), rule%xi(:, k))
            mass = mass + rule%weight(k)*spread(n, 1, 8)*spread(n, 2, 8)
         end do
         call close_to('mass of '//trim(cell_names(faces(i))), s%me, mass, 1.0e-13_wp)
         call close_to('area', s%area, sum(rule%weight), 1.0e-13_wp)
      end do
   end subroutine flat_parallelograms_are_exact

   !> Tensor Gauss rule on the common rectangle.
   subroutine shifted_rectangles_have_their_integrals()
      type(mortar_sums_type) :: s
      type(rule_type) :: rule
      real(wp) :: x(3, 8), y(3, 8), place(2), n(8), l(8), b(8, 8), low(2), high(2)
      integer :: k, cell

      call test('shifted rectangles have the integrals of a product rule on what they share')
      call new_rule(rule, cell_family%quad, 9)
      low = [-0.4_wp, -1.0_wp]
      high = [1.0_wp, 0.3_wp]
      do cell = cell_id%quad, cell_id%quad8
         x = flat_facet(cell, .true., 0.0_wp, 0.0_wp)
         y = flat_facet(cell, .false., 0.0_wp, 0.0_wp)
         y(1, :) = y(1, :) + 0.6_wp
         y(2, :) = y(2, :) - 0.7_wp
         call integrate(cell, cell, x, y, s)
         b = 0.0_wp
         do k = 1, rule%npoint
            place = 0.5_wp*(low + high) + 0.5_wp*(high - low)*rule%xi(:, k)
            n = shape_values(kernel%basis, cell, place)
            l = shape_values(kernel%basis, cell, [place(2) + 0.7_wp, place(1) - 0.6_wp])
            b = b + rule%weight(k)*0.25_wp*product(high - low)*spread(n, 2, 8)*spread(l, 1, 8)
         end do
         call close_to('b', s%b, b, 1.0e-13_wp)
      end do
   end subroutine shifted_rectangles_have_their_integrals

   !> A slave facet over a fan of distorted masters: areas add up whatever the inner node does.
   subroutine parts_of_a_slave_add_up()
      type(mortar_sums_type) :: s, whole
      real(wp) :: x(3, 8), y(3, 8), corner(3, 4), inner(3), d(8)
      integer :: i, k, t

      call test('masters that tile the slave give it all its area, none of it twice')
      do i = 1, 4
         do t = 1, 20
            x = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
            corner = reshape([-3.0_wp, -3.0_wp, 0.0_wp, 3.0_wp, -3.0_wp, 0.0_wp, 3.0_wp, 3.0_wp, &
               & 0.0_wp, -3.0_wp, 3.0_wp, 0.0_wp], [3, 4])
            call random_number(inner)
            inner = [inner(1), inner(2), 0.0_wp]
            if (t == 1) inner = [1.0_wp, 0.0_wp, 0.0_wp]
            if (t == 2) inner = [0.0_wp, 0.0_wp, 0.0_wp]
            d = 0.0_wp
            y = 0.0_wp
            do k = 1, 4
               y(:, :3) = reshape([corner(:, 1 + mod(k, 4)), corner(:, k), inner], [3, 3])
               call integrate(faces(i), cell_id%triangle, x, y, s)
               d = d + s%d
            end do
            y(:, :4) = corner(:, 4:1:-1)
            call integrate(faces(i), cell_id%quad, x, y, whole)
            call close_to(trim(cell_names(faces(i))), d, whole%d, 1.0e-11_wp)
            ! Warped and turned: the pieces lie in planes of their own.
            x = flat_facet(faces(i), .true., 0.2_wp, 0.0_wp)
            y(3, :4) = -1.0_wp
            call integrate(faces(i), cell_id%quad, x, y, whole)
            call close_to('area', [area_in_pieces(kernel, faces(i), &
               & x(:, :kernel%basis%nnode(faces(i))))], [whole%area], 1.0e-12_wp)
         end do
      end do
   end subroutine parts_of_a_slave_add_up

   !> Independent of clipping: midpoints of a fine grid over the slave cell, master by its inverse.
   subroutine a_brute_force_sum_agrees()
      integer, parameter :: grid = 300
      type(mortar_sums_type) :: s
      real(wp) :: x(3, 8), y(3, 8), at(2), n(8), l(8), p(3), eta(2), area, b(8, 8), t(2, 2)
      integer :: i, j, k, m

      call test('clipped integrals equal a brute force sum')
      do m = 1, 3
         x = flat_facet(cell_id%quad, .true., 0.15_wp, 0.0_wp)
         y = flat_facet(cell_id%triangle, .false., 0.15_wp, 0.0_wp)
         x(3, :) = 0.0_wp
         y(3, :) = 0.0_wp
         y(:2, :3) = 1.7_wp*y(:2, :3) - 0.5_wp
         call integrate(cell_id%quad, cell_id%triangle, x, y, s)
         b = 0.0_wp
         t = y(:2, 2:3) - spread(y(:2, 1), 2, 2)
         do i = 1, grid
            do j = 1, grid
               at = -1.0_wp + 2.0_wp*(real([i, j], wp) - 0.5_wp)/real(grid, wp)
               n = shape_values(kernel%basis, cell_id%quad, at)
               p = matmul(x(:, :4), n(:4))
               eta = p(:2) - y(:2, 1)
               eta = [t(2, 2)*eta(1) - t(1, 2)*eta(2), t(1, 1)*eta(2) - t(2, 1)*eta(1)] &
                  & /(t(1, 1)*t(2, 2) - t(1, 2)*t(2, 1))
               if (any(eta < 0.0_wp) .or. sum(eta) > 1.0_wp) cycle
               area = 0.0_wp
               do k = 1, 4
                  area = area + 0.25_wp*kernel%basis%xi(1, k, cell_id%quad)*(1.0_wp + at(2) &
                     & *kernel%basis%xi(2, k, cell_id%quad))*x(1, k)
               end do
               area = area*slope(x, at, 2, 2) - slope(x, at, 1, 2)*slope(x, at, 2, 1)
               l = shape_values(kernel%basis, cell_id%triangle, eta)
               b = b + area*(2.0_wp/real(grid, wp))**2*spread(n, 2, 8)*spread(l, 1, 8)
            end do
         end do
         call close_to('b', s%b/s%area, b/s%area, 2.0e-3_wp)
      end do
   end subroutine a_brute_force_sum_agrees

   !> d x(component)/d xi(direction) of a bilinear facet.
   pure real(wp) function slope(x, at, component, direction)
      real(wp), intent(in) :: x(3, 8), at(2)
      integer, intent(in) :: component, direction
      integer :: k

      slope = 0.0_wp
      do k = 1, 4
         associate (xi => kernel%basis%xi(:, k, cell_id%quad))
            slope = slope + 0.25_wp*xi(direction)*(1.0_wp + at(3 - direction)*xi(3 - direction)) &
               & *x(component, k)
         end associate
      end do
   end function slope

   !> Distorted quads: 1e-6 by the default rule, 1e-8 and less by raised ones.
   subroutine degree_removes_the_rest()
      type(mortar_kernel_type) :: kernels(4)
      type(mortar_sums_type) :: s(4)
      real(wp) :: x(3, 8), y(3, 8), normal(3, 8), worst(3)
      integer, parameter :: degree(4) = [5, 8, 12, 30]
      integer :: k, t

      call test('a raised degree removes the error on distorted faces')
      do k = 1, 4
         call new_mortar_kernel(kernels(k), degree(k))
      end do
      normal = spread([0.0_wp, 0.0_wp, 1.0_wp], 2, 8)
      worst = 0.0_wp
      do t = 1, 200
         x = flat_facet(cell_id%quad, .true., 0.2_wp, 0.0_wp)
         y = flat_facet(cell_id%quad, .false., 0.2_wp, 0.0_wp)
         x(3, :) = 0.0_wp
         do k = 1, 4
            call integrate_overlap(kernels(k), cell_id%quad, x(:, :4), normal(:, :4), &
               & cell_id%quad, y(:, :4), s(k))
         end do
         do k = 1, 3
            worst(k) = max(worst(k), maxval(abs(s(k)%b - s(4)%b))/s(4)%area)
         end do
      end do
      print '("   error of 7, 25 and 49 points on distorted quads: ",3es9.1)', worst
      call is_true('seven points', worst(1) < 2.0e-5_wp)
      call is_true('degree 8', worst(2) < 1.0e-6_wp)
      call is_true('degree 12', worst(3) < 1.0e-8_wp)
   end subroutine degree_removes_the_rest

   !> Fourth-order differences over every coordinate, wherever the topology of the cells stays.
   subroutine slopes_equal_differences()
      type(mortar_sums_type) :: s, at(4)
      type(slope_sums_type) :: slopes
      real(wp) :: x(3, 8), y(3, 8), h, worst, off
      integer :: i, j, t, p, a, q, ns, nm, tries

      call test('slopes equal fourth-order differences')
      h = 1.0e-4_wp
      worst = 0.0_wp
      tries = 0
      do i = 1, 4
         do j = 1, 4
            ns = kernel%basis%nnode(faces(i))
            nm = kernel%basis%nnode(faces(j))
            do t = 1, 3
               x = flat_facet(faces(i), .true., 0.1_wp, 0.0_wp)
               y = flat_facet(faces(j), .false., 0.1_wp, 0.1_wp)
               y(1, :) = y(1, :) + 0.23_wp
               y(2, :) = y(2, :) - 0.11_wp
               call move(x, y, .true.)
               call integrate(faces(i), faces(j), x, y, s, slopes)
               do p = 1, ns + nm
                  do a = 1, 3
                     do q = 1, 4
                        associate (step => h*real(merge(q - 3, q - 2, q < 3), wp))
                           if (p <= ns) x(a, p) = x(a, p) + step
                           if (p > ns) y(a, p - ns) = y(a, p - ns) + step
                           call integrate(faces(i), faces(j), x, y, at(q))
                           if (p <= ns) x(a, p) = x(a, p) - step
                           if (p > ns) y(a, p - ns) = y(a, p - ns) - step
                        end associate
                     end do
                     if (any(at%topology /= s%topology)) cycle
                     off = difference_of(slopes, 3*(p - 1) + a, at, h)
                     worst = max(worst, off)
                     tries = tries + 1
                     call close_to(trim(cell_names(faces(i)))//' '//trim(cell_names(faces(j))), &
                        & off, 0.0_wp, 1.0e-8_wp)
                  end do
               end do
            end do
         end do
      end do
      print '("   largest difference of slopes ",es9.1," in ",i0," directions")', worst, tries
   end subroutine slopes_equal_differences

   !> Largest difference of the slopes along one direction, relative to the integrals' size.
   function difference_of(slopes, k, at, h) result(off)
      type(slope_sums_type), intent(in) :: slopes
      integer, intent(in) :: k
      type(mortar_sums_type), intent(in) :: at(4)
      real(wp), intent(in) :: h
      real(wp), parameter :: w(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      real(wp) :: me(8, 8), b(8, 8), d(8), off
      integer :: r, ns, nm

      ns = slopes%ns
      nm = slopes%nm
      me = 0.0_wp
      b = 0.0_wp
      d = 0.0_wp
      do r = 1, 4
         me = me + w(r)/h*at(r)%me
         b = b + w(r)/h*at(r)%b
         d = d + w(r)/h*at(r)%d
      end do
      off = max(maxval(abs(me(:ns, :ns) - slopes%me(k, :ns, :ns))), maxval(abs(b(:ns, :nm) - &
         & slopes%b(k, :ns, :nm))), maxval(abs(d(:ns) - slopes%d(k, :ns))))
      off = off/max(1.0_wp, maxval(abs(b)))
   end function difference_of

   subroutine motion_and_numbering_change_nothing()
      type(mortar_sums_type) :: s, r
      real(wp) :: x(3, 8), y(3, 8), z(3, 8)
      integer :: i, j, t

      call test('rotation, unit and numbering change nothing')
      do i = 1, 4
         do j = 1, 4
            do t = 1, 5
               x = flat_facet(faces(i), .true., 0.1_wp, 0.0_wp)
               y = flat_facet(faces(j), .false., 0.1_wp, 0.1_wp)
               call integrate(faces(i), faces(j), x, y, s)
               call move(x, y, .true.)
               x = 1.0e-3_wp*x
               y = 1.0e-3_wp*y
               call integrate(faces(i), faces(j), x, y, r)
               call close_to('moved', 1.0e6_wp*r%b, s%b, 1.0e-12_wp)
               if (faces(j) /= cell_id%quad) cycle
               z = y
               z(:, :4) = y(:, [3, 4, 1, 2])
               call integrate(faces(i), faces(j), x, z, s)
               call close_to('renumbered master', 1.0e6_wp*s%b(:, [3, 4, 1, 2]), 1.0e6_wp*r%b(:, &
                  & :4), 1.0e-12_wp)
               if (faces(i) /= cell_id%quad) cycle
               z = x
               z(:, :4) = x(:, [2, 3, 4, 1])
               call integrate(faces(i), faces(j), z, y, s)
               call close_to('renumbered slave', 1.0e6_wp*s%b([4, 1, 2, 3], :), 1.0e6_wp*r%b(:4, &
                  & :), 1.0e-12_wp)
            end do
         end do
      end do
   end subroutine motion_and_numbering_change_nothing

   subroutine touching_facets_share_nothing()
      type(mortar_sums_type) :: s
      type(polygon_type) :: a
      type(common_type) :: c
      real(wp) :: x(3, 8), y(3, 8)
      integer :: i

      call test('degenerate positions')
      do i = 1, 4
         x = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
         y = flat_facet(faces(i), .false., 0.0_wp, 0.0_wp)
         call integrate(faces(i), faces(i), x, y, s)
         call close_to('identical', sum(s%d), merge(4.0_wp, 0.5_wp, faces(i) > 4), 1.0e-13_wp)
         y(1, :) = y(1, :) + 1.0_wp + merge(1.0_wp, 0.0_wp, faces(i) > 4)
         call integrate(faces(i), faces(i), x, y, s)
         call is_true('beside', s%ncell == 0)
         y = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
         call integrate(faces(i), faces(i), x, y, s)
         call is_true('looking the same way', s%ncell == 0)
         y = flat_facet(faces(i), .false., 0.0_wp, 0.0_wp)
         y(1, :) = y(1, :) + 1.0e-14_wp
         call integrate(faces(i), faces(i), x, y, s)
         call close_to('hardly moved', sum(s%d), merge(4.0_wp, 0.5_wp, faces(i) > 4), 1.0e-12_wp)
      end do
      ! A quad with two nodes at one place is a triangle.
      x = flat_facet(cell_id%quad, .true., 0.0_wp, 0.0_wp)
      y = 3.0_wp*flat_facet(cell_id%quad, .false., 0.0_wp, 0.0_wp)
      y(:, 4) = y(:, 3)
      call integrate(cell_id%quad, cell_id%quad, x, y, s)
      call close_to('collapsed', s%area, 2.0_wp, 1.0e-12_wp)
      ! A corner on an edge, and an edge on an edge.
      a%n = 4
      a%y = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
      call common_part(a, polygon_type(3, [1, 2, 3, 0], reshape([1.0_wp, 0.5_wp, 2.0_wp, 0.0_wp, &
         & 2.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], [2, 4])), 1.0e-12_wp, c)
      call is_true('corner on an edge', .not. c%area > 0.0_wp)
      call common_part(a, polygon_type(3, [1, 2, 3, 0], reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
         & 0.5_wp, 1.0_wp, 0.0_wp, 0.0_wp], [2, 4])), 1.0e-12_wp, c)
      call close_to('edge on an edge', c%area, 0.5_wp, 1.0e-15_wp)
      call common_part(a, polygon_type(4, [1, 2, 3, 4], reshape([0.5_wp, -0.5_wp, 1.5_wp, 0.5_wp, &
         & 0.5_wp, 1.5_wp, -0.5_wp, 0.5_wp], [2, 4])), 1.0e-12_wp, c)
      call close_to('corners on edges', c%area, 1.0_wp, 1.0e-15_wp)
   end subroutine touching_facets_share_nothing

   subroutine the_gap_is_along_the_normal()
      type(mortar_sums_type) :: s
      real(wp) :: x(3, 8), y(3, 8)
      integer :: i

      call test('the gap of parallel facets is their distance, positive when open')
      do i = 1, 4
         x = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
         y = flat_facet(faces(i), .false., 0.0_wp, 0.25_wp)
         call integrate(faces(i), faces(i), x, y, s)
         call close_to(trim(cell_names(faces(i))), s%gap, 0.25_wp*s%d, 1.0e-13_wp)
      end do
   end subroutine the_gap_is_along_the_normal

   subroutine dual_weights_are_positive()
      type(facet_rule_type) :: rules(6)
      type(mortar_sums_type) :: s
      real(wp) :: x(3, 8), y(3, 8), blend(8, 8), a(8, 8), me(8, 8), d(8), area
      integer :: i, n

      call test('transformed quadratic faces have positive weights and a dual basis')
      call new_facet_rules(rules)
      do i = 2, 4, 2
         n = kernel%basis%nnode(faces(i))
         x = flat_facet(faces(i), .true., 0.0_wp, 0.0_wp)
         y = 5.0_wp*flat_facet(cell_id%quad, .false., 0.0_wp, 0.0_wp)
         call integrate(faces(i), cell_id%quad, x, y, s)
         call take_blend(rules(faces(i)), 1.0_wp, blend(:n, :n))
         d(:n) = matmul(blend(:n, :n), s%d(:n))
         area = s%area
         if (n == 8) call close_to('quad8', d, [spread(0.2_wp, 1, 4), spread(0.8_wp, 1, 4)], &
            & 1.0e-13_wp)
         if (n == 6) call close_to('triangle6', d(:6)/area, [spread(2.0_wp/15.0_wp, 1, 3), &
            & spread(0.2_wp, 1, 3)], 1.0e-13_wp)
         me(:n, :n) = matmul(blend(:n, :n), matmul(s%me(:n, :n), transpose(blend(:n, :n))))
         call dual_matrix(me(:n, :n), d(:n), a(:n, :n))
         me(:n, :n) = matmul(a(:n, :n), me(:n, :n))
         call close_to('biorthogonal', [me(1, 1), me(1, 2), me(n, n), me(n, 1)], &
            & [d(1), 0.0_wp, d(n), 0.0_wp], 1.0e-12_wp)
      end do
   end subroutine dual_weights_are_positive

   subroutine measure()
      type(mortar_sums_type) :: s
      type(slope_sums_type) :: slopes
      real(wp) :: x(3, 8), y(3, 8), time(2)
      integer(lk) :: from, to, rate
      integer :: i, k, pass
      integer, parameter :: runs = 200

      do i = 1, 4
         x = flat_facet(faces(i), .true., 0.1_wp, 0.0_wp)
         y = flat_facet(faces(i), .false., 0.1_wp, 0.1_wp)
         y(1, :) = y(1, :) + 0.4_wp
         do pass = 1, 2
            call system_clock(from, rate)
            do k = 1, merge(runs, runs/4, mod(i, 2) == 1)
               if (pass == 1) call integrate(faces(i), faces(i), x, y, s)
               if (pass == 2) call integrate(faces(i), faces(i), x, y, s, slopes)
            end do
            call system_clock(to)
            time(pass) = 1.0e9_wp*real(to - from, wp)/real(rate, wp)/merge(runs, runs/4, &
               & mod(i, 2) == 1)
         end do
         print '(3x,a,": ",f9.0," ns a pair, with slopes ",f9.0," ns, cells ",i0)', &
            & cell_names(faces(i)), time, s%ncell
      end do
   end subroutine measure
end program test_mortar_3d
