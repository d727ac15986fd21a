!> Ribs of meshed masters that a single node of the slave meets: collocated there they press as if
!> over a whole facet, however narrow they are.
!>
!> Looked at where a step ends, on the present shape: places along the edges that leave a closed
!> node are projected on the master, until it leaves the plane in which it meets the node.
module lopin_narrow_ribs
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_facet_basis, only : facet_point_of
   use lopin_projection, only : facet_unit_normal
   use lopin_surface, only : surface_type
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection
   use lopin_wall_depth, only : depths_of_facets
   use lopin_model, only : model_type
   use lopin_flat_elements, only : is_ring
   use lopin_contact_points, only : facing
   use lopin_scene, only : scene_type
   use lopin_touched_width, only : touch_type, find_closed, number_closed, find_narrowest, &
      & say_narrow, left, most_edges, steps
   implicit none
   private
   public :: check_narrow_ribs

   !> Of a facet: so far past the master's rim a place is still opposite, as where a pressed body
   !> bulges.
   real(wp), parameter :: beyond = 0.05_wp

   !> The master and what finds places on it.
   type :: opposite_type
      type(surface_type) :: surface
      type(tree_type) :: tree
      type(limits_type) :: limits
   end type opposite_type

contains

   !> A closed node opposite a part of the master that is narrower than a facet.
   subroutine check_narrow_ribs(scene, model, pair, slave, master, x)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) present places [length]
      type(touch_type), allocatable :: touch(:)
      type(opposite_type) :: opposite
      logical :: closed(size(x, 2))
      integer :: place(size(x, 2)), worst
      real(wp) :: least

      call find_closed(scene, pair, closed)
      if (.not. any(closed)) return
      call number_closed(closed, touch, place)
      opposite%surface = master
      call build_tree(opposite%tree, master%low, master%high)
      opposite%limits%cosine = facing
      opposite%limits%extension = beyond
      call follow_edges(touch, place, slave, x, opposite)
      call find_narrowest(touch, place, is_ring(model, model%pair(pair)%slave), x, &
         & worst, least)
      if (worst == 0) return
      associate (p => model%pair(pair))
         call say_narrow(scene%log, model, pair, worst, least, 'W0339', 'facets of '// &
            & model%surface(p%slave)%name//' half as long as '//model%surface(p%master)%name// &
            & ' is wide there, or exchange slave and master')
      end associate
   end subroutine check_narrow_ribs

   !> How far the master stays in the plane that a closed node meets, along every edge from there.
   subroutine follow_edges(touch, place, slave, x, opposite)
      type(touch_type), intent(inout) :: touch(:)
      integer, intent(in) :: place(:)          !! (nnode) in `touch`; 0: open
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: x(:, :)
      type(opposite_type), intent(in) :: opposite
      type(facet_rule_type), allocatable :: rules(:)
      real(wp) :: wall(slave%facets%n)
      integer :: i, k, a, b

      allocate (rules(6))
      call new_facet_rules(rules)
      call depths_of_facets(slave, wall)
      do i = 1, slave%facets%n
         associate (cell => rules(slave%facets%cell(i))%cell, &
            & node => slave%facets%node(:slave%facets%nnode(i), i))
            if (all(place(node) == 0)) cycle
            do k = 1, merge(1, cell%ncorner, size(x, 1) == 2)
               a = cell%edge(1, k)
               b = cell%edge(2, k)
               if (place(node(a)) > 0) call follow(touch(place(node(a))), slave, i, cell, a, b, &
                  & opposite, wall(i))
               if (place(node(b)) > 0) call follow(touch(place(node(b))), slave, i, cell, b, a, &
                  & opposite, wall(i))
            end do
         end associate
      end do
   end subroutine follow_edges

   subroutine follow(self, slave, facet, cell, from, to, opposite, wall)
      type(touch_type), intent(inout) :: self
      type(surface_type), intent(in) :: slave
      integer, intent(in) :: facet, from, to   !! corners of the facet
      type(cell_type), intent(in) :: cell
      type(opposite_type), intent(in) :: opposite
      real(wp), intent(in) :: wall             !! of the facet: deeper is no contact [length]
      type(limits_type) :: limits
      type(projection_type) :: found
      real(wp) :: origin(3), way(3), normal(3), start, t, long
      integer :: j

      if (self%n == most_edges) return
      limits = opposite%limits
      limits%depth = wall
      call look(0.0_wp, origin, found)
      if (found%facet == 0) return
      start = found%gap
      normal = found%normal
      call look(1.0_wp, way, found)
      way = way - origin
      long = norm2(way)
      self%n = self%n + 1
      self%length(self%n) = long
      self%way(:, self%n) = way/long
      do j = 1, steps
         t = real(j, wp)/steps
         call look(t, origin, found)
         if (found%facet == 0) then
            ! Beyond the end of the master; a wall would be `left` only farther on.
            self%ends(self%n) = .true.
            self%flat(self%n) = min(long, self%flat(self%n) + left*long)
         else
            self%ends(self%n) = found%gap > start + t*dot_product(normal, way) + left*long
         end if
         if (self%ends(self%n)) exit
         self%flat(self%n) = t*long
      end do

   contains

      !> A place on the edge, and what lies opposite.
      subroutine look(t, at, found)
         real(wp), intent(in) :: t             !! 0 at the node, 1 at the other corner
         real(wp), intent(out) :: at(3)        !! [length]
         type(projection_type), intent(out) :: found
         real(wp) :: xi(2), n(3)

         xi = 0.0_wp
         xi(:slave%ndim - 1) = (1.0_wp - t)*cell%xi(:slave%ndim - 1, from) &
            & + t*cell%xi(:slave%ndim - 1, to)
         at = facet_point_of(slave%coefficient(:, :, facet), xi)
         n = facet_unit_normal(slave%coefficient(:, :, facet), &
            & slave%basis%family(slave%facets%cell(facet)), xi)
         call find_projection(opposite%surface, opposite%tree, at(:slave%ndim), n(:slave%ndim), &
            & limits, found)
      end subroutine look
   end subroutine follow
end module lopin_narrow_ribs
