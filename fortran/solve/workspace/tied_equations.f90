!> Equations of tied slave nodes, which the factor of a Newton step does without.
!>
!> A row of a tie, s_own v_own + sum s_k v_k = h, gives its own equation from the others, and its
!> multiplier is the force that its own equation is left with. With E the equations as combinations
!> of those that are kept, the inverse that preconditions the whole system is
!>
!>    v = E (E^T K E)^-1 E^T (f - K F h) + F h,    F h: the own equations alone,
!>
!> and then the multipliers from what own equations are left with. The operator of the iterations
!> keeps all rows, so that answers, multipliers and convergence are those of rows.
module lopin_tied_equations
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_constraints, only : constraints_type
   use lopin_reduce_matrix, only : reduce_matrix
   use lopin_linear_solver, only : vertices_type
   use lopin_contact_block, only : block_type
   implicit none
   private
   public :: tied_equations_type, find_tied, take_out, give_own, gather_kept, &
      & find_tied_forces, vertices_of_kept

   !> The own share of a row is at least this much of its largest.
   real(wp), parameter :: strong = 0.1_wp
   !> Ties that depend on ties: mid-side nodes on corners, and these on the slaves of another pair.
   integer, parameter :: longest_chain = 4
   !> Shares below this, beside the largest, are rounding, which iterations mend.
   real(wp), parameter :: rounded = 1.0e-12_wp

   !> Rows in the order in which they give their own equations.
   type :: tied_equations_type
      integer :: n = 0                         !! rows
      integer, allocatable :: row(:)           !! (n) of the multiplier
      integer, allocatable :: own(:)           !! (n) equation
      real(wp), allocatable :: own_share(:)    !! (n)
      integer, allocatable :: first(:)         !! (n + 1) of the other shares in
      integer, allocatable :: at(:)            !! equations
      real(wp), allocatable :: share(:)
      integer, allocatable :: kept(:)          !! equations that are no row's own, increasing
      type(constraints_type) :: terms          !! E
   end type tied_equations_type

   !> A combination of kept equations.
   type :: terms_type
      integer, allocatable :: at(:)
      real(wp), allocatable :: value(:)
   end type terms_type

contains

   !> The rows of a tangent whose own equations go; blocks of their points are marked.
   subroutine find_tied(self, blocks, neq)
      type(tied_equations_type), intent(inout) :: self
      type(block_type), intent(inout) :: blocks(:)
      integer, intent(in) :: neq
      integer :: b, before

      self%n = 0
      do b = 1, size(blocks)
         blocks(b)%tied = .false.
         if (allocated(blocks(b)%share)) blocks(b)%tied = has_own_shares(blocks(b))
      end do
      call leave_shared(blocks, neq)
      if (.not. any(blocks%tied)) return
      do
         before = count(blocks%tied)
         call list_rows(self, blocks)
         call put_in_order(self, blocks, neq)
         if (count(blocks%tied) == before) exit
      end do
      if (self%n > 0) call find_terms(self, neq)
   end subroutine find_tied

   !> Every row of a block has a good share of its own equation.
   pure logical function has_own_shares(block) result(has)
      type(block_type), intent(in) :: block
      integer :: k, own

      has = any(block%own > 0)
      do k = 1, size(block%share, 1)
         if (.not. has) return
         if (block%own(k) == 0) cycle
         own = findloc(block%at(:block%nu), block%own(k), dim=1)
         associate (s => block%share(k, :))
            has = abs(s(own)) >= strong*maxval(abs(s))
         end associate
      end do
   end function has_own_shares

   !> An equation is the own one of one point, the first.
   subroutine leave_shared(blocks, neq)
      type(block_type), intent(inout) :: blocks(:)
      integer, intent(in) :: neq
      logical :: taken(neq)
      integer :: b

      taken = .false.
      do b = 1, size(blocks)
         if (.not. blocks(b)%tied) cycle
         associate (own => pack(blocks(b)%own, blocks(b)%own > 0))
            blocks(b)%tied = .not. any(taken(own))
            if (blocks(b)%tied) taken(own) = .true.
         end associate
      end do
   end subroutine leave_shared

   !> The rows of the marked blocks.
   subroutine list_rows(self, blocks)
      type(tied_equations_type), intent(inout) :: self
      type(block_type), intent(in) :: blocks(:)
      integer, allocatable :: at(:)
      real(wp), allocatable :: share(:)
      integer :: b, k, m, most

      self%n = 0
      most = 0
      m = 0
      do b = 1, size(blocks)
         if (.not. blocks(b)%tied) cycle
         most = most + count(blocks(b)%own > 0)
         m = m + count(blocks(b)%own > 0)*blocks(b)%nu
      end do
      self = tied_equations_type()
      allocate (self%row(most), self%own(most), self%own_share(most), self%first(most + 1))
      allocate (at(m), share(m))
      m = 0
      self%first(1) = 1
      do b = 1, size(blocks)
         if (.not. blocks(b)%tied) cycle
         do k = 1, size(blocks(b)%share, 1)
            if (blocks(b)%own(k) > 0) call take_row(blocks(b), k, blocks(b)%share(k, :))
         end do
      end do
      self%at = at(:m)
      self%share = share(:m)

   contains

      subroutine take_row(block, k, s)
         type(block_type), intent(in) :: block
         integer, intent(in) :: k
         real(wp), intent(in) :: s(:)          !! (nu)
         integer :: j

         self%n = self%n + 1
         self%row(self%n) = block%at(block%nu + k)
         self%own(self%n) = block%own(k)
         do j = 1, block%nu
            if (block%at(j) == block%own(k)) then
               self%own_share(self%n) = s(j)
            else if (abs(s(j)) > rounded*maxval(abs(s))) then
               m = m + 1
               at(m) = block%at(j)
               share(m) = s(j)
            end if
         end do
         self%first(self%n + 1) = m + 1
      end subroutine take_row
   end subroutine list_rows

   !> Rows after those that they depend on; points whose chains are too long, or circles, are left.
   subroutine put_in_order(self, blocks, neq)
      type(tied_equations_type), intent(inout) :: self
      type(block_type), intent(inout) :: blocks(:)
      integer, intent(in) :: neq
      integer :: level(neq), row, k, pass, most, b, order(self%n)
      logical :: own(neq), changed

      own = .false.
      own(self%own) = .true.
      level = 0
      do pass = 0, longest_chain + 1
         changed = .false.
         do row = 1, self%n
            most = 0
            do k = self%first(row), self%first(row + 1) - 1
               if (own(self%at(k))) most = max(most, level(self%at(k)) + 1)
            end do
            changed = changed .or. level(self%own(row)) /= most
            level(self%own(row)) = most
         end do
         if (.not. changed) exit
      end do
      do b = 1, size(blocks)
         if (.not. blocks(b)%tied) cycle
         do k = 1, size(blocks(b)%share, 1)
            if (blocks(b)%own(k) == 0) cycle
            if (level(blocks(b)%own(k)) > longest_chain) blocks(b)%tied = .false.
         end do
      end do
      k = 0
      do pass = 0, longest_chain
         do row = 1, self%n
            if (level(self%own(row)) /= pass) cycle
            k = k + 1
            order(k) = row
         end do
      end do
      if (k == self%n) call sort_rows(self, order)
   end subroutine put_in_order

   subroutine sort_rows(self, order)
      type(tied_equations_type), intent(inout) :: self
      integer, intent(in) :: order(:)          !! (n)
      type(tied_equations_type) :: old
      integer :: i, m

      old = self
      self%row = old%row(order)
      self%own = old%own(order)
      self%own_share = old%own_share(order)
      do i = 1, self%n
         associate (from => old%first(order(i)), to => old%first(order(i) + 1) - 1)
            m = self%first(i) + to - from
            self%at(self%first(i):m) = old%at(from:to)
            self%share(self%first(i):m) = old%share(from:to)
            self%first(i + 1) = m + 1
         end associate
      end do
   end subroutine sort_rows

   !> All equations in those that are kept.
   subroutine find_terms(self, neq)
      type(tied_equations_type), intent(inout) :: self
      integer, intent(in) :: neq
      type(terms_type) :: of(self%n)
      integer :: number(neq), of_own(neq), i, k

      of_own = 0
      of_own(self%own) = [(i, i=1, self%n)]
      self%kept = pack([(i, i=1, neq)], of_own == 0)
      number = 0
      number(self%kept) = [(i, i=1, size(self%kept))]
      do i = 1, self%n
         of(i)%at = [integer ::]
         of(i)%value = [real(wp) ::]
         do k = self%first(i), self%first(i + 1) - 1
            call add_term(of(i), self%at(k), -self%share(k)/self%own_share(i))
         end do
      end do
      call lay_terms(self, neq, number, of_own, of)

   contains

      subroutine add_term(terms, equation, part)
         type(terms_type), intent(inout) :: terms
         integer, intent(in) :: equation
         real(wp), intent(in) :: part
         integer :: m

         if (of_own(equation) == 0) then
            call add(terms, number(equation), part)
            return
         end if
         associate (others => of(of_own(equation)))
            do m = 1, size(others%at)
               call add(terms, others%at(m), part*others%value(m))
            end do
         end associate
      end subroutine add_term

      subroutine add(terms, equation, part)
         type(terms_type), intent(inout) :: terms
         integer, intent(in) :: equation
         real(wp), intent(in) :: part
         integer :: j

         j = findloc(terms%at, equation, dim=1)
         if (j == 0) then
            terms%at = [terms%at, equation]
            terms%value = [terms%value, part]
         else
            terms%value(j) = terms%value(j) + part
         end if
      end subroutine add
   end subroutine find_terms

   !> E by the combinations of own equations.
   subroutine lay_terms(self, neq, number, of_own, of)
      type(tied_equations_type), intent(inout) :: self
      integer, intent(in) :: neq
      integer, intent(in) :: number(:)         !! (neq) place among those kept; 0: own
      integer, intent(in) :: of_own(:)         !! (neq) row; 0: kept
      type(terms_type), intent(in) :: of(:)    !! (n)
      integer :: i, m

      associate (e => self%terms)
         e%ndof = neq
         e%neq = size(self%kept)
         e%plain = .false.
         e%dof_of_equation = self%kept
         m = e%neq + sum([(size(of(i)%at), i=1, self%n)])
         if (allocated(e%first)) deallocate (e%first, e%equation, e%coefficient)
         allocate (e%first(neq + 1), e%equation(m), e%coefficient(m))
         m = 0
         do i = 1, neq
            e%first(i) = m + 1
            if (of_own(i) == 0) then
               m = m + 1
               e%equation(m) = number(i)
               e%coefficient(m) = 1.0_wp
            else
               associate (terms => of(of_own(i)))
                  e%equation(m + 1:m + size(terms%at)) = terms%at
                  e%coefficient(m + 1:m + size(terms%at)) = terms%value
                  m = m + size(terms%at)
               end associate
            end if
         end do
         e%first(neq + 1) = m + 1
      end associate
   end subroutine lay_terms

   !> The matrix on the equations that are kept.
   subroutine take_out(self, matrix, kept)
      type(tied_equations_type), intent(in) :: self
      type(csc_type), intent(in) :: matrix
      type(csc_type), intent(out) :: kept
      integer :: i

      call reduce_matrix(matrix, self%terms, [(i, i=1, self%terms%neq)], self%terms%neq, kept)
   end subroutine take_out

   pure function vertices_of_kept(self, vertices) result(kept)
      type(tied_equations_type), intent(in) :: self
      type(vertices_type), intent(in) :: vertices      !! of all equations, or of none
      type(vertices_type) :: kept

      kept = vertices
      if (self%n == 0 .or. .not. allocated(vertices%of)) return
      kept%of = vertices%of(self%kept)
      kept%motion = vertices%motion(self%kept, :)
   end function vertices_of_kept

   !> Own equations from the others and the right-hand sides of their rows.
   pure subroutine give_own(self, right, v)
      type(tied_equations_type), intent(in) :: self
      real(wp), intent(in) :: right(:)         !! (n)
      real(wp), intent(inout) :: v(:)          !! (neq)
      integer :: i

      do i = 1, self%n
         associate (from => self%first(i), to => self%first(i + 1) - 1)
            v(self%own(i)) = (right(i) - dot_product(self%share(from:to), &
               & v(self%at(from:to))))/self%own_share(i)
         end associate
      end do
   end subroutine give_own

   !> Forces of own equations fall on the others: E^T.
   pure subroutine gather_kept(self, force, kept)
      type(tied_equations_type), intent(in) :: self
      real(wp), intent(inout) :: force(:)      !! (neq) those of own equations go
      real(wp), intent(out) :: kept(:)         !! (kept)
      real(wp) :: multiplier
      integer :: i

      do i = self%n, 1, -1
         call take_force(self, i, force, multiplier)
      end do
      kept = force(self%kept)
   end subroutine gather_kept

   !> Multipliers that leave nothing at their own equations. The force of a row on equations is
   !> minus its multiplier times its shares and its area.
   pure subroutine find_tied_forces(self, left, area, multiplier)
      type(tied_equations_type), intent(in) :: self
      real(wp), intent(inout) :: left(:)       !! (neq) right-hand sides without ties
      real(wp), intent(in) :: area(:)          !! (n) of the rows
      real(wp), intent(out) :: multiplier(:)   !! (n)
      integer :: i

      do i = self%n, 1, -1
         call take_force(self, i, left, multiplier(i))
      end do
      multiplier = -multiplier/area
   end subroutine find_tied_forces

   !> What one own equation bears, by its row.
   pure subroutine take_force(self, i, force, multiplier)
      type(tied_equations_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(inout) :: force(:)
      real(wp), intent(out) :: multiplier

      associate (from => self%first(i), to => self%first(i + 1) - 1, own => self%own(i))
         multiplier = force(own)/self%own_share(i)
         force(own) = 0.0_wp
         force(self%at(from:to)) = force(self%at(from:to)) - self%share(from:to)*multiplier
      end associate
   end subroutine take_force
end module lopin_tied_equations
