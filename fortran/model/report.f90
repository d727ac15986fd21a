!> Reports: what one accepted increment, and a whole run, show to the recorders.
module lopin_report
   use lopin_kinds, only : wp
   use lopin_error, only : log_type
   use lopin_clock, only : counter_type, clock_type
   use lopin_shared_work, only : threads_of_run
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: lost_work, lost_share, note_most
   public :: contact_field_type, damage_field_type, certificate_type, &
      & frame_type, energy_type, summary_type, new_summary, &
      & verdict_words, keep_certificate, keep_energy

   character(len=*), parameter :: verdict_words(0:2) = [character(len=4) :: 'PASS', 'WARN', 'FAIL']

   !> Results of one criterion of damage.
   type :: damage_field_type
      character(len=:), allocatable :: name
      logical :: averaged = .false.          !! some material has a WIDTH
      real(wp), allocatable :: value(:, :)   !! (2, npoint) damage, its mean over the width [-]
      real(wp), allocatable :: nodal(:, :)   !! (2, nnode) if stresses are wanted there [-]
      real(wp) :: most = 0.0_wp              !! largest mean [-]
   end type damage_field_type

   !> Results of one pair, an entry per slave point. Forces are on the full circumference if
   !> axisymmetric.
   type :: contact_field_type
      integer, allocatable :: node(:)        !! slave node index
      integer, allocatable :: facet(:)       !! master facet; 0: none found (never touches)
      integer, allocatable :: status(:)   !! 0 open, 1 stick, 2 slip (or closed without friction),
                                          !! 3 tied; -1: no master opposite
      real(wp), allocatable :: weight(:)   !! tributary area [length^2]; plane: times thickness; 1
                                           !! if unknown
      real(wp), allocatable :: gap(:)        !! signed, >= 0 open [length]
      real(wp), allocatable :: pressure(:)   !! >= 0 pressing; < 0 only if bilateral [stress]
      real(wp), allocatable :: normal(:, :)  !! (ndim, npoint) master's outward normal
      real(wp), allocatable :: force(:, :)   !! (ndim, npoint) of the master on the slave by the row
                                             !! of the point, on all nodes that bear it [force]
      real(wp), allocatable :: shear(:, :)   !! (ndim, npoint) of it, along the tangents of the
                                             !! point [force]
      real(wp), allocatable :: couple(:, :)  !! (3, npoint) moment of it about the point
                                             !! [force*length]
      real(wp), allocatable :: xi(:, :)      !! (2, npoint) projection on the facet
      real(wp), allocatable :: u_n(:)   !! normal displacement relative to the master since the
                                        !! start [length]
      real(wp), allocatable :: u_t(:, :)   !! (ndim, npoint) tangential relative displacement
                                           !! [length]
      real(wp), allocatable :: slip_path(:)      !! length of the way slid in contact [length]
      real(wp), allocatable :: friction_work(:)  !! dissipated at the point [force*length]
      real(wp) :: lost = 0.0_wp              !! of the force, that the pressures do not carry [-]
   end type contact_field_type

   !> Tests of friction.
   type :: rubbing_type
      real(wp) :: cone = 0.0_wp   !! largest tangential force beyond its bound / largest bound
      real(wp) :: ramp = 0.0_wp   !! share of the bounds of shear that lightly pressed points lack
      real(wp) :: dissipation = 0.0_wp   !! least friction work of a point in the increment / most
   end type rubbing_type

   !> The frozen tests of an accepted increment; every number is dimensionless.
   type :: certificate_type
      real(wp) :: penetration = 0.0_wp       !! deepest penetration / slave facet size
      real(wp) :: tension = 0.0_wp   !! largest tension / largest pressure, unilateral points
      real(wp) :: complementarity = 0.0_wp   !! max |min(p, c g)| / p_ref over the exact pairs
      type(rubbing_type) :: rubs             !! tests of friction
      real(wp) :: pressure_error = 0.0_wp    !! estimate for rows that allow penetration
      logical :: obeys = .false.             !! all slopes of contact are the deck's
      logical :: flows = .false.             !! some solid flows: its work is a sum over increments
      real(wp) :: depth = 0.0_wp   !! deepest penetration / thinnest body of its pair, of slopes
      real(wp) :: corner = 1.0_wp            !! least scaled Jacobian of a corner, if it is folded
      integer :: folded = 0                  !! label of its element; 0: none
      integer :: fold_level = 0              !! what that makes of the verdict
      real(wp) :: equilibrium = 0.0_wp       !! largest residual / reference force
      real(wp) :: action_reaction = 0.0_wp   !! |sum of slave and master forces| / sum of |forces|
      real(wp) :: energy = 0.0_wp            !! energy balance, relative
      real(wp) :: support = 0.0_wp           !! reaction of artificial supports / load
      real(wp) :: artificial = 0.0_wp        !! work of what held floating bodies / work of the run,
                                             !! or energy of hourglass motions / of the bodies
      real(wp) :: traction = 0.0_wp   !! force that printed pressures do not carry / force
      integer :: verdict = 0                 !! index into verdict_words
      real(wp) :: excess = 0.0_wp   !! sum of figure / limit of the tests that fail; 0: none
      character(len=:), allocatable :: reason  !! empty if PASS
   end type certificate_type

   type :: energy_type
      real(wp) :: strain = 0.0_wp            !! [force*length]
      real(wp) :: external = 0.0_wp   !! work of loads and prescribed displacements since the start
      real(wp) :: contact = 0.0_wp           !! stored by penalty springs
      real(wp) :: friction = 0.0_wp   !! dissipated since the start, tractions at increments' ends
      real(wp) :: friction_mean = 0.0_wp   !! the same by mean tractions: balances external
      real(wp) :: plastic = 0.0_wp           !! work of plastic and viscous flow since the start
      real(wp) :: thermal = 0.0_wp           !! work of heat against stresses since the start
      real(wp) :: artificial = 0.0_wp   !! taken up by what held floating bodies since the start
      real(wp) :: hourglass = 0.0_wp         !! of `strain`, in hourglass motions
      real(wp) :: volume = 0.0_wp            !! of the bodies that flow, deformed [length^3]
      real(wp) :: nothing = 0.0_wp           !! below which they are not known
      real(wp) :: most = 0.0_wp              !! largest that was about since the start
   end type energy_type

   !> One accepted increment, as handed to the recorders. Displacements and reactions by node:
   !> dofs 1..3 translations, 4..6 rotations (only of reference nodes); zero where a node has no
   !> such dof. Many components: each is a column or a field of some result file.
   type :: frame_type
      integer :: step = 0, increment = 0, iterations = 0, augmentations = 0
      integer :: attempt = 1                  !! 1 as no increment is cut yet
      integer :: closed = 0                   !! slave points in contact
      real(wp) :: total_time = 0.0_wp, step_time = 0.0_wp, time_increment = 0.0_wp
      logical :: last_of_step = .false.
      real(wp), allocatable :: u(:, :)        !! (6, nnode) [length], [rad]
      real(wp), allocatable :: rf(:, :)   !! (6, nnode) reactions at prescribed dofs and reference
                                          !! nodes [force]
      real(wp), allocatable :: stress(:, :)   !! (6, npoint) xx yy zz xy xz yz at integration points
                                              !! [stress]
      real(wp), allocatable :: strain(:, :)   !! (6, npoint) engineering shears
      integer, allocatable :: first_point(:)   !! (nelement+1) first integration point of each
                                               !! element in `stress`
      real(wp), allocatable :: nodal_stress(:, :) !! (6, nnode) extrapolated and averaged
      !> (1, npoint) and (1, nnode) accumulated plastic strain, if some material flows
      real(wp), allocatable :: plastic_strain(:, :), nodal_plastic(:, :)
      type(damage_field_type), allocatable :: damage(:)    !! by criterion, if a material has one
      type(contact_field_type), allocatable :: contact(:)  !! by pair
      type(certificate_type) :: certificate
      type(energy_type) :: energy
   end type frame_type

   type :: step_summary_type
      integer :: increments = 0
      type(counter_type) :: counter
   end type step_summary_type

   !> What a whole run did.
   type :: summary_type
      character(len=:), allocatable :: status     !! finished, not converged, failed
      integer :: exit_code = 0
      character(len=:), allocatable :: plan       !! the line that says what was chosen and why
      character(len=:), allocatable :: path, solver
      character(len=:), allocatable :: reason     !! why this solver, where it was chosen on the way
      integer :: equations = 0, retained = 0, candidates = 0
      type(step_summary_type), allocatable :: step(:)
      type(clock_type) :: clock
      type(log_type) :: log                       !! what the run itself had to say
      real(wp) :: peak_memory = 0.0_wp            !! [MiB]
      integer :: threads = 1
      !> Of the translations of all nodes in all increments, in order; equal results have equal
      !> ones.
      character(len=:), allocatable :: checksum
   end type summary_type

contains

   !> Of a run of so many steps that begins now, on the threads of now.
   subroutine new_summary(summary, nstep)
      type(summary_type), intent(out) :: summary
      integer, intent(in) :: nstep

      summary%status = 'finished'
      summary%plan = ''
      summary%path = ''
      summary%solver = ''
      summary%reason = ''
      summary%checksum = ''
      summary%threads = threads_of_run()
      allocate (summary%step(nstep))
   end subroutine new_summary

   !> The last certificate, to a stream or back.
   subroutine keep_certificate(self, stream)
      type(certificate_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%penetration)
      call stream%pass(self%tension)
      call stream%pass(self%complementarity)
      call stream%pass(self%rubs%cone)
      call stream%pass(self%rubs%ramp)
      call stream%pass(self%rubs%dissipation)
      call stream%pass(self%pressure_error)
      call stream%pass(self%obeys)
      call stream%pass(self%flows)
      call stream%pass(self%depth)
      call stream%pass(self%corner)
      call stream%pass(self%folded)
      call stream%pass(self%fold_level)
      call stream%pass(self%equilibrium)
      call stream%pass(self%action_reaction)
      call stream%pass(self%energy)
      call stream%pass(self%support)
      call stream%pass(self%artificial)
      call stream%pass(self%traction)
      call stream%pass(self%verdict)
      call stream%pass(self%excess)
      call stream%pass(self%reason)
   end subroutine keep_certificate

   !> The last energies, to a stream or back.
   subroutine keep_energy(self, stream)
      type(energy_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%strain)
      call stream%pass(self%external)
      call stream%pass(self%contact)
      call stream%pass(self%friction)
      call stream%pass(self%friction_mean)
      call stream%pass(self%plastic)
      call stream%pass(self%thermal)
      call stream%pass(self%nothing)
      call stream%pass(self%most)
      call stream%pass(self%volume)
      call stream%pass(self%hourglass)
      call stream%pass(self%artificial)
   end subroutine keep_energy

   !> Work that is neither stored nor dissipated, beside the most that was done; 0 where nothing is.
   pure real(wp) function lost_share(energy) result(share)
      type(energy_type), intent(in) :: energy
      real(wp) :: whole

      share = lost_work(energy)
      whole = max(energy%most, energy%nothing)
      if (whole > 0.0_wp) share = sign(max(abs(share) - energy%nothing, 0.0_wp), share)/whole
   end function lost_share

   !> Keep the largest energy: what a share of the work is beside does not fade where it is given
   !> back.
   pure subroutine note_most(energy, most)
      type(energy_type), intent(inout) :: energy
      real(wp), intent(inout) :: most          !! of the increments before

      most = max(most, abs(energy%external), abs(energy%thermal), &
         & energy%strain + energy%plastic + abs(energy%friction_mean))
      energy%most = most
   end subroutine note_most

   !> Work that is neither stored nor dissipated [energy].
   pure real(wp) function lost_work(energy)
      type(energy_type), intent(in) :: energy

      lost_work = energy%external + energy%thermal - energy%strain - energy%contact &
         & - energy%friction_mean - energy%plastic
   end function lost_work
end module lopin_report
