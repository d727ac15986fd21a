!> Contact: interactions, pairs, clearances, controls.
module lopin_build_contact
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text, upper, parse_real
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type, pair_type, control_type, surface_of, initial_of, &
      & overclosure_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & complain, has_parameter, line_place, get_parameter
   use lopin_build_scene, only : scene_type, name_type, need_word, get_word, set_named, &
      & find_name, no_such
   use lopin_build_surfaces, only : surface_named
   implicit none
   private
   public :: build_pairs, check_sides

contains

   !> Pairs first, then what other cards say of them.
   subroutine build_pairs(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer :: k

      allocate (model%pair(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword == 'CONTACT PAIR') call read_pairs(model, scene, block, &
               & scene%card(k)%scope)
         end associate
      end do
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword == 'CLEARANCE') call read_clearance(model, scene, block, scope)
            if (block%keyword == 'CONTACT CONTROLS') then
               call read_controls(model, scene, block, scope)
               if (scene%card(k)%step > 1) call model%log%say(severity%note, 'N0304', &
                  & '*CONTACT CONTROLS of step '//to_text(scene%card(k)%step) &
                  & //' act from the first step on', block%at)
            end if
         end associate
      end do
   end subroutine build_pairs

   subroutine read_pairs(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(pair_type) :: common, pair
      type(field_type), allocatable :: field(:)
      integer :: j, n, twin
      logical :: ok

      call read_pair_words(common, model, scene, block, scope)
      if (block%nline == 0) call complain(model%log, 'E0304', '*CONTACT PAIR names no surfaces', &
         & block%at, &
         & help='a line with the slave surface and the master surface')
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         pair = common
         pair%at = line_place(block%line(j))
         ! One name, or the same twice: the surface against itself.
         twin = 1
         if (n > 1) then
            if (len(field(2)%text) > 0) twin = 2
         end if
         pair%slave = surface_named(model, scene, field(1)%text, scope, field(1)%at)
         pair%master = surface_named(model, scene, field(twin)%text, scope, field(twin)%at)
         if (pair%slave == 0 .or. pair%master == 0) cycle
         call check_sides(model, pair, field(1), field(twin), ok)
         if (ok) call check_itself(model, pair, field(1), ok)
         call note_nodes(model, pair)
         if (ok) call integrate_curves(model, pair)
         if (ok) model%pair = [model%pair, pair]
      end do
   end subroutine read_pairs

   !> A surface against itself slides; glued to itself it has no meaning.
   subroutine check_itself(model, pair, name, ok)
      type(model_type), intent(inout) :: model
      type(pair_type), intent(in) :: pair
      type(field_type), intent(in) :: name
      logical, intent(inout) :: ok

      if (pair%slave /= pair%master .or. .not. pair%tied) return
      ok = .false.
      call complain(model%log, 'E0304', 'surface `'//upper(name%text)// &
         & '` cannot be tied to itself', name%at, help='leave out TIED, or name two surfaces')
   end subroutine check_itself

   !> Where surface to surface cannot be what it says.
   subroutine note_nodes(model, pair)
      type(model_type), intent(inout) :: model
      type(pair_type), intent(in) :: pair
      character(len=:), allocatable :: why

      if (.not. pair%surface_to_surface .or. pair%tied) return
      if (model%surface(pair%slave)%kind == surface_of%nodes) then
         why = 'its slave is made of nodes'
      else
         return
      end if
      call model%log%say(severity%note, 'N0304', 'a pair of surface to surface is read as NODE '// &
         & 'TO SURFACE: '//why, pair%at)
   end subroutine note_nodes

   !> Rows at the nodes of second-order faces do not pass on a uniform pressure: such pairs are
   !> integrated. A surface against itself cannot be.
   subroutine integrate_curves(model, pair)
      type(model_type), intent(inout) :: model
      type(pair_type), intent(inout) :: pair
      logical :: curves(2)

      if (pair%surface_to_surface) then
         if (pair%slave /= pair%master) return
      end if
      curves = [has_curves(model, pair%slave), has_curves(model, pair%master)]
      if (.not. any(curves)) return
      if (pair%slave == pair%master) then
         call model%log%say(severity%warning, 'W0335', 'surface `'// &
            & upper(model%surface(pair%slave)%name)//'` meets itself with second-order faces: '// &
            & 'contact is at their nodes, and pressures are uneven', pair%at, &
            & help='linear elements, or two surfaces that meet each other')
         return
      end if
      if (any([model%surface(pair%slave)%kind, model%surface(pair%master)%kind] &
         & /= surface_of%faces)) return
      pair%surface_to_surface = .true.
      call model%log%say(severity%note, 'N0334', 'pair ('//model%surface(pair%slave)%name//', '// &
         & model%surface(pair%master)%name//') has second-order faces: NODE TO SURFACE is '// &
         & 'carried out surface to surface', pair%at)
   end subroutine integrate_curves

   !> A surface of faces of second-order elements.
   logical function has_curves(model, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      type(cell_type), allocatable :: cells(:)
      integer :: i

      has_curves = .false.
      associate (s => model%surface(surface))
         if (s%kind /= surface_of%faces) return
         call cells_of_words(model%element_word, cells)
         do i = 1, size(s%element)
            has_curves = has_curves .or. cells(model%mesh%etype(s%element(i)))%quadratic
         end do
      end associate
   end function has_curves

   subroutine read_pair_words(pair, model, scene, block, scope)
      type(pair_type), intent(out) :: pair
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(name_type), allocatable :: names(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: i
      logical :: found

      call need_word(block, 'INTERACTION', word, at, found, model%log)
      allocate (names(size(model%interaction)))
      do i = 1, size(names)
         names(i)%text = model%interaction(i)%name
      end do
      if (found) then
         pair%interaction = find_name(names, word)
         if (pair%interaction == 0) call no_such(model%log, 'surface interaction', word, names, at)
      end if
      pair%small_sliding = has_parameter(block, 'SMALL SLIDING')
      pair%tied = has_parameter(block, 'TIED')
      if (pair%interaction > 0) pair%tied = pair%tied &
         & .or. model%interaction(pair%interaction)%overclosure == overclosure_of%tied
      ! Glue holds whole surfaces unless the deck asks for nodes.
      call get_word(block, 'TYPE', word, at, found)
      pair%surface_to_surface = pair%tied
      if (found) pair%surface_to_surface = word /= 'NODE TO SURFACE'
      pair%open = .not. (found .or. pair%tied .or. has_parameter(block, 'SMOOTH') &
         & .or. has_parameter(block, 'EXTENSION ZONE'))
      call get_word(block, 'SMOOTH', word, at, found)
      if (found) pair%smooth = word == 'YES'
      if (pair%smooth .and. pair%surface_to_surface) call model%log%say(severity%note, 'N0304', &
         & 'SMOOTH curves the master where contact is at the nodes: mortar keeps its facets', at)
      call read_number(block, 'EXTENSION ZONE', pair%extension, model%log)
      if (pair%extension < 0.0_wp .or. pair%extension > 0.2_wp) then
         call get_word(block, 'EXTENSION ZONE', word, at, found)
         call complain(model%log, 'E0304', 'EXTENSION ZONE='//word//' is outside 0 to 0.2', at)
      end if
      call read_adjust(pair, model, scene, block, scope)
   end subroutine read_pair_words

   !> `ADJUST=number`, `ADJUST=node set`, `ADJUST=YES` (the same as 0) or `ADJUST=NO`.
   subroutine read_adjust(pair, model, scene, block, scope)
      type(pair_type), intent(inout) :: pair
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      character(len=:), allocatable :: word
      type(location_type) :: at
      real(wp) :: value
      integer :: k
      logical :: found

      call get_word(block, 'ADJUST', word, at, found)
      if (.not. found .or. word == 'NO') return
      call parse_real(word, value, found)
      if (found) then
         pair%adjust = value
         if (value < 0.0_wp) call complain(model%log, 'E0304', 'ADJUST='//word//' is negative', at)
      else if (word == 'YES' .or. word == '') then
         pair%adjust = 0.0_wp
      else
         k = set_named(scene, model%mesh%nset, 'node set', word, scope, at, model%log)
         if (k > 0) pair%adjust_node = model%mesh%nset(k)%member
      end if
   end subroutine read_adjust

   !> Which surface may be slave, which master, and no pair twice.
   subroutine check_sides(model, pair, slave, master, ok)
      type(model_type), intent(inout) :: model
      type(pair_type), intent(in) :: pair
      type(field_type), intent(in) :: slave, master
      logical, intent(out) :: ok
      integer :: i

      ok = .false.
      if (model%surface(pair%slave)%kind == surface_of%tool) then
         call complain(model%log, 'E0304', 'slave `'//upper(slave%text) &
            & //'` is a rigid tool: it has no nodes', &
            & slave%at, help='the data line is slave, master: write '//upper(master%text)//', ' &
            & //upper(slave%text))
      else if (model%surface(pair%master)%kind == surface_of%nodes) then
         call complain(model%log, 'E0304', 'master `'//upper(master%text) &
            & //'` is made of nodes: it has no faces', &
            & master%at, help='a master is TYPE=ELEMENT or a rigid tool; nodes may be the slave')
      else
         ok = .true.
      end if
      do i = 1, size(model%pair)
         if (model%pair(i)%slave == pair%slave .and. model%pair(i)%master == pair%master) then
            ok = .false.
            call complain(model%log, 'E0304', 'the pair '//upper(slave%text)//', ' &
               & //upper(master%text) &
               & //' is listed twice, in lines '//to_text(model%pair(i)%at%line)//' and ' &
               & //to_text(pair%at%line), &
               & pair%at, note='a pair counted twice is twice as stiff')
         else if (model%pair(i)%slave == pair%master .and. model%pair(i)%master == pair%slave) then
            call model%log%say(severity%warning, 'W0304', 'the pair '//upper(slave%text)//', ' &
               & //upper(master%text) &
               & //' is the pair of line '//to_text(model%pair(i)%at%line) &
               & //' with both sides swapped', pair%at, &
               & note='each point of contact is constrained twice', &
               & help='keep one: the finer, softer side is the slave')
         end if
      end do
   end subroutine check_sides

   subroutine read_clearance(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      logical :: chosen(size(model%pair))
      real(wp) :: value
      integer :: i

      call choose_pairs(model, scene, block, scope, chosen)
      value = 0.0_wp
      call read_number(block, 'VALUE', value, model%log)
      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         model%pair(i)%has_clearance = .true.
         model%pair(i)%clearance = value
      end do
   end subroutine read_clearance

   !> The pairs that SLAVE= and MASTER= mean; all without them.
   subroutine choose_pairs(model, scene, block, scope, chosen)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      logical, intent(out) :: chosen(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k
      logical :: found, named

      chosen = .true.
      named = .false.
      call get_word(block, 'SLAVE', word, at, found)
      if (found) then
         named = .true.
         k = surface_named(model, scene, word, scope, at)
         chosen = chosen .and. model%pair%slave == k
         if (k == 0) return
      end if
      call get_word(block, 'MASTER', word, at, found)
      if (found) then
         named = .true.
         k = surface_named(model, scene, word, scope, at)
         chosen = chosen .and. model%pair%master == k
         if (k == 0) return
      end if
      if (named .and. .not. any(chosen) &
         & .and. model%log%count_of(severity%error) == 0) call complain(model%log, &
         & 'E0304', '*'//block%keyword//' names surfaces that are no contact pair', block%at, &
         & help='SLAVE= and MASTER= as in *CONTACT PAIR')
   end subroutine choose_pairs

   subroutine read_controls(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(control_type) :: control
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: chosen(size(model%pair)), found
      real(wp) :: value
      integer :: i

      call choose_pairs(model, scene, block, scope, chosen)
      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         control = model%pair(i)%control
         if (has_parameter(block, 'RESET')) control = control_type()
         value = real(control%max_augmentations, wp)
         call read_number(block, 'MAX AUGMENTATIONS', value, model%log)
         if (value < 1.0_wp) call complain(model%log, 'E0304', 'MAX AUGMENTATIONS='// &
            & to_text(value, 6)//' is less than 1', block%at)
         control%max_augmentations = max(1, nint(value))
         call read_number(block, 'RELATIVE PENETRATION TOLERANCE', control%relative_penetration, &
            & model%log)
         call read_number(block, 'ABSOLUTE PENETRATION TOLERANCE', control%absolute_penetration, &
            & model%log)
         if (min(control%relative_penetration, control%absolute_penetration) < 0.0_wp) &
            & call complain(model%log, 'E0304', 'a tolerance of penetration is not negative', &
            & block%at)
         call get_word(block, 'INITIAL', word, at, found)
         if (found) then
            select case (word)
            case ('ERROR')
               control%initial = initial_of%error
            case ('INTERFERENCE')
               control%initial = initial_of%interference
            case ('ADJUST')
               control%initial = initial_of%adjust
            case default
               control%initial = initial_of%automatic
            end select
         end if
         model%pair(i)%control = control
      end do
   end subroutine read_controls

   !> A parameter that is a number; left as it is when absent.
   subroutine read_number(block, name, value, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: value
      type(log_type), intent(inout) :: log
      type(field_type) :: field
      real(wp) :: number
      logical :: found

      call get_parameter(block, name, field%text, field%at, found)
      if (.not. found) return
      call field_real(field, number, log, found)
      if (found) value = number
   end subroutine read_number
end module lopin_build_contact
