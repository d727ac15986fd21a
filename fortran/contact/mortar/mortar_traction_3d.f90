!> Slip and forces of a mortar row at any shape, with their exact slopes.
!>
!> Slip since the last increment, the same for every observer (Puso and Laursen 2004): what the row
!> has changed, at the present places. s = -(1 - n n) sum_i (c_i - c_i') x_i/D; a rigid motion
!> changes no c and slips nowhere.
module lopin_mortar_traction_3d
   use lopin_kinds, only : wp
   use lopin_mortar_rows_3d, only : mortar_row_type
   implicit none
   private
   public :: slip_of_row, forces_of_row

contains

   !> `row` was made with the rows before, so that it holds their nodes; without slopes the slip has
   !> none.
   subroutine slip_of_row(row, before, x, slip, slope)
      type(mortar_row_type), intent(in) :: row
      type(mortar_row_type), intent(in) :: before      !! of the same slave node
      real(wp), intent(in) :: x(:, :)                  !! (3, all mesh nodes) [length]
      real(wp), intent(out) :: slip(3)                 !! of the slave over the master [length]
      real(wp), intent(out) :: slope(:, :)             !! (3, 3n) directions as those of the row [-]
      real(wp) :: change(size(row%of)), w(3), across(3, 3), along(3)
      integer :: i, at

      slip = 0.0_wp
      slope = 0.0_wp
      if (before%node == 0 .or. row%node == 0 .or. .not. row%weight > 0.0_wp) return
      change = row%c
      do i = 1, size(before%of)
         at = findloc(row%of, before%of(i), dim=1)
         change(at) = change(at) - before%c(i)
      end do
      w = matmul(x(:, row%of), change)
      across = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], &
         & [3, 3]) - spread(row%normal, 2, 3)*spread(row%normal, 1, 3)
      slip = -matmul(across, w)/row%weight
      if (.not. allocated(row%c_slope)) return
      do i = 1, 3*size(row%of)
         at = (i + 2)/3
         along = matmul(x(:, row%of), row%c_slope(i, :))
         along(i - 3*at + 3) = along(i - 3*at + 3) + change(at)
         slope(:, i) = (-matmul(across, along) &
            & + row%normal_slope(:, i)*dot_product(row%normal, w) &
            & + row%normal*dot_product(row%normal_slope(:, i), w) &
            & - slip*row%weight_slope(i))/row%weight
      end do
   end subroutine slip_of_row

   !> Forces of a traction on the nodes of a row, and the exact tangent of their opposite.
   pure subroutine forces_of_row(row, traction, traction_slope, force, k)
      type(mortar_row_type), intent(in) :: row
      real(wp), intent(in) :: traction(3)              !! on the slave node [stress]
      real(wp), intent(in) :: traction_slope(:, :)     !! (3, 3n) by the places [stress/length]
      real(wp), intent(out) :: force(:)                !! (3n) [force]
      real(wp), intent(out) :: k(:, :)                 !! (3n, 3n) d(-force)/dx [force/length]
      integer :: i, q

      do i = 1, size(row%of)
         force(3*i - 2:3*i) = row%c(i)*traction
         do q = 1, size(force)
            k(3*i - 2:3*i, q) = -row%c_slope(q, i)*traction - row%c(i)*traction_slope(:, q)
         end do
      end do
   end subroutine forces_of_row
end module lopin_mortar_traction_3d
