!> From decks in memory to models: what every keyword becomes.
program test_build_model
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type, error_code, severity
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_mesh, only : find_set, find_label
   use lopin_model, only : model_type, kind_of, overclosure_of, surface_of, output_of, &
      & initial_of
   use lopin_build_model, only : new_model
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none

   character(len=1), parameter :: nl = achar(10)
   !> Two unit squares, one on the other, that meet at y = 1 with nodes of their own.
   character(len=*), parameter :: squares = '*NODE, NSET=ALL'//nl//'1, 0., 1.'//nl//'2, 1., 1.' &
      & //nl &
      & //'3, 1., 2.'//nl//'4, 0., 2.'//nl//'5, 0., 0.'//nl//'6, 1., 0.'//nl//'7, 1., 1.'//nl &
      & //'8, 0., 1.'//nl &
      & //'*ELEMENT, TYPE=CPE4, ELSET=UP'//nl//'1, 1, 2, 3, 4'//nl &
      & //'*ELEMENT, TYPE=CPE4, ELSET=LOW'//nl//'2, 5, 6, 7, 8'//nl &
      & //'*NSET, NSET=TOP'//nl//'3, 4'//nl//'*NSET, NSET=BOTTOM'//nl//'5, 6'//nl &
      & //'*MATERIAL, NAME=STEEL'//nl//'*ELASTIC'//nl//'210000., 0.3'//nl &
      & //'*ELSET, ELSET=BOTH'//nl//'UP, LOW'//nl
   character(len=*), parameter :: solid = '*SOLID SECTION, ELSET=BOTH, MATERIAL=STEEL'//nl//'2.,' &
      & //nl
   character(len=*), parameter :: faces = '*SURFACE, NAME=SLAVE'//nl//'UP, S1'//nl &
      & //'*SURFACE, NAME=MASTER' &
      & //nl//'LOW, S3'//nl
   character(len=*), parameter :: held = '*BOUNDARY'//nl//'BOTTOM, 1, 2'//nl
   character(len=*), parameter :: step = '*STEP'//nl//'*STATIC'//nl//'*END STEP'//nl
   type(model_type) :: model
   type(error_type), allocatable :: error

   call meshes()
   call sets()
   call elements_over_lines()
   call parts()
   call sections()
   call surfaces()
   call tools()
   call rigid_bodies()
   call equations_and_axes()
   call methods()
   call pairs()
   call steps()
   call boundaries()
   call boundary_words()
   call loads()
   call outputs()
   call general()
   call errors_come_together()
   call finish()

contains

   subroutine build(text)
      character(len=*), intent(in) :: text
      type(deck_type) :: deck
      type(log_type) :: log

      call read_deck_text(deck, text, 'deck.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      if (allocated(error)) print '(a)', error%text()
      call is_true('no error', .not. allocated(error))
   end subroutine build

   !> The code of the first error of a deck.
   subroutine refuse(text, id)
      character(len=*), intent(in) :: text, id
      type(deck_type) :: deck
      type(log_type) :: log

      call read_deck_text(deck, text, 'deck.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      call is_true('an error '//id, allocated(error))
      if (allocated(error)) call equal_text('code', error%item(1)%id, id)
   end subroutine refuse

   subroutine meshes()
      call test('nodes, elements and their labels, whatever the order of the cards')
      call build(step//solid//squares//held)
      call is_true('two dimensions', model%mesh%ndim == 2 .and. model%kind == kind_of%plane_strain)
      call is_true('counts', model%mesh%nnode == 8 .and. model%mesh%nelement == 2)
      call is_true('connectivity', all(model%mesh%conn(:4, 2) == [5, 6, 7, 8]))
      call close_to('coordinates', model%mesh%x(:, 3), [1.0_wp, 2.0_wp], 0.0_wp)
      call equal_text('word', trim(model%element_word(model%mesh%etype(2))), 'CPE4')

      call test('labels need not be sorted')
      call build('*NODE'//nl//'30, 0., 0.'//nl//'10, 1., 0.'//nl//'20, 0., 1.'//nl &
         & //'*ELEMENT, TYPE=CAX3, ELSET=E' &
         & //nl//'7, 30, 10, 20'//nl//'*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//'1., 0.'//nl &
         & //'*SOLID SECTION, ELSET=E, MATERIAL=M'//nl//step)
      call is_true('indices in the order of the deck', all(model%mesh%conn(:3, 1) == [1, 2, 3]))
      call is_true('found by bisection', find_label(model%mesh%node_label, model%mesh%node_order, &
         & 20) == 3)
      call is_true('axisymmetric', model%kind == kind_of%axisymmetric)
   end subroutine meshes

   subroutine sets()
      integer :: k

      call test('sets: generated, of sets, of later sets, opened twice, of the nodes of elements')
      call build(squares//solid//step//'*NSET, NSET=A'//nl//'B, 1'//nl//'*NSET, NSET=B, GENERATE' &
         & //nl//'2, 6, 2'//nl &
         & //'*NSET, NSET=A'//nl//'1, 8'//nl//'*NSET, NSET=C, ELSET=LOW'//nl)
      k = find_set(model%mesh%nset, 'A')
      call is_true('A', all(model%mesh%nset(k)%member == [2, 4, 6, 1, 8]))
      k = find_set(model%mesh%nset, 'C')
      call is_true('C', all(model%mesh%nset(k)%member == [5, 6, 7, 8]))
      k = find_set(model%mesh%nset, 'ALL')
      call is_true('ALL', size(model%mesh%nset(k)%member) == 8)
      k = find_set(model%mesh%elset, 'BOTH')
      call is_true('BOTH', all(model%mesh%elset(k)%member == [1, 2]))
   end subroutine sets

   subroutine elements_over_lines()
      call test('an element of 20 nodes runs over two lines')
      call build(brick20()//step)
      call is_true('one element of 20 nodes', model%mesh%nelement == 1 &
         & .and. model%mesh%conn(20, 1) == 20)
      call is_true('in its set once', size(model%mesh%elset(1)%member) == 1)
      call is_true('solid', model%kind == kind_of%solid .and. model%mesh%ndim == 3)
   end subroutine elements_over_lines

   function brick20() result(text)
      character(len=:), allocatable :: text
      character(len=40) :: line
      integer :: i

      text = '*NODE'//nl
      do i = 1, 20
         write (line, '(i0,", ",i0,".,",i0,".,",i0,".")') i, i, i*i, i*i*i
         text = text//trim(line)//nl
      end do
      text = text//'*ELEMENT, TYPE=C3D20, ELSET=E'//nl//'1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10,'//nl &
         & //'11, 12, 13, 14, 15, 16, 17, 18, 19, 20'//nl//'*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl &
         & //'1., 0.'//nl &
         & //'*SOLID SECTION, ELSET=E, MATERIAL=M'//nl
   end function brick20

   subroutine parts()
      character(len=*), parameter :: part = '*PART, NAME=BLOCK'//nl//'*NODE'//nl//'1, 0., 0.'//nl &
         & //'2, 1., 0.'//nl &
         & //'3, 1., 1.'//nl//'4, 0., 1.'//nl//'*ELEMENT, TYPE=CPE4, ELSET=E'//nl//'1, 1, 2, 3, 4' &
         & //nl &
         & //'*SOLID SECTION, ELSET=E, MATERIAL=M'//nl//','//nl//'*SURFACE, NAME=TOP'//nl//'E, S3' &
         & //nl &
         & //'*END PART'//nl
      character(len=*), parameter :: material = '*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//'1., 0.' &
         & //nl
      integer :: k

      call test('two instances of a part: moved, turned, renumbered, named INSTANCE.NAME')
      call build(part//'*ASSEMBLY, NAME=A'//nl//'*INSTANCE, NAME=ONE, PART=BLOCK'//nl &
         & //'*END INSTANCE'//nl &
         & //'*INSTANCE, NAME=TWO, PART=BLOCK'//nl//'0., 1., 0.'//nl &
         & //'0., 1., 0., 0., 1., 1., 90.'//nl &
         & //'*END INSTANCE'//nl//'*NSET, NSET=FOOT, INSTANCE=ONE'//nl//'1, 2'//nl &
         & //'*ELSET, ELSET=_S, INTERNAL, INSTANCE=TWO'//nl//'1,'//nl &
         & //'*SURFACE, TYPE=ELEMENT, NAME=S'//nl//'_S, S1'//nl//'*END ASSEMBLY'//nl//material &
         & //step &
         & //'*BOUNDARY'//nl//'FOOT, 1, 2'//nl//'TWO.3, 1'//nl)
      call is_true('eight nodes, two elements', model%mesh%nnode == 8 &
         & .and. model%mesh%nelement == 2)
      call is_true('labels', all(model%mesh%node_label == [1, 2, 3, 4, 5, 6, 7, 8]))
      call close_to('turned about (0, 1)', model%mesh%x(:, 6), [0.0_wp, 2.0_wp], 1.0e-14_wp)
      k = find_set(model%mesh%elset, 'TWO.E')
      call is_true('TWO.E', k > 0)
      if (k > 0) call is_true('members', all(model%mesh%elset(k)%member == [2]))
      k = find_set(model%mesh%nset, 'FOOT')
      call is_true('FOOT', all(model%mesh%nset(k)%member == [1, 2]))
      call is_true('three surfaces', size(model%surface) == 3)
      call equal_text('name', model%surface(2)%name, 'TWO.TOP')
      call is_true('element of TWO', model%surface(2)%element(1) == 2 &
         & .and. model%surface(3)%element(1) == 2)
      call is_true('INSTANCE.number', size(model%step(1)%prescribed) == 5)
      call is_true('node 3 of TWO', model%step(1)%prescribed(5)%node == 7)
      call is_true('each with a section', all(model%mesh%section == [1, 2]))

      call test('one instance keeps its numbers')
      call build(part//'*ASSEMBLY, NAME=A'//nl//'*INSTANCE, NAME=ONE, PART=BLOCK'//nl &
         & //'*END INSTANCE'//nl &
         & //'*NODE'//nl//'100, 5., 5.'//nl//'*END ASSEMBLY'//nl//material//step)
      call is_true('labels', all(model%mesh%node_label == [1, 2, 3, 4, 100]))
   end subroutine parts

   subroutine sections()
      call test('sections: thickness, formulation, density')
      call build(squares//'*SOLID SECTION, ELSET=UP, MATERIAL=STEEL, CONTROLS=PLAIN'//nl//'2.5' &
         & //nl &
         & //'*SOLID SECTION, ELSET=LOW, MATERIAL=WOOD'//nl &
         & //'*SECTION CONTROLS, NAME=PLAIN, FORMULATION=FULL'//nl &
         & //'*MATERIAL, NAME=WOOD'//nl//'*ELASTIC'//nl//'1.D4, 0.2'//nl//'*DENSITY'//nl//'7.e-10' &
         & //nl//step)
      call close_to('thickness', model%section%thickness, [2.5_wp, 1.0_wp], 0.0_wp)
      call equal_text('full', model%section(1)%formulation, 'FULL')
      call equal_text('default', model%section(2)%formulation, '')
      call is_true('materials', all(model%section%material == [1, 2]))
      call close_to('wood', [model%material(2)%young, model%material(2)%poisson, &
         & model%material(2)%density], &
         & [1.0e4_wp, 0.2_wp, 7.0e-10_wp], 1.0e-15_wp)
      call is_true('elements', all(model%mesh%section == [1, 2]))
   end subroutine sections

   subroutine surfaces()
      call test('surfaces: faces of sets and elements, free faces, nodes with areas')
      call build(squares//solid//faces//step//'*SURFACE, NAME=SKIN'//nl//'BOTH,'//nl &
         & //'*SURFACE, NAME=MIX'//nl//'1, S2'//nl//'LOW, S2'//nl//'1, S2'//nl &
         & //'*SURFACE, NAME=POINTS, TYPE=NODE'//nl//'TOP, 0.5'//nl//'1,'//nl)
      call is_true('slave', model%surface(1)%kind == surface_of%faces &
         & .and. model%surface(1)%face(1) == 1)
      call is_true('all eight faces are free', size(model%surface(3)%face) == 8)
      call is_true('mixed, once each', all(model%surface(4)%element == [1, 2]) &
         & .and. all(model%surface(4)%face == 2))
      call is_true('nodes', all(model%surface(5)%node == [3, 4, 1]))
      call close_to('areas', model%surface(5)%area, [0.5_wp, 0.5_wp, 0.0_wp], 0.0_wp)

      call test('rigid elements have the faces SPOS and SNEG and need no section')
      call build(squares//solid//'*ELEMENT, TYPE=R2D2, ELSET=TOOL'//nl//'9, 3, 4'//nl &
         & //'*SURFACE, NAME=T'//nl//'TOOL, SPOS'//nl//'*NODE'//nl//'99, 0., 3.'//nl &
         & //'*RIGID BODY, ELSET=TOOL, REF NODE=99'//nl//step)
      call is_true('face 1', model%surface(1)%face(1) == 1 .and. model%mesh%section(3) == 0)
   end subroutine surfaces

   subroutine tools()
      character(len=*), parameter :: punch = '*SURFACE, NAME=PUNCH, TYPE=SEGMENTS'//nl &
         & //'START, 2., 2.'//nl &
         & //'LINE, -1., 2.'//nl

      call test('an analytical surface becomes a tool that follows its rigid body')
      call build(squares//solid//punch//'*NODE, NSET=REF'//nl//'99, 0., 3.'//nl &
         & //'*RIGID BODY, ANALYTICAL SURFACE=PUNCH, REF NODE=REF'//nl//step//'*BOUNDARY'//nl &
         & //'REF, 6'//nl)
      call is_true('surface', model%surface(1)%kind == surface_of%tool &
         & .and. model%surface(1)%tool == 1)
      call is_true('tool', size(model%tool) == 1 .and. model%tool(1)%rigid_body == 1)
      call is_true('two dimensions', model%tool(1)%shape%ndim == 2)
      call is_true('body', model%rigid_body(1)%tool == 1 .and. model%rigid_body(1)%reference == 9 &
         & .and. size(model%rigid_body(1)%node) == 0)
      call equal_text('name', model%rigid_body(1)%name, 'PUNCH')
      call is_true('its rotation', model%step(1)%prescribed(1)%dof == 6)
   end subroutine tools

   subroutine rigid_bodies()
      call test('a rigid body of elements or nodes: no section, its reference node does not follow')
      call build(squares//solid//'*NODE'//nl//'99, 0., 3.'//nl//'98, 0., 3.'//nl &
         & //'*RIGID BODY, ELSET=UP, REF NODE=99, ROT NODE=98'//nl &
         & //'*NSET, NSET=N'//nl//'5, 6'//nl//'*RIGID BODY, NSET=N, REF NODE=5'//nl//step &
         & //'*BOUNDARY'//nl//'98, 3'//nl)
      call is_true('sections', all(model%mesh%section == [0, 1]))
      call is_true('followers', all(model%rigid_body(1)%node == [1, 2, 3, 4]))
      call is_true('rotation node', model%rigid_body(1)%rotation == 10)
      call is_true('reference among the nodes', all(model%rigid_body(2)%node == [6]))
      call is_true('rotation about z', model%step(1)%prescribed(1)%dof == 3)
   end subroutine rigid_bodies

   subroutine equations_and_axes()
      real(wp), parameter :: s = sqrt(0.5_wp)

      call test('equations of nodes and of sets, over several lines')
      call build(squares//solid//step//'*EQUATION'//nl//'2'//nl//'TOP, 1, 1., BOTTOM, 1, -1.'//nl &
         & //'3'//nl &
         & //'1, 2, 1.,'//nl//'2, 2, -0.5, 3, 2, -0.5'//nl)
      call is_true('three', size(model%equation) == 3)
      call is_true('by pairs', all(model%equation(2)%node == [4, 6]))
      call close_to('coefficients', model%equation(3)%coefficient, [1.0_wp, -0.5_wp, -0.5_wp], &
         & 0.0_wp)

      call test('local axes: Cartesian from two points, cylindrical about an axis')
      call build(squares//solid//step//'*TRANSFORM, NSET=TOP'//nl//'1., 1., 0., -1., 1., 0.'//nl &
         & //'*NSET, NSET=ONE'//nl//'7,'//nl//'*TRANSFORM, NSET=ONE, TYPE=C'//nl &
         & //'0., 0., 0., 0., 0., 1.'//nl)
      call is_true('nodes', all(model%transform%node == [3, 4, 7]))
      call close_to('R', model%transform%axes(:, :, 1), reshape([s, -s, 0.0_wp, s, s, 0.0_wp, &
         & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3]), 1.0e-14_wp)
      call close_to('C at (1, 1)', model%transform%axes(:, :, 3), &
         & reshape([s, -s, 0.0_wp, s, s, 0.0_wp, &
         & 0.0_wp, 0.0_wp, 1.0_wp], [3, 3]), 1.0e-14_wp)
   end subroutine equations_and_axes

   subroutine methods()
      character(len=*), parameter :: words(10) = [character(len=44) :: 'DIRECT', 'PENALTY', &
         & 'PERTURBED LAGRANGE', &
         & 'AUGMENTED LAGRANGE', 'PRESSURE-OVERCLOSURE=HARD', 'PRESSURE-OVERCLOSURE=LINEAR', &
         & 'DIRECT, PRESSURE-OVERCLOSURE=LINEAR', 'PRESSURE-OVERCLOSURE=EXPONENTIAL', &
         & 'PRESSURE-OVERCLOSURE=TIED', &
         & 'NO SEPARATION']
      character(len=*), parameter :: expected(10) = [character(len=11) :: 'lagrange', 'penalty', &
         & 'perturbed', 'augmented', 'lagrange', 'penalty', 'perturbed', 'exponential', 'penalty', &
         & 'lagrange']
      integer :: law(10), i
      character(len=:), allocatable :: text

      law = overclosure_of%hard
      law([3, 6, 7]) = overclosure_of%linear
      law(8) = overclosure_of%exponential
      law(9) = overclosure_of%tied
      text = squares//solid//step
      do i = 1, size(words)
         text = text//'*SURFACE INTERACTION, NAME='//achar(64 + i)//nl//'*SURFACE BEHAVIOR, ' &
            & //trim(words(i))//nl
         if (i < 10) text = text//'1.e3, 2.e-1'//nl
      end do
      call test('the words of *SURFACE BEHAVIOR choose one of the four methods')
      call build(text)
      call is_true('all ten', size(model%interaction) == 10)
      do i = 1, size(words)
         call is_true(trim(words(i)), model%interaction(i)%method%word() == expected(i))
         call is_true(trim(words(i))//': law', model%interaction(i)%overclosure == law(i))
      end do
      call is_true('no separation', model%interaction(10)%no_separation)
      call close_to('slope', model%interaction(2)%slope, 1000.0_wp, 0.0_wp)
      call close_to('clearance of PENALTY', model%interaction(2)%clearance, 0.2_wp, 0.0_wp)
      call close_to('second datum of CalculiX', model%interaction(6)%clearance, 0.0_wp, 0.0_wp)
      call close_to('p0, c0', model%interaction(8)%table(:, 1), [0.2_wp, 1000.0_wp], 0.0_wp)

      call test('without *SURFACE BEHAVIOR contact is exact; a table is pressure, overclosure')
      call build(squares//solid//step//'*SURFACE INTERACTION, NAME=A'//nl//'1.,'//nl//'*FRICTION' &
         & //nl//'0.'//nl &
         & //'*SURFACE INTERACTION, NAME=B'//nl//'*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR' &
         & //nl//'0., 0.'//nl &
         & //'5., 0.1'//nl)
      call is_true('lagrange', model%interaction(1)%method%word() == 'lagrange')
      call close_to('table', model%interaction(2)%table(:, 2), [5.0_wp, 0.1_wp], 0.0_wp)
   end subroutine methods

   subroutine pairs()
      call test('pairs: sides, adjust, clearance, controls of one pair and of all')
      call build(squares//solid//faces//step//'*SURFACE INTERACTION, NAME=I'//nl &
         & //'*CONTACT PAIR, INTERACTION=I, ADJUST=0.1, SMALL SLIDING, EXTENSION ZONE=0.2'//nl &
         & //'SLAVE, MASTER'//nl &
         & //'*SURFACE, NAME=POINTS, TYPE=NODE'//nl//'1, 2'//nl &
         & //'*CONTACT PAIR, INTERACTION=I, ADJUST=TOP, TYPE=SURFACE TO SURFACE, TIED'//nl &
         & //'POINTS, MASTER'//nl &
         & //'*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=-0.02'//nl &
         & //'*CONTACT CONTROLS, MAX AUGMENTATIONS=7'//nl &
         & //'*CONTACT CONTROLS, SLAVE=POINTS, MASTER=MASTER, INITIAL=ERROR, ' &
         & //'RELATIVE PENETRATION TOLERANCE=1.e-4'//nl)
      call is_true('two pairs', size(model%pair) == 2)
      associate (a => model%pair(1), b => model%pair(2))
         call is_true('sides', a%slave == 1 .and. a%master == 2 .and. b%slave == 3 &
            & .and. a%interaction == 1)
         call close_to('adjust', [a%adjust, a%extension, a%clearance], [0.1_wp, 0.2_wp, &
            & -0.02_wp], 0.0_wp)
         call is_true('flags', a%small_sliding .and. .not. a%tied .and. b%tied &
            & .and. b%surface_to_surface)
         call is_true('clearance', a%has_clearance .and. .not. b%has_clearance)
         call is_true('adjust nodes', all(b%adjust_node == [3, 4]))
         call is_true('controls', a%control%max_augmentations == 7 &
            & .and. b%control%max_augmentations == 7)
         call is_true('initial', a%control%initial == initial_of%automatic &
            & .and. b%control%initial == initial_of%error)
         call close_to('tolerance', b%control%relative_penetration, 1.0e-4_wp, 0.0_wp)
      end associate
   end subroutine pairs

   subroutine steps()
      call test('steps: times, defaults, heading, amplitude')
      call build(squares//solid//'*STEP, NAME=PRESS, INC=7, AMPLITUDE=STEP'//nl//'slowly'//nl &
         & //'*STATIC, DIRECT'//nl &
         & //'0.25, 2.'//nl//'*END STEP'//nl//'*STEP'//nl//'*STATIC, SOLVER=UMFPACK'//nl &
         & //'0.1, 1., 1.e-3, 0.2'//nl &
         & //'*END STEP'//nl//'*STEP'//nl//'*STATIC'//nl//'*END STEP'//nl)
      associate (a => model%step(1), b => model%step(2), c => model%step(3))
         call close_to('direct', [a%initial, a%period, a%smallest, a%largest], [0.25_wp, 2.0_wp, &
            & 0.25_wp, 0.25_wp], &
            & 0.0_wp)
         call close_to('given', [b%initial, b%period, b%smallest, b%largest], [0.1_wp, 1.0_wp, &
            & 1.0e-3_wp, 0.2_wp], &
            & 0.0_wp)
         call close_to('default', [c%initial, c%period, c%smallest, c%largest], [1.0_wp, 1.0_wp, &
            & 1.0e-6_wp, 1.0_wp], &
            & 0.0_wp)
         call is_true('words', a%direct .and. .not. a%ramp .and. b%ramp .and. a%max_increments == 7)
         call equal_text('heading', a%heading, 'PRESS slowly')
      end associate
      call equal_text('solver', model%solver, 'UMFPACK')
   end subroutine steps

   subroutine boundaries()
      call test('conditions go on, are overridden, and vanish with an empty OP=NEW')
      call build(squares//solid//held//'*AMPLITUDE, NAME=A'//nl//'0., 0., 1., 0.5'//nl &
         & //'*AMPLITUDE, NAME=T, TIME=' &
         & //'TOTAL TIME'//nl//'0., 0., 3., 3.'//nl &
         & //'*STEP'//nl//'*STATIC'//nl//'*BOUNDARY, AMPLITUDE=A'//nl//'3, 2, 2, -0.2'//nl &
         & //'*BOUNDARY, AMPLITUDE=T'//nl//'4, 2, 2, -0.2'//nl//'*END STEP'//nl &
         & //'*STEP'//nl//'*STATIC'//nl//'*BOUNDARY'//nl//'5, 1, 1, 0.3'//nl//'*END STEP'//nl &
         & //'*STEP'//nl//'*STATIC'//nl//'*BOUNDARY, OP=NEW'//nl//'*BOUNDARY'//nl//'1, 1'//nl &
         & //'*END STEP'//nl)
      associate (a => model%step(1)%prescribed, b => model%step(2)%prescribed, &
         & c => model%step(3)%prescribed)
         call is_true('numbers', size(a) == 6 .and. size(b) == 6 .and. size(c) == 1)
         call close_to('with amplitude', [a(5)%value, real(a(5)%amplitude, wp)], [-0.2_wp, &
            & 1.0_wp], 0.0_wp)
         call close_to('held at its end', [b(5)%value, real(b(5)%amplitude, wp)], [-0.1_wp, &
            & 0.0_wp], 1.0e-15_wp)
         call close_to('total time runs on', [b(6)%value, real(b(6)%amplitude, wp)], [-0.2_wp, &
            & 2.0_wp], 0.0_wp)
         call is_true('overridden', any(b%node == 5 .and. b%dof == 1 &
            & .and. abs(b%value - 0.3_wp) < 1.0e-15_wp))
         call is_true('the line of the deck', b(5)%at%line > 0 .and. b(5)%at%line == a(5)%at%line)
         call is_true('new', c(1)%node == 1 .and. c(1)%dof == 1)
      end associate
   end subroutine boundaries

   subroutine boundary_words()
      call test('words prescribe the dofs of a node; dof 3 of a plane scene is noted and ignored')
      call build(squares//solid//step//'*BOUNDARY'//nl//'BOTTOM, ENCASTRE'//nl//'4, XSYMM'//nl &
         & //'3, 1, 3'//nl)
      associate (a => model%step(1)%prescribed)
         call is_true('count', size(a) == 7)
         call is_true('x only', a(5)%node == 4 .and. a(5)%dof == 1)
      end associate
      call is_true('a note', model%log%count_of(severity%note) == 1)
   end subroutine boundary_words

   subroutine loads()
      call test('loads: forces, pressures, body forces, gravity, tractions; OP; the list in force')
      call build(squares//solid//faces//'*STEP'//nl//'*STATIC'//nl//'*CLOAD'//nl//'TOP, 2, -5.' &
         & //nl//'3, 1, 1.'//nl//'*DLOAD'//nl//'UP, P3, 7.'//nl &
         & //'LOW, BY, -1.'//nl//'*DSLOAD'//nl//'SLAVE, P, 3.'//nl//'MASTER, TRVEC, 2., 0., -4.' &
         & //nl//'*END STEP'//nl &
         & //'*STEP'//nl//'*STATIC'//nl//'*CLOAD'//nl//'3, 2, -6.'//nl//'*DLOAD, OP=NEW'//nl &
         & //'*END STEP'//nl &
         & //'*STEP'//nl//'*STATIC'//nl//'*CLOAD, OP=NEW'//nl//'*DSLOAD'//nl//'SLAVE, P, 4.'//nl &
         & //'*END STEP'//nl)
      associate (a => model%step(1), b => model%step(2), c => model%step(3))
         call is_true('first', size(a%point_load) == 3 .and. size(a%face_load) == 3 &
            & .and. size(a%body_load) == 1)
         call close_to('pressure', a%face_load%pressure, [7.0_wp, 3.0_wp, 0.0_wp], 0.0_wp)
         call close_to('traction', a%face_load(3)%traction, [0.0_wp, -2.0_wp, 0.0_wp], 0.0_wp)
         call close_to('body force', a%body_load(1)%force, [0.0_wp, -1.0_wp, 0.0_wp], 0.0_wp)
         call is_true('second', size(b%point_load) == 3 .and. size(b%face_load) == 2 &
            & .and. size(b%body_load) == 0)
         call close_to('replaced', sum(b%point_load%value), -10.0_wp, 1.0e-15_wp)
         call is_true('third', size(c%point_load) == 0 .and. size(c%face_load) == 2)
         call close_to('pressure', sum(c%face_load%pressure), 4.0_wp, 0.0_wp)
      end associate

      call test('gravity is multiplied by the density')
      call build(squares//'*SOLID SECTION, ELSET=BOTH, MATERIAL=WOOD'//nl//'*MATERIAL, NAME=WOOD' &
         & //nl//'*ELASTIC'//nl &
         & //'1., 0.'//nl//'*DENSITY'//nl//'2.'//nl//'*STEP'//nl//'*STATIC'//nl//'*DLOAD'//nl &
         & //'UP, GRAV, 10., 0., -3.'//nl//'*END STEP'//nl)
      call close_to('force', model%step(1)%body_load(1)%force, [0.0_wp, -20.0_wp, 0.0_wp], &
         & 1.0e-15_wp)
      call refuse(squares//solid//'*STEP'//nl//'*STATIC'//nl//'*DLOAD'//nl &
         & //'UP, GRAV, 10., 0., -1.'//nl &
         & //'*END STEP'//nl, 'E0203')

      call test('two loads of one step at one place are added, with a note')
      call build(squares//solid//'*STEP'//nl//'*STATIC'//nl//'*CLOAD'//nl//'3, 1, 1.'//nl &
         & //'3, 1, 2.'//nl &
         & //'*END STEP'//nl)
      call is_true('both are in the list', size(model%step(1)%point_load) == 2)
      call is_true('a note', model%log%count_of(severity%note) == 1)
   end subroutine loads

   subroutine outputs()
      call test('output of both families; a step without requests goes on with those before')
      call build(squares//solid//faces//'*STEP'//nl//'*STATIC'//nl//'*NODE FILE, FREQUENCY=2'//nl &
         & //'U, RF'//nl &
         & //'*NODE PRINT, NSET=TOP, TOTALS=ONLY'//nl//'RF'//nl &
         & //'*CONTACT PRINT, SLAVE=SLAVE, MASTER=MASTER'//nl &
         & //'CDIS, CSTR'//nl//'*OUTPUT, FIELD, VARIABLE=PRESELECT, FREQUENCY=3'//nl &
         & //'*ELEMENT OUTPUT, ELSET=UP'//nl &
         & //'S'//nl//'*OUTPUT, HISTORY'//nl//'*NODE OUTPUT, NSET=BOTTOM'//nl//'U'//nl &
         & //'*END STEP'//nl//step)
      associate (a => model%step(1)%output)
         call is_true('kinds', all(a%kind == [output_of%node_file, output_of%node_print, &
            & output_of%contact_print, &
            & output_of%field, output_of%element_file, output_of%history, output_of%node_print]))
         call is_true('frequency', all(a%frequency == [2, 1, 1, 3, 3, 1, 1]))
         call equal_text('variables', trim(a(1)%variable(2)), 'RF')
         call is_true('no variables: the usual ones', size(a(4)%variable) == 0)
         call is_true('totals', a(2)%totals .and. a(2)%totals_only &
            & .and. a(2)%set == find_set(model%mesh%nset, 'TOP'))
         call is_true('surfaces', a(3)%slave == 1 .and. a(3)%master == 2)
         call is_true('set', a(5)%set == find_set(model%mesh%elset, 'UP'))
      end associate
      call is_true('second step', size(model%step(2)%output) == 7)
   end subroutine outputs

   subroutine general()
      call test('heading and *LOPIN')
      call build('*HEADING'//nl//'Two squares'//nl//squares//solid//step &
         & //'*LOPIN, PATH=NEWTON, SOLVER=CHOLMOD, TARGET ERROR=0.05, CONTINUATION=3'//nl)
      call equal_text('heading', model%heading, 'Two squares')
      call equal_text('path', model%path, 'NEWTON')
      call equal_text('solver', model%solver, 'CHOLMOD')
      call close_to('target', model%target_error, 0.05_wp, 0.0_wp)
      call is_true('continuation', model%continuation == 3)

      call test('a modulus alone tells no unit: weight beside stiffness does')
      call build('*NODE'//nl//'1, 0., 0.'//nl//'2, 120., 0.'//nl//'3, 0., 120.'//nl &
         & //'*ELEMENT, TYPE=CPS3, ELSET=E'//nl &
         & //'1, 1, 2, 3'//nl//'*MATERIAL, NAME=M'//nl//'*ELASTIC'//nl//'2.1e11, 0.3'//nl &
         & //'*SOLID SECTION, ELSET=E, MATERIAL=M'//nl//step)
      call is_true('no warning', model%log%count_of(severity%warning) == 0)
      call is_true('plane stress', model%kind == kind_of%plane_stress)
   end subroutine general

   subroutine errors_come_together()
      character(len=:), allocatable :: text
      integer :: i

      call test('errors of different cards are raised together, each with its place')
      call refuse(squares//'*SOLID SECTION, ELSET=BOTH, MATERIAL=STEAL'//nl//'*BOUNDARY'//nl &
         & //'TOPP, 1'//nl//step, &
         & 'E0201')
      call is_true('two', size(error%item) == 2)
      call is_true('code of exit', error%code == error_code%deck)
      call equal_text('guess', error%item(1)%label, 'did you mean STEEL ?')
      call is_true('place', error%item(2)%at%first == 1 .and. error%item(2)%at%last == 4)

      call test('no more than twenty errors')
      text = squares//solid//step//'*BOUNDARY'//nl
      do i = 1, 30
         text = text//'NOWHERE, 1'//nl
      end do
      call refuse(text, 'E0201')
      call is_true('twenty', size(error%item) == 20)
   end subroutine errors_come_together
end program test_build_model
