!> Rows of the keyword table that only have a name: read past with a note, or refused until they
!> exist.
module lopin_keyword_rows_other
   use lopin_keyword_table, only : keyword_table_type, key, later_flag, ignored_flag, &
      & free_text, status_of
   implicit none
   private
   public :: add_other_rows

contains

   !> Keywords that are read past, and those that are refused by name.
   subroutine add_other_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_ignored(table)
      call add_later_materials(table)
      call add_later_contact(table)
      call add_later_mechanics(table)
      call add_later_procedures(table)
   end subroutine add_other_rows

   !> Nothing in the answer depends on these.
   subroutine add_ignored(table)
      type(keyword_table_type), intent(inout) :: table

      call past(table, 'PREPRINT', 'M', 'Echo of the input in Abaqus.')
      call past(table, 'PHYSICAL CONSTANTS', 'M', 'Absolute zero and the Stefan-Boltzmann '// &
         & 'constant.')
      call past(table, 'CONDUCTIVITY', 'M', 'Heat conduction; there is none in a static step.')
      call past(table, 'SPECIFIC HEAT', 'M', 'Heat capacity; there is none in a static step.')
      call past(table, 'CONTROLS', 'MS', 'Tolerances of another code''s iterations; Lopin has '// &
         & 'its own.')
      call past(table, 'TIME POINTS', 'MS', 'Times of output; results are at increments.')
      call past(table, 'MONITOR', 'S', 'A dof to watch in Abaqus.')
      call past(table, 'FILE FORMAT', 'MS', 'Format of the Abaqus result file.')
      call past(table, 'ENERGY OUTPUT', 'S', 'Energies; the history file always holds them.')
      call past(table, 'ENERGY PRINT', 'S', 'Energies; the history file always holds them.')
      call past(table, 'ENERGY FILE', 'S', 'Energies; the history file always holds them.')
      call past(table, 'USER OUTPUT VARIABLES', 'M', 'Variables of user subroutines.')
      call past(table, 'SOLVER CONTROLS', 'S', 'Controls of the iterative solver of Abaqus.')
      call past(table, 'DIAGNOSTICS', 'S', 'Messages of Abaqus.')
      call past(table, 'PRINT', 'S', 'Messages of Abaqus.')
      call past(table, 'CONTACT DIAGNOSTICS', 'S', 'Messages of Abaqus.')
      call past(table, 'INCREMENTATION OUTPUT', 'S', 'Increments; the .sta file holds them.')
      call past(table, 'WAVEFRONT MINIMIZATION', 'M', 'Order of elimination; Lopin has its own.')
      call past(table, 'SOLUTION TECHNIQUE', 'S', 'Newton or quasi-Newton; Lopin has its own.')
      call past(table, 'INELASTIC HEAT FRACTION', 'M', 'Heat of plastic work; there is none in '// &
         & 'a static step.')
      call past(table, 'LATENT HEAT', 'M', 'Heat conduction; there is none in a static step.')
      call past(table, 'BULK VISCOSITY', 'MS', 'Damping of Abaqus/Explicit.')
      call past(table, 'VALUES AT INFINITY', 'M', 'Flow in CalculiX; there is none.')
   end subroutine add_ignored

   subroutine past(table, name, levels, sentence)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name, levels, sentence

      call key(table, name, levels, 'both', sentence, status_of%ignored)
      call free_text(table)
   end subroutine past

   subroutine add_later_materials(table)
      type(keyword_table_type), intent(inout) :: table

      call later(table, 'CREEP', 'creep')
      call later(table, 'HYPERFOAM', 'hyperelastic foam')
      call later(table, 'VISCOELASTIC', 'viscoelasticity')
      call later(table, 'HYPOELASTIC', 'elasticity by rates')
      call later(table, 'POROUS ELASTIC', 'elasticity of soils')
      call later(table, 'MULLINS EFFECT', 'rubber that softens')
      call later(table, 'UNIAXIAL TEST DATA', 'constants fitted to tests')
      call later(table, 'BIAXIAL TEST DATA', 'constants fitted to tests')
      call later(table, 'PLANAR TEST DATA', 'constants fitted to tests')
      call later(table, 'VOLUMETRIC TEST DATA', 'constants fitted to tests')
      call later(table, 'DRUCKER PRAGER', 'plasticity that depends on pressure')
      call later(table, 'DRUCKER PRAGER HARDENING', 'plasticity that depends on pressure')
      call later(table, 'MOHR COULOMB', 'plasticity that depends on pressure')
      call later(table, 'MOHR COULOMB HARDENING', 'plasticity that depends on pressure')
      call later(table, 'CAP PLASTICITY', 'plasticity that depends on pressure')
      call later(table, 'CRUSHABLE FOAM', 'plasticity that depends on pressure')
      call later(table, 'POROUS METAL PLASTICITY', 'plasticity of porous metal')
      call later(table, 'CAST IRON PLASTICITY', 'plasticity of cast iron')
      call later(table, 'ANNEAL TEMPERATURE', 'annealing')
      call later(table, 'NO COMPRESSION', 'materials without compression')
      call later(table, 'NO TENSION', 'materials without tension')
      call later(table, 'SHEAR FAILURE', 'elements that fail (*DAMAGE, CRITICAL exists)')
      call later(table, 'TENSILE FAILURE', 'elements that fail (*DAMAGE, CRITICAL exists)')
      call later(table, 'DEFORMATION PLASTICITY', 'deformation plasticity')
      call later(table, 'USER MATERIAL', 'user materials')
      call later(table, 'DEPVAR', 'user materials')
      call later(table, 'DAMAGE INITIATION', 'damage')
      call later(table, 'DAMAGE EVOLUTION', 'damage')
      call later(table, 'DAMPING', 'damping')
      call later(table, 'DISTRIBUTION', 'distributions of properties')
      call later(table, 'SHELL SECTION', 'shells')
      call later(table, 'SHELL GENERAL SECTION', 'shells')
      call later(table, 'MEMBRANE SECTION', 'membranes')
      call later(table, 'BEAM SECTION', 'beams')
      call later(table, 'BEAM GENERAL SECTION', 'beams')
      call later(table, 'COHESIVE SECTION', 'cohesive elements')
      call later(table, 'NODAL THICKNESS', 'shells')
      call later(table, 'HOURGLASS STIFFNESS', 'hourglass control')
      call later(table, 'GASKET SECTION', 'gaskets')
      call later(table, 'USER ELEMENT', 'user elements')
      call later(table, 'REBAR', 'bars in solids')
   end subroutine add_later_materials

   subroutine add_later_contact(table)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), parameter :: general = 'general contact (*CONTACT PAIR exists)'

      call later(table, 'SELF CONTACT', 'self-contact')
      call later(table, 'CONTACT', general)
      call later(table, 'CONTACT INCLUSIONS', general)
      call later(table, 'CONTACT EXCLUSIONS', general)
      call later(table, 'CONTACT PROPERTY ASSIGNMENT', general)
      call later(table, 'CONTACT CONTROLS ASSIGNMENT', general)
      call later(table, 'CONTACT INITIALIZATION ASSIGNMENT', general)
      call later(table, 'CONTACT INITIALIZATION DATA', general)
      call later(table, 'CONTACT FORMULATION', general)
      call later(table, 'SURFACE PROPERTY ASSIGNMENT', general)
      call later(table, 'CONTACT STABILIZATION', 'viscous stabilisation of contact')
      call later(table, 'CONTACT INTERFERENCE', 'shrink fits given in a step')
      call later(table, 'CONTACT DAMPING', 'contact damping')
      call later(table, 'GAP CONDUCTANCE', 'heat conduction')
      call later(table, 'GAP RADIATION', 'heat conduction')
      call later(table, 'GAP HEAT GENERATION', 'heat conduction')
      call later(table, 'COHESIVE BEHAVIOR', 'cohesive surfaces')
      call later(table, 'DEBOND', 'surfaces that part')
      call later(table, 'FRACTURE CRITERION', 'surfaces that part')
      call later(table, 'RIGID SURFACE', 'the old card of tools (*SURFACE, TYPE=SEGMENTS with '// &
         & '*RIGID BODY exists)')
      call later(table, 'SURFACE SMOOTHING', 'round faces of Abaqus (*CONTACT PAIR, SMOOTH exists)')
      call later(table, 'SLIDE LINE', 'slide lines (*CONTACT PAIR exists)')
   end subroutine add_later_contact

   subroutine add_later_mechanics(table)
      type(keyword_table_type), intent(inout) :: table

      call later(table, 'MPC', 'multi-point constraints (*EQUATION exists)')
      call later(table, 'COUPLING', 'couplings (*RIGID BODY exists)')
      call later(table, 'KINEMATIC', 'couplings (*RIGID BODY exists)')
      call later(table, 'KINEMATIC COUPLING', 'couplings (*RIGID BODY exists)')
      call later(table, 'DISTRIBUTING', 'couplings (*RIGID BODY exists)')
      call later(table, 'DISTRIBUTING COUPLING', 'couplings (*RIGID BODY exists)')
      call later(table, 'DASHPOT', 'dashpots')
      call later(table, 'MASS', 'point masses')
      call later(table, 'ROTARY INERTIA', 'point masses')
      call later(table, 'CONNECTOR SECTION', 'connectors')
      call later(table, 'CYCLIC SYMMETRY MODEL', 'cyclic symmetry')
      call later(table, 'SUBMODEL', 'submodels')
      call later(table, 'NGEN', 'mesh generation in the deck')
      call later(table, 'NFILL', 'mesh generation in the deck')
      call later(table, 'NCOPY', 'mesh generation in the deck')
      call later(table, 'NMAP', 'mesh generation in the deck')
      call later(table, 'ELGEN', 'mesh generation in the deck')
      call later(table, 'ELCOPY', 'mesh generation in the deck')
      call later(table, 'SYSTEM', 'local axes of nodes')
      call later(table, 'PARAMETER', 'parameters in the deck')
      call later(table, 'EMBEDDED ELEMENT', 'embedded elements')
      call later(table, 'SHELL TO SOLID COUPLING', 'shells')
      call later(table, 'FLUID CAVITY', 'cavities')
      call later(table, 'INERTIA RELIEF', 'dynamics')
      call later(table, 'ADAPTIVE MESH', 'adaptive meshing of Abaqus (*REMESH exists)')
      call later(table, 'ADAPTIVE MESH CONTROLS', 'adaptive meshing of Abaqus (*REMESH exists)')
      call later(table, 'ADAPTIVE MESH CONSTRAINT', 'adaptive meshing of Abaqus (*REMESH exists)')
      call later(table, 'REFINE MESH', 'refinement (*LOPIN, TARGET ERROR exists)')
      call later(table, 'IMPORT', 'states of another run (lopin.operation of Python exists)')
      call later(table, 'MAP SOLUTION', 'states of another run (lopin.operation of Python exists)')
   end subroutine add_later_mechanics

   subroutine add_later_procedures(table)
      type(keyword_table_type), intent(inout) :: table

      call later(table, 'DYNAMIC', 'dynamics')
      call later(table, 'MODAL DYNAMIC', 'dynamics')
      call later(table, 'STEADY STATE DYNAMICS', 'dynamics')
      call later(table, 'FREQUENCY', 'natural frequencies')
      call later(table, 'BUCKLE', 'buckling')
      call later(table, 'HEAT TRANSFER', 'heat conduction')
      call later(table, 'COUPLED TEMPERATURE-DISPLACEMENT', 'heat conduction')
      call later(table, 'UNCOUPLED TEMPERATURE-DISPLACEMENT', 'heat conduction')
      call later(table, 'VISCO', 'creep')
      call later(table, 'ANNEAL', 'annealing')
      call later(table, 'DIRECT CYCLIC', 'cyclic steps')
      call later(table, 'COMPLEX FREQUENCY', 'natural frequencies')
      call later(table, 'RANDOM RESPONSE', 'dynamics')
      call later(table, 'RESPONSE SPECTRUM', 'dynamics')
      call later(table, 'GEOSTATIC', 'soils')
      call later(table, 'SOILS', 'soils')
      call later(table, 'FIXED MASS SCALING', 'dynamics')
      call later(table, 'VARIABLE MASS SCALING', 'dynamics')
      call later(table, 'CHANGE MATERIAL', 'materials that change in a step')
      call later(table, 'CHANGE PLASTIC', 'materials that change in a step')
      call later(table, 'CHANGE SOLID SECTION', 'materials that change in a step')
      call later(table, 'CHANGE CONTACT TYPE', 'pairs that change in a step')
      call later(table, 'FILM', 'heat conduction')
      call later(table, 'SFILM', 'heat conduction')
      call later(table, 'RADIATE', 'heat conduction')
      call later(table, 'CFLUX', 'heat conduction')
      call later(table, 'DFLUX', 'heat conduction')
      call later(table, 'DSFLUX', 'heat conduction')
      call later(table, 'BASE MOTION', 'dynamics')
      call later(table, 'FIELD', 'field variables')
      call later(table, 'SECTION PRINT', 'forces on sections')
      call later(table, 'SECTION FILE', 'forces on sections')
      call later(table, 'SUBSTRUCTURE GENERATE', 'substructures')
      call later(table, 'SENSITIVITY', 'sensitivities')
   end subroutine add_later_procedures

   subroutine later(table, name, what)
      type(keyword_table_type), intent(inout) :: table
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: what   !! noun that the refusal names
      call key(table, name, 'MPAS', 'both', what, status_of%later)
   end subroutine later
end module lopin_keyword_rows_other
