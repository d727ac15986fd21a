!> Mid-side nodes that hang on the edge of an element of first order: the edge of one element bends
!> and the other's stays straight, so that a gap opens in the mesh there.
module lopin_check_hanging
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_build_scene, only : scene_type
   implicit none
   private
   public :: check_hanging

contains

   subroutine check_hanging(model, scene)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer, allocatable :: first(:), end_(:), owner(:)
      logical :: held(model%mesh%nnode)
      integer :: e, k, a, b, j, node, hanging, at(3)

      if (.not. (has_order(.false.) .and. has_order(.true.))) return
      call list_straight_edges(model, scene, first, end_, owner)
      call find_held(model, held)
      hanging = 0
      at = 0
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         associate (cell => scene%etype(model%mesh%etype(e))%cell, conn => model%mesh%conn(:, e))
            if (.not. cell%quadratic) cycle
            do k = 1, count(cell%edge(1, :) > 0)
               a = minval(conn(cell%edge(:, k)))
               b = maxval(conn(cell%edge(:, k)))
               node = conn(cell%ncorner + k)
               if (held(node)) cycle
               do j = first(a), first(a + 1) - 1
                  if (end_(j) /= b) cycle
                  hanging = hanging + 1
                  if (hanging == 1) at = [node, e, owner(j)]
                  held(node) = .true.
                  exit
               end do
            end do
         end associate
      end do
      if (hanging == 0) return
      call model%log%say(severity%warning, 'W0309', 'node '// &
         & to_text(model%mesh%node_label(at(1)))//' in the middle of an edge of element '// &
         & to_text(model%mesh%element_label(at(2)))//' hangs on the edge of element '// &
         & to_text(model%mesh%element_label(at(3)))//', which stays straight; there are '// &
         & to_text(hanging)//' such nodes', model%section(model%mesh%section(at(2)))%at, &
         & help='give both elements one order, or hold the node by *EQUATION, 2 u = u1 + u2')

   contains

      logical function has_order(quadratic)
         logical, intent(in) :: quadratic
         integer :: i

         has_order = .false.
         do i = 1, model%mesh%nelement
            if (model%mesh%section(i) == 0) cycle
            has_order = scene%etype(model%mesh%etype(i))%cell%quadratic .eqv. quadratic
            if (has_order) return
         end do
      end function has_order
   end subroutine check_hanging

   !> Edges of elements of first order, by the lesser of their nodes.
   subroutine list_straight_edges(model, scene, first, end_, owner)
      type(model_type), intent(in) :: model
      type(scene_type), intent(in) :: scene
      integer, allocatable, intent(out) :: first(:)            !! (nnode+1) into the others
      integer, allocatable, intent(out) :: end_(:), owner(:)   !! greater node; element
      integer :: e, k, a, pass, place(model%mesh%nnode)

      allocate (first(model%mesh%nnode + 1))
      place = 0
      do pass = 1, 2
         do e = 1, model%mesh%nelement
            if (model%mesh%section(e) == 0) cycle
            associate (cell => scene%etype(model%mesh%etype(e))%cell)
               if (cell%quadratic) cycle
               do k = 1, count(cell%edge(1, :) > 0)
                  a = minval(model%mesh%conn(cell%edge(:, k), e))
                  place(a) = place(a) + 1
                  if (pass == 1) cycle
                  end_(place(a) - 1) = maxval(model%mesh%conn(cell%edge(:, k), e))
                  owner(place(a) - 1) = e
               end do
            end associate
         end do
         if (pass == 2) exit
         first(1) = 1
         do k = 1, size(place)
            first(k + 1) = first(k) + place(k)
         end do
         allocate (end_(first(size(first)) - 1), owner(first(size(first)) - 1))
         place = first(:size(place))
      end do
   end subroutine list_straight_edges

   !> Nodes that an equation or a rigid body moves.
   pure subroutine find_held(model, held)
      type(model_type), intent(in) :: model
      logical, intent(out) :: held(:)
      integer :: i

      held = .false.
      do i = 1, size(model%equation)
         held(model%equation(i)%node) = .true.
      end do
      do i = 1, size(model%rigid_body)
         held(model%rigid_body(i)%node) = .true.
      end do
   end subroutine find_held
end module lopin_check_hanging
