!> Refusal of increments in which artificial springs decide where a free body goes, although
!> friction would hold it.
!>
!> An iteration of Newton in which all contact slips leaves such a body to springs to the ground
!> (lopin_newton_step). It may then find its next balance far from the last one, in contact with
!> other points, whose friction knows nothing of the way. What is prescribed moves it no farther
!> than a few times itself.
module lopin_refuse_free_motion
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_vectors, only : largest
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_constraints, only : raw_displacement
   use lopin_body_words, only : describe_motion
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: refuse_free_motion

   !> Times what is prescribed that a free body may move, and facets beside it.
   real(wp), parameter :: far = 1.5_wp, facets = 0.1_wp

contains

   subroutine refuse_free_motion(scene, model, prescribed, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed) at the end of the increment
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: q(:)
      real(wp) :: arm                          !! of the tools, to where they touch [length]
      integer :: i
      logical :: held

      if (.not. scene%newton%in_use .or. scene%bodies%nq == 0) return
      ! By parts of what has held it, it goes no farther than it is pushed.
      if (scene%newton%grounded == 0 .or. scene%newton%faded) return
      held = .false.
      associate (c => scene%newton%contact)
         arm = 0.0_wp
         do i = 1, c%n
            if (.not. any(abs(scene%accepted%contact%traction(:, i)) > 0.0_wp)) cycle
            held = held .or. has_friction(c%friction(c%pair(i)))
            associate (body => c%masters%of(c%pair(i))%body)
               if (body > 0) arm = max(arm, norm2(model%mesh%x(:, c%node(i)) &
                  & - model%mesh%x(:, model%rigid_body(body)%reference)))
            end associate
         end do
         if (.not. held) return
         if (free_motion(scene, arm) <= far*motion_given(scene, arm, prescribed) &
            & + facets*maxval(c%size)) return
      end associate
      allocate (q(scene%bodies%nq), source=0.0_wp)
      q(1) = 1.0_wp
      call raise(error, error_code%not_converged, 'E0551', describe_motion(scene%bodies, model, q) &
         & //', and jumps: friction does not hold it through an increment', &
         & model%step(scene%step)%at, help='smaller increments on *STATIC, or hold it by *BOUNDARY')
   end subroutine refuse_free_motion

   !> The longest way of a free equation that a floating motion moves; rotations by the arm
   !> [length].
   pure real(wp) function free_motion(scene, arm) result(way)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: arm
      real(wp) :: moved
      integer :: i

      way = 0.0_wp
      associate (c => scene%constraints)
         do i = 1, c%neq
            if (.not. any(abs(scene%bodies%motion(i, :)) > 0.0_wp)) cycle
            moved = raw_displacement(c, scene%dofs, scene%trial%motion%u, c%dof_of_equation(i)) &
               & - raw_displacement(c, scene%dofs, scene%accepted%motion%u, c%dof_of_equation(i))
            if (scene%dofs%dof(c%dof_of_equation(i)) > 3) moved = moved*arm
            way = max(way, abs(moved))
         end do
      end associate
   end function free_motion

   !> The longest way that is prescribed [length].
   pure real(wp) function motion_given(scene, arm, prescribed) result(way)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: arm, prescribed(:)
      real(wp) :: moved(size(prescribed))
      integer :: i

      associate (c => scene%constraints)
         do i = 1, size(prescribed)
            moved(i) = prescribed(i) - raw_displacement(c, scene%dofs, scene%accepted%motion%u, &
               & c%dof_of_prescribed(i))
            if (scene%dofs%dof(c%dof_of_prescribed(i)) > 3) moved(i) = moved(i)*arm
         end do
      end associate
      way = largest(moved)
   end function motion_given
end module lopin_refuse_free_motion
