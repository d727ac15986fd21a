!> Facets: faces of elements taken as pieces of a surface. Which are free, their normals, areas,
!> weights.
!>
!> A facet is (element, face number); its nodes are ordered so that the normal points out of the
!> element (see lopin_cells). Areas are per unit thickness in the plane, over the full circumference
!> (2 pi r) if axisymmetric.
module lopin_facets
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_cells, only : cell_type, cell_id, new_cell_of, shape_functions
   use lopin_quadrature, only : rule_type, new_rule
   use lopin_face_numbers, only : number_faces
   implicit none
   private
   public :: facets_type, facet_rule_type, new_facets, boundary_facets, new_facet_rules
   public :: facet_point, facet_weights, nodal_weights, nodal_normals, middle_share

   real(wp), parameter :: pi = acos(-1.0_wp)
   !> Share of a mid-side function that each corner of its edge gets (Popp et al. 2012).
   real(wp), parameter :: given = 0.2_wp
   !> line3 whose inner end is nearer to the axis than this part of its radial length is blended:
   !> there the integral of its inner function vanishes.
   real(wp), parameter :: near_axis = 0.5_wp

   !> A list of facets.
   type :: facets_type
      integer :: n = 0
      integer, allocatable :: element(:)   !! (n) element index
      integer, allocatable :: face(:)      !! (n) Abaqus face number; rigid: 1 = SPOS, 2 = SNEG
      integer, allocatable :: cell(:)      !! (n) cell id of the facet: line2 ... quad8
      integer, allocatable :: nnode(:)     !! (n)
      integer, allocatable :: node(:, :)   !! (8, n) nodes, corners first, zeros behind the last
   end type facets_type

   !> Shape functions of a facet cell at its Gauss points.
   type :: facet_rule_type
      type(cell_type) :: cell
      integer :: npoint = 0
      real(wp), allocatable :: weight(:)    !! (npoint)
      real(wp), allocatable :: n(:, :)      !! (nnode, npoint)
      real(wp), allocatable :: dn(:, :, :)  !! (ndim, nnode, npoint)
      real(wp) :: blend(8, 8) = 0.0_wp  !! positive functions = matmul(blend, n); see facet_weights
   end type facet_rule_type

contains

   !> The facets of given elements and face numbers; face numbers must exist.
   pure subroutine new_facets(self, mesh, cells, element, face)
      type(facets_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cells(:)   !! cell of each element type, as mesh%etype counts
      integer, intent(in) :: element(:)         !! element indices
      integer, intent(in) :: face(:)            !! same size, 1..nface of the element's cell
      integer :: i, t, m

      self%n = size(element)
      self%element = element
      self%face = face
      allocate (self%cell(self%n), self%nnode(self%n), self%node(8, self%n))
      self%node = 0
      do i = 1, self%n
         t = mesh%etype(element(i))
         m = cells(t)%face_nnode(face(i))
         self%cell(i) = cells(t)%face_cell(face(i))
         self%nnode(i) = m
         self%node(:m, i) = mesh%conn(cells(t)%face_node(:m, face(i)), element(i))
      end do
   end subroutine new_facets

   !> The skin of a set of elements: faces that only one element of the set has.
   !>
   !> `shared` tells those that an element outside the set has as well; `ESET,` in a deck means the
   !> others. Rigid elements give their positive side. Edges on the axis are no surface and are left
   !> out.
   subroutine boundary_facets(self, mesh, cells, element, axisymmetric, shared)
      type(facets_type), intent(out) :: self
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cells(:)            !! cell of each element type
      integer, intent(in) :: element(:)                  !! element indices of the set
      logical, intent(in) :: axisymmetric
      logical, allocatable, intent(out) :: shared(:)     !! (self%n)
      integer, allocatable :: number(:, :), inside(:), outside(:), found_element(:), found_face(:)
      logical, allocatable :: found_shared(:)
      integer :: i, f, t, e, n

      call number_faces(mesh, cells, number, n)
      call count_facets(mesh, cells, number, n, element, inside, outside)
      allocate (found_element(6*size(element)), found_face(6*size(element)))
      allocate (found_shared(6*size(element)))
      n = 0
      do i = 1, size(element)
         e = element(i)
         t = mesh%etype(e)
         do f = 1, cells(t)%nface
            if (cells(t)%sided) then
               if (f == 2) cycle
            else
               if (inside(number(f, e)) /= 1) cycle
               if (axisymmetric .and. on_axis(mesh, cells(t), e, f)) cycle
            end if
            n = n + 1
            found_element(n) = e
            found_face(n) = f
            found_shared(n) = .false.
            if (.not. cells(t)%sided) found_shared(n) = outside(number(f, e)) > 0
         end do
      end do
      call new_facets(self, mesh, cells, found_element(:n), found_face(:n))
      shared = found_shared(:n)
   end subroutine boundary_facets

   pure logical function on_axis(mesh, cell, e, f)
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cell
      integer, intent(in) :: e, f
      real(wp) :: r(2)
      r = mesh%x(1, mesh%conn(cell%face_node(:2, f), e))
      on_axis = all(abs(r) <= 1.0e-10_wp*maxval(abs(mesh%x(1, mesh%conn(:cell%nnode, e)))))
   end function on_axis

   !> How many elements of the set, and how many others, have each face.
   pure subroutine count_facets(mesh, cells, number, n, element, inside, outside)
      type(mesh_type), intent(in) :: mesh
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: number(:, :), n, element(:)
      integer, allocatable, intent(out) :: inside(:), outside(:)
      logical :: member(mesh%nelement)
      integer :: e, f, k

      allocate (inside(n), outside(n))
      inside = 0
      outside = 0
      member = .false.
      member(element) = .true.
      do e = 1, mesh%nelement
         if (cells(mesh%etype(e))%sided) cycle
         do f = 1, cells(mesh%etype(e))%nface
            k = number(f, e)
            if (member(e)) then
               inside(k) = inside(k) + 1
            else
               outside(k) = outside(k) + 1
            end if
         end do
      end do
   end subroutine count_facets

   !> Tables for the six facet cells, indexed by cell id.
   pure subroutine new_facet_rules(self)
      type(facet_rule_type), intent(out) :: self(6)
      integer, parameter :: degree(6) = [3, 5, 2, 4, 3, 5]
      type(rule_type) :: rule
      integer :: i, k

      do i = 1, 6
         call new_cell_of(self(i)%cell, i)
         call new_rule(rule, self(i)%cell%family, degree(i))
         self(i)%npoint = rule%npoint
         self(i)%weight = rule%weight
         allocate (self(i)%n(self(i)%cell%nnode, rule%npoint))
         allocate (self(i)%dn(self(i)%cell%ndim, self(i)%cell%nnode, rule%npoint))
         do k = 1, rule%npoint
            call shape_functions(self(i)%cell, rule%xi(:, k), self(i)%n(:, k), self(i)%dn(:, :, k))
         end do
         call set_blend(self(i))
      end do
   end subroutine new_facet_rules

   !> A fifth of each mid-side function goes to each of the two corners of its edge: the integrals
   !> of quad8 and triangle6 become positive, their sum stays one (Popp, Wohlmuth, Gee, Wall 2012).
   pure subroutine set_blend(self)
      type(facet_rule_type), intent(inout) :: self
      integer :: k, mid

      do k = 1, self%cell%nnode
         self%blend(k, k) = 1.0_wp
      end do
      do k = 1, self%cell%nnode - self%cell%ncorner
         mid = self%cell%ncorner + k
         self%blend(mid, mid) = 1.0_wp - 2.0_wp*given
         self%blend(self%cell%edge(:, k), mid) = given
      end do
   end subroutine set_blend

   !> Normal times the area of the parametric unit, from the slopes of the shape functions.
   pure function facet_normal(x, dn) result(normal)
      real(wp), intent(in) :: x(:, :)       !! (ndim, nnode) coordinates [length]
      real(wp), intent(in) :: dn(:, :)      !! (ndim-1, nnode)
      real(wp) :: normal(size(x, 1))        !! not a unit vector
      real(wp) :: t(3, 2)

      if (size(x, 1) == 2) then
         t(:2, 1) = matmul(x, dn(1, :))
         normal = [t(2, 1), -t(1, 1)]
      else
         t(:, 1) = matmul(x, dn(1, :))
         t(:, 2) = matmul(x, dn(2, :))
         normal = [t(2, 1)*t(3, 2) - t(3, 1)*t(2, 2), t(3, 1)*t(1, 2) - t(1, 1)*t(3, 2), &
            & t(1, 1)*t(2, 2) - t(2, 1)*t(1, 2)]
      end if
   end function facet_normal

   !> Unit normal and area of a Gauss point of a facet.
   pure subroutine facet_point(self, k, x, axisymmetric, normal, area)
      type(facet_rule_type), intent(in) :: self
      integer, intent(in) :: k                !! Gauss point
      real(wp), intent(in) :: x(:, :)         !! (ndim, nnode) coordinates [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(out) :: normal(:)  !! (ndim) unit, outward; zero if the facet is degenerate
      real(wp), intent(out) :: area           !! weight included
      real(wp) :: length

      normal = facet_normal(x, self%dn(:, :, k))
      length = norm2(normal)
      area = length*self%weight(k)
      if (axisymmetric) area = area*2.0_wp*pi*dot_product(x(1, :), self%n(:, k))
      if (length > 0.0_wp) normal = normal/length
   end subroutine facet_point

   !> Share of a mid-side function that the transformed basis gives to each corner of its edge: that
   !> of a facet whose plain functions would have integrals that vanish or are negative.
   pure real(wp) function middle_share(self, x, axisymmetric) result(share)
      type(facet_rule_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      logical, intent(in) :: axisymmetric

      share = 0.0_wp
      if (.not. self%cell%quadratic) return
      if (self%cell%id == cell_id%line3) then
         if (.not. axisymmetric) return
         if (minval(abs(x(1, :2))) >= near_axis*abs(x(1, 2) - x(1, 1))) return
      end if
      share = given
   end function middle_share

   !> Areas that belong to the nodes of one facet; positive, their sum is the area exactly.
   !>
   !> Linear facets: integrals of the shape functions, so that a uniform pressure gives the
   !> consistent forces; on the axis pi h**2/3 > 0. Quadratic surfaces: integrals of the blended
   !> functions (the corners of quad8 would be negative). line3: with `share` those blended by it
   !> (lopin_slave_points); without, the shape functions, and the node on the axis, whose integral
   !> vanishes, gets a thousandth of the area from the middle node.
   pure subroutine facet_weights(self, x, axisymmetric, weight, share)
      type(facet_rule_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)        !! (ndim, nnode) coordinates [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(out) :: weight(:)     !! (nnode) [length^2], plane: per thickness [length]
      real(wp), intent(in), optional :: share   !! middle_share, 0 or as there
      real(wp) :: normal(3), area
      real(wp) :: lacking
      integer :: k, m

      m = self%cell%nnode
      weight = 0.0_wp
      do k = 1, self%npoint
         call facet_point(self, k, x, axisymmetric, normal(:size(x, 1)), area)
         weight(:m) = weight(:m) + area*self%n(:, k)
      end do
      if (.not. self%cell%quadratic) return
      if (present(share)) then
         if (share > 0.0_wp) weight(:m) = matmul(self%blend(:m, :m), weight(:m))
      else if (self%cell%id == cell_id%line3) then
         do k = 1, 2
            lacking = max(0.0_wp, 1.0e-3_wp*sum(weight(:m)) - weight(k))
            weight([k, 3]) = weight([k, 3]) + [lacking, -lacking]
         end do
      else
         weight(:m) = matmul(self%blend(:m, :m), weight(:m))
      end if
   end subroutine facet_weights

   !> Areas of all nodes of a list of facets in the transformed basis; zero elsewhere.
   pure subroutine nodal_weights(self, rules, x, axisymmetric, thickness, weight, start)
      type(facets_type), intent(in) :: self
      type(facet_rule_type), intent(in) :: rules(:)   !! from new_facet_rules
      real(wp), intent(in) :: x(:, :)                 !! (ndim, nnode) coordinates [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness(:)            !! (self%n); ones unless plane [length]
      real(wp), intent(out) :: weight(:)              !! (nnode) [length^2]
      real(wp), intent(in), optional :: start(:, :)   !! places that chose the basis; else x
      real(wp) :: own(8), share
      integer :: i, m

      weight = 0.0_wp
      do i = 1, self%n
         m = self%nnode(i)
         if (present(start)) then
            share = middle_share(rules(self%cell(i)), start(:, self%node(:m, i)), axisymmetric)
         else
            share = middle_share(rules(self%cell(i)), x(:, self%node(:m, i)), axisymmetric)
         end if
         call facet_weights(rules(self%cell(i)), x(:, self%node(:m, i)), axisymmetric, own, share)
         weight(self%node(:m, i)) = weight(self%node(:m, i)) + thickness(i)*own(:m)
      end do
   end subroutine nodal_weights

   !> Unit normals at the nodes: mean of the unit normals of the facets that meet there.
   !>
   !> On the axis the radial part vanishes by symmetry. Nodes without a facet, and nodes whose
   !> facets cancel, have a zero normal.
   pure subroutine nodal_normals(self, rules, x, axisymmetric, normal)
      type(facets_type), intent(in) :: self
      type(facet_rule_type), intent(in) :: rules(:)   !! from new_facet_rules
      real(wp), intent(in) :: x(:, :)                 !! (ndim, nnode) coordinates [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(out) :: normal(:, :)           !! (ndim, nnode) outward
      real(wp) :: own(size(x, 1)), n(8), dn(2, 8), length, axis
      integer :: i, k, m, d

      d = size(x, 1)
      normal = 0.0_wp
      axis = 0.0_wp
      if (axisymmetric) axis = 1.0e-10_wp*maxval(abs(x(1, :)))
      do i = 1, self%n
         m = self%nnode(i)
         do k = 1, m
            associate (cell => rules(self%cell(i))%cell)
               call shape_functions(cell, cell%xi(:d - 1, k), n(:m), dn(:d - 1, :m))
            end associate
            own = facet_normal(x(:, self%node(:m, i)), dn(:d - 1, :m))
            length = norm2(own)
            if (length <= 0.0_wp) cycle
            normal(:, self%node(k, i)) = normal(:, self%node(k, i)) + own/length
         end do
      end do
      do i = 1, size(normal, 2)
         if (axisymmetric) then
            if (abs(x(1, i)) <= axis .and. abs(normal(2, i)) > 0.0_wp) normal(1, i) = 0.0_wp
         end if
         length = norm2(normal(:, i))
         if (length > 1.0e-6_wp) then
            normal(:, i) = normal(:, i)/length
         else
            normal(:, i) = 0.0_wp
         end if
      end do
   end subroutine nodal_normals
end module lopin_facets
