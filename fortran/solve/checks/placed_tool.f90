!> A rigid tool where it stands in the trial state, and gaps of places of facets to it.
module lopin_placed_tool
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, shape_functions
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type, surface_of
   use lopin_contact_points, only : facing, pair_is_tied
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: placed_tool_type, find_places, place_tool, gap_at, distance_at, faces_a_tool, &
      & presses_by_faces

   !> A tool where it stands, as its slave meets it.
   type :: placed_tool_type
      class(tool_type), allocatable :: shape
      type(rigid_motion_type) :: motion
      real(wp) :: extension = 0.0_wp           !! [facets]
   end type placed_tool_type

contains

   !> Whether a pair is in force, not tied, and its slave are faces of solids.
   pure logical function presses_by_faces(scene, model, pair)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      presses_by_faces = model%surface(model%pair(pair)%slave)%kind == surface_of%faces &
         & .and. .not. pair_is_tied(model, model%pair(pair))
      if (presses_by_faces .and. scene%newton%in_use) &
         & presses_by_faces = scene%newton%contact%pair_active(pair)
   end function presses_by_faces

   !> Whether such a pair meets a rigid tool.
   pure logical function faces_a_tool(scene, model, pair)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      faces_a_tool = model%surface(model%pair(pair)%master)%kind == surface_of%tool &
         & .and. presses_by_faces(scene, model, pair)
   end function faces_a_tool

   !> Where the nodes are now.
   subroutine find_places(scene, model, x)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: x(:, :)         !! (ndim, nnode) now [length]
      integer :: node, k

      x = model%mesh%x
      do node = 1, size(x, 2)
         do k = 1, size(x, 1)
            if (scene%dofs%id(k, node) > 0) x(k, node) = x(k, node) &
               & + scene%trial%motion%u(scene%dofs%id(k, node))
         end do
      end do
   end subroutine find_places

   !> The tool of a pair where displacements have it.
   subroutine place_tool(self, scene, model, pair, u)
      type(placed_tool_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      real(wp) :: place(6), at(model%mesh%ndim)
      integer :: k, d

      d = model%mesh%ndim
      place = 0.0_wp
      at = 0.0_wp
      associate (tool => model%tool(model%surface(model%pair(pair)%master)%tool))
         allocate (self%shape, source=tool%shape)
         self%extension = model%pair(pair)%extension
         if (tool%rigid_body > 0) then
            associate (node => model%rigid_body(tool%rigid_body)%reference)
               at = model%mesh%x(:, node)
               do k = 1, 6
                  if (scene%dofs%id(k, node) > 0) place(k) = u(scene%dofs%id(k, node))
               end do
            end associate
         end if
      end associate
      if (d == 2) call new_rigid_motion(self%motion, at, place(:2), place(6:6))
      if (d == 3) call new_rigid_motion(self%motion, at, place(:3), place(4:6))
   end subroutine place_tool

   !> Gap of a place of a facet; huge where it does not meet the tool.
   real(wp) function gap_at(stand, cell, x, xi, size_, inside, normal) result(gap)
      type(placed_tool_type), intent(in) :: stand
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode of the facet) [length]
      real(wp), intent(in) :: xi(:)            !! (ndim - 1)
      real(wp), intent(in) :: size_            !! of the facet [length]
      logical, intent(in) :: inside            !! any side of the tool counts for places inside it
      real(wp), intent(out), optional :: normal(:)   !! (ndim) of the tool there
      type(foot_type) :: foot
      real(wp) :: n(8), dn(2, 8), t(3, 2), side(3)
      integer :: d, m

      d = size(x, 1)
      m = size(x, 2)
      gap = huge(1.0_wp)
      call shape_functions(cell, xi, n(:m), dn(:d - 1, :m))
      t = 0.0_wp
      t(3, 2) = 1.0_wp
      t(:d, :d - 1) = matmul(x, transpose(dn(:d - 1, :m)))
      side = [t(2, 1)*t(3, 2) - t(3, 1)*t(2, 2), t(3, 1)*t(1, 2) - t(1, 1)*t(3, 2), &
         & t(1, 1)*t(2, 2) - t(2, 1)*t(1, 2)]
      call stand%shape%project(stand%motion%to_tool(matmul(x, n(:m))), foot)
      if (.not. foot%found .or. foot%overhang > stand%extension*size_) return
      if (present(normal)) normal = stand%motion%turn(foot%normal(:d))
      ! Inside the tool the nearest side may be one that the facet does not face.
      if (dot_product(side(:d), stand%motion%turn(foot%normal(:d))) > facing*norm2(side) &
         & .and. .not. (inside .and. foot%gap < 0.0_wp)) return
      gap = foot%gap
   end function gap_at

   !> How far a place of a facet is from the tool, whichever way that faces.
   real(wp) function distance_at(stand, cell, x, xi) result(distance)
      type(placed_tool_type), intent(in) :: stand
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode of the facet) [length]
      real(wp), intent(in) :: xi(:)            !! (ndim - 1)
      type(foot_type) :: foot
      real(wp) :: n(8), dn(2, 8), y(size(x, 1))

      call shape_functions(cell, xi, n(:size(x, 2)), dn(:size(xi), :size(x, 2)))
      y = stand%motion%to_tool(matmul(x, n(:size(x, 2))))
      call stand%shape%project(y, foot)
      distance = huge(1.0_wp)
      if (foot%found) distance = norm2(y - foot%point(:size(y)))
   end function distance_at
end module lopin_placed_tool
