!> The energy in the hourglass motions of bricks of one point: what of the strain energy is there
!> only to hold them.
module lopin_hourglass_energy
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_element_type, only : element_formulation
   use lopin_hourglass, only : add_hourglass
   use lopin_solids, only : solids_type
   implicit none
   private
   public :: hourglass_energy

contains

   !> Of all elements [force*length]; 0 where no element has one point for all its motions.
   pure real(wp) function hourglass_energy(self, mesh, u, finite) result(energy)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)             !! (n) displacements by equation [length]
      logical, intent(in) :: finite            !! geometry of large motions
      integer :: e, g

      energy = 0.0_wp
      do g = 1, size(self%group)
         if (self%group(g)%element%formulation /= element_formulation%centre) cycle
         do e = 1, mesh%nelement
            if (self%which(e) == g) energy = energy + energy_of(self, mesh, e, u, finite)
         end do
      end do
   end function hourglass_energy

   pure real(wp) function energy_of(self, mesh, e, u, finite) result(energy)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(wp), intent(in) :: u(:)
      logical, intent(in) :: finite
      real(wp) :: moved(3, 8), force(3, 8)
      integer :: a, i

      moved = 0.0_wp
      do a = 1, 8
         do i = 1, 3
            associate (dof => self%dof(i, mesh%conn(a, e)))
               if (dof > 0) moved(i, a) = u(dof)
            end associate
         end do
      end do
      energy = 0.0_wp
      force = 0.0_wp
      associate (group => self%group(self%which(e)))
         call add_hourglass(group%element, [group%young, group%poisson], &
            & mesh%x(:, mesh%conn(:8, e)), moved, finite, force, energy)
      end associate
   end function energy_of
end module lopin_hourglass_energy
