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
   public :: mapped_tensor, log_one_plus, exp_minus_one

   !> Components of the stress order.
   integer, parameter, public :: first_axis(6) = [1, 2, 3, 1, 1, 2], &
      & second_axis(6) = [1, 2, 3, 2, 3, 3]

   type :: log_frame_type
      real(wp) :: axis(3, 3)            !! columns: principal directions
      real(wp) :: change(3)             !! b - 1 along each
      real(wp) :: e(3)                  !! logarithmic strain along each
   end type log_frame_type

   !> Difference of logarithmic strains below which the series of d coth d is taken; its error there
   !> is 2 d**6/945 < 1e-17.
   real(wp), parameter, public :: series_below = 4.0e-3_wp

contains

   !> Principal directions and logarithmic strains; directions decoupled from the others stay in
   !> place, so that in 2D the third one is z.
   pure subroutine new_log_frame(self, change)
      type(log_frame_type), intent(out) :: self
      real(wp), intent(in) :: change(3, 3)   !! b - 1: small strains keep all their digits
      real(wp) :: a(3, 3), c, s, move
      integer, parameter :: most_sweeps = 20
      integer :: sweep, k

      self%axis = 0.0_wp
      do k = 1, 3
         self%axis(k, k) = 1.0_wp
      end do
      if (abs(change(1, 3)) + abs(change(2, 3)) > 0.0_wp) then
         a = change
         do sweep = 1, most_sweeps
            if (.not. abs(a(1, 2)) + abs(a(1, 3)) + abs(a(2, 3)) &
               & > 0.01_wp*epsilon(1.0_wp)*(abs(a(1, 1)) + abs(a(2, 2)) + abs(a(3, 3)))) exit
            call rotate(a, self%axis, 1, 2)
            call rotate(a, self%axis, 1, 3)
            call rotate(a, self%axis, 2, 3)
         end do
         self%change = [a(1, 1), a(2, 2), a(3, 3)]
      else
         self%change = [change(1, 1), change(2, 2), change(3, 3)]
         call turn(0.5_wp*(change(2, 2) - change(1, 1)), change(1, 2), c, s, move)
         self%axis(:2, 1) = [c, -s]
         self%axis(:2, 2) = [s, c]
         self%change(:2) = self%change(:2) + [-move, move]
      end if
      do k = 1, 3
         self%e(k) = 0.5_wp*log_one_plus(self%change(k))
      end do
   end subroutine new_log_frame

   !> One rotation of Jacobi that makes a(p, q) zero.
   pure subroutine rotate(a, v, p, q)
      real(wp), intent(inout) :: a(3, 3), v(3, 3)
      integer, intent(in) :: p, q
      real(wp) :: c, s, move, old
      integer :: i, r

      call turn(0.5_wp*(a(q, q) - a(p, p)), a(p, q), c, s, move)
      a(p, p) = a(p, p) - move
      a(q, q) = a(q, q) + move
      a(p, q) = 0.0_wp
      a(q, p) = 0.0_wp
      r = 6 - p - q
      old = a(r, p)
      a(r, p) = c*old - s*a(r, q)
      a(r, q) = s*old + c*a(r, q)
      a(p, r) = a(r, p)
      a(q, r) = a(r, q)
      do i = 1, 3
         old = v(i, p)
         v(i, p) = c*old - s*v(i, q)
         v(i, q) = s*old + c*v(i, q)
      end do
   end subroutine rotate

   !> Rotation of two axes to the principal ones of a symmetric tensor in their plane: (c, -s) and
   !> (s, c), and how far the normal components move apart.
   pure subroutine turn(half, shear, c, s, move)
      real(wp), intent(in) :: half             !! of the second normal component less the first
      real(wp), intent(in) :: shear
      real(wp), intent(out) :: c, s, move
      real(wp) :: radius, t

      c = 1.0_wp
      s = 0.0_wp
      move = 0.0_wp
      radius = sqrt(half**2 + shear**2)
      if (.not. (abs(shear) > 0.0_wp .and. radius > 0.0_wp)) return
      t = shear/(half + sign(radius, half))
      c = 1.0_wp/sqrt(1.0_wp + t*t)
      s = t*c
      move = t*shear
   end subroutine turn

   !> Tensor of given principal values.
   pure function frame_stress(self, principal, m) result(stress)
      type(log_frame_type), intent(in) :: self
      real(wp), intent(in) :: principal(3)
      integer, intent(in) :: m               !! 4 or 6
      real(wp) :: stress(m)
      real(wp) :: half(3, 3)
      integer :: k

      do k = 1, 3
         half(:, k) = principal(k)*self%axis(:, k)
      end do
      associate (n => self%axis)
         stress(1) = half(1, 1)*n(1, 1) + half(1, 2)*n(1, 2) + half(1, 3)*n(1, 3)
         stress(2) = half(2, 1)*n(2, 1) + half(2, 2)*n(2, 2) + half(2, 3)*n(2, 3)
         stress(3) = half(3, 1)*n(3, 1) + half(3, 2)*n(3, 2) + half(3, 3)*n(3, 3)
         stress(4) = half(1, 1)*n(2, 1) + half(1, 2)*n(2, 2) + half(1, 3)*n(2, 3)
         if (m == 4) return
         stress(5) = half(1, 1)*n(3, 1) + half(1, 2)*n(3, 2) + half(1, 3)*n(3, 3)
         stress(6) = half(2, 1)*n(3, 1) + half(2, 2)*n(3, 2) + half(2, 3)*n(3, 3)
      end associate
   end function frame_stress

   !> A t A^T of a tensor t of given principal values, in the order of stress.
   pure function mapped_tensor(self, principal, a, m) result(tensor)
      type(log_frame_type), intent(in) :: self
      real(wp), intent(in) :: principal(3), a(3, 3)
      integer, intent(in) :: m               !! 4 or 6
      real(wp) :: tensor(m), n(3)
      integer :: k

      tensor = 0.0_wp
      do k = 1, 3
         n = a(:, 1)*self%axis(1, k) + a(:, 2)*self%axis(2, k) + a(:, 3)*self%axis(3, k)
         tensor = tensor + principal(k)*n(first_axis(:m))*n(second_axis(:m))
      end do
   end function mapped_tensor

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
      real(wp), contiguous, intent(out) :: tangent(:, :)    !! (4, 4) or (6, 6) [stress]
      real(wp) :: normal(3, 3), shear(3)
      integer :: k

      normal = slope
      do k = 1, 3
         normal(k, k) = normal(k, k) - 2.0_wp*principal(k)
      end do
      do k = 1, merge(1, 3, size(tangent, 1) == 4)
         shear(k) = 0.5_wp*(secant(k)*d_coth_d(self, first_axis(k + 3), second_axis(k + 3)) &
            & - principal(first_axis(k + 3)) - principal(second_axis(k + 3)))
      end do
      if (size(tangent, 1) == 4) then
         call turn_in_plane(self%axis(1, 1), self%axis(2, 1), normal, shear(1), tangent)
      else
         call turn_in_space(self%axis, normal, shear, tangent)
      end if
   end subroutine frame_tangent

   !> Tangent of principal axes (c, s), (-s, c) and z, in x, y and z.
   pure subroutine turn_in_plane(c, s, normal, shear, tangent)
      real(wp), intent(in) :: c, s              !! cosine and sine
      real(wp), intent(in) :: normal(3, 3)      !! on the principal directions, symmetric [stress]
      real(wp), intent(in) :: shear             !! on n1 n2 + n2 n1 [stress]
      real(wp), intent(out) :: tangent(4, 4)    !! xx yy zz xy [stress]
      real(wp) :: one(4), two(4), mixed(4), first(4), second(4), third(4)
      integer :: k

      one = [c*c, s*s, 0.0_wp, c*s]
      two = [s*s, c*c, 0.0_wp, -c*s]
      mixed = [-2.0_wp*c*s, 2.0_wp*c*s, 0.0_wp, c*c - s*s]
      first = normal(1, 1)*one + normal(2, 1)*two
      second = normal(1, 2)*one + normal(2, 2)*two
      third = normal(1, 3)*one + normal(2, 3)*two
      do k = 1, 4
         tangent(:, k) = one(k)*first + two(k)*second + (shear*mixed(k))*mixed
      end do
      tangent(:, 3) = third
      tangent(3, :) = third
      tangent(3, 3) = normal(3, 3)
   end subroutine turn_in_plane

   !> Tangent of any principal axes, in x, y and z.
   pure subroutine turn_in_space(axis, normal, shear, tangent)
      real(wp), intent(in) :: axis(3, 3)        !! columns: principal directions
      real(wp), intent(in) :: normal(3, 3)      !! on them, symmetric [stress]
      real(wp), intent(in) :: shear(3)          !! on n_k n_l + n_l n_k: 12, 13, 23 [stress]
      real(wp), intent(out) :: tangent(6, 6)    !! [stress]
      real(wp) :: map(6, 6), part(6, 6)
      integer :: i, k

      do k = 1, 6
         map(:, k) = axis(first_axis, first_axis(k))*axis(second_axis, second_axis(k))
         if (k > 3) map(:, k) = map(:, k) &
            & + axis(first_axis, second_axis(k))*axis(second_axis, first_axis(k))
      end do
      do k = 1, 3
         part(:, k) = normal(1, k)*map(:, 1) + normal(2, k)*map(:, 2) + normal(3, k)*map(:, 3)
         part(:, k + 3) = shear(k)*map(:, k + 3)
      end do
      do k = 1, 6
         tangent(:, k) = part(:, 1)*map(k, 1)
         do i = 2, 6
            tangent(:, k) = tangent(:, k) + part(:, i)*map(k, i)
         end do
      end do
   end subroutine turn_in_space

   !> d coth d of the difference of two logarithmic strains: 1 at d = 0. The hyperbolic tangent of d
   !> is a quotient of the principal values of b.
   pure real(wp) function d_coth_d(self, k, l) result(y)
      type(log_frame_type), intent(in) :: self
      integer, intent(in) :: k, l
      real(wp) :: d

      d = self%e(k) - self%e(l)
      if (abs(d) < series_below) then
         y = 1.0_wp + d**2/3.0_wp - d**4/45.0_wp
      else
         y = d*(2.0_wp + self%change(k) + self%change(l))/(self%change(k) - self%change(l))
      end if
   end function d_coth_d

   !> log(1 + x) with all digits also for small x > -1 (Goldberg 1991, theorem 4); large and
   !> negative for x <= -1, of a folded trial.
   elemental real(wp) function log_one_plus(x) result(y)
      real(wp), intent(in) :: x
      real(wp) :: one

      one = 1.0_wp + x
      y = x
      if (abs(one - 1.0_wp) > 0.0_wp) y = x*(log(max(one, tiny(1.0_wp)))/(one - 1.0_wp))
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
