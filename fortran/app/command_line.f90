!> The words and options of the command line.
module lopin_command_line
   use lopin_error, only : error_type, error_code, raise
   use lopin_solver_factory, only : solver_words
   use lopin_live, only : form_of, form_words
   use lopin_text, only : nearest_word, parse_integer, quoted, join
   implicit none
   private
   public :: options_type, read_command_line, usage

   type :: options_type
      character(len=:), allocatable :: task        !! run, check, info ... help, version
      character(len=:), allocatable :: subject     !! the deck, the code, the keyword; '' if none
      character(len=:), allocatable :: output      !! folder of results, out/<stem> unless given
      character(len=:), allocatable :: solver      !! '' : as the deck says
      integer :: threads = 0                       !! 0: as the environment says
      integer :: verbosity = 1                     !! 0 quiet, 1 normal, 2 every iteration
      integer :: progress = form_of%auto           !! how a run tells where it is
      logical :: resume = .false.                  !! go on from a checkpoint
      logical :: overwrite = .false.
      logical :: deterministic = .false.           !! of earlier versions: it is always so
      logical :: json = .false.                    !! one object on stdout at the end
      logical :: colour = .true.                   !! if stderr is a terminal
      logical :: strict = .false.                  !! warnings are errors
      logical :: all = .false.                     !! doc --all
   end type options_type

   character(len=*), parameter :: own_words(8) = [character(len=8) :: 'run', 'check', 'info', &
      & 'explain', 'doc', &
      & 'selftest', 'help', 'version']
   character(len=*), parameter :: python_words(12) = [character(len=8) :: 'report', 'plot', &
      & 'chart', 'atlas', 'convert', 'export', 'example', 'die', &
      & 'identify', 'wear', 'flc', 'tracers']
   character(len=*), parameter :: option_words(17) = [character(len=15) :: '--output', &
      & '--threads', '--solver', &
      & '--resume', '--overwrite', '--deterministic', '--json', '--quiet', '--verbose', &
      & '--no-color', '--strict', '--all', '--progress', &
      & '--help', '--version', '-o', '-v']

contains

   subroutine read_command_line(options, error)
      type(options_type), intent(out) :: options
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      character(len=:), allocatable :: word

      options%task = ''
      options%subject = ''
      options%output = ''
      options%solver = ''
      i = 1
      do while (i <= command_argument_count())
         word = argument(i)
         if (index(word, '-') == 1 .and. len(word) > 1) then
            call read_option(options, word, i, error)
         else
            call read_word(options, word, error)
         end if
         if (allocated(error)) return
         i = i + 1
      end do
      call complete(options, error)
   end subroutine read_command_line

   !> A word: the task first, then what it is about.
   subroutine read_word(options, word, error)
      type(options_type), intent(inout) :: options
      character(len=*), intent(in) :: word
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: alone(3) = [character(len=8) :: 'selftest', 'version', 'help']

      if (len(options%task) == 0 .and. any(own_words == word)) then
         options%task = word
      else if (len(options%task) == 0 .and. any(python_words == word)) then
         call raise(error, error_code%usage, 'E0802', quoted(word)//' needs the Python package', &
            & help='.venv/bin/lopin '//word//' (made by ./bootstrap), or lopin '//word// &
            & ' after pip install .')
      else if (len(options%subject) == 0 .and. .not. any(alone == options%task)) then
         if (len(options%task) == 0) call refuse_mistyped(word, error)
         if (allocated(error)) return
         if (len(options%task) == 0) options%task = 'run'
         options%subject = word
      else
         call raise(error, error_code%usage, 'E0801', 'one word too many: '//quoted(word), &
            & help='lopin --help')
      end if
   end subroutine read_word

   !> A word that is no task is a deck, unless nothing has that name and it is nearly a task.
   subroutine refuse_mistyped(word, error)
      character(len=*), intent(in) :: word
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: meant
      logical :: there

      if (scan(word, './\') > 0) return
      inquire (file=word, exist=there)
      if (there) return
      meant = nearest_word(word, [character(len=8) :: own_words, python_words])
      if (len(meant) > 0) then
         call raise(error, error_code%usage, 'E0801', 'unknown command '//quoted(word)// &
            & '; did you mean '//meant//'?', help='lopin '//meant//', or lopin --help')
      else
         call raise(error, error_code%usage, 'E0801', quoted(word)//' is no command, and there '// &
            & 'is no deck of that name', help='commands: '//join(own_words)//', '// &
            & join(python_words)//'; a deck ends in .inp')
      end if
   end subroutine refuse_mistyped

   subroutine read_option(options, word, i, error)
      type(options_type), intent(inout) :: options
      character(len=*), intent(in) :: word
      integer, intent(inout) :: i          !! moves on when the option has a value
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: value, meant
      logical :: ok

      select case (word)
      case ('-o', '--output')
         call next_value(i, word, options%output, error)
      case ('--solver')
         call next_value(i, word, options%solver, error)
      case ('--threads')
         call next_value(i, word, value, error)
         if (allocated(error)) return
         call parse_integer(value, options%threads, ok)
         if (.not. ok .or. options%threads < 1) call raise(error, error_code%usage, 'E0801', &
            & '--threads needs a number from 1, not '//quoted(value))
      case ('--progress')
         call next_value(i, word, value, error)
         if (.not. allocated(error)) call read_progress(options%progress, value, error)
      case ('--resume')
         options%resume = .true.
      case ('--overwrite')
         options%overwrite = .true.
      case ('--deterministic')
         options%deterministic = .true.
      case ('--json')
         options%json = .true.
      case ('--quiet', '-q')
         options%verbosity = 0
      case ('--verbose', '-v')
         options%verbosity = 2
      case ('--no-color')
         options%colour = .false.
      case ('--strict')
         options%strict = .true.
      case ('--all')
         options%all = .true.
      case ('--help', '-h')
         options%task = 'help'
      case ('--version')
         options%task = 'version'
      case default
         meant = nearest_word(word, option_words)
         if (len(meant) > 0) meant = '; did you mean '//meant//'?'
         call raise(error, error_code%usage, 'E0801', 'unknown option '//quoted(word)//meant, &
            & help='lopin --help')
      end select
   end subroutine read_option

   subroutine read_progress(form, value, error)
      integer, intent(inout) :: form           !! one of `form_of`
      character(len=*), intent(in) :: value
      type(error_type), allocatable, intent(out) :: error

      form = findloc(form_words, value, dim=1)
      if (form == 0) call raise(error, error_code%usage, 'E0801', '--progress is one of '// &
         & join(form_words)//', not '//quoted(value))
   end subroutine read_progress

   subroutine next_value(i, word, value, error)
      integer, intent(inout) :: i
      character(len=*), intent(in) :: word
      character(len=:), allocatable, intent(out) :: value
      type(error_type), allocatable, intent(out) :: error

      i = i + 1
      value = ''
      if (i <= command_argument_count()) value = argument(i)
      if (len(value) == 0) call raise(error, error_code%usage, 'E0801', word//' needs a value')
   end subroutine next_value

   !> What was not said.
   subroutine complete(options, error)
      type(options_type), intent(inout) :: options
      type(error_type), allocatable, intent(out) :: error
      integer :: slash, point

      if (len(options%task) == 0) options%task = 'help'
      if (len(options%subject) == 0 .and. any(options%task == ['run    ', 'check  '])) then
         call raise(error, error_code%usage, 'E0801', 'lopin '//options%task//' needs a deck', &
            & help='for example: lopin '//options%task//' deck.inp')
         return
      end if
      if (options%task == 'doc' .and. len(options%subject) == 0) options%all = .true.
      if (len(options%output) > 0 .or. options%task /= 'run') return
      slash = scan(options%subject, '/\', back=.true.)
      point = index(options%subject, '.', back=.true.)
      if (point <= slash + 1) point = len(options%subject) + 1
      options%output = 'out/'//options%subject(slash + 1:point - 1)
   end subroutine complete

   function argument(number) result(word)
      integer, intent(in) :: number
      character(len=:), allocatable :: word
      integer :: length

      call get_command_argument(number, length=length)
      allocate (character(len=length) :: word)
      call get_command_argument(number, value=word)
   end function argument

   function usage() result(text)
      character(len=:), allocatable :: text
      character(len=1), parameter :: nl = achar(10)

      text = 'lopin deck.inp                 the same as lopin run deck.inp: results in '// &
         & 'out/deck/'//nl// &
         & 'lopin run deck.inp             solve, write results'//nl// &
         & 'lopin check deck.inp           read the deck, build the model, say what is wrong; '// &
         & 'no solve'//nl// &
         & 'lopin info [deck.inp | out/]   version and build, a summary of a deck or of a run'// &
         & nl// &
         & 'lopin explain [E0312]          long text of a diagnostic, or the list of all'//nl// &
         & "lopin doc ['*FRICTION']        sheet of a keyword; --all: the manual in Markdown"// &
         & nl// &
         & 'lopin selftest                 checks of the installed program'//nl//nl// &
         & '-o, --output FOLDER   where results go'//nl// &
         & '--threads N           number of threads'//nl// &
         & '--solver WORD         auto, '//join(solver_words)//nl// &
         & '--resume              go on from the checkpoint of a run that was broken off'//nl// &
         & '--overwrite           replace the unfinished run of another deck'//nl// &
         & '--deterministic       of earlier versions; the bits never depend on threads'//nl// &
         & '--strict              warnings are errors'//nl// &
         & '--json                a JSON object on standard output at the end'//nl// &
         & '--progress WORD       auto, line, plain (one an increment), json (the same), none'// &
         & nl// &
         & '--quiet, -q; --verbose, -v; --no-color; --version; --help'//nl//nl// &
         & 'With the Python package (.venv/bin/lopin, pip install .): '//join(python_words)//nl// &
         & nl// &
         & 'Exit codes: 0 finished, 1 deck, 2 command line, 3 not converged, 4 singular, 5 '// &
         & 'memory or file,'//nl// &
         & '70 internal, 130 interrupted'//nl
   end function usage
end module lopin_command_line
