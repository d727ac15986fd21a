!> What one element is computed from: its material, its place and displacements, what its points
!> remember. Kernels of all kinematics take it, so that an assembly fills it once.
module lopin_element_input
   use lopin_kinds, only : wp
   use lopin_hyperelastic, only : solid_law_type
   implicit none
   private
   public :: element_input_type

   !> The arrays belong to the caller, which keeps them while the element is computed.
   type :: element_input_type
      type(solid_law_type), pointer :: law => null()
      real(wp), pointer, contiguous :: x(:, :) => null()   !! (ndim, nnode) coordinates [length]
      real(wp), pointer, contiguous :: u(:, :) => null()   !! (ndim, nnode) displacements [length]
      real(wp), pointer, contiguous :: memory(:, :) => null()   !! (nmemory, ngauss) of the accepted
                                             !! state; (0, ngauss) if the law remembers nothing
      real(wp) :: thickness = 1.0_wp         !! plane kinds [length]
      real(wp) :: dt = 1.0_wp                !! since the accepted state [time]
   end type element_input_type
end module lopin_element_input
