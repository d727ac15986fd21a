!> The part of T^T K T that dependent dofs make: rows of K among dofs that are combinations of
!> equations, spread to these.
!>
!> With s a dependent dof, T_s its combination, and X_s = K_s T the row of K on the equations, the
!> part is the sum over s of T_s^T X_s and of the transpose of what plain dofs give to X_s. Columns
!> are made one by one, so that no product is stored twice.
module lopin_spread_matrix
   use lopin_kinds, only : wp, ik
   use lopin_sorting, only : sort
   use lopin_csc, only : csc_type, storage
   use lopin_constraints, only : constraints_type
   implicit none
   private
   public :: spread_matrix

   !> Rows of a sparse matrix, and by columns.
   type :: rows_type
      integer, allocatable :: first(:), at(:)
      real(wp), allocatable :: value(:)
   end type rows_type

   !> A sum by places, as long as it is filled.
   type :: heap_type
      integer :: n = 0
      integer, allocatable :: place(:)         !! (n) filled
      real(wp), allocatable :: value(:)        !! (nplace)
      logical, allocatable :: filled(:)        !! (nplace)
   end type heap_type

contains

   !> Lower triangle on the equations.
   subroutine spread_matrix(k, constraints, number, n, plain, spread)
      type(csc_type), intent(in) :: k                         !! (ndof) lower triangle
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:)   !! (neq) row of the reduced matrix; 0: left out
      integer, intent(in) :: n           !! rows of the reduced matrix
      logical, intent(in) :: plain(:)    !! (ndof) dofs that are one equation, or prescribed
      type(csc_type), intent(out) :: spread
      type(rows_type) :: terms, beside, all, by_plain, columns, heads

      call find_terms(constraints, number, plain, terms)
      call rows_of(k, plain, beside)
      call on_equations(beside, constraints, number, n, plain, .false., all)
      call on_equations(beside, constraints, number, n, plain, .true., by_plain)
      call transpose_rows(all, n, columns)
      call transpose_rows(terms, n, heads)
      call sum_columns(n, terms, by_plain, columns, heads, spread)
   end subroutine spread_matrix

   !> T_s of the dependent dofs, in their order.
   subroutine find_terms(constraints, number, plain, terms)
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:)
      logical, intent(in) :: plain(:)
      type(rows_type), intent(out) :: terms
      integer :: i, c, m, s

      m = 0
      do i = 1, size(plain)
         if (.not. plain(i)) m = m + constraints%first(i + 1) - constraints%first(i)
      end do
      allocate (terms%first(count(.not. plain) + 1), terms%at(m), terms%value(m))
      m = 0
      s = 0
      terms%first(1) = 1
      do i = 1, size(plain)
         if (plain(i)) cycle
         s = s + 1
         do c = constraints%first(i), constraints%first(i + 1) - 1
            if (number(constraints%equation(c)) == 0) cycle
            m = m + 1
            terms%at(m) = number(constraints%equation(c))
            terms%value(m) = constraints%coefficient(c)
         end do
         terms%first(s + 1) = m + 1
      end do
   end subroutine find_terms

   !> Whole rows of K of the dependent dofs, by dofs.
   subroutine rows_of(k, plain, rows)
      type(csc_type), intent(in) :: k
      logical, intent(in) :: plain(:)
      type(rows_type), intent(out) :: rows
      integer :: at(size(plain)), i, j, s, entry, pass

      at = 0
      do pass = 1, 2
         do j = 1, k%n
            do entry = k%colptr(j) + 1, k%colptr(j + 1)
               i = k%row(entry) + 1
               if (.not. plain(i)) call put(i, j)
               if (i /= j .and. .not. plain(j)) call put(j, i)
            end do
         end do
         if (pass == 2) exit
         allocate (rows%first(count(.not. plain) + 1))
         s = 0
         rows%first(1) = 1
         do i = 1, size(plain)
            if (plain(i)) cycle
            s = s + 1
            rows%first(s + 1) = rows%first(s) + at(i)
            at(i) = rows%first(s)
         end do
         allocate (rows%at(rows%first(s + 1) - 1), rows%value(rows%first(s + 1) - 1))
      end do

   contains

      subroutine put(row, column)
         integer, intent(in) :: row, column

         if (pass == 2) then
            rows%at(at(row)) = column
            rows%value(at(row)) = k%value(entry)
         end if
         at(row) = at(row) + 1
      end subroutine put
   end subroutine rows_of

   !> Rows by dofs as rows by equations.
   subroutine on_equations(rows, constraints, number, n, plain, only_plain, out)
      type(rows_type), intent(in) :: rows
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:), n
      logical, intent(in) :: plain(:), only_plain
      type(rows_type), intent(out) :: out
      type(heap_type) :: heap
      integer :: s, k, c, total

      call new_heap(heap, n)
      allocate (out%first(size(rows%first)), out%at(size(rows%at)), out%value(size(rows%at)))
      total = 0
      out%first(1) = 1
      do s = 1, size(rows%first) - 1
         do k = rows%first(s), rows%first(s + 1) - 1
            associate (dof => rows%at(k))
               if (only_plain .and. .not. plain(dof)) cycle
               do c = constraints%first(dof), constraints%first(dof + 1) - 1
                  if (number(constraints%equation(c)) > 0) call add(heap, &
                     & number(constraints%equation(c)), rows%value(k)*constraints%coefficient(c))
               end do
            end associate
         end do
         call pour(heap, out%at, out%value, total)
         out%first(s + 1) = total + 1
      end do
      out%at = out%at(:total)
      out%value = out%value(:total)
   end subroutine on_equations

   subroutine transpose_rows(rows, n, columns)
      type(rows_type), intent(in) :: rows
      integer, intent(in) :: n
      type(rows_type), intent(out) :: columns
      integer :: at(n), s, k

      at = 0
      do k = 1, rows%first(size(rows%first)) - 1
         at(rows%at(k)) = at(rows%at(k)) + 1
      end do
      allocate (columns%first(n + 1), columns%at(sum(at)), columns%value(sum(at)))
      columns%first(1) = 1
      do k = 1, n
         columns%first(k + 1) = columns%first(k) + at(k)
      end do
      at = columns%first(:n)
      do s = 1, size(rows%first) - 1
         do k = rows%first(s), rows%first(s + 1) - 1
            columns%at(at(rows%at(k))) = s
            columns%value(at(rows%at(k))) = rows%value(k)
            at(rows%at(k)) = at(rows%at(k)) + 1
         end do
      end do
   end subroutine transpose_rows

   !> Column by column: the sum over s of X_s at the column times T_s, and of T_s at the column
   !> times what plain dofs give to X_s.
   subroutine sum_columns(n, terms, by_plain, columns, heads, spread)
      integer, intent(in) :: n
      type(rows_type), intent(in) :: terms, by_plain, columns, heads
      type(csc_type), intent(out) :: spread
      type(heap_type) :: heap
      integer, allocatable :: row(:)
      real(wp), allocatable :: value(:)
      integer :: j, total

      call new_heap(heap, n)
      allocate (row(size(columns%at)), value(size(columns%at)))
      allocate (spread%colptr(n + 1))
      spread%n = n
      spread%kind = storage%symmetric_lower
      spread%colptr(1) = 0_ik
      total = 0
      do j = 1, n
         call gather(columns, terms)
         call gather(heads, by_plain)
         call pour(heap, row, value, total)
         spread%colptr(j + 1) = int(total, ik)
      end do
      spread%row = int(row(:total) - 1, ik)
      spread%value = value(:total)

   contains

      subroutine gather(shares, rows)
         type(rows_type), intent(in) :: shares, rows
         integer :: i, k

         do i = shares%first(j), shares%first(j + 1) - 1
            do k = rows%first(shares%at(i)), rows%first(shares%at(i) + 1) - 1
               if (rows%at(k) >= j) call add(heap, rows%at(k), shares%value(i)*rows%value(k))
            end do
         end do
      end subroutine gather
   end subroutine sum_columns

   subroutine new_heap(heap, n)
      type(heap_type), intent(out) :: heap
      integer, intent(in) :: n

      allocate (heap%place(n), heap%value(n), heap%filled(n))
      heap%filled = .false.
   end subroutine new_heap

   subroutine add(heap, place, value)
      type(heap_type), intent(inout) :: heap
      integer, intent(in) :: place
      real(wp), intent(in) :: value

      if (heap%filled(place)) then
         heap%value(place) = heap%value(place) + value
         return
      end if
      heap%filled(place) = .true.
      heap%value(place) = value
      heap%n = heap%n + 1
      heap%place(heap%n) = place
   end subroutine add

   !> Append what is filled, places increasing, and empty it.
   subroutine pour(heap, at, value, total)
      type(heap_type), intent(inout) :: heap
      integer, allocatable, intent(inout) :: at(:)
      real(wp), allocatable, intent(inout) :: value(:)
      integer, intent(inout) :: total

      if (heap%n == 0) return
      if (total + heap%n > size(at)) then
         at = [at, at, heap%place(:heap%n)]
         value = [value, value, heap%value(heap%place(:heap%n))]
      end if
      call sort(heap%place(:heap%n))
      at(total + 1:total + heap%n) = heap%place(:heap%n)
      value(total + 1:total + heap%n) = heap%value(heap%place(:heap%n))
      heap%filled(heap%place(:heap%n)) = .false.
      total = total + heap%n
      heap%n = 0
   end subroutine pour
end module lopin_spread_matrix
