!> The friction of a pair in each step, as the deck changes it.
module lopin_pair_friction
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_friction, only : friction_type, has_friction, law_of
   use lopin_contact_points, only : pair_is_tied
   implicit none
   private
   public :: friction_in_step, pair_slides_with_friction

contains

   !> The friction of an interaction in a step, after the changes of that and all earlier steps.
   pure function friction_in_step(model, interaction, step) result(friction)
      type(model_type), intent(in) :: model
      integer, intent(in) :: interaction, step
      type(friction_type) :: friction
      integer :: i, k

      friction = model%interaction(interaction)%friction
      do i = 1, step
         if (.not. allocated(model%step(i)%friction_change)) cycle
         associate (change => model%step(i)%friction_change)
            do k = 1, size(change)
               if (change(k)%interaction == interaction) friction = change(k)%friction
            end do
         end associate
      end do
   end function friction_in_step

   !> The pair has friction in some step: its points keep tangential rows in all of them.
   pure logical function pair_slides_with_friction(model, pair) result(slides)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      integer :: step

      slides = .false.
      if (pair_is_tied(model, model%pair(pair))) return
      do step = 1, size(model%step)
         slides = slides .or. resists(friction_in_step(model, model%pair(pair)%interaction, step))
      end do
   end function pair_slides_with_friction

   !> mu = 0 is no friction at all: the frictionless kernel solves it.
   pure logical function resists(friction)
      type(friction_type), intent(in) :: friction

      resists = has_friction(friction)
      if (friction%rough .or. friction%law /= law_of%coulomb) return
      resists = friction%mu > 0.0_wp .or. (friction%decay > 0.0_wp &
         & .and. friction%mu_static > 0.0_wp)
   end function resists
end module lopin_pair_friction
