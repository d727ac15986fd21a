!> Motions that nothing holds: how many, which, and that they strain nothing.
program test_bodies
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_constraints, only : constraints_type, new_constraints, expand
   use lopin_bodies, only : bodies_type, new_bodies
   use lopin_body_words, only : describe_motion
   use constraint_scenes, only : model_of, squares, cube, ended, nl
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none

   character(len=*), parameter :: held = '*BOUNDARY'//nl//'BOTTOM, 1, 2'//nl
   character(len=*), parameter :: tool = '*SURFACE, NAME=DIE, TYPE=SEGMENTS'//nl// &
      & 'START, -3., 3.'//nl// &
      & 'LINE, 3., 3.'//nl//'*RIGID BODY, ANALYTICAL SURFACE=DIE, REF NODE=REF'//nl
   type(model_type) :: model
   type(bodies_type) :: self

   call test('free bodies have 3 motions in the plane, 6 in space, 1 in an axisymmetric scene')
   call counts(squares('CPE4')//held, 3)
   call counts(squares('CPS4'), 6)
   call counts(cube(), 6)
   call counts(squares('CAX4')//'*BOUNDARY'//nl//'1, 2'//nl, 1)
   call equal_text('words', describe_motion(self, model, [1.0_wp]), &
      & 'body UP can move along the axis (z)')
   call test('a body held in one node turns about it; on rollers it moves along them')
   call counts(squares('CPE4')//held//'*BOUNDARY'//nl//'5, 1, 2'//nl, 1)
   call is_true('turns', index(describe_motion(self, model, [1.0_wp]), 'turn about z') > 0)
   call counts(squares('CPE4')//held//'*BOUNDARY'//nl//'5, 2'//nl//'6, 2'//nl, 1)
   call equal_text('words', describe_motion(self, model, [1.0_wp]), 'body UP can move along x')
   call test('equations hold one body by another')
   call counts(squares('CPE4')//held//'*EQUATION'//nl//'2'//nl//'5, 1, 1., 4, 1, -1.'//nl//'2'// &
      & nl// &
      & '5, 2, 1., 4, 2, -1.'//nl, 1)
   call counts(squares('CPE4')//held//'*EQUATION'//nl//'2'//nl//'5, 1, 1., 4, 1, -1.'//nl//'2'// &
      & nl// &
      & '5, 2, 1., 4, 2, -1.'//nl//'2'//nl//'6, 2, 1., 3, 2, -1.'//nl, 0)
   call test('a tool has the motions of its reference node that are not prescribed')
   call counts(squares('CPE4')//held//'*BOUNDARY'//nl//'5, 1, 2'//nl//'6, 2'//nl//tool, 3)
   call counts(squares('CPE4')//held//'*BOUNDARY'//nl//'5, 1, 2'//nl//'6, 2'//nl//tool// &
      & '*BOUNDARY'//nl// &
      & 'REF, 1'//nl//'REF, 6'//nl, 1)
   call equal_text('words', describe_motion(self, model, [1.0_wp]), &
      & 'rigid body DIE can move along y')
   call test('a rigid row on a body adds no motion; a reference node inside the body neither')
   call counts(squares('CPE4')//held//'*RIGID BODY, NSET=TOP, REF NODE=REF'//nl, 3)
   call counts(squares('CPE4')//held//'*RIGID BODY, NSET=TOP, REF NODE=5'//nl, 3)
   call counts(cube()//'*RIGID BODY, NSET=TOP, REF NODE=REF'//nl//'*BOUNDARY'//nl//'REF, 1, 3'// &
      & nl, 3)
   call counts(cube()//'*RIGID BODY, NSET=TOP, REF NODE=1'//nl//'*BOUNDARY'//nl//'1, 1, 3'//nl, 3)
   call test('local axes: a roller at 37 degrees holds as much as a straight one')
   call counts(squares('CPE4')//held//'*TRANSFORM, NSET=TOP'//nl//'0.8, 0.6, 0., -0.6, 0.8, 0.'// &
      & nl// &
      & '*BOUNDARY'//nl//'TOP, 2'//nl, 1)
   call finish()

contains

   !> The number of motions, and that each moves every body and follower rigidly and every support
   !> not.
   subroutine counts(text, number)
      character(len=*), intent(in) :: text
      integer, intent(in) :: number
      type(error_type), allocatable :: error
      type(dofs_type) :: dofs
      type(constraints_type) :: constraints
      real(wp), allocatable :: u(:)
      integer :: q, e, a, b, i, n

      call model_of(text//ended, model, error)
      call is_true('the deck is read', .not. allocated(error))
      if (allocated(error)) return
      call new_dofs(dofs, model)
      call new_constraints(constraints, model, dofs, model%step(1), error)
      call is_true('constraints', .not. allocated(error))
      call new_bodies(self, model, dofs, constraints)
      call close_to('motions', real(self%nq, wp), real(number, wp), 0.0_wp)
      call is_true('as many supports, all different', size(self%support) == self%nq .and. &
         & all([(count(self%support == self%support(i)) == 1, i=1, self%nq)]))
      n = model%mesh%ndim
      allocate (u(dofs%n))
      do q = 1, self%nq
         call expand(constraints, self%motion(:, q), spread(0.0_wp, 1, constraints%nprescribed), u)
         do e = 1, model%mesh%nelement
            do a = 1, 4
               do b = 1, a - 1
                  associate (i => model%mesh%conn(a, e), j => model%mesh%conn(b, e))
                     call close_to('no length changes', dot_product(model%mesh%x(:, i) &
                        & - model%mesh%x(:, j), &
                        & u(dofs%id(:n, i)) - u(dofs%id(:n, j))), 0.0_wp, 1.0e-10_wp)
                  end associate
               end do
            end do
         end do
      end do
   end subroutine counts
end program test_bodies
