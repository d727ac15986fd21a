!> Times of the linear solvers on elastic blocks, one thread, as a Markdown table (docs/solvers.md).
program bench_solvers
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_ordering, only : profile_cost, profile_order, row_starts
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_solver_factory, only : choose_solver, new_solver, solver_names
   use lopin_blas_threads, only : set_blas_threads
   use matrices, only : elastic_block
   implicit none

   !> Longest time worth waiting for, in operations at about 5 GFlop/s.
   real(wp), parameter :: patience = 4.0e10_wp
   character(len=20) :: only
   logical :: is_set

   is_set = set_blas_threads(1)
   call get_command_argument(1, only)
   print '(a)', &
      & '| body | equations | last | half band | solver | analyse | factorise | solve '// &
      & '| entries | chosen |'
   print '(a)', '| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |'
   call measure('square', [10, 10], .false.)
   call measure('square', [22, 22], .false.)
   call measure('square', [35, 35], .false.)
   call measure('square', [50, 50], .false.)
   call measure('square', [100, 100], .false.)
   call measure('square', [160, 160], .false.)
   call measure('strip', [200, 4], .false.)
   call measure('strip', [800, 6], .false.)
   call measure('strip', [1000, 20], .false.)
   call measure('strip', [500, 40], .false.)
   call measure('cube', [4, 4, 4], .false.)
   call measure('cube', [6, 6, 6], .false.)
   call measure('cube', [8, 8, 8], .false.)
   call measure('cube', [10, 10, 10], .false.)
   call measure('cube', [14, 14, 14], .false.)
   call measure('cube', [18, 18, 18], .false.)
   call measure('column', [100, 4, 4], .false.)
   call measure('column', [300, 4, 4], .false.)
   call measure('column', [100, 8, 8], .false.)
   call measure('plate', [40, 40, 2], .false.)
   call measure('square', [50, 50], .true.)
   call measure('strip', [200, 4], .true.)
   call measure('strip', [800, 6], .true.)
   call measure('cube', [10, 10, 10], .true.)
   call measure('cube', [18, 18, 18], .true.)
   call measure('plate', [40, 40, 2], .true.)

contains

   subroutine measure(body, cells, last_too)
      character(len=*), intent(in) :: body
      integer, intent(in) :: cells(:)
      logical, intent(in) :: last_too     !! keep the equations of the top face last
      type(csc_type) :: a
      integer, allocatable :: top(:), order(:)
      character(len=:), allocatable :: chosen, reason
      character(len=40) :: title
      real(wp) :: cost
      integer :: s
      logical :: valid

      write (title, '(a,*(1x,i0))') body, cells
      if (only /= '' .and. index(title, trim(only)) == 0) return
      call elastic_block(cells, .true., a, top)
      if (.not. last_too) top = top(:0)
      call profile_order(a, top, order, valid)
      cost = profile_cost(row_starts(a, order))
      call choose_solver(a, matrix_class%positive_definite, top, chosen, reason)
      do s = 1, size(solver_names)
         if (solver_names(s) == 'skyline' .and. cost > patience) cycle
         if (solver_names(s) == 'dense' .and. a%n > 1200) cycle
         if (solver_names(s) == 'umfpack' .and. a%n > 25000) cycle
         call measure_solver(trim(title), trim(solver_names(s)), a, top, sqrt(cost/a%n), &
            & chosen == solver_names(s))
      end do
   end subroutine measure

   subroutine measure_solver(title, name, a, last, band, is_chosen)
      character(len=*), intent(in) :: title, name
      type(csc_type), intent(in) :: a
      integer, intent(in) :: last(:)
      real(wp), intent(in) :: band
      logical, intent(in) :: is_chosen
      class(linear_solver_type), allocatable :: solver
      type(error_type), allocatable :: error
      real(wp) :: t(4), best(3), start, again, x(a%n, 1)
      integer :: bad, round

      call new_solver(solver, name, error)
      if (size(last) > 0 .and. .not. solver%can_condense(matrix_class%positive_definite)) return
      best = huge(1.0_wp)
      call cpu_time(start)
      do round = 1, 200
         x = 1.0_wp
         call cpu_time(t(1))
         call solver%analyse(a, matrix_class%positive_definite, last, error)
         call cpu_time(t(2))
         if (.not. allocated(error)) call solver%factorise(a, bad, error)
         if (.not. allocated(error)) then   ! again, in memory that is now there: the usual case
            call cpu_time(again)
            call solver%factorise(a, bad, error)
         end if
         call cpu_time(t(3))
         if (allocated(error)) then
            print '(a)', error%text()
            return
         end if
         call solver%solve(x)
         call cpu_time(t(4))
         best = min(best, [t(2) - t(1), t(3) - again, t(4) - t(3)])
         if (t(4) - start > 0.3_wp) exit
      end do
      print '("| ",a," | ",i0," | ",i0," | ",i0," | ",a," | ",3(f0.3," | "),es8.1," | ",a," |")', &
         & title, a%n, &
         & size(last), nint(band), name, 1000.0_wp*best, real(solver%factor_entries, wp), &
         & trim(merge('*', ' ', is_chosen))
   end subroutine measure_solver
end program bench_solvers
