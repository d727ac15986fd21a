!> `*BOUNDARY`: the complete list of prescribed dofs of each step.
!>
!> What the model part prescribes is in force in every step until OP=NEW; later lines override
!> earlier ones, with a warning where both stand in one step and differ.
module lopin_build_boundary
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : upper, to_text, parse_integer, parse_real
   use lopin_model, only : model_type, prescribed_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & field_integer, complain, has_parameter
   use lopin_build_scene, only : need_integer, scene_type, nodes_of, get_word
   use lopin_build_amplitudes, only : read_amplitude_word, hold_value
   use lopin_prescribed_twice, only : clash_list_type, differ, note_clash
   implicit none
   private
   public :: boundary_type, new_boundary, boundary_of_step
   public :: find_roles, checked_dof, asks_new, verdict

   type :: roles
      integer :: plain = 0, reference = 1, rotation = 2
   end type roles
   type(roles), parameter :: role_of = roles()

   type :: verdicts
      integer :: use = 0, ignore = 1, refuse = 2
   end type verdicts
   type(verdicts), parameter :: verdict = verdicts()

   type :: boundary_type
      integer :: n = 0
      type(prescribed_type), allocatable :: item(:)
      integer, allocatable :: slot(:, :)      !! (6, nnode) position in item, 0: free
      integer, allocatable :: since(:)        !! (item) step that prescribed it
      integer :: step = 0                     !! being read
      type(clash_list_type) :: clashes        !! of this step
   end type boundary_type

   !> Words for sets of dofs, as 1..6 marks.
   character(len=*), parameter :: words(8) = [character(len=8) :: 'ENCASTRE', 'PINNED', 'XSYMM', &
      & 'YSYMM', 'ZSYMM', &
      & 'XASYMM', 'YASYMM', 'ZASYMM']
   character(len=*), parameter :: marks(8) = ['111111', '111000', '100011', '010101', '001110', &
      & '011100', &
      & '101010', '110001']

contains

   subroutine new_boundary(self, nnode)
      type(boundary_type), intent(out) :: self
      integer, intent(in) :: nnode

      allocate (self%item(64), self%since(64), self%slot(6, nnode))
      self%slot = 0
   end subroutine new_boundary

   !> Which nodes carry rotations.
   pure subroutine find_roles(model, role)
      type(model_type), intent(in) :: model
      integer, allocatable, intent(out) :: role(:)
      integer :: i

      allocate (role(model%mesh%nnode), source=role_of%plain)
      do i = 1, size(model%rigid_body)
         associate (body => model%rigid_body(i))
            if (body%reference > 0) role(body%reference) = role_of%reference
            if (body%rotation > 0) role(body%rotation) = role_of%rotation
         end associate
      end do
   end subroutine find_roles

   !> Whether a dof exists at a node of a role.
   pure integer function checked_dof(ndim, role, dof) result(answer)
      integer, intent(in) :: ndim, role, dof

      answer = verdict%use
      if (dof < 1 .or. dof > 6) then
         answer = verdict%refuse
      else if (role == role_of%reference) then
         if (ndim == 2 .and. dof > 2 .and. dof < 6) answer = verdict%ignore
      else if (dof > 3) then
         answer = verdict%refuse
      else if (role == role_of%rotation) then
         if (ndim == 2 .and. dof < 3) answer = verdict%ignore
      else if (ndim == 2 .and. dof == 3) then
         answer = verdict%ignore
      end if
   end function checked_dof

   logical function asks_new(deck, scene, step, keyword)
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: step
      character(len=*), intent(in) :: keyword
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k
      logical :: found

      asks_new = .true.
      do k = 1, scene%ncard
         if (scene%card(k)%step /= step) cycle
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= keyword) cycle
            call get_word(block, 'OP', word, at, found)
            if (word == 'NEW') return
         end associate
      end do
      asks_new = .false.
   end function asks_new

   !> Go from the list of the step before to that of a step (0: the model part).
   subroutine boundary_of_step(self, model, deck, scene, role, absolute, step)
      type(boundary_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: role(:)
      logical, intent(in) :: absolute(:)
      integer, intent(in) :: step
      integer :: k

      self%step = step
      if (step > 1) call hold_value(model, model%step(step - 1)%period, &
         & self%item(:self%n)%amplitude, &
         & self%item(:self%n)%value)
      if (step > 0) then
         if (asks_new(deck, scene, step, 'BOUNDARY')) then
            self%n = 0
            self%slot = 0
         end if
      end if
      do k = 1, scene%ncard
         if (scene%card(k)%step /= step) cycle
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'BOUNDARY') cycle
            call read_card(self, model, scene, block, scene%card(k)%scope, role, absolute)
         end associate
      end do
   end subroutine boundary_of_step

   subroutine read_card(self, model, scene, block, scope, role, absolute)
      type(boundary_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      integer, intent(in) :: role(:)
      logical, intent(in) :: absolute(:)
      type(field_type), allocatable :: field(:)
      type(prescribed_type) :: item
      integer, allocatable :: node(:)
      integer :: j, n, first, last
      character(len=6) :: mark
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: found, fixed

      item%amplitude = read_amplitude_word(model, block)
      fixed = has_parameter(block, 'FIXED')
      call get_word(block, 'TYPE', word, at, found)
      item%velocity = found .and. word == 'VELOCITY'
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         item%at = field(1)%at
         item%at%last = field(n)%at%last
         call nodes_of(scene, model%mesh, field(1), scope, node, model%log)
         if (n < 2) then
            call complain(model%log, 'E0103', 'a dof is missing after `'//field(1)%text//'`', &
               & item%at, &
               & help='node or node set, first dof, last dof, value')
            cycle
         end if
         call find_mark(field(2), mark, found)
         if (found) then
            if (n > 2) call model%log%say(severity%warning, 'W0405', 'what follows '// &
               & upper(field(2)%text)//' does nothing: such words prescribe zeros', field(3)%at, &
               & help='node or set, dof, dof, value moves a dof')
            item%value = 0.0_wp
            call prescribe_mark(self, model, node, mark, item, role)
            cycle
         end if
         call read_line(field(:n), first, last, item%value, found, model%log)
         if (.not. found) cycle
         if (fixed .and. abs(item%value) > 0.0_wp) call model%log%say(severity%warning, 'W0405', &
            & 'the value '//to_text(item%value, 6)//' does nothing: FIXED holds a dof where it '// &
            & 'is', field(4)%at, help='leave FIXED out to move the dof, or the value to hold it')
         if (item%amplitude > 0) then
            if (absolute(item%amplitude)) item%value = 1.0_wp
         end if
         call prescribe_range(self, model, node, [first, last], item, role, fixed, field(2)%at)
      end do
   end subroutine read_card

   pure subroutine find_mark(field, mark, found)
      type(field_type), intent(in) :: field
      character(len=6), intent(out) :: mark
      logical, intent(out) :: found
      integer :: i

      mark = ''
      i = findloc(words, upper(field%text), dim=1)
      found = i > 0
      if (found) mark = marks(i)
   end subroutine find_mark

   subroutine read_line(field, first, last, value, found, log)
      type(field_type), intent(in) :: field(:)
      integer, intent(out) :: first, last
      real(wp), intent(out) :: value
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log
      logical :: given

      value = 0.0_wp
      last = 0
      if (verify(upper(field(2)%text(:min(1, len(field(2)%text)))), &
         & 'ABCDEFGHIJKLMNOPQRSTUVWXYZ') == 0 &
         & .and. len(field(2)%text) > 0) then
         call complain(log, 'E0404', 'the word `'//upper(field(2)%text)//'` is not known', &
            & field(2)%at, &
            & help='a dof, or ENCASTRE, PINNED, XSYMM, YSYMM, ZSYMM, XASYMM, YASYMM, ZASYMM')
         found = .false.
         return
      end if
      call need_integer(field(2), first, log, found)
      if (.not. found) return
      last = first
      if (lacks_last(field, first)) then
         call complain(log, 'E0404', 'the value '//field(3)%text//' stands where the last dof '// &
            & 'belongs', field(3)%at, help='write '//field(1)%text//', '//field(2)%text//', '// &
            & field(2)%text//', '//field(3)%text//': node or set, first dof, last dof, value')
         found = .false.
         return
      end if
      if (size(field) > 2) call field_integer(field(3), last, log, given)
      if (last == 0) last = first
      if (size(field) > 3) call field_real(field(4), value, log, given)
      if (last < first) then
         call complain(log, 'E0404', 'dofs '//to_text(first)//' to '//to_text(last)//' are none', &
            & field(3)%at)
         found = .false.
      end if
   end subroutine read_line

   !> Whether a line of three fields ends with a value.
   pure logical function lacks_last(field, first)
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: first             !! dof
      real(wp) :: value
      integer :: dof
      logical :: is_whole

      lacks_last = .false.
      if (size(field) /= 3) return
      call parse_integer(field(3)%text, dof, is_whole)
      if (is_whole) then
         lacks_last = dof /= 0 .and. (dof < first .or. dof > 11)
      else
         call parse_real(field(3)%text, value, lacks_last)
      end if
   end function lacks_last

   !> A word: dofs that a node does not have are left out without a word.
   subroutine prescribe_mark(self, model, node, mark, item, role)
      type(boundary_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: node(:)
      character(len=6), intent(in) :: mark
      type(prescribed_type), intent(inout) :: item
      integer, intent(in) :: role(:)
      integer :: i, dof

      do i = 1, size(node)
         do dof = 1, 6
            if (mark(dof:dof) == '0') cycle
            if (checked_dof(model%mesh%ndim, role(node(i)), dof) /= verdict%use) cycle
            item%node = node(i)
            item%dof = dof
            call prescribe(self, item)
         end do
      end do
   end subroutine prescribe_mark

   subroutine prescribe_range(self, model, node, range, item, role, fixed, at)
      type(boundary_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node(:)
      integer, intent(in) :: range(2)               !! first and last dof
      type(prescribed_type), intent(inout) :: item
      integer, intent(in) :: role(:)
      logical, intent(in) :: fixed
      type(location_type), intent(in) :: at         !! of the first dof
      integer :: i, dof
      logical :: told

      told = .false.
      do dof = range(1), range(2)
         do i = 1, size(node)
            select case (checked_dof(model%mesh%ndim, role(node(i)), dof))
            case (verdict%refuse)
               call refuse_dof(model, node(i), dof, at)
               return
            case (verdict%ignore)
               ! `1, 6` at a reference node is a habit, not a mistake.
               told = told .or. (role(node(i)) == role_of%reference .and. range(2) > range(1))
               if (.not. told) call model%log%say(severity%note, 'N0404', 'dof '//to_text(dof) &
                  & //' does not exist in a scene of two dimensions: ignored', at)
               told = .true.
               cycle
            end select
            item%node = node(i)
            item%dof = dof
            if (.not. fixed) then
               call prescribe(self, item)
            else if (self%slot(dof, node(i)) == 0) then
               ! What was free stays where it is: it has no velocity.
               item%velocity = .true.
               item%value = 0.0_wp
               call prescribe(self, item)
            else if (self%item(self%slot(dof, node(i)))%velocity) then
               self%item(self%slot(dof, node(i)))%value = 0.0_wp
            end if
         end do
      end do
   end subroutine prescribe_range

   subroutine refuse_dof(model, node, dof, at)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: text, help

      ! A REF NODE that is wrong was told.
      if (dof >= 4 .and. any(model%rigid_body%reference == 0)) return
      text = 'dof '//to_text(dof)//' does not exist'
      help = '1 to 3 are translations, 4 to 6 rotations of a reference node'
      if (dof >= 4 .and. dof <= 6) then
         text = 'node '//to_text(model%mesh%node_label(node))//' has no rotations: dof ' &
            & //to_text(dof) &
            & //' does not exist'
         help = 'only the REF NODE of a *RIGID BODY has dofs 4 to 6; solid elements have ' &
            & //'translations only'
      end if
      call complain(model%log, 'E0404', text, at, help=help)
   end subroutine refuse_dof

   !> Add a prescribed dof, or override it.
   pure subroutine prescribe(self, item)
      type(boundary_type), intent(inout) :: self
      type(prescribed_type), intent(in) :: item
      type(prescribed_type), allocatable :: grown(:)
      integer, allocatable :: longer(:)
      integer :: k

      k = self%slot(item%dof, item%node)
      if (k > 0) then
         if (self%since(k) == self%step .and. differ(self%item(k), item)) call note_clash( &
            & self%clashes, self%item(k), item)
      else
         if (self%n == size(self%item)) then
            allocate (grown(2*self%n), longer(2*self%n))
            grown(:self%n) = self%item
            longer(:self%n) = self%since
            call move_alloc(grown, self%item)
            call move_alloc(longer, self%since)
         end if
         self%n = self%n + 1
         k = self%n
         self%slot(item%dof, item%node) = k
      end if
      self%item(k) = item
      self%since(k) = self%step
   end subroutine prescribe
end module lopin_build_boundary
