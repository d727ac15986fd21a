!> Semismooth Newton on displacements and contact tractions together, for finite sliding, finite
!> rotation and finite strain: project at the present positions, assemble forces and exact tangents,
!> solve, take the step that a non-monotone line search allows.
module lopin_finite_newton
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_interrupt, only : is_interrupted
   use lopin_vectors, only : largest
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_bodies, only : describe_motion
   use lopin_constraints, only : expand
   use lopin_finite_system, only : solve_step
   use lopin_finite_state, only : add_line
   use lopin_finite_forces, only : look_type, look_at
   use lopin_settled, only : settled, relative, reference_of, equilibrium, correction, &
      & floor_of_rounding
   use lopin_predict, only : start_from_accepted
   use lopin_newton_step, only : some_body_falls, find_step, coarse
   use lopin_line_search, only : way_type, take_step, refuse_inverted
   use lopin_contraction, only : by_old_tangent, look_without_tangent, note_step, gets_nowhere
   use lopin_judge_mesh, only : folding_at
   use lopin_finite_lagged, only : reads_lagged, renew_lagged
   use lopin_scene, only : scene_type
   use lopin_tell_watcher, only : tell_of_iteration
   implicit none
   private
   public :: newton

   integer, parameter :: most_sets = 400, most_iterations = 30, most_lagged = 200, memory = 4
   !> Solids that flow do better in smaller increments than in more iterations.
   integer, parameter :: most_of_flow = 40
   !> So many returns to sets of contact met before are a cycle.
   integer, parameter :: cycle_of = 3
   !> An increment this often the smallest one can still be cut.
   real(wp), parameter, public :: least_cuts = 4.0_wp

contains

   !> Newton from (v, before) to equilibrium at the prescribed values.
   subroutine newton(scene, model, f, v, before, prescribed, loop, guessed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      real(wp), allocatable, intent(inout) :: v(:), before(:)
      real(wp), intent(in) :: prescribed(:)
      integer, intent(in) :: loop              !! augmentations so far
      logical, intent(in) :: guessed           !! (v, before) is no accepted state
      type(error_type), allocatable, intent(out) :: error
      type(look_type) :: look
      type(way_type) :: way
      real(wp), allocatable :: jump(:)
      real(wp) :: merits(memory), last, residual
      integer :: iteration, stale, seen(most_sets), grounded
      logical :: lagged, fresh, first, simplified, unchanged, falls

      way%load = f
      way%prescribed = prescribed
      merits = 0.0_wp
      scene%finite%cycled = .false.
      lagged = reads_lagged(scene)
      last = huge(1.0_wp)
      scene%finite%history = [real(wp) ::]
      scene%finite%contact%noted = merge(scene%finite%contact%ahead, 0.0_wp, guessed)
      if (scene%bodies%nq > 0 .and. loop == 0) scene%finite%contact%grip%clings = .true.
      call look_at(scene, model, f, .true., look, error)
      scene%finite%contact%noted = 0.0_wp
      if (allocated(error)) return
      if (look%inverted > 0 .and. guessed) then
         call start_from_accepted(scene, v, before)
         call look_at(scene, model, f, .true., look, error)
         if (allocated(error)) return
      end if
      if (look%inverted > 0) call refuse_inverted(scene, model, look, error)
      if (allocated(error)) return
      allocate (jump(scene%dofs%n), source=0.0_wp)
      if (size(prescribed) > 0) call expand(scene%constraints, 0.0_wp*v, prescribed - before, jump)
      if (loop == 0 .and. scene%finite%flows .and. any(abs(jump) > 0.0_wp)) then
         call let_go(scene, model, f, v, before, prescribed, jump, look, error)
         if (allocated(error)) return
      end if
      scene%finite%began = look%force
      scene%finite%reference = look%force
      scene%finite%correction = 0.0_wp
      stale = 0
      seen = 0
      do iteration = 1, most_sets
         if (scene%stops_at_once) then
            if (is_interrupted()) call raise(error, error_code%interrupted, 'E0605', &
               & 'interrupted within an increment; what was accepted before it stands')
            if (allocated(error)) return
         end if
         ! What the increment brings is about once it is applied; a trial far out moves it no more.
         if (iteration == 2) scene%finite%reference = max(scene%finite%reference, look%force)
         scene%finite%history = [scene%finite%history, relative(look, scene%finite%reference)]
         unchanged = iteration == 1
         if (iteration > 1) unchanged = hash_of(scene%finite%contact%status) &
            & == seen(max(1, iteration - 1))
         if (settled(scene, look, jump, iteration, loop, last, unchanged)) then
            if (iteration > 1 .and. look%merit > floor_of_rounding*reference_of(scene, look) &
               & .and. .not. scene%finite%flows) &
               & call polish(scene, model, f, v, prescribed, look, error)
            scene%finite%reference = reference_of(scene, look)
            scene%finite%has_solved = .true.
            return
         end if
         scene%finite%iterations = scene%finite%iterations + 1
         ! A front of contact may open point by point: sets not met before are progress.
         seen(iteration) = hash_of(scene%finite%contact%status)
         if (any(seen(:iteration - 1) == seen(iteration))) stale = stale + 1
         fresh = .false.
         if (iteration > 1 .and. scene%finite%frictionless) fresh = seen(iteration) &
            & /= seen(max(1, iteration - 1))
         if (stale > merge(most_lagged, most_iterations, lagged)) exit
         if (scene%finite%flows) then
            ! What has nothing to go on from, as a sheet between flat tools or a body that springs
            ! back, loses contact node by node in any increment: slow, but it gets on.
            associate (step_data => model%step(scene%step))
               if (scene%accepted%motion%last_dt > 0.0_wp) then
                  if (iteration > most_of_flow) exit
                  if (.not. step_data%direct &
                     & .and. scene%finite%dt > least_cuts*step_data%smallest) then
                     if (gets_nowhere(scene%finite%history(2:))) exit
                  end if
               else if (iteration > most_of_flow) then
                  if (gets_nowhere(scene%finite%history(2:))) exit
               end if
            end associate
         end if
         merits(1 + mod(iteration, memory)) = look%merit
         first = any(abs(jump) > 0.0_wp)
         residual = relative(look, reference_of(scene, look))
         simplified = scene%finite%flows .and. .not. (first .or. lagged .or. iteration == 1)
         if (simplified) simplified = by_old_tangent(scene%finite%contraction, residual, last, &
            & equilibrium, correction)
         if (.not. (look%tangent .or. simplified)) &
            & call look_at(scene, model, f, .true., look, error)
         if (allocated(error)) return
         falls = some_body_falls(scene)
         grounded = scene%finite%grounded
         call find_step(scene, model, look, jump, way%step, error, flat=fresh, by_old=simplified)
         if (allocated(error)) return
         ! The residual of a body that falls shrinks only once it has met something.
         falls = falls .and. scene%finite%grounded > grounded
         ! Where the increment leads before further contacts close.
         if (iteration == 1 .and. loop == 0 .and. scene%finite%grounded == 0 &
            & .and. .not. (guessed .and. .not. first)) &
            & scene%finite%contact%noted = scene%finite%contact%ahead
         way%first = first
         way%falls = falls
         way%merit = maxval(merits)
         way%with_tangent = with_tangent(residual)
         call take_step(scene, model, way, v, look, error)
         scene%finite%contact%noted = 0.0_wp
         if (allocated(error)) return
         last = way%size
         call note_step(scene%finite%contraction, residual, relative(look, &
            & reference_of(scene, look)), .not. (first &
            & .or. simplified .or. way%share < 1.0_wp) &
            & .and. hash_of(scene%finite%contact%status) == seen(iteration))
         if (lagged) then
            call renew_lagged(scene, model)
            call look_at(scene, model, f, .true., look, error)
            if (allocated(error)) return
         end if
         call log_iteration(scene, look, iteration, last, way%share, simplified)
         call tell_of_iteration(scene, model)
         jump = 0.0_wp
      end do
      scene%finite%cycled = stale >= cycle_of
      if (scene%finite%grounded > 0 .and. scene%bodies%nq > 0) then
         call say_free(scene, model, error)
         return
      end if
      call say_unsolved(scene, model, look, error)

   contains

      !> What the look after the step is to form.
      logical function with_tangent(residual)
         real(wp), intent(in) :: residual      !! before it

         with_tangent = .not. lagged
         if (with_tangent .and. scene%finite%flows .and. .not. first) with_tangent = &
            & .not. look_without_tangent(scene%finite%contraction, residual, .not. simplified, &
            & equilibrium)
      end function with_tangent
   end subroutine newton

   !> Newton has not ended; where the mesh folds is said, for that is why.
   subroutine say_unsolved(scene, model, look, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(look_type), intent(in) :: look
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: fold

      fold = folding_at(scene, model, scene%accepted%motion%u)
      if (len(fold) > 0) fold = '; '//fold
      call raise(error, error_code%not_converged, 'E0510', 'Newton has not converged in '// &
         & to_text(scene%finite%iterations)//' iterations: residual '// &
         & to_text(relative(look, reference_of(scene, look)), 3)//' of the largest force'//fold, &
         & model%step(scene%step)%at, help='smaller increments on *STATIC'// &
         & trim(merge(', and a mesh that bears the strain', repeat(' ', 34), len(fold) > 0)))
   end subroutine say_unsolved

   !> A tool that leaves goes first, and the body springs back: contact that is about to open would
   !> drag a solid that flows along until it flows the other way.
   subroutine let_go(scene, model, f, v, before, prescribed, jump, look, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:), v(:), before(:), prescribed(:)
      real(wp), intent(inout) :: jump(:)       !! (ndof) 0 where the tools have gone
      type(look_type), intent(inout) :: look
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: closed(:)
      logical :: leaves(size(model%pair))
      integer :: i

      associate (c => scene%finite%contact)
         allocate (closed, source=c%status(:c%n) > 0)
         if (.not. (any(closed) .and. scene%finite%has_solved)) return
         call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
         call look_at(scene, model, f, .true., look, error)
         if (allocated(error)) return
         leaves = .false.
         do i = 1, c%n
            if (closed(i) .and. c%status(i) <= 0) leaves(c%pair(i)) = .true.
         end do
         if (look%inverted == 0 .and. any(leaves)) then
            ! Whole pairs open, and nothing else closes.
            if (all(c%status(:c%n) <= 0 .or. closed .and. .not. leaves(c%pair(:c%n)))) then
               jump = 0.0_wp
               scene%finite%parted = .true.
               return
            end if
         end if
      end associate
      call expand(scene%constraints, v, before, scene%trial%motion%u)
      call look_at(scene, model, f, .true., look, error)
   end subroutine let_go

   !> One more correction by the factor at hand: converged answers become as good as rounding lets
   !> them, for a few back-solves. Kept only if it is better.
   subroutine polish(scene, model, f, v, prescribed, look, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      real(wp), intent(inout) :: v(:)
      real(wp), intent(in) :: prescribed(:)
      type(look_type), intent(inout) :: look
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: right(:), step(:), from(:), traction(:)
      integer, allocatable :: status(:)
      real(wp) :: merit
      integer :: bad

      merit = look%merit
      allocate (from, source=v)
      allocate (traction, source=scene%trial%contact%multiplier)
      allocate (status, source=scene%finite%contact%status)
      allocate (right(size(v) + size(traction)), step(size(v) + size(traction)))
      right(:size(v)) = -look%free
      right(size(v) + 1:) = -scene%finite%contact%row
      call solve_step(scene%finite%system, right, coarse, model%solver, step, scene%clock, &
         & scene%counter, bad, error)
      if (allocated(error) .or. bad > 0) then
         if (allocated(error)) deallocate (error)
         return
      end if
      call go(1.0_wp)
      if (allocated(error)) return
      if (look%inverted == 0 .and. look%merit < merit &
         & .and. all(status == scene%finite%contact%status)) return
      call go(0.0_wp)

   contains

      subroutine go(share)
         real(wp), intent(in) :: share

         v = from + share*step(:size(v))
         call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
         scene%trial%contact%multiplier = traction + share*step(size(v) + 1:)
         call look_at(scene, model, f, .false., look, error)
      end subroutine go
   end subroutine polish

   !> A body that only contact could hold, and contact does not.
   subroutine say_free(scene, model, error)
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
   end subroutine say_free

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
   subroutine log_iteration(scene, look, iteration, last, share, simplified)
      type(scene_type), intent(inout) :: scene
      type(look_type), intent(in) :: look
      integer, intent(in) :: iteration
      real(wp), intent(in) :: last, share
      logical, intent(in) :: simplified        !! by the tangent of the step before
      character(len=100) :: text
      real(wp) :: reference

      reference = max(reference_of(scene, look), tiny(1.0_wp))
      associate (c => scene%finite%contact)
         write (text, '(i4,3(1x,es12.4),1x,f8.5,3(1x,i6),1x,i6,1x,a)') iteration, &
            & largest(look%free)/reference, largest(look%row)/reference, min(last, 9.0e99_wp), &
            & share, count(c%status(:c%n) == 0), count(c%status(:c%n) == 1), &
            & count(c%status(:c%n) == 2), scene%finite%system%krylov, &
            & trim(merge('   old', '      ', simplified))
      end associate
      call add_line(scene%finite, text)
   end subroutine log_iteration
end module lopin_finite_newton
