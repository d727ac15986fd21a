!> Points inside facets, and the rows that they make where facets meet creases of a tool.
program test_face_points
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_error, only : error_type, log_type
   use lopin_cells, only : cell_type, new_cell
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_tool, only : foot_type
   use lopin_model, only : model_type
   use lopin_build_model, only : new_model
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_friction, only : law_of
   use lopin_enforcement_factory, only : method_names, new_enforcement
   use lopin_face_points, only : face_points_type, new_face_points
   use lopin_face_rows, only : points_of_face
   use lopin_nonlinear_contact, only : nonlinear_contact_type, new_nonlinear_contact, cover_size
   use lopin_contact_history, only : start_increment
   use lopin_contact_evaluation, only : evaluate_contact
   use lopin_state, only : state_type, new_contact_state
   use contact_scenes, only : box, second_order_box
   use lopin_row_samples, only : basis_of
   use check, only : test, is_true, close_to, finish
   implicit none

   character(len=1), parameter :: nl = achar(10)
   real(wp), parameter :: pi = acos(-1.0_wp)
   type(model_type) :: model
   type(dofs_type) :: dofs
   type(nonlinear_contact_type) :: contact
   real(wp), allocatable :: u(:), z(:)         ! of the increment's end
   integer :: d, method, law, order, i

   call random_seed(size=i)
   call random_seed(put=[(4711*method, method=1, i)])
   call points('line2', reshape([0.3_wp, 0.1_wp, 1.1_wp, 0.7_wp], [2, 2]), .false., 1.5_wp)
   call points('line2', reshape([0.3_wp, 0.1_wp, 1.1_wp, 0.7_wp], [2, 2]), .true., 2.0_wp*pi*0.7_wp)
   call points('triangle', reshape([0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 1.0_wp, 0.5_wp, &
      & 1.5_wp, 1.0_wp], [3, 3]), .false., 1.5_wp)
   call points('quad', reshape([0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 1.0_wp, 1.5_wp, &
      & 1.0_wp, 1.0_wp, 0.2_wp, 1.3_wp, 1.0_wp], [3, 4]), .false., 1.875_wp)
   call points('line3', reshape([0.3_wp, 0.1_wp, 1.1_wp, 0.7_wp, 0.7_wp, 0.4_wp], [2, 3]), &
      & .true., 2.0_wp*pi*0.7_wp)
   call points('triangle6', reshape([0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 1.0_wp, 0.5_wp, &
      & 1.5_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 1.25_wp, 0.75_wp, 1.0_wp, 0.25_wp, 0.75_wp, &
      & 1.0_wp], [3, 6]), .false., 1.5_wp)
   call points('quad8', reshape([0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, &
      & 1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.5_wp, 1.0_wp, 1.0_wp, &
      & 1.0_wp, 1.0_wp, 0.0_wp, 0.5_wp, 1.0_wp], [3, 8]), .false., 2.0_wp)
   do d = 2, 3
      do order = 1, 2
         do method = 1, size(method_names)
            do law = 0, 1
               call rows()
            end do
         end do
      end do
   end do
   call finish()

contains

   !> Weights sum to the area, parts to the weights, and gaps of the shape functions come out as the
   !> rows of the nodes have them: of mid-side nodes, those of the transformed basis.
   subroutine points(name, x, axisymmetric, area)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: x(:, :), area
      logical, intent(in) :: axisymmetric
      type(cell_type) :: cell
      type(face_points_type) :: inside
      real(wp) :: gap(size(x, 2)), row(size(x, 2)), unit(size(x, 1)), share, c(2)
      logical :: found
      integer :: k, q, parts, mid

      call test('points inside a '//name)
      call new_cell(cell, name, found)
      share = merge(0.2_wp, 0.0_wp, cell%quadratic)
      c = basis_of(share)
      do parts = merge(4, 3, cell%quadratic), 8, merge(2, 1, cell%quadratic)
         call new_face_points(inside, cell, x, parts, axisymmetric, merge(1.0_wp, 1.5_wp, &
            & axisymmetric .or. name /= 'line2'), share)
         call close_to('area', sum(inside%weight), area, 1.0e-13_wp)
         call close_to('parts', sum(inside%part, dim=2), inside%weight, 1.0e-13_wp)
         call random_number(gap)
         row = gap
         do k = 1, cell%nnode - cell%ncorner
            mid = cell%ncorner + k
            row(mid) = c(1)*gap(mid) + c(2)*sum(gap(cell%edge(:, k)))
         end do
         call close_to('a gap', [(sum(inside%part(k, :)*matmul(gap, inside%shape)), &
            & k=1, size(gap))], inside%weight*row, 1.0e-13_wp)
         call random_number(unit)
         call close_to('places', [(dot_product(unit, inside%x(:size(unit), q)), q=1, inside%n)], &
            & matmul(matmul(unit, x), inside%shape), 1.0e-13_wp)
      end do
   end subroutine points

   !> A slab below a polygon; its facets are longer than those of the polygon.
   subroutine new_scene()
      type(deck_type) :: deck
      type(log_type) :: log
      type(error_type), allocatable :: error
      character(len=:), allocatable :: text
      character(len=60) :: line
      integer :: k

      if (d == 2) then
         text = '*NODE, NSET=REF'//nl//'900000, 0., 5.'//nl
         if (order == 1) text = text//box('UP', 0, [-4.0_wp, -2.0_wp], [4.0_wp, 0.0_wp], [7, 2], &
            & 0.0_wp)
         if (order == 2) text = text//second_order_box('UP', [-4.0_wp, -2.0_wp], &
            & [4.0_wp, 0.0_wp], [5, 1])
         text = text//'*SURFACE, NAME=TOOL, TYPE=SEGMENTS'//nl
      else
         text = '*NODE, NSET=REF'//nl//'900000, 0., 0.5, 5.'//nl
         if (order == 1) text = text//box('UP', 0, [-2.0_wp, 0.0_wp, -1.0_wp], &
            & [2.0_wp, 1.0_wp, 0.0_wp], [4, 1, 1], 0.0_wp)
         if (order == 2) text = text//second_order_box('UP', [-2.0_wp, 0.0_wp, -1.0_wp], &
            & [2.0_wp, 1.0_wp, 0.0_wp], [2, 1, 1])
         text = text//'*SURFACE, NAME=TOOL, TYPE=CYLINDER'//nl//'0., 0., 0., 1., 0., 0.'//nl &
            & //'0., -1., 0.'//nl
      end if
      do k = 10, -10, -1
         write (line, '(a,f0.3,", ",f0.6)') merge('START, ', 'LINE,  ', k == 10), 0.57_wp*k, &
            & (0.57_wp*k)**2/40.0_wp
         text = text//trim(line)//nl
      end do
      text = text//'*RIGID BODY, ANALYTICAL SURFACE=TOOL, REF NODE=900000'//nl &
         & //'*MATERIAL, NAME=STEEL'//nl//'*ELASTIC'//nl//'1000., 0.3'//nl &
         & //'*SOLID SECTION, ELSET=UP, MATERIAL=STEEL'//nl &
         & //'*SURFACE INTERACTION, NAME=TOUCH'//nl//'*CONTACT PAIR, INTERACTION=TOUCH'//nl &
         & //'UPF, TOOL'//nl//'*BOUNDARY'//nl//'UPBOT, 2'//nl &
         & //'*STEP, NLGEOM'//nl//'*STATIC'//nl//'0.5, 1.'//nl//'*END STEP'//nl
      call read_deck_text(deck, text, 'scene.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      call is_true('the deck is read', .not. allocated(error))
      call new_enforcement(model%interaction(1)%method, trim(method_names(method)))
      model%interaction%friction%law = merge(law_of%coulomb, law_of%none, law == 1)
      model%interaction%friction%mu = 0.2_wp
      call new_dofs(dofs, model)
      call new_nonlinear_contact(contact, model, dofs, log, error)
      call is_true('the contact is made', .not. allocated(error))
   end subroutine new_scene

   !> An increment in which the polygon comes down, turned in three dimensions if `turns`.
   subroutine press(turns)
      logical, intent(in) :: turns
      type(error_type), allocatable :: error
      type(state_type) :: accepted
      real(wp) :: start(dofs%n)
      integer :: k, body

      call new_contact_state(accepted%contact, contact%nmultiplier, cover_size(contact), &
         & contact%touches)
      call random_number(start)
      start = 0.02_wp*(start - 0.5_wp)
      body = model%rigid_body(1)%reference
      do k = 4, 6
         if (dofs%id(k, body) > 0) start(dofs%id(k, body)) = 0.0_wp
      end do
      start(dofs%id(d, body)) = -0.05_wp
      if (allocated(u)) deallocate (u, z)
      allocate (u(dofs%n), z(contact%nmultiplier))
      call random_number(u)
      u = start + 0.02_wp*(u - 0.5_wp)
      do k = 4, 6
         if (dofs%id(k, body) > 0) u(dofs%id(k, body)) = merge(0.01_wp*k, 0.0_wp, turns)
      end do
      u(dofs%id(d, body)) = -0.12_wp
      call random_number(z)
      z = 0.2_wp*(z - 0.5_wp)
      do k = 1, contact%n
         if (contact%first_row(k) > 0) z(contact%first_row(k) + d - 1) = -1.0_wp
      end do
      call start_increment(contact, model, accepted%contact, start, 0.5_wp, error)
      call evaluate_contact(contact, model, u, z, .true., error)
      call is_true('evaluated', .not. allocated(error))
   end subroutine press

   subroutine rows()
      character(len=:), allocatable :: name
      integer, parameter :: nway = 3           ! none of them leaves out an entry of the matrix
      real(wp), allocatable :: way(:, :), difference(:, :)
      logical :: turns, smooth
      integer :: try

      name = trim(method_names(method))//merge(', plane', ', space', d == 2)//merge(', friction', &
         & '          ', law == 1)//merge(', second order', '              ', order == 2)
      do i = 0, 1
         turns = i == 1
         call test(name//': rows of points inside faces')
         do try = 1, 20
            call new_scene()
            call press(turns)
            if (allocated(way)) deallocate (way)
            allocate (way(dofs%n + size(z), nway))
            call random_number(way)
            way = 2.0_wp*way - 1.0_wp
            call differences_along(way, difference, smooth)
            if (smooth) exit
         end do
         call is_true('there is a smooth draw', smooth)
         if (.not. turns) call gaps_are_those_of_the_points()
         call slopes_equal(way, difference)
         if (law == 0) call forces_balance()
      end do
   end subroutine rows

   !> The tool stands without rotation.
   subroutine gaps_are_those_of_the_points()
      type(face_points_type) :: inside
      type(foot_type) :: foot
      real(wp) :: gap(contact%n), part(contact%n), place(3), up(d)
      integer :: f, k, q

      gap = 0.0_wp
      part = 0.0_wp
      up = u([(dofs%id(k, model%rigid_body(1)%reference), k=1, d)])
      do f = 1, size(contact%face)
         associate (face => contact%face(f), node => contact%face(f)%node(:contact%face(f)%nnode))
            ! Facets in the middle meet the polygon with all nodes.
            if (.not. all([(allocated(contact%opposite(face%point(k))%inner), k=1, face%nnode)])) &
               & cycle
            call points_of_face(inside, face, model, contact%masters%start_x)
            do q = 1, inside%n
               place = 0.0_wp
               place(:d) = matmul(contact%masters%x(:, node), inside%shape(:, q)) - up
               call model%tool(1)%shape%project(place(:d), foot)
               do k = 1, face%nnode
                  associate (at => face%point(k))
                     part(at) = part(at) + inside%part(k, q)/contact%weight(at)
                     gap(at) = gap(at) + inside%part(k, q)/contact%weight(at)*foot%gap
                  end associate
               end do
            end do
         end associate
      end do
      do k = 1, contact%n
         if (.not. allocated(contact%opposite(k)%inner)) cycle
         ! A facet whose rows have no points of their own leaves part of the row to its node.
         if (abs(part(k) - contact%opposite(k)%inner%c) > 1.0e-10_wp) cycle
         if (allocated(contact%opposite(k)%sample)) then
            if (any(contact%opposite(k)%sample%continued)) cycle
         end if
         call close_to('gap', contact%gap(k), gap(k) + (1.0_wp - part(k))*base_gap(k), 1.0e-12_wp)
      end do
      call is_true('there are such rows', any(part > 0.5_wp))
   end subroutine gaps_are_those_of_the_points

   !> Normals of the planes that points inside faces meet, by rows.
   function planes_met() result(planes)
      real(wp) :: planes(contact%n)
      integer :: k, m

      planes = 0.0_wp
      do k = 1, contact%n
         if (.not. allocated(contact%opposite(k)%inner)) cycle
         associate (row => contact%opposite(k)%inner)
            planes(k) = sum([(m*row%normal(:, m), m=1, size(row%node))])
         end associate
      end do
   end function planes_met

   !> Gap of a row without points inside facets.
   real(wp) function base_gap(k) result(gap)
      integer, intent(in) :: k

      gap = contact%opposite(k)%foot%gap
      if (.not. allocated(contact%opposite(k)%sample)) return
      associate (other => contact%opposite(k)%sample)
         gap = (1.0_wp - sum(other%c))*gap + sum(other%c*other%foot%gap)
      end associate
   end function base_gap

   !> Fourth-order differences of all forces and rows along `way`s in all unknowns at once.
   subroutine differences_along(way, difference, smooth)
      real(wp), intent(in) :: way(:, :)        !! a way in each column, entries from -1 to 1
      real(wp), allocatable, intent(out) :: difference(:, :)
      logical, intent(out) :: smooth           !! no status and no segment changes
      real(wp), parameter :: h = 0.5e-5_wp, far(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp], &
         & share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:), planes(:)
      integer :: m, j, n, status(contact%n), segment(contact%n)

      n = dofs%n
      allocate (difference(n + size(z), size(way, 2)), source=0.0_wp)
      status = contact%status
      segment = contact%opposite%foot%segment
      planes = planes_met()
      smooth = .true.
      do m = 1, size(way, 2)
         do j = 1, 4
            x = [u, z] + far(j)*h*way(:, m)
            call evaluate_contact(contact, model, x(:n), x(n + 1:), .false., error)
            difference(:, m) = difference(:, m) + share(j)/h*[-contact%force, contact%row]
            smooth = smooth .and. all(contact%status == status) &
               & .and. all(contact%opposite%foot%segment == segment) &
               & .and. maxval(abs(planes_met() - planes)) < 1.0e-12_wp
         end do
      end do
      call evaluate_contact(contact, model, u, z, .true., error)
   end subroutine differences_along

   subroutine slopes_equal(way, difference)
      real(wp), intent(in) :: way(:, :), difference(:, :)
      real(wp) :: k(size(way, 1), size(way, 1)), slope(size(way, 1), size(way, 2))
      integer :: l, n

      n = dofs%n
      k = 0.0_wp
      do l = 1, contact%nlocal
         associate (own => contact%local(l))
            k(own%dof, own%dof) = k(own%dof, own%dof) + own%k
         end associate
      end do
      call is_true('something presses', maxval(abs(k(:n, :))) > 0.0_wp)
      slope = matmul(k, way)
      call close_to('d force', slope(:n, :)/maxval(abs(k(:n, :))), difference(:n, :) &
         & /maxval(abs(k(:n, :))), 1.0e-8_wp)
      if (size(z) > 0) call close_to('d row', slope(n + 1:, :)/maxval(abs(k(n + 1:, :))), &
         & difference(n + 1:, :)/maxval(abs(k(n + 1:, :))), 1.0e-8_wp)
   end subroutine slopes_equal

   !> Pressures act along one line on the slave and on the tool.
   subroutine forces_balance()
      real(wp) :: total(3), moment(3), force(3), at(3)
      integer :: node, k

      total = 0.0_wp
      moment = 0.0_wp
      do node = 1, size(dofs%id, 2)
         force = 0.0_wp
         at = 0.0_wp
         do k = 1, d
            if (dofs%id(k, node) == 0) cycle
            force(k) = contact%force(dofs%id(k, node))
            at(k) = model%mesh%x(k, node) + u(dofs%id(k, node))
         end do
         total = total + force
         moment = moment + cross(at, force)
         do k = 4, 6
            if (dofs%id(k, node) > 0) moment(k - 3) = moment(k - 3) &
               & + contact%force(dofs%id(k, node))
         end do
      end do
      call close_to('forces', total/maxval(abs(contact%force)), 0.0_wp*total, 1.0e-12_wp)
      if (d == 2) moment(:2) = 0.0_wp
      call close_to('moments', moment/maxval(abs(contact%force)), 0.0_wp*moment, 1.0e-12_wp)
   end subroutine forces_balance
end program test_face_points
