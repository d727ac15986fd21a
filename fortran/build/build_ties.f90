!> `*TIE`: surfaces glued for the whole run, as a pair of its own with an interaction of its own.
module lopin_build_ties
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, severity
   use lopin_face_vectors, only : surface_vector
   use lopin_text, only : parse_real, to_text
   use lopin_interactions, only : new_interaction, add_interaction
   use lopin_model, only : model_type, pair_type, interaction_type, surface_of, &
      & surface_data_type
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
         call turn_round(model, scene, pair)
         call check_sides(model, pair, field(1), field(2), ok)
         if (model%surface(pair%slave)%kind == surface_of%nodes) pair%surface_to_surface = .false.
         if (ok) model%pair = [model%pair, pair]
      end do
   end subroutine read_tie

   !> Surfaces that look the same way meet nowhere, but what they join is meant: the nodes of the
   !> slave are tied to the nearest points of the master.
   subroutine turn_round(model, scene, pair)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(pair_type), intent(inout) :: pair
      type(surface_data_type) :: nodes
      real(wp) :: one(3), other(3)
      logical :: met(model%mesh%nnode)
      integer :: i

      associate (slave => model%surface(pair%slave), master => model%surface(pair%master))
         if (any([slave%kind, master%kind] /= surface_of%faces)) return
         one = surface_vector(model%mesh, scene%etype%cell, slave)
         other = surface_vector(model%mesh, scene%etype%cell, master)
         if (dot_product(one, other) <= 0.5_wp*norm2(one)*norm2(other)) return
         met = .false.
         do i = 1, size(slave%element)
            associate (cell => scene%etype(model%mesh%etype(slave%element(i)))%cell, &
               & f => slave%face(i))
               met(model%mesh%conn(cell%face_node(:cell%face_nnode(f), f), slave%element(i))) &
                  & = .true.
            end associate
         end do
         call model%log%say(severity%warning, 'W0319', 'surfaces '//slave%name//' and '// &
            & master%name//' of *TIE look the same way: the nodes of '//slave%name// &
            & ' are tied to the nearest points', pair%at, &
            & help='two bodies overlap there, or a face number is wrong')
         nodes%name = slave%name
         nodes%at = slave%at
      end associate
      nodes%kind = surface_of%nodes
      nodes%node = pack([(i, i=1, size(met))], met)
      allocate (nodes%area(size(nodes%node)), source=0.0_wp)
      model%surface = [model%surface, nodes]
      pair%slave = size(model%surface)
   end subroutine turn_round
end module lopin_build_ties
