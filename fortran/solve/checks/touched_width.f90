!> How wide the part of a tool or of a master is that a closed node of a slave meets, from where it
!> leaves the plane of contact along the edges about that node.
module lopin_touched_width
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : log_type
   use lopin_facets, only : facets_type
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: touch_type, find_closed, leave_narrow, number_closed, find_narrowest, say_narrow
   public :: left, most_edges, steps

   !> A tool has left the plane in which it meets a node where it stands off by this share of an
   !> edge: a corner does so at once, a radius as large as the edge does not.
   real(wp), parameter :: left = 0.2_wp
   !> A part of a tool narrower than this share of the facets beside is narrow.
   real(wp), parameter :: narrow = 0.9_wp
   !> Contact is wide where a node in it has so many rings of closed nodes about it.
   integer, parameter :: wide = 2
   !> Samples of an edge.
   integer, parameter :: steps = 20
   !> Edges that leave a node by a larger angle than 120 degrees are opposite.
   real(wp), parameter :: opposite = -0.5_wp
   real(wp), parameter :: on_axis = 1.0e-10_wp   !! of the largest radius
   integer, parameter :: most_edges = 16

   !> The tool about a closed node along the edges that leave it.
   type :: touch_type
      integer :: n = 0
      real(wp) :: way(3, most_edges) = 0.0_wp     !! unit vectors
      real(wp) :: length(most_edges) = 0.0_wp     !! [length]
      real(wp) :: flat(most_edges) = 0.0_wp       !! of it, from the node, opposite the same plane
      logical :: ends(most_edges) = .false.       !! the tool leaves that plane on the way
   end type touch_type

contains

   !> Nodes of a pair's slave that are pressed.
   subroutine find_closed(scene, pair, closed)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: pair
      logical, intent(out) :: closed(:)        !! (nnode)
      integer :: i

      closed = .false.
      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            do i = 1, c%n
               if (c%pair(i) == pair .and. c%status(i) > 0) closed(c%node(i)) = .true.
            end do
         end associate
         return
      end if
      do i = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
         if (scene%answer%force(i) > 0.0_wp) closed(scene%points%node(scene%rows%point(i))) = .true.
      end do
   end subroutine find_closed

   !> Leave of closed nodes those that no wide contact has, with the rings about the innermost of
   !> them: 0 if no facet is closed.
   pure subroutine leave_narrow(facets, closed, depth)
      type(facets_type), intent(in) :: facets
      logical, intent(inout) :: closed(:)      !! (nnode)
      integer, intent(out) :: depth
      logical :: inner(size(closed)), more(size(closed))
      integer :: ring, i

      inner = closed
      depth = 0
      do ring = 1, wide
         more = inner
         do i = 1, facets%n
            associate (node => facets%node(:facets%nnode(i), i))
               if (.not. all(inner(node))) more(node) = .false.
            end associate
         end do
         if (any(inner .and. .not. more)) depth = ring - 1
         inner = more
      end do
      ! What is left spreads over the contact that it is the middle of.
      do while (any(inner))
         closed = closed .and. .not. inner
         more = inner
         inner = .false.
         do i = 1, facets%n
            associate (node => facets%node(:facets%nnode(i), i))
               if (any(more(node))) inner(node) = inner(node) .or. closed(node)
            end associate
         end do
      end do
   end subroutine leave_narrow

   !> Closed nodes numbered, with room for what lies opposite each.
   pure subroutine number_closed(closed, touch, place)
      logical, intent(in) :: closed(:)         !! (nnode)
      type(touch_type), allocatable, intent(out) :: touch(:)   !! (closed nodes)
      integer, intent(out) :: place(:)         !! (nnode) in `touch`; 0: open
      integer :: node, n

      place = 0
      n = 0
      do node = 1, size(closed)
         if (.not. closed(node)) cycle
         n = n + 1
         place(node) = n
      end do
      allocate (touch(n))
   end subroutine number_closed

   !> The closed node that meets the narrowest part.
   pure subroutine find_narrowest(touch, place, axisymmetric, x, node, width)
      type(touch_type), intent(in) :: touch(:)
      integer, intent(in) :: place(:)          !! (nnode) in `touch`; 0: open
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) present places [length]
      integer, intent(out) :: node             !! 0: none meets a narrow one
      real(wp), intent(out) :: width           !! of what it meets [facets]
      real(wp) :: share
      integer :: i

      node = 0
      width = narrow
      do i = 1, size(place)
         if (place(i) == 0) cycle
         share = width_of(touch(place(i)), axisymmetric .and. &
            & abs(x(1, i)) <= on_axis*maxval(abs(x(1, :))))
         if (share >= width) cycle
         width = share
         node = i
      end do
   end subroutine find_narrowest

   !> Warns of it.
   subroutine say_narrow(log, model, pair, node, width, code, remedy)
      type(log_type), intent(inout) :: log
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, node
      real(wp), intent(in) :: width            !! [facets]
      character(len=*), intent(in) :: code, remedy

      associate (p => model%pair(pair))
         call warn_once(log, code, model%surface(p%master)%name//' meets '// &
            & model%surface(p%slave)%name//' at node '//to_text(model%mesh%node_label(node))// &
            & ' over about '//to_text(100.0_wp*width, 2)//' % of a facet, narrower than the '// &
            & 'facets there, and presses as if over a whole one', p%at, help=remedy)
      end associate
   end subroutine say_narrow

   !> Least width of the part of the tool that a node meets, in facets; 1 where it does not end on
   !> both sides.
   pure real(wp) function width_of(touch, mirrored) result(width)
      type(touch_type), intent(in) :: touch
      logical, intent(in) :: mirrored          !! on the axis: the other side is the mirrored one
      integer :: a, b

      width = 1.0_wp
      do a = 1, touch%n
         if (.not. touch%ends(a)) cycle
         if (mirrored) width = min(width, 2.0_wp*(touch%flat(a)/touch%length(a) - left))
         do b = 1, a - 1
            if (.not. touch%ends(b)) cycle
            if (dot_product(touch%way(:, a), touch%way(:, b)) > opposite) cycle
            width = min(width, 2.0_wp*((touch%flat(a) + touch%flat(b)) &
               & /(touch%length(a) + touch%length(b)) - left))
         end do
      end do
      width = max(width, 0.0_wp)
   end function width_of
end module lopin_touched_width
