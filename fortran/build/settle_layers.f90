!> Sheets of one layer of elements or of few: where their material flows, they have more points
!> through the thickness.
!>
!> The stress of a bent sheet jumps near the middle. Two Gauss points say a plastic moment up to
!> 19 % too large, three one 14 % too small; five in each half are within 1 %, three within 3 %.
!> Two layers of two points each lose 1.5 % of the moment at R/t = 20 and 5 % at 5: where the metal
!> hardens by less, a strip bends in places, and its shape is another.
module lopin_settle_layers
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_element_type, only : element_type, element_formulation, element_kind, new_element_type
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_face_numbers, only : find_neighbours
   use lopin_quadrature, only : points_in_half
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type, kind_of
   implicit none
   private
   public :: settle_layers

   !> Opposite faces along each parametric direction of quads and of hexahedra.
   integer, parameter :: of_quad(2, 2) = reshape([4, 2, 1, 3], [2, 2])
   integer, parameter :: of_hexahedron(2, 3) = reshape([6, 4, 3, 5, 1, 2], [2, 3])
   !> Digits of a word; elements that are looked at along a sheet.
   integer, parameter :: most_layers = 9, most_steps = 1000
   !> Length of a sheet of several layers by its thickness, at least.
   real(wp), parameter :: long = 5.0_wp

contains

   !> Give elements of sheets the word of their layers, and say how many there are.
   subroutine settle_layers(model)
      type(model_type), intent(inout) :: model
      type(element_type) :: element(size(model%element_word))
      integer, allocatable :: beyond(:, :)
      integer :: number(size(element), size(model%section), most_layers)
      integer :: layers(3, model%mesh%nelement), named(model%mesh%nelement)
      integer :: e, k, word, section
      logical :: found

      do k = 1, size(element)
         call new_element_type(element(k), trim(model%element_word(k)), '', found)
      end do
      named = points_named(model)
      if (.not. any_can_bend(model, element, named)) return
      call find_neighbours(model%mesh, element%cell, beyond)
      if (model%kind == kind_of%axisymmetric) call close_axis(model, element%cell, beyond)
      layers = 0
      do e = 1, model%mesh%nelement
         if (can_bend(model, element, e, named)) layers(:, e) = layers_of(model, element%cell, e, &
            & beyond)
      end do
      do e = 1, model%mesh%nelement
         if (any(layers(:, e) > 1)) call share_with_stack(model, element, e, named, beyond, layers)
      end do
      number = 0
      do e = 1, model%mesh%nelement
         k = maxval(layers(:, e))
         if (k == 0) cycle
         word = model%mesh%etype(e)
         section = model%mesh%section(e)
         number(word, section, k) = number(word, section, k) + 1
         call give_word(model, e, layer_word(element(word)%word, layers(:model%mesh%ndim, e)))
      end do
      do section = 1, size(model%section)
         do word = 1, size(element)
            do k = 1, most_layers
               if (number(word, section, k) > 0) call say_layers(model, trim(element(word)%word), &
                  & section, k, number(word, section, k))
            end do
         end do
      end do
   end subroutine settle_layers

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

   !> The word of an element with so many layers along each direction.
   pure function layer_word(word, layers) result(text)
      character(len=*), intent(in) :: word
      integer, intent(in) :: layers(:)
      character(len=:), allocatable :: text
      integer :: d

      text = trim(word)//'/'
      do d = 1, size(layers)
         text = text//achar(iachar('0') + layers(d))
      end do
   end function layer_word

   !> Some element is of a word that bends, and flows.
   logical function any_can_bend(model, element, named) result(any_)
      type(model_type), intent(in) :: model
      type(element_type), intent(in) :: element(:)
      integer, intent(in) :: named(:)
      integer :: e

      any_ = .false.
      do e = 1, model%mesh%nelement
         any_ = can_bend(model, element, e, named)
         if (any_) return
      end do
   end function any_can_bend

   !> Largest number of a point of which the deck says a stress or a state, by element; 0: none.
   pure function points_named(model) result(named)
      type(model_type), intent(in) :: model
      integer :: named(model%mesh%nelement), i

      named = 0
      do i = 1, size(model%initial_stress)
         associate (start => model%initial_stress(i))
            named(start%element) = max(named(start%element), start%point)
         end associate
      end do
      do i = 1, size(model%initial_state)
         associate (start => model%initial_state(i))
            named(start%element) = max(named(start%element), start%point)
         end associate
      end do
   end function points_named

   !> Quads and bricks that bend in one layer: enhanced or quadratic, of a material that flows.
   !> Where the deck names the usual points, these stay.
   logical function can_bend(model, element, e, named) result(can)
      type(model_type), intent(in) :: model
      type(element_type), intent(in) :: element(:)
      integer, intent(in) :: e, named(:)

      can = .false.
      if (model%mesh%section(e) == 0) return
      associate (own => element(model%mesh%etype(e)), section => model%section( &
         & model%mesh%section(e)))
         if (own%kind == element_kind%rigid .or. any(own%layers > 0)) return
         if (section%formulation == 'FULL' .or. section%material == 0) return
         if (.not. is_product(own%cell)) return
         if (named(e) > 0 .and. named(e) <= own%ngauss) return
         if (.not. own%cell%quadratic .and. own%formulation /= element_formulation%enhanced) return
         can = flows(model%material(section%material)%flow)
      end associate
   end function can_bend

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

   !> Elements above and below lie in the same sheet, though their own rows may be shorter.
   subroutine share_with_stack(model, element, e, named, beyond, layers)
      type(model_type), intent(in) :: model
      type(element_type), intent(in) :: element(:)
      integer, intent(in) :: e, named(:), beyond(:, :)
      integer, intent(inout) :: layers(:, :)
      integer :: d, side, at, out, next

      do d = 1, model%mesh%ndim
         if (layers(d, e) < 2) cycle
         do side = 1, 2
            at = e
            out = face_of(model%mesh%ndim, d, side)
            do
               if (beyond(out, at) <= 0) exit
               call go_on(element%cell, model%mesh%etype, beyond, at, out, next)
               if (next == 0) exit
               if (can_bend(model, element, at, named)) layers((next + 1)/2, at) = layers(d, e)
            end do
         end do
      end do
   end subroutine share_with_stack

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

   !> Make the element one of a word that is appended if it is new.
   subroutine give_word(model, e, word)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: e
      character(len=*), intent(in) :: word
      integer :: k

      k = findloc(model%element_word == word, .true., dim=1)
      if (k == 0) then
         model%element_word = [character(len=len(model%element_word)) :: model%element_word, word]
         k = size(model%element_word)
      end if
      model%mesh%etype(e) = k
   end subroutine give_word

   subroutine say_layers(model, word, section, layers, number)
      type(model_type), intent(inout) :: model
      character(len=*), intent(in) :: word
      integer, intent(in) :: section, layers, number
      character(len=:), allocatable :: lie

      lie = ' lie in one layer: '
      if (layers > 1) lie = ' lie in '//to_text(layers)//' layers: '
      call model%log%say(severity%note, 'N0213', to_text(number)//' '//word//' of material `'// &
         & model%material(model%section(section)%material)%name//'`'//lie// &
         & to_text(2*points_in_half(model%mesh%ndim, layers))//' points through the thickness'// &
         & trim(merge(' of each', '        ', layers > 1)), model%section(section)%at)
   end subroutine say_layers
end module lopin_settle_layers
