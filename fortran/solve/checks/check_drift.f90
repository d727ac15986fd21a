!> Bodies that a tool merely pushes along: a forgotten support does not make the equations singular
!> while a contact pushes, and the answer is a body without stress that moves away.
!>
!> A body drifts in an increment if it moves by one of its floating motions, all but rigidly, while
!> no force acts on it. What touches something in the end does not drift any more.
module lopin_check_drift
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_body_words, only : describe_motion
   use lopin_contact_points, only : pair_is_tied
   use lopin_constraints, only : raw_displacement
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: drift_type, measure_drift, check_drift

   !> Deformation beside motion below which a body moves as a whole.
   real(wp), parameter :: rigid = 1.0e-2_wp
   !> Forces beside stiffness times motion that are rounding.
   real(wp), parameter :: no_force = 1.0e-9_wp
   !> Ways below this share of the bodies are how they come to rest.
   real(wp), parameter :: at_rest = 1.0e-6_wp

   type :: drift_type
      real(wp), allocatable :: way(:)   !! (nbody) moved since a force last acted on it [length]
   end type drift_type

contains

   !> Look at the trial state of an increment that is about to be accepted.
   subroutine measure_drift(self, scene, model, load, pressed)
      type(drift_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: load(:), pressed(:)   !! (ndof) loads and contact forces [force]
      real(wp), allocatable :: q(:), stiffness(:)
      real(wp) :: force, moved, strayed, most, largest
      logical :: glued(scene%bodies%nbody)
      integer :: b, i

      if (.not. allocated(self%way)) allocate (self%way(scene%bodies%nbody), source=0.0_wp)
      if (scene%bodies%nq == 0) then
         self%way = 0.0_wp
         return
      end if
      allocate (stiffness(scene%dofs%n))
      call scene%k%diagonal(stiffness)
      largest = maxval(abs(scene%trial%motion%u - scene%accepted%motion%u))
      call find_glued(scene, model, glued)
      do b = 1, scene%bodies%nbody
         force = 0.0_wp
         most = 0.0_wp
         do i = 1, scene%dofs%n
            if (scene%bodies%body(scene%dofs%node(i)) /= b) cycle
            force = max(force, abs(load(i)), abs(pressed(i)))
            most = max(most, stiffness(i))
         end do
         moved = largest
         strayed = 0.0_wp
         if (force <= no_force*most*max(largest, self%way(b))) call fit_motion(scene, &
            & scene%trial%motion%u - scene%accepted%motion%u, b, q, moved, strayed)
         if (force > no_force*most*max(moved, self%way(b)) .or. glued(b)) then
            self%way(b) = 0.0_wp
         else if (strayed <= rigid*moved) then
            self%way(b) = self%way(b) + moved
         end if
      end do
   end subroutine measure_drift

   !> Bodies that a tie carries: they move with what they are tied to.
   subroutine find_glued(scene, model, glued)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      logical, intent(out) :: glued(:)         !! (nbody)
      integer :: i, k

      glued = .false.
      do i = 1, scene%points%n
         if (scene%points%facet(i) == 0) cycle
         if (.not. pair_is_tied(model, model%pair(scene%points%pair(i)))) cycle
         call take(scene%points%node(i))
         do k = 1, size(scene%points%master, 1)
            if (scene%points%master(k, i) > 0) call take(scene%points%master(k, i))
         end do
      end do

   contains

      subroutine take(node)
         integer, intent(in) :: node
         if (scene%bodies%body(node) > 0) glued(scene%bodies%body(node)) = .true.
      end subroutine take
   end subroutine find_glued

   !> Say at the end of the run which bodies nothing has stopped.
   subroutine check_drift(self, scene, model)
      type(drift_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), allocatable :: q(:)
      real(wp) :: moved, strayed
      integer :: b

      if (.not. allocated(self%way)) return
      do b = 1, size(self%way)
         if (.not. self%way(b) > at_rest*scene%bodies%length) cycle
         call fit_motion(scene, scene%trial%motion%u, b, q, moved, strayed)
         if (.not. moved > 0.0_wp) cycle
         call warn_once(scene%log, 'W0515', describe_motion(scene%bodies, model, q)// &
            & ': it has moved away as a whole by '//to_text(self%way(b), 4)//' at the end of '// &
            & 'step '//to_text(scene%step)//', and no force acts on it', &
            & model%step(scene%step)%at, help='look for a support or a contact pair that is '// &
            & 'forgotten: *BOUNDARY holds the body, or something that it ends against')
      end do
   end subroutine check_drift

   !> The floating motion nearest to displacements of a body, and what is left of them.
   subroutine fit_motion(scene, u, body, q, moved, strayed)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: u(:)                !! (ndof) [length]
      integer, intent(in) :: body
      real(wp), allocatable, intent(out) :: q(:)  !! (nq) amplitudes
      real(wp), intent(out) :: moved, strayed     !! largest components [length]
      real(wp) :: basis(scene%constraints%neq, scene%bodies%nq), left(scene%constraints%neq)
      real(wp) :: way(scene%bodies%nq, scene%bodies%nq), share, before
      integer :: i, k, m, n

      basis = 0.0_wp
      left = 0.0_wp
      do i = 1, scene%constraints%neq
         associate (raw => scene%constraints%dof_of_equation(i))
            if (scene%bodies%body(scene%dofs%node(raw)) /= body) cycle
            left(i) = raw_displacement(scene%constraints, scene%dofs, u, raw)
            basis(i, :) = scene%bodies%motion(i, :)
         end associate
      end do
      ! Gram and Schmidt; motions of other bodies vanish here.
      way = 0.0_wp
      allocate (q(scene%bodies%nq), source=0.0_wp)
      n = size(q)
      do k = 1, n
         way(k, k) = 1.0_wp
         before = norm2(basis(:, k))
         do m = 1, k - 1
            share = dot_product(basis(:, m), basis(:, k))
            basis(:, k) = basis(:, k) - share*basis(:, m)
            way(:, k) = way(:, k) - share*way(:, m)
         end do
         if (.not. norm2(basis(:, k)) > 1.0e-6_wp*max(before, 1.0_wp)) then
            basis(:, k) = 0.0_wp
            way(:, k) = 0.0_wp
            cycle
         end if
         way(:, k) = way(:, k)/norm2(basis(:, k))
         basis(:, k) = basis(:, k)/norm2(basis(:, k))
         q = q + dot_product(basis(:, k), left)*way(:, k)
      end do
      moved = maxval([0.0_wp, abs(matmul(basis, matmul(left, basis)))])
      strayed = maxval([0.0_wp, abs(left - matmul(basis, matmul(left, basis)))])
   end subroutine fit_motion
end module lopin_check_drift
