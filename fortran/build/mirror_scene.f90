!> What of a scene is the mirror image of what: surfaces, tools, rigid bodies and pairs.
!>
!> Two dies that press from both sides of the plane are each other's image, with their pairs; others
!> are their own.
module lopin_mirror_scene
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type, surface_of
   use lopin_mirror, only : mirror_type, image_of_face, image_of_point
   implicit none
   private
   public :: scene_mirror_type, mirror_scene, differs, points_near, feet_differ

   !> Loads and places that differ by less than this share are equal.
   real(wp), parameter :: equal = 1.0e-9_wp

   type :: scene_mirror_type
      logical :: found = .false.               !! everything has an image
      integer, allocatable :: node(:)          !! (nnode) image, of reference nodes too; 0: none
      integer, allocatable :: pair(:)          !! (npair) image of each
   end type scene_mirror_type

contains

   !> The images of rigid bodies and pairs; `found` is false if some has none.
   subroutine mirror_scene(self, model, cell, mirror)
      type(scene_mirror_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)   !! of the element types
      type(mirror_type), intent(in) :: mirror
      integer :: i, j

      self%node = mirror%node
      allocate (self%pair(size(model%pair)), source=0)
      do i = 1, size(model%rigid_body)
         do j = 0, size(model%rigid_body)
            if (body_is_image(model, mirror, i, merge(i, j, j == 0))) exit
         end do
         if (j > size(model%rigid_body)) return
         associate (reference => model%rigid_body(i)%reference)
            if (mirror%node(reference) == 0) self%node(reference) = &
               & model%rigid_body(merge(i, j, j == 0))%reference
         end associate
      end do
      ! Of tools that stand at one place two would have one image.
      do i = 1, size(model%rigid_body)
         associate (reference => model%rigid_body(i)%reference)
            if (self%node(self%node(reference)) /= reference) return
         end associate
      end do
      do i = 1, size(model%pair)
         do j = 0, size(model%pair)
            if (pair_is_image(model, cell, mirror, self, [i, merge(i, j, j == 0)])) exit
         end do
         if (j > size(model%pair)) return
         self%pair(i) = merge(i, j, j == 0)
      end do
      if (any(self%pair(self%pair) /= [(i, i=1, size(self%pair))])) return
      self%found = .true.
   end subroutine mirror_scene

   !> Nodes of a rigid body, and the tool that it moves, are images of those of another.
   logical function body_is_image(model, mirror, body, other) result(is)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      integer, intent(in) :: body, other
      logical :: member(0:model%mesh%nnode)

      member = .false.
      associate (own => model%rigid_body(body), image => model%rigid_body(other))
         member(image%node) = .true.
         is = size(own%node) == size(image%node) .and. all(member(mirror%node(own%node))) &
            & .and. (own%tool == 0 .eqv. image%tool == 0)
         if (is .and. own%tool > 0) is = tool_is_image(model, mirror, model%tool(own%tool)%shape, &
            & model%tool(image%tool)%shape)
      end associate
   end function body_is_image

   !> The surfaces of a pair are images of those of another, and they act alike.
   logical function pair_is_image(model, cell, mirror, scene, both) result(is)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(mirror_type), intent(in) :: mirror
      type(scene_mirror_type), intent(in) :: scene
      integer, intent(in) :: both(2)           !! the pair, and that other one

      associate (own => model%pair(both(1)), image => model%pair(both(2)))
         is = own%interaction == image%interaction .and. own%before == image%before &
            & .and. own%first_step == image%first_step .and. own%last_step == image%last_step &
            & .and. (own%surface_to_surface .eqv. image%surface_to_surface) &
            & .and. (own%smooth .eqv. image%smooth) .and. (own%tied .eqv. image%tied) &
            & .and. (own%small_sliding .eqv. image%small_sliding) &
            & .and. (own%has_clearance .eqv. image%has_clearance) &
            & .and. own%control%initial == image%control%initial &
            & .and. .not. differs(own%adjust, image%adjust) &
            & .and. .not. differs(own%clearance, image%clearance) &
            & .and. .not. differs(own%extension, image%extension)
         if (is) is = surface_is_image(model, cell, mirror, scene, [own%slave, image%slave])
         if (is) is = surface_is_image(model, cell, mirror, scene, [own%master, image%master])
      end associate
   end function pair_is_image

   logical function surface_is_image(model, cell, mirror, scene, both) result(is)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(mirror_type), intent(in) :: mirror
      type(scene_mirror_type), intent(in) :: scene
      integer, intent(in) :: both(2)           !! the surface, and that other one
      logical, allocatable :: has(:, :)
      real(wp) :: area(0:model%mesh%nnode)
      integer :: i, face

      is = .false.
      if (any(both == 0)) return
      associate (s => model%surface(both(1)), o => model%surface(both(2)))
         if (s%kind /= o%kind) return
         if (s%kind == surface_of%tool) then
            is = bodies_are_images(model, scene, model%tool(s%tool)%rigid_body, &
               & model%tool(o%tool)%rigid_body)
            if (is) is = tool_is_image(model, mirror, model%tool(s%tool)%shape, &
               & model%tool(o%tool)%shape)
         else if (s%kind == surface_of%nodes) then
            if (size(s%node) /= size(o%node)) return
            area = -1.0_wp
            area(o%node) = o%area
            is = .not. any(differs(s%area, area(mirror%node(s%node))))
         else
            if (size(s%element) /= size(o%element)) return
            allocate (has(0:6, model%mesh%nelement), source=.false.)
            do i = 1, size(o%element)
               has(o%face(i), o%element(i)) = .true.
            end do
            do i = 1, size(s%element)
               associate (c => cell(model%mesh%etype(s%element(i))))
                  ! Which side of a rigid element is meant goes with the order of its nodes.
                  if (c%sided) return
                  face = image_of_face(mirror, model%mesh, c, s%element(i), s%face(i))
               end associate
               if (.not. has(face, mirror%element(s%element(i)))) return
            end do
            is = .true.
         end if
      end associate
   end function surface_is_image

   !> Two tools are both fixed in space, or the bodies that move them are each other's image.
   pure logical function bodies_are_images(model, scene, body, other) result(are)
      type(model_type), intent(in) :: model
      type(scene_mirror_type), intent(in) :: scene
      integer, intent(in) :: body, other       !! 0: fixed in space

      are = body == 0 .and. other == 0
      if (body == 0 .or. other == 0) return
      are = scene%node(model%rigid_body(body)%reference) == model%rigid_body(other)%reference
   end function bodies_are_images

   elemental logical function differs(a, b)
      real(wp), intent(in) :: a, b
      differs = abs(a - b) > equal*max(abs(a), abs(b))
   end function differs

   !> Every point of a tool near the bodies, and beside it, and every node, has the distance that
   !> its image has from another, and lies as far beyond its end.
   logical function tool_is_image(model, mirror, shape, other) result(is)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      class(tool_type), intent(in) :: shape, other
      real(wp), allocatable :: points(:, :)
      real(wp) :: extent, x(shape%ndim)
      type(foot_type) :: own, image
      integer :: i, side

      is = .false.
      call points_near(model%mesh%x, shape, points, extent)
      do i = 1, size(points, 2)
         call shape%project(points(:, i), own)
         do side = -1, 1
            x = points(:, i) + 0.1_wp*side*extent*own%normal(:shape%ndim)
            call shape%project(x, own)
            call other%project(image_of_point(mirror, x), image)
            if (feet_differ(own, image, extent)) return
         end do
      end do
      is = .true.
   end function tool_is_image

   !> Two points do not stand to a tool alike: beyond an end the gap goes on along the tangent.
   pure logical function feet_differ(own, image, extent) result(differ)
      type(foot_type), intent(in) :: own, image
      real(wp), intent(in) :: extent           !! of the bodies [length]

      differ = own%found .neqv. image%found
      differ = differ .or. max(abs(own%gap - image%gap), abs(own%overhang - image%overhang)) &
         & > 1.0e-6_wp*extent
   end function feet_differ

   !> Points of a tool near the nodes of bodies, and some of these.
   subroutine points_near(nodes, shape, points, extent)
      real(wp), intent(in) :: nodes(:, :)      !! (ndim, nnode) [length]
      class(tool_type), intent(in) :: shape
      real(wp), allocatable, intent(out) :: points(:, :)   !! (ndim, n) [length]
      real(wp), intent(out) :: extent          !! of the bodies [length]
      integer, parameter :: most = 400
      real(wp), allocatable :: on_tool(:, :)
      integer, allocatable :: cells(:, :)
      real(wp) :: box(shape%ndim, 2)
      integer :: i, every

      box(:, 1) = minval(nodes, dim=2)
      box(:, 2) = maxval(nodes, dim=2)
      extent = maxval(box(:, 2) - box(:, 1))
      box(:, 1) = box(:, 1) - extent
      box(:, 2) = box(:, 2) + extent
      call shape%tessellate(box, on_tool, cells)
      on_tool = on_tool(:, pack([(i, i=1, size(on_tool, 2))], [(all(on_tool(:, i) >= box(:, 1) &
         & .and. on_tool(:, i) <= box(:, 2)), i=1, size(on_tool, 2))]))
      every = 1 + size(nodes, 2)/most
      points = reshape([on_tool, nodes(:, [(i, i=1, size(nodes, 2), every)])], &
         & [size(nodes, 1), size(on_tool, 2) + (size(nodes, 2) + every - 1)/every])
   end subroutine points_near
end module lopin_mirror_scene
