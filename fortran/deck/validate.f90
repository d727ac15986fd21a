!> Checks every block of a deck against the keyword table: words, parameters, values, places.
!>
!> What passes has its first spelling: *ENDSTEP becomes END STEP, MAIN= becomes MASTER=, choices
!> are in
!> upper case, a parameter written without its value has the value that this means.
module lopin_validate
   use lopin_block, only : deck_type, block_type, parameter_type, complain, has_parameter, line_text
   use lopin_error, only : log_type, location_type, severity
   use lopin_keyword_table, only : keyword_table_type, keyword_type, keyword_parameter_type, &
      & status_of, find_keyword, find_parameter, suggest_keyword, suggest_parameter
   use lopin_keywords, only : new_keyword_table
   use lopin_place, only : place_type, enter, leave_deck
   use lopin_text, only : upper, without_blanks, quoted, parse_real, parse_integer, &
      & nearest_word
   use lopin_kinds, only : wp
   use lopin_lost_star, only : check_stars
   use lopin_validate_data, only : check_data
   use lopin_word_list, only : in_list, list_item, list_size
   implicit none
   private
   public :: validate_deck

   !> What stands behind the noun of a sentence, which says whether it is one or several.
   character(len=7), parameter :: behind_nouns(7) = [character(len=7) :: 'of', 'that', 'fitted', &
      & 'given', 'in', 'without', 'by']

contains

   !> Complain about what the table does not allow, and bring every word into its first spelling.
   subroutine validate_deck(deck, log)
      type(deck_type), intent(inout) :: deck
      type(log_type), intent(inout) :: log
      type(keyword_table_type) :: table
      type(place_type) :: place
      type(log_type) :: unheard
      integer :: i, row
      logical :: lost

      lost = .false.
      call new_keyword_table(table)
      do i = 1, deck%nblock
         row = find_keyword(table, deck%block(i)%keyword)
         call check_letters(deck, i, is_prose(table, row), log)
         if (row == 0) then
            call unknown_keyword(deck, table, i, place, log)
            cycle
         end if
         associate (block => deck%block(i), known => table%row(row))
            block%keyword = known%name
            ! Where a star is lost, what follows stands in no place that can be told.
            if (lost) then
               call enter(place, deck, known, i, unheard)
            else
               call enter(place, deck, known, i, log)
            end if
            if (known%status == status_of%later) then
               call complain(log, 'E0108', '*'//known%name//' is known but not yet there: '// &
                  & known%sentence//' '//verb(known%sentence)//' with a later version', block%at)
               cycle
            end if
            if (known%status == status_of%ignored) call note_once(log, 'N0101', '*'//known%name// &
               & ' is read past: '//known%sentence, block%at)
            call check_parameters(block, known, log)
            call check_stars(block, known, table, log, lost)
            call check_data(block, known, table, log)
         end associate
      end do
      if (.not. lost) call leave_deck(place, deck, log)
   end subroutine validate_deck

   !> Of a noun with what may stand behind it: `elements that fail`, `couplings (*EQUATION exists)`.
   pure function verb(noun) result(word)
      character(len=*), intent(in) :: noun
      character(len=:), allocatable :: word
      integer :: last, i, j

      last = len(noun)
      j = index(noun, ' (')
      if (j > 0) last = j - 1
      do i = 1, size(behind_nouns)
         j = index(noun, ' '//trim(behind_nouns(i))//' ')
         if (j > 0) last = min(last, j - 1)
      end do
      word = 'comes'
      if (noun(last:last) == 's' .and. noun(:last) /= 'dynamics') word = 'come'
   end function verb

   !> An unknown keyword: what was meant, and where it would be expected.
   subroutine unknown_keyword(deck, table, number, place, log)
      type(deck_type), intent(in) :: deck
      type(keyword_table_type), intent(in) :: table
      integer, intent(in) :: number          !! of the block
      type(place_type), intent(in) :: place
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: meant, label, note, help
      integer :: row

      label = ''
      note = ''
      help = 'a line that begins with ** is a comment'
      associate (block => deck%block(number))
         if (len(block%keyword) == 0) then
            call complain(log, 'E0101', 'a star without a keyword', block%at, help=help)
            return
         end if
         meant = suggest_keyword(table, block%keyword)
         if (len(meant) > 0) then
            label = 'did you mean *'//meant//' ?'
            help = "lopin doc '*"//meant//"'"
            row = find_keyword(table, meant)
            if (place%parent > 0) then
               if (in_list(table%row(row)%parents, deck%block(place%parent)%keyword)) &
                  & note = 'it follows '//place%shown(deck)//', where *'//meant//' is expected'
            end if
            if (index(meant, block%keyword) == 1) note = 'keywords are written in full'
         end if
         call complain(log, 'E0101', 'unknown keyword *'//block%keyword, block%at, label, note, &
            & help)
      end associate
   end subroutine unknown_keyword

   subroutine check_parameters(block, known, log)
      type(block_type), intent(inout) :: block
      type(keyword_type), intent(in) :: known
      type(log_type), intent(inout) :: log
      integer :: i, k

      do i = 1, size(block%parameter)
         k = find_parameter(known, block%parameter(i)%name)
         if (k > 0) then
            block%parameter(i)%name = known%parameter(k)%name
            call check_value(block%parameter(i), known, known%parameter(k), log)
         else if (known%status /= status_of%ignored) then
            call unknown_parameter(block%parameter(i), known, log)
         end if
      end do
      do k = 1, size(known%parameter)
         associate (wanted => known%parameter(k))
            if (.not. wanted%is_required .or. has_parameter(block, wanted%name)) cycle
            call complain(log, 'E0106', '*'//known%name//' needs the parameter '//wanted%name, &
               & block%at, &
               & label=wanted%name//'= is missing', help="lopin doc '*"//known%name//"'")
         end associate
      end do
   end subroutine check_parameters

   subroutine unknown_parameter(parameter, known, log)
      type(parameter_type), intent(in) :: parameter
      type(keyword_type), intent(in) :: known
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: meant, message, label, note
      real(wp) :: value
      logical :: is_number
      integer :: i

      meant = suggest_parameter(known, parameter%name)
      message = quoted(parameter%name)//' is not a parameter of *'//known%name
      label = ''
      note = ''
      if (len(meant) > 0) then
         message = message//'; did you mean '//meant//'?'
         label = 'did you mean '//meant//' ?'
         i = find_parameter(known, meant)
         if (len(known%parameter(i)%missing) > 0) message = message//' '//known%parameter(i)%missing
      else if (size(known%parameter) == 0) then
         note = '*'//known%name//' has no parameters'
      else
         note = 'parameters of *'//known%name//': '//known%parameter(1)%name
         do i = 2, size(known%parameter)
            note = note//', '//known%parameter(i)%name
         end do
      end if
      call parse_real(parameter%name, value, is_number)
      if (is_number) note = 'a keyword line that ends with a comma goes on in the next line'
      call complain(log, 'E0102', message, parameter%at, label, note, "lopin doc '*"//known%name// &
         & "'")
   end subroutine unknown_parameter

   !> Judge the value of a known parameter and bring a choice into its first spelling.
   subroutine check_value(parameter, known, rule, log)
      type(parameter_type), intent(inout) :: parameter
      type(keyword_type), intent(in) :: known
      type(keyword_parameter_type), intent(in) :: rule
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: shown

      shown = rule%name//' of *'//known%name
      if (rule%status == status_of%later) then
         call complain(log, 'E0108', shown//' is known but not yet there: it comes with a '// &
            & 'later version', &
            & parameter%at, note=rule%sentence)
         return
      end if
      if (rule%status == status_of%ignored) then
         if (known%status == status_of%supported) call note_once(log, 'N0102', shown// &
            & ' is read past: '// &
            & rule%sentence, parameter%at)
         return
      end if
      if (len_trim(parameter%value) == 0 .and. rule%kind /= 'flag') then
         if (parameter%has_value .or. len(rule%bare) == 0) then
            call complain(log, 'E0106', shown//' needs a value', parameter%at, label='write '// &
               & rule%name//'=...')
            return
         end if
         parameter%value = rule%bare
         parameter%has_value = .true.
      end if
      call check_kind(parameter, shown, rule, log)
   end subroutine check_value

   subroutine check_kind(parameter, shown, rule, log)
      type(parameter_type), intent(inout) :: parameter
      character(len=*), intent(in) :: shown   !! e.g. `INC of *STEP`
      type(keyword_parameter_type), intent(in) :: rule
      type(log_type), intent(inout) :: log
      real(wp) :: number
      integer :: whole
      logical :: ok

      ok = .true.
      select case (rule%kind)
      case ('flag')
         ok = .not. parameter%has_value
         if (.not. ok) call complain(log, 'E0106', shown//' takes no value', parameter%value_at)
      case ('number')
         call parse_real(parameter%value, number, ok)
      case ('whole number')
         call parse_integer(parameter%value, whole, ok)
      case ('choice')
         call check_choice(parameter, shown, rule, log)
      end select
      if (.not. ok .and. parameter%has_value .and. rule%kind /= 'flag') call complain(log, &
         & 'E0106', &
         & quoted(parameter%value)//' is not a '//rule%kind//', which '//shown//' needs', &
         & parameter%value_at)
   end subroutine check_kind

   subroutine check_choice(parameter, shown, rule, log)
      type(parameter_type), intent(inout) :: parameter
      character(len=*), intent(in) :: shown
      type(keyword_parameter_type), intent(in) :: rule
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: label, help
      integer :: i

      call respell(parameter, rule, log)
      do i = 1, list_size(rule%choices)
         if (without_blanks(upper(parameter%value)) /= without_blanks(list_item(rule%choices, &
            & i))) cycle
         parameter%value = list_item(rule%choices, i)
         return
      end do
      help = 'values: '//list_item(rule%choices, 1)
      do i = 2, list_size(rule%choices)
         help = help//', '//list_item(rule%choices, i)
      end do
      if (in_list(rule%refused, parameter%value)) then
         label = rule%name//'='//upper(parameter%value)
         if (parameter%value_at%first == parameter%at%first) label = rule%name
         call complain(log, 'E0108', label//' is known but not yet there: it comes with a '// &
            & 'later version', &
            & parameter%value_at, note=rule%sentence, help=help)
      else if (in_list(rule%replaced, parameter%value)) then
         call note_once(log, 'N0103', quoted(parameter%value)//' of '//shown// &
            & ' belongs to another code; '// &
            & rule%default//' is used', parameter%value_at)
         parameter%value = rule%default
      else
         label = nearest_word(parameter%value, choices_of(rule))
         if (len(label) > 0) then
            label = 'did you mean '//label//' ?'
         else
            label = 'unknown value'
         end if
         call complain(log, 'E0106', quoted(parameter%value)//' is not a value of '//shown, &
            & parameter%value_at, label=label, help=help)
      end if
   end subroutine check_choice

   !> A known misspelling of a value becomes that value.
   subroutine respell(parameter, rule, log)
      type(parameter_type), intent(inout) :: parameter
      type(keyword_parameter_type), intent(in) :: rule
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: pair
      integer :: i, k

      do i = 1, list_size(rule%misspelt)
         pair = list_item(rule%misspelt, i)
         k = index(pair, '=')
         if (without_blanks(upper(parameter%value)) /= without_blanks(pair(:k - 1))) cycle
         call note_once(log, 'N0105', quoted(parameter%value)//' is read as '//pair(k + 1:), &
            & parameter%value_at)
         parameter%value = pair(k + 1:)
         return
      end do
   end subroutine respell

   pure function choices_of(rule) result(list)
      type(keyword_parameter_type), intent(in) :: rule
      character(len=64) :: list(list_size(rule%choices))
      integer :: i

      do i = 1, size(list)
         list(i) = list_item(rule%choices, i)
      end do
   end function choices_of

   pure logical function is_prose(table, row)
      type(keyword_table_type), intent(in) :: table
      integer, intent(in) :: row             !! 0: an unknown keyword

      is_prose = .false.
      if (row > 0) is_prose = table%row(row)%is_free_text
   end function is_prose

   !> Letters outside 7-bit ASCII stand in comments and titles only.
   subroutine check_letters(deck, number, prose, log)
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: number          !! of the block
      logical, intent(in) :: prose           !! its data lines are in any alphabet
      type(log_type), intent(inout) :: log
      integer :: i

      associate (block => deck%block(number))
         if (.not. deck%source(block%at%file)%is_ascii) then
            call complain_of_letter(line_text(deck%source(block%at%file), block%at%line), &
               & block%at, log)
            do i = 1, size(block%parameter)
               if (block%parameter(i)%at%line == block%at%line) cycle
               call complain_of_letter(line_text(deck%source(block%parameter(i)%at%file), &
                  & block%parameter(i)%at%line), block%parameter(i)%at, log)
            end do
         end if
         if (prose) return
         do i = 1, block%nline
            if (deck%source(block%line(i)%file)%is_ascii) cycle
            call complain_of_letter(block%line(i)%text, location_type(block%line(i)%file, &
               & block%line(i)%line), log)
         end do
      end associate
   end subroutine check_letters

   subroutine complain_of_letter(text, at, log)
      character(len=*), intent(in) :: text
      type(location_type), intent(in) :: at   !! file and line
      type(log_type), intent(inout) :: log
      integer :: i, last

      do i = 1, len(text)
         if (iachar(text(i:i)) <= 127) cycle
         last = i
         do while (last < len(text))
            if (iachar(text(last + 1:last + 1)) < 128 &
               & .or. iachar(text(last + 1:last + 1)) > 191) exit
            last = last + 1
         end do
         call complain(log, 'E0109', quoted(text(i:last))//' is not a letter of the deck''s '// &
            & 'alphabet', &
            & location_type(at%file, at%line, i, last), label='not 7-bit ASCII', &
            & help='accents and other alphabets may stand in comments and titles')
         return
      end do
   end subroutine complain_of_letter

   !> Say a note unless the same was said before.
   subroutine note_once(log, id, message, at)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in) :: at
      integer :: i

      do i = 1, log%n
         if (log%item(i)%id == id .and. log%item(i)%message == message) return
      end do
      call log%say(severity%note, id, message, at)
   end subroutine note_once
end module lopin_validate
