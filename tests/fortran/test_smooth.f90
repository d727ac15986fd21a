!> Smoothed facets: circles, cylinders and spheres, joints, feature edges, exact derivatives.
program test_smooth
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_dual, only : dual_type, variable, constant
   use lopin_cells, only : cell_type, cell_id, new_cell_of
   use lopin_facets, only : facets_type
   use lopin_facet_basis, only : facet_point_of, ncoefficient, coefficients_of
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection
   use lopin_smooth_facet, only : smooth_coefficients
   use lopin_smooth_dual, only : dual_coefficients
   use lopin_contact_foot, only : facet_place_type, smooth_facet_foot
   use search_scenes, only : scene_type, make_cube, allocate_facets
   use check, only : test, close_to, is_true, finish
   implicit none

   real(wp), parameter :: pi = acos(-1.0_wp)

   call random_init(.true., .false.)
   call a_circle_is_nearly_exact()
   call open_ends_turn_like_the_circle()
   call a_sphere_converges()
   call flat_stays_flat()
   call feature_edges_stay()
   call gap_follows_over_joints()
   call dual_coefficients_are_exact_slopes()
   call dual_feet_are_exact_slopes()
   call finish()

contains

   !> A circle of radius 1 travelled clockwise: its outside is outside.
   subroutine make_circle(surface, x, n, closed, smooth)
      type(surface_type), intent(out) :: surface
      real(wp), allocatable, intent(out) :: x(:, :)
      integer, intent(in) :: n
      logical, intent(in) :: closed, smooth
      type(facets_type) :: facets
      type(cell_type) :: shape
      type(error_type), allocatable :: error
      real(wp) :: angle
      integer :: i, m

      call new_cell_of(shape, cell_id%line2)
      m = n
      if (.not. closed) m = n/4
      call allocate_facets(facets, m, shape)
      allocate (x(2, n))
      do i = 1, n
         angle = 2.0_wp*pi*(real(i, wp) + 0.3_wp*sin(3.0_wp*real(i, wp)))/real(n, wp)
         x(:, i) = [cos(angle), sin(angle)]
      end do
      do i = 1, m
         facets%node(:2, i) = [i, 1 + mod(i, n)]
      end do
      call new_surface(surface, 2, facets, smooth)
      call update_surface(surface, x, error)
   end subroutine make_circle

   !> Largest error of the radius over a surface.
   real(wp) function worst(surface) result(error)
      type(surface_type), intent(in) :: surface
      real(wp) :: xi(2)
      integer :: i, k

      error = 0.0_wp
      do i = 1, surface%facets%n
         do k = 0, 20
            xi = [-1.0_wp + 0.1_wp*real(k, wp), 0.0_wp]
            if (surface%ndim == 3) call random_number(xi)
            if (surface%facets%cell(i) == cell_id%triangle .and. sum(xi) > 1.0_wp) xi = 1.0_wp - xi
            error = max(error, abs(norm2(facet_point_of(surface%coefficient(:, :, i), xi)) - &
               & 1.0_wp))
         end do
      end do
   end function worst

   subroutine a_circle_is_nearly_exact()
      type(surface_type) :: faceted, smooth
      real(wp), allocatable :: x(:, :)
      real(wp) :: sagitta(2), left(2)
      integer :: k

      call test('unequal chords of a circle: sixth order instead of second')
      do k = 1, 2
         call make_circle(faceted, x, 12*2**k, .true., .false.)
         call make_circle(smooth, x, 12*2**k, .true., .true.)
         sagitta(k) = worst(faceted)
         left(k) = worst(smooth)
      end do
      call is_true('24 facets', left(1) < 3.0e-7_wp .and. sagitta(1) > 8.0e-3_wp)
      call is_true('sixth order', left(2) < left(1)/45.0_wp)
   end subroutine a_circle_is_nearly_exact

   subroutine open_ends_turn_like_the_circle()
      type(surface_type) :: smooth
      real(wp), allocatable :: x(:, :)

      call test('a quarter of a circle is as good as the whole')
      call make_circle(smooth, x, 24, .false., .true.)
      call is_true('24 facets', worst(smooth) < 3.0e-7_wp)
   end subroutine open_ends_turn_like_the_circle

   !> A cube blown up to the unit sphere.
   subroutine make_sphere(scene, n, triangles, smooth)
      type(scene_type), intent(out) :: scene
      integer, intent(in) :: n
      logical, intent(in) :: triangles, smooth
      type(error_type), allocatable :: error
      type(facets_type) :: facets
      integer :: i

      call make_cube(scene, n, triangles)
      do i = 1, size(scene%x, 2)
         scene%x(:, i) = tan(0.25_wp*pi*scene%x(:, i))
         if (norm2(scene%x(:, i)) > 0.0_wp) scene%x(:, i) = scene%x(:, i)/norm2(scene%x(:, i))
      end do
      facets = scene%surface%facets
      call new_surface(scene%surface, 3, facets, smooth)
      call update_surface(scene%surface, scene%x, error)
      call build_tree(scene%tree, scene%surface%low, scene%surface%high)
   end subroutine make_sphere

   subroutine a_sphere_converges()
      type(scene_type) :: faceted, smooth
      real(wp) :: error(2), flat
      integer :: k, cell

      call test('a sphere of facets: fourth order instead of second')
      do cell = 1, 2
         do k = 1, 2
            call make_sphere(smooth, 4*2**k, cell == 2, .true.)
            error(k) = worst(smooth%surface)
         end do
         call make_sphere(faceted, 16, cell == 2, .false.)
         flat = worst(faceted%surface)
         call is_true('a tenth of the chord error at least', error(2) < 0.1_wp*flat)
         call is_true('fourth order', error(2) < error(1)/10.0_wp)
      end do
   end subroutine a_sphere_converges

   subroutine flat_stays_flat()
      type(scene_type) :: scene
      type(surface_type) :: smooth
      type(error_type), allocatable :: error
      integer :: cell, i

      call test('flat facets are not curved, and right angles are kept')
      do cell = 1, 2
         call make_cube(scene, 3, cell == 2)
         call new_surface(smooth, 3, scene%surface%facets, .true.)
         call update_surface(smooth, scene%x, error)
         do i = 1, smooth%facets%n
            call close_to('coefficients', smooth%coefficient(:, :, i), &
               & scene%surface%coefficient(:, :, i), 1.0e-13_wp)
         end do
      end do
   end subroutine flat_stays_flat

   subroutine feature_edges_stay()
      type(facets_type) :: facets
      type(surface_type) :: surface
      type(cell_type) :: shape
      type(error_type), allocatable :: error
      real(wp) :: x(2, 4)
      integer :: i

      call test('a joint of more than 30 degrees stays sharp')
      call new_cell_of(shape, cell_id%line2)
      call allocate_facets(facets, 3, shape)
      do i = 1, 3
         facets%node(:2, i) = [i, i + 1]
      end do
      x = reshape([0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, -2.0_wp, -0.1_wp, -2.0_wp, -1.0_wp], [2, 4])
      call new_surface(surface, 2, facets, .true.)
      call update_surface(surface, x, error)
      call close_to('the last line', surface%coefficient(:, 3:, 3), &
         & spread(spread(0.0_wp, 1, 3), 2, ncoefficient - 2), 1.0e-14_wp)
      call is_true('the first ones are curved', &
         & maxval(abs(surface%coefficient(:, 5, :2))) > 1.0e-3_wp)
   end subroutine feature_edges_stay

   subroutine gap_follows_over_joints()
      type(surface_type) :: surface
      type(tree_type) :: tree
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp), allocatable :: x(:, :)
      real(wp) :: p(2), angle
      integer :: i

      call test('a point that circles a smoothed wheel keeps gap and radial normal')
      call make_circle(surface, x, 24, .true., .true.)
      call build_tree(tree, surface%low, surface%high)
      do i = 1, 500
         angle = 0.0127_wp*real(i, wp)
         p = 1.01_wp*[cos(angle), sin(angle)]
         call find_projection(surface, tree, p, [0.0_wp, 0.0_wp], limits, found)
         call is_true('gap', abs(found%gap - 0.01_wp) < 3.0e-7_wp)
         call is_true('normal', abs(found%normal(1)*p(2) - found%normal(2)*p(1)) < 1.0e-5_wp)
      end do
   end subroutine gap_follows_over_joints

   subroutine dual_coefficients_are_exact_slopes()
      type(scene_type) :: scene
      type(surface_type) :: circle
      real(wp), allocatable :: x(:, :)
      integer :: cell

      call test('dual coefficients equal the real ones and their differences')
      do cell = 1, 2
         call make_sphere(scene, 4, cell == 2, .true.)
         call compare_slopes(scene%surface, scene%x, 5)
      end do
      call make_circle(circle, x, 12, .true., .true.)
      call compare_slopes(circle, x, 4)
      call make_circle(circle, x, 12, .false., .true.)
      call compare_slopes(circle, x, 1)
   end subroutine dual_coefficients_are_exact_slopes

   subroutine compare_slopes(surface, x, f)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: f
      real(wp), allocatable :: place(:, :)
      type(dual_type), allocatable :: seeds(:, :)
      type(dual_type) :: c(3, ncoefficient)
      real(wp) :: left(3, ncoefficient), right(3, ncoefficient)
      real(wp), parameter :: h = 1.0e-5_wp
      integer :: j, k

      associate (stencil => surface%stencil(f), cell => surface%facets%cell(f))
         allocate (place(3, stencil%n), seeds(3, stencil%n))
         place = 0.0_wp
         place(:surface%ndim, :) = x(:, stencil%node(:stencil%n))
         do j = 1, stencil%n
            do k = 1, surface%ndim
               seeds = constant(place)
               seeds(k, j) = variable(place(k, j), 1)
               call dual_coefficients(stencil, surface%basis, cell, seeds, c)
               call close_to('values', c%v, surface%coefficient(:, :, f), 1.0e-13_wp)
               place(k, j) = place(k, j) + h
               right = smooth_coefficients(stencil, surface%basis, cell, place)
               place(k, j) = place(k, j) - 2.0_wp*h
               left = smooth_coefficients(stencil, surface%basis, cell, place)
               place(k, j) = place(k, j) + h
               call close_to('slopes', c%d(1), (right - left)/(2.0_wp*h), 1.0e-7_wp)
            end do
         end do
      end associate
   end subroutine compare_slopes

   !> Gap and normal of a smoothed face by its nodes, against differences of the whole search.
   subroutine dual_feet_are_exact_slopes()
      type(scene_type) :: scene
      type(surface_type) :: circle
      real(wp), allocatable :: x(:, :)
      integer :: cell

      call test('dual feet on smoothed facets equal differences of the search')
      do cell = 1, 2
         call make_sphere(scene, 4, cell == 2, .true.)
         call compare_feet(scene%surface, scene%x, [0.31_wp, 0.17_wp, 0.98_wp])
      end do
      call make_circle(circle, x, 12, .true., .true.)
      call compare_feet(circle, x, [0.82_wp, 0.65_wp])
   end subroutine dual_feet_are_exact_slopes

   subroutine compare_feet(surface, x, p)
      type(surface_type), intent(inout) :: surface
      real(wp), intent(inout) :: x(:, :)
      real(wp), intent(in) :: p(:)
      type(projection_type) :: found, right, left
      type(dual_type), allocatable :: seeds(:, :)
      type(dual_type) :: slave(3), gap, normal(3), shares(8)
      real(wp), parameter :: h = 1.0e-5_wp
      integer :: j, k

      call find_now(surface, x, p, found)
      slave = constant(0.0_wp)
      slave(:size(p)) = constant(p)
      associate (stencil => surface%stencil(found%facet), cell => surface%facets%cell(found%facet))
         do j = 1, stencil%n
            do k = 1, surface%ndim
               allocate (seeds(3, stencil%n))
               seeds = constant(0.0_wp)
               seeds(:surface%ndim, :) = constant(x(:, stencil%node(:stencil%n)))
               seeds(k, j)%d(1) = 1.0_wp
               call smooth_facet_foot(surface%basis, facet_place_type(cell, found, found%feature, &
                  & 1.0_wp), slave, seeds, stencil, gap, normal, shares)
               deallocate (seeds)
               x(k, stencil%node(j)) = x(k, stencil%node(j)) + h
               call find_now(surface, x, p, right)
               x(k, stencil%node(j)) = x(k, stencil%node(j)) - 2.0_wp*h
               call find_now(surface, x, p, left)
               x(k, stencil%node(j)) = x(k, stencil%node(j)) + h
               call close_to('gap', gap%d(1), (right%gap - left%gap)/(2.0_wp*h), 1.0e-7_wp)
               call close_to('normal', normal%d(1), (right%normal - left%normal)/(2.0_wp*h), &
                  & 1.0e-6_wp)
               call close_to('shares', shares(:2)%d(1), (right%shape(:2) - &
                  & left%shape(:2))/(2.0_wp*h), 1.0e-6_wp)
            end do
         end do
         call close_to('gap', gap%v, found%gap, 1.0e-12_wp)
      end associate
   end subroutine compare_feet

   subroutine find_now(surface, x, p, found)
      type(surface_type), intent(inout) :: surface
      real(wp), intent(in) :: x(:, :), p(:)
      type(projection_type), intent(out) :: found
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(error_type), allocatable :: error

      call update_surface(surface, x, error)
      call build_tree(tree, surface%low, surface%high)
      call find_projection(surface, tree, p, 0.0_wp*p, limits, found)
   end subroutine find_now
end program test_smooth
