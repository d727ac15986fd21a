!> The line `traction` of the certificate: the pressures as printed carry the forces of contact.
module lopin_check_traction
   use lopin_kinds, only : wp
   use lopin_carried_force, only : field_areas, lost_force
   use lopin_certificate, only : hold_traction
   use lopin_contact_points, only : pair_is_tied
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_report, only : contact_field_type, frame_type
   use lopin_rounding_floor, only : floor_of_forces
   use lopin_vectors, only : largest
   implicit none
   private
   public :: check_traction

   !> Forces of a pair below this share of those in the bodies are what equilibrium leaves open.
   real(wp), parameter :: left_open = 1.0e-6_wp

contains

   !> Of the fields of a frame, by pair; the verdict of the frame follows.
   subroutine check_traction(frame, scene, model)
      type(frame_type), intent(inout) :: frame
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: within, most
      integer :: pair, worst

      worst = 0
      most = 0.0_wp
      do pair = 1, size(model%pair)
         if (.not. scene%skin(pair)%in_use .or. size(frame%contact(pair)%node) == 0) cycle
         ! Without NLGEOM areas stay those of the start.
         if (scene%newton%in_use .and. scene%newton%nlgeom) then
            call check(scene%newton%contact%masters%x)
         else
            call check(model%mesh%x)
         end if
         most = max(most, within)
         if (.not. frame%contact(pair)%lost > frame%certificate%traction) cycle
         frame%certificate%traction = frame%contact(pair)%lost
         worst = pair
      end do
      if (worst == 0) return
      associate (p => model%pair(worst))
         call hold_traction(frame%certificate, '('//model%surface(p%slave)%name//', '// &
            & model%surface(p%master)%name//')', most, pair_is_tied(model, p) &
            & .or. model%interaction(p%interaction)%no_separation)
      end associate

   contains

      subroutine check(x)
         real(wp), intent(in) :: x(:, :)          !! present places [length]
         real(wp) :: area(size(frame%contact(pair)%node), 2)

         associate (f => frame%contact(pair))
            f%lost = 0.0_wp
            within = 0.0_wp
            if (is_left_open(f, scene)) return
            call field_areas(scene%skin(pair), x, f%node, f%normal, f%pressure, &
               & merge(f%weight, 0.0_wp, f%facet > 0), area)
            f%lost = lost_force(f%pressure, area(:, 1), f%force, f%normal, x(:, f%node))
            within = lost_force(f%pressure, area(:, 2), f%force, f%normal, x(:, f%node))
         end associate
      end subroutine check
   end subroutine check_traction

   !> The forces of a pair are what equilibrium leaves open, or what rounding makes of stiffnesses.
   logical function is_left_open(field, scene) result(open)
      type(contact_field_type), intent(in) :: field
      type(scene_type), intent(in) :: scene
      real(wp) :: floor(scene%constraints%neq)

      if (scene%newton%in_use) then
         open = sum(norm2(field%force, 1)) <= left_open*scene%newton%reference
      else
         call floor_of_forces(scene, floor)
         open = largest(norm2(field%force, 1)) <= largest(floor)
      end if
   end function is_left_open
end module lopin_check_traction
