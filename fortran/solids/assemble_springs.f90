!> Springs beside the solids of a mesh: their place in its matrix, and what they add.
module lopin_assemble_springs
   use lopin_kinds, only : wp, ik
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type, storage
   use lopin_model, only : spring_type
   use lopin_solids, only : solids_type, list_equations, set_slots, add_slots
   use lopin_springs, only : spring_element
   implicit none
   private
   public :: attach_springs, add_springs

contains

   !> Springs join solids whose tables and matrix are made: the matrix is laid out anew.
   subroutine attach_springs(self, mesh, spring, matrix)
      type(solids_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      type(spring_type), intent(in) :: spring(:)
      type(csc_type), intent(inout) :: matrix
      integer, allocatable :: start(:), equation(:), more(:)
      integer :: s, k, d

      if (size(spring) == 0) return
      self%spring = spring
      d = mesh%ndim
      call list_equations(self, mesh, start, equation)
      allocate (more(2*d*size(spring)), source=0)
      do s = 1, size(spring)
         do k = 1, 2
            if (spring(s)%node(k) > 0) more(2*d*(s - 1) + d*(k - 1) + 1:2*d*(s - 1) + d*k) = &
               & self%dof(:d, spring(s)%node(k))
         end do
      end do
      call matrix%new_from_lists(self%n, storage%symmetric_lower, &
         & [start, start(size(start)) + [(2*d*s, s=1, size(spring))]], [equation, more])
      deallocate (self%first_slot, self%slot)
      call set_slots(self, matrix, [start, start(size(start)) + [(2*d*s, s=1, size(spring))]], &
         & [equation, more])
   end subroutine attach_springs

   !> Add the forces, the energy and, if asked for, the stiffness of all springs.
   subroutine add_springs(self, mesh, u, finite, force, energy, value)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)             !! (n) displacements by equation [length]
      logical, intent(in) :: finite
      real(wp), intent(inout) :: force(:)      !! (n) [force]
      real(wp), intent(inout) :: energy        !! [force length]
      real(wp), intent(inout), optional :: value(:)    !! of the matrix
      real(wp), dimension(mesh%ndim, 2) :: x, moved, own
      real(wp) :: ke(2*mesh%ndim, 2*mesh%ndim), stored
      integer :: s, k, i, e, at(mesh%ndim, 2)

      if (.not. allocated(self%spring)) return
      do s = 1, size(self%spring)
         at = 0
         x = 0.0_wp
         do k = 1, 2
            if (self%spring(s)%node(k) == 0) cycle
            at(:, k) = self%dof(:mesh%ndim, self%spring(s)%node(k))
            x(:, k) = mesh%x(:, self%spring(s)%node(k))
         end do
         moved = reshape([(at_dof(u, at(1 + mod(i, mesh%ndim), 1 + i/mesh%ndim)), &
            & i=0, 2*mesh%ndim - 1)], shape(moved))
         call spring_element(self%spring(s), x, moved, finite, own, ke, stored)
         energy = energy + stored
         do k = 1, 2
            do i = 1, mesh%ndim
               if (at(i, k) > 0) force(at(i, k)) = force(at(i, k)) + own(i, k)
            end do
         end do
         e = mesh%nelement + s
         if (present(value)) call add_slots(self%slot(self%first_slot(e): &
            & self%first_slot(e + 1) - 1), ke, value)
      end do
   end subroutine add_springs

   !> A displacement; 0 where there is no equation.
   pure real(wp) function at_dof(u, dof)
      real(wp), intent(in) :: u(:)
      integer, intent(in) :: dof

      at_dof = 0.0_wp
      if (dof > 0) at_dof = u(dof)
   end function at_dof
end module lopin_assemble_springs
