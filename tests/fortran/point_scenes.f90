!> One slave point opposite one facet of any kind, a joint of facets, a smoothed facet among others,
!> or one tool of any kind, that all may move.
module point_scenes
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_facets, only : facets_type
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis
   use lopin_surface, only : new_surface, update_surface
   use lopin_search, only : build_tree, cost_type
   use lopin_tool, only : foot_type, tool_type
   use lopin_tool_plane, only : plane_type, new_plane
   use lopin_tool_sphere, only : sphere_type, new_sphere
   use lopin_tool_cylinder, only : cylinder_type, new_cylinder
   use lopin_tool_profile, only : profile_tool_type, extruded_type, revolved_type
   use lopin_profile, only : profile_type, segment_card_type, new_profile
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_friction, only : friction_type, condition_type
   use lopin_contact_row, only : enforcement_parameters_type, point_state_type, point_law_type
   use lopin_contact_inputs, only : point_view_type
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_enforcement, only : copy_method
   use lopin_enforcement_augmented, only : mixed_type
   use lopin_enforcement_law, only : law_type, new_exponential
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_facet_hysteresis, only : new_facet_hysteresis
   use lopin_closest_feature, only : opposite_type, anchor_type, find_opposite, anchor_of
   use lopin_nonlinear_samples, only : find_sample_feet, offset_of
   use lopin_nonlinear_faces, only : find_inner_feet
   use lopin_master_surfaces, only : masters_type, move_masters
   use lopin_contact_element, only : evaluate_point
   use lopin_tool_point, only : evaluate_tool_point
   use lopin_local_matrix, only : local_matrix_type
   use patch_scenes, only : patch_names, patch_dimension, is_dome, new_patch
   implicit none
   private
   public :: point_scene_type, master_names, new_point_scene, look, random, grip_names
   public :: tied_grip, set_method

   !> The six cells of facets in the order of their ids, then tools, then patches of facets.
   character(len=*), parameter :: master_names(14 + size(patch_names)) = [character(len=9) :: &
      & 'line2', 'line3', 'tri3', 'tri6', 'quad4', 'quad8', 'plane2', 'plane3', 'circle', &
      & 'sphere', 'cylinder', 'profile', 'extruded', 'revolved', patch_names]
   !> Methods by number: those of the factory, the form of the augmented one with unknown forces, a
   !> law of pressure over overclosure, ties.
   character(len=*), parameter :: grip_names(7) = [character(len=11) :: 'lagrange', 'penalty', &
      & 'perturbed', 'augmented', 'mixed', 'overclosure', 'tied']
   integer, parameter :: tied_grip = 7

   type :: point_scene_type
      integer :: ndim = 3
      logical :: is_tool = .false.
      logical :: is_smooth = .false.
      logical :: is_middle = .false.           !! a mid-side node: its row samples three places
      logical :: rolls = .false.               !! its two facets stand for a curve
      type(model_type) :: model
      type(dofs_type) :: dofs
      type(masters_type) :: masters
      type(nonlinear_points_type) :: points
      type(facet_basis_type) :: basis
      type(enforcement_parameters_type) :: enforcement
      type(friction_type) :: friction
      type(condition_type) :: at
      type(anchor_type) :: anchor
      real(wp) :: shift = 0.0_wp
      ! of the last look
      type(opposite_type) :: opposite
      type(point_state_type) :: state
      real(wp), allocatable :: k(:, :), spring(:, :), residual(:)   !! (ndof + ndim)
      logical :: alone = .false.               !! by lopin_tool_point
      logical :: reads_tool = .true.           !! with it
   end type point_scene_type

contains

   !> Uniform numbers between -size and size.
   function random(n, size_) result(x)
      integer, intent(in) :: n
      real(wp), intent(in) :: size_
      real(wp) :: x(n)
      call random_number(x)
      x = size_*(2.0_wp*x - 1.0_wp)
   end function random

   !> A method of `grip_names`; springs have the stiffness c of the grip.
   subroutine set_method(enforcement, kind, law)
      type(enforcement_parameters_type), intent(inout) :: enforcement
      integer, intent(in) :: kind
      type(law_type), intent(in) :: law        !! of the overclosure

      enforcement%tied = kind == tied_grip
      select case (grip_names(kind))
      case ('overclosure')
         call copy_method(law, enforcement%method)
         enforcement%slope = 1.0_wp
         return
      case ('mixed')
         call copy_method(mixed_type(), enforcement%method)
      case ('tied')
         call new_enforcement(enforcement%method, 'lagrange')
      case default
         call new_enforcement(enforcement%method, trim(grip_names(kind)))
      end select
      if (.not. enforcement%method%solves_for_multiplier()) enforcement%slope = enforcement%c
      if (grip_names(kind) == 'lagrange') enforcement%shear_slope = 0.0_wp
   end subroutine set_method

   subroutine new_point_scene(self, name, kind, middle, rolls)
      type(point_scene_type), intent(out) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: kind              !! of grip_names
      logical, intent(in), optional :: middle  !! opposite a tool: a mid-side node
      logical, intent(in), optional :: rolls   !! opposite a profile: between curved facets
      type(law_type) :: law
      integer :: cell, i

      cell = findloc(master_names, name, dim=1)
      self%is_tool = cell > 6 .and. .not. any(patch_names == name)
      self%ndim = 3
      if (any(name == [character(len=9) :: 'line2', 'line3', 'plane2', 'circle', 'profile'])) &
         & self%ndim = 2
      call new_facet_basis(self%basis)
      self%model%mesh%ndim = self%ndim
      allocate (self%masters%of(1), self%model%pair(1), self%model%tool(0))
      allocate (self%model%rigid_body(0))
      self%model%pair(1)%slave = 1
      self%model%pair(1)%master = 2
      if (any(patch_names == name)) then
         self%ndim = patch_dimension(name)
         self%model%mesh%ndim = self%ndim
         call make_patch(self, name)
      else if (self%is_tool) then
         call make_tool(self, name)
      else
         call make_facet(self, cell)
      end if
      if (present(middle)) self%is_middle = middle
      self%points%node = [1]
      if (present(rolls)) self%rolls = rolls
      if (self%is_middle .or. self%rolls) call add_ends(self)
      self%points%n = size(self%points%node)
      associate (n => self%points%n)
         allocate (self%masters%side(3, n), source=0.0_wp)
         call new_facet_hysteresis(self%masters%owner, n)
         self%points%pair = spread(1, 1, n)
         self%points%entry = spread(1, 1, n)
         self%points%weight = spread(0.7_wp, 1, n)
         self%points%size = spread(1.0_wp, 1, n)
         self%points%depth = spread(huge(1.0_wp), 1, n)
         self%points%share = spread(0.0_wp, 1, n)
         allocate (self%points%growth(n))
         self%points%corner = reshape(spread(0, 1, 2*n), [2, n])
      end associate
      if (self%is_middle) then
         self%points%share(1) = 0.2_wp
         self%points%corner(:, 1) = [2, 3]
      end if
      if (self%rolls) then
         self%points%weight = 0.26_wp
         allocate (self%points%face(2))
         self%points%face%pair = 1
         self%points%face%cell = 1
         self%points%face%nnode = 2
         self%points%face%curved = .true.
         self%points%face(1)%node(:2) = [4, 1]
         self%points%face(1)%point(:2) = [3, 1]
         self%points%face(1)%beside = [0, 3]
         self%points%face(2)%node(:2) = [1, 3]
         self%points%face(2)%point(:2) = [1, 2]
         self%points%face(2)%beside = [4, 0]
      end if
      self%enforcement%c = 100.0_wp
      self%enforcement%ct = 40.0_wp
      self%enforcement%slope = 300.0_wp
      self%enforcement%shear_slope = 90.0_wp
      call new_exponential(law, 5.0_wp, 0.3_wp)
      call set_method(self%enforcement, kind, law)
      self%enforcement%committed(:self%ndim) = random(self%ndim, 2.0_wp)
      self%enforcement%frozen(:self%ndim) = random(self%ndim, 2.0_wp)
      self%enforcement%creep(:self%ndim) = random(self%ndim, 0.02_wp)
      self%at = condition_type(yield=8.0_wp, mises=6.0_wp, dt=0.5_wp, speed=0.7_wp)
      self%dofs%n = maxval(self%dofs%id)
      ! The anchor is where the point is at rest.
      associate (still => [(0.0_wp, i=1, self%dofs%n)])
         call place_all(self, still)
      end associate
      call anchor_of(self%anchor, self%opposite)
      self%anchor%offset = offset_of(self%masters, self%points, 1)
      if (any(patch_names == name)) call leave_joint(self%anchor)
   end subroutine new_point_scene

   !> A foot that stays on a vertex slips only from an anchor elsewhere.
   pure subroutine leave_joint(anchor)
      type(anchor_type), intent(inout) :: anchor

      associate (share => anchor%share(:anchor%nnode))
         share = 0.9_wp*share + 0.1_wp/real(anchor%nnode, wp)
      end associate
   end subroutine leave_joint

   !> Node 1 is the slave, the others are the facet's, moved a little from a flat one.
   subroutine make_facet(self, cell)
      type(point_scene_type), intent(inout) :: self
      integer, intent(in) :: cell
      type(facets_type) :: facets
      type(error_type), allocatable :: error
      real(wp) :: xi(2), x(3), n(3), t1(3), t2(3)
      integer :: m, i

      m = self%basis%nnode(cell)
      facets%n = 1
      facets%element = [1]
      facets%face = [1]
      facets%cell = [cell]
      facets%nnode = [m]
      allocate (facets%node(8, 1), source=0)
      facets%node(:m, 1) = [(i + 1, i=1, m)]
      allocate (self%model%mesh%x(self%ndim, m + 1), source=0.0_wp)
      self%model%mesh%nnode = m + 1
      associate (at => self%model%mesh%x)
         do i = 1, m
            at(:, i + 1) = random(self%ndim, 0.06_wp)
            at(:min(2, self%ndim), i + 1) = at(:min(2, self%ndim), i + 1) + self%basis%xi(: &
               & min(2, self%ndim), i, cell)
         end do
         call new_surface(self%masters%of(1)%surface, self%ndim, facets)
         call update_surface(self%masters%of(1)%surface, at, error)
         call build_tree(self%masters%of(1)%tree, self%masters%of(1)%surface%low, &
            & self%masters%of(1)%surface%high)
         xi = self%basis%centre(:, cell) + random(2, 0.1_wp)
         if (self%ndim == 2) xi(2) = 0.0_wp
         associate (c => self%masters%of(1)%surface%coefficient(:, :, 1))
            x = c(:, 1) + xi(1)*c(:, 2) + xi(2)*c(:, 3) + xi(1)*xi(2)*c(:, 4) + xi(1)**2*c(:, 5) &
               & + xi(2)**2*c(:, 6) + xi(1)**2*xi(2)*c(:, 7) + xi(1)*xi(2)**2*c(:, 8)
            t1 = c(:, 2) + xi(2)*c(:, 4) + 2.0_wp*xi(1)*c(:, 5)
            t2 = c(:, 3) + xi(1)*c(:, 4) + 2.0_wp*xi(2)*c(:, 6)
         end associate
         if (self%ndim == 2) t2 = [0.0_wp, 0.0_wp, 1.0_wp]
         n = [t1(2)*t2(3) - t1(3)*t2(2), t1(3)*t2(1) - t1(1)*t2(3), t1(1)*t2(2) - t1(2)*t2(1)]
         x = x - 0.12_wp*n/norm2(n)
         at(:, 1) = x(:self%ndim)
      end associate
      call number_dofs(self)
   end subroutine make_facet

   !> Node 1 is the slave, over the middle of the patch.
   subroutine make_patch(self, name)
      type(point_scene_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(facets_type) :: facets
      type(error_type), allocatable :: error
      real(wp), allocatable :: x(:, :)
      real(wp), parameter :: height = 0.6_wp
      integer :: i, d

      call new_patch(name, x, facets)
      d = self%ndim
      where (facets%node > 0) facets%node = facets%node + 1
      self%is_smooth = is_dome(name)
      self%model%mesh%nnode = size(x, 2) + 1
      allocate (self%model%mesh%x(d, self%model%mesh%nnode))
      associate (at => self%model%mesh%x)
         at(:, 1) = random(d, 0.03_wp)
         at(d, 1) = at(d, 1) + height
         do i = 1, size(x, 2)
            at(:, i + 1) = x(:, i) + random(d, 0.03_wp)
         end do
         call new_surface(self%masters%of(1)%surface, d, facets, self%is_smooth)
         call update_surface(self%masters%of(1)%surface, at, error)
      end associate
      call build_tree(self%masters%of(1)%tree, self%masters%of(1)%surface%low, &
         & self%masters%of(1)%surface%high)
      self%shift = -height - 0.12_wp
      call number_dofs(self)
   end subroutine make_patch

   subroutine number_dofs(self)
      type(point_scene_type), intent(inout) :: self
      integer :: i, k

      allocate (self%dofs%id(6, self%model%mesh%nnode), source=0)
      do i = 1, self%model%mesh%nnode
         do k = 1, self%ndim
            self%dofs%id(k, i) = self%ndim*(i - 1) + k
         end do
      end do
   end subroutine number_dofs

   !> Node 1 is the slave, node 2 the reference node of the tool.
   subroutine make_tool(self, name)
      type(point_scene_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(foot_type) :: foot
      real(wp) :: x(3)
      integer :: k, d

      d = self%ndim
      deallocate (self%model%tool, self%model%rigid_body)
      allocate (self%model%tool(1), self%model%rigid_body(1))
      call make_shape(name, self%model%tool(1)%shape)
      self%model%tool(1)%rigid_body = 1
      self%model%rigid_body(1)%reference = 2
      self%masters%of(1)%tool = 1
      self%masters%of(1)%body = 1
      self%model%mesh%nnode = 2
      x = [0.9_wp, 1.1_wp, 0.7_wp] + random(3, 0.1_wp)
      call self%model%tool(1)%shape%project(x(:d), foot)
      x = foot%point - 0.12_wp*foot%normal
      self%model%mesh%x = reshape([x(:d), random(d, 1.0_wp)], [d, 2])
      allocate (self%dofs%id(6, 2), source=0)
      self%dofs%id(:d, 1) = [(k, k=1, d)]
      self%dofs%id(:d, 2) = [(d + k, k=1, d)]
      if (d == 2) self%dofs%id(6, 2) = 5
      if (d == 3) self%dofs%id(4:6, 2) = [7, 8, 9]
   end subroutine make_tool

   !> Nodes 3 and 4, the ends of the edge that node 1 is the middle of, on a curve of their own.
   subroutine add_ends(self)
      type(point_scene_type), intent(inout) :: self
      real(wp) :: x(self%ndim, 4), way(self%ndim)
      integer, allocatable :: id(:, :)
      integer :: d, k

      d = self%ndim
      way = [0.25_wp, -0.05_wp, 0.15_wp]
      x(:, :2) = self%model%mesh%x
      x(:, 3) = x(:, 1) + way(:d) + random(d, 0.02_wp)
      x(:, 4) = x(:, 1) - way(:d) + random(d, 0.02_wp)
      self%model%mesh%x = x
      self%model%mesh%nnode = 4
      allocate (id(6, 4), source=0)
      id(:, :2) = self%dofs%id
      id(:d, 3) = [(maxval(self%dofs%id) + k, k=1, d)]
      id(:d, 4) = [(maxval(self%dofs%id) + d + k, k=1, d)]
      call move_alloc(id, self%dofs%id)
      self%points%node = [1, 3, 4]
   end subroutine add_ends

   subroutine make_shape(name, shape)
      character(len=*), intent(in) :: name
      class(tool_type), allocatable, intent(out) :: shape
      type(plane_type) :: plane
      type(sphere_type) :: sphere
      type(cylinder_type) :: cylinder
      type(profile_tool_type) :: flat
      type(extruded_type) :: extruded
      type(revolved_type) :: revolved
      type(error_type), allocatable :: error
      real(wp), parameter :: one = 1.0_wp

      select case (name)
      case ('plane2')
         call new_plane(plane, [0.2_wp, 0.5_wp], [0.3_wp, one], error)
         allocate (shape, source=plane)
      case ('plane3')
         call new_plane(plane, [0.2_wp, 0.5_wp, 0.1_wp], [0.3_wp, one, -0.4_wp], error)
         allocate (shape, source=plane)
      case ('circle')
         call new_sphere(sphere, [0.1_wp, 0.2_wp], one, error)
         allocate (shape, source=sphere)
      case ('sphere')
         call new_sphere(sphere, [0.1_wp, 0.2_wp, -0.1_wp], 1.3_wp, error, cavity=.true.)
         allocate (shape, source=sphere)
      case ('cylinder')
         call new_cylinder(cylinder, [0.1_wp, 0.2_wp, -0.1_wp], [0.2_wp, 0.1_wp, one], one, error)
         allocate (shape, source=cylinder)
      case ('profile')
         call make_profile(flat%profile)
         flat%ndim = 2
         allocate (shape, source=flat)
      case ('extruded')
         call make_profile(extruded%profile)
         extruded%frame = reshape([0.6_wp, 0.8_wp, 0.0_wp, -0.8_wp, 0.6_wp, 0.0_wp, 0.0_wp, &
            & 0.0_wp, one], [3, 3])
         allocate (shape, source=extruded)
      case ('revolved')
         call make_profile(revolved%profile)
         revolved%axis = [0.0_wp, 0.0_wp, one]
         allocate (shape, source=revolved)
      end select
   end subroutine make_shape

   !> An arc about (1, 3), seen from below.
   subroutine make_profile(profile)
      type(profile_type), intent(out) :: profile
      type(segment_card_type) :: cards(2)
      type(error_type), allocatable :: error

      cards%word = ['START   ', 'CIRCL   ']
      cards(1)%value(:2) = [2.6_wp, 1.8_wp]
      cards(2)%value = [-0.6_wp, 1.8_wp, 1.0_wp, 3.0_wp]
      call new_profile(profile, cards, 0.0_wp, error)
   end subroutine make_profile

   !> Everything to X + u, and what is opposite there.
   subroutine place_all(self, u)
      type(point_scene_type), intent(inout) :: self
      real(wp), intent(in) :: u(:)
      type(error_type), allocatable :: error
      type(cost_type) :: cost
      type(opposite_type) :: opposite(self%points%n)
      logical :: met(2)
      integer :: i

      met = .false.
      self%masters%x = self%model%mesh%x
      call move_masters(self%masters, self%model, self%dofs, self%points, u, .false., cost, &
         & error)
      do i = 1, self%points%n
         call find_opposite(opposite(i), self%masters, self%model, self%points, i, cost)
      end do
      if (.not. self%rolls) call find_sample_feet(opposite, self%points, 1)
      if (self%rolls) call find_inner_feet(opposite, self%masters, self%points, self%model, &
         & self%model%mesh%x, met)
      self%opposite = opposite(1)
   end subroutine place_all

   !> -force and row at u, and the tangent if it is wanted.
   subroutine look(self, u, lambda, tangent)
      type(point_scene_type), intent(inout), target :: self
      real(wp), intent(in) :: u(:)             !! (ndof)
      real(wp), intent(in) :: lambda(3)
      logical, intent(in), optional :: tangent
      type(local_matrix_type) :: local
      type(point_view_type) :: point
      type(point_law_type) :: law
      integer :: a, b, n, first
      logical :: wanted

      wanted = .true.
      if (present(tangent)) wanted = tangent
      call place_all(self, u)
      if (allocated(self%points%growth(1)%slope)) self%at%growth = 1.1_wp &
         & + dot_product(self%points%growth(1)%slope, u)
      first = 0
      if (self%enforcement%method%solves_for_multiplier()) first = 1
      point%i = 1
      point%model => self%model
      point%dofs => self%dofs
      point%basis => self%basis
      point%masters => self%masters
      point%points => self%points
      point%opposite => self%opposite
      point%anchor => self%anchor
      law = point_law_type(self%enforcement, self%friction, self%at, self%shift, lambda, first, &
         & wanted)
      if (self%alone) then
         call evaluate_tool_point(self%state, local, point, law, self%reads_tool)
      else
         call evaluate_point(self%state, local, point, law)
      end if
      n = self%dofs%n + self%ndim
      self%residual = spread(0.0_wp, 1, n)
      self%k = reshape(spread(0.0_wp, 1, n*n), [n, n])
      self%spring = self%k
      if (self%is_tool) then
         do a = 1, 6
            b = self%dofs%id(a, 2)
            if (b > 0) self%residual(b) = -self%state%reaction(a)
         end do
      end if
      do a = 1, size(local%dof)
         if (a <= local%nu) then
            self%residual(local%dof(a)) = self%residual(local%dof(a)) - self%state%force(a)
         else if (local%dof(a) > self%dofs%n) then
            self%residual(local%dof(a)) = self%state%row(a - local%nu)
         end if
         if (.not. wanted) cycle
         do b = 1, size(local%dof)
            self%k(local%dof(a), local%dof(b)) = self%k(local%dof(a), local%dof(b)) + local%k(a, b)
            if (max(a, b) <= local%nu) self%spring(local%dof(a), local%dof(b)) = &
               & self%spring(local%dof(a), local%dof(b)) + local%spring(a, b)
         end do
      end do
   end subroutine look
end module point_scenes
