!> The line search of the nonlinear path.
!>
!> The step is shortened until it lowers the merit or contracts, and until no corner of an element
!> that was right turns inside out: beyond that the forces of a solid are those of no solid, and
!> Newton may find a balance among them. Where every share folds a corner, the merit alone decides;
!> a converged state that is folded is refused (lopin_check_mesh).
!>
!> Where metal flows, and nothing touches or the rows of contact are met, the work along the step
!> decides instead. Forces of an increment of flow are the slopes of a potential (Ortiz and Stainier
!> 1999), which the step descends until its work turns; residuals rise on the way down, and a step
!> that lowers them may lead nowhere. Metal that is stiff beside its yield stress would wander, and
!> end where the last bits of its forces lead.
module lopin_line_search
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_vectors, only : largest
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_newton_system, only : solve_step
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_newton_step, only : coarse
   use lopin_check_mesh, only : folds
   use lopin_one_unit, only : as_lengths
   use lopin_slip_increment, only : note_sliding, forget_sliding
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: search_type, take_step, refuse_inverted

   !> Displacements that are no more than rounding, beside the scene.
   real(wp), parameter :: motionless = 1.0e-9_wp
   integer, parameter :: most_halvings = 6
   !> A Newton step that lowers the merit by less than this is not worth a halving.
   real(wp), parameter :: sufficient = 1.0e-4_wp
   !> A body that falls has landed where the forces along its way are this share of those at its
   !> start, or after so many tries.
   real(wp), parameter :: landed = 0.5_wp
   integer, parameter :: most_landings = 20
   !> The work along a step is spent where it is this share of that at its start; a step is not cut
   !> to less than a tenth at once.
   real(wp), parameter :: spent = 0.5_wp, least_cut = 0.1_wp
   !> Rows of contact are met, so that pressures do no work along a step, where they leave no more
   !> than this share of the residual.
   real(wp), parameter :: met = 0.1_wp

   !> A step, what is asked of it, and what was taken of it.
   type :: search_type
      real(wp), allocatable :: load(:)         !! (ndof) dead loads [force]
      real(wp), allocatable :: prescribed(:)   !! (nprescribed)
      real(wp), allocatable :: step(:)         !! (neq + nmultiplier)
      logical :: first = .false.               !! it applies the prescribed values
      logical :: falls = .false.               !! a body on soft springs falls along it
      logical :: by_work = .false.             !! there is a potential, which it descends
      logical :: with_tangent = .true.         !! of the whole step; a shorter one always has it
      real(wp) :: merit = 0.0_wp               !! largest of the last few [force]
      real(wp) :: pull = 0.0_wp                !! residual along it where it starts [force*length]
      real(wp) :: share = 1.0_wp               !! of the step that was taken
      real(wp) :: size = 0.0_wp                !! of the correction beside the displacements
      logical :: cycles = .false.              !! sets came back: what slides sticks first
      real(wp), allocatable :: from(:)         !! (neq) where it starts
      real(wp), allocatable :: multiplier(:)   !! (nmultiplier) there
      real(wp), allocatable :: displaced(:)    !! (ndof) there
   end type search_type

contains

   !> Take the step, shortened until the merit is acceptable; the best try if none is.
   subroutine take_step(scene, model, search, v, evaluation, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(inout) :: search
      real(wp), intent(inout) :: v(:)
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      search%from = v
      search%multiplier = scene%trial%contact%multiplier
      search%displaced = scene%trial%motion%u
      search%size = 0.0_wp
      search%share = 1.0_wp
      if (search%cycles .and. .not. scene%newton%damping%on) then
         call note_sliding(scene%newton%contact)
      else
         call forget_sliding(scene%newton%contact)
      end if
      associate (step => as_lengths(scene, search%step(:size(v)), &
         & scene%constraints%dof_of_equation))
         search%pull = dot_product(search%step(:size(v)), evaluation%free)
         if (scene%newton%flows .and. .not. (search%first .or. search%falls)) search%share = &
            & longest_facet(scene)/max(largest(step), longest_facet(scene), tiny(1.0_wp))
         search%by_work = search%pull < 0.0_wp
         if (search%by_work) search%by_work = has_potential(scene, evaluation)
         call backtrack(scene, model, search, v, evaluation, error)
         if (allocated(error)) return
         if (search%falls .and. .not. search%first) call find_landing(scene, model, search, v, &
            & evaluation, error)
         if (allocated(error)) return
         scene%newton%correction = search%share*largest(step)
      end associate
      search%size = scene%newton%correction/max(largest(as_lengths(scene, &
         & scene%trial%motion%u, [(i, i=1, scene%dofs%n)])), &
         & motionless*scene%bodies%length)
   end subroutine take_step

   !> Metal flows, and nothing but its forces works along a step: amplitudes of internal modes may
   !> leap to another balance, and springs of contact have no rows that could be met.
   logical function has_potential(scene, evaluation) result(has)
      type(scene_type), intent(in) :: scene
      type(evaluation_type), intent(in) :: evaluation
      integer :: i

      has = scene%newton%flows
      do i = 1, size(scene%solids%group)
         has = has .and. scene%solids%group(i)%element%nmode == 0
      end do
      if (.not. has) return
      associate (contact => scene%newton%contact)
         do i = 1, contact%n
            associate (method => contact%enforcement(i)%method)
               has = method%solves_for_multiplier() .and. method%is_exact()
            end associate
            if (.not. has) return
         end do
      end associate
      has = norm2(evaluation%row) <= met*norm2(evaluation%unlevel)
   end function has_potential

   !> Shorten the step until it is acceptable; the best of those that fold nothing, if there is one.
   subroutine backtrack(scene, model, search, v, evaluation, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(inout) :: search
      real(wp), intent(inout) :: v(:)
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: best(2), best_share(2)       !! of shares that fold nothing, that fold a corner
      real(wp) :: measure, shorter             !! of a share, smaller is better; the next share
      logical :: free, good
      integer :: try, kind

      free = search%first .or. search%falls
      best = huge(1.0_wp)
      best_share = 0.0_wp
      do try = 0, most_halvings
         call try_share(scene, model, search, v, search%with_tangent .and. try == 0, evaluation, &
            & error)
         if (allocated(error)) return
         if (free) exit
         shorter = 0.5_wp*search%share
         if (evaluation%inverted == 0) then
            call judge(scene, search, evaluation, measure, good, shorter)
            kind = 1
            if (good .or. measure < best(1)) kind = merge(2, 1, folds_another(scene, model, search))
            if (good .and. kind == 1) exit
            if (measure < best(kind)) then
               best(kind) = merge(0.0_wp, measure, good)
               best_share(kind) = search%share
            end if
         end if
         search%share = shorter
      end do
      ! A body that falls too far is brought back to where it first touches.
      if (search%falls .and. .not. search%first) return
      kind = merge(1, 2, best_share(1) > 0.0_wp)
      if (evaluation%inverted > 0 .and. .not. best_share(kind) > 0.0_wp) then
         call refuse_inverted(scene, model, evaluation, error)
         return
      end if
      if (try > most_halvings) search%share = best_share(kind)
      if (try > 0) call try_share(scene, model, search, v, .true., evaluation, error)
   end subroutine backtrack

   !> Whether a share of the step is acceptable: by its merit and contraction, or by its work.
   subroutine judge(scene, search, evaluation, measure, good, shorter)
      type(scene_type), intent(inout) :: scene
      type(search_type), intent(in) :: search
      type(evaluation_type), intent(in) :: evaluation
      real(wp), intent(out) :: measure         !! smaller is better
      logical, intent(out) :: good
      real(wp), intent(inout) :: shorter       !! the next share, if it is not

      if (search%by_work) then
         measure = dot_product(search%step(:size(search%from)), evaluation%free)
         good = measure <= spent*abs(search%pull)
         ! Where a straight line has it vanish.
         if (.not. good) shorter = search%share*max(least_cut, search%pull/(search%pull - measure))
         measure = abs(measure)
      else
         measure = evaluation%merit
         good = evaluation%merit <= (1.0_wp - sufficient*search%share)*search%merit
         if (.not. good) good = contracts(scene, evaluation, search%step, search%share)
      end if
   end subroutine judge

   !> A body on soft springs goes until it has landed: they do not know how far that is, and what
   !> it meets would be crushed by as much as they bring it too far.
   subroutine find_landing(scene, model, search, v, evaluation, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(inout) :: search
      real(wp), intent(inout) :: v(:)
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: low, high, left
      integer :: try

      low = 0.0_wp
      high = search%share
      do try = 0, most_landings
         left = dot_product(search%step(:size(v)), evaluation%free)
         if (evaluation%inverted > 0) left = huge(1.0_wp)
         if (try == 0 .and. .not. left > landed*abs(search%pull)) return
         if (abs(left) <= landed*abs(search%pull)) exit
         if (left > 0.0_wp) high = search%share
         if (left < 0.0_wp) low = search%share
         search%share = 0.5_wp*(low + high)
         call try_share(scene, model, search, v, .false., evaluation, error)
         if (allocated(error)) return
      end do
      if (evaluation%inverted == 0) call try_share(scene, model, search, v, .true., evaluation, &
         & error)
      if (allocated(error)) return
      if (evaluation%inverted > 0) call refuse_inverted(scene, model, evaluation, error)
   end subroutine find_landing

   !> The state at a share of the step.
   subroutine try_share(scene, model, search, v, tangent, evaluation, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(in) :: search
      real(wp), intent(inout) :: v(:)
      logical, intent(in) :: tangent
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error

      v = search%from + search%share*search%step(:size(v))
      call expand(scene%constraints, v, search%prescribed, scene%trial%motion%u)
      scene%trial%contact%multiplier = search%multiplier + search%share*search%step(size(v) + 1:)
      associate (c => scene%newton%contact)
         if (c%noted > 0.0_wp) c%noted = search%share*c%ahead
      end associate
      call evaluate(scene, model, search%load, tangent, evaluation, error)
   end subroutine try_share

   !> A corner is inside out that was not where the step starts.
   logical function folds_another(scene, model, search) result(newly)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(in) :: search

      newly = .false.
      if (scene%newton%nlgeom) newly = folds(scene, model, scene%trial%motion%u)
      if (newly) newly = .not. folds(scene, model, search%displaced)
   end function folds_another

   !> Natural monotonicity (Deuflhard 2011, 3.3): the next correction, by the same tangent, is
   !> shorter than this one. Forces of an almost incompressible solid grow on the best of ways; its
   !> corrections do not.
   logical function contracts(scene, evaluation, step, share)
      type(scene_type), intent(inout) :: scene
      type(evaluation_type), intent(in) :: evaluation !! at this share of the step
      real(wp), intent(in) :: step(:), share
      real(wp) :: next(size(step)), right(size(step))
      type(error_type), allocatable :: error
      integer :: bad

      associate (neq => scene%constraints%neq, dof => scene%constraints%dof_of_equation)
         right(:neq) = -evaluation%free
         right(neq + 1:) = -scene%newton%contact%row
         call solve_step(scene%newton%system, right, coarse, next, scene%clock, &
            & scene%counter, bad, error)
         contracts = .not. allocated(error) .and. bad == 0
         if (contracts) contracts = norm2(as_lengths(scene, next(:neq), dof)) &
            & <= (1.0_wp - 0.25_wp*share)*norm2(as_lengths(scene, step(:neq), dof))
      end associate
   end function contracts

   !> No correction of a solid that flows goes farther than this: beyond it contact knows nothing of
   !> what lies opposite, and a body that has just lost it flies away.
   real(wp) function longest_facet(scene)
      type(scene_type), intent(in) :: scene

      longest_facet = huge(1.0_wp)
      if (scene%newton%contact%n > 0) longest_facet = maxval(scene%newton%contact%size)
   end function longest_facet

   !> A state in which an element is turned inside out, as an error.
   subroutine refuse_inverted(scene, model, evaluation, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(evaluation_type), intent(in) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: besides

      besides = ''
      if (scene%solids%group(scene%solids%which(evaluation%inverted))%element%nmode > 0) &
         & besides = ', or its internal modes find no balance'
      call raise(error, error_code%not_converged, 'E0512', 'element '// &
         & to_text(model%mesh%element_label(evaluation%inverted))//' would turn inside out'// &
         & besides, model%step(scene%step)%at, &
         & help='smaller increments, or a mesh that bears the strain')
   end subroutine refuse_inverted
end module lopin_line_search
