!> What a Fortran test needs: compare, count, and stop with the number of failures.
module check
   use lopin_kinds, only : wp
   implicit none
   private
   public :: test, close_to, is_true, equal_text, finish

   integer :: passed = 0, failed = 0
   character(len=:), allocatable :: current   !! the sentence under test

   interface close_to
      module procedure close_scalar, close_vector, close_matrix
   end interface close_to

contains

   !> Name the sentence that the following comparisons establish.
   subroutine test(sentence)
      character(len=*), intent(in) :: sentence
      current = sentence
   end subroutine test

   !> |actual - expected| <= tolerance*max(1, |expected|).
   subroutine close_scalar(what, actual, expected, tolerance)
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: actual, expected, tolerance
      call close_vector(what, [actual], [expected], tolerance)
   end subroutine close_scalar

   subroutine close_matrix(what, actual, expected, tolerance)
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: actual(:, :), expected(:, :), tolerance

      if (any(shape(actual) /= shape(expected))) then
         call fail(what//' has another shape than what is expected')
         return
      end if
      call close_vector(what, reshape(actual, [size(actual)]), &
         & reshape(expected, [size(expected)]), tolerance)
   end subroutine close_matrix

   !> Nothing compared is no success: vectors have the same length, and at least one component.
   subroutine close_vector(what, actual, expected, tolerance)
      character(len=*), intent(in) :: what
      real(wp), intent(in) :: actual(:), expected(:), tolerance
      integer :: i

      if (size(actual) /= size(expected) .or. size(expected) == 0) then
         call fail(what//' is not as long as what is expected, or empty')
         return
      end if
      do i = 1, size(expected)
         if (.not. abs(actual(i) - expected(i)) <= tolerance*max(1.0_wp, abs(expected(i)))) then
            failed = failed + 1
            print '(a,": ",a,"(",i0,") = ",g0,", expected ",g0)', current, what, i, actual(i), &
               & expected(i)
            return
         end if
      end do
      passed = passed + 1
   end subroutine close_vector

   subroutine is_true(what, condition)
      character(len=*), intent(in) :: what
      logical, intent(in) :: condition
      if (condition) then
         passed = passed + 1
      else
         call fail('not true: '//what)
      end if
   end subroutine is_true

   subroutine fail(reason)
      character(len=*), intent(in) :: reason
      failed = failed + 1
      print '(a,": ",a)', current, reason
   end subroutine fail

   subroutine equal_text(what, actual, expected)
      character(len=*), intent(in) :: what, actual, expected
      call is_true(what//": '"//actual//"' is '"//expected//"'", actual == expected)
   end subroutine equal_text

   !> Print the count and stop; non-zero when anything failed, or nothing was compared.
   subroutine finish()
      print '(i0," passed, ",i0," failed")', passed, failed
      if (failed > 0 .or. passed == 0) stop 1, quiet=.true.
   end subroutine finish
end module check
