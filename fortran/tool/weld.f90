!> Points that stand at one place become one point.
module lopin_weld
   use lopin_kinds, only : wp, lk
   implicit none
   private
   public :: weld_points

contains

   !> Merge points nearer than `distance` (each coordinate) to one met earlier, by a hashed grid.
   !>
   !> A point looks into the eight cells of size 2*distance that reach within `distance` of it.
   pure subroutine weld_points(x, distance, kept, which)
      real(wp), intent(in) :: x(:, :)                 !! (3, n) [length]
      real(wp), intent(in) :: distance                !! > 0 [length]
      integer, allocatable, intent(out) :: kept(:)    !! the points that stay, increasing
      integer, allocatable, intent(out) :: which(:)   !! (n) index into `kept`
      integer, allocatable :: head(:), next(:)
      integer(lk) :: cell(3), near(3)
      integer :: i, j, k, slot, n, nkept, nslot
      real(wp) :: low(3), place(3)

      n = size(x, 2)
      nslot = 2*n + 1
      allocate (which(n), next(n), kept(n), head(0:nslot - 1), source=0)
      low = 0.0_wp
      if (n > 0) low = minval(x, dim=2)
      nkept = 0
      do i = 1, n
         place = (x(:, i) - low)/(2.0_wp*distance)
         cell = floor(place, lk)
         near = cell + merge(1_lk, -1_lk, place - real(cell, wp) > 0.5_wp)
         corners: do k = 0, 7
            j = head(slot_of(merge(cell, near, [btest(k, 0), btest(k, 1), btest(k, 2)]), nslot))
            do while (j > 0)
               if (all(abs(x(:, kept(j)) - x(:, i)) <= distance)) exit corners
               j = next(j)
            end do
         end do corners
         if (j == 0) then
            nkept = nkept + 1
            kept(nkept) = i
            j = nkept
            slot = slot_of(cell, nslot)
            next(j) = head(slot)
            head(slot) = j
         end if
         which(i) = j
      end do
      kept = kept(:nkept)
   end subroutine weld_points

   pure integer function slot_of(cell, nslot)
      integer(lk), intent(in) :: cell(3)
      integer, intent(in) :: nslot
      integer(lk), parameter :: prime(3) = [73856093_lk, 19349663_lk, 83492791_lk]
      integer(lk) :: mixed
      integer :: i

      mixed = 0_lk
      do i = 1, 3
         mixed = ieor(mixed, cell(i)*prime(i))
      end do
      slot_of = int(modulo(mixed, int(nslot, lk)))
   end function slot_of
end module lopin_weld
