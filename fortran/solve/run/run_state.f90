!> The state of a run, out of it and into it; and making the workspace again from model and state.
module lopin_run_state
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_mesh, only : place_by_element
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_plan, only : plan_type, path_of
   use lopin_scene, only : scene_type, new_scene, begin_scene
   use lopin_settle_formulation, only : settle_formulation
   use lopin_uneven_pressure, only : warn_of_uneven_pressure
   use lopin_check_mesh, only : refuse_folded
   use lopin_contact_candidates, only : choose_candidates
   use lopin_run_type, only : run_type
   use lopin_checkpoint_store, only : checkpoint_store_type
   use lopin_checkpoint, only : pass_run
   use lopin_checkpointing, only : go_back
   implicit none
   private
   public :: run_state, resume_run, make_workspace, forget_workspace

contains

   !> Go on from the state that the store found.
   subroutine resume_run(self, model, recorders, log, store, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(log_type), intent(inout) :: log
      class(checkpoint_store_type), intent(inout) :: store
      type(error_type), allocatable, intent(out) :: error

      call go_back(self, model, recorders, store%found, error)
      if (allocated(error)) return
      store%kept = 'increment '//to_text(self%scene%accepted%clock%number)//' of step '// &
         & to_text(self%scene%step)
      call log%say(severity%note, 'N0604', 'goes on after '//store%kept)
   end subroutine resume_run

   !> All that lives from increment to increment, to a stream or back from one of the same deck.
   subroutine run_state(self, model, state, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(stream_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error

      call pass_run(self, model, state, error)
      if (allocated(error) .or. .not. state%reading) return
      if (state%broken .or. .not. state%ended()) call raise(error, error_code%resource, 'E0604', &
         & 'the state does not hold what this build of Lopin keeps', &
         & help='give a state that this version took out of the same deck')
   end subroutine run_state

   !> What follows from the model alone, and how pairs are enforced whose deck does not say it.
   subroutine make_workspace(scene, model, plan, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(inout) :: model
      type(plan_type), intent(inout) :: plan
      type(error_type), allocatable, intent(out) :: error

      call new_scene(scene, model, error)
      if (.not. allocated(error)) call settle_formulation(scene, model, plan, error)
      if (.not. allocated(error)) call begin_scene(scene, model)
      scene%eliminates = plan%path == path_of%condensed
      call place_by_element(model%mesh, error)
      if (.not. allocated(error)) call warn_of_uneven_pressure(scene, model)
      if (.not. allocated(error)) call refuse_folded(scene, model, error)
      if (.not. allocated(error)) call choose_candidates(scene, model)
   end subroutine make_workspace

   !> Throw away all but the state, and make the workspace again from the model and the state: the
   !> run goes on to the same bits, or something that evolves has a home outside the state.
   subroutine forget_workspace(self, model, error)
      class(run_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      type(scene_type), allocatable :: old
      type(stream_type) :: kept, state

      if (.not. (self%in_step .or. self%scene%accepted%clock%number > 0)) return
      call run_state(self, model, kept, error)
      if (allocated(error)) return
      call move_alloc(self%scene, old)
      allocate (self%scene)
      self%scene%clock = old%clock
      call move_alloc(old%watcher, self%scene%watcher)
      deallocate (old)
      call make_workspace(self%scene, model, self%plan, error)
      if (allocated(error)) return
      state%reading = .true.
      state%n = kept%n
      call move_alloc(kept%bytes, state%bytes)
      call run_state(self, model, state, error)
   end subroutine forget_workspace
end module lopin_run_state
