!> Explanations: what decks of other programs say in their own way, and advice.
module lopin_explain_others
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: other_explanations

contains

   subroutine other_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0203', 'an element in two sections', &
         & 'Two *SOLID SECTION cards name sets that share elements. The later card holds, as '// &
         & 'in CalculiX; with two different materials that is often a set too many.', &
         & 'leave the elements out of one of the two sets.')
      call add_explanation(list, 'W0205', 'a surface in two cards', &
         & 'Two *SURFACE cards have one name. Their faces, or their nodes, are taken together, '// &
         & 'as CalculiX does and as sets are; a face listed twice counts once.', &
         & 'write one card, or give the second surface a name of its own.')
      call add_explanation(list, 'W0319', 'tied surfaces that look the same way', &
         & 'Surfaces that are glued face each other: where they look the same way the bodies '// &
         & 'behind them overlap, or one has the wrong face number. What is joined is clear, '// &
         & 'though: the nodes of the slave follow the nearest points of the master.', &
         & 'look at the two surfaces in check.vtu or in ParaView.')
      call add_explanation(list, 'N0406', 'a node on the axis of *TRANSFORM', &
         & 'On the axis of a cylindrical system every direction across is radial. The one that '// &
         & 'CalculiX takes is taken; a condition on the radial or tangential dof of such a '// &
         & 'node depends on that choice.', &
         & 'prescribe nodes on the axis in a set of their own.')
      call add_explanation(list, 'E0315', 'a pre-tension section that cuts nothing', &
         & 'The surface of *PRE-TENSION SECTION is the element faces on one side of a plane '// &
         & 'across the bolt; the direction on the data line is the normal of that plane.', &
         & 'name faces by *SURFACE, TYPE=ELEMENT and give their normal, or none.')
      call advice(list)
   end subroutine other_explanations

   !> What a deck models beyond what its scene needs.
   subroutine advice(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0361', 'a scene of plane strain is meshed in space', &
         & 'Every node is held in one direction in all steps, and mesh, sections, supports, '// &
         & 'loads, contact surfaces and tools are the same at every height along it.', &
         & 'a plane deck (*ELEMENT, TYPE=CPE4 or CPE8, with the thickness under *SOLID '// &
         & 'SECTION) has the same answer for a fraction of the time.')
      call add_explanation(list, 'N0362', 'a meshed master is all but rigid', &
         & 'The elements of the master are at least a hundred times as stiff as those of the '// &
         & 'slave, and the body is held behind the contact, so that it does not bend: they '// &
         & 'take equations and hardly deform.', &
         & 'make it a *RIGID BODY, ELSET=, or a rigid profile; its stresses are then not known.')
      call add_explanation(list, 'N0363', 'increments that change nothing', &
         & 'Elastic bodies of small strain without friction and without NO SEPARATION '// &
         & 'remember nothing: the end of a '// &
         & 'step whose loads grow in proportion is the same in one increment as in many.', &
         & 'leave the data line of *STATIC out, or keep the increments for results on the way.')
      call add_explanation(list, 'N0364', 'a plane of symmetry that is not used', &
         & 'Mesh, sections, supports, loads, contact pairs and tools are their own mirror '// &
         & 'images about a plane across an axis, one by one: the answer is symmetric, too, '// &
         & 'unless a slender body buckles to one side.', &
         & 'mesh one side, hold the nodes of the plane in its normal direction, and double the '// &
         & 'forces that you read.')
      call add_explanation(list, 'N0365', 'a scene of revolution is meshed in space', &
         & 'The skin of the bodies, what holds, loads and touches them, and the tools are of '// &
         & 'revolution about one axis, whole or between planes of symmetry: nothing varies '// &
         & 'around it, unless metal wrinkles or ears.', &
         & 'an axisymmetric deck (*ELEMENT, TYPE=CAX4 or CAX8R) has the same answer for a '// &
         & 'fraction of the time; forces are then those of the whole circumference.')
      call add_explanation(list, 'N0366', 'a tool of facets is a plane, a sphere or a cylinder', &
         & 'All corners of a rigid master of facets (elements or an STL file) lie on one such '// &
         & 'surface, and it ends nowhere near the slave. Facets are searched, their chords '// &
         & 'stand off it, and their edges may ripple the force of a slide.', &
         & 'make it a *SURFACE, TYPE=SEGMENTS, CYLINDER or REVOLUTION of lines and arcs.')
      call add_explanation(list, 'N0367', 'a slave much finer or coarser than its master', &
         & 'Both bodies deform alike, and the facets of the slave are less than a third of '// &
         & 'those of the master, or more than 1.5 times (surface to surface: 3 times) as '// &
         & 'large. The force is as good as the coarser side; pressures of a finer slave show '// &
         & 'the facets '// &
         & 'of its master, and a coarser one lets the master through between its nodes.', &
         & 'mesh both sides of the contact alike, or take the finer one as slave.')
      call add_explanation(list, 'N0368', 'elements of second order for nothing', &
         & 'At the end of every step the displacements of nodes in the middle of edges are all '// &
         & 'but the mean of the two ends. The error of linear elements in energy is not larger '// &
         & 'than what these nodes add, so that the work of all forces on a body would be the '// &
         & 'same within the share that is named, on fewer equations; of bodies in contact the '// &
         & 'worst counts. A slender part of a stiff body may hide: look at it. Said of linear '// &
         & 'scenes with straight cells.', &
         & 'take the linear word of the same cells, or larger cells of second order.')
      call add_explanation(list, 'N0369', 'a finite path (NLGEOM) for nothing', &
         & 'After every increment the linear bodies, asked with the contact that was found, '// &
         & 'have all but the same displacements and work: two back substitutions by the '// &
         & 'tangent at hand, whose fall is measured. Of bodies in contact the worst counts. '// &
         & 'Said of elastic bodies without friction, whose loads keep their directions.', &
         & 'leave NLGEOM out on *STEP: linear bodies take one factor in all.')
   end subroutine advice
end module lopin_explain_others
