!> Preparation of the chosen path, and one solution on a linear path.
module lopin_solve_path
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_report, only : summary_type
   use lopin_plan, only : plan_type, plan_line, nonlinear_line, path_of
   use lopin_scene, only : scene_type, follow_tools
   use lopin_path_condensed, only : prepare_condensed, solve_condensed, complete_condensed, &
      & widen_condensed
   use lopin_path_refactorised, only : prepare_refactorised, solve_refactorised
   use lopin_nonlinear_start, only : begin_nonlinear
   implicit none
   private
   public :: prepare_path, widen_path, solve_linear, note_solver

   !> Projections of a tool that forces move within one increment; a few are the rule.
   integer, parameter :: most_places = 40
   !> It rests when it moves by less than this share of the scene, or by less than the second for
   !> rounding.
   real(wp), parameter :: settled = 1.0e-11_wp, rounded = 1.0e-7_wp

contains

   !> Make the factors of the path that was planned; `summary` is told what they are.
   subroutine prepare_path(scene, model, plan, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason

      if (plan%path == path_of%nonlinear) then
         call begin_nonlinear(scene, model, error)
         if (allocated(error)) return
         summary%path = 'finite'
         summary%solver = 'auto'
         reason = 'chosen at the first factorisation'
         summary%equations = scene%constraints%neq
         summary%retained = scene%newton%contact%nmultiplier
         summary%candidates = scene%newton%contact%n
         summary%plan = nonlinear_line(plan, summary%equations, summary%candidates, &
            & summary%retained)
         return
      else if (plan%path == path_of%refactorised) then
         call prepare_refactorised(scene, model, summary%solver, reason, summary%retained, error)
         if (allocated(error)) return
         summary%path = 'newton'
         summary%equations = scene%constraints%neq
      else
         call prepare_condensed(scene, model, error)
         if (allocated(error)) return
         summary%path = 'condensed'
         summary%solver = scene%system%solver%name()
         reason = scene%system%reason
      end if
      scene%fresh_factor = .true.
      call describe(scene, plan, reason, summary)
   end subroutine prepare_path

   !> Which solver Newton's iterations took is known once they have factorised.
   subroutine note_solver(scene, summary)
      type(scene_type), intent(in) :: scene
      type(summary_type), intent(inout) :: summary

      if (.not. allocated(scene%newton%system%solver)) return
      summary%solver = scene%newton%system%solver%name()
      summary%reason = scene%newton%system%reason
   end subroutine note_solver

   !> Rows for the points within reach by now: on the condensed path the factor stands.
   subroutine widen_path(scene, model, plan, summary, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(out) :: error

      if (plan%path == path_of%refactorised) then
         call prepare_path(scene, model, plan, summary, error)
         return
      end if
      call widen_condensed(scene, model, error)
      if (.not. allocated(error)) call describe(scene, plan, scene%system%reason, summary)
   end subroutine widen_path

   !> Tell the summary what the linear paths stand on.
   subroutine describe(scene, plan, reason, summary)
      type(scene_type), intent(in) :: scene
      type(plan_type), intent(in) :: plan
      character(len=*), intent(in) :: reason
      type(summary_type), intent(inout) :: summary
      integer :: joined

      joined = 0
      if (plan%path == path_of%condensed) then
         summary%equations = scene%system%n
         summary%retained = scene%system%nlast
         joined = size(scene%system%late)
      end if
      summary%candidates = scene%rows%nsolved
      associate (met => scene%points%facet(:scene%points%n) > 0)
         summary%plan = plan_line(plan, summary, reason, scene%bodies%nq, &
            & count(met .and. scene%accepted%solver%candidate), count(met), joined, &
            & scene%rows%n - scene%rows%nsolved)
      end associate
   end subroutine describe

   !> Solve on a linear path; where a tool that forces move is curved, again for the place it has
   !> moved to, until it rests.
   subroutine solve_linear(scene, model, plan, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(plan_type), intent(in) :: plan
      real(wp), intent(in) :: f(:), prescribed(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: pass, iterations
      real(wp) :: way, last

      iterations = 0
      scene%guess = scene%accepted%motion%u
      last = huge(1.0_wp)
      do pass = 1, most_places
         scene%again = pass > 1
         scene%tools_first = plan%path == path_of%condensed
         if (plan%path == path_of%refactorised) then
            call solve_refactorised(scene, model, f, prescribed, error)
         else
            call solve_condensed(scene, model, f, prescribed, error)
         end if
         scene%answer%iterations = scene%answer%iterations + iterations
         iterations = scene%answer%iterations
         if (allocated(error)) return
         call follow_tools(scene, model, prescribed, way)
         ! What no longer shrinks, small as it is, is rounding: stiff penalties leave some.
         if (way <= settled .or. (pass > 2 .and. way > 0.5_wp*last .and. way < rounded)) then
            call complete_condensed(scene, model, f, prescribed)
            return
         end if
         last = way
      end do
      call raise(error, error_code%not_converged, 'E0505', &
         & 'the place of a tool that forces move does not settle in '// &
         & to_text(most_places)//' passes', model%step(scene%step)%at, &
         & help='prescribe its displacement, or take smaller increments')
   end subroutine solve_linear
end module lopin_solve_path
