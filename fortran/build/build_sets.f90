!> Node and element sets: names first, members second, so that a set may name one that comes later.
module lopin_build_sets
   use lopin_error, only : location_type, log_type
   use lopin_text, only : parse_integer, to_text
   use lopin_mesh, only : set_type, find_label, find_set
   use lopin_model, only : model_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_integer, &
      & complain, has_parameter
   use lopin_build_scene, only : scene_type, list_type, push, scoped, split_prefix, get_word, &
      & need_word, set_named, find_name, name_type, no_such
   use lopin_build_springs, only : spring_labels, is_spring
   implicit none
   private
   public :: build_sets

   !> One family of sets while it is being resolved.
   type :: family_type
      character(len=:), allocatable :: what           !! 'node' or 'element'
      character(len=:), allocatable :: own, word      !! NSET, NODE / ELSET, ELEMENT
      integer, allocatable :: label(:), order(:), offset(:)
      integer, allocatable :: other(:)                !! elements that are no part of the mesh
      type(set_type), allocatable :: set(:)
      type(location_type), allocatable :: at(:)       !! first definition
      type(list_type), allocatable :: card(:)         !! cards that add to each set
      integer, allocatable :: state(:)                !! 0: to do, 1: being resolved, 2: done
   end type family_type

contains

   subroutine build_sets(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene

      call build_family(model, deck, scene, 'element', 'ELSET', 'ELEMENT')
      call build_family(model, deck, scene, 'node', 'NSET', 'NODE')
   end subroutine build_sets

   subroutine build_family(model, deck, scene, what, own, word)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: what, own, word
      type(family_type) :: family
      integer :: i

      family%what = what
      family%own = own
      family%word = word
      if (what == 'node') then
         family%label = model%mesh%node_label
         family%order = model%mesh%node_order
         allocate (family%offset(0:size(scene%instance)), source=scene%node_offset)
      else
         family%label = model%mesh%element_label
         family%order = model%mesh%element_order
         allocate (family%offset(0:size(scene%instance)), source=scene%element_offset)
      end if
      if (what == 'element') family%other = spring_labels(deck, scene)
      if (what == 'node') allocate (family%other(0))
      call collect_names(family, deck, scene, model%log)
      do i = 1, size(family%set)
         call resolve(family, i, model, deck, scene)
      end do
      if (what == 'node') then
         call move_alloc(family%set, model%mesh%nset)
      else
         call move_alloc(family%set, model%mesh%elset)
      end if
   end subroutine build_family

   !> Which sets there are, and which cards add to each.
   subroutine collect_names(family, deck, scene, log)
      type(family_type), intent(inout) :: family
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: name
      type(set_type) :: new
      type(location_type) :: at
      type(list_type) :: empty
      integer :: k, i
      logical :: found

      allocate (family%set(0), family%at(0), family%card(0), new%member(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword == family%own) then
               call need_word(block, family%own, name, at, found, log)
            else if (block%keyword == family%word) then
               call get_word(block, family%own, name, at, found)
               found = found .and. len(name) > 0
            else
               cycle
            end if
            if (.not. found) cycle
            new%name = scoped(scene, scope, name)
            i = find_set(family%set, new%name)
            if (i == 0) then
               family%set = [family%set, new]
               family%at = [family%at, at]
               family%card = [family%card, empty]
               i = size(family%set)
            end if
            call push(family%card(i), k)
         end associate
      end do
      allocate (family%state(size(family%set)), source=0)
   end subroutine collect_names

   recursive subroutine resolve(family, i, model, deck, scene)
      type(family_type), intent(inout) :: family
      integer, intent(in) :: i
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(list_type) :: member
      integer :: j
      logical :: clean

      if (family%state(i) == 2) return
      family%state(i) = 1
      clean = .true.
      do j = 1, family%card(i)%n
         associate (card => scene%card(family%card(i)%item(j)))
            associate (block => deck%block(card%block))
               if (block%keyword == family%word) then
                  if (size(family%other) > 0) clean = clean .and. .not. holds_springs(block)
                  call take_labels(family, block, card%scope, scene, member)
               else
                  call take_card(family, block, card%scope, member, clean, model, deck, scene)
               end if
            end associate
         end associate
      end do
      call without_repetition(member, size(family%label), family%set(i)%member)
      if (member%n == 0 .and. clean) call complain(model%log, 'E0204', family%what//' set `' &
         & //family%set(i)%name//'` is empty', family%at(i), &
         & help='give it members, or remove it and what refers to it')
      family%state(i) = 2
   end subroutine resolve

   logical function holds_springs(block)
      type(block_type), intent(in) :: block
      character(len=:), allocatable :: word
      type(location_type) :: at

      call get_word(block, 'TYPE', word, at, holds_springs)
      if (holds_springs) holds_springs = is_spring(word)
   end function holds_springs

   !> Members of `*NODE, NSET=` or `*ELEMENT, ELSET=`.
   subroutine take_labels(family, block, scope, scene, member)
      type(family_type), intent(in) :: family
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(scene_type), intent(in) :: scene
      type(list_type), intent(inout) :: member
      type(field_type), allocatable :: field(:)
      integer :: j, n, number, comma, have, nnode
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: ok

      nnode = 0
      if (family%word == 'ELEMENT') then
         call get_word(block, 'TYPE', word, at, ok)
         do j = 1, size(scene%etype)
            if (trim(scene%etype(j)%word) == word) nnode = scene%etype(j)%nnode
         end do
      end if
      have = 0
      do j = 1, block%nline
         if (have == 0) then
            comma = index(block%line(j)%text//',', ',')
            call parse_integer(block%line(j)%text(:comma - 1), number, ok)
            if (ok) number = find_label(family%label, family%order, number + family%offset(scope))
            if (ok .and. number > 0) call push(member, number)
         end if
         if (nnode == 0) cycle
         call split_fields(block%line(j), field, n)
         have = have + n
         if (have > nnode) have = 0
      end do
   end subroutine take_labels

   !> Members of one `*NSET` or `*ELSET` card.
   recursive subroutine take_card(family, block, scope, member, clean, model, deck, scene)
      type(family_type), intent(inout) :: family
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(list_type), intent(inout) :: member
      logical, intent(inout) :: clean              !! turns false after a complaint
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: j, i, n, within
      logical :: found

      within = scope
      call find_instance(scene, block, within, model%log)
      if (family%own == 'NSET') then
         call get_word(block, 'ELSET', name, at, found)
         if (found) call take_nodes_of_elements(model, scene, name, within, at, member)
      end if
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         if (has_parameter(block, 'GENERATE')) then
            call generate(family, field(:n), within, member, clean, model%log)
            cycle
         end if
         do i = 1, n
            call take_field(family, field(i), within, member, clean, model, deck, scene)
         end do
      end do
   end subroutine take_card

   subroutine find_instance(scene, block, scope, log)
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(inout) :: scope
      type(log_type), intent(inout) :: log
      type(name_type), allocatable :: names(:)
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: i
      logical :: found

      call get_word(block, 'INSTANCE', name, at, found)
      if (.not. found) return
      allocate (names(size(scene%instance)))
      do i = 1, size(names)
         names(i)%text = scene%instance(i)%name
      end do
      i = find_name(names, name)
      if (i > 0) scope = i
      if (i == 0) call no_such(log, 'instance', name, names, at)
   end subroutine find_instance

   recursive subroutine take_field(family, field, scope, member, clean, model, deck, scene)
      type(family_type), intent(inout) :: family
      type(field_type), intent(in) :: field
      integer, intent(in) :: scope
      type(list_type), intent(inout) :: member
      logical, intent(inout) :: clean
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: rest
      integer :: number, within, k, i
      logical :: ok

      if (len(field%text) == 0) return
      call parse_integer(field%text, number, ok)
      within = scope
      if (.not. ok) then
         call split_prefix(scene, field%text, within, rest)
         call parse_integer(rest, number, ok)
      end if
      if (ok) then
         k = find_label(family%label, family%order, number + family%offset(within))
         if (k > 0) then
            call push(member, k)
         else if (any(family%other == number + family%offset(within))) then
            clean = .false.                        ! a spring: no part of the mesh
         else
            clean = .false.
            call complain(model%log, 'E0202', family%what//' '//to_text(number) &
               & //' does not exist; numbers run ' &
               & //range_of(family%label), field%at)
         end if
         return
      end if
      k = set_named(scene, family%set, family%what//' set', rest, within, field%at, model%log)
      if (k == 0) then
         clean = .false.
      else if (family%state(k) == 1) then
         clean = .false.
         call complain(model%log, 'E0204', family%what//' set `'//family%set(k)%name &
            & //'` contains itself', &
            & field%at, label='closes the circle')
      else
         call resolve(family, k, model, deck, scene)
         do i = 1, size(family%set(k)%member)
            call push(member, family%set(k)%member(i))
         end do
      end if
   end subroutine take_field

   pure function range_of(label) result(text)
      integer, intent(in) :: label(:)
      character(len=:), allocatable :: text

      text = 'nowhere'
      if (size(label) > 0) text = to_text(minval(label))//'-'//to_text(maxval(label))
   end function range_of

   !> `first, last, increment`: those of the numbers that exist.
   subroutine generate(family, field, scope, member, clean, log)
      type(family_type), intent(in) :: family
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: scope
      type(list_type), intent(inout) :: member
      logical, intent(inout) :: clean
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: shown
      type(location_type) :: at
      integer :: number(3), i, k, hits
      logical :: found

      number = [0, 0, 1]
      do i = 1, min(3, size(field))
         call field_integer(field(i), k, log, found)
         if (found) number(i) = k
         if (.not. found .and. len(field(i)%text) > 0) clean = .false.
      end do
      if (.not. clean) return
      if (size(field) == 1) number(2) = number(1)
      at = field(1)%at
      at%last = field(size(field))%at%last
      shown = to_text(number(1))//', '//to_text(number(2))//', '//to_text(number(3))
      if (number(3) < 1 .or. number(2) < number(1)) then
         clean = .false.
         call complain(log, 'E0204', 'GENERATE '//shown//' counts nothing', at, &
            & help='GENERATE wants first, last, increment with first <= last and increment >= 1')
         return
      end if
      hits = 0
      do i = number(1), number(2), number(3)
         k = find_label(family%label, family%order, i + family%offset(scope))
         if (k == 0) cycle
         hits = hits + 1
         call push(member, k)
      end do
      if (hits > 0) return
      clean = .false.
      call complain(log, 'E0204', 'GENERATE '//shown//' matches no '//family%what &
         & //'; numbers run ' &
         & //range_of(family%label), at)
   end subroutine generate

   subroutine take_nodes_of_elements(model, scene, name, scope, at, member)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: name
      integer, intent(in) :: scope
      type(location_type), intent(in) :: at
      type(list_type), intent(inout) :: member
      integer :: k, i, j

      k = set_named(scene, model%mesh%elset, 'element set', name, scope, at, model%log)
      if (k == 0) return
      associate (element => model%mesh%elset(k)%member, conn => model%mesh%conn)
         do i = 1, size(element)
            do j = 1, count(conn(:, element(i)) > 0)
               call push(member, conn(j, element(i)))
            end do
         end do
      end associate
   end subroutine take_nodes_of_elements

   pure subroutine without_repetition(list, n, member)
      type(list_type), intent(in) :: list
      integer, intent(in) :: n                          !! largest index
      integer, allocatable, intent(out) :: member(:)
      logical, allocatable :: met(:)
      integer :: i, m

      allocate (met(n), source=.false.)
      allocate (member(list%n))
      m = 0
      do i = 1, list%n
         if (met(list%item(i))) cycle
         met(list%item(i)) = .true.
         m = m + 1
         member(m) = list%item(i)
      end do
      member = member(:m)
   end subroutine without_repetition
end module lopin_build_sets
