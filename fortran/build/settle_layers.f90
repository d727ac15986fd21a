!> Sheets that are one element thick: where their material flows, they have more points through the
!> thickness.
!>
!> The stress of a bent sheet jumps near the middle. Two Gauss points say a plastic moment up to
!> 19 % too large, three one 14 % too small; five in each half are within 1 %, three within 3 %.
module lopin_settle_layers
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_element_type, only : element_type, element_formulation, element_kind, new_element_type
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, boundary_facets
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type, kind_of
   implicit none
   private
   public :: settle_layers

   !> Opposite faces along each parametric direction of quads and of hexahedra.
   integer, parameter :: of_quad(2, 2) = reshape([4, 2, 1, 3], [2, 2])
   integer, parameter :: of_hexahedron(2, 3) = reshape([6, 4, 3, 5, 1, 2], [2, 3])

contains

   !> Give elements in one layer the word of their direction, and say how many there are.
   subroutine settle_layers(model)
      type(model_type), intent(inout) :: model
      type(element_type) :: element(size(model%element_word))
      logical, allocatable :: free(:, :)
      character(len=3) :: thin
      integer :: number(size(element), size(model%section)), e, k, word, section
      logical :: found

      do k = 1, size(element)
         call new_element_type(element(k), trim(model%element_word(k)), '', found)
      end do
      if (.not. any_can_bend(model, element)) return
      call find_free_faces(model, element, free)
      number = 0
      do e = 1, model%mesh%nelement
         word = model%mesh%etype(e)
         section = model%mesh%section(e)
         if (.not. can_bend(model, element, e)) cycle
         thin = thin_directions(model, element(word)%cell, e, free(:, e))
         if (thin == '') cycle
         number(word, section) = number(word, section) + 1
         call give_word(model, e, trim(element(word)%word)//'/'//trim(thin))
      end do
      do section = 1, size(model%section)
         do word = 1, size(element)
            if (number(word, section) > 0) call say_layer(model, trim(element(word)%word), &
               & section, number(word, section))
         end do
      end do
   end subroutine settle_layers

   !> Some element is of a word that bends, and flows.
   logical function any_can_bend(model, element) result(any_)
      type(model_type), intent(in) :: model
      type(element_type), intent(in) :: element(:)
      integer :: e

      any_ = .false.
      do e = 1, model%mesh%nelement
         any_ = can_bend(model, element, e)
         if (any_) return
      end do
   end function any_can_bend

   !> Quads and bricks that bend in one layer: enhanced or quadratic, of a material that flows.
   logical function can_bend(model, element, e) result(can)
      type(model_type), intent(in) :: model
      type(element_type), intent(in) :: element(:)
      integer, intent(in) :: e

      can = .false.
      if (model%mesh%section(e) == 0) return
      associate (own => element(model%mesh%etype(e)), section => model%section( &
         & model%mesh%section(e)))
         if (own%kind == element_kind%rigid .or. any(own%layered)) return
         if (section%formulation == 'FULL' .or. section%material == 0) return
         if (all(own%cell%name /= [character(len=12) :: 'quad', 'quad8', 'hexahedron', &
            & 'hexahedron20'])) return
         if (.not. own%cell%quadratic .and. own%formulation /= element_formulation%enhanced) return
         can = flows(model%material(section%material)%flow)
      end associate
   end function can_bend

   !> Faces that only one element has.
   subroutine find_free_faces(model, element, free)
      type(model_type), intent(in) :: model
      type(element_type), intent(in) :: element(:)
      logical, allocatable, intent(out) :: free(:, :)   !! (6, nelement)
      type(facets_type) :: skin
      logical, allocatable :: shared(:)
      integer :: i

      allocate (free(6, model%mesh%nelement), source=.false.)
      call boundary_facets(skin, model%mesh, element%cell, [(i, i=1, model%mesh%nelement)], &
         & model%kind == kind_of%axisymmetric, shared)
      do i = 1, skin%n
         free(skin%face(i), skin%element(i)) = .true.
      end do
   end subroutine find_free_faces

   !> The parametric directions with free faces at both ends: one of a sheet, two of a bar, the
   !> shorter two of an element that stands alone.
   pure function thin_directions(model, cell, e, free) result(thin)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell
      integer, intent(in) :: e
      logical, intent(in) :: free(:)           !! (6)
      character(len=3) :: thin                 !! '', '1', '23' ...
      real(wp) :: length(cell%ndim)
      logical :: is(cell%ndim)
      integer :: d, ends(2)

      do d = 1, cell%ndim
         if (cell%ndim == 2) ends = of_quad(:, d)
         if (cell%ndim == 3) ends = of_hexahedron(:, d)
         is(d) = all(free(ends))
         length(d) = norm2(middle(ends(2)) - middle(ends(1)))
      end do
      if (all(is)) is(maxloc(length, dim=1)) = .false.
      thin = ''
      do d = 1, cell%ndim
         if (is(d)) thin = trim(thin)//to_text(d)
      end do

   contains

      !> Of the corners of a face.
      pure function middle(face) result(x)
         integer, intent(in) :: face
         real(wp) :: x(cell%ndim)
         integer :: m

         m = 2*(cell%ndim - 1)
         x = sum(model%mesh%x(:, model%mesh%conn(cell%face_node(:m, face), e)), dim=2)/real(m, wp)
      end function middle
   end function thin_directions

   !> Make the element one of a word that is appended if it is new.
   subroutine give_word(model, e, word)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: e
      character(len=*), intent(in) :: word
      integer :: k

      k = findloc(model%element_word == word, .true., dim=1)
      if (k == 0) then
         model%element_word = [character(len=10) :: model%element_word, word]
         k = size(model%element_word)
      end if
      model%mesh%etype(e) = k
   end subroutine give_word

   subroutine say_layer(model, word, section, number)
      type(model_type), intent(inout) :: model
      character(len=*), intent(in) :: word
      integer, intent(in) :: section, number

      call model%log%say(severity%note, 'N0213', to_text(number)//' '//word//' of material `'// &
         & model%material(model%section(section)%material)%name// &
         & '` lie in one layer: '//merge('ten', 'six', model%mesh%ndim == 2)// &
         & ' points through the thickness', model%section(section)%at)
   end subroutine say_layer
end module lopin_settle_layers
