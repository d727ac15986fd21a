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
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis
   use lopin_facet_pieces, only : npiece, piece, ncorner_of_piece, vertex_weights, piece_polygons
   use lopin_polygon, only : polygon_type, common_type, common_part, polygon_area
   use lopin_mortar_overlap, only : overlap_type, least_type, meet_point
   use lopin_mortar_seen_3d, only : seen_facet_type, see_in_plane, go_back, functions, normal_gap, &
      & master_gap
   use lopin_mortar_slopes_3d, only : plane_type, planar_slopes_type, slope_sums_type, &
      & start_slopes, cell_slopes_type, follow_cell, triangle_type, cell_point_type, &
      & add_point_slopes, lift_slopes
   implicit none
   private
   public :: mortar_kernel_type, mortar_sums_type, new_mortar_kernel, integrate_overlap, &
      & area_in_pieces

   !> Tables that all pairs share.
   type :: mortar_kernel_type
      type(facet_basis_type) :: basis
      type(rule_type) :: rule(2)           !! without and with quad8
      type(facet_rule_type) :: facet_rule(6)   !! by cell id
   end type mortar_kernel_type

   !> Integrals over what both share, and how they came about.
   type, extends(overlap_type) :: mortar_sums_type
      integer :: ncell = 0                 !! polygons
      integer :: topology = 0              !! a sum over the lines that meet in their vertices
      integer :: nlost = 0                 !! points whose way back to a facet was not found
   end type mortar_sums_type

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

   !> Integrals over the overlap of one slave and one master facet; with slopes if wanted, and then
   !> without gaps.
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
      type(seen_facet_type) :: own, opposite
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

   !> Area of a facet in the planes of its pieces: what a master that covers it shares with it.
   pure real(wp) function area_in_pieces(self, cell, x) result(area)
      type(mortar_kernel_type), intent(in) :: self
      integer, intent(in) :: cell              !! cell id: triangle ... quad8
      real(wp), intent(in) :: x(:, :)          !! (3, nodes) outward [length]
      type(plane_type) :: plane
      type(seen_facet_type) :: own
      type(polygon_type) :: part(2)
      integer :: i, k, n

      own%cell = cell
      own%n = self%basis%nnode(cell)
      area = 0.0_wp
      do k = 1, npiece(cell)
         call lay_plane(plane, cell, piece(:ncorner_of_piece(cell), k, cell), x)
         if (.not. plane%area > 0.0_wp) cycle
         call see_in_plane(plane, self%basis, x, own)
         call piece_polygons(piece(:ncorner_of_piece(cell), k, cell), own%z(:2, :), 1, &
            & tolerance_in(plane), part, n)
         do i = 1, n
            area = area + polygon_area(part(i)%y(:, :part(i)%n))
         end do
      end do
   end function area_in_pieces

   !> A length that is none, in a plane.
   pure real(wp) function tolerance_in(plane)
      type(plane_type), intent(in) :: plane
      tolerance_in = 1.0e-12_wp*sqrt(plane%area) + 8.0_wp*epsilon(1.0_wp)*maxval(abs(plane%origin))
   end function tolerance_in

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

   !> What one piece of the slave and one of the master share; slopes where `planar` is started.
   pure subroutine integrate_pieces(self, slave, master, number, plane, sums, planar)
      type(mortar_kernel_type), intent(in) :: self
      type(seen_facet_type), intent(in) :: slave, master
      integer, intent(in) :: number(2)         !! of the piece in the slave, in the master
      type(plane_type), intent(in) :: plane
      type(mortar_sums_type), intent(inout) :: sums
      type(planar_slopes_type), intent(inout) :: planar
      type(polygon_type) :: a(2), b(2)
      type(common_type) :: c
      type(cell_slopes_type) :: motion
      real(wp) :: tolerance, own
      integer :: i, j, v, na, nb

      tolerance = tolerance_in(plane)
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
      type(seen_facet_type), intent(in) :: slave, master
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
            call go_back(slave, y, xi, point%js, found(1))
            call go_back(master, y, eta, point%jm, found(2))
            if (.not. all(found)) then
               sums%nlost = sums%nlost + 1
               cycle
            end if
            call functions(self%basis, slave%cell, xi, point%n)
            call functions(self%basis, master%cell, eta, point%l)
            call add_values(point%weight*triangle%area, slave%n, master%n, point%n(:, 0), &
               & point%l(:, 0), sums)
            if (planar%n > 0) then
               call add_point_slopes(planar, motion, triangle, point)
               cycle
            end if
            gap = normal_gap(slave, master, xi, eta, plane%axis(:, 3), point%n(:, 0))
            sums%gap(:slave%n) = sums%gap(:slave%n) + point%weight*triangle%area*gap &
               & *point%n(:slave%n, 0)
            call meet_point(sums%least, master_gap(slave, master, xi, eta), point%n(:, 0), &
               & point%l(:, 0))
         end do
      end do
   end subroutine integrate_cell

   !> The gaps at the corners of a polygon: between flat facets the least is one of them.
   pure subroutine meet_corners(self, slave, master, c, least)
      type(mortar_kernel_type), intent(in) :: self
      type(seen_facet_type), intent(in) :: slave, master
      type(common_type), intent(in) :: c
      type(least_type), intent(inout) :: least
      real(wp) :: n(8, 0:2), l(8, 0:2), slope(2, 2), xi(2), eta(2)
      logical :: found(2)
      integer :: k

      n = 0.0_wp
      l = 0.0_wp
      xi = self%basis%centre(:, slave%cell)
      eta = self%basis%centre(:, master%cell)
      do k = 1, c%n
         call go_back(slave, c%y(:, k), xi, slope, found(1))
         call go_back(master, c%y(:, k), eta, slope, found(2))
         if (.not. all(found)) cycle
         call functions(self%basis, slave%cell, xi, n)
         call functions(self%basis, master%cell, eta, l)
         call meet_point(least, master_gap(slave, master, xi, eta), n(:, 0), l(:, 0))
      end do
   end subroutine meet_corners

   pure subroutine add_values(weight, ns, nm, n, l, sums)
      real(wp), intent(in) :: weight
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
   end subroutine add_values
end module lopin_mortar_cells_3d
