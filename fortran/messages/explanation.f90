!> One explained diagnostic code.
module lopin_explanation
   implicit none
   private
   public :: explanation_type, add_explanation

   type :: explanation_type
      character(len=:), allocatable :: id, title
      character(len=:), allocatable :: why    !! what happened and why it matters
      character(len=:), allocatable :: cure   !! what to do
   end type explanation_type

contains

   subroutine add_explanation(list, id, title, why, cure)
      type(explanation_type), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: id, title, why, cure
      type(explanation_type) :: new

      new%id = id
      new%title = title
      new%why = why
      new%cure = cure
      list = [list, new]
   end subroutine add_explanation
end module lopin_explanation
