!> One slave facet over one master facet in the plane: the segment both share, and its integrals.
!>
!> Both sides are projected along one field, the slave's nodal normals interpolated on its facet, so
!> that neighbouring facets neither gap nor overlap (Yang, Laursen, Meng 2005). Everything is in
!> dual numbers: slopes with respect to slave places, slave normals and master places come out with
!> the values, the moving ends of the segment included. For values alone pass constants.
module lopin_mortar_cells_2d
   use lopin_kinds, only : wp
   use lopin_mortar_overlap, only : least_type, meet_point
   use lopin_dual, only : dual_type, constant, operator(+), operator(-), operator(*), operator(/), &
      & sqrt, assignment(=)
   implicit none
   private
   public :: segment_type, integrate_segment, find_least, slave_parameter, master_parameter, &
      & line_shape

   !> Integrals over a segment; weight: thickness, or 2 pi r.
   type :: segment_type
      logical :: overlaps = .false.
      type(dual_type) :: from, to        !! slave parameters of its ends
      type(dual_type) :: me(3, 3)        !! integral of N_j N_k [area]
      type(dual_type) :: d(3)            !! integral of N_j [area]
      type(dual_type) :: b(3, 3)         !! integral of N_j N_l of the master [area]
      type(dual_type) :: gap(3)          !! integral of N_j gap [area length]
      type(dual_type) :: area            !! [area]
      type(least_type) :: least          !! by find_least
   end type segment_type

   !> What a length along the facet is worth.
   type :: line_measure_type
      logical :: axisymmetric = .false.
      real(wp) :: thickness = 1.0_wp     !! not read if axisymmetric [length]
      real(wp) :: radius = 0.0_wp        !! of the origin of the coordinates [length]
   end type line_measure_type

   real(wp), parameter :: pi = acos(-1.0_wp)
   !> Shorter segments, in the slave's parameter, are rounding.
   real(wp), parameter :: shortest = 1.0e-12_wp
   integer, parameter :: most_steps = 60

   real(wp), parameter :: gauss3(2, 3) = reshape([ &
      & -sqrt(0.6_wp), 5.0_wp/9.0_wp, 0.0_wp, 8.0_wp/9.0_wp, sqrt(0.6_wp), 5.0_wp/9.0_wp], [2, 3])
   real(wp), parameter :: near = sqrt(5.0_wp - 2.0_wp*sqrt(10.0_wp/7.0_wp))/3.0_wp
   real(wp), parameter :: far = sqrt(5.0_wp + 2.0_wp*sqrt(10.0_wp/7.0_wp))/3.0_wp
   real(wp), parameter :: of_near = (322.0_wp + 13.0_wp*sqrt(70.0_wp))/900.0_wp
   real(wp), parameter :: of_far = (322.0_wp - 13.0_wp*sqrt(70.0_wp))/900.0_wp
   real(wp), parameter :: gauss5(2, 5) = reshape([-far, of_far, -near, of_near, 0.0_wp, &
      & 128.0_wp/225.0_wp, near, of_near, far, of_far], [2, 5])

contains

   !> The segment of two facets; `overlaps` is false where they share none.
   pure subroutine integrate_segment(slave, normal, master, axisymmetric, thickness, segment)
      type(dual_type), intent(in) :: slave(:, :)    !! (2, 2 or 3) its nodes [length]
      type(dual_type), intent(in) :: normal(:, :)   !! (2, the same) slave's outward unit normals
      type(dual_type), intent(in) :: master(:, :)   !! (2, 2 or 3) its nodes [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness             !! not read if axisymmetric [length]
      type(segment_type), intent(out) :: segment
      type(dual_type) :: x(2, size(slave, 2)), y(2, size(master, 2)), half, middle
      type(line_measure_type) :: measure
      real(wp) :: origin(2)
      integer :: k

      ! About a node of the slave: gaps do not lose the digits of far coordinates.
      origin = slave(:, 1)%v
      do k = 1, 2
         x(k, :) = slave(k, :) - origin(k)
         y(k, :) = master(k, :) - origin(k)
      end do
      ! The master runs the other way: its second node is the first met.
      call slave_parameter(x, normal, y(:, 2), segment%from)
      call slave_parameter(x, normal, y(:, 1), segment%to)
      if (.not. segment%to%v - segment%from%v > shortest) return
      segment%overlaps = .true.
      measure = line_measure_type(axisymmetric, thickness, origin(1))
      half = 0.5_wp*(segment%to - segment%from)
      middle = 0.5_wp*(segment%to + segment%from)
      if (size(x, 2) > 2 .or. size(y, 2) > 2) then
         do k = 1, 5
            call add_point(x, normal, y, measure, middle + half*gauss5(1, k), &
               & half*gauss5(2, k), segment)
         end do
      else
         do k = 1, 3
            call add_point(x, normal, y, measure, middle + half*gauss3(1, k), &
               & half*gauss3(2, k), segment)
         end do
      end if
   end subroutine integrate_segment

   !> The least gap of a segment: between straight facets it is at one of its ends. Along the normal
   !> of the master: the slave's lean where it turns away, and what they order differs.
   pure subroutine find_least(slave, normal, master, segment)
      real(wp), intent(in) :: slave(:, :)           !! (2, 2 or 3) its nodes [length]
      real(wp), intent(in) :: normal(:, :)          !! (2, the same) slave's outward unit normals
      real(wp), intent(in) :: master(:, :)          !! (2, 2 or 3) its nodes [length]
      type(segment_type), intent(inout) :: segment
      real(wp) :: x(2, size(slave, 2)), y(2, size(master, 2))
      real(wp) :: n(3), m(3), slope(3), place(2), nu(2), way(2), along(2), xi
      integer :: k, parts

      x = slave - spread(slave(:, 1), 2, size(x, 2))
      y = master - spread(slave(:, 1), 2, size(y, 2))
      parts = merge(4, 1, size(x, 2) > 2 .or. size(y, 2) > 2)
      do k = 0, parts
         xi = segment%from%v + (segment%to%v - segment%from%v)*real(k, wp)/real(parts, wp)
         call line_values(size(x, 2), xi, n, slope)
         place = matmul(x, n(:size(x, 2)))
         nu = matmul(normal, n(:size(x, 2)))
         call line_values(size(y, 2), master_value(place, nu, y), m, slope)
         way = matmul(y, m(:size(y, 2))) - place
         along = matmul(y, slope(:size(y, 2)))
         call meet_point(segment%least, sign((way(1)*along(2) - way(2)*along(1))/norm2(along), &
            & dot_product(way, nu)), n, m)
      end do
   end subroutine find_least

   !> Add one integration point.
   pure subroutine add_point(x, normal, y, measure, xi, weight, segment)
      type(dual_type), intent(in) :: x(:, :), normal(:, :), y(:, :), xi, weight
      type(line_measure_type), intent(in) :: measure
      type(segment_type), intent(inout) :: segment
      type(dual_type) :: n(3), dn(3), m(3), dm(3), place(2), tangent(2), nu(2), opposite(2), eta, &
         & area, share, gap
      integer :: j, k

      call line_shape(size(x, 2), xi, n, dn)
      place = combine(x, n)
      tangent = combine(x, dn)
      nu = combine(normal, n)
      call master_parameter(place, nu, y, eta)
      call line_shape(size(y, 2), eta, m, dm)
      opposite = combine(y, m) - place
      gap = (opposite(1)*nu(1) + opposite(2)*nu(2))/sqrt(nu(1)*nu(1) + nu(2)*nu(2))
      area = weight*sqrt(tangent(1)*tangent(1) + tangent(2)*tangent(2))
      if (measure%axisymmetric) then
         area = area*(place(1) + measure%radius)*(2.0_wp*pi)
      else
         area = area*measure%thickness
      end if
      segment%area = segment%area + area
      do j = 1, size(x, 2)
         share = area*n(j)
         segment%d(j) = segment%d(j) + share
         segment%gap(j) = segment%gap(j) + share*gap
         do k = j, size(x, 2)
            segment%me(j, k) = segment%me(j, k) + share*n(k)
            segment%me(k, j) = segment%me(j, k)
         end do
         do k = 1, size(y, 2)
            segment%b(j, k) = segment%b(j, k) + share*m(k)
         end do
      end do
   end subroutine add_point

   !> Shape functions of line2 and line3 and their slopes; zeros behind the last.
   pure subroutine line_shape(nnode, xi, n, dn)
      integer, intent(in) :: nnode       !! 2 or 3
      type(dual_type), intent(in) :: xi
      type(dual_type), intent(out) :: n(3), dn(3)

      if (nnode == 2) then
         n(1) = 0.5_wp*(1.0_wp - xi)
         n(2) = 0.5_wp*(1.0_wp + xi)
         dn(1) = constant(-0.5_wp)
         dn(2) = constant(0.5_wp)
      else
         n(1) = 0.5_wp*xi*(xi - 1.0_wp)
         n(2) = 0.5_wp*xi*(xi + 1.0_wp)
         n(3) = 1.0_wp - xi*xi
         dn(1) = xi - 0.5_wp
         dn(2) = xi + 0.5_wp
         dn(3) = -2.0_wp*xi
      end if
   end subroutine line_shape

   pure function combine(x, n) result(sum_)
      type(dual_type), intent(in) :: x(:, :), n(:)
      type(dual_type) :: sum_(2)
      integer :: k

      do k = 1, size(x, 2)
         sum_ = sum_ + x(:, k)*n(k)
      end do
   end function combine

   !> Where the slave's normal passes through a point: its parameter, kept within the facet.
   !>
   !> An end of the facet that cuts the segment off does not move along it: slope 0.
   pure subroutine slave_parameter(x, normal, point, xi)
      type(dual_type), intent(in) :: x(:, :), normal(:, :), point(2)
      type(dual_type), intent(out) :: xi
      type(dual_type) :: ahead, slope
      real(wp) :: place(2, size(x, 2)), nu(2, size(x, 2)), low, high, at, before, size2, way, turn
      integer :: step

      place = x%v
      nu = normal%v
      size2 = sum((place(:, 2) - place(:, 1))**2)
      low = -1.0_wp
      high = 1.0_wp
      xi = constant(low)
      call offset_value(place, nu, point%v, low, way, turn)
      if (way <= 0.0_wp) return
      xi = constant(high)
      call offset_value(place, nu, point%v, high, way, turn)
      if (way >= 0.0_wp) return
      at = 0.0_wp
      do step = 1, most_steps
         call offset_value(place, nu, point%v, at, way, turn)
         if (way > 0.0_wp) low = at
         if (way <= 0.0_wp) high = at
         if (abs(way) <= 4.0_wp*epsilon(1.0_wp)*sqrt(size2)) exit
         before = at
         if (turn < 0.0_wp) at = at - way/turn
         if (.not. (turn < 0.0_wp .and. at > low .and. at < high)) at = 0.5_wp*(low + high)
         if (high - low <= epsilon(1.0_wp) .or. abs(at - before) <= epsilon(1.0_wp)) exit
      end do
      ! One more step in dual numbers: the slopes of the implicit function.
      xi = constant(at)
      call offset(x, normal, point, xi, ahead, slope)
      if (abs(slope%v) > 0.0_wp) xi = xi - ahead/slope%v
   end subroutine slave_parameter

   !> `line_shape` in plain numbers.
   pure subroutine line_values(nnode, xi, n, dn)
      integer, intent(in) :: nnode       !! 2 or 3
      real(wp), intent(in) :: xi
      real(wp), intent(out) :: n(3), dn(3)

      if (nnode == 2) then
         n = [0.5_wp*(1.0_wp - xi), 0.5_wp*(1.0_wp + xi), 0.0_wp]
         dn = [-0.5_wp, 0.5_wp, 0.0_wp]
      else
         n = [0.5_wp*xi*(xi - 1.0_wp), 0.5_wp*xi*(xi + 1.0_wp), 1.0_wp - xi*xi]
         dn = [xi - 0.5_wp, xi + 0.5_wp, -2.0_wp*xi]
      end if
   end subroutine line_values

   !> `offset` in plain numbers.
   pure subroutine offset_value(x, normal, point, xi, ahead, slope)
      real(wp), intent(in) :: x(:, :), normal(:, :), point(2), xi
      real(wp), intent(out) :: ahead, slope
      real(wp) :: n(3), dn(3), way(2), nu(2), turn(2), tangent(2)
      integer :: m

      m = size(x, 2)
      call line_values(m, xi, n, dn)
      way = point - matmul(x, n(:m))
      tangent = matmul(x, dn(:m))
      nu = matmul(normal, n(:m))
      turn = matmul(normal, dn(:m))
      ahead = way(2)*nu(1) - way(1)*nu(2)
      slope = tangent(1)*nu(2) - tangent(2)*nu(1) + way(2)*turn(1) - way(1)*turn(2)
   end subroutine offset_value

   !> How far a point is ahead of the normal at a parameter, and the slope of that by the parameter.
   pure subroutine offset(x, normal, point, xi, ahead, slope)
      type(dual_type), intent(in) :: x(:, :), normal(:, :), point(2), xi
      type(dual_type), intent(out) :: ahead, slope
      type(dual_type) :: n(3), dn(3), way(2), nu(2), turn(2), tangent(2)

      call line_shape(size(x, 2), xi, n, dn)
      way = point - combine(x, n)
      tangent = combine(x, dn)
      nu = combine(normal, n)
      turn = combine(normal, dn)
      ahead = way(2)*nu(1) - way(1)*nu(2)
      slope = tangent(1)*nu(2) - tangent(2)*nu(1) + way(2)*turn(1) - way(1)*turn(2)
   end subroutine offset

   !> Where the ray from a place along a direction meets the master.
   pure subroutine master_parameter(place, direction, y, eta)
      type(dual_type), intent(in) :: place(2), direction(2), y(:, :)
      type(dual_type), intent(out) :: eta
      type(dual_type) :: m(3), dm(3), way(2), tangent(2), aside, slope

      eta = constant(master_value(place%v, direction%v, y%v))
      call line_shape(size(y, 2), eta, m, dm)
      way = combine(y, m) - place
      tangent = combine(y, dm)
      aside = way(1)*direction(2) - way(2)*direction(1)
      slope = tangent(1)*direction(2) - tangent(2)*direction(1)
      ! At the root a step in dual numbers gives the slopes of the implicit function.
      if (abs(slope%v) > 0.0_wp) eta = eta - aside/slope%v
   end subroutine master_parameter

   !> `master_parameter` in plain numbers.
   pure real(wp) function master_value(place, direction, y) result(eta)
      real(wp), intent(in) :: place(2), direction(2), y(:, :)
      real(wp) :: m(3), dm(3), way(2), tangent(2), aside, slope
      integer :: step, k

      k = size(y, 2)
      eta = 0.0_wp
      do step = 1, most_steps
         call line_values(k, eta, m, dm)
         way = matmul(y, m(:k)) - place
         tangent = matmul(y, dm(:k))
         aside = way(1)*direction(2) - way(2)*direction(1)
         slope = tangent(1)*direction(2) - tangent(2)*direction(1)
         if (.not. abs(slope) > 0.0_wp) return
         eta = eta - aside/slope
         if (step > 1 .and. abs(aside) <= 1.0e-15_wp*abs(slope)) exit
         if (abs(eta) > 3.0_wp) eta = sign(1.0_wp, eta)
      end do
   end function master_value
end module lopin_mortar_cells_2d
