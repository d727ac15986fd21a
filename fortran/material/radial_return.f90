!> The radial return of von Mises plasticity, in any measure of strain whose elastic law is Hooke's:
!> small strain, or logarithmic strain in its principal frame.
!>
!> The deviator of the trial elastic strain goes in; the deviator of stress is `secant` times it,
!> and the slope of that stress is secant (identity on deviators) + along n n, n the unit direction
!> of the trial deviator (Simo and Hughes 1998, box 3.2, in these letters). A rigid-viscoplastic
!> solid has no elastic deviator: its increment of strain is all flow, and the stress that of its
!> rate; far below the usual rate it is a linear fluid, so that parts at rest have a tangent.
module lopin_radial_return
   use lopin_kinds, only : wp
   use lopin_flow_curve, only : flow_type, flow_step, flow_stress
   implicit none
   private
   public :: return_type, return_radially

   !> Share of the usual rate below which a rigid solid is a linear fluid.
   real(wp), parameter :: slow = 1.0e-6_wp

   type :: return_type
      real(wp) :: secant = 0.0_wp      !! deviator of stress per trial deviator [stress]
      real(wp) :: along = 0.0_wp       !! slope along n n beyond it [stress]
      real(wp) :: step = 0.0_wp        !! plastic strain of the increment
      real(wp) :: kept = 1.0_wp        !! share of the trial deviator that stays elastic
      real(wp) :: stress = 0.0_wp      !! von Mises stress [stress]
   end type return_type

contains

   !> `magnitude` is sqrt(e:e) of the trial deviator e.
   pure function return_radially(flow, shear, magnitude, strain, dt) result(back)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: shear          !! G > 0 [stress]
      real(wp), intent(in) :: magnitude      !! >= 0
      real(wp), intent(in) :: strain         !! accumulated plastic strain before
      real(wp), intent(in) :: dt             !! > 0 [time]
      type(return_type) :: back
      real(wp) :: trial, slope

      if (flow%rigid) then
         back = flow_rigidly(flow, magnitude, strain, dt)
         return
      end if
      trial = sqrt(6.0_wp)*shear*magnitude
      back%secant = 2.0_wp*shear
      back%stress = trial
      call flow_step(flow, shear, trial, strain, dt, back%step, back%stress, slope)
      if (.not. back%step > 0.0_wp) then
         back%stress = trial
         return
      end if
      back%kept = back%stress/trial
      back%secant = 2.0_wp*shear*back%kept
      back%along = 2.0_wp*shear*(slope/(3.0_wp*shear + slope) - back%kept)
   end function return_radially

   !> All of the increment is flow: stress of the mean rate, smooth where it vanishes.
   pure function flow_rigidly(flow, magnitude, strain, dt) result(back)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: magnitude, strain, dt
      type(return_type) :: back
      real(wp) :: step, smooth, stress, slope, rate_slope, ratio

      step = sqrt(2.0_wp/3.0_wp)*magnitude
      smooth = hypot(step, slow*flow%usual*dt)
      ! Before anything has moved, Newton starts from the viscosity at the usual rate.
      if (.not. step > 0.0_wp) smooth = flow%usual*dt
      call flow_stress(flow, strain + smooth, smooth/dt, stress, slope, rate_slope)
      slope = slope + rate_slope/dt
      ratio = step/smooth
      back%step = step
      back%kept = 0.0_wp
      back%secant = 2.0_wp/3.0_wp*stress/smooth
      back%stress = stress*ratio
      back%along = 2.0_wp/3.0_wp*ratio**2*(slope - stress/smooth)
   end function flow_rigidly
end module lopin_radial_return
