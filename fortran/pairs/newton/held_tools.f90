!> Tools whose motion is given, at least how they turn: rows need no slopes in what is not solved
!> for, once what is prescribed has been applied.
module lopin_held_tools
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_constraints, only : constraints_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_slip_increment, only : forget_sliding
   implicit none
   private
   public :: find_held_tools, start_motion

contains

   !> By the supports of the step and what they move in the increment.
   pure subroutine find_held_tools(self, model, constraints, moved)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: moved(:)         !! (ndof) by prescribed values
      logical :: is_held(6)
      integer :: pair, k

      do pair = 1, size(self%masters%of)
         associate (m => self%masters%of(pair))
            m%held = m%tool > 0
            m%turns = .false.
            if (m%tool == 0 .or. m%body == 0) cycle
            do k = 1, 6
               associate (dof => self%dofs%id(k, model%rigid_body(m%body)%reference))
                  is_held(k) = dof == 0
                  if (dof == 0) cycle
                  is_held(k) = constraints%first(dof + 1) == constraints%first(dof)
                  if (k > 3) m%turns = m%turns .or. abs(moved(dof)) > 0.0_wp
               end associate
            end do
            m%held = all(is_held)
            m%floats = .not. all(is_held(4:))
         end associate
      end do
   end subroutine find_held_tools

   !> What is prescribed is still to come, and no point slides yet.
   pure subroutine start_motion(self)
      type(nonlinear_contact_type), intent(inout) :: self

      call forget_sliding(self)
      self%has_arrived = .false.
   end subroutine start_motion
end module lopin_held_tools
