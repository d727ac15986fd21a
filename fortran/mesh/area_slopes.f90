!> Slopes of the areas that belong to the nodes of a facet, in the places of all its nodes.
module lopin_area_slopes
   use lopin_kinds, only : wp
   use lopin_facets, only : facet_rule_type
   implicit none
   private
   public :: weight_slopes

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Slopes of `weight(place)` of facet_weights.
   pure subroutine weight_slopes(self, x, axisymmetric, share, place, slope)
      type(facet_rule_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: share          !! middle_share
      integer, intent(in) :: place           !! node of the facet
      real(wp), intent(out) :: slope(:, :)   !! (ndim, nnode) [length], plane: [-]
      real(wp) :: grows(size(x, 1), size(x, 2)), length, n, ring
      integer :: k, m

      m = size(x, 2)
      slope = 0.0_wp
      do k = 1, self%npoint
         n = self%n(place, k)
         if (share > 0.0_wp) n = dot_product(self%blend(place, :m), self%n(:m, k))
         call length_slopes(x, self%dn(:, :, k), length, grows)
         ring = self%weight(k)*n
         if (axisymmetric) then
            slope(1, :) = slope(1, :) + ring*2.0_wp*pi*length*self%n(:m, k)
            ring = ring*2.0_wp*pi*dot_product(x(1, :), self%n(:m, k))
         end if
         slope = slope + ring*grows
      end do
   end subroutine weight_slopes

   !> Area of the parametric unit, and its slopes; zero where the facet is degenerate.
   pure subroutine length_slopes(x, dn, length, slope)
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) [length]
      real(wp), intent(in) :: dn(:, :)       !! (ndim-1, nnode)
      real(wp), intent(out) :: length, slope(:, :)
      real(wp) :: a(3), b(3), normal(3)
      integer :: m

      slope = 0.0_wp
      if (size(x, 1) == 2) then
         a(:2) = matmul(x, dn(1, :))
         length = norm2(a(:2))
         if (.not. length > 0.0_wp) return
         do m = 1, size(x, 2)
            slope(:, m) = a(:2)/length*dn(1, m)
         end do
         return
      end if
      a = matmul(x, dn(1, :))
      b = matmul(x, dn(2, :))
      normal = cross(a, b)
      length = norm2(normal)
      if (.not. length > 0.0_wp) return
      normal = normal/length
      do m = 1, size(x, 2)
         slope(:, m) = cross(b, normal)*dn(1, m) + cross(normal, a)*dn(2, m)
      end do
   end subroutine length_slopes

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross
end module lopin_area_slopes
