!> Points sorted into cubes, so that those near a place are found without looking at all.
module lopin_point_bins
   use lopin_kinds, only : wp
   implicit none
   private
   public :: point_bins_type

   !> Cubes are kept by a hash of their numbers: as many buckets as points, whatever the cubes.
   type :: point_bins_type
      private
      real(wp) :: side = 1.0_wp                !! of a cube [length]
      real(wp) :: corner(3) = 0.0_wp           !! where the first begins [length]
      integer, allocatable :: cube(:, :)       !! (3, n) of each point
      integer, allocatable :: head(:)          !! (0:buckets-1) first point of a bucket; 0: none
      integer, allocatable :: next(:)          !! (n) the next of the same bucket; 0: the last
      integer, allocatable :: list(:)          !! (n) of the last answer
   contains
      procedure :: fill
      procedure :: near
   end type point_bins_type

contains

   !> Sort points.
   subroutine fill(self, x, side)
      class(point_bins_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)          !! (3, n) [length]
      real(wp), intent(in) :: side             !! of a cube, above 0 [length]
      integer :: i, b
      real(wp) :: extent

      self%corner = minval(x, dim=2)
      extent = maxval(maxval(x, dim=2) - self%corner)
      ! Numbers of cubes stay far below the largest integer.
      self%side = max(side, extent*1.0e-8_wp)
      if (.not. self%side > 0.0_wp) self%side = 1.0_wp
      if (allocated(self%cube)) deallocate (self%cube, self%head, self%next, self%list)
      allocate (self%cube(3, size(x, 2)), self%next(size(x, 2)), self%list(size(x, 2)))
      allocate (self%head(0:max(1, size(x, 2)) - 1), source=0)
      do i = size(x, 2), 1, -1
         self%cube(:, i) = cube_of(self, x(:, i))
         b = bucket(self, self%cube(:, i))
         self%next(i) = self%head(b)
         self%head(b) = i
      end do
   end subroutine fill

   !> Points in the cube of a place and the 26 around it: all that are nearer than a side are among
   !> them; always in the same order.
   subroutine near(self, place, found)
      class(point_bins_type), intent(inout) :: self
      real(wp), intent(in) :: place(3)         !! [length]
      integer, allocatable, intent(out) :: found(:)
      integer :: own(3), cube(3), k, p, n

      own = cube_of(self, place)
      n = 0
      do k = 0, 26
         cube = own + [mod(k, 3), mod(k/3, 3), k/9] - 1
         p = self%head(bucket(self, cube))
         do while (p > 0)
            if (all(self%cube(:, p) == cube)) then
               n = n + 1
               self%list(n) = p
            end if
            p = self%next(p)
         end do
      end do
      found = self%list(:n)
   end subroutine near

   pure function cube_of(self, place) result(cube)
      class(point_bins_type), intent(in) :: self
      real(wp), intent(in) :: place(3)
      integer :: cube(3)
      cube = floor(min(1.0e9_wp, max(-1.0e9_wp, (place - self%corner)/self%side)))
   end function cube_of

   pure integer function bucket(self, cube)
      class(point_bins_type), intent(in) :: self
      integer, intent(in) :: cube(3)
      integer, parameter :: long = selected_int_kind(18)
      integer(long), parameter :: prime(3) = [73856093_long, 19349663_long, 83492791_long]
      integer(long) :: key

      key = ieor(ieor(cube(1)*prime(1), cube(2)*prime(2)), cube(3)*prime(3))
      bucket = int(modulo(key, int(size(self%head), long)))
   end function bucket
end module lopin_point_bins
