!> The contact problem on the whole system, factorised again at every change of contact: lecture J.
!>
!> With G = -B^T (gaps g = gap0 + B u), on the rows of a set:
!>
!>    penalty, augmented    (K + G alpha G^T) u = F - G (multiplier - alpha gap0)
!>    Lagrange              [K  G; G^T  0       ] (u, lambda) = (F, gap0)
!>    perturbed             [K  G; G^T -1/alpha ] (u, lambda) = (F, gap0)
!>
!> It answers the active set in the place of the condensed problem, which it extends: there K_c is
!> small and dense, here nothing is condensed. The factor stays while the set and the springs stay.
module lopin_full_system
   use lopin_kinds, only : wp, ik
   use lopin_text, only : lower
   use lopin_error, only : error_type, error_code
   use lopin_clock, only : clock_type, counter_type, phase
   use lopin_csc, only : csc_type, storage
   use lopin_linear_solver, only : linear_solver_type, matrix_class
   use lopin_solver_factory, only : new_solver, choose_solver, general_solver
   use lopin_condensed, only : condensed_type, springs_type, response_type, rows_times, &
      & columns_times, is_spring
   implicit none
   private
   public :: full_system_type, new_full_system, set_rows

   !> A row smaller than this beside the largest is carried by supports alone.
   real(wp), parameter :: no_row = 1.0e-12_wp

   !> n of the parent counts the free equations; its `l`, `s` and `c` are not used.
   !> Many components: those of the condensed problem are inherited.
   type, extends(condensed_type) :: full_system_type
      integer :: nmotion = 0                     !! motions that contact alone holds
      real(wp) :: ground = 0.0_wp                !! springs at `support`, on the way [force/length]
      integer, allocatable :: support(:)         !! (nmotion) equations that stop the motions
      real(wp) :: scale = 1.0_wp                 !! mean stiffness, scales forces [force/length]
      logical :: dependent_rows = .false.        !! a set was singular although nothing floats
      character(len=:), allocatable :: definite_name, indefinite_name, reason
      type(clock_type) :: clock
      type(counter_type) :: counter
      type(error_type), allocatable :: trouble   !! an error that is not a set that fails to hold
      type(csc_type), private :: plain           !! K
      type(csc_type), private :: k               !! K with places for the springs
      logical, allocatable, private :: empty(:)  !! (nrow) rows without free equations
      class(linear_solver_type), allocatable, private :: definite, indefinite
      ! The factor in hand.
      logical, private :: analysed = .false., factorised = .false.
      real(wp), private :: ground_inside = 0.0_wp
      integer, allocatable, private :: set_inside(:)
      real(wp), allocatable, private :: springs_inside(:)
   contains
      procedure :: free_gaps
      procedure :: solve_set
      procedure :: has_rigid_motions
   end type full_system_type

contains

   !> From the stiffness of all free equations; nothing is supported artificially.
   subroutine new_full_system(self, k, support, wish, error)
      type(full_system_type), intent(out) :: self
      type(csc_type), intent(in) :: k              !! (neq) lower triangle
      integer, intent(in) :: support(:)            !! (nmotion) equations that stop what floats
      character(len=*), intent(in) :: wish         !! AUTO or a solver's word
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: diagonal(:)

      self%n = k%n
      self%plain = k
      self%support = support
      self%nmotion = size(support)
      allocate (diagonal(k%n))
      call k%diagonal(diagonal)
      if (any(diagonal > 0.0_wp)) self%scale = sum(diagonal)/count(diagonal > 0.0_wp)
      self%definite_name = lower(wish)
      self%indefinite_name = general_solver(self%definite_name)
      self%reason = 'as asked'
      if (self%definite_name == 'auto') call choose_solver(k, matrix_class%positive_definite, &
         & [integer ::], self%definite_name, self%reason)
      call new_solver(self%definite, self%definite_name, error)
      if (allocated(error)) return
      call new_solver(self%indefinite, self%indefinite_name, error)
   end subroutine new_full_system

   !> New data of the rows (already in the parent's components): places for springs, no factor.
   subroutine set_rows(self, moved)
      class(full_system_type), intent(inout) :: self
      logical, intent(in) :: moved                 !! other equations, not only other values
      real(wp), allocatable :: size_(:)
      integer :: row

      allocate (size_(self%nrow))
      do row = 1, self%nrow
         size_(row) = norm2(self%value(self%first(row):self%first(row + 1) - 1))
      end do
      self%empty = .not. size_ > no_row*maxval([0.0_wp, size_])
      self%factorised = .false.
      if (.not. moved) return
      call add_places(self)
      self%analysed = .false.
   end subroutine set_rows

   !> K with an entry wherever a spring couples two equations.
   subroutine add_places(self)
      class(full_system_type), intent(inout) :: self
      integer, allocatable :: i(:), j(:)
      real(wp), allocatable :: value(:)
      logical :: spring(self%nrow)
      integer :: row, column, a, b, total, pass

      spring = is_spring(self)
      if (.not. any(spring)) then
         self%k = self%plain
         return
      end if
      do pass = 1, 2
         total = 0
         do column = 1, merge(self%n, 0, pass == 2)
            do a = self%plain%colptr(column) + 1, self%plain%colptr(column + 1)
               i(a) = self%plain%row(a) + 1
               j(a) = column
               value(a) = self%plain%value(a)
            end do
         end do
         total = size(self%plain%row)
         do row = 1, self%nrow
            if (.not. spring(row)) cycle
            do a = self%first(row), self%first(row + 1) - 1
               do b = self%first(row), a - 1
                  total = total + 1
                  if (pass == 1) cycle
                  i(total) = self%column(a)
                  j(total) = self%column(b)
               end do
            end do
         end do
         if (pass == 1) then
            allocate (i(total), j(total))
            allocate (value(total), source=0.0_wp)
         end if
      end do
      call self%k%new_from_triplets(self%n, storage%symmetric_lower, i, j, value)
   end subroutine add_places

   !> Gaps without contact, by one factorisation of K; not if a set is known or contact alone holds.
   subroutine free_gaps(self, gap0, load, cold, gap)
      class(full_system_type), intent(inout) :: self
      real(wp), intent(in) :: gap0(:), load(:)
      logical, intent(in) :: cold
      real(wp), allocatable, intent(out) :: gap(:)
      real(wp) :: x(self%n, 1)
      integer :: status

      gap = gap0
      if (.not. cold .or. self%has_rigid_motions()) return
      call factorise(self, [integer ::], 0.0_wp*gap0, 0.0_wp*gap0, status)
      if (status /= 0) return
      x(:, 1) = load
      call back_solve(self, self%definite, x)
      gap = gap0 + rows_times(self, x(:, 1))
   end subroutine free_gaps

   !> Without the springs of the way, a set may fail to hold what floats.
   pure logical function has_rigid_motions(self)
      class(full_system_type), intent(in) :: self
      has_rigid_motions = self%nmotion > 0 .and. .not. self%ground > 0.0_wp
   end function has_rigid_motions

   !> Displacements, forces and gaps on a set; status /= 0: its matrix is singular.
   subroutine solve_set(self, active, spring, compliance, springs, answer, status)
      class(full_system_type), intent(inout) :: self
      logical, intent(in) :: active(:), spring(:)
      real(wp), intent(in) :: compliance(:)
      type(springs_type), intent(inout) :: springs
      type(response_type), intent(inout) :: answer
      integer, intent(out) :: status
      real(wp), allocatable :: x(:, :), stiffness(:), pull(:)
      integer, allocatable :: set(:)
      integer :: i, m

      set = pack([(i, i=1, self%nrow)], active .and. .not. spring .and. .not. self%empty)
      m = size(set)
      stiffness = merge(springs%stiffness, 0.0_wp, spring)
      call factorise(self, set, stiffness, compliance, status)
      if (status /= 0) return
      pull = merge(springs%offset - springs%stiffness*answer%gap0, 0.0_wp, spring)
      allocate (x(self%n + m, 1))
      x(:self%n, 1) = answer%load + columns_times(self, pull)
      x(self%n + 1:, 1) = self%scale*answer%gap0(set)
      if (m == 0) then
         call back_solve(self, self%definite, x)
      else
         call back_solve(self, self%indefinite, x)
      end if
      answer%u = x(:self%n, 1)
      answer%gap = answer%gap0 + rows_times(self, answer%u)
      answer%force = merge(springs%offset - springs%stiffness*answer%gap, 0.0_wp, spring)
      answer%force(set) = self%scale*x(self%n + 1:, 1)
      answer%dependent = count(active .and. .not. spring .and. self%empty)
   end subroutine solve_set

   !> Factor of the matrix of a set; the one in hand if nothing changed.
   subroutine factorise(self, set, stiffness, compliance, status)
      class(full_system_type), intent(inout) :: self
      integer, intent(in) :: set(:)                !! rows whose force is an unknown
      real(wp), intent(in) :: stiffness(:)         !! (nrow) of springs
      real(wp), intent(in) :: compliance(:)        !! (nrow)
      integer, intent(out) :: status
      type(csc_type) :: matrix, saddle
      type(error_type), allocatable :: error
      integer :: bad

      status = 0
      if (same_factor(self, set, stiffness)) return
      call self%clock%start()
      matrix = self%k
      call stiffen(self, matrix, stiffness)
      if (size(set) == 0) then
         if (.not. self%analysed .or. self%definite%orders_by_values()) &
            & call self%definite%analyse(matrix, &
            & matrix_class%positive_definite, [integer ::], error)
         self%analysed = .not. allocated(error)
         call self%clock%stop_in(phase%analyse)
         if (.not. allocated(error)) call self%definite%factorise(matrix, bad, error)
      else
         call border(self, matrix, set, compliance, saddle)
         call self%indefinite%analyse(saddle, matrix_class%symmetric_indefinite, [integer ::], &
            & error)
         call self%clock%stop_in(phase%analyse)
         if (.not. allocated(error)) call self%indefinite%factorise(saddle, bad, error)
      end if
      call self%clock%stop_in(phase%factorise)
      self%counter%factorisations = self%counter%factorisations + 1
      self%factorised = .not. allocated(error)
      self%set_inside = set
      self%springs_inside = stiffness
      self%ground_inside = self%ground
      if (self%factorised) return
      status = 1
      self%dependent_rows = .not. self%has_rigid_motions()
      if (error%code /= error_code%singular) call move_alloc(error, self%trouble)
   end subroutine factorise

   pure logical function same_factor(self, set, stiffness) result(same)
      class(full_system_type), intent(in) :: self
      integer, intent(in) :: set(:)
      real(wp), intent(in) :: stiffness(:)

      same = self%factorised
      if (same) same = size(self%set_inside) == size(set) &
         & .and. size(self%springs_inside) == size(stiffness)
      if (same) same = all(self%set_inside == set) .and. all(self%springs_inside == stiffness)
      if (same) same = .not. abs(self%ground_inside - self%ground) > 0.0_wp
   end function same_factor

   !> matrix + G alpha G^T + ground.
   subroutine stiffen(self, matrix, stiffness)
      class(full_system_type), intent(in) :: self
      type(csc_type), intent(inout) :: matrix
      real(wp), intent(in) :: stiffness(:)
      integer :: row, a, b, slot

      do row = 1, self%nrow
         if (.not. stiffness(row) > 0.0_wp) cycle
         do a = self%first(row), self%first(row + 1) - 1
            do b = self%first(row), a
               slot = matrix%slot(self%column(a), self%column(b))
               matrix%value(slot) = matrix%value(slot) + stiffness(row)*self%value(a)*self%value(b)
            end do
         end do
      end do
      if (.not. self%ground > 0.0_wp) return
      do row = 1, self%nmotion
         slot = matrix%slot(self%support(row), self%support(row))
         matrix%value(slot) = matrix%value(slot) + self%ground
      end do
   end subroutine stiffen

   !> [K G; G^T -compliance], forces and rows times `scale` so that all entries are stiffnesses.
   subroutine border(self, matrix, set, compliance, saddle)
      class(full_system_type), intent(in) :: self
      type(csc_type), intent(in) :: matrix
      integer, intent(in) :: set(:)
      real(wp), intent(in) :: compliance(:)
      type(csc_type), intent(out) :: saddle
      integer :: more(self%n), at, i, k, j, entries

      more = 0
      do i = 1, size(set)
         do k = self%first(set(i)), self%first(set(i) + 1) - 1
            more(self%column(k)) = more(self%column(k)) + 1
         end do
      end do
      entries = size(matrix%row) + sum(more) + size(set)
      saddle%n = self%n + size(set)
      saddle%kind = storage%symmetric_lower
      allocate (saddle%colptr(saddle%n + 1), saddle%row(entries), saddle%value(entries))
      at = 0
      do j = 1, self%n
         saddle%colptr(j) = int(at, ik)
         associate (from => matrix%colptr(j) + 1, to => matrix%colptr(j + 1))
            saddle%row(at + 1:at + 1 + to - from) = matrix%row(from:to)
            saddle%value(at + 1:at + 1 + to - from) = matrix%value(from:to)
            at = at + 1 + to - from
         end associate
         k = more(j)
         more(j) = at
         at = at + k
      end do
      do i = 1, size(set)
         do k = self%first(set(i)), self%first(set(i) + 1) - 1
            j = self%column(k)
            more(j) = more(j) + 1
            saddle%row(more(j)) = int(self%n + i - 1, ik)
            saddle%value(more(j)) = -self%scale*self%value(k)
         end do
         at = at + 1
         saddle%colptr(self%n + i) = int(at - 1, ik)
         saddle%row(at) = int(self%n + i - 1, ik)
         saddle%value(at) = -self%scale**2*compliance(set(i))
      end do
      saddle%colptr(saddle%n + 1) = int(at, ik)
   end subroutine border

   subroutine back_solve(self, solver, x)
      class(full_system_type), intent(inout) :: self
      class(linear_solver_type), intent(inout) :: solver
      real(wp), contiguous, intent(inout) :: x(:, :)

      call self%clock%start()
      call solver%solve(x)
      call self%clock%stop_in(phase%solve)
      self%counter%back_solves = self%counter%back_solves + size(x, 2)
   end subroutine back_solve
end module lopin_full_system
