!> A round bar or a bore in 3D, infinite or with open ends: the lateral surface only.
!>
!> A bar with flat ends and filleted edges is a profile of revolution.
module lopin_tool_cylinder
   use lopin_kinds, only : wp
   use lopin_vectors, only : across
   use lopin_error, only : error_type, error_code, raise
   use lopin_tool, only : tool_type, foot_type, outer_product, coincidence
   implicit none
   private
   public :: cylinder_type, new_cylinder

   integer, parameter :: ring = 72   !! quads on a full turn when drawn

   type, extends(tool_type) :: cylinder_type
      real(wp) :: origin(3) = 0.0_wp       !! a point of the axis; the first end if finite [length]
      real(wp) :: axis(3) = 0.0_wp         !! unit
      real(wp) :: radius = 1.0_wp          !! > 0 [length]
      real(wp) :: length = 0.0_wp          !! 0: infinite [length]
      real(wp) :: side = 1.0_wp            !! 1: bar, the body is outside; -1: bore
   contains
      procedure :: project
      procedure :: tessellate
      procedure :: describe
   end type cylinder_type

contains

   !> A cylinder, or a bore; an error if it has no radius or axis.
   subroutine new_cylinder(self, origin, axis, radius, error, length, bore)
      type(cylinder_type), intent(out) :: self
      real(wp), intent(in) :: origin(3)            !! a point of the axis [length]
      real(wp), intent(in) :: axis(3)              !! direction, any length > 0
      real(wp), intent(in) :: radius               !! > 0 [length]
      type(error_type), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: length !! from the origin; absent or 0: infinite [length]
      logical, intent(in), optional :: bore
      character(len=40) :: value

      if (.not. radius > 0.0_wp) then
         write (value, '(g0.6)') radius
         call raise(error, error_code%deck, 'E0313', &
            & 'the radius of a cylinder is '//trim(value)//'; it must be positive')
         return
      end if
      if (.not. norm2(axis) > 0.0_wp) then
         call raise(error, error_code%deck, 'E0313', 'the axis of a cylinder has no length')
         return
      end if
      self%ndim = 3
      self%name = 'cylinder'
      self%size = radius
      self%origin = origin
      self%axis = axis/norm2(axis)
      self%radius = radius
      if (present(length)) self%length = length
      if (present(bore)) self%side = merge(-1.0_wp, 1.0_wp, bore)
   end subroutine new_cylinder

   pure subroutine project(self, x, foot)
      class(cylinder_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      real(wp) :: away(3), along, distance
      integer :: i

      away = x - self%origin
      along = dot_product(away, self%axis)
      away = away - along*self%axis
      distance = norm2(away)
      if (distance > epsilon(1.0_wp)*self%radius) then
         away = away/distance
         foot%hessian = -outer_product(away, away) - outer_product(self%axis, self%axis)
         do i = 1, 3
            foot%hessian(i, i) = foot%hessian(i, i) + 1.0_wp
         end do
         foot%hessian = self%side/distance*foot%hessian
      else
         away = across(self%axis)
      end if
      if (self%length > 0.0_wp) then
         foot%overhang = max(-along, along - self%length, 0.0_wp)
         if (foot%overhang <= coincidence*self%size) foot%overhang = 0.0_wp
         along = min(max(along, 0.0_wp), self%length)
      end if
      foot%found = .true.
      foot%segment = 1
      foot%point = self%origin + along*self%axis + self%radius*away
      foot%normal = self%side*away
      foot%gap = self%side*(distance - self%radius)
   end subroutine project

   pure subroutine tessellate(self, box, points, cells)
      class(cylinder_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)
      real(wp), parameter :: pi = acos(-1.0_wp)
      real(wp) :: first, last, half, a, t1(3), t2(3)
      integer :: i, k

      first = 0.0_wp
      last = self%length
      if (.not. self%length > 0.0_wp) then
         half = 0.5_wp*norm2(box(:, 2) - box(:, 1))
         first = dot_product(0.5_wp*(box(:, 1) + box(:, 2)) - self%origin, self%axis) - half
         last = first + 2.0_wp*half
      end if
      t1 = across(self%axis)
      t2 = [self%axis(2)*t1(3) - self%axis(3)*t1(2), self%axis(3)*t1(1) - self%axis(1)*t1(3), &
         & self%axis(1)*t1(2) - self%axis(2)*t1(1)]
      allocate (points(3, 2*ring), cells(4, ring))
      do i = 1, ring
         a = 2.0_wp*pi*real(i - 1, wp)/real(ring, wp)
         points(:, i) = self%origin + first*self%axis + self%radius*(cos(a)*t1 + sin(a)*t2)
         points(:, ring + i) = points(:, i) + (last - first)*self%axis
         k = 1 + mod(i, ring)
         cells(:, i) = [i, k, ring + k, ring + i]
      end do
   end subroutine tessellate

   function describe(self) result(text)
      class(cylinder_type), intent(in) :: self
      character(len=:), allocatable :: text
      character(len=60) :: buffer

      write (buffer, '(g0.6)') self%radius
      text = 'cylinder, radius '//trim(buffer)
      if (self%side < 0.0_wp) text = text//', bore'
   end function describe
end module lopin_tool_cylinder
