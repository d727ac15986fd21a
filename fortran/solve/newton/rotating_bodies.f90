!> Rigid bodies of nodes that turn far: their nodes follow on circles, not on tangents.
!>
!> The constraint u = u_ref + (R(rotation) - 1)(x - x_ref) is met exactly at every trial state, and
!> the linear constraints of the step are those of its slopes there: forces and tangents are reduced
!> by them. What a free rotation adds to the tangent, because the slopes turn too, is a local
!> matrix.
module lopin_rotating_bodies
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_constraints, only : constraints_type, new_constraints
   use lopin_rigid_motion, only : rotation_matrix, slopes_of_rotation
   use lopin_local_matrix, only : local_matrix_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: rotate_followers, has_rotating_bodies, rotation_tangents

   !> Step of the differences of slopes; their error is its square [rad].
   real(wp), parameter :: small_turn = 1.0e-4_wp

contains

   !> Some rigid body has nodes, and rotations are finite.
   pure logical function has_rotating_bodies(scene, model) result(has)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: body

      has = .false.
      if (.not. scene%newton%nlgeom) return
      do body = 1, size(model%rigid_body)
         has = has .or. size(model%rigid_body(body)%node) > 0
      end do
   end function has_rotating_bodies

   !> Put the followers where the rotations of the trial displacements put them.
   subroutine rotate_followers(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: turn(3, size(model%rigid_body)), rotation(3, 3), arm(3), moved(3)
      type(constraints_type) :: constraints
      integer :: body, i, k, ndim

      if (.not. has_rotating_bodies(scene, model)) return
      ndim = model%mesh%ndim
      do body = 1, size(model%rigid_body)
         turn(:, body) = of_node(scene, model%rigid_body(body)%reference, 3)
         associate (rigid => model%rigid_body(body))
            if (size(rigid%node) == 0) turn(:, body) = 0.0_wp
            rotation = rotation_matrix(turn(:, body))
            do i = 1, size(rigid%node)
               if (rigid%node(i) == rigid%reference) cycle
               arm = arm_of(model, body, i)
               moved = of_node(scene, rigid%reference, 0) + matmul(rotation, arm) - arm
               do k = 1, ndim
                  if (scene%dofs%id(k, rigid%node(i)) > 0) &
                     & scene%trial%motion%u(scene%dofs%id(k, rigid%node(i))) = moved(k)
               end do
            end do
         end associate
      end do
      if (.not. any(abs(turn - scene%constraints%turn) > 0.0_wp)) return
      call new_constraints(constraints, model, scene%dofs, model%step(scene%step), error, turn)
      if (.not. allocated(error)) scene%constraints = constraints
   end subroutine rotate_followers

   !> What the turning of the slopes adds to the tangent, from the forces out of balance.
   subroutine rotation_tangents(scene, model, residual, local)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: residual(:)      !! (ndof) [force]
      type(local_matrix_type), allocatable, intent(out) :: local(:)
      real(wp) :: k(3, 3)
      integer :: body, n

      allocate (local(size(model%rigid_body)))
      n = 0
      do body = 1, size(model%rigid_body)
         associate (rigid => model%rigid_body(body), id => scene%dofs%id)
            if (size(rigid%node) == 0) cycle
            if (.not. any(id(4:6, rigid%reference) > 0)) cycle
            call bend_of(scene, model, body, residual, k)
            n = n + 1
            associate (own => pack([4, 5, 6], id(4:6, rigid%reference) > 0))
               local(n)%dof = id(own, rigid%reference)
               local(n)%nu = size(own)
               local(n)%k = k(own - 3, own - 3)
               allocate (local(n)%spring(size(own), size(own)), source=0.0_wp)
            end associate
         end associate
      end do
      local = local(:n)
   end subroutine rotation_tangents

   !> Second slopes of the places of all followers times the forces there, by differences.
   subroutine bend_of(scene, model, body, residual, k)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      real(wp), intent(in) :: residual(:)
      real(wp), intent(out) :: k(3, 3)         !! [force*length]
      real(wp) :: turn(3), force(3), more(3), less(3)
      integer :: i, a, d

      k = 0.0_wp
      associate (rigid => model%rigid_body(body))
         turn = of_node(scene, rigid%reference, 3)
         do i = 1, size(rigid%node)
            force = 0.0_wp
            do d = 1, model%mesh%ndim
               if (scene%dofs%id(d, rigid%node(i)) > 0) force(d) = &
                  & residual(scene%dofs%id(d, rigid%node(i)))
            end do
            do a = 1, 3
               more = turn
               less = turn
               more(a) = more(a) + small_turn
               less(a) = less(a) - small_turn
               k(:, a) = k(:, a) + matmul(force, slopes_of_rotation(more, arm_of(model, body, i)) &
                  & - slopes_of_rotation(less, arm_of(model, body, i)))/(2.0_wp*small_turn)
            end do
         end do
      end associate
      k = 0.5_wp*(k + transpose(k))
   end subroutine bend_of

   !> From the reference node to a follower at the start [length].
   pure function arm_of(model, body, i) result(arm)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body, i
      real(wp) :: arm(3)

      arm = 0.0_wp
      associate (rigid => model%rigid_body(body))
         arm(:model%mesh%ndim) = model%mesh%x(:, rigid%node(i)) - model%mesh%x(:, rigid%reference)
      end associate
   end function arm_of

   !> Translations (0) or rotations (3) of a node at the trial displacements.
   pure function of_node(scene, node, behind) result(value)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: node, behind
      real(wp) :: value(3)
      integer :: k

      value = 0.0_wp
      do k = 1, 3
         if (scene%dofs%id(behind + k, node) > 0) value(k) = scene%trial%motion%u( &
            & scene%dofs%id(behind + k, node))
      end do
   end function of_node
end module lopin_rotating_bodies
