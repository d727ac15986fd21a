!> Boxes in boxes around triangles: what is near a point is found without looking at the rest.
module lopin_facet_tree
   use lopin_kinds, only : wp
   implicit none
   private
   public :: facet_tree_type, new_facet_tree, box_distance2, deepest

   integer, parameter :: leaf = 4       !! facets in a last box, at most
   integer, parameter :: deepest = 64   !! halving: at most 31 levels

   !> The first child of a node follows it; nodes with facets have no second.
   type :: facet_tree_type
      integer :: nnode = 0
      real(wp), allocatable :: low(:, :), high(:, :)   !! (3, nnode) [length]
      integer, allocatable :: second(:)                !! (nnode) second child; 0: a leaf
      integer, allocatable :: first(:), last(:)        !! (nnode) range of `facet`
      integer, allocatable :: facet(:)                 !! (n) in the order of the tree
   end type facet_tree_type

contains

   !> Halve along the longest side of the box of the middles, until few facets are left.
   pure subroutine new_facet_tree(self, low, high)
      type(facet_tree_type), intent(out) :: self
      real(wp), intent(in) :: low(:, :), high(:, :)    !! (3, n) boxes of the facets [length]
      real(wp), allocatable :: middle(:, :)
      integer :: stack(3, deepest), top, n, i, k, axis, half, parent
      real(wp) :: spread(3)

      n = size(low, 2)
      allocate (self%low(3, max(1, 2*n)), self%high(3, max(1, 2*n)))
      allocate (self%second(max(1, 2*n)), self%first(max(1, 2*n)), self%last(max(1, 2*n)), source=0)
      self%facet = [(i, i=1, n)]
      middle = 0.5_wp*(low + high)
      top = 0
      if (n > 0) then
         top = 1
         stack(:, 1) = [1, n, 0]
      end if
      do while (top > 0)
         self%nnode = self%nnode + 1
         k = self%nnode
         self%first(k) = stack(1, top)
         self%last(k) = stack(2, top)
         parent = stack(3, top)
         top = top - 1
         if (parent > 0) self%second(parent) = k
         associate (list => self%facet(self%first(k):self%last(k)))
            self%low(:, k) = minval(low(:, list), dim=2)
            self%high(:, k) = maxval(high(:, list), dim=2)
            if (size(list) <= leaf) cycle
            spread = maxval(middle(:, list), dim=2) - minval(middle(:, list), dim=2)
            axis = maxloc(spread, dim=1)
            half = size(list)/2
            call divide(list, middle(axis, :), half)
         end associate
         half = self%first(k) + half
         stack(:, top + 1) = [half, self%last(k), k]
         stack(:, top + 2) = [self%first(k), half - 1, 0]
         top = top + 2
      end do
   end subroutine new_facet_tree

   !> The `half` least come first (Hoare's selection).
   pure subroutine divide(list, value, half)
      integer, intent(inout) :: list(:)
      real(wp), intent(in) :: value(:)
      integer, intent(in) :: half
      integer :: first, last, i, j
      real(wp) :: pivot

      first = 1
      last = size(list)
      do while (first < last)
         pivot = value(list((first + last)/2))
         i = first
         j = last
         do while (i <= j)
            do while (value(list(i)) < pivot)
               i = i + 1
            end do
            do while (value(list(j)) > pivot)
               j = j - 1
            end do
            if (i > j) exit
            list([i, j]) = list([j, i])
            i = i + 1
            j = j - 1
         end do
         if (half <= j) then
            last = j
         else if (half >= i) then
            first = i
         else
            exit
         end if
      end do
   end subroutine divide

   !> Squared distance of a point to a box, 0 inside [length^2].
   pure real(wp) function box_distance2(low, high, x)
      real(wp), intent(in) :: low(3), high(3), x(3)
      real(wp) :: d(3)

      d = max(low - x, x - high, 0.0_wp)
      box_distance2 = d(1)*d(1) + d(2)*d(2) + d(3)*d(3)
   end function box_distance2
end module lopin_facet_tree
