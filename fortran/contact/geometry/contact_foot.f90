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
   public :: facet_foot, smooth_facet_foot, tool_motion, tool_foot, turned, turned_back

   !> Distances below this share of the facet have no direction of their own.
   real(wp), parameter :: coincident = 1.0e-9_wp

contains

   !> Gap, normal and shares of the facet's nodes.
   pure subroutine facet_foot(basis, cell, found, feature, size_, slave, node, gap, normal, shares)
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: cell                  !! id of the facet's cell
      type(projection_type), intent(in) :: found   !! of the values
      integer, intent(in) :: feature               !! edge of the foot, if it is on one
      real(wp), intent(in) :: size_                !! of the facet [length]
      type(dual_type), intent(in) :: slave(3), node(:, :)   !! (3, nnode) places [length]
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type), intent(out) :: shares(:)    !! (nnode)
      real(wp) :: m(8, 6)
      type(dual_type) :: d(2)
      integer :: i, k

      call shape_derivatives(basis, cell, found%xi, m)
      k = size(node, 2)
      call foot_of_points(basis%family(cell), m(:k, :), found, feature, size_, slave, node, gap, &
         & normal, d)
      do i = 1, k
         shares(i) = m(i, 1) + m(i, 2)*d(1) + m(i, 3)*d(2)
      end do
   end subroutine facet_foot

   !> The same on a smoothed facet: shaped by its stencil, carried by the facet's own nodes.
   pure subroutine smooth_facet_foot(basis, cell, found, feature, size_, slave, node, stencil, &
      & gap, normal, shares)
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: cell                  !! id of the facet's cell (linear)
      type(projection_type), intent(in) :: found   !! of the values, on the smoothed facet
      integer, intent(in) :: feature               !! edge of the foot, if it is on one
      real(wp), intent(in) :: size_                !! of the facet [length]
      type(dual_type), intent(in) :: slave(3), node(:, :)   !! (3, stencil%n) places [length]
      type(stencil_type), intent(in) :: stencil    !! its first nodes are the facet's
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type), intent(out) :: shares(:)    !! (nodes of the facet)
      real(wp) :: m(8, 6)
      type(dual_type) :: c(3, ncoefficient), d(2)
      integer :: i

      call dual_coefficients(stencil, basis, cell, node, c)
      call foot_of_points(basis%family(cell), monomial_derivatives(found%xi), found, feature, &
         & size_, slave, c, gap, normal, d)
      call shape_derivatives(basis, cell, found%xi, m)
      do i = 1, basis%nnode(cell)
         shares(i) = m(i, 1) + m(i, 2)*d(1) + m(i, 3)*d(2)
      end do
   end subroutine smooth_facet_foot

   !> Foot on sum_i m(i, 1) node(:, i); `m` has that and its derivatives by xi, eta, xi xi, xi eta,
   !> eta eta.
   pure subroutine foot_of_points(family, m, found, feature, size_, slave, node, gap, normal, d)
      integer, intent(in) :: family                !! of the cell
      real(wp), intent(in) :: m(:, :)              !! (number of points, 6)
      type(projection_type), intent(in) :: found
      integer, intent(in) :: feature
      real(wp), intent(in) :: size_                !! [length]
      type(dual_type), intent(in) :: slave(3), node(:, :)   !! [length]
      type(dual_type), intent(out) :: gap, normal(3)
      type(dual_type), intent(out) :: d(2)         !! change of xi, eta; its value is 0
      real(wp) :: a(3), det, e(2), sign_
      type(dual_type) :: foot(3), t1(3), t2(3), r(3), g1, g2, long
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
      d = constant(0.0_wp)
      select case (found%place)
      case (place%vertex)
      case (place%edge)
         e = edge_ends(family, feature, 1.0_wp) - edge_ends(family, feature, &
            & 0.0_wp)
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
      if (found%place == place%edge .or. found%place == place%vertex) then
         if (norm2(r%v) > coincident*size_) then
            sign_ = sign(1.0_wp, dot_product(r%v, found%normal))
            long = dual_norm(r)
            normal = sign_*(r/long)
         else
            normal = found%normal
         end if
      else
         normal = dual_cross(t1, t2)
         normal = normal/dual_norm(normal)
      end if
      gap = dual_dot(normal, r)
   end subroutine foot_of_points

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
