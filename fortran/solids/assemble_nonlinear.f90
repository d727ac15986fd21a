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
   use lopin_solid_configuration, only : configuration_type, share_type, fill_input, add_nodes
   use lopin_assemble_batch, only : add_batch, recover_in_batch, remember_in_batch
   use lopin_simplex_patches, only : patch_element
   use lopin_solids, only : solids_type, add_slots, unit_nodes, unit_points
   use lopin_assemble_springs, only : add_springs
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : strain_at
   implicit none
   private
   public :: assemble_nonlinear, recover_nonlinear, remember, bad_element_type, elastic_energy
   public :: columns, recover_unit, remember_unit

   !> An element that the displacements turn inside out; and the largest force of an element on one
   !> of its nodes, before those of its neighbours cancel it.
   type :: bad_element_type
      integer :: element = 0     !! the first one; 0: none
      integer :: point = 0       !! its Gauss point
      integer :: number = 0      !! how many there are
      real(wp) :: force = 0.0_wp !! of all elements, by component [force]
   end type bad_element_type

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
      integer :: c, k, ncolour
      logical :: shared_out

      shape = configuration_type(self, mesh, u, memory)
      ncolour = size(self%colour_start) - 1
      allocate (share(mesh%nelement))
      force = 0.0_wp
      if (present(matrix)) matrix%value = 0.0_wp
      do c = 1, ncolour
         shared_out = .not. (self%last_is_serial .and. c == ncolour)
         !$omp parallel do schedule(static) if(shared_out)
         do k = self%colour_batch(c), self%colour_batch(c + 1) - 1
            call add_run(shape, self%batch_start(k), self%batch_start(k + 1) - 1, force, share, &
               & matrix)
         end do
         !$omp end parallel do
      end do
      energy = sum(share%energy)
      if (present(matrix)) then
         call add_springs(self, mesh, u, memory%finite_strain, force, energy, matrix%value)
      else
         call add_springs(self, mesh, u, memory%finite_strain, force, energy)
      end if
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

   !> Energy of the elements that remember nothing [force length].
   real(wp) function elastic_energy(self, mesh, u, memory) result(energy)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) displacements by equation [length]
      type(solids_state_type), intent(in), target :: memory
      type(configuration_type) :: shape
      type(share_type) :: share
      real(wp) :: force(size(u))
      integer :: e

      shape = configuration_type(self, mesh, u, memory)
      energy = 0.0_wp
      force = 0.0_wp
      do e = 1, mesh%nelement
         if (self%which(e) == 0 .or. memory%first(e + 1) > memory%first(e)) cycle
         if (size(unit_nodes(self, mesh, e)) == 0) cycle   ! another member stands for its patch
         share = share_type()
         call add_unit(shape, e, force, share)
         energy = energy + share%energy
      end do
   end function elastic_energy

   !> Elements that follow each other in the order: at a time, or one by one.
   subroutine add_run(shape, from, to, force, share, matrix)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: from, to          !! of the order of elements
      real(wp), contiguous, intent(inout) :: force(:)
      type(share_type), contiguous, intent(inout) :: share(:)   !! (nelement)
      type(csc_type), intent(inout), optional :: matrix
      integer :: k
      logical :: done

      call add_batch(shape, shape%solids%order(from:to), force, share, done, matrix)
      if (done) return
      do k = from, to
         call add_unit(shape, shape%solids%order(k), force, share(shape%solids%order(k)), matrix)
      end do
   end subroutine add_run

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

      call fill_input(shape, e, node, x, moved, input)
      input%memory => past
      if (present(matrix)) then
         call own_element(shape%memory%finite_strain, element, input, own, share, ke)
      else
         call own_element(shape%memory%finite_strain, element, input, own, share)
      end if
      if (share%bad > 0) return
      call add_nodes(shape, node, own, force, share)
      if (present(matrix)) call add_slots(shape%solids%slot(shape%solids%first_slot(e): &
         & shape%solids%first_slot(e + 1) - 1), ke, matrix%value)
   end subroutine add_element

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

   !> Stresses and strains at all Gauss points, laid out as by recover_stress: Cauchy and
   !> logarithmic at finite strain.
   subroutine recover_nonlinear(self, mesh, u, memory, stress, strain)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)                      !! (>= ndim, nnode) [length]
      type(solids_state_type), intent(in) :: memory        !! of the accepted state
      real(wp), allocatable, intent(out) :: stress(:, :)   !! (6, npoint) [stress]
      real(wp), allocatable, intent(out) :: strain(:, :)   !! (6, npoint) engineering shears [-]
      integer :: k, b, npoint
      logical :: done

      npoint = self%first_point(mesh%nelement + 1) - 1
      allocate (stress(6, npoint), strain(6, npoint))
      !$omp parallel do schedule(static) private(done, k)
      do b = 1, size(self%batch_start) - 1
         associate (element => self%order(self%batch_start(b):self%batch_start(b + 1) - 1))
            call recover_in_batch(self, mesh, u, memory, element, stress, strain, done)
            if (done) cycle
            do k = 1, size(element)
               call recover_unit(self, mesh, u, memory, element(k), stress, strain)
            end do
         end associate
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
      integer :: b, e, k, p, q, row
      logical :: done

      if (.not. memory%in_use) return
      allocate (work(mesh%nelement), volume(mesh%nelement), strain(mesh%nelement), source=0.0_wp)
      next%value = memory%value
      shape = configuration_type(self, mesh, u, memory)
      !$omp parallel do schedule(static) private(done, k)
      do b = 1, size(self%batch_start) - 1
         associate (element => self%order(self%batch_start(b):self%batch_start(b + 1) - 1))
            call remember_in_batch(shape, element, next%value, work, volume, done)
            if (done) cycle
            do k = 1, size(element)
               if (memory%first(element(k) + 1) > memory%first(element(k))) call remember_unit( &
                  & shape, element(k), next%value, work(element(k)), volume(element(k)))
            end do
         end associate
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
      real(wp), allocatable :: past(:, :), own(:, :)

      associate (self => shape%solids, patches => shape%solids%patches, memory => shape%memory)
         associate (group => self%group(self%which(e)), p => patches%of(e))
            if (p == 0) then
               call own_memory(shape, e, group%element, shape%mesh%conn(:group%element%nnode, e), &
                  & memory%value(:, memory%first(e):memory%first(e + 1) - 1), &
                  & next(:, memory%first(e):memory%first(e + 1) - 1), work, volume)
            else if (patches%member(patches%start(p)) == e) then
               call patch_element(patches, p, shape%mesh%conn, group%element, element)
               allocate (past, source=columns(self, memory, e))
               allocate (own, source=past)
               call own_memory(shape, e, element, &
                  & patches%node(patches%first(p):patches%first(p + 1) - 1), past, own, work, &
                  & volume)
               allocate (point, source=unit_points(self, memory%first, e))
               next(:, point) = own
            end if
         end associate
      end associate
   end subroutine remember_unit

   subroutine own_memory(shape, e, element, node, past, next, work, volume)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      type(element_type), intent(in) :: element    !! that of e, or of its patch
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in), target :: past(:, :)
      real(wp), contiguous, intent(inout) :: next(:, :)   !! equal to `past` before
      real(wp), intent(inout) :: work, volume
      real(wp), dimension(element%ndim, element%nnode), target :: x, moved
      type(element_input_type) :: input
      integer :: bad

      call fill_input(shape, e, node, x, moved, input)
      input%memory => past
      if (shape%memory%finite_strain) then
         call finite_strain_memory(element, input, next, work, volume, bad)
      else
         call flow_memory(element, input, next, work, volume, bad)
      end if
   end subroutine own_memory
end module lopin_assemble_nonlinear
