!> Gradients of shape functions; their means over an element are exact with curved edges too.
!>
!> A uniform stress s gives node a the force s times the integral of grad N_a. Between neighbours
!> these forces cancel, and on a face under pressure they are those of the pressure, only if the
!> integral is exact. On straight edges the rules of all elements are; on curved ones those of
!> C3D10, C3D15 and C3D20R are not: det J grad N has degree 3, 4 and 5 there, the rules 2, 2 and 3.
!> As the mean gradient of Flanagan and Belytschko (1981), and as integration constraints of
!> Galerkin methods (Chen, Hillman and Rueter 2013):
!>
!>    grad N_a <- grad N_a + (mean by a whole rule) - (mean by the element's own),
!>
!> with the volumes of the points scaled to the whole volume. Linear fields keep their gradients:
!> both means of x grad N are 1. Rings have the mean over their volumes, of N / r too: those of CAX6
!> and CAX8R (degrees 4 and 5) are not exact on curved edges.
module lopin_gradients
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_vectors, only : cross
   implicit none
   private
   public :: gradients, all_gradients, correct_means, correct_ring_means, is_curved

   !> Nodes farther off the middles of their edges than this, in edges, bend them.
   real(wp), parameter :: straight = 1.0e-9_wp

contains

   !> Cartesian slopes of the shape functions: J**-T dN, and det J.
   pure subroutine gradients(ndim, nnode, x, dn, g, determinant)
      integer, intent(in) :: ndim, nnode
      real(wp), intent(in) :: x(ndim, nnode)       !! [length]
      real(wp), intent(in) :: dn(ndim, nnode)
      real(wp), intent(out) :: g(ndim, nnode)      !! [1/length]; undefined unless det J > 0
      real(wp), intent(out) :: determinant

      if (ndim == 2) then
         call plane_gradients(nnode, x, dn, g, determinant)
      else
         call space_gradients(nnode, x, dn, g, determinant)
      end if
   end subroutine gradients

   pure subroutine plane_gradients(nnode, x, dn, g, determinant)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: x(2, nnode), dn(2, nnode)
      real(wp), intent(out) :: g(2, nnode), determinant
      real(wp) :: j(2, 2)
      integer :: a

      j = 0.0_wp
      do a = 1, nnode
         j(:, 1) = j(:, 1) + x(:, a)*dn(1, a)
         j(:, 2) = j(:, 2) + x(:, a)*dn(2, a)
      end do
      determinant = j(1, 1)*j(2, 2) - j(2, 1)*j(1, 2)
      if (determinant <= 0.0_wp) return
      j = j/determinant
      do a = 1, nnode
         g(1, a) = j(2, 2)*dn(1, a) - j(2, 1)*dn(2, a)
         g(2, a) = j(1, 1)*dn(2, a) - j(1, 2)*dn(1, a)
      end do
   end subroutine plane_gradients

   pure subroutine space_gradients(nnode, x, dn, g, determinant)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: x(3, nnode), dn(3, nnode)
      real(wp), intent(out) :: g(3, nnode), determinant
      real(wp) :: j(3, 3), c(3, 3)
      integer :: a, k

      j = 0.0_wp
      do a = 1, nnode
         do k = 1, 3
            j(:, k) = j(:, k) + x(:, a)*dn(k, a)
         end do
      end do
      c(:, 1) = cross(j(:, 2), j(:, 3))
      c(:, 2) = cross(j(:, 3), j(:, 1))
      c(:, 3) = cross(j(:, 1), j(:, 2))
      determinant = dot_product(j(:, 1), c(:, 1))
      if (determinant <= 0.0_wp) return
      c = c/determinant
      do a = 1, nnode
         g(:, a) = c(:, 1)*dn(1, a) + c(:, 2)*dn(2, a) + c(:, 3)*dn(3, a)
      end do
   end subroutine space_gradients

   !> Gradients at all Gauss points, and the volumes (in the plane: areas) of these.
   pure subroutine all_gradients(element, x, g, volume, bad)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(element%ndim, element%nnode)   !! [length]
      real(wp), intent(out) :: g(element%ndim, element%nnode, element%ngauss)   !! [1/length]
      real(wp), intent(out) :: volume(element%ngauss)
      integer, intent(out) :: bad              !! first folded point; 0: none
      real(wp) :: determinant

      do bad = 1, element%ngauss
         call gradients(element%ndim, element%nnode, x, element%dn(:, :, bad), g(:, :, bad), &
            & determinant)
         if (.not. determinant > 0.0_wp) return
         volume(bad) = element%weight(bad)*determinant
      end do
      bad = 0
      if (element%ndim == 3) call correct_means(element, x, g, volume)
   end subroutine all_gradients

   !> The gradients and volumes of all Gauss points; without change where edges are straight and
   !> have nodes in their middles. Bricks of one point have the mean always.
   pure subroutine correct_means(element, x, g, volume)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(3, element%nnode)      !! [length]
      real(wp), intent(inout) :: g(3, element%nnode, element%ngauss)   !! [1/length]
      real(wp), intent(inout) :: volume(element%ngauss)
      real(wp) :: at_point(3, element%nnode), mean(3, element%nnode), whole, determinant
      integer :: k

      if (.not. allocated(element%whole_weight)) return
      if (.not. is_curved(element, x)) return
      mean = 0.0_wp
      whole = 0.0_wp
      do k = 1, size(element%whole_weight)
         call space_gradients(element%nnode, x, element%whole_dn(:, :, k), at_point, determinant)
         if (.not. determinant > 0.0_wp) return
         whole = whole + element%whole_weight(k)*determinant
         mean = mean + element%whole_weight(k)*determinant*at_point
      end do
      volume = volume*(whole/sum(volume))
      do k = 1, element%ngauss
         mean = mean - volume(k)*g(:, :, k)
      end do
      mean = mean/whole
      do k = 1, element%ngauss
         g(:, :, k) = g(:, :, k) + mean
      end do
   end subroutine correct_means

   !> The same of a ring, its areas scaled so that its volume is whole, and what functions per
   !> radius have to be given.
   pure subroutine correct_ring_means(element, x, g, area, hoop)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(2, element%nnode)      !! r, z [length]
      real(wp), intent(inout) :: g(2, element%nnode, element%ngauss)   !! [1/length]
      real(wp), intent(inout) :: area(element%ngauss)
      real(wp), intent(out) :: hoop(element%nnode)     !! added to N / r [1/length]
      real(wp) :: at_point(2, element%nnode), mean(2, element%nnode), whole, determinant, radius
      integer :: k

      hoop = 0.0_wp
      if (.not. allocated(element%whole_weight)) return
      if (.not. is_curved(element, x)) return
      mean = 0.0_wp
      whole = 0.0_wp
      do k = 1, size(element%whole_weight)
         call plane_gradients(element%nnode, x, element%whole_dn(:, :, k), at_point, determinant)
         radius = dot_product(x(1, :), element%whole_n(:, k))
         if (.not. determinant*radius > 0.0_wp) then
            hoop = 0.0_wp
            return
         end if
         associate (part => element%whole_weight(k)*determinant)
            whole = whole + part*radius
            mean = mean + part*radius*at_point
            hoop = hoop + part*element%whole_n(:, k)
         end associate
      end do
      area = area*(whole/dot_product(area, matmul(x(1, :), element%n)))
      do k = 1, element%ngauss
         mean = mean - area(k)*dot_product(x(1, :), element%n(:, k))*g(:, :, k)
         hoop = hoop - area(k)*element%n(:, k)
      end do
      mean = mean/whole
      hoop = hoop/whole
      do k = 1, element%ngauss
         g(:, :, k) = g(:, :, k) + mean
      end do
   end subroutine correct_ring_means

   pure logical function is_curved(element, x)
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(element%ndim, element%nnode)
      real(wp) :: off(element%ndim), edge(element%ndim)
      integer :: k

      is_curved = .true.
      if (element%nnode == element%cell%ncorner) return
      do k = 1, element%nnode - element%cell%ncorner
         associate (ends => element%cell%edge(:, k))
            edge = x(:, ends(2)) - x(:, ends(1))
            off = x(:, element%cell%ncorner + k) - 0.5_wp*(x(:, ends(1)) + x(:, ends(2)))
            if (dot_product(off, off) > straight**2*dot_product(edge, edge)) return
         end associate
      end do
      is_curved = .false.
   end function is_curved
end module lopin_gradients
