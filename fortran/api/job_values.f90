!> What an open run holds between two increments, as tables that a caller can put on another mesh.
module lopin_job_values
   use lopin_kinds, only : wp
   use lopin_job, only : running_type
   use lopin_model, only : model_type
   use lopin_point_states, only : states_of_points
   implicit none
   private
   public :: job_points, job_tractions

contains

   !> What the slave nodes of an open run bear: pair, label of the node, traction (3) [stress], slip
   !> from the stick anchor (3) [length]; not allocated without contact on the present shape.
   subroutine job_tractions(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (8, points)
      integer :: i

      if (.not. running%opened) return
      associate (contact => running%run%scene%newton%contact, &
         & state => running%run%scene%accepted%contact)
         if (.not. allocated(contact%node) .or. .not. allocated(state%traction)) return
         allocate (table(8, contact%n))
         do i = 1, contact%n
            table(:2, i) = [contact%pair(i), model%mesh%node_label(contact%node(i))]
            table(3:5, i) = state%traction(:, i)
            table(6:, i) = state%creep(:, i)
         end do
      end associate
   end subroutine job_tractions

   !> What the integration points of an open run hold, as numbers of any mesh
   !> (lopin_point_states); not allocated if they remember nothing.
   subroutine job_points(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (state_rows, points)

      if (.not. running%opened) return
      associate (scene => running%run%scene)
         if (scene%accepted%solids%in_use) call states_of_points(scene%solids, model%mesh, &
            & scene%accepted%motion%u, scene%accepted%solids, table)
      end associate
   end subroutine job_points
end module lopin_job_values
