!> What the finite path keeps: the contacts with their history, tractions, the tangent's system.
module lopin_finite_state
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_finite_contact, only : finite_contact_type
   use lopin_finite_system, only : finite_system_type
   implicit none
   private
   public :: finite_state_type

   type :: finite_state_type
      logical :: in_use = .false.
      logical :: nlgeom = .false.              !! of the present step
      type(finite_contact_type) :: contact
      type(finite_system_type) :: system
      type(csc_type) :: k                      !! (ndof) tangent of the solids; small strain: unused
      real(wp), allocatable :: multiplier(:)   !! (nmultiplier) tractions, global axes [stress]
      real(wp), allocatable :: accepted_multiplier(:)
      real(wp), allocatable :: internal(:)     !! (ndof) forces of the solids [force]
      real(wp) :: energy = 0.0_wp              !! strain energy of the solids [force*length]
      real(wp) :: dt = 1.0_wp                  !! time increment [time]
      integer :: most_augmentations = 0
      real(wp) :: augment_until = 0.0_wp       !! relative change of the tractions
      ! of the last increment
      integer :: iterations = 0, augmentations = 0
      integer :: grounded = 0                  !! iterations on soft springs to the ground
      real(wp), allocatable :: history(:)      !! residual by iteration, beside the largest force
   end type finite_state_type
end module lopin_finite_state
