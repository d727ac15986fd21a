!> Ties between supports: where these hold a slave node and most of what it is tied to, rows depend
!> on each other, and nothing decides how the tractions between them are shared out.
!>
!> Displacements, forces of elements and reactions as sums are right; a traction there may be any
!> number. A tie transmits what elements bear: no more than some of their forces on a node.
module lopin_undecided_ties
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_undecided_ties

   !> Times the largest force of an element on a node.
   real(wp), parameter :: too_much = 100.0_wp

contains

   !> Look at an accepted increment of the nonlinear path.
   subroutine check_undecided_ties(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical :: free(scene%newton%contact%n)
      integer :: i, first

      if (.not. scene%newton%element_force > 0.0_wp) return
      associate (c => scene%newton%contact)
         do i = 1, c%n
            free(i) = c%enforcement(i)%tied
            if (free(i)) free(i) = norm2(c%traction(:, i))*abs(c%weight(i)) &
               & > too_much*scene%newton%element_force
         end do
         first = findloc(free, .true., dim=1)
         if (first == 0) return
         call warn_once(scene%log, 'W0346', to_text(count(free))//' tied nodes, first '// &
            & to_text(model%mesh%node_label(c%node(first)))//' of pair ('// &
            & model%surface(model%pair(c%pair(first))%slave)%name//'), have tractions that '// &
            & 'nothing decides: supports hold both sides of the tie there, or other ties do', &
            & model%pair(c%pair(first))%at, help='read no traction of the tie at these nodes; '// &
            & 'or leave out the supports of its slave side, or one of ties in a ring')
      end associate
   end subroutine check_undecided_ties
end module lopin_undecided_ties
