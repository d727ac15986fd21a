!> Explanations of what is said of sheets that bend point by point, and of their springback.
module lopin_explain_springback
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: springback_explanations

contains

   subroutine springback_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call facet_explanations(list)
      call add_explanation(list, 'N0518', 'work done while a body is let go of', &
         & 'A release that is elastic and without friction ends in one shape, whichever way '// &
         & 'the tools go: pairs removed, motion, loads taken off. Here the metal flows again '// &
         & 'or '// &
         & 'rubs on its way out. That work, beside the elastic energy that comes free, tells '// &
         & 'how far another way may end elsewhere.', &
         & 'nothing; let go as the press does where the springback matters.')
      call add_explanation(list, 'W0518', 'the springback depends on the way of the release', &
         & 'As N0518, but more than a twentieth of the elastic energy that comes free is used '// &
         & 'up by plastic flow and friction.', &
         & 'withdraw the tools by their motion, in the order of the press.')
      call add_explanation(list, 'W0519', 'springback beside work that is not accounted for', &
         & 'Springback is driven by the elastic energy that comes free, a small part of the '// &
         & 'work of forming. Before the release more than a twentieth of it was lost or found, '// &
         & 'beyond what increments miss of a smooth path: they were too long for what happened '// &
         & 'in them, as facets that leave a radius one by one while the force rises and falls. '// &
         & 'Forces and shapes under the tools may be right to a percent all the same.', &
         & 'smaller increments before the release, or more facets on the radii.')
      call add_explanation(list, 'N0522', 'springback of a strip that bends point by point', &
         & 'Where a strip is wrapped over a radius, its bending moment is largest where it '// &
         & 'leaves the tool, and the metal flows over a length of about half the thickness. '// &
         & 'Longer facets bend it too far at the last point that presses, and back as the '// &
         & 'next one comes to press: force and elastic energy rise and fall with every point, '// &
         & 'and part of the springback has come free before the tools let go. Smaller '// &
         & 'increments do not change that. The root of what fell and rose again, beside what '// &
         & 'comes free at last, is about the largest error; often it is much smaller.', &
         & 'facets of half the thickness on the radii; compare with half as long ones.')
      call add_explanation(list, 'W0522', 'springback of a strip that bends point by point', &
         & 'As N0522, but more than a twentieth of the elastic energy rose and fell: strips '// &
         & 'with facets of two to four thicknesses sprang back by 0.4 to 0.85 of what they do '// &
         & 'on a mesh four times finer, their mean forces right to a percent.', &
         & 'facets of half the thickness on the radii; compare with half as long ones.')
      call add_explanation(list, 'W0523', 'equilibrium says little of a shape', &
         & 'Metal without hardening bears nearly one moment, or one force, however far it '// &
         & 'flows: a strip that is bent by a moment alone takes its curvature wherever the '// &
         & 'smallest force of contact wants it. At the end of the step there is a motion that '// &
         & 'is a thousand times softer, and more, than any of the elastic body, and a '// &
         & 'hundredth of the forces in the metal moves it by a fiftieth of the body. Forces '// &
         & 'are right; shapes, and springback along that motion, differ by method and mesh.', &
         & 'the hardening that the metal has; tools that hold the shape on both sides.')
   end subroutine springback_explanations

   !> Forces that facets make rise.
   subroutine facet_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0561', 'the force of a tool rises and falls with the facets', &
         & 'A row of contact begins where its node arrives. As a tool moves on over a radius, '// &
         & 'or a strip over it, the force rises until the next node bears and falls as that '// &
         & 'takes over: waves of about one facet, shorter and lower on a finer mesh. Tools '// &
         & 'count that supports of theirs or of the part lead along it, whichever moves. The '// &
         & 'figure is the highest that came and went within the travel of three facets. Forces '// &
         & 'differed from those of a mesh of half the size by .3 to .9 of it (root of the mean '// &
         & 'square over the step) and by one to three times as much at their worst.', &
         & 'half as long facets over radii; means over the travel of a facet.')
      call add_explanation(list, 'W0561', 'the force of a tool rises and falls with the facets', &
         & 'As N0561, but by more than a twentieth of the largest force of the tool.', &
         & 'half as long facets over radii; in the plane SMOOTH=YES on *CONTACT PAIR (linear '// &
         & 'facets); means over the travel of a facet.')
      call add_explanation(list, 'N0562', 'a force rises within the sag of facets', &
         & 'Between its nodes a facet is flat, and off the curved tool that they lie on by the '// &
         & 'sag of its chord, h^2/8R. By so much it is unknown where the tool bears. What the '// &
         & 'driving force rises by within that travel is known no better. Of a bend in air '// &
         & 'that is little; where a sheet is pressed home between punch and die the force '// &
         & 'rises tenfold within hundredths of a thickness. What points have borne before, or '// &
         & 'formed metal of the start before it flows, is elastic and does not count. Pressed '// &
         & 'home on facets of a '// &
         & 'seventh to a half of the radius bends were 14 to 90 % off, and the figure was .5 '// &
         & 'to 1.1 of it. '// &
         & 'A force that snaps from one bending wave to the next is known worse.', &
         & 'half as long facets on the curved parts: a quarter of the sag; or end the way '// &
         & 'before.')
      call add_explanation(list, 'W0562', 'a force rises within the sag of facets', &
         & 'As N0562, but by more than a twentieth of the largest driving force.', &
         & 'half as long facets on the curved parts: a quarter of the sag; or end the way '// &
         & 'before.')
   end subroutine facet_explanations
end module lopin_explain_springback
