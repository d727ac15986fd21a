!> Which elements lie in a sheet, and how many of them lie through its thickness.
!>
!> Quads and bricks are looked at along their parametric directions, from one free face to the
!> other.
module lopin_sheet_layers
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_face_numbers, only : find_neighbours
   use lopin_quadrature, only : points_in_half
   use lopin_model, only : model_type, kind_of
   use lopin_held_faces, only : close_held
   implicit none
   private
   public :: find_beyond, layers_of, go_on, is_product, face_of

   !> Opposite faces along each parametric direction of quads and of hexahedra.
   integer, parameter :: of_quad(2, 2) = reshape([4, 2, 1, 3], [2, 2])
   integer, parameter :: of_hexahedron(2, 3) = reshape([6, 4, 3, 5, 1, 2], [2, 3])
   !> Elements that are looked at along a sheet.
   integer, parameter :: most_steps = 1000
   !> Length of a sheet of several layers by its thickness, at least.
   real(wp), parameter :: long = 5.0_wp

contains

   !> The element beyond each face of each; 0: none, -1: the other half of a body about an axis, or
   !> a support that keeps the face in its plane.
   subroutine find_beyond(model, cells, beyond)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)   !! of the words
      integer, allocatable, intent(out) :: beyond(:, :)

      call find_neighbours(model%mesh, cells, beyond)
      if (model%kind == kind_of%axisymmetric) call close_axis(model, cells, beyond)
      call close_held(model, cells, beyond)
   end subroutine find_beyond

   !> Edges on the axis have the other half of the body beyond them.
   subroutine close_axis(model, cells, beyond)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(inout) :: beyond(:, :)
      type(facets_type) :: skin
      logical, allocatable :: shared(:)
      integer :: i

      where (beyond == 0) beyond = -1
      call boundary_facets(skin, model%mesh, cells, [(i, i=1, model%mesh%nelement)], .true., &
         & shared)
      do i = 1, skin%n
         beyond(skin%face(i), skin%element(i)) = 0
      end do
   end subroutine close_axis

   !> Layers of a sheet along each parametric direction; 0: no sheet. One element between free faces
   !> is one layer, but for the longest way of an element that stands alone. Several are layers if
   !> the body is long beside them.
   pure function layers_of(model, cells, e, beyond) result(layers)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: e, beyond(:, :)
      integer :: layers(3), d, ndim
      real(wp) :: thick(3)
      logical :: bar

      ndim = model%mesh%ndim
      layers = 0
      thick = huge(1.0_wp)
      do d = 1, ndim
         call count_layers(model, cells, e, d, beyond, layers(d), thick(d))
      end do
      if (all(layers(:ndim) == 1)) layers(maxloc(thick(:ndim), dim=1)) = 0
      do d = 1, ndim
         if (layers(d) < 2) cycle
         if (is_long(model, cells, e, d, beyond, long*thick(d))) then
            where (layers == 1 .and. thick > long*thick(d)) layers = 0
         else
            layers(d) = 0
         end if
      end do
      if (count(layers > 1) < 2) return
      ! What has few layers in two directions is a sheet if it is wide, else a bar.
      d = minloc(thick, dim=1, mask=layers > 1)
      bar = count(layers > 1 .and. thick <= long*thick(d)) > 1
      where (layers > 1 .and. (bar .or. thick > long*thick(d))) layers = 0
   end function layers_of

   !> Elements between the free faces of both ends of a direction; 0: too many to be a sheet.
   pure subroutine count_layers(model, cells, e, d, beyond, layers, thick)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: e, d, beyond(:, :)
      integer, intent(out) :: layers
      real(wp), intent(out) :: thick           !! [length]
      integer :: side, at, out, next

      layers = 1
      thick = length_along(model, cells, e, d)
      do side = 1, 2
         at = e
         out = face_of(model%mesh%ndim, d, side)
         do
            if (beyond(out, at) == 0) exit
            call go_on(cells, model%mesh%etype, beyond, at, out, next)
            layers = layers + 1
            if (next == 0 .or. points_in_half(model%mesh%ndim, layers) == 0) then
               layers = 0
               return
            end if
            thick = thick + length_along(model, cells, at, (next + 1)/2)
         end do
      end do
   end subroutine count_layers

   !> The body goes on for a length square to a direction.
   pure logical function is_long(model, cells, e, d, beyond, length)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: e, d, beyond(:, :)
      real(wp), intent(in) :: length
      integer :: other, side, at, out, next, i
      real(wp) :: far

      is_long = .true.
      do other = 1, model%mesh%ndim
         if (other == d) cycle
         far = length_along(model, cells, e, other)
         sides: do side = 1, 2
            at = e
            out = face_of(model%mesh%ndim, other, side)
            do i = 1, most_steps
               if (far > length) return
               if (beyond(out, at) <= 0) exit
               call go_on(cells, model%mesh%etype, beyond, at, out, next)
               if (next == 0) exit
               if (at == e) exit sides          ! once round a ring
               far = far + length_along(model, cells, at, (next + 1)/2)
            end do
         end do sides
         if (far > length) return
      end do
      is_long = .false.
   end function is_long

   !> Through a face into the element beyond it, and to its opposite face: `next` is the place of
   !> that in the table, 0 where there is no quad or brick.
   pure subroutine go_on(cells, etype, beyond, at, out, next)
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: etype(:), beyond(:, :)
      integer, intent(inout) :: at, out        !! element, face by which it is left
      integer, intent(out) :: next
      integer :: from, ndim, k

      next = 0
      from = at
      if (beyond(out, from) <= 0) return
      at = beyond(out, from)
      if (.not. is_product(cells(etype(at)))) return
      ndim = cells(etype(at))%ndim
      do k = 1, 2*ndim
         if (beyond(face_of(ndim, (k + 1)/2, 1 + mod(k + 1, 2)), at) /= from) cycle
         next = k + merge(1, -1, mod(k, 2) == 1)
         out = face_of(ndim, (next + 1)/2, 1 + mod(next + 1, 2))
         return
      end do
   end subroutine go_on

   pure logical function is_product(cell)
      type(cell_type), intent(in) :: cell

      is_product = any(cell%name == [character(len=12) :: 'quad', 'quad8', 'hexahedron', &
         & 'hexahedron20'])
   end function is_product

   pure integer function face_of(ndim, direction, side)
      integer, intent(in) :: ndim, direction, side

      face_of = merge(of_quad(side, min(direction, 2)), of_hexahedron(side, direction), ndim == 2)
   end function face_of

   !> Between the middles of opposite faces, of their corners [length].
   pure real(wp) function length_along(model, cells, e, direction) result(length)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: e, direction
      real(wp) :: way(model%mesh%ndim)
      integer :: m, n

      n = model%mesh%ndim
      m = 2*(n - 1)
      associate (cell => cells(model%mesh%etype(e)), conn => model%mesh%conn(:, e))
         way = sum(model%mesh%x(:, conn(cell%face_node(:m, face_of(n, direction, 2)))), dim=2) &
            & - sum(model%mesh%x(:, conn(cell%face_node(:m, face_of(n, direction, 1)))), dim=2)
      end associate
      length = norm2(way)/real(m, wp)
   end function length_along
end module lopin_sheet_layers
