!> Dual functions and areas of one slave facet in the plane, in dual numbers.
module lopin_mortar_dual_2d
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, constant, operator(+), operator(-), operator(*), operator(/), &
      & assignment(=)
   use lopin_mortar_cells_2d, only : line_shape
   implicit none
   private
   include 'mortar_dual_2d.inc'
end module lopin_mortar_dual_2d
