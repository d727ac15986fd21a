!> Rows of the keyword table: files, mesh, parts, sets, materials, sections, constraints.
module lopin_keyword_rows_model
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, number, choice, &
      & ignored_flag, later_flag, required, refuses, data_line, &
      & free_text, example, under, about
   implicit none
   private
   public :: add_model_rows

contains

   !> What the model consists of.
   subroutine add_model_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_files(table)
      call add_mesh(table)
      call add_parts(table)
      call add_surfaces(table)
      call add_materials(table)
      call add_sections(table)
      call add_constraints(table)
      call add_springs(table)
   end subroutine add_model_rows

   subroutine add_files(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'HEADING', 'M', 'both', 'Title of the run; any number of lines in any '// &
         & 'alphabet.')
      call free_text(table)
      call example(table, '*HEADING|Cylinder on a plane, N mm s')

      call key(table, 'INCLUDE', 'MPAS', 'both', &
         & 'Reads another file in its place; looked for beside this file, then beside the deck.')
      call word(table, 'INPUT', 'Path of the file; quotes are allowed.')
      call required(table)
      call example(table, '*INCLUDE, INPUT=mesh.inp')
   end subroutine add_files

   subroutine add_mesh(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'NODE', 'MPA', 'both', 'Nodes and their coordinates; axisymmetric: x is '// &
         & 'r, y is z.')
      call word(table, 'NSET', 'Node set that the nodes join.')
      call choice(table, 'SYSTEM', 'R', 'R', 'Coordinate system of the data lines: R is Cartesian.')
      call refuses(table, 'C,S')
      call later_flag(table, 'INPUT', 'Read the data lines from another file: use *INCLUDE.')
      call data_line(table, 'node, x [length] = 0, y [length] = 0, z [length] = 0', &
         & 'One node a line.')
      call example(table, '*NODE, NSET=ALL|1, 0., 0.|2, 1., 0.')

      call key(table, 'ELEMENT', 'MPA', 'both', 'Elements of one type; an element may run '// &
         & 'over several lines.')
      call word(table, 'TYPE', 'Element word: CPE4, CPS8, CAX4, C3D8, C3D10, ... ')
      call required(table)
      call word(table, 'ELSET', 'Element set that the elements join.')
      call later_flag(table, 'INPUT', 'Read the data lines from another file: use *INCLUDE.')
      call data_line(table, 'element, node, ...', 'An element and its nodes in the order of '// &
         & 'Abaqus.')
      call example(table, '*ELEMENT, TYPE=CPE4, ELSET=BODY|1, 1, 2, 3, 4')
      call about(table, 'G')

      call key(table, 'NSET', 'MPA', 'both', 'A set of nodes; the same name again appends.')
      call word(table, 'NSET', 'Name of the set.')
      call required(table)
      call add_set_words(table)
      call word(table, 'ELSET', 'Take the nodes of this element set.')
      call ignored_flag(table, 'FREQUENCY', 'Sets have no frequency; CalculiX reads over it.')
      call data_line(table, 'node or node set, ...', 'Members.')
      call data_line(table, 'first, last, increment = 1', 'With GENERATE.')
      call example(table, '*NSET, NSET=BOTTOM, GENERATE|1, 9, 2')

      call key(table, 'ELSET', 'MPA', 'both', 'A set of elements; the same name again appends.')
      call word(table, 'ELSET', 'Name of the set.')
      call required(table)
      call add_set_words(table)
      call data_line(table, 'element or element set, ...', 'Members.')
      call data_line(table, 'first, last, increment = 1', 'With GENERATE.')
      call example(table, '*ELSET, ELSET=TOP_ROW|11, 12, 13')
   end subroutine add_mesh

   !> What *NSET and *ELSET have in common.
   subroutine add_set_words(table)
      type(keyword_table_type), intent(inout) :: table

      call flag(table, 'GENERATE', 'Each data line is first, last, increment.')
      call flag(table, 'UNSORTED', 'Keep the order and repetitions; accepted, no result '// &
         & 'depends on it.')
      call flag(table, 'INTERNAL', 'Mark of Abaqus/CAE for sets that its user did not name; '// &
         & 'accepted.')
      call word(table, 'INSTANCE', 'Numbers and sets of the data lines belong to this instance.')
   end subroutine add_set_words

   subroutine add_parts(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'PART', 'M', 'abaqus', 'Opens a part; its instances place it in the '// &
         & 'assembly.')
      call word(table, 'NAME', 'Name of the part.')
      call required(table)
      call example(table, '*PART, NAME=BLOCK|*NODE|1, 0., 0.|*END PART')

      call key(table, 'END PART', 'P', 'abaqus', 'Closes *PART.')
      call example(table, '*PART, NAME=BLOCK|*END PART')

      call key(table, 'ASSEMBLY', 'M', 'abaqus', 'Opens the assembly of instances.')
      call word(table, 'NAME', 'Name of the assembly.')
      call example(table, '*PART, NAME=BLOCK|*END PART|*ASSEMBLY, NAME=ALL|*INSTANCE, '// &
         & 'NAME=BLOCK-1, PART=BLOCK|*END INSTANCE|*END ASSEMBLY')

      call key(table, 'END ASSEMBLY', 'A', 'abaqus', 'Closes *ASSEMBLY.')
      call example(table, '*ASSEMBLY, NAME=ALL|*END ASSEMBLY')

      call key(table, 'INSTANCE', 'A', 'abaqus', &
         & 'Places a part: its labels become INSTANCE.label, its numbers are renumbered.')
      call word(table, 'NAME', 'Name of the instance.')
      call required(table)
      call word(table, 'PART', 'Name of the part.')
      call required(table)
      call later_flag(table, 'LIBRARY', 'Import from another run.')
      call later_flag(table, 'INSTANCE', 'Import from another run.')
      call data_line(table, 'x [length] = 0, y [length] = 0, z [length] = 0', &
         & 'First line: translation.')
      call data_line(table, 'ax [length], ay [length], az [length], bx [length], by [length], '// &
         & 'bz [length], angle [degree]', 'Second line: rotation about the axis from a to b.')
      call example(table, '*ASSEMBLY, NAME=ALL|*INSTANCE, NAME=BLOCK-1, PART=BLOCK|0., '// &
         & '10.|*END INSTANCE|*END ASSEMBLY')

      call key(table, 'END INSTANCE', 'A', 'abaqus', 'Closes *INSTANCE.')
      call example(table, '*ASSEMBLY, NAME=ALL|*INSTANCE, NAME=BLOCK-1, PART=BLOCK|*END '// &
         & 'INSTANCE|*END ASSEMBLY')
   end subroutine add_parts

   subroutine add_surfaces(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'SURFACE', 'MPA', 'both', &
         & 'A surface for contact or pressure: faces of elements, nodes, or an analytical '// &
         & 'rigid tool.')
      call word(table, 'NAME', 'Name of the surface.')
      call required(table)
      call choice(table, 'TYPE', 'ELEMENT,NODE,SEGMENTS,CYLINDER,REVOLUTION,STL', &
         & 'ELEMENT', &
         & 'SEGMENTS: profile in the plane or in (r, z); CYLINDER: profile swept along local '// &
         & 'z; REVOLUTION: profile turned about local z; STL: triangles of a file.')
      call word(table, 'INPUT', 'STL: the file, binary or in words, beside this one or the deck.')
      call number(table, 'SCALE', '1', 'STL: factor on the lengths of the file.')
      call choice(table, 'SMOOTH', 'YES,NO', 'YES', 'STL: facets that meet at less than 30 '// &
         & 'degrees are curved by the normals of their corners; NO: they stay flat.')
      call flag(table, 'OPEN', 'STL: a sheet, such as the face of a die; without it a surface '// &
         & 'with a hole is refused.')
      call flag(table, 'REPAIR', 'STL: facets that look against the greater area are turned; '// &
         & 'without it they are refused.')
      call number(table, 'FILLET RADIUS', '0', 'Rounds the corners of a profile [length].')
      call flag(table, 'INTERNAL', 'Mark of Abaqus/CAE; accepted.')
      call later_flag(table, 'COMBINE', 'Union, intersection or difference of surfaces.')
      call later_flag(table, 'CROP', 'Part of a surface inside a box.')
      call data_line(table, 'element or element set, face', &
         & 'ELEMENT: faces S1 to S6; SNEG, SPOS of rigid facets; without a face: all free '// &
         & 'faces of the set.')
      call data_line(table, 'node or node set, area [area]', 'NODE: without an area, pressure '// &
         & 'is a force.')
      call data_line(table, 'START, x [length], y [length]', 'Profile: the first point.')
      call data_line(table, 'LINE, x [length], y [length]', &
         & 'Profile: a straight line to a point; the normal is on the left of the way.')
      call data_line(table, 'CIRCL, x [length], y [length], xc [length], yc [length]', &
         & 'Profile: an arc of less than 180 degrees to (x, y) about (xc, yc).')
      call data_line(table, 'PARAB, xm [length], ym [length], x [length], y [length]', &
         & 'Profile: a parabola to (x, y) through (xm, ym), half-way in its parameter.')
      call data_line(table, 'ax [length], ay [length], az [length], bx [length], by [length], '// &
         & 'bz [length]', &
         & 'Local axes before START. CYLINDER: a is the origin, b is on local x. REVOLUTION: '// &
         & 'the axis from a to b.')
      call data_line(table, 'cx [length], cy [length], cz [length]', 'CYLINDER: a second line, '// &
         & 'c on local z, along which the profile is swept; local y = z x x.')
      call data_line(table, 'cx [length], cy [length], cz [length], dx [length], dy [length], '// &
         & 'dz [length]', 'REVOLUTION: a second line, the middles of two sides of a rectangle '// &
         & 'about a: the profile runs around it, r is the distance from it.')
      call example(table, '*SURFACE, NAME=PUNCH, TYPE=SEGMENTS|START, 10., 10.|CIRCL, 0., '// &
         & '0., 0., 10.')
      call about(table, 'H')
   end subroutine add_surfaces

   subroutine add_materials(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'MATERIAL', 'M', 'both', 'Opens a material; *ELASTIC or *HYPERELASTIC, '// &
         & 'and *DENSITY, follow.')
      call word(table, 'NAME', 'Name of the material.')
      call required(table)
      call example(table, '*MATERIAL, NAME=STEEL|*ELASTIC|210000., 0.3')

      call key(table, 'ELASTIC', 'M', 'both', 'Isotropic elasticity: Hooke''s law; under '// &
         & 'NLGEOM between Kirchhoff stress and logarithmic strain (Hencky).')
      call under(table, 'MATERIAL')
      call choice(table, 'TYPE', 'ISOTROPIC,ISO', 'ISOTROPIC', 'Kind of elasticity.')
      call refuses(table, 'ORTHO,ORTHOTROPIC,ENGINEERING CONSTANTS,ANISO,ANISOTROPIC,LAMINA')
      call choice(table, 'STRAIN', 'LOGARITHMIC,GREEN', 'LOGARITHMIC', 'Strain that the law is '// &
         & 'linear in under NLGEOM. GREEN is St Venant-Kirchhoff, as CalculiX has it: softer '// &
         & 'in compression, and without *PLASTIC.')
      call data_line(table, 'Young''s modulus [stress], Poisson''s ratio = 0, temperature', &
         & 'One line; a temperature is read past, there is none in the run.')
      call example(table, '*MATERIAL, NAME=STEEL|*ELASTIC|210000., 0.3')
      call about(table, 'F')

      call add_hyperelastic(table)

      call key(table, 'DENSITY', 'M', 'both', 'Mass density, used by gravity.')
      call under(table, 'MATERIAL')
      call data_line(table, 'density [mass/length^3], temperature', 'One line.')
      call example(table, '*MATERIAL, NAME=STEEL|*DENSITY|7.8e-9')
   end subroutine add_materials

   subroutine add_sections(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'SOLID SECTION', 'MP', 'both', 'Gives a material to an element set.')
      call word(table, 'ELSET', 'The elements.')
      call required(table)
      call word(table, 'MATERIAL', 'Their material.')
      call required(table)
      call word(table, 'CONTROLS', 'Name of a *SECTION CONTROLS.')
      call word(table, 'ORIENTATION', 'Name of an *ORIENTATION: axes of the material, which '// &
         & '*POTENTIAL counts along.')
      call later_flag(table, 'COMPOSITE', 'Layers.')
      call ignored_flag(table, 'OFFSET', 'Plane elements lie in their plane.')
      call data_line(table, 'thickness [length] = 1', 'Plane elements only.')
      call example(table, '*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL|1.,')

      call key(table, 'ORIENTATION', 'MPA', 'both', 'Axes of a material: those of the space '// &
         & 'without it. They turn with the material.')
      call word(table, 'NAME', 'Name that *SOLID SECTION, ORIENTATION= refers to.')
      call required(table)
      call choice(table, 'SYSTEM', 'RECTANGULAR', 'RECTANGULAR', 'Kind of axes.')
      call refuses(table, 'CYLINDRICAL,SPHERICAL,Z RECTANGULAR,USER')
      call choice(table, 'DEFINITION', 'COORDINATES', 'COORDINATES', 'How they are given.')
      call refuses(table, 'NODES,OFFSET TO NODES')
      call data_line(table, 'xa [length], ya [length], za [length], xb [length], yb [length], '// &
         & 'zb [length], xc [length] = 0, yc [length] = 0, zc [length] = 0', 'a on axis 1, b '// &
         & 'in the plane of 1 and 2, c the origin.')
      call data_line(table, 'axis = 3, angle = 0', 'A second line turns the axes about one of '// &
         & 'them [degrees].')
      call example(table, '*ORIENTATION, NAME=ROLLED|1., 0., 0., 0., 1., 0.|3, 45.')
      call about(table, 'E')

      call key(table, 'SECTION CONTROLS', 'MP', 'both', 'Formulation of the elements of a section.')
      call word(table, 'NAME', 'Name that *SOLID SECTION, CONTROLS= refers to.')
      call required(table)
      call choice(table, 'FORMULATION', 'AUTO,FULL', 'AUTO', &
         & 'AUTO: mean dilatation in linear quads and bricks, as in Abaqus, internal modes in '// &
         & 'words with I, patches in linear simplices that keep their volume; FULL: plain full '// &
         & 'integration, as in CalculiX.')
      call choice(table, 'HOURGLASS', 'ENHANCED,STIFFNESS,RELAX STIFFNESS', '', &
         & 'C3D8R of the section has one integration point, and a stiffness in its hourglass '// &
         & 'motions by which a box bends as a beam does; without it C3D8R is integrated fully.')
      call refuses(table, 'VISCOUS,COMBINED')
      call data_line(table, 'factor, ...', 'Factors of Abaqus; read past.')
      call example(table, '*SECTION CONTROLS, NAME=PLAIN, FORMULATION=FULL')
   end subroutine add_sections

   subroutine add_hyperelastic(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'HYPERELASTIC', 'M', 'both', 'Rubber-like elasticity: '// &
         & 'W = C10 (I1bar - 3) + (J - 1)^2/D1. Needs *STEP, NLGEOM.')
      call under(table, 'MATERIAL')
      call flag(table, 'NEO HOOKE', 'The form of the energy; must be there.')
      call later_flag(table, 'MOONEY-RIVLIN', 'Energy of Mooney and Rivlin.')
      call later_flag(table, 'OGDEN', 'Energy of Ogden.')
      call later_flag(table, 'YEOH', 'Energy of Yeoh.')
      call later_flag(table, 'POLYNOMIAL', 'Polynomial energy.')
      call later_flag(table, 'REDUCED POLYNOMIAL', 'Polynomial in the first invariant.')
      call later_flag(table, 'ARRUDA-BOYCE', 'Energy of Arruda and Boyce.')
      call later_flag(table, 'VAN DER WAALS', 'Energy of Kilian.')
      call later_flag(table, 'MARLOW', 'Energy from a test.')
      call later_flag(table, 'N', 'Order of the energy.')
      call later_flag(table, 'TEST DATA INPUT', 'Constants fitted to tests.')
      call later_flag(table, 'USER', 'Energy of a user subroutine.')
      call ignored_flag(table, 'MODULI', 'There is no viscosity in the run.')
      call data_line(table, 'C10 [stress], D1 [1/stress], temperature', 'One line. C10 is half '// &
         & 'the shear modulus, D1 twice the inverse of the bulk modulus and above 0; a '// &
         & 'temperature is read past.')
      call example(table, '*MATERIAL, NAME=RUBBER|*HYPERELASTIC, NEO HOOKE|0.5, 0.04')
      call about(table, 'F')
   end subroutine add_hyperelastic

   !> Springs and gaps between nodes.
   subroutine add_springs(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'SPRING', 'MPA', 'both', 'Springs: elements SPRINGA along the line of '// &
         & 'their two nodes, SPRING1 from a node to the ground, SPRING2 between dofs of two nodes.')
      call word(table, 'ELSET', 'The ELSET of the *ELEMENT card of the springs.')
      call required(table)
      call flag(table, 'NONLINEAR', 'A table of forces and extensions.')
      call later_flag(table, 'ORIENTATION', 'Directions of SPRING1 and SPRING2: use *TRANSFORM.')
      call ignored_flag(table, 'COMPLEX STIFFNESS', 'Damping.')
      call data_line(table, 'dof, dof', 'SPRING1, SPRING2: of the first and the second node; '// &
         & 'SPRINGA: a blank line, or none.')
      call data_line(table, 'stiffness [force/length]', 'Without NONLINEAR.')
      call data_line(table, 'force [force], extension [length]', 'NONLINEAR: one point a line; '// &
         & 'constant beyond the last.')
      call example(table, '*SPRING, ELSET=WIRES|1, 1|250.')

      call key(table, 'GAP', 'MPA', 'both', 'Gaps: elements GAPUNI, which press where their '// &
         & 'two nodes have come together.')
      call word(table, 'ELSET', 'The ELSET of the *ELEMENT card of the gaps.')
      call required(table)
      call data_line(table, 'clearance [length], x, y, z, area, stiffness [force/length], '// &
         & 'tension', &
         & 'The direction is that from the first node to the second; without a stiffness it is '// &
         & 'a thousand times the largest modulus times the size of the scene. Area and tension '// &
         & 'are read past.')
      call example(table, '*GAP, ELSET=STOPS|0.1, 0., 0., 1.')
   end subroutine add_springs

   subroutine add_constraints(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'EQUATION', 'MPA', 'both', &
         & 'Linear relation between displacements: the sum of coefficient times displacement '// &
         & 'is zero.')
      call later_flag(table, 'INPUT', 'Read the data lines from another file: use *INCLUDE.')
      call data_line(table, 'number of terms', 'First line.')
      call data_line(table, 'node or node set, dof, coefficient, ...', &
         & 'The terms; the first is eliminated.')
      call example(table, '*EQUATION|2|5, 1, 1., 9, 1, -1.')

      call key(table, 'PRE-TENSION SECTION', 'M', 'both', 'Cuts a bolt: the pre-tension node '// &
         & 'pulls the two sides of a section together.')
      call word(table, 'SURFACE', 'Faces across the bolt, of the elements on one side.')
      call required(table)
      call word(table, 'NODE', 'The pre-tension node: *CLOAD on its dof 1 is the tension, '// &
         & '*BOUNDARY the shortening.')
      call required(table)
      call later_flag(table, 'ELEMENT', 'A beam that is tightened.')
      call data_line(table, 'x, y, z', 'Normal of the section; without it that of the faces.')
      call example(table, '*PRE-TENSION SECTION, SURFACE=CUT, NODE=9000|0., 1., 0.')

      call key(table, 'TRANSFORM', 'MPA', 'both', 'Local axes in which the dofs of nodes are '// &
         & 'meant: displacements and forces, rotations and moments of reference nodes too.')
      call word(table, 'NSET', 'The nodes; for rotations the REF NODE, or the ROT NODE if the '// &
         & 'body has one.')
      call required(table)
      call choice(table, 'TYPE', 'R,C', 'R', 'R: one Cartesian system; C: radial, tangential, '// &
         & 'axial about an axis.')
      call refuses(table, 'S')
      call data_line(table, 'ax [length], ay [length], az [length], bx [length], by [length], '// &
         & 'bz [length]', &
         & 'R: a on local x, b in the local xy plane; C: the axis from a to b.')
      call example(table, '*TRANSFORM, NSET=SLOPE|0.7071, 0.7071, 0., -0.7071, 0.7071, 0.')

      call key(table, 'RIGID BODY', 'MPA', 'both', &
         & 'A tool that moves with a reference node: an analytical surface, elements or nodes.')
      call word(table, 'REF NODE', 'Reference node, or a set of one node.')
      call required(table)
      call word(table, 'ANALYTICAL SURFACE', 'Surface of type SEGMENTS, CYLINDER, REVOLUTION, STL.')
      call word(table, 'ELSET', 'Elements that become rigid.')
      call word(table, 'NSET', 'Nodes that become rigid (CalculiX).')
      call word(table, 'PIN NSET', 'Nodes that follow in translation.')
      call word(table, 'TIE NSET', 'Nodes that follow.')
      call word(table, 'ROT NODE', 'Node whose dofs 1 to 3 are the rotations (CalculiX); else '// &
         & 'dofs 4 to 6 of REF NODE.')
      call choice(table, 'POSITION', 'INPUT', 'INPUT', 'Where the reference node is.')
      call refuses(table, 'CENTER OF MASS')
      call ignored_flag(table, 'ISOTHERMAL', 'Heat conduction; there is none in a static step.')
      call example(table, '*RIGID BODY, ANALYTICAL SURFACE=PUNCH, REF NODE=9001')
      call about(table, 'D')
   end subroutine add_constraints
end module lopin_keyword_rows_model
