!> `*PRE-TENSION SECTION`: a body is cut along a surface of element faces, and one node moves the
!> two sides against each other along the normal.
!>
!> Nodes of the section get a twin, which the elements beyond the section take. With n the normal
!> out of the elements of the surface and s the displacement (dof 1) of the pre-tension node, every
!> twin follows u(twin) = u(node) - n s: s > 0 pulls the sides together, and the force that is
!> conjugate to s is the tension of the bolt.
module lopin_build_pretension
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   use lopin_model, only : model_type, equation_type, surface_of, temperature_type
   use lopin_face_vectors, only : surface_vector, centre
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, complain
   use lopin_build_scene, only : scene_type, need_word, node_of
   use lopin_build_surfaces, only : surface_named
   implicit none
   private
   public :: cut_type, cut_sections, join_sections

   !> One section: its nodes and their twins.
   type :: cut_type
      type(location_type) :: at
      integer, allocatable :: node(:), twin(:)
      integer :: mover = 0                     !! the pre-tension node
      real(wp) :: normal(3) = 0.0_wp           !! out of the elements of the surface
   end type cut_type

contains

   !> Give the nodes of all sections their twins: before anything counts the nodes.
   subroutine cut_sections(cuts, model, deck, scene)
      type(cut_type), allocatable, intent(out) :: cuts(:)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(cut_type) :: cut
      integer :: k, surface
      logical :: found

      allocate (cuts(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'PRE-TENSION SECTION') cycle
            call read_section(cut, surface, model, scene, block, scene%card(k)%scope)
            if (surface == 0 .or. cut%mover == 0) cycle
            call find_normal(cut, model, scene, block, surface, found)
            if (.not. found) cycle
            call part_elements(cut, model, scene, surface)
            cuts = [cuts, cut]
         end associate
      end do
   end subroutine cut_sections

   subroutine read_section(cut, surface, model, scene, block, scope)
      type(cut_type), intent(out) :: cut
      integer, intent(out) :: surface
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: found

      cut%at = block%at
      surface = 0
      call need_word(block, 'NODE', word, at, found, model%log)
      if (found) cut%mover = node_of(scene, model%mesh, word, scope, at, model%log)
      call need_word(block, 'SURFACE', word, at, found, model%log)
      if (found) surface = surface_named(model, scene, word, scope, at)
      if (surface == 0) return
      if (model%surface(surface)%kind == surface_of%faces) return
      call complain(model%log, 'E0315', 'surface `'//model%surface(surface)%name//'` of '// &
         & '*PRE-TENSION SECTION has no element faces', at, help='*SURFACE, TYPE=ELEMENT')
      surface = 0
   end subroutine read_section

   !> The nodes of the faces, and their mean normal; the direction of the deck if it gives one.
   subroutine find_normal(cut, model, scene, block, surface, found)
      type(cut_type), intent(inout) :: cut
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: surface
      logical, intent(out) :: found
      type(field_type), allocatable :: field(:)
      logical :: met(model%mesh%nnode)
      real(wp) :: mean(3), given(3), length
      integer :: i, n, node

      met = .false.
      mean = surface_vector(model%mesh, scene%etype%cell, model%surface(surface))
      associate (s => model%surface(surface))
         do i = 1, size(s%element)
            associate (cell => scene%etype(model%mesh%etype(s%element(i)))%cell, f => s%face(i))
               met(model%mesh%conn(cell%face_node(:cell%face_nnode(f), f), s%element(i))) = .true.
            end associate
         end do
      end associate
      cut%node = pack([(node, node=1, size(met))], met)
      length = norm2(mean)
      given = 0.0_wp
      if (block%nline > 0) then
         call split_fields(block%line(1), field, n)
         do i = 1, min(3, n)
            call field_real(field(i), given(i), model%log, found)
         end do
      end if
      if (norm2(given) > 0.0_wp) then
         given = given/norm2(given)
         found = abs(dot_product(given, mean)) > 0.5_wp*length .and. length > 0.0_wp
         cut%normal = sign(1.0_wp, dot_product(given, mean))*given
      else
         found = length > 0.0_wp
         if (found) cut%normal = mean/length
      end if
      if (.not. found) call complain(model%log, 'E0315', 'the faces of *PRE-TENSION SECTION '// &
         & 'do not lie across its direction', block%at, &
         & help='the data line is the normal of the section; the surface lies in one plane')
   end subroutine find_normal

   !> Elements beyond the section take the twins.
   subroutine part_elements(cut, model, scene, surface)
      type(cut_type), intent(inout) :: cut
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: surface
      integer :: twin_of(0:model%mesh%nnode), e, i, n
      logical :: stays

      call add_twins(cut, model)
      twin_of = 0
      twin_of(cut%node) = cut%twin
      do e = 1, model%mesh%nelement
         associate (nodes => model%mesh%conn(:, e))
            if (.not. any(twin_of(nodes) > 0)) cycle
            n = scene%etype(model%mesh%etype(e))%cell%ncorner
            stays = any(model%surface(surface)%element == e)
            if (.not. stays) stays = dot_product(centre(model%mesh, nodes(:n)) &
               & - centre(model%mesh, pack(nodes, twin_of(nodes) > 0)), cut%normal) < 0.0_wp
            if (stays) cycle
            do i = 1, size(nodes)
               if (twin_of(nodes(i)) > 0) nodes(i) = twin_of(nodes(i))
            end do
         end associate
      end do
   end subroutine part_elements

   subroutine add_twins(cut, model)
      type(cut_type), intent(inout) :: cut
      type(model_type), intent(inout) :: model
      real(wp), allocatable :: x(:, :)
      integer :: i, n, last

      associate (mesh => model%mesh)
         n = size(cut%node)
         last = maxval(mesh%node_label)
         cut%twin = [(mesh%nnode + i, i=1, n)]
         allocate (x(mesh%ndim, mesh%nnode + n))
         x(:, :mesh%nnode) = mesh%x
         x(:, mesh%nnode + 1:) = mesh%x(:, cut%node)
         call move_alloc(x, mesh%x)
         mesh%node_label = [mesh%node_label, [(last + i, i=1, n)]]
         mesh%node_order = [mesh%node_order, cut%twin]
         mesh%nnode = mesh%nnode + n
      end associate
   end subroutine add_twins

   !> Twins follow their nodes, in the axes and with the temperatures of those.
   subroutine join_sections(cuts, model)
      type(cut_type), intent(in) :: cuts(:)
      type(model_type), intent(inout) :: model
      type(equation_type) :: equation
      real(wp) :: axes(3, 3), along
      integer :: c, i, k

      do c = 1, size(cuts)
         associate (cut => cuts(c))
            equation%at = cut%at
            do i = 1, size(cut%node)
               call share_axes(model, cut%node(i), cut%twin(i), axes)
               do k = 1, model%mesh%ndim
                  along = dot_product(axes(k, :), cut%normal)
                  equation%node = [cut%twin(i), cut%node(i)]
                  equation%dof = [k, k]
                  equation%coefficient = [1.0_wp, -1.0_wp]
                  if (abs(along) > epsilon(along)) call add_mover(cut%mover)
                  model%equation = [model%equation, equation]
               end do
            end do
            call share_temperatures(model, cut)
         end associate
      end do

   contains

      subroutine add_mover(mover)
         integer, intent(in) :: mover

         equation%node = [equation%node, mover]
         equation%dof = [equation%dof, 1]
         equation%coefficient = [equation%coefficient, along]
      end subroutine add_mover
   end subroutine join_sections

   subroutine share_axes(model, node, twin, axes)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, twin
      real(wp), intent(out) :: axes(3, 3)
      real(wp), allocatable :: more(:, :, :)
      integer :: k, n

      axes = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
         & [3, 3])
      associate (transform => model%transform)
         n = size(transform%node)
         k = findloc(transform%node, node, dim=1)
         if (k == 0) return
         axes = transform%axes(:, :, k)
         allocate (more(3, 3, n + 1))
         more(:, :, :n) = transform%axes
         more(:, :, n + 1) = axes
         call move_alloc(more, transform%axes)
         transform%node = [transform%node, twin]
      end associate
   end subroutine share_axes

   subroutine share_temperatures(model, cut)
      type(model_type), intent(inout) :: model
      type(cut_type), intent(in) :: cut
      type(temperature_type) :: twin
      integer :: i, s, k

      if (allocated(model%temperature)) model%temperature(cut%twin) = model%temperature(cut%node)
      do s = 1, size(model%step)
         if (.not. allocated(model%step(s)%temperature)) cycle
         do i = 1, size(cut%node)
            k = findloc(model%step(s)%temperature%node, cut%node(i), dim=1)
            if (k == 0) cycle
            twin = model%step(s)%temperature(k)
            twin%node = cut%twin(i)
            model%step(s)%temperature = [model%step(s)%temperature, twin]
         end do
      end do
   end subroutine share_temperatures
end module lopin_build_pretension
