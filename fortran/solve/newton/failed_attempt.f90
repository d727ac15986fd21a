!> What a failed attempt at an increment shows of its cause.
module lopin_failed_attempt
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: turns_back, runs_round, cycles_when_small

   !> Attempts at an increment, each smaller, after which a turn of the path is likelier than a step
   !> that is too large.
   integer, parameter :: slow_after = 3
   !> And so it is where Newton runs in a cycle in increments that have become so small, beside
   !> those before.
   real(wp), parameter :: small = 0.25_wp
   !> Residuals of the last few iterations that are near a balance.
   real(wp), parameter :: near = 1.0e-4_wp
   integer, parameter :: few = 4

contains

   !> Newton has failed so that smaller increments promise little: the path may turn back.
   pure logical function turns_back(scene)
      type(scene_type), intent(in) :: scene

      associate (state => scene%newton)
         turns_back = state%attempt >= slow_after &
            & .or. state%cycled .and. state%dt < small*scene%accepted%clock%usual
      end associate
   end function turns_back

   !> Newton has come near a balance and goes round it: points may jam, in an increment of any
   !> length.
   pure logical function runs_round(scene)
      type(scene_type), intent(in) :: scene

      runs_round = .false.
      associate (history => scene%newton%history)
         if (size(history) >= few) runs_round = maxval(history(size(history) - few + 1:)) < near
      end associate
   end function runs_round

   !> Newton runs in a cycle in an increment that is small beside those before, or beside the first
   !> of the step: each of them would be cut once, and the next.
   pure logical function cycles_when_small(scene, model)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      associate (step => model%step(scene%step))
         cycles_when_small = scene%newton%cycled .and. scene%newton%dt &
            & < small*max(scene%accepted%clock%usual, min(step%initial, step%period))
      end associate
   end function cycles_when_small
end module lopin_failed_attempt
