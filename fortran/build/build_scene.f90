!> What all parts of `new_model` share: the cards of the deck with parts and instances flattened
!> out, and the way from a word of the user to an index.
!>
!> A card has a scope: 0 for the model, otherwise the instance whose part it came from. Names of
!> scope s are known as `INSTANCE.NAME`; numbers of scope s are moved by an offset so that they stay
!> unique.
module lopin_build_scene
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type
   use lopin_plural, only : plural, plural_of
   use lopin_text, only : upper, nearest_word, to_text, parse_integer
   use lopin_mesh, only : mesh_type, set_type, find_label, find_set
   use lopin_element_type, only : element_type
   use lopin_block, only : block_type, field_type, get_parameter, complain, field_integer, &
      & field_real
   implicit none
   private
   public :: scene_type, instance_type, card_type, list_type, name_type
   public :: push, scoped, split_prefix, no_such, get_word, need_word, node_of, nodes_of, &
      & elements_of
   public :: find_name, set_named, need_integer, need_real

   integer, parameter :: most_names = 10   !! names listed in a message

   type :: name_type
      character(len=:), allocatable :: text
   end type name_type

   !> A growing list of integers.
   type :: list_type
      integer :: n = 0
      integer, allocatable :: item(:)
   end type list_type

   type :: card_type
      integer :: block = 0    !! index into deck%block
      integer :: scope = 0    !! instance, 0: the model
      integer :: step = 0     !! number of the step it stands in, 0: model data
   end type card_type

   type :: instance_type
      character(len=:), allocatable :: name
      type(location_type) :: at
      real(wp) :: shift(3) = 0.0_wp          !! applied before the rotation [length]
      real(wp) :: pivot(3) = 0.0_wp          !! a point of the axis [length]
      real(wp) :: rotation(3, 3) = 0.0_wp
   end type instance_type

   type :: scene_type
      integer :: ncard = 0
      type(card_type), allocatable :: card(:)
      integer :: nstep = 0
      type(instance_type), allocatable :: instance(:)
      integer, allocatable :: node_offset(:), element_offset(:)   !! (0:ninstance) added to labels
      type(element_type), allocatable :: etype(:)                 !! of model%element_word
      type(location_type), allocatable :: etype_at(:)             !! where each word is first used
   end type scene_type

contains

   pure subroutine push(self, value)
      type(list_type), intent(inout) :: self
      integer, intent(in) :: value
      integer, allocatable :: grown(:)

      if (.not. allocated(self%item)) allocate (self%item(16))
      if (self%n == size(self%item)) then
         allocate (grown(2*self%n))
         grown(:self%n) = self%item
         call move_alloc(grown, self%item)
      end if
      self%n = self%n + 1
      self%item(self%n) = value
   end subroutine push

   !> The full name of a name that a card of a scope gives to something.
   pure function scoped(self, scope, name) result(full)
      type(scene_type), intent(in) :: self
      integer, intent(in) :: scope
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: full

      full = upper(name)
      if (scope > 0) full = self%instance(scope)%name//'.'//full
   end function scoped

   !> Cut `INSTANCE.rest`; without such a prefix the scope stays as it is.
   pure subroutine split_prefix(self, text, scope, rest)
      type(scene_type), intent(in) :: self
      character(len=*), intent(in) :: text
      integer, intent(inout) :: scope
      character(len=:), allocatable, intent(out) :: rest
      character(len=:), allocatable :: prefix
      integer :: i, dot

      rest = text
      dot = index(text, '.')
      if (dot < 2) return
      prefix = upper(text(:dot - 1))
      do i = 1, size(self%instance)
         if (self%instance(i)%name /= prefix) cycle
         scope = i
         rest = text(dot + 1:)
         return
      end do
   end subroutine split_prefix

   !> A word parameter in upper case; '' when absent.
   subroutine get_word(block, name, word, at, found)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(out) :: word
      type(location_type), intent(out) :: at
      logical, intent(out) :: found

      call get_parameter(block, name, word, at, found)
      word = upper(word)
   end subroutine get_word

   !> A word parameter that must be there and have a value.
   subroutine need_word(block, name, word, at, found, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(out) :: word
      type(location_type), intent(out) :: at
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log

      call get_word(block, name, word, at, found)
      found = found .and. len(word) > 0
      if (found) return
      call complain(log, 'E0106', '*'//block%keyword//' needs '//name//'=', block%at)
   end subroutine need_word

   !> A whole number that must be there: an empty field is a complaint too.
   subroutine need_integer(field, value, log, found)
      type(field_type), intent(in) :: field
      integer, intent(out) :: value
      type(log_type), intent(inout) :: log
      logical, intent(out) :: found

      call field_integer(field, value, log, found)
      if (len(field%text) == 0) call complain(log, 'E0103', 'a whole number is missing', field%at)
   end subroutine need_integer

   !> A number that must be there: an empty field is a complaint too.
   subroutine need_real(field, value, log, found)
      type(field_type), intent(in) :: field
      real(wp), intent(out) :: value
      type(log_type), intent(inout) :: log
      logical, intent(out) :: found

      call field_real(field, value, log, found)
      if (len(field%text) == 0) call complain(log, 'E0103', 'a number is missing', field%at)
   end subroutine need_real

   pure integer function find_name(names, wanted)
      type(name_type), intent(in) :: names(:)
      character(len=*), intent(in) :: wanted

      do find_name = 1, size(names)
         if (names(find_name)%text == wanted) return
      end do
      find_name = 0
   end function find_name

   !> Complain that a name is not defined: list those that are, and the one that was probably meant.
   subroutine no_such(log, what, name, names, at, members)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: what             !! 'node set', 'material' ...
      character(len=*), intent(in) :: name
      type(name_type), intent(in) :: names(:)          !! those that exist
      type(location_type), intent(in) :: at
      integer, intent(in), optional :: members(:)      !! their sizes
      character(len=:), allocatable :: text, guess, label
      character(len=160) :: list(size(names))
      integer :: i, dot

      text = ''
      do i = 1, size(names)
         list(i) = names(i)%text
         if (i > most_names) cycle
         if (i > 1) text = text//', '
         text = text//names(i)%text
         if (present(members)) text = text//' ('//to_text(members(i))//')'
      end do
      if (size(names) > most_names) text = text//' and '//to_text(size(names) - most_names)//' more'
      if (size(names) == 0) text = 'none'
      guess = nearest_word(name, list)
      do i = 1, size(names)
         dot = index(names(i)%text, '.')
         if (len(guess) == 0 .and. dot > 0 &
            & .and. names(i)%text(dot + 1:) == name) guess = names(i)%text
      end do
      label = 'not defined'
      if (len(guess) > 0) label = 'did you mean '//guess//' ?'
      call complain(log, 'E0201', 'no '//what//' `'//name//'`; '//plural_of(what)//' defined: '// &
         & text, at, label=label)
   end subroutine no_such

   !> The index of the set a card of a scope means; complains and returns 0 when there is none.
   integer function set_named(self, sets, what, name, scope, at, log) result(k)
      type(scene_type), intent(in) :: self
      type(set_type), intent(in) :: sets(:)
      character(len=*), intent(in) :: what, name     !! what: 'node set' or 'element set'
      integer, intent(in) :: scope
      type(location_type), intent(in) :: at
      type(log_type), intent(inout) :: log
      type(name_type), allocatable :: names(:)
      integer :: i

      k = find_set(sets, scoped(self, scope, name))
      if (k == 0) k = find_set(sets, upper(name))
      if (k > 0) return
      allocate (names(size(sets)))
      do i = 1, size(sets)
         names(i)%text = sets(i)%name
      end do
      call no_such(log, what, upper(name), names, at, [(size(sets(i)%member), i=1, size(sets))])
   end function set_named

   !> The nodes a field means: a number (`5`, `INSTANCE.5`) or a node set. Empty after a complaint.
   subroutine nodes_of(self, mesh, field, scope, node, log)
      type(scene_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(field_type), intent(in) :: field
      integer, intent(in) :: scope
      integer, allocatable, intent(out) :: node(:)
      type(log_type), intent(inout) :: log

      call members_of(self, mesh, field, scope, 'node', node, log)
   end subroutine nodes_of

   !> The elements a field means: a number or an element set. Empty after a complaint.
   subroutine elements_of(self, mesh, field, scope, element, log)
      type(scene_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(field_type), intent(in) :: field
      integer, intent(in) :: scope
      integer, allocatable, intent(out) :: element(:)
      type(log_type), intent(inout) :: log

      call members_of(self, mesh, field, scope, 'element', element, log)
   end subroutine elements_of

   subroutine members_of(self, mesh, field, scope, what, member, log)
      type(scene_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      type(field_type), intent(in) :: field
      integer, intent(in) :: scope
      character(len=*), intent(in) :: what          !! 'node' or 'element'
      integer, allocatable, intent(out) :: member(:)
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: rest
      integer :: within, number, k
      logical :: ok

      within = scope
      call split_prefix(self, field%text, within, rest)
      call parse_integer(rest, number, ok)
      if (ok) then
         if (what == 'node') then
            k = find_label(mesh%node_label, mesh%node_order, number + self%node_offset(within))
            if (k == 0) call no_number(log, what, number, mesh%node_label, field%at)
         else
            k = find_label(mesh%element_label, mesh%element_order, &
               & number + self%element_offset(within))
            if (k == 0) call no_number(log, what, number, mesh%element_label, field%at)
         end if
         if (k == 0) then
            allocate (member(0))
         else
            member = [k]
         end if
         return
      end if
      if (what == 'node') then
         k = set_named(self, mesh%nset, 'node set', rest, within, field%at, log)
         if (k > 0) member = mesh%nset(k)%member
      else
         k = set_named(self, mesh%elset, 'element set', rest, within, field%at, log)
         if (k > 0) member = mesh%elset(k)%member
      end if
      if (k == 0) allocate (member(0))
   end subroutine members_of

   !> Complain that a node or element number does not exist.
   subroutine no_number(log, what, number, label, at)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: what
      integer, intent(in) :: number, label(:)
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: text

      text = what//' '//to_text(number)//' does not exist'
      if (size(label) > 0) text = text//'; numbers run '//to_text(minval(label))//'-' &
         & //to_text(maxval(label))
      call complain(log, 'E0202', text, at)
   end subroutine no_number

   !> The one node a parameter value means: a number or a set of one node; 0 after a complaint.
   integer function node_of(self, mesh, text, scope, at, log) result(node)
      type(scene_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      character(len=*), intent(in) :: text
      integer, intent(in) :: scope
      type(location_type), intent(in) :: at
      type(log_type), intent(inout) :: log
      type(field_type) :: field
      integer, allocatable :: list(:)

      field%text = text
      field%at = at
      call nodes_of(self, mesh, field, scope, list, log)
      node = 0
      if (size(list) == 1) node = list(1)
      if (size(list) <= 1) return
      call complain(log, 'E0305', 'node set `'//upper(text)//'` has '//plural(size(list), 'node') &
         & //'; a reference node is one', at)
   end function node_of
end module lopin_build_scene
