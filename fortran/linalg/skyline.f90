!> Symmetric matrices by profile, and their factorisation A = L D L^T.
!>
!> Rows are kept in blocks: block i holds rows start(i) .. start(i+1)-1 from the first column of its
!> longest row up to the diagonal, as one dense rectangle, rows running fastest. So nearly all the
!> work is done by matrix products (BLAS-3), with a few explicit zeros at the ragged left edge.
module lopin_skyline
   use lopin_kinds, only : wp, lk
   use lopin_blas, only : dgemm, dgemv, dtrsm, dtrsv
   implicit none
   private
   public :: skyline_type

   type :: skyline_type
      integer :: n = 0
      integer :: nblock = 0
      integer, allocatable :: start(:)       !! (nblock+1) first row of each block
      integer, allocatable :: first(:)       !! (nblock) first column, at the start of a block
      integer, allocatable :: block_of(:)    !! (n) block of each row
      integer(lk), allocatable :: at(:)   !! (nblock+1) place before the first entry of each block
      real(wp), allocatable :: value(:)      !! A, after factorisation L (unit diagonal implied)
      real(wp), allocatable :: pivot(:)      !! (n) D
   contains
      procedure :: new => new_skyline
      procedure :: place
      procedure :: factorise
      procedure :: forward
      procedure :: backward
      procedure :: entry_of
   end type skyline_type

contains

   !> Storage for a profile; a block begins at row `split`.
   subroutine new_skyline(self, first, split)
      class(skyline_type), intent(out) :: self
      integer, intent(in) :: first(:)   !! (n) first column of each row
      integer, intent(in) :: split      !! 1..n+1
      integer :: width, i, b, from, n

      n = size(first)
      self%n = n
      width = block_width(first)
      allocate (self%block_of(n), self%pivot(n))
      allocate (self%start(n + 2), self%first(n + 1))
      b = 0
      from = 1
      do while (from <= n)
         b = b + 1
         self%start(b) = from
         i = min(from + width, n + 1)
         if (from < split) i = min(i, split)
         self%block_of(from:i - 1) = b
         self%first(b) = self%start(self%block_of(minval(first(from:i - 1))))
         from = i
      end do
      self%nblock = b
      self%start(b + 1) = n + 1
      self%start = self%start(:b + 1)
      self%first = self%first(:b)
      allocate (self%at(b + 1))
      self%at(1) = 0
      do i = 1, b
         self%at(i + 1) = self%at(i) + int(self%start(i + 1) - self%start(i), lk) &
            & *int(self%start(i + 1) - self%first(i), lk)
      end do
      allocate (self%value(self%at(b + 1)))
   end subroutine new_skyline

   !> Rows in a block: enough for matrix products, few enough to follow the profile.
   pure integer function block_width(first) result(width)
      integer, intent(in) :: first(:)
      real(wp) :: mean
      integer :: i

      mean = 0.0_wp
      do i = 1, size(first)
         mean = mean + real(i - first(i), wp)/real(size(first), wp)
      end do
      width = min(64, max(4, 4*nint(mean/16.0_wp)))
   end function block_width

   !> Index in `value` of entry (row, column), row >= column, inside the profile.
   elemental integer(lk) function place(self, row, column)
      class(skyline_type), intent(in) :: self
      integer, intent(in) :: row, column
      integer :: b

      b = self%block_of(row)
      place = self%at(b) + int(self%start(b + 1) - self%start(b), lk)*(column - self%first(b)) &
         & + row - self%start(b) + 1
   end function place

   !> Entry of L (or of A before factorisation), zero outside the profile.
   elemental real(wp) function entry_of(self, row, column)
      class(skyline_type), intent(in) :: self
      integer, intent(in) :: row, column

      entry_of = 0.0_wp
      if (column < self%first(self%block_of(row)) .or. row < column) return
      entry_of = self%value(self%place(row, column))
   end function entry_of

   !> A <- L D L^T without exchanges; stops at the first pivot that is too small.
   !>
   !> `ratio` is the smallest |pivot| over the sum of the moduli of the terms that formed it.
   subroutine factorise(self, tolerance, bad, ratio)
      class(skyline_type), intent(inout) :: self
      real(wp), intent(in) :: tolerance   !! smallest ratio taken for a pivot
      integer, intent(out) :: bad         !! row of the refused pivot, or 0
      real(wp), intent(out) :: ratio
      real(wp), allocatable :: scaled(:)
      real(wp) :: size_of(maxval(self%start(2:) - self%start(:self%nblock)))
      integer :: i, m, width, row
      integer(lk) :: p, diagonal

      allocate (scaled(maxval(self%at(2:) - self%at(:self%nblock))))
      bad = 0
      ratio = huge(1.0_wp)
      do i = 1, self%nblock
         m = self%start(i + 1) - self%start(i)
         width = self%start(i) - self%first(i)
         p = self%at(i)
         do row = 1, m
            size_of(row) = abs(self%value(p + int(m, lk)*(width + row - 1) + row))
         end do
         call reduce_row(self, i)
         diagonal = p + int(m, lk)*width
         if (width > 0) then
            call divide(m, width, self%pivot(self%first(i)), self%value(p + 1), scaled, size_of)
            call dgemm('N', 'T', m, m, width, -1.0_wp, self%value(p + 1), m, scaled, m, 1.0_wp, &
               & self%value(diagonal + 1), m)
         end if
         call factorise_diagonal(m, self%value(diagonal + 1:diagonal + m*m), size_of(:m), &
            & tolerance, self%pivot(self%start(i):self%start(i + 1) - 1), bad, ratio)
         if (bad > 0) then
            bad = bad + self%start(i) - 1
            return
         end if
      end do
   end subroutine factorise

   !> Split the left part of a block row: from L D to L and, apart, L D; adds |L D L| to the sizes.
   pure subroutine divide(m, width, pivot, left, scaled, size_of)
      integer, intent(in) :: m, width
      real(wp), intent(in) :: pivot(width)
      real(wp), intent(inout) :: left(m, width)
      real(wp), intent(out) :: scaled(m, width)
      real(wp), intent(inout) :: size_of(m)
      integer :: k

      scaled = left
      do k = 1, width
         left(:, k) = scaled(:, k)/pivot(k)
         size_of = size_of + abs(scaled(:, k)*left(:, k))
      end do
   end subroutine divide

   !> Left part of block row i: from A to L D.
   subroutine reduce_row(self, i)
      class(skyline_type), intent(inout) :: self
      integer, intent(in) :: i
      integer :: j, m, mj, from, k
      integer(lk) :: own, other, target

      if (self%first(i) == self%start(i)) return
      m = self%start(i + 1) - self%start(i)
      do j = self%block_of(self%first(i)), i - 1
         mj = self%start(j + 1) - self%start(j)
         from = max(self%first(i), self%first(j))
         k = self%start(j) - from
         target = self%at(i) + int(m, lk)*(self%start(j) - self%first(i)) + 1
         if (k > 0) then
            own = self%at(i) + int(m, lk)*(from - self%first(i)) + 1
            other = self%at(j) + int(mj, lk)*(from - self%first(j)) + 1
            call dgemm('N', 'T', m, mj, k, -1.0_wp, self%value(own), m, self%value(other), mj, &
               & 1.0_wp, self%value(target), m)
         end if
         other = self%at(j) + int(mj, lk)*(self%start(j) - self%first(j)) + 1
         call dtrsm('R', 'L', 'T', 'U', m, mj, 1.0_wp, self%value(other), mj, self%value(target), m)
      end do
   end subroutine reduce_row

   !> L D L^T of a dense diagonal block, lower triangle.
   pure subroutine factorise_diagonal(m, a, size_of, tolerance, pivot, bad, ratio)
      integer, intent(in) :: m
      real(wp), intent(inout) :: a(m, m)
      real(wp), intent(inout) :: size_of(:)   !! (m) moduli of the terms in each diagonal
      real(wp), intent(in) :: tolerance
      real(wp), intent(out) :: pivot(:)       !! (m)
      integer, intent(out) :: bad
      real(wp), intent(inout) :: ratio
      integer :: j, k
      real(wp) :: l(m)

      bad = 0
      do j = 1, m
         pivot(j) = a(j, j)
         if (.not. abs(pivot(j)) > tolerance*size_of(j)) then
            bad = j
            ratio = 0.0_wp
            if (size_of(j) > 0.0_wp) ratio = abs(pivot(j))/size_of(j)
            return
         end if
         ratio = min(ratio, abs(pivot(j))/size_of(j))
         l(j + 1:) = a(j + 1:, j)/pivot(j)
         do k = j + 1, m
            a(k:, k) = a(k:, k) - l(k:)*a(k, j)
            size_of(k) = size_of(k) + abs(l(k)*a(k, j))
         end do
         a(j + 1:, j) = l(j + 1:)
      end do
   end subroutine factorise_diagonal

   !> x <- L^-1 x.
   subroutine forward(self, nrhs, x)
      class(skyline_type), intent(in) :: self
      integer, intent(in) :: nrhs
      real(wp), intent(inout) :: x(self%n, nrhs)
      integer :: i, m, width, s
      integer(lk) :: p

      do i = 1, self%nblock
         s = self%start(i)
         m = self%start(i + 1) - s
         width = s - self%first(i)
         p = self%at(i) + 1
         if (width > 0 .and. nrhs == 1) then
            call dgemv('N', m, width, -1.0_wp, self%value(p), m, x(self%first(i), 1), 1, 1.0_wp, &
               & x(s, 1), 1)
         else if (width > 0) then
            call dgemm('N', 'N', m, nrhs, width, -1.0_wp, self%value(p), m, x(self%first(i), 1), &
               & self%n, 1.0_wp, x(s, 1), self%n)
         end if
         if (nrhs == 1) then
            call dtrsv('L', 'N', 'U', m, self%value(p + int(m, lk)*width), m, x(s, 1), 1)
         else
            call dtrsm('L', 'L', 'N', 'U', m, nrhs, 1.0_wp, self%value(p + int(m, lk)*width), m, &
               & x(s, 1), self%n)
         end if
      end do
   end subroutine forward

   !> x <- L^-T x.
   subroutine backward(self, nrhs, x)
      class(skyline_type), intent(in) :: self
      integer, intent(in) :: nrhs
      real(wp), intent(inout) :: x(self%n, nrhs)
      integer :: i, m, width, s
      integer(lk) :: p

      do i = self%nblock, 1, -1
         s = self%start(i)
         m = self%start(i + 1) - s
         width = s - self%first(i)
         p = self%at(i) + 1
         if (nrhs == 1) then
            call dtrsv('L', 'T', 'U', m, self%value(p + int(m, lk)*width), m, x(s, 1), 1)
         else
            call dtrsm('L', 'L', 'T', 'U', m, nrhs, 1.0_wp, self%value(p + int(m, lk)*width), m, &
               & x(s, 1), self%n)
         end if
         if (width > 0 .and. nrhs == 1) then
            call dgemv('T', m, width, -1.0_wp, self%value(p), m, x(s, 1), 1, 1.0_wp, &
               & x(self%first(i), 1), 1)
         else if (width > 0) then
            call dgemm('T', 'N', width, nrhs, m, -1.0_wp, self%value(p), m, x(s, 1), self%n, &
               & 1.0_wp, x(self%first(i), 1), self%n)
         end if
      end do
   end subroutine backward
end module lopin_skyline
