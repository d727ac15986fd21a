!> Consistent forces of loads on the bodies and on the faces of small-strain solids.
module lopin_solid_loads
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_solid_small, only : strain_matrices, body_force, face_force
   use lopin_solids, only : solids_type, group_type
   implicit none
   private
   public :: add_body_loads, add_face_loads

contains

   !> Add the consistent forces of uniform body forces to a vector of equations.
   subroutine add_body_loads(self, mesh, element, density, force)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element(:)       !! (nload) element indices
      real(wp), intent(in) :: density(:, :)   !! (>= ndim, nload) [force/length^3]
      real(wp), intent(inout) :: force(:)     !! (n) [force]
      integer :: k, e

      do k = 1, size(element)
         e = element(k)
         if (self%which(e) > 0) call add_one(self%group(self%which(e)), mesh%conn(:, e), &
            & density(:, k))
      end do

   contains

      subroutine add_one(group, conn, density)
         type(group_type), intent(in) :: group
         integer, intent(in) :: conn(:)
         real(wp), intent(in) :: density(:)
         real(wp) :: b(group%element%ndof, group%element%nstress, group%element%ngauss)
         real(wp) :: volume(group%element%ngauss), smallest
         real(wp) :: own(group%element%ndim, group%element%nnode)
         integer :: point
         call strain_matrices(group%element, mesh%x(:, conn(:group%element%nnode)), &
            & group%thickness, b, volume, smallest, point)
         if (smallest <= 0.0_wp) return
         call body_force(group%element, volume, density, own)
         call scatter(self%dof, conn, own, force)
      end subroutine add_one
   end subroutine add_body_loads

   !> Add the consistent forces of pressures and tractions on faces to a vector of equations.
   subroutine add_face_loads(self, mesh, element, face, pressure, traction, force)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element(:), face(:)   !! (nload) element indices, Abaqus face numbers
      real(wp), intent(in) :: pressure(:)          !! (nload) > 0 pushes into the element [stress]
      real(wp), intent(in) :: traction(:, :)  !! (>= ndim, nload) added to the pressure [stress]
      real(wp), intent(inout) :: force(:)          !! (n) [force]
      integer :: k, e

      do k = 1, size(element)
         e = element(k)
         if (self%which(e) > 0) call add_one(self%group(self%which(e)), mesh%conn(:, e), k)
      end do

   contains

      subroutine add_one(group, conn, k)
         type(group_type), intent(in) :: group
         integer, intent(in) :: conn(:), k
         real(wp) :: own(group%element%ndim, group%element%nnode)
         call face_force(group%element, self%rules, face(k), &
            & mesh%x(:, conn(:group%element%nnode)), group%thickness, pressure(k), &
            & traction(:, k), own)
         call scatter(self%dof, conn, own, force)
      end subroutine add_one
   end subroutine add_face_loads

   pure subroutine scatter(dof, conn, own, force)
      integer, intent(in) :: dof(:, :), conn(:)
      real(wp), intent(in) :: own(:, :)       !! (ndim, nnode of the element)
      real(wp), intent(inout) :: force(:)
      integer :: a, i, equation

      do a = 1, size(own, 2)
         do i = 1, size(own, 1)
            equation = dof(i, conn(a))
            if (equation > 0) force(equation) = force(equation) + own(i, a)
         end do
      end do
   end subroutine scatter
end module lopin_solid_loads
