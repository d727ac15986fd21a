!> Assembly of solids that are not linear, at finite strain or because they flow: internal force,
!> energy and tangent of a whole mesh, stresses for output, memory of what is accepted.
!>
!> Groups, colours and slots are those of the small-strain stiffness, so that the tangent has the
!> pattern of that matrix and the bits do not depend on the number of threads.
module lopin_assemble_finite
   use lopin_kinds, only : wp, ik
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_solid_finite, only : finite_element, finite_stresses, finite_memory
   use lopin_solid_flow, only : flow_element, flow_stresses, flow_memory
   use lopin_assemble_solids, only : solids_type, group_type, add_slots
   use lopin_solid_memory, only : solid_memory_type
   use lopin_material_memory, only : strain_at
   implicit none
   private
   public :: assemble_finite, recover_finite, remember, bad_element_type

   !> An element that the displacements turn inside out.
   type :: bad_element_type
      integer :: element = 0     !! the first one; 0: none
      integer :: point = 0       !! its Gauss point
      integer :: number = 0      !! how many there are
   end type bad_element_type

contains

   !> Internal force and energy of all solid elements and, if asked for, their tangent.
   !>
   !> Where `bad` names an element, nothing else is defined: the step was too large.
   subroutine assemble_finite(self, mesh, u, memory, force, energy, bad, matrix)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)             !! (n) total displacements by equation [length]
      type(solid_memory_type), intent(in) :: memory   !! of the accepted state
      real(wp), intent(out) :: force(:)        !! (n) internal forces [force]
      real(wp), intent(out) :: energy          !! strain energy [force length]
      type(bad_element_type), intent(out) :: bad
      type(csc_type), intent(inout), optional :: matrix   !! of new_solids; values are replaced
      real(wp), allocatable :: part(:)
      integer, allocatable :: point(:)
      integer :: c, k, e, ncolour
      logical :: shared_out

      ncolour = size(self%colour_start) - 1
      allocate (part(mesh%nelement), source=0.0_wp)
      allocate (point(mesh%nelement), source=0)
      force = 0.0_wp
      if (present(matrix)) matrix%value = 0.0_wp
      do c = 1, ncolour
         shared_out = .not. (self%last_is_serial .and. c == ncolour)
         !$omp parallel do schedule(static) private(e) if(shared_out)
         do k = self%colour_start(c), self%colour_start(c + 1) - 1
            e = self%order(k)
            if (present(matrix)) then
               call add_tangent(self%group(self%which(e)), mesh%x, mesh%conn(:, e), self%dof, u, &
                  & memory, e, self%slot(self%first_slot(e):self%first_slot(e + 1) - 1), force, part(e), &
                  & point(e), matrix%value)
            else
               call add_force(self%group(self%which(e)), mesh%x, mesh%conn(:, e), self%dof, u, &
                  & memory, e, force, part(e), point(e))
            end if
         end do
         !$omp end parallel do
      end do
      energy = sum(part)
      bad%number = count(point > 0)
      if (bad%number == 0) return
      bad%element = findloc(point > 0, .true., dim=1)
      bad%point = point(bad%element)
   end subroutine assemble_finite

   subroutine add_force(group, x, conn, dof, u, memory, e, force, energy, bad)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :), u(:)
      integer, intent(in) :: conn(:), dof(:, :), e
      type(solid_memory_type), intent(in) :: memory
      real(wp), intent(inout) :: force(:)
      real(wp), intent(out) :: energy
      integer, intent(out) :: bad
      real(wp) :: own(group%element%ndof)

      associate (m => group%element%nnode, d => group%element%ndim)
         call own_element(group, x(:, conn(:m)), displacements(dof(:d, conn(:m)), u), memory, e, &
            & own, energy, bad)
         if (bad == 0) call scatter(dof(:d, conn(:m)), own, force)
      end associate
   end subroutine add_force

   subroutine add_tangent(group, x, conn, dof, u, memory, e, slot, force, energy, bad, value)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :), u(:)
      integer, intent(in) :: conn(:), dof(:, :), e
      type(solid_memory_type), intent(in) :: memory
      integer(ik), intent(in) :: slot(:)
      real(wp), intent(inout) :: force(:), value(:)
      real(wp), intent(out) :: energy
      integer, intent(out) :: bad
      real(wp) :: own(group%element%ndof), ke(group%element%ndof, group%element%ndof)

      associate (m => group%element%nnode, d => group%element%ndim)
         call own_element(group, x(:, conn(:m)), displacements(dof(:d, conn(:m)), u), memory, e, &
            & own, energy, bad, ke)
         if (bad > 0) return
         call scatter(dof(:d, conn(:m)), own, force)
         call add_slots(slot, ke, value)
      end associate
   end subroutine add_tangent

   !> One element, by the kinematics of the step.
   subroutine own_element(group, x, u, memory, e, force, energy, bad, ke)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :), u(:, :)
      type(solid_memory_type), intent(in) :: memory
      integer, intent(in) :: e
      real(wp), intent(out) :: force(:), energy
      integer, intent(out) :: bad
      real(wp), intent(out), optional :: ke(:, :)
      integer :: p

      p = memory%first(e)
      associate (q => p + group%element%ngauss - 1)
         if (memory%finite .and. group%law%flows) then
            call finite_element(group%element, group%law, x, u, group%thickness, &
               & memory%value(:, p:q), memory%dt, force, energy, bad, ke)
         else if (memory%finite) then
            call finite_element(group%element, group%law, x, u, group%thickness, &
               & memory%none, memory%dt, force, energy, bad, ke)
         else if (group%law%flows) then
            call flow_element(group%element, group%law, x, u, group%thickness, &
               & memory%value(:, p:q), memory%dt, force, energy, bad, ke)
         else
            call flow_element(group%element, group%law, x, u, group%thickness, &
               & memory%none, memory%dt, force, energy, bad, ke)
         end if
      end associate
   end subroutine own_element

   pure function displacements(equation, u) result(own)
      integer, intent(in) :: equation(:, :)
      real(wp), intent(in) :: u(:)
      real(wp) :: own(size(equation, 1), size(equation, 2))
      integer :: a, i

      own = 0.0_wp
      do a = 1, size(equation, 2)
         do i = 1, size(equation, 1)
            if (equation(i, a) > 0) own(i, a) = u(equation(i, a))
         end do
      end do
   end function displacements

   pure subroutine scatter(equation, own, force)
      integer, intent(in) :: equation(:, :)
      real(wp), intent(in) :: own(size(equation, 1), size(equation, 2))
      real(wp), intent(inout) :: force(:)
      integer :: a, i

      do a = 1, size(equation, 2)
         do i = 1, size(equation, 1)
            if (equation(i, a) > 0) force(equation(i, a)) = force(equation(i, a)) + own(i, a)
         end do
      end do
   end subroutine scatter

   !> Stresses and strains at all Gauss points, laid out as by recover_stress: Cauchy and
   !> logarithmic at finite strain.
   subroutine recover_finite(self, mesh, u, memory, stress, strain)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)                      !! (>= ndim, nnode) [length]
      type(solid_memory_type), intent(in) :: memory        !! of the accepted state
      real(wp), allocatable, intent(out) :: stress(:, :)   !! (6, npoint) [stress]
      real(wp), allocatable, intent(out) :: strain(:, :)   !! (6, npoint) engineering shears [-]
      integer :: e, npoint, p, q

      npoint = self%first_point(mesh%nelement + 1) - 1
      allocate (stress(6, npoint), strain(6, npoint))
      !$omp parallel do schedule(static) private(p, q)
      do e = 1, mesh%nelement
         if (self%which(e) == 0) cycle
         p = self%first_point(e)
         q = self%first_point(e + 1) - 1
         associate (group => self%group(self%which(e)))
            call own_stresses(group, mesh%x(:, mesh%conn(:group%element%nnode, e)), &
               & u(:group%element%ndim, mesh%conn(:group%element%nnode, e)), memory, e, &
               & stress(:, p:q), strain(:, p:q))
         end associate
      end do
      !$omp end parallel do
   end subroutine recover_finite

   subroutine own_stresses(group, x, u, memory, e, stress, strain)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :), u(:, :)
      type(solid_memory_type), intent(in) :: memory
      integer, intent(in) :: e
      real(wp), intent(out) :: stress(:, :), strain(:, :)
      integer :: p, bad

      p = memory%first(e)
      associate (q => p + group%element%ngauss - 1)
         if (memory%finite .and. group%law%flows) then
            call finite_stresses(group%element, group%law, x, u, group%thickness, &
               & memory%value(:, p:q), memory%dt, stress, strain, bad)
         else if (memory%finite) then
            call finite_stresses(group%element, group%law, x, u, group%thickness, &
               & memory%none, memory%dt, stress, strain, bad)
         else if (group%law%flows) then
            call flow_stresses(group%element, group%law, x, u, group%thickness, &
               & memory%value(:, p:q), memory%dt, stress, strain, bad)
         else
            call flow_stresses(group%element, group%law, x, u, group%thickness, &
               & memory%none, memory%dt, stress, strain, bad)
         end if
      end associate
   end subroutine own_stresses

   !> The memory of a state that will be accepted, into `next`, and its plastic work.
   subroutine remember(self, mesh, u, memory)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:)             !! (n) total displacements by equation [length]
      type(solid_memory_type), intent(inout) :: memory
      real(wp), allocatable :: work(:), volume(:), strain(:)
      integer :: e, p, q, bad, row

      if (.not. memory%in_use) return
      allocate (work(mesh%nelement), volume(mesh%nelement), strain(mesh%nelement), source=0.0_wp)
      memory%next = memory%value
      !$omp parallel do schedule(static) private(p, q, bad, row)
      do e = 1, mesh%nelement
         p = memory%first(e)
         q = memory%first(e + 1) - 1
         if (q < p) cycle
         associate (group => self%group(self%which(e)))
            associate (x => mesh%x(:, mesh%conn(:group%element%nnode, e)), own => displacements( &
               & self%dof(:group%element%ndim, mesh%conn(:group%element%nnode, e)), u))
               if (memory%finite) then
                  call finite_memory(group%element, group%law, x, own, group%thickness, memory%dt, &
                     & memory%next(:, p:q), work(e), volume(e), bad)
               else
                  call flow_memory(group%element, group%law, x, own, group%thickness, memory%dt, &
                     & memory%next(:, p:q), work(e), volume(e), bad)
               end if
               row = strain_at(group%element%nstress)
               strain(e) = maxval(memory%next(row, p:q) - memory%value(row, p:q))
            end associate
         end associate
      end do
      !$omp end parallel do
      memory%next_work = memory%work + sum(work)
      memory%most_strain = maxval(strain)
      memory%most_element = maxloc(strain, dim=1)
      memory%volume = sum(volume)
   end subroutine remember
end module lopin_assemble_finite
