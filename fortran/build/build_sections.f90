!> Sections of the deck, and which elements have which: every one that deforms needs one.
module lopin_build_sections
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_model, only : model_type, section_type
   use lopin_element_type, only : element_type, element_kind, new_element_type
   use lopin_flow_curve, only : flows
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, complain, &
      & has_parameter
   use lopin_build_locking, only : check_locking
   use lopin_build_scene, only : scene_type, name_type, need_word, get_word, set_named, &
      & find_name, no_such
   use lopin_build_orientations, only : read_axes
   implicit none
   private
   public :: build_sections, check_sections

contains

   subroutine build_sections(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(inout) :: scene
      type(name_type), allocatable :: names(:)
      type(section_type) :: section
      integer :: k, i

      allocate (model%section(0), names(size(model%material)))
      do i = 1, size(names)
         names(i)%text = model%material(i)%name
      end do
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'SOLID SECTION') cycle
            call read_section(section, model, deck, scene, block, names)
            model%section = [model%section, section]
            call give_section(model, scene, block, scene%card(k)%scope)
         end associate
      end do
   end subroutine build_sections

   subroutine read_section(section, model, deck, scene, block, names)
      type(section_type), intent(out) :: section
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(block_type), intent(in) :: block
      type(name_type), intent(in) :: names(:)
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: n
      logical :: found

      section%at = block%at
      call need_word(block, 'MATERIAL', name, at, found, model%log)
      if (found) then
         section%material = find_name(names, name)
         if (section%material == 0) call no_such(model%log, 'material', name, names, at)
      end if
      call get_word(block, 'ORIENTATION', name, at, section%oriented)
      if (section%oriented) call read_axes(deck, scene, name, at, section%axes, model%log)
      call get_word(block, 'CONTROLS', name, at, found)
      if (found) call read_controls(section, deck, scene, name, at, model%log)
      if (block%nline == 0) return
      call split_fields(block%line(1), field, n)
      if (n == 0) return
      call field_real(field(1), section%thickness, model%log, found)
      if (.not. found) section%thickness = 1.0_wp
      if (found .and. .not. section%thickness > 0.0_wp) call complain(model%log, 'E0203', &
         & 'the thickness ' &
         & //to_text(section%thickness, 6)//' is not positive', field(1)%at)
   end subroutine read_section

   !> `*SECTION CONTROLS, NAME=, FORMULATION=FULL, HOURGLASS=`.
   subroutine read_controls(section, deck, scene, name, at, log)
      type(section_type), intent(inout) :: section
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      character(len=*), intent(in) :: name
      type(location_type), intent(in) :: at
      type(log_type), intent(inout) :: log
      type(name_type), allocatable :: names(:)
      character(len=:), allocatable :: other, word
      type(location_type) :: there
      integer :: k
      logical :: found

      allocate (names(0))
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            if (block%keyword /= 'SECTION CONTROLS') cycle
            call get_word(block, 'NAME', other, there, found)
            names = [names, name_type(other)]
            if (other /= name) cycle
            call get_word(block, 'FORMULATION', word, there, found)
            if (word == 'FULL') section%formulation = 'FULL'
            if (has_parameter(block, 'HOURGLASS')) then
               if (word /= 'FULL') section%formulation = 'ONE'
               if (word == 'FULL') call log%say(severity%note, 'N0306', 'HOURGLASS does '// &
                  & 'nothing beside FORMULATION=FULL', there)
            end if
            if (found .and. word /= 'FULL' .and. word /= 'AUTO') call complain(log, 'E0203', &
               & 'formulation `'//word//'` is not known', there, &
               & help='FULL, or leave it out for mean dilatation')
            return
         end associate
      end do
      call no_such(log, 'section controls', name, names, at)
   end subroutine read_controls

   subroutine give_section(model, scene, block, scope)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(inout) :: scene
      type(block_type), intent(in) :: block
      integer, intent(in) :: scope
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: k, i, e, other
      logical :: found

      call need_word(block, 'ELSET', name, at, found, model%log)
      if (.not. found) return
      k = set_named(scene, model%mesh%elset, 'element set', name, scope, at, model%log)
      if (k == 0) return
      other = 0
      do i = 1, size(model%mesh%elset(k)%member)
         e = model%mesh%elset(k)%member(i)
         if (other == 0 .and. model%mesh%section(e) > 0) then
            other = model%mesh%section(e)
            call model%log%say(severity%warning, 'W0203', 'element '// &
               & to_text(model%mesh%element_label(e))//' of set '//name//' has a section '// &
               & 'already, from line '//to_text(model%section(other)%at%line)// &
               & ': this later one holds', at, help='one *SOLID SECTION for each element')
         end if
         if (scene%etype(model%mesh%etype(e))%kind == element_kind%rigid) cycle
         model%mesh%section(e) = size(model%section)
      end do
      if (model%section(size(model%section))%formulation == 'ONE') &
         & call take_one_point(model, scene, model%mesh%elset(k)%member)
   end subroutine give_section

   !> HOURGLASS of *SECTION CONTROLS: its C3D8R have one integration point.
   subroutine take_one_point(model, scene, member)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: member(:)
      character(len=*), parameter :: word = 'C3D8RS'
      type(element_type) :: element
      logical :: found, some
      integer :: i, e, t

      some = .false.
      t = findloc(model%element_word == word, .true., dim=1)
      do i = 1, size(member)
         e = member(i)
         if (.not. any(model%element_word(model%mesh%etype(e)) == ['C3D8R ', 'C3D8RH', word])) cycle
         some = .true.
         if (t == 0) then
            call new_element_type(element, word, '', found)
            model%element_word = [character(len=8) :: model%element_word, word]
            scene%etype = [scene%etype, element]
            scene%etype_at = [scene%etype_at, model%section(size(model%section))%at]
            t = size(model%element_word)
         end if
         model%mesh%etype(e) = t
      end do
      associate (at => model%section(size(model%section))%at)
         if (some) call model%log%say(severity%note, 'N0206', 'C3D8R of this section has one '// &
            & 'integration point and hourglass control, as its *SECTION CONTROLS asks', at)
         if (.not. some) call model%log%say(severity%note, 'N0306', 'HOURGLASS on the *SECTION '// &
            & 'CONTROLS of this section does nothing: no element is a C3D8R', at)
      end associate
   end subroutine take_one_point

   !> Every element that deforms has a section, every section a material that can be computed.
   subroutine check_sections(model, scene, rigid)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      logical, intent(in) :: rigid(:)      !! (nelement) of a rigid body
      integer, allocatable :: bare(:)
      logical :: used(size(model%material))
      integer :: e, i

      call check_flow(model, scene)
      call check_locking(model, scene)
      used = .false.
      do i = 1, size(model%section)
         if (model%section(i)%material > 0) used(model%section(i)%material) = .true.
      end do
      do i = 1, size(model%material)
         associate (material => model%material(i))
            if (material%has_elastic .and. material%has_neo_hooke) call complain(model%log, &
               & 'E0205', 'material `'//material%name//'` has both *ELASTIC and *HYPERELASTIC', &
               & material%at, help='keep one of them')
            if (material%green .and. flows(material%flow)) call complain(model%log, 'E0205', &
               & 'material `'//material%name//'` has *PLASTIC beside *ELASTIC, STRAIN=GREEN', &
               & material%plastic_at, help='metals flow in logarithmic strain: leave STRAIN out')
            if (.not. used(i) .or. material%has_elastic .or. material%has_neo_hooke &
               & .or. material%flow%rigid) cycle
            call complain(model%log, 'E0203', 'material `'//material%name//'` has no *ELASTIC', &
               & material%at, help="add *ELASTIC with Young's modulus and Poisson's ratio")
         end associate
      end do
      allocate (bare(0))
      do i = 1, size(scene%etype)
         if (scene%etype(i)%kind == element_kind%rigid) then
            bare = pack([(e, e=1, model%mesh%nelement)], model%mesh%etype == i .and. .not. rigid)
            if (size(bare) > 0) call complain(model%log, 'E0305', plural(size(bare), 'element') &
               & //' of type '//trim(scene%etype(i)%word)//' in no *RIGID BODY (first: ' &
               & //to_text(model%mesh%element_label(bare(1)))//')', scene%etype_at(i), &
               & help='*RIGID BODY, ELSET=, REF NODE= says what moves them')
            cycle
         end if
         bare = pack([(e, e=1, model%mesh%nelement)], model%mesh%etype == i &
            & .and. model%mesh%section == 0 &
            & .and. .not. rigid)
         if (size(bare) > 0) call tell_bare(model, trim(scene%etype(i)%word), bare, &
            & scene%etype_at(i))
      end do
   end subroutine check_sections

   !> What flows in which element: no rigid solid in plane stress, no axes that leave a plane.
   subroutine check_flow(model, scene)
      type(model_type), intent(inout) :: model
      type(scene_type), intent(in) :: scene
      logical :: told(size(model%section))
      integer :: e, s

      told = .false.
      do e = 1, model%mesh%nelement
         s = model%mesh%section(e)
         if (s == 0) cycle
         if (model%section(s)%material == 0 .or. told(s)) cycle
         associate (word => scene%etype(model%mesh%etype(e)), section => model%section(s), &
            & material => model%material(model%section(s)%material))
            if (word%kind == element_kind%plane_stress .and. material%flow%rigid) then
               told(s) = .true.
               call complain(model%log, 'E0108', &
                  & 'a rigid solid that flows in plane stress comes '// &
                  & 'with a later version: element '//to_text(model%mesh%element_label(e))// &
                  & ' of type '//trim(word%word)//' has material `'//material%name//'`', &
                  & material%viscous_at, help='*VISCOPLASTIC without RIGID, with *ELASTIC')
            end if
            if (word%ndim == 3 .or. .not. section%oriented &
               & .or. .not. allocated(material%plastic)) cycle
            if (abs(maxval(abs(section%axes(:, 3))) - 1.0_wp) <= 1.0e-6_wp) cycle
            told(s) = .true.
            call complain(model%log, 'E0203', 'the *ORIENTATION of the elements of type '// &
               & trim(word%word)//' has no axis across their plane: they would shear out of it', &
               & section%at, help='turn the axes about axis 3')
         end associate
      end do
   end subroutine check_flow

   subroutine tell_bare(model, word, bare, at)
      type(model_type), intent(inout) :: model
      character(len=*), intent(in) :: word
      integer, intent(in) :: bare(:)
      type(location_type), intent(in) :: at
      character(len=:), allocatable :: text
      integer :: i

      text = plural(size(bare), 'element')//' of type '//word
      do i = 1, size(model%mesh%elset)
         if (.not. any(model%mesh%elset(i)%member == bare(1))) cycle
         text = text//' in set '//model%mesh%elset(i)%name
         exit
      end do
      text = text//merge(' has ', ' have', size(bare) == 1)
      call complain(model%log, 'E0203', trim(text)//' no *SOLID SECTION (first: ' &
         & //to_text(model%mesh%element_label(bare(1)))//')', at, &
         & help='*SOLID SECTION, ELSET=, MATERIAL=, or *RIGID BODY, ELSET= for a tool')
   end subroutine tell_bare
end module lopin_build_sections
