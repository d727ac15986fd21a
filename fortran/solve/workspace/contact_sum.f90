!> The sum of the exact matrices of contact points, where the whole matrix is factorised.
module lopin_contact_sum
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type, storage
   use lopin_contact_block, only : block_type, entries_of, put_entries, find_matrix
   implicit none
   private
   public :: add_up_contacts

   !> Corrections of tractions give way so much, beside c, where the whole matrix is factorised: a
   !> traction that works on supports alone (shear on the axis) is then none, and not undetermined.
   real(wp), parameter :: give = 1.0e-11_wp
   !> Entries of a row below which nothing can meet it.
   real(wp), parameter :: counts = 1.0e-6_wp

contains

   !> All contacts, and the little by which tractions give way.
   subroutine add_up_contacts(block, neq, scale, area, contacts)
      type(block_type), intent(in) :: block(:)
      integer, intent(in) :: neq
      real(wp), intent(in) :: scale(:), area(:)    !! (nmultiplier)
      type(csc_type), intent(out) :: contacts
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
      logical, allocatable :: acts(:)
      integer :: total, b, i

      total = 0
      do b = 1, size(block)
         total = total + entries_of(block(b))
      end do
      total = total + size(area)
      allocate (row(total), column(total), value(total))
      acts = acting_rows(block, neq, scale, area)
      total = 0
      do i = neq + 1, neq + size(area)
         total = total + 1
         row(total) = i
         column(total) = i
         value(total) = area(i - neq)
         if (acts(i - neq)) value(total) = give*value(total)
      end do
      do b = 1, size(block)
         i = total + entries_of(block(b))
         call put_entries(block(b), row(total + 1:i), column(total + 1:i), value(total + 1:i))
         total = i
      end do
      do i = size(area) + 1, total
         if (row(i) > neq) value(i) = value(i)*scale(row(i) - neq)
      end do
      call contacts%new_from_triplets(neq + size(area), storage%general, row, column, value)
   end subroutine add_up_contacts

   !> Rows that a free motion or a traction of their own can meet. That of a node which supports
   !> hold on a tool that stands still is none: its pressure goes by its penetration, c of it.
   pure function acting_rows(block, neq, scale, area) result(acts)
      type(block_type), intent(in) :: block(:)
      integer, intent(in) :: neq
      real(wp), intent(in) :: scale(:), area(:)
      logical, allocatable :: acts(:)
      real(wp), allocatable :: k(:, :)
      real(wp) :: most(size(area)), part
      integer :: b, i, j, row

      most = 0.0_wp
      do b = 1, size(block)
         call find_matrix(block(b), k)
         associate (at => block(b)%at, nu => block(b)%nu)
            do i = nu + 1, nu + block(b)%nrow
               row = at(i) - neq
               do j = 1, size(at)
                  part = abs(k(i, j))
                  if (at(j) > neq) part = part*scale(row)/area(row)
                  most(row) = max(most(row), part)
               end do
            end do
         end associate
      end do
      acts = most > counts
   end function acting_rows
end module lopin_contact_sum
