!> Slave nodes that leave their master within an increment, past its edge, and press to its end.
!>
!> Which nodes have rows of a surface-to-surface pair is decided between increments
!> (lopin_mortar_cover). A node that is taken far beyond the edge in one increment holds its facet
!> straight there, as if the master went on: a block pressed between dies gave 6 % too much force,
!> at ten times the pressure of its neighbours.
module lopin_refuse_lost_rows
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_mortar_cover, only : find_late
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: refuse_lost_rows, lost_row_id

   character(len=*), parameter :: lost_row_id = 'E0517'
   !> An increment is cut to no less; so often in a row.
   real(wp), parameter :: least_part = 0.25_wp
   integer, parameter :: most_cuts = 5

contains

   !> Before an increment is accepted: whether it must end where a node leaves.
   subroutine refuse_lost_rows(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: pair, node
      real(wp) :: part

      if (.not. scene%may_cut .or. scene%newton%attempt > most_cuts) return
      associate (c => scene%newton%contact)
         do pair = 1, size(c%mortar)
            if (.not. (c%mortar(pair)%is_on .and. c%pair_active(pair))) cycle
            call find_late(c%mortar(pair)%cover, node, part)
            if (node == 0) cycle
            scene%newton%fit = max(least_part, part)
            call raise(error, error_code%not_converged, lost_row_id, 'node '//to_text( &
               & model%mesh%node_label(c%mortar(pair)%slave%node(node)))//' of '// &
               & model%surface(model%pair(pair)%slave)%name//' goes past the edge of '// &
               & model%surface(model%pair(pair)%master)%name//' in one increment', &
               & model%step(scene%step)%at, help='smaller increments on *STATIC')
            return
         end do
      end associate
   end subroutine refuse_lost_rows
end module lopin_refuse_lost_rows
