!> Linear constraints: every physical dof as a combination of free equations and prescribed values.
!>
!>    u_i = sum_k coefficient * v(equation) + sum_p coefficient * prescribed(p)
!>
!> Prescribed displacements, local axes, *EQUATION and rigid followers all end in this one form;
!> chains are resolved, cycles and contradictions are errors at the user's line.
module lopin_constraints
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, location_type
   use lopin_model, only : model_type, step_type
   use lopin_dofs, only : dofs_type
   implicit none
   private
   public :: constraints_type, new_constraints, expand, reduce, prescribed_part, rule_type, follower_rule
   public :: raw_displacement

   !> How one raw variable (a dof in the axes of its node) is determined.
   type :: rule_type
      integer :: prescribed = 0                 !! index into the step's prescribed list; 0: not prescribed
      logical :: dependent = .false.
      type(location_type) :: at
      integer, allocatable :: raw(:)            !! the variables it depends on
      real(wp), allocatable :: coefficient(:)
   end type rule_type

   type :: constraints_type
      integer :: ndof = 0, neq = 0, nprescribed = 0
      logical :: plain = .true.                 !! every dof is one free equation or one prescribed value
      integer, allocatable :: first(:), equation(:)           !! (ndof+1), free part by dof
      real(wp), allocatable :: coefficient(:)
      integer, allocatable :: pfirst(:), prescribed(:)        !! (ndof+1), prescribed part by dof
      real(wp), allocatable :: pcoefficient(:)
      integer, allocatable :: dof_of_equation(:)              !! (neq) the raw variable (physical number) that is free
      integer, allocatable :: dof_of_prescribed(:)            !! (nprescribed) the raw variable
      integer, allocatable :: entry_of_prescribed(:)          !! (nprescribed) index into step%prescribed
      real(wp), allocatable :: axes(:, :, :)                  !! (3, 3, nlocal) local axes of transformed nodes
      integer, allocatable :: axes_of(:)                      !! (nnode) index into axes; 0: global
      type(rule_type), allocatable :: rule(:)                 !! (ndof) how each raw variable is determined
   end type constraints_type

contains

   !> Constraints in force in a step.
   subroutine new_constraints(self, model, dofs, step, error)
      type(constraints_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      type(rule_type), allocatable :: rule(:)

      self%ndof = dofs%n
      call local_axes(self, model)
      call raw_rules(rule, self, model, dofs, step, error)
      if (allocated(error)) return
      call number_variables(self, rule)
      call resolve(self, rule, model, dofs, error)
      call move_alloc(rule, self%rule)
   end subroutine new_constraints

   subroutine local_axes(self, model)
      type(constraints_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i

      allocate (self%axes_of(model%mesh%nnode), source=0)
      if (allocated(model%transform%node)) then
         self%axes = model%transform%axes
         do i = 1, size(model%transform%node)
            self%axes_of(model%transform%node(i)) = i
         end do
         if (size(model%transform%node) > 0) self%plain = .false.
      else
         allocate (self%axes(3, 3, 0))
      end if
   end subroutine local_axes

   !> The rule of every raw variable: prescribed, rigid follower, first term of an equation, or free.
   subroutine raw_rules(rule, self, model, dofs, step, error)
      type(rule_type), allocatable, intent(inout) :: rule(:)
      type(constraints_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(step_type), intent(in) :: step
      type(error_type), allocatable, intent(out) :: error
      integer :: i, k, id, body

      allocate (rule(dofs%n))
      do i = 1, size(step%prescribed)
         id = dofs%id(step%prescribed(i)%dof, step%prescribed(i)%node)
         if (id == 0) then
            if (step%prescribed(i)%value == 0.0_wp) cycle
            call raise(error, error_code%deck, 'E0205', 'node '// &
               & label_of(model, step%prescribed(i)%node)//' has no degree of freedom '// &
               & number_text(step%prescribed(i)%dof)//' that could be moved', step%prescribed(i)%at, &
               & help='a node needs an element or a rigid body; see lopin explain E0205')
            return
         end if
         rule(id)%prescribed = i
         rule(id)%at = step%prescribed(i)%at
      end do
      do body = 1, size(model%rigid_body)
         do k = 1, size(model%rigid_body(body)%node)
            call follow(rule, self, model, dofs, body, model%rigid_body(body)%node(k), error)
            if (allocated(error)) return
         end do
      end do
      do i = 1, size(model%equation)
         call use_equation(rule, self, model, dofs, i, error)
         if (allocated(error)) return
      end do
   end subroutine raw_rules

   !> Displacement of a follower: u = u_ref + theta x (x - x_ref), as coefficients of the reference dofs.
   pure subroutine follower_rule(arm, ndim, component, dof, coefficient, n)
      real(wp), intent(in) :: arm(3)              !! x - x_ref [length]
      integer, intent(in) :: ndim, component
      integer, intent(out) :: dof(3)              !! dofs 1..6 of the reference node
      real(wp), intent(out) :: coefficient(3)
      integer, intent(out) :: n

      dof = 0
      coefficient = 0.0_wp
      dof(1) = component
      coefficient(1) = 1.0_wp
      n = 2
      if (ndim == 2) then
         dof(2) = 6
         coefficient(2) = merge(-arm(2), arm(1), component == 1)
         return
      end if
      n = 3
      select case (component)
      case (1)
         dof(2:3) = [5, 6]
         coefficient(2:3) = [arm(3), -arm(2)]
      case (2)
         dof(2:3) = [6, 4]
         coefficient(2:3) = [arm(1), -arm(3)]
      case (3)
         dof(2:3) = [4, 5]
         coefficient(2:3) = [arm(2), -arm(1)]
      end select
   end subroutine follower_rule

   subroutine follow(rule, self, model, dofs, body, node, error)
      type(rule_type), intent(inout) :: rule(:)
      type(constraints_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: body, node
      type(error_type), allocatable, intent(out) :: error
      integer :: ndim, component, axis, id, axes
      real(wp) :: arm(3), share

      self%plain = .false.
      ndim = model%mesh%ndim
      arm = 0.0_wp
      associate (rigid => model%rigid_body(body))
         if (node == rigid%reference) return
         arm(:ndim) = model%mesh%x(:, node) - model%mesh%x(:, rigid%reference)
         do component = 1, ndim
            id = dofs%id(component, node)
            if (rule(id)%prescribed > 0 .or. rule(id)%dependent) then
               call raise(error, error_code%deck, 'E0403', 'node '//label_of(model, node)// &
                  & ' follows the rigid body of line '//number_text(rigid%at%line)// &
                  & ' and is also prescribed', rule(id)%at, help='move the reference node instead')
               return
            end if
            rule(id)%dependent = .true.
            rule(id)%at = rigid%at
            allocate (rule(id)%raw(0), rule(id)%coefficient(0))
            axes = self%axes_of(node)
            do axis = 1, ndim
               share = merge(1.0_wp, 0.0_wp, axis == component)
               if (axes > 0) share = self%axes(component, axis, axes)
               if (share /= 0.0_wp) call follow_along(rule(id), self, dofs, ndim, rigid%reference, &
                  & arm, axis, share)
            end do
         end do
      end associate
   end subroutine follow

   !> Add the follower's displacement along one global axis, in the raw variables of the reference node.
   subroutine follow_along(rule, self, dofs, ndim, reference, arm, axis, share)
      type(rule_type), intent(inout) :: rule
      type(constraints_type), intent(in) :: self
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: ndim, reference, axis
      real(wp), intent(in) :: arm(3), share
      integer :: k, j, n, dof(3), axes
      real(wp) :: coefficient(3)

      call follower_rule(arm, ndim, axis, dof, coefficient, n)
      axes = self%axes_of(reference)
      do k = 1, n
         if (dof(k) > 3 .or. axes == 0) then
            call add(dofs%id(dof(k), reference), share*coefficient(k))
         else
            do j = 1, 3
               call add(dofs%id(j, reference), share*coefficient(k)*self%axes(j, dof(k), axes))
            end do
         end if
      end do

   contains

      subroutine add(raw, value)
         integer, intent(in) :: raw
         real(wp), intent(in) :: value
         if (raw == 0 .or. value == 0.0_wp) return
         rule%raw = [rule%raw, raw]
         rule%coefficient = [rule%coefficient, value]
      end subroutine add
   end subroutine follow_along

   subroutine use_equation(rule, self, model, dofs, i, error)
      type(rule_type), intent(inout) :: rule(:)
      type(constraints_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: i
      type(error_type), allocatable, intent(out) :: error
      integer :: id, k, m

      self%plain = .false.
      associate (eq => model%equation(i))
         id = dofs%id(eq%dof(1), eq%node(1))
         if (id == 0 .or. eq%coefficient(1) == 0.0_wp) then
            call raise(error, error_code%deck, 'E0403', 'the first term of the equation, node '// &
               & label_of(model, eq%node(1))//', cannot be eliminated', eq%at, &
               & help='give a node of an element and a coefficient that is not zero first')
            return
         end if
         if (rule(id)%prescribed > 0 .or. rule(id)%dependent) then
            call raise(error, error_code%deck, 'E0403', 'node '//label_of(model, eq%node(1))//', dof '// &
               & number_text(eq%dof(1))//' is eliminated by this equation and constrained a second time', eq%at, &
               & note='the other constraint is on line '//number_text(rule(id)%at%line), &
               & help='put another term of the equation first')
            return
         end if
         rule(id)%dependent = .true.
         rule(id)%at = eq%at
         allocate (rule(id)%raw(0), rule(id)%coefficient(0))
         do k = 2, size(eq%node)
            m = dofs%id(eq%dof(k), eq%node(k))
            if (m == 0) cycle
            rule(id)%raw = [rule(id)%raw, m]
            rule(id)%coefficient = [rule(id)%coefficient, -eq%coefficient(k)/eq%coefficient(1)]
         end do
      end associate
   end subroutine use_equation

   subroutine number_variables(self, rule)
      type(constraints_type), intent(inout) :: self
      type(rule_type), intent(in) :: rule(:)
      integer :: i

      self%nprescribed = count(rule%prescribed > 0)
      self%neq = count(rule%prescribed == 0 .and. .not. rule%dependent)
      self%dof_of_equation = pack([(i, i=1, size(rule))], rule%prescribed == 0 .and. .not. rule%dependent)
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
      integer :: i, k, id, axes, ne, np, longest

      longest = count(rule%dependent)
      allocate (equation_of(self%ndof), prescribed_of(self%ndof), source=0)
      equation_of(self%dof_of_equation) = [(i, i=1, self%neq)]
      prescribed_of(self%dof_of_prescribed) = [(i, i=1, self%nprescribed)]
      allocate (self%first(self%ndof + 1), self%pfirst(self%ndof + 1))
      allocate (self%equation(self%ndof), self%coefficient(self%ndof))
      allocate (self%prescribed(self%ndof), self%pcoefficient(self%ndof))
      self%first(1) = 1
      self%pfirst(1) = 1
      allocate (eq(64), pr(64), ce(64), cp(64))
      do i = 1, self%ndof
         ne = 0
         np = 0
         axes = 0
         if (dofs%dof(i) <= 3) axes = self%axes_of(dofs%node(i))
         if (axes == 0) then
            call follow_chain(i, 1.0_wp, 0)
         else
            do k = 1, 3
               id = dofs%id(k, dofs%node(i))
               if (id > 0) call follow_chain(id, self%axes(k, dofs%dof(i), axes), 0)
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
            call raise(error, error_code%deck, 'E0403', 'the constraint on dof '//number_text(dofs%dof(raw))// &
               & ' of node '//label_of(model, dofs%node(raw))//' depends on itself', rule(raw)%at, &
               & help='order the terms so that no chain closes')
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

      r = 0.0_wp
      do i = 1, self%ndof
         do k = self%first(i), self%first(i + 1) - 1
            r(self%equation(k)) = r(self%equation(k)) + self%coefficient(k)*f(i)
         end do
      end do
   end subroutine reduce

   !> Forces on the prescribed variables from forces on the physical dofs.
   pure subroutine prescribed_part(self, f, r)
      type(constraints_type), intent(in) :: self
      real(wp), intent(in) :: f(:)            !! (ndof)
      real(wp), intent(out) :: r(:)           !! (nprescribed)
      integer :: i, k

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
      integer :: node, dof, k, axes

      node = dofs%node(raw)
      dof = dofs%dof(raw)
      value = u(raw)
      if (dof > 3) return
      axes = self%axes_of(node)
      if (axes == 0) return
      value = 0.0_wp
      do k = 1, 3
         if (dofs%id(k, node) > 0) value = value + self%axes(dof, k, axes)*u(dofs%id(k, node))
      end do
   end function raw_displacement

   function label_of(model, node) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      character(len=:), allocatable :: text
      text = number_text(model%mesh%node_label(node))
   end function label_of

   pure function number_text(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      character(len=12) :: buffer
      write (buffer, '(i0)') i
      text = trim(buffer)
   end function number_text
end module lopin_constraints
