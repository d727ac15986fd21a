!> Dual functions and areas of one slave facet in the plane, by values: lopin_mortar_dual_2d.
module lopin_plain_functions_2d
   use lopin_kinds, only : wp
   use lopin_plain, only : dual_type, constant, operator(+), operator(-), operator(*), &
      & operator(/), assignment(=)
   use lopin_plain_cells_2d, only : line_shape
   implicit none
   private
   include 'mortar_dual_2d.inc'
end module lopin_plain_functions_2d
