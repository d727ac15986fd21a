!> Contact on the present shape: which points there are, and what the last evaluation found.
!>
!> One point is one slave node of one pair (two near a concave corner of a tool). Any trial
!> displacements may be evaluated (lopin_contact_evaluation); what an increment leaves of them is
!> state (lopin_state, written by lopin_contact_history).
module lopin_nonlinear_contact
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_facet_basis, only : facet_basis_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_friction, only : friction_type
   use lopin_carried_force, only : skin_type
   use lopin_contact_row, only : enforcement_parameters_type, point_state_type
   use lopin_enforcement_parameters, only : choose_enforcement
   use lopin_nonlinear_points, only : nonlinear_points_type, new_nonlinear_points
   use lopin_search, only : cost_type
   use lopin_closest_feature, only : opposite_type, anchor_type
   use lopin_master_surfaces, only : masters_type, new_masters, areas_of
   use lopin_facet_hysteresis, only : new_facet_hysteresis
   use lopin_skins, only : new_skins
   use lopin_local_matrix, only : local_matrix_type
   use lopin_gap_path, only : gap_path_type
   use lopin_mortar_patch_2d, only : patch_type
   use lopin_initial_gaps, only : is_moved
   use lopin_mortar_element, only : present_mortar_type, mortar_anchor_type, new_present_mortar
   implicit none
   private
   public :: nonlinear_contact_type, star_type, new_nonlinear_contact, set_slopes, cover_size, &
      & place_of

   !> The facets around each node of a mesh.
   type :: star_type
      integer, allocatable :: first(:)         !! (nnode + 1) first of a node in
      integer, allocatable :: facet(:), place(:)   !! facets, and the node's place in them
   end type star_type

   !> The contacts of the nonlinear path. Many components: arrays by point of the last evaluation,
   !> kept as arrays because detection, forces and output each go through a few of them.
   type, extends(nonlinear_points_type) :: nonlinear_contact_type
      integer :: nmultiplier = 0               !! rows: ndim per point whose method solves for it
      integer :: nlocal = 0
      real(wp), allocatable :: force(:)        !! (ndof) of the contacts on the dofs [force]
      real(wp), allocatable :: row(:)          !! (nmultiplier) residuals [length]
      integer, allocatable :: point_of_row(:)  !! (nmultiplier)
      integer, allocatable :: first_row(:)     !! (n) first row of a point; 0: none
      integer, allocatable :: before(:)        !! (n) point that it goes on from when the behaviour
                                               !! of its pair changes; 0: none
      type(local_matrix_type), allocatable :: local(:)
      ! results of the last evaluation
      integer, allocatable :: facet(:)         !! 0: no master opposite
      integer, allocatable :: status(:)        !! 0 open, 1 stick or closed, 2 slip
      logical, allocatable :: bilateral(:)
      logical, allocatable :: chosen(:)        !! the deck leaves the slope of the point open
      real(wp), allocatable :: slope(:)        !! as it was chosen first [stress/length]
      real(wp), allocatable :: c(:), ct(:)     !! normal and tangential stiffness [stress/length]
      real(wp), allocatable :: gap(:), pressure(:)   !! of the rows
      real(wp), allocatable :: opening(:)      !! gaps of the nodes [length]
      real(wp), allocatable :: traction(:, :)  !! (3, n) on the slave [stress]
      real(wp), allocatable :: normal(:, :)    !! (3, n)
      real(wp), allocatable :: xi(:, :)        !! (2, n)
      real(wp) :: soft_error = 0.0_wp          !! estimated pressure error of penalties, relative
      type(cost_type) :: cost                  !! of the search so far
      ! set from outside
      real(wp) :: interference = 1.0_wp        !! share of initial overclosures that is applied
      logical :: closes_in = .false.           !! the increment applies some
      real(wp) :: early_share = 1.0_wp         !! the same of rows where no node touches
      logical, allocatable :: pair_active(:)   !! *MODEL CHANGE
      type(friction_type), allocatable :: friction(:)   !! (npair) in force
      real(wp), allocatable :: mises(:)        !! (n) of the last iteration [stress]
      logical, allocatable :: follows(:)       !! (npair) bounds follow the stress of solids
      logical :: stretches = .true.            !! areas follow the motion: NLGEOM
      real(wp), allocatable :: speed(:)        !! (n) of slip, of the last iteration [length/time]
      real(wp), allocatable :: eased(:)        !! (n) condition_type%eased of points [-]
      ! inside
      real(wp) :: dt = 1.0_wp
      real(wp), allocatable :: first_weight(:) !! (n) areas at the start [area]
      real(wp), allocatable :: first_area(:)   !! (n) of its node there; 0: no faces [area]
      type(star_type), allocatable :: star(:)  !! (npair) of the slave, where bounds follow areas
      real(wp), allocatable :: start_normal(:, :)   !! (3, n) where the increment begins
      real(wp), allocatable :: start_gap(:)    !! (n) there; huge: nothing opposite [length]
      real(wp), allocatable :: start_row(:)    !! (n) there, rows with points in facets [length]
      logical, allocatable :: face_met(:)      !! (face) see lopin_nonlinear_faces
      real(wp), allocatable :: start_u(:)      !! (ndof) displacements then [length]
      type(gap_path_type) :: path              !! of the increment, where points go far
      real(wp), allocatable :: touch(:)        !! (n) share of the increment before it touched [-]
      real(wp) :: noted = 0.0_wp   !! > 0: the next evaluation stands this share of the way from the
                                   !! start to where the increment leads before contacts close
      real(wp) :: ahead = 1.0_wp   !! share of the way that the first step of Newton goes; 0: past
      logical :: has_arrived = .false.   !! what is prescribed has been applied: no slopes in it
      type(dofs_type) :: dofs
      type(facet_basis_type) :: basis
      type(masters_type) :: masters
      type(skin_type), allocatable :: skin(:)          !! (npair) faces of the slaves
      integer, allocatable :: piece(:)   !! (n) of the skin, on a sharp edge: that which is pressed
                                         !! where the increment begins; 0: all there
      type(enforcement_parameters_type), allocatable :: enforcement(:) !! (n)
      type(anchor_type), allocatable :: anchor(:)      !! (n)
      type(opposite_type), allocatable :: opposite(:)  !! (n) of the last evaluation
      type(present_mortar_type), allocatable :: mortar(:)        !! (npair)
      type(mortar_anchor_type), allocatable :: mortar_anchor(:)  !! (n)
      type(patch_type), allocatable :: patch(:)        !! (n) of the last evaluation
      type(point_state_type), allocatable :: trial(:)  !! (n)
      ! as it was measured where contact was met first
      real(wp), allocatable :: met_at(:)       !! (ndof) displacements there; else not yet [length]
      real(wp), allocatable :: tied_at(:, :)   !! (ndim, nnode) places there [length]
      logical, allocatable :: loose(:)         !! of a tied pair, but too far to be tied
      logical, allocatable :: idle(:)          !! (n) nothing that is solved for moves its node or
                                               !! the master: no row finds a force for it
      logical, allocatable :: waits(:)         !! (n) open until Newton is near a balance without it
      logical :: speed_of_trial = .true.       !! a coefficient that falls with the speed reads that
                                               !! of the trial; else `speed`
      ! of self-contact, where the increment begins
      logical, allocatable :: yields(:)        !! only pressed upon
      integer, allocatable :: pressing(:)      !! (nnode) pair whose node presses
   end type nonlinear_contact_type

contains

   !> Contacts of the nonlinear path at the start of a run.
   subroutine new_nonlinear_contact(self, model, dofs, log, error)
      type(nonlinear_contact_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: n, pair

      call new_nonlinear_points(self%nonlinear_points_type, model, log, error)
      if (allocated(error)) return
      call new_masters(self%masters, model, self%basis, error)
      if (allocated(error)) return
      n = self%n
      call new_facet_hysteresis(self%masters%owner, n)
      call new_skins(self%skin, model)
      self%first_weight = self%weight
      self%dofs = dofs
      allocate (self%first_area(n), source=0.0_wp)
      do pair = 1, size(model%pair)
         if (.not. self%masters%of(pair)%has_slave_faces) cycle
         associate (area => areas_of(self%masters, model, pair))
            where (self%pair == pair) self%first_area = area(self%node)
         end associate
      end do
      allocate (self%force(dofs%n), self%gap(n), self%opening(n), self%pressure(n), &
         & self%traction(3, n), self%normal(3, n), self%xi(2, n), self%start_normal(3, n), &
         & self%c(n), self%ct(n), self%mises(n), self%speed(n), self%start_gap(n), self%touch(n), &
         & source=0.0_wp)
      allocate (self%eased(n), source=1.0_wp)
      allocate (self%facet(n), self%status(n), self%first_row(n), self%piece(n), source=0)
      allocate (self%pressing(model%mesh%nnode), source=0)
      allocate (self%bilateral(n), self%loose(n), self%idle(n), self%waits(n), &
         & self%yields(n), self%follows(size(model%pair)), source=.false.)
      allocate (self%pair_active(size(model%pair)), source=.true.)
      allocate (self%enforcement(n), self%anchor(n), self%opposite(n), self%trial(n), self%local(n))
      allocate (self%friction(size(model%pair)), self%mortar(size(model%pair)), &
         & self%star(size(model%pair)), self%mortar_anchor(n), self%patch(n))
      do pair = 1, size(model%pair)
         self%friction(pair) = model%interaction(model%pair(pair)%interaction)%friction
         call choose_enforcement(self%enforcement, self%nonlinear_points_type, &
            & self%friction(pair), model, pair, log)
         if (self%masters%of(pair)%has_slave_faces) call new_present_mortar(self%mortar(pair), &
            & model, pair, self%masters%of(pair)%slave, self%masters%rules, &
            & findloc(self%pair, pair, dim=1), is_moved(self%shift, self%size))
      end do
      call number_rows(self, model%mesh%ndim)
      call keep_slopes(self, model)
      call find_before(self, model)
   end subroutine new_nonlinear_contact

   !> Slopes of the points, and rows of those whose method solves for a traction.
   subroutine number_rows(self, ndim)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: ndim
      integer :: i

      do i = 1, self%n
         self%c(i) = self%enforcement(i)%c
         self%ct(i) = self%enforcement(i)%ct
         if (.not. self%enforcement(i)%method%solves_for_multiplier()) cycle
         self%first_row(i) = self%nmultiplier + 1
         self%nmultiplier = self%nmultiplier + ndim
      end do
      allocate (self%row(self%nmultiplier), source=0.0_wp)
      allocate (self%point_of_row(self%nmultiplier))
      do i = 1, self%n
         if (self%first_row(i) > 0) self%point_of_row(self%first_row(i):self%first_row(i) + ndim &
            & - 1) = i
      end do
   end subroutine number_rows

   !> The points of a pair whose behaviour changes go on from those of the same nodes before.
   subroutine find_before(self, model)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i, k, pair
      logical :: free(self%n)

      allocate (self%before(self%n), source=0)
      free = .true.
      do i = 1, self%n
         pair = model%pair(self%pair(i))%before
         if (pair == 0) cycle
         k = findloc(self%pair(:self%n) == pair .and. self%node(:self%n) == self%node(i) &
            & .and. free, .true., dim=1)
         if (k == 0) cycle
         self%before(i) = k
         free(k) = .false.
      end do
   end subroutine find_before

   !> Where the state of a point is kept: its own place, or that of the point that it goes on from.
   pure integer function place_of(self, i, closed)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i
      logical, intent(in) :: closed(:)         !! (n) of the accepted state

      place_of = i
      if (self%before(i) == 0 .or. .not. self%pair_active(self%pair(i))) return
      ! A pair that acts no more forgets with the first increment.
      if (closed(self%before(i))) place_of = self%before(i)
   end function place_of

   !> Slave nodes of all pairs by mortar.
   pure integer function cover_size(self)
      type(nonlinear_contact_type), intent(in) :: self
      integer :: pair

      cover_size = 0
      do pair = 1, size(self%mortar)
         if (self%mortar(pair)%is_on) cover_size = cover_size + size(self%mortar(pair)%cover%state)
      end do
   end function cover_size

   !> Slopes as they were chosen first, and where the deck leaves them open.
   subroutine keep_slopes(self, model)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i

      allocate (self%slope(self%n), self%chosen(self%n))
      do i = 1, self%n
         self%slope(i) = self%enforcement(i)%slope
         self%chosen(i) = leaves_slope(model, self%pair(i)) &
            & .and. self%enforcement(i)%method%reads_slope()
      end do
   end subroutine keep_slopes

   !> The deck names no slope for a pair.
   pure logical function leaves_slope(model, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      associate (way => model%interaction(model%pair(pair)%interaction))
         leaves_slope = .not. way%slope*way%scale > 0.0_wp
      end associate
   end function leaves_slope

   !> Slopes that the deck leaves open are these times what was chosen first.
   pure subroutine set_slopes(self, stiffer)
      type(nonlinear_contact_type), intent(inout) :: self
      real(wp), intent(in) :: stiffer
      integer :: i

      do i = 1, self%n
         if (.not. self%chosen(i)) cycle
         associate (g => self%enforcement(i))
            g%slope = self%slope(i)*stiffer
            if (.not. g%method%solves_for_multiplier()) g%c = self%c(i)*stiffer
         end associate
      end do
   end subroutine set_slopes
end module lopin_nonlinear_contact
