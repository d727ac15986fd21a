!> From the closest point of a surface to a contact point: side, normal, gap at edges and corners.
!>
!> Inside a facet the normal is the facet's. On an edge or corner between facets the point belongs
!> to its Voronoi region: the normal is the direction to the point, and the angle-weighted normal
!> of the edge or corner tells the side (Baerentzen and Aanaes 2005). On the perimeter the facet
!> goes on by a fraction of its size, and then ends.
!>
!> Across its sharp edges a skin goes on with walls, and a slave that looks along a wall is not
!> opposite it. To such a slave the edge is a perimeter for what lies on the facet continued there,
!> or in it: nodes of a body flush with the wall, beside it by rounding or as the two bulge. What
!> stands off the facet by more than it lies beside it is in the Voronoi region of the edge; what is
!> in it deeply lies beside the wall.
module lopin_feature
   use lopin_kinds, only : wp
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal, edge_ends
   use lopin_facet_basis, only : shape_values
   use lopin_surface, only : surface_type
   use lopin_flush_walls, only : ends_at_wall, slack_beyond, ask_walls, find_faced, touches_hardly
   implicit none
   private
   public :: projection_type, limits_type, settle, along_edge, joint_normal

   !> What a facet must fulfil to be opposite a point.
   type :: limits_type
      real(wp) :: reach = huge(1.0_wp)      !! farther facets do not count [length]
      real(wp) :: depth = huge(1.0_wp)      !! deeper penetrations do not count [length]
      real(wp) :: cosine = -0.2_wp          !! n_slave.n_master must not be above [-]
      logical :: behind = .false.           !! only facets that the point is behind count
      real(wp) :: shallow = 0.0_wp          !! by more than this [length]
      real(wp) :: extension = 0.1_wp        !! beyond the perimeter, fraction of the facet [-]
   end type limits_type

   !> The master opposite a slave point.
   type :: projection_type
      integer :: place = 0 !! lopin_projection's place%...; none: no facet is opposite
      integer :: facet = 0                  !! index into surface%facets; 0: none
      integer :: kind = 0 !! place%inside: moves on the face; %edge: along it; %vertex: fixed
      integer :: feature = 0                !! number of that edge or vertex in the facet
      real(wp) :: xi(2) = 0.0_wp            !! may pass the bounds of the cell when extended
      real(wp) :: shape(8) = 0.0_wp         !! values of the facet's nodes at the foot; sum 1
      real(wp) :: point(3) = 0.0_wp         !! foot [length]
      real(wp) :: normal(3) = 0.0_wp        !! unit, out of the master = gradient of the gap
      real(wp) :: gap = 0.0_wp              !! (x - point).normal, >= 0 open [length]
   end type projection_type

   real(wp), parameter :: touching = 1.0e-9_wp   !! of a facet: lengths below are rounding
   !> Of a facet: what is flush with a wall is entered by less; beside the wall by less still.
   real(wp), parameter :: flush_depth = 0.5_wp

contains

   !> Turn the closest foot among the admitted facets into a projection; `result%facet` stays 0 if
   !> the point is opposite no facet after all.
   pure subroutine settle(surface, facet, closest, x, n_slave, limits, result)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3)                 !! [length]
      real(wp), intent(in) :: n_slave(3) !! outward unit normal: facets were refused for it; 0: none
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(out) :: result
      logical :: admitted

      result%facet = facet
      result%place = closest%place
      result%kind = closest%place
      result%feature = closest%feature
      result%xi = closest%xi
      result%point = closest%point
      admitted = .true.
      if (closest%place == place%inside) then
         call take_facet_normal(surface, x, result)
      else
         call settle_on_joint(surface, closest, x, n_slave, limits, result, admitted)
      end if
      if (admitted .and. any(abs(n_slave) > 0.0_wp)) call take_faced(surface, x, n_slave, &
         & limits%cosine, result)
      if (result%gap < -limits%depth) admitted = .false.
      if (.not. admitted) then
         result%facet = 0
         result%place = place%none
         return
      end if
      result%shape = shape_values(surface%basis, surface%facets%cell(result%facet), result%xi)
   end subroutine settle

   !> The foot is on an edge or a corner: beyond a perimeter, beside a wall, or between facets.
   pure subroutine settle_on_joint(surface, closest, x, n_slave, limits, result, admitted)
      type(surface_type), intent(in) :: surface
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3), n_slave(3)
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(inout) :: result
      logical, intent(out) :: admitted
      type(projection_type) :: beyond
      real(wp), parameter :: any_side(3) = 0.0_wp
      real(wp) :: pseudo(3), beside
      logical :: perimeter, continued, entered

      call joint_normal(surface, result%facet, closest, pseudo, perimeter)
      continued = .false.
      beside = 0.0_wp
      if (any(abs(n_slave) > 0.0_wp)) then
         if (ends_at_wall(surface, result%facet, closest, n_slave, limits%cosine)) then
            beyond = result
            call extend(surface, closest, x, n_slave, limits, beyond, continued)
            beside = norm2(beyond%point - closest%point)
         end if
      end if
      if (continued) then
         if (lies_on(surface, beyond, beside, limits)) then
            result = beyond
            admitted = .true.
            return
         end if
      end if
      if (perimeter) then
         call extend(surface, closest, x, any_side, limits, result, admitted)
         return
      end if
      call take_direction(surface, x, sqrt(closest%distance2), pseudo, result)
      admitted = .true.
      if (.not. any(abs(n_slave) > 0.0_wp)) return
      call ask_walls(surface, closest, x, result%facet, admitted, entered)
      if (.not. (admitted .and. entered)) return
      ! In a concave corner the wall is nearer to what has entered it by rounding.
      if (continued .and. beyond%gap > beside) then
         result = beyond
      else
         admitted = abs(result%gap) <= flush_depth*surface%size(result%facet)
      end if
   end subroutine settle_on_joint

   !> Whether a point beside a wall is on or in the facet that ends there: the farther beside it,
   !> the less deep.
   pure logical function lies_on(surface, beyond, beside, limits)
      type(surface_type), intent(in) :: surface
      type(projection_type), intent(in) :: beyond   !! on the continued facet
      real(wp), intent(in) :: beside                !! [length]
      type(limits_type), intent(in) :: limits
      real(wp) :: left

      associate (size => surface%size(beyond%facet))
         left = max(0.0_wp, 1.0_wp - beside/((limits%extension + 2.0_wp*touching)*size))
         lies_on = beyond%gap <= max(beside, touching*size) &
            & .and. beyond%gap >= -flush_depth*size*left**2
      end associate
   end function lies_on

   !> A point flush with a wall that it hardly faces belongs to the facet beside it that it faces.
   pure subroutine take_faced(surface, x, n_slave, cosine, result)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3), n_slave(3), cosine
      type(projection_type), intent(inout) :: result
      type(closest_type) :: foot
      integer :: other

      if (.not. touches_hardly(surface, result%facet, n_slave, result%normal, result%gap)) return
      call find_faced(surface, x, n_slave, result%facet, cosine, other, foot)
      if (other == 0) return
      result%facet = other
      result%place = place%extended
      result%kind = place%inside
      result%feature = 0
      result%xi = foot%xi
      result%point = foot%point
      call take_facet_normal(surface, x, result)
   end subroutine take_faced

   pure subroutine take_facet_normal(surface, x, result)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3)
      type(projection_type), intent(inout) :: result

      result%normal = facet_unit_normal(surface%coefficient(:, :, result%facet), &
         & surface%basis%family(surface%facets%cell(result%facet)), result%xi)
      result%gap = dot_product(x - result%point, result%normal)
   end subroutine take_facet_normal

   !> The normal is the direction between foot and point, unless they coincide.
   pure subroutine take_direction(surface, x, distance, pseudo, result)
      type(surface_type), intent(in) :: surface
      real(wp), intent(in) :: x(3), distance, pseudo(3)
      type(projection_type), intent(inout) :: result

      result%normal = pseudo
      if (distance > 1.0e-3_wp*touching*surface%size(result%facet)) then
         result%normal = sign(1.0_wp, dot_product(x - result%point, pseudo))*(x - &
            & result%point)/distance
      end if
      result%gap = dot_product(x - result%point, result%normal)
   end subroutine take_direction

   !> Angle-weighted normal of an edge or a corner, and whether it lies on the perimeter.
   pure subroutine joint_normal(surface, facet, closest, pseudo, perimeter)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(out) :: pseudo(3)
      logical, intent(out) :: perimeter
      integer :: family, other, edge, n, i, cell
      real(wp) :: xi(2)

      cell = surface%facets%cell(facet)
      family = surface%basis%family(cell)
      if (closest%place == place%edge) then
         other = surface%neighbour(closest%feature, facet)
         perimeter = other == 0
         pseudo = facet_unit_normal(surface%coefficient(:, :, facet), family, closest%xi)
         if (perimeter) return
         edge = surface%twin(closest%feature, facet)
         xi = edge_ends(surface%basis%family(surface%facets%cell(other)), edge, &
            & 1.0_wp - along_edge(family, closest%feature, closest%xi))
         pseudo = pseudo + facet_unit_normal(surface%coefficient(:, :, other), &
            & surface%basis%family(surface%facets%cell(other)), xi)
         if (norm2(pseudo) > 0.0_wp) pseudo = pseudo/norm2(pseudo)
         return
      end if
      n = surface%local(closest%feature, facet)
      pseudo = surface%pseudo(:, n)
      perimeter = .false.
      do i = surface%ring_first(n), surface%ring_first(n + 1) - 1
         if (touches_perimeter(surface, surface%ring(i), n)) perimeter = .true.
      end do
   end subroutine joint_normal

   !> Whether one of the two edges of a facet at a node is on the perimeter.
   pure logical function touches_perimeter(surface, facet, node)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet, node
      integer :: k, n

      touches_perimeter = .false.
      n = surface%basis%ncorner(surface%facets%cell(facet))
      do k = 1, n
         if (surface%local(k, facet) /= node) cycle
         touches_perimeter = surface%neighbour(k, facet) == 0
         if (n > 2) touches_perimeter = touches_perimeter .or. surface%neighbour(1 + modulo(k - 2, &
            & n), facet) == 0
      end do
   end function touches_perimeter

   !> Fraction of edge k at which a foot of the edge lies.
   pure real(wp) function along_edge(family, k, xi)
      integer, intent(in) :: family, k
      real(wp), intent(in) :: xi(2)
      real(wp) :: a(2), b(2)

      a = edge_ends(family, k, 0.0_wp)
      b = edge_ends(family, k, 1.0_wp)
      along_edge = dot_product(xi - a, b - a)/dot_product(b - a, b - a)
   end function along_edge

   !> Beyond the perimeter, or beside walls of a slave that has a side: continue a facet by the
   !> extension; the nearest continuation is taken.
   pure subroutine extend(surface, closest, x, n_slave, limits, result, admitted)
      type(surface_type), intent(in) :: surface
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3)
      real(wp), intent(in) :: n_slave(3)           !! 0: walls are no ends
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(inout) :: result
      logical, intent(out) :: admitted
      type(closest_type) :: trial, chosen
      integer :: i, n, f, facet, first, last
      real(wp) :: best, pseudo(3), slack(4)
      logical :: perimeter

      admitted = .false.
      best = huge(1.0_wp)
      facet = result%facet
      n = 0
      first = 1
      last = 1
      if (closest%place == place%vertex) then
         n = surface%local(closest%feature, facet)
         first = surface%ring_first(n)
         last = surface%ring_first(n + 1) - 1
      end if
      do i = first, last
         f = facet
         if (n > 0) f = surface%ring(i)
         slack = slack_beyond(surface, f, n_slave, limits%cosine, limits%extension + touching)
         associate (cell => surface%facets%cell(f))
            call project_on_facet(surface%coefficient(:, :, f), surface%basis%family(cell), &
               & surface%basis%centre(:, cell), slack, x, trial)
            if (trial%distance2 >= best .or. .not. may_carry(surface, f, trial, slack)) cycle
            if (any(abs(n_slave) > 0.0_wp)) then
               if (dot_product(n_slave, facet_unit_normal(surface%coefficient(:, :, f), &
                  & surface%basis%family(cell), trial%xi)) > limits%cosine) cycle
            end if
         end associate
         best = trial%distance2
         admitted = .true.
         result%facet = f
         result%xi = trial%xi
         result%point = trial%point
         chosen = trial
      end do
      if (.not. admitted) return
      result%place = place%extended
      result%kind = chosen%place
      result%feature = chosen%feature
      if (chosen%place == place%inside) then
         call take_facet_normal(surface, x, result)
      else
         call joint_normal(surface, result%facet, chosen, pseudo, perimeter)
         call take_direction(surface, x, sqrt(chosen%distance2), pseudo, result)
      end if
   end subroutine extend

   !> A continued facet carries a foot inside its wider bounds, or on an edge that it shares: the
   !> end of a ridge in a plane of symmetry.
   pure logical function may_carry(surface, facet, closest, slack)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: slack(4)         !! of its edges

      may_carry = closest%place == place%inside
      if (closest%place == place%edge) may_carry = surface%neighbour(closest%feature, facet) > 0 &
         & .and. .not. slack(closest%feature) > 0.0_wp
   end function may_carry
end module lopin_feature
