!> Motions that metal which flows without hardening all but leaves free.
!>
!> A strip that is bent by a moment alone bears nearly the same moment whatever its curvature: where
!> along it the bend goes is decided by what is left of hardening, and by any small force of
!> contact. Equilibrium says nothing of a shape then, and methods differ in it while their forces
!> agree. How soft the softest motion is beside the elastic body is the largest m of
!> K_elastic x = m K x, K the tangent at the end of a step: a few inverse iterations by its factor.
!> A billet may be as soft beside its elastic stiffness; but no small force moves it far.
module lopin_neutral_motion
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_csc, only : csc_type
   use lopin_vectors, only : largest
   use lopin_constraints, only : expand, reduce
   use lopin_newton_system, only : solve_step
   use lopin_newton_step, only : coarse
   use lopin_one_unit, only : as_lengths
   use lopin_pseudo_transient, only : set_metric
   use lopin_repeated_messages, only : warn_once
   use lopin_scene, only : scene_type
   use lopin_text, only : to_text
   implicit none
   private
   public :: neutral_type, find_neutral_motion, tell_neutral_motion

   integer, parameter :: iterations = 3
   !> Times softer than the elastic body.
   real(wp), parameter :: softer = 1.0e3_wp
   !> And it goes far, beside the bodies, by a small share of the forces in the metal.
   real(wp), parameter :: small = 1.0e-2_wp, far = 0.02_wp

   !> The softest motion where a step ends.
   type :: neutral_type
      real(wp) :: times = 0.0_wp               !! softer than the elastic body [-]
      real(wp) :: way = 0.0_wp                 !! by a small share of the forces [length]
      integer :: node = 0                      !! where the motion is largest; 0: not looked for
   contains
      procedure :: keep => keep_neutral
   end type neutral_type

contains

   !> To a stream or back: whoever goes on from the end of a step has no factor to look at.
   subroutine keep_neutral(self, stream)
      class(neutral_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%times)
      call stream%pass(self%way)
      call stream%pass(self%node)
   end subroutine keep_neutral

   !> After the last increment of a step, if metal flowed in it and Newton took an iteration: the
   !> factor is that of its end.
   subroutine find_neutral_motion(self, scene, model)
      type(neutral_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable :: error

      if (scene%newton%time < model%step(scene%step)%period) return
      if (.not. (scene%newton%in_use .and. scene%newton%flows)) return
      if (scene%newton%iterations == 0) return
      if (.not. scene%trial%solids%most_strain > 0.0_wp .or. scene%constraints%neq == 0) return
      call set_metric(scene, model, error)
      if (allocated(error)) return
      call find_softest(scene, self%times, self%way, self%node, error)
      if (allocated(error)) self = neutral_type()
      scene%newton%damping%metric = csc_type()
   end subroutine find_neutral_motion

   !> At the end of the step.
   subroutine tell_neutral_motion(self, scene, model)
      type(neutral_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%node > 0 .and. self%times > softer .and. self%way > far*scene%bodies%length) &
         & call warn_once(scene%log, 'W0523', 'at the end of step '//to_text(scene%step)// &
         & ' metal that flows leaves a motion '//to_text(self%times, 1)//' times as soft as '// &
         & 'that of the elastic body, largest at node '// &
         & to_text(model%mesh%node_label(self%node))//': a hundredth of the forces in the '// &
         & 'metal moves it by '//to_text(self%way, 2), model%step(scene%step)%at, &
         & help='forces are known, the shape along that motion is not: hardening, or tools '// &
         & 'that hold it on both sides, decide it')
      self = neutral_type()
   end subroutine tell_neutral_motion

   !> Inverse iterations from a motion without a pattern.
   subroutine find_softest(scene, times, way, node, error)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(out) :: times           !! softer than the elastic body [-]
      real(wp), intent(out) :: way             !! by a small share of the forces [length]
      integer, intent(out) :: node             !! where the motion is largest
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: v(scene%constraints%neq), pushed(scene%constraints%neq)
      real(wp) :: u(scene%dofs%n), before, after, most
      real(wp) :: right(scene%constraints%neq + scene%newton%contact%nmultiplier)
      real(wp) :: step(size(right))
      integer :: i, k, bad

      times = 0.0_wp
      way = 0.0_wp
      node = 0
      ! Rotations times the length of the scene are as large as displacements.
      v = [(1.0_wp, i=1, size(v))]
      v = 1.0_wp/as_lengths(scene, v, scene%constraints%dof_of_equation)
      v = v*[(sin(1.0_wp*i*i), i=1, size(v))]
      call push(v, pushed, before)
      do k = 1, iterations
         right = 0.0_wp
         right(:size(v)) = pushed
         call solve_step(scene%newton%system, right, coarse, step, scene%clock, scene%counter, &
            & bad, error)
         if (bad > 0) times = 0.0_wp
         if (allocated(error) .or. bad > 0) return
         v = step(:size(v))
         most = largest(as_lengths(scene, v, scene%constraints%dof_of_equation))
         if (.not. most > 0.0_wp) return
         v = v/most
         call push(v, pushed, after)
         times = sqrt(after/before)*most
         before = after
         way = small*scene%newton%element_force*times/after
      end do
      node = scene%dofs%node(maxloc(abs(u), dim=1, mask=scene%dofs%dof <= 3))

   contains

      !> Elastic forces of a motion, and twice its energy.
      subroutine push(v, forces, energy)
         real(wp), intent(in) :: v(:)
         real(wp), intent(out) :: forces(:), energy
         real(wp) :: force(scene%dofs%n), nil(scene%constraints%nprescribed)

         nil = 0.0_wp
         call expand(scene%constraints, v, nil, u)
         call scene%newton%damping%metric%multiply(u, force)
         call reduce(scene%constraints, force, forces)
         energy = dot_product(u, force)
      end subroutine push
   end subroutine find_softest
end module lopin_neutral_motion
