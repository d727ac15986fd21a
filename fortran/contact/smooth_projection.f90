!> Projection along the smoothed normal n(xi) = sum N^k n^k, normalised.
!>
!> The seed's step H4 repaired: x = x(xi, eta) + g n(xi, eta)/|n(xi, eta)| is solved for xi, eta and
!> g together; the sum of the nodal normals carries their shape functions and is not of unit length.
!> The gap is then continuous across joints, although the facets are not smooth.
module lopin_smooth_projection
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_family
   use lopin_facet_basis, only : ncoefficient, facet_point_of, facet_tangents
   implicit none
   private
   public :: project_along

   integer, parameter :: most_iterations = 30
   real(wp), parameter :: settled = 1.0e-13_wp      !! step in reference units
   real(wp), parameter :: longest = 1.0_wp          !! step in reference units

contains

   !> Where the line along the smoothed normal through x meets the facet (or its continuation).
   pure subroutine project_along(c, normals, family, start, x, xi, gap, normal, converged)
      real(wp), intent(in) :: c(3, ncoefficient)        !! of the facet [length]
      real(wp), intent(in) :: normals(3, ncoefficient)  !! of its nodal normals, interpolated alike
      integer, intent(in) :: family                     !! cell_family%...
      real(wp), intent(in) :: start(2)
      real(wp), intent(in) :: x(3)                      !! [length]
      real(wp), intent(out) :: xi(2)
      real(wp), intent(out) :: gap                      !! [length]
      real(wp), intent(out) :: normal(3)                !! unit
      logical, intent(out) :: converged
      real(wp) :: r(3), t1(3), t2(3), n1(3), n2(3), n(3), a(3, 3), step(3), g, det
      integer :: i

      xi = start
      n = facet_point_of(normals, xi)
      g = dot_product(x - facet_point_of(c, xi), n)/max(dot_product(n, n), tiny(1.0_wp))
      converged = .false.
      do i = 1, most_iterations
         n = facet_point_of(normals, xi)
         r = x - facet_point_of(c, xi) - g*n
         call facet_tangents(c, xi, t1, t2)
         call facet_tangents(normals, xi, n1, n2)
         a(:, 1) = t1 + g*n1
         a(:, 2) = t2 + g*n2
         if (family == cell_family%line) a(:, 2) = [0.0_wp, 0.0_wp, 1.0_wp]
         a(:, 3) = n
         det = dot_product(a(:, 1), cross(a(:, 2), a(:, 3)))
         if (.not. abs(det) > 0.0_wp) exit
         step = [dot_product(r, cross(a(:, 2), a(:, 3))), dot_product(r, cross(a(:, 3), a(:, 1))), &
            & dot_product(r, cross(a(:, 1), a(:, 2)))]/det
         if (family == cell_family%line) step(2) = 0.0_wp
         step = step*min(1.0_wp, longest/max(maxval(abs(step(:2))), tiny(1.0_wp)))
         xi = xi + step(:2)
         g = g + step(3)
         converged = maxval(abs(step(:2))) <= settled
         if (converged) exit
      end do
      n = facet_point_of(normals, xi)
      gap = g*norm2(n)
      normal = n/max(norm2(n), tiny(1.0_wp))
   end subroutine project_along
end module lopin_smooth_projection
