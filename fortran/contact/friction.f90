!> Friction laws: one kernel; a law is the radius of a disc and its slopes (seed E).
!>
!> With pressure p >= 0, trial traction q = |lambda_t - c_t s| and direction m, all laws press with
!> t = F m, F = min(q, radius) or a regularised function of the slip. Tractions are stresses.
module lopin_friction
   use lopin_kinds, only : wp
   implicit none
   private
   public :: friction_type, condition_type, law_of, regularization_of
   public :: has_friction, is_regularised, friction_radius, return_to_disc, regularised_traction

   type :: laws
      integer :: none = 0, coulomb = 1, tresca = 2, orowan = 3, cristescu = 4, norton_hoff = 5
   end type laws
   type(laws), parameter :: law_of = laws()

   type :: regularizations
      integer :: linear = 1     !! return mapping: exact stick, or elastic slip where asked for
      integer :: arctan = 2, tanh = 3, sqrt = 4
   end type regularizations
   type(regularizations), parameter :: regularization_of = regularizations()

   !> Parameters of the law of one interaction, as the deck gave them.
   type :: friction_type
      integer :: law = 0                       !! law_of%...
      integer :: regularization = 1            !! regularization_of%...
      logical :: rough = .false.               !! no slip at all
      logical :: exact_stick = .false.         !! LAGRANGE: no elastic slip whatever the method
      real(wp) :: mu = 0.0_wp                  !! coefficient (kinetic, if it decays) [-]
      real(wp) :: mu_static = 0.0_wp           !! with `decay` > 0 [-]
      real(wp) :: decay = 0.0_wp               !! EXPONENTIAL DECAY [time/length]; 0: none
      real(wp) :: m = 0.0_wp                   !! shear factor of Tresca, Orowan, Cristescu [-]
      real(wp) :: alpha = 0.0_wp               !! Norton-Hoff [stress*(time/length)^q]
      real(wp) :: q = 0.0_wp                   !! Norton-Hoff exponent, 0..1 [-]
      real(wp) :: tau_max = huge(1.0_wp)       !! TAUMAX [stress]
      real(wp) :: elastic_slip = 0.0_wp        !! ELASTIC SLIP or u0 [length]; 0: not given
      real(wp) :: slip_tolerance = 0.0_wp      !! of the facet size; 0: not given [-]
      real(wp) :: v0 = 0.0_wp                  !! V0 of the regularisation [length/time]; 0: by slip
      real(wp) :: stick_slope = 0.0_wp         !! CalculiX's second value [stress/length]; 0: none
   end type friction_type

   !> What a law reads at a point besides pressure and slip; lagged, never linearised.
   type :: condition_type
      real(wp) :: yield = 0.0_wp               !! yield stress at the slave surface [stress]
      real(wp) :: mises = 0.0_wp               !! von Mises stress at the slave surface [stress]
      real(wp) :: dt = 1.0_wp                  !! time increment [time]
      real(wp) :: speed = 0.0_wp               !! slip speed of the last iteration [length/time]
   end type condition_type

contains

   pure logical function has_friction(law)
      type(friction_type), intent(in) :: law
      has_friction = law%rough .or. law%law /= law_of%none
   end function has_friction

   pure logical function is_regularised(law)
      type(friction_type), intent(in) :: law
      is_regularised = law%regularization /= regularization_of%linear
   end function is_regularised

   !> Radius of the disc of tractions and its slope in the pressure.
   pure subroutine friction_radius(law, p, at, radius, slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p                !! pressure; <= 0: radius 0 [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius          !! [stress]
      real(wp), intent(out) :: slope           !! d radius / d p [-]
      real(wp) :: cap

      radius = 0.0_wp
      slope = 0.0_wp
      if (.not. p > 0.0_wp) return
      cap = law%tau_max
      select case (law%law)
      case (law_of%coulomb)
         radius = law%mu*p
         slope = law%mu
      case (law_of%tresca)
         radius = law%m*at%yield/sqrt(3.0_wp)
      case (law_of%orowan)
         radius = law%mu*p
         slope = law%mu
         cap = min(cap, law%m*at%yield/sqrt(3.0_wp))
      case (law_of%cristescu)
         radius = law%m*min(at%mises, at%yield)/sqrt(3.0_wp)
      case (law_of%norton_hoff)
         radius = huge(1.0_wp)
      end select
      if (law%rough) radius = huge(1.0_wp)
      if (radius <= cap) return
      radius = cap
      slope = 0.0_wp
   end subroutine friction_radius

   !> Magnitude F of the traction for a trial magnitude q; Norton-Hoff bounds it by the slip speed.
   pure subroutine return_to_disc(law, q, ct, p, at, traction, slope_q, slope_p, slips)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: q                !! >= 0 [stress]
      real(wp), intent(in) :: ct               !! tangential stiffness > 0 [stress/length]
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: traction        !! F <= q [stress]
      real(wp), intent(out) :: slope_q, slope_p  !! of F [-]
      logical, intent(out) :: slips
      real(wp) :: radius

      associate (unused => ct)
         call friction_radius(law, p, at, radius, slope_p)
      end associate
      slips = q > radius
      traction = q
      slope_q = 1.0_wp
      if (.not. slips) then
         slope_p = 0.0_wp
         return
      end if
      traction = radius
      slope_q = 0.0_wp
   end subroutine return_to_disc

   !> Magnitude of a regularised law for a slip magnitude from the anchor, or made in the increment.
   pure subroutine regularised_traction(law, slip, p, at, traction, slope_slip, slope_p)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: slip             !! >= 0 [length]
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: traction        !! [stress]
      real(wp), intent(out) :: slope_slip      !! [stress/length]
      real(wp), intent(out) :: slope_p         !! [-]
      real(wp) :: radius, u0

      call friction_radius(law, p, at, radius, slope_p)
      u0 = law%elastic_slip
      if (law%v0 > 0.0_wp) u0 = law%v0*at%dt
      traction = radius*2.0_wp/acos(-1.0_wp)*atan(slip/u0)
      slope_slip = radius*2.0_wp/acos(-1.0_wp)*u0/(u0**2 + slip**2)
      slope_p = slope_p*2.0_wp/acos(-1.0_wp)*atan(slip/u0)
   end subroutine regularised_traction
end module lopin_friction
