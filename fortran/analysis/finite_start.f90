!> What the finite path needs before its first increment, and what each step changes.
module lopin_finite_start
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_finite_points, only : is_self_contact
   use lopin_finite_contact, only : new_finite_contact, cover_size
   use lopin_solid_memory, only : new_solid_memory
   use lopin_heat, only : start_stresses
   use lopin_heat_work, only : start_heat_work
   use lopin_state, only : begin, begin_step_of, new_contact_state
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: begin_finite, start_step, complementarity

   !> Contact is met to this share of the largest force, by Newton and by augmentation.
   real(wp), parameter :: complementarity = 1.0e-8_wp

contains

   !> Contacts of a scene that the finite path solves; its state from rest, unless there is one.
   subroutine begin_finite(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      if (scene%finite%in_use) return
      call new_finite_contact(scene%finite%contact, model, scene%dofs, scene%log, error)
      if (allocated(error)) return
      scene%finite%in_use = .true.
      call start_step(scene, model)
      if (.not. allocated(scene%accepted%solids%first)) call start_from_rest(scene, model)
      scene%finite%flows = scene%accepted%solids%in_use
      scene%finite%augment_until = complementarity
      do pair = 1, size(model%pair)
         if (.not. model%interaction(model%pair(pair)%interaction)%method%updates()) cycle
         scene%finite%most_augmentations = max(scene%finite%most_augmentations, &
            & model%pair(pair)%control%max_augmentations)
      end do
   end subroutine begin_finite

   !> Solids and contacts of the state before the first increment on this path.
   subroutine start_from_rest(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      associate (accepted => scene%accepted, contact => scene%finite%contact)
         call new_solid_memory(accepted%solids, scene%solids, model%mesh)
         call new_contact_state(accepted%contact, contact%nmultiplier, cover_size(contact), &
            & contact%touches)
         call begin_step_of(accepted, scene%finite%nlgeom)
         call start_stresses(scene, model)
         call start_heat_work(scene, model)
         call begin(scene%trial, accepted)
      end associate
   end subroutine start_from_rest

   !> What steps change up to the present one: friction, pairs, NLGEOM.
   subroutine start_step(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: s, i, pair

      scene%finite%nlgeom = model%step(scene%step)%nlgeom
      scene%finite%contact%stretches = scene%finite%nlgeom
      if (.not. scene%finite%in_use) return
      associate (contact => scene%finite%contact)
         do s = 1, scene%step
            do i = 1, size(model%step(s)%pair_change)
               contact%pair_active(model%step(s)%pair_change(i)%pair) = &
                  & model%step(s)%pair_change(i)%active
            end do
            do i = 1, size(model%step(s)%friction_change)
               do pair = 1, size(model%pair)
                  if (model%pair(pair)%interaction &
                     & == model%step(s)%friction_change(i)%interaction) &
                     & contact%friction(pair) = model%step(s)%friction_change(i)%friction
               end do
            end do
         end do
         scene%finite%frictionless = .true.
         do pair = 1, size(model%pair)
            if (has_friction(contact%friction(pair))) scene%finite%frictionless = .false.
            ! A surface that meets itself is as far from flat.
            if (is_self_contact(model%pair(pair))) scene%finite%frictionless = .false.
         end do
      end associate
   end subroutine start_step
end module lopin_finite_start
