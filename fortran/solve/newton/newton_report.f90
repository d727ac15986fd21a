!> What Newton tells: the line of an iteration, and why there is no balance.
module lopin_newton_report
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_vectors, only : largest
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_newton_workspace, only : add_line
   use lopin_residual, only : evaluation_type
   use lopin_newton_convergence, only : relative, reference_of
   use lopin_check_mesh, only : folding_at
   use lopin_scene, only : scene_type
   use lopin_worst_residual, only : describe_worst
   use lopin_held_points, only : name_held_point
   implicit none
   private
   public :: log_iteration, raise_not_converged

contains

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
      call name_held_point(scene, model, error)
   end subroutine raise_not_converged

   !> One line of the log: the three numbers, the share of the step taken, the points, GMRES.
   subroutine log_iteration(scene, evaluation, iteration, last, share, simplified)
      type(scene_type), intent(inout) :: scene
      type(evaluation_type), intent(in) :: evaluation
      integer, intent(in) :: iteration
      real(wp), intent(in) :: last, share
      logical, intent(in) :: simplified        !! by the tangent of the step before
      character(len=100) :: text
      real(wp), parameter :: shown(2) = [1.0e-99_wp, 9.0e99_wp]   ! two digits of exponent
      real(wp) :: reference, size(3)

      reference = max(reference_of(scene, evaluation), tiny(1.0_wp))
      size = [largest(evaluation%unlevel)/reference, largest(evaluation%row)/reference, last]
      size = merge(min(size, shown(2)), 0.0_wp, size >= shown(1))
      associate (c => scene%newton%contact)
         write (text, '(i4,3(1x,es12.4),1x,f8.5,3(1x,i6),1x,i6,1x,a)') iteration, size, share, &
            & count(c%status(:c%n) == 0), count(c%status(:c%n) == 1), &
            & count(c%status(:c%n) == 2), scene%newton%system%krylov%last, &
            & trim(merge('   old', '      ', simplified))
      end associate
      call add_line(scene%newton, text)
   end subroutine log_iteration
end module lopin_newton_report
