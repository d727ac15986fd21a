!> Text of a user where letters have a meaning: terminals, XML, CSV, JSON.
!>
!> Decks are bytes. What is not UTF-8, or commands a terminal (control characters, marks that turn
!> the direction of writing), is shown as a question mark.
module lopin_safe_text
   implicit none
   private
   public :: printable, json_text, xml_text, xml_meaning, csv_field

contains

   !> The text with nothing in it but letters, blanks for tabs, and line ends.
   pure function printable(text) result(shown)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: shown
      integer :: i, n, length

      shown = text
      n = 0
      i = 1
      do while (i <= len(text))
         length = letter_length(text(i:min(len(text), i + 3)))
         n = n + 1
         if (length == 0) then
            shown(n:n) = '?'
            if (text(i:i) == achar(9)) shown(n:n) = ' '
            length = max(1, mark_length(text(i:min(len(text), i + 2))))
         else
            shown(n:n + length - 1) = text(i:i + length - 1)
            n = n + length - 1
         end if
         i = i + length
      end do
      shown = shown(:n)
   end function printable

   !> The text as JSON has it between quotes; what commands a terminal is written by its number.
   pure function json_text(text) result(safe)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: safe
      integer :: i, length, mark

      safe = ''
      i = 1
      do while (i <= len(text))
         length = letter_length(text(i:min(len(text), i + 3)))
         mark = mark_length(text(i:min(len(text), i + 2)))
         if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) mark = 1
         if (text(i:i) == achar(10)) then
            safe = safe//'\n'
         else if (mark > 0) then
            safe = safe//numbered(text(i:i + mark - 1))
            length = mark
         else if (length == 0) then
            safe = safe//'?'
         else if (text(i:i) == '"' .or. text(i:i) == '\') then
            safe = safe//'\'//text(i:i)
         else
            safe = safe//text(i:i + length - 1)
         end if
         i = i + max(1, length)
      end do
   end function json_text

   !> A letter of one to three bytes as \u and four hexadecimal digits.
   pure function numbered(letter) result(text)
      character(len=*), intent(in) :: letter
      character(len=6) :: text
      character(len=*), parameter :: digit = '0123456789abcdef'
      integer :: code, i

      code = iachar(letter(1:1))
      if (len(letter) == 2) code = iand(code, 31)
      if (len(letter) == 3) code = iand(code, 15)
      do i = 2, len(letter)
         code = 64*code + iand(iachar(letter(i:i)), 63)
      end do
      text(:2) = '\u'
      do i = 6, 3, -1
         text(i:i) = digit(mod(code, 16) + 1:mod(code, 16) + 1)
         code = code/16
      end do
   end function numbered

   !> Bytes of the letter with which a text begins; 0 if it begins with none that may be shown.
   pure integer function letter_length(text) result(length)
      character(len=*), intent(in) :: text      !! not empty
      integer :: first, second, i

      first = iachar(text(1:1))
      length = 0
      if (first == 10 .or. (first >= 32 .and. first < 127)) length = 1
      if (first >= 194 .and. first < 224) length = 2
      if (first >= 224 .and. first < 240) length = 3
      if (first >= 240 .and. first < 245) length = 4
      if (length < 2) return
      if (length > len(text)) then
         length = 0
         return
      end if
      do i = 2, length
         if (iachar(text(i:i)) < 128 .or. iachar(text(i:i)) > 191) then
            length = 0
            return
         end if
      end do
      second = iachar(text(2:2))
      ! Longer than need be, surrogates, beyond the last; controls of the second half.
      if (first == 224 .and. second < 160 .or. first == 237 .and. second > 159 &
         & .or. first == 240 .and. second < 144 .or. first == 244 .and. second > 143 &
         & .or. first == 194 .and. second < 160) length = 0
      if (mark_length(text) > 0) length = 0
   end function letter_length

   !> Bytes of a mark that turns the direction of writing, or of a control of two bytes, at the
   !> beginning of a text; else 0.
   pure integer function mark_length(text) result(length)
      character(len=*), intent(in) :: text

      length = 0
      if (len(text) < 2) return
      if (iachar(text(1:1)) == 194 .and. iachar(text(2:2)) >= 128 .and. iachar(text(2:2)) < 160) &
         & length = 2
      if (len(text) < 3 .or. iachar(text(1:1)) /= 226) return
      ! U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069.
      if (iachar(text(2:2)) == 128 .and. (any(iachar(text(3:3)) == [142, 143]) .or. &
         & (iachar(text(3:3)) >= 168 .and. iachar(text(3:3)) <= 174))) length = 3
      if (iachar(text(2:2)) == 129 .and. iachar(text(3:3)) >= 166 .and. iachar(text(3:3)) <= 169) &
         & length = 3
   end function mark_length

   !> The text as XML has it in attributes and between tags.
   pure function xml_text(text) result(escaped)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: escaped
      character(len=:), allocatable :: shown
      integer :: i

      shown = printable(text)
      escaped = ''
      do i = 1, len(shown)
         select case (shown(i:i))
         case ('&')
            escaped = escaped//'&amp;'
         case ('<')
            escaped = escaped//'&lt;'
         case ('>')
            escaped = escaped//'&gt;'
         case ('"')
            escaped = escaped//'&quot;'
         case default
            escaped = escaped//shown(i:i)
         end select
      end do
   end function xml_text

   !> What a text of `xml_text` stands for.
   pure function xml_meaning(escaped) result(text)
      character(len=*), intent(in) :: escaped
      character(len=:), allocatable :: text
      character(len=*), parameter :: word(4) = [character(len=6) :: '&amp;', '&lt;', '&gt;', &
         & '&quot;'], letter(4) = ['&', '<', '>', '"']
      integer :: i, k, length

      text = ''
      i = 1
      do while (i <= len(escaped))
         length = 1
         do k = 1, size(word)
            if (index(escaped(i:), trim(word(k))) /= 1) cycle
            text = text//letter(k)
            length = len_trim(word(k))
            exit
         end do
         if (length == 1) text = text//escaped(i:i)
         i = i + length
      end do
   end function xml_meaning

   !> The text as a field of a table with commas: between quotes where it needs them.
   pure function csv_field(text) result(field)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: field
      integer :: i

      field = printable(text)
      if (scan(field, ',"'//achar(10)//achar(13)) == 0) return
      i = 1
      do while (i <= len(field))
         if (field(i:i) == '"') then
            field = field(:i)//'"'//field(i + 1:)
            i = i + 1
         end if
         i = i + 1
      end do
      field = '"'//field//'"'
   end function csv_field
end module lopin_safe_text
