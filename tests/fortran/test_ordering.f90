!> Tests of lopin_graph and lopin_ordering.
program test_ordering
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_graph, only : node_graph_type, number_interior, postorder
   use lopin_ordering, only : delay, profile_cost, profile_order, reverse_cuthill_mckee, row_starts
   use check, only : test, close_to, is_true, finish
   use matrices, only : elastic_block, uniform
   implicit none

   call nodes_are_found()
   call paths_have_bandwidth_one()
   call strips_are_numbered_across()
   call last_equations_stay_last()
   call multipliers_are_delayed()
   call postorders_keep_children_before_parents()
   call finish()

contains

   logical function is_permutation(order)
      integer, intent(in) :: order(:)
      integer :: i
      is_permutation = all([(count(order == i) == 1, i=1, size(order))])
   end function is_permutation

   subroutine nodes_are_found()
      type(csc_type) :: a
      type(node_graph_type) :: graph
      integer, allocatable :: top(:), local(:), order(:)
      integer :: m, i
      logical :: valid

      call test('the equations of a node have equal neighbours and make one group')
      call elastic_block([5, 4, 3], .true., a, top)
      call number_interior(a%n, [integer ::], local, m, valid)
      call graph%new(a, local, m)
      call is_true('nodes', graph%ngroup == 5*5*4 .and. all(graph%weight == 3))
      call is_true('three in a row', all([(all(graph%group(3*i - 2:3*i) == i), i=1, 100)]))
      order = graph%equations_by([(i, i=100, 1, -1)])
      call is_true('expanded', all(order(:6) == [298, 299, 300, 295, 296, 297]))
      call is_true('permutation', is_permutation(order))
      call number_interior(a%n, [4, 4], local, m, valid)
      call is_true('named twice', .not. valid)
      call number_interior(a%n, [0], local, m, valid)
      call is_true('no equation', .not. valid)
      call number_interior(a%n, [4, 1], local, m, valid)
      call is_true('valid', valid .and. m == a%n - 2 .and. local(2) == 1 .and. local(4) == 0)
   end subroutine nodes_are_found

   subroutine paths_have_bandwidth_one()
      integer :: order(7), at(7), k

      call test('two paths in one graph, numbered anyhow, get consecutive numbers')
      ! 1-4-2-6 and 5-3-7
      call reverse_cuthill_mckee([1, 2, 4, 6, 8, 9, 10, 11], [4, 4, 6, 5, 7, 1, 2, 3, 2, 3], order)
      call is_true('permutation', is_permutation(order))
      at(order) = [(k, k=1, 7)]
      call is_true('first path', abs(at(1) - at(4)) == 1 .and. abs(at(4) - at(2)) == 1 &
         & .and. abs(at(2) - at(6)) == 1)
      call is_true('second path', abs(at(5) - at(3)) == 1 .and. abs(at(3) - at(7)) == 1)
   end subroutine paths_have_bandwidth_one

   subroutine strips_are_numbered_across()
      type(csc_type) :: a
      integer, allocatable :: top(:), order(:)
      integer :: first(2*200*5), i
      logical :: valid

      call test('a strip of 5 nodes across has rows of at most 2 lines of nodes and 4 more')
      call elastic_block([200, 4], .true., a, top)
      call profile_order(a, top(:0), order, valid)
      call is_true('permutation', valid .and. is_permutation(order))
      first = row_starts(a, order)
      call is_true('band', maxval([(i - first(i), i=1, a%n)]) <= 2*14)
      call close_to('cost', profile_cost([1, 1, 3]), 1.0_wp + 4.0_wp + 1.0_wp, 0.0_wp)
   end subroutine strips_are_numbered_across

   subroutine last_equations_stay_last()
      type(csc_type) :: a
      integer, allocatable :: top(:), order(:), last(:)
      logical :: valid

      call test('equations to be kept last come last, in the order given')
      call elastic_block([12, 5], .true., a, top)
      last = top(size(top):1:-1)
      call profile_order(a, last, order, valid)
      call is_true('permutation', valid .and. is_permutation(order))
      call is_true('last', all(order(a%n - size(last) + 1:) == last))
   end subroutine last_equations_stay_last

   subroutine multipliers_are_delayed()
      integer :: order(5)

      call test('a multiplier moves just behind the last of its neighbours')
      ! path 1-2-3-4, multiplier 5 on 1 and 2
      order = [5, 1, 2, 3, 4]
      call delay([1, 3, 6, 8, 9, 11], [2, 5, 1, 3, 5, 2, 4, 3, 1, 2], [.false., .false., .false., &
         & .false., .true.], order)
      call is_true('behind 2', all(order == [1, 2, 5, 3, 4]))
   end subroutine multipliers_are_delayed

   subroutine postorders_keep_children_before_parents()
      integer :: parent(200), count(200), order(200), at(200), trial, i, seed, n_interior
      logical :: good

      call test('postorders: children first, subtrees together, the last ones behind')
      seed = 17
      do trial = 1, 20
         do i = 1, 199
            parent(i) = min(200, i + 1 + int(uniform(seed)*8))
            count(i) = 1 + int(uniform(seed)*50)
         end do
         parent(200) = 0
         count(200) = 1
         n_interior = 100 + 5*trial
         call postorder(parent, count, n_interior, order)
         call is_true('permutation', is_permutation(order))
         at(order) = [(i, i=1, 200)]
         good = .true.
         do i = 1, 199
            good = good .and. at(i) < at(parent(i))
         end do
         call is_true('children first', good)
         call is_true('behind', all(at(n_interior + 1:) > n_interior))
      end do
      call postorder([3, 3, 4, 0], [2, 5, 2, 1], 4, order(:4))
      call is_true('the long column next to its parent', all(order(:4) == [1, 2, 3, 4]))
      call postorder([3, 3, 4, 0], [5, 2, 2, 1], 4, order(:4))
      call is_true('the long column next to its parent, the other way', all(order(:4) == [2, 1, &
         & 3, 4]))
   end subroutine postorders_keep_children_before_parents
end program test_ordering
