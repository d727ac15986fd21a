!> Master surfaces and tools where they stand now, and the sides of their slaves.
module lopin_master_surfaces
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, facet_rule_type, new_facets, new_facet_rules, &
      & nodal_normals, nodal_weights
   use lopin_mortar_pairs, only : thickness_of
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : limits_type
   use lopin_search, only : tree_type, cost_type, build_tree, refit_tree
   use lopin_self_contact, only : self_contact_type, new_self_contact, measure_thickness, &
      & depths_of_elements
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_model, only : model_type, surface_of
   use lopin_flat_elements, only : is_ring
   use lopin_dofs, only : dofs_type
   use lopin_contact_points, only : pair_is_tied, facing
   use lopin_nonlinear_points, only : nonlinear_points_type, is_self_contact, stays_mortar
   use lopin_facet_hysteresis, only : facet_hysteresis_type
   implicit none
   private
   public :: masters_type, master_type, new_masters, move_masters, measure_walls, areas_of

   !> Facets, of both sides, beyond which two boxes count as apart: quadratic facets bulge less.
   real(wp), parameter :: apart = 2.0_wp

   type :: master_type
      integer :: tool = 0, body = 0                !! of the model; 0: none
      logical :: held = .false.                    !! a tool of which nothing is solved for
      logical :: floats = .false.                  !! how it turns is solved for
      logical :: turns = .false.                   !! as prescribed, in this increment
      type(surface_type) :: surface
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(rigid_motion_type) :: motion
      real(wp) :: rotation(3) = 0.0_wp             !! its rotation vector [rad]
      logical :: may_sleep = .false.               !! far from all its points, it is left alone
      logical :: asleep = .false.
      real(wp) :: distance = 0.0_wp                !! of the boxes of points and surface [length]
      real(wp) :: coarsest = 0.0_wp                !! facet at the start [length]
      logical :: against_itself = .false.
      type(self_contact_type) :: itself            !! of the points of a surface against itself
      integer :: first_point = 0                   !! the first of them
      logical :: has_slave_faces = .false.
      type(facets_type) :: slave                   !! for the slave's normals and areas
      real(wp), allocatable :: thickness(:)        !! of its facets [length]
   end type master_type

   type :: masters_type
      type(master_type), allocatable :: of(:)      !! (npair)
      type(facet_rule_type) :: rules(6)
      real(wp), allocatable :: x(:, :)             !! (ndim, nnode) present places [length]
      real(wp), allocatable :: start_x(:, :)       !! the same where the increment began
      real(wp), allocatable :: side(:, :)          !! (3, npoint) slave normals, start of increment
      integer, allocatable :: part(:)   !! (npoint) segment of the tool met last; 0: none yet
      type(facet_hysteresis_type) :: owner !! of points that sit in the joint of two facets
   end type masters_type

contains

   !> The masters of all pairs where the model has them.
   subroutine new_masters(self, model, basis, error)
      type(masters_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(facet_basis_type), intent(out) :: basis
      type(error_type), allocatable, intent(out) :: error
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: facets
      integer :: pair

      call cells_of_words(model%element_word, cells)
      call new_facet_basis(basis)
      call new_facet_rules(self%rules)
      self%x = model%mesh%x
      allocate (self%of(size(model%pair)))
      do pair = 1, size(model%pair)
         associate (m => self%of(pair), p => model%pair(pair), &
            & master => model%surface(model%pair(pair)%master), &
            & slave => model%surface(model%pair(pair)%slave))
            m%limits%extension = p%extension
            m%limits%cosine = facing
            m%has_slave_faces = slave%kind == surface_of%faces
            if (m%has_slave_faces) then
               call new_facets(m%slave, model%mesh, cells, slave%element, slave%face)
               m%thickness = thickness_of(model, m%slave)
            end if
            if (master%kind == surface_of%tool) then
               m%tool = master%tool
               m%body = model%tool(m%tool)%rigid_body
               cycle
            end if
            call new_facets(facets, model%mesh, cells, master%element, master%face)
            call new_surface(m%surface, model%mesh%ndim, facets, p%smooth)
            call update_surface(m%surface, model%mesh%x, error)
            if (allocated(error)) return
            call build_tree(m%tree, m%surface%low, m%surface%high)
            m%coarsest = maxval([0.0_wp, m%surface%size])
            m%may_sleep = can_sleep(model, pair)
         end associate
      end do
   end subroutine new_masters

   !> Pairs of nodes with faces whose contacts do nothing from afar.
   pure logical function can_sleep(model, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      can_sleep = .not. is_self_contact(model%pair(pair)) &
         & .and. .not. stays_mortar(model, model%pair(pair)) &
         & .and. .not. pair_is_tied(model, model%pair(pair))
      if (.not. can_sleep) return
      associate (way => model%interaction(model%pair(pair)%interaction))
         can_sleep = way%method%piecewise_linear()
      end associate
   end function can_sleep

   !> Compare the box of the points with that of the surface, as they are now.
   subroutine skip_far_masters(m, x, points, pair, clearance)
      type(master_type), intent(inout) :: m
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) present [length]
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: pair
      real(wp), intent(in) :: clearance        !! [length]
      real(wp) :: low(size(x, 1)), high(size(x, 1)), from(size(x, 1)), to(size(x, 1)), reach
      integer :: i

      from = huge(1.0_wp)
      to = -huge(1.0_wp)
      low = from
      high = to
      reach = 0.0_wp
      do i = 1, points%n
         if (points%pair(i) /= pair) cycle
         from = min(from, x(:, points%node(i)))
         to = max(to, x(:, points%node(i)))
         reach = max(reach, apart*points%size(i) + abs(points%shift(i)) + points%overclosure(i))
      end do
      do i = 1, m%surface%nnode
         low = min(low, x(:, m%surface%node(i)))
         high = max(high, x(:, m%surface%node(i)))
      end do
      m%distance = norm2(max(0.0_wp, from - high, low - to))
      m%asleep = m%distance > reach + apart*m%coarsest + abs(clearance)
   end subroutine skip_far_masters

   !> All to where displacements u put it; at the start of an increment the slave normals too.
   subroutine move_masters(self, model, dofs, points, u, start, cost, error)
      type(masters_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(nonlinear_points_type), intent(in) :: points
      real(wp), intent(in) :: u(:)             !! (ndof)
      logical, intent(in) :: start
      type(cost_type), intent(inout) :: cost
      type(error_type), allocatable, intent(out) :: error
      integer :: pair, k, node

      do node = 1, model%mesh%nnode
         do k = 1, model%mesh%ndim
            if (dofs%id(k, node) > 0) self%x(k, node) = model%mesh%x(k, node) + u(dofs%id(k, node))
         end do
      end do
      do pair = 1, size(model%pair)
         associate (m => self%of(pair))
            if (m%tool > 0) then
               call move_tool(m, model, dofs, u)
            else
               if (m%may_sleep) then
                  cost%box = cost%box + 1
                  call skip_far_masters(m, self%x, points, pair, &
                     & model%interaction(model%pair(pair)%interaction)%clearance)
                  if (m%asleep) cycle
               end if
               call update_surface(m%surface, self%x, error)
               if (allocated(error)) return
               call refit_tree(m%tree, m%surface%low, m%surface%high)
            end if
         end associate
      end do
      if (start) then
         self%start_x = self%x
         call find_sides(self, model, points)
      end if
      do pair = 1, size(model%pair)
         if (is_self_contact(model%pair(pair)) .and. .not. self%of(pair)%against_itself) &
            & call know_itself(self, model, points, pair)
      end do
   end subroutine move_masters

   subroutine move_tool(m, model, dofs, u)
      type(master_type), intent(inout) :: m
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: u(:)
      real(wp) :: place(6)
      integer :: k, d

      place = 0.0_wp
      d = model%mesh%ndim
      if (m%body == 0) then
         call new_rigid_motion(m%motion, spread(0.0_wp, 1, d), place(:d), [real(wp) ::])
         return
      end if
      associate (node => model%rigid_body(m%body)%reference)
         do k = 1, 6
            if (dofs%id(k, node) > 0) place(k) = u(dofs%id(k, node))
         end do
         m%rotation = place(4:6)
         if (d == 2) then
            call new_rigid_motion(m%motion, model%mesh%x(:, node), place(:2), place(6:6))
         else
            call new_rigid_motion(m%motion, model%mesh%x(:, node), place(:3), place(4:6))
         end if
      end associate
   end subroutine move_tool

   !> What a surface must know to meet itself: the neighbours of each of its points, and how deep
   !> its elements are.
   subroutine know_itself(self, model, points, pair)
      type(masters_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: pair
      integer, allocatable :: node(:)

      node = pack(points%node, points%pair == pair)
      associate (m => self%of(pair))
         m%first_point = findloc(points%pair, pair, dim=1)
         m%against_itself = .true.
         call new_self_contact(m%itself, m%surface, node, &
            & depths_of_elements(m%surface, self%x, model%mesh%conn))
      end associate
   end subroutine know_itself

   !> How deep points of surfaces that meet themselves may enter in this increment.
   subroutine measure_walls(self, points, pressed)
      type(masters_type), intent(inout) :: self
      type(nonlinear_points_type), intent(in) :: points
      logical, intent(in) :: pressed(:)        !! (npoint) since the last increment
      integer :: pair, first, last

      do pair = 1, size(self%of)
         associate (m => self%of(pair))
            if (.not. m%against_itself) cycle
            first = m%first_point
            last = first + size(m%itself%depth) - 1
            call measure_thickness(m%itself, m%surface, m%tree, &
               & self%x(:, points%node(first:last)), self%side(:size(self%x, 1), first:last), &
               & m%limits%cosine, pressed(first:last))
         end associate
      end do
   end subroutine measure_walls

   !> The outward normals of the slaves now.
   subroutine find_sides(self, model, points)
      type(masters_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(nonlinear_points_type), intent(in) :: points
      real(wp), allocatable :: normal(:, :)
      integer :: pair, i

      if (.not. allocated(self%side)) allocate (self%side(3, points%n))
      if (.not. allocated(self%part)) allocate (self%part(points%n), source=0)
      self%side = 0.0_wp
      allocate (normal(model%mesh%ndim, model%mesh%nnode))
      do pair = 1, size(model%pair)
         if (.not. self%of(pair)%has_slave_faces) cycle
         call nodal_normals(self%of(pair)%slave, self%rules, self%x, &
            & is_ring(model, model%pair(pair)%slave), normal)
         do i = 1, points%n
            if (points%pair(i) == pair) self%side(:model%mesh%ndim, i) = normal(:, points%node(i))
         end do
      end do
   end subroutine find_sides

   !> Areas of the slave nodes of a pair with faces now; 0 elsewhere.
   function areas_of(self, model, pair) result(area)
      type(masters_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp) :: area(model%mesh%nnode)       !! [area]

      call nodal_weights(self%of(pair)%slave, self%rules, self%x, &
         & is_ring(model, model%pair(pair)%slave), &
         & self%of(pair)%thickness, area, model%mesh%x)
   end function areas_of
end module lopin_master_surfaces
