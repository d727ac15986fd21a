!> Advice: what a deck models beyond what its scene needs, and what leaving it out would save.
!>
!> Notes only, on what can be told from the deck alone: the answer of such a deck is right.
module lopin_advise
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_advise_plane, only : advise_plane
   use lopin_advise_rigid, only : advise_rigid
   use lopin_advise_slaves, only : advise_slaves
   use lopin_advise_tools, only : advise_tools
   use lopin_advise_symmetry, only : advise_symmetry
   use lopin_advise_revolution, only : advise_revolution
   implicit none
   private
   public :: advise

   !> Decks of fewer elements are done before their advice is read.
   integer, parameter :: worth_saying = 200

contains

   subroutine advise(model)
      type(model_type), intent(inout) :: model
      integer :: plane
      logical :: told

      if (model%remeshes .or. size(model%step) == 0) return
      plane = 0
      if (model%mesh%nelement >= worth_saying) call advise_plane(model, plane)
      call advise_rigid(model)
      call advise_increments(model)
      call advise_tools(model)
      if (model%mesh%nelement < worth_saying) return
      call advise_slaves(model)
      call advise_revolution(model, told)
      if (.not. told) call advise_symmetry(model, plane)
   end subroutine advise

   !> Where nothing remembers the way, a step has one end whatever its increments.
   subroutine advise_increments(model)
      type(model_type), intent(inout) :: model
      integer :: s, count_of

      if (size(model%pair) > 0) then
         if (any([(has_friction(model%interaction(s)%friction), s=1, &
            & size(model%interaction))])) return
         ! What touched on the way is held.
         if (any(model%interaction(model%pair%interaction)%no_separation)) return
      end if
      if (remembers(model) .or. size(model%spring) > 0) return
      do s = 1, size(model%step)
         associate (step => model%step(s))
            if (step%nlgeom .or. .not. step%timed .or. varies(model, s)) cycle
            if (size(step%pair_change) > 0 .or. size(step%friction_change) > 0) cycle
            if (.not. step%initial < 0.5_wp*step%period) cycle
            count_of = nint(step%period/step%initial)
            call model%log%say(severity%note, 'N0363', 'step '//to_text(s)//' asks for '// &
               & to_text(count_of)//' increments: the scene is elastic, small and without '// &
               & 'friction, its end does not depend on them', step%at, &
               & help='*STATIC without data has the same end in one increment; keep them for '// &
               & 'results on the way')
         end associate
      end do
   end subroutine advise_increments

   !> Whether a material remembers the way: it flows, or is of rubber, whose way is not straight.
   pure logical function remembers(model)
      type(model_type), intent(in) :: model
      integer :: i

      remembers = .false.
      do i = 1, size(model%material)
         associate (m => model%material(i))
            remembers = remembers .or. m%flow%hardening /= 0 .or. m%flow%consistency > 0.0_wp &
               & .or. m%has_neo_hooke .or. allocated(m%plastic) .or. .not. m%has_elastic
         end associate
      end do
   end function remembers

   !> Whether something in a step follows an amplitude: its increments are the user's own.
   pure logical function varies(model, s)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s

      associate (step => model%step(s))
         varies = any(step%prescribed%amplitude > 0) .or. any(step%prescribed%velocity)
         varies = varies .or. any(step%point_load%amplitude > 0) .or. &
            & any(step%face_load%amplitude > 0) .or. any(step%body_load%amplitude > 0)
      end associate
   end function varies
end module lopin_advise
