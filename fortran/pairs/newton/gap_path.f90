!> Gaps of points on the way of an increment, where it bends: what passes over a point comes nearer
!> and goes away again.
module lopin_gap_path
   use lopin_kinds, only : wp
   implicit none
   private
   public :: gap_path_type, meet, unseen

   !> Gap of a point with nothing opposite [length].
   real(wp), parameter :: unseen = huge(1.0_wp)

   type :: gap_path_type
      integer :: n = 0                         !! equal parts of the way; 0: not looked at
      integer, allocatable :: column(:)        !! (points) in `gap`; 0: does not go far
      real(wp), allocatable :: gap(:, :)       !! (0:n, columns) of the nodes [length]
   end type gap_path_type

contains

   !> Where a row first touches whose gap goes from `open` to open - approach: the line between
   !> them, with the bend of the gap of its node. Where it never does, it is where it comes nearest,
   !> and at the latest amid the last two looks: the guess of its motion is off, perhaps by more
   !> than would be left of the way, and slip has the direction of the way, not that of the error.
   pure subroutine meet(self, i, open, approach, phi, left)
      type(gap_path_type), intent(in) :: self
      integer, intent(in) :: i                 !! point
      real(wp), intent(in) :: open             !! > 0 [length]
      real(wp), intent(in) :: approach         !! < 0: it goes away [length]
      real(wp), intent(out) :: phi             !! share of the way before it, in [0, 1]
      real(wp), intent(out) :: left            !! gap there [length]
      real(wp) :: before, now, share, latest
      integer :: column, k
      logical :: seen

      column = 0
      if (self%n > 0) column = self%column(i)
      phi = 0.0_wp
      left = open
      if (column == 0) then
         if (approach > 0.0_wp) phi = min(open/approach, 1.0_wp)
         left = open - phi*approach
         return
      end if
      seen = all(self%gap(:, column) < unseen)
      before = open
      latest = real(self%n, wp) - 0.5_wp
      do k = 1, self%n
         share = real(k, wp)/real(self%n, wp)
         now = open - share*approach
         if (seen) now = now + bend(self, column, k)
         if (now <= 0.0_wp) then
            phi = (real(k, wp) - now/(now - before))/real(self%n, wp)
            left = 0.0_wp
            return
         end if
         if (now < left) then
            phi = min(real(k, wp), latest)/real(self%n, wp)
            left = now
         end if
         before = now
      end do
   end subroutine meet

   !> How far a gap is from the line between its ends [length].
   pure real(wp) function bend(self, column, k)
      type(gap_path_type), intent(in) :: self
      integer, intent(in) :: column, k
      real(wp) :: share

      associate (first => self%gap(0, column), last => self%gap(self%n, column))
         share = real(k, wp)/real(self%n, wp)
         bend = self%gap(k, column) - first - share*(last - first)
      end associate
   end function bend
end module lopin_gap_path
