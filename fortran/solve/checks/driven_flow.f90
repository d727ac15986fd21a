!> Metal whose rate of strain follows the stress, driven by loads that change.
!>
!> Where tools are moved, or where strain follows the stress, an increment flows as far as its ends
!> are apart. Under loads the stress of a viscous metal is given, and with it its rate: backward
!> Euler flows over the whole increment as fast as it does at the end, which is too far while loads
!> grow. A block of m = .145 pressed by a force to a strain of .2 went by 20 % too far in three
!> increments, with PASS. What is too much, as plastic work: length times (P1 - Pm), where P0 and P1
!> are the plastic powers at the ends of the last and of this increment, Pm = (P1 - P0)/ln(P1/P0)
!> their mean while power rises by the same factor in equal times. Only flow that loads drive counts
!> (their work beside the plastic one), and of it what looks at the rate rather than at the strain:
!> of an increment dt of a metal with slopes s' by rate and s by strain the part s'/(s' + s dt),
!> which is also what is left of earlier errors.
!>
!> Increments are cut where that is above 0.8 % of the plastic and elastic work so far (below the
!> elastic one flow is of no account yet), and the sum over the run is told.
module lopin_driven_flow
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : error_type, error_code, raise
   use lopin_model, only : model_type
   use lopin_flow_curve, only : flow_stress, is_viscous
   use lopin_material_memory, only : strain_at
   use lopin_point_volumes, only : point_volumes
   use lopin_state, only : clock_state_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: limit_driven, tell_driven, driven_id

   character(len=*), parameter :: driven_id = 'E0567'

   !> Work too much in an increment, beside plastic and elastic work; told beside all plastic work.
   real(wp), parameter :: most = 0.008_wp, told = 0.05_wp
   !> An increment is cut so often, to no less than this part and to less than what should fit.
   integer, parameter :: most_cuts = 4
   real(wp), parameter :: least_part = 0.25_wp, safe = 0.8_wp
   !> A power that rises from less than this part of what it is rises from that.
   real(wp), parameter :: least_power = 1.0e-3_wp

contains

   !> Before an increment is accepted: what loads do too much in it, and whether it must be shorter.
   subroutine limit_driven(scene, model, load, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: load(:)          !! (ndof) all loads at its end [force]
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: driven, flowed

      associate (clock => scene%trial%clock, before => scene%accepted%clock, &
         & newton => scene%newton)
         clock%flow = 0.0_wp
         clock%extra = 0.0_wp
         flowed = scene%trial%solids%work - scene%accepted%solids%work
         if (.not. (flowed > 0.0_wp .and. newton%dt > 0.0_wp)) return
         if (.not. has_rate(scene)) return
         driven = min(1.0_wp, 0.5_wp*dot_product(load + scene%accepted%loads%force, &
            & scene%trial%motion%u - scene%accepted%motion%u)/flowed)
         if (.not. driven > 0.0_wp) return
         call note_flow(clock, before, scene, model, driven)
         associate (fits => most*(scene%trial%solids%work + scene%accepted%loads%strain))
            if (.not. scene%may_cut .or. newton%attempt > most_cuts .or. .not. clock%extra &
               & > fits) return
            newton%fit = max(least_part, safe*sqrt(fits/clock%extra))
            call raise(error, error_code%not_converged, driven_id, 'loads drive metal whose '// &
               & 'rate follows the stress, and do '// &
               & to_text(100.0_wp*most*clock%extra/fits, 2)//' % of its plastic work too much '// &
               & 'in one increment', model%step(scene%step)%at, &
               & help='smaller increments on *STATIC')
         end associate
      end associate
   end subroutine limit_driven

   !> Some metal looks at its rate.
   pure logical function has_rate(scene)
      type(scene_type), intent(in) :: scene
      integer :: g

      has_rate = any([(is_viscous(scene%solids%group(g)%law%flow), g=1, size(scene%solids%group))])
   end function has_rate

   !> Power, and what an increment does too much. From where the power of a first increment rose is
   !> known by the second: loads may be there at once.
   subroutine note_flow(clock, before, scene, model, driven)
      type(clock_state_type), intent(inout) :: clock
      type(clock_state_type), intent(in) :: before
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: driven           !! of the flow, by loads
      real(wp) :: from, part, first

      call measure_flow(scene, model, clock%flow, part)
      associate (dt => scene%newton%dt)
         first = 0.0_wp
         if (before%number == 1) then
            from = min(before%flow, max(0.0_wp, before%flow - (clock%flow - before%flow) &
               & *before%lasted/dt))
            first = max(0.0_wp, before%extra - driven*part*before%lasted*above_mean(from, &
               & before%flow))
         end if
         clock%extra = driven*part*dt*above_mean(before%flow, clock%flow)
         clock%extra_sum = part*(before%extra_sum - first) + clock%extra
      end associate
   end subroutine note_flow

   !> Plastic power at the end of the trial, and the part of it that looks at the rate rather than
   !> at the strain.
   subroutine measure_flow(scene, model, power, part)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: power           !! [energy/time]
      real(wp), intent(out) :: part
      real(wp) :: flowed, by_rate
      integer :: e

      flowed = 0.0_wp
      by_rate = 0.0_wp
      do e = 1, size(scene%trial%solids%first) - 1
         if (scene%trial%solids%first(e + 1) > scene%trial%solids%first(e)) &
            & call add_element(scene, model, e, flowed, by_rate)
      end do
      power = flowed/scene%newton%dt
      part = 0.0_wp
      if (flowed > 0.0_wp) part = by_rate/flowed
   end subroutine measure_flow

   !> Stress at the end times plastic strain, of an element's volume.
   subroutine add_element(scene, model, e, flowed, by_rate)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(inout) :: flowed, by_rate   !! [energy]
      real(wp), allocatable :: volume(:)
      real(wp) :: strain, stress, slope, rate_slope, here
      integer :: p, row, first

      associate (new => scene%trial%solids, old => scene%accepted%solids, dt => scene%newton%dt, &
         & mesh => model%mesh, group => scene%solids%group(scene%solids%which(e)))
         row = strain_at(group%element%nstress)
         first = new%first(e)
         volume = point_volumes(group%element, mesh%x(:, mesh%conn(:group%element%nnode, e)), &
            & model%section(mesh%section(e))%thickness)
         do p = first, new%first(e + 1) - 1
            strain = new%value(row, p) - old%value(row, p)
            if (.not. strain > 0.0_wp) cycle
            call flow_stress(group%law%flow, new%value(row, p), strain/dt, stress, slope, &
               & rate_slope)
            here = volume(min(p - first + 1, size(volume)))*stress*strain
            flowed = flowed + here
            if (is_viscous(group%law%flow)) by_rate = by_rate + here*rate_slope/(rate_slope &
               & + dt*max(slope, 0.0_wp))
         end do
      end associate
   end subroutine add_element

   !> How far a power is above the mean of the way to it.
   pure real(wp) function above_mean(from, to) result(above)
      real(wp), intent(in) :: from, to
      real(wp) :: low

      above = 0.0_wp
      if (.not. to > 0.0_wp) return
      low = max(from, least_power*to)
      if (abs(to - low) > 1.0e-6_wp*to) above = to - (to - low)/log(to/low)
   end function above_mean

   !> Say at the end of a step how much too far loads have driven metal.
   subroutine tell_driven(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: word
      real(wp) :: share

      associate (clock => scene%accepted%clock, work => scene%accepted%solids%work)
         if (.not. abs(clock%extra_sum) > told*work) return
         share = abs(clock%extra_sum)/work
         word = 'far'
         if (clock%extra_sum < 0.0_wp) word = 'little'
         call warn_once(scene%log, 'W0567', 'loads drive metal whose rate of strain follows '// &
            & 'the stress, in increments in which that changes much: by the end of step '// &
            & to_text(scene%step)//' it has flowed up to '//to_text(100.0_wp*share, 2)// &
            & ' % too '//word, model%step(scene%step)%at, help='increments of '// &
            & to_text(0.4_wp*told/share*clock%lasted, 2)//' (the last was '// &
            & to_text(clock%lasted, 2)//') leave 2 %: *STATIC, fourth number')
      end associate
   end subroutine tell_driven
end module lopin_driven_flow
