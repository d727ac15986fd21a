!> The predictor of the nonlinear path: the start of Newton is extrapolated from the last increments
!> of solids that flow.
!>
!> The motion of the next increment is read off the last one, or off the last two where these would
!> have told the last one better: velocities at mid-increment, extended linearly. A contact that
!> closes bends the path, and the last motion alone is then the better guess for a while.
module lopin_predictor
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_constraints, only : raw_displacement
   use lopin_dense, only : symmetric_eigen
   use lopin_newton_workspace, only : newton_workspace_type
   use lopin_state, only : motion_type
   use lopin_contact_block, only : spring_of
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: predict, start_from_accepted, record_motion, extrapolated_motion, closed_pairs, &
      & opened_after_guess, has_free_motion
   public :: resistance, iterate_type

   !> Where trial displacements stand.
   type :: iterate_type
      real(wp), allocatable :: v(:)            !! (neq) free displacements [length]
      real(wp), allocatable :: before(:)       !! (nprescribed) values that go with them
      logical :: guessed = .false.             !! no accepted state
   end type iterate_type

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
   subroutine predict(scene, prescribed, iterate)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(iterate_type), intent(out) :: iterate
      real(wp), allocatable :: from(:)
      real(wp) :: left, way

      call start_from_accepted(scene, iterate)
      associate (motion => scene%accepted%motion)
         if (.not. scene%newton%flows .or. .not. motion%last_dt > 0.0_wp) return
         scene%trial%motion%u = motion%u + extrapolated_motion(motion, scene%newton%dt, &
            & motion%curved)
         call move_alloc(iterate%before, from)
         call free_and_prescribed(scene, iterate%v, iterate%before)
         left = norm2(prescribed - iterate%before)
         way = norm2(prescribed - from)
         if (left <= rounding*way) iterate%before = prescribed
         iterate%guessed = left <= same_way*way
      end associate
      if (.not. iterate%guessed) call start_from_accepted(scene, iterate)
   end subroutine predict

   !> The accepted state, and what was prescribed then.
   subroutine start_from_accepted(scene, iterate)
      type(scene_type), intent(inout) :: scene
      type(iterate_type), intent(out) :: iterate

      scene%trial%motion%u = scene%accepted%motion%u
      call free_and_prescribed(scene, iterate%v, iterate%before)
   end subroutine start_from_accepted

   !> Keep the motion of an increment, and which guess would have come nearer to it.
   subroutine record_motion(self, motion, dt, separated)
      type(motion_type), intent(inout) :: self
      real(wp), intent(in) :: motion(:)        !! (ndof) of the increment [length]
      real(wp), intent(in) :: dt               !! [time]
      logical, intent(in) :: separated         !! a tool has left, or a body floats

      self%curved = .false.
      if (self%last_dt > 0.0_wp .and. self%dt_before > 0.0_wp) self%curved = &
         & largest(motion - extrapolated_motion(self, dt, .true.)) &
         & < much*largest(motion - extrapolated_motion(self, dt, .false.))
      if (self%last_dt > 0.0_wp) call move_alloc(self%last, self%before)
      self%dt_before = self%last_dt
      self%last = motion
      self%last_dt = dt
      ! A body springs back once.
      if (separated) self%last_dt = 0.0_wp
   end subroutine record_motion

   !> A pair has opened on the way from a guess, and a body may float: nothing then holds it where
   !> the guess put it.
   pure logical function opened_after_guess(scene)
      type(scene_type), intent(in) :: scene

      opened_after_guess = scene%bodies%nq > 0
      if (opened_after_guess) opened_after_guess = any(scene%accepted%contact%held &
         & .and. .not. closed_pairs(scene%newton))
   end function opened_after_guess

   !> Some rigid motion is held by no contact: it does not go on by itself.
   logical function has_free_motion(scene)
      type(scene_type), intent(in) :: scene
      real(wp) :: held(scene%bodies%nq, scene%bodies%nq), value(scene%bodies%nq)
      integer :: status

      has_free_motion = .false.
      if (scene%bodies%nq == 0) return
      has_free_motion = scene%newton%grounded > 0 .or. .not. allocated(scene%newton%system%block)
      if (has_free_motion) return
      call resistance(scene, held)
      call symmetric_eigen(held, value, status)
      has_free_motion = status /= 0 .or. .not. minval(value) > holds*maxval(value)
   end function has_free_motion

   !> What the springs of contact do against the floating motions.
   subroutine resistance(scene, held)
      type(scene_type), intent(in) :: scene
      real(wp), intent(out) :: held(:, :)      !! (nq, nq)
      integer :: b

      held = 0.0_wp
      do b = 1, size(scene%newton%system%block)
         associate (block => scene%newton%system%block(b), r => scene%bodies%motion)
            associate (at => block%at(:block%nu))
               held = held + matmul(transpose(r(at, :)), matmul(spring_of(block), r(at, :)))
            end associate
         end associate
      end do
   end subroutine resistance

   !> Pairs with a closed point.
   pure function closed_pairs(state) result(closed)
      type(newton_workspace_type), intent(in) :: state
      logical :: closed(size(state%contact%pair_active))
      integer :: i

      closed = .false.
      do i = 1, state%contact%n
         if (state%contact%status(i) > 0) closed(state%contact%pair(i)) = .true.
      end do
   end function closed_pairs

   !> Motion in the next increment, of the velocity of the last one or of its trend.
   pure function extrapolated_motion(self, dt, curved) result(motion)
      type(motion_type), intent(in) :: self
      real(wp), intent(in) :: dt               !! of the next increment [time]
      logical, intent(in) :: curved
      real(wp) :: motion(size(self%last))
      real(wp) :: ahead

      motion = dt/self%last_dt*self%last
      if (.not. curved) return
      ahead = dt*(dt + self%last_dt)/(self%last_dt + self%dt_before)
      motion = motion + ahead*(self%last/self%last_dt - self%before/self%dt_before)
   end function extrapolated_motion

   !> The free equations and the prescribed dofs of the trial displacements.
   subroutine free_and_prescribed(scene, v, prescribed)
      type(scene_type), intent(in) :: scene
      real(wp), allocatable, intent(out) :: v(:), prescribed(:)
      integer :: i

      associate (c => scene%constraints)
         allocate (v(c%neq), prescribed(c%nprescribed))
         v(:) = [(raw_displacement(c, scene%dofs, scene%trial%motion%u, c%dof_of_equation(i)), &
            & i=1, c%neq)]
         prescribed(:) = [(raw_displacement(c, scene%dofs, scene%trial%motion%u, &
            & c%dof_of_prescribed(i)), &
            & i=1, c%nprescribed)]
      end associate
   end subroutine free_and_prescribed
end module lopin_predictor
