!> The cheapest exact path: one factorisation with the contact equations last, contact solved on
!> them.
!>
!> A step keeps its supports, so it keeps its factor; a step with the supports of the one before
!> keeps that one's. Every increment is one forward and one backward pass.
module lopin_path_condensed
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, log_type, raise
   use lopin_text, only : to_text
   use lopin_clock, only : phase
   use lopin_model, only : model_type
   use lopin_constraints, only : expand, reduce, raw_displacement
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_condensed, only : columns_times
   use lopin_active_set, only : solve_contact, outcome
   use lopin_contact_rows, only : contact_rows_type
   use lopin_reduced_rows, only : reduce_rows
   use lopin_contact_candidates, only : transfer_rows
   use lopin_scene, only : scene_type, retained_equations, rebuild_rows
   use lopin_linear_system, only : new_linear_system, factorise_system, condense_load, recover, &
      & widen_system, joins_cheaply
   use lopin_automatic_penalty, only : set_stiffness
   use lopin_raise_penalty, only : raising_type, wants_other_slope
   use lopin_methods, only : choose_methods
   use lopin_contact_friction, only : slides_with_friction, contact_with_friction, start_speed, &
      & renew_speed
   use lopin_friction_stress, only : friction_reads_stress, update_friction_stress, &
      & most_stress_passes, stress_tolerance
   use lopin_repeated_messages, only : warn_once
   use lopin_tie_forces, only : drop_tie_forces, add_tie_forces
   use lopin_kept_displacements, only : tools_suffice, displace_tools, add_floating
   use lopin_contact_failure, only : check_held, explain_outcome
   implicit none
   private
   public :: prepare_condensed, solve_condensed, complete_condensed, widen_condensed

contains

   !> Factorise for the constraints in force.
   subroutine prepare_condensed(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: retained(:)
      integer :: bad

      scene%straight%ready = .false.
      call retained_equations(scene, model, retained)
      if (allocated(scene%kept_last)) call move_alloc(scene%kept_last, retained)
      call new_linear_system(scene%system, scene%constraints%neq, scene%bodies%support, retained)
      call factorise_system(scene%system, scene%k, scene%constraints, model%solver, scene%clock, &
         & scene%counter, bad, error)
      if (.not. allocated(error)) then
         call note_order(scene, retained)
         return
      end if
      if (bad > 0) call name_equation(scene, model, bad, error)
   end subroutine prepare_condensed

   !> The order of the factor in force: it is made again in that order.
   subroutine note_order(scene, last)
      type(scene_type), intent(inout) :: scene
      integer, intent(in) :: last(:)           !! equations that it kept last when it was made

      scene%accepted%solver%joined = scene%system%late
      scene%accepted%solver%last = last
      scene%trial%solver%joined = scene%system%late
      scene%trial%solver%last = last
   end subroutine note_order

   !> Rows for the points within reach by now: on the factor that stands if they are few.
   subroutine widen_condensed(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(contact_rows_type) :: old
      integer, allocatable :: retained(:), added(:)

      old = scene%rows
      scene%straight%ready = .false.
      call retained_equations(scene, model, retained)
      call transfer_rows(scene, model, old)
      added = pack(retained, scene%system%place(retained) == 0)
      if (joins_cheaply(scene%system, size(added))) then
         call widen_system(scene%system, added, scene%counter, error)
         call note_order(scene, scene%accepted%solver%last)
      else
         call prepare_condensed(scene, model, error)
      end if
      scene%fresh_factor = .true.
      call scene%clock%stop_in(phase%solve)
   end subroutine widen_condensed

   !> A pivot that vanished: say which node and direction.
   subroutine name_equation(scene, model, bad, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: bad
      type(error_type), allocatable, intent(inout) :: error
      integer :: dof

      dof = scene%constraints%dof_of_equation(bad)
      error%item(1)%message = error%item(1)%message//'; the pivot of node '// &
         & to_text(model%mesh%node_label(scene%dofs%node(dof)))//', direction '// &
         & to_text(scene%dofs%dof(dof))//', vanished'
   end subroutine name_equation

   !> Displacements and contact forces for the loads and prescribed values of one increment.
   subroutine solve_condensed(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: u_known(:), y(:), load(:), moving(:), gap(:)
      real(wp) :: v(scene%constraints%neq)

      allocate (u_known(scene%dofs%n))
      v = 0.0_wp
      call expand(scene%constraints, v, prescribed, u_known)
      call scene%clock%start()
      if (scene%straight%fits) then
         call pass_ends(scene)
         associate (line => scene%straight)
            y = line%at(line%y)
            load = line%at(line%load)
            moving = line%at(line%moving)
         end associate
      else
         call pass_load(scene, f, u_known, y, load, moving)
      end if
      call scene%clock%stop_in(phase%solve)
      call rebuild_rows(scene, model, prescribed)
      call drop_tie_forces(scene)
      call fill_problem(scene, model, u_known, gap, error)
      if (allocated(error)) return
      if (abs(scene%stiffer - scene%trial%contact%stiffer) > 0.0_wp) call set_stiffness(scene, &
         & model)
      if (slides_with_friction(scene)) then
         call solve_friction_history(scene, model, gap, y, load, moving, prescribed, error)
      else
         call contact_by_continuation(scene, model, gap, load, moving, error)
         call scene%clock%stop_in(phase%contact)
         if (.not. allocated(error)) call displace(scene, model, y, prescribed)
      end if
      if (allocated(error)) return
      if (allocated(scene%system%forward)) return
      call add_tie_forces(scene, f)
      call scene%clock%stop_in(phase%contact)
   end subroutine solve_condensed

   !> All displacements of an answer whose tools rest, where those behind the tools were all so far.
   subroutine complete_condensed(scene, model, f, prescribed)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      real(wp), allocatable :: y(:)

      scene%tools_first = .false.
      if (.not. allocated(scene%system%forward)) return
      call move_alloc(scene%system%forward, y)
      call displace(scene, model, y, prescribed)
      call add_tie_forces(scene, f)
      call scene%clock%stop_in(phase%contact)
   end subroutine complete_condensed

   !> Forward pass of loads while some displacements are prescribed.
   subroutine pass_load(scene, f, u_known, y, load, moving)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]
      real(wp), intent(in) :: u_known(:)       !! (ndof) displacements at zero equations [length]
      real(wp), allocatable, intent(out) :: y(:), load(:), moving(:)
      real(wp), allocatable :: internal(:), right(:)

      allocate (internal(scene%dofs%n), right(scene%constraints%neq))
      if (any(abs(u_known) > 0.0_wp)) then
         call scene%k%multiply(u_known, internal)
         call reduce(scene%constraints, f - internal, right)
      else
         call reduce(scene%constraints, f, right)
      end if
      moving = matmul(right, scene%bodies%motion)
      call condense_load(scene%system, right, y, load)
   end subroutine pass_load

   !> Forward passes of the ends of a step, once for each factor.
   subroutine pass_ends(scene)
      type(scene_type), intent(inout) :: scene
      real(wp), allocatable :: u(:), y(:), load(:), moving(:)
      real(wp) :: v(scene%constraints%neq)
      integer :: e

      associate (line => scene%straight)
         if (line%ready) return
         v = 0.0_wp
         if (allocated(line%y)) deallocate (line%y, line%load, line%moving)
         allocate (line%y(scene%system%n, 2), line%load(scene%system%nlast, 2), &
            & line%moving(scene%bodies%nq, 2), u(scene%dofs%n))
         do e = 1, 2
            call expand(scene%constraints, v, line%prescribed(:, e), u)
            call pass_load(scene, line%f(:, e), u, y, load, moving)
            line%y(:, e) = y
            line%load(:, e) = load
            line%moving(:, e) = moving
         end do
         line%ready = .true.
      end associate
   end subroutine pass_ends

   !> The same with friction, repeated where a law reads what the last solve gave.
   subroutine solve_friction_history(scene, model, gap, y, load, moving, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: gap(:), y(:), load(:), moving(:), prescribed(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: change, slower
      logical :: reads_stress
      integer :: pass

      scene%gap = gap
      reads_stress = friction_reads_stress(scene, model)
      ! From what is accepted: an increment tried again has the same bits.
      call start_speed(scene)
      if (reads_stress) call update_friction_stress(scene, model, scene%accepted%motion%u, change)
      do pass = 1, most_stress_passes
         call contact_by_slopes(scene, model, gap, load, moving, error)
         if (.not. allocated(error)) call explain_outcome(scene, model, error)
         call scene%clock%stop_in(phase%contact)
         if (allocated(error)) return
         call displace(scene, model, y, prescribed)
         call renew_speed(scene, model, slower)
         change = 0.0_wp
         if (reads_stress) call update_friction_stress(scene, model, scene%trial%motion%u, change)
         change = max(change, slower)
         if (change <= stress_tolerance) return
      end do
      call warn_once(scene%log, 'W0509', 'the von Mises stress or the speed of slip that '// &
         & 'friction reads still changes by '//to_text(change, 3)// &
         & ' of its largest value after '//to_text(most_stress_passes)// &
         & ' passes of an increment of step '//to_text(scene%step), model%step(scene%step)%at)
   end subroutine solve_friction_history

   !> Contact with friction, again by stiffer slopes where those that were chosen are too soft.
   subroutine contact_by_slopes(scene, model, gap, load, moving, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: gap(:), load(:), moving(:)
      type(error_type), allocatable, intent(out) :: error
      type(raising_type) :: raising
      type(log_type) :: log

      log = scene%log
      do
         call contact_with_friction(scene, model, gap, load, moving, error)
         if (.not. wants_other_slope(raising, scene, model)) exit
         if (allocated(error)) deallocate (error)
         scene%log = log
         call set_stiffness(scene, model)
      end do
   end subroutine contact_by_slopes

   !> Displacements from the condensed load and the contact forces.
   subroutine displace(scene, model, y, prescribed)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: y(:), prescribed(:)
      real(wp) :: v(scene%constraints%neq)

      if (allocated(scene%system%forward)) deallocate (scene%system%forward)
      if (tools_suffice(scene, model)) then
         call displace_tools(scene, y, prescribed)
         call scene%clock%stop_in(phase%solve)
         return
      end if
      call recover(scene%system, y, columns_times(scene%problem, scene%answer%force), v)
      scene%counter%back_solves = scene%counter%back_solves + 1
      call add_floating(scene, v)
      call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
      call scene%clock%stop_in(phase%solve)
   end subroutine displace

   !> Rows of the contact problem on the equations kept last; the compliance is kept if they did not
   !> change.
   subroutine fill_problem(scene, model, u_known, gap, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u_known(:)
      real(wp), allocatable, intent(out) :: gap(:)
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: first(:), equation(:)
      real(wp), allocatable :: value(:)
      integer :: row, k, kept
      logical :: same

      call reduce_rows(scene%rows, scene%constraints, u_known, first, equation, value, gap)
      associate (p => scene%problem)
         same = allocated(p%value) .and. .not. scene%fresh_factor
         if (same) same = size(p%value) == size(scene%kept_value)
         if (same) same = size(scene%kept_value) == size(value)
         if (same) same = all(scene%kept_equation == equation) .and. all(scene%kept_value == value)
         if (same) same = p%nrow == scene%rows%nsolved
         if (same) then
            p%bilateral = scene%rows%bilateral(:p%nrow)
            return
         end if
         scene%kept_equation = equation
         scene%kept_value = value
         scene%fresh_factor = .false.
         p%n = scene%system%nlast
         p%nq = scene%bodies%nq
         p%nrow = scene%rows%nsolved
         p%l = scene%system%l
         if (allocated(p%s)) deallocate (p%s)
         if (allocated(p%c)) deallocate (p%c)
         allocate (p%c(p%nrow, p%nq), source=0.0_wp)
         if (allocated(p%first)) deallocate (p%first, p%column, p%value)
         allocate (p%first(p%nrow + 1), p%column(size(equation)), p%value(size(value)))
         kept = 0
         p%first(1) = 1
         do row = 1, p%nrow
            do k = first(row), first(row + 1) - 1
               p%c(row, :) = p%c(row, :) + value(k)*scene%bodies%motion(equation(k), :)
               if (scene%system%number(equation(k)) == 0) cycle
               if (scene%system%place(equation(k)) == 0) then
                  call raise(error, error_code%internal, 'E0901', &
                     & 'a contact row meets an equation that was not kept')
                  return
               end if
               kept = kept + 1
               p%column(kept) = scene%system%place(equation(k))
               p%value(kept) = value(k)
            end do
            p%first(row + 1) = kept + 1
         end do
         p%bilateral = scene%rows%bilateral(:p%nrow)
         p%group_first = scene%rows%group_first
         p%ngroup = size(model%pair)
      end associate
      call choose_methods(scene, model)
      call set_stiffness(scene, model)
      call stay_where_they_are(scene)
      call check_held(scene, model, error)
   end subroutine fill_problem

   !> Floating motions of the accepted state: the artificial supports tell them, for there nothing
   !> else moves.
   subroutine stay_where_they_are(scene)
      type(scene_type), intent(inout) :: scene
      real(wp) :: moved(scene%bodies%nq), a(scene%bodies%nq, scene%bodies%nq)
      integer :: i, status

      if (scene%bodies%nq == 0) return
      associate (at => scene%bodies%support, c => scene%constraints)
         moved = [(raw_displacement(c, scene%dofs, scene%accepted%motion%u, &
            & c%dof_of_equation(at(i))), &
            & i=1, size(at))]
         a = scene%bodies%motion(at, :)
         moved = matmul(moved, a)
         a = matmul(transpose(a), a)
      end associate
      call cholesky(a, status)
      if (status /= 0) return
      call cholesky_solve(a, moved)
      scene%problem%rest = moved
   end subroutine stay_where_they_are

   !> The sequence of problems of lecture J.1: softer penalties first, each starting from the last
   !> one's set.
   subroutine contact_by_continuation(scene, model, gap, load, moving, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: gap(:), load(:), moving(:)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: alpha(:)
      type(raising_type) :: raising
      integer :: stage

      associate (p => scene%problem)
         do
            alpha = p%alpha
            do stage = model%continuation - 1, 0, -1
               p%alpha = alpha*0.1_wp**stage
               call solve_contact(p, gap, load, moving, scene%answer)
               scene%counter%iterations = scene%counter%iterations + scene%answer%iterations
               scene%counter%augmentations = scene%counter%augmentations &
                  & + scene%answer%augmentations
               if (scene%answer%outcome /= outcome%solved) exit
            end do
            p%alpha = alpha
            if (.not. wants_other_slope(raising, scene, model)) exit
            call set_stiffness(scene, model)
         end do
         scene%gap = gap
      end associate
      call explain_outcome(scene, model, error)
   end subroutine contact_by_continuation
end module lopin_path_condensed
