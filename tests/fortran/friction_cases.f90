!> Laws of friction with plain numbers, a place that they read, and slopes by differences.
module friction_cases
   use lopin_kinds, only : wp
   use lopin_friction, only : friction_type, condition_type, law_of, regularization_of
   implicit none
   private
   public :: law_with, scene, slope_of

contains

   !> A law with plain numbers, as C9 has them.
   pure type(friction_type) function law_with(number, regularization) result(law)
      integer, intent(in) :: number
      integer, intent(in), optional :: regularization

      law%law = number
      law%mu = 0.3_wp
      law%m = 0.2_wp
      law%alpha = 5.0_wp
      law%q = 0.2_wp
      law%elastic_slip = 0.01_wp
      if (present(regularization)) law%regularization = regularization
      if (number == law_of%norton_hoff .and. law%regularization /= regularization_of%linear) &
         & law%v0 = 0.05_wp
   end function law_with

   pure type(condition_type) function scene() result(at)
      at%yield = 200.0_wp
      at%mises = 150.0_wp
      at%dt = 0.5_wp
      at%speed = 0.7_wp
   end function scene

   !> Fourth-order differences.
   pure real(wp) function slope_of(f, h) result(slope)
      real(wp), intent(in) :: f(-2:2), h
      slope = (f(-2) - 8.0_wp*f(-1) + 8.0_wp*f(1) - f(2))/(12.0_wp*h)
   end function slope_of
end module friction_cases
