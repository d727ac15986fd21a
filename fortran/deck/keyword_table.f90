!> The keyword table: what a deck may say, as data.
!>
!> A row is written by `key` and completed by the calls that follow it, which act on the last
!> keyword
!> (`data_line`, `example`, `under`) or on its last parameter (`required`, `known_as`, `refuses`).
!> Validation, defaults, `lopin doc`, the manual and the suggestions all read this one table.
module lopin_keyword_table
   use lopin_text, only : upper, without_blanks, nearest_word
   use lopin_word_list, only : in_list, list_item, list_size
   implicit none
   private
   public :: keyword_type, keyword_parameter_type, keyword_field_type, keyword_table_type
   public :: status_of, key, flag, word, number, whole, choice, ignored_flag, later_flag
   public :: bare_value, required, known_as, refuses, replaces, respells, missing_means, &
      & data_line, free_text, reported
   public :: example, under, about, find_keyword, find_parameter, suggest_keyword, suggest_parameter

   type :: statuses
      integer :: supported = 1   !! does what it says
      integer :: ignored = 2     !! accepted, does nothing; one note
      integer :: later = 3       !! known but not yet there: refused by name
   end type statuses
   type(statuses), parameter :: status_of = statuses()

   type :: keyword_parameter_type
      character(len=:), allocatable :: name
      character(len=:), allocatable :: kind        !! flag, text, number, whole number, choice
      character(len=:), allocatable :: choices     !! allowed values, separated by commas
      character(len=:), allocatable :: refused     !! values known but not yet there
      character(len=:), allocatable :: replaced    !! values of other codes, read as the default
      character(len=:), allocatable :: misspelt    !! of the lecture, `AS IT IS=AS IT SHOULD BE`
      character(len=:), allocatable :: default     !! value when absent; '' if none
      character(len=:), allocatable :: bare        !! value when written without; '': needs one
      character(len=:), allocatable :: aliases     !! other spellings, separated by commas
      character(len=:), allocatable :: sentence
      character(len=:), allocatable :: missing     !! what a misspelling would silently have done
      logical :: is_required = .false.
      integer :: status = 1
   end type keyword_parameter_type

   type :: keyword_field_type
      character(len=:), allocatable :: name
      character(len=:), allocatable :: unit        !! [length], [stress] ...; '' for words
      character(len=:), allocatable :: default
   end type keyword_field_type

   !> One form that a data line may have.
   type :: keyword_data_type
      type(keyword_field_type), allocatable :: field(:)
      logical :: is_list = .false.                 !! the last field may be repeated without limit
      character(len=:), allocatable :: condition   !! `PARAMETER=VALUE` that it goes with; '': any
      character(len=:), allocatable :: sentence
   end type keyword_data_type

   type :: keyword_type
      character(len=:), allocatable :: name
      character(len=:), allocatable :: levels      !! letters: M model, P part, A assembly, S step
      character(len=:), allocatable :: origin      !! abaqus, calculix, both, lopin
      integer :: status = 1
      character(len=:), allocatable :: sentence
      character(len=:), allocatable :: parents     !! keywords that it must follow
      character(len=:), allocatable :: lecture     !! section of the lecture
      character(len=:), allocatable :: example     !! lines separated by |
      logical :: is_free_text = .false.            !! its data lines are prose
      logical :: is_reported = .false.             !! what it says is a setting of the model
      type(keyword_parameter_type), allocatable :: parameter(:)
      type(keyword_data_type), allocatable :: data(:)
   contains
      procedure :: most_fields
   end type keyword_type

   type :: keyword_table_type
      integer :: n = 0
      type(keyword_type), allocatable :: row(:)
   end type keyword_table_type

contains

   !> Start a row.
   subroutine key(table, name, levels, origin, sentence, status)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, levels, origin, sentence
      integer, intent(in), optional :: status
      type(keyword_type), allocatable :: grown(:)

      if (.not. allocated(table%row)) allocate (table%row(64))
      if (table%n == size(table%row)) then
         allocate (grown(2*table%n))
         grown(:table%n) = table%row
         call move_alloc(grown, table%row)
      end if
      table%n = table%n + 1
      associate (row => table%row(table%n))
         row%name = name
         row%levels = levels
         row%origin = origin
         row%sentence = sentence
         row%parents = ''
         row%lecture = ''
         row%example = ''
         if (present(status)) row%status = status
         allocate (row%parameter(0), row%data(0))
      end associate
   end subroutine key

   !> A parameter without value.
   subroutine flag(table, name, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, sentence
      call add_parameter(table, name, 'flag', '', sentence)
   end subroutine flag

   !> A parameter whose value is a label.
   subroutine word(table, name, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, sentence
      call add_parameter(table, name, 'text', '', sentence)
   end subroutine word

   !> A parameter whose value is a real number.
   subroutine number(table, name, default, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, default, sentence
      call add_parameter(table, name, 'number', default, sentence)
   end subroutine number

   !> A parameter whose value is a whole number.
   subroutine whole(table, name, default, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, default, sentence
      call add_parameter(table, name, 'whole number', default, sentence)
   end subroutine whole

   !> A parameter whose value is one of a few words.
   subroutine choice(table, name, choices, default, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: choices   !! separated by commas, without blanks around them
      character(len=*), intent(in) :: default, sentence
      call add_parameter(table, name, 'choice', default, sentence)
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%choices = choices
      end associate
   end subroutine choice

   !> A parameter that is read past, with a note; a value is allowed.
   subroutine ignored_flag(table, name, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, sentence
      call add_parameter(table, name, 'text', '', sentence)
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%status = status_of%ignored
         row%parameter(size(row%parameter))%bare = 'YES'
      end associate
   end subroutine ignored_flag

   !> A parameter that a later version will have; a value is allowed.
   subroutine later_flag(table, name, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, sentence
      call ignored_flag(table, name, sentence)
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%status = status_of%later
      end associate
   end subroutine later_flag

   subroutine add_parameter(table, name, kind, default, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, kind, default, sentence
      type(keyword_parameter_type) :: new

      new%name = name
      new%kind = kind
      new%default = default
      new%sentence = sentence
      new%choices = ''
      new%refused = ''
      new%replaced = ''
      new%misspelt = ''
      new%bare = ''
      new%aliases = ''
      new%missing = ''
      table%row(table%n)%parameter = [table%row(table%n)%parameter, new]
   end subroutine add_parameter

   !> The last parameter may stand without a value, which then is this one.
   subroutine bare_value(table, value)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: value
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%bare = value
      end associate
   end subroutine bare_value

   !> The last parameter must be given.
   subroutine required(table)
      type(keyword_table_type), intent(inout) :: table
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%is_required = .true.
      end associate
   end subroutine required

   !> Other names of the last parameter, separated by commas.
   subroutine known_as(table, aliases)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: aliases
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%aliases = aliases
      end associate
   end subroutine known_as

   !> Values of the last parameter that a later version will have.
   subroutine refuses(table, values)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: values
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%refused = values
      end associate
   end subroutine refuses

   !> Values of other codes that are read as the default of the last parameter, with a note.
   subroutine replaces(table, values)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: values
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%replaced = values
      end associate
   end subroutine replaces

   !> Another spelling of a value of the last parameter, read as that value with a note.
   subroutine respells(table, pairs)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: pairs   !! `WRONG=RIGHT`, separated by commas
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%misspelt = pairs
      end associate
   end subroutine respells

   !> What a misspelling of the last parameter would silently have done.
   subroutine missing_means(table, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: sentence
      associate (row => table%row(table%n))
         row%parameter(size(row%parameter))%missing = sentence
      end associate
   end subroutine missing_means

   !> A form of data line: `name [unit] = default, name, ...`; an ellipsis repeats the field before
   !> it.
   subroutine data_line(table, fields, sentence, condition)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: fields, sentence
      character(len=*), intent(in), optional :: condition   !! `PARAMETER=VALUE` that it goes with
      type(keyword_data_type) :: new
      integer :: i, n

      new%sentence = sentence
      new%condition = ''
      if (present(condition)) new%condition = condition
      n = list_size(fields)
      if (n > 0) new%is_list = list_item(fields, n) == '...'
      if (new%is_list) n = n - 1
      allocate (new%field(n))
      do i = 1, n
         call read_field(list_item(fields, i), new%field(i))
      end do
      table%row(table%n)%data = [table%row(table%n)%data, new]
   end subroutine data_line

   subroutine read_field(text, field)
      character(len=*), intent(in) :: text   !! `name [unit] = default`
      type(keyword_field_type), intent(out) :: field
      integer :: open, close, equals, last

      open = index(text, '[')
      close = index(text, ']')
      equals = index(text, '=')
      last = len(text)
      field%default = ''
      field%unit = ''
      if (equals > 0) then
         field%default = trim(adjustl(text(equals + 1:)))
         last = equals - 1
      end if
      if (open > 0) then
         field%unit = text(open:close)
         last = open - 1
      end if
      field%name = trim(text(:last))
   end subroutine read_field

   !> The data lines are prose, in any alphabet.
   subroutine free_text(table)
      type(keyword_table_type), intent(inout) :: table
      table%row(table%n)%is_free_text = .true.
   end subroutine free_text

   !> What the card says, its parameters and data lines, is kept in `model%settings` as it is
   !> written: the head of the run shows it, the summary has it, `Model.read` hands it on.
   subroutine reported(table)
      type(keyword_table_type), intent(inout) :: table
      table%row(table%n)%is_reported = .true.
   end subroutine reported

   !> A deck, or the part of one, that shows the keyword.
   subroutine example(table, lines)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: lines   !! separated by |
      table%row(table%n)%example = lines
   end subroutine example

   !> The keyword must follow one of these.
   subroutine under(table, parents)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: parents
      table%row(table%n)%parents = parents
   end subroutine under

   !> The section of the lecture that the keyword serves.
   subroutine about(table, lecture)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: lecture
      table%row(table%n)%lecture = lecture
   end subroutine about

   !> The most fields that a data line may have; -1: no data lines, huge: no limit.
   pure integer function most_fields(self) result(most)
      class(keyword_type), intent(in) :: self
      integer :: i

      most = -1
      do i = 1, size(self%data)
         most = max(most, size(self%data(i)%field))
         if (self%data(i)%is_list) most = huge(most)
      end do
      if (self%is_free_text) most = huge(most)
   end function most_fields

   !> Row of a keyword, 0 if unknown; blanks do not count (`*ENDSTEP`).
   pure integer function find_keyword(table, name) result(found)
      type(keyword_table_type), intent(in) :: table
      character(len=*), intent(in) :: name   !! any case, with or without its star
      character(len=:), allocatable :: wanted

      wanted = upper(without_blanks(name))
      if (index(wanted, '*') == 1) wanted = wanted(2:)
      do found = 1, table%n
         if (without_blanks(table%row(found)%name) == wanted) return
      end do
      found = 0
   end function find_keyword

   !> Number of a parameter in its row, 0 if unknown; aliases count, blanks do not.
   pure integer function find_parameter(row, name) result(found)
      type(keyword_type), intent(in) :: row
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: wanted

      wanted = upper(without_blanks(name))
      do found = 1, size(row%parameter)
         if (without_blanks(row%parameter(found)%name) == wanted) return
         if (in_list(row%parameter(found)%aliases, name)) return
      end do
      found = 0
   end function find_parameter

   !> The keyword that was probably meant, '' if none is near.
   pure function suggest_keyword(table, name) result(found)
      type(keyword_table_type), intent(in) :: table
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: found
      character(len=64) :: list(table%n)
      integer :: i

      do i = 1, table%n
         list(i) = table%row(i)%name
      end do
      found = nearest_word(name, list)
   end function suggest_keyword

   !> The parameter that was probably meant, '' if none is near.
   pure function suggest_parameter(row, name) result(found)
      type(keyword_type), intent(in) :: row
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: found
      character(len=64) :: list(size(row%parameter))
      integer :: i

      do i = 1, size(row%parameter)
         list(i) = row%parameter(i)%name
      end do
      found = nearest_word(name, list)
   end function suggest_parameter
end module lopin_keyword_table
