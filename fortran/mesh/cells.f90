!> Reference cells: nodes, edges, faces, VTK numbers and shape functions.
!>
!> Names are meshio's, node order is Abaqus' (C3D20, C3D15, C3D10 ...), face numbers are Abaqus'
!> S1..S6. The nodes of a face are listed so that its normal points OUT of the cell: right-hand rule
!> for surfaces, and to the right of the way 1 -> 2 for lines.
!> Lines, quads and hexahedra live in [-1, 1]^d; simplices in 0 <= r, s, t, r + s + t <= 1; wedges
!> are triangle times [-1, 1].
module lopin_cells
   use lopin_kinds, only : wp
   use lopin_sorting, only : sort
   implicit none
   private
   public :: cell_type, cell_names, cell_id, cell_family, ncell
   public :: new_cell, new_cell_of, new_sided_cell, shape_functions, cell_centre, face_of_nodes

   integer, parameter :: ncell = 12

   !> Families share corners, edges and faces; the second cell of a family has a node on every edge.
   type :: families
      integer :: line = 1, triangle = 2, quad = 3, tetra = 4, wedge = 5, hexahedron = 6
   end type families
   type(families), parameter :: cell_family = families()

   type :: ids
      integer :: line2 = 1, line3 = 2, triangle = 3, triangle6 = 4, quad = 5, quad8 = 6, &
         & tetra = 7, tetra10 = 8, wedge = 9, wedge15 = 10, hexahedron = 11, hexahedron20 = 12
   end type ids
   type(ids), parameter :: cell_id = ids()

   character(len=*), parameter :: cell_names(ncell) = [character(len=12) :: 'line2', 'line3', &
      & 'triangle', 'triangle6', 'quad', 'quad8', 'tetra', 'tetra10', 'wedge', 'wedge15', &
      & 'hexahedron', 'hexahedron20']

   type :: cell_type
      character(len=12) :: name = ''
      integer :: id = 0                !! index into cell_names
      integer :: family = 0            !! one of cell_family
      integer :: ndim = 0              !! parametric dimension
      integer :: nnode = 0
      integer :: ncorner = 0
      integer :: nface = 0
      logical :: quadratic = .false.
      logical :: sided = .false.       !! a surface with two sides: face 1 = SPOS, face 2 = SNEG
      integer :: vtk = 0               !! VTK cell number
      integer :: vtk_order(20) = 0     !! VTK's k-th node is our node vtk_order(k): here k
      integer :: edge(2, 12) = 0       !! ends of each edge; node ncorner+k is amid edge k
      integer :: face_cell(6) = 0      !! cell id of each face
      integer :: face_nnode(6) = 0
      integer :: face_node(8, 6) = 0   !! nodes of each face, corners first, zeros behind the last
      real(wp) :: xi(3, 20) = 0.0_wp   !! parametric coordinates of the nodes
   end type cell_type

   integer, parameter :: vtk_number(ncell) = [3, 21, 5, 22, 9, 23, 10, 24, 13, 26, 12, 25]
   integer, parameter :: family_ndim(6) = [1, 2, 2, 3, 3, 3]
   integer, parameter :: family_ncorner(6) = [2, 3, 4, 4, 6, 8]
   integer, parameter :: family_nedge(6) = [1, 3, 4, 6, 9, 12]
   integer, parameter :: family_nface(6) = [0, 3, 4, 4, 5, 6]

contains

   !> The cell of a name; `found` is false when there is none.
   pure subroutine new_cell(self, name, found)
      type(cell_type), intent(out) :: self
      character(len=*), intent(in) :: name   !! one of cell_names
      logical, intent(out) :: found
      integer :: id

      found = .false.
      do id = 1, ncell
         if (cell_names(id) /= name) cycle
         found = .true.
         call new_cell_of(self, id)
      end do
   end subroutine new_cell

   !> The cell of a number.
   pure subroutine new_cell_of(self, id)
      type(cell_type), intent(out) :: self
      integer, intent(in) :: id   !! 1..ncell
      integer :: family, k

      family = (id + 1)/2
      self%name = cell_names(id)
      self%id = id
      self%family = family
      self%quadratic = mod(id, 2) == 0
      self%ndim = family_ndim(family)
      self%ncorner = family_ncorner(family)
      self%nnode = self%ncorner
      if (self%quadratic) self%nnode = self%ncorner + family_nedge(family)
      self%vtk = vtk_number(id)
      self%vtk_order(:self%nnode) = [(k, k=1, self%nnode)]
      call set_corners_and_edges(self)
      if (self%quadratic) then
         do k = 1, family_nedge(family)
            self%xi(:, self%ncorner + k) = 0.5_wp*sum(self%xi(:, self%edge(:, k)), dim=2)
         end do
      end if
      call set_faces(self)
   end subroutine new_cell_of

   !> A rigid line or surface: its faces are its two sides, 1 = SPOS and 2 = SNEG.
   !>
   !> SPOS is the side of the right-hand rule for surfaces, and to the LEFT of 1 -> 2 for lines
   !> (Abaqus).
   pure subroutine new_sided_cell(self, name, found)
      type(cell_type), intent(out) :: self
      character(len=*), intent(in) :: name   !! a line, triangle or quad of cell_names
      logical, intent(out) :: found
      integer :: corner(4), k, n

      call new_cell(self, name, found)
      if (self%ndim > 2) found = .false.
      if (.not. found) return
      self%sided = .true.
      self%nface = 2
      n = self%ncorner
      corner(:n) = [(k, k=1, n)]
      if (self%ndim == 1) corner(:2) = [2, 1]
      call set_face(self, 1, corner(:n))
      corner(2:n) = corner(n:2:-1)
      if (self%ndim == 1) corner(:2) = [1, 2]
      call set_face(self, 2, corner(:n))
   end subroutine new_sided_cell

   !> Parametric centre.
   pure function cell_centre(self) result(xi)
      type(cell_type), intent(in) :: self
      real(wp) :: xi(self%ndim)
      xi = sum(self%xi(:self%ndim, :self%ncorner), dim=2)/real(self%ncorner, wp)
   end function cell_centre

   pure subroutine set_corners_and_edges(self)
      type(cell_type), intent(inout) :: self
      integer, parameter :: square(3, 4) = reshape([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], [3, 4])
      integer, parameter :: simplex(3, 4) = reshape([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 4])
      integer, parameter :: ring3(2, 3) = reshape([1, 2, 2, 3, 3, 1], [2, 3])
      integer, parameter :: ring4(2, 4) = reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4])

      self%edge(:, 1) = [1, 2]
      select case (self%family)
      case (cell_family%line)
         self%xi(1, :2) = [-1.0_wp, 1.0_wp]
      case (cell_family%triangle)
         self%xi(:, :3) = real(simplex(:, :3), wp)
         self%edge(:, :3) = ring3
      case (cell_family%quad)
         self%xi(:, :4) = real(square, wp)
         self%edge(:, :4) = ring4
      case (cell_family%tetra)
         self%xi(:, :4) = real(simplex, wp)
         self%edge(:, :6) = reshape([ring3, 1, 4, 2, 4, 3, 4], [2, 6])
      case (cell_family%wedge)
         self%xi(:, :6) = real(reshape([simplex(:, :3), simplex(:, :3)], [3, 6]), wp)
         self%xi(3, :6) = [-1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp]
         self%edge(:, :9) = reshape([ring3, ring3 + 3, 1, 4, 2, 5, 3, 6], [2, 9])
      case (cell_family%hexahedron)
         self%xi(:, :8) = real(reshape([square, square], [3, 8]), wp)
         self%xi(3, :4) = -1.0_wp
         self%xi(3, 5:8) = 1.0_wp
         self%edge(:, :12) = reshape([ring4, ring4 + 4, 1, 5, 2, 6, 3, 7, 4, 8], [2, 12])
      end select
   end subroutine set_corners_and_edges

   !> Abaqus lists the corners of a face in no constant sense; here they are turned outward.
   pure subroutine set_faces(self)
      type(cell_type), intent(inout) :: self
      integer, parameter :: tetra(3, 4) = reshape([1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4], [3, 4])
      integer, parameter :: wedge(4, 5) = reshape([1, 3, 2, 0, 4, 5, 6, 0, 1, 2, 5, 4, 2, 3, 6, 5, &
         & 3, 1, 4, 6], [4, 5])
      integer, parameter :: hexahedron(4, 6) = reshape([1, 4, 3, 2, 5, 6, 7, 8, 1, 2, 6, 5, &
         & 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8], [4, 6])
      integer :: f

      self%nface = family_nface(self%family)
      do f = 1, self%nface
         select case (self%family)
         case (cell_family%triangle, cell_family%quad)
            call set_face(self, f, self%edge(:, f))
         case (cell_family%tetra)
            call set_face(self, f, tetra(:, f))
         case (cell_family%wedge)
            call set_face(self, f, wedge(:count(wedge(:, f) > 0), f))
         case (cell_family%hexahedron)
            call set_face(self, f, hexahedron(:, f))
         end select
      end do
   end subroutine set_faces

   !> Complete a face from its corners: its cell and, when quadratic, its mid-side nodes.
   pure subroutine set_face(self, f, corner)
      type(cell_type), intent(inout) :: self
      integer, intent(in) :: f           !! face number
      integer, intent(in) :: corner(:)   !! local corner nodes, 2 to 4 of them
      integer :: n, nedge, i, k, ends(2)

      n = size(corner)
      self%face_cell(f) = 2*n - 3   ! line2, triangle, quad
      self%face_nnode(f) = n
      self%face_node(:, f) = 0
      self%face_node(:n, f) = corner
      if (.not. self%quadratic) return
      self%face_cell(f) = self%face_cell(f) + 1
      nedge = merge(1, n, n == 2)
      do i = 1, nedge
         ends = [corner(i), corner(mod(i, n) + 1)]
         do k = 1, family_nedge(self%family)
            if (all(self%edge(:, k) == ends) .or. all(self%edge(:, k) == ends([2, 1]))) exit
         end do
         self%face_node(n + i, f) = self%ncorner + k
      end do
      self%face_nnode(f) = n + nedge
   end subroutine set_face

   !> Shape functions and their parametric derivatives at a free point.
   pure subroutine shape_functions(self, xi, n, dn)
      type(cell_type), intent(in) :: self
      real(wp), intent(in) :: xi(:)        !! (ndim) parametric point
      real(wp), intent(out) :: n(:)        !! (nnode)
      real(wp), intent(out) :: dn(:, :)    !! (ndim, nnode) d n / d xi

      select case (self%family)
      case (cell_family%line, cell_family%quad, cell_family%hexahedron)
         call brick_functions(self, xi, n, dn)
      case (cell_family%triangle, cell_family%tetra)
         call simplex_functions(self, xi, n, dn)
      case (cell_family%wedge)
         call wedge_functions(self, xi, n, dn)
      end select
   end subroutine shape_functions

   !> Lagrange (linear) or serendipity (quadratic) functions on [-1, 1]^d.
   pure subroutine brick_functions(self, xi, n, dn)
      type(cell_type), intent(in) :: self
      real(wp), intent(in) :: xi(:)
      real(wp), intent(out) :: n(:), dn(:, :)
      real(wp) :: f(3), df(3), blend
      integer :: i, j, d, k

      d = self%ndim
      f = 1.0_wp
      df = 0.0_wp
      do i = 1, self%nnode
         do j = 1, d
            if (i <= self%ncorner .or. abs(self%xi(j, i)) > 0.5_wp) then
               f(j) = 0.5_wp*(1.0_wp + self%xi(j, i)*xi(j))
               df(j) = 0.5_wp*self%xi(j, i)
            else
               f(j) = 1.0_wp - xi(j)**2
               df(j) = -2.0_wp*xi(j)
            end if
         end do
         n(i) = f(1)*f(2)*f(3)
         dn(1, i) = df(1)*f(2)*f(3)
         if (d > 1) dn(2, i) = f(1)*df(2)*f(3)
         if (d > 2) dn(3, i) = f(1)*f(2)*df(3)
         if (self%quadratic .and. i <= self%ncorner) then
            blend = dot_product(self%xi(:d, i), xi(:d)) - real(d - 1, wp)
            do k = 1, d
               dn(k, i) = dn(k, i)*blend + n(i)*self%xi(k, i)
            end do
            n(i) = n(i)*blend
         end if
      end do
   end subroutine brick_functions

   !> Functions of the barycentric coordinates.
   pure subroutine simplex_functions(self, xi, n, dn)
      type(cell_type), intent(in) :: self
      real(wp), intent(in) :: xi(:)
      real(wp), intent(out) :: n(:), dn(:, :)
      real(wp) :: l(4), dl(3, 4)
      integer :: i, a, b, d

      d = self%ndim
      call barycentric(xi(:d), l(:d + 1), dl(:d, :d + 1))
      if (.not. self%quadratic) then
         n(:d + 1) = l(:d + 1)
         dn(:d, :d + 1) = dl(:d, :d + 1)
         return
      end if
      do i = 1, self%ncorner
         n(i) = l(i)*(2.0_wp*l(i) - 1.0_wp)
         dn(:d, i) = dl(:d, i)*(4.0_wp*l(i) - 1.0_wp)
      end do
      do i = self%ncorner + 1, self%nnode
         a = self%edge(1, i - self%ncorner)
         b = self%edge(2, i - self%ncorner)
         n(i) = 4.0_wp*l(a)*l(b)
         dn(:d, i) = 4.0_wp*(dl(:d, a)*l(b) + l(a)*dl(:d, b))
      end do
   end subroutine simplex_functions

   !> Triangle times line; the quadratic one is of the serendipity family (15 nodes).
   pure subroutine wedge_functions(self, xi, n, dn)
      type(cell_type), intent(in) :: self
      real(wp), intent(in) :: xi(:)
      real(wp), intent(out) :: n(:), dn(:, :)
      real(wp) :: l(3), dl(2, 3), t, side, slope, bubble, factor
      integer :: i, k, a, b

      call barycentric(xi(:2), l, dl)
      t = xi(3)
      bubble = 1.0_wp - t**2
      do i = 1, self%nnode
         slope = 0.5_wp*self%xi(3, i)
         side = 0.5_wp + slope*t
         if (i <= 6) then
            a = mod(i - 1, 3) + 1
            factor = 1.0_wp
            if (self%quadratic) factor = 2.0_wp*l(a) - 1.0_wp
            n(i) = l(a)*factor*side
            dn(:2, i) = dl(:, a)*factor*side
            dn(3, i) = l(a)*factor*slope
            if (self%quadratic) then
               n(i) = n(i) - 0.5_wp*l(a)*bubble
               dn(:2, i) = dn(:2, i) + dl(:, a)*(2.0_wp*l(a)*side - 0.5_wp*bubble)
               dn(3, i) = dn(3, i) + l(a)*t
            end if
         else if (i <= 12) then
            k = i - 6
            a = mod(self%edge(1, k) - 1, 3) + 1
            b = mod(self%edge(2, k) - 1, 3) + 1
            n(i) = 4.0_wp*l(a)*l(b)*side
            dn(:2, i) = 4.0_wp*(dl(:, a)*l(b) + l(a)*dl(:, b))*side
            dn(3, i) = 4.0_wp*l(a)*l(b)*slope
         else
            a = i - 12
            n(i) = l(a)*bubble
            dn(:2, i) = dl(:, a)*bubble
            dn(3, i) = -2.0_wp*l(a)*t
         end if
      end do
   end subroutine wedge_functions

   pure subroutine barycentric(xi, l, dl)
      real(wp), intent(in) :: xi(:)
      real(wp), intent(out) :: l(:), dl(:, :)
      integer :: k

      l(1) = 1.0_wp - sum(xi)
      l(2:) = xi
      dl = 0.0_wp
      dl(:, 1) = -1.0_wp
      do k = 1, size(xi)
         dl(k, k + 1) = 1.0_wp
      end do
   end subroutine barycentric

   !> The face of a cell that has these nodes, in any order; 0: none.
   pure integer function face_of_nodes(cell, node, face_node) result(face)
      type(cell_type), intent(in) :: cell
      integer, intent(in) :: node(:)           !! numbers of the cell's nodes
      integer, intent(in) :: face_node(:)      !! numbers of the nodes of a face
      integer :: wanted(8), own(8), n

      wanted = 0
      wanted(:size(face_node)) = face_node
      call sort(wanted)
      do face = 1, cell%nface
         own = 0
         n = cell%face_nnode(face)
         own(:n) = node(cell%face_node(:n, face))
         call sort(own)
         if (all(own == wanted)) return
      end do
      face = 0
   end function face_of_nodes
end module lopin_cells
