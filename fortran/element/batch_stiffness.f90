!> Stiffness of a batch of elements in space: module velocity_form and the mean dilatation of module
!> solid_finite_strain, in the same operations, with the element as the fastest index.
module lopin_batch_stiffness
   use lopin_kinds, only : wp
   use lopin_element_batch, only : lanes
   implicit none
   private
   public :: velocity_form_in_lanes, add_stiffness_in_lanes, average_in_lanes, add_coupling_in_lanes
   public :: add_force

contains

   !> Quadratic form on velocity gradients, times a volume: of a spatial tangent, of the stress on
   !> the second variation of the place, and of `swap` times the trace of a product of gradients.
   pure subroutine velocity_form_in_lanes(stress, tangent, swap, weight, q)
      real(wp), intent(in) :: stress(lanes, 6)       !! Kirchhoff [stress]
      real(wp), intent(in) :: tangent(lanes, 6, 6)   !! [stress]
      real(wp), intent(in) :: swap(lanes)            !! [stress]
      real(wp), intent(in) :: weight(lanes)          !! [length^3]
      real(wp), intent(out) :: q(lanes, 9, 9)
      integer, parameter :: in_space(9) = [1, 4, 5, 4, 2, 6, 5, 6, 3]
      integer, parameter :: row(9) = [1, 2, 3, 1, 2, 3, 1, 2, 3], column(9) = [1, 1, 1, 2, 2, 2, &
         & 3, 3, 3], swapped(9) = [1, 4, 7, 2, 5, 8, 3, 6, 9]
      integer :: i, m

      do m = 1, 9
         do i = 1, 9
            q(:, i, m) = tangent(:, in_space(i), in_space(m))
         end do
         do i = row(m), 9, 3
            q(:, i, m) = q(:, i, m) + stress(:, in_space(column(i) + 3*column(m) - 3))
         end do
         q(:, swapped(m), m) = q(:, swapped(m), m) + swap
         do i = 1, 9
            q(:, i, m) = weight*q(:, i, m)
         end do
      end do
   end subroutine velocity_form_in_lanes

   !> Nodal forces of a stress.
   pure subroutine add_force(nnode, g, stress, volume, force)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(lanes, 3, nnode)     !! gradients in the deformed place [1/length]
      real(wp), intent(in) :: stress(lanes, 6)       !! Kirchhoff [stress]
      real(wp), intent(in) :: volume(lanes)          !! [length^3]
      real(wp), intent(inout) :: force(lanes, 3, nnode)   !! [force]
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

   !> Stiffness of a quadratic form: the blocks of node a and node b <= a.
   pure subroutine add_stiffness_in_lanes(nnode, g, q, ke)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(lanes, 3, nnode)     !! gradients in the deformed place [1/length]
      real(wp), intent(in) :: q(lanes, 9, 9)
      real(wp), intent(inout) :: ke(lanes, 3, 8, 3, 8)
      real(wp) :: p(lanes, 9)
      integer :: a, b, i, j, l

      do b = 1, nnode
         do j = 1, 3
            do i = 1, 9
               do l = 1, lanes
                  p(l, i) = q(l, i, j)*g(l, 1, b) + q(l, i, j + 3)*g(l, 2, b) &
                     & + q(l, i, j + 6)*g(l, 3, b)
               end do
            end do
            do a = b, nnode
               do l = 1, lanes
                  ke(l, 1, a, j, b) = ke(l, 1, a, j, b) + p(l, 1)*g(l, 1, a) &
                     & + p(l, 4)*g(l, 2, a) + p(l, 7)*g(l, 3, a)
                  ke(l, 2, a, j, b) = ke(l, 2, a, j, b) + p(l, 2)*g(l, 1, a) &
                     & + p(l, 5)*g(l, 2, a) + p(l, 8)*g(l, 3, a)
                  ke(l, 3, a, j, b) = ke(l, 3, a, j, b) + p(l, 3)*g(l, 1, a) &
                     & + p(l, 6)*g(l, 2, a) + p(l, 9)*g(l, 3, a)
               end do
            end do
         end do
      end do
   end subroutine add_stiffness_in_lanes

   !> The quadratic form of the mean dilatation; see average_tangent of module solid_finite_strain.
   pure subroutine average_in_lanes(tangent, stress, pressure, coupling, corner)
      real(wp), intent(inout) :: tangent(lanes, 6, 6)   !! [stress]
      real(wp), intent(in) :: stress(lanes, 6)       !! [stress]
      real(wp), intent(in) :: pressure(lanes)        !! Kirchhoff pressure that is shared [stress]
      real(wp), intent(out) :: coupling(lanes, 6)    !! [stress]
      real(wp), intent(out) :: corner(lanes)         !! [stress]
      real(wp), dimension(lanes) :: total, trace
      real(wp) :: sums(lanes, 6)
      integer :: i, j

      do i = 1, 6
         sums(:, i) = tangent(:, i, 1) + tangent(:, i, 2) + tangent(:, i, 3)
         coupling(:, i) = sums(:, i)/3.0_wp + 2.0_wp/3.0_wp*stress(:, i)
      end do
      total = sums(:, 1) + sums(:, 2) + sums(:, 3)
      trace = stress(:, 1) + stress(:, 2) + stress(:, 3)
      do j = 1, 3
         do i = 1, 3
            tangent(:, i, j) = tangent(:, i, j) - coupling(:, i) - coupling(:, j) &
               & + ((total + 2.0_wp*trace)/9.0_wp + pressure)
         end do
      end do
      do j = 4, 6
         do i = 1, 3
            tangent(:, i, j) = tangent(:, i, j) - coupling(:, j)
            tangent(:, j, i) = tangent(:, i, j)
         end do
      end do
      do i = 1, 3
         coupling(:, i) = coupling(:, i) - (total + 2.0_wp*trace)/9.0_wp
      end do
      corner = (total - trace)/9.0_wp
   end subroutine average_in_lanes

   !> What the mean volume ratio adds.
   pure subroutine add_coupling_in_lanes(nnode, theta, mixed, corners, ke)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: theta(lanes, 3, nnode)   !! slopes of its amplitude
      real(wp), intent(in) :: mixed(lanes, 3, nnode)
      real(wp), intent(in) :: corners(lanes)
      real(wp), intent(inout) :: ke(lanes, 3, 8, 3, 8)
      real(wp) :: whole(lanes, 3, nnode)
      integer :: a, b, i, j

      do a = 1, nnode
         do i = 1, 3
            whole(:, i, a) = mixed(:, i, a) + (0.5_wp*corners)*theta(:, i, a)
         end do
      end do
      do b = 1, nnode
         do j = 1, 3
            do a = b, nnode
               do i = 1, 3
                  ke(:, i, a, j, b) = ke(:, i, a, j, b) + theta(:, i, a)*whole(:, j, b) &
                     & + whole(:, i, a)*theta(:, j, b)
               end do
            end do
         end do
      end do
   end subroutine add_coupling_in_lanes
end module lopin_batch_stiffness
