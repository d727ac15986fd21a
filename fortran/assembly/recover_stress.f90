!> Stresses and strains of a solved mesh, at Gauss points and averaged to the nodes.
module lopin_recover_stress
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_element_type, only : element_kind
   use lopin_elastic, only : thickness_strain
   use lopin_solid_small, only : strain_matrices, strains
   use lopin_assemble_solids, only : solids_type, group_type
   implicit none
   private
   public :: recover_stress, average_to_nodes

contains

   !> Stresses and strains at all Gauss points, xx yy zz xy xz yz; element e has the points
   !> first_point(e) .. first_point(e+1)-1. In 2D the last two are zero.
   subroutine recover_stress(self, mesh, u, stress, strain)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)  !! (>= ndim, nnode) displacements [length]
      real(wp), allocatable, intent(out) :: stress(:, :)   !! (6, npoint) [stress]
      real(wp), allocatable, intent(out) :: strain(:, :)   !! (6, npoint) engineering shears
      integer :: e, npoint

      npoint = self%first_point(mesh%nelement + 1) - 1
      allocate (stress(6, npoint), strain(6, npoint))
      !$omp parallel do schedule(static)
      do e = 1, mesh%nelement
         if (self%which(e) == 0) cycle
         call recover_element(self%group(self%which(e)), mesh%x, u, mesh%conn(:, e), &
            & stress(:, self%first_point(e):), strain(:, self%first_point(e):))
      end do
      !$omp end parallel do
   end subroutine recover_stress

   pure subroutine recover_element(group, x, u, conn, stress, strain)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :), u(:, :)
      integer, intent(in) :: conn(:)
      real(wp), intent(inout) :: stress(:, :), strain(:, :)
      real(wp) :: b(group%element%ndof, group%element%nstress, group%element%ngauss)
      real(wp) :: volume(group%element%ngauss), smallest
      real(wp) :: own(group%element%nstress, group%element%ngauss)
      integer :: k, m, ns, point

      m = group%element%nnode
      ns = group%element%nstress
      call strain_matrices(group%element, x(:, conn(:m)), group%thickness, b, volume, smallest, &
         & point, group%d)
      call strains(group%element, b, reshape(u(:group%element%ndim, conn(:m)), &
         & [group%element%ndof]), own)
      do k = 1, group%element%ngauss
         stress(:, k) = 0.0_wp
         strain(:, k) = 0.0_wp
         stress(:ns, k) = matmul(group%d, own(:, k))
         strain(:ns, k) = own(:, k)
         if (group%element%kind == element_kind%plane_stress) strain(3, k) = &
            & thickness_strain(group%poisson, own(:, k))
      end do
   end subroutine recover_element

   !> Mean over the elements of a node of the values extrapolated from their Gauss points.
   subroutine average_to_nodes(self, mesh, at_points, at_nodes)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: at_points(:, :)    !! (m, npoint)
      real(wp), intent(out) :: at_nodes(:, :)    !! (m, nnode); zero where no element is
      integer :: e, a, p, q, node, share(mesh%nnode)

      at_nodes = 0.0_wp
      share = 0
      do e = 1, mesh%nelement
         if (self%which(e) == 0) cycle
         p = self%first_point(e)
         q = self%first_point(e + 1) - 1
         associate (element => self%group(self%which(e))%element)
            do a = 1, element%nnode
               node = mesh%conn(a, e)
               share(node) = share(node) + 1
               at_nodes(:, node) = at_nodes(:, node) + matmul(at_points(:, p:q), &
                  & element%extrapolation(a, :))
            end do
         end associate
      end do
      do node = 1, mesh%nnode
         if (share(node) > 1) at_nodes(:, node) = at_nodes(:, node)/real(share(node), wp)
      end do
   end subroutine average_to_nodes
end module lopin_recover_stress
