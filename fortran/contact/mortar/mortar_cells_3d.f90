!> Integrals over the overlap of a slave and a master facet in space: clipped polygons.
!>
!> Each piece of the slave facet has a plane through its centre; the master is seen along the
!> normal of that plane, clipped there, and the common polygon is integrated by triangles about its
!> centre (Puso and Laursen 2004). Points go back to both facets along the same normal. Everything
!> but the gap depends only on the places of the nodes in the plane: that is how the slopes are
!> formed.
module lopin_mortar_cells_3d
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_quadrature, only : rule_type, new_rule
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis, coefficients_of, &
      & facet_point_of, facet_tangents, ncoefficient
   use lopin_facet_pieces, only : npiece, piece, ncorner_of_piece, vertex_weights, most_vertex, &
      & piece_polygons
   use lopin_polygon, only : polygon_type, common_type, common_part, polygon_area
   use lopin_mortar_overlap, only : overlap_type, least_type, meet_point
   use lopin_mortar_slopes_3d, only : plane_type, planar_slopes_type, slope_sums_type, &
      & start_slopes, cell_slopes_type, follow_cell, triangle_type, cell_point_type, &
      & add_point_slopes, lift_slopes
   implicit none
   private
   public :: mortar_kernel_type, mortar_sums_type, new_mortar_kernel, integrate_overlap

   !> Tables that all pairs share.
   type :: mortar_kernel_type
      type(facet_basis_type) :: basis
      type(rule_type) :: rule(2)           !! without and with quad8
      type(facet_rule_type) :: facet_rule(6)   !! by cell id
   end type mortar_kernel_type

   !> A facet as it is seen along the normal of a plane.
   type :: projected_facet_type
      integer :: cell = 0                  !! cell id: triangle ... quad8
      integer :: n = 0                     !! nodes
      real(wp) :: z(3, most_vertex)        !! place in the plane, height: nodes, and the centre of a
                                           !! quad8 [length]
      real(wp) :: c(3, ncoefficient)       !! coefficients of z by monomials
      real(wp) :: normal(3, 8)             !! (n) of the slave: outward unit normals at its nodes
   end type projected_facet_type

   !> Integrals over what both share, and how they came about.
   type, extends(overlap_type) :: mortar_sums_type
      integer :: ncell = 0                 !! polygons
      integer :: topology = 0              !! a sum over the lines that meet in their vertices
      integer :: nlost = 0                 !! points whose way back to a facet was not found
   end type mortar_sums_type

   integer, parameter :: most_iterations = 20
   real(wp), parameter :: settled = 1.0e-8_wp      !! a Newton step this small is the last
   real(wp), parameter :: sliver = 1.0e-10_wp      !! of the slave's area: left out
   integer, parameter :: order(6) = [1, 2, 1, 2, 2, 3]   !! of the functions of a facet cell
contains

   !> `degree` of exactness in a triangle of a cell: 5 (seven points) or more; quad8 needs 6.
   pure subroutine new_mortar_kernel(self, degree)
      type(mortar_kernel_type), intent(out) :: self
      integer, intent(in) :: degree

      call new_facet_basis(self%basis)
      call new_rule(self%rule(1), cell_family%triangle, max(5, degree))
      call new_rule(self%rule(2), cell_family%triangle, max(6, degree))
      call new_facet_rules(self%facet_rule)
   end subroutine new_mortar_kernel

   !> Integrals over the overlap of one slave and one master facet; with slopes if wanted.
   !>
   !> The functions are those of the whole facets. The gap is n.(x_s - x_m), n against the slave's
   !> outward nodal normals. Facets that do not face each other share nothing.
   pure subroutine integrate_overlap(self, slave, xs, normal, master, xm, sums, slopes)
      type(mortar_kernel_type), intent(in) :: self
      integer, intent(in) :: slave, master     !! cell ids: triangle ... quad8
      real(wp), intent(in) :: xs(:, :)         !! (3, nodes) slave facet, outward [length]
      real(wp), intent(in) :: normal(:, :)     !! (3, nodes) outward unit normals at its nodes
      real(wp), intent(in) :: xm(:, :)         !! (3, nodes) master facet, outward [length]
      type(mortar_sums_type), intent(out) :: sums
      type(slope_sums_type), intent(inout), optional :: slopes
      type(planar_slopes_type) :: planar
      type(plane_type) :: plane
      type(projected_facet_type) :: own, opposite
      integer :: k, m

      own%cell = slave
      own%n = self%basis%nnode(slave)
      own%normal(:, :own%n) = normal(:, :own%n)
      opposite%cell = master
      opposite%n = self%basis%nnode(master)
      if (present(slopes)) call start_slopes(slopes, own%n, opposite%n)
      do k = 1, npiece(slave)
         call lay_plane(plane, slave, piece(:ncorner_of_piece(slave), k, slave), xs)
         if (.not. plane%area > 0.0_wp) cycle
         call see_in_plane(plane, self%basis, xs, own)
         call see_in_plane(plane, self%basis, xm, opposite)
         if (present(slopes)) call start_slopes(planar, own%n, opposite%n)
         do m = 1, npiece(master)
            call integrate_pieces(self, own, opposite, [k, m], plane, sums, planar)
         end do
         if (present(slopes)) call lift_slopes(planar, plane, own%z, opposite%z, slopes)
      end do
   end subroutine integrate_overlap

   !> The plane of a piece: through the mean of its corners, across its diagonals.
   pure subroutine lay_plane(plane, cell, vertex, x)
      type(plane_type), intent(out) :: plane
      integer, intent(in) :: cell
      integer, intent(in) :: vertex(:)
      real(wp), intent(in) :: x(:, :)
      real(wp) :: w(8, 4), mean(8), e(3), length
      integer :: k, n, m

      n = size(vertex)
      m = size(x, 2)
      mean = 0.0_wp
      do k = 1, n
         w(:, k) = vertex_weights(cell, vertex(k))
         mean = mean + w(:, k)/real(n, wp)
      end do
      plane%origin = matmul(x, mean(:m))
      plane%weight(:, 1) = w(:, n - 1) - w(:, 1)
      plane%weight(:, 2) = w(:, n) - w(:, merge(1, 2, n == 3))
      if (n == 3) plane%weight(:, 1) = w(:, 2) - w(:, 1)
      plane%diagonal = matmul(x, plane%weight(:m, :))
      e = cross(plane%diagonal(:, 1), plane%diagonal(:, 2))
      length = norm2(e)
      plane%area = length
      if (.not. length > 0.0_wp) return
      plane%axis(:, 3) = e/length
      plane%axis(:, 1) = plane%diagonal(:, 1)/norm2(plane%diagonal(:, 1))
      plane%axis(:, 2) = cross(plane%axis(:, 3), plane%axis(:, 1))
   end subroutine lay_plane

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> Places in the plane and heights above it: of the nodes, and of the centre of a quad8.
   pure subroutine see_in_plane(plane, basis, x, facet)
      type(plane_type), intent(in) :: plane
      type(facet_basis_type), intent(in) :: basis
      real(wp), intent(in) :: x(:, :)          !! (3, nodes) [length]
      type(projected_facet_type), intent(inout) :: facet
      integer :: i

      facet%z = 0.0_wp
      do i = 1, size(x, 2)
         facet%z(:, i) = matmul(x(:, i) - plane%origin, plane%axis)
      end do
      facet%z(:, most_vertex) = matmul(facet%z(:, :8), vertex_weights(facet%cell, most_vertex))
      facet%c = coefficients_of(basis, facet%cell, facet%z(:, :facet%n))
   end subroutine see_in_plane

   !> What one piece of the slave and one of the master share; slopes where `planar` is started.
   pure subroutine integrate_pieces(self, slave, master, number, plane, sums, planar)
      type(mortar_kernel_type), intent(in) :: self
      type(projected_facet_type), intent(in) :: slave, master
      integer, intent(in) :: number(2)         !! of the piece in the slave, in the master
      type(plane_type), intent(in) :: plane
      type(mortar_sums_type), intent(inout) :: sums
      type(planar_slopes_type), intent(inout) :: planar
      type(polygon_type) :: a(2), b(2)
      type(common_type) :: c
      type(cell_slopes_type) :: motion
      real(wp) :: tolerance, own
      integer :: i, j, v, na, nb

      own = sqrt(plane%area)
      tolerance = 1.0e-12_wp*own + 8.0_wp*epsilon(1.0_wp)*maxval(abs(plane%origin))
      call piece_polygons(piece(:ncorner_of_piece(slave%cell), number(1), slave%cell), &
         & slave%z(:2, :), 1, tolerance, a, na)
      call piece_polygons(piece(:ncorner_of_piece(master%cell), number(2), master%cell), &
         & master%z(:2, :), -1, tolerance, b, nb)
      own = 0.0_wp
      do i = 1, na
         own = own + polygon_area(a(i)%y(:, :a(i)%n))
      end do
      do i = 1, na
         do j = 1, nb
            call common_part(a(i), b(j), tolerance, c)
            if (c%n == 0 .or. c%area <= sliver*own) cycle
            sums%ncell = sums%ncell + 1
            sums%area = sums%area + c%area
            sums%topology = mod(101*sums%topology + sum(c%line(1, :c%n)*[(v, v=1, c%n)]) &
               & + 17*sum(c%line(2, :c%n)*[(v, v=1, c%n)]), 1000003)
            if (planar%n > 0) call follow_cell(planar, slave%cell, master%cell, a(i), b(j), c, &
               & motion)
            call integrate_cell(self, slave, master, plane, c, sums, planar, motion)
         end do
      end do
   end subroutine integrate_pieces

   !> A polygon by triangles about its centre.
   pure subroutine integrate_cell(self, slave, master, plane, c, sums, planar, motion)
      type(mortar_kernel_type), intent(in) :: self
      type(projected_facet_type), intent(in) :: slave, master
      type(plane_type), intent(in) :: plane
      type(common_type), intent(in) :: c
      type(mortar_sums_type), intent(inout) :: sums
      type(planar_slopes_type), intent(inout) :: planar
      type(cell_slopes_type), intent(in) :: motion
      type(triangle_type) :: triangle
      type(cell_point_type) :: point
      real(wp) :: y(2), gap, xi(2), eta(2)
      integer :: i, g, which
      logical :: found(2)

      if (planar%n == 0) call meet_corners(self, slave, master, c, sums%least)
      triangle%corner(:, 1) = sum(c%y(:, :c%n), dim=2)/real(c%n, wp)
      which = merge(2, 1, order(slave%cell) + max(order(slave%cell), order(master%cell)) > 5)
      do i = 1, c%n
         triangle%number = i
         triangle%corner(:, 2) = c%y(:, i)
         triangle%corner(:, 3) = c%y(:, 1 + mod(i, c%n))
         triangle%area = 2.0_wp*polygon_area(triangle%corner)
         xi = self%basis%centre(:, slave%cell)
         eta = self%basis%centre(:, master%cell)
         do g = 1, self%rule(which)%npoint
            point%bary(2:) = self%rule(which)%xi(:, g)
            point%bary(1) = 1.0_wp - point%bary(2) - point%bary(3)
            y = matmul(triangle%corner, point%bary)
            point%weight = self%rule(which)%weight(g)
            call go_back(slave%c, y, xi, point%js, found(1))
            call go_back(master%c, y, eta, point%jm, found(2))
            if (.not. all(found)) then
               sums%nlost = sums%nlost + 1
               cycle
            end if
            call functions(self%basis, slave%cell, xi, point%n)
            call functions(self%basis, master%cell, eta, point%l)
            gap = normal_gap(slave, master, xi, eta, plane, point%n(:, 0))
            call add_values(point%weight*triangle%area, gap, slave%n, master%n, point%n(:, 0), &
               & point%l(:, 0), sums)
            if (planar%n > 0) then
               call add_point_slopes(planar, motion, triangle, point)
            else
               call meet_point(sums%least, master_gap(slave%c, master%c, xi, eta), point%n(:, 0), &
                  & point%l(:, 0))
            end if
         end do
      end do
   end subroutine integrate_cell

   !> The gaps at the corners of a polygon: between flat facets the least is one of them.
   pure subroutine meet_corners(self, slave, master, c, least)
      type(mortar_kernel_type), intent(in) :: self
      type(projected_facet_type), intent(in) :: slave, master
      type(common_type), intent(in) :: c
      type(least_type), intent(inout) :: least
      real(wp) :: n(8, 0:2), l(8, 0:2), slope(2, 2), xi(2), eta(2)
      logical :: found(2)
      integer :: k

      xi = self%basis%centre(:, slave%cell)
      eta = self%basis%centre(:, master%cell)
      do k = 1, c%n
         call go_back(slave%c, c%y(:, k), xi, slope, found(1))
         call go_back(master%c, c%y(:, k), eta, slope, found(2))
         if (.not. all(found)) cycle
         call functions(self%basis, slave%cell, xi, n)
         call functions(self%basis, master%cell, eta, l)
         call meet_point(least, master_gap(slave%c, master%c, xi, eta), n(:, 0), l(:, 0))
      end do
   end subroutine meet_corners

   pure subroutine add_values(weight, gap, ns, nm, n, l, sums)
      real(wp), intent(in) :: weight, gap
      integer, intent(in) :: ns, nm
      real(wp), intent(in) :: n(8), l(8)
      type(mortar_sums_type), intent(inout) :: sums
      integer :: k

      do k = 1, ns
         sums%me(:ns, k) = sums%me(:ns, k) + weight*n(k)*n(:ns)
      end do
      do k = 1, nm
         sums%b(:ns, k) = sums%b(:ns, k) + weight*l(k)*n(:ns)
      end do
      sums%d(:ns) = sums%d(:ns) + weight*n(:ns)
      sums%gap(:ns) = sums%gap(:ns) + weight*gap*n(:ns)
   end subroutine add_values

   !> n.(x_s - x_m); both points are on one line along the normal of the plane.
   pure real(wp) function normal_gap(slave, master, xi, eta, plane, n) result(gap)
      type(projected_facet_type), intent(in) :: slave, master
      real(wp), intent(in) :: xi(2), eta(2)
      type(plane_type), intent(in) :: plane
      real(wp), intent(in) :: n(8)             !! functions of the slave at xi
      real(wp) :: xs(3), xm(3), own(3), length

      xs = facet_point_of(slave%c, xi)
      xm = facet_point_of(master%c, eta)
      own = matmul(slave%normal(:, :slave%n), n(:slave%n))
      length = norm2(own)
      gap = xm(3) - xs(3)
      if (length > 0.0_wp) gap = gap*dot_product(own, plane%axis(:, 3))/length
   end function normal_gap

   !> The same along the normal of the master: the slave's lean where it turns away.
   pure real(wp) function master_gap(cs, cm, xi, eta) result(gap)
      real(wp), intent(in) :: cs(3, ncoefficient), cm(3, ncoefficient), xi(2), eta(2)
      real(wp) :: xs(3), xm(3), t1(3), t2(3), area(3)

      xs = facet_point_of(cs, xi)
      xm = facet_point_of(cm, eta)
      call facet_tangents(cm, eta, t1, t2)
      area = [t1(2)*t2(3) - t1(3)*t2(2), t1(3)*t2(1) - t1(1)*t2(3), t1(1)*t2(2) - t1(2)*t2(1)]
      gap = (xm(3) - xs(3))*abs(area(3))/norm2(area)
   end function master_gap

   !> The reference coordinates of a facet over a place in the plane, by Newton's method.
   !>
   !> `slope` is d y/d xi there. The start may lie anywhere in the cell.
   pure subroutine go_back(c, y, xi, slope, found)
      real(wp), intent(in) :: c(3, ncoefficient), y(2)
      real(wp), intent(inout) :: xi(2)
      real(wp), intent(out) :: slope(2, 2)
      logical, intent(out) :: found
      real(wp) :: x(3), t1(3), t2(3), r(2), step(2), det
      integer :: i

      if (.not. any(abs(c(:2, 5:)) > 0.0_wp)) then
         call go_back_straight(c(:2, :4), y, xi, slope, found)
         return
      end if
      found = .false.
      do i = 1, most_iterations
         x = facet_point_of(c, xi)
         call facet_tangents(c, xi, t1, t2)
         slope(:, 1) = t1(:2)
         slope(:, 2) = t2(:2)
         if (found) return
         r = y - x(:2)
         det = t1(1)*t2(2) - t1(2)*t2(1)
         if (.not. abs(det) > 0.0_wp) return
         step = [t2(2)*r(1) - t2(1)*r(2), t1(1)*r(2) - t1(2)*r(1)]/det
         found = maxval(abs(step)) <= settled
         xi = xi + step/max(1.0_wp, maxval(abs(step)))
      end do
      found = .false.
   end subroutine go_back

   !> The same where edges are straight: a whole step leaves c4 times the product of its parts.
   pure subroutine go_back_straight(c, y, xi, slope, found)
      real(wp), intent(in) :: c(2, 4), y(2)
      real(wp), intent(inout) :: xi(2)
      real(wp), intent(out) :: slope(2, 2)
      logical, intent(out) :: found
      real(wp) :: r(2), step(2), det, most, bend
      integer :: i

      found = .false.
      bend = maxval(abs(c(:, 4)))
      most = settled**2*maxval(abs(c(:, 2:3)))
      do i = 1, most_iterations
         slope(:, 1) = c(:, 2) + xi(2)*c(:, 4)
         slope(:, 2) = c(:, 3) + xi(1)*c(:, 4)
         if (found) return
         r = y - c(:, 1) - xi(1)*slope(:, 1) - xi(2)*c(:, 3)
         det = slope(1, 1)*slope(2, 2) - slope(2, 1)*slope(1, 2)
         if (.not. abs(det) > 0.0_wp) return
         step = [slope(2, 2)*r(1) - slope(1, 2)*r(2), slope(1, 1)*r(2) - slope(2, 1)*r(1)]/det
         found = bend*abs(step(1)*step(2)) <= most
         if (.not. found) step = step/max(1.0_wp, maxval(abs(step)))
         xi = xi + step
      end do
      found = .false.
   end subroutine go_back_straight

   !> Shape functions and their two slopes.
   pure subroutine functions(basis, cell, xi, n)
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: cell
      real(wp), intent(in) :: xi(2)
      real(wp), intent(out) :: n(8, 0:2)
      real(wp) :: m(8, 0:2)
      integer :: i

      n = 0.0_wp
      if (basis%nnode(cell) <= 4) then
         do i = 1, basis%nnode(cell)
            associate (t => basis%transform(:4, i, cell))
               n(i, 1) = t(2) + xi(2)*t(4)
               n(i, 2) = t(3) + xi(1)*t(4)
               n(i, 0) = t(1) + xi(1)*n(i, 1) + xi(2)*t(3)
            end associate
         end do
         return
      end if
      associate (a => xi(1), b => xi(2), o => 0.0_wp)
         m(:, 0) = [1.0_wp, a, b, a*b, a**2, b**2, a**2*b, a*b**2]
         m(:, 1) = [o, 1.0_wp, o, b, 2.0_wp*a, o, 2.0_wp*a*b, b**2]
         m(:, 2) = [o, o, 1.0_wp, a, o, 2.0_wp*b, a**2, 2.0_wp*a*b]
      end associate
      do i = 1, basis%nnode(cell)
         n(i, :) = matmul(basis%transform(:8, i, cell), m)
      end do
   end subroutine functions
end module lopin_mortar_cells_3d
