!> Surfaces for the tests of the contact search: wavy sheets and cubes of every facet cell.
module search_scenes
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_cells, only : cell_type, cell_id, new_cell_of
   use lopin_facets, only : facets_type
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type, build_tree
   use check, only : is_true
   implicit none
   private
   public :: scene_type, make_sheet, make_cube, start, follow, allocate_facets

   !> A surface, its nodes and its tree.
   type :: scene_type
      type(surface_type) :: surface
      type(tree_type) :: tree
      real(wp), allocatable :: x(:, :)
   end type scene_type

contains

   !> A wavy sheet over [0, 1]^2 (in the plane: a wavy line over [0, 1], its outside above).
   subroutine make_sheet(scene, cell, n, wave)
      type(scene_type), intent(out) :: scene
      integer, intent(in) :: cell, n
      real(wp), intent(in) :: wave
      type(facets_type) :: facets
      type(cell_type) :: shape
      integer :: i, j, k, m, corner(2, 4), row

      call new_cell_of(shape, cell)
      row = 2*n + 1
      if (shape%ndim == 1) then
         allocate (scene%x(2, row))
         do i = 1, row
            scene%x(:, i) = [real(i - 1, wp)/real(2*n, wp), 0.0_wp]
            scene%x(2, i) = wave*sin(7.0_wp*scene%x(1, i))
         end do
         call allocate_facets(facets, n, shape)
         do i = 1, n
            ! Travelled to the left: the right of the way is above.
            facets%node(:2, i) = [2*i + 1, 2*i - 1]
            if (shape%quadratic) facets%node(3, i) = 2*i
         end do
      else
         allocate (scene%x(3, row**2))
         do j = 1, row
            do i = 1, row
               scene%x(:2, i + (j - 1)*row) = real([i - 1, j - 1], wp)/real(2*n, wp)
               scene%x(3, i + (j - 1)*row) = wave*sin(7.0_wp*scene%x(1, i))*cos(5.0_wp*real(j - 1, &
                  & wp)/real(2*n, wp))
            end do
         end do
         m = merge(1, 2, shape%ncorner == 4)
         call allocate_facets(facets, m*n*n, shape)
         do k = 1, facets%n
            i = mod((k - 1)/m, n)
            j = (k - 1)/m/n
            corner = reshape(2*[i, j, i + 1, j, i + 1, j + 1, i, j + 1], [2, 4])
            if (m == 2 .and. mod(k, 2) == 0) corner(:, :3) = corner(:, [1, 3, 4])
            call fill_nodes(facets%node(:, k), shape, corner(:, :shape%ncorner), row)
         end do
      end if
      call start(scene, facets)
   end subroutine make_sheet

   subroutine allocate_facets(facets, n, shape)
      type(facets_type), intent(out) :: facets
      integer, intent(in) :: n
      type(cell_type), intent(in) :: shape

      facets%n = n
      allocate (facets%element(n), facets%face(n), facets%cell(n), facets%nnode(n), facets%node(8, &
         & n))
      facets%element = 1
      facets%face = 1
      facets%cell = shape%id
      facets%nnode = shape%nnode
      facets%node = 0
   end subroutine allocate_facets

   !> Nodes of a facet from its corners on a grid with mid-points.
   subroutine fill_nodes(node, shape, corner, row)
      integer, intent(inout) :: node(:)
      type(cell_type), intent(in) :: shape
      integer, intent(in) :: corner(:, :), row
      integer :: k, mid(2)

      do k = 1, shape%ncorner
         node(k) = 1 + corner(1, k) + row*corner(2, k)
         if (.not. shape%quadratic) cycle
         mid = (corner(:, k) + corner(:, 1 + mod(k, shape%ncorner)))/2
         node(shape%ncorner + k) = 1 + mid(1) + row*mid(2)
      end do
   end subroutine fill_nodes

   subroutine start(scene, facets)
      type(scene_type), intent(inout) :: scene
      type(facets_type), intent(in) :: facets

      call new_surface(scene%surface, size(scene%x, 1), facets)
      call follow(scene)
      call build_tree(scene%tree, scene%surface%low, scene%surface%high)
   end subroutine start

   subroutine follow(scene)
      type(scene_type), intent(inout) :: scene
      type(error_type), allocatable :: error

      call update_surface(scene%surface, scene%x, error)
      call is_true('no degenerate facet', .not. allocated(error))
   end subroutine follow

   !> The cube [-1, 1]^3: n x n quads, or 2 n x n triangles, on each side.
   subroutine make_cube(scene, n, triangles)
      type(scene_type), intent(out) :: scene
      integer, intent(in) :: n
      logical, intent(in) :: triangles
      type(facets_type) :: facets
      type(cell_type) :: shape
      integer :: side, axis, i, j, k, u, v, corner(3, 4)

      call new_cell_of(shape, merge(cell_id%triangle, cell_id%quad, triangles))
      allocate (scene%x(3, (n + 1)**3))
      do k = 0, n
         do j = 0, n
            do i = 0, n
               scene%x(:, number(i, j, k, n)) = 2.0_wp*real([i, j, k], wp)/real(n, wp) - 1.0_wp
            end do
         end do
      end do
      call allocate_facets(facets, merge(12, 6, triangles)*n*n, shape)
      k = 0
      do side = 1, 6
         axis = 1 + mod(side, 3)
         u = 1 + mod(axis, 3)
         v = 1 + mod(u, 3)
         do j = 0, n - 1
            do i = 0, n - 1
               corner(axis, :) = merge(0, n, side > 3)
               corner(u, :) = [i, i + 1, i + 1, i]
               corner(v, :) = [j, j, j + 1, j + 1]
               if (side > 3) corner = corner(:, [1, 4, 3, 2])
               k = k + 1
               facets%node(:3, k) = node_numbers(corner(:, :3), n)
               if (.not. triangles) facets%node(:4, k) = node_numbers(corner, n)
               if (.not. triangles) cycle
               k = k + 1
               facets%node(:3, k) = node_numbers(corner(:, [1, 3, 4]), n)
            end do
         end do
      end do
      call start(scene, facets)
   end subroutine make_cube

   pure integer function number(i, j, k, n)
      integer, intent(in) :: i, j, k, n
      number = 1 + i + (n + 1)*(j + (n + 1)*k)
   end function number

   pure function node_numbers(corner, n) result(node)
      integer, intent(in) :: corner(:, :), n
      integer :: node(size(corner, 2)), i
      do i = 1, size(node)
         node(i) = number(corner(1, i), corner(2, i), corner(3, i), n)
      end do
   end function node_numbers
end module search_scenes
