!> `*ORIENTATION`: axes of the material of a section.
module lopin_build_orientations
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_error, only : location_type, log_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, complain, &
      & line_place
   use lopin_build_scene, only : scene_type, name_type, get_word, need_word, no_such
   implicit none
   private
   public :: read_axes

contains

   !> The axes of that name, as rows.
   subroutine read_axes(deck, scene, name, at, axes, log)
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: name
      type(location_type), intent(in) :: at
      real(wp), intent(inout) :: axes(3, 3)
      type(log_type), intent(inout) :: log
      type(name_type), allocatable :: names(:)
      character(len=:), allocatable :: other
      type(location_type) :: there
      integer :: k
      logical :: found

      allocate (names(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'ORIENTATION') cycle
            call need_word(block, 'NAME', other, there, found, log)
            if (.not. found) cycle
            names = [names, name_type(other)]
            if (other /= name) cycle
            call read_lines(block, axes, log)
            if (scene%card(k)%scope > 0) axes = matmul(axes, &
               & transpose(scene%instance(scene%card(k)%scope)%rotation))
            return
         end associate
      end do
      call no_such(log, 'orientation', name, names, at)
   end subroutine read_axes

   !> `a, b` and perhaps an origin c; then perhaps an axis and an angle by which the axes are turned
   !> about it.
   subroutine read_lines(block, axes, log)
      type(block_type), intent(in) :: block
      real(wp), intent(inout) :: axes(3, 3)
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      real(wp) :: point(9), turn(2), x(3), z(3)
      real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
      integer :: i, n
      logical :: found

      if (block%nline == 0) then
         call complain(log, 'E0103', '*ORIENTATION needs a line with two points', block%at)
         return
      end if
      point = 0.0_wp
      call split_fields(block%line(1), field, n)
      do i = 1, min(n, 9)
         call field_real(field(i), point(i), log, found)
      end do
      x = point(1:3) - point(7:9)
      z = cross(x, point(4:6) - point(7:9))
      if (.not. norm2(z) > 1.0e-10_wp*norm2(x)*norm2(point(4:6) - point(7:9))) then
         call complain(log, 'E0405', 'the points of *ORIENTATION give no axes', &
            & line_place(block%line(1)), help='a on local 1, b in the plane of 1 and 2, not in '// &
            & 'line with the origin')
         return
      end if
      axes(1, :) = x/norm2(x)
      axes(3, :) = z/norm2(z)
      axes(2, :) = cross(axes(3, :), axes(1, :))
      if (block%nline < 2) return
      turn = [3.0_wp, 0.0_wp]
      call split_fields(block%line(2), field, n)
      do i = 1, min(n, 2)
         call field_real(field(i), turn(i), log, found)
      end do
      if (nint(turn(1)) < 1 .or. nint(turn(1)) > 3) then
         call complain(log, 'E0203', 'an axis is 1, 2 or 3', line_place(block%line(2)))
         return
      end if
      call turn_about(axes, nint(turn(1)), degree*turn(2))
   end subroutine read_lines

   pure subroutine turn_about(axes, k, angle)
      real(wp), intent(inout) :: axes(3, 3)
      integer, intent(in) :: k
      real(wp), intent(in) :: angle
      real(wp) :: first(3)
      integer :: i, j

      i = 1 + mod(k, 3)
      j = 1 + mod(k + 1, 3)
      first = cos(angle)*axes(i, :) + sin(angle)*axes(j, :)
      axes(j, :) = cos(angle)*axes(j, :) - sin(angle)*axes(i, :)
      axes(i, :) = first
   end subroutine turn_about
end module lopin_build_orientations
