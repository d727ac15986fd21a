!> Closest point of one facet, and the conventions of gap and normal.
!>
!> The normal points out of the master, towards the slave; gap g = (x_s - x_m).n, >= 0 open, < 0
!> penetrating. Facet nodes are ordered as in lopin_cells: right-hand rule, or right of 1 -> 2 for
!> lines.
!>
!> The distance is minimised by Newton steps; each step solves its quadratic model exactly under the
!> bounds of the cell, so that edges and corners need no other treatment.
module lopin_projection
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_family
   use lopin_facet_basis, only : ncoefficient, facet_point_of, facet_tangents, facet_seconds
   implicit none
   private
   public :: closest_type, place, project_on_facet, facet_unit_normal, edge_ends, facet_metric

   !> Where a foot lies.
   type :: places
      integer :: none = 0       !! there is no foot
      integer :: inside = 1
      integer :: edge = 2
      integer :: vertex = 3
      integer :: extended = 4   !! just beyond the perimeter of the surface, on the continued facet
   end type places
   type(places), parameter :: place = places()

   type :: closest_type
      integer :: place = 0 !! place%...; none: the iterations failed (degenerate facet)
      integer :: feature = 0             !! number of the edge or vertex
      integer :: iterations = 0
      real(wp) :: xi(2) = 0.0_wp         !! eta = 0 on lines
      real(wp) :: point(3) = 0.0_wp      !! [length]
      real(wp) :: distance2 = huge(1.0_wp)   !! squared distance [length^2]
   end type closest_type

   integer, parameter :: most_iterations = 40
   real(wp), parameter :: settled = 1.0e-13_wp       !! step in reference units
   real(wp), parameter :: quadratic = 1.0e-8_wp !! a Newton step this small is the last
   real(wp), parameter :: rounding = 1.0e-14_wp      !! relative, of a squared distance
   real(wp), parameter :: pushing = 1.0e-10_wp       !! relative slope that presses against a bound

contains

   !> Closest point of a facet to x.
   !>
   !> Edge k joins corners k and k+1; on lines "edge" k is the end at node k, reported as vertex k.
   pure subroutine project_on_facet(c, family, start, slack, x, closest)
      real(wp), intent(in) :: c(3, ncoefficient)   !! see lopin_facet_basis [length]
      integer, intent(in) :: family                !! cell_family%line, %triangle or %quad
      real(wp), intent(in) :: start(2)             !! first guess, inside the cell
      real(wp), intent(in) :: slack(4) !! how far each edge is moved outward, reference units
      real(wp), intent(in) :: x(3)                 !! [length]
      type(closest_type), intent(out) :: closest
      real(wp) :: corner(2, 4)
      integer :: n

      call corners_of(family, slack, n, corner)
      if (family == cell_family%line) then
         call project_on_line(c, corner, start(1), x, closest)
      else
         call minimise(c, n, corner, start, x, closest)
      end if
      if (.not. closest%distance2 < huge(1.0_wp)) closest%place = place%none
   end subroutine project_on_facet

   pure subroutine corners_of(family, slack, n, corner)
      integer, intent(in) :: family
      real(wp), intent(in) :: slack(4)
      integer, intent(out) :: n
      real(wp), intent(out) :: corner(2, 4)

      n = 4
      if (family == cell_family%quad) then
         corner(1, :) = [-1.0_wp - slack(4), 1.0_wp + slack(2), 1.0_wp + slack(2), -1.0_wp - &
            & slack(4)]
         corner(2, :) = [-1.0_wp - slack(1), -1.0_wp - slack(1), 1.0_wp + slack(3), 1.0_wp + &
            & slack(3)]
      else if (family == cell_family%triangle) then
         n = 3
         corner(1, :) = [-slack(3), 1.0_wp + slack(1) + slack(2), -slack(3), -slack(3)]
         corner(2, :) = [-slack(1), -slack(1), 1.0_wp + slack(2) + slack(3), -slack(1)]
      else
         n = 2
         corner = 0.0_wp
         corner(1, :2) = [-1.0_wp - slack(1), 1.0_wp + slack(2)]
      end if
   end subroutine corners_of

   !> Reference coordinates of a point at fraction s of edge k.
   pure function edge_ends(family, k, s) result(xi)
      integer, intent(in) :: family, k
      real(wp), intent(in) :: s            !! in [0, 1], from corner k to the next
      real(wp) :: xi(2), corner(2, 4)
      integer :: n

      call corners_of(family, [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp], n, corner)
      xi = corner(:, k) + s*(corner(:, 1 + mod(k, n)) - corner(:, k))
      if (family == cell_family%line) xi = corner(:, k)
   end function edge_ends

   !> A line: Newton within a bracket; the slope of the squared distance of a line3 is a cubic, of
   !> which the lowest minimum is wanted: the search starts from the best of a few samples.
   pure subroutine project_on_line(c, corner, start, x, closest)
      real(wp), intent(in) :: c(3, ncoefficient), corner(2, 4), start, x(3)
      type(closest_type), intent(inout) :: closest
      real(wp) :: t, r(3), t1(3), t2(3), slope, curve, step, low, high, value, best, at
      logical :: bent
      integer :: i

      low = corner(1, 1)
      high = corner(1, 2)
      bent = any(abs(c(:, [5, 9])) > 0.0_wp)
      t = start
      if (bent) then
         best = huge(1.0_wp)
         do i = 0, 6
            at = low + real(i, wp)/6.0_wp*(high - low)
            value = sum((x - facet_point_of(c, [at, 0.0_wp]))**2)
            if (value < best) t = at
            best = min(best, value)
         end do
      end if
      do i = 1, most_iterations
         closest%iterations = i
         r = x - facet_point_of(c, [t, 0.0_wp])
         call facet_tangents(c, [t, 0.0_wp], t1, t2)
         slope = -dot_product(r, t1)
         curve = dot_product(t1, t1) - dot_product(r, 2.0_wp*c(:, 5) + 6.0_wp*t*c(:, 9))
         if (.not. curve > 0.1_wp*dot_product(t1, t1)) curve = dot_product(t1, t1)
         if (.not. curve > 0.0_wp) return
         step = min(max(t - slope/curve, low), high) - t
         do while (bent .and. abs(step) > settled)
            value = sum((x - facet_point_of(c, [t + step, 0.0_wp]))**2)
            if (value <= (1.0_wp + rounding)*dot_product(r, r)) exit
            step = 0.5_wp*step
         end do
         t = t + step
         if (abs(step) <= settled .or. .not. bent) exit
      end do
      closest%xi(1) = t
      closest%point = facet_point_of(c, closest%xi)
      closest%distance2 = sum((x - closest%point)**2)
      call facet_tangents(c, closest%xi, t1, t2)
      slope = dot_product(x - closest%point, t1)
      closest%place = place%inside
      step = pushing*dot_product(t1, t1)
      if (t <= low .and. slope < -step) closest%feature = 1
      if (t >= high .and. slope > step) closest%feature = 2
      if (closest%feature > 0) closest%place = place%vertex
   end subroutine project_on_line

   !> A surface: Newton steps, each the exact minimum of its convex quadratic model in the cell.
   pure subroutine minimise(c, n, corner, start, x, closest)
      real(wp), intent(in) :: c(3, ncoefficient)
      integer, intent(in) :: n
      real(wp), intent(in) :: corner(2, 4), start(2), x(3)
      type(closest_type), intent(inout) :: closest
      real(wp) :: xi(2), r(3), r_new(3), step(2), g(2), h(3), decrease
      logical :: flat, exact
      integer :: i

      flat = all(abs(c(:, 4:)) <= 0.0_wp)
      xi = start
      if (any(abs(c(:, 5:)) > 0.0_wp)) call best_sample(c, n, corner, x, xi)
      r = x - facet_point_of(c, xi)
      do i = 1, most_iterations
         closest%iterations = i
         call slopes(c, xi, r, g, h, exact)
         if (.not. h(1) + h(3) > 0.0_wp) return
         call bounded_step(n, corner, xi, g, h, step)
         decrease = 1.0e-4_wp*dot_product(g, step)
         r_new = x - facet_point_of(c, xi + step)
         if (flat) then
            xi = xi + step
            r = r_new
            exit
         end if
         ! Where the distance only changes by rounding, the step is better than the distance.
         do while (dot_product(r_new, r_new) > (1.0_wp + rounding)*dot_product(r, r) + &
            & 2.0_wp*decrease)
            if (maxval(abs(step)) <= settled) exit
            step = 0.5_wp*step
            decrease = 0.5_wp*decrease
            r_new = x - facet_point_of(c, xi + step)
         end do
         xi = xi + step
         r = r_new
         if (maxval(abs(step)) <= merge(quadratic, settled, exact)) exit
      end do
      closest%xi = xi
      closest%point = x - r
      closest%distance2 = dot_product(r, r)
      call classify(c, n, corner, xi, r, closest)
   end subroutine minimise

   !> A curved facet can have several local minima: start half-way to the corner or edge that is
   !> nearest.
   pure subroutine best_sample(c, n, corner, x, xi)
      real(wp), intent(in) :: c(3, ncoefficient)
      integer, intent(in) :: n
      real(wp), intent(in) :: corner(2, 4), x(3)
      real(wp), intent(inout) :: xi(2)      !! in: the centre
      real(wp) :: at(2), centre(2), value, best
      integer :: k, next

      centre = xi
      best = sum((x - facet_point_of(c, xi))**2)
      do k = 1, 2*n
         next = 1 + mod(k - 1, n)
         at = corner(:, next)
         if (k > n) at = 0.5_wp*(at + corner(:, 1 + mod(next, n)))
         at = centre + merge(0.6_wp, 0.8_wp, k > n)*(at - centre)
         value = sum((x - facet_point_of(c, at))**2)
         if (value < best) then
            best = value
            xi = at
         end if
      end do
   end subroutine best_sample

   !> Gradient of half the squared distance, and a positive definite second derivative.
   pure subroutine slopes(c, xi, r, g, h, exact)
      real(wp), intent(in) :: c(3, ncoefficient), xi(2), r(3)
      real(wp), intent(out) :: g(2)
      real(wp), intent(out) :: h(3)     !! 11, 12, 22
      logical, intent(out) :: exact     !! h is the second derivative itself
      real(wp) :: t1(3), t2(3), x11(3), x12(3), x22(3), full(3), trace

      call facet_tangents(c, xi, t1, t2)
      call facet_seconds(c, xi, x11, x12, x22)
      g = -[dot_product(r, t1), dot_product(r, t2)]
      h = [dot_product(t1, t1), dot_product(t1, t2), dot_product(t2, t2)]
      full = h - [dot_product(r, x11), dot_product(r, x12), dot_product(r, x22)]
      trace = h(1) + h(3)
      exact = full(1) + full(3) > 0.0_wp .and. full(1)*full(3) - full(2)**2 &
         & > 1.0e-3_wp*(h(1)*h(3) - h(2)**2)
      if (exact) then
         h = full
      else
         h = made_positive(full, 1.0e-3_wp*trace)
      end if
   end subroutine slopes

   !> Symmetric 2 x 2 matrix with its eigenvalues replaced by their magnitude, at least `floor`.
   pure function made_positive(h, floor) result(positive)
      real(wp), intent(in) :: h(3)       !! 11, 12, 22
      real(wp), intent(in) :: floor      !! > 0
      real(wp) :: positive(3)
      real(wp) :: mean, half, radius, low, high, cosine, sine

      mean = 0.5_wp*(h(1) + h(3))
      half = 0.5_wp*(h(1) - h(3))
      radius = hypot(half, h(2))
      low = max(abs(mean - radius), floor)
      high = max(abs(mean + radius), floor)
      cosine = 1.0_wp
      sine = 0.0_wp
      if (radius > 0.0_wp) then
         cosine = half/radius
         sine = h(2)/radius
      end if
      mean = 0.5_wp*(low + high)
      half = 0.5_wp*(high - low)
      positive = [mean + half*cosine, half*sine, mean - half*cosine]
   end function made_positive

   !> Minimum of g.d + d.h.d/2 with xi + d in the convex polygon of the corners.
   !>
   !> If the free minimum is outside, the constrained one is on an edge that the free one violates.
   pure subroutine bounded_step(n, corner, xi, g, h, step)
      integer, intent(in) :: n
      real(wp), intent(in) :: corner(2, 4), xi(2), g(2), h(3)
      real(wp), intent(out) :: step(2)
      real(wp) :: free(2), e(2), d(2), hd(2), he(2), s, value, best, det
      integer :: k

      det = h(1)*h(3) - h(2)**2
      free = -[h(3)*g(1) - h(2)*g(2), h(1)*g(2) - h(2)*g(1)]/det
      step = free
      best = huge(1.0_wp)
      do k = 1, n
         e = corner(:, 1 + mod(k, n)) - corner(:, k)
         d = xi + free - corner(:, k)
         if (e(1)*d(2) - e(2)*d(1) >= 0.0_wp) cycle
         d = corner(:, k) - xi
         hd = [h(1)*d(1) + h(2)*d(2), h(2)*d(1) + h(3)*d(2)]
         he = [h(1)*e(1) + h(2)*e(2), h(2)*e(1) + h(3)*e(2)]
         s = -dot_product(e, g + hd)/dot_product(e, he)
         d = d + min(max(s, 0.0_wp), 1.0_wp)*e
         if (s >= 1.0_wp) d = corner(:, 1 + mod(k, n)) - xi
         hd = [h(1)*d(1) + h(2)*d(2), h(2)*d(1) + h(3)*d(2)]
         value = dot_product(g + 0.5_wp*hd, d)
         if (value < best) then
            best = value
            step = d
         end if
      end do
   end subroutine bounded_step

   !> A foot belongs to an edge only if x pulls it outward across that edge.
   pure subroutine classify(c, n, corner, xi, r, closest)
      real(wp), intent(in) :: c(3, ncoefficient)
      integer, intent(in) :: n
      real(wp), intent(in) :: corner(2, 4), xi(2), r(3)
      type(closest_type), intent(inout) :: closest
      real(wp) :: t1(3), t2(3), g(2), e(2), out(2), scale
      integer :: k, active(4), m

      closest%place = place%inside
      m = 0
      do k = 1, n
         e = corner(:, 1 + mod(k, n)) - corner(:, k)
         if (abs(e(1)*(xi(2) - corner(2, k)) - e(2)*(xi(1) - corner(1, k))) > 1.0e-12_wp) cycle
         m = m + 1
         active(m) = k
      end do
      if (m == 0) return
      call facet_tangents(c, xi, t1, t2)
      g = [dot_product(r, t1), dot_product(r, t2)]
      scale = pushing*max(dot_product(t1, t1), dot_product(t2, t2))
      do k = 1, m
         e = corner(:, 1 + mod(active(k), n)) - corner(:, active(k))
         out = [e(2), -e(1)]
         if (dot_product(out, g) <= scale) cycle
         if (closest%place == place%inside) then
            closest%place = place%edge
            closest%feature = active(k)
         end if
      end do
      ! At a corner the pull must not be along one of the edges only.
      if (closest%place == place%edge .and. m >= 2) then
         call corner_of_edges(n, active(:2), k)
         e = corner(:, 1 + mod(k, n)) - corner(:, k)
         out = corner(:, k) - corner(:, 1 + modulo(k - 2, n))
         if (dot_product(g, e) < -scale .and. dot_product(g, out) > scale) then
            closest%place = place%vertex
            closest%feature = k
         end if
      end if
   end subroutine classify

   !> The corner that two edges share.
   pure subroutine corner_of_edges(n, edge, corner)
      integer, intent(in) :: n, edge(2)
      integer, intent(out) :: corner

      corner = maxval(edge)
      if (minval(edge) == 1 .and. maxval(edge) == n .and. n > 2) corner = 1
   end subroutine corner_of_edges

   !> Unit outward normal of a facet; zero where the facet is degenerate.
   pure function facet_unit_normal(c, family, xi) result(n)
      real(wp), intent(in) :: c(3, ncoefficient)
      integer, intent(in) :: family
      real(wp), intent(in) :: xi(2)
      real(wp) :: n(3), t1(3), t2(3), length

      call facet_tangents(c, xi, t1, t2)
      if (family == cell_family%line) t2 = [0.0_wp, 0.0_wp, 1.0_wp]
      n = cross(t1, t2)
      length = norm2(n)
      if (length > 0.0_wp) n = n/length
   end function facet_unit_normal

   !> Covariant metric and curvature of a facet, for the variation of the projection.
   pure subroutine facet_metric(c, family, xi, tangent, metric, curvature)
      real(wp), intent(in) :: c(3, ncoefficient)
      integer, intent(in) :: family
      real(wp), intent(in) :: xi(2)
      real(wp), intent(out) :: tangent(3, 2) !! by xi and eta; the second is 0 on lines [length]
      real(wp), intent(out) :: metric(2, 2)       !! tangent.tangent [length^2]
      real(wp), intent(out) :: curvature(2, 2)    !! n.x,ab [length]
      real(wp) :: x11(3), x12(3), x22(3), n(3)

      call facet_tangents(c, xi, tangent(:, 1), tangent(:, 2))
      if (family == cell_family%line) tangent(:, 2) = 0.0_wp
      call facet_seconds(c, xi, x11, x12, x22)
      n = facet_unit_normal(c, family, xi)
      metric = matmul(transpose(tangent), tangent)
      curvature(:, 1) = [dot_product(n, x11), dot_product(n, x12)]
      curvature(:, 2) = [dot_product(n, x12), dot_product(n, x22)]
      if (family == cell_family%line) curvature(:, 2) = 0.0_wp
      if (family == cell_family%line) curvature(2, 1) = 0.0_wp
   end subroutine facet_metric
end module lopin_projection
