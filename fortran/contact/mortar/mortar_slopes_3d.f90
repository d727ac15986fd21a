!> Exact first derivatives of the integrals of lopin_mortar_cells_3d.
!>
!> Within the plane of a piece everything follows the places of the nodes there: the vertices of
!> the cell, its triangles, the points and their ways back. Then the plane turns with the diagonals
!> of the piece: a node at height z above it moves by -z dn, so that heights and the turning enter
!> only at the end. Directions in the plane: (1, 2) of slave node 1, of slave node 2, ..., of master
!> node 1, ...; in space the same with (1, 2, 3). The topology of the cell is held.
module lopin_mortar_slopes_3d
   use lopin_kinds, only : wp
   use lopin_facet_pieces, only : vertex_weights
   use lopin_polygon, only : polygon_type, common_type, most_vertices, vertex_slopes
   implicit none
   private
   public :: plane_type, planar_slopes_type, slope_sums_type, cell_slopes_type
   public :: triangle_type, cell_point_type
   public :: start_slopes, follow_cell, add_point_slopes, lift_slopes, most_planar, most_spatial

   integer, parameter :: most_planar = 32, most_spatial = 48

   !> The plane in which a piece of the slave is cut.
   type :: plane_type
      real(wp) :: origin(3) = 0.0_wp           !! [length]
      real(wp) :: axis(3, 3) = 0.0_wp          !! two in the plane, then the normal out of the slave
      real(wp) :: diagonal(3, 2) = 0.0_wp      !! across which the normal is [length]
      real(wp) :: weight(8, 2) = 0.0_wp        !! the diagonals by the slave's nodes
      real(wp) :: area = 0.0_wp                !! |first x second diagonal| [length^2]
   end type plane_type

   !> Slopes along the places in the plane.
   type :: planar_slopes_type
      integer :: ns = 0, nm = 0, n = 0         !! nodes; n = 2 (ns + nm), 0: not wanted
      real(wp) :: me(most_planar, 8, 8)        !! lower triangle [length]
      real(wp) :: b(most_planar, 8, 8)
   end type planar_slopes_type

   !> Slopes along the coordinates: of N_j N_k, of N_j and of N_j M_l.
   type :: slope_sums_type
      integer :: ns = 0, nm = 0, n = 0         !! nodes; n = 3 (ns + nm)
      real(wp) :: me(most_spatial, 8, 8)       !! [length]
      real(wp) :: d(most_spatial, 8)
      real(wp) :: b(most_spatial, 8, 8)
   end type slope_sums_type

   !> Slopes of the vertices of a cell and of its centre.
   type :: cell_slopes_type
      integer :: n = 0
      real(wp) :: vertex(most_planar, 2, most_vertices)
      real(wp) :: centre(most_planar, 2)
   end type cell_slopes_type

   !> A triangle of a cell: centre, a vertex, the next.
   type :: triangle_type
      integer :: number = 0                    !! of the first vertex
      real(wp) :: corner(2, 3) = 0.0_wp        !! in the plane [length]
      real(wp) :: area = 0.0_wp                !! twice its area [length^2]
   end type triangle_type

   !> An integration point of a triangle, as both facets see it.
   type :: cell_point_type
      real(wp) :: bary(3) = 0.0_wp             !! place in the triangle
      real(wp) :: weight = 0.0_wp
      real(wp) :: n(8, 0:2) = 0.0_wp, l(8, 0:2) = 0.0_wp   !! functions, slopes: slave, master
      real(wp) :: js(2, 2) = 0.0_wp, jm(2, 2) = 0.0_wp     !! d y/d xi of both [length]
   end type cell_point_type

   interface start_slopes
      module procedure start_planar, start_spatial
   end interface start_slopes

contains

   pure subroutine start_planar(self, ns, nm)
      type(planar_slopes_type), intent(inout) :: self
      integer, intent(in) :: ns, nm

      self%ns = ns
      self%nm = nm
      self%n = 2*(ns + nm)
      self%me(:self%n, :ns, :ns) = 0.0_wp
      self%b(:self%n, :ns, :nm) = 0.0_wp
   end subroutine start_planar

   pure subroutine start_spatial(self, ns, nm)
      type(slope_sums_type), intent(inout) :: self
      integer, intent(in) :: ns, nm

      self%ns = ns
      self%nm = nm
      self%n = 3*(ns + nm)
      self%me(:self%n, :ns, :ns) = 0.0_wp
      self%d(:self%n, :ns) = 0.0_wp
      self%b(:self%n, :ns, :nm) = 0.0_wp
   end subroutine start_spatial

   !> The motion of the vertices of a cell with the nodes.
   pure subroutine follow_cell(planar, slave, master, a, b, c, motion)
      type(planar_slopes_type), intent(in) :: planar
      integer, intent(in) :: slave, master           !! cell ids
      type(polygon_type), intent(in) :: a, b
      type(common_type), intent(in) :: c
      type(cell_slopes_type), intent(out) :: motion
      real(wp) :: by_end(2, 2, 4), w(8)
      integer :: i, k, q, end(4), at, m, first

      motion%n = c%n
      motion%centre = 0.0_wp
      do i = 1, c%n
         motion%vertex(:, :, i) = 0.0_wp
         call vertex_slopes(a, b, c, i, end, by_end)
         do k = 1, 4
            if (end(k) == 0) cycle
            if (end(k) <= a%n) then
               w = vertex_weights(slave, a%vertex(end(k)))
               first = 0
               m = planar%ns
            else
               w = vertex_weights(master, b%vertex(end(k) - a%n))
               first = planar%ns
               m = planar%nm
            end if
            do q = 1, m
               if (.not. abs(w(q)) > 0.0_wp) cycle
               at = 2*(first + q)
               motion%vertex(at - 1:at, :, i) = motion%vertex(at - 1:at, :, i) &
                  & + w(q)*transpose(by_end(:, :, k))
            end do
         end do
         motion%centre = motion%centre + motion%vertex(:, :, i)/real(c%n, wp)
      end do
   end subroutine follow_cell

   !> What one point of a triangle of a cell adds.
   pure subroutine add_point_slopes(self, motion, triangle, point)
      type(planar_slopes_type), intent(inout) :: self
      type(cell_slopes_type), intent(in) :: motion
      type(triangle_type), intent(in) :: triangle
      type(cell_point_type), intent(in) :: point
      real(wp) :: e(2), f(2), stretch(most_planar), y(most_planar, 2)
      real(wp) :: xi(most_planar, 2), eta(most_planar, 2), whole(most_planar)
      real(wp) :: own(most_planar, 8), opposite(most_planar, 8)   !! of N_j, of M_k alone
      integer :: j, k, next, m

      m = self%n
      next = 1 + mod(triangle%number, motion%n)
      e = triangle%corner(:, 2) - triangle%corner(:, 1)
      f = triangle%corner(:, 3) - triangle%corner(:, 1)
      associate (v => motion%vertex, c => motion%centre, i => triangle%number, &
         & bary => point%bary, weight => point%weight)
         stretch(:m) = weight*((v(:m, 1, i) - c(:m, 1))*f(2) - (v(:m, 2, i) - c(:m, 2))*f(1) &
            & + e(1)*(v(:m, 2, next) - c(:m, 2)) - e(2)*(v(:m, 1, next) - c(:m, 1)))
         y(:m, :) = bary(1)*c(:m, :) + bary(2)*v(:m, :, i) + bary(3)*v(:m, :, next)
      end associate
      call follow_way_back(0, point%n(:self%ns, 0), point%js, y(:m, :), xi(:m, :))
      call follow_way_back(self%ns, point%l(:self%nm, 0), point%jm, y(:m, :), eta(:m, :))
      associate (n => point%n, l => point%l, area => point%weight*triangle%area)
         do k = 1, self%nm
            opposite(:m, k) = area*(eta(:m, 1)*l(k, 1) + eta(:m, 2)*l(k, 2))
         end do
         do j = 1, self%ns
            own(:m, j) = 0.5_wp*stretch(:m)*n(j, 0) + area*(xi(:m, 1)*n(j, 1) + xi(:m, 2)*n(j, 2))
            do k = 1, j
               self%me(:m, j, k) = self%me(:m, j, k) + own(:m, j)*n(k, 0) + own(:m, k)*n(j, 0)
            end do
            whole(:m) = own(:m, j) + 0.5_wp*stretch(:m)*n(j, 0)
            do k = 1, self%nm
               self%b(:m, j, k) = self%b(:m, j, k) + whole(:m)*l(k, 0) + opposite(:m, k)*n(j, 0)
            end do
         end do
      end associate
   end subroutine add_point_slopes

   !> Slopes of the reference coordinates over a moving place: J dxi = dy - sum_i N_i dy_i.
   pure subroutine follow_way_back(first, n, slope, y, xi)
      integer, intent(in) :: first                 !! nodes before those of this facet
      real(wp), intent(in) :: n(:)                 !! its shape functions
      real(wp), intent(in) :: slope(2, 2), y(:, :)
      real(wp), intent(out) :: xi(:, :)
      real(wp) :: r(size(y, 1), 2), det
      integer :: i, at

      r = y
      do i = 1, size(n)
         at = 2*(first + i)
         r(at - 1, 1) = r(at - 1, 1) - n(i)
         r(at, 2) = r(at, 2) - n(i)
      end do
      det = slope(1, 1)*slope(2, 2) - slope(1, 2)*slope(2, 1)
      xi(:, 1) = (slope(2, 2)*r(:, 1) - slope(1, 2)*r(:, 2))/det
      xi(:, 2) = (slope(1, 1)*r(:, 2) - slope(2, 1)*r(:, 1))/det
   end subroutine follow_way_back

   !> From the plane into space.
   pure subroutine lift_slopes(planar, plane, zs, zm, slopes)
      type(planar_slopes_type), intent(in) :: planar
      type(plane_type), intent(in) :: plane
      real(wp), intent(in) :: zs(:, :), zm(:, :)   !! (3, nodes) in the plane, height [length]
      type(slope_sums_type), intent(inout) :: slopes
      real(wp) :: height(planar%ns + planar%nm), g(most_spatial)
      integer :: j, k, m

      m = slopes%n
      height(:planar%ns) = zs(3, :planar%ns)
      height(planar%ns + 1:) = zm(3, :planar%nm)
      do j = 1, planar%ns
         do k = 1, j
            g(:m) = lifted(planar%me(:planar%n, j, k))
            slopes%me(:m, j, k) = slopes%me(:m, j, k) + g(:m)
            slopes%d(:m, j) = slopes%d(:m, j) + g(:m)
            if (j == k) cycle
            slopes%me(:m, k, j) = slopes%me(:m, k, j) + g(:m)
            slopes%d(:m, k) = slopes%d(:m, k) + g(:m)
         end do
         do k = 1, planar%nm
            slopes%b(:m, j, k) = slopes%b(:m, j, k) + lifted(planar%b(:planar%n, j, k))
         end do
      end do

   contains

      pure function lifted(p) result(g)
         real(wp), intent(in) :: p(:)
         real(wp) :: g(3*size(height)), own(3), h(3), turn(3, 2)
         integer :: i

         h = 0.0_wp
         do i = 1, size(height)
            own = plane%axis(:, 1)*p(2*i - 1) + plane%axis(:, 2)*p(2*i)
            g(3*i - 2:3*i) = own
            h = h - height(i)*own
         end do
         turn(:, 1) = cross(plane%diagonal(:, 2), h)/plane%area
         turn(:, 2) = cross(h, plane%diagonal(:, 1))/plane%area
         do i = 1, planar%ns
            g(3*i - 2:3*i) = g(3*i - 2:3*i) + matmul(turn, plane%weight(i, :))
         end do
      end function lifted
   end subroutine lift_slopes

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross
end module lopin_mortar_slopes_3d
