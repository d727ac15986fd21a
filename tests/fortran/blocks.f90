!> Small meshes for tests: a block of any cell, with inner nodes moved if wanted.
module blocks
   use lopin_kinds, only : wp
   use lopin_mesh, only : mesh_type
   use lopin_cells, only : cell_type, cell_family
   implicit none
   private
   public :: new_block, random

   integer, parameter :: tetra(4, 6) = reshape([1, 2, 3, 7, 1, 3, 4, 7, 1, 4, 8, 7, 1, 8, 5, 7, &
      & 1, 5, 6, 7, 1, 6, 2, 7], [4, 6])
   integer, parameter :: wedge(6, 2) = reshape([1, 2, 3, 5, 6, 7, 1, 3, 4, 5, 7, 8], [6, 2])
   integer, parameter :: triangle(3, 2) = reshape([1, 2, 3, 1, 3, 4], [3, 2])

contains

   !> Boxes from `low` to `high`, split into the cell; element type and section are 1.
   subroutine new_block(mesh, cell, boxes, low, high, distortion)
      type(mesh_type), intent(out) :: mesh
      type(cell_type), intent(in) :: cell           !! a 2D or 3D cell
      integer, intent(in) :: boxes(:)               !! (>= ndim) numbers of boxes
      real(wp), intent(in) :: low(:), high(:)       !! (>= ndim) corners of the block
      real(wp), intent(in) :: distortion            !! largest move of inner corners / box size
      integer :: n(3), i, j, k, d, node, inner, seed
      real(wp) :: step(3), place(3), move

      d = cell%ndim
      n = 0
      n(:d) = boxes(:d)
      step(:d) = (high(:d) - low(:d))/real(boxes(:d), wp)
      mesh%ndim = d
      mesh%nnode = product(n + 1)
      allocate (mesh%x(d, mesh%nnode))
      seed = 1
      node = 0
      do k = 0, n(3)
         do j = 0, n(2)
            do i = 0, n(1)
               node = node + 1
               place = real([i, j, k], wp)
               mesh%x(:, node) = low(:d) + step(:d)*place(:d)
               if (any([i, j, k] == 0 .and. n > 0) .or. any([i, j, k] == n .and. n > 0)) cycle
               do inner = 1, d
                  call random(seed, move)
                  mesh%x(inner, node) = mesh%x(inner, node) + distortion*step(inner)*move
               end do
            end do
         end do
      end do
      call split(mesh, cell, n)
      if (cell%quadratic) call add_mid_nodes(mesh, cell)
      mesh%etype = spread(1, 1, mesh%nelement)
      mesh%section = mesh%etype
      mesh%element_label = [(i, i=1, mesh%nelement)]
      mesh%node_label = [(i, i=1, mesh%nnode)]
   end subroutine new_block

   !> A number in [-1, 1], the same on every machine.
   pure subroutine random(seed, value)
      integer, intent(inout) :: seed
      real(wp), intent(out) :: value
      seed = mod(seed*811 + 17, 100003)
      value = 2.0_wp*real(seed, wp)/100003.0_wp - 1.0_wp
   end subroutine random

   subroutine split(mesh, cell, n)
      type(mesh_type), intent(inout) :: mesh
      type(cell_type), intent(in) :: cell
      integer, intent(in) :: n(3)
      integer :: part(8, 6), corner(8), parts, i, j, k, p, e, layer

      part = 0
      parts = 1
      part(:, 1) = [1, 2, 3, 4, 5, 6, 7, 8]
      select case (cell%family)
      case (cell_family%triangle)
         parts = 2
         part(:3, :2) = triangle
      case (cell_family%wedge)
         parts = 2
         part(:6, :2) = wedge
      case (cell_family%tetra)
         parts = 6
         part(:4, :) = tetra
      end select
      mesh%nelement = parts*n(1)*n(2)*max(1, n(3))
      allocate (mesh%conn(20, mesh%nelement))
      mesh%conn = 0
      layer = (n(1) + 1)*(n(2) + 1)
      e = 0
      do k = 1, max(1, n(3))
         do j = 1, n(2)
            do i = 1, n(1)
               corner(1) = i + (j - 1)*(n(1) + 1) + (k - 1)*layer
               corner(2:4) = corner(1) + [1, n(1) + 2, n(1) + 1]
               corner(5:8) = corner(1:4) + layer
               do p = 1, parts
                  e = e + 1
                  mesh%conn(:cell%ncorner, e) = corner(part(:cell%ncorner, p))
               end do
            end do
         end do
      end do
   end subroutine split

   !> Mid-side nodes in the middle of straight edges, one for each edge.
   subroutine add_mid_nodes(mesh, cell)
      type(mesh_type), intent(inout) :: mesh
      type(cell_type), intent(in) :: cell
      integer, allocatable :: other(:), mid(:), next(:), first(:)
      real(wp), allocatable :: x(:, :)
      integer :: e, k, a, b, m, n

      n = mesh%nelement*(cell%nnode - cell%ncorner)
      allocate (other(n), mid(n), next(n), first(mesh%nnode), x(mesh%ndim, mesh%nnode + n))
      first = 0
      n = 0
      x(:, :mesh%nnode) = mesh%x
      do e = 1, mesh%nelement
         do k = 1, cell%nnode - cell%ncorner
            a = minval(mesh%conn(cell%edge(:, k), e))
            b = maxval(mesh%conn(cell%edge(:, k), e))
            m = first(a)
            do while (m > 0)
               if (other(m) == b) exit
               m = next(m)
            end do
            if (m == 0) then
               n = n + 1
               m = n
               other(m) = b
               next(m) = first(a)
               first(a) = m
               x(:, mesh%nnode + m) = 0.5_wp*(x(:, a) + x(:, b))
            end if
            mesh%conn(cell%ncorner + k, e) = mesh%nnode + m
         end do
      end do
      mesh%nnode = mesh%nnode + n
      mesh%x = x(:, :mesh%nnode)
   end subroutine add_mid_nodes
end module blocks
