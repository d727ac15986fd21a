!> The energy in the hourglass motions of elements of few points: what of the strain energy is
!> there only to hold them.
module lopin_hourglass_energy
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_hourglass, only : add_hourglass, moduli_type
   use lopin_solids, only : solids_type
   implicit none
   private
   public :: hourglass_energy

contains

   !> Of all elements [force*length]; 0 where the points of every element see all its motions.
   pure real(wp) function hourglass_energy(self, mesh, u, finite) result(energy)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)             !! (n) displacements by equation [length]
      logical, intent(in) :: finite            !! geometry of large motions
      integer :: e, g

      energy = 0.0_wp
      do g = 1, size(self%group)
         if (.not. self%group(g)%element%hourglass) cycle
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
      real(wp), dimension(mesh%ndim, self%group(self%which(e))%element%nnode) :: moved, force
      integer :: a, i

      moved = 0.0_wp
      do a = 1, size(moved, 2)
         do i = 1, size(moved, 1)
            associate (dof => self%dof(i, mesh%conn(a, e)))
               if (dof > 0) moved(i, a) = u(dof)
            end associate
         end do
      end do
      energy = 0.0_wp
      force = 0.0_wp
      associate (group => self%group(self%which(e)))
         call add_hourglass(group%element, moduli_type(group%young, group%poisson, &
            & group%thickness), mesh%x(:, mesh%conn(:size(moved, 2), e)), moved, finite, force, &
            & energy)
      end associate
   end function energy_of
end module lopin_hourglass_energy
