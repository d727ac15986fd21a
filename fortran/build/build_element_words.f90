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

   character(len=*), parameter :: instead_of_members = 'instead of a truss SPRINGA with '// &
      & '*SPRING, its stiffness E A/L; instead of a beam, a shell or a membrane solids that '// &
      & 'bend well: '// &
      & 'CPE8R, CPS8R, CAX8R, C3D20R, C3D8I'

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
      logical :: built                         !! trusses, beams, shells or membranes are there

      built = .false.
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
                  built = built .or. len(member_of(word)) > 0
               end if
            end associate
         end do
      end do
      if (len(skins) == 0) return
      skin = most - 1
      call complain(log, 'E0206', skins//' cannot stand beside '//cells//': '//trim(merge( &
         & 'there are no trusses, beams, shells or membranes', &
         & 'one scene does not mix dimensions               ', built)), first_at, &
         & note='gmsh writes the edges and faces of a part as elements, too: leave them out; '// &
         & '`lopin convert part.msh part.inp` makes a deck of gmsh''s mesh with its groups as '// &
         & 'sets and surfaces', help=instead_of_members)
   end subroutine refuse_skins

   !> What elements of a type make that is no solid: `trusses`, `beams` ...; '': nothing like that.
   pure function member_of(word) result(noun)
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: noun
      character(len=4) :: begin

      begin = word
      noun = ''
      if (index('0123456789', begin(2:2)) > 0) then
         if (begin(1:1) == 'S') noun = 'shells'
         if (begin(1:1) == 'B') noun = 'beams'
         if (begin(1:1) == 'T') noun = 'trusses'
      end if
      if (begin == 'STRI' .or. any(begin(:3) == ['SC6', 'SC8', 'SAX'])) noun = 'shells'
      if (begin == 'PIPE' .or. begin == 'ELBO' .or. begin == 'FRAM') noun = 'beams'
      if (any(begin(:3) == ['M3D', 'MAX', 'MCL'])) noun = 'membranes'
   end function member_of

   !> Of the body that elements of a type make: 3, 2, or 1; 0: unknown, or rigid.
   pure integer function dimensions_of(word) result(n)
      character(len=*), intent(in) :: word

      n = 0
      if (index(word, 'C3D') == 1) then
         n = 3
      else if (any(word(:min(3, len(word))) == ['CPE', 'CPS', 'CAX'])) then
         n = 2
      else if (any(member_of(word) == [character(len=9) :: 'shells', 'membranes'])) then
         n = merge(1, 2, index(word, 'AX') == 2)
      else if (len(member_of(word)) > 0) then
         n = 1
      end if
   end function dimensions_of

   subroutine unknown_word(log, word, at)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: word
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: label, help, text

      text = 'element type `'//word//'` is not known'
      label = 'not an element of Lopin'
      if (len(member_of(word)) > 0) then
         text = text//': there are no '//member_of(word)
         help = instead_of_members
      else
         help = 'elements are CPE, CPS, CAX 3 4 6 8, C3D 4 6 8 10 15 20, rigid R2D2, RAX2, '// &
            & 'R3D3, R3D4'
         if (dimensions_of(word) > 0) help = help//'; there are no trusses, beams or shells'
         if (len(nearest_word(word, element_words)) > 0) label = 'did you mean ' &
            & //nearest_word(word, element_words)//' ?'
      end if
      call complain(log, 'E0206', text, at, label=label, help=help)
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
