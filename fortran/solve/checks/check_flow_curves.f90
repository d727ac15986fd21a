!> Flow curves that end before the strain does.
module lopin_check_flow_curves
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_solid_memory, only : at_all_points
   use lopin_material_memory, only : strain_at
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   use lopin_flow_curve, only : table_end
   implicit none
   private
   public :: check_flow_curves

contains

   !> Say once of each material that its plastic strain has passed the end of its table.
   subroutine check_flow_curves(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: strain(:)
      real(wp) :: last(size(model%material)), most(size(model%material)), own
      integer :: worst(size(model%material)), e, k

      if (.not. scene%newton%in_use) return
      if (.not. scene%newton%flows) return
      last = [(table_end(model%material(k)%flow), k=1, size(last))]
      if (.not. any(last < huge(1.0_wp))) return
      strain = at_all_points(scene%accepted%solids, scene%solids, &
         & strain_at(merge(4, 6, model%mesh%ndim == 2)))
      most = 0.0_wp
      worst = 0
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         k = model%section(model%mesh%section(e))%material
         own = maxval(strain(scene%solids%first_point(e):scene%solids%first_point(e + 1) - 1))
         if (own <= max(last(k), most(k))) cycle
         most(k) = own
         worst(k) = e
      end do
      do k = 1, size(worst)
         if (worst(k) == 0) cycle
         call warn_once(scene%log, 'W0510', 'the plastic strain in material `'// &
            & model%material(k)%name//'` passes the end of its table, '//to_text(last(k), 4)// &
            & ', in step '//to_text(scene%step)//' (first seen: '//to_text(most(k), 4)// &
            & ' in element '//to_text(model%mesh%element_label(worst(k)))// &
            & '); the stress stays that of the last line', model%material(k)%plastic_at, &
            & help='add lines to *PLASTIC, or write a law: SWIFT, VOCE, HOLLOMON, LINEAR')
      end do
   end subroutine check_flow_curves
end module lopin_check_flow_curves
