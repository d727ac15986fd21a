!> What the answer on a set says about the set: rows in the wrong state, laws of pressure not met.
module lopin_set_state
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_condensed, only : condensed_type
   use lopin_contact_result, only : contact_result_type, work_type
   implicit none
   private
   public :: set_tolerance, find_wrong, linearise, laws_met

   !> A gap or a force this small beside what it is made of is zero.
   real(wp), parameter :: set_tolerance = 1.0e-12_wp

contains

   !> Rows in the wrong state: pressing rows that pull, open rows that penetrate.
   subroutine find_wrong(self, work, result, wrong)
      class(condensed_type), intent(in) :: self
      type(work_type), intent(in) :: work
      type(contact_result_type), intent(in) :: result
      logical, intent(out) :: wrong(:)
      real(wp) :: small_force, small_gap, force
      integer :: row, group
      logical :: linear

      small_force = set_tolerance*largest(work%answer%force)
      small_gap = set_tolerance*max(work%gap_scale, largest(work%answer%gap))
      do group = 1, self%ngroup
         linear = self%group(group)%method%piecewise_linear()
         do row = self%group_first(group), self%group_first(group + 1) - 1
            wrong(row) = .false.
            if (self%bilateral(row)) cycle
            if (.not. work%spring(row)) then
               wrong(row) = merge(work%answer%force(row) < -small_force, &
                  & work%answer%gap(row) < -small_gap, &
                  & result%active(row))
            else if (linear) then
               force = result%multiplier(row) - self%alpha(row)*work%answer%gap(row)
               wrong(row) = merge(force < -small_force, &
                  & force > max(small_force, self%alpha(row)*small_gap), result%active(row))
            end if
         end do
      end do
   end subroutine find_wrong

   !> Springs about the current gaps; those that are linear while closed follow the set.
   subroutine linearise(self, work, result, by_set)
      class(condensed_type), intent(in) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(in) :: result
      logical, intent(in) :: by_set
      real(wp) :: force(self%nrow)
      integer :: group, from, to

      if (.not. any(work%spring)) return
      do group = 1, self%ngroup
         from = self%group_first(group)
         to = self%group_first(group + 1) - 1
         if (to < from) cycle
         if (.not. work%spring(from)) cycle
         if (self%group(group)%method%piecewise_linear()) then
            work%springs%stiffness(from:to) = merge(self%alpha(from:to), 0.0_wp, &
               & result%active(from:to))
            work%springs%offset(from:to) = merge(result%multiplier(from:to), 0.0_wp, &
               & result%active(from:to))
         else if (.not. by_set .or. result%iterations == 0) then
            call self%group(group)%method%forces(work%answer%gap(from:to), self%alpha(from:to), &
               & result%multiplier(from:to), self%bilateral(from:to), force(from:to), &
               & work%springs%stiffness(from:to))
            work%springs%offset(from:to) = force(from:to) &
               & + work%springs%stiffness(from:to)*work%answer%gap(from:to)
         end if
      end do
   end subroutine linearise

   !> The forces found are those of the laws at the gaps found.
   logical function laws_met(self, work, result)
      class(condensed_type), intent(in) :: self
      type(work_type), intent(in) :: work
      type(contact_result_type), intent(in) :: result
      real(wp) :: force(self%nrow), stiffness(self%nrow), off
      integer :: group, from, to

      laws_met = .true.
      do group = 1, self%ngroup
         from = self%group_first(group)
         to = self%group_first(group + 1) - 1
         if (self%group(group)%method%piecewise_linear() .or. to < from) cycle
         call self%group(group)%method%forces(work%answer%gap(from:to), self%alpha(from:to), &
            & result%multiplier(from:to), self%bilateral(from:to), force(from:to), &
            & stiffness(from:to))
         off = largest(force(from:to) - work%answer%force(from:to))
         laws_met = laws_met .and. off <= 1.0e-11_wp*largest(force(from:to))
      end do
   end function laws_met
end module lopin_set_state
