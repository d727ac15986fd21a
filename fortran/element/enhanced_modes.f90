!> Internal modes of the enhanced linear quads and bricks (words with I).
!>
!> The gradient of an element is F + F0 E, where F is that of the nodes, F0 its value at the centre
!> and E = sum alpha_m mode_m. A mode is strain-like: entry (i, j) of its parametric matrix, times
!> xi_i, carried to the reference shape by the Jacobian of the centre (Simo and Rifai 1990; the
!> transposed Wilson modes of Glaser and Armero 1997, which stay free of hourglassing in large
!> compression). Bricks and axisymmetric quads also have the products of two parameters in the
!> dilatation, so that they do not lock in volume. Sheets of one layer have the square and the cube
!> in the stretch of their thickness, so that the stress across all but vanishes at each of its
!> points, as in a thick sheet that bends. Every mode has a vanishing integral over the
!> reference volume, so the patch test passes; no amplitude depends on the frame or on units.
module lopin_enhanced_modes
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_element_type, only : element_type
   implicit none
   private
   public :: modes_type, internal_modes, edge_of, outer_sum, solve_small

   integer, parameter, public :: most_modes = 16, most_nodes = 8, most_points = 72

   !> Modes at the Gauss points and gradients at the centre, in the reference shape.
   type :: modes_type
      real(wp) :: e(3, 3, most_modes, most_points)   !! [-]; (3, 3) is the hoop if axisymmetric
      real(wp) :: g(3, most_nodes)                   !! slopes of the shape functions [1/length]
      real(wp) :: hoop(most_nodes)                   !! shape function per radius [1/length]
   end type modes_type

contains

   !> The internal modes of an element on its reference place.
   pure subroutine internal_modes(element, x, self, smallest)
      type(element_type), intent(in) :: element    !! with nmode > 0
      real(wp), intent(in) :: x(:, :)              !! (ndim, nnode) reference [length]
      type(modes_type), intent(out) :: self
      real(wp), intent(out) :: smallest            !! least det J; nothing is defined unless > 0
      real(wp) :: inverse(3, 3), centre, here, size_of, scale, other(3, 3)
      integer :: i, k, d, m

      d = element%ndim
      m = element%nnode
      call invert(d, outer_sum(d, m, x, element%dn0), inverse, centre)
      smallest = centre
      if (.not. centre > 0.0_wp) return
      self%e(:, :, :element%nmode, :element%ngauss) = 0.0_wp
      self%hoop = 0.0_wp
      do k = 1, m
         self%g(:d, k) = 0.0_wp
         do i = 1, d
            self%g(:d, k) = self%g(:d, k) + inverse(i, :d)*element%dn0(i, k)
         end do
      end do
      if (element%axisymmetric) then
         self%hoop(:m) = element%n0/dot_product(x(1, :m), element%n0)
         centre = centre*dot_product(x(1, :m), element%n0)
      end if
      size_of = edge_of(smallest, d)
      do k = 1, element%ngauss
         call invert(d, outer_sum(d, m, x, element%dn(:, :, k)), other, here)
         smallest = min(smallest, here)
         if (.not. smallest > 0.0_wp) return
         if (element%axisymmetric) here = here*dot_product(x(1, :m), element%n(:, k))
         scale = centre/here
         call fill(element, size_of*inverse, scale, element%xi(:, k), self%e(:, :, :, k))
      end do
   end subroutine internal_modes

   pure subroutine fill(element, inverse, scale, xi, e)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: inverse(3, 3), scale, xi(:)
      real(wp), intent(inout) :: e(:, :, :)
      real(wp), parameter :: third = 1.0_wp/3.0_wp
      integer :: i, j, p, q, m, d

      d = element%ndim
      m = 0
      do j = 1, d
         do i = 1, d
            m = m + 1
            do q = 1, d
               do p = 1, d
                  e(p, q, m) = scale*xi(i)*inverse(i, p)*inverse(j, q)
               end do
            end do
         end do
      end do
      do i = 1, d
         if (element%layers(i) /= 1) cycle
         m = m + 2
         do q = 1, d
            do p = 1, d
               e(p, q, m - 1) = scale*(xi(i)**2 - third)*inverse(i, p)*inverse(i, q)
               e(p, q, m) = scale*xi(i)**3*inverse(i, p)*inverse(i, q)
            end do
         end do
      end do
      if (m == element%nmode) return
      do j = 2, d
         do i = 1, j - 1
            m = m + 1
            do p = 1, 3
               e(p, p, m) = scale*xi(i)*xi(j)
            end do
         end do
      end do
   end subroutine fill

   !> Edge of a square or cube of a content. A procedure apart: a loop over powers would be made one
   !> of vector copies of them, which have other bits.
   pure real(wp) function edge_of(content, d)
      real(wp), intent(in) :: content              !! [length^d]
      integer, intent(in) :: d

      edge_of = content**(1.0_wp/real(d, wp))
   end function edge_of

   !> Sum of x(:, a) dn(:, a)^T over the nodes, node after node.
   pure function outer_sum(d, nnode, x, dn) result(total)
      integer, intent(in) :: d, nnode
      real(wp), intent(in) :: x(:, :)              !! (>= d, >= nnode)
      real(wp), intent(in) :: dn(:, :)             !! the same
      real(wp) :: total(d, d)
      integer :: a, k

      total = 0.0_wp
      do a = 1, nnode
         do k = 1, d
            total(:, k) = total(:, k) + x(:d, a)*dn(k, a)
         end do
      end do
   end function outer_sum

   !> Inverse and determinant of the leading block.
   pure subroutine invert(d, j, inverse, determinant)
      integer, intent(in) :: d
      real(wp), intent(in) :: j(d, d)
      real(wp), intent(out) :: inverse(3, 3)   !! meaningless unless the determinant is > 0
      real(wp), intent(out) :: determinant

      inverse = 0.0_wp
      if (d == 2) then
         inverse(:2, 1) = [j(2, 2), -j(2, 1)]
         inverse(:2, 2) = [-j(1, 2), j(1, 1)]
      else
         inverse(1, :) = cross(j(:, 2), j(:, 3))
         inverse(2, :) = cross(j(:, 3), j(:, 1))
         inverse(3, :) = cross(j(:, 1), j(:, 2))
      end if
      determinant = dot_product(inverse(1, :d), j(:, 1))
      if (determinant > 0.0_wp) inverse(:d, :d) = inverse(:d, :d)/determinant
   end subroutine invert

   !> b <- a^-1 b by elimination with the largest pivot; `regular` is false where there is none.
   pure subroutine solve_small(a, b, regular)
      real(wp), contiguous, intent(inout) :: a(:, :)   !! overwritten
      real(wp), contiguous, intent(inout) :: b(:, :)
      logical, intent(out) :: regular
      real(wp) :: held(max(size(a, 2), size(b, 2)))
      integer :: j, k, p, n

      n = size(a, 1)
      regular = .false.
      do k = 1, n
         p = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         if (.not. abs(a(p, k)) > 0.0_wp) return
         if (p /= k) then
            held(:n) = a(k, :)
            a(k, :) = a(p, :)
            a(p, :) = held(:n)
            held(:size(b, 2)) = b(k, :)
            b(k, :) = b(p, :)
            b(p, :) = held(:size(b, 2))
         end if
         a(k + 1:, k) = a(k + 1:, k)/a(k, k)
         do j = k + 1, n
            a(k + 1:, j) = a(k + 1:, j) - a(k, j)*a(k + 1:, k)
         end do
         do j = 1, size(b, 2)
            b(k + 1:, j) = b(k + 1:, j) - b(k, j)*a(k + 1:, k)
         end do
      end do
      do j = 1, size(b, 2)
         do k = n, 1, -1
            b(k, j) = b(k, j)/a(k, k)
            b(:k - 1, j) = b(:k - 1, j) - b(k, j)*a(:k - 1, k)
         end do
      end do
      regular = .true.
   end subroutine solve_small
end module lopin_enhanced_modes
