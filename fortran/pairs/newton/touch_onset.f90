!> Slip counts from where a point touched: what it moved along its master before is none.
!>
!> A point whose gap g0 closes at a rate a in the increment touches after the share phi = g0/a of
!> it. Rate and motion are those that the increment leads to before further contacts close, which
!> the first step of Newton gives, or the guess that it starts from; so bodies and tools may move as
!> they like. Of that motion, phi parts come before the touch. A gap that is rounding is none:
!> beside the rounding of its motion it would give any share.
module lopin_touch_onset
   use lopin_kinds, only : wp
   use lopin_friction, only : has_friction
   use lopin_friction_touch, only : touching
   use lopin_nonlinear_samples, only : row_value
   use lopin_gap_path, only : meet
   use lopin_nonlinear_faces, only : start_gap_of
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   implicit none
   private
   public :: start_approach, may_touch, note_approach

contains

   !> Gaps where the increment begins; every point is taken to touch already.
   pure subroutine start_approach(self)
      type(nonlinear_contact_type), intent(inout) :: self
      integer :: i

      self%noted = 0.0_wp
      self%ahead = 1.0_wp
      self%touch = 0.0_wp
      self%waits = .false.
      do i = 1, self%n
         self%start_gap(i) = huge(1.0_wp)
         if (self%opposite(i)%facet == 0) cycle
         self%start_gap(i) = self%opposite(i)%found%gap
         if (self%masters%of(self%pair(i))%tool > 0) self%start_gap(i) = self%opposite(i)%foot%gap
      end do
      if (size(self%face) == 0) return
      if (.not. allocated(self%start_row)) allocate (self%start_row(self%n))
      do i = 1, self%n
         self%start_row(i) = start_gap_of(self%opposite(i), nodes_start(self, i))
      end do
   end subroutine start_approach

   !> A point with friction that was open where the increment began.
   pure logical function may_touch(self, i)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      may_touch = self%noted > 0.0_wp .and. self%start_gap(i) < huge(1.0_wp) &
         & .and. .not. any(abs(self%enforcement(i)%committed) > 0.0_wp) .and. &
         & .not. self%enforcement(i)%tied .and. has_friction(self%friction(self%pair(i)))
   end function may_touch

   !> The motion before the touch, from the evaluation of the point at the noted share of the way;
   !> whether it changes what the point does.
   pure subroutine note_approach(self, i, shift, changes)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: shift            !! added to the gap [length]
      logical, intent(out) :: changes
      real(wp) :: open, approach, phi, left, arm(3)

      associate (t => self%trial(i))
         open = row_start(self, i) + shift
         approach = (open - (t%gap + shift))/self%noted
         phi = 0.0_wp
         left = open
         if (open > touching*self%size(i)) call meet(self%path, i, open, approach, phi, left)
         self%touch(i) = phi
         ! What the kernels call slip is counted from the foot: it holds the arm to it.
         arm = self%start_gap(i)*self%start_normal(:, i)
         self%enforcement(i)%approach = arm + phi/self%noted*(t%slip - (arm - dot_product(arm, &
            & t%normal)*t%normal)) - (open - left)*t%normal
      end associate
      changes = any(abs(self%enforcement(i)%approach) > 0.0_wp)
   end subroutine note_approach

   !> The gap of a row where the increment begins [length].
   pure real(wp) function row_start(self, i) result(gap)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      if (size(self%face) > 0) then
         gap = self%start_row(i)
      else
         gap = nodes_start(self, i)
      end if
   end function row_start

   !> The same without points inside facets.
   pure real(wp) function nodes_start(self, i) result(gap)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      gap = self%start_gap(i)
      if (.not. self%share(i) > 0.0_wp) return
      if (all(self%start_gap(self%corner(:, i)) < huge(1.0_wp))) gap = row_value(self, i, &
         & self%start_gap)
   end function nodes_start
end module lopin_touch_onset
