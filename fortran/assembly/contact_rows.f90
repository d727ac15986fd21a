!> Contact constraints as rows: gap = gap0 + sum coefficient * u(dof).
!>
!> A sliding point has one row along the master's normal, a tied point one a direction; behind the
!> rows of all pairs stand the tangential rows of the points with friction, whose gaps are relative
!> displacements since the start. The frozen rule for initial gaps is applied here, and never
!> silently.
module lopin_contact_rows
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, initial_of
   use lopin_dofs, only : dofs_type
   use lopin_friction, only : friction_type, has_friction, law_of
   use lopin_constraint_rules, only : follower_rule
   use lopin_constraints, only : constraints_type
   use lopin_contact_points, only : contact_points_type, pair_is_tied
   implicit none
   private
   public :: initial_gap_type, new_initial_gaps, contact_rows_type, new_contact_rows, reduce_rows, &
      & row_forces, friction_in_step, pair_slides_with_friction

   !> Overclosures below this share of a facet are inexact geometry, not interference (frozen).
   real(wp), parameter :: inexact = 1.0e-3_wp
   !> Deeper overclosures, in facets, are mistakes.
   real(wp), parameter :: too_deep = 0.5_wp
   !> Gaps below this share of a facet are the rounding of coordinates: nothing is said of them.
   real(wp), parameter :: rounding = 1.0e-9_wp

   type :: initial_gap_type
      real(wp), allocatable :: shift(:)   !! (npoint) added to the geometric gap: ADJUST, CLEARANCE
                                          !! [length]
      real(wp), allocatable :: overclosure(:)   !! (npoint) >= 0, ramped in over the first step
                                                !! [length]
      logical, allocatable :: touches(:)       !! (npoint) closed at the start
   end type initial_gap_type

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

   !> ADJUST, CLEARANCE and the rule for overclosures of every pair.
   subroutine new_initial_gaps(self, model, points, log, error)
      type(initial_gap_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      allocate (self%shift(points%n), self%overclosure(points%n), source=0.0_wp)
      allocate (self%touches(points%n), source=.false.)
      do pair = 1, size(model%pair)
         call judge_pair(self, model, points, pair, log, error)
         if (allocated(error)) return
      end do
   end subroutine new_initial_gaps

   subroutine judge_pair(self, model, points, pair, log, error)
      type(initial_gap_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: i, adjusted, interfering, worst, untied
      real(wp) :: gap, deepest, moved
      logical :: adjust, keeps

      adjusted = 0
      interfering = 0
      worst = 0
      deepest = 0.0_wp
      moved = 0.0_wp
      untied = 0
      associate (p => model%pair(pair))
         keeps = model%interaction(p%interaction)%no_separation
         do i = points%first(pair), points%first(pair + 1) - 1
            if (pair_is_tied(model, p)) then
               if (.not. may_tie(points, i, p%adjust)) untied = untied + 1
               cycle
            end if
            if (points%facet(i) == 0) cycle
            gap = points%gap(i)
            if (p%has_clearance) then
               self%shift(i) = p%clearance - gap
               gap = p%clearance
            end if
            adjust = gap < 0.0_wp .and. gap > -inexact*points%size(i)
            ! What never separates is not pulled together by inexact geometry either.
            if (keeps) adjust = adjust .or. abs(gap) < inexact*points%size(i)
            if (p%adjust >= 0.0_wp) adjust = adjust .or. gap <= p%adjust
            if (allocated(p%adjust_node)) adjust = adjust .or. any(p%adjust_node == points%node(i))
            if (p%control%initial == initial_of%adjust) adjust = adjust .or. gap < 0.0_wp
            if (adjust .and. .not. p%has_clearance) then
               if (abs(gap) > rounding*points%size(i)) adjusted = adjusted + 1
               moved = max(moved, abs(gap))
               self%shift(i) = self%shift(i) - gap
               gap = 0.0_wp
            end if
            self%touches(i) = gap <= inexact*points%size(i)
            if (gap >= 0.0_wp) cycle
            self%overclosure(i) = -gap
            interfering = interfering + 1
            if (-gap/points%size(i) <= deepest) cycle
            deepest = -gap/points%size(i)
            worst = i
         end do
         if (adjusted > 0) call log%say(severity%note, 'N0316', to_text(adjusted)// &
            & ' slave points of '// &
            & model%surface(p%slave)%name//' were set on '//model%surface(p%master)%name// &
            & ' without strain, by at most '//to_text(moved), p%at)
         if (untied > 0) call log%say(severity%warning, 'W0318', to_text(untied)//' of '// &
            & to_text(points%first(pair + 1) - points%first(pair))//' slave nodes of '// &
            & model%surface(p%slave)%name// &
            & ' are not tied: they are farther than half a facet from '// &
            & model%surface(p%master)%name, p%at, &
            & help='ADJUST= on *CONTACT PAIR ties what is nearer than its value')
         if (interfering == 0) return
         call report_overclosure(model, points, pair, interfering, worst, deepest, log, error)
      end associate
   end subroutine judge_pair

   !> A point of a tied pair that has a master near enough.
   pure logical function may_tie(points, i, adjust)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: adjust           !! ADJUST= [length]
      may_tie = points%facet(i) > 0 .and. abs(points%gap(i)) <= max(too_deep*points%size(i), adjust)
   end function may_tie

   subroutine report_overclosure(model, points, pair, number, worst, deepest, log, error)
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair, number, worst
      real(wp), intent(in) :: deepest
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text, help, note

      associate (p => model%pair(pair))
         text = to_text(number)//' slave points of '//model%surface(p%slave)%name//' penetrate '// &
            & model%surface(p%master)%name//' at the start, the deepest, node '// &
            & to_text(model%mesh%node_label(points%node(worst)))//', by '// &
            & to_text(deepest*points%size(worst))//' ('//to_text(nint(100.0_wp*deepest))// &
            & ' % of a facet)'
         help = 'ADJUST='//to_text(1.01_wp*deepest*points%size(worst))// &
            & ' on *CONTACT PAIR moves them out without strain'
         if (deepest > too_deep .or. p%control%initial == initial_of%error) then
            note = 'INITIAL=ERROR asks to refuse it'
            if (deepest > too_deep) note = 'deeper than half a facet is a mistake of position, unit or side'
            call raise(error, error_code%deck, 'E0311', text, p%at, help=help, note=note)
         else if (p%control%initial == initial_of%interference .or. p%has_clearance) then
            call log%say(severity%note, 'N0311', text// &
               & ': an interference as meant, ramped in over the first step', &
               & p%at)
         else
            call log%say(severity%warning, 'W0311', text// &
               & ': treated as interference, ramped in over the first step', &
               & p%at, help=help//'; *CONTACT CONTROLS, INITIAL=INTERFERENCE says that it is meant')
         end if
      end associate
   end subroutine report_overclosure

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
      logical :: tied

      allocate (self%group_first(size(model%pair) + 1))
      allocate (self%point(3*points%n), self%bilateral(3*points%n), self%tied(3*points%n))
      allocate (self%direction(3, 3*points%n), self%gap0(3*points%n), self%first(3*points%n + 1))
      terms = (3*size(points%master, 1) + 4)*3*points%n
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
            ndirection = 1
            if (tied) ndirection = model%mesh%ndim
            do d = 1, ndirection
               self%n = self%n + 1
               self%point(self%n) = i
               self%direction(:, self%n) = frame(:, d)
               self%tied(self%n) = tied
               self%bilateral(self%n) = tied .or. (sticks(i) &
                  & .and. model%interaction(model%pair(pair)%interaction)%no_separation)
               self%gap0(self%n) = 0.0_wp
               if (.not. tied) self%gap0(self%n) = points%gap(i) + initial%shift(i)
               call add_terms(self, model, dofs, points, i, frame(:, d), here, terms)
               self%first(self%n + 1) = terms + 1
            end do
         end do
      end do
      self%group_first(size(model%pair) + 1) = self%n + 1
      self%nnormal = self%n
      call add_tangents(self, model, dofs, points, place, terms)
      self%point = self%point(:self%n)
      self%bilateral = self%bilateral(:self%n)
      self%tied = self%tied(:self%n)
      self%direction = self%direction(:, :self%n)
      self%gap0 = self%gap0(:self%n)
      self%first = self%first(:self%n + 1)
      self%dof = self%dof(:terms)
      self%coefficient = self%coefficient(:terms)
   end subroutine new_contact_rows

   !> Tangential rows of the points with friction.
   subroutine add_tangents(self, model, dofs, points, place, terms)
      type(contact_rows_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      real(wp), intent(in) :: place(:, :)
      integer, intent(inout) :: terms
      real(wp) :: frame(3, 3), here(6)
      integer :: row, d, pair

      allocate (self%tangent(self%nnormal), source=0)
      do pair = 1, size(model%pair)
         if (.not. pair_slides_with_friction(model, pair)) cycle
         here = 0.0_wp
         if (points%body(pair) > 0) here = place(:, points%body(pair))
         do row = self%group_first(pair), self%group_first(pair + 1) - 1
            call frame_of(points%normal(:, self%point(row)), model%mesh%ndim, frame)
            self%tangent(row) = self%n + 1
            do d = 2, model%mesh%ndim
               self%n = self%n + 1
               self%point(self%n) = self%point(row)
               self%direction(:, self%n) = frame(:, d)
               self%tied(self%n) = .false.
               self%bilateral(self%n) = .false.
               self%gap0(self%n) = 0.0_wp
               call add_terms(self, model, dofs, points, self%point(row), frame(:, d), here, terms)
               self%gap0(self%n) = 0.0_wp
               self%first(self%n + 1) = terms + 1
            end do
         end do
      end do
   end subroutine add_tangents

   !> The friction of an interaction in a step, after the changes of that and all earlier steps.
   pure function friction_in_step(model, interaction, step) result(friction)
      type(model_type), intent(in) :: model
      integer, intent(in) :: interaction, step
      type(friction_type) :: friction
      integer :: i, k

      friction = model%interaction(interaction)%friction
      do i = 1, step
         if (.not. allocated(model%step(i)%friction_change)) cycle
         associate (change => model%step(i)%friction_change)
            do k = 1, size(change)
               if (change(k)%interaction == interaction) friction = change(k)%friction
            end do
         end associate
      end do
   end function friction_in_step

   !> The pair has friction in some step: its points keep tangential rows in all of them.
   pure logical function pair_slides_with_friction(model, pair) result(slides)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      integer :: step

      slides = .false.
      if (pair_is_tied(model, model%pair(pair))) return
      do step = 1, size(model%step)
         slides = slides .or. resists(friction_in_step(model, model%pair(pair)%interaction, step))
      end do
   end function pair_slides_with_friction

   !> mu = 0 is no friction at all: the frictionless kernel solves it.
   pure logical function resists(friction)
      type(friction_type), intent(in) :: friction

      resists = has_friction(friction)
      if (friction%rough .or. friction%law /= law_of%coulomb) return
      resists = friction%mu > 0.0_wp .or. (friction%decay > 0.0_wp .and. friction%mu_static > 0.0_wp)
   end function resists

   !> Unit normal and tangents, as columns.
   pure subroutine frame_of(normal, ndim, frame)
      real(wp), intent(in) :: normal(3)
      integer, intent(in) :: ndim
      real(wp), intent(out) :: frame(3, 3)
      integer :: least

      frame(:, 1) = normal
      if (ndim == 2) then
         frame(:, 2) = [-normal(2), normal(1), 0.0_wp]
         frame(:, 3) = [0.0_wp, 0.0_wp, 1.0_wp]
         return
      end if
      least = minloc(abs(normal), 1)
      frame(:, 2) = -normal*normal(least)
      frame(least, 2) = frame(least, 2) + 1.0_wp
      frame(:, 2) = frame(:, 2)/norm2(frame(:, 2))
      frame(:, 3) = [normal(2)*frame(3, 2) - normal(3)*frame(2, 2), normal(3)*frame(1, 2) &
         & - normal(1)*frame(3, 2), &
         & normal(1)*frame(2, 2) - normal(2)*frame(1, 2)]
   end subroutine frame_of

   !> Terms of one row, and for a tool the part of its motion that the projection already contains.
   subroutine add_terms(self, model, dofs, points, i, direction, place, terms)
      type(contact_rows_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: direction(3), place(6)
      integer, intent(inout) :: terms
      integer :: k, m, ndim, body, dof(3), n, j
      real(wp) :: arm(3), coefficient(3)

      ndim = model%mesh%ndim
      do k = 1, ndim
         call add(dofs%id(k, points%node(i)), direction(k))
      end do
      do m = 1, size(points%master, 1)
         if (points%master(m, i) == 0) exit
         do k = 1, ndim
            call add(dofs%id(k, points%master(m, i)), -direction(k)*points%shape(m, i))
         end do
      end do
      body = points%body(points%pair(i))
      if (body == 0) return
      arm = 0.0_wp
      associate (reference => model%rigid_body(body)%reference)
         arm(:ndim) = points%foot(:ndim, i) - model%mesh%x(:, reference) - place(:ndim)
         do k = 1, ndim
            call follower_rule(arm, ndim, k, dof, coefficient, n)
            do j = 1, n
               call add(dofs%id(dof(j), reference), -direction(k)*coefficient(j))
               self%gap0(self%n) = self%gap0(self%n) + direction(k)*coefficient(j)*place(dof(j))
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

   !> Rows on the free equations, and what prescribed displacements (in `u_known`) do to the gaps.
   subroutine reduce_rows(self, constraints, u_known, first, equation, value, gap)
      type(contact_rows_type), intent(in) :: self
      type(constraints_type), intent(in) :: constraints
      real(wp), intent(in) :: u_known(:)   !! (ndof) displacements with all equations zero
      integer, allocatable, intent(out) :: first(:), equation(:)
      real(wp), allocatable, intent(out) :: value(:), gap(:)
      integer :: row, k, c, m, from, total
      integer, allocatable :: seen(:)

      total = 0
      do k = 1, size(self%dof)
         total = total + constraints%first(self%dof(k) + 1) - constraints%first(self%dof(k))
      end do
      allocate (first(self%n + 1), equation(total), seen(constraints%neq), source=0)
      allocate (value(total), source=0.0_wp)
      allocate (gap, source=self%gap0)
      m = 0
      first(1) = 1
      do row = 1, self%n
         from = m + 1
         do k = self%first(row), self%first(row + 1) - 1
            gap(row) = gap(row) + self%coefficient(k)*u_known(self%dof(k))
            do c = constraints%first(self%dof(k)), constraints%first(self%dof(k) + 1) - 1
               associate (eq => constraints%equation(c))
                  if (seen(eq) < from) then
                     m = m + 1
                     seen(eq) = m
                     equation(m) = eq
                     value(m) = 0.0_wp
                  end if
                  value(seen(eq)) = value(seen(eq)) + self%coefficient(k)*constraints%coefficient(c)
               end associate
            end do
         end do
         first(row + 1) = m + 1
      end do
      equation = equation(:m)
      value = value(:m)
   end subroutine reduce_rows

   !> Forces on the physical dofs from forces of the rows.
   pure subroutine row_forces(self, force, f)
      type(contact_rows_type), intent(in) :: self
      real(wp), intent(in) :: force(:)       !! (n) [force]
      real(wp), intent(inout) :: f(:)        !! (ndof) added to
      integer :: row, k

      do row = 1, self%n
         do k = self%first(row), self%first(row + 1) - 1
            f(self%dof(k)) = f(self%dof(k)) + self%coefficient(k)*force(row)
         end do
      end do
   end subroutine row_forces
end module lopin_contact_rows
