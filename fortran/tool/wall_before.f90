!> The wall of a tool between a point inside it and the body that the point belongs to.
!>
!> The closest point of a surface tells little of a point that is deep inside a thin part: it lies
!> on either side of a rib, or in the corner behind it.
module lopin_wall_before
   use lopin_kinds, only : wp
   use lopin_tool, only : tool_type, foot_type, coincidence
   implicit none
   private
   public :: find_wall_before

   !> Steps of the way out, each as long as the surface is far; its length, in sizes of the tool.
   integer, parameter :: most_steps = 200
   real(wp), parameter :: farthest = 2.0_wp

contains

   !> From a point inside the tool against the outward side of its own surface, to where the way
   !> leaves the tool. Not found: the point is outside, or the way does not lead out.
   pure subroutine find_wall_before(tool, x, side, wall)
      class(tool_type), intent(in) :: tool
      real(wp), intent(in) :: x(:)             !! (ndim) in the tool frame [length]
      real(wp), intent(in) :: side(:)          !! (ndim) unit, in the tool frame
      type(foot_type), intent(out) :: wall     !! its gap is that of the point to the plane there
      type(foot_type) :: foot
      real(wp) :: way, far, rounding
      integer :: step, d

      d = size(x)
      rounding = coincidence*tool%size
      way = 0.0_wp
      do step = 1, most_steps
         call tool%project(x - way*side, foot)
         if (.not. foot%found .or. foot%overhang > 0.0_wp) return
         ! Behind an edge the gap is that of one wall, and may vanish where the surface is far.
         far = norm2(x - way*side - foot%point(:d))
         if (foot%gap > rounding .or. far <= rounding) exit
         way = way + far
         if (way > farthest*tool%size) return
      end do
      if (step == 1 .or. step > most_steps) return
      ! A little farther it is outside, and no corner that is seen from within is nearest.
      call tool%project(x - (way + 2.0_wp*rounding)*side, wall)
      if (wall%gap < 0.0_wp) wall%found = .false.
      wall%gap = dot_product(wall%normal(:d), x - wall%point(:d))
      wall%point(:d) = x - wall%gap*wall%normal(:d)
   end subroutine find_wall_before
end module lopin_wall_before
