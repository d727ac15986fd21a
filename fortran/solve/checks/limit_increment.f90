!> What metal that flows, and friction, may see of one increment: how far it flows, and how much of
!> the force of contact passes from point to point, or ends. They remember when.
!>
!> Backward Euler knows the end of an increment alone. Where points close, open, or go round a
!> corner of the tool on the way, the metal there has flowed as if they had done so from the start.
!> What passes by metal that flows (lopin_passed_force) bounds what the increment may have in the
!> wrong place. Increments are cut, to what should fit, where that is more than a tenth of the
!> force, unless the metal flows so little that the increment is elastic for most of it. Where a
!> pair lets go that holds a body that floats then, or that rubs while the metal flows or other
!> pairs go on pressing, a tenth of the largest force of the run counts: a body that springs back
!> free of all friction does so alike in one increment and in many.
!>
!> What passes less in a shorter increment is followed so; a jump is not: where more than an eighth
!> of what passed in an increment that was refused still passes in a sixty-fourth of it, that is
!> taken, and increments go on as long as they were. A pair that lets go of all its force does so
!> within a short way of a tool that goes on: where the metal flows meanwhile, as friction that does
!> not ask for pressure makes it, the increment is cut seven times at most, else three times.
module lopin_limit_increment
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_driven_flow, only : limit_driven
   use lopin_first_increment, only : first_flow
   use lopin_flow_curve, only : is_viscous
   use lopin_material_memory, only : strain_at
   use lopin_repeated_messages, only : warn_once
   use lopin_passed_force, only : transfer_type, sum_transfers
   use lopin_state, only : refused_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: limit_increment, transfer_id

   character(len=*), parameter :: transfer_id = 'E0555'

   !> Largest plastic strain of one increment, where increments may be cut.
   real(wp), parameter :: most_flow = 0.25_wp
   !> Force that may pass within an increment, beside all of it; and within one that is not cut.
   real(wp), parameter :: most_passed = 0.1_wp, most_silent = 0.25_wp
   !> Of the largest force, what a metal that flows on may be let go of.
   real(wp), parameter :: most_lost = 0.25_wp
   !> Plastic strains below this are none.
   real(wp), parameter :: some_flow = 1.0e-6_wp
   !> Cuts in a row for a pair that lets go, and for force that passes.
   integer, parameter :: most_cuts = 3, most_halts = 5
   !> The way of a release is a small part of a tool's, and is there however short the increment:
   !> so many cuts where the plastic work of an increment is more than this part of the elastic
   !> energy that may come free. What a V released at .05 was 1.8 % off, what bends in air
   !> did at .14 and .17 30 and 20 %; cut so, 20 and 9 %.
   integer, parameter :: most_releases = 7
   real(wp), parameter :: some_work = 0.1_wp
   !> An increment is cut to no less, and to less than what should fit.
   real(wp), parameter :: least_part = 0.25_wp, safe = 0.9_wp
   !> A jump passes in so short a part of an increment that was refused more than its root of what
   !> passed there; what is smooth passes in proportion.
   real(wp), parameter :: shorter = least_part**most_cuts

contains

   !> Before an increment is accepted: whether it must be shorter.
   subroutine limit_increment(scene, model, load, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: load(:)          !! (ndof) all loads at its end [force]
      type(error_type), allocatable, intent(out) :: error

      scene%newton%passes = .false.
      call limit_flow(scene, model, error)
      if (scene%newton%flows .and. .not. allocated(error)) call limit_transfer(scene, model, error)
      if (.not. allocated(error)) call limit_driven(scene, model, load, error)
   end subroutine limit_increment

   !> More plastic flow than one increment follows, where increments may be cut.
   subroutine limit_flow(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (memory => scene%trial%solids, step => model%step(scene%step))
         if (step%direct .or. .not. memory%most_strain > most_flow) return
         if (scene%newton%rests) then
            call warn_once(scene%log, 'W0559', 'plastic strain grows by '// &
               & to_text(memory%most_strain, 3)//' at element '//to_text( &
               & model%mesh%element_label(memory%most_element))//' as what its mesh leaves out '// &
               & 'of balance is let go of', model%start%at, help='finer elements there: those '// &
               & 'that separate held what their neighbours bear now')
            return
         end if
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
      logical :: flows
      integer :: pair

      call sum_transfers(scene, model, of)
      associate (most => scene%trial%loads%pressed)
         most = max(most, maxval(of%now))
         whole = max(maxval(of%before), maxval(of%now))
         if (.not. any(of%before > 0.0_wp)) return
         flows = scene%trial%solids%most_strain > first_flow(model)
         if (flows) then
            pair = maxloc(of%remembered, dim=1)
            associate (share => of(pair)%remembered/whole)
               if (share > most_passed) call refuse(scene, model, pair, share, &
                  & safe*most_passed/share, error)
               if (.not. allocated(error)) call warn(scene, model, of, whole, &
                  & share > most_passed)
            end associate
         end if
         if (.not. allocated(error)) call limit_loss(scene, model, of, most, error)
         if (.not. allocated(error)) call limit_release(scene, model, of, most, flows, error)
      end associate
   end subroutine limit_transfer

   !> A pair lets go of all its force, and something remembers how.
   subroutine limit_release(scene, model, of, most, flows, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(transfer_type), intent(in) :: of(:)
      real(wp), intent(in) :: most             !! largest force of the run [force]
      logical, intent(in) :: flows             !! metal, in this increment
      type(error_type), allocatable, intent(out) :: error
      logical :: remembers
      integer :: cuts, pair

      cuts = most_cuts
      if (scene%trial%solids%work - scene%accepted%solids%work &
         & > some_work*scene%accepted%loads%strain) cuts = most_releases
      if (scene%newton%attempt > cuts .or. .not. scene%may_cut) return
      do pair = 1, size(of)
         if (of(pair)%now > 0.0_wp .or. .not. of(pair)%before > most_passed*most) cycle
         remembers = has_friction(scene%newton%contact%friction(pair)) &
            & .and. (flows .or. any(of%now > 0.0_wp))
         if (.not. (remembers .or. scene%bodies%nq > 0)) cycle
         scene%newton%refused = refused_type(pair, of(pair)%before/most, scene%newton%dt, &
            & scene%newton%time)
         scene%newton%passes = cuts == most_cuts .and. is_jump(scene, scene%newton%refused)
         if (.not. scene%newton%passes) call cut(scene, model, least_part, error)
         return
      end do
   end subroutine limit_release

   !> A metal whose stress depends on its rate flows on while a tool lets go of it: an increment
   !> knows the force of its end alone, and a tool that is gone by then has let go at once.
   subroutine limit_loss(scene, model, of, most, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(transfer_type), intent(in) :: of(:)
      real(wp), intent(in) :: most             !! largest force of the run [force]
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: share
      integer :: pair

      if (.not. most > 0.0_wp) return
      pair = maxloc(of%before - of%now, dim=1)
      share = (of(pair)%before - of(pair)%now)/most
      if (.not. share > most_lost) return
      if (.not. flows_by_rate(scene)) return
      call refuse(scene, model, pair, share, safe*most_lost/share, error)
      if (allocated(error)) return
      call warn_once(scene%log, 'W0555', describe(model, pair, share)//': metal whose stress '// &
         & 'depends on its rate flows on while it is let go of', &
         & model%step(scene%step)%at, help='smaller increments on *STATIC, or without DIRECT')
   end subroutine limit_loss

   !> Some metal whose stress depends on its rate has flowed.
   pure logical function flows_by_rate(scene) result(flows)
      type(scene_type), intent(in) :: scene
      integer :: e

      flows = .false.
      associate (old => scene%accepted%solids)
         if (.not. old%in_use) return
         do e = 1, size(old%first) - 1
            if (old%first(e + 1) == old%first(e)) cycle
            associate (group => scene%solids%group(scene%solids%which(e)))
               if (.not. is_viscous(group%law%flow)) cycle
               flows = any(old%value(strain_at(group%element%nstress), old%first(e):old%first(e &
                  & + 1) - 1) > some_flow)
            end associate
            if (flows) return
         end do
      end associate
   end function flows_by_rate

   !> What was not cut may be wrong by as much as passed.
   subroutine warn(scene, model, of, whole, known)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(transfer_type), intent(in) :: of(:)
      real(wp), intent(in) :: whole            !! force of contact [force]
      logical, intent(in) :: known             !! metal remembers more than it should
      integer :: pair

      pair = maxloc(of%passed, dim=1)
      if (scene%may_cut .and. .not. known .or. .not. of(pair)%passed > most_silent*whole) return
      call warn_once(scene%log, 'W0555', describe(model, pair, of(pair)%passed/whole)// &
         & ': forces there may be off by as much as that, because metal that flows remembers '// &
         & 'when', model%step(scene%step)%at, &
         & help='smaller increments on *STATIC, or without DIRECT')
   end subroutine warn

   !> A shorter increment, if there may be one that helps.
   subroutine refuse(scene, model, pair, share, part, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: share            !! of the force of contact
      real(wp), intent(in) :: part             !! of the increment that should fit
      type(error_type), allocatable, intent(out) :: error

      associate (newton => scene%newton)
         newton%refused = refused_type(pair, share, newton%dt, newton%time)
         newton%passes = is_jump(scene, newton%refused)
         if (newton%passes .or. newton%attempt > most_halts .or. .not. scene%may_cut) return
         call cut(scene, model, part, error)
      end associate
   end subroutine refuse

   !> For what has been noted as refused.
   subroutine cut(scene, model, part, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: part             !! of the increment that should fit
      type(error_type), allocatable, intent(out) :: error

      scene%newton%fit = max(least_part, part)
      associate (of => scene%newton%refused)
         call raise(error, error_code%not_converged, transfer_id, &
            & describe(model, of%pair, of%share), model%step(scene%step)%at, &
            & help='smaller increments on *STATIC')
      end associate
   end subroutine cut

   function describe(model, pair, share) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: share            !! of the force of contact
      character(len=:), allocatable :: text

      text = to_text(100.0_wp*share, 3)//' % of the contact force passes between points of '// &
         & model%surface(model%pair(pair)%slave)%name//' or leaves them in one increment'
   end function describe

   !> As much passes as did in a longer increment that was refused and is not over yet.
   pure logical function is_jump(scene, now)
      type(scene_type), intent(in) :: scene
      type(refused_type), intent(in) :: now

      associate (before => scene%accepted%clock%refused)
         is_jump = before%pair == now%pair .and. scene%accepted%clock%time < before%until &
            & .and. now%length <= shorter*before%length .and. now%share > sqrt(shorter)*before%share
      end associate
   end function is_jump
end module lopin_limit_increment
