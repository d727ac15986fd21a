!> The solid elements of a mesh: groups of one word and section, patches, colours, matrix slots.
!>
!> The slots of every element in the global matrix are found once. Elements are coloured so that no
!> two of a colour share a node, and each colour is shared out among the threads: every entry
!> receives its addends in the order of the colours, so the bits do not depend on the number of
!> threads.
module lopin_solids
   use lopin_kinds, only : wp, ik, lk
   use lopin_error, only : error_type, error_code, raise
   use lopin_mesh, only : mesh_type
   use lopin_shared_work, only : shared_work_type, share_out
   use lopin_csc, only : csc_type, storage
   use lopin_element_type, only : element_type, element_kind, element_formulation, &
      & new_element_type
   use lopin_model, only : spring_type
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix
   use lopin_flow_curve, only : flow_type
   use lopin_plastic_return, only : plastic_type
   use lopin_element_batch, only : is_batchable, lanes
   use lopin_hyperelastic, only : solid_law_type, hencky_law, green_law, neo_hooke_law, &
      & give_flow, elastic_constants
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_simplex_patches, only : patches_type, new_patches
   implicit none
   private
   public :: solids_type, solid_section_type, group_type, new_solids, unit_nodes, unit_points, &
      & add_slots, list_equations, set_slots

   !> What the elements of one section have in common.
   type :: solid_section_type
      character(len=4) :: formulation = ''   !! '' or 'FULL'
      real(wp) :: young = 0.0_wp             !! [stress]
      real(wp) :: poisson = 0.0_wp           !! [-]
      real(wp) :: thickness = 1.0_wp         !! plane kinds [length]
      logical :: neo_hooke = .false.         !! then c10 and d1 in the place of young and poisson
      real(wp) :: c10 = 0.0_wp               !! [stress]
      real(wp) :: d1 = 0.0_wp                !! [1/stress]
      type(flow_type) :: flow                !! of a plastic or viscous material
      type(plastic_type), allocatable :: plastic   !! yield surface of its own, or one that moves
      logical :: green = .false.             !! Hooke's law in Green's strain, not in logarithmic
      real(wp) :: expansion = 0.0_wp         !! thermal strain per degree [1/temperature]
      logical :: heated = .false.            !! temperatures or stresses of the start act on it
   end type solid_section_type

   !> Elements of one word in one section.
   type :: group_type
      integer :: etype = 0, section = 0
      type(element_type) :: element
      real(wp), allocatable :: d(:, :)       !! (nstress, nstress) Hooke [stress]
      type(solid_law_type) :: law           !! at finite strain
      real(wp) :: young = 0.0_wp, poisson = 0.0_wp   !! [stress], [-]
      real(wp) :: thickness = 1.0_wp
      logical :: patched = .false.           !! neighbours share their change of volume
      logical :: batched = .false.           !! several at a time; see module solid_batch
      real(wp) :: expansion = 0.0_wp         !! [1/temperature]
   end type group_type

   !> Poisson's ratio above which elements that lock in volume are averaged over patches, or have
   !> their change of volume projected.
   real(wp), parameter, public :: keeps_volume = 0.4_wp

   !> Tables of a mesh; disposable, and the same for every increment of small strains.
   type :: solids_type
      integer :: n = 0                     !! equations
      type(group_type), allocatable :: group(:)
      integer, allocatable :: which(:)     !! (nelement) group; 0: rigid, no stiffness
      integer, allocatable :: dof(:, :)    !! (6, nnode) equation of each dof, 0: none
      type(patches_type) :: patches        !! each is assembled with its first element
      integer, allocatable :: first_point(:) !! (nelement+1) first Gauss point of each element
      integer, allocatable :: colour_start(:) !! (ncolour+1) into `order`
      integer, allocatable :: order(:)     !! elements by colour
      integer, allocatable :: colour_batch(:) !! (ncolour+1) into `batch_start`
      integer, allocatable :: batch_start(:)  !! (nbatch+1) into `order`: of one group, or single
      logical :: last_is_serial = .false.  !! the last colour holds elements that may touch
      integer(lk), allocatable :: first_slot(:) !! (nelement+1), then one more for each spring
      type(spring_type), allocatable :: spring(:)   !! only if there are any
      integer(ik), allocatable :: slot(:)  !! lower triangle by columns; 0: none; < 0: twice
      type(facet_rule_type) :: rules(6)
   end type solids_type

   type, extends(shared_work_type) :: slots_work_type
      type(solids_type), pointer :: solids => null()
      type(csc_type), pointer :: matrix => null()
      integer, pointer :: start(:) => null(), equation(:) => null()   !! of list_equations
   contains
      procedure :: do_part => find_slots
   end type slots_work_type

contains

   !> Groups, colours, the pattern of the matrix (lower triangle, all physical dofs) and the slots.
   subroutine new_solids(self, mesh, word, section, dof, matrix, error)
      type(solids_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      character(len=*), intent(in) :: word(:)              !! element words, as mesh%etype counts
      type(solid_section_type), intent(in) :: section(:)   !! as mesh%section counts
      integer, intent(in) :: dof(:, :)                     !! (6, nnode) equations from 1; 0: none
      type(csc_type), intent(out) :: matrix                !! values are zero
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: start(:), equation(:)

      self%n = maxval(dof)
      self%dof = dof
      call new_facet_rules(self%rules)
      call set_groups(self, mesh, word, section, error)
      if (allocated(error)) return
      call set_patches(self, mesh)
      call set_colours(self, mesh)
      call set_batches(self)
      call list_equations(self, mesh, start, equation)
      call matrix%new_from_lists(self%n, storage%symmetric_lower, start, equation)
      call set_slots(self, matrix, start, equation)
   end subroutine new_solids

   subroutine set_groups(self, mesh, word, section, error)
      type(solids_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      character(len=*), intent(in) :: word(:)
      type(solid_section_type), intent(in) :: section(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: table(size(word), 0:size(section))
      integer :: e, t, s

      allocate (self%group(0), self%which(mesh%nelement), self%first_point(mesh%nelement + 1))
      self%which = 0
      self%first_point(1) = 1
      table = -1
      do e = 1, mesh%nelement
         t = mesh%etype(e)
         s = mesh%section(e)
         if (table(t, s) < 0) then
            table(t, s) = 0
            if (s > 0) call add_group(self, trim(word(t)), section(s), table(t, s), error)
            if (allocated(error)) return
         end if
         self%which(e) = table(t, s)
         self%first_point(e + 1) = self%first_point(e)
         if (table(t, s) > 0) self%first_point(e + 1) = self%first_point(e) &
            & + self%group(table(t, s))%element%ngauss
      end do
   end subroutine set_groups

   subroutine set_patches(self, mesh)
      type(solids_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer :: key(mesh%nelement), e, k

      key = 0
      do e = 1, mesh%nelement
         if (self%which(e) == 0) cycle
         if (self%group(self%which(e))%patched) key(e) = self%which(e)
      end do
      call new_patches(self%patches, mesh, key, [(self%group(k)%element%cell, k=1, &
         & size(self%group))])
   end subroutine set_patches

   !> Nodes of what is assembled with an element: its own, those of its patch, or none where another
   !> element of the patch stands for it.
   pure function unit_nodes(self, mesh, e) result(node)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      integer, allocatable :: node(:)
      integer :: p

      allocate (node(0))
      if (self%which(e) == 0) return
      p = self%patches%of(e)
      if (p == 0) then
         node = mesh%conn(:self%group(self%which(e))%element%nnode, e)
      else if (self%patches%member(self%patches%start(p)) == e) then
         node = self%patches%node(self%patches%first(p):self%patches%first(p + 1) - 1)
      end if
   end function unit_nodes

   !> `first`, where the Gauss points of an element begin in a table, for every point of its patch.
   pure function unit_points(self, first, e) result(point)
      type(solids_type), intent(in) :: self
      integer, intent(in) :: first(:)        !! (nelement+1)
      integer, intent(in) :: e               !! first element of a patch
      integer, allocatable :: point(:)
      integer :: k, i

      associate (p => self%patches)
         point = [((k, k=first(p%member(i)), first(p%member(i) + 1) - 1), &
            & i=p%start(p%of(e)), p%start(p%of(e) + 1) - 1)]
      end associate
   end function unit_points

   !> `number` stays 0 for rigid words.
   subroutine add_group(self, word, section, number, error)
      type(solids_type), intent(inout) :: self
      character(len=*), intent(in) :: word
      type(solid_section_type), intent(in) :: section
      integer, intent(inout) :: number
      type(error_type), allocatable, intent(out) :: error
      type(group_type) :: new
      real(wp) :: young, poisson
      logical :: found

      call new_element_type(new%element, word, trim(section%formulation), found)
      if (.not. found) then
         call raise(error, error_code%deck, 'E0205', &
            & "'"//word//"' is not an element that Lopin knows")
         return
      end if
      if (new%element%kind == element_kind%rigid) return
      new%thickness = section%thickness
      young = section%young
      poisson = section%poisson
      if (section%neo_hooke) then
         new%law = neo_hooke_law(section%c10, section%d1)
         call elastic_constants(new%law, young, poisson)
      else if (section%green) then
         new%law = green_law(young, poisson)
      else
         new%law = hencky_law(young, poisson)
         call give_flow(new%law, section%flow)
         if (allocated(section%plastic)) allocate (new%law%plastic, source=section%plastic)
      end if
      new%law%remembers = new%law%flows .or. section%heated
      new%expansion = section%expansion
      new%young = young
      new%poisson = poisson
      if (poisson > keeps_volume .or. new%law%flows) then
         new%patched = new%element%patched
         if (new%element%projectable) new%element%formulation = element_formulation%projected
      end if
      new%batched = is_batchable(new%element, new%law) .and. .not. new%patched
      allocate (new%d(new%element%nstress, new%element%nstress))
      if (new%element%kind == element_kind%plane_stress) then
         call plane_stress_matrix(young, poisson, new%d)
      else
         call hooke_matrix(young, poisson, new%d)
      end if
      self%group = [self%group, new]
      number = size(self%group)
   end subroutine add_group

   !> Greedy: the first of 63 colours that no neighbour has; what finds none is left to one thread.
   subroutine set_colours(self, mesh)
      type(solids_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer, parameter :: most = 63
      integer(lk) :: taken(mesh%nnode), near
      integer :: colour(mesh%nelement), fill(0:most + 1)
      integer, allocatable :: node(:)
      integer :: e, a, c, ncolour

      taken = 0
      colour = 0
      fill = 0
      do e = 1, mesh%nelement
         node = unit_nodes(self, mesh, e)
         if (size(node) == 0) cycle
         near = 0
         do a = 1, size(node)
            near = ior(near, taken(node(a)))
         end do
         c = trailz(not(near)) + 1
         colour(e) = min(c, most + 1)
         fill(colour(e)) = fill(colour(e)) + 1
         if (c > most) cycle
         do a = 1, size(node)
            taken(node(a)) = ibset(taken(node(a)), c - 1)
         end do
      end do
      self%last_is_serial = fill(most + 1) > 0
      ncolour = maxval(colour)
      allocate (self%colour_start(ncolour + 1), self%order(sum(fill)))
      self%colour_start(1) = 1
      do c = 1, ncolour
         self%colour_start(c + 1) = self%colour_start(c) + fill(c)
      end do
      fill(1:ncolour) = self%colour_start(1:ncolour)
      do e = 1, mesh%nelement
         c = colour(e)
         if (c == 0) cycle
         self%order(fill(c)) = e
         fill(c) = fill(c) + 1
      end do
   end subroutine set_colours

   !> Runs of elements of one colour and group that may be computed at a time.
   subroutine set_batches(self)
      type(solids_type), intent(inout) :: self
      integer :: start(size(self%order) + 1), c, g, k, n, last

      allocate (self%colour_batch(size(self%colour_start)))
      n = 1
      start(1) = 1
      self%colour_batch(1) = 1
      do c = 1, size(self%colour_start) - 1
         do while (start(n) < self%colour_start(c + 1))
            k = start(n)
            g = self%which(self%order(k))
            last = k
            if (self%group(g)%batched) last = min(k + lanes, self%colour_start(c + 1)) - 1
            do k = k + 1, last
               if (self%which(self%order(k)) /= g) exit
            end do
            n = n + 1
            start(n) = k
         end do
         self%colour_batch(c + 1) = n
      end do
      self%batch_start = start(:n)
   end subroutine set_batches

   !> Equations of all elements, one behind the other; element e is equation(start(e):start(e+1)-1).
   subroutine list_equations(self, mesh, start, equation)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, allocatable, intent(out) :: start(:), equation(:)
      integer, allocatable :: node(:)
      integer :: e, d

      allocate (start(mesh%nelement + 1))
      start(1) = 1
      do e = 1, mesh%nelement
         start(e + 1) = start(e)
         if (self%which(e) > 0) start(e + 1) = start(e) &
            & + size(unit_nodes(self, mesh, e))*self%group(self%which(e))%element%ndim
      end do
      allocate (equation(start(mesh%nelement + 1) - 1))
      do e = 1, mesh%nelement
         if (self%which(e) == 0) cycle
         node = unit_nodes(self, mesh, e)
         d = self%group(self%which(e))%element%ndim
         equation(start(e):start(e + 1) - 1) = reshape(self%dof(:d, node), [size(node)*d])
      end do
   end subroutine list_equations

   subroutine set_slots(self, matrix, start, equation)
      type(solids_type), intent(inout), target :: self
      type(csc_type), intent(in), target :: matrix
      integer, intent(in), target :: start(:), equation(:)
      type(slots_work_type) :: work
      integer :: e, m, nelement

      nelement = size(start) - 1
      allocate (self%first_slot(nelement + 1))
      self%first_slot(1) = 1
      do e = 1, nelement
         m = start(e + 1) - start(e)
         self%first_slot(e + 1) = self%first_slot(e) + (int(m, lk)*(m + 1))/2
      end do
      allocate (self%slot(self%first_slot(nelement + 1) - 1))
      work%solids => self
      work%matrix => matrix
      work%start => start
      work%equation => equation
      call share_out(work, [1, nelement + 1])
   end subroutine set_slots

   subroutine find_slots(self, k)
      class(slots_work_type), intent(inout) :: self
      integer, intent(in) :: k             !! the element
      integer :: i, j
      integer(lk) :: m

      m = self%solids%first_slot(k)
      associate (equation => self%equation, slot => self%solids%slot, last => self%start(k + 1) - 1)
         do j = self%start(k), last
            do i = j, last
               slot(m) = 0
               if (min(equation(i), equation(j)) > 0) slot(m) = self%matrix%slot(equation(i), &
                  & equation(j))
               ! A node named twice by a collapsed element: both entries fall on the diagonal.
               if (i /= j .and. equation(i) == equation(j)) slot(m) = -slot(m)
               m = m + 1
            end do
         end do
      end associate
   end subroutine find_slots

   !> Add the lower triangle of an element matrix to its slots in the values of a matrix.
   pure subroutine add_slots(slot, ke, value)
      integer(ik), contiguous, intent(in) :: slot(:)
      real(wp), contiguous, intent(in) :: ke(:, :)
      real(wp), intent(inout) :: value(:)
      integer :: i, j, k

      k = 0
      do j = 1, size(ke, 1)
         do i = j, size(ke, 1)
            k = k + 1
            if (slot(k) > 0) then
               value(slot(k)) = value(slot(k)) + ke(i, j)
            else if (slot(k) < 0) then
               value(-slot(k)) = value(-slot(k)) + 2.0_wp*ke(i, j)
            end if
         end do
      end do
   end subroutine add_slots
end module lopin_solids
