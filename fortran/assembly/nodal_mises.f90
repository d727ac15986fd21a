!> Von Mises stress at the nodes: what Cristescu's law of friction reads at a slave.
module lopin_nodal_mises
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_assemble_solids, only : solids_type
   use lopin_solid_memory, only : solid_memory_type
   use lopin_assemble_finite, only : recover_finite
   use lopin_recover_stress, only : recover_stress, average_to_nodes
   use lopin_von_mises, only : von_mises
   implicit none
   private
   public :: nodal_mises

contains

   !> Of the stress that is extrapolated to the nodes and averaged there; 0 where no element is.
   subroutine nodal_mises(solids, mesh, u, memory, mises)
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)      !! (>= ndim, nnode) displacements [length]
      type(solid_memory_type), intent(in) :: memory   !! of the accepted state
      real(wp), intent(out) :: mises(:)    !! (nnode) [stress]
      real(wp), allocatable :: stress(:, :), strain(:, :)
      real(wp) :: at_nodes(6, mesh%nnode)
      integer :: node

      if (memory%finite .or. memory%in_use) then
         call recover_finite(solids, mesh, u, memory, stress, strain)
      else
         call recover_stress(solids, mesh, u, stress, strain)
      end if
      call average_to_nodes(solids, mesh, stress, at_nodes)
      do node = 1, mesh%nnode
         mises(node) = von_mises(at_nodes(:, node))
      end do
   end subroutine nodal_mises
end module lopin_nodal_mises
