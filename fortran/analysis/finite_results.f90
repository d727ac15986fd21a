!> Forces, certificate and contact fields of an increment of the finite path.
module lopin_finite_results
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_friction, only : has_friction
   use lopin_vectors, only : largest
   use lopin_model, only : model_type, method_of
   use lopin_state, only : certificate_type, energy_type, contact_field_type
   use lopin_constraints, only : reduce, prescribed_part
   use lopin_certificate, only : forces_type, give_verdict
   use lopin_finite_state, only : forgotten
   use lopin_finite_forces, only : above_rounding, pressure_about, nil_gap
   use lopin_contact_traction, only : grip_kind
   use lopin_finite_contact, only : finite_contact_type
   use lopin_finite_slip, only : dissipated, mean_work_of, held_energy, shear_bound
   use lopin_scene, only : scene_type
   implicit none
   private
   !> The softness of a penalty is bounded from above by that of one facet: reason to warn, not to
   !> fail (verdict FAIL from 0.2).
   real(wp), parameter :: only_warns = 0.19_wp

   public :: find_finite_forces, certify_finite, finite_contact_fields, tell_finite

   !> Work of a traction over this share of a facet is rounding.
   real(wp), parameter :: rounding = 1.0e-14_wp

contains

   !> The forces of the trial state, as Newton left them.
   subroutine find_finite_forces(self, scene, f)
      type(forces_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: f(:)             !! (ndof) loads [force]

      self%load = f
      self%internal = scene%finite%internal
      self%pressed = scene%finite%contact%force
      self%residual = self%internal - f - self%pressed
      allocate (self%reaction(scene%constraints%nprescribed))
      call prescribed_part(scene%constraints, self%residual, self%reaction)
   end subroutine find_finite_forces

   !> Equilibrium, complementarity, action and reaction of the trial state.
   !>
   !> The work of large increments is not integrated exactly by any rule that sees only their ends:
   !> the energies are reported, the verdict does not use them.
   subroutine certify_finite(self, energy, scene, model, forces)
      type(certificate_type), intent(out) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(forces_type), intent(in) :: forces
      real(wp), allocatable :: free(:)
      real(wp) :: reference

      allocate (free(scene%constraints%neq))
      call reduce(scene%constraints, forces%residual, free)
      reference = max(largest(forces%load), largest(forces%reaction), largest(forces%pressed), &
         & largest(forces%internal), forgotten*scene%finite%force_seen)
      reference = above_rounding(scene, reference)
      if (reference > 0.0_wp) self%equilibrium = largest(free)/reference
      energy%strain = scene%finite%energy
      call judge_points(self, scene, model)
      call judge_friction(self, energy, scene%finite%contact)
      call judge_balance(self, scene, model, forces%pressed)
      call give_verdict(self)
   end subroutine certify_finite

   !> Shear within its bound, work of friction not negative, and the energies of the trial state.
   subroutine judge_friction(self, energy, contact)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(inout) :: energy
      type(finite_contact_type), intent(in) :: contact
      real(wp) :: work(contact%n), beyond(contact%n), bound(contact%n), shear(3), most
      integer :: i

      energy%contact = 0.0_wp
      energy%friction = 0.0_wp
      energy%friction_mean = 0.0_wp
      work = 0.0_wp
      beyond = 0.0_wp
      bound = 0.0_wp
      most = 0.0_wp
      associate (c => contact)
         do i = 1, c%n
            energy%friction = energy%friction + c%friction_work(i)
            energy%friction_mean = energy%friction_mean + c%mean_work(i)
            if (c%facet(i) == 0 .or. c%grip(i)%kind == grip_kind%tied) cycle
            work(i) = dissipated(c, i)*c%weight(i)
            energy%friction = energy%friction + work(i)
            energy%friction_mean = energy%friction_mean + mean_work_of(c, i)*c%weight(i)
            energy%contact = energy%contact + held_energy(c, i)*c%weight(i)
            shear = c%traction(:, i) - c%pressure(i)*c%normal(:, i)
            ! Slips that add up to nothing, and shears that are rounding, do rounding's work.
            most = max(most, abs(work(i)), c%weight(i)*max(1.0e-3_wp*norm2(shear) &
               & *norm2(c%trial(i)%slip), rounding*norm2(c%traction(:, i))*c%size(i)))
            if (.not. shear_bound(c, i) < huge(1.0_wp)) cycle
            bound(i) = shear_bound(c, i)
            beyond(i) = norm2(shear) - bound(i)
         end do
      end associate
      if (most > 0.0_wp) self%dissipation = minval(work)/most
      if (largest(bound) > 0.0_wp) self%cone = max(maxval(beyond), 0.0_wp)/largest(bound)
   end subroutine judge_friction

   subroutine judge_points(self, scene, model)
      type(certificate_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: p_ref
      integer :: i, method

      associate (c => scene%finite%contact)
         if (c%n == 0) return
         p_ref = pressure_about(scene)
         do i = 1, c%n
            if (c%facet(i) == 0) cycle
            method = model%interaction(model%pair(c%pair(i))%interaction)%method
            self%penetration = max(self%penetration, -c%gap(i)/c%size(i))
            if (.not. p_ref > 0.0_wp) cycle
            if (c%bilateral(i)) then
               self%complementarity = max(self%complementarity, &
                  & merge(abs(c%c(i)*c%gap(i))/p_ref, 0.0_wp, exact(method)))
            else
               self%tension = max(self%tension, -c%pressure(i)/p_ref)
               if (exact(method)) self%complementarity = max(self%complementarity, &
                  & (abs(min(c%pressure(i), c%c(i)*c%gap(i))) - nil_gap*c%c(i)*c%size(i))/p_ref)
            end if
            if (method == method_of%penalty .or. method == method_of%perturbed) &
               & self%pressure_error = min(max(self%pressure_error, c%soft_error), only_warns)
         end do
      end associate
   end subroutine judge_points

   !> Methods that leave no penetration.
   pure logical function exact(method)
      integer, intent(in) :: method
      exact = method == method_of%lagrange .or. method == method_of%augmented
   end function exact

   !> The contact forces on all bodies and tools balance as a whole.
   subroutine judge_balance(self, scene, model, pressed)
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
   end subroutine judge_balance

   !> Warnings and notes of the trial state, once for each step.
   subroutine tell_finite(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      associate (c => scene%finite%contact)
         if (scene%finite%grounded > 0) call once(severity%note, 'N0511', to_text( &
            & scene%finite%grounded)//' iterations held a free body by soft springs to the '// &
            & 'ground: none is in the answer', 'the springs did no work')
         do i = 1, c%n
            if (.not. c%bilateral(i) .or. c%facet(i) == 0) cycle
            if (c%grip(i)%kind == grip_kind%tied .or. .not. c%pressure(i) < 0.0_wp) cycle
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
   end subroutine tell_finite

   !> What recorders see of the contacts, by pair.
   subroutine finite_contact_fields(field, closed, scene, model)
      type(contact_field_type), allocatable, intent(inout) :: field(:)
      integer, intent(out) :: closed
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, i, ndim
      integer, allocatable :: at(:)

      ndim = model%mesh%ndim
      closed = 0
      if (allocated(field)) deallocate (field)
      allocate (field(size(model%pair)))
      associate (c => scene%finite%contact)
         do pair = 1, size(model%pair)
            at = pack([(i, i=1, c%n)], c%pair(:c%n) == pair)
            associate (f => field(pair))
               f%node = c%node(at)
               f%facet = c%facet(at)
               f%status = merge(c%status(at), -1, f%facet > 0)
               where (f%status > 0 .and. c%grip(at)%kind == grip_kind%tied) f%status = 3
               f%weight = c%weight(at)
               f%gap = c%opening(at)
               f%pressure = c%pressure(at)
               f%normal = c%normal(:ndim, at)
               f%xi = c%xi(:, at)
               allocate (f%force(ndim, size(at)), f%u_n(size(at)), f%u_t(ndim, size(at)))
               do i = 1, size(at)
                  f%force(:, i) = f%weight(i)*c%traction(:ndim, at(i))
                  f%u_n(i) = 0.0_wp
                  f%u_t(:, i) = c%slip(:ndim, at(i))
               end do
               closed = closed + count(f%status > 0)
            end associate
         end do
      end associate
   end subroutine finite_contact_fields
end module lopin_finite_results
