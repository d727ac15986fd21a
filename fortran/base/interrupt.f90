!> Requests to stop a run: the first SIGINT, SIGTERM, SIGHUP or SIGXCPU is noted, the second ends
!> the process.
module lopin_interrupt
   use, intrinsic :: iso_c_binding, only : c_int
   use lopin_error, only : error_type, error_code, raise
   implicit none
   private
   public :: catch_interrupts, is_interrupted, answer_interrupt, guard_process
   public :: borrow_interrupt, return_interrupt

   interface
      !> From now on the first signal is only noted. For programs; a library leaves signals alone.
      subroutine catch_interrupts() bind(c, name='lopin_catch_interrupts')
      end subroutine catch_interrupts

      !> Note one SIGINT of a process that is not ours; give its handler back.
      subroutine borrow_interrupt() bind(c, name='lopin_borrow_interrupt')
      end subroutine borrow_interrupt

      subroutine return_interrupt(answered) bind(c, name='lopin_return_interrupt')
         import :: c_int
         integer(c_int), value :: answered   !! not 0: the run has ended for it
      end subroutine return_interrupt

      !> The first call of a program: writes that fail return, signals print nothing.
      subroutine guard_process() bind(c, name='lopin_guard_process')
      end subroutine guard_process

      function lopin_signal_noted() bind(c) result(number)
         import :: c_int
         integer(c_int) :: number
      end function lopin_signal_noted
   end interface

contains

   !> Whether the process was asked to stop since `catch_interrupts`.
   logical function is_interrupted()
      is_interrupted = lopin_signal_noted() /= 0
   end function is_interrupted

   !> An error where the process was asked to stop: between two iterations, so that a run that finds
   !> no answer ends as soon as one that does.
   subroutine answer_interrupt(error)
      type(error_type), allocatable, intent(out) :: error
      if (is_interrupted()) call raise(error, error_code%interrupted, 'E0605', &
         & 'interrupted within an increment; what was accepted before it stands')
   end subroutine answer_interrupt
end module lopin_interrupt
