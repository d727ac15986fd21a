!> Tests of lopin_packed_blocks: the products of GMRES by packed blocks and by the blocks themselves.
program test_packed_blocks
   use lopin_kinds, only : wp
   use lopin_contact_block, only : block_type, add_product
   use lopin_firm_springs, only : push_back, give_back
   use lopin_packed_blocks, only : packed_blocks_type, pack_blocks, add_packed, push_packed, &
      & give_packed
   use check, only : test, close_to, is_true, finish
   use matrices, only : uniform
   implicit none
   integer :: seed = 5

   call same_products()
   call finish()

contains

   !> Nodes alone, with and without firm springs, open ones, springs without rows, facets, and blocks
   !> that read the places of nodes around them.
   subroutine same_products()
      integer, parameter :: neq = 40, nblock = 24
      integer, parameter :: nu(6) = [3, 3, 0, 2, 15, 3], rows(6) = [3, 3, 3, 0, 3, 3], &
         & around(6) = [0, 0, 0, 0, 0, 4]
      logical, parameter :: firm(6) = [.true., .false., .false., .false., .true., .true.]
      type(block_type) :: block(nblock)
      type(packed_blocks_type) :: packed
      real(wp) :: scale(3*nblock), area(3*nblock), x(neq + 3*nblock)
      real(wp), dimension(neq + 3*nblock) :: y, z
      integer :: b, kind, i, large

      do b = 1, nblock
         kind = 1 + mod(b, size(nu))
         call new_block(block(b), nu(kind), rows(kind), around(kind), firm(kind), neq, 3*b - 2)
      end do
      scale = [(1.0_wp + uniform(seed), i=1, size(scale))]
      area = [(1.0_wp + uniform(seed), i=1, size(area))]
      x = [(uniform(seed) - 0.5_wp, i=1, size(x))]
      call pack_blocks(packed, block, neq, scale, area)
      call test('which blocks are packed')
      large = count([(any(mod(b, size(nu)) == [4, 5]), b=1, nblock)])
      call is_true('number', packed%n == nblock - large .and. size(packed%large) == large)
      call test('packed products are those of the blocks, to the bit but for sums of rows')
      y = 0.0_wp
      z = 0.0_wp
      call add_packed(packed, x, y)
      do b = 1, nblock
         if (.not. any(packed%large == b)) call add_product(block(b), x, z)
      end do
      call close_to('product', y, z, 1.0e-15_wp)
      y = x
      z = x
      call push_packed(packed, y)
      do b = 1, nblock
         if (.not. any(packed%large == b)) call push_back(block(b), z(:neq), z)
      end do
      call close_to('pushed back', y, z, 1.0e-14_wp)
      call give_packed(packed, y)
      do b = 1, nblock
         if (.not. any(packed%large == b)) call give_back(block(b), neq, scale, area, z)
      end do
      call close_to('given back', y, z, 1.0e-13_wp)
   end subroutine same_products

   subroutine new_block(block, nu, rows, around, firm, neq, first_row)
      type(block_type), intent(inout) :: block
      integer, intent(in) :: nu, rows, around, neq, first_row
      logical, intent(in) :: firm
      integer :: n, i

      n = nu + rows + around
      block%nu = nu
      block%nrow = rows
      block%at = [(1 + mod(7*i + first_row, neq), i=1, nu), (neq + first_row + i, i=0, rows - 1), &
         & (1 + mod(11*i + first_row, neq), i=1, around)]
      block%k = reshape([(uniform(seed) - 0.5_wp, i=1, n*n)], [n, n])
      if (.not. firm) return
      block%inner = reshape([(uniform(seed) - 0.5_wp, i=1, rows*rows)], [rows, rows])
      block%firmness = [30.0_wp, 20.0_wp, 10.0_wp]
   end subroutine new_block
end program test_packed_blocks
