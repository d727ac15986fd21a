!> Sparse supernodal Cholesky factorisation by CHOLMOD, for positive definite matrices.
module lopin_solver_cholmod
   use, intrinsic :: iso_c_binding, only : c_ptr, c_null_ptr, c_int, c_double, c_long_long, &
      & c_associated
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use lopin_kinds, only : wp, ik, lk
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_csc, only : csc_type
   use lopin_graph, only : node_graph_type, number_interior, postorder
   use lopin_linear_solver, only : linear_solver_type, matrix_class, class_name, pivot_tolerance, &
      & raise_singular, raise_no_memory, raise_failed
   implicit none
   private
   public :: solver_cholmod_type

   !> Right-hand sides solved at once: enough for BLAS-3, small beside the factor.
   integer, parameter :: block_of_columns = 256

   !> Nested dissection is tried when minimum degree promises more operations than this per entry of
   !> the matrix: below it, ordering costs more than it saves (docs/solvers.md).
   real(wp), parameter :: worth_dissection = 3000.0_wp

   type :: codes
      integer :: ok = 0, no_memory = 1, not_positive = 2, too_large = 3, other = 4
   end type codes
   type(codes), parameter :: code = codes()

   type :: systems
      integer(c_int) :: all = 0, lower = 4, lower_transposed = 5
   end type systems
   type(systems), parameter :: system = systems()

   !> An order, the elimination tree that it makes, and its cost.
   type :: tree_type
      integer(ik), allocatable :: order(:)    !! (n) new -> old
      integer(ik), allocatable :: parent(:)   !! (n) 0 at a root
      integer(ik), allocatable :: count(:)    !! (n) entries of each column of the factor
      real(wp) :: flops = 0.0_wp
   end type tree_type

   type, extends(linear_solver_type) :: solver_cholmod_type
      private
      type(c_ptr) :: handle = c_null_ptr
      integer(ik), allocatable :: order(:)    !! (n) 1-based, position in the factor -> equation
      integer, allocatable :: place(:)        !! (nlast) position in the trailing block -> in `last`
      character(len=5), public :: ordering = ''   !! AMD or METIS, whichever was taken
   contains
      procedure :: name => cholmod_name
      procedure :: accepts => cholmod_accepts
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      procedure :: trailing_factor
      procedure :: forward
      procedure :: backward
      procedure :: symbolic
      final :: destroy
   end type solver_cholmod_type

   interface
      integer(c_int) function lopin_cholmod_create(handle) bind(c)
         import :: c_int, c_ptr
         type(c_ptr), intent(out) :: handle
      end function lopin_cholmod_create
      subroutine lopin_cholmod_free(handle) bind(c)
         import :: c_ptr
         type(c_ptr), intent(inout) :: handle
      end subroutine lopin_cholmod_free
      integer(c_int) function lopin_cholmod_amd(handle, n, p, i, perm) bind(c)
         import :: c_int, c_ptr
         type(c_ptr), value :: handle
         integer(c_int), value :: n
         integer(c_int), intent(in) :: p(*), i(*)
         integer(c_int), intent(out) :: perm(*)
      end function lopin_cholmod_amd
      integer(c_int) function lopin_cholmod_tree(handle, n, p, i, perm, parent, count, flops, &
         & entries) bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), value :: handle
         integer(c_int), value :: n
         integer(c_int), intent(in) :: p(*), i(*), perm(*)
         integer(c_int), intent(out) :: parent(*), count(*)
         real(c_double), intent(out) :: flops, entries
      end function lopin_cholmod_tree
      integer(c_int) function lopin_cholmod_analyse(handle, n, p, i, perm, stored, flops) bind(c)
         import :: c_int, c_ptr, c_long_long, c_double
         type(c_ptr), value :: handle
         integer(c_int), value :: n
         integer(c_int), intent(in) :: p(*), i(*), perm(*)
         integer(c_long_long), intent(out) :: stored
         real(c_double), intent(out) :: flops
      end function lopin_cholmod_analyse
      integer(c_int) function lopin_cholmod_factorise(handle, p, i, x, ratio, where_) bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), value :: handle
         integer(c_int), intent(in) :: p(*), i(*)
         real(c_double), intent(in) :: x(*)
         real(c_double), intent(out) :: ratio
         integer(c_int), intent(out) :: where_
      end function lopin_cholmod_factorise
      integer(c_int) function lopin_cholmod_solve(handle, what, columns, b, x) bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), value :: handle
         integer(c_int), value :: what, columns
         real(c_double), intent(in) :: b(*)
         real(c_double), intent(inout) :: x(*)
      end function lopin_cholmod_solve
      integer(c_int) function lopin_cholmod_trailing(handle, last, t) bind(c)
         import :: c_int, c_ptr, c_double
         type(c_ptr), value :: handle
         integer(c_int), value :: last
         real(c_double), intent(out) :: t(*)
      end function lopin_cholmod_trailing
      integer(c_int) function lopin_metis(n, ptr, adjacent, weight, perm) bind(c)
         import :: c_int
         integer(c_int), value :: n
         integer(c_int), intent(in) :: ptr(*), adjacent(*), weight(*)
         integer(c_int), intent(out) :: perm(*)
      end function lopin_metis
   end interface

contains

   function cholmod_name(self) result(name)
      class(solver_cholmod_type), intent(in) :: self
      character(len=:), allocatable :: name
      associate (unused => self)
         name = 'cholmod'
      end associate
   end function cholmod_name

   function cholmod_accepts(self, class_of) result(reason)
      class(solver_cholmod_type), intent(in) :: self
      integer, intent(in) :: class_of
      character(len=:), allocatable :: reason

      reason = ''
      if (class_of /= matrix_class%positive_definite) reason = self%name()// &
         & ' factorises positive definite matrices only, this one is '//class_name(class_of)
   end function cholmod_accepts

   subroutine analyse(self, a, class_of, last, error)
      class(solver_cholmod_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: class_of
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: local(:)
      integer(c_long_long) :: stored
      integer :: status, m, i
      logical :: distinct

      call self%begin_analysis(a, class_of, last, .true., error)
      if (allocated(error)) return
      call number_interior(a%n, last, local, m, distinct)
      if (.not. c_associated(self%handle)) then
         status = lopin_cholmod_create(self%handle)
         call explain(status, a%n, error)
         if (allocated(error)) return
      end if
      call choose_order(self, a, local, m, last, error)
      if (allocated(error)) return
      status = lopin_cholmod_analyse(self%handle, a%n, a%colptr, a%row, self%order - 1, stored, &
         & self%flops)
      call explain(status, a%n, error)
      if (allocated(error)) return
      self%factor_entries = int(stored, lk)
      local(last) = [(i, i=1, size(last))]
      self%place = local(self%order(m + 1:))
   end subroutine analyse

   !> Minimum degree on the graph of nodes, or nested dissection where it pays; then a postorder.
   !>
   !> The graph is that without the equations kept last: dissecting the whole graph and taking
   !> these out afterwards saved one operation in a hundred.
   subroutine choose_order(self, a, local, m, last, error)
      class(solver_cholmod_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(in) :: local(:)    !! (n) interior number, 0 for the last ones
      integer, intent(in) :: m
      integer, intent(in) :: last(:)
      type(error_type), allocatable, intent(out) :: error
      type(node_graph_type) :: graph
      type(tree_type) :: tree, rival
      integer, allocatable :: group_order(:), order(:)
      integer :: status, final(a%n)

      call graph%new(a, local, m)
      allocate (group_order(graph%ngroup))
      self%ordering = 'AMD'
      call minimum_degree(self%handle, graph%group_ptr, graph%group_adjacent, group_order, status)
      if (status == code%ok) call grow_tree(self%handle, a, [graph%equations_by(group_order), &
         & last], tree, status)
      call explain(status, a%n, error)
      if (allocated(error)) return
      if (tree%flops > worth_dissection*size(a%row)) then
         call dissect(graph, order, status)
         if (status == code%ok) call grow_tree(self%handle, a, [order, last], rival, status)
         if (status == code%ok .and. rival%flops < tree%flops) then
            tree = rival
            self%ordering = 'METIS'
         end if
      end if
      call postorder(tree%parent, tree%count, m, final)
      self%order = tree%order(final)
   end subroutine choose_order

   !> Nested dissection of the graph of nodes.
   subroutine dissect(graph, order, status)
      type(node_graph_type), intent(in) :: graph
      integer, allocatable, intent(out) :: order(:)   !! new -> equation
      integer, intent(out) :: status
      integer(ik) :: group_order(graph%ngroup)

      status = lopin_metis(graph%ngroup, graph%group_ptr - 1, graph%group_adjacent - 1, &
         & graph%weight, group_order)
      order = graph%equations_by(group_order + 1)
   end subroutine dissect

   subroutine minimum_degree(handle, ptr, adjacent, order, status)
      type(c_ptr), intent(in) :: handle
      integer, intent(in) :: ptr(:), adjacent(:)   !! a graph, both directions of each edge
      integer, intent(out) :: order(:)             !! new -> old
      integer, intent(out) :: status
      integer(ik) :: lower_ptr(size(ptr)), lower(size(adjacent))
      integer :: v, k, n

      status = code%ok
      if (size(order) == 0) return
      n = 0
      lower_ptr(1) = 0
      do v = 1, size(order)
         do k = ptr(v), ptr(v + 1) - 1
            if (adjacent(k) <= v) cycle
            n = n + 1
            lower(n) = adjacent(k) - 1
         end do
         lower_ptr(v + 1) = n
      end do
      status = lopin_cholmod_amd(handle, size(order), lower_ptr, lower, order)
      order = order + 1
   end subroutine minimum_degree

   !> The elimination tree and the cost of an order.
   subroutine grow_tree(handle, a, order, tree, status)
      type(c_ptr), intent(in) :: handle
      type(csc_type), intent(in) :: a
      integer, intent(in) :: order(:)         !! (n) new -> old
      type(tree_type), intent(out) :: tree
      integer, intent(out) :: status
      real(wp) :: entries

      tree%order = order
      allocate (tree%parent(a%n), tree%count(a%n))
      status = lopin_cholmod_tree(handle, a%n, a%colptr, a%row, tree%order - 1, tree%parent, &
         & tree%count, tree%flops, entries)
      tree%parent = tree%parent + 1
   end subroutine grow_tree

   subroutine factorise(self, a, bad, error)
      class(solver_cholmod_type), intent(inout) :: self
      type(csc_type), intent(in) :: a
      integer, intent(out) :: bad
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: weakest
      integer :: status

      bad = 0
      self%negative = -1
      status = lopin_cholmod_factorise(self%handle, a%colptr, a%row, a%value, self%pivot_ratio, &
         & weakest)
      if (status == code%not_positive) then
         bad = weakest + 1
         call raise_singular(error, self%name(), bad, self%pivot_ratio, 'not positive definite')
      else if (status /= code%ok) then
         call explain(status, self%n, error)
      else if (self%n > 0 .and. .not. self%pivot_ratio > pivot_tolerance(self%n)) then
         bad = weakest + 1
         call raise_singular(error, self%name(), bad, self%pivot_ratio, 'singular')
      else
         self%negative = 0
      end if
   end subroutine factorise

   subroutine solve(self, x)
      class(solver_cholmod_type), intent(inout) :: self
      real(wp), contiguous, intent(inout) :: x(:, :)
      integer :: first, n, status

      if (self%n == 0) return
      do first = 1, size(x, 2), block_of_columns
         n = min(block_of_columns, size(x, 2) - first + 1)
         status = lopin_cholmod_solve(self%handle, system%all, n, x(:, first:), x(:, first:))
         if (status /= code%ok) x(:, first:first + n - 1) = ieee_value(1.0_wp, ieee_quiet_nan)
      end do
   end subroutine solve

   !> What other factors on the same analysis ask for; null before it.
   function symbolic(self) result(handle)
      class(solver_cholmod_type), intent(in) :: self
      type(c_ptr) :: handle
      handle = self%handle
   end function symbolic

   subroutine trailing_factor(self, l, error)
      class(solver_cholmod_type), intent(inout) :: self
      real(wp), intent(out) :: l(:, :)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: inner(:, :)
      integer :: status, i, j

      allocate (inner(self%nlast, self%nlast))
      status = lopin_cholmod_trailing(self%handle, self%nlast, inner)
      call explain(status, self%n, error)
      if (allocated(error)) return
      l = 0.0_wp
      do j = 1, self%nlast
         do i = j, self%nlast
            l(self%place(i), self%place(j)) = inner(i, j)
         end do
      end do
   end subroutine trailing_factor

   subroutine forward(self, b, y)
      class(solver_cholmod_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)
      real(wp), contiguous, intent(out) :: y(:)
      integer :: m, status

      m = self%n - self%nlast
      status = lopin_cholmod_solve(self%handle, system%lower, 1, b(self%order), y)
      if (status /= code%ok) y = ieee_value(1.0_wp, ieee_quiet_nan)
      y(m + self%place) = y(m + 1:)
   end subroutine forward

   subroutine backward(self, b, y)
      class(solver_cholmod_type), intent(inout) :: self
      real(wp), contiguous, intent(in) :: b(:)
      real(wp), contiguous, intent(out) :: y(:)
      real(wp) :: inner(self%n)
      integer :: m, status

      m = self%n - self%nlast
      inner(:m) = b(:m)
      inner(m + 1:) = b(m + self%place)
      status = lopin_cholmod_solve(self%handle, system%lower_transposed, 1, inner, inner)
      if (status /= code%ok) inner = ieee_value(1.0_wp, ieee_quiet_nan)
      y(self%order) = inner
   end subroutine backward

   !> A status of the shim as an error.
   subroutine explain(status, n, error)
      integer, intent(in) :: status, n
      type(error_type), allocatable, intent(out) :: error

      select case (status)
      case (code%ok)
         return
      case (code%no_memory)
         call raise_no_memory(error, 'cholmod', n)
      case (code%too_large)
         call raise(error, error_code%resource, 'E0702', 'the analysis or one supernode of '// &
            & to_text(n)//' equations would have more than 2**31 entries')
      case default
         call raise_failed(error, 'cholmod', n, status)
      end select
   end subroutine explain

   subroutine destroy(self)
      type(solver_cholmod_type), intent(inout) :: self
      if (c_associated(self%handle)) call lopin_cholmod_free(self%handle)
      self%handle = c_null_ptr
   end subroutine destroy
end module lopin_solver_cholmod
