!> Assembly of small-strain solids: stiffness and loads of a whole mesh.
!>
!> The slots of every element in the global matrix are found once. Elements are coloured so that no
!> two of a colour share a node, and each colour is shared out among the threads: every entry
!> receives its addends in the order of the colours, so the bits do not depend on the number of
!> threads.
module lopin_assemble_solids
   use lopin_kinds, only : wp, ik, lk
   use lopin_error, only : error_type, error_code, raise
   use lopin_mesh, only : mesh_type
   use lopin_csc, only : csc_type, storage
   use lopin_element_type, only : element_type, element_kind, element_formulation, &
      & new_element_type
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix
   use lopin_flow_curve, only : flow_type
   use lopin_finite_elastic, only : finite_law_type, hencky_law, green_law, neo_hooke_law, &
      & give_flow, elastic_constants
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_simplex_patches, only : patches_type, new_patches, patch_element
   use lopin_solid_small, only : stiffness, strain_matrices, body_force, face_force
   implicit none
   private
   public :: solids_type, solid_section_type, group_type, new_solids, assemble_stiffness
   public :: add_body_loads, add_face_loads, add_slots, unit_nodes, unit_points

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
      logical :: green = .false.             !! Hooke's law in Green's strain, not in logarithmic
      real(wp) :: expansion = 0.0_wp         !! thermal strain per degree [1/temperature]
      logical :: heated = .false.            !! temperatures or stresses of the start act on it
   end type solid_section_type

   !> Elements of one word in one section.
   type :: group_type
      integer :: etype = 0, section = 0
      type(element_type) :: element
      real(wp), allocatable :: d(:, :)       !! (nstress, nstress) Hooke [stress]
      type(finite_law_type) :: law           !! at finite strain
      real(wp) :: poisson = 0.0_wp
      real(wp) :: thickness = 1.0_wp
      logical :: patched = .false.           !! neighbours share their change of volume
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
      logical :: last_is_serial = .false.  !! the last colour holds elements that may touch
      integer(lk), allocatable :: first_slot(:) !! (nelement+1)
      integer(ik), allocatable :: slot(:)  !! lower triangle by columns; 0: none; < 0: twice
      type(facet_rule_type) :: rules(6)
   end type solids_type

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
      end if
      new%law%remembers = new%law%flows .or. section%heated
      new%expansion = section%expansion
      new%poisson = poisson
      if (poisson > keeps_volume .or. new%law%flows) then
         new%patched = new%element%patched
         if (new%element%projectable) new%element%formulation = element_formulation%projected
      end if
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
      type(solids_type), intent(inout) :: self
      type(csc_type), intent(in) :: matrix
      integer, intent(in) :: start(:), equation(:)
      integer :: e, i, j, m, nelement
      integer(lk) :: k

      nelement = size(start) - 1
      allocate (self%first_slot(nelement + 1))
      self%first_slot(1) = 1
      do e = 1, nelement
         m = start(e + 1) - start(e)
         self%first_slot(e + 1) = self%first_slot(e) + (int(m, lk)*(m + 1))/2
      end do
      allocate (self%slot(self%first_slot(nelement + 1) - 1))
      !$omp parallel do schedule(static) private(i, j, k)
      do e = 1, nelement
         k = self%first_slot(e)
         do j = start(e), start(e + 1) - 1
            do i = j, start(e + 1) - 1
               self%slot(k) = 0
               if (min(equation(i), equation(j)) > 0) self%slot(k) = &
                  & matrix%slot(equation(i), equation(j))
               ! A node named twice by a collapsed element: both entries fall on the diagonal.
               if (i /= j .and. equation(i) == equation(j)) self%slot(k) = -self%slot(k)
               k = k + 1
            end do
         end do
      end do
      !$omp end parallel do
   end subroutine set_slots

   !> Stiffness of all solid elements into a matrix made by `new_solids`; its values are replaced.
   subroutine assemble_stiffness(self, mesh, matrix, error)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(csc_type), intent(inout) :: matrix
      type(error_type), allocatable, intent(out) :: error
      integer :: c, k, e, folded, ncolour
      logical :: shared_out

      ncolour = size(self%colour_start) - 1
      folded = huge(1)
      matrix%value = 0.0_wp
      do c = 1, ncolour
         shared_out = .not. (self%last_is_serial .and. c == ncolour)
         !$omp parallel do schedule(static) private(e) reduction(min:folded) if(shared_out)
         do k = self%colour_start(c), self%colour_start(c + 1) - 1
            e = self%order(k)
            call add_unit(self, mesh, e, matrix%value, folded)
         end do
         !$omp end parallel do
      end do
      if (folded < huge(1)) call report_folded(self, mesh, folded, error)
   end subroutine assemble_stiffness

   subroutine add_unit(self, mesh, e, value, folded)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(wp), intent(inout) :: value(:)
      integer, intent(inout) :: folded      !! least element with det J <= 0, or first of its patch
      type(element_type) :: element

      associate (group => self%group(self%which(e)), &
         & slot => self%slot(self%first_slot(e):self%first_slot(e + 1) - 1))
         if (self%patches%of(e) == 0) then
            call add_element(group, group%element, mesh%x(:, mesh%conn(:group%element%nnode, e)), &
               & slot, e, value, folded)
         else
            call patch_element(self%patches, self%patches%of(e), mesh%conn, group%element, element)
            call add_element(group, element, mesh%x(:, unit_nodes(self, mesh, e)), slot, e, value, &
               & folded)
         end if
      end associate
   end subroutine add_unit

   subroutine add_element(group, element, x, slot, e, value, folded)
      type(group_type), intent(in) :: group
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: e
      integer(ik), intent(in) :: slot(:)
      real(wp), intent(inout) :: value(:)
      integer, intent(inout) :: folded
      real(wp) :: ke(element%ndof, element%ndof), smallest
      integer :: point

      call stiffness(element, x, group%thickness, group%d, ke, smallest, point)
      if (smallest <= 0.0_wp) then
         folded = min(folded, e)
         return
      end if
      call add_slots(slot, ke, value)
   end subroutine add_element

   !> Add the lower triangle of an element matrix to its slots in the values of a matrix.
   pure subroutine add_slots(slot, ke, value)
      integer(ik), intent(in) :: slot(:)
      real(wp), intent(in) :: ke(:, :)
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

   !> One error that names the first folded element, its worst point and how many others there are.
   subroutine report_folded(self, mesh, first, error)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: first      !! none before it is folded
      type(error_type), allocatable, intent(out) :: error
      character(len=160) :: text
      character(len=:), allocatable :: help
      real(wp) :: smallest, worst
      integer :: e, point, at, number, named

      number = 0
      worst = 0.0_wp
      at = 1
      named = first
      do e = first, mesh%nelement
         if (self%which(e) == 0) cycle
         call jacobian_of(self%group(self%which(e)), mesh%x, mesh%conn(:, e), smallest, point)
         if (smallest > 0.0_wp) cycle
         number = number + 1
         if (number > 1) cycle
         named = e
         worst = smallest
         at = point
      end do
      write (text, '(a,i0,3a,i0,a,es10.3)') 'element ', mesh%element_label(named), ' (', &
         & trim(self%group(self%which(named))%element%word), ') is folded: at integration point ', &
         & at, ' the Jacobian is ', worst
      help = 'list its nodes in the order of the element: counter-clockwise in the plane, nodes' &
         & //' of the first face before those of the second in space'
      if (number > 1) then
         write (text(len_trim(text) + 1:), '(a,i0)') '; folded elements in all: ', number
      end if
      call raise(error, error_code%deck, 'E0302', trim(text), help=help)
   end subroutine report_folded

   subroutine jacobian_of(group, x, conn, smallest, point)
      type(group_type), intent(in) :: group
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: conn(:)
      real(wp), intent(out) :: smallest
      integer, intent(out) :: point
      real(wp) :: b(group%element%ndof, group%element%nstress, group%element%ngauss)
      real(wp) :: volume(group%element%ngauss)
      call strain_matrices(group%element, x(:, conn(:group%element%nnode)), group%thickness, b, &
         & volume, smallest, point)
   end subroutine jacobian_of

   !> Add the consistent forces of uniform body forces to a vector of equations.
   subroutine add_body_loads(self, mesh, element, density, force)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element(:)       !! (nload) element indices
      real(wp), intent(in) :: density(:, :)   !! (>= ndim, nload) [force/length^3]
      real(wp), intent(inout) :: force(:)     !! (n) [force]
      integer :: k, e

      do k = 1, size(element)
         e = element(k)
         if (self%which(e) > 0) call add_one(self%group(self%which(e)), mesh%conn(:, e), &
            & density(:, k))
      end do

   contains

      subroutine add_one(group, conn, density)
         type(group_type), intent(in) :: group
         integer, intent(in) :: conn(:)
         real(wp), intent(in) :: density(:)
         real(wp) :: b(group%element%ndof, group%element%nstress, group%element%ngauss)
         real(wp) :: volume(group%element%ngauss), smallest
         real(wp) :: own(group%element%ndim, group%element%nnode)
         integer :: point
         call strain_matrices(group%element, mesh%x(:, conn(:group%element%nnode)), &
            & group%thickness, b, volume, smallest, point)
         if (smallest <= 0.0_wp) return
         call body_force(group%element, volume, density, own)
         call scatter(self%dof, conn, own, force)
      end subroutine add_one
   end subroutine add_body_loads

   !> Add the consistent forces of pressures and tractions on faces to a vector of equations.
   subroutine add_face_loads(self, mesh, element, face, pressure, traction, force)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element(:), face(:)   !! (nload) element indices, Abaqus face numbers
      real(wp), intent(in) :: pressure(:)          !! (nload) > 0 pushes into the element [stress]
      real(wp), intent(in) :: traction(:, :)  !! (>= ndim, nload) added to the pressure [stress]
      real(wp), intent(inout) :: force(:)          !! (n) [force]
      integer :: k, e

      do k = 1, size(element)
         e = element(k)
         if (self%which(e) > 0) call add_one(self%group(self%which(e)), mesh%conn(:, e), k)
      end do

   contains

      subroutine add_one(group, conn, k)
         type(group_type), intent(in) :: group
         integer, intent(in) :: conn(:), k
         real(wp) :: own(group%element%ndim, group%element%nnode)
         call face_force(group%element, self%rules, face(k), &
            & mesh%x(:, conn(:group%element%nnode)), group%thickness, pressure(k), &
            & traction(:, k), own)
         call scatter(self%dof, conn, own, force)
      end subroutine add_one
   end subroutine add_face_loads

   pure subroutine scatter(dof, conn, own, force)
      integer, intent(in) :: dof(:, :), conn(:)
      real(wp), intent(in) :: own(:, :)       !! (ndim, nnode of the element)
      real(wp), intent(inout) :: force(:)
      integer :: a, i, equation

      do a = 1, size(own, 2)
         do i = 1, size(own, 1)
            equation = dof(i, conn(a))
            if (equation > 0) force(equation) = force(equation) + own(i, a)
         end do
      end do
   end subroutine scatter
end module lopin_assemble_solids
