!> Bodies and the motions that nothing holds: found before solving, from supports and constraints
!> alone.
!>
!> Every connected body has rigid motions, every rigid tool the motions of its reference node. What
!> is left of them under all constraints are the floating motions R. They are treated exactly: as
!> many artificial supports as motions make the stiffness definite, the amplitudes q are unknowns of
!> the contact problem, and at its solution the artificial supports carry nothing.
module lopin_bodies
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, kind_of
   use lopin_flat_elements, only : ring_bodies
   use lopin_dofs, only : dofs_type
   use lopin_constraints, only : constraints_type, axes_at
   use lopin_dense, only : symmetric_eigen
   implicit none
   private
   public :: bodies_type, new_bodies, connect

   !> Squared share of a motion that constraints must leave free for it to count as floating.
   real(wp), parameter :: floating_tolerance = 1.0e-12_wp

   type :: bodies_type
      integer :: nbody = 0                    !! connected deformable bodies
      integer :: nq = 0                       !! floating motions
      integer, allocatable :: body(:)         !! (nnode) deformable body of a node; 0: none
      real(wp), allocatable :: motion(:, :)   !! (neq, nq) R on the free equations
      real(wp), allocatable :: amplitude(:, :)   !! (ncolumn, nq) the same in motions of bodies and
                                                 !! tools
      integer, allocatable :: support(:)      !! (nq) equations supported artificially
      real(wp), allocatable :: centre(:, :)   !! (3, nbody) [length]
      real(wp) :: length = 1.0_wp             !! of the scene, scales rotations [length]
      integer :: nmode = 0                    !! rigid motions of a deformable body
      logical, allocatable :: ring(:)         !! (nbody) of an axisymmetric scene: moves along the
                                              !! axis alone
      integer, allocatable :: column(:, :)    !! (6, nrigid) column of each reference dof; 0: none
      integer, allocatable :: lone(:)         !! (ndof) column of a dof that only equations name
   end type bodies_type

contains

   !> The bodies of a model and the free motions that supports leave them.
   subroutine new_bodies(self, model, dofs, constraints)
      type(bodies_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer :: ncolumn

      call connect(self, model)
      call number_columns(self, model, dofs, ncolumn)
      call find_floating(self, model, dofs, constraints, ncolumn)
      call choose_supports(self)
   end subroutine new_bodies

   !> Connected bodies by shared nodes.
   subroutine connect(self, model)
      type(bodies_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, allocatable :: parent(:), number(:), members(:)
      integer :: e, k, node, root, other

      associate (mesh => model%mesh)
         allocate (parent(mesh%nnode), self%body(mesh%nnode), number(mesh%nnode), source=0)
         parent(:) = [(node, node=1, mesh%nnode)]
         do e = 1, mesh%nelement
            if (mesh%section(e) == 0) cycle
            call find_root(parent, mesh%conn(1, e), root)
            do k = 1, size(mesh%conn, 1)
               node = mesh%conn(k, e)
               if (node == 0) exit
               self%body(node) = -1
               call find_root(parent, node, other)
               parent(max(root, other)) = min(root, other)
               root = min(root, other)
            end do
         end do
         do node = 1, mesh%nnode
            if (self%body(node) == 0) cycle
            call find_root(parent, node, root)
            if (number(root) == 0) then
               self%nbody = self%nbody + 1
               number(root) = self%nbody
            end if
            self%body(node) = number(root)
         end do
         allocate (self%centre(3, self%nbody), members(self%nbody))
         self%centre = 0.0_wp
         members = 0
         do node = 1, mesh%nnode
            if (self%body(node) == 0) cycle
            associate (c => self%centre(:mesh%ndim, self%body(node)))
               c = c + mesh%x(:, node)
            end associate
            members(self%body(node)) = members(self%body(node)) + 1
         end do
         do k = 1, self%nbody
            self%centre(:, k) = self%centre(:, k)/members(k)
         end do
         self%length = 0.0_wp
         do node = 1, mesh%nnode
            if (self%body(node) == 0) cycle
            self%length = max(self%length, &
               & norm2(mesh%x(:, node) - self%centre(:mesh%ndim, self%body(node))))
         end do
         if (.not. self%length > 0.0_wp) self%length = 1.0_wp
      end associate
   end subroutine connect

   !> Root of a node in the forest, halving the way to it.
   subroutine find_root(parent, start, root)
      integer, intent(inout) :: parent(:)
      integer, intent(in) :: start
      integer, intent(out) :: root

      root = start
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end subroutine find_root

   subroutine number_columns(self, model, dofs, ncolumn)
      type(bodies_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(out) :: ncolumn
      integer :: i, k

      self%ring = ring_bodies(model, self%body, self%nbody)
      select case (model%kind)
      case (kind_of%axisymmetric)
         self%nmode = merge(1, 3, all(self%ring))
      case (kind_of%solid)
         self%nmode = 6
      case default
         self%nmode = 3
      end select
      ncolumn = self%nmode*self%nbody
      allocate (self%column(6, size(model%rigid_body)), source=0)
      do i = 1, size(model%rigid_body)
         ! Tools with one reference node are one body.
         k = findloc(model%rigid_body(:i)%reference, model%rigid_body(i)%reference, dim=1)
         if (k < i) then
            self%column(:, i) = self%column(:, k)
            cycle
         end if
         do k = 1, 6
            if (dofs%id(k, model%rigid_body(i)%reference) == 0) cycle
            ncolumn = ncolumn + 1
            self%column(k, i) = ncolumn
         end do
      end do
      allocate (self%lone(dofs%n), source=0)
      do i = 1, dofs%n
         if (.not. dofs%alone(dofs%node(i))) cycle
         ncolumn = ncolumn + 1
         self%lone(i) = ncolumn
      end do
   end subroutine number_columns

   !> Value of a raw variable per amplitude of each column that moves it; rotations are times
   !> `length`.
   subroutine raw_row(self, model, dofs, constraints, raw, column, value, n)
      type(bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: raw
      integer, intent(out) :: column(6), n
      real(wp), intent(out) :: value(6)
      integer :: node, dof, i, k, axes, before
      real(wp) :: axis(3)

      n = 0
      if (self%lone(raw) > 0) then
         n = 1
         column(1) = self%lone(raw)
         value(1) = 1.0_wp
         return
      end if
      node = dofs%node(raw)
      dof = dofs%dof(raw)
      before = merge(0, 3, dof <= 3)
      axis = 0.0_wp
      axis(dof - before) = 1.0_wp
      axes = axes_at(constraints, node, dof)
      if (axes > 0) axis = constraints%axes(dof - before, :, axes)
      if (dof > 3) axis = axis/self%length
      do i = 1, size(self%column, 2)
         if (model%rigid_body(i)%reference /= node) cycle
         do k = 1, 3
            if (self%column(before + k, i) == 0 .or. .not. abs(axis(k)) > 0.0_wp) cycle
            n = n + 1
            column(n) = self%column(before + k, i)
            value(n) = axis(k)
         end do
         return
      end do
      if (self%body(node) > 0 .and. dof <= 3) call body_row(self, model, node, axis, column, &
         & value, n)
   end subroutine raw_row

   !> Displacement of a node of a deformable body along an axis, by the body's rigid motions.
   subroutine body_row(self, model, node, axis, column, value, n)
      type(bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp), intent(in) :: axis(3)
      integer, intent(out) :: column(6), n
      real(wp), intent(out) :: value(6)
      real(wp) :: arm(3)
      integer :: k

      arm = 0.0_wp
      arm(:model%mesh%ndim) = model%mesh%x(:, node)
      arm = (arm - self%centre(:, self%body(node)))/self%length
      n = self%nmode
      column(:n) = [(self%nmode*(self%body(node) - 1) + k, k=1, n)]
      select case (self%nmode)
      case (1)
         value(1) = axis(2)
      case (3)
         value(:3) = [axis(1), axis(2), axis(2)*arm(1) - axis(1)*arm(2)]
         if (self%ring(self%body(node))) value([1, 3]) = 0.0_wp
      case (6)
         value(:3) = axis
         value(4:) = [axis(3)*arm(2) - axis(2)*arm(3), axis(1)*arm(3) - axis(3)*arm(1), &
            & axis(2)*arm(1) - axis(1)*arm(2)]
      end select
   end subroutine body_row

   !> What springs hold: the displacements of their nodes along them.
   subroutine add_springs(self, model, dofs, constraints, gram)
      type(bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(inout) :: gram(:, :)
      real(wp) :: row(size(gram, 1)), most
      integer :: s, k, m

      do s = 1, size(model%spring)
         row = 0.0_wp
         associate (spring => model%spring(s))
            do k = 1, 2
               if (spring%node(k) == 0) cycle
               call add_node(spring%node(k), merge(-1, 1, k == 1)*spring%direction(:, k))
            end do
         end associate
         most = maxval(abs(row))
         if (.not. most > 0.0_wp) cycle
         row = row/most
         do m = 1, size(row)
            gram(:, m) = gram(:, m) + row*row(m)
         end do
      end do

   contains

      !> Axes of nodes turn with what their dofs mean: the row is by global components.
      subroutine add_node(node, g)
         integer, intent(in) :: node
         real(wp), intent(in) :: g(3)
         integer :: i, j, n, at, axes, column(6)
         real(wp) :: value(6), part

         axes = axes_at(constraints, node, 1)
         do i = 1, model%mesh%ndim
            at = dofs%id(i, node)
            if (at == 0) cycle
            part = g(i)
            if (axes > 0) part = dot_product(constraints%axes(i, :, axes), g)
            call raw_row(self, model, dofs, constraints, at, column, value, n)
            do j = 1, n
               row(column(j)) = row(column(j)) + part*value(j)
            end do
         end do
      end subroutine add_node
   end subroutine add_springs

   !> A reference node that is also a node of a deformable body moves with both.
   subroutine join_references(self, model, gram)
      type(bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: gram(:, :)
      real(wp) :: row(size(gram, 1)), axis(3), value(6)
      integer :: i, k, m, n, column(6)

      do i = 1, size(model%rigid_body)
         associate (node => model%rigid_body(i)%reference)
            if (self%body(node) == 0) cycle
            do k = 1, model%mesh%ndim
               axis = 0.0_wp
               axis(k) = 1.0_wp
               call body_row(self, model, node, axis, column, value, n)
               row = 0.0_wp
               row(column(:n)) = value(:n)
               if (self%column(k, i) > 0) row(self%column(k, i)) = -1.0_wp
               do m = 1, size(row)
                  gram(:, m) = gram(:, m) + row*row(m)
               end do
            end do
         end associate
      end do
   end subroutine join_references

   !> Null space of all constraints on the motions of bodies and tools.
   subroutine find_floating(self, model, dofs, constraints, ncolumn)
      type(bodies_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: ncolumn
      real(wp), allocatable :: gram(:, :), eigenvalue(:), row(:)
      integer :: raw, i, k, n, column(6), status
      real(wp) :: value(6), size_
      integer, allocatable :: touched(:)

      allocate (gram(ncolumn, ncolumn), eigenvalue(ncolumn), row(ncolumn), source=0.0_wp)
      do raw = 1, dofs%n
         associate (rule => constraints%rule(raw))
            if (rule%prescribed == 0 .and. .not. rule%dependent) cycle
            call raw_row(self, model, dofs, constraints, raw, column, value, n)
            if (n == 0) cycle
            ! A rotation that is held counts as the displacement that it holds: no constraint may
            ! look weak because lengths are large numbers.
            size_ = maxval(abs(value(:n)))
            row(column(:n)) = value(:n)
            touched = column(:n)
            if (rule%dependent) then
               do k = 1, size(rule%raw)
                  call raw_row(self, model, dofs, constraints, rule%raw(k), column, value, n)
                  if (n > 0) size_ = max(size_, maxval(abs(rule%coefficient(k)*value(:n))))
                  call add_terms(row, column(:n), -rule%coefficient(k)*value(:n))
                  touched = [touched, column(:n)]
               end do
            end if
            ! Axes of nodes make several terms touch one column.
            touched = pack(touched, [(all(touched(:k - 1) /= touched(k)), k=1, size(touched))])
            if (size_ > 0.0_wp) row(touched) = row(touched)/size_
            do k = 1, size(touched)
               gram(:, touched(k)) = gram(:, touched(k)) + row*row(touched(k))
            end do
            row(touched) = 0.0_wp
         end associate
      end do
      call add_springs(self, model, dofs, constraints, gram)
      call join_references(self, model, gram)
      if (self%nmode == 3) then
         do i = 1, self%nbody
            if (.not. self%ring(i)) cycle
            do k = 3*i - 2, 3*i, 2
               gram(k, k) = gram(k, k) + 1.0_wp
            end do
         end do
      end if
      call symmetric_eigen(gram, eigenvalue, status)
      self%nq = count(eigenvalue <= floating_tolerance*max(1.0_wp, maxval([0.0_wp, eigenvalue])))
      self%amplitude = gram(:, :self%nq)
      allocate (self%motion(constraints%neq, self%nq), source=0.0_wp)
      if (self%nq == 0) return
      do i = 1, constraints%neq
         call raw_row(self, model, dofs, constraints, constraints%dof_of_equation(i), column, &
            & value, n)
         self%motion(i, :) = matmul(value(:n), self%amplitude(column(:n), :))
      end do
   end subroutine find_floating

   !> A column may stand in several terms.
   pure subroutine add_terms(row, column, value)
      real(wp), intent(inout) :: row(:)
      integer, intent(in) :: column(:)
      real(wp), intent(in) :: value(:)
      integer :: j

      do j = 1, size(column)
         row(column(j)) = row(column(j)) + value(j)
      end do
   end subroutine add_terms

   !> Equations whose support stops every floating motion: the largest pivots, so that they stop it
   !> well.
   subroutine choose_supports(self)
      type(bodies_type), intent(inout) :: self
      real(wp), allocatable :: left(:, :), direction(:)
      integer :: i, k

      allocate (self%support(self%nq))
      left = self%motion
      do i = 1, self%nq
         self%support(i) = maxloc(sum(left**2, dim=2), dim=1)
         direction = left(self%support(i), :)/norm2(left(self%support(i), :))
         do k = 1, size(left, 1)
            left(k, :) = left(k, :) - dot_product(left(k, :), direction)*direction
         end do
      end do
   end subroutine choose_supports
end module lopin_bodies
