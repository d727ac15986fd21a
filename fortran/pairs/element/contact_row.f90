!> A row of contact: what decides its traction, what it measures and what it answers.
module lopin_contact_row
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type
   use lopin_friction, only : friction_type, condition_type
   use lopin_enforcement, only : enforcement_type
   implicit none
   private
   public :: slip_space_type, take_corner
   public :: enforcement_parameters_type, point_law_type, row_type, point_state_type, contact_status

   type :: statuses
      integer :: open = 0, stick = 1, slip = 2
   end type statuses
   type(statuses), parameter :: contact_status = statuses()

   !> What supports, and the other wall of a corner, take from the slip of a point.
   type :: slip_space_type
      logical :: limited = .false.
      real(wp) :: taken(3, 3) = 0.0_wp         !! projector on the directions in which nothing moves
      logical :: supported = .false.           !! supports hold the node where its master rests too
      real(wp) :: support(3, 3) = 0.0_wp       !! projector on those directions
      logical :: follows = .false.   !! the other point of a corner sticks, this one by springs
   end type slip_space_type

   !> The enforcement at one point.
   type :: enforcement_parameters_type
      class(enforcement_type), allocatable :: method   !! that Newton solves
      logical :: tied = .false.                    !! glued, in all directions unless `partly`
      logical :: bilateral = .false.
      real(wp) :: c = 1.0_wp, ct = 1.0_wp          !! [stress/length]
      real(wp) :: slope = 0.0_wp   !! that the method reads: eps [stress/length]; of a law: 1
      real(wp) :: shear_slope = 0.0_wp   !! unknown traction: epst; 0: exact stick [stress/length]
      real(wp) :: elastic_slip = 0.0_wp   !! the same: u0, slip before sliding; 0: none [length]
      real(wp) :: elastic(3) = 0.0_wp              !! of it, committed [length]
      real(wp) :: yield = 0.0_wp                   !! of the slave; 0: unknown [stress]
      real(wp) :: grazing = 0.0_wp   !! trial pressures down to minus this count as closed: a point
                                     !! that just touches holds a body that nothing else holds
      logical :: clings = .false.   !! at the limit of sticking counts as sticking: so a body that
                                    !! only friction holds starts an increment
      real(wp) :: slid(3) = 0.0_wp   !! shear with which it slid where a step of Newton starts, once
                                     !! sets have come back, else 0; it sticks before it slides the
                                     !! other way [stress]
      real(wp) :: committed(3) = 0.0_wp           !! traction at the start of the increment [stress]
      real(wp) :: frozen(3) = 0.0_wp   !! multiplier of a method that updates it [stress]
      real(wp) :: approach(3) = 0.0_wp   !! motion along the master before it touched, no slip
                                         !! [length]
      real(wp) :: creep(3) = 0.0_wp               !! regularised by slip: slip from the stick anchor
      logical :: partly = .false.                  !! tied, but not in all directions
      real(wp) :: held(3, 3) = 0.0_wp              !! projector on those, if partly
      type(slip_space_type) :: space               !! directions in which the point may slip
   end type enforcement_parameters_type

   !> What decides the traction of a point at its place: the law, and the multiplier of this
   !> iteration.
   type :: point_law_type
      type(enforcement_parameters_type), pointer :: enforcement => null()
      type(friction_type), pointer :: friction => null()
      type(condition_type) :: at
      real(wp) :: shift = 0.0_wp               !! added to the gap [length]
      real(wp) :: lambda(3) = 0.0_wp           !! multiplier, if it is an unknown [stress]
      integer :: first_row = 0                 !! of the multiplier; 0: none
      logical :: with_tangent = .true.
      logical :: follows = .false.   !! slopes in the bound of shear are asked for: it follows the
                                     !! stress of the solids
   end type point_law_type

   !> A row in one block of columns.
   type :: row_type
      integer :: ndim = 3
      integer :: from = 0              !! the block has the columns behind this one
      integer :: columns = 0           !! of the matrix that is asked for
      logical :: with_tangent = .true., has_rows = .false.   !! has_rows: the traction is an unknown
      integer :: status = 0            !! contact_status%...
      real(wp) :: shift = 0.0_wp       !! added to the gap [length]
      real(wp) :: weight = 1.0_wp      !! [area]
      ! measured by who makes the row
      type(dual_type) :: gap           !! [length]
      type(dual_type) :: normal(3)
      type(dual_type) :: slip(3)       !! of the increment [length]
      type(dual_type) :: arm(3)        !! of a tie: from where it holds on [length]
      type(dual_type) :: multiplier(3) !! if it is an unknown [stress]
      real(wp) :: held_gap = 0.0_wp    !! of a tie: the gap that it keeps [length]
      ! what follows
      type(dual_type) :: z(3)          !! traction on the slave [stress]
      type(dual_type) :: residual(3)   !! of the multiplier's rows [length]
      real(wp) :: shear(3, 3) = 0.0_wp !! -dz/dslip without the coupling to pressure [stress/length]
      real(wp), allocatable :: along_gap(:), along_slip(:, :)   !! slopes by the dofs
   end type row_type

   !> Results of an evaluation.
   type :: point_state_type
      integer :: status = 0
      real(wp) :: gap = 0.0_wp                 !! of the row [length]
      real(wp) :: opening = 0.0_wp             !! of the node itself [length]
      real(wp) :: beyond = 0.0_wp   !! gap of the nodes that the row pushes beyond that [length]
      real(wp) :: normal(3) = 0.0_wp
      real(wp) :: traction(3) = 0.0_wp         !! on the slave [stress]
      real(wp) :: slip(3) = 0.0_wp             !! of the increment [length]
      real(wp) :: row(3) = 0.0_wp              !! residuals of its multiplier [length]
      real(wp) :: weight = 0.0_wp              !! of a mortar row [area]
      real(wp) :: reaction(6) = 0.0_wp         !! on the reference of a tool of which nothing is
                                               !! solved for [force], [force length]
      real(wp), allocatable :: force(:)        !! on the first nu dofs of the local matrix [force]
   end type point_state_type

   !> Normals that lean so far out of what is taken from a point can be followed there.
   real(wp), parameter :: leans = 1.0e-3_wp

contains

   !> The directions that supports and the other wall take from a point.
   pure subroutine take_corner(self, normal, other)
      type(slip_space_type), intent(inout) :: self
      real(wp), intent(in) :: normal(3), other(3)
      real(wp) :: taken(3, 3), more(3), left(3)

      taken = 0.0_wp
      if (self%supported) taken = self%support
      more = other - matmul(taken, other)
      if (norm2(more) > leans) then
         more = more/norm2(more)
         taken = taken + spread(more, 2, 3)*spread(more, 1, 3)
      end if
      left = normal - matmul(taken, normal)
      if (.not. norm2(left) > leans) return
      self%limited = .true.
      self%taken = taken
   end subroutine take_corner
end module lopin_contact_row
