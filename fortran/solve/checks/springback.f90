!> Path dependence of a release from the tools: where a body flows or slips on its way out, its
!> springback depends on the way.
!>
!> An elastic release without friction ends in one shape, whether pairs are removed, tools withdrawn
!> or loads taken off. Beside the energy that comes free, the plastic work and the friction of the
!> release tell how far other ways may end elsewhere. A release is a step after which nothing
!> presses any more, or one that takes pairs or supports away, or one that ends the contact of a
!> pair and sets free more than its tools put in: others may press on, as the die on which a flange
!> was wiped.
!>
!> What comes free is a small part of the work of forming. Energy that was lost or found on the
!> way in, beyond what the rule that integrates the work misses of a smooth path
!> (lopin_work_balance), as where few increments follow facets that leave a radius one by one, may
!> be little beside the work and much beside the springback.
!>
!> Where contact passes from point to point over a radius, a strip bends too far at the last point
!> that presses and unbends as the next one comes to press: elastic energy falls while tools do
!> work, and rises again. A fine mesh lets none of it go on the way. Energy is a square of stress:
!> the root of what fell and rose again, beside what comes free at last, is about the most that is
!> wrong of the springback.
module lopin_springback
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type, is_heated
   use lopin_report, only : energy_type
   use lopin_repeated_messages, only : warn_once, note_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: springback_type, note_falls, report_springback

   !> Work done in a release, beside the energy that came free, that is told, and warned of.
   real(wp), parameter :: some = 1.0e-3_wp, much = 0.05_wp
   !> Contact forces that are gone, beside those of the step before.
   real(wp), parameter :: gone = 1.0e-3_wp

   !> Elastic energy that fell while work was done, and rose again.
   type :: falls_type
      real(wp) :: strain = 0.0_wp, external = 0.0_wp    !! at the last increment [energy]
      real(wp) :: fallen = 0.0_wp              !! in this step, not risen again so far [energy]
      real(wp) :: regained = 0.0_wp            !! since the last release [energy]
   end type falls_type

   !> How the last step ended.
   type :: springback_type
      real(wp) :: strain = 0.0_wp              !! elastic energy [energy]
      real(wp) :: plastic = 0.0_wp, friction = 0.0_wp   !! work so far [energy]
      real(wp) :: external = 0.0_wp            !! work so far [energy]
      real(wp) :: unknown = 0.0_wp             !! lost or found beyond what is excused [energy]
      real(wp), allocatable :: pressed(:)      !! (npair) sum of the forces of the points [force]
      type(falls_type) :: falls
   contains
      procedure :: keep
   end type springback_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(springback_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%strain)
      call stream%pass(self%plastic)
      call stream%pass(self%friction)
      call stream%pass(self%external)
      call stream%pass(self%unknown)
      call stream%pass(self%pressed)
      call stream%pass(self%falls%strain)
      call stream%pass(self%falls%external)
      call stream%pass(self%falls%fallen)
      call stream%pass(self%falls%regained)
   end subroutine keep

   !> An increment is accepted: what of the elastic energy fell in it, or rose again.
   pure subroutine note_falls(self, energy)
      type(springback_type), intent(inout) :: self
      type(energy_type), intent(in) :: energy
      real(wp) :: rise, again

      associate (falls => self%falls)
         rise = energy%strain - falls%strain
         if (rise > 0.0_wp) then
            again = min(rise, falls%fallen)
            falls%fallen = falls%fallen - again
            falls%regained = falls%regained + again
         else if (.not. energy%external < falls%external) then
            falls%fallen = falls%fallen - rise
         end if
         falls%strain = energy%strain
         falls%external = energy%external
      end associate
   end subroutine note_falls

   !> A step of the nonlinear path ends: say what it did if it was a release.
   subroutine report_springback(self, scene, model, energy, excess, releases)
      type(springback_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy
      real(wp), intent(in) :: excess            !! work lost so far that is not excused [energy]
      logical, intent(in) :: releases           !! the step took away pairs or supports
      real(wp) :: pressed(size(model%pair)), released

      if (.not. scene%newton%flows) return
      pressed = forces_of_pairs(scene, size(pressed))
      if (.not. allocated(self%pressed)) self%pressed = 0.0_wp*pressed
      released = self%strain - energy%strain
      if (released > 0.0_wp .and. is_release(self, pressed, energy%external - self%external, &
         & released) .or. releases .and. released > 0.5_wp*self%strain) then
         call report_way(scene, model, self%strain, released, energy%plastic - self%plastic, &
            & energy%friction - self%friction)
         if (.not. is_heated(model)) call report_unknown(scene, model, self%unknown, released)
         call report_falls(scene, model, self%falls%regained, released)
         self%falls%regained = 0.0_wp
      end if
      self%falls%fallen = 0.0_wp
      self = springback_type(energy%strain, energy%plastic, energy%friction, energy%external, &
         & abs(excess), pressed, self%falls)
   end subroutine report_springback

   !> Nothing presses any more, or one pair does not, and more energy came free than work went in.
   pure logical function is_release(self, pressed, worked, released)
      type(springback_type), intent(in) :: self
      real(wp), intent(in) :: pressed(:)        !! (npair) at the end of the step [force]
      real(wp), intent(in) :: worked            !! external work of the step [energy]
      real(wp), intent(in) :: released          !! elastic [energy]
      real(wp) :: nothing

      nothing = gone*maxval([0.0_wp, self%pressed])
      is_release = any(pressed <= nothing .and. self%pressed > nothing) &
         & .and. (all(pressed <= nothing) .or. worked < released)
   end function is_release

   !> Sums of the sizes of the forces of the points, by pair [force].
   pure function forces_of_pairs(scene, npair) result(force)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: npair
      real(wp) :: force(npair)
      integer :: i

      force = 0.0_wp
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%facet(i) == 0) cycle
            force(c%pair(i)) = force(c%pair(i)) + c%weight(i)*norm2(c%traction(:, i))
         end do
      end associate
   end function forces_of_pairs

   !> What comes free is no better known than the energy that is there to come free.
   subroutine report_unknown(scene, model, unknown, released)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: unknown, released !! [energy]

      if (.not. unknown > much*released) return
      call warn_once(scene%log, 'W0519', 'step '//to_text(scene%step)//' is a release: '// &
         & to_text(released, 3)//' of elastic energy comes free, and '//to_text(unknown, 3)// &
         & ' of work is not accounted for before it ('// &
         & to_text(100.0_wp*unknown/released, 2)//' %): the springback is known no better', &
         & model%step(scene%step)%at, help='smaller increments on *STATIC before the release, '// &
         & 'or more facets on the radii that the metal leaves')
   end subroutine report_unknown

   !> What comes free at last, beside what did so on the way as points took over from each other.
   !> Energy is a square of stress: the springback is off by up to about the root of that.
   subroutine report_falls(scene, model, regained, released)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: regained, released   !! [energy]
      character(len=:), allocatable :: text

      if (.not. regained > much**2*released) return
      text = 'step '//to_text(scene%step)//' is a release: '//to_text(released, 3)// &
         & ' of elastic energy comes free, and '//to_text(regained, 3)// &
         & ' fell and rose again before it, while tools did work, as facets came to press one '// &
         & 'by one: for that the springback may be off by some '// &
         & to_text(100.0_wp*sqrt(min(regained/released, 1.0_wp)), 2)//' %'
      associate (at => model%step(scene%step)%at)
         if (regained > much*released) then
            call warn_once(scene%log, 'W0522', text, at, help='more facets on the radii that '// &
               & 'the metal passes: half as long ones tell what of the springback stays')
         else
            call note_once(scene%log, 'N0522', text, at)
         end if
      end associate
   end subroutine report_falls

   !> The work of a release, if there is any.
   subroutine report_way(scene, model, stored, released, flowed, rubbed)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: stored, released, flowed, rubbed   !! [energy]
      character(len=:), allocatable :: text
      real(wp) :: share

      share = (flowed + rubbed)/released
      if (.not. share > some) return
      text = 'step '//to_text(scene%step)//' is a release: of the elastic energy of '// &
         & to_text(stored, 4)//', '//to_text(released, 4)//' comes free, and '
      if (flowed > some*released) text = text//'the metal flows again (plastic work '// &
         & to_text(flowed, 3)//')'
      if (flowed > some*released .and. rubbed > some*released) text = text//' and '
      if (rubbed > some*released) text = text//'rubs on the tools (work of friction '// &
         & to_text(rubbed, 3)//')'
      if (max(flowed, rubbed) <= some*released) text = text//'a little is used up on the way'
      text = text//': the springback depends on the way, by about '// &
         & to_text(100.0_wp*min(share, 1.0_wp), 2)//' % of it'
      associate (at => model%step(scene%step)%at)
         if (share > much) then
            call warn_once(scene%log, 'W0518', text, at, help='let go as the press does: '// &
               & 'withdraw the tools by their motion, in their order')
         else
            call note_once(scene%log, 'N0518', text, at)
         end if
      end associate
   end subroutine report_way
end module lopin_springback
