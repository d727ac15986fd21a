!> What one element is computed from: its material, its place and displacements, what its points
!> remember. Kernels of all kinematics take it, so that an assembly fills it once.
module lopin_element_input
   use lopin_kinds, only : wp
   use lopin_hyperelastic, only : solid_law_type
   implicit none
   private
   public :: element_input_type, counted_volume

   !> The arrays belong to the caller, which keeps them while the element is computed.
   type :: element_input_type
      type(solid_law_type), pointer :: law => null()
      real(wp), pointer, contiguous :: x(:, :) => null()   !! (ndim, nnode) coordinates [length]
      real(wp), pointer, contiguous :: u(:, :) => null()   !! (ndim, nnode) displacements [length]
      real(wp), pointer, contiguous :: memory(:, :) => null()   !! (nmemory, ngauss) of the accepted
                                             !! state; (0, ngauss) if the law remembers nothing
      real(wp) :: thickness = 1.0_wp         !! plane kinds [length]
      real(wp) :: dt = 1.0_wp                !! since the accepted state [time]
      logical :: scaled = .false.            !! the last row of memory is the volume that the law
                                             !! counts by over that of x [-]
   end type element_input_type

contains

   !> J - 1 that the law counts by: that of the displacements, and what a state of the start had.
   pure real(wp) function counted_volume(input, k, own)
      type(element_input_type), intent(in) :: input
      integer, intent(in) :: k                 !! integration point
      real(wp), intent(in) :: own              !! J - 1 of the displacements [-]

      counted_volume = own
      if (.not. input%scaled) return
      associate (scale => input%memory(size(input%memory, 1), k))
         counted_volume = (own + (1.0_wp - scale))/scale
      end associate
   end function counted_volume
end module lopin_element_input
