!> A flat tool: a point and a normal, in 2D and in 3D, without edges.
module lopin_tool_plane
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_tool, only : tool_type, foot_type
   implicit none
   private
   public :: plane_type, new_plane

   type, extends(tool_type) :: plane_type
      real(wp) :: origin(3) = 0.0_wp   !! a point of the plane [length]
      real(wp) :: normal(3) = 0.0_wp   !! unit, towards the body
   contains
      procedure :: project
      procedure :: tessellate
      procedure :: describe
   end type plane_type

contains

   !> A half-space; an error if the normal has no length.
   subroutine new_plane(self, origin, normal, error)
      type(plane_type), intent(out) :: self
      real(wp), intent(in) :: origin(:)   !! (ndim) a point of the plane [length]
      real(wp), intent(in) :: normal(:)   !! (ndim) towards the body, any length > 0
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: length

      length = norm2(normal)
      if (.not. length > 0.0_wp) then
         call raise(error, error_code%deck, 'E0313', 'the normal of a plane has no length')
         return
      end if
      self%ndim = size(origin)
      self%name = 'plane'
      self%origin(:self%ndim) = origin
      self%normal(:self%ndim) = normal/length
   end subroutine new_plane

   pure subroutine project(self, x, foot)
      class(plane_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      integer :: n

      n = self%ndim
      foot%found = .true.
      foot%segment = 1
      foot%normal = self%normal
      foot%gap = dot_product(self%normal(:n), x - self%origin(:n))
      foot%point(:n) = x - foot%gap*self%normal(:n)
   end subroutine project

   !> One line or one quad that covers the box.
   pure subroutine tessellate(self, box, points, cells)
      class(plane_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)
      real(wp) :: half, t1(3), t2(3)
      type(foot_type) :: foot

      half = 0.5_wp*norm2(box(:, 2) - box(:, 1))
      call self%project(0.5_wp*(box(:, 1) + box(:, 2)), foot)
      if (self%ndim == 2) then
         t1(:2) = half*[-self%normal(2), self%normal(1)]
         points = reshape([foot%point(:2) - t1(:2), foot%point(:2) + t1(:2)], [2, 2])
         cells = reshape([1, 2], [2, 1])
      else
         t1 = 0.0_wp
         t1(minloc(abs(self%normal), dim=1)) = 1.0_wp
         t1 = t1 - dot_product(t1, self%normal)*self%normal
         t1 = half*t1/norm2(t1)
         t2 = [self%normal(2)*t1(3) - self%normal(3)*t1(2), &
            & self%normal(3)*t1(1) - self%normal(1)*t1(3), &
            & self%normal(1)*t1(2) - self%normal(2)*t1(1)]
         points = reshape([foot%point - t1 - t2, foot%point + t1 - t2, foot%point + t1 + t2, &
            & foot%point - t1 + t2], [3, 4])
         cells = reshape([1, 2, 3, 4], [4, 1])
      end if
   end subroutine tessellate

   function describe(self) result(text)
      class(plane_type), intent(in) :: self
      character(len=:), allocatable :: text
      character(len=100) :: buffer

      write (buffer, '("plane, normal (",g0.5,2(", ",g0.5))') self%normal(:self%ndim)
      text = trim(buffer)//')'
   end function describe
end module lopin_tool_plane
