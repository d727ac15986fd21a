!> A mesh in space and an axis: whether its skin is one of revolution, whole or between planes of
!> symmetry through the axis.
!>
!> A face of the skin belongs to a surface of revolution if its corners lie on one line of the
!> meridian plane (r, z), as those of cylinders, cones and caps do; a face on a plane through the
!> axis is a cut. Faces between sections count as skin: what is inside is of revolution too.
module lopin_revolution
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_mesh, only : mesh_type
   implicit none
   private
   public :: revolution_type, find_revolution, edges_are_circles

   type :: revolution_type
      logical :: found = .false.
      integer :: axis = 0                      !! 1, 2, 3
      integer :: across(2) = 0                 !! the other two directions
      real(wp) :: centre(3) = 0.0_wp           !! a point of the axis [length]
      real(wp) :: near = 0.0_wp                !! nearer is the same place [length]
      logical :: cut(2) = .false.              !! a plane through the axis, normal to `across`, cuts
      integer :: cut_faces = 0                 !! elements of one meridian; 0: no cut
      logical, allocatable :: body(:)          !! (nnode) of the solids
      real(wp), allocatable :: r(:), z(:)      !! (nnode) [length]
   contains
      procedure :: on_plane
   end type revolution_type

   real(wp), parameter :: same_place = 1.0e-6_wp
   !> Chords of a circle span less than this: 23 degrees.
   real(wp), parameter :: widest = 0.4_wp

contains

   !> The axis of a mesh, among those through the origin and through middles and corners of its box.
   subroutine find_revolution(self, mesh, cell)
      type(revolution_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell(:)   !! of the element types
      type(facets_type) :: skin
      logical, allocatable :: shared(:)
      real(wp) :: box(3, 0:3)
      integer :: axis, i, j, k

      if (mesh%ndim /= 3 .or. .not. any(mesh%section > 0)) return
      call boundary_facets(skin, mesh, cell, pack([(i, i=1, mesh%nelement)], mesh%section > 0), &
         & .false., shared)
      call find_body(self, mesh)
      do k = 1, 3
         box(k, 1) = minval(mesh%x(k, :), mask=self%body)
         box(k, 3) = maxval(mesh%x(k, :), mask=self%body)
      end do
      box(:, 2) = 0.5_wp*(box(:, 1) + box(:, 3))
      box(:, 0) = 0.0_wp
      self%near = same_place*maxval(box(:, 3) - box(:, 1))
      do axis = 1, 3
         self%axis = axis
         self%across = [1 + mod(axis, 3), 1 + mod(axis + 1, 3)]
         do i = 0, 3
            do j = 0, 3
               self%centre = 0.0_wp
               self%centre(self%across) = [box(self%across(1), i), box(self%across(2), j)]
               call try_axis(self, mesh, cell, skin)
               if (self%found) return
            end do
         end do
      end do
   end subroutine find_revolution

   subroutine find_body(self, mesh)
      type(revolution_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer :: e, i

      allocate (self%body(mesh%nnode), source=.false.)
      do e = 1, mesh%nelement
         if (mesh%section(e) == 0) cycle
         do i = 1, size(mesh%conn, 1)
            if (mesh%conn(i, e) > 0) self%body(mesh%conn(i, e)) = .true.
         end do
      end do
   end subroutine find_body

   !> Whether the skin, and that of each section, is of revolution about the axis.
   subroutine try_axis(self, mesh, cell, skin)
      type(revolution_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell(:)
      type(facets_type), intent(in) :: skin
      type(facets_type) :: part
      logical, allocatable :: shared(:)
      integer :: cuts(2), s, i

      associate (a => self%across, c => self%centre)
         self%r = hypot(mesh%x(a(1), :) - c(a(1)), mesh%x(a(2), :) - c(a(2)))
         self%z = mesh%x(self%axis, :)
      end associate
      self%cut = .false.
      cuts = 0
      if (.not. faces_revolve(self, mesh, cell, skin, cuts)) return
      self%cut = cuts > 0
      do i = 1, 2
         if (.not. self%cut(i)) cycle
         associate (x => mesh%x(self%across(i), :) - self%centre(self%across(i)))
            if (any(self%body .and. x > self%near) .and. any(self%body .and. x < -self%near)) return
         end associate
      end do
      do s = 1, maxval(mesh%section)
         if (all(mesh%section == s .or. mesh%section == 0)) exit
         call boundary_facets(part, mesh, cell, pack([(i, i=1, mesh%nelement)], &
            & mesh%section == s), .false., shared)
         cuts = 0
         if (.not. faces_revolve(self, mesh, cell, part, cuts)) return
         if (any(cuts > 0 .and. .not. self%cut)) return
      end do
      cuts = 0
      self%found = faces_revolve(self, mesh, cell, skin, cuts)
      self%cut_faces = 0
      ! One plane alone cuts both sides of the axis.
      if (all(self%cut)) self%cut_faces = minval(cuts)
      if (count(self%cut) == 1) self%cut_faces = sum(cuts)/2
   end subroutine try_axis

   !> All faces are of revolution, or on a plane through the axis; those are counted.
   logical function faces_revolve(self, mesh, cell, faces, cuts) result(revolve)
      type(revolution_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell(:)
      type(facets_type), intent(in) :: faces
      integer, intent(inout) :: cuts(2)
      integer :: f, n, plane

      revolve = .false.
      do f = 1, faces%n
         n = faces%nnode(f)
         if (cell(mesh%etype(faces%element(f)))%quadratic) n = n/2
         associate (node => faces%node(:n, f))
            do plane = 1, 2
               if (all(self%on_plane(mesh, node, plane))) exit
            end do
            if (plane <= 2) then
               cuts(plane) = cuts(plane) + 1
            else if (.not. is_drawn_round(self, mesh, node)) then
               return
            end if
         end associate
      end do
      revolve = .true.
   end function faces_revolve

   !> Nodes on the plane through the axis that is normal to a direction across it.
   elemental logical function on(x, place, near)
      real(wp), intent(in) :: x, place, near
      on = abs(x - place) <= near
   end function on

   pure function on_plane(self, mesh, node, plane) result(are)
      class(revolution_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node(:)
      integer, intent(in) :: plane             !! 1, 2
      logical :: are(size(node))

      associate (d => self%across(plane))
         are = on(mesh%x(d, node), self%centre(d), self%near)
      end associate
   end function on_plane

   !> Corners of a face lie on one line of the meridian plane, and are short chords of its circles.
   logical function is_drawn_round(self, mesh, node) result(is)
      type(revolution_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node(:)
      real(wp) :: along(2), reach, off, x(2), y(2)
      integer :: i, j, far(2)

      is = .false.
      reach = -1.0_wp
      do i = 1, size(node)
         do j = 1, i - 1
            off = hypot(self%r(node(i)) - self%r(node(j)), self%z(node(i)) - self%z(node(j)))
            if (off <= reach) cycle
            reach = off
            far = [node(i), node(j)]
         end do
      end do
      if (reach <= self%near) return
      along = [self%r(far(2)) - self%r(far(1)), self%z(far(2)) - self%z(far(1))]/reach
      do i = 1, size(node)
         off = along(1)*(self%z(node(i)) - self%z(far(1))) - along(2)*(self%r(node(i)) &
            & - self%r(far(1)))
         if (abs(off) > self%near) return
      end do
      is = .true.
      if (abs(along(2)) <= 1.0e-6_wp) return   ! a cap
      do i = 1, size(node)
         x = mesh%x(self%across, node(i)) - self%centre(self%across)
         do j = 1, i - 1
            y = mesh%x(self%across, node(j)) - self%centre(self%across)
            if (min(norm2(x), norm2(y)) <= self%near) cycle
            is = is .and. dot_product(x, y) >= cos(widest)*norm2(x)*norm2(y)
         end do
      end do
   end function is_drawn_round

   !> The edge of a patch of faces runs along circles and cuts alone.
   logical function edges_are_circles(self, mesh, cell, element, face) result(are)
      type(revolution_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell(:)
      integer, intent(in) :: element(:), face(:)
      integer, allocatable :: head(:), next(:), other(:), times(:)
      integer :: i, k, n, used, a, b, p

      allocate (head(mesh%nnode), source=0)
      allocate (next(4*size(face)), other(4*size(face)), times(4*size(face)), source=0)
      used = 0
      do i = 1, size(face)
         associate (c => cell(mesh%etype(element(i))))
            n = c%face_nnode(face(i))
            if (c%quadratic) n = n/2
            do k = 1, n
               a = mesh%conn(c%face_node(k, face(i)), element(i))
               b = mesh%conn(c%face_node(1 + mod(k, n), face(i)), element(i))
               call count_edge(min(a, b), max(a, b))
            end do
         end associate
      end do
      are = .false.
      do a = 1, mesh%nnode
         p = head(a)
         do while (p > 0)
            if (times(p) == 1 .and. .not. is_circle(a, other(p))) return
            p = next(p)
         end do
      end do
      are = .true.

   contains

      subroutine count_edge(a, b)
         integer, intent(in) :: a, b
         integer :: p

         p = head(a)
         do while (p > 0)
            if (other(p) == b) then
               times(p) = times(p) + 1
               return
            end if
            p = next(p)
         end do
         used = used + 1
         other(used) = b
         times(used) = 1
         next(used) = head(a)
         head(a) = used
      end subroutine count_edge

      logical function is_circle(a, b)
         integer, intent(in) :: a, b
         is_circle = max(abs(self%r(a) - self%r(b)), abs(self%z(a) - self%z(b))) <= self%near
         if (.not. is_circle) is_circle = all(self%on_plane(mesh, [a, b], 1)) &
            & .or. all(self%on_plane(mesh, [a, b], 2))
      end function is_circle
   end function edges_are_circles
end module lopin_revolution
