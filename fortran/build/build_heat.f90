!> *EXPANSION, *INITIAL CONDITIONS and *TEMPERATURE: thermal strain, temperatures, initial stresses.
module lopin_build_heat
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, material_type, temperature_type, initial_stress_type
   use lopin_element_type, only : element_kind
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & field_integer, complain, line_place
   use lopin_build_scene, only : scene_type, need_real, get_word, nodes_of, elements_of
   use lopin_build_amplitudes, only : read_amplitude_word, hold_value
   use lopin_build_boundary, only : asks_new
   use lopin_build_states, only : read_states, read_memories
   implicit none
   private
   public :: read_expansion, build_initial_conditions, build_temperatures

   !> Fields of the longest line of *INITIAL CONDITIONS but for TYPE=MEMORY: that of a state.
   integer, parameter :: most_fields = 17

contains

   subroutine read_expansion(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n
      logical :: found

      if (material%has_expansion) call complain(log, 'E0205', 'material `'//material%name// &
         & '` has a second *EXPANSION', block%at)
      material%has_expansion = .true.
      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      if (n == 0) then
         call complain(log, 'E0103', '*EXPANSION needs a coefficient', block%at)
         return
      end if
      call need_real(field(1), material%expansion, log, found)
      if (block%nline > 1) call complain(log, 'E0203', &
         & 'expansion that depends on temperature is not in this version', &
         & line_place(block%line(2)))
   end subroutine read_expansion

   !> Temperatures of nodes and stresses of elements before the first step.
   subroutine build_initial_conditions(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: k
      logical :: found

      allocate (model%temperature(model%mesh%nnode), source=0.0_wp)
      allocate (model%initial_stress(0), model%initial_state(0), model%start%kept(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
            if (block%keyword /= 'INITIAL CONDITIONS') cycle
            call get_word(block, 'TYPE', word, at, found)
            if (word /= 'MEMORY') call refuse_long_lines(model, block)
            if (word == 'TEMPERATURE') call read_start(model, scene, block, scope)
            if (word == 'STRESS') call read_stress(model, scene, block, scope)
            if (word == 'STATE' .or. word == 'HARDENING') call read_states(model, scene, block, &
               & scope, word == 'STATE')
            if (word == 'MEMORY') call read_memories(model, scene, block, scope)
         end associate
      end do
   end subroutine build_initial_conditions

   !> Lines longer than those of any other type: a memory has as many numbers as its law asks for.
   subroutine refuse_long_lines(model, block)
      type(model_type), intent(inout) :: model
      type(block_type), intent(in) :: block
      type(field_type), allocatable :: field(:)
      integer :: j, n

      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n > most_fields) call complain(model%log, 'E0103', '*INITIAL CONDITIONS has at '// &
            & 'most '//to_text(most_fields)//' fields a line, here are '//to_text(n), &
            & field(most_fields + 1)%at, &
            & help='if a keyword line is lost above it, write that; or lopin doc '// &
            & "'*INITIAL CONDITIONS'")
      end do
   end subroutine refuse_long_lines

   subroutine read_start(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(field_type), allocatable :: field(:)
      integer, allocatable :: node(:)
      real(wp) :: value
      integer :: j, n
      logical :: found

      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call nodes_of(scene, model%mesh, field(1), scope, node, model%log)
         call second_number(field(:n), value, found, model%log)
         if (found) model%temperature(node) = value
      end do
   end subroutine read_start

   !> `set, temperature`.
   subroutine second_number(field, value, found, log)
      type(field_type), intent(in) :: field(:)
      real(wp), intent(out) :: value
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log

      value = 0.0_wp
      found = size(field) > 1
      if (found) then
         call need_real(field(2), value, log, found)
      else
         call complain(log, 'E0103', 'a temperature is missing', field(1)%at)
      end if
   end subroutine second_number

   subroutine read_stress(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(field_type), allocatable :: field(:)
      type(initial_stress_type) :: new
      integer, allocatable :: element(:)
      integer :: i, j, n, first
      logical :: found

      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call elements_of(scene, model%mesh, field(1), scope, element, model%log)
         if (n < 2) call complain(model%log, 'E0103', 'a stress is missing', field(1)%at)
         new = initial_stress_type(at=field(1)%at)
         ! CalculiX has a point between the element and six stresses.
         first = merge(3, 2, n > 7)
         if (n > 7) call field_integer(field(2), new%point, model%log, found)
         do i = first, min(first + 5, n)
            if (len_trim(field(i)%text) > 0) call field_real(field(i), new%stress(i - first + 1), &
               & model%log, found)
         end do
         do i = 1, size(element)
            new%element = element(i)
            if (scene%etype(model%mesh%etype(element(i)))%kind == element_kind%plane_stress) then
               call complain(model%log, 'E0108', 'stresses of the start in plane stress come '// &
                  & 'with a later version: element '// &
                  & to_text(model%mesh%element_label(element(i))), field(1)%at)
               exit
            end if
            model%initial_stress = [model%initial_stress, new]
         end do
      end do
   end subroutine read_stress

   !> The temperatures in force at the end of every step; those of a step stay in the next.
   subroutine build_temperatures(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(temperature_type) :: now(model%mesh%nnode)
      integer :: k, s, i

      do s = 1, size(model%step)
         if (s > 1) then
            do i = 1, size(now)
               call hold_value(model, model%step(s - 1)%period, now(i)%amplitude, now(i)%value)
            end do
         end if
         if (asks_new(deck, scene, s, 'TEMPERATURE')) now%node = 0
         do k = 1, scene%ncard
            if (scene%card(k)%step /= s) cycle
            associate (block => deck%block(scene%card(k)%block), scope => scene%card(k)%scope)
               if (block%keyword == 'TEMPERATURE') call read_temperatures(model, scene, block, &
                  & scope, now)
            end associate
         end do
         model%step(s)%temperature = pack(now, now%node > 0)
      end do
      call check_heat(model)
   end subroutine build_temperatures

   subroutine read_temperatures(model, scene, block, scope, now)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      type(temperature_type), intent(inout) :: now(:)
      type(field_type), allocatable :: field(:)
      integer, allocatable :: node(:)
      real(wp) :: value
      integer :: amplitude, i, j, n
      logical :: found

      amplitude = read_amplitude_word(model, block)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         if (n == 0) cycle
         call nodes_of(scene, model%mesh, field(1), scope, node, model%log)
         call second_number(field(:n), value, found, model%log)
         if (.not. found) cycle
         do i = 1, size(node)
            now(node(i)) = temperature_type(node(i), value, amplitude)
         end do
      end do
   end subroutine read_temperatures

   !> Heat and expansion that do not meet are said; rubber does not expand.
   subroutine check_heat(model)
      type(model_type), intent(inout) :: model
      logical :: heated
      integer :: i, s

      heated = .false.
      do s = 1, size(model%step)
         heated = heated .or. size(model%step(s)%temperature) > 0
      end do
      do i = 1, size(model%material)
         associate (material => model%material(i))
            if ((material%has_neo_hooke .or. material%green) .and. material%has_expansion &
               & .and. heated) call complain(model%log, 'E0205', 'material `'//material%name// &
               & '` has *HYPERELASTIC or STRAIN=GREEN, whose *EXPANSION is not in this version', &
               & material%at, help='*ELASTIC alone expands')
         end associate
      end do
      if (any(model%material%has_expansion) .and. .not. heated) call model%log%say(severity%note, &
         & 'N0325', '*EXPANSION does nothing: no step has a *TEMPERATURE', &
         & model%material(findloc(model%material%has_expansion, .true., dim=1))%at)
      if (.not. heated .or. any(model%material%has_expansion)) return
      if (any([(allocated(model%material(i)%flow%temperature), i=1, size(model%material))])) return
      call model%log%say(severity%warning, 'W0325', &
         & 'temperatures are prescribed, and no material '// &
         & 'has *EXPANSION or a flow curve that looks at them: they do nothing', model%step(1)%at)
   end subroutine check_heat
end module lopin_build_heat
