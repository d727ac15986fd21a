!> Deck words to rigid tools: the data lines of *SURFACE, TYPE=SEGMENTS, CYLINDER and REVOLUTION.
module lopin_tool_factory
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, location_type
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_vectors, only : cross
   use lopin_tool, only : tool_type
   use lopin_profile, only : profile_type, segment_card_type, new_profile
   use lopin_tool_plane, only : plane_type, new_plane
   use lopin_tool_sphere, only : sphere_type, new_sphere
   use lopin_tool_cylinder, only : cylinder_type, new_cylinder
   use lopin_tool_profile, only : profile_tool_type, extruded_type, revolved_type
   use lopin_facet_mesh, only : facet_mesh_type, facet_flaws_type, new_facet_mesh
   use lopin_tool_facets, only : facets_tool_type, new_facets_tool
   use lopin_tool_curved, only : curved_tool_type, new_curved_tool
   implicit none
   private
   public :: new_tool_from_segments, new_tool_plane, new_tool_sphere, new_tool_cylinder, &
      & new_tool_from_facets, tool_kinds

   !> Words after TYPE= that make a rigid tool.
   character(len=*), parameter :: tool_kinds(3) = [character(len=10) :: 'SEGMENTS', 'CYLINDER', &
      & 'REVOLUTION']

   !> 1: point c of TYPE=CYLINDER lies on the positive local z; the local y is then z cross x.
   real(wp), parameter :: generator_side = 1.0_wp

contains

   !> A tool from a profile.
   !>
   !> `frame` holds the points of the data lines before START, one a column: none for SEGMENTS;
   !> a, b, c for CYLINDER (default: the global frame); a, b for REVOLUTION (default: the y axis),
   !> and c, d where the profile runs around a rectangle: the middles of two of its sides.
   subroutine new_tool_from_segments(tool, kind, frame, cards, fillet, at, error)
      class(tool_type), allocatable, intent(out) :: tool
      character(len=*), intent(in) :: kind               !! one of `tool_kinds`
      real(wp), intent(in) :: frame(:, :)               !! (3, 0), (3, 2), (3, 3) or (3, 4) [length]
      type(segment_card_type), intent(in) :: cards(:)    !! START first
      real(wp), intent(in) :: fillet                     !! radius, 0: none [length]
      type(location_type), intent(in) :: at              !! of the keyword
      type(error_type), allocatable, intent(out) :: error
      type(profile_type) :: profile

      call new_profile(profile, cards, fillet, error)
      if (allocated(error)) return
      select case (kind)
      case ('SEGMENTS')
         allocate (profile_tool_type :: tool)
         tool%ndim = 2
         tool%name = 'profile'
      case ('CYLINDER')
         allocate (extruded_type :: tool)
         tool%name = 'extruded profile'
      case ('REVOLUTION')
         allocate (revolved_type :: tool)
         tool%name = 'revolved profile'
      case default
         call raise(error, error_code%deck, 'E0314', "TYPE="//kind//' does not make a rigid tool', &
            & at, &
            & help='types are SEGMENTS, CYLINDER and REVOLUTION')
         return
      end select
      tool%size = profile%size
      select type (tool)
      type is (extruded_type)
         tool%profile = profile
         call set_extrusion(tool, frame, at, error)
      type is (revolved_type)
         tool%profile = profile
         call set_revolution(tool, frame, at, error)
      type is (profile_tool_type)
         tool%profile = profile
      end select
   end subroutine new_tool_from_segments

   subroutine set_extrusion(tool, frame, at, error)
      type(extruded_type), intent(inout) :: tool
      real(wp), intent(in) :: frame(:, :)
      type(location_type), intent(in) :: at
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: x(3), y(3), z(3)

      x = [1.0_wp, 0.0_wp, 0.0_wp]
      z = [0.0_wp, 0.0_wp, 1.0_wp]
      if (size(frame, 2) >= 3) then
         tool%origin = frame(:, 1)
         x = frame(:, 2) - frame(:, 1)
         z = generator_side*(frame(:, 3) - frame(:, 1))
      end if
      y = [z(2)*x(3) - z(3)*x(2), z(3)*x(1) - z(1)*x(3), z(1)*x(2) - z(2)*x(1)]
      if (.not. norm2(y) > 1.0e-9_wp*norm2(x)*norm2(z)) then
         call raise(error, error_code%deck, 'E0314', &
            & 'points a, b and c of TYPE=CYLINDER lie on one line', at)
         return
      end if
      ! A generator that is not quite across x keeps its direction; x gives way.
      tool%frame(:, 3) = z/norm2(z)
      tool%frame(:, 2) = y/norm2(y)
      y = tool%frame(:, 2)
      z = tool%frame(:, 3)
      tool%frame(:, 1) = [y(2)*z(3) - y(3)*z(2), y(3)*z(1) - y(1)*z(3), y(1)*z(2) - y(2)*z(1)]
   end subroutine set_extrusion

   subroutine set_revolution(tool, frame, at, error)
      type(revolved_type), intent(inout) :: tool
      real(wp), intent(in) :: frame(:, :)
      type(location_type), intent(in) :: at
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      real(wp) :: least

      tool%axis = [0.0_wp, 1.0_wp, 0.0_wp]
      if (size(frame, 2) >= 2) then
         tool%origin = frame(:, 1)
         tool%axis = frame(:, 2) - frame(:, 1)
      end if
      if (.not. norm2(tool%axis) > 0.0_wp) then
         call raise(error, error_code%deck, 'E0314', &
            & 'points a and b of TYPE=REVOLUTION are the same', at)
         return
      end if
      tool%axis = tool%axis/norm2(tool%axis)
      if (size(frame, 2) >= 4) then
         do i = 1, 2
            tool%side(:, i) = frame(:, i + 2) - tool%origin
            tool%half(i) = norm2(tool%side(:, i))
            tool%side(:, i) = tool%side(:, i)/max(tool%half(i), tiny(1.0_wp))
         end do
         if (max(maxval(abs(matmul(tool%axis, tool%side))), abs(dot_product(tool%side(:, 1), &
            & tool%side(:, 2)))) > 1.0e-6_wp .or. .not. minval(tool%half) > 0.0_wp) then
            call raise(error, error_code%deck, 'E0314', 'the sides of the rectangle of '// &
               & 'TYPE=REVOLUTION are not at right angles with its axis and each other', at, &
               & help='after the axis: a line with the middles of two of its sides')
            return
         end if
         tool%side(:, 2) = cross(tool%axis, tool%side(:, 1))
      end if
      least = huge(1.0_wp)
      do i = 1, size(tool%profile%segment)
         least = min(least, tool%profile%segment(i)%a(1), tool%profile%segment(i)%b(1))
      end do
      if (least < -1.0e-9_wp*tool%size) then
         call raise(error, error_code%deck, 'E0314', &
            & 'a profile of revolution has a negative radius', at)
      end if
   end subroutine set_revolution

   !> A tool from triangles, if they make one surface with two sides.
   subroutine new_tool_from_facets(tool, corner, may_be_open, may_turn, flaws, error, curved)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: corner(:, :, :)   !! (3, 3, n): coordinate, corner, facet [length]
      logical, intent(in) :: may_be_open        !! a sheet, not a body: edges of one facet
      logical, intent(in) :: may_turn           !! facets that look the wrong way are turned
      type(facet_flaws_type), intent(out) :: flaws
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in), optional :: curved   !! by the normals of corners
      type(facet_mesh_type) :: mesh
      type(facets_tool_type), allocatable :: facets
      type(curved_tool_type), allocatable :: bent

      call new_facet_mesh(mesh, corner, flaws)
      if (mesh%nfacet == 0) then
         call raise(error, error_code%deck, 'E0332', 'the tool has no facet with an area')
      else if (flaws%crowded > 0) then
         call raise(error, error_code%deck, 'E0332', plural(flaws%crowded, 'edge')// &
            & ' shared by three or more facets, one at '//place_text(flaws%crowded_at), &
            & help='a tool is the surface of one body: unite overlapping bodies before the export')
      else if (flaws%hole > 0 .and. .not. may_be_open) then
         call raise(error, error_code%deck, 'E0332', 'the surface has a hole: '// &
            & plural(flaws%hole, 'edge')//' of one facet only, one at '// &
            & place_text(flaws%hole_at), help='close it where it was made; if it is a sheet, '// &
            & 'such as the face of a die, say so by OPEN')
      else if (flaws%loop > 0) then
         call raise(error, error_code%deck, 'E0332', 'the surface has one side only, as a '// &
            & 'Moebius strip: no facet knows where outside is')
      else if (flaws%against > 0 .and. .not. may_turn) then
         call raise(error, error_code%deck, 'E0332', plural(flaws%against, 'facet')// &
            & ' looking against the others, one at '//place_text(flaws%against_at), &
            & help='export it again, or have the lesser area turned by REPAIR')
      else
         if (present(curved)) then
            if (curved) then
               allocate (bent)
               call new_curved_tool(bent, mesh)
               call move_alloc(bent, tool)
               return
            end if
         end if
         allocate (facets)
         call new_facets_tool(facets, mesh)
         call move_alloc(facets, tool)
      end if
   end subroutine new_tool_from_facets

   function place_text(x) result(text)
      real(wp), intent(in) :: x(3)   !! [length]
      character(len=:), allocatable :: text
      text = '('//to_text(x(1))//', '//to_text(x(2))//', '//to_text(x(3))//')'
   end function place_text

   !> A half-space.
   subroutine new_tool_plane(tool, origin, normal, error)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: origin(:), normal(:)   !! (ndim) [length], any
      type(error_type), allocatable, intent(out) :: error
      type(plane_type), allocatable :: plane

      allocate (plane)
      call new_plane(plane, origin, normal, error)
      call move_alloc(plane, tool)
   end subroutine new_tool_plane

   !> A sphere or circle, or the cavity of one.
   subroutine new_tool_sphere(tool, centre, radius, cavity, error)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: centre(:)              !! (ndim): 2 makes a circle [length]
      real(wp), intent(in) :: radius                 !! > 0 [length]
      logical, intent(in) :: cavity                  !! the body is inside
      type(error_type), allocatable, intent(out) :: error
      type(sphere_type), allocatable :: sphere

      allocate (sphere)
      call new_sphere(sphere, centre, radius, error, cavity)
      call move_alloc(sphere, tool)
   end subroutine new_tool_sphere

   !> A cylinder, or the bore of one.
   subroutine new_tool_cylinder(tool, origin, axis, radius, length, bore, error)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: origin(3), axis(3)     !! a point, a direction [length], any
      real(wp), intent(in) :: radius                 !! > 0 [length]
      real(wp), intent(in) :: length                 !! 0: infinite [length]
      logical, intent(in) :: bore                    !! the body is inside
      type(error_type), allocatable, intent(out) :: error
      type(cylinder_type), allocatable :: cylinder

      allocate (cylinder)
      call new_cylinder(cylinder, origin, axis, radius, error, length, bore)
      call move_alloc(cylinder, tool)
   end subroutine new_tool_cylinder
end module lopin_tool_factory
