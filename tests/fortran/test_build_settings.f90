!> Settings: a row of the keyword table that says `reported` is all that a card needs to be kept.
program test_build_settings
   use lopin_kinds, only : wp
   use lopin_block, only : deck_type
   use lopin_build_settings, only : build_settings
   use lopin_deck, only : read_deck_text
   use lopin_error, only : error_type, log_type
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, number, free_text, reported
   use lopin_settings, only : settings_type
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none
   character(len=1), parameter :: nl = achar(10)
   type(keyword_table_type) :: table
   type(settings_type) :: settings

   call key(table, 'LOPIN', 'M', 'lopin', 'A card of the deck language, reported here.')
   call word(table, 'PATH', 'A word.')
   call number(table, 'TARGET ERROR', '0.01', 'A number.')
   call reported(table)
   ! The keywords are those of the deck language, which checks the deck.
   call key(table, 'HEADING', 'M', 'lopin', 'Prose.')
   call free_text(table)
   call reported(table)
   call key(table, 'STEP', 'M', 'lopin', 'Another that is not reported.')
   call flag(table, 'NLGEOM', 'A flag.')

   call collect('*HEADING'//nl//'Order 4711,'//nl//'second die'//nl// &
      & '*LOPIN, PATH=FINITE, TARGET ERROR=0.05'//nl//'*STEP, NLGEOM'//nl//'*STATIC'//nl// &
      & '*END STEP'//nl)
   call test('parameters and prose are kept as they are written')
   call is_true('three', settings%count_all() == 3)
   call equal_text('prose', settings%text('HEADING'), 'Order 4711, second die')
   call equal_text('a word', settings%text('LOPIN, PATH'), 'FINITE')
   call close_to('a number', settings%number('LOPIN, TARGET ERROR', 1.0_wp), 0.05_wp, 0.0_wp)
   call test('what the deck does not say is a default, or nothing')
   call collect('*LOPIN, PATH=FINITE'//nl)
   call close_to('a default', settings%number('LOPIN, TARGET ERROR', 0.01_wp), 0.01_wp, 0.0_wp)
   call close_to('a word is no number', settings%number('LOPIN, PATH', 7.0_wp), 7.0_wp, 0.0_wp)
   call equal_text('nothing', settings%text('HEADING'), '')
   call collect('*HEADING'//nl//'a'//nl//'*LOPIN, PATH=FINITE'//nl//'*LOPIN, PATH=NEWTON'//nl// &
      & '*HEADING'//nl//'b'//nl)
   call test('of a parameter the last value holds, prose is joined')
   call equal_text('a word', settings%text('LOPIN, PATH'), 'NEWTON')
   call equal_text('prose', settings%text('HEADING'), 'a b')
   call finish()

contains

   subroutine collect(text)
      character(len=*), intent(in) :: text
      type(deck_type) :: deck
      type(log_type) :: log
      type(error_type), allocatable :: error

      call read_deck_text(deck, text, 'settings.inp', '', log, error)
      call is_true('read', .not. allocated(error))
      call build_settings(settings, deck, table)
   end subroutine collect
end program test_build_settings
