!> `*TIE`: surfaces glued for the whole run, as a pair of its own with an interaction of its own.
module lopin_build_ties
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   use lopin_text, only : parse_real, to_text
   use lopin_interactions, only : new_interaction, add_interaction
   use lopin_model, only : model_type, pair_type, interaction_type, surface_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, complain, line_place
   use lopin_build_scene, only : scene_type, get_word, need_word
   use lopin_build_surfaces, only : surface_named
   use lopin_build_contact, only : check_sides
   implicit none
   private
   public :: build_ties

contains

   !> After the pairs, so that what speaks of all pairs does not mean ties.
   subroutine build_ties(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer :: k

      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword == 'TIE') call read_tie(model, scene, block, scene%card(k)%scope)
         end associate
      end do
   end subroutine build_ties

   subroutine read_tie(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(pair_type) :: same, pair
      type(interaction_type) :: interaction
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: j, n
      logical :: found, ok

      call need_word(block, 'NAME', word, at, found, model%log)
      ! No deck can call an interaction so: names have no asterisk.
      call new_interaction(interaction)
      interaction%name = '*TIE '//word
      interaction%at = block%at
      call add_interaction(model, interaction)
      same%interaction = size(model%interaction)
      same%tied = .true.
      call get_word(block, 'TYPE', word, at, found)
      same%surface_to_surface = .not. found .or. word == 'SURFACE TO SURFACE'
      call get_word(block, 'POSITION TOLERANCE', word, at, found)
      if (found) then
         call parse_real(word, same%adjust, ok)
         if (.not. ok .or. same%adjust < 0.0_wp) call complain(model%log, 'E0304', &
            & 'POSITION TOLERANCE='//word//' is no distance', at)
      end if
      if (block%nline == 0) call complain(model%log, 'E0304', '*TIE names no surfaces', block%at, &
         & help='a line with the slave surface and the master surface')
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         pair = same
         pair%at = line_place(block%line(j))
         if (n < 2) then
            call complain(model%log, 'E0304', 'a tie needs two surfaces: slave, master', pair%at)
            cycle
         end if
         pair%slave = surface_named(model, scene, field(1)%text, scope, field(1)%at)
         pair%master = surface_named(model, scene, field(2)%text, scope, field(2)%at)
         if (pair%slave == 0 .or. pair%master == 0) cycle
         if (pair%slave == pair%master) then
            call complain(model%log, 'E0304', 'surface `'//model%surface(pair%slave)%name &
               & //'` is tied to itself', pair%at)
            cycle
         end if
         call check_sides(model, pair, field(1), field(2), ok)
         if (model%surface(pair%slave)%kind == surface_of%nodes) pair%surface_to_surface = .false.
         if (ok) model%pair = [model%pair, pair]
      end do
   end subroutine read_tie
end module lopin_build_ties
