!> A mesh in space that is the same at every height along one axis: columns of nodes and stacks of
!> elements.
!>
!> Elements are prisms along the axis, from one level to the next. Nodes of an element that stand
!> over each other are of one column, and so on through the elements that share them; elements on
!> the same columns are a stack, which has one element of one kind at each level.
module lopin_extrusion
   use lopin_kinds, only : wp
   use lopin_sorting, only : sort
   use lopin_cells, only : cell_type, face_of_nodes
   use lopin_mesh, only : mesh_type, max_nodes_per_element
   implicit none
   private
   public :: extrusion_type, new_extrusion, face_in_base

   type :: extrusion_type
      logical :: found = .false.
      integer :: axis = 0                      !! 1, 2, 3
      integer :: levels = 0                    !! of elements over each other
      real(wp) :: near = 0.0_wp                !! nearer is the same place [length]
      real(wp) :: ends(2) = 0.0_wp             !! along the axis [length]
      integer, allocatable :: column(:)        !! (nnode) one node for all of a column
      integer, allocatable :: base(:)          !! (nelement) lowest of the stack; 0: not of the part
   end type extrusion_type

   real(wp), parameter :: same_place = 1.0e-6_wp
   !> A mesh of more levels is not looked at.
   integer, parameter :: most_levels = 200

contains

   !> The stacks of some elements; `found` is false where they are none.
   subroutine new_extrusion(self, mesh, axis, made_of, part)
      type(extrusion_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: axis
      integer, intent(in) :: made_of(:)        !! (nelement) equal where sections are alike
      logical, intent(in) :: part(:)           !! (nelement)
      real(wp) :: span(2, mesh%nelement)
      integer, allocatable :: key(:, :)
      integer :: e
      logical :: fits

      if (.not. any(part)) return
      self%axis = axis
      self%near = same_place*maxval(maxval(mesh%x, dim=2) - minval(mesh%x, dim=2))
      span = 0.0_wp
      do e = 1, mesh%nelement
         if (.not. part(e)) cycle
         associate (node => pack(mesh%conn(:, e), mesh%conn(:, e) > 0))
            span(:, e) = [minval(mesh%x(axis, node)), maxval(mesh%x(axis, node))]
         end associate
      end do
      self%ends = [minval(span(1, :), mask=part), maxval(span(2, :), mask=part)]
      call link_columns(self, mesh, part)
      allocate (key(max_nodes_per_element, mesh%nelement), source=0)
      do e = 1, mesh%nelement
         if (.not. part(e)) cycle
         call take_key(self, mesh, e, span(:, e), key(:, e), fits)
         if (.not. fits) return
      end do
      call stack_up(self, mesh, made_of, part, span, key)
   end subroutine new_extrusion

   !> Nodes of an element that stand over each other are of one column.
   subroutine link_columns(self, mesh, part)
      type(extrusion_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: part(:)
      integer :: e, i, j, a, b

      self%column = [(i, i=1, mesh%nnode)]
      do e = 1, mesh%nelement
         if (.not. part(e)) cycle
         do i = 2, count(mesh%conn(:, e) > 0)
            do j = 1, i - 1
               associate (p => mesh%x(:, mesh%conn(i, e)), q => mesh%x(:, mesh%conn(j, e)))
                  if (sum(abs(p - q)) - abs(p(self%axis) - q(self%axis)) > self%near) cycle
               end associate
               a = root(mesh%conn(i, e))
               b = root(mesh%conn(j, e))
               self%column(max(a, b)) = min(a, b)
            end do
         end do
      end do
      do i = 1, mesh%nnode
         self%column(i) = root(i)
      end do

   contains

      integer function root(node)
         integer, intent(in) :: node

         root = node
         do while (self%column(root) /= root)
            self%column(root) = self%column(self%column(root))
            root = self%column(root)
         end do
      end function root
   end subroutine link_columns

   !> The columns of the lower end of an element, in order; those of its upper end must be the same,
   !> and nodes halfway on some of them.
   subroutine take_key(self, mesh, e, span, key, fits)
      type(extrusion_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      real(wp), intent(in) :: span(2)          !! [length]
      integer, intent(out) :: key(:)
      logical, intent(out) :: fits
      integer :: upper(size(key)), i, low, high
      real(wp) :: z

      key = 0
      upper = 0
      low = 0
      high = 0
      fits = span(2) - span(1) > self%near
      do i = 1, count(mesh%conn(:, e) > 0)
         z = mesh%x(self%axis, mesh%conn(i, e))
         if (z - span(1) <= self%near) then
            low = low + 1
            key(low) = self%column(mesh%conn(i, e))
         else if (span(2) - z <= self%near) then
            high = high + 1
            upper(high) = self%column(mesh%conn(i, e))
         else
            fits = fits .and. abs(z - 0.5_wp*sum(span)) <= self%near
         end if
      end do
      call sort(key)
      call sort(upper)
      fits = fits .and. all(key == upper)
      do i = 1, count(mesh%conn(:, e) > 0)
         fits = fits .and. any(key == self%column(mesh%conn(i, e)))
      end do
      do i = 2, size(key)
         fits = fits .and. (key(i) /= key(i - 1) .or. key(i) == 0)
      end do
   end subroutine take_key

   !> Every stack begins at the lower end and has one element of one kind from each level to the
   !> next.
   subroutine stack_up(self, mesh, made_of, part, span, key)
      type(extrusion_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: made_of(:), key(:, :)
      logical, intent(in) :: part(:)
      real(wp), intent(in) :: span(:, :)
      real(wp) :: level(most_levels + 1)
      logical, allocatable :: there(:, :)
      integer :: e, k, bases, head(mesh%nnode), next(mesh%nelement), top

      level(1) = self%ends(1)
      self%levels = 0
      do
         level(self%levels + 2) = minval(span(2, :), mask=part .and. span(2, :) &
            & > level(self%levels + 1) + self%near)
         self%levels = self%levels + 1
         if (level(self%levels + 1) >= self%ends(2) - self%near) exit
         if (self%levels == most_levels) return
      end do
      allocate (self%base(mesh%nelement), source=0)
      allocate (there(self%levels, mesh%nelement), source=.false.)
      head = 0
      bases = 0
      top = size(key, 1)
      do e = 1, mesh%nelement
         if (.not. part(e) .or. span(1, e) > self%ends(1) + self%near) cycle
         bases = bases + 1
         self%base(e) = e
         next(e) = head(key(top, e))
         head(key(top, e)) = e
      end do
      if (count(part) /= bases*self%levels) return
      do e = 1, mesh%nelement
         if (.not. part(e)) cycle
         k = minloc(abs(level(:self%levels) - span(1, e)), 1)
         if (maxval(abs(level(k:k + 1) - span(:, e))) > self%near) return
         self%base(e) = head(key(top, e))
         do while (self%base(e) > 0)
            if (all(key(:, self%base(e)) == key(:, e))) exit
            self%base(e) = next(self%base(e))
         end do
         associate (b => self%base(e))
            if (b == 0) return
            if (there(k, b) .or. mesh%etype(b) /= mesh%etype(e) .or. made_of(b) /= made_of(e)) &
               & return
            there(k, b) = .true.
         end associate
      end do
      self%found = .true.
   end subroutine stack_up

   !> The face of the lowest element of a stack that stands under a face of another; 0: the face
   !> lies across the axis.
   pure integer function face_in_base(self, mesh, cell, e, f) result(face)
      type(extrusion_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell      !! of both elements
      integer, intent(in) :: e, f

      face = 0
      associate (node => mesh%conn(cell%face_node(:cell%face_nnode(f), f), e), &
         & base => mesh%conn(:cell%nnode, self%base(e)))
         if (maxval(mesh%x(self%axis, node)) - minval(mesh%x(self%axis, node)) <= self%near) return
         face = face_of_nodes(cell, self%column(base), self%column(node))
      end associate
   end function face_in_base
end module lopin_extrusion
