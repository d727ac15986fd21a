!> Semismooth Newton on displacements and contact tractions together, for finite sliding, finite
!> rotation and finite strain: project at the present positions, assemble forces and exact tangents,
!> solve, take the step that a non-monotone line search allows.
module lopin_semismooth_newton
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_interrupt, only : answer_interrupt
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_newton_refinement, only : refine
   use lopin_newton_workspace, only : add_line
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_newton_convergence, only : converged, relative, reference_of, equilibrium, &
      & correction, floor_of_rounding
   use lopin_predictor, only : iterate_type, start_from_accepted
   use lopin_newton_step, only : some_body_falls, find_step
   use lopin_line_search, only : search_type, take_step, refuse_inverted
   use lopin_contraction, only : by_old_tangent, evaluate_without_tangent, note_step, gets_nowhere
   use lopin_awaited_touch, only : awaited_type, note_slides, await_touch, go_on_waiting
   use lopin_lagged_friction, only : reads_lagged, renew_lagged, share_of_new, may_relax
   use lopin_free_body, only : raise_free_body
   use lopin_first_increment, only : size_first, flows_far
   use lopin_held_tools, only : start_motion
   use lopin_scene, only : scene_type
   use lopin_tell_watcher, only : tell_of_iteration
   use lopin_newton_report, only : log_iteration, raise_not_converged
   use lopin_eased_friction, only : jams_type, ease_returning
   implicit none
   private
   public :: solve_newton

   integer, parameter :: most_sets = 400, most_iterations = 30, most_lagged = 200, memory = 4
   !> Solids that flow do better in smaller increments than in more iterations.
   integer, parameter :: most_of_flow = 40
   !> Steps of which so little is taken, this often in a row, lead to no end in few iterations.
   real(wp), parameter :: creeps = 0.05_wp
   integer, parameter :: most_creeping = 4
   !> Residuals below which the tangent hardly changes any more.
   real(wp), parameter :: nearly = 1.0e-2_wp
   !> So many returns to sets of contact met before are a cycle.
   integer, parameter :: cycle_of = 3
   !> An increment this often the smallest one can still be cut.
   real(wp), parameter, public :: least_cuts = 4.0_wp

   type :: iteration_type
      type(evaluation_type) :: evaluation      !! where it stands
      type(search_type) :: search              !! to there
      type(awaited_type) :: awaited            !! points that do not close yet
      type(jams_type) :: jams                  !! points that come back to what they were
      integer :: loop = 0                      !! augmentations so far
      logical :: guessed = .false.             !! it started from a guess
      logical :: lagged = .false.              !! laws read what the last iteration found
      integer :: number = 0
      real(wp), allocatable :: remaining(:)    !! (ndof) still to be prescribed
      real(wp) :: merits(memory) = 0.0_wp      !! of the last looks
      real(wp) :: last = huge(1.0_wp)          !! size of the last step
      integer :: seen(most_sets) = 0           !! sets of contact met
      integer :: stale = 0                     !! of those, met again
      integer :: creeping = 0                  !! last steps of which little was taken
      integer, allocatable :: status(:)        !! (npoint) of contact before the last step
      logical :: fresh = .false.               !! the set has changed, without friction
   end type iteration_type

contains

   !> Newton to equilibrium at the prescribed values.
   subroutine solve_newton(scene, model, f, iterate, prescribed, loop, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      type(iterate_type), intent(inout) :: iterate
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      integer, intent(in) :: loop              !! augmentations so far
      type(error_type), allocatable, intent(out) :: error
      type(iteration_type) :: it
      integer :: iteration
      logical :: settled

      it%search%load = f
      it%search%prescribed = prescribed
      it%loop = loop
      it%lagged = reads_lagged(scene)
      scene%newton%cycled = .false.
      it%status = [integer ::]
      scene%newton%history = [real(wp) ::]
      it%guessed = iterate%guessed .and. loop == 0
      scene%newton%contact%noted = merge(scene%newton%contact%ahead, 0.0_wp, it%guessed)
      if (scene%bodies%nq > 0 .and. loop == 0) scene%newton%contact%enforcement%clings = .true.
      call start_motion(scene%newton%contact)
      call evaluate(scene, model, f, .true., it%evaluation, error)
      scene%newton%contact%noted = 0.0_wp
      if (.not. allocated(error)) call look_at_start(it, scene, model, iterate, error)
      if (allocated(error)) return
      do iteration = 1, most_sets
         call answer_interrupt(error)
         if (allocated(error)) return
         it%number = iteration
         call look_for_end(it, scene, model, settled, error)
         if (allocated(error)) return
         if (settled .and. .not. it%awaited%on) then
            if (iteration > 1 .and. it%evaluation%merit > floor_of_rounding*reference_of(scene, &
               & it%evaluation) .and. .not. scene%newton%flows) &
               & call refine(scene, model, f, iterate%v, prescribed, it%evaluation, error)
            scene%newton%reference = reference_of(scene, it%evaluation)
            scene%newton%has_solved = .true.
            return
         end if
         scene%newton%iterations = scene%newton%iterations + 1
         call note_set(it, scene)
         if (is_vain(it, scene, model)) exit
         call correct(it, scene, model, iterate, error)
         if (it%awaited%on) call go_on_waiting(it%awaited, scene, model, it%search, iterate%v, &
            & it%evaluation, error)
         if (allocated(error)) return
      end do
      scene%newton%cycled = it%stale >= cycle_of
      if (scene%newton%grounded > 0 .and. scene%bodies%nq > 0) then
         call raise_free_body(scene, model, error)
      else
         call raise_not_converged(scene, model, it%evaluation, it%status, error)
      end if
   end subroutine solve_newton

   !> Where the iteration starts: not from a guess that folds; what is still to be prescribed.
   subroutine look_at_start(it, scene, model, iterate, error)
      type(iteration_type), intent(inout) :: it
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(iterate_type), intent(inout) :: iterate
      type(error_type), allocatable, intent(out) :: error

      associate (prescribed => it%search%prescribed)
         if (it%evaluation%inverted > 0 .and. it%guessed) then
            call start_from_accepted(scene, iterate)
            call evaluate(scene, model, it%search%load, .true., it%evaluation, error)
            if (allocated(error)) return
         end if
         if (it%evaluation%inverted > 0) call refuse_inverted(scene, model, it%evaluation, error)
         if (allocated(error)) return
         allocate (it%remaining(scene%dofs%n), source=0.0_wp)
         if (size(prescribed) > 0) call expand(scene%constraints, 0.0_wp*iterate%v, &
            & prescribed - iterate%before, it%remaining)
         if (it%loop == 0 .and. scene%newton%flows .and. any(abs(it%remaining) > 0.0_wp)) &
            & call open_leaving_pairs(it, scene, model, iterate, error)
      end associate
      scene%newton%began = it%evaluation%force
      scene%newton%reference = it%evaluation%force
      scene%newton%correction = 0.0_wp
   end subroutine look_at_start

   !> What laws read in part is read in full before it counts.
   subroutine look_for_end(it, scene, model, settled, error)
      type(iteration_type), intent(inout) :: it
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(out) :: settled
      type(error_type), allocatable, intent(out) :: error

      ! What the increment brings is about once it is applied; a trial far out moves it no more.
      if (it%number == 2) scene%newton%reference = max(scene%newton%reference, it%evaluation%force)
      scene%newton%history = [scene%newton%history, relative(it%evaluation, &
         & scene%newton%reference)]
      settled = has_settled(it, scene)
      if (.not. (settled .and. it%lagged)) return
      if (.not. share_of_new(scene%newton%history) < 1.0_wp) return
      call renew_lagged(scene, 1.0_wp)
      call evaluate(scene, model, it%search%load, .true., it%evaluation, error)
      if (allocated(error)) return
      settled = has_settled(it, scene)
   end subroutine look_for_end

   logical function has_settled(it, scene)
      type(iteration_type), intent(in) :: it
      type(scene_type), intent(in) :: scene
      logical :: unchanged

      unchanged = it%number == 1 .or. hash_of(scene%newton%contact%status) &
         & == it%seen(max(1, it%number - 1))
      has_settled = converged(scene, it%evaluation, it%remaining, it%number, it%loop, it%last, &
         & unchanged)
   end function has_settled

   !> The set of contact: a front may open point by point, and sets not met before are progress.
   subroutine note_set(it, scene)
      type(iteration_type), intent(inout) :: it
      type(scene_type), intent(in) :: scene

      associate (i => it%number, seen => it%seen)
         seen(i) = hash_of(scene%newton%contact%status)
         if (any(seen(:i - 1) == seen(i))) it%stale = it%stale + 1
         it%fresh = .false.
         if (i > 1 .and. scene%newton%frictionless) it%fresh = seen(i) /= seen(max(1, i - 1))
      end associate
   end subroutine note_set

   !> More iterations promise nothing.
   logical function is_vain(it, scene, model)
      type(iteration_type), intent(in) :: it
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      is_vain = it%stale > merge(most_lagged, most_iterations, it%lagged)
      if (is_vain .or. .not. scene%newton%flows) return
      if (it%lagged .and. may_relax(scene%newton%history)) return
      ! What has nothing to go on from, as a sheet between flat tools or a body that springs
      ! back, loses contact node by node in any increment: slow, but it gets on. Metal that flows
      ! does not.
      associate (step => model%step(scene%step), history => scene%newton%history)
         if (scene%accepted%motion%last_dt > 0.0_wp) then
            is_vain = it%number > most_of_flow
            if (is_vain .or. step%direct) return
            if (scene%newton%dt > least_cuts*step%smallest) is_vain = gets_nowhere(history(2:)) &
               & .or. it%creeping >= most_creeping
         else
            is_vain = gets_nowhere(history(2:))
            if (.not. is_vain .or. it%number > most_of_flow) return
            is_vain = flows_far(scene, model)
            is_vain = is_vain .and. .not. step%direct .and. scene%newton%dt &
               & > least_cuts*step%smallest
         end if
      end associate
   end function is_vain

   !> One step of Newton, and a look at where it leads.
   subroutine correct(it, scene, model, iterate, error)
      type(iteration_type), intent(inout) :: it
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(iterate_type), intent(inout) :: iterate
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: residual
      integer :: grounded
      logical :: first, falls, simplified

      associate (search => it%search, evaluation => it%evaluation, finite => scene%newton)
         it%merits(1 + mod(it%number, memory)) = evaluation%merit
         first = any(abs(it%remaining) > 0.0_wp)
         residual = relative(evaluation, reference_of(scene, evaluation))
         simplified = finite%flows .and. .not. (first .or. it%lagged .or. it%number == 1)
         if (simplified) simplified = by_old_tangent(finite%contraction, residual, it%last, &
            & equilibrium, correction)
         if (.not. (evaluation%tangent .or. simplified)) &
            & call evaluate(scene, model, search%load, .true., evaluation, error)
         if (allocated(error)) return
         falls = some_body_falls(scene)
         grounded = finite%grounded
         if (it%number == 1) finite%system%lag%failed = .false.
         finite%system%lag%may = it%number > 1 .and. residual < nearly
         call find_step(scene, model, evaluation, it%remaining, search%step, error, flat=it%fresh, &
            & by_old=simplified)
         if (allocated(error)) return
         ! The residual of a body that falls shrinks only once it has met something.
         search%falls = falls .and. finite%grounded > grounded
         ! Where the increment leads before further contacts close.
         if (it%number == 1 .and. it%loop == 0 .and. finite%grounded == 0 &
            & .and. .not. (it%guessed .and. .not. first)) finite%contact%noted = &
            & finite%contact%ahead
         search%first = first
         search%cycles = it%stale > 0
         search%merit = maxval(it%merits)
         search%with_tangent = .not. it%lagged
         if (search%with_tangent .and. finite%flows .and. .not. first) search%with_tangent = &
            & .not. evaluate_without_tangent(finite%contraction, residual, .not. simplified, &
            & equilibrium)
         it%status = finite%contact%status
         if (finite%contact%noted > 0.0_wp) call note_slides(it%awaited, finite%contact)
         call take_step(scene, model, search, iterate%v, evaluation, error)
         if (finite%contact%noted > 0.0_wp .and. .not. allocated(error)) &
            & call await_touch(it%awaited, scene, model, search, iterate%v, evaluation, error)
         finite%contact%noted = 0.0_wp
         if (allocated(error)) return
         it%last = search%size
         if (it%loop == 0) call size_first(scene, model, it%number, error)
         if (allocated(error)) return
         it%creeping = merge(it%creeping + 1, 0, search%share < creeps .and. .not. first)
         call note_step(finite%contraction, residual, relative(evaluation, reference_of(scene, &
            & evaluation)), .not. (first .or. simplified .or. search%share < 1.0_wp) &
            & .and. hash_of(finite%contact%status) == it%seen(it%number))
      end associate
      call end_iteration(it, scene, model, simplified, error)
   end subroutine correct

   !> What laws read of the last iteration, points that jam, and the line of the log.
   subroutine end_iteration(it, scene, model, simplified, error)
      type(iteration_type), intent(inout) :: it
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: simplified        !! the step was by the last tangent
      type(error_type), allocatable, intent(out) :: error
      integer :: eased

      if (it%lagged) then
         call renew_lagged(scene, share_of_new(scene%newton%history))
         call evaluate(scene, model, it%search%load, .true., it%evaluation, error)
         if (allocated(error)) return
      end if
      call log_iteration(scene, it%evaluation, it%number, it%last, it%search%share, simplified)
      call ease_returning(it%jams, scene, eased)
      if (eased > 0) call go_on_eased(it, scene, model, eased, error)
      if (allocated(error)) return
      call tell_of_iteration(scene, model)
      it%remaining = 0.0_wp
   end subroutine end_iteration

   !> Bounds have changed: what was met and reached before says nothing of them.
   subroutine go_on_eased(it, scene, model, eased, error)
      type(iteration_type), intent(inout) :: it
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: eased             !! points
      type(error_type), allocatable, intent(out) :: error

      call add_line(scene%newton, '  points that jam: '//to_text(eased)//', whose bounds of '// &
         & 'friction rise less steeply')
      it%stale = 0
      scene%newton%history = [real(wp) ::]
      call evaluate(scene, model, it%search%load, .true., it%evaluation, error)
   end subroutine go_on_eased

   !> A tool that leaves goes first, and the body springs back: contact that is about to open would
   !> drag a solid that flows along until it flows the other way.
   subroutine open_leaving_pairs(it, scene, model, iterate, error)
      type(iteration_type), intent(inout) :: it    !! nothing jumps where the tools have gone
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(iterate_type), intent(in) :: iterate
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: closed(:)
      logical :: leaves(size(model%pair))
      integer :: i

      associate (c => scene%newton%contact)
         allocate (closed, source=c%status(:c%n) > 0)
         if (.not. (any(closed) .and. scene%newton%has_solved)) return
         call expand(scene%constraints, iterate%v, it%search%prescribed, scene%trial%motion%u)
         call evaluate(scene, model, it%search%load, .true., it%evaluation, error)
         if (allocated(error)) return
         leaves = .false.
         do i = 1, c%n
            if (closed(i) .and. c%status(i) <= 0) leaves(c%pair(i)) = .true.
         end do
         if (it%evaluation%inverted == 0 .and. any(leaves)) then
            ! Whole pairs open, and nothing else closes.
            if (all(c%status(:c%n) <= 0 .or. closed .and. .not. leaves(c%pair(:c%n)))) then
               it%remaining = 0.0_wp
               scene%newton%separated = .true.
               return
            end if
         end if
      end associate
      call expand(scene%constraints, iterate%v, iterate%before, scene%trial%motion%u)
      call evaluate(scene, model, it%search%load, .true., it%evaluation, error)
   end subroutine open_leaving_pairs

   !> A number that differs where statuses do, but for chance.
   pure integer function hash_of(status) result(hash)
      integer, intent(in) :: status(:)
      integer :: i

      hash = 17
      do i = 1, size(status)
         hash = ieor(ishftc(hash, 5), 31*status(i) + i)
      end do
   end function hash_of
end module lopin_semismooth_newton
