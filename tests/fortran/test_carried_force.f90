program test_carried_force
   use lopin_kinds, only : wp
   use lopin_carried_force, only : skin_type, find_pieces, piece_areas, field_areas, lost_force
   use lopin_cells, only : cell_id
   use lopin_facets, only : new_facet_rules, facet_weights, middle_share
   use check, only : test, close_to, is_true, finish
   implicit none
   real(wp), parameter :: corners(2, 4) = reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 2.0_wp, &
      & 0.0_wp, 2.0_wp], [2, 4])
   type(skin_type) :: skin
   real(wp), allocatable :: x(:, :), w(:), area(:), p(:), normal(:, :)
   integer :: cell, n
   real(wp) :: lost, within

   call test('a uniform pressure carries its force on any face')
   do cell = cell_id%triangle, cell_id%quad8
      call one_face(cell)
      p = spread(3.0_wp, 1, n)
      call judge(p, p*w)
      call close_to('lost', lost, 0.0_wp, 1.0e-13_wp)
   end do

   call test('0 at the corners and 167 at the mid-sides carries two thirds too much')
   call one_face(cell_id%triangle6)
   ! Forces as the shape functions have them, areas of another basis.
   p = [0.0_wp, 0.0_wp, 0.0_wp, spread(sum(w)/3.0_wp, 1, 3)/w(4:6)]
   call close_to('printed', p(4:6), spread(5.0_wp/3.0_wp, 1, 3), 1.0e-13_wp)
   call judge(p, p*w)
   call close_to('lost', lost, 2.0_wp/3.0_wp, 1.0e-13_wp)
   call one_face(cell_id%quad8)
   p = [spread(-sum(w)/12.0_wp, 1, 4)/w(:4), spread(sum(w)/3.0_wp, 1, 4)/w(5:)]
   call judge(p, p*w)
   call is_true('quad8', lost > 0.2_wp)

   call test('weights that do not belong are found')
   do cell = cell_id%triangle, cell_id%quad8
      call one_face(cell)
      p = spread(3.0_wp, 1, n)
      call judge(p, 2.0_wp*p*w)
      call close_to('half', lost, 0.5_wp, 1.0e-13_wp)
      call judge(p, p*w/10.0_wp)
      call close_to('thickness', lost, 9.0_wp, 1.0e-12_wp)
   end do

   call test('so are right pressures at wrong nodes: by their moment')
   call one_face(cell_id%quad)
   p = [0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp]
   call judge(p, [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]*w)
   call is_true('lost', lost > 0.2_wp)

   call test('a roller along one edge is no fault: the rim says nothing of what lies between')
   do cell = cell_id%triangle, cell_id%quad8
      call one_face(cell)
      p = spread(0.0_wp, 1, n)
      p(:2) = 1.0_wp
      if (cell == cell_id%triangle6) p(4) = 1.3_wp
      if (cell == cell_id%quad8) p(5) = 1.3_wp
      call judge(p, p*w)
      call close_to('lost', lost, 0.0_wp, 1.0e-13_wp)
   end do

   call test('a strip one face wide has no face within: coarse, and no more')
   call three_faces()
   p = spread(0.0_wp, 1, n)
   p([2, 3, 6, 7]) = 3.0_wp
   p([10, 11, 14, 17]) = 1.4_wp
   call judge(p, p*w)
   call is_true('lost', lost > 0.2_wp)
   call close_to('within', within, 0.0_wp, 1.0e-13_wp)
   p = max(p, 1.0_wp)
   call judge(p, p*w)
   call is_true('pressed all over it is lost within', within > 0.1_wp)

   call test('where rows know what is covered their areas count')
   call one_face(cell_id%quad)
   skin%integrated = .true.
   w = w*[0.5_wp, 1.0_wp, 1.0_wp, 0.5_wp]
   p = spread(3.0_wp, 1, n)
   call judge(p, p*w)
   call close_to('lost', lost, 0.0_wp, 1.0e-13_wp)

   call test('on a sharp edge a node has the area of the face that is pressed')
   call top_and_side()
   call find_areas([1, 2, 3, 4, 5, 6], normal)
   call close_to('top', area(:4), spread(1.0_wp, 1, 4), 1.0e-13_wp)
   normal(:, 3:4) = spread([-1.0_wp, 0.0_wp, 0.0_wp], 2, 2)
   call find_areas([1, 2, 3, 4, 5, 6], normal)
   call close_to('side', area(3:4), spread(3.0_wp, 1, 2), 1.0e-13_wp)
   call find_areas([1, 2, 3, 3, 4, 5, 6], normal(:, [1, 2, 1, 3, 4, 5, 6]))
   call close_to('both, in the corner of a tool', area(3:4), [1.0_wp, 3.0_wp], 1.0e-13_wp)
   call finish()

contains

   !> One face in the plane z = 0, its outside down, and the areas of its nodes.
   subroutine one_face(cell)
      integer, intent(in) :: cell
      integer :: k, c

      skin = skin_type(in_use=.true.)
      allocate (skin%rules(6))
      call new_facet_rules(skin%rules)
      associate (r => skin%rules(cell)%cell)
         n = r%nnode
         c = r%ncorner
         if (allocated(x)) deallocate (x)
         allocate (x(3, n), source=0.0_wp)
         x(:2, :c) = corners(:, [1, (k, k=c, 2, -1)])
         do k = 1, n - c
            x(:, c + k) = 0.5_wp*(x(:, r%edge(1, k)) + x(:, r%edge(2, k)))
         end do
      end associate
      call list([cell], reshape([(k, k=1, n)], [n, 1]))
      normal = spread([0.0_wp, 0.0_wp, 1.0_wp], 2, n)
      if (allocated(w)) deallocate (w)
      allocate (w(n))
      call facet_weights(skin%rules(cell), x, .false., w, skin%share(1))
   end subroutine one_face

   !> Three faces of eight nodes in a row, two by two each: corners, mid-sides across, and along.
   subroutine three_faces()
      real(wp) :: own(8)
      integer :: i, node(8, 3)

      n = 18
      do i = 1, 3
         node(:, i) = [i, 4 + i, 5 + i, 1 + i, 8 + i, 15 + i, 9 + i, 12 + i]
      end do
      x = reshape([([2.0_wp*i, 0.0_wp, 0.0_wp], i=0, 3), ([2.0_wp*i, 2.0_wp, 0.0_wp], i=0, 3), &
         & ([2.0_wp*i, 1.0_wp, 0.0_wp], i=0, 3), ([2.0_wp*i + 1.0_wp, 0.0_wp, 0.0_wp], i=0, 2), &
         & ([2.0_wp*i + 1.0_wp, 2.0_wp, 0.0_wp], i=0, 2)], [3, n])
      skin = skin_type(in_use=.true.)
      allocate (skin%rules(6))
      call new_facet_rules(skin%rules)
      call list(spread(cell_id%quad8, 1, 3), node)
      normal = spread([0.0_wp, 0.0_wp, 1.0_wp], 2, n)
      w = spread(0.0_wp, 1, n)
      do i = 1, 3
         call facet_weights(skin%rules(cell_id%quad8), x(:, node(:, i)), .false., own, &
            & skin%share(i))
         w(node(:, i)) = w(node(:, i)) + own
      end do
   end subroutine three_faces

   !> A top of 2 by 2 and a side of 2 by 4, 8 facets long edges in common: nodes 3 and 4.
   subroutine top_and_side()
      skin = skin_type(in_use=.true., is_sharp=.true.)
      allocate (skin%rules(6))
      call new_facet_rules(skin%rules)
      x = reshape([0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 2.0_wp, 0.0_wp, &
         & 2.0_wp, 0.0_wp, 0.0_wp, 2.0_wp, 2.0_wp, -6.0_wp, 2.0_wp, 0.0_wp, -6.0_wp], [3, 6])
      call list([cell_id%quad, cell_id%quad], reshape([1, 4, 3, 2, 4, 6, 5, 3], [4, 2]))
      skin%piece = [1, 2]
      normal = spread([0.0_wp, 0.0_wp, -1.0_wp], 2, 6)
      normal(:, 5:) = 0.0_wp
   end subroutine top_and_side

   subroutine find_areas(node, normal)
      integer, intent(in) :: node(:)
      real(wp), intent(in) :: normal(:, :)
      integer :: piece(size(node))

      if (allocated(area)) deallocate (area)
      allocate (area(size(node)))
      call find_pieces(skin, x, node, normal, spread(.true., 1, size(node)), piece)
      call piece_areas(skin, x, node, piece, area)
   end subroutine find_areas

   subroutine list(cell, node)
      integer, intent(in) :: cell(:), node(:, :)
      integer :: i, m

      m = size(node, 1)
      skin%facets%n = size(cell)
      skin%facets%cell = cell
      skin%facets%nnode = spread(m, 1, size(cell))
      allocate (skin%facets%node(8, size(cell)), source=0)
      skin%facets%node(:m, :) = node
      skin%thickness = spread(1.0_wp, 1, size(cell))
      skin%piece = spread(1, 1, size(cell))
      skin%share = [(middle_share(skin%rules(cell(i)), x(:, node(:, i)), .false.), &
         & i=1, size(cell))]
   end subroutine list

   subroutine judge(pressure, push)
      real(wp), intent(in) :: pressure(:), push(:)
      real(wp) :: both(n, 2)
      integer :: i

      call field_areas(skin, x, [(i, i=1, n)], normal, pressure, w, both)
      lost = lost_force(pressure, both(:, 1), spread(push, 1, 3)*normal, normal, x)
      within = lost_force(pressure, both(:, 2), spread(push, 1, 3)*normal, normal, x)
   end subroutine judge
end program test_carried_force
