!> A slave surface in smooth pieces, cut at its sharp edges.
!>
!> The mean of two normals at a right angle looks at no master: the top of a billet that a plate
!> presses would be projected aslant at its rim, and the side, which the plate does not see, would
!> seem to lie within it. So each piece has normals of its own, and a node on a sharp edge has a
!> number on the surface for each of its pieces: each piece is covered by itself. Which of them
!> have a row is told by lopin_mortar_cover.
module lopin_slave_pieces
   use lopin_kinds, only : wp
   use lopin_facets, only : facet_rule_type, facet_weights, middle_share
   use lopin_facet_sides, only : facet_sides
   use lopin_surface, only : surface_type, renumber_nodes
   implicit none
   private
   public :: split_slave, piece_normals, whole_weights

   !> Facets whose normals turn by more across an edge, 40 degrees, belong to two pieces.
   real(wp), parameter :: corner_cosine = 0.766044443118978_wp

contains

   !> Cut a surface at the edges that are sharp now, and number its nodes by pieces.
   subroutine split_slave(slave, rules, x, piece)
      type(surface_type), intent(inout) :: slave
      type(facet_rule_type), intent(in) :: rules(:)      !! from new_facet_rules
      real(wp), intent(in) :: x(:, :)                    !! (ndim, mesh nodes) [length]
      integer, allocatable, intent(out) :: piece(:)      !! (slave facets) from 1
      real(wp) :: side(size(x, 1), 8, slave%facets%n)
      integer :: i, n, number

      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         call facet_sides(rules(slave%facets%cell(i))%cell, x(:, slave%facets%node(:n, i)), &
            & side(:, :n, i))
      end do
      allocate (piece(slave%facets%n), source=0)
      number = 0
      do i = 1, slave%facets%n
         if (piece(i) > 0) cycle
         number = number + 1
         call spread_from(slave, side, i, number, piece)
      end do
      if (number > 1) call number_by_pieces(slave, piece)
   end subroutine split_slave

   !> Number a facet and all that continue it smoothly.
   pure subroutine spread_from(slave, side, first, number, piece)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: side(:, :, :)
      integer, intent(in) :: first, number
      integer, intent(inout) :: piece(:)
      integer :: waiting(slave%facets%n), n, i, k, other

      n = 1
      waiting(1) = first
      piece(first) = number
      do while (n > 0)
         i = waiting(n)
         n = n - 1
         do k = 1, size(slave%neighbour, 1)
            other = slave%neighbour(k, i)
            if (other == 0) cycle
            if (piece(other) > 0) cycle
            if (edge_cosine(slave, side, i, k, other) < corner_cosine) cycle
            n = n + 1
            waiting(n) = other
            piece(other) = number
         end do
      end do
   end subroutine spread_from

   !> Of the normals on both sides of an edge, mean over its ends; in the plane at the one node.
   pure real(wp) function edge_cosine(slave, side, facet, edge, other) result(cosine)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: side(:, :, :)
      integer, intent(in) :: facet, edge, other
      integer :: k, n, ends, at

      n = slave%basis%ncorner(slave%facets%cell(facet))
      ends = merge(1, 2, slave%ndim == 2)
      cosine = 0.0_wp
      do k = edge, edge + ends - 1
         associate (own => 1 + mod(k - 1, n))
            at = findloc(slave%local(:, other), slave%local(own, facet), 1)
            cosine = cosine + dot_product(side(:, own, facet), side(:, at, other))/real(ends, wp)
         end associate
      end do
   end function edge_cosine

   !> One number for each node and piece, the nodes in their order.
   subroutine number_by_pieces(slave, piece)
      type(surface_type), intent(inout) :: slave
      integer, intent(in) :: piece(:)
      integer :: first(slave%nnode + 1), met(slave%nnode), local(8, slave%facets%n)
      integer :: i, k, n
      integer, allocatable :: node(:), of(:)

      met = 0
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            met(slave%local(k, i)) = met(slave%local(k, i)) + 1
         end do
      end do
      first(1) = 1
      do i = 1, slave%nnode
         first(i + 1) = first(i) + met(i)
      end do
      allocate (of(first(slave%nnode + 1) - 1))
      met = 0
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            associate (at => slave%local(k, i))
               n = findloc(of(first(at):first(at) + met(at) - 1), piece(i), 1)
               if (n == 0) then
                  met(at) = met(at) + 1
                  n = met(at)
                  of(first(at) + n - 1) = piece(i)
               end if
               local(k, i) = n
            end associate
         end do
      end do
      allocate (node(sum(met)))
      n = 0
      do i = 1, slave%nnode
         first(i) = n
         node(n + 1:n + met(i)) = slave%node(i)
         n = n + met(i)
      end do
      do i = 1, slave%facets%n
         k = slave%facets%nnode(i)
         local(:k, i) = local(:k, i) + first(slave%local(:k, i))
         local(k + 1:, i) = 0
      end do
      call renumber_nodes(slave, node, local)
   end subroutine number_by_pieces

   !> Normals at the nodes by pieces: the mean over the facets of each. On the axis the radial part
   !> vanishes by symmetry.
   pure subroutine piece_normals(slave, rules, x, axisymmetric, normal)
      type(surface_type), intent(in) :: slave
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)             !! (ndim, mesh nodes) present [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(out) :: normal(:, :)       !! (ndim, slave%nnode) outward, unit
      real(wp) :: side(size(x, 1), 8), axis
      integer :: i, k, n

      normal = 0.0_wp
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         call facet_sides(rules(slave%facets%cell(i))%cell, x(:, slave%facets%node(:n, i)), &
            & side(:, :n))
         do k = 1, n
            normal(:, slave%local(k, i)) = normal(:, slave%local(k, i)) + side(:, k)
         end do
      end do
      axis = -1.0_wp
      if (axisymmetric) axis = 1.0e-10_wp*maxval(abs(x(1, :)))
      do i = 1, slave%nnode
         if (abs(x(1, slave%node(i))) <= axis .and. abs(normal(2, i)) > 0.0_wp) &
            & normal(1, i) = 0.0_wp
         if (norm2(normal(:, i)) > 0.0_wp) normal(:, i) = normal(:, i)/norm2(normal(:, i))
      end do
   end subroutine piece_normals

   !> Areas of the nodes by pieces, in the transformed basis.
   pure subroutine whole_weights(slave, rules, x, axisymmetric, thickness, weight, share)
      type(surface_type), intent(in) :: slave
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)             !! (ndim, mesh nodes) [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness(:)        !! (slave facets) ones unless plane [length]
      real(wp), intent(out) :: weight(:)          !! (slave%nnode) [area]
      real(wp), intent(out) :: share(:)           !! (slave facets) middle_share of each
      real(wp) :: own(8)
      integer :: i, n

      weight = 0.0_wp
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         share(i) = middle_share(rules(slave%facets%cell(i)), x(:, slave%facets%node(:n, i)), &
            & axisymmetric)
         call facet_weights(rules(slave%facets%cell(i)), x(:, slave%facets%node(:n, i)), &
            & axisymmetric, own(:n), share(i))
         associate (at => slave%local(:n, i))
            weight(at) = weight(at) + thickness(i)*own(:n)
         end associate
      end do
   end subroutine whole_weights
end module lopin_slave_pieces
