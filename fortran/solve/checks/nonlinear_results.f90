!> Forces, certificate and contact fields of an increment of the nonlinear path.
module lopin_nonlinear_results
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_friction, only : has_friction
   use lopin_vectors, only : largest
   use lopin_model, only : model_type
   use lopin_report, only : certificate_type, energy_type, contact_field_type
   use lopin_constraints, only : reduce, prescribed_part
   use lopin_body_size, only : thinnest
   use lopin_check_mesh, only : check_corners
   use lopin_methods, only : obeys_deck
   use lopin_certificate, only : forces_type, give_verdict, check_hourglass
   use lopin_one_unit, only : as_forces
   use lopin_residual, only : largest_force, largest_pressure, gap_rounding
   use lopin_nonlinear_start, only : complementarity
   use lopin_rounding_floor, only : beyond
   use lopin_slave_areas, only : areas_now, pieces_now
   use lopin_row_resultants, only : row_resultants
   use lopin_slip_increment, only : dissipated, mean_work_of, held_energy, shear_bound, &
      & shear_excess, path_of, lost_bound
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: find_nonlinear_forces, certify_nonlinear, nonlinear_contact_fields, report_nonlinear

   !> Energies of friction below this share of those of the scene are not judged beside themselves.
   real(wp), parameter :: share_of_energy = 1.0e-6_wp
   !> Work of friction may be negative to this share of what is about (conventions, frozen).
   real(wp), parameter :: least_share = 1.0e-9_wp

contains

   !> The forces of the trial state, as Newton left them.
   subroutine find_nonlinear_forces(self, scene, f)
      type(forces_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]

      self%load = f
      self%internal = scene%newton%internal
      self%pressed = scene%newton%contact%force
      self%residual = self%internal - f - self%pressed
      allocate (self%reaction(scene%constraints%nprescribed))
      call prescribed_part(scene%constraints, self%residual, self%reaction)
   end subroutine find_nonlinear_forces

   !> Equilibrium, complementarity, action and reaction of the trial state.
   !>
   !> The work of large increments is not integrated exactly by any rule that sees only their ends:
   !> the energies are reported, the verdict does not use them.
   subroutine certify_nonlinear(self, energy, scene, model, forces)
      type(certificate_type), intent(out) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(forces_type), intent(in) :: forces
      real(wp), allocatable :: free(:), floor(:)
      real(wp) :: reference

      allocate (free(scene%constraints%neq))
      call reduce(scene%constraints, forces%residual, free)
      floor = as_forces(scene, scene%newton%floor, scene%constraints%dof_of_equation)
      reference = max(scene%newton%reference, largest_force(scene, forces%load, forces%reaction), &
         & largest(floor))
      if (reference > 0.0_wp) self%equilibrium = beyond(as_forces(scene, free, &
         & scene%constraints%dof_of_equation), floor)/reference
      energy%strain = scene%newton%energy
      call check_points(self, scene, model)
      call check_friction(self, energy, scene)
      call check_work(self, energy, scene)
      call check_hourglass(self, energy, scene, model)
      call check_balance(self, scene, model, forces%pressed)
      call check_corners(self, scene, model)
      call give_verdict(self)
   end subroutine certify_nonlinear

   !> Shear within its bound, and the energies of friction of the trial state.
   subroutine check_friction(self, energy, scene)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      real(wp) :: lost, whole, all_lost, all_whole
      integer :: i

      energy%contact = 0.0_wp
      energy%friction = 0.0_wp
      energy%friction_mean = 0.0_wp
      all_lost = 0.0_wp
      all_whole = 0.0_wp
      associate (c => scene%newton%contact, before => scene%accepted%contact)
         do i = 1, c%n
            energy%friction = energy%friction + before%friction_work(i)
            energy%friction_mean = energy%friction_mean + before%mean_work(i)
            if (c%facet(i) == 0 .or. c%enforcement(i)%tied) cycle
            energy%friction = energy%friction + dissipated(c, i)*c%weight(i)
            energy%friction_mean = energy%friction_mean + mean_work_of(c, i)*c%weight(i)
            energy%contact = energy%contact + held_energy(c, i)*c%weight(i)
            call lost_bound(c, i, lost, whole)
            all_lost = all_lost + lost*c%weight(i)
            all_whole = all_whole + whole*c%weight(i)
         end do
      end associate
      self%rubs%cone = shear_excess(scene%newton%contact, scene%newton%noise)
      if (all_lost > 0.0_wp) self%rubs%ramp = all_lost/all_whole
   end subroutine check_friction

   !> Work of friction is not negative but for what Newton's tolerance of slips, the last
   !> corrections and rounding leave, beside what slips, and beside the energies of the scene.
   subroutine check_work(self, energy, scene)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(in) :: energy
      type(scene_type), intent(in) :: scene
      real(wp) :: gained, slack, scale, bound
      integer :: i

      gained = 0.0_wp
      slack = 0.0_wp
      scale = 0.0_wp
      associate (c => scene%newton%contact, state => scene%newton)
         do i = 1, c%n
            if (c%facet(i) == 0 .or. c%status(i) == 0 .or. c%enforcement(i)%tied) cycle
            bound = shear_bound(c, i)
            if (.not. bound < huge(1.0_wp)) bound = norm2(c%traction(:, i))
            gained = gained + min(dissipated(c, i), 0.0_wp)*c%weight(i)
            scale = scale + bound*path_of(c, i)*c%weight(i)
            slack = slack + bound*c%weight(i)*(state%correction + state%noise)
            if (c%c(i) > 0.0_wp) slack = slack + bound*complementarity*state%reference/c%c(i)
         end do
         if (c%n > 0) scale = max(scale, share_of_energy*max(abs(energy%external), &
            & energy%strain, energy%plastic), largest(state%floor)*maxval(c%size(:c%n)))
      end associate
      if (gained + slack < -least_share*scale .and. scale > 0.0_wp) &
         & self%rubs%dissipation = (gained + slack)/scale
   end subroutine check_work

   subroutine check_points(self, scene, model)
      type(certificate_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: p_ref, thin(size(model%pair))
      integer :: i
      logical :: exact

      associate (c => scene%newton%contact)
         if (c%n == 0) return
         p_ref = largest_pressure(scene)
         self%pressure_error = max(c%soft_error, scene%trial%contact%softness)
         self%obeys = obeys_deck(model)
         thin = [(thinnest(scene%bodies, model, i), i=1, size(model%pair))]
         do i = 1, c%n
            if (c%facet(i) == 0) cycle
            exact = model%interaction(model%pair(c%pair(i))%interaction)%method%is_exact()
            self%penetration = max(self%penetration, -c%gap(i)/c%size(i))
            if (.not. c%enforcement(i)%method%is_exact()) &
               & self%depth = max(self%depth, -c%gap(i)/thin(c%pair(i)))
            ! What supports hold has no row: they bear it; how deep it may be is asked elsewhere.
            if (.not. p_ref > 0.0_wp .or. c%idle(i)) cycle
            if (c%bilateral(i)) then
               self%complementarity = max(self%complementarity, &
                  & merge((abs(c%gap(i)) - gap_rounding(scene, i))*c%c(i)/p_ref, 0.0_wp, exact))
            else
               self%tension = max(self%tension, &
                  & -(c%pressure(i) + gap_rounding(scene, i)*c%c(i))/p_ref)
               if (exact) self%complementarity = max(self%complementarity, &
                  & (abs(min(c%pressure(i), c%c(i)*c%gap(i))) &
                  & - gap_rounding(scene, i)*c%c(i))/p_ref)
            end if
         end do
      end associate
   end subroutine check_points

   !> The contact forces on all bodies and tools balance as a whole.
   subroutine check_balance(self, scene, model, pressed)
      type(certificate_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: pressed(:)
      real(wp) :: total(3)
      integer :: dof, i

      do i = 1, size(model%pair)
         associate (master => model%surface(model%pair(i)%master))
            if (master%tool == 0) cycle
            if (model%tool(master%tool)%rigid_body == 0) return
         end associate
      end do
      total = 0.0_wp
      do dof = 1, scene%dofs%n
         if (scene%dofs%dof(dof) > 3) cycle
         total(scene%dofs%dof(dof)) = total(scene%dofs%dof(dof)) + pressed(dof)
      end do
      if (any(scene%dofs%id(1, :) == 0 .and. scene%dofs%id(2, :) > 0)) total(1) = 0.0_wp
      if (largest(pressed) > 0.0_wp) self%action_reaction = norm2(total)/sum(abs(pressed))
   end subroutine check_balance

   !> Warnings and notes of the trial state, once for each step.
   subroutine report_nonlinear(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      associate (c => scene%newton%contact)
         if (scene%newton%grounded > 0) call once(severity%note, 'N0511', to_text( &
            & scene%newton%grounded)//' iterations held a free body by soft springs to the '// &
            & 'ground: none is in the answer', 'the springs did no work')
         do i = 1, c%n
            if (.not. c%bilateral(i) .or. c%facet(i) == 0) cycle
            if (c%enforcement(i)%tied .or. .not. c%pressure(i) < 0.0_wp) cycle
            associate (law => c%friction(c%pair(i)))
               if (.not. has_friction(law) .or. law%rough) cycle
            end associate
            call once(severity%warning, 'W0521', 'node '// &
               & to_text(model%mesh%node_label(c%node(i)))//' is pulled by NO SEPARATION: '// &
               & 'friction there is that of no pressure', 'TIED or ROUGH also hold along the face')
            exit
         end do
      end associate

   contains

      subroutine once(level, id, message, help)
         integer, intent(in) :: level
         character(len=*), intent(in) :: id, message, help
         integer :: k

         do k = 1, scene%log%n
            if (scene%log%item(k)%id == id .and. scene%log%item(k)%at%line &
               & == model%step(scene%step)%at%line) return
         end do
         call scene%log%say(level, id, message, model%step(scene%step)%at, help=help)
      end subroutine once
   end subroutine report_nonlinear

   !> What recorders see of the contacts, by pair.
   subroutine nonlinear_contact_fields(field, closed, scene, model)
      type(contact_field_type), allocatable, intent(inout) :: field(:)
      integer, intent(out) :: closed
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, i, ndim
      real(wp), dimension(3, scene%newton%contact%n) :: force, couple
      real(wp) :: weight(scene%newton%contact%n)
      integer, allocatable :: at(:)

      ndim = model%mesh%ndim
      closed = 0
      if (allocated(field)) deallocate (field)
      allocate (field(size(model%pair)))
      associate (c => scene%newton%contact)
         weight = areas_now(c, model, pieces_now(c, model))
         call row_resultants(c, model, force, couple)
         do pair = 1, size(model%pair)
            at = pack([(i, i=1, c%n)], c%pair(:c%n) == pair)
            associate (f => field(pair))
               f%node = c%node(at)
               f%facet = c%facet(at)
               f%status = merge(c%status(at), -1, f%facet > 0)
               where (f%status > 0 .and. c%enforcement(at)%tied) f%status = 3
               ! The area of the end of the increment: the traction was found by that of its start.
               f%weight = weight(at)
               ! Rows of surface to surface stand on the area that is covered now.
               if (c%mortar(pair)%is_on .and. .not. c%mortar(pair)%tied) then
                  where (f%status > 0) f%weight = c%weight(at)
               end if
               f%gap = c%opening(at)
               f%pressure = c%pressure(at)
               where (f%weight > 0.0_wp) f%pressure = f%pressure*c%weight(at)/f%weight
               f%normal = c%normal(:ndim, at)
               f%xi = c%xi(:, at)
               f%slip_path = scene%trial%contact%slip_path(at)
               f%friction_work = scene%trial%contact%friction_work(at)
               f%force = force(:ndim, at)
               f%couple = couple(:, at)
               allocate (f%shear(ndim, size(at)), f%u_n(size(at)), f%u_t(ndim, size(at)))
               do i = 1, size(at)
                  f%shear(:, i) = c%weight(at(i))*(c%traction(:ndim, at(i)) &
                     & - c%pressure(at(i))*f%normal(:, i))
                  f%u_n(i) = 0.0_wp
                  f%u_t(:, i) = scene%trial%contact%slip(:ndim, at(i))
               end do
               closed = closed + count(f%status > 0)
            end associate
         end do
      end associate
   end subroutine nonlinear_contact_fields
end module lopin_nonlinear_results
