!> A mesh and its mirror image in a plane across one axis: which node and element stand for which.
!>
!> Only meshes that are their own image, node by node, have one. Sets, faces and loads are then
!> compared through it.
module lopin_mirror
   use lopin_kinds, only : wp
   use lopin_sorting, only : sort
   use lopin_cells, only : cell_type, face_of_nodes
   use lopin_mesh, only : mesh_type, max_nodes_per_element
   use lopin_point_bins, only : point_bins_type
   implicit none
   private
   public :: mirror_type, new_mirror, image_of_face, image_of_point

   type :: mirror_type
      integer :: axis = 0                      !! normal of the plane: 1, 2, 3
      real(wp) :: place = 0.0_wp               !! where the plane stands on it [length]
      logical :: found = .false.
      integer, allocatable :: node(:)          !! (nnode) the image of each; 0: of no element
      integer, allocatable :: element(:)       !! (nelement) the image of each
   end type mirror_type

   !> Nodes nearer than this share of the extent are one place.
   real(wp), parameter :: coincident = 1.0e-8_wp

contains

   !> The image of the mesh across an axis, about the middle of its elements; `found` is false if
   !> some node or element has none.
   subroutine new_mirror(self, mesh, axis, made_of)
      type(mirror_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: axis
      integer, intent(in) :: made_of(:)        !! (nelement) equal where sections are alike
      logical :: used(mesh%nnode)
      integer :: e, i

      used = .false.
      do e = 1, mesh%nelement
         do i = 1, max_nodes_per_element
            if (mesh%conn(i, e) > 0) used(mesh%conn(i, e)) = .true.
         end do
      end do
      if (.not. any(used)) return
      self%axis = axis
      self%place = 0.5_wp*(minval(mesh%x(axis, :), mask=used) + maxval(mesh%x(axis, :), mask=used))
      call match_nodes(self, mesh, used)
      if (self%found) call match_elements(self, mesh, made_of)
   end subroutine new_mirror

   !> The image of a point.
   pure function image_of_point(self, x) result(image)
      type(mirror_type), intent(in) :: self
      real(wp), intent(in) :: x(:)             !! [length]
      real(wp) :: image(size(x))

      image = x
      image(self%axis) = 2.0_wp*self%place - x(self%axis)
   end function image_of_point

   !> Where several nodes stand at one place, as of bodies that touch, the image is that of the body
   !> to which the rest of the own body is led.
   subroutine match_nodes(self, mesh, used)
      type(mirror_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      logical, intent(in) :: used(:)
      type(point_bins_type) :: bins
      real(wp), allocatable :: x(:, :)
      integer, allocatable :: of(:), near(:), body(:), body_image(:)
      real(wp) :: extent, at(3)
      integer :: i, k, n, pass

      of = pack([(i, i=1, mesh%nnode)], used)
      n = size(of)
      allocate (x(3, n), source=0.0_wp)
      x(:mesh%ndim, :) = mesh%x(:, of)
      extent = maxval(maxval(x, dim=2) - minval(x, dim=2))
      call bins%fill(x, 1.0e-3_wp*extent)
      call find_bodies(mesh, body)
      allocate (self%node(mesh%nnode), body_image(mesh%nnode), source=0)
      do pass = 1, 2
         do i = 1, n
            if (self%node(of(i)) > 0) cycle
            at = image_of_point(self, x(:, i))
            call bins%near(at, near)
            near = pack(near, [(norm2(x(:, near(k)) - at) <= coincident*extent, k=1, size(near))])
            if (size(near) == 0) return
            if (pass == 1 .and. size(near) > 1) cycle
            if (pass == 2) near = pack(near, body(of(near)) == body_image(body(of(i))))
            if (size(near) /= 1) return
            self%node(of(i)) = of(near(1))
            body_image(body(of(i))) = body(of(near(1)))
         end do
      end do
      self%found = .true.
   end subroutine match_nodes

   !> The body of each node: the least node that elements connect with it.
   subroutine find_bodies(mesh, body)
      type(mesh_type), intent(in) :: mesh
      integer, allocatable, intent(out) :: body(:)
      integer :: e, i, least
      logical :: changed

      body = [(i, i=1, mesh%nnode)]
      do
         changed = .false.
         do e = 1, mesh%nelement
            associate (node => pack(mesh%conn(:, e), mesh%conn(:, e) > 0))
               least = minval(body(body(node)))
               changed = changed .or. any(body(node) /= least)
               body(body(node)) = least
               body(node) = least
            end associate
         end do
         if (.not. changed) exit
      end do
   end subroutine find_bodies

   subroutine match_elements(self, mesh, made_of)
      type(mirror_type), intent(inout) :: self
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: made_of(:)
      integer, allocatable :: start(:), list(:), own(:, :)
      integer :: e, k, wanted(max_nodes_per_element)

      self%found = .false.
      allocate (self%element(mesh%nelement), source=0)
      allocate (own, mold=mesh%conn)
      do e = 1, mesh%nelement
         own(:, e) = mesh%conn(:, e)
         call sort(own(:, e))
      end do
      ! Elements by their highest node.
      allocate (start(mesh%nnode + 2), source=0)
      do e = 1, mesh%nelement
         associate (top => own(max_nodes_per_element, e))
            start(top + 2) = start(top + 2) + 1
         end associate
      end do
      start(1) = 1
      do k = 2, size(start)
         start(k) = start(k) + start(k - 1)
      end do
      allocate (list(mesh%nelement))
      do e = 1, mesh%nelement
         associate (top => own(max_nodes_per_element, e))
            list(start(top + 1)) = e
            start(top + 1) = start(top + 1) + 1
         end associate
      end do
      do e = 1, mesh%nelement
         wanted = 0
         where (own(:, e) > 0) wanted = self%node(max(own(:, e), 1))
         call sort(wanted)
         associate (top => wanted(max_nodes_per_element))
            do k = start(top), start(top + 1) - 1
               if (any(own(:, list(k)) /= wanted)) cycle
               if (mesh%etype(list(k)) /= mesh%etype(e)) cycle
               if (made_of(list(k)) == made_of(e)) self%element(e) = list(k)
            end do
         end associate
         if (self%element(e) == 0) return
      end do
      self%found = .true.
   end subroutine match_elements

   !> The face of the image of an element that is the image of a face; 0: none.
   pure integer function image_of_face(self, mesh, cell, e, f) result(face)
      type(mirror_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell      !! of both elements
      integer, intent(in) :: e, f

      face = face_of_nodes(cell, mesh%conn(:, self%element(e)), &
         & self%node(mesh%conn(cell%face_node(:cell%face_nnode(f), f), e)))
   end function image_of_face
end module lopin_mirror
