!> `job.sta`: one line per increment, CalculiX's columns and then the closed points and
!> augmentations;
!> `job.cvg`: the lines that the run says, iteration by iteration.
module lopin_recorder_sta
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : frame_type
   use lopin_recorder, only : recorder_type
   use lopin_safe_text, only : printable
   use lopin_atomic_file, only : log_file_type
   implicit none
   private
   public :: sta_recorder_type, new_sta_recorder

   type, extends(recorder_type) :: sta_recorder_type
      private
      character(len=:), allocatable :: sta_path, cvg_path
      type(log_file_type) :: sta, cvg
      type(error_type), allocatable :: trouble   !! of a line, told with the increment
   contains
      procedure :: begin
      procedure :: commit
      procedure :: increment
      procedure :: close => close_files
      procedure :: keep
      procedure :: line
   end type sta_recorder_type

   character(len=*), parameter :: newline = achar(10)

contains

   subroutine new_sta_recorder(self, sta_path, cvg_path)
      type(sta_recorder_type), intent(out) :: self
      character(len=*), intent(in) :: sta_path, cvg_path
      self%sta_path = sta_path
      self%cvg_path = cvg_path
   end subroutine new_sta_recorder

   subroutine begin(self, model, error)
      class(sta_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (unused => model)
      end associate
      call self%sta%open(self%sta_path, 'SUMMARY OF JOB INFORMATION'//newline// &
         & '  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME  CLOSED   AUG' &
         & //newline, error, self%resumes)
      if (allocated(error)) return
      call self%cvg%open(self%cvg_path, '', error, self%resumes)
   end subroutine begin

   subroutine commit(self, error)
      class(sta_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%sta%commit(error)
      if (.not. allocated(error)) call self%cvg%commit(error)
   end subroutine commit

   subroutine increment(self, model, frame, error)
      class(sta_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      character(len=100) :: row

      associate (unused => model)
      end associate
      write (row, '(1x,i5,1x,i10,2(1x,i5),3(1x,e13.6),1x,i7,1x,i5)') frame%step, frame%increment, &
         & frame%attempt, frame%iterations, frame%total_time, frame%step_time, &
         & frame%time_increment, &
         & frame%closed, frame%augmentations
      call self%sta%append(trim(row)//newline, error)
      if (.not. allocated(error) .and. allocated(self%trouble)) error = self%trouble
   end subroutine increment

   subroutine keep(self, stream, error)
      class(sta_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      call self%sta%keep(stream, error)
      if (.not. allocated(error)) call self%cvg%keep(stream, error)
   end subroutine keep

   subroutine close_files(self, error)
      class(sta_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: also

      call self%sta%close(error)
      call self%cvg%close(also)
      if (.not. allocated(error)) call move_alloc(also, error)
      if (.not. allocated(error)) call move_alloc(self%trouble, error)
   end subroutine close_files

   subroutine line(self, text)
      class(sta_recorder_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      type(error_type), allocatable :: error

      call self%cvg%append(printable(text)//newline, error)
      if (allocated(error)) call move_alloc(error, self%trouble)
   end subroutine line
end module lopin_recorder_sta
