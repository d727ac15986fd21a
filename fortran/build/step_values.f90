!> What a step gives to nodes and elements, as fields that can be compared along a mesh.
module lopin_step_values
   use lopin_kinds, only : wp
   use lopin_model, only : step_type
   implicit none
   private
   public :: held_at_zero, add_body_forces, put_temperatures

contains

   !> Dofs that a step prescribes to be zero.
   pure function held_at_zero(step, nnode) result(held)
      type(step_type), intent(in) :: step
      integer, intent(in) :: nnode
      logical :: held(6, nnode)
      integer :: i

      held = .false.
      do i = 1, size(step%prescribed)
         associate (p => step%prescribed(i))
            held(p%dof, p%node) = .not. abs(p%value) > 0.0_wp
         end associate
      end do
   end function held_at_zero

   !> Forces by volume, added to those of the elements; several with unlike amplitudes are not told
   !> apart.
   pure subroutine add_body_forces(step, force, alike)
      type(step_type), intent(in) :: step
      real(wp), intent(inout) :: force(:, :)   !! (3, nelement) [force/length^3]
      logical, intent(out) :: alike            !! all have the amplitude of the first
      integer :: i

      alike = .false.
      do i = 1, size(step%body_load)
         associate (b => step%body_load(i))
            if (b%amplitude /= step%body_load(1)%amplitude) return
            force(:, b%element) = force(:, b%element) + b%force
         end associate
      end do
      alike = .true.
   end subroutine add_body_forces

   !> Temperatures of the nodes that a step gives one.
   pure subroutine put_temperatures(step, heat, alike)
      type(step_type), intent(in) :: step
      real(wp), intent(inout) :: heat(:)       !! (nnode) [temperature]
      logical, intent(out) :: alike            !! all have the amplitude of the first
      integer :: i

      alike = .true.
      if (.not. allocated(step%temperature)) return
      alike = .false.
      do i = 1, size(step%temperature)
         if (step%temperature(i)%amplitude /= step%temperature(1)%amplitude) return
         heat(step%temperature(i)%node) = step%temperature(i)%value
      end do
      alike = .true.
   end subroutine put_temperatures
end module lopin_step_values
