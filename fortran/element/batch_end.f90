!> What is asked of a batch of elements in space where an increment ends: stresses and strains for
!> output, and what the points keep of a flow. Module solid_finite_strain computes it one by one, in
!> the same operations: the same bits. Compiled three times, see module batch_kernel.
module lopin_batch_end
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, kept_type, lanes, points
   use lopin_hyperelastic, only : solid_law_type
   use lopin_batch_law, only : law_lanes_type, respond_in_lanes, strain_in_lanes, &
      & flow_lanes_type, flow_in_lanes, frame_lanes_type, find_frames
   use lopin_batch_motion, only : motion_type, deform, inverse_in_lanes
   use lopin_enhanced_batch, only : deform_enhanced
   use lopin_enhanced_modes, only : most_modes
   implicit none
   private
   public :: recover_batch, keep_batch

contains

   !> Cauchy stress and logarithmic strain (engineering shears) at the Gauss points.
   pure subroutine recover_batch(element, law, batch, stress, strain, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      real(wp), intent(out) :: stress(lanes, 6, points)   !! [stress]
      real(wp), intent(out) :: strain(lanes, 6, points)   !! [-]
      logical, intent(out) :: done             !! no element is turned inside out
      type(motion_type) :: motion
      type(law_lanes_type) :: answer
      type(frame_lanes_type) :: frame(points), whole(points)   ! of the elastic part, of all
      real(wp) :: change(lanes, 3, 3, points), amplitude(lanes, most_modes)
      integer :: i, k

      call deform_all(element, law, batch, motion, amplitude, done)
      if (.not. done) return
      do k = 1, element%ngauss
         call total_change(motion%h(:, :, :, k), change(:, :, :, k))
      end do
      call find_frames(element%ngauss, motion%change, frame)
      call find_frames(element%ngauss, change, whole)
      do k = 1, element%ngauss
         call respond_in_lanes(law, frame(k), motion%volume(:, k), &
            & batch%strain(:, k), batch%offset(:, k), batch%dt, .false., answer)
         do i = 1, 6
            stress(:, i, k) = answer%stress(:, i)/(1.0_wp + motion%volume(:, k))
         end do
         call strain_in_lanes(whole(k), motion%volume(:, k), strain(:, :, k))
      end do
   end subroutine recover_batch

   !> What the points remember of this state beyond the accepted one, their reference volumes and
   !> the deformed volumes of the elements.
   pure subroutine keep_batch(element, law, batch, kept, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(kept_type), intent(inout) :: kept
      logical, intent(out) :: done             !! no element is turned inside out
      type(motion_type) :: motion
      type(flow_lanes_type) :: flow
      type(frame_lanes_type) :: frame(points)
      real(wp) :: inverse(lanes, 3, 3)
      integer :: k

      call deform_all(element, law, batch, motion, kept%amplitude, done)
      if (.not. done) return
      call find_frames(element%ngauss, motion%change, frame)
      kept%held = 0.0_wp
      do k = 1, element%ngauss
         kept%weight(:, k) = motion%weight(:, k)
         kept%held = kept%held + motion%weight(:, k)*(1.0_wp + motion%own(:, k))
         call inverse_in_lanes(motion%h(:, :, :, k), inverse)
         call flow_in_lanes(law, frame(k), inverse, batch%strain(:, k), &
            & batch%dt, flow)
         kept%step(:, k) = flow%step
         kept%stress(:, k) = flow%stress
         kept%metric(:, :, k) = flow%metric
      end do
   end subroutine keep_batch

   !> Deformation of the points; amplitudes of internal modes, where the element has some.
   pure subroutine deform_all(element, law, batch, motion, amplitude, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      type(batch_type), intent(in) :: batch
      type(motion_type), intent(inout) :: motion
      real(wp), intent(out) :: amplitude(lanes, most_modes)   !! [-]
      logical, intent(out) :: done

      if (element%nmode > 0) then
         call deform_enhanced(element, law, batch, motion, amplitude, done)
      else
         amplitude = 0.0_wp
         call deform(element, batch, motion, done)
      end if
   end subroutine deform_all

   !> b - 1 of a displacement gradient.
   pure subroutine total_change(h, change)
      real(wp), intent(in) :: h(lanes, 3, 3)
      real(wp), intent(out) :: change(lanes, 3, 3)
      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            change(:, i, j) = h(:, i, j) + h(:, j, i) + (h(:, i, 1)*h(:, j, 1) &
               & + h(:, i, 2)*h(:, j, 2) + h(:, i, 3)*h(:, j, 3))
         end do
      end do
   end subroutine total_change
end module lopin_batch_end
