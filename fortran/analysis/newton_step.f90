!> One step of Newton on the finite path: the direction by the exact tangent, and how much of it to
!> take.
module lopin_newton_step
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_vectors, only : largest
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_constraints, only : expand, reduce
   use lopin_finite_kernel, only : local_matrix_type
   use lopin_finite_system, only : set_tangent, put_on_ground, solve_step
   use lopin_contact_block, only : apply_locals
   use lopin_finite_state, only : is_nonlinear
   use lopin_finite_forces, only : look_type, look_at, of_rows
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: some_body_falls, find_step, take_step, refuse_inverted

   !> Displacements that are no more than rounding, beside the scene.
   real(wp), parameter :: motionless = 1.0e-9_wp
   integer, parameter :: most_halvings = 6
   !> A Newton step that lowers the merit by less than this is not worth a halving.
   real(wp), parameter :: sufficient = 1.0e-4_wp
   !> Tolerance of GMRES where only the length of a correction matters.
   real(wp), parameter, public :: coarse = 1.0e-4_wp
   !> Residuals of a solid that flows, beside the largest force, that nothing asks to be smaller.
   real(wp), parameter :: enough = 1.0e-10_wp
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

   !> Tangents of the contact points and, under NLGEOM, of the pressures.
   subroutine collect_locals(scene, local)
      type(scene_type), intent(in) :: scene
      type(local_matrix_type), allocatable, intent(out) :: local(:)
      integer :: n, m

      n = scene%finite%contact%nlocal
      m = 0
      if (scene%finite%nlgeom) m = size(scene%finite%follower%local)
      allocate (local(n + m))
      local(:n) = scene%finite%contact%local(:n)
      if (m > 0) local(n + 1:) = scene%finite%follower%local
      if (allocated(scene%finite%turning)) local = [local, scene%finite%turning]
   end subroutine collect_locals

   !> The Newton direction for free equations and multipliers.
   subroutine find_step(scene, model, look, jump, step, error, flat, by_old)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(look_type), intent(in) :: look
      real(wp), intent(in) :: jump(:)          !! (ndof) prescribed displacements still to come
      real(wp), allocatable, intent(out) :: step(:)
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: flat              !! contact has just changed: normals stand still
      logical, intent(in) :: by_old            !! by the factor at hand; jump = 0
      real(wp), allocatable :: right(:)
      type(local_matrix_type), allocatable :: local(:)
      real(wp) :: tolerance
      integer :: bad, pass

      associate (contact => scene%finite%contact, system => scene%finite%system, &
         & neq => scene%constraints%neq)
         allocate (step(neq + contact%nmultiplier), right(neq + contact%nmultiplier))
         right(:neq) = -look%free
         right(neq + 1:) = -contact%row
         if (.not. by_old) then
            call collect_locals(scene, local)
            if (any(abs(jump) > 0.0_wp)) call push_along(scene, local, jump, right)
            call take_tangent(scene, local, flat)
         end if
         tolerance = forcing(scene, look)
         do pass = 1, 2
            call solve_step(system, right, tolerance, model%solver, step, scene%clock, &
               & scene%counter, bad, error)
            if (allocated(error)) return
            if (bad == 0 .and. .not. (scene%bodies%nq > 0 .and. pass == 1 .and. &
               & largest(step(:neq)) > beyond*scene%bodies%length)) exit
            if (bad == 0) bad = 1
            if (pass == 2 .or. scene%bodies%nq == 0) then
               call raise(error, error_code%not_converged, 'E0511', &
                  & 'the tangent is singular: a limit load, or a part that is free to move', &
                  & model%step(scene%step)%at, &
                  & help='drive by displacement instead of force, or hold the part')
               return
            end if
            call put_on_ground(system, scene%bodies%support, softer(scene))
            scene%finite%grounded = scene%finite%grounded + 1
         end do
         if (pass > 1) call limit_motion(scene, step(:neq))
      end associate
   end subroutine find_step

   !> Stiffness of the ground: a body that falls on and on without contact goes faster and faster.
   pure real(wp) function softer(scene)
      type(scene_type), intent(in) :: scene

      softer = soft
      if (some_body_falls(scene)) softer = soft*0.5_wp**min(scene%finite%grounded, most_softer)
   end function softer

   !> No contact is closed, or a body that floats has none that is.
   pure logical function some_body_falls(scene) result(falls)
      type(scene_type), intent(in) :: scene
      logical :: touched(scene%bodies%nbody), floats(scene%bodies%nbody)
      integer :: i, body

      associate (c => scene%finite%contact)
         falls = all(c%status(:c%n) <= 0)
         if (falls .or. scene%bodies%nq == 0) return
         touched = .false.
         do i = 1, scene%dofs%n
            body = scene%bodies%body(scene%dofs%node(i))
            if (body > 0) touched(body) = touched(body) .or. abs(c%force(i)) > 0.0_wp
         end do
      end associate
      floats = .false.
      do i = 1, scene%constraints%neq
         body = scene%bodies%body(scene%dofs%node(scene%constraints%dof_of_equation(i)))
         if (body > 0) floats(body) = floats(body) .or. any(abs(scene%bodies%motion(i, :)) > 0.0_wp)
      end do
      falls = any(floats .and. .not. touched)
   end function some_body_falls

   !> What the prescribed displacements that are still to come ask of the right-hand side.
   subroutine push_along(scene, local, jump, right)
      type(scene_type), intent(in) :: scene
      type(local_matrix_type), intent(in) :: local(:)
      real(wp), intent(in) :: jump(:)          !! (ndof)
      real(wp), intent(inout) :: right(:)      !! (neq + nmultiplier)
      real(wp) :: pushed(scene%dofs%n + size(right) - scene%constraints%neq)
      real(wp) :: reduced(scene%constraints%neq)

      pushed = 0.0_wp
      associate (neq => scene%constraints%neq, ndof => scene%dofs%n)
         if (is_nonlinear(scene%finite)) then
            call scene%finite%k%multiply(jump, pushed(:ndof))
         else
            call scene%k%multiply(jump, pushed(:ndof))
         end if
         call apply_locals(size(local), local, jump, pushed)
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

      associate (contact => scene%finite%contact, system => scene%finite%system)
         if (is_nonlinear(scene%finite)) then
            call set_tangent(system, scene%finite%k, scene%constraints, size(local), local, &
               & of_rows(scene, contact%c), of_rows(scene, contact%weight), flat)
         else
            call set_tangent(system, scene%k, scene%constraints, size(local), local, &
               & of_rows(scene, contact%c), of_rows(scene, contact%weight), flat)
         end if
      end associate
   end subroutine take_tangent

   !> Tolerance of GMRES for one Newton step: tight; looser for solids that flow while the residual
   !> is large, which keeps the order of Newton (Eisenstat and Walker 1996), and where less would do
   !> for an answer well beyond convergence. The stiff volume of solids without an elastic part
   !> would hide in it what is left of their flow.
   pure real(wp) function forcing(scene, look)
      type(scene_type), intent(in) :: scene
      type(look_type), intent(in) :: look
      real(wp) :: residual, reference
      integer :: i

      forcing = tight
      if (any([(scene%solids%group(i)%law%flow%rigid, i=1, size(scene%solids%group))])) return
      reference = max(scene%finite%reference, look%force)
      if (.not. scene%finite%flows .or. .not. reference > 0.0_wp) return
      residual = look%merit/reference
      forcing = max(tight, min(coarse, residual**2), min(coarsest, enough/max(residual, enough)))
   end function forcing

   !> A body on soft springs goes as far as a search can follow.
   subroutine limit_motion(scene, step)
      type(scene_type), intent(in) :: scene
      real(wp), intent(inout) :: step(:)
      real(wp) :: way

      way = largest(step)
      if (way > most_motion*scene%bodies%length) step = step*(most_motion*scene%bodies%length/way)
   end subroutine limit_motion

   !> Natural monotonicity (Deuflhard 2011, 3.3): the next correction, by the same tangent, is
   !> shorter than this one. Forces of an almost incompressible solid grow on the best of ways; its
   !> corrections do not.
   logical function contracts(scene, model, look, step, share)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(look_type), intent(in) :: look      !! at this share of the step
      real(wp), intent(in) :: step(:), share
      real(wp) :: next(size(step)), right(size(step))
      type(error_type), allocatable :: error
      integer :: bad

      associate (neq => scene%constraints%neq)
         right(:neq) = -look%free
         right(neq + 1:) = -scene%finite%contact%row
         call solve_step(scene%finite%system, right, coarse, model%solver, next, scene%clock, &
            & scene%counter, bad, error)
         contracts = .not. allocated(error) .and. bad == 0
         if (contracts) contracts = norm2(next(:neq)) <= (1.0_wp - 0.25_wp*share)*norm2(step(:neq))
      end associate
   end function contracts

   !> No correction of a solid that flows goes farther than this: beyond it contact knows nothing of
   !> what lies opposite, and a body that has just lost it flies away.
   real(wp) function longest_facet(scene)
      type(scene_type), intent(in) :: scene

      longest_facet = huge(1.0_wp)
      if (scene%finite%contact%n > 0) longest_facet = maxval(scene%finite%contact%size)
   end function longest_facet

   !> Take the step, shortened until the merit is acceptable; the best try if none is.
   subroutine take_step(scene, model, f, v, prescribed, step, first, merit, with_tangent, look, &
      & size_, share, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      real(wp), intent(inout) :: v(:)
      real(wp), intent(in) :: prescribed(:), step(:)
      logical, intent(in) :: first             !! the step that applies the prescribed values
      real(wp), intent(in) :: merit            !! largest of the last few
      logical, intent(in) :: with_tangent      !! of the whole step; a shorter one always has it
      type(look_type), intent(inout) :: look
      real(wp), intent(out) :: size_           !! of the correction beside the displacements
      real(wp), intent(out) :: share           !! of the step that was taken
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: from(:), from_multiplier(:)
      real(wp) :: best, best_share
      integer :: try

      allocate (from, source=v)
      allocate (from_multiplier, source=scene%trial%contact%multiplier)
      best = huge(1.0_wp)
      best_share = 0.0_wp
      size_ = 0.0_wp
      share = 1.0_wp
      if (scene%finite%flows .and. .not. first) share = min(1.0_wp, &
         & longest_facet(scene)/max(largest(step(:scene%constraints%neq)), tiny(1.0_wp)))
      do try = 0, most_halvings
         call go(with_tangent .and. try == 0)
         if (allocated(error)) return
         if (look%inverted == 0) then
            if (first .or. look%merit <= (1.0_wp - sufficient*share)*merit) exit
            if (contracts(scene, model, look, step, share)) exit
            if (look%merit < best) then
               best = look%merit
               best_share = share
            end if
         end if
         if (first .and. look%inverted > 0) exit
         share = 0.5_wp*share
      end do
      if (look%inverted > 0 .and. .not. best_share > 0.0_wp) then
         call refuse_inverted(scene, model, look, error)
         return
      end if
      if (try > most_halvings) share = best_share
      if (try > 0) call go(.true.)
      scene%finite%correction = share*largest(step(:scene%constraints%neq))
      size_ = scene%finite%correction/max(largest(scene%trial%motion%u), &
         & motionless*scene%bodies%length)

   contains

      !> The state at a share of the step.
      subroutine go(tangent)
         logical, intent(in) :: tangent

         v = from + share*step(:scene%constraints%neq)
         call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
         scene%trial%contact%multiplier = from_multiplier + share*step(scene%constraints%neq + 1:)
         associate (c => scene%finite%contact)
            if (c%noted > 0.0_wp) c%noted = share*c%ahead
         end associate
         call look_at(scene, model, f, tangent, look, error)
      end subroutine go
   end subroutine take_step

   !> A state in which an element is turned inside out, as an error.
   subroutine refuse_inverted(scene, model, look, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(look_type), intent(in) :: look
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: besides

      besides = ''
      if (scene%solids%group(scene%solids%which(look%inverted))%element%nmode > 0) &
         & besides = ', or its internal modes find no balance'
      call raise(error, error_code%not_converged, 'E0512', 'element '// &
         & to_text(model%mesh%element_label(look%inverted))//' would turn inside out'//besides, &
         & model%step(scene%step)%at, help='smaller increments, or a mesh that bears the strain')
   end subroutine refuse_inverted
end module lopin_newton_step
