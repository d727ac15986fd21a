!> What the factor of the nonlinear path makes of ties, said when it is known: after an increment.
module lopin_tell_ties
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_holder_type
   use lopin_scene, only : scene_type
   use lopin_run_type, only : run_type
   use lopin_tell_watcher, only : tell_of_plan
   implicit none
   private
   public :: tell_of_ties

contains

   !> A line, and the end of the plan, when it is new.
   subroutine tell_of_ties(run, model, recorders)
      class(run_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(recorder_holder_type), intent(inout) :: recorders(:)
      character(len=:), allocatable :: line
      integer :: i, before

      line = ties_line(run%scene)
      if (line == '') return
      before = index(run%summary%plan, '; ties: ')
      if (before > 0) then
         if (run%summary%plan(before + 2:) == line) return
         run%summary%plan = run%summary%plan(:before - 1)
      end if
      run%summary%plan = run%summary%plan//'; '//line
      do i = 1, size(recorders)
         call recorders(i)%recorder%line(line)
      end do
      call tell_of_plan(run%scene, model, line)
   end subroutine tell_of_ties

   !> How many displacements of slave nodes are eliminated, and why other rows stay; '' without any.
   function ties_line(scene) result(line)
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: line
      integer :: b, d, rows, gone, held, far, together

      line = ''
      gone = 0
      held = 0
      far = 0
      together = 0
      if (.not. allocated(scene%newton%system%block)) return
      do b = 1, size(scene%newton%system%block)
         associate (block => scene%newton%system%block(b))
            if (.not. allocated(block%glue)) cycle
            d = size(block%reach, 1)
            rows = d - nint(sum([block%glue%give(1, 1), block%glue%give(2, 2), &
               & block%glue%give(3, 3)])*block%glue%c)
            if (.not. allocated(block%share)) then
               far = far + rows
            else if (block%tied) then
               gone = gone + count(block%own > 0)
               held = held + rows - count(block%own > 0)
            else if (any(block%own > 0)) then
               together = together + rows
            else
               held = held + rows
            end if
         end associate
      end do
      if (gone + held + far + together == 0) return
      line = 'ties: '//to_text(gone)//' displacements of slave nodes eliminated'
      if (gone == 0) line = 'ties: no displacements of slave nodes eliminated'
      if (held + far + together == 0) return
      line = line//', '//to_text(held + far + together)//' rows stay ('
      if (held > 0) line = line//to_text(held)//' where supports, equations or local axes bear '// &
         & 'on the slave node, '
      if (far > 0) line = line//to_text(far)//' whose sides are far apart, '
      if (together > 0) line = line//to_text(together)//' that depend on each other, '
      line = line(:len(line) - 2)//')'
   end function ties_line
end module lopin_tell_ties
