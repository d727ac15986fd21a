!> Everything the deck said, resolved to indices and checked. Never changes after `new_model`.
!>
!> Indices point into the lists of this type; 0 means "none". Locations point into the deck, so that
!> an error found while solving still shows the user's line. Physical dofs of a node are numbered as
!> in Abaqus: 1..3 translations, 4..6 rotations (2D: 1, 2 and 6; axisymmetric: 1 = r, 2 = z).
module lopin_model
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type
   use lopin_checksum, only : checksum_type
   use lopin_mesh, only : mesh_type
   use lopin_tool, only : tool_type
   use lopin_enforcement, only : enforcement_type
   use lopin_friction, only : friction_type
   use lopin_flow_curve, only : flow_type
   use lopin_damage_criteria, only : damage_type, damage_names
   use lopin_plastic_return, only : plastic_type
   use lopin_settings, only : settings_type
   use lopin_start, only : start_type
   implicit none
   private
   public :: model_type, material_type, section_type, surface_data_type, rigid_body_type
   public :: interaction_type, pair_type, amplitude_type, equation_type
   public :: friction_change_type, pair_change_type, spring_type
   public :: step_type, prescribed_type, point_load_type, face_load_type, body_load_type, &
      & output_type, temperature_type, initial_stress_type, initial_state_type, &
      & initial_traction_type
   public :: control_type, tool_holder_type
   public :: kind_of, overclosure_of, surface_of, output_of, initial_of
   public :: amplitude_value, amplitude_integral, is_heated

   !> What the whole scene is; every section of a scene has the same number of dimensions.
   type :: kinds_of
      integer :: plane_strain = 1, plane_stress = 2, axisymmetric = 3, solid = 4, rigid = 5
   end type kinds_of
   type(kinds_of), parameter :: kind_of = kinds_of()

   type :: overclosures_of
      integer :: hard = 1, linear = 2, exponential = 3, tabular = 4, tied = 5
   end type overclosures_of
   type(overclosures_of), parameter :: overclosure_of = overclosures_of()

   type :: surfaces_of
      integer :: faces = 1, nodes = 2, tool = 3
   end type surfaces_of
   type(surfaces_of), parameter :: surface_of = surfaces_of()

   type :: outputs_of
      integer :: node_print = 1, element_print = 2, contact_print = 3
      integer :: node_file = 4, element_file = 5, contact_file = 6
      integer :: field = 7, history = 8      !! *OUTPUT, FIELD / HISTORY
   end type outputs_of
   type(outputs_of), parameter :: output_of = outputs_of()

   !> What to do with an initial overclosure of a pair (`*CONTACT CONTROLS, INITIAL=`).
   type :: initials_of
      integer :: automatic = 1, error = 2, interference = 3, adjust = 4
   end type initials_of
   type(initials_of), parameter :: initial_of = initials_of()

   !> A material as the deck gave it. Many components: one for each number or switch of its cards,
   !> and the places of the cards for messages.
   type :: material_type
      character(len=:), allocatable :: name
      type(location_type) :: at
      logical :: has_elastic = .false.
      real(wp) :: young = 0.0_wp      !! [stress]
      real(wp) :: poisson = 0.0_wp, given_poisson = 0.0_wp   !! in force, and of *ELASTIC [-]
      logical :: green = .false.      !! under NLGEOM in Green's strain, not in logarithmic
      real(wp) :: density = 0.0_wp    !! [mass/length^3]
      logical :: has_neo_hooke = .false.
      real(wp) :: c10 = 0.0_wp        !! *HYPERELASTIC, NEO HOOKE: half the shear modulus [stress]
      real(wp) :: d1 = 0.0_wp         !! 2 / bulk modulus [1/stress]
      real(wp) :: yield = 0.0_wp   !! where flow begins, before anything is strained or heated; set
                                   !! by settle_flow; friction laws read it; 0: none [stress]
      logical :: hardens = .false.    !! *PLASTIC has a row above the first
      type(flow_type) :: flow         !! of *PLASTIC and *VISCOPLASTIC
      type(flow_type) :: friction_flow   !! of *PLASTIC, ONLY=FRICTION: the solid stays elastic
      type(plastic_type), allocatable :: plastic   !! of *POTENTIAL and of hardening that moves
      logical :: cyclic = .false.     !! *PLASTIC, HARDENING=COMBINED: *CYCLIC HARDENING fits
      type(location_type) :: plastic_at, viscous_at, potential_at, cyclic_at
      logical :: starts_elastic = .false. !! Hollomon without a yield stress: *ELASTIC gives it
      logical :: has_expansion = .false.
      real(wp) :: expansion = 0.0_wp  !! thermal strain per degree, *EXPANSION [1/temperature]
      type(damage_type), allocatable :: damage(:)   !! of *DAMAGE
   end type material_type

   type :: section_type
      type(location_type) :: at
      integer :: material = 0
      real(wp) :: thickness = 1.0_wp                    !! plane kinds [length]
      character(len=4) :: formulation = ''   !! '' (default), 'FULL', 'ONE': one point for C3D8R
      real(wp) :: axes(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, &
         & 0.0_wp, 1.0_wp], [3, 3])                     !! rows: axes of the material, *ORIENTATION
      logical :: oriented = .false.                     !! the deck gives them
   end type section_type

   !> A named surface: faces of elements, nodes with areas, or a rigid analytic tool.
   type :: surface_data_type
      character(len=:), allocatable :: name
      type(location_type) :: at
      integer :: kind = 1                               !! surface_of%...
      integer, allocatable :: element(:), face(:)       !! faces: element index, Abaqus face number
      integer, allocatable :: node(:)                   !! nodes: node indices
      real(wp), allocatable :: area(:)   !! nodes: area of each; 0: none, pressure is a force
      integer :: tool = 0                               !! tool: index into model%tool
      logical :: flat = .false.                 !! on plane elements of an axisymmetric scene
   end type surface_data_type

   type :: tool_holder_type
      character(len=:), allocatable :: name
      class(tool_type), allocatable :: shape            !! geometry at time zero
      integer :: rigid_body = 0                         !! the body that moves it; 0: fixed in space
   end type tool_holder_type

   !> A rigid body: an analytic surface, or nodes/elements that follow a reference node.
   type :: rigid_body_type
      character(len=:), allocatable :: name             !! for messages
      type(location_type) :: at
      integer :: reference = 0                          !! reference node index
      integer :: rotation = 0   !! node whose dofs 1..3 are the rotations (ROT NODE); 0: dofs 4..6
      integer :: tool = 0                               !! analytic surface, or 0
      integer, allocatable :: node(:)   !! nodes that follow (without the reference node)
      real(wp) :: start(6) = 0.0_wp   !! where *START finds it [length], [rad]
   end type rigid_body_type

   type :: interaction_type
      character(len=:), allocatable :: name
      type(location_type) :: at
      class(enforcement_type), allocatable :: method    !! what presses, and how
      integer :: overclosure = 1                        !! overclosure_of%...
      logical :: no_separation = .false.
      real(wp) :: slope = 0.0_wp   !! pressure per penetration [stress/length]; 0: automatic
      real(wp) :: clearance = 0.0_wp                    !! gap at which pressure starts [length]
      real(wp) :: scale = 1.0_wp                        !! factor on the slope
      real(wp), allocatable :: table(:, :)   !! (2, n) pressure, overclosure; exponential: (p0, c0)
      type(friction_type) :: friction
   end type interaction_type

   type :: control_type
      integer :: max_augmentations = 50
      real(wp) :: relative_penetration = 0.0_wp         !! 0: not given [-]
      real(wp) :: absolute_penetration = 0.0_wp         !! 0: not given [length]
      integer :: initial = 1                            !! initial_of%...
   end type control_type

   type :: pair_type
      type(location_type) :: at
      integer :: slave = 0, master = 0                  !! surfaces
      integer :: interaction = 0
      integer :: before = 0   !! the pair whose behaviour it changes: this one goes on from it
      integer :: first_step = 1, last_step = huge(1)    !! steps in which it can act
      logical :: surface_to_surface = .false.   !! dual mortar instead of node to segment
      logical :: open = .false.   !! the deck does not say which of the two
      logical :: smooth = .false.               !! normals interpolated from averaged nodal ones
      logical :: small_sliding = .false.
      logical :: tied = .false.
      real(wp) :: adjust = -1.0_wp                      !! ADJUST=tolerance; <0: none; YES: 0
      integer, allocatable :: adjust_node(:)            !! ADJUST=nset
      logical :: has_clearance = .false.
      real(wp) :: clearance = 0.0_wp   !! *CLEARANCE, VALUE=: replaces every initial gap
      real(wp) :: extension = 0.1_wp                    !! EXTENSION ZONE, fraction of a facet
      type(control_type) :: control
   end type pair_type

   type :: amplitude_type
      character(len=:), allocatable :: name
      real(wp), allocatable :: time(:), value(:)
      logical :: total_time = .false.
   end type amplitude_type

   !> sum coefficient * u(dof of node) = 0; the first term is eliminated.
   type :: equation_type
      type(location_type) :: at
      integer, allocatable :: node(:), dof(:)
      real(wp), allocatable :: coefficient(:)
   end type equation_type

   !> Local axes of the nodes that have one; rows of `axes` are the local directions.
   type :: transform_type
      integer, allocatable :: node(:)
      real(wp), allocatable :: axes(:, :, :)            !! (3, 3, node)
   end type transform_type

   type :: prescribed_type
      type(location_type) :: at
      integer :: node = 0, dof = 0
      real(wp) :: value = 0.0_wp   !! at the end of the step (times amplitude) [length] or [rad]
      logical :: velocity = .false.   !! value is a velocity [length/time] or [rad/time]
      integer :: amplitude = 0
   end type prescribed_type

   type :: point_load_type
      type(location_type) :: at
      integer :: node = 0, dof = 0
      real(wp) :: value = 0.0_wp   !! [force]; full circumference if axisymmetric
      integer :: amplitude = 0
   end type point_load_type

   type :: face_load_type
      type(location_type) :: at
      integer :: element = 0, face = 0
      integer :: family = 0   !! of the card: a new load replaces an old one of its own family
      real(wp) :: pressure = 0.0_wp                     !! > 0 pushes into the element [stress]
      real(wp) :: traction(3) = 0.0_wp                  !! added to the pressure [stress]
      integer :: amplitude = 0
   end type face_load_type

   type :: body_load_type
      type(location_type) :: at
      integer :: element = 0
      integer :: family = 0   !! 1 to 3 along an axis, 4 gravity: a new load replaces its own
      real(wp) :: force(3) = 0.0_wp   !! per unit volume; gravity already times density
                                      !! [force/length^3]
      integer :: amplitude = 0
   end type body_load_type

   !> *TEMPERATURE: of a node at the end of the step.
   type :: temperature_type
      integer :: node = 0
      real(wp) :: value = 0.0_wp                        !! (times amplitude) [temperature]
      integer :: amplitude = 0
   end type temperature_type

   !> *INITIAL CONDITIONS, TYPE=STRESS: of one point of an element, or of all.
   type :: initial_stress_type
      type(location_type) :: at
      integer :: element = 0
      integer :: point = 0                              !! as files count them; 0: all
      real(wp) :: stress(6) = 0.0_wp                    !! xx yy zz xy xz yz [stress]
   end type initial_stress_type

   !> *INITIAL CONDITIONS, TYPE=STATE or HARDENING: of one point of an element, or of all.
   type :: initial_state_type
      type(location_type) :: at
      integer :: element = 0
      integer :: point = 0                              !! 0: all of them
      logical :: whole = .false.                        !! else the plastic strain alone
      real(wp) :: strain(6) = 0.0_wp                    !! deviator of the elastic strain [-]
      real(wp) :: volume = 0.0_wp                       !! ln J of the elastic part [-]
      real(wp) :: ratio = 0.0_wp   !! ln of the volume here over that which the law counts by [-]
      real(wp) :: plastic = 0.0_wp                      !! accumulated strain [-]
      real(wp) :: flow_stress = 0.0_wp   !! of the last flow; 0: by the curve [stress]
      real(wp) :: work = 0.0_wp                         !! plastic, by that volume [stress]
      real(wp) :: damage(size(damage_names)) = 0.0_wp   !! by criterion [-]
   end type initial_state_type

   !> *INITIAL CONDITIONS, TYPE=TRACTION: what a slave node bears.
   type :: initial_traction_type
      integer :: pair = 0, node = 0
      real(wp) :: traction(3) = 0.0_wp                  !! [stress]
      real(wp) :: creep(3) = 0.0_wp                     !! slip from the stick anchor [length]
   end type initial_traction_type

   type :: output_type
      type(location_type) :: at
      integer :: kind = 0                               !! output_of%...
      integer :: set = 0                                !! node or element set index; 0: everything
      character(len=8), allocatable :: variable(:)  !! as written, upper case: U, RF, S, E, CDIS ...
      integer :: frequency = 1
      logical :: totals = .false., totals_only = .false.
      logical :: global = .true.                        !! else in the axes of *TRANSFORM
      integer :: slave = 0, master = 0                  !! surfaces of *CONTACT PRINT
   end type output_type

   !> *SPRING: a force between two nodes, or between a node and the ground.
   type :: spring_type
      type(location_type) :: at
      integer :: node(2) = 0                            !! 0: the ground
      logical :: axial = .false.                        !! along the line through its nodes
      real(wp) :: direction(3, 2) = 0.0_wp   !! else it extends by the displacement of each node
                                             !! along its column, the second less the first
      real(wp) :: stiffness = 0.0_wp                    !! [force/length]
      real(wp), allocatable :: table(:, :)   !! (2, n) force, extension, increasing; else linear
   end type spring_type

   !> *CHANGE FRICTION in a step.
   type :: friction_change_type
      type(location_type) :: at
      integer :: interaction = 0
      type(friction_type) :: friction
   end type friction_change_type

   !> *MODEL CHANGE, TYPE=CONTACT PAIR in a step.
   type :: pair_change_type
      type(location_type) :: at
      integer :: pair = 0
      logical :: active = .true.
   end type pair_change_type

   !> One step; prescribed values and loads are the complete lists in force (OP= is resolved).
   type :: step_type
      type(location_type) :: at
      character(len=:), allocatable :: heading
      logical :: ramp = .true.                          !! .false.: AMPLITUDE=STEP
      logical :: direct = .false.                       !! fixed increments
      logical :: nlgeom = .false.                       !! finite rotations and strains
      logical :: timed = .false.                        !! the deck gives the period
      real(wp) :: initial = 1.0_wp, period = 1.0_wp, smallest = 0.0_wp, largest = 0.0_wp
      integer :: max_increments = 100
      integer :: checkpoint = 1                         !! every so many increments; 0: none
      type(prescribed_type), allocatable :: prescribed(:)
      type(point_load_type), allocatable :: point_load(:)
      type(face_load_type), allocatable :: face_load(:)
      type(body_load_type), allocatable :: body_load(:)
      type(temperature_type), allocatable :: temperature(:)
      type(output_type), allocatable :: output(:)
      type(friction_change_type), allocatable :: friction_change(:)
      type(pair_change_type), allocatable :: pair_change(:)
   end type step_type

   !> All lists are allocated, possibly with size 0. Many components: one list for each kind of card
   !> of the deck, and the options of *LOPIN.
   type :: model_type
      character(len=:), allocatable :: heading
      type(settings_type) :: settings                   !! of the cards that are reported
      integer :: kind = 0   !! kind_of%... of the scene (plane strain if mixed with stress)
      type(mesh_type) :: mesh
      character(len=12), allocatable :: element_word(:)  !! what mesh%etype points to, e.g. CPE4
      type(material_type), allocatable :: material(:)
      type(section_type), allocatable :: section(:)
      type(surface_data_type), allocatable :: surface(:)
      type(tool_holder_type), allocatable :: tool(:)
      type(rigid_body_type), allocatable :: rigid_body(:)
      type(interaction_type), allocatable :: interaction(:)
      type(pair_type), allocatable :: pair(:)
      type(amplitude_type), allocatable :: amplitude(:)
      type(equation_type), allocatable :: equation(:)
      type(spring_type), allocatable :: spring(:)
      type(transform_type) :: transform
      real(wp), allocatable :: temperature(:)           !! (nnode) at the start [temperature]
      type(initial_stress_type), allocatable :: initial_stress(:)
      type(initial_state_type), allocatable :: initial_state(:)
      type(initial_traction_type), allocatable :: initial_traction(:)
      type(step_type), allocatable :: step(:)
      type(start_type) :: start                         !! where a part of a run goes on
      logical :: remeshes = .false.                     !! *REMESH
      type(location_type) :: remesh_at
      ! *LOPIN
      character(len=:), allocatable :: path             !! AUTO, CONDENSED, NEWTON
      type(location_type) :: path_at
      character(len=:), allocatable :: solver           !! AUTO or a solver's word
      real(wp) :: target_error = 0.01_wp   !! of pressure, that automatic penalties aim at [-]
      integer :: continuation = 1   !! number of penalties of the sequence of problems (lecture J.1)
      integer :: mortar_degree = 5  !! exactness of the cells of surface-to-surface pairs in space
      type(checksum_type) :: outside                    !! of what other files than the deck give
      type(log_type) :: log                             !! notes and warnings met while building
   end type model_type

contains

   !> Value of an amplitude at a time; linear between points, constant outside.
   pure real(wp) function amplitude_value(self, time) result(value)
      type(amplitude_type), intent(in) :: self
      real(wp), intent(in) :: time
      integer :: i, n

      n = size(self%time)
      value = self%value(n)
      if (time >= self%time(n)) return
      value = self%value(1)
      do i = 2, n
         if (time > self%time(i)) cycle
         if (time <= self%time(i - 1)) return
         value = self%value(i - 1) + (self%value(i) - self%value(i - 1)) &
            & *(time - self%time(i - 1))/(self%time(i) - self%time(i - 1))
         return
      end do
   end function amplitude_value

   !> Its integral from one time to a later one: exact, straight lines between the points.
   pure real(wp) function amplitude_integral(self, from, to) result(total)
      type(amplitude_type), intent(in) :: self
      real(wp), intent(in) :: from, to         !! [time]
      real(wp) :: last, next
      integer :: i

      total = 0.0_wp
      last = from
      do i = 1, size(self%time) + 1
         next = to
         if (i <= size(self%time)) next = min(to, self%time(i))
         if (next <= last) cycle
         total = total + 0.5_wp*(next - last)*(amplitude_value(self, last) &
            & + amplitude_value(self, next))
         last = next
      end do
   end function amplitude_integral

   !> Some step has a temperature.
   pure logical function is_heated(model)
      type(model_type), intent(in) :: model
      integer :: s

      is_heated = .false.
      do s = 1, size(model%step)
         if (allocated(model%step(s)%temperature)) is_heated = is_heated &
            & .or. size(model%step(s)%temperature) > 0
      end do
   end function is_heated
end module lopin_model
