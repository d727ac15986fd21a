!> What a pair carried at most in a run: a tool that presses and withdraws leaves nothing at
!> its end.
module lopin_pair_peak
   use lopin_kinds, only : wp
   use lopin_json_writer, only : json_writer_type
   use lopin_recorder_table, only : pair_summary_type
   use lopin_report, only : frame_type
   use lopin_stream, only : stream_type
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   implicit none
   private
   public :: pair_peak_type, note_peak, keep_peak, add_peak, pair_words

   !> An end below this share of the most is not the most.
   real(wp), parameter :: near = 0.99_wp

   type :: pair_peak_type
      real(wp) :: force = 0.0_wp               !! largest magnitude [force]
      real(wp) :: pressure = 0.0_wp            !! largest [stress]
      integer :: at(2) = 0                     !! step and increment of the force
      integer :: pressure_at(2) = 0            !! those of the pressure
   end type pair_peak_type

contains

   !> Another increment was accepted.
   pure subroutine note_peak(self, pair, frame)
      type(pair_peak_type), intent(inout) :: self
      type(pair_summary_type), intent(in) :: pair
      type(frame_type), intent(in) :: frame

      if (norm2(pair%force) > self%force) then
         self%force = norm2(pair%force)
         self%at = [frame%step, frame%increment]
      end if
      if (pair%max_pressure > self%pressure) then
         self%pressure = pair%max_pressure
         self%pressure_at = [frame%step, frame%increment]
      end if
   end subroutine note_peak

   !> All of it, to a stream or back.
   subroutine keep_peak(self, stream)
      type(pair_peak_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%force)
      call stream%pass(self%pressure)
      call stream%pass_within(self%at)
      call stream%pass_within(self%pressure_at)
   end subroutine keep_peak

   subroutine add_peak(self, json)
      type(pair_peak_type), intent(in) :: self
      type(json_writer_type), intent(inout) :: json

      call json%open('{', 'peak')
      call json%add('force', self%force)
      call json%add('step', self%at(1))
      call json%add('increment', self%at(2))
      call json%add('pressure', self%pressure)
      call json%add('pressure_step', self%pressure_at(1))
      call json%add('pressure_increment', self%pressure_at(2))
      call json%close('}')
   end subroutine add_peak

   !> A pair at the end, and at its most where that was earlier: "25 points in contact, ...".
   function pair_words(self, pair, ndim) result(text)
      type(pair_peak_type), intent(in) :: self
      type(pair_summary_type), intent(in) :: pair
      integer, intent(in) :: ndim
      character(len=:), allocatable :: text
      character(len=80) :: force, pressure

      if (pair%closed == 0 .and. self%at(1) > 0) then
         text = 'open at the end'
      else
         associate (f => pair%force(:ndim))
            ! Components that are round-off beside the others are shown as none.
            write (force, '(*(g0.6, :, ", "))') &
               & merge(f, 0.0_wp, abs(f) > 1.0e-12_wp*maxval(abs(f)))
         end associate
         write (pressure, '(g0.6)') pair%max_pressure
         text = plural(pair%closed, 'point')//' in contact, force ('//trim(force)// &
            & '), largest pressure '//trim(pressure)
      end if
      if (norm2(pair%force) < near*self%force) text = text//'; largest force of the run '// &
         & to_text(self%force, 6)//' in '//place(self%at)
      if (pair%max_pressure < near*self%pressure) text = text//'; largest pressure of the run '// &
         & to_text(self%pressure, 6)//' in '//place(self%pressure_at)
   end function pair_words

   function place(at) result(text)
      integer, intent(in) :: at(2)
      character(len=:), allocatable :: text

      text = 'step '//to_text(at(1))//', increment '//to_text(at(2))
   end function place
end module lopin_pair_peak
