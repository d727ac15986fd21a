!> The residual of the nonlinear path at a trial state.
module lopin_residual
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_vectors, only : largest
   use lopin_clock, only : phase
   use lopin_model, only : model_type
   use lopin_constraints, only : reduce, prescribed_part
   use lopin_contact_evaluation, only : evaluate_contact
   use lopin_newton_workspace, only : is_nonlinear
   use lopin_rounding_floor, only : beyond
   use lopin_one_unit, only : as_forces
   use lopin_follower_loads, only : add_follower_loads
   use lopin_assemble_nonlinear, only : assemble_nonlinear, bad_element_type
   use lopin_rotating_bodies, only : rotate_followers, has_rotating_bodies, rotation_tangents
   use lopin_followed_stress, only : follow_stress, follow_slopes
   use lopin_held_points, only : find_idle_rows, wake_idle_rows
   use lopin_slip_increment, only : shear_excess
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: evaluation_type, evaluate, internal_forces, at_rows, largest_force, largest_pressure, &
      & gap_rounding

   !> Gaps smaller than this share of a facet are rounding of the positions of its nodes.
   real(wp), parameter :: facet_noise = 1.0e-11_wp

   !> What one evaluation at (u, multiplier) gives.
   type :: evaluation_type
      real(wp), allocatable :: internal(:)     !! (ndof) [force]
      real(wp), allocatable :: free(:)         !! (neq) residual [force], [force*length]
      real(wp), allocatable :: unlevel(:)      !! (neq) the same, moments as forces [force]
      real(wp), allocatable :: row(:)          !! (nmultiplier) as forces [force]
      real(wp) :: merit = 0.0_wp               !! [force]
      real(wp) :: force = 0.0_wp               !! largest of elements, loads and reactions [force]
      real(wp) :: unbalanced = 0.0_wp          !! residual beyond rounding [force]
      real(wp) :: unmet = 0.0_wp               !! rows beyond rounding [force]
      real(wp) :: contact_residual = 0.0_wp    !! contact rows beside the pressures of contact
      integer :: inverted = 0                  !! element that turned inside out
      logical :: tangent = .false.             !! the tangent was formed too
   end type evaluation_type

contains

   !> Forces, residuals and, if asked, the tangent at the trial state.
   subroutine evaluate(scene, model, f, with_tangent, evaluation, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      logical, intent(in) :: with_tangent
      type(evaluation_type), intent(inout) :: evaluation
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: residual(:)
      real(wp) :: grazing(scene%newton%contact%n)
      logical :: found, clings(scene%newton%contact%n)

      call scene%clock%stop_in(phase%solve)
      call rotate_followers(scene, model, error)
      if (allocated(error)) return
      evaluation%tangent = with_tangent
      if (.not. allocated(evaluation%internal)) allocate (evaluation%internal(scene%dofs%n), &
         & evaluation%free(scene%constraints%neq))
      call internal_forces(scene, model, with_tangent, evaluation%internal, evaluation%inverted)
      if (evaluation%inverted > 0) return
      call scene%clock%stop_in(phase%assemble)
      call follow_stress(scene, model)
      grazing = scene%newton%contact%enforcement%grazing
      clings = scene%newton%contact%enforcement%clings
      if (with_tangent) call wake_idle_rows(scene, model)
      call evaluate_contact(scene%newton%contact, model, scene%trial%motion%u, &
         & scene%trial%contact%multiplier, with_tangent, &
         & error)
      if (allocated(error)) return
      if (with_tangent) then
         call find_idle_rows(scene, model, found)
         if (found) then
            scene%newton%contact%enforcement%grazing = grazing
            scene%newton%contact%enforcement%clings = clings
            call evaluate_contact(scene%newton%contact, model, scene%trial%motion%u, &
               & scene%trial%contact%multiplier, with_tangent, error)
         end if
         if (allocated(error)) return
      end if
      if (with_tangent) call follow_slopes(scene, model)
      call scene%clock%stop_in(phase%contact)
      residual = evaluation%internal - f - scene%newton%contact%force
      if (scene%newton%nlgeom) then
         call add_face_pressures(scene, model, with_tangent)
         residual = residual - scene%newton%follower%force
      end if
      if (with_tangent .and. has_rotating_bodies(scene, model)) call rotation_tangents(scene, &
         & model, residual, scene%newton%turning)
      if (scene%newton%damping%on) call add_damping(scene, residual)
      call weigh(evaluation, scene, f, residual)
   end subroutine evaluate

   !> What is out of balance at the trial state, in numbers.
   subroutine weigh(evaluation, scene, f, residual)
      type(evaluation_type), intent(inout) :: evaluation
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: f(:), residual(:)      !! (ndof) loads, what is out of balance [force]
      real(wp) :: reaction(scene%constraints%nprescribed)

      call reduce(scene%constraints, residual, evaluation%free)
      call prescribed_part(scene%constraints, residual, reaction)
      scene%newton%internal = evaluation%internal
      evaluation%row = scene%newton%contact%row*row_scale(scene)
      associate (dof => scene%constraints%dof_of_equation)
         evaluation%unlevel = as_forces(scene, evaluation%free, dof)
         evaluation%unbalanced = beyond(evaluation%unlevel, as_forces(scene, scene%newton%floor, &
            & dof))
      end associate
      evaluation%merit = sqrt(sum(evaluation%unlevel**2) + sum(evaluation%row**2))
      evaluation%unmet = beyond(evaluation%row, scene%newton%row_floor)
      evaluation%force = largest_force(scene, f, reaction)
      evaluation%contact_residual = contact_residual(scene)
   end subroutine weigh

   !> Largest force of a state: of an element on a node, before its neighbours cancel it; of loads;
   !> of reactions. What assembled forces leave at a node that is free is the residual itself.
   !>
   !> A reaction sums what nodes bear. Ties between supports on both sides may give them any force,
   !> and beside 1e9 times its load a body was in balance wherever it stood. Where nothing bears
   !> anything yet but contact, its springs are what counts.
   pure real(wp) function largest_force(scene, f, reaction) result(force)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: f(:), reaction(:)      !! loads, reactions [force], [force*length]
      real(wp) :: met, most
      integer :: i, all_dofs(size(f))

      all_dofs = [(i, i=1, size(f))]
      force = max(largest(as_forces(scene, f, all_dofs)), scene%newton%element_force)
      if (scene%newton%nlgeom) force = max(force, largest(scene%newton%follower%force))
      met = largest(as_forces(scene, reaction, scene%constraints%dof_of_prescribed))
      most = size(f)*force
      if (met > most) most = max(most, size(f)*largest(as_forces(scene, scene%newton%internal, &
         & all_dofs)))
      force = max(force, merge(min(met, most), met, most > 0.0_wp))
   end function largest_force

   !> What is left of the contact conditions as the certificate sees it: shear beyond its bounds,
   !> which may be far below the forces beside which rows are judged, and where metal flows rows
   !> beside the pressures of contact. A body that is all but released has large forces of its own.
   pure real(wp) function contact_residual(scene)
      type(scene_type), intent(in) :: scene
      real(wp) :: scale, left(scene%newton%contact%n)
      integer :: i

      contact_residual = shear_excess(scene%newton%contact, scene%newton%noise)
      if (.not. scene%newton%flows) return
      scale = largest_pressure(scene)
      if (.not. scale > 0.0_wp) return
      associate (c => scene%newton%contact)
         ! Of all directions of a point together: their parts along axes depend on the axes.
         left = 0.0_wp
         do i = 1, c%nmultiplier
            left(c%point_of_row(i)) = left(c%point_of_row(i)) + c%row(i)**2
         end do
         do i = 1, c%n
            contact_residual = max(contact_residual, c%c(i)*(sqrt(left(i)) &
               & - gap_rounding(scene, i))/scale)
         end do
      end associate
   end function contact_residual

   !> Pressure beside which contact is judged: the largest, or what rounding of places makes.
   pure real(wp) function largest_pressure(scene) result(pressure)
      type(scene_type), intent(in) :: scene

      pressure = 0.0_wp
      associate (c => scene%newton%contact)
         if (c%n > 0) pressure = max(largest(c%pressure(:c%n)), scene%newton%noise*largest(c%c))
      end associate
   end function largest_pressure

   !> Gap of a point that is rounding of places.
   pure real(wp) function gap_rounding(scene, point) result(gap)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: point

      gap = max(facet_noise*scene%newton%contact%size(point), scene%newton%noise)
   end function gap_rounding

   !> Pressures at the trial displacements.
   subroutine add_face_pressures(scene, model, with_tangent)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: with_tangent

      associate (follower => scene%newton%follower)
         follower%force = 0.0_wp
         if (with_tangent) then
            call add_follower_loads(scene%solids, model%mesh, scene%trial%motion%u, &
               & follower%element, &
               & follower%face, follower%pressure, follower%force, follower%local)
         else
            call add_follower_loads(scene%solids, model%mesh, scene%trial%motion%u, &
               & follower%element, &
               & follower%face, follower%pressure, follower%force)
         end if
      end associate
   end subroutine add_face_pressures

   !> Stiffness c times area of every multiplier row.
   function row_scale(scene) result(scale)
      type(scene_type), intent(in) :: scene
      real(wp) :: scale(scene%newton%contact%nmultiplier)
      scale = at_rows(scene, scene%newton%contact%c)*at_rows(scene, scene%newton%contact%weight)
   end function row_scale

   !> Values of points at their multiplier rows.
   function at_rows(scene, value) result(at_row)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: value(:)
      real(wp) :: at_row(scene%newton%contact%nmultiplier)
      at_row = value(scene%newton%contact%point_of_row)
   end function at_rows

   !> Internal forces of the solids at the trial displacements, and their tangent in finite%k.
   subroutine internal_forces(scene, model, with_tangent, internal, inverted)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: with_tangent
      real(wp), intent(out) :: internal(:)
      integer, intent(out) :: inverted

      type(bad_element_type) :: bad

      inverted = 0
      if (.not. is_nonlinear(scene%newton)) then
         call scene%k%multiply(scene%trial%motion%u, internal)
         scene%newton%energy = 0.5_wp*dot_product(scene%trial%motion%u, internal)
         ! Without stresses of the start, forces of linear solids vanish with their strains alone.
         scene%newton%element_force = largest(internal)
         return
      end if
      if (with_tangent) then
         if (.not. allocated(scene%newton%k%value)) scene%newton%k = scene%k
         call assemble_nonlinear(scene%solids, model%mesh, scene%trial%motion%u, &
            & scene%newton%past, internal, &
            & scene%newton%energy, bad, scene%newton%k)
      else
         call assemble_nonlinear(scene%solids, model%mesh, scene%trial%motion%u, &
            & scene%newton%past, internal, &
            & scene%newton%energy, bad)
      end if
      inverted = bad%element
      scene%newton%element_force = bad%force
      if (with_tangent .and. scene%newton%damping%on .and. inverted == 0) scene%newton%k%value = &
         & scene%newton%k%value + scene%newton%damping%rate*scene%newton%damping%metric%value
   end subroutine internal_forces

   !> What resists the motion through pseudo-time.
   subroutine add_damping(scene, residual)
      type(scene_type), intent(in) :: scene
      real(wp), intent(inout) :: residual(:)   !! (ndof) [force]
      real(wp) :: resistance(size(residual))

      call scene%newton%damping%metric%multiply(scene%trial%motion%u - scene%newton%damping%from, &
         & resistance)
      residual = residual + scene%newton%damping%rate*resistance
   end subroutine add_damping
end module lopin_residual
