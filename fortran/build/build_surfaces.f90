!> Surfaces of the deck: faces of elements, nodes with areas, rigid tools.
module lopin_build_surfaces
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, severity
   use lopin_text, only : upper, to_text
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_tool_factory, only : tool_kinds
   use lopin_model, only : model_type, surface_data_type, surface_of, kind_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, complain
   use lopin_build_scene, only : scene_type, list_type, name_type, push, scoped, need_word, &
      & get_word, nodes_of, elements_of, find_name, no_such
   use lopin_face_neighbours, only : neighbours_type, find_neighbours, across
   use lopin_build_stl, only : build_stl_tool
   use lopin_build_tools, only : build_tool
   implicit none
   private
   public :: build_surfaces, surface_named

contains

   subroutine build_surfaces(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(neighbours_type) :: neighbours
      type(surface_data_type) :: surface
      character(len=:), allocatable :: name, word
      type(location_type) :: at, word_at
      integer :: k, i, known
      logical :: found

      allocate (model%surface(0), model%tool(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword /= 'SURFACE') cycle
            call need_word(block, 'NAME', name, at, found, model%log)
            if (.not. found) cycle
            surface = surface_data_type()
            surface%name = scoped(scene, scope, name)
            surface%at = at
            call get_word(block, 'TYPE', word, word_at, found)
            if (.not. found) word = 'ELEMENT'
            known = 0
            do i = 1, size(model%surface)
               if (model%surface(i)%name /= surface%name) cycle
               if ((model%surface(i)%kind == surface_of%nodes) .neqv. word == 'NODE') cycle
               known = i
               call tell_second(model, word, surface, i)
            end do
            select case (word)
            case ('ELEMENT')
               if (.not. allocated(neighbours%start)) call find_neighbours(neighbours, model, scene)
               neighbours%within = cuts_a_body(deck, scene, name)
               call read_faces(surface, model, scene, block, scope, neighbours)
            case ('NODE')
               call read_surface_nodes(surface, model, scene, block, scope)
            case default
               surface%kind = surface_of%tool
               if (word == 'STL') then
                  call build_stl_tool(surface%tool, model, deck, scene, block, scope, surface%name)
               else if (any(tool_kinds == word)) then
                  call build_tool(surface%tool, model, scene, block, scope, word, surface%name)
               else
                  call complain(model%log, 'E0301', 'surfaces of type `'//word &
                     & //'` are not known', word_at, &
                     & help='ELEMENT, NODE, SEGMENTS, CYLINDER, REVOLUTION, STL')
               end if
            end select
            if (known > 0 .and. surface%kind /= surface_of%tool) then
               call join_surfaces(model%surface(known), surface, model%mesh%nelement, &
                  & model%mesh%nnode)
            else
               model%surface = [model%surface, surface]
            end if
         end associate
      end do
   end subroutine build_surfaces

   !> Faces and nodes of two cards of one name are taken together, as sets are; a tool is one thing.
   subroutine tell_second(model, word, surface, known)
      type(model_type), intent(inout) :: model
      character(len=*), intent(in) :: word       !! TYPE of the second card
      type(surface_data_type), intent(in) :: surface
      integer, intent(in) :: known               !! surface of the first card
      character(len=:), allocatable :: text

      text = 'surface `'//surface%name//'` is defined twice, first in line '// &
         & to_text(model%surface(known)%at%line)
      if (model%surface(known)%kind == surface_of%tool .or. (word /= 'ELEMENT' &
         & .and. word /= 'NODE')) then
         call complain(model%log, 'E0205', text, surface%at)
      else
         call model%log%say(severity%warning, 'W0205', text//': the two are taken together', &
            & surface%at, help='one card for all of it, or another name')
      end if
   end subroutine tell_second

   !> Add what another surface of the same kind has and this one does not.
   subroutine join_surfaces(self, other, nelement, nnode)
      type(surface_data_type), intent(inout) :: self
      type(surface_data_type), intent(in) :: other
      integer, intent(in) :: nelement, nnode
      type(list_type) :: element, face
      logical :: met(nnode)
      integer :: i

      if (self%kind == surface_of%nodes) then
         met = .false.
         met(self%node) = .true.
         associate (new => pack([(i, i=1, size(other%node))], .not. met(other%node)))
            self%node = [self%node, other%node(new)]
            self%area = [self%area, other%area(new)]
         end associate
      else if (self%kind == surface_of%faces) then
         element%item = [self%element, other%element]
         face%item = [self%face, other%face]
         element%n = size(element%item)
         face%n = element%n
         call keep_once(nelement, element, face)
         self%element = element%item(:element%n)
         self%face = face%item(:face%n)
      end if
   end subroutine join_surfaces

   !> Is it the surface of a *PRE-TENSION SECTION?
   logical function cuts_a_body(deck, scene, name)
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k

      cuts_a_body = .false.
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword == 'PRE-TENSION SECTION') &
               & call get_word(block, 'SURFACE', word, at, cuts_a_body)
         end associate
         if (cuts_a_body) cuts_a_body = word == name
         if (cuts_a_body) return
      end do
   end function cuts_a_body

   subroutine read_surface_nodes(surface, model, scene, block, scope)
      type(surface_data_type), intent(inout) :: surface
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(field_type), allocatable :: field(:)
      integer, allocatable :: node(:)
      type(list_type) :: list
      real(wp), allocatable :: area(:)
      real(wp) :: value
      integer :: j, i, n, complaints
      logical :: found, met(model%mesh%nnode)

      surface%kind = surface_of%nodes
      met = .false.
      complaints = model%log%n
      allocate (area(model%mesh%nnode))
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call nodes_of(scene, model%mesh, field(1), scope, node, model%log)
         value = 0.0_wp
         if (n > 1) call field_real(field(2), value, model%log, found)
         do i = 1, size(node)
            if (met(node(i))) cycle
            met(node(i)) = .true.
            call push(list, node(i))
            area(list%n) = value
         end do
      end do
      if (.not. allocated(list%item)) allocate (list%item(0))
      surface%node = list%item(:list%n)
      surface%area = area(:list%n)
      if (list%n == 0 .and. model%log%n == complaints) call complain(model%log, 'E0301', &
         & 'surface `' &
         & //surface%name//'` has no nodes', surface%at)
   end subroutine read_surface_nodes

   subroutine read_faces(surface, model, scene, block, scope, neighbours)
      type(surface_data_type), intent(inout) :: surface
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(neighbours_type), intent(in) :: neighbours
      type(field_type), allocatable :: field(:)
      type(list_type) :: element, face
      integer, allocatable :: wanted(:)
      integer :: j, n, complaints

      surface%kind = surface_of%faces
      complaints = model%log%n
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call elements_of(scene, model%mesh, field(1), scope, wanted, model%log)
         if (size(wanted) == 0) cycle
         if (n == 1 .or. len(field(min(2, n))%text) == 0) then
            call take_free_faces(model, scene, wanted, element, face)
         else
            call take_faces(model, scene, wanted, field(2), neighbours, element, face)
         end if
      end do
      if (element%n == 0) allocate (element%item(0), face%item(0))
      call keep_once(model%mesh%nelement, element, face)
      surface%element = element%item(:element%n)
      surface%face = face%item(:face%n)
      if (element%n == 0 .and. model%log%n == complaints) call complain(model%log, 'E0301', &
         & 'surface `' &
         & //surface%name//'` has no faces', surface%at)
   end subroutine read_faces

   !> Without a face label: all faces that no other element has.
   subroutine take_free_faces(model, scene, wanted, element, face)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: wanted(:)
      type(list_type), intent(inout) :: element, face
      type(facets_type) :: facets
      logical, allocatable :: shared(:)
      integer :: i

      call boundary_facets(facets, model%mesh, scene%etype%cell, wanted, &
         & model%kind == kind_of%axisymmetric, shared)
      do i = 1, facets%n
         if (shared(i)) cycle
         call push(element, facets%element(i))
         call push(face, facets%face(i))
      end do
   end subroutine take_free_faces

   !> The same face of several elements; the first that is wrong is told.
   subroutine take_faces(model, scene, wanted, label, neighbours, element, face)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: wanted(:)
      type(field_type), intent(in) :: label
      type(neighbours_type), intent(in) :: neighbours
      type(list_type), intent(inout) :: element, face
      integer :: i, f, other, e

      do i = 1, size(wanted)
         e = wanted(i)
         associate (etype => scene%etype(model%mesh%etype(e)))
            f = face_number(etype%cell, upper(label%text))
            if (f == 0) then
               call complain(model%log, 'E0301', 'element '//to_text(model%mesh%element_label(e)) &
                  & //' (' &
                  & //trim(etype%word)//') has faces '//face_words(etype%cell)//'; ' &
                  & //upper(label%text) &
                  & //' does not exist', label%at)
               return
            end if
            if (.not. (etype%cell%sided .or. neighbours%within)) then
               other = across(model, etype%cell, neighbours, e, f)
               if (other > 0) then
                  call complain(model%log, 'E0301', 'face '//upper(label%text)//' of element ' &
                     & //to_text(model%mesh%element_label(e))//' is shared with element ' &
                     & //to_text(model%mesh%element_label(other))//': not on the boundary', &
                     & label%at)
                  return
               end if
            end if
         end associate
         call push(element, e)
         call push(face, f)
      end do
   end subroutine take_faces

   !> Face number of a label; 0 if there is none. CalculiX' S1 and S2 of shells are SNEG and SPOS.
   pure integer function face_number(cell, label) result(f)
      type(cell_type), intent(in) :: cell
      character(len=*), intent(in) :: label
      character(len=*), parameter :: words(6) = ['S1', 'S2', 'S3', 'S4', 'S5', 'S6']

      if (cell%sided) then
         f = 0
         if (label == 'SPOS' .or. label == 'S2') f = 1
         if (label == 'SNEG' .or. label == 'S1') f = 2
      else
         f = findloc(words(:cell%nface), label, dim=1)
      end if
   end function face_number

   pure function face_words(cell) result(text)
      type(cell_type), intent(in) :: cell
      character(len=:), allocatable :: text

      text = 'S1...S'//to_text(cell%nface)
      if (cell%sided) text = 'SPOS and SNEG'
   end function face_words

   !> A face listed twice counts once.
   pure subroutine keep_once(nelement, element, face)
      integer, intent(in) :: nelement
      type(list_type), intent(inout) :: element, face
      logical, allocatable :: met(:, :)
      integer :: i, n

      allocate (met(6, nelement), source=.false.)
      n = 0
      do i = 1, element%n
         if (met(face%item(i), element%item(i))) cycle
         met(face%item(i), element%item(i)) = .true.
         n = n + 1
         element%item(n) = element%item(i)
         face%item(n) = face%item(i)
      end do
      element%n = n
      face%n = n
   end subroutine keep_once

   !> The index of a surface; complains and returns 0 when there is none. Where nodes and faces
   !> have the same name it is the faces, which know their areas.
   integer function surface_named(model, scene, name, scope, at) result(k)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: name
      integer, intent(in) :: scope
      type(location_type), intent(in) :: at
      type(name_type) :: names(size(model%surface))
      integer :: i

      do i = 1, size(names)
         names(i)%text = model%surface(i)%name
      end do
      k = find_name(names, scoped(scene, scope, name))
      if (k == 0) k = find_name(names, upper(name))
      if (k == 0) call no_such(model%log, 'surface', upper(name), names, at)
      if (k == 0) return
      if (model%surface(k)%kind == surface_of%nodes .and. twin_of(model, k) > 0) &
         & k = twin_of(model, k)
   end function surface_named

   !> The surface of nodes with the name of one of faces, or the other way round; 0: none.
   pure integer function twin_of(model, k) result(twin)
      type(model_type), intent(in) :: model
      integer, intent(in) :: k                 !! surface; 0: none

      if (k > 0) then
         do twin = 1, size(model%surface)
            if (twin /= k .and. model%surface(twin)%name == model%surface(k)%name) return
         end do
      end if
      twin = 0
   end function twin_of
end module lopin_build_surfaces
