!> Assembly of solids that are not linear, at finite strain or because they flow: internal force,
!> energy and tangent of a whole mesh.
!>
!> Groups, colours and slots are those of the small-strain stiffness, so that the tangent has the
!> pattern of that matrix and the bits do not depend on the number of threads.
module lopin_assemble_nonlinear
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type
   use lopin_shared_work, only : shared_work_type, share_out
   use lopin_solid_finite_strain, only : finite_strain_element
   use lopin_solid_flow, only : flow_element
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_solid_configuration, only : configuration_type, share_type, fill_input, add_nodes, &
      & columns
   use lopin_assemble_batch, only : add_batch
   use lopin_simplex_patches, only : patch_element
   use lopin_solids, only : solids_type, add_slots, unit_nodes
   use lopin_assemble_springs, only : add_springs
   use lopin_state, only : solids_state_type
   implicit none
   private
   public :: assemble_nonlinear, bad_element_type, elastic_energy

   !> An element that the displacements turn inside out; and the largest force of an element on one
   !> of its nodes, before those of its neighbours cancel it.
   type :: bad_element_type
      integer :: element = 0     !! the first one; 0: none
      integer :: point = 0       !! its Gauss point
      integer :: number = 0      !! how many there are
      real(wp) :: force = 0.0_wp !! of all elements, by component [force]
   end type bad_element_type

   !> Runs of elements of one colour touch different nodes.
   type, extends(shared_work_type) :: assembly_work_type
      type(configuration_type) :: shape
      real(wp), pointer, contiguous :: force(:) => null()
      type(share_type), pointer, contiguous :: share(:) => null()   !! (nelement)
      type(csc_type), pointer :: matrix => null()                   !! or none
   contains
      procedure :: do_part => add_one_run
   end type assembly_work_type

contains

   !> Internal force and energy of all solid elements and, if asked for, their tangent.
   !>
   !> Where `bad` names an element, nothing else is defined: the step was too large.
   subroutine assemble_nonlinear(self, mesh, u, memory, force, energy, bad, matrix)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) displacements by equation [length]
      type(solids_state_type), intent(in), target :: memory   !! of the accepted state
      real(wp), contiguous, intent(out), target :: force(:)   !! (n) internal forces [force]
      real(wp), intent(out) :: energy          !! strain energy [force length]
      type(bad_element_type), intent(out) :: bad
      type(csc_type), intent(inout), optional, target :: matrix   !! of new_solids; values are
                                                                  !! replaced
      type(share_type), allocatable, target :: share(:)
      type(assembly_work_type) :: work

      work%shape = configuration_type(self, mesh, u, memory)
      allocate (share(mesh%nelement))
      force = 0.0_wp
      work%force => force
      work%share => share
      if (present(matrix)) then
         matrix%value = 0.0_wp
         work%matrix => matrix
      end if
      call share_out(work, self%colour_batch, self%last_is_serial)
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

   subroutine add_one_run(self, k)
      class(assembly_work_type), intent(inout) :: self
      integer, intent(in) :: k                 !! the run

      ! A matrix that is not there is absent.
      associate (start => self%shape%solids%batch_start)
         call add_run(self%shape, start(k), start(k + 1) - 1, self%force, self%share, self%matrix)
      end associate
   end subroutine add_one_run

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
end module lopin_assemble_nonlinear
