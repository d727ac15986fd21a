!> The contract of yield surfaces.
!>
!> A surface is a convex equivalent stress phi(s) of the deviator of stress, homogeneous of degree
!> one: the solid flows where phi reaches the flow stress, in the direction of its gradient. To add
!> one, extend `yield_type` with this one procedure; the return to the surface, the consistent
!> tangent, every hardening law, small and finite strain and plane stress are written once against
!> it (modules plastic_return and material_point).
module lopin_yield_surface
   use lopin_kinds, only : wp
   implicit none
   private
   public :: yield_type

   type, abstract :: yield_type
   contains
      procedure(evaluate_if), deferred :: evaluate
   end type yield_type

   abstract interface
      !> Equivalent stress, its gradient, and the second derivative of half its square.
      !>
      !> The Hessian of phi itself is (curvature - gradient gradient)/phi. The curvature is positive
      !> on deviators, and constant for a quadratic surface.
      pure subroutine evaluate_if(self, s, value, gradient, curvature)
         import :: yield_type, wp
         class(yield_type), intent(in) :: self
         real(wp), intent(in) :: s(6)              !! deviator on the axes of the material, as a
                                                   !! Kelvin vector [stress]
         real(wp), intent(out) :: value            !! >= 0 [stress]
         real(wp), intent(out) :: gradient(6)      !! a deviator; any bound value where s = 0 [-]
         real(wp), intent(out) :: curvature(6, 6)  !! symmetric [-]
      end subroutine evaluate_if
   end interface
end module lopin_yield_surface
