!> From the closest point of a surface to a contact point: side, normal, gap at edges and corners.
!>
!> Inside a facet the normal is the facet's. On an edge or corner between facets the point belongs
!> to its Voronoi region: the normal is the direction to the point, and the angle-weighted normal
!> of the edge or corner tells the side (Baerentzen and Aanaes 2005). On the perimeter the facet
!> goes on by a fraction of its size, and then ends.
module lopin_feature
   use lopin_kinds, only : wp
   use lopin_projection, only : closest_type, place, project_on_facet, facet_unit_normal, edge_ends
   use lopin_facet_basis, only : shape_values
   use lopin_surface, only : surface_type, slack_of
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

contains

   !> Turn the closest foot among the admitted facets into a projection; `result%facet` stays 0 if
   !> the point is opposite no facet after all.
   pure subroutine settle(surface, facet, closest, x, sided, limits, result)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3)                 !! [length]
      logical, intent(in) :: sided                 !! facets were refused for their side
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(out) :: result
      real(wp) :: pseudo(3)
      logical :: perimeter, admitted

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
         call joint_normal(surface, facet, closest, pseudo, perimeter)
         if (perimeter) then
            call extend(surface, facet, closest, x, limits, result, admitted)
         else
            call take_direction(surface, x, sqrt(closest%distance2), pseudo, result)
            if (sided) admitted = owns(surface, closest, x, result)
         end if
      end if
      if (result%gap < -limits%depth) admitted = .false.
      if (.not. admitted) then
         result%facet = 0
         result%place = place%none
         return
      end if
      result%shape = shape_values(surface%basis, surface%facets%cell(result%facet), result%xi)
   end subroutine settle

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

   !> Beyond the perimeter: continue a facet by the extension; the nearest continuation is taken.
   pure subroutine extend(surface, facet, closest, x, limits, result, admitted)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3)
      type(limits_type), intent(in) :: limits
      type(projection_type), intent(inout) :: result
      logical, intent(out) :: admitted
      type(closest_type) :: trial, chosen
      integer :: i, n, f, first, last
      real(wp) :: best, pseudo(3)
      logical :: perimeter

      admitted = .false.
      best = huge(1.0_wp)
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
         associate (cell => surface%facets%cell(f))
            call project_on_facet(surface%coefficient(:, :, f), surface%basis%family(cell), &
               & surface%basis%centre(:, cell), slack_of(surface, f, limits%extension + touching), &
               & x, trial)
         end associate
         if (trial%distance2 >= best .or. .not. may_carry(surface, f, trial)) cycle
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
   pure logical function may_carry(surface, facet, closest)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: facet
      type(closest_type), intent(in) :: closest

      may_carry = closest%place == place%inside
      if (closest%place == place%edge) may_carry = surface%neighbour(closest%feature, facet) > 0
   end function may_carry

   !> Whether a foot on an edge or corner is really the closest one, also among the facets around it
   !> that were refused for their side. If not, the point is beside the body, opposite nothing.
   pure logical function owns(surface, closest, x, result)
      type(surface_type), intent(in) :: surface
      type(closest_type), intent(in) :: closest
      real(wp), intent(in) :: x(3)
      type(projection_type), intent(in) :: result
      type(closest_type) :: trial
      real(wp), parameter :: none(4) = 0.0_wp
      integer :: i, k, n, f, corner

      owns = .true.
      n = surface%basis%ncorner(surface%facets%cell(result%facet))
      corner = closest%feature
      do k = 1, merge(2, 1, closest%place == place%edge)
         if (k == 2) corner = 1 + mod(closest%feature, n)
         associate (node => surface%local(corner, result%facet))
            do i = surface%ring_first(node), surface%ring_first(node + 1) - 1
               f = surface%ring(i)
               call project_on_facet(surface%coefficient(:, :, f), &
                  & surface%basis%family(surface%facets%cell(f)), &
                  & surface%basis%centre(:, surface%facets%cell(f)), none, x, trial)
               if (sqrt(trial%distance2) < sqrt(closest%distance2) - &
                  & touching*surface%size(f)) owns = .false.
            end do
         end associate
      end do
   end function owns
end module lopin_feature
