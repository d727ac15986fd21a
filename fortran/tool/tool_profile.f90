!> Tools made of a plane profile: the profile itself (2D, axisymmetric), extruded, or revolved (3D).
module lopin_tool_profile
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross, across
   use lopin_tool, only : tool_type, foot_type, one_plane, outer_product
   use lopin_profile, only : profile_type
   use lopin_profile_points, only : draw_profile
   use lopin_profile_projection, only : foot_2d_type, project_profile, project_profile_all
   implicit none
   private
   public :: profile_tool_type, extruded_type, revolved_type

   integer, parameter :: ring = 72   !! quads on a full turn when drawn
   real(wp), parameter :: corner_sign(2, 4) = reshape([1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
      & -1.0_wp, 1.0_wp, -1.0_wp], [2, 4])

   !> The profile in the plane of the model: (x, y), or (r, z) if axisymmetric.
   type, extends(tool_type) :: profile_tool_type
      type(profile_type) :: profile
   contains
      procedure :: project => project_plane
      procedure :: project_all => project_all_plane
      procedure :: tessellate => tessellate_plane
      procedure :: describe
      procedure :: has_creases => has_kinks
      procedure :: is_creased => is_kinked
   end type profile_tool_type

   !> The profile in the local (x, y) plane, infinite along the local z.
   type, extends(profile_tool_type) :: extruded_type
      real(wp) :: origin(3) = 0.0_wp    !! [length]
      real(wp) :: frame(3, 3) = 0.0_wp  !! columns: local x, y, z
   contains
      procedure :: project => project_extruded
      procedure :: project_all => project_all_extruded
      procedure :: tessellate => tessellate_extruded
   end type extruded_type

   !> The profile in the local (r, z) half-plane, turned about the local z, or led around a
   !> rectangle with centre there: r is then the distance from the rectangle, as for the tools of a
   !> square cup.
   type, extends(profile_tool_type) :: revolved_type
      real(wp) :: origin(3) = 0.0_wp    !! a point of the axis [length]
      real(wp) :: axis(3) = 0.0_wp      !! unit
      real(wp) :: side(3, 2) = 0.0_wp   !! unit, along the rectangle; right-handed with the axis
      real(wp) :: half(2) = 0.0_wp      !! of its length and width; 0: none [length]
   contains
      procedure :: project => project_revolved
      procedure :: project_all => project_all_revolved
      procedure :: tessellate => tessellate_revolved
   end type revolved_type

   !> Where a point lies beside a revolved profile.
   type :: meridian_type
      real(wp) :: centre(3) = 0.0_wp   !! of the hoop, at the height of the origin [length]
      real(wp) :: radial(3) = 0.0_wp   !! unit, from there
      real(wp) :: r = 0.0_wp           !! [length]
      real(wp) :: z = 0.0_wp           !! along the axis [length]
      logical :: is_round = .true.     !! the hoop is curved there
   end type meridian_type

contains

   pure logical function has_kinks(self)
      class(profile_tool_type), intent(in) :: self
      integer :: i

      has_kinks = any([(is_kinked(self, i, 1 + mod(i, size(self%profile%segment))), &
         & i=1, size(self%profile%segment) - merge(0, 1, self%profile%closed))])
   end function has_kinks

   !> A kink lies on the shorter way from one segment to another.
   pure logical function is_kinked(self, a, b)
      class(profile_tool_type), intent(in) :: self
      integer, intent(in) :: a, b
      integer :: i, from, steps, n

      n = size(self%profile%segment)
      from = min(a, b)
      steps = abs(a - b)
      if (self%profile%closed .and. 2*steps > n) then
         from = max(a, b)
         steps = n - steps
      end if
      is_kinked = .false.
      do i = from, from + steps - 1
         is_kinked = is_kinked .or. dot_product(self%profile%segment(1 + mod(i - 1, n))%tb, &
            & self%profile%segment(1 + mod(i, n))%ta) < one_plane
      end do
   end function is_kinked

   pure subroutine project_plane(self, x, foot)
      class(profile_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      type(foot_2d_type) :: flat

      call project_profile(self%profile, x, flat)
      call lift_plane(flat, foot)
   end subroutine project_plane

   pure subroutine project_all_plane(self, x, reach, feet, nfeet)
      class(profile_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: reach
      type(foot_type), intent(out) :: feet(2)
      integer, intent(out) :: nfeet
      type(foot_2d_type) :: flat(2)
      integer :: i

      call project_profile_all(self%profile, x, reach, flat, nfeet)
      do i = 1, nfeet
         call lift_plane(flat(i), feet(i))
      end do
   end subroutine project_all_plane

   pure subroutine lift_plane(flat, foot)
      type(foot_2d_type), intent(in) :: flat
      type(foot_type), intent(out) :: foot
      real(wp) :: t(2)

      call copy_scalars(flat, foot)
      t = [-flat%normal(2), flat%normal(1)]
      foot%point(:2) = flat%point
      foot%normal(:2) = flat%normal
      foot%hessian(:2, :2) = flat%bend*outer_product(t, t)
   end subroutine lift_plane

   pure subroutine copy_scalars(flat, foot)
      type(foot_2d_type), intent(in) :: flat
      type(foot_type), intent(inout) :: foot

      foot%found = .true.
      foot%gap = flat%gap
      foot%overhang = flat%overhang
      foot%segment = flat%segment
      foot%corner = flat%corner
      foot%cone = flat%cone
   end subroutine copy_scalars

   pure subroutine project_extruded(self, x, foot)
      class(extruded_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      type(foot_2d_type) :: flat
      real(wp) :: local(3)

      local = to_local(self, x)
      call project_profile(self%profile, local(:2), flat)
      call lift_extruded(self, local(3), flat, foot)
   end subroutine project_extruded

   pure function to_local(self, x) result(local)
      class(extruded_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      real(wp) :: local(3), arm(3)
      integer :: i

      arm = x - self%origin
      do i = 1, 3
         local(i) = dot_product(arm, self%frame(:, i))
      end do
   end function to_local

   pure subroutine project_all_extruded(self, x, reach, feet, nfeet)
      class(extruded_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: reach
      type(foot_type), intent(out) :: feet(2)
      integer, intent(out) :: nfeet
      type(foot_2d_type) :: flat(2)
      real(wp) :: local(3)
      integer :: i

      local = to_local(self, x)
      call project_profile_all(self%profile, local(:2), reach, flat, nfeet)
      do i = 1, nfeet
         call lift_extruded(self, local(3), flat(i), feet(i))
      end do
   end subroutine project_all_extruded

   pure subroutine lift_extruded(self, z, flat, foot)
      class(extruded_type), intent(in) :: self
      real(wp), intent(in) :: z
      type(foot_2d_type), intent(in) :: flat
      type(foot_type), intent(out) :: foot
      real(wp) :: t(3)

      call copy_scalars(flat, foot)
      foot%point = self%origin + matmul(self%frame, [flat%point(1), flat%point(2), z])
      foot%normal = matmul(self%frame(:, :2), flat%normal)
      t = matmul(self%frame(:, :2), [-flat%normal(2), flat%normal(1)])
      foot%hessian = flat%bend*outer_product(t, t)
   end subroutine lift_extruded

   pure subroutine project_revolved(self, x, foot)
      class(revolved_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      type(foot_type), intent(out) :: foot
      type(foot_2d_type) :: flat
      type(meridian_type) :: at

      at = meridian(self, x)
      call project_profile(self%profile, [at%r, at%z], flat)
      call lift_revolved(self, at, flat, foot)
   end subroutine project_revolved

   pure subroutine project_all_revolved(self, x, reach, feet, nfeet)
      class(revolved_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: reach
      type(foot_type), intent(out) :: feet(2)
      integer, intent(out) :: nfeet
      type(foot_2d_type) :: flat(2)
      type(meridian_type) :: at
      integer :: i

      at = meridian(self, x)
      call project_profile_all(self%profile, [at%r, at%z], reach, flat, nfeet)
      do i = 1, nfeet
         call lift_revolved(self, at, flat(i), feet(i))
      end do
   end subroutine project_all_revolved

   !> Cylindrical coordinates of a point about the axis, or about the nearest point of the
   !> rectangle; on it any radial direction will do.
   pure type(meridian_type) function meridian(self, x) result(at)
      class(revolved_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp) :: along(2)

      at%radial = x - self%origin
      at%z = dot_product(at%radial, self%axis)
      at%radial = at%radial - at%z*self%axis
      at%centre = self%origin
      at%is_round = .true.
      if (any(self%half > 0.0_wp)) then
         along = matmul(at%radial, self%side)
         at%is_round = all(abs(along) > self%half)
         along = max(-self%half, min(self%half, along))
         at%centre = at%centre + matmul(self%side, along)
         at%radial = at%radial - matmul(self%side, along)
      end if
      at%r = norm2(at%radial)
      if (at%r > 1.0e-14_wp*self%profile%size) then
         at%radial = at%radial/at%r
      else
         at%radial = across(self%axis)
         at%r = 0.0_wp
      end if
   end function meridian

   !> The hoop part of the hessian is n_r/r; on the axis it equals the radial part of the plane one.
   pure subroutine lift_revolved(self, at, flat, foot)
      class(revolved_type), intent(in) :: self
      type(meridian_type), intent(in) :: at
      type(foot_2d_type), intent(in) :: flat
      type(foot_type), intent(out) :: foot
      real(wp) :: t(3), hoop(3), hoop_bend

      call copy_scalars(flat, foot)
      foot%point = at%centre + flat%point(1)*at%radial + flat%point(2)*self%axis
      foot%normal = flat%normal(1)*at%radial + flat%normal(2)*self%axis
      t = flat%normal(1)*self%axis - flat%normal(2)*at%radial
      hoop = cross(self%axis, at%radial)
      hoop_bend = flat%bend*flat%normal(2)**2
      if (at%r > 1.0e-9_wp*self%profile%size) hoop_bend = flat%normal(1)/at%r
      if (.not. at%is_round) hoop_bend = 0.0_wp
      foot%hessian = flat%bend*outer_product(t, t) + hoop_bend*outer_product(hoop, hoop)
   end subroutine lift_revolved

   pure subroutine tessellate_plane(self, box, points, cells)
      class(profile_tool_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)
      integer :: i

      call draw_profile(self%profile, points)
      allocate (cells(size(box, 1), size(points, 2) - 1))
      do i = 1, size(cells, 2)
         cells(:, i) = [i, i + 1]
      end do
   end subroutine tessellate_plane

   !> The extrusion is drawn over the length that the box has along the generator.
   pure subroutine tessellate_extruded(self, box, points, cells)
      class(extruded_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)
      real(wp), allocatable :: line(:, :)
      real(wp) :: half(3), middle, reach
      integer :: i, n

      call draw_profile(self%profile, line)
      n = size(line, 2)
      half = 0.5_wp*(box(:, 2) - box(:, 1))
      middle = dot_product(box(:, 1) + half - self%origin, self%frame(:, 3))
      reach = dot_product(half, abs(self%frame(:, 3)))
      allocate (points(3, 2*n), cells(4, n - 1))
      do i = 1, n
         points(:, i) = self%origin + matmul(self%frame, [line(1, i), line(2, i), middle - reach])
         points(:, n + i) = points(:, i) + 2.0_wp*reach*self%frame(:, 3)
      end do
      do i = 1, n - 1
         cells(:, i) = [i, i + 1, n + i + 1, n + i]
      end do
   end subroutine tessellate_extruded

   pure subroutine tessellate_revolved(self, box, points, cells)
      class(revolved_type), intent(in) :: self
      real(wp), intent(in) :: box(:, :)
      real(wp), allocatable, intent(out) :: points(:, :)
      integer, allocatable, intent(out) :: cells(:, :)
      real(wp), parameter :: pi = acos(-1.0_wp)
      real(wp), allocatable :: line(:, :)
      real(wp) :: t1(3), t2(3), centre(3), a
      integer :: corners, i, j, k, n, m, turns

      call draw_profile(self%profile, line)
      n = size(line, 2)
      t1 = across(self%axis)
      corners = merge(4, 0, any(self%half > 0.0_wp))
      if (corners > 0) t1 = self%side(:, 1)
      t2 = cross(self%axis, t1)
      turns = ring + corners
      allocate (points(size(box, 1), n*turns), cells(4, (n - 1)*turns))
      centre = self%origin
      do j = 1, turns
         k = j - 1
         if (corners > 0) then
            ! Each corner begins where the one before ended: the sides lie between.
            k = k - (j - 1)/(ring/4 + 1)
            centre = self%origin + matmul(self%side, self%half*corner_sign(:, 1 + (j - 1)/(ring/4 &
               & + 1)))
         end if
         a = 2.0_wp*pi*real(k, wp)/real(ring, wp)
         do i = 1, n
            points(:, (j - 1)*n + i) = centre + line(1, i)*(cos(a)*t1 + sin(a)*t2) + line(2, &
               & i)*self%axis
         end do
      end do
      m = 0
      do j = 1, turns
         k = mod(j, turns)
         do i = 1, n - 1
            m = m + 1
            cells(:, m) = [(j - 1)*n + i, (j - 1)*n + i + 1, k*n + i + 1, k*n + i]
         end do
      end do
      if (corners == 0) return
      do i = 1, n, n - 1
         if (line(1, i) > 1.0e-9_wp*self%profile%size) cycle
         cells = reshape([cells, i + n*[0, 1, 2, 3]*(ring/4 + 1)], [4, size(cells, 2) + 1])
      end do
   end subroutine tessellate_revolved

   function describe(self) result(text)
      class(profile_tool_type), intent(in) :: self
      character(len=:), allocatable :: text
      character(len=20) :: buffer

      write (buffer, '(i0)') size(self%profile%segment)
      text = self%name//' of '//trim(buffer)//' segments'
      if (self%profile%closed) text = text//', closed'
   end function describe
end module lopin_tool_profile
