!> What rounding leaves of forces: positions are known to a few units in their last place, and a
!> force is a stiffness times a difference of positions.
!>
!> What lies below is nothing, however small the other forces are: a body that is let go of, a
!> contact that just closes. The floor has no units of its own and grows with the distance from the
!> origin, as rounding does.
module lopin_rounding_floor
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_constraints, only : reduce_bounds
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: noise_of_places, floor_of_forces, floor_of_rows, beyond

   !> Roundings of a position between its node and a force.
   real(wp), parameter :: roundings = 8.0_wp

contains

   !> How far places are known [length].
   pure real(wp) function noise_of_places(scene) result(noise)
      type(scene_type), intent(in) :: scene

      if (scene%dofs%rotate) then
         noise = largest(pack(scene%trial%motion%u, scene%dofs%dof <= 3))
      else
         noise = largest(scene%trial%motion%u)
      end if
      noise = roundings*epsilon(1.0_wp)*(scene%farthest + noise)
   end function noise_of_places

   !> What that makes of the force of every free equation, by the stiffness there [force].
   subroutine floor_of_forces(scene, floor)
      type(scene_type), intent(in) :: scene
      real(wp), intent(out) :: floor(:)        !! (neq)
      real(wp) :: stiffness(scene%dofs%n), contact

      contact = 0.0_wp
      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            if (c%n > 0) contact = maxval(c%c(:c%n)*c%weight(:c%n))
         end associate
      else if (allocated(scene%problem%alpha)) then
         contact = largest(scene%problem%alpha)
      end if
      stiffness = scene%stiffness + contact
      if (scene%dofs%rotate) then
         where (scene%dofs%dof > 3) stiffness = stiffness*scene%bodies%length
      end if
      call reduce_bounds(scene%constraints, stiffness, floor)
      floor = floor*noise_of_places(scene)
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
      integer :: i

      beyond = largest(x)
      if (beyond /= beyond) return
      beyond = 0.0_wp
      do i = 1, size(x)
         if (abs(x(i)) > floor(i)) beyond = max(beyond, abs(x(i)) - floor(i))
      end do
   end function beyond
end module lopin_rounding_floor
