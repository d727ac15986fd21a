!> The sum of two sparse matrices of one size and storage, with the union of their patterns; and a
!> matrix among empty rows and columns.
module lopin_csc_sum
   use lopin_kinds, only : ik
   use lopin_csc, only : csc_type
   implicit none
   private
   public :: sum_of, widen

contains

   !> c = a + b, rows sorted in every column.
   subroutine sum_of(a, b, c)
      type(csc_type), intent(in) :: a, b
      type(csc_type), intent(out) :: c
      integer :: j, p, q, n

      c%n = a%n
      c%kind = a%kind
      allocate (c%colptr(a%n + 1), c%row(size(a%row) + size(b%row)), &
         & c%value(size(a%row) + size(b%row)))
      c%colptr(1) = 0_ik
      n = 0
      do j = 1, a%n
         p = a%colptr(j) + 1
         q = b%colptr(j) + 1
         do while (p <= a%colptr(j + 1) .or. q <= b%colptr(j + 1))
            n = n + 1
            if (q > b%colptr(j + 1)) then
               call take(a)
            else if (p > a%colptr(j + 1)) then
               call put(b, q)
            else if (a%row(p) < b%row(q)) then
               call take(a)
            else if (b%row(q) < a%row(p)) then
               call put(b, q)
            else
               call take(a)
               c%value(n) = c%value(n) + b%value(q)
               q = q + 1
            end if
         end do
         c%colptr(j + 1) = int(n, ik)
      end do
      c%row = c%row(:n)
      c%value = c%value(:n)

   contains

      subroutine take(from)
         type(csc_type), intent(in) :: from
         call put(from, p)
      end subroutine take

      subroutine put(from, at)
         type(csc_type), intent(in) :: from
         integer, intent(inout) :: at
         c%row(n) = from%row(at)
         c%value(n) = from%value(at)
         at = at + 1
      end subroutine put
   end subroutine sum_of

   !> The same matrix with empty rows and columns behind it.
   pure subroutine widen(a, n, wide)
      type(csc_type), intent(in) :: a
      integer, intent(in) :: n
      type(csc_type), intent(out) :: wide

      wide%n = n
      wide%kind = a%kind
      wide%row = a%row
      wide%value = a%value
      allocate (wide%colptr(n + 1))
      wide%colptr(:a%n + 1) = a%colptr
      wide%colptr(a%n + 2:) = a%colptr(a%n + 1)
   end subroutine widen
end module lopin_csc_sum
