!> The facets whose boxes meet a box.
module lopin_box_query
   use lopin_kinds, only : wp, lk
   use lopin_search, only : tree_type
   implicit none
   private
   public :: facets_in_box

   integer, parameter :: deepest = 64     !! the tree has at most 31 levels

contains

   !> In increasing order.
   pure subroutine facets_in_box(tree, facet_low, facet_high, low, high, found)
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: facet_low(:, :), facet_high(:, :)   !! (3, n) boxes [length]
      real(wp), intent(in) :: low(3), high(3)                     !! the box asked for [length]
      integer, allocatable, intent(out) :: found(:)
      integer, allocatable :: list(:), longer(:)
      integer :: stack(deepest), top, k, i, first, last, n

      allocate (list(64))
      n = 0
      top = 0
      if (tree%n > 0) then
         top = 1
         stack(1) = 1
      end if
      do while (top > 0)
         k = stack(top)
         top = top - 1
         if (any(tree%low(:, k) > high) .or. any(tree%high(:, k) < low)) cycle
         if (k < tree%nleaf) then
            stack(top + 1:top + 2) = [2*k + 1, 2*k]
            top = top + 2
            cycle
         end if
         i = k - tree%nleaf + 1
         first = 1 + int(int(i - 1, lk)*int(tree%n, lk)/int(tree%nleaf, lk))
         last = int(int(i, lk)*int(tree%n, lk)/int(tree%nleaf, lk))
         do i = first, last
            associate (facet => tree%facet(i))
               if (any(facet_low(:, facet) > high) .or. any(facet_high(:, facet) < low)) cycle
               if (n == size(list)) then
                  allocate (longer(2*n))
                  longer(:n) = list
                  call move_alloc(longer, list)
               end if
               n = n + 1
               list(n) = facet
            end associate
         end do
      end do
      found = list(:n)
      call sort(found)
   end subroutine facets_in_box

   !> By insertion: the lists are short.
   pure subroutine sort(list)
      integer, intent(inout) :: list(:)
      integer :: i, j, held

      do i = 2, size(list)
         held = list(i)
         do j = i - 1, 1, -1
            if (list(j) <= held) exit
            list(j + 1) = list(j)
         end do
         list(j + 1) = held
      end do
   end subroutine sort
end module lopin_box_query
