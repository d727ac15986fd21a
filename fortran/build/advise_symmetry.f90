!> Advice on planes of symmetry that a mesh does not use.
!>
!> Exact: mesh, sections, supports, loads, pairs and tools are compared with their mirror images,
!> one by one. What this module does not compare (springs, equations, turned axes, states of the
!> start, orientations) keeps it silent.
module lopin_advise_symmetry
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type, step_type, kind_of, surface_of
   use lopin_mirror, only : mirror_type, new_mirror, image_of_face, image_of_point
   implicit none
   private
   public :: advise_symmetry, compares, add_nodes

   !> Loads and places that differ by less than this share are equal.
   real(wp), parameter :: equal = 1.0e-9_wp
   character(len=1), parameter :: axis_name(3) = ['x', 'y', 'z']

contains

   subroutine advise_symmetry(model, plane)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: plane             !! nothing varies in this direction; 0: none
      type(mirror_type) :: mirror
      type(cell_type), allocatable :: cell(:)
      character(len=:), allocatable :: planes, directions
      character(len=1) :: name
      integer :: axis, first, found

      if (.not. compares(model)) return
      call cells_of_words(model%element_word, cell)
      first = 1
      if (model%kind == kind_of%axisymmetric) first = 2
      found = 0
      do axis = first, model%mesh%ndim
         if (axis == plane) cycle
         call new_mirror(mirror, model%mesh, axis)
         if (.not. mirror%found) cycle
         if (.not. is_image(model, cell, mirror)) cycle
         name = axis_name(axis)
         if (model%kind == kind_of%axisymmetric) name = 'z'
         found = found + 1
         if (found == 1) then
            planes = name//' = '//to_text(mirror%place, 4)
            directions = to_text(axis)
         else
            planes = planes//' and '//name//' = '//to_text(mirror%place, 4)
            directions = directions//' and '//to_text(axis)
         end if
      end do
      if (found == 0) return
      call model%log%say(severity%note, 'N0364', 'the scene is its own mirror image about '// &
         & planes//': '//trim(merge('a half   ', 'a quarter', found == 1))//' of it has '// &
         & 'the same answer', model%step(1)%at, help='cut the mesh there and hold direction '// &
         & directions//' on the cut: '//to_text(model%mesh%nelement - &
         & (model%mesh%nelement + 2**found - 1)/2**found)//' of '//to_text(model%mesh%nelement)// &
         & ' elements go, forces are those of the part; a body that buckles to a side needs '// &
         & 'the whole')
   end subroutine advise_symmetry

   !> Everything in the deck is of a kind that advice on symmetry compares.
   logical function compares(model)
      type(model_type), intent(in) :: model
      integer :: i

      compares = .not. (model%kind == kind_of%rigid .or. model%start%step /= 0)
      compares = compares .and. size(model%equation) == 0 .and. size(model%spring) == 0
      compares = compares .and. size(model%initial_stress) == 0
      compares = compares .and. size(model%initial_state) == 0
      compares = compares .and. size(model%initial_traction) == 0
      compares = compares .and. .not. any(model%section%oriented)
      if (allocated(model%transform%node)) compares = compares .and. &
         & size(model%transform%node) == 0
      do i = 1, size(model%material)
         compares = compares .and. .not. allocated(model%material(i)%plastic)
      end do
      do i = 1, size(model%pair)
         if (allocated(model%pair(i)%adjust_node)) compares = compares .and. &
            & size(model%pair(i)%adjust_node) == 0
      end do
      do i = 1, size(model%rigid_body)
         compares = compares .and. model%rigid_body(i)%rotation == 0 &
            & .and. .not. any(abs(model%rigid_body(i)%start) > 0.0_wp)
      end do
   end function compares

   !> The scene is its own image: bodies, pairs, and what every step does to them.
   logical function is_image(model, cell, mirror)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(mirror_type), intent(in) :: mirror
      integer :: i

      is_image = .false.
      do i = 1, size(model%rigid_body)
         if (.not. body_is_image(model, mirror, i)) return
      end do
      do i = 1, size(model%pair)
         if (.not. surface_is_image(model, cell, mirror, model%pair(i)%slave)) return
         if (.not. surface_is_image(model, cell, mirror, model%pair(i)%master)) return
      end do
      if (allocated(model%temperature)) then
         do i = 1, size(model%temperature)
            if (mirror%node(i) == 0) cycle
            if (differ(model%temperature(i), model%temperature(mirror%node(i)))) return
         end do
      end if
      do i = 1, size(model%step)
         if (.not. supports_are_images(model, mirror, model%step(i))) return
         if (.not. loads_are_images(model, mirror, model%step(i))) return
         if (.not. faces_are_images(model, cell, mirror, model%step(i))) return
      end do
      is_image = .true.
   end function is_image

   pure logical function differ(a, b)
      real(wp), intent(in) :: a, b
      differ = abs(a - b) > equal*max(abs(a), abs(b))
   end function differ

   !> Nodes of a rigid body are images of each other.
   logical function body_is_image(model, mirror, body) result(is)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      integer, intent(in) :: body
      logical :: member(0:model%mesh%nnode)

      member = .false.
      associate (node => model%rigid_body(body)%node)
         member(node) = .true.
         is = all(member(mirror%node(node)))
      end associate
   end function body_is_image

   logical function surface_is_image(model, cell, mirror, surface) result(is)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(mirror_type), intent(in) :: mirror
      integer, intent(in) :: surface
      logical, allocatable :: has(:, :)
      real(wp) :: area(0:model%mesh%nnode)
      integer :: i, face

      is = .false.
      if (surface == 0) return
      associate (s => model%surface(surface))
         if (s%kind == surface_of%tool) then
            is = tool_is_image(model, mirror, model%tool(s%tool)%shape)
         else if (s%kind == surface_of%nodes) then
            area = -1.0_wp
            area(s%node) = s%area
            is = .not. any(differs(area(s%node), area(mirror%node(s%node))))
         else
            allocate (has(0:6, model%mesh%nelement), source=.false.)
            do i = 1, size(s%element)
               has(s%face(i), s%element(i)) = .true.
            end do
            do i = 1, size(s%element)
               associate (c => cell(model%mesh%etype(s%element(i))))
                  ! Which side of a rigid element is meant goes with the order of its nodes.
                  if (c%sided) return
                  face = image_of_face(mirror, model%mesh, c, s%element(i), s%face(i))
               end associate
               if (.not. has(face, mirror%element(s%element(i)))) return
            end do
            is = .true.
         end if
      end associate
   end function surface_is_image

   elemental logical function differs(a, b)
      real(wp), intent(in) :: a, b
      differs = abs(a - b) > equal*max(abs(a), abs(b))
   end function differs

   !> Some of the nodes among points that are tried.
   subroutine add_nodes(points, x)
      real(wp), allocatable, intent(inout) :: points(:, :)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      integer, parameter :: most = 400
      real(wp), allocatable :: all(:, :)
      integer :: i, n, every

      every = 1 + size(x, 2)/most
      n = (size(x, 2) + every - 1)/every
      allocate (all(size(x, 1), size(points, 2) + n))
      all(:, :size(points, 2)) = points
      all(:, size(points, 2) + 1:) = x(:, [(i, i=1, size(x, 2), every)])
      call move_alloc(all, points)
   end subroutine add_nodes

   !> Every point of a tool near the bodies, and beside it, and every node, has the distance that
   !> its image has.
   logical function tool_is_image(model, mirror, shape) result(is)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      class(tool_type), intent(in) :: shape
      real(wp), allocatable :: points(:, :)
      integer, allocatable :: cells(:, :)
      real(wp) :: box(shape%ndim, 2), extent, x(shape%ndim)
      type(foot_type) :: own, image
      integer :: i, side

      is = .false.
      box(:, 1) = minval(model%mesh%x, dim=2)
      box(:, 2) = maxval(model%mesh%x, dim=2)
      extent = maxval(box(:, 2) - box(:, 1))
      box(:, 1) = box(:, 1) - extent
      box(:, 2) = box(:, 2) + extent
      call shape%tessellate(box, points, cells)
      call add_nodes(points, model%mesh%x)
      do i = 1, size(points, 2)
         if (any(points(:, i) < box(:, 1) .or. points(:, i) > box(:, 2))) cycle
         call shape%project(points(:, i), own)
         do side = -1, 1
            x = points(:, i) + 0.1_wp*side*extent*own%normal(:shape%ndim)
            call shape%project(x, own)
            call shape%project(image_of_point(mirror, x), image)
            if (own%found .neqv. image%found) return
            if (abs(own%gap - image%gap) > 1.0e-6_wp*extent) return
         end do
      end do
      is = .true.
   end function tool_is_image

   !> Prescribed values: across the plane they change their sign, along it they do not. What holds a
   !> rigid body must keep it in its own image.
   logical function supports_are_images(model, mirror, step) result(are)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      type(step_type), intent(in) :: step
      real(wp) :: value(6, model%mesh%nnode)
      integer :: amplitude(6, model%mesh%nnode), i, image
      logical :: has(6, model%mesh%nnode), moves(6, model%mesh%nnode), reference(model%mesh%nnode)
      real(wp) :: sign_

      has = .false.
      value = 0.0_wp
      reference = .false.
      reference(model%rigid_body%reference) = .true.
      do i = 1, size(step%prescribed)
         associate (p => step%prescribed(i))
            has(p%dof, p%node) = .true.
            value(p%dof, p%node) = p%value
            moves(p%dof, p%node) = p%velocity
            amplitude(p%dof, p%node) = p%amplitude
         end associate
      end do
      are = .false.
      do i = 1, size(step%prescribed)
         associate (p => step%prescribed(i))
            if (reference(p%node)) cycle
            image = mirror%node(p%node)
            if (image == 0) return
            if (.not. has(p%dof, image)) return
            sign_ = merge(-1.0_wp, 1.0_wp, p%dof == mirror%axis)
            if (differ(sign_*p%value, value(p%dof, image))) return
            if (p%velocity .neqv. moves(p%dof, image)) return
            if (p%amplitude /= amplitude(p%dof, image)) return
         end associate
      end do
      are = bodies_keep_place(model, mirror, has .and. .not. abs(value) > 0.0_wp)
   end function supports_are_images

   !> Rigid bodies are held so that they remain their own images: they do not move across the plane,
   !> and turn about its normal alone.
   pure logical function bodies_keep_place(model, mirror, held) result(keep)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      logical, intent(in) :: held(:, :)        !! (6, nnode) at zero
      integer :: i, k

      keep = .false.
      do i = 1, size(model%rigid_body)
         associate (node => model%rigid_body(i)%reference)
            if (mirror%node(node) > 0) return
            if (.not. held(mirror%axis, node)) return
            do k = 4, 6
               if (k - 3 == mirror%axis .and. model%mesh%ndim == 3) cycle
               if (model%mesh%ndim == 2 .and. k < 6) cycle
               if (model%kind == kind_of%axisymmetric) cycle
               if (.not. held(k, node)) return
            end do
         end associate
      end do
      keep = .true.
   end function bodies_keep_place

   !> Forces at nodes, of volumes, and temperatures.
   logical function loads_are_images(model, mirror, step) result(are)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      type(step_type), intent(in) :: step
      real(wp) :: force(6, 0:model%mesh%nnode), heat(0:model%mesh%nnode), sign_(3)
      real(wp) :: body(3, model%mesh%nelement)
      integer :: amplitude(6, 0:model%mesh%nnode), i
      logical :: reference(model%mesh%nnode)

      are = .false.
      sign_ = 1.0_wp
      sign_(mirror%axis) = -1.0_wp
      reference = .false.
      reference(model%rigid_body%reference) = .true.
      force = 0.0_wp
      amplitude = 0
      heat = 0.0_wp
      body = 0.0_wp
      do i = 1, size(step%point_load)
         associate (p => step%point_load(i))
            force(p%dof, p%node) = force(p%dof, p%node) + p%value
            amplitude(p%dof, p%node) = p%amplitude
         end associate
      end do
      do i = 1, size(step%point_load)
         associate (p => step%point_load(i), image => mirror%node(step%point_load(i)%node))
            if (p%dof > 3) return
            if (reference(p%node)) then
               if (p%dof == mirror%axis .and. abs(p%value) > 0.0_wp) return
               cycle
            end if
            if (differ(sign_(p%dof)*force(p%dof, p%node), force(p%dof, image))) return
            if (amplitude(p%dof, p%node) /= amplitude(p%dof, image)) return
         end associate
      end do
      do i = 1, size(step%body_load)
         associate (b => step%body_load(i))
            ! Several with amplitudes are not told apart.
            if (b%amplitude /= step%body_load(1)%amplitude) return
            body(:, b%element) = body(:, b%element) + b%force
         end associate
      end do
      do i = 1, model%mesh%nelement
         if (any(differs(sign_*body(:, i), body(:, mirror%element(i))))) return
      end do
      if (allocated(step%temperature)) then
         do i = 1, size(step%temperature)
            if (step%temperature(i)%amplitude /= step%temperature(1)%amplitude) return
            heat(step%temperature(i)%node) = step%temperature(i)%value
         end do
      end if
      are = .not. any(differs(heat(1:), heat(mirror%node)) .and. mirror%node > 0)
   end function loads_are_images

   !> Pressures and tractions on faces.
   logical function faces_are_images(model, cell, mirror, step) result(are)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(mirror_type), intent(in) :: mirror
      type(step_type), intent(in) :: step
      real(wp), allocatable :: load(:, :, :)
      real(wp) :: image(4), sign_(4)
      integer :: i, face

      are = .true.
      if (size(step%face_load) == 0) return
      are = .false.
      sign_ = 1.0_wp
      sign_(1 + mirror%axis) = -1.0_wp
      allocate (load(4, 0:6, model%mesh%nelement), source=0.0_wp)
      do i = 1, size(step%face_load)
         associate (f => step%face_load(i))
            if (f%amplitude /= step%face_load(1)%amplitude) return
            load(:, f%face, f%element) = load(:, f%face, f%element) + [f%pressure, f%traction]
         end associate
      end do
      do i = 1, size(step%face_load)
         associate (f => step%face_load(i))
            associate (c => cell(model%mesh%etype(f%element)))
               if (c%sided) return
               face = image_of_face(mirror, model%mesh, c, f%element, f%face)
            end associate
            image = sign_*load(:, f%face, f%element)
            if (any(differs(image, load(:, face, mirror%element(f%element))))) return
         end associate
      end do
      are = .true.
   end function faces_are_images
end module lopin_advise_symmetry
