!> Rows of contact are the derivatives of the gap that the projection finds.
program test_contact_rows
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_contact_points, only : contact_points_type
   use lopin_pairing, only : new_contact_points
   use lopin_tool_points, only : move_tool
   use lopin_initial_gaps, only : initial_gap_type, new_initial_gaps
   use lopin_contact_rows, only : contact_rows_type, new_contact_rows
   use lopin_reduced_rows, only : row_forces
   use constraint_scenes, only : model_of, ended, nl
   use check, only : test, close_to, is_true, finish
   implicit none

   character(len=*), parameter :: steel = '*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//'1000., 0.3'//nl
   !> A small square above the slanted top of a large one, and a round tool below on node REF (9).
   character(len=*), parameter :: slanted = '*NODE'//nl//'1, 0., 0.'//nl//'2, 3., 0.'//nl// &
      & '3, 3., 0.9'//nl &
      & //'4, 0., 1.1'//nl//'5, 0.7, 1.1'//nl//'6, 1.9, 1.1'//nl//'7, 1.9, 2.1'//nl// &
      & '8, 0.7, 2.1'//nl &
      & //'*NODE, NSET=REF'//nl//'9, 1.3, -2.'//nl &
      & //'*ELEMENT, TYPE=CPE4, ELSET=LOW'//nl//'1, 1, 2, 3, 4'//nl &
      & //'*ELEMENT, TYPE=CPE4, ELSET=UP'//nl//'2, 5, 6, 7, 8'//nl//steel &
      & //'*SOLID SECTION, ELSET=LOW, MATERIAL=M'//nl//'*SOLID SECTION, ELSET=UP, MATERIAL=M'//nl &
      & //'*SURFACE, NAME=SLAVE'//nl//'UP, S1'//nl//'*SURFACE, NAME=MASTER'//nl//'LOW, S3'//nl &
      & //'*SURFACE, NAME=FOOT'//nl//'LOW, S1'//nl//'*SURFACE, NAME=ROUND, TYPE=SEGMENTS'//nl &
      & //'START, -5., -5.1'//nl//'CIRCL, 0., -0.1, 0., -5.1'//nl//'CIRCL, 5., -5.1, 0., -5.1'//nl &
      & //'*RIGID BODY, ANALYTICAL SURFACE=ROUND, REF NODE=REF'//nl// &
      & '*SURFACE INTERACTION, NAME=I'//nl &
      & //'*CONTACT PAIR, INTERACTION=I'//nl//'SLAVE, MASTER'//nl//'FOOT, ROUND'//nl
   real(wp), parameter :: step = 1.0e-6_wp
   type(model_type) :: model
   type(dofs_type) :: dofs
   type(contact_points_type) :: points
   type(contact_rows_type) :: rows
   type(error_type), allocatable :: error
   real(wp) :: place(6, 1)

   call nodes()
   call the_reference_node()
   call forces_balance()
   call finish()

contains

   !> Gaps of all points with the nodes where they are and the tool at `place`.
   subroutine project(gap)
      real(wp), allocatable, intent(out) :: gap(:)
      type(log_type) :: log

      call new_contact_points(points, model, log, error)
      call move_tool(points, model, 2, place(:2, 1), place(6:, 1))
      gap = points%gap(:points%n)
   end subroutine project

   subroutine make_rows()
      type(initial_gap_type) :: initial
      type(log_type) :: log
      real(wp), allocatable :: gap(:)
      integer :: i

      call project(gap)
      call new_initial_gaps(initial, model, points, log, error)
      call new_contact_rows(rows, model, dofs, points, initial, place, [(.false., i=1, points%n)], &
         & [(.true., i=1, points%n)])
      call close_to('four rows', real(rows%n, wp), 4.0_wp, 0.0_wp)
      call close_to('gaps of the rows at this place', [(rows%gap0(i) + sum_at(i), i=1, rows%n)], &
         & gap(rows%point), 1.0e-12_wp)
   end subroutine make_rows

   !> What the place of the tool adds: coefficients times the displacement of the reference node.
   real(wp) function sum_at(row) result(total)
      integer, intent(in) :: row
      integer :: k
      total = 0.0_wp
      do k = rows%first(row), rows%first(row + 1) - 1
         if (dofs%node(rows%dof(k)) == 9) total = total &
            & + rows%coefficient(k)*place(dofs%dof(rows%dof(k)), 1)
      end do
   end function sum_at

   real(wp) function slope(row, dof)
      integer, intent(in) :: row, dof
      integer :: k
      slope = 0.0_wp
      do k = rows%first(row), rows%first(row + 1) - 1
         if (rows%dof(k) == dof) slope = slope + rows%coefficient(k)
      end do
   end function slope

   subroutine nodes()
      integer :: node, k, i
      real(wp), allocatable :: up(:), down(:)

      call test('moving slave and master nodes changes gaps as the rows say, to first order '// &
         & 'in the gap')
      call model_of(slanted//ended, model, error)
      call is_true('the deck is read', .not. allocated(error))
      call new_dofs(dofs, model)
      place = 0.0_wp
      call make_rows()
      do node = 1, 8
         do k = 1, 2
            model%mesh%x(k, node) = model%mesh%x(k, node) + step
            call project(up)
            model%mesh%x(k, node) = model%mesh%x(k, node) - 2.0_wp*step
            call project(down)
            model%mesh%x(k, node) = model%mesh%x(k, node) + step
            do i = 1, rows%n
               call close_to('slope', (up(rows%point(i)) - down(rows%point(i)))/(2.0_wp*step), &
                  & slope(i, dofs%id(k, node)), 1.0e-7_wp)
            end do
         end do
      end do
   end subroutine nodes

   subroutine the_reference_node()
      integer, parameter :: moves(3) = [1, 2, 6]
      integer :: k, i, stand
      real(wp), allocatable :: up(:), down(:)
      real(wp) :: kept

      call test('moving and turning the tool changes gaps as the rows say, at rest and where '// &
         & 'it has gone')
      do stand = 1, 2
         if (stand == 2) place([1, 2, 6], 1) = [0.1_wp, -0.2_wp, 0.3_wp]
         call make_rows()
         do k = 1, 3
            kept = place(moves(k), 1)
            place(moves(k), 1) = kept + step
            call project(up)
            place(moves(k), 1) = kept - step
            call project(down)
            place(moves(k), 1) = kept
            do i = 1, rows%n
               call close_to('slope', (up(rows%point(i)) - down(rows%point(i)))/(2.0_wp*step), &
                  & slope(i, dofs%id(moves(k), 9)), 1.0e-7_wp)
            end do
         end do
      end do
   end subroutine the_reference_node

   subroutine forces_balance()
      real(wp), allocatable :: f(:)
      real(wp) :: total(2), moment, x(2)
      integer :: node, row

      call test('forces on slave and master balance; their moment is that of the gap')
      place = 0.0_wp
      call make_rows()
      do row = 1, rows%n
         allocate (f(dofs%n), source=0.0_wp)
         call row_forces(rows, [(merge(1.0_wp, 0.0_wp, node == row), node=1, rows%n)], f)
         total = 0.0_wp
         moment = 0.0_wp
         do node = 1, 9
            x = model%mesh%x(:, node)
            total = total + f(dofs%id(:2, node))
            moment = moment + x(1)*f(dofs%id(2, node)) - x(2)*f(dofs%id(1, node))
            if (dofs%id(6, node) > 0) moment = moment + f(dofs%id(6, node))
         end do
         call close_to('force', total, [0.0_wp, 0.0_wp], 1.0e-14_wp)
         ! The force acts along the normal, which is the line from foot to slave point: no moment
         ! either.
         call close_to('moment', moment, 0.0_wp, 1.0e-12_wp)
         deallocate (f)
      end do
   end subroutine forces_balance
end program test_contact_rows
