!> History of friction at each point of the linear path, and the increments that are reported.
!>
!> Vectors are in global axes, so that a tool may turn between increments.
module lopin_friction_state
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: friction_history_type, friction_tests_type, new_friction_history, new_friction_tests

   !> Accepted with the increment, or dropped with it (lopin_state).
   type :: friction_history_type
      real(wp), allocatable :: traction(:, :)   !! (3, npoint) tangential force on the slave [force]
      real(wp), allocatable :: elastic(:, :)    !! (3, npoint) elastic slip [length]
      real(wp), allocatable :: anchor(:, :)     !! (3, npoint) slip from the anchor [length]
      real(wp), allocatable :: slip(:, :)       !! (3, npoint) sum of the slips in contact [length]
      real(wp), allocatable :: slid(:, :)       !! (3, npoint) slip of the increment where it slides
      real(wp), allocatable :: path(:)          !! (npoint) length of the way slid [length]
      real(wp), allocatable :: work(:)          !! (npoint) dissipated >= 0 [force*length]
      real(wp), allocatable :: mean_work(:)     !! (npoint) the same by mean tractions, any sign
      real(wp), allocatable :: speed(:)         !! (npoint) of slip in the increment [length/time]
      integer, allocatable :: status(:)         !! (npoint) 0 open, 1 stick, 2 slip
      logical, allocatable :: closed(:)         !! (npoint) pressed once: NO SEPARATION holds
      real(wp), allocatable :: force(:)         !! (nrow) forces of all rows [force]
      real(wp), allocatable :: gap(:)           !! (nrow) their gaps [length]
      real(wp), allocatable :: q(:)             !! (nq) motions that nothing else holds
   contains
      procedure :: pass
   end type friction_history_type

   !> Of the last solve.
   type :: friction_tests_type
      real(wp), allocatable :: slid(:, :)       !! (3, npoint) slip of the increment [length]
      real(wp), allocatable :: mises(:), speed(:)   !! (npoint) of the last iteration, read by laws
      logical :: speed_of_trial = .true.        !! laws read that of the trial, not `speed`
      real(wp), allocatable :: touch(:)         !! (npoint) share of the increment before the touch
      real(wp) :: cone_excess = 0.0_wp          !! largest, beside the largest bound [-]
      real(wp) :: misfit = 0.0_wp               !! of tractions and slips, beside the largest force
      real(wp) :: stored = 0.0_wp               !! in elastic stick [force*length]
      real(wp) :: gained = 0.0_wp               !! negative dissipation beyond noise [force*length]
      real(wp) :: slid_work = 0.0_wp            !! bounds times slips [force*length]
      real(wp) :: ramp = 0.0_wp                 !! share of the bounds that touching points lack [-]
   end type friction_tests_type

contains

   !> History of points that have not slipped yet.
   subroutine new_friction_history(self, closed)
      type(friction_history_type), intent(out) :: self
      logical, intent(in) :: closed(:)          !! (npoint) touch at the start
      integer :: npoint

      npoint = size(closed)
      allocate (self%traction(3, npoint), self%elastic(3, npoint), self%anchor(3, npoint), &
         & self%slip(3, npoint), self%slid(3, npoint), self%path(npoint), self%work(npoint), &
         & self%mean_work(npoint), self%speed(npoint), source=0.0_wp)
      allocate (self%status(npoint), source=0)
      self%closed = closed
   end subroutine new_friction_history

   !> Tests of points that have not slipped yet.
   subroutine new_friction_tests(self, npoint)
      type(friction_tests_type), intent(out) :: self
      integer, intent(in) :: npoint

      allocate (self%slid(3, npoint), self%mises(npoint), self%speed(npoint), self%touch(npoint), &
         & source=0.0_wp)
   end subroutine new_friction_tests

   !> To a stream or back.
   subroutine pass(self, stream)
      class(friction_history_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%traction)
      call stream%pass(self%elastic)
      call stream%pass(self%anchor)
      call stream%pass(self%slip)
      call stream%pass(self%slid)
      call stream%pass(self%path)
      call stream%pass(self%work)
      call stream%pass(self%mean_work)
      call stream%pass(self%speed)
      call stream%pass(self%status)
      call stream%pass(self%closed)
      call stream%pass(self%force)
      call stream%pass(self%gap)
      call stream%pass(self%q)
   end subroutine pass
end module lopin_friction_state
