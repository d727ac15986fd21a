!> The return to a yield surface of any shape that moves and grows, with its consistent tangent.
!>
!> Works at small strain and in logarithmic elastic strain alike: the deviator of the trial elastic
!> strain goes in, on the axes of the material, and the law of elasticity is Hooke's. Written with
!> x = s - alpha, half of the square of the equivalent stress psi, plastic strain of the increment
!> dp and flow stress y(dp):
!>
!>    (1 + mu) x + 2 G lambda psi'(x) = b,  lambda = dp/y,  mu = gain/y,  b = s_trial - left alpha
!>    phi(x) = y
!>
!> For given dp the first line is the minimum of a convex function, which is one linear system where
!> the surface is quadratic; phi(x(dp)) - y(dp) falls with dp, so a bracketed Newton iteration in
!> this one number finds the only root. Von Mises' surface that only grows has a closed form of its
!> own in module radial_return.
module lopin_plastic_return
   use lopin_kinds, only : wp
   use lopin_kelvin, only : solve_positive, positive_factor, unit_kelvin, deviator_of
   use lopin_flow_curve, only : flow_type, flow_stress, flow_step
   use lopin_yield_surface, only : yield_type
   use lopin_kinematic_hardening, only : kinematic_type, kinematic_step, most_parts
   implicit none
   private
   public :: plastic_type, plastic_past_type, plastic_answer_type, return_to_surface

   !> A trial stress beyond yield by no more than this share is rounding: the point is at rest.
   real(wp), parameter :: rest = 1.0e-9_wp

   !> What a law has beside its flow curve.
   type :: plastic_type
      class(yield_type), allocatable :: yield
      type(kinematic_type) :: kinematic
      real(wp) :: axes(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, &
         & 0.0_wp, 1.0_wp], [3, 3])          !! rows: axes of the material
   end type plastic_type

   !> The accepted state of a point.
   type :: plastic_past_type
      real(wp) :: strain = 0.0_wp            !! accumulated plastic strain
      real(wp) :: dt = 1.0_wp                !! since then, > 0 [time]
      real(wp) :: radius = 0.0_wp            !! flow stress [stress]
      real(wp) :: back(6, most_parts) = 0.0_wp   !! parts of the backstress, deviators [stress]
   end type plastic_past_type

   !> What a trial leads to; all on the axes of the material, in Kelvin vectors.
   type :: plastic_answer_type
      real(wp) :: stress(6) = 0.0_wp         !! deviator [stress]
      real(wp) :: slope(6, 6) = 0.0_wp       !! d stress/d trial strain [stress]
      real(wp) :: flow(6) = 0.0_wp           !! increment of the plastic strain
      real(wp) :: step = 0.0_wp              !! of its accumulated measure
      real(wp) :: radius = 0.0_wp            !! flow stress [stress]
      real(wp) :: along = 0.0_wp             !! stress that works on `step` [stress]
      real(wp) :: work = 0.0_wp              !! of the increment per volume [stress]
      real(wp) :: back(6, most_parts) = 0.0_wp
      logical :: found = .true.              !! the iterations have converged
   end type plastic_answer_type

   !> One value of dp, and what follows from it.
   type :: trial_type
      real(wp) :: dp = 0.0_wp, y = 0.0_wp, y_slope = 0.0_wp
      real(wp) :: lambda = 0.0_wp, mu = 0.0_wp, mu_slope = 0.0_wp
      real(wp) :: b(6) = 0.0_wp, b_slope(6) = 0.0_wp
      real(wp) :: x(6) = 0.0_wp, phi = 0.0_wp, gradient(6) = 0.0_wp
      real(wp) :: x_slope(6) = 0.0_wp        !! dx/d dp
      real(wp) :: factor(6, 6) = 0.0_wp      !! of (1 + mu) + 2 G lambda psi''
      logical :: found = .true.
   end type trial_type

contains

   pure subroutine return_to_surface(self, flow, shear, strain, past, answer)
      type(plastic_type), intent(in) :: self
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: shear          !! G > 0 [stress]
      real(wp), intent(in) :: strain(6)      !! trial elastic strain; its deviator counts
      type(plastic_past_type), intent(in) :: past
      type(plastic_answer_type), intent(out) :: answer
      type(trial_type) :: at
      real(wp) :: elastic(6), slope, rate_slope
      integer :: k

      elastic = 2.0_wp*shear*deviator_of(strain)
      call flow_stress(flow, past%strain, 0.0_wp, at%y, slope, rate_slope)
      at%b = elastic - sum(past%back(:, :self%kinematic%n), dim=2)
      call self%yield%evaluate(at%b, at%phi, at%gradient, answer%slope)
      answer%back = past%back
      answer%radius = past%radius
      if (at%phi <= at%y*(1.0_wp + rest)) then
         answer%stress = elastic
         answer%slope = 0.0_wp
         do k = 1, 6
            answer%slope(k, k) = 2.0_wp*shear
         end do
         answer%slope(:3, :3) = answer%slope(:3, :3) - 2.0_wp/3.0_wp*shear
         return
      end if
      call find_step(self, flow, shear, elastic, past, at)
      call leave_surface(self, shear, elastic, past, at, answer)
   end subroutine return_to_surface

   !> The root of phi(x(dp)) - y(dp).
   pure subroutine find_step(self, flow, shear, elastic, past, at)
      type(plastic_type), intent(in) :: self
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: shear, elastic(6)
      type(plastic_past_type), intent(in) :: past
      type(trial_type), intent(inout) :: at  !! in: phi and its gradient at dp = 0
      integer, parameter :: most = 100
      real(wp) :: low, high, next, excess, stiff, stress, slope
      integer :: i

      ! As if the direction stayed: then one step of the radial return.
      stiff = (2.0_wp*shear*dot_product(at%gradient, at%gradient) &
         & + sum(self%kinematic%modulus(:self%kinematic%n)))/3.0_wp
      call flow_step(flow, stiff, at%phi, past%strain, past%dt, next, stress, slope)
      at%x = at%b
      low = 0.0_wp
      high = huge(high)
      do i = 1, most
         at%dp = next
         call try_step(self, flow, shear, elastic, past, at)
         if (.not. at%found) return
         excess = at%phi - at%y
         if (excess > 0.0_wp) low = at%dp
         if (excess <= 0.0_wp) high = at%dp
         next = at%dp - excess/(dot_product(at%gradient, at%x_slope) - at%y_slope)
         if (abs(next - at%dp) <= 2.0_wp*epsilon(next)*(next + norm2(elastic)/shear)) return
         if (.not. next > low) next = 0.5_wp*(low + at%dp)
         if (.not. next < high) next = 0.5_wp*(at%dp + high)
         if (.not. (next > low .and. next < high)) return
      end do
      at%found = .false.
   end subroutine find_step

   !> What follows from one value of dp.
   pure subroutine try_step(self, flow, shear, elastic, past, at)
      type(plastic_type), intent(in) :: self
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: shear, elastic(6)
      type(plastic_past_type), intent(in) :: past
      type(trial_type), intent(inout) :: at  !! in: dp and a first guess of x
      real(wp), dimension(self%kinematic%n) :: left, gain, left_slope, gain_slope
      real(wp) :: rate_slope, lambda_slope
      integer :: n

      n = self%kinematic%n
      call flow_stress(flow, past%strain + at%dp, at%dp/past%dt, at%y, at%y_slope, rate_slope)
      at%y_slope = at%y_slope + rate_slope/past%dt
      call kinematic_step(self%kinematic, at%dp, left, gain, left_slope, gain_slope)
      at%lambda = at%dp/at%y
      lambda_slope = (1.0_wp - at%lambda*at%y_slope)/at%y
      at%mu = sum(gain)/at%y
      at%mu_slope = (sum(gain_slope) - at%mu*at%y_slope)/at%y
      at%b = elastic - matmul(past%back(:, :n), left)
      at%b_slope = -matmul(past%back(:, :n), left_slope)
      call nearest(self, 2.0_wp*shear*at%lambda, at)
      at%x_slope = solve_positive(at%factor, at%b_slope - at%mu_slope*at%x &
         & - (2.0_wp*shear*lambda_slope*at%phi)*at%gradient)
   end subroutine try_step

   !> The x at which (1 + mu) x.x/2 + weight psi(x) - b.x is least: Newton with a search along the
   !> line, whose first step is the answer where psi is quadratic.
   pure subroutine nearest(self, weight, at)
      type(plastic_type), intent(in) :: self
      real(wp), intent(in) :: weight
      type(trial_type), intent(inout) :: at
      integer, parameter :: most = 60, most_halvings = 30
      real(wp) :: force(6), way(6), start(6), before, along, share
      integer :: i, halving

      before = huge(before)
      start = at%x
      way = 0.0_wp
      along = 0.0_wp
      share = 1.0_wp
      halving = 0
      do i = 1, most
         call self%yield%evaluate(at%x, at%phi, at%gradient, at%factor)
         associate (height => 0.5_wp*((1.0_wp + at%mu)*dot_product(at%x, at%x) &
            & + weight*at%phi**2) - dot_product(at%b, at%x))
            if (i > 1 .and. height > before + 1.0e-4_wp*share*along + 4.0_wp*epsilon(height) &
               & *dot_product(at%b, at%b) .and. halving < most_halvings) then
               share = 0.5_wp*share
               halving = halving + 1
               at%x = start + share*way
               cycle
            end if
            before = height
         end associate
         force = (1.0_wp + at%mu)*at%x + (weight*at%phi)*at%gradient - at%b
         at%factor = weight*at%factor
         at%factor = at%factor + (1.0_wp + at%mu)*identity()
         call positive_factor(at%factor)
         if (norm2(force) <= 8.0_wp*epsilon(share)*norm2(at%b)) return
         start = at%x
         way = -solve_positive(at%factor, force)
         along = dot_product(force, way)
         share = 1.0_wp
         halving = 0
         at%x = start + way
         if (norm2(way) <= 4.0_wp*epsilon(share)*norm2(start)) return
      end do
      ! What rounding leaves of the force moves no digit that counts.
      at%found = norm2(force) <= 1.0e-12_wp*norm2(at%b)
   end subroutine nearest

   pure function identity() result(one)
      real(wp) :: one(6, 6)
      integer :: k

      one = 0.0_wp
      do k = 1, 6
         one(k, k) = 1.0_wp
      end do
   end function identity

   !> The state on the surface and the consistent tangent.
   pure subroutine leave_surface(self, shear, elastic, past, at, answer)
      type(plastic_type), intent(in) :: self
      real(wp), intent(in) :: shear, elastic(6)
      type(plastic_past_type), intent(in) :: past
      type(trial_type), intent(in) :: at
      type(plastic_answer_type), intent(inout) :: answer
      real(wp), dimension(self%kinematic%n) :: left, gain, left_slope, gain_slope
      real(wp) :: column(6), row(6), fall, means(6)
      integer :: k

      answer%found = at%found
      answer%step = at%dp
      answer%radius = at%y
      answer%flow = at%dp*at%gradient
      answer%stress = elastic - at%b + (1.0_wp + at%mu)*at%x
      call kinematic_step(self%kinematic, at%dp, left, gain, left_slope, gain_slope)
      do k = 1, self%kinematic%n
         answer%back(:, k) = left(k)*past%back(:, k) + (gain(k)/at%y)*at%x
      end do
      answer%along = dot_product(answer%stress, at%gradient)
      answer%work = 0.5_wp*at%dp*(past%radius + dot_product(at%gradient, &
         & sum(past%back(:, :self%kinematic%n), dim=2)) + answer%along)
      ! d stress = (1 + mu) M^-1 db + column d dp, d dp = -row.db/fall, M the matrix of `factor`.
      column = (1.0_wp + at%mu)*at%x_slope + at%mu_slope*at%x - at%b_slope
      row = solve_positive(at%factor, at%gradient)
      fall = dot_product(at%gradient, at%x_slope) - at%y_slope
      do k = 1, 6
         answer%slope(:, k) = 2.0_wp*shear*((1.0_wp + at%mu)*solve_positive(at%factor, axis(k)) &
            & - column*(row(k)/fall))
      end do
      ! Only the deviator of the strain counts.
      means = (answer%slope(:, 1) + answer%slope(:, 2) + answer%slope(:, 3))/3.0_wp
      do k = 1, 3
         answer%slope(:, k) = answer%slope(:, k) - means*unit_kelvin(k)
      end do
   end subroutine leave_surface

   pure function axis(k) result(one)
      integer, intent(in) :: k
      real(wp) :: one(6)
      one = 0.0_wp
      one(k) = 1.0_wp
   end function axis
end module lopin_plastic_return
