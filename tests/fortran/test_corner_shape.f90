program test_corner_shape
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, cell_names, cell_id, new_cell
   use lopin_corner_shape, only : corners_type, new_corners, worst_corner, turns_over, &
      & shortest_side
   use check, only : test, close_to, is_true, finish
   implicit none
   type(cell_type) :: cell
   type(corners_type) :: corners
   real(wp) :: value, x(3, 20), angle
   integer :: corner, id, k
   logical :: found

   call test('every reference cell has the scaled Jacobian of its corners')
   do id = cell_id%triangle, cell_id%hexahedron20
      call new_cell(cell, trim(cell_names(id)), found)
      call worst_corner(cell, cell%xi(:cell%ndim, :), value, corner)
      call is_true('positive', value > 0.3_wp .and. value <= 1.0_wp)
      call worst_corner(cell, 7.0_wp*cell%xi(:cell%ndim, :), angle, corner)
      call close_to('unit', angle, value, 1.0e-14_wp)
      x(:cell%ndim, :cell%nnode) = cell%xi(:cell%ndim, :cell%nnode)
      x(1, :) = -x(1, :)
      call worst_corner(cell, x(:cell%ndim, :), angle, corner)
      call is_true('mirrored', angle < 0.0_wp)
   end do

   call test('nodes that move less than the spare way of a cell turn no corner over')
   do id = cell_id%triangle, cell_id%hexahedron20
      call new_cell(cell, trim(cell_names(id)), found)
      call new_corners(corners, cell)
      call worst_corner(corners, cell%xi(:cell%ndim, :), value, corner)
      value = value*shortest_side(corners, cell%xi(:cell%ndim, :)) &
         & /(7.0_wp*merge(8.0_wp, 2.0_wp, cell%quadratic))
      do k = 1, 40
         ! Against the first node, in directions that differ from node to node.
         x(:cell%ndim, :cell%nnode) = cell%xi(:cell%ndim, :cell%nnode)
         do corner = 2, cell%nnode
            angle = 2.4_wp*k*corner
            x(:2, corner) = x(:2, corner) + 0.999_wp*value*[cos(angle), sin(angle)]
         end do
         call is_true('stands', .not. turns_over(corners, x(:cell%ndim, :cell%nnode)))
      end do
   end do

   call test('a corner that folds is found: the sine of its angle')
   call new_cell(cell, 'quad', found)
   do k = 1, 3
      angle = 0.9_wp*k
      x(:2, :4) = reshape([0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp + cos(angle), sin(angle), &
         & cos(angle), sin(angle)], [2, 4])
      call worst_corner(cell, x(:2, :4), value, corner)
      call close_to('sine', value, sin(angle), 1.0e-14_wp)
   end do
   x(:2, 3) = [0.3_wp, 0.3_wp]
   x(:2, 4) = [0.0_wp, 1.0_wp]
   call worst_corner(cell, x(:2, :4), value, corner)
   call is_true('folded at 3', value < 0.0_wp .and. corner == 3)
   call finish()
end program test_corner_shape
