!> A body does not pass through another or through a tool within an increment, on the present shape.
module lopin_nonlinear_sweep
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_sweep, only : sweep_type, new_sweep, next_share, take_gap
   use lopin_rigid_motion, only : rigid_motion_type
   use lopin_master_surfaces, only : move_masters
   use lopin_closest_feature, only : opposite_type, find_opposite, cut_off
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   implicit none
   private
   public :: find_passage, measure_ways, gap_of

contains

   !> A point that passes through its master between two states; 0: none. `lost`: and the contacts
   !> of the second state do not know it.
   subroutine find_passage(self, model, from, to, passed, lost, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: from(:), to(:)   !! (ndof) accepted and trial displacements
      integer, intent(out) :: passed
      logical, intent(out) :: lost
      type(error_type), allocatable, intent(out) :: error
      type(sweep_type) :: sweep
      type(opposite_type) :: opposite
      real(wp) :: way(self%n), gap(self%n), level(self%n), turn
      integer :: k, i

      passed = 0
      lost = .false.
      if (self%n == 0) return
      call measure_ways(self, model, from, to, way, turn)
      call gaps_at_ends(self, model, gap, level)
      call new_sweep(sweep, gap, way, self%size, level, turn)
      if (sweep%n == 0) return
      do while (next_share(sweep))
         call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, &
            & from + sweep%share*(to - from), .false., self%cost, error)
         if (allocated(error)) return
         do k = 1, sweep%n
            if (sweep%due(k) > sweep%share) cycle
            i = sweep%point(k)
            call find_opposite(opposite, self%masters, model, self%nonlinear_points_type, i, &
               & self%cost)
            call take_gap(sweep, k, opposite%facet > 0, gap_of(self, model, i, opposite))
         end do
      end do
      call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, to, .false., &
         & self%cost, error)
      passed = sweep%passed
      do k = 1, sweep%n
         if (passed > 0) exit
         i = sweep%point(k)
         ! Behind when last seen, and not in front again.
         if (sweep%behind(k) .and. self%status(i) == 0 .and. .not. (self%facet(i) > 0 &
            & .and. self%opening(i) >= merge(level(i), 0.0_wp, &
            & self%masters%of(self%pair(i))%against_itself))) passed = i
      end do
      if (passed > 0) lost = self%status(passed) == 0
   end subroutine find_passage

   !> How far points move beside their masters; nothing where a pair is tied or away.
   subroutine measure_ways(self, model, from, to, way, turn)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: from(:), to(:)
      real(wp), intent(out) :: way(:)
      real(wp), intent(out) :: turn            !! largest rotation of a tool [rad]
      real(wp) :: moved(3), about(3, size(model%pair)), spread_(size(model%pair)), &
         & angle(3, size(model%pair))
      integer :: pair, i, d

      d = model%mesh%ndim
      turn = 0.0_wp
      do pair = 1, size(model%pair)
         call master_motion(self, model, pair, from, to, about(:, pair), angle(:, pair), &
            & spread_(pair))
         turn = max(turn, norm2(angle(:, pair)))
      end do
      way = 0.0_wp
      do i = 1, self%n
         pair = self%pair(i)
         if (.not. self%pair_active(pair) .or. self%enforcement(i)%tied) cycle
         ! In a corner of a fold what a node is behind of is no wall: it has to come from the front.
         if (self%masters%of(pair)%against_itself .and. .not. (self%start_gap(i) < huge(1.0_wp) &
            & .and. self%start_gap(i) >= -cut_off*self%size(i))) cycle
         moved = node_motion(self, self%node(i), from, to) - about(:, pair)
         way(i) = norm2(moved) + spread_(pair)
         if (any(abs(angle(:, pair)) > 0.0_wp)) then
            ! Beside the motion of the tool's own point there.
            associate (m => self%masters%of(pair)%motion)
               moved(:d) = self%masters%x(:, self%node(i)) - m%reference(:d) - m%displacement(:d)
               way(i) = min(way(i) + norm2(angle(:, pair))*norm2(moved(:d)), &
                  & beside_turning(self, m, i, from, to, about(:, pair), angle(:, pair)))
            end associate
         end if
      end do
   end subroutine measure_ways

   !> Way of a point beside a tool that moves and turns: chord of the small rotation, and its sag.
   pure real(wp) function beside_turning(self, motion, i, from, to, about, angle) result(way)
      type(nonlinear_contact_type), intent(in) :: self
      type(rigid_motion_type), intent(in) :: motion
      integer, intent(in) :: i
      real(wp), intent(in) :: from(:), to(:), about(3), angle(3)
      real(wp) :: arm(3), moved(3)
      integer :: d

      d = size(self%masters%x, 1)
      arm = 0.0_wp
      moved = node_motion(self, self%node(i), from, to)
      arm(:d) = self%masters%x(:, self%node(i)) - motion%reference(:d) - motion%displacement(:d)
      arm = arm - 0.5_wp*(moved - about)
      moved = moved - about - [angle(2)*arm(3) - angle(3)*arm(2), angle(3)*arm(1) &
         & - angle(1)*arm(3), angle(1)*arm(2) - angle(2)*arm(1)]
      way = norm2(moved) + 0.5_wp*dot_product(angle, angle)*norm2(arm)
   end function beside_turning

   !> Motion of a master: its mean, its rotation, and how far parts of it differ from the mean.
   subroutine master_motion(self, model, pair, from, to, about, angle, differs)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: from(:), to(:)
      real(wp), intent(out) :: about(3), angle(3), differs
      integer :: k, dof

      about = 0.0_wp
      angle = 0.0_wp
      differs = 0.0_wp
      associate (m => self%masters%of(pair))
         if (m%tool > 0) then
            if (m%body == 0) return
            associate (node => model%rigid_body(m%body)%reference)
               about = node_motion(self, node, from, to)
               do k = 1, 3
                  dof = self%dofs%id(k + 3, node)
                  if (dof > 0) angle(k) = to(dof) - from(dof)
               end do
            end associate
            return
         end if
         do k = 1, m%surface%nnode
            about = about + node_motion(self, m%surface%node(k), from, to)/m%surface%nnode
         end do
         do k = 1, m%surface%nnode
            differs = max(differs, norm2(node_motion(self, m%surface%node(k), from, to) - about))
         end do
      end associate
   end subroutine master_motion

   pure function node_motion(self, node, from, to) result(moved)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: node
      real(wp), intent(in) :: from(:), to(:)
      real(wp) :: moved(3)
      integer :: k

      moved = 0.0_wp
      do k = 1, size(self%masters%x, 1)
         if (self%dofs%id(k, node) > 0) moved(k) = to(self%dofs%id(k, node)) &
            & - from(self%dofs%id(k, node))
      end do
   end function node_motion

   !> Gaps at the start, and the least that start and end allow.
   subroutine gaps_at_ends(self, model, gap, level)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: gap(:), level(:)
      integer :: i

      do i = 1, self%n
         gap(i) = -1.0_wp
         level(i) = 0.0_wp
         if (self%masters%of(self%pair(i))%against_itself) level(i) = -cut_off*self%size(i)
         if (self%start_gap(i) < huge(1.0_wp)) then
            gap(i) = self%start_gap(i) + shift_of(self, model, i)
            level(i) = min(level(i), gap(i))
         end if
         if (self%facet(i) > 0 .and. self%status(i) /= 0) level(i) = min(level(i), &
            & self%opening(i) - model%interaction(model%pair(self%pair(i))%interaction)%clearance)
      end do
   end subroutine gaps_at_ends

   pure real(wp) function gap_of(self, model, i, opposite) result(gap)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      type(opposite_type), intent(in) :: opposite

      gap = opposite%found%gap
      if (self%masters%of(self%pair(i))%tool > 0) gap = opposite%foot%gap
      gap = gap + shift_of(self, model, i)
   end function gap_of

   !> Added to gaps as they are found [length].
   pure real(wp) function shift_of(self, model, i) result(shift)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i

      shift = self%shift(i) + (1.0_wp - self%interference)*self%overclosure(i) &
         & - model%interaction(model%pair(self%pair(i))%interaction)%clearance
   end function shift_of
end module lopin_nonlinear_sweep
