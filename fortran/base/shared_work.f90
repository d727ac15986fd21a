!> Loops whose parts the threads of a run share out.
!>
!> What a part needs and writes stands in an extension of `shared_work_type`. Parts of one stage
!> must not write to the same place; stages follow each other. The bits do not depend on the number
!> of threads as long as that holds.
module lopin_shared_work
   use, intrinsic :: iso_c_binding, only : c_int, c_ptr, c_funptr, c_loc, c_funloc, c_f_pointer
   use omp_lib, only : omp_get_max_threads
   implicit none
   private
   public :: shared_work_type, share_out

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

   !> Do parts begin(s) to begin(s + 1) - 1 of stage s, stage after stage.
   subroutine share_out(work, begin, last_is_serial)
      class(shared_work_type), intent(inout), target :: work
      integer, intent(in) :: begin(:)                  !! (nstage + 1)
      logical, intent(in), optional :: last_is_serial  !! parts of the last stage in their order
      type(handle_type), target :: handle
      integer(c_int) :: serial
      integer :: k

      if (omp_get_max_threads() == 1) then
         do k = begin(1), begin(size(begin)) - 1
            call work%do_part(k)
         end do
         return
      end if
      serial = 0
      if (present(last_is_serial)) serial = merge(1_c_int, 0_c_int, last_is_serial)
      handle%work => work
      call lopin_team_loop(int(omp_get_max_threads(), c_int), size(begin) - 1, &
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
