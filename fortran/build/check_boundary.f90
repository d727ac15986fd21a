!> Conflicts of the dofs that a step prescribes with equations, rigid bodies and other lines.
module lopin_check_boundary
   use lopin_error, only : location_type
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_block, only : complain
   use lopin_build_boundary, only : boundary_type
   use lopin_prescribed_twice, only : differ, note_clash, warn_of_clashes
   implicit none
   private
   public :: check_boundary

contains

   !> No dof is prescribed that an equation eliminates or a rigid body moves.
   subroutine check_boundary(self, model)
      type(boundary_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      integer :: owner(model%mesh%nnode), i, dof, node, k

      call find_turns(self, model)
      call warn_of_clashes(self%clashes, model, self%step)
      if (self%step == 0) return
      do i = 1, size(model%equation)
         node = model%equation(i)%node(1)
         dof = model%equation(i)%dof(1)
         if (dof < 1 .or. dof > 6) cycle
         k = self%slot(dof, node)
         if (k == 0) cycle
         if (is_new(self, k)) call twice(model, node, dof, 'by *BOUNDARY of line ' &
            & //to_text(self%item(k)%at%line) &
            & //' and by *EQUATION of line '//to_text(model%equation(i)%at%line), self%item(k)%at)
      end do
      owner = 0
      do i = 1, size(model%rigid_body)
         owner(model%rigid_body(i)%node) = i
      end do
      do i = 1, self%n
         node = self%item(i)%node
         if (owner(node) == 0 .or. .not. is_new(self, i)) cycle
         call twice(model, node, self%item(i)%dof, 'by *BOUNDARY of line ' &
            & //to_text(self%item(i)%at%line) &
            & //' and by *RIGID BODY of line '//to_text(model%rigid_body(owner(node))%at%line), &
            & self%item(i)%at)
         return
      end do
   end subroutine check_boundary

   subroutine twice(model, node, dof, by, at)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: node, dof
      character(len=*), intent(in) :: by
      type(location_type), intent(in) :: at

      call complain(model%log, 'E0403', 'dof '//to_text(dof)//' of node ' &
         & //to_text(model%mesh%node_label(node)) &
         & //' is constrained twice: '//by, at, &
         & help='remove one; the first term of an equation and the nodes ' &
         & //'of a rigid body are not free to be prescribed')
   end subroutine twice

   !> Said of a later step only what that step prescribes.
   pure logical function is_new(self, k)
      type(boundary_type), intent(in) :: self
      integer, intent(in) :: k
      is_new = self%since(k) == self%step .or. self%step == 1
   end function is_new

   !> Rotations are prescribed at the reference node and at the ROT NODE: they are the same dofs.
   pure subroutine find_turns(self, model)
      type(boundary_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i, dof, a, b

      do i = 1, size(model%rigid_body)
         associate (body => model%rigid_body(i))
            if (body%rotation == 0 .or. body%reference == 0) cycle
            do dof = 1, 3
               a = self%slot(dof + 3, body%reference)
               b = self%slot(dof, body%rotation)
               if (min(a, b) == 0) cycle
               if (max(self%since(a), self%since(b)) /= self%step) cycle
               if (differ(self%item(a), self%item(b))) call note_clash(self%clashes, &
                  & self%item(min(a, b)), self%item(max(a, b)))
            end do
         end associate
      end do
   end subroutine find_turns
end module lopin_check_boundary
