!> When a checkpoint is written, and how a run resumes from one.
module lopin_checkpointing
   use lopin_error, only : error_type, error_code, raise
   use lopin_interrupt, only : is_interrupted
   use lopin_stream, only : stream_type
   use lopin_text, only : to_text
   use lopin_clock, only : phase
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_run_type, only : run_type
   use lopin_checkpoint_store, only : checkpoint_store_type
   use lopin_checkpoint, only : pass_run
   implicit none
   private
   public :: save_checkpoint, keep_for_resume, go_back

contains

   !> To the state that an earlier run kept; its files are cut to what they were then.
   subroutine go_back(run, model, recorders, stream, error)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      stream%reading = .true.
      call pass_run(run, model, stream, error)
      if (.not. allocated(error)) call pass_recorders(recorders, stream, error)
      if (allocated(error)) return
      if (stream%broken .or. .not. stream%ended()) call raise(error, error_code%resource, &
         & 'E0604', 'the checkpoint does not hold what this build of Lopin keeps', &
         & help='run the deck without --resume')
   end subroutine go_back

   subroutine pass_recorders(recorders, stream, error)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(recorders)
         call recorders(i)%recorder%keep(stream, error)
         if (allocated(error)) return
      end do
   end subroutine pass_recorders

   !> Keep the state of an accepted increment: where it is due, or if the run is to end here, which
   !> is the error then; else it is only at hand, for an end within the next increment.
   subroutine save_checkpoint(run, model, recorders, error, store)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(error_type), allocatable, intent(out) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      type(stream_type) :: stream
      character(len=:), allocatable :: name
      logical :: ends, due

      associate (scene => run%scene, clock => run%scene%accepted%clock)
         if (clock%at_end .and. scene%step == size(model%step)) return
         ends = is_interrupted()
         name = 'increment '//to_text(clock%number)//' of step '//to_text(scene%step)
         if (.not. present(store)) then
            if (ends) call raise(error, error_code%interrupted, 'E0605', 'interrupted after '// &
               & name//'; without a folder nothing is kept')
            return
         end if
         associate (every => model%step(scene%step)%checkpoint)
            due = every > 0
            if (due) due = clock%at_end .or. mod(clock%number, every) == 0
         end associate
         call move_alloc(store%room, stream%bytes)
         call pass_run(run, model, stream, error)
         if (.not. allocated(error)) call pass_recorders(recorders, stream, error)
         if (allocated(error)) return
         store%bytes_in_room = stream%n
         store%in_room = name
         call move_alloc(stream%bytes, store%room)
         if (due .or. ends) call keep_accepted(store, error)
         call scene%clock%stop_in(phase%output)
         if (allocated(error) .or. .not. ends) return
         call raise(error, error_code%interrupted, 'E0605', 'interrupted after '//name// &
            & ', which is kept', help='the same command with --resume goes on from there')
      end associate
   end subroutine save_checkpoint

   !> A run ends within an increment: what was accepted is kept, and the error says how to go on.
   subroutine keep_for_resume(store, error)
      class(checkpoint_store_type), intent(inout) :: store
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: failed

      call keep_accepted(store, failed)
      if (allocated(failed)) then
         call move_alloc(failed, error)
      else if (allocated(store%kept)) then
         error%item(1)%help = 'with --resume (resume=True) the run goes on from '//store%kept
      end if
   end subroutine keep_for_resume

   !> Keep the state of the last accepted increment, if it is not kept yet.
   subroutine keep_accepted(store, error)
      class(checkpoint_store_type), intent(inout) :: store
      type(error_type), allocatable, intent(out) :: error
      type(stream_type) :: stream

      if (store%bytes_in_room == 0) return
      call move_alloc(store%room, stream%bytes)
      stream%n = store%bytes_in_room
      call store%save(stream, error)
      if (.not. allocated(error)) store%kept = store%in_room
      store%bytes_in_room = 0
      call move_alloc(stream%bytes, store%room)
   end subroutine keep_accepted
end module lopin_checkpointing
