!> Where a run goes on from: a step that is under way, on a mesh that stands in the present shape.
!>
!> A part of a run whose mesh was made anew begins in the middle of a step. Its mesh has no
!> displacements yet; what was not meshed anew (tools) has, and keeps its place of the start in the
!> deck. Loads and prescribed values go on from where the step had begun.
module lopin_start
   use lopin_kinds, only : wp
   use lopin_error, only : location_type
   implicit none
   private
   public :: start_type, displaced_type

   !> A degree of freedom that has moved already.
   type :: displaced_type
      integer :: node = 0, dof = 0
      real(wp) :: now = 0.0_wp                 !! displacement [length], rotation [rad]
      real(wp) :: begun = 0.0_wp               !! the same where the step began
      real(wp) :: force = 0.0_wp               !! load without amplitude there [force]
   end type displaced_type

   !> *START.
   type :: start_type
      type(location_type) :: at
      integer :: step = 0                      !! 0: the run begins with its first step
      real(wp) :: begun = 0.0_wp               !! total time where the step began [time]
      real(wp) :: time = 0.0_wp                !! of the step, reached [time]
      real(wp) :: rest = 0.0_wp                !! length of the first increment [time]
      real(wp) :: increment = 0.0_wp           !! of the second [time]
      type(displaced_type), allocatable :: displaced(:)
   end type start_type
end module lopin_start
