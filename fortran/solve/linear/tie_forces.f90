!> Forces of eliminated ties: rows behind those that contact is solved on.
module lopin_tie_forces
   use lopin_kinds, only : wp
   use lopin_eliminated_ties, only : find_tie_forces
   use lopin_reduced_rows, only : row_forces
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: drop_tie_forces, add_tie_forces

contains

   !> Leave the rows that are solved for, with what is known of them to start from.
   subroutine drop_tie_forces(scene)
      type(scene_type), intent(inout) :: scene

      associate (answer => scene%answer)
         if (allocated(answer%active)) answer%active = answer%active(:shorter(size( &
            & answer%active)))
         call shorten(answer%force)
         call shorten(answer%gap)
         call shorten(answer%multiplier)
      end associate

   contains

      pure integer function shorter(n)
         integer, intent(in) :: n
         shorter = min(n, scene%rows%nsolved)
      end function shorter

      subroutine shorten(value)
         real(wp), allocatable, intent(inout) :: value(:)
         if (allocated(value)) value = value(:shorter(size(value)))
      end subroutine shorten
   end subroutine drop_tie_forces

   !> All rows, those of the ties by what their nodes would be left with otherwise.
   subroutine add_tie_forces(scene, f)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]
      real(wp) :: residual(scene%dofs%n), pressed(scene%dofs%n)
      real(wp), allocatable :: none(:)
      integer :: row, k

      associate (rows => scene%rows, answer => scene%answer)
         if (rows%n == rows%nsolved) return
         allocate (none(rows%n - rows%nsolved), source=0.0_wp)
         answer%active = [answer%active, (.true., row=rows%nsolved + 1, rows%n)]
         answer%force = [answer%force, none]
         answer%gap = [answer%gap, none]
         if (allocated(answer%multiplier)) answer%multiplier = [answer%multiplier, none]
         pressed = 0.0_wp
         call row_forces(rows, answer%force, pressed)
         call scene%k%multiply(scene%trial%motion%u, residual)
         residual = residual - f - pressed
         call find_tie_forces(rows, residual, answer%force)
         do row = rows%nsolved + 1, rows%n
            do k = rows%first(row), rows%first(row + 1) - 1
               answer%gap(row) = answer%gap(row) &
                  & + rows%coefficient(k)*scene%trial%motion%u(rows%dof(k))
            end do
         end do
      end associate
   end subroutine add_tie_forces
end module lopin_tie_forces
