!> Fillets of triangles as grids and CAD programs bring them: curved, whatever single edges turn by.
program test_tool_fillets
   use lopin_kinds, only : wp
   use lopin_tool, only : tool_type, foot_type
   use check, only : test, close_to, is_true, finish
   use facet_scenes, only : strips, new_open
   implicit none

   call random_init(.true., .false.)
   call a_fillet_of_twisted_squares_has_no_edges()
   call nor_has_one_of_chance_triangles()
   call a_ridge_beside_a_fillet_stays()
   call a_fillet_of_two_facets_is_round()
   call finish()

contains

   !> A concave fillet as a grid brings it: the halves of its squares are not of one plane.
   subroutine a_fillet_of_twisted_squares_has_no_edges()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: row = acos(-1.0_wp)/11.0_wp
      real(wp) :: corner(3, 3, 24), p(3, 3, 7), x(3), before(3), worst
      integer :: i, j

      call test('a fillet of twisted squares has no edges')
      do i = 1, 7
         do j = 1, 3
            p(:, j, i) = [2.0_wp - j, 3.0_wp*sin((i - 4)*row), 3.0_wp - 3.0_wp*cos((i - 4)*row) &
               & + 0.01_wp*i*(j - 2)]
         end do
      end do
      call strips(p, corner)
      call new_open(tool, corner)
      worst = 0.0_wp
      do i = -1000, 1000
         x = [0.1_wp, 3.0_wp*sin(0.001_wp*i*row), 3.01_wp - 3.0_wp*cos(0.001_wp*i*row)]
         call tool%project(x, foot)
         if (i > -1000) worst = max(worst, norm2(foot%normal - before))
         before = foot%normal
      end do
      call is_true('no jump of the normal', worst < 0.01_wp)
      call is_true('no creases', .not. tool%has_creases())
   end subroutine a_fillet_of_twisted_squares_has_no_edges

   !> As exported dies have them: slivers turn by up to 30 degrees either way.
   subroutine nor_has_one_of_chance_triangles()
      class(tool_type), allocatable :: tool
      real(wp), parameter :: step = 0.4_wp
      real(wp) :: corner(3, 3, 2*15*23), p(3, 16, 24), shake(2)
      integer :: trial, i, j

      call test('a fillet of chance triangles has no edges')
      do trial = 1, 20
         do i = 1, 24
            do j = 1, 16
               call random_number(shake)
               shake = 0.6_wp*(shake - 0.5_wp)
               if (any(i == [1, 24])) shake(1) = 0.0_wp
               if (any(j == [1, 16])) shake(2) = 0.0_wp
               p(:, j, i) = on_fillet(step*(i - 12 + shake(1)))
               p(1, j, i) = -step*(j + shake(2))
            end do
         end do
         call strips(p, corner)
         call new_open(tool, corner)
         call is_true('no creases', .not. tool%has_creases())
         call is_true('nor between its ends', .not. tool%is_creased(1, size(corner, 3)))
      end do
   end subroutine nor_has_one_of_chance_triangles

   !> A place on the way from a plane over an arc of 60 degrees into another plane.
   pure function on_fillet(way) result(x)
      real(wp), intent(in) :: way              !! from the middle of the arc [length]
      real(wp), parameter :: radius = 3.0_wp, half = acos(-1.0_wp)/6.0_wp
      real(wp) :: x(3), angle

      angle = max(-half, min(half, way/radius))
      x = [0.0_wp, sin(angle), 1.0_wp - cos(angle)]*radius
      x = x + (way - radius*angle)*[0.0_wp, cos(angle), sin(angle)]
   end function on_fillet

   !> A ridge of 15 degrees 3 before a fillet of strips of 0.3, which are curved.
   subroutine a_ridge_beside_a_fillet_stays()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: slope = acos(-1.0_wp)/12.0_wp
      real(wp) :: corner(3, 3, 4*14), p(3, 3, 15), lean
      integer :: i, j, side

      call test('a ridge beside a fillet stays')
      do i = 1, 15
         do j = 1, 3
            p(:, j, i) = on_fillet(0.3_wp*(i - 9))
            if (i == 2) p(:, j, i) = on_fillet(-4.5_wp)
            if (i == 1) p(:, j, i) = on_fillet(-4.5_wp) - 3.0_wp*[0.0_wp, &
               & cos(acos(-1.0_wp)/6.0_wp - slope), -sin(acos(-1.0_wp)/6.0_wp - slope)]
            p(1, j, i) = 1.5_wp*(2 - j)
         end do
      end do
      call strips(p, corner)
      call new_open(tool, corner)
      call is_true('one crease', tool%has_creases())
      do side = -1, 1, 2
         lean = acos(-1.0_wp)/6.0_wp - merge(slope, 0.0_wp, side < 0)
         call tool%project(p(:, 2, 2) + [0.1_wp, 0.3_wp*side*cos(lean), -0.3_wp*side*sin(lean)] &
            & + 0.1_wp*[0.0_wp, sin(lean), cos(lean)], foot)
         call close_to('its normals', foot%normal(2), sin(lean), 1.0e-4_wp)
      end do
   end subroutine a_ridge_beside_a_fillet_stays

   !> Around a ring of facets that stand out as much: two chords of 35 degrees between two cones.
   subroutine a_fillet_of_two_facets_is_round()
      class(tool_type), allocatable :: tool
      type(foot_type) :: foot
      real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp, ring = 18.0_wp, radius = 2.0_wp
      real(wp) :: corner(3, 3, 2*4*9), p(3, 5, 10), around, angle, along(3), worst
      integer :: i, j

      call test('a fillet of two facets is round')
      do i = 1, 10
         do j = 1, 5
            angle = max(-35.0_wp, min(35.0_wp, 35.0_wp*(j - 3)))*degree
            along = [ring + radius*sin(angle), 0.0_wp, radius*cos(angle)]
            if (any(j == [1, 5])) along = along + 4.0_wp*sign(1.0_wp, angle)*[cos(angle), 0.0_wp, &
               & -sin(angle)]
            around = 12.0_wp*(i - 5.5_wp)*degree
            p(:, j, i) = [along(1)*cos(around), along(1)*sin(around), along(3)]
         end do
      end do
      call strips(p, corner)
      call new_open(tool, corner)
      call is_true('no creases', .not. tool%has_creases())
      worst = 0.0_wp
      do i = -30, 30
         do j = -30, 30
            angle = i*degree
            around = 0.5_wp*j*degree
            along = [ring + 2.1_wp*sin(angle), 0.0_wp, 2.1_wp*cos(angle)]
            call tool%project([along(1)*cos(around), along(1)*sin(around), along(3)], foot)
            worst = max(worst, abs(abs(foot%gap) - 0.1_wp))
         end do
      end do
      call is_true('gaps: a fifth of the chords', worst < 0.2_wp*(radius*(1.0_wp &
         & - cos(17.5_wp*degree)) + ring*(1.0_wp - cos(6.0_wp*degree))))
   end subroutine a_fillet_of_two_facets_is_round
end program test_tool_fillets
