!> Explanations of diagnostics: facets that do not match, or are coarse for what they meet.
module lopin_explain_facets
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: facet_explanations

contains

   subroutine facet_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call uneven_gaps(list)
      call narrow_masters(list)
   end subroutine facet_explanations

   !> Slaves and masters whose facets do not match.
   subroutine uneven_gaps(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0333', 'facets that do not match make the pressure uneven', &
         & 'Contact is at the nodes of the slave. Where its facets and those of the master do '// &
         & 'not match, or are longer, a uniform load gives no uniform pressure, and master '// &
         & 'nodes that no slave node meets go in. The figure is that of a uniform '// &
         & 'pressure, solved with the elements near the contact (docs/atlas.md, map 9); under '// &
         & 'a given load forces as a whole are right (of a given way: W0340).', &
         & 'TYPE=SURFACE TO SURFACE is exact there; or take the softer side, with facets at '// &
         & 'most half as long, as the slave.')
      call add_explanation(list, 'W0348', 'a coarse slave presses a finer master at single nodes', &
         & 'Contact is at the nodes of the slave. Nodes of the master between them bear '// &
         & 'nothing, the others too much: stresses in its first elements are uneven by about '// &
         & 'the figure, even where the pressures of the slave are right. Under a given load '// &
         & 'forces as a whole are right (of a given way: W0340), and stresses a few elements '// &
         & 'away.', &
         & 'TYPE=SURFACE TO SURFACE is exact there; or take the side with the shorter facets '// &
         & 'as the slave.')
      call add_explanation(list, 'N0347', 'a pair that says no TYPE is carried out surface to '// &
         & 'surface', 'At the nodes its facets, which do not match, would make a uniform '// &
         & 'pressure uneven by the figure that is said (W0333), or even on the slave and '// &
         & 'uneven in the master; on the nonlinear path (NLGEOM, temperatures, plastic flow) '// &
         & 'facets that match at the start do so no more when they have slid, and nodes of '// &
         & 'round bodies leave the corners that they met. Surface to surface is exact '// &
         & 'there, so it is taken where the deck leaves the choice open: no TYPE, SMOOTH or '// &
         & 'EXTENSION ZONE, no new meshes. In space, and where bodies move far, every facet '// &
         & 'of the slave that faces the master must lie opposite it whole, or be of metal: '// &
         & 'at its end contact of elastic bodies is narrower than a facet.', &
         & 'TYPE=NODE TO SURFACE where contact at the nodes is meant.')
      call add_explanation(list, 'W0341', 'chords beside an interference or a gap', &
         & 'Facets that do not match cut an arc at different places: their gaps differ by the '// &
         & 'sag of a facet, its length times the angle between facets over eight. Beside a '// &
         & 'small interference pressures then vary by sag / (interference times angle) of '// &
         & 'themselves, beside a small gap the corners of facets touch first. Mean pressures '// &
         & 'suffer less; surface to surface they lack two thirds of the difference of the sags '// &
         & 'of both sides. *CLEARANCE or facets that match even the gaps, but nodes press '// &
         & 'along the normals of single facets, which lean against the curve by up to half '// &
         & 'the angle between facets: so much of the normal force is a wrong tangential one.', &
         & 'finer or matching facets, or second-order elements whose mid-side nodes are on the '// &
         & 'arc, on both sides.')
      call add_explanation(list, 'W0342', 'force across a gap', &
         & 'The gap of a surface-to-surface node is a mean over its facets by a function that '// &
         & 'is negative at their far ends. Where a master is convex within a facet the mean '// &
         & 'is less than every gap there, by up to curvature times facet squared over twelve. '// &
         & 'Runs with NLGEOM take the least gap instead; runs without change to the nonlinear '// &
         & 'path when this happens, unless friction has begun or PATH is given.', &
         & 'finer slave facets, the convex side as the slave, NLGEOM, *LOPIN PATH=FINITE, or '// &
         & 'TYPE=NODE TO SURFACE.')
   end subroutine uneven_gaps

   !> Masters and tools that are narrow, or chords, beside a slave facet.
   subroutine narrow_masters(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0336', 'a part of the master is narrower than a slave facet', &
         & 'Surface to surface spreads what a narrow punch or rib carries over the functions '// &
         & 'of the slave''s nodes: narrower than one facet it presses the whole facet, and the '// &
         & 'force may be a quarter to two thirds too large. Up to one and a half facets wide '// &
         & 'it is 14 to 5 % too large at a given motion on first-order faces, 29 to 17 % on '// &
         & 'triangles and tetrahedra of constant strain.', &
         & 'make the slave''s facets there at most as long as the master is wide, or exchange '// &
         & 'slave and master.')
      call add_explanation(list, 'N0334', 'a pair at the nodes is carried out surface to surface', &
         & 'Rows at the nodes of second-order faces (C3D10, C3D15, C3D20, CPE8, CAX8, CPE6 '// &
         & '...) do not pass on a uniform pressure: corners would carry nothing. TYPE=NODE TO '// &
         & 'SURFACE keeps its meaning between linear faces.', '')
      call add_explanation(list, 'W0335', 'second-order faces meet themselves', &
         & 'Contact of a surface with itself is at its nodes. On second-order faces the '// &
         & 'pressure of corners and of mid-side nodes differs though the load is uniform; the '// &
         & 'force as a whole is right.', &
         & 'linear elements there, or two surfaces that meet each other.')
      call add_explanation(list, 'W0337', 'a tool is narrower than the facets that it meets', &
         & 'Rows of contact with a tool sample the gap at the nodes of the slave. A rib, an '// &
         & 'edge or a radius between them is not seen: it goes into the facet without force. '// &
         & 'Under one node it counts as a facet laid flat. Looked at where steps end: where '// &
         & 'the tool is inside a facet whose nodes do not touch it, or deeper by 0.15 of it '// &
         & 'than at its nodes; and where the tool leaves the plane in which it meets a closed '// &
         & 'node on both sides within a facet.', &
         & 'make the facets of the slave finer there: two at least under each rib, edge or '// &
         & 'radius of the tool.')
      call add_explanation(list, 'W0338', 'a node ends inside its tool', &
         & 'The linear paths look from the place of a node at the start to where the tool '// &
         & 'stands at the end of an increment. Where a tool with a rib, an edge or a recess '// &
         & 'goes in by more than its features are high, the nearest side may be another one '// &
         & 'than the side that the node meets: its row then lets it into the tool.', &
         & '*LOPIN, PATH=FINITE, which follows the slave; or give the tool a shorter way.')
      call coarse_contact(list)
      call coarse_bodies(list)
   end subroutine narrow_masters

   !> Slaves that are coarse beside their masters, or beside contact.
   subroutine coarse_contact(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0339', 'a master goes into the slave between its nodes', &
         & 'Rows of contact belong to the nodes of the slave. A rib, a corner or a bulge of a '// &
         & 'meshed master between them is not seen: it goes into the facet without force, or '// &
         & 'deeper than the nodes that touch. Looked at where steps end: where the master is '// &
         & 'inside a facet whose nodes do not touch it, or deeper by 0.15 of it than at its '// &
         & 'nodes (0.05 past its edge in metal). A rib at one node presses as a whole facet.', &
         & 'make the facets of the slave at most as long as the master is wide there; or '// &
         & 'TYPE=SURFACE TO SURFACE; or exchange slave and master.')
      call add_explanation(list, 'W0340', 'a master sinks in between the nodes of its slave', &
         & 'A slave coarser than its master presses it at single nodes, and the master sinks '// &
         & 'in between them, all over the contact: the bodies have come nearer for nothing. '// &
         & 'The force of a given way is too low by that depth, the mean by the forces of the '// &
         & 'nodes, times the force over twice the work in the bodies, as far as it grows with '// &
         & 'its way in proportion. Of two equal blocks pressed together slaves of facets two, '// &
         & 'three and four times as long had 10, 11 and 37 % less force, and were told 10, 11 '// &
         & 'and 37; a cylinder on a block 28, 51 and 61 %, told 30, 52 and 59.', &
         & 'TYPE=SURFACE TO SURFACE; or take the side with the shorter facets as the slave.')
      call add_explanation(list, 'W0349', 'a master is curved within the facets of its slave', &
         & 'Surface to surface a node meets the mean of the gaps over its facets. Where the '// &
         & 'master is curved within them it is inside here and before them there, and how far '// &
         & 'the bodies have come is known to the mean of that room by the forces of the nodes. '// &
         & 'The figure is half of it, times the force over twice the work in the bodies. '// &
         & 'Crowned blocks under slave facets of a quarter to all of their side were 1 to '// &
         & '900 % off in force, told 5 to 90 (docs/theory.md).', &
         & 'facets half as long on the slave: a quarter of the room; or exchange slave and '// &
         & 'master.')
      call add_explanation(list, 'N0563', 'contact is hardly wider than a facet', &
         & 'Where curved bodies touch over few facets, the mesh does not show how wide the '// &
         & 'contact is: a force on one node sinks in by what a facet makes of it, deeper on '// &
         & 'finer ones, and pressures are forces over facets. Looked at where steps end: of '// &
         & 'contact in which no node has two rings of closed ones about it, the share of all '// &
         & 'work in the bodies, stored and plastic, that goes into the elements under its '// &
         & 'nodes. The figure is that share of itself. Balls and cylinders on one or two '// &
         & 'facets were 1 to 580 % off in force, told 16 to 100 (docs/theory.md). Where forces '// &
         & 'are given they are right, and the ways are off.', &
         & 'facets a quarter as long about the contact; *LOPIN, TARGET ERROR finds how fine '// &
         & 'they must be.')
      call add_explanation(list, 'W0563', 'contact is hardly wider than a facet', &
         & 'As N0563, but more than a tenth.', &
         & 'facets a quarter as long about the contact; *LOPIN, TARGET ERROR finds how fine '// &
         & 'they must be.')
   end subroutine coarse_contact

   !> Elements that bend otherwise than their bodies.
   subroutine coarse_bodies(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'N0565', 'work that the mesh adds', &
         & 'Elements that are too coarse, or that lock where bodies bend, strain otherwise '// &
         & 'than their neighbours. Looked at where steps end: the work of the stresses on what '// &
         & 'strains differ by from their means at nodes, beside all work. Of a cantilever of '// &
         & '20 elements along its length CPE3 and C3D4 in one to four layers made the work 5.3 '// &
         & 'to 2.5 times what it should be, told 87 to 60 %, and CPE4 and C3D8 1.1 to 1.5 '// &
         & 'times, told 35 to 43 %; words with I and second order were right to 0.1 %, and '// &
         & 'nothing is said of them.', &
         & 'words with I (CPE4I, C3D8I) or second order where bodies bend; a finer mesh '// &
         & 'elsewhere.')
      call add_explanation(list, 'W0565', 'work that the mesh adds', &
         & 'As N0565, but more than a tenth.', &
         & 'words with I (CPE4I, C3D8I) or second order where bodies bend; a finer mesh '// &
         & 'elsewhere.')
      call add_explanation(list, 'W0566', 'metal that bends in one layer', &
         & 'Quads and bricks of first order without I have two points across a layer. With '// &
         & 'one mean dilatation (CPE4, CAX4, C3D8) they carry two thirds of the plastic '// &
         & 'moment of a strip; without it (CPS4, FULL) 15 % more than it, and more yet where '// &
         & 'their straight edges keep the metal from bending in one place.', &
         & 'words with I (CPE4I, CPS4I, CAX4I, C3D8I), whose points follow the number of '// &
         & 'layers; or three layers and more.')
   end subroutine coarse_bodies
end module lopin_explain_facets
