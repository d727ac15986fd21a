!> Kinematic hardening: how the centre of the yield surface moves.
!>
!> The backstress is a sum of parts, each after Armstrong and Frederick (1966), as in Chaboche's
!> model and in Abaqus: d alpha = C (s - alpha)/phi dp - gamma alpha dp, with p the accumulated
!> plastic strain and phi the flow stress. One part with gamma = 0 is linear kinematic hardening.
!>
!> Over an increment the direction (s - alpha)/phi is that of the end, and the equation is solved
!> exactly for it: alpha <- alpha exp(-gamma dp) + C/gamma (1 - exp(-gamma dp)) direction. So a test
!> in which the direction stays has the exact answer for increments of any length.
module lopin_kinematic_hardening
   use lopin_kinds, only : wp
   use lopin_log_strain, only : exp_minus_one
   implicit none
   private
   public :: kinematic_type, kinematic_step, most_parts

   integer, parameter :: most_parts = 10

   type :: kinematic_type
      integer :: n = 0                                  !! parts of the backstress
      real(wp) :: modulus(most_parts) = 0.0_wp          !! C >= 0 [stress]
      real(wp) :: recovery(most_parts) = 0.0_wp         !! gamma >= 0 [-]
   end type kinematic_type

contains

   !> alpha after a plastic strain `step`: left*alpha + gain*direction, and the slopes of both.
   pure subroutine kinematic_step(self, step, left, gain, left_slope, gain_slope)
      type(kinematic_type), intent(in) :: self
      real(wp), intent(in) :: step                      !! >= 0
      real(wp), intent(out), dimension(self%n) :: left          !! [-]
      real(wp), intent(out), dimension(self%n) :: gain          !! [stress]
      real(wp), intent(out), dimension(self%n) :: left_slope    !! [-]
      real(wp), intent(out), dimension(self%n) :: gain_slope    !! [stress]
      integer :: k

      do k = 1, self%n
         associate (c => self%modulus(k), gamma => self%recovery(k))
            left(k) = exp(-gamma*step)
            gain(k) = c*step
            if (gamma*step > 0.0_wp) gain(k) = -c/gamma*exp_minus_one(-gamma*step)
            left_slope(k) = -gamma*left(k)
            gain_slope(k) = c*left(k)
         end associate
      end do
   end subroutine kinematic_step
end module lopin_kinematic_hardening
