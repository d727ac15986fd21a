!> The nonlinear path: one increment of finite sliding, finite rotation and finite strain by Newton.
!>
!> Nothing is committed here: what fails leaves the accepted state as it was, and the caller cuts
!> the increment. One that may not be cut is tried again by parts of its prescribed motion: each
!> part starts where the one before it has ended, histories stay those of the accepted state, so
!> that only the way to the answer differs. So is one that begins with letting go of something at
!> once, by parts of the forces that held it.
module lopin_path_nonlinear
   use lopin_held_points, only : find_idle_points
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_clock, only : phase
   use lopin_model, only : model_type
   use lopin_start, only : unreleased
   use lopin_admit_tractions, only : admit_tractions
   use lopin_constraints, only : expand
   use lopin_contact_history, only : start_increment, augment
   use lopin_nonlinear_tie_release, only : release_nonlinear_ties
   use lopin_supported_points, only : find_supported_points
   use lopin_newton_workspace, only : add_line, is_nonlinear
   use lopin_semismooth_newton, only : solve_newton, least_cuts
   use lopin_compliance_error, only : limit_compliance
   use lopin_residual, only : gap_rounding, evaluate, evaluation_type
   use lopin_predictor, only : iterate_type, predict, start_from_accepted, opened_after_guess, &
      & has_free_motion
   use lopin_heat, only : start_solids
   use lopin_newton_convergence, only : set_rounding_floors
   use lopin_rotating_bodies, only : rotate_followers
   use lopin_lagged_friction, only : reads_trial, start_lagged
   use lopin_followed_stress, only : choose_followers
   use lopin_eased_friction, only : ease_jammed, forget_eased, apply_eased
   use lopin_pseudo_transient, only : pseudo_transient
   use lopin_failed_attempt, only : turns_back, runs_round, cycles_when_small
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: solve_nonlinear

   !> Parts of an increment that may not be cut: the first, and the smallest.
   real(wp), parameter :: first_part = 0.25_wp, least_part = 1.0_wp/64.0_wp

   !> Attempts after which friction that falls with the speed is likelier the cause.
   integer, parameter :: lagged_after = 3

   !> How Newton comes to the prescribed values.
   type :: ways_type
      integer :: direct = 1, parts = 2, pseudo_transient = 3
   end type ways_type
   type(ways_type), parameter :: way_of = ways_type()

contains

   !> Displacements and tractions for the loads and prescribed values of one increment.
   subroutine solve_nonlinear(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: f(:)          !! (ndof) dead loads; on return with forces that fade
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      type(iterate_type) :: iterate
      integer :: way
      logical :: guessed, back

      scene%newton%separated = .false.
      scene%newton%faded = .false.
      scene%newton%jumped = .false.
      scene%newton%in_vain = .false.
      scene%newton%iterations = 0
      scene%newton%grounded = 0
      scene%newton%augmentations = 0
      scene%newton%nline = 0
      scene%newton%contact%speed_of_trial = .true.
      scene%newton%rests = model%start%step == scene%step .and. .not. &
         & scene%accepted%clock%time > model%start%time
      call start_solids(scene, model)
      call find_idle_points(scene, model)
      scene%trial%motion%u = scene%accepted%motion%u
      call rotate_followers(scene, model, error)
      if (allocated(error)) return
      call add_fading(scene, model, f, prescribed, error)
      if (allocated(error)) return
      call predict(scene, prescribed, iterate)
      way = way_of%direct
      if (releases_at_once(scene) .and. scene%newton%attempt > 1) then
         call start_from_accepted(scene, iterate)
         way = way_of%parts
      end if
      guessed = iterate%guessed
      call solve_from(scene, model, f, iterate, prescribed, way, error)
      if (guessed .and. .not. allocated(error)) then
         if (opened_after_guess(scene)) then
            call start_from_accepted(scene, iterate)
            call solve_from(scene, model, f, iterate, prescribed, way_of%direct, error)
            scene%newton%separated = .true.
         end if
      end if
      if (allocated(error)) call try_lagged(scene, model, f, prescribed, error)
      if (allocated(error)) call try_by_parts(scene, model, f, prescribed, error)
      if (allocated(error)) then
         back = turns_back(scene)
         if (back .or. runs_round(scene)) call try_eased(scene, model, f, prescribed, error)
         if (back .and. allocated(error)) call try_slowly(scene, model, f, prescribed, error)
      end if
      if (allocated(error)) return
      if (scene%newton%flows) then
         if (has_free_motion(scene)) scene%newton%separated = .true.
      end if
      call count_searches(scene)
      scene%counter%iterations = scene%counter%iterations + scene%newton%iterations
      scene%counter%augmentations = scene%counter%augmentations + scene%newton%augmentations
   end subroutine solve_nonlinear

   !> The increment begins a step that lets go of something at once, or a part whose mesh is not in
   !> balance: a jump, however short it is.
   pure logical function releases_at_once(scene)
      type(scene_type), intent(in) :: scene
      releases_at_once = scene%newton%rests .or. (allocated(scene%newton%released) &
         & .and. .not. scene%accepted%clock%time > 0.0_wp)
   end function releases_at_once

   !> Forces that a part finds out of balance where it begins, and that fade from there (*START,
   !> RELEASE): elements that separate let go of their neighbours over increments.
   subroutine add_fading(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: f(:)          !! (ndof) dead loads [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      type(iterate_type) :: iterate
      real(wp) :: now, next

      if (.not. (model%start%release > 0.0_wp .and. model%start%step == scene%step)) return
      associate (clock => scene%accepted%clock, period => model%step(scene%step)%period)
         if (scene%newton%rests) then
            call start_from_accepted(scene, iterate)
            call start_attempt(scene, model, prescribed, error)
            if (.not. allocated(error)) call measure_imbalance(scene, model, f, error)
            if (allocated(error)) return
            call move_alloc(scene%newton%released, scene%trial%loads%released)
         else
            if (.not. allocated(scene%accepted%loads%released)) return
            now = unreleased(model%start, clock%time, period)
            next = unreleased(model%start, clock%time + scene%newton%dt, period)
            scene%trial%loads%released = scene%accepted%loads%released
            if (.not. next > 0.0_wp) deallocate (scene%trial%loads%released)
            if (.not. next > 0.0_wp) return
            scene%trial%loads%released = scene%trial%loads%released*(next/now)
         end if
         f = f + scene%trial%loads%released
      end associate
   end subroutine add_fading

   !> What the forces of a part that begins leave where it begins: elements that were taken out held
   !> it, or the old mesh did.
   subroutine measure_imbalance(scene, model, f, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      type(error_type), allocatable, intent(out) :: error
      type(evaluation_type) :: evaluation

      call evaluate(scene, model, f, .false., evaluation, error)
      if (allocated(error)) return
      scene%newton%released = evaluation%internal - f - scene%newton%contact%force &
         & - scene%newton%follower%force
      ! What supports bear they go on to bear.
      scene%newton%released(scene%constraints%dof_of_prescribed) = 0.0_wp
   end subroutine measure_imbalance

   !> Again with the speed of slip of the last iteration, where friction falls with it.
   subroutine try_lagged(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failed
      type(iterate_type) :: iterate

      if (error%code /= error_code%not_converged .or. .not. reads_trial(scene)) return
      if (scene%newton%attempt < lagged_after .and. .not. (model%step(scene%step)%direct &
         & .or. cycles_when_small(scene, model))) return
      scene%newton%contact%speed_of_trial = .false.
      call add_line(scene%newton, '  with the speed of slip of the last iteration')
      call start_from_accepted(scene, iterate)
      call solve_from(scene, model, f, iterate, prescribed, way_of%direct, failed)
      if (.not. allocated(failed)) then
         deallocate (error)
      else
         call move_alloc(failed, error)
      end if
   end subroutine try_lagged

   !> Again by parts of the motion, if the increment may not be cut; the first error if that fails.
   subroutine try_by_parts(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failed
      type(iterate_type) :: iterate

      associate (step => model%step(scene%step))
         if (error%code /= error_code%not_converged .or. scene%newton%faded) return
         if (.not. (step%direct .or. releases_at_once(scene)) .and. scene%newton%dt > least_cuts &
            & *step%smallest) return
      end associate
      ! Solids that flow remember the way: their increments are too large then.
      if (scene%newton%flows .and. .not. releases_at_once(scene)) return
      call start_from_accepted(scene, iterate)
      if (.not. (releases_at_once(scene) .or. any(abs(prescribed - iterate%before) > 0.0_wp))) &
         & return
      call solve_from(scene, model, f, iterate, prescribed, way_of%parts, failed)
      if (.not. allocated(failed)) deallocate (error)
   end subroutine try_by_parts

   !> Where Newton finds no equilibrium nearby: points may jam.
   subroutine try_eased(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failed
      type(iterate_type) :: iterate
      logical :: jammed(size(model%pair)), jams

      jammed = .false.
      if (error%code /= error_code%not_converged) return
      do
         call ease_jammed(scene, jammed, jams)
         if (.not. jams) exit
         call add_line(scene%newton, '  with bounds of friction that rise less steeply')
         call start_from_accepted(scene, iterate)
         call solve_from(scene, model, f, iterate, prescribed, way_of%direct, failed)
         if (.not. allocated(failed)) then
            deallocate (error)
            return
         end if
         if (failed%code /= error_code%not_converged) call move_alloc(failed, error)
         if (error%code /= error_code%not_converged) return
      end do
      call forget_eased(scene)
   end subroutine try_eased

   !> Again by slow motion from the accepted state; the first error if that fails.
   subroutine try_slowly(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failed
      type(iterate_type) :: iterate

      if (error%code /= error_code%not_converged .or. .not. is_nonlinear(scene%newton)) return
      call start_from_accepted(scene, iterate)
      call add_line(scene%newton, '  slow motion from the accepted state')
      call solve_from(scene, model, f, iterate, prescribed, way_of%pseudo_transient, failed)
      if (allocated(failed)) then
         scene%newton%in_vain = .true.
         if (failed%code /= error_code%not_converged) call move_alloc(failed, error)
         return
      end if
      scene%newton%jumped = .true.
      scene%newton%separated = .true.
      deallocate (error)
   end subroutine try_slowly

   !> Contact and rounding floors as an attempt at an increment starts with them.
   subroutine start_attempt(scene, model, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error

      scene%trial%contact%multiplier = scene%accepted%contact%multiplier
      call start_lagged(scene)
      call apply_eased(scene)
      call choose_followers(scene, model)
      call start_increment(scene%newton%contact, model, scene%accepted%contact, &
         & scene%accepted%motion%u, scene%newton%dt, error)
      if (allocated(error)) return
      call release_nonlinear_ties(scene%newton%contact, model, scene%constraints)
      call find_supported_points(scene%newton%contact, model, scene%constraints, &
         & scene%accepted%motion%u, prescribed)
      call set_rounding_floors(scene)   ! by the areas that the increment starts with
      if (scene%newton%rests) call admit_tractions(scene, model, error)
   end subroutine start_attempt

   !> Newton and augmentations.
   subroutine solve_from(scene, model, f, iterate, prescribed, way, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      type(iterate_type), intent(inout) :: iterate
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      integer, intent(in) :: way               !! way_of%...
      type(error_type), allocatable, intent(out) :: error
      integer :: loop, i
      real(wp) :: change, beyond, last

      call start_attempt(scene, model, prescribed, error)
      if (allocated(error)) return
      call scene%clock%stop_in(phase%search)
      if (way == way_of%parts) call solve_by_parts(scene, model, f, iterate, prescribed, error)
      if (way == way_of%pseudo_transient) then
         call pseudo_transient(scene, model, f, iterate, prescribed, error)
         scene%newton%damping%on = .false.
      end if
      if (allocated(error)) return
      last = huge(1.0_wp)
      do loop = 0, scene%newton%most_augmentations
         call solve_newton(scene, model, f, iterate, prescribed, loop, error)
         if (allocated(error)) return
         iterate%before = prescribed
         iterate%guessed = .false.
         call augment(scene%newton%contact, [(gap_rounding(scene, i), i=1, &
            & scene%newton%contact%n)], change, beyond)
         ! What contracts no more, and is rounding, has settled.
         if (loop > 1 .and. change > 0.5_wp*last .and. beyond <= scene%newton%augment_until) &
            & change = 0.0_wp
         if (change <= scene%newton%augment_until) exit
         last = change
         scene%newton%augmentations = scene%newton%augmentations + 1
      end do
      if (change > scene%newton%augment_until) call raise(error, error_code%not_converged, &
         & 'E0502', 'the augmented Lagrangian has not settled in '// &
         & to_text(scene%newton%most_augmentations)//' augmentations', model%step(scene%step)%at, &
         & help='raise the penalty, or MAX AUGMENTATIONS on *CONTACT CONTROLS')
      if (.not. allocated(error)) call limit_compliance(scene, model, f, iterate, &
         & prescribed, error)
   end subroutine solve_from

   !> Equilibria on the way to the prescribed values, or to where nothing holds any more, and there.
   subroutine solve_by_parts(scene, model, f, iterate, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) dead loads [force]
      type(iterate_type), intent(inout) :: iterate
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      type(iterate_type) :: last
      real(wp), allocatable :: start(:), goal(:), multiplier(:), load(:)
      real(wp) :: reached, part

      scene%newton%faded = releases_at_once(scene)
      call add_line(scene%newton, '  by parts of '//trim(merge('the prescribed motion', &
         & 'what is let go of    ', .not. scene%newton%faded)))
      if (scene%newton%rests) call measure_imbalance(scene, model, f, error)
      if (allocated(error)) return
      allocate (start, source=iterate%before)
      reached = 0.0_wp
      part = first_part
      do while (reached < 1.0_wp)
         goal = start + (reached + part)*(prescribed - start)
         last = iterate
         multiplier = scene%trial%contact%multiplier
         scene%newton%contact%ahead = merge(part, 0.0_wp, .not. reached > 0.0_wp)
         load = f
         if (releases_at_once(scene)) load = f + (1.0_wp - (reached + part))*scene%newton%released
         call solve_newton(scene, model, load, iterate, goal, 0, error)
         if (.not. allocated(error)) then
            reached = reached + part
            iterate%before = goal
            cycle
         end if
         part = 0.5_wp*part
         if (error%code /= error_code%not_converged .or. part < least_part) return
         deallocate (error)
         iterate = last
         scene%trial%contact%multiplier = multiplier
         call expand(scene%constraints, iterate%v, iterate%before, scene%trial%motion%u)
      end do
      scene%newton%contact%ahead = 0.0_wp
   end subroutine solve_by_parts

   !> What the contacts asked since this was called last.
   subroutine count_searches(scene)
      type(scene_type), intent(inout) :: scene

      associate (cost => scene%newton%contact%cost)
         scene%counter%queries = scene%counter%queries + cost%query
         scene%counter%projections = scene%counter%projections + cost%projection
         scene%counter%boxes = scene%counter%boxes + cost%box
         cost%query = 0
         cost%projection = 0
         cost%box = 0
      end associate
   end subroutine count_searches
end module lopin_path_nonlinear
