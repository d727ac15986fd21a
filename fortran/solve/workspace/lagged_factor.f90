!> The factor of an earlier tangent as the preconditioner of a near one, which saves the factor: the
!> operator of the iterations stays exact, so answers do not change, and where many more iterations
!> are needed than before, the factor is made after all.
!>
!> Only within one Newton iteration: nothing is kept that a checkpoint would have to hold.
module lopin_lagged_factor
   use lopin_kinds, only : wp
   implicit none
   private
   public :: lagged_factor_type, limit_of, note_solution

   !> So many times the iterations of the last solution, and so many more.
   real(wp), parameter :: longer = 1.5_wp
   integer, parameter :: more = 5

   type :: lagged_factor_type
      logical :: may = .false.                 !! the next tangent is near the one factorised
      logical :: at_hand = .false.             !! the factor is of an earlier tangent
      logical :: failed = .false.              !! such a factor has not done in this iteration
      real(wp) :: decades = 1.0_wp             !! of the residual, in the last solution
   end type lagged_factor_type

contains

   !> Iterations after which the factor is given up.
   pure integer function limit_of(self, last, tolerance, most)
      type(lagged_factor_type), intent(in) :: self
      integer, intent(in) :: last              !! iterations of the last solution
      real(wp), intent(in) :: tolerance        !! of this one, relative
      integer, intent(in) :: most              !! of any

      limit_of = most
      if (self%at_hand) limit_of = min(most, more + ceiling(longer*last*max(1.0_wp, &
         & -log10(tolerance))/self%decades))
   end function limit_of

   pure subroutine note_solution(self, ratio)
      type(lagged_factor_type), intent(inout) :: self
      real(wp), intent(in) :: ratio            !! of its residual to the right-hand side

      self%decades = max(1.0_wp, -log10(max(ratio, tiny(ratio))))
   end subroutine note_solution
end module lopin_lagged_factor
