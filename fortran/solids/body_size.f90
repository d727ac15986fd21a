!> Thickness of bodies: the length that a penetration is compared with.
module lopin_body_size
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_bodies, only : bodies_type
   implicit none
   private
   public :: thinnest

contains

   !> Shortest side of the boxes round the bodies that a pair brings together; huge without bodies.
   pure real(wp) function thinnest(bodies, model, pair)
      type(bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      thinnest = min(side_of(bodies, model, node_of(model, model%pair(pair)%slave)), &
         & side_of(bodies, model, node_of(model, model%pair(pair)%master)))
   end function thinnest

   !> A node of a surface; 0 of a tool.
   pure integer function node_of(model, s) result(node)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s                 !! surface; 0: none

      node = 0
      if (s == 0) return
      associate (surface => model%surface(s))
         if (allocated(surface%element)) then
            if (size(surface%element) > 0) node = model%mesh%conn(1, surface%element(1))
         end if
         if (node > 0 .or. .not. allocated(surface%node)) return
         if (size(surface%node) > 0) node = surface%node(1)
      end associate
   end function node_of

   !> Shortest side of the box round the body of a node [length].
   pure real(wp) function side_of(bodies, model, node) result(side)
      type(bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      integer, intent(in) :: node              !! 0: none
      real(wp) :: low(model%mesh%ndim), high(model%mesh%ndim)
      integer :: i

      side = huge(1.0_wp)
      if (node == 0) return
      if (bodies%body(node) == 0) return
      low = model%mesh%x(:, node)
      high = low
      do i = 1, model%mesh%nnode
         if (bodies%body(i) /= bodies%body(node)) cycle
         low = min(low, model%mesh%x(:, i))
         high = max(high, model%mesh%x(:, i))
      end do
      side = minval(high - low)
   end function side_of
end module lopin_body_size
