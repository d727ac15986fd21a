!> Keeps the last increment: for callers that look at one answer.
module lopin_recorder_last
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_type
   use lopin_report, only : frame_type
   implicit none
   private
   public :: last_recorder_type

   type, extends(recorder_type) :: last_recorder_type
      type(frame_type) :: frame
   contains
      procedure :: begin
      procedure :: increment
   end type last_recorder_type

contains

   subroutine begin(self, model, error)
      class(last_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (unused => self, also => model, too => error)
      end associate
   end subroutine begin

   subroutine increment(self, model, frame, error)
      class(last_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error

      associate (unused => model, also => error)
      end associate
      self%frame = frame
   end subroutine increment
end module lopin_recorder_last
