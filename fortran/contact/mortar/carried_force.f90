!> Consistency of pressures and nodal forces: point pressures, interpolated and integrated, against
!> the forces on the points.
module lopin_carried_force
   use lopin_kinds, only : wp
   use lopin_facets, only : facets_type, facet_rule_type, facet_weights
   use lopin_facet_sides, only : facet_sides
   implicit none
   private
   public :: skin_type, find_pieces, piece_areas, field_areas, lost_force

   !> Faces of a slave, and what it is known of them from the start.
   type :: skin_type
      logical :: in_use = .false.
      logical :: axisymmetric = .false.
      logical :: integrated = .false.          !! points know how much of their area is covered
      type(facets_type) :: facets
      type(facet_rule_type), allocatable :: rules(:)
      real(wp), allocatable :: thickness(:)    !! (facets) ones unless plane [length]
      real(wp), allocatable :: share(:)        !! (facets) middle_share of each
      integer, allocatable :: piece(:)         !! (facets) smooth piece, lopin_slave_pieces
      logical :: is_sharp = .false.            !! there are several
   end type skin_type

contains

   !> Areas of points by the facets of their smooth pieces; 0: no point.
   subroutine piece_areas(self, x, node, piece, area)
      type(skin_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) present places [length]
      integer, intent(in) :: node(:)           !! (n) of the points; those of one node side by side
      integer, intent(in) :: piece(:)          !! (n) from find_pieces
      real(wp), intent(out) :: area(:)         !! (n) [length^2]
      integer :: at(8, self%facets%n)
      real(wp) :: own(8, self%facets%n), full(0:size(node))

      call find_points(self, size(x, 2), node, piece, at)
      call add_facets(self, x, at, own, full)
      area = full(1:)
      call share_areas(node, piece, area)
   end subroutine piece_areas

   !> The area by which the pressure at each point acts, if its values are interpolated by the shape
   !> functions of the facets: forces are pressure times area.
   !>
   !> Rows of mid-side nodes have the areas of a transformed basis (middle_share). Of a uniform
   !> pressure its forces are the same; else they differ by how far mid-side nodes stand out from
   !> the ends of their edges. That is counted where all is pressed: at the rim, facets of which one
   !> side is pressed say nothing of what lies between.
   !>
   !> Points on the rim have a pressure that is a mean over open area too. So a facet that has one
   !> says how coarse the mesh is, not that the rows are wrong; the second answer is without these.
   subroutine field_areas(self, x, node, normal, pressure, covered, area)
      type(skin_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) present places [length]
      integer, intent(in) :: node(:)           !! (n) as in piece_areas
      real(wp), intent(in) :: normal(:, :)     !! (ndim, n)
      real(wp), intent(in) :: pressure(:)      !! (n) [stress]
      real(wp), intent(in) :: covered(:)       !! (n) of `integrated`: area of the row; 0: no row
      real(wp), intent(out) :: area(:, :)      !! (n, 2) by all facets, by those within [length^2]
      integer :: at(8, self%facets%n), piece(size(node)), i
      logical :: bare(0:size(node)), rim(0:size(node))
      real(wp) :: own(8, self%facets%n), full(0:size(node)), ratio(size(node))

      call find_pieces(self, x, node, normal, covered > 0.0_wp, piece)
      call find_points(self, size(x, 2), node, piece, at, pressure)
      call add_facets(self, x, at, own, full)
      area(:, 1) = full(1:)
      call share_areas(node, piece, area(:, 1))
      if (self%integrated) area(:, 1) = covered
      area(:, 2) = area(:, 1)
      if (.not. any(self%share > 0.0_wp)) return
      call find_bare(self, at, pressure, bare)
      call find_rim(self, at, bare, rim)
      ratio = area(:, 2)/max(full(1:), tiny(1.0_wp))
      do i = 1, self%facets%n
         associate (points => at(:self%facets%nnode(i), i))
            if (.not. self%share(i) > 0.0_wp .or. any(bare(points))) cycle
            call add_middles(self, i, points, own(:, i), ratio, area(:, 1))
            if (.not. any(rim(points))) call add_middles(self, i, points, own(:, i), ratio, &
               & area(:, 2))
         end associate
      end do
   end subroutine field_areas

   !> Areas of the nodes of each facet, and of all facets of each point.
   pure subroutine add_facets(self, x, at, own, full)
      type(skin_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: at(:, :)          !! (8, facets) points of their nodes; 0: none
      real(wp), intent(out) :: own(:, :)       !! (8, facets) [length^2]
      real(wp), intent(out) :: full(0:)        !! (points) [length^2]
      integer :: i, k, m

      full = 0.0_wp
      do i = 1, self%facets%n
         m = self%facets%nnode(i)
         call facet_weights(self%rules(self%facets%cell(i)), x(:, self%facets%node(:m, i)), &
            & self%axisymmetric, own(:m, i), self%share(i))
         own(:m, i) = self%thickness(i)*own(:m, i)
         do k = 1, m
            full(at(k, i)) = full(at(k, i)) + own(k, i)
         end do
      end do
   end subroutine add_facets

   !> Of each point the smooth piece that faces best what presses its node; 0: nothing does.
   pure subroutine find_pieces(self, x, node, normal, present, piece)
      type(skin_type), intent(in) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) present places [length]
      integer, intent(in) :: node(:)           !! (n) of the points; those of one node side by side
      real(wp), intent(in) :: normal(:, :)     !! (ndim, n) out of the master
      logical, intent(in) :: present(:)        !! (n) a master is opposite
      integer, intent(out) :: piece(:)         !! (n)
      integer :: first(size(x, 2)), i, k, m, p
      real(wp) :: best(size(node)), side(size(x, 1), 8), cosine

      first = first_points(size(x, 2), node)
      best = huge(1.0_wp)
      piece = 0
      do i = 1, self%facets%n
         m = self%facets%nnode(i)
         call facet_sides(self%rules(self%facets%cell(i))%cell, x(:, self%facets%node(:m, i)), &
            & side(:, :m))
         do k = 1, m
            p = first(self%facets%node(k, i))
            do while (p > 0)
               cosine = dot_product(normal(:, p), side(:, k))
               if (present(p) .and. cosine < best(p)) then
                  best(p) = cosine
                  piece(p) = self%piece(i)
               end if
               p = next_point(node, p)
            end do
         end do
      end do
   end subroutine find_pieces

   !> Points of one node against several walls press on the same facets.
   pure subroutine share_areas(node, piece, area)
      integer, intent(in) :: node(:), piece(:)   !! (n) as in piece_areas
      real(wp), intent(inout) :: area(:)         !! (n) [length^2]
      integer :: i, p

      do i = 1, size(node)
         p = next_point(node, i)
         do while (p > 0)
            if (piece(p) == piece(i)) then
               area(i) = max(area(i), area(p))
               area(p) = area(i)
            end if
            p = next_point(node, p)
         end do
      end do
   end subroutine share_areas

   !> The points that stand at the nodes of each facet; 0: none. Of several, the one most pressed.
   pure subroutine find_points(self, nnode, node, piece, at, pressure)
      type(skin_type), intent(in) :: self
      integer, intent(in) :: nnode             !! of the mesh
      integer, intent(in) :: node(:), piece(:)
      integer, intent(out) :: at(:, :)         !! (8, facets)
      real(wp), intent(in), optional :: pressure(:)
      integer :: first(nnode), i, k, p

      first = first_points(nnode, node)
      at = 0
      do i = 1, self%facets%n
         do k = 1, self%facets%nnode(i)
            p = first(self%facets%node(k, i))
            do while (p > 0)
               if (piece(p) == self%piece(i)) at(k, i) = more_pressed(at(k, i), p, pressure)
               p = next_point(node, p)
            end do
         end do
      end do
   end subroutine find_points

   !> Of two points the one that is pressed more; the later one where pressures are not given.
   pure integer function more_pressed(one, other, pressure) result(point)
      integer, intent(in) :: one, other        !! points; one = 0: none
      real(wp), intent(in), optional :: pressure(:)

      point = other
      if (one == 0 .or. .not. present(pressure)) return
      if (.not. abs(pressure(other)) > abs(pressure(one))) point = one
   end function more_pressed

   !> The first point of each mesh node; 0: none.
   pure function first_points(nnode, node) result(first)
      integer, intent(in) :: nnode, node(:)
      integer :: first(nnode), i

      first = 0
      do i = size(node), 1, -1
         first(node(i)) = i
      end do
   end function first_points

   !> The next point of the same node.
   pure integer function next_point(node, p)
      integer, intent(in) :: node(:), p

      next_point = 0
      if (p == size(node)) return
      if (node(p + 1) == node(p)) next_point = p + 1
   end function next_point

   !> Points that are not pressed, nor all of their neighbours along edges; 0 is one.
   pure subroutine find_bare(self, at, pressure, bare)
      type(skin_type), intent(in) :: self
      integer, intent(in) :: at(:, :)          !! (8, facets) points of their nodes
      real(wp), intent(in) :: pressure(:)
      logical, intent(out) :: bare(0:)
      logical :: pressed(0:size(pressure))
      integer :: i, k

      pressed(0) = .false.
      pressed(1:) = abs(pressure) > 0.0_wp
      bare = .false.
      bare(0) = .true.
      do i = 1, self%facets%n
         associate (cell => self%rules(self%facets%cell(i))%cell)
            do k = 1, cell%nnode - cell%ncorner
               call look_at_edge(at(cell%ncorner + k, i), at(cell%edge(:, k), i), bare)
            end do
         end associate
      end do

   contains

      pure subroutine look_at_edge(middle, ends, bare)
         integer, intent(in) :: middle, ends(:)
         logical, intent(inout) :: bare(0:)
         integer :: m

         do m = 1, 2
            if (pressed(middle) .or. pressed(ends(m))) cycle
            bare([middle, ends(m)]) = .true.
         end do
      end subroutine look_at_edge
   end subroutine find_bare

   !> Points of facets that have a bare point.
   pure subroutine find_rim(self, at, bare, rim)
      type(skin_type), intent(in) :: self
      integer, intent(in) :: at(:, :)          !! (8, facets) points of their nodes
      logical, intent(in) :: bare(0:)
      logical, intent(out) :: rim(0:)
      integer :: i

      rim = .false.
      do i = 1, self%facets%n
         associate (points => at(:self%facets%nnode(i), i))
            if (any(bare(points))) rim(points) = .true.
         end associate
      end do
   end subroutine find_rim

   !> What the shape functions give mid-side nodes more, and the ends of their edges less, than the
   !> transformed basis.
   pure subroutine add_middles(self, facet, at, own, ratio, area)
      type(skin_type), intent(in) :: self
      integer, intent(in) :: facet, at(:)
      real(wp), intent(in) :: own(:)           !! areas of the transformed basis [length^2]
      real(wp), intent(in) :: ratio(:)         !! covered shares of the points
      real(wp), intent(inout) :: area(:)
      real(wp) :: more
      integer :: k

      associate (cell => self%rules(self%facets%cell(facet))%cell, s => self%share(facet))
         do k = 1, cell%nnode - cell%ncorner
            associate (middle => at(cell%ncorner + k), ends => at(cell%edge(:, k)))
               more = 2.0_wp*s/(1.0_wp - 2.0_wp*s)*own(cell%ncorner + k)*min(1.0_wp, ratio(middle))
               area(middle) = area(middle) + more
               area(ends(1)) = area(ends(1)) - 0.5_wp*more
               area(ends(2)) = area(ends(2)) - 0.5_wp*more
            end associate
         end do
      end associate
   end subroutine add_middles

   !> What pressures on areas lack of the forces on the points, beside these: the largest of the sum
   !> of magnitudes, the resultant, and its moment (over the reach of the points).
   pure real(wp) function lost_force(pressure, area, force, normal, x) result(lost)
      real(wp), intent(in) :: pressure(:), area(:)    !! (n) [stress], [length^2]
      real(wp), intent(in) :: force(:, :), normal(:, :), x(:, :)   !! (ndim, n)
      real(wp) :: push(size(area)), lack(size(area)), centre(size(x, 1)), total, reach
      real(wp) :: moment(3), arm(3), way(3)
      integer :: i, d

      lost = 0.0_wp
      d = size(x, 1)
      push = sum(force*normal, dim=1)
      total = sum(abs(push))
      if (.not. total > 0.0_wp) return
      lack = pressure*area - push
      centre = matmul(x, abs(push))/total
      moment = 0.0_wp
      arm = 0.0_wp
      way = 0.0_wp
      reach = 0.0_wp
      do i = 1, size(area)
         arm(:d) = x(:, i) - centre
         way(:d) = lack(i)*normal(:, i)
         reach = max(reach, norm2(arm))
         moment = moment + [arm(2)*way(3) - arm(3)*way(2), arm(3)*way(1) - arm(1)*way(3), &
            & arm(1)*way(2) - arm(2)*way(1)]
      end do
      lost = max(abs(sum(lack)), norm2(matmul(normal, lack)))/total
      if (reach > 0.0_wp) lost = max(lost, norm2(moment)/(total*reach))
   end function lost_force
end module lopin_carried_force
