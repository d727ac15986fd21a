!> From a method's number or name to the method.
module lopin_enforcement_factory
   use lopin_enforcement, only : enforcement_type
   use lopin_enforcement_lagrange, only : lagrange_type
   use lopin_enforcement_penalty, only : penalty_type
   use lopin_enforcement_perturbed, only : perturbed_type
   use lopin_enforcement_augmented, only : augmented_type
   implicit none
   private
   public :: new_enforcement, method_names, enforcement_holder_type

   !> In the order of the numbers that the model uses.
   character(len=*), parameter :: method_names(4) = [character(len=9) :: &
      & 'lagrange', 'penalty', 'perturbed', 'augmented']

   type :: enforcement_holder_type
      class(enforcement_type), allocatable :: method
   end type enforcement_holder_type

contains

   !> Unallocated for a number that is not a method.
   subroutine new_enforcement(self, number)
      class(enforcement_type), allocatable, intent(out) :: self
      integer, intent(in) :: number

      select case (number)
      case (1)
         allocate (lagrange_type :: self)
      case (2)
         allocate (penalty_type :: self)
      case (3)
         allocate (perturbed_type :: self)
      case (4)
         allocate (augmented_type :: self)
      end select
   end subroutine new_enforcement
end module lopin_enforcement_factory
