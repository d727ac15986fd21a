!> What a step lets go of - pairs that it takes away, supports that it frees - acts on as a force
!> and fades over the step: a body that flowed springs back along a path, not in one jump.
!>
!> A metal whose stress depends on its rate would flow on under such a force for as long as the step
!> lasts, as under no real tool, which loses its force with the first micrometres: it is let go of
!> at once, or, where Newton cannot follow, by parts of that force within the first increment
!> (lopin_path_nonlinear).
module lopin_released_forces
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_flow_curve, only : is_viscous
   use lopin_model, only : model_type
   use lopin_pair_activity, only : active_pairs
   use lopin_contact_evaluation, only : evaluate_contact
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: supports_type, record_supports, release_pairs, add_released_forces, releases_support

   !> What held the scene at the end of a step.
   type :: supports_type
      integer, allocatable :: prescribed(:)    !! dofs
      logical, allocatable :: pair_active(:)
   end type supports_type

contains

   subroutine record_supports(self, scene)
      type(supports_type), intent(out) :: self
      type(scene_type), intent(in) :: scene

      self%prescribed = scene%constraints%dof_of_prescribed
      if (scene%newton%in_use) self%pair_active = scene%newton%contact%pair_active
   end subroutine record_supports

   !> The step takes away a support, or takes away or adds a pair.
   pure logical function releases_support(held, scene)
      type(supports_type), intent(in) :: held
      type(scene_type), intent(in) :: scene
      integer :: i

      releases_support = .false.
      if (.not. scene%newton%in_use) return
      do i = 1, size(held%prescribed)
         releases_support = releases_support .or. .not. any(scene%constraints%dof_of_prescribed == &
            & held%prescribed(i))
      end do
      if (allocated(held%pair_active)) releases_support = releases_support &
         & .or. any(held%pair_active .neqv. scene%newton%contact%pair_active)
   end function releases_support

   !> Forces of what holds no more, added to those that the step starts from.
   subroutine add_released_forces(held, scene, model, before)
      type(supports_type), intent(in) :: held
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: before(:)     !! (ndof) loads that the step starts from [force]
      real(wp), allocatable :: released(:)     !! (ndof) [force]
      integer :: i
      logical :: at_once

      if (allocated(scene%newton%released)) deallocate (scene%newton%released)
      if (.not. (allocated(held%pair_active) .and. scene%newton%flows)) return
      at_once = any([(is_viscous(model%material(i)%flow), i=1, size(model%material))])
      associate (loads => scene%accepted%loads, now => scene%constraints%dof_of_prescribed)
         allocate (released(size(before)), source=0.0_wp)
         do i = 1, size(held%prescribed)
            associate (dof => held%prescribed(i))
               if (any(now == dof)) cycle
               released(dof) = loads%reaction(dof)
               if (at_once) loads%reaction(dof) = 0.0_wp
            end associate
         end do
         if (allocated(loads%released)) then
            released = released + loads%released
            if (.not. at_once) loads%force = loads%force + loads%released
            deallocate (loads%released)
         end if
         if (.not. at_once) before = before + released
         if (at_once .and. any(abs(released) > 0.0_wp)) call move_alloc(released, &
            & scene%newton%released)
      end associate
   end subroutine add_released_forces

   !> At the end of a step, what the pairs press that the next one takes away: all that is pressed,
   !> less what is without them.
   subroutine release_pairs(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: active(:)

      if (.not. (scene%newton%in_use .and. scene%newton%flows)) return
      if (scene%step == size(model%step)) return
      associate (contact => scene%newton%contact, accepted => scene%accepted)
         active = contact%pair_active
         contact%pair_active = active_pairs(model, scene%step, scene%step + 1)
         if (any(active .and. .not. contact%pair_active)) then
            accepted%loads%released = contact%force
            call evaluate_contact(contact, model, accepted%motion%u, accepted%contact%multiplier, &
               & .false., error)
            if (.not. allocated(error)) accepted%loads%released = accepted%loads%released &
               & - contact%force
         end if
         contact%pair_active = active
      end associate
   end subroutine release_pairs
end module lopin_released_forces
