!> What of a meshed master is inside the facets of its slave, or before them, in their present
!> places: places of the facets of the master, its nodes among them, are projected on the slave.
module lopin_master_entries
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_facet_basis, only : facet_point_of
   use lopin_projection, only : facet_unit_normal
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection
   use lopin_wall_depth, only : depths_of_facets
   use lopin_contact_points, only : facing
   implicit none
   private
   public :: entry_type, find_entries, width_of

   real(wp), parameter :: ahead = 1.0e-3_wp      !! of a facet
   real(wp), parameter :: thick = 0.5_wp         !! of a facet: deeper is another side of its body
   !> Places of a master facet in each direction, at most.
   integer, parameter :: most_parts = 8

   !> What of the master is opposite one facet of the slave.
   type :: entry_type
      real(wp) :: depth = 0.0_wp                 !! of the deepest place [length]
      real(wp) :: ahead(3) = 0.0_wp              !! just before the master there [length]
      real(wp) :: low(2) = huge(1.0_wp)          !! extent along its edges [length]
      real(wp) :: high(2) = -huge(1.0_wp)
      real(wp) :: area = 0.0_wp                  !! of the places opposite [length^(ndim-1)]
      real(wp) :: inside = 0.0_wp                !! volume of what is inside [length^ndim]
      real(wp) :: before = 0.0_wp                !! volume between both where it is not
   end type entry_type

contains

   !> How wide what goes into a facet is, its shorter way [length].
   pure real(wp) function width_of(self, ndim)
      type(entry_type), intent(in) :: self
      integer, intent(in) :: ndim
      width_of = minval(max(0.0_wp, self%high(:ndim - 1) - self%low(:ndim - 1)))
   end function width_of

   !> The deepest place of the master inside each facet of the slave, and how far the part that is
   !> inside extends.
   subroutine find_entries(slave, master, x, limit, shift, entry)
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(in) :: limit            !! deeper is the other side of a thin body [length]
      real(wp), intent(in) :: shift(:)         !! (nnode) added to the gaps of nodes, those of
                                               !! facets between them by their shape [length]
      type(entry_type), intent(inout) :: entry(:)      !! (slave facets)
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(projection_type) :: found
      real(wp) :: at(3), normal(3), xi(2), low(3), high(3), reach, typical, wall(slave%facets%n)
      integer :: i, a, b, parts, d

      d = slave%ndim
      call build_tree(tree, slave%low, slave%high)
      call depths_of_facets(slave, wall)
      limits%cosine = facing
      limits%extension = 0.0_wp
      low = minval(slave%low, 2)
      high = maxval(slave%high, 2)
      reach = norm2(high - low)
      low = low - reach
      high = high + reach
      typical = minval(slave%size)
      do i = 1, master%facets%n
         if (any(master%low(:, i) > high) .or. any(master%high(:, i) < low)) cycle
         associate (cell => master%facets%cell(i), basis => master%basis)
            parts = 2*min(most_parts/2, max(1, ceiling(master%size(i)/typical)))
            do a = 0, parts
               do b = 0, merge(0, parts, d == 2)
                  if (basis%family(cell) == cell_family%triangle .and. a + b > parts) cycle
                  xi = real([a, b], wp)/parts
                  if (basis%family(cell) /= cell_family%triangle) xi = 2.0_wp*xi - 1.0_wp
                  if (d == 2) xi(2) = 0.0_wp
                  at = facet_point_of(master%coefficient(:, :, i), xi)
                  if (any(at > high) .or. any(at < low)) cycle
                  normal = facet_unit_normal(master%coefficient(:, :, i), basis%family(cell), xi)
                  call find_projection(slave, tree, at(:d), normal(:d), limits, found)
                  if (found%facet == 0) cycle
                  if (dot_product(found%normal, normal) > facing) cycle
                  if (found%gap < -wall(found%facet)) cycle
                  if (-found%gap < min(limit, thick*slave%size(found%facet))) call add_volume( &
                     & entry(found%facet), found%gap + between(slave, found, shift), &
                     & (master%size(i)/parts)**(d - 1))
                  if (found%gap < 0.0_wp) call take_place(entry(found%facet), slave, found, x, at, &
                     & normal)
               end do
            end do
         end associate
      end do
   end subroutine find_entries

   !> A value of nodes at the foot of a projection.
   pure real(wp) function between(slave, foot, nodal) result(value)
      type(surface_type), intent(in) :: slave
      type(projection_type), intent(in) :: foot
      real(wp), intent(in) :: nodal(:)         !! (nnode)

      associate (n => slave%facets%nnode(foot%facet))
         value = dot_product(foot%shape(:n), nodal(slave%facets%node(:n, foot%facet)))
      end associate
   end function between

   !> A place of the master stands for some of its area.
   pure subroutine add_volume(self, gap, area)
      type(entry_type), intent(inout) :: self
      real(wp), intent(in) :: gap              !! [length]
      real(wp), intent(in) :: area             !! [length^(ndim-1)]

      self%area = self%area + area
      self%inside = self%inside + max(0.0_wp, -gap)*area
      self%before = self%before + max(0.0_wp, gap)*area
   end subroutine add_volume

   subroutine take_place(self, slave, found, x, at, normal)
      type(entry_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      type(projection_type), intent(in) :: found
      real(wp), intent(in) :: x(:, :), at(3), normal(3)   !! of the master
      real(wp) :: way(size(x, 1)), along
      integer :: k

      associate (node => slave%facets%node(:, found%facet), d => size(x, 1))
         do k = 1, d - 1
            way = x(:, node(k + 1)) - x(:, node(k))
            along = dot_product(at(:d) - x(:, node(k)), way)/norm2(way)
            self%low(k) = min(self%low(k), along)
            self%high(k) = max(self%high(k), along)
         end do
      end associate
      if (-found%gap <= self%depth) return
      self%depth = -found%gap
      self%ahead = at + ahead*slave%size(found%facet)*normal
   end subroutine take_place
end module lopin_master_entries
