!> The solids in a displaced configuration: what elements are computed from, and where their forces
!> go.
module lopin_solid_configuration
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_element_input, only : element_input_type
   use lopin_solids, only : solids_type, unit_points
   use lopin_state, only : solids_state_type
   implicit none
   private
   public :: configuration_type, share_type, take_nodes, fill_input, add_nodes, columns

   !> Displacements, and what the points remember of the accepted configuration.
   type :: configuration_type
      type(solids_type), pointer :: solids => null()
      type(mesh_type), pointer :: mesh => null()
      real(wp), pointer, contiguous :: u(:) => null()   !! (n) total displacements [length]
      type(solids_state_type), pointer :: memory => null()
   end type configuration_type

   !> What an element, or a patch of elements, adds beside its forces.
   type :: share_type
      real(wp) :: energy = 0.0_wp   !! [force length]
      integer :: bad = 0            !! Gauss point turned inside out
      real(wp) :: most = 0.0_wp     !! its largest force on a node, by component [force]
   end type share_type

contains

   !> Coordinates and displacements of nodes; these are zero where there is no equation.
   subroutine take_nodes(shape, node, x, moved)
      type(configuration_type), intent(in) :: shape
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(out) :: x(:, :), moved(:, :)   !! (ndim, size(node)) [length]
      integer :: a, i

      associate (dof => shape%solids%dof, place => shape%mesh%x)
         do a = 1, size(node)
            do i = 1, size(x, 1)
               x(i, a) = place(i, node(a))
               moved(i, a) = 0.0_wp
               if (dof(i, node(a)) > 0) moved(i, a) = shape%u(dof(i, node(a)))
            end do
         end do
      end associate
   end subroutine take_nodes

   !> What an element is computed from, but for its memory.
   subroutine fill_input(shape, e, node, x, moved, input)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(out), target :: x(:, :), moved(:, :)   !! where they are put
      type(element_input_type), intent(inout) :: input

      call take_nodes(shape, node, x, moved)
      input%law => shape%solids%group(shape%solids%which(e))%law
      input%x => x
      input%u => moved
      input%thickness = shape%solids%group(shape%solids%which(e))%thickness
      input%dt = shape%memory%dt
      input%scaled = shape%memory%scaled .and. input%law%remembers
   end subroutine fill_input

   !> Add the forces of an element to those of the equations.
   subroutine add_nodes(shape, node, own, force, share)
      type(configuration_type), intent(in) :: shape
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: own(:, :)      !! (ndim, size(node)) [force]
      real(wp), contiguous, intent(inout) :: force(:)    !! (n) [force]
      type(share_type), intent(inout) :: share
      integer :: a, i

      share%most = maxval(abs(own))
      do a = 1, size(node)
         do i = 1, size(own, 1)
            associate (k => shape%solids%dof(i, node(a)))
               if (k > 0) force(k) = force(k) + own(i, a)
            end associate
         end do
      end do
   end subroutine add_nodes

   !> What the points of an element or of its patch remember.
   pure function columns(self, memory, e) result(past)
      type(solids_type), intent(in) :: self
      type(solids_state_type), intent(in) :: memory
      integer, intent(in) :: e
      real(wp), allocatable :: past(:, :)   !! (nmemory, ngauss); (0, enough) of what does not flow

      if (.not. self%group(self%which(e))%law%remembers) then
         allocate (past, source=memory%none)
      else if (self%patches%of(e) == 0) then
         allocate (past, source=memory%value(:, memory%first(e):memory%first(e + 1) - 1))
      else
         allocate (past, source=memory%value(:, unit_points(self, memory%first, e)))
      end if
   end function columns
end module lopin_solid_configuration
