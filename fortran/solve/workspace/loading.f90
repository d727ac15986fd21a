!> Loads and prescribed displacements of a step as functions of time.
!>
!> Without an amplitude a load goes linearly from its value at the end of the last step to its new
!> value (at once if the step says AMPLITUDE=STEP); a load that is no longer in force goes to zero
!> in the same way. With an amplitude it is value times amplitude, and a load without one that is
!> given again with one is replaced at once; where the next step takes the amplitude away, the load
!> goes on from its last value. A prescribed velocity moves its dof on from where the step found it,
!> at once, whatever the ramp.
module lopin_loading
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, step_type, amplitude_value, amplitude_integral
   use lopin_dofs, only : dofs_type
   use lopin_constraints, only : constraints_type, raw_displacement, axes_at
   use lopin_solids, only : solids_type
   use lopin_state, only : state_type
   use lopin_solid_loads, only : add_body_loads, add_face_loads
   implicit none
   private
   public :: loading_type, new_loading, loads_at, prescribed_at, carry_loads

   type :: loading_type
      real(wp) :: start = 0.0_wp                       !! total time at the start of the step
      real(wp) :: period = 1.0_wp
      logical :: ramp = .true.
      real(wp), allocatable :: before(:), after(:)     !! (ndof) loads without amplitude [force]
      integer, allocatable :: amplitude(:)             !! amplitudes in use
      real(wp), allocatable :: varying(:, :)           !! (ndof, namplitude) loads per unit of each
      real(wp), allocatable :: from(:), to(:)          !! (nprescribed)
      integer, allocatable :: follows(:)               !! (nprescribed) amplitude; 0: none
      logical, allocatable :: moves(:)                 !! (nprescribed) `to` is a velocity
   end type loading_type

contains

   !> From the loads, displacements and time at the end of the last step.
   subroutine new_loading(self, model, dofs, constraints, solids, step, accepted)
      type(loading_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      type(solids_type), intent(in) :: solids
      type(step_type), intent(in) :: step
      type(state_type), intent(in) :: accepted
      integer :: i, a

      self%start = accepted%clock%start
      self%period = step%period
      self%ramp = step%ramp
      self%before = accepted%loads%steady
      allocate (self%after(dofs%n), source=0.0_wp)
      call add_loads(self%after, model, dofs, constraints, solids, step, 0)
      allocate (self%amplitude(0))
      do a = 1, size(model%amplitude)
         if (uses(step, a)) self%amplitude = [self%amplitude, a]
      end do
      allocate (self%varying(dofs%n, size(self%amplitude)), source=0.0_wp)
      do i = 1, size(self%amplitude)
         call add_loads(self%varying(:, i), model, dofs, constraints, solids, step, &
            & self%amplitude(i))
      end do
      allocate (self%from(constraints%nprescribed), self%to(constraints%nprescribed), &
         & self%follows(constraints%nprescribed), self%moves(constraints%nprescribed))
      do i = 1, constraints%nprescribed
         associate (entry => step%prescribed(constraints%entry_of_prescribed(i)))
            self%to(i) = entry%value
            self%follows(i) = entry%amplitude
            self%moves(i) = entry%velocity
            self%from(i) = raw_displacement(constraints, dofs, accepted%motion%u, &
               & constraints%dof_of_prescribed(i))
         end associate
      end do
   end subroutine new_loading

   pure logical function uses(step, amplitude)
      type(step_type), intent(in) :: step
      integer, intent(in) :: amplitude
      uses = any(step%point_load%amplitude == amplitude) &
         & .or. any(step%face_load%amplitude == amplitude) &
         & .or. any(step%body_load%amplitude == amplitude)
   end function uses

   !> Bring `steady` from the end of the old step to the start of the new one: with the last values
   !> of the loads that followed an amplitude and no longer do, without those that are given again
   !> and follow one now, which act at once.
   subroutine carry_loads(self, model, dofs, constraints, solids, old, new, steady)
      type(loading_type), intent(in) :: self           !! of the old step
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      type(solids_type), intent(in) :: solids
      type(step_type), intent(in) :: old, new
      real(wp), intent(inout) :: steady(:)             !! (ndof) [force]
      type(step_type) :: changed
      real(wp) :: f(dofs%n)
      integer :: i

      call changed_loads(changed, old, new)
      f = 0.0_wp
      call add_loads(f, model, dofs, constraints, solids, changed, 0)
      steady = steady - f
      do i = 1, size(self%amplitude)
         f = 0.0_wp
         call add_loads(f, model, dofs, constraints, solids, changed, self%amplitude(i))
         steady = steady + factor(self, model, self%amplitude(i), self%period)*f
      end do
   end subroutine carry_loads

   !> The loads of `old` that go from following an amplitude to none in `new`, or from none to one.
   pure subroutine changed_loads(changed, old, new)
      type(step_type), intent(inout) :: changed
      type(step_type), intent(in) :: old, new
      logical, allocatable :: keep(:)
      integer :: i

      changed%nlgeom = old%nlgeom
      if (.not. (follow_some(old) .or. follow_some(new))) then
         allocate (changed%point_load(0), changed%face_load(0), changed%body_load(0))
         return
      end if
      allocate (keep(size(old%point_load)))
      do i = 1, size(keep)
         associate (load => old%point_load(i), list => new%point_load)
            keep(i) = changes(load%amplitude, pack(list%amplitude, list%node == load%node &
               & .and. list%dof == load%dof))
         end associate
      end do
      changed%point_load = pack(old%point_load, keep)
      deallocate (keep)
      allocate (keep(size(old%face_load)))
      do i = 1, size(keep)
         associate (load => old%face_load(i), list => new%face_load)
            keep(i) = changes(load%amplitude, pack(list%amplitude, list%element == load%element &
               & .and. list%face == load%face .and. list%family == load%family))
         end associate
      end do
      changed%face_load = pack(old%face_load, keep)
      deallocate (keep)
      allocate (keep(size(old%body_load)))
      do i = 1, size(keep)
         associate (load => old%body_load(i), list => new%body_load)
            keep(i) = changes(load%amplitude, pack(list%amplitude, list%element == load%element &
               & .and. list%family == load%family))
         end associate
      end do
      changed%body_load = pack(old%body_load, keep)
   end subroutine changed_loads

   !> Some load of a step follows an amplitude.
   pure logical function follow_some(step)
      type(step_type), intent(in) :: step
      follow_some = any(step%point_load%amplitude > 0) .or. any(step%face_load%amplitude > 0) &
         & .or. any(step%body_load%amplitude > 0)
   end function follow_some

   !> A load that followed amplitude `before` (0: none), where those of the new step at its place
   !> follow `after`.
   pure logical function changes(before, after)
      integer, intent(in) :: before, after(:)

      if (before > 0) then
         changes = .not. any(after > 0)
      else
         changes = size(after) > 0 .and. all(after > 0)
      end if
   end function changes

   !> Add the loads of a step that follow one amplitude (0: none). Under NLGEOM pressures follow
   !> their faces and are not among them (see lopin_follower_loading).
   subroutine add_loads(f, model, dofs, constraints, solids, step, amplitude)
      real(wp), intent(inout) :: f(:)
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      type(solids_type), intent(in) :: solids
      type(step_type), intent(in) :: step
      integer, intent(in) :: amplitude
      integer, allocatable :: chosen(:)
      real(wp), allocatable :: density(:, :)
      integer :: i, k, axes, id, before

      do i = 1, size(step%point_load)
         associate (load => step%point_load(i))
            if (load%amplitude /= amplitude) cycle
            axes = axes_at(constraints, load%node, load%dof)
            before = merge(0, 3, load%dof <= 3)
            do k = 1, merge(3, 1, axes > 0)
               id = dofs%id(merge(before + k, load%dof, axes > 0), load%node)
               if (id == 0) cycle
               if (axes > 0) then
                  f(id) = f(id) + load%value*constraints%axes(load%dof - before, k, axes)
               else
                  f(id) = f(id) + load%value
               end if
            end do
         end associate
      end do
      chosen = pack([(i, i=1, size(step%face_load))], step%face_load%amplitude == amplitude)
      allocate (density(3, size(chosen)))
      do i = 1, size(chosen)
         density(:, i) = step%face_load(chosen(i))%traction
      end do
      if (size(chosen) > 0) call add_face_loads(solids, model%mesh, &
         & step%face_load(chosen)%element, step%face_load(chosen)%face, &
         & merge(0.0_wp, 1.0_wp, step%nlgeom)*step%face_load(chosen)%pressure, density, f)
      chosen = pack([(i, i=1, size(step%body_load))], step%body_load%amplitude == amplitude)
      deallocate (density)
      allocate (density(3, size(chosen)))
      do i = 1, size(chosen)
         density(:, i) = step%body_load(chosen(i))%force
      end do
      if (size(chosen) > 0) call add_body_loads(solids, model%mesh, &
         & step%body_load(chosen)%element, density, f)
   end subroutine add_loads

   !> Share of the ramp that is done.
   pure real(wp) function ramped(self, step_time) result(share)
      type(loading_type), intent(in) :: self
      real(wp), intent(in) :: step_time
      share = 1.0_wp
      if (self%ramp) share = min(1.0_wp, step_time/self%period)
   end function ramped

   !> All loads at a time of the step.
   subroutine loads_at(self, model, step_time, f, steady)
      type(loading_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: step_time
      real(wp), intent(out) :: f(:)        !! (ndof) all loads [force]
      real(wp), intent(out) :: steady(:)   !! (ndof) those without amplitude, to go on from
      real(wp) :: share
      integer :: i

      share = ramped(self, step_time)
      steady = self%before + share*(self%after - self%before)
      if (.not. share < 1.0_wp) steady = self%after
      f = steady
      do i = 1, size(self%amplitude)
         f = f + factor(self, model, self%amplitude(i), step_time)*self%varying(:, i)
      end do
   end subroutine loads_at

   !> All prescribed values at a time of the step.
   subroutine prescribed_at(self, model, step_time, value)
      type(loading_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: step_time
      real(wp), intent(out) :: value(:)    !! (nprescribed) [length] or [rad]
      real(wp) :: share
      integer :: i

      share = ramped(self, step_time)
      do i = 1, size(value)
         if (self%moves(i)) then
            value(i) = self%from(i) + self%to(i)*time_of(self, model, self%follows(i), step_time)
         else if (self%follows(i) > 0) then
            value(i) = self%to(i)*factor(self, model, self%follows(i), step_time)
         else if (share < 1.0_wp) then
            value(i) = self%from(i) + share*(self%to(i) - self%from(i))
         else
            value(i) = self%to(i)
         end if
      end do
   end subroutine prescribed_at

   !> Time of the step so far, each moment times its amplitude.
   pure real(wp) function time_of(self, model, amplitude, step_time) result(time)
      type(loading_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: amplitude         !! 0: none
      real(wp), intent(in) :: step_time
      real(wp) :: from

      time = step_time
      if (amplitude == 0) return
      from = merge(self%start, 0.0_wp, model%amplitude(amplitude)%total_time)
      time = amplitude_integral(model%amplitude(amplitude), from, from + step_time)
   end function time_of

   pure real(wp) function factor(self, model, amplitude, step_time)
      type(loading_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: amplitude
      real(wp), intent(in) :: step_time
      real(wp) :: time

      time = step_time
      if (model%amplitude(amplitude)%total_time) time = time + self%start
      factor = amplitude_value(model%amplitude(amplitude), time)
   end function factor
end module lopin_loading
