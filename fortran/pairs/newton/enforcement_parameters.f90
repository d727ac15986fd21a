!> Enforcement parameters of the points of the nonlinear path: methods and stiffnesses by the deck
!> and the moduli.
module lopin_enforcement_parameters
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, interaction_type
   use lopin_friction, only : friction_type, condition_type, friction_radius, has_friction, &
      & is_regularised
   use lopin_contact_row, only : enforcement_parameters_type
   use lopin_contact_points, only : pair_is_tied
   use lopin_enforcement, only : enforcement_type, setting_type, copy_method
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_nonlinear_points, only : nonlinear_points_type
   implicit none
   private
   public :: choose_enforcement, remember_elastic

   !> Penalty without a slope, beside the modulus over the facet; stiffness of exact methods that
   !> only conditions the system; shear beside normal stiffness.
   real(wp), parameter :: default_penalty = 100.0_wp, scale_of_exact = 1.0_wp
   !> The same for slaves that may flow, whose tangent is softer than their modulus: a stiffness
   !> beyond it takes errors of curved tools for a change of contact.
   real(wp), parameter :: scale_of_flow = 0.1_wp
   real(wp), parameter :: shear_share = 1.0_wp/3.0_wp, share_augmented = 0.1_wp
   !> What opposes a common slip is less than the modulus over the span; in the plane, where it acts
   !> on a line, by so much less (measured: Newton hops from 400 moduli over the line on, and from
   !> 100 over the side of a square).
   real(wp), parameter :: line_share = 0.25_wp

contains

   !> How the points of a pair press; stiffnesses that the deck leaves open come from the modulus.
   subroutine choose_enforcement(enforcement, points, friction, model, pair, log)
      type(enforcement_parameters_type), intent(inout) :: enforcement(:) !! (points%n); only those
                                                                         !! of the pair
      type(nonlinear_points_type), intent(in) :: points
      type(friction_type), intent(in) :: friction
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      real(wp) :: slope, stiffest
      integer :: i
      real(wp) :: span
      logical :: said

      said = .false.
      span = span_of(points, friction, model%mesh%ndim, pair)
      stiffest = 0.0_wp
      do i = 1, points%n
         if (points%pair(i) == pair) stiffest = max(stiffest, default_slope(points, i, &
            & model%interaction(model%pair(pair)%interaction)%method))
      end do
      associate (way => model%interaction(model%pair(pair)%interaction), f => friction)
         do i = 1, points%n
            if (points%pair(i) /= pair) cycle
            associate (g => enforcement(i), own => points%modulus(i)/points%size(i))
               g%c = merge(scale_of_flow, scale_of_exact, points%yield(i) > 0.0_wp)*own
               g%ct = g%c*shear_share
               slope = way%slope*way%scale
               ! A penalty is one of the pair: points of other facets would yield to a uniform
               ! pressure by other gaps.
               if (.not. slope > 0.0_wp) slope = way%scale*merge(default_slope(points, i, &
                  & way%method), stiffest, way%method%updates())
               call copy_method(way%method, g%method)
               call take_form(g, f, slope/own, span)
               g%tied = pair_is_tied(model, model%pair(pair))
               if (way%method%updates() .or. .not. way%method%is_exact()) then
                  if (way%method%reads_slope() .and. .not. way%slope > 0.0_wp) call tell_slope()
                  call take_slope(g, f, slope)
               end if
               call choose_stick(g, f, points%size(i))
               if (g%tied) call new_enforcement(g%method, 'lagrange')
            end associate
         end do
         if (any(points%pair(:points%n) == pair)) call stick_of_deck(way, f, model, pair, log)
      end associate

   contains

      !> Once for the pair.
      subroutine tell_slope()
         if (said) return
         said = .true.
         call log%say(severity%note, 'N0317', 'pair ('// &
            & model%surface(model%pair(pair)%slave)%name//', '// &
            & model%surface(model%pair(pair)%master)%name//'): slope '// &
            & to_text(slope, 4)//' = 100 moduli over a facet', model%pair(pair)%at)
      end subroutine tell_slope
   end subroutine choose_enforcement

   !> Whether the deck says how points give way before they slide.
   pure logical function gives_way(friction)
      type(friction_type), intent(in) :: friction
      gives_way = has_friction(friction) .and. .not. is_regularised(friction) .and. max( &
         & friction%elastic_slip, friction%slip_tolerance, friction%stick_slope) > 0.0_wp
   end function gives_way

   !> The form in which Newton's iterations solve the method.
   subroutine take_form(enforcement, friction, stiffness, span)
      type(enforcement_parameters_type), intent(inout) :: enforcement
      type(friction_type), intent(in) :: friction
      real(wp), intent(in) :: stiffness        !! of the slope beside the modulus over the facet
      real(wp), intent(in) :: span             !! facets along the contact
      class(enforcement_type), allocatable :: form

      call enforcement%method%form_for_newton(setting_type(stiffness, span, has_friction( &
         & friction), friction%exact_stick, max(friction%elastic_slip, friction%slip_tolerance) &
         & > 0.0_wp, gives_way(friction)), form)
      if (allocated(form)) call move_alloc(form, enforcement%method)
   end subroutine take_form

   !> Facets along the surface of a pair, whose points slip together; 1 where none changes between
   !> stick and slip.
   pure real(wp) function span_of(points, friction, ndim, pair) result(span)
      type(nonlinear_points_type), intent(in) :: points
      type(friction_type), intent(in) :: friction
      integer, intent(in) :: ndim, pair

      span = 1.0_wp
      if (is_regularised(friction) .or. friction%rough) return
      span = count(points%pair(:points%n) == pair)
      span = merge(line_share*span, sqrt(span), ndim == 2)
   end function span_of

   !> Stiffnesses by a slope; a law has its own along the normal, and sticks by springs as a penalty
   !> does.
   subroutine take_slope(enforcement, friction, slope)
      type(enforcement_parameters_type), intent(inout) :: enforcement
      type(friction_type), intent(in) :: friction
      real(wp), intent(in) :: slope            !! [stress/length]

      enforcement%slope = slope
      enforcement%shear_slope = slope*shear_share
      if (friction%stick_slope > 0.0_wp) enforcement%shear_slope = friction%stick_slope
      if (.not. enforcement%method%solves_for_multiplier()) then
         enforcement%ct = enforcement%shear_slope
         if (enforcement%method%piecewise_linear()) then
            enforcement%c = slope
         else
            enforcement%slope = 1.0_wp
         end if
      else if (.not. enforcement%method%reads_slope()) then
         enforcement%shear_slope = friction%stick_slope
      end if
   end subroutine take_slope

   !> What the deck says of sticking and this path does otherwise.
   subroutine stick_of_deck(way, friction, model, pair, log)
      type(interaction_type), intent(in) :: way
      type(friction_type), intent(in) :: friction
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: why
      logical :: slips

      if (.not. has_friction(friction) .or. friction%rough .or. is_regularised(friction)) return
      slips = friction%elastic_slip + friction%slip_tolerance > 0.0_wp
      why = ''
      if (.not. way%method%piecewise_linear() .and. (slips .or. friction%exact_stick)) &
         & why = 'a pressure-'// &
         & 'overclosure law sticks by springs of 33 moduli over a facet where bodies move far '// &
         & 'or flow'
      if (len(why) == 0) return
      call log%say(severity%warning, 'W0305', trim(merge('ELASTIC SLIP', 'LAGRANGE    ', slips))// &
         & ' on *FRICTION does nothing here: '//why, friction%at, help='leave it out, or write '// &
         & '*SURFACE BEHAVIOR, PENALTY or DIRECT for the pair of line '// &
         & to_text(model%pair(pair)%at%line))
   end subroutine stick_of_deck

   !> By the slave's own modulus, which bounds the error; augmentation needs less, and Newton
   !> dislikes springs that are stiff beside a soft master.
   pure real(wp) function default_slope(points, i, method)
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      class(enforcement_type), intent(in) :: method
      real(wp) :: modulus

      modulus = points%slave_modulus(i)
      if (method%updates()) modulus = max(points%modulus(i), share_augmented*modulus)
      default_slope = default_penalty*modulus/points%size(i)
   end function default_slope

   !> What the deck says of the slip before sliding, where the traction is an unknown.
   subroutine choose_stick(enforcement, friction, facet)
      type(enforcement_parameters_type), intent(inout) :: enforcement
      type(friction_type), intent(in) :: friction
      real(wp), intent(in) :: facet            !! [length]

      if (.not. enforcement%method%solves_for_multiplier()) return
      enforcement%elastic_slip = friction%elastic_slip
      if (.not. enforcement%elastic_slip > 0.0_wp) enforcement%elastic_slip = &
         & friction%slip_tolerance*facet
      if (friction%stick_slope > 0.0_wp) enforcement%shear_slope = friction%stick_slope
      if (friction%stick_slope > 0.0_wp .or. friction%exact_stick) enforcement%elastic_slip = 0.0_wp
      if (friction%exact_stick .or. enforcement%elastic_slip > 0.0_wp) enforcement%shear_slope = &
         & 0.0_wp
   end subroutine choose_stick

   !> The elastic slip that the committed traction holds.
   pure subroutine remember_elastic(enforcement, friction, normal, eased)
      type(enforcement_parameters_type), intent(inout) :: enforcement
      type(friction_type), intent(in) :: friction
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: eased            !! condition_type%eased [-]
      real(wp) :: p, radius, slope

      enforcement%elastic = 0.0_wp
      if (.not. enforcement%elastic_slip > 0.0_wp) return
      p = dot_product(enforcement%committed, normal)
      call friction_radius(friction, p, condition_type(held=enforcement%bilateral, &
         & yield=enforcement%yield, eased=eased), radius, slope)
      if (.not. radius > 0.0_wp .or. .not. radius < huge(1.0_wp)) return
      enforcement%elastic = -enforcement%elastic_slip/radius*(enforcement%committed - p*normal)
   end subroutine remember_elastic
end module lopin_enforcement_parameters
