!> Balance of work: what is neither stored nor dissipated, beyond the error of the rule that
!> integrates it.
!>
!> External work is a trapezoid over increments, and so is that of contact in it, which is known:
!> friction, and what springs hold. Where points close or open, what the trapezoid has beyond that
!> is their force on the way through a gap; it is taken off the work if that explains what is lost:
!> a tool that goes on where it has left the body does none. Of forces r and displacements u that
!> bend, the trapezoid misses |dr·u'' - r''·du| dt²/12, and as much in the next increment as in
!> this one, but for the cube of their lengths: three times the lesser is allowed for. So a jump
!> within one increment (another branch, a body that snaps) is no bend, and what is lost all the
!> way is no jump.
module lopin_work_balance
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : energy_type, lost_work
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: balance_type, mend_work, note_work, note_energy, end_balance

   !> Work that may be lost, beside all of it: of solids that flow, and remember how, and of others.
   real(wp), parameter :: flow_limit = 0.01_wp, elastic_limit = 0.03_wp
   !> Times the estimate, for kinks; where a step begins a yield stress may be reached at once.
   real(wp), parameter :: kinks = 3.0_wp, from_rest = 6.0_wp

   !> What is kept of an increment.
   type :: increment_type
      integer :: number = 0                     !! 0: none
      real(wp) :: dt = 0.0_wp                   !! [time]
      real(wp) :: lost = 0.0_wp                 !! [energy]
      real(wp) :: excused = 0.0_wp              !! closing and opening, artificial [energy]
      real(wp), allocatable :: speed(:), rate(:)   !! (ndof) of u and of the forces on the boundary
   contains
      procedure :: keep => keep_increment
   end type increment_type

   type :: balance_type
      type(increment_type) :: of(3)             !! the last ones of the step, the newest last
      real(wp) :: lost = 0.0_wp                 !! of the energies so far [energy]
      real(wp) :: artificial = 0.0_wp           !! the same
      real(wp) :: excess = 0.0_wp               !! lost beyond what is excused [energy]
      real(wp) :: said = 0.0_wp                 !! of it, when last it was told
      real(wp) :: worst = 0.0_wp                !! of one increment since
      integer :: at = 0                         !! its number
      logical :: springs_back = .false.         !! the step takes away what held a body
      logical, allocatable :: closed(:)         !! (npoint) at the end of the last increment
      real(wp), allocatable :: pressed(:)       !! (ndof) contact forces there [force]
      real(wp) :: dissipated = 0.0_wp, stored = 0.0_wp   !! by contact so far [energy]
   contains
      procedure :: keep
   end type balance_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(balance_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      integer :: i

      do i = 1, size(self%of)
         call self%of(i)%keep(stream)
      end do
      call stream%pass(self%lost)
      call stream%pass(self%artificial)
      call stream%pass(self%excess)
      call stream%pass(self%said)
      call stream%pass(self%worst)
      call stream%pass(self%at)
      call stream%pass(self%springs_back)
      call stream%pass(self%closed)
      call stream%pass(self%pressed)
      call stream%pass(self%dissipated)
      call stream%pass(self%stored)
   end subroutine keep

   subroutine keep_increment(self, stream)
      class(increment_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%number)
      call stream%pass(self%dt)
      call stream%pass(self%lost)
      call stream%pass(self%excused)
      call stream%pass(self%speed)
      call stream%pass(self%rate)
   end subroutine keep_increment

   !> How boundary forces and displacements change in an increment that is about to be accepted.
   subroutine note_work(self, number, dt, moved, changed)
      type(balance_type), intent(inout) :: self
      integer, intent(in) :: number             !! of the increment in its step
      real(wp), intent(in) :: dt                !! [time]
      real(wp), intent(in) :: moved(:)          !! (ndof) [length]
      real(wp), intent(in) :: changed(:)        !! (ndof) loads and reactions [force]

      self%of(:2) = self%of(2:)
      self%of(3) = increment_type(number=number, dt=dt, speed=moved/dt, rate=changed/dt)
   end subroutine note_work

   !> Take off the external work of an increment what its trapezoid counts of gaps, and what held
   !> floating bodies has not taken up.
   subroutine mend_work(self, scene, pressed, energy)
      type(balance_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: pressed(:)        !! (ndof) contact forces [force]
      type(energy_type), intent(inout) :: energy
      real(wp) :: lost, closing

      lost = lost_work(energy) - self%lost - (energy%artificial - self%artificial)
      closing = work_of_gaps(self, scene, pressed, energy)
      if (.not. abs(lost - closing) < abs(lost)) return
      energy%external = energy%external - closing
      scene%trial%loads%work = energy%external
   end subroutine mend_work

   !> Its energies; the increment before it can now be judged.
   subroutine note_energy(self, scene, energy)
      type(balance_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(energy_type), intent(in) :: energy

      associate (now => self%of(3))
         now%lost = lost_work(energy) - self%lost
         now%excused = abs(energy%artificial - self%artificial)
         ! A jump sets its energy free, and is told by itself.
         if (scene%newton%jumped) now%excused = now%excused + max(0.0_wp, now%lost)
         ! An interference that is ramped in does work of its own.
         if (scene%newton%contact%closes_in) now%excused = huge(1.0_wp)
         ! What is let go of gives its energy to nothing.
         if (self%springs_back .and. now%number == 1) now%excused = huge(1.0_wp)
         self%lost = lost_work(energy)
         self%artificial = energy%artificial
      end associate
      if (self%of(2)%number > 0) call check(self, self%of(1), self%of(2), self%of(3))
   end subroutine note_energy

   !> What the trapezoid counts beyond the work of contact that is known, where points close or
   !> open: of their forces on the way through their gaps.
   real(wp) function work_of_gaps(self, scene, pressed, energy) result(work)
      type(balance_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: pressed(:)        !! (ndof) contact forces [force]
      type(energy_type), intent(in) :: energy
      logical :: closed(scene%newton%contact%n)

      work = 0.0_wp
      associate (c => scene%newton%contact)
         closed = c%status(:c%n) > 0 .and. c%facet(:c%n) > 0
      end associate
      if (.not. allocated(self%closed)) then
         allocate (self%closed(size(closed)), source=.false.)
         allocate (self%pressed(size(pressed)), source=0.0_wp)
      end if
      if (size(self%closed) == size(closed)) then
         if (any(self%closed .neqv. closed)) work = self%dissipated - energy%friction_mean &
            & + self%stored - energy%contact - 0.5_wp*dot_product(self%pressed + pressed, &
            & scene%trial%motion%u - scene%accepted%motion%u)
      end if
      self%closed = closed
      self%pressed = pressed
      self%dissipated = energy%friction_mean
      self%stored = energy%contact
   end function work_of_gaps

   !> Compare what an increment lost with what may be missed there.
   subroutine check(self, before, one, after)
      type(balance_type), intent(inout) :: self
      type(increment_type), intent(in) :: before, one, after   !! before: perhaps none
      real(wp) :: missed, excess

      if (before%number > 0) then
         missed = kinks*min(bend(before, one, after), max(as_in(before, one), as_in(after, one)))
      else
         missed = from_rest*bend(one, one, after)
      end if
      excess = sign(max(0.0_wp, abs(one%lost) - one%excused - missed), one%lost)
      self%excess = self%excess + excess
      if (abs(excess) <= abs(self%worst)) return
      self%worst = excess
      self%at = one%number
   end subroutine check

   !> What a neighbour lost, as an increment as long as this one would.
   pure real(wp) function as_in(neighbour, one)
      type(increment_type), intent(in) :: neighbour, one

      as_in = 0.0_wp
      if (neighbour%number /= one%number) as_in = abs(neighbour%lost)*(one%dt/neighbour%dt)**3
   end function as_in

   !> What the trapezoid of an increment misses, by the bend of the path between two others.
   pure real(wp) function bend(before, one, after)
      type(increment_type), intent(in) :: before, one, after
      real(wp) :: apart

      apart = 0.5_wp*(before%dt + after%dt)
      if (before%number /= one%number .and. after%number /= one%number) apart = apart + one%dt
      bend = 0.0_wp
      if (before%number == after%number) return
      bend = abs(dot_product(one%rate, after%speed - before%speed) - dot_product(one%speed, &
         & after%rate - before%rate))*one%dt**3/(12.0_wp*apart)
   end function bend

   !> A step ends: judge its last increment and say what was lost in it, or so far where that was
   !> not said.
   subroutine end_balance(self, scene, model, energy)
      type(balance_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy
      real(wp) :: whole
      integer :: i

      if (self%of(3)%number > 0) call check(self, self%of(2), self%of(3), self%of(3))
      do i = 1, size(self%of)
         self%of(i)%number = 0
      end do
      whole = max(energy%most, energy%nothing)
      if (.not. max(0.0_wp, abs(self%excess - self%said) - energy%nothing) &
         & > merge(flow_limit, elastic_limit, scene%newton%flows)*whole) return
      call warn_once(scene%log, 'W0530', to_text(100.0_wp*(self%excess - self%said)/whole, 3)// &
         & ' % of the work is neither stored nor dissipated in step '//to_text(scene%step)// &
         & ', beyond what increments of this size may miss; most of it, '//to_text(100.0_wp &
         & *self%worst/whole, 3)//' %, in increment '//to_text(self%at), &
         & model%step(scene%step)%at, help='smaller increments on *STATIC: a body may leap '// &
         & 'to another equilibrium within one')
      self%said = self%excess
      self%worst = 0.0_wp
   end subroutine end_balance
end module lopin_work_balance
