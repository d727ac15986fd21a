!> Tools that are narrower than the facets of their slaves: rows sample the gap at nodes, so a rib,
!> an edge or a radius between them is not seen, and under a single node it counts as a whole facet.
!>
!> Looked at where a step ends, on the present shape, near what is closed.
module lopin_narrow_tools
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type, cell_family
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, facet_rule_type, new_facets, new_facet_rules
   use lopin_tool, only : foot_type
   use lopin_model, only : model_type
   use lopin_flat_elements, only : is_ring
   use lopin_scene, only : scene_type
   use lopin_placed_tool, only : placed_tool_type, find_places, place_tool, gap_at, faces_a_tool, &
      & distance_at
   use lopin_present_gaps, only : gap_of
   use lopin_touched_width, only : touch_type, find_closed, number_closed, find_narrowest, &
      & say_narrow, left, most_edges, steps
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_narrow_tools, open_by, too_deep

   !> Nodes that are open by more, in facets, do not see what is inside.
   real(wp), parameter :: open_by = 0.05_wp
   !> What goes in deeper between nodes that touch, in facets, is more than the bend of a radius.
   real(wp), parameter :: too_deep = 0.15_wp
   !> Samples of a facet in each direction.
   integer, parameter :: parts = 10
   real(wp), parameter :: shallow = 0.01_wp     !! of a facet: finer parts that go in by less
   real(wp), parameter :: finest = 0.015_wp      !! of a facet: narrower parts are not found
   real(wp), parameter :: rounding = 1.0e-6_wp   !! of a facet: nothing goes in by less

contains

   subroutine check_narrow_tools(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(cell_type), allocatable :: cells(:)
      type(facet_rule_type), allocatable :: rules(:)
      type(facets_type) :: facets
      type(placed_tool_type) :: stand
      real(wp) :: x(model%mesh%ndim, model%mesh%nnode)
      logical :: closed(model%mesh%nnode)
      integer :: pair

      allocate (rules(6))
      call cells_of_words(model%element_word, cells)
      call new_facet_rules(rules)
      do pair = 1, size(model%pair)
         if (.not. faces_a_tool(scene, model, pair)) cycle
         associate (slave => model%surface(model%pair(pair)%slave))
            call new_facets(facets, model%mesh, cells, slave%element, slave%face)
            call find_places(scene, model, x)
            call find_closed(scene, pair, closed)
            call place_tool(stand, scene, model, pair, scene%trial%motion%u)
            if (.not. scene%newton%in_use) call find_inside(scene, model, pair, x, stand)
            call find_between(scene, model, pair, facets, rules, x, stand, closed)
            if (any(closed)) call find_beside(scene, model, pair, facets, rules, x, stand, closed)
         end associate
      end do
   end subroutine check_narrow_tools

   !> On the linear paths a node goes where its row sends it: to another side of the tool than the
   !> one that it meets there, if that was nearer from where the node was at the start.
   subroutine find_inside(scene, model, pair, x, stand)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: x(:, :)
      type(placed_tool_type), intent(in) :: stand
      type(foot_type) :: foot
      real(wp) :: depth, deepest
      integer :: i, worst

      worst = 0
      deepest = open_by
      do i = scene%points%first(pair), scene%points%first(pair + 1) - 1
         if (scene%points%facet(i) == 0) cycle
         associate (size_ => scene%points%size(i))
            call stand%shape%project(stand%motion%to_tool(x(:, scene%points%node(i))), foot)
            if (.not. foot%found .or. foot%overhang > stand%extension*size_) cycle
            depth = (min(gap_of(scene, model, i), 0.0_wp) - foot%gap)/size_
         end associate
         if (depth <= deepest) cycle
         deepest = depth
         worst = i
      end do
      if (worst == 0) return
      associate (p => model%pair(pair))
         call warn_once(scene%log, 'W0338', 'node '// &
            & to_text(model%mesh%node_label(scene%points%node(worst)))//' of '// &
            & model%surface(p%slave)%name//' ends inside '//model%surface(p%master)%name// &
            & ' by '//to_text(100.0_wp*deepest, 2)//' % of a facet: from its place at the '// &
            & 'start it was sent to another side of the tool', p%at, &
            & help='*LOPIN, PATH=FINITE follows the slave; or give the tool a shorter way')
      end associate
   end subroutine find_inside

   !> Length of a facet between neighbouring nodes.
   pure real(wp) function span(cell, x)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)
      integer :: k

      span = 0.0_wp
      do k = 1, cell%ncorner
         span = max(span, norm2(x(:, 1 + mod(k, cell%ncorner)) - x(:, k)))
      end do
      if (cell%quadratic) span = 0.5_wp*span
   end function span

   !> A part of a tool that goes into a facet deeper than all its nodes.
   subroutine find_between(scene, model, pair, facets, rules, x, stand, closed)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(facets_type), intent(in) :: facets
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)
      type(placed_tool_type), intent(in) :: stand
      logical, intent(in) :: closed(:)         !! (nnode)
      real(wp) :: deepest, least, lowest, long
      integer :: i, k, worst

      deepest = 0.0_wp
      worst = 0
      do i = 1, facets%n
         associate (cell => rules(facets%cell(i))%cell, node => facets%node(:facets%nnode(i), i), &
            & d => size(x, 1))
            long = span(cell, x(:, node))
            if (.not. is_close(stand, x(:, node), long)) cycle
            ! A node on a corner of the tool may face none of its sides.
            least = merge(0.0_wp, huge(1.0_wp), any(closed(node)))
            do k = 1, size(node)
               least = min(least, gap_at(stand, cell, x(:, node), cell%xi(:d - 1, k), long, &
                  & .false.))
            end do
            ! Between nodes that touch, in space, nothing finer than the places is looked for.
            lowest = lowest_inside(stand, cell, x(:, node), long, merge(finest, 1.0_wp, d == 2 &
               & .or. least > open_by*long))
            if (lowest >= -rounding*long) cycle
            if (least <= open_by*long .and. least - lowest <= too_deep*long) cycle
            if (-lowest/long <= deepest) cycle
            deepest = -lowest/long
            worst = i
         end associate
      end do
      if (worst == 0) return
      associate (p => model%pair(pair))
         call warn_once(scene%log, 'W0337', model%surface(p%master)%name//' goes into face S'// &
            & to_text(facets%face(worst))//' of element '// &
            & to_text(model%mesh%element_label(facets%element(worst)))//' of '// &
            & model%surface(p%slave)%name//' where no node sees it, by '// &
            & to_text(100.0_wp*deepest, 2)//' % of a facet', p%at, help=remedy())
      end associate
   end subroutine find_between

   pure function remedy() result(text)
      character(len=:), allocatable :: text
      text = 'finer facets of the slave there: two at least under each rib, edge or radius'
   end function remedy

   !> Some node is nearer to the tool than two facets.
   pure logical function is_close(stand, x, long)
      type(placed_tool_type), intent(in) :: stand
      real(wp), intent(in) :: x(:, :), long
      type(foot_type) :: foot
      integer :: k

      is_close = .false.
      do k = 1, size(x, 2)
         call stand%shape%project(stand%motion%to_tool(x(:, k)), foot)
         is_close = foot%found .and. abs(foot%gap) < 2.0_wp*long
         if (is_close) return
      end do
   end function is_close

   !> The least gap inside a facet.
   real(wp) function lowest_inside(stand, cell, x, long, finest) result(lowest)
      type(placed_tool_type), intent(in) :: stand
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :), long
      real(wp), intent(in) :: finest           !! part of the facet that is divided no more
      integer :: i, j

      lowest = huge(1.0_wp)
      do i = 1, parts
         do j = 1, merge(1, parts, size(x, 1) == 2)
            lowest = min(lowest, lowest_about(stand, cell, x, long, finest, &
               & ([i, j] - 0.5_wp)/parts, 1.0_wp/parts))
         end do
      end do
   end function lowest_inside

   !> The least gap of a part of a facet: divided where the tool is nearer than its rim, so that
   !> nothing between two places is passed over.
   recursive real(wp) function lowest_about(stand, cell, x, long, finest, at, share) result(lowest)
      type(placed_tool_type), intent(in) :: stand
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :), long, finest
      real(wp), intent(in) :: at(2)            !! middle of the part, the facet in [0, 1]
      real(wp), intent(in) :: share            !! of the facet's edges
      real(wp) :: xi(2)
      integer :: i, j, d

      d = size(x, 1)
      lowest = huge(1.0_wp)
      xi = 2.0_wp*at - 1.0_wp
      if (cell%family == cell_family%triangle) then
         if (sum(at) >= 1.0_wp) return
         xi = at
      end if
      lowest = gap_at(stand, cell, x, xi(:d - 1), long, .true.)
      ! Beside a node that an edge let slip, the edge cuts the facet by a little.
      if (parts*share < 0.9_wp .and. lowest > -shallow*long) lowest = max(lowest, 0.0_wp)
      if (share <= finest) return
      if (distance_at(stand, cell, x, xi(:d - 1)) > 0.6_wp*share*norm2(maxval(x, 2) - minval(x, &
         & 2))) return
      do i = -1, 1, 2
         do j = -1, merge(-1, 1, d == 2), 2
            lowest = min(lowest, lowest_about(stand, cell, x, long, finest, &
               & at + 0.25_wp*share*[i, j], 0.5_wp*share))
         end do
      end do
   end function lowest_about

   !> A closed node opposite a part of the tool that is narrower than a facet.
   subroutine find_beside(scene, model, pair, facets, rules, x, stand, closed)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(facets_type), intent(in) :: facets
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)
      type(placed_tool_type), intent(in) :: stand
      logical, intent(in) :: closed(:)
      type(touch_type), allocatable :: touch(:)
      integer :: place(size(closed)), worst
      real(wp) :: least

      call number_closed(closed, touch, place)
      call follow_edges(touch, place, facets, rules, x, stand)
      call find_narrowest(touch, place, is_ring(model, model%pair(pair)%slave), x, &
         & worst, least)
      if (worst > 0) call say_narrow(scene%log, model, pair, worst, least, 'W0337', remedy())
   end subroutine find_beside

   !> How far the tool stays in the plane that a closed node meets, along every edge from there.
   subroutine follow_edges(touch, place, facets, rules, x, stand)
      type(touch_type), intent(inout) :: touch(:)
      integer, intent(in) :: place(:)          !! (nnode) in `touch`; 0: open
      type(facets_type), intent(in) :: facets
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)
      type(placed_tool_type), intent(in) :: stand
      integer :: i, k, a, b, mid

      do i = 1, facets%n
         associate (cell => rules(facets%cell(i))%cell, node => facets%node(:facets%nnode(i), i))
            if (all(place(node) == 0)) cycle
            do k = 1, merge(1, cell%ncorner, size(x, 1) == 2)
               a = cell%edge(1, k)
               b = cell%edge(2, k)
               mid = merge(cell%ncorner + k, 0, cell%quadratic)
               if (mid == 0) then
                  call follow(a, b)
                  call follow(b, a)
               else
                  call follow(a, mid)
                  call follow(mid, a)
                  call follow(b, mid)
                  call follow(mid, b)
               end if
            end do
         end associate
      end do

   contains

      subroutine follow(from, to)
         integer, intent(in) :: from, to
         real(wp) :: long, start, t, gap, normal(size(x, 1)), way(size(x, 1))
         integer :: j, d

         d = size(x, 1)
         associate (cell => rules(facets%cell(i))%cell, node => facets%node(:facets%nnode(i), i))
            if (place(node(from)) == 0) return
            associate (own => touch(place(node(from))))
               if (own%n == most_edges) return
               way = x(:, node(to)) - x(:, node(from))
               long = norm2(way)
               start = gap_at(stand, cell, x(:, node), cell%xi(:d - 1, from), long, &
                  & .false., normal)
               if (start >= huge(1.0_wp)) return
               own%n = own%n + 1
               own%length(own%n) = long
               own%way(:d, own%n) = way/long
               do j = 1, steps
                  t = real(j, wp)/steps
                  gap = gap_at(stand, cell, x(:, node), (1.0_wp - t)*cell%xi(:d - 1, from) &
                     & + t*cell%xi(:d - 1, to), long, .false.)
                  ! Along a curved edge the chord will do: the tool is what is looked at.
                  own%ends(own%n) = gap > start + t*dot_product(normal, way) + left*long
                  if (own%ends(own%n)) exit
                  own%flat(own%n) = t*long
               end do
            end associate
         end associate
      end subroutine follow
   end subroutine follow_edges
end module lopin_narrow_tools
