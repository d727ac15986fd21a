!> Rows of the keyword table: contact pairs, interactions, their methods and controls.
module lopin_keyword_rows_contact
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, number, whole, choice, &
      & ignored_flag, later_flag, required, known_as, refuses, data_line, example, under, about, &
      & bare_value
   implicit none
   private
   public :: add_contact_rows

contains

   !> Pairs, ties, interactions and their controls.
   subroutine add_contact_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_pair(table)
      call add_tie(table)
      call add_interaction(table)
      call add_controls(table)
   end subroutine add_contact_rows

   subroutine add_pair(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'CONTACT PAIR', 'MA', 'both', 'Two surfaces that may touch: slave, then '// &
         & 'master.')
      call word(table, 'INTERACTION', 'Name of the *SURFACE INTERACTION.')
      call required(table)
      call choice(table, 'TYPE', 'NODE TO SURFACE,SURFACE TO SURFACE,MORTAR,LINMORTAR,'// &
         & 'PGLINMORTAR', 'NODE TO SURFACE', &
         & 'NODE TO SURFACE: each slave node meets the facet opposite; the others: dual '// &
         & 'mortar, each slave node meets the mean of what its share of the surface covers. '// &
         & 'Rigid tools and slaves of nodes: at the nodes in both. A pair without TYPE is '// &
         & 'surface to surface where its facets do not match, and on the nonlinear path '// &
         & '(N0347); in space and on that path if what faces the master lies opposite it '// &
         & 'whole or is of metal; never in a run with new meshes.')
      call refuses(table, 'MASSLESS')
      call flag(table, 'SMALL SLIDING', 'Each slave node keeps the plane it met at the start.')
      call word(table, 'ADJUST', &
         & 'Moves slave nodes on the master without strain: those that penetrate and those '// &
         & 'nearer than a distance, or the nodes of a set; YES: only those that penetrate.')
      call bare_value(table, 'YES')
      call flag(table, 'TIED', 'The surfaces stay glued; by mortar unless TYPE says otherwise.')
      call number(table, 'EXTENSION ZONE', '0.1', 'Extension of open master edges, and of '// &
         & 'edges to walls that the slave does not face, fraction of a facet, 0 to 0.2.')
      call flag(table, 'NO THICKNESS', 'Shell thickness does not count; accepted.')
      call ignored_flag(table, 'HCRIT', 'Distance of an old search.')
      call choice(table, 'SMOOTH', 'YES,NO', 'NO', 'YES: linear facets of the master are '// &
         & 'curved by averaged normals, joints up to 30 degrees; where contact is at the '// &
         & 'nodes. Opposite a profile (TYPE=SEGMENTS in the plane) those of the slave are '// &
         & 'curved, under NLGEOM: forces of sheets that roll on radii wave half as much.')
      call bare_value(table, 'YES')
      call ignored_flag(table, 'MECHANICAL CONSTRAINT', 'Choice of Abaqus/Explicit.')
      call ignored_flag(table, 'SUPPLEMENTARY CONSTRAINTS', 'Points that Abaqus adds.')
      call ignored_flag(table, 'TRACKING', 'Search of Abaqus.')
      call ignored_flag(table, 'WEIGHT', 'Roles in Abaqus/Explicit.')
      call later_flag(table, 'GEOMETRIC CORRECTION', 'Round faces: SMOOTH exists.')
      call later_flag(table, 'CPSET', 'Controls by name: *CONTACT CONTROLS, SLAVE, MASTER exists.')
      call data_line(table, 'slave surface, master surface', 'One pair a line.')
      call example(table, '*CONTACT PAIR, INTERACTION=SMOOTH, TYPE=NODE TO SURFACE|TOP, PUNCH')
      call about(table, 'D, H')
   end subroutine add_pair

   subroutine add_tie(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'TIE', 'MA', 'both', 'Glues two surfaces whose meshes need not match: '// &
         & 'slave, then master.')
      call word(table, 'NAME', 'Name of the tie.')
      call required(table)
      call choice(table, 'TYPE', 'SURFACE TO SURFACE,NODE TO SURFACE', 'SURFACE TO SURFACE', &
         & 'Dual mortar, exact for uniform stress, or each slave node on its own; in 3D and '// &
         & 'against rigid tools at the nodes in both.')
      call number(table, 'POSITION TOLERANCE', '', 'Ties what is nearer than this, or than '// &
         & 'half a slave facet [length].')
      call choice(table, 'ADJUST', 'YES,NO', 'YES', 'Accepted: gaps are bridged without strain '// &
         & 'either way.')
      call bare_value(table, 'YES')
      call flag(table, 'NO ROTATION', 'Solids have no rotations; accepted.')
      call flag(table, 'NO THICKNESS', 'Shell thickness does not count; accepted.')
      call later_flag(table, 'CYCLIC SYMMETRY', 'Sectors.')
      call data_line(table, 'slave surface, master surface', 'One pair a line.')
      call example(table, '*TIE, NAME=GLUE|LINING, BODY')
      call about(table, 'D.3')

      call key(table, 'CLEARANCE', 'MA', 'both', 'Replaces every initial gap of a pair by one '// &
         & 'value.')
      call word(table, 'SLAVE', 'Slave surface of the pair.')
      call known_as(table, 'SECONDARY')
      call required(table)
      call word(table, 'MASTER', 'Master surface of the pair.')
      call known_as(table, 'MAIN')
      call required(table)
      call number(table, 'VALUE', '', 'Gap: positive is open, negative an overclosure [length].')
      call required(table)
      call later_flag(table, 'TABULAR', 'A gap for each node.')
      call later_flag(table, 'BOLT', 'Threads.')
      call example(table, '*CLEARANCE, SLAVE=TOP, MASTER=PUNCH, VALUE=0.')
   end subroutine add_tie

   subroutine add_interaction(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'SURFACE INTERACTION', 'M', 'both', &
         & 'Opens the description of a contact: *SURFACE BEHAVIOR and *FRICTION follow.')
      call word(table, 'NAME', 'Name that *CONTACT PAIR refers to.')
      call required(table)
      call data_line(table, 'thickness [length] = 1', 'Out of plane, as the section has it; '// &
         & 'read past.')
      call example(table, '*SURFACE INTERACTION, NAME=SMOOTH|*SURFACE BEHAVIOR, AUGMENTED '// &
         & 'LAGRANGE|1.e5')

      call key(table, 'SURFACE BEHAVIOR', 'MS', 'both', &
         & 'How surfaces are kept from passing through each other: one of the four methods.')
      call under(table, 'SURFACE INTERACTION,CHANGE SURFACE BEHAVIOR')
      call flag(table, 'DIRECT', 'Lagrange multipliers: no penetration. The default.')
      call choice(table, 'PENALTY', 'LINEAR', 'LINEAR', 'Pressure is a slope times the '// &
         & 'penetration.')
      call bare_value(table, 'LINEAR')
      call refuses(table, 'NONLINEAR')
      call flag(table, 'AUGMENTED LAGRANGE', 'Penalty with multipliers that take the load '// &
         & 'over pass by pass.')
      call flag(table, 'PERTURBED LAGRANGE', 'Multipliers with a compliance; condensed, it is '// &
         & 'the penalty method.')
      call flag(table, 'NO SEPARATION', 'Surfaces that touch stay together; they may slide.')
      call choice(table, 'PRESSURE-OVERCLOSURE', 'HARD,LINEAR,EXPONENTIAL,TABULAR,TIED', 'HARD', &
         & 'Law between pressure and penetration.')
      call refuses(table, 'TRUNCATED EXPONENTIAL,SCALE FACTOR')
      call data_line(table, 'slope [stress/length], clearance [length] = 0, scale = 1', &
         & 'PENALTY, AUGMENTED LAGRANGE, PERTURBED LAGRANGE, LINEAR, TIED: without a slope it '// &
         & 'is chosen from the elements behind the surface and printed.')
      call data_line(table, 'c0 [length], p0 [stress]', 'EXPONENTIAL: pressure p0 at gap 0, '// &
         & 'none at gap c0.')
      call data_line(table, 'pressure [stress], overclosure [length]', &
         & 'TABULAR: one point a line, increasing.')
      call example(table, '*SURFACE INTERACTION, NAME=SMOOTH|*SURFACE BEHAVIOR, PENALTY|1.e6')
      call about(table, 'D, J')
   end subroutine add_interaction

   subroutine add_controls(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'CONTACT CONTROLS', 'MS', 'both', &
         & 'Tolerances of contact: for one pair with SLAVE and MASTER, else for all.')
      call word(table, 'SLAVE', 'Slave surface of the pair.')
      call known_as(table, 'SECONDARY')
      call word(table, 'MASTER', 'Master surface of the pair.')
      call known_as(table, 'MAIN')
      call number(table, 'RELATIVE PENETRATION TOLERANCE', '0.001', &
         & 'AUGMENTED LAGRANGE: penetration allowed, fraction of a facet.')
      call number(table, 'ABSOLUTE PENETRATION TOLERANCE', '', &
         & 'AUGMENTED LAGRANGE: penetration allowed [length].')
      call whole(table, 'MAX AUGMENTATIONS', '50', 'AUGMENTED LAGRANGE: most passes of an '// &
         & 'increment.')
      call choice(table, 'INITIAL', 'AUTOMATIC,ERROR,INTERFERENCE,ADJUST', 'AUTOMATIC', &
         & 'What an initial overclosure is. AUTOMATIC: below a thousandth of an element it is '// &
         & 'adjusted, else it is an interference, resolved in the first step.')
      call later_flag(table, 'STABILIZE', 'Holds bodies that only contact will hold.')
      call later_flag(table, 'AUTOMATIC TOLERANCES', 'Tolerances that relax.')
      call later_flag(table, 'STIFFNESS SCALE FACTOR', 'Factor on the slope: write it in '// &
         & '*SURFACE BEHAVIOR.')
      call flag(table, 'RESET', 'Back to the defaults.')
      call example(table, '*CONTACT CONTROLS, RELATIVE PENETRATION TOLERANCE=1.e-4, MAX '// &
         & 'AUGMENTATIONS=80')
      call about(table, 'J')
   end subroutine add_controls
end module lopin_keyword_rows_contact
