!> Isotropic linear elasticity: Hooke's matrix in the stress order of Lopin.
!>
!> 2D kinds: (xx, yy, zz, xy); axisymmetric: x = r, y = z, zz = hoop. 3D: (xx, yy, zz, xy, xz, yz).
!> Shear strains are engineering strains.
module lopin_elastic
   use lopin_kinds, only : wp
   implicit none
   private
   public :: hooke_matrix, plane_stress_matrix, thickness_strain, strain_energy_density

contains

   !> D for plane strain, axisymmetry (4 x 4) and solids (6 x 6).
   pure subroutine hooke_matrix(young, poisson, d)
      real(wp), intent(in) :: young      !! E > 0 [stress]
      real(wp), intent(in) :: poisson    !! in (-1, 0.5) [-]
      real(wp), intent(out) :: d(:, :)   !! (4, 4) or (6, 6) [stress]
      real(wp) :: lambda, shear
      integer :: i

      lambda = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
      shear = 0.5_wp*young/(1.0_wp + poisson)
      d = 0.0_wp
      d(:3, :3) = lambda
      do i = 1, 3
         d(i, i) = lambda + 2.0_wp*shear
      end do
      do i = 4, size(d, 1)
         d(i, i) = shear
      end do
   end subroutine hooke_matrix

   !> D for plane stress: the row and the column of zz are zero.
   pure subroutine plane_stress_matrix(young, poisson, d)
      real(wp), intent(in) :: young      !! E > 0 [stress]
      real(wp), intent(in) :: poisson    !! in (-1, 0.5] [-]
      real(wp), intent(out) :: d(4, 4)   !! [stress]

      d = 0.0_wp
      d(1, 1) = young/(1.0_wp - poisson**2)
      d(2, 2) = d(1, 1)
      d(1, 2) = poisson*d(1, 1)
      d(2, 1) = d(1, 2)
      d(4, 4) = 0.5_wp*young/(1.0_wp + poisson)
   end subroutine plane_stress_matrix

   !> Strain through the thickness in plane stress.
   pure real(wp) function thickness_strain(poisson, strain)
      real(wp), intent(in) :: poisson
      real(wp), intent(in) :: strain(:)   !! (xx, yy, ...)
      thickness_strain = -poisson/(1.0_wp - poisson)*(strain(1) + strain(2))
   end function thickness_strain

   !> Half of stress times strain [energy/volume].
   pure real(wp) function strain_energy_density(stress, strain)
      real(wp), intent(in) :: stress(:), strain(:)
      strain_energy_density = 0.5_wp*dot_product(stress, strain)
   end function strain_energy_density
end module lopin_elastic
