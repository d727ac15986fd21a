!> Friction laws: one kernel; a law is the radius of a disc and its slopes (lecture E).
!>
!> What a trial traction becomes under them is told by `lopin_friction_return`. Tractions are
!> stresses.
!>
!> | law            | radius                        | lecture, and what is repaired            |
!> | coulomb        | mu p                          | E1: slip is a rate, not a displacement   |
!> | tresca         | m sigma_y / sqrt 3            | E2: acts only where p > 0, and sticks    |
!> | orowan         | min(mu p, m sigma_y / sqrt 3) | E3: the least of two numbers             |
!> | cristescu      | m sigma_vm / sqrt 3           | E4: capped at sigma_y, floored, lagged   |
!> | norton_hoff    | alpha v^q, not a disc         | E5: opposes v; unit stress (time/length)^q |
!>
!> TAUMAX cuts all of them. What is not known (no yield stress) does not bound. A bound that is a
!> stress of its own would jump from 0 to m k at first touch, and a point there may have no state at
!> all: it rises with the pressure, as `steepest` times p, until it is reached.
!>
!> To add a law: its number in `law_of`, its row in `law_rows`, its radius as a `case` of
!> `whole_bound`; a datum that no law has yet also in `lopin_build_friction`. A caller's own law is
!> `law_of%own` with its radius in `friction_type%own`.
module lopin_friction
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   use lopin_text, only : upper, without_blanks
   implicit none
   private
   public :: friction_type, condition_type, law_of, regularization_of
   public :: law_names, law_data, law_notes, law_number, automatic_law, radius_if
   public :: regularization_names, regularization_number, coefficient
   public :: has_friction, is_regularised, by_rate, reads_yield, reads_mises, reads_speed
   public :: bounds_by_area, jumps_at_touch, depends_on_time, friction_radius, whole_bound, &
      & lost_at_touch, bound_slopes

   type :: laws
      integer :: automatic = -1      !! AUTO: chosen from the material when the model is built
      integer :: none = 0, coulomb = 1, tresca = 2, orowan = 3, cristescu = 4, norton_hoff = 5
      integer :: own = 100           !! a law of the caller: no word of the deck
   end type laws
   type(laws), parameter :: law_of = laws()

   !> A law as decks and tests know it.
   type :: law_row_type
      character(len=14) :: name         !! the deck's word
      character(len=8) :: data          !! what the line under *FRICTION gives, in this order
      character(len=56) :: note         !! of that, for the manual
      logical :: yield = .false.        !! reads condition_type%yield
      logical :: mises = .false.        !! reads condition_type%mises
      logical :: jumps = .false.        !! its bound does not vanish with the pressure
   end type law_row_type

   !> One row a law; its place is the number in `law_of`.
   type(law_row_type), parameter :: law_rows(5) = [ &
      & law_row_type('COULOMB', 'mu', 'a coefficient.'), &
      & law_row_type('TRESCA', 'm', 'a shear factor, 0 to 1; it may be left to TAUMAX alone.', &
      & yield=.true., jumps=.true.), &
      & law_row_type('COULOMB-OROWAN', 'mu, m', 'a coefficient and a shear factor; m as of '// &
      & 'TRESCA.', yield=.true.), &
      & law_row_type('CRISTESCU', 'm', 'a shear factor, 0 to 1.', yield=.true., mises=.true., &
      & jumps=.true.), &
      & law_row_type('NORTON-HOFF', 'alpha, q', 'alpha [stress*(time/length)^q]; q from 0 to 1.', &
      & jumps=.true.)]
   character(len=*), parameter :: law_names(size(law_rows)) = law_rows%name
   character(len=*), parameter :: law_data(size(law_rows)) = law_rows%data
   character(len=*), parameter :: law_notes(size(law_rows)) = law_rows%note

   type :: regularizations
      integer :: linear = 1     !! return mapping: exact stick, or elastic slip where asked for
      integer :: arctan = 2, tanh = 3, sqrt = 4
   end type regularizations
   type(regularizations), parameter :: regularization_of = regularizations()

   character(len=*), parameter :: regularization_names(4) = [character(len=6) :: 'LINEAR', &
      & 'ARCTAN', 'TANH', 'SQRT']

   !> Slope in the pressure of bounds that are stresses of their own, up to where they are reached:
   !> a range of pressures of m k/10. The law is not changed by it where p > m k/10.
   real(wp), parameter :: steepest = 10.0_wp

   !> Parameters of the law of one interaction, as the deck gave them.
   type :: friction_type
      integer :: law = 0                       !! law_of%...
      integer :: regularization = 1            !! regularization_of%...
      logical :: rough = .false.               !! no slip at all
      logical :: exact_stick = .false.         !! LAGRANGE: no elastic slip whatever the method
      real(wp) :: mu = 0.0_wp                  !! coefficient (kinetic, if it decays) [-]
      real(wp) :: mu_static = 0.0_wp           !! with `decay` > 0 [-]
      real(wp) :: decay = 0.0_wp               !! EXPONENTIAL DECAY [time/length]; 0: none
      real(wp) :: m = 0.0_wp                   !! shear factor, of laws whose data list it [-]
      real(wp) :: alpha = 0.0_wp               !! Norton-Hoff [stress*(time/length)^q]
      real(wp) :: q = 0.0_wp                   !! Norton-Hoff exponent, 0..1 [-]
      real(wp) :: tau_max = huge(1.0_wp)       !! TAUMAX [stress]
      real(wp) :: rise = steepest              !! of a bound that is a stress, with p [-]
      real(wp) :: elastic_slip = 0.0_wp        !! ELASTIC SLIP or u0 [length]; 0: not given
      real(wp) :: slip_tolerance = 0.0_wp      !! of the facet size; 0: not given [-]
      real(wp) :: v0 = 0.0_wp                  !! V0 of the regularisation [length/time]; 0: by slip
      real(wp) :: stick_slope = 0.0_wp         !! CalculiX's second value [stress/length]; 0: none
      logical :: has_m = .true.                !! .false.: TAUMAX alone bounds Tresca and Orowan
      procedure(radius_if), pointer, nopass :: own => null()   !! radius of `law_of%own`
      type(location_type) :: at                !! of *FRICTION in the deck
   end type friction_type

   !> What a law reads at a point besides pressure and slip.
   type :: condition_type
      real(wp) :: yield = 0.0_wp   !! yield stress at the slave surface; 0: unknown [stress]
      real(wp) :: mises = 0.0_wp   !! von Mises stress at the slave surface [stress]
      real(wp) :: dt = 1.0_wp                  !! time increment [time]
      real(wp) :: speed = 0.0_wp   !! slip speed of the last iteration, >= 0 [length/time]
      logical :: of_trial = .false.   !! the speed is that of the trial, `speed` is not read
      logical :: held = .false.    !! bilateral: a rough surface sticks under tension too
      real(wp) :: growth = 1.0_wp  !! area now over the area that tractions count on; bounds of
                                   !! shear are stresses on the area now [-]
      real(wp) :: eased = 1.0_wp   !! share of friction_type%rise where the point would jam [-]
   end type condition_type

   abstract interface
      !> Radius of the disc and its slope in the pressure p > 0; a bound that is a stress of its own
      !> grows with the area (`at%growth`).
      pure subroutine radius_if(law, p, at, radius, slope)
         import :: friction_type, condition_type, wp
         type(friction_type), intent(in) :: law
         real(wp), intent(in) :: p                !! pressure [stress]
         type(condition_type), intent(in) :: at
         real(wp), intent(out) :: radius          !! [stress]
         real(wp), intent(out) :: slope           !! d radius / d p [-]
      end subroutine radius_if
   end interface

   !> Least equivalent stress of Cristescu as a fraction of the pressure: at first touch the body
   !> has no stress, and a disc without radius would let everything slide.
   real(wp), parameter :: least_equivalent = 1.0e-3_wp
   real(wp), parameter :: root_3 = sqrt(3.0_wp)

contains

   !> Number of a law's word, AUTO included; `law_of%none` if there is no such law.
   pure integer function law_number(word) result(number)
      character(len=*), intent(in) :: word
      number = place_of(law_names, word)
      if (upper(word) == 'AUTO') number = law_of%automatic
   end function law_number

   !> Number of a regularisation's word; 0 if there is none.
   pure integer function regularization_number(word) result(number)
      character(len=*), intent(in) :: word
      number = place_of(regularization_names, word)
   end function regularization_number

   pure integer function place_of(list, word) result(place)
      character(len=*), intent(in) :: list(:), word
      do place = 1, size(list)
         if (without_blanks(trim(list(place))) == without_blanks(upper(word))) return
      end do
      place = 0
   end function place_of

   !> LAW=AUTO (lecture E, remarks 2 to 6): the law that goes with what the material does, and the
   !> word for it.
   pure subroutine automatic_law(plastic, hardens, viscoplastic, number, why)
      logical, intent(in) :: plastic, hardens, viscoplastic
      integer, intent(out) :: number
      character(len=:), allocatable, intent(out) :: why

      if (viscoplastic) then
         number = law_of%norton_hoff
         why = 'viscoplastic'
      else if (plastic .and. hardens) then
         number = law_of%cristescu
         why = 'plastic with hardening'
      else if (plastic) then
         number = law_of%tresca
         why = 'perfectly plastic'
      else
         number = law_of%coulomb
         why = 'elastic'
      end if
   end subroutine automatic_law

   !> Whether anything resists slip.
   elemental logical function has_friction(law)
      type(friction_type), intent(in) :: law
      has_friction = law%rough .or. law%law /= law_of%none
   end function has_friction

   !> Whether the shear is a function of slip or speed, without stick.
   pure logical function is_regularised(law)
      type(friction_type), intent(in) :: law
      is_regularised = .not. law%rough .and. law%regularization /= regularization_of%linear
   end function is_regularised

   !> Whether `regularised_traction` wants the slip of the increment (a rate times its time), not
   !> the slip from the stick anchor.
   pure logical function by_rate(law)
      type(friction_type), intent(in) :: law
      by_rate = law%v0 > 0.0_wp .or. law%law == law_of%norton_hoff
   end function by_rate

   !> Whether the law reads `condition_type%yield`.
   elemental logical function reads_yield(law)
      type(friction_type), intent(in) :: law
      reads_yield = law%law == law_of%own
      if (is_listed(law)) reads_yield = law_rows(law%law)%yield
      reads_yield = reads_yield .and. law%has_m .and. .not. law%rough
   end function reads_yield

   !> Whether the law reads `condition_type%mises`.
   elemental logical function reads_mises(law)
      type(friction_type), intent(in) :: law
      reads_mises = law%law == law_of%own
      if (is_listed(law)) reads_mises = law_rows(law%law)%mises
      reads_mises = reads_mises .and. .not. law%rough
   end function reads_mises

   !> Whether the law reads `condition_type%speed`.
   elemental logical function reads_speed(law)
      type(friction_type), intent(in) :: law
      reads_speed = .not. law%rough .and. law%decay > 0.0_wp &
         & .and. (law%law == law_of%coulomb .or. law%law == law_of%orowan)
   end function reads_speed

   !> Whether a bound is a stress of its own, not a share of the pressure.
   elemental logical function bounds_by_area(law)
      type(friction_type), intent(in) :: law
      bounds_by_area = .not. law%rough .and. law%law /= law_of%none &
         & .and. (law%law /= law_of%coulomb .or. law%tau_max < huge(1.0_wp))
   end function bounds_by_area

   !> Whether a bound would jump from nothing where a point touches.
   elemental logical function jumps_at_touch(law)
      type(friction_type), intent(in) :: law
      jumps_at_touch = .false.
      if (is_listed(law)) jumps_at_touch = .not. law%rough .and. law_rows(law%law)%jumps
   end function jumps_at_touch

   !> Whether the law has a row in `law_rows`.
   elemental logical function is_listed(law)
      type(friction_type), intent(in) :: law
      is_listed = law%law >= 1 .and. law%law <= size(law_rows)
   end function is_listed

   !> Whether the answer depends on the speed of slip, hence on a real scale of time.
   pure logical function depends_on_time(law)
      type(friction_type), intent(in) :: law
      depends_on_time = .not. law%rough .and. (law%decay > 0.0_wp .or. law%v0 > 0.0_wp &
         & .or. (law%law == law_of%norton_hoff .and. law%q > 0.0_wp))
   end function depends_on_time

   !> mu(v) = mu_k + (mu_s - mu_k) exp(-d v), with the speed that is given.
   pure real(wp) function coefficient(law, at) result(mu)
      type(friction_type), intent(in) :: law
      type(condition_type), intent(in) :: at

      mu = law%mu
      if (law%decay > 0.0_wp) mu = mu + (law%mu_static - law%mu)*exp(-law%decay*at%speed)
   end function coefficient

   !> Radius of the disc of tractions and its slope in the pressure.
   !>
   !> Norton-Hoff with q > 0 has no disc: its radius is what caps it.
   pure subroutine friction_radius(law, p, at, radius, slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p                !! pressure; <= 0: radius 0 [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius          !! [stress]
      real(wp), intent(out) :: slope           !! d radius / d p [-]

      radius = 0.0_wp
      slope = 0.0_wp
      if (law%rough .and. (p > 0.0_wp .or. at%held)) radius = huge(1.0_wp)
      if (law%rough .or. .not. p > 0.0_wp) return
      call whole_bound(law, p, at, radius, slope)
      if (.not. jumps_at_touch(law) .or. radius <= at%eased*law%rise*p) return
      slope = at%eased*law%rise
      radius = slope*p
   end subroutine friction_radius

   !> Slopes of the radius in the stresses of the solids that the law reads: laws are straight
   !> between kinks, and at a kink they have the slope below it.
   pure subroutine bound_slopes(law, p, at, radius, by_yield, by_mises)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius          !! [stress]
      real(wp), intent(out) :: by_yield, by_mises   !! [-]
      real(wp), parameter :: less = 1.0e-6_wp
      type(condition_type) :: below
      real(wp) :: other, slope

      by_yield = 0.0_wp
      by_mises = 0.0_wp
      call friction_radius(law, p, at, radius, slope)
      if (.not. radius < huge(1.0_wp)) return
      if (reads_yield(law) .and. at%yield > 0.0_wp) then
         below = at
         below%yield = (1.0_wp - less)*at%yield
         call friction_radius(law, p, below, other, slope)
         by_yield = (radius - other)/(at%yield - below%yield)
      end if
      if (reads_mises(law) .and. at%mises > 0.0_wp) then
         below = at
         below%mises = (1.0_wp - less)*at%mises
         call friction_radius(law, p, below, other, slope)
         by_mises = (radius - other)/(at%mises - below%mises)
      end if
   end subroutine bound_slopes

   !> The same as the law has it, a jump at p = 0 included: what a new law adds its `case` to. A
   !> bound that is a stress of its own grows with the area (`at%growth`).
   pure subroutine whole_bound(law, p, at, radius, slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p                !! > 0 [stress]
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius          !! [stress]
      real(wp), intent(out) :: slope           !! d radius / d p [-]
      real(wp) :: cap

      radius = 0.0_wp
      slope = 0.0_wp
      cap = huge(1.0_wp)
      if (law%tau_max < huge(1.0_wp)) cap = law%tau_max*at%growth
      select case (law%law)
      case (law_of%coulomb, law_of%orowan)
         slope = coefficient(law, at)
         radius = slope*p
         if (law%law == law_of%orowan) cap = min(cap, shear_yield(law, at))
      case (law_of%tresca)
         radius = shear_yield(law, at)
      case (law_of%cristescu)
         call cristescu(law, p, at, radius, slope)
      case (law_of%norton_hoff)
         radius = huge(1.0_wp)
         if (.not. law%q > 0.0_wp) radius = law%alpha*at%growth
      case (law_of%own)
         call law%own(law, p, at, radius, slope)
      end select
      if (radius <= cap) return
      radius = cap
      slope = 0.0_wp
   end subroutine whole_bound

   !> What a slipping point lacks of its law's bound because that rises from nothing; 0 where the
   !> law has its bound. `whole` is 0 where it has none.
   pure subroutine lost_at_touch(law, p, at, lost, whole)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at   !! with the speed of the slip
      real(wp), intent(out) :: lost, whole     !! [stress]
      real(wp) :: slope

      lost = 0.0_wp
      whole = 0.0_wp
      if (law%rough .or. .not. p > 0.0_wp) return
      call whole_bound(law, p, at, whole, slope)
      if (law%law == law_of%norton_hoff) whole = min(whole, law%alpha*at%growth*at%speed**law%q)
      if (.not. whole < huge(1.0_wp)) whole = 0.0_wp
      if (.not. jumps_at_touch(law)) return
      ! A rise that the deck gives is the law.
      lost = whole
      if (law%rise < steepest) lost = min(whole, law%rise*p)
      lost = max(lost - at%eased*law%rise*p, 0.0_wp)
   end subroutine lost_at_touch

   !> m sigma_y / sqrt 3; no bound where the yield stress is unknown.
   pure real(wp) function shear_yield(law, at) result(k)
      type(friction_type), intent(in) :: law
      type(condition_type), intent(in) :: at

      k = huge(1.0_wp)
      if (law%has_m .and. at%yield > 0.0_wp) k = law%m*at%yield*at%growth/root_3
   end function shear_yield

   !> m sigma_vm / sqrt 3 with sigma_vm between a trace of the pressure and the yield stress.
   pure subroutine cristescu(law, p, at, radius, slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius, slope
      real(wp) :: equivalent, change

      equivalent = at%mises*at%growth
      change = 0.0_wp
      if (equivalent < least_equivalent*p) then
         equivalent = least_equivalent*p
         change = least_equivalent
      end if
      if (at%yield > 0.0_wp .and. equivalent > at%yield*at%growth) then
         equivalent = at%yield*at%growth
         change = 0.0_wp
      end if
      radius = law%m*equivalent/root_3
      slope = law%m*change/root_3
   end subroutine cristescu

end module lopin_friction
