!> The end of an increment: work, checks, and the state that the next one starts from.
module lopin_leave_increment
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_report, only : frame_type, note_most, lost_work
   use lopin_run_type, only : watch_type
   use lopin_eased_friction, only : steepen_eased
   use lopin_scene, only : scene_type
   use lopin_solver_state, only : leave_solver
   use lopin_certificate, only : forces_type, give_verdict
   use lopin_contact_history, only : leave_history
   use lopin_predictor, only : record_motion, closed_pairs
   use lopin_damage, only : grow_damage
   use lopin_artificial_work, only : measure_artificial_work
   use lopin_work_balance, only : balance_type, mend_work, note_work, note_energy
   use lopin_snap_through, only : record_snap_through
   use lopin_springback, only : note_falls
   use lopin_force_ripples, only : note_ripples
   use lopin_facet_sag, only : note_sag
   use lopin_soft_springs, only : note_springs
   use lopin_contact_rows, only : joins_pair
   implicit none
   private
   public :: add_work, check_solids, leave_trial

contains

   !> Work of everything that moves the boundary, by the trapezoidal rule over the increment.
   subroutine add_work(scene, forces, balance, frame)
      type(scene_type), intent(inout) :: scene
      type(forces_type), intent(in) :: forces
      type(balance_type), intent(inout) :: balance
      type(frame_type), intent(inout) :: frame
      real(wp) :: moved(scene%dofs%n)

      associate (before => scene%accepted%loads, after => scene%trial%loads)
         moved = scene%trial%motion%u - scene%accepted%motion%u
         after%force = forces%load
         after%reaction = forces%residual
         after%internal = forces%internal
         after%work = before%work + 0.5_wp*dot_product(after%force + before%force &
            & + after%reaction + before%reaction, moved)
         frame%energy%external = after%work
         if (scene%newton%in_use) call note_work(balance, frame%increment, &
            & frame%time_increment, moved, after%force - before%force + after%reaction &
            & - before%reaction)
      end associate
   end subroutine add_work

   !> Artificial work of the increment, and its share in the verdict; what the trapezoid counts of
   !> gaps is taken off the external work.
   subroutine check_solids(scene, model, watch, pressed, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(watch_type), intent(inout) :: watch
      real(wp), intent(in) :: pressed(:)       !! (ndof) contact forces [force]
      type(frame_type), intent(inout) :: frame

      call measure_artificial_work(watch%artificial, scene, model, pressed, frame%increment, &
         & frame%energy)
      if (scene%newton%in_use) call mend_work(watch%balance, scene, pressed, frame%energy)
      watch%artificial%lost = lost_work(frame%energy)
      scene%trial%loads%most = scene%accepted%loads%most
      call note_most(frame%energy, scene%trial%loads%most)
      scene%trial%loads%strain = frame%energy%strain
      if (scene%newton%in_use) call note_energy(watch%balance, scene, frame%energy)
      call note_falls(watch%springback, frame%energy)
      call note_springs(watch%springs, frame)
      if (scene%newton%in_use) then
         call note_ripples(watch%ripples, scene, model)
         call note_sag(watch%sag, scene, model, frame%increment, frame%step_time)
      end if
      ! What is let go of gives its energy to nothing: that is no jump.
      if (scene%newton%jumped) call record_snap_through(watch%jumps, frame%increment, &
         & merge(0.0_wp, watch%balance%of(3)%lost, watch%balance%springs_back &
         & .and. frame%increment == 1))
      if (.not. frame%energy%artificial > 0.0_wp) return
      frame%certificate%artificial = max(frame%certificate%artificial, &
         & frame%energy%artificial/max(frame%energy%most, frame%energy%artificial))
      ! It is the run's work that it must be small beside.
      if (frame%last_of_step .and. frame%step == size(model%step)) &
         & call give_verdict(frame%certificate)
   end subroutine check_solids

   !> What the increment leaves to the next: motion, tractions and histories of contact.
   subroutine leave_trial(scene, model, frame)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      integer :: row

      associate (accepted => scene%accepted, trial => scene%trial, newton => scene%newton)
         trial%clock%number = frame%increment
         trial%clock%time = frame%step_time
         trial%clock%at_end = frame%last_of_step
         call leave_solver(scene)
         if (newton%in_use) then
            if (newton%flows) then
               call grow_damage(scene%solids, model, trial%motion%u, newton%past, &
                  & accepted%solids, trial%solids)
               if (allocated(newton%contact%pair_active)) trial%contact%held = closed_pairs(newton)
               call record_motion(trial%motion, trial%motion%u - accepted%motion%u, newton%dt, &
                  & newton%separated)
            end if
            call leave_history(newton%contact, accepted%contact, trial%contact)
            call steepen_eased(trial%contact)
            return
         end if
         do row = 1, scene%rows%n
            if (.not. joins_pair(scene%rows, row)) cycle
            if (scene%answer%active(row)) trial%friction%closed(scene%rows%point(row)) = .true.
         end do
      end associate
   end subroutine leave_trial
end module lopin_leave_increment
