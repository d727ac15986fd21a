!> The pieces of a deck: sources, blocks (a keyword line with its data lines), parameters, fields.
!>
!> Everything remembers its file, line and columns, because every message shows them. Reading a
!> field
!> never stops at a bad number: the complaint goes into a log and the reader carries on.
module lopin_block
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : parse_real, parse_integer, quoted
   implicit none
   private
   public :: source_type, parameter_type, data_line_type, field_type, block_type, deck_type
   public :: split_fields, count_fields, field_real, field_integer, get_parameter, has_parameter
   public :: complain, line_text, line_place, without_quotes, quotes_close

   integer, parameter :: most_errors = 20   !! further errors of one reading are not collected

   !> One file, or one text given by a caller.
   type :: source_type
      character(len=:), allocatable :: name        !! as shown in messages
      character(len=:), allocatable :: folder      !! with a trailing slash; '' is the current one
      character(len=:), allocatable :: text        !! without a byte-order mark
      integer, allocatable :: line_start(:)        !! (nline + 1) first character of each line
      integer :: nline = 0
      logical :: is_ascii = .true.                 !! no byte above 127
      type(location_type) :: included_from         !! the *INCLUDE line; file = 0: the deck
   end type source_type

   type :: parameter_type
      character(len=:), allocatable :: name        !! upper case, single blanks
      character(len=:), allocatable :: value       !! case as written, no quotes; '' if none
      logical :: has_value = .false.
      type(location_type) :: at                    !! the name
      type(location_type) :: value_at              !! the value, or the name if it has none
   end type parameter_type

   type :: data_line_type
      integer :: file = 0, line = 0
      character(len=:), allocatable :: text        !! the whole line: columns are the file's
   end type data_line_type

   type :: field_type
      character(len=:), allocatable :: text        !! trimmed, without quotes
      type(location_type) :: at
   end type field_type

   type :: block_type
      character(len=:), allocatable :: keyword     !! upper case, single blanks, without the star
      type(location_type) :: at
      type(parameter_type), allocatable :: parameter(:)
      integer :: nline = 0
      type(data_line_type), allocatable :: line(:) !! 1..nline; no comments, no empty lines
   end type block_type

   type :: deck_type
      type(source_type), allocatable :: source(:)
      type(block_type), allocatable :: block(:)    !! the first nblock are used
      integer :: nblock = 0
   end type deck_type

   character(len=*), parameter :: blanks = ' '//achar(9)

contains

   !> Cut a data line at its commas, outside quotes; one comma at the end is ignored.
   subroutine split_fields(line, field, n)
      type(data_line_type), intent(in) :: line
      type(field_type), allocatable, intent(inout) :: field(:)   !! reused, grows when needed
      integer, intent(out) :: n   !! number of fields; a lone comma is one empty field
      integer :: first, last, comma, length, number

      number = count_fields(line%text)
      if (.not. allocated(field)) allocate (field(max(16, number)))
      if (size(field) < number) then
         deallocate (field)
         allocate (field(2*number))
      end if
      length = len(line%text)
      first = 1
      do n = 1, number
         comma = next_comma(line%text, first)
         last = comma - 1
         if (comma == 0) last = length
         call set_field(field(n), line, first, last)
         first = last + 2
      end do
      n = number
   end subroutine split_fields

   !> Number of fields of a line; one comma at the end opens no field, a lone comma is one empty
   !> field.
   pure integer function count_fields(text) result(number)
      character(len=*), intent(in) :: text
      integer :: first, comma

      number = 0
      first = 1
      do
         if (verify(text(first:), blanks) == 0) return
         number = number + 1
         comma = next_comma(text, first)
         if (comma == 0) return
         first = comma + 1
      end do
   end function count_fields

   !> Position of the next comma outside double quotes, 0 when there is none.
   pure integer function next_comma(text, first) result(comma)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first
      logical :: inside

      inside = .false.
      do comma = first, len(text)
         if (text(comma:comma) == '"') inside = .not. inside
         if (text(comma:comma) == ',' .and. .not. inside) return
      end do
      comma = 0
   end function next_comma

   !> Whether each quote of the text has its second one.
   pure logical function quotes_close(text)
      character(len=*), intent(in) :: text
      integer :: i

      quotes_close = .true.
      do i = 1, len(text)
         if (text(i:i) == '"') quotes_close = .not. quotes_close
      end do
   end function quotes_close

   !> A name as it is meant: quoted, or with quoted parts (`"my part-1".Set-1`). A quote that is not
   !> closed stays.
   pure function without_quotes(text) result(bare)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: bare
      integer :: i

      bare = text
      if (.not. quotes_close(text)) return
      do
         i = index(bare, '"')
         if (i == 0) return
         bare = bare(:i - 1)//bare(i + 1:)
      end do
   end function without_quotes

   subroutine set_field(field, line, first, last)
      type(field_type), intent(inout) :: field
      type(data_line_type), intent(in) :: line
      integer, intent(in) :: first, last     !! columns between the commas
      integer :: a, b

      a = first
      b = last
      do while (a < b)
         if (scan(line%text(a:a), blanks) == 0) exit
         a = a + 1
      end do
      do while (b > a)
         if (scan(line%text(b:b), blanks) == 0) exit
         b = b - 1
      end do
      if (b < a) then
         field%text = ''
      else if (a == b .and. scan(line%text(a:b), blanks) > 0) then
         field%text = ''
      else
         field%text = without_quotes(line%text(a:b))
      end if
      field%at = location_type(line%file, line%line, a, max(a, b))
   end subroutine set_field

   !> A field as a real; `found` is false for an empty field and, with a complaint, for bad text.
   subroutine field_real(field, value, log, found)
      type(field_type), intent(in) :: field
      real(wp), intent(out) :: value
      type(log_type), intent(inout) :: log
      logical, intent(out) :: found

      call parse_real(field%text, value, found)
      if (found .or. len(field%text) == 0) return
      call bad_number(field, 'a number', log)
   end subroutine field_real

   !> A field as an integer; `found` is false for an empty field and, with a complaint, for bad
   !> text.
   subroutine field_integer(field, value, log, found)
      type(field_type), intent(in) :: field
      integer, intent(out) :: value
      type(log_type), intent(inout) :: log
      logical, intent(out) :: found

      call parse_integer(field%text, value, found)
      if (found .or. len(field%text) == 0) return
      call bad_number(field, 'a whole number', log)
   end subroutine field_integer

   !> Say what is wrong with a field that should have been a number, and what was probably meant.
   subroutine bad_number(field, wanted, log)
      type(field_type), intent(in) :: field
      character(len=*), intent(in) :: wanted
      type(log_type), intent(inout) :: log
      real(wp) :: value
      integer :: gap
      logical :: left, right

      gap = scan(field%text, ';')
      if (gap > 0) then
         call complain(log, 'E0104', quoted(field%text)//' is not '//wanted// &
            & ': fields are separated by commas', &
            & field%at, label='semicolon', help='write a comma between fields and a point in '// &
            & 'numbers, as in 0.3')
         return
      end if
      gap = scan(field%text, blanks)
      left = .false.
      right = .false.
      if (gap > 0) then
         call parse_real(field%text(:gap - 1), value, left)
         call parse_real(field%text(gap + 1:), value, right)
      end if
      if (left .and. right) then
         call complain(log, 'E0103', quoted(field%text)//' is not '//wanted, field%at, &
            & label='a comma seems to be missing', &
            & help='write '//quoted(field%text(:gap - 1)//', '// &
            & trim(adjustl(field%text(gap + 1:)))))
      else
         call complain(log, 'E0103', quoted(field%text)//' is not '//wanted, field%at, &
            & label='expected '//wanted)
      end if
   end subroutine bad_number

   !> Add an error to a log, unless it already holds as many as a user wants to read at once.
   subroutine complain(log, id, message, at, label, note, help)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in) :: at
      character(len=*), intent(in), optional :: label, note, help

      if (log%count_of(severity%error) >= most_errors) return
      call log%say(severity%error, id, message, at, label, note, help)
   end subroutine complain

   !> The value of a parameter; '' if it is absent or has none.
   subroutine get_parameter(block, name, value, at, found)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name                    !! upper case
      character(len=:), allocatable, intent(out) :: value
      type(location_type), intent(out) :: at   !! the value, else the name, else the keyword
      logical, intent(out) :: found
      integer :: i

      value = ''
      at = block%at
      found = .false.
      do i = 1, size(block%parameter)
         if (block%parameter(i)%name /= name) cycle
         value = block%parameter(i)%value
         at = block%parameter(i)%value_at
         found = .true.
         return
      end do
   end subroutine get_parameter

   !> Whether a keyword line has a parameter.
   pure logical function has_parameter(block, name)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name                    !! upper case
      integer :: i

      has_parameter = .true.
      do i = 1, size(block%parameter)
         if (block%parameter(i)%name == name) return
      end do
      has_parameter = .false.
   end function has_parameter

   !> The text of a line of a source, without its end.
   pure function line_text(source, line) result(text)
      type(source_type), intent(in) :: source
      integer, intent(in) :: line
      character(len=:), allocatable :: text
      integer :: last

      text = ''
      if (line < 1 .or. line > source%nline) return
      last = source%line_start(line + 1) - 1
      do while (last >= source%line_start(line))
         if (scan(source%text(last:last), achar(10)//achar(13)) == 0) exit
         last = last - 1
      end do
      text = source%text(source%line_start(line):last)
   end function line_text

   !> The whole of a data line, without blanks at its ends.
   pure type(location_type) function line_place(line) result(at)
      type(data_line_type), intent(in) :: line
      at = location_type(line%file, line%line, max(1, verify(line%text, blanks)), &
         & max(1, verify(line%text, blanks, back=.true.)))
   end function line_place
end module lopin_block
