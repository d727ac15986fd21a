!> Plane elements that stand in an axisymmetric scene, as bolts, ribs and slots do.
!>
!> They are as thick as all of their kind around the circumference; surfaces on them have that
!> thickness in the place of 2 pi r.
module lopin_flat_elements
   use lopin_model, only : model_type, kind_of
   implicit none
   private
   public :: is_flat, is_ring, ring_bodies

contains

   !> The element has a thickness.
   elemental logical function is_flat(model, element)
      type(model_type), intent(in) :: model
      integer, intent(in) :: element

      is_flat = model%element_word(model%mesh%etype(element))(:2) == 'CP'
   end function is_flat

   !> Areas of the surface go around the axis.
   elemental logical function is_ring(model, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface           !! 0: none

      is_ring = model%kind == kind_of%axisymmetric
      if (is_ring .and. surface > 0) is_ring = .not. model%surface(surface)%flat
   end function is_ring

   !> Bodies of an axisymmetric scene with elements that go around the axis.
   pure function ring_bodies(model, body, nbody) result(ring)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body(:)           !! (nnode) of each node; 0: none
      integer, intent(in) :: nbody
      logical :: ring(nbody)
      integer :: e

      ring = .false.
      if (model%kind /= kind_of%axisymmetric) return
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0 .or. is_flat(model, e)) cycle
         ring(body(model%mesh%conn(1, e))) = .true.
      end do
   end function ring_bodies
end module lopin_flat_elements
