!> *INITIAL CONDITIONS, TYPE=STATE, HARDENING and MEMORY: what integration points remember at the
!> start; TRACTION: what slave nodes bear.
module lopin_build_states
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : location_type
   use lopin_model, only : model_type, initial_state_type, initial_traction_type
   use lopin_start, only : kept_memory_type
   use lopin_element_type, only : element_kind
   use lopin_damage_criteria, only : damage_names
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & field_integer, complain
   use lopin_build_scene, only : scene_type, elements_of, nodes_of, get_word
   use lopin_build_changes, only : pair_named
   implicit none
   private
   public :: read_states, read_memories, build_tractions

contains

   !> The lines of a card, added to those of the model.
   subroutine read_states(model, scene, block, scope, whole)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      logical, intent(in) :: whole              !! STATE, else HARDENING
      type(initial_state_type), allocatable :: list(:), longer(:)
      type(initial_state_type) :: new
      type(field_type), allocatable :: field(:)
      integer, allocatable :: element(:)
      integer :: i, j, n, known

      known = size(model%initial_state)
      allocate (list(known + max(1, block%nline)))
      list(:known) = model%initial_state
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call elements_of(scene, model%mesh, field(1), scope, element, model%log)
         call read_line(model, field, n, whole, new)
         if (known + size(element) > size(list)) then
            allocate (longer(2*(known + size(element))))
            longer(:known) = list(:known)
            call move_alloc(longer, list)
         end if
         do i = 1, size(element)
            if (whole .and. scene%etype(model%mesh%etype(element(i)))%kind &
               & == element_kind%plane_stress) then
               call complain(model%log, 'E0108', 'a state of the start in plane stress comes '// &
                  & 'with a later version: element '// &
                  & to_text(model%mesh%element_label(element(i))), field(1)%at)
               exit
            end if
            known = known + 1
            new%element = element(i)
            list(known) = new
         end do
      end do
      model%initial_state = list(:known)
   end subroutine read_states

   !> One line: all of a state, or the plastic strain.
   subroutine read_line(model, field, n, whole, new)
      type(model_type), intent(inout) :: model
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: n
      logical, intent(in) :: whole              !! STATE, else HARDENING
      type(initial_state_type), intent(out) :: new
      logical :: found

      new = initial_state_type(at=field(1)%at, whole=whole)
      if (whole) then
         call read_point(model, field, n, new)
      else if (n < 2) then
         call complain(model%log, 'E0103', 'a plastic strain is missing', field(1)%at)
      else
         call field_real(field(2), new%plastic, model%log, found)
         if (n > 2) call complain(model%log, 'E0108', 'backstresses of the start come with a '// &
            & 'later version', field(3)%at)
      end if
      if (new%plastic < 0.0_wp) call complain(model%log, 'E0106', &
         & 'a plastic strain that has accumulated is not below 0', field(1)%at)
   end subroutine read_line

   !> The numbers of a line of STATE.
   subroutine read_point(model, field, n, new)
      type(model_type), intent(inout) :: model
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: n
      type(initial_state_type), intent(inout) :: new
      real(wp) :: value(15)
      logical :: found
      integer :: k

      if (n < 9) then
         call complain(model%log, 'E0103', 'a line of TYPE=STATE has an element, a point, six '// &
            & 'strains and ln J at least', field(1)%at)
         return
      end if
      call field_integer(field(2), new%point, model%log, found)
      value = 0.0_wp
      do k = 3, min(n, 17)
         if (len_trim(field(k)%text) > 0) call field_real(field(k), value(k - 2), model%log, found)
      end do
      new%strain = value(:6)
      new%volume = value(7)
      new%ratio = value(8)
      new%plastic = value(9)
      new%flow_stress = value(10)
      new%work = value(11)
      new%damage = value(12:)
   end subroutine read_point

   !> The lines of TYPE=MEMORY: a point of an element each.
   subroutine read_memories(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(kept_memory_type), allocatable :: list(:)
      type(field_type), allocatable :: field(:)
      integer, allocatable :: element(:)
      real(wp), allocatable :: value(:)
      integer :: j, k, n, known, before
      logical :: found

      known = size(model%start%kept)
      allocate (list(known + block%nline))
      list(:known) = model%start%kept
      before = 4 + size(damage_names)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call elements_of(scene, model%mesh, field(1), scope, element, model%log)
         if (size(element) == 0) cycle
         if (n <= before .or. size(element) > 1) then
            call complain(model%log, 'E0103', 'a line of TYPE=MEMORY has one element, a point '// &
               & 'and what it remembers, as a run writes it', field(1)%at)
            cycle
         end if
         allocate (value(n), source=0.0_wp)
         do k = 3, n
            call field_real(field(k), value(k), model%log, found)
         end do
         known = known + 1
         associate (new => list(known))
            new = kept_memory_type(at=field(1)%at, element=element(1), pressed=value(3), &
               & scale=value(4), damage=value(5:before))
            call field_integer(field(2), new%point, model%log, found)
            new%value = value(before + 1:)
         end associate
         deallocate (value)
      end do
      model%start%kept = list(:known)
   end subroutine read_memories

   !> Cards of TYPE=TRACTION, once the contact pairs are known.
   subroutine build_tractions(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k
      logical :: found

      allocate (model%initial_traction(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword /= 'INITIAL CONDITIONS') cycle
            call get_word(block, 'TYPE', word, at, found)
            if (word == 'TRACTION') call read_tractions(model, scene, block, scope)
         end associate
      end do
   end subroutine build_tractions

   subroutine read_tractions(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(field_type), allocatable :: field(:)
      type(initial_traction_type), allocatable :: list(:), longer(:)
      type(initial_traction_type) :: new
      integer, allocatable :: node(:)
      real(wp) :: value(6)
      integer :: i, j, k, n, known
      logical :: found

      known = size(model%initial_traction)
      allocate (list(known + max(1, block%nline)))
      list(:known) = model%initial_traction
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         if (n < 5) then
            call complain(model%log, 'E0103', 'a line of TYPE=TRACTION has two surfaces, a '// &
               & 'node and two or three components', field(1)%at)
            cycle
         end if
         new%pair = pair_named(model, scene, field(1), field(2), scope, field(1)%at)
         if (new%pair == 0) cycle
         call nodes_of(scene, model%mesh, field(3), scope, node, model%log)
         value = 0.0_wp
         do k = 4, min(n, 9)
            if (len_trim(field(k)%text) > 0) call field_real(field(k), value(k - 3), model%log, &
               & found)
         end do
         new%traction = value(:3)
         new%creep = value(4:)
         if (known + size(node) > size(list)) then
            allocate (longer(2*(known + size(node))))
            longer(:known) = list(:known)
            call move_alloc(longer, list)
         end if
         do i = 1, size(node)
            known = known + 1
            new%node = node(i)
            list(known) = new
         end do
      end do
      model%initial_traction = list(:known)
   end subroutine read_tractions
end module lopin_build_states
