!> One step of Newton on the nonlinear path: the direction by the exact tangent. How much of it is
!> taken, the line search says (lopin_line_search).
module lopin_newton_step
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_vectors, only : largest
   use lopin_model, only : model_type
   use lopin_constraints, only : reduce
   use lopin_one_unit, only : as_lengths
   use lopin_local_matrix, only : local_matrix_type
   use lopin_friction, only : has_friction
   use lopin_newton_system, only : set_tangent, add_ground_springs, solve_step
   use lopin_apply_locals, only : apply_locals
   use lopin_newton_workspace, only : is_nonlinear
   use lopin_residual, only : evaluation_type, at_rows
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: some_body_falls, find_step

   !> Residuals of a solid that flows, beside the largest force, that nothing asks to be smaller.
   real(wp), parameter :: enough = 1.0e-10_wp
   !> Tolerance of GMRES where only the length of a correction matters.
   real(wp), parameter, public :: coarse = 1.0e-4_wp
   !> And then no solution of the linear system better than this.
   real(wp), parameter :: coarsest = 1.0e-2_wp
   !> And of a Newton step.
   real(wp), parameter :: tight = 1.0e-9_wp
   !> Springs to the ground of a body that nothing holds, beside its stiffness; how far one
   !> iteration may move it, beside its length.
   real(wp), parameter :: soft = 1.0e-4_wp, most_motion = 0.1_wp
   integer, parameter :: most_softer = 20
   !> A free body whose step is longer than this many scenes is held by nothing but rounding.
   real(wp), parameter :: beyond = 1.0e3_wp

contains

   !> There are tangents of pressures or of turning bodies.
   pure logical function has_more_locals(scene) result(has)
      type(scene_type), intent(in) :: scene

      has = allocated(scene%newton%turning)
      if (scene%newton%nlgeom) has = has .or. size(scene%newton%follower%local) > 0
   end function has_more_locals

   !> Tangents of the contact points and, under NLGEOM, of the pressures.
   subroutine collect_locals(scene, local)
      type(scene_type), intent(in) :: scene
      type(local_matrix_type), allocatable, intent(out) :: local(:)
      integer :: n, m

      n = scene%newton%contact%nlocal
      m = 0
      if (scene%newton%nlgeom) m = size(scene%newton%follower%local)
      allocate (local(n + m))
      local(:n) = scene%newton%contact%local(:n)
      if (m > 0) local(n + 1:) = scene%newton%follower%local
      if (allocated(scene%newton%turning)) local = [local, scene%newton%turning]
   end subroutine collect_locals

   !> The Newton direction for free equations and multipliers.
   subroutine find_step(scene, model, evaluation, remaining, step, error, flat, by_old)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(evaluation_type), intent(in) :: evaluation
      real(wp), intent(in) :: remaining(:)     !! (ndof) prescribed displacements still to come
      real(wp), allocatable, intent(out) :: step(:)
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: flat              !! contact has just changed: normals stand still
      logical, intent(in) :: by_old            !! by the factor at hand; jump = 0
      real(wp), allocatable :: right(:)
      type(local_matrix_type), allocatable :: local(:)
      real(wp) :: tolerance
      integer :: bad, pass

      associate (contact => scene%newton%contact, system => scene%newton%system, &
         & neq => scene%constraints%neq)
         allocate (step(neq + contact%nmultiplier), right(neq + contact%nmultiplier))
         right(:neq) = -evaluation%free
         right(neq + 1:) = -contact%row
         if (.not. by_old) then
            if (has_more_locals(scene)) then
               call collect_locals(scene, local)
               call use_tangent(scene, local, remaining, flat, right)
            else
               call use_tangent(scene, contact%local(:contact%nlocal), remaining, flat, right)
            end if
         end if
         tolerance = forcing(scene, evaluation)
         do pass = 1, 2
            call solve_step(system, right, tolerance, step, scene%clock, &
               & scene%counter, bad, error)
            if (allocated(error)) return
            if (bad == 0) then
               if (scene%bodies%nq == 0 .or. pass > 1) exit
               if (.not. way_of(scene, step(:neq)) > beyond*scene%bodies%length) exit
               bad = 1
            end if
            if (pass == 2 .or. scene%bodies%nq == 0) then
               call raise(error, error_code%not_converged, 'E0511', &
                  & 'the tangent is singular: a limit load, or a part that is free to move', &
                  & model%step(scene%step)%at, &
                  & help='drive by displacement instead of force, or hold the part')
               return
            end if
            call add_ground_springs(system, scene%bodies%support, softer(scene))
            scene%newton%grounded = scene%newton%grounded + 1
         end do
         if (pass > 1) call limit_motion(scene, step(:neq))
         contact%has_arrived = .true.
      end associate
   end subroutine find_step

   !> Stiffness of the ground: a body that falls on and on without contact goes faster and faster.
   pure real(wp) function softer(scene)
      type(scene_type), intent(in) :: scene

      softer = soft
      if (some_body_falls(scene)) softer = soft*0.5_wp**min(scene%newton%grounded, most_softer)
   end function softer

   !> No contact is closed, or a body that floats has none that is.
   pure logical function some_body_falls(scene) result(falls)
      type(scene_type), intent(in) :: scene
      logical :: touched(scene%bodies%nbody), is_free(scene%bodies%nbody)
      integer :: i, body

      associate (c => scene%newton%contact)
         falls = all(c%status(:c%n) <= 0)
         if (falls .or. scene%bodies%nq == 0) return
         touched = .false.
         do i = 1, scene%dofs%n
            body = scene%bodies%body(scene%dofs%node(i))
            if (body > 0) touched(body) = touched(body) .or. abs(c%force(i)) > 0.0_wp
         end do
      end associate
      is_free = .false.
      do i = 1, scene%constraints%neq
         body = scene%bodies%body(scene%dofs%node(scene%constraints%dof_of_equation(i)))
         if (body > 0) is_free(body) = is_free(body) .or. any(abs(scene%bodies%motion(i, :)) &
            & > 0.0_wp)
      end do
      falls = any(is_free .and. .not. touched)
   end function some_body_falls

   !> The tangent for the linear system, and what it brings to the right-hand side.
   subroutine use_tangent(scene, local, remaining, flat, right)
      type(scene_type), intent(inout) :: scene
      type(local_matrix_type), intent(in) :: local(:)
      real(wp), intent(in) :: remaining(:)     !! (ndof)
      logical, intent(in) :: flat
      real(wp), intent(inout) :: right(:)      !! (neq + nmultiplier)

      if (any(abs(remaining) > 0.0_wp)) call push_along(scene, local, remaining, right)
      call take_tangent(scene, local, flat)
   end subroutine use_tangent

   !> What the prescribed displacements that are still to come ask of the right-hand side.
   subroutine push_along(scene, local, remaining, right)
      type(scene_type), intent(in) :: scene
      type(local_matrix_type), intent(in) :: local(:)
      real(wp), intent(in) :: remaining(:)     !! (ndof)
      real(wp), intent(inout) :: right(:)      !! (neq + nmultiplier)
      real(wp) :: pushed(scene%dofs%n + size(right) - scene%constraints%neq)
      real(wp) :: reduced(scene%constraints%neq)

      pushed = 0.0_wp
      associate (neq => scene%constraints%neq, ndof => scene%dofs%n)
         if (is_nonlinear(scene%newton)) then
            call scene%newton%k%multiply(remaining, pushed(:ndof))
         else
            call scene%k%multiply(remaining, pushed(:ndof))
         end if
         call apply_locals(size(local), local, remaining, pushed)
         call reduce(scene%constraints, pushed(:ndof), reduced)
         right(:neq) = right(:neq) - reduced
         right(neq + 1:) = right(neq + 1:) - pushed(ndof + 1:)
      end associate
   end subroutine push_along

   !> Hand the tangent of the last look to the linear system.
   subroutine take_tangent(scene, local, flat)
      type(scene_type), intent(inout) :: scene
      type(local_matrix_type), intent(in) :: local(:)
      logical, intent(in) :: flat

      associate (contact => scene%newton%contact, system => scene%newton%system)
         ! Where solids flow c is small beside them. Friction of elastic ones keeps the digit: the
         ! direction of a slip that is small beside traction/c is all that tells that of a traction.
         system%firm = scene%newton%flows .or. .not. any(has_friction(contact%friction))
         if (is_nonlinear(scene%newton)) then
            call set_tangent(system, scene%newton%k, scene%constraints, size(local), local, &
               & at_rows(scene, contact%c), at_rows(scene, contact%weight), flat)
         else
            call set_tangent(system, scene%k, scene%constraints, size(local), local, &
               & at_rows(scene, contact%c), at_rows(scene, contact%weight), flat)
         end if
      end associate
   end subroutine take_tangent

   !> Tolerance of GMRES for one Newton step: tight; looser for solids that flow while the residual
   !> is large, which keeps the order of Newton (Eisenstat and Walker 1996), and where less would do
   !> for an answer well beyond convergence. The stiff volume of solids without an elastic part
   !> would hide in it what is left of their flow.
   pure real(wp) function forcing(scene, evaluation)
      type(scene_type), intent(in) :: scene
      type(evaluation_type), intent(in) :: evaluation
      real(wp) :: residual, reference
      integer :: i

      forcing = tight
      if (any([(scene%solids%group(i)%law%flow%rigid, i=1, size(scene%solids%group))])) return
      reference = max(scene%newton%reference, evaluation%force)
      if (.not. scene%newton%flows .or. .not. reference > 0.0_wp) return
      residual = evaluation%merit/reference
      forcing = max(tight, min(coarse, residual**2), min(coarsest, enough/max(residual, enough)))
   end function forcing

   !> A body on soft springs goes as far as a search can follow.
   subroutine limit_motion(scene, step)
      type(scene_type), intent(in) :: scene
      real(wp), intent(inout) :: step(:)
      real(wp) :: way

      way = way_of(scene, step)
      if (way > most_motion*scene%bodies%length) step = step*(most_motion*scene%bodies%length/way)
   end subroutine limit_motion

   !> How far a step goes, rotations by the length of the scene.
   pure real(wp) function way_of(scene, step) result(way)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: step(:)          !! (neq)
      way = largest(as_lengths(scene, step, scene%constraints%dof_of_equation))
   end function way_of
end module lopin_newton_step
