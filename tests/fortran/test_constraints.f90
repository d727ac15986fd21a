!> Constraints: expansion and its adjoint, chains, followers, cycles, and T^T K T.
program test_constraints
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type, storage
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_constraints, only : constraints_type, new_constraints, expand, reduce, &
      & prescribed_part, &
      & raw_displacement
   use lopin_reduce_matrix, only : reduce_matrix
   use lopin_rigid_motion, only : rigid_motion
   use constraint_scenes, only : model_of, squares, cube, ended, nl
   use blocks, only : random
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none

   character(len=*), parameter :: axes = '0.8, 0.6, 0., -0.6, 0.8, 0.'//nl
   !> Local axes, an equation that chains into another, a rigid row: everything at once.
   character(len=*), parameter :: mixed = '*RIGID BODY, NSET=TOP, REF NODE=REF'//nl// &
      & '*NSET, NSET=T'//nl//'3, 7' &
      & //nl//'*TRANSFORM, NSET=T'//nl//axes//'*EQUATION'//nl//'3'//nl// &
      & '1, 1, 2., 2, 1, 3., 7, 2, -1.'//nl &
      & //'2'//nl//'2, 1, 1., 3, 1, 0.5'//nl//'*BOUNDARY'//nl//'5, 1, 2'//nl//'3, 2'//nl
   type(model_type) :: model
   type(dofs_type) :: dofs
   type(constraints_type) :: self
   type(error_type), allocatable :: error

   call expansion_and_reduction_are_adjoint()
   call followers_are_derivatives_of_finite_rotations()
   call followers_do_not_care_about_axes()
   call long_chains_are_resolved()
   call cycles_and_contradictions_are_refused()
   call reduced_matrices_are_congruent()
   call finish()

contains

   subroutine constrain(text)
      character(len=*), intent(in) :: text
      call model_of(text, model, error)
      call is_true('the deck is read', .not. allocated(error))
      call new_dofs(dofs, model)
      call new_constraints(self, model, dofs, model%step(1), error)
   end subroutine constrain

   function numbers(n, start) result(x)
      integer, intent(in) :: n, start
      real(wp) :: x(n)
      integer :: i, seed
      seed = start
      do i = 1, n
         call random(seed, x(i))
      end do
   end function numbers

   subroutine expansion_and_reduction_are_adjoint()
      real(wp), allocatable :: v(:), p(:), u(:), f(:), r(:), s(:)

      call test('f . expand(v, p) = reduce(f) . v + prescribed_part(f) . p, with every kind '// &
         & 'of constraint')
      call constrain(squares('CPE4')//mixed//ended)
      call is_true('no error', .not. allocated(error))
      v = numbers(self%neq, 3)
      p = numbers(self%nprescribed, 5)
      f = numbers(dofs%n, 7)
      allocate (u(dofs%n), r(self%neq), s(self%nprescribed))
      call expand(self, v, p, u)
      call reduce(self, f, r)
      call prescribed_part(self, f, s)
      call close_to('work', dot_product(f, u), dot_product(r, v) + dot_product(s, p), 1.0e-13_wp)
      call test('the equations hold for what was expanded, local axes included')
      call close_to('first', 2.0_wp*u(dofs%id(1, 1)) + 3.0_wp*u(dofs%id(1, 2)), raw(7, 2, u), &
         & 1.0e-13_wp)
      call close_to('second', u(dofs%id(1, 2)) + 0.5_wp*raw(3, 1, u), 0.0_wp, 1.0e-13_wp)
      call close_to('local support', raw(3, 2, u), &
         & p(findloc(self%dof_of_prescribed, dofs%id(2, 3), 1)), 1.0e-13_wp)
   end subroutine expansion_and_reduction_are_adjoint

   real(wp) function raw(node, dof, u)
      integer, intent(in) :: node, dof
      real(wp), intent(in) :: u(:)
      raw = raw_displacement(self, dofs, u, dofs%id(dof, node))
   end function raw

   !> Displacements for given dofs 1..6 of the reference node, all other equations zero.
   subroutine move_reference(q, u)
      real(wp), intent(in) :: q(6)
      real(wp), allocatable, intent(out) :: u(:)
      real(wp), allocatable :: v(:)
      integer :: i

      allocate (v(self%neq), source=0.0_wp)
      do i = 1, self%neq
         if (dofs%node(self%dof_of_equation(i)) == 9) v(i) = q(dofs%dof(self%dof_of_equation(i)))
      end do
      allocate (u(dofs%n))
      call expand(self, v, spread(0.0_wp, 1, self%nprescribed), u)
   end subroutine move_reference

   subroutine followers_are_derivatives_of_finite_rotations()
      real(wp), allocatable :: u(:)
      real(wp) :: q(6), step, moved(3), back(3)
      integer :: k, i, d, node, first

      call test('a follower moves as the derivative of the finite motion about the reference node')
      do d = 2, 3
         if (d == 2) call constrain(squares('CPE4')//'*RIGID BODY, NSET=TOP, REF NODE=REF'//nl// &
            & ended)
         if (d == 3) call constrain(cube()//'*RIGID BODY, NSET=TOP, REF NODE=REF'//nl//ended)
         first = merge(7, 5, d == 2)
         step = 1.0e-4_wp
         do k = 1, 6
            if (dofs%id(k, 9) == 0) cycle
            q = 0.0_wp
            q(k) = step
            call move_reference(q, u)
            do node = first, 8
               if (d == 2) then
                  moved(:2) = rigid_motion(model%mesh%x(:, 9), q(:2), q(6:6), model%mesh%x(:, node))
                  back(:2) = rigid_motion(model%mesh%x(:, 9), -q(:2), -q(6:6), &
                     & model%mesh%x(:, node))
               else
                  moved = rigid_motion(model%mesh%x(:, 9), q(:3), q(4:), model%mesh%x(:, node))
                  back = rigid_motion(model%mesh%x(:, 9), -q(:3), -q(4:), model%mesh%x(:, node))
               end if
               call close_to('displacement', [(u(dofs%id(i, node)), i=1, d)]/step, &
                  & (moved(:d) - back(:d))/(2.0_wp*step), 1.0e-7_wp)
            end do
         end do
      end do
   end subroutine followers_are_derivatives_of_finite_rotations

   subroutine followers_do_not_care_about_axes()
      character(len=*), parameter :: body = '*RIGID BODY, NSET=TOP, REF NODE=REF'//nl
      real(wp), allocatable :: plain(:), turned(:)
      integer :: i

      call test('local axes of followers or of the reference node change names, not displacements')
      call constrain(squares('CPE4')//body//ended)
      call move_reference([0.3_wp, -0.2_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.1_wp], plain)
      call constrain(squares('CPE4')//body//'*TRANSFORM, NSET=TOP'//nl//axes//ended)
      call move_reference([0.3_wp, -0.2_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.1_wp], turned)
      call close_to('followers', turned, plain, 1.0e-14_wp)
      call constrain(squares('CPE4')//body//'*TRANSFORM, NSET=REF'//nl//axes//ended)
      call move_reference([0.8_wp*0.3_wp - 0.6_wp*0.2_wp, -0.6_wp*0.3_wp - 0.8_wp*0.2_wp, 0.0_wp, &
         & 0.0_wp, 0.0_wp, &
         & 0.1_wp], turned)
      call close_to('reference', &
         & [(turned(dofs%id(i, 7)), turned(dofs%id(i, 8)), turned(dofs%id(i, 9)), i=1, 2)], &
         & [(plain(dofs%id(i, 7)), plain(dofs%id(i, 8)), plain(dofs%id(i, 9)), i=1, 2)], 1.0e-14_wp)
   end subroutine followers_do_not_care_about_axes

   !> A row of squares whose nodes follow each other: 70 links.
   subroutine long_chains_are_resolved()
      character(len=:), allocatable :: text
      character(len=80) :: line
      integer :: i
      real(wp), allocatable :: v(:), u(:)

      call test('a chain of seventy equations ends at its free node')
      text = '*NODE'//nl
      do i = 0, 71
         write (line, '(i0,",",f6.1,",0.")') 2*i + 1, real(i, wp)
         text = text//trim(line)//nl
         write (line, '(i0,",",f6.1,",1.")') 2*i + 2, real(i, wp)
         text = text//trim(line)//nl
      end do
      text = text//'*ELEMENT, TYPE=CPE4, ELSET=E'//nl
      do i = 0, 70
         write (line, '(i0,4(",",i0))') i + 1, 2*i + 1, 2*i + 3, 2*i + 4, 2*i + 2
         text = text//trim(line)//nl
      end do
      text = text//'*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//'1., 0.'//nl// &
         & '*SOLID SECTION, ELSET=E, MATERIAL=M'//nl
      do i = 0, 69
         write (line, '("2",a,i0,",1,1.,",i0,",1,-1.01")') nl, 2*i + 1, 2*i + 3
         text = text//'*EQUATION'//nl//trim(line)//nl
      end do
      call constrain(text//ended)
      call is_true('no error', .not. allocated(error))
      if (allocated(error)) return
      allocate (v(self%neq), u(dofs%n), source=0.0_wp)
      v(findloc(self%dof_of_equation, dofs%id(1, 141), 1)) = 1.0_wp
      call expand(self, v, [real(wp) ::], u)
      call close_to('end of the chain', u(dofs%id(1, 1)), 1.01_wp**70, 1.0e-13_wp)
   end subroutine long_chains_are_resolved

   subroutine cycles_and_contradictions_are_refused()
      call test('what depends on itself, or is determined twice, is an error at its line')
      call refuse('*EQUATION'//nl//'2'//nl//'1, 1, 1., 2, 1, 1.'//nl//'2'//nl// &
         & '2, 1, 1., 1, 1, 1.'//nl)
      call refuse('*EQUATION'//nl//'2'//nl//'1, 1, 1., 2, 1, 1.'//nl//'2'//nl// &
         & '1, 1, 1., 3, 1, 1.'//nl)
      call refuse('*BOUNDARY'//nl//'1, 1'//nl//'*EQUATION'//nl//'2'//nl//'1, 1, 1., 2, 1, 1.'//nl)
      call refuse('*RIGID BODY, NSET=TOP, REF NODE=REF'//nl//'*BOUNDARY'//nl//'7, 1'//nl)
   end subroutine cycles_and_contradictions_are_refused

   subroutine refuse(text)
      character(len=*), intent(in) :: text
      call model_of(squares('CPE4')//text//ended, model, error)
      if (.not. allocated(error)) then
         call new_dofs(dofs, model)
         call new_constraints(self, model, dofs, model%step(1), error)
      end if
      call is_true('an error', allocated(error))
      if (allocated(error)) then
         call equal_text('code', error%item(1)%id, 'E0403')
         call is_true('a line', error%item(1)%at%line > 0)
      end if
   end subroutine refuse

   subroutine reduced_matrices_are_congruent()
      type(csc_type) :: k, reduced
      real(wp), allocatable :: t(:, :), dense(:, :), small(:, :), value(:), v(:)
      integer, allocatable :: i(:), j(:), number(:)
      integer :: n, a, b, e, kind
      character(len=:), allocatable :: text

      call test('the reduced matrix is T^T K T, with and without equations left out')
      do kind = 1, 2
         text = squares('CPE4')//mixed//ended
         if (kind == 2) text = squares('CPE4')//'*BOUNDARY'//nl//'1, 1'//nl//'6, 2'//nl//ended
         call constrain(text)
         call is_true('plain', self%plain .eqv. kind == 2)
         n = dofs%n
         i = [((a, a=b, n), b=1, n)]
         j = [((b, a=b, n), b=1, n)]
         value = numbers(size(i), 11)
         call k%new_from_triplets(n, storage%symmetric_lower, i, j, value)
         allocate (dense(n, n), t(n, self%neq), v(self%neq))
         call k%to_dense(dense)
         do e = 1, self%neq
            v = 0.0_wp
            v(e) = 1.0_wp
            call expand(self, v, spread(0.0_wp, 1, self%nprescribed), t(:, e))
         end do
         number = [(e, e=1, self%neq)]
         number(3:) = number(3:) - 1
         number(3) = 0
         number(4:) = [(e, e=3, self%neq - 1)]
         call reduce_matrix(k, self, number, self%neq - 1, reduced)
         allocate (small(self%neq - 1, self%neq - 1))
         call reduced%to_dense(small)
         t(:, 3:self%neq - 1) = t(:, 4:)
         t = t(:, :self%neq - 1)
         call close_to('matrix', small, matmul(transpose(t), matmul(dense, t)), 1.0e-12_wp)
         deallocate (dense, t, v, small)
      end do
   end subroutine reduced_matrices_are_congruent
end program test_constraints
