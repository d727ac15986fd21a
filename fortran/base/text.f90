!> Words and numbers as text: case, blanks, parsing, printing, and the word that was probably meant.
module lopin_text
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use lopin_kinds, only : wp, lk
   implicit none
   private
   public :: upper, lower, squeeze, without_blanks, parse_real, parse_integer, edit_distance, &
      & nearest_word
   public :: to_text, join, quoted

   !> Shortest text that reads back as the same number: `to_text(0.1_wp)` is `0.1`.
   interface to_text
      module procedure integer_text, long_text, real_text, logical_text
   end interface to_text

   character(len=*), parameter :: blanks = ' '//achar(9)
   integer, parameter :: exact_power = 22      !! the last power of ten that a double holds exactly
   integer, parameter :: safe_digits = 15      !! of a decimal that a normal number gives back
   real(wp), parameter :: safe_above = 1.0e-300_wp   !! and normal numbers are all that are larger
   integer, parameter :: largest_power = 308   !! beyond it the run-time library would overflow

contains

   !> In upper case, letters of ASCII only.
   elemental function upper(text) result(changed)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: changed
      integer :: i

      changed = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') changed(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function upper

   elemental function lower(text) result(changed)
      character(len=*), intent(in) :: text
      character(len=len(text)) :: changed
      integer :: i

      changed = text
      do i = 1, len(text)
         if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') changed(i:i) = achar(iachar(text(i:i)) + 32)
      end do
   end function lower

   !> Runs of blanks and tabs become one blank; none at the ends.
   pure function squeeze(text) result(changed)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: changed
      character(len=len(text)) :: buffer
      integer :: i, n

      n = 0
      do i = 1, len(text)
         if (scan(text(i:i), blanks) == 0) then
            n = n + 1
            buffer(n:n) = text(i:i)
         else if (n > 0) then
            if (buffer(n:n) == ' ') cycle
            n = n + 1
            buffer(n:n) = ' '
         end if
      end do
      changed = trim(buffer(:n))
   end function squeeze

   pure function without_blanks(text) result(changed)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: changed
      character(len=len(text)) :: buffer
      integer :: i, n

      n = 0
      do i = 1, len(text)
         if (scan(text(i:i), blanks) > 0) cycle
         n = n + 1
         buffer(n:n) = text(i:i)
      end do
      changed = buffer(:n)
   end function without_blanks

   !> Read a whole text as an integer; `3.` and `3.0` are not integers.
   pure subroutine parse_integer(text, value, ok)
      character(len=*), intent(in) :: text   !! blanks around the number are allowed
      integer, intent(out) :: value
      logical, intent(out) :: ok
      integer(lk) :: number
      integer :: i, first, last

      value = 0
      ok = .false.
      call span(text, first, last)
      if (first > last) return
      i = first
      if (scan(text(i:i), '+-') > 0) i = i + 1
      if (i > last .or. last - i > 17) return
      number = 0_lk
      do i = i, last
         if (.not. is_digit(text(i:i))) return
         number = 10_lk*number + iachar(text(i:i)) - 48
      end do
      if (number > huge(value)) return
      value = int(number)
      if (text(first:first) == '-') value = -value
      ok = .true.
   end subroutine parse_integer

   !> Read a whole text as a real: `1`, `1.`, `.5`, `1E3`, `1D3`, `1+3`; not `nan` or `inf`.
   !>
   !> Up to 18 digits that fit into 2**53 and powers of ten up to 22 are read exactly by one
   !> product;
   !> the rest goes through the run-time library.
   pure subroutine parse_real(text, value, ok)
      character(len=*), intent(in) :: text   !! blanks around the number are allowed
      real(wp), intent(out) :: value
      logical, intent(out) :: ok
      integer(lk) :: mantissa
      integer :: first, last, i, digits, scale, power

      value = 0.0_wp
      ok = .false.
      call span(text, first, last)
      if (first > last) return
      i = first
      if (scan(text(i:i), '+-') > 0) i = i + 1
      call read_mantissa(text(:last), i, mantissa, digits, scale)
      if (digits == 0) return
      power = 0
      if (i <= last) then
         if (scan(text(i:i), 'eEdD') > 0) then
            i = i + 1
         else if (scan(text(i:i), '+-') == 0) then
            return
         end if
         call parse_integer(text(i:last), power, ok)
         if (.not. ok .or. abs(power) > 9999) then
            ok = .false.
            return
         end if
      end if
      power = power + scale
      ok = .true.
      if (digits <= 18 .and. mantissa <= 2_lk**53 .and. abs(power) <= exact_power) then
         value = real(mantissa, wp)
         if (power > 0) value = value*10.0_wp**power
         if (power < 0) value = value/10.0_wp**(-power)
         if (text(first:first) == '-') value = -value
      else if (mantissa == 0 .or. power + digits > largest_power) then
         ok = mantissa == 0
      else
         call read_slowly(text(first:last), value, ok)
      end if
   end subroutine parse_real

   !> Digits with at most one point, from position `i` on; `i` ends behind them.
   pure subroutine read_mantissa(text, i, mantissa, digits, scale)
      character(len=*), intent(in) :: text
      integer, intent(inout) :: i
      integer(lk), intent(out) :: mantissa
      integer, intent(out) :: digits   !! number of digits met
      integer, intent(out) :: scale    !! minus the number of digits behind the point
      logical :: point

      mantissa = 0_lk
      digits = 0
      scale = 0
      point = .false.
      do i = i, len(text)
         if (is_digit(text(i:i))) then
            digits = digits + 1
            if (digits <= 18) mantissa = 10_lk*mantissa + iachar(text(i:i)) - 48
            if (point) scale = scale - 1
         else if (text(i:i) == '.' .and. .not. point) then
            point = .true.
         else
            return
         end if
      end do
   end subroutine read_mantissa

   pure subroutine read_slowly(text, value, ok)
      character(len=*), intent(in) :: text
      real(wp), intent(out) :: value
      logical, intent(out) :: ok
      character(len=len(text) + 8) :: form
      integer :: status

      write (form, '("(f",i0,".0)")') len(text)
      read (text, form, iostat=status) value
      ok = status == 0
      if (ok) ok = ieee_is_finite(value)
      if (.not. ok) value = 0.0_wp
   end subroutine read_slowly

   !> First and last character that is neither blank nor tab; `first > last` when there is none.
   pure subroutine span(text, first, last)
      character(len=*), intent(in) :: text
      integer, intent(out) :: first, last

      first = verify(text, blanks)
      last = verify(text, blanks, back=.true.)
      if (first == 0) first = 1
   end subroutine span

   elemental logical function is_digit(letter)
      character(len=1), intent(in) :: letter
      is_digit = letter >= '0' .and. letter <= '9'
   end function is_digit

   !> Fewest insertions, deletions, replacements and swaps of neighbours that turn one word into
   !> another.
   pure integer function edit_distance(left, right) result(distance)
      character(len=*), intent(in) :: left, right
      integer :: row(0:len(right)), above(0:len(right)), higher(0:len(right))
      integer :: i, j

      row = [(j, j=0, len(right))]
      above = row
      do i = 1, len(left)
         higher = above
         above = row
         row(0) = i
         do j = 1, len(right)
            row(j) = min(above(j) + 1, row(j - 1) + 1, above(j - 1) + merge(0, 1, &
               & left(i:i) == right(j:j)))
            if (swapped(left, i, right, j)) row(j) = min(row(j), higher(max(0, j - 2)) + 1)
         end do
      end do
      distance = row(len(right))
   end function edit_distance

   !> Whether the two letters that end at i and at j are the same two in the other order.
   pure logical function swapped(left, i, right, j)
      character(len=*), intent(in) :: left, right
      integer, intent(in) :: i, j

      swapped = i > 1 .and. j > 1
      if (swapped) swapped = left(i:i) == right(j - 1:j - 1) .and. left(i - 1:i - 1) == right(j:j)
   end function swapped

   !> The word of a list that was probably meant, or '' when none is near enough.
   !>
   !> Near is: at most two letters wrong (one in a word of three or fewer), or the same beginning
   !> of at least four letters. Case does not matter.
   pure function nearest_word(word, list, n) result(found)
      character(len=*), intent(in) :: word
      character(len=*), intent(in) :: list(:)
      integer, intent(in), optional :: n     !! only the first n of the list
      character(len=:), allocatable :: found
      character(len=:), allocatable :: wanted, other
      integer :: i, best, distance, number

      number = size(list)
      if (present(n)) number = n
      found = ''
      wanted = upper(trim(word))
      best = merge(1, 2, len(wanted) <= 3) + 1
      do i = 1, number
         other = upper(trim(list(i)))
         if (abs(len(other) - len(wanted)) >= best) cycle
         distance = edit_distance(wanted, other)
         if (distance >= best .or. distance >= len(wanted)) cycle
         best = distance
         found = trim(list(i))
      end do
      if (found /= '' .or. len(wanted) < 4) return
      do i = 1, number
         if (index(upper(list(i)), wanted) /= 1) cycle
         found = trim(list(i))
         return
      end do
   end function nearest_word

   pure function integer_text(value) result(text)
      integer, intent(in) :: value
      character(len=:), allocatable :: text
      text = long_text(int(value, lk))
   end function integer_text

   pure function long_text(value) result(text)
      integer(lk), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=24) :: buffer

      write (buffer, '(i0)') value
      text = trim(buffer)
   end function long_text

   pure function logical_text(value) result(text)
      logical, intent(in) :: value
      character(len=:), allocatable :: text
      text = trim(merge('yes', 'no ', value))
   end function logical_text

   !> Fewest significant digits (or `digits` of them) that read back as the same number; no blanks.
   !>
   !> Decimals of 15 digits come back from normal numbers: fewer that do are those without their
   !> last zeros, which `plain` leaves out.
   pure function real_text(value, digits) result(text)
      real(wp), intent(in) :: value
      integer, intent(in), optional :: digits   !! round to so many significant digits, 1..17
      character(len=:), allocatable :: text
      character(len=40) :: buffer
      real(wp) :: again
      integer :: n, limit

      if (ieee_is_nan(value)) then
         text = 'nan'
      else if (.not. ieee_is_finite(value)) then
         text = trim(merge('inf ', '-inf', value > 0.0_wp))
      else
         limit = 17
         if (present(digits)) limit = max(1, min(17, digits))
         n = min(limit, safe_digits)
         if (abs(value) < safe_above) n = 1
         do n = n, limit
            write (buffer, '(es40.'//achar(48 + (n - 1)/10)//achar(48 + mod(n - 1, 10))//'e3)') &
               & value
            if (n == limit) exit
            read (buffer, '(f40.0)') again
            if (abs(again - value) <= 0.0_wp) exit
         end do
         text = plain(trim(adjustl(buffer)))
      end if
   end function real_text

   !> `1.25E+003` as `1250`, `1.25E-007` as `1.25e-7`.
   pure function plain(scientific) result(text)
      character(len=*), intent(in) :: scientific
      character(len=:), allocatable :: text
      character(len=:), allocatable :: sign, digits
      integer :: e, power, i
      logical :: ok

      e = index(scientific, 'E')
      call parse_integer(scientific(e + 1:), power, ok)
      sign = ''
      if (scientific(1:1) == '-') sign = '-'
      digits = ''
      do i = 1, e - 1
         if (is_digit(scientific(i:i))) digits = digits//scientific(i:i)
      end do
      i = verify(digits, '0', back=.true.)
      digits = digits(:max(1, i))
      if (digits == '0') then
         text = '0'
      else if (power < -4 .or. power > 15) then
         text = sign//digits(1:1)
         if (len(digits) > 1) text = text//'.'//digits(2:)
         text = text//'e'//integer_text(power)
      else if (power < 0) then
         text = sign//'0.'//repeat('0', -power - 1)//digits
      else if (len(digits) > power + 1) then
         text = sign//digits(:power + 1)//'.'//digits(power + 2:)
      else
         text = sign//digits//repeat('0', power + 1 - len(digits))
      end if
   end function plain

   !> The trimmed words of a list with a separator between them.
   pure function join(list, separator, n) result(text)
      character(len=*), intent(in) :: list(:)
      character(len=*), intent(in), optional :: separator   !! ', ' unless given
      integer, intent(in), optional :: n                    !! only the first n, then '...'
      character(len=:), allocatable :: text
      character(len=:), allocatable :: between
      integer :: i

      between = ', '
      if (present(separator)) between = separator
      text = ''
      do i = 1, size(list)
         if (i > 1) text = text//between
         if (present(n)) then
            if (i > n) then
               text = text//'...'
               return
            end if
         end if
         text = text//trim(list(i))
      end do
   end function join

   !> A text as the messages show it: between back quotes.
   pure function quoted(text) result(shown)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: shown
      shown = '`'//text//'`'
   end function quoted
end module lopin_text
