!> A meshed surface as the contact search sees it: facets, neighbours, nodes, present shape.
!>
!> The topology is made once by `new_surface`; `update_surface` follows the nodes.
module lopin_surface
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_cells, only : cell_family
   use lopin_facets, only : facets_type
   use lopin_facet_basis, only : facet_basis_type, new_facet_basis, coefficients_of, ncoefficient, &
      & facet_tangents, facet_point_of
   use lopin_projection, only : facet_unit_normal, edge_ends
   use lopin_smooth_facet, only : stencil_type, find_stencil, smooth_coefficients, is_smoothed, &
      & twin_of, feature_cosine, most_stencil
   implicit none
   private
   public :: surface_type, new_surface, renumber_nodes, update_surface, slack_of, edge_normal

   type :: surface_type
      integer :: ndim = 0
      type(facets_type) :: facets
      integer :: nnode = 0
      integer, allocatable :: node(:)          !! (nnode) its mesh nodes, not decreasing
      integer, allocatable :: local(:, :) !! (8, n) index into `node`, 0 behind the last
      integer, allocatable :: neighbour(:, :)  !! (4, n) facet across each edge; 0 on the perimeter
      integer, allocatable :: twin(:, :)       !! (4, n) number of that edge in the neighbour
      integer, allocatable :: ring_first(:)    !! (nnode+1) first entry of `ring` of each node
      integer, allocatable :: ring(:)          !! facets that have the node as a corner
      type(facet_basis_type) :: basis
      logical :: smooth = .false.              !! curved facets, see lopin_smooth_facet
      type(stencil_type), allocatable :: stencil(:)  !! (n) of smoothed facets
      ! Present shape
      real(wp), allocatable :: coefficient(:, :, :)  !! (3, 9, n) see lopin_facet_basis [length]
      real(wp), allocatable :: low(:, :), high(:, :) !! (3, n) box of each facet [length]
      real(wp), allocatable :: disc(:, :) !! (8, n) centre, axis, radius, half height [length]
      logical, allocatable :: flat(:)                !! (n) one normal all over
      real(wp), allocatable :: outlook(:, :)  !! (3, n) axes where the increment began, if it moves
      real(wp), allocatable :: size(:)               !! (n) mean edge length [length]
      real(wp), allocatable :: pseudo(:, :) !! (3, nnode) angle-weighted unit normal of corners
   end type surface_type

contains

   !> A surface of facets; `update_surface` gives it its places.
   subroutine new_surface(self, ndim, facets, smooth)
      type(surface_type), intent(out) :: self
      integer, intent(in) :: ndim                !! 2 or 3
      type(facets_type), intent(in) :: facets    !! outward, see lopin_facets
      logical, intent(in), optional :: smooth    !! curve linear facets by averaged normals

      self%ndim = ndim
      if (present(smooth)) self%smooth = smooth
      self%facets = facets
      call new_facet_basis(self%basis)
      call number_nodes(self)
      call make_rings(self)
      call find_neighbours(self)
      allocate (self%coefficient(3, ncoefficient, facets%n), self%low(3, facets%n), self%high(3, &
         & facets%n))
      allocate (self%disc(8, facets%n), self%size(facets%n), self%pseudo(3, self%nnode))
      allocate (self%flat(facets%n), source=.false.)
   end subroutine new_surface

   subroutine number_nodes(self)
      type(surface_type), intent(inout) :: self
      integer, allocatable :: place(:)
      integer :: i, k, n, top

      top = 0
      if (self%facets%n > 0) top = maxval(self%facets%node)
      allocate (place(top))
      place = 0
      do i = 1, self%facets%n
         place(self%facets%node(:self%facets%nnode(i), i)) = 1
      end do
      n = 0
      allocate (self%node(sum(place)))
      do i = 1, top
         if (place(i) == 0) cycle
         n = n + 1
         self%node(n) = i
         place(i) = n
      end do
      self%nnode = n
      allocate (self%local(8, self%facets%n))
      self%local = 0
      do i = 1, self%facets%n
         do k = 1, self%facets%nnode(i)
            self%local(k, i) = place(self%facets%node(k, i))
         end do
      end do
   end subroutine number_nodes

   !> Other local numbers: a mesh node may have several, each with facets of its own.
   subroutine renumber_nodes(self, node, local)
      type(surface_type), intent(inout) :: self
      integer, intent(in) :: node(:)             !! mesh node of each, not decreasing
      integer, intent(in) :: local(:, :)         !! (8, n)

      self%nnode = size(node)
      self%node = node
      self%local = local
      deallocate (self%ring_first, self%ring, self%pseudo)
      allocate (self%pseudo(3, self%nnode))
      call make_rings(self)
   end subroutine renumber_nodes

   subroutine make_rings(self)
      type(surface_type), intent(inout) :: self
      integer :: next(self%nnode + 1)
      integer :: i, k, node

      allocate (self%ring_first(self%nnode + 1))
      self%ring_first = 0
      do i = 1, self%facets%n
         do k = 1, self%basis%ncorner(self%facets%cell(i))
            node = self%local(k, i)
            self%ring_first(node + 1) = self%ring_first(node + 1) + 1
         end do
      end do
      self%ring_first(1) = 1
      do i = 1, self%nnode
         self%ring_first(i + 1) = self%ring_first(i + 1) + self%ring_first(i)
      end do
      next = self%ring_first
      allocate (self%ring(self%ring_first(self%nnode + 1) - 1))
      do i = 1, self%facets%n
         do k = 1, self%basis%ncorner(self%facets%cell(i))
            node = self%local(k, i)
            self%ring(next(node)) = i
            next(node) = next(node) + 1
         end do
      end do
   end subroutine make_rings

   !> The facet across an edge travels it the other way (a line: ends where this one begins).
   subroutine find_neighbours(self)
      type(surface_type), intent(inout) :: self
      integer :: i, k, j, other, m, n, a, b

      allocate (self%neighbour(4, self%facets%n), self%twin(4, self%facets%n))
      self%neighbour = 0
      self%twin = 0
      do i = 1, self%facets%n
         n = self%basis%ncorner(self%facets%cell(i))
         do k = 1, n
            a = self%local(k, i)
            b = self%local(1 + mod(k, n), i)
            do j = self%ring_first(a), self%ring_first(a + 1) - 1
               other = self%ring(j)
               if (other == i .or. self%neighbour(k, i) > 0) cycle
               m = edge_in(self, other, k, a, b)
               if (m == 0) cycle
               self%neighbour(k, i) = other
               self%twin(k, i) = m
            end do
         end do
      end do
   end subroutine find_neighbours

   !> Number of the edge b -> a in a facet (a line: of the opposite end at node a); 0 if it has
   !> none.
   pure integer function edge_in(self, facet, end, a, b) result(edge)
      type(surface_type), intent(in) :: self
      integer, intent(in) :: facet, end, a, b
      integer :: n

      n = self%basis%ncorner(self%facets%cell(facet))
      if (n == 2) then
         edge = 3 - end
         if (self%local(edge, facet) /= a) edge = 0
         return
      end if
      do edge = 1, n
         if (self%local(edge, facet) == b .and. self%local(1 + mod(edge, n), facet) == a) return
      end do
      edge = 0
   end function edge_in

   !> Follow the nodes: coefficients, boxes, sizes, normals. A facet without area is refused.
   subroutine update_surface(self, x, error)
      type(surface_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :) !! (ndim, all mesh nodes) present coordinates [length]
      type(error_type), allocatable, intent(out) :: error
      integer :: i, cell, n, nc
      real(wp) :: own(3, 8), normal(3), bulge(3)
      character(len=60) :: text

      if (self%smooth .and. .not. allocated(self%stencil)) call find_stencils(self, x)
      do i = 1, self%facets%n
         cell = self%facets%cell(i)
         nc = self%basis%ncorner(cell)
         call shape_facet(self, i, x, n, own)
         call bound_facet(nc, n, own, self%low(:, i), self%high(:, i), bulge)
         if (self%smooth) then
            bulge = bulge + abs(self%coefficient(:, 9, i))
            self%low(:, i) = self%low(:, i) - abs(self%coefficient(:, 9, i))
            self%high(:, i) = self%high(:, i) + abs(self%coefficient(:, 9, i))
         end if
         self%size(i) = norm2(own(:, 2) - own(:, 1))
         if (nc > 2) self%size(i) = sum(norm2(own(:, :nc) - cshift(own(:, :nc), 1, dim=2), &
            & dim=1))/real(nc, wp)
         normal = facet_unit_normal(self%coefficient(:, :, i), self%basis%family(cell), &
            & self%basis%centre(:, cell))
         self%flat(i) = all(abs(self%coefficient(:, 4:, i)) <= 0.0_wp)
         self%disc(:, i) = enclosing_disc(own(:, :n), nc, normal, norm2(bulge))
         if (degenerate(self, i, normal)) then
            write (text, '("face S",i0)') self%facets%face(i)
            call raise(error, error_code%deck, 'E0304', &
               & trim(text)//' of a contact surface has no area', &
               & help='two of its nodes are at the same place, or all are on one line')
            error%item(1)%element = self%facets%element(i)
            return
         end if
      end do
      call weigh_normals(self)
   end subroutine update_surface

   pure logical function degenerate(self, i, normal)
      type(surface_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: normal(3)      !! at the centre
      real(wp) :: length, t1(3), t2(3)
      integer :: cell

      cell = self%facets%cell(i)
      call facet_tangents(self%coefficient(:, :, i), self%basis%centre(:, cell), t1, t2)
      length = dot_product(t1, t1)
      degenerate = .not. length > 0.0_wp .or. .not. norm2(normal) > 0.5_wp
      if (self%basis%ncorner(cell) > 2) degenerate = degenerate .or. &
         & .not. length*dot_product(t2, t2) - dot_product(t1, &
         & t2)**2 > (1.0e-10_wp*self%size(i)**2)**2
   end function degenerate

   !> Coefficients of a facet, and the points that bound it: its nodes, or those of its smooth twin.
   pure subroutine shape_facet(self, i, x, n, own)
      type(surface_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:, :)
      integer, intent(out) :: n
      real(wp), intent(out) :: own(3, 8)
      real(wp) :: around(3, most_stencil)
      integer :: cell, k

      cell = self%facets%cell(i)
      n = self%facets%nnode(i)
      own = 0.0_wp
      own(:self%ndim, :n) = x(:, self%facets%node(:n, i))
      if (.not. self%smooth .or. .not. is_smoothed(cell)) then
         self%coefficient(:, :, i) = coefficients_of(self%basis, cell, own(:, :n))
         return
      end if
      associate (stencil => self%stencil(i))
         around = 0.0_wp
         around(:self%ndim, :stencil%n) = x(:, stencil%node(:stencil%n))
         self%coefficient(:, :, i) = smooth_coefficients(stencil, self%basis, cell, &
            & around(:, :stencil%n))
      end associate
      do k = 1, merge(1, n, n == 2)
         own(:, n + k) = facet_point_of(self%coefficient(:, :, i), &
            & merge([0.0_wp, 0.0_wp], self%basis%xi(:, min(8, n + k), twin_of(cell)), n == 2))
      end do
      n = n + merge(1, n, n == 2)
   end subroutine shape_facet

   !> What smoothing needs of the neighbourhood; edges sharp at the start stay so.
   subroutine find_stencils(self, x)
      type(surface_type), intent(inout) :: self
      real(wp), intent(in) :: x(:, :)
      logical :: feature(4, self%facets%n)
      real(wp) :: own(3, 8)
      integer :: i, k, n, other

      allocate (self%stencil(self%facets%n))
      do i = 1, self%facets%n
         n = self%facets%nnode(i)
         own = 0.0_wp
         own(:self%ndim, :n) = x(:, self%facets%node(:n, i))
         self%coefficient(:, :, i) = coefficients_of(self%basis, self%facets%cell(i), own(:, :n))
      end do
      feature = .false.
      do i = 1, self%facets%n
         do k = 1, self%basis%ncorner(self%facets%cell(i))
            other = self%neighbour(k, i)
            if (other == 0) cycle
            feature(k, i) = dot_product(edge_normal(self, i, k), edge_normal(self, other, &
               & self%twin(k, i))) < feature_cosine
         end do
      end do
      do i = 1, self%facets%n
         call find_stencil(self%stencil(i), self%facets, self%basis, self%neighbour, feature, i)
      end do
   end subroutine find_stencils

   pure function edge_normal(self, facet, edge) result(n)
      type(surface_type), intent(in) :: self
      integer, intent(in) :: facet, edge
      real(wp) :: n(3)
      integer :: family

      family = self%basis%family(self%facets%cell(facet))
      n = facet_unit_normal(self%coefficient(:, :, facet), family, edge_ends(family, edge, 0.5_wp))
   end function edge_normal

   !> A box that holds the whole facet: a curved edge bulges beyond its nodes by less than the
   !> distance from its mid-side node to its chord; a curved quad by less than twice that.
   pure subroutine bound_facet(ncorner, nnode, x, low, high, bulge)
      integer, intent(in) :: ncorner, nnode
      real(wp), intent(in) :: x(3, 8)
      real(wp), intent(out) :: low(3), high(3)
      real(wp), intent(out) :: bulge(3)       !! by which the facet may pass its nodes [length]
      integer :: k

      low = minval(x(:, :nnode), dim=2)
      high = maxval(x(:, :nnode), dim=2)
      bulge = 0.0_wp
      do k = 1, nnode - ncorner
         bulge = max(bulge, abs(x(:, ncorner + k) - 0.5_wp*(x(:, k) + x(:, 1 + mod(k, ncorner)))))
      end do
      if (ncorner > 2) bulge = 2.0_wp*bulge
      low = low - bulge
      high = high + bulge
   end subroutine bound_facet

   !> A flat round disc that holds the whole facet: a closer bound than its box.
   pure function enclosing_disc(x, ncorner, axis, bulge) result(disc)
      real(wp), intent(in) :: x(:, :)         !! (3, nnode) [length]
      integer, intent(in) :: ncorner
      real(wp), intent(in) :: axis(3)         !! unit
      real(wp), intent(in) :: bulge           !! [length]
      real(wp) :: disc(8), arm(3), height
      integer :: k

      disc = 0.0_wp
      do k = 1, ncorner
         disc(1:3) = disc(1:3) + x(:, k)/real(ncorner, wp)
      end do
      disc(4:6) = axis
      do k = 1, size(x, 2)
         arm = x(:, k) - disc(1:3)
         height = dot_product(arm, axis)
         disc(7) = max(disc(7), norm2(arm - height*axis))
         disc(8) = max(disc(8), abs(height))
      end do
      ! A little more than rounding, so that no facet is missed for it.
      disc(7:8) = (1.0_wp + 1.0e-12_wp)*(disc(7:8) + bulge) + 1.0e-12_wp*disc(7)
   end function enclosing_disc

   !> Angle-weighted normals of the corners: their sign tells inside from outside at a vertex
   !> (Baerentzen and Aanaes 2005).
   subroutine weigh_normals(self)
      type(surface_type), intent(inout) :: self
      integer :: i, k, cell, n
      real(wp) :: t1(3), t2(3), ahead(3), back(3), angle, length
      real(wp) :: xi(2)

      self%pseudo = 0.0_wp
      do i = 1, self%facets%n
         cell = self%facets%cell(i)
         n = self%basis%ncorner(cell)
         do k = 1, n
            xi = self%basis%xi(:, k, cell)
            angle = 1.0_wp
            if (n > 2) then
               call facet_tangents(self%coefficient(:, :, i), xi, t1, t2)
               ahead = self%basis%xi(1, 1 + mod(k, n), cell)*t1 + self%basis%xi(2, 1 + mod(k, n), &
                  & cell)*t2 &
                  & - xi(1)*t1 - xi(2)*t2
               back = self%basis%xi(1, 1 + modulo(k - 2, n), cell)*t1 &
                  & + self%basis%xi(2, 1 + modulo(k - 2, n), cell)*t2 - xi(1)*t1 - xi(2)*t2
               length = norm2(ahead)*norm2(back)
               if (.not. length > 0.0_wp) cycle
               angle = acos(min(1.0_wp, max(-1.0_wp, dot_product(ahead, back)/length)))
            end if
            self%pseudo(:, self%local(k, i)) = self%pseudo(:, self%local(k, i)) &
               & + angle*facet_unit_normal(self%coefficient(:, :, i), self%basis%family(cell), xi)
         end do
      end do
      do i = 1, self%nnode
         length = norm2(self%pseudo(:, i))
         if (length > 1.0e-12_wp) self%pseudo(:, i) = self%pseudo(:, i)/length
      end do
   end subroutine weigh_normals

   !> How far the perimeter edges of a facet may be moved outward, in reference units.
   pure function slack_of(self, facet, extension) result(slack)
      type(surface_type), intent(in) :: self
      integer, intent(in) :: facet
      real(wp), intent(in) :: extension      !! fraction of the facet
      real(wp) :: slack(4)
      integer :: n

      slack = 0.0_wp
      n = self%basis%ncorner(self%facets%cell(facet))
      where (self%neighbour(:n, facet) == 0) slack(:n) = extension
      if (self%basis%family(self%facets%cell(facet)) /= cell_family%triangle) slack = 2.0_wp*slack
   end function slack_of
end module lopin_surface
