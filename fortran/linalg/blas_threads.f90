!> Threads and kernel of the BLAS, where it has such switches (OpenBLAS).
!>
!> A run calls it on one thread: factorisations share out their own work (supernodal_tiles.h), and
!> handing small blocks from thread to thread costs more than it saves.
module lopin_blas_threads
   use, intrinsic :: iso_c_binding, only : c_int, c_char, c_null_char
   use lopin_blas, only : dsyev
   use lopin_error, only : error_type, error_code, raise
   use lopin_kinds, only : wp
   implicit none
   private
   public :: set_blas_threads, blas_threads, ready_blas, blas_kernel

   interface
      integer(c_int) function lopin_blas_threads_set(n) bind(c)
         import :: c_int
         integer(c_int), value :: n
      end function lopin_blas_threads_set
      integer(c_int) function lopin_blas_threads_now() bind(c)
         import :: c_int
      end function lopin_blas_threads_now
      integer(c_int) function lopin_blas_took_room(now) bind(c)
         import :: c_int
         integer(c_int), value :: now
      end function lopin_blas_took_room
      integer(c_int) function lopin_has_room_for_blas(threads) bind(c)
         import :: c_int
         integer(c_int), value :: threads
      end function lopin_has_room_for_blas
      subroutine lopin_choose_blas_kernel() bind(c)
      end subroutine lopin_choose_blas_kernel
      integer(c_int) function lopin_blas_kernel(name, room) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(out) :: name(*)
         integer(c_int), value :: room
      end function lopin_blas_kernel
   end interface

contains

   !> Let the BLAS use n threads; false if this BLAS has no such switch.
   logical function set_blas_threads(n) result(done)
      integer, intent(in) :: n   !! 1 makes results independent of the machine's load
      integer :: most

      most = n
      if (n > 1) then
         if (lopin_has_room_for_blas(int(n, c_int)) == 0) most = 1
      end if
      done = lopin_blas_threads_set(int(most, c_int)) /= 0
   end function set_blas_threads

   !> Let the BLAS take its kernel, and its room: where it finds none it waits for ever, so it is
   !> not called at all.
   subroutine ready_blas(error)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: matrix(3, 3), value(3), work(16)
      integer :: info

      if (blas_threads() == 0) return
      call lopin_choose_blas_kernel()
      if (lopin_blas_took_room(0_c_int) /= 0) return
      if (lopin_has_room_for_blas(1_c_int) == 0) then
         call raise(error, error_code%resource, 'E0702', 'not enough memory: the BLAS takes '// &
            & '128 MB, which the system refuses', help='raise the limit of the address space '// &
            & '(ulimit -v)')
         return
      end if
      matrix = 1.0_wp
      call dsyev('N', 'L', 3, matrix, 3, value, work, size(work), info)
      info = info + lopin_blas_took_room(1_c_int) - 1
      if (info /= 0) call raise(error, error_code%resource, 'E0703', 'the BLAS fails on three '// &
         & 'equations')
   end subroutine ready_blas

   !> The kernel that the BLAS uses for this processor, '' if it does not say.
   function blas_kernel() result(name)
      character(len=:), allocatable :: name
      character(kind=c_char) :: text(32)
      logical :: chosen
      integer :: i

      call lopin_choose_blas_kernel()
      chosen = lopin_blas_kernel(text, int(size(text), c_int)) /= 0
      name = ''
      do i = 1, size(text)
         if (text(i) == c_null_char) exit
         name = name//text(i)
      end do
      if (chosen) name = name//' (chosen here: this BLAS does not know the processor)'
   end function blas_kernel

   !> How many threads the BLAS uses; 0 if it does not say.
   integer function blas_threads()
      blas_threads = lopin_blas_threads_now()
   end function blas_threads
end module lopin_blas_threads
