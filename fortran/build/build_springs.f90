!> `*SPRING` and `*GAP`: elements SPRINGA, SPRING1, SPRING2 and GAPUNI, which are no part of the
!> mesh. A gap is a spring that only presses.
module lopin_build_springs
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type
   use lopin_text, only : to_text
   use lopin_model, only : model_type, spring_type
   use lopin_mesh, only : find_label
   use lopin_block, only : deck_type, block_type, data_line_type, field_type, split_fields, &
      & complain, has_parameter, line_place
   use lopin_build_scene, only : scene_type, name_type, need_word, get_word, need_integer, &
      & need_real, find_name, no_such
   implicit none
   private
   public :: build_springs, is_spring, spring_labels

   character(len=*), parameter :: words(4) = ['SPRINGA', 'SPRING1', 'SPRING2', 'GAPUNI ']

   !> Stiffness of a gap for which the deck has none, beside the largest modulus times the size of
   !> the scene.
   real(wp), parameter :: stiff_gap = 1.0e3_wp

   !> What the springs of two cards have in common.
   type :: kind_type
      type(spring_type) :: law
      integer :: dof(2) = 0                    !! of the first and the second node of the deck
      character(len=:), allocatable :: word
   end type kind_type

contains

   !> An element word of springs.
   pure logical function is_spring(word)
      character(len=*), intent(in) :: word
      is_spring = any(words == word)
   end function is_spring

   !> Numbers of all spring elements: sets may name them.
   function spring_labels(deck, scene) result(label)
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, allocatable :: label(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      type(field_type), allocatable :: field(:)
      type(log_type) :: deaf
      integer :: k, j, n, number
      logical :: found

      allocate (label(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'ELEMENT') cycle
            call get_word(block, 'TYPE', word, at, found)
            if (.not. found) cycle
            if (.not. is_spring(word)) cycle
            do j = 1, block%nline
               call split_fields(block%line(j), field, n)
               if (n == 0) cycle
               call need_integer(field(1), number, deaf, found)
               if (found) label = [label, number + scene%element_offset(scene%card(k)%scope)]
            end do
         end associate
      end do
   end function spring_labels

   !> The springs of all *SPRING cards: those of the *ELEMENT cards that name the same set.
   subroutine build_springs(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(name_type), allocatable :: names(:)
      logical, allocatable :: used(:)
      character(len=:), allocatable :: name, word
      type(location_type) :: at
      integer :: k, e
      logical :: found, any_here

      allocate (model%spring(0), names(0), used(scene%ncard))
      used = .false.
      do k = 1, scene%ncard
         associate (card => deck%block(scene%card(k)%block))
            if (card%keyword /= 'SPRING' .and. card%keyword /= 'GAP') cycle
            call need_word(card, 'ELSET', name, at, found, model%log)
            if (.not. found) cycle
            any_here = .false.
            do e = 1, scene%ncard
               call spring_card(e, word, found)
               if (.not. found) cycle
               names = [names, name_type(word)]
               if (word /= name) cycle
               any_here = .true.
               used(e) = .true.
               call add_springs(model, deck, scene, e, card)
            end do
            if (.not. any_here) call no_such(model%log, 'set of spring elements', name, names, at)
         end associate
      end do
      do e = 1, scene%ncard
         call spring_card(e, word, found)
         if (found .and. .not. used(e)) call missing_card(model%log, deck%block( &
            & scene%card(e)%block), word)
      end do

   contains

      !> Whether a card holds spring elements, and the set that they are in.
      subroutine spring_card(e, word, found)
         integer, intent(in) :: e
         character(len=:), allocatable, intent(out) :: word
         logical, intent(out) :: found
         character(len=:), allocatable :: type_
         type(location_type) :: there

         word = ''
         associate (block => deck%block(scene%card(e)%block))
            found = block%keyword == 'ELEMENT'
            if (found) call get_word(block, 'TYPE', type_, there, found)
            if (found) found = is_spring(type_)
            if (.not. found) return
            call get_word(block, 'ELSET', word, there, found)
            if (.not. found) word = ''
            found = .true.
         end associate
      end subroutine spring_card
   end subroutine build_springs

   !> Elements without the card that says what they are: *SPRING, or *GAP of GAPUNI.
   subroutine missing_card(log, block, set)
      type(log_type), intent(inout) :: log
      type(block_type), intent(in) :: block     !! *ELEMENT
      character(len=*), intent(in) :: set
      character(len=:), allocatable :: word, card, what
      type(location_type) :: at
      logical :: found

      call get_word(block, 'TYPE', word, at, found)
      card = '*SPRING'
      what = 'spring elements'
      if (word == 'GAPUNI') then
         card = '*GAP'
         what = 'gap elements'
      end if
      if (len(set) == 0) then
         call complain(log, 'E0203', what//' are in no set', block%at, help='ELSET= on this '// &
            & 'card, and '//card//' with the same ELSET')
         return
      end if
      call complain(log, 'E0203', what//' of `'//set//'` have no '//card, block%at, &
         & help=card//', ELSET='//set//' with the ELSET of their *ELEMENT card')
   end subroutine missing_card

   !> The springs of one *ELEMENT card, by one *SPRING card.
   subroutine add_springs(model, deck, scene, e, card)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: e                  !! card of the elements
      type(block_type), intent(in) :: card      !! *SPRING
      type(location_type) :: at
      type(kind_type) :: kind
      type(spring_type) :: new
      integer :: j
      logical :: found

      associate (block => deck%block(scene%card(e)%block))
         call get_word(block, 'TYPE', kind%word, at, found)
         if ((kind%word == 'GAPUNI') .neqv. card%keyword == 'GAP') then
            call complain(model%log, 'E0203', '*'//card%keyword//' cannot describe elements '// &
               & kind%word, card%at, help='*SPRING goes with SPRINGA, SPRING1, SPRING2; *GAP '// &
               & 'with GAPUNI')
            return
         end if
         kind%law%axial = kind%word == 'SPRINGA'
         if (kind%word == 'GAPUNI') then
            call read_gap(kind%law, card, model)
         else
            call read_law(kind%law, kind%dof, card, kind%word, model%mesh%ndim, model%log)
         end if
         do j = 1, block%nline
            call read_nodes(new, kind, model, scene, scene%card(e)%scope, block%line(j), found)
            if (found) model%spring = [model%spring, new]
         end do
      end associate
   end subroutine add_springs

   !> Dofs on the first line (none or a blank line with SPRINGA), then the stiffness or a table.
   subroutine read_law(law, dof, card, word, ndim, log)
      type(spring_type), intent(inout) :: law
      integer, intent(out) :: dof(2)
      type(block_type), intent(in) :: card
      character(len=*), intent(in) :: word
      integer, intent(in) :: ndim
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      type(data_line_type), allocatable :: line(:)
      integer :: j, i, n, first
      logical :: found

      law%at = card%at
      dof = 0
      allocate (line(0))
      do j = 1, card%nline
         call split_fields(card%line(j), field, n)
         if (n > 0) found = any([(len(field(i)%text) > 0, i=1, n)])
         if (n == 0) found = .false.
         if (found) line = [line, card%line(j)]
      end do
      first = 1
      if (.not. law%axial .and. size(line) > 0) then
         first = 2
         call split_fields(line(1), field, n)
         do i = 1, merge(2, 1, word == 'SPRING2')
            if (i > n) exit
            call need_integer(field(i), dof(i), log, found)
            if (found .and. (dof(i) < 1 .or. dof(i) > ndim)) call complain(log, 'E0404', 'dof '// &
               & to_text(dof(i))//' of a spring is not a displacement', field(i)%at, &
               & help='1 to '//to_text(ndim)//'; nodes of solids do not turn')
         end do
         if (word == 'SPRING2' .and. n < 2) dof(2) = dof(1)
      end if
      if (size(line) < first) then
         call complain(log, 'E0103', '*SPRING has no stiffness', card%at, help=trim(merge( &
            & 'SPRINGA: a blank line, then the stiffness        ', &
            & 'a line with the dof, then one with the stiffness ', law%axial)))
         law%stiffness = 1.0_wp
         return
      end if
      if (has_parameter(card, 'NONLINEAR')) then
         call read_table(law, line(first:), log)
      else
         call split_fields(line(first), field, n)
         call need_real(field(1), law%stiffness, log, found)
         if (found .and. .not. law%stiffness > 0.0_wp) call complain(log, 'E0106', &
            & 'the stiffness of a spring is above 0', field(1)%at)
      end if
   end subroutine read_law

   !> `clearance, nx, ny, nz, area, stiffness`: it presses where the second node has come nearer to
   !> the first along n than the clearance.
   subroutine read_gap(law, card, model)
      type(spring_type), intent(inout) :: law
      type(block_type), intent(in) :: card
      type(model_type), intent(inout) :: model
      type(field_type), allocatable :: field(:)
      real(wp) :: value(6), wide
      integer :: i, n
      logical :: found

      law%at = card%at
      value = 0.0_wp
      n = 0
      if (card%nline > 0) call split_fields(card%line(1), field, n)
      do i = 1, min(6, n)
         if (len(field(i)%text) > 0) call need_real(field(i), value(i), model%log, found)
      end do
      if (.not. norm2(value(2:4)) > 0.0_wp) then
         call complain(model%log, 'E0103', '*GAP needs a clearance and a direction', card%at, &
            & help='0., 1., 0., 0.: no clearance, along x from the first node to the second')
         value(2) = 1.0_wp
      end if
      wide = norm2(maxval(model%mesh%x, dim=2) - minval(model%mesh%x, dim=2))
      if (.not. value(6) > 0.0_wp) value(6) = stiff_gap*wide*maxval([0.0_wp, model%material%young])
      law%direction = spread(value(2:4)/norm2(value(2:4)), 2, 2)
      allocate (law%table(2, 3))
      law%table(:, 1) = [-value(6)*wide, -value(1) - wide]
      law%table(:, 2) = [0.0_wp, -value(1)]
      law%table(:, 3) = [0.0_wp, max(wide, wide - value(1))]
   end subroutine read_gap

   subroutine read_table(law, line, log)
      type(spring_type), intent(inout) :: law
      type(data_line_type), intent(in) :: line(:)
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: j, i, n
      logical :: found

      allocate (law%table(2, size(line)), source=0.0_wp)
      do j = 1, size(line)
         call split_fields(line(j), field, n)
         if (n < 2) then
            call complain(log, 'E0103', 'a point of a spring is a force and an extension', &
               & line_place(line(j)))
            return
         end if
         do i = 1, 2
            call need_real(field(i), law%table(i, j), log, found)
         end do
         if (j == 1) cycle
         if (law%table(2, j) > law%table(2, j - 1) .and. law%table(1, j) >= law%table(1, j - 1)) &
            & cycle
         call complain(log, 'E0106', 'the table of a spring does not increase', &
            & line_place(line(j)), help='force, extension: extensions grow from line to line, '// &
            & 'forces do not fall')
         return
      end do
      if (size(line) < 2) call complain(log, 'E0103', 'the table of a spring has two points or '// &
         & 'more', line_place(line(1)))
   end subroutine read_table

   !> One element: a number and its nodes.
   subroutine read_nodes(new, kind, model, scene, scope, line, ok)
      type(spring_type), intent(out) :: new
      type(kind_type), intent(in) :: kind
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: scope
      type(data_line_type), intent(in) :: line
      logical, intent(out) :: ok
      type(field_type), allocatable :: field(:)
      integer :: k, n, number, nnode

      new = kind%law
      call split_fields(line, field, n)
      ok = .false.
      if (n == 0) return
      nnode = merge(1, 2, kind%word == 'SPRING1')
      if (n < nnode + 1) then
         call complain(model%log, 'E0208', kind%word//' has '//to_text(nnode)//' node'// &
            & trim(merge(' ', 's', nnode == 1)), line_place(line))
         return
      end if
      do k = 1, nnode
         call need_integer(field(k + 1), number, model%log, ok)
         if (.not. ok) return
         ! A spring extends by the first less the second, a gap opens by the second less the first.
         associate (node => new%node(merge(k, 3 - k, kind%word == 'GAPUNI')))
            node = find_label(model%mesh%node_label, model%mesh%node_order, &
               & number + scene%node_offset(scope))
            if (node == 0) call complain(model%log, 'E0202', 'node '//to_text(number)// &
               & ' of a spring does not exist', field(k + 1)%at)
            ok = node > 0
            if (.not. ok) return
            if (kind%dof(k) > 0) new%direction(:, 3 - k) = axis_of(model, node, kind%dof(k))
         end associate
      end do
      if (.not. new%axial) return
      new%direction(:model%mesh%ndim, 1) = model%mesh%x(:, new%node(2)) &
         & - model%mesh%x(:, new%node(1))
      ok = norm2(new%direction) > 0.0_wp
      if (ok) new%direction = spread(new%direction(:, 1)/norm2(new%direction(:, 1)), 2, 2)
      if (.not. ok) call complain(model%log, 'E0208', 'the nodes of a SPRINGA are at one '// &
         & 'place: it has no direction', line_place(line), help='SPRING2 acts between two dofs')
   end subroutine read_nodes

   !> Direction of a dof of a node, in its own axes if it has them.
   pure function axis_of(model, node, dof) result(axis)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node, dof
      real(wp) :: axis(3)
      integer :: k

      axis = 0.0_wp
      if (dof < 1 .or. dof > 3) return
      axis(dof) = 1.0_wp
      if (.not. allocated(model%transform%node)) return
      k = findloc(model%transform%node, node, dim=1)
      if (k > 0) axis = model%transform%axes(dof, :, k)
   end function axis_of
end module lopin_build_springs
