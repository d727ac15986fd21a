!> Forces, certificate and contact fields of an increment of the finite path.
module lopin_finite_results
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_model, only : model_type, method_of
   use lopin_state, only : certificate_type, energy_type, contact_field_type
   use lopin_constraints, only : reduce, prescribed_part
   use lopin_certificate, only : forces_type, give_verdict
   use lopin_finite_state, only : forgotten
   use lopin_contact_traction, only : grip_kind
   use lopin_scene, only : scene_type
   implicit none
   private
   !> The softness of a penalty is bounded from above by that of one facet: reason to warn, not to
   !> fail (verdict FAIL from 0.2).
   real(wp), parameter :: only_warns = 0.19_wp

   public :: find_finite_forces, certify_finite, finite_contact_fields

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
      if (reference > 0.0_wp) self%equilibrium = largest(free)/reference
      energy%strain = scene%finite%energy
      call judge_points(self, energy, scene, model)
      call judge_balance(self, scene, model, forces%pressed)
      call give_verdict(self)
   end subroutine certify_finite

   subroutine judge_points(self, energy, scene, model)
      type(certificate_type), intent(inout) :: self
      type(energy_type), intent(inout) :: energy
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: p_ref
      integer :: i, method

      associate (c => scene%finite%contact)
         if (c%n == 0) return
         p_ref = max(largest(c%pressure(:c%n)), forgotten*scene%finite%force_seen/sum(c%weight(:c%n)))
         energy%contact = 0.0_wp
         energy%friction = sum(c%friction_work(:c%n)*c%weight(:c%n))
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
                  & abs(min(c%pressure(i), c%c(i)*c%gap(i)))/p_ref)
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
               f%gap = c%gap(at)
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
