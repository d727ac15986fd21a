!> The equivalent stress of von Mises.
module lopin_von_mises
   use lopin_kinds, only : wp
   implicit none
   private
   public :: von_mises, von_mises_slope

contains

   !> sqrt(3 J2): the stress of a uniaxial test with the same distortion.
   pure real(wp) function von_mises(s) result(q)
      real(wp), intent(in) :: s(6)   !! xx yy zz and three shears [stress]

      q = sqrt(0.5_wp*((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2) &
         & + 3.0_wp*sum(s(4:6)**2))
   end function von_mises

   !> Its slopes in the six; none where it has none.
   pure function von_mises_slope(s) result(slope)
      real(wp), intent(in) :: s(6)   !! [stress]
      real(wp) :: slope(6), q

      slope = 0.0_wp
      q = von_mises(s)
      if (.not. q > 0.0_wp) return
      slope(:3) = (1.5_wp*s(:3) - 0.5_wp*sum(s(:3)))/q
      slope(4:) = 3.0_wp*s(4:)/q
   end function von_mises_slope
end module lopin_von_mises
