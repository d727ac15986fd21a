!> The tangential traction of a law of friction from a trial: return to the disc, or a regularised
!> law.
!>
!> With pressure p >= 0, trial traction q = |lambda_t - c_t s| and direction m, all laws press with
!> t = F m. Exact: F is q inside the disc and its radius outside. Norton-Hoff, whose traction grows
!> with the speed of slip, bounds F by the root of q - c_t dgamma = F(dgamma); so does a coefficient
!> that falls with the speed, where that is the speed of the trial. Regularised: F is the
!> radius times a function of the slip that saturates at 1. Tractions are stresses.
module lopin_friction_return
   use lopin_kinds, only : wp
   use lopin_friction, only : friction_type, condition_type, law_of, regularization_of, by_rate, &
      & reads_speed, coefficient, friction_radius
   implicit none
   private
   public :: return_to_disc, regularised_traction, drag_limit, at_rest, steepest_fall

   !> Regularised laws with a length: the anchor follows where this share of the bound acts.
   real(wp), parameter :: saturated = 0.999_wp
   real(wp), parameter :: pi = acos(-1.0_wp)
   integer, parameter :: most_iterations = 100   !! of Newton in `rate_bound`; 2 to 9 are usual

contains

   !> Magnitude F of the traction for a trial magnitude q; Norton-Hoff bounds it by the slip speed.
   !> The point slips where F < q.
   pure subroutine return_to_disc(law, q, ct, p, at, traction, slope_q, slope_p)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: q                !! >= 0 [stress]
      real(wp), intent(in) :: ct               !! tangential stiffness > 0 [stress/length]
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: traction        !! F <= q [stress]
      real(wp), intent(out) :: slope_q, slope_p  !! of F [-]
      real(wp) :: radius, slope
      logical :: falls

      falls = at%of_trial .and. reads_speed(law)
      if (falls) then
         call friction_radius(law, p, at_rest(at), radius, slope)
      else
         call friction_radius(law, p, at, radius, slope)
      end if
      traction = q
      slope_q = 1.0_wp
      slope_p = 0.0_wp
      if (law%law == law_of%norton_hoff .and. law%q > 0.0_wp .and. p > 0.0_wp &
         & .and. .not. law%rough) call rate_bound(law%alpha*at%growth, &
         & law%q, q, ct*at%dt, traction, slope_q)
      if (traction > radius) then
         traction = radius
         slope_q = 0.0_wp
         slope_p = slope
         if (falls) call falling_bound(law, q, ct*at%dt, p, at, traction, slope_q, slope_p)
      end if
   end subroutine return_to_disc

   !> What a point that sticks reads: no speed.
   elemental type(condition_type) function at_rest(at) result(rest)
      type(condition_type), intent(in) :: at
      rest = at
      rest%speed = 0.0_wp
   end function at_rest

   !> d mu/d v at a speed [time/length].
   elemental real(wp) function fall_of_coefficient(law, speed) result(slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: speed            !! [length/time]
      slope = -law%decay*(law%mu_static - law%mu)*exp(-law%decay*speed)
   end function fall_of_coefficient

   !> The largest fall of the bound with the slip of the increment, in size [stress/length].
   elemental real(wp) function steepest_fall(law, p, at) result(slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      slope = 0.0_wp
      if (at%of_trial .and. p > 0.0_wp .and. reads_speed(law)) &
         & slope = p*abs(fall_of_coefficient(law, 0.0_wp))/at%dt
   end function steepest_fall

   !> The root v > 0 of q = c v + mu(v) p of a trial above the bound at rest, and F = mu(v) p, if
   !> that is below what caps it.
   !>
   !> What is left, q - c v - mu(v) p, is concave where mu falls: Newton from a speed beyond the
   !> root, that of mu_k p, comes down to it, and there is one root alone. Where mu rises it is
   !> convex, and Newton comes up from rest.
   pure subroutine falling_bound(law, q, c, p, at, traction, slope_q, slope_p)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: q                !! trial [stress]
      real(wp), intent(in) :: c                !! tangential stiffness * time [stress*time/length]
      real(wp), intent(in) :: p                !! > 0 [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: traction        !! F [stress]
      real(wp), intent(out) :: slope_q, slope_p
      type(condition_type) :: moving
      real(wp) :: step, fall
      integer :: i

      slope_q = 0.0_wp
      moving = at_rest(at)
      if (law%mu < law%mu_static) moving%speed = (q - law%mu*p)/c
      do i = 1, most_iterations
         fall = p*fall_of_coefficient(law, moving%speed)
         step = (q - c*moving%speed - p*coefficient(law, moving))/(c + fall)
         ! No root: what caps the bound is below it.
         if (.not. c + fall > 0.0_wp) step = -moving%speed
         moving%speed = max(moving%speed + step, 0.0_wp)
         if (.not. abs(step) > 4.0_wp*epsilon(1.0_wp)*moving%speed) exit
         if (.not. moving%speed > 0.0_wp) exit
      end do
      call friction_radius(law, p, moving, traction, slope_p)
      if (.not. slope_p > 0.0_wp) return
      fall = p*fall_of_coefficient(law, moving%speed)/c
      slope_q = fall/(1.0_wp + fall)
      slope_p = slope_p/(1.0_wp + fall)
   end subroutine falling_bound

   !> The root F of q = F + c (F/alpha)^n, n = 1/exponent >= 1: what is left of the trial is the
   !> slip that its speed needs.
   !>
   !> Convex and increasing in F, with a finite slope at 0 (in the speed it would be infinite):
   !> Newton from an upper bound descends to the root. F is scaled by that bound so that
   !> large n neither overflow nor lose it.
   pure subroutine rate_bound(alpha, exponent, q, c, traction, slope)
      real(wp), intent(in) :: alpha            !! of the law, >= 0 [stress*(time/length)^exponent]
      real(wp), intent(in) :: exponent         !! 0..1 [-]
      real(wp), intent(in) :: q                !! trial, >= 0 [stress]
      real(wp), intent(in) :: c                !! tangential stiffness * time [stress*time/length]
      real(wp), intent(out) :: traction, slope
      real(wp) :: bound, power, x, step, n, rest
      integer :: i

      traction = 0.0_wp
      slope = 0.0_wp
      if (.not. alpha > 0.0_wp) return
      n = 1.0_wp/exponent
      slope = 1.0_wp
      if (n <= 1.0_wp) slope = 1.0_wp/(1.0_wp + c/alpha)
      if (.not. q > 0.0_wp) return
      bound = alpha*(q/c)**exponent
      power = q
      if (bound > q) then
         bound = q
         power = c*(q/alpha)**n
      end if
      x = 1.0_wp
      do i = 1, most_iterations
         rest = power*x**n
         step = (bound*x + rest - q)/(bound + n*rest/x)
         if (step <= epsilon(1.0_wp)*x) exit
         x = x - step
      end do
      traction = bound*x
      slope = traction/(traction + n*power*x**n)
   end subroutine rate_bound

   !> Magnitude of a regularised law for a slip magnitude from the anchor, or made in the increment.
   !>
   !> Near slip 0 the direction is lost but traction/slip -> slope_slip. Where a law of slip draws
   !> its anchor along, `drawn` is how far, and the slope is that of the whole way.
   pure subroutine regularised_traction(law, slip, p, at, traction, slope_slip, slope_p, drawn)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: slip   !! >= 0; of the increment if `by_rate(law)` [length]
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: traction        !! [stress]
      real(wp), intent(out) :: slope_slip      !! [stress/length]
      real(wp), intent(out) :: slope_p         !! [-]
      real(wp), intent(in), optional :: drawn  !! >= 0 [length]
      type(condition_type) :: moving
      real(wp) :: radius, cap, u0, share, slope, growth, faster

      moving = at
      faster = 0.0_wp
      if (at%of_trial .and. reads_speed(law) .and. (by_rate(law) .or. present(drawn))) then
         moving%speed = slip/at%dt
         if (present(drawn) .and. .not. by_rate(law)) moving%speed = drawn/at%dt
         if (by_rate(law) .or. moving%speed > 0.0_wp) &
            & faster = fall_of_coefficient(law, moving%speed)/at%dt
      end if
      call friction_radius(law, p, moving, radius, slope_p)
      ! Where nothing caps it the bound is the coefficient times the pressure.
      faster = merge(p*faster, 0.0_wp, slope_p > 0.0_wp)
      cap = radius
      u0 = law%elastic_slip
      if (law%v0 > 0.0_wp) u0 = law%v0*at%dt
      call saturation(law%regularization, slip/u0, share, slope)
      growth = faster
      if (law%law == law_of%norton_hoff .and. law%q > 0.0_wp .and. p > 0.0_wp) &
         & call smoothed_rate(law, slip, u0, at, radius, growth)
      if (radius < cap) slope_p = 0.0_wp
      traction = radius*share
      slope_slip = radius*slope/u0 + growth*share
      if (present(drawn)) then
         if (drawn > 0.0_wp) slope_slip = growth*share
      end if
      slope_p = slope_p*share
   end subroutine regularised_traction

   !> Slip from the anchor beyond which a regularised law draws the anchor along: where it has all
   !> but its whole bound, so that a reversal finds it near. A law of rate has no anchor.
   pure real(wp) function drag_limit(law) result(limit)
      type(friction_type), intent(in) :: law

      limit = huge(1.0_wp)
      if (by_rate(law)) return
      select case (law%regularization)
      case (regularization_of%tanh)
         limit = law%elastic_slip*atanh(saturated)
      case (regularization_of%sqrt)
         limit = law%elastic_slip*saturated/sqrt(1.0_wp - saturated**2)
      case default
         limit = law%elastic_slip*tan(0.5_wp*acos(-1.0_wp)*saturated)
      end select
   end function drag_limit

   !> alpha (v^2 + v0^2)^(q/2) and its slope in the slip, under the cap that `radius` holds; times
   !> v/sqrt(v^2 + v0^2), the square root's share, it is alpha (v^2 + v0^2)^((q-1)/2) v.
   pure subroutine smoothed_rate(law, slip, u0, at, radius, growth)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: slip, u0         !! [length]
      type(condition_type), intent(in) :: at
      real(wp), intent(inout) :: radius        !! in: the cap [stress]
      real(wp), intent(out) :: growth          !! d radius / d slip [stress/length]
      real(wp) :: free

      free = law%alpha*at%growth*(hypot(slip, u0)/at%dt)**law%q
      growth = 0.0_wp
      if (free > radius) return
      radius = free
      growth = law%q*free*slip/(slip**2 + u0**2)
   end subroutine smoothed_rate

   !> A function of x = slip/u0 or v/v0 that rises from 0 and saturates at 1, and its slope.
   pure subroutine saturation(regularization, x, share, slope)
      integer, intent(in) :: regularization    !! regularization_of%...
      real(wp), intent(in) :: x                !! >= 0 [-]
      real(wp), intent(out) :: share, slope    !! [-]

      select case (regularization)
      case (regularization_of%tanh)
         share = tanh(x)
         slope = 1.0_wp - share**2
      case (regularization_of%sqrt)
         share = x/hypot(1.0_wp, x)
         slope = 1.0_wp/hypot(1.0_wp, x)**3
      case default
         share = 2.0_wp/pi*atan(x)
         slope = 2.0_wp/pi/(1.0_wp + x**2)
      end select
   end subroutine saturation
end module lopin_friction_return
