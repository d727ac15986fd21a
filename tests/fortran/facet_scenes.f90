!> Triangles of a sphere, a box and a torus; tools of triangles.
module facet_scenes
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_facet_mesh, only : facet_flaws_type
   use lopin_tool, only : tool_type
   use lopin_tool_factory, only : new_tool_from_facets
   use check, only : is_true
   implicit none
   private
   public :: sphere_facets, box_facets, torus_facets, valley_facets, strips, new_open

   real(wp), parameter, public :: pi = acos(-1.0_wp)
   real(wp), parameter, public :: torus_radii(2) = [2.0_wp, 0.7_wp]

contains

   !> A unit sphere of 8*n*n facets: an octahedron whose sides are divided, projected.
   function sphere_facets(n) result(corner)
      integer, intent(in) :: n
      real(wp), allocatable :: corner(:, :, :)
      real(wp) :: s(3), a(3), b(3), c(3)
      integer :: octant, i, j, k

      allocate (corner(3, 3, 8*n*n))
      k = 0
      do octant = 0, 7
         s = merge(-1.0_wp, 1.0_wp, [btest(octant, 0), btest(octant, 1), btest(octant, 2)])
         do i = 0, n - 1
            do j = 0, n - 1 - i
               a = node(i, j)
               b = node(i + 1, j)
               c = node(i, j + 1)
               call add(a, b, c)
               if (j < n - 1 - i) call add(node(i + 1, j), node(i + 1, j + 1), node(i, j + 1))
            end do
         end do
      end do

   contains

      function node(p, q) result(x)
         integer, intent(in) :: p, q
         real(wp) :: x(3)
         x = real([p, q, n - p - q], wp)
         x = s*x/norm2(x)
      end function node

      subroutine add(p, q, r)
         real(wp), intent(in) :: p(3), q(3), r(3)
         k = k + 1
         corner(:, 1, k) = p
         corner(:, 2, k) = merge(q, r, product(s) > 0.0_wp)
         corner(:, 3, k) = merge(r, q, product(s) > 0.0_wp)
      end subroutine add
   end function sphere_facets

   !> The cube [-1, 1]**3.
   function box_facets() result(corner)
      real(wp) :: corner(3, 3, 12)
      real(wp) :: x(3, 4)
      integer :: axis, side, k

      k = 0
      do axis = 1, 3
         do side = -1, 1, 2
            x = 0.0_wp
            x(axis, :) = real(side, wp)
            x(1 + mod(axis, 3), :) = [-1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp]
            x(1 + mod(axis + 1, 3), :) = real(side, wp)*[-1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp]
            corner(:, :, k + 1) = x(:, [1, 2, 3])
            corner(:, :, k + 2) = x(:, [1, 3, 4])
            k = k + 2
         end do
      end do
   end function box_facets

   !> About the z axis, of 4*n*n facets.
   function torus_facets(n) result(corner)
      integer, intent(in) :: n
      real(wp), allocatable :: corner(:, :, :)
      integer :: i, j, k

      allocate (corner(3, 3, 4*n*n))
      k = 0
      do i = 0, 2*n - 1
         do j = 0, n - 1
            corner(:, :, k + 1) = reshape([on(i, j), on(i + 1, j), on(i + 1, j + 1)], [3, 3])
            corner(:, :, k + 2) = reshape([on(i, j), on(i + 1, j + 1), on(i, j + 1)], [3, 3])
            k = k + 2
         end do
      end do

   contains

      function on(p, q) result(x)
         integer, intent(in) :: p, q
         real(wp) :: x(3), a, b
         a = pi*real(modulo(p, 2*n), wp)/real(n, wp)
         b = 2.0_wp*pi*real(modulo(q, n), wp)/real(n, wp)
         x = [(torus_radii(1) + torus_radii(2)*cos(b))*[cos(a), sin(a)], torus_radii(2)*sin(b)]
      end function on
   end function torus_facets

   !> Two triangles a square of a grid of points, seen from above.
   pure subroutine strips(p, corner)
      real(wp), intent(in) :: p(:, :, :)       !! (3, across, along)
      real(wp), intent(out) :: corner(:, :, :)
      integer :: i, j, n

      n = 0
      do i = 1, size(p, 3) - 1
         do j = 1, size(p, 2) - 1
            corner(:, :, n + 1) = reshape([p(:, j, i), p(:, j, i + 1), p(:, j + 1, i + 1)], [3, 3])
            corner(:, :, n + 2) = reshape([p(:, j, i), p(:, j + 1, i + 1), p(:, j + 1, i)], [3, 3])
            n = n + 2
         end do
      end do
   end subroutine strips

   !> An open valley of two walls at right angles, along y: x >= 0 on z = 0, z >= 0 on x = 0.
   function valley_facets() result(corner)
      real(wp) :: corner(3, 3, 4)
      real(wp) :: x(3, 6)

      x = reshape([0.0_wp, -9.0_wp, 0.0_wp, 0.0_wp, 9.0_wp, 0.0_wp, 9.0_wp, -9.0_wp, 0.0_wp, &
         & 9.0_wp, 9.0_wp, 0.0_wp, 0.0_wp, -9.0_wp, 9.0_wp, 0.0_wp, 9.0_wp, 9.0_wp], [3, 6])
      corner(:, :, 1) = x(:, [1, 3, 4])
      corner(:, :, 2) = x(:, [1, 4, 2])
      corner(:, :, 3) = x(:, [1, 2, 6])
      corner(:, :, 4) = x(:, [1, 6, 5])
   end function valley_facets

   !> A tool of triangles that are taken for curved; they need not close a volume.
   subroutine new_open(tool, corner)
      class(tool_type), allocatable, intent(out) :: tool
      real(wp), intent(in) :: corner(:, :, :)
      type(facet_flaws_type) :: flaws
      type(error_type), allocatable :: error

      call new_tool_from_facets(tool, corner, .true., .false., flaws, error, .true.)
      call is_true('accepted', .not. allocated(error))
   end subroutine new_open
end module facet_scenes
