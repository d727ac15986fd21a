!> One slave facet over one master facet in the plane, by values: lopin_mortar_cells_2d.
module lopin_plain_cells_2d
   use lopin_kinds, only : wp
   use lopin_mortar_overlap, only : least_type, meet_point
   use lopin_plain, only : dual_type, constant, operator(+), operator(-), operator(*), &
      & operator(/), sqrt, assignment(=)
   implicit none
   private
   include 'mortar_cells_2d.inc'
end module lopin_plain_cells_2d
