!> What rounding leaves of forces: positions are known to a few units in their last place, and a
!> force is a stiffness times a difference of positions.
!>
!> What lies below is nothing, however small the other forces are: a body that is let go of, a
!> contact that just closes. The floor has no units of its own and grows with the distance from the
!> origin, as rounding does.
module lopin_rounding_floor
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_model, only : model_type
   use lopin_constraints, only : reduce_bounds
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: noise_of_places, floor_of_forces, floor_of_rows, beyond

   !> Roundings of a position between its node and a force.
   real(wp), parameter :: roundings = 8.0_wp

contains

   !> How far places are known [length].
   pure real(wp) function noise_of_places(scene, model) result(noise)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      noise = roundings*epsilon(1.0_wp)*(max(maxval(model%mesh%x), -minval(model%mesh%x)) &
         & + largest(pack(scene%trial%motion%u, scene%dofs%dof <= 3)))
   end function noise_of_places

   !> What that makes of the force of every free equation, by the stiffness there [force].
   subroutine floor_of_forces(scene, model, floor)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: floor(:)        !! (neq)
      real(wp) :: stiffness(scene%dofs%n)

      call scene%k%diagonal(stiffness)
      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            if (c%n > 0) stiffness = stiffness + maxval(c%c(:c%n)*c%weight(:c%n))
         end associate
      else if (allocated(scene%problem%alpha)) then
         stiffness = stiffness + largest(scene%problem%alpha)
      end if
      where (scene%dofs%dof > 3) stiffness = stiffness*scene%bodies%length
      call reduce_bounds(scene%constraints, stiffness, floor)
      floor = floor*noise_of_places(scene, model)
   end subroutine floor_of_forces

   !> The same of the rows of multipliers, as forces.
   function floor_of_rows(scene, noise) result(floor)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: noise            !! of places [length]
      real(wp) :: floor(scene%newton%contact%nmultiplier)

      associate (c => scene%newton%contact)
         floor = noise*c%c(c%point_of_row)*c%weight(c%point_of_row)
      end associate
   end function floor_of_rows

   !> Largest size of an entry beyond its floor; NaN if an entry is.
   pure real(wp) function beyond(x, floor)
      real(wp), intent(in) :: x(:), floor(:)

      beyond = largest(sign(1.0_wp, x)*max(abs(x) - floor, 0.0_wp))
      if (largest(x) /= largest(x)) beyond = largest(x)
   end function beyond
end module lopin_rounding_floor
