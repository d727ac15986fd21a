!> The answer of a contact problem, and how its solution ended.
module lopin_contact_result
   use lopin_kinds, only : wp
   use lopin_condensed, only : springs_type, response_type
   implicit none
   private
   public :: contact_result_type, work_type, outcome

   type :: outcomes
      integer :: solved = 0, not_held = 1, cycling = 2, not_augmented = 3, broken = 4
   end type outcomes
   type(outcomes), parameter :: outcome = outcomes()

   !> The answer; `active` and `multiplier` may hold the last answer as a start.
   type :: contact_result_type
      integer :: outcome = 0
      integer :: iterations = 0, augmentations = 0, single_pivots = 0, dependent = 0
      real(wp), allocatable :: force(:), gap(:)   !! (nrow)
      real(wp), allocatable :: q(:)               !! (nq); if not held: the motion that escapes
      real(wp), allocatable :: u(:)   !! displacements, where the system solves for all of them
      logical, allocatable :: active(:)           !! (nrow)
      real(wp), allocatable :: multiplier(:)      !! (nrow)
      real(wp) :: rate = 0.0_wp                   !! last contraction of the augmentations
      real(wp) :: opening = 0.0_wp                !! largest change of a gap by the forces alone
      real(wp) :: soft_error = 0.0_wp   !! relative force error of rows that allow penetration,
                                        !! estimated
      real(wp) :: softness = 0.0_wp     !! the same of the pressures alone, by pairs
   end type contact_result_type

   !> What one call carries around.
   type :: work_type
      logical, allocatable :: spring(:)
      real(wp), allocatable :: compliance(:)
      real(wp) :: gap_scale = 0.0_wp
      type(springs_type) :: springs
      type(response_type) :: answer
   end type work_type
end module lopin_contact_result
