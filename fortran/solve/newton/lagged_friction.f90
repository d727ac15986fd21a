!> What friction takes from the last Newton iteration on the nonlinear path: the speed of slip,
!> which EXPONENTIAL DECAY reads, where Newton with the speed of the trial itself has failed.
!>
!> A bound that falls with the slip more steeply than the body is stiff has several answers, and
!> Newton jumps among them. There the speed is put in place between iterations and stays in a line
!> search: tangents do not know it, and the residual that Newton ends with is that of the speed
!> which it ends with. Stresses that laws read are those of the trial (lopin_followed_stress).
module lopin_lagged_friction
   use lopin_kinds, only : wp
   use lopin_friction, only : reads_speed
   use lopin_slip_increment, only : speed_of
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: reads_lagged, reads_trial, start_lagged, renew_lagged, share_of_new, may_relax

   !> Residuals that fall by less beside the best before them: what is read runs in a cycle.
   real(wp), parameter :: falls = 0.5_wp
   !> Residuals below which that is looked at.
   real(wp), parameter :: near = 0.05_wp
   !> Such residuals after which half, and after which a quarter of what is new is read; and after
   !> which less would do no better.
   integer, parameter :: half_after = 2, quarter_after = 15, most_stalls = 30

contains

   !> Some law in force reads what the last iteration gave.
   pure logical function reads_lagged(scene)
      type(scene_type), intent(in) :: scene
      reads_lagged = .false.
      if (.not. allocated(scene%newton%contact%friction)) return
      reads_lagged = any(reads_speed(scene%newton%contact%friction)) &
         & .and. .not. scene%newton%contact%speed_of_trial
   end function reads_lagged

   !> Some law in force reads the speed of the trial.
   pure logical function reads_trial(scene)
      type(scene_type), intent(in) :: scene
      reads_trial = .false.
      if (.not. allocated(scene%newton%contact%friction)) return
      reads_trial = any(reads_speed(scene%newton%contact%friction)) &
         & .and. scene%newton%contact%speed_of_trial
   end function reads_trial

   !> From what is accepted: an increment tried again has the same bits.
   subroutine start_lagged(scene)
      type(scene_type), intent(inout) :: scene

      scene%newton%contact%speed = scene%accepted%contact%speed
   end subroutine start_lagged

   !> From the trial state, or a share of the way there.
   subroutine renew_lagged(scene, share)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: share            !! of what is new, 0..1 [-]
      real(wp) :: speed(scene%newton%contact%n)
      integer :: i

      associate (contact => scene%newton%contact)
         speed = contact%speed(:contact%n)
         contact%speed = [(speed_of(contact, i), i=1, contact%n)]
         if (.not. share < 1.0_wp) return
         contact%speed(:contact%n) = speed + share*(contact%speed(:contact%n) - speed)
      end associate
   end subroutine renew_lagged

   !> How much of what is new to read: all of it while that contracts. What is read and what it
   !> makes of the state may chase each other in a cycle; the mean of both then ends it.
   pure real(wp) function share_of_new(residual) result(share)
      real(wp), intent(in) :: residual(:)      !! of all looks so far [-]

      share = 1.0_wp
      if (.not. is_near(residual)) return
      if (stalls(residual) >= half_after) share = 0.5_wp
      if (stalls(residual) >= quarter_after) share = 0.25_wp
   end function share_of_new

   !> Reading less of what is new may still end the iteration.
   pure logical function may_relax(residual)
      real(wp), intent(in) :: residual(:)      !! of all looks so far [-]
      may_relax = is_near(residual)
      if (may_relax) may_relax = stalls(residual) < most_stalls
   end function may_relax

   !> Close to an answer; further out it is not what is read that Newton chases.
   pure logical function is_near(residual)
      real(wp), intent(in) :: residual(:)
      is_near = size(residual) > 1
      if (is_near) is_near = minval(residual(2:)) < near
   end function is_near

   !> Looks whose residual has not fallen.
   pure integer function stalls(residual)
      real(wp), intent(in) :: residual(:)
      integer :: i

      stalls = 0
      do i = 4, size(residual)
         if (residual(i) > falls*minval(residual(2:i - 1))) stalls = stalls + 1
      end do
   end function stalls

end module lopin_lagged_friction
