!> Temperatures of a step as functions of time, and what they do to the solids.
module lopin_heat
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, amplitude_value, is_heated
   use lopin_error, only : error_type, error_code, raise, severity
   use lopin_text, only : to_text
   use lopin_point_states, only : put_state, settle_states, energy_of_memory
   use lopin_kept_memory, only : put_kept_memory
   use lopin_assemble_nonlinear, only : elastic_energy
   use lopin_assemble_springs, only : add_springs
   use lopin_stress_free_state, only : heat_points, stress_points, temper_points
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: start_stresses, start_solids

contains

   !> The stresses before the first step, into a memory that is at rest.
   subroutine start_stresses(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: found
      integer :: i

      if (.not. allocated(model%initial_stress)) return
      associate (memory => scene%accepted%solids)
         do i = 1, size(model%initial_stress)
            associate (start => model%initial_stress(i))
               call stress_points(memory, scene%solids, start, found)
               if (found) cycle
               call raise(error, error_code%deck, 'E0210', 'element '// &
                  & to_text(model%mesh%element_label(start%element))//' has no point '// &
                  & to_text(start%point), start%at, help='a line of eight numbers gives the '// &
                  & 'stress of one point; seven: the element and six stresses')
               return
            end associate
         end do
         do i = 1, size(model%initial_state)
            associate (state => model%initial_state(i))
               if (state%whole .and. .not. memory%finite_strain) then
                  call raise(error, error_code%deck, 'E0210', 'TYPE=STATE belongs to the '// &
                     & 'present shape: the first step needs NLGEOM', state%at, &
                     & help='write *STEP, NLGEOM')
                  return
               end if
               call put_state(memory, scene%solids, state, found)
               if (found) cycle
               call raise(error, error_code%deck, 'E0210', 'element '// &
                  & to_text(model%mesh%element_label(state%element))//' has no point that '// &
                  & 'could take this state: point '//to_text(state%point), state%at, &
                  & help='a state '// &
                  & 'goes to elements that flow, to a point of theirs (0: all), and without '// &
                  & 'backstress or Hill''s ratios')
               return
            end associate
         end do
         call refuse_partial(model, memory%first, error)
         if (allocated(error)) return
         if (any_modes(scene, model)) call scene%log%say(severity%warning, 'W0210', &
            & 'the state of the start does not have the internal modes of its elements: they '// &
            & 'begin anew', model%initial_state(1)%at)
         call settle_states(scene%solids, model%mesh, scene%dofs%n, memory)
         call keep_memories(scene, model, error)
         if (allocated(error)) return
         call heat_points(memory, scene%solids, model%mesh, &
            & spread(0.0_wp, 1, model%mesh%nnode), memory%pressed)
         call temper_points(memory, scene%solids, model%mesh, model%temperature)
         ! Nothing has worked for what is stored at the start.
         memory%heat = energy_at_start(scene, model)
      end associate
   end subroutine start_stresses

   !> What bodies whose mesh stays remember.
   subroutine keep_memories(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: found
      integer :: i

      do i = 1, size(model%start%kept)
         associate (kept => model%start%kept(i))
            call put_kept_memory(scene%accepted%solids, kept, found)
            if (found) cycle
            call raise(error, error_code%deck, 'E0210', 'element '// &
               & to_text(model%mesh%element_label(kept%element))//' has no point '// &
               & to_text(kept%point)//' that remembers '//to_text(size(kept%value))//' numbers', &
               & kept%at, help='a memory belongs to the elements and materials that it was '// &
               & 'written for')
            return
         end associate
      end do
   end subroutine keep_memories

   !> Elastic energy of all solids and springs where *START puts them [force length].
   real(wp) function energy_at_start(scene, model) result(energy)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: u(:), force(:)
      integer :: i, id

      allocate (u(scene%dofs%n), force(scene%dofs%n), source=0.0_wp)
      do i = 1, size(model%start%displaced)
         associate (place => model%start%displaced(i))
            id = scene%dofs%id(place%dof, place%node)
            if (id > 0) u(id) = place%now
         end associate
      end do
      energy = energy_of_memory(scene%solids, model%mesh, u, scene%accepted%solids)
      if (any(abs(u) > 0.0_wp)) energy = energy &
         & + elastic_energy(scene%solids, model%mesh, u, scene%accepted%solids)
      call add_springs(scene%solids, model%mesh, u, .true., force, energy)
   end function energy_at_start

   !> A state for some points of an element and none for others was meant for other elements.
   subroutine refuse_partial(model, first, error)
      type(model_type), intent(in) :: model
      integer, intent(in) :: first(:)          !! (nelement + 1) first point of each element
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: given(:)
      integer :: i, p, q

      allocate (given(first(size(first)) - 1), source=.false.)
      do i = 1, size(model%initial_state)
         associate (state => model%initial_state(i))
            if (.not. state%whole) cycle
            p = first(state%element)
            q = first(state%element + 1) - 1
            if (state%point > 0) p = p + state%point - 1
            if (state%point > 0) q = p
            given(p:q) = .true.
         end associate
      end do
      do i = 1, size(model%initial_state)
         associate (state => model%initial_state(i))
            p = first(state%element)
            q = first(state%element + 1) - 1
            if (.not. state%whole .or. all(given(p:q))) cycle
            call raise(error, error_code%deck, 'E0210', 'element '// &
               & to_text(model%mesh%element_label(state%element))//' has '//to_text(q - p + 1)// &
               & ' points, and a state for '//to_text(count(given(p:q)))//' of them', state%at, &
               & help='give one to each point, or to point 0, which is all of them')
            return
         end associate
      end do
   end subroutine refuse_partial

   !> Whether states of the start go to elements with internal modes.
   pure logical function any_modes(scene, model)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      any_modes = .false.
      do i = 1, size(model%initial_state)
         associate (state => model%initial_state(i))
            if (state%whole) any_modes = any_modes &
               & .or. scene%solids%group(scene%solids%which(state%element))%element%nmode > 0
         end associate
      end do
   end function any_modes

   !> What the solids remember where an increment starts, at the temperatures of its end.
   subroutine start_solids(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: temperature(model%mesh%nnode)

      associate (past => scene%newton%past)
         past = scene%accepted%solids
         past%dt = scene%newton%dt
         if (.not. (scene%newton%flows .and. is_heated(model))) return
         temperature = temperature_at(model, scene%step, scene%newton%time)
         call heat_points(past, scene%solids, model%mesh, temperature - model%temperature, &
            & past%pressed)
         call temper_points(past, scene%solids, model%mesh, temperature)
      end associate
   end subroutine start_solids

   !> Linear from the end of the last step, at once with AMPLITUDE=STEP, or by an amplitude.
   function temperature_at(model, s, time) result(value)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s
      real(wp), intent(in) :: time
      real(wp) :: value(model%mesh%nnode), before(model%mesh%nnode), share
      logical :: follows(model%mesh%nnode)
      integer :: i

      before = model%temperature
      if (s > 1) before = temperature_at_end(model, s - 1)
      value = model%temperature
      follows = .false.
      associate (step => model%step(s))
         do i = 1, size(step%temperature)
            associate (entry => step%temperature(i))
               value(entry%node) = entry%value
               if (entry%amplitude == 0) cycle
               follows(entry%node) = .true.
               value(entry%node) = entry%value*factor(model, s, entry%amplitude, time)
            end associate
         end do
         share = 1.0_wp
         if (step%ramp) share = time/step%period
      end associate
      where (.not. follows) value = before + share*(value - before)
   end function temperature_at

   function temperature_at_end(model, s) result(value)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s
      real(wp) :: value(model%mesh%nnode)
      integer :: i

      value = model%temperature
      do i = 1, size(model%step(s)%temperature)
         associate (entry => model%step(s)%temperature(i))
            value(entry%node) = entry%value
            if (entry%amplitude > 0) value(entry%node) = entry%value &
               & *factor(model, s, entry%amplitude, model%step(s)%period)
         end associate
      end do
   end function temperature_at_end

   pure real(wp) function factor(model, s, amplitude, time)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s, amplitude
      real(wp), intent(in) :: time
      real(wp) :: start

      start = 0.0_wp
      if (model%amplitude(amplitude)%total_time) start = sum(model%step(:s - 1)%period)
      factor = amplitude_value(model%amplitude(amplitude), start + time)
   end function factor
end module lopin_heat
