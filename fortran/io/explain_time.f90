!> Explanations of what a run says about its increments.
module lopin_explain_time
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: time_explanations

contains

   subroutine time_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0550', 'increments end at the points of amplitudes', &
         & 'Friction, flow and contact that sticks remember the way that loads and motions '// &
         & 'took. So an increment ends at every point of an amplitude in use, DIRECT or not; '// &
         & 'fixed increments go on in their places after it. INC= does not count these.', &
         & 'nothing to do; a scene without history keeps the increments that are given.')
   end subroutine time_explanations
end module lopin_explain_time
