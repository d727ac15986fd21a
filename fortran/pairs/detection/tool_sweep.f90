!> A tool does not pass through a body within an increment, on the linear paths.
module lopin_tool_sweep
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_sweep, only : sweep_type, new_sweep, next_share, take_gap
   use lopin_tool, only : foot_type, project_all_moved
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_contact_points, only : contact_points_type, pair_is_tied, facing
   implicit none
   private
   public :: find_tool_passage, place_of

contains

   !> A point that a tool passes between two states; 0: none. `lost`: and the contacts of the second
   !> state do not know it.
   subroutine find_tool_passage(points, model, dofs, from, to, closed, passed, lost)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: from(:), to(:)   !! (ndof) accepted and trial displacements
      logical, intent(in) :: closed(:)         !! (npoint) in the trial state
      integer, intent(out) :: passed
      logical, intent(out) :: lost
      integer :: pair

      passed = 0
      do pair = 1, size(model%pair)
         if (points%tool(pair) == 0 .or. points%first(pair) == points%first(pair + 1)) cycle
         if (pair_is_tied(model, model%pair(pair))) cycle
         call sweep_pair(points, model, dofs, pair, from, to, closed, passed)
         if (passed > 0) exit
      end do
      lost = .false.
      if (passed > 0) lost = .not. closed(passed)
   end subroutine find_tool_passage

   subroutine sweep_pair(points, model, dofs, pair, from, to, closed, passed)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: pair
      real(wp), intent(in) :: from(:), to(:)
      logical, intent(in) :: closed(:)
      integer, intent(out) :: passed
      type(sweep_type) :: sweep
      type(rigid_motion_type) :: motion
      real(wp) :: u(size(from)), gap
      logical :: faces
      integer :: i, k

      call begin(sweep, points, model, dofs, pair, from, to, closed)
      do while (next_share(sweep))
         u = from + sweep%share*(to - from)
         motion = motion_of(points, model, dofs, pair, u)
         do k = 1, sweep%n
            if (sweep%due(k) > sweep%share) cycle
            i = points%first(pair) - 1 + sweep%point(k)
            call look(points, model, pair, i, motion, place_of(model, dofs, points%node(i), u), &
               & faces, gap)
            call take_gap(sweep, k, faces, gap)
         end do
      end do
      passed = 0
      if (sweep%passed > 0) passed = points%first(pair) - 1 + sweep%passed
      motion = motion_of(points, model, dofs, pair, to)
      do k = 1, sweep%n
         if (passed > 0) exit
         i = points%first(pair) - 1 + sweep%point(k)
         if (.not. sweep%behind(k) .or. closed(i)) cycle
         call look(points, model, pair, i, motion, place_of(model, dofs, points%node(i), to), &
            & faces, gap)
         ! Behind when last seen, and not in front again.
         if (.not. faces .or. gap < 0.0_wp) passed = i
      end do
   end subroutine sweep_pair

   !> Gaps at the ends, and ways beside the tool.
   subroutine begin(sweep, points, model, dofs, pair, from, to, closed)
      type(sweep_type), intent(out) :: sweep
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: pair
      real(wp), intent(in) :: from(:), to(:)
      logical, intent(in) :: closed(:)
      type(rigid_motion_type) :: first, last
      real(wp), allocatable :: gap(:), way(:), level(:)
      real(wp) :: angle, end_gap, x(model%mesh%ndim), y(model%mesh%ndim)
      logical :: faces
      integer :: i, k, n

      n = points%first(pair + 1) - points%first(pair)
      allocate (gap(n), way(n), level(n), source=0.0_wp)
      first = motion_of(points, model, dofs, pair, from)
      last = motion_of(points, model, dofs, pair, to)
      angle = norm2(rotation_of(points, model, dofs, pair, to) &
         & - rotation_of(points, model, dofs, pair, from))
      do k = 1, n
         i = points%first(pair) - 1 + k
         x = place_of(model, dofs, points%node(i), to)
         if (closed(i)) then
            call look(points, model, pair, i, last, x, faces, end_gap)
            if (faces) level(k) = min(0.0_wp, end_gap)
         end if
         y = last%to_tool(x)
         x = place_of(model, dofs, points%node(i), from)
         call look(points, model, pair, i, first, x, faces, gap(k))
         if (.not. faces) gap(k) = -1.0_wp
         if (faces) level(k) = min(level(k), gap(k))
         x = first%to_tool(x)
         way(k) = norm2(y - x) + 0.5_wp*angle**2*norm2(x - first%reference(:size(x)))
      end do
      call new_sweep(sweep, gap, way, points%size(points%first(pair):points%first(pair + 1) - 1), &
         & level, angle)
   end subroutine begin

   !> Where the tool of a pair stands.
   function motion_of(points, model, dofs, pair, u) result(motion)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: pair
      real(wp), intent(in) :: u(:)
      type(rigid_motion_type) :: motion
      real(wp) :: rotation(3), origin(model%mesh%ndim)

      origin = 0.0_wp
      if (points%body(pair) == 0) then
         call new_rigid_motion(motion, origin, origin, [real(wp) ::])
         return
      end if
      rotation = rotation_of(points, model, dofs, pair, u)
      associate (node => model%rigid_body(points%body(pair))%reference)
         origin = model%mesh%x(:, node)
         call new_rigid_motion(motion, origin, place_of(model, dofs, node, u) - origin, &
            & rotation(merge(3, 1, model%mesh%ndim == 2):))
      end associate
   end function motion_of

   pure function rotation_of(points, model, dofs, pair, u) result(rotation)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: pair
      real(wp), intent(in) :: u(:)
      real(wp) :: rotation(3)
      integer :: k, dof

      rotation = 0.0_wp
      if (points%body(pair) == 0) return
      do k = 1, 3
         dof = dofs%id(k + 3, model%rigid_body(points%body(pair))%reference)
         if (dof > 0) rotation(k) = u(dof)
      end do
   end function rotation_of

   !> Where a node is under displacements.
   pure function place_of(model, dofs, node, u) result(x)
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node
      real(wp), intent(in) :: u(:)
      real(wp) :: x(model%mesh%ndim)
      integer :: k

      x = model%mesh%x(:, node)
      do k = 1, size(x)
         if (dofs%id(k, node) > 0) x(k) = x(k) + u(dofs%id(k, node))
      end do
   end function place_of

   !> Gap at the nearest foot that the point faces.
   subroutine look(points, model, pair, i, motion, x, faces, gap)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, i
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)
      logical, intent(out) :: faces
      real(wp), intent(out) :: gap             !! [length]
      type(foot_type) :: feet(2)
      integer :: n, k

      gap = 0.0_wp
      faces = .false.
      call project_all_moved(model%tool(points%tool(pair))%shape, motion, x, points%size(i), feet, &
         & n)
      do k = 1, n
         faces = feet(k)%found .and. feet(k)%overhang <= model%pair(pair)%extension*points%size(i)
         if (faces .and. any(abs(points%side(:, i)) > 0.0_wp)) &
            & faces = dot_product(points%side(:, i), feet(k)%normal) <= facing
         gap = feet(k)%gap
         if (faces) return
      end do
   end subroutine look
end module lopin_tool_sweep
