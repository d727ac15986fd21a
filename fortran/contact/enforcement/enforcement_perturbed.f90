!> Perturbed Lagrangian (lecture J.3, with 1/alpha as in its matrix): the force is an unknown and
!> the closed gap is -force/alpha. Condensing the force gives the penalty system; keeping it keeps
!> the digits.
module lopin_enforcement_perturbed
   use lopin_kinds, only : wp
   use lopin_enforcement, only : enforcement_type
   implicit none
   private
   public :: perturbed_type

   type, extends(enforcement_type) :: perturbed_type
   contains
      procedure :: word
      procedure :: solves_for_multiplier
      procedure :: penetration
      procedure :: stored
   end type perturbed_type

contains

   function word(self)
      class(perturbed_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'perturbed'
      end associate
   end function word

   pure logical function solves_for_multiplier(self)
      class(perturbed_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .true.
      end associate
   end function solves_for_multiplier

   elemental real(wp) function penetration(self, force, alpha)
      class(perturbed_type), intent(in) :: self
      real(wp), intent(in) :: force, alpha
      associate (unused => self)
         penetration = force/alpha
      end associate
   end function penetration

   elemental real(wp) function stored(self, gap, force, alpha)
      class(perturbed_type), intent(in) :: self
      real(wp), intent(in) :: gap, force, alpha
      associate (unused => self, also => gap)
         stored = 0.5_wp*force**2/alpha
      end associate
   end function stored
end module lopin_enforcement_perturbed
