!> Patches of linear triangles, tetrahedra and wedges that share one change of volume.
!>
!> One linear simplex has one volume and as good as no freedom left once that is kept: a mesh of
!> them locks where the material keeps its volume. A patch of neighbours has the freedom of a quad
!> or a brick. The mean dilatation of its members makes it an element like any other (Q1P0 on
!> several cells; the energy form of the F-bar patches of de Souza Neto, Andrade Pires and Owen
!> 2005): the tangent is symmetric and no unknown is added.
!>
!> Patches grow over shared faces from the elements with the fewest free neighbours, taking first
!> what is enclosed already; remnants join a neighbour. The result depends on the mesh alone.
module lopin_simplex_patches
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_cells, only : cell_type, cell_family
   use lopin_element_type, only : element_type, element_formulation
   implicit none
   private
   public :: patches_type, new_patches, patch_element

   integer, parameter :: most_faces = 5

   type :: patches_type
      integer :: n = 0
      integer, allocatable :: of(:)        !! (nelement) patch of an element; 0: none
      integer, allocatable :: start(:)     !! (n+1) into `member`
      integer, allocatable :: member(:)    !! elements, ascending within a patch
      integer, allocatable :: first(:)     !! (n+1) into `node`
      integer, allocatable :: node(:)      !! nodes of a patch, each once
   end type patches_type

contains

   !> Elements of equal key > 0 may share a patch.
   subroutine new_patches(self, mesh, key, cell)
      type(patches_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: key(:)             !! (nelement) 0: stays alone
      type(cell_type), intent(in) :: cell(:)    !! of each key
      integer, allocatable :: near(:, :)

      allocate (self%of(mesh%nelement), source=0)
      if (any(key > 0)) then
         call find_neighbours(mesh, key, cell, near)
         call grow_all(self, mesh, key, cell, near)
         call join_remnants(self, key, cell, near)
      end if
      call list_members(self)
      call list_nodes(self, mesh, key, cell)
   end subroutine new_patches

   !> Members of a patch that is just right, and the least number of a patch that stays.
   pure integer function wanted(family)
      integer, intent(in) :: family
      wanted = merge(8, 2, family == cell_family%tetra)
   end function wanted

   pure integer function least(family)
      integer, intent(in) :: family
      least = merge(5, 2, family == cell_family%tetra)
   end function least

   !> Element of equal key behind each face; 0: none.
   subroutine find_neighbours(mesh, key, cell, near)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: key(:)
      type(cell_type), intent(in) :: cell(:)
      integer, allocatable, intent(out) :: near(:, :)   !! (most_faces, nelement)
      integer, allocatable :: start(:), list(:)
      integer :: e, f, k, m, other, face(4)

      call elements_of_nodes(mesh, key, cell, start, list)
      allocate (near(most_faces, mesh%nelement), source=0)
      do e = 1, mesh%nelement
         if (key(e) == 0) cycle
         associate (own => cell(key(e)))
            do f = 1, own%nface
               m = own%face_nnode(f)
               face(:m) = mesh%conn(own%face_node(:m, f), e)
               do k = start(face(1)), start(face(1) + 1) - 1
                  other = list(k)
                  if (other == e .or. key(other) /= key(e)) cycle
                  if (shared(face(:m), mesh%conn(:own%nnode, other)) < m) cycle
                  near(f, e) = other
                  exit
               end do
            end do
         end associate
      end do
   end subroutine find_neighbours

   pure integer function shared(a, b)
      integer, intent(in) :: a(:), b(:)
      integer :: i
      shared = 0
      do i = 1, size(a)
         if (any(b == a(i))) shared = shared + 1
      end do
   end function shared

   subroutine elements_of_nodes(mesh, key, cell, start, list)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: key(:)
      type(cell_type), intent(in) :: cell(:)
      integer, allocatable, intent(out) :: start(:), list(:)
      integer, allocatable :: fill(:)
      integer :: a, e, node

      allocate (start(mesh%nnode + 1), source=0)
      do e = 1, mesh%nelement
         if (key(e) == 0) cycle
         do a = 1, cell(key(e))%nnode
            start(mesh%conn(a, e) + 1) = start(mesh%conn(a, e) + 1) + 1
         end do
      end do
      start(1) = 1
      do node = 1, mesh%nnode
         start(node + 1) = start(node + 1) + start(node)
      end do
      allocate (list(start(mesh%nnode + 1) - 1), fill(mesh%nnode))
      fill = start(:mesh%nnode)
      do e = 1, mesh%nelement
         if (key(e) == 0) cycle
         do a = 1, cell(key(e))%nnode
            node = mesh%conn(a, e)
            list(fill(node)) = e
            fill(node) = fill(node) + 1
         end do
      end do
   end subroutine elements_of_nodes

   !> Seeds by the number of free neighbours, fewest first: a list per number, with stale entries.
   subroutine grow_all(self, mesh, key, cell, near)
      type(patches_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: key(:), near(:, :)
      type(cell_type), intent(in) :: cell(:)
      integer, allocatable :: head(:), next(:), entry(:), free(:)
      integer :: e, level, used

      allocate (head(0:most_faces), source=0)
      allocate (free(size(key)), source=0)
      allocate (next((most_faces + 1)*size(key)), entry((most_faces + 1)*size(key)))
      used = 0
      do e = size(key), 1, -1
         if (key(e) == 0) cycle
         free(e) = count(near(:, e) > 0)
         call push(e)
      end do
      level = 0
      do while (level <= most_faces)
         if (head(level) == 0) then
            level = level + 1
            cycle
         end if
         e = entry(head(level))
         head(level) = next(head(level))
         if (self%of(e) > 0 .or. free(e) /= level) cycle
         call grow(e)
         level = 0
      end do

   contains

      subroutine push(e)
         integer, intent(in) :: e
         used = used + 1
         entry(used) = e
         next(used) = head(free(e))
         head(free(e)) = used
      end subroutine push

      subroutine grow(seed)
         integer, intent(in) :: seed
         integer :: member(8), n, best

         self%n = self%n + 1
         n = 0
         best = seed
         do while (best > 0)
            n = n + 1
            member(n) = best
            call take(best)
            if (n == wanted(cell(key(seed))%family)) exit
            best = next_of(member(:n))
         end do
      end subroutine grow

      subroutine take(e)
         integer, intent(in) :: e
         integer :: f, other

         self%of(e) = self%n
         do f = 1, most_faces
            other = near(f, e)
            if (other == 0) cycle
            free(other) = free(other) - 1
            if (self%of(other) == 0) call push(other)
         end do
      end subroutine take

      !> The free neighbour with most faces, then most nodes, in the patch; then with fewest free
      !> neighbours of its own.
      integer function next_of(member) result(best)
         integer, intent(in) :: member(:)
         integer :: i, f, a, other, rank, highest, inside

         best = 0
         highest = -1
         do i = 1, size(member)
            do f = 1, most_faces
               other = near(f, member(i))
               if (other == 0) cycle
               if (self%of(other) > 0) cycle
               inside = 0
               do a = 1, cell(key(other))%nnode
                  if (is_in(mesh%conn(a, other), member)) inside = inside + 1
               end do
               rank = 100*count(near(:, other) > 0 .and. [(among(near(a, other), member), &
                  & a=1, most_faces)]) + 10*inside + most_faces - free(other)
               if (rank < highest .or. (rank == highest .and. other > best)) cycle
               highest = rank
               best = other
            end do
         end do
      end function next_of

      pure logical function among(e, member)
         integer, intent(in) :: e, member(:)
         among = any(member == e)
      end function among

      logical function is_in(node, member)
         integer, intent(in) :: node, member(:)
         integer :: i
         is_in = .true.
         do i = 1, size(member)
            if (any(mesh%conn(:cell(key(member(i)))%nnode, member(i)) == node)) return
         end do
         is_in = .false.
      end function is_in
   end subroutine grow_all

   !> Elements of patches that stayed too small join the smallest patch beside them.
   subroutine join_remnants(self, key, cell, near)
      type(patches_type), intent(inout) :: self
      integer, intent(in) :: key(:), near(:, :)
      type(cell_type), intent(in) :: cell(:)
      integer, allocatable :: number(:)
      logical, allocatable :: small(:)
      integer :: e, best, sweep

      allocate (number(self%n), source=0)
      allocate (small(self%n), source=.false.)
      do e = 1, size(key)
         if (key(e) > 0) number(self%of(e)) = number(self%of(e)) + 1
      end do
      do e = 1, size(key)
         if (key(e) > 0) small(self%of(e)) = number(self%of(e)) < least(cell(key(e))%family)
      end do
      do sweep = 1, 4
         do e = 1, size(key)
            if (key(e) == 0) cycle
            if (.not. small(self%of(e))) cycle
            best = smallest_of(near(:, e))
            if (best == 0) cycle
            number(self%of(e)) = number(self%of(e)) - 1
            self%of(e) = best
            number(best) = number(best) + 1
         end do
      end do
      call renumber(self)

   contains

      !> The smallest patch of these elements that is large enough; 0: none.
      pure integer function smallest_of(beside) result(best)
         integer, intent(in) :: beside(:)
         integer :: f

         best = 0
         do f = 1, most_faces
            if (beside(f) == 0) cycle
            associate (other => self%of(beside(f)))
               if (small(other)) cycle
               if (best > 0) then
                  if (number(other) >= number(best)) cycle
               end if
               best = other
            end associate
         end do
      end function smallest_of
   end subroutine join_remnants

   !> Numbers without gaps, in the order of the first element.
   pure subroutine renumber(self)
      type(patches_type), intent(inout) :: self
      integer :: new(self%n), e

      new = 0
      self%n = 0
      do e = 1, size(self%of)
         if (self%of(e) == 0) cycle
         if (new(self%of(e)) == 0) then
            self%n = self%n + 1
            new(self%of(e)) = self%n
         end if
         self%of(e) = new(self%of(e))
      end do
   end subroutine renumber

   pure subroutine list_members(self)
      type(patches_type), intent(inout) :: self
      integer :: fill(self%n), e, p

      allocate (self%start(self%n + 1), source=0)
      do e = 1, size(self%of)
         if (self%of(e) > 0) self%start(self%of(e) + 1) = self%start(self%of(e) + 1) + 1
      end do
      self%start(1) = 1
      do p = 1, self%n
         self%start(p + 1) = self%start(p + 1) + self%start(p)
      end do
      fill = self%start(:self%n)
      allocate (self%member(self%start(self%n + 1) - 1))
      do e = 1, size(self%of)
         p = self%of(e)
         if (p == 0) cycle
         self%member(fill(p)) = e
         fill(p) = fill(p) + 1
      end do
   end subroutine list_members

   pure subroutine list_nodes(self, mesh, key, cell)
      type(patches_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: key(:)
      type(cell_type), intent(in) :: cell(:)
      integer, allocatable :: node(:)
      integer :: a, e, k, n, p

      allocate (self%first(self%n + 1))
      allocate (node(8*size(self%member)))
      n = 0
      do p = 1, self%n
         self%first(p) = n + 1
         do k = self%start(p), self%start(p + 1) - 1
            e = self%member(k)
            do a = 1, cell(key(e))%nnode
               if (any(node(self%first(p):n) == mesh%conn(a, e))) cycle
               n = n + 1
               node(n) = mesh%conn(a, e)
            end do
         end do
      end do
      self%first(self%n + 1) = n + 1
      self%node = node(:n)
   end subroutine list_nodes

   !> A patch as one element: the points of its members, on its nodes.
   pure subroutine patch_element(self, p, conn, single, element)
      type(patches_type), intent(in) :: self
      integer, intent(in) :: p                     !! the patch
      integer, intent(in) :: conn(:, :)            !! of the mesh
      type(element_type), intent(in) :: single     !! of a member
      type(element_type), intent(out) :: element
      integer :: a, at, i, k, n

      associate (member => self%member(self%start(p):self%start(p + 1) - 1), &
         & node => self%node(self%first(p):self%first(p + 1) - 1))
         n = size(member)*single%ngauss
         element%word = single%word
         element%cell = single%cell
         element%kind = single%kind
         element%formulation = element_formulation%bbar
         element%axisymmetric = single%axisymmetric
         element%ndim = single%ndim
         element%nnode = size(node)
         element%ndof = element%ndim*element%nnode
         element%nstress = single%nstress
         element%ngauss = n
         allocate (element%weight(n), element%n(element%nnode, n))
         allocate (element%dn(element%ndim, element%nnode, n))
         element%n = 0.0_wp
         element%dn = 0.0_wp
         do i = 1, size(member)
            k = (i - 1)*single%ngauss
            element%weight(k + 1:k + single%ngauss) = single%weight
            do a = 1, single%nnode
               at = findloc(node, conn(a, member(i)), dim=1)
               element%n(at, k + 1:k + single%ngauss) = element%n(at, k + 1:k + single%ngauss) &
                  & + single%n(a, :)
               element%dn(:, at, k + 1:k + single%ngauss) = &
                  & element%dn(:, at, k + 1:k + single%ngauss) + single%dn(:, a, :)
            end do
         end do
      end associate
   end subroutine patch_element
end module lopin_simplex_patches
