!> Bodies whose meshes meet node on node and that nothing joins: parts that were to be merged, tied
!> or in contact pass through each other.
module lopin_check_seams
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, surface_data_type
   implicit none
   private
   public :: check_seams

   !> Nodes nearer than this share of the model are at one place.
   real(wp), parameter :: one_place = 1.0e-7_wp
   !> More bodies than these are a pile of grains, whose seams are not looked at.
   integer, parameter :: most_bodies = 200

contains

   subroutine check_seams(model)
      type(model_type), intent(inout) :: model
      integer :: body(model%mesh%nnode), nbody
      logical, allocatable :: joined(:, :)
      integer, allocatable :: number(:, :), first(:, :)
      integer :: a, b

      call find_bodies(model, body, nbody)
      if (nbody < 2 .or. nbody > most_bodies) return
      allocate (joined(0:nbody, 0:nbody), source=.false.)
      allocate (number(nbody, nbody), first(nbody, nbody), source=0)
      call find_joints(model, body, joined)
      call count_seams(model, body, number, first)
      do a = 1, nbody
         do b = a + 1, nbody
            if (number(a, b) < model%mesh%ndim .or. joined(a, b) .or. joined(b, a)) cycle
            call model%log%say(severity%warning, 'W0306', 'two bodies have '// &
               & to_text(number(a, b))//' nodes at the same places, the first at node '// &
               & to_text(model%mesh%node_label(first(a, b)))//', and no pair, tie or equation '// &
               & 'joins them: they pass through each other', model%section(1)%at, &
               & help='merge the nodes, write *TIE, or *CONTACT PAIR')
         end do
      end do
   end subroutine check_seams

   !> Connected bodies of elements that deform; 0: nodes of none.
   subroutine find_bodies(model, body, nbody)
      type(model_type), intent(in) :: model
      integer, intent(out) :: body(:), nbody
      integer :: parent(size(body)), e, k, a, b

      parent = [(k, k=1, size(body))]
      body = 0
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         a = root_of(model%mesh%conn(1, e))
         do k = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(k, e) == 0) exit
            body(model%mesh%conn(k, e)) = 1
            b = root_of(model%mesh%conn(k, e))
            parent(max(a, b)) = min(a, b)
            a = min(a, b)
         end do
      end do
      nbody = 0
      do k = 1, size(body)
         if (body(k) == 0) cycle
         a = root_of(k)
         if (a == k) then
            nbody = nbody + 1
            body(k) = nbody
         else
            body(k) = body(a)
         end if
      end do

   contains

      integer function root_of(node)
         integer, intent(in) :: node

         root_of = node
         do while (parent(root_of) /= root_of)
            parent(root_of) = parent(parent(root_of))
            root_of = parent(root_of)
         end do
      end function root_of
   end subroutine find_bodies

   !> Bodies that a pair, an equation or a rigid body has to do with together.
   subroutine find_joints(model, body, joined)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body(:)
      logical, intent(inout) :: joined(0:, 0:)
      logical, dimension(0:ubound(joined, 1)) :: slave, master
      integer :: i, k

      do i = 1, size(model%pair)
         call mark(model, body, model%surface(model%pair(i)%slave), slave)
         call mark(model, body, model%surface(model%pair(i)%master), master)
         do k = 0, ubound(joined, 1)
            if (slave(k)) joined(:, k) = joined(:, k) .or. master
         end do
      end do
      do i = 1, size(model%equation)
         do k = 2, size(model%equation(i)%node)
            joined(body(model%equation(i)%node(1)), body(model%equation(i)%node(k))) = .true.
         end do
      end do
      do i = 1, size(model%rigid_body)
         slave = .false.
         slave(body(model%rigid_body(i)%node)) = .true.
         do k = 0, ubound(joined, 1)
            if (slave(k)) joined(:, k) = joined(:, k) .or. slave
         end do
      end do
      joined = joined .or. transpose(joined)
   end subroutine find_joints

   !> Bodies that have nodes of a surface.
   subroutine mark(model, body, surface, met)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body(:)
      type(surface_data_type), intent(in) :: surface
      logical, intent(out) :: met(0:)
      integer :: i

      met = .false.
      if (allocated(surface%node)) met(body(surface%node)) = .true.
      if (.not. allocated(surface%element)) return
      do i = 1, size(surface%element)
         met(body(model%mesh%conn(1, surface%element(i)))) = .true.
      end do
   end subroutine mark

   !> Nodes at one place, by body and body: along a line that no mesh is aligned with.
   subroutine count_seams(model, body, number, first)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body(:)
      integer, intent(inout) :: number(:, :), first(:, :)
      real(wp), parameter :: line(3) = [0.5377_wp, 0.6293_wp, 0.5612_wp]
      real(wp) :: along(size(body)), near
      integer :: order(size(body)), i, j, a, b

      associate (x => model%mesh%x)
         near = one_place*maxval(maxval(x, dim=2) - minval(x, dim=2))
         along = matmul(line(:size(x, 1)), x)
         order = sorted(along)
         do i = 1, size(order)
            if (body(order(i)) == 0) cycle
            do j = i + 1, size(order)
               if (along(order(j)) - along(order(i)) > near) exit
               a = min(body(order(i)), body(order(j)))
               b = max(body(order(i)), body(order(j)))
               if (a == 0 .or. a == b) cycle
               if (maxval(abs(x(:, order(i)) - x(:, order(j)))) > near) cycle
               number(a, b) = number(a, b) + 1
               if (number(a, b) == 1) first(a, b) = order(i)
            end do
         end do
      end associate
   end subroutine count_seams

   !> Positions in ascending order, by merging.
   pure function sorted(value) result(order)
      real(wp), intent(in) :: value(:)
      integer :: order(size(value)), merged(size(value))
      integer :: width, low, middle, high, i, j, k

      order = [(i, i=1, size(value))]
      width = 1
      do while (width < size(value))
         do low = 1, size(value), 2*width
            middle = min(low + width, size(value) + 1)
            high = min(low + 2*width, size(value) + 1)
            i = low
            j = middle
            do k = low, high - 1
               if (j >= high) then
                  merged(k) = order(i)
                  i = i + 1
               else if (i >= middle) then
                  merged(k) = order(j)
                  j = j + 1
               else if (value(order(i)) <= value(order(j))) then
                  merged(k) = order(i)
                  i = i + 1
               else
                  merged(k) = order(j)
                  j = j + 1
               end if
            end do
         end do
         order = merged
         width = 2*width
      end do
   end function sorted
end module lopin_check_seams
