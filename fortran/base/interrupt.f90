!> The wish that a run ends: the first SIGINT, SIGTERM, SIGHUP or SIGXCPU is noted, the second ends
!> the process.
module lopin_interrupt
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: catch_interrupts, is_interrupted, guard_process

   interface
      !> From now on the first signal is only noted. For programs; a library leaves signals alone.
      subroutine catch_interrupts() bind(c, name='lopin_catch_interrupts')
      end subroutine catch_interrupts

      !> The first call of a program: writes that fail return, signals print nothing.
      subroutine guard_process() bind(c, name='lopin_guard_process')
      end subroutine guard_process

      function lopin_signal_noted() bind(c) result(number)
         import :: c_int
         integer(c_int) :: number
      end function lopin_signal_noted
   end interface

contains

   logical function is_interrupted()
      is_interrupted = lopin_signal_noted() /= 0
   end function is_interrupted
end module lopin_interrupt
