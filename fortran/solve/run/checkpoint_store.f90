!> The contract of checkpoint stores: where the state of a run is kept between two processes, asked
!> after accepted increments.
!>
!> The analysis knows what belongs to the state, a store knows where it is kept; a run without a
!> store keeps nothing.
module lopin_checkpoint_store
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: checkpoint_store_type

   type, abstract :: checkpoint_store_type
      type(stream_type), allocatable :: found   !! of an earlier run, to go on from; else a new run
      integer(int8), allocatable :: room(:)     !! bytes of the last state, room for the next
      character(len=:), allocatable :: kept     !! increment whose state is kept, for messages
      integer(int64) :: bytes_in_room = 0       !! of a state that is not kept yet; 0: none
      character(len=:), allocatable :: in_room  !! its increment
   contains
      procedure(save_if), deferred :: save
      procedure(forget_if), deferred :: forget
      procedure(settle_if), deferred :: settle
   end type checkpoint_store_type

   abstract interface
      !> Replace what is kept: afterwards it is the new state or, on an error, still the old one.
      subroutine save_if(self, stream, error)
         import :: checkpoint_store_type, stream_type, error_type
         class(checkpoint_store_type), intent(inout) :: self
         type(stream_type), intent(in) :: stream
         type(error_type), allocatable, intent(out) :: error
      end subroutine save_if

      !> The run starts from its beginning, or is finished: nothing is to be resumed.
      subroutine forget_if(self)
         import :: checkpoint_store_type
         class(checkpoint_store_type), intent(inout) :: self
      end subroutine forget_if

      !> All that the run has written is on the disk afterwards.
      subroutine settle_if(self, error)
         import :: checkpoint_store_type, error_type
         class(checkpoint_store_type), intent(inout) :: self
         type(error_type), allocatable, intent(out) :: error
      end subroutine settle_if
   end interface
end module lopin_checkpoint_store
