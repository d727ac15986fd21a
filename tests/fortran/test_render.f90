!> Diagnostics as text: the exact form, in the terminal and as JSON.
program test_render
   use lopin_error, only : diagnostic_type, error_type, log_type, location_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_render, only : render, render_json, json_string
   use check, only : test, is_true, equal_text, finish
   implicit none

   character(len=1), parameter :: nl = achar(10)
   type(deck_type) :: deck
   type(log_type) :: log
   type(error_type), allocatable :: error
   type(diagnostic_type) :: item

   call test('a misspelt keyword is shown with its line, a caret, the reason and the cure')
   call read_deck_text(deck, repeat('**'//nl, 137)//'*SURFACE INTERACTION, NAME=GREASE'//nl// &
      & repeat('**'//nl, 3)//'*FRICTON, TAUMAX=120.'//nl, 'decks/strip.inp', '', log, error)
   call equal_text('text', render(error%item(1), deck, .false.), &
      & 'error[E0101]: unknown keyword *FRICTON'//nl// &
      & '  --> decks/strip.inp:142:1'//nl// &
      & '    |'//nl// &
      & '142 | *FRICTON, TAUMAX=120.'//nl// &
      & '    | ^^^^^^^^ did you mean *FRICTION ?'//nl// &
      & '    = note: it follows *SURFACE INTERACTION, NAME=GREASE (line 138), where *FRICTION '// &
      & 'is expected'//nl// &
      & '    = help: lopin doc ''*FRICTION'''//nl)
   call is_true('colour changes the head and the caret', index(render(error%item(1), deck, &
      & .true.), &
      & achar(27)//'[1;31merror[E0101]'//achar(27)//'[0m: unknown') == 1)

   call test('columns count letters, not bytes')
   log = log_type()
   call read_deck_text(deck, '*HEADING'//nl//'été'//nl//'*NSET, NSET=poinçon'//nl//'1'//nl, &
      & 'a.inp', '', log, error)
   call equal_text('text', render(error%item(1), deck, .false.), &
      & 'error[E0109]: `ç` is not a letter of the deck''s alphabet'//nl// &
      & ' --> a.inp:3:17'//nl//'   |'//nl// &
      & ' 3 | *NSET, NSET=poinçon'//nl// &
      & '   |                 ^ not 7-bit ASCII'//nl// &
      & '   = help: accents and other alphabets may stand in comments and titles'//nl)

   call test('without a place only the sentence and the cure are shown; further lines are indented')
   item = diagnostic_type(1, 'W0311', 'open', location_type(), '', 'one'//nl//'two', 'do this')
   call equal_text('text', render(item, deck, .false.), 'warning[W0311]: open'//nl// &
      & '   = note: one'//nl//'           two'//nl//'   = help: do this'//nl)

   call test('a place without columns shows the line without a caret')
   item = diagnostic_type(0, 'N0001', 'here', location_type(1, 4), '', '', '')
   call equal_text('text', render(item, deck, .false.), 'note[N0001]: here'//nl// &
      & ' --> a.inp:4'//nl//'   |'//nl//' 4 | 1'//nl)

   call test('JSON: one object, quotes and control characters escaped')
   call equal_text('string', json_string('a"b\c'//nl//achar(9)//'é'), '"a\"b\\c\n\u0009é"')
   call equal_text('object', render_json(item, deck), '{"severity": "note", "code": "N0001", '// &
      & '"message": "here", '// &
      & '"file": "a.inp", "line": 4, "column": 0, "end_column": 0, "label": "", "note": "", '// &
      & '"help": ""}')
   call finish()
end program test_render
