!> The mortar row of one slave node in the plane, by values: lopin_mortar_node_2d.
module lopin_plain_node_2d
   use lopin_kinds, only : wp
   use lopin_plain, only : dual_type, constant, dual_norm, operator(+), operator(-), operator(*), &
      & operator(/), assignment(=)
   use lopin_mortar_patch_2d, only : patch_type, most_facets
   use lopin_plain_cells_2d, only : segment_type, integrate_segment, line_shape
   use lopin_plain_functions_2d, only : transform, whole, dual_function
   implicit none
   private
   include 'mortar_node_2d.inc'
end module lopin_plain_node_2d
