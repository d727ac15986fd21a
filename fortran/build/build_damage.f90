!> *DAMAGE: a criterion of ductile damage that a material counts.
module lopin_build_damage
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, location_type
   use lopin_text, only : to_text, parse_real
   use lopin_model, only : material_type
   use lopin_damage_criteria, only : damage_type, damage_kind
   use lopin_block, only : block_type, field_type, split_fields, complain, line_place
   use lopin_build_scene, only : need_real, need_word, get_word
   implicit none
   private
   public :: read_damage

contains

   !> One card is one criterion; a material has at most one of each.
   subroutine read_damage(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(damage_type) :: one
      type(location_type) :: at
      character(len=:), allocatable :: word
      logical :: found

      call need_word(block, 'CRITERION', word, at, found, log)
      if (.not. found) return
      one%kind = damage_kind(word)
      if (one%kind == 0) return   ! the table of keywords has said so
      if (.not. allocated(material%damage)) allocate (material%damage(0))
      if (any(material%damage%kind == one%kind)) then
         call complain(log, 'E0205', 'material `'//material%name//'` has a second *DAMAGE, '// &
            & 'CRITERION='//word, at)
         return
      end if
      call read_coefficient(word, one%coefficient, block, log)
      call get_word(block, 'WIDTH', word, at, found)
      if (found) call parse_real(word, one%width, found)
      if (found .and. .not. one%width > 0.0_wp) call complain(log, 'E0203', 'WIDTH='//word// &
         & ' is not positive', at)
      call get_word(block, 'CRITICAL', word, at, found)
      if (found) call parse_real(word, one%critical, found)
      if (found .and. .not. one%critical > 0.0_wp) call complain(log, 'E0203', 'CRITICAL='// &
         & word//' is not positive', at)
      material%damage = [material%damage, one]
   end subroutine read_damage

   !> A of OYANE, which has no usual value; c of RICE-TRACEY, 3/2 unless given.
   subroutine read_coefficient(word, value, block, log)
      character(len=*), intent(in) :: word
      real(wp), intent(inout) :: value
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n
      logical :: right

      if (word == 'RICE-TRACEY') value = 1.5_wp
      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      if (n > 0 .and. (word == 'OYANE' .or. word == 'RICE-TRACEY')) then
         call need_real(field(1), value, log, right)
         if (right .and. .not. value > 0.0_wp) call complain(log, 'E0203', 'a coefficient of '// &
            & to_text(value, 6)//' is not positive', line_place(block%line(1)))
      else if (n > 0) then
         call complain(log, 'E0103', word//' has no coefficient', line_place(block%line(1)), &
            & help='leave the line out')
      else if (word == 'OYANE') then
         call complain(log, 'E0103', 'OYANE needs its coefficient A on one line', block%at, &
            & help="lopin doc '*DAMAGE'")
      end if
   end subroutine read_coefficient
end module lopin_build_damage
