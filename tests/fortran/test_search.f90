!> The search over meshed surfaces: against brute force, closed forms and invariances.
program test_search
   use lopin_shared_work, only : set_threads_of_run, threads_of_run
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_cells, only : cell_id, cell_names
   use lopin_facets, only : facets_type
   use lopin_projection, only : closest_type, place, project_on_facet
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, refit_tree, find_projection, find_projections
   use lopin_rigid_motion, only : rotation_matrix
   use search_scenes, only : scene_type, make_sheet, make_cube, follow
   use check, only : test, close_to, is_true, finish
   implicit none

   real(wp), parameter :: tight = 1.0e-12_wp
   real(wp), parameter :: any_side(3) = 0.0_wp

   call random_init(.true., .false.)
   call the_tree_misses_nothing()
   call no_miss_in_random_configurations()
   call a_closed_cube_has_its_exact_signed_distance()
   call the_normal_is_the_gradient_of_the_gap()
   call shape_values_carry_the_foot()
   call a_thin_sheet_is_met_on_the_right_side()
   call a_point_beside_a_block_meets_nothing()
   call a_point_flush_with_a_wall_meets_the_top()
   call the_perimeter_extends_by_a_fraction()
   call a_ridge_ends_in_a_plane_of_symmetry()
   call a_polyline_is_followed_without_jumps()
   call limits_are_respected()
   call turning_and_scaling_change_nothing()
   call threads_do_not_change_a_bit()
   call a_refitted_tree_answers_like_a_new_one()
   call a_facet_without_area_is_refused()
   call finish()

contains

   !> Least squared distance over all facets.
   real(wp) function brute_distance2(surface, x) result(least)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:)
      real(wp) :: point(3)
      real(wp), parameter :: none(4) = 0.0_wp
      type(closest_type) :: trial
      integer :: f, cell

      point = 0.0_wp
      point(:size(x)) = x
      least = huge(1.0_wp)
      do f = 1, surface%facets%n
         cell = surface%facets%cell(f)
         call project_on_facet(surface%coefficient(:, :, f), surface%basis%family(cell), &
            & surface%basis%centre(:, cell), none, point, trial)
         least = min(least, trial%distance2)
      end do
   end function brute_distance2

   !> 10 000 random pairs; an extension without end makes every point count.
   subroutine the_tree_misses_nothing()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp) :: x(3), d
      integer :: cell, i, misses, n

      call test('the tree finds the facet that brute force finds')
      limits%extension = 0.0_wp
      do cell = 1, 6
         call make_sheet(scene, cell, merge(9, 60, cell > 2), 0.1_wp)
         n = scene%surface%ndim
         misses = 0
         do i = 1, 1700
            call random_number(x)
            x(n) = 0.6_wp*x(n) - 0.3_wp
            call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, found)
            d = sqrt(brute_distance2(scene%surface, x(:n)))
            if (found%facet == 0) then
               ! Only points beyond the perimeter are opposite nothing.
               if (all(x(:n - 1) > 0.3_wp .and. x(:n - 1) < 0.7_wp)) misses = misses + 1
            else
               if (abs(norm2(x(:n) - found%point(:n)) - d) > tight) misses = misses + 1
               if (abs(abs(found%gap) - d) > 1.0e-9_wp) misses = misses + 1
            end if
         end do
         call is_true(trim(cell_names(cell))//' no miss', misses == 0)
      end do
   end subroutine the_tree_misses_nothing

   !> More than 1e5 points over more than 1000 different rough surfaces of every facet cell.
   subroutine no_miss_in_random_configurations()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp), allocatable :: noise(:, :), flat(:, :)
      real(wp) :: x(3)
      integer :: cell, k, i, n, misses, claimed
      integer, parameter :: surfaces = 180, points = 100

      call test('no miss against brute force in 1e5 random configurations')
      claimed = 0
      do cell = 1, 6
         call make_sheet(scene, cell, merge(20, 6, cell <= 2), 0.1_wp)
         n = scene%surface%ndim
         flat = scene%x
         allocate (noise(n, size(flat, 2)))
         misses = 0
         do k = 1, surfaces
            call random_number(noise)
            scene%x = flat + merge(0.01_wp, 0.03_wp, n == 2 .or. cell == 4 &
               & .or. cell == 6)*(noise - 0.5_wp)
            call follow(scene)
            call build_tree(scene%tree, scene%surface%low, scene%surface%high)
            do i = 1, points
               call random_number(x)
               x(:n - 1) = 0.3_wp + 0.4_wp*x(:n - 1)
               x(n) = 0.4_wp*x(n) - 0.2_wp
               call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, found)
               if (found%facet == 0) cycle
               claimed = claimed + 1
               if (.not. norm2(x(:n) - found%point(:n)) <= sqrt(brute_distance2(scene%surface, &
                  & x(:n))) + 1.0e-10_wp) misses = misses + 1
               if (.not. abs(norm2(found%normal) - 1.0_wp) < 1.0e-9_wp) misses = misses + 1
            end do
         end do
         call is_true(trim(cell_names(cell))//' no miss', misses == 0)
         deallocate (noise)
      end do
      call is_true('1e5 points', claimed >= 100000)
   end subroutine no_miss_in_random_configurations

   subroutine a_closed_cube_has_its_exact_signed_distance()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp) :: x(3), outside(3), expected
      integer :: i, k

      call test('every point is claimed by a closed surface, with the exact signed distance')
      do k = 1, 2
         call make_cube(scene, 3, k == 2)
         call is_true('no perimeter', all(scene%surface%neighbour(:merge(4, 3, k == 1), :) > 0))
         do i = 1, 3000
            call random_number(x)
            x = 4.0_wp*x - 2.0_wp
            if (mod(i, 3) == 0) x = real(nint(3.0_wp*x), wp)/3.0_wp
            if (mod(i, 7) == 0) x = 1.0_wp + 1.0e-12_wp*(x - 0.5_wp)
            outside = abs(x) - 1.0_wp
            expected = norm2(max(outside, 0.0_wp)) + min(maxval(outside), 0.0_wp)
            call find_projection(scene%surface, scene%tree, x, any_side, limits, found)
            call is_true('claimed', found%facet > 0)
            call close_to('gap', found%gap, expected, merge(1.0e-11_wp, tight, mod(i, 7) == 0))
            call close_to('unit normal', norm2(found%normal), 1.0_wp, tight)
         end do
      end do
   end subroutine a_closed_cube_has_its_exact_signed_distance

   subroutine the_normal_is_the_gradient_of_the_gap()
      type(scene_type) :: scene
      type(projection_type) :: found, plus, minus
      type(limits_type) :: limits
      real(wp), parameter :: h = 1.0e-6_wp
      real(wp) :: x(3)
      integer :: cell, i, j, n

      call test('differences of the gap equal the normal, on facets, edges and vertices')
      do cell = 1, 6
         call make_sheet(scene, cell, 6, 0.15_wp)
         n = scene%surface%ndim
         do i = 1, 200
            call random_number(x)
            x(n) = 0.4_wp*x(n) - 0.2_wp
            call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, found)
            if (found%facet == 0) cycle
            do j = 1, n
               x(j) = x(j) + h
               call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, plus)
               x(j) = x(j) - 2.0_wp*h
               call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, minus)
               x(j) = x(j) + h
               if (plus%facet /= minus%facet .or. plus%place /= minus%place &
                  & .or. plus%facet == 0) cycle
               call close_to(trim(cell_names(cell))//' gradient', (plus%gap - &
                  & minus%gap)/(2.0_wp*h), &
                  & found%normal(j), 2.0e-6_wp)
            end do
         end do
      end do
   end subroutine the_normal_is_the_gradient_of_the_gap

   subroutine shape_values_carry_the_foot()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp) :: x(3), foot(3)
      integer :: cell, i, n, m

      call test('shape values times nodes give the foot, also when extended')
      do cell = 1, 6
         call make_sheet(scene, cell, 4, 0.1_wp)
         n = scene%surface%ndim
         do i = 1, 100
            call random_number(x)
            x(:n - 1) = 1.1_wp*x(:n - 1) - 0.05_wp
            x(n) = 0.2_wp*x(n) - 0.1_wp
            call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, found)
            if (found%facet == 0) cycle
            m = scene%surface%facets%nnode(found%facet)
            foot(:n) = matmul(scene%x(:, scene%surface%facets%node(:m, found%facet)), &
               & found%shape(:m))
            call close_to('foot', foot(:n), found%point(:n), tight)
            call close_to('sum', sum(found%shape), 1.0_wp, tight)
            call close_to('x = foot + gap n', found%point(:n) + found%gap*found%normal(:n), x(:n), &
               & 1.0e-9_wp)
         end do
      end do
   end subroutine shape_values_carry_the_foot

   subroutine a_thin_sheet_is_met_on_the_right_side()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp) :: x(3)
      integer :: i

      call test('between the two faces of a thin plate the facing side is taken, not the nearest')
      call make_cube(scene, 4, .false.)
      scene%x(3, :) = 0.01_wp*scene%x(3, :)
      call follow(scene)
      call refit_tree(scene%tree, scene%surface%low, scene%surface%high)
      do i = 1, 100
         call random_number(x)
         x(:2) = 1.8_wp*x(:2) - 0.9_wp
         x(3) = 0.018_wp*x(3) - 0.009_wp
         call find_projection(scene%surface, scene%tree, x, [0.0_wp, 0.0_wp, -1.0_wp], limits, &
            & found)
         call close_to('upper face', found%gap, x(3) - 0.01_wp, tight)
         call close_to('up', found%normal, [0.0_wp, 0.0_wp, 1.0_wp], tight)
         call find_projection(scene%surface, scene%tree, x, [0.0_wp, 0.0_wp, 1.0_wp], limits, found)
         call close_to('lower face', found%gap, -0.01_wp - x(3), tight)
      end do
   end subroutine a_thin_sheet_is_met_on_the_right_side

   subroutine a_point_beside_a_block_meets_nothing()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits

      call test('a point beside a block that looks down does not penetrate its top')
      call make_cube(scene, 2, .false.)
      call find_projection(scene%surface, scene%tree, [1.05_wp, 0.2_wp, 0.8_wp], [0.0_wp, 0.0_wp, &
         & -1.0_wp], limits, found)
      call is_true('nothing opposite', found%facet == 0)
      call find_projection(scene%surface, scene%tree, [1.03_wp, 0.2_wp, 1.04_wp], [0.0_wp, 0.0_wp, &
         & -1.0_wp], limits, found)
      call close_to('above the edge: open', found%gap, 0.05_wp, tight)
      call find_projection(scene%surface, scene%tree, [0.99_wp, 0.2_wp, 0.95_wp], [0.0_wp, 0.0_wp, &
         & -1.0_wp], limits, found)
      call close_to('inside near the edge: under the top', found%gap, -0.05_wp, tight)
   end subroutine a_point_beside_a_block_meets_nothing

   subroutine a_point_flush_with_a_wall_meets_the_top()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp), parameter :: down(3) = [0.0_wp, 0.0_wp, -1.0_wp]
      real(wp) :: beside
      integer :: i, k

      call test('a point flush with walls of a block is under its top, beside them by little')
      do k = 1, 2
         call make_cube(scene, 2, k == 2)
         do i = -1, 1
            beside = 1.0_wp + i*1.0e-15_wp
            call find_projection(scene%surface, scene%tree, [beside, 0.2_wp, 0.7_wp], down, &
               & limits, found)
            call close_to('at an edge', found%gap, -0.3_wp, tight)
            call find_projection(scene%surface, scene%tree, [beside, -beside, 0.7_wp], down, &
               & limits, found)
            call close_to('at a corner', found%gap, -0.3_wp, tight)
            call close_to('up', found%normal, -down, tight)
         end do
         call find_projection(scene%surface, scene%tree, [1.0_wp + 1.0e-6_wp, 0.2_wp, 0.3_wp], &
            & down, limits, found)
         call is_true('not so deep beside it', found%facet == 0)
         call find_projection(scene%surface, scene%tree, [1.02_wp, -1.03_wp, 0.98_wp], down, &
            & limits, found)
         call close_to('bulged past a corner', found%gap, -0.02_wp, tight)
         call find_projection(scene%surface, scene%tree, [1.02_wp, 0.2_wp, 1.01_wp], down, &
            & limits, found)
         call close_to('just above', found%gap, 0.01_wp, tight)
         call find_projection(scene%surface, scene%tree, [1.2_wp, 0.2_wp, 0.99_wp], down, limits, &
            & found)
         call is_true('too far beside', found%facet == 0)
      end do
   end subroutine a_point_flush_with_a_wall_meets_the_top

   subroutine the_perimeter_extends_by_a_fraction()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      integer :: cell, n
      real(wp) :: x(3)

      call test('just beyond the perimeter a facet goes on, further it does not')
      do cell = 1, 6
         call make_sheet(scene, cell, 5, 0.0_wp)
         n = scene%surface%ndim
         x = 0.51_wp
         x(1) = 1.015_wp
         x(n) = -0.03_wp
         call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, found)
         call is_true(trim(cell_names(cell))//' extended', found%place == place%extended)
         call close_to('gap', found%gap, -0.03_wp, tight)
         call close_to('foot', found%point(1), 1.015_wp, tight)
         x(1) = 1.03_wp
         call find_projection(scene%surface, scene%tree, x(:n), any_side(:n), limits, found)
         call is_true('beyond', found%facet == 0)
         if (n == 2) cycle
         ! At a corner of the sheet some triangles have no edge on the perimeter on that side.
         call find_projection(scene%surface, scene%tree, [-0.015_wp, -0.015_wp, 0.1_wp], any_side, &
            & limits, found)
         call is_true('corner', found%facet > 0)
         call close_to('gap', found%gap, 0.1_wp, tight)
         limits%extension = 0.0_wp
         call find_projection(scene%surface, scene%tree, [1.0_wp, 0.4_wp, 0.1_wp], any_side, &
            & limits, found)
         call is_true('without extension the rim still counts', found%facet > 0)
         limits%extension = 0.1_wp
      end do
   end subroutine the_perimeter_extends_by_a_fraction

   subroutine a_ridge_ends_in_a_plane_of_symmetry()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      integer :: k

      call test('above the end of a ridge on the perimeter a point is still claimed')
      call make_sheet(scene, cell_id%quad, 2, 0.0_wp)
      scene%x(3, :) = -abs(scene%x(1, :) - 0.5_wp)
      call follow(scene)
      call refit_tree(scene%tree, scene%surface%low, scene%surface%high)
      do k = -1, 1
         call find_projection(scene%surface, scene%tree, [0.5_wp, real(k, wp)*1.0e-12_wp, 0.2_wp], &
            & any_side, limits, found)
         call is_true('claimed', found%facet > 0)
         call close_to('gap', found%gap, 0.2_wp, 1.0e-9_wp)
         call close_to('normal', found%normal, [0.0_wp, 0.0_wp, 1.0_wp], 1.0e-9_wp)
      end do
   end subroutine a_ridge_ends_in_a_plane_of_symmetry

   !> Convex polyline with kinks of 10 degrees: the gap must follow the step, never jump.
   subroutine a_polyline_is_followed_without_jumps()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits
      real(wp) :: angle, x(2), old, step
      integer :: i

      call test('sliding over kinks the gap changes by no more than the step')
      call make_sheet(scene, cell_id%line2, 12, 0.0_wp)
      do i = 1, size(scene%x, 2)
         angle = acos(-1.0_wp)*(0.25_wp + 0.5_wp*(1.0_wp - scene%x(1, i)))
         scene%x(:, i) = [cos(angle), sin(angle)]
      end do
      call follow(scene)
      call refit_tree(scene%tree, scene%surface%low, scene%surface%high)
      step = 1.0e-3_wp
      old = 0.0_wp
      do i = 0, 1200
         x = [-0.6_wp + step*real(i, wp), 0.0_wp]
         x(2) = sqrt(1.0_wp - x(1)**2) - 1.0e-3_wp
         call find_projection(scene%surface, scene%tree, x, any_side(:2), limits, found)
         call is_true('claimed', found%facet > 0)
         if (i > 0) call is_true('no jump', abs(found%gap - old) <= 2.0_wp*step)
         call is_true('radial', dot_product(found%normal(:2), x) > 0.98_wp)
         old = found%gap
      end do
   end subroutine a_polyline_is_followed_without_jumps

   subroutine limits_are_respected()
      type(scene_type) :: scene
      type(projection_type) :: found
      type(limits_type) :: limits

      call test('reach and depth are limits')
      call make_sheet(scene, cell_id%quad, 4, 0.0_wp)
      limits%reach = 0.2_wp
      call find_projection(scene%surface, scene%tree, [0.4_wp, 0.4_wp, 0.19_wp], any_side, limits, &
         & found)
      call is_true('within reach', found%facet > 0)
      call find_projection(scene%surface, scene%tree, [0.4_wp, 0.4_wp, 0.21_wp], any_side, limits, &
         & found)
      call is_true('out of reach', found%facet == 0)
      limits%depth = 0.1_wp
      call find_projection(scene%surface, scene%tree, [0.4_wp, 0.4_wp, -0.09_wp], any_side, &
         & limits, found)
      call is_true('not too deep', found%facet > 0)
      call find_projection(scene%surface, scene%tree, [0.4_wp, 0.4_wp, -0.11_wp], any_side, &
         & limits, found)
      call is_true('too deep', found%facet == 0)
   end subroutine limits_are_respected

   subroutine turning_and_scaling_change_nothing()
      type(scene_type) :: scene, other
      type(projection_type) :: a, b
      type(limits_type) :: limits
      real(wp) :: x(3), turn(3, 3), factor
      integer :: i, k

      call test('turning the scene and changing the unit of length change no foot')
      call make_sheet(scene, cell_id%quad8, 5, 0.1_wp)
      do k = 1, 3
         call make_sheet(other, cell_id%quad8, 5, 0.1_wp)
         turn = rotation_matrix([0.0_wp, 0.0_wp, 0.0_wp])
         if (k == 3) turn = rotation_matrix([1.0_wp, 0.3_wp, -0.8_wp])
         factor = merge(1.0e-9_wp, 1.0e9_wp, k == 1)
         if (k == 3) factor = 1.0_wp
         other%x = factor*matmul(turn, other%x)
         call follow(other)
         call build_tree(other%tree, other%surface%low, other%surface%high)
         do i = 1, 200
            call random_number(x)
            x(3) = 0.4_wp*x(3) - 0.2_wp
            call find_projection(scene%surface, scene%tree, x, any_side, limits, a)
            call find_projection(other%surface, other%tree, factor*matmul(turn, x), any_side, &
               & limits, b)
            call is_true('facet', a%facet == b%facet)
            call close_to('xi', b%xi, a%xi, 1.0e-9_wp)
            call close_to('gap', b%gap/factor, a%gap, tight)
            call close_to('normal', matmul(transpose(turn), b%normal), a%normal, 1.0e-9_wp)
         end do
      end do
   end subroutine turning_and_scaling_change_nothing

   subroutine threads_do_not_change_a_bit()
      type(scene_type) :: scene
      integer, parameter :: n = 2000
      type(projection_type) :: one(n), many(n)
      type(limits_type) :: limits
      real(wp) :: x(3, n), normal(3, n)
      integer :: i, before
      logical :: same

      call test('the answers are the same bits for any number of threads')
      call make_sheet(scene, cell_id%quad, 30, 0.1_wp)
      call random_number(x)
      x(3, :) = 0.4_wp*x(3, :) - 0.2_wp
      normal = 0.0_wp
      normal(3, :) = -1.0_wp
      before = threads_of_run()
      call set_threads_of_run(1)
      call find_projections(scene%surface, scene%tree, x, normal, limits, one)
      call set_threads_of_run(3)
      call find_projections(scene%surface, scene%tree, x, normal, limits, many)
      call set_threads_of_run(before)
      same = .true.
      do i = 1, n
         same = same .and. one(i)%facet == many(i)%facet .and. abs(one(i)%gap - &
            & many(i)%gap) <= 0.0_wp &
            & .and. maxval(abs(one(i)%xi - many(i)%xi)) <= 0.0_wp
      end do
      call is_true('same', same)
   end subroutine threads_do_not_change_a_bit

   subroutine a_refitted_tree_answers_like_a_new_one()
      type(scene_type) :: scene
      type(tree_type) :: fresh
      type(projection_type) :: a, b
      type(limits_type) :: limits
      real(wp) :: x(3)
      integer :: i

      call test('a refitted tree gives the answers of a new one')
      call make_sheet(scene, cell_id%triangle, 12, 0.1_wp)
      call random_number(x)
      scene%x(3, :) = scene%x(3, :) + 0.3_wp*scene%x(1, :)
      scene%x(1, :) = scene%x(1, :)*(1.0_wp + 0.5_wp*scene%x(2, :))
      call follow(scene)
      call refit_tree(scene%tree, scene%surface%low, scene%surface%high)
      call build_tree(fresh, scene%surface%low, scene%surface%high)
      do i = 1, 500
         call random_number(x)
         call find_projection(scene%surface, scene%tree, x, any_side, limits, a)
         call find_projection(scene%surface, fresh, x, any_side, limits, b)
         call is_true('facet', a%facet == b%facet)
         call close_to('gap', a%gap, b%gap, tight)
      end do
   end subroutine a_refitted_tree_answers_like_a_new_one

   subroutine a_facet_without_area_is_refused()
      type(scene_type) :: scene
      type(error_type), allocatable :: error
      integer :: cell

      call test('a facet without area is refused')
      do cell = 1, 6
         call make_sheet(scene, cell, 2, 0.0_wp)
         scene%x = 0.3_wp
         call update_surface(scene%surface, scene%x, error)
         call is_true(trim(cell_names(cell))//' refused', allocated(error))
      end do
      call make_sheet(scene, cell_id%quad, 2, 0.0_wp)
      scene%x(1, :) = scene%x(2, :)
      call update_surface(scene%surface, scene%x, error)
      call is_true('on one line', allocated(error))
   end subroutine a_facet_without_area_is_refused
end program test_search
