!> The set of contact by the energy of the forces, one row at a time.
!>
!> The forces of contact are the least of a convex function, half their product with the compliance
!> and with the gaps that the loads leave, among forces that press. From forces that press, each
!> solve on a set is the least on that set; the way to it ends where a force vanishes, whose row
!> leaves; at the least of a set the deepest open row joins. The energy falls from set to set, so
!> that none comes back (Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23), and
!> the pivots are about as many as the rows. Rows held both ways and laws of pressure, whose
!> springs Newton renews at the end, bound nothing.
module lopin_least_energy
   use lopin_kinds, only : wp
   use lopin_condensed, only : condensed_type
   use lopin_contact_result, only : contact_result_type, work_type
   use lopin_set_state, only : find_wrong, linearise, laws_met
   implicit none
   private
   public :: lower_energy

contains

   !> From the answer on `result%active`; `stuck` if rounding leaves no row to change.
   subroutine lower_energy(self, work, result, stuck)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      logical, intent(out) :: stuck
      logical :: pressing(self%nrow), wrong(self%nrow), refused(self%nrow)
      real(wp) :: force(self%nrow)
      integer :: pass, joined, status

      stuck = .true.
      pressing = rows_that_press(self)
      result%active = result%active .and. (work%answer%force > 0.0_wp .or. .not. pressing)
      force = merge(work%answer%force, 0.0_wp, result%active .or. .not. pressing)
      refused = .false.
      joined = 0
      do pass = 1, 60 + 10*self%nrow
         call descend(self, work, result, pressing, force, status)
         if (status /= 0) return
         if (joined > 0) then
            ! Taken back at once: that it penetrates is rounding of the answer.
            refused = refused .and. .not. result%active(joined)
            refused(joined) = .not. result%active(joined)
         end if
         call find_wrong(self, work, result, wrong)
         joined = 0
         if (any(wrong)) then
            joined = deepest(self, work, result, wrong .and. .not. refused)
            if (joined == 0) return
            result%active(joined) = .true.
            result%single_pivots = result%single_pivots + 1
         else
            stuck = .not. laws_met(self, work, result)
            if (.not. stuck) return
            call linearise(self, work, result, by_set=.false.)
         end if
      end do
   end subroutine lower_energy

   !> To the least energy on the set: rows whose force vanishes on the way leave it.
   subroutine descend(self, work, result, pressing, force, status)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      logical, intent(in) :: pressing(:)
      real(wp), intent(inout) :: force(:)          !! (nrow) where pressing: >= 0, 0 out of the set
      integer, intent(out) :: status
      real(wp) :: share(self%nrow), step
      logical :: ends(self%nrow)

      do
         call linearise(self, work, result, by_set=.true.)
         call self%solve_set(result%active, work%spring, work%compliance, work%springs, &
            & work%answer, status)
         result%iterations = result%iterations + 1
         if (status /= 0) return
         ends = pressing .and. result%active .and. .not. work%answer%force > 0.0_wp
         if (.not. any(ends)) exit
         share = 0.0_wp
         where (ends .and. force > 0.0_wp) share = force/(force - work%answer%force)
         step = minval(share, mask=ends)
         force = force + step*(work%answer%force - force)
         ends = ends .and. .not. share > step
         where (ends) force = 0.0_wp
         result%active = result%active .and. .not. ends
         result%single_pivots = result%single_pivots + 1
      end do
      force = work%answer%force
   end subroutine descend

   !> The row that penetrates most, beyond what its own spring explains; 0: none.
   integer function deepest(self, work, result, among) result(row)
      class(condensed_type), intent(in) :: self
      type(work_type), intent(in) :: work
      type(contact_result_type), intent(in) :: result
      logical, intent(in) :: among(:)
      real(wp) :: depth(self%nrow)

      row = 0
      if (.not. any(among)) return
      depth = -work%answer%gap
      where (work%spring) depth = depth + result%multiplier/max(self%alpha, tiny(1.0_wp))
      row = maxloc(depth, 1, among)
   end function deepest

   !> Rows whose force presses or is none: the set decides. The others: held both ways, or a law.
   function rows_that_press(self) result(pressing)
      class(condensed_type), intent(in) :: self
      logical :: pressing(self%nrow)
      integer :: group

      do group = 1, self%ngroup
         associate (from => self%group_first(group), to => self%group_first(group + 1) - 1)
            pressing(from:to) = .not. self%bilateral(from:to) &
               & .and. (self%group(group)%method%solves_for_multiplier() &
               & .or. self%group(group)%method%piecewise_linear())
         end associate
      end do
   end function rows_that_press
end module lopin_least_energy
