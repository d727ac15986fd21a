!> Rigid tools of the deck: `*SURFACE, TYPE=SEGMENTS, CYLINDER, REVOLUTION`.
module lopin_build_tools
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_text, only : upper
   use lopin_profile, only : segment_card_type
   use lopin_tool_factory, only : new_tool_from_segments
   use lopin_model, only : model_type, tool_holder_type
   use lopin_block, only : block_type, field_type, split_fields, field_real, get_parameter, &
      & complain
   use lopin_build_scene, only : scene_type
   use lopin_build_parts, only : placed
   implicit none
   private
   public :: build_tool

contains

   subroutine build_tool(k, model, scene, block, scope, kind, name)
      integer, intent(out) :: k                      !! index of the tool; 0 after a complaint
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      character(len=*), intent(in) :: kind, name     !! kind: SEGMENTS, CYLINDER or REVOLUTION
      type(segment_card_type), allocatable :: cards(:)
      type(tool_holder_type) :: holder
      type(error_type), allocatable :: error
      real(wp), allocatable :: frame(:, :)
      real(wp) :: fillet
      integer :: i, complaints

      k = 0
      complaints = model%log%n
      call read_fillet(block, fillet, model)
      call read_cards(block, kind, cards, frame, model)
      if (model%log%n > complaints) return
      if (scope > 0) call place(scene, scope, kind, cards, frame)
      call new_tool_from_segments(holder%shape, kind, frame, cards, fillet, block%at, error)
      if (allocated(error)) then
         do i = 1, size(error%item)
            if (error%item(i)%at%file == 0) error%item(i)%at = block%at
            call complain(model%log, error%item(i)%id, error%item(i)%message, error%item(i)%at, &
               & label=error%item(i)%label, note=error%item(i)%note, help=error%item(i)%help)
         end do
         return
      end if
      if (holder%shape%ndim /= model%mesh%ndim) then
         call complain(model%log, 'E0314', 'TYPE='//kind//' makes a tool of '//merge('2', '3', &
            & holder%shape%ndim == 2)//' dimensions; the mesh has ' &
            & //merge('2', '3', model%mesh%ndim == 2), block%at, &
            & help='SEGMENTS in two dimensions, CYLINDER or REVOLUTION in three')
         return
      end if
      holder%name = name
      model%tool = [model%tool, holder]
      k = size(model%tool)
   end subroutine build_tool

   subroutine read_fillet(block, fillet, model)
      type(block_type), intent(in) :: block
      real(wp), intent(out) :: fillet
      type(model_type), intent(inout) :: model
      type(field_type) :: field
      logical :: found

      fillet = 0.0_wp
      call get_parameter(block, 'FILLET RADIUS', field%text, field%at, found)
      if (found) call field_real(field, fillet, model%log, found)
   end subroutine read_fillet

   !> Lines of three or more numbers before START are points of the frame.
   subroutine read_cards(block, kind, cards, frame, model)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: kind
      type(segment_card_type), allocatable, intent(out) :: cards(:)
      real(wp), allocatable, intent(out) :: frame(:, :)
      type(model_type), intent(inout) :: model
      type(field_type), allocatable :: field(:)
      type(segment_card_type) :: card
      real(wp) :: point(3, 4)
      real(wp) :: value
      integer :: j, i, n, npoint
      logical :: found, started

      allocate (cards(0))
      npoint = 0
      started = .false.
      point = 0.0_wp
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         started = started .or. upper(field(1)%text) == 'START'
         if (started) then
            card = segment_card_type(word=upper(field(1)%text), at=field(1)%at)
            do i = 2, min(5, n)
               call field_real(field(i), card%value(i - 1), model%log, found)
            end do
            cards = [cards, card]
            cycle
         end if
         do i = 1, min(n, 6)
            call field_real(field(i), value, model%log, found)
            if (npoint + (i - 1)/3 < 4) point(mod(i - 1, 3) + 1, npoint + (i - 1)/3 + 1) = value
         end do
         npoint = min(4, npoint + (n + 2)/3)
      end do
      select case (kind)
      case ('REVOLUTION')
         frame = point(:, :2*(npoint/2))
      case ('CYLINDER')
         frame = point(:, :merge(3, 0, npoint >= 3))
      case default
         frame = point(:, :0)
      end select
      if (.not. started) call complain(model%log, 'E0314', &
         & 'the profile of a tool begins with START, x, y', block%at)
   end subroutine read_cards

   !> Move a tool with the instance of its part.
   subroutine place(scene, scope, kind, cards, frame)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: scope
      character(len=*), intent(in) :: kind
      type(segment_card_type), intent(inout) :: cards(:)
      real(wp), allocatable, intent(inout) :: frame(:, :)
      real(wp) :: x(3)
      integer :: i, j

      if (kind == 'SEGMENTS') then
         do i = 1, size(cards)
            do j = 1, 3, 2
               x = placed(scene, scope, [cards(i)%value(j:j + 1), 0.0_wp])
               cards(i)%value(j:j + 1) = x(:2)
            end do
         end do
         return
      end if
      ! A frame that the deck leaves out is written down, so that it can be moved.
      if (size(frame, 2) == 0 .and. kind == 'CYLINDER') frame = reshape([0.0_wp, 0.0_wp, 0.0_wp, &
         & 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      if (size(frame, 2) == 0) frame = reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], &
         & [3, 2])
      do i = 1, size(frame, 2)
         frame(:, i) = placed(scene, scope, frame(:, i))
      end do
   end subroutine place
end module lopin_build_tools
