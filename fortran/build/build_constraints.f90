!> Rigid bodies and equations between displacements.
module lopin_build_constraints
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_model, only : model_type, rigid_body_type, equation_type, surface_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, complain, line_place
   use lopin_build_scene, only : need_integer, need_real, scene_type, list_type, push, get_word, &
      & nodes_of, node_of, set_named
   use lopin_build_surfaces, only : surface_named
   implicit none
   private
   public :: build_rigid_bodies, build_equations

contains

   subroutine build_rigid_bodies(model, deck, scene, rigid)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      logical, intent(out) :: rigid(:)       !! (nelement) elements of a rigid body
      type(rigid_body_type) :: body
      integer, allocatable :: owner(:)
      integer :: k

      rigid = .false.
      allocate (model%rigid_body(0))
      allocate (owner(model%mesh%nnode), source=0)
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword /= 'RIGID BODY') cycle
            call read_body(body, model, scene, block, scope, rigid)
            model%rigid_body = [model%rigid_body, body]
            if (body%tool > 0) model%tool(body%tool)%rigid_body = size(model%rigid_body)
            call claim_nodes(model, owner)
         end associate
      end do
      where (rigid) model%mesh%section = 0
   end subroutine build_rigid_bodies

   subroutine read_body(body, model, scene, block, scope, rigid)
      type(rigid_body_type), intent(out) :: body
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      logical, intent(inout) :: rigid(:)
      character(len=*), parameter :: node_words(3) = [character(len=8) :: 'NSET', 'PIN NSET', &
         & 'TIE NSET']
      character(len=:), allocatable :: word
      type(location_type) :: at
      type(list_type) :: list
      integer :: i, j, k
      logical :: found

      body%at = block%at
      body%name = '*RIGID BODY'
      call get_word(block, 'REF NODE', word, at, found)
      if (found) body%reference = node_of(scene, model%mesh, word, scope, at, model%log)
      if (.not. found) call complain(model%log, 'E0305', '*RIGID BODY has no REF NODE', block%at, &
         & help='give a node number or a set of one node: it carries the motion of the body')
      call get_word(block, 'ROT NODE', word, at, found)
      if (found) body%rotation = node_of(scene, model%mesh, word, scope, at, model%log)
      call get_word(block, 'ANALYTICAL SURFACE', word, at, found)
      if (found) then
         body%name = word
         call take_tool(body, model, scene, word, scope, at)
      end if
      call get_word(block, 'ELSET', word, at, found)
      if (found) then
         body%name = word
         k = set_named(scene, model%mesh%elset, 'element set', word, scope, at, model%log)
         if (k > 0) call take_elements(model, model%mesh%elset(k)%member, rigid, list)
      end if
      do i = 1, size(node_words)
         call get_word(block, trim(node_words(i)), word, at, found)
         if (.not. found) cycle
         if (body%name == '*RIGID BODY') body%name = word
         k = set_named(scene, model%mesh%nset, 'node set', word, scope, at, model%log)
         if (k == 0) cycle
         do j = 1, size(model%mesh%nset(k)%member)
            call push(list, model%mesh%nset(k)%member(j))
         end do
      end do
      call pass_followers(body, list, model%mesh%nnode)
      if (body%tool == 0 .and. body%name == '*RIGID BODY') call complain(model%log, 'E0305', &
         & '*RIGID BODY moves nothing', block%at, help='ANALYTICAL SURFACE=, ELSET= or NSET=')
   end subroutine read_body

   subroutine take_tool(body, model, scene, word, scope, at)
      type(rigid_body_type), intent(inout) :: body
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: word
      integer, intent(in) :: scope
      type(location_type), intent(in) :: at
      integer :: k

      k = surface_named(model, scene, word, scope, at)
      if (k == 0) return
      if (model%surface(k)%kind /= surface_of%tool) then
         call complain(model%log, 'E0305', 'surface `'//word &
            & //'` is not analytical: it has elements or nodes', at, &
            & help='name its elements by ELSET=')
         return
      end if
      body%tool = model%surface(k)%tool
      if (body%tool == 0) return
      if (model%tool(body%tool)%rigid_body > 0) then
         call complain(model%log, 'E0305', 'surface `'//word &
            & //'` moves with another rigid body already, of line ' &
            & //to_text(model%rigid_body(model%tool(body%tool)%rigid_body)%at%line), at)
         body%tool = 0
      end if
   end subroutine take_tool

   subroutine take_elements(model, element, rigid, list)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element(:)
      logical, intent(inout) :: rigid(:)
      type(list_type), intent(inout) :: list
      integer :: i, j

      do i = 1, size(element)
         rigid(element(i)) = .true.
         do j = 1, count(model%mesh%conn(:, element(i)) > 0)
            call push(list, model%mesh%conn(j, element(i)))
         end do
      end do
   end subroutine take_elements

   !> Each node once, without the reference and the rotation node.
   pure subroutine pass_followers(body, list, nnode)
      type(rigid_body_type), intent(inout) :: body
      type(list_type), intent(in) :: list
      integer, intent(in) :: nnode
      logical, allocatable :: met(:)
      integer :: i, n

      allocate (met(0:nnode), source=.false.)
      met([0, body%reference, body%rotation]) = .true.
      allocate (body%node(list%n))
      n = 0
      do i = 1, list%n
         if (met(list%item(i))) cycle
         met(list%item(i)) = .true.
         n = n + 1
         body%node(n) = list%item(i)
      end do
      body%node = body%node(:n)
   end subroutine pass_followers

   !> A node follows one body only.
   subroutine claim_nodes(model, owner)
      type(model_type), intent(inout) :: model
      integer, intent(inout) :: owner(:)     !! body that each node follows, 0: none
      integer :: b, i, node

      b = size(model%rigid_body)
      do i = 1, size(model%rigid_body(b)%node)
         node = model%rigid_body(b)%node(i)
         if (owner(node) > 0) then
            call complain(model%log, 'E0403', 'node '//to_text(model%mesh%node_label(node)) &
               & //' follows two rigid bodies, of lines ' &
               & //to_text(model%rigid_body(owner(node))%at%line)//' and ' &
               & //to_text(model%rigid_body(b)%at%line), model%rigid_body(b)%at)
            return
         end if
         owner(node) = b
      end do
   end subroutine claim_nodes

   !> The number of terms, then `node or set, dof, coefficient` three by three over several lines.
   subroutine build_equations(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(field_type), allocatable :: field(:), term(:)
      integer :: k, j, n, nterm
      logical :: found

      allocate (model%equation(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'EQUATION') cycle
            j = 1
            do while (j <= block%nline)
               call split_fields(block%line(j), field, n)
               call need_integer(field(1), nterm, model%log, found)
               if (.not. found .or. nterm < 1) then
                  if (found) call complain(model%log, 'E0103', &
                     & 'an equation has at least one term', field(1)%at)
                  exit
               end if
               allocate (term(0))
               do while (size(term) < 3*nterm .and. j < block%nline)
                  j = j + 1
                  call split_fields(block%line(j), field, n)
                  term = [term, field(:n)]
               end do
               if (size(term) /= 3*nterm) then
                  call complain(model%log, 'E0103', 'an equation of '//plural(nterm, 'term') &
                     & //' has ' &
                     & //to_text(3*nterm)//' fields: node, dof, coefficient; ' &
                     & //to_text(size(term))//' given', &
                     & line_place(block%line(j)))
                  exit
               end if
               call add_equations(model, scene, scene%card(k)%scope, term, &
                  & line_place(block%line(j)))
               deallocate (term)
               j = j + 1
            end do
            if (allocated(term)) deallocate (term)
         end associate
      end do
      call check_eliminated(model)
   end subroutine build_equations

   !> A dof is eliminated by one equation only, and not at a node that a rigid body moves.
   subroutine check_eliminated(model)
      type(model_type), intent(inout) :: model
      integer, allocatable :: taken(:, :), body(:)
      integer :: i, node, dof

      allocate (taken(6, model%mesh%nnode), body(model%mesh%nnode), source=0)
      do i = 1, size(model%rigid_body)
         body(model%rigid_body(i)%node) = i
      end do
      do i = 1, size(model%equation)
         node = model%equation(i)%node(1)
         dof = model%equation(i)%dof(1)
         if (dof < 1 .or. dof > 6) cycle
         if (taken(dof, node) > 0) then
            call complain(model%log, 'E0403', 'dof '//to_text(dof)//' of node ' &
               & //to_text(model%mesh%node_label(node))//' is eliminated twice: by the ' &
               & //'equations of lines '//to_text(model%equation(taken(dof, node))%at%line)// &
               & ' and ' &
               & //to_text(model%equation(i)%at%line), model%equation(i)%at, &
               & help='the first term of an equation is eliminated: put another one first')
         else if (body(node) > 0) then
            call complain(model%log, 'E0403', 'dof '//to_text(dof)//' of node ' &
               & //to_text(model%mesh%node_label(node))//' is eliminated by an equation ' &
               & //'and moved by *RIGID BODY of line '// &
               & to_text(model%rigid_body(body(node))%at%line), &
               & model%equation(i)%at, help='put a node that is free first')
         end if
         taken(dof, node) = i
      end do
   end subroutine check_eliminated

   !> One equation for single nodes; for sets of equal size, one for each member.
   subroutine add_equations(model, scene, scope, term, at)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: scope
      type(field_type), intent(in) :: term(:)
      type(location_type), intent(in) :: at
      type(equation_type) :: equation
      type(list_type) :: member(size(term)/3)
      integer, allocatable :: node(:)
      real(wp) :: coefficient
      integer :: i, m, number, dof
      logical :: found

      equation%at = at
      allocate (equation%node(size(member)), equation%dof(size(member)), &
         & equation%coefficient(size(member)))
      number = 1
      do i = 1, size(member)
         call nodes_of(scene, model%mesh, term(3*i - 2), scope, node, model%log)
         if (size(node) == 0) return
         member(i)%item = node
         member(i)%n = size(node)
         number = max(number, size(node))
         call need_integer(term(3*i - 1), dof, model%log, found)
         if (found .and. (dof < 1 .or. dof > 6)) call complain(model%log, 'E0404', 'dof ' &
            & //to_text(dof) &
            & //' does not exist', term(3*i - 1)%at, &
            & help='1 to 3 are translations, 4 to 6 rotations')
         equation%dof(i) = dof
         call need_real(term(3*i), coefficient, model%log, found)
         equation%coefficient(i) = coefficient
      end do
      if (.not. abs(equation%coefficient(1)) > 0.0_wp) then
         call complain(model%log, 'E0403', &
            & 'the first coefficient of an equation is zero: its dof cannot be eliminated', &
            & term(3)%at)
         return
      end if
      do i = 1, size(member)
         if (member(i)%n == number .or. member(i)%n == 1) cycle
         call complain(model%log, 'E0403', 'the sets of an equation have '//to_text(number) &
            & //' and ' &
            & //plural(member(i)%n, 'node'), term(3*i - 2)%at)
         return
      end do
      do m = 1, number
         do i = 1, size(member)
            equation%node(i) = member(i)%item(min(m, member(i)%n))
         end do
         model%equation = [model%equation, equation]
      end do
   end subroutine add_equations
end module lopin_build_constraints
