!> Rigid motions of all solids in the equations, for solvers that make coarse levels of a matrix:
!> what costs no strain must be there on every level.
module lopin_rigid_motions
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_constraints, only : constraints_type, axes_at
   use lopin_linear_solver, only : vertices_type
   implicit none
   private
   public :: find_vertices, axis_of

contains

   !> Equations of a node are one vertex, rotations of a reference node another.
   subroutine find_vertices(vertices, model, dofs, constraints)
      type(vertices_type), intent(out) :: vertices
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(constraints_type), intent(in) :: constraints
      integer :: i, d, raw
      real(wp) :: centre(3), length, axis(3), arm(3)

      d = model%mesh%ndim
      vertices%places = d
      allocate (vertices%of(constraints%neq))
      allocate (vertices%motion(constraints%neq, merge(6, 3, d == 3)), source=0.0_wp)
      centre = 0.0_wp
      centre(:d) = sum(model%mesh%x, dim=2)/model%mesh%nnode
      length = maxval(maxval(model%mesh%x, dim=2) - minval(model%mesh%x, dim=2))
      do i = 1, constraints%neq
         raw = constraints%dof_of_equation(i)
         associate (node => dofs%node(raw), dof => dofs%dof(raw))
            vertices%of(i) = merge(node, -node, dof <= 3)
            call axis_of(constraints, node, dof, axis)
            arm = 0.0_wp
            arm(:d) = (model%mesh%x(:, node) - centre(:d))/length
            if (d == 2 .and. dof > 3) then
               vertices%motion(i, 3) = 1.0_wp/length
            else if (d == 2) then
               vertices%motion(i, :) = [axis(1), axis(2), axis(2)*arm(1) - axis(1)*arm(2)]
            else if (dof > 3) then
               vertices%motion(i, 4:) = axis/length
            else
               vertices%motion(i, :3) = axis
               vertices%motion(i, 4:) = [axis(3)*arm(2) - axis(2)*arm(3), &
                  & axis(1)*arm(3) - axis(3)*arm(1), axis(2)*arm(1) - axis(1)*arm(2)]
            end if
         end associate
      end do
   end subroutine find_vertices

   !> Direction of a degree of freedom of a node.
   pure subroutine axis_of(constraints, node, dof, axis)
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: node, dof         !! dof: 1..6
      real(wp), intent(out) :: axis(3)
      integer :: axes, k

      k = merge(dof, dof - 3, dof <= 3)
      axes = axes_at(constraints, node, dof)
      axis = 0.0_wp
      axis(k) = 1.0_wp
      if (axes > 0) axis = constraints%axes(k, :, axes)
   end subroutine axis_of
end module lopin_rigid_motions
