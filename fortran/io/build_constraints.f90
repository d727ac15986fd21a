!> Rigid bodies, equations between displacements, local axes of nodes.
module lopin_build_constraints
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type
   use lopin_text, only : to_text, plural
   use lopin_model, only : model_type, rigid_body_type, equation_type, surface_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & complain, line_place
   use lopin_build_scene, only : need_integer, need_real, scene_type, list_type, push, &
      & need_word, get_word, nodes_of, node_of, set_named
   use lopin_build_surfaces, only : surface_named
   use lopin_build_parts, only : placed
   implicit none
   private
   public :: build_rigid_bodies, build_equations, build_transforms

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
      call keep_followers(body, list, model%mesh%nnode)
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
   pure subroutine keep_followers(body, list, nnode)
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
   end subroutine keep_followers

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
   end subroutine build_equations

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

   subroutine build_transforms(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: word, kind
      type(location_type) :: at
      real(wp), allocatable :: axes(:, :, :)
      real(wp) :: point(6)
      integer, allocatable :: slot(:)
      integer :: k, i, s, n
      logical :: found

      allocate (model%transform%node(0), slot(model%mesh%nnode), axes(3, 3, model%mesh%nnode))
      slot = 0
      n = 0
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword /= 'TRANSFORM') cycle
            call need_word(block, 'NSET', word, at, found, model%log)
            if (.not. found) cycle
            s = set_named(scene, model%mesh%nset, 'node set', word, scope, at, model%log)
            call get_word(block, 'TYPE', kind, at, found)
            call read_points(block, point, found, model%log)
            if (s == 0 .or. .not. found) cycle
            point(:3) = placed(scene, scope, point(:3)) - merge(placed(scene, scope, [0.0_wp, &
               & 0.0_wp, 0.0_wp]), &
               & 0.0_wp, kind /= 'C')
            point(4:) = placed(scene, scope, point(4:)) - merge(placed(scene, scope, [0.0_wp, &
               & 0.0_wp, 0.0_wp]), &
               & 0.0_wp, kind /= 'C')
            associate (member => model%mesh%nset(s)%member)
               do i = 1, size(member)
                  if (slot(member(i)) == 0) then
                     n = n + 1
                     slot(member(i)) = n
                     model%transform%node = [model%transform%node, member(i)]
                  end if
                  call local_axes(kind, point, model%mesh%x(:, member(i)), &
                     & axes(:, :, slot(member(i))), found)
                  if (found) cycle
                  call complain(model%log, 'E0405', 'the points of *TRANSFORM give no axes', &
                     & line_place(block%line(1)), &
                     & help='R: a on local x, b in the xy plane, not in line with the origin; ' &
                     & //'C: a and b on the axis, no node of the set on it')
                  exit
               end do
            end associate
         end associate
      end do
      model%transform%axes = axes(:, :, :n)
   end subroutine build_transforms

   subroutine read_points(block, point, found, log)
      type(block_type), intent(in) :: block
      real(wp), intent(out) :: point(6)
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: i, n
      logical :: ok

      point = 0.0_wp
      found = block%nline > 0
      if (.not. found) then
         call complain(log, 'E0103', '*TRANSFORM needs a line with two points', block%at)
         return
      end if
      call split_fields(block%line(1), field, n)
      do i = 1, min(6, n)
         call field_real(field(i), point(i), log, ok)
      end do
   end subroutine read_points

   !> Rows are the local directions: R from two points, C radial, tangential, axial at a node.
   pure subroutine local_axes(kind, point, x, axes, found)
      character(len=*), intent(in) :: kind
      real(wp), intent(in) :: point(6)       !! a and b [length]
      real(wp), intent(in) :: x(:)           !! (ndim) the node [length]
      real(wp), intent(out) :: axes(3, 3)
      logical, intent(out) :: found
      real(wp), parameter :: smallest = 1.0e-9_wp
      real(wp) :: one(3), two(3), three(3), scale

      axes = 0.0_wp
      if (kind == 'C') then
         three = point(4:) - point(:3)
         one = -point(:3)
         one(:size(x)) = one(:size(x)) + x
         scale = norm2(three)
         if (scale > 0.0_wp) three = three/scale
         scale = norm2(one)
         one = one - three*dot_product(one, three)
         found = norm2(three) > 0.5_wp .and. norm2(one) > smallest*scale
      else
         one = point(:3)
         two = point(4:)
         three = cross(one, two)
         found = norm2(three) > smallest*norm2(one)*norm2(two)
      end if
      if (.not. found) return
      axes(1, :) = one/norm2(one)
      axes(3, :) = three/norm2(three)
      axes(2, :) = cross(axes(3, :), axes(1, :))
   end subroutine local_axes

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross
end module lopin_build_constraints
