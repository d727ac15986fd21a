!> Integers in order.
module lopin_sorting
   implicit none
   private
   public :: sort

contains

   !> Ascending; by insertion while short, else by heap (a tool's equation may meet thousands).
   pure subroutine sort(a)
      integer, intent(inout) :: a(:)
      integer :: i, j, v, n

      n = size(a)
      if (n <= 100) then
         do i = 2, n
            v = a(i)
            j = i - 1
            do while (j >= 1)
               if (a(j) <= v) exit
               a(j + 1) = a(j)
               j = j - 1
            end do
            a(j + 1) = v
         end do
         return
      end if
      do i = n/2, 1, -1
         call sift(a, i, n)
      end do
      do i = n, 2, -1
         v = a(1)
         a(1) = a(i)
         a(i) = v
         call sift(a, 1, i - 1)
      end do
   end subroutine sort

   pure subroutine sift(a, first, n)
      integer, intent(inout) :: a(:)
      integer, intent(in) :: first, n
      integer :: parent, child, v

      v = a(first)
      parent = first
      do
         child = 2*parent
         if (child > n) exit
         if (child < n) then
            if (a(child + 1) > a(child)) child = child + 1
         end if
         if (a(child) <= v) exit
         a(parent) = a(child)
         parent = child
      end do
      a(parent) = v
   end subroutine sift
end module lopin_sorting
