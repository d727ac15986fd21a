!> How supports lead the deformable bodies in an increment: a tool that stands while a strip is
!> pulled through it works as one that moves along the strip.
module lopin_led_bodies
   use lopin_kinds, only : wp
   use lopin_dense, only : symmetric_eigen
   use lopin_rigid_motions, only : axis_of
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: measure_led

   !> Directions in which supports hold less, beside the one they hold most, are free.
   real(wp), parameter :: none = 1.0e-6_wp

contains

   !> The translation that fits the ways of all supported dofs of a body best; 0 where it is free.
   subroutine measure_led(scene, way)
      type(scene_type), intent(in) :: scene
      real(wp), allocatable, intent(out) :: way(:, :)   !! (3, bodies) [length]
      real(wp), dimension(3, 3, scene%bodies%nbody) :: gram
      real(wp) :: axis(3), value(3)
      logical :: moves(scene%bodies%nbody)
      integer :: id, body, i, status

      allocate (way(3, scene%bodies%nbody), source=0.0_wp)
      gram = 0.0_wp
      moves = .false.
      do id = 1, scene%dofs%n
         if (scene%constraints%rule(id)%prescribed == 0 .or. scene%dofs%dof(id) > 3) cycle
         body = scene%bodies%body(scene%dofs%node(id))
         if (body == 0) cycle
         call axis_of(scene%constraints, scene%dofs%node(id), scene%dofs%dof(id), axis)
         associate (moved => dot_product(axis, motion_of(scene, scene%dofs%node(id))))
            way(:, body) = way(:, body) + moved*axis
            moves(body) = moves(body) .or. abs(moved) > 0.0_wp
         end associate
         gram(:, :, body) = gram(:, :, body) + spread(axis, 1, 3)*spread(axis, 2, 3)
      end do
      do body = 1, size(way, 2)
         if (.not. moves(body)) cycle
         call symmetric_eigen(gram(:, :, body), value, status)
         axis = way(:, body)
         way(:, body) = 0.0_wp
         do i = 1, 3
            if (status == 0 .and. value(i) > none*value(3)) way(:, body) = way(:, body) &
               & + dot_product(gram(:, i, body), axis)/value(i)*gram(:, i, body)
         end do
      end do
   end subroutine measure_led

   pure function motion_of(scene, node) result(moved)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: node
      real(wp) :: moved(3)                     !! in the increment [length]
      integer :: k

      moved = 0.0_wp
      do k = 1, 3
         associate (id => scene%dofs%id(k, node))
            if (id > 0) moved(k) = scene%trial%motion%u(id) - scene%accepted%motion%u(id)
         end associate
      end do
   end function motion_of
end module lopin_led_bodies
