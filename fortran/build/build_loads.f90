!> `*CLOAD`, `*DLOAD`, `*DSLOAD`: the complete lists of loads of each step.
!>
!> A load of the same kind at the same place replaces that of an earlier step; within one step
!> they add up.
module lopin_build_loads
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : upper, to_text
   use lopin_model, only : model_type, point_load_type, face_load_type, body_load_type, &
      & surface_of, kind_of
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, complain
   use lopin_build_scene, only : need_integer, need_real, scene_type, nodes_of, elements_of
   use lopin_build_surfaces, only : surface_named
   use lopin_build_amplitudes, only : read_amplitude_word
   use lopin_build_load_list, only : loads_type, family_of, hold_loads, drop_dloads, &
      & drop_dsloads, drop_replaced, add_point, add_face, add_body
   use lopin_build_boundary, only : checked_dof, asks_new, verdict
   implicit none
   private
   public :: loads_of_step

contains

   !> Go from the loads of the step before to those of a step.
   subroutine loads_of_step(self, model, deck, scene, role, absolute, step)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: role(:)
      logical, intent(in) :: absolute(:)
      integer, intent(in) :: step
      integer :: k

      if (step > 1) call hold_loads(self, model, model%step(step - 1)%period)
      if (asks_new(deck, scene, step, 'CLOAD')) self%npoint = 0
      if (asks_new(deck, scene, step, 'DLOAD')) call drop_dloads(self)
      if (asks_new(deck, scene, step, 'DSLOAD')) call drop_dsloads(self)
      do k = 1, scene%ncard
         if (scene%card(k)%step /= step) cycle
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            select case (block%keyword)
            case ('CLOAD')
               call read_cload(self, model, scene, block, scope, role, absolute, step)
            case ('DLOAD')
               call read_dload(self, model, scene, block, scope, absolute, step)
            case ('DSLOAD')
               call read_dsload(self, model, scene, block, scope, absolute, step)
            end select
         end associate
      end do
      call drop_replaced(self)
   end subroutine loads_of_step

   subroutine read_cload(self, model, scene, block, scope, role, absolute, step)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      integer, intent(in) :: role(:)
      logical, intent(in) :: absolute(:)
      integer, intent(in) :: step
      type(field_type), allocatable :: field(:)
      type(point_load_type) :: load
      integer, allocatable :: node(:)
      integer :: j, i, n
      logical :: found, told

      told = .false.
      load%amplitude = read_amplitude_word(model, block)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call nodes_of(scene, model%mesh, field(1), scope, node, model%log)
         call need_fields(field(:n), 3, 'node or node set, dof, force', found, model%log)
         if (.not. found) cycle
         call need_integer(field(2), load%dof, model%log, found)
         if (found) call need_real(field(3), load%value, model%log, found)
         if (.not. found) cycle
         load%at = line_span(field(:n))
         if (is_absolute(absolute, load%amplitude)) load%value = 1.0_wp
         do i = 1, size(node)
            if (checked_dof(model%mesh%ndim, role(node(i)), load%dof) /= verdict%use) then
               call complain(model%log, 'E0404', 'node '//to_text(model%mesh%node_label(node(i))) &
                  & //' has no dof ' &
                  & //to_text(load%dof), field(2)%at, &
                  & help='1 to 3 are forces, 4 to 6 moments on a reference node')
               exit
            end if
            load%node = node(i)
            if (self%point_latest(load%dof, node(i)) == step .and. .not. told) then
               call model%log%say(severity%note, 'N0407', 'node ' &
                  & //to_text(model%mesh%node_label(node(i))) &
                  & //' is loaded twice in this step: the forces are added', load%at)
               told = .true.
            end if
            self%point_latest(load%dof, node(i)) = step
            call add_point(self, load, step)
         end do
      end do
   end subroutine read_cload

   subroutine read_dload(self, model, scene, block, scope, absolute, step)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      logical, intent(in) :: absolute(:)
      integer, intent(in) :: step
      type(field_type), allocatable :: field(:)
      integer, allocatable :: element(:)
      character(len=:), allocatable :: label
      integer :: j, i, n, amplitude
      real(wp) :: value
      logical :: found

      amplitude = read_amplitude_word(model, block)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call need_fields(field(:n), 3, 'element or element set, P1 or BX or GRAV, value', found, &
            & model%log)
         if (.not. found) cycle
         if (len(field(1)%text) == 0) then
            element = [(i, i=1, model%mesh%nelement)]
         else
            call elements_of(scene, model%mesh, field(1), scope, element, model%log)
         end if
         label = upper(field(2)%text)
         call need_real(field(3), value, model%log, found)
         if (.not. found) cycle
         if (is_absolute(absolute, amplitude)) value = 1.0_wp
         select case (label)
         case ('P1', 'P2', 'P3', 'P4', 'P5', 'P6', 'P')
            call load_faces(self, model, scene, element, field(2), value, amplitude, step)
         case ('BX', 'BY', 'BZ', 'BR', 'GRAV')
            call load_bodies(self, model, element, label, field(:n), value, amplitude, step)
         case ('CENTRIF')
            call complain(model%log, 'E0108', 'CENTRIF of *DLOAD is known but not yet there: '// &
               & 'centrifugal loads come with a later version', field(2)%at)
         case default
            call complain(model%log, 'E0407', 'load `'//label//'` is not known', field(2)%at, &
               & help='P1 to P6, BX, BY, BZ, GRAV')
         end select
      end do
   end subroutine read_dload

   subroutine load_faces(self, model, scene, element, label, value, amplitude, step)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: element(:)
      type(field_type), intent(in) :: label
      real(wp), intent(in) :: value               !! pressure [stress]
      integer, intent(in) :: amplitude, step
      type(face_load_type) :: load
      integer :: i, f

      f = index('123456', label%text(len(label%text):))
      load%at = label%at
      load%pressure = value
      load%amplitude = amplitude
      do i = 1, size(element)
         associate (etype => scene%etype(model%mesh%etype(element(i))))
            if (f < 1 .or. f > etype%cell%nface .or. etype%cell%sided) then
               call complain(model%log, 'E0301', 'element ' &
                  & //to_text(model%mesh%element_label(element(i)))//' (' &
                  & //trim(etype%word)//') takes pressures P1...P'//to_text(etype%cell%nface) &
                  & //'; '//upper(label%text) &
                  & //' does not exist', label%at)
               return
            end if
         end associate
         load%element = element(i)
         load%face = f
         call add_face(self, load, family_of%dload, step)
      end do
   end subroutine load_faces

   subroutine load_bodies(self, model, element, label, field, value, amplitude, step)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      integer, intent(in) :: element(:)
      character(len=*), intent(in) :: label
      type(field_type), intent(in) :: field(:)
      real(wp), intent(in) :: value           !! force per volume, or acceleration of gravity
      integer, intent(in) :: amplitude, step
      type(body_load_type) :: load
      real(wp) :: direction(3)
      integer :: i, axis, section
      logical :: found

      load%at = field(2)%at
      load%amplitude = amplitude
      direction = 0.0_wp
      axis = 4
      if (label == 'GRAV') then
         call read_direction(field, 4, direction, found, model%log)
         if (.not. found) return
      else
         axis = index('XYZ', label(2:2))
         if (label == 'BR') axis = 1
         if (label == 'BZ' .and. model%kind == kind_of%axisymmetric) axis = 2
         if (axis > model%mesh%ndim) then
            call complain(model%log, 'E0407', 'load `'//label &
               & //'` does not exist in a scene of two dimensions', &
               & field(2)%at)
            return
         end if
         direction(axis) = 1.0_wp
      end if
      do i = 1, size(element)
         section = model%mesh%section(element(i))
         if (section == 0) cycle
         load%element = element(i)
         load%force = value*direction
         if (label == 'GRAV') then
            if (model%section(section)%material == 0) cycle
            associate (material => model%material(model%section(section)%material))
               if (.not. material%density > 0.0_wp) then
                  call complain(model%log, 'E0203', 'GRAV needs a density: material `' &
                     & //material%name &
                     & //'` has no *DENSITY', field(2)%at)
                  return
               end if
               load%force = material%density*load%force
            end associate
         end if
         call add_body(self, load, axis, step)
      end do
   end subroutine load_bodies

   subroutine read_dsload(self, model, scene, block, scope, absolute, step)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      logical, intent(in) :: absolute(:)
      integer, intent(in) :: step
      type(field_type), allocatable :: field(:)
      type(face_load_type) :: load
      real(wp) :: value, direction(3)
      integer :: j, i, n, k, family
      logical :: found

      load%amplitude = read_amplitude_word(model, block)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call need_fields(field(:n), 3, 'surface, P, pressure', found, model%log)
         if (.not. found) cycle
         k = surface_named(model, scene, field(1)%text, scope, field(1)%at)
         call need_real(field(3), value, model%log, found)
         if (k == 0 .or. .not. found) cycle
         if (is_absolute(absolute, load%amplitude)) value = 1.0_wp
         if (model%surface(k)%kind /= surface_of%faces) then
            call complain(model%log, 'E0407', 'surface `'//upper(field(1)%text) &
               & //'` has no faces to load', field(1)%at)
            cycle
         end if
         load%at = field(2)%at
         load%pressure = 0.0_wp
         load%traction = 0.0_wp
         select case (upper(field(2)%text))
         case ('P')
            family = family_of%dsload
            load%pressure = value
         case ('TRVEC')
            family = family_of%traction
            call read_direction(field(:n), 4, direction, found, model%log)
            if (.not. found) cycle
            load%traction = value*direction
         case default
            call complain(model%log, 'E0407', 'load `'//upper(field(2)%text)//'` is not known', &
               & field(2)%at, &
               & help='P or TRVEC')
            cycle
         end select
         do i = 1, size(model%surface(k)%element)
            load%element = model%surface(k)%element(i)
            load%face = model%surface(k)%face(i)
            call add_face(self, load, family, step)
         end do
      end do
   end subroutine read_dsload

   subroutine need_fields(field, n, wanted, found, log)
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: n
      character(len=*), intent(in) :: wanted
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log

      found = size(field) >= n
      if (.not. found) call complain(log, 'E0103', 'this load needs '//to_text(n)//' fields; ' &
         & //to_text(size(field)) &
         & //' given', line_span(field), help=wanted)
   end subroutine need_fields

   pure type(location_type) function line_span(field) result(at)
      type(field_type), intent(in) :: field(:)
      at = field(1)%at
      at%last = field(size(field))%at%last
   end function line_span

   !> A unit vector from three fields.
   subroutine read_direction(field, first, direction, found, log)
      type(field_type), intent(in) :: field(:)
      integer, intent(in) :: first
      real(wp), intent(out) :: direction(3)
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log
      integer :: i
      logical :: given

      direction = 0.0_wp
      do i = first, min(first + 2, size(field))
         call field_real(field(i), direction(i - first + 1), log, given)
      end do
      found = norm2(direction) > 0.0_wp
      if (found) direction = direction/norm2(direction)
      if (.not. found) call complain(log, 'E0407', upper(field(2)%text) &
         & //' needs a direction: value, x, y, z', &
         & field(2)%at)
   end subroutine read_direction

   pure logical function is_absolute(absolute, amplitude)
      logical, intent(in) :: absolute(:)
      integer, intent(in) :: amplitude

      is_absolute = .false.
      if (amplitude > 0) is_absolute = absolute(amplitude)
   end function is_absolute
end module lopin_build_loads
