!> Forces beside moments, and displacements beside rotations, in one unit: moments over the length
!> of the scene, rotations times it. Else what is largest, or converged, hangs on the unit of
!> length.
module lopin_one_unit
   use lopin_kinds, only : wp
   use lopin_vectors, only : largest
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: as_forces, as_lengths, to_forces, largest_force

   !> Directions up to this are displacements.
   integer, parameter :: last_displacement = 3

contains

   !> Forces of these dofs as they are, moments over the length of the scene.
   pure function as_forces(scene, value, dof) result(force)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: value(:)         !! [force], [force*length]
      integer, intent(in) :: dof(:)            !! of each
      real(wp) :: force(size(value))           !! [force]

      force = value
      call to_forces(scene, force, dof)
   end function as_forces

   !> The same in place.
   pure subroutine to_forces(scene, value, dof)
      type(scene_type), intent(in) :: scene
      real(wp), intent(inout) :: value(:)      !! [force], [force*length]; then [force]
      integer, intent(in) :: dof(:)            !! of each

      if (.not. has_rotations(scene)) return
      where (scene%dofs%dof(dof) > last_displacement) value = value/scene%bodies%length
   end subroutine to_forces

   !> Largest of forces on all dofs, moments over the length of the scene [force].
   pure real(wp) function largest_force(scene, value)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: value(:)         !! (ndof) [force], [force*length]

      if (has_rotations(scene)) then
         largest_force = largest(merge(value/scene%bodies%length, value, &
            & scene%dofs%dof > last_displacement))
      else
         largest_force = largest(value)
      end if
   end function largest_force

   !> Displacements of these dofs as they are, rotations times the length of the scene.
   pure function as_lengths(scene, value, dof) result(way)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: value(:)         !! [length], [-]
      integer, intent(in) :: dof(:)            !! of each
      real(wp) :: way(size(value))             !! [length]

      way = value
      if (.not. has_rotations(scene)) return
      where (scene%dofs%dof(dof) > last_displacement) way = way*scene%bodies%length
   end function as_lengths

   pure logical function has_rotations(scene)
      type(scene_type), intent(in) :: scene
      has_rotations = scene%dofs%rotate .and. scene%bodies%length > 0.0_wp
   end function has_rotations
end module lopin_one_unit
