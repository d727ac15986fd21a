!> The keyword table is complete and consistent, and its examples and foreign decks are read.
program test_keywords
   use lopin_error, only : error_type, log_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_keyword_table, only : keyword_table_type, status_of, find_keyword
   use lopin_keywords, only : new_keyword_table, keyword_sheet, keyword_manual
   use lopin_word_list, only : in_list, list_item, list_size
   use check, only : test, is_true, equal_text, finish
   implicit none

   character(len=1), parameter :: nl = achar(10)
   type(keyword_table_type) :: table

   call new_keyword_table(table)
   call names_are_unique()
   call rows_are_complete()
   call examples_are_read()
   call sheets()
   call lists()
   call decks_of_other_programs()
   call refused_words()
   call finish()

contains

   subroutine names_are_unique()
      integer :: i, k

      call test('every keyword and every parameter stands once')
      do i = 1, table%n
         call is_true(table%row(i)%name, find_keyword(table, table%row(i)%name) == i)
         do k = 2, size(table%row(i)%parameter)
            call is_true(table%row(i)%name//', '//table%row(i)%parameter(k)%name, &
               & count_of_parameter(i, table%row(i)%parameter(k)%name) == 1)
         end do
      end do
   end subroutine names_are_unique

   integer function count_of_parameter(row, name) result(number)
      integer, intent(in) :: row
      character(len=*), intent(in) :: name
      integer :: k

      number = 0
      do k = 1, size(table%row(row)%parameter)
         if (table%row(row)%parameter(k)%name == name) number = number + 1
      end do
   end function count_of_parameter

   subroutine rows_are_complete()
      integer :: i, k

      call test('supported keywords have a sentence, an example and parents that exist')
      do i = 1, table%n
         associate (row => table%row(i))
            call is_true(row%name//': sentence', len(row%sentence) > 0)
            call is_true(row%name//': levels', verify(row%levels, 'MPAS') == 0)
            call is_true(row%name//': origin', in_list('abaqus,calculix,both,lopin', row%origin))
            if (row%status /= status_of%supported) cycle
            call is_true(row%name//': example', index(row%example, '*'//row%name) > 0)
            do k = 1, list_size(row%parents)
               call is_true(row%name//': parent', find_keyword(table, list_item(row%parents, &
                  & k)) > 0)
            end do
            do k = 1, size(row%parameter)
               associate (parameter => row%parameter(k))
                  call is_true(row%name//', '//parameter%name, len(parameter%sentence) > 0)
                  if (parameter%kind /= 'choice' .or. len(parameter%default) == 0) cycle
                  call is_true(row%name//', '//parameter%name//': default is a choice', &
                     & in_list(parameter%choices, parameter%default))
               end associate
            end do
         end associate
      end do
   end subroutine rows_are_complete

   subroutine examples_are_read()
      character(len=:), allocatable :: text
      integer :: i

      call test('the example of every keyword is read without error')
      do i = 1, table%n
         associate (row => table%row(i))
            if (row%status /= status_of%supported .or. row%name == 'INCLUDE') cycle
            text = lines_of(row%example)
            if (row%levels == 'S' .and. index(text, '*STEP') == 0) text = '*STEP'//nl//text// &
               & '*END STEP'//nl
            call accepts(text)
         end associate
      end do
   end subroutine examples_are_read

   !> An example has a bar between its lines.
   function lines_of(example) result(text)
      character(len=*), intent(in) :: example
      character(len=:), allocatable :: text
      integer :: i

      text = example//nl
      do i = 1, len(text)
         if (text(i:i) == '|') text(i:i) = nl
      end do
   end function lines_of

   subroutine accepts(text)
      character(len=*), intent(in) :: text
      type(deck_type) :: deck
      type(log_type) :: log
      type(error_type), allocatable :: error

      call read_deck_text(deck, text, 'deck.inp', '', log, error)
      if (allocated(error)) then
         call is_true(text//' gives '//error%text(), .false.)
      else
         call is_true('read', .true.)
      end if
   end subroutine accepts

   subroutine sheets()
      character(len=:), allocatable :: text
      logical :: found

      call test('a sheet says what a keyword is, takes and looks like')
      call keyword_sheet('*Friction', text, found)
      call is_true('found', found)
      call is_true('head', index(text, '*FRICTION'//nl) == 1)
      call is_true('place', index(text, 'after *SURFACE INTERACTION or *CHANGE FRICTION') > 0)
      call is_true('unit', index(text, 'mu = 0, stick slope [stress/length]') > 0)
      call keyword_sheet('FRICTON', text, found)
      call equal_text('meant', text, 'no keyword *FRICTON; did you mean *FRICTION ?')
      call keyword_sheet('*CREEP', text, found)
      call is_true('later', index(text, 'not yet there: for creep') > 0)

      call test('the manual holds every keyword')
      text = keyword_manual()
      call is_true('first', index(text, '## `*HEADING`') > 0)
      call is_true('later', index(text, '| `*CREEP` |') > 0)
   end subroutine sheets

   subroutine lists()
      call test('lists of words')
      call is_true('size', list_size('A,B C,D') == 3 .and. list_size('') == 0)
      call equal_text('item', list_item('A,B C,D', 2), 'B C')
      call equal_text('last', list_item('A,B C,D', 3), 'D')
      call is_true('in', in_list('A,B C,D', 'bc') .and. .not. in_list('A,B C,D', 'B'))
   end subroutine lists

   subroutine decks_of_other_programs()
      call test('what FreeCAD writes')
      call accepts(lines_of('*HEADING|written by FreeCAD|*NODE, NSET=Nall|1, 0, 0, 0|'// &
         & '*MATERIAL, NAME=Steel|*ELASTIC|210000,0.300|*DENSITY|7.9E-09|*EXPANSION, '// &
         & 'ZERO=293.15|'// &
         & '1.2e-05|*SOLID SECTION, ELSET=E, MATERIAL=Steel|*PHYSICAL CONSTANTS, ABSOLUTE '// &
         & 'ZERO=0|'// &
         & '*SURFACE, NAME=DEPc, TYPE=ELEMENT|1,S1|*SURFACE, NAME=INDc|2,S2|'// &
         & '*CONTACT PAIR, INTERACTION=INTc, TYPE=SURFACE TO SURFACE, ADJUST=0.1|DEPc,INDc|'// &
         & '*SURFACE INTERACTION, NAME=INTc|*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR|1e6|'// &
         & '*FRICTION|0, 100|*RIGID BODY, NSET=R, REF NODE=9, ROT NODE=10|'// &
         & '*STEP, INC=2000|*STATIC, SOLVER=PASTIX|0.1, 1.0|*CONTROLS, '// &
         & 'PARAMETERS=FIELD|0.005,,,|'// &
         & '*BOUNDARY|F,1|*NODE FILE|U|*EL FILE|S, E|*CONTACT FILE|CDIS, CSTR|'// &
         & '*NODE PRINT, NSET=F, TOTALS=ONLY|RF|*OUTPUT, FREQUENCY=1|*END STEP'))

      call test('what PrePoMax writes')
      call accepts(lines_of('*Heading|Hash: f0, Date: 1|*Node|1, 0, 0, 0|'// &
         & '*Surface, Name=S, Type=Element|Internal_Selection-1_S_S1, S1|*Material, '// &
         & 'Name=M|*Density|'// &
         & '7.8E-09|*Elastic|210000, 0.28, 0|*Solid section, Elset=E, Material=M|'// &
         & '*Surface interaction, Name=I|*Surface behavior, Pressure-overclosure=Hard|'// &
         & '*Contact pair, Interaction=I, Type=Node to surface, Small sliding, Adjust=0|S, T|'// &
         & '*Step, Inc=100|*Static, Solver=Pardiso, Direct|0.1, 1, 1E-05, 1E+30|*Output, '// &
         & 'Frequency=1|'// &
         & '*Boundary, op=New|*Cload, op=New|*Dload, op=New|*Node file|RF, U|*El file|S, E, '// &
         & 'NOE|'// &
         & '*Contact file|CDIS, CSTR|*Contact print, Master=T, Slave=S, Totals=Yes|CF|*End step'))

      call test('what Abaqus/CAE writes')
      call accepts(lines_of('*Heading|** Job name: a|*Preprint, echo=NO, model=NO|*Part, '// &
         & 'name=P|*Node|'// &
         & '      1,           0.,           0.|*Element, type=CPE4R|1, 1, 2, 3, 4|'// &
         & '*Nset, nset=Set-1, generate|1,  4,  1|*Elset, elset=Set-1|1,|'// &
         & '** Section: S|*Solid Section, elset=Set-1, controls=EC-1, material=M|,|*End Part|'// &
         & '*Assembly, name=Assembly|*Instance, name=P-1, part=P|1., 0., 0.|*End '// &
         & 'Instance|*Node|'// &
         & '1, 0., 0., 0.|*Nset, nset=_RP, internal|1,|*Elset, elset=_S_S1, internal, '// &
         & 'instance=P-1|1,|'// &
         & '*Surface, type=ELEMENT, name=S|_S_S1, S1|*Surface, type=SEGMENTS, name=T|START, '// &
         & '0., 0.|'// &
         & 'LINE, 1., 0.|*Rigid Body, ref node=_RP, analytical surface=T|*End Assembly|'// &
         & '*Section Controls, name=EC-1, hourglass=ENHANCED|1., 1., 1.|*Material, '// &
         & 'name=M|*Elastic|'// &
         & '210000., 0.3|*Surface Interaction, name=I|1.,|*Friction|0.,|'// &
         & '*Surface Behavior, pressure-overclosure=HARD|*Boundary|_RP, ENCASTRE|'// &
         & '*Contact Pair, interaction=I, type=SURFACE TO SURFACE, no Thickness|S, T|'// &
         & '*Step, name=Step-1, nlgeom=NO|*Static|0.1, 1., 1e-05, 1.|*Dsload|S, P, 1.|'// &
         & '*Restart, write, frequency=0|*Output, field, variable=PRESELECT|'// &
         & '*Output, history|*Node Output, nset=_RP|RF1, RF2|*Element Output, '// &
         & 'directions=YES|S,|'// &
         & '*End Step'))

      call test('a mesh of gmsh, a set of CGX without its keyword')
      call accepts(lines_of('*Heading| a.inp|*NODE|1, 0, 0, 0|******* E L E M E N T S '// &
         & '*************|'// &
         & '*ELEMENT, type=CPS4, ELSET=Surface1|1, 1, 2, 3, 4|*ELSET,ELSET=body|1,|'// &
         & '*NSET,NSET=Ntop |1, |2, '))

      call test('what is read past parts no card from those under it')
      call accepts(lines_of('*MATERIAL, NAME=M|*CONDUCTIVITY|50.|*ELASTIC|210000., 0.3|'// &
         & '*SURFACE INTERACTION, NAME=I|*CONTROLS, PARAMETERS=CONTACT|0.1|*FRICTION|0.1|*STEP|'// &
         & '*STATIC|*OUTPUT, HISTORY|*ENERGY OUTPUT|ALLSE|*CONTACT OUTPUT, SLAVE=S, MASTER=T|'// &
         & 'CFN|*END STEP'))
   end subroutine decks_of_other_programs

   subroutine refused_words()
      call test('values that are not there yet are refused by name')
      call refuses('*MATERIAL, NAME=M|*ELASTIC, TYPE=ORTHO|1., 1., 1.', 'TYPE=ORTHO')
      call refuses('*MATERIAL, NAME=M|*ELASTIC, TYPE=ENGINEERING CONSTANTS|1., 1., 1.', &
         & 'TYPE=ENGINEERING CONSTANTS')
      call refuses('*MATERIAL, NAME=M|*ELASTIC|1., 0.|*PLASTIC, HARDENING=JOHNSON COOK|1.', &
         & 'HARDENING=JOHNSON COOK')
      call refuses('*AMPLITUDE, NAME=A, DEFINITION=SMOOTH STEP|0., 0., 1., 1.', &
         & 'DEFINITION=SMOOTH STEP')
   end subroutine refused_words

   subroutine refuses(lines, what)
      character(len=*), intent(in) :: lines, what
      type(deck_type) :: deck
      type(log_type) :: log
      type(error_type), allocatable :: error

      call read_deck_text(deck, lines_of(lines), 'deck.inp', '', log, error)
      call is_true(what, allocated(error))
      if (.not. allocated(error)) return
      call is_true(what//' is named in '//error%text(), &
         & index(error%text(), what//' is known but not yet') > 0)
   end subroutine refuses
end program test_keywords
