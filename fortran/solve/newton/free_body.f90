!> Why Newton has no equilibrium where it had to hold a body by springs: a load beyond what flowing
!> metal bears, or a body that contact does not hold.
module lopin_free_body
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_plural, only : plural
   use lopin_model, only : model_type, step_type
   use lopin_body_words, only : describe_motion
   use lopin_newton_step, only : some_body_falls
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: raise_free_body, pushed_by_forces

contains

   !> A body that only contact could hold, and contact does not; or, where metal flows under forces,
   !> no equilibrium.
   subroutine raise_free_body(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text
      real(wp) :: q(scene%bodies%nq)

      q = 0.0_wp
      q(1) = 1.0_wp
      text = describe_motion(scene%bodies, model, q)
      if (may_be_at_limit(scene) .and. pushed_by_forces(model%step(scene%step))) then
         text = 'no equilibrium under these forces: metal flows at a limit load, or '//text// &
            & ' and contact does not hold it'
      else
         text = text//': contact does not hold it under these loads'
      end if
      call raise(error, error_code%not_converged, 'E0511', text, model%step(scene%step)%at, &
         & note=plural(scene%bodies%nq, 'free rigid motion'), &
         & help='fix it by *BOUNDARY, bring it into contact, or drive it by displacement')
   end subroutine raise_free_body

   !> Metal that can flow has flowed, or is loaded by bodies that contact or ties have hold of.
   pure logical function may_be_at_limit(scene)
      type(scene_type), intent(in) :: scene

      may_be_at_limit = scene%newton%flows
      if (may_be_at_limit) may_be_at_limit = scene%accepted%solids%most_strain > 0.0_wp &
         & .or. .not. some_body_falls(scene)
   end function may_be_at_limit

   !> Loads act, and no motion is prescribed.
   pure logical function pushed_by_forces(step)
      type(step_type), intent(in) :: step

      pushed_by_forces = any(abs(step%point_load%value) > 0.0_wp) .or. &
         & any(abs(step%face_load%pressure) > 0.0_wp)
      if (pushed_by_forces) pushed_by_forces = .not. any(abs(step%prescribed%value) > 0.0_wp)
   end function pushed_by_forces
end module lopin_free_body
