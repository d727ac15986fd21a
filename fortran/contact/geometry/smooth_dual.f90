!> Smoothed facets in dual numbers: the coefficients with their derivatives by the stencil's nodes.
!>
!> The same arithmetic as lopin_smooth_facet, so that tangents through a smoothed face are exact.
module lopin_smooth_dual
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, dual_dot, dual_cross, dual_norm, operator(+), &
      & operator(-), operator(*), operator(/), assignment(=)
   use lopin_facet_basis, only : facet_basis_type, ncoefficient
   use lopin_smooth_facet, only : stencil_type, twin_of
   implicit none
   private
   public :: dual_coefficients

contains

   !> Coefficients of a smoothed facet with their slopes by the places of its stencil.
   pure subroutine dual_coefficients(self, basis, cell, x, c)
      type(stencil_type), intent(in) :: self
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: cell                  !! cell id of the linear facet
      type(dual_type), intent(in) :: x(:, :)       !! (3, self%n) places of the stencil [length]
      type(dual_type), intent(out) :: c(3, ncoefficient)
      type(dual_type) :: normal(3, 4), all_nodes(3, 8), d(3), s(3), long, factor
      integer :: i, j, k, next, n

      n = basis%ncorner(cell)
      call dual_normals(self, n, x, normal)
      if (n == 2) then
         call dual_hermite(x(:, 1), x(:, 2), normal(:, 1), normal(:, 2), c)
         return
      end if
      do k = 1, n
         next = 1 + mod(k, n)
         all_nodes(:, k) = x(:, k)
         d = x(:, next) - x(:, k)
         s = normal(:, k) + normal(:, next)
         long = dual_norm(s)
         factor = dual_dot(normal(:, k) - normal(:, next), d)/(2.0_wp*long*(2.0_wp + long))
         all_nodes(:, n + k) = 0.5_wp*(x(:, k) + x(:, next)) - factor*s
      end do
      c = constant(0.0_wp)
      do i = 1, 2*n
         do j = 1, ncoefficient
            associate (t => basis%transform(j, i, twin_of(cell)))
               if (abs(t) > 0.0_wp) c(:, j) = c(:, j) + t*all_nodes(:, i)
            end associate
         end do
      end do
   end subroutine dual_coefficients

   pure subroutine dual_normals(self, n, x, normal)
      type(stencil_type), intent(in) :: self
      integer, intent(in) :: n
      type(dual_type), intent(in) :: x(:, :)
      type(dual_type), intent(out) :: normal(3, 4)
      type(dual_type) :: a(3), b(3), square
      integer :: k, j

      normal = constant(0.0_wp)
      do k = 1, n
         do j = 1, self%nfan(k)
            associate (fan => self%fan(:, j, k))
               if (n == 2) then
                  a = x(:, fan(3)) - x(:, fan(1))
                  square = dual_dot(a, a)
                  normal(1, k) = normal(1, k) + a(2)/square
                  normal(2, k) = normal(2, k) - a(1)/square
               else
                  a = x(:, fan(3)) - x(:, fan(2))
                  b = x(:, fan(1)) - x(:, fan(2))
                  square = dual_dot(a, a)*dual_dot(b, b)
                  normal(:, k) = normal(:, k) + dual_cross(a, b)/square
               end if
            end associate
         end do
         if (norm2(normal(:, k)%v) > 0.0_wp) normal(:, k) = normal(:, k)/dual_norm(normal(:, k))
      end do
      if (n /= 2 .or. sum(self%nfan(:2)) /= 3) return
      k = minloc(self%nfan(:2), dim=1)
      a = x(:, 2) - x(:, 1)
      a = a/dual_norm(a)
      normal(:, k) = normal(:, 3 - k) - (2.0_wp*dual_dot(normal(:, 3 - k), a))*a
   end subroutine dual_normals

   pure subroutine dual_hermite(a, b, na, nb, c)
      type(dual_type), intent(in) :: a(3), b(3), na(3), nb(3)
      type(dual_type), intent(out) :: c(3, ncoefficient)
      type(dual_type) :: d(3), ta(3), tb(3), chord

      d = b - a
      chord = dual_norm(d)
      ta = constant(0.0_wp)
      tb = constant(0.0_wp)
      ta(1) = (-1.0_wp)*na(2)
      ta(2) = na(1)
      tb(1) = (-1.0_wp)*nb(2)
      tb(2) = nb(1)
      ta = (chord/(1.0_wp + dual_dot(ta, d)/chord))*ta
      tb = (chord/(1.0_wp + dual_dot(tb, d)/chord))*tb
      c = constant(0.0_wp)
      c(:, 5) = 0.25_wp*(tb - ta)
      c(:, 9) = 0.25_wp*(ta + tb - d)
      c(:, 1) = 0.5_wp*(a + b) - c(:, 5)
      c(:, 2) = 0.5_wp*d - c(:, 9)
   end subroutine dual_hermite
end module lopin_smooth_dual
