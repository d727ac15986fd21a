!> From a word to a linear solver, and which word to take when the user gives none.
module lopin_solver_factory
   use lopin_kinds, only : wp, ik
   use lopin_error, only : error_type, error_code, raise
   use lopin_csc, only : csc_type
   use lopin_ordering, only : profile_cost, profile_order, row_starts
   use lopin_linear_solver, only : linear_solver_type, matrix_class, class_name
   use lopin_solver_skyline, only : solver_skyline_type
   use lopin_solver_cholmod, only : solver_cholmod_type
   use lopin_solver_mixed, only : solver_mixed_type
   use lopin_solver_multigrid, only : solver_multigrid_type, is_present
   use lopin_solver_umfpack, only : solver_umfpack_type
   use lopin_solver_dense, only : solver_dense_type
   implicit none
   private
   public :: choose_solver, choose_preconditioner, general_solver, new_solver, solver_names, &
      & solver_words, may_coarsen, may_need_levels, prefers_levels

   !> All direct solvers; where several can do it, the first one that accepts the matrix is a fair
   !> choice. 'mixed' is 'cholmod' for iterations that mend what single precision leaves.
   character(len=7), parameter :: solver_names(4) = ['cholmod', 'skyline', 'umfpack', 'dense  ']
   !> What a user may ask for: these, and iterations by multigrid where the build has them.
   character(len=9), parameter :: solver_words(5) = [character(len=9) :: solver_names, 'multigrid']

   !> Equations of a solid from which multigrid takes the place of the one factor of a linear scene
   !> (docs/solvers.md).
   integer, parameter :: too_many = 500000
   !> Operations of a factor for each stored entry of the matrix from which multigrid takes its
   !> place in Newton's iterations: a cube of 470 000 equations. Sheets and plane meshes have far
   !> fewer.
   real(wp), parameter :: dear = 2.0e5_wp
   !> Solids of fewer equations have no factor that dear.
   integer, parameter :: few = 100000

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
      case ('mixed')
         allocate (solver_mixed_type :: solver)
      case ('skyline')
         allocate (solver_skyline_type :: solver)
      case ('umfpack')
         allocate (solver_umfpack_type :: solver)
      case ('dense')
         allocate (solver_dense_type :: solver)
      case ('multigrid')
         allocate (solver_multigrid_type :: solver)
         if (.not. is_present()) call raise(error, error_code%deck, 'E0704', &
            & 'this build of Lopin has no solver multigrid', &
            & help='leave out the solver, or build with -DLOPIN_PETSC=ON')
      case default
         known = trim(solver_words(1))
         do i = 2, size(solver_words)
            known = known//', '//trim(solver_words(i))
         end do
         call raise(error, error_code%deck, 'E0704', &
            & "no linear solver is named '"//trim(name)//"'", help='solvers: '//known)
      end select
   end subroutine new_solver

   !> The solver that is likely the fastest for one matrix, one thread.
   !>
   !> Skyline wins on small and slender bodies. Let b be the root mean square length of a row of the
   !> profile and e the stored entries an equation; measured break-even (docs/solvers.md): b = 200
   !> for plane meshes (e = 9), b = 500 for solid ones (e = 37), and one line through both is the
   !> rule. At half of that b skyline is two to seven times faster, at twice of it as much slower.
   subroutine choose_solver(a, class_of, last, name, reason)
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of                      !! matrix_class%...
      integer, intent(in) :: last(:)                       !! equations to be kept last
      character(len=:), allocatable, intent(out) :: name
      character(len=:), allocatable, intent(out) :: reason !! in words, for the log

      name = general_solver('auto')
      reason = 'the matrix is '//class_name(class_of)
      if (class_of /= matrix_class%positive_definite) return
      call choose_by_profile(a, last, [90.0_wp, 11.0_wp], name, reason)
   end subroutine choose_solver

   !> The same for a positive definite matrix whose factor iterations use and mend: a factor of
   !> single precision, used ten to twenty times, wins from b = 110 (e = 9) and b = 180 (e = 37) on.
   subroutine choose_preconditioner(a, name, reason)
      type(csc_type), intent(in) :: a
      character(len=:), allocatable, intent(out) :: name
      character(len=:), allocatable, intent(out) :: reason   !! in words, for the log

      call choose_by_profile(a, [integer ::], [85.0_wp, 2.5_wp], name, reason)
      if (name == 'skyline') return
      name = 'mixed'
   end subroutine choose_preconditioner

   !> Multigrid takes the place of a factor: asked for, or present and the solid is large.
   pure logical function may_coarsen(wish, n)
      character(len=*), intent(in) :: wish     !! AUTO or a solver's word, upper case
      integer, intent(in) :: n                 !! equations

      may_coarsen = wish == 'MULTIGRID' .or. (may_need_levels(wish, n) .and. n >= too_many)
   end function may_coarsen

   !> Iterations of Newton may come to want levels.
   pure logical function may_need_levels(wish, n)
      character(len=*), intent(in) :: wish     !! AUTO or a solver's word, upper case
      integer, intent(in) :: n                 !! equations

      may_need_levels = wish == 'MULTIGRID' .or. (wish == 'AUTO' .and. n >= few .and. is_present())
   end function may_need_levels

   !> Levels cost less than the factor that has been analysed.
   pure logical function prefers_levels(solver, entries)
      class(linear_solver_type), intent(in) :: solver
      integer(ik), intent(in) :: entries       !! stored, of the matrix

      prefers_levels = is_present() .and. solver%flops > dear*real(entries, wp)
   end function prefers_levels

   !> Skyline where the mean row of the profile is shorter than line(1) + line(2) e.
   subroutine choose_by_profile(a, last, line, name, reason)
      type(csc_type), intent(in) :: a
      integer, intent(in) :: last(:)
      real(wp), intent(in) :: line(2)
      character(len=:), allocatable, intent(out) :: name, reason
      integer, allocatable :: order(:)
      real(wp) :: length, limit
      character(len=60) :: numbers
      logical :: valid

      name = 'cholmod'
      reason = 'the matrix is empty'
      if (a%n == 0) return
      call profile_order(a, last, order, valid)
      reason = 'the equations to be kept last are not valid'
      if (.not. valid) return
      length = sqrt(profile_cost(row_starts(a, order))/a%n)
      limit = line(1) + line(2)*size(a%row)/a%n
      if (length < limit) name = 'skyline'
      write (numbers, '("mean half band ",i0,", break-even at ",i0)') nint(length), nint(limit)
      reason = trim(numbers)
   end subroutine choose_by_profile

   !> The solver of matrices that are not positive definite.
   pure function general_solver(wish) result(name)
      character(len=*), intent(in) :: wish       !! what was asked for, lower case
      character(len=:), allocatable :: name

      name = 'umfpack'
      if (wish == 'dense') name = 'dense'
   end function general_solver
end module lopin_solver_factory
