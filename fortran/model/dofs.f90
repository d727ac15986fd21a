!> Physical dofs: which node has which, and their numbers.
!>
!> Nodes of deformable elements and followers of rigid bodies have translations; a reference node
!> has its translations and rotations; other nodes have the dofs that equations name. A rotation
!> node is another name for the rotations of its reference node.
module lopin_dofs
   use lopin_model, only : model_type, kind_of
   implicit none
   private
   public :: dofs_type, new_dofs

   type :: dofs_type
      integer :: n = 0
      integer, allocatable :: id(:, :)    !! (6, nnode) number of dof 1..6 of a node; 0: none
      integer, allocatable :: node(:)     !! (n) node of a dof; the reference node for rotations
      integer, allocatable :: dof(:)      !! (n) 1..6
      logical, allocatable :: alone(:)    !! (nnode) of no element and no body: only in equations
      logical :: rotate = .false.         !! some are rotations
   end type dofs_type

contains

   !> Numbers of the degrees of freedom of a model.
   subroutine new_dofs(self, model)
      type(dofs_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer :: i, k, node, body, ndim

      ndim = model%mesh%ndim
      allocate (self%id(6, model%mesh%nnode), source=0)
      do i = 1, model%mesh%nelement
         if (model%mesh%section(i) == 0) cycle
         do k = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(k, i) > 0) self%id(:ndim, model%mesh%conn(k, i)) = 1
         end do
      end do
      do body = 1, size(model%rigid_body)
         associate (rigid => model%rigid_body(body))
            do k = 1, size(rigid%node)
               self%id(:ndim, rigid%node(k)) = 1
            end do
            call mark_reference(self%id(:, rigid%reference), model%kind)
         end associate
      end do
      call mark_equations(self%id, self%alone, model)
      do node = 1, model%mesh%nnode
         do k = 1, 6
            if (self%id(k, node) == 0) cycle
            self%n = self%n + 1
            self%id(k, node) = self%n
         end do
      end do
      allocate (self%node(self%n), self%dof(self%n))
      do node = 1, model%mesh%nnode
         do k = 1, 6
            if (self%id(k, node) == 0) cycle
            self%node(self%id(k, node)) = node
            self%dof(self%id(k, node)) = k
         end do
      end do
      self%rotate = any(self%dof > 3)
      do body = 1, size(model%rigid_body)
         associate (rigid => model%rigid_body(body))
            if (rigid%rotation > 0) self%id(1:3, rigid%rotation) = self%id(4:6, rigid%reference)
         end associate
      end do
   end subroutine new_dofs

   !> A node of nothing else that an equation names carries what it is loaded by to the others.
   pure subroutine mark_equations(id, alone, model)
      integer, intent(inout) :: id(:, :)       !! (6, nnode)
      type(model_type), intent(in) :: model
      logical, allocatable, intent(out) :: alone(:)
      integer :: i, k

      alone = all(id == 0, dim=1)
      do i = 1, size(model%rigid_body)
         if (model%rigid_body(i)%rotation > 0) alone(model%rigid_body(i)%rotation) = .false.
      end do
      do i = 1, size(model%spring)
         do k = 1, 2
            associate (node => model%spring(i)%node(k))
               if (node == 0) cycle
               if (.not. alone(node)) cycle
               where (model%spring(i)%axial .or. model%spring(i)%direction(:model%mesh%ndim, k) &
                  & /= 0) id(:model%mesh%ndim, node) = 1
            end associate
         end do
      end do
      do i = 1, size(model%equation)
         associate (node => model%equation(i)%node, dof => model%equation(i)%dof)
            do k = 1, size(node)
               if (alone(node(k)) .and. dof(k) <= model%mesh%ndim) id(dof(k), node(k)) = 1
            end do
         end associate
      end do
   end subroutine mark_equations

   !> A rigid body moves along its plane's translations and turns about the axes that keep it in
   !> plane.
   pure subroutine mark_reference(id, kind)
      integer, intent(inout) :: id(6)
      integer, intent(in) :: kind

      select case (kind)
      case (kind_of%axisymmetric)
         id(2) = 1
      case (kind_of%solid)
         id = 1
      case default
         id([1, 2, 6]) = 1
      end select
   end subroutine mark_reference
end module lopin_dofs
