!> What the end of a step says of it: checks that look at the whole step, or at the whole run.
module lopin_end_of_step
   use lopin_model, only : model_type
   use lopin_report, only : frame_type
   use lopin_scene, only : scene_type
   use lopin_run_type, only : watch_type
   use lopin_after_step, only : check_step
   use lopin_driven_flow, only : tell_driven
   use lopin_soft_springs, only : tell_springs
   use lopin_coarse_faces, only : check_coarse_faces
   use lopin_mesh_work, only : check_mesh_work
   use lopin_unresolved_contact, only : check_unresolved_contact
   use lopin_artificial_work, only : check_artificial_work
   use lopin_work_balance, only : end_balance
   use lopin_snap_through, only : report_snap_through
   use lopin_springback, only : report_springback
   use lopin_force_ripples, only : report_ripples
   use lopin_facet_sag, only : report_sag
   use lopin_needless_order, only : measure_middles, tell_needless_order
   use lopin_check_drift, only : check_drift
   implicit none
   private
   public :: check_end_of_step

contains

   subroutine check_end_of_step(watch, scene, model, frame)
      type(watch_type), intent(inout) :: watch
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame    !! of the last increment of the step

      associate (energy => frame%energy, taken => frame%energy%strain + frame%energy%plastic)
         call check_step(scene, model, watch%seen, frame%certificate%rubs%ramp, energy%most, taken)
         call tell_driven(scene, model)
         call tell_springs(watch%springs, scene, model, energy)
         call check_unresolved_contact(scene, model, watch%artificial%pressed, taken)
         call check_mesh_work(scene, model, frame%u, taken, energy%plastic, energy%most)
         call check_coarse_faces(scene, model, energy%most)
         if (scene%newton%in_use) call end_balance(watch%balance, scene, model, energy)
         call report_snap_through(watch%jumps, scene, model, energy)
         if (scene%newton%in_use) call report_springback(watch%springback, scene, model, energy, &
            & watch%balance%excess, watch%balance%springs_back)
         call measure_middles(watch%needless, scene, model, frame%u)
         if (scene%step < size(model%step)) return
         call report_ripples(watch%ripples, scene, model)
         call report_sag(watch%sag, scene, model)
         call tell_needless_order(watch%needless, scene, model)
         call check_drift(watch%drift, scene, model, frame%contact)
         call check_artificial_work(watch%artificial, scene, model, energy)
      end associate
   end subroutine check_end_of_step
end module lopin_end_of_step
