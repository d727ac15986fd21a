!> Tractions that contacts start from where a part of a run begins.
module lopin_admit_tractions
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: admit_tractions

   !> Each takes the tractions that were carried over to what the law returns for them.
   integer, parameter :: admissions = 2
   !> Nodes of a new mesh that stand farther from a tool bear nothing there, in facets.
   real(wp), parameter :: open = 1.0e-9_wp

contains

   !> Tractions that a new mesh took over become those that its contacts allow where it stands:
   !> normals of the new skin differ, and what was carried lies beyond the bound of friction then.
   subroutine admit_tractions(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(evaluation_type) :: evaluation
      real(wp) :: nothing(scene%dofs%n)
      integer :: i, row, pass

      nothing = 0.0_wp
      associate (contact => scene%newton%contact, multiplier => scene%trial%contact%multiplier, &
         & d => model%mesh%ndim)
         do pass = 1, admissions
            call evaluate(scene, model, nothing, .false., evaluation, error)
            if (allocated(error)) return
            do i = 1, contact%n
               row = contact%first_row(i)
               if (row == 0) cycle
               multiplier(row:row + d - 1) = multiplier(row:row + d - 1) &
                  & - contact%enforcement(i)%c*contact%row(row:row + d - 1)
               if (contact%gap(i) > open*contact%size(i) .and. .not. contact%bilateral(i)) &
                  & multiplier(row:row + d - 1) = 0.0_wp
            end do
         end do
      end associate
   end subroutine admit_tractions
end module lopin_admit_tractions
