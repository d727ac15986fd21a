!> Small blocks of contact points one behind the other in memory, for the products of GMRES.
!>
!> A block of a point alone has some six equations, and thousands of them are gone through for each
!> iteration: what they cost is to find them. The operations are those of lopin_contact_block and
!> lopin_firm_springs in the same order. Blocks of ties, those that read equations around them (of
!> areas, of stresses), and large ones are left where they are.
module lopin_packed_blocks
   use lopin_kinds, only : wp
   use lopin_contact_block, only : block_type
   implicit none
   private
   public :: packed_blocks_type, pack_blocks, add_packed, push_packed, give_packed

   !> Equations of a block up to which it is small.
   integer, parameter :: small = 12

   type :: packed_blocks_type
      integer :: n = 0                         !! blocks
      integer, allocatable :: large(:)         !! blocks that are not here
      integer, allocatable :: first(:)         !! (n + 1) in `at`
      integer, allocatable :: first_value(:)   !! (n + 1) in `k`
      integer, allocatable :: nu(:)            !! (n) equations, multipliers come behind them
      integer, allocatable :: inner_at(:)      !! (n) in `inner`; 0: none
      integer, allocatable :: at(:)
      real(wp), allocatable :: k(:)            !! by columns
      real(wp), allocatable :: inner(:)        !! (ndim, ndim) of each, by columns
      real(wp), allocatable :: back(:)         !! (at) firmness times c of its rows
   end type packed_blocks_type

contains

   !> Copies of all small blocks.
   subroutine pack_blocks(self, block, neq, scale, area)
      type(packed_blocks_type), intent(out) :: self
      type(block_type), intent(in) :: block(:)
      integer, intent(in) :: neq
      real(wp), intent(in) :: scale(:), area(:)    !! (nmultiplier)
      logical :: is_small(size(block))
      integer :: b, m, entries, values, inners

      entries = 0
      values = 0
      inners = 0
      do b = 1, size(block)
         is_small(b) = .not. (allocated(block(b)%glue) .or. allocated(block(b)%by_bound)) &
            & .and. size(block(b)%at) == block(b)%nu + block(b)%nrow &
            & .and. size(block(b)%at) <= small
         if (.not. is_small(b)) cycle
         entries = entries + size(block(b)%at)
         values = values + size(block(b)%at)**2
         if (allocated(block(b)%inner)) inners = inners + size(block(b)%inner)
      end do
      self%n = count(is_small)
      self%large = pack([(b, b=1, size(block))], .not. is_small)
      allocate (self%first(self%n + 1), self%first_value(self%n + 1), self%nu(self%n), &
         & self%inner_at(self%n), self%at(entries), self%k(values), self%inner(inners))
      allocate (self%back(entries), source=0.0_wp)
      self%first(1) = 1
      self%first_value(1) = 1
      m = 0
      inners = 0
      do b = 1, size(block)
         if (.not. is_small(b)) cycle
         m = m + 1
         call put_block(self, m, inners, block(b))
         if (self%inner_at(m) > 0) call put_back(self, m, neq, scale, area, block(b)%firmness)
      end do
   end subroutine pack_blocks

   !> One behind those before.
   pure subroutine put_block(self, m, inners, block)
      type(packed_blocks_type), intent(inout) :: self
      integer, intent(in) :: m
      integer, intent(inout) :: inners             !! entries of `inner` so far
      type(block_type), intent(in) :: block
      integer :: n, d

      n = size(block%at)
      associate (from => self%first(m), value => self%first_value(m))
         self%nu(m) = block%nu
         self%first(m + 1) = from + n
         self%first_value(m + 1) = value + n*n
         self%at(from:from + n - 1) = block%at
         self%k(value:value + n*n - 1) = reshape(block%k, [n*n])
      end associate
      self%inner_at(m) = 0
      if (.not. allocated(block%inner)) return
      d = size(block%inner, 1)
      self%inner_at(m) = inners + 1
      self%inner(inners + 1:inners + d*d) = reshape(block%inner, [d*d])
      inners = inners + d*d
   end subroutine put_block

   !> What firm springs have taken of the tractions: firmness times c of its rows.
   pure subroutine put_back(self, m, neq, scale, area, firmness)
      type(packed_blocks_type), intent(inout) :: self
      integer, intent(in) :: m, neq
      real(wp), intent(in) :: scale(:), area(:)    !! (nmultiplier)
      real(wp), intent(in) :: firmness(:)          !! (3) of its rows [-]
      integer :: i, from

      from = self%first(m) + self%nu(m)
      do i = from, self%first(m + 1) - 1
         associate (row => self%at(i) - neq)
            self%back(i) = firmness(i - from + 1)*(scale(row)/area(row))
         end associate
      end do
   end subroutine put_back

   !> Add the products, rows not yet as forces.
   pure subroutine add_packed(self, x, y)
      type(packed_blocks_type), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(inout) :: y(:)
      integer :: b, i, j, k

      do b = 1, self%n
         k = self%first_value(b)
         do j = self%first(b), self%first(b + 1) - 1
            do i = self%first(b), self%first(b + 1) - 1
               y(self%at(i)) = y(self%at(i)) + self%k(k)*x(self%at(j))
               k = k + 1
            end do
         end do
      end do
   end subroutine add_packed

   !> dl of each block, and what it leaves of the forces.
   pure subroutine push_packed(self, y)
      type(packed_blocks_type), intent(in) :: self
      real(wp), intent(inout) :: y(:)          !! forces, dl behind them
      real(wp) :: l(small), own(small)
      integer :: b, i, j, k, d, nu, row

      do b = 1, self%n
         nu = self%nu(b)
         row = self%first(b) + nu
         d = self%first(b + 1) - row
         if (d == 0) cycle
         do i = 1, d
            l(i) = y(self%at(row + i - 1))
         end do
         if (self%inner_at(b) > 0) then
            own(:d) = 0.0_wp
            k = self%inner_at(b)
            do j = 1, d
               do i = 1, d
                  own(i) = own(i) + self%inner(k)*l(j)
                  k = k + 1
               end do
            end do
            l(:d) = own(:d)
            do i = 1, d
               y(self%at(row + i - 1)) = l(i)
            end do
         end if
         k = self%first_value(b) + nu*(nu + d)
         do j = 1, d
            do i = 0, nu - 1
               associate (at => self%at(self%first(b) + i))
                  y(at) = y(at) - self%k(k + i)*l(j)
               end associate
            end do
            k = k + nu + d
         end do
      end do
   end subroutine push_packed

   !> dl of the true unknowns.
   pure subroutine give_packed(self, y)
      type(packed_blocks_type), intent(in) :: self
      real(wp), intent(inout) :: y(:)
      real(wp) :: l(small)
      integer :: b, i, j, k, d, nu, row

      do b = 1, self%n
         if (self%inner_at(b) == 0) cycle
         nu = self%nu(b)
         row = self%first(b) + nu
         d = self%first(b + 1) - row
         do i = 1, d
            l(i) = y(self%at(row + i - 1))
         end do
         k = self%first_value(b) + nu
         do j = self%first(b), row - 1
            do i = 1, d
               l(i) = l(i) - self%back(row + i - 1)*self%k(k + i - 1)*y(self%at(j))
            end do
            k = k + nu + d
         end do
         do i = 1, d
            y(self%at(row + i - 1)) = l(i)
         end do
      end do
   end subroutine give_packed
end module lopin_packed_blocks
