!> Slave points opposite rigid tools, at rest and where the tool stands at the end of an increment.
!>
!> The path of a tool may be long while the piece's is short: the points are projected on it again.
module lopin_tool_points
   use lopin_kinds, only : wp
   use lopin_slave_points, only : slave_type
   use lopin_tool, only : tool_type, foot_type, one_plane, project_all_moved, move_foot
   use lopin_wall_before, only : find_wall_before
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_model, only : model_type, kind_of
   use lopin_contact_points, only : contact_points_type, add_point, facing
   use lopin_face_rows, only : list_faces, find_inner, one_piece
   implicit none
   private
   public :: pair_with_tool, move_tool

   !> Planes of a tool closer than this share of its size are one.
   real(wp), parameter :: in_plane = 1.0e-6_wp

contains

   !> A tool at rest; in a concave corner a point meets both walls.
   subroutine pair_with_tool(self, model, pair, slave)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(slave_type), intent(in) :: slave
      type(rigid_motion_type) :: rest
      type(foot_type) :: feet(2)
      integer :: i, k, nfeet, ndim, entries, first(size(slave%node))

      ndim = model%mesh%ndim
      entries = 1
      call motion_of_start(rest, model, self%body(pair))
      associate (tool => model%tool(self%tool(pair))%shape)
         if (size(slave%node) > 0 .and. may_move(model, self%body(pair))) then
            ! A tool that moves may bring a concave corner to any node: room for its second wall.
            call project_all_moved(tool, rest, model%mesh%x(:, slave%node(1)), huge(1.0_wp), feet, &
               & nfeet)
            entries = max(1, nfeet)
         end if
         do i = 1, size(slave%node)
            call project_all_moved(tool, rest, model%mesh%x(:, slave%node(i)), slave%size(i), &
               & feet, nfeet)
            first(i) = self%n + 1
            do k = 1, max(entries, nfeet)
               call add_point(self, pair, slave, i)
               if (k <= nfeet) call take_foot(self, self%n, feet(k), model%pair(pair)%extension)
            end do
         end do
         call join_corners(self, slave, first)
         call list_faces(self, model, pair, slave, first)
         call find_inner(self, model, pair, rest)
      end associate
   end subroutine pair_with_tool

   !> Where a tool stands before the first increment.
   subroutine motion_of_start(motion, model, body)
      type(rigid_motion_type), intent(out) :: motion
      type(model_type), intent(in) :: model
      integer, intent(in) :: body              !! 0: a tool that belongs to none
      integer :: d

      d = model%mesh%ndim
      call new_rigid_motion(motion, spread(0.0_wp, 1, d), spread(0.0_wp, 1, d), [real(wp) ::])
      if (body == 0) return
      associate (b => model%rigid_body(body))
         if (all(b%start == 0.0_wp)) return
         call new_rigid_motion(motion, model%mesh%x(:, b%reference), b%start(:d), &
            & b%start(merge(6, 4, d == 2):6))
      end associate
   end subroutine motion_of_start

   !> Mid-side nodes of a transformed basis know the points of the ends of their edges.
   pure subroutine join_corners(self, slave, first)
      type(contact_points_type), intent(inout) :: self
      type(slave_type), intent(in) :: slave
      integer, intent(in) :: first(:)          !! (slave nodes) first point of each
      integer :: i, k

      do i = 1, size(first)
         if (.not. slave%share(i) > 0.0_wp) cycle
         k = first(i)
         do while (k <= self%n)
            if (self%node(k) /= slave%node(i)) exit
            self%corner(:, k) = first(slave%corner(:, i))
            self%share(k) = slave%share(i)
            k = k + 1
         end do
      end do
   end subroutine join_corners

   !> A rigid body is free, or prescribed to go somewhere in some step.
   pure logical function may_move(model, body)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      integer :: i, k, dofs

      may_move = .false.
      if (body == 0) return
      dofs = 6
      if (model%mesh%ndim == 2) dofs = 3
      if (model%kind == kind_of%axisymmetric) dofs = 1
      associate (rigid => model%rigid_body(body))
         do i = 1, size(model%step)
            k = 0
            associate (p => model%step(i)%prescribed)
               may_move = may_move &
                  & .or. any((p%node == rigid%reference .or. p%node == rigid%rotation) &
                  & .and. abs(p%value) > 0.0_wp)
               k = count(p%node == rigid%reference) + count(p%node == rigid%rotation &
                  & .and. rigid%rotation > 0)
            end associate
            may_move = may_move .or. k < dofs
         end do
      end associate
   end function may_move

   !> A foot counts if it is not past the end of the tool and the slave faces it.
   subroutine take_foot(self, n, foot, extension)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: n
      type(foot_type), intent(in) :: foot
      real(wp), intent(in) :: extension

      self%facet(n) = 0
      if (.not. foot%found) return
      self%normal(:, n) = foot%normal
      self%foot(:, n) = foot%point
      self%gap(n) = foot%gap
      if (foot%overhang > extension*self%size(n)) return
      ! On a corner itself the slave's own side says which of the tool's directions meets it.
      if (foot%cone < 1.0_wp .and. -dot_product(self%side(:, n), foot%normal) >= &
         & foot%cone - 1.0e-6_wp) self%normal(:, n) = -self%side(:, n)
      if (any(abs(self%side(:, n)) > 0.0_wp)) then
         if (dot_product(self%side(:, n), foot%normal) > facing) return
      end if
      self%facet(n) = max(1, foot%segment)
   end subroutine take_foot

   !> A point deep inside the moved tool may be nearest to a side that it does not face, as beside
   !> the corner of a punch: it keeps the face that it met at the start, wherever that is now.
   subroutine keep_start(self, i, motion, x)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: i
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)             !! (ndim) the point [length]
      integer :: n

      if (self%facet(i) > 0 .or. self%start_facet(i) == 0 .or. self%gap(i) >= 0.0_wp) return
      n = size(x)
      self%facet(i) = self%start_facet(i)
      self%normal(:n, i) = motion%turn(self%start_normal(:n, i))
      self%foot(:n, i) = motion%to_global(self%start_foot(:n, i))
      self%gap(i) = dot_product(self%normal(:n, i), x - self%foot(:n, i))
   end subroutine keep_start

   !> A point deep inside a rib may be nearest to its side, or to the corner behind it. Where the
   !> wall between the point and its own body is the one that it faced at the start, it went in
   !> there, and that wall alone counts.
   subroutine take_entered(self, i, tool, motion, x, feet, nfeet)
      type(contact_points_type), intent(in) :: self
      integer, intent(in) :: i
      class(tool_type), intent(in) :: tool
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)             !! (ndim) the point [length]
      type(foot_type), intent(inout) :: feet(2)
      integer, intent(inout) :: nfeet
      type(foot_type) :: wall
      real(wp) :: side(size(x)), start(size(x))
      integer :: k

      if (nfeet == 0 .or. self%start_facet(i) == 0) return
      if (feet(1)%gap >= 0.0_wp) return
      start = motion%turn(self%start_normal(:size(x), i))
      side = self%side(:size(x), i)
      if (.not. any(abs(side) > 0.0_wp)) side = -start
      ! What lies square to the slave is what it went in by.
      if (nfeet == 1 .and. -dot_product(side, feet(1)%normal(:size(x))) >= one_piece) return
      call find_wall_before(tool, motion%to_tool(x), &
         & matmul(transpose(motion%rotation(:size(x), :size(x))), side), wall)
      if (.not. wall%found) return
      call move_foot(motion, tool%ndim, wall)
      if (dot_product(wall%normal(:size(x)), start) < one_piece) return
      if (.not. is_wall(self%start_facet(i), start, &
         & motion%to_global(self%start_foot(:size(x), i)))) return
      do k = 1, nfeet
         if (is_wall(feet(k)%segment, feet(k)%normal(:size(x)), feet(k)%point(:size(x)))) return
      end do
      feet(1) = wall
      nfeet = 1

   contains

      !> Another foot is on the wall, or on what goes over into it without an edge: planes that are
      !> parallel are one if they lie in each other. A corner is no part of the walls beside it.
      pure logical function is_wall(segment, normal, point)
         integer, intent(in) :: segment
         real(wp), intent(in) :: normal(:), point(:)
         is_wall = wall%segment == segment .and. .not. wall%corner
         if (is_wall) return
         if (tool%is_creased(wall%segment, segment)) return
         is_wall = .not. wall%corner
         if (dot_product(wall%normal(:size(x)), normal) >= one_plane) is_wall = abs(dot_product( &
            & normal, wall%point(:size(x)) - point)) <= in_plane*tool%size
      end function is_wall
   end subroutine take_entered

   !> Project the points of a pair on its tool in another place.
   subroutine move_tool(self, model, pair, displacement, rotation)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: displacement(:), rotation(:)  !! of the reference node [length], [rad]
      type(rigid_motion_type) :: motion
      type(foot_type) :: feet(2)
      real(wp) :: reference(model%mesh%ndim)
      integer :: i, k, nfeet

      reference = model%mesh%x(:, model%rigid_body(self%body(pair))%reference)
      call new_rigid_motion(motion, reference, displacement, rotation)
      i = self%first(pair)
      do while (i < self%first(pair + 1))
         associate (tool => model%tool(self%tool(pair))%shape)
            call project_all_moved(tool, motion, model%mesh%x(:, self%node(i)), self%size(i), &
               & feet, nfeet)
            call take_entered(self, i, tool, motion, model%mesh%x(:, self%node(i)), feet, nfeet)
         end associate
         do k = 1, 2
            self%facet(i) = 0
            self%normal(:, i) = 0.0_wp
            self%foot(:, i) = 0.0_wp
            self%gap(i) = 0.0_wp
            if (k <= nfeet) then
               call take_foot(self, i, feet(k), model%pair(pair)%extension)
               if (feet(k)%overhang <= 0.0_wp) call keep_start(self, i, motion, &
                  & model%mesh%x(:, self%node(i)))
            end if
            i = i + 1
            if (i >= self%first(pair + 1)) exit
            if (self%node(i) /= self%node(i - 1)) exit
         end do
      end do
      call find_inner(self, model, pair, motion)
   end subroutine move_tool
end module lopin_tool_points
