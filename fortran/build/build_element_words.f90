!> Element words of the deck, and what kind of scene they make.
module lopin_build_element_words
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text, nearest_word
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_model, only : model_type, kind_of
   use lopin_block, only : deck_type, complain
   use lopin_build_scene, only : scene_type, need_word
   use lopin_build_springs, only : is_spring
   implicit none
   private
   public :: find_element_words, set_kind

contains

   subroutine find_element_words(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(inout) :: scene
      type(element_type) :: etype
      character(len=:), allocatable :: word
      character(len=len(model%element_word)) :: short
      type(location_type) :: at
      integer :: k, skin
      logical :: found

      allocate (model%element_word(0), scene%etype(0), scene%etype_at(0))
      call refuse_skins(model%log, deck, scene, skin)
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'ELEMENT') cycle
            call need_word(block, 'TYPE', word, at, found, model%log)
            if (.not. found) cycle
            if (dimensions_of(word) <= skin .or. is_spring(word)) cycle
            short = word
            if (any(model%element_word == short)) cycle
            call new_element_type(etype, word, '', found)
            if (.not. found) then
               call unknown_word(model%log, word, at)
               cycle
            end if
            if (len(etype%note) > 0) call model%log%say(severity%note, 'N0206', etype%note, at)
            model%element_word = [character(len=len(short)) :: model%element_word, short]
            scene%etype = [scene%etype, etype]
            scene%etype_at = [scene%etype_at, at]
         end associate
      end do
   end subroutine find_element_words

   !> Edges and faces of a mesh beside its cells, as gmsh writes them: one message for all of them.
   subroutine refuse_skins(log, deck, scene, skin)
      type(log_type), intent(inout) :: log
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(out) :: skin   !! words of so many dimensions or less have been refused
      type(log_type) :: deaf
      type(location_type) :: at, first_at
      character(len=:), allocatable :: word, cells, skins
      logical :: found
      integer :: k, pass, most

      most = 0
      skin = -1
      skins = ''
      do pass = 1, 2
         do k = 1, scene%ncard
            associate (block => deck%block(scene%card(k)%block))
               if (block%keyword /= 'ELEMENT') cycle
               call need_word(block, 'TYPE', word, at, found, deaf)
               if (.not. found) cycle
               if (pass == 1) then
                  if (dimensions_of(word) <= most) cycle
                  most = dimensions_of(word)
                  cells = word
               else if (dimensions_of(word) > 0 .and. dimensions_of(word) < most) then
                  if (len(skins) == 0) first_at = at
                  if (index(', '//skins//',', ', '//word//',') > 0) cycle
                  if (len(skins) > 0) skins = skins//', '
                  skins = skins//word
               end if
            end associate
         end do
      end do
      if (len(skins) == 0) return
      skin = most - 1
      call complain(log, 'E0206', skins//' cannot stand beside '//cells//': one scene does not '// &
         & 'mix dimensions', first_at, note='gmsh writes the edges and faces of a part as '// &
         & 'elements, too; Lopin has solids only, no trusses, beams or shells', help='leave '// &
         & 'them out: `lopin convert part.msh part.inp` makes a deck of gmsh''s mesh with its '// &
         & 'groups as sets and surfaces')
   end subroutine refuse_skins

   !> Of the body that elements of a type make: 3, 2, or 1; 0: unknown, or rigid.
   pure integer function dimensions_of(word) result(n)
      character(len=*), intent(in) :: word

      n = 0
      if (index(word, 'C3D') == 1) then
         n = 3
      else if (any(word(:min(3, len(word))) == ['CPE', 'CPS', 'CAX', 'M3D', 'STR']) .or. &
         & any(word == ['S3 ', 'S4 ', 'S6 ', 'S8 ', 'S3R', 'S4R', 'S8R'])) then
         n = 2
      else if (any(word(:min(3, len(word))) == ['T3D', 'T2D', 'B31', 'B32', 'B21', 'B22'])) then
         n = 1
      end if
   end function dimensions_of

   subroutine unknown_word(log, word, at)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: word
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: label, help

      help = 'elements are CPE, CPS, CAX 3 4 6 8, C3D 4 6 8 10 15 20, rigid R2D2, RAX2, R3D3, R3D4'
      if (dimensions_of(word) > 0) help = help//'; there are no trusses, beams or shells'
      label = 'not an element of Lopin'
      if (len(nearest_word(word, element_words)) > 0) label = 'did you mean ' &
         & //nearest_word(word, element_words)//' ?'
      call complain(log, 'E0206', 'element type `'//word//'` is not known', at, label=label, &
         & help=help)
   end subroutine unknown_word

   !> Dimensions and kind of the scene; every word must agree with the first.
   subroutine set_kind(model, scene)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer :: i, first

      first = 0
      do i = 1, size(scene%etype)
         associate (etype => scene%etype(i))
            if (model%mesh%ndim == 0) then
               model%mesh%ndim = etype%ndim
               first = i
            end if
            if (etype%ndim /= model%mesh%ndim) then
               call mixed(model%log, scene, first, i, 'dimensions')
            else if ((etype%axisymmetric .neqv. scene%etype(first)%axisymmetric) &
               & .and. all([etype%kind, scene%etype(first)%kind] /= element_kind%plane_stress)) then
               call mixed(model%log, scene, first, i, 'plane and axisymmetric elements')
            end if
            if (etype%kind == element_kind%rigid) cycle
            if (model%kind == 0) model%kind = etype%kind
            if (etype%axisymmetric .neqv. model%kind == kind_of%axisymmetric) &
               & call tell_flat(model, scene, i)
            if (etype%axisymmetric) model%kind = kind_of%axisymmetric
            if (etype%kind == kind_of%plane_strain .and. model%kind == kind_of%plane_stress) &
               & model%kind = kind_of%plane_strain
         end associate
      end do
      if (model%kind == 0) model%kind = kind_of%rigid
      if (model%mesh%ndim == 0) model%mesh%ndim = 3
   end subroutine set_kind

   !> Plane elements beside axisymmetric ones: once.
   subroutine tell_flat(model, scene, i)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: i                  !! type that makes the scene mixed

      if (count(scene%etype(:i)%axisymmetric .neqv. scene%etype(i)%axisymmetric) &
         & == 0) return
      if (count(scene%etype(:i)%axisymmetric .eqv. scene%etype(i)%axisymmetric) > 1) return
      call model%log%say(severity%note, 'N0206', 'plane elements stand beside axisymmetric '// &
         & 'ones: their thickness is that of all of them around the circumference, and their '// &
         & 'nodes move radially together', scene%etype_at(i))
   end subroutine tell_flat

   subroutine mixed(log, scene, first, other, what)
      type(log_type), intent(inout) :: log
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: first, other
      character(len=*), intent(in) :: what

      character(len=:), allocatable :: help

      help = ''
      if (what /= 'dimensions') help = 'plane stress (CPS) may stand beside CAX: ribs and bolts'
      call complain(log, 'E0206', trim(scene%etype(other)%word)//' cannot stand beside ' &
         & //trim(scene%etype(first)%word)//' of line '//to_text(scene%etype_at(first)%line) &
         & //': one scene does not mix '//what, scene%etype_at(other), help=help)
   end subroutine mixed
end module lopin_build_element_words
