!> Penalty (seed J.1): a spring of stiffness alpha where the point penetrates, K + alpha G G^T.
module lopin_enforcement_penalty
   use lopin_enforcement, only : enforcement_type
   implicit none
   private
   public :: penalty_type

   type, extends(enforcement_type) :: penalty_type
   contains
      procedure :: word
      procedure :: solves_for_multiplier
   end type penalty_type

contains

   function word(self)
      class(penalty_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'penalty'
      end associate
   end function word

   pure logical function solves_for_multiplier(self)
      class(penalty_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .false.
      end associate
   end function solves_for_multiplier
end module lopin_enforcement_penalty
