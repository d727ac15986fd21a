!> Steps: their time, and the lists of what is prescribed, loaded and written in each.
module lopin_build_steps
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text, parse_integer
   use lopin_model, only : model_type, step_type
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & complain, has_parameter, line_place
   use lopin_build_scene, only : scene_type, get_word
   use lopin_build_boundary, only : boundary_type, new_boundary, boundary_of_step, find_roles
   use lopin_check_boundary, only : check_boundary
   use lopin_build_load_list, only : loads_type, new_loads
   use lopin_build_loads, only : loads_of_step
   use lopin_build_output, only : output_of_step
   implicit none
   private
   public :: build_steps

   real(wp), parameter :: smallest_share = 1.0e-6_wp   !! smallest increment / period

contains

   subroutine build_steps(model, deck, scene, absolute)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      logical, intent(in) :: absolute(:)      !! amplitudes with VALUE=ABSOLUTE
      type(boundary_type) :: boundary
      type(loads_type) :: loads
      integer, allocatable :: role(:)
      integer :: s

      allocate (model%step(scene%nstep))
      if (scene%nstep == 0) call complain(model%log, 'E0408', 'the deck has no *STEP', &
         & location_type(1, 1, 1, 1), help='end it with *STEP, *STATIC, loads, *END STEP')
      call find_roles(model, role)
      call new_boundary(boundary, model%mesh%nnode)
      call new_loads(loads, model%mesh%nnode, model%mesh%nelement)
      call boundary_of_step(boundary, model, deck, scene, role, absolute, 0)
      call check_boundary(boundary, model)
      call refuse_loads_outside(model, deck, scene)
      do s = 1, scene%nstep
         call read_step(model, deck, scene, s)
         call read_checkpoints(model, deck, scene, s)
         call check_strains(model, s)
         call boundary_of_step(boundary, model, deck, scene, role, absolute, s)
         call check_boundary(boundary, model)
         call loads_of_step(loads, model, deck, scene, role, absolute, s)
         model%step(s)%prescribed = boundary%item(:boundary%n)
         model%step(s)%point_load = loads%point(:loads%npoint)
         model%step(s)%face_load = loads%face(:loads%nface)
         model%step(s)%body_load = loads%body(:loads%nbody)
         call output_of_step(model, deck, scene, s)
      end do
   end subroutine build_steps

   subroutine refuse_loads_outside(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer :: k

      do k = 1, scene%ncard
         if (scene%card(k)%step > 0) cycle
         associate (block => deck%block(scene%card(k)%block))
            select case (block%keyword)
            case ('CLOAD', 'DLOAD', 'DSLOAD', 'STATIC')
               call complain(model%log, 'E0408', '*'//block%keyword//' stands outside a step', &
                  & block%at, &
                  & help='write it between *STEP and *END STEP')
            end select
         end associate
      end do
   end subroutine refuse_loads_outside

   subroutine read_step(model, deck, scene, s)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: s
      character(len=:), allocatable :: help
      integer :: k
      logical :: is_static

      is_static = .false.
      help = 'write *STATIC after *STEP'
      do k = 1, scene%ncard
         if (scene%card(k)%step /= s) cycle
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword == 'STEP') then
               if (s > 1) model%step(s)%nlgeom = model%step(s - 1)%nlgeom
               call read_head(model%step(s), block, model%log)
               if (block%nline > 0) help = 'write *STATIC, with its star, between *STEP and '// &
                  & 'its data; line '//to_text(block%line(1)%line)//' is a title of the step now'
            end if
            if (block%keyword /= 'STATIC') cycle
            if (is_static) call complain(model%log, 'E0408', 'step '//to_text(s) &
               & //' has a second *STATIC', block%at)
            is_static = .true.
            call read_static(model, model%step(s), block)
         end associate
      end do
      if (.not. is_static) call complain(model%log, 'E0408', 'step '//to_text(s) &
         & //' has no *STATIC', &
         & model%step(s)%at, help=help)
   end subroutine read_step

   !> *RESTART holds until another one; one outside the steps, from the first.
   subroutine read_checkpoints(model, deck, scene, s)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: s
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k, number
      logical :: found

      if (s > 1) model%step(s)%checkpoint = model%step(s - 1)%checkpoint
      do k = 1, scene%ncard
         if (scene%card(k)%step /= s .and. (s > 1 .or. scene%card(k)%step > 0)) cycle
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'RESTART') cycle
            call get_word(block, 'FREQUENCY', word, at, found)
            model%step(s)%checkpoint = 1
            if (.not. found) cycle
            call parse_integer(word, number, found)
            if (found .and. number >= 0) then
               model%step(s)%checkpoint = number
            else
               call complain(model%log, 'E0408', 'FREQUENCY='//word//' is not a whole number '// &
                  & 'from 0', at)
            end if
         end associate
      end do
   end subroutine read_checkpoints

   !> A linear step cannot follow a finite one, nor hold a material that has no linear law.
   subroutine check_strains(model, s)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: s
      integer :: i

      if (model%step(s)%nlgeom) return
      if (s > 1) then
         if (model%step(s - 1)%nlgeom) then
            call complain(model%log, 'E0408', 'step '//to_text(s)//' says NLGEOM=NO, but step ' &
               & //to_text(s - 1)//' has left a deformed shape that a linear step does not know', &
               & model%step(s)%at, help='leave NLGEOM=NO out')
            return
         end if
      end if
      do i = 1, size(model%section)
         if (model%section(i)%material == 0) cycle
         associate (material => model%material(model%section(i)%material))
            if (.not. material%has_neo_hooke) cycle
            call complain(model%log, 'E0408', 'step '//to_text(s)//' is linear, but material `' &
               & //material%name//'` is hyperelastic', model%step(s)%at, help='*STEP, NLGEOM')
            return
         end associate
      end do
   end subroutine check_strains

   subroutine read_head(step, block, log)
      type(step_type), intent(inout) :: step
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: j, number
      logical :: found

      step%at = block%at
      step%heading = ''
      call get_word(block, 'NAME', word, at, found)
      if (found) step%heading = word
      do j = 1, block%nline
         if (len(step%heading) > 0) step%heading = step%heading//' '
         step%heading = step%heading//trim(adjustl(block%line(j)%text))
      end do
      call get_word(block, 'NLGEOM', word, at, found)
      if (found) step%nlgeom = word /= 'NO'
      call get_word(block, 'AMPLITUDE', word, at, found)
      step%ramp = word /= 'STEP'
      call get_word(block, 'INC', word, at, found)
      if (.not. found) return
      call parse_integer(word, number, found)
      if (found .and. number > 0) then
         step%max_increments = number
      else
         call complain(log, 'E0408', 'INC='//word//' is not a positive whole number', at)
      end if
   end subroutine read_head

   !> `initial, period, smallest, largest`.
   subroutine read_static(model, step, block)
      type(model_type), intent(inout) :: model
      type(step_type), intent(inout) :: step
      type(block_type), intent(in) :: block
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      real(wp) :: value(4)
      integer :: i, n
      logical :: found, given(4)

      step%direct = has_parameter(block, 'DIRECT')
      call get_word(block, 'SOLVER', word, at, found)
      if (found .and. model%solver == 'AUTO') model%solver = word
      value = 0.0_wp
      given = .false.
      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      if (block%nline > 1) call complain(model%log, 'E0103', '*STATIC has one data line', &
         & line_place(block%line(2)), help='write the keyword line that is lost above it, or '// &
         & 'take it away')
      do i = 1, min(4, n)
         call field_real(field(i), value(i), model%log, given(i))
         if (value(i) < 0.0_wp) call complain(model%log, 'E0408', 'a time of ' &
            & //to_text(value(i), 6) &
            & //' is negative', field(i)%at, help='initial, period, smallest, largest')
      end do
      given = given .and. value > 0.0_wp
      step%timed = given(2)
      step%period = merge(value(2), 1.0_wp, given(2))
      step%initial = merge(value(1), step%period, given(1))
      if (step%initial > step%period) then
         call model%log%say(severity%note, 'N0405', 'the initial increment ' &
            & //to_text(step%initial, 6) &
            & //' is longer than the period '//to_text(step%period, 6)//': it is cut', &
            & line_place(block%line(1)))
         step%initial = step%period
      end if
      step%smallest = merge(value(3), smallest_share*step%period, given(3))
      step%largest = merge(value(4), step%period, given(4))
      if (step%direct) then
         step%smallest = step%initial
         step%largest = step%initial
      else if (step%smallest > step%largest) then
         call complain(model%log, 'E0408', 'the smallest increment '//to_text(step%smallest, 6) &
            & //' is larger than the largest '//to_text(step%largest, 6), line_place(block%line(1)))
      end if
      step%initial = min(step%initial, step%largest)
   end subroutine read_static
end module lopin_build_steps
