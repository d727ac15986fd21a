!> All that evolves from increment to increment, and nothing else.
!>
!> A run holds two values of `state_type`: what was accepted, and a trial of the next increment.
!> `begin` starts a trial from what was accepted; all that an increment finds goes into the trial;
!> `accept` makes it the accepted state, `reject` drops it. `pass` writes a state to a stream or
!> reads it back. Matrices, factors, surfaces, trees of boxes and the numbers of the last iteration
!> are no state: they follow from the model and from it.
module lopin_state
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   use lopin_friction_state, only : friction_history_type
   implicit none
   private
   public :: state_type, motion_type, solids_state_type, contact_state_type, clock_state_type
   public :: loads_state_type, pressures_type, solver_state_type, judged_type, refused_type
   public :: begin, accept, reject, begin_step_of, new_contact_state

   !> Where the bodies are, and how they went there.
   type :: motion_type
      real(wp), allocatable :: u(:)            !! (ndof) displacements [length], rotations [rad]
      real(wp), allocatable :: last(:)         !! (ndof) motion of the last increment [length]
      real(wp) :: last_dt = 0.0_wp             !! its time; 0: none in this step [time]
      real(wp), allocatable :: before(:)       !! (ndof) motion of the increment before [length]
      real(wp) :: dt_before = 0.0_wp           !! its time; 0: none in this step [time]
      logical :: curved = .false.              !! both tell more of the next than the last alone
   contains
      procedure :: pass => pass_motion
   end type motion_type

   !> What the integration points of solids that look back remember: a column each, of rows that
   !> lopin_material_memory names; the columns of an element follow each other.
   type :: solids_state_type
      logical :: in_use = .false.              !! some material looks back
      logical :: finite_strain = .false.       !! finite strain; else small strain
      real(wp) :: dt = 1.0_wp                  !! of the increment that starts here [time]
      integer, allocatable :: first(:)         !! (nelement+1) first column of each element
      real(wp), allocatable :: value(:, :)     !! (nmemory, ncolumn)
      real(wp), allocatable :: pressed(:)      !! (ncolumn) ln J of the stresses of the start [-]
      logical :: scaled = .false.   !! the last row of value is the volume that the law counts by
                                    !! over that of the mesh [-]
      real(wp), allocatable :: none(:, :)      !! (0, most_points): elements that remember nothing
      real(wp) :: work = 0.0_wp                !! plastic work so far [force length]
      ! of the last increment
      real(wp) :: most_strain = 0.0_wp         !! largest plastic strain in it
      integer :: most_element = 0              !! where
      real(wp) :: volume = 0.0_wp              !! of the elements that flow, deformed [length^3]
      ! of solids that are heated; heat is its work [force length]
      real(wp) :: heat = 0.0_wp
      real(wp) :: unsure = 0.0_wp              !! how far it is known [force length]
      real(wp), allocatable :: heated(:, :)    !! (2, ncolumn) mean stress and offset
      real(wp), allocatable :: place(:)        !! (ncolumn) volume of the start [length^3]
      real(wp), allocatable :: damage(:, :)    !! (2 a criterion, ncolumn) lopin_damage
   contains
      procedure :: pass => pass_solids
   end type solids_state_type

   !> The contact at which the error of penalties was estimated last.
   type :: judged_type
      logical, allocatable :: closed(:)        !! (n) points that were closed
      integer :: before = 0                    !! increments since then
      real(wp), allocatable :: pressed(:)      !! (npair) normal forces one increment ago [force]
   end type judged_type

   !> What the search of contacts goes on from.
   type :: search_state_type
      integer, allocatable :: segment(:)       !! (n) of the tool, met last; 0: none yet
      integer, allocatable :: cover(:)         !! (slave nodes by mortar) lopin_mortar_cover
      real(wp), allocatable :: met_at(:)       !! (ndof) where contact was met first [length]
   end type search_state_type

   !> Contact on the present shape, by slave point. Vectors are in global axes.
   type :: contact_state_type
      real(wp), allocatable :: multiplier(:)   !! (nmultiplier) tractions that are unknowns [stress]
      real(wp), allocatable :: traction(:, :)  !! (3, n) on the slave [stress]
      real(wp), allocatable :: normal(:, :)    !! (3, n) when it pressed last
      real(wp), allocatable :: creep(:, :)     !! (3, n) slip from the stick anchor [length]
      real(wp), allocatable :: slip(:, :)      !! (3, n) of all increments together [length]
      real(wp), allocatable :: slip_path(:)    !! (n) its length [length]
      real(wp), allocatable :: speed(:)        !! (n) of slip, of the last increment [length/time]
      real(wp), allocatable :: friction_work(:)   !! (n) dissipated [force*length]
      real(wp), allocatable :: mean_work(:)    !! (n) the same by mean tractions [force*length]
      logical, allocatable :: closed(:)        !! (n) pressed once; NO SEPARATION holds it then
      integer, allocatable :: facet(:)         !! (n) kept beyond its end; 0: the nearest
      type(search_state_type) :: search
      logical, allocatable :: held(:)          !! (npair) has closed points
      real(wp), allocatable :: eased(:)        !! (n) condition_type%eased; none: all are 1
      real(wp), allocatable :: steepest(:)     !! (n) what that goes back to
      ! of both paths: penalties that were chosen
      real(wp) :: stiffer = 1.0_wp             !! slopes now, beside those first chosen
      integer :: raised = 0                    !! times they were raised; most_raises: no more
      real(wp) :: softness = 0.0_wp            !! estimated pressure error of penalties, relative
      type(judged_type) :: judged              !! what that was estimated at
   contains
      procedure :: pass => pass_contact
   end type contact_state_type

   !> Pressures that follow faces, where a step begins.
   type :: pressures_type
      integer, allocatable :: element(:), face(:)
      integer, allocatable :: family(:)        !! of the card
      real(wp), allocatable :: steady(:)       !! part without amplitude [stress]
      real(wp), allocatable :: pressure(:)     !! all of it [stress]
   contains
      procedure :: pass => pass_pressures
   end type pressures_type

   !> What moves the boundary, and what that has done.
   type :: loads_state_type
      real(wp), allocatable :: before(:)       !! (ndof) steady, where the step starts [force]
      real(wp), allocatable :: from(:)         !! (nprescribed) values there
      type(pressures_type) :: followers        !! there
      real(wp), allocatable :: steady(:)       !! (ndof) loads without amplitude [force]
      real(wp), allocatable :: force(:)        !! (ndof) all loads [force]
      real(wp), allocatable :: reaction(:)     !! (ndof) of the supports [force]
      real(wp), allocatable :: internal(:)     !! (ndof) of the solids: what holds their stresses in
                                               !! balance [force]
      real(wp), allocatable :: released(:)     !! (ndof) of pairs the next step takes away; fading
      real(wp) :: work = 0.0_wp                !! of loads and prescribed displacements [energy]
      real(wp) :: most = 0.0_wp                !! largest energy that was about [energy]
      real(wp) :: strain = 0.0_wp              !! elastic energy of the solids [energy]
      real(wp) :: pressed = 0.0_wp             !! largest force of a pair so far [force]
   contains
      procedure :: pass => pass_loads
   end type loads_state_type

   !> An increment in which too much force passed between points.
   type :: refused_type
      integer :: pair = 0                      !! whose force that was; 0: none was refused
      real(wp) :: share = 0.0_wp               !! of the force of contact
      real(wp) :: length = 0.0_wp              !! of the increment [time]
      real(wp) :: until = 0.0_wp               !! time of the step where it ended
   end type refused_type

   !> How far the run has gone, and how it goes on.
   type :: clock_state_type
      real(wp) :: start = 0.0_wp               !! total time at the start of the step [time]
      integer :: number = 0                    !! increments of the step
      real(wp) :: time = 0.0_wp                !! of the step, reached [time]
      logical :: at_end = .false.              !! the last increment of the step is accepted
      real(wp) :: increment = 0.0_wp           !! to be tried next [time]
      real(wp) :: usual = 0.0_wp               !! largest of the last ones accepted [time]
      integer :: vain_motions = 0              !! slow motions without rest, since an increment
      real(wp) :: vain = 0.0_wp                !! as long as the longest of theirs [time] ended
      real(wp) :: parts_from = 0.0_wp          !! time of the step when contact begins, and
      real(wp) :: parts_until = 0.0_wp         !! up to which it goes by parts [time]
      real(wp) :: part = 0.0_wp                !! of an increment in which contact began [time]
      type(refused_type) :: refused            !! the longest now tried over its time
      real(wp) :: worked = 0.0_wp              !! plastic work of the run when the last one ended
      real(wp) :: power = 0.0_wp               !! plastic, of the last one [energy/time]
      real(wp) :: lasted = 0.0_wp              !! its length [time]
      real(wp) :: missed = 0.0_wp              !! plastic work that it may have missed, by all [-]
      real(wp) :: flow = 0.0_wp                !! plastic power at its end, where loads drive
                                               !! metal [energy/time]
      real(wp) :: extra = 0.0_wp               !! plastic work that these did too much [energy]
      real(wp) :: extra_sum = 0.0_wp           !! the same, of the run [energy]
   contains
      procedure :: pass => pass_clock
   end type clock_state_type

   !> What solutions start from, and what was learnt on the way: answers change with it by rounding.
   type :: solver_state_type
      ! of the linear paths
      logical, allocatable :: candidate(:)     !! (npoint) within reach: may have a row
      real(wp), allocatable :: place(:, :)     !! (6, nbody) where tools were projected
      integer, allocatable :: last(:)          !! equations that the factor keeps last
      integer, allocatable :: joined(:)        !! those that joined it since
      logical, allocatable :: active(:)        !! (nrow) rows that are closed
      real(wp), allocatable :: force(:), gap(:)   !! (nrow) [force], [length]
      real(wp), allocatable :: multiplier(:)   !! (nrow) [force]
      real(wp), allocatable :: q(:), u(:)      !! motions that nothing else holds, displacements
      ! of the nonlinear path
      character(len=:), allocatable :: name    !! of the solver that was chosen
      logical :: has_solved = .false.          !! some increment, with forces about
      real(wp) :: bend = -1.0_wp               !! lopin_contraction
   contains
      procedure :: pass => pass_solver
   end type solver_state_type

   type :: state_type
      type(motion_type) :: motion
      type(solids_state_type) :: solids
      type(contact_state_type) :: contact      !! on the present shape: the nonlinear path
      type(friction_history_type) :: friction  !! on the shape of the start: the linear path
      type(loads_state_type) :: loads
      type(clock_state_type) :: clock
      type(solver_state_type) :: solver
   contains
      procedure :: pass
   end type state_type

contains

   !> An increment starts from what was accepted.
   subroutine begin(trial, accepted)
      type(state_type), intent(inout) :: trial
      type(state_type), intent(in) :: accepted
      trial = accepted
   end subroutine begin

   !> The increment is accepted.
   subroutine accept(accepted, trial)
      type(state_type), intent(inout) :: accepted
      type(state_type), intent(in) :: trial
      accepted = trial
   end subroutine accept

   !> The increment is given up: nothing of it is left.
   subroutine reject(trial, accepted)
      type(state_type), intent(inout) :: trial
      type(state_type), intent(in) :: accepted
      trial = accepted
   end subroutine reject

   !> In a new step no motion foretells the next, strains are finite or not, and bounds of friction
   !> rise as their laws say.
   subroutine begin_step_of(self, finite_strain)
      type(state_type), intent(inout) :: self
      logical, intent(in) :: finite_strain     !! strain

      self%motion%last_dt = 0.0_wp
      self%clock%usual = 0.0_wp
      self%clock%vain_motions = 0
      self%clock%vain = 0.0_wp
      self%clock%worked = self%solids%work
      self%clock%missed = 0.0_wp
      if (allocated(self%contact%eased)) deallocate (self%contact%eased, self%contact%steepest)
      self%solids%finite_strain = finite_strain
   end subroutine begin_step_of

   !> Points that nothing has pressed yet.
   subroutine new_contact_state(self, nmultiplier, ncover, closed)
      type(contact_state_type), intent(out) :: self
      integer, intent(in) :: nmultiplier
      integer, intent(in) :: ncover            !! slave nodes of pairs by mortar
      logical, intent(in) :: closed(:)         !! (n) touch at the start
      integer :: n

      n = size(closed)
      allocate (self%multiplier(nmultiplier), self%traction(3, n), self%normal(3, n), &
         & self%creep(3, n), self%slip(3, n), self%slip_path(n), self%speed(n), &
         & self%friction_work(n), self%mean_work(n), source=0.0_wp)
      allocate (self%facet(n), self%search%segment(n), source=0)
      allocate (self%search%cover(ncover), source=-1)
      self%closed = closed
   end subroutine new_contact_state

   !> To a stream or back.
   subroutine pass(self, stream)
      class(state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call self%motion%pass(stream)
      call self%solids%pass(stream)
      call self%contact%pass(stream)
      call self%friction%pass(stream)
      call self%loads%pass(stream)
      call self%clock%pass(stream)
      call self%solver%pass(stream)
   end subroutine pass

   subroutine pass_motion(self, stream)
      class(motion_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%u)
      call stream%pass(self%last)
      call stream%pass(self%last_dt)
      call stream%pass(self%before)
      call stream%pass(self%dt_before)
      call stream%pass(self%curved)
   end subroutine pass_motion

   subroutine pass_solids(self, stream)
      class(solids_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%in_use)
      call stream%pass(self%finite_strain)
      call stream%pass(self%first)
      call stream%pass(self%value)
      call stream%pass(self%pressed)
      call stream%pass(self%scaled)
      call stream%pass(self%none)
      call stream%pass(self%work)
      call stream%pass(self%most_strain)
      call stream%pass(self%most_element)
      call stream%pass(self%volume)
      call stream%pass(self%heat)
      call stream%pass(self%unsure)
      call stream%pass(self%heated)
      call stream%pass(self%place)
      call stream%pass(self%damage)
   end subroutine pass_solids

   subroutine pass_contact(self, stream)
      class(contact_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%multiplier)
      call stream%pass(self%traction)
      call stream%pass(self%normal)
      call stream%pass(self%creep)
      call stream%pass(self%slip)
      call stream%pass(self%slip_path)
      call stream%pass(self%speed)
      call stream%pass(self%friction_work)
      call stream%pass(self%mean_work)
      call stream%pass(self%closed)
      call stream%pass(self%facet)
      call stream%pass(self%search%segment)
      call stream%pass(self%search%cover)
      call stream%pass(self%search%met_at)
      call stream%pass(self%held)
      call stream%pass(self%eased)
      call stream%pass(self%steepest)
      call stream%pass(self%stiffer)
      call stream%pass(self%raised)
      call stream%pass(self%softness)
      call stream%pass(self%judged%closed)
      call stream%pass(self%judged%before)
      call stream%pass(self%judged%pressed)
   end subroutine pass_contact

   subroutine pass_loads(self, stream)
      class(loads_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%before)
      call stream%pass(self%from)
      call self%followers%pass(stream)
      call stream%pass(self%steady)
      call stream%pass(self%force)
      call stream%pass(self%reaction)
      call stream%pass(self%internal)
      call stream%pass(self%released)
      call stream%pass(self%work)
      call stream%pass(self%most)
      call stream%pass(self%strain)
      call stream%pass(self%pressed)
   end subroutine pass_loads

   subroutine pass_pressures(self, stream)
      class(pressures_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%element)
      call stream%pass(self%face)
      call stream%pass(self%family)
      call stream%pass(self%steady)
      call stream%pass(self%pressure)
   end subroutine pass_pressures

   subroutine pass_solver(self, stream)
      class(solver_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%candidate)
      call stream%pass(self%place)
      call stream%pass(self%last)
      call stream%pass(self%joined)
      call stream%pass(self%active)
      call stream%pass(self%force)
      call stream%pass(self%gap)
      call stream%pass(self%multiplier)
      call stream%pass(self%q)
      call stream%pass(self%u)
      call stream%pass(self%name)
      call stream%pass(self%has_solved)
      call stream%pass(self%bend)
   end subroutine pass_solver

   subroutine pass_clock(self, stream)
      class(clock_state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%start)
      call stream%pass(self%number)
      call stream%pass(self%time)
      call stream%pass(self%at_end)
      call stream%pass(self%increment)
      call stream%pass(self%usual)
      call stream%pass(self%vain_motions)
      call stream%pass(self%vain)
      call stream%pass(self%parts_from)
      call stream%pass(self%parts_until)
      call stream%pass(self%part)
      call stream%pass(self%refused%pair)
      call stream%pass(self%refused%share)
      call stream%pass(self%refused%length)
      call stream%pass(self%refused%until)
      call stream%pass(self%worked)
      call stream%pass(self%power)
      call stream%pass(self%lasted)
      call stream%pass(self%missed)
      call stream%pass(self%flow)
      call stream%pass(self%extra)
      call stream%pass(self%extra_sum)
   end subroutine pass_clock
end module lopin_state
