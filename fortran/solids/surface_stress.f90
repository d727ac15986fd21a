!> What laws of friction read of the solids behind a few nodes, von Mises' stress and that of flow.
!>
!> Both are means of what the elements at a node extrapolate to it, as in lopin_nodal_mises. Only
!> elements, or patches of them, that have such a node are computed. Module surface_slopes has their
!> slopes.
module lopin_surface_stress
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_solids, only : solids_type, unit_nodes
   use lopin_solid_configuration, only : configuration_type
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : stress_at
   use lopin_recover_stress, only : recover_linear => recover_unit
   use lopin_recover_nonlinear, only : recover_unit, remember_unit
   use lopin_von_mises, only : von_mises
   implicit none
   private
   public :: surface_stress_type, new_surface_stress, find_stress
   public :: share_type, compute, read_unit, remembers, members_of

   !> The nodes that are read, the elements there, and what was read last.
   type :: surface_stress_type
      integer, allocatable :: node(:)          !! (nread) each once
      integer, allocatable :: place(:)         !! (nnode) its place in these; 0: it is none
      integer, allocatable :: unit(:)          !! elements, each that stands for its patch
      integer, allocatable :: share(:)         !! (nread) elements of the node
      logical :: flows = .false.               !! the stress of flow is read
      logical :: stressed = .false.            !! von Mises' is read
      real(wp), allocatable :: u(:, :)         !! (3, nnode) displacements [length]
      real(wp), allocatable :: stress(:, :)    !! (6, npoint) where an element has such a node
      real(wp), allocatable :: strain(:, :)    !! (6, npoint) the same
      real(wp), allocatable :: next(:, :)      !! memory of the points
      real(wp), allocatable :: at_node(:, :)   !! (6, nread) [stress]
      real(wp), allocatable :: flow(:)         !! (nread) sum over points that flow [stress]
      real(wp), allocatable :: weight(:)       !! (nread) their weights in it; 0: nothing flows
   end type surface_stress_type

   !> What an element or patch adds to the nodes that are read.
   type :: share_type
      integer, allocatable :: place(:)         !! each once
      real(wp), allocatable :: stress(:, :)    !! (6, place) [stress]
      real(wp), allocatable :: flow(:), weight(:)   !! (place)
   end type share_type

contains

   !> Who is read.
   subroutine new_surface_stress(self, solids, mesh, node, flows, stressed)
      type(surface_stress_type), intent(out) :: self
      type(solids_type), intent(in) :: solids
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node(:)           !! some may stand more than once
      logical, intent(in) :: flows             !! the stress of flow is read
      logical, intent(in) :: stressed          !! and von Mises'; else that is left 0
      logical :: reads(mesh%nelement)
      integer :: e, i, n

      allocate (self%place(mesh%nnode), source=0)
      n = 0
      do i = 1, size(node)
         if (self%place(node(i)) > 0) cycle
         n = n + 1
         self%place(node(i)) = n
      end do
      allocate (self%node(n), self%share(n), source=0)
      reads = .false.
      do i = 1, mesh%nnode
         if (self%place(i) > 0) self%node(self%place(i)) = i
      end do
      do e = 1, mesh%nelement
         if (solids%which(e) == 0) cycle
         associate (own => self%place(mesh%conn(:solids%group(solids%which(e))%element%nnode, e)))
            do i = 1, size(own)
               if (own(i) > 0) self%share(own(i)) = self%share(own(i)) + 1
            end do
            if (any(own > 0)) reads(first_of(solids, e)) = .true.
         end associate
      end do
      self%unit = pack([(e, e=1, mesh%nelement)], reads)
      self%flows = flows
      self%stressed = stressed
      n = solids%first_point(mesh%nelement + 1) - 1
      allocate (self%u(3, mesh%nnode), self%stress(6, n), self%strain(6, n), source=0.0_wp)
      allocate (self%at_node(6, size(self%node)), self%flow(size(self%node)), &
         & self%weight(size(self%node)))
   end subroutine new_surface_stress

   !> The element that stands for the patch of an element, or itself.
   pure integer function first_of(solids, e) result(first)
      type(solids_type), intent(in) :: solids
      integer, intent(in) :: e

      first = e
      associate (p => solids%patches)
         if (p%of(e) > 0) first = p%member(p%start(p%of(e)))
      end associate
   end function first_of

   !> Elements of a patch, or the one that is none.
   pure function members_of(solids, e) result(member)
      type(solids_type), intent(in) :: solids
      integer, intent(in) :: e                 !! one that stands for its patch
      integer, allocatable :: member(:)

      member = [e]
      associate (p => solids%patches)
         if (p%of(e) > 0) member = p%member(p%start(p%of(e)):p%start(p%of(e) + 1) - 1)
      end associate
   end function members_of

   !> The stresses of these displacements: von Mises', and that of flow, 0 where nothing flows.
   subroutine find_stress(self, solids, mesh, u, memory, mises, flow)
      type(surface_stress_type), intent(inout) :: self
      type(solids_type), intent(in), target :: solids
      type(mesh_type), intent(in), target :: mesh
      real(wp), contiguous, intent(in), target :: u(:)   !! (n) by equation [length]
      type(solids_state_type), intent(in), target :: memory   !! of the accepted state
      real(wp), intent(out) :: mises(:), flow(:)         !! (nread) [stress]
      type(configuration_type) :: shape
      type(share_type) :: own
      integer :: i, k

      shape = configuration_type(solids, mesh, u, memory)
      if (self%flows) self%next = memory%value
      do i = 1, mesh%nnode
         do k = 1, mesh%ndim
            if (solids%dof(k, i) > 0) self%u(k, i) = u(solids%dof(k, i))
         end do
      end do
      self%at_node = 0.0_wp
      self%flow = 0.0_wp
      self%weight = 0.0_wp
      do i = 1, size(self%unit)
         call compute(self, shape, self%unit(i))
         call read_unit(self, shape, self%unit(i), own)
         self%at_node(:, own%place) = self%at_node(:, own%place) + own%stress
         self%flow(own%place) = self%flow(own%place) + own%flow
         self%weight(own%place) = self%weight(own%place) + own%weight
      end do
      do i = 1, size(self%node)
         self%at_node(:, i) = self%at_node(:, i)/real(max(1, self%share(i)), wp)
         mises(i) = von_mises(self%at_node(:, i))
         flow(i) = 0.0_wp
         if (self%weight(i) > 0.0_wp) flow(i) = max(0.0_wp, self%flow(i)/self%weight(i))
      end do
   end subroutine find_stress

   !> Stresses at the points of an element or patch.
   subroutine compute(self, shape, e)
      type(surface_stress_type), intent(inout) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      real(wp) :: work, volume

      if (self%stressed .and. (shape%memory%finite_strain .or. shape%memory%in_use)) then
         call recover_unit(shape%solids, shape%mesh, self%u, shape%memory, e, self%stress, &
            & self%strain)
      else if (self%stressed) then
         call recover_linear(shape%solids, shape%mesh, self%u, e, self%stress, self%strain)
      end if
      if (.not. remembers(self, shape, e)) return
      associate (p => shape%memory%first(e), q => shape%memory%first(e + 1) - 1)
         self%next(:, p:q) = shape%memory%value(:, p:q)
      end associate
      call remember_unit(shape, e, self%next, work, volume)
   end subroutine compute

   pure logical function remembers(self, shape, e)
      type(surface_stress_type), intent(in) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      remembers = self%flows .and. shape%memory%in_use
      if (remembers) remembers = shape%memory%first(e + 1) > shape%memory%first(e)
   end function remembers

   !> What an element or patch says of its nodes.
   subroutine read_unit(self, shape, e, own)
      type(surface_stress_type), intent(in) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e
      type(share_type), intent(inout) :: own
      integer, allocatable :: member(:)
      real(wp) :: stress(6), flow, weight
      integer :: m, a, i

      own%place = self%place(unit_nodes(shape%solids, shape%mesh, e))
      own%place = pack(own%place, own%place > 0)
      own%flow = 0.0_wp*own%place
      own%weight = own%flow
      own%stress = spread(own%flow, 1, 6)
      allocate (member, source=members_of(shape%solids, e))
      do m = 1, size(member)
         do a = 1, shape%solids%group(shape%solids%which(member(m)))%element%nnode
            if (self%place(shape%mesh%conn(a, member(m))) == 0) cycle
            i = findloc(own%place, self%place(shape%mesh%conn(a, member(m))), 1)
            call extrapolate(self, shape, member(m), a, stress, flow, weight)
            own%stress(:, i) = own%stress(:, i) + stress
            own%flow(i) = own%flow(i) + flow
            own%weight(i) = own%weight(i) + weight
         end do
      end do
   end subroutine read_unit

   !> What an element says of one of its nodes.
   subroutine extrapolate(self, shape, e, a, stress, flow, weight)
      type(surface_stress_type), intent(in) :: self
      type(configuration_type), intent(in) :: shape
      integer, intent(in) :: e, a              !! element, its node
      real(wp), intent(out) :: stress(6), flow, weight
      integer :: p, q, k

      flow = 0.0_wp
      weight = 0.0_wp
      p = shape%solids%first_point(e)
      q = shape%solids%first_point(e + 1) - 1
      associate (at => shape%solids%group(shape%solids%which(e))%element%extrapolation(a, :))
         stress = 0.0_wp
         if (self%stressed) stress = matmul(self%stress(:, p:q), at)
         if (.not. remembers(self, shape, e)) return
         do k = 1, size(at)
            associate (now => self%next(stress_at(merge(4, 6, shape%mesh%ndim == 2)), &
               & shape%memory%first(e) + k - 1))
               if (.not. now > 0.0_wp) cycle
               flow = flow + at(k)*now
               weight = weight + at(k)
            end associate
         end do
      end associate
   end subroutine extrapolate
end module lopin_surface_stress
