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
   use lopin_model, only : model_type, step_type, kind_of
   use lopin_pair_activity, only : active_pairs
   use lopin_mirror, only : mirror_type, new_mirror, image_of_face
   use lopin_mirror_scene, only : scene_mirror_type, mirror_scene, differs
   use lopin_step_values, only : add_body_forces, put_temperatures
   implicit none
   private
   public :: advise_symmetry, compares, made_of

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
         call new_mirror(mirror, model%mesh, axis, made_of(model))
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

   !> The first section that is like that of each element; 0: it has none.
   pure function made_of(model) result(first)
      type(model_type), intent(in) :: model
      integer :: first(model%mesh%nelement), of(0:size(model%section)), i, j

      of(0) = 0
      do i = 1, size(model%section)
         associate (own => model%section(i))
            do j = 1, i
               associate (other => model%section(j))
                  if (other%material == own%material .and. other%formulation == own%formulation &
                     & .and. .not. differs(other%thickness, own%thickness)) exit
               end associate
            end do
            of(i) = min(j, i)
         end associate
      end do
      first = of(model%mesh%section)
   end function made_of

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
      type(scene_mirror_type) :: scene
      integer :: i

      is_image = .false.
      call mirror_scene(scene, model, cell, mirror)
      if (.not. scene%found) return
      if (allocated(model%temperature)) then
         do i = 1, size(model%temperature)
            if (mirror%node(i) == 0) cycle
            if (differs(model%temperature(i), model%temperature(mirror%node(i)))) return
         end do
      end if
      do i = 1, size(model%step)
         associate (active => active_pairs(model, i))
            if (any(active .neqv. active(scene%pair))) return
         end associate
         if (.not. supports_are_images(model, mirror, scene, model%step(i))) return
         if (.not. loads_are_images(model, mirror, scene, model%step(i))) return
         if (.not. faces_are_images(model, cell, mirror, model%step(i))) return
      end do
      is_image = .true.
   end function is_image

   !> Prescribed values: across the plane they change their sign, along it they do not. What holds a
   !> rigid body must keep it in its own image, or do the same to the body that is its image.
   logical function supports_are_images(model, mirror, scene, step) result(are)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      type(scene_mirror_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      real(wp) :: value(6, model%mesh%nnode)
      integer :: amplitude(6, model%mesh%nnode), i, image
      logical :: has(6, model%mesh%nnode), moves(6, model%mesh%nnode)
      real(wp) :: sign_

      has = .false.
      value = 0.0_wp
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
            image = scene%node(p%node)
            if (image == p%node .and. mirror%node(p%node) == 0) cycle   ! a tool that stays
            if (image == 0) return
            if (.not. has(p%dof, image)) return
            if (p%dof > 3 .and. abs(p%value) > 0.0_wp) return
            sign_ = merge(-1.0_wp, 1.0_wp, p%dof == mirror%axis)
            if (differs(sign_*p%value, value(p%dof, image))) return
            if (p%velocity .neqv. moves(p%dof, image)) return
            if (p%amplitude /= amplitude(p%dof, image)) return
         end associate
      end do
      are = bodies_keep_place(model, mirror, scene, has .and. .not. abs(value) > 0.0_wp)
   end function supports_are_images

   !> Rigid bodies are held so that they remain images: they turn about the plane's normal alone,
   !> and those that are their own do not move across it.
   pure logical function bodies_keep_place(model, mirror, scene, held) result(keep)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      type(scene_mirror_type), intent(in) :: scene
      logical, intent(in) :: held(:, :)        !! (6, nnode) at zero
      integer :: i, k

      keep = .false.
      do i = 1, size(model%rigid_body)
         associate (node => model%rigid_body(i)%reference)
            if (mirror%node(node) > 0) return
            if (scene%node(node) == node .and. .not. held(mirror%axis, node)) return
            do k = 4, 6
               if (k - 3 == mirror%axis .and. model%mesh%ndim == 3 &
                  & .and. scene%node(node) == node) cycle
               if (model%mesh%ndim == 2 .and. k < 6) cycle
               if (model%kind == kind_of%axisymmetric) cycle
               if (.not. held(k, node)) return
            end do
         end associate
      end do
      keep = .true.
   end function bodies_keep_place

   !> Forces at nodes, of volumes, and temperatures.
   logical function loads_are_images(model, mirror, scene, step) result(are)
      type(model_type), intent(in) :: model
      type(mirror_type), intent(in) :: mirror
      type(scene_mirror_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      real(wp) :: force(6, 0:model%mesh%nnode), heat(0:model%mesh%nnode), sign_(3)
      real(wp) :: body(3, model%mesh%nelement)
      integer :: amplitude(6, 0:model%mesh%nnode), i
      logical :: alike

      are = .false.
      sign_ = 1.0_wp
      sign_(mirror%axis) = -1.0_wp
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
         associate (p => step%point_load(i), image => scene%node(step%point_load(i)%node))
            if (p%dof > 3) return
            if (differs(sign_(p%dof)*force(p%dof, p%node), force(p%dof, image))) return
            if (amplitude(p%dof, p%node) /= amplitude(p%dof, image)) return
         end associate
      end do
      call add_body_forces(step, body, alike)
      if (.not. alike) return
      do i = 1, model%mesh%nelement
         if (any(differs(sign_*body(:, i), body(:, mirror%element(i))))) return
      end do
      call put_temperatures(step, heat(1:), alike)
      are = alike .and. .not. any(differs(heat(1:), heat(mirror%node)) .and. mirror%node > 0)
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
