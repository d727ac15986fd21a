!> Products with sparse matrices by columns.
module lopin_csc_product
   use lopin_kinds, only : wp, ik
   implicit none
   private
   public :: multiply_general, multiply_symmetric

contains

   !> y = A x, all entries stored.
   pure subroutine multiply_general(n, colptr, nnz, row, value, x, y)
      integer, intent(in) :: n, nnz
      integer(ik), intent(in) :: colptr(n + 1), row(nnz)   !! 0-based
      real(wp), intent(in) :: value(nnz), x(n)
      real(wp), intent(out) :: y(n)
      integer :: j, k, p

      y = 0.0_wp
      do j = 1, n
         do k = colptr(j) + 1, colptr(j + 1)
            p = row(k) + 1
            y(p) = y(p) + value(k)*x(j)
         end do
      end do
   end subroutine multiply_general

   !> y = A x by the lower triangle, rows sorted in each column.
   pure subroutine multiply_symmetric(n, colptr, nnz, row, value, x, y)
      integer, intent(in) :: n, nnz
      integer(ik), intent(in) :: colptr(n + 1), row(nnz)   !! 0-based
      real(wp), intent(in) :: value(nnz), x(n)
      real(wp), intent(out) :: y(n)
      real(wp) :: above
      integer :: j, k, first, p

      y = 0.0_wp
      do j = 1, n
         first = colptr(j) + 1
         if (first > colptr(j + 1)) cycle
         if (row(first) + 1 == j) then
            y(j) = y(j) + value(first)*x(j)
            first = first + 1
         end if
         above = 0.0_wp
         do k = first, colptr(j + 1)
            p = row(k) + 1
            y(p) = y(p) + value(k)*x(j)
            above = above + value(k)*x(p)
         end do
         y(j) = y(j) + above
      end do
   end subroutine multiply_symmetric
end module lopin_csc_product
