!> Materials of the deck.
module lopin_build_materials
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, material_type
   use lopin_hyperelastic, only : neo_hooke_law, elastic_constants
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & complain, line_place, has_parameter
   use lopin_build_damage, only : read_damage
   use lopin_build_heat, only : read_expansion
   use lopin_build_plastic, only : read_plastic, read_cyclic_hardening, read_rate_dependent, &
      & read_viscoplastic
   use lopin_build_yield, only : read_potential
   use lopin_build_scene, only : need_real, scene_type, need_word, get_word
   implicit none
   private
   public :: build_materials

   !> D1 times C10 at a Poisson's ratio of 0.495: 3 (1 - 2 nu)/(2 (1 + nu)).
   real(wp), parameter :: near_incompressible = 0.03_wp/2.99_wp

contains

   subroutine build_materials(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(material_type) :: material
      type(location_type) :: at
      integer :: k, i
      logical :: open

      allocate (model%material(0))
      open = .false.
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block))
            select case (block%keyword)
            case ('MATERIAL')
               material = material_type()
               call need_word(block, 'NAME', material%name, at, open, model%log)
               material%at = at
               if (.not. open) cycle
               do i = 1, size(model%material)
                  if (model%material(i)%name /= material%name) cycle
                  call complain(model%log, 'E0205', 'material `'//material%name &
                     & //'` is defined twice, first in line ' &
                     & //to_text(model%material(i)%at%line), at)
               end do
               model%material = [model%material, material]
            case ('ELASTIC', 'HYPERELASTIC', 'PLASTIC', 'POTENTIAL', 'CYCLIC HARDENING', &
               & 'RATE DEPENDENT', 'VISCOPLASTIC', 'DAMAGE', 'EXPANSION', 'DENSITY')
               if (is_open(open, block, model%log)) call read_property( &
                  & model%material(size(model%material)), block, model%log)
            end select
         end associate
      end do
   end subroutine build_materials

   !> A card that belongs to the material above it.
   subroutine read_property(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log

      select case (block%keyword)
      case ('ELASTIC')
         call read_elastic(material, block, log)
      case ('HYPERELASTIC')
         call read_hyperelastic(material, block, log)
      case ('PLASTIC')
         call read_plastic(material, block, log)
      case ('POTENTIAL')
         call read_potential(material, block, log)
      case ('CYCLIC HARDENING')
         call read_cyclic_hardening(material, block, log)
      case ('RATE DEPENDENT')
         call read_rate_dependent(material, block, log)
      case ('VISCOPLASTIC')
         call read_viscoplastic(material, block, log)
      case ('DAMAGE')
         call read_damage(material, block, log)
      case ('EXPANSION')
         call read_expansion(material, block, log)
      case ('DENSITY')
         call read_density(material, block, log)
      end select
   end subroutine read_property

   subroutine read_density(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      logical :: found

      call read_one(block, 'a density', material%density, found, log)
      if (found .and. .not. material%density > 0.0_wp) call complain(log, 'E0203', &
         & 'a density of '//to_text(material%density, 6)//' is not positive', &
         & line_place(block%line(1)))
   end subroutine read_density

   logical function is_open(open, block, log)
      logical, intent(in) :: open
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log

      is_open = open
      if (.not. open) call complain(log, 'E0203', '*'//block%keyword &
         & //' stands outside a material', block%at, &
         & help='write *MATERIAL, NAME= before it')
   end function is_open

   subroutine read_one(block, what, value, found, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: what
      real(wp), intent(out) :: value
      logical, intent(out) :: found
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n

      value = 0.0_wp
      found = .false.
      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      if (n > 0) call need_real(field(1), value, log, found)
      if (n == 0) call complain(log, 'E0103', '*'//block%keyword//' needs '//what, block%at)
   end subroutine read_one

   subroutine read_elastic(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: n
      logical :: found, two

      if (material%has_elastic) then
         call complain(log, 'E0205', 'material `'//material%name//'` has a second *ELASTIC', &
            & block%at)
         return
      end if
      material%has_elastic = .true.
      call get_word(block, 'TYPE', word, at, found)
      if (found .and. word /= 'ISOTROPIC' .and. word /= 'ISO') then
         call complain(log, 'E0203', 'elasticity of type `'//word//'` is not in this version', at, &
            & help='TYPE=ISOTROPIC: Young''s modulus, Poisson''s ratio')
         return
      end if
      call get_word(block, 'STRAIN', word, at, found)
      if (found) material%green = word == 'GREEN'
      call read_one(block, "Young's modulus and Poisson's ratio", material%young, found, log)
      if (.not. found) return
      call split_fields(block%line(1), field, n)
      two = .false.
      if (n > 1) call field_real(field(2), material%poisson, log, two)
      material%given_poisson = material%poisson
      if (.not. material%young > 0.0_wp) call complain(log, 'E0203', "Young's modulus " &
         & //to_text(material%young, 6)//' is not positive', field(1)%at)
      if (two .and. (material%poisson >= 0.5_wp .or. material%poisson <= -1.0_wp)) then
         call complain(log, 'E0203', "Poisson's ratio "//to_text(material%poisson, 6) &
            & //' is outside (-1, 0.5)', field(2)%at, &
            & help=trim(merge( &
            & 'steel has 0.3, rubber 0.49: is a decimal point lost?                ', &
            & 'an incompressible solid has no stiffness matrix; 0.49 is near enough', &
            & abs(material%poisson) >= 1.0_wp)))
      end if
      if (.not. two) call log%say(severity%note, 'N0402', "material `"//material%name// &
         & "` has no Poisson's ratio: it is 0", line_place(block%line(1)))
      if (n > 3) call log%say(severity%warning, 'W0104', 'decimal comma? this line reads as E = ' &
         & //to_text(material%young, 6)//', nu = '//to_text(material%poisson, 6)//' and more', &
         & field(3)%at)
      if (block%nline > 1) call complain(log, 'E0203', 'a second line: elasticity that depends '// &
         & 'on temperature is not in this version, or a keyword line is lost above it', &
         & line_place(block%line(2)))
   end subroutine read_elastic

   !> `C10, D1` of *HYPERELASTIC, NEO HOOKE; the constants of small strain follow from them.
   subroutine read_hyperelastic(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n
      logical :: found, two

      if (material%has_neo_hooke) then
         call complain(log, 'E0205', 'material `'//material%name//'` has a second *HYPERELASTIC', &
            & block%at)
         return
      end if
      material%has_neo_hooke = .true.
      if (.not. has_parameter(block, 'NEO HOOKE')) then
         call complain(log, 'E0203', 'the form of the energy is missing', block%at, &
            & help='*HYPERELASTIC, NEO HOOKE')
         return
      end if
      call read_one(block, 'C10 and D1', material%c10, found, log)
      if (.not. found) return
      call split_fields(block%line(1), field, n)
      two = .false.
      if (n > 1) call field_real(field(2), material%d1, log, two)
      if (.not. material%c10 > 0.0_wp) then
         call complain(log, 'E0203', 'C10 = '//to_text(material%c10, 6)//' is not positive', &
            & field(1)%at)
      else if (.not. material%d1 > 0.0_wp) then
         call complain(log, 'E0203', 'D1 = '//to_text(material%d1, 6)//' is not positive: an '// &
            & 'incompressible solid has no stiffness matrix', field(min(n, 2))%at, &
            & help='D1 is 2 over the bulk modulus; '//to_text(near_incompressible/material%c10, 3) &
            & //" gives a Poisson's ratio of 0.495, which is near enough")
      else
         call elastic_constants(neo_hooke_law(material%c10, material%d1), material%young, &
            & material%poisson)
      end if
      if (block%nline > 1) call complain(log, 'E0203', 'a second line: elasticity that depends '// &
         & 'on temperature is not in this version, or a keyword line is lost above it', &
         & line_place(block%line(2)))
   end subroutine read_hyperelastic
end module lopin_build_materials
