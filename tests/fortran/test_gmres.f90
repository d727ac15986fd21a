!> An operator for the tests.
module dense_operator
   use lopin_kinds, only : wp
   use lopin_gmres, only : operator_type
   implicit none
   private
   public :: dense_type

   !> A dense matrix preconditioned by its diagonal.
   type, extends(operator_type) :: dense_type
      real(wp), allocatable :: a(:, :)
      integer :: products = 0
   contains
      procedure :: multiply
      procedure :: precondition
   end type dense_type

contains

   subroutine multiply(self, x, y)
      class(dense_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      self%products = self%products + 1
      y = matmul(self%a, x)
   end subroutine multiply

   subroutine precondition(self, x, y)
      class(dense_type), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: i
      do i = 1, size(x)
         y(i) = x(i)/self%a(i, i)
      end do
   end subroutine precondition
end module dense_operator

!> Tests of lopin_gmres and lopin_csc_sum against dense algebra.
program test_gmres
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_csc_sum, only : sum_of
   use lopin_gmres, only : gmres
   use dense_operator, only : dense_type
   use check, only : test, close_to, is_true, finish
   use matrices, only : uniform
   implicit none
   integer :: seed = 7

   call solves_what_it_should()
   call says_how_far_it_came()
   call zero_right_hand_side()
   call sums_of_patterns()
   call finish()

contains

   function random_operator(n) result(a)
      integer, intent(in) :: n
      type(dense_type) :: a
      integer :: i, j

      allocate (a%a(n, n))
      do j = 1, n
         do i = 1, n
            a%a(i, j) = 2.0_wp*uniform(seed) - 1.0_wp
         end do
         a%a(j, j) = a%a(j, j) + 0.5_wp*n
      end do
   end function random_operator

   subroutine solves_what_it_should()
      type(dense_type) :: a
      real(wp) :: x(30), exact(30), ratio
      integer :: i, iterations

      call test('an unsymmetric system is solved in at most n iterations')
      a = random_operator(30)
      exact = [(uniform(seed), i=1, 30)]
      call gmres(a, matmul(a%a, exact), 1.0e-13_wp, 30, x, iterations, ratio)
      call close_to('solution', x, exact, 1.0e-11_wp)
      call is_true('ratio', ratio <= 1.0e-12_wp)
      call is_true('iterations', iterations <= 30 .and. iterations == a%products)
   end subroutine solves_what_it_should

   subroutine says_how_far_it_came()
      type(dense_type) :: a
      real(wp) :: x(40), b(40), ratio
      integer :: i, iterations

      call test('the ratio told is the true residual')
      a = random_operator(40)
      b = [(uniform(seed), i=1, 40)]
      call gmres(a, b, 1.0e-13_wp, 4, x, iterations, ratio)
      call is_true('all iterations', iterations == 4)
      call close_to('ratio', norm2(b - matmul(a%a, x))/norm2(b), ratio, 1.0e-12_wp)
   end subroutine says_how_far_it_came

   subroutine zero_right_hand_side()
      type(dense_type) :: a
      real(wp) :: x(3), ratio
      integer :: iterations

      call test('nothing is solved for nothing')
      a = random_operator(3)
      call gmres(a, [0.0_wp, 0.0_wp, 0.0_wp], 1.0e-13_wp, 4, x, iterations, ratio)
      call close_to('x', x, [0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp)
      call is_true('iterations', iterations == 0)
   end subroutine zero_right_hand_side

   subroutine sums_of_patterns()
      type(csc_type) :: a, b, c
      real(wp) :: da(4, 4), db(4, 4), dc(4, 4)
      integer :: kind

      call test('the sum of two matrices has the union of their patterns')
      do kind = 1, 2
         call a%new_from_triplets(4, kind, [1, 3, 4], [1, 1, 2], [1.0_wp, 2.0_wp, 3.0_wp])
         call b%new_from_triplets(4, kind, [2, 3, 4, 4], [1, 1, 2, 3], [1.0_wp, 5.0_wp, -3.0_wp, &
            & 7.0_wp])
         call sum_of(a, b, c)
         call a%to_dense(da)
         call b%to_dense(db)
         call c%to_dense(dc)
         call close_to('values', dc, da + db, 0.0_wp)
         call is_true('kind', c%kind == a%kind .and. c%n == 4)
         call is_true('sorted', sorted(c))
      end do
   end subroutine sums_of_patterns

   logical function sorted(a)
      type(csc_type), intent(in) :: a
      integer :: j

      sorted = .true.
      do j = 1, a%n
         associate (row => a%row(a%colptr(j) + 1:a%colptr(j + 1)))
            sorted = sorted .and. all(row(2:) > row(:size(row) - 1))
         end associate
      end do
   end function sorted
end program test_gmres
