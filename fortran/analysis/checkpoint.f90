!> Everything that lives from increment to increment, to a stream and back.
!>
!> One procedure for both directions. What follows from the model and from what is kept (matrices,
!> factors, rows, surfaces, trees of boxes) is made again on reading, in the order in which the run
!> made it; what an increment makes anew before reading it is left out.
module lopin_checkpoint
   use lopin_error, only : error_type, keep_log
   use lopin_clock, only : keep_counter
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : summary_type
   use lopin_plan, only : plan_type, path_of
   use lopin_active_set, only : contact_result_type
   use lopin_state, only : begin
   use lopin_contact_points, only : contact_points_type
   use lopin_contact_memory, only : keep_contact
   use lopin_solver_factory, only : new_solver
   use lopin_linear_system, only : widen_system
   use lopin_finite_system, only : finite_system_type
   use lopin_follower_loading, only : follower_type
   use lopin_finite_state, only : finite_state_type
   use lopin_loading, only : loading_type, new_loading
   use lopin_scene, only : scene_type, set_supports
   use lopin_solve_path, only : prepare_path
   use lopin_finite_start, only : start_step
   use lopin_run_type, only : run_type, watch_type
   implicit none
   private
   public :: keep_run

contains

   !> Keep all of a run, or go back to it in a scene that was just made.
   subroutine keep_run(run, model, stream, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: joined(:)
      integer :: step

      associate (scene => run%scene, plan => run%plan)
         step = scene%step
         call stream%pass(step)
         call stream%pass(plan%path)
         call stream%pass(plan%by_user)
         call stream%pass(plan%reason)
         call keep_watch(run%watch, stream)
         call keep_search(scene, stream)
         call keep_order(scene, plan, joined, stream)
         if (stream%reading .and. .not. stream%broken) call remake(run, model, step, joined, error)
         if (allocated(error)) return
         call keep_loading(run%loading, stream)
         call scene%accepted%pass(stream)
         call begin(scene%trial, scene%accepted)
         run%in_step = .not. scene%accepted%clock%at_end
         call keep_answer(scene%answer, stream)
         call keep_finite(scene%finite, stream, error)
         if (allocated(error)) return
         call keep_counter(scene%counter, stream)
         call keep_log(scene%log, stream)
         call keep_summary(run%summary, stream)
      end associate
   end subroutine keep_run

   !> Supports, factors and contacts of the step; loads that the rest will set right.
   subroutine remake(run, model, step, joined, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      integer, intent(in) :: joined(:)         !! equations that joined the factor
      type(error_type), allocatable, intent(out) :: error
      logical :: same

      associate (scene => run%scene)
         call set_supports(scene, model, step, same, error)
         if (allocated(error)) return
         call prepare_path(scene, model, run%plan, run%summary, error)
         if (allocated(error)) return
         call widen_system(scene%system, joined, scene%counter, error)
         if (allocated(error)) return
         call start_step(scene, model)
         call new_loading(run%loading, model, scene%dofs, scene%constraints, scene%solids, &
            & model%step(step), scene%accepted)
      end associate
   end subroutine remake

   subroutine keep_watch(self, stream)
      type(watch_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%seen%keep(stream)
      call stream%pass(self%drift%way)
      call self%artificial%keep(stream)
      call self%balance%keep(stream)
      call self%jumps%keep(stream)
      call self%checksum%keep(stream)
   end subroutine keep_watch

   !> Where the tools of the linear path were projected, and which points they reached.
   subroutine keep_search(self, stream)
      type(scene_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%place)
      call stream%pass(self%candidate)
      call keep_points(self%points, stream)
   end subroutine keep_search

   !> What changes where a tool is projected again.
   subroutine keep_points(self, stream)
      type(contact_points_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%facet)
      call stream%pass(self%xi)
      call stream%pass(self%normal)
      call stream%pass(self%foot)
      call stream%pass(self%gap)
      call stream%pass(self%start_facet)
      call stream%pass(self%start_foot)
      call stream%pass(self%start_normal)
   end subroutine keep_points

   !> The equations kept last are those that contact touched when the factor was made; others joined
   !> it since.
   subroutine keep_order(self, plan, joined, stream)
      type(scene_type), intent(inout) :: self
      type(plan_type), intent(in) :: plan
      integer, allocatable, intent(out) :: joined(:)
      type(stream_type), intent(inout) :: stream
      integer, allocatable :: last(:)
      integer :: i

      allocate (joined(0))
      if (plan%path /= path_of%condensed) return
      if (.not. stream%reading) then
         joined = self%system%late
         last = pack([(i, i=1, size(self%system%place))], self%system%place > size(joined))
      end if
      call stream%pass(last)
      call stream%pass(joined)
      if (stream%reading) call move_alloc(last, self%kept_last)
   end subroutine keep_order

   !> What the step found at its start; the rest follows from the model.
   subroutine keep_loading(self, stream)
      type(loading_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%start)
      call stream%pass(self%before)
      call stream%pass(self%from)
   end subroutine keep_loading

   !> The last answer of the contact problem, from which the next one starts.
   subroutine keep_answer(self, stream)
      type(contact_result_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%force)
      call stream%pass(self%gap)
      call stream%pass(self%q)
      call stream%pass(self%u)
      call stream%pass(self%active)
      call stream%pass(self%multiplier)
   end subroutine keep_answer

   subroutine keep_finite(self, stream, error)
      type(finite_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      if (.not. self%in_use) return
      call stream%pass(self%contraction%bend)
      call stream%pass(self%has_solved)
      call keep_followers(self%follower, stream)
      call keep_system(self%system, stream, error)
      if (allocated(error)) return
      call keep_contact(self%contact, stream, error)
   end subroutine keep_finite

   subroutine keep_followers(self, stream)
      type(follower_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%element)
      call stream%pass(self%face)
      call stream%pass(self%family)
      call stream%pass(self%amplitude)
      call stream%pass(self%from)
      call stream%pass(self%to)
      call stream%pass(self%varying)
      call stream%pass(self%steady)
      call stream%pass(self%pressure)
      call stream%pass(self%start)
      call stream%pass(self%period)
      call stream%pass(self%ramp)
      call stream%pass(self%force)
   end subroutine keep_followers

   !> The solver stays the one that was chosen at the first factorisation.
   subroutine keep_system(self, stream, error)
      type(finite_system_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: name

      if (allocated(self%solver)) name = self%solver%name()
      call stream%pass(name)
      call stream%pass(self%reason)
      call stream%pass(self%krylov)
      call stream%pass(self%most_krylov)
      call stream%pass(self%whole_factors)
      if (stream%reading .and. allocated(name)) call new_solver(self%solver, name, error)
   end subroutine keep_system

   subroutine keep_summary(self, stream)
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
   end subroutine keep_summary
end module lopin_checkpoint
