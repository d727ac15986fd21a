!> What a surface resists pressures that vary along it: from its mesh alone, per unit of modulus.
!>
!> A half-space answers a displacement of wave number k by the pressure (modulus/2) k u: half the
!> square root of the surface's Laplacian. With the matrices L and M of the facets the same is
!> K = 1/2 C (C^-1 L C^-T)^(1/2) C^T, M = C C^T. Near a free edge of the body a surface is softer: L
!> is reduced there (a quarter-space; set beside measured pressures in the atlas, map 9).
module lopin_surface_stiffness
   use lopin_kinds, only : wp
   use lopin_dense, only : cholesky, lower_solve, symmetric_eigen
   use lopin_facets, only : facet_rule_type
   use lopin_surface, only : surface_type
   implicit none
   private
   public :: surface_stiffness

   !> The softer zone along an edge in widths of the surface, and what is left of L at the edge.
   real(wp), parameter :: zone = 0.2_wp, left = 0.1_wp
   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Of the facets that have all their nodes in the list; status /= 0: none could be formed.
   subroutine surface_stiffness(surface, rules, x, axisymmetric, place, k, area, status)
      type(surface_type), intent(in) :: surface
      type(facet_rule_type), intent(in) :: rules(:)   !! from new_facet_rules
      real(wp), intent(in) :: x(:, :)                 !! (ndim, mesh nodes) [length]
      logical, intent(in) :: axisymmetric
      integer, intent(in) :: place(:)                 !! (surface%nnode) row of each; 0: none
      real(wp), intent(out) :: k(:, :)                !! (n, n) over modulus [length]
      real(wp), intent(out) :: area(:)                !! (n) [length^2]
      integer, intent(out) :: status
      real(wp) :: m(size(k, 1), size(k, 1)), value(size(k, 1))
      real(wp), allocatable :: edge(:, :)
      real(wp) :: width, far
      integer :: i, j, n

      k = 0.0_wp
      m = 0.0_wp
      call find_edges(surface, x, axisymmetric, edge, width)
      do i = 1, surface%facets%n
         n = surface%facets%nnode(i)
         if (any(place(surface%local(:n, i)) == 0)) cycle
         far = huge(1.0_wp)
         do j = 1, size(edge, 2)
            far = min(far, norm2(edge(:, j) - surface%disc(:3, i)))
         end do
         call add_facet(rules(surface%facets%cell(i)), x(:, surface%facets%node(:n, i)), &
            & axisymmetric, min(1.0_wp, left + far/(zone*width)), place(surface%local(:n, i)), k, m)
      end do
      area = sum(m, dim=1)
      call cholesky(m, status)
      if (status /= 0) return
      do i = 2, size(m, 1)
         m(:i - 1, i) = 0.0_wp
      end do
      call lower_solve(m, k)
      k = transpose(k)
      call lower_solve(m, k)
      call symmetric_eigen(k, value, status)
      k = matmul(m, k)
      k = 0.5_wp*matmul(k*spread(sqrt(max(0.0_wp, value)), 1, size(value)), transpose(k))
   end subroutine surface_stiffness

   !> The middles of the free edges (in the plane the ends), but for the axis; the width across.
   subroutine find_edges(surface, x, axisymmetric, edge, width)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: axisymmetric
      real(wp), allocatable, intent(out) :: edge(:, :)   !! (3, edges) [length]
      real(wp), intent(out) :: width                     !! [length]
      real(wp) :: at(3), axis
      integer :: i, k, n, a, b
      logical :: touches

      allocate (edge(3, 0))
      axis = 1.0e-10_wp*maxval(abs(x(1, :)))
      touches = .false.
      do i = 1, surface%facets%n
         n = surface%basis%ncorner(surface%facets%cell(i))
         do k = 1, n
            if (surface%neighbour(k, i) > 0) cycle
            a = surface%facets%node(k, i)
            b = a
            if (n > 2) b = surface%facets%node(1 + mod(k, n), i)
            if (axisymmetric .and. abs(x(1, a)) <= axis) then
               touches = .true.
               cycle
            end if
            at = 0.0_wp
            at(:size(x, 1)) = 0.5_wp*(x(:, a) + x(:, b))
            edge = reshape([edge, at], [3, size(edge, 2) + 1])
         end do
      end do
      ! Discs: the radius of a line is half its length.
      width = 2.0_wp*sum(surface%disc(7, :))
      if (touches) width = 2.0_wp*width
      if (size(x, 1) == 3) width = sqrt(sum(surface%size**2))
   end subroutine find_edges

   !> Laplacian (reduced) and mass of one facet.
   pure subroutine add_facet(rule, x, axisymmetric, share, row, l, m)
      type(facet_rule_type), intent(in) :: rule
      real(wp), intent(in) :: x(:, :)                 !! (ndim, nodes) [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: share
      integer, intent(in) :: row(:)
      real(wp), intent(inout) :: l(:, :), m(:, :)
      real(wp) :: t(size(x, 1), size(x, 1) - 1), g(size(t, 2), size(t, 2)), weight, det
      real(wp) :: slope(size(t, 2), size(row))
      integer :: q

      do q = 1, rule%npoint
         t = matmul(x, transpose(rule%dn(:, :, q)))
         g = matmul(transpose(t), t)
         if (size(t, 2) == 1) then
            det = g(1, 1)
            if (.not. det > 0.0_wp) cycle
            slope = rule%dn(:, :, q)/det
         else
            det = g(1, 1)*g(2, 2) - g(1, 2)*g(2, 1)
            if (.not. det > 0.0_wp) cycle
            slope(1, :) = (g(2, 2)*rule%dn(1, :, q) - g(1, 2)*rule%dn(2, :, q))/det
            slope(2, :) = (g(1, 1)*rule%dn(2, :, q) - g(2, 1)*rule%dn(1, :, q))/det
         end if
         weight = rule%weight(q)*sqrt(det)
         if (axisymmetric) weight = weight*2.0_wp*pi*dot_product(x(1, :), rule%n(:, q))
         l(row, row) = l(row, row) + share*weight*matmul(transpose(rule%dn(:, :, q)), slope)
         m(row, row) = m(row, row) + weight*spread(rule%n(:, q), 2, size(row)) &
            & *spread(rule%n(:, q), 1, size(row))
      end do
   end subroutine add_facet
end module lopin_surface_stiffness
