!> Threads of the BLAS, where it has such a switch (OpenBLAS; others obey the environment only).
!>
!> Handing small blocks from thread to thread costs more than it saves, and threads that were woken
!> once spin for a while: measured on two cores, a solid of 6000 equations takes twice as long on
!> two threads as on one, of 24000 as long, of 66000 a tenth less.
module lopin_blas_threads
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: set_blas_threads, blas_threads, worth_threads

   !> Equations of a solid from which more than one thread pays; plane systems never do.
   integer, parameter :: worth_threads = 40000

   interface
      integer(c_int) function lopin_blas_threads_set(n) bind(c)
         import :: c_int
         integer(c_int), value :: n
      end function lopin_blas_threads_set
      integer(c_int) function lopin_blas_threads_now() bind(c)
         import :: c_int
      end function lopin_blas_threads_now
   end interface

contains

   !> Let the BLAS use n threads; false if this BLAS has no such switch.
   logical function set_blas_threads(n) result(done)
      integer, intent(in) :: n   !! 1 makes results independent of the machine's load
      done = lopin_blas_threads_set(int(n, c_int)) /= 0
   end function set_blas_threads

   !> How many threads the BLAS uses; 0 if it does not say.
   integer function blas_threads()
      blas_threads = lopin_blas_threads_now()
   end function blas_threads
end module lopin_blas_threads
