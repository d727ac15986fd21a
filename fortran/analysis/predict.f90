!> Where Newton starts on the finite path: solids that flow go on as they did.
!>
!> The motion of the next increment is read off the last one, or off the last two where these would
!> have told the last one better: velocities at mid-increment, extended linearly. A contact that
!> closes bends the path, and the last motion alone is then the better guess for a while.
module lopin_predict
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_constraints, only : raw_displacement
   use lopin_dense, only : symmetric_eigen
   use lopin_finite_state, only : finite_state_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: predict, start_from_accepted, note_motion, next_motion, coasts, floats, resistance

   !> Prescribed motion that goes on as before, up to this share of itself.
   real(wp), parameter :: same_way = 0.5_wp
   !> What is left of it then is nothing.
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> The trend must have been nearer by this factor at the worst dof: elsewhere a smooth motion
   !> hides the place where a contact has closed.
   real(wp), parameter :: much = 0.3_wp
   !> Springs of contact hold a motion that they resist by more than this, beside the motion which
   !> they resist most.
   real(wp), parameter :: holds = 1.0e-10_wp

contains

   !> A guess, where solids flow and what is prescribed goes on; otherwise the accepted state.
   subroutine predict(scene, prescribed, v, before, guessed)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: prescribed(:)
      real(wp), allocatable, intent(out) :: v(:)        !! (neq)
      real(wp), allocatable, intent(out) :: before(:)   !! (nprescribed) that go with it
      logical, intent(out) :: guessed
      real(wp), allocatable :: from(:)
      real(wp) :: left, way

      call start_from_accepted(scene, v, before)
      guessed = .false.
      associate (state => scene%finite)
         if (.not. state%memory%in_use .or. .not. state%last_dt > 0.0_wp) return
         scene%u = scene%accepted + next_motion(state, state%dt, state%curved)
         call move_alloc(before, from)
         call free_and_prescribed(scene, v, before)
         left = norm2(prescribed - before)
         way = norm2(prescribed - from)
         if (left <= rounding*way) before = prescribed
         guessed = left <= same_way*way
      end associate
      if (.not. guessed) call start_from_accepted(scene, v, before)
   end subroutine predict

   !> The accepted state, and what was prescribed then.
   subroutine start_from_accepted(scene, v, before)
      type(scene_type), intent(inout) :: scene
      real(wp), allocatable, intent(out) :: v(:), before(:)

      scene%u = scene%accepted
      call free_and_prescribed(scene, v, before)
   end subroutine start_from_accepted

   !> Keep the motion of an increment, and which guess would have come nearer to it.
   subroutine note_motion(state, motion)
      type(finite_state_type), intent(inout) :: state
      real(wp), intent(in) :: motion(:)        !! (ndof) of the increment [length]

      if (.not. state%memory%in_use) return
      if (allocated(state%contact%pair_active)) state%held = closed_pairs(state)
      state%curved = .false.
      if (state%last_dt > 0.0_wp .and. state%dt_before > 0.0_wp) state%curved = &
         & largest(motion - next_motion(state, state%dt, .true.)) &
         & < much*largest(motion - next_motion(state, state%dt, .false.))
      if (state%last_dt > 0.0_wp) call move_alloc(state%last_motion, state%motion_before)
      state%dt_before = state%last_dt
      state%last_motion = motion
      state%last_dt = state%dt
      ! A body springs back once.
      if (state%parted) state%last_dt = 0.0_wp
   end subroutine note_motion

   !> A pair has opened on the way from a guess, and a body may float: nothing then holds it where
   !> the guess put it.
   pure logical function coasts(scene)
      type(scene_type), intent(in) :: scene

      coasts = scene%bodies%nq > 0
      if (coasts) coasts = any(scene%finite%held .and. .not. closed_pairs(scene%finite))
   end function coasts

   !> Some rigid motion is held by no contact: it does not go on by itself.
   logical function floats(scene)
      type(scene_type), intent(in) :: scene
      real(wp) :: held(scene%bodies%nq, scene%bodies%nq), value(scene%bodies%nq)
      integer :: status

      floats = .false.
      if (scene%bodies%nq == 0) return
      floats = scene%finite%grounded > 0 .or. .not. allocated(scene%finite%system%block)
      if (floats) return
      call resistance(scene, held)
      call symmetric_eigen(held, value, status)
      floats = status /= 0 .or. .not. minval(value) > holds*maxval(value)
   end function floats

   !> What the springs of contact do against the floating motions.
   subroutine resistance(scene, held)
      type(scene_type), intent(in) :: scene
      real(wp), intent(out) :: held(:, :)      !! (nq, nq)
      integer :: b

      held = 0.0_wp
      do b = 1, size(scene%finite%system%block)
         associate (block => scene%finite%system%block(b), r => scene%bodies%motion)
            associate (at => block%at(:block%nu))
               held = held + matmul(transpose(r(at, :)), matmul(block%spring, r(at, :)))
            end associate
         end associate
      end do
   end subroutine resistance

   !> Pairs with a closed point.
   pure function closed_pairs(state) result(closed)
      type(finite_state_type), intent(in) :: state
      logical :: closed(size(state%contact%pair_active))
      integer :: i

      closed = .false.
      do i = 1, state%contact%n
         if (state%contact%status(i) > 0) closed(state%contact%pair(i)) = .true.
      end do
   end function closed_pairs

   !> Motion in the next increment, of the velocity of the last one or of its trend.
   pure function next_motion(state, dt, curved) result(motion)
      type(finite_state_type), intent(in) :: state
      real(wp), intent(in) :: dt               !! of the next increment [time]
      logical, intent(in) :: curved
      real(wp) :: motion(size(state%last_motion))
      real(wp) :: ahead

      motion = dt/state%last_dt*state%last_motion
      if (.not. curved) return
      ahead = dt*(dt + state%last_dt)/(state%last_dt + state%dt_before)
      motion = motion + ahead*(state%last_motion/state%last_dt &
         & - state%motion_before/state%dt_before)
   end function next_motion

   !> The free equations and the prescribed dofs of the trial displacements.
   subroutine free_and_prescribed(scene, v, prescribed)
      type(scene_type), intent(in) :: scene
      real(wp), allocatable, intent(out) :: v(:), prescribed(:)
      integer :: i

      associate (c => scene%constraints)
         allocate (v(c%neq), prescribed(c%nprescribed))
         v(:) = [(raw_displacement(c, scene%dofs, scene%u, c%dof_of_equation(i)), i=1, c%neq)]
         prescribed(:) = [(raw_displacement(c, scene%dofs, scene%u, c%dof_of_prescribed(i)), &
            & i=1, c%nprescribed)]
      end associate
   end subroutine free_and_prescribed
end module lopin_predict
