!> From a method's name to the method. This is the only list of them.
module lopin_enforcement_factory
   use lopin_enforcement, only : enforcement_type
   use lopin_enforcement_lagrange, only : lagrange_type
   use lopin_enforcement_penalty, only : penalty_type
   use lopin_enforcement_perturbed, only : perturbed_type
   use lopin_enforcement_augmented, only : augmented_type
   implicit none
   private
   public :: new_enforcement, method_names, method_parameters, enforcement_holder_type

   character(len=*), parameter :: method_names(4) = [character(len=9) :: &
      & 'lagrange', 'penalty', 'perturbed', 'augmented']

   !> The parameter of *SURFACE BEHAVIOR that asks for each.
   character(len=*), parameter :: method_parameters(4) = [character(len=18) :: 'DIRECT', &
      & 'PENALTY', 'PERTURBED LAGRANGE', 'AUGMENTED LAGRANGE']

   type :: enforcement_holder_type
      class(enforcement_type), allocatable :: method
   end type enforcement_holder_type

contains

   !> Unallocated for a name that is not a method's.
   subroutine new_enforcement(self, name)
      class(enforcement_type), allocatable, intent(out) :: self
      character(len=*), intent(in) :: name

      select case (name)
      case ('lagrange')
         allocate (lagrange_type :: self)
      case ('penalty')
         allocate (penalty_type :: self)
      case ('perturbed')
         allocate (perturbed_type :: self)
      case ('augmented')
         allocate (augmented_type :: self)
      end select
   end subroutine new_enforcement
end module lopin_enforcement_factory
