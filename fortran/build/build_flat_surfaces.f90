!> Which surfaces of an axisymmetric scene lie on plane elements.
module lopin_build_flat_surfaces
   use lopin_model, only : model_type, kind_of, surface_of
   use lopin_flat_elements, only : is_flat
   use lopin_block, only : complain
   implicit none
   private
   public :: find_flat_surfaces

contains

   !> A surface goes around the axis, or has a thickness: not both.
   subroutine find_flat_surfaces(model)
      type(model_type), intent(inout) :: model
      logical :: of_ring(model%mesh%nnode), flat(model%mesh%nelement)
      logical, allocatable :: own(:)
      integer :: e, k, s

      if (model%kind /= kind_of%axisymmetric) return
      flat = is_flat(model, [(e, e=1, model%mesh%nelement)])
      if (.not. any(flat)) return
      of_ring = .false.
      do e = 1, model%mesh%nelement
         if (flat(e)) cycle
         do k = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(k, e) > 0) of_ring(model%mesh%conn(k, e)) = .true.
         end do
      end do
      do s = 1, size(model%surface)
         associate (surface => model%surface(s))
            if (surface%kind == surface_of%faces) then
               own = flat(surface%element)
            else if (surface%kind == surface_of%nodes) then
               own = .not. of_ring(surface%node)
            else
               cycle
            end if
            if (any(own) .and. .not. all(own)) call complain(model%log, 'E0301', 'surface `'// &
               & surface%name//'` lies on plane and on axisymmetric elements', surface%at, &
               & help='one surface for each: the one has a thickness, the other goes around '// &
               & 'the axis')
            surface%flat = all(own) .and. size(own) > 0
         end associate
      end do
   end subroutine find_flat_surfaces
end module lopin_build_flat_surfaces
