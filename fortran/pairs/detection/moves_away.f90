!> A sign that is wrong: a tool that only moves away from what it should press.
module lopin_moves_away
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, severity
   use lopin_model, only : model_type, step_type
   use lopin_contact_points, only : contact_points_type
   implicit none
   private
   public :: check_moves_away

   real(wp), parameter :: rounding = 1.0e-9_wp

contains

   !> Points of the last pair. Nothing is said where something else moves or is loaded.
   subroutine check_moves_away(self, model, pair, log)
      type(contact_points_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      real(wp) :: nearer, farther, way
      integer :: s, i, first, at(2)

      if (self%tool(pair) == 0 .or. self%body(pair) == 0) return
      if (model%pair(pair)%tied) return
      if (allocated(model%transform%node)) then
         if (size(model%transform%node) > 0) return
      end if
      nearer = 0.0_wp
      farther = 0.0_wp
      at = 0
      associate (node => model%rigid_body(self%body(pair))%reference, d => model%mesh%ndim)
         do s = 1, size(model%step)
            if (.not. moves_alone(model, model%step(s), node)) return
            do i = self%first(pair), self%n
               if (self%facet(i) == 0) cycle
               if (self%gap(i) < -rounding*self%size(i)) return
               way = approach(model, model%step(s), node, self%normal(:d, i))
               nearer = max(nearer, way)
               farther = max(farther, -way)
            end do
            first = findloc(model%step(s)%prescribed%node == node .and. &
               & abs(model%step(s)%prescribed%value) > 0.0_wp, .true., dim=1)
            if (at(1) == 0 .and. first > 0) at = [s, first]
         end do
      end associate
      if (at(1) == 0 .or. farther <= 0.0_wp .or. nearer > rounding*farther) return
      associate (p => model%pair(pair))
         call log%say(severity%warning, 'W0343', 'tool '//model%surface(p%master)%name// &
            & ' moves away from '//model%surface(p%slave)%name//', which nothing else moves: '// &
            & 'the pair presses nothing', model%step(at(1))%prescribed(at(2))%at, &
            & help='look at the sign of the displacement')
      end associate
   end subroutine check_moves_away

   !> Whether nothing but a reference node moves in a step, and that only as prescribed.
   pure logical function moves_alone(model, step, node) result(alone)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      integer, intent(in) :: node
      integer :: i
      logical :: held(6)

      alone = .false.
      if (size(step%point_load) + size(step%face_load) + size(step%body_load) &
         & + size(step%temperature) > 0) return
      held = .false.
      do i = 1, size(step%prescribed)
         associate (item => step%prescribed(i))
            if (item%node == node) held(item%dof) = .true.
            if (.not. abs(item%value) > 0.0_wp) cycle
            if (item%node /= node .or. item%dof > 3) return
         end associate
      end do
      alone = all(held(:model%mesh%ndim))
   end function moves_alone

   !> The most that the way of a step brings a tool nearer to a point.
   pure real(wp) function approach(model, step, node, normal) result(most)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      integer, intent(in) :: node
      real(wp), intent(in) :: normal(:)        !! out of the tool
      real(wp) :: part
      integer :: i

      most = 0.0_wp
      do i = 1, size(step%prescribed)
         associate (item => step%prescribed(i))
            if (item%node /= node .or. item%dof > size(normal)) cycle
            part = item%value*normal(item%dof)
            if (item%amplitude > 0) part = max( &
               & part*minval(model%amplitude(item%amplitude)%value), &
               & part*maxval(model%amplitude(item%amplitude)%value))
            most = most + part
         end associate
      end do
   end function approach
end module lopin_moves_away
