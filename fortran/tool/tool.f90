!> The contract of a rigid tool: closest point of its surface, normal, and signed gap.
!>
!> The geometry stands in the tool frame, which is the global frame at time 0. The normal points
!> out of the tool, towards the body that may touch it; the gap g = n.(x - foot) is positive when
!> open.
module lopin_tool
   use lopin_kinds, only : wp
   use lopin_rigid_motion, only : rigid_motion_type
   implicit none
   private
   public :: one_plane
   public :: tool_type, foot_type, coincidence, project_moved, project_all_moved, move_foot
   public :: outer_product

   !> Lengths below `coincidence` times the size of the tool are rounding, not geometry.
   real(wp), parameter :: coincidence = 1.0e-9_wp

   !> Parts of a tool whose normals have a larger cosine are one plane: 1e-5 rad.
   real(wp), parameter :: one_plane = 1.0_wp - 0.5e-10_wp

   !> The closest point of a surface and what a contact kernel needs of it.
   type :: foot_type
      logical :: found = .false.            !! false only when the surface has no point to offer
      real(wp) :: point(3) = 0.0_wp         !! closest point of the surface [length]
      real(wp) :: normal(3) = 0.0_wp        !! unit outward normal = gradient of the gap
      logical :: leans = .false.            !! but for facets whose normals run between corners:
      real(wp) :: gradient(3) = 0.0_wp      !! of the gap there; the normal is about that
      real(wp) :: gap = 0.0_wp              !! >= 0 open, < 0 penetrating [length]
      real(wp) :: hessian(3, 3) = 0.0_wp    !! d normal/d x: of component i by x(j) [1/length]
      real(wp) :: overhang = 0.0_wp         !! > 0: x lies that far beyond an open end [length]
      integer :: segment = 0                !! segment of a profile, else 1
      logical :: corner = .false.           !! the foot is a sharp corner
      real(wp) :: cone = 1.0_wp   !! < 1: on a corner, every normal within this cosine serves
   end type foot_type

   type, abstract :: tool_type
      integer :: ndim = 3
      character(len=:), allocatable :: name
      real(wp) :: size = 1.0_wp !! a length of the geometry; scale of its tolerances [length]
      logical :: curved = .false.         !! facets are curved by the normals of their corners
      real(wp), allocatable :: chord(:)   !! of facets: how far off the surface they mean [length]
   contains
      procedure(project_if), deferred :: project
      procedure(tessellate_if), deferred :: tessellate
      procedure(describe_if), deferred :: describe
      procedure :: project_all
      procedure :: has_creases
      procedure :: is_creased
      procedure :: apart
   end type tool_type

   abstract interface
      !> Closest point among all parts of the surface, by distance, never by the least signed gap.
      !>
      !> A sharp convex corner owns the wedge of points nearest to it: the normal is the direction
      !> from the corner. Beyond an open end (`overhang` > 0) the foot is the end, and gap and
      !> normal continue the tangent there: the caller decides how far to believe them.
      pure subroutine project_if(self, x, foot)
         import :: tool_type, foot_type, wp
         class(tool_type), intent(in) :: self
         real(wp), intent(in) :: x(:)           !! (ndim) point in the tool frame [length]
         type(foot_type), intent(out) :: foot
      end subroutine project_if

      !> Lines (2D), triangles and quads (3D) of the part of the surface near a box, for drawing.
      pure subroutine tessellate_if(self, box, points, cells)
         import :: tool_type, wp
         class(tool_type), intent(in) :: self
         real(wp), intent(in) :: box(:, &
            & :)                  !! (ndim, 2) least and greatest corner [length]
         real(wp), allocatable, intent(out) :: points(:, &
            & :) !! (ndim, npoint) in the tool frame [length]
         integer, allocatable, intent(out) :: cells(:, :)   !! (2 or 4, ncell); triangle: last is 0
      end subroutine tessellate_if

      !> One phrase for the echo of the model, such as "sphere, radius 10".
      function describe_if(self) result(text)
         import :: tool_type
         class(tool_type), intent(in) :: self
         character(len=:), allocatable :: text
      end function describe_if
   end interface

contains

   !> Every constraint that the tool puts on a point: two near a concave corner, else one.
   pure subroutine project_all(self, x, reach, feet, nfeet)
      class(tool_type), intent(in) :: self
      real(wp), intent(in) :: x(:)              !! (ndim) point in the tool frame [length]
      real(wp), intent(in) :: reach             !! a concave corner nearer than this counts [length]
      type(foot_type), intent(out) :: feet(2)   !! the least gap first
      integer, intent(out) :: nfeet             !! 0, 1 or 2

      nfeet = 0
      if (reach < 0.0_wp) return
      call self%project(x, feet(1))
      if (feet(1)%found) nfeet = 1
   end subroutine project_all

   !> Somewhere the direction of the surface jumps.
   pure logical function has_creases(self)
      class(tool_type), intent(in) :: self
      has_creases = self%size < 0.0_wp
   end function has_creases

   !> The direction of the surface jumps between two of its segments.
   pure logical function is_creased(self, a, b)
      class(tool_type), intent(in) :: self
      integer, intent(in) :: a, b              !! segments of feet
      is_creased = self%size < 0.0_wp .and. a /= b
   end function is_creased

   !> How far segments of two feet are from being of one wall: what tells the two points of a node
   !> in a concave corner apart.
   pure integer function apart(self, a, b)
      class(tool_type), intent(in) :: self
      integer, intent(in) :: a, b              !! segments of feet
      apart = 0
      if (self%ndim > 0) apart = abs(a - b)
   end function apart

   !> Project a point of the present on a tool that has moved; the foot is in the present too.
   pure subroutine project_moved(tool, motion, x, foot)
      class(tool_type), intent(in) :: tool
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)              !! (ndim) [length]
      type(foot_type), intent(out) :: foot

      call tool%project(motion%to_tool(x), foot)
      call move_foot(motion, tool%ndim, foot)
   end subroutine project_moved

   !> As `project_all`, on a tool that has moved.
   pure subroutine project_all_moved(tool, motion, x, reach, feet, nfeet)
      class(tool_type), intent(in) :: tool
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)              !! (ndim) [length]
      real(wp), intent(in) :: reach             !! as in `project_all` [length]
      type(foot_type), intent(out) :: feet(2)
      integer, intent(out) :: nfeet
      integer :: i

      call tool%project_all(motion%to_tool(x), reach, feet, nfeet)
      do i = 1, nfeet
         call move_foot(motion, tool%ndim, feet(i))
      end do
   end subroutine project_all_moved

   !> A foot of the tool's frame where the tool stands now.
   pure subroutine move_foot(motion, ndim, foot)
      type(rigid_motion_type), intent(in) :: motion
      integer, intent(in) :: ndim
      type(foot_type), intent(inout) :: foot

      foot%point(:ndim) = motion%to_global(foot%point(:ndim))
      foot%normal(:ndim) = motion%turn(foot%normal(:ndim))
      foot%gradient(:ndim) = motion%turn(foot%gradient(:ndim))
      foot%hessian(:ndim, :ndim) = matmul(motion%rotation(:ndim, :ndim), &
         & matmul(foot%hessian(:ndim, :ndim), transpose(motion%rotation(:ndim, :ndim))))
   end subroutine move_foot

   !> a b^T.
   pure function outer_product(a, b) result(c)
      real(wp), intent(in) :: a(:), b(:)
      real(wp) :: c(size(a), size(b))
      integer :: j

      do j = 1, size(b)
         c(:, j) = a*b(j)
      end do
   end function outer_product
end module lopin_tool
