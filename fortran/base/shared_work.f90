!> Loops whose parts the threads of a run share out.
!>
!> What a part needs and writes stands in an extension of `shared_work_type`. Parts of one stage
!> must not write to the same place; stages follow each other. The bits do not depend on the number
!> of threads as long as that holds.
module lopin_shared_work
   use, intrinsic :: iso_c_binding, only : c_int, c_ptr, c_funptr, c_loc, c_funloc, c_f_pointer
   implicit none
   private
   public :: shared_work_type, share_out, threads_of_run, set_threads_of_run

   type, abstract :: shared_work_type
   contains
      procedure(do_one_part), deferred :: do_part
   end type shared_work_type

   abstract interface
      subroutine do_one_part(self, k)
         import :: shared_work_type
         class(shared_work_type), intent(inout) :: self
         integer, intent(in) :: k              !! the part
      end subroutine do_one_part
   end interface

   !> What C hands back to each thread.
   type :: handle_type
      class(shared_work_type), pointer :: work => null()
   end type handle_type

   interface
      integer(c_int) function lopin_threads_of_run() bind(c)
         import :: c_int
      end function lopin_threads_of_run
      subroutine lopin_set_threads_of_run(threads) bind(c)
         import :: c_int
         integer(c_int), value :: threads
      end subroutine lopin_set_threads_of_run
      subroutine lopin_team_loop(threads, stages, begin, last_is_serial, part, context) &
         & bind(c)
         import :: c_int, c_ptr, c_funptr
         integer(c_int), value :: threads, stages, last_is_serial
         integer(c_int), intent(in) :: begin(*)
         type(c_funptr), value :: part
         type(c_ptr), value :: context
      end subroutine lopin_team_loop
   end interface

contains

   !> Threads that the run in progress computes on; 1 where none is.
   integer function threads_of_run()
      threads_of_run = int(lopin_threads_of_run())
   end function threads_of_run

   !> From now on loops and factorisations are shared out among so many threads.
   subroutine set_threads_of_run(threads)
      integer, intent(in) :: threads

      call lopin_set_threads_of_run(int(threads, c_int))
   end subroutine set_threads_of_run

   !> Do parts begin(s) to begin(s + 1) - 1 of stage s, stage after stage.
   subroutine share_out(work, begin, last_is_serial)
      class(shared_work_type), intent(inout), target :: work
      integer, intent(in) :: begin(:)                  !! (nstage + 1)
      logical, intent(in), optional :: last_is_serial  !! parts of the last stage in their order
      type(handle_type), target :: handle
      integer(c_int) :: serial
      integer :: k

      if (threads_of_run() == 1) then
         do k = begin(1), begin(size(begin)) - 1
            call work%do_part(k)
         end do
         return
      end if
      serial = 0
      if (present(last_is_serial)) serial = merge(1_c_int, 0_c_int, last_is_serial)
      handle%work => work
      call lopin_team_loop(lopin_threads_of_run(), size(begin) - 1, &
         & int(begin, c_int), serial, c_funloc(do_part_of), c_loc(handle))
   end subroutine share_out

   subroutine do_part_of(context, k) bind(c)
      type(c_ptr), value :: context
      integer(c_int), value :: k
      type(handle_type), pointer :: handle

      call c_f_pointer(context, handle)
      call handle%work%do_part(int(k))
   end subroutine do_part_of
end module lopin_shared_work
