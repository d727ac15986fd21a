!> Nodes and elements of the deck.
module lopin_build_mesh
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_mesh, only : max_nodes_per_element, find_label
   use lopin_model, only : model_type, kind_of
   use lopin_block, only : deck_type, block_type, field_type, data_line_type, split_fields, &
      & field_real, complain, line_place
   use lopin_build_scene, only : need_integer, scene_type, need_word
   use lopin_build_parts, only : placed
   use lopin_build_element_words, only : find_element_words, set_kind
   use lopin_build_labels, only : sort_labels, find_doubles
   implicit none
   private
   public :: build_mesh

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
      call need_integer(field(1), label, model%log, ok)
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
      character(len=:), allocatable :: word
      character(len=len(model%element_word)) :: short
      type(location_type) :: at
      type(log_type) :: deaf
      integer :: k, m, e
      logical :: found

      m = lines_of(deck, scene, 'ELEMENT')
      associate (mesh => model%mesh)
         allocate (mesh%conn(max_nodes_per_element, m), source=0)
         allocate (mesh%etype(m), mesh%element_label(m), mesh%element_at(m))
         do k = 1, scene%ncard
            associate (block => deck%block(scene%card(k)%block))
               if (block%keyword /= 'ELEMENT') cycle
               call need_word(block, 'TYPE', word, at, found, deaf)
               short = word
               e = findloc(model%element_word, short, dim=1)
               if (e == 0) cycle
               call read_element_block(model, scene, block, scene%card(k)%scope, e)
            end associate
         end do
         m = mesh%nelement
         mesh%conn = mesh%conn(:, :m)
         mesh%etype = mesh%etype(:m)
         mesh%element_label = mesh%element_label(:m)
         mesh%element_at = mesh%element_at(:m)
         allocate (mesh%section(m), source=0)
         call sort_labels(mesh%element_label, mesh%element_order)
         call find_doubles(model%log, 'element', mesh%element_label, mesh%element_order, &
            & mesh%element_at%file, mesh%element_at%line)
      end associate
   end subroutine read_elements

   !> The elements of one card: a number and as many nodes as the type has, over several lines.
   subroutine read_element_block(model, scene, block, scope, e)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      integer, intent(in) :: e                  !! index of the type
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
               call need_integer(field(i), number, model%log, ok)
               if (.not. ok) number = 0
               if (have == 0) then
                  if (ok .and. number < 1) call complain(model%log, 'E0103', &
                     & 'element numbers start at 1', field(i)%at)
                  mesh%nelement = mesh%nelement + 1
                  mesh%element_label(mesh%nelement) = number + scene%element_offset(scope)
                  mesh%etype(mesh%nelement) = e
                  mesh%element_at(mesh%nelement) = line_place(block%line(j))
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

      if (model%mesh%nnode == 0) return   ! said once, of the deck
      text = 'node '//to_text(number)//' of element ' &
         & //to_text(model%mesh%element_label(model%mesh%nelement)) &
         & //' does not exist'
      text = text//'; numbers run ' &
         & //to_text(minval(model%mesh%node_label))//'-' &
         & //to_text(maxval(model%mesh%node_label))
      call complain(model%log, 'E0202', text, at)
   end subroutine lost_node

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
