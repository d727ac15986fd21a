!> The grammar of decks, row by row, and what the keyword table says about them.
program test_deck
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type, location_type, severity
   use lopin_deck, only : deck_type, field_type, data_line_type, read_deck, &
      & read_deck_text, &
      & split_fields, count_fields, field_real, field_integer, get_parameter
   use lopin_render, only : render
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none

   character(len=1), parameter :: nl = achar(10), cr = achar(13), tab = achar(9)
   type(deck_type) :: deck
   type(log_type) :: log
   type(error_type), allocatable :: error
   type(field_type), allocatable :: field(:)
   integer :: n

   call keyword_lines()
   call comments_and_empty_lines()
   call line_ends()
   call fields()
   call numbers()
   call first_spellings()
   call includes()
   call complaints()
   call notes()
   call a_large_deck_is_read_quickly()
   call finish()

contains

   subroutine read_text(text)
      character(len=*), intent(in) :: text
      log = log_type()
      call read_deck_text(deck, text, 'deck.inp', '', log, error)
   end subroutine read_text

   subroutine keyword_lines()
      character(len=:), allocatable :: value
      type(location_type) :: at
      logical :: found

      call test('a keyword line: any case, blanks anywhere, the first star after blanks')
      call read_text('  *element , type = cpe4 , ElSet = Body'//nl//'1,1,2,3,4'//nl)
      call is_true('no error', .not. allocated(error))
      call equal_text('keyword', deck%block(1)%keyword, 'ELEMENT')
      call get_parameter(deck%block(1), 'ELSET', value, at, found)
      call equal_text('value keeps its case', value, 'Body')
      call is_true('columns of the value', at%line == 1 .and. at%first == 36 .and. at%last == 39)
      call get_parameter(deck%block(1), 'NSET', value, at, found)
      call is_true('absent', .not. found .and. value == '')

      call test('a quoted label keeps case, blanks and commas')
      call read_text('*NSET, NSET="My, Set"'//nl//'"a, b", 3'//nl)
      call get_parameter(deck%block(1), 'NSET', value, at, found)
      call equal_text('value', value, 'My, Set')
      call split_fields(deck%block(1)%line(1), field, n)
      call is_true('two fields', n == 2)
      call equal_text('field', field(1)%text, 'a, b')

      call test('a keyword line that ends with a comma goes on, across comments')
      call read_text('*ELEMENT,'//nl//'** here'//nl//' TYPE=CPE4,'//nl//'ELSET=BODY'//nl// &
         & '1,1,2,3,4')
      call is_true('no error', .not. allocated(error))
      call get_parameter(deck%block(1), 'ELSET', value, at, found)
      call equal_text('value', value, 'BODY')
      call is_true('line', at%line == 4)
      call is_true('one data line', deck%block(1)%nline == 1)

      call test('a comma at the end does not swallow the next keyword')
      call read_text('*HEADING,'//nl//'*NODE'//nl//'1,0.,0.')
      call is_true('two blocks', deck%nblock == 2)
      call is_true('no error', .not. allocated(error))

      call test('blanks inside keywords and parameters do not count')
      call read_text('*RIGIDBODY, REFNODE=9, ANALYTICALSURFACE=P'//nl//'*END  PART')
      call equal_text('keyword', deck%block(1)%keyword, 'RIGID BODY')
      call get_parameter(deck%block(1), 'REF NODE', value, at, found)
      call equal_text('value', value, '9')
   end subroutine keyword_lines

   subroutine comments_and_empty_lines()
      call test('comments and empty lines may stand anywhere')
      call read_text('** first'//nl//'*NODE'//nl//'1,0.,0.'//nl//'   ** inside'//nl//nl//'   '// &
         & nl// &
         & '*********'//nl//'2,1.,0.')
      call is_true('no error', .not. allocated(error))
      call is_true('two data lines', deck%block(1)%nline == 2)
      call is_true('line number', deck%block(1)%line(2)%line == 8)

      call test('comments and titles may be in any alphabet')
      call read_text('** poinçon'//nl//'*HEADING'//nl//'Bande emboutie, poinçon'//nl//'*STEP'// &
         & nl//'étape'//nl// &
         & '*STATIC'//nl//'*END STEP')
      call is_true('no error', .not. allocated(error))
   end subroutine comments_and_empty_lines

   subroutine line_ends()
      character(len=*), parameter :: mark = char(239)//char(187)//char(191)

      call test('CR LF, a byte-order mark, a last line without end, tabs')
      call read_text(mark//'*NODE'//cr//nl//'1,0.,0.'//cr//nl//tab//'2,'//tab//'1.,0.')
      call is_true('no error', .not. allocated(error))
      call equal_text('keyword', deck%block(1)%keyword, 'NODE')
      call is_true('column', deck%block(1)%at%first == 1)
      call equal_text('no CR', deck%block(1)%line(1)%text, '1,0.,0.')
      call split_fields(deck%block(1)%line(2), field, n)
      call equal_text('tab', field(1)%text//'|'//field(2)%text//'|'//field(3)%text, '2|1.|0.')

      call test('an empty deck has no blocks')
      call read_text('')
      call is_true('none', deck%nblock == 0 .and. .not. allocated(error))
   end subroutine line_ends

   subroutine fields()
      type(data_line_type) :: line

      call test('fields: blanks, empty ones, one comma at the end')
      line = data_line_type(1, 7, '  1 , , -2.5 ,')
      call split_fields(line, field, n)
      call is_true('three', n == 3)
      call equal_text('texts', field(1)%text//'|'//field(2)%text//'|'//field(3)%text, '1||-2.5')
      call is_true('place', field(3)%at%line == 7 .and. field(3)%at%first == 9 &
         & .and. field(3)%at%last == 12)
      call is_true('lone comma', count_fields(',') == 1)
      call is_true('blank', count_fields('   ') == 0)
      call is_true('two commas', count_fields('1,,') == 2)
      call is_true('many', count_fields('1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20') == 20)
      line%text = '1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20'
      call split_fields(line, field, n)
      call equal_text('last', field(20)%text, '20')
   end subroutine fields

   subroutine numbers()
      type(data_line_type) :: line
      real(wp) :: value
      integer :: whole
      logical :: found

      call test('an empty field is absent without complaint')
      log = log_type()
      line = data_line_type(1, 1, ', 2.1D5, 7, x, 210000 .3, 1;2')
      call split_fields(line, field, n)
      call field_real(field(1), value, log, found)
      call is_true('absent', .not. found .and. log%n == 0)
      call field_real(field(2), value, log, found)
      call close_to('value', value, 210000.0_wp, 0.0_wp)
      call field_integer(field(3), whole, log, found)
      call is_true('whole', found .and. whole == 7)

      call test('a bad number is complained of with its place and what was meant')
      call field_real(field(4), value, log, found)
      call equal_text('word', log%item(1)%id//' '//log%item(1)%message, 'E0103 `x` is not a number')
      call field_real(field(5), value, log, found)
      call equal_text('label', log%item(2)%label, 'a comma seems to be missing')
      call equal_text('help', log%item(2)%help, 'write `210000, .3`')
      call is_true('place', log%item(2)%at%first == 16 .and. log%item(2)%at%last == 24)
      call field_real(field(6), value, log, found)
      call equal_text('semicolon', log%item(3)%id, 'E0104')
      call field_integer(field(2), whole, log, found)
      call equal_text('integer', log%item(4)%message, '`2.1D5` is not a whole number')
   end subroutine numbers

   subroutine first_spellings()
      character(len=:), allocatable :: value
      type(location_type) :: at
      logical :: found

      call test('aliases, choices and bare parameters come back in their first spelling')
      call read_text('*CONTACT CONTROLS, MAIN=die, SECONDARY=top, INITIAL=adjust'//nl// &
         & '*CONTACT PAIR, INTERACTION=I, ADJUST, type=node TO  surface'//nl//'TOP, DIE')
      call is_true('no error', .not. allocated(error))
      call get_parameter(deck%block(1), 'MASTER', value, at, found)
      call equal_text('main', value, 'die')
      call get_parameter(deck%block(1), 'SLAVE', value, at, found)
      call equal_text('secondary', value, 'top')
      call get_parameter(deck%block(1), 'INITIAL', value, at, found)
      call equal_text('choice', value, 'ADJUST')
      call get_parameter(deck%block(2), 'ADJUST', value, at, found)
      call equal_text('bare', value, 'YES')
      call get_parameter(deck%block(2), 'TYPE', value, at, found)
      call equal_text('blanks', value, 'NODE TO SURFACE')
   end subroutine first_spellings

   subroutine includes()
      call write_file('deck_part.inp', '3, 2., 0.'//nl//'*NSET, NSET=A'//nl//'1, 2'//nl)
      call write_file('deck_whole.inp', '*NODE'//nl//'1,0.,0.'//nl// &
         & '*INCLUDE, INPUT="deck_part.inp"'//nl//'3'//nl)
      call test('an include may begin and end inside the data of a keyword')
      log = log_type()
      call read_deck(deck, 'deck_whole.inp', log, error)
      call is_true('no error', .not. allocated(error))
      call is_true('blocks', deck%nblock == 2)
      call is_true('node lines', deck%block(1)%nline == 2)
      call is_true('set lines', deck%block(2)%nline == 2)
      call is_true('from the include', deck%block(1)%line(2)%file == 2)
      call is_true('from the deck', deck%block(2)%line(2)%file == 1)

      call test('a missing include names the paths tried; reading goes on')
      call write_file('deck_whole.inp', '*INCLUDE, INPUT=nothere.inp'//nl//'*NODA'//nl)
      call read_deck(deck, 'deck_whole.inp', log, error)
      call is_true('two errors', size(error%item) == 2)
      call equal_text('id', error%item(1)%id, 'E0105')
      call equal_text('tried', error%item(1)%note, 'tried: nothere.inp')

      call test('an include loop is found and its chain told')
      call write_file('deck_part.inp', '*INCLUDE, INPUT=deck_whole.inp'//nl)
      call write_file('deck_whole.inp', '*INCLUDE, INPUT=deck_part.inp'//nl)
      log = log_type()
      call read_deck(deck, 'deck_whole.inp', log, error)
      call equal_text('id', error%item(1)%id, 'E0105')
      call is_true('chain', index(render(error%item(1), deck, .false.), &
         & 'note: deck_part.inp is included at deck_whole.inp:1') > 0)

      call test('a deck that is not there is a matter of files')
      log = log_type()
      call read_deck(deck, 'no_such_deck.inp', log, error)
      call is_true('code', error%code == 5)
      call equal_text('id', error%item(1)%id, 'E0100')
   end subroutine includes

   subroutine write_file(name, text)
      character(len=*), intent(in) :: name, text
      integer :: unit
      open (newunit=unit, file=name, access='stream', form='unformatted', status='replace', &
         & action='write')
      write (unit) text
      close (unit)
   end subroutine write_file

   subroutine complaints()
      call test('each mistake has its code and its sentence')
      call says('*FRICTON'//nl, 'E0101', 'unknown keyword *FRICTON')
      call says('*ELAS'//nl, 'E0101', 'unknown keyword *ELAS')
      call says('*STEP, NLGOEM'//nl//'*END STEP', 'E0102', '`NLGOEM` is not a parameter of '// &
         & '*STEP; did you mean '// &
         & 'NLGEOM? Without it the step would be small-strain.')
      call says('*NODE'//nl//'1, 0,5, 1,5', 'E0104', 'decimal comma? *NODE has at most 4 '// &
         & 'fields a line, here are 5')
      call says('*END STEP'//nl, 'E0113', '*END STEP without *STEP')
      call says('*STEP'//nl//'*STATIC', 'E0113', '*STEP is not closed')
      call says('*STEP'//nl//'*NODE'//nl//'*END STEP', 'E0107', '*NODE cannot stand in a step')
      call says('*ELASTIC'//nl//'1.', 'E0107', '*ELASTIC must follow *MATERIAL')
      call says('*ELEMENT', 'E0106', '*ELEMENT needs the parameter TYPE')
      call says('*ELEMENT, TYPE', 'E0106', 'TYPE of *ELEMENT needs a value')
      call says('*STEP, INC=ten'//nl//'*END STEP', 'E0106', '`ten` is not a whole number, '// &
         & 'which INC of *STEP needs')
      call says('*SURFACE, NAME=A, TYPE=FACES', 'E0106', '`FACES` is not a value of TYPE of '// &
         & '*SURFACE')
      call says('*STEP, PERTURBATION'//nl//'*END STEP', 'E0108', &
         & 'PERTURBATION of *STEP is known but not yet there: it comes with a later version')
      call says('*STEP'//nl//'*STATIC, SOLVER=MUMPS'//nl//'*END STEP', 'E0108', &
         & 'SOLVER=MUMPS is known but not yet there: it comes with a later version')
      call says('*CREEP', 'E0108', '*CREEP is known but not yet there: creep comes '// &
         & 'with a later version')
      call says('*NSET, NSET=poinçon'//nl//'1', 'E0109', '`ç` is not a letter of the deck''s '// &
         & 'alphabet')
      call says('1, 2, 3', 'E0110', 'data before any keyword')
      call says('*NSET, NSET="A'//nl//'1', 'E0111', 'a quote is opened but not closed')
      call says('*NODE, NSET=A, NSET=B', 'E0114', 'the parameter `NSET` is given twice')
      call says('*INCLUDE', 'E0105', '*INCLUDE names no file')
      call says('*SURFACE INTERACTION, NAME=I'//nl//'*FRICTION, LAW=TRESKA'//nl//'0.1', 'E0106', &
         & '`TRESKA` is not a value of LAW of *FRICTION')
      call says('*FRICTION'//nl//'0.1', 'E0107', &
         & '*FRICTION must follow *SURFACE INTERACTION or *CHANGE FRICTION')
      call says('*MATERIAL'//nl, 'E0106', '*MATERIAL needs the parameter NAME')
      call says('*MATERIAL, NAME=A'//nl//'3.', 'E0103', '*MATERIAL takes no data lines')

      call says('*', 'E0101', 'a star without a keyword')
      call says('*NODE, NSET=', 'E0106', 'NSET of *NODE needs a value')
      call says('*NODE, =3', 'E0102', '`` is not a parameter of *NODE')
      call says('*NODE, NSET="', 'E0111', 'a quote is opened but not closed')

      call test('twenty errors are enough')
      call read_text(repeat('*NOTHING'//nl, 50))
      call is_true('twenty', size(error%item) == 20)
   end subroutine complaints

   subroutine says(text, id, message)
      character(len=*), intent(in) :: text, id, message

      call read_text(text)
      call is_true('an error for '//text, allocated(error))
      if (.not. allocated(error)) return
      call equal_text('said', error%item(1)%id//' '//error%item(1)%message, id//' '//message)
      call is_true('only one error for '//text, size(error%item) == 1)
   end subroutine says

   subroutine notes()
      call test('harmless cards are noted once, suspicious data are warned of')
      call read_text('*PREPRINT, ECHO=NO'//nl//'*PREPRINT'//nl//'*FILE FORMAT, ASCII'//nl)
      call is_true('no error', .not. allocated(error))
      call is_true('two keywords', log%count_of(severity%note) == 2)
      call read_text('*MATERIAL, NAME=A'//nl//'*ELASTIC'//nl//'210000,0,3')
      call is_true('no error', .not. allocated(error))
      call equal_text('warning', log%item(1)%id//' '//log%item(1)%message, &
         & 'W0104 decimal comma? `210000,0,3` '// &
         & 'reads as E = 210000, Poisson''s ratio = 0, temperature = 3')
      call read_text('*STEP, NLGEOM=NO'//nl//'*STATIC, SOLVER=PARDISO'//nl//'*END STEP')
      call is_true('no error', .not. allocated(error))
      call equal_text('solver', log%item(1)%id, 'N0103')
      call read_text('*SURFACE INTERACTION, NAME=I'//nl//'1.'//nl//'*FRICTION'//nl//'0.'//nl)
      call is_true('mu = 0 is accepted', .not. allocated(error))
   end subroutine notes

   subroutine a_large_deck_is_read_quickly()
      integer, parameter :: nnode = 60000, nelement = 50000
      character(len=:), allocatable :: text
      character(len=64) :: line
      integer :: i, k, length
      real(wp) :: value, total, before, after
      logical :: found

      call test('60 000 nodes and 50 000 elements are read and cut into numbers in less than '// &
         & 'a second')
      allocate (character(len=64*(nnode + nelement) + 64) :: text)
      text(:6) = '*NODE'//nl
      k = 6
      do i = 1, nnode
         write (line, '(i0,3(", ",es14.7))') i, real(i, wp), 0.5_wp, -1.25_wp
         length = len_trim(line)
         text(k + 1:k + length + 1) = line(:length)//nl
         k = k + length + 1
      end do
      text(k + 1:k + 20) = '*ELEMENT, TYPE=C3D4'//nl
      k = k + 20
      do i = 1, nelement
         write (line, '(5(i0,", "))') i, i, i + 1, i + 2, i + 3
         length = len_trim(line)
         text(k + 1:k + length + 1) = line(:length)//nl
         k = k + length + 1
      end do
      call cpu_time(before)
      call read_text(text(:k))
      call cpu_time(after)
      print '("large deck: read in ",f6.3," s")', after - before
      call is_true('no error', .not. allocated(error))
      call is_true('nodes', deck%block(1)%nline == nnode)
      call is_true('elements', deck%block(2)%nline == nelement)
      total = 0.0_wp
      do i = 1, nnode
         call split_fields(deck%block(1)%line(i), field, n)
         do k = 2, n
            call field_real(field(k), value, log, found)
            total = total + value
         end do
      end do
      call cpu_time(after)
      print '("large deck: numbers after ",f6.3," s")', after - before
      call close_to('sum', total, 0.5_wp*nnode*(nnode + 1.0_wp) - 0.75_wp*nnode, 1.0e-12_wp)
      call is_true('quick', after - before < 1.0_wp)
   end subroutine a_large_deck_is_read_quickly
end program test_deck
