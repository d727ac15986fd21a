!> Bounds of friction that rise less steeply with the pressure, where points jam.
!>
!> A bound that is a stress of its own rises as 10 p until it is reached (lopin_friction). Under
!> less pressure than that it is a coefficient of 10, and a point that is pushed as much along the
!> face as its pressure bears has an equilibrium nearby only while that coefficient is below the
!> ratio S_nn/|S_nt| of its compliances: in a sheet of thickness t with facets h that is about
!> 2 h/t. Beyond, sticking asks for more shear than the bound, and sliding presses less than it
!> needs: Newton goes to and fro between both. There the bound rises half as steeply, and half
!> again, down to a coefficient that dry metals have: of the one point that Newton has come back to
!> so often, and of whole pairs where it ends without that. What it lacks is part of `ramp` in the
!> certificate, as everywhere.
module lopin_eased_friction
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : condition_type, law_names, law_of, has_friction, jumps_at_touch, &
      & lost_at_touch
   use lopin_slip_increment, only : condition_at, shear_bound, shear_of, speed_of
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_repeated_messages, only : warn_once
   use lopin_state, only : contact_state_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: jams_type, ease_jammed, ease_returning, forget_eased, steepen_eased, apply_eased, &
      & tell_eased

   !> How much less steeply each time, and the least slope.
   real(wp), parameter :: less = 0.5_wp, gentlest = 0.6_wp
   !> Shears this near to their bound, beside it, may be held back by it.
   real(wp), parameter :: near = 0.9_wp
   !> And this share of the pressure is a little less.
   real(wp), parameter :: little = 0.5_wp
   !> Returns of a point to what it was before, in one Newton, after which it jams.
   integer, parameter :: most_returns = 3
   !> Sliding under a bound that still rises, beside open (0), sticking (1) and sliding (2).
   integer, parameter :: rising = 3

   !> Where points have been in the iterations of one Newton.
   type :: jams_type
      private
      integer, allocatable :: last(:), before(:)   !! (n) open, sticking, sliding, `rising`
      integer, allocatable :: returns(:)           !! (n) to what they were before
   end type jams_type

contains

   !> Half the slope of the pairs in which points jam at the last trial, and of those in which they
   !> did; `jams` if any slope is left to be halved.
   subroutine ease_jammed(scene, jammed, jams)
      type(scene_type), intent(inout) :: scene
      logical, intent(inout) :: jammed(:)      !! (npair)
      logical, intent(out) :: jams
      integer :: i, eased

      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (may_jam(c, i)) jammed(c%pair(i)) = .true.
         end do
         call ease(scene, [(jammed(c%pair(i)), i=1, c%n)], eased)
      end associate
      jams = eased > 0
   end subroutine ease_jammed

   !> Half the slope of the points that jam at this trial and have come back to it again and again.
   subroutine ease_returning(self, scene, eased)
      type(jams_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      integer, intent(out) :: eased            !! how many
      logical, allocatable :: which(:)
      integer :: i, now

      eased = 0
      associate (c => scene%newton%contact)
         if (.not. allocated(c%friction)) return
         if (.not. any(has_friction(c%friction) .and. jumps_at_touch(c%friction))) return
         if (.not. allocated(self%last)) allocate (self%last(c%n), self%before(c%n), &
            & self%returns(c%n), source=0)
         allocate (which(c%n), source=.false.)
         do i = 1, c%n
            now = c%status(i)
            if (now == 2) then
               if (lacks_bound(c, i, 1.0_wp)) now = rising
            end if
            if (now == self%last(i)) cycle
            if (now == self%before(i)) self%returns(i) = self%returns(i) + 1
            self%before(i) = self%last(i)
            self%last(i) = now
            if (self%returns(i) < most_returns) cycle
            which(i) = may_jam(c, i)
         end do
         if (.not. any(which)) return
         call ease(scene, which, eased)
         call apply_eased(scene)
         where (which) self%returns = 0
      end associate
   end subroutine ease_returning

   !> Half the slope of some points.
   subroutine ease(scene, which, eased)
      type(scene_type), intent(inout) :: scene
      logical, intent(in) :: which(:)          !! (n)
      integer, intent(out) :: eased            !! of them whose slope was not yet the gentlest
      logical :: halved(size(which))

      associate (c => scene%newton%contact, state => scene%trial%contact)
         halved = which
         where (less*c%eased*c%friction(c%pair(:c%n))%rise < gentlest) halved = .false.
         eased = count(halved)
         if (eased == 0) return
         if (.not. allocated(state%eased)) allocate (state%eased(size(which)), &
            & state%steepest(size(which)), source=1.0_wp)
         if (allocated(scene%accepted%contact%eased)) then
            where (halved) state%steepest = less*scene%accepted%contact%eased
         else
            where (halved) state%steepest = less
         end if
         where (halved) state%eased = less*state%eased
      end associate
   end subroutine ease

   !> A closed point is held by a bound that still rises, or did at a little less pressure.
   pure logical function may_jam(contact, i)
      type(nonlinear_contact_type), intent(in) :: contact
      integer, intent(in) :: i

      may_jam = .false.
      if (contact%status(i) == 0) return
      if (.not. lacks_bound(contact, i, little)) return
      may_jam = norm2(shear_of(contact, i)) > near*shear_bound(contact, i)
   end function may_jam

   !> The bound of a point still rises under this share of its pressure.
   pure logical function lacks_bound(contact, i, share)
      type(nonlinear_contact_type), intent(in) :: contact
      integer, intent(in) :: i
      real(wp), intent(in) :: share            !! of the pressure [-]
      type(condition_type) :: at
      real(wp) :: lost, whole

      lacks_bound = .false.
      associate (law => contact%friction(contact%pair(i)))
         if (.not. (has_friction(law) .and. jumps_at_touch(law))) return
         at = condition_at(contact, i)
         at%speed = speed_of(contact, i)
         call lost_at_touch(law, share*contact%pressure(i), at, lost, whole)
         lacks_bound = lost > 0.0_wp
      end associate
   end function lacks_bound

   !> Back to what the accepted state has.
   subroutine forget_eased(scene)
      type(scene_type), intent(inout) :: scene

      if (.not. allocated(scene%trial%contact%eased)) return
      deallocate (scene%trial%contact%eased, scene%trial%contact%steepest)
      if (.not. allocated(scene%accepted%contact%eased)) return
      scene%trial%contact%eased = scene%accepted%contact%eased
      scene%trial%contact%steepest = scene%accepted%contact%steepest
   end subroutine forget_eased

   !> An increment is accepted: the next goes half the way back to the slope that points do not jam
   !> under.
   subroutine steepen_eased(state)
      type(contact_state_type), intent(inout) :: state

      if (.not. allocated(state%eased)) return
      state%eased = min(state%steepest, state%eased/less)
   end subroutine steepen_eased

   !> Points have the slopes of the trial state.
   subroutine apply_eased(scene)
      type(scene_type), intent(inout) :: scene

      scene%newton%contact%eased = 1.0_wp
      if (allocated(scene%trial%contact%eased)) scene%newton%contact%eased = &
         & scene%trial%contact%eased
   end subroutine apply_eased

   !> At the end of a step: where that was done, and how much of the bounds was lacking at most.
   subroutine tell_eased(scene, model, most)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: most             !! largest `ramp` of its increments [-]
      character(len=:), allocatable :: which
      integer :: point, pair

      if (.not. allocated(scene%accepted%contact%eased)) return
      point = minloc(scene%accepted%contact%steepest, dim=1)
      pair = scene%newton%contact%pair(point)
      associate (eased => scene%accepted%contact%steepest(point), p => model%pair(pair), &
         & friction => scene%newton%contact%friction)
         if (.not. eased < 1.0_wp) return
         which = 'the bound of friction'
         if (friction(pair)%law >= law_of%coulomb .and. friction(pair)%law <= size(law_names)) &
            & which = 'the bound of '//trim(law_names(friction(pair)%law))
         call warn_once(scene%log, 'W0326', 'step '//to_text(scene%step)//': points of pair ('// &
            & model%surface(p%slave)%name//', '//model%surface(p%master)%name//') jammed; '// &
            & which//' rises at most as '//to_text(eased*friction(pair)%rise, 2)// &
            & ' p there, and up to '//to_text(100.0_wp*most, 2)//' % of what it allows was '// &
            & 'left out', friction(pair)%at, &
            & help='COULOMB-OROWAN has a slope of your own, and sheets have it')
      end associate
   end subroutine tell_eased
end module lopin_eased_friction
