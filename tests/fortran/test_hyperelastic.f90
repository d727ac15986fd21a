program test_hyperelastic
   use lopin_kinds, only : wp
   use lopin_log_strain, only : log_one_plus, exp_minus_one
   use lopin_hyperelastic, only : solid_law_type, hencky_law, green_law, neo_hooke_law, &
      & finite_response, past_type, log_strain, total_change, thickness_change, &
      & condense_thickness, volume_change, elastic_constants
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: young = 210.0_wp, poisson = 0.3_wp
   real(wp), parameter :: shear = young/2.6_wp, bulk = young/1.2_wp
   real(wp), parameter :: unit(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
      & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
   type(solid_law_type) :: hencky, green, neo_hooke

   hencky = hencky_law(young, poisson)
   green = green_law(young, poisson)
   neo_hooke = neo_hooke_law(0.5_wp*shear, 2.0_wp/bulk)
   call constants_are_those_of_small_strain()
   call small_numbers_keep_their_digits()
   call hencky_in_a_bar()
   call hencky_holds_under_any_compression()
   call green_in_a_column()
   call rubber_in_a_bar()
   call simple_shear()
   call the_tangent_is_the_rate_of_the_stress()
   call a_scaled_volume_is_a_scaled_deformation()
   call plane_stress_at_rest_is_the_linear_one()
   call finish()

contains

   !> Stress, energy and tangent of a deformation gradient 1 + h.
   subroutine response(law, h, stress, energy, tangent)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: h(3, 3)
      real(wp), intent(out) :: stress(6), energy
      real(wp), intent(out), optional :: tangent(6, 6)
      real(wp) :: change(3, 3)

      change = h + transpose(h) + matmul(h, transpose(h))
      call finite_response(law, past_type(), change, volume_change(h), volume_change(h), stress, &
         & energy, tangent)
   end subroutine response

   subroutine constants_are_those_of_small_strain()
      real(wp) :: e, nu
      call test('a law gives back its elastic constants')
      call elastic_constants(hencky, e, nu)
      call close_to('Hencky', [e, nu], [young, poisson], 1.0e-14_wp)
      call elastic_constants(neo_hooke, e, nu)
      call close_to('neo-Hooke', [e, nu], [young, poisson], 1.0e-14_wp)
   end subroutine constants_are_those_of_small_strain

   subroutine small_numbers_keep_their_digits()
      real(wp) :: x
      integer :: k

      call test('log(1 + x) and exp(x) - 1 are exact for small and large x')
      do k = -14, 0
         x = 0.37_wp*10.0_wp**k
         call close_to('there and back', log_one_plus(exp_minus_one(x))/x, 1.0_wp, 4.0e-15_wp)
         call close_to('negative', exp_minus_one(log_one_plus(-x))/x, -1.0_wp, 4.0e-15_wp)
         call close_to('series', log_one_plus(1.0e-3_wp*x)/(1.0e-3_wp*x), 1.0_wp &
            & - 0.5e-3_wp*x + x**2*1.0e-6_wp/3.0_wp, 1.0e-10_wp)
      end do
   end subroutine small_numbers_keep_their_digits

   !> A bar at stretch l is thinned to l**(-nu); Kirchhoff stress is E ln l.
   subroutine hencky_in_a_bar()
      real(wp) :: h(3, 3), stress(6), energy, stretch, strain(6)
      integer :: k

      do k = -4, 4
         stretch = exp(0.3_wp*k)
         call test('a Hencky bar carries E ln l')
         h = 0.0_wp
         h(1, 1) = stretch - 1.0_wp
         h(2, 2) = stretch**(-poisson) - 1.0_wp
         h(3, 3) = h(2, 2)
         call response(hencky, h, stress, energy)
         call close_to('stress', stress/young, [log(stretch), 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
            & 0.0_wp], 1.0e-14_wp)
         call close_to('energy', energy/young, 0.5_wp*log(stretch)**2, 1.0e-14_wp)
         strain = log_strain(total_change(h), volume_change(h))
         call close_to('strain', strain, log(stretch)*[1.0_wp, -poisson, -poisson, 0.0_wp, 0.0_wp, &
            & 0.0_wp], 1.0e-14_wp)
      end do
   end subroutine hencky_in_a_bar

   !> The force of a confined column grows without bound as it is pressed flat.
   subroutine hencky_holds_under_any_compression()
      real(wp) :: h(3, 3), stress(6), energy, last
      integer :: k

      call test('a confined column resists more the flatter it is pressed')
      last = 0.0_wp
      h = 0.0_wp
      do k = 1, 9
         h(3, 3) = -0.1_wp*k
         call response(hencky, h, stress, energy)
         call is_true('grows', stress(3)/(1.0_wp + h(3, 3)) < last)
         last = stress(3)/(1.0_wp + h(3, 3))
      end do
   end subroutine hencky_holds_under_any_compression

   !> Confined: the force of a column is (lame/2 + shear) l (l**2 - 1), least at l = 1/sqrt(3).
   subroutine green_in_a_column()
      real(wp) :: h(3, 3), stress(6), energy, l, least
      integer :: k

      call test('a confined column of St Venant-Kirchhoff is weakest at 1/sqrt(3) of its height')
      h = 0.0_wp
      least = 0.0_wp
      do k = 1, 9
         l = 1.0_wp - 0.1_wp*k
         h(3, 3) = l - 1.0_wp
         call response(green, h, stress, energy)
         call close_to('force', stress(3)/l, &
            & 0.5_wp*(bulk + 4.0_wp*shear/3.0_wp)*l*(l**2 - 1.0_wp), 1.0e-14_wp*bulk)
         call close_to('energy', energy, 0.125_wp*(bulk + 4.0_wp*shear/3.0_wp)*(l**2 - 1.0_wp)**2, &
            & 1.0e-14_wp*bulk)
         least = min(least, stress(3)/l)
      end do
      h(3, 3) = 1.0_wp/sqrt(3.0_wp) - 1.0_wp
      call response(green, h, stress, energy)
      call is_true('least', stress(3)*sqrt(3.0_wp) <= least)
   end subroutine green_in_a_column

   !> Almost incompressible rubber: s = mu (l**2 - 1/l), thickness 1/sqrt(l).
   subroutine rubber_in_a_bar()
      type(solid_law_type) :: rubber
      real(wp) :: h(3, 3), stress(6), energy, stretch
      integer :: k

      rubber = neo_hooke_law(0.5_wp, 2.0e-8_wp)
      do k = -5, 5
         stretch = exp(0.25_wp*k)
         call test('an incompressible neo-Hookean bar carries mu (l**2 - 1/l)')
         h = 0.0_wp
         h(1, 1) = stretch - 1.0_wp
         h(2, 2) = 1.0_wp/sqrt(stretch) - 1.0_wp
         h(3, 3) = thickness_change(rubber, past_type(), 0.0_wp, h + transpose(h) &
            & + matmul(h, transpose(h)), volume_change(h))
         call close_to('thickness', h(3, 3), h(2, 2), 1.0e-7_wp)
         call response(rubber, h, stress, energy)
         call close_to('stress', stress(:3), [stretch**2 - 1.0_wp/stretch, 0.0_wp, 0.0_wp], &
            & 1.0e-7_wp)
         call close_to('energy', energy, 0.5_wp*(stretch**2 + 2.0_wp/stretch - 3.0_wp), 1.0e-7_wp)
      end do
   end subroutine rubber_in_a_bar

   !> F = 1 + g e1 e2. Hencky: principal strains +-asinh(g/2), turned by half of acot(g/2).
   subroutine simple_shear()
      real(wp) :: h(3, 3), stress(6), energy, g
      integer :: k

      do k = 1, 12
         g = 0.25_wp*k
         h = 0.0_wp
         h(1, 2) = g
         call test('simple shear of a neo-Hookean solid: mu g, and mu g**2 between the normals')
         call response(neo_hooke, h, stress, energy)
         call close_to('stress', stress/shear, [2.0_wp*g**2/3.0_wp, -g**2/3.0_wp, -g**2/3.0_wp, g, &
            & 0.0_wp, 0.0_wp], 1.0e-13_wp)
         call test('simple shear of a Hencky solid')
         call response(hencky, h, stress, energy)
         call close_to('stress', stress/shear, 2.0_wp*asinh(0.5_wp*g)/sqrt(4.0_wp + g**2) &
            & *[g, -g, 0.0_wp, 2.0_wp, 0.0_wp, 0.0_wp], 1.0e-13_wp)
         call close_to('energy', energy/shear, 2.0_wp*asinh(0.5_wp*g)**2, 1.0e-13_wp)
      end do
   end subroutine simple_shear

   !> d tau = c d + l tau + tau l^T for F <- (1 + l) F, also where stretches (almost) coalesce.
   subroutine the_tangent_is_the_rate_of_the_stress()
      real(wp), parameter :: apart(6) = [0.3_wp, 1.0e-2_wp, 7.0e-3_wp, 1.0e-5_wp, 1.0e-9_wp, 0.0_wp]
      real(wp) :: h(3, 3), stress(6), tangent(6, 6), energy
      integer :: i

      do i = 1, size(apart)
         call test('the tangent is the Lie rate of the Kirchhoff stress')
         h = 0.4_wp*unit
         h(1, 1) = h(1, 1) + apart(i)
         h(2, 2) = h(2, 2) - 0.7_wp*apart(i)
         h(1, 3) = 0.3_wp*apart(i)
         h(2, 1) = 0.6_wp*apart(i)
         call response(hencky, h, stress, energy, tangent)
         call compare_rates(hencky, h, stress, tangent)
         call response(green, h, stress, energy, tangent)
         call compare_rates(green, h, stress, tangent)
         call response(neo_hooke, h, stress, energy, tangent)
         call compare_rates(neo_hooke, h, stress, tangent)
      end do
   end subroutine the_tangent_is_the_rate_of_the_stress

   subroutine compare_rates(law, h, stress, tangent)
      type(solid_law_type), intent(in) :: law
      real(wp), intent(in) :: h(3, 3), stress(6), tangent(6, 6)
      integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
      real(wp), parameter :: step = 1.0e-3_wp, place(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp]
      real(wp) :: l(3, 3), s(3, 3), turned(3, 3), moved(6, 4), rate(6), expected(6), energy
      integer :: k, p, r

      s = reshape(stress([1, 4, 5, 4, 2, 6, 5, 6, 3]), [3, 3])
      do k = 1, 6
         l = 0.0_wp
         l(row(k), column(k)) = 1.0_wp
         do p = 1, 4
            call response(law, h + step*place(p)*matmul(l, unit + h), moved(:, p), energy)
         end do
         rate = (moved(:, 1) - 8.0_wp*moved(:, 2) + 8.0_wp*moved(:, 3) - moved(:, 4)) &
            & /(12.0_wp*step)
         turned = matmul(l, s) + matmul(s, transpose(l))
         expected = tangent(:, k) + [(turned(row(r), column(r)), r=1, 6)]
         call close_to('rate', rate/young, expected/young, 1.0e-9_wp)
      end do
      call close_to('symmetry', (tangent - transpose(tangent))/young, 0.0_wp*tangent, 1.0e-14_wp)
   end subroutine compare_rates

   subroutine a_scaled_volume_is_a_scaled_deformation()
      real(wp) :: h(3, 3), change(3, 3), f(3, 3), one(6), two(6), c1(6, 6), c2(6, 6), e1, e2
      real(wp), parameter :: volume = 0.17_wp
      integer :: l
      type(solid_law_type) :: law

      do l = 1, 2
         law = hencky
         if (l == 2) law = neo_hooke
         call test('a change of volume that is given apart is that of the scaled deformation')
         h = reshape([0.4_wp, 0.3_wp, -0.1_wp, -0.2_wp, -0.3_wp, 0.1_wp, 0.3_wp, 0.2_wp, 0.1_wp], &
            & [3, 3])
         change = h + transpose(h) + matmul(h, transpose(h))
         call finite_response(law, past_type(), change, volume_change(h), volume, one, e1, c1)
         f = ((1.0_wp + volume)/(1.0_wp + volume_change(h)))**(1.0_wp/3.0_wp)*(unit + h)
         call response(law, f - unit, two, e2, c2)
         call close_to('stress', one/young, two/young, 1.0e-13_wp)
         call close_to('energy', e1/young, e2/young, 1.0e-13_wp)
         call close_to('tangent', c1/young, c2/young, 1.0e-12_wp)
      end do
   end subroutine a_scaled_volume_is_a_scaled_deformation

   subroutine plane_stress_at_rest_is_the_linear_one()
      real(wp) :: tangent(4, 4), d(4, 4), stress(4), energy, none(3, 3)

      none = 0.0_wp
      call test('at rest the tangents are Hooke''s matrices')
      call finite_response(hencky, past_type(), none, 0.0_wp, 0.0_wp, stress, energy, tangent)
      call hooke_matrix(young, poisson, d)
      call close_to('Hencky', tangent/young, d/young, 1.0e-14_wp)
      call finite_response(neo_hooke, past_type(), none, 0.0_wp, 0.0_wp, stress, energy, tangent)
      call close_to('neo-Hooke', tangent/young, d/young, 1.0e-14_wp)
      call condense_thickness(tangent)
      call plane_stress_matrix(young, poisson, d)
      call close_to('plane stress', tangent/young, d/young, 1.0e-14_wp)
   end subroutine plane_stress_at_rest_is_the_linear_one
end program test_hyperelastic
