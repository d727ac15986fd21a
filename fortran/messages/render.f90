!> Diagnostics as a user reads them: code, one sentence, the line of the deck, a caret, why, what
!> to do.
!>
!> Only text is made here; `app/` prints it. The same diagnostics as JSON serve editors and Python.
module lopin_render
   use lopin_block, only : deck_type, line_text
   use lopin_error, only : diagnostic_type, severity
   use lopin_safe_text, only : printable, json_text
   use lopin_text, only : to_text
   implicit none
   private
   public :: render, render_json, json_string

   character(len=1), parameter :: nl = achar(10)
   character(len=*), parameter :: escape = achar(27)//'['
   integer, parameter :: window = 160   !! longer lines of a deck are shown in part

contains

   !> One diagnostic in full, with a line end after each line.
   function render(item, deck, colour) result(text)
      type(diagnostic_type), intent(in) :: item
      type(deck_type), intent(in) :: deck
      logical, intent(in) :: colour                  !! with the escape sequences of terminals
      character(len=:), allocatable :: text
      character(len=:), allocatable :: margin
      integer :: width

      text = painted(severity_word(item%severity)//'['//item%id//']', item%severity, colour)// &
         & ': '// &
         & printable(item%message)//nl
      width = 2
      if (has_source(item, deck)) then
         width = max(width, len(to_text(item%at%line)))
         text = text//source_lines(item, deck, width, colour)
      end if
      margin = repeat(' ', width + 1)
      text = text//remark(margin, 'note', item%note)//remark(margin, 'note', included(item, &
         & deck))// &
         & remark(margin, 'help', item%help)
   end function render

   !> Arrow, line of the deck and caret.
   function source_lines(item, deck, width, colour) result(text)
      type(diagnostic_type), intent(in) :: item
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: width
      logical, intent(in) :: colour
      character(len=:), allocatable :: text
      character(len=:), allocatable :: line, number, caret
      integer :: first, last, start

      associate (source => deck%source(item%at%file), at => item%at)
         line = line_text(source, at%line)
         first = max(1, min(at%first, len(line) + 1))
         last = max(first, min(at%last, len(line)))
         text = repeat(' ', width - 1)//'--> '//printable(source%name)//':'//to_text(at%line)
         if (at%first > 0) text = text//':'//to_text(letters(line(:first - 1)) + 1)
         text = text//nl
         start = 1
         if (len(line) > window) then
            start = max(1, min(first - window/4, len(line) - window + 1))
            line = line(start:min(len(line), start + window - 1))
            first = first - start + 1
            last = min(last - start + 1, len(line))
         end if
         number = to_text(at%line)
         number = repeat(' ', width - len(number))//number
         text = text//repeat(' ', width + 1)//'|'//nl//number//' | '//printable(line)//nl
         if (at%first == 0) return
         caret = repeat('^', max(1, letters(line(first:min(last, len(line))))))
         if (len(item%label) > 0) caret = caret//' '//printable(item%label)
         text = text//repeat(' ', width + 1)//'| '//repeat(' ', letters(line(:first - 1)))// &
            & painted(caret, item%severity, colour)//nl
      end associate
   end function source_lines

   !> Where the file of a diagnostic is included; '' for the deck itself.
   function included(item, deck) result(text)
      type(diagnostic_type), intent(in) :: item
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: text
      integer :: k

      text = ''
      if (.not. has_source(item, deck)) return
      k = item%at%file
      do while (deck%source(k)%included_from%file > 0)
         associate (from => deck%source(k)%included_from)
            if (len(text) > 0) text = text//', '
            text = text//printable(deck%source(k)%name)//' is included at '// &
               & printable(deck%source(from%file)%name)//':'// &
               & to_text(from%line)
            k = from%file
         end associate
      end do
   end function included

   pure logical function has_source(item, deck)
      type(diagnostic_type), intent(in) :: item
      type(deck_type), intent(in) :: deck

      has_source = allocated(deck%source) .and. item%at%file > 0
      if (has_source) has_source = item%at%file <= size(deck%source)
   end function has_source

   !> `    = note: ...`; further lines of the text are set under its first.
   pure function remark(margin, word, said) result(text)
      character(len=*), intent(in) :: margin, word, said
      character(len=:), allocatable :: text
      character(len=:), allocatable :: content
      integer :: first, length

      text = ''
      content = printable(said)
      if (len(content) == 0) return
      text = margin//'= '//word//': '
      first = 1
      do
         length = index(content(first:), nl)
         if (length == 0) exit
         text = text//content(first:first + length - 1)//margin//repeat(' ', len(word) + 4)
         first = first + length
      end do
      text = text//content(first:)//nl
   end function remark

   !> Number of letters of a text in UTF-8: bytes that do not continue a letter.
   pure integer function letters(text)
      character(len=*), intent(in) :: text
      integer :: i

      letters = 0
      do i = 1, len(text)
         if (iachar(text(i:i)) < 128 .or. iachar(text(i:i)) > 191) letters = letters + 1
      end do
   end function letters

   pure function painted(text, level, colour) result(shown)
      character(len=*), intent(in) :: text
      integer, intent(in) :: level
      logical, intent(in) :: colour
      character(len=:), allocatable :: shown

      shown = text
      if (.not. colour) return
      select case (level)
      case (severity%error)
         shown = escape//'1;31m'//text//escape//'0m'
      case (severity%warning)
         shown = escape//'1;33m'//text//escape//'0m'
      case default
         shown = escape//'1;36m'//text//escape//'0m'
      end select
   end function painted

   pure function severity_word(level) result(word)
      integer, intent(in) :: level
      character(len=:), allocatable :: word

      select case (level)
      case (severity%error)
         word = 'error'
      case (severity%warning)
         word = 'warning'
      case default
         word = 'note'
      end select
   end function severity_word

   !> One diagnostic as a JSON object on one line.
   function render_json(item, deck) result(text)
      type(diagnostic_type), intent(in) :: item
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: text
      character(len=:), allocatable :: file
      integer :: line

      file = ''
      line = 0
      if (has_source(item, deck)) then
         file = deck%source(item%at%file)%name
         line = item%at%line
      end if
      text = '{"severity": "'//severity_word(item%severity)//'", "code": '//json_string(item%id)// &
         & ', "message": '//json_string(item%message)//', "file": '//json_string(file)// &
         & ', "line": '//to_text(line)//', "column": '//to_text(item%at%first)// &
         & ', "end_column": '//to_text(item%at%last)//', "label": '//json_string(item%label)// &
         & ', "note": '//json_string(item%note)//', "help": '//json_string(item%help)//'}'
   end function render_json

   !> A text between double quotes, with the escapes of JSON.
   pure function json_string(text) result(quoted)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: quoted
      quoted = '"'//json_text(text)//'"'
   end function json_string
end module lopin_render
