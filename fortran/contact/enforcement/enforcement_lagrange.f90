!> Lagrange multipliers (lecture J.2): the force is an unknown, the gap of a closed point is zero.
module lopin_enforcement_lagrange
   use lopin_enforcement, only : enforcement_type
   implicit none
   private
   public :: lagrange_type

   type, extends(enforcement_type) :: lagrange_type
   contains
      procedure :: word
      procedure :: solves_for_multiplier
   end type lagrange_type

contains

   function word(self)
      class(lagrange_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'lagrange'
      end associate
   end function word

   pure logical function solves_for_multiplier(self)
      class(lagrange_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .true.
      end associate
   end function solves_for_multiplier
end module lopin_enforcement_lagrange
