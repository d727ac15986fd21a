!> What metal that flows, and friction, may see of one increment: how far it flows, and how much of
!> the force of contact passes from point to point, or ends. They remember when.
!>
!> Backward Euler knows the end of an increment alone. Where points close, open, or go round a
!> corner of the tool on the way, the metal has flowed as if they had done so from the start. How
!> much of the force of contact did, the sum over points of what closed, what opened and
!> |f - f0| - ||f| - |f0|| of those that turned, bounds what the increment may have in the wrong
!> place. Increments are cut where that is more than a tenth of the force, unless the metal flows so
!> little that the increment is elastic for most of it. Where a pair lets go that holds a body that
!> floats then, or that rubs while the metal flows or other pairs go on pressing, a tenth of the
!> largest force of the run counts: a body that springs back free of all friction does so alike in
!> one increment and in many.
module lopin_limit_increment
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_first_increment, only : first_flow
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: limit_increment

   !> Largest plastic strain of one increment, where increments may be cut.
   real(wp), parameter :: most_flow = 0.25_wp
   !> Force that may pass within an increment, beside all of it; and within one that is not cut.
   real(wp), parameter :: most_passed = 0.1_wp, most_silent = 0.25_wp
   !> Cuts in a row for a pair that lets go, and for force that passes: a jump does in any
   !> increment.
   integer, parameter :: most_cuts = 3, most_halts = 5

   !> Sums over the points of a pair, where the increment begins and ends.
   type :: transfer_type
      real(wp) :: before = 0.0_wp, now = 0.0_wp   !! [force]
      real(wp) :: passed = 0.0_wp              !! from point to point, or round a corner [force]
   end type transfer_type

contains

   !> Before an increment is accepted: whether it must be shorter.
   subroutine limit_increment(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call limit_flow(scene, model, error)
      if (scene%newton%flows .and. .not. allocated(error)) call limit_transfer(scene, model, error)
   end subroutine limit_increment

   !> More plastic flow than one increment follows, where increments may be cut.
   subroutine limit_flow(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (memory => scene%trial%solids, step => model%step(scene%step))
         if (step%direct .or. .not. memory%most_strain > most_flow) return
         call raise(error, error_code%not_converged, 'E0513', 'plastic strain grows by '// &
            & to_text(memory%most_strain, 3)//' in one increment, at element '// &
            & to_text(model%mesh%element_label(memory%most_element)), step%at, &
            & help='smaller increments on *STATIC; DIRECT takes them as they are')
      end associate
   end subroutine limit_flow

   !> Forces that pass, and pairs that let go; notes the largest force of the run.
   subroutine limit_transfer(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(transfer_type) :: of(size(model%pair))
      real(wp) :: whole
      logical :: flows, remembers
      integer :: pair

      call sum_transfers(scene, of)
      associate (most => scene%trial%loads%pressed)
         most = max(most, maxval(of%now))
         whole = max(maxval(of%before), maxval(of%now))
         if (.not. any(of%before > 0.0_wp)) return
         flows = scene%trial%solids%most_strain > first_flow(model)
         if (flows) then
            pair = maxloc(of%passed, dim=1)
            if (of(pair)%passed > most_passed*whole) call refuse(scene, model, pair, &
               & of(pair)%passed/whole, error)
         end if
         if (allocated(error) .or. scene%newton%attempt > most_cuts) return
         do pair = 1, size(of)
            if (of(pair)%now > 0.0_wp .or. .not. of(pair)%before > most_passed*most) cycle
            remembers = has_friction(scene%newton%contact%friction(pair)) &
               & .and. (flows .or. any(of%now > 0.0_wp))
            if (.not. (remembers .or. scene%bodies%nq > 0)) cycle
            if (scene%may_cut) call refuse(scene, model, pair, of(pair)%before/most, error)
            return
         end do
      end associate
   end subroutine limit_transfer

   !> What the points of each pair carry and hand over; pairs that the step takes away are let go
   !> of in their own way.
   pure subroutine sum_transfers(scene, of)
      type(scene_type), intent(in) :: scene
      type(transfer_type), intent(out) :: of(:)
      real(wp) :: f0(3), f(3)
      integer :: i

      associate (c => scene%newton%contact, old => scene%accepted%contact)
         do i = 1, c%n
            if (.not. c%pair_active(c%pair(i))) cycle
            f0 = c%weight(i)*old%traction(:, i)
            f = merge(c%weight(i)*c%traction(:, i), 0.0_wp, c%status(i) > 0)
            associate (sum => of(c%pair(i)), before => norm2(f0), now => norm2(f))
               sum%before = sum%before + before
               sum%now = sum%now + now
               if (before > 0.0_wp .and. now > 0.0_wp) then
                  sum%passed = sum%passed + norm2(f - f0) - abs(now - before)
               else
                  sum%passed = sum%passed + before + now
               end if
            end associate
         end do
      end associate
   end subroutine sum_transfers

   !> A shorter increment, or the warning that this one may not be shorter.
   subroutine refuse(scene, model, pair, share, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: share            !! of the force of contact
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      text = to_text(100.0_wp*share, 3)//' % of the contact force passes between points of '// &
         & model%surface(model%pair(pair)%slave)%name//' or leaves them in one increment'
      if (scene%may_cut .and. scene%newton%attempt <= most_halts) then
         call raise(error, error_code%not_converged, 'E0555', text, model%step(scene%step)%at, &
            & help='smaller increments on *STATIC')
      else if (share > most_silent) then
         call warn_once(scene%log, 'W0555', text//': forces there may be off by as much as '// &
            & 'that, because metal that flows remembers when', model%step(scene%step)%at, &
            & help='smaller increments on *STATIC, or without DIRECT')
      end if
   end subroutine refuse
end module lopin_limit_increment
