!> One contact point at finite sliding: exact tangents of every method, law, facet and tool.
program test_contact_point
   use lopin_kinds, only : wp
   use lopin_dense, only : symmetric_eigen
   use lopin_friction, only : friction_type, law_of, law_names, regularization_names, &
      & regularization_of
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_contact_row, only : contact_status
   use lopin_projection, only : place
   use lopin_rigid_motion, only : rotation_matrix
   use point_scenes, only : point_scene_type, master_names, grip_names, new_point_scene, look, &
      & random, tied_grip
   use check, only : test, close_to, is_true, finish
   implicit none

   integer :: i, n

   call random_seed(size=n)
   call random_seed(put=[(4711*i, i=1, n)])
   call tangents()
   call tangents_of_mid_side_nodes()
   call tangents_of_what_rolls()
   call perturbed_is_penalty()
   call no_coefficient()
   call sticks_between_two_ways()
   call turned_scenes()
   call alone_on_tools()
   call finish()

contains

   pure type(friction_type) function law_with(number, regularization) result(law)
      integer, intent(in) :: number, regularization
      law%law = number
      law%mu = 0.3_wp
      law%m = 0.2_wp
      law%alpha = 1.0_wp
      law%q = 0.4_wp
      law%elastic_slip = 0.03_wp
      law%regularization = regularization
      if (number == law_of%norton_hoff .and. regularization /= regularization_of%linear) &
         & law%v0 = 0.05_wp
   end function law_with

   subroutine tangents()
      type(point_scene_type) :: scene
      integer :: kind, master, law, regularization, draw
      integer, parameter :: ntool = 14         ! behind them patches, of many nodes

      do kind = 1, size(grip_names)
         do master = 1, size(master_names)
            do law = 0, size(law_names)
               do regularization = 1, size(regularization_names)
                  if (law == 0 .and. regularization > 1) cycle
                  if (master > ntool .and. regularization > 2) cycle
                  if (kind == tied_grip .and. law > 0) cycle
                  do draw = 1, merge(1, 2, master > ntool)
                     call new_point_scene(scene, trim(master_names(master)), kind)
                     scene%friction = law_with(law, regularization)
                     if (law == 0) scene%friction%law = law_of%none
                     if (draw == 2) then
                        scene%enforcement%elastic_slip = 0.01_wp
                        scene%enforcement%elastic(:scene%ndim) = random(scene%ndim, 0.01_wp)
                        if (law == law_of%coulomb) scene%friction%tau_max = 1.0_wp
                     end if
                     if (law > 0) call let_grow(scene)
                     call one_tangent(scene, trim(grip_names(kind))//' on '// &
                        & trim(master_names(master))//', law '//achar(48 + law)//achar(48 &
                        & + regularization), draw)
                  end do
               end do
            end do
         end do
      end do
   end subroutine tangents

   !> An area that follows all dofs.
   subroutine let_grow(scene)
      type(point_scene_type), intent(inout) :: scene
      integer :: i

      scene%points%growth(1)%dof = [(i, i=1, scene%dofs%n)]
      scene%points%growth(1)%slope = random(scene%dofs%n, 0.5_wp)
   end subroutine let_grow

   !> Rows of three places, of every method and law on every tool.
   subroutine tangents_of_mid_side_nodes()
      type(point_scene_type) :: scene
      integer :: kind, master, law
      integer, parameter :: first_tool = 7, last_tool = 14

      do kind = 1, size(grip_names)
         do master = first_tool, last_tool
            do law = 0, size(law_names)
               if (kind == tied_grip .and. law > 0) cycle
               call new_point_scene(scene, trim(master_names(master)), kind, middle=.true.)
               scene%friction = law_with(law, 1)
               if (law == 0) scene%friction%law = law_of%none
               if (law > 0) call let_grow(scene)
               call one_tangent(scene, 'middle, '//trim(grip_names(kind))//' on '// &
                  & trim(master_names(master))//', law '//achar(48 + law), 1)
            end do
         end do
      end do
   end subroutine tangents_of_mid_side_nodes

   !> Nodes between facets that stand for a curve, on round profiles.
   subroutine tangents_of_what_rolls()
      type(point_scene_type) :: scene
      character(len=*), parameter :: tools(2) = [character(len=7) :: 'circle', 'profile']
      integer :: tool, kind, law

      do kind = 1, size(grip_names)
         do tool = 1, size(tools)
            do law = 0, merge(0, size(law_names), kind == tied_grip)
               call new_point_scene(scene, trim(tools(tool)), kind, rolls=.true.)
               scene%friction = law_with(law, 1)
               if (law == 0) scene%friction%law = law_of%none
               if (law > 0) call let_grow(scene)
               call one_tangent(scene, 'rolls, '//trim(grip_names(kind))//' on '// &
                  & trim(tools(tool))//', law '//achar(48 + law), 1)
               call is_true('by its curve', scene%opposite%inner%soft > 0.0_wp)
            end do
         end do
      end do
   end subroutine tangents_of_what_rolls

   !> Fourth-order differences along ways in all unknowns; a draw near a kink is drawn again.
   subroutine one_tangent(scene, name, draw)
      type(point_scene_type), intent(inout) :: scene
      character(len=*), intent(in) :: name
      integer, intent(in) :: draw
      real(wp), parameter :: h = 3.0e-5_wp, far(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp], &
         & share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      integer, parameter :: nway = 3           ! none of them leaves out an entry of the matrix
      real(wp) :: u(scene%dofs%n), value(scene%dofs%n), x(scene%dofs%n + scene%ndim)
      real(wp), dimension(scene%dofs%n + scene%ndim, scene%dofs%n + scene%ndim) :: k, spring
      real(wp), dimension(scene%dofs%n + scene%ndim, nway) :: way, difference, slope
      real(wp), allocatable :: small(:, :)
      real(wp) :: lambda(3), total(3), moment(3), force(3), scale, at(3), arm(3), shear(3)
      integer :: i, j, n, m, status, try, d, node, place_of
      logical :: kink, smooth

      d = scene%ndim
      n = scene%dofs%n
      do try = 1, 50
         u(:) = random(n, 0.02_wp*(1.0_wp + 0.1_wp*try))
         if (scene%is_tool) u(2*d + 1:) = random(n - 2*d, 0.03_wp)
         lambda = 0.0_wp
         call look(scene, u, lambda)
         lambda(:d) = 5.0_wp*scene%state%normal(:d) + random(d, real(draw*draw, wp))
         call look(scene, u, lambda)
         status = scene%state%status
         place_of = scene%opposite%found%place
         k = scene%k
         spring = scene%spring
         ! Without shear the direction of friction is not smooth.
         shear = scene%state%traction - dot_product(scene%state%traction, scene%state%normal) &
            & *scene%state%normal
         smooth = scene%friction%law == law_of%none .or. norm2(shear) > 0.2_wp
         difference = 0.0_wp
         kink = .not. smooth .or. scene%opposite%facet == 0
         if (kink) cycle
         do i = 1, nway
            way(:, i) = random(n + d, 1.0_wp)
            do j = 1, 4
               x = [u, lambda(:d)] + far(j)*h*way(:, i)
               call look(scene, x(:n), [x(n + 1:), spread(0.0_wp, 1, 3 - d)], .false.)
               kink = kink .or. scene%state%status /= status &
                  & .or. scene%opposite%found%place /= place_of
               difference(:, i) = difference(:, i) + share(j)/h*scene%residual
            end do
         end do
         if (.not. kink) exit
      end do
      call test(name//': the tangent is exact')
      call is_true('there is a smooth draw', .not. kink)
      call is_true('closed', status > 0)
      scale = maxval(abs(k(:n, :)))
      slope = matmul(k, way)
      call close_to('d force', slope(:n, :)/scale, difference(:n, :)/scale, 1.0e-8_wp)
      call close_to('d row', slope(n + 1:, :), difference(n + 1:, :), 1.0e-8_wp)
      call test(name//': the spring is symmetric and pushes back')
      scale = maxval(abs(spring))
      call close_to('symmetric', spring/scale, transpose(spring)/scale, 1.0e-13_wp)
      allocate (small, source=spring(:n, :n)/scale)
      call symmetric_eigen(small, value, i)
      call is_true('semidefinite', minval(value) > -1.0e-13_wp)
      call test(name//': forces balance, and moments up to the arm of the gap; ties hold the arm')
      call look(scene, u, lambda)
      total = 0.0_wp
      moment = 0.0_wp
      do node = 1, size(scene%dofs%id, 2)
         force = 0.0_wp
         at = 0.0_wp
         do i = 1, d
            m = scene%dofs%id(i, node)
            force(i) = -scene%residual(m)
            at(i) = scene%model%mesh%x(i, node) + u(m)
         end do
         total = total + force
         moment = moment + cross(at, force)
         do i = 4, 6
            m = scene%dofs%id(i, node)
            if (m > 0) moment(i - 3) = moment(i - 3) - scene%residual(m)
         end do
      end do
      scale = norm2(scene%state%traction)
      arm = scene%points%weight(1)*scene%state%gap*cross(scene%state%normal, scene%state%traction)
      if (scene%is_tool .and. index(name, 'tied') > 0) arm = 0.0_wp
      call close_to('forces', total/scale, 0.0_wp*total, 1.0e-12_wp)
      ! Of a smoothed facet the nodes carry what acts on the curve; places of a row have gaps and
      ! normals of their own unless the tool is plane.
      if (.not. (scene%is_smooth .or. scene%rolls) .and. (.not. scene%is_middle .or. &
         & index(name, 'plane') > 0)) &
         & call close_to('moments', moment/scale, arm/scale, 1.0e-12_wp)
      call on_the_joint(scene, name, place_of)
   end subroutine one_tangent

   !> Roofs are met where they are not smooth, domes on their smoothed facet in the middle.
   subroutine on_the_joint(scene, name, found)
      type(point_scene_type), intent(in) :: scene
      character(len=*), intent(in) :: name
      integer, intent(in) :: found

      if (index(name, ' vertex') > 0 .or. index(name, ' corner') > 0) &
         & call is_true('at a vertex', found == place%vertex)
      if (index(name, ' edge') > 0) call is_true('on an edge', found == place%edge)
      if (scene%is_smooth) call is_true('on a curved facet', allocated(scene%opposite%stencil))
   end subroutine on_the_joint

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> The traction of the penalty solves the rows of the perturbed Lagrangian, whatever c.
   subroutine perturbed_is_penalty()
      type(point_scene_type) :: scene
      real(wp) :: z(3)
      real(wp), allocatable :: u(:), force(:)
      integer :: master, law

      do master = 1, size(master_names)
         do law = 0, size(law_names)
            call test('perturbed is penalty on '//trim(master_names(master))//', law '// &
               & achar(48 + law))
            call new_point_scene(scene, trim(master_names(master)), findloc(grip_names, 'penalty', &
               & dim=1))
            scene%friction = law_with(law, 1)
            u = random(scene%dofs%n, 0.02_wp)
            scene%enforcement%slope = 300.0_wp
            scene%enforcement%ct = 90.0_wp
            call look(scene, u, [0.0_wp, 0.0_wp, 0.0_wp])
            z = scene%state%traction
            force = scene%state%force
            call new_enforcement(scene%enforcement%method, 'perturbed')
            scene%enforcement%c = 50.0_wp
            scene%enforcement%ct = 20.0_wp
            call look(scene, u, z)
            call close_to('row', scene%enforcement%c*scene%state%row(:scene%ndim)/norm2(z), &
               & 0.0_wp*z(:scene%ndim), 1.0e-12_wp)
            call close_to('force', scene%state%force/norm2(z), force/norm2(z), 1.0e-12_wp)
         end do
      end do
   end subroutine perturbed_is_penalty

   subroutine no_coefficient()
      type(point_scene_type) :: scene
      real(wp), allocatable :: u(:), force(:)
      real(wp) :: lambda(3)
      integer :: master, kind

      call test('coefficient 0 gives the bits of no friction')
      do master = 1, size(master_names)
         do kind = 1, tied_grip - 1
            call new_point_scene(scene, trim(master_names(master)), kind)
            u = random(scene%dofs%n, 0.02_wp)
            call look(scene, u, [0.0_wp, 0.0_wp, 0.0_wp])
            lambda = 5.0_wp*scene%state%normal
            call look(scene, u, lambda)
            force = scene%state%force
            scene%friction%law = law_of%coulomb
            call look(scene, u, lambda)
            call is_true(trim(master_names(master)), all(abs(force - scene%state%force) <= 0.0_wp))
         end do
      end do
   end subroutine no_coefficient

   !> A point that slid where a step starts slides on as it did, and sticks where it would slide
   !> back: between the two there is a state, which a step may leap over.
   subroutine sticks_between_two_ways()
      type(point_scene_type) :: scene
      real(wp), allocatable :: u(:), force(:)
      real(wp) :: lambda(3), shear(3)
      integer :: master, kind, try

      do master = 1, size(master_names)
         do kind = 1, tied_grip - 1
            call test('sticks before it slides back: '//trim(grip_names(kind))//' on '// &
               & trim(master_names(master)))
            call new_point_scene(scene, trim(master_names(master)), kind)
            scene%friction = law_with(law_of%coulomb, regularization_of%linear)
            scene%friction%mu = 1.0e-3_wp
            do try = 1, 20
               u = random(scene%dofs%n, 0.02_wp)
               call look(scene, u, [0.0_wp, 0.0_wp, 0.0_wp])
               lambda = 5.0_wp*scene%state%normal
               call look(scene, u, lambda)
               if (scene%state%status == contact_status%slip) exit
            end do
            call is_true('slides', scene%state%status == contact_status%slip)
            shear = scene%state%traction - dot_product(scene%state%traction, &
               & scene%state%normal)*scene%state%normal
            force = scene%state%force
            scene%enforcement%slid = 2.0_wp*shear
            call look(scene, u, lambda)
            call is_true('slides on', scene%state%status == contact_status%slip .and. &
               & all(abs(force - scene%state%force) <= 0.0_wp))
            scene%enforcement%slid = -shear
            call look(scene, u, lambda)
            call is_true('sticks', scene%state%status == contact_status%stick)
         end do
      end do
   end subroutine sticks_between_two_ways

   !> A node opposite a tool that does not turn: forces, and slopes by what its kernel reads, are
   !> those of the kernel that reads all.
   subroutine alone_on_tools()
      integer, parameter :: first_tool = 7, last_tool = 14
      integer :: kind, master, law, regularization

      do kind = 1, tied_grip - 1
         do master = first_tool, last_tool
            do law = 0, size(law_names)
               do regularization = 1, merge(1, size(regularization_names), law == 0)
                  call alone_on_tool(kind, master, law, regularization)
               end do
            end do
         end do
      end do
   end subroutine alone_on_tools

   subroutine alone_on_tool(kind, master, law, regularization)
      integer, intent(in) :: kind, master, law, regularization
      type(point_scene_type) :: scene
      real(wp), allocatable :: u(:), residual(:), k(:, :), spring(:, :)
      integer, allocatable :: read(:)
      real(wp) :: lambda(3), scale
      integer :: i, d, reads

      call test('alone: '//trim(grip_names(kind))//' on '//trim(master_names(master))//', law '// &
         & achar(48 + law)//achar(48 + regularization))
      call new_point_scene(scene, trim(master_names(master)), kind)
      scene%friction = law_with(law, regularization)
      if (law == 0) scene%friction%law = law_of%none
      d = scene%ndim
      u = random(scene%dofs%n, 0.02_wp)
      call look(scene, u, [0.0_wp, 0.0_wp, 0.0_wp])
      lambda = 5.0_wp*scene%state%normal
      lambda(:d) = lambda(:d) + random(d, 1.0_wp)
      call look(scene, u, lambda)
      residual = scene%residual
      k = scene%k
      spring = scene%spring
      scale = maxval(abs(k))
      scene%alone = .true.
      do reads = 0, 1
         scene%reads_tool = reads > 0
         call look(scene, u, lambda)
         call close_to('forces and row', scene%residual, residual, 1.0e-12_wp*norm2(residual))
         read = [(i, i=1, merge(2*d, d, scene%reads_tool)), (scene%dofs%n + i, i=1, d)]
         call close_to('slopes', scene%k(read, read)/scale, k(read, read)/scale, 1.0e-12_wp)
         call close_to('springs', scene%spring(read, read)/scale, spring(read, read)/scale, &
            & 1.0e-12_wp)
      end do
   end subroutine alone_on_tool

   subroutine turned_scenes()
      type(point_scene_type) :: scene
      integer :: master, kind

      do kind = 1, size(grip_names)
         do master = 1, size(master_names)
            call test('turned as a whole: '//trim(grip_names(kind))//' on '// &
               & trim(master_names(master)))
            call new_point_scene(scene, trim(master_names(master)), kind)
            scene%friction = law_with(law_of%coulomb, 1)
            call turn_scene(scene)
         end do
      end do
   end subroutine turned_scenes

   !> The whole scene turned: forces turn with it, gap and lengths of slip stay.
   subroutine turn_scene(scene)
      type(point_scene_type), intent(inout) :: scene
      real(wp) :: lambda(3), q(3, 3), vector(3), gap, slip
      real(wp) :: u(scene%dofs%n), force(scene%dofs%n + scene%ndim), moved(scene%dofs%n)
      integer :: i, m, node, d

      d = scene%ndim
      u = random(scene%dofs%n, 0.02_wp)
      if (scene%is_tool) u(d + 1:) = 0.0_wp
      vector = random(3, 1.5_wp)
      if (d == 2) vector(:2) = 0.0_wp
      q = rotation_matrix(vector)
      lambda = 0.0_wp
      lambda(:d) = random(d, 4.0_wp)
      call look(scene, u, lambda)
      force = scene%residual
      gap = scene%state%gap
      slip = norm2(scene%state%slip)
      moved = u
      do node = 1, size(scene%dofs%id, 2)
         associate (id => scene%dofs%id(:, node))
            do i = 1, d
               m = id(i)
               moved(m) = dot_product(q(i, :d), scene%model%mesh%x(:, node) + u(id(:d))) &
                  & - scene%model%mesh%x(i, node)
               force(m) = dot_product(q(i, :d), scene%residual(id(:d)))
            end do
            if (d == 3 .and. id(4) > 0) then
               moved(id(4:6)) = vector
               force(id(4:6)) = matmul(q, scene%residual(id(4:6)))
            else if (id(6) > 0) then
               moved(id(6)) = vector(3)
            end if
         end associate
      end do
      force(scene%dofs%n + 1:) = matmul(q(:d, :d), scene%residual(scene%dofs%n + 1:))
      scene%enforcement%committed = matmul(q, scene%enforcement%committed)
      scene%enforcement%frozen = matmul(q, scene%enforcement%frozen)
      call look(scene, moved, matmul(q, lambda))
      call close_to('forces', scene%residual, force, 1.0e-10_wp)
      call close_to('gap', scene%state%gap, gap, 1.0e-12_wp)
      call close_to('slip', norm2(scene%state%slip), slip, 1.0e-12_wp)
   end subroutine turn_scene
end program test_contact_point
