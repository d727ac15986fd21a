!> A slave surface of the plane in smooth pieces, cut at its sharp corners.
!>
!> The mean of two normals at a right angle looks at no master: the top of a billet that a plate
!> presses would be projected aslant at its rim, and the side, which the plate does not see, would
!> seem to lie within it. So each piece has normals of its own, and at a corner one piece, the one
!> that faces its master best, integrates the row of the node: a row of every piece would tell the
!> node the same twice once the side has rolled onto the plate. Elsewhere the function of the node
!> goes to its neighbours.
module lopin_slave_pieces
   use lopin_kinds, only : wp
   use lopin_facets, only : facet_rule_type, facet_weights
   use lopin_surface, only : surface_type
   use lopin_mortar_overlap, only : overlap_list_type
   implicit none
   private
   public :: slave_pieces_type, new_slave_pieces, piece_normals, choose_owners, owner_normals
   public :: measure_cover, take_over, is_strong

   type :: slave_pieces_type
      integer, allocatable :: piece(:)         !! (slave facets) its number, from 1
      integer, allocatable :: owner(:)         !! (slave nodes) the piece that has its row
      real(wp), allocatable :: whole(:, :)     !! (3, slave facets) areas of its nodes [area]
      ! Present shape
      real(wp), allocatable :: full(:)         !! (slave nodes) area on its own piece [area]
      real(wp), allocatable :: ratio(:)        !! (slave nodes) covered share of it
      real(wp), allocatable :: best(:)         !! the largest share on the facets of each
   end type slave_pieces_type

   !> Facets whose normals turn by more at a node, 40 degrees, meet at a corner.
   real(wp), parameter :: corner_cosine = 0.766044443118978_wp
   !> Of two pieces that face alike, by cosine, the first owns the corner.
   real(wp), parameter :: alike = 0.01_wp
   !> A piece farther from its master than the nearest by this share of a facet does not own.
   real(wp), parameter :: apart = 0.25_wp
   !> A node covered less than this share of its best neighbour hands its row to its neighbours.
   real(wp), parameter :: weak = 0.05_wp

contains

   subroutine new_slave_pieces(self, slave, rules, x, axisymmetric, thickness)
      type(slave_pieces_type), intent(out) :: self
      type(surface_type), intent(in) :: slave
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)             !! (2, mesh nodes) at the start [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: thickness(:)        !! (slave facets) ones unless plane [length]
      integer :: i, n, number

      allocate (self%piece(slave%facets%n), self%owner(slave%nnode), source=0)
      allocate (self%whole(3, slave%facets%n), source=0.0_wp)
      number = 0
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         call facet_weights(rules(slave%facets%cell(i)), x(:, slave%facets%node(:n, i)), &
            & axisymmetric, self%whole(:n, i))
         self%whole(:n, i) = thickness(i)*self%whole(:n, i)
         if (self%piece(i) > 0) cycle
         number = number + 1
         call spread_from(self, slave, x, i, number)
      end do
      call give_to_first(self, slave)
   end subroutine new_slave_pieces

   !> Where nothing decides the first piece owns a node.
   pure subroutine give_to_first(self, slave)
      type(slave_pieces_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      integer :: i, k

      do i = slave%facets%n, 1, -1
         do k = 1, slave%facets%nnode(i)
            self%owner(slave%local(k, i)) = self%piece(i)
         end do
      end do
   end subroutine give_to_first

   !> Number a facet and all that continue it smoothly.
   subroutine spread_from(self, slave, x, first, number)
      type(slave_pieces_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: first, number
      integer :: waiting(slave%facets%n), n, i, k, j, other

      n = 1
      waiting(1) = first
      self%piece(first) = number
      do while (n > 0)
         i = waiting(n)
         n = n - 1
         do k = 1, 2
            associate (node => slave%local(k, i))
               do j = slave%ring_first(node), slave%ring_first(node + 1) - 1
                  other = slave%ring(j)
                  if (self%piece(other) > 0) cycle
                  if (dot_product(end_normal(slave, x, i, node), &
                     & end_normal(slave, x, other, node)) < corner_cosine) cycle
                  n = n + 1
                  waiting(n) = other
                  self%piece(other) = number
               end do
            end associate
         end do
      end do
   end subroutine spread_from

   !> Outward unit normal of a facet at one of its nodes.
   pure function end_normal(slave, x, facet, node) result(normal)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: facet, node          !! number of the node on the slave
      real(wp) :: normal(2), tangent(2), xi
      integer :: k

      associate (f => slave%facets)
         k = findloc(slave%local(:f%nnode(facet), facet), node, 1)
         tangent = x(:, f%node(2, facet)) - x(:, f%node(1, facet))
         if (f%nnode(facet) == 3) then
            xi = real(merge(2*k - 3, 0, k < 3), wp)
            tangent = 0.5_wp*tangent + xi*(x(:, f%node(1, facet)) + x(:, f%node(2, facet)) &
               & - 2.0_wp*x(:, f%node(3, facet)))
         end if
      end associate
      normal = [tangent(2), -tangent(1)]/max(tiny(1.0_wp), norm2(tangent))
   end function end_normal

   !> Normals at the nodes of every facet: the mean over the facets of its own piece.
   pure subroutine piece_normals(self, slave, x, axisymmetric, normal)
      type(slave_pieces_type), intent(in) :: self
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: x(:, :)             !! (2, mesh nodes) present [length]
      logical, intent(in) :: axisymmetric
      real(wp), intent(out) :: normal(:, :, :)    !! (2, 3, slave facets) outward, unit
      real(wp) :: own(2), axis
      integer :: i, k, j, other

      axis = -1.0_wp
      if (axisymmetric) axis = 1.0e-10_wp*maxval(abs(x(1, :)))
      normal = 0.0_wp
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            associate (node => slave%local(k, i))
               own = 0.0_wp
               if (k > 2) own = end_normal(slave, x, i, node)
               do j = slave%ring_first(node), slave%ring_first(node + 1) - 1
                  other = slave%ring(j)
                  if (self%piece(other) == self%piece(i)) own = own &
                     & + end_normal(slave, x, other, node)
               end do
               if (abs(x(1, slave%node(node))) <= axis .and. abs(own(2)) > 0.0_wp) own(1) = 0.0_wp
            end associate
            if (norm2(own) > 0.0_wp) normal(:, k, i) = own/norm2(own)
         end do
      end do
   end subroutine piece_normals

   !> At each corner: of the pieces near a master there, the one that faces it best.
   subroutine choose_owners(self, slave, master, list, normal, x)
      type(slave_pieces_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave, master
      type(overlap_list_type), intent(in) :: list
      real(wp), intent(in) :: normal(:, :, :)     !! from piece_normals
      real(wp), intent(in) :: x(:, :)             !! (2, mesh nodes) present [length]
      real(wp) :: nearest(slave%nnode), cosine(slave%nnode), away, own, way(2)
      integer :: pass, i, k, node

      call give_to_first(self, slave)
      nearest = huge(1.0_wp)
      cosine = huge(1.0_wp)
      do pass = 1, 2
         do i = 1, list%n
            associate (o => list%item(i), f => slave%facets, m => master%facets)
               way = x(:, m%node(2, o%master)) - x(:, m%node(1, o%master))
               do k = 1, 2
                  if (.not. o%d(k) > 0.0_wp) cycle
                  node = slave%local(k, o%slave)
                  away = abs(o%gap(k))/o%d(k)
                  if (pass == 1) then
                     nearest(node) = min(nearest(node), away)
                     cycle
                  end if
                  if (away > nearest(node) + apart*slave%size(o%slave)) cycle
                  own = (normal(1, k, o%slave)*way(2) - normal(2, k, o%slave)*way(1))/norm2(way)
                  if (own > cosine(node) - alike) cycle
                  cosine(node) = own
                  self%owner(node) = self%piece(o%slave)
               end do
            end associate
         end do
      end do
   end subroutine choose_owners

   !> The normal of each node on the piece that owns it.
   pure function owner_normals(self, slave, normal) result(own)
      type(slave_pieces_type), intent(in) :: self
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: normal(:, :, :)     !! from piece_normals
      real(wp) :: own(2, slave%nnode)
      integer :: i, k

      own = 0.0_wp
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            if (owns(self, slave%local(k, i), i)) own(:, slave%local(k, i)) = normal(:, k, i)
         end do
      end do
   end function owner_normals

   !> Which share of each node is covered on its own piece, and of its best neighbour there.
   subroutine measure_cover(self, slave, list)
      type(slave_pieces_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      type(overlap_list_type), intent(in) :: list
      real(wp) :: best
      integer :: i, k, n

      self%full = spread(0.0_wp, 1, slave%nnode)
      self%ratio = self%full
      do i = 1, slave%facets%n
         do k = 1, slave%facets%nnode(i)
            associate (node => slave%local(k, i))
               if (owns(self, node, i)) self%full(node) = self%full(node) + self%whole(k, i)
            end associate
         end do
      end do
      do i = 1, list%n
         associate (o => list%item(i))
            do k = 1, slave%facets%nnode(o%slave)
               associate (node => slave%local(k, o%slave))
                  if (owns(self, node, o%slave)) self%ratio(node) = self%ratio(node) &
                     & + o%d(k)/self%full(node)
               end associate
            end do
         end associate
      end do
      self%best = self%ratio
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         best = 0.0_wp
         do k = 1, n
            associate (node => slave%local(k, i))
               if (owns(self, node, i)) best = max(best, self%ratio(node))
            end associate
         end do
         do k = 1, n
            associate (node => slave%local(k, i))
               if (owns(self, node, i)) self%best(node) = max(self%best(node), best)
            end associate
         end do
      end do
   end subroutine measure_cover

   !> The row of a node is integrated on this facet.
   pure logical function owns(self, node, facet)
      type(slave_pieces_type), intent(in) :: self
      integer, intent(in) :: node, facet
      owns = self%owner(node) == self%piece(facet)
   end function owns

   !> Nodes whose functions this one takes over, in equal parts with their other strong neighbours:
   !> hardly covered ones, and corners on the pieces that do not own them.
   subroutine take_over(self, slave, node, also, share, on)
      type(slave_pieces_type), intent(in) :: self
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: node                 !! number on the slave surface
      integer, allocatable, intent(out) :: also(:)
      real(wp), allocatable, intent(out) :: share(:)
      integer, allocatable, intent(out) :: on(:)  !! piece of the node's own function, then of these
      integer, allocatable :: heir(:)
      integer :: i, k, j, n

      also = [integer ::]
      share = [real(wp) ::]
      on = [self%owner(node)]
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         if (.not. any(slave%local(:n, i) == node)) cycle
         if (.not. owns(self, node, i)) cycle
         do k = 1, n
            j = slave%local(k, i)
            if (owns(self, j, i) .and. is_strong(self, j)) cycle
            if (any(also == slave%node(j))) cycle
            heir = heirs_of(self, slave, j, self%piece(i))
            if (.not. any(heir == node)) cycle
            on = [on, self%piece(i)]
            also = [also, slave%node(j)]
            share = [share, 1.0_wp/real(size(heir), wp)]
         end do
      end do
   end subroutine take_over

   pure function heirs_of(self, slave, node, piece) result(heir)
      type(slave_pieces_type), intent(in) :: self
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: node, piece
      integer, allocatable :: heir(:)
      integer :: i, k, n

      heir = [integer ::]
      do i = 1, slave%facets%n
         n = slave%facets%nnode(i)
         if (.not. any(slave%local(:n, i) == node)) cycle
         if (self%piece(i) /= piece) cycle
         do k = 1, n
            associate (j => slave%local(k, i))
               if (j == node .or. .not. owns(self, j, i)) cycle
               if (is_strong(self, j) .and. .not. any(heir == j)) heir = [heir, j]
            end associate
         end do
      end do
   end function heirs_of

   pure logical function is_strong(self, node)
      type(slave_pieces_type), intent(in) :: self
      integer, intent(in) :: node
      is_strong = self%ratio(node) > weak*self%best(node)
   end function is_strong
end module lopin_slave_pieces
