!> Convergence of Newton: residual, contact and correction, relative to the forces of the scene, or
!> below the rounding of both.
!>
!> The forces beside which a residual is small are those that elements, loads and supports bear, one
!> by one. They do not fade where a body is let go of, as assembled forces do, nor grow with a trial
!> that lies far out.
module lopin_newton_convergence
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_model, only : model_type
   use lopin_residual, only : evaluation_type
   use lopin_nonlinear_start, only : complementarity
   use lopin_rounding_floor, only : noise_of_places, floor_of_forces, floor_of_rows
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: converged, set_rounding_floors, relative, reference_of

   !> Convergence, all dimensionless (conventions, frozen): equilibrium, contact, correction.
   real(wp), parameter, public :: equilibrium = 1.0e-8_wp, correction = 1.0e-6_wp
   !> And contact beside the forces of contact, as the certificate judges it: a body that is all but
   !> released has large forces of its own.
   real(wp), parameter :: certified = 1.0e-6_wp
   !> What rounding leaves of the equilibrium of a long or stiff body.
   real(wp), parameter, public :: floor_of_rounding = 1.0e-11_wp

contains

   !> What rounding leaves of the forces of this increment.
   subroutine set_rounding_floors(scene)
      type(scene_type), intent(inout) :: scene
      real(wp) :: floor(scene%constraints%neq)

      call floor_of_forces(scene, floor)
      scene%newton%floor = floor
      scene%newton%noise = noise_of_places(scene)
      scene%newton%row_floor = floor_of_rows(scene, scene%newton%noise)
   end subroutine set_rounding_floors

   !> Size of what is out of balance, beside a force; huge beside none.
   pure real(wp) function relative(evaluation, force)
      type(evaluation_type), intent(in) :: evaluation
      real(wp), intent(in) :: force
      relative = huge(1.0_wp)
      if (evaluation%merit < force*huge(1.0_wp)**0.5_wp) relative = evaluation%merit/force
      if (.not. evaluation%merit > 0.0_wp) relative = 0.0_wp
   end function relative

   !> Forces beside which a state is in balance: its own, or those that the increment began with.
   pure real(wp) function reference_of(scene, evaluation) result(force)
      type(scene_type), intent(in) :: scene
      type(evaluation_type), intent(in) :: evaluation
      force = max(scene%newton%began, evaluation%force)
   end function reference_of

   !> The three dimensionless tests; the correction may stay large if the residual is all rounding.
   logical function converged(scene, evaluation, remaining, iteration, loop, last, unchanged)
      type(scene_type), intent(in) :: scene
      type(evaluation_type), intent(in) :: evaluation
      real(wp), intent(in) :: remaining(:)
      integer, intent(in) :: iteration, loop
      real(wp), intent(in) :: last             !! size of the last correction beside u
      logical, intent(in) :: unchanged         !! contact is as before the last correction
      real(wp) :: reference

      converged = .false.
      if (any(abs(remaining) > 0.0_wp)) return
      ! Friction of forces that have all but gone is beyond its bound long before rows are rounding.
      if (.not. evaluation%contact_residual <= certified) return
      converged = unchanged .and. evaluation%unbalanced <= 0.0_wp .and. evaluation%unmet <= 0.0_wp
      if (converged) return
      reference = reference_of(scene, evaluation)
      converged = evaluation%unbalanced <= equilibrium*reference &
         & .and. evaluation%unmet <= complementarity*reference
      if (converged) converged = last <= correction .or. iteration == 1 .and. loop == 0 &
         & .or. max(largest(evaluation%unlevel), largest(evaluation%row)) <= &
         & floor_of_rounding*reference
   end function converged
end module lopin_newton_convergence
