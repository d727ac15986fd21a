!> Advice on scenes of revolution that are meshed in space.
!>
!> Exact: skin, sections, supports, loads, slave and master faces and tools are of revolution about
!> one axis across the directions of the deck. What is not compared (see lopin_advise_symmetry, and
!> loads on nodes, tractions, temperatures that vary) keeps this module silent.
module lopin_advise_revolution
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type, step_type, kind_of, surface_of
   use lopin_advise_symmetry, only : compares
   use lopin_step_values, only : held_at_zero
   use lopin_mirror_scene, only : points_near, feet_differ
   use lopin_revolution, only : revolution_type, find_revolution, edges_are_circles
   implicit none
   private
   public :: advise_revolution

   character(len=1), parameter :: axis_name(3) = ['x', 'y', 'z']
   !> More heights at which nodes are held are not looked at.
   integer, parameter :: most_levels = 20

contains

   !> `told`: it was.
   subroutine advise_revolution(model, told)
      type(model_type), intent(inout) :: model
      logical, intent(out) :: told
      type(revolution_type) :: scene
      type(cell_type), allocatable :: cell(:)
      character(len=:), allocatable :: saving

      told = .false.
      if (model%kind /= kind_of%solid) return
      if (.not. compares(model)) return
      call cells_of_words(model%element_word, cell)
      call find_revolution(scene, model%mesh, cell)
      if (.not. scene%found) return
      told = is_of_revolution(model, cell, scene)
      if (.not. told) return
      saving = 'fewer elements, and two equations at each node'
      if (scene%cut_faces > 0) saving = to_text(scene%cut_faces)//' elements instead of '// &
         & to_text(count(model%mesh%section > 0))//', and two equations at each node'
      call model%log%say(severity%note, 'N0365', 'the scene is one of revolution about the '// &
         & axis_name(scene%axis)//' axis through '//to_text(scene%centre(1), 4)//', '// &
         & to_text(scene%centre(2), 4)//', '//to_text(scene%centre(3), 4)// &
         & ', meshed in space', model%step(1)%at, help='an axisymmetric mesh (CAX4, CAX8R) '// &
         & 'needs '//saving//'; metal that wrinkles or ears needs the mesh in space')
   end subroutine advise_revolution

   logical function is_of_revolution(model, cell, scene) result(is)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(revolution_type), intent(in) :: scene
      integer :: i, s

      is = .false.
      do i = 1, size(model%rigid_body)
         if (size(model%rigid_body(i)%node) > 0) return
      end do
      if (allocated(model%temperature)) then
         associate (t => pack(model%temperature, scene%body))
            if (size(t) > 0) then
               if (any(abs(t - t(1)) > 0.0_wp)) return
            end if
         end associate
      end if
      do i = 1, size(model%pair)
         do s = 1, 2
            if (.not. surface_revolves(merge(model%pair(i)%slave, model%pair(i)%master, s == 1))) &
               & return
         end do
      end do
      do i = 1, size(model%step)
         if (.not. cuts_are_held(model, scene, model%step(i))) return
         if (.not. supports_revolve(model, scene, model%step(i))) return
         if (.not. loads_revolve(model, cell, scene, model%step(i))) return
      end do
      is = .true.

   contains

      logical function surface_revolves(surface)
         integer, intent(in) :: surface

         surface_revolves = .false.
         if (surface == 0) return
         associate (f => model%surface(surface))
            select case (f%kind)
            case (surface_of%tool)
               surface_revolves = tool_revolves(model, scene, model%tool(f%tool)%shape)
            case (surface_of%faces)
               if (any(model%mesh%section(f%element) == 0)) return
               surface_revolves = edges_are_circles(scene, model%mesh, cell, f%element, f%face)
            end select
         end associate
      end function surface_revolves
   end function is_of_revolution

   !> Every point of a tool near the bodies, and beside it, and every node, keeps its distance when
   !> it is turned, and, but in the corners of the box around them, lies as far beyond an end.
   logical function tool_revolves(model, scene, shape) result(revolves)
      type(model_type), intent(in) :: model
      type(revolution_type), intent(in) :: scene
      class(tool_type), intent(in) :: shape
      real(wp), parameter :: angle(3) = [0.37_wp, 1.6_wp, 3.5_wp]
      real(wp), allocatable :: points(:, :)
      real(wp) :: extent, x(3), turned(3), y(2), reach
      type(foot_type) :: own, image
      integer :: i, k, side

      revolves = .false.
      call points_near(model%mesh%x, shape, points, extent)
      reach = maxval(scene%r, mask=scene%body) + extent
      do i = 1, size(points, 2)
         call shape%project(points(:, i), own)
         do side = -1, 1
            x = points(:, i) + 0.1_wp*side*extent*own%normal
            call shape%project(x, own)
            do k = 1, size(angle)
               y = x(scene%across) - scene%centre(scene%across)
               turned = x
               turned(scene%across) = scene%centre(scene%across) &
                  & + [cos(angle(k))*y(1) - sin(angle(k))*y(2), sin(angle(k))*y(1) &
                  & + cos(angle(k))*y(2)]
               call shape%project(turned, image)
               if (norm2(y) > reach) image%overhang = own%overhang
               if (feet_differ(own, image, extent)) return
            end do
         end do
      end do
      revolves = .true.
   end function tool_revolves

   !> Nodes on planes that cut the body are held across them.
   logical function cuts_are_held(model, scene, step) result(are)
      type(model_type), intent(in) :: model
      type(revolution_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      logical :: held(6, model%mesh%nnode)
      integer :: i, plane

      held = held_at_zero(step, model%mesh%nnode)
      are = .true.
      do plane = 1, 2
         if (.not. scene%cut(plane)) cycle
         are = are .and. all(held(scene%across(plane), :) .or. .not. (scene%body .and. &
            & scene%on_plane(model%mesh, [(i, i=1, model%mesh%nnode)], plane)))
      end do
   end function cuts_are_held

   !> Beside that, nodes are held or moved along the axis, or held altogether, on whole circles;
   !> tools keep to the axis.
   logical function supports_revolve(model, scene, step) result(do_)
      type(model_type), intent(in) :: model
      type(revolution_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      logical :: held(6, model%mesh%nnode), reference(model%mesh%nnode), &
         & free(2, model%mesh%nnode)
      real(wp) :: value(6, model%mesh%nnode)
      integer :: i, d

      held = .false.
      value = 0.0_wp
      reference = .false.
      reference(model%rigid_body%reference) = .true.
      do_ = .false.
      do i = 1, size(step%prescribed)
         associate (p => step%prescribed(i))
            held(p%dof, p%node) = .true.
            value(p%dof, p%node) = p%value
            if (reference(p%node)) cycle
            if (.not. scene%body(p%node) .or. p%dof > 3) return
            if (p%velocity .or. p%amplitude /= step%prescribed(1)%amplitude) return
            if (p%dof /= scene%axis .and. abs(p%value) > 0.0_wp) return
         end associate
      end do
      do i = 1, size(model%rigid_body)
         associate (node => model%rigid_body(i)%reference)
            if (scene%body(node)) return
            if (.not. all(held([scene%across, 4, 5, 6], node))) return
            if (any(abs(value([scene%across, 4, 5, 6], node)) > 0.0_wp)) return
         end associate
      end do
      ! On a cut, and on the axis, being held across it says nothing more.
      do d = 1, 2
         free(d, :) = held(scene%across(d), :) .and. scene%r > scene%near
         if (scene%cut(d)) free(d, :) = free(d, :) .and. .not. scene%on_plane(model%mesh, [(i, &
            & i=1, model%mesh%nnode)], d)
      end do
      do i = 1, model%mesh%nnode
         if (.not. scene%body(i) .or. .not. any(free(:, i))) cycle
         ! Held along the radius at one angle and not at another.
         if (.not. all(held(scene%across, i))) return
      end do
      do_ = on_circles(scene, scene%body .and. any(free, dim=1), value(scene%axis, :)*0.0_wp)
      if (do_) do_ = on_circles(scene, scene%body .and. held(scene%axis, :), value(scene%axis, :))
   end function supports_revolve

   !> Nodes of a height, between the least and the largest radius of those marked there, are marked,
   !> with one value.
   logical function on_circles(scene, marked, value) result(are)
      type(revolution_type), intent(in) :: scene
      logical, intent(in) :: marked(:)
      real(wp), intent(in) :: value(:)
      logical :: left(size(marked)), level(size(marked))
      real(wp) :: most, least, one
      integer :: i, k

      left = marked
      are = .false.
      do k = 1, most_levels
         i = findloc(left, .true., 1)
         if (i == 0) exit
         one = value(i)
         level = abs(scene%z - scene%z(i)) <= scene%near .and. scene%body
         least = minval(scene%r, mask=level .and. marked) - scene%near
         most = maxval(scene%r, mask=level .and. marked) + scene%near
         level = level .and. scene%r >= least .and. scene%r <= most
         if (any(level .and. .not. marked)) return
         if (any(level .and. abs(value - one) > 1.0e-9_wp*abs(one))) return
         left = left .and. .not. level
      end do
      are = .not. any(left)
   end function on_circles

   !> One pressure on a patch between circles, one force of volume along the axis, nothing at nodes
   !> of the body.
   logical function loads_revolve(model, cell, scene, step) result(do_)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(revolution_type), intent(in) :: scene
      type(step_type), intent(in) :: step
      integer :: i

      do_ = .false.
      do i = 1, size(step%point_load)
         associate (p => step%point_load(i))
            if (scene%body(p%node) .or. p%dof /= scene%axis) return
         end associate
      end do
      if (allocated(step%temperature)) then
         if (size(step%temperature) > 0) return
      end if
      do i = 1, size(step%body_load)
         associate (b => step%body_load(i), first => step%body_load(1))
            if (any(abs(b%force(scene%across)) > 0.0_wp)) return
            if (abs(b%force(scene%axis) - first%force(scene%axis)) > 0.0_wp) return
            if (b%amplitude /= first%amplitude) return
         end associate
      end do
      if (size(step%body_load) > 0) then
         if (size(step%body_load) /= count(model%mesh%section > 0)) return
      end if
      do i = 1, size(step%face_load)
         associate (f => step%face_load(i), first => step%face_load(1))
            if (any(abs(f%traction) > 0.0_wp) .or. f%amplitude /= first%amplitude) return
            if (abs(f%pressure - first%pressure) > 0.0_wp) return
         end associate
      end do
      do_ = edges_are_circles(scene, model%mesh, cell, step%face_load%element, &
         & step%face_load%face)
   end function loads_revolve
end module lopin_advise_revolution
