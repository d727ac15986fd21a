!> The executable: command line, deck, model, run; one task after the other.
program lopin
   use lopin_command_line, only : options_type, read_command_line, usage
   use lopin_error, only : error_type
   use lopin_interrupt, only : guard_process
   use lopin_tasks, only : run_deck, check_deck, show_info, show_explanation, show_keyword, &
      & run_selftest
   use lopin_terminal, only : terminal_type, new_terminal
   use lopin_version, only : version
   implicit none

   type(options_type) :: options
   type(terminal_type) :: terminal
   type(error_type), allocatable :: error

   call guard_process()
   call read_command_line(options, error)
   call new_terminal(terminal, options%colour, options%json, options%verbosity == 0, options%strict)
   call terminal%stop_on(error)

   select case (options%task)
   case ('run')
      call run_deck(options, terminal)
      call terminal%finish(0, 'Job finished')
   case ('check')
      call check_deck(options, terminal)
   case ('info')
      call show_info(options, terminal)
   case ('explain')
      call show_explanation(options, terminal)
   case ('doc')
      call show_keyword(options, terminal)
   case ('selftest')
      call run_selftest(terminal)
   case ('version')
      call terminal%tell('lopin '//version//achar(10))
   case default
      call terminal%tell(usage()//achar(10))
   end select
   call terminal%finish(0, '')
end program lopin
