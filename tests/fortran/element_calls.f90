!> The kernels of elements, called with what they are computed from one by one.
module element_calls
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_hyperelastic, only : solid_law_type
   use lopin_solid_finite_strain, only : finite_strain_element, finite_strain_stresses, &
      & finite_strain_memory
   use lopin_solid_flow, only : flow_element, flow_stresses, flow_memory
   implicit none
   private
   public :: element_at, stresses_at, remember_at

contains

   !> Force, energy and tangent.
   subroutine element_at(finite, element, law, x, u, thickness, memory, dt, force, energy, bad, ke)
      logical, intent(in) :: finite
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in), target :: law
      real(wp), contiguous, intent(in), target :: x(:, :), u(:, :), memory(:, :)
      real(wp), intent(in) :: thickness, dt
      real(wp), intent(out) :: force(element%ndof), energy
      integer, intent(out) :: bad
      real(wp), intent(out), optional :: ke(element%ndof, element%ndof)
      type(element_input_type) :: input

      input = element_input_type(law, x, u, memory, thickness, dt)
      if (finite) then
         call finite_strain_element(element, input, force, energy, bad, ke)
      else
         call flow_element(element, input, force, energy, bad, ke)
      end if
   end subroutine element_at

   !> Stresses and strains.
   subroutine stresses_at(finite, element, law, x, u, thickness, memory, dt, stress, strain, bad)
      logical, intent(in) :: finite
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in), target :: law
      real(wp), contiguous, intent(in), target :: x(:, :), u(:, :), memory(:, :)
      real(wp), intent(in) :: thickness, dt
      real(wp), intent(out) :: stress(6, element%ngauss), strain(6, element%ngauss)
      integer, intent(out) :: bad
      type(element_input_type) :: input

      input = element_input_type(law, x, u, memory, thickness, dt)
      if (finite) then
         call finite_strain_stresses(element, input, stress, strain, bad)
      else
         call flow_stresses(element, input, stress, strain, bad)
      end if
   end subroutine stresses_at

   !> The memory of the next state in the place of that of the accepted one.
   subroutine remember_at(finite, element, law, x, u, thickness, dt, memory, work, held, bad)
      logical, intent(in) :: finite
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in), target :: law
      real(wp), contiguous, intent(in), target :: x(:, :), u(:, :)
      real(wp), intent(in) :: thickness, dt
      real(wp), contiguous, intent(inout) :: memory(:, :)
      real(wp), intent(out) :: work, held
      integer, intent(out) :: bad
      type(element_input_type) :: input
      real(wp), target :: past(size(memory, 1), size(memory, 2))

      past = memory
      input = element_input_type(law, x, u, past, thickness, dt)
      if (finite) then
         call finite_strain_memory(element, input, memory, work, held, bad)
      else
         call flow_memory(element, input, memory, work, held, bad)
      end if
   end subroutine remember_at
end module element_calls
