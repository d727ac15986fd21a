!> What solids that are not linear leave at their points: stresses for output, memory of what is
!> accepted.
module lopin_recover_nonlinear
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_shared_work, only : shared_work_type, share_out
   use lopin_solid_finite_strain, only : finite_strain_stresses, finite_strain_memory
   use lopin_solid_flow, only : flow_stresses, flow_memory
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_solid_configuration, only : configuration_type, fill_input, columns
   use lopin_assemble_batch, only : recover_in_batch, remember_in_batch
   use lopin_simplex_patches, only : patch_element
   use lopin_solids, only : solids_type, unit_nodes, unit_points
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : strain_at
   implicit none
   private
   public :: recover_nonlinear, remember, recover_unit, remember_unit

   type, extends(shared_work_type) :: recovery_work_type
      type(solids_type), pointer :: solids => null()
      type(mesh_type), pointer :: mesh => null()
      type(solids_state_type), pointer :: memory => null()
      real(wp), pointer :: u(:, :) => null(), stress(:, :) => null(), strain(:, :) => null()
   contains
      procedure :: do_part => recover_batch
   end type recovery_work_type

   type, extends(shared_work_type) :: memory_work_type
      type(configuration_type) :: shape
      real(wp), pointer, contiguous :: next(:, :) => null()    !! (nmemory, ncolumn)
      real(wp), allocatable :: work(:), volume(:)              !! (nelement)
   contains
      procedure :: do_part => remember_batch
   end type memory_work_type

contains

   !> Stresses and strains at all Gauss points, laid out as by recover_stress: Cauchy and
   !> logarithmic at finite strain.
   subroutine recover_nonlinear(self, mesh, u, memory, stress, strain)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), intent(in), target :: u(:, :)              !! (>= ndim, nnode) [length]
      type(solids_state_type), intent(in), target :: memory        !! of the accepted state
      real(wp), allocatable, intent(out), target :: stress(:, :)   !! (6, npoint) [stress]
      real(wp), allocatable, intent(out), target :: strain(:, :)   !! (6, npoint) engineering
                                                                   !! shears [-]
      type(recovery_work_type) :: work
      integer :: npoint

      npoint = self%first_point(mesh%nelement + 1) - 1
      allocate (stress(6, npoint), strain(6, npoint))
      work%solids => self
      work%mesh => mesh
      work%u => u
      work%memory => memory
      work%stress => stress
      work%strain => strain
      call share_out(work, [1, size(self%batch_start)])
   end subroutine recover_nonlinear

   subroutine recover_batch(self, k)
      class(recovery_work_type), intent(inout) :: self
      integer, intent(in) :: k                 !! the run of elements
      integer :: i
      logical :: done

      associate (start => self%solids%batch_start)
         associate (element => self%solids%order(start(k):start(k + 1) - 1))
            call recover_in_batch(self%solids, self%mesh, self%u, self%memory, element, &
               & self%stress, self%strain, done)
            if (done) return
            do i = 1, size(element)
               call recover_unit(self%solids, self%mesh, self%u, self%memory, element(i), &
                  & self%stress, self%strain)
            end do
         end associate
      end associate
   end subroutine recover_batch

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
      type(solids_state_type), intent(inout), target :: next     !! of the trial
      type(memory_work_type) :: work
      real(wp), allocatable :: strain(:)
      integer :: e, p, q, row

      if (.not. memory%in_use) return
      allocate (work%work(mesh%nelement), work%volume(mesh%nelement), strain(mesh%nelement), &
         & source=0.0_wp)
      next%value = memory%value
      work%next => next%value
      work%shape = configuration_type(self, mesh, u, memory)
      call share_out(work, [1, size(self%batch_start)])
      do e = 1, mesh%nelement
         p = memory%first(e)
         q = memory%first(e + 1) - 1
         if (q < p) cycle
         row = strain_at(self%group(self%which(e))%element%nstress)
         strain(e) = maxval(next%value(row, p:q) - memory%value(row, p:q))
      end do
      next%work = memory%work + sum(work%work)
      next%most_strain = maxval(strain)
      next%most_element = maxloc(strain, dim=1)
      next%volume = sum(work%volume)
   end subroutine remember

   subroutine remember_batch(self, k)
      class(memory_work_type), intent(inout) :: self
      integer, intent(in) :: k                 !! the run of elements
      integer :: i
      logical :: done

      associate (solids => self%shape%solids, first => self%shape%memory%first)
         associate (element => solids%order(solids%batch_start(k):solids%batch_start(k + 1) - 1))
            call remember_in_batch(self%shape, element, self%next, self%work, self%volume, done)
            if (done) return
            do i = 1, size(element)
               if (first(element(i) + 1) > first(element(i))) call remember_unit(self%shape, &
                  & element(i), self%next, self%work(element(i)), self%volume(element(i)))
            end do
         end associate
      end associate
   end subroutine remember_batch

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
end module lopin_recover_nonlinear
