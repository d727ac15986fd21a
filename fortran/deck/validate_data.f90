!> Checks data lines as far as the keyword table can: number of fields, and values that are never
!> valid.
module lopin_validate_data
   use lopin_block, only : block_type, data_line_type, field_type, complain, count_fields, &
      & split_fields, quotes_close, &
      & field_real, line_place
   use lopin_error, only : log_type, location_type, severity
   use lopin_keyword_table, only : keyword_table_type, keyword_type
   use lopin_lost_star, only : help_of, is_keyword
   use lopin_kinds, only : wp
   use lopin_plural, only : plural
   use lopin_text, only : parse_real, parse_integer, quoted, upper, without_blanks, to_text
   implicit none
   private
   public :: check_data

contains

   subroutine check_data(block, known, table, log)
      type(block_type), intent(in) :: block
      type(keyword_type), intent(in) :: known
      type(keyword_table_type), intent(in) :: table
      type(log_type), intent(inout) :: log
      integer :: i, most

      most = known%most_fields()
      do i = 1, block%nline
         ! What follows is that keyword's.
         if (.not. known%is_free_text .and. is_keyword(block%line(i), table)) exit
         call check_quotes(block%line(i), known, log)
         if (.not. known%is_free_text) call check_commas(block%line(i), log)
         if (most == huge(most)) cycle
         if (most < 0) then
            call complain(log, 'E0103', '*'//known%name//' takes no data lines', &
               & line_place(block%line(i)), help=help_of(known))
            exit
         end if
         if (count_fields(block%line(i)%text) > most) call too_many(block%line(i), known, most, log)
      end do
      if (known%name == 'ELASTIC') call check_elastic(block, log)
   end subroutine check_data

   subroutine check_quotes(line, known, log)
      type(data_line_type), intent(in) :: line
      type(keyword_type), intent(in) :: known
      type(log_type), intent(inout) :: log
      integer :: i

      if (known%is_free_text .or. quotes_close(line%text)) return
      i = index(line%text, '"', back=.true.)
      call complain(log, 'E0111', 'a quote is opened but not closed', &
         & location_type(line%file, line%line, i, len_trim(line%text)), &
         & label='no second quote on this line')
   end subroutine check_quotes

   !> Two numbers with a blank between them are two fields with a comma missing, under any keyword.
   subroutine check_commas(line, log)
      type(data_line_type), intent(in) :: line
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      real(wp) :: value
      integer :: n, i
      logical :: found

      if (.not. has_two_numbers(line%text)) return
      call split_fields(line, field, n)
      do i = 1, n
         if (has_two_numbers(field(i)%text)) call field_real(field(i), value, log, found)
      end do
   end subroutine check_commas

   !> Whether a blank stands between two numbers, as in `1 0.5`.
   pure logical function has_two_numbers(text) result(two)
      character(len=*), intent(in) :: text
      character(len=*), parameter :: digits = '0123456789.'
      character(len=1) :: before   !! last letter that is not blank
      integer :: i
      logical :: gap

      two = .true.
      before = ','
      gap = .false.
      do i = 1, len(text)
         if (text(i:i) == ' ') then
            gap = .true.
         else
            if (gap .and. index(digits, before) > 0 .and. index(digits//'+-', text(i:i)) > 0) return
            before = text(i:i)
            gap = .false.
         end if
      end do
      two = .false.
   end function has_two_numbers

   !> More fields than the keyword has: a decimal comma, or simply too many.
   subroutine too_many(line, known, most, log)
      type(data_line_type), intent(in) :: line
      type(keyword_type), intent(in) :: known
      integer, intent(in) :: most
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n, i

      call split_fields(line, field, n)
      do i = 1, n - 1
         if (.not. (is_whole(field(i)%text) .and. may_be_decimals(field(i + 1)%text))) cycle
         if (field(i + 1)%at%first /= field(i)%at%last + 2) cycle
         call complain(log, 'E0104', 'decimal comma? *'//known%name//' has at most '//plural(most, &
            & 'field')// &
            & ' a line, here are '//to_text(n), location_type(line%file, line%line, &
            & field(i)%at%first, &
            & field(i + 1)%at%last), label='write '//quoted(field(i)%text//'.'// &
            & field(i + 1)%text), &
            & help='a comma separates fields; numbers have a point')
         return
      end do
      call complain(log, 'E0103', '*'//known%name//' has at most '//plural(most, 'field')// &
         & ' a line, here are '// &
         & to_text(n), location_type(line%file, line%line, field(most + 1)%at%first, &
         & field(n)%at%last), &
         & label='too many', help=help_of(known))
   end subroutine too_many

   !> `210000,0,3` is legal, and probably not what was meant.
   subroutine check_elastic(block, log)
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n, i

      do i = 1, block%nline
         call split_fields(block%line(i), field, n)
         if (n /= 3) cycle
         if (field(2)%text /= '0' .or. .not. may_be_decimals(field(3)%text)) cycle
         call log%say(severity%warning, 'W0104', 'decimal comma? '// &
            & quoted(trim(adjustl(block%line(i)%text)))// &
            & ' reads as E = '//field(1)%text//', Poisson''s ratio = 0, temperature = '// &
            & field(3)%text, &
            & location_type(block%line(i)%file, block%line(i)%line, field(2)%at%first, &
            & field(3)%at%last), &
            & label='or 0.'//field(3)%text//' ?', help='numbers have a point: '// &
            & quoted(field(1)%text//', 0.'//field(3)%text))
      end do
   end subroutine check_elastic

   pure logical function is_whole(text)
      character(len=*), intent(in) :: text
      integer :: value
      call parse_integer(text, value, is_whole)
   end function is_whole

   !> Digits, perhaps with an exponent, without sign or point: `5`, `05`, `8e-9`.
   pure logical function may_be_decimals(text)
      character(len=*), intent(in) :: text
      real(wp) :: value

      may_be_decimals = .false.
      if (len(text) == 0) return
      if (verify(text(1:1), '0123456789') > 0 .or. index(text, '.') > 0) return
      call parse_real(text, value, may_be_decimals)
   end function may_be_decimals
end module lopin_validate_data
