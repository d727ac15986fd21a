!> A mortar row in space with its slopes: what it holds, and how one takes another over.
!>
!> A node that is hardly covered hands its row to neighbours that are covered more, so that the
!> functions still sum to one, as in lopin_mortar.
module lopin_mortar_row_3d
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   implicit none
   private
   public :: mortar_row_type, join, share_weak_rows

   !> A node covered less than this share of its best neighbour has no row of its own.
   real(wp), parameter :: weak = 0.05_wp

   !> Directions: x, y, z of of(1), of of(2), ...
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

   !> The least covered first; before normals and gaps are formed.
   subroutine share_weak_rows(row, slave, full)
      type(mortar_row_type), intent(inout) :: row(:)   !! (slave%nnode)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: full(:)                  !! (slave%nnode) weights if all were covered
      real(wp) :: ratio(size(row)), best(size(row))
      logical :: open(size(row))
      integer :: i, j, n

      ratio = 0.0_wp
      where (full > 0.0_wp) ratio = row%weight/full
      best = ratio
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         associate (own => slave%local(:n, i))
            best(own) = max(best(own), maxval(ratio(own)))
         end associate
      end do
      open = row%node > 0 .and. .not. ratio > weak*best
      do while (any(open))
         j = minloc(ratio, dim=1, mask=open)
         open(j) = .false.
         call hand_over(row, slave, ratio, weak*best, j)
      end do
   end subroutine share_weak_rows

   !> To the strong neighbours in equal parts, or else to the best one.
   subroutine hand_over(row, slave, ratio, limit, j)
      type(mortar_row_type), intent(inout) :: row(:)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: ratio(:), limit(:)
      integer, intent(in) :: j
      integer, allocatable :: heir(:)
      integer :: i, k, n, best

      allocate (heir(0))
      best = 0
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         if (.not. any(slave%local(:n, i) == j)) cycle
         do k = 1, n
            associate (node => slave%local(k, i))
               if (.not. ratio(node) > ratio(j) .or. any(heir == node)) cycle
               if (ratio(node) > limit(node)) heir = [heir, node]
               if (best == 0) best = node
               if (ratio(node) > ratio(best)) best = node
            end associate
         end do
      end do
      if (size(heir) == 0 .and. best > 0) heir = [best]
      do i = 1, size(heir)
         call add_row(row(heir(i)), row(j), 1.0_wp/real(size(heir), wp))
      end do
      row(j)%node = 0
   end subroutine hand_over

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
      to%weight_slope(way) = to%weight_slope(way) + share*from%weight_slope
      do k = 1, size(at)
         to%c(at(k)) = to%c(at(k)) + share*from%c(k)
         to%c_slope(way, at(k)) = to%c_slope(way, at(k)) + share*from%c_slope(:, k)
      end do
   end subroutine add_row

   !> Room for more nodes; old ones keep their numbers.
   pure subroutine lengthen(row, node)
      type(mortar_row_type), intent(inout) :: row
      integer, intent(in) :: node(:)
      type(mortar_row_type) :: old
      integer :: m, n

      old = row
      m = size(old%of)
      call join(row%of, node)
      n = size(row%of)
      if (n == m) return
      deallocate (row%c, row%c_slope, row%weight_slope, row%normal_slope, row%gap_slope)
      allocate (row%c(n), row%c_slope(3*n, n), row%weight_slope(3*n), row%normal_slope(3, 3*n), &
         & row%gap_slope(3*n), source=0.0_wp)
      row%c(:m) = old%c
      row%c_slope(:3*m, :m) = old%c_slope
      row%weight_slope(:3*m) = old%weight_slope
      row%normal_slope(:, :3*m) = old%normal_slope
   end subroutine lengthen
end module lopin_mortar_row_3d
