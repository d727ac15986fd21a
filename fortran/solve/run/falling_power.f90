!> How long the next increment may be where metal flows less and less.
!>
!> An increment knows the ends of its way alone. Where the plastic power falls, point after point
!> unloads, each at a time of its own between two ends, and what it would have flowed until then is
!> missed: a sheet that is lifted off its die by a pressure that goes was bent by 2 % less, and
!> what it pressed on the die in the end was off by 7 %. By the trapezoidal rule the plastic work
!> that is missed is half the fall of the power times the length, so that it goes with the square
!> of the length. The next increment is as long as leaves that below half a per cent of all
!> plastic work. Power that rises misses nothing where strains are given, or follow the stress:
!> what flows on ends where its strains end (module lopin_driven_flow has the other case). An
!> increment much shorter than the one after it (at rest, in a jump) says nothing of how power
!> changes over that.
module lopin_falling_power
   use lopin_kinds, only : wp
   use lopin_state, only : state_type
   implicit none
   private
   public :: note_power, part_by_power

   !> Plastic work that an increment may miss, or that loads do too much, beside all of it; least
   !> part of the last increment.
   real(wp), parameter :: most_missed = 0.005_wp, least_part = 0.3_wp
   !> Times its length, how far ahead the power of an increment counts.
   real(wp), parameter :: ahead = 3.0_wp

contains

   !> After an increment was accepted: its plastic power, and what it may have missed, or loads
   !> have done too much in it.
   subroutine note_power(accepted, length)
      type(state_type), intent(inout) :: accepted
      real(wp), intent(in) :: length           !! of the increment [time]
      real(wp) :: power, fall

      associate (clock => accepted%clock, work => accepted%solids%work)
         power = (work - clock%worked)/length
         clock%missed = 0.0_wp
         if (clock%number > 1 .and. work > 0.0_wp) then
            fall = 0.5_wp*(clock%power - power)*min(length, ahead*clock%lasted)
            clock%missed = max(0.0_wp, fall/work, clock%extra/(work + accepted%loads%strain))
         end if
         clock%worked = work
         clock%power = power
         clock%lasted = length
      end associate
   end subroutine note_power

   !> Of the last increment, as long as the next may be.
   pure real(wp) function part_by_power(accepted) result(part)
      type(state_type), intent(in) :: accepted

      part = huge(part)
      if (accepted%clock%missed > 0.0_wp) part = max(least_part, &
         & sqrt(most_missed/accepted%clock%missed))
   end function part_by_power
end module lopin_falling_power
