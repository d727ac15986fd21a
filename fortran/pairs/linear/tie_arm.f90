!> A tie across a gap as a rigid arm: it turns with the facet opposite.
!>
!>    u_slave = sum share u_master + theta x a,   a = x_slave - sum share x_master
!>
!> theta is the rotation that fits the nodes opposite best. A rigid rotation of both bodies then
!> keeps the tie, so that its forces, by the transpose, keep the balance of moments.
module lopin_tie_arm
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   implicit none
   private
   public :: find_tie_arm

   !> Arms below this share of the nodes' distance from their middle are what facets leave out of a
   !> curved face, no gap: over them displacements are joined as they are.
   real(wp), parameter :: faceting = 0.02_wp

contains

   !> What along . (theta x a) takes of each displacement of the nodes opposite; 0 without a gap.
   pure subroutine find_tie_arm(x, share, slave, along, coefficient)
      real(wp), intent(in) :: x(:, :)            !! (ndim, n) nodes opposite [length]
      real(wp), intent(in) :: share(:)           !! (n); sum 1
      real(wp), intent(in) :: slave(:)           !! (ndim) where the tied point is [length]
      real(wp), intent(in) :: along(3)
      real(wp), intent(out) :: coefficient(:, :) !! (3, >= n)
      real(wp) :: arm(3), r(3, size(share)), turn(3), inertia(3, 3)
      integer :: d, k
      logical :: found

      d = size(x, 1)
      coefficient = 0.0_wp
      if (size(share) == 0) return
      arm = 0.0_wp
      r = 0.0_wp
      arm(:d) = slave - matmul(x, share)
      do k = 1, d
         r(k, :) = x(k, :) - sum(x(k, :))/size(share)
      end do
      found = norm2(arm) > faceting*maxval(norm2(r, dim=1))
      if (.not. found) return
      turn = cross(arm, along)
      if (d == 2) then
         found = sum(r**2) > 0.0_wp
         if (found) turn = turn/sum(r**2)
      else
         inertia = -matmul(r, transpose(r))
         do k = 1, 3
            inertia(k, k) = inertia(k, k) + sum(r**2)
         end do
         call divide(inertia, turn, found)
      end if
      if (.not. found) return
      do k = 1, size(share)
         coefficient(:, k) = cross(turn, r(:, k))
      end do
   end subroutine find_tie_arm

   !> Solve for a rotation; nodes in one line give none.
   pure subroutine divide(inertia, turn, found)
      real(wp), intent(in) :: inertia(3, 3)
      real(wp), intent(inout) :: turn(3)
      logical, intent(out) :: found
      real(wp), parameter :: in_line = 1.0e-8_wp
      real(wp) :: row(3, 3), determinant

      row(:, 1) = cross(inertia(:, 2), inertia(:, 3))
      row(:, 2) = cross(inertia(:, 3), inertia(:, 1))
      row(:, 3) = cross(inertia(:, 1), inertia(:, 2))
      determinant = dot_product(inertia(:, 1), row(:, 1))
      found = determinant > in_line*(inertia(1, 1) + inertia(2, 2) + inertia(3, 3))**3
      if (found) turn = matmul(transpose(row), turn)/determinant
   end subroutine divide
end module lopin_tie_arm
