!> Explanations of E02xx, E03xx, E04xx: what is wrong with the model that a deck describes.
module lopin_explain_model
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: model_explanations

contains

   subroutine model_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call names(list)
      call mesh(list)
      call states(list)
      call contact(list)
      call gaps(list)
      call raised(list)
      call conditions(list)
   end subroutine model_explanations

   subroutine names(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0201', 'a name that is not defined', &
         & 'A set, surface, material, interaction or amplitude is named but nowhere defined. '// &
         & 'Model data may stand in any order, so the definition is missing, not late. Labels '// &
         & 'of instances are written INSTANCE.label.', &
         & 'the message lists what is defined and the nearest name.')
      call add_explanation(list, 'E0202', 'a node or element that does not exist', &
         & 'A number in a data line belongs to no node or element.', &
         & 'check the number, and that its mesh is included.')
      call add_explanation(list, 'E0203', 'a material or section is incomplete', &
         & 'Every deformable element needs a *SOLID SECTION, every section a *MATERIAL, every '// &
         & 'material an *ELASTIC with a positive modulus and a Poisson''s ratio above -1 and '// &
         & 'below 0.5.', &
         & 'give the section to a set that holds all elements.')
      call add_explanation(list, 'E0204', 'an empty set', &
         & 'A set that something uses has no members, or GENERATE counts nothing.', &
         & 'check first, last and increment of GENERATE.')
      call add_explanation(list, 'W0401', 'units that do not fit together', &
         & 'Lopin has no units; a deck uses one consistent set, best mm, N, s, t and MPa. The '// &
         & 'weight of the model, density times gravity times its size, exceeds the modulus: as '// &
         & 'if two sets were mixed.', &
         & 'steel in mm, N, t: E = 210000, density 7.8e-9, gravity 9810.')
      call add_explanation(list, 'E0205', 'a definition that cannot be used', &
         & 'Something is defined twice, or a word of the mesh is not known.', &
         & 'keep one of the definitions.')
   end subroutine names

   subroutine states(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0210', 'a state of the start that nothing can take', &
         & '*INITIAL CONDITIONS, TYPE=STATE gives what integration points remember in the '// &
         & 'present shape. The element has no such point, its material has a yield surface of '// &
         & 'its own or one that moves, or is rubber, or the first step is of small strain.', &
         & 'give states as `Job.points` of an earlier run writes them, to the same elements, '// &
         & 'under *STEP, NLGEOM.')
      call add_explanation(list, 'W0210', 'internal modes begin anew', &
         & 'Elements with internal modes (I) keep part of their deformation in modes that '// &
         & 'belong to the shape of the start. A state of points does not have them: the first '// &
         & 'increment finds new ones, and forces jump by some per cent where elements are '// &
         & 'sheared much.', &
         & 'hand states over between meshes of elements without modes (CAX4, CPE4, C3D8), or '// &
         & 'look at the jump of the forces in an increment at rest.')
   end subroutine states

   subroutine mesh(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0206', 'an element type that cannot be used', &
         & 'The word after TYPE= is not an element of Lopin, or elements of different kinds '// &
         & '(plane, axisymmetric, solid) stand in one scene.', &
         & 'solids are CPE, CPS, CAX with 3, 4, 6, 8 nodes and C3D with 4, 6, 8, 10, 15, 20.')
      call add_explanation(list, 'W0211', 'elements that lock', &
         & 'FORMULATION=FULL takes away the averaging of the change of volume. Where '// &
         & 'Poisson''s ratio is above 0.4, or the material flows, each point then has to keep '// &
         & 'its volume by itself, for which the element has not enough freedom.', &
         & 'leave out FORMULATION=FULL.')
      call add_explanation(list, 'N0211', 'linear simplices in patches', &
         & 'A linear triangle, tetrahedron or wedge alone cannot keep its volume and deform. '// &
         & 'Where Poisson''s ratio is above 0.4, or the material flows, about 2 (8 tetrahedra) '// &
         & 'neighbours have one change of volume in common; stresses are still those of each '// &
         & 'element.', &
         & 'nothing; *SECTION CONTROLS, FORMULATION=FULL leaves every element alone, and locks.')
      call add_explanation(list, 'N0212', 'quadratic elements with a linear change of volume', &
         & 'A fully integrated quadratic quad or brick that has to keep its volume at each of '// &
         & 'its points is too stiff. Where Poisson''s ratio is above 0.4, or the material '// &
         & 'flows, its change of volume is projected onto the linear functions of the '// &
         & 'coordinates.', &
         & 'nothing; *SECTION CONTROLS, FORMULATION=FULL leaves every point alone, and locks.')
      call add_explanation(list, 'N0213', 'sheets of few layers of elements that flow', &
         & 'Bent plastically, the stress jumps near the middle: the usual points of one layer '// &
         & 'give a moment 14 to 19 % off, of two layers 1.5 to 5 % too small. Sheets whose '// &
         & 'metal flows have five, four, three points in each half of each of one, two, three '// &
         & 'layers (in space three, two): 1 % off (3 %). Several layers are a sheet if it is '// &
         & 'five times as long as thick. Nothing bends across faces that supports hold along '// &
         & 'their normal in every step: they are not free.', &
         & 'nothing; *SECTION CONTROLS, FORMULATION=FULL keeps the usual points.')
      call add_explanation(list, 'N0206', 'an element word stands for another formulation', &
         & 'The letters of the word (R, I, H, M) ask for a formulation that Lopin does not '// &
         & 'have; the message says which one is used.', '')
      call add_explanation(list, 'E0207', 'a node that cannot be used', &
         & 'A node has a position that its kind of scene does not allow, for example a '// &
         & 'negative radius in an axisymmetric scene, or lies outside the plane.', &
         & 'correct the coordinates.')
      call add_explanation(list, 'E0208', 'an element with the wrong number of nodes', &
         & 'Each element type has a fixed number of nodes; an element may run over several '// &
         & 'data lines.', &
         & 'compare the data lines with the type; a comma may be missing, or the type may be '// &
         & 'of the wrong order.')
      call add_explanation(list, 'E0209', 'a part or instance is wrong', &
         & 'A part is not closed, or an instance refers to something that does not exist or '// &
         & 'cannot be placed.', &
         & 'see `lopin doc ''*INSTANCE''`.')
      call add_explanation(list, 'N0209', 'numbers of an instance', &
         & 'Parts are copied into one mesh; the numbers of their nodes and elements are shifted.', &
         & '')
      call add_explanation(list, 'E0301', 'a surface names a face that cannot touch', &
         & 'The face does not exist on elements of this type, or it is shared with another '// &
         & 'element and so is not on the boundary.', 'give the element set without a face '// &
         & 'label: Lopin takes its free faces.')
      call add_explanation(list, 'E0302', 'an element is turned inside out', &
         & 'The volume of the element is zero or negative at an integration point. Its nodes '// &
         & 'are in the wrong order, or the element is badly distorted.', &
         & 'renumber its nodes as in the manual; 2D elements go round counterclockwise.')
   end subroutine mesh

   subroutine contact(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0304', 'a contact pair that cannot be used', &
         & 'A pair has a slave surface with nodes and a master surface with faces or an '// &
         & 'analytical tool; each pair stands once.', 'see `lopin doc ''*CONTACT PAIR''`.')
      call add_explanation(list, 'E0305', 'a rigid body that cannot be used', &
         & 'A rigid body needs one reference node and something that follows it, and nothing '// &
         & 'can follow two bodies.', &
         & 'see `lopin doc ''*RIGID BODY''`.')
      call add_explanation(list, 'E0306', 'a contact law that cannot be used', &
         & 'The law between pressure and penetration must push, and push more the deeper the '// &
         & 'penetration.', &
         & 'see `lopin doc ''*SURFACE BEHAVIOR''`.')
      call add_explanation(list, 'E0312', 'the normal of a tool points the wrong way', &
         & 'An analytical surface is one-sided: its normal is on the left of the way along '// &
         & 'the profile and must point to the deformable body. Here no node of the slave has '// &
         & 'it opposite, some look out of it from inside, and no other lies in front of it.', &
         & 'reverse the order of START, LINE, CIRCL.')
      call add_explanation(list, 'E0316', 'a face too distorted for surface-to-surface contact', &
         & 'Points of the slave''s faces are carried to the faces opposite along the normal; '// &
         & 'on a face that is folded or not convex there may be no such place.', &
         & 'improve the mesh of the two surfaces, or use TYPE=NODE TO SURFACE.')
      call add_explanation(list, 'E0317', 'a pair of which nothing deforms', &
         & 'Both sides follow rigid bodies or are tools. Equilibrium alone does not say how '// &
         & 'the nodes share the force: there is no answer to compute.', &
         & 'give one of the two bodies an elastic material and leave it out of *RIGID BODY.')
      call add_explanation(list, 'E0313', 'a tool that has no shape', &
         & 'The data of the tool are degenerate: a radius that is not positive, an axis '// &
         & 'without length, an arc whose ends are not on one circle.', &
         & 'the message names the value.')
      call add_explanation(list, 'E0314', 'the profile of a tool is wrong', &
         & 'A profile begins with START and goes on with LINE and CIRCL; arcs are shorter '// &
         & 'than half a circle, and a fillet must fit between its neighbours.', &
         & 'see `lopin doc ''*SURFACE''`.')
      call add_explanation(list, 'E0331', 'the file of a tool cannot be used', &
         & 'A binary STL file has 84 bytes and 50 more for each facet, no more and no less; '// &
         & 'one in words begins with solid and ends with endsolid. This file is neither, or it '// &
         & 'is cut off, or it is not there.', &
         & 'export it again; the path counts from the deck.')
      call add_explanation(list, 'E0332', 'the facets do not make a surface', &
         & 'A tool needs an outside. Corners nearer than 1e-6 of the size are one; then each '// &
         & 'edge must belong to two facets that look to the same side.', &
         & 'mend it where it was made. OPEN allows a sheet, REPAIR turns facets.')
   end subroutine contact

   !> What the first look at the pairs says.
   subroutine gaps(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0311', 'slave nodes start inside the master', &
         & 'Nodes penetrate the master by more than half a facet, or the deck says '// &
         & 'INITIAL=ERROR. So deep an overclosure is nearly always a mistake of position, '// &
         & 'unit or side.', &
         & 'move the tool, or look at the side on which its normal points.')
      call add_explanation(list, 'W0311', 'an initial overclosure is taken as an interference '// &
         & 'fit', &
         & 'Slave nodes start inside the master by more than a thousandth of a facet. They '// &
         & 'are pushed out over the first step, which loads the body: that is a press fit.', &
         & 'if it is not meant, give ADJUST= on *CONTACT PAIR or *CONTACT CONTROLS, '// &
         & 'INITIAL=ADJUST; if it is, INITIAL=INTERFERENCE says so.')
      call add_explanation(list, 'W0304', 'a pair stands twice, once with its sides swapped', &
         & 'Each point of contact is then constrained from both sides, which stiffens the '// &
         & 'contact.', &
         & 'keep one: the finer, softer side is the slave.')
      call add_explanation(list, 'N0311', 'an interference that is meant', &
         & 'Slave nodes lie inside the master at the start, as INITIAL=INTERFERENCE or a '// &
         & 'negative *CLEARANCE says. '// &
         & 'Linear scenes ramp it in over the first step, Newton resolves it in the first '// &
         & 'increment.', 'nothing to do.')
      call add_explanation(list, 'W0318', 'slave nodes of a tied pair are not tied', &
         & 'A node is tied if a facet of the master lies opposite, nearer than half a facet '// &
         & 'of the slave or than '// &
         & 'ADJUST=. Others are free.', &
         & 'raise ADJUST=, or take the nodes out of the slave surface.')
      call add_explanation(list, 'W0315', 'a pair can never touch', &
         & 'No slave node has a point of the master opposite.', &
         & 'check positions and units, and that the slave''s faces look at the master.')
      call add_explanation(list, 'W0331', 'the normals of an STL file contradict its corners', &
         & 'The outward side of a facet is that from which its corners turn anticlockwise. The '// &
         & 'file also says a normal, and it is the other one.', &
         & 'look at the tool in the results, or export it again.')
      call add_explanation(list, 'W0332', 'the facets of a tool are coarse beside the slave', &
         & 'The facets stand off the curved surface they mean by more than a fiftieth of a '// &
         & 'slave facet: pressures will show the facets. Chords also take room from a '// &
         & 'cavity, or give it some: where a die fills, its force is that of a '// &
         & 'stroke which differs by their mean.', &
         & 'export the tool with a smaller chord error, or use an analytical tool.')
      call add_explanation(list, 'N0332', 'the facets of a tool are curved', &
         & 'Triangles of an STL file that meet at less than 30 degrees are taken for a curved '// &
         & 'surface: each becomes the quadratic one whose edges follow the normals of its '// &
         & 'corners. Sharper edges stay, but for those of up to 60 degrees, of fillets of few '// &
         & 'facets and of slivers, that stand out no more than the chords beside them. The '// &
         & 'figure is how far that is off the facets, beside a slave facet.', &
         & 'SMOOTH=NO on *SURFACE where the facets are meant as they are.')
   end subroutine gaps

   !> What is done to contact cards and tools.
   subroutine raised(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0331', 'facets of a tool were mended', &
         & 'Facets without area were dropped, or facets were turned because REPAIR asks for it.', &
         & '')
      call add_explanation(list, 'N0304', 'a contact card is read in another way', &
         & 'The message says how; the answer is the same up to the discretisation of contact.', '')
      call add_explanation(list, 'N0306', 'a datum of the contact law is not used', &
         & 'The law does not need it, or it belongs to another code.', '')
      call add_explanation(list, 'N0316', 'slave nodes were set on the master', &
         & 'Small initial overclosures and gaps within ADJUST= are removed without strain '// &
         & 'before the first step.', '')
      call add_explanation(list, 'N0317', 'the stiffness of contact was chosen', &
         & 'A penalty without a value is chosen so that the pressure error stays below TARGET '// &
         & 'ERROR of *LOPIN; on the finite path it is 100 times the modulus of the softer side '// &
         & 'over the size of the facet.', &
         & 'give a slope under *SURFACE BEHAVIOR to choose it yourself.')
      call add_explanation(list, 'W0568', 'springs of contact give way beside the bodies', &
         & 'A stiffness that was chosen (N0317) keeps pressures right. Where loads are given '// &
         & 'and bodies are thin, their springs may give way as the bodies do: two sheets a '// &
         & 'tenth of a facet thick were pressed together by 41 % too far. Friction that sticks '// &
         & 'by an elastic slip of half a percent of a facet (N0520) turns round with the '// &
         & 'springs. The energy that springs take up in a step beside that of the bodies is '// &
         & 'their share of the displacements.', &
         & 'DIRECT or AUGMENTED LAGRANGE, or a stiffness of your own behind PENALTY and '// &
         & 'ELASTIC SLIP= on *FRICTION.')
      call add_explanation(list, 'W0343', 'a tool moves away', &
         & 'Every step moves the tool away from the slave of its pair, and nothing else moves '// &
         & 'or is loaded: the pair can press nothing.', &
         & 'look at the sign of the displacement under *BOUNDARY.')
      call add_explanation(list, 'W0344', 'an accuracy is asked for that one run cannot tell', &
         & '*LOPIN, QUANTITY asks for a number within TARGET ERROR. That takes runs on finer '// &
         & 'meshes and in smaller increments, which the command of the Python package makes; '// &
         & 'the executable alone has solved the deck as it is.', &
         & 'run the deck by the command of the Python package, or leave QUANTITY out.')
      call add_explanation(list, 'N0305', 'a rigid body is free to turn', &
         & 'The deck moves or loads the reference node of a rigid body and says nothing of its '// &
         & 'rotations. Contact and friction turn it then: a ball rolls where it was to slide.', &
         & 'hold the rotations by *BOUNDARY (dof 6 in a plane scene, 4 to 6 of a solid one), '// &
         & 'if the body is not meant to roll.')
      call add_explanation(list, 'N0329', 'the chosen stiffness of contact was raised', &
         & 'Bodies that are confined, nearly incompressible or in many layers give way less '// &
         & 'than one facet does. The equilibrium by the slopes chosen first told that its '// &
         & 'pressures were off by more than TARGET ERROR of *LOPIN; it was found again by '// &
         & 'stiffer ones, which the run keeps.', &
         & 'nothing; DIRECT has no penetration at all.')
   end subroutine raised

   subroutine conditions(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0310', 'a body can move freely', &
         & 'Nothing holds a body in some direction, so its position is not determined and the '// &
         & 'matrix is singular. Contact holds a body only after it has closed, and never '// &
         & 'along a frictionless surface; with friction within the cones of its law only.', &
         & 'fix a dof, or bring the tool into touch before the force acts.')
      call add_explanation(list, 'E0403', 'a node is constrained twice', &
         & 'A boundary condition, an equation, a tie or a rigid body each take a dof; two of '// &
         & 'them want the same one.', &
         & 'remove one of the constraints that the message lists.')
      call add_explanation(list, 'E0404', 'a boundary condition or load that cannot be used', &
         & 'Degrees of freedom are 1 to 3 for translations and 4 to 6 for rotations of a '// &
         & 'reference node (2D: 1, 2, 6). Loads have the words that `lopin doc ''*DLOAD''` '// &
         & 'lists.', &
         & 'correct the dof or the word.')
      call add_explanation(list, 'N0404', 'a dof that the scene does not have', &
         & 'A boundary condition on a dof that does not exist in two dimensions holds nothing '// &
         & 'and is ignored.', '')
      call add_explanation(list, 'E0407', 'a load that does not exist', &
         & 'The word of *DLOAD or *DSLOAD is not known, or does not exist in a scene of this '// &
         & 'kind.', &
         & '`lopin doc ''*DLOAD''` lists the words.')
      call add_explanation(list, 'N0407', 'a node or a face is loaded twice', &
         & 'Two data lines of one step load the same dof or face; the loads are added, as in '// &
         & 'Abaqus. OP=NEW takes away those of earlier steps, not those of its own step.', '')
      call add_explanation(list, 'E0405', 'local axes that cannot be used', &
         & 'The two points of *TRANSFORM must give two different directions.', &
         & 'see `lopin doc ''*TRANSFORM''`.')
      call add_explanation(list, 'E0408', 'a step that cannot be used', &
         & 'A run needs at least one *STEP with *STATIC, and loads stand inside steps; times '// &
         & 'are positive.', &
         & 'see `lopin doc ''*STEP''` and `lopin doc ''*STATIC''`.')
      call add_explanation(list, 'N0405', 'times of a step were cut', &
         & 'The initial increment is longer than the period; one increment of the period is '// &
         & 'used.', '')
      call add_explanation(list, 'E0406', 'an amplitude that cannot be used', &
         & 'The times of an amplitude must grow, and every time has a value.', 'sort the points.')
   end subroutine conditions
end module lopin_explain_model
