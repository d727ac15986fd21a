program test_elastic
   use lopin_kinds, only : wp
   use lopin_elastic, only : hooke_matrix, plane_stress_matrix, thickness_strain, &
      & strain_energy_density
   use check, only : test, close_to, finish
   implicit none

   call uniaxial_tension_gives_young_and_poisson()
   call uniform_strain_gives_the_bulk_modulus()
   call plane_stress_is_the_solid_without_stress_through_the_thickness()
   call finish()

contains

   subroutine uniaxial_tension_gives_young_and_poisson()
      real(wp) :: d(6, 6), strain(6), stress(6)
      call test('uniaxial tension gives Young and Poisson back')
      call hooke_matrix(210.0_wp, 0.3_wp, d)
      strain = [1.0_wp, -0.3_wp, -0.3_wp, 0.2_wp, 0.0_wp, 0.0_wp]
      stress = matmul(d, strain)
      call close_to('stress', stress, &
         & [210.0_wp, 0.0_wp, 0.0_wp, 0.2_wp*210.0_wp/2.6_wp, 0.0_wp, 0.0_wp], 1.0e-12_wp)
      call close_to('energy', strain_energy_density(stress, strain), &
         & 105.0_wp + 0.02_wp*210.0_wp/2.6_wp, 1.0e-13_wp)
   end subroutine uniaxial_tension_gives_young_and_poisson

   subroutine uniform_strain_gives_the_bulk_modulus()
      real(wp) :: d(4, 4), stress(4)
      call test('equal strains give the bulk modulus K = E/3(1-2 nu)')
      call hooke_matrix(3.0_wp, 0.25_wp, d)
      stress = matmul(d, [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp])
      call close_to('stress', stress, [6.0_wp, 6.0_wp, 6.0_wp, 0.0_wp], 1.0e-13_wp)
   end subroutine uniform_strain_gives_the_bulk_modulus

   subroutine plane_stress_is_the_solid_without_stress_through_the_thickness()
      real(wp) :: d(4, 4), solid(4, 4), strain(4)
      call test('plane stress equals the solid whose thickness strain makes zz vanish')
      call plane_stress_matrix(70.0_wp, 0.33_wp, d)
      call hooke_matrix(70.0_wp, 0.33_wp, solid)
      strain = [0.7_wp, -0.2_wp, 0.0_wp, 0.4_wp]
      strain(3) = thickness_strain(0.33_wp, strain)
      call close_to('stress', matmul(d, strain), matmul(solid, strain), 1.0e-13_wp)
   end subroutine plane_stress_is_the_solid_without_stress_through_the_thickness
end program test_elastic
