!> The mortar row of one slave node in the plane, in dual numbers: for exact tangents of finite
!> sliding.
!>
!> The row depends on the facets at the node, on their other neighbours by the nodal normals, and
!> on the master facets that these cover. `new_patch` lists them, `mortar_row` gives the weight,
!> normal,
!> mean gap and coefficients with their slopes by all places of the list: those of the dual basis,
!> of the normals and of the moving ends of the segments. A node may take over the functions of
!> others: lopin_mortar_cover.
module lopin_mortar_node_2d
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, dual_norm, operator(+), operator(-), operator(*), &
      & operator(/), assignment(=)
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_type, overlap_list_type
   use lopin_mortar_cells_2d, only : segment_type, integrate_segment, line_shape
   use lopin_mortar_dual_2d, only : transform, whole, dual_function
   implicit none
   private
   public :: patch_type, basis_functions_type, new_patch, mortar_row_type, mortar_row

   integer, parameter :: most_facets = 8

   !> gap vector = sum coefficient*x / weight.
   type :: mortar_row_type
      type(dual_type) :: weight                    !! D [area]
      type(dual_type) :: normal(2)                 !! out of the master: its mean opposite
      type(dual_type) :: gap                       !! mean by the dual function [length]
      type(dual_type), allocatable :: coefficient(:)   !! of each place; their sum is 0 [area]
   end type mortar_row_type

   !> What is around a slave node; places are numbers in `node`.
   type :: patch_type
      integer, allocatable :: node(:)              !! mesh node of each place; the first: the node
      integer :: nchain = 0                        !! slave facets: at the node, then beside those
      integer :: nnode(most_facets) = 0
      integer :: chain(3, most_facets) = 0
      logical :: at_node(most_facets) = .false.    !! integrated; others only have the normals
      integer :: piece(most_facets) = 1            !! smooth pieces: lopin_slave_pieces
      real(wp) :: middle(most_facets) = 0.0_wp     !! middle_share of the transformed basis
      integer, allocatable :: function(:)          !! places whose functions the row has
      integer, allocatable :: on(:)                !! the piece each of them is integrated on
      real(wp), allocatable :: share(:)            !! of each; the first: 1
      integer :: ncover = 0                        !! pairs of a slave facet and a master facet
      integer, allocatable :: over(:)              !! the slave facet, in the chain
      integer, allocatable :: ncovered(:)          !! nodes of the master facet
      integer, allocatable :: cover(:, :)          !! (3, ncover) places of them
      real(wp) :: lift = 0.0_wp                    !! of its gap above the mean [length]
      type(mortar_row_type) :: met                 !! its row by values, where it was met last
   end type patch_type

   !> The dual functions that a row is integrated with: those of its node, then of the nodes that
   !> it takes over.
   type :: basis_functions_type
      integer, allocatable :: node(:)              !! mesh nodes, its own first
      real(wp), allocatable :: share(:)            !! of each; the first: 1
      integer, allocatable :: piece(:)             !! of lopin_slave_pieces, on which each is
   end type basis_functions_type

   !> How a row is integrated.
   type :: measure_type
      logical :: axisymmetric = .false.
      real(wp) :: thickness = 1.0_wp               !! not read if axisymmetric [length]
   end type measure_type

   !> Below this share of a facet the standard basis stays, as in lopin_mortar.
   real(wp), parameter :: thin = 0.1_wp
contains

   !> The neighbourhood of a slave node; the overlaps are those found on the present shape.
   subroutine new_patch(self, slave, master, list, functions, piece, middle)
      type(patch_type), intent(out) :: self
      type(surface_type), intent(in) :: slave, master
      type(overlap_list_type), intent(in) :: list
      type(basis_functions_type), intent(in) :: functions
      integer, intent(in), optional :: piece(:)    !! (slave facets) of lopin_slave_pieces
      real(wp), intent(in), optional :: middle(:)  !! (slave facets) middle_share; 0
      integer :: facet(most_facets)
      integer, allocatable :: near(:)
      integer :: i, k, n, pass, own

      self%node = functions%node
      self%function = [(k, k=1, size(functions%node))]
      self%share = functions%share
      self%on = functions%piece
      near = self%node
      do pass = 1, 2
         do i = 1, slave%facets%n
            n = slave%facets%nnode(i)
            if (self%nchain == most_facets) exit
            if (any(facet(:self%nchain) == i)) cycle
            if (.not. any([(any(near == slave%facets%node(k, i)), k=1, n)])) cycle
            own = 1
            if (present(piece)) own = piece(i)
            if (pass == 1) then
               if (.not. any([(any(slave%facets%node(:n, i) == near(k) .and. self%on(k) == own), &
                  & k=1, size(self%on))])) cycle
            end if
            call add_chain(self, slave%facets%node(:n, i), pass == 1, own)
            facet(self%nchain) = i
            if (present(middle)) self%middle(self%nchain) = middle(i)
         end do
         near = self%node
         if (pass == 1) call add_covers(self, master, list, facet(:self%nchain))
      end do
   end subroutine new_patch

   subroutine add_chain(self, nodes, at_node, piece)
      type(patch_type), intent(inout) :: self
      integer, intent(in) :: nodes(:)
      logical, intent(in) :: at_node
      integer, intent(in) :: piece
      integer :: k

      self%nchain = self%nchain + 1
      self%nnode(self%nchain) = size(nodes)
      self%at_node(self%nchain) = at_node
      self%piece(self%nchain) = piece
      do k = 1, size(nodes)
         call take_place(self, nodes(k), self%chain(k, self%nchain))
      end do
   end subroutine add_chain

   subroutine add_covers(self, master, list, facet)
      type(patch_type), intent(inout) :: self
      type(surface_type), intent(in) :: master
      type(overlap_list_type), intent(in) :: list
      integer, intent(in) :: facet(:)
      integer :: i, k, most

      most = 0
      do i = 1, list%n
         if (any(facet == list%item(i)%slave)) most = most + 1
      end do
      allocate (self%over(most), self%ncovered(most), self%cover(3, most), source=0)
      do i = 1, list%n
         if (.not. any(facet == list%item(i)%slave)) cycle
         self%ncover = self%ncover + 1
         self%over(self%ncover) = findloc(facet, list%item(i)%slave, 1)
         self%ncovered(self%ncover) = master%facets%nnode(list%item(i)%master)
         do k = 1, self%ncovered(self%ncover)
            call take_place(self, master%facets%node(k, list%item(i)%master), &
               & self%cover(k, self%ncover))
         end do
      end do
   end subroutine add_covers

   subroutine take_place(self, node, place)
      type(patch_type), intent(inout) :: self
      integer, intent(in) :: node
      integer, intent(out) :: place

      place = findloc(self%node, node, 1)
      if (place > 0) return
      self%node = [self%node, node]
      place = size(self%node)
   end subroutine take_place

   !> The row at present places.
   subroutine mortar_row(self, patch, x, axisymmetric, thickness)
      type(mortar_row_type), intent(out) :: self
      type(patch_type), intent(in) :: patch
      type(dual_type), intent(in) :: x(:, :)       !! (2, places) [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness            !! not read if axisymmetric [length]
      type(dual_type) :: length, side(2, 3, most_facets)
      integer :: i, k

      allocate (self%coefficient(size(x, 2)))
      self%normal = constant([0.0_wp, 0.0_wp])
      do i = 1, patch%nchain
         call facet_sides(x, patch%chain(:patch%nnode(i), i), side(:, :, i))
      end do
      do i = 1, patch%nchain
         if (patch%at_node(i)) call add_facet(self, patch, x, side, &
            & measure_type(axisymmetric, thickness), i)
      end do
      if (.not. self%weight%v > 0.0_wp) return
      if (axisymmetric .and. is_on_axis(x, 1) .and. abs(self%normal(2)%v) > 0.0_wp) &
         & self%normal(1) = constant(0.0_wp)
      length = dual_norm(self%normal)
      self%gap = constant(0.0_wp)
      do k = 1, 2
         self%normal(k) = self%normal(k)/length
         do i = 2, size(x, 2)
            ! About the node: far coordinates lose no digits.
            self%gap = self%gap + self%coefficient(i)*self%normal(k)*(x(k, i) - x(k, 1))
         end do
      end do
      self%gap = self%gap/self%weight + constant(patch%lift)
   end subroutine mortar_row

   !> By symmetry nothing is radial there.
   pure logical function is_on_axis(x, place)
      type(dual_type), intent(in) :: x(:, :)
      integer, intent(in) :: place
      is_on_axis = abs(x(1, place)%v) <= 1.0e-10_wp*maxval(abs(x(1, :)%v))
   end function is_on_axis

   !> Mean of the unit normals of the facets of a piece at a place.
   function nodal_normal(patch, x, side, place, piece, axisymmetric) result(normal)
      type(patch_type), intent(in) :: patch
      type(dual_type), intent(in) :: x(:, :)
      type(dual_type), intent(in) :: side(:, :, :) !! (2, 3, facets) facet_sides of the chain
      integer, intent(in) :: place, piece
      logical, intent(in) :: axisymmetric
      type(dual_type) :: normal(2), length
      integer :: i, k

      normal = constant([0.0_wp, 0.0_wp])
      do i = 1, patch%nchain
         if (patch%piece(i) /= piece) cycle
         do k = 1, patch%nnode(i)
            if (patch%chain(k, i) == place) normal = normal + side(:, k, i)
         end do
      end do
      if (axisymmetric .and. is_on_axis(x, place) .and. abs(normal(2)%v) > 0.0_wp) &
         & normal(1) = constant(0.0_wp)
      length = dual_norm(normal)
      normal(1) = normal(1)/length
      normal(2) = normal(2)/length
   end function nodal_normal

   !> Outward unit normals of a facet at its nodes; that of a straight facet is found once.
   subroutine facet_sides(x, at, side)
      type(dual_type), intent(in) :: x(:, :)       !! (2, places) [length]
      integer, intent(in) :: at(:)                 !! places of its nodes
      type(dual_type), intent(inout) :: side(:, :) !! (2, 3)
      type(dual_type) :: n(3), dn(3), tangent(2), length
      real(wp), parameter :: xi(3) = [-1.0_wp, 1.0_wp, 0.0_wp]
      integer :: k, m

      do k = 1, size(at)
         if (k == 2 .and. size(at) == 2) then
            side(:, 2) = side(:, 1)
            exit
         end if
         call line_shape(size(at), constant(xi(k)), n, dn)
         tangent = constant([0.0_wp, 0.0_wp])
         do m = 1, size(at)
            tangent = tangent + dn(m)%v*x(:, at(m))
         end do
         length = dual_norm(tangent)
         side(1, k) = tangent(2)/length
         side(2, k) = constant(0.0_wp) - tangent(1)/length
      end do
   end subroutine facet_sides

   !> What one facet at the node adds.
   subroutine add_facet(self, patch, x, side, how, i)
      type(mortar_row_type), intent(inout) :: self
      type(patch_type), intent(in) :: patch
      type(dual_type), intent(in) :: x(:, :)
      type(dual_type), intent(in) :: side(:, :, :) !! (2, 3, facets) facet_sides of the chain
      type(measure_type), intent(in) :: how
      integer, intent(in) :: i
      type(segment_type) :: segment(patch%ncover)
      type(dual_type) :: own(2, 3), normal(2, 3), me(3, 3), d(3), a(3), area
      real(wp) :: plain(3)
      integer :: c, f, j, k, n
      logical :: dual

      n = patch%nnode(i)
      do k = 1, n
         own(:, k) = x(:, patch%chain(k, i))
         normal(:, k) = nodal_normal(patch, x, side, patch%chain(k, i), patch%piece(i), &
            & how%axisymmetric)
      end do
      do c = 1, patch%ncover
         if (patch%over(c) /= i) cycle
         call integrate_segment(own(:, :n), normal(:, :n), &
            & x(:, patch%cover(:patch%ncovered(c), c)), how%axisymmetric, how%thickness, &
            & segment(c))
         if (.not. segment(c)%overlaps) cycle
         me = me + segment(c)%me
         d = d + segment(c)%d
         area = area + segment(c)%area
      end do
      if (.not. area%v > 0.0_wp) return
      call transform(patch%middle(i), me, d)
      dual = area%v >= thin*whole(own(:, :n)%v, how%axisymmetric, how%thickness)
      a = constant([0.0_wp, 0.0_wp, 0.0_wp])
      plain = 0.0_wp
      do f = 1, size(patch%function)
         if (patch%on(f) /= patch%piece(i)) cycle
         j = findloc(patch%chain(:n, i), patch%function(f), 1)
         if (j == 0) cycle
         plain(j) = plain(j) + patch%share(f)
         self%weight = self%weight + patch%share(f)*d(j)
         call add_own(self, patch, i, j, patch%share(f)*d(j))
         if (dual) then
            call dual_function(me(:n, :n), patch%share(f)*d(j), j, a(:n))
         else
            a(j) = a(j) + patch%share(f)
         end if
      end do
      ! By the standard basis, in which the segments are.
      if (patch%middle(i) > 0.0_wp) then
         a(3) = patch%middle(i)*(a(1) + a(2)) + (1.0_wp - 2.0_wp*patch%middle(i))*a(3)
         plain(3) = patch%middle(i)*(plain(1) + plain(2)) &
            & + (1.0_wp - 2.0_wp*patch%middle(i))*plain(3)
      end if
      call subtract_masters(self, patch, x, segment, a(:n), plain(:n), i)
   end subroutine add_facet

   !> What the masters under a facet weigh, and their normals.
   subroutine subtract_masters(self, patch, x, segment, a, plain, i)
      type(mortar_row_type), intent(inout) :: self
      type(patch_type), intent(in) :: patch
      type(dual_type), intent(in) :: x(:, :)
      type(segment_type), intent(in) :: segment(:) !! (ncover)
      type(dual_type), intent(in) :: a(:)          !! coefficients of the standard basis
      real(wp), intent(in) :: plain(:)             !! the same of its sum
      integer, intent(in) :: i                     !! the facet, in the chain
      type(dual_type) :: out(2, 3)
      integer :: c, k, l

      do c = 1, patch%ncover
         if (patch%over(c) /= i .or. .not. segment(c)%overlaps) cycle
         call facet_sides(x, patch%cover(:patch%ncovered(c), c), out)
         do l = 1, patch%ncovered(c)
            associate (to => self%coefficient(patch%cover(l, c)))
               do k = 1, size(a)
                  to = to - a(k)*segment(c)%b(k, l)
                  if (.not. plain(k) > 0.0_wp) cycle
                  self%normal(1) = self%normal(1) + plain(k)*segment(c)%b(k, l)*out(1, l)
                  self%normal(2) = self%normal(2) + plain(k)*segment(c)%b(k, l)*out(2, l)
               end do
            end associate
         end do
      end do
   end subroutine subtract_masters

   !> The slave's side of function j of a facet: of a transformed one that of the middle is
   !> (u_3 - share (u_1 + u_2))/(1 - 2 share).
   subroutine add_own(self, patch, i, j, d)
      type(mortar_row_type), intent(inout) :: self
      type(patch_type), intent(in) :: patch
      integer, intent(in) :: i, j
      type(dual_type), intent(in) :: d
      real(wp) :: inner
      integer :: k

      inner = 1.0_wp
      if (j == 3) inner = 1.0_wp - 2.0_wp*patch%middle(i)
      associate (c => self%coefficient(patch%chain(j, i)))
         c = c + (1.0_wp/inner)*d
      end associate
      if (.not. inner < 1.0_wp) return
      do k = 1, 2
         associate (c => self%coefficient(patch%chain(k, i)))
            c = c - (patch%middle(i)/inner)*d
         end associate
      end do
   end subroutine add_own
end module lopin_mortar_node_2d
