!> A node opposite a tool that does not turn while slopes are read: its forces and slopes.
!>
!> With the foot in the tool's frame (gap g, gradient or normal n, curvature H) and R the rotation
!> of the tool, the slopes by the place of the node are
!>
!>    dg/dx = R n,    d(R n)/dx = R H R^T,    d(arm)/dx = 1,
!>
!> and those by the place of the tool their opposites, asked for where that is solved for or still
!> to be prescribed. What else the tool bears follows from the force alone.
module lopin_tool_point
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, variable, constant, dual_dot, operator(-), operator(*), &
      & assignment(=)
   use lopin_local_matrix, only : local_matrix_type
   use lopin_rigid_motion, only : rigid_motion_type
   use lopin_tool, only : foot_type
   use lopin_contact_row, only : row_type, point_state_type, point_law_type
   use lopin_row_element, only : begin_row, press_row, last_block, end_row
   use lopin_contact_inputs, only : point_view_type
   implicit none
   private
   public :: evaluate_tool_point

   !> Where the components of places stand among the dofs; 0: held.
   type :: own_type
      integer :: slave(3) = 0, reference(3) = 0
   end type own_type

contains

   !> Forces on the node and what the tool bears; slopes in the places of the node and, if they are
   !> read, of the tool.
   subroutine evaluate_tool_point(state, local, point, law, reads_tool)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(point_view_type), intent(in) :: point
      type(point_law_type), intent(in) :: law
      logical, intent(in) :: reads_tool        !! the place of the tool is solved for, or to come
      type(dual_type) :: force(6), z(3)
      type(row_type) :: row
      type(own_type) :: own
      integer :: d, k

      d = point%model%mesh%ndim
      call list_own(local, point, law%first_row, reads_tool, own)
      row%ndim = d
      row%shift = law%shift
      row%weight = point%points%weight(point%i)
      row%has_rows = law%first_row > 0
      row%held_gap = point%anchor%gap
      call begin_row(row, local, size(local%dof), law%with_tangent)
      row%from = 0
      associate (x => point%masters%x(:, point%points%node(point%i)), &
         & motion => point%masters%of(point%points%pair(point%i))%motion)
         call measure(row, point%opposite%foot, motion, x, point%anchor%y, own)
         row%multiplier = constant(0.0_wp)
         do k = 1, d
            row%multiplier(k) = variable(law%lambda(k), merge(local%nu + k, 0, row%has_rows))
         end do
         call press_row(row, law)
         z = row%weight*row%z
         state%opening = row%gap%v
         state%beyond = 0.0_wp
         state%normal = row%normal%v
         state%traction = row%z%v
         call bear(state%reaction, motion, x, row%gap%v*row%normal%v, z%v)
      end associate
      do k = 1, d
         if (own%slave(k) > 0) force(own%slave(k)) = z(k)
         if (own%reference(k) == 0) cycle
         force(own%reference(k)) = (-1.0_wp)*z(k)
         state%reaction(k) = 0.0_wp
      end do
      if (.not. last_block(row, local, force(:local%nu))) error stop 'a row of more than one block'
      call end_row(state, local, row, law%enforcement, force(:local%nu))
   end subroutine evaluate_tool_point

   !> The dofs of the node, of the place of the tool if asked for, and multipliers.
   subroutine list_own(local, point, first_row, reads_tool, own)
      type(local_matrix_type), intent(inout) :: local
      type(point_view_type), intent(in) :: point
      integer, intent(in) :: first_row         !! of the multiplier; 0: none
      logical, intent(in) :: reads_tool
      type(own_type), intent(out) :: own
      integer :: dof(9), n, k, d, body

      d = point%model%mesh%ndim
      body = 0
      if (reads_tool) body = point%masters%of(point%points%pair(point%i))%body
      n = 0
      do k = 1, d
         call take(point%dofs%id(k, point%points%node(point%i)), own%slave(k))
      end do
      if (body > 0) then
         do k = 1, d
            call take(point%dofs%id(k, point%model%rigid_body(body)%reference), own%reference(k))
         end do
      end if
      local%nu = n
      if (first_row > 0) then
         dof(n + 1:n + d) = point%dofs%n + first_row + [(k, k=0, d - 1)]
         n = n + d
      end if
      local%dof = dof(:n)

   contains

      subroutine take(id, input)
         integer, intent(in) :: id             !! dof; 0: there is none
         integer, intent(inout) :: input

         if (id == 0) return
         n = n + 1
         dof(n) = id
         input = n
      end subroutine take
   end subroutine list_own

   !> Gap, normal and slip of the row with their slopes.
   subroutine measure(row, foot, motion, x, anchor, own)
      type(row_type), intent(inout) :: row
      type(foot_type), intent(in) :: foot      !! in the tool's frame
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)             !! (ndim) [length]
      real(wp), intent(in) :: anchor(3)        !! in the tool's frame [length]
      type(own_type), intent(in) :: own
      real(wp) :: gradient(3), bend(3, 3), arm(3)
      integer :: i

      associate (r => motion%rotation, d => size(x))
         gradient = matmul(r, merge(foot%gradient, foot%normal, foot%leans))
         bend = matmul(r, matmul(foot%hessian, transpose(r)))
         arm = 0.0_wp
         arm(:d) = x - motion%reference(:d) - motion%displacement(:d)
         arm = arm - matmul(r, anchor - motion%reference)
         row%gap = constant(foot%gap)
         row%normal%v = matmul(r, foot%normal)
         do i = 1, 3
            row%normal(i) = constant(row%normal(i)%v)
            row%arm(i) = constant(arm(i))
         end do
         call slope(own%slave(:d), 1.0_wp)
         call slope(own%reference(:d), -1.0_wp)
      end associate
      row%slip = row%arm - row%normal*dual_dot(row%arm, row%normal)

   contains

      subroutine slope(input, way)
         integer, intent(in) :: input(:)
         real(wp), intent(in) :: way           !! 1: of the node, -1: of the tool
         integer :: k, j

         do k = 1, size(input)
            if (input(k) == 0) cycle
            row%gap%d(input(k)) = way*gradient(k)
            row%arm(k)%d(input(k)) = way
            do j = 1, 3
               row%normal(j)%d(input(k)) = way*bend(j, k)
            end do
         end do
      end subroutine slope
   end subroutine measure

   !> Force and moment on the reference of the tool, at the foot of the point.
   pure subroutine bear(reaction, motion, x, lift, z)
      real(wp), intent(out) :: reaction(6)     !! force, moment [force], [force length]
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)             !! (ndim) [length]
      real(wp), intent(in) :: lift(3)          !! of the point above its foot [length]
      real(wp), intent(in) :: z(3)             !! on the point [force]
      real(wp) :: arm(3)

      arm = 0.0_wp
      arm(:size(x)) = x - motion%reference(:size(x)) - motion%displacement(:size(x))
      arm = arm - lift
      reaction(:3) = -z
      reaction(4:) = -[arm(2)*z(3) - arm(3)*z(2), arm(3)*z(1) - arm(1)*z(3), &
         & arm(1)*z(2) - arm(2)*z(1)]
   end subroutine bear
end module lopin_tool_point
