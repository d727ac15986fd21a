!> One more correction of an answer of Newton.
module lopin_newton_refinement
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_newton_system, only : solve_step
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_newton_step, only : coarse
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: refine

contains

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
      call solve_step(scene%newton%system, right, coarse, step, scene%clock, &
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
end module lopin_newton_refinement
