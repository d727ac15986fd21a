!> Triangles curved by the normals of their corners: closer to what they mean than flat ones, and
!> without a jump from one to the next.
program test_tool_curved
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_facet_mesh, only : facet_flaws_type
   use lopin_tool, only : tool_type, foot_type
   use lopin_tool_curved, only : curved_tool_type
   use lopin_tool_factory, only : new_tool_from_facets
   use check, only : test, close_to, is_true, finish
   use facet_scenes, only : sphere_facets, box_facets, torus_facets, torus_radii, strips, &
      & new_open
   implicit none

   call random_init(.true., .false.)
   call a_sphere_is_met_far_better_than_by_flat_facets()
   call so_is_a_torus()
   call a_box_keeps_its_edges()
   call the_gap_does_not_jump()
   call the_normal_does_not_jump()
   call gradient_and_hessian_are_the_derivatives()
   call a_valley_holds_by_both_walls()
   call so_does_a_valley_that_ends()
   call what_lies_on_a_rough_surface_is_behind_no_wall_of_it()
   call a_crease_has_two_walls_from_both_of_its_sides()
   call walls_beside_a_fillet_of_two_chords_stay_flat()
   call wide_facets_of_a_cylinder_are_curved_too()
   call finish()

contains

   subroutine make(tool, corner, curved)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: corner(:, :, :)
      logical, intent(in) :: curved
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error

      call new_tool_from_facets(tool, corner, .false., .false., flaws, error, curved)
      call is_true('accepted', .not. allocated(error))
   end subroutine make

   !> A point off the unit sphere by up to a tenth.
   subroutine near_sphere(x)
      real(wp), intent(out) :: x(3)
      real(wp) :: r

      do
         call random_number(x)
         x = 2.0_wp*x - 1.0_wp
         if (norm2(x) > 0.1_wp .and. norm2(x) < 1.0_wp) exit
      end do
      call random_number(r)
      x = x/norm2(x)*(0.9_wp + 0.2_wp*r)
   end subroutine near_sphere

   subroutine a_sphere_is_met_far_better_than_by_flat_facets()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: x(3), worst(2), turned
      integer :: i, k

      call test('a sphere of facets: the gap is near that of the sphere')
      worst = 0.0_wp
      turned = 0.0_wp
      do k = 1, 2
         call make(tool, sphere_facets(6), k == 2)
         do i = 1, 2000
            call near_sphere(x)
            call tool%project(x, foot)
            worst(k) = max(worst(k), abs(foot%gap - (norm2(x) - 1.0_wp)))
            if (k == 2) turned = max(turned, norm2(foot%normal - x/norm2(x)))
         end do
      end do
      call is_true('gap', worst(2) < 0.15_wp*worst(1))
      call is_true('normal', turned < 0.07_wp)
   end subroutine a_sphere_is_met_far_better_than_by_flat_facets

   subroutine so_is_a_torus()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: x(3), worst(2), exact
      integer :: i, k

      call test('a torus of facets: the gap is near that of the torus')
      worst = 0.0_wp
      do k = 1, 2
         call make(tool, torus_facets(20), k == 2)
         do i = 1, 2000
            call random_number(x)
            x = (2.0_wp*x - 1.0_wp)*(torus_radii(1) + torus_radii(2))
            exact = norm2([norm2(x(:2)) - torus_radii(1), x(3)]) - torus_radii(2)
            if (abs(exact) > 0.3_wp*torus_radii(2)) cycle
            call tool%project(x, foot)
            worst(k) = max(worst(k), abs(foot%gap - exact))
         end do
      end do
      call is_true('gap', worst(2) < 0.2_wp*worst(1))
   end subroutine so_is_a_torus

   subroutine a_box_keeps_its_edges()
      class(tool_type), allocatable :: flat, curved
      type(foot_type) :: a, b
      real(wp) :: x(3)
      integer :: i

      call test('a box: edges of 90 degrees stay')
      call make(flat, box_facets(), .false.)
      call make(curved, box_facets(), .true.)
      do i = 1, 2000
         call random_number(x)
         x = 3.0_wp*x - 1.5_wp
         call flat%project(x, a)
         call curved%project(x, b)
         if (abs(a%gap - b%gap) > 1.0e-12_wp) exit
      end do
      call close_to('gap', b%gap, a%gap, 1.0e-12_wp)
   end subroutine a_box_keeps_its_edges

   !> Along a way over many facets the gap changes by no more than the way.
   subroutine the_gap_does_not_jump()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: before, worst
      integer :: i

      call test('no jump of the gap along a way over the facets')
      call make(tool, sphere_facets(5), .true.)
      worst = 0.0_wp
      do i = 0, 100000
         call tool%project(place(i), foot)
         if (i > 0) worst = max(worst, abs(foot%gap - before))
         before = foot%gap
      end do
      call is_true('gap', worst < 1.0_wp*norm2(place(1) - place(0)))
   end subroutine the_gap_does_not_jump

   subroutine the_normal_does_not_jump()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: before(3), worst
      integer :: i

      call test('no jump of the normal along a way over the facets')
      call make(tool, sphere_facets(5), .true.)
      worst = 0.0_wp
      do i = 0, 100000
         call tool%project(place(i), foot)
         if (i > 0) worst = max(worst, norm2(foot%normal - before))
         before = foot%normal
      end do
      call is_true('normal', worst < 20.0_wp*norm2(place(1) - place(0)))
   end subroutine the_normal_does_not_jump

   !> A great circle, a little outside and inside the sphere in turn.
   pure function place(i) result(x)
      integer, intent(in) :: i
      real(wp) :: x(3), t

      t = 1.0e-5_wp*i
      x = [cos(t), 0.8_wp*sin(t), 0.6_wp*sin(t)]
      x = x*(1.0_wp + 0.002_wp*sin(37.0_wp*t))
   end function place

   subroutine gradient_and_hessian_are_the_derivatives()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot, low, high
      real(wp), parameter :: h = 1.0e-6_wp
      real(wp) :: x(3), step(3), slope, bend(3), worst(3)
      integer :: i, d

      call test('gradient of the gap and of the normal, and the normal near the first')
      call make(tool, sphere_facets(6), .true.)
      worst = 0.0_wp
      do i = 1, 500
         call near_sphere(x)
         call tool%project(x, foot)
         do d = 1, 3
            step = 0.0_wp
            step(d) = h
            call tool%project(x - step, low)
            call tool%project(x + step, high)
            slope = (high%gap - low%gap)/(2.0_wp*h)
            bend = (high%normal - low%normal)/(2.0_wp*h)
            worst(1) = max(worst(1), abs(slope - foot%normal(d)))
            if (low%segment /= high%segment) cycle
            worst(3) = max(worst(3), abs(slope - foot%gradient(d)))
            worst(2) = max(worst(2), maxval(abs(bend - foot%hessian(:, d))))
         end do
      end do
      call is_true('normal', worst(1) < 0.04_wp)
      call is_true('hessian', worst(2) < 1.0e-5_wp)
      call is_true('gradient', worst(3) < 1.0e-5_wp)
   end subroutine gradient_and_hessian_are_the_derivatives

   !> A crease of 25 degrees that stands alone: both walls within reach, each by its own plane, on
   !> either side of the crease and where the point has gone through one of them or both.
   subroutine a_valley_holds_by_both_walls()
      class(tool_type), allocatable :: tool
      type(foot_type) :: feet(2)
      real(wp), parameter :: half = 12.5_wp*acos(-1.0_wp)/180.0_wp
      real(wp) :: corner(3, 3, 4), x(3), gap(2), worst
      integer :: i, n, most

      call test('a valley of 25 degrees holds a point by both of its walls')
      corner(:, :, 1) = wall(1.0_wp, [0.0_wp, 1.0_wp, 1.0_wp], [-1.0_wp, -1.0_wp, 1.0_wp])
      corner(:, :, 2) = wall(1.0_wp, [0.0_wp, 1.0_wp, 0.0_wp], [-1.0_wp, 1.0_wp, 1.0_wp])
      corner(:, :, 3) = wall(-1.0_wp, [0.0_wp, 1.0_wp, 1.0_wp], [-1.0_wp, 1.0_wp, -1.0_wp])
      corner(:, :, 4) = wall(-1.0_wp, [0.0_wp, 0.0_wp, 1.0_wp], [-1.0_wp, 1.0_wp, 1.0_wp])
      call new_open(tool, corner)
      worst = 0.0_wp
      most = 2
      do i = 1, 1000
         call random_number(x)
         x = [0.1_wp, 0.5_wp, 0.02_wp]*(2.0_wp*x - 1.0_wp)
         if (i == 1) x = 0.0_wp
         call tool%project_all(x, 0.5_wp, feet, n)
         most = min(most, n)
         gap = cos(half)*x(3) - sin(half)*x(1)*[1.0_wp, -1.0_wp]
         worst = max(worst, abs(feet(1)%gap - minval(gap)), abs(feet(2)%gap - maxval(gap)))
      end do
      call is_true('two feet', most == 2)
      call is_true('gaps', worst < 1.0e-12_wp)
   end subroutine a_valley_holds_by_both_walls

   !> Floor before y = 0, behind it a wall that rises by 25 degrees up to x = 0 and not at all from
   !> x = 3 on: both are one surface, around the end of the crease.
   subroutine so_does_a_valley_that_ends()
      class(tool_type), allocatable :: tool
      type(foot_type) :: feet(2)
      real(wp), parameter :: slope = tan(25.0_wp*acos(-1.0_wp)/180.0_wp)
      real(wp) :: corner(3, 3, 24), p(3, 3, 7), x(3), gap(2), worst
      integer :: i, n, most

      call test('so does a valley that ends in one surface')
      do i = 1, 7
         p(:, 1, i) = [i - 4.0_wp, -1.0_wp, 0.0_wp]
         p(:, 2, i) = [i - 4.0_wp, 0.0_wp, 0.0_wp]
         p(:, 3, i) = [i - 4.0_wp, 1.0_wp, slope*min(1.0_wp, max(0.0_wp, (7.0_wp - i)/3.0_wp))]
      end do
      call strips(p, corner)
      call new_open(tool, corner)
      worst = 0.0_wp
      most = 2
      do i = 1, 1000
         call random_number(x)
         x = [0.2_wp, 0.1_wp, 0.02_wp]*(2.0_wp*x - 1.0_wp) - [1.5_wp, 0.0_wp, 0.0_wp]
         call tool%project_all(x, 0.5_wp, feet, n)
         most = min(most, n)
         gap = [x(3), (x(3) - slope*x(2))/sqrt(1.0_wp + slope**2)]
         worst = max(worst, abs(feet(1)%gap - minval(gap)), abs(feet(2)%gap - maxval(gap)))
      end do
      call is_true('two feet', most == 2)
      call is_true('gaps', worst < 1.0e-9_wp)
   end subroutine so_does_a_valley_that_ends

   !> A tool of n x n heights at random: creases of all angles, most of which end at once.
   subroutine new_rough(tool, n)
      class(tool_type), allocatable, intent(out) :: tool
      integer, intent(in) :: n
      real(wp) :: corner(3, 3, 2*(n - 1)**2), p(3, n, n), noise(3)
      integer :: i, j

      do i = 1, n
         do j = 1, n
            call random_number(noise)
            p(:, j, i) = [real(i, wp), real(j, wp), 0.0_wp] + [0.4_wp, 0.4_wp, 0.7_wp]*noise
         end do
      end do
      call strips(p, corner)
      call new_open(tool, corner)
   end subroutine new_rough

   !> A point on the surface is in the corner of two walls or is not; behind one of them it would be
   !> inside the tool.
   subroutine what_lies_on_a_rough_surface_is_behind_no_wall_of_it()
      class(tool_type), allocatable :: tool
      type(foot_type) :: feet(2)
      integer, parameter :: n = 12
      real(wp) :: x(3), deepest
      integer :: k, number, twice

      call test('what lies on a rough surface is behind no wall of it')
      call new_rough(tool, n)
      deepest = 0.0_wp
      twice = 0
      do k = 1, 20000
         call random_number(x)
         x = [2.0_wp, 2.0_wp, 0.0_wp] + real(n - 3, wp)*[x(1), x(2), 0.0_wp]
         call tool%project(x, feet(1))
         x = feet(1)%point
         call tool%project_all(x, 0.5_wp, feet, number)
         if (number < 2) cycle
         twice = twice + 1
         deepest = min(deepest, feet(1)%gap)
      end do
      call is_true('many are in corners', twice > 1000)
      call is_true('behind none', deepest > -1.0e-6_wp)
   end subroutine what_lies_on_a_rough_surface_is_behind_no_wall_of_it

   !> Normals are means about the corners: where a crease ends, those on its sides turn towards each
   !> other, and the facet of one side may look as the other does where they meet.
   subroutine a_crease_has_two_walls_from_both_of_its_sides()
      class(tool_type), allocatable :: tool
      type(foot_type) :: feet(2)
      integer, parameter :: n = 20
      real(wp) :: x(3)
      integer :: f, k, g, number, asked, found(2), side

      call test('a concave crease has two walls from both of its sides')
      call new_rough(tool, n)
      asked = 0
      found = 0
      select type (tool)
      type is (curved_tool_type)
         do f = 1, tool%mesh%nfacet
            do k = 1, 3
               g = tool%mesh%neighbour(k, f)
               if (g == 0 .or. .not. tool%hollow(k, f)) cycle
               asked = asked + 1
               associate (v => tool%mesh%vertex(:, f), to => 1 + mod(k, 3))
                  x = 0.5_wp*(tool%mesh%x(:, v(k)) + tool%mesh%x(:, v(to)))
               end associate
               do side = 1, 2
                  call tool%project_all(x + (side - 1.5_wp)*1.0e-5_wp*(tool%mesh%normal(:, g) &
                     & - tool%mesh%normal(:, f)), 0.5_wp, feet, number)
                  if (number == 2) found(side) = found(side) + 1
               end do
            end do
         end do
      end select
      call is_true('many creases', asked > 100)
      call is_true('two walls from one side', found(1) == asked)
      call is_true('and from the other', found(2) == asked)
   end subroutine a_crease_has_two_walls_from_both_of_its_sides

   !> Facets of 20 degrees between two of 5, and of 7 beside 2: no fillet begins at the narrow ones,
   !> which turn no more from one to the next than at the wide one.
   subroutine wide_facets_of_a_cylinder_are_curved_too()
      integer, parameter :: n = 13
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
      real(wp) :: corner(3, 3, 8*(n - 1)), p(3, 5, n), part(3), wide, a
      integer :: i, way

      call test('wide facets of a cylinder are curved, beside narrow ones too')
      do way = 1, 2
         part = merge([5.0_wp, 5.0_wp, 20.0_wp], [2.0_wp, 7.0_wp, 2.0_wp], way == 1)
         wide = maxval(part)*degree
         a = 0.0_wp
         do i = 1, n
            p(1, :, i) = sin(a)
            p(3, :, i) = cos(a)
            a = a + merge(part(1 + mod(i - 1, 3)), part(1 + mod(i - 1, 2)), way == 1)*degree
         end do
         do i = 1, 5
            p(2, i, :) = i - 3.0_wp
         end do
         call strips(p, corner)
         call new_open(tool, corner)
         ! The middle of the third wide facet, or of the sixth.
         i = merge(9, 6, way == 1)
         associate (middle => 0.5_wp*(p(:, 3, i) + p(:, 3, i + 1)))
            call tool%project(middle/norm2(middle([1, 3])), foot)
         end associate
         call is_true('nearer than the chord', abs(foot%gap) < 0.9_wp*(1.0_wp - cos(0.5_wp*wide)))
      end do
   end subroutine wide_facets_of_a_cylinder_are_curved_too

   !> A plane, a fillet of radius 1 that turns by 56 degrees in two chords, and a wall beyond it.
   subroutine walls_beside_a_fillet_of_two_chords_stay_flat()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: turn = 56.0_wp*acos(-1.0_wp)/180.0_wp
      real(wp) :: corner(3, 3, 32), p(3, 5, 5), x(3), a, off(3)
      integer :: i, part

      call test('walls beside a fillet of two chords stay flat, and the fillet is round')
      do i = 1, 5
         p(2, i, :) = i - 3.0_wp
      end do
      p(1, :, 1) = -10.0_wp
      p(3, :, 1) = 0.0_wp
      do i = 0, 2
         p(1, :, 2 + i) = sin(0.5_wp*i*turn)
         p(3, :, 2 + i) = cos(0.5_wp*i*turn) - 1.0_wp
      end do
      p(1, :, 5) = p(1, :, 4) + 8.0_wp*cos(turn)
      p(3, :, 5) = p(3, :, 4) - 8.0_wp*sin(turn)
      call strips(p, corner)
      call new_open(tool, corner)
      off = 0.0_wp
      do i = 1, 300
         do part = 1, 3
            call random_number(a)
            x(2) = 3.0_wp*a - 1.5_wp
            call random_number(a)
            select case (part)
            case (1)
               x([1, 3]) = [-10.0_wp*a, 0.0_wp]
            case (2)
               x([1, 3]) = [sin(a*turn), cos(a*turn) - 1.0_wp]
            case (3)
               x([1, 3]) = p([1, 3], 1, 4)*(1.0_wp - a) + p([1, 3], 1, 5)*a
            end select
            call tool%project(x, foot)
            off(part) = max(off(part), abs(foot%gap))
         end do
      end do
      call is_true('plane and wall', maxval(off([1, 3])) < 1.0e-9_wp)
      call is_true('fillet', off(2) < 0.2_wp*(1.0_wp - cos(0.25_wp*turn)))
      off(1) = maxval(tool%chord)
      call close_to('what stands off', off(1), 0.5_wp*sin(0.25_wp*turn)*tan(0.25_wp*turn), &
         & 1.0e-9_wp)
   end subroutine walls_beside_a_fillet_of_two_chords_stay_flat

   !> A triangle of a wall that rises from the crease.
   pure function wall(side, out, along) result(corner)
      real(wp), intent(in) :: side, out(3), along(3)
      real(wp), parameter :: half = 12.5_wp*acos(-1.0_wp)/180.0_wp
      real(wp) :: corner(3, 3)

      corner(1, :) = side*cos(half)*out
      corner(2, :) = along
      corner(3, :) = sin(half)*out
   end function wall
end program test_tool_curved
