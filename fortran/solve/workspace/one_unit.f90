!> Forces beside moments, and displacements beside rotations, in one unit: moments over the length
!> of the scene, rotations times it. Else what is largest, or converged, hangs on the unit of
!> length.
module lopin_one_unit
   use lopin_kinds, only : wp
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: as_forces, as_lengths

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
      if (.not. has_rotations(scene)) return
      where (scene%dofs%dof(dof) > last_displacement) force = force/scene%bodies%length
   end function as_forces

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
      has_rotations = .false.
      if (size(scene%dofs%dof) > 0) has_rotations = maxval(scene%dofs%dof) > last_displacement &
         & .and. scene%bodies%length > 0.0_wp
   end function has_rotations
end module lopin_one_unit
