!> Contact constraints as rows: gap = gap0 + sum coefficient * u(dof).
!>
!> A sliding point has one row along the master's normal, a tied point one a direction; behind the
!> rows of all pairs stand the tangential rows of the points with friction, whose gaps are relative
!> displacements since the start.
module lopin_contact_rows
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_constraint_rules, only : follower_rule
   use lopin_contact_points, only : contact_points_type, sample_type, pair_is_tied
   use lopin_initial_gaps, only : initial_gap_type, may_tie
   use lopin_pair_friction, only : pair_slides_with_friction
   use lopin_tie_arm, only : find_tie_arm
   use lopin_row_samples, only : find_samples, base_samples, has_inner, row_value, frame_of
   implicit none
   private
   public :: contact_rows_type, new_contact_rows

   type :: contact_rows_type
      integer :: n = 0
      integer :: nnormal = 0                   !! rows of the pairs; tangential ones stand behind
      integer, allocatable :: tangent(:)   !! (nnormal) first tangential row of the point; 0: none
      integer, allocatable :: point(:)         !! (n)
      integer, allocatable :: group_first(:)   !! (npair+1)
      real(wp), allocatable :: direction(:, :) !! (3, n)
      logical, allocatable :: bilateral(:)     !! (n)
      logical, allocatable :: tied(:)          !! (n)
      real(wp), allocatable :: gap0(:)         !! (n) gap without displacements [length]
      integer, allocatable :: first(:), dof(:) !! (n+1) physical dofs of each row
      real(wp), allocatable :: coefficient(:)
   end type contact_rows_type

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

      allocate (self%group_first(size(model%pair) + 1))
      allocate (self%point(3*points%n), self%bilateral(3*points%n), self%tied(3*points%n))
      allocate (self%direction(3, 3*points%n), self%gap0(3*points%n), self%first(3*points%n + 1))
      ! Ties across a gap name their masters twice.
      terms = 2*(3*max(size(points%master, 1), 12) + 4)*3*points%n + inner_terms(points)
      allocate (self%dof(terms), self%coefficient(terms))
      self%first(1) = 1
      terms = 0
      do pair = 1, size(model%pair)
         self%group_first(pair) = self%n + 1
         tied = pair_is_tied(model, model%pair(pair))
         ! A tied point was projected at rest, and follows the tool from there.
         here = 0.0_wp
         if (points%body(pair) > 0 .and. .not. tied) here = place(:, points%body(pair))
         do i = points%first(pair), points%first(pair + 1) - 1
            if (points%facet(i) == 0 .or. .not. candidate(i)) cycle
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
      call trim_rows(self, terms)
   end subroutine new_contact_rows

   !> Arrays as long as they are filled.
   subroutine trim_rows(self, terms)
      type(contact_rows_type), intent(inout) :: self
      integer, intent(in) :: terms             !! of all rows

      self%point = self%point(:self%n)
      self%bilateral = self%bilateral(:self%n)
      self%tied = self%tied(:self%n)
      self%direction = self%direction(:, :self%n)
      self%gap0 = self%gap0(:self%n)
      self%first = self%first(:self%n + 1)
      self%dof = self%dof(:terms)
      self%coefficient = self%coefficient(:terms)
   end subroutine trim_rows

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

   !> Room for the terms of rows with points inside facets: those of one before they are joined,
   !> and of all after that, each facet with at most half as many more nodes as points.
   pure integer function inner_terms(points) result(terms)
      type(contact_points_type), intent(in) :: points
      integer :: i, most

      terms = 0
      if (.not. allocated(points%inner)) return
      most = 0
      do i = 1, points%n
         if (.not. has_inner(points, i)) cycle
         most = max(most, size(points%inner(i)%sample))
         terms = terms + 3*(3 + size(points%inner(i)%sample)/2) + 6
      end do
      terms = terms + 30*most
   end function inner_terms

   !> One term a dof in the row that is being made; what points inside facets weigh out is dropped.
   pure subroutine join_terms(self, terms)
      type(contact_rows_type), intent(inout) :: self
      integer, intent(inout) :: terms
      integer :: dof(terms - self%first(self%n) + 1), k, j, n, from
      real(wp) :: value(size(dof)), least

      from = self%first(self%n)
      n = 0
      do k = from, terms
         do j = 1, n
            if (dof(j) == self%dof(k)) exit
         end do
         if (j > n) then
            n = j
            dof(n) = self%dof(k)
            value(n) = 0.0_wp
         end if
         value(j) = value(j) + self%coefficient(k)
      end do
      if (n == 0) return
      least = 16.0_wp*epsilon(1.0_wp)*maxval(abs(value(:n)))
      terms = from - 1
      do k = 1, n
         if (abs(value(k)) <= least) cycle
         terms = terms + 1
         self%dof(terms) = dof(k)
         self%coefficient(terms) = value(k)
      end do
   end subroutine join_terms

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

   !> Terms of a row at all its samples, along one direction or, without any, along the normal of
   !> each.
   subroutine add_samples(self, model, dofs, points, sample, place, terms, along)
      type(contact_rows_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      type(sample_type), intent(in) :: sample(:)
      real(wp), intent(in) :: place(6)
      integer, intent(inout) :: terms
      real(wp), intent(in) :: along(:, :)      !! (3, 0 or 1)
      integer :: s

      do s = 1, size(sample)
         if (size(along, 2) > 0) then
            call add_terms(self, model, dofs, points, sample(s), along(:, 1), place, terms)
         else
            call add_terms(self, model, dofs, points, sample(s), sample(s)%normal, place, terms)
         end if
      end do
   end subroutine add_samples

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

   !> Where a sample is at the start.
   pure function place_of(sample, x) result(place)
      type(sample_type), intent(in) :: sample
      real(wp), intent(in) :: x(:, :)
      real(wp) :: place(size(x, 1))
      integer :: k

      place = 0.0_wp
      do k = 1, sample%nnode
         place = place + sample%shape(k)*x(:, sample%node(k))
      end do
   end function place_of

   !> A tie across a gap turns with the nodes opposite.
   pure subroutine add_arm(self, id, by, terms)
      type(contact_rows_type), intent(inout) :: self
      integer, intent(in) :: id(:, :)          !! (ndim, n) their dofs
      real(wp), intent(in) :: by(:, :)         !! (3, >= n)
      integer, intent(inout) :: terms
      integer :: k, m

      if (.not. any(abs(by(:, :size(id, 2))) > 0.0_wp)) return
      do m = 1, size(id, 2)
         do k = 1, size(id, 1)
            if (id(k, m) == 0) cycle
            terms = terms + 1
            self%dof(terms) = id(k, m)
            self%coefficient(terms) = -by(k, m)
         end do
      end do
      call join_terms(self, terms)
   end subroutine add_arm

   !> Terms of one sample, and for a tool the part of its motion that the projection already
   !> contains.
   subroutine add_terms(self, model, dofs, points, sample, direction, place, terms)
      type(contact_rows_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      type(sample_type), intent(in) :: sample
      real(wp), intent(in) :: direction(3), place(6)
      integer, intent(inout) :: terms
      integer :: k, m, ndim, body, dof(3), n, j, i
      real(wp) :: arm(3), coefficient(3), part(3), by(3, size(points%master, 1))

      ndim = model%mesh%ndim
      i = sample%point
      part = sample%c*direction
      do j = 1, sample%nnode
         do k = 1, ndim
            call add(dofs%id(k, sample%node(j)), sample%shape(j)*part(k))
         end do
      end do
      do m = 1, size(points%master, 1)
         if (points%master(m, i) == 0) exit
         do k = 1, ndim
            call add(dofs%id(k, points%master(m, i)), -part(k)*points%shape(m, i))
         end do
      end do
      if (self%tied(self%n)) then
         call find_tie_arm(model%mesh%x(:, points%master(:m - 1, i)), points%shape(:m - 1, i), &
            & place_of(sample, model%mesh%x), part, by)
         call add_arm(self, dofs%id(:ndim, points%master(:m - 1, i)), by, terms)
      end if
      body = points%body(points%pair(i))
      if (body == 0) return
      arm = 0.0_wp
      associate (reference => model%rigid_body(body)%reference)
         arm(:ndim) = sample%foot(:ndim) - model%mesh%x(:, reference) - place(:ndim)
         if (self%tied(self%n)) arm(:ndim) = place_of(sample, model%mesh%x) &
            & - model%mesh%x(:, reference)
         do k = 1, ndim
            call follower_rule(arm, ndim, k, dof, coefficient, n)
            do j = 1, n
               call add(dofs%id(dof(j), reference), -part(k)*coefficient(j))
               self%gap0(self%n) = self%gap0(self%n) + part(k)*coefficient(j)*place(dof(j))
            end do
         end do
      end associate

   contains

      subroutine add(id, value)
         integer, intent(in) :: id
         real(wp), intent(in) :: value
         if (id == 0 .or. value == 0.0_wp) return
         terms = terms + 1
         self%dof(terms) = id
         self%coefficient(terms) = value
      end subroutine add
   end subroutine add_terms
end module lopin_contact_rows
