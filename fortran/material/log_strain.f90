!> Logarithmic strains of a finite deformation, and the frame in which isotropic laws are written.
!>
!> The left Cauchy-Green tensor b = F F^T has the eigenvalues exp(2 e_k), e_k the logarithmic
!> (Hencky) strains along the principal directions of the deformed solid. A law needs to say only
!> its principal Kirchhoff stresses t_k, their slopes dt_k/de_l, and the secants
!> (t_k - t_l)/(e_k - e_l), which stay regular where strains coalesce; the stress and the spatial
!> tangent follow (Simo 1992, with the quotient of the shear terms written as d coth d, d = e_k -
!> e_l, whose series takes over for small d). A radial return in logarithmic strains fits in the
!> same frame.
!>
!> Stress order xx yy zz xy xz yz, engineering shears; in 2D the first four.
module lopin_log_strain
   use lopin_kinds, only : wp
   implicit none
   private
   public :: log_frame_type, new_log_frame, frame_stress, frame_tangent, frame_strain
   public :: log_one_plus, exp_minus_one

   !> Components of the stress order.
   integer, parameter, public :: first_axis(6) = [1, 2, 3, 1, 1, 2], &
      & second_axis(6) = [1, 2, 3, 2, 3, 3]

   type :: log_frame_type
      real(wp) :: axis(3, 3) = 0.0_wp   !! columns: principal directions
      real(wp) :: e(3) = 0.0_wp         !! logarithmic strain along each
   end type log_frame_type

   !> Difference of logarithmic strains below which the series of d coth d is taken; its error there
   !> is 2 d**6/945 < 1e-17.
   real(wp), parameter :: series_below = 4.0e-3_wp

contains

   !> Principal directions and logarithmic strains; directions decoupled from the others stay in
   !> place, so that in 2D the third one is z.
   pure subroutine new_log_frame(self, change)
      type(log_frame_type), intent(out) :: self
      real(wp), intent(in) :: change(3, 3)   !! b - 1: small strains keep all their digits
      real(wp) :: a(3, 3)
      integer, parameter :: most_sweeps = 20
      integer :: sweep, k

      a = change
      self%axis = 0.0_wp
      do k = 1, 3
         self%axis(k, k) = 1.0_wp
      end do
      do sweep = 1, most_sweeps
         if (.not. abs(a(1, 2)) + abs(a(1, 3)) + abs(a(2, 3)) &
            & > 0.01_wp*epsilon(1.0_wp)*(abs(a(1, 1)) + abs(a(2, 2)) + abs(a(3, 3)))) exit
         call rotate(a, self%axis, 1, 2)
         call rotate(a, self%axis, 1, 3)
         call rotate(a, self%axis, 2, 3)
      end do
      do k = 1, 3
         self%e(k) = 0.5_wp*log_one_plus(a(k, k))
      end do
   end subroutine new_log_frame

   !> One rotation of Jacobi that makes a(p, q) zero.
   pure subroutine rotate(a, v, p, q)
      real(wp), intent(inout) :: a(3, 3), v(3, 3)
      integer, intent(in) :: p, q
      real(wp) :: t, c, s, ratio, old(3)
      integer :: r

      if (.not. abs(a(p, q)) > 0.0_wp) return
      ratio = 0.5_wp*(a(q, q) - a(p, p))/a(p, q)
      t = sign(1.0_wp, ratio)/(abs(ratio) + hypot(1.0_wp, ratio))
      c = 1.0_wp/sqrt(1.0_wp + t*t)
      s = t*c
      a(p, p) = a(p, p) - t*a(p, q)
      a(q, q) = a(q, q) + t*a(p, q)
      a(p, q) = 0.0_wp
      a(q, p) = 0.0_wp
      r = 6 - p - q
      old(:2) = [a(r, p), a(r, q)]
      a(r, p) = c*old(1) - s*old(2)
      a(r, q) = s*old(1) + c*old(2)
      a(p, r) = a(r, p)
      a(q, r) = a(r, q)
      old = v(:, p)
      v(:, p) = c*old - s*v(:, q)
      v(:, q) = s*old + c*v(:, q)
   end subroutine rotate

   !> Columns: components of n_k n_k, and of n_k n_l + n_l n_k for the pairs 12, 13, 23.
   pure function frame_map(self, m) result(map)
      type(log_frame_type), intent(in) :: self
      integer, intent(in) :: m               !! 4 or 6
      real(wp) :: map(m, m)
      integer :: r, k, i, j

      do k = 1, m
         do r = 1, m
            i = first_axis(r)
            j = second_axis(r)
            map(r, k) = self%axis(i, first_axis(k))*self%axis(j, second_axis(k))
            if (k > 3) map(r, k) = map(r, k) &
               & + self%axis(i, second_axis(k))*self%axis(j, first_axis(k))
         end do
      end do
   end function frame_map

   !> Tensor of given principal values.
   pure function frame_stress(self, principal, m) result(stress)
      type(log_frame_type), intent(in) :: self
      real(wp), intent(in) :: principal(3)
      integer, intent(in) :: m
      real(wp) :: stress(m)
      integer :: r, k

      do r = 1, m
         stress(r) = 0.0_wp
         do k = 1, 3
            stress(r) = stress(r) &
               & + principal(k)*self%axis(first_axis(r), k)*self%axis(second_axis(r), k)
         end do
      end do
   end function frame_stress

   !> Tensor of given principal strains, with engineering shears.
   pure function frame_strain(self, principal) result(strain)
      type(log_frame_type), intent(in) :: self
      real(wp), intent(in) :: principal(3)
      real(wp) :: strain(6)
      strain = frame_stress(self, principal, 6)
      strain(4:) = 2.0_wp*strain(4:)
   end function frame_strain

   !> Spatial tangent: the Lie rate of the Kirchhoff stress per rate of deformation.
   pure subroutine frame_tangent(self, principal, slope, secant, tangent)
      type(log_frame_type), intent(in) :: self
      real(wp), intent(in) :: principal(3)      !! Kirchhoff stresses t_k [stress]
      real(wp), intent(in) :: slope(3, 3)       !! dt_k/de_l, symmetric [stress]
      real(wp), intent(in) :: secant(3)         !! (t_k - t_l)/(e_k - e_l): 12, 13, 23 [stress]
      real(wp), intent(out) :: tangent(:, :)    !! (4, 4) or (6, 6) [stress]
      real(wp) :: map(size(tangent, 1), size(tangent, 1)), part(size(tangent, 1), size(tangent, 1))
      real(wp) :: normal(3, 3), shear
      integer :: k, l, m

      m = size(tangent, 1)
      map = frame_map(self, m)
      normal = slope
      do k = 1, 3
         normal(k, k) = normal(k, k) - 2.0_wp*principal(k)
      end do
      part(:, :3) = matmul(map(:, :3), normal)
      do k = 4, m
         l = k - 3
         shear = 0.5_wp*(secant(l)*d_coth_d(self%e(first_axis(k)) - self%e(second_axis(k))) &
            & - principal(first_axis(k)) - principal(second_axis(k)))
         part(:, k) = shear*map(:, k)
      end do
      tangent = matmul(part, transpose(map))
   end subroutine frame_tangent

   !> d coth d: 1 at d = 0.
   pure real(wp) function d_coth_d(d) result(y)
      real(wp), intent(in) :: d

      if (abs(d) < series_below) then
         y = 1.0_wp + d**2/3.0_wp - d**4/45.0_wp
      else
         y = d/tanh(d)
      end if
   end function d_coth_d

   !> log(1 + x) with all digits also for small x > -1 (Goldberg 1991, theorem 4).
   elemental real(wp) function log_one_plus(x) result(y)
      real(wp), intent(in) :: x
      real(wp) :: one

      one = 1.0_wp + x
      y = x
      if (abs(one - 1.0_wp) > 0.0_wp) y = x*(log(one)/(one - 1.0_wp))
   end function log_one_plus

   !> exp(x) - 1 with all digits also for small x (Kahan).
   elemental real(wp) function exp_minus_one(x) result(y)
      real(wp), intent(in) :: x
      real(wp) :: power

      power = exp(x)
      y = power - 1.0_wp
      if (abs(x) > 0.5_wp) return
      if (abs(y) > 0.0_wp) then
         y = y*(x/log(power))
      else
         y = x
      end if
   end function exp_minus_one
end module lopin_log_strain
