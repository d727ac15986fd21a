!> Small tools that an increment takes through a face of their slave, between its nodes: no row sees
!> them, and once they are through nothing touches any more.
!>
!> Looked at after every increment: the middle of a tool whose whole surface is smaller than the
!> body passes from one side of a face to the other. The nodes of the face are taken into the frame
!> of the tool, where the middle stands still.
module lopin_passed_tools
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_vectors, only : cross
   use lopin_element_type, only : cells_of_words
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, new_facets
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_placed_tool, only : placed_tool_type, place_tool, faces_a_tool
   use lopin_tool_sweep, only : place_of
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_passed_tools

contains

   subroutine check_passed_tools(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(placed_tool_type) :: before, after
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: facets
      real(wp) :: middle(model%mesh%ndim), wide
      integer :: pair, i

      do pair = 1, size(model%pair)
         if (.not. faces_a_tool(scene, model, pair)) cycle
         associate (slave => model%surface(model%pair(pair)%slave))
            call measure_tool(model%tool(model%surface(model%pair(pair)%master)%tool)%shape, &
               & model, scene%bodies%length, middle, wide)
            if (.not. wide < huge(1.0_wp)) cycle
            call place_tool(before, scene, model, pair, scene%accepted%motion%u)
            call place_tool(after, scene, model, pair, scene%trial%motion%u)
            if (.not. allocated(cells)) call cells_of_words(model%element_word, cells)
            call new_facets(facets, model%mesh, cells, slave%element, slave%face)
            do i = 1, facets%n
               if (.not. passes(scene, model, facets%node(:facets%nnode(i), i), before, after, &
                  & middle)) cycle
               call tell(scene, model, pair, facets, i, wide)
               exit
            end do
         end associate
      end do
   end subroutine check_passed_tools

   !> The middle of the tool goes through a part of a facet.
   logical function passes(scene, model, node, before, after, middle)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: node(:)           !! of the facet, corners first
      type(placed_tool_type), intent(in) :: before, after
      real(wp), intent(in) :: middle(:)
      real(wp) :: from(size(middle), size(node)), to(size(middle), size(node))
      integer :: k, n

      n = size(node)
      do k = 1, n
         from(:, k) = before%motion%to_tool(place_of(model, scene%dofs, node(k), &
            & scene%accepted%motion%u))
         to(:, k) = after%motion%to_tool(place_of(model, scene%dofs, node(k), &
            & scene%trial%motion%u))
      end do
      passes = .false.
      if (size(middle) == 3) then
         do k = 2, merge(4, 3, n == 4 .or. n >= 8) - 1
            passes = passes .or. crosses(from(:, [1, k, k + 1]), to(:, [1, k, k + 1]), middle)
         end do
      else if (n == 3) then
         passes = crosses(from(:, [1, 3]), to(:, [1, 3]), middle) &
            & .or. crosses(from(:, [3, 2]), to(:, [3, 2]), middle)
      else
         passes = crosses(from, to, middle)
      end if
   end function passes

   !> The middle of a tool and its size, huge where its middle is not inside it or where it is
   !> larger than the bodies.
   subroutine measure_tool(shape, model, long, middle, wide)
      class(tool_type), intent(in) :: shape
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: long             !! of the bodies [length]
      real(wp), intent(out) :: middle(:), wide
      real(wp), allocatable :: points(:, :)
      integer, allocatable :: cells(:, :)
      real(wp) :: box(size(middle), 2)
      type(foot_type) :: foot

      wide = huge(1.0_wp)
      middle = 0.0_wp
      box(:, 1) = minval(model%mesh%x, 2) - 10.0_wp*long
      box(:, 2) = maxval(model%mesh%x, 2) + 10.0_wp*long
      call shape%tessellate(box, points, cells)
      if (size(points, 2) == 0) return
      if (norm2(maxval(points, 2) - minval(points, 2)) > long) return
      middle = 0.5_wp*(minval(points, 2) + maxval(points, 2))
      call shape%project(middle, foot)
      if (.not. foot%found .or. foot%gap >= 0.0_wp) return
      wide = maxval(maxval(points, 2) - minval(points, 2))
   end subroutine measure_tool

   !> A point passes from one side of a segment or a triangle to the other, through it.
   pure logical function crosses(from, to, point)
      real(wp), intent(in) :: from(:, :), to(:, :)   !! (ndim, ndim) before and after
      real(wp), intent(in) :: point(:)
      real(wp) :: x(size(point), size(point)), before, after

      before = side(from, point)
      after = side(to, point)
      crosses = .false.
      if (before > 0.0_wp .eqv. after > 0.0_wp) return
      x = from + before/(before - after)*(to - from)
      crosses = is_within(x, point)
   end function crosses

   !> Positive on one side of a segment or a triangle.
   pure real(wp) function side(x, point)
      real(wp), intent(in) :: x(:, :), point(:)

      if (size(point) == 2) then
         side = (x(1, 2) - x(1, 1))*(point(2) - x(2, 1)) - (x(2, 2) - x(2, 1))*(point(1) - x(1, 1))
      else
         side = dot_product(cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1)), point - x(:, 1))
      end if
   end function side

   !> The foot of a point is on a segment or a triangle.
   pure logical function is_within(x, point)
      real(wp), intent(in) :: x(:, :), point(:)
      real(wp) :: normal(3), share
      integer :: k, next

      if (size(point) == 2) then
         share = dot_product(point - x(:, 1), x(:, 2) - x(:, 1))/sum((x(:, 2) - x(:, 1))**2)
         is_within = share >= 0.0_wp .and. share <= 1.0_wp
         return
      end if
      normal = cross(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))
      is_within = .true.
      do k = 1, 3
         next = 1 + mod(k, 3)
         is_within = is_within .and. dot_product(cross(x(:, next) - x(:, k), point - x(:, k)), &
            & normal) >= 0.0_wp
      end do
   end function is_within

   subroutine tell(scene, model, pair, facets, i, wide)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, i
      type(facets_type), intent(in) :: facets
      real(wp), intent(in) :: wide             !! size of the tool [length]

      associate (p => model%pair(pair))
         call warn_once(scene%log, 'W0337', model%surface(p%master)%name//', '// &
            & to_text(wide, 3)//' wide, goes through face S'//to_text(facets%face(i))// &
            & ' of element '//to_text(model%mesh%element_label(facets%element(i)))//' of '// &
            & model%surface(p%slave)%name//' between its nodes: no row sees it, and it bears '// &
            & 'nothing from there on', p%at, &
            & help='facets of the slave that are at most half as wide as the tool')
      end associate
   end subroutine tell
end module lopin_passed_tools
