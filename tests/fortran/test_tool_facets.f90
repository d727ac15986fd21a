!> Tools of triangles against closed forms, against a plain loop over all, and what is refused.
program test_tool_facets
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_facet_mesh, only : facet_flaws_type, facet_mesh_type, new_facet_mesh
   use lopin_text, only : to_text
   use lopin_tool, only : tool_type, foot_type
   use lopin_tool_factory, only : new_tool_from_facets
   use check, only : test, close_to, is_true, finish
   use facet_scenes, only : sphere_facets, box_facets, torus_facets, valley_facets, torus_radii
   implicit none

   integer, parameter :: nrandom = 100000

   call random_init(.true., .false.)
   call a_box_is_exact()
   call facets_of_a_sphere_converge_by_the_square()
   call facets_of_a_torus_converge_by_the_square()
   call the_tree_finds_what_a_loop_finds()
   call normal_and_hessian_are_derivatives()
   call a_point_on_the_surface_has_one_facet()
   call a_valley_has_two_walls()
   call an_open_sheet_says_how_far_beyond_its_end()
   call wrong_surfaces_are_refused()
   call facets_without_area_are_dropped()
   call queries_are_quick()
   call finish()

contains

   subroutine make(tool, corner)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: corner(:, :, :)
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error

      call new_tool_from_facets(tool, corner, .false., .false., flaws, error)
      call is_true('accepted', .not. allocated(error))
   end subroutine make

   !> Uniform in the cube of half side `half`.
   subroutine random_point(x, half)
      real(wp), intent(out) :: x(3)
      real(wp), intent(in) :: half
      call random_number(x)
      x = half*(2.0_wp*x - 1.0_wp)
   end subroutine random_point

   subroutine a_box_is_exact()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: x(3), q(3), gap, worst
      integer :: i

      call test('a box: the signed distance of a cube')
      call make(tool, box_facets())
      worst = 0.0_wp
      do i = 1, 10000
         call random_point(x, 2.0_wp)
         q = abs(x) - 1.0_wp
         gap = norm2(max(q, 0.0_wp)) + min(maxval(q), 0.0_wp)
         call tool%project(x, foot)
         worst = max(worst, abs(foot%gap - gap), norm2(x - foot%point - foot%gap*foot%normal))
      end do
      call close_to('gap and foot', worst, 0.0_wp, 1.0e-14_wp)
      call close_to('nothing curved is meant', maxval(tool%chord), 0.0_wp, 1.0e-14_wp)
   end subroutine a_box_is_exact

   subroutine facets_of_a_sphere_converge_by_the_square()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: x(3), error(3)
      integer :: i, k

      call test('a sphere of facets: the error of the gap falls by the square')
      error = 0.0_wp
      do k = 1, 3
         call make(tool, sphere_facets(5*2**k))
         do i = 1, 5000
            call random_point(x, 1.0_wp)
            x = x*(0.9_wp + 0.2_wp*real(mod(i, 10), wp)/9.0_wp)/norm2(x)
            call tool%project(x, foot)
            error(k) = max(error(k), abs(foot%gap - (norm2(x) - 1.0_wp)))
         end do
         call is_true('the chord error is foretold', maxval(tool%chord) > 0.5_wp*error(k) .and. &
            & maxval(tool%chord) < 2.0_wp*error(k))
      end do
      call close_to('factor', error(1)/error(2), 4.0_wp, 0.4_wp)
      call close_to('factor', error(2)/error(3), 4.0_wp, 0.4_wp)
   end subroutine facets_of_a_sphere_converge_by_the_square

   subroutine facets_of_a_torus_converge_by_the_square()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: x(3), error(3), exact
      integer :: i, k

      call test('a torus of facets: the error of the gap falls by the square')
      error = 0.0_wp
      do k = 1, 3
         call make(tool, torus_facets(10*2**k))
         do i = 1, 5000
            call random_point(x, 3.0_wp)
            exact = hypot(norm2(x(:2)) - torus_radii(1), x(3)) - torus_radii(2)
            if (abs(exact) > 0.3_wp) cycle
            call tool%project(x, foot)
            error(k) = max(error(k), abs(foot%gap - exact))
         end do
      end do
      call close_to('factor', error(1)/error(2), 4.0_wp, 0.5_wp)
      call close_to('factor', error(2)/error(3), 4.0_wp, 0.5_wp)
   end subroutine facets_of_a_torus_converge_by_the_square

   !> The distance to a triangle, written another way: least over plane, edges, corners.
   pure real(wp) function distance_of(a, b, c, x)
      real(wp), intent(in) :: a(3), b(3), c(3), x(3)
      real(wp) :: n(3), ab(3), ac(3), bary(2), m(2, 2), right(2), det

      distance_of = min(edge_distance(a, b, x), edge_distance(b, c, x), edge_distance(c, a, x))
      ab = b - a
      ac = c - a
      m = reshape([dot_product(ab, ab), dot_product(ab, ac), dot_product(ab, ac), &
         & dot_product(ac, ac)], [2, 2])
      right = [dot_product(ab, x - a), dot_product(ac, x - a)]
      det = m(1, 1)*m(2, 2) - m(1, 2)**2
      bary = [m(2, 2)*right(1) - m(1, 2)*right(2), m(1, 1)*right(2) - m(1, 2)*right(1)]/det
      if (minval(bary) < 0.0_wp .or. sum(bary) > 1.0_wp) return
      n = x - a - bary(1)*ab - bary(2)*ac
      distance_of = min(distance_of, norm2(n))
   end function distance_of

   pure real(wp) function edge_distance(a, b, x)
      real(wp), intent(in) :: a(3), b(3), x(3)
      real(wp) :: s

      s = min(1.0_wp, max(0.0_wp, dot_product(x - a, b - a)/dot_product(b - a, b - a)))
      edge_distance = norm2(x - a - s*(b - a))
   end function edge_distance

   subroutine the_tree_finds_what_a_loop_finds()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), allocatable :: corner(:, :, :), ball(:, :)
      real(wp) :: x(3), least
      integer :: i, f, missed

      call test('100 000 random points: what a loop over all facets finds')
      corner = torus_facets(8)
      call make(tool, corner)
      allocate (ball(4, size(corner, 3)))
      do f = 1, size(corner, 3)
         ball(:3, f) = sum(corner(:, :, f), dim=2)/3.0_wp
         ball(4, f) = maxval(norm2(corner(:, :, f) - spread(ball(:3, f), 2, 3), dim=1))
      end do
      missed = 0
      do i = 1, nrandom
         call random_point(x, 3.0_wp)
         call tool%project(x, foot)
         least = 10.0_wp
         do f = 1, size(corner, 3)
            ! What lies in a ball that is farther is not nearer.
            if (sum((x - ball(:3, f))**2) > (least + ball(4, f))**2) cycle
            least = min(least, distance_of(corner(:, 1, f), corner(:, 2, f), corner(:, 3, f), x))
         end do
         if (abs(abs(foot%gap) - least) > 1.0e-12_wp) missed = missed + 1
      end do
      call is_true('none missed ('//to_text(missed)//')', missed == 0)
   end subroutine the_tree_finds_what_a_loop_finds

   subroutine normal_and_hessian_are_derivatives()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot, plus, minus
      real(wp) :: x(3), step(3), bend(3, 3), worst(2)
      real(wp), parameter :: h = 1.0e-5_wp
      integer :: i, k
      logical :: crossed

      call test('normal and hessian are the derivatives of the gap, also at edges and corners')
      call make(tool, torus_facets(6))
      worst = 0.0_wp
      do i = 1, 3000
         call random_point(x, 3.0_wp)
         call tool%project(x, foot)
         if (abs(foot%gap) < 0.05_wp) cycle
         crossed = .false.
         do k = 1, 3
            step = 0.0_wp
            step(k) = h
            call tool%project(x + step, plus)
            call tool%project(x - step, minus)
            crossed = crossed .or. plus%segment /= foot%segment .or. minus%segment /= foot%segment &
               & .or. norm2(plus%hessian - foot%hessian) > 0.01_wp .or. norm2(minus%hessian - &
               & foot%hessian) > 0.01_wp
            bend(:, k) = (plus%normal - minus%normal)/(2.0_wp*h)
            if (.not. crossed) worst(1) = max(worst(1), abs((plus%gap - minus%gap)/(2.0_wp*h) - &
               & foot%normal(k)))
         end do
         if (.not. crossed) worst(2) = max(worst(2), norm2(bend - foot%hessian))
      end do
      call close_to('normal', worst(1), 0.0_wp, 1.0e-8_wp)
      call close_to('hessian', worst(2), 0.0_wp, 1.0e-6_wp)
   end subroutine normal_and_hessian_are_derivatives

   !> On edges and corners several facets are equally near: the least one is named, always.
   subroutine a_point_on_the_surface_has_one_facet()
      class(tool_type), allocatable :: tool
      type(facet_mesh_type) :: mesh
      type(facet_flaws_type) :: flaws
      type(foot_type) :: foot
      real(wp) :: s
      integer :: f, k, wrong

      call test('points on edges and corners are claimed once, by the least facet')
      call make(tool, torus_facets(8))
      call new_facet_mesh(mesh, torus_facets(8), flaws)
      wrong = 0
      do f = 1, mesh%nfacet
         do k = 1, 3
            associate (v => mesh%vertex(:, f))
               call tool%project(mesh%x(:, v(k)), foot)
               if (foot%segment /= minval(mesh%ring(mesh%ring_first(v(k)): &
                  & mesh%ring_first(v(k) + 1) - 1))) wrong = wrong + 1
               s = 0.25_wp
               call tool%project((1.0_wp - s)*mesh%x(:, v(k)) + s*mesh%x(:, v(1 + mod(k, 3))), foot)
               if (all(foot%segment /= [f, mesh%neighbour(k, f)])) wrong = wrong + 1
            end associate
            if (.not. (foot%found .and. abs(foot%gap) < 1.0e-14_wp)) wrong = wrong + 1
         end do
      end do
      call is_true('none lost, none twice ('//to_text(wrong)//')', wrong == 0)
   end subroutine a_point_on_the_surface_has_one_facet

   subroutine a_valley_has_two_walls()
      class(tool_type), allocatable :: tool
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error
      type(foot_type) :: feet(2)
      integer :: n

      call test('in a concave corner two walls are met, each with its gap')
      call new_tool_from_facets(tool, valley_facets(), .true., .false., flaws, error)
      call is_true('an open surface by its word', .not. allocated(error))
      call tool%project_all([0.2_wp, 1.0_wp, 0.1_wp], 0.5_wp, feet, n)
      call is_true('two', n == 2)
      call close_to('the nearer', feet(1)%gap, 0.1_wp, 1.0e-14_wp)
      call close_to('the other', feet(2)%gap, 0.2_wp, 1.0e-14_wp)
      call close_to('its normal', feet(2)%normal(1), 1.0_wp, 1.0e-14_wp)
      call tool%project_all([0.9_wp, 1.0_wp, 0.1_wp], 0.5_wp, feet, n)
      call is_true('one, if the other is out of reach', n == 1)
   end subroutine a_valley_has_two_walls

   subroutine an_open_sheet_says_how_far_beyond_its_end()
      class(tool_type), allocatable :: tool
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error
      type(foot_type) :: foot

      call test('beyond the end of a sheet')
      call new_tool_from_facets(tool, valley_facets(), .true., .false., flaws, error)
      call tool%project([9.5_wp, 1.0_wp, 0.1_wp], foot)
      call close_to('overhang', foot%overhang, 0.5_wp, 1.0e-14_wp)
      call close_to('the plane goes on', foot%gap, 0.1_wp, 1.0e-14_wp)
   end subroutine an_open_sheet_says_how_far_beyond_its_end

   subroutine wrong_surfaces_are_refused()
      class(tool_type), allocatable :: tool
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error
      type(foot_type) :: foot
      real(wp) :: corner(3, 3, 12)

      call test('holes, flipped facets, crowded edges')
      corner = box_facets()
      call new_tool_from_facets(tool, corner(:, :, :11), .false., .false., flaws, error)
      call is_true('a hole', allocated(error))
      call is_true('of three edges', flaws%hole == 3)
      corner(:, :, 5) = corner(:, [1, 3, 2], 5)
      call new_tool_from_facets(tool, corner, .false., .false., flaws, error)
      call is_true('one flipped', allocated(error) .and. flaws%against == 1)
      call new_tool_from_facets(tool, corner, .false., .true., flaws, error)
      call is_true('turned if allowed', allocated(tool) .and. flaws%against == 1)
      call tool%project([0.0_wp, 0.3_wp, 1.5_wp], foot)
      call close_to('then right', foot%gap, 0.5_wp, 1.0e-14_wp)
      call tool%project([0.2_wp, 1.5_wp, 0.3_wp], foot)
      call close_to('right everywhere', foot%gap, 0.5_wp, 1.0e-14_wp)
      corner = box_facets()
      call new_tool_from_facets(tool, reshape([corner, corner(:, :, 1:1) + spread(spread([0.0_wp, &
         & 0.0_wp, 0.0_wp], 2, 3), 3, 1)], [3, 3, 13]), .true., .true., flaws, error)
      call is_true('crowded', allocated(error) .and. flaws%crowded > 0)
      call new_tool_from_facets(tool, corner(:, :, :0), .true., .true., flaws, error)
      call is_true('nothing', allocated(error))
   end subroutine wrong_surfaces_are_refused

   subroutine facets_without_area_are_dropped()
      class(tool_type), allocatable :: tool
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error
      real(wp) :: corner(3, 3, 14)

      call test('welding closes cracks of rounding and drops facets without area')
      corner(:, :, :12) = box_facets()
      corner(:, :, 13) = spread(corner(:, 1, 1), 2, 3)
      corner(:, :, 14) = corner(:, [1, 2, 2], 3)
      corner(:, 1, 5) = corner(:, 1, 5) + 1.0e-7_wp
      call new_tool_from_facets(tool, corner, .false., .false., flaws, error)
      call is_true('accepted', allocated(tool))
      call is_true('two dropped', flaws%degenerate == 2)
   end subroutine facets_without_area_are_dropped

   subroutine queries_are_quick()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), allocatable :: x(:, :)
      integer(lk) :: before, after, rate
      real(wp) :: total
      integer :: i, k

      call test('a query costs the logarithm of the facets')
      allocate (x(3, 5000))
      do i = 1, size(x, 2)
         call random_point(x(:, i), 1.0_wp)
         x(:, i) = x(:, i)*(0.98_wp + 0.04_wp*real(mod(i, 10), wp)/9.0_wp)/norm2(x(:, i))
      end do
      do k = 1, 3
         call make(tool, sphere_facets(11*merge(1, merge(3, 10, k == 2), k == 1)))
         call system_clock(before, rate)
         total = 0.0_wp
         do i = 1, size(x, 2)
            call tool%project(x(:, i), foot)
            total = total + foot%gap
         end do
         call system_clock(after)
         write (*, '(a,i0,a,i0,a)') '   ', 8*(11*merge(1, merge(3, 10, k == 2), k == 1))**2, &
            & ' facets: ', nint(1.0e9_wp*real(after - before, wp)/real(rate, wp)/5000.0_wp), &
            & ' ns a query'
         call is_true('found', abs(total) < 1000.0_wp)
      end do
   end subroutine queries_are_quick
end program test_tool_facets
