!> Where Coulomb's law has several answers: wedging.
!>
!> A point whose motion along the face presses it on more than friction lets go has several
!> equilibria: with its own compliance S, unique for mu < S_nn/|S_nt| = K_tt/|K_nt| (Klarbring, Ing.
!> Archiv 60, 1990). All points together: the tangent of the slipping set turns its orientation.
module lopin_friction_limits
   use lopin_kinds, only : wp
   use lopin_friction, only : whole_bound
   use lopin_friction_rows, only : friction_points_type
   implicit none
   private
   public :: find_wedging

   !> Pressing motion below this share of the diagonal is rounding.
   real(wp), parameter :: no_coupling = 1.0e-12_wp

contains

   !> The point whose friction exceeds its critical coefficient by most; 0: none.
   subroutine find_wedging(s, points, status, worst, coefficient, critical)
      real(wp), intent(in) :: s(:, :)              !! (nrow, nrow) compliance [length/force]
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: status(:)             !! (npoint) 0 open: looked at if all are
      integer, intent(out) :: worst
      real(wp), intent(out) :: coefficient, critical   !! of that point [-]
      real(wp) :: radius, slope, limit, coupling, most
      integer :: k

      worst = 0
      coefficient = 0.0_wp
      critical = huge(1.0_wp)
      most = 1.0_wp
      do k = 1, points%n
         if (status(k) == 0 .and. any(status > 0)) cycle
         if (points%law(k)%rough) cycle
         call whole_bound(points%law(k), tiny(1.0_wp), points%at(k), radius, slope)
         if (.not. slope > 0.0_wp) cycle
         associate (n => points%normal(k), from => points%tangent(k))
            coupling = norm2(s(from:from + points%nt - 1, n))
            if (.not. coupling > no_coupling*s(n, n)) cycle
            limit = s(n, n)/coupling
         end associate
         if (slope/limit <= most) cycle
         most = slope/limit
         worst = k
         coefficient = slope
         critical = limit
      end do
   end subroutine find_wedging
end module lopin_friction_limits
