!> The way of an increment before further contacts close, where its first step does not lead there.
!>
!> Slip counts from where a point touched (lopin_touch_onset), on the way that the increment leads
!> to before further contacts close. The first step of Newton gives it where friction goes on as it
!> was: what slid into the accepted state slides on. Where what is prescribed turns round, those
!> points stick or slide the other way, and with them moves what is open. There the points that are
!> open wait: Newton comes near the balance of what is closed, slip counts from the way to there,
!> and then they may close.
module lopin_awaited_touch
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_contact_row, only : contact_status
   use lopin_touch_onset, only : may_touch
   use lopin_slip_increment, only : shear_of
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_residual, only : evaluation_type, evaluate
   use lopin_line_search, only : search_type
   use lopin_newton_convergence, only : relative, reference_of
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: awaited_type, note_slides, await_touch, go_on_waiting

   !> The balance of what is closed, beside forces: the way is a line through it.
   real(wp), parameter :: near = 1.0e-2_wp
   !> Steps of Newton to there; after as many more Newton goes on from its first step.
   integer, parameter :: most_steps = 10

   type :: awaited_type
      logical :: on = .false.
      integer :: steps = 0
      real(wp), allocatable :: slid(:, :)      !! (3, n) shears of what slides at first [stress]
      integer, allocatable :: status(:)        !! (n) before the last step
      ! where the first step led
      real(wp), allocatable :: v(:)            !! (neq) [length]
      real(wp), allocatable :: multiplier(:)   !! (nmultiplier) [stress]
   end type awaited_type

contains

   !> What slides where the first step of Newton starts.
   pure subroutine note_slides(self, contact)
      type(awaited_type), intent(inout) :: self
      type(nonlinear_contact_type), intent(in) :: contact
      integer :: i

      allocate (self%slid(3, contact%n), source=0.0_wp)
      do i = 1, contact%n
         if (contact%status(i) == contact_status%slip) self%slid(:, i) = shear_of(contact, i)
      end do
   end subroutine note_slides

   !> After the first step: where some of it sticks or slides the other way, points that are open
   !> wait.
   subroutine await_touch(self, scene, model, search, v, evaluation, error)
      type(awaited_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(in) :: search
      real(wp), intent(in) :: v(:)             !! (neq) [length]
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      associate (c => scene%newton%contact)
         if (.not. any([(has_turned(self, c, i), i=1, c%n)])) return
         c%waits = [(may_touch(c, i), i=1, c%n)]
         if (.not. any(c%waits)) return
         self%on = .true.
         self%v = v
         self%multiplier = scene%trial%contact%multiplier
         c%noted = 0.0_wp
         call evaluate(scene, model, search%load, .true., evaluation, error)
         self%status = c%status
      end associate
   end subroutine await_touch

   !> Before another step: where the balance is near, slip counts from the way to it, and nothing
   !> waits any more. Where it does not come near, or a step has failed, all goes on from where the
   !> first step led.
   subroutine go_on_waiting(self, scene, model, search, v, evaluation, error)
      type(awaited_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(search_type), intent(in) :: search
      real(wp), intent(inout) :: v(:)          !! (neq) [length]
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(inout) :: error
      logical :: failed, is_near

      self%steps = self%steps + 1
      associate (c => scene%newton%contact)
         failed = allocated(error)
         if (.not. failed) failed = self%steps > most_steps .or. scene%newton%grounded > 0
         is_near = .false.
         if (.not. failed) then
            if (evaluation%inverted == 0) is_near = relative(evaluation, reference_of(scene, &
               & evaluation)) < near .and. all(c%status == self%status)
            self%status = c%status
            if (.not. is_near) return
         end if
         self%on = .false.
         c%waits = .false.
         if (failed) then
            if (allocated(error)) deallocate (error)
            v = self%v
            scene%trial%contact%multiplier = self%multiplier
            call expand(scene%constraints, v, search%prescribed, scene%trial%motion%u)
         else
            c%noted = c%ahead
         end if
         call evaluate(scene, model, search%load, .true., evaluation, error)
         c%noted = 0.0_wp
      end associate
   end subroutine go_on_waiting

   !> A point that slid sticks, or slides the other way.
   pure logical function has_turned(self, contact, i)
      type(awaited_type), intent(in) :: self
      type(nonlinear_contact_type), intent(in) :: contact
      integer, intent(in) :: i

      has_turned = any(abs(self%slid(:, i)) > 0.0_wp) .and. contact%status(i) > 0
      if (has_turned) has_turned = contact%status(i) /= contact_status%slip &
         & .or. dot_product(self%slid(:, i), shear_of(contact, i)) < 0.0_wp
   end function has_turned
end module lopin_awaited_touch
