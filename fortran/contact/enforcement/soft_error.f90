!> Estimate of the pressure error that penetration causes in penalty methods.
module lopin_soft_error
   use lopin_kinds, only : wp
   use lopin_soft_share, only : largest_share
   use lopin_condensed, only : condensed_type, response_type
   use lopin_contact_result, only : contact_result_type, work_type
   implicit none
   private
   public :: estimate_soft_error

contains

   !> One augmentation of all rows that allow penetration, on the set found: what it changes is the
   !> error of their forces to a few per cent (measured in docs/theory.md). Costs back-solves only.
   subroutine estimate_soft_error(self, work, result)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      type(response_type) :: once
      logical :: soft(self%nrow)
      real(wp) :: size_
      integer :: group, from, to, status

      result%soft_error = 0.0_wp
      result%softness = 0.0_wp
      do group = 1, self%ngroup
         from = self%group_first(group)
         to = self%group_first(group + 1) - 1
         soft(from:to) = self%group(group)%method%piecewise_linear() &
            & .and. (work%spring(from:to) .or. work%compliance(from:to) > 0.0_wp)
      end do
      size_ = norm2(pack(result%force, soft))
      if (.not. size_ > 0.0_wp) return
      once = work%answer
      where (soft .and. work%spring .and. result%active) work%springs%offset = result%force
      where (soft .and. .not. work%spring) once%free_gap = once%free_gap &
         & - work%compliance*result%force
      once%gap0 = once%gap0 + (once%free_gap - work%answer%free_gap)
      call self%solve_set(result%active, work%spring, work%compliance, work%springs, once, status)
      ! A set that cannot be solved once more has lost all its digits.
      result%soft_error = 1.0_wp
      result%softness = 1.0_wp
      if (status /= 0) return
      result%softness = largest_share(once%force - result%force, result%force, self%group_first)
      result%soft_error = max(norm2(pack(once%force - result%force, soft))/size_, result%softness)
   end subroutine estimate_soft_error
end module lopin_soft_error
