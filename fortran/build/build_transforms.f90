!> `*TRANSFORM`: local axes of nodes.
module lopin_build_transforms
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & complain, line_place
   use lopin_build_scene, only : scene_type, need_word, get_word, set_named
   use lopin_build_parts, only : placed
   implicit none
   private
   public :: build_transforms

contains

   subroutine build_transforms(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: word, kind
      type(location_type) :: at
      real(wp), allocatable :: axes(:, :, :)
      real(wp) :: point(6), origin(3)
      integer, allocatable :: slot(:)
      integer :: k, i, s, n
      logical :: found, lies_on_axis, told

      allocate (model%transform%node(0), slot(model%mesh%nnode), axes(3, 3, model%mesh%nnode))
      slot = 0
      n = 0
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword /= 'TRANSFORM') cycle
            call need_word(block, 'NSET', word, at, found, model%log)
            if (.not. found) cycle
            s = set_named(scene, model%mesh%nset, 'node set', word, scope, at, model%log)
            call get_word(block, 'TYPE', kind, at, found)
            call read_points(block, point, found, model%log)
            if (s == 0 .or. .not. found) cycle
            ! R: directions, which instances turn and do not move.
            origin = merge(placed(scene, scope, [0.0_wp, 0.0_wp, 0.0_wp]), 0.0_wp, kind /= 'C')
            point(:3) = placed(scene, scope, point(:3)) - origin
            point(4:) = placed(scene, scope, point(4:)) - origin
            told = .false.
            do i = 1, size(model%mesh%nset(s)%member)
               call turn_node(model%mesh%nset(s)%member(i), line_place(block%line(1)))
               if (.not. found) exit
            end do
            if (.not. found) call complain(model%log, 'E0405', 'the points of *TRANSFORM give '// &
               & 'no axes', line_place(block%line(1)), help='R: a on local x, b in the xy '// &
               & 'plane, not in line with the origin; C: a and b, two points of the axis')
         end associate
      end do
      model%transform%axes = axes(:, :, :n)

   contains

      !> Axes of a node; `found` if the points give any.
      subroutine turn_node(node, place)
         integer, intent(in) :: node
         type(location_type), intent(in) :: place   !! of the points

         if (slot(node) == 0) then
            n = n + 1
            slot(node) = n
            model%transform%node = [model%transform%node, node]
         end if
         call local_axes(kind, point, model%mesh%x(:, node), axes(:, :, slot(node)), found, &
            & lies_on_axis)
         if (found .and. lies_on_axis .and. .not. told) call model%log%say(severity%note, 'N0406', &
            & 'node '//to_text(model%mesh%node_label(node))//' lies on the axis of '// &
            & '*TRANSFORM: its radial direction is '//direction(axes(1, :, slot(node))), place)
         told = told .or. lies_on_axis
      end subroutine turn_node
   end subroutine build_transforms

   subroutine read_points(block, point, found, log)
      type(block_type), intent(in) :: block
      real(wp), intent(out) :: point(6)
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: i, n
      logical :: ok

      point = 0.0_wp
      found = block%nline > 0
      if (.not. found) then
         call complain(log, 'E0103', '*TRANSFORM needs a line with two points', block%at)
         return
      end if
      call split_fields(block%line(1), field, n)
      do i = 1, min(6, n)
         call field_real(field(i), point(i), log, ok)
      end do
   end subroutine read_points

   !> Rows are the local directions: R from two points, C radial, tangential, axial at a node.
   !> At a node on the axis of C every direction is radial: CalculiX' choice is taken.
   pure subroutine local_axes(kind, point, x, axes, found, lies_on_axis)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: point(6)       !! a and b [length]
      real(wp), intent(in) :: x(:)           !! (ndim) the node [length]
      real(wp), intent(out) :: axes(3, 3)
      logical, intent(out) :: found, lies_on_axis
      real(wp), parameter :: smallest = 1.0e-9_wp
      real(wp) :: one(3), two(3), three(3), scale

      axes = 0.0_wp
      lies_on_axis = .false.
      if (kind == 'C') then
         three = point(4:) - point(:3)
         one = -point(:3)
         one(:size(x)) = one(:size(x)) + x
         scale = norm2(three)
         if (scale > 0.0_wp) three = three/scale
         scale = max(scale, norm2(one))
         one = one - three*dot_product(one, three)
         found = norm2(three) > 0.5_wp
         lies_on_axis = .not. norm2(one) > smallest*scale
         if (found .and. lies_on_axis) one = across(three)
      else
         one = point(:3)
         two = point(4:)
         three = cross(one, two)
         found = norm2(three) > smallest*norm2(one)*norm2(two)
      end if
      if (.not. found) return
      axes(1, :) = one/norm2(one)
      axes(3, :) = three/norm2(three)
      axes(2, :) = cross(axes(3, :), axes(1, :))
   end subroutine local_axes

   !> A direction across an axis.
   pure function across(axis) result(one)
      real(wp), intent(in) :: axis(3)
      real(wp) :: one(3)
      real(wp), parameter :: smallest = 1.0e-9_wp

      if (abs(axis(1)) > smallest) then
         one = [-axis(2)/axis(1), 1.0_wp, 0.0_wp]
      else if (abs(axis(2)) > smallest) then
         one = [0.0_wp, -axis(3)/axis(2), 1.0_wp]
      else
         one = [1.0_wp, 0.0_wp, 0.0_wp]
      end if
   end function across

   pure function direction(one) result(text)
      real(wp), intent(in) :: one(3)
      character(len=:), allocatable :: text

      text = '('//to_text(one(1), 3)//', '//to_text(one(2), 3)//', '//to_text(one(3), 3)//')'
   end function direction
end module lopin_build_transforms
