!> Dual numbers without slopes: kernels that are written in dual numbers, for their values alone.
!>
!> A kernel is the body of two modules (a file .inc): one uses lopin_dual, the other this one under
!> the same names.
module lopin_plain
   use lopin_kinds, only : wp
   implicit none
   private

   integer, parameter :: dual_width = 0
   include 'dual.inc'
end module lopin_plain
