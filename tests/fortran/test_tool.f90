!> Rigid tools: gap, normal and curvature against closed forms, and rigid motion.
program test_tool
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, nowhere
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion, rigid_motion, rotation_matrix
   use lopin_tool, only : tool_type, foot_type, project_moved
   use lopin_profile, only : segment_card_type
   use lopin_tool_factory, only : new_tool_from_segments, new_tool_plane, new_tool_sphere, &
      & new_tool_cylinder
   use check, only : test, close_to, is_true, finish
   implicit none

   type :: holder
      class(tool_type), allocatable :: shape
   end type holder

   real(wp), parameter :: tight = 1.0e-12_wp
   type(holder) :: tools(12)

   call random_init(.true., .false.)
   call make_all()
   call gaps_equal_closed_forms()
   call normal_and_hessian_are_derivatives_of_the_gap()
   call foot_gap_and_normal_agree()
   call rotation_is_exact()
   call moved_tool_sees_what_the_still_one_saw()
   call a_finite_cylinder_says_how_far_beyond_its_end()
   call drawings_lie_on_the_tool()
   call wrong_data_are_refused()
   call finish()

contains

   subroutine make_all()
      type(error_type), allocatable :: error
      integer :: i
      real(wp) :: none(3, 0), frame(3, 3), around(3, 4)

      call new_tool_plane(tools(1)%shape, [1.0_wp, 2.0_wp], [3.0_wp, 4.0_wp], error)
      call new_tool_plane(tools(2)%shape, [1.0_wp, 2.0_wp, 3.0_wp], [1.0_wp, 2.0_wp, 2.0_wp], error)
      call new_tool_sphere(tools(3)%shape, [0.5_wp, -0.5_wp], 2.0_wp, .false., error)
      call new_tool_sphere(tools(4)%shape, [0.5_wp, -0.5_wp, 1.0_wp], 2.0_wp, .true., error)
      call new_tool_cylinder(tools(5)%shape, [0.1_wp, 0.2_wp, 0.3_wp], [0.0_wp, 3.0_wp, 4.0_wp], &
         & 1.5_wp, &
         & 0.0_wp, .false., error)
      call new_tool_cylinder(tools(6)%shape, [0.1_wp, 0.2_wp, 0.3_wp], [1.0_wp, 0.0_wp, 0.0_wp], &
         & 8.0_wp, &
         & 5.0_wp, .true., error)
      call new_tool_from_segments(tools(7)%shape, 'SEGMENTS', none, die(), 0.3_wp, nowhere, error)
      call new_tool_from_segments(tools(8)%shape, 'REVOLUTION', none, die(), 0.3_wp, nowhere, error)
      frame = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 0.0_wp], &
         & [3, 3])
      call new_tool_from_segments(tools(9)%shape, 'CYLINDER', frame, punch(), 0.0_wp, nowhere, &
         & error)
      frame(:, 2) = [2.0_wp, 1.0_wp, -1.0_wp]
      call new_tool_from_segments(tools(10)%shape, 'REVOLUTION', frame(:, :2), punch(), 0.0_wp, &
         & nowhere, error)
      around(:, :2) = frame(:, :2)
      around(:, 3) = frame(:, 1) + [1.0_wp, 0.0_wp, 1.0_wp]
      around(:, 4) = frame(:, 1) + [-0.5_wp, 1.0_wp, 0.5_wp]
      call new_tool_from_segments(tools(11)%shape, 'REVOLUTION', around, punch(), 0.0_wp, nowhere, &
         & error)
      around = reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, &
         & 0.0_wp, 1.0_wp, 0.0_wp], [3, 4])
      call new_tool_from_segments(tools(12)%shape, 'REVOLUTION', around, post(), 0.0_wp, nowhere, &
         & error)
      call test('every tool can be made')
      do i = 1, size(tools)
         call is_true('allocated', allocated(tools(i)%shape))
         call is_true('described', len(tools(i)%shape%describe()) > 4)
      end do
   end subroutine make_all

   !> Down, round, along a parabola, in to the axis.
   function punch() result(cards)
      type(segment_card_type) :: cards(5)
      cards(1) = segment_card_type('START', [3.0_wp, 6.0_wp, 0.0_wp, 0.0_wp])
      cards(2) = segment_card_type('LINE', [3.0_wp, 2.0_wp, 0.0_wp, 0.0_wp])
      cards(3) = segment_card_type('CIRCL', [2.0_wp, 1.0_wp, 2.0_wp, 2.0_wp])
      cards(4) = segment_card_type('PARAB', [1.5_wp, 0.8_wp, 1.0_wp, 0.9_wp])
      cards(5) = segment_card_type('LINE', [0.0_wp, 0.9_wp, 0.0_wp, 0.0_wp])
   end function punch

   !> A straight wall.
   function post() result(cards)
      type(segment_card_type) :: cards(2)
      cards(1) = segment_card_type('START', [0.5_wp, 30.0_wp, 0.0_wp, 0.0_wp])
      cards(2) = segment_card_type('LINE', [0.5_wp, -30.0_wp, 0.0_wp, 0.0_wp])
   end function post

   !> Two sharp shoulders, one convex and one concave, which a fillet rounds; then in to the axis.
   function die() result(cards)
      type(segment_card_type) :: cards(5)
      cards(1) = segment_card_type('START', [5.0_wp, 4.0_wp, 0.0_wp, 0.0_wp])
      cards(2) = segment_card_type('LINE', [3.0_wp, 4.0_wp, 0.0_wp, 0.0_wp])
      cards(3) = segment_card_type('LINE', [3.0_wp, 2.0_wp, 0.0_wp, 0.0_wp])
      cards(4) = segment_card_type('CIRCL', [2.0_wp, 1.0_wp, 3.0_wp, 1.0_wp])
      cards(5) = segment_card_type('LINE', [0.0_wp, 0.9_wp, 0.0_wp, 0.0_wp])
   end function die

   subroutine gaps_equal_closed_forms()
      type(foot_type) :: foot
      real(wp) :: x(3), r
      integer :: i

      call test('gap of plane, sphere and cylinder equals its closed form')
      do i = 1, 50
         call random_number(x)
         x = 20.0_wp*x - 10.0_wp
         call tools(1)%shape%project(x(:2), foot)
         call close_to('line', foot%gap, (3.0_wp*(x(1) - 1.0_wp) + 4.0_wp*(x(2) - 2.0_wp))/5.0_wp, &
            & tight)
         call tools(2)%shape%project(x, foot)
         call close_to('plane', foot%gap, dot_product(x - [1.0_wp, 2.0_wp, 3.0_wp], [1.0_wp, &
            & 2.0_wp, 2.0_wp])/3.0_wp, tight)
         call tools(3)%shape%project(x(:2), foot)
         call close_to('circle', foot%gap, hypot(x(1) - 0.5_wp, x(2) + 0.5_wp) - 2.0_wp, tight)
         call tools(4)%shape%project(x, foot)
         call close_to('cavity', foot%gap, 2.0_wp - norm2(x - [0.5_wp, -0.5_wp, 1.0_wp]), tight)
         call tools(5)%shape%project(x, foot)
         r = hypot(x(1) - 0.1_wp, 0.8_wp*(x(2) - 0.2_wp) - 0.6_wp*(x(3) - 0.3_wp))
         call close_to('bar', foot%gap, r - 1.5_wp, tight)
         call tools(6)%shape%project(x, foot)
         call close_to('bore', foot%gap, 8.0_wp - hypot(x(2) - 0.2_wp, x(3) - 0.3_wp), tight)
         call tools(12)%shape%project(x, foot)
         call close_to('post around a rectangle', foot%gap, norm2(max(abs(x(:2)) - [2.0_wp, &
            & 1.0_wp], 0.0_wp)) - 0.5_wp, tight)
      end do
   end subroutine gaps_equal_closed_forms

   !> Where the foot changes its segment the gap is not smooth: those points are left out.
   subroutine normal_and_hessian_are_derivatives_of_the_gap()
      type(foot_type) :: foot, plus, minus
      real(wp), parameter :: h = 1.0e-5_wp
      real(wp) :: x(3)
      integer :: i, j, k, n
      logical :: smooth

      call test('the normal is the gradient of the gap, the hessian the gradient of the normal')
      do k = 1, size(tools)
         n = tools(k)%shape%ndim
         do i = 1, 40
            call random_number(x)
            x = 8.0_wp*x - 3.0_wp
            call tools(k)%shape%project(x(:n), foot)
            if (foot%overhang > 0.0_wp) cycle
            ! In its rectangle a tool is as flat as its profile there: a wall has no gradient.
            if (k == 12 .and. all(abs(x(:2)) < [2.0_wp, 1.0_wp])) cycle
            do j = 1, n
               x(j) = x(j) + h
               call tools(k)%shape%project(x(:n), plus)
               x(j) = x(j) - 2.0_wp*h
               call tools(k)%shape%project(x(:n), minus)
               x(j) = x(j) + h
               smooth = plus%segment == minus%segment .and. (plus%corner .eqv. minus%corner) &
                  & .and. plus%overhang + minus%overhang <= 0.0_wp
               if (.not. smooth .or. maxval(abs(foot%hessian)) > 20.0_wp) cycle
               call close_to(tools(k)%shape%name//' gradient', (plus%gap - minus%gap)/(2.0_wp*h), &
                  & foot%normal(j), 1.0e-7_wp)
               call close_to(tools(k)%shape%name//' hessian', (plus%normal(:n) - &
                  & minus%normal(:n))/(2.0_wp*h), &
                  & foot%hessian(:n, j), 1.0e-5_wp)
            end do
         end do
      end do
   end subroutine normal_and_hessian_are_derivatives_of_the_gap

   subroutine foot_gap_and_normal_agree()
      type(foot_type) :: foot
      real(wp) :: x(3)
      integer :: i, k, n

      call test('x = foot + gap n')
      do k = 1, size(tools)
         n = tools(k)%shape%ndim
         do i = 1, 20
            call random_number(x)
            x = 8.0_wp*x - 3.0_wp
            call tools(k)%shape%project(x(:n), foot)
            if (foot%overhang > 0.0_wp) cycle
            call close_to(tools(k)%shape%name, foot%point(:n) + foot%gap*foot%normal(:n), x(:n), &
               & tight)
            call close_to(tools(k)%shape%name//' unit', norm2(foot%normal), 1.0_wp, tight)
         end do
      end do
   end subroutine foot_gap_and_normal_agree

   subroutine rotation_is_exact()
      real(wp) :: r(3, 3), v(3)
      real(wp), parameter :: quarter = acos(0.0_wp)

      call test('rotations are exact, large and small')
      v = rigid_motion([1.0_wp, 1.0_wp, 1.0_wp], [5.0_wp, 0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp, &
         & quarter], &
         & [2.0_wp, 1.0_wp, 1.0_wp])
      call close_to('quarter turn about z', v, [6.0_wp, 2.0_wp, 1.0_wp], tight)
      v(:2) = rigid_motion([0.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], [-quarter], [1.0_wp, 0.0_wp])
      call close_to('quarter turn in the plane', v(:2), [0.0_wp, 0.0_wp], tight)
      r = rotation_matrix([1.0e-9_wp, -2.0e-9_wp, 3.0e-9_wp])
      call close_to('small', r(3, 2), 1.0e-9_wp - 3.0e-18_wp, 1.0e-24_wp)
      r = rotation_matrix([1.0_wp, -2.0_wp, 3.0_wp])
      call close_to('orthogonal', matmul(r, transpose(r)), rotation_matrix([0.0_wp, 0.0_wp, &
         & 0.0_wp]), tight)
      call close_to('axis stays', matmul(r, [1.0_wp, -2.0_wp, 3.0_wp]), [1.0_wp, -2.0_wp, 3.0_wp], &
         & tight)
   end subroutine rotation_is_exact

   subroutine moved_tool_sees_what_the_still_one_saw()
      type(rigid_motion_type) :: motion
      type(foot_type) :: still, moved
      real(wp) :: x(3), rotation(3)
      real(wp), parameter :: shift(3) = [1.0_wp, -2.0_wp, 0.5_wp]
      integer :: k, n

      call test('a moved tool and a moved point have the same gap')
      rotation = [0.7_wp, -1.1_wp, 2.0_wp]
      x = [0.3_wp, 1.4_wp, 0.6_wp]
      do k = 1, size(tools)
         n = tools(k)%shape%ndim
         call new_rigid_motion(motion, x(:n) + 1.0_wp, shift(:n), rotation(:merge(1, 3, n == 2)))
         call tools(k)%shape%project(x(:n), still)
         call project_moved(tools(k)%shape, motion, motion%to_global(x(:n)), moved)
         call close_to('gap', moved%gap, still%gap, tight)
         call close_to('foot', motion%to_tool(moved%point(:n)), still%point(:n), tight)
         call close_to('normal', moved%normal(:n), motion%turn(still%normal(:n)), tight)
         call close_to('hessian', matmul(moved%hessian, moved%normal), [0.0_wp, 0.0_wp, 0.0_wp], &
            & 1.0e-11_wp)
      end do
   end subroutine moved_tool_sees_what_the_still_one_saw

   subroutine a_finite_cylinder_says_how_far_beyond_its_end()
      type(foot_type) :: foot

      call test('overhang beyond the ends of a finite cylinder')
      call tools(6)%shape%project([6.1_wp, 3.2_wp, 0.3_wp], foot)
      call close_to('overhang', foot%overhang, 1.0_wp, tight)
      call tools(6)%shape%project([-1.9_wp, 3.2_wp, 0.3_wp], foot)
      call close_to('overhang', foot%overhang, 2.0_wp, tight)
      call tools(6)%shape%project([2.0_wp, 3.2_wp, 0.3_wp], foot)
      call close_to('overhang', foot%overhang, 0.0_wp, tight)
      call close_to('gap', foot%gap, 5.0_wp, tight)
   end subroutine a_finite_cylinder_says_how_far_beyond_its_end

   subroutine drawings_lie_on_the_tool()
      real(wp), allocatable :: points(:, :)
      integer, allocatable :: cells(:, :)
      real(wp) :: box(3, 2)
      type(foot_type) :: foot
      integer :: k, i, n

      call test('the points of a drawing lie on the tool')
      box(:, 1) = -3.0_wp
      box(:, 2) = 4.0_wp
      do k = 1, size(tools)
         n = tools(k)%shape%ndim
         call tools(k)%shape%tessellate(box(:n, :), points, cells)
         do i = 1, size(points, 2)
            call tools(k)%shape%project(points(:, i), foot)
            call is_true(tools(k)%shape%name//' drawn', abs(foot%gap) < 1.0e-12_wp*10.0_wp)
         end do
         call is_true(tools(k)%shape%name//' cells', size(cells, 1) == merge(2, 4, n == 2) &
            & .and. minval(cells(1, :)) >= 1 .and. maxval(cells) <= size(points, 2))
      end do
   end subroutine drawings_lie_on_the_tool

   subroutine wrong_data_are_refused()
      class(tool_type), allocatable :: tool
      type(error_type), allocatable :: error
      type(segment_card_type) :: cards(3)
      real(wp) :: none(3, 0)

      call test('data that make no tool are refused')
      call new_tool_plane(tool, [0.0_wp, 0.0_wp], [0.0_wp, 0.0_wp], error)
      call is_true('plane without normal', allocated(error))
      call new_tool_sphere(tool, [0.0_wp, 0.0_wp], -1.0_wp, .false., error)
      call is_true('negative radius', allocated(error))
      call new_tool_from_segments(tool, 'REVOLUTION', reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
         & 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp], [3, 4]), post(), &
         & 0.0_wp, nowhere, error)
      call is_true('a rectangle that is askew', allocated(error))
      cards(1) = segment_card_type('START', [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
      cards(2) = segment_card_type('LINE', [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
      cards(3) = segment_card_type('LINE', [1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp])
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards(2:), 0.0_wp, nowhere, error)
      call is_true('no START', allocated(error))
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards, 2.0_wp, nowhere, error)
      call is_true('fillet too large', allocated(error))
      cards(3) = segment_card_type('CIRCL', [1.0_wp, 1.0_wp, 5.0_wp, 1.0_wp])
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards, 0.0_wp, nowhere, error)
      call is_true('centre not in the middle', allocated(error))
      cards(3) = segment_card_type('CIRCL', [1.0_wp, 2.0_wp, 1.0_wp, 1.0_wp])
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards, 0.0_wp, nowhere, error)
      call is_true('half circle', allocated(error))
      cards(3) = segment_card_type('LINE', [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards, 0.0_wp, nowhere, error)
      call is_true('no length', allocated(error))
      cards(3) = segment_card_type('SPLINE', [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])
      call new_tool_from_segments(tool, 'SEGMENTS', none, cards, 0.0_wp, nowhere, error)
      call is_true('no such word', allocated(error))
   end subroutine wrong_data_are_refused
end program test_tool
