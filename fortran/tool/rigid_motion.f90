!> Motion of a rigid tool: exact, finite rotation about a reference point that moves.
!>
!> A point y of the tool frame (the global frame at time 0) is now at
!>     x = X_ref + u_ref + R(rotation) (y - X_ref).
!> In 2D the rotation is one angle about z, in 3D a rotation vector (axis times angle), in radians.
module lopin_rigid_motion
   use lopin_kinds, only : wp
   implicit none
   private
   public :: rigid_motion_type, new_rigid_motion, rigid_motion, rotation_matrix, slopes_of_rotation

   type :: rigid_motion_type
      integer :: ndim = 3
      real(wp) :: reference(3) = 0.0_wp !! X_ref, place of the reference node at time 0 [length]
      real(wp) :: displacement(3) = 0.0_wp   !! u_ref [length]
      real(wp) :: rotation(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
         & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])  !! R
   contains
      procedure :: to_global
      procedure :: to_tool
      procedure :: turn
   end type rigid_motion_type

contains

   !> A motion by displacement and rotation vector of a reference point.
   pure subroutine new_rigid_motion(self, reference, displacement, rotation)
      type(rigid_motion_type), intent(out) :: self
      real(wp), intent(in) :: reference(:)      !! (ndim) [length]
      real(wp), intent(in) :: displacement(:)   !! (ndim) [length]
      real(wp), intent(in) :: rotation(:)       !! (1) in 2D, (3) in 3D [radian]; (0): none

      self%ndim = size(reference)
      self%reference(:self%ndim) = reference
      self%displacement(:self%ndim) = displacement
      if (size(rotation) > 0) self%rotation = rotation_matrix(rotation)
   end subroutine new_rigid_motion

   !> Where a point of the tool frame is now.
   pure function to_global(self, y) result(x)
      class(rigid_motion_type), intent(in) :: self
      real(wp), intent(in) :: y(:)   !! (ndim) [length]
      real(wp) :: x(size(y))
      integer :: n

      n = size(y)
      x = self%reference(:n) + self%displacement(:n) + self%turn(y - self%reference(:n))
   end function to_global

   !> The point of the tool frame that is now at x.
   pure function to_tool(self, x) result(y)
      class(rigid_motion_type), intent(in) :: self
      real(wp), intent(in) :: x(:)   !! (ndim) [length]
      real(wp) :: y(size(x))
      real(wp) :: arm(size(x))
      integer :: n, i

      n = size(x)
      arm = x - self%reference(:n) - self%displacement(:n)
      do i = 1, n
         y(i) = self%reference(i) + dot_product(self%rotation(:n, i), arm)
      end do
   end function to_tool

   !> A direction of the tool frame, turned to where it points now.
   pure function turn(self, direction) result(turned)
      class(rigid_motion_type), intent(in) :: self
      real(wp), intent(in) :: direction(:)   !! (ndim)
      real(wp) :: turned(size(direction))
      integer :: i, n

      n = size(direction)
      do i = 1, n
         turned(i) = dot_product(self%rotation(i, :n), direction)
      end do
   end function turn

   !> Move one point: the same as building a motion and calling `to_global`.
   pure function rigid_motion(reference, displacement, rotation, x) result(moved)
      real(wp), intent(in) :: reference(:)      !! (ndim) [length]
      real(wp), intent(in) :: displacement(:)   !! (ndim) [length]
      real(wp), intent(in) :: rotation(:)       !! (0), (1) or (3) [radian]
      real(wp), intent(in) :: x(:)              !! (ndim) [length]
      real(wp) :: moved(size(x))
      type(rigid_motion_type) :: motion

      call new_rigid_motion(motion, reference, displacement, rotation)
      moved = motion%to_global(x)
   end function rigid_motion

   !> Rodrigues' formula with the half angle: no loss of digits for small rotations.
   pure function rotation_matrix(rotation) result(matrix)
      real(wp), intent(in) :: rotation(:)   !! (1) about z, or (3) [radian]
      real(wp) :: matrix(3, 3)
      real(wp) :: v(3), angle, a, b, w(3, 3)
      integer :: i

      v = 0.0_wp
      if (size(rotation) == 1) then
         v(3) = rotation(1)
      else
         v = rotation(:3)
      end if
      matrix = 0.0_wp
      do i = 1, 3
         matrix(i, i) = 1.0_wp
      end do
      angle = norm2(v)
      if (.not. angle > 0.0_wp) return
      a = sin(angle)/angle
      b = 2.0_wp*(sin(0.5_wp*angle)/angle)**2
      w = reshape([0.0_wp, v(3), -v(2), -v(3), 0.0_wp, v(1), v(2), -v(1), 0.0_wp], [3, 3])
      matrix = matrix + a*w + b*matmul(w, w)
   end function rotation_matrix

   !> Slopes of R(v) a by the rotation vector v: -R [a] J, J = 1 - (1 - cos t)/t^2 [v]
   !> + (t - sin t)/t^3 [v]^2, where [a] b = a x b.
   pure function slopes_of_rotation(v, a) result(slope)
      real(wp), intent(in) :: v(3)             !! [radian]
      real(wp), intent(in) :: a(3)
      real(wp) :: slope(3, 3), j(3, 3), t
      real(wp), parameter :: small = 1.0e-3_wp
      integer :: k

      t = norm2(v)
      if (t > small) then
         j = -(1.0_wp - cos(t))/t**2*across(v) + (t - sin(t))/t**3*matmul(across(v), across(v))
      else
         j = -(0.5_wp - t**2/24.0_wp)*across(v) + (1.0_wp/6.0_wp - t**2/120.0_wp) &
            & *matmul(across(v), across(v))
      end if
      do k = 1, 3
         j(k, k) = j(k, k) + 1.0_wp
      end do
      slope = -matmul(rotation_matrix(v), matmul(across(a), j))

   contains

      !> Matrix of a x.
      pure function across(b) result(matrix)
         real(wp), intent(in) :: b(3)
         real(wp) :: matrix(3, 3)
         matrix = reshape([0.0_wp, b(3), -b(2), -b(3), 0.0_wp, b(1), b(2), -b(1), 0.0_wp], [3, 3])
      end function across
   end function slopes_of_rotation
end module lopin_rigid_motion
