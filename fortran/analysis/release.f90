!> What a step lets go of - pairs that it takes away, supports that it frees - acts on as a force
!> and fades over the step: a body that flowed springs back along a path, not in one leap.
module lopin_release
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_finite_evaluation, only : evaluate
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: held_type, remember_held, leave_pairs, let_go, lets_go

   !> What held the scene at the end of a step.
   type :: held_type
      integer, allocatable :: prescribed(:)    !! dofs
      logical, allocatable :: pair_active(:)
   end type held_type

contains

   subroutine remember_held(self, scene)
      type(held_type), intent(out) :: self
      type(scene_type), intent(in) :: scene

      self%prescribed = scene%constraints%dof_of_prescribed
      if (scene%finite%in_use) self%pair_active = scene%finite%contact%pair_active
   end subroutine remember_held

   !> The step takes away a support, or takes away or adds a pair.
   pure logical function lets_go(held, scene)
      type(held_type), intent(in) :: held
      type(scene_type), intent(in) :: scene
      integer :: i

      lets_go = .false.
      if (.not. scene%finite%in_use) return
      do i = 1, size(held%prescribed)
         lets_go = lets_go .or. .not. any(scene%constraints%dof_of_prescribed == held%prescribed(i))
      end do
      if (allocated(held%pair_active)) lets_go = lets_go &
         & .or. any(held%pair_active .neqv. scene%finite%contact%pair_active)
   end function lets_go

   !> Forces of what holds no more, added to those that the step starts from.
   subroutine let_go(held, scene, before)
      type(held_type), intent(in) :: held
      type(scene_type), intent(inout) :: scene
      real(wp), intent(inout) :: before(:)     !! (ndof) loads that the step starts from [force]
      integer :: i

      if (.not. (allocated(held%pair_active) .and. scene%finite%flows)) return
      associate (loads => scene%accepted%loads, now => scene%constraints%dof_of_prescribed)
         do i = 1, size(held%prescribed)
            associate (dof => held%prescribed(i))
               if (.not. any(now == dof)) before(dof) = before(dof) &
                  & + scene%accepted%loads%reaction(dof)
            end associate
         end do
         if (.not. allocated(loads%let_go)) return
         before = before + loads%let_go
         loads%force = loads%force + loads%let_go
         deallocate (loads%let_go)
      end associate
   end subroutine let_go

   !> At the end of a step, what the pairs press that the next one takes away: all that is pressed,
   !> less what is without them.
   subroutine leave_pairs(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: active(:)
      integer :: i

      if (.not. (scene%finite%in_use .and. scene%finite%flows)) return
      if (scene%step == size(model%step)) return
      associate (contact => scene%finite%contact, accepted => scene%accepted, &
         & change => model%step(scene%step + 1)%pair_change)
         active = contact%pair_active
         do i = 1, size(change)
            contact%pair_active(change(i)%pair) = change(i)%active
         end do
         if (any(active .and. .not. contact%pair_active)) then
            accepted%loads%let_go = contact%force
            call evaluate(contact, model, accepted%motion%u, accepted%contact%multiplier, .false., &
               & error)
            if (.not. allocated(error)) accepted%loads%let_go = accepted%loads%let_go &
               & - contact%force
         end if
         contact%pair_active = active
      end associate
   end subroutine leave_pairs
end module lopin_release
