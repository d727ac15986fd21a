!> Springs of contact that give way beside the bodies.
!>
!> A stiffness that was chosen is chosen for the pressures: where forces are given these are right
!> whatever the springs are, and what the loads move is not. By Clapeyron the loads do twice the
!> energy that bodies and springs store, so that the springs' share is that of the displacements.
module lopin_soft_springs
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_report, only : energy_type
   use lopin_raise_penalty, only : chooses_slope
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: check_soft_springs

   !> Energy of the springs, beside that of the bodies, that is told; and beside the largest of the
   !> run, below which it is of no account.
   real(wp), parameter :: told = 0.05_wp, some = 1.0e-3_wp

contains

   !> At the end of a step.
   subroutine check_soft_springs(scene, model, energy)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy
      logical :: chooses, augments

      call chooses_slope(model, chooses, augments)
      if (.not. chooses) return
      associate (stored => energy%strain + energy%plastic)
         if (.not. (stored > 0.0_wp .and. energy%contact > max(told*stored, some*energy%most))) &
            & return
         call warn_once(scene%log, 'W0568', 'at the end of step '//to_text(scene%step)// &
            & ' the springs of contact, whose stiffness was chosen for the pressures, hold '// &
            & to_text(100.0_wp*energy%contact/stored, 2)//' % of what the bodies do: what '// &
            & 'loads move moves too far by about as much', model%step(scene%step)%at, &
            & help='DIRECT or AUGMENTED LAGRANGE, or a stiffness of your own behind PENALTY')
      end associate
   end subroutine check_soft_springs
end module lopin_soft_springs
