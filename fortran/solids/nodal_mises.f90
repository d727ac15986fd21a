!> Stresses at the nodes that laws of friction read at a slave: von Mises', and that of flow.
module lopin_nodal_mises
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_solids, only : solids_type
   use lopin_solid_memory, only : at_all_points
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : stress_at
   use lopin_recover_nonlinear, only : recover_nonlinear, remember
   use lopin_recover_stress, only : recover_stress, average_to_nodes
   use lopin_von_mises, only : von_mises
   implicit none
   private
   public :: nodal_mises, nodal_flow_stress

contains

   !> Of the stress that is extrapolated to the nodes and averaged there; 0 where no element is.
   subroutine nodal_mises(solids, mesh, u, memory, mises)
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)      !! (>= ndim, nnode) displacements [length]
      type(solids_state_type), intent(in) :: memory   !! of the accepted state
      real(wp), intent(out) :: mises(:)    !! (nnode) [stress]
      real(wp), allocatable :: stress(:, :), strain(:, :)
      real(wp) :: at_nodes(6, mesh%nnode)
      integer :: node

      if (memory%finite_strain .or. memory%in_use) then
         call recover_nonlinear(solids, mesh, u, memory, stress, strain)
      else
         call recover_stress(solids, mesh, u, stress, strain)
      end if
      call average_to_nodes(solids, mesh, stress, at_nodes)
      do node = 1, mesh%nnode
         mises(node) = von_mises(at_nodes(:, node))
      end do
   end subroutine nodal_mises

   !> Flow stress of the solids behind each node, averaged over those that flow; 0 where none does.
   subroutine nodal_flow_stress(solids, mesh, u, memory, next, stress)
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)         !! (n) displacements by equation [length]
      type(solids_state_type), intent(in) :: memory      !! of the accepted state
      type(solids_state_type), intent(inout) :: next     !! becomes that of u
      real(wp), intent(out) :: stress(:)   !! (nnode) [stress]
      real(wp), allocatable :: at_points(:, :)
      real(wp) :: at_nodes(2, mesh%nnode)
      integer :: node

      call remember(solids, mesh, u, memory, next)
      allocate (at_points(2, solids%first_point(mesh%nelement + 1) - 1))
      at_points(1, :) = at_all_points(next, solids, stress_at(merge(4, 6, mesh%ndim == 2)))
      at_points(2, :) = merge(1.0_wp, 0.0_wp, at_points(1, :) > 0.0_wp)
      call average_to_nodes(solids, mesh, at_points, at_nodes)
      stress = 0.0_wp
      do node = 1, mesh%nnode
         if (at_nodes(2, node) > 0.0_wp) stress(node) = max(0.0_wp, at_nodes(1, node) &
            & /at_nodes(2, node))
      end do
   end subroutine nodal_flow_stress
end module lopin_nodal_mises
