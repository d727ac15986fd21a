!> The accepted state, a trial of the next increment, and the workspace: what can be made again from
!> the model and the state.
module lopin_scene
   use lopin_kinds, only : wp
   use lopin_state, only : state_type, begin
   use lopin_error, only : error_type, log_type
   use lopin_clock, only : clock_type, counter_type, phase
   use lopin_csc, only : csc_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_constraints, only : constraints_type, new_constraints, raw_displacement
   use lopin_bodies, only : bodies_type, new_bodies
   use lopin_solids, only : solids_type, new_solids
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_assemble_springs, only : attach_springs
   use lopin_contact_points, only : contact_points_type, pair_is_tied
   use lopin_pairing, only : new_contact_points
   use lopin_tool_points, only : move_tool
   use lopin_row_samples, only : sample_type, find_samples, row_value, has_inner
   use lopin_initial_gaps, only : initial_gap_type, new_initial_gaps
   use lopin_contact_rows, only : contact_rows_type, new_contact_rows
   use lopin_tie_release, only : release_ties
   use lopin_constraint_rules, only : rule_type
   use lopin_eliminated_ties, only : eliminate_ties
   use lopin_chord_sag, only : report_chords
   use lopin_carried_force, only : skin_type
   use lopin_condensed, only : condensed_type
   use lopin_active_set, only : contact_result_type
   use lopin_friction_state, only : friction_tests_type, new_friction_history, new_friction_tests
   use lopin_skins, only : new_skins
   use lopin_straight_loads, only : straight_loads_type
   use lopin_linear_system, only : linear_system_type
   use lopin_full_system, only : full_system_type
   use lopin_newton_workspace, only : newton_workspace_type
   use lopin_tool_plane, only : plane_type
   use lopin_section_properties, only : sections_of
   use lopin_watcher, only : watcher_type
   use lopin_node_spread, only : node_spread_type
   implicit none
   private
   public :: scene_type, new_scene, meet_surfaces, begin_scene, set_supports, retained_equations
   public :: rebuild_rows, follow_tools, stand_tools

   !> The state of a run and its workspace. Many components: one object for each part of the
   !> algorithm (solids, rows, systems), grouped by how long it lives.
   type :: scene_type
      type(state_type) :: accepted, trial          !! all that evolves; the rest follows from it
      type(skin_type), allocatable :: skin(:)      !! (npair) faces of the slaves
      type(dofs_type) :: dofs
      type(solids_type) :: solids
      type(csc_type) :: k                          !! stiffness of all physical dofs
      real(wp), allocatable :: stiffness(:)        !! (ndof) its diagonal
      real(wp) :: farthest = 0.0_wp                !! of the model: largest coordinate [length]
      type(contact_points_type) :: points
      type(initial_gap_type) :: initial
      ! of a step
      integer :: step = 0
      type(constraints_type) :: constraints
      logical :: eliminates = .false.   !! slaves of exact ties are no unknowns
      type(constraints_type) :: supports   !! the constraints but for eliminated ties
      type(bodies_type) :: bodies
      type(linear_system_type) :: system
      type(full_system_type) :: full               !! in the place of `system` on the path newton
      logical :: fresh_factor = .true.
      logical :: tools_first = .false.   !! until tools rest, only what moves them is solved for
      type(straight_loads_type) :: straight        !! passes that serve all increments of the step
      integer, allocatable :: kept_last(:)         !! equations, of a factor that is made again
      type(newton_workspace_type) :: newton        !! of the nonlinear path; else unused
      ! of an increment
      type(contact_rows_type) :: rows
      type(condensed_type) :: problem
      type(contact_result_type) :: answer
      type(friction_tests_type) :: friction        !! of the last solve
      integer, allocatable :: kept_equation(:)     !! rows in which the problem stands
      real(wp), allocatable :: kept_value(:)
      real(wp) :: stiffer = 1.0_wp                 !! times slopes are raised in it
      real(wp), allocatable :: gap(:)              !! (nrow) gaps at zero equations
      real(wp), allocatable :: place(:, :)         !! (6, nbody) where tools were projected
      real(wp) :: interference = 1.0_wp            !! share of initial overclosures that is applied
      real(wp), allocatable :: guess(:)   !! (ndof) those that place the tools that forces move
      logical :: again = .false.          !! the answer is that of this increment, tools placed anew
      real(wp) :: margin = 0.0_wp   !! displacements below a quarter of it fold no corner [length]
      type(node_spread_type) :: spread    !! how far the nodes of elements move apart
      real(wp), allocatable :: spare(:)   !! (nelement) how far they may [length]
      logical :: may_cut = .false.    !! the increment that is tried may be cut if it fails
      real(wp) :: turned = 0.0_wp     !! tool against sliding points in the increment [rad]
      logical :: may_part = .false.   !! an increment in which contact begins may be cut
      real(wp) :: least_part = 0.0_wp    !! share of the increment that a part of it is at least
      real(wp) :: first_touch = 0.0_wp   !! share of the increment before it
      class(watcher_type), allocatable :: watcher  !! told of what happens; it changes nothing
      type(clock_type) :: clock
      type(counter_type) :: counter
      type(log_type) :: log
   end type scene_type

contains

   !> The workspace of a model before its first increment: bodies; `meet_surfaces` and `begin_scene`
   !> follow.
   subroutine new_scene(self, model, error)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call new_dofs(self%dofs, model)
      call new_solids(self%solids, model%mesh, model%element_word, sections_of(model), &
         & self%dofs%id, self%k, error)
      if (allocated(error)) return
      call attach_springs(self%solids, model%mesh, model%spring, self%k)
      call assemble_stiffness(self%solids, model%mesh, self%k, error)
      if (allocated(error)) return
      allocate (self%stiffness(self%dofs%n))
      call self%k%diagonal(self%stiffness)
      call self%spread%new(model, self%dofs)
      self%farthest = max(maxval(model%mesh%x), -minval(model%mesh%x))
      call self%clock%stop_in(phase%assemble)
   end subroutine new_scene

   !> What touches what at the start.
   subroutine meet_surfaces(self, model, error)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call new_contact_points(self%points, model, self%log, error)
      if (allocated(error)) return
      call new_skins(self%skin, model)
      call new_initial_gaps(self%initial, model, self%points, self%log, error)
      if (allocated(error)) return
      call report_chords(self%points, model, self%initial, self%log, error)
      if (allocated(error)) return
      call self%clock%stop_in(phase%search)
   end subroutine meet_surfaces

   !> The state before the first increment.
   subroutine begin_scene(self, model)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model

      allocate (self%accepted%motion%u(self%dofs%n), self%guess(self%dofs%n), source=0.0_wp)
      allocate (self%place(6, size(model%rigid_body)), source=0.0_wp)
      call new_friction_history(self%accepted%friction, self%initial%touches)
      associate (loads => self%accepted%loads)
         allocate (loads%steady(self%dofs%n), loads%force(self%dofs%n), &
            & loads%reaction(self%dofs%n), loads%internal(self%dofs%n), source=0.0_wp)
      end associate
      allocate (self%accepted%solver%candidate(self%points%n), source=.true.)
      call begin(self%trial, self%accepted)
      call new_friction_tests(self%friction, self%points%n)
   end subroutine begin_scene

   !> Constraints and floating motions of a step; `same` if they are those of the step before.
   subroutine set_supports(self, model, step, same, error)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      logical, intent(out) :: same
      type(error_type), allocatable, intent(out) :: error
      type(constraints_type) :: constraints
      integer, allocatable :: own(:)
      type(rule_type), allocatable :: rule(:)

      call new_constraints(constraints, model, self%dofs, model%step(step), error)
      if (allocated(error)) return
      same = self%step > 0
      if (same) same = constraints%neq == self%supports%neq
      if (same) same = all(constraints%dof_of_equation == self%supports%dof_of_equation)
      self%step = step
      self%supports = constraints
      if (.not. same) call release_ties(self%points, model, self%dofs, constraints)
      if (self%eliminates) then
         call eliminate_ties(self%points, model, self%dofs, constraints, own, rule)
         if (size(own) > 0) call new_constraints(constraints, model, self%dofs, &
            & model%step(step), error, own=own, given=rule)
         if (allocated(error)) return
      end if
      self%constraints = constraints
      if (same) return
      call new_bodies(self%bodies, model, self%dofs, self%constraints)
   end subroutine set_supports

   !> Free equations that rows touch or may touch, in increasing order, without artificial supports.
   subroutine retained_equations(self, model, retained)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, allocatable, intent(out) :: retained(:)
      logical, allocatable :: wanted(:)
      integer :: i, k, pair

      allocate (wanted(self%constraints%neq), source=.false.)
      call new_contact_rows(self%rows, model, self%dofs, self%points, self%initial, self%place, &
         & self%accepted%friction%closed, self%accepted%solver%candidate)
      do k = 1, self%rows%first(self%rows%nsolved + 1) - 1
         call want(self%rows%dof(k))
      end do
      do pair = 1, size(model%pair)
         if (.not. may_turn(self, model, pair)) cycle
         do i = self%points%first(pair), self%points%first(pair + 1) - 1
            if (.not. self%accepted%solver%candidate(i)) cycle
            call want_node(self%points%node(i))
            if (.not. self%points%share(i) > 0.0_wp) cycle
            do k = 1, 2
               call want_node(self%points%node(self%points%corner(k, i)))
            end do
         end do
         if (allocated(self%points%face)) call want_faces(pair)
         associate (reference => model%rigid_body(self%points%body(pair))%reference)
            do k = 1, 6
               if (self%dofs%id(k, reference) > 0) call want(self%dofs%id(k, reference))
            end do
         end associate
      end do
      wanted(self%bodies%support) = .false.
      retained = pack([(i, i=1, self%constraints%neq)], wanted)

   contains

      subroutine want_node(node)
         integer, intent(in) :: node
         integer :: c
         do c = 1, model%mesh%ndim
            if (self%dofs%id(c, node) > 0) call want(self%dofs%id(c, node))
         end do
      end subroutine want_node

      !> Points inside a facet push all its nodes.
      subroutine want_faces(pair)
         integer, intent(in) :: pair
         integer :: i, k

         do i = 1, size(self%points%face)
            associate (f => self%points%face(i))
               if (f%pair /= pair .or. .not. any(self%accepted%solver%candidate( &
                  & f%point(:f%nnode)))) cycle
               do k = 1, f%nnode
                  call want_node(f%node(k))
               end do
            end associate
         end do
      end subroutine want_faces

      subroutine want(dof)
         integer, intent(in) :: dof
         integer :: c
         do c = self%constraints%first(dof), self%constraints%first(dof + 1) - 1
            wanted(self%constraints%equation(c)) = .true.
         end do
      end subroutine want
   end subroutine retained_equations

   !> The normals of this pair change while the tool moves.
   logical function may_turn(self, model, pair)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      may_turn = .false.
      if (self%points%body(pair) == 0) return
      select type (shape => model%tool(self%points%tool(pair))%shape)
      type is (plane_type)
         may_turn = body_turns(self, model, self%points%body(pair))
      class default
         may_turn = .true.
      end select
   end function may_turn

   !> A rigid body has a rotation that is free, or prescribed in some step.
   logical function body_turns(self, model, body) result(turns)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      integer :: i, k, id

      turns = any(self%place(4:, body) /= 0.0_wp)
      do k = 4, 6
         id = self%dofs%id(k, model%rigid_body(body)%reference)
         if (id > 0) turns = turns .or. self%constraints%rule(id)%prescribed == 0
      end do
      do i = 1, size(model%step)
         associate (p => model%step(i)%prescribed)
            do k = 1, size(p)
               id = self%dofs%id(p(k)%dof, p(k)%node)
               if (id == 0 .or. .not. abs(p(k)%value) > 0.0_wp) cycle
               turns = turns .or. (self%dofs%node(id) == model%rigid_body(body)%reference &
                  & .and. self%dofs%dof(id) > 3)
            end do
         end associate
      end do
   end function body_turns

   !> Where the rigid bodies' references stand: prescribed dofs as given, free ones as guessed.
   subroutine tool_places(self, model, prescribed, place)
      type(scene_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)
      real(wp), intent(out) :: place(:, :)
      integer :: body, k, id

      place = 0.0_wp
      do body = 1, size(model%rigid_body)
         do k = 1, 6
            id = self%dofs%id(k, model%rigid_body(body)%reference)
            if (id > 0) place(k, body) = expand_one(self, id, prescribed)
         end do
      end do
   end subroutine tool_places

   !> One dof by the guess of the free equations and the prescribed values.
   pure real(wp) function expand_one(self, id, prescribed) result(u)
      type(scene_type), intent(in) :: self
      integer, intent(in) :: id
      real(wp), intent(in) :: prescribed(:)
      integer :: k

      u = 0.0_wp
      associate (c => self%constraints)
         do k = c%first(id), c%first(id + 1) - 1
            u = u + c%coefficient(k)*raw_displacement(c, self%dofs, self%guess, &
               & c%dof_of_equation(c%equation(k)))
         end do
         do k = c%pfirst(id), c%pfirst(id + 1) - 1
            u = u + c%pcoefficient(k)*prescribed(c%prescribed(k))
         end do
      end associate
   end function expand_one

   !> Guess that the tools stand where the last solve moved them; `way` is how far a
   !> curved one then stands from where it was projected, as a share of the scene.
   subroutine follow_tools(self, model, prescribed, way)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)
      real(wp), intent(out) :: way
      real(wp) :: place(6, size(model%rigid_body)), moved
      integer :: pair

      self%guess = self%trial%motion%u
      call tool_places(self, model, prescribed, place)
      way = 0.0_wp
      do pair = 1, size(model%pair)
         associate (body => self%points%body(pair))
            if (.not. may_turn(self, model, pair)) cycle
            if (pair_is_tied(model, model%pair(pair))) cycle
            moved = norm2(place(:3, body) - self%place(:3, body)) &
               & + self%bodies%length*norm2(place(4:, body) - self%place(4:, body))
            way = max(way, moved/(self%bodies%length + norm2(place(:3, body))))
         end associate
      end do
   end subroutine follow_tools

   !> Rows for the place of the tools at the end of the increment.
   subroutine rebuild_rows(self, model, prescribed)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)
      integer :: row
      real(wp) :: place(6, size(model%rigid_body))
      type(sample_type), allocatable :: sample(:)

      call tool_places(self, model, prescribed, place)
      call stand_tools(self, model, place)
      call new_contact_rows(self%rows, model, self%dofs, self%points, self%initial, self%place, &
         & self%accepted%friction%closed, self%accepted%solver%candidate)
      do row = 1, self%rows%nnormal
         if (self%rows%tied(row)) cycle
         associate (point => self%rows%point(row))
            call find_samples(self%points, point, model%mesh%x, sample)
            self%rows%gap0(row) = self%rows%gap0(row) &
               & + (1.0_wp - self%interference)*row_value(self%points, sample, &
               & self%initial%overclosure) &
               & + (1.0_wp - self%interference)*merge(0.0_wp, self%initial%early(point), &
               & has_inner(self%points, point)) &
               & - model%interaction(model%pair(self%points%pair(point))%interaction)%clearance
         end associate
      end do
   end subroutine rebuild_rows

   !> Project the points on the tools where these stand; what does not move is left alone.
   subroutine stand_tools(self, model, place)
      type(scene_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: place(:, :)      !! (6, nbody) of the references [length], [rad]
      real(wp), allocatable :: rotation(:)
      real(wp) :: before(6, size(model%rigid_body))
      integer :: pair

      before = self%place
      self%place = place
      do pair = 1, size(model%pair)
         associate (body => self%points%body(pair))
            if (body == 0) cycle
            if (pair_is_tied(model, model%pair(pair))) cycle
            if (all(place(:, body) == before(:, body))) cycle
            rotation = place(4:6, body)
            if (model%mesh%ndim == 2) rotation = place(6:6, body)
            call move_tool(self%points, model, pair, place(:model%mesh%ndim, body), rotation)
         end associate
      end do
   end subroutine stand_tools
end module lopin_scene
