!> Gauss rules by cell family and degree of exactness; every weight is positive.
!>
!> Tensor families (line, quad, hexahedron) are exact in each direction; layered ones have more
!> points in one. Simplices use symmetric
!> rules up to degree 5 and a collapsed product beyond. Weights sum to the parametric volume of the
!> cell.
module lopin_quadrature
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   implicit none
   private
   public :: rule_type, new_rule, new_layered_rule, points_in_half, calculix_order

   type :: rule_type
      integer :: npoint = 0
      real(wp), allocatable :: xi(:, :)     !! (ndim, npoint) parametric points
      real(wp), allocatable :: weight(:)    !! (npoint) > 0
   end type rule_type

contains

   !> The cheapest rule that integrates polynomials of a degree.
   pure subroutine new_rule(self, family, degree, through)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: family              !! one of cell_family
      integer, intent(in) :: degree              !! >= 0
      integer, intent(in), optional :: through   !! wedge: degree along its axis, else as `degree`
      type(rule_type) :: line, triangle
      integer :: along

      select case (family)
      case (cell_family%line)
         call new_product(self, 1, degree)
      case (cell_family%quad)
         call new_product(self, 2, degree)
      case (cell_family%hexahedron)
         call new_product(self, 3, degree)
      case (cell_family%triangle)
         call new_triangle(self, degree)
      case (cell_family%tetra)
         call new_tetra(self, degree)
      case (cell_family%wedge)
         along = degree
         if (present(through)) along = through
         call new_triangle(triangle, degree)
         call new_product(line, 1, along)
         call cross(self, triangle, line)
      end select
   end subroutine new_rule

   !> As `new_rule` for quads and hexahedra, but with Gauss points in each half of some directions:
   !> a stress that jumps near the middle of a sheet, as where it is bent plastically, is integrated
   !> to a per cent in the plane, to three in space. A sheet of several layers needs fewer in each.
   pure subroutine new_layered_rule(self, family, degree, layers)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: family      !! quad or hexahedron
      integer, intent(in) :: degree      !! of the other directions
      integer, intent(in) :: layers(:)   !! (3) of the sheet along each direction; 0: no sheet
      type(rule_type) :: along, halves, part
      integer :: d, ndim

      ndim = merge(2, 3, family == cell_family%quad)
      call new_product(along, 1, degree)
      do d = 1, ndim
         part = along
         if (layers(d) > 0) then
            call new_halves(halves, points_in_half(ndim, layers(d)))
            part = halves
         end if
         if (d == 1) then
            self = part
         else
            call cross(self, rule_type(self%npoint, self%xi, self%weight), part)
         end if
      end do
   end subroutine new_layered_rule

   !> Of each element of a sheet of so many layers, in half its thickness; 0: of so many layers the
   !> usual points do.
   pure integer function points_in_half(ndim, layers) result(n)
      integer, intent(in) :: ndim, layers
      integer, parameter :: plane(3) = [5, 3, 3], space(2) = [3, 2]

      n = 0
      if (ndim == 2 .and. layers <= size(plane)) n = plane(layers)
      if (ndim == 3 .and. layers <= size(space)) n = space(layers)
   end function points_in_half

   !> Gauss points in each half of [-1, 1].
   pure subroutine new_halves(self, n)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: n                 !! in each half
      real(wp) :: x(n), w(n)

      call gauss_line(n, x, w)
      self%npoint = 2*n
      self%xi = reshape(0.5_wp*[x - 1.0_wp, x + 1.0_wp], [1, 2*n])
      self%weight = 0.5_wp*[w, w]
   end subroutine new_halves

   !> Gauss-Legendre points on [-1, 1]: Newton on the Legendre polynomial.
   pure subroutine gauss_line(n, x, w)
      integer, intent(in) :: n         !! number of points, >= 1
      real(wp), intent(out) :: x(n)    !! increasing
      real(wp), intent(out) :: w(n)
      real(wp), parameter :: pi = acos(-1.0_wp)
      real(wp) :: z, p, previous, older, slope
      integer :: i, k, sweep

      do i = 1, n
         z = -cos(pi*(real(i, wp) - 0.25_wp)/(real(n, wp) + 0.5_wp))
         do sweep = 1, 100
            p = z
            previous = 1.0_wp
            do k = 2, n
               older = previous
               previous = p
               p = (real(2*k - 1, wp)*z*previous - real(k - 1, wp)*older)/real(k, wp)
            end do
            slope = real(n, wp)*(z*p - previous)/(z*z - 1.0_wp)
            z = z - p/slope
            if (abs(p/slope) < 4.0_wp*epsilon(1.0_wp)) exit
         end do
         if (2*i == n + 1) z = 0.0_wp
         x(i) = z
         w(i) = 2.0_wp/((1.0_wp - z*z)*slope**2)
      end do
      w = w*2.0_wp/sum(w)
   end subroutine gauss_line

   !> The first parametric direction runs fastest.
   pure subroutine new_product(self, ndim, degree)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: ndim, degree
      type(rule_type) :: line, square
      integer :: n

      n = degree/2 + 1
      line%npoint = n
      allocate (line%xi(1, n), line%weight(n))
      call gauss_line(n, line%xi(1, :), line%weight)
      self = line
      if (ndim >= 2) call cross(self, line, line)
      if (ndim == 3) then
         square = self
         call cross(self, square, line)
      end if
   end subroutine new_product

   !> All points of `a` for each point of `b`.
   pure subroutine cross(self, a, b)
      type(rule_type), intent(out) :: self
      type(rule_type), intent(in) :: a, b
      integer :: i, j, k, da, db

      da = size(a%xi, 1)
      db = size(b%xi, 1)
      self%npoint = a%npoint*b%npoint
      allocate (self%xi(da + db, self%npoint), self%weight(self%npoint))
      k = 0
      do j = 1, b%npoint
         do i = 1, a%npoint
            k = k + 1
            self%xi(:da, k) = a%xi(:, i)
            self%xi(da + 1:, k) = b%xi(:, j)
            self%weight(k) = a%weight(i)*b%weight(j)
         end do
      end do
   end subroutine cross

   !> Strang and Fix (3 points), Dunavant (6, 7), then a collapsed square.
   pure subroutine new_triangle(self, degree)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: degree
      real(wp), parameter :: root = sqrt(15.0_wp)
      real(wp), parameter :: a4(2) = [0.44594849091596488632_wp, 0.09157621350977074346_wp]
      real(wp), parameter :: w4(2) = 0.5_wp*[0.22338158967801146570_wp, 0.10995174365532186764_wp]
      real(wp), parameter :: a5(2) = [6.0_wp - root, 6.0_wp + root]/21.0_wp
      real(wp), parameter :: w5(2) = [155.0_wp - root, 155.0_wp + root]/2400.0_wp
      real(wp), parameter :: third = 1.0_wp/3.0_wp

      select case (degree)
      case (:1)
         call set(self, reshape([third, third], [2, 1]), [0.5_wp])
      case (2)
         call set(self, orbit(1.0_wp/6.0_wp), spread(1.0_wp/6.0_wp, 1, 3))
      case (3:4)
         call set(self, reshape([orbit(a4(1)), orbit(a4(2))], [2, 6]), &
            & [spread(w4(1), 1, 3), spread(w4(2), 1, 3)])
      case (5)
         call set(self, reshape([third, third, orbit(a5(1)), orbit(a5(2))], [2, 7]), &
            & [9.0_wp/80.0_wp, spread(w5(1), 1, 3), spread(w5(2), 1, 3)])
      case default
         call new_collapsed(self, 2, degree)
      end select

   contains

      !> The three points with two barycentric coordinates equal to a.
      pure function orbit(a) result(xi)
         real(wp), intent(in) :: a
         real(wp) :: xi(2, 3)
         xi = reshape([a, a, 1.0_wp - 2.0_wp*a, a, a, 1.0_wp - 2.0_wp*a], [2, 3])
      end function orbit
   end subroutine new_triangle

   !> One point, four points, Walkington's 14 points (degree 5), then a collapsed cube.
   pure subroutine new_tetra(self, degree)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: degree
      real(wp), parameter :: a2 = (5.0_wp - sqrt(5.0_wp))/20.0_wp
      real(wp), parameter :: a5(2) = [0.31088591926330060980_wp, 0.09273525031089122640_wp]
      real(wp), parameter :: w5(3) = [0.11268792571801585080_wp, 0.07349304311636194954_wp, &
         & 0.04254602077708146644_wp]/6.0_wp
      real(wp), parameter :: c = 0.04550370412564964949_wp, d = 0.5_wp - c

      select case (degree)
      case (:1)
         call set(self, reshape([0.25_wp, 0.25_wp, 0.25_wp], [3, 1]), [1.0_wp/6.0_wp])
      case (2)
         call set(self, orbit(a2), spread(1.0_wp/24.0_wp, 1, 4))
      case (3:5)
         call set(self, reshape([orbit(a5(1)), orbit(a5(2)), c, c, d, c, d, c, d, c, c, &
            & d, d, c, d, c, d, c, d, d], [3, 14]), &
            & [spread(w5(1), 1, 4), spread(w5(2), 1, 4), spread(w5(3), 1, 6)])
      case default
         call new_collapsed(self, 3, degree)
      end select

   contains

      !> The four points with three barycentric coordinates equal to a.
      pure function orbit(a) result(xi)
         real(wp), intent(in) :: a
         real(wp) :: xi(3, 4), b
         b = 1.0_wp - 3.0_wp*a
         xi = reshape([a, a, a, b, a, a, a, b, a, a, a, b], [3, 4])
      end function orbit
   end subroutine new_tetra

   !> Product rule on the square or cube, folded onto the simplex (Duffy): any degree.
   pure subroutine new_collapsed(self, ndim, degree)
      type(rule_type), intent(out) :: self
      integer, intent(in) :: ndim, degree
      real(wp) :: u(ndim)
      integer :: k

      call new_product(self, ndim, degree + ndim - 1)
      do k = 1, self%npoint
         u = 0.5_wp*(1.0_wp + self%xi(:, k))
         self%weight(k) = self%weight(k)*0.5_wp**ndim*(1.0_wp - u(1))**(ndim - 1)
         self%xi(1, k) = u(1)
         self%xi(2, k) = u(2)*(1.0_wp - u(1))
         if (ndim == 3) then
            self%weight(k) = self%weight(k)*(1.0_wp - u(2))
            self%xi(3, k) = u(3)*(1.0_wp - u(1))*(1.0_wp - u(2))
         end if
      end do
   end subroutine new_collapsed

   pure subroutine set(self, xi, weight)
      type(rule_type), intent(inout) :: self
      real(wp), intent(in) :: xi(:, :), weight(:)
      self%npoint = size(weight)
      self%xi = xi
      self%weight = weight
   end subroutine set

   !> CalculiX counts points with the first coordinate fastest and the last slowest, in every cell.
   pure function calculix_order(xi) result(order)
      real(wp), intent(in) :: xi(:, :)       !! (ndim, npoint)
      integer :: order(size(xi, 2))
      real(wp), parameter :: same = 1.0e-6_wp
      integer :: i, j, held

      order = [(i, i=1, size(order))]
      do i = 2, size(order)
         held = order(i)
         j = i
         do while (j > 1)
            if (.not. before(xi(:, held), xi(:, order(j - 1)))) exit
            order(j) = order(j - 1)
            j = j - 1
         end do
         order(j) = held
      end do
   contains
      pure logical function before(a, b)
         real(wp), intent(in) :: a(:), b(:)
         integer :: k

         before = .false.
         do k = size(a), 1, -1
            if (abs(a(k) - b(k)) <= same) cycle
            before = a(k) < b(k)
            return
         end do
      end function before
   end function calculix_order
end module lopin_quadrature
