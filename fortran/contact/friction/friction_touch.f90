!> Slip counts from where a point touched, on the condensed equations.
!>
!> A point whose gap g0 closes at a rate a in the increment touches after the share phi = g0/a of
!> it. Rate and motion are those that the increment leads to with the contacts of its start; of the
!> motion along the master, phi parts come before the touch. A gap that is rounding is none:
!> beside the rounding of its motion it would give any share.
module lopin_friction_touch
   use lopin_kinds, only : wp
   use lopin_condensed, only : condensed_type
   use lopin_friction_rows, only : friction_points_type, form_equations
   use lopin_friction_step, only : trial_type, work_type
   use lopin_friction_tangents, only : step_to
   implicit none
   private
   public :: slip_from_touch, touching

   !> A gap below this share of the facet touches.
   real(wp), parameter :: touching = 1.0e-10_wp

contains

   !> Move the starts of slip of the points that are open at the accepted state `x`.
   subroutine slip_from_touch(self, points, work, x)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(inout) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      type(trial_type) :: next
      logical :: open(points%n)
      real(wp) :: approach
      integer :: k

      points%touch = [(0.0_wp, k=1, points%n)]
      if (.not. allocated(points%open)) return
      open = points%open > 0.0_wp .and. .not. abs(x%force(points%normal)) > 0.0_wp
      if (self%nq == 0) open = open .and. x%gap(points%normal) < points%open
      if (.not. any(open)) return
      next = x
      if (work%cold .and. self%nq > 0) return
      if (.not. work%cold) call lead(self, points, work, x, next)
      if (work%singular) return
      do k = 1, points%n
         if (.not. open(k)) cycle
         approach = points%open(k) - next%gap(points%normal(k))
         if (.not. approach > 0.0_wp) cycle
         points%touch(k) = min(points%open(k)/approach, 1.0_wp)
         associate (from => points%tangent(k), to => points%tangent(k) + points%nt - 1)
            points%start(:, k) = points%start(:, k) + points%touch(k)*(next%gap(from:to) &
               & - points%start(:, k))
         end associate
      end do
   end subroutine slip_from_touch

   !> Where the increment leads if no further point closes.
   subroutine lead(self, points, work, x, next)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      type(trial_type), intent(out) :: next
      type(trial_type) :: before
      integer :: dependent

      dependent = work%dependent
      before = x
      before%gap = work%old_gap
      work%equations%set = abs(x%force) > 0.0_wp
      call form_equations(work%equations, self, points, before%force, before%gap)
      call step_to(self, points, work, before, next)
      deallocate (work%equations%set)
      work%dependent = dependent
   end subroutine lead
end module lopin_friction_touch
