!> The enforcement of each pair, as the deck chose it.
module lopin_methods
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, method_of, overclosure_of
   use lopin_enforcement, only : enforcement_type
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_enforcement_law, only : law_type, new_exponential, new_tabular
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
               if (has_law(model, pair)) then
                  call new_law(p%group(pair)%method, &
                     & law%overclosure == overclosure_of%exponential, law%table)
                  cycle
               end if
               call new_enforcement(p%group(pair)%method, law%method)
               if (law%method /= method_of%augmented) cycle
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
         if (has_law(model, pair)) cycle
         associate (law => model%interaction(model%pair(pair)%interaction))
            if (law%method == method_of%penalty .or. law%method == method_of%perturbed) &
               & obeys = obeys .and. law%slope > 0.0_wp
         end associate
      end do
   end function obeys_deck

   !> The pair presses by a pressure-overclosure law that is not linear.
   pure logical function has_law(model, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      associate (law => model%interaction(model%pair(pair)%interaction)%overclosure)
         has_law = law == overclosure_of%exponential .or. law == overclosure_of%tabular
      end associate
   end function has_law

   subroutine new_law(method, exponential, table)
      class(enforcement_type), allocatable, intent(out) :: method
      logical, intent(in) :: exponential
      real(wp), intent(in) :: table(:, :)
      type(law_type) :: law

      if (exponential) then
         call new_exponential(law, table(1, 1), table(2, 1))
      else
         call new_tabular(law, table(1, :), table(2, :))
      end if
      allocate (method, source=law)
   end subroutine new_law
end module lopin_methods
