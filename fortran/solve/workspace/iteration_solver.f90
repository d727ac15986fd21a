!> The solver whose factor, or whose levels, precondition Newton's iterations: chosen once.
module lopin_iteration_solver
   use lopin_kinds, only : ik
   use lopin_error, only : error_type
   use lopin_text, only : lower
   use lopin_csc, only : csc_type
   use lopin_linear_solver, only : linear_solver_type, vertices_type, matrix_class
   use lopin_solver_factory, only : new_solver, choose_preconditioner, prefers_levels
   implicit none
   private
   public :: analyse_for_iterations

contains

   !> Order a positive definite matrix, by the solver at hand or by one that is chosen. What a
   !> factor costs is known once it is analysed: multigrid may cost less.
   subroutine analyse_for_iterations(solver, reason, wish, matrix, vertices, error)
      class(linear_solver_type), allocatable, intent(inout) :: solver
      character(len=:), allocatable, intent(inout) :: reason   !! why this solver
      character(len=*), intent(in) :: wish                     !! AUTO or a solver's word
      type(csc_type), intent(in) :: matrix
      type(vertices_type), intent(in) :: vertices              !! of its equations, if known
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: name
      logical :: may_change

      may_change = .false.
      if (.not. allocated(solver)) then
         name = lower(wish)
         may_change = name == 'auto' .and. allocated(vertices%of)
         reason = 'as asked'
         if (name == 'auto') call choose_preconditioner(matrix, name, reason)
         call new_solver(solver, name, error)
         if (allocated(error)) return
      end if
      call order()
      if (allocated(error) .or. .not. may_change) return
      if (.not. prefers_levels(solver, size(matrix%row, kind=ik))) return
      call new_solver(solver, 'multigrid', error)
      reason = 'a factor would take too many operations'
      if (.not. allocated(error)) call order()

   contains

      subroutine order()
         solver%vertices = vertices
         call solver%analyse(matrix, matrix_class%positive_definite, [integer ::], error)
      end subroutine order
   end subroutine analyse_for_iterations
end module lopin_iteration_solver
