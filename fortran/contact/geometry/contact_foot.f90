!> The foot of a slave point on a facet or a tool in dual numbers: gap, normal, slip, shares.
!>
!> The projection itself is found in real numbers. One Newton step of its equations in dual numbers,
!> at the solution, gives the exact first derivatives of the foot (implicit function theorem); all
!> that follows is arithmetic. On edges the foot moves along the edge, at vertices it stays.
module lopin_contact_foot
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, dual_dot, dual_cross, dual_norm, operator(+), &
      & operator(-), operator(*), operator(/), assignment(=), sqrt, sin
   use lopin_cells, only : cell_family
   use lopin_facet_basis, only : facet_basis_type, shape_derivatives, monomial_derivatives, &
      & ncoefficient
   use lopin_smooth_facet, only : stencil_type
   use lopin_smooth_dual, only : dual_coefficients
   use lopin_projection, only : place, edge_ends
   use lopin_feature, only : projection_type
   use lopin_tool, only : foot_type
   implicit none
   private
   public :: facet_place_type, facet_foot, smooth_facet_foot, tool_motion, tool_foot, turned, &
      & turned_back

   !> Where on a facet a foot is.
   type :: facet_place_type
      integer :: cell = 0                          !! id of the facet's cell
      type(projection_type) :: found               !! of the values, on the smoothed facet if it is
      integer :: feature = 0                       !! edge of the foot, if it is on one
      real(wp) :: size = 1.0_wp                    !! of the facet [length]
   end type facet_place_type

   !> Distances below this share of the facet have no direction of their own.
   real(wp), parameter :: coincident = 1.0e-9_wp

contains

   !> Gap, normal and shares of the facet's nodes.
   pure subroutine facet_foot(basis, at, slave, node, gap, normal, shares)
      type(facet_basis_type), intent(in) :: basis
      type(facet_place_type), intent(in) :: at
      type(dual_type), intent(in) :: slave(3), node(:, :)   !! (3, nnode) places [length]
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type), intent(out) :: shares(:)    !! (nnode)
      real(wp) :: m(8, 6)
      type(dual_type) :: d(2)
      integer :: i, k

      call shape_derivatives(basis, at%cell, at%found%xi, m)
      k = size(node, 2)
      call foot_of_points(basis%family(at%cell), m(:k, :), at, slave, node, gap, normal, d)
      do i = 1, k
         shares(i) = m(i, 1) + m(i, 2)*d(1) + m(i, 3)*d(2)
      end do
   end subroutine facet_foot

   !> The same on a smoothed facet: shaped by its stencil, carried by the facet's own nodes.
   pure subroutine smooth_facet_foot(basis, at, slave, node, stencil, gap, normal, shares)
      type(facet_basis_type), intent(in) :: basis
      type(facet_place_type), intent(in) :: at     !! the cell is linear
      type(dual_type), intent(in) :: slave(3), node(:, :)   !! (3, stencil%n) places [length]
      type(stencil_type), intent(in) :: stencil    !! its first nodes are the facet's
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type), intent(out) :: shares(:)    !! (nodes of the facet)
      real(wp) :: m(8, 6)
      type(dual_type) :: c(3, ncoefficient), d(2)
      integer :: i

      call dual_coefficients(stencil, basis, at%cell, node, c)
      call foot_of_points(basis%family(at%cell), monomial_derivatives(at%found%xi), at, slave, c, &
         & gap, normal, d)
      call shape_derivatives(basis, at%cell, at%found%xi, m)
      do i = 1, basis%nnode(at%cell)
         shares(i) = m(i, 1) + m(i, 2)*d(1) + m(i, 3)*d(2)
      end do
   end subroutine smooth_facet_foot

   !> Foot on sum_i m(i, 1) node(:, i); `m` has that and its derivatives by xi, eta, xi xi, xi eta,
   !> eta eta.
   pure subroutine foot_of_points(family, m, at, slave, node, gap, normal, d)
      integer, intent(in) :: family                !! of the cell
      real(wp), intent(in) :: m(:, :)              !! (number of points, 6)
      type(facet_place_type), intent(in) :: at
      type(dual_type), intent(in) :: slave(3), node(:, :)   !! [length]
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type), intent(out) :: d(2)         !! change of xi, eta; its value is 0
      real(wp) :: a(3)
      type(dual_type) :: foot(3), t1(3), t2(3), r(3), g1, g2
      integer :: i

      foot = 0.0_wp
      t1 = 0.0_wp
      t2 = 0.0_wp
      do i = 1, size(node, 2)
         foot = foot + m(i, 1)*node(:, i)
         t1 = t1 + m(i, 2)*node(:, i)
         t2 = t2 + m(i, 3)*node(:, i)
      end do
      r = slave - foot
      g1 = dual_dot(r, t1)
      g2 = dual_dot(r, t2)
      g1%v = 0.0_wp
      g2%v = 0.0_wp
      a = [sum(t1%v**2), sum(t1%v*t2%v), sum(t2%v**2)]
      do i = 1, size(node, 2)
         a = a - dot_product(r%v, node(:, i)%v)*m(i, 4:6)
      end do
      call move_foot(family, at, a, g1, g2, d)
      do i = 1, size(node, 2)
         t1 = t1 + (m(i, 4)*d(1) + m(i, 5)*d(2))*node(:, i)%v
         t2 = t2 + (m(i, 5)*d(1) + m(i, 6)*d(2))*node(:, i)%v
      end do
      foot = foot + d(1)*t1 + d(2)*t2
      r = slave - foot
      if (family == cell_family%line) then
         t2 = 0.0_wp
         t2(3) = constant(1.0_wp)
      end if
      if (at%found%place == place%edge .or. at%found%place == place%vertex) then
         call normal_along(r, at, normal)
      else
         normal = dual_cross(t1, t2)
         normal = normal/dual_norm(normal)
      end if
      gap = dual_dot(normal, r)
   end subroutine foot_of_points

   !> The change of the parameters from the gradient of half the distance squared, within the face
   !> or along an edge.
   pure subroutine move_foot(family, at, a, g1, g2, d)
      integer, intent(in) :: family                !! of the cell
      type(facet_place_type), intent(in) :: at
      real(wp), intent(in) :: a(3)                 !! second derivatives [length^2]
      type(dual_type), intent(in) :: g1, g2        !! gradient [length^2]
      type(dual_type), intent(out) :: d(2)
      real(wp) :: det, e(2)

      d = constant(0.0_wp)
      select case (at%found%place)
      case (place%vertex)
      case (place%edge)
         e = edge_ends(family, at%feature, 1.0_wp) - edge_ends(family, at%feature, 0.0_wp)
         det = a(1)*e(1)**2 + 2.0_wp*a(2)*e(1)*e(2) + a(3)*e(2)**2
         d(1) = (e(1)*g1 + e(2)*g2)*(e(1)/det)
         d(2) = (e(1)*g1 + e(2)*g2)*(e(2)/det)
      case default
         if (family == cell_family%line) then
            d(1) = g1/a(1)
         else
            det = a(1)*a(3) - a(2)**2
            d(1) = (a(3)*g1 - a(2)*g2)/det
            d(2) = (a(1)*g2 - a(2)*g1)/det
         end if
      end select
   end subroutine move_foot

   !> At an edge or a vertex: the direction to the slave, on the side of the values.
   pure subroutine normal_along(r, at, normal)
      type(dual_type), intent(in) :: r(3)          !! from the foot to the slave [length]
      type(facet_place_type), intent(in) :: at
      type(dual_type), intent(out) :: normal(3)
      type(dual_type) :: long

      if (norm2(r%v) > coincident*at%size) then
         long = dual_norm(r)
         normal = sign(1.0_wp, dot_product(r%v, at%found%normal))*(r/long)
      else
         normal = at%found%normal
      end if
   end subroutine normal_along

   !> Rotation matrix of a rotation vector (2D: about z), exact also at rest.
   pure function tool_motion(rotation) result(matrix)
      type(dual_type), intent(in) :: rotation(3)   !! [rad]
      type(dual_type) :: matrix(3, 3), w(3, 3), w2(3, 3), a, b, angle, half
      integer :: i, j, k

      w = constant(0.0_wp)
      w(2, 1) = rotation(3)
      w(3, 1) = -rotation(2)
      w(1, 2) = -rotation(3)
      w(3, 2) = rotation(1)
      w(1, 3) = rotation(2)
      w(2, 3) = -rotation(1)
      w2 = constant(0.0_wp)
      do j = 1, 3
         do i = 1, 3
            do k = 1, 3
               w2(i, j) = w2(i, j) + w(i, k)*w(k, j)
            end do
         end do
      end do
      a = constant(1.0_wp)
      b = constant(0.5_wp)
      if (norm2(rotation%v) > 1.0e-7_wp) then
         angle = dual_norm(rotation)
         a = sin(angle)/angle
         half = sin(0.5_wp*angle)/angle
         b = 2.0_wp*(half*half)
      end if
      do j = 1, 3
         do i = 1, 3
            matrix(i, j) = a*w(i, j) + b*w2(i, j)
         end do
         matrix(j, j) = matrix(j, j) + 1.0_wp
      end do
   end function tool_motion

   !> matrix * v.
   pure function turned(matrix, v) result(w)
      type(dual_type), intent(in) :: matrix(3, 3), v(3)
      type(dual_type) :: w(3)
      integer :: i
      do i = 1, 3
         w(i) = dual_dot(matrix(i, :), v)
      end do
   end function turned

   pure function turned_back(matrix, v) result(w)
      type(dual_type), intent(in) :: matrix(3, 3), v(3)
      type(dual_type) :: w(3)
      integer :: i
      do i = 1, 3
         w(i) = dual_dot(matrix(:, i), v)
      end do
   end function turned_back

   !> Gap and normal in the tool's frame, to first order about the foot found there.
   pure subroutine tool_foot(found, y, gap, normal)
      type(foot_type), intent(in) :: found         !! of the values, in the tool's frame
      type(dual_type), intent(in) :: y(3)          !! the slave in the tool's frame
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type) :: way(3)
      integer :: i

      way = y
      way%v = 0.0_wp
      gap = constant(found%gap)
      if (found%leans) then
         gap = gap + dual_dot(constant(found%gradient), way)
      else
         gap = gap + dual_dot(constant(found%normal), way)
      end if
      do i = 1, 3
         normal(i) = found%normal(i) + dual_dot(constant(found%hessian(i, :)), way)
      end do
   end subroutine tool_foot
end module lopin_contact_foot
