!> Numbers of nodes and elements: their order, and none twice.
module lopin_build_labels
   use lopin_error, only : location_type, log_type
   use lopin_text, only : to_text
   use lopin_block, only : complain
   implicit none
   private
   public :: sort_labels, find_doubles

contains

   !> The permutation that sorts labels; decks are nearly always sorted already.
   pure subroutine sort_labels(label, order)
      integer, intent(in) :: label(:)
      integer, allocatable, intent(out) :: order(:)
      integer, allocatable :: from(:), to(:)
      integer :: n, i, width, low, middle, high

      n = size(label)
      order = [(i, i=1, n)]
      if (all(label(2:) > label(:max(0, n - 1)))) return
      from = order
      to = order
      width = 1
      do while (width < n)
         do low = 1, n, 2*width
            middle = min(low + width - 1, n)
            high = min(low + 2*width - 1, n)
            call merge_runs(label, from(low:middle), from(middle + 1:high), to(low:high))
         end do
         from = to
         width = 2*width
      end do
      order = from
   end subroutine sort_labels

   pure subroutine merge_runs(label, left, right, both)
      integer, intent(in) :: label(:), left(:), right(:)
      integer, intent(out) :: both(:)
      integer :: i, j, k

      i = 1
      j = 1
      do k = 1, size(both)
         if (j > size(right)) then
            both(k) = left(i)
            i = i + 1
         else if (i > size(left)) then
            both(k) = right(j)
            j = j + 1
         else if (label(left(i)) <= label(right(j))) then
            both(k) = left(i)
            i = i + 1
         else
            both(k) = right(j)
            j = j + 1
         end if
      end do
   end subroutine merge_runs

   subroutine find_doubles(log, what, label, order, file, line)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: what
      integer, intent(in) :: label(:), order(:)
      integer, intent(in) :: file(:), line(:)   !! where each was defined
      integer :: i, one, two

      do i = 2, size(order)
         one = order(i - 1)
         two = order(i)
         if (label(one) /= label(two)) cycle
         call complain(log, 'E0205', what//' '//to_text(label(one)) &
            & //' is defined twice, first in line ' &
            & //to_text(line(one)), location_type(file(two), line(two), 1, &
            & len(to_text(label(two)))))
      end do
   end subroutine find_doubles
end module lopin_build_labels
