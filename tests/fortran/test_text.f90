!> Words and numbers as text.
program test_text
   use lopin_kinds, only : wp
   use lopin_text, only : upper, lower, squeeze, without_blanks, parse_real, parse_integer, &
      & edit_distance, nearest_word, to_text, join
   use lopin_plural, only : plural, plural_of
   use check, only : test, is_true, equal_text, finish
   implicit none

   call test('case changes letters of the alphabet only')
   call equal_text('upper', upper('Élan a1-z'), 'ÉLAN A1-Z')
   call equal_text('lower', lower('CPE4 X_'), 'cpe4 x_')

   call test('runs of blanks and tabs become one blank')
   call equal_text('squeeze', squeeze('  end '//achar(9)//'  step  '), 'end step')
   call equal_text('squeeze of blanks', squeeze('   '), '')
   call equal_text('without', without_blanks(' ref node '), 'refnode')

   call test('reals are read in every spelling of a deck')
   call reads('1', 1.0_wp)
   call reads('1.', 1.0_wp)
   call reads(' .5', 0.5_wp)
   call reads('-2.5e-3 ', -2.5e-3_wp)
   call reads('1E3', 1000.0_wp)
   call reads('2.1D5', 210000.0_wp)
   call reads('+1.e+05', 1.0e5_wp)
   call reads('1-3', 1.0e-3_wp)
   call reads('0.1', 0.1_wp)
   call reads('3.14159265358979323846', 3.14159265358979323846_wp)
   call reads('1.7976931348623157e307', 1.7976931348623157e307_wp)
   call reads('0e999', 0.0_wp)
   call reads('4.9406564584124654e-312', 4.9406564584124654e-312_wp)
   call reads('0.30000000000000004', 0.30000000000000004_wp)

   call test('what is not a real is refused')
   call refuses('')
   call refuses('.')
   call refuses('1e')
   call refuses('1.2.3')
   call refuses('210000 .3')
   call refuses('1;2')
   call refuses('nan')
   call refuses('inf')
   call refuses('1e999')
   call refuses('abc')

   call test('integers')
   call reads_integer('42', 42, .true.)
   call reads_integer(' -7 ', -7, .true.)
   call reads_integer('2147483647', 2147483647, .true.)
   call reads_integer('2147483648', 0, .false.)
   call reads_integer('3.', 0, .false.)
   call reads_integer('', 0, .false.)

   call test('one swap, one missing, one wrong letter are one step apart')
   call is_true('swap', edit_distance('NLGOEM', 'NLGEOM') == 1)
   call is_true('missing', edit_distance('FRICTON', 'FRICTION') == 1)
   call is_true('wrong', edit_distance('NODA', 'NODE') == 1)
   call is_true('all', edit_distance('', 'NODE') == 4)

   call test('the word that was meant, or none')
   call equal_text('friction', nearest_word('fricton', [character(len=10) :: 'SECTION', &
      & 'FRICTION']), 'FRICTION')
   call equal_text('abbreviation', nearest_word('ELAS', [character(len=10) :: 'NODE', 'ELASTIC']), &
      & 'ELASTIC')
   call equal_text('none', nearest_word('XYZ', [character(len=10) :: 'NODE', 'ELASTIC']), '')
   call equal_text('only the first', nearest_word('NODA', [character(len=10) :: 'SET', 'NODE'], &
      & 1), '')

   call test('numbers are written short and read back')
   call equal_text('integer', to_text(-12), '-12')
   call equal_text('tenth', to_text(0.1_wp), '0.1')
   call equal_text('third', to_text(1.0_wp/3.0_wp, 3), '0.333')
   call equal_text('large', to_text(210000.0_wp), '210000')
   call equal_text('small', to_text(-7.8e-9_wp), '-7.8e-9')
   call equal_text('zero', to_text(0.0_wp), '0')
   call equal_text('mixed', to_text(123.456_wp), '123.456')
   call equal_text('small fraction', to_text(0.00125_wp), '0.00125')

   call test('lists')
   call equal_text('join', join([character(len=3) :: 'a', 'bb', 'c']), 'a, bb, c')
   call equal_text('join two', join([character(len=3) :: 'a', 'bb', 'c'], ' ', 2), 'a bb ...')
   call equal_text('one', plural(1, 'node'), '1 node')
   call equal_text('two', plural(2, 'node'), '2 nodes')
   call equal_text('the noun', plural_of('set of spring elements'), 'sets of spring elements')
   call equal_text('several', plural_of('section controls'), 'section controls')
   call finish()

contains

   subroutine reads(text, expected)
      character(len=*), intent(in) :: text
      real(wp), intent(in) :: expected
      real(wp) :: value
      logical :: ok

      call parse_real(text, value, ok)
      call is_true(text//' is read', ok)
      call is_true(text//' is exact', abs(value - expected) <= 0.0_wp)
   end subroutine reads

   subroutine refuses(text)
      character(len=*), intent(in) :: text
      real(wp) :: value
      logical :: ok

      call parse_real(text, value, ok)
      call is_true(text//' is refused', .not. ok)
   end subroutine refuses

   subroutine reads_integer(text, expected, expected_ok)
      character(len=*), intent(in) :: text
      integer, intent(in) :: expected
      logical, intent(in) :: expected_ok
      integer :: value
      logical :: ok

      call parse_integer(text, value, ok)
      call is_true(text, (ok .eqv. expected_ok) .and. value == expected)
   end subroutine reads_integer
end program test_text
