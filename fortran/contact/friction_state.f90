!> What friction remembers of each point: accepted with the increment, or forgotten with it.
!>
!> Vectors are in global axes, so that a tool may turn between increments. A trial never touches
!> what is accepted: an increment that is given up leaves nothing behind.
module lopin_friction_state
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: friction_state_type, history_type, new_friction_state, commit, roll_back, &
      & keep_friction

   type :: history_type
      real(wp), allocatable :: traction(:, :)   !! (3, npoint) tangential force on the slave [force]
      real(wp), allocatable :: elastic(:, :)    !! (3, npoint) elastic slip [length]
      real(wp), allocatable :: anchor(:, :)     !! (3, npoint) slip from the anchor [length]
      real(wp), allocatable :: slip(:, :)       !! (3, npoint) sum of the slips in contact [length]
      real(wp), allocatable :: path(:)          !! (npoint) length of the way slid [length]
      real(wp), allocatable :: work(:)          !! (npoint) dissipated >= 0 [force*length]
      real(wp), allocatable :: mean_work(:)     !! (npoint) the same by mean tractions, any sign
      real(wp), allocatable :: speed(:)         !! (npoint) of slip in the increment [length/time]
      integer, allocatable :: status(:)         !! (npoint) 0 open, 1 stick, 2 slip
      real(wp), allocatable :: force(:)         !! (nrow) forces of all rows [force]
      real(wp), allocatable :: gap(:)           !! (nrow) their gaps [length]
      real(wp), allocatable :: q(:)             !! (nq) motions that nothing else holds
   end type history_type

   type :: friction_state_type
      type(history_type) :: accepted, trial
      real(wp), allocatable :: slid(:, :)       !! (3, npoint) slip of the increment [length]
      real(wp), allocatable :: mises(:), speed(:)   !! (npoint) of the last iteration, read by laws
      real(wp), allocatable :: touch(:)         !! (npoint) share of the increment before the touch
      real(wp) :: cone_excess = 0.0_wp          !! largest, beside the largest bound [-]
      real(wp) :: misfit = 0.0_wp               !! of tractions and slips, beside the largest force
      real(wp) :: stored = 0.0_wp               !! in elastic stick [force*length]
      real(wp) :: gained = 0.0_wp               !! negative dissipation beyond noise [force*length]
      real(wp) :: slid_work = 0.0_wp            !! bounds times slips [force*length]
   end type friction_state_type

contains

   subroutine new_friction_state(self, npoint)
      type(friction_state_type), intent(out) :: self
      integer, intent(in) :: npoint

      associate (h => self%accepted)
         allocate (h%traction(3, npoint), h%elastic(3, npoint), h%anchor(3, npoint), &
            & h%slip(3, npoint), h%path(npoint), h%work(npoint), h%mean_work(npoint), &
            & h%speed(npoint), source=0.0_wp)
         allocate (h%status(npoint), source=0)
      end associate
      allocate (self%slid(3, npoint), self%mises(npoint), self%speed(npoint), self%touch(npoint), &
         & source=0.0_wp)
      self%trial = self%accepted
   end subroutine new_friction_state

   !> The increment is accepted.
   subroutine commit(self)
      type(friction_state_type), intent(inout) :: self
      self%accepted = self%trial
   end subroutine commit

   !> All of it, to a stream or back.
   subroutine keep_friction(self, stream)
      type(friction_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call keep_history(self%accepted, stream)
      call keep_history(self%trial, stream)
      call stream%pass(self%slid)
      call stream%pass(self%mises)
      call stream%pass(self%speed)
      call stream%pass(self%cone_excess)
      call stream%pass(self%misfit)
      call stream%pass(self%stored)
      call stream%pass(self%gained)
      call stream%pass(self%slid_work)
   end subroutine keep_friction

   subroutine keep_history(self, stream)
      type(history_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%traction)
      call stream%pass(self%elastic)
      call stream%pass(self%anchor)
      call stream%pass(self%slip)
      call stream%pass(self%path)
      call stream%pass(self%work)
      call stream%pass(self%mean_work)
      call stream%pass(self%speed)
      call stream%pass(self%status)
      call stream%pass(self%force)
      call stream%pass(self%gap)
      call stream%pass(self%q)
   end subroutine keep_history

   !> The increment is given up.
   subroutine roll_back(self)
      type(friction_state_type), intent(inout) :: self
      self%trial = self%accepted
   end subroutine roll_back
end module lopin_friction_state
