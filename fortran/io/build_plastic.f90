!> *PLASTIC: the flow curve of a metal.
module lopin_build_plastic
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, location_type
   use lopin_text, only : to_text
   use lopin_model, only : material_type
   use lopin_flow_curve, only : table_flow
   use lopin_block, only : block_type, field_type, split_fields, field_real, complain, line_place
   use lopin_build_scene, only : need_real, get_word
   implicit none
   private
   public :: read_plastic

contains

   !> Lines `yield stress, plastic strain`: strains from 0 upwards.
   subroutine read_plastic(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      real(wp) :: stress, strain, before, table(2, block%nline)
      integer :: j, n
      logical :: found, right
      character(len=:), allocatable :: word
      type(location_type) :: at

      if (material%yield > 0.0_wp) then
         call complain(log, 'E0205', 'material `'//material%name//'` has a second *PLASTIC', &
            & block%at)
         return
      end if
      material%plastic_at = block%at
      if (block%nline == 0) call complain(log, 'E0103', '*PLASTIC needs a yield stress', block%at)
      right = block%nline > 0
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         call need_real(field(1), stress, log, found)
         right = right .and. found
         strain = 0.0_wp
         if (n > 1) call field_real(field(2), strain, log, found)
         if (.not. stress > 0.0_wp) call complain(log, 'E0203', 'a yield stress of ' &
            & //to_text(stress, 6)//' is not positive', field(1)%at)
         if (j == 1) then
            material%yield = stress
            if (abs(strain) > 0.0_wp) call complain(log, 'E0203', 'the first plastic strain is ' &
               & //to_text(strain, 6)//', not 0', field(2)%at, &
               & help='yield stress at plastic strain 0 first')
         else
            if (.not. strain > before) call complain(log, 'E0203', 'plastic strain ' &
               & //to_text(strain, 6)//' does not increase', line_place(block%line(j)))
            material%hardens = material%hardens .or. stress > material%yield
         end if
         before = strain
         table(:, j) = [strain, stress]
      end do
      call get_word(block, 'ONLY', word, at, found)
      if (found .and. word /= 'FRICTION') call complain(log, 'E0106', 'ONLY='//word// &
         & ' is not known', at, help='ONLY=FRICTION: the body stays elastic')
      if (right .and. .not. found) material%flow = table_flow(table(1, :), table(2, :))
   end subroutine read_plastic
end module lopin_build_plastic
