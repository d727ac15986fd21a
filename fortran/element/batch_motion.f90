!> Deformation of the Gauss points of a batch of elements in space: module deformation, in the same
!> operations, with the element as the fastest index. Compiled three times, see module batch_kernel.
module lopin_batch_motion
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, lanes, most, points
   use lopin_dilatation, only : dilatation_count
   implicit none
   private
   public :: motion_type, deform, cross, jacobian, gradients, displacement_gradient, trial_change
   public :: volume_change, inverse_in_lanes

   !> The Gauss points of a batch; gradients are taken in the deformed place.
   type :: motion_type
      real(wp) :: g(lanes, 3, most, points)      !! component, node, point [1/length]
      real(wp) :: change(lanes, 3, 3, points)    !! b - 1, of the elastic part if no point flowed
      real(wp) :: h(lanes, 3, 3, points)         !! F - 1
      real(wp) :: own(lanes, points)             !! J - 1
      real(wp) :: volume(lanes, points)          !! J - 1 that counts
      real(wp) :: weight(lanes, points)          !! reference volume
      real(wp) :: phi(lanes)                     !! constant function of unit norm; see dilatation
      logical :: averaged = .false.              !! mean dilatation
   end type motion_type

contains

   !> Deformation of all points.
   pure subroutine deform(element, batch, motion, done)
      type(element_type), intent(in) :: element
      type(batch_type), intent(in) :: batch
      type(motion_type), intent(inout) :: motion
      logical, intent(out) :: done
      real(wp) :: total(lanes)
      integer :: k

      motion%averaged = dilatation_count(element) == 1
      do k = 1, element%ngauss
         call gradients(element%nnode, batch%x, element%dn(:, :, k), motion%g(:, :, :, k), total)
         done = all(total > 0.0_wp)
         if (.not. done) return
         motion%weight(:, k) = element%weight(k)*total
      end do
      do k = 1, element%ngauss
         call displacement_gradient(element%nnode, batch%u, motion%g(:, :, :, k), &
            & motion%h(:, :, :, k))
         call trial_change(motion%h(:, :, :, k), batch%metric(:, :, k), motion%change(:, :, :, k))
         call volume_change(motion%h(:, :, :, k), motion%own(:, k))
         done = all(1.0_wp + motion%own(:, k) > 0.0_wp)
         if (.not. done) return
         call push(element%nnode, motion%h(:, :, :, k), motion%g(:, :, :, k))
         motion%volume(:, k) = motion%own(:, k)
      end do
      if (.not. motion%averaged) return
      total = 0.0_wp
      do k = 1, element%ngauss
         total = total + motion%weight(:, k)
      end do
      motion%phi = 1.0_wp/sqrt(total)
      total = 0.0_wp
      do k = 1, element%ngauss
         total = total + motion%phi*(motion%weight(:, k)*motion%own(:, k))
      end do
      do k = 1, element%ngauss
         motion%volume(:, k) = motion%phi*total
      end do
      done = all(1.0_wp + motion%volume(:, 1) > 0.0_wp)
   end subroutine deform

   !> Cartesian slopes of the shape functions: J**-T dN, and det J.
   pure subroutine gradients(nnode, x, dn, g, determinant)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: x(lanes, 3, nnode)         !! [length]
      real(wp), intent(in) :: dn(3, nnode)               !! parametric slopes [-]
      real(wp), intent(out) :: g(lanes, 3, nnode)        !! [1/length]
      real(wp), intent(out) :: determinant(lanes)        !! [length^3]
      real(wp) :: j(lanes, 3, 3), c(lanes, 3, 3)
      integer :: a, i, k, l

      call jacobian(nnode, x, dn, j)
      call cross(j(:, :, 2), j(:, :, 3), c(:, :, 1))
      call cross(j(:, :, 3), j(:, :, 1), c(:, :, 2))
      call cross(j(:, :, 1), j(:, :, 2), c(:, :, 3))
      determinant = j(:, 1, 1)*c(:, 1, 1) + j(:, 2, 1)*c(:, 2, 1) + j(:, 3, 1)*c(:, 3, 1)
      if (.not. all(determinant > 0.0_wp)) return
      do k = 1, 3
         do i = 1, 3
            c(:, i, k) = c(:, i, k)/determinant
         end do
      end do
      do a = 1, nnode
         do l = 1, lanes
            g(l, 1, a) = c(l, 1, 1)*dn(1, a) + c(l, 1, 2)*dn(2, a) + c(l, 1, 3)*dn(3, a)
            g(l, 2, a) = c(l, 2, 1)*dn(1, a) + c(l, 2, 2)*dn(2, a) + c(l, 2, 3)*dn(3, a)
            g(l, 3, a) = c(l, 3, 1)*dn(1, a) + c(l, 3, 2)*dn(2, a) + c(l, 3, 3)*dn(3, a)
         end do
      end do
   end subroutine gradients

   !> Sum of x(:, a) dn(:, a)^T.
   pure subroutine jacobian(nnode, x, dn, j)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: x(lanes, 3, nnode)         !! [length]
      real(wp), intent(in) :: dn(3, nnode)               !! parametric slopes [-]
      real(wp), intent(out) :: j(lanes, 3, 3)            !! [length]
      integer :: a, i, k

      j = 0.0_wp
      do a = 1, nnode
         do k = 1, 3
            do i = 1, 3
               j(:, i, k) = j(:, i, k) + x(:, i, a)*dn(k, a)
            end do
         end do
      end do
   end subroutine jacobian

   !> c = a x b.
   pure subroutine cross(a, b, c)
      real(wp), intent(in) :: a(lanes, 3), b(lanes, 3)   !! any unit
      real(wp), intent(out) :: c(lanes, 3)               !! that of a times that of b

      c(:, 1) = a(:, 2)*b(:, 3) - a(:, 3)*b(:, 2)
      c(:, 2) = a(:, 3)*b(:, 1) - a(:, 1)*b(:, 3)
      c(:, 3) = a(:, 1)*b(:, 2) - a(:, 2)*b(:, 1)
   end subroutine cross

   !> F - 1.
   pure subroutine displacement_gradient(nnode, u, g, h)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: u(lanes, 3, nnode)         !! [length]
      real(wp), intent(in) :: g(lanes, 3, nnode)         !! [1/length]
      real(wp), intent(out) :: h(lanes, 3, 3)            !! [-]
      integer :: a, i, k

      h = 0.0_wp
      do a = 1, nnode
         do k = 1, 3
            do i = 1, 3
               h(:, i, k) = h(:, i, k) + u(:, i, a)*g(:, k, a)
            end do
         end do
      end do
   end subroutine displacement_gradient

   !> b - 1 of the elastic part if nothing flowed: F (1 + P) F^T - 1.
   pure subroutine trial_change(h, metric, change)
      real(wp), intent(in) :: h(lanes, 3, 3)             !! F - 1
      real(wp), intent(in) :: metric(lanes, 6)           !! plastic metric - 1
      real(wp), intent(out) :: change(lanes, 3, 3)       !! [-]
      integer, parameter :: at(3, 3) = reshape([1, 4, 5, 4, 2, 6, 5, 6, 3], [3, 3])
      real(wp) :: half(lanes, 3, 3)   ! F (1 + P) - 1
      integer :: i, j

      do j = 1, 3
         do i = 1, 3
            half(:, i, j) = h(:, i, j) + metric(:, at(i, j)) + h(:, i, 1)*metric(:, at(1, j)) &
               & + h(:, i, 2)*metric(:, at(2, j)) + h(:, i, 3)*metric(:, at(3, j))
         end do
      end do
      do j = 1, 3
         do i = 1, j
            change(:, i, j) = half(:, i, j) + h(:, j, i) + half(:, i, 1)*h(:, j, 1) &
               & + half(:, i, 2)*h(:, j, 2) + half(:, i, 3)*h(:, j, 3)
            change(:, j, i) = change(:, i, j)
         end do
      end do
   end subroutine trial_change

   !> J - 1.
   pure subroutine volume_change(h, change)
      real(wp), intent(in) :: h(lanes, 3, 3)             !! F - 1
      real(wp), intent(out) :: change(lanes)             !! [-]

      change = h(:, 1, 1) + h(:, 2, 2) + h(:, 3, 3) &
         & + (h(:, 1, 1)*h(:, 2, 2) - h(:, 1, 2)*h(:, 2, 1)) &
         & + (h(:, 1, 1)*h(:, 3, 3) - h(:, 1, 3)*h(:, 3, 1)) &
         & + (h(:, 2, 2)*h(:, 3, 3) - h(:, 2, 3)*h(:, 3, 2)) &
         & + h(:, 1, 1)*(h(:, 2, 2)*h(:, 3, 3) - h(:, 2, 3)*h(:, 3, 2)) &
         & - h(:, 1, 2)*(h(:, 2, 1)*h(:, 3, 3) - h(:, 2, 3)*h(:, 3, 1)) &
         & + h(:, 1, 3)*(h(:, 2, 1)*h(:, 3, 2) - h(:, 2, 2)*h(:, 3, 1))
   end subroutine volume_change

   !> g <- F**-T g.
   pure subroutine push(nnode, h, g)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: h(lanes, 3, 3)
      real(wp), intent(inout) :: g(lanes, 3, nnode)
      real(wp) :: v(lanes, 3, 3), one, two, three
      integer :: a, l

      call inverse_in_lanes(h, v)
      do a = 1, nnode
         do l = 1, lanes
            one = g(l, 1, a)
            two = g(l, 2, a)
            three = g(l, 3, a)
            g(l, 1, a) = v(l, 1, 1)*one + v(l, 2, 1)*two + v(l, 3, 1)*three
            g(l, 2, a) = v(l, 1, 2)*one + v(l, 2, 2)*two + v(l, 3, 2)*three
            g(l, 3, a) = v(l, 1, 3)*one + v(l, 2, 3)*two + v(l, 3, 3)*three
         end do
      end do
   end subroutine push

   !> The inverse of F = 1 + h, regular; see inverse_of of module vectors.
   pure subroutine inverse_in_lanes(h, v)
      real(wp), intent(in) :: h(lanes, 3, 3)             !! F - 1
      real(wp), intent(out) :: v(lanes, 3, 3)            !! [-]
      real(wp) :: f(lanes, 3, 3), scale(lanes)
      integer :: a, i

      f = h
      do i = 1, 3
         f(:, i, i) = f(:, i, i) + 1.0_wp
      end do
      v(:, 1, 1) = f(:, 2, 2)*f(:, 3, 3) - f(:, 3, 2)*f(:, 2, 3)
      v(:, 2, 1) = f(:, 3, 1)*f(:, 2, 3) - f(:, 2, 1)*f(:, 3, 3)
      v(:, 3, 1) = f(:, 2, 1)*f(:, 3, 2) - f(:, 3, 1)*f(:, 2, 2)
      v(:, 1, 2) = f(:, 3, 2)*f(:, 1, 3) - f(:, 1, 2)*f(:, 3, 3)
      v(:, 2, 2) = f(:, 1, 1)*f(:, 3, 3) - f(:, 3, 1)*f(:, 1, 3)
      v(:, 3, 2) = f(:, 3, 1)*f(:, 1, 2) - f(:, 1, 1)*f(:, 3, 2)
      v(:, 1, 3) = f(:, 1, 2)*f(:, 2, 3) - f(:, 2, 2)*f(:, 1, 3)
      v(:, 2, 3) = f(:, 2, 1)*f(:, 1, 3) - f(:, 1, 1)*f(:, 2, 3)
      v(:, 3, 3) = f(:, 1, 1)*f(:, 2, 2) - f(:, 2, 1)*f(:, 1, 2)
      scale = 1.0_wp/(f(:, 1, 1)*v(:, 1, 1) + f(:, 2, 1)*v(:, 1, 2) + f(:, 3, 1)*v(:, 1, 3))
      do a = 1, 3
         do i = 1, 3
            v(:, i, a) = v(:, i, a)*scale
         end do
      end do
   end subroutine inverse_in_lanes
end module lopin_batch_motion
