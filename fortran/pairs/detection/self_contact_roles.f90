!> Slave and master roles of the points of a surface in contact with itself.
!>
!> Both sides of a fold are slaves of the other. With exact constraints two nodes that face each
!> other would state one condition twice: the tractions are not unique, and two polygons that may
!> not enter one another at the nodes of both lock. So one side presses: the roles spread along the
!> surface from a seed (a point that pressed before, else the finest, else the first), and a point
!> yields where the facet opposite it has a node that presses back upon the point's own
!> surroundings. The whole of the contact's force acts at the side that presses, and its
!> reaction on the nodes of the facets opposite.
module lopin_self_contact_roles
   use lopin_kinds, only : wp
   use lopin_surface, only : surface_type
   implicit none
   private
   public :: choose_self_contact_roles

   !> Sizes of facets that count as equal.
   real(wp), parameter :: same = 1.0e-6_wp

   integer, parameter :: unknown = 0, pressing = 1, yielding = 2

contains

   !> Roles for the facets opposite now.
   subroutine choose_self_contact_roles(surface, node, opposite, size_, pressed, yields)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: node(:)           !! (n) mesh node of each point
      integer, intent(in) :: opposite(:)       !! (n) facet; 0: none
      real(wp), intent(in) :: size_(:)         !! (n) of the facets around [length]
      logical, intent(in) :: pressed(:)        !! (n) when the last increment ended
      logical, intent(out) :: yields(:)        !! (n)
      integer :: point_of(maxval([0, surface%node, node]))
      integer :: queue(size(node)), role(size(node)), head, tail, i
      logical :: seen(size(node))

      point_of = 0
      do i = 1, size(node)
         point_of(node(i)) = i
      end do
      role = unknown
      seen = opposite == 0
      tail = 0
      head = 0
      do
         if (head == tail) then
            i = next_seed()
            if (i == 0) exit
            seen(i) = .true.
            tail = tail + 1
            queue(tail) = i
         end if
         head = head + 1
         i = queue(head)
         role(i) = merge(yielding, pressing, is_pressed_upon(i))
         if (role(i) == pressing) call spread_from(i)
      end do
      yields = role == yielding

   contains

      !> Those that pressed first, then the finest, then the lowest.
      pure integer function next_seed() result(seed)
         integer :: k

         seed = 0
         do k = 1, size(node)
            if (seen(k)) cycle
            if (seed == 0) then
               seed = k
            else if (pressed(k) .neqv. pressed(seed)) then
               if (pressed(k)) seed = k
            else if (size_(k) < size_(seed)*(1.0_wp - same)) then
               seed = k
            end if
         end do
      end function next_seed

      !> A node of the facet opposite presses already, upon the facets around this point.
      pure logical function is_pressed_upon(i)
         integer, intent(in) :: i
         integer :: k, other

         is_pressed_upon = .true.
         associate (f => surface%facets)
            do k = 1, f%nnode(opposite(i))
               other = point_of(f%node(k, opposite(i)))
               if (other == 0) cycle
               if (role(other) /= pressing) cycle
               if (are_near(node(i), opposite(other))) return
            end do
         end associate
         is_pressed_upon = .false.
      end function is_pressed_upon

      !> The facet has the node, or touches a facet that has it.
      pure logical function are_near(a, facet)
         integer, intent(in) :: a, facet
         integer :: k, j, l

         are_near = .true.
         associate (f => surface%facets)
            do k = 1, f%nnode(facet)
               if (f%node(k, facet) == a) return
               l = surface%local(k, facet)
               do j = surface%ring_first(l), surface%ring_first(l + 1) - 1
                  if (any(f%node(:f%nnode(surface%ring(j)), surface%ring(j)) == a)) return
               end do
            end do
         end associate
         are_near = .false.
      end function are_near

      subroutine spread_from(i)
         integer, intent(in) :: i
         integer :: l, j, k, other

         l = local_of(i)
         if (l == 0) return
         associate (f => surface%facets)
            do j = surface%ring_first(l), surface%ring_first(l + 1) - 1
               do k = 1, f%nnode(surface%ring(j))
                  other = point_of(f%node(k, surface%ring(j)))
                  if (other == 0) cycle
                  if (seen(other)) cycle
                  seen(other) = .true.
                  tail = tail + 1
                  queue(tail) = other
               end do
            end do
         end associate
      end subroutine spread_from

      !> Nodes of a surface are sorted.
      pure integer function local_of(i) result(l)
         integer, intent(in) :: i
         integer :: low, high

         low = 1
         high = surface%nnode
         l = 0
         do while (low <= high)
            l = (low + high)/2
            if (surface%node(l) == node(i)) return
            if (surface%node(l) < node(i)) then
               low = l + 1
            else
               high = l - 1
            end if
         end do
         l = 0
      end function local_of
   end subroutine choose_self_contact_roles
end module lopin_self_contact_roles
