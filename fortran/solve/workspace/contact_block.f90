!> Exact matrices of contact points: on physical dofs, and reduced to free equations.
module lopin_contact_block
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type, storage
   use lopin_constraints, only : constraints_type
   use lopin_local_matrix, only : local_matrix_type, glue_type, turned_force
   implicit none
   private
   public :: block_type, reduce_block, set_spring, spring_of, rest_of, find_matrix, add_product, &
      & add_up_springs, entries_of, put_entries

   !> A local matrix on free equations and multipliers.
   type :: block_type
      integer, allocatable :: at(:)            !! equations of the contact, neq + its multipliers,
                                               !! and equations of what else it reads (areas)
      real(wp), allocatable :: k(:, :)
      integer :: nu = 0                        !! equations of the contact
      integer :: nrow = 0                      !! multipliers
      real(wp), allocatable :: spring(:, :)
      real(wp), allocatable :: reach(:, :)     !! (ndim, nu) of a point whose traction is unknown
      real(wp), allocatable :: firm(:, :)      !! (nu, nu) added to its spring in the factor
      real(wp) :: firmness(3) = 0.0_wp         !! of its rows, with it: times the springs
      real(wp), allocatable :: inner(:, :)     !! (ndim, ndim) with it: the inverse of c times what
                                               !! its rows see
      type(glue_type), allocatable :: glue     !! of a tie, which has no k
      real(wp), allocatable :: tangent(:, :)   !! (, nu) of a tie whose arm turns
      real(wp), allocatable :: share(:, :)     !! (ndim, nu) of a tie: rows without an arm
      integer :: own(3) = 0                    !! equation that each row gives: of its node; 0: none
      logical :: tied = .false.                !! the factor does without these
      ! a bound of shear that follows the stress of the solids: by_bound times what is read
      real(wp), allocatable :: by_bound(:)     !! (at); not allocated: none
      integer, allocatable :: read_at(:)       !! equations, one may stand more than once
      real(wp), allocatable :: read_slope(:)   !! in these
   end type block_type

contains

   !> T^T k T of one contact point.
   subroutine reduce_block(block, local, constraints, flat)
      type(block_type), intent(out) :: block
      type(local_matrix_type), intent(in) :: local
      type(constraints_type), intent(in) :: constraints
      logical, intent(in) :: flat
      integer :: i, n, m
      integer, allocatable :: at(:), from(:)
      real(wp), allocatable :: t(:, :), k(:, :)
      logical :: picks

      m = terms_of(local, constraints)
      allocate (at(m), from(m))
      allocate (t(size(local%dof), m), source=0.0_wp)
      n = 0
      picks = .true.
      do i = 1, size(local%dof)
         if (i == local%nu + 1) block%nu = n
         call put_dof(i, local%dof(i))
      end do
      if (size(local%dof) == local%nu) block%nu = n
      block%at = at(:n)
      block%nrow = count(at(:n) > constraints%neq)
      if (allocated(local%by_bound)) call reduce_bound(block, local, constraints, t(:, :n))
      if (allocated(local%glue)) then
         call reduce_glue()
         return
      end if
      k = local%k
      if (flat) call flatten(k, local, count(local%dof > constraints%ndof))
      if (picks) then
         block%k = k(from(:n), from(:n))
         block%spring = local%spring(from(:block%nu), from(:block%nu))
         if (allocated(local%reach)) block%reach = local%reach(:, from(:block%nu))
         return
      end if
      block%k = matmul(transpose(t(:, :n)), matmul(k, t(:, :n)))
      block%spring = matmul(transpose(t(:local%nu, :block%nu)), matmul(local%spring, &
         & t(:local%nu, :block%nu)))
      if (allocated(local%reach)) block%reach = matmul(local%reach, t(:local%nu, :block%nu))

   contains

      subroutine reduce_glue()
         block%glue = local%glue
         block%glue%turns = local%glue%turns .and. .not. flat
         call find_own(block, local, constraints)
         call take(local%reach, block%reach)
         call take(local%share, block%share)
         if (block%glue%turns) call take(local%tangent, block%tangent)
      end subroutine reduce_glue

      !> What is by displacements, if it is, by equations.
      subroutine take(row, reduced)
         real(wp), allocatable, intent(in) :: row(:, :)
         real(wp), allocatable, intent(inout) :: reduced(:, :)

         if (.not. allocated(row)) return
         if (picks) then
            reduced = row(:, from(:block%nu))
         else
            reduced = matmul(row, t(:local%nu, :block%nu))
         end if
      end subroutine take

      subroutine put_dof(row, dof)
         integer, intent(in) :: row, dof
         integer :: c

         if (dof > constraints%ndof) then
            call put(row, constraints%neq + dof - constraints%ndof, 1.0_wp)
            return
         end if
         do c = constraints%first(dof), constraints%first(dof + 1) - 1
            call put(row, constraints%equation(c), constraints%coefficient(c))
         end do
      end subroutine put_dof

      subroutine put(row, equation, coefficient)
         integer, intent(in) :: row, equation
         real(wp), intent(in) :: coefficient
         integer :: j

         j = findloc(at(:n), equation, dim=1)
         ! Nearly always T only leaves out what is held.
         picks = picks .and. j == 0 .and. abs(coefficient - 1.0_wp) <= 0.0_wp
         if (j == 0) then
            n = n + 1
            j = n
            at(n) = equation
            from(n) = row
         end if
         t(row, j) = t(row, j) + coefficient
      end subroutine put
   end subroutine reduce_block

   !> The equation that each linear row gives: where its node has one of its own.
   pure subroutine find_own(block, local, constraints)
      type(block_type), intent(inout) :: block
      type(local_matrix_type), intent(in) :: local
      type(constraints_type), intent(in) :: constraints
      integer :: k

      do k = 1, 3
         if (local%own(k) == 0) cycle
         associate (dof => local%dof(local%own(k)))
            associate (c => constraints%first(dof))
               if (constraints%first(dof + 1) /= c + 1) cycle
               if (constraints%dof_of_equation(constraints%equation(c)) == dof .and. &
                  & abs(constraints%coefficient(c) - 1.0_wp) <= 0.0_wp) block%own(k) = &
                  & constraints%equation(c)
            end associate
         end associate
      end do
   end subroutine find_own

   !> The spring of a tie, but for the rows that the factor is without; without any, none.
   pure subroutine set_spring(block)
      type(block_type), intent(inout) :: block
      real(wp) :: rest(size(block%reach, 1), size(block%reach, 2))

      rest = rest_of(block)
      if (any(abs(rest) > 0.0_wp)) block%spring = block%glue%weight &
         & *block%glue%c*matmul(transpose(rest), rest)
   end subroutine set_spring

   !> The spring of a point, that of a tie with all its rows.
   pure function spring_of(block) result(spring)
      type(block_type), intent(in) :: block
      real(wp), allocatable :: spring(:, :)

      if (allocated(block%glue)) then
         spring = block%glue%weight*block%glue%c*matmul(transpose(block%reach), block%reach)
      else
         spring = block%spring
      end if
   end function spring_of

   !> Rows of a tie that the factor is not without.
   pure function rest_of(block) result(rest)
      type(block_type), intent(in) :: block
      real(wp) :: rest(size(block%reach, 1), size(block%reach, 2))
      integer :: k

      rest = block%reach
      if (.not. block%tied) return
      do k = 1, size(rest, 1)
         if (block%own(k) > 0) rest(k, :) = 0.0_wp
      end do
   end function rest_of

   !> The dense matrix of a block.
   pure subroutine find_matrix(block, k)
      type(block_type), intent(in) :: block
      real(wp), allocatable, intent(out) :: k(:, :)

      if (.not. allocated(block%glue)) then
         k = block%k
         return
      end if
      associate (r => block%reach, g => block%glue, nu => block%nu, d => size(block%reach, 1))
         allocate (k(nu + d, nu + d))
         k(:nu, :nu) = g%weight*g%c*matmul(transpose(r), r)
         if (g%turns) k(:nu, :nu) = k(:nu, :nu) + matmul(transpose(block%tangent), &
            & matmul(g%turning(:d*(d - 1), :d*(d - 1)), block%tangent))
         k(:nu, nu + 1:) = -g%weight*transpose(r)
         k(nu + 1:, :nu) = r
         k(nu + 1:, nu + 1:) = g%give(:d, :d)
      end associate
   end subroutine find_matrix

   !> Add the product of a block, rows not yet as forces.
   pure subroutine add_product(block, x, y)
      type(block_type), intent(in) :: block
      real(wp), intent(in) :: x(:)
      real(wp), intent(inout) :: y(:)
      real(wp) :: s(3), u
      integer :: i, j, d

      associate (at => block%at, nu => block%nu)
         if (.not. allocated(block%glue)) then
            do j = 1, size(at)
               do i = 1, size(at)
                  y(at(i)) = y(at(i)) + block%k(i, j)*x(at(j))
               end do
            end do
            if (allocated(block%by_bound)) y(at) = y(at) + block%by_bound &
               & *dot_product(block%read_slope, x(block%read_at))
            return
         end if
         d = size(block%reach, 1)
         s = 0.0_wp
         do j = 1, nu
            u = x(at(j))
            s(:d) = s(:d) + block%reach(:, j)*u
         end do
         associate (l => x(at(nu + 1:nu + d)), g => block%glue)
            y(at(nu + 1:nu + d)) = y(at(nu + 1:nu + d)) + s(:d) + matmul(g%give(:d, :d), l)
            s(:d) = g%weight*(g%c*s(:d) - l)
         end associate
         do j = 1, nu
            y(at(j)) = y(at(j)) + dot_product(block%reach(:, j), s(:d))
         end do
         if (block%glue%turns) y(at(:nu)) = y(at(:nu)) + turned_force(block%glue, &
            & block%tangent, x(at(:nu)))
      end associate
   end subroutine add_product

   !> What a bound that follows the stress of the solids reads, in equations.
   pure subroutine reduce_bound(block, local, constraints, t)
      type(block_type), intent(inout) :: block
      type(local_matrix_type), intent(in) :: local
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: t(:, :)          !! (dofs, at)
      integer :: i, c, m

      block%by_bound = matmul(local%by_bound, t(:size(local%by_bound), :))
      m = 0
      do i = 1, size(local%read_dof)
         m = m + constraints%first(local%read_dof(i) + 1) - constraints%first(local%read_dof(i))
      end do
      allocate (block%read_at(m), block%read_slope(m))
      m = 0
      do i = 1, size(local%read_dof)
         do c = constraints%first(local%read_dof(i)), constraints%first(local%read_dof(i) + 1) - 1
            m = m + 1
            block%read_at(m) = constraints%equation(c)
            block%read_slope(m) = local%read_slope(i)*constraints%coefficient(c)
         end do
      end do
   end subroutine reduce_bound

   !> Terms of all degrees of freedom of a contact in the equations.
   pure integer function terms_of(local, constraints) result(m)
      type(local_matrix_type), intent(in) :: local
      type(constraints_type), intent(in) :: constraints
      integer :: i

      m = 0
      do i = 1, size(local%dof)
         m = m + 1
         if (local%dof(i) <= constraints%ndof) m = m - 1 + constraints%first(local%dof(i) + 1) &
            & - constraints%first(local%dof(i))
      end do
   end function terms_of

   !> Forces by the springs alone, as if normals stood still.
   pure subroutine flatten(k, local, rows)
      real(wp), intent(inout) :: k(:, :)
      type(local_matrix_type), intent(in) :: local
      integer, intent(in) :: rows              !! of multipliers

      k(:local%nu, :local%nu) = local%spring
      if (allocated(local%flat_row)) then
         if (all(shape(local%flat_row) == [rows, local%nu])) &
            & k(local%nu + 1:local%nu + rows, :local%nu) = local%flat_row
      end if
      k(:, local%nu + rows + 1:) = 0.0_wp
   end subroutine flatten

   !> Entries of the whole matrix that a contact brings.
   pure integer function entries_of(block) result(n)
      type(block_type), intent(in) :: block

      n = size(block%at)**2
      if (allocated(block%by_bound)) n = n + size(block%at)*size(block%read_at)
   end function entries_of

   !> These entries; rows of multipliers not yet as forces.
   pure subroutine put_entries(block, row, column, value)
      type(block_type), intent(in) :: block
      integer, intent(out) :: row(:), column(:)
      real(wp), intent(out) :: value(:)
      real(wp), allocatable :: k(:, :)
      integer :: n, i, j

      call find_matrix(block, k)
      n = 0
      do j = 1, size(block%at)
         do i = 1, size(block%at)
            n = n + 1
            row(n) = block%at(i)
            column(n) = block%at(j)
            value(n) = k(i, j)
         end do
      end do
      if (.not. allocated(block%by_bound)) return
      do j = 1, size(block%read_at)
         do i = 1, size(block%at)
            n = n + 1
            row(n) = block%at(i)
            column(n) = block%read_at(j)
            value(n) = block%by_bound(i)*block%read_slope(j)
         end do
      end do
   end subroutine put_entries
   !> The springs of all contacts.
   subroutine add_up_springs(blocks, neq, springs)
      type(block_type), intent(in) :: blocks(:)
      integer, intent(in) :: neq                 !! equations
      type(csc_type), intent(out) :: springs     !! lower triangle
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
      integer :: total, b, i, j

      total = 0
      do b = 1, size(blocks)
         if (allocated(blocks(b)%spring)) total = total + (blocks(b)%nu*(blocks(b)%nu + 1))/2
      end do
      allocate (row(total), column(total), value(total))
      total = 0
      do b = 1, size(blocks)
         associate (block => blocks(b))
            if (.not. allocated(block%spring)) cycle
            do j = 1, block%nu
               do i = j, block%nu
                  total = total + 1
                  row(total) = max(block%at(i), block%at(j))
                  column(total) = min(block%at(i), block%at(j))
                  value(total) = block%spring(i, j)
                  if (allocated(block%firm)) value(total) = value(total) + block%firm(i, j)
               end do
            end do
         end associate
      end do
      call springs%new_from_triplets(neq, storage%symmetric_lower, row, column, value)
   end subroutine add_up_springs
end module lopin_contact_block
