!> Contributions of a Gauss point to the nodes of its element: forces of a stress, stiffness of a
!> quadratic form on velocity gradients.
!>
!> A velocity gradient is listed as its entries (i, j), first index fastest, of the plane, with the
!> hoop as fifth, or of space. Component i of node a, moved by one, has the entries (i, j) = g(j, a)
!> and, for i = 1, the hoop = hoop(a); all others are zero, and products with them are left out.
module lopin_velocity_form
   use lopin_kinds, only : wp
   implicit none
   private
   public :: velocity_form, add_force, add_stiffness, listed, tensor_of

contains

   !> Quadratic form of a spatial tangent, of the stress on the second variation of the place, and
   !> of `swap` times the trace of the product of two velocity gradients; times `weight`.
   pure subroutine velocity_form(d, stress, tangent, swap, weight, q)
      integer, intent(in) :: d               !! 2 or 3
      real(wp), contiguous, intent(in) :: stress(:)       !! (4 or 6) Kirchhoff [stress]
      real(wp), contiguous, intent(in) :: tangent(:, :)   !! (4, 4) or (6, 6) [stress]
      real(wp), intent(in) :: swap           !! [stress]
      real(wp), intent(in) :: weight         !! [length^3]
      real(wp), intent(inout) :: q(9, 9)     !! the first 5 or 9 rows and columns are set
      integer, parameter :: in_plane(5) = [1, 4, 4, 2, 3], in_space(9) = [1, 4, 5, 4, 2, 6, 5, 6, 3]
      integer, parameter :: row(9) = [1, 2, 3, 1, 2, 3, 1, 2, 3], column(9) = [1, 1, 1, 2, 2, 2, &
         & 3, 3, 3], swapped(9) = [1, 4, 7, 2, 5, 8, 3, 6, 9]
      integer :: i, m

      if (d == 2) then
         do m = 1, 5
            do i = 1, 5
               q(i, m) = tangent(in_plane(i), in_plane(m))
            end do
         end do
         do i = 1, 2
            q(i, i) = q(i, i) + stress(1)
            q(i + 2, i + 2) = q(i + 2, i + 2) + stress(2)
            q(i, i + 2) = q(i, i + 2) + stress(4)
            q(i + 2, i) = q(i + 2, i) + stress(4)
         end do
         q(5, 5) = q(5, 5) + stress(3) + swap
         q(1, 1) = q(1, 1) + swap
         q(2, 3) = q(2, 3) + swap
         q(3, 2) = q(3, 2) + swap
         q(4, 4) = q(4, 4) + swap
         q(:5, :5) = weight*q(:5, :5)
         return
      end if
      do m = 1, 9
         do i = 1, 9
            q(i, m) = tangent(in_space(i), in_space(m))
         end do
         do i = row(m), 9, 3
            q(i, m) = q(i, m) + stress(in_space(column(i) + 3*column(m) - 3))
         end do
         q(swapped(m), m) = q(swapped(m), m) + swap
         q(:, m) = weight*q(:, m)
      end do
   end subroutine velocity_form

   !> Nodal forces of a stress.
   pure subroutine add_force(d, nnode, g, hoop, stress, volume, force)
      integer, intent(in) :: d, nnode
      real(wp), intent(in) :: g(d, nnode)          !! gradients in the deformed place [1/length]
      real(wp), intent(in) :: hoop(nnode)          !! axisymmetric, else 0 [1/length]
      real(wp), contiguous, intent(in) :: stress(:)   !! (4 or 6) [stress]
      real(wp), intent(in) :: volume               !! [length^3]
      real(wp), intent(inout) :: force(d, nnode)   !! [force]

      if (d == 2) then
         call force_in_plane(nnode, g, hoop, volume*stress(:4), force)
      else
         call force_in_space(nnode, g, volume*stress(:6), force)
      end if
   end subroutine add_force

   pure subroutine force_in_plane(nnode, g, hoop, s, force)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(2, nnode), hoop(nnode), s(4)
      real(wp), intent(inout) :: force(2, nnode)
      real(wp) :: one(2), two(2), along(2)
      integer :: a

      one = [s(1), s(4)]
      two = [s(4), s(2)]
      along = [s(3), 0.0_wp]
      do a = 1, nnode
         force(:, a) = force(:, a) + (one*g(1, a) + two*g(2, a) + along*hoop(a))
      end do
   end subroutine force_in_plane

   pure subroutine force_in_space(nnode, g, s, force)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(3, nnode), s(6)
      real(wp), intent(inout) :: force(3, nnode)
      real(wp) :: t(3, 3)
      integer :: a

      t = reshape([s(1), s(4), s(5), s(4), s(2), s(6), s(5), s(6), s(3)], [3, 3])
      do a = 1, nnode
         force(:, a) = force(:, a) + (t(:, 1)*g(1, a) + t(:, 2)*g(2, a) + t(:, 3)*g(3, a))
      end do
   end subroutine force_in_space

   !> Stiffness of a quadratic form: the blocks of node a and node b <= a.
   pure subroutine add_stiffness(d, nnode, g, hoop, q, ke)
      integer, intent(in) :: d, nnode
      real(wp), intent(in) :: g(d, nnode)          !! as for add_force
      real(wp), intent(in) :: hoop(nnode)
      real(wp), intent(in) :: q(9, 9)              !! of velocity_form
      real(wp), intent(inout) :: ke(d*nnode, d*nnode)

      if (d == 2) then
         call add_in_plane(nnode, g, hoop, q, ke)
      else
         call add_in_space(nnode, g, q, ke)
      end if
   end subroutine add_stiffness

   pure subroutine add_in_plane(nnode, g, hoop, q, ke)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(2, nnode), hoop(nnode), q(9, 9)
      real(wp), intent(inout) :: ke(2, nnode, 2, nnode)
      real(wp) :: p(5), r(5), e, f, h
      integer :: a, b

      do b = 1, nnode
         p = q(:5, 1)*g(1, b) + q(:5, 3)*g(2, b) + q(:5, 5)*hoop(b)
         r = q(:5, 2)*g(1, b) + q(:5, 4)*g(2, b)
         !GCC$ novector
         do a = b, nnode
            e = g(1, a)
            f = g(2, a)
            h = hoop(a)
            ke(1, a, 1, b) = ke(1, a, 1, b) + (p(1)*e + p(3)*f + p(5)*h)
            ke(2, a, 1, b) = ke(2, a, 1, b) + (p(2)*e + p(4)*f)
            ke(1, a, 2, b) = ke(1, a, 2, b) + (r(1)*e + r(3)*f + r(5)*h)
            ke(2, a, 2, b) = ke(2, a, 2, b) + (r(2)*e + r(4)*f)
         end do
      end do
   end subroutine add_in_plane

   pure subroutine add_in_space(nnode, g, q, ke)
      integer, intent(in) :: nnode
      real(wp), intent(in) :: g(3, nnode), q(9, 9)
      real(wp), intent(inout) :: ke(3, nnode, 3, nnode)
      real(wp) :: p(9)
      integer :: a, b, j

      do b = 1, nnode
         do j = 1, 3
            p = q(:, j)*g(1, b) + q(:, j + 3)*g(2, b) + q(:, j + 6)*g(3, b)
            do a = b, nnode
               ke(:, a, j, b) = ke(:, a, j, b) + p(:3)*g(1, a) + p(4:6)*g(2, a) + p(7:)*g(3, a)
            end do
         end do
      end do
   end subroutine add_in_space

   !> Entries of a tensor in the order of a velocity gradient.
   pure function listed(d, s) result(list)
      integer, intent(in) :: d
      real(wp), intent(in) :: s(3, 3)
      real(wp) :: list(9)

      if (d == 2) then
         list = 0.0_wp
         list(:5) = [s(1, 1), s(2, 1), s(1, 2), s(2, 2), s(3, 3)]
      else
         list = [s(:, 1), s(:, 2), s(:, 3)]
      end if
   end function listed

   !> The tensor of stresses in the order xx yy zz xy xz yz.
   pure function tensor_of(stress) result(s)
      real(wp), intent(in) :: stress(:)   !! (4 or 6)
      real(wp) :: s(3, 3)
      integer, parameter :: row(6) = [1, 2, 3, 1, 1, 2], column(6) = [1, 2, 3, 2, 3, 3]
      integer :: r

      s = 0.0_wp
      do r = 1, size(stress)
         s(row(r), column(r)) = stress(r)
         s(column(r), row(r)) = stress(r)
      end do
   end function tensor_of
end module lopin_velocity_form
