!> Keyword lines that have lost their star, and lines of data that have lost their keyword.
module lopin_lost_star
   use lopin_block, only : block_type, data_line_type, complain, line_place
   use lopin_error, only : log_type
   use lopin_keyword_table, only : keyword_table_type, keyword_type, find_keyword
   use lopin_text, only : quoted, upper, without_blanks
   implicit none
   private
   public :: check_stars, is_keyword, help_of

   !> Words that name nothing of a model.
   character(len=*), parameter :: of_steps(*) = [character(len=11) :: 'STEP', 'ENDSTEP', 'STATIC', &
      & 'ENDPART', 'ENDINSTANCE', 'ENDASSEMBLY']

contains

   !> Complain of `END STEP` and of `BOUNDARY, OP=NEW` among data.
   subroutine check_stars(block, known, table, log, lost)
      type(block_type), intent(in) :: block
      type(keyword_type), intent(in) :: known
      type(keyword_table_type), intent(in) :: table
      type(log_type), intent(inout) :: log
      logical, intent(inout) :: lost           !! some star is
      character(len=:), allocatable :: text
      integer :: i

      if (known%is_free_text) return
      do i = 1, block%nline
         if (.not. is_keyword(block%line(i), table)) cycle
         lost = .true.
         text = trim(adjustl(block%line(i)%text))
         call complain(log, 'E0110', quoted(text)//' is a keyword without its star', &
            & line_place(block%line(i)), label='write *'//text)
      end do
   end subroutine check_stars

   !> Whether a line of data is a keyword line but for its star.
   pure logical function is_keyword(line, table)
      type(data_line_type), intent(in) :: line
      type(keyword_table_type), intent(in) :: table
      character(len=:), allocatable :: word
      integer :: comma, first

      is_keyword = .false.
      first = verify(line%text, ' ')
      if (first == 0) return
      ! Most lines are numbers.
      if (index('0123456789+-.,"', line%text(first:first)) > 0) return
      word = upper(without_blanks(line%text))
      comma = index(word//',', ',')
      if (comma > len(word)) then
         is_keyword = any(of_steps == word)
      else if (index(word, '=') > comma) then
         is_keyword = find_keyword(table, word(:comma - 1)) > 0
      end if
   end function is_keyword

   !> What to do about data that a keyword does not take.
   pure function help_of(known) result(text)
      type(keyword_type), intent(in) :: known
      character(len=:), allocatable :: text

      text = "if a keyword line is lost above it, write that; or lopin doc '*"//known%name//"'"
   end function help_of
end module lopin_lost_star
