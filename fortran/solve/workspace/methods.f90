!> The enforcement of each pair, as the deck chose it, on the linear path.
module lopin_methods
   use lopin_kinds, only : wp
   use lopin_enforcement, only : copy_method
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: choose_methods, has_law, obeys_deck

contains

   subroutine choose_methods(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, from, to

      associate (p => scene%problem)
         if (allocated(p%group)) deallocate (p%group)
         allocate (p%group(p%ngroup))
         p%max_augmentations = spread(0, 1, p%ngroup)
         p%penetration = spread(0.0_wp, 1, p%ngroup)
         do pair = 1, p%ngroup
            associate (law => model%interaction(model%pair(pair)%interaction), &
               & control => model%pair(pair)%control)
               call copy_method(law%method, p%group(pair)%method)
               if (.not. law%method%updates()) cycle
               p%max_augmentations(pair) = control%max_augmentations
               p%penetration(pair) = control%absolute_penetration
               from = scene%points%first(pair)
               to = scene%points%first(pair + 1) - 1
               if (control%relative_penetration > 0.0_wp .and. to >= from) p%penetration(pair) = &
                  & max(p%penetration(pair), &
                  & control%relative_penetration*minval(scene%points%size(from:to)))
            end associate
         end do
      end associate
   end subroutine choose_methods

   !> Contact gives way nowhere but by slopes and laws of the deck.
   pure logical function obeys_deck(model) result(obeys)
      type(model_type), intent(in) :: model
      integer :: pair

      obeys = .true.
      do pair = 1, size(model%pair)
         associate (law => model%interaction(model%pair(pair)%interaction))
            if (law%method%reads_slope() .and. .not. law%method%is_exact()) &
               & obeys = obeys .and. law%slope > 0.0_wp
         end associate
      end do
   end function obeys_deck

   !> The pair presses by a pressure-overclosure law that is not linear.
   pure logical function has_law(model, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      associate (law => model%interaction(model%pair(pair)%interaction))
         has_law = .not. law%method%piecewise_linear()
      end associate
   end function has_law
end module lopin_methods
