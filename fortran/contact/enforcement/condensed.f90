!> The contact problem on the equations that contact touches: dense and exact.
!>
!> Given K_c = L L^T (the condensation of everything else), gaps g = gap0 + B u + C q and the
!> equilibrium of floating bodies, C^T lambda = -moving, find the forces lambda:
!>
!>    K_c u = load + B^T lambda,   each row by its method (lopin_enforcement).
!>
!> `q` are the motions of bodies that nothing but contact holds. Rows whose method solves for the
!> force use the compliance S = B K_c^-1 B^T; rows with springs stiffen K_c itself, as the penalty
!> system does.
module lopin_condensed
   use lopin_kinds, only : wp
   use lopin_blas, only : dsyrk
   use lopin_enforcement_factory, only : enforcement_holder_type
   use lopin_eliminated_normals, only : eliminated_type
   use lopin_dense, only : cholesky, cholesky_solve, lower_solve, bordered_solve, symmetric_eigen
   implicit none
   private
   public :: condensed_type, springs_type, response_type, form_compliance, rows_times, columns_times
   public :: is_spring, row_compliance, add_ground_springs, hold_at_rest

   !> Problem data. Rows come in groups of one method each (one group a pair).
   type :: condensed_type
      integer :: n = 0, nq = 0, nrow = 0, ngroup = 0
      real(wp), allocatable :: l(:, :)             !! (n, n) lower Cholesky factor of K_c
      integer, allocatable :: first(:), column(:)  !! rows of B by (nrow+1) pointers
      real(wp), allocatable :: value(:)
      real(wp), allocatable :: c(:, :)             !! (nrow, nq)
      real(wp), allocatable :: s(:, :)   !! (nrow, nrow) compliance; unallocated until it is needed
      logical, allocatable :: bilateral(:)         !! (nrow)
      real(wp), allocatable :: alpha(:)   !! (nrow) nodal stiffness [force/length]; weight for a
                                          !! pressure law
      integer, allocatable :: group_first(:)       !! (ngroup+1) first row of each group
      type(enforcement_holder_type), allocatable :: group(:)
      integer, allocatable :: max_augmentations(:) !! (ngroup) 0: the method has none
      real(wp), allocatable :: penetration(:)   !! (ngroup) accepted by the augmented method
                                                !! [length]; 0: exact
      real(wp), allocatable :: rest(:)         !! (nq) the floating motions before this load
      real(wp), allocatable :: held(:, :)   !! (nq, nq) springs to `place` of motions that no row of
                                            !! a set resists and no load drives; unallocated: none
      real(wp), allocatable :: place(:)        !! (nq)
      type(eliminated_type) :: eliminated      !! closed rows of the last solve with friction
   contains
      ! What the active set asks of a system; another way to solve it overrides these three.
      procedure :: free_gaps
      procedure :: solve_set
      procedure :: has_rigid_motions
   end type condensed_type

   !> The springs of one linear solve, force = offset - stiffness*gap, and the factor that holds
   !> them.
   type :: springs_type
      real(wp), allocatable :: offset(:), stiffness(:)   !! (nrow)
      real(wp), allocatable :: k(:, :)                   !! K_c
      real(wp), allocatable :: factor(:, :)              !! of K_c + sum of the springs in `inside`
      real(wp), allocatable :: inside(:)
   end type springs_type

   !> What the loads do alone, and the answer on one set.
   type :: response_type
      real(wp), allocatable :: gap0(:), load(:), moving(:)
      real(wp), allocatable :: free_gap(:)   !! (nrow) gaps without contact forces
      real(wp), allocatable :: force(:), gap(:), q(:)
      real(wp), allocatable :: u(:)   !! displacements, where the system solves for all of them
      integer :: dependent = 0
   end type response_type

contains

   !> S = (L^-1 B^T)^T (L^-1 B^T), once.
   subroutine form_compliance(self)
      type(condensed_type), intent(inout) :: self
      real(wp), allocatable :: w(:, :)
      integer :: row, k, j

      if (allocated(self%s)) return
      self%eliminated = eliminated_type()
      allocate (w(self%n, self%nrow), source=0.0_wp)
      do row = 1, self%nrow
         do k = self%first(row), self%first(row + 1) - 1
            w(self%column(k), row) = w(self%column(k), row) + self%value(k)
         end do
      end do
      call lower_solve(self%l, w)
      allocate (self%s(self%nrow, self%nrow), source=0.0_wp)
      if (self%n > 0 .and. self%nrow > 0) then
         call dsyrk('L', 'T', self%nrow, self%n, 1.0_wp, w, self%n, 0.0_wp, self%s, self%nrow)
      end if
      do j = 1, self%nrow
         self%s(j, j + 1:) = self%s(j + 1:, j)
      end do
   end subroutine form_compliance

   !> Gaps under the loads without contact, from which a first set follows.
   subroutine free_gaps(self, gap0, load, cold, gap)
      class(condensed_type), intent(inout) :: self
      real(wp), intent(in) :: gap0(:), load(:)
      logical, intent(in) :: cold            !! no set is known yet
      real(wp), allocatable, intent(out) :: gap(:)
      real(wp), allocatable :: u(:)

      associate (unused => cold)
      end associate
      if (.not. all(is_spring(self))) call form_compliance(self)
      u = load
      call cholesky_solve(self%l, u)
      gap = gap0 + rows_times(self, u)
   end subroutine free_gaps

   !> .true.: some motion is held by contact alone, so that a set may fail to hold it.
   pure logical function has_rigid_motions(self)
      class(condensed_type), intent(in) :: self
      has_rigid_motions = self%nq > 0
   end function has_rigid_motions

   !> B u.
   pure function rows_times(self, u) result(g)
      class(condensed_type), intent(in) :: self
      real(wp), intent(in) :: u(:)
      real(wp) :: g(self%nrow)
      integer :: row, k

      do row = 1, self%nrow
         g(row) = 0.0_wp
         do k = self%first(row), self%first(row + 1) - 1
            g(row) = g(row) + self%value(k)*u(self%column(k))
         end do
      end do
   end function rows_times

   !> B^T force.
   pure function columns_times(self, force) result(u)
      class(condensed_type), intent(in) :: self
      real(wp), intent(in) :: force(:)
      real(wp) :: u(self%n)
      integer :: row, k

      u = 0.0_wp
      do row = 1, self%nrow
         do k = self%first(row), self%first(row + 1) - 1
            u(self%column(k)) = u(self%column(k)) + self%value(k)*force(row)
         end do
      end do
   end function columns_times

   !> Rows whose force is a spring's.
   function is_spring(self) result(spring)
      class(condensed_type), intent(in) :: self
      logical :: spring(self%nrow)
      integer :: group

      do group = 1, self%ngroup
         spring(self%group_first(group):self%group_first(group + 1) - 1) = &
            & .not. self%group(group)%method%solves_for_multiplier()
      end do
   end function is_spring

   !> Compliance that the methods add to the diagonal of S [length/force].
   function row_compliance(self) result(compliance)
      class(condensed_type), intent(in) :: self
      real(wp) :: compliance(self%nrow)
      integer :: group, from, to

      do group = 1, self%ngroup
         from = self%group_first(group)
         to = self%group_first(group + 1) - 1
         compliance(from:to) = self%group(group)%method%compliance(self%alpha(from:to))
      end do
   end function row_compliance

   !> Forces, gaps and floating motions on a set; status /= 0: the set does not hold the bodies.
   subroutine solve_set(self, active, spring, compliance, springs, answer, status)
      class(condensed_type), intent(inout) :: self
      logical, intent(in) :: active(:), spring(:)
      real(wp), intent(in) :: compliance(:)
      type(springs_type), intent(inout) :: springs
      type(response_type), intent(inout) :: answer
      integer, intent(out) :: status
      integer, allocatable :: set(:)
      integer :: i

      set = pack([(i, i=1, self%nrow)], active .and. .not. spring)
      answer%dependent = 0
      if (any(spring)) then
         call solve_with_springs(self, set, spring, compliance, springs, answer, status)
      else
         call solve_unknowns(self, set, compliance, answer, status)
      end if
   end subroutine solve_set

   !> All rows solve for their force: only S is needed.
   subroutine solve_unknowns(self, set, compliance, answer, status)
      class(condensed_type), intent(in) :: self
      integer, intent(in) :: set(:)
      real(wp), intent(in) :: compliance(:)
      type(response_type), intent(inout) :: answer
      integer, intent(out) :: status
      real(wp), allocatable :: a(:, :), force(:)
      integer :: i

      allocate (a(size(set), size(set)), force(size(set)))
      a(:, :) = self%s(set, set)
      do i = 1, size(set)
         a(i, i) = a(i, i) + compliance(set(i))
      end do
      force = -answer%free_gap(set)
      answer%q = -(answer%moving + pull_to_rest(self))
      call bordered_solve(a, self%c(set, :), force, answer%q, answer%dependent, status, self%held)
      if (status /= 0) return
      answer%force = 0.0_wp
      answer%force(set) = force
      answer%gap = answer%free_gap
      do i = 1, size(set)
         answer%gap = answer%gap + self%s(:, set(i))*force(i)
      end do
      if (self%nq > 0) answer%gap = answer%gap + matmul(self%c, answer%q)
   end subroutine solve_unknowns

   !> Some rows are springs: they stiffen K_c, and hold the floating motions with the unknown
   !> forces.
   subroutine solve_with_springs(self, set, spring, compliance, springs, answer, status)
      class(condensed_type), intent(in) :: self
      integer, intent(in) :: set(:)
      logical, intent(in) :: spring(:)
      real(wp), intent(in) :: compliance(:)
      type(springs_type), intent(inout) :: springs
      type(response_type), intent(inout) :: answer
      integer, intent(out) :: status
      real(wp), allocatable :: u(:), pull(:), stiffness(:), right(:, :), a(:, :), held(:, :), &
         & force(:), balance(:)
      integer :: i, k, m

      call stiffen(self, spring, springs, status)
      if (status /= 0) return
      m = size(set)
      stiffness = merge(springs%stiffness, 0.0_wp, spring)
      pull = merge(springs%offset - springs%stiffness*answer%gap0, 0.0_wp, spring)
      u = answer%load + columns_times(self, pull)
      call cholesky_solve(springs%factor, u)
      answer%gap = answer%gap0 + rows_times(self, u)
      ! Response of all gaps to a unit of each unknown force, then of each floating motion.
      allocate (right(self%n, m + self%nq), source=0.0_wp)
      do i = 1, m
         do k = self%first(set(i)), self%first(set(i) + 1) - 1
            right(self%column(k), i) = right(self%column(k), i) + self%value(k)
         end do
      end do
      do i = 1, self%nq
         right(:, m + i) = -columns_times(self, stiffness*self%c(:, i))
      end do
      call cholesky_solve(springs%factor, right)
      allocate (a(self%nrow, m + self%nq), held(self%nq, self%nq), force(m))
      do i = 1, m + self%nq
         a(:, i) = rows_times(self, right(:, i))
         if (i > m) a(:, i) = a(:, i) + self%c(:, i - m)
      end do
      do i = 1, self%nq
         held(:, i) = matmul(stiffness*a(:, m + i), self%c)
      end do
      if (allocated(self%held)) held = held + self%held
      balance = answer%moving + pull_to_rest(self) + matmul(merge(springs%offset &
         & - stiffness*answer%gap, 0.0_wp, spring), self%c)
      block
         real(wp) :: s(m, m)
         s = a(set, :m)
         do i = 1, m
            s(i, i) = s(i, i) + compliance(set(i))
         end do
         force = -answer%gap(set)
         answer%q = -balance
         call bordered_solve(s, a(set, m + 1:), force, answer%q, answer%dependent, status, held)
      end block
      if (status /= 0) return
      if (m + self%nq > 0) answer%gap = answer%gap + matmul(a, [force, answer%q])
      answer%force = merge(springs%offset - springs%stiffness*answer%gap, 0.0_wp, spring)
      answer%force(set) = force
   end subroutine solve_with_springs

   !> What the springs of `held` do where the floating motions are zero.
   pure function pull_to_rest(self) result(pull)
      class(condensed_type), intent(in) :: self
      real(wp) :: pull(self%nq)

      pull = 0.0_wp
      if (allocated(self%held)) pull = matmul(self%held, self%place)
   end function pull_to_rest

   !> Hold the floating motions that no active row resists and no load drives where they are: a
   !> body without contact stays. `held` stays unallocated if there are none.
   subroutine hold_at_rest(self, active, load, moving, q, ground)
      class(condensed_type), intent(inout) :: self
      logical, intent(in) :: active(:)         !! (nrow)
      real(wp), intent(in) :: load(:), moving(:)
      real(wp), intent(in) :: q(:)             !! (nq) where
      real(wp), intent(in) :: ground(:)        !! (nq) their stiffness: they carry nothing
      !> Squared shares of motions that rows resist, and forces beside all loads, that are none.
      real(wp), parameter :: resisted = 1.0e-10_wp, no_force = 1.0e-9_wp
      real(wp) :: gram(self%nq, self%nq), value(self%nq)
      integer :: i, j, status

      if (allocated(self%held)) deallocate (self%held)
      self%place = q
      do i = 1, self%nq
         do j = 1, self%nq
            gram(j, i) = sum(self%c(:, j)*self%c(:, i), mask=active)
         end do
      end do
      call symmetric_eigen(gram, value, status)
      if (status /= 0) return
      value = value/max(maxval(sum(self%c**2, dim=1)), tiny(1.0_wp))
      if (.not. any(value <= resisted)) return
      allocate (self%held(self%nq, self%nq), source=0.0_wp)
      do i = 1, self%nq
         if (value(i) > resisted) cycle
         if (abs(dot_product(gram(:, i), moving)) > no_force*(norm2(load) + norm2(moving))) then
            deallocate (self%held)
            return
         end if
         do j = 1, self%nq
            self%held(:, j) = self%held(:, j) + maxval(ground)*gram(j, i)*gram(:, i)
         end do
      end do
   end subroutine hold_at_rest

   !> Factor of K_c + sum of the springs; kept while the springs stay the same.
   subroutine stiffen(self, spring, springs, status)
      class(condensed_type), intent(in) :: self
      logical, intent(in) :: spring(:)
      type(springs_type), intent(inout) :: springs
      integer, intent(out) :: status
      integer :: row, i, j

      status = 0
      if (allocated(springs%inside)) then
         if (all(springs%inside == springs%stiffness)) return
      end if
      springs%inside = springs%stiffness
      if (.not. allocated(springs%k)) then
         allocate (springs%k(self%n, self%n), source=0.0_wp)
         if (self%n > 0) call dsyrk('L', 'N', self%n, self%n, 1.0_wp, self%l, self%n, 0.0_wp, &
            & springs%k, self%n)
      end if
      springs%factor = springs%k
      do row = 1, self%nrow
         if (.not. spring(row) .or. springs%stiffness(row) == 0.0_wp) cycle
         do i = self%first(row), self%first(row + 1) - 1
            do j = self%first(row), self%first(row + 1) - 1
               if (self%column(j) > self%column(i)) cycle
               springs%factor(self%column(i), self%column(j)) = springs%factor(self%column(i), &
                  & self%column(j)) &
                  & + springs%stiffness(row)*self%value(i)*self%value(j)
            end do
         end do
      end do
      call cholesky(springs%factor, status)
   end subroutine stiffen

   !> The same problem with the floating motions among the equations, each on a spring `ground`.
   subroutine add_ground_springs(self, grounded, ground)
      class(condensed_type), intent(inout) :: self
      type(condensed_type), intent(out) :: grounded
      real(wp), intent(out) :: ground(:)
      real(wp) :: mean
      integer :: i, row, n

      call form_compliance(self)
      mean = 0.0_wp
      do row = 1, self%nrow
         mean = mean + self%s(row, row)
      end do
      n = self%n
      grounded%nrow = self%nrow
      grounded%ngroup = self%ngroup
      grounded%bilateral = self%bilateral
      grounded%alpha = self%alpha
      grounded%group_first = self%group_first
      grounded%group = self%group
      grounded%max_augmentations = self%max_augmentations
      grounded%penetration = self%penetration
      grounded%n = n + self%nq
      allocate (grounded%l(n + self%nq, n + self%nq), grounded%c(self%nrow, 0), source=0.0_wp)
      if (n > 0) grounded%l(:n, :n) = self%l
      do i = 1, self%nq
         ground(i) = sum(self%c(:, i)**2)/(1.0e2_wp*mean)
         if (.not. ground(i) > 0.0_wp .or. ground(i) > huge(1.0_wp)) ground(i) = 1.0_wp
         grounded%l(n + i, n + i) = sqrt(ground(i))
      end do
      allocate (grounded%first(self%nrow + 1), grounded%column(0), grounded%value(0))
      grounded%first(1) = 1
      do row = 1, self%nrow
         associate (from => self%first(row), to => self%first(row + 1) - 1)
            grounded%column = [grounded%column, self%column(from:to), [(n + i, i=1, self%nq)]]
            grounded%value = [grounded%value, self%value(from:to), self%c(row, :)]
         end associate
         grounded%first(row + 1) = size(grounded%column) + 1
      end do
   end subroutine add_ground_springs
end module lopin_condensed
