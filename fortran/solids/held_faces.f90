!> Faces of elements that supports hold along their normal in every step: they stay planes, and
!> nothing bends across them.
module lopin_held_faces
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_type
   use lopin_model, only : model_type
   implicit none
   private
   public :: close_held

   !> Square of the share of a normal that supports must hold.
   real(wp), parameter :: along = 1.0_wp - 1.0e-6_wp

contains

   !> Free faces that supports hold along their normal are none: -1 stands in their place.
   subroutine close_held(model, cells, beyond)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)  !! cell of each element type
      integer, intent(inout) :: beyond(:, :)   !! (6, nelement) element beyond a face; 0: free
      logical :: held(3, model%mesh%nnode)
      integer :: axes(model%mesh%nnode), e, f, i

      held = held_throughout(model)
      if (.not. any(held)) return
      axes = 0
      if (allocated(model%transform%node)) axes(model%transform%node) = &
         & [(i, i=1, size(model%transform%node))]
      do e = 1, model%mesh%nelement
         associate (cell => cells(model%mesh%etype(e)))
            if (cell%sided) cycle
            do f = 1, cell%nface
               if (beyond(f, e) /= 0) cycle
               associate (node => model%mesh%conn(cell%face_node(:cell%face_nnode(f), f), e))
                  if (all_hold(model, held, axes, node, cell%ndim)) beyond(f, e) = -1
               end associate
            end do
         end associate
      end do
   end subroutine close_held

   !> Directions in which nodes are held in all steps.
   pure function held_throughout(model) result(held)
      type(model_type), intent(in) :: model
      logical :: held(3, model%mesh%nnode), now(3, model%mesh%nnode)
      integer :: s, i

      held = size(model%step) > 0
      do s = 1, size(model%step)
         now = .false.
         do i = 1, size(model%step(s)%prescribed)
            associate (p => model%step(s)%prescribed(i))
               if (p%dof <= 3 .and. .not. abs(p%value) > 0.0_wp) now(p%dof, p%node) = .true.
            end associate
         end do
         held = held .and. now
      end do
   end function held_throughout

   !> All nodes of a face are held along its normal.
   pure logical function all_hold(model, held, axes, node, ndim) result(hold)
      type(model_type), intent(in) :: model
      logical, intent(in) :: held(:, :)        !! (3, nnode) in the axes of the node
      integer, intent(in) :: axes(:)           !! (nnode) its axes; 0: the global ones
      integer, intent(in) :: node(:), ndim     !! corners first
      real(wp) :: normal(3), axis(3), share
      integer :: k, d

      hold = .false.
      normal = normal_of(model%mesh%x(:, node), ndim)
      do k = 1, size(node)
         share = 0.0_wp
         do d = 1, ndim
            if (.not. held(d, node(k))) cycle
            axis = 0.0_wp
            axis(d) = 1.0_wp
            if (axes(node(k)) > 0) axis = model%transform%axes(d, :, axes(node(k)))
            share = share + dot_product(axis, normal)**2
         end do
         if (.not. share > along) return
      end do
      hold = .true.
   end function all_hold

   !> Unit normal of a face; its sign does not matter.
   pure function normal_of(x, ndim) result(n)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nodes) [length]
      integer, intent(in) :: ndim
      real(wp) :: n(3), a(3), b(3)

      n = 0.0_wp
      if (ndim == 2) then
         n(:2) = [x(2, 1) - x(2, 2), x(1, 2) - x(1, 1)]
      else
         a = x(:, 3) - x(:, 1)
         b = x(:, merge(4, 1, size(x, 2) == 4 .or. size(x, 2) == 8)) - x(:, 2)
         n = cross(a, b)
      end if
      n = n/max(norm2(n), tiny(1.0_wp))
   end function normal_of
end module lopin_held_faces
