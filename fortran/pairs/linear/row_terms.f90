!> Rows of contact as lists of terms: one sample after the other, the slave's and the master's.
module lopin_row_terms
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_constraint_rules, only : follower_rule
   use lopin_contact_points, only : contact_points_type, sample_type
   use lopin_tie_arm, only : find_tie_arm
   use lopin_row_samples, only : has_inner
   implicit none
   private
   public :: contact_rows_type, joins_pair, reserve_rows, trim_rows, join_terms, add_samples

   type :: contact_rows_type
      integer :: n = 0
      integer :: nnormal = 0                   !! rows of the pairs; tangential ones stand behind
      integer :: nsolved = 0                   !! rows that are solved for their forces
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

   !> A row of a pair's normal or of a tie, not of friction.
   pure logical function joins_pair(self, row)
      type(contact_rows_type), intent(in) :: self
      integer, intent(in) :: row
      joins_pair = row <= self%nnormal .or. row > self%nsolved
   end function joins_pair

   !> Room for the rows of all points.
   subroutine reserve_rows(self, npair, points)
      type(contact_rows_type), intent(inout) :: self
      integer, intent(in) :: npair
      type(contact_points_type), intent(in) :: points
      integer :: terms

      allocate (self%group_first(npair + 1), source=1)
      allocate (self%point(3*points%n), self%bilateral(3*points%n), self%tied(3*points%n))
      allocate (self%direction(3, 3*points%n), self%gap0(3*points%n), self%first(3*points%n + 1))
      ! Ties across a gap name their masters twice.
      terms = 2*(3*max(size(points%master, 1), 12) + 4)*3*points%n + inner_terms(points)
      allocate (self%dof(terms), self%coefficient(terms))
      self%first(1) = 1
   end subroutine reserve_rows

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
end module lopin_row_terms
