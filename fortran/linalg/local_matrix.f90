!> A small dense tangent with the dofs that it couples: a contact point, a face under pressure.
module lopin_local_matrix
   use lopin_kinds, only : wp
   implicit none
   private
   public :: local_matrix_type

   !> The exact tangent of one contact point, or of a group of forces that follow their faces.
   type :: local_matrix_type
      integer, allocatable :: dof(:)           !! physical dofs, then ndof + multiplier row, then
                                               !! physical dofs that only bounds of shear read
      real(wp), allocatable :: k(:, :)         !! d(-force, row)/d(u, multiplier)
      integer :: nu = 0                        !! entries that are displacements
      real(wp), allocatable :: spring(:, :)    !! (nu, nu) positive semidefinite part, for a factor
      real(wp), allocatable :: reach(:, :)     !! (ndim, nu) of a point whose traction is unknown:
                                               !! how far it goes
      real(wp), allocatable :: stiff(:, :)     !! (ndim, ndim) with it: of its spring [force/length]
      real(wp), allocatable :: firm(:, :)      !! (ndim, ndim) with it: of springs instead of the
                                               !! unknown traction [force/length]
      real(wp), allocatable :: flat_row(:, :)  !! (ndim, nu) multiplier rows, normals standing still
      ! a bound of shear that follows the stress of the solids couples all dofs that this reads
      real(wp), allocatable :: by_bound(:)     !! slopes of -force and row in the logarithm of the
                                               !! bound; not allocated: it follows none
      integer :: point = 0                     !! contact point whose bound that is
      integer, allocatable :: read_dof(:)      !! physical dofs, one may stand more than once
      real(wp), allocatable :: read_slope(:)   !! of the logarithm of the bound in these [1/length]
   end type local_matrix_type
end module lopin_local_matrix
