!> How fast Newton contracts, and what that saves: the last step of an increment often needs neither
!> a new tangent nor a new factor.
!>
!> Near the solution a step with the exact tangent leaves the residual r' = bend r^2; a step with
!> the tangent of the state before leaves about 2 r'/r of its own residual (Kelley 1995, 5.4: the
!> error of the tangent is the Lipschitz constant times the last correction, and Newton's own is
!> half of that). So the two residuals of one Newton step tell whether the next may do with the old
!> tangent; and `bend`, kept from increment to increment, tells beforehand whether a look needs to
!> form the tangent.
module lopin_contraction
   use lopin_kinds, only : wp
   implicit none
   private
   public :: contraction_type, by_old_tangent, evaluate_without_tangent, note_step
   public :: gets_nowhere

   !> Forecasts must be better than what is asked by this factor.
   real(wp), parameter :: safety = 5.0_wp
   !> Steps that contract less than this are not near the solution.
   real(wp), parameter :: near = 0.05_wp

   !> So many residuals in a row above one before them: a smaller increment costs less.
   integer, parameter :: in_vain = 7

   type :: contraction_type
      real(wp) :: bend = -1.0_wp               !! r'/r^2 of the last full step, kept; < 0: unknown
      real(wp) :: rate = 1.0_wp                !! r'/r of the last step
      logical :: exact = .false.               !! it was a full step by the tangent of its start
   end type contraction_type

contains

   !> The next step, by the tangent of the last, ends the iteration.
   pure logical function by_old_tangent(self, residual, correction, wanted, wanted_correction)
      type(contraction_type), intent(in) :: self
      real(wp), intent(in) :: residual         !! after the last step, beside the largest force
      real(wp), intent(in) :: correction       !! of the last step, beside the displacements
      real(wp), intent(in) :: wanted, wanted_correction

      by_old_tangent = self%exact .and. self%rate < near
      if (by_old_tangent) by_old_tangent = 2.0_wp*self%rate*residual*safety < wanted &
         & .and. self%rate*correction*safety < wanted_correction
   end function by_old_tangent

   !> After the step to come, from this residual, no tangent will be asked for.
   pure logical function evaluate_without_tangent(self, residual, exact, wanted)
      type(contraction_type), intent(in) :: self
      real(wp), intent(in) :: residual         !! before the step, beside the largest force
      logical, intent(in) :: exact             !! the step is by the tangent of its start
      real(wp), intent(in) :: wanted
      real(wp) :: rate

      if (.not. exact) then
         evaluate_without_tangent = .true.
         return
      end if
      evaluate_without_tangent = .false.
      if (self%bend < 0.0_wp) return
      rate = self%bend*residual
      evaluate_without_tangent = rate < near
      if (evaluate_without_tangent) evaluate_without_tangent = 2.0_wp*rate**2*residual*safety &
         & < wanted
   end function evaluate_without_tangent

   !> A step was taken.
   pure subroutine note_step(self, from, to, exact)
      type(contraction_type), intent(inout) :: self
      real(wp), intent(in) :: from, to         !! residuals beside the largest force
      logical, intent(in) :: exact             !! in full, by the tangent of its start, same contact

      self%exact = exact .and. from > 0.0_wp
      if (.not. self%exact) return
      self%rate = to/from
      if (from < near) self%bend = self%rate/from
   end subroutine note_step

   !> The last residuals are all above the best before them.
   pure logical function gets_nowhere(residual)
      real(wp), intent(in) :: residual(:)      !! of all looks after the first step
      integer :: n

      n = size(residual)
      gets_nowhere = n > in_vain
      if (gets_nowhere) gets_nowhere = minval(residual(n - in_vain + 1:)) &
         & > minval(residual(:n - in_vain))
   end function gets_nowhere
end module lopin_contraction
