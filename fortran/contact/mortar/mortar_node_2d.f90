!> The mortar row of one slave node in the plane, in dual numbers: for exact tangents of finite
!> sliding.
!>
!> The row depends on the facets at the node, on their other neighbours by the nodal normals, and
!> on the master facets that these cover, as lopin_mortar_patch_2d lists them. `mortar_row` gives
!> the weight, normal, mean gap and coefficients with their slopes by all places of the list: those
!> of the dual basis, of the normals and of the moving ends of the segments. A node may take over
!> the functions of others: lopin_mortar_cover.
module lopin_mortar_node_2d
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, dual_norm, operator(+), operator(-), operator(*), &
      & operator(/), assignment(=)
   use lopin_mortar_patch_2d, only : patch_type, most_facets
   use lopin_mortar_cells_2d, only : segment_type, integrate_segment, line_shape
   use lopin_mortar_dual_2d, only : transform, whole, dual_function
   implicit none
   private
   include 'mortar_node_2d.inc'
end module lopin_mortar_node_2d
