!> Where a run goes on from: a step that is under way, on a mesh that stands in the present shape.
!>
!> A part of a run whose mesh was made anew begins in the middle of a step. Its mesh has no
!> displacements yet; what was not meshed anew (tools) has, and keeps its place of the start in the
!> deck. Loads and prescribed values go on from where the step had begun.
module lopin_start
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   use lopin_damage_criteria, only : damage_names
   implicit none
   private
   public :: start_type, displaced_type, kept_memory_type, unreleased, unseated

   !> A degree of freedom that has moved already.
   type :: displaced_type
      integer :: node = 0, dof = 0
      real(wp) :: now = 0.0_wp                 !! displacement [length], rotation [rad]
      real(wp) :: begun = 0.0_wp               !! the same where the step began
      real(wp) :: force = 0.0_wp               !! load without amplitude there [force]
   end type displaced_type

   !> *INITIAL CONDITIONS, TYPE=MEMORY: what one point of a mesh that stays remembers.
   type :: kept_memory_type
      type(location_type) :: at
      integer :: element = 0
      integer :: point = 0                     !! from 1
      real(wp) :: pressed = 0.0_wp             !! ln J of stresses of the start [-]
      real(wp) :: scale = 1.0_wp   !! volume that the law counts by over that of the mesh [-]
      real(wp) :: damage(size(damage_names)) = 0.0_wp   !! by criterion [-]
      real(wp), allocatable :: value(:)        !! as lopin_material_memory has it
   end type kept_memory_type

   !> *START.
   type :: start_type
      type(location_type) :: at
      integer :: step = 0                      !! 0: the run begins with its first step
      real(wp) :: begun = 0.0_wp               !! total time where the step began [time]
      real(wp) :: time = 0.0_wp                !! of the step, reached [time]
      real(wp) :: rest = 0.0_wp                !! length of the first increment [time]
      real(wp) :: increment = 0.0_wp           !! of the second [time]
      real(wp) :: release = 0.0_wp             !! over which forces out of balance fade [time]
      real(wp) :: seating = 0.0_wp             !! over which what is inside tools is pressed out
                                               !! [time]
      type(displaced_type), allocatable :: displaced(:)
      type(kept_memory_type), allocatable :: kept(:)   !! of meshes that stay
   end type start_type

contains

   !> Share of the forces out of balance at the start that still acts at a time of the step.
   elemental real(wp) function unreleased(self, time, period)
      type(start_type), intent(in) :: self
      real(wp), intent(in) :: time             !! of the step [time]
      real(wp), intent(in) :: period           !! of the step [time]

      unreleased = share_left(self, self%release, time, period)
   end function unreleased

   !> Share of what slave nodes were inside tools at the start that they may still be inside.
   elemental real(wp) function unseated(self, time, period)
      type(start_type), intent(in) :: self
      real(wp), intent(in) :: time             !! of the step [time]
      real(wp), intent(in) :: period           !! of the step [time]

      unseated = share_left(self, self%seating, time, period)
   end function unseated

   !> What fades evenly from the end of the increment at rest on.
   elemental real(wp) function share_left(self, lasts, time, period)
      type(start_type), intent(in) :: self
      real(wp), intent(in) :: lasts            !! 0: it is gone in the increment at rest [time]
      real(wp), intent(in) :: time             !! of the step [time]
      real(wp), intent(in) :: period           !! of the step [time]
      real(wp) :: from, until

      from = self%time + self%rest
      until = min(lasts, period - from)
      share_left = 0.0_wp
      if (until > 0.0_wp) share_left = max(0.0_wp, min(1.0_wp, 1.0_wp - (time - from)/until))
   end function share_left
end module lopin_start
