!> The error of contact forces by penetration, over all points, as one number.
module lopin_soft_share
   use lopin_kinds, only : wp
   implicit none
   private
   public :: largest_share

   !> Groups that carry less than this share of all forces are judged beside it.
   real(wp), parameter :: least_part = 0.1_wp

contains

   !> Largest change of the forces of a group beside them: what holds little is not hidden by what
   !> holds much, as the wall of a die by its punch.
   pure real(wp) function largest_share(change, force, group_first) result(share)
      real(wp), intent(in) :: change(:)        !! (n) [force]
      real(wp), intent(in) :: force(:)         !! (n) [force]
      integer, intent(in) :: group_first(:)    !! (ngroup + 1)
      real(wp) :: all_
      integer :: group

      share = 0.0_wp
      all_ = norm2(force(group_first(1):group_first(size(group_first)) - 1))
      if (.not. all_ > 0.0_wp) return
      do group = 1, size(group_first) - 1
         associate (from => group_first(group), to => group_first(group + 1) - 1)
            share = max(share, norm2(change(from:to))/max(norm2(force(from:to)), least_part*all_))
         end associate
      end do
   end function largest_share
end module lopin_soft_share
