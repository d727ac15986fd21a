!> The result files of a run and its checkpoint, begun together and ended together.
module lopin_run_files
   use lopin_error, only : error_type, error_code
   use lopin_model, only : model_type
   use lopin_report, only : summary_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_checkpoint_store, only : checkpoint_store_type
   implicit none
   private
   public :: begin_files, finish_files

contains

   !> The files of an earlier run, its checkpoint included, stay until those of this run are begun.
   subroutine begin_files(recorders, model, error, store)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      logical :: resumes
      integer :: i

      resumes = .false.
      if (present(store)) resumes = allocated(store%found)
      do i = 1, size(recorders)
         recorders(i)%recorder%resumes = resumes
         call recorders(i)%recorder%begin(model, error)
         if (allocated(error)) return
      end do
      do i = 1, size(recorders)
         call recorders(i)%recorder%commit(error)
         if (allocated(error)) return
         ! The first file that is replaced ends the earlier run.
         if (i == 1 .and. present(store) .and. .not. resumes) call store%forget()
      end do
   end subroutine begin_files

   !> Files are closed and on the disk before the summary says how the run ended.
   subroutine finish_files(recorders, model, summary, error, store)
      type(recorder_holder_type), intent(inout) :: recorders(:)
      type(model_type), intent(in) :: model
      type(summary_type), intent(inout) :: summary
      type(error_type), allocatable, intent(inout) :: error
      class(checkpoint_store_type), intent(inout), optional :: store
      type(error_type), allocatable :: trouble
      integer :: i

      if (present(store)) call store%settle(trouble)
      if (.not. allocated(error)) call move_alloc(trouble, error)
      do i = 1, size(recorders)
         call recorders(i)%recorder%close(trouble)
         if (.not. allocated(error)) call move_alloc(trouble, error)
      end do
      if (allocated(error)) then
         summary%status = 'failed'
         if (error%code == error_code%not_converged) summary%status = 'not converged'
         if (error%code == error_code%interrupted) summary%status = 'interrupted'
         summary%exit_code = error%code
         if (present(store)) call note_what_survives(error, store)
      end if
      do i = 1, size(recorders)
         call recorders(i)%recorder%finish(model, summary, error, trouble)
         if (.not. allocated(trouble)) cycle
         if (present(store)) call note_what_survives(trouble, store)
         if (.not. allocated(error)) call move_alloc(trouble, error)
      end do
   end subroutine finish_files

   !> Where memory or a disk ended the run: what is whole.
   subroutine note_what_survives(error, store)
      type(error_type), intent(inout) :: error
      class(checkpoint_store_type), intent(in) :: store

      associate (id => error%item(1)%id)
         if (id /= 'E0602' .and. id(:3) /= 'E07') return
      end associate
      error%item(1)%note = 'no file is torn; no checkpoint is there yet'
      if (allocated(store%kept)) error%item(1)%note = 'no file is torn, and the checkpoint '// &
         & 'after '//store%kept//' is whole'
   end subroutine note_what_survives
end module lopin_run_files
