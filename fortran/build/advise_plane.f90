!> Advice on scenes of plane strain that are meshed in space.
!>
!> Exact: every node is held in one direction, and nothing varies along it: elements and sections
!> stand over each other, and supports, loads, temperatures, surfaces and tools are alike at every
!> height. What is not compared (see lopin_advise_symmetry, and surfaces of nodes, surfaces on
!> rigid elements with two sides) keeps this module silent.
module lopin_advise_plane
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type, step_type, kind_of, surface_of
   use lopin_extrusion, only : extrusion_type, new_extrusion, face_in_base
   use lopin_mirror_scene, only : points_near, feet_differ, differs
   use lopin_advise_symmetry, only : compares, made_of
   use lopin_step_values, only : held_at_zero, add_body_forces, put_temperatures
   implicit none
   private
   public :: advise_plane

contains

   subroutine advise_plane(model, direction)
      type(model_type), intent(inout) :: model
      integer, intent(out) :: direction        !! nothing varies in this direction; 0: none
      type(extrusion_type) :: stacks(2)
      type(cell_type), allocatable :: cell(:)
      logical :: held(3)
      integer :: k

      direction = 0
      if (model%kind /= kind_of%solid) return
      if (.not. compares(model)) return
      held = .true.
      do k = 1, size(model%step)
         held = held .and. all_held(model, model%step(k))
      end do
      if (.not. any(held)) return
      call cells_of_words(model%element_word, cell)
      do k = 1, 3
         if (.not. held(k)) cycle
         call new_extrusion(stacks(1), model%mesh, k, made_of(model), model%mesh%section > 0)
         if (.not. stacks(1)%found) cycle
         call new_extrusion(stacks(2), model%mesh, k, made_of(model), model%mesh%section == 0)
         if (.not. is_uniform(model, cell, stacks)) cycle
         direction = k
         call model%log%say(severity%note, 'N0361', 'every node is held in direction '// &
            & to_text(k)//', and nothing varies along it: the scene is one of plane strain, '// &
            & 'meshed in space', model%step(1)%at, help='a plane mesh (CPE4, CPE8) has the '// &
            & 'same answer with half the nodes or fewer, and two equations at each instead '// &
            & 'of three')
         return
      end do
   end subroutine advise_plane

   !> Directions in which every node of an element with stiffness is held.
   function all_held(model, step) result(all_)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      logical :: all_(3), held(6, model%mesh%nnode)
      integer :: e, i

      held = held_at_zero(step, model%mesh%nnode)
      all_ = .true.
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         do i = 1, count(model%mesh%conn(:, e) > 0)
            all_ = all_ .and. held(:3, model%mesh%conn(i, e))
         end do
      end do
   end function all_held

   logical function is_uniform(model, cell, stacks) result(is)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(extrusion_type), intent(in) :: stacks(2)   !! of the bodies, of rigid elements
      integer :: i

      is = .false.
      if (any(model%mesh%section == 0)) then
         if (.not. stacks(2)%found) return
         associate (own => stacks(1)%ends, rigid => stacks(2)%ends)
            if (rigid(1) > own(1) + stacks(1)%near .or. rigid(2) < own(2) - stacks(1)%near) return
         end associate
      end if
      do i = 1, size(model%pair)
         if (.not. surface_is_uniform(model, cell, stacks, model%pair(i)%slave)) return
         if (.not. surface_is_uniform(model, cell, stacks, model%pair(i)%master)) return
      end do
      if (allocated(model%temperature)) then
         if (any(differs(model%temperature, model%temperature(stacks(1)%column)))) return
      end if
      do i = 1, size(model%step)
         if (.not. supports_are_uniform(model, stacks(1), model%step(i))) return
         if (.not. bodies_keep_upright(model, stacks(1)%axis, model%step(i))) return
         if (.not. points_are_uniform(model, cell, stacks(1), model%step(i))) return
         if (.not. loads_are_uniform(model, cell, stacks(1), model%step(i))) return
      end do
      is = .true.
   end function is_uniform

   logical function surface_is_uniform(model, cell, stacks, surface) result(is)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(extrusion_type), intent(in) :: stacks(2)
      integer, intent(in) :: surface
      logical, allocatable :: has(:, :)
      integer :: i, face, s

      is = .false.
      if (surface == 0) return
      associate (f => model%surface(surface))
         if (f%kind == surface_of%tool) then
            is = tool_is_uniform(model, stacks(1), model%tool(f%tool)%shape)
         else if (f%kind == surface_of%faces) then
            s = merge(1, 2, all(model%mesh%section(f%element) > 0))
            if (s == 2 .and. any(model%mesh%section(f%element) > 0)) return
            allocate (has(6, model%mesh%nelement), source=.false.)
            do i = 1, size(f%element)
               associate (c => cell(model%mesh%etype(f%element(i))))
                  if (c%sided) return
                  face = face_in_base(stacks(s), model%mesh, c, f%element(i), f%face(i))
               end associate
               if (face == 0) return
               has(face, f%element(i)) = .true.
            end do
            do i = 1, model%mesh%nelement
               associate (base => stacks(s)%base(i))
                  if (base == 0) cycle
                  if (any(has(:, i) .neqv. has(:, base))) return
               end associate
            end do
            is = .true.
         end if
      end associate
   end function surface_is_uniform

   !> Every point of a tool near the bodies, and beside it, and every node, keeps its distance when
   !> it is moved along the bodies.
   logical function tool_is_uniform(model, stack, shape) result(is)
      type(model_type), intent(in) :: model
      type(extrusion_type), intent(in) :: stack
      class(tool_type), intent(in) :: shape
      real(wp), parameter :: share(3) = [0.0_wp, 0.37_wp, 1.0_wp]
      real(wp), allocatable :: points(:, :)
      real(wp) :: extent, x(3)
      type(foot_type) :: own, other
      integer :: i, k, side

      is = .false.
      call points_near(model%mesh%x, shape, points, extent)
      do i = 1, size(points, 2)
         call shape%project(points(:, i), own)
         do side = -1, 1
            x = points(:, i) + 0.1_wp*side*extent*own%normal
            do k = 1, size(share)
               x(stack%axis) = stack%ends(1) + share(k)*(stack%ends(2) - stack%ends(1))
               if (k == 1) then
                  call shape%project(x, other)
                  cycle
               end if
               call shape%project(x, own)
               if (feet_differ(own, other, extent)) return
            end do
            call shape%project(points(:, i), own)
         end do
      end do
      is = .true.
   end function tool_is_uniform

   !> What is prescribed is the same on a whole column.
   logical function supports_are_uniform(model, stack, step) result(are)
      type(model_type), intent(in) :: model
      type(extrusion_type), intent(in) :: stack
      type(step_type), intent(in) :: step
      real(wp) :: value(6, model%mesh%nnode)
      integer :: how(6, model%mesh%nnode), i

      value = 0.0_wp
      how = -1
      do i = 1, size(step%prescribed)
         associate (p => step%prescribed(i))
            value(p%dof, p%node) = p%value
            how(p%dof, p%node) = 2*p%amplitude + merge(1, 0, p%velocity)
         end associate
      end do
      are = .not. (any(differs(value, value(:, stack%column))) &
         & .or. any(how /= how(:, stack%column)))
   end function supports_are_uniform

   !> Rigid bodies neither move along the axis nor tilt against it.
   logical function bodies_keep_upright(model, axis, step) result(keep)
      type(model_type), intent(in) :: model
      integer, intent(in) :: axis
      type(step_type), intent(in) :: step
      logical :: held(6, model%mesh%nnode)
      integer :: i, k

      held = held_at_zero(step, model%mesh%nnode)
      keep = .true.
      do i = 1, size(model%rigid_body)
         do k = 1, 3
            keep = keep .and. held(merge(k, 3 + k, k == axis), model%rigid_body(i)%reference)
         end do
      end do
   end function bodies_keep_upright

   !> Forces at nodes and temperatures. Equal forces at nodes are uniform between two levels alone:
   !> more would need half of them at the ends.
   logical function points_are_uniform(model, cell, stack, step) result(are)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(extrusion_type), intent(in) :: stack
      type(step_type), intent(in) :: step
      real(wp) :: force(6, model%mesh%nnode), heat(model%mesh%nnode)
      logical :: tool(model%mesh%nnode), alike
      integer :: how(6, model%mesh%nnode), i

      are = .false.
      force = 0.0_wp
      how = -1
      heat = -huge(1.0_wp)
      tool = .false.
      tool(model%rigid_body%reference) = .true.
      do i = 1, size(step%point_load)
         associate (p => step%point_load(i))
            if (tool(p%node) .or. p%dof == stack%axis) cycle
            if (stack%levels > 1 .or. any(cell(model%mesh%etype)%quadratic)) return
            force(p%dof, p%node) = force(p%dof, p%node) + p%value
            how(p%dof, p%node) = p%amplitude
         end associate
      end do
      if (any(differs(force, force(:, stack%column)))) return
      if (any(how /= how(:, stack%column))) return
      call put_temperatures(step, heat, alike)
      are = alike .and. .not. any(differs(heat, heat(stack%column)))
   end function points_are_uniform

   !> Pressures and tractions on faces, forces of volumes.
   logical function loads_are_uniform(model, cell, stack, step) result(are)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      type(extrusion_type), intent(in) :: stack
      type(step_type), intent(in) :: step
      real(wp), allocatable :: load(:, :, :)
      real(wp) :: body(3, model%mesh%nelement)
      integer :: i, face
      logical :: alike

      are = .false.
      allocate (load(4, 6, model%mesh%nelement), source=0.0_wp)
      body = 0.0_wp
      do i = 1, size(step%face_load)
         associate (f => step%face_load(i))
            ! Several with amplitudes are not told apart.
            if (f%amplitude /= step%face_load(1)%amplitude) return
            if (stack%base(f%element) == 0) return
            face = face_in_base(stack, model%mesh, cell(model%mesh%etype(f%element)), f%element, &
               & f%face)
            if (face == 0) return
            load(:, face, f%element) = load(:, face, f%element) + [f%pressure, f%traction]
         end associate
      end do
      call add_body_forces(step, body, alike)
      if (.not. alike) return
      do i = 1, model%mesh%nelement
         associate (base => stack%base(i))
            if (base == 0) cycle
            if (any(differs(load(:, :, i), load(:, :, base)))) return
            if (any(differs(body(:, i), body(:, base)))) return
         end associate
      end do
      are = .true.
   end function loads_are_uniform
end module lopin_advise_plane
