!> The grammar of a keyword line: `*KEYWORD, NAME=VALUE, FLAG`, over one or several lines.
module lopin_keyword_line
   use lopin_block, only : block_type, parameter_type, complain, has_parameter, without_quotes
   use lopin_error, only : location_type, log_type
   use lopin_text, only : upper, squeeze, quoted
   implicit none
   private
   public :: begin_block, more_parameters

   character(len=*), parameter :: blanks = ' '//achar(9)

contains

   !> Start a block from the first line of its keyword.
   subroutine begin_block(block, text, file, line, continued, log)
      type(block_type), intent(out) :: block
      character(len=*), intent(in) :: text
      integer, intent(in) :: file, line
      logical, intent(out) :: continued      !! a comma at the end: the next line belongs to it
      type(log_type), intent(inout) :: log
      integer :: star, last

      star = index(text, '*')
      last = index(text, ',') - 1
      if (last < 0) last = len(text)
      allocate (block%parameter(0), block%line(0))
      block%keyword = upper(squeeze(text(star + 1:last)))
      block%at = location_type(file, line, star, max(star, len_trim(text(:last))))
      continued = .false.
      if (last < len(text)) then
         call read_parameters(block, text, last + 2, file, line, continued, log)
         if (verify(text(last + 2:), blanks) == 0) continued = .true.
      end if
   end subroutine begin_block

   !> Go on with the parameters of a keyword on its next line.
   subroutine more_parameters(block, text, file, line, continued, log)
      type(block_type), intent(inout) :: block
      character(len=*), intent(in) :: text
      integer, intent(in) :: file, line
      logical, intent(out) :: continued
      type(log_type), intent(inout) :: log

      call read_parameters(block, text, 1, file, line, continued, log)
   end subroutine more_parameters

   subroutine read_parameters(block, text, start, file, line, continued, log)
      type(block_type), intent(inout) :: block
      character(len=*), intent(in) :: text
      integer, intent(in) :: start           !! column where the first parameter may begin
      integer, intent(in) :: file, line
      logical, intent(out) :: continued
      type(log_type), intent(inout) :: log
      integer :: first, i
      logical :: inside

      continued = .false.
      inside = .false.
      first = start
      do i = start, len(text)
         if (text(i:i) == '"') inside = .not. inside
         if (text(i:i) /= ',' .or. inside) cycle
         call add_parameter(block, text, first, i - 1, file, line, log)
         first = i + 1
         continued = verify(text(first:), blanks) == 0
      end do
      if (inside) call complain(log, 'E0111', 'a quote is opened but not closed', &
         & location_type(file, line, index(text, '"', back=.true.), len_trim(text)), &
         & label='no second quote on this line')
      call add_parameter(block, text, first, len(text), file, line, log)
   end subroutine read_parameters

   !> Add `NAME=VALUE` or `NAME` between two columns; blank text adds nothing.
   subroutine add_parameter(block, text, first, last, file, line, log)
      type(block_type), intent(inout) :: block
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, last, file, line
      type(log_type), intent(inout) :: log
      type(parameter_type) :: new
      integer :: equals, a, b

      if (verify(text(first:last), blanks) == 0) return
      equals = index(text(first:last), '=') + first - 1
      new%has_value = equals >= first
      a = first
      b = last
      if (new%has_value) b = equals - 1
      call shrink(text, a, b)
      new%name = upper(squeeze(text(a:b)))
      new%at = location_type(file, line, a, max(a, b))
      new%value = ''
      new%value_at = new%at
      if (new%has_value) then
         a = equals + 1
         b = last
         call shrink(text, a, b)
         new%value = without_quotes(text(a:b))
         new%value_at = location_type(file, line, a, max(a, b))
      end if
      if (has_parameter(block, new%name)) then
         call complain(log, 'E0114', 'the parameter '//quoted(new%name)//' is given twice', new%at)
      else
         block%parameter = [block%parameter, new]
      end if
   end subroutine add_parameter

   !> Move two columns inwards past blanks; `first > last` when there is nothing else.
   pure subroutine shrink(text, first, last)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: first, last
      integer :: start

      start = first
      first = start - 1 + verify(text(start:last), blanks)
      if (first == start - 1) then
         first = start
         last = start - 1
      else
         last = start - 1 + verify(text(start:last), blanks, back=.true.)
      end if
   end subroutine shrink
end module lopin_keyword_line
