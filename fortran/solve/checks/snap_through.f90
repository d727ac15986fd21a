!> Where the path of equilibria turned back, and a body jumped to another equilibrium.
!>
!> A real part sets energy free there, as sound and speed. What a run loses in such an increment is
!> that energy; it is said. The answer of a run that loses much of its work so is one of several.
module lopin_snap_through
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : energy_type
   use lopin_repeated_messages, only : warn_once, note_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: snap_through_type, record_snap_through, report_snap_through

   !> Energy set free, beside the work, above which several equilibria are in play.
   real(wp), parameter :: much = 0.05_wp
   !> And below which no jump is told.
   real(wp), parameter :: none = 1.0e-4_wp

   !> Jumps of the present step.
   type :: snap_through_type
      integer :: number = 0
      integer :: first = 0, last = 0           !! increments
      real(wp) :: freed = 0.0_wp               !! [energy]
   contains
      procedure :: keep
   end type snap_through_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(snap_through_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%number)
      call stream%pass(self%first)
      call stream%pass(self%last)
      call stream%pass(self%freed)
   end subroutine keep

   !> An increment that slow motion ended is about to be accepted.
   pure subroutine record_snap_through(self, increment, lost)
      type(snap_through_type), intent(inout) :: self
      integer, intent(in) :: increment
      real(wp), intent(in) :: lost             !! work neither stored nor dissipated [energy]

      if (self%number == 0) self%first = increment
      self%number = self%number + 1
      self%last = increment
      self%freed = self%freed + max(lost, 0.0_wp)
   end subroutine record_snap_through

   !> A step ends: say where it jumped.
   subroutine report_snap_through(self, scene, model, energy)
      type(snap_through_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy
      character(len=:), allocatable :: where_, text
      real(wp) :: share

      if (self%number == 0) return
      share = self%freed/max(energy%most, energy%nothing, tiny(1.0_wp))
      where_ = 'increment '//to_text(self%first)
      if (self%number > 1) where_ = to_text(self%number)//' increments from '// &
         & to_text(self%first)//' to '//to_text(self%last)
      text = 'step '//to_text(scene%step)//': slow motion found the equilibrium of '//where_// &
         & ', where Newton alone found none'
      if (share > none) text = text//': the body jumped, and '//to_text(100.0_wp*share, 2)// &
         & ' % of the work was set free'
      associate (at => model%step(scene%step)%at)
         if (share > much) then
            call warn_once(scene%log, 'W0517', text, at, help='a finer mesh where it bends, '// &
               & 'or what holds it there, as a pad: the answer is one of several')
         else
            call note_once(scene%log, 'N0517', text, at)
         end if
      end associate
      self = snap_through_type()
   end subroutine report_snap_through
end module lopin_snap_through
