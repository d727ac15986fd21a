!> A small dense tangent with the dofs that it couples: a contact point, a face under pressure.
module lopin_local_matrix
   use lopin_kinds, only : wp
   implicit none
   private
   public :: local_matrix_type, glue_type, turned_force

   !> A tie: with R how far its sides come apart (`reach`), and t the tangents of the facet with
   !> which the arm between them turns (`tangent` by displacements), its tangent is
   !>
   !>    [ w c R^T R + t^T turning t   -w R^T ]
   !>    [            R                 give  ]
   type :: glue_type
      real(wp) :: weight = 0.0_wp              !! w [area]
      real(wp) :: c = 0.0_wp                   !! [stress/length]
      real(wp) :: give(3, 3) = 0.0_wp          !! where supports hold the point [length/stress]
      logical :: turns = .false.               !! the arm is more than rounding
      real(wp) :: turning(6, 6) = 0.0_wp       !! [force/length]
   end type glue_type

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
      ! of ties, which have no k and no spring
      type(glue_type), allocatable :: glue
      real(wp), allocatable :: share(:, :)     !! (ndim, nu) rows without the arm, if it is short
      real(wp), allocatable :: tangent(:, :)   !! (ndim (ndim-1), nu), if the arm turns
      integer :: own(3) = 0                    !! entry of dof that each row gives: of its node
      ! a bound of shear that follows the stress of the solids couples all dofs that this reads
      real(wp), allocatable :: by_bound(:)     !! slopes of -force and row in the logarithm of the
                                               !! bound; not allocated: it follows none
      integer :: point = 0                     !! contact point whose bound that is
      integer, allocatable :: read_dof(:)      !! physical dofs
      real(wp), allocatable :: read_slope(:)   !! of the logarithm of the bound in these [1/length]
   end type local_matrix_type

contains

   !> Forces of an arm that turns.
   pure function turned_force(glue, tangent, u) result(force)
      type(glue_type), intent(in) :: glue
      real(wp), intent(in) :: tangent(:, :), u(:)
      real(wp) :: force(size(u))

      associate (n => size(tangent, 1))
         force = matmul(matmul(glue%turning(:n, :n), matmul(tangent, u)), tangent)
      end associate
   end function turned_force
end module lopin_local_matrix
