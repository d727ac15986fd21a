!> Assembly of solids that are not linear, at finite strain or because they flow: internal force,
!> energy and tangent of a whole mesh, stresses for output, memory of what is accepted.
!>
!> Groups, colours and slots are those of the small-strain stiffness, so that the tangent has the
!> pattern of that matrix and the bits do not depend on the number of threads.
module lopin_assemble_nonlinear
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_solid_finite_strain, only : finite_strain_element, finite_strain_stresses, &
      & finite_strain_memory
   use lopin_solid_flow, only : flow_element, flow_stresses, flow_memory
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_simplex_patches, only : patch_element
   use lopin_solids, only : solids_type, add_slots, unit_nodes, unit_points
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : strain_at
   implicit none
   private
   public :: assemble_nonlinear, recover_nonlinear, remember, bad_element_type
   public :: configuration_type, fill_input, columns

   !> An element that the displacements turn inside out; and the largest force of an element on one
   !> of its nodes, before those of its neighbours cancel it.
   type :: bad_element_type
      integer :: element = 0     !! the first one; 0: none
      integer :: point = 0       !! its Gauss point
      integer :: number = 0      !! how many there are
      real(wp) :: force = 0.0_wp !! of all elements, by component [force]
   end type bad_element_type

   !> What an element, or a patch of elements, adds beside its forces.
   type :: share_type
      real(wp) :: energy = 0.0_wp   !! [force length]
      integer :: bad = 0            !! Gauss point turned inside out
      real(wp) :: most = 0.0_wp     !! its largest force on a node, by component [force]
   end type share_type

   !> The solids in a displaced configuration, with what their points remember of the accepted one.
   type :: configuration_type
      type(solids_type), pointer :: solids => null()
      type(mesh_type), pointer :: mesh => null()
      real(wp), pointer, contiguous :: u(:) => null()   !! (n) total displacements [length]
      type(solids_state_type), pointer :: memory => null()
   end type configuration_type

contains

   !> Internal force and energy of all solid elements and, if asked for, their tangent.
   !>
   !> Where `bad` names an element, nothing else is defined: the step was too large.
   subroutine assemble_nonlinear(self, mesh, u, memory, force, energy, bad, matrix)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) displacements by equation [length]
      type(solids_state_type), intent(in), target :: memory   !! of the accepted state
      real(wp), contiguous, intent(out) :: force(:)   !! (n) internal forces [force]
      real(wp), intent(out) :: energy          !! strain energy [force length]
      type(bad_element_type), intent(out) :: bad
      type(csc_type), intent(inout), optional :: matrix   !! of new_solids; values are replaced
      type(configuration_type) :: shape
      type(share_type), allocatable :: share(:)
      integer :: c, k, e, ncolour
      logical :: shared_out

      shape = configuration_type(self, mesh, u, memory)
      ncolour = size(self%colour_start) - 1
      allocate (share(mesh%nelement))
      force = 0.0_wp
      if (present(matrix)) matrix%value = 0.0_wp
      do c = 1, ncolour
         shared_out = .not. (self%last_is_serial .and. c == ncolour)
         !$omp parallel do schedule(static) private(e) if(shared_out)
         do k = self%colour_start(c), self%colour_start(c + 1) - 1
            e = self%order(k)
            call add_unit(shape, e, force, share(e), matrix)
         end do
         !$omp end parallel do
      end do
      energy = sum(share%energy)
      bad%force = maxval([0.0_wp, share%most])
      bad%number = count(share%bad > 0)
      if (bad%number == 0) return
      bad%element = 1
      do while (share(bad%element)%bad == 0)
         bad%element = bad%element + 1
      end do
      bad%point = share(bad%element)%bad
      if (self%patches%of(bad%element) == 0) return
      ! The point is one of its patch.
      associate (p => self%patches, n => self%group(self%which(bad%element))%element%ngauss)
         bad%element = p%member(p%start(p%of(bad%element)) + (bad%point - 1)/n)
         bad%point = 1 + mod(bad%point - 1, n)
      end associate
   end subroutine assemble_nonlinear

   !> An element, or the patch that it stands for.
   subroutine add_unit(shape, e, force, share, matrix)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      real(wp), contiguous, intent(inout) :: force(:)
      type(share_type), intent(inout) :: share
      type(csc_type), intent(inout), optional :: matrix

      if (shape%solids%patches%of(e) > 0) then
         call add_patch(shape, e, force, share, matrix)
         return
      end if
      associate (group => shape%solids%group(shape%solids%which(e)), memory => shape%memory)
         associate (node => shape%mesh%conn(:group%element%nnode, e))
            if (group%law%remembers) then
               call add_element(shape, e, group%element, node, &
                  & memory%value(:, memory%first(e):memory%first(e + 1) - 1), force, share, matrix)
            else
               call add_element(shape, e, group%element, node, memory%none, force, share, matrix)
            end if
         end associate
      end associate
   end subroutine add_unit

   subroutine add_patch(shape, e, force, share, matrix)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e                 !! its first member
      real(wp), contiguous, intent(inout) :: force(:)
      type(share_type), intent(inout) :: share
      type(csc_type), intent(inout), optional :: matrix
      type(element_type) :: element

      associate (self => shape%solids, patches => shape%solids%patches, &
         & p => shape%solids%patches%of(e))
         call patch_element(patches, p, shape%mesh%conn, self%group(self%which(e))%element, element)
         associate (node => patches%node(patches%first(p):patches%first(p + 1) - 1))
            call add_element(shape, e, element, node, columns(self, shape%memory, e), force, &
               & share, matrix)
         end associate
      end associate
   end subroutine add_patch

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

   subroutine add_element(shape, e, element, node, past, force, share, matrix)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      type(element_type), intent(in) :: element    !! that of e, or of its patch
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in), target :: past(:, :)
      real(wp), contiguous, intent(inout) :: force(:)
      type(share_type), intent(inout) :: share
      type(csc_type), intent(inout), optional :: matrix
      real(wp), dimension(element%ndim, element%nnode), target :: x, moved
      real(wp) :: own(element%ndim, element%nnode), ke(element%ndof, element%ndof)
      type(element_input_type) :: input
      integer :: a, i

      call fill_input(shape, e, node, x, moved, input)
      input%memory => past
      if (present(matrix)) then
         call own_element(shape%memory%finite_strain, element, input, own, share, ke)
      else
         call own_element(shape%memory%finite_strain, element, input, own, share)
      end if
      if (share%bad > 0) return
      share%most = maxval(abs(own))
      associate (self => shape%solids)
         do a = 1, element%nnode
            do i = 1, element%ndim
               associate (k => self%dof(i, node(a)))
                  if (k > 0) force(k) = force(k) + own(i, a)
               end associate
            end do
         end do
         if (present(matrix)) call add_slots( &
            & self%slot(self%first_slot(e):self%first_slot(e + 1) - 1), ke, matrix%value)
      end associate
   end subroutine add_element

   !> What an element is computed from, but for its memory.
   subroutine fill_input(shape, e, node, x, moved, input)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(out), target :: x(:, :), moved(:, :)   !! where they are put
      type(element_input_type), intent(out) :: input
      integer :: a

      do a = 1, size(node)
         x(:, a) = shape%mesh%x(:, node(a))
      end do
      call displacements(shape%solids, node, shape%u, moved)
      input%law => shape%solids%group(shape%solids%which(e))%law
      input%x => x
      input%u => moved
      input%thickness = shape%solids%group(shape%solids%which(e))%thickness
      input%dt = shape%memory%dt
      input%scaled = shape%memory%scaled .and. input%law%remembers
   end subroutine fill_input

   !> One element, by the kinematics of the step.
   subroutine own_element(finite_strain, element, input, force, share, ke)
      logical, intent(in) :: finite_strain
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), contiguous, intent(out) :: force(:, :)
      type(share_type), intent(inout) :: share
      real(wp), contiguous, intent(out), optional :: ke(:, :)

      if (finite_strain) then
         call finite_strain_element(element, input, force, share%energy, share%bad, ke)
      else
         call flow_element(element, input, force, share%energy, share%bad, ke)
      end if
   end subroutine own_element

   !> Displacements of nodes; zero where there is no equation.
   pure subroutine displacements(self, node, u, moved)
      type(solids_type), intent(in) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: u(:)
      real(wp), contiguous, intent(out) :: moved(:, :)   !! (ndim, size(node)) [length]
      integer :: a, i

      moved = 0.0_wp
      do a = 1, size(node)
         do i = 1, size(moved, 1)
            if (self%dof(i, node(a)) > 0) moved(i, a) = u(self%dof(i, node(a)))
         end do
      end do
   end subroutine displacements

   !> Stresses and strains at all Gauss points, laid out as by recover_stress: Cauchy and
   !> logarithmic at finite strain.
   subroutine recover_nonlinear(self, mesh, u, memory, stress, strain)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)                      !! (>= ndim, nnode) [length]
      type(solids_state_type), intent(in) :: memory        !! of the accepted state
      real(wp), allocatable, intent(out) :: stress(:, :)   !! (6, npoint) [stress]
      real(wp), allocatable, intent(out) :: strain(:, :)   !! (6, npoint) engineering shears [-]
      integer :: e, npoint

      npoint = self%first_point(mesh%nelement + 1) - 1
      allocate (stress(6, npoint), strain(6, npoint))
      !$omp parallel do schedule(static)
      do e = 1, mesh%nelement
         call recover_unit(self, mesh, u, memory, e, stress, strain)
      end do
      !$omp end parallel do
   end subroutine recover_nonlinear

   subroutine recover_unit(self, mesh, u, memory, e, stress, strain)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)
      type(solids_state_type), intent(in) :: memory
      integer, intent(in) :: e
      real(wp), intent(inout) :: stress(:, :), strain(:, :)
      type(element_type) :: element
      type(element_input_type) :: input
      integer, allocatable :: node(:), point(:)
      real(wp), allocatable :: own(:, :), elongation(:, :)
      real(wp), allocatable, target :: x(:, :), moved(:, :), past(:, :)

      allocate (node, source=unit_nodes(self, mesh, e))
      if (size(node) == 0) return
      associate (group => self%group(self%which(e)), p => self%patches%of(e))
         x = mesh%x(:, node)
         moved = u(:group%element%ndim, node)
         allocate (past, source=columns(self, memory, e))
         input = element_input_type(group%law, x, moved, past, group%thickness, memory%dt, &
            & memory%scaled .and. group%law%remembers)
         if (p == 0) then
            call own_stresses(memory%finite_strain, group%element, input, &
               & stress(:, self%first_point(e):self%first_point(e + 1) - 1), &
               & strain(:, self%first_point(e):self%first_point(e + 1) - 1))
         else
            call patch_element(self%patches, p, mesh%conn, group%element, element)
            allocate (own(6, element%ngauss), elongation(6, element%ngauss))
            call own_stresses(memory%finite_strain, element, input, own, elongation)
            allocate (point, source=unit_points(self, self%first_point, e))
            stress(:, point) = own
            strain(:, point) = elongation
         end if
      end associate
   end subroutine recover_unit

   subroutine own_stresses(finite_strain, element, input, stress, strain)
      logical, intent(in) :: finite_strain
      type(element_type), intent(in) :: element
      type(element_input_type), intent(in) :: input
      real(wp), intent(out) :: stress(:, :), strain(:, :)
      integer :: bad

      if (finite_strain) then
         call finite_strain_stresses(element, input, stress, strain, bad)
      else
         call flow_stresses(element, input, stress, strain, bad)
      end if
   end subroutine own_stresses

   !> The memory of a trial, and its plastic work.
   subroutine remember(self, mesh, u, memory, next)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) displacements by equation [length]
      type(solids_state_type), intent(in), target :: memory      !! of the accepted state
      type(solids_state_type), intent(inout) :: next     !! of the trial
      type(configuration_type) :: shape
      real(wp), allocatable :: work(:), volume(:), strain(:)
      integer :: e, p, q, row

      if (.not. memory%in_use) return
      allocate (work(mesh%nelement), volume(mesh%nelement), strain(mesh%nelement), source=0.0_wp)
      next%value = memory%value
      shape = configuration_type(self, mesh, u, memory)
      !$omp parallel do schedule(static)
      do e = 1, mesh%nelement
         if (memory%first(e + 1) > memory%first(e)) call remember_unit(shape, e, next%value, &
            & work(e), volume(e))
      end do
      !$omp end parallel do
      do e = 1, mesh%nelement
         p = memory%first(e)
         q = memory%first(e + 1) - 1
         if (q < p) cycle
         row = strain_at(self%group(self%which(e))%element%nstress)
         strain(e) = maxval(next%value(row, p:q) - memory%value(row, p:q))
      end do
      next%work = memory%work + sum(work)
      next%most_strain = maxval(strain)
      next%most_element = maxloc(strain, dim=1)
      next%volume = sum(volume)
   end subroutine remember

   !> Of an element or of the patch that it stands for; `next` holds the accepted state before.
   subroutine remember_unit(shape, e, next, work, volume)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      real(wp), contiguous, intent(inout) :: next(:, :)   !! (nmemory, ncolumn)
      real(wp), intent(inout) :: work, volume
      type(element_type) :: element
      integer, allocatable :: point(:)
      real(wp), allocatable :: past(:, :)

      associate (self => shape%solids, patches => shape%solids%patches, memory => shape%memory)
         associate (group => self%group(self%which(e)), p => patches%of(e))
            if (p == 0) then
               call own_memory(shape, e, group%element, shape%mesh%conn(:group%element%nnode, e), &
                  & next(:, memory%first(e):memory%first(e + 1) - 1), work, volume)
            else if (patches%member(patches%start(p)) == e) then
               call patch_element(patches, p, shape%mesh%conn, group%element, element)
               allocate (past, source=columns(self, memory, e))
               call own_memory(shape, e, element, &
                  & patches%node(patches%first(p):patches%first(p + 1) - 1), past, work, volume)
               allocate (point, source=unit_points(self, memory%first, e))
               next(:, point) = past
            end if
         end associate
      end associate
   end subroutine remember_unit

   subroutine own_memory(shape, e, element, node, next, work, volume)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      type(element_type), intent(in) :: element    !! that of e, or of its patch
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(inout) :: next(:, :)
      real(wp), intent(inout) :: work, volume
      real(wp), dimension(element%ndim, element%nnode), target :: x, moved
      real(wp), target :: past(size(next, 1), size(next, 2))
      type(element_input_type) :: input
      integer :: bad

      past = next
      call fill_input(shape, e, node, x, moved, input)
      input%memory => past
      if (shape%memory%finite_strain) then
         call finite_strain_memory(element, input, next, work, volume, bad)
      else
         call flow_memory(element, input, next, work, volume, bad)
      end if
   end subroutine own_memory
end module lopin_assemble_nonlinear
