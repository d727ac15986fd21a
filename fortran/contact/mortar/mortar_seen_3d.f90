!> A facet as it is seen along the normal of a plane: the ways from places there back to the facet,
!> and the gap between two facets over such a place.
module lopin_mortar_seen_3d
   use lopin_kinds, only : wp
   use lopin_facet_basis, only : facet_basis_type, coefficients_of, facet_point_of, &
      & facet_tangents, ncoefficient
   use lopin_facet_pieces, only : vertex_weights, most_vertex
   use lopin_mortar_slopes_3d, only : plane_type
   implicit none
   private
   public :: seen_facet_type, see_in_plane, go_back, functions, normal_gap, master_gap

   type :: seen_facet_type
      integer :: cell = 0                  !! cell id: triangle ... quad8
      integer :: n = 0                     !! nodes
      real(wp) :: z(3, most_vertex)        !! place in the plane, height: nodes, and the centre of a
                                           !! quad8 [length]
      real(wp) :: c(3, ncoefficient)       !! coefficients of z by monomials
      logical :: linear = .true.           !! c ends with xi eta
      logical :: straight = .true.         !! edges, as they are seen
      real(wp) :: bend = 0.0_wp            !! largest of c by xi eta, in the plane [length]
      real(wp) :: most = 0.0_wp            !! what a settled step leaves at most [length]
      real(wp) :: normal(3, 8)             !! (n) of the slave: outward unit normals at its nodes
   end type seen_facet_type

   integer, parameter :: most_iterations = 20
   real(wp), parameter :: settled = 1.0e-8_wp      !! a Newton step this small is the last
contains

   !> Places in the plane and heights above it: of the nodes, and of the centre of a quad8.
   pure subroutine see_in_plane(plane, basis, x, facet)
      type(plane_type), intent(in) :: plane
      type(facet_basis_type), intent(in) :: basis
      real(wp), intent(in) :: x(:, :)          !! (3, nodes) [length]
      type(seen_facet_type), intent(inout) :: facet
      real(wp) :: arm(3)
      integer :: i, k

      facet%z = 0.0_wp
      do i = 1, size(x, 2)
         arm = x(:, i) - plane%origin
         do k = 1, 3
            facet%z(k, i) = arm(1)*plane%axis(1, k) + arm(2)*plane%axis(2, k) &
               & + arm(3)*plane%axis(3, k)
         end do
      end do
      if (facet%n > 4) facet%z(:, most_vertex) = matmul(facet%z(:, :8), &
         & vertex_weights(facet%cell, most_vertex))
      facet%c = coefficients_of(basis, facet%cell, facet%z(:, :facet%n))
      facet%linear = facet%n <= 4
      facet%straight = .not. any(abs(facet%c(:2, 5:)) > 0.0_wp)
      facet%bend = maxval(abs(facet%c(:2, 4)))
      facet%most = settled**2*maxval(abs(facet%c(:2, 2:3)))
   end subroutine see_in_plane

   !> n.(x_s - x_m); both points are on one line along the normal of the plane.
   pure real(wp) function normal_gap(slave, master, xi, eta, axis, n) result(gap)
      type(seen_facet_type), intent(in) :: slave, master
      real(wp), intent(in) :: xi(2), eta(2)
      real(wp), intent(in) :: axis(3)          !! normal of the plane
      real(wp), intent(in) :: n(8)             !! functions of the slave at xi
      real(wp) :: own(3), length
      integer :: i

      own = 0.0_wp
      do i = 1, slave%n
         own = own + slave%normal(:, i)*n(i)
      end do
      length = norm2(own)
      gap = height_of(master, eta) - height_of(slave, xi)
      if (length > 0.0_wp) gap = gap*dot_product(own, axis)/length
   end function normal_gap

   !> The same along the normal of the master: the slave's lean where it turns away.
   pure real(wp) function master_gap(slave, master, xi, eta) result(gap)
      type(seen_facet_type), intent(in) :: slave, master
      real(wp), intent(in) :: xi(2), eta(2)
      real(wp) :: t1(3), t2(3), area(3)

      if (master%linear) then
         t1 = master%c(:, 2) + eta(2)*master%c(:, 4)
         t2 = master%c(:, 3) + eta(1)*master%c(:, 4)
      else
         call facet_tangents(master%c, eta, t1, t2)
      end if
      area = [t1(2)*t2(3) - t1(3)*t2(2), t1(3)*t2(1) - t1(1)*t2(3), t1(1)*t2(2) - t1(2)*t2(1)]
      gap = (height_of(master, eta) - height_of(slave, xi))*abs(area(3))/norm2(area)
   end function master_gap

   !> Above the plane [length].
   pure real(wp) function height_of(facet, xi) result(height)
      type(seen_facet_type), intent(in) :: facet
      real(wp), intent(in) :: xi(2)
      real(wp) :: x(3)

      if (facet%linear) then
         height = facet%c(3, 1) + xi(1)*facet%c(3, 2) + xi(2)*facet%c(3, 3) &
            & + xi(1)*xi(2)*facet%c(3, 4)
      else
         x = facet_point_of(facet%c, xi)
         height = x(3)
      end if
   end function height_of

   !> The reference coordinates of a facet over a place in the plane, by Newton's method.
   !>
   !> `slope` is d y/d xi there. The start may lie anywhere in the cell.
   pure subroutine go_back(facet, y, xi, slope, found)
      type(seen_facet_type), intent(in) :: facet
      real(wp), intent(in) :: y(2)
      real(wp), intent(inout) :: xi(2)
      real(wp), intent(out) :: slope(2, 2)
      logical, intent(out) :: found
      real(wp) :: x(3), t1(3), t2(3), r(2), step(2), det
      integer :: i

      if (facet%straight) then
         call go_back_straight(facet%c, facet%bend, facet%most, y, xi, slope, found)
         return
      end if
      found = .false.
      associate (c => facet%c)
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
      end associate
      found = .false.
   end subroutine go_back

   !> The same where edges are straight: a whole step leaves c4 times the product of its parts.
   pure subroutine go_back_straight(c, bend, most, y, xi, slope, found)
      real(wp), intent(in) :: c(3, ncoefficient), bend, most, y(2)
      real(wp), intent(inout) :: xi(2)
      real(wp), intent(out) :: slope(2, 2)
      logical, intent(out) :: found
      real(wp) :: r(2), step(2), det
      integer :: i

      found = .false.
      do i = 1, most_iterations
         slope(:, 1) = c(:2, 2) + xi(2)*c(:2, 4)
         slope(:, 2) = c(:2, 3) + xi(1)*c(:2, 4)
         if (found) return
         r = y - c(:2, 1) - xi(1)*slope(:, 1) - xi(2)*c(:2, 3)
         det = slope(1, 1)*slope(2, 2) - slope(2, 1)*slope(1, 2)
         if (.not. abs(det) > 0.0_wp) return
         step(1) = (slope(2, 2)*r(1) - slope(1, 2)*r(2))/det
         step(2) = (slope(1, 1)*r(2) - slope(2, 1)*r(1))/det
         found = bend*abs(step(1)*step(2)) <= most
         if (.not. found) step = step/max(1.0_wp, abs(step(1)), abs(step(2)))
         xi = xi + step
      end do
      found = .false.
   end subroutine go_back_straight

   !> Shape functions and their two slopes; behind the last of a linear facet nothing is written.
   pure subroutine functions(basis, cell, xi, n)
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: cell
      real(wp), intent(in) :: xi(2)
      real(wp), intent(inout) :: n(8, 0:2)
      real(wp) :: m(8, 0:2)
      integer :: i

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
end module lopin_mortar_seen_3d
