!> Augmented Lagrangian (seed J.4, Uzawa's update): the penalty system with a frozen multiplier,
!> which takes over the spring's force after each solve until nothing moves.
module lopin_enforcement_augmented
   use lopin_kinds, only : wp
   use lopin_enforcement, only : enforcement_type
   implicit none
   private
   public :: augmented_type

   type, extends(enforcement_type) :: augmented_type
   contains
      procedure :: word
      procedure :: solves_for_multiplier
      procedure :: update
   end type augmented_type

contains

   function word(self)
      class(augmented_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'augmented'
      end associate
   end function word

   pure logical function solves_for_multiplier(self)
      class(augmented_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .false.
      end associate
   end function solves_for_multiplier

   elemental subroutine update(self, force, multiplier, change)
      class(augmented_type), intent(in) :: self
      real(wp), intent(in) :: force
      real(wp), intent(inout) :: multiplier
      real(wp), intent(out) :: change
      associate (unused => self)
         change = force - multiplier
         multiplier = force
      end associate
   end subroutine update
end module lopin_enforcement_augmented
