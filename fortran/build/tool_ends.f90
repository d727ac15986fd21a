!> Where facets of a rigid tool end, and whether slaves come near.
module lopin_tool_ends
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type, surface_of
   implicit none
   private
   public :: tool_ends_type, new_tool_ends, slave_reaches

   !> Beside the slave, as a share of its extent.
   real(wp), parameter :: beside = 0.1_wp
   !> Nodes of a slave whose distance is looked for.
   integer, parameter :: most_nodes = 100

   !> Boxes around the edges (2D: corners) that one facet alone has.
   type :: tool_ends_type
      real(wp), allocatable :: low(:, :), high(:, :)   !! (ndim, n) [length]
   end type tool_ends_type

contains

   subroutine new_tool_ends(self, x, corner)
      type(tool_ends_type), intent(out) :: self
      real(wp), intent(in) :: x(:, :)          !! (ndim, node) [length]
      integer, intent(in) :: corner(:, :)      !! (corners, facet); zeros behind the last
      integer :: head(size(x, 2)), low(size(corner)), high(size(corner))
      integer :: next(size(corner)), times(size(corner)), i, k, n, m, edge, first

      head = 0
      m = 0
      do i = 1, size(corner, 2)
         n = count(corner(:, i) > 0)
         do k = 1, n
            associate (a => corner(k, i), b => corner(1 + mod(k, n), i))
               first = merge(a, min(a, b), n == 2)
               edge = head(first)
               do while (edge > 0)
                  if (high(edge) == merge(a, max(a, b), n == 2)) exit
                  edge = next(edge)
               end do
               if (edge > 0) then
                  times(edge) = times(edge) + 1
                  cycle
               end if
               m = m + 1
               low(m) = first
               high(m) = merge(a, max(a, b), n == 2)
               times(m) = 1
               next(m) = head(first)
               head(first) = m
            end associate
         end do
      end do
      associate (a => pack(low(:m), times(:m) == 1), b => pack(high(:m), times(:m) == 1))
         self%low = min(x(:, a), x(:, b))
         self%high = max(x(:, a), x(:, b))
      end associate
   end subroutine new_tool_ends

   !> Some slave of a master, wherever it is moved, comes near an end.
   logical function slave_reaches(model, master, ends, corners) result(reaches)
      type(model_type), intent(in) :: model
      integer, intent(in) :: master            !! surface
      type(tool_ends_type), intent(in) :: ends
      real(wp), intent(in) :: corners(:, :)    !! (ndim, n) of the facets [length]
      real(wp) :: low(size(corners, 1)), high(size(corners, 1)), gap, way
      integer :: p, i

      reaches = .false.
      if (size(ends%low, 2) == 0) return
      way = way_of(model)
      do p = 1, size(model%pair)
         if (model%pair(p)%master /= master) cycle
         associate (x => model%mesh%x(:, nodes_of(model, model%pair(p)%slave)))
            if (size(x, 2) == 0) cycle
            low = minval(x, dim=2)
            high = maxval(x, dim=2)
            gap = huge(1.0_wp)
            do i = 1, size(x, 2), 1 + size(x, 2)/most_nodes
               gap = min(gap, minval(norm2(corners - spread(x(:, i), 2, size(corners, 2)), 1)))
            end do
            associate (far => gap + way + beside*maxval(high - low))
               low = low - far
               high = high + far
            end associate
         end associate
         do i = 1, size(ends%low, 2)
            reaches = reaches .or. all(ends%low(:, i) <= high .and. ends%high(:, i) >= low)
         end do
      end do
   end function slave_reaches

   !> The sum of the largest prescribed displacements of the steps [length].
   pure real(wp) function way_of(model) result(way)
      type(model_type), intent(in) :: model
      real(wp) :: most
      integer :: s, i

      way = 0.0_wp
      do s = 1, size(model%step)
         most = 0.0_wp
         do i = 1, size(model%step(s)%prescribed)
            associate (p => model%step(s)%prescribed(i))
               if (p%dof > 3) cycle
               most = max(most, abs(p%value)*merge(model%step(s)%period, 1.0_wp, p%velocity))
            end associate
         end do
         way = way + most
      end do
   end function way_of

   !> Nodes of a surface.
   function nodes_of(model, surface) result(node)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      integer, allocatable :: node(:)
      type(cell_type), allocatable :: cell(:)
      logical :: used(model%mesh%nnode)
      integer :: i

      used = .false.
      associate (s => model%surface(surface))
         if (s%kind == surface_of%nodes) then
            used(s%node) = .true.
         else if (s%kind == surface_of%faces) then
            call cells_of_words(model%element_word, cell)
            do i = 1, size(s%element)
               associate (c => cell(model%mesh%etype(s%element(i))))
                  used(model%mesh%conn(c%face_node(:c%face_nnode(s%face(i)), s%face(i)), &
                     & s%element(i))) = .true.
               end associate
            end do
         end if
      end associate
      node = pack([(i, i=1, model%mesh%nnode)], used)
   end function nodes_of
end module lopin_tool_ends
