!> A triangle curved by the normals of its corners, and the closest point on it.
!>
!> The quadratic surface through three corners whose edges are parabolas (Nagata, Comput. Aided
!> Geom. Des. 22, 2005, 327-347), as a Bezier triangle: corners 1 to 3, then what pulls the edges
!> 12, 23 and 31. An edge that bends the way of a circle has the sagitta of the circle.
module lopin_curved_triangle
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   implicit none
   private
   public :: edge_control, rise_of_patch, closest_on_curved, normal_slopes

   integer, parameter :: most_steps = 25
   real(wp), parameter :: still = 1.0e-14_wp   !! of a parameter [-]
   !> Patches of which the normal has turned further from that of the corners have none [cosine].
   real(wp), parameter :: least = 0.5_wp
   !> Along the edges 12, 23, 31, in the shares of corners 2 and 3.
   real(wp), parameter :: ways(2, 3) = reshape([1.0_wp, 0.0_wp, -1.0_wp, 1.0_wp, 0.0_wp, &
      & -1.0_wp], [2, 3])

contains

   !> What pulls the edge from a to b, with unit normals there.
   pure function edge_control(a, b, na, nb) result(control)
      real(wp), intent(in) :: a(3), b(3)       !! [length]
      real(wp), intent(in) :: na(3), nb(3)
      real(wp) :: control(3)                   !! [length]
      real(wp) :: mean(3)

      mean = na + nb
      control = 0.5_wp*(a + b) + 0.5_wp*mean*dot_product(nb - na, b - a)/dot_product(mean, mean)
   end function edge_control

   !> How far the patch is off the triangle of its corners, by the middles of its edges and its own.
   pure real(wp) function rise_of_patch(control) result(rise)
      real(wp), intent(in) :: control(3, 6)    !! [length]
      real(wp) :: bulge(3, 3)
      integer :: k

      do k = 1, 3
         bulge(:, k) = control(:, 3 + k) - 0.5_wp*(control(:, k) + control(:, 1 + mod(k, 3)))
      end do
      rise = max(0.5_wp*maxval(norm2(bulge, dim=1)), norm2(sum(bulge, dim=2))*2.0_wp/9.0_wp)
   end function rise_of_patch

   !> The closest point: where it is, and on what.
   pure subroutine closest_on_curved(control, x, share, point, feature)
      real(wp), intent(in) :: control(3, 6)    !! [length]
      real(wp), intent(in) :: x(3)             !! [length]
      real(wp), intent(inout) :: share(3)      !! of the corners; in: where to begin [-]
      real(wp), intent(out) :: point(3)        !! [length]
      integer, intent(out) :: feature          !! as lopin_triangle has it
      integer, parameter :: from(3) = [1, 2, 3], to(3) = [2, 3, 1]
      real(wp) :: inner(3), best, t, place(3)
      integer :: k

      inner = share
      call descend(control, x, inner)
      if (all(inner >= 0.0_wp)) then
         share = inner
         point = at(control, share)
         feature = 0
         return
      end if
      best = huge(1.0_wp)
      feature = 0
      do k = 1, 3
         t = 0.5_wp
         call descend_edge(control(:, from(k)), control(:, 3 + k), control(:, to(k)), x, t)
         place = (1.0_wp - t)**2*control(:, from(k)) + 2.0_wp*t*(1.0_wp - t)*control(:, 3 + k) &
            & + t**2*control(:, to(k))
         if (sum((x - place)**2) >= best) cycle
         best = sum((x - place)**2)
         point = place
         share = 0.0_wp
         share(from(k)) = 1.0_wp - t
         share(to(k)) = t
         feature = k
         if (t <= 0.0_wp) feature = 3 + from(k)
         if (t >= 1.0_wp) feature = 3 + to(k)
      end do
   end subroutine closest_on_curved

   !> Newton on the squared distance; shares may become negative, and then end it.
   pure subroutine descend(control, x, share)
      real(wp), intent(in) :: control(3, 6), x(3)
      real(wp), intent(inout) :: share(3)
      real(wp) :: slope(3, 2), bend(3, 3), arm(3), f(2), j(2, 2), step(2), det
      integer :: i

      do i = 1, most_steps
         call find_slopes(control, share, slope, bend)
         arm = at(control, share) - x
         f = matmul(arm, slope)
         j = matmul(transpose(slope), slope)
         call add_bend(j, arm, bend)
         det = j(1, 1)*j(2, 2) - j(1, 2)**2
         if (.not. (det > 0.0_wp .and. j(1, 1) > 0.0_wp)) then
            j = matmul(transpose(slope), slope)
            det = j(1, 1)*j(2, 2) - j(1, 2)**2
         end if
         if (.not. det > 0.0_wp) return
         step = [j(2, 2)*f(1) - j(1, 2)*f(2), j(1, 1)*f(2) - j(1, 2)*f(1)]/det
         step = step/max(1.0_wp, 2.0_wp*maxval(abs(step)))
         share(2:3) = share(2:3) - step
         share(1) = 1.0_wp - share(2) - share(3)
         if (maxval(abs(step)) <= still) return
         if (minval(share) < -1.0_wp) return
      end do
   end subroutine descend

   !> Newton on an edge, within its ends.
   pure subroutine descend_edge(a, p, b, x, t)
      real(wp), intent(in) :: a(3), p(3), b(3), x(3)   !! [length]
      real(wp), intent(inout) :: t             !! 0..1 [-]
      real(wp) :: arm(3), slope(3), bend(3), f, j, next
      integer :: i

      bend = 2.0_wp*(a - 2.0_wp*p + b)
      do i = 1, most_steps
         arm = (1.0_wp - t)**2*a + 2.0_wp*t*(1.0_wp - t)*p + t**2*b - x
         slope = 2.0_wp*((1.0_wp - t)*(p - a) + t*(b - p))
         f = dot_product(arm, slope)
         j = dot_product(slope, slope) + dot_product(arm, bend)
         if (.not. j > 0.0_wp) j = dot_product(slope, slope)
         if (.not. j > 0.0_wp) return
         next = min(1.0_wp, max(0.0_wp, t - f/j))
         if (abs(next - t) <= still) return
         t = next
      end do
   end subroutine descend_edge

   pure subroutine add_bend(j, arm, bend)
      real(wp), intent(inout) :: j(2, 2)
      real(wp), intent(in) :: arm(3), bend(3, 3)

      j(1, 1) = j(1, 1) + dot_product(arm, bend(:, 1))
      j(2, 2) = j(2, 2) + dot_product(arm, bend(:, 2))
      j(1, 2) = j(1, 2) + dot_product(arm, bend(:, 3))
      j(2, 1) = j(1, 2)
   end subroutine add_bend

   pure function at(control, share) result(point)
      real(wp), intent(in) :: control(3, 6), share(3)
      real(wp) :: point(3)

      associate (b => share)
         point = b(1)**2*control(:, 1) + b(2)**2*control(:, 2) + b(3)**2*control(:, 3) + 2.0_wp &
            & *(b(1)*b(2)*control(:, 4) + b(2)*b(3)*control(:, 5) + b(3)*b(1)*control(:, 6))
      end associate
   end function at

   !> First and second derivatives in the shares of corners 2 and 3: by 2, 3; by 22, 33, 23.
   pure subroutine find_slopes(control, share, slope, bend)
      real(wp), intent(in) :: control(3, 6), share(3)
      real(wp), intent(out) :: slope(3, 2), bend(3, 3)
      real(wp) :: by(3, 3)

      by(:, 1) = share(1)*control(:, 1) + share(2)*control(:, 4) + share(3)*control(:, 6)
      by(:, 2) = share(2)*control(:, 2) + share(1)*control(:, 4) + share(3)*control(:, 5)
      by(:, 3) = share(3)*control(:, 3) + share(2)*control(:, 5) + share(1)*control(:, 6)
      slope(:, 1) = 2.0_wp*(by(:, 2) - by(:, 1))
      slope(:, 2) = 2.0_wp*(by(:, 3) - by(:, 1))
      bend(:, 1) = 2.0_wp*(control(:, 2) + control(:, 1) - 2.0_wp*control(:, 4))
      bend(:, 2) = 2.0_wp*(control(:, 3) + control(:, 1) - 2.0_wp*control(:, 6))
      bend(:, 3) = 2.0_wp*(control(:, 1) + control(:, 5) - control(:, 4) - control(:, 6))
   end subroutine find_slopes

   !> The normal between those of the corners, the patch's own, and how the first turns as the point
   !> moves.
   pure subroutine normal_slopes(control, corner, share, feature, x, normals, hessian)
      real(wp), intent(in) :: control(3, 6)    !! [length]
      real(wp), intent(in) :: corner(3, 3)     !! unit normals of the corners
      real(wp), intent(in) :: share(3)         !! of the corners at the foot [-]
      integer, intent(in) :: feature           !! what the foot lies on
      real(wp), intent(in) :: x(3)             !! the point [length]
      real(wp), intent(out) :: normals(3, 2)
      real(wp), intent(out) :: hessian(3, 3)   !! of normals(i, 1) by x(j) [1/length]
      real(wp) :: slope(3, 2), bend(3, 3), j(2, 2), det, size_, normal(3), own(3), &
         & turn(3, 2), move(3, 2), way(2), along(3), stiff
      integer :: i

      normal = matmul(corner, share)
      size_ = norm2(normal)
      normal = normal/size_
      turn(:, 1) = (corner(:, 2) - corner(:, 1))/size_
      turn(:, 2) = (corner(:, 3) - corner(:, 1))/size_
      do i = 1, 2
         turn(:, i) = turn(:, i) - dot_product(turn(:, i), normal)*normal
      end do
      hessian = 0.0_wp
      call find_slopes(control, share, slope, bend)
      own = cross(slope(:, 1), slope(:, 2))
      if (.not. abs(dot_product(own, normal)) > least*norm2(own)) own = normal
      own = sign(1.0_wp, dot_product(own, normal))/norm2(own)*own
      normals(:, 1) = normal
      normals(:, 2) = own
      if (feature > 3) return
      j = matmul(transpose(slope), slope)
      call add_bend(j, at(control, share) - x, bend)
      if (feature == 0) then
         det = j(1, 1)*j(2, 2) - j(1, 2)**2
         if (.not. det > 0.0_wp) return
         move(:, 1) = (j(2, 2)*slope(:, 1) - j(1, 2)*slope(:, 2))/det
         move(:, 2) = (j(1, 1)*slope(:, 2) - j(1, 2)*slope(:, 1))/det
      else
         way = ways(:, feature)
         along = matmul(slope, way)
         stiff = dot_product(way, matmul(j, way))
         if (.not. stiff > 0.0_wp) return
         move(:, 1) = way(1)*along/stiff
         move(:, 2) = way(2)*along/stiff
      end if
      do i = 1, 3
         hessian(:, i) = turn(:, 1)*move(i, 1) + turn(:, 2)*move(i, 2)
      end do
   end subroutine normal_slopes
end module lopin_curved_triangle
