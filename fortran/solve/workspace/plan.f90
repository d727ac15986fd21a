!> The plan of a run: path, method of each pair, and the line that says why.
module lopin_plan
   use lopin_kinds, only : wp
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_error, only : error_type, error_code, raise
   use lopin_model, only : model_type
   use lopin_pair_activity, only : pairs_change
   use lopin_flow_curve, only : flows
   use lopin_pair_friction, only : pair_slides_with_friction
   use lopin_report, only : summary_type
   use lopin_solver_factory, only : may_coarsen
   implicit none
   private
   public :: plan_type, new_plan, plan_line, nonlinear_line, needs_nonlinear, path_of

   type :: paths
      integer :: condensed = 1, refactorised = 2, nonlinear = 3
   end type paths
   type(paths), parameter :: path_of = paths()

   type :: plan_type
      integer :: path = 1
      logical :: by_user = .false.
      character(len=:), allocatable :: reason
   end type plan_type

contains

   !> Choose path and solver, and say why.
   subroutine new_plan(self, model, error)
      type(plan_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: friction
      integer :: pair

      self%reason = 'linear elastic, small strain'
      friction = .false.
      do pair = 1, size(model%pair)
         friction = friction .or. pair_slides_with_friction(model, pair)
      end do
      if (friction) then
         self%reason = self%reason//', small sliding, friction: whole history on one factorisation'
      else if (size(model%pair) == 0) then
         self%reason = self%reason//', no contact: one linear solve a load'
      else
         self%reason = self%reason// &
            & ', small sliding, no friction: contact is solved exactly on the '// &
            & 'condensed contact equations'
      end if
      select case (model%path)
      case ('AUTO')
         self%path = path_of%condensed
         if (needs_nonlinear(model)) then
            self%path = path_of%nonlinear
            self%reason = why_nonlinear(model)
         else if (model%mesh%ndim == 3 .and. may_coarsen(model%solver, 3*model%mesh%nnode)) then
            self%path = path_of%nonlinear
            self%reason = 'a factor is too large or not wanted: iterations by multigrid'
         end if
      case ('CONDENSED')
         self%path = path_of%condensed
      case ('FINITE')
         self%path = path_of%nonlinear
         self%reason = 'PATH=FINITE asks for it'
      case ('NEWTON')
         self%path = path_of%refactorised
         if (friction) then
            call raise(error, error_code%deck, 'E0521', 'PATH=NEWTON solves contact without '// &
               & 'friction only', model%path_at, help='leave out PATH=, or PATH=FINITE')
            return
         end if
         self%reason = 'PATH=NEWTON asks for the whole system, factorised again at every '// &
            & 'change of contact'
      case default
         call raise(error, error_code%deck, 'E0106', "PATH="//model%path//' is not a path', &
            & model%path_at, help='paths are AUTO, CONDENSED, NEWTON and FINITE')
         return
      end select
      self%by_user = model%path /= 'AUTO'
      if (self%path /= path_of%nonlinear .and. needs_nonlinear(model) &
         & .and. .not. only_flows(model)) call raise(error, &
         & error_code%deck, 'E0116', 'PATH='//model%path//' cannot solve this scene: ' &
         & //why_nonlinear(model), model%path_at, help='leave out PATH=')
   end subroutine new_plan

   !> Linear solutions on the shape at the start do not hold.
   logical function needs_nonlinear(model)
      type(model_type), intent(in) :: model
      needs_nonlinear = why_nonlinear(model) /= ''
   end function needs_nonlinear

   !> Plastic materials alone ask for Newton: a user who knows that they stay elastic may say so.
   logical function only_flows(model)
      type(model_type), intent(in) :: model
      only_flows = index(why_nonlinear(model), 'plastic') == 1
   end function only_flows

   function why_nonlinear(model) result(reason)
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: reason
      integer :: i

      reason = ''
      if (pairs_change(model)) reason = 'contact pairs change'
      if (any([(allocated(model%spring(i)%table), i=1, size(model%spring))])) &
         & reason = 'springs have tables'
      if (any(model%pair%slave == model%pair%master)) &
         & reason = 'self-contact is searched on the present shape'
      do i = 1, size(model%section)
         if (flows(model%material(model%section(i)%material)%flow)) reason = 'plastic flow'
      end do
      do i = 1, size(model%step)
         if (allocated(model%step(i)%temperature)) then
            if (size(model%step(i)%temperature) > 0) reason = 'temperatures'
         end if
      end do
      if (allocated(model%initial_stress)) then
         if (size(model%initial_stress) > 0) reason = 'stresses of the start'
      end if
      if (allocated(model%initial_state)) then
         if (size(model%initial_state) > 0) reason = 'a state of the start'
      end if
      if (allocated(model%initial_traction)) then
         if (size(model%initial_traction) > 0) reason = 'tractions of the start'
      end if
      if (any(model%step%nlgeom)) reason = 'NLGEOM: finite rotation and sliding'
      if (reason /= '') reason = reason//', Newton with exact tangents'
   end function why_nonlinear

   !> One line: what was chosen, and why.
   function plan_line(self, summary, reason, nq, reached, points, joined, &
      & eliminated) result(line)
      type(plan_type), intent(in) :: self
      type(summary_type), intent(in) :: summary   !! solver, equations, retained, candidates
      character(len=*), intent(in) :: reason      !! of the solver
      integer, intent(in) :: nq                   !! motions held only by contact
      integer, intent(in) :: reached, points   !! slave points within reach, and all of them
      integer, intent(in) :: joined            !! equations that came into reach after the factor
      integer, intent(in) :: eliminated        !! displacements of tied nodes that are no unknowns
      character(len=:), allocatable :: line

      line = 'path '
      if (self%path == path_of%condensed) line = line//'condensed'
      if (self%path == path_of%refactorised) line = line//'newton'
      if (self%path == path_of%nonlinear) line = line//'finite'
      line = line//', solver '//summary%solver//' ('//reason//'): '//to_text(summary%equations)// &
         & ' equations'
      if (summary%candidates > 0) line = line//', '//to_text(summary%candidates)// &
         & ' contact rows on '//to_text(summary%retained)//' of them'
      if (joined > 0) line = line//' ('//to_text(joined)//' joined by a back-solve each)'
      if (eliminated > 0) line = line//', '//to_text(eliminated)// &
         & ' displacements of tied nodes eliminated'
      if (reached < points) line = line//', '//to_text(reached)//' of '//to_text(points)// &
         & ' slave points within reach'
      if (nq > 0) line = line//', '//plural(nq, 'motion')//' held only by contact'
      line = line//'; because '//self%reason
   end function plan_line

   !> The same for the nonlinear path, whose contacts change as they slide.
   function nonlinear_line(self, equations, points, multipliers) result(line)
      type(plan_type), intent(in) :: self
      integer, intent(in) :: equations, points, multipliers
      character(len=:), allocatable :: line

      line = 'path finite: '//to_text(equations)//' equations, '//to_text(points)// &
         & ' contact points'
      if (multipliers > 0) line = line//', '//to_text(multipliers)//' tractions as unknowns'
      line = line//'; because '//self%reason
   end function nonlinear_line
end module lopin_plan
