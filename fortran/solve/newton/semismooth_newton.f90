!> Semismooth Newton on displacements and contact tractions together, for finite sliding, finite
!> rotation and finite strain: project at the present positions, assemble forces and exact tangents,
!> solve, take the step that a non-monotone line search allows.
module lopin_semismooth_newton
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_interrupt, only : is_interrupted
   use lopin_vectors, only : largest
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_bodies, only : describe_motion
   use lopin_constraints, only : expand
   use lopin_newton_system, only : solve_step
   use lopin_newton_workspace, only : add_line
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_newton_convergence, only : converged, relative, reference_of, equilibrium, &
      & correction, floor_of_rounding
   use lopin_predictor, only : start_from_accepted
   use lopin_newton_step, only : some_body_falls, find_step, coarse
   use lopin_line_search, only : search_type, take_step, refuse_inverted
   use lopin_contraction, only : by_old_tangent, evaluate_without_tangent, note_step, gets_nowhere
   use lopin_check_mesh, only : folding_at
   use lopin_lagged_friction, only : reads_lagged, renew_lagged
   use lopin_scene, only : scene_type
   use lopin_tell_watcher, only : tell_of_iteration
   use lopin_worst_residual, only : describe_worst
   implicit none
   private
   public :: solve_newton

   integer, parameter :: most_sets = 400, most_iterations = 30, most_lagged = 200, memory = 4
   !> Solids that flow do better in smaller increments than in more iterations.
   integer, parameter :: most_of_flow = 40
   !> So many returns to sets of contact met before are a cycle.
   integer, parameter :: cycle_of = 3
   !> An increment this often the smallest one can still be cut.
   real(wp), parameter, public :: least_cuts = 4.0_wp

contains

   !> Newton from (v, before) to equilibrium at the prescribed values.
   subroutine solve_newton(scene, model, f, v, before, prescribed, loop, guessed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      real(wp), allocatable, intent(inout) :: v(:), before(:)
      real(wp), intent(in) :: prescribed(:)
      integer, intent(in) :: loop              !! augmentations so far
      logical, intent(in) :: guessed           !! (v, before) is no accepted state
      type(error_type), allocatable, intent(out) :: error
      type(evaluation_type) :: evaluation
      type(search_type) :: search
      real(wp), allocatable :: remaining(:)
      real(wp) :: merits(memory), last, residual
      integer, allocatable :: status(:)
      integer :: iteration, stale, seen(most_sets), grounded
      logical :: lagged, fresh, first, simplified, unchanged, falls

      search%load = f
      search%prescribed = prescribed
      merits = 0.0_wp
      scene%newton%cycled = .false.
      lagged = reads_lagged(scene)
      status = [integer ::]
      last = huge(1.0_wp)
      scene%newton%history = [real(wp) ::]
      scene%newton%contact%noted = merge(scene%newton%contact%ahead, 0.0_wp, guessed)
      if (scene%bodies%nq > 0 .and. loop == 0) scene%newton%contact%enforcement%clings = .true.
      call evaluate(scene, model, f, .true., evaluation, error)
      scene%newton%contact%noted = 0.0_wp
      if (allocated(error)) return
      if (evaluation%inverted > 0 .and. guessed) then
         call start_from_accepted(scene, v, before)
         call evaluate(scene, model, f, .true., evaluation, error)
         if (allocated(error)) return
      end if
      if (evaluation%inverted > 0) call refuse_inverted(scene, model, evaluation, error)
      if (allocated(error)) return
      allocate (remaining(scene%dofs%n), source=0.0_wp)
      if (size(prescribed) > 0) call expand(scene%constraints, 0.0_wp*v, prescribed - before, &
         & remaining)
      if (loop == 0 .and. scene%newton%flows .and. any(abs(remaining) > 0.0_wp)) then
         call open_leaving_pairs(scene, model, f, v, before, prescribed, remaining, evaluation, &
            & error)
         if (allocated(error)) return
      end if
      scene%newton%began = evaluation%force
      scene%newton%reference = evaluation%force
      scene%newton%correction = 0.0_wp
      stale = 0
      seen = 0
      do iteration = 1, most_sets
         if (scene%stops_at_once) then
            if (is_interrupted()) call raise(error, error_code%interrupted, 'E0605', &
               & 'interrupted within an increment; what was accepted before it stands')
            if (allocated(error)) return
         end if
         ! What the increment brings is about once it is applied; a trial far out moves it no more.
         if (iteration == 2) scene%newton%reference = max(scene%newton%reference, evaluation%force)
         scene%newton%history = [scene%newton%history, relative(evaluation, scene%newton%reference)]
         unchanged = iteration == 1
         if (iteration > 1) unchanged = hash_of(scene%newton%contact%status) &
            & == seen(max(1, iteration - 1))
         if (converged(scene, evaluation, remaining, iteration, loop, last, unchanged)) then
            if (iteration > 1 .and. evaluation%merit > floor_of_rounding*reference_of(scene, &
               & evaluation) .and. .not. scene%newton%flows) &
               & call refine(scene, model, f, v, prescribed, evaluation, error)
            scene%newton%reference = reference_of(scene, evaluation)
            scene%newton%has_solved = .true.
            return
         end if
         scene%newton%iterations = scene%newton%iterations + 1
         ! A front of contact may open point by point: sets not met before are progress.
         seen(iteration) = hash_of(scene%newton%contact%status)
         if (any(seen(:iteration - 1) == seen(iteration))) stale = stale + 1
         fresh = .false.
         if (iteration > 1 .and. scene%newton%frictionless) fresh = seen(iteration) &
            & /= seen(max(1, iteration - 1))
         if (stale > merge(most_lagged, most_iterations, lagged)) exit
         if (scene%newton%flows) then
            ! What has nothing to go on from, as a sheet between flat tools or a body that springs
            ! back, loses contact node by node in any increment: slow, but it gets on.
            associate (step_data => model%step(scene%step))
               if (scene%accepted%motion%last_dt > 0.0_wp) then
                  if (iteration > most_of_flow) exit
                  if (.not. step_data%direct &
                     & .and. scene%newton%dt > least_cuts*step_data%smallest) then
                     if (gets_nowhere(scene%newton%history(2:))) exit
                  end if
               else if (iteration > most_of_flow) then
                  if (gets_nowhere(scene%newton%history(2:))) exit
               end if
            end associate
         end if
         merits(1 + mod(iteration, memory)) = evaluation%merit
         first = any(abs(remaining) > 0.0_wp)
         residual = relative(evaluation, reference_of(scene, evaluation))
         simplified = scene%newton%flows .and. .not. (first .or. lagged .or. iteration == 1)
         if (simplified) simplified = by_old_tangent(scene%newton%contraction, residual, last, &
            & equilibrium, correction)
         if (.not. (evaluation%tangent .or. simplified)) &
            & call evaluate(scene, model, f, .true., evaluation, error)
         if (allocated(error)) return
         falls = some_body_falls(scene)
         grounded = scene%newton%grounded
         call find_step(scene, model, evaluation, remaining, search%step, error, flat=fresh, &
            & by_old=simplified)
         if (allocated(error)) return
         ! The residual of a body that falls shrinks only once it has met something.
         falls = falls .and. scene%newton%grounded > grounded
         ! Where the increment leads before further contacts close.
         if (iteration == 1 .and. loop == 0 .and. scene%newton%grounded == 0 &
            & .and. .not. (guessed .and. .not. first)) &
            & scene%newton%contact%noted = scene%newton%contact%ahead
         search%first = first
         search%falls = falls
         search%merit = maxval(merits)
         search%with_tangent = with_tangent(residual)
         status = scene%newton%contact%status
         call take_step(scene, model, search, v, evaluation, error)
         scene%newton%contact%noted = 0.0_wp
         if (allocated(error)) return
         last = search%size
         call note_step(scene%newton%contraction, residual, relative(evaluation, &
            & reference_of(scene, evaluation)), .not. (first &
            & .or. simplified .or. search%share < 1.0_wp) &
            & .and. hash_of(scene%newton%contact%status) == seen(iteration))
         if (lagged) then
            call renew_lagged(scene, model)
            call evaluate(scene, model, f, .true., evaluation, error)
            if (allocated(error)) return
         end if
         call log_iteration(scene, evaluation, iteration, last, search%share, simplified)
         call tell_of_iteration(scene, model)
         remaining = 0.0_wp
      end do
      scene%newton%cycled = stale >= cycle_of
      if (scene%newton%grounded > 0 .and. scene%bodies%nq > 0) then
         call raise_free_body(scene, model, error)
         return
      end if
      call raise_not_converged(scene, model, evaluation, status, error)

   contains

      !> What the look after the step is to form.
      logical function with_tangent(residual)
         real(wp), intent(in) :: residual      !! before it

         with_tangent = .not. lagged
         if (with_tangent .and. scene%newton%flows .and. .not. first) with_tangent = &
            & .not. evaluate_without_tangent(scene%newton%contraction, residual, .not. simplified, &
            & equilibrium)
      end function with_tangent
   end subroutine solve_newton

   !> Newton has not ended; where the mesh folds is said, for that is why.
   subroutine raise_not_converged(scene, model, evaluation, before, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(evaluation_type), intent(in) :: evaluation
      integer, intent(in) :: before(:)         !! (points) status before the last iteration
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: fold

      fold = folding_at(scene, model, scene%accepted%motion%u)
      if (len(fold) > 0) fold = '; '//fold
      call raise(error, error_code%not_converged, 'E0510', 'Newton has not converged in '// &
         & to_text(scene%newton%iterations)//' iterations: residual '// &
         & to_text(relative(evaluation, reference_of(scene, evaluation)), 3)// &
         & ' of the largest force'//describe_worst(scene, model, evaluation, before)//fold, &
         & model%step(scene%step)%at, help='smaller increments on *STATIC'// &
         & trim(merge(', and a mesh that bears the strain', repeat(' ', 34), len(fold) > 0)))
   end subroutine raise_not_converged

   !> A tool that leaves goes first, and the body springs back: contact that is about to open would
   !> drag a solid that flows along until it flows the other way.
   subroutine open_leaving_pairs(scene, model, f, v, before, prescribed, remaining, evaluation, &
      & error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), v(:), before(:), prescribed(:)
      real(wp), intent(inout) :: remaining(:)  !! (ndof) 0 where the tools have gone
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: closed(:)
      logical :: leaves(size(model%pair))
      integer :: i

      associate (c => scene%newton%contact)
         allocate (closed, source=c%status(:c%n) > 0)
         if (.not. (any(closed) .and. scene%newton%has_solved)) return
         call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
         call evaluate(scene, model, f, .true., evaluation, error)
         if (allocated(error)) return
         leaves = .false.
         do i = 1, c%n
            if (closed(i) .and. c%status(i) <= 0) leaves(c%pair(i)) = .true.
         end do
         if (evaluation%inverted == 0 .and. any(leaves)) then
            ! Whole pairs open, and nothing else closes.
            if (all(c%status(:c%n) <= 0 .or. closed .and. .not. leaves(c%pair(:c%n)))) then
               remaining = 0.0_wp
               scene%newton%separated = .true.
               return
            end if
         end if
      end associate
      call expand(scene%constraints, v, before, scene%trial%motion%u)
      call evaluate(scene, model, f, .true., evaluation, error)
   end subroutine open_leaving_pairs

   !> One more correction by the factor at hand: converged answers become as good as rounding lets
   !> them, for a few back-solves. Kept only if it is better.
   subroutine refine(scene, model, f, v, prescribed, evaluation, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      real(wp), intent(inout) :: v(:)
      real(wp), intent(in) :: prescribed(:)
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: right(:), step(:), from(:), traction(:)
      integer, allocatable :: status(:)
      real(wp) :: merit
      integer :: bad

      merit = evaluation%merit
      allocate (from, source=v)
      allocate (traction, source=scene%trial%contact%multiplier)
      allocate (status, source=scene%newton%contact%status)
      allocate (right(size(v) + size(traction)), step(size(v) + size(traction)))
      right(:size(v)) = -evaluation%free
      right(size(v) + 1:) = -scene%newton%contact%row
      call solve_step(scene%newton%system, right, coarse, model%solver, step, scene%clock, &
         & scene%counter, bad, error)
      if (allocated(error) .or. bad > 0) then
         if (allocated(error)) deallocate (error)
         return
      end if
      call try_share(1.0_wp)
      if (allocated(error)) return
      if (evaluation%inverted == 0 .and. evaluation%merit < merit &
         & .and. all(status == scene%newton%contact%status)) return
      call try_share(0.0_wp)

   contains

      subroutine try_share(share)
         real(wp), intent(in) :: share

         v = from + share*step(:size(v))
         call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
         scene%trial%contact%multiplier = traction + share*step(size(v) + 1:)
         call evaluate(scene, model, f, .false., evaluation, error)
      end subroutine try_share
   end subroutine refine

   !> A body that only contact could hold, and contact does not.
   subroutine raise_free_body(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: q(scene%bodies%nq)

      q = 0.0_wp
      q(1) = 1.0_wp
      call raise(error, error_code%not_converged, 'E0511', &
         & describe_motion(scene%bodies, model, q)// &
         & ': contact does not hold it under these loads', &
         & model%step(scene%step)%at, note=to_text(scene%bodies%nq)//' rigid motions are free', &
         & help='fix it by *BOUNDARY, bring it into contact, or drive it by displacement')
   end subroutine raise_free_body

   !> A number that differs where statuses do, but for chance.
   pure integer function hash_of(status) result(hash)
      integer, intent(in) :: status(:)
      integer :: i

      hash = 17
      do i = 1, size(status)
         hash = ieor(ishftc(hash, 5), 31*status(i) + i)
      end do
   end function hash_of

   !> One line of the log: the three numbers, the share of the step taken, the points, GMRES.
   subroutine log_iteration(scene, evaluation, iteration, last, share, simplified)
      type(scene_type), intent(inout) :: scene
      type(evaluation_type), intent(in) :: evaluation
      integer, intent(in) :: iteration
      real(wp), intent(in) :: last, share
      logical, intent(in) :: simplified        !! by the tangent of the step before
      character(len=100) :: text
      real(wp) :: reference

      reference = max(reference_of(scene, evaluation), tiny(1.0_wp))
      associate (c => scene%newton%contact)
         write (text, '(i4,3(1x,es12.4),1x,f8.5,3(1x,i6),1x,i6,1x,a)') iteration, &
            & largest(evaluation%free)/reference, largest(evaluation%row)/reference, min(last, &
            & 9.0e99_wp), share, count(c%status(:c%n) == 0), count(c%status(:c%n) == 1), &
            & count(c%status(:c%n) == 2), scene%newton%system%krylov, &
            & trim(merge('   old', '      ', simplified))
      end associate
      call add_line(scene%newton, text)
   end subroutine log_iteration
end module lopin_semismooth_newton
