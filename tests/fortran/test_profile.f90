!> Profiles of lines, arcs and parabolas: against sampling, at corners, at ends, with fillets.
program test_profile
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, nowhere
   use lopin_tool, only : tool_type, foot_type
   use lopin_profile, only : profile_type, segment_card_type, new_profile, segment_type, &
      & parabola_point, segment_kind
   use lopin_tool_factory, only : new_tool_from_segments
   use check, only : test, close_to, is_true, finish
   implicit none

   real(wp), parameter :: tight = 1.0e-12_wp

   call random_init(.true., .false.)
   call the_outward_side_is_on_the_left()
   call distance_equals_that_of_a_fine_sampling()
   call answers_scale_with_the_unit_of_length()
   call a_convex_corner_owns_its_wedge()
   call a_point_on_a_convex_corner_has_a_normal_in_the_cone()
   call a_concave_corner_gives_two_constraints()
   call two_reactions_in_a_concave_corner_are_exact()
   call an_open_end_says_how_far_beyond_it_is()
   call an_end_on_the_axis_is_no_end()
   call fillets_are_tangent_arcs()
   call a_closed_square_has_no_ends()
   call finish()

contains

   !> `numbers` holds four values a segment, START first.
   subroutine make(tool, words, numbers, fillet)
      class(tool_type), allocatable, intent(out) :: tool
      character(len=*), intent(in) :: words(:)
      real(wp), intent(in) :: numbers(:) !! two values for START and LINE, four for CIRCL and PARAB
      real(wp), intent(in) :: fillet
      type(segment_card_type) :: cards(size(words))
      type(error_type), allocatable :: error
      real(wp) :: none(3, 0)
      integer :: i, k, n

      k = 0
      do i = 1, size(words)
         n = merge(4, 2, words(i) == 'CIRCL' .or. words(i) == 'PARAB')
         cards(i)%word = words(i)
         cards(i)%value(:n) = numbers(k + 1:k + n)
         k = k + n
      end do
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards, fillet, nowhere, error)
      if (allocated(error)) print '(a)', error%text()
      call is_true('made', .not. allocated(error))
   end subroutine make

   subroutine make_corner(tool, concave)
      class(tool_type), allocatable, intent(out) :: tool
      logical, intent(in) :: concave

      if (concave) then
         call make(tool, ['START', 'LINE ', 'LINE '], [0.0_wp, 3.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, &
            & 0.0_wp], 0.0_wp)
      else
         call make(tool, ['START', 'LINE ', 'LINE '], [-3.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
            & -3.0_wp], 0.0_wp)
      end if
   end subroutine make_corner

   subroutine the_outward_side_is_on_the_left()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot

      call test('travelling along +x the outward normal is +y')
      call make(tool, ['START', 'LINE '], [-1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], 0.0_wp)
      call tool%project([0.2_wp, 0.7_wp], foot)
      call close_to('gap', foot%gap, 0.7_wp, tight)
      call close_to('normal', foot%normal(:2), [0.0_wp, 1.0_wp], tight)
      call tool%project([0.2_wp, -0.7_wp], foot)
      call close_to('gap behind', foot%gap, -0.7_wp, tight)
      call make(tool, ['START', 'CIRCL'], [6.0_wp, 10.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 10.0_wp], &
         & 0.0_wp)
      call tool%project([3.0_wp, 6.0_wp], foot)
      call close_to('below a punch that is travelled inwards', foot%gap, -1.0_wp, tight)
      call tool%project([3.6_wp, 5.2_wp], foot)
      call close_to('on it', foot%gap, 0.0_wp, tight)
   end subroutine the_outward_side_is_on_the_left

   subroutine make_wild(tool, scale)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: scale

      call make(tool, ['START', 'LINE ', 'CIRCL', 'PARAB', 'LINE ', 'PARAB', 'CIRCL'], &
         & scale*[5.0_wp, 4.0_wp, 3.0_wp, 4.0_wp, 2.0_wp, 3.0_wp, 3.0_wp, 3.0_wp, 1.5_wp, 1.0_wp, &
         & 1.0_wp, 2.5_wp, &
         & -1.0_wp, 2.4_wp, -1.2_wp, 1.0_wp, -3.0_wp, 0.8_wp, -4.0_wp, 1.8_wp, -3.0_wp, 1.8_wp], &
         & 0.0_wp)
   end subroutine make_wild

   subroutine distance_equals_that_of_a_fine_sampling()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      type(profile_type) :: profile
      type(segment_card_type) :: cards(7)
      type(error_type), allocatable :: error
      integer, parameter :: n = 4000
      real(wp) :: x(2), q(2), least
      integer :: i, j, k

      call test('distance to a profile of lines, arcs and parabolas equals a sampling')
      call make_wild(tool, 1.0_wp)
      cards%word = ['START   ', 'LINE    ', 'CIRCL   ', 'PARAB   ', 'LINE    ', 'PARAB   ', &
         & 'CIRCL   ']
      cards(1)%value(:2) = [5.0_wp, 4.0_wp]
      cards(2)%value(:2) = [3.0_wp, 4.0_wp]
      cards(3)%value = [2.0_wp, 3.0_wp, 3.0_wp, 3.0_wp]
      cards(4)%value = [1.5_wp, 1.0_wp, 1.0_wp, 2.5_wp]
      cards(5)%value(:2) = [-1.0_wp, 2.4_wp]
      cards(6)%value = [-1.2_wp, 1.0_wp, -3.0_wp, 0.8_wp]
      cards(7)%value = [-4.0_wp, 1.8_wp, -3.0_wp, 1.8_wp]
      call new_profile(profile, cards, 0.0_wp, error)
      do i = 1, 300
         call random_number(x)
         x = [12.0_wp, 8.0_wp]*x - [6.0_wp, 2.0_wp]
         call tool%project(x, foot)
         least = huge(1.0_wp)
         do k = 1, size(profile%segment)
            do j = 0, n
               q = along(profile%segment(k), real(j, wp)/real(n, wp))
               least = min(least, norm2(x - q))
            end do
         end do
         ! The sampled distance is never below the true one, and above it by little.
         call is_true('not further than the sampling', norm2(x - foot%point(:2)) <= least + tight)
         call is_true('not nearer than the sampling', norm2(x - foot%point(:2)) >= least - &
            & 2.0e-3_wp)
         if (.not. foot%overhang > 0.0_wp) call close_to('|gap|', abs(foot%gap), norm2(x - &
            & foot%point(:2)), tight)
      end do
   end subroutine distance_equals_that_of_a_fine_sampling

   function along(segment, s) result(p)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: s
      real(wp) :: p(2)

      p = segment%a + s*(segment%b - segment%a)
      if (segment%kind == segment_kind%parabola) p = parabola_point(segment, 2.0_wp*s - 1.0_wp)
      if (segment%kind == segment_kind%arc) p = segment%c + segment%radius*(p - &
         & segment%c)/norm2(p - segment%c)
   end function along

   subroutine answers_scale_with_the_unit_of_length()
      class(tool_type), allocatable :: tool, scaled
      type(foot_type) :: a, b
      real(wp) :: x(2)
      real(wp), parameter :: scale(2) = [2.0_wp**(-30), 2.0_wp**30]
      integer :: i, k

      call test('the unit of length changes nothing')
      call make_wild(tool, 1.0_wp)
      do k = 1, 2
         call make_wild(scaled, scale(k))
         do i = 1, 100
            call random_number(x)
            x = [12.0_wp, 8.0_wp]*x - [6.0_wp, 2.0_wp]
            call tool%project(x, a)
            call scaled%project(scale(k)*x, b)
            call close_to('gap', b%gap/scale(k), a%gap, 1.0e-13_wp)
            call close_to('normal', b%normal, a%normal, 1.0e-11_wp)
            call is_true('segment', a%segment == b%segment)
         end do
      end do
   end subroutine answers_scale_with_the_unit_of_length

   subroutine a_convex_corner_owns_its_wedge()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: angle, previous, step
      integer :: i

      call test('round a convex corner the gap is the distance and the normal turns with the point')
      call make_corner(tool, .false.)
      step = acos(-1.0_wp)/400.0_wp
      previous = 0.5_wp
      do i = 0, 200
         angle = step*real(i, wp)
         call tool%project(0.5_wp*[sin(angle), cos(angle)], foot)
         call close_to('gap', foot%gap, 0.5_wp, tight)
         call close_to('normal', foot%normal(:2), [sin(angle), cos(angle)], tight)
      end do
      ! From above the plate, round the corner and into the metal: no jump.
      do i = -100, 300
         angle = step*real(i, wp)
         call tool%project(0.5_wp*[sin(angle), cos(angle)], foot)
         if (i > -100) call is_true('continuous', abs(foot%gap - previous) <= 0.5_wp*step + tight)
         previous = foot%gap
      end do
   end subroutine a_convex_corner_owns_its_wedge

   subroutine a_point_on_a_convex_corner_has_a_normal_in_the_cone()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: shift(3) = [-1.0e-12_wp, 0.0_wp, 1.0e-12_wp]
      integer :: i, j

      call test('on a convex corner +-1e-12 there is one facet and its normal is in the cone')
      call make_corner(tool, .false.)
      do i = 1, 3
         do j = 1, 3
            call tool%project([shift(i), shift(j)], foot)
            call is_true('found', foot%found .and. .not. foot%overhang > 0.0_wp)
            call is_true('in the cone', foot%normal(1) >= -tight .and. foot%normal(2) >= -tight)
            call close_to('unit', norm2(foot%normal), 1.0_wp, tight)
            call is_true('gap', abs(foot%gap) < 2.0e-12_wp)
         end do
      end do
   end subroutine a_point_on_a_convex_corner_has_a_normal_in_the_cone

   subroutine a_concave_corner_gives_two_constraints()
      class(tool_type), allocatable :: tool
      type(foot_type) :: feet(2), foot
      real(wp), parameter :: shift(5) = [-0.1_wp, -1.0e-12_wp, 0.0_wp, 1.0e-12_wp, 0.1_wp]
      integer :: i, j, n, a, b

      call test('in a concave corner both surfaces push, each along its own normal')
      call make_corner(tool, .true.)
      do i = 1, 5
         do j = 1, 5
            call tool%project_all([shift(i), shift(j)], 0.2_wp, feet, n)
            call is_true('two', n == 2)
            a = merge(1, 2, feet(1)%segment == 1)
            b = 3 - a
            call close_to('wall', feet(a)%gap, shift(i), 1.0e-15_wp)
            call close_to('floor', feet(b)%gap, shift(j), 1.0e-15_wp)
            call close_to('wall normal', feet(a)%normal(:2), [1.0_wp, 0.0_wp], tight)
            call close_to('floor normal', feet(b)%normal(:2), [0.0_wp, 1.0_wp], tight)
            call is_true('ordered', feet(1)%gap <= feet(2)%gap)
         end do
      end do
      call tool%project_all([1.0_wp, 0.1_wp], 0.2_wp, feet, n)
      call is_true('far from the corner one is enough', n == 1)
      call tool%project([-0.3_wp, -0.4_wp], foot)
      call close_to('alone, the corner is the closest point', foot%gap, -0.5_wp, tight)
      call close_to('and pushes out through it', foot%normal(:2), [0.6_wp, 0.8_wp], tight)
   end subroutine a_concave_corner_gives_two_constraints

   subroutine two_reactions_in_a_concave_corner_are_exact()
      class(tool_type), allocatable :: tool
      type(foot_type) :: feet(2)
      integer :: n
      real(wp) :: det, p(2)
      real(wp), parameter :: force(2) = [-3.0_wp, -4.0_wp]

      call test('the force (-3, -4) into the corner is carried as 3 and 4')
      call make_corner(tool, .true.)
      call tool%project_all([0.0_wp, 0.0_wp], 0.1_wp, feet, n)
      det = feet(1)%normal(1)*feet(2)%normal(2) - feet(1)%normal(2)*feet(2)%normal(1)
      p(1) = -(force(1)*feet(2)%normal(2) - force(2)*feet(2)%normal(1))/det
      p(2) = -(feet(1)%normal(1)*force(2) - feet(1)%normal(2)*force(1))/det
      call close_to('reactions', [minval(p), maxval(p)], [3.0_wp, 4.0_wp], tight)
   end subroutine two_reactions_in_a_concave_corner_are_exact

   subroutine an_open_end_says_how_far_beyond_it_is()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot

      call test('beyond an open end the tangent goes on and the overhang is told')
      call make(tool, ['START', 'LINE '], [1.0_wp, 0.0_wp, 3.0_wp, 0.0_wp], 0.0_wp)
      call tool%project([3.25_wp, 0.5_wp], foot)
      call close_to('overhang', foot%overhang, 0.25_wp, tight)
      call close_to('gap', foot%gap, 0.5_wp, tight)
      call tool%project([0.5_wp, -0.5_wp], foot)
      call close_to('overhang', foot%overhang, 0.5_wp, tight)
      call close_to('gap', foot%gap, -0.5_wp, tight)
      call tool%project([3.0_wp + 1.0e-15_wp, -0.5_wp], foot)
      call close_to('rounding is no overhang', foot%overhang, 0.0_wp, 0.0_wp)
   end subroutine an_open_end_says_how_far_beyond_it_is

   subroutine an_end_on_the_axis_is_no_end()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot

      call test('the tip of a cone on the axis is a corner')
      call make(tool, ['START', 'LINE '], [1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp], 0.0_wp)
      call tool%project([0.0_wp, -0.5_wp], foot)
      call close_to('gap', foot%gap, 0.5_wp, tight)
      call close_to('normal', foot%normal(:2), [0.0_wp, -1.0_wp], tight)
      call close_to('overhang', foot%overhang, 0.0_wp, 0.0_wp)
      call tool%project([-0.1_wp, -0.5_wp], foot)
      call is_true('seen from the other side it is an end', foot%overhang > 0.0_wp)
   end subroutine an_end_on_the_axis_is_no_end

   subroutine fillets_are_tangent_arcs()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: root2 = sqrt(2.0_wp)

      call test('a fillet of radius r leaves (sqrt 2 - 1) r at a right angle')
      call make(tool, ['START', 'LINE ', 'LINE '], [-3.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
         & -3.0_wp], 0.5_wp)
      call tool%project([0.0_wp, 0.0_wp], foot)
      call close_to('convex', foot%gap, 0.5_wp*(root2 - 1.0_wp), tight)
      call close_to('curvature', foot%hessian(1, 1) + foot%hessian(2, 2), 1.0_wp/(0.5_wp*root2), &
         & tight)
      call make(tool, ['START', 'LINE ', 'LINE '], [0.0_wp, 3.0_wp, 0.0_wp, 0.0_wp, 3.0_wp, &
         & 0.0_wp], 0.5_wp)
      call tool%project([0.0_wp, 0.0_wp], foot)
      call close_to('concave', foot%gap, -0.5_wp*(root2 - 1.0_wp), tight)

      call test('a fillet between a line and an arc is tangent to both')
      ! Floor y = 0 to the foot of a bump of radius 2 about (0, 0): fillet centre at height 1, 3
      ! from the centre.
      call make(tool, ['START', 'LINE ', 'CIRCL', 'CIRCL'], [-5.0_wp, 0.0_wp, -2.0_wp, 0.0_wp, &
         & 0.0_wp, 2.0_wp, &
         & 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], 1.0_wp)
      call tool%project([-sqrt(8.0_wp), 1.0_wp], foot)
      call close_to('from its centre', foot%gap, 1.0_wp, tight)
      call tool%project([-sqrt(8.0_wp), 0.5_wp], foot)
      call close_to('above its lowest point', foot%gap, 0.5_wp, tight)
      call tool%project([-sqrt(8.0_wp)*2.0_wp/3.0_wp, 2.0_wp/3.0_wp], foot)
      call close_to('where it meets the bump', foot%gap, 0.0_wp, tight)

      call test('a fillet between two arcs is tangent to both')
      ! Two bumps of radius 2 about (-2, 0) and (2, 0): fillet centre at (0, sqrt(9 - 4)).
      call make(tool, ['START', 'CIRCL', 'CIRCL'], [-2.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, -2.0_wp, &
         & 0.0_wp, &
         & 2.0_wp, 2.0_wp, 2.0_wp, 0.0_wp], 1.0_wp)
      call tool%project([0.0_wp, 0.5_wp], foot)
      call close_to('below its centre', foot%gap, 0.5_wp - (sqrt(5.0_wp) - 1.0_wp), tight)
   end subroutine fillets_are_tangent_arcs

   subroutine a_closed_square_has_no_ends()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp) :: x(2), outside(2), expected
      integer :: i

      call test('a closed square: the exact signed distance everywhere')
      ! Clockwise, so that the outside is on the left.
      call make(tool, ['START', 'LINE ', 'LINE ', 'LINE ', 'LINE '], &
         & [0.5_wp, 0.5_wp, 0.5_wp, -0.5_wp, -0.5_wp, -0.5_wp, -0.5_wp, 0.5_wp, 0.5_wp, 0.5_wp], &
         & 0.0_wp)
      do i = 1, 500
         call random_number(x)
         x = 3.0_wp*x - 1.5_wp
         outside = abs(x) - 0.5_wp
         expected = norm2(max(outside, 0.0_wp)) + min(maxval(outside), 0.0_wp)
         call tool%project(x, foot)
         call close_to('gap', foot%gap, expected, tight)
         call close_to('overhang', foot%overhang, 0.0_wp, 0.0_wp)
      end do
   end subroutine a_closed_square_has_no_ends
end program test_profile
