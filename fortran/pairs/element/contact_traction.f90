!> The traction of a contact point in dual numbers: any method, all laws of friction.
!>
!> In vectors, without tangent bases: with the trial pressure phat and the trial shear that,
!>
!>    p = max(0, phat)  (bilateral: phat),   t = that F(|that|)/|that|,   z = p n + t,
!>
!> and the methods differ in the trials (lopin_enforcement; lecture J; Alart and Curnier 1991):
!>
!>    penalty     phat = -c g                     that = P l - ct s     l: committed traction
!>    augmented   phat = l.n - c g                that = P l - ct s     l: frozen, updated outside
!>    Lagrange    phat = l.n - c g                that = P l - ct s     l: unknown, row (l - z)/c
!>    perturbed   phat = l.n - c (g + l.n/eps)   that = P l - ct (s + P (l - l0)/epst)   as Lagrange
!>    augmented,  phat = l.n - c (g + (l - l0).n/eps), that as perturbed: l0 frozen, l unknown,
!>    mixed       the same equations without what stiff springs do to Newton
!>
!> P = I - n n^T; s is the slip since the increment began, P (x_slave - x_anchor), or since the
!> point touched in it: less P approach. Where the deck gives an elastic slip u0, that = P l - ct (s
!> + u0 P l/radius + P e0): a traction on the disc holds u0, e0 what the committed one held.
!>
!> Between sliding one way and the other lies sticking, a small part of the way of a step of Newton
!> that leaps over it and, from there, back: once sets have come back, a point that slid where a
!> step starts sticks where it would slide the other way. The next step starts from there, and
!> slides if its shear asks for it.
module lopin_contact_traction
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, dual_dot, dual_norm, operator(+), operator(-), &
      & operator(*), operator(/), assignment(=)
   use lopin_friction, only : friction_type, condition_type, has_friction, is_regularised, &
      & by_rate, friction_radius
   use lopin_friction_return, only : return_to_disc, regularised_traction, drag_limit, &
      & at_rest, steepest_fall
   use lopin_contact_row, only : enforcement_parameters_type, point_law_type, row_type, &
      & contact_status
   implicit none
   private
   public :: traction_of, elastic_slip_of, normal_stiffness, stored_energy, regularised_energy

   !> Shears this near to the limit, beside it, are at it.
   real(wp), parameter :: at_limit = 1.0e-6_wp

   !> What a law leaves of a trial shear.
   type :: return_type
      real(wp) :: shear = 0.0_wp               !! magnitude [stress]
      real(wp) :: slope_q = 1.0_wp, slope_p = 0.0_wp   !! of it in the trial, in the pressure [-]
      logical :: slips = .false.
   end type return_type

contains

   !> The traction on the slave and the residual of the multiplier's rows: z, residual, status and
   !> shear of the row from its gap, normal, slip and multiplier.
   pure subroutine traction_of(row, law, growth)
      type(row_type), intent(inout) :: row
      type(point_law_type), intent(in) :: law
      type(dual_type), intent(in), optional :: growth   !! at%growth with its slopes; else it stands
      type(dual_type) :: held(row%ndim), p, t(row%ndim), s(row%ndim), normal_part, magnitude, f
      type(return_type) :: back
      real(wp) :: ct
      logical :: closed, solves
      integer :: d

      d = row%ndim
      associate (e => law%enforcement, friction => law%friction, n => row%normal(:d), &
         & shear => row%shear(:d, :d))
         solves = e%method%solves_for_multiplier()
         held = constant(merge(e%frozen(:d), e%committed(:d), e%method%updates()))
         if (solves) held = row%multiplier(:d)
         normal_part = dual_dot(held, n)
         p = trial_pressure(e, row%gap + row%shift, n, normal_part)
         closed = p%v > -e%grazing .or. e%bilateral
         row%status = merge(contact_status%slip, contact_status%open, closed)
         shear = 0.0_wp
         t = 0.0_wp
         if (.not. closed) then
            p = constant(0.0_wp)
         else if (has_friction(friction)) then
            if (e%space%limited) row%slip(:d) = free_slip(e, row%slip(:d), n)
            s = row%slip(:d)
            if (any(abs(e%approach) > 0.0_wp)) s = s - free_slip(e, constant(e%approach(:d)), n)
            if (solves .and. e%space%limited) held = held - idle_part(e, held, n)
            if (is_regularised(friction)) then
               if (.not. by_rate(friction)) s = tangential(s + constant(e%creep(:d)), n)
               call regularised_shear(friction, law%at, p, s, t, shear, growth)
            else
               ct = tangential_scale(e, friction, p%v, law%at)
               t = held - n*normal_part - ct*s
               if (solves) call give_way(e, friction, law%at, p, held, n, t, growth)
               magnitude = constant(0.0_wp)
               if (norm2(t%v) > 0.0_wp) magnitude = dual_norm(t)
               call return_to_disc(friction, magnitude%v, ct, p%v, law%at, back%shear, &
                  & back%slope_q, back%slope_p)
               back%slips = back%shear < magnitude%v .and. dot_product(e%slid(:d), t%v) >= 0.0_wp
               if (e%grazing > 0.0_wp) call start_shear(back, e, friction, law%at, magnitude%v, &
                  & ct, p%v)
               row%status = merge(contact_status%slip, contact_status%stick, back%slips)
               if (back%slips) then
                  f%v = back%shear
                  f%d = back%slope_q*magnitude%d + back%slope_p*p%d
                  if (present(growth)) f%d = f%d + growth_slope(f%v*(1.0_wp - back%slope_q) &
                     & - back%slope_p*p%v, growth)
                  call set_shear(shear, t%v, max(back%slope_q, 0.0_wp)*ct, f%v/magnitude%v*ct)
                  t = (f/magnitude)*t
               else
                  call set_shear(shear, t%v, ct, ct)
               end if
            end if
         end if
         row%z(:d) = p*n + t
         if (solves) row%residual(:d) = (row%multiplier(:d) - row%z(:d))/e%c
      end associate
   end subroutine traction_of

   !> Where Newton starts. Points that slid into the state from which it starts are at the limit
   !> there, and rounding would choose: they slide on, or stick where only friction holds a body. A
   !> shear that is rounding itself sticks.
   pure subroutine start_shear(back, e, law, at, q, ct, p)
      type(return_type), intent(inout) :: back
      type(enforcement_parameters_type), intent(in) :: e
      type(friction_type), intent(in) :: law
      type(condition_type), intent(in) :: at
      real(wp), intent(in) :: q                !! magnitude of the trial [stress]
      real(wp), intent(in) :: ct, p            !! [stress/length], [stress]
      real(wp) :: beyond

      if (q <= e%grazing .or. e%clings .and. q <= (1.0_wp + at_limit)*back%shear) then
         back%slips = .false.
         back%shear = q
      else if (.not. (back%slips .or. e%clings)) then
         beyond = (1.0_wp + at_limit)*q
         call return_to_disc(law, beyond, ct, p, at, back%shear, back%slope_q, back%slope_p)
         back%slips = back%shear < beyond
      end if
   end subroutine start_shear

   !> The normal trial traction: of springs, or of a multiplier with what conditions its row.
   pure function trial_pressure(enforcement, g, n, normal_part) result(phat)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(dual_type), intent(in) :: g             !! gap [length]
      type(dual_type), intent(in) :: n(:)          !! (ndim)
      type(dual_type), intent(in) :: normal_part   !! of the multiplier or its stand-in [stress]
      type(dual_type) :: phat

      if (.not. enforcement%method%solves_for_multiplier()) then
         phat = pressed(enforcement, g, enforcement%method%updates(), normal_part)
      else if (enforcement%method%updates()) then
         phat = penetrates(enforcement, normal_part &
            & - dual_dot(constant(enforcement%frozen(:size(n))), n))
         phat = normal_part - enforcement%c*(g + phat)
      else
         phat = normal_part - enforcement%c*(g + penetrates(enforcement, normal_part))
      end if
   end function trial_pressure

   !> The tangential stiffness of the trial. Beside unknown tractions it only scales their rows: at
   !> least twice as steep as the bound falls with the slip, where that has one root then.
   pure real(wp) function tangential_scale(enforcement, friction, p, at) result(ct)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(friction_type), intent(in) :: friction
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      ct = enforcement%ct
      if (enforcement%method%solves_for_multiplier()) ct = max(ct, 2.0_wp*steepest_fall(friction, &
         & p, at))
   end function tangential_scale

   !> The slip that a traction along the face holds elastically, and gives back.
   pure function elastic_slip_of(enforcement, friction, at, p, t) result(slip)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(friction_type), intent(in) :: friction
      type(condition_type), intent(in) :: at
      real(wp), intent(in) :: p                !! [stress]
      real(wp), intent(in) :: t(3)             !! along the face [stress]
      real(wp) :: slip(3)                      !! [length]
      slip = -shear_compliance(enforcement, friction, at, p)*t
   end function elastic_slip_of

   !> Elastic slip per shear; 0: the point sticks exactly.
   pure real(wp) function shear_compliance(enforcement, friction, at, p) result(compliance)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(friction_type), intent(in) :: friction
      type(condition_type), intent(in) :: at
      real(wp), intent(in) :: p                !! [stress]
      real(wp) :: radius, slope

      compliance = 0.0_wp
      if (is_regularised(friction) .or. enforcement%tied .or. enforcement%method%updates()) return
      if (.not. enforcement%method%solves_for_multiplier()) then
         compliance = 1.0_wp/enforcement%ct
         return
      end if
      if (enforcement%shear_slope > 0.0_wp) compliance = 1.0_wp/enforcement%shear_slope
      if (.not. enforcement%elastic_slip > 0.0_wp) return
      call friction_radius(friction, p, at_rest(at), radius, slope)
      if (radius > 0.0_wp .and. radius < huge(1.0_wp)) compliance = compliance &
         & + enforcement%elastic_slip/radius
   end function shear_compliance

   !> Energy per area that the springs of a pair hold, normal and along the face.
   pure real(wp) function stored_energy(enforcement, friction, at, p, t, gap, kept) result(energy)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(friction_type), intent(in) :: friction
      type(condition_type), intent(in) :: at
      real(wp), intent(in) :: p                !! [stress]
      real(wp), intent(in) :: t(3)             !! along the face [stress]
      real(wp), intent(in) :: gap              !! [length]
      real(wp), intent(in) :: kept(3)          !! slip from the anchor of a regularised law [length]

      energy = 0.0_wp
      if (.not. enforcement%tied) energy = enforcement%method%stored(gap, p, enforcement%slope)
      energy = energy + 0.5_wp*shear_compliance(enforcement, friction, at, p)*dot_product(t, t)
      if (has_friction(friction) .and. is_regularised(friction)) energy = energy &
         & + regularised_energy(friction, norm2(kept), p, at)
   end function stored_energy

   !> Energy per area of a law regularised by slip between its anchor and the slip that it keeps.
   pure real(wp) function regularised_energy(friction, reach, p, at) result(energy)
      type(friction_type), intent(in) :: friction
      real(wp), intent(in) :: reach            !! that slip [length]
      real(wp), intent(in) :: p                !! [stress]
      type(condition_type), intent(in) :: at
      integer, parameter :: parts = 64
      real(wp) :: traction, slope, slope_p
      integer :: i

      energy = 0.0_wp
      if (by_rate(friction) .or. .not. reach > 0.0_wp) return
      ! The curves are smooth: midpoints on a grid that is finer near the anchor.
      do i = 1, parts
         call regularised_traction(friction, reach*((i - 0.5_wp)/parts)**2, p, at, traction, &
            & slope, slope_p)
         energy = energy + traction*reach*2.0_wp*(i - 0.5_wp)/parts**2
      end do
   end function regularised_energy

   !> -dp/dg of a closed point, for a factor: that of its springs, else what conditions its rows.
   pure real(wp) function normal_stiffness(enforcement, g) result(stiffness)
      type(enforcement_parameters_type), intent(in) :: enforcement
      real(wp), intent(in) :: g                !! gap [length]
      real(wp) :: force

      stiffness = enforcement%c
      if (enforcement%tied .or. enforcement%method%solves_for_multiplier()) return
      call enforcement%method%trial(g, enforcement%slope, 0.0_wp, force, stiffness)
   end function normal_stiffness

   !> What an unknown traction gives way by before it slides: springs along the face, and the
   !> elastic slip of the deck in the measure of the disc's present radius at rest.
   pure subroutine give_way(enforcement, friction, at, p, held, n, trial, growth)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(friction_type), intent(in) :: friction
      type(condition_type), intent(in) :: at
      type(dual_type), intent(in) :: p, held(:), n(:)
      type(dual_type), intent(inout) :: trial(:)   !! (ndim) [stress]
      type(dual_type), intent(in), optional :: growth
      type(dual_type) :: compliance
      real(wp) :: radius, slope, ct
      integer :: d

      d = size(n)
      ct = tangential_scale(enforcement, friction, p%v, at)
      if (enforcement%shear_slope > 0.0_wp) trial = trial &
         & - (ct/enforcement%shear_slope)*tangential(held - constant(merge( &
         & enforcement%frozen(:d), enforcement%committed(:d), enforcement%method%updates())), n)
      if (.not. enforcement%elastic_slip > 0.0_wp) return
      call friction_radius(friction, p%v, at_rest(at), radius, slope)
      if (.not. radius > 0.0_wp .or. .not. radius < huge(1.0_wp)) return
      compliance = p
      compliance%v = radius
      compliance%d = slope*p%d
      if (present(growth)) compliance%d = compliance%d + (radius - slope*p%v)/growth%v*growth%d
      compliance = (ct*enforcement%elastic_slip)/compliance
      trial = trial - compliance*tangential(held, n) &
         & - ct*tangential(constant(enforcement%elastic(:size(n))), n)
   end subroutine give_way

   !> The trial pressure of springs; a multiplier that is frozen turns with the normal.
   pure function pressed(enforcement, g, updates, frozen) result(p)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(dual_type), intent(in) :: g
      logical, intent(in) :: updates
      type(dual_type), intent(in) :: frozen    !! along the normal [stress]
      type(dual_type) :: p
      real(wp) :: stiffness

      call enforcement%method%trial(g%v, enforcement%slope, merge(frozen%v, 0.0_wp, updates), p%v, &
         & stiffness)
      p%d = -stiffness*g%d
      if (updates) p%d = frozen%d - stiffness*g%d
   end function pressed

   !> The penetration that goes with an unknown pressure.
   pure function penetrates(enforcement, p) result(depth)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(dual_type), intent(in) :: p
      type(dual_type) :: depth

      depth%v = enforcement%method%penetration(p%v, enforcement%slope)
      depth%d = enforcement%method%penetration(p%d, enforcement%slope)
   end function penetrates

   !> The part along the face of a motion that supports leave to the point.
   pure function free_slip(enforcement, way, n) result(slip)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(dual_type), intent(in) :: way(:), n(:)  !! [length]
      type(dual_type) :: slip(size(n)), lean(size(n))
      integer :: k

      if (.not. enforcement%space%limited) then
         slip = tangential(way, n)
         return
      end if
      slip = way
      lean = n
      do k = 1, size(n)
         slip = slip - enforcement%space%taken(:size(n), k)*way(k)
         lean = lean - enforcement%space%taken(:size(n), k)*n(k)
      end do
      slip = slip - lean*(dual_dot(lean, slip)/dual_dot(lean, lean))
   end function free_slip

   !> What an unknown traction has more than at the start along the face where nothing can slip: it
   !> works on supports alone, and stays what it was.
   pure function idle_part(enforcement, held, n) result(idle)
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(dual_type), intent(in) :: held(:), n(:) !! held [stress]
      type(dual_type) :: idle(size(n)), more(size(n))

      more = held - constant(enforcement%committed(:size(n)))
      idle = tangential(more, n)
      ! Two points that both stick exactly would ask for the same twice.
      if (.not. enforcement%space%follows) idle = idle - free_slip(enforcement, more, n)
   end function idle_part

   pure function tangential(a, n) result(b)
      type(dual_type), intent(in) :: a(:), n(:)
      type(dual_type) :: b(size(a))
      b = a - n*dual_dot(a, n)
   end function tangential

   !> Shear of a closed point by a law that is regularised.
   pure subroutine regularised_shear(friction, at, p, way, t, shear, growth)
      type(friction_type), intent(in) :: friction
      type(condition_type), intent(in) :: at
      type(dual_type), intent(in) :: p             !! [stress]
      type(dual_type), intent(in) :: way(:)   !! (ndim) slip, by rates of the increment [length]
      type(dual_type), intent(out) :: t(:)         !! (ndim) [stress]
      real(wp), intent(out) :: shear(:, :)         !! (ndim, ndim) -dt/ds [stress/length]
      type(dual_type), intent(in), optional :: growth
      type(dual_type) :: magnitude, f
      real(wp) :: slope, slope_p, length, reach
      integer :: i

      length = norm2(way%v)
      magnitude = constant(0.0_wp)
      if (length > 0.0_wp) magnitude = dual_norm(way)
      ! Beyond the drag limit the anchor follows with the whole of its traction.
      reach = min(magnitude%v, drag_limit(friction))
      call regularised_traction(friction, reach, p%v, at, f%v, slope, slope_p, magnitude%v - reach)
      f%d = slope*magnitude%d + slope_p*p%d
      if (present(growth)) f%d = f%d + growth_slope(f%v - slope_p*p%v, growth)
      t = 0.0_wp
      if (length > 0.0_wp) then
         t = (-1.0_wp)*(f/magnitude)*way
         call set_shear(shear, way%v, max(slope, 0.0_wp), f%v/magnitude%v)
      else
         do i = 1, size(way)
            t(i) = (-slope)*way(i)
         end do
         call set_shear(shear, way%v, slope, slope)
      end if
   end subroutine regularised_shear

   !> Slopes of a bound of shear in the growth J of its area. A law of stresses is homogeneous:
   !> F(J q, J p, J c) = J F(q, p, c), which gives the slope in J from those in q and p.
   pure function growth_slope(rest, growth) result(slopes)
      real(wp), intent(in) :: rest             !! F less its slopes in q and p times these [stress]
      type(dual_type), intent(in) :: growth    !! J [-]
      real(wp) :: slopes(size(growth%d))
      slopes = rest/growth%v*growth%d
   end function growth_slope

   !> -dt/ds, positive semidefinite: the slope along the direction, the secant across it.
   pure subroutine set_shear(shear, way, slope, secant)
      real(wp), intent(out) :: shear(:, :)     !! (ndim, ndim) [stress/length]
      real(wp), intent(in) :: way(:)           !! (ndim) of the direction, if the two differ
      real(wp), intent(in) :: slope, secant    !! [stress/length]
      real(wp) :: direction(size(way))
      integer :: i

      direction = 0.0_wp
      if (slope < secant .or. slope > secant) direction = way/norm2(way)
      shear = 0.0_wp
      do i = 1, size(way)
         shear(i, i) = secant
         shear(:, i) = shear(:, i) + (slope - secant)*direction*direction(i)
      end do
   end subroutine set_shear
end module lopin_contact_traction
