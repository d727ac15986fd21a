!> A mortar row in space with its slopes, and how one row is added to another.
!>
!> A node without a row of its own hands it over to others, so that the functions still sum to one:
!> lopin_mortar_cover.
module lopin_mortar_row_3d
   use lopin_kinds, only : wp
   implicit none
   private
   public :: mortar_row_type, join, make_room, hand_row_over

   !> Directions: x, y, z of of(1), of of(2), ... Slopes are there only where they were asked for.
   type :: mortar_row_type
      integer :: node = 0                          !! mesh node of the slave; 0: it meets nothing
      integer :: topology = 0                      !! of its cells: the slopes jump where it changes
      integer, allocatable :: of(:)                !! (n) mesh nodes that the row depends on
      real(wp), allocatable :: c(:)                !! (n) [length^2]
      real(wp), allocatable :: c_slope(:, :)       !! (3n, n) [length]
      real(wp) :: weight = 0.0_wp                  !! D [length^2]
      real(wp), allocatable :: weight_slope(:)     !! (3n) [length]
      real(wp) :: normal(3) = 0.0_wp               !! unit, out of the master
      real(wp), allocatable :: normal_slope(:, :)  !! (3, 3n) [1/length]
      real(wp) :: gap = 0.0_wp                     !! >= 0 open [length]
      real(wp), allocatable :: gap_slope(:)        !! (3n) [-]
   end type mortar_row_type

contains

   !> Nodes behind a list, those that it lacks.
   pure subroutine join(list, node)
      integer, allocatable, intent(inout) :: list(:)
      integer, intent(in) :: node(:)
      integer :: k

      if (.not. allocated(list)) allocate (list(0))
      do k = 1, size(node)
         if (any(list == node(k))) cycle
         list = [list, node(k)]
      end do
   end subroutine join

   !> Zeros for all nodes of a row.
   pure subroutine make_room(row, with_slopes)
      type(mortar_row_type), intent(inout) :: row
      logical, intent(in) :: with_slopes
      integer :: n

      n = size(row%of)
      allocate (row%c(n), source=0.0_wp)
      if (with_slopes) allocate (row%c_slope(3*n, n), row%weight_slope(3*n), &
         & row%normal_slope(3, 3*n), row%gap_slope(3*n), source=0.0_wp)
   end subroutine make_room

   !> Row j to others in equal parts, before normals and gaps are formed.
   pure subroutine hand_row_over(row, j, heir)
      type(mortar_row_type), intent(inout) :: row(:)
      integer, intent(in) :: j, heir(:)
      integer :: i

      do i = 1, size(heir)
         call add_row(row(heir(i)), row(j), 1.0_wp/real(size(heir), wp))
      end do
      row(j)%node = 0
   end subroutine hand_row_over

   pure subroutine add_row(to, from, share)
      type(mortar_row_type), intent(inout) :: to
      type(mortar_row_type), intent(in) :: from
      real(wp), intent(in) :: share
      integer :: at(size(from%of)), way(3*size(from%of)), k

      call lengthen(to, from%of)
      do k = 1, size(at)
         at(k) = findloc(to%of, from%of(k), dim=1)
         way(3*k - 2:3*k) = 3*at(k) + [-2, -1, 0]
      end do
      to%topology = mod(31*to%topology + from%topology, 1000003)
      to%weight = to%weight + share*from%weight
      to%normal = to%normal + share*from%normal
      to%c(at) = to%c(at) + share*from%c
      if (.not. allocated(to%c_slope)) return
      to%weight_slope(way) = to%weight_slope(way) + share*from%weight_slope
      to%normal_slope(:, way) = to%normal_slope(:, way) + share*from%normal_slope
      do k = 1, size(at)
         to%c_slope(way, at(k)) = to%c_slope(way, at(k)) + share*from%c_slope(:, k)
      end do
   end subroutine add_row

   !> Room for more nodes; old ones keep their numbers.
   pure subroutine lengthen(row, node)
      type(mortar_row_type), intent(inout) :: row
      integer, intent(in) :: node(:)
      type(mortar_row_type) :: old
      integer :: m

      old = row
      m = size(old%of)
      call join(row%of, node)
      if (size(row%of) == m) return
      deallocate (row%c)
      if (allocated(row%c_slope)) deallocate (row%c_slope, row%weight_slope, row%normal_slope, &
         & row%gap_slope)
      call make_room(row, allocated(old%c_slope))
      row%c(:m) = old%c
      if (.not. allocated(old%c_slope)) return
      row%c_slope(:3*m, :m) = old%c_slope
      row%weight_slope(:3*m) = old%weight_slope
      row%normal_slope(:, :3*m) = old%normal_slope
   end subroutine lengthen
end module lopin_mortar_row_3d
