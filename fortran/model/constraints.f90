!> Linear constraints: every physical dof as a combination of free equations and prescribed values.
!>
!>    u_i = sum_k coefficient * v(equation) + sum_p coefficient * prescribed(p)
!>
!> Prescribed displacements, local axes, *EQUATION and rigid followers (lopin_constraint_rules) all
!> end in this one form; a chain of rules that closes is an error at the user's line.
module lopin_constraints
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type, step_type
   use lopin_dofs, only : dofs_type
   use lopin_constraint_rules, only : rule_type, local_axes_type, new_local_axes, axes_at, &
      & new_rules, label_of
   implicit none
   private
   public :: constraints_type, new_constraints, expand, reduce, reduce_bounds
   public :: prescribed_part, raw_displacement
   public :: axes_at

   type, extends(local_axes_type) :: constraints_type
      integer :: ndof = 0, neq = 0, nprescribed = 0
      logical :: plain = .true.   !! every dof is one free equation or one prescribed value
      integer, allocatable :: first(:), equation(:)           !! (ndof+1), free part by dof
      real(wp), allocatable :: coefficient(:)
      integer, allocatable :: pfirst(:), prescribed(:)        !! (ndof+1), prescribed part by dof
      real(wp), allocatable :: pcoefficient(:)
      integer, allocatable :: dof_of_equation(:)              !! (neq) the raw variable that is free
      integer, allocatable :: dof_of_prescribed(:)            !! (nprescribed) the raw variable
      integer, allocatable :: entry_of_prescribed(:)   !! (nprescribed) index into step%prescribed
      type(rule_type), allocatable :: rule(:)   !! (ndof) how each raw variable is determined
   end type constraints_type

contains

   !> Constraints in force in a step.
   subroutine new_constraints(self, model, dofs, step, error, turn, own, given)
      type(constraints_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: turn(:, :)     !! (3, nbody) of bodies; absent: 0 [rad]
      integer, intent(in), optional :: own(:)          !! free dofs with the rules of `given`
      type(rule_type), intent(in), optional :: given(:)
      type(rule_type), allocatable :: rule(:)

      self%ndof = dofs%n
      call new_local_axes(self%local_axes_type, model, turn)
      call new_rules(rule, self%local_axes_type, model, dofs, step, error)
      if (allocated(error)) return
      if (present(own)) rule(own) = given
      self%plain = .not. (any(rule%dependent) .or. any(self%axes_of > 0))
      call number_variables(self, rule)
      call resolve(self, rule, model, dofs, error)
      call move_alloc(rule, self%rule)
   end subroutine new_constraints

   subroutine number_variables(self, rule)
      type(constraints_type), intent(inout) :: self
      type(rule_type), intent(in) :: rule(:)
      integer :: i

      self%nprescribed = count(rule%prescribed > 0)
      self%neq = count(rule%prescribed == 0 .and. .not. rule%dependent)
      self%dof_of_equation = pack([(i, i=1, size(rule))], rule%prescribed == 0 &
         & .and. .not. rule%dependent)
      self%dof_of_prescribed = pack([(i, i=1, size(rule))], rule%prescribed > 0)
      self%entry_of_prescribed = pack(rule%prescribed, rule%prescribed > 0)
   end subroutine number_variables

   !> Write every physical dof in free equations and prescribed values.
   subroutine resolve(self, rule, model, dofs, error)
      type(constraints_type), intent(inout) :: self
      type(rule_type), intent(in) :: rule(:)
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: equation_of(:), prescribed_of(:), eq(:), pr(:)
      real(wp), allocatable :: ce(:), cp(:)
      integer :: i, k, id, axes, before, ne, np, longest

      longest = count(rule%dependent)
      allocate (equation_of(self%ndof), prescribed_of(self%ndof), source=0)
      equation_of(self%dof_of_equation) = [(i, i=1, self%neq)]
      prescribed_of(self%dof_of_prescribed) = [(i, i=1, self%nprescribed)]
      allocate (self%first(self%ndof + 1), self%pfirst(self%ndof + 1), source=1)
      allocate (self%equation(self%ndof), self%coefficient(self%ndof), &
         & self%prescribed(self%ndof), self%pcoefficient(self%ndof), eq(64), pr(64), ce(64), cp(64))
      do i = 1, self%ndof
         ne = 0
         np = 0
         axes = axes_at(self, dofs%node(i), dofs%dof(i))
         if (axes == 0) then
            call follow_chain(i, 1.0_wp, 0)
         else
            before = merge(0, 3, dofs%dof(i) <= 3)
            do k = 1, 3
               id = dofs%id(before + k, dofs%node(i))
               if (id > 0) call follow_chain(id, self%axes(k, dofs%dof(i) - before, axes), 0)
            end do
         end if
         if (allocated(error)) return
         call append(self%equation, self%coefficient, self%first(i), eq(:ne), ce(:ne))
         call append(self%prescribed, self%pcoefficient, self%pfirst(i), pr(:np), cp(:np))
         self%first(i + 1) = self%first(i) + ne
         self%pfirst(i + 1) = self%pfirst(i) + np
      end do

   contains

      recursive subroutine follow_chain(raw, factor, depth)
         integer, intent(in) :: raw, depth
         real(wp), intent(in) :: factor
         integer :: j

         if (allocated(error) .or. factor == 0.0_wp) return
         if (depth > longest) then
            call raise(error, error_code%deck, 'E0403', 'the constraint on dof '//to_text( &
               & dofs%dof(raw))//' of node '//label_of(model, dofs%node(raw))//' depends on '// &
               & 'itself', rule(raw)%at, help='order the terms so that no chain closes')
         else if (rule(raw)%dependent) then
            do j = 1, size(rule(raw)%raw)
               call follow_chain(rule(raw)%raw(j), factor*rule(raw)%coefficient(j), depth + 1)
            end do
         else if (rule(raw)%prescribed > 0) then
            call add_term(pr, cp, np, prescribed_of(raw), factor)
         else
            call add_term(eq, ce, ne, equation_of(raw), factor)
         end if
      end subroutine follow_chain
   end subroutine resolve

   !> Add a term to a short list, merging equal indices.
   subroutine add_term(index, value, n, i, factor)
      integer, allocatable, intent(inout) :: index(:)
      real(wp), allocatable, intent(inout) :: value(:)
      integer, intent(inout) :: n
      integer, intent(in) :: i
      real(wp), intent(in) :: factor
      integer :: k

      do k = 1, n
         if (index(k) /= i) cycle
         value(k) = value(k) + factor
         return
      end do
      if (n == size(index)) then
         index = [index, index]
         value = [value, value]
      end if
      n = n + 1
      index(n) = i
      value(n) = factor
   end subroutine add_term

   subroutine append(index, value, at, more, with)
      integer, allocatable, intent(inout) :: index(:)
      real(wp), allocatable, intent(inout) :: value(:)
      integer, intent(in) :: at, more(:)
      real(wp), intent(in) :: with(:)

      if (at - 1 + size(more) > size(index)) then
         index = [index, index, more]
         value = [value, value, with]
      end if
      index(at:at + size(more) - 1) = more
      value(at:at + size(more) - 1) = with
   end subroutine append

   !> Physical displacements from free equations and prescribed values.
   pure subroutine expand(self, v, prescribed, u)
      type(constraints_type), intent(in) :: self
      real(wp), intent(in) :: v(:)            !! (neq)
      real(wp), intent(in) :: prescribed(:)   !! (nprescribed)
      real(wp), intent(out) :: u(:)           !! (ndof)
      integer :: i, k

      if (self%plain) then
         ! A sum from zero, as below: it has no negative zeros.
         u(self%dof_of_equation) = 0.0_wp + v(:self%neq)
         u(self%dof_of_prescribed) = 0.0_wp + prescribed(:self%nprescribed)
         return
      end if
      do i = 1, self%ndof
         u(i) = 0.0_wp
         do k = self%first(i), self%first(i + 1) - 1
            u(i) = u(i) + self%coefficient(k)*v(self%equation(k))
         end do
         do k = self%pfirst(i), self%pfirst(i + 1) - 1
            u(i) = u(i) + self%pcoefficient(k)*prescribed(self%prescribed(k))
         end do
      end do
   end subroutine expand

   !> Forces on the free equations from forces on the physical dofs: the transpose of `expand`.
   pure subroutine reduce(self, f, r)
      type(constraints_type), intent(in) :: self
      real(wp), intent(in) :: f(:)            !! (ndof)
      real(wp), intent(out) :: r(:)           !! (neq)
      integer :: i, k

      if (self%plain) then
         r(:self%neq) = 0.0_wp + f(self%dof_of_equation)
         return
      end if
      r = 0.0_wp
      do i = 1, self%ndof
         do k = self%first(i), self%first(i + 1) - 1
            r(self%equation(k)) = r(self%equation(k)) + self%coefficient(k)*f(i)
         end do
      end do
   end subroutine reduce

   !> What errors of the forces on the physical dofs may make at the free equations: errors of
   !> either sign add up, whatever the signs of the coefficients are.
   pure subroutine reduce_bounds(self, bound, r)
      type(constraints_type), intent(in) :: self
      real(wp), intent(in) :: bound(:)        !! (ndof) sizes of errors
      real(wp), intent(out) :: r(:)           !! (neq)
      integer :: i, k

      if (self%plain) then
         r(:self%neq) = abs(bound(self%dof_of_equation))
         return
      end if
      r = 0.0_wp
      do i = 1, self%ndof
         do k = self%first(i), self%first(i + 1) - 1
            r(self%equation(k)) = r(self%equation(k)) + abs(self%coefficient(k)*bound(i))
         end do
      end do
   end subroutine reduce_bounds

   !> Forces on the prescribed variables from forces on the physical dofs.
   pure subroutine prescribed_part(self, f, r)
      type(constraints_type), intent(in) :: self
      real(wp), intent(in) :: f(:)            !! (ndof)
      real(wp), intent(out) :: r(:)           !! (nprescribed)
      integer :: i, k

      if (self%plain) then
         r(:self%nprescribed) = 0.0_wp + f(self%dof_of_prescribed)
         return
      end if
      r = 0.0_wp
      do i = 1, self%ndof
         do k = self%pfirst(i), self%pfirst(i + 1) - 1
            r(self%prescribed(k)) = r(self%prescribed(k)) + self%pcoefficient(k)*f(i)
         end do
      end do
   end subroutine prescribed_part

   !> Value of a raw variable: the displacement in the axes of its node.
   pure real(wp) function raw_displacement(self, dofs, u, raw) result(value)
      type(constraints_type), intent(in) :: self
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: u(:)            !! (ndof)
      integer, intent(in) :: raw
      integer :: node, dof, k, axes, before, id

      node = dofs%node(raw)
      dof = dofs%dof(raw)
      value = u(raw)
      axes = axes_at(self, node, dof)
      if (axes == 0) return
      before = merge(0, 3, dof <= 3)
      value = 0.0_wp
      do k = 1, 3
         id = dofs%id(before + k, node)
         if (id > 0) value = value + self%axes(dof - before, k, axes)*u(id)
      end do
   end function raw_displacement
end module lopin_constraints
