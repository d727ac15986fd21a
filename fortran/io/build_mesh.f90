!> Nodes and elements of the deck, and what kind of scene they make.
module lopin_build_mesh
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : parse_integer, to_text, nearest_word, upper
   use lopin_mesh, only : max_nodes_per_element, find_label
   use lopin_element_type, only : element_type, element_words, element_kind, new_element_type
   use lopin_model, only : model_type, kind_of
   use lopin_block, only : deck_type, block_type, field_type, data_line_type, split_fields, &
      & field_real, &
      & field_integer, complain, line_place, has_parameter
   use lopin_build_scene, only : scene_type, need_word
   use lopin_build_parts, only : placed
   implicit none
   private
   public :: build_mesh, sort_labels

contains

   subroutine build_mesh(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(inout) :: scene

      call find_element_words(model, deck, scene)
      call set_kind(model, scene)
      call read_nodes(model, deck, scene)
      call read_elements(model, deck, scene)
      call tell_offsets(model, scene)
   end subroutine build_mesh

   subroutine find_element_words(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(inout) :: scene
      type(element_type) :: etype
      character(len=:), allocatable :: word
      character(len=8) :: short
      type(location_type) :: at
      integer :: k
      logical :: found

      allocate (model%element_word(0), scene%etype(0), scene%etype_at(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'ELEMENT') cycle
            call need_word(block, 'TYPE', word, at, found, model%log)
            if (.not. found) cycle
            short = word
            if (any(model%element_word == short)) cycle
            call new_element_type(etype, word, '', found)
            if (.not. found) then
               call unknown_word(model%log, word, at)
               cycle
            end if
            if (len(etype%note) > 0) call model%log%say(severity%note, 'N0206', etype%note, at)
            model%element_word = [character(len=8) :: model%element_word, short]
            scene%etype = [scene%etype, etype]
            scene%etype_at = [scene%etype_at, at]
         end associate
      end do
   end subroutine find_element_words

   subroutine unknown_word(log, word, at)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: word
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: label, help

      help = 'elements are CPE, CPS, CAX 3 4 6 8, C3D 4 6 8 10 15 20, rigid R2D2, RAX2, R3D3, R3D4'
      if (any(word(1:1) == ['T', 'M', 'S', 'B'])) help = help &
         & //'; gmsh writes the boundary as elements: save only the cells of the highest dimension'
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
            else if (etype%axisymmetric .neqv. scene%etype(first)%axisymmetric) then
               call mixed(model%log, scene, first, i, 'plane and axisymmetric elements')
            end if
            if (etype%kind == element_kind%rigid) cycle
            if (model%kind == 0) model%kind = etype%kind
            if (etype%kind == kind_of%plane_strain .and. model%kind == kind_of%plane_stress) &
               & model%kind = kind_of%plane_strain
         end associate
      end do
      if (model%kind == 0) model%kind = kind_of%rigid
      if (model%mesh%ndim == 0) model%mesh%ndim = 3
   end subroutine set_kind

   subroutine mixed(log, scene, first, other, what)
      type(log_type), intent(inout) :: log
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: first, other
      character(len=*), intent(in) :: what
      character(len=:), allocatable :: help

      help = ''
      if (what == 'dimensions') help = 'gmsh writes the boundary as elements: save only the ' &
         & //'cells of the highest dimension'
      call complain(log, 'E0206', trim(scene%etype(other)%word)//' cannot stand beside ' &
         & //trim(scene%etype(first)%word)//' of line '//to_text(scene%etype_at(first)%line) &
         & //': one scene does not mix '//what, scene%etype_at(other), help=help)
   end subroutine mixed

   subroutine read_nodes(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(field_type), allocatable :: field(:)
      integer, allocatable :: file(:), line(:)
      real(wp) :: x(3)
      integer :: k, j, n, m, label
      logical :: ok

      m = lines_of(deck, scene, 'NODE')
      associate (mesh => model%mesh)
         allocate (mesh%x(mesh%ndim, m), mesh%node_label(m), file(m), line(m))
         m = 0
         do k = 1, scene%ncard
            associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
               if (block%keyword /= 'NODE') cycle
               do j = 1, block%nline
                  call split_fields(block%line(j), field, n)
                  if (n == 0) cycle
                  call read_node(model, field(:n), label, x, ok)
                  if (.not. ok) cycle
                  if (scope > 0) x = placed(scene, scope, x)
                  m = m + 1
                  mesh%node_label(m) = label + scene%node_offset(scope)
                  mesh%x(:, m) = x(:mesh%ndim)
                  file(m) = block%line(j)%file
                  line(m) = block%line(j)%line
                  call check_place(model, label, x, field(min(n, 2))%at)
               end do
            end associate
         end do
         mesh%nnode = m
         mesh%x = mesh%x(:, :m)
         mesh%node_label = mesh%node_label(:m)
         call sort_labels(mesh%node_label, mesh%node_order)
         call find_doubles(model%log, 'node', mesh%node_label, mesh%node_order, file, line)
      end associate
   end subroutine read_nodes

   pure integer function lines_of(deck, scene, keyword) result(m)
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: keyword
      integer :: k

      m = 0
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword == keyword) m = m + block%nline
         end associate
      end do
   end function lines_of

   subroutine read_node(model, field, label, x, ok)
      type(model_type), intent(inout) :: model
      type(field_type), intent(in) :: field(:)
      integer, intent(out) :: label
      real(wp), intent(out) :: x(3)
      logical, intent(out) :: ok
      integer :: i
      logical :: found

      x = 0.0_wp
      call field_integer(field(1), label, model%log, ok)
      if (ok .and. label < 1) then
         ok = .false.
         call complain(model%log, 'E0103', 'node numbers start at 1', field(1)%at)
      end if
      if (size(field) > 4) call complain(model%log, 'E0103', &
         & 'a node has a number and two or three coordinates', &
         & field(5)%at, label='one field too many')
      do i = 2, min(4, size(field))
         call field_real(field(i), x(i - 1), model%log, found)
      end do
   end subroutine read_node

   subroutine check_place(model, label, x, at)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: label
      real(wp), intent(in) :: x(3)
      type(location_type), intent(in) :: at

      if (model%mesh%ndim == 2 .and. abs(x(3)) > 0.0_wp) call complain(model%log, 'E0207', 'node ' &
         & //to_text(label)//' of a plane scene has z = '//to_text(x(3), 6), at, &
         & help='plane elements lie in the x-y plane')
      if (model%kind == kind_of%axisymmetric .and. x(1) < 0.0_wp) call complain(model%log, &
         & 'E0207', 'node ' &
         & //to_text(label)//' has a negative radius r = '//to_text(x(1), 6), at, &
         & help='in an axisymmetric scene x is the radius and y the axis')
   end subroutine check_place

   subroutine read_elements(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, allocatable :: file(:), line(:)
      character(len=:), allocatable :: word
      character(len=8) :: short
      type(location_type) :: at
      type(log_type) :: deaf
      integer :: k, m, e
      logical :: found

      m = lines_of(deck, scene, 'ELEMENT')
      associate (mesh => model%mesh)
         allocate (mesh%conn(max_nodes_per_element, m), source=0)
         allocate (mesh%etype(m), mesh%element_label(m), file(m), line(m))
         do k = 1, scene%ncard
            associate (block => deck%block(scene%card(k)%block))
               if (block%keyword /= 'ELEMENT') cycle
               call need_word(block, 'TYPE', word, at, found, deaf)
               short = word
               e = findloc(model%element_word, short, dim=1)
               if (e == 0) cycle
               call read_element_block(model, scene, block, scene%card(k)%scope, e, file, line)
            end associate
         end do
         m = mesh%nelement
         mesh%conn = mesh%conn(:, :m)
         mesh%etype = mesh%etype(:m)
         mesh%element_label = mesh%element_label(:m)
         allocate (mesh%section(m), source=0)
         call sort_labels(mesh%element_label, mesh%element_order)
         call find_doubles(model%log, 'element', mesh%element_label, mesh%element_order, file, line)
      end associate
   end subroutine read_elements

   !> The elements of one card: a number and as many nodes as the type has, over several lines.
   subroutine read_element_block(model, scene, block, scope, e, file, line)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      integer, intent(in) :: e                  !! index of the type
      integer, intent(inout) :: file(:), line(:)
      type(field_type), allocatable :: field(:)
      integer :: j, i, n, nnode, have, number
      logical :: ok

      nnode = scene%etype(e)%nnode
      have = 0      ! fields of the present element so far, with its number
      associate (mesh => model%mesh)
         do j = 1, block%nline
            call split_fields(block%line(j), field, n)
            if (have > 0 .and. .not. ends_in_comma(block%line(max(1, j - 1)))) then
               call complain(model%log, 'E0208', 'element ' &
                  & //to_text(mesh%element_label(mesh%nelement)) &
                  & //' has '//to_text(have - 1)//' nodes; '//trim(scene%etype(e)%word)//' needs ' &
                  & //to_text(nnode), line_place(block%line(j - 1)), &
                  & help='end a line with a comma when the element goes on')
               have = 0
            end if
            if (have + n > nnode + 1) then
               call too_many(model%log, trim(scene%etype(e)%word), nnode, have + n - 1, field(1), &
                  & field(n))
               return
            end if
            do i = 1, n
               call field_integer(field(i), number, model%log, ok)
               if (.not. ok) number = 0
               if (have == 0) then
                  mesh%nelement = mesh%nelement + 1
                  mesh%element_label(mesh%nelement) = number + scene%element_offset(scope)
                  mesh%etype(mesh%nelement) = e
                  file(mesh%nelement) = block%line(j)%file
                  line(mesh%nelement) = block%line(j)%line
               else
                  mesh%conn(have, mesh%nelement) = find_label(mesh%node_label, mesh%node_order, &
                     & number + scene%node_offset(scope))
                  if (mesh%conn(have, mesh%nelement) == 0 .and. ok) call lost_node(model, number, &
                     & field(i)%at)
               end if
               have = have + 1
            end do
            if (have == nnode + 1) have = 0
         end do
         if (have > 0) call complain(model%log, 'E0208', 'element ' &
            & //to_text(mesh%element_label(mesh%nelement)) &
            & //' has '//to_text(have - 1)//' nodes; '//trim(scene%etype(e)%word)//' needs ' &
            & //to_text(nnode), &
            & line_place(block%line(block%nline)))
      end associate
   end subroutine read_element_block

   pure logical function ends_in_comma(line)
      type(data_line_type), intent(in) :: line
      integer :: last

      last = verify(line%text, ' '//achar(9), back=.true.)
      ends_in_comma = .false.
      if (last > 0) ends_in_comma = line%text(last:last) == ','
   end function ends_in_comma

   subroutine too_many(log, word, nnode, have, first, last)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: word
      integer, intent(in) :: nnode, have
      type(field_type), intent(in) :: first, last
      character(len=:), allocatable :: help

      help = 'check TYPE= against the mesh'
      if (word == 'C3D6' .or. have == 18) help = 'gmsh writes complete wedges of 18 nodes ' &
         & //'as C3D6: set Mesh.SecondOrderIncomplete=1 and write TYPE=C3D15'
      if (have == 27 .or. have == 9) help = 'set Mesh.SecondOrderIncomplete=1 in gmsh: quadratic ' &
         & //'elements have nodes on corners and edges only'
      call complain(log, 'E0208', 'element `'//first%text//'` has at least '//to_text(have) &
         & //' nodes; '//word &
         & //' has '//to_text(nnode), location_type(first%at%file, first%at%line, first%at%first, &
         & last%at%last), &
         & help=help)
   end subroutine too_many

   subroutine lost_node(model, number, at)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: number
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: text

      text = 'node '//to_text(number)//' of element ' &
         & //to_text(model%mesh%element_label(model%mesh%nelement)) &
         & //' does not exist'
      if (model%mesh%nnode > 0) text = text//'; numbers run ' &
         & //to_text(minval(model%mesh%node_label))//'-' &
         & //to_text(maxval(model%mesh%node_label))
      call complain(model%log, 'E0202', text, at)
   end subroutine lost_node

   !> The permutation that sorts labels; decks are nearly always sorted already.
   pure subroutine sort_labels(label, order)
      integer, intent(in) :: label(:)
      integer, allocatable, intent(out) :: order(:)
      integer, allocatable :: from(:), to(:)
      integer :: n, i, width, low, middle, high

      n = size(label)
      order = [(i, i=1, n)]
      if (all(label(2:) > label(:max(0, n - 1)))) return
      from = order
      to = order
      width = 1
      do while (width < n)
         do low = 1, n, 2*width
            middle = min(low + width - 1, n)
            high = min(low + 2*width - 1, n)
            call merge_runs(label, from(low:middle), from(middle + 1:high), to(low:high))
         end do
         from = to
         width = 2*width
      end do
      order = from
   end subroutine sort_labels

   pure subroutine merge_runs(label, left, right, both)
      integer, intent(in) :: label(:), left(:), right(:)
      integer, intent(out) :: both(:)
      integer :: i, j, k

      i = 1
      j = 1
      do k = 1, size(both)
         if (j > size(right)) then
            both(k) = left(i)
            i = i + 1
         else if (i > size(left)) then
            both(k) = right(j)
            j = j + 1
         else if (label(left(i)) <= label(right(j))) then
            both(k) = left(i)
            i = i + 1
         else
            both(k) = right(j)
            j = j + 1
         end if
      end do
   end subroutine merge_runs

   subroutine find_doubles(log, what, label, order, file, line)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: what
      integer, intent(in) :: label(:), order(:)
      integer, intent(in) :: file(:), line(:)   !! where each was defined
      integer :: i, one, two

      do i = 2, size(order)
         one = order(i - 1)
         two = order(i)
         if (label(one) /= label(two)) cycle
         call complain(log, 'E0205', what//' '//to_text(label(one)) &
            & //' is defined twice, first in line ' &
            & //to_text(line(one)), location_type(file(two), line(two), 1, &
            & len(to_text(label(two)))))
      end do
   end subroutine find_doubles

   !> Say how the numbers of instances were moved, so that results can be read.
   subroutine tell_offsets(model, scene)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: name
      integer :: i

      do i = 0, size(scene%instance)
         if (scene%node_offset(i) == 0 .and. scene%element_offset(i) == 0) cycle
         name = 'the assembly'
         if (i > 0) name = 'instance '//scene%instance(i)%name
         call model%log%say(severity%note, 'N0209', 'numbers of '//name//': nodes +' &
            & //to_text(scene%node_offset(i))//', elements +'//to_text(scene%element_offset(i)), &
            & note='parts are copied into one mesh; results show the new numbers')
      end do
   end subroutine tell_offsets
end module lopin_build_mesh
