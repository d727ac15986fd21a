!> All overlaps of two surfaces in the plane.
module lopin_mortar_overlaps_2d
   use lopin_kinds, only : wp
   use lopin_plain, only : dual_type, constant
   use lopin_surface, only : surface_type
   use lopin_search, only : tree_type
   use lopin_box_query, only : facets_in_box
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type, add_overlap, &
      & cosine_between, overlap_limits_type, area_measure_type
   use lopin_plain_cells_2d, only : segment_type, integrate_segment, find_least
   implicit none
   private
   public :: find_overlaps_2d

   !> Two segments of one slave facet that share more of it than this are one behind the other.
   real(wp), parameter :: shared = 1.0e-6_wp

contains

   !> The tree is that of the master's boxes.
   subroutine find_overlaps_2d(slave, normal, master, tree, x, measure, limits, list)
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: normal(:, :)        !! (2, slave%nnode) outward unit normals
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)             !! (2, all mesh nodes) [length]
      type(area_measure_type), intent(in) :: measure
      type(overlap_limits_type), intent(in) :: limits
      type(overlap_list_type), intent(inout) :: list
      type(segment_type), allocatable :: segment(:)
      type(dual_type) :: place(2, 3), nu(2, 3), other(2, 3)
      real(wp) :: low(3), high(3), way(3)
      integer, allocatable :: candidate(:)
      integer :: i, k, n, m, found

      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         low = slave%low(:, i)
         high = slave%high(:, i)
         nu(:, :n) = constant(normal(:2, slave%local(:n, i)))
         do k = 1, n
            way = 0.0_wp
            way(:2) = limits%reach*nu(:, k)%v
            low = min(low, slave%low(:, i) + way, slave%low(:, i) - way)
            high = max(high, slave%high(:, i) + way, slave%high(:, i) - way)
         end do
         call facets_in_box(tree, master%low, master%high, low, high, candidate)
         place(:, :n) = constant(x(:2, slave%facets%node(:n, i)))
         found = 0
         if (allocated(segment)) deallocate (segment)
         allocate (segment(size(candidate)))
         do k = 1, size(candidate)
            if (.not. cosine_between(slave, i, master, candidate(k)) < limits%facing) cycle
            m = master%facets%nnode(candidate(k))
            if (any(master%facets%node(:m, candidate(k)) == slave%facets%node(1, i)) .and. &
               & any(master%facets%node(:m, candidate(k)) == slave%facets%node(2, i))) cycle
            other(:, :m) = constant(x(:2, master%facets%node(:m, candidate(k))))
            call integrate_segment(place(:, :n), nu(:, :n), other(:, :m), &
               & measure%axisymmetric, measure%thickness(i), segment(found + 1))
            if (.not. segment(found + 1)%overlaps) cycle
            if (allocated(limits%depth)) then
               if (sum(segment(found + 1)%gap(:n)%v)/segment(found + 1)%area%v &
                  & < -limits%depth(i)) cycle
            end if
            call find_least(place(:, :n)%v, nu(:, :n)%v, other(:, :m)%v, segment(found + 1))
            found = found + 1
            candidate(found) = candidate(k)
            if (found == size(segment)) exit
         end do
         call take_nearest(i, candidate(:found), segment(:found), n, list)
      end do
   end subroutine find_overlaps_2d

   !> Of segments that lie behind each other only the nearest is met.
   subroutine take_nearest(facet, candidate, segment, nnode, list)
      integer, intent(in) :: facet, candidate(:), nnode
      type(segment_type), intent(in) :: segment(:)
      type(overlap_list_type), intent(inout) :: list
      type(overlap_type) :: item
      real(wp) :: distance(size(segment))
      logical :: behind(size(segment))
      integer :: k, j

      do k = 1, size(segment)
         distance(k) = abs(sum(segment(k)%gap(:nnode)%v))/segment(k)%area%v
      end do
      behind = .false.
      do k = 1, size(segment)
         do j = 1, size(segment)
            if (j == k .or. distance(j) > distance(k)) cycle
            if (.not. distance(j) < distance(k) .and. j > k) cycle
            behind(k) = behind(k) .or. min(segment(j)%to%v, segment(k)%to%v) &
               & - max(segment(j)%from%v, segment(k)%from%v) > shared
         end do
      end do
      do k = 1, size(segment)
         if (behind(k)) cycle
         item = overlap_type()
         item%slave = facet
         item%master = candidate(k)
         item%me(:3, :3) = segment(k)%me%v
         item%d(:3) = segment(k)%d%v
         item%b(:3, :3) = segment(k)%b%v
         item%gap(:3) = segment(k)%gap%v
         item%area = segment(k)%area%v
         item%part = 0.5_wp*(segment(k)%to%v - segment(k)%from%v)
         item%least = segment(k)%least
         call add_overlap(list, item)
      end do
   end subroutine take_nearest
end module lopin_mortar_overlaps_2d
