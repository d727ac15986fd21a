!> The only loop a reader must understand: steps, increments, solve, certify, accept, record.
module lopin_run_analysis
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_text, only : to_text
   use lopin_checksum, only : checksum_type
   use lopin_clock, only : phase, clock_type
   use lopin_memory, only : peak_memory
   use lopin_model, only : model_type, step_type
   use lopin_state, only : frame_type, summary_type
   use lopin_recorder, only : recorder_holder_type, wants_type
   use lopin_follower_loading, only : new_followers, set_followers
   use lopin_loading, only : loading_type, new_loading, loads_at, prescribed_at, add_ended_loads
   use lopin_friction, only : has_friction
   use lopin_plan, only : plan_type, new_plan, path_of
   use lopin_scene, only : scene_type, new_scene, set_supports, widen_reach
   use lopin_solve_path, only : prepare_path, solve_path
   use lopin_bodies, only : describe_motion
   use lopin_certificate, only : forces_type, find_forces, certify, worst_unrowed
   use lopin_finite_contact, only : accept_contact => accept, reject_contact => reject
   use lopin_finite_state, only : iteration_header
   use lopin_path_finite, only : start_step
   use lopin_finite_results, only : find_finite_forces, certify_finite
   use lopin_contact_friction, only : slides_with_friction
   use lopin_friction_state, only : commit_friction => commit, roll_back_friction => roll_back
   use lopin_frames, only : fill_frame
   use lopin_after_step, only : seen_type, look_at_pairs, judge_step, say_once, pair_that_slid
   use lopin_judge_yield, only : judge_yield
   implicit none
   private
   public :: run_analysis

   !> A failed increment is cut to this share; one that took few iterations grows; none is smaller
   !> than the last, beside the period, unless the deck says otherwise.
   real(wp), parameter :: cut = 0.25_wp, growth = 1.5_wp, smallest = 1.0e-6_wp
   integer, parameter :: few_iterations = 8

   !> What goes on from step to step.
   type :: progress_type
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: steady(:)       !! (ndof) loads to go on from
      real(wp), allocatable :: f(:), residual(:)
      real(wp) :: work = 0.0_wp                !! of loads and prescribed displacements
      type(seen_type) :: seen                  !! how near the pairs came
      real(wp), allocatable :: f_before(:), u_before(:), r_before(:)
      type(checksum_type) :: checksum          !! of the displacements of all nodes so far
   end type progress_type

contains

   !> Run all steps. `log` gets the warnings of the run; `error` what ended it.
   subroutine run_analysis(model, recorders, clock, summary, log, error)
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(clock_type), intent(in) :: clock              !! with the time spent so far
      type(summary_type), intent(out) :: summary
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(scene_type) :: scene
      type(plan_type) :: plan
      type(error_type), allocatable :: trouble
      integer :: i

      scene%clock = clock
      call scene%clock%start()
      summary%status = 'finished'
      summary%plan = ''
      summary%path = ''
      summary%solver = ''
      summary%checksum = ''
      allocate (summary%step(size(model%step)))
      call begin_all(recorders, model, error)
      if (.not. allocated(error)) call new_plan(plan, model, error)
      if (.not. allocated(error)) call new_scene(scene, model, error)
      if (.not. allocated(error)) call run_steps(scene, model, plan, recorders, summary, error)
      do i = 1, scene%log%n
         associate (d => scene%log%item(i))
            call log%say(d%severity, d%id, d%message, d%at, d%label, d%note, d%help)
         end associate
      end do
      if (allocated(error)) then
         summary%status = 'failed'
         if (error%code == error_code%not_converged) summary%status = 'not converged'
         summary%exit_code = error%code
      end if
      summary%clock = scene%clock
      summary%log = scene%log
      summary%peak_memory = peak_memory()
      do i = 1, size(recorders)
         call recorders(i)%recorder%finish(model, summary, error, trouble)
         if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
      end do
   end subroutine run_analysis

   subroutine begin_all(recorders, model, error)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(recorders)
         call recorders(i)%recorder%begin(model, error)
         if (allocated(error)) return
      end do
   end subroutine begin_all

   subroutine say(recorders, line)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      character(len=*), intent(in) :: line
      integer :: i
      do i = 1, size(recorders)
         call recorders(i)%recorder%line(line)
      end do
   end subroutine say

   subroutine run_steps(scene, model, plan, recorders, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(progress_type) :: progress
      integer :: step
      logical :: same

      allocate (progress%steady(scene%dofs%n), progress%f(scene%dofs%n), &
         & progress%residual(scene%dofs%n), &
         & progress%f_before(scene%dofs%n), progress%u_before(scene%dofs%n), &
         & progress%r_before(scene%dofs%n), &
         & source=0.0_wp)
      do step = 1, size(model%step)
         scene%counter%factorisations = 0
         scene%counter%back_solves = 0
         scene%counter%iterations = 0
         scene%counter%augmentations = 0
         call set_supports(scene, model, step, same, error)
         if (allocated(error)) return
         if (.not. same) then
            call check_supports(scene, model, error)
            if (allocated(error)) return
            call prepare(scene, model, plan, recorders, summary, error)
            if (allocated(error)) return
         end if
         call run_step(scene, model, plan, progress, recorders, summary, error)
         summary%step(step)%counter = scene%counter
         if (allocated(error)) return
      end do
   end subroutine run_steps

   !> Without contact nothing may float.
   subroutine check_supports(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: q(:)

      if (scene%bodies%nq == 0 .or. any(scene%points%facet(:scene%points%n) > 0)) return
      allocate (q(scene%bodies%nq), source=0.0_wp)
      q(1) = 1.0_wp
      call raise(error, error_code%singular, 'E0310', describe_motion(scene%bodies, model, q)// &
         & ': nothing holds it', &
         & model%step(scene%step)%at, note=to_text(scene%bodies%nq)//' rigid motions are free', &
         & help='fix degrees of freedom by *BOUNDARY, or add the contact that holds the body')
   end subroutine check_supports

   subroutine prepare(scene, model, plan, recorders, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error

      call prepare_path(scene, model, plan, summary, error)
      if (.not. allocated(error)) call say(recorders, summary%plan)
   end subroutine prepare

   subroutine run_step(scene, model, plan, progress, recorders, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      type(loading_type) :: loading
      type(frame_type) :: frame
      real(wp) :: time, increment
      integer :: number

      frame%last_of_step = .false.
      associate (step => model%step(scene%step))
         call new_loading(loading, model, scene%dofs, scene%constraints, scene%solids, step, &
            & progress%time, &
            & progress%steady, scene%accepted)
         time = 0.0_wp
         increment = min(step%initial, step%period)
         call start_step(scene, model)
         if (step%nlgeom) call new_followers(scene%finite%follower, step, progress%time, &
            & scene%dofs%n)
         do number = 1, step%max_increments
            frame%increment = number
            call advance(scene, model, plan, loading, progress, recorders, summary, time, &
               & increment, frame, error)
            if (allocated(error)) return
            call judge_yield(scene, model, frame%u)
            summary%step(scene%step)%increments = number
            if (frame%last_of_step) exit
            if (.not. step%direct .and. (plan%path /= path_of%finite &
               & .or. frame%iterations <= few_iterations)) increment = growth*increment
            if (step%largest > 0.0_wp) increment = min(increment, step%largest)
         end do
         if (.not. frame%last_of_step) then
            call raise(error, error_code%not_converged, 'E0503', 'step '//to_text(scene%step)// &
               & ' reached time '// &
               & to_text(time)//' of '//to_text(step%period)//' in the '// &
               & to_text(step%max_increments)// &
               & ' increments that INC= allows', step%at, &
               & help='raise INC= on *STEP, or the increments on *STATIC')
         end if
         progress%time = progress%time + time
         if (scene%step < size(model%step)) call add_ended_loads(loading, model, scene%dofs, &
            & scene%constraints, &
            & scene%solids, step, model%step(scene%step + 1), progress%steady)
         call judge_step(scene, model, progress%seen)
      end associate
   end subroutine run_step

   !> One increment from `time`: tried, cut and tried again until it is accepted or cannot be cut.
   subroutine advance(scene, model, plan, loading, progress, recorders, summary, time, increment, &
      & frame, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(loading_type), intent(in) :: loading
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      real(wp), intent(inout) :: time, increment
      type(frame_type), intent(inout) :: frame
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: target_time

      associate (step => model%step(scene%step))
         frame%attempt = 1
         do
            target_time = time + increment
            if (time + increment*(1.0_wp + 1.0e-9_wp) >= step%period) target_time = step%period
            increment = target_time - time
            frame%step = scene%step
            frame%step_time = target_time
            frame%total_time = progress%time + target_time
            frame%time_increment = increment
            frame%last_of_step = .not. target_time < step%period
            scene%finite%dt = increment
            call solve_increment(scene, model, plan, loading, progress, recorders, summary, frame, &
               & error)
            if (.not. allocated(error)) exit
            if (frame%certificate%verdict == 2) return
            if (.not. may_cut(plan, scene, step, increment, error)) return
            call reject(scene)
            call say(recorders, 'step '//to_text(scene%step)//', increment '// &
               & to_text(frame%increment)//', attempt '//to_text(frame%attempt)//': cut to '// &
               & to_text(cut*increment, 4)//', because '//error%item(1)%message)
            deallocate (error)
            increment = cut*increment
            frame%attempt = frame%attempt + 1
         end do
         time = target_time
      end associate
   end subroutine advance

   !> What did not converge may do so in smaller increments, where the path depends on them.
   logical function may_cut(plan, scene, step, increment, error)
      type(plan_type), intent(in) :: plan
      type(scene_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: increment
      type(error_type), intent(in) :: error

      may_cut = (plan%path == path_of%finite .or. slides_with_friction(scene)) .and. error%code == error_code%not_converged &
         & .and. .not. step%direct &
         & .and. cut*increment >= max(step%smallest, smallest*step%period)
   end function may_cut

   !> Back to the accepted state.
   subroutine reject(scene)
      type(scene_type), intent(inout) :: scene

      scene%u = scene%accepted
      call roll_back_friction(scene%friction)
      if (scene%finite%in_use) call reject_contact(scene%finite%contact)
   end subroutine reject

   !> Solve, look at every gap, certify, accept, record.
   subroutine solve_increment(scene, model, plan, loading, progress, recorders, summary, frame, &
      & error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(loading_type), intent(in) :: loading
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(frame_type), intent(inout) :: frame
      type(error_type), allocatable, intent(out) :: error
      type(forces_type) :: forces
      real(wp), allocatable :: prescribed(:), steady(:)

      allocate (prescribed(scene%constraints%nprescribed), steady(scene%dofs%n))
      call loads_at(loading, model, frame%step_time, progress%f, steady)
      call prescribed_at(loading, model, frame%step_time, prescribed)
      if (scene%finite%nlgeom) call set_followers(scene%finite%follower, model, frame%step_time)
      scene%interference = 1.0_wp
      if (scene%step == 1) scene%interference = frame%step_time/loading%period
      call solve_path(scene, model, plan, progress%f, prescribed, error)
      call say_iterations(recorders, scene, frame)
      if (allocated(error)) return
      if (.not. scene%finite%in_use) then
         call close_condensed(scene, model, plan, prescribed, progress, recorders, summary, forces, &
            & frame, error)
         if (allocated(error)) return
         if (slides_away(scene, model, plan)) then
            call change_to_finite(scene, model, plan, recorders, summary, error)
            if (allocated(error)) return
            call solve_path(scene, model, plan, progress%f, prescribed, error)
            call say_iterations(recorders, scene, frame)
            if (allocated(error)) return
         end if
      end if
      if (scene%finite%in_use) then
         if (scene%finite%nlgeom) progress%f = progress%f + scene%finite%follower%force
         call find_finite_forces(forces, scene, progress%f)
         progress%residual = forces%residual
         call certify_finite(frame%certificate, frame%energy, scene, model, forces)
         frame%iterations = scene%finite%iterations
         frame%augmentations = scene%finite%augmentations
      end if
      call scene%clock%stop_in(phase%solve)
      call warn_of(scene, model, frame)
      call add_work(scene, progress, frame)
      call accept(scene, progress, steady)
      call look_at_pairs(progress%seen, scene, model)
      call record(scene, model, forces%reaction, recorders, frame, error)
      if (allocated(error)) return
      call progress%checksum%add(frame%u(:3, :))
      summary%checksum = progress%checksum%text()
      if (frame%certificate%verdict == 2) call raise(error, error_code%not_converged, 'E0504', &
         & 'the certificate of step '// &
         & to_text(frame%step)//', increment '//to_text(frame%increment)//' fails: '// &
         & frame%certificate%reason, &
         & model%step(scene%step)%at, help='see lopin explain E0504')
   end subroutine solve_increment

   !> What the iterations of the finite path did.
   subroutine say_iterations(recorders, scene, frame)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(scene_type), intent(in) :: scene
      type(frame_type), intent(in) :: frame
      integer :: i

      if (.not. scene%finite%in_use .or. scene%finite%nline == 0) return
      call say(recorders, 'step '//to_text(frame%step)//', increment '//to_text(frame%increment)// &
         & ', attempt '//to_text(frame%attempt)//', time increment '// &
         & to_text(frame%time_increment, 4))
      call say(recorders, iteration_header)
      do i = 1, scene%finite%nline
         call say(recorders, trim(scene%finite%line(i)))
      end do
   end subroutine say_iterations

   !> The trial slides farther than the linear path follows, and nothing forbids to change the path:
   !> contact without friction has no history that would be lost.
   logical function slides_away(scene, model, plan)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      integer :: pair

      slides_away = .false.
      if (plan%by_user .or. plan%path /= path_of%condensed) return
      do pair = 1, size(model%pair)
         if (has_friction(model%interaction(model%pair(pair)%interaction)%friction)) return
      end do
      slides_away = pair_that_slid(scene, model) > 0
   end function slides_away

   !> From the accepted state on, contact is followed on the present shape.
   subroutine change_to_finite(scene, model, plan, recorders, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(inout) :: plan
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error

      plan%path = path_of%finite
      plan%reason = 'a node slides by more than a quarter of its facet'
      scene%u = scene%accepted
      call prepare(scene, model, plan, recorders, summary, error)
   end subroutine change_to_finite

   !> Look at the points without a row, and certify what the condensed paths found.
   subroutine close_condensed(scene, model, plan, prescribed, progress, recorders, summary, forces, &
      & frame, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      real(wp), intent(in) :: prescribed(:)
      type(progress_type), intent(inout) :: progress
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(summary_type), intent(inout) :: summary
      type(forces_type), intent(out) :: forces
      type(frame_type), intent(inout) :: frame
      type(error_type), allocatable, intent(out) :: error

      if (worst_unrowed(scene, model) > 0.0_wp) then
         call widen_reach(scene)
         call say(recorders, 'points beyond the first reach penetrate: all slave points get a '// &
            & 'row, factorised again')
         call prepare(scene, model, plan, recorders, summary, error)
         if (allocated(error)) return
         call solve_path(scene, model, plan, progress%f, prescribed, error)
         if (allocated(error)) return
      end if
      call find_forces(forces, scene, progress%f)
      progress%residual = forces%residual
      call certify(frame%certificate, frame%energy, scene, model, forces, prescribed)
      frame%iterations = scene%answer%iterations
      frame%augmentations = scene%answer%augmentations
   end subroutine close_condensed

   !> Work of everything that moves the boundary, by the trapezoidal rule over the increment.
   subroutine add_work(scene, progress, frame)
      type(scene_type), intent(in) :: scene
      type(progress_type), intent(inout) :: progress
      type(frame_type), intent(inout) :: frame

      progress%work = progress%work + 0.5_wp*dot_product(progress%f + progress%f_before &
         & + progress%residual &
         & + progress%r_before, scene%u - progress%u_before)
      frame%energy%external = progress%work
      progress%f_before = progress%f
      progress%r_before = progress%residual
      progress%u_before = scene%u
   end subroutine add_work

   subroutine accept(scene, progress, steady)
      type(scene_type), intent(inout) :: scene
      type(progress_type), intent(inout) :: progress
      real(wp), intent(in) :: steady(:)
      integer :: row

      scene%accepted = scene%u
      progress%steady = steady
      if (scene%finite%in_use) then
         scene%finite%accepted_multiplier = scene%finite%multiplier
         call accept_contact(scene%finite%contact, scene%u, scene%finite%multiplier)
         return
      end if
      call commit_friction(scene%friction)
      do row = 1, scene%rows%nnormal
         if (scene%answer%active(row)) scene%sticks(scene%rows%point(row)) = .true.
      end do
   end subroutine accept

   subroutine warn_of(scene, model, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame

      if (frame%certificate%verdict == 1) call say_once(scene%log, 'W0504', &
         & 'certificate of step '// &
         & to_text(frame%step)//', increment '//to_text(frame%increment)//': '// &
         & frame%certificate%reason, &
         & model%step(scene%step)%at)
      if (scene%answer%dependent > 0) call say_once(scene%log, 'W0403', &
         & to_text(scene%answer%dependent)// &
         & ' contact rows depend on supports or on other rows: their forces are '// &
         & 'shared in the way of least norm', model%step(scene%step)%at, &
         & help='do not fix slave nodes along the contact normal, and list a pair of surfaces once')
   end subroutine warn_of

   subroutine record(scene, model, reaction, recorders, frame, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: reaction(:)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(frame_type), intent(inout) :: frame
      type(error_type), allocatable, intent(out) :: error
      type(wants_type) :: wants, more
      integer :: i

      do i = 1, size(recorders)
         more = recorders(i)%recorder%wants(model, frame)
         wants%stress = wants%stress .or. more%stress
         wants%strain = wants%strain .or. more%strain
         wants%nodal_stress = wants%nodal_stress .or. more%nodal_stress
      end do
      call fill_frame(frame, scene, model, reaction, wants)
      do i = 1, size(recorders)
         call recorders(i)%recorder%increment(model, frame, error)
         if (allocated(error)) exit
      end do
      call scene%clock%stop_in(phase%output)
   end subroutine record
end module lopin_run_analysis
