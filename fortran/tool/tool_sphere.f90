!> A sphere (3D) or a circle (2D): a solid ball, or the cavity of the same shape.
module lopin_tool_sphere
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_tool, only : tool_type, foot_type, outer_product
   implicit none
   private
   public :: sphere_type, new_sphere

   integer, parameter :: ring = 72   !! lines on a full circle when drawn

   type, extends(tool_type) :: sphere_type
      real(wp) :: centre(3) = 0.0_wp   !! [length]
      real(wp) :: radius = 1.0_wp      !! > 0 [length]
      real(wp) :: side = 1.0_wp !! 1: solid, the body is outside; -1: cavity, the body is inside
   contains
      procedure :: project
      procedure :: tessellate
      procedure :: describe
   end type sphere_type

contains

   !> A sphere or circle, or the cavity of one; an error if the radius is not positive.
   subroutine new_sphere(self, centre, radius, error, cavity)
      type(sphere_type), intent(out) :: self
      real(wp), intent(in) :: centre(:)   !! (ndim) [length]
      real(wp), intent(in) :: radius      !! > 0 [length]
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in), optional :: cavity
      character(len=40) :: value

      if (.not. radius > 0.0_wp) then
         write (value, '(g0.6)') radius
         call raise(error, error_code%deck, 'E0313', &
            & 'the radius of a sphere is '//trim(value)//'; it must be positive')
         return
      end if
      self%ndim = size(centre)
      self%name = 'sphere'
      self%size = radius
      self%centre(:self%ndim) = centre
      self%radius = radius
      if (present(cavity)) self%side = merge(-1.0_wp, 1.0_wp, cavity)
   end subroutine new_sphere

   !> At the centre every point is equally near: the last axis is taken.
   pure subroutine project(self, x, foot)
      class(sphere_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      real(wp) :: away(3), distance
      integer :: n, i

      n = self%ndim
      away = 0.0_wp
      away(:n) = x - self%centre(:n)
      distance = norm2(away)
      if (distance > epsilon(1.0_wp)*self%radius) then
         away = away/distance
         foot%hessian(:n, :n) = -self%side/distance*outer_product(away(:n), away(:n))
         do i = 1, n
            foot%hessian(i, i) = foot%hessian(i, i) + self%side/distance
         end do
      else
         away = 0.0_wp
         away(n) = -1.0_wp
      end if
      foot%found = .true.
      foot%segment = 1
      foot%point(:n) = self%centre(:n) + self%radius*away(:n)
      foot%normal = self%side*away
      foot%gap = self%side*(distance - self%radius)
   end subroutine project

   pure subroutine tessellate(self, box, points, cells)
      class(sphere_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)
      real(wp), parameter :: pi = acos(-1.0_wp)
      integer, parameter :: nrow = ring/2
      real(wp) :: a, b
      integer :: i, j, k

      if (size(box, 1) == 2) then
         allocate (points(2, ring), cells(2, ring))
         do i = 1, ring
            a = 2.0_wp*pi*real(i - 1, wp)/real(ring, wp)
            points(:, i) = self%centre(:2) + self%radius*[cos(a), sin(a)]
            cells(:, i) = [i, 1 + mod(i, ring)]
         end do
         return
      end if
      ! Rows of `ring` points from pole to pole; the rows at the poles are degenerate quads' ends.
      allocate (points(3, ring*(nrow + 1)), cells(4, ring*nrow))
      do j = 0, nrow
         b = pi*real(j, wp)/real(nrow, wp)
         do i = 1, ring
            a = 2.0_wp*pi*real(i - 1, wp)/real(ring, wp)
            points(:, j*ring + i) = self%centre + self%radius*[sin(b)*cos(a), sin(b)*sin(a), &
               & -cos(b)]
         end do
      end do
      do j = 0, nrow - 1
         do i = 1, ring
            k = 1 + mod(i, ring)
            if (j == 0) then
               cells(:, j*ring + i) = [i, ring + k, ring + i, 0]
            else if (j == nrow - 1) then
               cells(:, j*ring + i) = [j*ring + i, j*ring + k, (j + 1)*ring + i, 0]
            else
               cells(:, j*ring + i) = [j*ring + i, j*ring + k, (j + 1)*ring + k, (j + 1)*ring + i]
            end if
         end do
      end do
   end subroutine tessellate

   function describe(self) result(text)
      class(sphere_type), intent(in) :: self
      character(len=:), allocatable :: text
      character(len=60) :: buffer

      write (buffer, '(g0.6)') self%radius
      text = merge('circle', 'sphere', self%ndim == 2)//', radius '//trim(buffer)
      if (self%side < 0.0_wp) text = text//', hollow'
   end function describe
end module lopin_tool_sphere
