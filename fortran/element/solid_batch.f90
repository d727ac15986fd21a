!> Solids in space at finite strain, several elements of one type and material at a time.
!>
!> The element is the fastest index of every array, so that loops over the elements of a batch are
!> vector instructions. What is computed is that of module solid_finite_strain, operation by
!> operation: the same bits. A batch in which an element turns inside out is left to that module.
!> Compiled three times, see module batch_kernel.
module lopin_solid_batch
   use lopin_kinds, only : wp
   use lopin_element_type, only : element_type
   use lopin_element_batch, only : batch_type, lanes, most
   use lopin_dilatation, only : dilatation_count
   use lopin_hyperelastic, only : solid_law_type
   use lopin_batch_law, only : law_lanes_type, respond_in_lanes, frame_lanes_type, find_frames
   use lopin_batch_stiffness, only : add_stiffness_in_lanes, add_coupling_in_lanes, &
      & average_in_lanes, velocity_form_in_lanes
   implicit none
   private
   public :: evaluate_batch, motion_type, deform, inverse_in_lanes

   !> The Gauss points of a batch; gradients are taken in the deformed place.
   type :: motion_type
      real(wp) :: g(lanes, 3, most, most)        !! component, node, point [1/length]
      real(wp) :: change(lanes, 3, 3, most)      !! b - 1, of the elastic part if no point flowed
      real(wp) :: h(lanes, 3, 3, most)           !! F - 1
      real(wp) :: own(lanes, most)               !! J - 1
      real(wp) :: volume(lanes, most)            !! J - 1 that counts
      real(wp) :: weight(lanes, most)            !! reference volume
      real(wp) :: phi(lanes)                     !! constant function of unit norm; see dilatation
      logical :: averaged = .false.              !! mean dilatation
   end type motion_type

contains

   !> Forces, energies and, if asked for, tangents.
   pure subroutine evaluate_batch(element, law, with_tangent, batch, done)
      type(element_type), intent(in) :: element
      type(solid_law_type), intent(in) :: law
      logical, intent(in) :: with_tangent
      type(batch_type), intent(inout) :: batch
      logical, intent(out) :: done             !! no element is turned inside out
      type(motion_type) :: motion
      type(law_lanes_type) :: answer
      type(frame_lanes_type) :: frame(most)
      real(wp) :: stress(lanes, 6, most), tangent(lanes, 6, 6, most), shared(lanes, most)
      integer :: k

      call deform(element, batch, motion, done)
      if (.not. done) return
      call find_frames(element%ngauss, motion%change, frame)
      batch%energy = 0.0_wp
      do k = 1, element%ngauss
         call respond_in_lanes(law, frame(k), motion%volume(:, k), &
            & batch%strain(:, k), batch%offset(:, k), batch%dt, with_tangent, answer)
         stress(:, :, k) = answer%stress
         if (with_tangent) tangent(:, :, :, k) = answer%tangent
         batch%energy = batch%energy + motion%weight(:, k)*answer%energy
      end do
      shared = 0.0_wp
      if (motion%averaged) call share_pressure(element%ngauss, motion, stress, shared)
      if (with_tangent) call find_tangent(element, motion, stress, shared, tangent, batch%ke)
      batch%force = 0.0_wp
      do k = 1, element%ngauss
         if (motion%averaged) call replace_pressure(motion%own(:, k), shared(:, k), &
            & stress(:, :, k))
         call add_force(element%nnode, motion%g(:, :, :, k), stress(:, :, k), &
            & motion%weight(:, k), batch%force)
      end do
   end subroutine evaluate_batch

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
      real(wp), intent(in) :: x(lanes, 3, nnode), dn(3, nnode)
      real(wp), intent(out) :: g(lanes, 3, nnode), determinant(lanes)
      real(wp) :: j(lanes, 3, 3), c(lanes, 3, 3)
      integer :: a, i, k, l

      j = 0.0_wp
      do a = 1, nnode
         do k = 1, 3
            do i = 1, 3
               j(:, i, k) = j(:, i, k) + x(:, i, a)*dn(k, a)
            end do
         end do
      end do
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

   pure subroutine cross(a, b, c)
      real(wp), intent(in) :: a(lanes, 3), b(lanes, 3)
      real(wp), intent(out) :: c(lanes, 3)

      c(:, 1) = a(:, 2)*b(:, 3) - a(:, 3)*b(:, 2)
      c(:, 2) = a(:, 3)*b(:, 1) - a(:, 1)*b(:, 3)
      c(:, 3) = a(:, 1)*b(:, 2) - a(:, 2)*b(:, 1)
   end subroutine cross

   !> F - 1.
   pure subroutine displacement_gradient(nnode, u, g, h)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: u(lanes, 3, nnode), g(lanes, 3, nnode)
      real(wp), intent(out) :: h(lanes, 3, 3)
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
      real(wp), intent(in) :: h(lanes, 3, 3), metric(lanes, 6)
      real(wp), intent(out) :: change(lanes, 3, 3)
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
      real(wp), intent(in) :: h(lanes, 3, 3)
      real(wp), intent(out) :: change(lanes)

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
      real(wp), intent(in) :: h(lanes, 3, 3)
      real(wp), intent(out) :: v(lanes, 3, 3)
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

   !> Projection of the Kirchhoff pressure (tension positive) per volume ratio that counts.
   pure subroutine share_pressure(ngauss, motion, stress, shared)
      integer, intent(in) :: ngauss
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: stress(lanes, 6, most)
      real(wp), intent(inout) :: shared(lanes, most)
      real(wp) :: total(lanes)
      integer :: k

      total = 0.0_wp
      do k = 1, ngauss
         total = total + motion%phi*(motion%weight(:, k)*((stress(:, 1, k) + stress(:, 2, k) &
            & + stress(:, 3, k))/(3.0_wp*(1.0_wp + motion%volume(:, k)))))
      end do
      do k = 1, ngauss
         shared(:, k) = motion%phi*total
      end do
   end subroutine share_pressure

   !> The Kirchhoff stress that does the same work on the projected volume ratio.
   pure subroutine replace_pressure(own, shared, stress)
      real(wp), intent(in) :: own(lanes), shared(lanes)
      real(wp), intent(inout) :: stress(lanes, 6)
      real(wp) :: mean(lanes)
      integer :: i

      mean = (stress(:, 1) + stress(:, 2) + stress(:, 3))/3.0_wp
      do i = 1, 3
         stress(:, i) = stress(:, i) - mean + shared*(1.0_wp + own)
      end do
   end subroutine replace_pressure

   !> Nodal forces of a stress.
   pure subroutine add_force(nnode, g, stress, volume, force)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(lanes, 3, nnode), stress(lanes, 6), volume(lanes)
      real(wp), intent(inout) :: force(lanes, 3, nnode)
      real(wp) :: s(lanes, 6)
      integer :: a, i, l

      do i = 1, 6
         s(:, i) = volume*stress(:, i)
      end do
      do a = 1, nnode
         do l = 1, lanes
            force(l, 1, a) = force(l, 1, a) &
               & + (s(l, 1)*g(l, 1, a) + s(l, 4)*g(l, 2, a) + s(l, 5)*g(l, 3, a))
            force(l, 2, a) = force(l, 2, a) &
               & + (s(l, 4)*g(l, 1, a) + s(l, 2)*g(l, 2, a) + s(l, 6)*g(l, 3, a))
            force(l, 3, a) = force(l, 3, a) &
               & + (s(l, 5)*g(l, 1, a) + s(l, 6)*g(l, 2, a) + s(l, 3)*g(l, 3, a))
         end do
      end do
   end subroutine add_force

   !> The second derivative of the energy.
   pure subroutine find_tangent(element, motion, stress, shared, tangent, ke)
      type(element_type), intent(in) :: element
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: stress(lanes, 6, most), shared(lanes, most)
      real(wp), intent(inout) :: tangent(lanes, 6, 6, most)
      real(wp), intent(out) :: ke(lanes, 3, most, 3, most)
      real(wp), dimension(lanes, 3, most) :: row, dilation, theta, mixed
      real(wp) :: coupling(lanes, 6), unit(lanes, 6), corners(lanes), q(lanes, 9, 9)
      real(wp), dimension(lanes) :: swap, corner, part, weight
      integer :: a, i, k

      ke = 0.0_wp
      theta = 0.0_wp
      mixed = 0.0_wp
      corners = 0.0_wp
      swap = 0.0_wp
      unit = 0.0_wp
      unit(:, :3) = 1.0_wp
      do k = 1, element%ngauss
         weight = motion%weight(:, k)
         if (motion%averaged) then
            call average_in_lanes(tangent(:, :, :, k), stress(:, :, k), &
               & shared(:, k)*(1.0_wp + motion%own(:, k)), coupling, corner)
            swap = (stress(:, 1, k) + stress(:, 2, k) + stress(:, 3, k))/3.0_wp &
               & - shared(:, k)*(1.0_wp + motion%own(:, k))
            row = 0.0_wp
            dilation = 0.0_wp
            call add_force(element%nnode, motion%g(:, :, :, k), coupling, weight, row)
            call add_force(element%nnode, motion%g(:, :, :, k), unit, &
               & weight*(1.0_wp + motion%own(:, k)), dilation)
            part = motion%phi/(1.0_wp + motion%volume(:, k))
            do a = 1, element%nnode
               do i = 1, 3
                  mixed(:, i, a) = mixed(:, i, a) + part*row(:, i, a)
                  theta(:, i, a) = theta(:, i, a) + motion%phi*dilation(:, i, a)
               end do
            end do
            corners = corners + (weight*corner*part)*part
         end if
         call velocity_form_in_lanes(stress(:, :, k), tangent(:, :, :, k), swap, weight, q)
         call add_stiffness_in_lanes(element%nnode, motion%g(:, :, :, k), q, ke)
      end do
      if (motion%averaged) call add_coupling_in_lanes(element%nnode, theta, mixed, corners, ke)
   end subroutine find_tangent
end module lopin_solid_batch
