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
   public :: held_type, remember_held, let_go, lets_go

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
   subroutine let_go(held, scene, model, before, error)
      type(held_type), intent(in) :: held
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: before(:)     !! (ndof) loads that the step starts from [force]
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: pressed(:)
      integer :: i

      if (.not. (allocated(held%pair_active) .and. scene%finite%flows)) return
      associate (contact => scene%finite%contact, now => scene%constraints%dof_of_prescribed)
         do i = 1, size(held%prescribed)
            associate (dof => held%prescribed(i))
               if (.not. any(now == dof)) before(dof) = before(dof) &
                  & + scene%accepted%loads%reaction(dof)
            end associate
         end do
         if (.not. any(held%pair_active .and. .not. contact%pair_active)) return
         allocate (pressed, source=contact%force)
         call evaluate(contact, model, scene%trial%motion%u, scene%accepted%contact%multiplier, &
            & .false., error)
         if (allocated(error)) return
         pressed = pressed - contact%force
         before = before + pressed
         scene%accepted%loads%force = scene%accepted%loads%force + pressed
      end associate
   end subroutine let_go
end module lopin_release
