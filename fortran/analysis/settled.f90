!> When Newton has arrived: residual, contact and correction, beside the forces of the scene, or all
!> of it below what rounding leaves.
!>
!> The forces beside which a residual is small are those that elements, loads and supports bear, one
!> by one. They do not fade where a body is let go of, as assembled forces do, nor grow with a trial
!> that lies far out.
module lopin_settled
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_model, only : model_type
   use lopin_finite_forces, only : look_type
   use lopin_finite_start, only : complementarity
   use lopin_rounding_floor, only : noise_of_places, floor_of_forces, floor_of_rows
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: settled, set_floor, relative, reference_of

   !> Convergence, all dimensionless (conventions, frozen): equilibrium, contact, correction.
   real(wp), parameter, public :: equilibrium = 1.0e-8_wp, correction = 1.0e-6_wp
   !> And contact beside the forces of contact, as the certificate judges it: a body that is all but
   !> released has large forces of its own.
   real(wp), parameter :: certified = 1.0e-6_wp
   !> What rounding leaves of the equilibrium of a long or stiff body.
   real(wp), parameter, public :: floor_of_rounding = 1.0e-11_wp

contains

   !> What rounding leaves of the forces of this increment.
   subroutine set_floor(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: floor(scene%constraints%neq)

      call floor_of_forces(scene, model, floor)
      scene%finite%floor = floor
      scene%finite%noise = noise_of_places(scene, model)
      scene%finite%row_floor = floor_of_rows(scene, scene%finite%noise)
   end subroutine set_floor

   !> Size of what is out of balance, beside a force.
   pure real(wp) function relative(look, force)
      type(look_type), intent(in) :: look
      real(wp), intent(in) :: force
      relative = look%merit/max(force, tiny(1.0_wp))
   end function relative

   !> Forces beside which a state is in balance: its own, or those that the increment began with.
   pure real(wp) function reference_of(scene, look) result(force)
      type(scene_type), intent(in) :: scene
      type(look_type), intent(in) :: look
      force = max(scene%finite%began, look%force)
   end function reference_of

   !> The three dimensionless tests; the correction may stay large if the residual is all rounding.
   logical function settled(scene, look, jump, iteration, loop, last, unchanged)
      type(scene_type), intent(in) :: scene
      type(look_type), intent(in) :: look
      real(wp), intent(in) :: jump(:)
      integer, intent(in) :: iteration, loop
      real(wp), intent(in) :: last             !! size of the last correction beside u
      logical, intent(in) :: unchanged         !! contact is as before the last correction
      real(wp) :: reference

      settled = .false.
      if (any(abs(jump) > 0.0_wp)) return
      settled = unchanged .and. look%unbalanced <= 0.0_wp .and. look%unmet <= 0.0_wp
      if (settled) return
      reference = reference_of(scene, look)
      settled = look%unbalanced <= equilibrium*reference &
         & .and. look%unmet <= complementarity*reference .and. look%ajar <= certified
      if (settled) settled = last <= correction .or. iteration == 1 .and. loop == 0 &
         & .or. max(largest(look%free), largest(look%row)) <= floor_of_rounding*reference
   end function settled
end module lopin_settled
