!> A tool of triangles that mean a curved surface: each is curved by the normals of its corners.
!>
!> Facets that meet at less than 30 degrees share the normals of their corners
!> (`corner_normals.f90`). Sharper edges stay as they are, and so do creases that stand
!> alone and stand out: a surface that is curved turns on, the same way and about as much, at the
!> next crease, and what stands out no more than the chords of that surface belongs to it.
!> Points whose foot is on an edge that stays are met as on flat facets. The normal runs between
!> those of the corners, so that it does not jump where a point goes from one facet to the next.
module lopin_tool_curved
   use lopin_kinds, only : wp
   use lopin_facet_mesh, only : facet_mesh_type
   use lopin_tool, only : foot_type, one_plane, coincidence
   use lopin_corner_normals, only : corner_normal
   use lopin_tool_facets, only : facets_tool_type, nearest_type, new_facets_tool, settle_flat, &
      & goes_through
   use lopin_creases, only : sharp, chord_of, rise_of, turn_at, edge_to, stays, stands_alone
   use lopin_curved_triangle, only : edge_control, closest_on_curved, normal_slopes, &
      & rise_of_patch
   implicit none
   private
   public :: curved_tool_type, new_curved_tool

   !> 60 degrees: no facets of a curved surface meet at more.
   real(wp), parameter :: few = 0.5_wp + 1.0e-9_wp
   integer, parameter :: most_hops = 8          !! from facet to facet, on the way to the closest
   real(wp), parameter :: nearer = 1.0_wp - 1.0e-12_wp   !! beside the squared distance before

   type, extends(facets_tool_type) :: curved_tool_type
      real(wp), allocatable :: control(:, :, :)   !! (3, 6, nfacet) Bezier points [length]
      real(wp), allocatable :: corner(:, :, :)    !! (3, 3, nfacet) unit normals of the corners
      logical, allocatable :: kept(:, :)          !! (3, nfacet) edges that stay as they are
      logical, allocatable :: fixed(:)            !! (nvertex) such an edge ends there
      integer, allocatable :: region(:)           !! (nfacet) of facets that no kept edge parts
   contains
      procedure :: settle => settle_curved
      procedure :: is_other_wall => is_other_curved
      procedure :: is_creased => is_bent
      procedure :: apart => apart_by_walls
   end type curved_tool_type

contains

   !> A tool of curved triangles from a mesh of flat ones.
   subroutine new_curved_tool(self, mesh)
      type(curved_tool_type), intent(out) :: self
      type(facet_mesh_type), intent(in) :: mesh
      integer :: f, k, to

      call new_facets_tool(self%facets_tool_type, mesh)
      self%curved = .true.
      allocate (self%control(3, 6, mesh%nfacet), self%corner(3, 3, mesh%nfacet))
      allocate (self%kept(3, mesh%nfacet), self%fixed(mesh%nvertex), source=.false.)
      call find_kept(self)
      self%hollow_edges = any(self%hollow)
      do f = 1, mesh%nfacet
         do k = 1, 3
            self%corner(:, k, f) = corner_normal(mesh, self%kept, f, k)
         end do
      end do
      do f = 1, mesh%nfacet
         self%control(:, :3, f) = mesh%x(:, mesh%vertex(:, f))
         do k = 1, 3
            to = 1 + mod(k, 3)
            associate (a => self%control(:, k, f), b => self%control(:, to, f))
               self%control(:, 3 + k, f) = 0.5_wp*(a + b)
               if (.not. self%kept(k, f)) self%control(:, 3 + k, f) = edge_control(a, b, &
                  & self%corner(:, k, f), self%corner(:, to, f))
            end associate
         end do
         self%chord(f) = rise_of_patch(self%control(:, :, f))
      end do
   end subroutine new_curved_tool

   !> Edges that stay: sharp ones, and creases that stand alone and stand out.
   pure subroutine find_kept(self)
      type(curved_tool_type), intent(inout) :: self
      real(wp) :: chord(self%mesh%nfacet)      !! largest of edges that are curved [length]
      integer :: f, k, g
      logical :: all_stand_out

      associate (mesh => self%mesh)
         do f = 1, mesh%nfacet
            do k = 1, 3
               g = mesh%neighbour(k, f)
               ! Both sides of an edge say the same.
               if (g > f) self%kept(k, f) = stays(mesh, f, k)
               if (g > 0 .and. g < f) self%kept(k, f) = self%kept(edge_to(mesh, g, f), g)
            end do
         end do
         chord = 0.0_wp
         do f = 1, mesh%nfacet
            do k = 1, 3
               if (.not. self%kept(k, f)) chord(f) = max(chord(f), chord_of(mesh, f, k))
            end do
         end do
         do
            call find_regions(self)
            call drop_chords(self, chord, all_stand_out)
            if (all_stand_out) exit
         end do
         do f = 1, mesh%nfacet
            do k = 1, 3
               self%hollow(k, f) = self%kept(k, f) .and. turn_at(mesh, f, k) < 0.0_wp
               if (self%kept(k, f)) self%fixed(mesh%vertex([k, 1 + mod(k, 3)], f)) = .true.
            end do
         end do
      end associate
   end subroutine find_kept

   !> Slivers and diagonals turn as chance has it. What stands out no more than the chords of the
   !> curved surface beside it is a chord of that too; taken for one, it moves the tool by less than
   !> these do.
   pure subroutine drop_chords(self, chord, all_stand_out)
      type(curved_tool_type), intent(inout) :: self
      real(wp), intent(in) :: chord(:)         !! (nfacet) [length]
      logical, intent(out) :: all_stand_out
      real(wp) :: largest(maxval(self%region))
      integer :: f, k, g

      all_stand_out = .true.
      associate (mesh => self%mesh, region => self%region)
         largest = 0.0_wp
         do f = 1, mesh%nfacet
            largest(region(f)) = max(largest(region(f)), chord(f))
         end do
         do f = 1, mesh%nfacet
            do k = 1, 3
               g = mesh%neighbour(k, f)
               if (g < f .or. .not. self%kept(k, f)) cycle
               if (rise_of(mesh, f, k) > max(largest(region(f)), largest(region(g)))) cycle
               if (is_edge(self, f, k)) cycle
               self%kept(k, f) = .false.
               self%kept(edge_to(mesh, g, f), g) = .false.
               all_stand_out = .false.
            end do
         end do
      end associate
   end subroutine drop_chords

   !> An edge of more than 30 degrees, however little it stands out: not one of a fillet of few
   !> facets, which turns on, nor that of a sliver, which ends at both its ends.
   pure logical function is_edge(self, f, k)
      type(curved_tool_type), intent(in) :: self
      integer, intent(in) :: f, k
      real(wp) :: cosine
      integer :: side, v, i, j, g

      cosine = dot_product(self%mesh%normal(:, f), self%mesh%normal(:, self%mesh%neighbour(k, f)))
      is_edge = cosine < few
      if (is_edge .or. cosine >= sharp) return
      if (.not. stands_alone(self%mesh, f, k)) return
      do side = 0, 1
         v = self%mesh%vertex(1 + mod(k - 1 + side, 3), f)
         do i = self%mesh%ring_first(v), self%mesh%ring_first(v + 1) - 1
            g = self%mesh%ring(i)
            do j = 1, 3
               if (.not. self%kept(j, g)) cycle
               if (g == f .and. j == k .or. self%mesh%neighbour(j, g) == f &
                  & .and. edge_to(self%mesh, f, g) == k) cycle
               is_edge = is_edge .or. any(self%mesh%vertex([j, 1 + mod(j, 3)], g) == v)
            end do
         end do
      end do
   end function is_edge

   !> Facets that hang together without a kept edge between them.
   pure subroutine find_regions(self)
      type(curved_tool_type), intent(inout) :: self
      integer, allocatable :: stack(:)
      integer :: first, top, f, k, g, n

      if (allocated(self%region)) deallocate (self%region)
      allocate (self%region(self%mesh%nfacet), source=0)
      allocate (stack(self%mesh%nfacet))
      n = 0
      do first = 1, self%mesh%nfacet
         if (self%region(first) > 0) cycle
         n = n + 1
         self%region(first) = n
         stack(1) = first
         top = 1
         do while (top > 0)
            f = stack(top)
            top = top - 1
            do k = 1, 3
               g = self%mesh%neighbour(k, f)
               if (g == 0 .or. self%kept(k, f)) cycle
               if (self%region(g) > 0) cycle
               self%region(g) = n
               top = top + 1
               stack(top) = g
            end do
         end do
      end do
   end subroutine find_regions

   !> Facets beyond kept edges, and those of one curved surface that look elsewhere, or that a
   !> concave crease parts from that of the foot: where a crease ends, normals turn towards each
   !> other, and by one side's normal the other may look the same way.
   pure logical function is_other_curved(self, f, foot) result(is_other)
      class(curved_tool_type), intent(in) :: self
      integer, intent(in) :: f
      type(foot_type), intent(in) :: foot

      is_other = self%region(f) /= self%region(foot%segment)
      if (.not. is_other) is_other = dot_product(self%mesh%normal(:, f), foot%normal) <= sharp
      if (.not. is_other) is_other = any(self%hollow(:, f) .and. self%mesh%neighbour(:, f) &
         & == foot%segment)
   end function is_other_curved

   !> By walls first: numbers of facets say little.
   pure integer function apart_by_walls(self, a, b) result(apart)
      class(curved_tool_type), intent(in) :: self
      integer, intent(in) :: a, b
      apart = abs(a - b)
      if (self%region(a) /= self%region(b)) apart = apart + 2*self%mesh%nfacet
   end function apart_by_walls

   !> Only kept edges are creases: where a fillet turns far from one place to another it is curved.
   pure logical function is_bent(self, a, b)
      class(curved_tool_type), intent(in) :: self
      integer, intent(in) :: a, b
      is_bent = self%region(a) /= self%region(b) &
         & .and. dot_product(self%mesh%normal(:, a), self%mesh%normal(:, b)) < one_plane
   end function is_bent

   !> The foot on the curved surface, from the closest point of the flat facets.
   pure subroutine settle_curved(self, x, nearest, foot)
      class(curved_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      type(nearest_type), intent(in) :: nearest
      type(foot_type), intent(out) :: foot
      type(nearest_type) :: there
      real(wp) :: share(3), arm(3), normals(3, 2)
      logical :: perimeter, through
      integer :: v

      call walk(self, x, nearest, there, share)
      perimeter = .false.
      through = goes_through(self, x, there)
      associate (f => there%facet, k => there%feature)
         if (k > 3) then
            v = self%mesh%vertex(k - 3, f)
            perimeter = self%mesh%on_perimeter(v)
            if (self%fixed(v) .and. .not. through) then
               call settle_flat(self, x, there, foot)
               return
            end if
         else if (k > 0) then
            perimeter = self%mesh%neighbour(k, f) == 0
            if (self%kept(k, f) .and. .not. through) then
               call settle_flat(self, x, there, foot)
               return
            end if
         end if
         foot%found = .true.
         foot%segment = f
         foot%point = there%point
         call normal_slopes(self%control(:, :, f), self%corner(:, :, f), share, k, x, normals, &
            & foot%hessian)
         foot%normal = normals(:, 1)
         foot%gradient = normals(:, 2)
         arm = x - foot%point
         foot%gap = dot_product(arm, foot%normal)
         if (perimeter) then
            foot%overhang = norm2(arm - foot%gap*foot%normal)
         else
            foot%leans = .true.
            if (through) then
               foot%gap = dot_product(arm, foot%gradient)
               return
            end if
            foot%gap = sign(sqrt(there%distance2), foot%gap)
            ! On an edge between two patches the gap is along the arm.
            if (k > 0 .and. abs(foot%gap) > coincidence*self%size) foot%gradient = arm/foot%gap
         end if
      end associate
   end subroutine settle_curved

   !> From facet to facet while that comes nearer.
   pure subroutine walk(self, x, flat, nearest, share)
      class(curved_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      type(nearest_type), intent(in) :: flat
      type(nearest_type), intent(out) :: nearest
      real(wp), intent(out) :: share(3)
      integer :: hop, before, v, i, on, next

      nearest%facet = 0
      share = 0.0_wp
      call try(self, x, flat%facet, nearest, share)
      nearest%of_other = flat%of_other
      do hop = 1, most_hops
         before = nearest%facet
         on = nearest%feature
         if (on == 0) return
         if (on <= 3) then
            next = self%mesh%neighbour(on, before)
            if (flat%of_other .and. self%kept(on, before)) next = 0
            if (next > 0) call try(self, x, next, nearest, share)
         else
            v = self%mesh%vertex(on - 3, before)
            if (flat%of_other .and. self%fixed(v)) return
            do i = self%mesh%ring_first(v), self%mesh%ring_first(v + 1) - 1
               if (flat%of_other .and. self%region(self%mesh%ring(i)) /= self%region(before)) cycle
               call try(self, x, self%mesh%ring(i), nearest, share)
            end do
         end if
         nearest%of_other = flat%of_other
         if (nearest%facet == before) return
      end do
   end subroutine walk

   !> Take this facet if it is nearer.
   pure subroutine try(self, x, f, nearest, share)
      class(curved_tool_type), intent(in) :: self
      real(wp), intent(in) :: x(3)
      integer, intent(in) :: f
      type(nearest_type), intent(inout) :: nearest
      real(wp), intent(inout) :: share(3)
      real(wp) :: here(3), point(3), distance2
      integer :: feature

      here = 1.0_wp/3.0_wp
      call closest_on_curved(self%control(:, :, f), x, here, point, feature)
      distance2 = sum((x - point)**2)
      if (nearest%facet > 0) then
         if (.not. distance2 < nearest%distance2*nearer) return
      end if
      nearest = nearest_type(f, feature, distance2, point)
      share = here
   end subroutine try
end module lopin_tool_curved
