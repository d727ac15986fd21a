!> Text of a user on terminals, in XML, CSV and JSON; names of parts of an output.
program test_safe_text
   use lopin_safe_text, only : printable, json_text, xml_text, xml_meaning, csv_field
   use lopin_part_names, only : part_name_type, name_parts
   use check, only : test, is_true, equal_text, finish
   implicit none

   character(len=*), parameter :: escape = achar(27), delete = achar(127)
   character(len=*), parameter :: e_acute = char(195)//char(169)           ! U+00E9
   character(len=*), parameter :: next_line = char(194)//char(133)         ! U+0085
   character(len=*), parameter :: turned = char(226)//char(128)//char(174) ! U+202E

   call terminals()
   call json()
   call tables()
   call parts()
   call finish()

contains

   subroutine terminals()
      call test('a terminal gets letters, blanks and line ends')
      call equal_text('plain', printable('plain'//achar(10)//'text'), 'plain'//achar(10)//'text')
      call equal_text('controls', printable('a'//escape//'[31m'//achar(9)//delete), 'a?[31m ?')
      call equal_text('letters', printable(e_acute), e_acute)
      call equal_text('one mark a letter', printable(next_line//'x'//turned//'y'), '?x?y')
      call equal_text('not UTF-8', printable(char(233)//'t'//char(195)), '?t?')
      call equal_text('longer than need be', printable(char(192)//char(155)), '??')
      call equal_text('nothing', printable(''), '')
   end subroutine terminals

   subroutine json()
      call test('JSON has numbers for what commands a terminal')
      call equal_text('quotes', json_text('a"b\c'//achar(10)), 'a\"b\\c\n')
      call equal_text('controls', json_text(escape//delete//next_line//turned), &
         & '\u001b\u007f\u0085\u202e')
      call equal_text('letters', json_text(e_acute//char(233)), e_acute//'?')
   end subroutine json

   subroutine tables()
      character(len=*), parameter :: name = 'a&b<c>"d" &amp;'
      call test('XML gives back what it was given; CSV has quotes where it needs them')
      call equal_text('XML', xml_text('a&<>"'), 'a&amp;&lt;&gt;&quot;')
      call equal_text('back', xml_meaning(xml_text(name)), name)
      call equal_text('plain', csv_field('TOP-BALL.area [length^2]'), 'TOP-BALL.area [length^2]')
      call equal_text('comma', csv_field('a,b'), '"a,b"')
      call equal_text('quote', csv_field('a"b'), '"a""b"')
   end subroutine tables

   subroutine parts()
      type(part_name_type) :: part(5)
      integer :: i

      call test('two names that fold to one word get two words, equal names two names')
      part(1)%name = 'A B'
      part(2)%name = 'A_B'
      part(3)%name = 'a+b'
      part(4)%name = 'A B'
      part(5)%name = repeat('long', 100)
      call name_parts(part)
      call equal_text('first', part(1)%word, 'A_B')
      call equal_text('second', part(2)%word, 'A_B-2')
      call equal_text('disks without small letters', part(3)%word, 'a_b-3')
      call equal_text('fourth', part(4)%word, 'A_B-4')
      call equal_text('its name', part(4)%name, 'A B-2')
      call is_true('room for the rest', len(part(5)%word) <= 80)
      do i = 1, 3
         call is_true('names stay', len(part(i)%name) == 3)
      end do
   end subroutine parts
end program test_safe_text
