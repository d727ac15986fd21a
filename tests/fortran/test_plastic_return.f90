!> A yield surface that only this test knows.
module own_yield
   use lopin_kinds, only : wp
   use lopin_kelvin, only : deviator_of
   use lopin_yield_surface, only : yield_type
   implicit none
   private
   public :: own_yield_type

   !> The root of the square of Mises' stress and the norm of fourth powers.
   type, extends(yield_type) :: own_yield_type
      real(wp) :: weight = 0.5_wp
   contains
      procedure :: evaluate => evaluate_own
   end type own_yield_type

contains

   pure subroutine evaluate_own(self, s, value, gradient, curvature)
      class(own_yield_type), intent(in) :: self
      real(wp), intent(in) :: s(6)
      real(wp), intent(out) :: value, gradient(6), curvature(6, 6)
      real(wp) :: four, slope(6)
      integer :: k

      four = sqrt(sum(s**4))
      value = sqrt(1.5_wp*dot_product(s, s) + self%weight*four)
      gradient = 0.0_wp
      curvature = 0.0_wp
      if (value > 0.0_wp) then
         slope = s**3/four
         gradient = 1.5_wp*s + self%weight*slope
         do k = 1, 6
            curvature(:, k) = -2.0_wp*self%weight*slope*slope(k)/four
            curvature(k, k) = curvature(k, k) + 1.5_wp + 3.0_wp*self%weight*s(k)**2/four
         end do
         gradient = gradient/value
      end if
      ! On deviators.
      gradient = deviator_of(gradient)
      do k = 1, 6
         curvature(:, k) = deviator_of(curvature(:, k))
      end do
      do k = 1, 6
         curvature(k, :) = deviator_of(curvature(k, :))
      end do
   end subroutine evaluate_own
end module own_yield

!> The return to yield surfaces that are not von Mises', or that move.
program test_plastic_return
   use lopin_kinds, only : wp
   use lopin_kelvin, only : kelvin_of, tensor_of, deviator_of
   use lopin_flow_curve, only : flow_type, linear_flow, swift_flow, voce_flow
   use lopin_radial_return, only : return_type, return_radially
   use own_yield, only : own_yield_type
   use lopin_yield_hill, only : hill_yield_type, hill_yield, ratios_of_lankford, is_convex
   use lopin_plastic_return, only : plastic_type, plastic_past_type, plastic_answer_type, &
      & return_to_surface
   use blocks, only : random
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: shear = 80.0_wp, dt = 0.3_wp

   call unit_ratios_are_von_mises()
   call locus_in_eight_directions()
   call lankford_gives_its_ratios()
   call every_trial_comes_back()
   call slope_is_that_of_the_stress()
   call units_do_not_matter()
   call loop_is_that_of_the_equation()
   call finish()

contains

   !> Surfaces and hardening by number.
   function law(number) result(self)
      integer, intent(in) :: number
      type(plastic_type) :: self

      select case (mod(number, 4))
      case (0)
         self%yield = hill_yield([1.0_wp, 1.3_wp, 0.8_wp, 0.9_wp, 1.2_wp, 0.7_wp])
      case (1)
         self%yield = hill_yield(ratios_of_lankford([0.3_wp, 1.2_wp, 4.0_wp]))
      case (2)
         self%yield = own_yield_type()
      case default
         self%yield = hill_yield(spread(1.0_wp, 1, 6))
      end select
      if (number < 4) return
      self%kinematic%n = 2
      self%kinematic%modulus(:2) = [30.0_wp, 2.0_wp]
      if (number >= 8) self%kinematic%recovery(:2) = [20.0_wp, 1.5_wp]
   end function law

   function past_of(self) result(past)
      type(plastic_type), intent(in) :: self
      type(plastic_past_type) :: past

      past%strain = 0.1_wp
      past%dt = dt
      past%radius = 1.1_wp
      if (self%kinematic%n > 0) past%back(:, 1) = [0.3_wp, -0.1_wp, -0.2_wp, 0.2_wp, 0.1_wp, 0.0_wp]
   end function past_of

   function trial(seed, size_of) result(strain)
      integer, intent(inout) :: seed
      real(wp), intent(in) :: size_of
      real(wp) :: strain(6)
      integer :: k

      do k = 1, 6
         call random(seed, strain(k))
      end do
      strain = strain*size_of/norm2(deviator_of(strain))
   end function trial

   subroutine unit_ratios_are_von_mises()
      type(plastic_type) :: self
      type(plastic_past_type) :: past
      type(plastic_answer_type) :: answer
      type(return_type) :: back
      type(flow_type) :: flow
      real(wp) :: e(6), d(6), slope(6, 6)
      integer :: k, seed, number

      call test('unit ratios, or one ratio of Lankford for all, are von Mises'' return')
      seed = 5
      self = law(3)
      past = past_of(self)
      flow = voce_flow(2.0_wp, 1.0_wp, 3.0_wp, 0.4_wp)
      do number = 1, 2
         if (number == 2) self%yield = hill_yield(ratios_of_lankford(spread(1.0_wp, 1, 3)))
         e = trial(seed, 0.1_wp)
         d = deviator_of(e)
         call return_to_surface(self, flow, shear, e, past, answer)
         back = return_radially(flow, shear, norm2(d), past%strain, past%dt)
         call close_to('step', answer%step, back%step, 1.0e-15_wp)
         call close_to('stress', answer%stress, back%secant*d, 1.0e-13_wp)
         do k = 1, 6
            slope(:, k) = back%along*d*d(k)/dot_product(d, d)
            slope(k, k) = slope(k, k) + back%secant
         end do
         slope(:3, :3) = slope(:3, :3) - back%secant/3.0_wp
         call close_to('slope', reshape(answer%slope, [36]), reshape(slope, [36]), 1.0e-11_wp)
      end do
   end subroutine unit_ratios_are_von_mises

   !> Plane of s11 and s22: the length of the stress of each direction at yield, from Hill's formula.
   subroutine locus_in_eight_directions()
      real(wp), parameter :: ratio(6) = [1.0_wp, 1.3_wp, 0.8_wp, 0.9_wp, 1.2_wp, 0.7_wp]
      real(wp), parameter :: pi = acos(-1.0_wp), y = 2.0_wp
      type(plastic_type) :: self
      real(wp) :: f, g, h, a, b, radius, stress(6)
      integer :: k

      call test('the yield locus of Hill in eight directions, and in the three shears')
      self = law(0)
      f = 0.5_wp*(1.0_wp/1.3_wp**2 + 1.0_wp/0.64_wp - 1.0_wp)
      g = 0.5_wp*(1.0_wp/0.64_wp + 1.0_wp - 1.0_wp/1.3_wp**2)
      h = 0.5_wp*(1.0_wp + 1.0_wp/1.3_wp**2 - 1.0_wp/0.64_wp)
      do k = 0, 7
         a = cos(k*pi/4.0_wp)
         b = sin(k*pi/4.0_wp)
         radius = y/sqrt(f*b**2 + g*a**2 + h*(a - b)**2)
         stress = radius*[a, b, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
         call yields_there(self, y, 'plane', stress)
      end do
      do k = 1, 3
         stress = 0.0_wp
         stress(k) = ratio(k)*y
         call yields_there(self, y, 'tension', stress)
         stress = 0.0_wp
         stress(3 + k) = sqrt(2.0_wp)*ratio(3 + k)*y/sqrt(3.0_wp)
         call yields_there(self, y, 'shear', stress)
      end do
   end subroutine locus_in_eight_directions

   !> 1e-8 below it is at rest, 1e-8 above it comes back to it.
   subroutine yields_there(self, y, what, stress)
      type(plastic_type), intent(in) :: self
      real(wp), intent(in) :: y
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: stress(6)
      type(plastic_answer_type) :: answer

      call return_to_surface(self, linear_flow(y, 0.0_wp), shear, &
         & (1.0_wp - 1.0e-8_wp)*stress/(2.0_wp*shear), plastic_past_type(), answer)
      call is_true(what//': at rest below', .not. answer%step > 0.0_wp)
      call return_to_surface(self, linear_flow(y, 0.0_wp), shear, &
         & (1.0_wp + 1.0e-8_wp)*stress/(2.0_wp*shear), plastic_past_type(), answer)
      call is_true(what//': flows above', answer%step > 0.0_wp)
      call close_to(what//': comes back', answer%stress, deviator_of(stress), 1.0e-7_wp*y)
   end subroutine yields_there

   !> Plastic flow of a strip cut at an angle: width by thickness.
   subroutine lankford_gives_its_ratios()
      real(wp), parameter :: r(3) = [1.7_wp, 1.2_wp, 2.1_wp], pi = acos(-1.0_wp)
      type(hill_yield_type) :: yield
      real(wp) :: value, gradient(6), curvature(6, 6), flow(3, 3), along(3), across(3)
      integer :: k

      call test('Lankford''s numbers come back from the flow of tension at 0, 45 and 90 degrees')
      yield = hill_yield(ratios_of_lankford(r))
      do k = 0, 2
         along = [cos(k*pi/4.0_wp), sin(k*pi/4.0_wp), 0.0_wp]
         across = [-along(2), along(1), 0.0_wp]
         call yield%evaluate(deviator_of(kelvin_of(spread(along, 1, 3)*spread(along, 2, 3))), &
            & value, gradient, curvature)
         flow = tensor_of(gradient)
         call close_to('r', dot_product(across, matmul(flow, across))/flow(3, 3), r(k + 1), &
            & 1.0e-13_wp)
         if (k == 0) call close_to('along direction 1 the flow stress', value, 1.0_wp, 1.0e-14_wp)
      end do
      call is_true('closed', is_convex(ratios_of_lankford(r)))
      call is_true('open', .not. is_convex([1.0_wp, 1.0_wp, 0.5_wp, 1.0_wp, 1.0_wp, 1.0_wp]))
   end subroutine lankford_gives_its_ratios

   !> Trials up to a thousand times the yield strain.
   subroutine every_trial_comes_back()
      type(plastic_type) :: self
      type(plastic_answer_type) :: answer
      type(flow_type) :: flow
      real(wp) :: gradient(6), curvature(6, 6), value, back(6)
      integer :: number, k, seed, kind

      call test('every trial comes back to the surface')
      seed = 11
      do kind = 1, 3
         flow = swift_flow(2.0_wp, 0.01_wp, 0.2_wp)
         if (kind == 2) flow = linear_flow(1.0_wp, 0.0_wp)
         if (kind == 3) then
            flow%rate = 2.0_wp
            flow%power = 5.0_wp
         end if
         do number = 0, 11
            self = law(number)
            do k = 1, 60
               call return_to_surface(self, flow, shear, &
                  & trial(seed, 0.005_wp*10.0_wp**(0.05_wp*k)), past_of(self), answer)
               call is_true('found', answer%found)
               back = sum(answer%back(:, :self%kinematic%n), dim=2)
               call self%yield%evaluate(answer%stress - back, value, gradient, curvature)
               if (answer%step > 0.0_wp) call close_to('on it', value/answer%radius, 1.0_wp, &
                  & 1.0e-10_wp)
               call close_to('flow', answer%flow, answer%step*gradient, 1.0e-10_wp*answer%step)
            end do
         end do
      end do
   end subroutine every_trial_comes_back

   subroutine slope_is_that_of_the_stress()
      type(plastic_type) :: self
      type(plastic_past_type) :: past
      type(plastic_answer_type) :: answer, moved
      type(flow_type) :: flow
      real(wp), parameter :: step = 1.0e-4_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      real(wp), parameter :: share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]
      real(wp) :: e(6), one(6), slope(6)
      integer :: number, k, s, seed

      call test('the slope is that of the stress; symmetric unless the backstress recovers')
      seed = 3
      flow = swift_flow(2.0_wp, 0.01_wp, 0.2_wp)
      flow%rate = 2.0_wp
      flow%power = 3.0_wp
      do number = 0, 11
         self = law(number)
         past = past_of(self)
         e = trial(seed, 0.2_wp)
         call return_to_surface(self, flow, shear, e, past, answer)
         do k = 1, 6
            one = 0.0_wp
            one(k) = step
            slope = 0.0_wp
            do s = 1, 4
               call return_to_surface(self, flow, shear, e + place(s)*one, past, moved)
               slope = slope + share(s)*moved%stress/(12.0_wp*step)
            end do
            call close_to('slope', answer%slope(:, k)/shear, slope/shear, 1.0e-9_wp)
         end do
         if (number < 4) call close_to('symmetric', maxval(abs(answer%slope &
            & - transpose(answer%slope)))/shear, 0.0_wp, 1.0e-13_wp)
      end do
   end subroutine slope_is_that_of_the_stress

   subroutine units_do_not_matter()
      type(plastic_type) :: self
      type(plastic_past_type) :: past
      type(plastic_answer_type) :: answer, scaled
      real(wp), parameter :: unit = 1.0e9_wp
      integer :: number, seed
      real(wp) :: e(6)

      call test('another unit of stress')
      seed = 17
      do number = 0, 11
         self = law(number)
         past = past_of(self)
         e = trial(seed, 0.1_wp)
         call return_to_surface(self, linear_flow(1.0_wp, 0.5_wp), shear, e, past, answer)
         self%kinematic%modulus = unit*self%kinematic%modulus
         past%back = unit*past%back
         past%radius = unit*past%radius
         call return_to_surface(self, linear_flow(unit, 0.5_wp*unit), unit*shear, e, past, scaled)
         call close_to('stress', scaled%stress/unit, answer%stress, 1.0e-12_wp)
         call close_to('flow', scaled%flow, answer%flow, 1.0e-14_wp)
         call close_to('work', scaled%work/unit, answer%work, 1.0e-13_wp)
      end do
   end subroutine units_do_not_matter

   !> Tension, compression and tension again, in steps of any length: at each reversal the stress
   !> of the equation of Armstrong and Frederick, integrated over each branch in closed form.
   subroutine loop_is_that_of_the_equation()
      type(plastic_type) :: self
      type(plastic_past_type) :: past
      type(plastic_answer_type) :: answer
      type(flow_type) :: flow
      real(wp), parameter :: y = 1.0_wp, c(2) = [30.0_wp, 2.0_wp], gamma(2) = [20.0_wp, 1.5_wp]
      real(wp), parameter :: target(3) = [0.05_wp, -0.03_wp, 0.08_wp]
      real(wp) :: total, plastic, elastic, alpha(2), p, way, low, high, mid, sign_of, before, &
         & carried
      integer :: branch, step, steps, trial_number

      call test('a loop of tension and compression is that of the integrated equation')
      self = law(11)
      flow = voce_flow(1.5_wp, y, 4.0_wp, 0.0_wp)
      do trial_number = 1, 2
         steps = merge(1, 13, trial_number == 1)
         past = plastic_past_type(radius=y)
         plastic = 0.0_wp
         total = 0.0_wp
         alpha = 0.0_wp
         p = 0.0_wp
         do branch = 1, 3
            way = target(branch) - total
            sign_of = sign(1.0_wp, way)
            before = plastic
            do step = 1, steps
               total = total + way/steps
               ! Deviator of the strain of a bar whose elastic deviator is that of its stress.
               elastic = total - plastic
               call return_to_surface(self, flow, shear, elastic*[1.0_wp, -0.5_wp, -0.5_wp, &
                  & 0.0_wp, 0.0_wp, 0.0_wp], past, answer)
               plastic = plastic + answer%flow(1)
               past%strain = past%strain + answer%step
               past%radius = answer%radius
               past%back = answer%back
            end do
            ! The same in one number: 3 G (total - plastic) = sign (y(p) + a), a and p of the branch.
            low = 0.0_wp
            high = 0.2_wp
            do step = 1, 200
               mid = 0.5_wp*(low + high)
               carried = sum(sign_of*c/gamma + (alpha - sign_of*c/gamma)*exp(-gamma*mid)) &
                  & + sign_of*(1.5_wp - 0.5_wp*exp(-4.0_wp*(p + mid)))
               if (sign_of*(3.0_wp*shear*(total - before - sign_of*mid) - carried) > 0.0_wp) then
                  low = mid
               else
                  high = mid
               end if
            end do
            alpha = sign_of*c/gamma + (alpha - sign_of*c/gamma)*exp(-gamma*mid)
            p = p + mid
            call close_to('accumulated', past%strain, p, 1.0e-12_wp)
            call close_to('stress', 1.5_wp*answer%stress(1), sum(alpha) + sign_of*(1.5_wp &
               & - 0.5_wp*exp(-4.0_wp*p)), 1.0e-11_wp)
         end do
      end do
   end subroutine loop_is_that_of_the_equation
end program test_plastic_return
