!> Criteria of ductile damage: D = integral of f(stress) over the accumulated plastic strain.
!>
!> They only count: nothing in the flow depends on them. With s1 the largest principal stress, sm
!> the mean stress and q that of von Mises,
!>
!>     COCKCROFT-LATHAM  f = <s1>/q                          (1968, normalised by Oh et al., 1979)
!>     OYANE             f = <1 + A sm/q>                    (1972; that of sm/q + 1/A is D/A)
!>     RICE-TRACEY       f = exp(c sm/q), c = 1.5            (1969; growth of a void is .283 D)
!>     LEMAITRE          f = 2/3 (1 + nu) + 3 (1 - 2 nu) (sm/q)^2, 0 where sm/q <= -1/3 (1985)
!>
!> f depends on ratios of stresses alone, so that Cauchy's and Kirchhoff's stress give the same.
module lopin_damage_criteria
   use lopin_kinds, only : wp
   use lopin_von_mises, only : von_mises
   implicit none
   private
   public :: damage_type, damage_names, damage_kind, damage_rate, largest_principal

   !> One row of a material's *DAMAGE.
   type :: damage_type
      integer :: kind = 0                  !! place in `damage_names`
      real(wp) :: coefficient = 0.0_wp     !! OYANE: A; RICE-TRACEY: c [-]
      real(wp) :: width = 0.0_wp           !! means are taken over it; 0: none [length]
      real(wp) :: critical = 0.0_wp        !! metal separates there; 0: never [-]
   end type damage_type

   character(len=16), parameter :: damage_names(4) = [character(len=16) :: 'COCKCROFT-LATHAM', &
      & 'OYANE', 'RICE-TRACEY', 'LEMAITRE']

contains

   !> Place of a name; 0 if it is none.
   pure integer function damage_kind(name)
      character(len=*), intent(in) :: name
      do damage_kind = size(damage_names), 1, -1
         if (damage_names(damage_kind) == name) return
      end do
   end function damage_kind

   !> f of a criterion [-]; -1 without stress, where it has no value.
   pure real(wp) function damage_rate(criterion, poisson, stress) result(f)
      type(damage_type), intent(in) :: criterion
      real(wp), intent(in) :: poisson      !! [-]
      real(wp), intent(in) :: stress(6)    !! xx yy zz xy xz yz [stress]
      real(wp) :: q, ratio

      f = -1.0_wp
      q = von_mises(stress)
      if (.not. q > epsilon(q)*maxval(abs(stress))) return
      ratio = sum(stress(:3))/(3.0_wp*q)
      select case (criterion%kind)
      case (1)
         f = max(0.0_wp, largest_principal(stress)/q)
      case (2)
         f = max(0.0_wp, 1.0_wp + criterion%coefficient*ratio)
      case (3)
         f = exp(criterion%coefficient*ratio)
      case (4)
         f = 2.0_wp/3.0_wp*(1.0_wp + poisson) + 3.0_wp*(1.0_wp - 2.0_wp*poisson)*ratio**2
         ! A bar in compression lies on the limit: rounding does not decide.
         if (ratio <= -(1.0_wp - 1.0e-6_wp)/3.0_wp) f = 0.0_wp
      end select
   end function damage_rate

   !> The largest principal value of a symmetric tensor (Cardano's formula by the angle of Lode).
   pure real(wp) function largest_principal(s) result(value)
      real(wp), intent(in) :: s(6)         !! xx yy zz xy xz yz
      real(wp) :: d(3), q, j3, cosine, mean

      mean = sum(s(:3))/3.0_wp
      q = von_mises(s)
      value = mean
      if (.not. q > 0.0_wp) return
      d = (s(:3) - mean)/q
      associate (t => s(4:6)/q)
         j3 = d(1)*(d(2)*d(3) - t(3)**2) - t(1)*(t(1)*d(3) - t(3)*t(2)) &
            & + t(2)*(t(1)*t(3) - d(2)*t(2))
      end associate
      cosine = min(1.0_wp, max(-1.0_wp, 13.5_wp*j3))
      value = mean + 2.0_wp/3.0_wp*q*cos(acos(cosine)/3.0_wp)
   end function largest_principal
end module lopin_damage_criteria
