!> Stresses and strains of a solved mesh, at Gauss points and averaged to the nodes.
module lopin_recover_stress
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_shared_work, only : shared_work_type, share_out
   use lopin_element_type, only : element_type, element_kind
   use lopin_elastic, only : thickness_strain
   use lopin_solid_small, only : strain_matrices, strains
   use lopin_solids, only : solids_type, group_type, unit_nodes, unit_points
   use lopin_simplex_patches, only : patch_element
   implicit none
   private
   public :: recover_stress, average_to_nodes, recover_unit

   type, extends(shared_work_type) :: recovery_work_type
      type(solids_type), pointer :: solids => null()
      type(mesh_type), pointer :: mesh => null()
      real(wp), pointer :: u(:, :) => null(), stress(:, :) => null(), strain(:, :) => null()
   contains
      procedure :: do_part => recover_one_unit
   end type recovery_work_type

contains

   !> Stresses and strains at all Gauss points, xx yy zz xy xz yz; element e has the points
   !> first_point(e) .. first_point(e+1)-1. In 2D the last two are zero.
   subroutine recover_stress(self, mesh, u, stress, strain)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), intent(in), target :: u(:, :)  !! (>= ndim, nnode) displacements [length]
      real(wp), allocatable, intent(out), target :: stress(:, :)   !! (6, npoint) [stress]
      real(wp), allocatable, intent(out), target :: strain(:, :)   !! (6, npoint) engineering shears
      type(recovery_work_type) :: work
      integer :: npoint

      npoint = self%first_point(mesh%nelement + 1) - 1
      allocate (stress(6, npoint), strain(6, npoint))
      work%solids => self
      work%mesh => mesh
      work%u => u
      work%stress => stress
      work%strain => strain
      call share_out(work, [1, mesh%nelement + 1])
   end subroutine recover_stress

   subroutine recover_one_unit(self, k)
      class(recovery_work_type), intent(inout) :: self
      integer, intent(in) :: k             !! the element

      call recover_unit(self%solids, self%mesh, self%u, k, self%stress, self%strain)
   end subroutine recover_one_unit

   pure subroutine recover_unit(self, mesh, u, e, stress, strain)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)
      integer, intent(in) :: e
      real(wp), intent(inout) :: stress(:, :), strain(:, :)
      type(element_type) :: element
      integer, allocatable :: node(:), point(:)
      real(wp), allocatable :: own(:, :), elongation(:, :)

      allocate (node, source=unit_nodes(self, mesh, e))
      if (size(node) == 0) return
      associate (group => self%group(self%which(e)), p => self%patches%of(e))
         if (p == 0) then
            call recover_element(group, group%element, mesh%x(:, node), &
               & u(:group%element%ndim, node), &
               & stress(:, self%first_point(e):self%first_point(e + 1) - 1), &
               & strain(:, self%first_point(e):self%first_point(e + 1) - 1))
         else
            call patch_element(self%patches, p, mesh%conn, group%element, element)
            allocate (own(6, element%ngauss), elongation(6, element%ngauss))
            call recover_element(group, element, mesh%x(:, node), u(:element%ndim, node), own, &
               & elongation)
            allocate (point, source=unit_points(self, self%first_point, e))
            stress(:, point) = own
            strain(:, point) = elongation
         end if
      end associate
   end subroutine recover_unit

   pure subroutine recover_element(group, element, x, u, stress, strain)
      type(group_type), intent(in) :: group
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :), u(:, :)
      real(wp), intent(out) :: stress(:, :), strain(:, :)
      real(wp) :: b(element%ndof, element%nstress, element%ngauss)
      real(wp) :: volume(element%ngauss), smallest
      real(wp) :: own(element%nstress, element%ngauss)
      integer :: k, ns, point

      ns = element%nstress
      call strain_matrices(element, x, group%thickness, b, volume, smallest, point, group%d)
      call strains(element, b, reshape(u, [element%ndof]), own)
      stress = 0.0_wp
      strain = 0.0_wp
      do k = 1, element%ngauss
         stress(:ns, k) = matmul(group%d, own(:, k))
         strain(:ns, k) = own(:, k)
         if (element%kind == element_kind%plane_stress) strain(3, k) = &
            & thickness_strain(group%poisson, own(:, k))
      end do
   end subroutine recover_element

   !> Mean over the elements of a node (those of one section, if asked) of the values extrapolated
   !> from their Gauss points.
   subroutine average_to_nodes(self, mesh, at_points, at_nodes, section)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: at_points(:, :)    !! (m, npoint)
      real(wp), intent(out) :: at_nodes(:, :)    !! (m, nnode); zero where no element is
      integer, intent(in), optional :: section
      integer :: e, a, p, q, node, share(mesh%nnode)

      at_nodes = 0.0_wp
      share = 0
      do e = 1, mesh%nelement
         if (self%which(e) == 0) cycle
         if (present(section)) then
            if (mesh%section(e) /= section) cycle
         end if
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
