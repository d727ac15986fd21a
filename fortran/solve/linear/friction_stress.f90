!> The von Mises stress that Cristescu's friction reads, lagged from pass to pass of an increment.
!>
!> The stress contains the shear that it bounds (lecture E4), so that the two are solved in turn
!> until the stress settles. Taken from the last increment instead, the answer would depend on the
!> step.
module lopin_friction_stress
   use lopin_kinds, only : wp
   use lopin_pair_friction, only : friction_in_step
   use lopin_friction, only : reads_mises
   use lopin_model, only : model_type
   use lopin_nodal_mises, only : nodal_mises
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: friction_reads_stress, update_friction_stress, most_stress_passes, stress_tolerance

   integer, parameter :: most_stress_passes = 60
   real(wp), parameter :: stress_tolerance = 1.0e-9_wp   !! change of the stress beside the largest

contains

   !> Whether a law of the step reads the von Mises stress of the slave.
   pure logical function friction_reads_stress(scene, model) result(reads)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair

      reads = .true.
      do pair = 1, size(model%pair)
         if (reads_mises(friction_in_step(model, model%pair(pair)%interaction, scene%step))) return
      end do
      reads = .false.
   end function friction_reads_stress

   !> Put the stress of these displacements at the slave points.
   subroutine update_friction_stress(scene, model, displacement, change)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: displacement(:)   !! (ndof) [length]
      real(wp), intent(out) :: change      !! largest, beside the largest stress of a point [-]
      real(wp) :: u(3, model%mesh%nnode), mises(model%mesh%nnode), most, new
      integer :: i, k, node

      u = 0.0_wp
      do node = 1, model%mesh%nnode
         do k = 1, model%mesh%ndim
            if (scene%dofs%id(k, node) > 0) u(k, node) = &
               & displacement(scene%dofs%id(k, node))
         end do
      end do
      call nodal_mises(scene%solids, model%mesh, u, scene%accepted%solids, mises)
      change = 0.0_wp
      most = 0.0_wp
      do i = 1, scene%points%n
         new = mises(scene%points%node(i))
         change = max(change, abs(new - scene%friction%mises(i)))
         most = max(most, new)
         scene%friction%mises(i) = new
      end do
      if (most > 0.0_wp) change = change/most
   end subroutine update_friction_stress
end module lopin_friction_stress
