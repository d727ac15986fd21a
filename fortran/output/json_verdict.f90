!> The verdict of a run in `job.json`: that of its worst increment, and its energies.
module lopin_json_verdict
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   use lopin_report, only : frame_type, certificate_type, energy_type, verdict_words, lost_work, &
      & keep_certificate, keep_energy
   use lopin_json_writer, only : json_writer_type
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   implicit none
   private
   public :: verdict_type, note_verdict, keep_verdict, add_judgement, verdict_line

   !> Shares of the work that are rounding.
   real(wp), parameter :: unseen = 1.0e-12_wp

   type :: verdict_type
      type(certificate_type) :: certificate    !! of the worst increment, of the last of equal ones
      integer :: at(2) = 0                     !! its step and number; 0: no increment yet
      integer :: warned = 0                    !! increments that are not PASS
      type(energy_type) :: energy              !! at the end
   end type verdict_type

contains

   !> Another increment was accepted.
   subroutine note_verdict(self, frame)
      type(verdict_type), intent(inout) :: self
      type(frame_type), intent(in) :: frame

      logical :: worse

      worse = frame%certificate%verdict > self%certificate%verdict
      if (frame%certificate%verdict == self%certificate%verdict) worse = &
         & frame%certificate%excess >= self%certificate%excess
      if (worse) then
         self%certificate = frame%certificate
         self%at = [frame%step, frame%increment]
      end if
      if (frame%certificate%verdict > 0) self%warned = self%warned + 1
      self%energy = frame%energy
   end subroutine note_verdict

   !> All of it, to a stream or back.
   subroutine keep_verdict(self, stream)
      type(verdict_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call keep_certificate(self%certificate, stream)
      call stream%pass_within(self%at)
      call stream%pass(self%warned)
      call keep_energy(self%energy, stream)
   end subroutine keep_verdict

   subroutine add_judgement(self, json)
      type(verdict_type), intent(in) :: self
      type(json_writer_type), intent(inout) :: json

      associate (c => self%certificate)
         call json%open('{', 'certificate')
         call json%add('verdict', verdict_words(c%verdict))
         call json%add('reason', c%reason)
         call json%add('step', self%at(1))
         call json%add('increment', self%at(2))
         call json%add('increments_warned', self%warned)
         call json%add('penetration', c%penetration)
         call json%add('depth', c%depth)
         call json%add('tension', c%tension)
         call json%add('complementarity', c%complementarity)
         call json%add('cone', c%rubs%cone)
         call json%add('ramp', c%rubs%ramp)
         call json%add('dissipation', c%rubs%dissipation)
         call json%add('pressure_error', c%pressure_error)
         call json%add('equilibrium', c%equilibrium)
         call json%add('action_reaction', c%action_reaction)
         call json%add('energy', c%energy)
         call json%add('traction', c%traction)
         call json%add('support', c%support)
         call json%add('artificial', c%artificial)
         call json%add('corner', c%corner)
         call json%close('}')
      end associate
      associate (energy => self%energy)
         call json%open('{', 'energy')
         call json%add('strain', energy%strain)
         call json%add('external', energy%external)
         call json%add('thermal', energy%thermal)
         call json%add('contact', energy%contact)
         call json%add('friction', energy%friction)
         call json%add('friction_mean', energy%friction_mean)
         call json%add('plastic', energy%plastic)
         call json%add('artificial', energy%artificial)
         if (energy%hourglass > 0.0_wp) call json%add('hourglass', energy%hourglass)
         call json%add('lost', lost_work(energy))
         call json%close('}')
      end associate
   end subroutine add_judgement

   !> The verdict of the run in a line; empty without an increment.
   function verdict_line(self) result(text)
      type(verdict_type), intent(in) :: self
      character(len=:), allocatable :: text

      text = ''
      if (self%at(1) == 0) return
      text = 'certificate: '//trim(verdict_words(self%certificate%verdict))
      if (self%energy%artificial > unseen*self%energy%most) text = text//'; artificial work '// &
         & to_text(self%energy%artificial, 3)//', '//to_text(100.0_wp*self%energy%artificial/ &
         & self%energy%most, 3)//' % of all'
      if (self%energy%hourglass > unseen*self%energy%most) text = text//'; energy of hourglass '// &
         & 'motions '//to_text(self%energy%hourglass, 3)
      if (self%warned == 0) return
      text = text//', '//plural(self%warned, 'increment')//' not PASS; step '// &
         & to_text(self%at(1))//', increment '//to_text(self%at(2))//': '//self%certificate%reason
   end function verdict_line
end module lopin_json_verdict
