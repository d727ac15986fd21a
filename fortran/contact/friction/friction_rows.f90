!> Friction at points as semismooth equations in the forces and gaps of their rows.
!>
!> With the force lambda [force] and the gap g [length] of each row, in force units:
!>
!>    normal       lambda_n - <lambda_n - c_n (g_n + compliance_n lambda_n - shift)>          = 0
!>    exact        lambda_t - F(|q|, p) q/|q|,  q = lambda_t - c_t slip                       = 0
!>    regularised  lambda_t + F(|s|, p) s/|s|,  s the slip since the anchor or the increment  = 0
!>
!> (Alart and Curnier, CMAME 92, 1991). `slip` is what the elastic stick displacement leaves of the
!> tangential gap since the last accepted increment: exact stick where the tangential compliance is
!> zero. c_n and c_t only decide the sets; no answer depends on them.
module lopin_friction_rows
   use lopin_kinds, only : wp
   use lopin_condensed, only : condensed_type
   use lopin_friction, only : friction_type, condition_type, friction_radius, is_regularised, &
      & by_rate, reads_speed
   use lopin_friction_return, only : return_to_disc, regularised_traction, drag_limit, &
      & at_rest, steepest_fall
   use lopin_tool, only : outer => outer_product
   implicit none
   private
   public :: friction_points_type, equations_type, new_equations, form_equations, slip_of
   public :: elastic_compliance, no_deformation

   !> Points with friction, and what they keep from the last accepted increment.
   type :: friction_points_type
      integer :: n = 0
      integer :: nt = 1                            !! tangential rows of a point
      integer, allocatable :: normal(:)            !! (n) row of the pressure
      integer, allocatable :: tangent(:)           !! (n) first tangential row; the next follows
      type(friction_type), allocatable :: law(:)   !! (n)
      type(condition_type), allocatable :: at(:)   !! (n)
      real(wp), allocatable :: weight(:)           !! (n) [length^2]
      real(wp), allocatable :: stiffness(:)   !! (n) of elastic stick, 0: see next [force/length]
      real(wp), allocatable :: elastic_slip(:)     !! (n) at the bound; 0: exact stick [length]
      real(wp), allocatable :: traction(:, :)      !! (nt, n) accepted [force]
      real(wp), allocatable :: start(:, :)         !! (nt, n) tangential gaps accepted [length]
      real(wp), allocatable :: way(:, :)   !! (nt, n) slip of the accepted increment, which the next
                                           !! one begins with; unallocated: none [length]
      real(wp), allocatable :: open(:)   !! (n) gaps accepted; unallocated: all touch [length]
      real(wp), allocatable :: touch(:)  !! (n) share of the increment before they touched [-]
      real(wp), allocatable :: anchor(:, :)        !! (nt, n) slip from the anchor accepted [length]
      real(wp), allocatable :: elastic(:, :)       !! (nt, n) elastic slip accepted [length]
      logical, allocatable :: augmented(:)   !! (n) elastic slip vanishes by augmentation
   end type friction_points_type

   !> All rows at a state: residual, and P d(lambda) + Q d(gap) = -residual, each point's own.
   type :: equations_type
      logical, allocatable :: linear(:)   !! (nrow) normal row of a spring or an unknown; else a law
      real(wp), allocatable :: c(:)                !! (nrow) scaling [force/length]
      real(wp), allocatable :: compliance(:)       !! (nrow) normal rows [length/force]
      real(wp), allocatable :: extra(:)   !! (nrow) of rows that nothing deforms [length/force]
      real(wp), allocatable :: shift(:)            !! (nrow) [length]
      real(wp), allocatable :: frozen(:)  !! (npoint) pressing force of the bound; unallocated: own
      logical :: damped = .false.                  !! tangent of Hueeber, Stadler and Wohlmuth
      integer, allocatable :: group(:)             !! (nrow) 0: tangential
      ! at a state
      logical, allocatable :: set(:)      !! (nrow) closed rows of the tangent; unallocated: natural
      logical, allocatable :: natural(:)           !! (nrow) rows that press, by their residual
      logical, allocatable :: closed(:)            !! (nrow) rows of the tangent that press
      integer, allocatable :: status(:)            !! (npoint) 0 open, 1 stick, 2 slip
      real(wp), allocatable :: residual(:)         !! (nrow) [force]
      real(wp), allocatable :: diagonal(:), gap_diagonal(:)   !! (nrow) P and Q of normal rows
      real(wp), allocatable :: p(:, :, :), q(:, :, :)   !! (nt, 0:nt, npoint) of tangential rows;
                                                         !! column 0: the normal row
   end type equations_type

   !> What a row that nothing deforms yields by, beside the mean compliance.
   real(wp), parameter :: no_deformation = 1.0e-12_wp

contains

   !> Room for the equations of a problem, with their scales.
   subroutine new_equations(self, problem, points)
      type(equations_type), intent(out) :: self
      type(condensed_type), intent(in) :: problem
      type(friction_points_type), intent(in) :: points
      integer :: group, row, n
      real(wp) :: mean, most

      n = problem%nrow
      allocate (self%linear(n), source=.true.)
      allocate (self%c(n), self%compliance(n), self%extra(n), self%shift(n), self%residual(n), &
         & self%diagonal(n), self%gap_diagonal(n), source=0.0_wp)
      allocate (self%group(n), self%status(points%n), source=0)
      allocate (self%closed(n), self%natural(n), source=.false.)
      allocate (self%p(points%nt, 0:points%nt, points%n), self%q(points%nt, 0:points%nt, points%n))
      do group = 1, problem%ngroup
         do row = problem%group_first(group), problem%group_first(group + 1) - 1
            self%group(row) = group
            associate (method => problem%group(group)%method)
               self%linear(row) = method%piecewise_linear()
               if (method%solves_for_multiplier()) then
                  self%compliance(row) = method%compliance(problem%alpha(row))
               else if (self%linear(row)) then
                  self%compliance(row) = 1.0_wp/problem%alpha(row)
               end if
            end associate
         end do
      end do
      mean = 0.0_wp
      most = 0.0_wp
      do row = 1, n
         mean = mean + problem%s(row, row)/n
         most = max(most, problem%s(row, row))
      end do
      if (.not. mean > 0.0_wp) mean = 1.0_wp
      do row = 1, n
         if (.not. problem%s(row, row) > no_deformation*most) self%extra(row) = no_deformation*mean
         self%c(row) = 1.0_wp/(max(problem%s(row, row), no_deformation*mean) + self%compliance(row))
         if (self%extra(row) > 0.0_wp) self%c(row) = 1.0_wp/(mean + self%compliance(row))
      end do
   end subroutine new_equations

   !> Residuals, states and slopes at forces and gaps.
   subroutine form_equations(self, problem, points, force, gap)
      type(equations_type), intent(inout) :: self
      type(condensed_type), intent(in) :: problem
      type(friction_points_type), intent(in) :: points
      real(wp), intent(in) :: force(:), gap(:)     !! (nrow)
      integer :: row, k

      do row = 1, problem%nrow
         if (self%group(row) > 0) call normal_row(self, problem, row, force(row), gap(row))
      end do
      do k = 1, points%n
         associate (first => points%tangent(k), last => points%tangent(k) + points%nt - 1)
            self%closed(first:last) = self%closed(points%normal(k))
            if (.not. self%closed(points%normal(k))) then
               self%status(k) = 0
               self%residual(first:last) = force(first:last)
               self%p(:, :, k) = 0.0_wp
               self%q(:, :, k) = 0.0_wp
            else if (is_regularised(points%law(k))) then
               call regularised_rows(self, points, k, force, gap)
            else
               call exact_rows(self, points, k, force, gap)
            end if
         end associate
      end do
   end subroutine form_equations

   subroutine normal_row(self, problem, row, force, gap)
      type(equations_type), intent(inout) :: self
      type(condensed_type), intent(in) :: problem
      integer, intent(in) :: row
      real(wp), intent(in) :: force, gap
      real(wp) :: trial, pressed, stiffness

      if (.not. self%linear(row)) then
         call problem%group(self%group(row))%method%forces(gap, problem%alpha(row), 0.0_wp, &
            & problem%bilateral(row), pressed, stiffness)
         self%natural(row) = pressed > 0.0_wp
         self%closed(row) = self%natural(row)
         self%residual(row) = force - pressed
         self%diagonal(row) = 1.0_wp
         self%gap_diagonal(row) = stiffness
         return
      end if
      trial = force - self%c(row)*opening(self, row, force, gap)
      self%natural(row) = trial > 0.0_wp .or. problem%bilateral(row)
      self%closed(row) = self%natural(row)
      if (allocated(self%set)) self%closed(row) = self%set(row)
      self%residual(row) = force
      if (self%closed(row)) self%residual(row) = force - trial
      self%diagonal(row) = self%c(row)*(self%compliance(row) + self%extra(row))
      self%gap_diagonal(row) = self%c(row)
   end subroutine normal_row

   !> What a closed normal row makes zero [length].
   pure real(wp) function opening(self, row, force, gap)
      type(equations_type), intent(in) :: self
      integer, intent(in) :: row
      real(wp), intent(in) :: force, gap
      opening = gap + (self%compliance(row) + self%extra(row))*force - self%shift(row)
   end function opening

   !> Pressing force that the bound of a point reads, and its slopes in force and gap.
   subroutine pressing(self, points, k, force, gap, press, by_force, by_gap)
      type(equations_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: force(:), gap(:)
      real(wp), intent(out) :: press, by_force, by_gap

      by_force = 0.0_wp
      by_gap = 0.0_wp
      if (allocated(self%frozen)) then
         press = self%frozen(k)
         return
      end if
      associate (row => points%normal(k))
         press = force(row)
         by_force = 1.0_wp
         if (self%linear(row)) then
            press = force(row) - self%c(row)*opening(self, row, force(row), gap(row))
            by_force = 1.0_wp - self%c(row)*(self%compliance(row) + self%extra(row))
            by_gap = -self%c(row)
         end if
      end associate
      if (press > 0.0_wp) return
      press = 0.0_wp
      by_force = 0.0_wp
      by_gap = 0.0_wp
   end subroutine pressing

   !> Compliance of elastic stick at a pressing force; 0: exact stick [length/force].
   pure real(wp) function elastic_compliance(points, k, press) result(compliance)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: press                !! [force]
      real(wp) :: by_press

      call elastic_stick(points, k, press, compliance, by_press)
   end function elastic_compliance

   !> The same with its slope in the pressing force.
   pure subroutine elastic_stick(points, k, press, compliance, by_press)
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: press                !! [force]
      real(wp), intent(out) :: compliance          !! [length/force]
      real(wp), intent(out) :: by_press            !! [length/force^2]
      real(wp) :: radius, slope

      compliance = 0.0_wp
      by_press = 0.0_wp
      if (points%stiffness(k) > 0.0_wp) then
         compliance = 1.0_wp/points%stiffness(k)
      else if (points%elastic_slip(k) > 0.0_wp) then
         associate (w => points%weight(k))
            call friction_radius(points%law(k), press/w, at_rest(points%at(k)), radius, slope)
            if (.not. (radius > 0.0_wp .and. radius < huge(1.0_wp))) return
            compliance = points%elastic_slip(k)/(radius*w)
            by_press = -compliance*slope/(radius*w)
         end associate
      end if
   end subroutine elastic_stick

   !> Slip of the increment at a point, without what elastic stick gives back [length].
   pure function slip_of(self, points, k, force, gap, press) result(slip)
      type(equations_type), intent(in) :: self
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: force(:), gap(:), press
      real(wp) :: slip(points%nt), yielding(points%nt)
      integer :: i

      associate (first => points%tangent(k))
         yielding = elastic_compliance(points, k, press)*force(first:first + points%nt - 1)
         do i = 1, points%nt
            slip(i) = gap(first + i - 1) - points%start(i, k) + yielding(i) + points%elastic(i, k) &
               & + self%extra(first + i - 1)*(force(first + i - 1) - points%traction(i, k))
         end do
      end associate
   end function slip_of

   subroutine exact_rows(self, points, k, force, gap)
      type(equations_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: force(:), gap(:)
      real(wp) :: press, by_force, by_gap, c, w, q(points%nt), m(points%nt), size_, bound, &
         & slope_q, slope_p, turn(points%nt, points%nt), elastic, by_press, back
      integer :: i, nt
      logical :: slips, joint

      nt = points%nt
      w = points%weight(k)
      call pressing(self, points, k, force, gap, press, by_force, by_gap)
      associate (from => points%tangent(k), to => points%tangent(k) + nt - 1)
         call elastic_stick(points, k, press, elastic, by_press)
         c = max(self%c(from), 2.0_wp*w*steepest_fall(points%law(k), press/w, points%at(k)))
         ! Beside a point that yields where it sticks the scale is that of both.
         joint = .not. (by_rate(points%law(k)) .or. reads_speed(points%law(k)))
         if (joint) c = c/(1.0_wp + c*elastic)
         q = force(from:to) - c*slip_of(self, points, k, force, gap, press)
         size_ = norm2(q)
         call return_to_disc(points%law(k), size_/w, c/w, press/w, points%at(k), bound, slope_q, &
            & slope_p)
         slips = bound < size_/w
         bound = bound*w
         m = 0.0_wp
         if (size_ > 0.0_wp) m = q/size_
         self%status(k) = merge(2, 1, slips)
         self%residual(from:to) = force(from:to) - bound*m
         turn = 0.0_wp
         do i = 1, nt
            turn(i, i) = slope_q
            if (size_ > 0.0_wp) turn(i, i) = bound/size_
         end do
         if (size_ > 0.0_wp) then
            back = bound/size_
            if (self%damped .and. slips) then
               ! lambda_t m^T / max(b, |lambda_t|) in the place of m m^T.
               turn = turn + (slope_q - back)*outer(force(from:to), m)/max(bound, &
                  & norm2(force(from:to)), tiny(1.0_wp))
            else
               turn = turn + (slope_q - back)*outer(m, m)
            end if
         end if
         self%q(:, 1:, k) = c*turn
         self%p(:, 1:, k) = -turn
         do i = 1, nt
            self%p(:, i, k) = self%p(:, i, k) + c*(elastic + self%extra(from + i - 1))*turn(:, i)
            self%p(i, i, k) = self%p(i, i, k) + 1.0_wp
         end do
         ! By the pressing force: of the bound, and of what the point yields (and so of c).
         if (.not. joint) q = force(from:to)
         m = c*by_press*matmul(turn, q) - slope_p*m
         self%p(:, 0, k) = by_force*m
         self%q(:, 0, k) = by_gap*m
      end associate
   end subroutine exact_rows

   subroutine regularised_rows(self, points, k, force, gap)
      type(equations_type), intent(inout) :: self
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      real(wp), intent(in) :: force(:), gap(:)
      real(wp) :: press, by_force, by_gap, w, s(points%nt), m(points%nt), size_, reach, bound, &
         & slope, slope_p
      integer :: i, nt

      nt = points%nt
      w = points%weight(k)
      call pressing(self, points, k, force, gap, press, by_force, by_gap)
      associate (from => points%tangent(k), to => points%tangent(k) + nt - 1)
         s = gap(from:to) - points%start(:, k) + points%anchor(:, k)
         size_ = norm2(s)
         reach = min(size_, drag_limit(points%law(k)))
         call regularised_traction(points%law(k), reach, press/w, points%at(k), bound, slope, &
            & slope_p, size_ - reach)
         bound = bound*w
         slope = slope*w
         m = 0.0_wp
         if (size_ > 0.0_wp) m = s/size_
         self%status(k) = 2
         self%residual(from:to) = force(from:to) + bound*m
         self%p(:, :, k) = 0.0_wp
         self%q(:, :, k) = 0.0_wp
         do i = 1, nt
            self%p(i, i, k) = 1.0_wp
            self%q(i, i, k) = slope
            if (size_ > 0.0_wp) self%q(i, i, k) = bound/size_
         end do
         if (size_ > 0.0_wp) self%q(:, 1:, k) = self%q(:, 1:, k) + (slope - bound/size_)*outer(m, m)
         self%p(:, 0, k) = slope_p*by_force*m
         self%q(:, 0, k) = slope_p*by_gap*m
      end associate
   end subroutine regularised_rows
end module lopin_friction_rows
