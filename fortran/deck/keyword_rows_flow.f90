!> Rows of the keyword table about materials that flow or expand, and their state at the start.
module lopin_keyword_rows_flow
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, number, whole, choice, &
      & later_flag, ignored_flag, required, refuses, data_line, example, under, about
   implicit none
   private
   public :: add_flow_rows

contains

   !> Metals that flow, and heat.
   subroutine add_flow_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_plastic(table)
      call add_viscous(table)
      call add_damage(table)
      call add_heat(table)
      call add_remeshing(table)
   end subroutine add_flow_rows

   subroutine add_plastic(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'PLASTIC', 'M', 'both', 'Flow curve of plasticity, of von Mises unless '// &
         & '*POTENTIAL gives another surface; laws of friction read the flow stress at the slave.')
      call under(table, 'MATERIAL')
      call choice(table, 'HARDENING', 'ISOTROPIC,SWIFT,VOCE,HOLLOMON,LINEAR,KINEMATIC,COMBINED', &
         & 'ISOTROPIC', &
         & 'ISOTROPIC: a table; SWIFT: K (e0 + e)^n; VOCE: S - (S - Y) exp(-d e) + H e; '// &
         & 'HOLLOMON: K (e0 + e)^n with e0 = (Y/K)^(1/n), the strain that K e^n gives the '// &
         & 'yield stress: e0 stays, so that the sum is the total strain at yield and falls '// &
         & 'short of it by the elastic strain that hardening adds; LINEAR: Y + H e. e is the '// &
         & 'accumulated plastic strain. KINEMATIC: the '// &
         & 'surface moves along a straight line; COMBINED: it moves as Armstrong, Frederick '// &
         & 'and Chaboche say, and may grow by *CYCLIC HARDENING.')
      call refuses(table, 'JOHNSON COOK,USER')
      call choice(table, 'DATA TYPE', 'PARAMETERS', '', 'COMBINED: constants.')
      call refuses(table, 'HALF CYCLE,STABILIZED')
      call whole(table, 'NUMBER BACKSTRESSES', '1', &
         & 'COMBINED: pairs of C and gamma; as many as '// &
         & 'the line has.')
      call choice(table, 'ONLY', 'FRICTION', '', 'FRICTION: the body stays elastic, and only '// &
         & 'laws of friction read the flow stress at plastic strain 0.')
      call later_flag(table, 'RATE', 'Rate of the table.')
      call data_line(table, 'yield stress [stress], plastic strain = 0, temperature', &
         & 'ISOTROPIC: true stress against logarithmic plastic strain; strains increase from '// &
         & '0, and the stress stays that of the last line beyond it. Tables of several '// &
         & 'temperatures follow each other, the coldest first; stresses go linearly from one '// &
         & 'to the next.')
      call data_line(table, 'K [stress], e0, n', 'SWIFT: one line.')
      call data_line(table, 'S [stress], Y [stress], d, H [stress] = 0', 'VOCE: one line; '// &
         & 'saturation, yield stress, decay, last slope.')
      call data_line(table, 'K [stress], n, Y [stress]', 'HOLLOMON: one line; without Y the '// &
         & 'curve begins where it leaves the line of Young''s modulus.')
      call data_line(table, 'Y [stress], H [stress] = 0', 'LINEAR: one line.')
      call data_line(table, 'yield stress [stress], plastic strain = 0', &
         & 'KINEMATIC: two lines, '// &
         & 'the first at plastic strain 0.')
      call data_line(table, 'yield stress [stress], C1 [stress], gamma1, ...', &
         & 'COMBINED: parts '// &
         & 'of the backstress, d alpha = C (s - alpha)/Y de - gamma alpha de.')
      call example(table, '*MATERIAL, NAME=DC04|*ELASTIC|210000., 0.3|*PLASTIC|180., 0.|320., 0.2')
      call about(table, 'E')
      call add_yield(table)
   end subroutine add_plastic

   subroutine add_yield(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'CYCLIC HARDENING', 'M', 'both', 'How the yield surface of *PLASTIC, '// &
         & 'HARDENING=COMBINED grows.')
      call under(table, 'MATERIAL')
      call flag(table, 'PARAMETERS', 'Y + Q (1 - exp(-b e)) in the place of a table.')
      call data_line(table, 'yield stress [stress], plastic strain = 0, temperature', &
         & 'A table as '// &
         & 'that of *PLASTIC.')
      call data_line(table, 'Y [stress], Q [stress], b', 'PARAMETERS: one line.')
      call example(table, '*MATERIAL, NAME=STEEL|*ELASTIC|210000., 0.3|*PLASTIC, '// &
         & 'HARDENING=COMBINED, DATA TYPE=PARAMETERS|200., 20000., 150.|*CYCLIC HARDENING, '// &
         & 'PARAMETERS|200., 80., 5.')
      call about(table, 'E')

      call key(table, 'POTENTIAL', 'M', 'both', 'Yield surface of Hill, 1948, on the axes of '// &
         & '*SOLID SECTION, ORIENTATION=.')
      call under(table, 'MATERIAL')
      call choice(table, 'TYPE', 'HILL', 'HILL', 'Kind of surface.')
      call refuses(table, 'BARLAT,BARLAT91,HOSFORD,TSAI-WU')
      call choice(table, 'DEFINITION', 'RATIOS,LANKFORD', 'RATIOS', 'RATIOS: yield stresses by '// &
         & 'the flow stress, as in Abaqus; LANKFORD, a word of Lopin: r of a sheet whose '// &
         & 'normal is axis 3, with the flow curve of tension along axis 1.')
      call data_line(table, 'R11, R22, R33, R12, R13, R23', 'RATIOS: one line, each above 0.')
      call data_line(table, 'r0, r45, r90', 'LANKFORD: one line, each above 0.')
      call example(table, '*MATERIAL, NAME=DC04|*ELASTIC|210000., 0.3|*PLASTIC|180., 0.|320., '// &
         & '0.2|*POTENTIAL, DEFINITION=LANKFORD|1.8, 1.3, 2.1')
      call about(table, 'E')
   end subroutine add_yield

   subroutine add_viscous(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'RATE DEPENDENT', 'M', 'both', 'Flow stress that grows with the rate of '// &
         & 'plastic strain: factor 1 + (rate/D)^(1/p) on the curve of *PLASTIC (Cowper and '// &
         & 'Symonds). Needs steps with a period.')
      call under(table, 'MATERIAL')
      call choice(table, 'TYPE', 'POWER LAW', 'POWER LAW', 'Kind of dependence.')
      call refuses(table, 'YIELD RATIO,JOHNSON COOK')
      call data_line(table, 'D [1/time], p', 'One line.')
      call example(table, '*MATERIAL, NAME=DC04|*ELASTIC|210000., 0.3|*PLASTIC|180., 0.|320., '// &
         & '0.2|*RATE DEPENDENT|40., 5.')
      call about(table, 'G')

      call key(table, 'VISCOPLASTIC', 'M', 'lopin', 'Viscoplastic flow of Norton and Hoff: the '// &
         & 'flow stress is K sqrt(3)^(m+1) rate^m in uniaxial tension. With *PLASTIC it is '// &
         & 'added to that curve, which becomes a threshold. Needs steps with a period.')
      call under(table, 'MATERIAL')
      call choice(table, 'LAW', 'NORTON-HOFF', 'NORTON-HOFF', 'Kind of viscosity.')
      call flag(table, 'RIGID', 'No elastic deviator: all of the strain is flow, and the '// &
         & 'volume is kept. *ELASTIC is not needed; where it stands, its bulk modulus is taken.')
      call data_line(table, 'K [stress time^m], m', 'One line; m between 0 and 1.')
      call example(table, '*MATERIAL, NAME=HOT STEEL|*VISCOPLASTIC, LAW=NORTON-HOFF, '// &
         & 'RIGID|100., 0.2')
      call about(table, 'G')
   end subroutine add_viscous

   subroutine add_damage(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'DAMAGE', 'M', 'lopin', 'A criterion of ductile damage, the integral '// &
         & 'of f over plastic strain; it is counted and nothing depends on it. With s1 the '// &
         & 'largest principal, sm the mean, q von Mises'' stress: COCKCROFT-LATHAM <s1>/q; '// &
         & 'OYANE <1 + A sm/q>; RICE-TRACEY exp(c sm/q); LEMAITRE 2/3 (1 + nu) + 3 (1 - 2 nu) '// &
         & '(sm/q)^2, none where sm/q <= -1/3. One card a criterion.')
      call under(table, 'MATERIAL')
      call choice(table, 'CRITERION', 'COCKCROFT-LATHAM,OYANE,RICE-TRACEY,LEMAITRE', '', &
         & 'Which one.')
      call required(table)
      call number(table, 'WIDTH', '0', 'Length over which means are taken, in the present '// &
         & 'shape [length]: values at points grow as cells shrink, means do not.')
      call number(table, 'CRITICAL', '0', 'Mean in an element at which its metal separates: it '// &
         & 'is taken out. With *REMESH, by the command of the Python package.')
      call data_line(table, 'A [-]', 'OYANE: its A; RICE-TRACEY: its c, 1.5 without the line.')
      call example(table, '*MATERIAL, NAME=SHEET|*ELASTIC|210000., 0.3|*PLASTIC|180., 0.|320., '// &
         & '0.2|*DAMAGE, CRITERION=OYANE, WIDTH=0.05|3.9')
   end subroutine add_damage

   subroutine add_heat(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'EXPANSION', 'M', 'both', 'Thermal expansion: strain alpha (T - T0) in '// &
         & 'every direction, T from *TEMPERATURE, T0 from *INITIAL CONDITIONS; logarithmic '// &
         & 'under NLGEOM.')
      call under(table, 'MATERIAL')
      call choice(table, 'TYPE', 'ISO', 'ISO', 'Kind of expansion.')
      call refuses(table, 'ORTHO,ANISO')
      call ignored_flag(table, 'ZERO', 'Temperature at which a coefficient that varies is '// &
         & 'counted from; a constant one does not read it.')
      call data_line(table, 'alpha [1/temperature], temperature', 'One line; a temperature is '// &
         & 'read past.')
      call example(table, '*MATERIAL, NAME=STEEL|*ELASTIC|210000., 0.3|*EXPANSION|1.2e-5')

      call key(table, 'INITIAL CONDITIONS', 'M', 'both', 'State before the first step.')
      call choice(table, 'TYPE', 'TEMPERATURE,STRESS,HARDENING,STATE,MEMORY,TRACTION', '', &
         & 'TEMPERATURE of nodes, where nothing is strained; STRESS in elements, which need '// &
         & 'not be in balance; HARDENING: plastic strain of an operation before; STATE: all '// &
         & 'that a point remembers, as an earlier run gives it on the present shape (NLGEOM); '// &
         & 'MEMORY: the same of a mesh that stays, by *START displaced; '// &
         & 'TRACTION: what slave nodes bear, from which friction goes on.')
      call required(table)
      call refuses(table, 'PLASTIC STRAIN,DISPLACEMENT,VELOCITY,FIELD,PRESSURE,SOLUTION')
      call data_line(table, 'node or set, temperature [temperature]', 'TEMPERATURE: as many '// &
         & 'lines as needed; 0 where none is given.')
      call data_line(table, 'element or set, S11 [stress], S22 = 0, S33 = 0, S12 = 0, S13 = 0, '// &
         & 'S23 = 0', 'STRESS: as many lines as needed.')
      call data_line(table, 'element, point, S11 [stress], S22, S33, S12, S13, S23', &
         & 'STRESS, of one point as CalculiX counts them: eight numbers.')
      call data_line(table, 'element or set, PEEQ [-]', 'HARDENING: as many lines as needed.')
      call data_line(table, 'element or set, point, E11, E22, E33, E12, E13, E23, ln J [-], '// &
         & 'ln V/V0 = 0, PEEQ = 0, flow stress = 0 [stress], plastic work = 0 [stress], '// &
         & 'damage 1 = 0, damage 2 = 0, damage 3 = 0, damage 4 = 0', &
         & 'STATE: point 0 is every one; E the deviator of the elastic logarithmic strain '// &
         & '(tensor components), J its volume ratio, V0 the volume that energies count by; '// &
         & 'flow stress 0: by the curve; damage in the order of the criteria of *DAMAGE.')
      call data_line(table, 'element, point, ln J of stresses of the start [-], V0/V [-], '// &
         & 'damage 1, damage 2, damage 3, damage 4, memory, ...', 'MEMORY: as a run '// &
         & 'with *REMESH writes it for the bodies whose mesh stays.')
      call data_line(table, 'slave surface, master surface, node or set, T1 [stress], T2, '// &
         & 'T3 = 0, slip 1 = 0 [length], slip 2 = 0, slip 3 = 0', 'TRACTION: on the slave; '// &
         & 'the slip is that of laws which are regularised by it, from where it holds no shear.')
      call example(table, '*INITIAL CONDITIONS, TYPE=TEMPERATURE|BODY, 20.')

      call key(table, 'TEMPERATURE', 'S', 'both', 'Temperatures of nodes at the end of the '// &
         & 'step; they go there linearly from those before, or with an amplitude.')
      call choice(table, 'OP', 'MOD,NEW', 'MOD', 'NEW: nodes that are not listed go back to '// &
         & 'their temperature at the start.')
      call word(table, 'AMPLITUDE', 'Amplitude by which the temperatures are multiplied.')
      call later_flag(table, 'FILE', 'Temperatures from another run.')
      call later_flag(table, 'BSTEP', 'Temperatures from another run.')
      call later_flag(table, 'BINC', 'Temperatures from another run.')
      call later_flag(table, 'ESTEP', 'Temperatures from another run.')
      call later_flag(table, 'EINC', 'Temperatures from another run.')
      call data_line(table, 'node or set, temperature [temperature]', 'As many lines as needed.')
      call example(table, '*STEP|*STATIC|*TEMPERATURE|BODY, 120.|*END STEP')
   end subroutine add_heat

   !> Runs in parts, on meshes that are made anew.
   subroutine add_remeshing(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'START', 'M', 'lopin', 'Where a part of a run goes on: in the middle of '// &
         & 'a step, on a mesh in the present shape. Lopin writes it for the parts of a run '// &
         & 'that is remeshed.')
      call whole(table, 'STEP', '1', 'Step that is under way.')
      call number(table, 'BEGUN', '0.', 'Total time where it began [time].')
      call number(table, 'TIME', '0.', 'Time of the step that was reached [time].')
      call number(table, 'REST', '', 'Length of the first increment, at rest; missing: that of '// &
         & 'the next [time].')
      call number(table, 'INCREMENT', '', 'Length of the next increment; missing: the first of '// &
         & '*STATIC [time].')
      call number(table, 'RELEASE', '0.', 'Time over which forces fade that the mesh leaves '// &
         & 'out of balance, as where elements were taken out; 0: they are let go of in the '// &
         & 'increment at rest [time].')
      call number(table, 'SEATING', '0.', 'Time over which slave nodes are pressed out of '// &
         & 'tools that the mesh leaves them inside of; 0: in the increment at rest [time].')
      call data_line(table, 'node or set, dof, displacement, displacement where the step began '// &
         & '= 0, load there = 0', 'What has moved already: tools, and bodies that keep their '// &
         & 'mesh. Their coordinates in the deck are those of the start.')
      call example(table, '*START, TIME=0.02, REST=1e-9, INCREMENT=0.001|DIE_REF, 2, -1.')

      call key(table, 'REMESH', 'M', 'lopin', 'The mesh of a body is made anew while the run '// &
         & 'goes on, its state carried over. Needs the command of the Python package.')
      call word(table, 'ELSET', 'Elements of the body.')
      call required(table)
      call number(table, 'SIZE', '', 'Largest length of element edges; missing: that of the '// &
         & 'first mesh [length].')
      call number(table, 'SMALLEST', '', 'Smallest length; missing: a fifth of SIZE [length].')
      call number(table, 'HAUSDORFF', '', 'Largest distance between the old and the new skin; '// &
         & 'missing: a hundredth of SIZE [length].')
      call number(table, 'GROWTH', '1.3', 'Ratio of the sizes of neighbours.')
      call number(table, 'QUALITY', '0.15', 'Remesh where the worst corner of an element has '// &
         & 'come down to this (1: right angles, equal sides).')
      call number(table, 'PENETRATION', '0.05', 'Remesh where the middle of an edge of the '// &
         & 'skin is this share of its length inside a tool.')
      call number(table, 'STRAIN', '0.5', 'Remesh after this plastic strain.')
      call number(table, 'PERIOD', '', 'Remesh after this time; missing: never for that [time].')
      call whole(table, 'MOST', '50', 'Remeshes of a run.')
      call example(table, '*REMESH, ELSET=BILLET, SIZE=0.5, SMALLEST=0.1')
   end subroutine add_remeshing
end module lopin_keyword_rows_flow
