!> What a scene needs and no more: the path, the method of each pair, and the line that says why.
module lopin_plan
   use lopin_text, only : to_text
   use lopin_error, only : error_type, error_code, raise
   use lopin_model, only : model_type
   implicit none
   private
   public :: plan_type, new_plan, plan_line, path_of

   type :: paths
      integer :: condensed = 1, newton = 2
   end type paths
   type(paths), parameter :: path_of = paths()

   type :: plan_type
      integer :: path = 1
      logical :: by_user = .false.
      character(len=:), allocatable :: reason
   end type plan_type

contains

   subroutine new_plan(self, model, error)
      type(plan_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      self%reason = 'linear elastic, small strain'
      if (size(model%pair) == 0) then
         self%reason = self%reason//', no contact: one linear solve a load'
      else
         self%reason = self%reason// &
            & ', small sliding, no friction: contact is solved exactly on the '// &
            & 'condensed contact equations'
      end if
      select case (model%path)
      case ('AUTO', 'CONDENSED')
         self%path = path_of%condensed
      case ('NEWTON')
         self%path = path_of%newton
         self%reason = 'PATH=NEWTON asks for the whole system, factorised again at every '// &
            & 'change of contact'
      case default
         call raise(error, error_code%deck, 'E0106', "PATH="//model%path//' is not a path', &
            & help='paths are AUTO, CONDENSED and NEWTON')
         return
      end select
      self%by_user = model%path /= 'AUTO'
   end subroutine new_plan

   !> One line: what was chosen, and why.
   function plan_line(self, solver, solver_reason, equations, retained, rows, nq) result(line)
      type(plan_type), intent(in) :: self
      character(len=*), intent(in) :: solver, solver_reason
      integer, intent(in) :: equations, retained, rows, nq
      character(len=:), allocatable :: line

      line = 'path '
      if (self%path == path_of%condensed) line = line//'condensed'
      if (self%path == path_of%newton) line = line//'newton'
      line = line//', solver '//solver//' ('//solver_reason//'): '//to_text(equations)//' equations'
      if (rows > 0) line = line//', '//to_text(rows)//' contact rows on '//to_text(retained)// &
         & ' of them'
      if (nq > 0) line = line//', '//to_text(nq)//' motions held only by contact'
      line = line//'; because '//self%reason
   end function plan_line
end module lopin_plan
