!> Sparse matrices by columns: a pattern built once, values set many times.
!>
!> Symmetric matrices keep their lower triangle, rows sorted in each column, so that the
!> arrays go to CHOLMOD as they are. Indices are 0-based inside (`colptr`, `row`), as SuiteSparse wants.
module lopin_csc
   use lopin_kinds, only : wp, ik
   implicit none
   private
   public :: csc_type, storage

   type :: storages
      integer :: symmetric_lower = 1, general = 2
   end type storages
   type(storages), parameter :: storage = storages()

   type :: csc_type
      integer :: n = 0
      integer :: kind = 1                     !! storage%symmetric_lower or storage%general
      integer(ik), allocatable :: colptr(:)   !! (n+1) 0-based
      integer(ik), allocatable :: row(:)      !! (nnz) 0-based, sorted in each column
      real(wp), allocatable :: value(:)       !! (nnz)
   end type csc_type
end module lopin_csc
