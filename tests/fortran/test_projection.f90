!> Closest point of one facet, for all six cells.
program test_projection
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, cell_names, new_cell_of, shape_functions, cell_family
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis, coefficients_of, shape_values, &
      & facet_point_of, facet_tangents, facet_seconds, nfacet_cell
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal, &
      & facet_metric
   use lopin_rigid_motion, only : rotation_matrix
   use check, only : test, close_to, is_true, finish
   implicit none

   type(facet_basis_type) :: basis
   real(wp), parameter :: tight = 1.0e-12_wp
   real(wp), parameter :: none(4) = 0.0_wp

   call random_init(.true., .false.)
   call new_facet_basis(basis)
   call polynomials_equal_the_shape_functions()
   call slopes_are_derivatives()
   call feet_are_closer_than_any_sample()
   call a_point_raised_along_the_normal_comes_back()
   call places_are_named()
   call rotation_and_unit_change_nothing()
   call warped_quads_take_few_iterations()
   call degenerate_facets_are_refused()
   call slack_lets_the_foot_out()
   call finish()

contains

   !> A slightly random facet: warped, curved, of size about `scale`.
   function random_facet(cell, amount) result(x)
      integer, intent(in) :: cell
      real(wp), intent(in) :: amount
      real(wp) :: x(3, 8)

      call random_number(x)
      x = amount*(2.0_wp*x - 1.0_wp)
      x(:2, :) = x(:2, :) + basis%xi(:, :, cell)
      if (basis%family(cell) == cell_family%line) x(3, :) = 0.0_wp
   end function random_facet

   subroutine polynomials_equal_the_shape_functions()
      type(cell_type) :: cell
      real(wp) :: n(8), dn(2, 8), xi(2), values(8)
      integer :: id, i

      call test('the polynomial table equals the shape functions of the cells')
      do id = 1, nfacet_cell
         call new_cell_of(cell, id)
         do i = 1, 5
            call random_number(xi)
            if (cell%ndim == 1) xi(2) = 0.0_wp
            n = 0.0_wp
            call shape_functions(cell, xi(:cell%ndim), n(:cell%nnode), dn(:cell%ndim, :cell%nnode))
            values = shape_values(basis, id, xi)
            call close_to(trim(cell_names(id)), values, n, 1.0e-14_wp)
            call close_to(trim(cell_names(id))//' sum', sum(values), 1.0_wp, 1.0e-14_wp)
         end do
      end do
   end subroutine polynomials_equal_the_shape_functions

   subroutine slopes_are_derivatives()
      real(wp) :: c(3, 9), x(3, 8), xi(2), t1(3), t2(3), a(3), b(3), x11(3), x12(3), x22(3)
      real(wp) :: tangent(3, 2), metric(2, 2), curvature(2, 2)
      real(wp), parameter :: h = 1.0e-5_wp
      integer :: id

      call test('tangents and second derivatives equal differences')
      do id = 1, nfacet_cell
         x = random_facet(id, 0.2_wp)
         c = coefficients_of(basis, id, x)
         xi = [0.3_wp, 0.2_wp]
         if (basis%family(id) == cell_family%line) xi(2) = 0.0_wp
         call facet_tangents(c, xi, t1, t2)
         call facet_seconds(c, xi, x11, x12, x22)
         a = facet_point_of(c, xi + [h, 0.0_wp])
         b = facet_point_of(c, xi - [h, 0.0_wp])
         call close_to('t1', (a - b)/(2.0_wp*h), t1, 1.0e-9_wp)
         call close_to('x11', (a - 2.0_wp*facet_point_of(c, xi) + b)/h**2, x11, 1.0e-4_wp)
         call facet_metric(c, basis%family(id), xi, tangent, metric, curvature)
         call close_to('metric', metric(1, 1), dot_product(t1, t1), tight)
         call close_to('curvature', curvature(1, 1), &
            & dot_product(x11, facet_unit_normal(c, basis%family(id), xi)), tight)
         if (basis%family(id) == cell_family%line) cycle
         a = facet_point_of(c, xi + [0.0_wp, h])
         b = facet_point_of(c, xi - [0.0_wp, h])
         call close_to('t2', (a - b)/(2.0_wp*h), t2, 1.0e-9_wp)
         call close_to('x22', (a - 2.0_wp*facet_point_of(c, xi) + b)/h**2, x22, 1.0e-4_wp)
         call facet_tangents(c, xi + [0.0_wp, h], a, t2)
         call facet_tangents(c, xi - [0.0_wp, h], b, t2)
         call close_to('x12', (a - b)/(2.0_wp*h), x12, 1.0e-8_wp)
      end do
   end subroutine slopes_are_derivatives

   !> Least distance over a grid of the cell.
   function sampled(c, id, x) result(least)
      real(wp), intent(in) :: c(3, 9), x(3)
      integer, intent(in) :: id
      real(wp) :: least, xi(2)
      integer, parameter :: n = 60
      integer :: i, j

      least = huge(1.0_wp)
      do j = 0, n
         do i = 0, n
            xi = [real(i, wp), real(j, wp)]/real(n, wp)
            if (basis%family(id) == cell_family%triangle) then
               if (i + j > n) exit
            else
               xi = 2.0_wp*xi - 1.0_wp
            end if
            if (basis%family(id) == cell_family%line) xi(2) = 0.0_wp
            least = min(least, norm2(x - facet_point_of(c, xi)))
         end do
         if (basis%family(id) == cell_family%line) exit
      end do
   end function sampled

   subroutine feet_are_closer_than_any_sample()
      real(wp) :: c(3, 9), x(3)
      type(closest_type) :: foot
      integer :: id, i

      call test('no sampled point of a facet is closer than its foot')
      do id = 1, nfacet_cell
         do i = 1, 300
            c = coefficients_of(basis, id, random_facet(id, merge(0.08_wp, 0.15_wp, &
               & basis%family(id) == cell_family%triangle)))
            ! Much farther away a curved facet has several feet that are almost equally near.
            call random_number(x)
            x = [2.6_wp, 2.6_wp, 1.2_wp]*x - [1.3_wp, 1.3_wp, 0.6_wp]
            if (basis%family(id) == cell_family%line) x(3) = 0.0_wp
            call project_on_facet(c, basis%family(id), basis%centre(:, id), none, x, foot)
            call is_true(trim(cell_names(id))//' found', foot%place /= place%none)
            call is_true(trim(cell_names(id))//' closest', sqrt(foot%distance2) <= sampled(c, id, &
               & x) + tight)
            call close_to(trim(cell_names(id))//' distance', norm2(x - foot%point), &
               & sqrt(foot%distance2), tight)
            call close_to(trim(cell_names(id))//' foot', foot%point, facet_point_of(c, foot%xi), &
               & tight)
         end do
      end do
   end subroutine feet_are_closer_than_any_sample

   subroutine a_point_raised_along_the_normal_comes_back()
      real(wp) :: c(3, 9), x(3), xi(2), n(3), gap
      type(closest_type) :: foot
      integer :: id, i

      call test('a point raised along the normal comes back to its parameters, with its signed gap')
      do id = 1, nfacet_cell
         do i = 1, 100
            c = coefficients_of(basis, id, random_facet(id, 0.1_wp))
            call random_number(xi)
            call random_number(gap)
            gap = 0.3_wp*(gap - 0.5_wp)
            if (basis%family(id) == cell_family%triangle) xi = 0.5_wp*xi
            if (basis%family(id) == cell_family%quad) xi = 1.9_wp*xi - 0.95_wp
            if (basis%family(id) == cell_family%line) xi(2) = 0.0_wp
            n = facet_unit_normal(c, basis%family(id), xi)
            x = facet_point_of(c, xi) + gap*n
            call project_on_facet(c, basis%family(id), basis%centre(:, id), none, x, foot)
            call close_to(trim(cell_names(id))//' xi', foot%xi, xi, 1.0e-11_wp)
            call close_to(trim(cell_names(id))//' gap', &
               & dot_product(x - foot%point, facet_unit_normal(c, basis%family(id), foot%xi)), &
               & gap, tight)
            call is_true('inside', foot%place == place%inside)
         end do
      end do
   end subroutine a_point_raised_along_the_normal_comes_back

   subroutine places_are_named()
      real(wp) :: c(3, 9), x(3, 8)
      integer, parameter :: quad = 5, triangle = 3, line = 1

      call test('feet on edges and vertices say so')
      x(:2, :) = basis%xi(:, :, quad)
      x(3, :) = 0.0_wp
      c = coefficients_of(basis, quad, x)
      call at(c, quad, [0.0_wp, -2.0_wp, 0.1_wp], place%edge, 1)
      call at(c, quad, [2.0_wp, 0.2_wp, 0.1_wp], place%edge, 2)
      call at(c, quad, [0.0_wp, 2.0_wp, 0.1_wp], place%edge, 3)
      call at(c, quad, [-2.0_wp, 0.2_wp, 0.1_wp], place%edge, 4)
      call at(c, quad, [-2.0_wp, -2.0_wp, 0.1_wp], place%vertex, 1)
      call at(c, quad, [2.0_wp, -2.0_wp, 0.1_wp], place%vertex, 2)
      call at(c, quad, [2.0_wp, 2.0_wp, 0.1_wp], place%vertex, 3)
      call at(c, quad, [-2.0_wp, 2.0_wp, 0.1_wp], place%vertex, 4)
      call at(c, quad, [1.0_wp, 0.5_wp, 3.0_wp], place%inside, 0)
      x(:2, :) = basis%xi(:, :, triangle)
      c = coefficients_of(basis, triangle, x)
      call at(c, triangle, [0.5_wp, -1.0_wp, 1.0_wp], place%edge, 1)
      call at(c, triangle, [1.0_wp, 1.0_wp, 1.0_wp], place%edge, 2)
      call at(c, triangle, [-1.0_wp, 0.5_wp, 1.0_wp], place%edge, 3)
      call at(c, triangle, [-1.0_wp, -0.5_wp, 1.0_wp], place%vertex, 1)
      call at(c, triangle, [3.0_wp, 0.5_wp, 1.0_wp], place%vertex, 2)
      call at(c, triangle, [0.5_wp, 3.0_wp, 1.0_wp], place%vertex, 3)
      x(:2, :) = basis%xi(:, :, line)
      c = coefficients_of(basis, line, x)
      call at(c, line, [-1.5_wp, 1.0_wp, 0.0_wp], place%vertex, 1)
      call at(c, line, [1.5_wp, 1.0_wp, 0.0_wp], place%vertex, 2)
      call at(c, line, [0.9_wp, 1.0_wp, 0.0_wp], place%inside, 0)
      call close_to('a line faces right', facet_unit_normal(c, cell_family%line, [0.0_wp, &
         & 0.0_wp]), &
         & [0.0_wp, -1.0_wp, 0.0_wp], tight)

   end subroutine places_are_named

   subroutine at(c, id, point, expected, feature)
      real(wp), intent(in) :: c(3, 9), point(3)
      integer, intent(in) :: id, expected, feature
      type(closest_type) :: foot

      call project_on_facet(c, basis%family(id), basis%centre(:, id), none, point, foot)
      call is_true(trim(cell_names(id)), foot%place == expected .and. foot%feature == feature)
   end subroutine at

   subroutine rotation_and_unit_change_nothing()
      real(wp) :: c(3, 9), x(3, 8), p(3), turn(3, 3)
      real(wp), parameter :: scale(2) = [1.0e-9_wp, 1.0e9_wp]
      type(closest_type) :: a, b
      integer :: id, i, k

      call test('turning the scene or changing the unit of length leaves xi')
      do id = 1, nfacet_cell
         do i = 1, 40
            x = random_facet(id, 0.15_wp)
            call random_number(p)
            p = 3.0_wp*p - 1.5_wp
            if (basis%family(id) == cell_family%line) p(3) = 0.0_wp
            c = coefficients_of(basis, id, x)
            call project_on_facet(c, basis%family(id), basis%centre(:, id), none, p, a)
            do k = 1, 2
               call project_on_facet(scale(k)*c, basis%family(id), basis%centre(:, id), none, &
                  & scale(k)*p, b)
               call close_to('xi', b%xi, a%xi, 1.0e-11_wp)
               call is_true('place', a%place == b%place .and. a%feature == b%feature)
            end do
            turn = rotation_matrix([0.4_wp, 1.0_wp, -0.7_wp])
            if (basis%family(id) == cell_family%line) turn = rotation_matrix([1.3_wp])
            c = coefficients_of(basis, id, matmul(turn, x))
            call project_on_facet(c, basis%family(id), basis%centre(:, id), none, matmul(turn, p), &
               & b)
            call close_to('xi turned', b%xi, a%xi, 1.0e-10_wp)
         end do
      end do
   end subroutine rotation_and_unit_change_nothing

   subroutine warped_quads_take_few_iterations()
      real(wp) :: c(3, 9), p(3)
      type(closest_type) :: foot
      integer :: i, most

      call test('a warped quad takes at most 8 iterations near its surface')
      most = 0
      do i = 1, 2000
         c = coefficients_of(basis, 5, random_facet(5, 0.25_wp))
         call random_number(p)
         p = [2.4_wp, 2.4_wp, 1.0_wp]*p - [1.2_wp, 1.2_wp, 0.5_wp]
         call project_on_facet(c, basis%family(5), basis%centre(:, 5), none, p, foot)
         most = max(most, foot%iterations)
      end do
      print '(a,i0)', 'most iterations on warped quads: ', most
      call is_true('few', most <= 8)
   end subroutine warped_quads_take_few_iterations

   subroutine degenerate_facets_are_refused()
      real(wp) :: c(3, 9), x(3, 8)
      type(closest_type) :: foot
      integer :: id

      call test('a facet shrunk to a point has no foot; one with a collapsed edge has')
      do id = 1, nfacet_cell
         x = 1.0_wp
         c = coefficients_of(basis, id, x)
         call project_on_facet(c, basis%family(id), basis%centre(:, id), none, [0.0_wp, 0.0_wp, &
            & 0.0_wp], foot)
         call is_true(trim(cell_names(id)), foot%place == place%none)
      end do
      x(:2, :) = basis%xi(:, :, 5)
      x(3, :) = 0.0_wp
      x(:, 4) = x(:, 3)
      c = coefficients_of(basis, 5, x)
      call project_on_facet(c, basis%family(5), basis%centre(:, 5), none, [1.0_wp, 1.0_wp, &
         & 0.5_wp], foot)
      call close_to('the collapsed corner', foot%point, [1.0_wp, 1.0_wp, 0.0_wp], 1.0e-10_wp)
      call project_on_facet(c, basis%family(5), basis%centre(:, 5), none, [0.2_wp, -0.3_wp, &
         & 0.5_wp], foot)
      call close_to('above the triangle', foot%point, [0.2_wp, -0.3_wp, 0.0_wp], 1.0e-10_wp)
   end subroutine degenerate_facets_are_refused

   subroutine slack_lets_the_foot_out()
      real(wp) :: c(3, 9), x(3, 8)
      type(closest_type) :: foot

      call test('slack moves the bounds of the cell outward')
      x(:2, :) = basis%xi(:, :, 5)
      x(3, :) = 0.0_wp
      c = coefficients_of(basis, 5, x)
      call project_on_facet(c, basis%family(5), basis%centre(:, 5), [0.0_wp, 0.2_wp, 0.0_wp, &
         & 0.0_wp], &
         & [1.1_wp, 1.1_wp, 0.5_wp], foot)
      call close_to('out on edge 2 only', foot%xi, [1.1_wp, 1.0_wp], tight)
      x(:2, :) = basis%xi(:, :, 3)
      c = coefficients_of(basis, 3, x)
      call project_on_facet(c, basis%family(3), basis%centre(:, 3), [0.1_wp, 0.1_wp, 0.1_wp, &
         & 0.0_wp], &
         & [-0.05_wp, -0.05_wp, 0.5_wp], foot)
      call close_to('out of a corner', foot%xi, [-0.05_wp, -0.05_wp], tight)
      call is_true('inside its bounds', foot%place == place%inside)
   end subroutine slack_lets_the_foot_out
end program test_projection
