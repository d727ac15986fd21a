!> Initialisation of the nonlinear path, and its update at the beginning of a step.
module lopin_nonlinear_start
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_pair_activity, only : active_pairs
   use lopin_friction, only : has_friction
   use lopin_nonlinear_points, only : is_self_contact
   use lopin_nonlinear_contact, only : new_nonlinear_contact, cover_size
   use lopin_damage, only : new_damage
   use lopin_solid_memory, only : new_solid_memory
   use lopin_heat, only : start_stresses
   use lopin_heat_work, only : start_heat_work
   use lopin_state, only : begin, begin_step_of, new_contact_state
   use lopin_scene, only : scene_type
   use lopin_rigid_motions, only : find_vertices
   use lopin_solver_factory, only : may_need_levels
   implicit none
   private
   public :: begin_nonlinear, start_step, complementarity

   !> Contact is met to this share of the largest force, by Newton and by augmentation.
   real(wp), parameter :: complementarity = 1.0e-8_wp

contains

   !> Contacts of a scene that the nonlinear path solves; its state from rest, unless there is one.
   subroutine begin_nonlinear(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      if (scene%newton%in_use) return
      call new_nonlinear_contact(scene%newton%contact, model, scene%dofs, scene%log, error)
      if (allocated(error)) return
      scene%newton%in_use = .true.
      scene%newton%system%wish = model%solver
      call start_step(scene, model)
      if (.not. allocated(scene%accepted%solids%first)) call start_from_rest(scene, model, error)
      if (allocated(error)) return
      scene%newton%flows = scene%accepted%solids%in_use
      scene%newton%bends = any([(allocated(model%spring(pair)%table), pair=1, size(model%spring))])
      scene%newton%augment_until = complementarity
      do pair = 1, size(model%pair)
         if (.not. model%interaction(model%pair(pair)%interaction)%method%updates()) cycle
         scene%newton%most_augmentations = max(scene%newton%most_augmentations, &
            & model%pair(pair)%control%max_augmentations)
      end do
   end subroutine begin_nonlinear

   !> Solids and contacts of the state before the first increment on this path.
   subroutine start_from_rest(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: scaled

      scaled = .false.
      if (allocated(model%initial_state)) scaled = any(model%initial_state%whole) &
         & .or. any(abs(model%start%kept%scale - 1.0_wp) > 0.0_wp)
      associate (accepted => scene%accepted, contact => scene%newton%contact)
         call new_solid_memory(accepted%solids, scene%solids, model%mesh, scaled)
         call new_damage(accepted%solids, model)
         call new_contact_state(accepted%contact, contact%nmultiplier, cover_size(contact), &
            & contact%touches)
         if (allocated(model%initial_traction)) call start_tractions(scene, model)
         call begin_step_of(accepted, scene%newton%nlgeom)
         call start_stresses(scene, model, error)
         if (allocated(error)) return
         call start_heat_work(scene, model)
         call begin(scene%trial, accepted)
      end associate
   end subroutine start_from_rest

   !> What slave nodes bear at the start; the nearer wall of a concave corner bears it alone.
   subroutine start_tractions(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i, k, d, row

      d = model%mesh%ndim
      associate (contact => scene%newton%contact, state => scene%accepted%contact)
         do k = 1, size(model%initial_traction)
            associate (start => model%initial_traction(k))
               i = findloc(contact%node(:contact%n) == start%node &
                  & .and. contact%pair(:contact%n) == start%pair, .true., dim=1)
               if (i == 0) cycle
               state%traction(:, i) = start%traction
               state%creep(:, i) = start%creep
               state%closed(i) = any(abs(start%traction) > 0.0_wp)
               row = contact%first_row(i)
               if (row > 0) state%multiplier(row:row + d - 1) = start%traction(:d)
            end associate
         end do
      end associate
   end subroutine start_tractions

   !> What steps change up to the present one: friction, pairs, NLGEOM.
   subroutine start_step(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: s, i, pair

      scene%newton%nlgeom = model%step(scene%step)%nlgeom
      scene%newton%contact%stretches = scene%newton%nlgeom
      if (.not. scene%newton%in_use) return
      if (may_need_levels(model%solver, scene%constraints%neq)) call find_vertices( &
         & scene%newton%system%vertices, model, scene%dofs, scene%constraints)
      associate (contact => scene%newton%contact)
         contact%pair_active = active_pairs(model, scene%step)
         do s = 1, scene%step
            do i = 1, size(model%step(s)%friction_change)
               do pair = 1, size(model%pair)
                  if (model%pair(pair)%interaction &
                     & == model%step(s)%friction_change(i)%interaction) &
                     & contact%friction(pair) = model%step(s)%friction_change(i)%friction
               end do
            end do
         end do
         scene%newton%frictionless = .true.
         do pair = 1, size(model%pair)
            if (has_friction(contact%friction(pair))) scene%newton%frictionless = .false.
            ! A surface that meets itself is as far from flat.
            if (is_self_contact(model%pair(pair))) scene%newton%frictionless = .false.
         end do
      end associate
   end subroutine start_step
end module lopin_nonlinear_start
