!> What each word of the command line does.
module lopin_tasks
   use, intrinsic :: iso_fortran_env, only : compiler_version
   use omp_lib, only : omp_get_max_threads
   use lopin_blas_threads, only : blas_kernel
   use lopin_closing, only : tell_end
   use lopin_command_line, only : options_type
   use lopin_enforcement_factory, only : method_names
   use lopin_plan, only : plan_type, new_plan
   use lopin_run_state, only : make_workspace
   use lopin_scene, only : scene_type
   use lopin_solver_factory, only : solver_words
   use lopin_deck, only : read_deck
   use lopin_error, only : error_type, error_code, log_type, raise
   use lopin_interrupt, only : catch_interrupts
   use lopin_job, only : job_type, outcome_type, open_job, run_job, stem_of
   use lopin_explain, only : explain, explained_codes
   use lopin_first_contact, only : describe_pair
   use lopin_keywords, only : keyword_sheet, keyword_manual
   use lopin_live, only : live_type, new_live, form_of
   use lopin_model, only : model_type
   use lopin_safe_text, only : printable
   use lopin_selftest, only : selftest_case, ncase
   use lopin_terminal, only : terminal_type
   use lopin_plural, only : plural
   use lopin_text, only : join, to_text
   use lopin_version, only : version
   implicit none
   private
   public :: run_deck, check_deck, show_info, show_explanation, show_keyword, run_selftest

   character(len=1), parameter :: nl = achar(10)

contains

   !> lopin run deck.inp
   subroutine run_deck(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(job_type) :: job
      type(model_type) :: model
      type(outcome_type) :: outcome
      type(live_type) :: live
      type(error_type), allocatable :: error
      integer :: i

      call outcome%clock%start()
      call new_live(live, options%progress, options%verbosity, options%json)
      terminal%jsonl = live%form == form_of%json
      call new_job(job, options)
      call open_model(job, options, terminal, model)
      do i = 1, model%settings%count_all()
         call terminal%say('*'//model%settings%item(i)%name//': '//model%settings%item(i)%text)
      end do
      call catch_interrupts()
      terminal%line = live%form == form_of%line
      allocate (outcome%watcher, source=live)
      call run_job(job, terminal%deck, model, outcome, error)
      call terminal%end_line()
      call terminal%show_log(outcome%log)
      call tell_end(job, model, outcome, error, terminal)
      call terminal%stop_on(error)
   end subroutine run_deck

   subroutine new_job(job, options)
      type(job_type), intent(out) :: job
      type(options_type), intent(in) :: options

      job%stem = stem_of(options%subject)
      job%folder = options%output
      if (len(job%folder) == 0) job%folder = 'out/'//job%stem
      job%solver = options%solver
      job%threads = options%threads
      job%deterministic = options%deterministic
      job%resume = options%resume
      job%overwrite = options%overwrite
   end subroutine new_job

   !> lopin check deck.inp: what a run does before its first step, the search of contact included.
   subroutine check_deck(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(job_type) :: job
      type(model_type) :: model
      type(plan_type) :: plan
      type(scene_type) :: scene
      type(error_type), allocatable :: error
      integer :: pair

      call new_job(job, options)
      call open_model(job, options, terminal, model)
      call new_plan(plan, model, error)
      if (.not. allocated(error)) call make_workspace(scene, model, plan, error)
      call terminal%show_log(scene%log)
      call terminal%stop_on(error)
      do pair = 1, size(model%pair)
         call terminal%say(describe_pair(scene%points, scene%initial, model, pair))
      end do
      call terminal%say(options%subject//': '//plural(model%mesh%nnode, 'node')//', '// &
         & plural(model%mesh%nelement, 'element')//', '//plural(size(model%pair), &
         & 'contact pair')//', '// &
         & plural(size(model%step), 'step')//': no error')
   end subroutine check_deck

   !> Read the deck, build the model, and show what both had to say.
   subroutine open_model(job, options, terminal, model)
      type(job_type), intent(in) :: job
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(model_type), intent(out) :: model
      type(error_type), allocatable :: error

      call open_deck(options, terminal)
      call open_job(job, terminal%deck, model, error)
      call terminal%show_log(model%log)
      call terminal%stop_on(error)
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
         call terminal%tell('lopin '//version//nl//'compiler: '//compiler_version()//nl// &
            & 'solvers: '//join(solver_words)//nl//'methods: '//join(method_names)//nl// &
            & 'threads: '//to_text(omp_get_max_threads())//nl// &
            & 'kernel of the BLAS: '//blas_kernel()//nl)
         return
      end if
      call open_deck(options, terminal)
      call summarise(terminal)
   end subroutine show_info

   !> Files and keywords of a deck with their numbers of data lines.
   subroutine summarise(terminal)
      type(terminal_type), intent(inout) :: terminal
      integer :: i, k, cards, lines

      do i = 1, size(terminal%deck%source)
         call terminal%tell(printable(terminal%deck%source(i)%name)//': '// &
            & plural(terminal%deck%source(i)%nline, 'line')//nl)
      end do
      do i = 1, terminal%deck%nblock
         cards = 0
         lines = 0
         do k = 1, terminal%deck%nblock
            if (terminal%deck%block(k)%keyword /= terminal%deck%block(i)%keyword) cycle
            if (k < i) exit
            cards = cards + 1
            lines = lines + terminal%deck%block(k)%nline
         end do
         if (cards > 0) call terminal%tell('*'//printable(terminal%deck%block(i)%keyword)//': '// &
            & plural(cards, 'card')//', '//plural(lines, 'data line')//nl)
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
         call terminal%tell(explained_codes()//nl)
         return
      end if
      call explain(options%subject, text, found)
      if (.not. found) call raise(error, error_code%usage, 'E0801', text, help='lopin explain')
      call terminal%stop_on(error)
      call terminal%tell(text//nl)
   end subroutine show_explanation

   !> lopin doc '*FRICTION', lopin doc --all
   subroutine show_keyword(options, terminal)
      type(options_type), intent(in) :: options
      type(terminal_type), intent(inout) :: terminal
      type(error_type), allocatable :: error
      character(len=:), allocatable :: text
      logical :: found

      if (options%all) then
         call terminal%tell(keyword_manual())
         return
      end if
      call keyword_sheet(options%subject, text, found)
      if (.not. found) call raise(error, error_code%usage, 'E0801', text, help='lopin doc --all')
      call terminal%stop_on(error)
      call terminal%tell(text//nl)
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
