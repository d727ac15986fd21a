!> Which points touch: the primal-dual active set on the condensed contact problem.
!>
!> Each pass solves on a set and changes every row that is in the wrong state. Where that stops
!> making progress, one row at a time is changed so that the energy falls (lopin_least_energy).
!> Bodies that only contact holds are treated exactly; where no set on the way holds them, proximal
!> steps on their motions find the set or the motion that escapes.
module lopin_active_set
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_condensed, only : condensed_type, is_spring, row_compliance, add_ground_springs, &
      & hold_at_rest
   use lopin_contact_result, only : contact_result_type, work_type, outcome
   use lopin_soft_error, only : estimate_soft_error
   use lopin_set_state, only : set_tolerance, find_wrong, linearise, laws_met
   use lopin_least_energy, only : lower_energy
   implicit none
   private
   public :: contact_result_type, solve_contact, outcome

   !> Multipliers that move by less of the largest force have settled.
   real(wp), parameter :: settled = 1.0e-10_wp
   !> Newton on laws of pressure, from the gaps on soft ground.
   integer, parameter :: most_law_passes = 60

contains

   !> Solve for gaps without displacement, condensed loads and loads on the floating motions.
   subroutine solve_contact(self, gap0, load, moving, result)
      class(condensed_type), intent(inout) :: self
      real(wp), intent(in) :: gap0(:)      !! (nrow) [length]
      real(wp), intent(in) :: load(:)      !! (n) [force]
      real(wp), intent(in) :: moving(:)    !! (nq) [force]
      type(contact_result_type), intent(inout) :: result
      type(work_type) :: work
      real(wp) :: moved, last, size_
      integer :: pass

      call prepare(self, gap0, load, moving, work, result)
      last = 0.0_wp
      size_ = 0.0_wp
      do pass = 1, max(1, maxval(self%max_augmentations))
         call settle(self, work, result)
         if (result%outcome /= outcome%solved) return
         ! Forces that fade altogether are measured by what they were.
         size_ = max(size_, largest(result%force))
         call update_multipliers(self, result, moved)
         if (.not. moved > 0.0_wp) exit
         result%augmentations = pass
         if (augmented_enough(self, result, moved, last, size_, work%gap_scale)) exit
         last = moved
         if (pass == max(1, maxval(self%max_augmentations))) result%outcome = outcome%not_augmented
      end do
      if (result%outcome /= outcome%solved) return
      if (result%augmentations > 0 .and. largest(result%force) <= settled*size_) then
         ! What is left of forces that faded is round-off, not contact.
         result%force = 0.0_wp
         result%multiplier = 0.0_wp
         result%opening = 0.0_wp
      end if
      call estimate_soft_error(self, work, result)
   end subroutine solve_contact

   subroutine prepare(self, gap0, load, moving, work, result)
      class(condensed_type), intent(inout) :: self
      real(wp), intent(in) :: gap0(:), load(:), moving(:)
      type(work_type), intent(out) :: work
      type(contact_result_type), intent(inout) :: result
      logical :: warm

      work%spring = is_spring(self)
      work%compliance = row_compliance(self)
      warm = allocated(result%active)
      if (warm) warm = size(result%active) == self%nrow
      work%answer%gap0 = gap0
      work%answer%load = load
      work%answer%moving = moving
      call self%free_gaps(gap0, load, .not. warm, work%answer%free_gap)
      allocate (work%answer%force(self%nrow), work%answer%q(self%nq), source=0.0_wp)
      work%answer%gap = work%answer%free_gap
      work%gap_scale = largest(gap0) + largest(work%answer%free_gap - gap0)
      allocate (work%springs%offset(self%nrow), work%springs%stiffness(self%nrow), source=0.0_wp)
      if (.not. warm) then
         result%active = work%answer%free_gap < 0.0_wp .or. self%has_rigid_motions()
         call close_held(self, work%answer%free_gap, result%active)
         result%multiplier = spread(0.0_wp, 1, self%nrow)
      end if
      result%active = result%active .or. self%bilateral
      result%outcome = outcome%solved
      result%iterations = 0
      result%augmentations = 0
      result%single_pivots = 0
   end subroutine prepare

   !> Rows that nothing moves are closed if they touch: what they share with supports is then told.
   subroutine close_held(self, gap, active)
      class(condensed_type), intent(in) :: self
      real(wp), intent(in) :: gap(:)           !! (nrow) without contact forces [length]
      logical, intent(inout) :: active(:)
      integer :: row

      if (.not. allocated(self%s)) return
      do row = 1, self%nrow
         if (.not. gap(row) > 0.0_wp .and. .not. self%s(row, row) > 0.0_wp) active(row) = .true.
      end do
   end subroutine close_held

   !> Settle the sets, with the proximal steps where the bodies are not held on the way.
   subroutine settle(self, work, result)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      real(wp) :: opened(self%nrow)
      logical :: stuck

      if (allocated(self%held)) deallocate (self%held)
      call iterate_sets(self, work, result, stuck)
      if (stuck) then
         if (self%nq > 0) then
            call hold_bodies(self, work, result)
         else
            result%outcome = outcome%cycling
         end if
      end if
      result%force = work%answer%force
      result%gap = work%answer%gap
      if (allocated(work%answer%u)) result%u = work%answer%u
      if (result%outcome == outcome%solved) then
         result%q = work%answer%q
         opened = result%gap - work%answer%free_gap
         if (self%nq > 0) opened = opened - matmul(self%c, result%q)
         ! Forces that are rounding themselves are no measure.
         result%opening = max(largest(opened), 1.0e-6_wp*work%gap_scale)
      end if
      result%dependent = work%answer%dependent
   end subroutine settle

   !> Solve, change the wrong rows, repeat; `stuck` if no progress is possible this way.
   subroutine iterate_sets(self, work, result, stuck)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      logical, intent(out) :: stuck
      logical :: wrong(self%nrow)
      integer :: pass, best, patience, nwrong, status

      best = self%nrow + 1
      patience = 5
      stuck = .false.
      call linearise(self, work, result, by_set=.true.)
      do pass = 1, 60 + 10*self%nrow
         result%iterations = result%iterations + 1
         call self%solve_set(result%active, work%spring, work%compliance, work%springs, &
            & work%answer, status)
         if (status /= 0) exit
         call find_wrong(self, work, result, wrong)
         nwrong = count(wrong)
         if (nwrong == 0) then
            if (laws_met(self, work, result)) return
            call linearise(self, work, result, by_set=.false.)
            cycle
         end if
         patience = merge(5, patience - 1, nwrong < best)
         best = min(best, nwrong)
         if (patience <= 0) then
            if (self%has_rigid_motions()) exit
            call lower_energy(self, work, result, stuck)
            return
         end if
         result%active = result%active .neqv. wrong
         call linearise(self, work, result, by_set=.true.)
      end do
      stuck = .true.
   end subroutine iterate_sets

   subroutine update_multipliers(self, result, moved)
      class(condensed_type), intent(in) :: self
      type(contact_result_type), intent(inout) :: result
      real(wp), intent(out) :: moved
      real(wp) :: change(self%nrow)
      integer :: group, from, to

      do group = 1, self%ngroup
         from = self%group_first(group)
         to = self%group_first(group + 1) - 1
         call self%group(group)%method%update(result%force(from:to), result%multiplier(from:to), &
            & change(from:to))
      end do
      moved = largest(change)
   end subroutine update_multipliers

   !> The multipliers' error, estimated from their contraction, is below round-off's reach, or every
   !> group accepts its penetration.
   logical function augmented_enough(self, result, moved, last, size_, gap_scale) result(enough)
      class(condensed_type), intent(in) :: self
      type(contact_result_type), intent(inout) :: result
      real(wp), intent(in) :: moved, last
      real(wp), intent(in) :: size_        !! largest force of all passes [force]
      real(wp), intent(in) :: gap_scale    !! what gaps are differences of [length]
      integer :: group
      logical :: accepted

      enough = .false.
      if (last > 0.0_wp) then
         result%rate = min(moved/last, 0.999_wp)
         enough = moved*result%rate <= settled*(1.0_wp - result%rate)*size_
      end if
      ! Started from multipliers that are right, the first change is rounding already and contracts
      ! no more.
      enough = enough .or. moved <= min(1.0e2_wp*epsilon(1.0_wp)*largest(self%alpha)*gap_scale, &
         & 1.0e-6_wp*largest(result%force))
      accepted = .true.
      do group = 1, self%ngroup
         if (self%max_augmentations(group) == 0) cycle
         associate (from => self%group_first(group), to => self%group_first(group + 1) - 1)
            accepted = accepted .and. self%penetration(group) > 0.0_wp &
               & .and. .not. any(-result%gap(from:to) > self%penetration(group))
         end associate
      end do
      enough = enough .or. accepted
   end function augmented_enough

   !> Proximal steps: each gives the floating motions a soft ground that follows them, from where
   !> the bodies were. The sets found that way are tried without ground, and with those motions at
   !> rest that nothing resists and nothing drives. If the forces never balance, nothing holds.
   subroutine hold_bodies(self, work, result)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      type(condensed_type) :: grounded
      type(work_type) :: soft
      type(contact_result_type) :: trial
      real(wp) :: ground(self%nq), q(self%nq), drift(self%nq), last(self%nq)
      integer :: pass
      logical :: stuck

      call add_ground_springs(self, grounded, ground)
      q = 0.0_wp
      if (allocated(self%rest)) q = self%rest
      drift = 0.0_wp
      trial = result
      trial%active = .true.
      do pass = 1, 60
         call prepare(grounded, work%answer%gap0, [work%answer%load, work%answer%moving &
            & + ground*q], &
            & [real(wp) ::], soft, trial)
         call iterate_sets(grounded, soft, trial, stuck)
         result%iterations = result%iterations + trial%iterations
         if (stuck) exit
         result%active = trial%active
         work%answer%gap = soft%answer%gap
         if (holds_without(self, work, result)) return
         last = drift
         drift = (work%answer%moving + matmul(soft%answer%force, self%c))/ground
         result%active = trial%active .and. (self%bilateral .or. abs(soft%answer%force) &
            & > set_tolerance*max(largest(soft%answer%force), maxval(ground)*work%gap_scale))
         work%answer%gap = soft%answer%gap
         if (stays(self, work, result, q + drift, ground)) return
         q = q + drift
         ! What falls without end by equal steps goes on to the next contact.
         if (all(abs(drift - last) <= set_tolerance*largest(drift))) q = q + drift &
            & *(way_to_contact(self, trial%active, soft%answer%gap, drift) - 1.0_wp)
      end do
      result%q = drift
      result%outcome = outcome%not_held
   end subroutine hold_bodies

   !> The set holds with the motions that no row of it resists, and no load drives, where they are.
   logical function stays(self, work, result, q, ground)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      real(wp), intent(in) :: q(:)             !! (nq) where the bodies are
      real(wp), intent(in) :: ground(:)        !! (nq) stiffness of the springs that hold them

      call hold_at_rest(self, result%active, work%answer%load, work%answer%moving, q, ground)
      stays = allocated(self%held)
      if (stays) stays = holds_without(self, work, result)
      if (allocated(self%held) .and. .not. stays) deallocate (self%held)
   end function stays

   !> How often a drift may be taken until the first open row closes.
   pure real(wp) function way_to_contact(self, active, gap, drift) result(way)
      class(condensed_type), intent(in) :: self
      logical, intent(in) :: active(:)
      real(wp), intent(in) :: gap(:), drift(:)
      real(wp) :: closes(self%nrow)

      closes = -matmul(self%c, drift)
      way = 1.0_wp
      if (any(.not. active .and. closes > 0.0_wp .and. gap > 0.0_wp)) way = max(way, minval( &
         & gap/closes, mask=.not. active .and. closes > 0.0_wp .and. gap > 0.0_wp))
   end function way_to_contact

   !> The set found on soft ground also holds without: laws of pressure go on from the gaps there.
   logical function holds_without(self, work, result) result(holds)
      class(condensed_type), intent(inout) :: self
      type(work_type), intent(inout) :: work
      type(contact_result_type), intent(inout) :: result
      logical :: wrong(self%nrow)
      integer :: pass, status

      holds = .false.
      call linearise(self, work, result, by_set=.false.)
      do pass = 1, most_law_passes
         call self%solve_set(result%active, work%spring, work%compliance, work%springs, &
            & work%answer, status)
         if (status /= 0) return
         call find_wrong(self, work, result, wrong)
         if (any(wrong)) return
         holds = laws_met(self, work, result)
         if (holds) return
         call linearise(self, work, result, by_set=.false.)
      end do
   end function holds_without
end module lopin_active_set
