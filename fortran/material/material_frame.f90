!> Laws on axes of the material at finite strain: from a trial deformation to its logarithmic strain
!> on these axes, and back from stress and tangent there to Kirchhoff stress and spatial tangent.
!>
!> The deformation is split into an elastic and a plastic part, F = Fe Fp. The law is written in the
!> logarithmic strain e = ln(Fe^T Fe)/2 of the intermediate shape, in which the axes of the material
!> stay: they turn in space with the elastic part, the increments of Fp being free of spin (Weber
!> and Anand 1990, Eterovic and Bathe 1990). With the principal directions N_k there and n_k in
!> space and the stretches l_k, the stress T that works on e gives Kirchhoff components
!> t_kl = d/sinh(d) T_kl, d = e_k - e_l, and the tangent adds, to that of the law so scaled, terms
!> with second divided differences of ln(x)/2 at the squares of the stretches.
module lopin_material_frame
   use lopin_kinds, only : wp
   use lopin_kelvin, only : kelvin_rotation, tensor_of, root_two
   use lopin_log_strain, only : log_frame_type, new_log_frame, first_axis, second_axis, &
      & exp_minus_one
   implicit none
   private
   public :: material_frame_type, new_material_frame, frame_elastic_strain, spatial_stress, &
      & spatial_tangent, plastic_map

   type :: material_frame_type
      type(log_frame_type) :: space          !! principal directions in space, stretches
      real(wp) :: own(3, 3)                  !! columns: the same on the axes of the material
      real(wp) :: to_own(6, 6)               !! Kelvin vectors from principal to material axes
      real(wp) :: scale(6)                   !! d/sinh d by component of a Kelvin vector
   end type material_frame_type

   !> Differences of principal values below which a series takes the place of a quotient.
   real(wp), parameter :: near = 4.0e-3_wp, near_three = 2.0e-2_wp

contains

   pure subroutine new_material_frame(self, h, map, axes)
      type(material_frame_type), intent(out) :: self
      real(wp), intent(in) :: h(3, 3)        !! F - 1
      real(wp), intent(in) :: map(3, 3)      !! inverse of Fp, - 1
      real(wp), intent(in) :: axes(3, 3)     !! rows: axes of the material
      real(wp) :: trial(3, 3), change(3, 3), d
      integer :: k

      trial = h + map + matmul(h, map)
      change = trial + transpose(trial) + matmul(trial, transpose(trial))
      call new_log_frame(self%space, change)
      do k = 1, 3
         associate (n => self%space%axis(:, k))
            self%own(:, k) = matmul(axes, n + matmul(n, trial))/sqrt(1.0_wp + self%space%change(k))
         end associate
      end do
      self%to_own = kelvin_rotation(self%own)
      self%scale = 1.0_wp
      do k = 4, 6
         d = self%space%e(first_axis(k)) - self%space%e(second_axis(k))
         if (abs(d) < near) then
            self%scale(k) = 1.0_wp - d**2/6.0_wp + 7.0_wp*d**4/360.0_wp
         else
            associate (one => self%space%change(first_axis(k)), &
               & two => self%space%change(second_axis(k)))
               self%scale(k) = 2.0_wp*d*sqrt((1.0_wp + one)*(1.0_wp + two))/(one - two)
            end associate
         end if
      end do
   end subroutine new_material_frame

   !> Logarithmic strain on the axes of the material, as a Kelvin vector.
   pure function frame_elastic_strain(self) result(strain)
      type(material_frame_type), intent(in) :: self
      real(wp) :: strain(6)
      strain = matmul(self%to_own(:, :3), self%space%e)
   end function frame_elastic_strain

   !> Kirchhoff stress in space, in the order of stress.
   pure function spatial_stress(self, stress) result(tau)
      type(material_frame_type), intent(in) :: self
      real(wp), intent(in) :: stress(6)      !! T on the axes of the material, a Kelvin vector
      real(wp) :: tau(6), to_space(6, 6)

      tau = self%scale*matmul(stress, self%to_own)
      to_space = kelvin_rotation(self%space%axis)
      tau = matmul(to_space, tau)
      tau(4:) = tau(4:)/root_two
   end function spatial_stress

   !> Lie rate of the Kirchhoff stress per rate of deformation, engineering shears.
   pure function spatial_tangent(self, stress, slope) result(tangent)
      type(material_frame_type), intent(in) :: self
      real(wp), intent(in) :: stress(6)      !! T on the axes of the material, a Kelvin vector
      real(wp), intent(in) :: slope(6, 6)    !! its slope with e, symmetric [stress]
      real(wp) :: tangent(6, 6)
      real(wp) :: to_space(6, 6), principal(3, 3), scaled(6)
      integer :: k

      scaled = matmul(stress, self%to_own)
      principal = tensor_of(scaled)
      tangent = matmul(transpose(self%to_own), matmul(slope, self%to_own))
      do k = 1, 6
         tangent(:, k) = self%scale*tangent(:, k)*self%scale(k)
      end do
      call add_geometric(self, principal, tangent)
      to_space = kelvin_rotation(self%space%axis)
      tangent = matmul(to_space, matmul(tangent, transpose(to_space)))
      tangent(4:, :) = tangent(4:, :)/root_two
      tangent(:, 4:) = tangent(:, 4:)/root_two
   end function spatial_tangent

   !> What the turning of the principal directions and the change of the stretches add.
   pure subroutine add_geometric(self, stress, tangent)
      type(material_frame_type), intent(in) :: self
      real(wp), intent(in) :: stress(3, 3)   !! T on the principal directions
      real(wp), intent(inout) :: tangent(6, 6)
      integer, parameter :: at(3, 3) = reshape([1, 4, 5, 4, 2, 6, 5, 6, 3], [3, 3])
      real(wp) :: x(3), weight(6), second
      integer :: k, l, m, row

      x = 1.0_wp + self%space%change
      weight = [1.0_wp, 1.0_wp, 1.0_wp, root_two, root_two, root_two]
      do row = 1, 6
         k = first_axis(row)
         l = second_axis(row)
         do m = 1, 3
            second = 4.0_wp*sqrt(x(k)*x(l))*second_difference(x([k, l, m]))*sqrt(x(m))*weight(row)
            tangent(row, at(k, m)) = tangent(row, at(k, m)) &
               & + second*sqrt(x(k))/weight(at(k, m))*stress(m, l)
            tangent(row, at(l, m)) = tangent(row, at(l, m)) &
               & + second*sqrt(x(l))/weight(at(l, m))*stress(k, m)
         end do
      end do
   end subroutine add_geometric

   !> Second divided difference of ln(x)/2.
   pure real(wp) function second_difference(x) result(value)
      real(wp), intent(in) :: x(3)           !! > 0
      integer, parameter :: terms = 12
      real(wp) :: mean, u(3), h(3)
      integer :: i, j, low, high

      mean = sum(x)/3.0_wp
      u = x/mean - 1.0_wp
      if (maxval(abs(u)) > near_three) then
         low = minloc(x, dim=1)
         high = maxloc(x, dim=1)
         i = 6 - low - high
         value = (first_difference(x(high), x(i)) - first_difference(x(i), x(low))) &
            & /(x(high) - x(low))
         return
      end if
      ! Series at the mean, with complete homogeneous polynomials of u.
      value = 0.0_wp
      h = [1.0_wp, 1.0_wp, 1.0_wp]
      do j = 0, terms
         value = value + merge(-0.5_wp, 0.5_wp, mod(j, 2) == 0)*h(3)/(j + 2)
         h(1) = h(1)*u(1)
         h(2) = h(1) + u(2)*h(2)
         h(3) = h(2) + u(3)*h(3)
      end do
      value = value/mean**2
   end function second_difference

   !> First divided difference of ln(x)/2.
   pure real(wp) function first_difference(a, b) result(value)
      real(wp), intent(in) :: a, b           !! > 0
      real(wp) :: v, power
      integer :: k

      v = (a - b)/(a + b)
      if (abs(v) < 0.05_wp) then
         value = 1.0_wp
         power = 1.0_wp
         do k = 1, 7
            power = power*v**2
            value = value + power/(2*k + 1)
         end do
         value = value/(a + b)
      else
         value = 0.5_wp*log(a/b)/(a - b)
      end if
   end function first_difference

   !> The new inverse of Fp, - 1, once the strain of the frame has flowed by `flow`.
   pure function plastic_map(self, map, flow, axes) result(new)
      type(material_frame_type), intent(in) :: self
      real(wp), intent(in) :: map(3, 3)      !! before
      real(wp), intent(in) :: flow(6)        !! on the axes of the material, a Kelvin vector
      real(wp), intent(in) :: axes(3, 3)     !! rows: axes of the material
      real(wp) :: new(3, 3), trial(3, 3), strain(3, 3), back(3, 3), ahead(3, 3)
      type(log_frame_type) :: after
      real(wp) :: deviator(3)

      deviator = self%space%e - sum(self%space%e)/3.0_wp
      back = spectral(self%own, exp_minus_one(-deviator))
      trial = spectral(self%own, deviator)
      strain = trial - tensor_of(flow)
      call new_log_frame(after, strain)
      ahead = spectral(after%axis, exp_minus_one(after%change))
      new = matmul(transpose(axes), matmul(back + ahead + matmul(back, ahead), axes))
      new = map + new + matmul(map, new)
   end function plastic_map

   !> Tensor of principal values.
   pure function spectral(axis, value) result(tensor)
      real(wp), intent(in) :: axis(3, 3)     !! columns: principal directions
      real(wp), intent(in) :: value(3)
      real(wp) :: tensor(3, 3)
      integer :: k

      do k = 1, 3
         tensor(:, k) = axis(:, 1)*(value(1)*axis(k, 1)) + axis(:, 2)*(value(2)*axis(k, 2)) &
            & + axis(:, 3)*(value(3)*axis(k, 3))
      end do
   end function spectral
end module lopin_material_frame
