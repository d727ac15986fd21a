!> What determines each variable of a step: prescribed displacements, rigid followers, equations.
!>
!> A rule names variables in the axes of their nodes (raw variables), which may have rules of their
!> own: lopin_constraints follows the chains.
module lopin_constraint_rules
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, location_type
   use lopin_text, only : to_text
   use lopin_model, only : model_type, step_type
   use lopin_dofs, only : dofs_type
   use lopin_rigid_motion, only : slopes_of_rotation
   implicit none
   private
   public :: rule_type, local_axes_type, new_local_axes, axes_at, new_rules, follower_rule, label_of

   !> How one raw variable (a dof in the axes of its node) is determined.
   type :: rule_type
      integer :: prescribed = 0   !! index into the step's prescribed list; 0: not prescribed
      logical :: dependent = .false.
      type(location_type) :: at
      integer, allocatable :: raw(:)            !! the variables it depends on
      real(wp), allocatable :: coefficient(:)
   end type rule_type

   !> The axes in which a node's dofs are prescribed, where they are not the global ones.
   type :: local_axes_type
      real(wp), allocatable :: axes(:, :, :)   !! (3, 3, nlocal) rows are local axes of a node
      integer, allocatable :: axes_of(:)       !! (nnode) index into axes; 0: global
      integer, allocatable :: rotation_axes_of(:)   !! (nnode) the same for dofs 4 to 6: the axes of
                                                    !! the ROT NODE, where a body has one
      real(wp), allocatable :: turn(:, :)      !! (3, nbody) rotations about which rigid bodies are
                                               !! linear [rad]
   end type local_axes_type

contains

   subroutine new_local_axes(self, model, turn)
      type(local_axes_type), intent(out) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in), optional :: turn(:, :)     !! (3, nbody) [rad]; absent: 0
      integer :: i

      allocate (self%axes_of(model%mesh%nnode), source=0)
      allocate (self%turn(3, size(model%rigid_body)), source=0.0_wp)
      if (present(turn)) self%turn = turn
      if (allocated(model%transform%node)) then
         self%axes = model%transform%axes
         do i = 1, size(model%transform%node)
            self%axes_of(model%transform%node(i)) = i
         end do
      else
         allocate (self%axes(3, 3, 0))
      end if
      self%rotation_axes_of = self%axes_of
      do i = 1, size(model%rigid_body)
         associate (body => model%rigid_body(i))
            if (body%rotation > 0) self%rotation_axes_of(body%reference) &
               & = self%axes_of(body%rotation)
         end associate
      end do
   end subroutine new_local_axes

   !> Index of the axes in which a dof of a node is given; 0: the global ones. Dofs 1 to 3 are one
   !> vector, dofs 4 to 6 another.
   pure integer function axes_at(self, node, dof) result(axes)
      class(local_axes_type), intent(in) :: self
      integer, intent(in) :: node, dof         !! dof: 1..6

      if (dof <= 3) then
         axes = self%axes_of(node)
      else
         axes = self%rotation_axes_of(node)
      end if
   end function axes_at

   !> The rule of every raw variable: prescribed, rigid follower, first term of an equation, or
   !> free.
   subroutine new_rules(rule, local, model, dofs, step, error)
      type(rule_type), allocatable, intent(out) :: rule(:)
      type(local_axes_type), intent(in) :: local
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
               & to_text(step%prescribed(i)%dof)//' that could be moved', step%prescribed(i)%at, &
               & help='a node needs an element or a rigid body; see lopin explain E0205')
            return
         end if
         rule(id)%prescribed = i
         rule(id)%at = step%prescribed(i)%at
      end do
      do body = 1, size(model%rigid_body)
         do k = 1, size(model%rigid_body(body)%node)
            call follow(rule, local, model, dofs, body, model%rigid_body(body)%node(k), error)
            if (allocated(error)) return
         end do
      end do
      do i = 1, size(model%equation)
         call use_equation(rule, model, dofs, i, error)
         if (allocated(error)) return
      end do
   end subroutine new_rules

   !> Displacement of a follower: u = u_ref + theta x (x - x_ref), as coefficients of the reference
   !> dofs.
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

   subroutine follow(rule, local, model, dofs, body, node, error)
      type(rule_type), intent(inout) :: rule(:)
      type(local_axes_type), intent(in) :: local
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: body, node
      type(error_type), allocatable, intent(out) :: error
      integer :: ndim, component, axis, id, axes
      real(wp) :: arm(3), share

      ndim = model%mesh%ndim
      arm = 0.0_wp
      associate (rigid => model%rigid_body(body))
         if (node == rigid%reference) return
         arm(:ndim) = model%mesh%x(:, node) - model%mesh%x(:, rigid%reference)
         do component = 1, ndim
            id = dofs%id(component, node)
            if (rule(id)%prescribed > 0 .or. rule(id)%dependent) then
               call raise(error, error_code%deck, 'E0403', 'node '//label_of(model, node)// &
                  & ' follows the rigid body of line '//to_text(rigid%at%line)// &
                  & ' and is also prescribed', rule(id)%at, help='move the reference node instead')
               return
            end if
            rule(id)%dependent = .true.
            rule(id)%at = rigid%at
            allocate (rule(id)%raw(0), rule(id)%coefficient(0))
            axes = local%axes_of(node)
            do axis = 1, ndim
               share = merge(1.0_wp, 0.0_wp, axis == component)
               if (axes > 0) share = local%axes(component, axis, axes)
               if (.not. abs(share) > 0.0_wp) cycle
               if (any(abs(local%turn(:, body)) > 0.0_wp)) then
                  call follow_turned(rule(id), local, dofs, rigid%reference, &
                     & share*turned_slopes(arm, ndim, local%turn(:, body), axis))
               else
                  call follow_along(rule(id), local, dofs, ndim, rigid%reference, arm, axis, share)
               end if
            end do
         end do
      end associate
   end subroutine follow

   !> Slopes of a follower's displacement along one global axis by the six dofs of the reference
   !> node, where the body has turned: u = u_ref + (R - 1)(x - x_ref).
   pure function turned_slopes(arm, ndim, turn, axis) result(slope)
      real(wp), intent(in) :: arm(3)           !! x - x_ref at the start [length]
      integer, intent(in) :: ndim, axis
      real(wp), intent(in) :: turn(3)          !! rotation vector; in 2D about z [rad]
      real(wp) :: slope(6), by_turn(3, 3)

      slope = 0.0_wp
      slope(axis) = 1.0_wp
      by_turn = slopes_of_rotation(turn, arm)
      slope(4:) = by_turn(axis, :)
      if (ndim == 2) slope(3:5) = 0.0_wp
   end function turned_slopes

   !> Add these slopes to the rule of a follower, in the raw variables of the reference node.
   subroutine follow_turned(rule, local, dofs, reference, slope)
      type(rule_type), intent(inout) :: rule
      type(local_axes_type), intent(in) :: local
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: reference
      real(wp), intent(in) :: slope(6)
      real(wp) :: raw(6)
      integer :: k

      associate (axes => local%axes_of(reference))
         raw = slope
         if (axes > 0) raw(:3) = matmul(local%axes(:, :, axes), slope(:3))
      end associate
      associate (axes => local%rotation_axes_of(reference))
         if (axes > 0) raw(4:) = matmul(local%axes(:, :, axes), slope(4:))
      end associate
      do k = 1, 6
         if (dofs%id(k, reference) == 0 .or. .not. abs(raw(k)) > 0.0_wp) cycle
         rule%raw = [rule%raw, dofs%id(k, reference)]
         rule%coefficient = [rule%coefficient, raw(k)]
      end do
   end subroutine follow_turned

   !> Add the follower's displacement along one global axis, in the raw variables of the reference
   !> node.
   subroutine follow_along(rule, local, dofs, ndim, reference, arm, axis, share)
      type(rule_type), intent(inout) :: rule
      type(local_axes_type), intent(in) :: local
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: ndim, reference, axis
      real(wp), intent(in) :: arm(3), share
      integer :: k, j, n, dof(3), axes, before
      real(wp) :: coefficient(3)

      call follower_rule(arm, ndim, axis, dof, coefficient, n)
      do k = 1, n
         axes = axes_at(local, reference, dof(k))
         before = merge(0, 3, dof(k) <= 3)
         if (axes == 0) then
            call add(dofs%id(dof(k), reference), share*coefficient(k))
         else
            do j = 1, 3
               call add(dofs%id(before + j, reference), &
                  & share*coefficient(k)*local%axes(j, dof(k) - before, axes))
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

   subroutine use_equation(rule, model, dofs, i, error)
      type(rule_type), intent(inout) :: rule(:)
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: i
      type(error_type), allocatable, intent(out) :: error
      integer :: id, k, m

      associate (eq => model%equation(i))
         id = dofs%id(eq%dof(1), eq%node(1))
         if (id == 0 .or. eq%coefficient(1) == 0.0_wp) then
            call raise(error, error_code%deck, 'E0403', 'the first term of the equation, node '// &
               & label_of(model, eq%node(1))//', cannot be eliminated', eq%at, &
               & help='give a node of an element and a coefficient that is not zero first')
            return
         end if
         if (rule(id)%prescribed > 0 .or. rule(id)%dependent) then
            call raise(error, error_code%deck, 'E0403', 'node '//label_of(model, eq%node(1))// &
               & ', dof '// &
               & to_text(eq%dof(1))// &
               & ' is eliminated by this equation and constrained a second time', eq%at, &
               & note='the other constraint is on line '//to_text(rule(id)%at%line), &
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

   !> The deck's number of a node.
   function label_of(model, node) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      character(len=:), allocatable :: text
      text = to_text(model%mesh%node_label(node))
   end function label_of
end module lopin_constraint_rules
