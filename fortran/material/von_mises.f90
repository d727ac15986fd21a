!> The equivalent stress of von Mises.
module lopin_von_mises
   use lopin_kinds, only : wp
   implicit none
   private
   public :: von_mises

contains

   !> sqrt(3 J2): the stress of a uniaxial test with the same distortion.
   pure real(wp) function von_mises(s) result(q)
      real(wp), intent(in) :: s(6)   !! xx yy zz and three shears [stress]

      q = sqrt(0.5_wp*((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2) &
         & + 3.0_wp*sum(s(4:6)**2))
   end function von_mises
end module lopin_von_mises
