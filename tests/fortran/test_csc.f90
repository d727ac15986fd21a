!> Tests of lopin_csc.
program test_csc
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type, storage
   use check, only : test, close_to, is_true, finish
   use matrices, only : elastic_block, random_general, random_spd, uniform
   implicit none

   call lists_make_the_coupled_pattern()
   call triplets_add_up()
   call long_columns_are_sorted()
   call products_agree_with_the_full_matrix()
   call finish()

contains

   subroutine lists_make_the_coupled_pattern()
      type(csc_type) :: a
      integer :: slots(3, 3)
      real(wp) :: dense(4, 4)

      call test('two lists sharing an equation couple within each list; prescribed ones do not')
      call a%new_from_lists(4, storage%symmetric_lower, [1, 4, 6], [3, 1, 0, 2, 3])
      call is_true('columns', all(a%colptr == [0, 2, 4, 5, 6]))
      call is_true('rows', all(a%row == [0, 2, 1, 2, 2, 3]))
      call is_true('missing entry', a%slot(2, 1) == 0)
      call is_true('mirrored entry', a%slot(1, 3) == 2)
      call a%element_slots([3, 1, 0], slots)
      call is_true('slots', all(slots == reshape([5, 0, 0, 2, 1, 0, 0, 0, 0], [3, 3])))
      call a%add_block(slots, reshape([1, 2, 3, 2, 4, 5, 3, 5, 6]*1.0_wp, [3, 3]))
      call is_true('adds', a%add(3, 2, 7.0_wp))
      call is_true('does not add', .not. a%add(1, 2, 7.0_wp))
      call a%to_dense(dense)
      call close_to('values', dense, reshape([4, 0, 2, 0, 0, 0, 7, 0, 2, 7, 1, 0, 0, 0, 0, &
         & 0]*1.0_wp, [4, 4]), 0.0_wp)
      call a%clear()
      call close_to('cleared', sum(abs(a%value)), 0.0_wp, 0.0_wp)
   end subroutine lists_make_the_coupled_pattern

   subroutine triplets_add_up()
      type(csc_type) :: a
      real(wp) :: dense(3, 3), d(3)

      call test('triplets at one place add up and mirror to the lower triangle')
      call a%new_from_triplets(3, storage%symmetric_lower, [1, 3, 1, 3], [1, 1, 3, 3], [1.0_wp, &
         & 2.0_wp, 3.0_wp, 4.0_wp])
      call a%to_dense(dense)
      call close_to('values', dense, reshape([1, 0, 5, 0, 0, 0, 5, 0, 4]*1.0_wp, [3, 3]), 0.0_wp)
      call a%diagonal(d)
      call close_to('diagonal', d, [1.0_wp, 0.0_wp, 4.0_wp], 0.0_wp)
      call a%new_from_triplets(3, storage%general, [3, 1, 1], [1, 3, 3], [2.0_wp, 3.0_wp, 4.0_wp])
      call a%to_dense(dense)
      call close_to('general', dense, reshape([0, 0, 2, 0, 0, 0, 7, 0, 0]*1.0_wp, [3, 3]), 0.0_wp)
   end subroutine triplets_add_up

   subroutine long_columns_are_sorted()
      type(csc_type) :: a
      integer :: i, k, seed, rows(1000)

      call test('a column of a thousand entries is sorted')
      seed = 5
      do i = 1, 1000
         rows(i) = 1 + int(uniform(seed)*2000)
      end do
      call a%new_from_triplets(2000, storage%general, rows, [(7, i=1, 1000)], [(1.0_wp, i=1, 1000)])
      k = a%colptr(7) + 1
      call is_true('ascending', all(a%row(k + 1:a%colptr(8)) > a%row(k:a%colptr(8) - 1)))
      call close_to('nothing lost', sum(a%value), 1000.0_wp, 0.0_wp)
   end subroutine long_columns_are_sorted

   subroutine products_agree_with_the_full_matrix()
      type(csc_type) :: a, full
      real(wp), allocatable :: x(:), y(:), r(:), dense(:, :), again(:, :)
      integer, allocatable :: source(:), top(:)
      integer :: seed, which, i

      call test('multiply, residual and expansion agree with the full matrix')
      seed = 11
      do which = 1, 3
         if (which == 1) call elastic_block([3, 2, 2], .true., a, top)
         if (which == 2) call random_general(50, 6, seed, a)
         if (which == 3) call random_spd(50, 6, seed, a)
         allocate (x(a%n), y(a%n), r(a%n), dense(a%n, a%n), again(a%n, a%n))
         x = [(uniform(seed), i=1, a%n)]
         call a%to_dense(dense)
         call a%multiply(x, y)
         call close_to('product', y, matmul(dense, x), 1.0e-13_wp)
         call a%residual(x, y, r)
         call close_to('residual', r, 0.0_wp*x, 1.0e-13_wp)
         call a%to_general(full, source)
         call full%to_dense(again)
         call close_to('expanded', again, dense, 0.0_wp)
         call close_to('source', full%value, a%value(source), 0.0_wp)
         deallocate (x, y, r, dense, again)
      end do
   end subroutine products_agree_with_the_full_matrix
end program test_csc
