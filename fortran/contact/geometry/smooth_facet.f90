!> Smoothed facets: the curved face through the corners of a linear one, from averaged normals.
!>
!> The normal of a corner is that of the circle or sphere through the nodes around it: corner
!> products weighted by 1/(a^2 b^2) (Max 1999), lines by 1/length; both are exact there. Facets
!> that meet at a feature edge (more than 30 degrees) do not share normals. A line becomes the cubic
!> of Hermite with end tangents 2 chord/(1 + cos of half the turn), a circle but for terms of sixth
!> order; an edge in space the parabola with the sagitta of the circle (after Nagata 2005), a facet
!> the quadratic one with these edges. Quadratic facets are left as they are. An open end of a line
!> turns as much as its other end.
module lopin_smooth_facet
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_cells, only : cell_id
   use lopin_facets, only : facets_type
   use lopin_facet_basis, only : facet_basis_type, coefficients_of, ncoefficient
   implicit none
   private
   public :: stencil_type, find_stencil, smooth_coefficients, corner_normals, is_smoothed, twin_of
   public :: most_stencil, feature_cosine

   real(wp), parameter :: feature_cosine = 0.86602540378443865_wp
   integer, parameter :: most_stencil = 40, most_fans = 12

   !> The nodes that shape a smoothed facet; the first ones are its corners.
   type :: stencil_type
      integer :: n = 0
      integer :: node(most_stencil) = 0         !! mesh nodes
      integer :: nfan(4) = 0                    !! facets that share the normal of each corner
      integer :: fan(3, most_fans, 4) = 0       !! their nodes before, at, after it (in `node`)
   end type stencil_type

contains

   !> Whether facets of a cell can be curved by averaged normals: the linear ones.
   pure logical function is_smoothed(cell)
      integer, intent(in) :: cell                !! cell id of the facet
      is_smoothed = cell == cell_id%line2 .or. cell == cell_id%triangle .or. cell == cell_id%quad
   end function is_smoothed

   !> The cell whose nodes carry the smoothed facet (a line: itself).
   pure integer function twin_of(cell)
      integer, intent(in) :: cell
      twin_of = cell
      if (cell == cell_id%triangle) twin_of = cell_id%triangle6
      if (cell == cell_id%quad) twin_of = cell_id%quad8
   end function twin_of

   !> Gather the facets around each corner without crossing a feature edge.
   pure subroutine find_stencil(self, facets, basis, neighbour, feature, i)
      type(stencil_type), intent(out) :: self
      type(facets_type), intent(in) :: facets
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: neighbour(:, :)     !! (4, n) facet across each edge
      logical, intent(in) :: feature(:, :)       !! (4, n) edges that are not smoothed over
      integer, intent(in) :: i
      integer :: k, m, n, c, f, g, list(most_fans), nlist, turn

      n = basis%ncorner(facets%cell(i))
      self%n = n
      self%node(:n) = facets%node(:n, i)
      do k = 1, n
         nlist = 1
         list(1) = i
         m = 0
         do while (m < nlist)
            m = m + 1
            f = list(m)
            c = corner_at(facets, basis, f, facets%node(k, i))
            if (c == 0) cycle
            call add_fan(self, facets, basis, f, c, k)
            do turn = 0, merge(0, 1, n == 2)
               g = 1 + modulo(c - 1 - turn, basis%ncorner(facets%cell(f)))
               if (feature(g, f)) cycle
               g = neighbour(g, f)
               if (g == 0 .or. nlist == most_fans) cycle
               if (any(list(:nlist) == g)) cycle
               nlist = nlist + 1
               list(nlist) = g
            end do
         end do
      end do
   end subroutine find_stencil

   pure integer function corner_at(facets, basis, f, node)
      type(facets_type), intent(in) :: facets
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: f, node

      do corner_at = 1, basis%ncorner(facets%cell(f))
         if (facets%node(corner_at, f) == node) return
      end do
      corner_at = 0
   end function corner_at

   pure subroutine add_fan(self, facets, basis, f, c, k)
      type(stencil_type), intent(inout) :: self
      type(facets_type), intent(in) :: facets
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: f, c, k
      integer :: n, three(3), j, at

      n = basis%ncorner(facets%cell(f))
      three = facets%node([1 + modulo(c - 2, n), c, 1 + mod(c, n)], f)
      if (n == 2) three = facets%node([1, c, 2], f)
      do j = 1, 3
         at = findloc(self%node(:self%n), three(j), dim=1)
         if (at == 0) then
            if (self%n == most_stencil) return
            self%n = self%n + 1
            at = self%n
            self%node(at) = three(j)
         end if
         three(j) = at
      end do
      self%nfan(k) = self%nfan(k) + 1
      self%fan(:, self%nfan(k), k) = three
   end subroutine add_fan

   !> Unit normals of the corners of a facet.
   pure function corner_normals(self, n, x) result(normal)
      type(stencil_type), intent(in) :: self
      integer, intent(in) :: n                   !! corners
      real(wp), intent(in) :: x(:, :)            !! (3, self%n) places of the stencil [length]
      real(wp) :: normal(3, 4), a(3), b(3), length
      integer :: k, j

      normal = 0.0_wp
      do k = 1, n
         do j = 1, self%nfan(k)
            associate (fan => self%fan(:, j, k))
               if (n == 2) then
                  a = x(:, fan(3)) - x(:, fan(1))
                  normal(:, k) = normal(:, k) + [a(2), -a(1), 0.0_wp]/dot_product(a, a)
               else
                  a = x(:, fan(3)) - x(:, fan(2))
                  b = x(:, fan(1)) - x(:, fan(2))
                  normal(:, k) = normal(:, k) + cross(a, b)/(dot_product(a, a)*dot_product(b, b))
               end if
            end associate
         end do
         length = norm2(normal(:, k))
         if (length > 0.0_wp) normal(:, k) = normal(:, k)/length
      end do
      if (n /= 2 .or. sum(self%nfan(:2)) /= 3) return
      ! One end is open: it turns as much as the other.
      k = minloc(self%nfan(:2), dim=1)
      a = x(:, 2) - x(:, 1)
      a = a/norm2(a)
      normal(:, k) = normal(:, 3 - k) - 2.0_wp*dot_product(normal(:, 3 - k), a)*a
   end function corner_normals

   !> Coefficients (see lopin_facet_basis) of the smoothed facet.
   pure function smooth_coefficients(self, basis, cell, x) result(c)
      type(stencil_type), intent(in) :: self
      type(facet_basis_type), intent(in) :: basis
      integer, intent(in) :: cell                !! cell id of the linear facet
      real(wp), intent(in) :: x(:, :)            !! (3, self%n) places of the stencil [length]
      real(wp) :: c(3, ncoefficient)
      real(wp) :: normal(3, 4), all_nodes(3, 8), d(3), s(3), long
      integer :: k, next, n

      n = basis%ncorner(cell)
      normal = corner_normals(self, n, x)
      if (n == 2) then
         c = hermite(x(:, 1), x(:, 2), normal(:, 1), normal(:, 2))
         return
      end if
      do k = 1, n
         next = 1 + mod(k, n)
         all_nodes(:, k) = x(:, k)
         d = x(:, next) - x(:, k)
         s = normal(:, k) + normal(:, next)
         long = norm2(s)
         all_nodes(:, n + k) = 0.5_wp*(x(:, k) + x(:, next)) &
            & - dot_product(normal(:, k) - normal(:, next), d)/(2.0_wp*long*(2.0_wp + long))*s
      end do
      c = coefficients_of(basis, twin_of(cell), all_nodes(:, :2*n))
   end function smooth_coefficients

   !> The cubic from a to b whose ends are square to their normals.
   pure function hermite(a, b, na, nb) result(c)
      real(wp), intent(in) :: a(3), b(3), na(3), nb(3)
      real(wp) :: c(3, ncoefficient), d(3), ta(3), tb(3), chord

      d = b - a
      chord = norm2(d)
      ta = [-na(2), na(1), 0.0_wp]
      tb = [-nb(2), nb(1), 0.0_wp]
      ta = chord/(1.0_wp + dot_product(ta, d)/chord)*ta
      tb = chord/(1.0_wp + dot_product(tb, d)/chord)*tb
      c = 0.0_wp
      c(:, 5) = 0.25_wp*(tb - ta)
      c(:, 9) = 0.25_wp*(ta + tb - d)
      c(:, 1) = 0.5_wp*(a + b) - c(:, 5)
      c(:, 2) = 0.5_wp*d - c(:, 9)
   end function hermite
end module lopin_smooth_facet
