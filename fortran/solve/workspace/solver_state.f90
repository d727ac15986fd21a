!> Start values of solutions: copied out of the state where an increment begins, and into it where
!> it ends.
module lopin_solver_state
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type, stand_tools
   implicit none
   private
   public :: start_solver, leave_solver, resume_tools

contains

   !> As the last accepted increment left it: one that was given up since has left nothing.
   subroutine start_solver(scene)
      type(scene_type), intent(inout) :: scene

      associate (start => scene%accepted%solver, answer => scene%answer, newton => scene%newton)
         if (newton%in_use) then
            newton%has_solved = start%has_solved
            newton%contraction%bend = start%bend
            return
         end if
         call copy_marks(start%active, answer%active)
         call copy(start%force, answer%force)
         call copy(start%gap, answer%gap)
         call copy(start%multiplier, answer%multiplier)
         call copy(start%q, answer%q)
         call copy(start%u, answer%u)
      end associate
   end subroutine start_solver

   !> For the next increment.
   subroutine leave_solver(scene)
      type(scene_type), intent(inout) :: scene

      associate (next => scene%trial%solver, answer => scene%answer, newton => scene%newton)
         if (newton%in_use) then
            next%has_solved = newton%has_solved
            next%bend = newton%contraction%bend
            if (allocated(newton%system%solver)) next%name = newton%system%solver%name()
            return
         end if
         next%place = scene%place
         call copy_marks(answer%active, next%active)
         call copy(answer%force, next%force)
         call copy(answer%gap, next%gap)
         call copy(answer%multiplier, next%multiplier)
         call copy(answer%q, next%q)
         call copy(answer%u, next%u)
      end associate
   end subroutine leave_solver

   !> Slave points in a workspace that was just made, on the tools as they were projected last.
   subroutine resume_tools(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (allocated(scene%accepted%solver%place)) call stand_tools(scene, model, &
         & scene%accepted%solver%place)
   end subroutine resume_tools

   !> What may be absent.
   pure subroutine copy(from, to)
      real(wp), allocatable, intent(in) :: from(:)
      real(wp), allocatable, intent(inout) :: to(:)

      if (allocated(from)) then
         to = from
      else if (allocated(to)) then
         deallocate (to)
      end if
   end subroutine copy

   pure subroutine copy_marks(from, to)
      logical, allocatable, intent(in) :: from(:)
      logical, allocatable, intent(inout) :: to(:)

      if (allocated(from)) then
         to = from
      else if (allocated(to)) then
         deallocate (to)
      end if
   end subroutine copy_marks
end module lopin_solver_state
