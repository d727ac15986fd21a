!> Facets as polynomials: all six cells in one list of monomials, with two derivatives.
!>
!> x(xi, eta) = sum_k c(:, k) m_k,   m = 1, xi, eta, xi eta, xi^2, eta^2, xi^2 eta, xi eta^2,
!> xi^3 (the last only on smoothed lines).
!> The closest-point iterations work on the coefficients c; shape functions are needed only at its
!> end.
module lopin_facet_basis
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, new_cell_of
   implicit none
   private
   public :: facet_basis_type, new_facet_basis, coefficients_of, shape_values, shape_derivatives
   public :: facet_point_of, facet_tangents, facet_seconds, ncoefficient, nfacet_cell, &
      & monomial_derivatives

   integer, parameter :: ncoefficient = 9
   integer, parameter :: nfacet_cell = 6   !! line2, line3, triangle, triangle6, quad, quad8

   !> Tables of the six facet cells, indexed by cell id.
   type :: facet_basis_type
      integer :: family(nfacet_cell) = 0
      integer :: nnode(nfacet_cell) = 0
      integer :: ncorner(nfacet_cell) = 0
      real(wp) :: xi(2, 8, nfacet_cell) = 0.0_wp                       !! places of the nodes
      real(wp) :: centre(2, nfacet_cell) = 0.0_wp
      real(wp) :: transform(ncoefficient, 8, nfacet_cell) = &
         & 0.0_wp     !! N_i = sum_k transform(k, i) m_k
   end type facet_basis_type

contains

   !> Tables of the six facet cells.
   pure subroutine new_facet_basis(self)
      type(facet_basis_type), intent(out) :: self
      integer, parameter :: used(8, nfacet_cell) = reshape([ &
         & 1, 2, 0, 0, 0, 0, 0, 0, &
         & 1, 2, 5, 0, 0, 0, 0, 0, &
         & 1, 2, 3, 0, 0, 0, 0, 0, &
         & 1, 2, 3, 4, 5, 6, 0, 0, &
         & 1, 2, 3, 4, 0, 0, 0, 0, &
         & 1, 2, 3, 4, 5, 6, 7, 8], [8, nfacet_cell])
      type(cell_type) :: cell
      real(wp) :: values(8, 8), m(ncoefficient)
      integer :: id, i, n

      do id = 1, nfacet_cell
         call new_cell_of(cell, id)
         n = cell%nnode
         self%family(id) = cell%family
         self%nnode(id) = n
         self%ncorner(id) = cell%ncorner
         self%xi(:cell%ndim, :n, id) = cell%xi(:cell%ndim, :n)
         self%centre(:cell%ndim, id) = sum(cell%xi(:cell%ndim, :cell%ncorner), &
            & dim=2)/real(cell%ncorner, wp)
         do i = 1, n
            m = monomials(self%xi(:, i, id))
            values(i, :n) = m(used(:n, id))
         end do
         self%transform(used(:n, id), :n, id) = inverse(values(:n, :n))
      end do
   end subroutine new_facet_basis

   pure function monomials(xi) result(m)
      real(wp), intent(in) :: xi(2)
      real(wp) :: m(ncoefficient)

      m = [1.0_wp, xi(1), xi(2), xi(1)*xi(2), xi(1)**2, xi(2)**2, xi(1)**2*xi(2), xi(1)*xi(2)**2, &
         & xi(1)**3]
   end function monomials

   !> Gauss-Jordan with column pivots: small matrices of small integers and halves.
   pure function inverse(matrix) result(b)
      real(wp), intent(in) :: matrix(:, :)
      real(wp) :: b(size(matrix, 1), size(matrix, 1))
      real(wp) :: a(size(matrix, 1), size(matrix, 1)), row(size(matrix, 1))
      integer :: i, k, p, n

      n = size(matrix, 1)
      a = matrix
      b = 0.0_wp
      do i = 1, n
         b(i, i) = 1.0_wp
      end do
      do k = 1, n
         p = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         row = a(p, :)
         a(p, :) = a(k, :)
         a(k, :) = row/row(k)
         row = b(p, :)/row(k)
         b(p, :) = b(k, :)
         b(k, :) = row
         do i = 1, n
            if (i == k) cycle
            b(i, :) = b(i, :) - a(i, k)*b(k, :)
            a(i, :) = a(i, :) - a(i, k)*a(k, :)
         end do
      end do
   end function inverse

   !> Coefficients of a facet from its nodes; in the plane the third component is 0.
   pure function coefficients_of(self, cell, x) result(c)
      type(facet_basis_type), intent(in) :: self
      integer, intent(in) :: cell              !! cell id, 1..6
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp) :: c(3, ncoefficient)
      integer :: i, k

      c = 0.0_wp
      do i = 1, self%nnode(cell)
         do k = 1, ncoefficient
            if (.not. abs(self%transform(k, i, cell)) > 0.0_wp) cycle
            c(:size(x, 1), k) = c(:size(x, 1), k) + self%transform(k, i, cell)*x(:, i)
         end do
      end do
   end function coefficients_of

   !> Shape functions at a point; zeros behind the last node.
   pure function shape_values(self, cell, xi) result(n)
      type(facet_basis_type), intent(in) :: self
      integer, intent(in) :: cell
      real(wp), intent(in) :: xi(2)
      real(wp) :: n(8), m(ncoefficient)
      integer :: i

      m = monomials(xi)
      do i = 1, 8
         n(i) = dot_product(m, self%transform(:, i, cell))
      end do
   end function shape_values

   !> Shape functions with their first and second derivatives; zeros behind the last node.
   pure subroutine shape_derivatives(self, cell, xi, n)
      type(facet_basis_type), intent(in) :: self
      integer, intent(in) :: cell
      real(wp), intent(in) :: xi(2)
      real(wp), intent(out) :: n(8, 6)   !! values, slopes by xi, eta, then xi xi, xi eta, eta eta
      real(wp) :: m(ncoefficient, 6)
      integer :: i, k

      m = monomial_derivatives(xi)
      do i = 1, 8
         associate (t => self%transform(:, i, cell))
            do k = 1, 6
               n(i, k) = dot_product(m(:, k), t)
            end do
         end associate
      end do
   end subroutine shape_derivatives

   !> The monomials, and their derivatives by xi, eta, xi xi, xi eta, eta eta.
   pure function monomial_derivatives(xi) result(m)
      real(wp), intent(in) :: xi(2)
      real(wp) :: m(ncoefficient, 6)
      real(wp), parameter :: o = 0.0_wp, two = 2.0_wp

      associate (a => xi(1), b => xi(2))
         m(:, 1) = monomials(xi)
         m(:, 2) = [o, 1.0_wp, o, b, two*a, o, two*a*b, b**2, 3.0_wp*a**2]
         m(:, 3) = [o, o, 1.0_wp, a, o, two*b, a**2, two*a*b, o]
         m(:, 4) = [o, o, o, o, two, o, two*b, o, 6.0_wp*a]
         m(:, 5) = [o, o, o, 1.0_wp, o, o, two*a, two*b, o]
         m(:, 6) = [o, o, o, o, o, two, o, two*a, o]
      end associate
   end function monomial_derivatives

   !> Place of a facet at reference coordinates [length].
   pure function facet_point_of(c, xi) result(x)
      real(wp), intent(in) :: c(3, ncoefficient)
      real(wp), intent(in) :: xi(2)
      real(wp) :: x(3)

      x = c(:, 1) + xi(1)*(c(:, 2) + xi(1)*(c(:, 5) + xi(2)*c(:, 7) + xi(1)*c(:, 9))) &
         & + xi(2)*(c(:, 3) + xi(2)*(c(:, 6) + xi(1)*c(:, 8))) + xi(1)*xi(2)*c(:, 4)
   end function facet_point_of

   !> First derivatives of the place by the reference coordinates.
   pure subroutine facet_tangents(c, xi, t1, t2)
      real(wp), intent(in) :: c(3, ncoefficient)
      real(wp), intent(in) :: xi(2)
      real(wp), intent(out) :: t1(3)   !! d x/d xi [length]
      real(wp), intent(out) :: t2(3)   !! d x/d eta [length]

      t1 = c(:, 2) + xi(2)*(c(:, 4) + 2.0_wp*xi(1)*c(:, 7) + xi(2)*c(:, 8)) + 2.0_wp*xi(1)*c(:, 5) &
         & + 3.0_wp*xi(1)**2*c(:, 9)
      t2 = c(:, 3) + xi(1)*(c(:, 4) + 2.0_wp*xi(2)*c(:, 8) + xi(1)*c(:, 7)) + 2.0_wp*xi(2)*c(:, 6)
   end subroutine facet_tangents

   !> Second derivatives of the place by the reference coordinates.
   pure subroutine facet_seconds(c, xi, x11, x12, x22)
      real(wp), intent(in) :: c(3, ncoefficient)
      real(wp), intent(in) :: xi(2)
      real(wp), intent(out) :: x11(3), x12(3), x22(3)   !! second derivatives [length]

      x11 = 2.0_wp*(c(:, 5) + xi(2)*c(:, 7)) + 6.0_wp*xi(1)*c(:, 9)
      x22 = 2.0_wp*(c(:, 6) + xi(1)*c(:, 8))
      x12 = c(:, 4) + 2.0_wp*(xi(1)*c(:, 7) + xi(2)*c(:, 8))
   end subroutine facet_seconds
end module lopin_facet_basis
