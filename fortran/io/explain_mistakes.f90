!> Explanations: what a deck says twice, for nothing, or in two systems of units.
module lopin_explain_mistakes
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: mistake_explanations

contains

   subroutine mistake_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0404', 'a dof has two values in one step', &
         & 'Two data lines of *BOUNDARY in the same step prescribe a dof, often through node '// &
         & 'sets that overlap, and with different values. The last line counts. Equal values '// &
         & 'and other values in a later step are not warned of.', &
         & 'remove one of the lines, or take the node out of one of the sets.')
      call add_explanation(list, 'W0402', 'a number of a material that does not fit', &
         & 'Ratios need no unit: solids yield at strains between 1e-5 and a tenth, their flow '// &
         & 'curves rise more slowly than they are stiff, heat strains them by per cents and '// &
         & 'pressures lie below their modulus. What is far off is most often a number in '// &
         & 'another unit: GPa beside MPa, per cent beside strain.', &
         & 'write all numbers in one system of units; if the number is meant, go on.')
      call add_explanation(list, 'W0303', 'a tool or an interaction in no pair', &
         & 'Contact acts between the surfaces that *CONTACT PAIR or *TIE names, and nowhere '// &
         & 'else: a tool in no pair is passed through, and the friction of an interaction in '// &
         & 'no pair acts nowhere.', &
         & 'name the tool as the master of a *CONTACT PAIR, or remove it.')
      call add_explanation(list, 'N0303', 'a material or an amplitude that is not used', &
         & 'No section names the material, or no load and no motion the amplitude. Programs '// &
         & 'that write decks do so; by hand it is a forgotten word.', '')
      call add_explanation(list, 'W0305', 'an option of contact that does nothing', &
         & 'The option is known, but has nothing to act on where it stands: SMOOTH on a flat '// &
         & 'master, a tolerance of a method that no pair has, a clearance of a tied pair.', &
         & 'leave it out, or look whether another pair was meant.')
   end subroutine mistake_explanations
end module lopin_explain_mistakes
