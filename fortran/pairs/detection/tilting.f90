!> How many rows of contact keep the bodies of a pair from tilting where supports do not.
!>
!> A body whose supports leave it free to turn rests on two points in the plane and on three in
!> space: so many rows a pair keeps, however little of their facets is covered.
module lopin_tilting
   use lopin_kinds, only : wp
   use lopin_dense, only : symmetric_eigen
   use lopin_vectors, only : cross
   use lopin_model, only : model_type, surface_of
   use lopin_flat_elements, only : is_ring
   use lopin_bodies, only : bodies_type, connect
   implicit none
   private
   public :: rows_needed

   !> Squares of shares of a motion below this are rounding.
   real(wp), parameter :: none = 1.0e-12_wp

contains

   integer function rows_needed(model, pair) result(rows)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(bodies_type) :: bodies
      logical :: held(model%mesh%nnode)
      logical, allocatable :: asked(:)
      integer :: i

      rows = 1
      if (is_ring(model, model%pair(pair)%slave)) return
      call connect(bodies, model)
      call fully_held(model, held)
      allocate (asked(0:bodies%nbody), source=.false.)
      call ask_surface(model%pair(pair)%slave)
      call ask_surface(model%pair(pair)%master)
      do i = 1, bodies%nbody
         if (asked(i)) rows = max(rows, 1 + min(model%mesh%ndim - 1, free_turns(model, bodies, &
            & held, i)))
      end do

   contains

      subroutine ask_surface(surface)
         integer, intent(in) :: surface
         integer :: k

         associate (s => model%surface(surface))
            if (s%kind /= surface_of%faces) return
            do k = 1, size(s%element)
               asked(bodies%body(model%mesh%conn(1, s%element(k)))) = .true.
            end do
         end associate
      end subroutine ask_surface
   end function rows_needed

   !> Nodes that rigid bodies and equations lead: taken as supports in all directions.
   pure subroutine fully_held(model, held)
      type(model_type), intent(in) :: model
      logical, intent(out) :: held(:)
      integer :: i

      held = .false.
      do i = 1, size(model%rigid_body)
         if (allocated(model%rigid_body(i)%node)) held(model%rigid_body(i)%node) = .true.
      end do
      do i = 1, size(model%equation)
         held(model%equation(i)%node) = .true.
      end do
   end subroutine fully_held

   !> Independent rotations among the motions that supports leave to a body.
   integer function free_turns(model, bodies, held, body) result(turns)
      type(model_type), intent(in) :: model
      type(bodies_type), intent(in) :: bodies
      logical, intent(in) :: held(:)
      integer, intent(in) :: body
      real(wp) :: gram(6, 6), value(6), turn(3, 3)
      integer :: i, k, status

      gram = 0.0_wp
      if (model%mesh%ndim == 2) then
         do k = 3, 5
            gram(k, k) = 1.0_wp
         end do
      end if
      do i = 1, model%mesh%nnode
         if (bodies%body(i) /= body .or. .not. held(i)) cycle
         do k = 1, model%mesh%ndim
            call add_support(i, k)
         end do
      end do
      if (size(model%step) > 0) then
         associate (p => model%step(1)%prescribed)
            do i = 1, size(p)
               if (p(i)%dof > model%mesh%ndim .or. held(p(i)%node)) cycle
               if (bodies%body(p(i)%node) == body) call add_support(p(i)%node, p(i)%dof)
            end do
         end associate
      end if
      call symmetric_eigen(gram, value, status)
      turn = 0.0_wp
      do i = 1, count(value <= none*max(1.0_wp, value(6)))
         turn = turn + spread(gram(4:6, i), 2, 3)*spread(gram(4:6, i), 1, 3)
      end do
      call symmetric_eigen(turn, value(:3), status)
      turns = count(value(:3) > none)

   contains

      subroutine add_support(node, dof)
         integer, intent(in) :: node, dof
         real(wp) :: axis(3), arm(3), row(6)
         integer :: at

         axis = 0.0_wp
         axis(dof) = 1.0_wp
         at = 0
         if (allocated(model%transform%node)) at = findloc(model%transform%node, node, 1)
         if (at > 0) axis = model%transform%axes(dof, :, at)
         arm = 0.0_wp
         arm(:model%mesh%ndim) = model%mesh%x(:, node)
         arm = (arm - bodies%centre(:, body))/bodies%length
         row = [axis, cross(arm, axis)]
         gram = gram + spread(row, 2, 6)*spread(row, 1, 6)
      end subroutine add_support
   end function free_turns
end module lopin_tilting
