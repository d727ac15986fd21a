!> All forces of a trial state of the finite path, and how far it is from equilibrium.
module lopin_finite_forces
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_vectors, only : largest
   use lopin_clock, only : phase
   use lopin_model, only : model_type
   use lopin_constraints, only : reduce, prescribed_part
   use lopin_finite_evaluation, only : evaluate
   use lopin_finite_state, only : is_nonlinear
   use lopin_rounding_floor, only : beyond
   use lopin_follower_loads, only : add_follower_loads
   use lopin_assemble_finite, only : assemble_finite, bad_element_type
   use lopin_turning_bodies, only : turn_followers, has_turning, turning_tangents
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: look_type, look_at, internal_forces, of_rows, forces_about, pressure_about, nil_gap

   !> Gaps smaller than this share of a facet are rounding of the positions of its nodes.
   real(wp), parameter :: facet_noise = 1.0e-11_wp

   !> What one evaluation at (u, multiplier) gives.
   type :: look_type
      real(wp), allocatable :: internal(:)     !! (ndof) [force]
      real(wp), allocatable :: free(:)         !! (neq) residual [force]
      real(wp), allocatable :: row(:)          !! (nmultiplier) as forces [force]
      real(wp) :: merit = 0.0_wp               !! [force]
      real(wp) :: force = 0.0_wp               !! largest of elements, loads and reactions [force]
      real(wp) :: unbalanced = 0.0_wp          !! residual beyond rounding [force]
      real(wp) :: unmet = 0.0_wp               !! rows beyond rounding [force]
      real(wp) :: ajar = 0.0_wp                !! contact rows beside the pressures of contact
      integer :: inverted = 0                  !! element that turned inside out
      logical :: tangent = .false.             !! the tangent was formed too
   end type look_type

contains

   !> Forces, residuals and, if asked, the tangent at the trial state.
   subroutine look_at(scene, model, f, with_tangent, look, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: f(:)
      logical, intent(in) :: with_tangent
      type(look_type), intent(inout) :: look
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: residual(:), reaction(:)

      call scene%clock%stop_in(phase%solve)
      call turn_followers(scene, model, error)
      if (allocated(error)) return
      look%tangent = with_tangent
      if (.not. allocated(look%internal)) allocate (look%internal(scene%dofs%n), &
         & look%free(scene%constraints%neq))
      call internal_forces(scene, model, with_tangent, look%internal, look%inverted)
      if (look%inverted > 0) return
      call scene%clock%stop_in(phase%assemble)
      call evaluate(scene%finite%contact, model, scene%trial%motion%u, &
         & scene%trial%contact%multiplier, with_tangent, &
         & error)
      if (allocated(error)) return
      call scene%clock%stop_in(phase%contact)
      residual = look%internal - f - scene%finite%contact%force
      if (scene%finite%nlgeom) then
         call push_faces(scene, model, with_tangent)
         residual = residual - scene%finite%follower%force
      end if
      if (with_tangent .and. has_turning(scene, model)) call turning_tangents(scene, model, &
         & residual, scene%finite%turning)
      if (scene%finite%drag%on) call resist(scene, residual)
      call reduce(scene%constraints, residual, look%free)
      allocate (reaction(scene%constraints%nprescribed))
      call prescribed_part(scene%constraints, residual, reaction)
      scene%finite%internal = look%internal
      look%row = scene%finite%contact%row*row_scale(scene)
      look%merit = sqrt(sum(look%free**2) + sum(look%row**2))
      look%unbalanced = beyond(look%free, scene%finite%floor)
      look%unmet = beyond(look%row, scene%finite%row_floor)
      look%force = forces_about(scene, f, reaction)
      if (scene%finite%flows) look%ajar = ajar(scene)
   end subroutine look_at

   !> Largest force of a state: of an element on a node, before its neighbours cancel it; of loads;
   !> of reactions. What assembled forces leave at a node that is free is the residual itself.
   pure real(wp) function forces_about(scene, f, reaction) result(force)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: f(:), reaction(:)      !! loads, reactions [force]

      force = max(largest(f), largest(reaction), scene%finite%element_force)
      if (scene%finite%nlgeom) force = max(force, largest(scene%finite%follower%force))
   end function forces_about

   !> What is left of the contact conditions as the certificate sees it: beside the pressures of
   !> contact. A body that is all but released has large forces of its own.
   pure real(wp) function ajar(scene)
      type(scene_type), intent(in) :: scene
      real(wp) :: scale
      integer :: i

      ajar = 0.0_wp
      scale = pressure_about(scene)
      if (.not. scale > 0.0_wp) return
      associate (c => scene%finite%contact)
         do i = 1, c%nmultiplier
            associate (point => c%point_of_row(i))
               ajar = max(ajar, c%c(point)*(abs(c%row(i)) - nil_gap(scene, point))/scale)
            end associate
         end do
      end associate
   end function ajar

   !> Pressure beside which contact is judged: the largest, or what rounding of places makes.
   pure real(wp) function pressure_about(scene) result(pressure)
      type(scene_type), intent(in) :: scene

      pressure = 0.0_wp
      associate (c => scene%finite%contact)
         if (c%n > 0) pressure = max(largest(c%pressure(:c%n)), scene%finite%noise*largest(c%c))
      end associate
   end function pressure_about

   !> Gap of a point that is rounding of places.
   pure real(wp) function nil_gap(scene, point) result(gap)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: point

      gap = max(facet_noise*scene%finite%contact%size(point), scene%finite%noise)
   end function nil_gap

   !> Pressures at the trial displacements.
   subroutine push_faces(scene, model, with_tangent)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: with_tangent

      associate (follower => scene%finite%follower)
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
   end subroutine push_faces

   !> Stiffness c times area of every multiplier row.
   function row_scale(scene) result(scale)
      type(scene_type), intent(in) :: scene
      real(wp) :: scale(scene%finite%contact%nmultiplier)
      scale = of_rows(scene, scene%finite%contact%c)*of_rows(scene, scene%finite%contact%weight)
   end function row_scale

   !> Values of points at their multiplier rows.
   function of_rows(scene, value) result(at_row)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: value(:)
      real(wp) :: at_row(scene%finite%contact%nmultiplier)
      at_row = value(scene%finite%contact%point_of_row)
   end function of_rows

   !> Internal forces of the solids at the trial displacements, and their tangent in finite%k.
   subroutine internal_forces(scene, model, with_tangent, internal, inverted)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: with_tangent
      real(wp), intent(out) :: internal(:)
      integer, intent(out) :: inverted

      type(bad_element_type) :: bad

      inverted = 0
      if (.not. is_nonlinear(scene%finite)) then
         call scene%k%multiply(scene%trial%motion%u, internal)
         scene%finite%energy = 0.5_wp*dot_product(scene%trial%motion%u, internal)
         ! Without stresses of the start, forces of linear solids vanish with their strains alone.
         scene%finite%element_force = largest(internal)
         return
      end if
      if (with_tangent) then
         if (.not. allocated(scene%finite%k%value)) scene%finite%k = scene%k
         call assemble_finite(scene%solids, model%mesh, scene%trial%motion%u, &
            & scene%finite%past, internal, &
            & scene%finite%energy, bad, scene%finite%k)
      else
         call assemble_finite(scene%solids, model%mesh, scene%trial%motion%u, &
            & scene%finite%past, internal, &
            & scene%finite%energy, bad)
      end if
      inverted = bad%element
      scene%finite%element_force = bad%force
      if (with_tangent .and. scene%finite%drag%on .and. inverted == 0) scene%finite%k%value = &
         & scene%finite%k%value + scene%finite%drag%rate*scene%finite%drag%metric%value
   end subroutine internal_forces

   !> What resists the motion through pseudo-time.
   subroutine resist(scene, residual)
      type(scene_type), intent(in) :: scene
      real(wp), intent(inout) :: residual(:)   !! (ndof) [force]
      real(wp) :: resistance(size(residual))

      call scene%finite%drag%metric%multiply(scene%trial%motion%u - scene%finite%drag%from, &
         & resistance)
      residual = residual + scene%finite%drag%rate*resistance
   end subroutine resist
end module lopin_finite_forces
