!> The certificate of an accepted increment: tests of quantities that the run computed.
module lopin_certificate
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_vectors, only : largest
   use lopin_one_unit, only : as_forces, to_forces, largest_force
   use lopin_model, only : model_type
   use lopin_report, only : certificate_type, energy_type
   use lopin_body_size, only : thinnest
   use lopin_constraints, only : reduce, prescribed_part
   use lopin_contact_points, only : pair_is_tied
   use lopin_reduced_rows, only : row_forces
   use lopin_scene, only : scene_type
   use lopin_rounding_floor, only : noise_of_places, floor_of_forces, beyond
   use lopin_check_mesh, only : check_corners
   use lopin_hourglass_energy, only : hourglass_energy
   use lopin_methods, only : has_law, obeys_deck
   implicit none
   private
   public :: forces_type, find_forces, certify, give_verdict, hold_traction, check_hourglass

   !> PASS up to these, WARN above, FAIL above ten times (conventions, frozen).
   real(wp), parameter :: complementarity_limit = 1.0e-6_wp, equilibrium_limit = 1.0e-6_wp
   real(wp), parameter :: cone_limit = 1.0e-6_wp, dissipation_limit = 1.0e-9_wp
   !> A compliance below this share of the largest is rounding: an artificial support holds the row.
   real(wp), parameter :: rounded = 1.0e-12_wp
   real(wp), parameter :: balance_limit = 1.0e-3_wp, flow_limit = 1.0e-2_wp
   real(wp), parameter :: penalty_limit = 2.0e-2_wp
   real(wp), parameter, public :: artificial_limit = 1.0e-2_wp
   real(wp), parameter :: traction_limit = 2.0e-2_wp

   !> Energies of friction below this share of those of the scene are not judged beside themselves.
   real(wp), parameter :: share_of_energy = 1.0e-6_wp

   !> All forces of a state, on the physical dofs: residual = internal - load - pressed.
   type :: forces_type
      real(wp), allocatable :: load(:)       !! (ndof) [force]
      real(wp), allocatable :: internal(:)   !! (ndof) K u [force]
      real(wp), allocatable :: pressed(:)    !! (ndof) of the contacts [force]
      real(wp), allocatable :: residual(:)   !! (ndof) [force]
      real(wp), allocatable :: reaction(:)   !! (nprescribed) [force]
   end type forces_type

contains

   !> The forces of the trial state under loads f.
   subroutine find_forces(self, scene, f)
      type(forces_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: f(:)             !! (ndof) [force]

      self%load = f
      allocate (self%internal(scene%dofs%n), self%reaction(scene%constraints%nprescribed))
      allocate (self%pressed(scene%dofs%n), source=0.0_wp)
      call scene%k%multiply(scene%trial%motion%u, self%internal)
      call row_forces(scene%rows, scene%answer%force, self%pressed)
      self%residual = self%internal - f - self%pressed
      call prescribed_part(scene%constraints, self%residual, self%reaction)
   end subroutine find_forces

   !> Tests of the trial state.
   subroutine certify(self, energy, scene, model, forces, prescribed)
      type(certificate_type), intent(out) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(forces_type), intent(in) :: forces
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed) [length]
      real(wp) :: free(scene%constraints%neq), floor(scene%constraints%neq)
      real(wp) :: reference, work, passed, noise, rounded

      call reduce(scene%constraints, forces%residual, free)
      noise = noise_of_places(scene)
      call floor_of_forces(scene, floor)
      ! Linear solids without stresses of the start have no forces that cancel at every node.
      associate (c => scene%constraints)
         call to_forces(scene, free, c%dof_of_equation)
         call to_forces(scene, floor, c%dof_of_equation)
         reference = max(largest_force(scene, forces%load), largest(as_forces(scene, &
            & forces%reaction, c%dof_of_prescribed)), largest_force(scene, forces%internal), &
            & largest(floor))
      end associate
      if (reference > 0.0_wp) then
         self%equilibrium = beyond(free, floor)/reference
         self%support = beyond(free(scene%bodies%support), floor(scene%bodies%support))/reference
      end if
      call check_contact(self, energy, scene, model, noise)
      call sum_works(scene%trial%motion%u, forces, energy%strain, work, passed)
      call check_work(self, energy, scene, largest(floor))
      call check_hourglass(self, energy, scene, model)
      self%obeys = obeys_deck(model)
      rounded = 0.0_wp
      if (scene%rows%n > 0) rounded = drift(scene)
      if (scene%rows%n > 0) self%pressure_error = max(scene%answer%soft_error, rounded)
      call check_action(self, scene, model, forces%pressed)
      ! Clapeyron: at equilibrium loads, contact and reactions do twice the stored energy's work.
      ! Where the forces all but cancel no energy is stored: what they do one by one is the measure.
      work = work + dot_product(forces%reaction, prescribed)
      passed = max(passed, largest(floor)*largest(scene%trial%motion%u)/balance_limit)
      if (passed > 0.0_wp) self%energy = abs(work - 2.0_wp*energy%strain)/passed
      call check_corners(self, scene, model)
      call give_verdict(self, rounded)
   end subroutine certify

   !> What forces do on displacements u from rest.
   pure subroutine sum_works(u, forces, strain, work, passed)
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      type(forces_type), intent(in) :: forces
      real(wp), intent(out) :: strain          !! half of that of internal forces [energy]
      real(wp), intent(out) :: work            !! of loads and contact [energy]
      real(wp), intent(out) :: passed          !! sizes of all of them, one by one [energy]
      integer :: i

      strain = 0.0_wp
      work = 0.0_wp
      passed = 0.0_wp
      associate (internal => forces%internal, load => forces%load, pressed => forces%pressed)
         do i = 1, size(u)
            strain = strain + u(i)*internal(i)
            work = work + u(i)*(load(i) + pressed(i))
            passed = passed + abs(u(i))*(abs(load(i)) + abs(pressed(i)) + abs(internal(i)))
         end do
      end associate
      strain = 0.5_wp*strain
   end subroutine sum_works

   !> Gaps made from the displacements against those the contact forces were found with, beside what
   !> the forces do to gaps: the share of the forces that rounding made. A stiff penalty loses
   !> digits this way.
   pure real(wp) function drift(scene)
      type(scene_type), intent(in) :: scene
      real(wp) :: gap
      integer :: row, k

      drift = 0.0_wp
      if (.not. scene%answer%opening > 0.0_wp) return
      do row = 1, scene%rows%n
         gap = scene%rows%gap0(row)
         do k = scene%rows%first(row), scene%rows%first(row + 1) - 1
            gap = gap + scene%rows%coefficient(k)*scene%trial%motion%u(scene%rows%dof(k))
         end do
         drift = max(drift, abs(gap - scene%answer%gap(row)))
      end do
      drift = drift/scene%answer%opening
   end function drift

   !> Gaps and forces of all rows, exact and soft apart.
   subroutine check_contact(self, energy, scene, model, noise)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: noise            !! of places [length]
      real(wp) :: p_ref, size_, scaled, stiff, bite, thin, softest
      integer :: row, pair
      logical :: exact

      energy%contact = 0.0_wp
      if (scene%rows%n == 0) return
      energy%friction = sum(scene%trial%friction%work)
      energy%friction_mean = sum(scene%trial%friction%mean_work)
      softest = softest_row(scene)
      p_ref = max(largest(scene%answer%force), maxval([0.0_wp, &
         & (noise*stiffness_of(scene, row, softest), row=1, scene%rows%nnormal)]))
      do pair = 1, size(model%pair)
         exact = is_exact(model, pair)
         if (.not. exact) thin = thinnest(scene%bodies, model, pair)
         do row = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
            call check_row(row)
         end do
      end do
      if (.not. p_ref > 0.0_wp) self%complementarity = max(0.0_wp, self%penetration)
      energy%contact = energy%contact + scene%friction%stored
      self%complementarity = max(self%complementarity, scene%friction%misfit)
      self%rubs%cone = scene%friction%cone_excess

   contains

      subroutine check_row(row)
         integer, intent(in) :: row

         size_ = scene%points%size(scene%rows%point(row))
         associate (force => scene%answer%force(row), gap => scene%answer%gap(row))
            ! A spring may start at a clearance: what counts as penetration is the gap itself.
            if (.not. scene%rows%tied(row)) then
               bite = -(gap + model%interaction(model%pair(pair)%interaction)%clearance)
               self%penetration = max(self%penetration, bite/size_)
               if (.not. exact) self%depth = max(self%depth, bite/thin)
            end if
            stiff = stiffness_of(scene, row, softest)
            if (.not. scene%rows%bilateral(row) .and. p_ref > 0.0_wp) &
               & self%tension = max(self%tension, -(force + noise*stiff)/p_ref)
            if (exact) then
               if (.not. stiff > 0.0_wp) stiff = p_ref/size_
               scaled = stiff*sign(max(abs(gap) - noise, 0.0_wp), gap)
               if (scene%rows%bilateral(row)) then
                  scaled = abs(scaled)
               else
                  scaled = abs(min(force, scaled))
               end if
               if (p_ref > 0.0_wp) self%complementarity = max(self%complementarity, scaled/p_ref)
            else if (scene%problem%alpha(row) > 0.0_wp .and. .not. has_law(model, pair)) then
               energy%contact = energy%contact &
                  & + scene%problem%group(pair)%method%stored(gap, force, &
                  & scene%problem%alpha(row))
            end if
         end associate
      end subroutine check_row
   end subroutine check_contact

   !> The method of a pair allows no penetration.
   logical function is_exact(model, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      associate (method => model%interaction(model%pair(pair)%interaction)%method, &
         & control => model%pair(pair)%control)
         is_exact = method%is_exact()
         if (method%updates()) is_exact = control%relative_penetration <= 0.0_wp &
            & .and. control%absolute_penetration <= 0.0_wp
      end associate
   end function is_exact

   !> Work of friction is not negative but for what rounding leaves, beside what slips, and beside
   !> the energies of the scene.
   subroutine check_work(self, energy, scene, floor)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(in) :: energy
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: floor            !! of forces [force]
      real(wp) :: scale

      scale = max(scene%friction%slid_work, share_of_energy*max(abs(energy%external), &
         & energy%strain, energy%contact), floor*largest(scene%points%size))
      self%rubs%ramp = scene%friction%ramp
      if (scene%friction%gained < -dissipation_limit*scale) &
         & self%rubs%dissipation = scene%friction%gained/scale
   end subroutine check_work

   !> Force per gap of a row by the compliance; 0 where it is not known [force/length].
   pure real(wp) function stiffness_of(scene, row, softest) result(stiffness)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: row
      real(wp), intent(in) :: softest          !! largest compliance of a row [length/force]

      stiffness = 0.0_wp
      if (.not. allocated(scene%problem%s)) return
      if (scene%problem%s(row, row) > softest*rounded) stiffness = 1.0_wp/scene%problem%s(row, row)
   end function stiffness_of

   !> Largest compliance of a row; 0 where it is not known [length/force].
   pure real(wp) function softest_row(scene) result(softest)
      type(scene_type), intent(in) :: scene
      integer :: row

      softest = 0.0_wp
      if (.not. allocated(scene%problem%s)) return
      do row = 1, scene%rows%nsolved
         softest = max(softest, scene%problem%s(row, row))
      end do
   end function softest_row

   !> The forces on slaves and masters balance as a whole.
   subroutine check_action(self, scene, model, pressed)
      type(certificate_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: pressed(:)
      real(wp) :: total(3), size_
      integer :: dof, row
      logical :: closed_loop

      ! Pairs with a tool that no node moves have no master dofs: there is nothing to balance there.
      closed_loop = size(model%pair) > 0
      do row = 1, size(model%pair)
         if (scene%points%tool(row) > 0 .and. scene%points%body(row) == 0) closed_loop = .false.
      end do
      if (.not. closed_loop) return
      total = 0.0_wp
      do dof = 1, scene%dofs%n
         if (pressed(dof) == 0.0_wp) cycle
         if (scene%dofs%dof(dof) > 3) cycle
         total(scene%dofs%dof(dof)) = total(scene%dofs%dof(dof)) + pressed(dof)
      end do
      if (.not. allocated(scene%answer%force)) return
      size_ = sum(abs(scene%answer%force))
      if (model%mesh%ndim == 2 .and. scene%dofs%n > 0) total(3) = 0.0_wp
      if (any(scene%dofs%id(1, :) == 0 .and. scene%dofs%id(2, :) > 0)) total(1) = 0.0_wp
      if (size_ > 0.0_wp) self%action_reaction = norm2(total)/size_
   end subroutine check_action

   !> How much of the bodies' energy only holds bricks of one point in shape.
   subroutine check_hourglass(self, energy, scene, model)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      energy%hourglass = hourglass_energy(scene%solids, model%mesh, scene%trial%motion%u, &
         & scene%accepted%solids%finite_strain)
      if (energy%hourglass > 0.0_wp) self%artificial = energy%hourglass/max(energy%strain &
         & + scene%trial%solids%work, energy%hourglass)
   end subroutine check_hourglass

   subroutine give_verdict(self, rounded)
      type(certificate_type), intent(inout) :: self
      real(wp), intent(in), optional :: rounded   !! share of the error of pressures by rounding
      logical :: by_rounding

      self%reason = ''
      call hold(self, 'complementarity', self%complementarity, complementarity_limit)
      call hold(self, 'friction beyond its bound', self%rubs%cone, cone_limit)
      call hold(self, 'negative dissipation', -self%rubs%dissipation, dissipation_limit)
      call hold(self, 'tension', self%tension, complementarity_limit)
      call hold(self, 'equilibrium', self%equilibrium, equilibrium_limit)
      call hold(self, 'action and reaction', self%action_reaction, equilibrium_limit)
      call hold(self, 'artificial support', self%support, equilibrium_limit)
      call hold(self, 'artificial work', self%artificial, artificial_limit, 1)
      call hold(self, 'energy balance', self%energy, merge(flow_limit, balance_limit, self%flows))
      by_rounding = .false.
      if (present(rounded)) by_rounding = rounded > 0.0_wp &
         & .and. .not. rounded < self%pressure_error
      call hold_pressure(self, by_rounding)
      call hold(self, 'penetration beside the body', self%depth, penalty_limit, 1)
      if (self%folded == 0) return
      self%verdict = max(self%verdict, self%fold_level)
      self%excess = self%excess + 1.0_wp - self%corner
      if (len(self%reason) > 0) self%reason = self%reason//'; '
      self%reason = self%reason//'a corner of element '//to_text(self%folded)//' is turned '// &
         & 'inside '// &
         & 'out, its scaled Jacobian '//short(self%corner)
   end subroutine give_verdict

   !> The error of the pressures where contact gives way, or where rounding has made them.
   subroutine hold_pressure(self, by_rounding)
      type(certificate_type), intent(inout) :: self
      logical, intent(in) :: by_rounding
      integer :: most

      most = merge(1, 2, self%obeys)
      if (by_rounding) then
         call hold(self, 'gaps at odds with the contact forces', self%pressure_error, &
            & penalty_limit, most)
         return
      end if
      ! A slope that the deck gives is used as given, with a warning.
      call hold(self, 'estimated pressure error of the penalty', self%pressure_error, &
         & penalty_limit, most)
      if (self%obeys .and. self%pressure_error > penalty_limit) self%reason = self%reason// &
         & ' (beside hard contact: none if the slope of the deck is a law of the surface)'
   end subroutine hold_pressure

   !> The pressures as printed were judged by themselves, when all else was done.
   !> What a tie holds, or a pair that does not separate, is right without them; supports share its
   !> forces in the way of least norm.
   !> What is lost at the rim of contact alone says that the mesh is coarse for pressures there.
   subroutine hold_traction(self, pair, within, is_tied)
      type(certificate_type), intent(inout) :: self
      character(len=*), intent(in) :: pair     !! its name
      real(wp), intent(in) :: within           !! the same of facets that are not at the rim
      logical, intent(in) :: is_tied           !! or does not separate

      call hold(self, 'force that the pressures of pair '//pair//' do not carry', &
         & self%traction, traction_limit, merge(1, 2, is_tied .or. within <= traction_limit))
   end subroutine hold_traction

   !> One test: what it makes of the verdict, and of the reason.
   subroutine hold(self, what, value, limit, most)
      type(certificate_type), intent(inout) :: self
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: value, limit
      integer, intent(in), optional :: most    !! level
      integer :: level

      level = 0
      if (.not. value <= limit) level = 1
      if (.not. value <= 10.0_wp*limit) level = 2
      if (present(most)) level = min(level, most)
      if (level == 0) return
      self%verdict = max(self%verdict, level)
      self%excess = self%excess &
         & + merge(value/limit, sqrt(huge(1.0_wp)), value <= huge(1.0_wp))
      if (len(self%reason) > 0) self%reason = self%reason//'; '
      self%reason = self%reason//what//' '//short(value)//' > '//short(limit)
   end subroutine hold

   function short(value) result(text)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=12) :: buffer
      write (buffer, '(es9.2)') value
      text = trim(adjustl(buffer))
   end function short
end module lopin_certificate
