!> Advice on slaves that are much finer or coarser than their masters where both deform alike.
!>
!> By measurement (docs/accuracy.md): the force has what the coarser side has to give; pressures of
!> a finer slave follow the facets of its master, and a coarser slave at its nodes lets facets of
!> the master through.
module lopin_advise_slaves
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type, pair_type, surface_of
   implicit none
   private
   public :: advise_slaves

   !> Facets of the master by those of the slave, from where the slave is finer than pays; of the
   !> slave by the master's, from where it is too coarse: at nodes, in the mean.
   real(wp), parameter :: finer = 3.0_wp, coarser(2) = [1.5_wp, 3.0_wp]
   !> Moduli that differ by more are no like bodies.
   real(wp), parameter :: alike = 5.0_wp
   !> Facets whose median is looked for.
   integer, parameter :: most = 400

contains

   subroutine advise_slaves(model)
      type(model_type), intent(inout) :: model
      type(cell_type), allocatable :: cell(:)
      real(wp) :: slave, master
      integer :: p, n

      call cells_of_words(model%element_word, cell)
      do p = 1, size(model%pair)
         associate (pair => model%pair(p))
            if (pair%tied .or. pair%slave == 0 .or. pair%master == 0 &
               & .or. pair%slave == pair%master) cycle
            if (.not. deform_alike(model, pair)) cycle
            slave = size_of(model, cell, pair%slave, pair%master)
            master = size_of(model, cell, pair%master, pair%slave)
            if (.not. (slave > 0.0_wp .and. master > 0.0_wp)) cycle
            ! What says no TYPE may go surface to surface in linear scenes of the plane.
            n = merge(2, 1, pair%surface_to_surface .or. (pair%open .and. model%mesh%ndim == 2 &
               & .and. .not. any(model%step%nlgeom)))
            if (master > finer*slave) then
               call model%log%say(severity%note, 'N0367', 'facets of slave '// &
                  & model%surface(pair%slave)%name//' are '//to_text(master/slave, 2)// &
                  & ' times as small as those of master '//model%surface(pair%master)%name, &
                  & pair%at, help='the force is as good with a slave of three times the size, '// &
                  & 'and pressures follow the facets of the master less; or refine the master too')
            else if (slave > coarser(n)*master) then
               call model%log%say(severity%note, 'N0367', 'facets of slave '// &
                  & model%surface(pair%slave)%name//' are '//to_text(slave/master, 2)// &
                  & ' times as large as those of master '//model%surface(pair%master)%name, &
                  & pair%at, help='exchange slave and master: between nodes that are so far '// &
                  & 'apart the master comes through')
            end if
         end associate
      end do
   end subroutine advise_slaves

   !> Both sides are faces of elastic elements of moduli that hardly differ.
   logical function deform_alike(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      real(wp) :: young(2)

      young = [modulus(model, pair%slave), modulus(model, pair%master)]
      deform_alike = minval(young) > 0.0_wp .and. maxval(young) <= alike*minval(young)
   end function deform_alike

   !> Modulus of the elements behind a surface; 0 if it is none of elements, or they are rigid.
   real(wp) function modulus(model, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      integer :: section

      modulus = 0.0_wp
      associate (s => model%surface(surface))
         if (s%kind /= surface_of%faces .or. .not. allocated(s%element)) return
         if (size(s%element) == 0) return
         section = model%mesh%section(s%element(1))
         if (section == 0 .or. any(model%mesh%section(s%element) /= section)) return
         if (model%section(section)%material == 0) return
         associate (m => model%material(model%section(section)%material))
            if (m%has_elastic) modulus = m%young
         end associate
      end associate
   end function modulus

   !> Median size of the facets of a surface that lie near another; 0: none [length].
   real(wp) function size_of(model, cell, surface, other)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      integer, intent(in) :: surface, other
      real(wp), allocatable :: own(:), middle(:, :), far(:), beyond(:, :)
      real(wp) :: box(model%mesh%ndim, 2)
      integer :: i

      call facets_of(model, cell, surface, own, middle)
      call facets_of(model, cell, other, far, beyond)
      box(:, 1) = minval(beyond, dim=2) - maxval(far)
      box(:, 2) = maxval(beyond, dim=2) + maxval(far)
      own = pack(own, [(all(middle(:, i) >= box(:, 1) .and. middle(:, i) <= box(:, 2)), &
         & i=1, size(own))])
      own = own(1::1 + size(own)/most)
      size_of = 0.0_wp
      do i = 1, size(own)
         if (2*count(own <= own(i)) > size(own) .and. 2*count(own < own(i)) <= size(own)) &
            & size_of = own(i)
      end do
   end function size_of

   !> Mean edges and middles of the facets of a surface.
   subroutine facets_of(model, cell, surface, length, middle)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cell(:)
      integer, intent(in) :: surface
      real(wp), allocatable, intent(out) :: length(:)      !! (facet) [length]
      real(wp), allocatable, intent(out) :: middle(:, :)   !! (ndim, facet) [length]
      real(wp) :: x(model%mesh%ndim, 4)
      integer :: i, k, n

      associate (s => model%surface(surface))
         allocate (length(size(s%element)), middle(model%mesh%ndim, size(s%element)))
         do i = 1, size(s%element)
            associate (c => cell(model%mesh%etype(s%element(i))))
               n = c%face_nnode(s%face(i))
               if (model%mesh%ndim == 2) then
                  n = 2
               else if (c%nnode > c%ncorner) then
                  n = n/2
               end if
               x(:, :n) = model%mesh%x(:, model%mesh%conn(c%face_node(:n, s%face(i)), s%element(i)))
            end associate
            length(i) = sum([(norm2(x(:, 1 + mod(k, n)) - x(:, k)), k=1, n)])/n
            middle(:, i) = sum(x(:, :n), dim=2)/n
         end do
      end associate
   end subroutine facets_of
end module lopin_advise_slaves
