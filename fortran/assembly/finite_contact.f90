!> Contact on the present shape: which points there are, what they remember, what they press with.
!>
!> One point is one slave node of one pair (two near a concave corner of a tool). Within an
!> increment nothing is committed: `evaluate` may be called for any trial displacements, `accept`
!> makes the last evaluation the history, and a failed increment simply starts again from it.
module lopin_finite_contact
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_facet_basis, only : facet_basis_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_friction, only : friction_type, condition_type, has_friction, is_regularised, &
      & drag_limit, friction_radius
   use lopin_contact_traction, only : grip_type, grip_kind, grip_status, elastic_slip_of, &
      & stored_energy
   use lopin_finite_grips, only : choose_grips, remember_elastic
   use lopin_finite_points, only : finite_points_type, new_finite_points, is_self_contact
   use lopin_search, only : cost_type
   use lopin_finite_opposite, only : opposite_type, anchor_type, masters_type, new_masters, &
      & move_masters, find_opposite, anchor_of, area_ratios
   use lopin_finite_owner, only : new_owners, start_owners, note_owner, commit_owners
   use lopin_finite_roles, only : choose_roles
   use lopin_finite_kernel, only : local_matrix_type, point_state_type, evaluate_point
   use lopin_mortar_node_2d, only : patch_type
   use lopin_finite_mortar, only : present_mortar_type, mortar_anchor_type, new_present_mortar, &
      & update_mortar, meet_row, evaluate_mortar_point
   implicit none
   private
   public :: local_matrix_type, finite_contact_type, new_finite_contact, start_increment
   public :: evaluate, augment, accept, reject, speed_of, dissipated, mean_work_of
   public :: held_energy, shear_bound

   !> A point farther from its master, in facets, is not tied unless ADJUST says so.
   real(wp), parameter :: too_far = 0.5_wp
   !> A gap below this share of the facet touches.
   real(wp), parameter :: touching = 1.0e-10_wp

   type, extends(finite_points_type) :: finite_contact_type
      integer :: nmultiplier = 0               !! rows: ndim per point whose method solves for it
      integer :: nlocal = 0
      real(wp), allocatable :: force(:)        !! (ndof) of the contacts on the dofs [force]
      real(wp), allocatable :: row(:)          !! (nmultiplier) residuals [length]
      integer, allocatable :: point_of_row(:)  !! (nmultiplier)
      integer, allocatable :: first_row(:)     !! (n) first row of a point; 0: none
      type(local_matrix_type), allocatable :: local(:)
      ! results of the last evaluation
      integer, allocatable :: facet(:)         !! 0: no master opposite
      integer, allocatable :: status(:)        !! 0 open, 1 stick or closed, 2 slip
      logical, allocatable :: bilateral(:)
      real(wp), allocatable :: c(:), ct(:)     !! normal and tangential stiffness [stress/length]
      real(wp), allocatable :: gap(:), pressure(:)
      real(wp), allocatable :: traction(:, :)  !! (3, n) on the slave [stress]
      real(wp), allocatable :: normal(:, :)    !! (3, n)
      real(wp), allocatable :: slip(:, :)      !! (3, n) of the accepted increments together [length]
      real(wp), allocatable :: xi(:, :)        !! (2, n)
      real(wp), allocatable :: slip_path(:)    !! (n) its length
      real(wp), allocatable :: friction_work(:) !! (n) dissipated [force*length]
      real(wp), allocatable :: mean_work(:)     !! (n) the same by mean tractions [force*length]
      real(wp) :: soft_error = 0.0_wp          !! estimated pressure error of penalties, relative
      type(cost_type) :: cost                  !! of the search so far
      ! set from outside
      real(wp) :: interference = 1.0_wp        !! share of initial overclosures that is applied
      logical, allocatable :: pair_active(:)   !! *MODEL CHANGE
      type(friction_type), allocatable :: friction(:)   !! (npair) in force
      real(wp), allocatable :: mises(:)        !! (n) of the last iteration [stress]
      real(wp), allocatable :: speed(:)        !! (n) of slip, of the last iteration [length/time]
      ! inside
      real(wp) :: dt = 1.0_wp
      real(wp), allocatable :: first_weight(:) !! (n) areas at the start [area]
      real(wp), allocatable :: start_normal(:, :)   !! (3, n) where the increment begins
      type(dofs_type) :: dofs
      type(facet_basis_type) :: basis
      type(masters_type) :: masters
      type(grip_type), allocatable :: grip(:)          !! (n)
      type(anchor_type), allocatable :: anchor(:)      !! (n)
      type(opposite_type), allocatable :: opposite(:)  !! (n) of the last evaluation
      type(present_mortar_type), allocatable :: mortar(:)        !! (npair)
      type(mortar_anchor_type), allocatable :: mortar_anchor(:)  !! (n)
      type(patch_type), allocatable :: patch(:)        !! (n) of the last evaluation
      type(point_state_type), allocatable :: trial(:)  !! (n)
      ! committed
      real(wp), allocatable :: lambda(:, :)    !! (3, n) tractions [stress]
      real(wp), allocatable :: last_normal(:, :)
      real(wp), allocatable :: creep(:, :)     !! (3, n) slip from the stick anchor [length]
      logical, allocatable :: closed(:)
      real(wp), allocatable :: last_speed(:)   !! (n) of slip, of the last increment [length/time]
      logical, allocatable :: loose(:)         !! of a tied pair, but too far to be tied
      logical, allocatable :: yields(:)        !! of self-contact: only pressed upon
      integer, allocatable :: pressing(:)      !! (nnode) pair of self-contact whose node presses
      real(wp), allocatable :: tied_at(:, :)   !! (ndim, nnode) places where mortar ties were made
   end type finite_contact_type

contains

   subroutine new_finite_contact(self, model, dofs, log, error)
      type(finite_contact_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: i, n, pair

      call new_finite_points(self%finite_points_type, model, log, error)
      if (allocated(error)) return
      call new_masters(self%masters, model, self%basis, error)
      if (allocated(error)) return
      n = self%n
      call new_owners(self%masters%owner, n)
      self%first_weight = self%weight
      self%dofs = dofs
      allocate (self%force(dofs%n), self%gap(n), self%pressure(n), self%traction(3, n), &
         & self%normal(3, n), self%slip(3, n), self%xi(2, n), self%slip_path(n), &
         & self%friction_work(n), self%mean_work(n), self%lambda(3, n), self%last_normal(3, n), &
         & self%start_normal(3, n), &
         & self%creep(3, n), self%c(n), self%ct(n), self%mises(n), self%speed(n), self%last_speed(n), &
         & source=0.0_wp)
      allocate (self%facet(n), self%status(n), self%first_row(n), source=0)
      allocate (self%pressing(model%mesh%nnode), source=0)
      allocate (self%bilateral(n), self%closed(n), self%loose(n), &
         & self%yields(n), source=.false.)
      allocate (self%pair_active(size(model%pair)), source=.true.)
      allocate (self%grip(n), self%anchor(n), self%opposite(n), self%trial(n), self%local(n))
      allocate (self%friction(size(model%pair)))
      allocate (self%mortar(size(model%pair)), self%mortar_anchor(n), self%patch(n))
      do pair = 1, size(model%pair)
         self%friction(pair) = model%interaction(model%pair(pair)%interaction)%friction
         call choose_grips(self%grip, self%finite_points_type, self%friction(pair), model, pair, &
            & log)
         if (self%masters%of(pair)%has_slave_faces) call new_present_mortar(self%mortar(pair), &
            & model, model%pair(pair), self%masters%of(pair)%slave, self%masters%rules)
      end do
      do i = 1, n
         self%closed(i) = self%touches(i)
         self%c(i) = self%grip(i)%c
         self%ct(i) = self%grip(i)%ct
         if (.not. solves(self%grip(i)%kind)) cycle
         self%first_row(i) = self%nmultiplier + 1
         self%nmultiplier = self%nmultiplier + model%mesh%ndim
      end do
      allocate (self%row(self%nmultiplier), source=0.0_wp)
      allocate (self%point_of_row(self%nmultiplier))
      do i = 1, n
         if (self%first_row(i) > 0) self%point_of_row(self%first_row(i): &
            & self%first_row(i) + model%mesh%ndim - 1) = i
      end do
   end subroutine new_finite_contact

   pure logical function solves(kind)
      integer, intent(in) :: kind
      solves = kind == grip_kind%lagrange .or. kind == grip_kind%perturbed .or. kind == grip_kind%tied
   end function solves

   !> Search from the accepted state; anchors of friction; tractions turned with the normals.
   subroutine start_increment(self, model, u, dt, error)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) accepted displacements
      real(wp), intent(in) :: dt               !! [time]
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%dt = dt
      call move_masters(self%masters, model, self%dofs, self%finite_points_type, u, .true., &
         & self%cost, error)
      if (allocated(error)) return
      if (any(self%mortar%tied) .and. .not. allocated(self%tied_at)) &
         & self%tied_at = self%masters%x
      call start_owners(self%masters%owner)
      call follow_areas(self, model)
      call find_present(self, .true., error)
      if (allocated(error)) return
      do i = 1, self%n
         call meet(self, model, i, .true.)
         if (.not. (self%grip(i)%kind == grip_kind%tied .and. self%anchor(i)%set)) &
            & call take_anchor(self, model, i)
         if (self%opposite(i)%facet > 0) self%masters%part(i) = self%opposite(i)%foot%segment
         associate (g => self%grip(i))
            g%ct = self%ct(i)
            g%c = self%c(i)
            g%grazing = touching*g%c*self%size(i)
            g%committed = self%lambda(:, i)
            g%creep = self%creep(:, i)
            if (self%opposite(i)%facet > 0) then
               call turn(self%last_normal(:, i), self%opposite(i)%normal, g%committed)
               call turn(self%last_normal(:, i), self%opposite(i)%normal, g%creep)
            end if
            self%start_normal(:, i) = self%opposite(i)%normal
            g%frozen = g%committed
            g%bilateral = self%closed(i) &
               & .and. model%interaction(model%pair(self%pair(i))%interaction)%no_separation
            self%bilateral(i) = g%bilateral .or. g%kind == grip_kind%tied
            g%yield = self%yield(i)
            call remember_elastic(g, self%friction(self%pair(i)), self%opposite(i)%normal)
         end associate
      end do
      call share_roles(self, model)
   end subroutine start_increment

   !> Tractions are by the area of the nodes where the increment begins: m k by that of the start
   !> would fade as a billet spreads.
   subroutine follow_areas(self, model)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp) :: ratio(model%mesh%nnode)
      integer :: pair

      do pair = 1, size(model%pair)
         ratio = area_ratios(self%masters, model, pair)
         where (self%pair == pair) self%weight = self%first_weight*ratio(self%node)
      end do
   end subroutine follow_areas

   !> Of two sides of one surface that face each other only one presses.
   subroutine share_roles(self, model)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: pair, first, last, k

      self%pressing = 0
      do pair = 1, size(model%pair)
         if (.not. is_self_contact(model%pair(pair))) cycle
         first = findloc(self%pair, pair, dim=1)
         if (first == 0) cycle
         last = first + count(self%pair == pair) - 1
         call choose_roles(self%masters%of(pair)%surface, self%node(first:last), &
            & self%opposite(first:last)%facet, self%size(first:last), &
            & [(any(abs(self%lambda(:, k)) > 0.0_wp), k=first, last)], self%yields(first:last))
         do k = first, last
            if (self%opposite(k)%facet > 0 .and. .not. self%yields(k)) &
               & self%pressing(self%node(k)) = pair
         end do
      end do
   end subroutine share_roles

   !> A point of self-contact that yields does so only to nodes that press.
   pure logical function is_left_out(self, i)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i

      is_left_out = .false.
      if (.not. self%yields(i)) return
      associate (o => self%opposite(i))
         is_left_out = any(self%pressing(o%node(:o%ncarry)) == self%pair(i))
      end associate
   end function is_left_out

   !> The point opposite; tied points keep it, and those too far from it are never tied.
   subroutine take_anchor(self, model, i)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i

      call anchor_of(self%anchor(i), self%opposite(i))
      if (self%grip(i)%kind /= grip_kind%tied) return
      self%loose(i) = .not. self%anchor(i)%set
      if (self%anchor(i)%set) self%loose(i) = abs(self%anchor(i)%gap) > max(too_far*self%size(i), &
         & model%pair(self%pair(i))%adjust)
   end subroutine take_anchor

   !> The least rotation that takes one unit vector to another, applied to a third vector.
   pure subroutine turn(from, to, v)
      real(wp), intent(in) :: from(3), to(3)
      real(wp), intent(inout) :: v(3)
      real(wp) :: c, axis(3)

      c = dot_product(from, to)
      if (.not. c > -0.5_wp .or. .not. any(abs(v) > 0.0_wp)) return
      axis = [from(2)*to(3) - from(3)*to(2), from(3)*to(1) - from(1)*to(3), &
         & from(1)*to(2) - from(2)*to(1)]
      v = c*v + [axis(2)*v(3) - axis(3)*v(2), axis(3)*v(1) - axis(1)*v(3), &
         & axis(1)*v(2) - axis(2)*v(1)] + axis*dot_product(axis, v)/(1.0_wp + c)
   end subroutine turn

   !> Project at x = X + u, apply the laws: force, row and, if asked, the local matrices.
   subroutine evaluate(self, model, u, multiplier, with_tangent, error)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof)
      real(wp), intent(in) :: multiplier(:)    !! (nmultiplier) tractions, global axes [stress]
      logical, intent(in) :: with_tangent
      type(error_type), allocatable, intent(out) :: error
      type(condition_type) :: at
      real(wp) :: lambda(3), shift
      integer :: i, k, d

      d = model%mesh%ndim
      self%force = 0.0_wp
      self%row = 0.0_wp
      self%nlocal = 0
      self%soft_error = 0.0_wp
      call move_masters(self%masters, model, self%dofs, self%finite_points_type, u, .false., &
         & self%cost, error)
      if (allocated(error)) return
      call find_present(self, .false., error)
      if (allocated(error)) return
      do i = 1, self%n
         lambda = 0.0_wp
         k = self%first_row(i)
         if (k > 0) lambda(:d) = multiplier(k:k + d - 1)
         if (self%pair_active(self%pair(i))) then
            call meet(self, model, i, .false.)
         else
            self%opposite(i)%facet = 0
         end if
         if (self%loose(i)) self%opposite(i)%facet = 0
         if (is_left_out(self, i)) self%opposite(i)%facet = 0
         self%facet(i) = self%opposite(i)%facet
         if (self%facet(i) == 0) then
            call stay_open(self, i, d, lambda, with_tangent)
            cycle
         end if
         if (.not. self%anchor(i)%set) call anchor_of(self%anchor(i), self%opposite(i))
         shift = self%shift(i) + (1.0_wp - self%interference)*self%overclosure(i) &
            & - model%interaction(model%pair(self%pair(i))%interaction)%clearance
         if (is_clear(self, i, lambda, shift)) then
            call stay_open(self, i, d, lambda, with_tangent)
            self%trial(i)%normal = self%opposite(i)%normal
            self%trial(i)%gap = self%opposite(i)%foot%gap
            self%normal(:, i) = self%trial(i)%normal
            self%gap(i) = self%trial(i)%gap + self%shift(i) &
               & + (1.0_wp - self%interference)*self%overclosure(i)
            cycle
         end if
         at = condition_at(self, i)
         self%nlocal = self%nlocal + 1
         if (self%mortar(self%pair(i))%is_on) then
            call evaluate_mortar_point(self%trial(i), self%local(self%nlocal), &
               & self%mortar(self%pair(i)), self%dofs, self%masters%x, self%patch(i), &
               & self%mortar_anchor(i), self%grip(i), self%friction(self%pair(i)), at, shift, &
               & lambda, self%first_row(i), with_tangent, self%weight(i))
            call collect(self, i, d)
            cycle
         end if
         call evaluate_point(self%trial(i), self%local(self%nlocal), model, self%dofs, self%basis, &
            & self%masters, self%finite_points_type, i, self%opposite(i), self%anchor(i), &
            & self%grip(i), self%friction(self%pair(i)), at, shift, lambda, self%first_row(i), &
            & with_tangent)
         call collect(self, i, d)
         if (with_tangent .and. self%status(i) /= 0 .and. self%opposite(i)%ncarry > 0) &
            & call note_owner(self%masters%owner, i, self%opposite(i)%found, self%opposite(i)%kept)
      end do
      call estimate_softness(self)
      ! Touching counts as closed where Newton starts, and no longer.
      self%grip%grazing = 0.0_wp
   end subroutine evaluate

   !> A mortar row that its values already show to be open: its slopes, which cost most of it, are
   !> not needed.
   pure logical function is_clear(self, i, lambda, shift)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: lambda(3), shift
      real(wp) :: along, gap

      is_clear = .false.
      associate (g => self%grip(i), o => self%opposite(i))
         if (.not. self%mortar(self%pair(i))%is_on .or. g%bilateral) return
         along = dot_product(lambda, o%normal)
         gap = o%foot%gap + shift
         if (g%kind == grip_kind%perturbed) gap = gap + along/g%slope
         if (g%kind == grip_kind%lagrange .or. g%kind == grip_kind%perturbed) is_clear = &
            & along - g%c*gap < -g%grazing .and. gap > 0.0_wp
      end associate
   end function is_clear

   !> What the law of friction reads at a point besides pressure and slip.
   pure function condition_at(self, i) result(at)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      type(condition_type) :: at
      at = condition_type(yield=self%yield(i), mises=self%mises(i), dt=self%dt, &
         & speed=self%speed(i), held=self%grip(i)%bilateral)
   end function condition_at

   !> The slip of the trial state that is not given back: what it is more than elastic slip.
   pure function lost_slip(self, i) result(slip)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slip(3)

      slip = 0.0_wp
      if (self%facet(i) == 0 .or. self%trial(i)%status /= grip_status%slip) return
      associate (t => self%trial(i), g => self%grip(i), law => self%friction(self%pair(i)))
         if (.not. has_friction(law)) return
         slip = t%slip
         if (is_regularised(law)) then
            if (drag_limit(law) < huge(1.0_wp)) slip = g%creep + t%slip &
               & - drawn(law, g%creep + t%slip)
            return
         end if
         slip = slip - elastic_slip_of(g, law, condition_at(self, i), self%pressure(i), &
            & t%traction - self%pressure(i)*t%normal)
         if (g%elastic_slip > 0.0_wp) slip = slip + g%elastic
         if (.not. g%elastic_slip > 0.0_wp) slip = slip + elastic_slip_of(g, law, &
            & condition_at(self, i), self%pressure(i), along(g%committed, t%normal))
      end associate
   end function lost_slip

   !> Slip from the stick anchor after the anchor has followed.
   pure function drawn(law, slip) result(left)
      type(friction_type), intent(in) :: law
      real(wp), intent(in) :: slip(3)          !! [length]
      real(wp) :: left(3), limit

      left = slip
      limit = drag_limit(law)
      if (norm2(slip) > limit) left = slip*(limit/norm2(slip))
   end function drawn

   !> Way slid in the increment, with friction only what is not given back.
   pure real(wp) function path_of(self, i) result(way)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i

      way = norm2(self%trial(i)%slip)
      associate (law => self%friction(self%pair(i)))
         if (has_friction(law) .and. .not. is_regularised(law)) way = norm2(lost_slip(self, i))
      end associate
   end function path_of

   !> Friction work per area of the trial state, in this increment, as its law has it: by the
   !> traction at the end, never negative [stress*length].
   pure real(wp) function dissipated(self, i)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      dissipated = -dot_product(self%trial(i)%traction, lost_slip(self, i))
   end function dissipated

   !> The same by the mean of the tractions at start and end, as the work of external forces is
   !> counted: negative where friction turns round while the pressure falls [stress*length].
   pure real(wp) function mean_work_of(self, i) result(work)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: before(3)

      associate (t => self%trial(i))
         before = self%grip(i)%committed
         ! On a curved master the pressure of the start would work along the chord of the way.
         if (self%opposite(i)%facet > 0) call turn(self%start_normal(:, i), t%normal, before)
         work = -0.5_wp*dot_product(t%traction + along(before, t%normal), lost_slip(self, i))
      end associate
   end function mean_work_of

   !> Energy per area that a point's springs hold [stress*length].
   pure real(wp) function held_energy(self, i) result(energy)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i

      energy = 0.0_wp
      if (self%facet(i) == 0 .or. self%trial(i)%status == 0) return
      associate (t => self%trial(i), p => self%pressure(i), law => self%friction(self%pair(i)))
         energy = stored_energy(self%grip(i), law, condition_at(self, i), p, &
            & merge(1.0_wp, 0.0_wp, has_friction(law))*along(t%traction, t%normal))
      end associate
   end function held_energy

   !> Largest shear that the law of friction allows a point; huge: no bound [stress].
   pure real(wp) function shear_bound(self, i) result(radius)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      real(wp) :: slope

      radius = huge(1.0_wp)
      associate (law => self%friction(self%pair(i)))
         if (has_friction(law)) call friction_radius(law, self%pressure(i), condition_at(self, i), &
            & radius, slope)
      end associate
   end function shear_bound

   pure function along(v, normal) result(t)
      real(wp), intent(in) :: v(3), normal(3)
      real(wp) :: t(3)
      t = v - dot_product(v, normal)*normal
   end function along

   !> Speed of slip of the trial state [length/time].
   pure real(wp) function speed_of(self, i) result(speed)
      type(finite_contact_type), intent(in) :: self
      integer, intent(in) :: i
      speed = norm2(lost_slip(self, i))/self%dt
   end function speed_of

   !> The overlaps of the pairs by mortar.
   subroutine find_present(self, start, error)
      type(finite_contact_type), intent(inout) :: self
      logical, intent(in) :: start             !! of an increment
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      do pair = 1, size(self%mortar)
         if (.not. self%mortar(pair)%is_on) cycle
         call update_mortar(self%mortar(pair), self%masters%rules, self%masters%of(pair)%surface, &
            & self%masters%of(pair)%tree, self%masters%x, start, error)
         if (allocated(error)) return
      end do
   end subroutine find_present

   !> What lies opposite a point now; by mortar its row, kept as the anchor at the start.
   subroutine meet(self, model, i, start)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      logical, intent(in) :: start             !! of an increment
      logical :: covered

      associate (pair => self%pair(i))
         if (.not. self%mortar(pair)%is_on) then
            call find_opposite(self%opposite(i), self%masters, model, self%finite_points_type, i, &
               & self%cost)
            return
         end if
         call meet_row(self%mortar(pair), self%masters%of(pair)%surface, self%masters%rules, &
            & self%masters%x, self%node(i), start, self%patch(i), self%mortar_anchor(i), covered, &
            & self%opposite(i)%normal, self%opposite(i)%found%gap)
         self%opposite(i)%facet = merge(1, 0, covered)
         self%opposite(i)%foot%gap = self%opposite(i)%found%gap
      end associate
   end subroutine meet

   !> A point with no master opposite has no traction; its multiplier is sent to zero.
   subroutine stay_open(self, i, d, lambda, with_tangent)
      type(finite_contact_type), intent(inout) :: self
      integer, intent(in) :: i, d
      real(wp), intent(in) :: lambda(3)
      logical, intent(in) :: with_tangent
      integer :: k

      self%status(i) = 0
      self%gap(i) = 0.0_wp
      ! Of a surface too far to be asked, at least so much.
      if (self%masters%of(self%pair(i))%asleep) self%gap(i) = self%masters%of(self%pair(i))%distance
      self%pressure(i) = 0.0_wp
      self%traction(:, i) = 0.0_wp
      self%trial(i) = point_state_type()
      if (self%first_row(i) == 0) return
      self%row(self%first_row(i):self%first_row(i) + d - 1) = lambda(:d)/self%grip(i)%c
      if (.not. with_tangent) return
      self%nlocal = self%nlocal + 1
      associate (l => self%local(self%nlocal))
         l%nu = 0
         l%dof = [(self%dofs%n + self%first_row(i) + k, k=0, d - 1)]
         if (allocated(l%k)) deallocate (l%k)
         if (allocated(l%spring)) deallocate (l%spring)
         if (allocated(l%flat_row)) deallocate (l%flat_row)
         allocate (l%k(d, d), l%spring(0, 0), source=0.0_wp)
         do k = 1, d
            l%k(k, k) = 1.0_wp/self%grip(i)%c
         end do
      end associate
   end subroutine stay_open

   !> Forces, row and results of one evaluated point.
   subroutine collect(self, i, d)
      type(finite_contact_type), intent(inout) :: self
      integer, intent(in) :: i, d
      integer :: k

      associate (l => self%local(self%nlocal), t => self%trial(i))
         do k = 1, l%nu
            self%force(l%dof(k)) = self%force(l%dof(k)) + t%force(k)
         end do
         if (self%first_row(i) > 0) self%row(self%first_row(i):self%first_row(i) + d - 1) = &
            & t%row(:d)
         self%status(i) = t%status
         self%gap(i) = t%gap + self%shift(i) + (1.0_wp - self%interference)*self%overclosure(i)
         self%normal(:, i) = t%normal
         self%traction(:, i) = t%traction
         self%pressure(i) = dot_product(t%traction, t%normal)
         self%xi(:, i) = self%opposite(i)%found%xi
      end associate
   end subroutine collect

   !> One augmentation would change the pressure by slope times penetration beside the compliance;
   !> the compliance of a facet, 1/(2 moduli over facet), stands for it. The slave's own: pressures
   !> of nodes that share a master facet can change without moving the master.
   subroutine estimate_softness(self)
      type(finite_contact_type), intent(inout) :: self
      real(wp) :: most
      integer :: i

      most = 0.0_wp
      if (self%n > 0) most = maxval(abs(self%pressure))
      if (.not. most > 0.0_wp) return
      do i = 1, self%n
         if (self%grip(i)%kind /= grip_kind%penalty .and. self%grip(i)%kind /= &
            & grip_kind%perturbed) cycle
         if (self%status(i) == 0) cycle
         self%soft_error = max(self%soft_error, abs(self%pressure(i))/most &
            & /(1.0_wp + 2.0_wp*self%grip(i)%slope*self%size(i)/self%slave_modulus(i)))
      end do
   end subroutine estimate_softness

   !> Augmented Lagrangian: take the present tractions for the next solve.
   subroutine augment(self, change)
      type(finite_contact_type), intent(inout) :: self
      real(wp), intent(out) :: change          !! relative, of the tractions
      real(wp) :: most, moved
      integer :: i

      most = 0.0_wp
      moved = 0.0_wp
      do i = 1, self%n
         if (self%grip(i)%kind /= grip_kind%augmented) cycle
         most = max(most, norm2(self%traction(:, i)))
         moved = max(moved, norm2(self%traction(:, i) - self%grip(i)%frozen))
         self%grip(i)%frozen = self%traction(:, i)
      end do
      change = 0.0_wp
      if (most > 0.0_wp) change = moved/most
   end subroutine augment

   !> Commit the history of the last evaluation.
   subroutine accept(self, u, multiplier)
      type(finite_contact_type), intent(inout) :: self
      real(wp), intent(in) :: u(:), multiplier(:)
      integer :: i

      associate (unused => u, also => multiplier)
      end associate
      do i = 1, self%n
         call commit_owners(self%masters%owner, i, self%opposite(i)%past .and. self%status(i) /= 0)
         associate (t => self%trial(i))
            if (self%facet(i) == 0 .or. t%status == 0) then
               self%last_speed(i) = 0.0_wp
               ! A pair that is taken away has no memory when it comes back.
               if (.not. self%pair_active(self%pair(i))) self%closed(i) = .false.
               self%lambda(:, i) = 0.0_wp
               self%creep(:, i) = 0.0_wp
               if (self%facet(i) > 0) self%last_normal(:, i) = t%normal
               cycle
            end if
            self%closed(i) = .true.
            self%lambda(:, i) = t%traction
            self%last_normal(:, i) = t%normal
            self%slip(:, i) = self%slip(:, i) + t%slip
            self%creep(:, i) = drawn(self%friction(self%pair(i)), self%grip(i)%creep + t%slip)
            self%slip_path(i) = self%slip_path(i) + path_of(self, i)
            self%last_speed(i) = speed_of(self, i)
            self%friction_work(i) = self%friction_work(i) + dissipated(self, i)*self%weight(i)
            self%mean_work(i) = self%mean_work(i) + mean_work_of(self, i)*self%weight(i)
         end associate
      end do
   end subroutine accept

   !> Back to the history that was committed last: what is not committed is only overwritten.
   subroutine reject(self)
      type(finite_contact_type), intent(inout) :: self
      self%nlocal = 0
   end subroutine reject
end module lopin_finite_contact
