!> Closest point of a plane profile: segments, Voronoi regions of its corners, open ends.
module lopin_profile_projection
   use lopin_kinds, only : wp
   use lopin_tool, only : coincidence
   use lopin_profile, only : profile_type, segment_type, segment_kind, outward_side, left_of, &
      & cross_2d, &
      & smooth_angle, parabola_point, parabola_slope
   implicit none
   private
   public :: foot_2d_type, project_profile, project_profile_all

   type :: foot_2d_type
      real(wp) :: point(2) = 0.0_wp
      real(wp) :: normal(2) = 0.0_wp
      real(wp) :: gap = 0.0_wp
      real(wp) :: bend = 0.0_wp        !! second derivative of the gap across the normal [1/length]
      real(wp) :: overhang = 0.0_wp
      integer :: segment = 0
      logical :: corner = .false.
      real(wp) :: cone = 1.0_wp        !! as in `foot_type`
   end type foot_2d_type

contains

   !> The closest point of a profile.
   pure subroutine project_profile(profile, p, foot)
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: p(2)              !! [length]
      type(foot_2d_type), intent(out) :: foot
      real(wp) :: q(2), best(2), t, best_t, d2, least
      integer :: i, k

      least = huge(1.0_wp)
      best = 0.0_wp
      best_t = 0.0_wp
      k = 1
      do i = 1, size(profile%segment)
         call closest_on_segment(profile%segment(i), p, q, t)
         d2 = (p(1) - q(1))**2 + (p(2) - q(2))**2
         if (d2 < least) then
            least = d2
            best = q
            best_t = t
            k = i
         end if
      end do
      if (abs(best_t) < 1.0_wp) then
         call inside_foot(profile%segment(k), p, best, best_t, foot)
      else
         call end_foot(profile, k, best_t > 0.0_wp, p, foot)
      end if
      foot%segment = k
   end subroutine project_profile

   !> Both constraints of the nearest concave corner within reach; else the closest point alone.
   !>
   !> Beside a concave corner each neighbour counts as if it went on behind the corner: a node that
   !> has passed both surfaces is pushed back by each along its own normal.
   pure subroutine project_profile_all(profile, p, reach, feet, nfeet)
      type(profile_type), intent(in) :: profile
      real(wp), intent(in) :: p(2)                  !! [length]
      real(wp), intent(in) :: reach                 !! [length]
      type(foot_2d_type), intent(out) :: feet(2)    !! the least gap first
      integer, intent(out) :: nfeet
      type(foot_2d_type) :: swap
      integer :: i, n, before, after
      real(wp) :: least, d

      n = size(profile%segment)
      least = reach
      after = 0
      do i = 1, n
         before = i - 1
         if (i == 1) before = merge(n, 0, profile%closed)
         if (before == 0) cycle
         if (.not. is_concave(profile%segment(before), profile%segment(i))) cycle
         d = norm2(p - profile%segment(i)%a)
         if (d <= least) then
            least = d
            after = i
         end if
      end do
      nfeet = 1
      if (after == 0) then
         call project_profile(profile, p, feet(1))
         return
      end if
      before = merge(n, after - 1, after == 1)
      ! Beyond the far end of a wall, as on the top of a rib, the corner behind it is nothing.
      call project_profile(profile, p, feet(1))
      if (feet(1)%segment /= before .and. feet(1)%segment /= after &
         & .and. reach < huge(1.0_wp)) return
      call carrier_foot(profile%segment(before), .true., p, feet(1))
      call carrier_foot(profile%segment(after), .false., p, feet(2))
      feet(1)%segment = before
      feet(2)%segment = after
      nfeet = 2
      if (feet(2)%gap < feet(1)%gap) then
         swap = feet(1)
         feet(1) = feet(2)
         feet(2) = swap
      end if
   end subroutine project_profile_all

   !> The corner between two segments turns towards the outward side.
   pure logical function is_concave(one, two)
      type(segment_type), intent(in) :: one, two
      is_concave = outward_side*cross_2d(one%tb, two%ta) > smooth_angle
   end function is_concave

   !> Closest point of one segment; t is -1 at a, 1 at b and between them inside.
   pure subroutine closest_on_segment(segment, p, q, t)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: p(2)
      real(wp), intent(out) :: q(2), t
      real(wp) :: along, length, away(2)

      t = 0.0_wp
      select case (segment%kind)
      case (segment_kind%line)
         along = dot_product(p - segment%a, segment%ta)
         length = dot_product(segment%b - segment%a, segment%ta)
         if (along <= 0.0_wp) then
            t = -1.0_wp
         else if (along >= length) then
            t = 1.0_wp
         else
            q = segment%a + along*segment%ta
         end if
      case (segment_kind%arc)
         away = p - segment%c
         if (dot_product(away, segment%ta) <= 0.0_wp .or. dot_product(away, &
            & segment%tb) >= 0.0_wp) then
            call arc_end(segment, away, t)
         end if
         if (abs(t) < 1.0_wp) then
            length = norm2(away)
            if (length <= epsilon(1.0_wp)*segment%radius) then
               away = 0.5_wp*(segment%a + segment%b) - segment%c
               length = norm2(away)
            end if
            q = segment%c + segment%radius*away/length
         end if
      case default
         call closest_on_parabola(segment, p, t)
         q = parabola_point(segment, t)
      end select
      if (t <= -1.0_wp) q = segment%a
      if (t >= 1.0_wp) q = segment%b
   end subroutine closest_on_segment

   !> Which end of an arc is nearest when the direction from the centre is outside its angle.
   pure subroutine arc_end(segment, away, t)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: away(2)          !! from the centre
      real(wp), intent(out) :: t

      t = 0.0_wp
      ! An arc below 180 degrees: inside its angle, the direction is ahead of a and not yet at b.
      if (dot_product(away, segment%ta) > 0.0_wp .and. dot_product(away, &
         & segment%tb) < 0.0_wp) return
      if (.not. dot_product(away, away) > (epsilon(1.0_wp)*segment%radius)**2) return
      if (dot_product(away, segment%a - segment%c) >= dot_product(away, segment%b - segment%c)) then
         t = -1.0_wp
      else
         t = 1.0_wp
      end if
   end subroutine arc_end

   !> Global closest parameter of a parabola: the slope of the squared distance is a cubic in t.
   pure subroutine closest_on_parabola(segment, p, t)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: p(2)
      real(wp), intent(out) :: t               !! in [-1, 1]
      real(wp) :: c(0:3), root(4), turning, s, trial, d2, least
      real(wp) :: x1(2), x2(2), x0(2)
      integer :: i

      x0 = segment%c - p
      x1 = 0.5_wp*(segment%b - segment%a)
      x2 = 0.5_wp*(segment%a + segment%b) - segment%c
      c = [dot_product(x1, x0), dot_product(x1, x1) + 2.0_wp*dot_product(x2, x0), &
         & 3.0_wp*dot_product(x1, x2), 2.0_wp*dot_product(x2, x2)]
      ! The cubic is monotone between its turning points: one bracketed root in each piece.
      root = [-1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp]
      turning = c(2)**2 - 3.0_wp*c(1)*c(3)
      if (turning > 0.0_wp) then
         s = -(c(2) + sign(sqrt(turning), c(2)))
         root(2) = min(1.0_wp, max(-1.0_wp, ratio(c(1), s)))
         root(3) = min(1.0_wp, max(-1.0_wp, ratio(s, 3.0_wp*c(3))))
         if (root(2) > root(3)) root(2:3) = [root(3), root(2)]
      end if
      least = sum((segment%a - p)**2)
      t = -1.0_wp
      if (sum((segment%b - p)**2) < least) then
         t = 1.0_wp
         least = sum((segment%b - p)**2)
      end if
      do i = 1, 3
         if (.not. root(i + 1) > root(i)) cycle
         if (cubic(c, root(i)) > 0.0_wp .or. cubic(c, root(i + 1)) < 0.0_wp) cycle
         trial = bracketed_root(c, root(i), root(i + 1))
         d2 = sum((parabola_point(segment, trial) - p)**2)
         if (d2 < least) then
            least = d2
            t = trial
         end if
      end do
   end subroutine closest_on_parabola

   !> a/b, or a large number of the right sign.
   pure real(wp) function ratio(a, b)
      real(wp), intent(in) :: a, b
      if (abs(a) < 2.0_wp*abs(b)) then
         ratio = a/b
      else
         ratio = 2.0_wp*sign(1.0_wp, a)*sign(1.0_wp, b)
      end if
   end function ratio

   pure real(wp) function cubic(c, t)
      real(wp), intent(in) :: c(0:3), t
      cubic = c(0) + t*(c(1) + t*(c(2) + t*c(3)))
   end function cubic

   !> Root of a cubic that rises from a to b, by Newton kept inside its bracket.
   pure real(wp) function bracketed_root(c, a, b) result(t)
      real(wp), intent(in) :: c(0:3), a, b
      real(wp) :: low, high, f, slope, step
      integer :: i

      low = a
      high = b
      t = 0.5_wp*(a + b)
      do i = 1, 60
         f = cubic(c, t)
         if (f > 0.0_wp) then
            high = t
         else
            low = t
         end if
         slope = c(1) + t*(2.0_wp*c(2) + t*3.0_wp*c(3))
         step = 0.5_wp*(low + high) - t
         if (slope > 0.0_wp) then
            if (t - f/slope >= low .and. t - f/slope <= high) step = -f/slope
         end if
         t = t + step
         if (abs(step) <= 4.0_wp*epsilon(1.0_wp)) exit
      end do
   end function bracketed_root

   pure subroutine inside_foot(segment, p, q, t, foot)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: p(2), q(2), t
      type(foot_2d_type), intent(out) :: foot
      real(wp) :: direction(2), curvature

      foot%point = q
      call shape_at(segment, q, t, direction, curvature)
      foot%normal = outward_side*left_of(direction)
      foot%gap = dot_product(p - q, foot%normal)
      foot%bend = bend_of(curvature, foot%gap)
   end subroutine inside_foot

   !> Unit direction of travel, and curvature: > 0 when the outward side is inside the bend.
   pure subroutine shape_at(segment, q, t, direction, curvature)
      type(segment_type), intent(in) :: segment
      real(wp), intent(in) :: q(2), t
      real(wp), intent(out) :: direction(2), curvature
      real(wp) :: speed

      select case (segment%kind)
      case (segment_kind%line)
         direction = segment%ta
         curvature = 0.0_wp
      case (segment_kind%arc)
         direction = segment%turn*left_of(q - segment%c)/segment%radius
         curvature = outward_side*segment%turn/segment%radius
      case default
         direction = parabola_slope(segment, t)
         speed = norm2(direction)
         curvature = outward_side*cross_2d(direction, segment%a + segment%b - &
            & 2.0_wp*segment%c)/speed**3
         direction = direction/speed
      end select
   end subroutine shape_at

   !> Second derivative of the distance to a curve; 0 at the centre of curvature, where it has none.
   pure real(wp) function bend_of(curvature, gap)
      real(wp), intent(in) :: curvature, gap
      real(wp) :: remaining

      remaining = 1.0_wp - curvature*gap
      bend_of = 0.0_wp
      if (abs(remaining) > epsilon(1.0_wp)) bend_of = -curvature/remaining
   end function bend_of

   !> The foot is an end of segment k: a smooth joint, a corner, or an open end.
   pure subroutine end_foot(profile, k, last, p, foot)
      type(profile_type), intent(in) :: profile
      integer, intent(in) :: k
      logical, intent(in) :: last
      real(wp), intent(in) :: p(2)
      type(foot_2d_type), intent(out) :: foot
      real(wp) :: v(2), before(2), after(2), pseudo(2), away(2), distance, here(2)
      logical :: has_neighbour

      v = merge(profile%segment(k)%b, profile%segment(k)%a, last)
      here = merge(profile%segment(k)%tb, profile%segment(k)%ta, last)
      call inside_foot(profile%segment(k), p, v, merge(1.0_wp, -1.0_wp, last), foot)
      call joint(profile, k, last, p, before, after, has_neighbour)
      if (.not. has_neighbour) then
         foot%overhang = dot_product(p - v, merge(here, -here, last))
         if (foot%overhang <= coincidence*profile%size) then
            foot%overhang = 0.0_wp
         else
            foot%bend = 0.0_wp
         end if
         return
      end if
      if (abs(cross_2d(before, after)) <= smooth_angle .and. dot_product(before, &
         & after) > 0.0_wp) return

      foot%corner = .true.
      ! A cusp is taken for a needle: its outward direction is the way to its tip.
      pseudo = outward_side*left_of(before + after)
      if (dot_product(before, after) < 0.0_wp .and. abs(cross_2d(before, &
         & after)) <= smooth_angle) pseudo = before
      away = p - v
      distance = norm2(away)
      if (distance <= 1.0e-3_wp*coincidence*profile%size) then
         foot%normal = pseudo/norm2(pseudo)
         foot%cone = abs(dot_product(foot%normal, left_of(before)))
         foot%gap = dot_product(away, foot%normal)
         foot%bend = 0.0_wp
      else
         foot%gap = sign(distance, dot_product(away, pseudo))
         foot%normal = away/foot%gap
         foot%bend = 1.0_wp/foot%gap
      end if
   end subroutine end_foot

   !> Directions of travel before and after an end of segment k.
   !>
   !> An end on the axis x = 0 seen from x >= 0 meets its mirror image: the tip of an axisymmetric
   !> or half-modelled punch is a corner (or smooth), not an open end.
   pure subroutine joint(profile, k, last, p, before, after, has_neighbour)
      type(profile_type), intent(in) :: profile
      integer, intent(in) :: k
      logical, intent(in) :: last
      real(wp), intent(in) :: p(2)
      real(wp), intent(out) :: before(2), after(2)
      logical, intent(out) :: has_neighbour
      integer :: n, next
      real(wp) :: x

      n = size(profile%segment)
      before = profile%segment(k)%tb
      after = profile%segment(k)%ta
      next = k + merge(1, -1, last)
      if (profile%closed) next = 1 + modulo(next - 1, n)
      has_neighbour = next >= 1 .and. next <= n
      if (has_neighbour) then
         if (last) after = profile%segment(next)%ta
         if (.not. last) before = profile%segment(next)%tb
         return
      end if
      x = merge(profile%segment(k)%b(1), profile%segment(k)%a(1), last)
      has_neighbour = abs(x) <= coincidence*profile%size .and. p(1) >= -coincidence*profile%size
      if (last) after = [before(1), -before(2)]
      if (.not. last) before = [after(1), -after(2)]
   end subroutine joint

   !> Foot on a segment that goes on beyond one of its ends: its line, its circle, its end tangent.
   pure subroutine carrier_foot(segment, last, p, foot)
      type(segment_type), intent(in) :: segment
      logical, intent(in) :: last              !! goes on beyond b, else beyond a
      real(wp), intent(in) :: p(2)
      type(foot_2d_type), intent(out) :: foot
      real(wp) :: q(2), t, v(2), direction(2)

      call closest_on_segment(segment, p, q, t)
      if (abs(t) >= 1.0_wp) then
         v = merge(segment%b, segment%a, last)
         direction = merge(segment%tb, segment%ta, last)
         if (segment%kind == segment_kind%arc) then
            q = segment%c + segment%radius*(p - segment%c)/norm2(p - segment%c)
         else
            q = v + direction*dot_product(p - v, direction)
         end if
      end if
      if (segment%kind == segment_kind%parabola .and. abs(t) >= 1.0_wp) then
         foot%point = q
         foot%normal = outward_side*left_of(direction)
         foot%gap = dot_product(p - q, foot%normal)
      else
         call inside_foot(segment, p, q, t, foot)
      end if
   end subroutine carrier_foot
end module lopin_profile_projection
