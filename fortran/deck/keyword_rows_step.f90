!> Rows of the keyword table: steps, boundary conditions, loads, controls of the run, output.
module lopin_keyword_rows_step
   use lopin_solver_factory, only : solver_words
   use lopin_text, only : upper, join
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, number, whole, choice, &
      & ignored_flag, later_flag, required, known_as, refuses, replaces, missing_means, data_line, &
      & free_text, reported, example, under, about, bare_value
   implicit none
   private
   public :: add_step_rows

contains

   !> Steps, loads, outputs and choices of the run.
   subroutine add_step_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_steps(table)
      call add_conditions(table)
      call add_loads(table)
      call add_run(table)
      call add_prints(table)
      call add_outputs(table)
   end subroutine add_step_rows

   subroutine add_steps(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'STEP', 'M', 'both', 'Opens a step: a stretch of the history of loads.')
      call word(table, 'NAME', 'Name of the step.')
      call choice(table, 'NLGEOM', 'YES,NO', 'NO', 'Finite rotation, strain and sliding; once '// &
         & 'on, it stays on in later steps.')
      call bare_value(table, 'YES')
      call missing_means(table, 'Without it the step would be small-strain.')
      call whole(table, 'INC', '100', 'Most increments.')
      call missing_means(table, 'Without it the step would stop after 100 increments.')
      call choice(table, 'AMPLITUDE', 'RAMP,STEP', 'RAMP', 'Loads grow with the time of the '// &
         & 'step, or act at once.')
      call later_flag(table, 'PERTURBATION', 'Linear perturbation about a state.')
      call ignored_flag(table, 'UNSYMM', 'Lopin stores what it needs.')
      call ignored_flag(table, 'EXTRAPOLATION', 'First guess of an increment.')
      call ignored_flag(table, 'CONVERT SDI', 'Counting of iterations in Abaqus.')
      call ignored_flag(table, 'SOLVER', 'Write SOLVER in *STATIC.')
      call free_text(table)
      call data_line(table, 'title', 'Any number of lines.')
      call example(table, '*STEP, NAME=PRESS, INC=50|*STATIC|0.1, 1.|*END STEP')

      call key(table, 'STATIC', 'S', 'both', 'The step is static; its increments.')
      call flag(table, 'DIRECT', &
         & 'Increments are all the initial one, but for those that end at a '// &
         & 'point of an amplitude.')
      call choice(table, 'SOLVER', upper('auto,'//join(solver_words, ',')), 'AUTO', &
         & 'Solver of linear systems.')
      call replaces(table, 'SPOOLES,PARDISO,PASTIX,ITERATIVE SCALING,ITERATIVE CHOLESKY')
      call refuses(table, 'KLU,SPQR,MUMPS,PETSC')
      call later_flag(table, 'STABILIZE', 'Viscous stabilisation.')
      call later_flag(table, 'ALLSDTOL', 'Viscous stabilisation.')
      call later_flag(table, 'CONTINUE', 'Viscous stabilisation.')
      call later_flag(table, 'FULLY PLASTIC', 'The step ends where a set flows.')
      call later_flag(table, 'ADIABATIC', 'Heat of plastic work.')
      call later_flag(table, 'RIKS', 'Arc length.')
      call later_flag(table, 'TIME RESET', 'Times of CalculiX.')
      call later_flag(table, 'TOTAL TIME AT START', 'Times of CalculiX.')
      call data_line(table, 'initial [time] = 1, period [time] = 1, smallest [time], largest '// &
         & '[time]', &
         & 'One line; smallest: a millionth of the period unless given.')
      call example(table, '*STATIC|0.1, 1., 1.e-4, 0.2')

      call key(table, 'RESTART', 'MS', 'both', 'How often the state of the run is kept for '// &
         & '--resume; from this step on.')
      call flag(table, 'WRITE', 'Keep it; without the card it is kept too.')
      call whole(table, 'FREQUENCY', '1', 'After every so many increments and each step; 0: '// &
         & 'only where the run is interrupted.')
      call ignored_flag(table, 'OVERLAY', 'There is one checkpoint, the last.')
      call ignored_flag(table, 'NUMBER INTERVAL', 'Write FREQUENCY.')
      call ignored_flag(table, 'TIME MARKS', 'Times of checkpoints.')
      call later_flag(table, 'READ', 'Another deck that goes on from a checkpoint.')
      call later_flag(table, 'STEP', 'Another deck that goes on from a checkpoint.')
      call later_flag(table, 'INC', 'Another deck that goes on from a checkpoint.')
      call example(table, '*STEP|*STATIC|0.01, 1.|*RESTART, WRITE, FREQUENCY=10|*END STEP')

      call key(table, 'END STEP', 'S', 'both', 'Closes *STEP.')
      call example(table, '*STEP|*STATIC|*END STEP')
   end subroutine add_steps

   subroutine add_conditions(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'BOUNDARY', 'MS', 'both', &
         & 'Prescribed displacements; dofs 1 to 3 are translations, 4 to 6 rotations of a '// &
         & 'reference node.')
      call choice(table, 'OP', 'MOD,NEW', 'MOD', 'NEW removes what the model part and earlier '// &
         & 'steps prescribe; the card may be empty.')
      call word(table, 'AMPLITUDE', 'Name of an *AMPLITUDE.')
      call flag(table, 'FIXED', 'Hold the values reached at the end of the step before.')
      call choice(table, 'TYPE', 'DISPLACEMENT,VELOCITY', 'DISPLACEMENT', 'What is prescribed; '// &
         & 'a velocity goes on from where the step finds the dof.')
      call refuses(table, 'ACCELERATION')
      call later_flag(table, 'USER', 'Subroutine of the user.')
      call later_flag(table, 'SUBMODEL', 'Motions of another run.')
      call later_flag(table, 'LOAD CASE', 'Cases of load.')
      call data_line(table, 'node or node set, first dof, last dof, value [length] = 0', &
         & 'last dof: the first unless given.')
      call data_line(table, 'node or node set, word', &
         & 'ENCASTRE, PINNED, XSYMM, YSYMM, ZSYMM, XASYMM, YASYMM, ZASYMM.')
      call example(table, '*BOUNDARY|BOTTOM, 2|PREF, 2, 2, -0.5')
      call about(table, 'F')

      call key(table, 'AMPLITUDE', 'MS', 'both', 'A factor as a function of time, linear '// &
         & 'between points.')
      call word(table, 'NAME', 'Name of the amplitude.')
      call required(table)
      call choice(table, 'TIME', 'STEP TIME,TOTAL TIME', 'STEP TIME', 'Which time the points mean.')
      call choice(table, 'VALUE', 'RELATIVE,ABSOLUTE', 'RELATIVE', &
         & 'Factor of the load, or the load itself.')
      call choice(table, 'DEFINITION', 'TABULAR', 'TABULAR', 'How the function is given.')
      call refuses(table, 'SMOOTH STEP,PERIODIC,EQUALLY SPACED,DECAY,MODULATED,USER')
      call later_flag(table, 'SMOOTH', 'Rounded corners.')
      call later_flag(table, 'SHIFTX', 'Shift of the times.')
      call later_flag(table, 'SHIFTY', 'Shift of the values.')
      call data_line(table, 'time [time], value, ...', 'Pairs; several on a line, several lines.')
      call example(table, '*AMPLITUDE, NAME=UPDOWN|0., 0., 0.5, 1., 1., 0.')
   end subroutine add_conditions

   subroutine add_loads(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'CLOAD', 'S', 'both', &
         & 'Forces on nodes; axisymmetric: of the full circumference.')
      call choice(table, 'OP', 'MOD,NEW', 'MOD', 'NEW removes those of earlier steps; within a '// &
         & 'step all cards add up. The card may be empty.')
      call word(table, 'AMPLITUDE', 'Name of an *AMPLITUDE.')
      call later_flag(table, 'FOLLOWER', 'Force that turns with the node.')
      call data_line(table, 'node or node set, dof, value [force]', 'One load a line.')
      call example(table, '*CLOAD|PREF, 2, -2000.')
      call about(table, 'F')

      call key(table, 'DLOAD', 'S', 'both', 'Loads on elements: pressure on faces, body '// &
         & 'forces, gravity.')
      call choice(table, 'OP', 'MOD,NEW', 'MOD', 'NEW removes those of earlier steps; within a '// &
         & 'step all cards add up. The card may be empty.')
      call word(table, 'AMPLITUDE', 'Name of an *AMPLITUDE.')
      call data_line(table, 'element or element set, face, pressure [stress]', &
         & 'P1 to P6: pressure on face S1 to S6, positive into the element; it follows the '// &
         & 'face under NLGEOM.')
      call data_line(table, 'element or element set, direction, force [force/length^3]', &
         & 'BX, BY, BZ.')
      call data_line(table, 'element or element set, GRAV, value [acceleration], x, y, z', &
         & 'Gravity along (x, y, z); needs *DENSITY.')
      call data_line(table, 'element or element set, CENTRIF, omega^2, x, y, z, nx, ny, nz', &
         & 'Comes with a later version.')
      call example(table, '*DLOAD|TOP_ROW, P3, 12.')
      call about(table, 'F')

      call key(table, 'DSLOAD', 'S', 'abaqus', 'Loads on surfaces.')
      call choice(table, 'OP', 'MOD,NEW', 'MOD', 'NEW removes those of earlier steps; within a '// &
         & 'step all cards add up. The card may be empty.')
      call word(table, 'AMPLITUDE', 'Name of an *AMPLITUDE.')
      call choice(table, 'FOLLOWER', 'NO', 'NO', 'Whether the direction turns with the surface.')
      call bare_value(table, 'YES')
      call refuses(table, 'YES')
      call data_line(table, 'surface, P, pressure [stress]', 'Pressure, positive into the '// &
         & 'body; it follows the surface under NLGEOM.')
      call data_line(table, 'surface, TRVEC, traction [stress], x, y, z', &
         & 'Traction along (x, y, z).')
      call example(table, '*DSLOAD|TOP, P, 12.')
      call about(table, 'F')
   end subroutine add_loads

   subroutine add_run(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'LOPIN', 'M', 'lopin', &
         & 'Choices that other codes do not have; an export drops the card with a note.')
      call reported(table)
      call choice(table, 'PATH', 'AUTO,CONDENSED,NEWTON,FINITE', 'AUTO', &
         & 'CONDENSED: the contact problem is reduced to the contact dofs by one '// &
         & 'factorisation; NEWTON: the whole system in every iteration; FINITE: '// &
         & 'Newton on the present shape, sliding without limit; AUTO: the cheaper '// &
         & 'one, printed.')
      call choice(table, 'SOLVER', upper('auto,'//join(solver_words, ',')), 'AUTO', &
         & 'Solver of linear systems.')
      call number(table, 'TARGET ERROR', '0.01', 'Relative error that QUANTITY may have; '// &
         & 'without it, of pressure, that an automatic slope aims at.')
      call choice(table, 'QUANTITY', &
         & 'PRESSURE,PEAK PRESSURE,FORCE,PEAK FORCE,DISPLACEMENT,SPRINGBACK', '', &
         & 'What is to be known as well as TARGET ERROR says: the command of the Python '// &
         & 'package refines the mesh and the increments until it is. PRESSURE: in the mean '// &
         & 'over the slave surfaces; FORCE: on SET, or of all contact, at the end; PEAK '// &
         & 'FORCE: the largest over the run; DISPLACEMENT: mean over '// &
         & 'SET; SPRINGBACK: what the last step adds to it.')
      call word(table, 'SET', 'Node set or label that QUANTITY is asked of.')
      call whole(table, 'COMPONENT', '0', 'Direction of QUANTITY, 1 to 3; 0: its length.')
      call whole(table, 'CONTINUATION', '1', 'Number of growing penalties tried one after the '// &
         & 'other.')
      call whole(table, 'MORTAR DEGREE', '5', 'Degree to which the cells of '// &
         & 'surface-to-surface pairs in space are integrated, 5 to 40: 5 is exact on '// &
         & 'triangles and parallelograms, 1e-6 on distorted faces; 12 is 1e-12 there.')
      call example(table, '*LOPIN, QUANTITY=FORCE, TARGET ERROR=0.02')
      call about(table, 'J')
   end subroutine add_run

   !> The output family of CalculiX.
   subroutine add_prints(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'NODE PRINT', 'S', 'both', 'Table of node values in the .dat file.')
      call add_print_words(table)
      call word(table, 'NSET', 'The nodes.')
      call choice(table, 'TOTALS', 'NO,YES,ONLY', 'NO', 'Sum over the set: after the table, '// &
         & 'or alone.')
      call data_line(table, 'variable, ...', 'U, RF.')
      call example(table, '*NODE PRINT, NSET=PREF, TOTALS=ONLY|RF')

      call key(table, 'EL PRINT', 'S', 'both', 'Table of values at integration points in the '// &
         & '.dat file.')
      call add_print_words(table)
      call word(table, 'ELSET', 'The elements.')
      call choice(table, 'TOTALS', 'NO,YES,ONLY', 'NO', 'Sum over the set.')
      call ignored_flag(table, 'POSITION', 'Values are those of the integration points.')
      call data_line(table, 'variable, ...', 'S, E.')
      call example(table, '*EL PRINT, ELSET=TOP_ROW|S')

      call key(table, 'CONTACT PRINT', 'S', 'both', 'Table of contact values in the .dat file.')
      call add_print_words(table)
      call word(table, 'SLAVE', 'Slave surface of the pair.')
      call known_as(table, 'SECONDARY')
      call word(table, 'MASTER', 'Master surface of the pair.')
      call known_as(table, 'MAIN')
      call word(table, 'NSET', 'Only these nodes.')
      call known_as(table, 'SET')
      call choice(table, 'TOTALS', 'NO,YES,ONLY', 'NO', 'Sum over the pair.')
      call data_line(table, 'variable, ...', &
         & 'CDIS (signed gap), CSTR (pressure and shear), CF, CFN, CFS (forces), CPRESS, '// &
         & 'COPEN, CNORMF.')
      call example(table, '*CONTACT PRINT, SLAVE=TOP, MASTER=PUNCH|CDIS, CSTR')

      call key(table, 'NODE FILE', 'S', 'both', 'Node values in the result files.')
      call add_print_words(table)
      call word(table, 'NSET', 'The nodes; the result files hold all nodes.')
      call data_line(table, 'variable, ...', 'U, RF.')
      call example(table, '*NODE FILE|U, RF')

      call key(table, 'EL FILE', 'S', 'both', 'Element values, averaged at nodes, in the '// &
         & 'result files.')
      call add_print_words(table)
      call word(table, 'ELSET', 'The elements; the result files hold all elements.')
      call ignored_flag(table, 'POSITION', 'Values are those averaged at nodes.')
      call data_line(table, 'variable, ...', 'S, E, PEEQ; others are noted and left out.')
      call example(table, '*EL FILE|S, E, PEEQ')

      call key(table, 'CONTACT FILE', 'S', 'both', 'Contact values in the result files.')
      call add_print_words(table)
      call word(table, 'NSET', 'The nodes; the result files hold all slave nodes.')
      call word(table, 'SLAVE', 'Slave surface of the pair.')
      call known_as(table, 'SECONDARY')
      call word(table, 'MASTER', 'Master surface of the pair.')
      call known_as(table, 'MAIN')
      call data_line(table, 'variable, ...', 'CDIS (signed gap), CSTR (pressure and shear).')
      call example(table, '*CONTACT FILE|CDIS, CSTR')
   end subroutine add_prints

   !> What the cards of the print and file family have in common.
   subroutine add_print_words(table)
      type(keyword_table_type), intent(inout) :: table

      call whole(table, 'FREQUENCY', '1', 'Every so many increments; 0: never. The last one '// &
         & 'is always written.')
      call choice(table, 'GLOBAL', 'YES,NO', '', 'NO, the default of *NODE PRINT: in the axes '// &
         & 'of *TRANSFORM. Result files are in global axes.')
      call bare_value(table, 'YES')
      call ignored_flag(table, 'OUTPUT', '2D or 3D.')
      call ignored_flag(table, 'LAST ITERATIONS', 'Iterations of CalculiX.')
      call ignored_flag(table, 'CONTACT ELEMENTS', 'Contact elements of CalculiX.')
      call known_as(table, 'CONTACT ELEMENT')
      call ignored_flag(table, 'SUMMARY', 'Extremes of a table.')
      call ignored_flag(table, 'TIME POINTS', 'Chosen times: results are at increments.')
   end subroutine add_print_words

   !> The output family of Abaqus.
   subroutine add_outputs(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'OUTPUT', 'S', 'both', 'Opens a request: *NODE OUTPUT, *ELEMENT OUTPUT, '// &
         & '*CONTACT OUTPUT follow.')
      call flag(table, 'FIELD', 'Fields for the result files.')
      call flag(table, 'HISTORY', 'Curves for the history file.')
      call choice(table, 'VARIABLE', 'PRESELECT,ALL', '', 'A usual choice of variables, or all.')
      call whole(table, 'FREQUENCY', '1', 'Every so many increments.')
      call choice(table, 'OP', 'NEW,ADD,REPLACE', 'NEW', 'Accepted; every step has its own '// &
         & 'requests.')
      call ignored_flag(table, 'NUMBER INTERVAL', 'Output follows the increments.')
      call ignored_flag(table, 'TIME INTERVAL', 'Output follows the increments.')
      call ignored_flag(table, 'TIME MARKS', 'Output follows the increments.')
      call ignored_flag(table, 'NAME', 'Name of the request.')
      call later_flag(table, 'TIME POINTS', 'Chosen times.')
      call example(table, '*OUTPUT, FIELD, VARIABLE=PRESELECT')

      call key(table, 'NODE OUTPUT', 'S', 'both', 'Node variables of the *OUTPUT above.')
      call under(table, 'OUTPUT')
      call add_output_words(table)
      call word(table, 'NSET', 'The nodes.')
      call data_line(table, 'variable, ...', 'U, RF.')
      call example(table, '*OUTPUT, HISTORY|*NODE OUTPUT, NSET=PREF|U, RF')

      call key(table, 'ELEMENT OUTPUT', 'S', 'both', 'Element variables of the *OUTPUT above.')
      call under(table, 'OUTPUT')
      call add_output_words(table)
      call word(table, 'ELSET', 'The elements.')
      call ignored_flag(table, 'DIRECTIONS', 'Axes of the elements.')
      call ignored_flag(table, 'POSITION', 'Where the values are taken.')
      call data_line(table, 'variable, ...', 'S, E; others are noted and left out.')
      call example(table, '*OUTPUT, FIELD|*ELEMENT OUTPUT|S, E')

      call key(table, 'CONTACT OUTPUT', 'S', 'both', 'Contact variables of the *OUTPUT above.')
      call under(table, 'OUTPUT')
      call add_output_words(table)
      call word(table, 'SLAVE', 'Slave surface of the pair.')
      call known_as(table, 'SECONDARY')
      call word(table, 'MASTER', 'Master surface of the pair.')
      call known_as(table, 'MAIN')
      call word(table, 'NSET', 'Only these nodes.')
      call data_line(table, 'variable, ...', 'CPRESS, COPEN, CNORMF, CSTATUS, CFN.')
      call example(table, '*OUTPUT, FIELD|*CONTACT OUTPUT|CPRESS, COPEN')
   end subroutine add_outputs

   subroutine add_output_words(table)
      type(keyword_table_type), intent(inout) :: table
      call choice(table, 'VARIABLE', 'PRESELECT,ALL', '', 'A usual choice of variables, or all.')
   end subroutine add_output_words
end module lopin_keyword_rows_step
