!> A method of enforcement, a law of friction and a yield surface that the library has never heard
!> of, as a caller would write them.
module own_laws
   use lopin_kinds, only : wp
   use lopin_kelvin, only : deviator_of
   use lopin_enforcement, only : enforcement_type
   use lopin_friction, only : friction_type, condition_type
   use lopin_yield_surface, only : yield_type
   use lopin_model, only : model_type
   use lopin_report, only : frame_type
   use lopin_recorder, only : wants_type
   use lopin_recorder_last, only : last_recorder_type
   implicit none
   private
   public :: stress_recorder_type, spring_type, compliant_type, tanh_radius, coulomb_radius, &
      & quartic_type

   !> The last increment with stresses.
   type, extends(last_recorder_type) :: stress_recorder_type
   contains
      procedure :: wants => wants_stress
   end type stress_recorder_type

   !> A spring that hardens, smooth at first touch: p = alpha h^2/width, h = -g > 0.
   type, extends(enforcement_type) :: spring_type
      real(wp) :: width = 1.0_wp             !! [length]
   contains
      procedure :: word => spring_word
      procedure :: solves_for_multiplier => spring_solves
      procedure :: piecewise_linear => spring_is_linear
      procedure :: trial => spring_trial
      procedure :: stored => spring_stored
   end type spring_type

   !> An unknown force under which the penetration is a share of that of the perturbed Lagrangian.
   type, extends(enforcement_type) :: compliant_type
      real(wp) :: share = 1.0_wp
   contains
      procedure :: word => compliant_word
      procedure :: solves_for_multiplier => compliant_solves
      procedure :: penetration => compliant_penetration
      procedure :: stored => compliant_stored
   end type compliant_type

   !> phi^4 = (3/2 s.s)^2 + bend sum s_ii^4: not quadratic; von Mises' where nothing bends it.
   type, extends(yield_type) :: quartic_type
      real(wp) :: bend = 0.0_wp
   contains
      procedure :: evaluate => quartic_evaluate
   end type quartic_type

contains

   function wants_stress(self, model, frame) result(wants)
      class(stress_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(wants_type) :: wants

      associate (unused => self, also => model, too => frame)
         wants%stress = .true.
      end associate
   end function wants_stress

   function spring_word(self) result(word)
      class(spring_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'hardening spring'
      end associate
   end function spring_word

   pure logical function spring_solves(self)
      class(spring_type), intent(in) :: self
      associate (unused => self)
         spring_solves = .false.
      end associate
   end function spring_solves

   pure logical function spring_is_linear(self)
      class(spring_type), intent(in) :: self
      associate (unused => self)
         spring_is_linear = .false.
      end associate
   end function spring_is_linear

   elemental subroutine spring_trial(self, gap, alpha, multiplier, force, stiffness)
      class(spring_type), intent(in) :: self
      real(wp), intent(in) :: gap, alpha, multiplier
      real(wp), intent(out) :: force, stiffness

      associate (unused => multiplier)
         force = alpha*max(-gap, 0.0_wp)**2/self%width
         stiffness = 2.0_wp*alpha*max(-gap, 0.0_wp)/self%width
      end associate
   end subroutine spring_trial

   elemental real(wp) function spring_stored(self, gap, force, alpha) result(energy)
      class(spring_type), intent(in) :: self
      real(wp), intent(in) :: gap, force, alpha
      associate (unused => force)
         energy = alpha*max(-gap, 0.0_wp)**3/(3.0_wp*self%width)
      end associate
   end function spring_stored

   function compliant_word(self) result(word)
      class(compliant_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'compliant'
      end associate
   end function compliant_word

   pure logical function compliant_solves(self)
      class(compliant_type), intent(in) :: self
      associate (unused => self)
         compliant_solves = .true.
      end associate
   end function compliant_solves

   elemental real(wp) function compliant_penetration(self, force, alpha) result(depth)
      class(compliant_type), intent(in) :: self
      real(wp), intent(in) :: force, alpha
      depth = self%share*force/alpha
   end function compliant_penetration

   elemental real(wp) function compliant_stored(self, gap, force, alpha) result(energy)
      class(compliant_type), intent(in) :: self
      real(wp), intent(in) :: gap, force, alpha
      associate (unused => gap)
         energy = 0.5_wp*self%share*force**2/alpha
      end associate
   end function compliant_stored

   !> Coulomb's law that saturates at the shear yield stress (Wanheim and Bay's curve, smoothed):
   !> radius = k tanh(mu p/k).
   pure subroutine tanh_radius(law, p, at, radius, slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius, slope
      real(wp) :: k

      k = law%m*at%yield*at%growth/sqrt(3.0_wp)
      radius = k*tanh(law%mu*p/k)
      slope = law%mu/cosh(law%mu*p/k)**2
   end subroutine tanh_radius

   !> A law of the library written once more.
   pure subroutine coulomb_radius(law, p, at, radius, slope)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: p
      type(condition_type), intent(in) :: at
      real(wp), intent(out) :: radius, slope

      associate (unused => at)
         slope = law%mu
      end associate
      radius = slope*p
   end subroutine coulomb_radius

   pure subroutine quartic_evaluate(self, s, value, gradient, curvature)
      class(quartic_type), intent(in) :: self
      real(wp), intent(in) :: s(6)
      real(wp), intent(out) :: value, gradient(6), curvature(6, 6)
      real(wp) :: q, d(6), f(6)
      integer :: k, l

      value = 0.0_wp
      gradient = 0.0_wp
      curvature = 0.0_wp
      d = deviator_of(s)
      q = 1.5_wp*dot_product(d, d)
      if (.not. q > 0.0_wp) then
         do k = 1, 6
            curvature(k, k) = 1.5_wp
         end do
         curvature(:3, :3) = curvature(:3, :3) - 0.5_wp
         return
      end if
      ! F = phi^4; phi' = F'/(4 phi^3); (phi^2/2)'' = F''/(4 phi^2) - F' F'^T/(8 phi^6).
      f = 6.0_wp*q*d
      f(:3) = f(:3) + 4.0_wp*self%bend*d(:3)**3
      f = deviator_of(f)
      value = (q**2 + self%bend*sum(d(:3)**4))**0.25_wp
      gradient = f/(4.0_wp*value**3)
      do l = 1, 6
         curvature(:, l) = 18.0_wp*d*d(l)
         curvature(l, l) = curvature(l, l) + 6.0_wp*q
         if (l <= 3) curvature(l, l) = curvature(l, l) + 12.0_wp*self%bend*d(l)**2
      end do
      do l = 1, 6
         curvature(:, l) = deviator_of(curvature(:, l))
      end do
      do k = 1, 6
         curvature(k, :) = deviator_of(curvature(k, :))
      end do
      do l = 1, 6
         curvature(:, l) = curvature(:, l)/(4.0_wp*value**2) - f*f(l)/(8.0_wp*value**6)
      end do
   end subroutine quartic_evaluate
end module own_laws
