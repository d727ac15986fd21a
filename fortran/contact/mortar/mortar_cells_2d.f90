!> One slave facet over one master facet in the plane: the segment both share, and its integrals.
!>
!> Both sides are projected along one field, the slave's nodal normals interpolated on its facet, so
!> that neighbouring facets neither gap nor overlap (Yang, Laursen, Meng 2005). Everything is in
!> dual numbers: slopes with respect to slave places, slave normals and master places come out with
!> the values, the moving ends of the segment included. For values alone pass constants.
module lopin_mortar_cells_2d
   use lopin_kinds, only : wp
   use lopin_mortar_overlap, only : least_type, meet_point
   use lopin_dual, only : dual_type, constant, operator(+), operator(-), operator(*), operator(/), &
      & sqrt, assignment(=)
   implicit none
   private
   include 'mortar_cells_2d.inc'
end module lopin_mortar_cells_2d
