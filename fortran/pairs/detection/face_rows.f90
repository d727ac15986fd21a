!> Rows of contact with a tool from points inside the facets that meet a crease of it.
!>
!> Where a facet of the slave meets planes of a tool that differ, facets of an STL file or a
!> polygon, a row that samples the gap at its node turns at once when the node passes an edge, and
!> the force ripples as the tool slides. There the row of a node is
!>
!>    D_j gap_j = sum over its facets of sum_q w_q psi_j(x_q) gap(x_q)
!>
!> with each point's own foot and normal. Other facets give D_j times the gap of the node, of a
!> mid-side node that of the transformed basis, so that nothing changes where no crease is met.
module lopin_face_rows
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, new_cell_of
   use lopin_face_points, only : face_points_type, new_face_points
   use lopin_tool, only : tool_type, foot_type, move_foot
   use lopin_rigid_motion, only : rigid_motion_type
   use lopin_model, only : model_type
   use lopin_flat_elements, only : is_ring
   use lopin_slave_points, only : slave_type
   use lopin_contact_points, only : contact_points_type, face_type, inner_type, sample_type, &
      & facing, pair_is_tied
   use lopin_row_samples, only : base_samples
   use lopin_curved_slave, only : curves_slave, join_facets
   implicit none
   private
   public :: list_faces, find_inner, points_of_face, face_feet_type, find_feet, one_piece

   !> Points of a facet in each direction: of lines and second-order surfaces, of other surfaces.
   integer, parameter :: parts_of_line = 8, parts_of_face = 4
   !> Normals of one piece of a tool differ by less than 30 degrees; more is an edge.
   real(wp), parameter :: one_piece = 0.866025403784439_wp
   !> Facets whose nodes are all farther away, in facets, are not looked at.
   real(wp), parameter :: near = 1.0_wp

   !> The feet of the points of a facet, in the tool's frame.
   type :: face_feet_type
      type(foot_type), allocatable :: foot(:)
      logical :: found = .false.               !! all of them
      logical :: meets = .false.   !! they look the same way, and a crease is between them
   end type face_feet_type

contains

   !> The facets of a slave that may meet creases of its tool.
   subroutine list_faces(self, model, pair, slave, first)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(slave_type), intent(in) :: slave
      integer, intent(in) :: first(:)          !! (slave nodes) first point of each
      type(face_type) :: face
      integer :: i

      if (.not. allocated(self%face)) allocate (self%face(0))
      if (.not. (model%tool(self%tool(pair))%shape%has_creases() &
         & .or. curves_slave(model, model%pair(pair)))) return
      if (pair_is_tied(model, model%pair(pair)) .or. .not. allocated(slave%facets%cell)) return
      do i = 1, slave%facets%n
         face%pair = pair
         face%cell = slave%facets%cell(i)
         face%nnode = slave%facets%nnode(i)
         face%node = slave%facets%node(:, i)
         face%point = 0
         face%point(:face%nnode) = first(slave%local(:face%nnode, i))
         face%share = slave%share(slave%local(face%nnode, i))
         face%thickness = slave%thickness(i)
         self%face = [self%face, face]
      end do
      if (curves_slave(model, model%pair(pair))) call join_facets(self%face, model, pair)
   end subroutine list_faces

   !> The rows of a pair that have points inside faces, its tool standing as `motion` says.
   subroutine find_inner(self, model, pair, motion)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(rigid_motion_type), intent(in) :: motion
      type(face_points_type) :: inside
      type(face_feet_type) :: feet
      integer :: i, q

      if (.not. any(self%face%pair == pair)) return
      call make_room(self)
      do i = self%first(pair), self%n
         if (self%pair(i) /= pair) exit
         if (allocated(self%inner(i)%sample)) deallocate (self%inner(i)%sample)
      end do
      do i = 1, size(self%face)
         if (self%face(i)%pair /= pair) cycle
         if (.not. is_open_to(self, self%face(i))) cycle
         associate (f => self%face(i), at => self%face(i)%point(:self%face(i)%nnode))
            call points_of_face(inside, f, model, model%mesh%x)
            call find_feet(model%tool(self%tool(pair))%shape, motion, &
               & model%pair(pair)%extension*maxval(self%size(at)), self%normal(:, at), &
               & self%facet(at), inside, .false., feet)
            if (.not. feet%meets) cycle
            do q = 1, inside%n
               call move_foot(motion, model%mesh%ndim, feet%foot(q))
            end do
            call add_points(self, model, f, inside, feet%foot)
         end associate
      end do
   end subroutine find_inner

   !> Points may have been added since.
   subroutine make_room(self)
      type(contact_points_type), intent(inout) :: self
      type(inner_type), allocatable :: longer(:)

      if (.not. allocated(self%inner)) allocate (self%inner(self%n))
      if (size(self%inner) >= self%n) return
      allocate (longer(self%n))
      longer(:size(self%inner)) = self%inner
      call move_alloc(longer, self%inner)
   end subroutine make_room

   !> All nodes of a facet meet the tool, each one side of it, and some node is near.
   pure logical function is_open_to(self, face)
      type(contact_points_type), intent(in) :: self
      type(face_type), intent(in) :: face
      integer :: k

      associate (at => face%point(:face%nnode))
         is_open_to = all(self%facet(at) > 0)
         if (is_open_to) is_open_to = minval(self%gap(at) - near*self%size(at)) <= 0.0_wp
         if (.not. is_open_to) return
         do k = 1, face%nnode
            if (at(k) == self%n) cycle
            if (self%node(at(k) + 1) == face%node(k) .and. self%pair(at(k) + 1) == face%pair &
               & .and. self%facet(at(k) + 1) > 0) is_open_to = .false.
         end do
      end associate
   end function is_open_to

   !> Points of a facet whose nodes are at x.
   subroutine points_of_face(self, face, model, x)
      type(face_points_type), intent(out) :: self
      type(face_type), intent(in) :: face
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) [length]
      type(cell_type) :: cell
      integer :: parts

      call new_cell_of(cell, face%cell)
      parts = merge(parts_of_line, parts_of_face, size(x, 1) == 2 .or. cell%quadratic)
      call new_face_points(self, cell, x(:, face%node(:face%nnode)), parts, &
         & is_ring(model, model%pair(face%pair)%slave), face%thickness, face%share)
   end subroutine points_of_face

   !> The feet of the points of a facet, in the tool's frame, and whether it meets a crease of one
   !> piece of its tool.
   subroutine find_feet(tool, motion, reach, normal, segment, inside, wanted, feet)
      class(tool_type), intent(in) :: tool
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: reach            !! how far beyond the end of the tool counts [length]
      real(wp), intent(in) :: normal(:, :)     !! (3, nnode) of the tool opposite the nodes
      integer, intent(in) :: segment(:)        !! (nnode) of the tool there
      type(face_points_type), intent(in) :: inside
      logical, intent(in) :: wanted            !! whether it meets a crease or not
      type(face_feet_type), intent(out) :: feet
      real(wp) :: side(3), first(3), cosine
      integer :: q, d

      d = tool%ndim
      allocate (feet%foot(inside%n))
      associate (foot => feet%foot, meets => feet%meets)
         first = normal(:, 1)
         meets = all([(dot_product(normal(:, q), first) >= one_piece, q=1, size(segment))])
         do q = 1, inside%n
            if (.not. (meets .or. wanted)) return
            call tool%project(motion%to_tool(inside%x(:d, q)), foot(q))
            if (.not. foot(q)%found .or. foot(q)%overhang > reach) then
               meets = .false.
               return
            end if
            side = 0.0_wp
            side(:d) = matmul(transpose(motion%rotation(:d, :d)), inside%normal(:d, q))
            cosine = dot_product(side, foot(q)%normal)
            ! On a crease itself the facet's own side says which direction meets it.
            if (foot(q)%cone < 1.0_wp .and. -cosine >= foot(q)%cone - 1.0e-6_wp) then
               foot(q)%normal = -side
               foot(q)%hessian = 0.0_wp
            end if
            meets = meets .and. .not. cosine > facing
            meets = meets .and. .not. dot_product(motion%turn(foot(q)%normal(:d)), first(:d)) &
               & < one_piece
         end do
         feet%found = .true.
         if (meets) meets = any([(tool%is_creased(segment(1), foot(q)%segment), q=1, inside%n), &
            & (tool%is_creased(segment(1), segment(q)), q=2, size(segment))])
      end associate
   end subroutine find_feet

   !> Points of one facet to the rows of its nodes; the row without them keeps what is left of the
   !> area.
   subroutine add_points(self, model, face, inside, foot)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(face_type), intent(in) :: face
      type(face_points_type), intent(in) :: inside
      type(foot_type), intent(in) :: foot(:)
      type(sample_type), allocatable :: longer(:), base(:)
      integer :: k, q, n, m

      do k = 1, face%nnode
         associate (i => face%point(k))
            call base_samples(self, i, model%mesh%x, base)
            if (.not. allocated(self%inner(i)%sample)) self%inner(i)%sample = base
            n = size(self%inner(i)%sample)
            allocate (longer(n + inside%n))
            longer(:n) = self%inner(i)%sample
            do q = 1, inside%n
               associate (s => longer(n + q))
                  s%c = inside%part(k, q)/self%weight(i)
                  s%point = i
                  s%nnode = face%nnode
                  s%node(:face%nnode) = face%node(:face%nnode)
                  s%shape(:face%nnode) = inside%shape(:, q)
                  s%normal = foot(q)%normal
                  s%foot = foot(q)%point
                  s%gap = foot(q)%gap
               end associate
            end do
            m = size(base)
            longer(:m)%c = longer(:m)%c - base%c*(inside%weight(k)/self%weight(i))
            call move_alloc(longer, self%inner(i)%sample)
         end associate
      end do
   end subroutine add_points
end module lopin_face_rows
