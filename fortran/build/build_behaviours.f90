!> `*CHANGE SURFACE BEHAVIOR`: from a step on, other pairs act in the place of those of an
!> interaction, with the new behaviour, and go on from what those bear.
module lopin_build_behaviours
   use lopin_error, only : location_type
   use lopin_model, only : model_type, interaction_type, pair_type, overclosure_of
   use lopin_interactions, only : new_interaction, add_interaction
   use lopin_block, only : deck_type, block_type, complain
   use lopin_build_interactions, only : read_behaviour
   use lopin_build_scene, only : scene_type, name_type, need_word, find_name, no_such
   implicit none
   private
   public :: build_behaviour_changes, interaction_named

contains

   subroutine build_behaviour_changes(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(location_type) :: at
      integer :: k, changed, s
      logical :: waiting

      waiting = .false.
      changed = 0
      s = 0
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (waiting .and. scene%card(k)%step /= s) call without_behaviour()
            s = scene%card(k)%step
            if (s == 0) cycle
            if (block%keyword == 'CHANGE SURFACE BEHAVIOR') then
               if (waiting) call without_behaviour()
               at = block%at
               changed = interaction_named(model, block)
               waiting = .true.
            else if (block%keyword == 'SURFACE BEHAVIOR') then
               if (.not. waiting) call complain(model%log, 'E0306', '*SURFACE BEHAVIOR in a '// &
                  & 'step stands after no *CHANGE SURFACE BEHAVIOR', block%at)
               if (waiting .and. changed > 0) call change_behaviour(model, block, changed, s)
               waiting = .false.
            end if
         end associate
      end do
      if (waiting) call without_behaviour()
   contains
      subroutine without_behaviour()
         call complain(model%log, 'E0306', '*CHANGE SURFACE BEHAVIOR is not followed by '// &
            & '*SURFACE BEHAVIOR', at)
         waiting = .false.
      end subroutine without_behaviour
   end subroutine build_behaviour_changes

   !> INTERACTION= of a card; 0, with a complaint, if there is none of that name.
   integer function interaction_named(model, block) result(number)
      type(model_type), intent(inout) :: model
      type(block_type), intent(in) :: block
      type(name_type), allocatable :: names(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: i
      logical :: found

      number = 0
      call need_word(block, 'INTERACTION', word, at, found, model%log)
      if (.not. found) return
      allocate (names(size(model%interaction)))
      do i = 1, size(names)
         names(i)%text = model%interaction(i)%name
      end do
      number = find_name(names, word)
      if (number == 0) call no_such(model%log, 'surface interaction', word, names, at)
   end function interaction_named

   !> The pairs that have the interaction in this step end before it; others begin.
   subroutine change_behaviour(model, block, changed, s)
      type(model_type), intent(inout) :: model
      type(block_type), intent(in) :: block
      integer, intent(in) :: changed, s
      type(interaction_type) :: interaction
      type(pair_type) :: pair
      integer :: i, own, npair

      call new_interaction(interaction)
      interaction%name = model%interaction(changed)%name
      interaction%at = block%at
      interaction%friction = model%interaction(changed)%friction
      call read_behaviour(interaction, block, model%log)
      if (interaction%overclosure == overclosure_of%tied) then
         call complain(model%log, 'E0108', 'a change to PRESSURE-OVERCLOSURE=TIED comes with a '// &
            & 'later version', block%at, help='*CONTACT PAIR, TIED or *TIE glues from the '// &
            & 'start; NO SEPARATION with *FRICTION, ROUGH holds what touches')
         return
      end if
      call add_interaction(model, interaction)
      own = size(model%interaction)
      npair = size(model%pair)
      do i = 1, npair
         if (model%pair(i)%last_step < s) cycle
         if (model%interaction(model%pair(i)%interaction)%name /= interaction%name) cycle
         pair = model%pair(i)
         pair%interaction = own
         pair%before = i
         pair%first_step = s
         pair%tied = .false.
         model%pair(i)%last_step = s - 1
         model%pair = [model%pair, pair]
      end do
   end subroutine change_behaviour
end module lopin_build_behaviours
