!> Cards whose row of the keyword table says `reported`, kept as settings of the model.
module lopin_build_settings
   use lopin_block, only : deck_type, block_type
   use lopin_keyword_table, only : keyword_table_type, keyword_type, find_keyword, find_parameter, &
      & status_of
   use lopin_settings, only : settings_type, setting_type
   use lopin_text, only : parse_real
   implicit none
   private
   public :: build_settings

contains

   !> Of a checked deck.
   subroutine build_settings(settings, deck, table)
      type(settings_type), intent(out) :: settings
      type(deck_type), intent(in) :: deck
      type(keyword_table_type), intent(in) :: table
      integer :: i, row

      do i = 1, deck%nblock
         row = find_keyword(table, deck%block(i)%keyword)
         if (row == 0) cycle
         if (table%row(row)%is_reported) call add_card(settings, deck%block(i), table%row(row))
      end do
   end subroutine build_settings

   subroutine add_card(settings, block, row)
      type(settings_type), intent(inout) :: settings
      type(block_type), intent(in) :: block
      type(keyword_type), intent(in) :: row
      type(setting_type) :: new
      integer :: i, k

      do i = 1, size(block%parameter)
         k = find_parameter(row, block%parameter(i)%name)
         if (k == 0) cycle
         if (row%parameter(k)%status /= status_of%supported) cycle
         new%name = row%name//', '//row%parameter(k)%name
         new%text = block%parameter(i)%value
         if (row%parameter(k)%kind == 'flag') new%text = 'YES'
         new%is_number = index(row%parameter(k)%kind, 'number') > 0
         if (new%is_number) call parse_real(new%text, new%value, new%is_number)
         call settings%add(new)
      end do
      new%name = row%name
      new%is_number = .false.
      do i = 1, block%nline
         new%text = trim(adjustl(block%line(i)%text))
         call settings%add(new)
      end do
   end subroutine add_card
end module lopin_build_settings
