!> The nodal forces of a uniform pressure between two surfaces, as their shape functions share it.
!>
!> Slave facets are sampled, and each sample finds the master facet opposite: what the master does
!> not cover carries nothing.
module lopin_uniform_pressure
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_facet_basis, only : shape_values, facet_point_of, facet_tangents
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection
   use lopin_wall_depth, only : depths_of_facets
   use lopin_surface, only : surface_type
   implicit none
   private
   public :: share_pressure

   !> Samples of a slave facet, in each direction: this many a master facet, and bounds of it.
   integer, parameter :: a_facet = 6, fewest(2) = [8, 6], most(2) = [64, 12]

contains

   !> Of the slave facets in the list. Forces are those on the nodes of both, per unit of pressure.
   subroutine share_pressure(slave, facet, master, axisymmetric, force, area, opposite)
      type(surface_type), intent(in) :: slave, master   !! of the present shape
      integer, intent(in) :: facet(:)                  !! facets of the slave
      logical, intent(in) :: axisymmetric
      real(wp), intent(inout) :: force(:, :)   !! (ndim, mesh nodes) they are added to [length^2]
      real(wp), intent(out) :: area(:)         !! (slave%nnode) of facets that meet some
      logical, intent(out) :: opposite(:)      !! (master%facets%n) facets that are met
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(projection_type) :: found
      real(wp), allocatable :: xi(:, :), weight(:), x(:, :), normal(:, :)
      real(wp) :: n(8), whole(8), finest, wall(slave%facets%n)
      logical :: meets
      integer :: i, k, count_

      area = 0.0_wp
      opposite = .false.
      call build_tree(tree, master%low, master%high)
      call depths_of_facets(slave, wall)
      limits%extension = 1.0e-6_wp
      finest = minval(master%size)
      do i = 1, size(facet)
         associate (cell => slave%facets%cell(facet(i)), nodes => slave%facets%nnode(facet(i)), &
            & at => slave%local(:slave%facets%nnode(facet(i)), facet(i)))
            count_ = min(most(slave%ndim - 1), max(fewest(slave%ndim - 1), &
               & ceiling(min(1.0e3_wp, slave%size(facet(i))/finest)*a_facet)))
            call place_samples(slave%basis%family(cell), count_, xi, weight)
            call check_samples(slave, facet(i), axisymmetric, xi, weight, x, normal)
            whole = 0.0_wp
            meets = .false.
            limits%depth = wall(facet(i))
            do k = 1, size(weight)
               n = shape_values(slave%basis, cell, xi(:, k))
               whole(:nodes) = whole(:nodes) + weight(k)*n(:nodes)
               call find_projection(master, tree, x(:, k), normal(:, k), limits, found)
               if (found%facet == 0) cycle
               meets = .true.
               opposite(found%facet) = .true.
               call add(slave, facet(i), weight(k)*n, found%normal)
               call add(master, found%facet, -weight(k)*found%shape, found%normal)
            end do
            if (meets) area(at) = area(at) + whole(:nodes)
         end associate
      end do

   contains

      subroutine add(surface, i, share, normal)
         type(surface_type), intent(in) :: surface
         integer, intent(in) :: i
         real(wp), intent(in) :: share(:), normal(:)
         integer :: j

         do j = 1, surface%facets%nnode(i)
            associate (node => surface%facets%node(j, i))
               force(:, node) = force(:, node) + share(j)*normal(:slave%ndim)
            end associate
         end do
      end subroutine add
   end subroutine share_pressure

   !> Middles of equal parts of a cell, and the parts' sizes in its coordinates.
   pure subroutine place_samples(family, n, xi, weight)
      integer, intent(in) :: family            !! cell_family%...
      integer, intent(in) :: n                 !! in each direction
      real(wp), allocatable, intent(out) :: xi(:, :), weight(:)
      real(wp) :: third
      integer :: i, j, k

      if (family == cell_family%line) then
         allocate (xi(2, n), source=0.0_wp)
         xi(1, :) = [((2*i - 1)/real(n, wp) - 1.0_wp, i=1, n)]
         weight = spread(2.0_wp/n, 1, n)
         return
      end if
      allocate (xi(2, n*n))
      k = 0
      do j = 1, n
         do i = 1, n
            if (family /= cell_family%triangle) then
               k = k + 1
               xi(:, k) = [2*i - 1, 2*j - 1]/real(n, wp) - 1.0_wp
               cycle
            end if
            if (i + j > n + 1) cycle
            third = 1.0_wp/3.0_wp
            k = k + 1
            xi(:, k) = ([i, j] - 1.0_wp + third)/n
            if (i + j > n) cycle
            k = k + 1
            xi(:, k) = ([i, j] - third)/n
         end do
      end do
      weight = spread(merge(0.5_wp, 4.0_wp, family == cell_family%triangle)/n**2, 1, n*n)
   end subroutine place_samples

   !> Where the samples of a facet are, its normal there, and their areas.
   pure subroutine check_samples(slave, facet, axisymmetric, xi, weight, x, normal)
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: facet
      logical, intent(in) :: axisymmetric
      real(wp), intent(in) :: xi(:, :)
      real(wp), intent(inout) :: weight(:)     !! in: of the cell; out: areas
      real(wp), allocatable, intent(out) :: x(:, :), normal(:, :)   !! (3, samples)
      real(wp) :: t1(3), t2(3), area
      integer :: k

      allocate (x(3, size(weight)))
      normal = spread(slave%disc(4:6, facet), 2, size(weight))
      associate (c => slave%coefficient(:, :, facet))
         do k = 1, size(weight)
            x(:, k) = facet_point_of(c, xi(:, k))
            call facet_tangents(c, xi(:, k), t1, t2)
            area = norm2(t1)
            if (slave%ndim == 3) area = norm2([t1(2)*t2(3) - t1(3)*t2(2), &
               & t1(3)*t2(1) - t1(1)*t2(3), t1(1)*t2(2) - t1(2)*t2(1)])
            weight(k) = weight(k)*area
            if (axisymmetric) weight(k) = weight(k)*x(1, k)
         end do
      end associate
   end subroutine check_samples
end module lopin_uniform_pressure
