!> Directions in which a tie leaves a slave node to its supports.
program test_tie_release
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_constraints, only : constraints_type, new_constraints
   use lopin_tie_release, only : released_directions, row_misfit
   use constraint_scenes, only : model_of, squares, ended, nl
   use check, only : test, close_to, is_true, finish
   implicit none

   !> A row of node 5 on nodes 4 and 3 below it, the second with a few hundredths.
   integer, parameter :: node(3) = [5, 4, 3]
   real(wp), parameter :: row(3) = [1.0_wp, -0.97_wp, -0.03_wp], curved = 0.03_wp
   !> Axes with the first along (0.6, 0.8).
   character(len=*), parameter :: axes = '0.6, 0.8, 0., -0.8, 0.6, 0.'//nl
   type(model_type) :: model
   type(dofs_type) :: dofs
   type(constraints_type) :: constraints
   type(error_type), allocatable :: error
   real(wp) :: basis(2, 2)
   integer :: n

   call a_plane_of_symmetry()
   call slanted_supports()
   call a_free_master_is_tied()
   call exact_rows_stay()
   call misfits()
   call finish()

contains

   subroutine look(supports, share, misfit)
      character(len=*), intent(in) :: supports
      real(wp), intent(in) :: share(:), misfit

      call model_of(squares('CPE4')//supports//ended, model, error)
      call is_true('the deck is read', .not. allocated(error))
      call new_dofs(dofs, model)
      call new_constraints(constraints, model, dofs, model%step(1), error)
      call released_directions(constraints, dofs, node, share, misfit, basis, n)
      call close_to('orthonormal', matmul(transpose(basis), basis), &
         & reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2]), 1.0e-14_wp)
   end subroutine look

   subroutine along(direction)
      real(wp), intent(in) :: direction(2)
      call is_true('one direction', n == 1)
      call close_to('along it', abs(dot_product(basis(:, 1), direction)), 1.0_wp, 1.0e-12_wp)
   end subroutine along

   subroutine a_plane_of_symmetry()
      call test('a slave and a master node held along x leave x to the supports, also both ways')
      call look('*BOUNDARY'//nl//'5, 1'//nl//'4, 1'//nl, row, curved)
      call along([1.0_wp, 0.0_wp])
      call look('*BOUNDARY'//nl//'5, 1, 2'//nl//'4, 1'//nl, row, curved)
      call along([1.0_wp, 0.0_wp])
      call look('*BOUNDARY'//nl//'5, 1, 2'//nl//'4, 1, 2'//nl, row, curved)
      call is_true('both', n == 2)
      call look('*BOUNDARY'//nl//'5, 1'//nl//'4, 2'//nl, row, curved)
      call is_true('the master is free along x', n == 0)
   end subroutine a_plane_of_symmetry

   subroutine slanted_supports()
      call test('the same in local axes, and by equations')
      call look('*NSET, NSET=T'//nl//'4, 5'//nl//'*TRANSFORM, NSET=T'//nl//axes//'*BOUNDARY'//nl// &
         & 'T, 1'//nl, row, curved)
      call along([0.6_wp, 0.8_wp])
      call look('*EQUATION'//nl//'2'//nl//'5, 2, 0.8, 5, 1, 0.6'//nl//'2'//nl// &
         & '4, 1, 0.6, 4, 2, 0.8'//nl, row, curved)
      call along([0.6_wp, 0.8_wp])
   end subroutine slanted_supports

   subroutine a_free_master_is_tied()
      call test('a free slave node is tied, and a held one holds a master that nothing else holds')
      call look('*BOUNDARY'//nl//'4, 1, 2'//nl, row, curved)
      call is_true('free slave', n == 0)
      call look('*BOUNDARY'//nl//'5, 1, 2'//nl, row, curved)
      call is_true('free master', n == 0)
      call look('*BOUNDARY'//nl//'5, 1, 2'//nl//'4, 1, 2'//nl, [1.0_wp, -0.4_wp, -0.6_wp], curved)
      call is_true('mostly free master', n == 0)
   end subroutine a_free_master_is_tied

   subroutine exact_rows_stay()
      call test('rows that are exact for linear fields hold nothing wrongly and stay, '// &
         & 'empty ones go')
      call look('*BOUNDARY'//nl//'5, 1, 2'//nl//'4, 1, 2'//nl, row, 1.0e-14_wp)
      call is_true('exact', n == 0)
      call look('*BOUNDARY'//nl//'5, 1, 2'//nl//'4, 1, 2'//nl, &
         & [1.0_wp, -1.0_wp, 1.0e-15_wp], 0.0_wp)
      call is_true('empty', n == 2)
   end subroutine exact_rows_stay

   subroutine misfits()
      real(wp) :: x(2, 3)

      call test('the error of a row for linear fields, across the normal alone')
      x = reshape([0.0_wp, 0.1_wp, 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp], [2, 3])
      call close_to('misfit', row_misfit(x, [1, 2, 3], row, [0.0_wp, 1.0_wp]), 0.03_wp, 1.0e-14_wp)
      x(1, 1) = 0.06_wp
      call close_to('exact', row_misfit(x, [1, 2, 3], row, [0.0_wp, 1.0_wp]), 0.0_wp, 1.0e-14_wp)
   end subroutine misfits
end program test_tie_release
