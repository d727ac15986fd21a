!> From a word to a linear solver, and which word to take when the user gives none.
module lopin_solver_factory
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_csc, only : csc_type
   use lopin_linear_solver, only : linear_solver_type
   use lopin_solver_skyline, only : solver_skyline_type
   use lopin_solver_cholmod, only : solver_cholmod_type
   use lopin_solver_umfpack, only : solver_umfpack_type
   use lopin_solver_dense, only : solver_dense_type
   implicit none
   private
   public :: new_solver, solver_names

   !> All solvers; where several can do it, the first one that accepts the matrix is a fair choice.
   character(len=7), parameter :: solver_names(4) = ['cholmod', 'skyline', 'umfpack', 'dense  ']

contains

   !> A solver by its name.
   subroutine new_solver(solver, name, error)
      class(linear_solver_type), allocatable, intent(out) :: solver
      character(len=*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: known
      integer :: i

      select case (name)
      case ('cholmod')
         allocate (solver_cholmod_type :: solver)
      case ('skyline')
         allocate (solver_skyline_type :: solver)
      case ('umfpack')
         allocate (solver_umfpack_type :: solver)
      case ('dense')
         allocate (solver_dense_type :: solver)
      case default
         known = trim(solver_names(1))
         do i = 2, size(solver_names)
            known = known//', '//trim(solver_names(i))
         end do
         call raise(error, error_code%deck, 'E0704', "no linear solver is named '"//trim(name)//"'", &
            & help='solvers: '//known)
      end select
   end subroutine new_solver
end module lopin_solver_factory
