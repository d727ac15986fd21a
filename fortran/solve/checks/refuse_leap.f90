!> A balance with more energy than its increment can have been given is not accepted.
!>
!> Boundary forces do no more work in an increment than the larger of their values at its ends does
!> over its motion, but for what rises and falls again within it. Where far more is stored and
!> dissipated, Newton has leapt to an equilibrium that no path leads to: a crease in a free surface,
!> an element of reduced integration that has collapsed between its integration points.
module lopin_refuse_leap
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type, is_heated
   use lopin_report, only : energy_type, lost_work
   use lopin_work_balance, only : balance_type
   use lopin_scene, only : scene_type
   use lopin_certificate, only : forces_type
   implicit none
   private
   public :: refuse_leap

   !> Times the largest work of the boundary: forces that rise and fall again within the increment,
   !> and, of solids that flow, the rates at its end.
   real(wp), parameter :: beyond_elastic = 1.5_wp, beyond_flow = 3.0_wp

contains

   subroutine refuse_leap(scene, model, forces, balance, energy, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(forces_type), intent(in) :: forces
      type(balance_type), intent(in) :: balance    !! of the increments before this one
      type(energy_type), intent(in) :: energy  !! of it, but for the external work
      type(error_type), allocatable, intent(out) :: error
      type(energy_type) :: given
      real(wp) :: least, most, beyond

      if (.not. (scene%newton%in_use .and. scene%may_cut)) return
      ! Heat gives more than the boundary does, and what it gave is known by its rule alone.
      if (is_heated(model)) return
      ! What a state that was handed over stores was not given here.
      if (.not. allocated(balance%closed)) return
      if (scene%newton%contact%closes_in .or. adds_pairs(scene, model)) return
      given = energy
      beyond = merge(beyond_flow, beyond_elastic, scene%newton%flows)
      associate (before => scene%accepted%loads, &
         & moved => scene%trial%motion%u - scene%accepted%motion%u)
         most = sum(max(abs(before%force + before%reaction), abs(forces%load + forces%residual)) &
            & *abs(moved))
         given%external = before%work + beyond*most
      end associate
      least = max(energy%strain + energy%plastic, energy%nothing)*1.0e-2_wp
      associate (created => balance%lost - lost_work(given))
         if (.not. created > least) return
         call raise(error, error_code%not_converged, 'E0516', 'the balance found stores '// &
            & to_text(created + beyond*most, 3)//' more energy than the state before it, and '// &
            & 'what moves the boundary can have given '//to_text(most, 3), &
            & model%step(scene%step)%at, help='smaller increments on *STATIC')
      end associate
   end subroutine refuse_leap

   !> The step begins with pairs that it adds: what they overlap by is pressed out at once.
   pure logical function adds_pairs(scene, model)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      adds_pairs = .not. scene%accepted%clock%time > 0.0_wp
      if (adds_pairs) adds_pairs = allocated(model%step(scene%step)%pair_change)
      if (adds_pairs) adds_pairs = any(model%step(scene%step)%pair_change%active)
   end function adds_pairs
end module lopin_refuse_leap
