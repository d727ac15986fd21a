!> Outward unit normals of one facet at its nodes, and their slopes by the places of its nodes.
module lopin_facet_sides
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_type, shape_functions
   implicit none
   private
   public :: facet_sides

contains

   !> A facet without area has none: zero.
   pure subroutine facet_sides(cell, x, normal, slope)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)                      !! (ndim, nodes) [length]
      real(wp), intent(out) :: normal(:, :)                !! (ndim, nodes)
      real(wp), intent(out), optional :: slope(:, :, :)    !! (3, 3 nodes, nodes), space [1/length]
      real(wp) :: n(8), dn(2, 8), t(3, 2), v(3), length, across(3, 3)
      integer :: j, k, d, m

      d = size(x, 1)
      m = size(x, 2)
      normal = 0.0_wp
      if (present(slope)) slope = 0.0_wp
      do j = 1, m
         call shape_functions(cell, cell%xi(:d - 1, j), n(:m), dn(:d - 1, :m))
         t = 0.0_wp
         t(:d, :d - 1) = matmul(x, transpose(dn(:d - 1, :m)))
         if (d == 2) v = [t(2, 1), -t(1, 1), 0.0_wp]
         if (d == 3) v = cross(t(:, 1), t(:, 2))
         length = norm2(v)
         if (.not. length > 0.0_wp) cycle
         v = v/length
         normal(:, j) = v(:d)
         if (.not. present(slope)) cycle
         across = (unity() - spread(v, 2, 3)*spread(v, 1, 3))/length
         do k = 1, m
            slope(:, 3*k - 2:3*k, j) = matmul(across, dn(1, k)*turning(-t(:, 2)) &
               & + dn(2, k)*turning(t(:, 1)))
         end do
      end do
   end subroutine facet_sides

   pure function unity() result(i)
      real(wp) :: i(3, 3)
      i = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
   end function unity

   !> The matrix of v cross.
   pure function turning(v) result(w)
      real(wp), intent(in) :: v(3)
      real(wp) :: w(3, 3)
      w = reshape([0.0_wp, v(3), -v(2), -v(3), 0.0_wp, v(1), v(2), -v(1), 0.0_wp], [3, 3])
   end function turning
end module lopin_facet_sides
