program test_cells
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, cell_names, cell_id, ncell, new_cell, new_cell_of, &
      & new_sided_cell, &
      & shape_functions, cell_centre
   use check, only : test, close_to, is_true, finish
   implicit none
   type(cell_type) :: cell
   logical :: found
   integer :: id

   do id = 1, ncell
      call new_cell(cell, trim(cell_names(id)), found)
      call test('the cell is found by its name')
      call is_true(cell_names(id), found .and. cell%id == id)
      call shape_functions_are_a_nodal_basis(cell)
      call derivatives_equal_differences(cell)
      call faces_point_outward(cell)
   end do
   call unknown_names_are_not_found()
   call abaqus_faces_have_their_corners()
   call sides_of_rigid_cells_are_opposite()
   call finish()

contains

   pure function inner_point(cell) result(xi)
      type(cell_type), intent(in) :: cell
      real(wp) :: xi(cell%ndim)
      real(wp), parameter :: shift(3) = [0.07_wp, -0.11_wp, 0.23_wp]
      xi = cell_centre(cell) + shift(:cell%ndim)
   end function inner_point

   subroutine shape_functions_are_a_nodal_basis(cell)
      type(cell_type), intent(in) :: cell
      real(wp) :: n(cell%nnode), dn(cell%ndim, cell%nnode), unit(cell%nnode), xi(cell%ndim)
      integer :: i

      xi = inner_point(cell)
      call shape_functions(cell, xi, n, dn)
      call test('shape functions sum to one, slopes to zero, and reproduce the point: '//cell%name)
      call close_to('sum', sum(n), 1.0_wp, 1.0e-14_wp)
      call close_to('slopes', sum(dn, dim=2), spread(0.0_wp, 1, cell%ndim), 1.0e-14_wp)
      call close_to('point', matmul(cell%xi(:cell%ndim, :cell%nnode), n), xi, 1.0e-14_wp)
      call test('a shape function is one at its node and zero at the others: '//cell%name)
      do i = 1, cell%nnode
         unit = 0.0_wp
         unit(i) = 1.0_wp
         call shape_functions(cell, cell%xi(:cell%ndim, i), n, dn)
         call close_to('n', n, unit, 1.0e-14_wp)
      end do
   end subroutine shape_functions_are_a_nodal_basis

   subroutine derivatives_equal_differences(cell)
      type(cell_type), intent(in) :: cell
      real(wp), parameter :: h = 1.0e-5_wp
      real(wp), dimension(cell%nnode) :: plus, minus, n
      real(wp) :: dn(cell%ndim, cell%nnode), unused(cell%ndim, cell%nnode), xi(cell%ndim)
      integer :: k

      call test('slopes equal differences: '//cell%name)
      call shape_functions(cell, inner_point(cell), n, dn)
      do k = 1, cell%ndim
         xi = inner_point(cell)
         xi(k) = xi(k) + h
         call shape_functions(cell, xi, plus, unused)
         xi(k) = xi(k) - 2.0_wp*h
         call shape_functions(cell, xi, minus, unused)
         call close_to('dn', dn(k, :), (plus - minus)/(2.0_wp*h), 1.0e-9_wp)
      end do
   end subroutine derivatives_equal_differences

   !> At the centre of every face, with the nodes of the face in their order.
   subroutine faces_point_outward(cell)
      type(cell_type), intent(in) :: cell
      type(cell_type) :: face
      real(wp) :: n(8), dn(2, 8), x(3, 8), centre(3), normal(3), tangent(3, 2)
      integer :: f, m, d

      call test('face normals point outward and mid-side nodes are in place: '//cell%name)
      d = cell%ndim
      do f = 1, cell%nface
         m = cell%face_nnode(f)
         call new_cell_of(face, cell%face_cell(f))
         call is_true('face has the nodes of its cell', face%nnode == m .and. face%ndim == d - 1)
         x = 0.0_wp
         x(:d, :m) = cell%xi(:d, cell%face_node(:m, f))
         call shape_functions(face, cell_centre(face), n(:m), dn(:face%ndim, :m))
         centre = matmul(x(:, :m), n(:m))
         tangent = 0.0_wp
         tangent(:, :face%ndim) = matmul(x(:, :m), transpose(dn(:face%ndim, :m)))
         if (d == 2) tangent(3, 2) = 1.0_wp
         normal = [tangent(2, 1)*tangent(3, 2) - tangent(3, 1)*tangent(2, 2), &
            & tangent(3, 1)*tangent(1, 2) - tangent(1, 1)*tangent(3, 2), &
            & tangent(1, 1)*tangent(2, 2) - tangent(2, 1)*tangent(1, 2)]
         call is_true('outward', dot_product(normal(:d), centre(:d) - cell_centre(cell)) > 0.1_wp)
         if (face%quadratic) call mid_nodes_are_in_the_middle(face, x)
      end do
   end subroutine faces_point_outward

   subroutine mid_nodes_are_in_the_middle(face, x)
      type(cell_type), intent(in) :: face
      real(wp), intent(in) :: x(:, :)
      integer :: k
      do k = 1, face%nnode - face%ncorner
         call close_to('mid-side', x(:, face%ncorner + k), &
            & 0.5_wp*(x(:, face%edge(1, k)) + x(:, face%edge(2, k))), 1.0e-15_wp)
      end do
   end subroutine mid_nodes_are_in_the_middle

   subroutine unknown_names_are_not_found()
      call test('an unknown cell is not found')
      call new_cell(cell, 'pyramid', found)
      call is_true('pyramid', .not. found)
      call new_sided_cell(cell, 'hexahedron', found)
      call is_true('a hexahedron has no two sides', .not. found)
   end subroutine unknown_names_are_not_found

   subroutine abaqus_faces_have_their_corners()
      call test('faces have the corners that Abaqus lists')
      call new_cell_of(cell, cell_id%hexahedron)
      call is_true('hexahedron S3', same_set(cell%face_node(:4, 3), [1, 5, 6, 2]))
      call is_true('hexahedron S6', same_set(cell%face_node(:4, 6), [4, 8, 5, 1]))
      call new_cell_of(cell, cell_id%tetra)
      call is_true('tetra S2', same_set(cell%face_node(:3, 2), [1, 4, 2]))
      call is_true('tetra S4', same_set(cell%face_node(:3, 4), [3, 4, 1]))
      call new_cell_of(cell, cell_id%wedge15)
      call is_true('wedge15 S5', same_set(cell%face_node(:8, 5), [3, 1, 4, 6, 9, 13, 12, 15]))
   end subroutine abaqus_faces_have_their_corners

   pure logical function same_set(a, b)
      integer, intent(in) :: a(:), b(:)
      integer :: i
      same_set = size(a) == size(b)
      do i = 1, size(a)
         same_set = same_set .and. any(b == a(i))
      end do
   end function same_set

   subroutine sides_of_rigid_cells_are_opposite()
      call test('SPOS of a line is to its left, of a surface by the right-hand rule')
      call new_sided_cell(cell, 'line2', found)
      call is_true('line', found .and. all(cell%face_node(:2, 1) == [2, 1]) &
         & .and. all(cell%face_node(:2, 2) == [1, 2]))
      call new_sided_cell(cell, 'quad8', found)
      call is_true('quad8', all(cell%face_node(:, 1) == [1, 2, 3, 4, 5, 6, 7, 8]) &
         & .and. all(cell%face_node(:, 2) == [1, 4, 3, 2, 8, 7, 6, 5]))
   end subroutine sides_of_rigid_cells_are_opposite
end program test_cells
