!> Kinds used everywhere: one real, one default integer, one long integer.
module lopin_kinds
   use, intrinsic :: iso_fortran_env, only : real64, int32, int64
   implicit none
   private
   public :: wp, ik, lk

   integer, parameter :: wp = real64   !! working precision
   integer, parameter :: ik = int32    !! indices, as SuiteSparse's int
   integer, parameter :: lk = int64    !! counts that may pass 2**31
end module lopin_kinds
