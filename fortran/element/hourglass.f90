!> Hourglass control of elements of few integration points: stiffness of the modes that the points
!> do not see. Today's are bricks of one point (`find_modes`).
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
!>
!> To add an element: `hourglass` in `set_formulation` of element_type, and its modes in
!> `find_modes`; the rest holds for the plane and for space.
module lopin_hourglass
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross, inverse_of
   use lopin_element_type, only : element_type, element_kind
   use lopin_gradients, only : all_gradients
   implicit none
   private
   public :: add_hourglass, stiffen_hourglass, moduli_type

   integer, parameter :: most = 4                !! modes of an element

   !> What holds the motions: the elastic solid.
   type :: moduli_type
      real(wp) :: young = 0.0_wp                 !! [stress]
      real(wp) :: poisson = 0.0_wp               !! [-]
      real(wp) :: thickness = 1.0_wp             !! of plane kinds [length]
   end type moduli_type

   !> Shape vectors and stiffness of an element in its reference place.
   type :: modes_type
      integer :: n = 0                           !! how many
      real(wp) :: gamma(8, most) = 0.0_wp        !! (node, mode) [-]
      real(wp) :: k(3, 3, most) = 0.0_wp         !! [force/length]
      real(wp) :: b(3, 8) = 0.0_wp               !! mean of grad N [1/length]
   end type modes_type

contains

   !> Adds force, energy and, if asked for, stiffness of hourglass motions.
   pure subroutine add_hourglass(element, moduli, x, u, finite, force, energy, ke)
      type(element_type), intent(in) :: element
      type(moduli_type), intent(in) :: moduli
      real(wp), intent(in) :: x(element%ndim, element%nnode)   !! reference, unfolded [length]
      real(wp), intent(in) :: u(element%ndim, element%nnode)   !! displacements [length]
      logical, intent(in) :: finite              !! geometry of large motions
      real(wp), intent(inout) :: force(element%ndim, element%nnode)          !! [force]
      real(wp), intent(inout) :: energy          !! [force length]
      real(wp), intent(inout), optional :: ke(element%ndof, element%ndof)    !! [force/length]
      type(modes_type) :: modes
      real(wp) :: f(element%ndim, element%ndim), q(element%ndim), t(element%ndim)
      real(wp) :: d(element%ndim, element%ndim, element%nnode)
      real(wp) :: k(element%ndim, element%ndim), gamma(element%nnode), tb(element%nnode)
      real(wp) :: b(element%ndim, element%nnode)
      integer :: m, a, i

      call find_modes(element, moduli, x, modes)
      b = 0.0_wp
      if (finite) b = modes%b(:element%ndim, :element%nnode)
      f = matmul(u, transpose(b))
      do i = 1, element%ndim
         f(i, i) = f(i, i) + 1.0_wp
      end do
      do m = 1, modes%n
         gamma = modes%gamma(:element%nnode, m)
         k = modes%k(:element%ndim, :element%ndim, m)
         q = matmul(u, gamma)
         t = matmul(k, matmul(q, f))
         energy = energy + 0.5_wp*dot_product(matmul(q, f), t)
         ! d s = sum over the nodes of (gamma F + q b^T)^T du
         do a = 1, element%nnode
            d(:, :, a) = gamma(a)*f
            do i = 1, element%ndim
               d(:, i, a) = d(:, i, a) + q*b(i, a)
            end do
            force(:, a) = force(:, a) + matmul(d(:, :, a), t)
         end do
         tb = matmul(t, b)
         if (present(ke)) call add_stiffness(element%ndim, element%nnode, gamma, k, d, tb, ke)
      end do
   end subroutine add_hourglass

   !> Second derivative of the energy of a mode.
   pure subroutine add_stiffness(n, nnode, gamma, k, d, tb, ke)
      integer, intent(in) :: n, nnode            !! components and nodes of the element
      real(wp), intent(in) :: gamma(nnode)       !! shape vector [-]
      real(wp), intent(in) :: k(n, n)            !! [force/length]
      real(wp), intent(in) :: d(n, n, nnode)     !! slope of the amplitude in the nodes [-]
      real(wp), intent(in) :: tb(nnode)          !! force along grad N, 0 at small strain
      real(wp), intent(inout) :: ke(n*nnode, n*nnode)   !! [force/length]
      real(wp) :: dk(n, n), part(n, n)
      integer :: a, c, i

      do c = 1, nnode
         dk = matmul(k, transpose(d(:, :, c)))
         do a = c, nnode
            part = matmul(d(:, :, a), dk)
            do i = 1, n
               part(i, i) = part(i, i) + (gamma(a)*tb(c) + gamma(c)*tb(a))
            end do
            if (a == c) part = 0.5_wp*(part + transpose(part))
            associate (row => n*(a - 1), column => n*(c - 1))
               ke(row + 1:row + n, column + 1:column + n) = &
                  & ke(row + 1:row + n, column + 1:column + n) + part
               if (a > c) ke(column + 1:column + n, row + 1:row + n) = &
                  & ke(column + 1:column + n, row + 1:row + n) + transpose(part)
            end associate
         end do
      end do
   end subroutine add_stiffness

   !> Adds the stiffness of hourglass motions at small strain.
   pure subroutine stiffen_hourglass(element, d, thickness, x, ke)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: d(:, :)            !! Hooke's matrix of an isotropic solid [stress]
      real(wp), intent(in) :: thickness          !! of plane kinds [length]
      real(wp), intent(in) :: x(:, :)            !! (ndim, nnode) [length]
      real(wp), intent(inout) :: ke(element%ndof, element%ndof)   !! [force/length]
      real(wp) :: force(element%ndim, element%nnode), energy
      type(moduli_type) :: moduli

      force = 0.0_wp
      energy = 0.0_wp
      associate (lame => d(2, 1), shear => d(4, 4))
         if (element%kind == element_kind%plane_stress) then
            moduli%young = d(1, 1) - lame**2/d(1, 1)
            moduli%poisson = lame/d(1, 1)
         else
            moduli%young = shear*(3.0_wp*lame + 2.0_wp*shear)/(lame + shear)
            moduli%poisson = 0.5_wp*lame/(lame + shear)
         end if
      end associate
      moduli%thickness = thickness
      call add_hourglass(element, moduli, x, 0.0_wp*force, .false., force, energy, ke)
   end subroutine stiffen_hourglass

   !> The modes of an element by its cell and points.
   pure subroutine find_modes(element, moduli, x, modes)
      type(element_type), intent(in) :: element
      type(moduli_type), intent(in) :: moduli
      real(wp), intent(in) :: x(element%ndim, element%nnode)   !! reference place [length]
      type(modes_type), intent(out) :: modes

      select case (element%cell%name)
      case ('hexahedron')
         call modes_of_brick(element, moduli%young, moduli%poisson, x, modes)
      end select
   end subroutine find_modes

   !> Of a brick of one point: four.
   pure subroutine modes_of_brick(element, young, poisson, x, modes)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: young              !! Young's modulus [stress]
      real(wp), intent(in) :: poisson            !! Poisson's ratio [-]
      real(wp), intent(in) :: x(3, 8)            !! reference place [length]
      type(modes_type), intent(out) :: modes
      integer, parameter :: nmode = 4
      real(wp) :: slope(3, 3), h(8, nmode), g(3, 8, 1), volume(1), n(3), shear
      integer :: m, i, j, bad

      modes%n = nmode
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
   end subroutine modes_of_brick
end module lopin_hourglass
