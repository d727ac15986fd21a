!> The feature opposite a contact point on the present shape: a place on a master surface, or the
!> foot on a tool.
module lopin_closest_feature
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_family
   use lopin_surface, only : surface_type
   use lopin_projection, only : place, facet_unit_normal
   use lopin_smooth_facet, only : stencil_type, most_stencil, is_smoothed
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : cost_type, find_projection
   use lopin_tool, only : tool_type, foot_type
   use lopin_model, only : model_type
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_facet_hysteresis, only : keep_facet
   use lopin_contact_points, only : facing
   use lopin_master_surfaces, only : masters_type, master_type
   implicit none
   private
   public :: opposite_type, anchor_type, sample_foot_type, inner_foot_type, inner_row_type, &
      & find_opposite, anchor_of, cut_off

   !> Sine below which an arm is square to its facet.
   real(wp), parameter :: square = 1.0e-6_wp
   !> Of a facet: nodes of a surface that meets itself are behind it by less, where they do not
   !> press but are pressed upon, and facets cut off what lies between.
   real(wp), parameter :: cut_off = 0.1_wp

   !> What lies opposite another place that the row of a point samples, see lopin_row_samples.
   type :: sample_foot_type
      real(wp) :: c = 0.0_wp                       !! its part of the row
      integer :: node = 0
      type(foot_type) :: foot                      !! in the tool's frame
      logical :: continued = .false.               !! on the tangent plane of the point's own foot
   end type sample_foot_type

   !> What lies opposite a point inside a facet that meets a crease of the tool.
   type :: inner_foot_type
      real(wp) :: c = 0.0_wp                       !! its part of the row
      integer :: nnode = 0
      integer :: at(8) = 0                         !! nodes of the facet in the list of the row
      real(wp) :: shape(8) = 0.0_wp
      type(foot_type) :: foot                      !! in the tool's frame
   end type inner_foot_type

   !> All points inside facets of one row. Gaps to planes are linear in the places, and forces on
   !> planes have one direction each: of all points on planes, sum c N n of every node is enough.
   type :: inner_row_type
      real(wp) :: c = 0.0_wp                       !! their part of the row
      real(wp) :: soft = 0.0_wp   !! of the soft least gap, all points `bent`; 0: the mean [length]
      integer, allocatable :: node(:)              !! of these facets, the point's own first
      real(wp) :: gap = 0.0_wp                     !! of points on planes: sum of c gap [length]
      real(wp), allocatable :: normal(:, :)        !! (3, nodes) sum of c N n, in the tool's frame
      type(inner_foot_type), allocatable :: bent(:)   !! the others
   end type inner_row_type

   type :: opposite_type
      integer :: facet = 0                         !! 0: none
      integer :: feature = 0                       !! edge of the facet, if the foot is on one
      real(wp) :: normal(3) = 0.0_wp               !! in the present
      type(projection_type) :: found               !! on a surface
      logical :: kept = .false.                    !! on the facet that the point keeps
      logical :: past = .false.                    !! beyond its end
      type(foot_type) :: foot                      !! on a tool, in its frame
      integer :: nnode = 0                         !! nodes that shape the facet
      integer :: ncarry = 0                        !! the first of them carry it
      integer :: node(most_stencil) = 0
      type(stencil_type), allocatable :: stencil   !! of a smoothed facet
      integer :: cell = 0
      real(wp) :: size = 1.0_wp                    !! of the facet [length]
      type(sample_foot_type), allocatable :: sample(:)   !! the other places of the row
      type(inner_row_type), allocatable :: inner   !! those inside facets, lopin_nonlinear_faces
   end type opposite_type

   !> The material point of the master that friction measures slip from.
   type :: anchor_type
      logical :: set = .false.
      integer :: nnode = 0
      integer :: node(8) = 0
      real(wp) :: share(8) = 0.0_wp
      real(wp) :: y(3) = 0.0_wp                    !! in a tool's frame [length]
      real(wp) :: gap = 0.0_wp                     !! of the point then [length]
      real(wp) :: offset(3) = 0.0_wp   !! mean place of the row's samples less the point's, in the
                                       !! tool's frame where the increment began [length]
   end type anchor_type

contains

   subroutine find_opposite(self, masters, model, points, i, cost)
      type(opposite_type), intent(out) :: self
      type(masters_type), intent(in) :: masters
      type(model_type), intent(in) :: model
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      type(cost_type), intent(inout) :: cost
      type(limits_type) :: limits

      associate (m => masters%of(points%pair(i)), x => masters%x(:, points%node(i)))
         if (m%tool > 0) then
            call find_on_tool(self, m, model, masters%side(:, i), points%size(i), points%entry(i), &
               & parts_of(masters, points, i), x)
         else if (.not. m%asleep) then
            if (m%against_itself) then
               call find_on_itself(self, masters, points%pair(i), points%node(i), &
                  & masters%side(:model%mesh%ndim, i), i, points%size(i), cost)
            else
               limits = m%limits
               limits%depth = min(limits%depth, points%depth(i))
               call find_projection(m%surface, m%tree, x, masters%side(:model%mesh%ndim, i), &
                  & limits, self%found, cost=cost)
            end if
            associate (held => masters%owner%held(i))
               if (held > 0) call keep_facet(m%surface, held, x, &
                  & masters%side(:model%mesh%ndim, i), m%limits, self%found, self%kept, self%past)
            end associate
            call take_facet(self, m%surface)
            if (self%facet > 0) call mark_shared_edge(self, m%surface, x)
         end if
      end associate
   end subroutine find_opposite

   !> Neighbours are left out, and nothing is entered deeper than half of the point's own wall, or
   !> than point and place have moved beside each other since the increment began.
   subroutine find_on_itself(self, masters, pair, node, side, i, size_, cost)
      type(opposite_type), intent(inout) :: self
      type(masters_type), intent(in) :: masters
      integer, intent(in) :: pair, node
      real(wp), intent(in) :: side(:)
      integer, intent(in) :: i
      real(wp), intent(in) :: size_            !! of the point's facets [length]
      type(cost_type), intent(inout) :: cost
      type(limits_type) :: limits
      real(wp) :: moved(size(side)), bound
      integer :: k

      associate (m => masters%of(pair), x => masters%x, start => masters%start_x)
         k = i - m%first_point + 1
         limits = m%limits
         limits%depth = min(limits%depth, m%itself%depth(k))
         associate (around => m%itself%neighbour(m%itself%first(k):m%itself%first(k + 1) - 1))
            call find_projection(m%surface, m%tree, x(:, node), side, limits, self%found, around, &
               & cost)
            if (self%found%facet == 0 .or. self%found%gap >= 0.0_wp) return
            associate (n => m%surface%facets%nnode(self%found%facet))
               associate (of => m%surface%facets%node(:n, self%found%facet))
                  moved = x(:, node) - start(:, node) - matmul(x(:, of) - start(:, of), &
                     & self%found%shape(:n))
               end associate
            end associate
            bound = m%itself%entered(k) + cut_off*size_ + norm2(moved)
            if (-self%found%gap <= bound) return
            limits%depth = min(limits%depth, bound)
            call find_projection(m%surface, m%tree, x(:, node), side, limits, self%found, around, &
               & cost)
         end associate
      end associate
   end subroutine find_on_itself

   subroutine take_facet(self, surface)
      type(opposite_type), intent(inout) :: self
      type(surface_type), intent(in) :: surface

      self%facet = self%found%facet
      if (self%facet == 0) return
      self%normal = self%found%normal
      self%cell = surface%facets%cell(self%facet)
      self%nnode = surface%facets%nnode(self%facet)
      self%ncarry = self%nnode
      self%node(:self%nnode) = surface%facets%node(:self%nnode, self%facet)
      if (surface%smooth .and. is_smoothed(self%cell)) then
         self%stencil = surface%stencil(self%facet)
         self%nnode = self%stencil%n
         self%node = self%stencil%node
      end if
      self%size = surface%size(self%facet)
      if (self%found%place == place%edge) self%feature = edge_at(surface%basis%family(self%cell), &
         & self%found%xi)
   end subroutine take_facet

   !> Beyond the perimeter a foot may lie on an edge that two continued facets share: the arm is not
   !> square to the facet then, and the foot moves along that edge only.
   subroutine mark_shared_edge(self, surface, x)
      type(opposite_type), intent(inout) :: self
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(:)
      real(wp) :: arm(3), n(3)
      integer :: family

      if (self%found%place /= place%extended) return
      family = surface%basis%family(self%cell)
      arm = -self%found%point
      arm(:size(x)) = arm(:size(x)) + x
      n = facet_unit_normal(surface%coefficient(:, :, self%facet), family, self%found%xi)
      if (norm2(arm - dot_product(arm, n)*n) <= square*max(norm2(arm), square*self%size)) return
      self%found%place = merge(place%vertex, place%edge, family == cell_family%line)
      self%feature = edge_at(family, self%found%xi)
   end subroutine mark_shared_edge

   !> The edge of a cell that a point of its reference lies on.
   pure integer function edge_at(family, xi) result(edge)
      integer, intent(in) :: family
      real(wp), intent(in) :: xi(2)

      if (family == cell_family%triangle) then
         edge = minloc(abs([xi(2), 1.0_wp - xi(1) - xi(2), xi(1)]), 1)
      else
         edge = minloc(abs([xi(2) + 1.0_wp, xi(1) - 1.0_wp, xi(2) - 1.0_wp, xi(1) + 1.0_wp]), 1)
      end if
   end function edge_at

   !> Segments that the two points of a node met last; negative: the node has one point.
   pure function parts_of(masters, points, i) result(part)
      type(masters_type), intent(in) :: masters
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      integer :: part(2)

      part = -1
      if (.not. allocated(masters%part)) return
      if (points%entry(i) == 2) then
         part = masters%part(i - 1:i)
      else if (i < points%n) then
         if (points%entry(i + 1) == 2) part = masters%part(i:i + 1)
      end if
   end function parts_of

   !> Near a concave corner the feet come by distance, and the points keep their walls: whether the
   !> first foot belongs to the second point, because that is less far from where they were.
   pure logical function crossed(tool, part, feet, n)
      class(tool_type), intent(in) :: tool
      integer, intent(in) :: part(2)
      type(foot_type), intent(in) :: feet(2)
      integer, intent(in) :: n
      integer :: straight, cross, k

      crossed = .false.
      if (n == 0 .or. any(part < 0) .or. all(part == 0)) return
      straight = 0
      cross = 0
      do k = 1, n
         if (part(k) > 0) straight = straight + tool%apart(part(k), feet(k)%segment)
         if (part(3 - k) > 0) cross = cross + tool%apart(part(3 - k), feet(k)%segment)
      end do
      ! A point that met nothing yet does not take the only foot from one that did.
      if (n == 1 .and. part(1) == 0) straight = huge(1)
      if (n == 1 .and. part(2) == 0) cross = huge(1)
      crossed = cross < straight
   end function crossed

   !> A foot counts if it is not past the end of the tool and the slave faces it.
   subroutine find_on_tool(self, m, model, side, size_, entry, part, x)
      type(opposite_type), intent(inout) :: self
      type(master_type), intent(in) :: m
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: side(3), size_
      integer, intent(in) :: entry, part(2)
      real(wp), intent(in) :: x(:)
      type(foot_type) :: feet(2)
      real(wp) :: turned(3)
      integer :: n, d, which

      d = size(x)
      call model%tool(m%tool)%shape%project_all(m%motion%to_tool(x), size_, feet, n)
      which = entry
      if (crossed(model%tool(m%tool)%shape, part, feet, n)) which = 3 - entry
      if (which > n) return
      self%foot = feet(which)
      if (self%foot%overhang > m%limits%extension*size_) return
      self%normal(:d) = m%motion%turn(self%foot%normal(:d))
      if (self%foot%cone < 1.0_wp .and. -dot_product(side, self%normal) >= &
         & self%foot%cone - 1.0e-6_wp) then
         turned = 0.0_wp
         turned(:d) = -matmul(transpose(m%motion%rotation(:d, :d)), side(:d))
         self%foot%normal = turned
         self%foot%hessian = 0.0_wp
         self%foot%gap = dot_product(m%motion%to_tool(x) - self%foot%point(:d), turned(:d))
         self%normal = -side
      end if
      if (dot_product(side, self%normal) > -facing .and. any(abs(side) > 0.0_wp)) return
      self%facet = max(1, self%foot%segment)
      self%size = size_
   end subroutine find_on_tool

   !> The place opposite; the offset of the row's samples stays.
   pure subroutine anchor_of(self, opposite)
      type(anchor_type), intent(inout) :: self
      type(opposite_type), intent(in) :: opposite

      self = anchor_type(offset=self%offset)
      self%set = opposite%facet > 0
      if (.not. self%set) return
      self%nnode = opposite%ncarry
      self%node = opposite%node(:8)
      self%share = opposite%found%shape
      self%y = opposite%foot%point
      self%gap = opposite%found%gap
      if (self%nnode == 0) self%gap = opposite%foot%gap
   end subroutine anchor_of
end module lopin_closest_feature
