!> Solids in space at finite strain, several elements of one type and material at a time.
!>
!> The element is the fastest index of every array, so that loops over the elements of a batch are
!> vector instructions. What is computed is that of module solid_finite_strain, operation by
!> operation: the same bits. A batch in which an element turns inside out is left to that module.
!> Compiled three times, see module batch_kernel.
module lopin_solid_batch
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, lanes, most
   use lopin_hyperelastic, only : solid_law_type
   use lopin_batch_law, only : law_lanes_type, respond_in_lanes, frame_lanes_type, find_frames
   use lopin_batch_motion, only : motion_type, deform
   use lopin_batch_stiffness, only : add_force, add_stiffness_in_lanes, add_coupling_in_lanes, &
      & average_in_lanes, velocity_form_in_lanes
   use lopin_enhanced_batch, only : evaluate_enhanced
   implicit none
   private
   public :: evaluate_batch

contains

   !> Forces, energies and, if asked for, tangents.
   pure subroutine evaluate_batch(element, law, with_tangent, batch, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      logical, intent(in) :: with_tangent
      type(batch_type), intent(inout) :: batch
      logical, intent(out) :: done             !! no element is turned inside out
      type(motion_type) :: motion
      type(law_lanes_type) :: answer
      type(frame_lanes_type) :: frame(most)
      real(wp) :: stress(lanes, 6, most), tangent(lanes, 6, 6, most), shared(lanes, most)
      integer :: k

      if (element%nmode > 0) then
         call evaluate_enhanced(element, law, with_tangent, batch, done)
         return
      end if
      call deform(element, batch, motion, done)
      if (.not. done) return
      call find_frames(element%ngauss, motion%change, frame)
      batch%energy = 0.0_wp
      do k = 1, element%ngauss
         call respond_in_lanes(law, frame(k), motion%volume(:, k), &
            & batch%strain(:, k), batch%offset(:, k), batch%dt, with_tangent, answer)
         stress(:, :, k) = answer%stress
         if (with_tangent) tangent(:, :, :, k) = answer%tangent
         batch%energy = batch%energy + motion%weight(:, k)*answer%energy
      end do
      shared = 0.0_wp
      if (motion%averaged) call share_pressure(element%ngauss, motion, stress, shared)
      if (with_tangent) call find_tangent(element, motion, stress, shared, tangent, batch%ke)
      batch%force = 0.0_wp
      do k = 1, element%ngauss
         if (motion%averaged) call replace_pressure(motion%own(:, k), shared(:, k), &
            & stress(:, :, k))
         call add_force(element%nnode, motion%g(:, :, :, k), stress(:, :, k), &
            & motion%weight(:, k), batch%force)
      end do
   end subroutine evaluate_batch

   !> Projection of the Kirchhoff pressure (tension positive) per volume ratio that counts.
   pure subroutine share_pressure(ngauss, motion, stress, shared)
      integer, intent(in) :: ngauss
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: stress(lanes, 6, most)
      real(wp), intent(inout) :: shared(lanes, most)
      real(wp) :: total(lanes)
      integer :: k

      total = 0.0_wp
      do k = 1, ngauss
         total = total + motion%phi*(motion%weight(:, k)*((stress(:, 1, k) + stress(:, 2, k) &
            & + stress(:, 3, k))/(3.0_wp*(1.0_wp + motion%volume(:, k)))))
      end do
      do k = 1, ngauss
         shared(:, k) = motion%phi*total
      end do
   end subroutine share_pressure

   !> The Kirchhoff stress that does the same work on the projected volume ratio.
   pure subroutine replace_pressure(own, shared, stress)
      real(wp), intent(in) :: own(lanes), shared(lanes)
      real(wp), intent(inout) :: stress(lanes, 6)
      real(wp) :: mean(lanes)
      integer :: i

      mean = (stress(:, 1) + stress(:, 2) + stress(:, 3))/3.0_wp
      do i = 1, 3
         stress(:, i) = stress(:, i) - mean + shared*(1.0_wp + own)
      end do
   end subroutine replace_pressure

   !> The second derivative of the energy.
   pure subroutine find_tangent(element, motion, stress, shared, tangent, ke)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: stress(lanes, 6, most), shared(lanes, most)
      real(wp), intent(inout) :: tangent(lanes, 6, 6, most)
      real(wp), intent(out) :: ke(lanes, 3, most, 3, most)
      real(wp), dimension(lanes, 3, most) :: row, dilation, theta, mixed
      real(wp) :: coupling(lanes, 6), unit(lanes, 6), corners(lanes), q(lanes, 9, 9)
      real(wp), dimension(lanes) :: swap, corner, part, weight
      integer :: a, i, k

      ke = 0.0_wp
      theta = 0.0_wp
      mixed = 0.0_wp
      corners = 0.0_wp
      swap = 0.0_wp
      unit = 0.0_wp
      unit(:, :3) = 1.0_wp
      do k = 1, element%ngauss
         weight = motion%weight(:, k)
         if (motion%averaged) then
            call average_in_lanes(tangent(:, :, :, k), stress(:, :, k), &
               & shared(:, k)*(1.0_wp + motion%own(:, k)), coupling, corner)
            swap = (stress(:, 1, k) + stress(:, 2, k) + stress(:, 3, k))/3.0_wp &
               & - shared(:, k)*(1.0_wp + motion%own(:, k))
            row = 0.0_wp
            dilation = 0.0_wp
            call add_force(element%nnode, motion%g(:, :, :, k), coupling, weight, row)
            call add_force(element%nnode, motion%g(:, :, :, k), unit, &
               & weight*(1.0_wp + motion%own(:, k)), dilation)
            part = motion%phi/(1.0_wp + motion%volume(:, k))
            do a = 1, element%nnode
               do i = 1, 3
                  mixed(:, i, a) = mixed(:, i, a) + part*row(:, i, a)
                  theta(:, i, a) = theta(:, i, a) + motion%phi*dilation(:, i, a)
               end do
            end do
            corners = corners + (weight*corner*part)*part
         end if
         call velocity_form_in_lanes(stress(:, :, k), tangent(:, :, :, k), swap, weight, q)
         call add_stiffness_in_lanes(element%nnode, motion%g(:, :, :, k), q, ke)
      end do
      if (motion%averaged) call add_coupling_in_lanes(element%nnode, theta, mixed, corners, ke)
   end subroutine find_tangent
end module lopin_solid_batch
