!> An increment in which a body passes through another or through a tool is not accepted.
module lopin_refuse_passage
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_nonlinear_sweep, only : find_passage
   use lopin_tool_sweep, only : find_tool_passage
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   use lopin_contact_rows, only : joins_pair
   implicit none
   private
   public :: refuse_passage, passage_id

   character(len=*), parameter :: passage_id = 'E0550'

contains

   subroutine refuse_passage(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: closed(scene%points%n), lost
      integer :: passed, pair, node, row

      if (scene%newton%in_use) then
         call find_passage(scene%newton%contact, model, scene%accepted%motion%u, &
            & scene%trial%motion%u, passed, lost, &
            & error)
         if (allocated(error) .or. passed == 0) return
         pair = scene%newton%contact%pair(passed)
         node = scene%newton%contact%node(passed)
      else
         closed = .false.
         do row = 1, scene%rows%n
            if (.not. joins_pair(scene%rows, row)) cycle
            if (scene%answer%active(row)) closed(scene%rows%point(row)) = .true.
         end do
         call find_tool_passage(scene%points, model, scene%dofs, scene%accepted%motion%u, &
            & scene%trial%motion%u, closed, &
            & passed, lost)
         if (passed == 0) return
         pair = scene%points%pair(passed)
         node = scene%points%node(passed)
      end if
      associate (step => model%step(scene%step), text => 'node '// &
         & to_text(model%mesh%node_label(node))//' of '// &
         & model%surface(model%pair(pair)%slave)%name//' passes through '// &
         & model%surface(model%pair(pair)%master)%name//' within an increment of step '// &
         & to_text(scene%step))
         if (step%direct .and. .not. lost) then
            ! What it meets in the end is known; how it came there is not.
            call warn_once(scene%log, 'W0550', text, step%at, help='smaller increments on *STATIC')
         else
            call raise(error, error_code%not_converged, passage_id, text, step%at, &
               & help='smaller increments on *STATIC: the motion of an increment jumps over '// &
               & 'what lies in its way')
         end if
      end associate
   end subroutine refuse_passage
end module lopin_refuse_passage
