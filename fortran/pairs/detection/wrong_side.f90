!> Pairs whose slave lies behind its master: described the wrong way round.
!>
!> A slave node is behind where it looks out of the master from inside it. A curved tool with its
!> solid side out has nodes inside it that look along its surface, and that no closer look finds
!> opposite; as the slave turns they would be pressed, by their whole depth. So what counts is that
!> some nodes are behind the tool itself, and none is in front.
module lopin_wrong_side
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_contact_points, only : contact_points_type, facing
   implicit none
   private
   public :: count_behind

   !> Of a facet: nearer is not in front.
   real(wp), parameter :: met = 1.0e-3_wp

contains

   !> Nodes of the last pair, none of which has the master opposite, and those behind it.
   subroutine count_behind(self, model, pair, nodes, behind, wrong)
      type(contact_points_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      integer, intent(out) :: nodes, behind
      logical, intent(out) :: wrong            !! the master shows its wrong side
      logical :: out, is_new, known, inside, front
      integer :: i

      nodes = 0
      behind = 0
      known = .false.
      inside = .false.
      front = .false.
      do i = self%first(pair), self%n
         is_new = i == self%first(pair)
         if (.not. is_new) is_new = self%node(i) /= self%node(i - 1)
         if (is_new) then
            nodes = nodes + 1
            known = .false.
         end if
         if (.not. any(abs(self%normal(:, i)) > 0.0_wp)) cycle
         if (.not. self%gap(i) < met*self%size(i)) then
            front = .true.
            cycle
         end if
         out = dot_product(self%side(:, i), self%normal(:, i)) > -facing
         if (out .and. .not. known) behind = behind + 1
         known = known .or. out
         inside = inside .or. (out .and. .not. is_past_end(self, model, i))
      end do
      wrong = behind > 0 .and. (behind == nodes .or. (inside .and. .not. front))
   end subroutine count_behind

   !> The foot of a point is an open end that it lies beyond.
   pure logical function is_past_end(self, model, i)
      type(contact_points_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      real(wp) :: arm(3)

      arm = -self%foot(:, i)
      arm(:model%mesh%ndim) = arm(:model%mesh%ndim) + model%mesh%x(:, self%node(i))
      arm = arm - dot_product(arm, self%normal(:, i))*self%normal(:, i)
      is_past_end = norm2(arm) > met*self%size(i)
   end function is_past_end
end module lopin_wrong_side
