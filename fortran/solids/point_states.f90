!> The state of integration points as numbers that mean the same on any mesh: out of a memory at
!> present displacements, and into the memory of a mesh that is at rest in the present shape.
module lopin_point_states
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_element_type, only : element_type
   use lopin_element_input, only : element_input_type
   use lopin_elastic_state, only : elastic_state
   use lopin_simplex_patches, only : patch_element
   use lopin_solids, only : solids_type, unit_nodes, unit_points
   use lopin_solid_configuration, only : configuration_type, fill_input, columns
   use lopin_stress_free_state, only : set_elastic
   use lopin_log_strain, only : first_axis, second_axis, exp_minus_one
   use lopin_hyperelastic, only : finite_law
   use lopin_flow_curve, only : flow_stress
   use lopin_model, only : initial_state_type
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : strain_at, stress_at, work_at, offset_at, &
      & temperature_at
   implicit none
   private
   public :: states_of_points, put_state, settle_states, energy_of_memory, state_rows

   !> Rows of a table of states.
   integer, parameter :: state_rows = 17

contains

   !> One column a point: element, point, x y z, volume [length^3], elastic strain (6, deviator,
   !> tensor components), ln J, ln V/V0, plastic strain, flow stress, plastic work by V0.
   subroutine states_of_points(self, mesh, u, memory, table)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) displacements by equation [length]
      type(solids_state_type), intent(in), target :: memory   !! accepted with them
      real(wp), allocatable, intent(out) :: table(:, :)   !! (state_rows, ncolumn)
      type(configuration_type) :: shape
      integer :: e

      shape = configuration_type(self, mesh, u, memory)
      allocate (table(state_rows, size(memory%value, 2)), source=0.0_wp)
      do e = 1, mesh%nelement
         if (memory%first(e + 1) > memory%first(e)) call states_of_unit(shape, e, table)
      end do
   end subroutine states_of_points

   !> Of an element, or of the patch that it stands for.
   subroutine states_of_unit(shape, e, table)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      real(wp), intent(inout) :: table(:, :)
      type(element_type) :: element
      integer, allocatable :: node(:), point(:)
      integer :: k, i

      allocate (node, source=unit_nodes(shape%solids, shape%mesh, e))
      if (size(node) == 0) return
      associate (self => shape%solids, first => shape%memory%first)
         if (self%patches%of(e) == 0) then
            point = [(k, k=first(e), first(e + 1) - 1)]
            call fill_states(shape, e, self%group(self%which(e))%element, node, point, table)
            call name_points(e)
         else
            call patch_element(self%patches, self%patches%of(e), shape%mesh%conn, &
               & self%group(self%which(e))%element, element)
            point = unit_points(self, first, e)
            call fill_states(shape, e, element, node, point, table)
            associate (p => self%patches, of => self%patches%of(e))
               do i = p%start(of), p%start(of + 1) - 1
                  call name_points(p%member(i))
               end do
            end associate
         end if
      end associate

   contains

      subroutine name_points(member)
         integer, intent(in) :: member
         integer :: j

         associate (from => shape%memory%first(member))
            do j = from, shape%memory%first(member + 1) - 1
               table(1, j) = shape%mesh%element_label(member)
               table(2, j) = j - from + 1
            end do
         end associate
      end subroutine name_points
   end subroutine states_of_unit

   subroutine fill_states(shape, e, element, node, point, table)
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      type(element_type), intent(in) :: element    !! that of e, or of its patch
      integer, contiguous, intent(in) :: node(:)
      integer, intent(in) :: point(:)              !! (ngauss) columns
      real(wp), intent(inout) :: table(:, :)
      real(wp), dimension(element%ndim, element%nnode), target :: x, moved
      real(wp), allocatable, target :: past(:, :)
      real(wp) :: strain(6, element%ngauss), volume(element%ngauss), ratio(element%ngauss)
      real(wp) :: place(element%ngauss)
      type(element_input_type) :: input
      integer :: bad, k, m

      call fill_input(shape, e, node, x, moved, input)
      allocate (past, source=columns(shape%solids, shape%memory, e))
      input%memory => past
      call elastic_state(element, input, strain, volume, ratio, place, bad)
      m = element%nstress
      do k = 1, element%ngauss
         associate (row => table(:, point(k)), memory => shape%memory%value(:, point(k)))
            row(3:2 + element%ndim) = matmul(x + moved, element%n(:, k))
            row(6) = place(k)
            row(7:12) = strain(:, k)
            row(13) = volume(k)
            row(14) = ratio(k)
            row(15) = memory(strain_at(m))
            row(16) = memory(stress_at(m))
            row(17) = memory(work_at(m))
         end associate
      end do
   end subroutine fill_states

   !> The changes of volume that states of the start ask for, `memory%pressed`, less those that the
   !> elements have at rest: what is left is added to ln J of every point.
   subroutine settle_states(self, mesh, n, memory)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      integer, intent(in) :: n                 !! equations
      type(solids_state_type), intent(inout), target :: memory
      real(wp), allocatable, target :: u(:)
      real(wp), allocatable :: table(:, :)
      integer :: e, q

      if (.not. memory%scaled) return
      allocate (u(n), source=0.0_wp)
      do e = 1, mesh%nelement
         q = memory%first(e + 1) - 1
         if (q >= memory%first(e)) memory%value(offset_at(self%group(self%which(e)) &
            & %element%nstress), memory%first(e):q) = 0.0_wp
      end do
      call states_of_points(self, mesh, u, memory, table)
      memory%pressed = memory%pressed - table(13, :)
   end subroutine settle_states

   !> Elastic energy of the points that remember [force length].
   real(wp) function energy_of_memory(self, mesh, u, memory) result(energy)
      type(solids_type), intent(in), target :: self
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) displacements by equation [length]
      type(solids_state_type), intent(in), target :: memory
      real(wp), allocatable :: table(:, :)
      integer :: e, k

      call states_of_points(self, mesh, u, memory, table)
      energy = 0.0_wp
      do e = 1, mesh%nelement
         do k = memory%first(e), memory%first(e + 1) - 1
            associate (law => self%group(self%which(e))%law, row => table(:, k))
               energy = energy + row(6)*(1.0_wp + exp_minus_one(-row(14))) &
                  & *(0.5_wp*law%bulk*row(13)**2 + law%shear*(sum(row(7:9)**2) &
                  & + 2.0_wp*sum(row(10:12)**2)))
            end associate
         end do
      end do
   end function energy_of_memory

   !> Into the memory of one element at rest; `found` is false if it has no such point, or if its
   !> law remembers what such a state does not have.
   subroutine put_state(memory, solids, state, found)
      type(solids_state_type), intent(inout) :: memory
      type(solids_type), intent(in) :: solids
      type(initial_state_type), intent(in) :: state
      logical, intent(out) :: found
      real(wp) :: strain(3, 3), stress, slope, rate_slope
      integer :: p, q, k, r, m

      p = memory%first(state%element)
      q = memory%first(state%element + 1) - 1
      found = q >= p .and. state%point <= q - p + 1 .and. state%point >= 0
      if (.not. found) return
      if (state%point > 0) then
         p = p + state%point - 1
         q = p
      end if
      do r = 1, 6
         strain(first_axis(r), second_axis(r)) = state%strain(r)
         strain(second_axis(r), first_axis(r)) = state%strain(r)
      end do
      associate (group => solids%group(solids%which(state%element)))
         found = .not. (state%whole .and. (allocated(group%law%plastic) &
            & .or. group%law%kind /= finite_law%hencky))
         if (.not. found) return
         m = group%element%nstress
         do k = p, q
            stress = state%flow_stress
            if (.not. stress > 0.0_wp) call flow_stress(group%law%flow, state%plastic, 0.0_wp, &
               & stress, slope, rate_slope)
            memory%value(strain_at(m), k) = state%plastic
            memory%value(stress_at(m), k) = stress
            if (allocated(group%law%plastic)) memory%value(temperature_at(m) + 1, k) = stress
            if (.not. state%whole) cycle
            memory%value(work_at(m), k) = state%work
            memory%pressed(k) = state%volume
            if (memory%scaled) memory%value(size(memory%value, 1), k) = exp(-state%ratio)
            call set_elastic(memory%value(:, k), group, strain, memory%finite_strain)
         end do
      end associate
   end subroutine put_state
end module lopin_point_states
