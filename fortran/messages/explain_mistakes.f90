!> Explanations: contradictions, statements without effect, and mixed units in a deck.
module lopin_explain_mistakes
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: mistake_explanations

contains

   subroutine mistake_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call more_explanations(list)
      call add_explanation(list, 'W0404', 'a dof has two values in one step', &
         & 'Two data lines of *BOUNDARY in the same step prescribe a dof, often through node '// &
         & 'sets that overlap, and with different values. The last line counts. Equal values '// &
         & 'and other values in a later step are not warned of.', &
         & 'remove one of the lines, or take the node out of one of the sets.')
      call add_explanation(list, 'W0402', 'a number of a material that does not fit', &
         & 'Ratios need no unit: solids yield at strains between 1e-5 and a tenth, their flow '// &
         & 'curves rise more slowly than they are stiff, heat strains them by per cents and '// &
         & 'pressures lie below their modulus. What is far off is most often a number in '// &
         & 'another unit: GPa beside MPa, per cent beside strain.', &
         & 'write all numbers in one system of units; if the number is meant, go on.')
      call add_explanation(list, 'W0303', 'a tool or an interaction in no pair', &
         & 'Contact acts between the surfaces that *CONTACT PAIR or *TIE names, and nowhere '// &
         & 'else: a tool in no pair is passed through, and the friction of an interaction in '// &
         & 'no pair acts nowhere.', &
         & 'name the tool as the master of a *CONTACT PAIR, or remove it.')
      call add_explanation(list, 'W0350', 'a request for contact output of no pair', &
         & '*CONTACT PRINT and *CONTACT FILE with SLAVE= or MASTER= are of the pairs in which '// &
         & 'these surfaces have these roles. There is none: most often roles were exchanged on '// &
         & '*CONTACT PAIR, and the request was left as it was.', &
         & 'name the surfaces as the pair does, or none: the request is then of all pairs.')
      call add_explanation(list, 'N0303', 'a material or an amplitude that is not used', &
         & 'No section names the material, or no load and no motion the amplitude. Programs '// &
         & 'that write decks do so; by hand it is a forgotten word.', '')
      call add_explanation(list, 'W0307', 'a bound of the shear stress on nodes without areas', &
         & 'TRESCA, COULOMB-OROWAN, CRISTESCU, NORTON-HOFF and TAUMAX bound a stress. On a '// &
         & 'surface of nodes without areas, pressure and shear are forces, and so is the '// &
         & 'bound: it does not know how large the surface is.', &
         & 'take TYPE=ELEMENT, or give the area of each node.')
      call add_explanation(list, 'W0306', 'bodies that meet node on node and that nothing joins', &
         & 'Meshes of parts have nodes at the same places, but no elements in common, and no '// &
         & 'pair, tie or equation has to do with both: they move through each other. Mesh '// &
         & 'programs leave such seams where parts were not merged.', &
         & 'merge the nodes, write *TIE, or *CONTACT PAIR.')
      call add_explanation(list, 'W0309', 'a mid-side node that hangs on a straight edge', &
         & 'An element of second order and one of first order share the corners of an edge. '// &
         & 'One edge bends with its mid-side node, the other stays straight: '// &
         & 'the mesh gapes or overlaps there, and the mid-side node is loaded by one side only.', &
         & 'give both elements one order, or hold the node by *EQUATION, 2 u = u1 + u2.')
      call add_explanation(list, 'W0305', 'an option of contact that does nothing', &
         & 'The option is known, but has nothing to act on where it stands: SMOOTH on a flat '// &
         & 'master, a tolerance of a method that no pair has, a clearance of a tied pair.', &
         & 'leave it out, or look whether another pair was meant.')
   end subroutine mistake_explanations

   !> Loads, data and runs.
   subroutine more_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0405', 'a load or a datum that does nothing', &
         & 'A force where *BOUNDARY prescribes the displacement goes into the support; a value '// &
         & 'after FIXED or after a word like XSYMM is not used.', &
         & 'give the force or the displacement; take the value away.')
      call add_explanation(list, 'W0406', 'a pressure inside a body', &
         & 'The face belongs to two elements. Most often the element set of *DLOAD holds more '// &
         & 'elements than those at the surface.', &
         & 'name the elements at the surface, or a *SURFACE for *DSLOAD.')
      call add_explanation(list, 'W0408', 'an amplitude that the step does not reach', &
         & '*STATIC without data lasts 1. An amplitude in the time of the step that goes on '// &
         & 'beyond is cut there, and the load with it.', &
         & 'write the increment and the period after *STATIC.')
      call add_explanation(list, 'N0402', 'a number that may be forgotten or in degrees', &
         & "A material without Poisson's ratio has 0, and rotations are in radians.", '')
      call add_explanation(list, 'N0326', 'temperatures that start from 0', &
         & 'Heat strains by the difference to the temperature of *INITIAL CONDITIONS, which is '// &
         & '0 where no line gives it: in kelvin that is seldom meant.', '')
      call add_explanation(list, 'W0316', 'ADJUST moves slave points far', &
         & 'ADJUST takes gaps and overclosures away without strain, as if the mesh had been '// &
         & 'made so. Over more than half a facet the shape that is computed is not the one of '// &
         & 'the deck.', &
         & 'move the bodies together in the mesh, or give ADJUST a smaller distance.')
      call add_explanation(list, 'W0515', 'a body moves away as a whole', &
         & 'A tool pushes a body that nothing holds: no support, no other contact, no load. '// &
         & 'The equations have an answer, because the pushing contact says where the body is, '// &
         & 'but it is a body without stress that moves. Or tools carry a body along by '// &
         & 'friction, all but rigidly and to the end of the run, where no wall and no support '// &
         & 'stops it.', &
         & 'hold the body by *BOUNDARY, or name the pair against which it should end. A body '// &
         & 'that is meant to travel (a sled, a conveyor) is right as it is.')
      call add_explanation(list, 'W0516', 'an elastic solid is stretched beyond any metal', &
         & '*ELASTIC is a straight line between stress and logarithmic strain. No solid that '// &
         & 'it is written for keeps to it when it is stretched to twice its length or pressed '// &
         & 'to half; rubber has *HYPERELASTIC.', &
         & 'look at the units of loads and modulus; a metal yields first: *PLASTIC.')
      call add_explanation(list, 'N0318', 'areas of a surface of nodes were found', &
         & 'Friction whose shear stress has a limit (TAUMAX, TRESCA, CRISTESCU, NORTON-HOFF) '// &
         & 'needs areas, and so does a slope or a law of pressure that the deck gives. The '// &
         & 'nodes of a surface of TYPE=NODE take those of the free faces '// &
         & 'between them; pressures are stresses then. Abaqus counts 1 a node, CalculiX all '// &
         & 'faces that the node is a corner of.', &
         & 'nothing to do; an area behind each node, or a surface of faces, says it in the deck.')
      call add_explanation(list, 'N0505', 'warnings that held again', &
         & 'A warning about a pair, a material or a step is said once; the note counts in how '// &
         & 'many later increments it held too.', '')
   end subroutine more_explanations
end module lopin_explain_mistakes
