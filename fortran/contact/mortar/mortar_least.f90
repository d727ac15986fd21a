!> Lower bound of a weighted gap: the least gap over the facets of the slave node.
!>
!> Dual functions are negative over a part of their facets: where a master is convex within them,
!> the weighted gap of a node lies below every gap that it weighs, by up to kappa h^2/12, and would
!> press bodies that do not touch. The gap of a row is lifted then to that of the place where the
!> facets of the node are nearest. The lift has no slopes: forces go by the means, and where a dent
!> makes the least gap fall as its node is pressed, a row that held to it would have no answer. Gaps
!> linear on the slave facets are their own means and stay.
module lopin_mortar_least
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type
   implicit none
   private
   public :: least_of_nodes, lift_of_row

   !> Of a facet: more is covered wholly; differences of gaps, in facets, that are rounding.
   real(wp), parameter :: whole = 1.0_wp - 1.0e-6_wp, rounding = 1.0e-9_wp

contains

   !> The overlap in which the gap over the facets of a node is least; 0 where not all of them are
   !> covered wholly: their means are continued beyond the master.
   pure subroutine least_of_nodes(slave, list, best)
      type(surface_type), intent(in) :: slave
      type(overlap_list_type), intent(in) :: list
      integer, intent(out) :: best(:)          !! (slave%nnode)
      integer :: nearest(slave%facets%n), i, j, k
      real(wp) :: covered(slave%facets%n)

      nearest = 0
      covered = 0.0_wp
      do i = 1, list%n
         associate (s => list%item(i)%slave)
            covered(s) = covered(s) + list%item(i)%part
            if (is_less(i, nearest(s))) nearest(s) = i
         end associate
      end do
      best = 0
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            j = slave%local(k, i)
            if (covered(i) < whole) then
               best(j) = -1
            else if (best(j) >= 0) then
               if (is_less(nearest(i), best(j))) best(j) = nearest(i)
            end if
         end do
      end do
      best = max(best, 0)

   contains

      pure logical function is_less(a, b)
         integer, intent(in) :: a, b
         is_less = b == 0
         if (.not. is_less) is_less = list%item(a)%least%gap < list%item(b)%least%gap
      end function is_less
   end subroutine least_of_nodes

   !> The gap where an overlap is nearest, along the normal of a row.
   pure real(wp) function least_gap(overlap, slave, master, x, normal) result(gap)
      type(overlap_type), intent(in) :: overlap
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)          !! (ndim, all mesh nodes) [length]
      real(wp), intent(in) :: normal(:)        !! out of the master
      integer :: k, first

      gap = 0.0_wp
      first = slave%facets%node(1, overlap%slave)
      do k = 1, slave%facets%nnode(overlap%slave)
         gap = gap + overlap%least%n(k)*dot_product(normal(:size(x, 1)), &
            & x(:, slave%facets%node(k, overlap%slave)) - x(:, first))
      end do
      do k = 1, master%facets%nnode(overlap%master)
         gap = gap - overlap%least%m(k)*dot_product(normal(:size(x, 1)), &
            & x(:, master%facets%node(k, overlap%master)) - x(:, first))
      end do
   end function least_gap

   !> A gap is above the mean of a row by more than rounding.
   pure logical function is_above(gap, mean, size)
      real(wp), intent(in) :: gap, mean        !! [length]
      real(wp), intent(in) :: size             !! of the slave facet [length]
      is_above = gap > mean + rounding*size
   end function is_above

   !> What the gap where an overlap is nearest is above the mean of a row, >= 0 [length].
   pure real(wp) function lift_of_row(overlap, slave, master, x, normal, mean) result(lift)
      type(overlap_type), intent(in) :: overlap
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)          !! (ndim, all mesh nodes) [length]
      real(wp), intent(in) :: normal(:)        !! of the row, out of the master
      real(wp), intent(in) :: mean             !! gap of the row [length]
      real(wp) :: gap

      gap = least_gap(overlap, slave, master, x, normal)
      lift = 0.0_wp
      if (is_above(gap, mean, slave%size(overlap%slave))) lift = gap - mean
   end function lift_of_row
end module lopin_mortar_least
