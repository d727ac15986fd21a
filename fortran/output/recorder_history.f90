!> `job_history.csv`: a header `name [dimension]`, then one row an increment.
module lopin_recorder_history
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : frame_type
   use lopin_recorder, only : recorder_type
   use lopin_atomic_file, only : log_file_type
   use lopin_safe_text, only : csv_field
   use lopin_recorder_table, only : column_type, history_columns, history_row
   implicit none
   private
   public :: history_recorder_type, new_history_recorder

   type, extends(recorder_type) :: history_recorder_type
      private
      character(len=:), allocatable :: path
      type(log_file_type) :: log
   contains
      procedure :: begin
      procedure :: commit
      procedure :: increment
      procedure :: close => close_file
      procedure :: keep
   end type history_recorder_type

contains

   subroutine new_history_recorder(self, path)
      type(history_recorder_type), intent(out) :: self
      character(len=*), intent(in) :: path
      self%path = path
   end subroutine new_history_recorder

   subroutine begin(self, model, error)
      class(history_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(column_type), allocatable :: column(:)
      character(len=:), allocatable :: header
      integer :: i

      call history_columns(model, column)
      header = ''
      do i = 1, size(column)
         if (i > 1) header = header//','
         header = header//csv_field(column(i)%name//' ['//column(i)%dimension//']')
      end do
      call self%log%open(self%path, header//achar(10), error, self%resumes)
   end subroutine begin

   subroutine commit(self, error)
      class(history_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%log%commit(error)
   end subroutine commit

   subroutine increment(self, model, frame, error)
      class(history_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: row(:)
      character(len=:), allocatable :: text
      integer :: i

      call history_row(model, frame, row)
      text = ''
      do i = 1, size(row)
         if (i > 1) text = text//','
         text = text//to_text(row(i))
      end do
      call self%log%append(text//achar(10), error)
   end subroutine increment

   subroutine keep(self, stream, error)
      class(history_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      call self%log%keep(stream, error)
   end subroutine keep

   subroutine close_file(self, error)
      class(history_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%log%close(error)
   end subroutine close_file
end module lopin_recorder_history
