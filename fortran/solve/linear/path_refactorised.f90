!> The second path, *LOPIN, PATH=NEWTON: the whole system, factorised again at every change of
!> contact.
!>
!> It condenses nothing and supports nothing artificially: the matrices are those of lecture J. It
!> is the reference of the condensed path and the cost of doing without it. A motion that only
!> contact holds makes K singular and the matrix of a set regular as soon as the set holds it; where
!> a set on the way does not, soft springs that follow the motion (proximal steps) lead to one that
!> does.
module lopin_path_refactorised
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_clock, only : phase
   use lopin_csc, only : csc_type
   use lopin_blas, only : dgetrf, dgetrs
   use lopin_model, only : model_type
   use lopin_constraints, only : expand, reduce
   use lopin_reduce_matrix, only : reduce_matrix
   use lopin_reduced_rows, only : reduce_rows
   use lopin_active_set, only : contact_result_type, solve_contact, outcome
   use lopin_scene, only : scene_type, retained_equations, rebuild_rows
   use lopin_full_system, only : full_system_type, new_full_system, set_rows
   use lopin_linear_system, only : linear_system_type, new_linear_system, factorise_system
   use lopin_automatic_penalty, only : set_stiffness, wants_compliance
   use lopin_raise_penalty, only : raising_type, wants_other_slope
   use lopin_methods, only : choose_methods
   use lopin_contact_failure, only : check_held, explain_outcome
   implicit none
   private
   public :: prepare_refactorised, solve_refactorised

   !> Soft springs of the proximal steps, beside the mean stiffness; steps before giving up.
   real(wp), parameter :: soft = 1.0e-2_wp
   integer, parameter :: most_steps = 60
   !> Columns of the compliance that are solved for together.
   integer, parameter :: together = 64

contains

   !> The matrix of the free equations; nothing is factorised yet.
   subroutine prepare_refactorised(scene, model, solver, reason, retained, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=:), allocatable, intent(out) :: solver, reason
      integer, intent(out) :: retained             !! equations that contact touches
      type(error_type), allocatable, intent(out) :: error
      type(csc_type) :: k
      integer, allocatable :: touched(:)
      integer :: i

      call retained_equations(scene, model, touched)
      retained = size(touched)
      call reduce_matrix(scene%k, scene%constraints, [(i, i=1, scene%constraints%neq)], &
         & scene%constraints%neq, k)
      call scene%clock%stop_in(phase%assemble)
      call new_full_system(scene%full, k, scene%bodies%support, model%solver, error)
      solver = scene%full%definite_name
      reason = scene%full%reason
      if (allocated(error) .or. scene%rows%n == 0) return
      call choose_methods_of_rows(scene, model)
      associate (group => scene%problem%group)
         if (.not. any([(group(i)%method%solves_for_multiplier(), i=1, size(group))])) return
         solver = scene%full%indefinite_name
         reason = 'forces are unknowns: symmetric indefinite'
      end associate
   end subroutine prepare_refactorised

   subroutine choose_methods_of_rows(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      scene%problem%nrow = scene%rows%n
      scene%problem%group_first = scene%rows%group_first
      scene%problem%ngroup = size(model%pair)
      call choose_methods(scene, model)
   end subroutine choose_methods_of_rows

   !> Displacements and contact forces for the loads and prescribed values of one increment.
   subroutine solve_refactorised(scene, model, f, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed)
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: u_known(:), internal(:), right(:), v(:)

      allocate (u_known(scene%dofs%n), internal(scene%dofs%n), right(scene%constraints%neq))
      allocate (v(scene%constraints%neq), source=0.0_wp)
      call expand(scene%constraints, v, prescribed, u_known)
      call scene%k%multiply(u_known, internal)
      call reduce(scene%constraints, f - internal, right)
      call scene%clock%stop_in(phase%solve)
      call rebuild_rows(scene, model, prescribed)
      call fill_rows(scene, model, u_known, error)
      call take_counts(scene)
      if (allocated(error)) return
      call settle_with_continuation(scene, model, right)
      call take_counts(scene)
      if (allocated(scene%full%trouble)) then
         call move_alloc(scene%full%trouble, error)
      else if (scene%answer%outcome /= outcome%solved .and. scene%full%dependent_rows) then
         call raise(error, error_code%singular, 'E0310', &
            & 'the contact rows of a set depend on each other or on supports: its matrix is '// &
            & 'singular', model%step(scene%step)%at, &
            & help='list a pair of surfaces once, or leave out PATH=NEWTON: the default path '// &
            & 'shares the forces')
      else
         call explain_outcome(scene, model, error)
      end if
      if (allocated(error)) return
      call expand(scene%constraints, scene%answer%u, prescribed, scene%trial%motion%u)
      call scene%clock%stop_in(phase%solve)
   end subroutine solve_refactorised

   !> Operations and times of the system, which runs inside the contact phase.
   subroutine take_counts(scene)
      type(scene_type), intent(inout) :: scene

      call scene%clock%stop_in(phase%contact)
      associate (mine => scene%full%clock%seconds, all => scene%clock%seconds)
         all(phase%contact) = all(phase%contact) - sum(mine)
         all = all + mine
         mine = 0.0_wp
      end associate
      scene%counter%factorisations = scene%counter%factorisations &
         & + scene%full%counter%factorisations
      scene%counter%back_solves = scene%counter%back_solves + scene%full%counter%back_solves
      scene%full%counter%factorisations = 0
      scene%full%counter%back_solves = 0
   end subroutine take_counts

   !> Rows on the free equations; factors and stiffnesses are kept if they did not change.
   subroutine fill_rows(scene, model, u_known, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u_known(:)
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: first(:), equation(:)
      real(wp), allocatable :: value(:)
      integer :: row, k
      logical :: same, moved

      call reduce_rows(scene%rows, scene%constraints, u_known, first, equation, value, scene%gap)
      moved = scene%fresh_factor
      if (.not. moved) moved = size(scene%problem%first) /= size(first)
      if (.not. moved) moved = size(scene%problem%column) /= size(equation)
      if (.not. moved) moved = any(scene%problem%first /= first) &
         & .or. any(scene%problem%column /= equation)
      same = .not. moved
      if (same) same = all(scene%problem%value == value)
      scene%full%bilateral = scene%rows%bilateral
      if (same) then
         if (abs(scene%stiffer - scene%trial%contact%stiffer) > 0.0_wp) call set_stiffness(scene, &
            & model)
         return
      end if
      scene%fresh_factor = .false.
      associate (p => scene%problem, bodies => scene%bodies)
         call choose_methods_of_rows(scene, model)
         p%n = scene%constraints%neq
         p%nq = bodies%nq
         p%first = first
         p%column = equation
         p%value = value
         p%bilateral = scene%rows%bilateral
         if (allocated(p%c)) deallocate (p%c)
         allocate (p%c(p%nrow, p%nq), source=0.0_wp)
         do row = 1, p%nrow
            do k = first(row), first(row + 1) - 1
               p%c(row, :) = p%c(row, :) + value(k)*bodies%motion(equation(k), :)
            end do
         end do
      end associate
      if (allocated(scene%problem%s)) deallocate (scene%problem%s)
      if (wants_compliance(model)) call compliance_by_solves(scene, model, error)
      if (allocated(error)) return
      call set_stiffness(scene, model)
      call check_held(scene, model, error)
      if (allocated(error)) return
      scene%full%condensed_type = scene%problem
      scene%full%nq = 0
      deallocate (scene%full%c)
      allocate (scene%full%c(scene%problem%nrow, 0))
      call set_rows(scene%full, moved)
   end subroutine fill_rows

   !> S = B K^-1 B^T for the automatic stiffness, from a factor of K of its own (floating motions
   !> supported).
   subroutine compliance_by_solves(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(linear_system_type) :: aside
      real(wp), allocatable :: x(:, :)
      integer :: bad, from, to, row, other, k

      call new_linear_system(aside, scene%constraints%neq, scene%bodies%support, [integer ::])
      call factorise_system(aside, scene%k, scene%constraints, model%solver, scene%clock, &
         & scene%counter, bad, error)
      if (allocated(error)) return
      associate (p => scene%problem)
         allocate (p%s(p%nrow, p%nrow), source=0.0_wp)
         do from = 1, p%nrow, together
            to = min(p%nrow, from + together - 1)
            if (allocated(x)) deallocate (x)
            allocate (x(aside%n, to - from + 1), source=0.0_wp)
            do row = from, to
               do k = p%first(row), p%first(row + 1) - 1
                  if (aside%number(p%column(k)) == 0) cycle
                  x(aside%number(p%column(k)), row - from + 1) = p%value(k)
               end do
            end do
            call aside%solver%solve(x)
            do other = 1, p%nrow
               do k = p%first(other), p%first(other + 1) - 1
                  if (aside%number(p%column(k)) == 0) cycle
                  p%s(other, from:to) = p%s(other, from:to) &
                     & + p%value(k)*x(aside%number(p%column(k)), :)
               end do
            end do
         end do
         p%s = 0.5_wp*(p%s + transpose(p%s))
         scene%counter%back_solves = scene%counter%back_solves + p%nrow
      end associate
      call scene%clock%stop_in(phase%solve)
   end subroutine compliance_by_solves

   !> The sequence of problems of lecture J.1: softer penalties first, each starting from the last
   !> one's set.
   subroutine settle_with_continuation(scene, model, right)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: right(:)         !! (neq) loads [force]
      type(raising_type) :: raising
      integer :: stage

      scene%full%dependent_rows = .false.
      do
         do stage = model%continuation - 1, 0, -1
            scene%full%alpha = scene%problem%alpha*0.1_wp**stage
            call settle(scene%full, scene%gap, right, &
               & scene%bodies%motion(scene%bodies%support, :), scene%answer)
            scene%counter%iterations = scene%counter%iterations + scene%answer%iterations
            scene%counter%augmentations = scene%counter%augmentations &
               & + scene%answer%augmentations
            if (scene%answer%outcome /= outcome%solved) exit
         end do
         if (.not. wants_other_slope(raising, scene, model)) exit
         call set_stiffness(scene, model)
      end do
   end subroutine settle_with_continuation

   !> Solve; where a set on the way holds nothing, take proximal steps and try their sets without
   !> springs.
   subroutine settle(full, gap, right, motion, answer)
      type(full_system_type), intent(inout) :: full
      real(wp), intent(in) :: gap(:), right(:)
      real(wp), intent(in) :: motion(:, :)     !! (nq, nq) what each motion does at the supports
      type(contact_result_type), intent(inout) :: answer
      type(contact_result_type) :: trial
      real(wp), allocatable :: at(:), load(:)
      integer :: pass, iterations

      call solve_contact(full, gap, right, [real(wp) ::], answer)
      if (answer%outcome /= outcome%cycling .or. full%nmotion == 0) return
      iterations = answer%iterations
      trial = answer
      trial%active = .true.
      allocate (at(full%nmotion), source=0.0_wp)
      do pass = 1, most_steps
         load = right
         full%ground = soft*full%scale
         load(full%support) = load(full%support) + full%ground*at
         call solve_contact(full, gap, load, [real(wp) ::], trial)
         full%ground = 0.0_wp
         iterations = iterations + trial%iterations
         if (trial%outcome /= outcome%solved) exit
         answer%active = trial%active
         answer%multiplier = trial%multiplier
         call solve_contact(full, gap, right, [real(wp) ::], answer)
         iterations = iterations + answer%iterations
         if (answer%outcome == outcome%solved) exit
         answer%q = amplitudes(motion, trial%u(full%support) - at)
         at = trial%u(full%support)
      end do
      answer%iterations = iterations
      if (answer%outcome /= outcome%solved) answer%outcome = outcome%not_held
   end subroutine settle

   !> Amplitudes of the motions that move the supports so.
   function amplitudes(motion, drift) result(q)
      real(wp), intent(in) :: motion(:, :), drift(:)
      real(wp) :: q(size(drift)), factor(size(drift), size(drift)), x(size(drift), 1)
      integer :: exchange(size(drift)), info

      factor = motion
      x(:, 1) = drift
      call dgetrf(size(drift), size(drift), factor, size(drift), exchange, info)
      call dgetrs('N', size(drift), 1, factor, size(drift), exchange, x, size(drift), info)
      q = x(:, 1)
   end function amplitudes
end module lopin_path_refactorised
