!> Springs of contact that give way beside the bodies.
!>
!> A stiffness that was chosen is chosen for the pressures: where forces are given these are right
!> whatever the springs are, and what the loads move is not. An elastic slip that was chosen is a
!> share of the facets: friction that turns round takes the shear of the body and that of the
!> springs back. By Clapeyron the loads do twice the energy that bodies and springs store, so that
!> what the springs take up, beside the bodies, is their share of the displacements. It is summed
!> over the increments of a step, up and down: at the end of a cycle the springs hold little of
!> what they took up on the way.
module lopin_soft_springs
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : frame_type, energy_type
   use lopin_raise_penalty, only : chooses_slope, chooses_elastic_slip
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: soft_springs_type, note_springs, tell_springs

   !> What springs take up, beside the bodies, that is told; and beside the largest energy of the
   !> run, below which it is of no account.
   real(wp), parameter :: told = 0.05_wp, some = 1.0e-3_wp

   !> What was taken up and given back in the step, and what was held last [energy].
   type :: soft_springs_type
      real(wp) :: springs = 0.0_wp, bodies = 0.0_wp
      real(wp) :: held = 0.0_wp, stored = 0.0_wp
   contains
      procedure :: keep => keep_springs
   end type soft_springs_type

contains

   !> To a stream or back.
   subroutine keep_springs(self, stream)
      class(soft_springs_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%springs)
      call stream%pass(self%bodies)
      call stream%pass(self%held)
      call stream%pass(self%stored)
   end subroutine keep_springs

   !> Look at an accepted increment.
   subroutine note_springs(self, frame)
      type(soft_springs_type), intent(inout) :: self
      type(frame_type), intent(in) :: frame

      associate (energy => frame%energy, stored => frame%energy%strain + frame%energy%plastic)
         if (frame%increment == 1) self%springs = 0.0_wp
         if (frame%increment == 1) self%bodies = 0.0_wp
         self%springs = self%springs + abs(energy%contact - self%held)
         self%bodies = self%bodies + abs(stored - self%stored)
         self%held = energy%contact
         self%stored = stored
      end associate
   end subroutine note_springs

   !> At the end of a step.
   subroutine tell_springs(self, scene, model, energy)
      type(soft_springs_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy
      logical :: chooses, augments

      call chooses_slope(model, chooses, augments)
      if (.not. (chooses .or. any(chooses_elastic_slip(model%interaction(model%pair &
         & %interaction))))) return
      if (.not. (self%bodies > 0.0_wp .and. self%springs > max(told*self%bodies, &
         & some*energy%most))) return
      call warn_once(scene%log, 'W0568', 'in step '//to_text(scene%step)//' the springs of '// &
         & 'contact, whose stiffness was chosen, took up '// &
         & to_text(100.0_wp*self%springs/self%bodies, 2)//' % of what the bodies did: what '// &
         & 'loads move moves too far, and friction turns round too late, by about as much', &
         & model%step(scene%step)%at, help='DIRECT or AUGMENTED LAGRANGE, or a stiffness of '// &
         & 'your own behind PENALTY and ELASTIC SLIP= on *FRICTION')
   end subroutine tell_springs
end module lopin_soft_springs
