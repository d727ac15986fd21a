!> The contract of recorders: called once before the first step, after each accepted increment, and
!> at the end.
!>
!> In the order of a run: all recorders `begin`, then all `commit`; `increment` and `line` as they
!> come; all `close`, and when it is known whether all that was written is on the disk, all
!> `finish`.
!>
!> Recorders never change the run: what they are given is read only, and a recorder that fails
!> returns an error which ends the run with the files complete up to the last increment.
module lopin_recorder
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_report, only : frame_type, summary_type
   implicit none
   private
   public :: recorder_type, recorder_holder_type, wants_type

   !> What some recorder will read of a frame; the rest is not computed.
   type :: wants_type
      logical :: stress = .false., strain = .false., nodal_stress = .false.
   end type wants_type

   type, abstract :: recorder_type
      logical :: resumes = .false.   !! `begin` leaves files as they are; `keep` cuts them
   contains
      procedure(begin_if), deferred :: begin
      procedure(increment_if), deferred :: increment
      procedure :: commit => nothing_to_do
      procedure :: close => nothing_to_do
      procedure :: finish => no_summary
      procedure :: line => no_line
      procedure :: keep => keep_nothing
      procedure :: wants => wants_nothing
   end type recorder_type

   type :: recorder_holder_type
      class(recorder_type), allocatable :: recorder
   end type recorder_holder_type

   abstract interface
      subroutine begin_if(self, model, error)
         import :: recorder_type, model_type, error_type
         class(recorder_type), intent(inout) :: self
         type(model_type), intent(in) :: model
         type(error_type), allocatable, intent(out) :: error
      end subroutine begin_if

      subroutine increment_if(self, model, frame, error)
         import :: recorder_type, model_type, frame_type, error_type
         class(recorder_type), intent(inout) :: self
         type(model_type), intent(in) :: model
         type(frame_type), intent(in) :: frame
         type(error_type), allocatable, intent(out) :: error
      end subroutine increment_if
   end interface

contains

   !> `commit`: what was begun replaces the files of an earlier run. `close`: nothing more comes,
   !> and what was written is on the disk.
   subroutine nothing_to_do(self, error)
      class(recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      associate (unused => self, none => error)
      end associate
   end subroutine nothing_to_do

   !> Called once, also after a failure: `failure` then holds what went wrong.
   subroutine no_summary(self, model, summary, failure, error)
      class(recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: failure
      type(error_type), allocatable, intent(out) :: error
      associate (unused => self, also => model, too => summary, and => failure, none => error)
      end associate
   end subroutine no_summary

   !> One line of the run's log (plan, iteration, warning): ignored unless a recorder overrides it.
   subroutine no_line(self, text)
      class(recorder_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      associate (unused => self, also => text)
      end associate
   end subroutine no_line

   !> What it carries from increment to increment, to a stream; or back, after `begin`: files are
   !> cut to what they were then.
   subroutine keep_nothing(self, stream, error)
      class(recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      associate (unused => self, also => stream, none => error)
      end associate
   end subroutine keep_nothing

   !> What this recorder reads in the increment to come.
   function wants_nothing(self, model, frame) result(wants)
      class(recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame   !! step, increment, times and last_of_step are set
      type(wants_type) :: wants
      associate (unused => self, also => model, too => frame)
         wants = wants_type()
      end associate
   end function wants_nothing
end module lopin_recorder
