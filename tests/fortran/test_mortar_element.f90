!> Mortar on the present shape as a whole: exact tangents of every method and law, plane and space.
program test_mortar_element
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_facets, only : facets_type, new_facet_rules
   use lopin_master_surfaces, only : masters_type
   use lopin_closest_feature, only : opposite_type
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type, build_tree
   use lopin_dofs, only : dofs_type
   use lopin_friction, only : friction_type, condition_type, law_names, law_of
   use lopin_contact_row, only : enforcement_parameters_type, point_state_type, point_law_type
   use lopin_enforcement_law, only : law_type, new_exponential
   use lopin_rigid_motion, only : rotation_matrix
   use lopin_mortar_patch_2d, only : patch_type
   use lopin_mortar_cells_3d, only : new_mortar_kernel
   use lopin_local_matrix, only : local_matrix_type, turned_force
   use lopin_mortar_element, only : present_mortar_type, mortar_anchor_type, update_mortar, &
      & find_mortar_row, evaluate_mortar_point, lay_pieces
   use point_scenes, only : set_method, tied_grip, grip_names
   use check, only : test, close_to, is_true, finish
   implicit none
   type(present_mortar_type) :: mortar
   type(masters_type) :: masters
   type(mortar_anchor_type) :: anchor
   type(dofs_type) :: dofs
   type(enforcement_parameters_type), target :: enforcement
   type(friction_type), target :: friction
   type(condition_type) :: at
   real(wp), allocatable :: start(:, :)        !! places when the increment began [length]
   real(wp) :: worst
   integer :: d, kind, law, seed, n

   call random_seed(size=n)
   call random_seed(put=[(4711*kind, kind=1, n)])
   call new_facet_rules(masters%rules)
   allocate (masters%of(1))
   worst = 0.0_wp
   do d = 2, 3
      do kind = 1, tied_grip
         do law = 0, size(law_names)
            if (kind == tied_grip .and. law > 0) cycle
            do seed = 1, 2
               call one_point()
            end do
         end do
      end do
   end do
   print '("   largest difference of tangents ",es9.1)', worst
   call finish()

contains

   !> Two bent surfaces that do not match, the slave above; its node in the middle is looked at.
   subroutine set_scene()
      type(facets_type) :: facets
      type(error_type), allocatable :: error
      type(law_type) :: overclosure
      integer :: i

      mortar = present_mortar_type()
      mortar%is_on = .true.
      mortar%in_space = d == 3
      mortar%tied = kind == tied_grip
      anchor = mortar_anchor_type()
      if (d == 3) call new_mortar_kernel(mortar%space%kernel, 0)
      if (allocated(start)) deallocate (start)
      allocate (start(d, 0))
      call add_sheet(facets, 2, 0.7_wp, .true.)
      if (bent()) call turn_last_up(facets)
      call new_surface(mortar%slave, d, facets)
      call add_sheet(facets, 3, 1.1_wp, .false.)
      call new_surface(masters%of(1)%surface, d, facets)
      call update_surface(mortar%slave, start, error)
      mortar%lifts = spread(.false., 1, mortar%slave%nnode)
      mortar%space%lifts = mortar%lifts
      call is_true('a surface', .not. allocated(error))
      mortar%thickness = spread(0.8_wp, 1, mortar%slave%facets%n)
      call lay_pieces(mortar, masters%rules, start)
      if (bent()) call is_true('two pieces', maxval(mortar%piece) == 2)
      dofs%n = size(start)
      if (allocated(dofs%id)) deallocate (dofs%id)
      allocate (dofs%id(6, size(start, 2)), source=0)
      dofs%id(:d, :) = reshape([(i, i=1, dofs%n)], shape(start))
      enforcement = enforcement_parameters_type(c=20.0_wp, ct=8.0_wp, slope=60.0_wp, &
         & shear_slope=18.0_wp)
      call new_exponential(overclosure, 0.2_wp, 3.0_wp)
      call set_method(enforcement, kind, overclosure)
      if (kind == tied_grip .and. seed == 2) call add_released_forces(enforcement)
      enforcement%committed(:d) = random(d, 0.3_wp)
      enforcement%frozen(:d) = random(d, 0.3_wp)
      enforcement%creep(:d) = random(d, 0.01_wp)
      friction = friction_type(law=merge(law_of%none, law, law == 0), mu=0.3_wp, m=0.2_wp, &
         & alpha=1.0_wp, q=0.4_wp)
      friction%elastic_slip = 0.03_wp
      if (law == law_of%norton_hoff) friction%v0 = 0.05_wp
      at = condition_type(dt=0.5_wp, yield=2.0_wp)
   end subroutine set_scene

   !> Supports hold the node along a slanted direction: the tie does not.
   subroutine add_released_forces(enforcement)
      type(enforcement_parameters_type), intent(inout) :: enforcement
      real(wp) :: along(d)
      integer :: j

      along = 1.0_wp + random(d, 0.5_wp)
      along = along/norm2(along)
      enforcement%partly = .true.
      do j = 1, d
         enforcement%held(:d, j) = -along*along(j)
         enforcement%held(j, j) = enforcement%held(j, j) + 1.0_wp
      end do
   end subroutine add_released_forces

   !> A corner in the middle: the last node takes its function on the steep facet over.
   logical function bent()
      bent = d == 2 .and. seed == 2 .and. kind /= tied_grip
   end function bent

   !> The last facet of the slave rises by 50 degrees and more.
   subroutine turn_last_up(facets)
      type(facets_type), intent(in) :: facets

      associate (corner => facets%node(1, facets%n), last => facets%node(2, facets%n))
         start(:, last) = start(:, corner) + [0.3_wp, 0.4_wp]
      end associate
   end subroutine turn_last_up

   function random(n, size) result(x)
      integer, intent(in) :: n
      real(wp), intent(in) :: size
      real(wp) :: x(n)
      call random_number(x)
      x = size*(2.0_wp*x - 1.0_wp)
   end function random

   !> n facets (squared in space) on a bent sheet; `down`: their normals.
   subroutine add_sheet(facets, n, size_, down)
      type(facets_type), intent(out) :: facets
      integer, intent(in) :: n
      real(wp), intent(in) :: size_
      logical, intent(in) :: down
      integer :: a, b, first, node(4), rows
      real(wp) :: u(2)

      first = size(start, 2)
      rows = merge(n, 0, d == 3)
      do b = 0, rows
         do a = 0, n
            u = size_*(2.0_wp*real([a, b], wp)/real(n, wp) - 1.0_wp)
            if (d == 2) u(2) = 0.3_wp
            u = u + random(2, 0.04_wp)
            if (d == 2) then
               start = reshape([start, u(1), 0.1_wp*u(1)**2], [d, size(start, 2) + 1])
            else
               start = reshape([start, u, 0.1_wp*u(1)**2 - 0.05_wp*u(1)*u(2)], &
                  & [d, size(start, 2) + 1])
            end if
         end do
      end do
      facets%n = n*max(1, rows)
      facets%element = [(a, a=1, facets%n)]
      facets%face = spread(1, 1, facets%n)
      facets%cell = spread(merge(1, 5, d == 2), 1, facets%n)
      facets%nnode = spread(merge(2, 4, d == 2), 1, facets%n)
      allocate (facets%node(8, facets%n), source=0)
      do a = 1, facets%n
         b = first + a + (a - 1)/n*merge(1, 0, d == 3)
         node = [b, b + 1, b + n + 2, b + n + 1]
         if (d == 2) node(:2) = merge(node(:2), node([2, 1]), down)
         if (d == 3 .and. down) node = node([1, 4, 3, 2])
         facets%node(:facets%nnode(a), a) = node(:facets%nnode(a))
      end do
   end subroutine add_sheet

   subroutine look(x, lambda, state, local, from_start)
      real(wp), intent(in) :: x(:, :), lambda(3)
      type(point_state_type), intent(out) :: state
      type(local_matrix_type), intent(out) :: local
      logical, intent(in) :: from_start
      type(error_type), allocatable :: error
      type(tree_type) :: tree
      type(patch_type) :: patch
      type(opposite_type) :: opposite
      integer :: first

      masters%x = x
      associate (master => masters%of(1)%surface)
         call update_surface(master, x, error)
         call build_tree(tree, master%low, master%high)
         call update_mortar(mortar, masters%rules, master, tree, x, from_start, .true., error)
      end associate
      call is_true('overlaps', .not. allocated(error))
      call find_mortar_row(mortar, masters, middle(), from_start, patch, anchor, opposite)
      call is_true('covered', opposite%facet == 1)
      if (from_start) return
      first = merge(1, 0, enforcement%method%solves_for_multiplier())
      call evaluate_mortar_point(state, local, mortar, dofs, x, patch, anchor, &
         & point_law_type(enforcement, friction, at, merge(-0.6_wp, 0.0_wp, bent()), lambda, first))
   end subroutine look

   !> Its number on the slave.
   integer function middle()
      middle = merge(2, 5, d == 2)
      if (bent()) middle = 3
      middle = findloc(mortar%slave%node, middle, dim=1)
   end function middle

   !> -force on all dofs, then the rows.
   function residual(state, local) result(r)
      type(point_state_type), intent(in) :: state
      type(local_matrix_type), intent(in) :: local
      real(wp) :: r(dofs%n + d)
      integer :: i

      r = 0.0_wp
      do i = 1, local%nu
         r(local%dof(i)) = -state%force(i)
      end do
      if (size(local%dof) > local%nu) r(dofs%n + 1:) = state%row(:d)
   end function residual

   !> A random direction of all places and the multiplier; kinks are drawn again.
   subroutine one_point()
      real(wp), parameter :: h = 2.0e-5_wp, far(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp], &
         & share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      type(point_state_type) :: state, still
      type(local_matrix_type) :: local
      real(wp), allocatable :: x(:, :), way(:), slope(:), difference(:), turned(:, :)
      real(wp) :: lambda(3), turn(3, 3), off
      integer :: try, j, status, topology
      logical :: kink
      character(len=40) :: name

      write (name, '(i0,"D, ",a,", law ",i0)') d, trim(grip_names(kind)), law
      do try = 1, 30
         call set_scene()
         lambda = 0.0_wp
         call look(start, lambda, state, local, .true.)
         x = start + reshape(random(size(start), 0.02_wp), shape(start))
         x(d, :(merge(3, 9, d == 2))) = x(d, :(merge(3, 9, d == 2))) - 0.06_wp
         call look(x, lambda, state, local, .false.)
         lambda(:d) = state%normal(:d) + random(d, 0.3_wp)
         call look(x, lambda, state, local, .false.)
         status = state%status
         topology = topology_now()
         way = random(dofs%n + d, 1.0_wp)
         slope = tangent_times(local, way)
         difference = 0.0_wp*way
         kink = status == 0
         do j = 1, 4
            call look(x + far(j)*h*reshape(way(:dofs%n), shape(x)), &
               & lambda + far(j)*h*[way(dofs%n + 1:), spread(0.0_wp, 1, 3 - d)], still, local, &
               & .false.)
            difference = difference + share(j)/h*residual(still, local)
            kink = kink .or. still%status /= status .or. topology_now() /= topology
         end do
         if (.not. kink) exit
      end do
      call test(trim(name)//': the tangent is exact')
      call is_true('there is a smooth draw', .not. kink)
      off = maxval(abs(slope - difference))/maxval(abs(difference))
      worst = max(worst, off)
      call close_to('d (force, row)', off, 0.0_wp, 1.0e-8_wp)
      call test(trim(name)//': momentum, and the same for every observer')
      call look(x, lambda, state, local, .false.)
      do j = 1, d
         call close_to('forces balance', sum(pack(state%force, mod(local%dof(:local%nu) - j, d) &
            & == 0))/maxval(abs(state%force)), 0.0_wp, 1.0e-12_wp)
      end do
      if (.not. enforcement%method%solves_for_multiplier()) return
      turn = rotation_matrix([0.0_wp, 0.0_wp, 0.7_wp])
      if (d == 3) turn = rotation_matrix([0.4_wp, -0.8_wp, 0.7_wp])
      enforcement%committed = matmul(turn, enforcement%committed)
      enforcement%frozen = matmul(turn, enforcement%frozen)
      enforcement%creep = matmul(turn, enforcement%creep)
      enforcement%held = matmul(matmul(turn, enforcement%held), transpose(turn))
      turned = matmul(turn(:d, :d), x)
      call look(turned, matmul(turn, lambda), still, local, .false.)
      call close_to('force turns', maxval(abs(reshape(still%force, [d, local%nu/d]) &
         & - matmul(turn(:d, :d), reshape(state%force, [d, local%nu/d])))) &
         & /maxval(abs(state%force)), 0.0_wp, 1.0e-11_wp)
   end subroutine one_point

   !> The tangent of a point, or of a tie by its parts, times a direction of dofs and row.
   function tangent_times(local, way) result(slope)
      type(local_matrix_type), intent(in) :: local
      real(wp), intent(in) :: way(:)
      real(wp) :: slope(size(way))

      slope = 0.0_wp
      if (.not. allocated(local%glue)) then
         slope(local%dof) = matmul(local%k, way(local%dof))
         return
      end if
      associate (u => local%dof(:local%nu), row => local%dof(local%nu + 1:), g => local%glue)
         slope(row) = matmul(local%reach, way(u))
         slope(u) = g%weight*matmul(g%c*slope(row) - way(row), local%reach)
         slope(row) = slope(row) + matmul(g%give(:d, :d), way(row))
         if (g%turns) slope(u) = slope(u) + turned_force(g, local%tangent, way(u))
      end associate
   end function tangent_times

   integer function topology_now()
      topology_now = mortar%list%n
      if (d == 3) topology_now = mortar%space%row(middle())%topology
   end function topology_now
end program test_mortar_element
