!> Integration points inside a facet, and their weights in the rows of the facet's nodes.
!>
!> The dual functions psi = A N, A = diag(sum w N) (sum w N N^T)^-1, are made with the points' own
!> sums: a gap that is linear over the facet gives exactly the gaps at its nodes. On second-order
!> facets N stands for the functions of the transformed basis, and a gap that is quadratic gives
!> exactly what the rows of that basis make of the gaps at the nodes, lopin_row_samples.
module lopin_face_points
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_type, cell_family, shape_functions
   use lopin_mortar, only : dual_matrix
   implicit none
   private
   public :: face_points_type, new_face_points, place_points

   real(wp), parameter :: two_pi = 2.0_wp*acos(-1.0_wp)

   type :: face_points_type
      integer :: n = 0
      real(wp), allocatable :: shape(:, :)     !! (nnode, n) N
      real(wp), allocatable :: slope(:, :, :)  !! (ndim - 1, nnode, n) dN/dxi
      real(wp), allocatable :: part(:, :)      !! (nnode, n) w psi; summed over points the weight
      real(wp), allocatable :: weight(:)       !! (nnode) integral of N, transformed [area]
      real(wp), allocatable :: area(:)         !! (n) w [area]
      real(wp), allocatable :: x(:, :)         !! (3, n) [length]
      real(wp), allocatable :: normal(:, :)    !! (3, n) unit, out of the facet
   end type face_points_type

contains

   !> Points at the middles of equal parts; on second-order facets, Gauss points of parts twice as
   !> long, which integrate quadratic functions exactly.
   subroutine new_face_points(self, cell, x, parts, axisymmetric, thickness, share)
      type(face_points_type), intent(out) :: self
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      integer, intent(in) :: parts             !! in each direction
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness        !! 1 unless plane [length]
      real(wp), intent(in) :: share            !! of mid-side functions that each corner gets
      real(wp), allocatable :: xi(:, :)
      real(wp) :: area, a(size(x, 2), size(x, 2)), me(size(x, 2), size(x, 2)), w(parts**2), &
         & blended(size(x, 2), parts**2)
      integer :: q, k, m, d

      d = size(x, 1)
      m = size(x, 2)
      if (cell%quadratic) then
         call middles(cell%family, max(2, parts/2), xi, area)
         call split(cell%family, max(2, parts/2), xi, area)
      else
         call middles(cell%family, parts, xi, area)
      end if
      self%n = size(xi, 2)
      allocate (self%shape(m, self%n), self%slope(d - 1, m, self%n), self%part(m, self%n), &
         & self%weight(m))
      allocate (self%x(3, self%n), self%normal(3, self%n), source=0.0_wp)
      do q = 1, self%n
         call shape_functions(cell, xi(:d - 1, q), self%shape(:, q), self%slope(:, :, q))
      end do
      call place_points(self, x, w(:self%n))
      call blend(cell, share, self%shape, blended(:, :self%n))
      me = 0.0_wp
      do q = 1, self%n
         w(q) = thickness*area*w(q)
         if (axisymmetric) w(q) = two_pi*self%x(1, q)*w(q)
         do k = 1, m
            me(:, k) = me(:, k) + w(q)*blended(k, q)*blended(:, q)
         end do
      end do
      self%area = w(:self%n)
      self%weight = matmul(blended(:, :self%n), w(:self%n))
      call dual_matrix(me, self%weight, a)
      do q = 1, self%n
         self%part(:, q) = w(q)*matmul(a, blended(:, q))
      end do
   end subroutine new_face_points

   !> Functions of the transformed basis: each corner gets a share of the mid-sides of its edges.
   pure subroutine blend(cell, share, plain, blended)
      type(cell_type), intent(in) :: cell
      real(wp), intent(in) :: share
      real(wp), intent(in) :: plain(:, :)      !! (nnode, points)
      real(wp), intent(out) :: blended(:, :)
      integer :: k, mid

      blended = plain
      if (.not. share > 0.0_wp) return
      do k = 1, cell%nnode - cell%ncorner
         mid = cell%ncorner + k
         blended(cell%edge(1, k), :) = blended(cell%edge(1, k), :) + share*plain(mid, :)
         blended(cell%edge(2, k), :) = blended(cell%edge(2, k), :) + share*plain(mid, :)
         blended(mid, :) = (1.0_wp - 2.0_wp*share)*plain(mid, :)
      end do
   end subroutine blend

   !> Places and normals where the nodes of the facet are at x, and areas for one of the cell.
   pure subroutine place_points(self, x, stretch)
      type(face_points_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(out) :: stretch(:)      !! (n) [area]
      real(wp) :: t(3, 2)
      integer :: q, d

      d = size(x, 1)
      do q = 1, self%n
         self%x(:d, q) = matmul(x, self%shape(:, q))
         t = 0.0_wp
         t(3, 2) = 1.0_wp
         t(:d, :d - 1) = matmul(x, transpose(self%slope(:, :, q)))
         self%normal(:, q) = cross(t(:, 1), t(:, 2))
         stretch(q) = norm2(self%normal(:, q))
         self%normal(:, q) = self%normal(:, q)/stretch(q)
      end do
   end subroutine place_points

   !> Middles of equal parts of a reference cell, and the area of each.
   pure subroutine middles(family, parts, xi, area)
      integer, intent(in) :: family, parts
      real(wp), allocatable, intent(out) :: xi(:, :)   !! (2, points)
      real(wp), intent(out) :: area
      integer :: i, j, n

      allocate (xi(2, merge(parts, parts**2, family == cell_family%line)), source=0.0_wp)
      n = 0
      select case (family)
      case (cell_family%line)
         xi(1, :) = [((2*i - 1)/real(parts, wp) - 1.0_wp, i=1, parts)]
         area = 2.0_wp/parts
      case (cell_family%triangle)
         ! Sub-triangles that stand as the whole, and those between them.
         do i = 0, parts - 1
            do j = 0, parts - 1 - i
               n = n + 1
               xi(:, n) = ([i, j] + 1.0_wp/3.0_wp)/parts
               if (i + j == parts - 1) cycle
               n = n + 1
               xi(:, n) = ([i, j] + 2.0_wp/3.0_wp)/parts
            end do
         end do
         area = 0.5_wp/parts**2
      case default
         do i = 1, parts
            do j = 1, parts
               n = n + 1
               xi(:, n) = [2*i - 1, 2*j - 1]/real(parts, wp) - 1.0_wp
            end do
         end do
         area = 4.0_wp/parts**2
      end select
   end subroutine middles

   !> Gauss points of equal weights, in the parts of a reference cell, for their middles.
   subroutine split(family, parts, xi, area)
      integer, intent(in) :: family, parts
      real(wp), allocatable, intent(inout) :: xi(:, :)   !! (2, points)
      real(wp), intent(inout) :: area          !! of each point
      real(wp), parameter :: g = 1.0_wp/sqrt(3.0_wp), a = 1.0_wp/6.0_wp, &
         & corner(2, 3) = reshape([-a, -a, 2.0_wp*a, -a, -a, 2.0_wp*a], [2, 3]), &
         & line(2, 2) = reshape([-g, 0.0_wp, g, 0.0_wp], [2, 2]), &
         & quad(2, 4) = reshape([-g, -g, g, -g, -g, g, g, g], [2, 4])

      select case (family)
      case (cell_family%line)
         call put(line)
      case (cell_family%triangle)
         call put(corner)
      case default
         call put(quad)
      end select

   contains

      subroutine put(way)
         real(wp), intent(in) :: way(:, :)     !! (2, points of a part)
         real(wp) :: middle(2, size(xi, 2)), step(2, size(way, 2))
         integer :: k, n

         middle = xi
         n = size(way, 2)
         deallocate (xi)
         allocate (xi(2, n*size(middle, 2)))
         do k = 1, size(middle, 2)
            step = way/parts
            ! Triangles between those that stand as the whole are turned by half a turn.
            if (family == cell_family%triangle .and. modulo(parts*sum(middle(:, k)), 1.0_wp) &
               & < 0.5_wp) step = -step
            xi(:, (k - 1)*n + 1:k*n) = spread(middle(:, k), 2, n) + step
         end do
         area = area/n
      end subroutine put
   end subroutine split
end module lopin_face_points
