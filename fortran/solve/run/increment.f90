!> One increment: solve on the planned path, look at every gap, certify, accept, record.
!>
!> What fails before it is accepted leaves the accepted state untouched; `reject` drops the trial.
module lopin_increment
   use lopin_kinds, only : wp
   use lopin_state, only : begin, accept, reject_state => reject
   use lopin_error, only : error_type, error_code, raise, log_type
   use lopin_text, only : to_text
   use lopin_clock, only : phase
   use lopin_model, only : model_type
   use lopin_report, only : frame_type, lost_share
   use lopin_recorder, only : recorder_holder_type, wants_type
   use lopin_follower_loading, only : set_followers
   use lopin_straight_loads, only : follow_line
   use lopin_loading, only : loads_at, prescribed_at
   use lopin_friction, only : has_friction
   use lopin_plan, only : plan_type, path_of
   use lopin_run_type, only : run_type
   use lopin_scene, only : scene_type
   use lopin_solver_state, only : start_solver
   use lopin_overconstrained, only : report_dependent, refuse_held_penetration
   use lopin_contact_candidates, only : some_penetrate, add_candidates, add_nearest_candidates, &
      & all_are_candidates
   use lopin_solve_path, only : prepare_path, widen_path, solve_linear
   use lopin_path_nonlinear, only : solve_nonlinear
   use lopin_tell_ties, only : tell_of_ties
   use lopin_initial_contact, only : apply_overclosures
   use lopin_torn_ties, only : refuse_torn_ties
   use lopin_certificate, only : forces_type, find_forces, certify
   use lopin_newton_workspace, only : iteration_header
   use lopin_held_points, only : refuse_held_points, tell_idle_points
   use lopin_recover_nonlinear, only : remember
   use lopin_heat_work, only : add_heat_work
   use lopin_limit_increment, only : limit_increment
   use lopin_vectors, only : largest
   use lopin_nonlinear_results, only : find_nonlinear_forces, certify_nonlinear, report_nonlinear
   use lopin_frames, only : fill_frame
   use lopin_leave_increment, only : add_work, check_solids, leave_trial
   use lopin_check_traction, only : check_traction
   use lopin_check_drift, only : measure_drift
   use lopin_check_mesh, only : check_mesh, refuse_fold
   use lopin_after_step, only : record_increment
   use lopin_repeated_messages, only : warn_once
   use lopin_refuse_passage, only : refuse_passage
   use lopin_refuse_free_motion, only : refuse_free_motion
   use lopin_refuse_turn, only : refuse_turn
   use lopin_refuse_leap, only : refuse_leap
   use lopin_refuse_lost_rows, only : refuse_lost_rows
   use lopin_touch_order, only : check_touch_order
   use lopin_small_displacements, only : pair_that_slid
   use lopin_tell_watcher, only : tell_of_plan, tell_of_increment
   use lopin_across_gaps, only : across_type, find_across_gaps, report_across_gaps
   implicit none
   private
   public :: solve_increment, reject, prepare, say

contains

   !> Back to the accepted state.
   subroutine reject(scene)
      type(scene_type), intent(inout) :: scene

      call reject_state(scene%trial, scene%accepted)
      scene%newton%contact%nlocal = 0
   end subroutine reject

   !> Solve, look at every gap, certify, accept, record.
   subroutine solve_increment(run, model, recorders, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      type(forces_type) :: forces

      call begin(run%scene%trial, run%scene%accepted)
      call start_solver(run%scene)
      call find_trial(run, model, recorders, forces, error)
      if (.not. allocated(error)) call measure_trial(run, model, forces, error)
      if (.not. allocated(error)) call refuse_leap(run%scene, model, forces, run%watch%balance, &
         & run%frame%energy, error)
      if (allocated(error)) return
      associate (scene => run%scene, watch => run%watch, frame => run%frame)
         call add_work(scene, forces, watch%balance, frame)
         call check_solids(scene, model, watch, forces%pressed, frame)
         ! Told, and judged by what increments may miss (W0530): no part of the verdict.
         frame%certificate%flows = scene%newton%flows
         if (scene%newton%flows) frame%certificate%energy = abs(lost_share(frame%energy))
         call measure_drift(watch%drift, scene, model, forces%load, forces%pressed)
         call leave_trial(scene, model, frame)
         call record_increment(watch%seen, scene, model, frame%increment, &
            & frame%certificate%rubs%ramp)
         if (scene%newton%nlgeom) call check_mesh(scene, model, frame%increment)
         call scene%clock%stop_in(phase%check)
         call record(scene, model, forces%reaction, recorders, frame, error)
         if (allocated(error)) return
         call accept(scene%accepted, scene%trial)
         call tell_of_increment(scene, model, frame)
         if (run%plan%path == path_of%nonlinear) call tell_of_ties(run, model, recorders)
         call watch%checksum%add(frame%u(:3, :))
         run%summary%checksum = watch%checksum%text()
         call scene%clock%stop_in(phase%check)
         if (frame%certificate%verdict == 2) call refuse_verdict(scene, model, frame, error)
      end associate
   end subroutine solve_increment

   !> Displacements and tractions for the end of the increment; its forces, but for the tractions of
   !> the nonlinear path.
   subroutine find_trial(run, model, recorders, forces, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(forces_type), intent(out) :: forces
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: prescribed(:), f(:), steady(:)
      type(across_type) :: across

      associate (scene => run%scene, frame => run%frame, loading => run%loading)
         allocate (prescribed(scene%constraints%nprescribed), f(scene%dofs%n), steady(scene%dofs%n))
         call loads_at(loading, model, frame%step_time, f, steady)
         call prescribed_at(loading, model, frame%step_time, prescribed)
         if (scene%newton%nlgeom) call set_followers(scene%newton%follower, model, frame%step_time)
         call apply_overclosures(scene%newton%contact, model, scene%step, &
            & scene%accepted%clock%time, frame%step_time, loading%period)
         scene%interference = scene%newton%contact%early_share
         call refuse_torn_ties(scene, model, prescribed, error)
         if (allocated(error)) return
         if (run%plan%path == path_of%nonlinear) then
            call solve_nonlinear(scene, model, f, prescribed, error)
         else
            call solve_with_candidates(run, model, f, prescribed, recorders, error)
         end if
         forces%load = f
         call move_alloc(steady, scene%trial%loads%steady)
         call log_iterations(recorders, scene, frame)
         if (.not. allocated(error)) call refuse_passage(scene, model, error)
         if (.not. allocated(error)) call refuse_free_motion(scene, model, prescribed, error)
         if (.not. allocated(error)) call check_touch_order(scene, model, &
            & model%step(scene%step)%direct, error)
         if (.not. allocated(error)) call refuse_turn(scene, model, error)
         if (allocated(error)) return
         call scene%clock%stop_in(phase%search)
         if (scene%newton%in_use) return
         call close_condensed(scene, model, prescribed, forces, frame)
         call find_across_gaps(across, scene, model)
         call scene%clock%stop_in(phase%check)
         if (.not. (slides_away(scene, model, run%plan) &
            & .or. leaves_gap(across, scene, model, run%plan))) then
            call report_across_gaps(across, scene, model)
            return
         end if
         steady = scene%trial%loads%steady
         call switch_to_nonlinear(run, model, recorders, across%pair > 0, error)
         if (allocated(error)) return
         call move_alloc(steady, scene%trial%loads%steady)
         call solve_nonlinear(scene, model, f, prescribed, error)
         call log_iterations(recorders, scene, frame)
         if (.not. allocated(error)) call refuse_passage(scene, model, error)
         if (.not. allocated(error)) call refuse_turn(scene, model, error)
      end associate
   end subroutine find_trial

   !> Forces, certificate and memory of a trial of the nonlinear path; work and heat of its solids.
   subroutine measure_trial(run, model, forces, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(forces_type), intent(inout) :: forces
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: f(:)

      associate (scene => run%scene, frame => run%frame, &
         & memory => run%scene%trial%solids)
         if (scene%newton%in_use) then
            f = forces%load
            if (scene%newton%nlgeom) f = f + scene%newton%follower%force
            call find_nonlinear_forces(forces, scene, f)
            frame%energy%external = scene%accepted%loads%work
            call certify_nonlinear(frame%certificate, frame%energy, scene, model, forces)
            call refuse_held_points(scene, model, error)
            if (.not. allocated(error)) call refuse_fold(scene, model, frame%certificate, error)
            if (allocated(error)) return
            call tell_idle_points(scene, model)
            call report_nonlinear(scene, model)
            frame%iterations = scene%newton%iterations
            frame%augmentations = scene%newton%augmentations
         end if
         call scene%clock%stop_in(phase%solve)
         if (scene%answer%dependent > 0) call report_dependent(scene, model)
         if (.not. scene%newton%in_use) return
         call remember(scene%solids, model%mesh, scene%trial%motion%u, scene%newton%past, memory)
         call limit_increment(scene, model, forces%load, error)
         if (.not. allocated(error)) call refuse_lost_rows(scene, model, error)
         if (allocated(error)) return
         call add_heat_work(scene, model)
         frame%energy%plastic = memory%work
         frame%energy%thermal = memory%heat
         frame%energy%nothing = memory%unsure + sum(scene%newton%floor)*largest( &
            & scene%trial%motion%u)
         frame%energy%volume = memory%volume
      end associate
   end subroutine measure_trial

   !> An answer that fails its certificate ends the run.
   subroutine refuse_verdict(scene, model, frame, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error

      if (.not. scene%newton%in_use) call refuse_held_penetration(scene, model, &
         & frame%certificate%reason, error)
      if (.not. allocated(error)) call raise(error, error_code%not_converged, 'E0504', &
         & 'the certificate of step '//to_text(frame%step)//', increment '// &
         & to_text(frame%increment)//' fails: '//frame%certificate%reason, &
         & model%step(scene%step)%at, help='see lopin explain E0504')
   end subroutine refuse_verdict

   !> What the iterations of the nonlinear path did.
   subroutine log_iterations(recorders, scene, frame)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(scene_type), intent(in) :: scene
      type(frame_type), intent(in) :: frame
      integer :: i

      if (.not. scene%newton%in_use .or. scene%newton%nline == 0) return
      call say(recorders, 'step '//to_text(frame%step)//', increment '//to_text(frame%increment)// &
         & ', attempt '//to_text(frame%attempt)//', time increment '// &
         & to_text(frame%time_increment, 4))
      call say(recorders, iteration_header)
      do i = 1, scene%newton%nline
         call say(recorders, trim(scene%newton%line(i)))
      end do
   end subroutine log_iterations

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

   !> The trial presses across a gap, and nothing forbids to change the path: no node that has
   !> touched has a history of friction.
   logical function leaves_gap(across, scene, model, plan) result(leaves)
      type(across_type), intent(in) :: across
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      integer :: pair

      leaves = .false.
      if (across%pair == 0 .or. plan%by_user .or. plan%path /= path_of%condensed) return
      leaves = .true.
      if (.not. any(scene%accepted%friction%closed)) return
      do pair = 1, size(model%pair)
         leaves = leaves .and. .not. has_friction(model%interaction( &
            & model%pair(pair)%interaction)%friction)
      end do
   end function leaves_gap

   !> From the accepted state on, contact is followed on the present shape.
   subroutine switch_to_nonlinear(run, model, recorders, across, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      logical, intent(in) :: across            !! not for slip, but for a gap
      type(error_type), allocatable, intent(out) :: error

      run%plan%path = path_of%nonlinear
      run%plan%reason = 'a node slides by more than a quarter of its facet'
      if (across) run%plan%reason = 'means over facets would press across a gap'
      run%scene%trial%motion%u = run%scene%accepted%motion%u
      call prepare(run, model, recorders, error)
   end subroutine switch_to_nonlinear

   !> Solve with rows for the points within reach, and again for more where others would press, or
   !> where those do not hold the bodies.
   subroutine solve_with_candidates(run, model, f, prescribed, recorders, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      type(log_type) :: log
      integer :: round

      round = 0
      associate (scene => run%scene, plan => run%plan)
         call follow_line(scene%straight, run%loading, model, scene%step, run%frame%step_time, f, &
            & prescribed)
         do
            log = scene%log
            call solve_linear(scene, model, plan, f, prescribed, error)
            if (all_are_candidates(scene)) return
            if (.not. allocated(error)) then
               if (.not. some_penetrate(scene, model)) return
            else if (all(error%code /= [error_code%singular, error_code%not_converged])) then
               return
            end if
            round = round + 1
            if (allocated(error)) then
               deallocate (error)
               call add_nearest_candidates(scene, model, round)
            else
               call add_candidates(scene, model, round)
            end if
            call reject(scene)
            scene%log = log
            call widen_path(scene, model, plan, run%summary, error)
            if (allocated(error)) return
            call say(recorders, 'more slave points come within reach: '// &
               & run%summary%plan)
         end do
      end associate
   end subroutine solve_with_candidates

   !> Certify what the condensed paths found.
   subroutine close_condensed(scene, model, prescribed, forces, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)
      type(forces_type), intent(inout) :: forces   !! loads are known
      type(frame_type), intent(inout) :: frame
      real(wp), allocatable :: f(:)

      call move_alloc(forces%load, f)
      call find_forces(forces, scene, f)
      frame%energy%external = scene%accepted%loads%work
      call certify(frame%certificate, frame%energy, scene, model, forces, prescribed)
      frame%iterations = scene%answer%iterations
      frame%augmentations = scene%answer%augmentations
   end subroutine close_condensed

   subroutine warn_of(scene, model, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame

      if (frame%certificate%verdict == 1) call warn_once(scene%log, 'W0504', &
         & 'certificate of step '//to_text(frame%step)//', increment '// &
         & to_text(frame%increment)//': '//frame%certificate%reason, model%step(scene%step)%at)
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
      call check_traction(frame, scene, model)
      call warn_of(scene, model, frame)
      do i = 1, size(recorders)
         call recorders(i)%recorder%increment(model, frame, error)
         if (allocated(error)) exit
      end do
      call scene%clock%stop_in(phase%output)
   end subroutine record

   !> Factors of the path that was planned, and the line that says so.
   subroutine prepare(run, model, recorders, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error

      call prepare_path(run%scene, model, run%plan, run%summary, error)
      if (allocated(error)) return
      call say(recorders, run%summary%plan)
      call tell_of_plan(run%scene, model, run%summary%plan)
   end subroutine prepare

   !> Show a line to every recorder.
   subroutine say(recorders, line)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      character(len=*), intent(in) :: line
      integer :: i
      do i = 1, size(recorders)
         call recorders(i)%recorder%line(line)
      end do
   end subroutine say
end module lopin_increment
