!> Hill's orthotropic yield surface of 1948.
!>
!> phi^2 = F (s22 - s33)^2 + G (s33 - s11)^2 + H (s11 - s22)^2 + 2 L s23^2 + 2 M s13^2 + 2 N s12^2
!> on the axes of the material. The ratios R of *POTENTIAL are yield stresses under one component of
!> stress alone, by the flow stress (shears: by the flow stress over sqrt 3):
!> F = (1/R22^2 + 1/R33^2 - 1/R11^2)/2 and so on, L = 3/(2 R23^2) and so on (Hill 1948).
!> Lankford's r is the plastic strain across a strip by that through its thickness, at 0, 45 and 90
!> degrees to direction 1 of a sheet whose normal is direction 3; the flow stress is that along 1.
module lopin_yield_hill
   use lopin_kinds, only : wp
   use lopin_yield_surface, only : yield_type
   implicit none
   private
   public :: hill_yield_type, hill_yield, ratios_of_lankford, is_convex

   type, extends(yield_type) :: hill_yield_type
      real(wp) :: curvature(6, 6) = 0.0_wp   !! of phi^2/2 in Kelvin vectors [-]
   contains
      procedure :: evaluate => evaluate_hill
   end type hill_yield_type

contains

   !> The surface of six ratios R11 R22 R33 R12 R13 R23, all > 0.
   pure function hill_yield(ratio) result(self)
      real(wp), intent(in) :: ratio(6)       !! [-]
      type(hill_yield_type) :: self
      real(wp) :: f(3)
      integer :: k

      f = normal_constants(ratio)
      self%curvature = 0.0_wp
      self%curvature(:3, 1) = [f(2) + f(3), -f(3), -f(2)]
      self%curvature(:3, 2) = [-f(3), f(1) + f(3), -f(1)]
      self%curvature(:3, 3) = [-f(2), -f(1), f(1) + f(2)]
      do k = 4, 6
         self%curvature(k, k) = 1.5_wp/ratio(k)**2
      end do
   end function hill_yield

   !> F, G and H.
   pure function normal_constants(ratio) result(f)
      real(wp), intent(in) :: ratio(6)
      real(wp) :: f(3)
      f = 0.5_wp*sum(ratio(:3)**(-2)) - ratio(:3)**(-2)
   end function normal_constants

   !> The surface closes: no stress but a pressure is free of yield.
   pure logical function is_convex(ratio)
      real(wp), intent(in) :: ratio(6)
      real(wp) :: f(3), product

      f = normal_constants(ratio)
      product = f(1)*f(2) + f(2)*f(3) + f(3)*f(1)
      is_convex = product > 100.0_wp*epsilon(product)*sum(abs(f))**2
   end function is_convex

   !> Six ratios from Lankford's r at 0, 45 and 90 degrees, all > 0.
   pure function ratios_of_lankford(r) result(ratio)
      real(wp), intent(in) :: r(3)           !! r0, r45, r90 [-]
      real(wp) :: ratio(6)

      ratio = 1.0_wp
      ratio(2) = sqrt(r(3)*(r(1) + 1.0_wp)/(r(1)*(r(3) + 1.0_wp)))
      ratio(3) = sqrt(r(3)*(r(1) + 1.0_wp)/(r(1) + r(3)))
      ratio(4) = sqrt(3.0_wp*(r(1) + 1.0_wp)*r(3)/((2.0_wp*r(2) + 1.0_wp)*(r(1) + r(3))))
   end function ratios_of_lankford

   pure subroutine evaluate_hill(self, s, value, gradient, curvature)
      class(hill_yield_type), intent(in) :: self
      real(wp), intent(in) :: s(6)
      real(wp), intent(out) :: value, gradient(6), curvature(6, 6)

      gradient = matmul(self%curvature, s)
      value = sqrt(max(0.0_wp, dot_product(s, gradient)))
      if (value > 0.0_wp) gradient = gradient/value
      curvature = self%curvature
   end subroutine evaluate_hill
end module lopin_yield_hill
