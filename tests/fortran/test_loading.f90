!> Loads and prescribed displacements as functions of time.
program test_loading
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_csc, only : csc_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_constraints, only : constraints_type, new_constraints
   use lopin_state, only : state_type
   use lopin_solids, only : solids_type, solid_section_type, new_solids
   use lopin_loading, only : loading_type, new_loading, loads_at, prescribed_at, carry_loads
   use constraint_scenes, only : model_of, squares, nl
   use check, only : test, close_to, is_true, finish
   implicit none

   character(len=*), parameter :: tent = '*AMPLITUDE, NAME=TENT'//nl//'0., 0., 1., 1., 2., 0.5'//nl
   character(len=*), parameter :: clock = '*AMPLITUDE, NAME=CLOCK, TIME=TOTAL TIME'//nl// &
      & '0., 0., 4., 4.'//nl
   type(model_type) :: model
   type(dofs_type) :: dofs
   type(solids_type) :: solids
   type(constraints_type) :: constraints
   type(state_type) :: state

   call test('loads go from the old value to the new one over the step')
   call load(step('', '*CLOAD'//nl//'7, 2, 10.'//nl)//step('', '*CLOAD'//nl//'7, 2, 4.'//nl// &
      & '8, 2, 2.'//nl) &
      & //step('', '*CLOAD, OP=NEW'//nl//'8, 2, 6.'//nl))
   call follow(1, 7, [2.5_wp, 5.0_wp, 10.0_wp])
   call follow(2, 7, [8.5_wp, 7.0_wp, 4.0_wp])
   call test('with OP=NEW what is not repeated goes to zero')
   call follow(3, 7, [3.0_wp, 2.0_wp, 0.0_wp])
   call test('AMPLITUDE=STEP is at once')
   call load(step(', AMPLITUDE=STEP', '*CLOAD'//nl//'7, 2, 10.'//nl))
   call follow(1, 7, [10.0_wp, 10.0_wp, 10.0_wp])
   call test('an amplitude in step time is held where its step ends, in total time it runs on')
   call load(tent//clock//step('', '*CLOAD, AMPLITUDE=TENT'//nl//'7, 2, 10.'//nl// &
      & '*CLOAD, AMPLITUDE=CLOCK'//nl &
      & //'8, 2, 1.'//nl)//step('', ''))
   call follow(1, 7, [5.0_wp, 10.0_wp, 5.0_wp])
   call follow(2, 7, [5.0_wp, 5.0_wp, 5.0_wp])
   call follow(2, 8, [2.5_wp, 3.0_wp, 4.0_wp])
   call test('a load that loses its amplitude goes on from its last value')
   call load(clock//step('', '*CLOAD, AMPLITUDE=CLOCK'//nl//'8, 2, 5.'//nl)// &
      & step('', '*CLOAD, OP=NEW'//nl))
   call follow(1, 8, [2.5_wp, 5.0_wp, 10.0_wp])
   call follow(2, 8, [7.5_wp, 5.0_wp, 0.0_wp])
   call test('a load given again with an amplitude is replaced at once')
   call load(tent//step('', '*CLOAD'//nl//'7, 2, 8.'//nl)// &
      & step('', '*CLOAD, AMPLITUDE=TENT'//nl//'7, 2, 10.'//nl))
   call follow(1, 7, [2.0_wp, 4.0_wp, 8.0_wp])
   call follow(2, 7, [5.0_wp, 10.0_wp, 5.0_wp])
   call test('and so is one of another kind on the same element, not those beside it')
   call load(tent//step('', '*DLOAD'//nl//'2, BY, 8.'//nl//'2, BX, 1.'//nl)// &
      & step('', '*DLOAD, AMPLITUDE=TENT'//nl//'2, BX, 10.'//nl))
   call follow(1, 7, 0.25_wp*[2.0_wp, 4.0_wp, 8.0_wp])
   call follow(2, 7, 0.25_wp*[8.0_wp, 8.0_wp, 8.0_wp])
   call test('a load on a face that ends with its amplitude goes out beside one that begins')
   call load(clock//tent//step('', '*DSLOAD, AMPLITUDE=CLOCK'//nl//'LID, P, 2.'//nl)// &
      & step('', '*DSLOAD, OP=NEW'//nl//'*DLOAD, AMPLITUDE=TENT'//nl//'UP, P3, 2.'//nl))
   call follow(1, 7, -0.5_wp*[1.0_wp, 2.0_wp, 4.0_wp])
   call follow(2, 7, -0.5_wp*[1.0_wp + 3.0_wp, 2.0_wp + 2.0_wp, 1.0_wp])
   call test('a prescribed displacement goes on from where the node is')
   call load(step('', '*BOUNDARY'//nl//'7, 2, 2, 3.'//nl))
   state%motion%u(dofs%id(2, 7)) = 1.0_wp
   call place([1.5_wp, 2.0_wp, 3.0_wp])
   call test('a force in local axes acts along them')
   call load('*TRANSFORM, NSET=TOP'//nl//'0.6, 0.8, 0., -0.8, 0.6, 0.'//nl// &
      & step('', '*CLOAD'//nl//'7, 1, 10.'//nl))
   call follow(1, 7, 0.8_wp*[2.5_wp, 5.0_wp, 10.0_wp])
   call finish()

contains

   !> A step of period 2.
   function step(words, cards) result(text)
      character(len=*), intent(in) :: words, cards
      character(len=:), allocatable :: text
      text = '*STEP'//words//nl//'*STATIC'//nl//'0.5, 2.'//nl//cards//'*END STEP'//nl
   end function step

   subroutine load(steps)
      character(len=*), intent(in) :: steps
      type(error_type), allocatable :: error
      type(csc_type) :: k
      type(solid_section_type) :: section(2)

      call model_of(squares('CPE4')//'*SURFACE, NAME=LID'//nl//'UP, S3'//nl//'*BOUNDARY'//nl// &
         & 'BOTTOM, 1, 2'//nl//steps, model, error)
      if (allocated(error)) print '(a)', error%text()
      call is_true('the deck is read', .not. allocated(error))
      call new_dofs(dofs, model)
      section%young = 1.0_wp
      section%poisson = 0.3_wp
      section%thickness = 1.0_wp
      section(1)%formulation = ''
      section(2)%formulation = ''
      call new_solids(solids, model%mesh, model%element_word, section, dofs%id, k, error)
      call is_true('solids', .not. allocated(error))
      state%loads%steady = spread(0.0_wp, 1, dofs%n)
      state%motion%u = state%loads%steady
      state%clock%start = 0.0_wp
   end subroutine load

   !> The vertical force on a node at times 0.5, 1 and 2 of a step; then the step is over.
   subroutine follow(number, node, expected)
      integer, intent(in) :: number, node
      real(wp), intent(in) :: expected(3)
      type(loading_type) :: self
      type(error_type), allocatable :: error
      real(wp) :: f(dofs%n), after(dofs%n), found(3)
      real(wp), parameter :: times(3) = [0.5_wp, 1.0_wp, 2.0_wp]
      integer :: i

      call new_constraints(constraints, model, dofs, model%step(number), error)
      state%clock%start = 2.0_wp*(number - 1)
      call new_loading(self, model, dofs, constraints, solids, model%step(number), state)
      do i = 1, 3
         call loads_at(self, model, times(i), f, after)
         found(i) = f(dofs%id(2, node))
      end do
      call close_to('force', found, expected, 1.0e-13_wp)
      if (number == size(model%step)) return
      state%loads%steady = after
      call carry_loads(self, model, dofs, constraints, solids, model%step(number), &
         & model%step(number + 1), state%loads%steady)
   end subroutine follow

   subroutine place(expected)
      real(wp), intent(in) :: expected(3)
      type(loading_type) :: self
      type(error_type), allocatable :: error
      real(wp), allocatable :: value(:)
      real(wp), parameter :: times(3) = [0.5_wp, 1.0_wp, 2.0_wp]
      integer :: i

      call new_constraints(constraints, model, dofs, model%step(1), error)
      call new_loading(self, model, dofs, constraints, solids, model%step(1), state)
      allocate (value(constraints%nprescribed))
      do i = 1, 3
         call prescribed_at(self, model, times(i), value)
         call close_to('place', value(findloc(constraints%dof_of_prescribed, dofs%id(2, 7), 1)), &
            & expected(i), 1.0e-14_wp)
      end do
   end subroutine place
end program test_loading
