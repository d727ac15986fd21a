!> Contact constraints as rows: gap = gap0 + sum coefficient * u(dof).
!>
!> A sliding point has one row along the master's normal, a tied point one a direction; behind the
!> rows of all pairs stand the tangential rows of the points with friction, whose gaps are relative
!> displacements since the start, and behind these the rows of eliminated ties, whose forces are no
!> unknowns.
module lopin_contact_rows
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_contact_points, only : contact_points_type, sample_type, pair_is_tied, &
      & is_eliminated, is_released
   use lopin_initial_gaps, only : initial_gap_type, may_tie
   use lopin_pair_friction, only : pair_slides_with_friction
   use lopin_row_terms, only : contact_rows_type, joins_pair, reserve_rows, trim_rows, &
      & join_terms, add_samples
   use lopin_row_samples, only : find_samples, base_samples, has_inner, row_value, frame_of
   implicit none
   private
   public :: contact_rows_type, new_contact_rows, new_eliminated_rows, joins_pair

contains

   !> Rows of all points that have a master opposite.
   !>
   !> `place` is where each rigid body's reference was when its tool was projected (6, nbody).
   subroutine new_contact_rows(self, model, dofs, points, initial, place, sticks, candidate)
      type(contact_rows_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      type(initial_gap_type), intent(in) :: initial
      real(wp), intent(in) :: place(:, :)
      logical, intent(in) :: sticks(:)   !! (npoint) closed once, never to open (NO SEPARATION)
      logical, intent(in) :: candidate(:)      !! (npoint) others get no row
      integer :: pair, i, d, ndirection, terms
      real(wp) :: frame(3, 3), here(6)
      type(sample_type), allocatable :: sample(:)
      logical :: tied

      call reserve_rows(self, size(model%pair), points)
      terms = 0
      do pair = 1, size(model%pair)
         self%group_first(pair) = self%n + 1
         tied = pair_is_tied(model, model%pair(pair))
         ! A tied point was projected at rest, and follows the tool from there.
         here = 0.0_wp
         if (points%body(pair) > 0 .and. .not. tied) here = place(:, points%body(pair))
         do i = points%first(pair), points%first(pair + 1) - 1
            if (points%facet(i) == 0 .or. .not. candidate(i)) cycle
            if (is_eliminated(points, i)) cycle
            if (tied .and. .not. may_tie(points, i, model%pair(pair)%adjust)) cycle
            call frame_of(points%normal(:, i), model%mesh%ndim, frame)
            call find_samples(points, i, model%mesh%x, sample)
            ndirection = 1
            if (tied) call take_held(points, i, model%mesh%ndim, frame, ndirection)
            do d = 1, ndirection
               self%n = self%n + 1
               self%point(self%n) = i
               self%direction(:, self%n) = frame(:, d)
               if (.not. tied .and. size(sample) > 1) self%direction(:, self%n) = &
                  & resultant(sample)
               self%tied(self%n) = tied
               self%bilateral(self%n) = tied .or. (sticks(i) &
                  & .and. model%interaction(model%pair(pair)%interaction)%no_separation)
               self%gap0(self%n) = 0.0_wp
               if (.not. tied) self%gap0(self%n) = gap_of(sample) &
                  & + row_value(points, sample, initial%shift)
               call add_samples(self, model, dofs, points, sample, here, terms, &
                  & frame(:, d:merge(d, d - 1, tied)))
               if (has_inner(points, i)) call join_terms(self, terms)
               self%first(self%n + 1) = terms + 1
            end do
         end do
      end do
      self%group_first(size(model%pair) + 1) = self%n + 1
      self%nnormal = self%n
      call add_tangents(self, model, dofs, points, place, terms)
      self%nsolved = self%n
      call add_eliminated(self, model, dofs, points, terms)
      call trim_rows(self, terms)
   end subroutine new_contact_rows

   !> Rows of the eliminated ties alone.
   subroutine new_eliminated_rows(self, model, dofs, points)
      type(contact_rows_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      integer :: terms

      call reserve_rows(self, size(model%pair), points)
      terms = 0
      call add_eliminated(self, model, dofs, points, terms)
      call trim_rows(self, terms)
   end subroutine new_eliminated_rows

   !> One row a dof of an eliminated node, its own term first.
   subroutine add_eliminated(self, model, dofs, points, terms)
      type(contact_rows_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      integer, intent(inout) :: terms
      type(sample_type), allocatable :: sample(:)
      real(wp) :: along(3, 1)
      integer :: i, d

      if (.not. allocated(points%eliminated)) return
      do i = 1, points%n
         if (.not. points%eliminated(i)) cycle
         call find_samples(points, i, model%mesh%x, sample)
         do d = 1, model%mesh%ndim
            if (is_released(points, i, d)) cycle
            along(:, 1) = 0.0_wp
            along(d, 1) = 1.0_wp
            self%n = self%n + 1
            self%point(self%n) = i
            self%direction(:, self%n) = along(:, 1)
            self%tied(self%n) = .true.
            self%bilateral(self%n) = .true.
            self%gap0(self%n) = 0.0_wp
            call add_samples(self, model, dofs, points, sample, [real(wp) :: 0, 0, 0, 0, 0, 0], &
               & terms, along)
            call join_terms(self, terms)
            self%first(self%n + 1) = terms + 1
         end do
      end do
   end subroutine add_eliminated

   !> The directions in which a tie holds a point: the frame's, or what its supports leave.
   pure subroutine take_held(points, i, ndim, frame, n)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i, ndim
      real(wp), intent(inout) :: frame(3, 3)
      integer, intent(out) :: n

      n = ndim
      if (.not. allocated(points%released)) return
      n = ndim - points%released(i)
      if (n == ndim) return
      frame = 0.0_wp
      frame(:, :n) = points%axes(:, points%released(i) + 1:ndim, i)
   end subroutine take_held

   !> Force of the samples for a unit force of the row.
   pure function resultant(sample) result(total)
      type(sample_type), intent(in) :: sample(:)
      real(wp) :: total(3)
      integer :: s

      total = 0.0_wp
      do s = 1, size(sample)
         total = total + sample(s)%c*sample(s)%normal
      end do
   end function resultant

   pure real(wp) function gap_of(sample) result(gap)
      type(sample_type), intent(in) :: sample(:)
      gap = sample(1)%gap
      if (size(sample) > 1) gap = dot_product(sample%c, sample%gap)
   end function gap_of

   !> Tangential rows of the points with friction.
   subroutine add_tangents(self, model, dofs, points, place, terms)
      type(contact_rows_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      real(wp), intent(in) :: place(:, :)
      integer, intent(inout) :: terms
      real(wp) :: frame(3, 3), here(6)
      type(sample_type), allocatable :: sample(:)
      integer :: row, d, pair

      allocate (self%tangent(self%nnormal), source=0)
      do pair = 1, size(model%pair)
         if (.not. pair_slides_with_friction(model, pair)) cycle
         here = 0.0_wp
         if (points%body(pair) > 0) here = place(:, points%body(pair))
         do row = self%group_first(pair), self%group_first(pair + 1) - 1
            call frame_of(points%normal(:, self%point(row)), model%mesh%ndim, frame)
            if (has_inner(points, self%point(row))) then
               ! Slips of points inside facets weigh out, along the row's plane.
               call frame_of(self%direction(:, row)/norm2(self%direction(:, row)), &
                  & model%mesh%ndim, frame)
               call base_samples(points, self%point(row), model%mesh%x, sample)
            else
               call find_samples(points, self%point(row), model%mesh%x, sample)
            end if
            self%tangent(row) = self%n + 1
            do d = 2, model%mesh%ndim
               self%n = self%n + 1
               self%point(self%n) = self%point(row)
               self%direction(:, self%n) = frame(:, d)
               self%tied(self%n) = .false.
               self%bilateral(self%n) = .false.
               self%gap0(self%n) = 0.0_wp
               call add_samples(self, model, dofs, points, sample, here, terms, frame(:, d:d))
               self%gap0(self%n) = 0.0_wp
               self%first(self%n + 1) = terms + 1
            end do
         end do
      end do
   end subroutine add_tangents

end module lopin_contact_rows
