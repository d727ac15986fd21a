!> Points along a profile, for pictures.
module lopin_profile_points
   use lopin_kinds, only : wp
   use lopin_profile, only : profile_type, segment_type, segment_kind, parabola_point
   implicit none
   private
   public :: draw_profile

   integer, parameter :: ring = 72             !! lines per turn of an arc

contains

   !> Points along the profile: ends, and what an arc or a parabola needs to look round.
   pure subroutine draw_profile(profile, points)
      type(profile_type), intent(in) :: profile
      real(wp), allocatable, intent(out) :: points(:, :)   !! (2, npoint) in the order of travel
      real(wp), parameter :: pi = acos(-1.0_wp)
      integer :: i, j, k, total
      integer :: pieces(size(profile%segment))

      do i = 1, size(profile%segment)
         associate (segment => profile%segment(i))
            pieces(i) = 1
            if (segment%kind == segment_kind%parabola) pieces(i) = ring/2
            if (segment%kind == segment_kind%arc) pieces(i) = &
               & max(2, ceiling(ring/(2.0_wp*pi)*acos(min(1.0_wp, max(-1.0_wp, &
               & dot_product(segment%ta, segment%tb))))))
         end associate
      end do
      total = 1 + sum(pieces)
      allocate (points(2, total))
      points(:, 1) = profile%segment(1)%a
      k = 1
      do i = 1, size(profile%segment)
         do j = 1, pieces(i)
            k = k + 1
            points(:, k) = point_along(profile%segment(i), real(j, wp)/real(pieces(i), wp))
         end do
      end do
   end subroutine draw_profile

   pure function point_along(segment, s) result(p)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: s   !! in [0, 1]
      real(wp) :: p(2), angle, from(2)

      select case (segment%kind)
      case (segment_kind%line)
         p = segment%a + s*(segment%b - segment%a)
      case (segment_kind%arc)
         angle = s*segment%turn*acos(min(1.0_wp, max(-1.0_wp, dot_product(segment%ta, segment%tb))))
         from = segment%a - segment%c
         p = segment%c + cos(angle)*from + sin(angle)*[-from(2), from(1)]
      case default
         p = parabola_point(segment, 2.0_wp*s - 1.0_wp)
      end select
   end function point_along
end module lopin_profile_points
