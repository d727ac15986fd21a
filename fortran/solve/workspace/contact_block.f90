!> Exact matrices of contact points: on physical dofs, and reduced to free equations.
module lopin_contact_block
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type, storage
   use lopin_constraints, only : constraints_type
   use lopin_local_matrix, only : local_matrix_type
   implicit none
   private
   public :: block_type, reduce_block, add_up_springs, apply_locals, entries_of, put_entries

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
      real(wp), allocatable :: inner(:, :)     !! (ndim, ndim) with it: the inverse of c times what
                                               !! its rows see
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

   !> What the local matrices make of displacements (and no multipliers), on dofs and rows.
   subroutine apply_locals(nlocal, local, u, force)
      integer, intent(in) :: nlocal
      type(local_matrix_type), intent(in) :: local(:)
      real(wp), intent(in) :: u(:)               !! (ndof)
      real(wp), intent(inout) :: force(:)        !! (ndof + nmultiplier) added to
      integer :: i, j, m

      do i = 1, nlocal
         associate (l => local(i))
            ! A node of the facet may be one of the anchor too: its dof stands twice.
            do j = 1, size(l%dof)
               force(l%dof(j)) = force(l%dof(j)) + dot_product(l%k(j, :l%nu), u(l%dof(:l%nu)))
            end do
            if (allocated(l%by_bound)) then
               do j = 1, size(l%by_bound)
                  force(l%dof(j)) = force(l%dof(j)) + l%by_bound(j)*dot_product(l%read_slope, &
                     & u(l%read_dof))
               end do
            end if
            do j = l%nu + 1, size(l%dof)
               if (l%dof(j) > size(u)) cycle
               do m = 1, l%nu
                  force(l%dof(m)) = force(l%dof(m)) + l%k(m, j)*u(l%dof(j))
               end do
            end do
         end associate
      end do
   end subroutine apply_locals

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
      integer :: n, i, j

      n = 0
      do j = 1, size(block%at)
         do i = 1, size(block%at)
            n = n + 1
            row(n) = block%at(i)
            column(n) = block%at(j)
            value(n) = block%k(i, j)
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
         total = total + (blocks(b)%nu*(blocks(b)%nu + 1))/2
      end do
      allocate (row(total), column(total), value(total))
      total = 0
      do b = 1, size(blocks)
         associate (block => blocks(b))
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
