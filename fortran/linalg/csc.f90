!> Sparse matrices by columns: a pattern built once, values set many times.
!>
!> Symmetric matrices keep their lower triangle, rows sorted in each column, so that the
!> arrays go to CHOLMOD as they are. Indices (`colptr`, `row`) are 0-based, as SuiteSparse wants.
module lopin_csc
   use lopin_kinds, only : wp, ik
   use lopin_csc_product, only : multiply_general, multiply_symmetric
   use lopin_sorting, only : sort
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
   contains
      procedure :: new_from_lists
      procedure :: new_from_triplets
      procedure :: slot
      procedure :: element_slots
      procedure :: add
      procedure :: add_block
      procedure :: clear
      procedure :: multiply
      procedure :: residual
      procedure :: diagonal
      procedure :: to_general
      procedure :: to_dense
   end type csc_type

contains

   !> Pattern in which the equations of each list (an element, a contact) are coupled; values zero.
   !>
   !> Every diagonal entry is present, so that a free equation shows as a zero pivot, not as a gap.
   subroutine new_from_lists(self, n, kind, ptr, equation)
      class(csc_type), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: kind          !! storage%...
      integer, intent(in) :: ptr(:)   !! (nlist+1) 1-based: list e is equation(ptr(e):ptr(e+1)-1)
      integer, intent(in) :: equation(:)   !! 1-based equations; <= 0 is skipped (prescribed)
      integer, allocatable :: start(:), list(:), stamp(:), column(:)
      integer :: e, i, j, k, m, total

      self%n = n
      self%kind = kind
      call lists_of_each(n, ptr, equation, start, list)
      allocate (self%colptr(n + 1), stamp(n), column(n))
      allocate (self%row(max(n, size(equation))))
      stamp = 0
      total = 0
      self%colptr(1) = 0
      do j = 1, n
         stamp(j) = j
         m = 1
         column(1) = j
         do k = start(j), start(j + 1) - 1
            do e = ptr(list(k)), ptr(list(k) + 1) - 1
               i = equation(e)
               if (i <= 0) cycle
               if (kind == storage%symmetric_lower .and. i < j) cycle
               if (stamp(i) == j) cycle
               stamp(i) = j
               m = m + 1
               column(m) = i
            end do
         end do
         call sort(column(:m))
         call append(self%row, total, column(:m) - 1)
         self%colptr(j + 1) = total
      end do
      self%row = self%row(:total)
      allocate (self%value(total), source=0.0_wp)
   end subroutine new_from_lists

   !> Pattern and values from entries (i, j, value); entries at one place add up.
   !>
   !> For symmetric storage an entry above the diagonal is taken to its mirror place, so give each
   !> pair once. Every diagonal entry is present.
   subroutine new_from_triplets(self, n, kind, i, j, value)
      class(csc_type), intent(out) :: self
      integer, intent(in) :: n
      integer, intent(in) :: kind          !! storage%...
      integer, intent(in) :: i(:), j(:)    !! 1-based
      real(wp), intent(in) :: value(:)
      integer, allocatable :: at(:)
      integer :: k, c, m, from, till, total, rows(size(i)), columns(size(i))

      self%n = n
      self%kind = kind
      rows = i
      columns = j
      if (kind == storage%symmetric_lower) then
         rows = max(i, j)
         columns = min(i, j)
      end if
      allocate (at(n + 1), self%colptr(n + 1))
      at = 0
      do k = 1, size(i)
         at(columns(k)) = at(columns(k)) + 1
      end do
      at = at + 1   ! room for the diagonal
      m = 0
      do c = 1, n
         self%colptr(c) = m
         m = m + at(c)
         at(c) = self%colptr(c) + 1
      end do
      self%colptr(n + 1) = m
      allocate (self%row(m))
      do k = 1, size(i)
         self%row(at(columns(k))) = rows(k) - 1
         at(columns(k)) = at(columns(k)) + 1
      end do
      total = 0
      do c = 1, n
         from = self%colptr(c) + 1
         till = at(c)
         self%row(till) = c - 1
         call sort(self%row(from:till))
         self%colptr(c) = total
         do k = from, till
            if (k > from) then
               if (self%row(k) == self%row(total)) cycle
            end if
            total = total + 1
            self%row(total) = self%row(k)
         end do
      end do
      self%colptr(n + 1) = total
      self%row = self%row(:total)
      allocate (self%value(total), source=0.0_wp)
      do k = 1, size(i)
         m = self%slot(rows(k), columns(k))
         self%value(m) = self%value(m) + value(k)
      end do
   end subroutine new_from_triplets

   !> Index in `value` of entry (i, j), 0 if it is not in the pattern; symmetric storage mirrors.
   pure integer function slot(self, i, j)
      class(csc_type), intent(in) :: self
      integer, intent(in) :: i, j   !! 1-based
      integer :: low, high, middle, r, c

      r = i
      c = j
      if (self%kind == storage%symmetric_lower) then
         r = max(i, j)
         c = min(i, j)
      end if
      slot = 0
      low = self%colptr(c) + 1
      high = self%colptr(c + 1)
      do while (low <= high)
         middle = (low + high)/2
         if (self%row(middle) == r - 1) then
            slot = middle
            return
         else if (self%row(middle) < r - 1) then
            low = middle + 1
         else
            high = middle - 1
         end if
      end do
   end function slot

   !> Where the entries of an element matrix go: 0 for a prescribed equation, and, with symmetric
   !> storage, for the upper one of each mirrored pair.
   pure subroutine element_slots(self, equation, slots)
      class(csc_type), intent(in) :: self
      integer, intent(in) :: equation(:)      !! (m) 1-based; <= 0 is prescribed
      integer, intent(out) :: slots(:, :)     !! (m, m) index in `value`, or 0
      integer :: i, j

      slots = 0
      do j = 1, size(equation)
         if (equation(j) <= 0) cycle
         do i = 1, size(equation)
            if (equation(i) <= 0) cycle
            if (self%kind == storage%symmetric_lower .and. equation(i) < equation(j)) cycle
            slots(i, j) = self%slot(equation(i), equation(j))
         end do
      end do
   end subroutine element_slots

   !> Add to entry (i, j), which must be in the pattern; false (and nothing done) if it is not.
   logical function add(self, i, j, value) result(found)
      class(csc_type), intent(inout) :: self
      integer, intent(in) :: i, j
      real(wp), intent(in) :: value
      integer :: k

      k = self%slot(i, j)
      found = k > 0
      if (found) self%value(k) = self%value(k) + value
   end function add

   !> Add an element matrix by its slots (see element_slots).
   pure subroutine add_block(self, slots, block)
      class(csc_type), intent(inout) :: self
      integer, intent(in) :: slots(:, :)      !! (m, m)
      real(wp), intent(in) :: block(:, :)     !! (m, m)
      integer :: i, j

      do j = 1, size(block, 2)
         do i = 1, size(block, 1)
            if (slots(i, j) > 0) self%value(slots(i, j)) = self%value(slots(i, j)) + block(i, j)
         end do
      end do
   end subroutine add_block

   !> Set all values to zero.
   pure subroutine clear(self)
      class(csc_type), intent(inout) :: self
      self%value = 0.0_wp
   end subroutine clear

   !> y = A x.
   pure subroutine multiply(self, x, y)
      class(csc_type), intent(in) :: self
      real(wp), intent(in) :: x(:)    !! (n)
      real(wp), intent(out) :: y(:)   !! (n)

      associate (n => self%n, p => self%colptr, nnz => size(self%row))
         if (self%kind == storage%symmetric_lower) then
            call multiply_symmetric(n, p, nnz, self%row, self%value, x, y)
         else
            call multiply_general(n, p, nnz, self%row, self%value, x, y)
         end if
      end associate
   end subroutine multiply

   !> r = b - A x.
   pure subroutine residual(self, x, b, r)
      class(csc_type), intent(in) :: self
      real(wp), intent(in) :: x(:), b(:)   !! (n)
      real(wp), intent(out) :: r(:)        !! (n)

      call self%multiply(x, r)
      r = b - r
   end subroutine residual

   !> The diagonal; zero where the pattern has no diagonal entry.
   pure subroutine diagonal(self, d)
      class(csc_type), intent(in) :: self
      real(wp), intent(out) :: d(:)   !! (n)
      integer :: j, k

      do j = 1, self%n
         ! In a lower triangle it is first in its column.
         k = 0
         if (self%kind == storage%symmetric_lower .and. self%colptr(j) < self%colptr(j + 1)) then
            if (self%row(self%colptr(j) + 1) == j - 1) k = self%colptr(j) + 1
         else
            k = self%slot(j, j)
         end if
         d(j) = 0.0_wp
         if (k > 0) d(j) = self%value(k)
      end do
   end subroutine diagonal

   !> The same matrix with both triangles stored; `source` says where each value comes from.
   !>
   !> With a fixed pattern, new values follow by full%value = self%value(source).
   pure subroutine to_general(self, full, source)
      class(csc_type), intent(in) :: self
      type(csc_type), intent(out) :: full
      integer, allocatable, intent(out) :: source(:)   !! (nnz of full) index in self%value
      integer :: at(self%n), j, k, i, total

      full%n = self%n
      full%kind = storage%general
      if (self%kind == storage%general) then
         full%colptr = self%colptr
         full%row = self%row
         full%value = self%value
         source = [(k, k=1, size(self%row))]
         return
      end if
      at = 0
      do j = 1, self%n
         do k = self%colptr(j) + 1, self%colptr(j + 1)
            i = self%row(k) + 1
            at(j) = at(j) + 1
            if (i /= j) at(i) = at(i) + 1
         end do
      end do
      allocate (full%colptr(self%n + 1))
      total = 0
      do j = 1, self%n
         full%colptr(j) = total
         total = total + at(j)
         at(j) = full%colptr(j)
      end do
      full%colptr(self%n + 1) = total
      allocate (full%row(total), source(total))
      ! Columns in ascending order: the mirrored rows of a column arrive sorted and before its own.
      do j = 1, self%n
         do k = self%colptr(j) + 1, self%colptr(j + 1)
            i = self%row(k) + 1
            at(j) = at(j) + 1
            full%row(at(j)) = i - 1
            source(at(j)) = k
            if (i == j) cycle
            at(i) = at(i) + 1
            full%row(at(i)) = j - 1
            source(at(i)) = k
         end do
      end do
      full%value = self%value(source)
   end subroutine to_general

   !> The matrix with all its zeros.
   pure subroutine to_dense(self, dense)
      class(csc_type), intent(in) :: self
      real(wp), intent(out) :: dense(:, :)   !! (n, n)
      integer :: j, k, i

      dense = 0.0_wp
      do j = 1, self%n
         do k = self%colptr(j) + 1, self%colptr(j + 1)
            i = self%row(k) + 1
            dense(i, j) = self%value(k)
            if (self%kind == storage%symmetric_lower) dense(j, i) = self%value(k)
         end do
      end do
   end subroutine to_dense

   !> For each equation the lists in which it stands.
   pure subroutine lists_of_each(n, ptr, equation, start, list)
      integer, intent(in) :: n, ptr(:), equation(:)
      integer, allocatable, intent(out) :: start(:)   !! (n+1)
      integer, allocatable, intent(out) :: list(:)
      integer :: at(n), e, k, i

      at = 0
      do k = 1, size(equation)
         if (equation(k) > 0) at(equation(k)) = at(equation(k)) + 1
      end do
      allocate (start(n + 1))
      start(1) = 1
      do i = 1, n
         start(i + 1) = start(i) + at(i)
         at(i) = start(i)
      end do
      allocate (list(start(n + 1) - 1))
      do e = 1, size(ptr) - 1
         do k = ptr(e), ptr(e + 1) - 1
            i = equation(k)
            if (i <= 0) cycle
            list(at(i)) = e
            at(i) = at(i) + 1
         end do
      end do
   end subroutine lists_of_each

   pure subroutine append(array, n, more)
      integer(ik), allocatable, intent(inout) :: array(:)
      integer, intent(inout) :: n
      integer, intent(in) :: more(:)
      integer(ik), allocatable :: grown(:)

      if (n + size(more) > size(array)) then
         allocate (grown(2*(n + size(more))))
         grown(:n) = array(:n)
         call move_alloc(grown, array)
      end if
      array(n + 1:n + size(more)) = more
      n = n + size(more)
   end subroutine append
end module lopin_csc
