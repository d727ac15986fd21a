!> What each word of the command line does.
module lopin_tasks
   use, intrinsic :: iso_fortran_env, only : compiler_version, compiler_options
   use lopin_build_model, only : new_model
   use lopin_command_line, only : options_type
   use lopin_deck, only : deck_type, read_deck
   use lopin_error, only : error_type, error_code, log_type, raise
   use lopin_explain, only : explain, explained_codes
   use lopin_keywords, only : keyword_sheet, keyword_manual
   use lopin_model, only : model_type
   use lopin_clock, only : clock_type, phase
   use lopin_recorder, only : recorder_holder_type
   use lopin_recorder_factory, only : new_recorders
   use lopin_run_analysis, only : run_analysis
   use lopin_selftest, only : selftest_case, ncase
   use lopin_solver_cholmod, only : set_blas_threads
   use lopin_state, only : summary_type
   use lopin_terminal, only : terminal_type
   use lopin_text, only : plural, upper
   use lopin_version, only : version
   use omp_lib, only : omp_set_num_threads
   implicit none
   private
   public :: run_deck, check_deck, show_info, show_explanation, show_keyword, run_selftest

contains

   !> lopin run deck.inp
   subroutine run_deck(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(model_type) :: model
      type(recorder_holder_type), allocatable :: recorders(:)
      type(clock_type) :: clock
      type(summary_type) :: summary
      type(log_type) :: log
      type(error_type), allocatable :: error

      call clock%start()
      call open_model(options, terminal, model)
      call clock%stop_in(phase%model)
      call set_threads(options)
      call new_recorders(recorders, model, folder_of(options), stem_of(options%subject), error, &
         & names_of(terminal%deck))
      call terminal%stop_on(error)
      call run_analysis(model, recorders, clock, summary, log, error)
      if (len(summary%plan) > 0) call terminal%say(summary%plan)
      call terminal%show_log(log)
      call terminal%stop_on(error)
   end subroutine run_deck

   !> Threads of the assembly; BLAS on one thread where the same bits are asked for.
   subroutine set_threads(options)
      type(options_type), intent(in) :: options
      logical :: done

      if (options%threads > 0) call omp_set_num_threads(options%threads)
      done = .true.
      if (options%deterministic) then
         done = set_blas_threads(1)
      else if (options%threads > 0) then
         done = set_blas_threads(options%threads)
      end if
      associate (unused => done)
      end associate
   end subroutine set_threads

   function folder_of(options) result(folder)
      type(options_type), intent(in) :: options
      character(len=:), allocatable :: folder
      folder = options%output
      if (len(folder) == 0) folder = 'out/'//stem_of(options%subject)
   end function folder_of

   !> Name of the deck without its folder and its .inp.
   function stem_of(path) result(stem)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: stem
      integer :: dot

      stem = path(index(path, '/', back=.true.) + 1:)
      dot = index(stem, '.', back=.true.)
      if (dot > 1) stem = stem(:dot - 1)
   end function stem_of

   function names_of(deck) result(names)
      type(deck_type), intent(in) :: deck
      character(len=200), allocatable :: names(:)
      integer :: i

      allocate (names(size(deck%source)))
      do i = 1, size(names)
         names(i) = deck%source(i)%name
      end do
   end function names_of

   !> lopin check deck.inp: everything but the solution.
   subroutine check_deck(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(model_type) :: model

      call open_model(options, terminal, model)
      call terminal%say(options%subject//': '//plural(model%mesh%nnode, 'node')//', '// &
         & plural(model%mesh%nelement, 'element')//', '//plural(size(model%pair), &
         & 'contact pair')//', '// &
         & plural(size(model%step), 'step')//': no error')
   end subroutine check_deck

   !> Read the deck, build the model, and show what both had to say.
   subroutine open_model(options, terminal, model)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(model_type), intent(out) :: model
      type(error_type), allocatable :: error

      call open_deck(options, terminal)
      call new_model(model, terminal%deck, error)
      call terminal%show_log(model%log)
      call terminal%stop_on(error)
      if (len(options%solver) > 0) model%solver = upper(options%solver)
   end subroutine open_model

   !> Read the deck and show what the reader had to say.
   subroutine open_deck(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(log_type) :: log
      type(error_type), allocatable :: error

      call read_deck(terminal%deck, options%subject, log, error)
      call terminal%show_log(log)
      call terminal%stop_on(error)
   end subroutine open_deck

   !> lopin info, lopin info deck.inp
   subroutine show_info(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal

      if (len(options%subject) == 0) then
         print '(a)', 'lopin '//version, 'compiler: '//compiler_version(), 'options: '// &
            & compiler_options()
         return
      end if
      call open_deck(options, terminal)
      call summarise(terminal%deck)
   end subroutine show_info

   !> Files and keywords of a deck with their numbers of data lines.
   subroutine summarise(deck)
      type(deck_type), intent(in) :: deck
      integer :: i, k, cards, lines

      do i = 1, size(deck%source)
         print '(a)', deck%source(i)%name//': '//plural(deck%source(i)%nline, 'line')
      end do
      do i = 1, deck%nblock
         cards = 0
         lines = 0
         do k = 1, deck%nblock
            if (deck%block(k)%keyword /= deck%block(i)%keyword) cycle
            if (k < i) exit
            cards = cards + 1
            lines = lines + deck%block(k)%nline
         end do
         if (cards > 0) print '(a)', '*'//deck%block(i)%keyword//': '//plural(cards, 'card')// &
            & ', '// &
            & plural(lines, 'data line')
      end do
   end subroutine summarise

   !> lopin explain E0312; without a code, the list of all.
   subroutine show_explanation(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(error_type), allocatable :: error
      character(len=:), allocatable :: text
      logical :: found

      if (len(options%subject) == 0) then
         print '(a)', explained_codes()
         return
      end if
      call explain(options%subject, text, found)
      if (.not. found) call raise(error, error_code%usage, 'E0801', text, help='lopin explain')
      call terminal%stop_on(error)
      print '(a)', text
   end subroutine show_explanation

   !> lopin doc '*FRICTION', lopin doc --all
   subroutine show_keyword(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(error_type), allocatable :: error
      character(len=:), allocatable :: text
      logical :: found

      if (options%all) then
         write (*, '(a)', advance='no') keyword_manual()
         return
      end if
      call keyword_sheet(options%subject, text, found)
      if (.not. found) call raise(error, error_code%usage, 'E0801', text, help='lopin doc --all')
      call terminal%stop_on(error)
      print '(a)', text
   end subroutine show_keyword

   !> lopin selftest: closed forms, without any file.
   subroutine run_selftest(terminal)
      type(terminal_type), intent(inout) :: terminal
      type(error_type), allocatable :: error
      character(len=:), allocatable :: line
      integer :: i

      call terminal%say('lopin '//version)
      do i = 1, ncase
         call selftest_case(i, line, error)
         call terminal%stop_on(error)
         call terminal%say(line)
      end do
      call terminal%say('selftest passed')
   end subroutine run_selftest
end module lopin_tasks
