!> Hourglass control of bricks of one integration point: stiffness of the modes that the point does
!> not see.
!>
!> With shape vectors h = (eta zeta, xi zeta, xi eta, xi eta zeta) at the corners and b the mean of
!> grad N, gamma = (h - (h.x) b)/8 sees no motion that is linear in place (Flanagan and
!> Belytschko 1981), and q = sum gamma u is the amplitude of h in the displacements. The energy is
!>
!>    W = 1/2 s.K s,  s = F^T q,  K = E H + G tr(H) n n^T,  H = integral of grad h (grad h)^T
!>
!> F is the mean deformation gradient (1 at small strain): s is the linear part of Green's
!> strain, so no rotation stores energy. E H lets a box of any proportions bend as a beam does,
!> where full integration locks in shear; n is normal to both slopes of h, in which it warps.
!> Force and tangent are the exact derivatives. There is no memory: the energy is a function of
!> place, of the elastic moduli also where the material flows.
module lopin_hourglass
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross, inverse_of
   use lopin_element_type, only : element_type, element_formulation
   use lopin_gradients, only : all_gradients
   implicit none
   private
   public :: add_hourglass, stiffen_hourglass

   integer, parameter :: nmode = 4

   !> Shape vectors and stiffness of an element in its reference place.
   type :: modes_type
      real(wp) :: gamma(8, nmode) = 0.0_wp       !! [-]
      real(wp) :: k(3, 3, nmode) = 0.0_wp        !! [force/length]
      real(wp) :: b(3, 8) = 0.0_wp               !! mean of grad N [1/length]
   end type modes_type

contains

   !> Adds force, energy and, if asked for, stiffness of hourglass motions; nothing to elements
   !> whose points see all motions.
   pure subroutine add_hourglass(element, moduli, x, u, finite, force, energy, ke)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: moduli(2)          !! Young's [stress], Poisson's ratio [-]
      real(wp), intent(in) :: x(element%ndim, element%nnode)   !! reference, unfolded [length]
      real(wp), intent(in) :: u(element%ndim, element%nnode)   !! displacements [length]
      logical, intent(in) :: finite              !! geometry of large motions
      real(wp), intent(inout) :: force(element%ndim, element%nnode)          !! [force]
      real(wp), intent(inout) :: energy          !! [force length]
      real(wp), intent(inout), optional :: ke(element%ndof, element%ndof)    !! [force/length]
      type(modes_type) :: modes
      real(wp) :: f(3, 3), q(3), t(3), d(3, 3, 8), dk(3, 3), part(3, 3), tb(8)
      integer :: m, a, c, i

      if (element%formulation /= element_formulation%centre) return
      call find_modes(element, moduli(1), moduli(2), x, modes)
      f = 0.0_wp
      do i = 1, 3
         f(i, i) = 1.0_wp
      end do
      if (finite) f = f + matmul(u, transpose(modes%b))
      do m = 1, nmode
         q = matmul(u, modes%gamma(:, m))
         t = matmul(modes%k(:, :, m), matmul(q, f))
         energy = energy + 0.5_wp*dot_product(matmul(q, f), t)
         ! d s = sum over the nodes of (gamma F + q b^T)^T du
         do a = 1, 8
            d(:, :, a) = modes%gamma(a, m)*f
            if (finite) then
               do i = 1, 3
                  d(:, i, a) = d(:, i, a) + q*modes%b(i, a)
               end do
            end if
            force(:, a) = force(:, a) + matmul(d(:, :, a), t)
         end do
         if (.not. present(ke)) cycle
         tb = 0.0_wp
         if (finite) tb = matmul(t, modes%b)
         do c = 1, 8
            dk = matmul(modes%k(:, :, m), transpose(d(:, :, c)))
            do a = c, 8
               part = matmul(d(:, :, a), dk)
               do i = 1, 3
                  part(i, i) = part(i, i) + (modes%gamma(a, m)*tb(c) + modes%gamma(c, m)*tb(a))
               end do
               if (a == c) part = 0.5_wp*(part + transpose(part))
               ke(3*a - 2:3*a, 3*c - 2:3*c) = ke(3*a - 2:3*a, 3*c - 2:3*c) + part
               if (a > c) ke(3*c - 2:3*c, 3*a - 2:3*a) = ke(3*c - 2:3*c, 3*a - 2:3*a) &
                  & + transpose(part)
            end do
         end do
      end do
   end subroutine add_hourglass

   !> Adds the stiffness of hourglass motions at small strain.
   pure subroutine stiffen_hourglass(element, d, x, ke)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: d(:, :)            !! Hooke's matrix of an isotropic solid [stress]
      real(wp), intent(in) :: x(:, :)            !! (ndim, nnode) [length]
      real(wp), intent(inout) :: ke(element%ndof, element%ndof)   !! [force/length]
      real(wp) :: force(element%ndim, element%nnode), energy

      if (element%formulation /= element_formulation%centre) return
      force = 0.0_wp
      energy = 0.0_wp
      associate (lame => d(2, 1), shear => d(4, 4))
         call add_hourglass(element, [shear*(3.0_wp*lame + 2.0_wp*shear)/(lame + shear), &
            & 0.5_wp*lame/(lame + shear)], x, 0.0_wp*force, .false., force, energy, ke)
      end associate
   end subroutine stiffen_hourglass

   pure subroutine find_modes(element, young, poisson, x, modes)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: young, poisson, x(3, 8)
      type(modes_type), intent(out) :: modes
      real(wp) :: slope(3, 3), h(8, nmode), g(3, 8, 1), volume(1), n(3), shear
      integer :: m, i, j, bad

      slope = matmul(x, transpose(element%dn(:, :, 1)))
      call all_gradients(element, x, g, volume, bad)
      modes%b = g(:, :, 1)
      do m = 1, 3
         slope(m, m) = slope(m, m) - 1.0_wp
      end do
      slope = transpose(inverse_of(slope))       ! columns: gradients of xi, eta, zeta
      associate (xi => element%cell%xi)
         h(:, 1) = xi(2, :8)*xi(3, :8)
         h(:, 2) = xi(1, :8)*xi(3, :8)
         h(:, 3) = xi(1, :8)*xi(2, :8)
         h(:, 4) = xi(1, :8)*h(:, 1)
      end associate
      shear = young/(2.0_wp*(1.0_wp + poisson))
      do m = 1, nmode
         modes%gamma(:, m) = (h(:, m) - matmul(matmul(x, h(:, m)), modes%b))/8.0_wp
         do i = 1, 3
            if (i == m) cycle
            do j = 1, 3
               modes%k(:, j, m) = modes%k(:, j, m) + slope(:, i)*slope(j, i)
            end do
         end do
         modes%k(:, :, m) = volume(1)/merge(9.0_wp, 3.0_wp, m == 4)*modes%k(:, :, m)
         if (m < 4) then
            n = cross(slope(:, 1 + mod(m, 3)), slope(:, 1 + mod(m + 1, 3)))
            n = n/norm2(n)
            associate (trace => modes%k(1, 1, m) + modes%k(2, 2, m) + modes%k(3, 3, m))
               modes%k(:, :, m) = young*modes%k(:, :, m) &
                  & + shear*trace*spread(n, 2, 3)*spread(n, 1, 3)
            end associate
         else
            modes%k(:, :, m) = young*modes%k(:, :, m)
         end if
      end do
   end subroutine find_modes
end module lopin_hourglass
