!> Slopes that were chosen by the facet are too soft for bodies that are confined, or layered: there
!> all points together meet a compliance far below that of each. The estimate sees it; what was
!> chosen is raised until the error is within its target. Slopes of the deck are used as given.
module lopin_raise_penalty
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_friction, only : has_friction
   use lopin_model, only : model_type, interaction_type
   use lopin_active_set, only : outcome
   use lopin_state, only : contact_state_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: raising_type, chooses_slope, chooses_elastic_slip, wants_other_slope, choose_other, &
      & report_raised

   !> Times that a run raises them.
   integer, parameter :: most_raises = 20
   !> Most and least by which they rise at once; of an augmentation that does not settle.
   real(wp), parameter :: most_at_once = 1.0e4_wp, least_at_once = 2.0_wp, unsettled = 10.0_wp
   !> A raise that leaves more than this of the error does not mend it.
   real(wp), parameter :: no_better = 0.5_wp
   !> The error that is aimed at, relative to the target.
   real(wp), parameter :: margin = 0.5_wp

   !> What an increment has tried.
   type :: raising_type
      real(wp) :: before = 0.0_wp    !! factor of the solve before; 0: none, or gone back to
      real(wp) :: error = 0.0_wp     !! of that solve, relative
      real(wp) :: first = 0.0_wp     !! of the first solve, relative
   end type raising_type

contains

   !> Some pair leaves its slope open; `augments`: some such pair augments.
   pure subroutine chooses_slope(model, chooses, augments)
      type(model_type), intent(in) :: model
      logical, intent(out) :: chooses, augments
      integer :: pair

      chooses = .false.
      augments = .false.
      do pair = 1, size(model%pair)
         associate (law => model%interaction(model%pair(pair)%interaction))
            if (law%slope*law%scale > 0.0_wp .or. .not. law%method%reads_slope()) cycle
            if (law%method%updates()) then
               augments = .true.
            else
               chooses = .true.
            end if
         end associate
      end do
   end subroutine chooses_slope

   !> Sticking points give way by what the deck leaves open.
   elemental logical function chooses_elastic_slip(way)
      type(interaction_type), intent(in) :: way

      chooses_elastic_slip = .not. way%method%is_exact() .and. has_friction(way%friction) &
         & .and. .not. (way%friction%exact_stick .or. way%friction%elastic_slip > 0.0_wp &
         & .or. way%friction%slip_tolerance > 0.0_wp .or. way%friction%stick_slope > 0.0_wp)
   end function chooses_elastic_slip

   !> The linear path is to solve once more, by the slopes that the trial now has.
   logical function wants_other_slope(self, scene, model) result(again)
      type(raising_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical :: chooses, augments

      again = .false.
      call chooses_slope(model, chooses, augments)
      if (.not. (chooses .or. augments)) return
      associate (state => scene%trial%contact)
         if (augments .and. scene%answer%outcome == outcome%not_augmented &
            & .and. state%raised < most_raises) then
            state%stiffer = unsettled*state%stiffer
            state%raised = state%raised + 1
            self%before = 0.0_wp
            again = .true.
            return
         end if
         if (chooses) call choose_other(self, state, scene%answer%outcome == outcome%solved, &
            & scene%answer%softness, model%target_error, again)
      end associate
      if (.not. again) call report_raised(self, scene, model)
   end function wants_other_slope

   !> Raise the factor if the error asks for it; go back where that did not help.
   pure subroutine choose_other(self, state, solved, error, promised, again)
      type(raising_type), intent(inout) :: self
      type(contact_state_type), intent(inout) :: state
      logical, intent(in) :: solved
      real(wp), intent(in) :: error            !! estimated, relative
      real(wp), intent(in) :: promised         !! relative
      logical, intent(out) :: again
      real(wp) :: more

      again = .false.
      if (solved) then
         if (.not. self%first > 0.0_wp) self%first = error
         state%softness = error
         if (.not. error > promised .or. state%raised >= most_raises) return
      end if
      if (self%before > 0.0_wp .and. .not. (solved .and. error <= no_better*self%error)) then
         state%stiffer = self%before
         state%raised = most_raises
         self%before = 0.0_wp
         again = .true.
      else if (solved) then
         ! The error of a mode is 1/(1 + slope*compliance).
         more = (1.0_wp/(margin*promised) - 1.0_wp)*error/max(1.0_wp - error, promised)
         self%before = state%stiffer
         self%error = error
         state%stiffer = state%stiffer*min(most_at_once, max(least_at_once, more))
         state%raised = state%raised + 1
         again = .true.
      end if
   end subroutine choose_other

   !> Say once that the slopes are other than was said.
   subroutine report_raised(self, scene, model)
      type(raising_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      if (.not. self%before > 0.0_wp) return
      do i = 1, scene%log%n
         if (scene%log%item(i)%id == 'N0329') return
      end do
      call scene%log%say(severity%note, 'N0329', &
         & 'slopes of contact that were chosen are raised '// &
         & to_text(scene%trial%contact%stiffer, 3)// &
         & ' times: confined or layered bodies give way less than a facet, and pressures '// &
         & 'would be off by '//to_text(self%first, 2)// &
         & ' of them', model%step(scene%step)%at)
   end subroutine report_raised
end module lopin_raise_penalty
