!> Everything that lives from increment to increment, to a stream and back.
!>
!> One procedure for both directions. What follows from the model and from what is kept (matrices,
!> factors, rows, surfaces, trees of boxes) is made again on reading, in the order in which the run
!> made it; what an increment makes anew before reading it is left out.
module lopin_checkpoint
   use lopin_error, only : error_type, keep_log
   use lopin_clock, only : keep_counter
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type, step_type
   use lopin_report, only : summary_type
   use lopin_plan, only : path_of
   use lopin_state, only : begin
   use lopin_solver_factory, only : new_solver
   use lopin_linear_system, only : widen_system
   use lopin_follower_loading, only : new_followers, set_followers, resume_followers
   use lopin_newton_workspace, only : newton_workspace_type
   use lopin_loading, only : new_loading
   use lopin_scene, only : set_supports
   use lopin_solver_state, only : resume_tools
   use lopin_solve_path, only : prepare_path
   use lopin_nonlinear_start, only : start_step
   use lopin_run_type, only : run_type, watch_type
   implicit none
   private
   public :: pass_run

contains

   !> Keep all of a run, or go back to it in a scene that was just made.
   subroutine pass_run(run, model, stream, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer :: step

      associate (scene => run%scene, plan => run%plan)
         step = scene%step
         call stream%pass(step)
         call stream%pass(plan%path)
         call stream%pass(plan%by_user)
         call stream%pass(plan%reason)
         call scene%accepted%pass(stream)
         if (stream%reading .and. .not. stream%broken) call remake(run, model, step, error)
         if (allocated(error)) return
         call begin(scene%trial, scene%accepted)
         run%in_step = .not. scene%accepted%clock%at_end
         call pass_watch(run%watch, stream)
         call keep_reports(scene%newton, stream)
         call keep_counter(scene%counter, stream)
         call keep_log(scene%log, stream)
         call pass_summary(run%summary, stream)
      end associate
   end subroutine pass_run

   !> Supports, factors, contacts and loads of the step, from the model and the state.
   subroutine remake(run, model, step, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: joined(:)
      logical :: same

      associate (scene => run%scene, solver => run%scene%accepted%solver)
         call set_supports(scene, model, step, same, error)
         if (allocated(error)) return
         call resume_tools(scene, model)
         if (run%plan%path == path_of%condensed) scene%kept_last = solver%last
         if (allocated(solver%joined)) joined = solver%joined
         call prepare_path(scene, model, run%plan, run%summary, error)
         if (allocated(error)) return
         if (run%plan%path == path_of%condensed) then
            call widen_system(scene%system, joined, scene%counter, error)
            if (allocated(error)) return
            solver%joined = joined
         end if
         if (run%plan%path == path_of%nonlinear .and. allocated(solver%name)) &
            & call new_solver(scene%newton%system%solver, solver%name, error)
         if (allocated(error)) return
         call start_step(scene, model)
         call resume_loading(run, model, model%step(step))
      end associate
   end subroutine remake

   !> Loads of a step, from where it has begun.
   subroutine resume_loading(run, model, step)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step

      associate (scene => run%scene, loads => run%scene%accepted%loads, &
         & clock => run%scene%accepted%clock, loading => run%loading)
         call new_loading(loading, model, scene%dofs, scene%constraints, scene%solids, step, &
            & scene%accepted)
         if (allocated(loads%before)) loading%before = loads%before
         if (allocated(loads%from)) loading%from = loads%from
         call resume_followers(scene%newton%follower, loads%followers, scene%dofs%n)
         if (clock%at_end .or. .not. step%nlgeom) return
         call new_followers(scene%newton%follower, step, clock%start, scene%dofs%n)
         call set_followers(scene%newton%follower, model, clock%time)
      end associate
   end subroutine resume_loading

   subroutine pass_watch(self, stream)
      type(watch_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%seen%keep(stream)
      call stream%pass(self%drift%way)
      call stream%pass(self%drift%carried)
      call stream%pass(self%drift%path)
      call self%artificial%keep(stream)
      call self%balance%keep(stream)
      call self%jumps%keep(stream)
      call self%springback%keep(stream)
      call self%ripples%keep(stream)
      call self%sag%keep(stream)
      call self%springs%keep(stream)
      call self%needless%keep(stream)
      call self%checksum%keep(stream)
   end subroutine pass_watch

   !> What the nonlinear path reports of its solver and of its search; what the search has done
   !> since it was counted last is counted with the next increment.
   subroutine keep_reports(self, stream)
      type(newton_workspace_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%system%reason)
      call stream%pass(self%system%krylov%last)
      call stream%pass(self%system%krylov%most)
      call stream%pass(self%system%krylov%whole_factors)
      call stream%pass(self%contact%cost%query)
      call stream%pass(self%contact%cost%box)
      call stream%pass(self%contact%cost%projection)
   end subroutine keep_reports

   subroutine pass_summary(self, stream)
      type(summary_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      call stream%pass(self%plan)
      call stream%pass(self%path)
      call stream%pass(self%solver)
      call stream%pass(self%equations)
      call stream%pass(self%retained)
      call stream%pass(self%candidates)
      call stream%pass(self%checksum)
      do i = 1, size(self%step)
         call stream%pass(self%step(i)%increments)
         call keep_counter(self%step(i)%counter, stream)
      end do
   end subroutine pass_summary
end module lopin_checkpoint
