!> Sparse LU factorisation by UMFPACK, for matrices that are not positive definite.
module lopin_solver_umfpack
   use, intrinsic :: iso_c_binding, only : c_ptr, c_null_ptr, c_int, c_double, c_associated
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use lopin_kinds, only : wp, lk
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_linear_solver, only : linear_solver_type, pivot_tolerance, &
      & raise_singular, raise_refused, raise_no_memory, raise_failed, refuse_unknown_class
   implicit none
   private
   public :: solver_umfpack_type

   !> As for CHOLMOD: operations per entry above which nested dissection is tried.
   real(wp), parameter :: worth_dissection = 3000.0_wp

   ! Places in umfpack.h's Control and Info, 1-based, and values of them.
   integer, parameter :: control_print = 1, control_strategy = 6, control_ordering = 11
   integer, parameter :: info_strategy = 19, info_symmetric_flops = 38
   integer, parameter :: info_flops_estimate = 23, info_flops = 43, info_lower = 44, info_upper = 45
   integer, parameter :: strategy_symmetric = 3, ordering_metis = 3
   integer, parameter :: umfpack_ok = 0, umfpack_singular = 1, umfpack_no_memory = -1

   type, extends(linear_solver_type) :: solver_umfpack_type
      private
      type(csc_type) :: full                !! both triangles
      integer, allocatable :: source(:)     !! (nnz of full) place of each value in the given matrix
      type(c_ptr) :: symbolic = c_null_ptr
      type(c_ptr) :: numeric = c_null_ptr
      real(c_double) :: control(20) = 0.0_c_double
   contains
      procedure :: name => umfpack_name
      procedure :: accepts
      procedure :: can_condense
      procedure :: orders_by_values
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      procedure, private :: clear
      final :: destroy
   end type solver_umfpack_type

   interface
      subroutine umfpack_di_defaults(control) bind(c)
         import :: c_double
         real(c_double), intent(out) :: control(*)
      end subroutine umfpack_di_defaults
      integer(c_int) function umfpack_di_symbolic(rows, columns, p, i, x, symbolic, control, &
         & info) bind(c)
         import :: c_int, c_double, c_ptr
         integer(c_int), value :: rows, columns
         integer(c_int), intent(in) :: p(*), i(*)
         real(c_double), intent(in), optional :: x(*)
         real(c_double), intent(in) :: control(*)
         type(c_ptr), intent(out) :: symbolic
         real(c_double), intent(inout) :: info(*)
      end function umfpack_di_symbolic
      integer(c_int) function umfpack_di_numeric(p, i, x, symbolic, numeric, control, info) bind(c)
         import :: c_int, c_double, c_ptr
         integer(c_int), intent(in) :: p(*), i(*)
         real(c_double), intent(in) :: x(*), control(*)
         type(c_ptr), value :: symbolic
         type(c_ptr), intent(out) :: numeric
         real(c_double), intent(inout) :: info(*)
      end function umfpack_di_numeric
      integer(c_int) function umfpack_di_solve(system, p, i, x, solution, b, numeric, control, &
         & info) bind(c)
         import :: c_int, c_double, c_ptr
         integer(c_int), value :: system
         integer(c_int), intent(in) :: p(*), i(*)
         real(c_double), intent(in) :: x(*), b(*), control(*)
         real(c_double), intent(out) :: solution(*)
         type(c_ptr), value :: numeric
         real(c_double), intent(inout) :: info(*)
      end function umfpack_di_solve
      integer(c_int) function umfpack_di_get_numeric(lp, lj, lx, up, ui, ux, p, q, d, reciprocal, &
         & scale, numeric) bind(c)
         import :: c_int, c_double, c_ptr
         type(c_ptr), value :: lp, lj, lx, up, ui, ux, p
         integer(c_int), intent(out) :: q(*), reciprocal
         real(c_double), intent(out) :: d(*), scale(*)
         type(c_ptr), value :: numeric
      end function umfpack_di_get_numeric
      subroutine umfpack_di_free_symbolic(symbolic) bind(c)
         import :: c_ptr
         type(c_ptr), intent(inout) :: symbolic
      end subroutine umfpack_di_free_symbolic
      subroutine umfpack_di_free_numeric(numeric) bind(c)
         import :: c_ptr
         type(c_ptr), intent(inout) :: numeric
      end subroutine umfpack_di_free_numeric
   end interface

contains

   function umfpack_name(self) result(name)
      class(solver_umfpack_type), intent(in) :: self
      character(len=:), allocatable :: name
      associate (unused => self)
         name = 'umfpack'
      end associate
   end function umfpack_name

   function accepts(self, class_of) result(reason)
      class(solver_umfpack_type), intent(in) :: self
      integer, intent(in) :: class_of
      character(len=:), allocatable :: reason

      reason = refuse_unknown_class(class_of)
      if (reason /= '') reason = self%name()//' '//reason
   end function accepts

   pure logical function can_condense(self, class_of)
      class(solver_umfpack_type), intent(in) :: self
      integer, intent(in) :: class_of
      associate (unused => self, also => class_of)
         can_condense = .false.   ! L and U are not transposes
      end associate
   end function can_condense

   pure logical function orders_by_values(self)
      class(solver_umfpack_type), intent(in) :: self
      associate (unused => self)
         orders_by_values = .true.
      end associate
   end function orders_by_values

   subroutine analyse(self, a, class_of, last, error)
      class(solver_umfpack_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error
      type(csc_type) :: full
      real(c_double) :: info(90), control(20)
      type(c_ptr) :: rival
      real(wp) :: flops, expected
      integer :: status

      call self%begin_analysis(a, class_of, last, .false., error)
      if (allocated(error)) return
      if (size(last) > 0) then
         call raise_refused(error, self%name(), &
            & 'cannot keep equations last for condensation; use skyline, cholmod or dense')
         return
      end if
      call self%clear()
      call a%to_general(full, self%source)
      self%full = full
      if (self%n == 0) return
      call umfpack_di_defaults(self%control)
      self%control(control_print) = 0.0_c_double
      call order_by(self, self%control, self%symbolic, info, status)
      call explain(status, self%n, error)
      if (allocated(error)) return
      flops = info(info_flops_estimate)
      ! The estimate allows for every exchange; while the diagonal serves, the symmetric count
      ! is nearer.
      expected = flops
      if (nint(info(info_strategy)) == strategy_symmetric) &
         & expected = 2.0_wp*info(info_symmetric_flops)
      if (expected <= worth_dissection*size(self%full%row)) return
      control = self%control
      control(control_strategy) = strategy_symmetric
      control(control_ordering) = ordering_metis
      call order_by(self, control, rival, info, status)
      if (status /= umfpack_ok) return
      if (info(info_flops_estimate) < flops) then
         call umfpack_di_free_symbolic(self%symbolic)
         self%symbolic = rival
         self%control = control
      else
         call umfpack_di_free_symbolic(rival)
      end if
   end subroutine analyse

   !> UMFPACK's own analysis; it looks at the values too when there are any.
   subroutine order_by(self, control, symbolic, info, status)
      class(solver_umfpack_type), intent(in) :: self
      real(c_double), intent(in) :: control(:)
      type(c_ptr), intent(out) :: symbolic
      real(c_double), intent(inout) :: info(:)
      integer, intent(out) :: status

      symbolic = c_null_ptr
      if (any(abs(self%full%value) > 0.0_wp)) then
         status = umfpack_di_symbolic(self%n, self%n, self%full%colptr, self%full%row, &
            & self%full%value, &
            & symbolic=symbolic, control=control, info=info)
      else
         status = umfpack_di_symbolic(self%n, self%n, self%full%colptr, self%full%row, &
            & symbolic=symbolic, control=control, info=info)
      end if
   end subroutine order_by

   subroutine factorise(self, a, bad, error)
      class(solver_umfpack_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      real(c_double) :: info(90)
      integer :: status

      bad = 0
      if (self%n == 0) return
      self%full%value = a%value(self%source)
      if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
      status = umfpack_di_numeric(self%full%colptr, self%full%row, self%full%value, self%symbolic, &
         & self%numeric, self%control, info)
      if (status /= umfpack_singular) call explain(status, self%n, error)
      if (allocated(error)) return
      self%flops = info(info_flops)
      self%factor_entries = int(info(info_lower) + info(info_upper), lk)
      call weakest_pivot(self, bad, self%pivot_ratio)
      if (self%pivot_ratio > pivot_tolerance(self%n)) then
         bad = 0
      else
         call raise_singular(error, self%name(), bad, self%pivot_ratio, 'singular')
      end if
   end subroutine factorise

   !> The pivot that is smallest beside the largest entry of its column, after the scaling of rows.
   subroutine weakest_pivot(self, equation, ratio)
      class(solver_umfpack_type), intent(in) :: self
      integer, intent(out) :: equation
      real(wp), intent(out) :: ratio
      integer(c_int) :: column(self%n), reciprocal
      real(c_double) :: d(self%n), scale(self%n)
      real(wp) :: largest, own
      integer :: status, k, j, i

      status = umfpack_di_get_numeric(c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, &
         & c_null_ptr, &
         & c_null_ptr, column, d, reciprocal, scale, self%numeric)
      equation = 0
      ratio = 0.0_wp
      if (status /= umfpack_ok) return
      if (reciprocal == 0) scale = 1.0_wp/scale
      ratio = huge(1.0_wp)
      do k = 1, self%n
         j = column(k) + 1
         largest = 0.0_wp
         do i = self%full%colptr(j) + 1, self%full%colptr(j + 1)
            largest = max(largest, abs(self%full%value(i))*scale(self%full%row(i) + 1))
         end do
         own = 0.0_wp
         if (largest > 0.0_wp) own = abs(d(k))/largest
         if (own >= ratio) cycle
         ratio = own
         equation = j
      end do
   end subroutine weakest_pivot

   subroutine solve(self, x)
      class(solver_umfpack_type), intent(inout) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)
      real(c_double) :: info(90), solution(self%n)
      integer :: j, status

      do j = 1, size(x, 2)
         if (self%n == 0) exit
         status = umfpack_di_solve(0_c_int, self%full%colptr, self%full%row, self%full%value, &
            & solution, x(:, j), &
            & self%numeric, self%control, info)
         x(:, j) = solution
         if (status /= umfpack_ok) x(:, j) = ieee_value(1.0_wp, ieee_quiet_nan)
      end do
   end subroutine solve

   !> A negative status of UMFPACK as an error.
   subroutine explain(status, n, error)
      integer, intent(in) :: status, n
      type(error_type), allocatable, intent(out) :: error

      if (status == umfpack_no_memory) call raise_no_memory(error, 'umfpack', n)
      if (status /= umfpack_ok .and. status /= umfpack_no_memory) call raise_failed(error, &
         & 'umfpack', n, status)
   end subroutine explain

   subroutine clear(self)
      class(solver_umfpack_type), intent(inout) :: self
      if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
      if (c_associated(self%symbolic)) call umfpack_di_free_symbolic(self%symbolic)
      self%numeric = c_null_ptr
      self%symbolic = c_null_ptr
   end subroutine clear

   subroutine destroy(self)
      type(solver_umfpack_type), intent(inout) :: self
      call self%clear()
   end subroutine destroy
end module lopin_solver_umfpack
