!> Forward-mode derivatives: a number together with its slopes along a few directions.
!>
!> A kernel written in dual numbers gives its exact first derivatives beside its value (Wengert
!> 1964; no step, no truncation). Values of branches are compared by `%v`. A kernel of more inputs
!> than `dual_width` is run once for each block of directions.
module lopin_dual
   use lopin_kinds, only : wp
   implicit none
   private

   integer, parameter :: dual_width = 16
   include 'dual.inc'
end module lopin_dual
