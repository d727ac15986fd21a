!> What a deck may say: the whole table, and its sheets for the terminal and the manual.
module lopin_keywords
   use lopin_keyword_rows_contact, only : add_contact_rows
   use lopin_keyword_rows_flow, only : add_flow_rows
   use lopin_keyword_rows_friction, only : add_friction_rows
   use lopin_keyword_rows_model, only : add_model_rows
   use lopin_keyword_rows_other, only : add_other_rows
   use lopin_keyword_rows_step, only : add_step_rows
   use lopin_keyword_table, only : keyword_table_type, keyword_type, keyword_parameter_type, &
      & keyword_field_type, status_of, find_keyword, suggest_keyword
   use lopin_text, only : squeeze
   use lopin_word_list, only : list_item, list_size
   implicit none
   private
   public :: new_keyword_table, keyword_sheet, keyword_manual

   character(len=1), parameter :: nl = achar(10)

contains

   !> The whole table.
   subroutine new_keyword_table(table)
      type(keyword_table_type), intent(out) :: table

      call add_model_rows(table)
      call add_contact_rows(table)
      call add_friction_rows(table)
      call add_flow_rows(table)
      call add_step_rows(table)
      call add_other_rows(table)
   end subroutine new_keyword_table

   !> The sheet of one keyword as plain text.
   subroutine keyword_sheet(word, text, found)
      character(len=*), intent(in) :: word                 !! any case, with or without its star
      character(len=:), allocatable, intent(out) :: text   !! the sheet, or what was probably meant
      logical, intent(out) :: found
      type(keyword_table_type) :: table
      character(len=:), allocatable :: name, meant
      integer :: row

      call new_keyword_table(table)
      row = find_keyword(table, word)
      found = row > 0
      if (found) then
         text = sheet(table%row(row), .false.)
         return
      end if
      name = squeeze(word)
      if (index(name, '*') == 1) name = squeeze(name(2:))
      meant = suggest_keyword(table, name)
      text = 'no keyword *'//name
      if (len(meant) > 0) text = text//'; did you mean *'//meant//' ?'
   end subroutine keyword_sheet

   !> The reference manual of all keywords in Markdown.
   function keyword_manual() result(text)
      character(len=:), allocatable :: text
      type(keyword_table_type) :: table
      integer :: i

      call new_keyword_table(table)
      text = '# Keywords'//nl//nl// &
         & 'Written by `lopin doc --all` from the table that also checks every deck.'//nl//nl// &
         & 'Keywords, parameters and labels may be in upper or lower case; blanks do not '// &
         & 'count. A line that'//nl// &
         & 'begins with `**` is a comment. MAIN and SECONDARY may be written for MASTER and '// &
         & 'SLAVE.'//nl
      do i = 1, table%n
         if (table%row(i)%status == status_of%supported) text = text//nl//sheet(table%row(i), &
            & .true.)
      end do
      text = text//nl//'## Read past, with a note'//nl//nl//'| keyword | what it is |'//nl// &
         & '| --- | --- |'//nl
      do i = 1, table%n
         if (table%row(i)%status == status_of%ignored) text = text//'| `*'//table%row(i)%name// &
            & '` | '// &
            & table%row(i)%sentence//' |'//nl
      end do
      text = text//nl//'## Known, refused until it exists'//nl//nl//'| keyword | for |'//nl// &
         & '| --- | --- |'//nl
      do i = 1, table%n
         if (table%row(i)%status == status_of%later) text = text//'| `*'//table%row(i)%name// &
            & '` | '// &
            & table%row(i)%sentence//' |'//nl
      end do
   end function keyword_manual

   function sheet(row, markdown) result(text)
      type(keyword_type), intent(in) :: row
      logical, intent(in) :: markdown
      character(len=:), allocatable :: text
      integer :: i

      text = '*'//row%name//nl//nl
      if (markdown) text = '## `*'//row%name//'`'//nl//nl
      if (row%status == status_of%later) then
         text = text//'Known but not yet there: for '//row%sentence//'.'//nl
         return
      end if
      text = text//row%sentence//nl
      if (row%status == status_of%ignored) text = text//'Accepted and read past, with a note.'//nl
      text = text//nl//place(row)//nl
      if (size(row%parameter) > 0) text = text//nl//'Parameters:'//nl//nl
      do i = 1, size(row%parameter)
         text = text//parameter_line(row%parameter(i), markdown)
      end do
      if (size(row%data) > 0) text = text//nl//'Data lines:'//nl//nl
      do i = 1, size(row%data)
         associate (data => row%data(i))
            text = text//fence('  ', '- `', markdown)//field_line(data%field, data%is_list)// &
               & fence(nl//'      ', '`: ', markdown)//data%sentence//nl
         end associate
      end do
      if (len(row%example) == 0) return
      text = text//nl//'Example:'//nl//nl//fence('', '```'//nl, markdown)
      do i = 1, example_size(row%example)
         text = text//fence('  ', '', markdown)//example_line(row%example, i)//nl
      end do
      text = text//fence('', '```'//nl, markdown)
   end function sheet

   !> Where the keyword may stand and who else knows it.
   function place(row) result(text)
      type(keyword_type), intent(in) :: row
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      if (index(row%levels, 'M') > 0) text = text//', model'
      if (index(row%levels, 'P') > 0) text = text//', part'
      if (index(row%levels, 'A') > 0) text = text//', assembly'
      if (index(row%levels, 'S') > 0) text = text//', step'
      text = 'Place: '//text(3:)
      do i = 1, list_size(row%parents)
         if (i == 1) text = text//', after *'//list_item(row%parents, 1)
         if (i > 1) text = text//' or *'//list_item(row%parents, i)
      end do
      text = text//'. Origin: '
      select case (row%origin)
      case ('both')
         text = text//'Abaqus and CalculiX.'
      case ('abaqus')
         text = text//'Abaqus.'
      case ('calculix')
         text = text//'CalculiX.'
      case default
         text = text//'Lopin.'
      end select
      if (len(row%lecture) > 0) text = text//' Lecture: '//row%lecture//'.'
   end function place

   function parameter_line(parameter, markdown) result(text)
      type(keyword_parameter_type), intent(in) :: parameter
      logical, intent(in) :: markdown
      character(len=:), allocatable :: text
      integer :: i

      text = parameter%name
      if (parameter%kind == 'choice') then
         text = text//'='//list_item(parameter%choices, 1)
         do i = 2, list_size(parameter%choices)
            text = text//' | '//list_item(parameter%choices, i)
         end do
      else if (parameter%kind /= 'flag' .and. parameter%status == status_of%supported) then
         text = text//'='//'<'//parameter%kind//'>'
      end if
      text = fence('  ', '- `', markdown)//text//fence(nl//'      ', '`: ', markdown)// &
         & parameter%sentence
      if (parameter%is_required) text = text//' Required.'
      if (len(parameter%default) > 0) text = text//' Default: '//parameter%default//'.'
      if (len(parameter%aliases) > 0) text = text//' Also: '//parameter%aliases//'.'
      if (len(parameter%refused) > 0) text = text//' Not yet: '//spaced(parameter%refused)//'.'
      if (len(parameter%replaced) > 0) text = text//' Read as the default: '// &
         & spaced(parameter%replaced)//'.'
      if (len(parameter%misspelt) > 0) text = text//' Respelt: '//spaced(parameter%misspelt)//'.'
      if (parameter%status == status_of%ignored) text = text//' Read past, with a note.'
      if (parameter%status == status_of%later) text = text//' Not yet.'
      text = text//nl
   end function parameter_line

   function field_line(field, is_list) result(text)
      type(keyword_field_type), intent(in) :: field(:)
      logical, intent(in) :: is_list
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(field)
         if (i > 1) text = text//', '
         text = text//field(i)%name
         if (len(field(i)%unit) > 0) text = text//' '//field(i)%unit
         if (len(field(i)%default) > 0) text = text//' = '//field(i)%default
      end do
      if (is_list) text = text//', ...'
   end function field_line

   !> One of two decorations.
   pure function fence(plain, marked, markdown) result(text)
      character(len=*), intent(in) :: plain, marked
      logical, intent(in) :: markdown
      character(len=:), allocatable :: text

      text = plain
      if (markdown) text = marked
   end function fence

   pure function spaced(list) result(text)
      character(len=*), intent(in) :: list
      character(len=:), allocatable :: text
      integer :: i

      text = list_item(list, 1)
      do i = 2, list_size(list)
         text = text//', '//list_item(list, i)
      end do
   end function spaced

   pure integer function example_size(lines)
      character(len=*), intent(in) :: lines
      integer :: i

      example_size = 1
      do i = 1, len(lines)
         if (lines(i:i) == '|') example_size = example_size + 1
      end do
   end function example_size

   !> The i-th line of an example.
   pure function example_line(lines, number) result(line)
      character(len=*), intent(in) :: lines
      integer, intent(in) :: number
      character(len=:), allocatable :: line
      integer :: first, bar, i

      first = 1
      do i = 1, number
         bar = index(lines(first:), '|')
         if (bar == 0) bar = len(lines) - first + 2
         line = lines(first:first + bar - 2)
         first = first + bar
      end do
   end function example_line
end module lopin_keywords
