!> Explanations: flow, rates and heat, metal past edges.
module lopin_explain_flow
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: flow_explanations

contains

   subroutine flow_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0323', 'a flow stress of the rate without a scale of time', &
         & '*RATE DEPENDENT and *VISCOPLASTIC read the rate of strain. A step whose *STATIC '// &
         & 'gives no period lasts 1 by default, so that the rate is what the unit of time '// &
         & 'makes of it.', 'write initial increment and period after *STATIC.')
      call add_explanation(list, 'W0324', 'a flow curve that falls', &
         & 'Where the flow stress falls with strain, equilibrium has answers in which the '// &
         & 'strain gathers in one row of elements: the load falls faster on finer meshes, and '// &
         & 'no mesh is fine enough.', 'take a curve that does not fall, or read the result as '// &
         & 'that of this mesh.')
      call add_explanation(list, 'W0325', 'temperatures that do nothing', &
         & 'Temperatures act by thermal expansion and by flow curves of several temperatures, '// &
         & 'and no material has one.', &
         & 'add *EXPANSION to a material, or leave *TEMPERATURE out.')
      call add_explanation(list, 'N0325', 'an expansion that does nothing', &
         & 'A material has *EXPANSION and no step prescribes temperatures: programs that write '// &
         & 'decks often add the coefficient anyway.', '')
      call add_explanation(list, 'W0510', 'strain beyond the end of a flow curve', &
         & 'The accumulated plastic strain is larger than the last one of *PLASTIC. The stress '// &
         & 'stays that of the last line: perfect plasticity from there on, as in Abaqus.', &
         & 'add lines, or write a law that has no end.')
      call edge_explanations(list)
   end subroutine flow_explanations

   !> Metal that spreads past the edge of what presses it.
   subroutine edge_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0517', 'a node goes past the edge of its master', &
         & 'Which nodes press surface to surface is decided between increments. This one left '// &
         & 'its master for the most part within one, and held its facet straight past the '// &
         & 'edge to the end: forces were up to 15 % too large. The increment is cut to where '// &
         & 'the node leaves.', &
         & 'smaller increments on *STATIC; nothing where they may be cut.')
      call add_explanation(list, 'W0345', 'facets of metal hang past an edge', &
         & 'Metal that flows has spread past the edge of what presses it, surface to surface, '// &
         & 'and its facet cannot bend there. While both ends press it is held straight and '// &
         & 'presses as if covered whole; once its end lets go, what is covered presses too '// &
         & 'little. Forces of blocks between dies were off by three quarters of the share of '// &
         & 'the area that hangs, in both ways; the pressure at the edge is one of the mesh.', &
         & 'facets half as long halve it.')
      call add_explanation(list, 'W0346', 'tractions of ties that nothing decides', &
         & 'Supports hold slave nodes of a tie and most of what they are tied to. What the tie '// &
         & 'asks there is met by the supports already, so that its tractions may be shared out '// &
         & 'in any way: those of the nodes named are more than a hundred times what elements '// &
         & 'bear. Displacements, stresses and the sums of reactions are right.', &
         & 'read no traction of the tie at these nodes, or leave out the supports of its '// &
         & 'slave side.')
   end subroutine edge_explanations
end module lopin_explain_flow
