!> Ties whose slave nodes are eliminated: their displacements are combinations of those opposite.
!>
!> The vector row of a tied node is c u_slave + sum_m P_m u_m = 0. Where the matrix of the slave's
!> shares is diagonal, or triangular as with mid-side nodes of a transformed basis, the rows of a
!> pair give its slave displacements one by one; the rows then need no unknown force, and the
!> stiffness is reduced to the others by these constraints. The forces of the rows follow from the
!> residual of the slave nodes, which nothing but the ties can carry.
!>
!> A node stays a row with a force of its own where supports, equations, a rigid body or local axes
!> bear on it, where it meets another master as well, where the method of its pair gives way, where
!> its own share is small beside the others, and where ties depend on each other in long chains or
!> in circles.
module lopin_eliminated_ties
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_constraint_rules, only : rule_type
   use lopin_constraints, only : constraints_type, axes_at
   use lopin_contact_points, only : contact_points_type, pair_is_tied, is_released
   use lopin_contact_rows, only : contact_rows_type, new_eliminated_rows
   use lopin_initial_gaps, only : may_tie
   implicit none
   private
   public :: eliminate_ties, find_tie_forces

   !> The own share of a row is at least this much of its largest.
   real(wp), parameter :: strong = 0.1_wp
   !> Ties that depend on ties: mid-side nodes on corners, and these on the slaves of another pair.
   integer, parameter :: longest_chain = 4
   !> Shares below this, beside the largest, are rounding.
   real(wp), parameter :: rounded = 1.0e-15_wp

contains

   !> Choose the nodes, note them at the points, and give the rule of each of their dofs.
   subroutine eliminate_ties(points, model, dofs, constraints, own, rule)
      type(contact_points_type), intent(inout) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints   !! without ties
      integer, allocatable, intent(out) :: own(:)         !! dofs
      type(rule_type), allocatable, intent(out) :: rule(:)
      type(contact_rows_type) :: rows
      integer :: row, before

      allocate (own(0), rule(0))
      if (allocated(points%eliminated)) deallocate (points%eliminated)
      allocate (points%eliminated(points%n), source=.false.)
      call find_candidates(points, model, dofs, constraints)
      do
         before = count(points%eliminated)
         if (before == 0) return
         call new_eliminated_rows(rows, model, dofs, points)
         call leave_weak_rows(points, rows)
         call leave_long_chains(points, rows, dofs%n)
         if (count(points%eliminated) == before) exit
      end do
      deallocate (own, rule)
      allocate (own(rows%n), rule(rows%n))
      do row = 1, rows%n
         own(row) = rows%dof(rows%first(row))
         rule(row)%dependent = .true.
         rule(row)%at = model%pair(points%pair(rows%point(row)))%at
         call rule_of(rows, row, dofs, constraints, rule(row))
      end do
   end subroutine eliminate_ties

   !> Tied nodes that nothing else determines.
   subroutine find_candidates(points, model, dofs, constraints)
      type(contact_points_type), intent(inout) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer :: met(model%mesh%nnode), pair, i
      logical :: named(dofs%n)

      named = .false.
      do i = 1, dofs%n
         associate (rule => constraints%rule(i))
            named(i) = named(i) .or. rule%prescribed > 0 .or. rule%dependent
            if (rule%dependent) named(rule%raw) = .true.
         end associate
      end do
      met = 0
      do i = 1, points%n
         if (points%facet(i) > 0) met(points%node(i)) = met(points%node(i)) + 1
      end do
      do pair = 1, size(model%pair)
         if (.not. pair_is_tied(model, model%pair(pair))) cycle
         associate (method => model%interaction(model%pair(pair)%interaction)%method)
            if (.not. method%is_exact() .or. method%updates()) cycle
         end associate
         do i = points%first(pair), points%first(pair + 1) - 1
            if (points%facet(i) == 0) cycle
            if (.not. may_tie(points, i, model%pair(pair)%adjust)) cycle
            points%eliminated(i) = met(points%node(i)) == 1 &
               & .and. constraints%axes_of(points%node(i)) == 0 &
               & .and. is_open(points, i, dofs%id(:model%mesh%ndim, points%node(i)), named)
         end do
      end do
   end subroutine find_candidates

   !> No constraint names the dofs of a node, but those that its tie leaves out.
   pure logical function is_open(points, i, id, named)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      integer, intent(in) :: id(:)             !! (ndim) dofs of its node; 0: none
      logical, intent(in) :: named(:)          !! (ndof)
      integer :: k, released

      is_open = all(id > 0)
      if (.not. is_open) return
      released = 0
      do k = 1, size(id)
         if (is_released(points, i, k)) then
            released = released + 1
         else
            is_open = is_open .and. .not. named(id(k))
         end if
      end do
      if (allocated(points%released)) is_open = is_open &
         & .and. released == points%released(i) .and. released < size(id)
   end function is_open

   !> Rows that do not begin with a good share of their own dof.
   subroutine leave_weak_rows(points, rows)
      type(contact_points_type), intent(inout) :: points
      type(contact_rows_type), intent(in) :: rows
      integer :: row

      do row = 1, rows%n
         associate (c => rows%coefficient(rows%first(row):rows%first(row + 1) - 1))
            if (.not. abs(c(1)) >= strong*maxval(abs(c))) points%eliminated(rows%point(row)) &
               & = .false.
         end associate
      end do
   end subroutine leave_weak_rows

   !> Rows whose combinations lead through more rows than the longest chain, or back.
   subroutine leave_long_chains(points, rows, ndof)
      type(contact_points_type), intent(inout) :: points
      type(contact_rows_type), intent(in) :: rows
      integer, intent(in) :: ndof
      integer :: level(ndof), row, k, pass, most
      logical :: own(ndof), changed

      own = .false.
      own(rows%dof(rows%first(:rows%n))) = .true.
      level = 0
      do pass = 0, longest_chain
         changed = .false.
         do row = 1, rows%n
            most = 0
            do k = rows%first(row) + 1, rows%first(row + 1) - 1
               if (own(rows%dof(k))) most = max(most, level(rows%dof(k)) + 1)
            end do
            changed = changed .or. level(rows%dof(rows%first(row))) /= most
            level(rows%dof(rows%first(row))) = most
         end do
         if (.not. changed) return
      end do
      do row = 1, rows%n
         if (level(rows%dof(rows%first(row))) > longest_chain) &
            & points%eliminated(rows%point(row)) = .false.
      end do
   end subroutine leave_long_chains

   !> The dof of a row as a combination of the variables of its others, in the axes of their nodes.
   subroutine rule_of(rows, row, dofs, constraints, rule)
      type(contact_rows_type), intent(in) :: rows
      integer, intent(in) :: row
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      type(rule_type), intent(inout) :: rule
      integer :: k, c, axes, before
      real(wp) :: least, part

      rule%raw = [integer ::]
      rule%coefficient = [real(wp) ::]
      associate (from => rows%first(row), to => rows%first(row + 1) - 1)
         least = rounded*maxval(abs(rows%coefficient(from:to)))
         do k = from + 1, to
            if (.not. abs(rows%coefficient(k)) > least) cycle
            part = -rows%coefficient(k)/rows%coefficient(from)
            associate (node => dofs%node(rows%dof(k)), dof => dofs%dof(rows%dof(k)))
               axes = axes_at(constraints, node, dof)
               if (axes == 0) then
                  call add(rows%dof(k), part)
                  cycle
               end if
               before = merge(0, 3, dof <= 3)
               do c = 1, 3
                  call add(dofs%id(before + c, node), part*constraints%axes(c, dof - before, axes))
               end do
            end associate
         end do
      end associate

   contains

      subroutine add(raw, coefficient)
         integer, intent(in) :: raw
         real(wp), intent(in) :: coefficient

         if (raw == 0 .or. .not. abs(coefficient) > 0.0_wp) return
         rule%raw = [rule%raw, raw]
         rule%coefficient = [rule%coefficient, coefficient]
      end subroutine add
   end subroutine rule_of

   !> Forces of the rows that leave no residual at their own dofs: the rows on which others depend
   !> come after these.
   subroutine find_tie_forces(rows, residual, force)
      type(contact_rows_type), intent(in) :: rows
      real(wp), intent(in) :: residual(:)      !! (ndof) that ties must carry [force]
      real(wp), intent(inout) :: force(:)      !! (rows%n) those behind the solved ones are set
      real(wp) :: f(size(residual)), c, next
      integer :: row, pass
      logical :: changed

      force(rows%nsolved + 1:) = 0.0_wp
      do pass = 0, longest_chain
         f = 0.0_wp
         do row = rows%nsolved + 1, rows%n
            associate (from => rows%first(row) + 1, to => rows%first(row + 1) - 1)
               f(rows%dof(from:to)) = f(rows%dof(from:to)) &
                  & + rows%coefficient(from:to)*force(row)
            end associate
         end do
         changed = .false.
         do row = rows%nsolved + 1, rows%n
            c = rows%coefficient(rows%first(row))
            next = (residual(rows%dof(rows%first(row))) - f(rows%dof(rows%first(row))))/c
            changed = changed .or. abs(next - force(row)) > 0.0_wp
            force(row) = next
         end do
         if (.not. changed) return
      end do
   end subroutine find_tie_forces
end module lopin_eliminated_ties
