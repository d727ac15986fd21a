!> Open, stick or slip: contact with friction on the condensed compliance, all points together.
!>
!> Newton (lopin_friction_newton) on the equations of lopin_friction_rows, reduced to the closed
!> rows. The tangential scaling is the collective compliance of the closed points
!> (lopin_friction_scaling): with the nodal one Newton cycles. Where states repeat without progress,
!> in order: the load of the increment in parts; the tangent of Hueeber, Stadler and Wohlmuth; one
!> normal row at a time; a fixed point on the bounds (Tresca), whose problems are convex;
!> coefficients from where all sticks down to those of the laws. Bodies that only contact and
!> friction hold move with the unknown motions q, C^T lambda = -moving.
module lopin_friction_set
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_soft_share, only : largest_share
   use lopin_condensed, only : condensed_type, form_compliance, rows_times
   use lopin_dense, only : cholesky_solve
   use lopin_active_set, only : contact_result_type, outcome
   use lopin_friction_rows, only : friction_points_type, new_equations, form_equations
   use lopin_friction_step, only : trial_type, work_type, friction_controls_type
   use lopin_friction_tangents, only : step_to
   use lopin_friction_newton, only : newton
   use lopin_friction_touch, only : slip_from_touch
   use lopin_friction_scaling, only : noise_of
   implicit none
   private
   public :: solve_friction, friction_result_type, friction_controls_type

   integer, parameter :: most_bounds = 100, most_parts = 60
   real(wp), parameter :: least_part = 1.0e-4_wp
   real(wp), parameter :: most_friction = 16.0_wp   !! what coefficients are multiplied by at first
   !> Changes below this share of the largest force end the augmentation, and the fixed point.
   real(wp), parameter :: settled = 1.0e-10_wp
   !> Newton and its fallbacks, in order.
   type :: fallbacks
      integer :: newton = 1, load = 2, damped = 3, single = 4, bounds = 5, friction = 6
   end type fallbacks
   type(fallbacks), parameter :: fallback = fallbacks()

   type :: friction_result_type
      integer, allocatable :: status(:)            !! (npoint) 0 open, 1 stick, 2 slip
      integer :: cure = 1                          !! fallback%... that solved it
      integer :: sign_of_determinant = 1   !! of the tangent at the answer; < 0: not the only one
      integer, allocatable :: changing(:)          !! points whose state still changed at the end
      real(wp), allocatable :: norms(:)            !! residuals of the iterations
      real(wp), allocatable :: noise(:)            !! (nrow) rounding of the gaps [length]
   end type friction_result_type

contains

   !> Forces, gaps and motions for gaps without displacement, condensed loads and loads on the
   !> floating motions. `result` may hold forces and motions to start from.
   subroutine solve_friction(self, points, gap0, load, moving, result, friction, controls)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(inout) :: points
      real(wp), intent(in) :: gap0(:)      !! (nrow) [length]
      real(wp), intent(in) :: load(:)      !! (n) [force]
      real(wp), intent(in) :: moving(:)    !! (nq) [force]
      type(contact_result_type), intent(inout) :: result
      type(friction_result_type), intent(out) :: friction
      type(friction_controls_type), intent(in), optional :: controls
      type(work_type) :: work
      type(trial_type) :: x
      real(wp) :: moved, last, size_
      integer :: pass, most

      call prepare(self, points, gap0, load, moving, result, work, x)
      if (present(controls)) work%controls = controls
      work%predict = work%predict .and. work%controls%predict
      call slip_from_touch(self, points, work, x)
      last = 0.0_wp
      size_ = 0.0_wp
      most = max(1, maxval(self%max_augmentations))
      do pass = 1, most
         call try_in_turn(self, points, work, x, result%outcome)
         if (result%outcome /= outcome%solved) exit
         size_ = max(size_, largest(x%force))
         call augment(self, points, work, x, moved)
         if (.not. moved > 0.0_wp) exit
         result%augmentations = pass
         if (last > 0.0_wp) result%rate = min(moved/last, 0.999_wp)
         if (moved <= settled*size_ .and. last > 0.0_wp) exit
         last = moved
         if (pass == most) result%outcome = outcome%not_augmented
      end do
      result%force = x%force
      result%gap = x%gap
      result%q = x%q
      result%active = work%equations%closed
      result%iterations = work%iterations
      result%single_pivots = work%single_pivots
      result%dependent = work%dependent
      result%opening = largest(matmul(self%s, x%force))
      result%opening = max(result%opening, 1.0e-6_wp*work%gap_scale)
      friction%noise = noise_of(self, work, x)
      friction%status = work%equations%status
      friction%cure = work%cure
      friction%norms = work%norms
      friction%changing = work%changing
      friction%sign_of_determinant = work%sign_of_determinant
      if (result%outcome == outcome%solved) call estimate_soft_error(self, points, work, x, result)
   end subroutine solve_friction

   subroutine prepare(self, points, gap0, load, moving, result, work, x)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      real(wp), intent(in) :: gap0(:), load(:), moving(:)
      type(contact_result_type), intent(inout) :: result
      type(work_type), intent(out) :: work
      type(trial_type), intent(out) :: x
      real(wp), allocatable :: u(:)
      integer :: i, group
      logical :: warm

      call form_compliance(self)
      u = load
      call cholesky_solve(self%l, u)
      work%free_gap = gap0 + rows_times(self, u)
      work%gap_scale = largest(gap0) + largest(work%free_gap - gap0)
      work%moving = moving
      allocate (work%q_scale(self%nq))
      do i = 1, self%nq
         work%q_scale(i) = 1.0_wp/max(maxval(abs(self%c(:, i))), tiny(1.0_wp))
      end do
      call new_equations(work%equations, self, points)
      work%nodal = work%equations%c
      warm = allocated(result%force) .and. allocated(result%q)
      if (warm) warm = size(result%force) == self%nrow .and. size(result%q) == self%nq
      allocate (x%force(self%nrow), x%q(self%nq), source=0.0_wp)
      if (warm) then
         x%force = result%force
         x%q = result%q
      end if
      ! Of several answers the first is the one of points that touch and stick.
      work%touching = gap0 <= 0.0_wp .or. self%nq > 0
      work%cold = .not. any(abs(x%force) > 0.0_wp)
      work%predict = .not. work%cold .or. any(work%touching .and. work%equations%group > 0)
      x%gap = work%free_gap + matmul(self%s, x%force) + matmul(self%c, x%q)
      work%old_gap = max(gap0, 0.0_wp)
      if (.not. work%cold) work%old_gap = result%gap
      do i = 1, points%n
         work%old_gap(points%tangent(i):points%tangent(i) + points%nt - 1) = points%start(:, i)
      end do
      do group = 1, self%ngroup
         if (self%max_augmentations(group) == 0) cycle
         associate (from => self%group_first(group), to => self%group_first(group + 1) - 1)
            work%equations%shift(from:to) = work%equations%compliance(from:to)*x%force(from:to)
         end associate
      end do
      result%outcome = outcome%solved
      result%augmentations = 0
      result%soft_error = 0.0_wp
      result%softness = 0.0_wp
   end subroutine prepare

   !> The fallbacks in turn: each starts from the state that the last accepted increment left.
   subroutine try_in_turn(self, points, work, x, reached)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      integer, intent(out) :: reached              !! outcome%...
      type(trial_type) :: start
      logical :: solved, predict
      integer :: cure

      start = x
      predict = work%predict
      do cure = fallback%newton, fallback%friction
         x = start
         work%predict = predict .and. cure /= fallback%single .and. cure /= fallback%load
         work%equations%damped = cure == fallback%damped
         work%one_by_one = cure == fallback%single
         if (allocated(work%equations%set)) deallocate (work%equations%set)
         work%cure = cure
         if (cure == fallback%bounds) then
            call fix_bounds(self, points, work, x, solved)
         else if (cure == fallback%load) then
            call follow_load(self, points, work, x, solved)
         else if (cure == fallback%friction) then
            call follow_friction(self, points, work, x, solved)
         else
            call newton(self, points, work, x, solved)
         end if
         if (solved .or. .not. work%controls%ladder) exit
      end do
      work%predict = .false.
      work%equations%damped = .false.
      work%one_by_one = .false.
      if (allocated(work%equations%set)) deallocate (work%equations%set)
      reached = outcome%solved
      if (solved) return
      reached = outcome%cycling
      if (work%singular .and. self%nq > 0) reached = outcome%not_held
   end subroutine try_in_turn

   !> The load of the increment bit by bit, all bits from the same accepted state: each answer
   !> starts the next one, and the last is that of the whole increment.
   subroutine follow_load(self, points, work, x, solved)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      logical, intent(out) :: solved
      type(trial_type) :: next
      real(wp) :: free_end(self%nrow), moving_end(self%nq), free_start(self%nrow), &
         & moving_start(self%nq), reached, share, part
      integer :: pass

      free_end = work%free_gap
      moving_end = work%moving
      free_start = work%old_gap - (x%gap - free_end)
      moving_start = -matmul(x%force, self%c)
      reached = 0.0_wp
      share = 0.25_wp
      do pass = 1, most_parts
         part = min(1.0_wp, reached + share)
         if (part > 0.999_wp) part = 1.0_wp
         work%free_gap = free_end
         work%moving = moving_end
         if (part < 1.0_wp) then
            work%free_gap = free_start + part*(free_end - free_start)
            work%moving = moving_start + part*(moving_end - moving_start)
         end if
         next = x
         next%gap = work%free_gap + matmul(self%s, x%force) + matmul(self%c, x%q)
         call newton(self, points, work, next, solved)
         if (solved) then
            x = next
            reached = part
            if (part >= 1.0_wp) exit
            share = 2.0_wp*share
         else
            share = 0.25_wp*share
            if (share < least_part) exit
         end if
      end do
      work%free_gap = free_end
      work%moving = moving_end
      solved = solved .and. reached >= 1.0_wp
   end subroutine follow_load

   !> Coefficients from where all that touches sticks down to those of the laws: each answer starts
   !> the next one, and the last is that of the increment.
   subroutine follow_friction(self, points, work, x, solved)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      logical, intent(out) :: solved
      type(friction_points_type) :: rough
      type(trial_type) :: next
      real(wp) :: factor, ratio, part
      integer :: pass

      solved = .false.
      if (.not. any(points%law%mu > 0.0_wp)) return
      rough = points
      factor = 2.0_wp*most_friction
      ratio = 2.0_wp
      do pass = 1, most_parts
         part = max(1.0_wp, factor/ratio)
         rough%law%mu = part*points%law%mu
         rough%law%mu_static = part*points%law%mu_static
         next = x
         call newton(self, rough, work, next, solved)
         if (solved) then
            x = next
            factor = part
            if (part <= 1.0_wp) exit
            ratio = ratio**2
         else
            if (pass == 1) exit
            ratio = ratio**0.25_wp
            if (ratio - 1.0_wp < least_part) exit
         end if
      end do
      solved = solved .and. factor <= 1.0_wp
   end subroutine follow_friction

   !> Tresca's fixed point: bounds from the pressures found last, until they stay.
   subroutine fix_bounds(self, points, work, x, solved)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(inout) :: x
      logical, intent(out) :: solved
      real(wp) :: press(points%n), moved, last, share
      integer :: pass

      last = huge(1.0_wp)
      share = 1.0_wp
      press = max(x%force(points%normal), 0.0_wp)
      solved = .false.
      do pass = 1, most_bounds
         work%equations%frozen = press
         call newton(self, points, work, x, solved)
         if (.not. solved) exit
         moved = largest(max(x%force(points%normal), 0.0_wp) - press)
         solved = moved <= settled*largest(x%force)
         if (solved) exit
         if (moved > 0.7_wp*last) share = 0.5_wp
         press = press + share*(max(x%force(points%normal), 0.0_wp) - press)
         last = moved
      end do
      deallocate (work%equations%frozen)
      ! Bounds that all but stay start Newton well; what counts is its residual.
      call newton(self, points, work, x, solved)
   end subroutine fix_bounds

   !> Uzawa's update of the augmented groups, normal and tangential; `moved` is by how much.
   subroutine augment(self, points, work, x, moved)
      type(condensed_type), intent(in) :: self
      type(friction_points_type), intent(inout) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      real(wp), intent(out) :: moved
      real(wp) :: elastic(points%nt)
      integer :: group, k

      moved = 0.0_wp
      associate (e => work%equations)
         do group = 1, self%ngroup
            if (self%max_augmentations(group) == 0) cycle
            associate (from => self%group_first(group), to => self%group_first(group + 1) - 1)
               moved = max(moved, largest((e%shift(from:to) - e%compliance(from:to) &
                  & *x%force(from:to))/e%compliance(from:to)))
               e%shift(from:to) = e%compliance(from:to)*x%force(from:to)
            end associate
         end do
         do k = 1, points%n
            if (.not. points%augmented(k)) cycle
            elastic = -x%force(points%tangent(k):points%tangent(k) + points%nt - 1)/&
               & points%stiffness(k)
            moved = max(moved, points%stiffness(k)*largest(elastic - points%elastic(:, k)))
            points%elastic(:, k) = elastic
         end do
      end associate
   end subroutine augment

   !> One augmentation of what allows penetration or elastic slip, linearised: what it changes is
   !> the error of these forces.
   subroutine estimate_soft_error(self, points, work, x, result)
      type(condensed_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      type(work_type), intent(inout) :: work
      type(trial_type), intent(in) :: x
      type(contact_result_type), intent(inout) :: result
      type(trial_type) :: once
      logical :: soft(self%nrow)
      real(wp) :: size_

      result%soft_error = 0.0_wp
      result%softness = 0.0_wp
      soft = work%equations%compliance > 0.0_wp
      size_ = norm2(pack(x%force, soft))
      if (.not. size_ > 0.0_wp) return
      where (soft) work%equations%shift = work%equations%compliance*x%force
      call form_equations(work%equations, self, points, x%force, x%gap)
      call step_to(self, points, work, x, once)
      result%softness = largest_share(once%force - x%force, x%force, self%group_first)
      result%soft_error = max(norm2(pack(once%force - x%force, soft))/size_, result%softness)
   end subroutine estimate_soft_error
end module lopin_friction_set
