!> Elements that lock where the material keeps its volume: which get mean dilatation, and which are
!> warned of.
module lopin_build_locking
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_element_type, only : element_kind, element_type
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type
   use lopin_solids, only : keeps_volume
   use lopin_build_scene, only : scene_type
   implicit none
   private
   public :: check_locking

contains

   !> Once for each word and section.
   subroutine check_locking(model, scene)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      integer :: number(size(scene%etype), size(model%section)), e, s, t

      number = 0
      do e = 1, model%mesh%nelement
         s = model%mesh%section(e)
         if (s > 0) number(model%mesh%etype(e), s) = number(model%mesh%etype(e), s) + 1
      end do
      do s = 1, size(model%section)
         if (.not. volume_is_kept(model, s)) cycle
         do t = 1, size(scene%etype)
            if (number(t, s) > 0) call check_word(model, scene%etype(t), s, number(t, s))
         end do
      end do
   end subroutine check_locking

   pure logical function volume_is_kept(model, section) result(kept)
      type(model_type), intent(in) :: model
      integer, intent(in) :: section

      kept = .false.
      if (model%section(section)%material == 0) return
      associate (material => model%material(model%section(section)%material))
         if (material%has_neo_hooke) then
            ! bulk/shear = (1/d1)/c10 above that of the same Poisson's ratio.
            kept = 3.0_wp*(1.0_wp - 2.0_wp*keeps_volume) &
               & > 2.0_wp*(1.0_wp + keeps_volume)*material%c10*material%d1
         else
            kept = material%poisson > keeps_volume .or. flows(material%flow)
         end if
      end associate
   end function volume_is_kept

   subroutine check_word(model, word, section, number)
      type(model_type), intent(inout) :: model
      type(element_type), intent(in) :: word
      integer, intent(in) :: section, number

      if (word%kind == element_kind%plane_stress .or. word%kind == element_kind%rigid) return
      associate (material => model%material(model%section(section)%material), &
         & at => model%section(section)%at)
         if (model%section(section)%formulation == 'FULL') then
            if (.not. locks_alone(word)) return
            call model%log%say(severity%warning, 'W0211', to_text(number)//' '//trim(word%word)// &
               & ' with FORMULATION=FULL and material `'//material%name//'`, which keeps its '// &
               & 'volume, will lock: too stiff, with pressures that oscillate', at, &
               & help='leave out FORMULATION=FULL')
         else if (word%patched) then
            call model%log%say(severity%note, 'N0211', to_text(number)//' '//trim(word%word)// &
               & ' of material `'//material%name//'`, which keeps its volume, share their '// &
               & 'change of volume in patches of neighbours', at)
         else if (word%projectable) then
            call model%log%say(severity%note, 'N0212', to_text(number)//' '//trim(word%word)// &
               & ' of material `'//material%name//'`, which keeps its volume, change it '// &
               & 'linearly over each element', at)
         end if
      end associate
   end subroutine check_word

   !> Fully integrated, with a change of volume at each point.
   pure logical function locks_alone(word)
      type(element_type), intent(in) :: word
      locks_alone = .not. word%cell%quadratic .or. word%cell%name == 'quad8' &
         & .or. word%cell%name == 'hexahedron20'
   end function locks_alone
end module lopin_build_locking
