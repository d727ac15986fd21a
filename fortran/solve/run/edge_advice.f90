!> Advice where metal that flows is the master of a body that does not, and spreads past its edge.
!>
!> The node at the edge of the slave then presses on the inside of a facet of the metal, which
!> cannot bend around it: it cuts in, until the element below turns or strains without bound. With
!> the metal as slave its own nodes lie on the body, and those past the edge are free.
module lopin_edge_advice
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, new_facets
   use lopin_model, only : model_type, pair_type, surface_of
   use lopin_text, only : to_text
   use lopin_scene, only : scene_type
   use lopin_surface_material, only : is_metal
   implicit none
   private
   public :: exchange_at_edges

contains

   !> What to try; '': no such edge presses.
   function exchange_at_edges(scene, model) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      logical, allocatable :: on_edge(:)
      integer :: pair, i

      text = ''
      associate (c => scene%newton%contact)
         do pair = 1, size(model%pair)
            associate (p => model%pair(pair))
               if (.not. presses_on_metal(model, p)) cycle
               call find_edge(model, p%slave, on_edge)
               do i = 1, c%n
                  if (c%pair(i) /= pair .or. c%status(i) <= 0) cycle
                  if (.not. on_edge(c%node(i))) cycle
                  text = 'exchange slave and master of ('//model%surface(p%slave)%name//', '// &
                     & model%surface(p%master)%name//'): node '// &
                     & to_text(model%mesh%node_label(c%node(i)))//' at the edge of '// &
                     & model%surface(p%slave)%name//' cuts into facets of metal that flows '// &
                     & 'past it'
                  return
               end do
            end associate
         end do
      end associate
   end function exchange_at_edges

   !> A slave of elements that do not flow, and a master of those that do.
   logical function presses_on_metal(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair

      presses_on_metal = .false.
      if (pair%tied .or. pair%slave == 0 .or. pair%master == 0) return
      if (model%surface(pair%slave)%kind /= surface_of%faces &
         & .or. model%surface(pair%master)%kind /= surface_of%faces) return
      presses_on_metal = is_metal(model, pair%master) .and. .not. is_metal(model, pair%slave)
   end function presses_on_metal

   !> Corners of a surface of faces where it ends: of edges, in the plane ends, of one facet alone.
   subroutine find_edge(model, surface, on_edge)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      logical, allocatable, intent(out) :: on_edge(:)   !! (nnode)
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: f
      integer, allocatable :: edge(:, :)
      integer :: i, k, m, n

      allocate (on_edge(model%mesh%nnode), source=.false.)
      call cells_of_words(model%element_word, cells)
      call new_facets(f, model%mesh, cells, model%surface(surface)%element, &
         & model%surface(surface)%face)
      allocate (edge(2, 4*f%n))
      n = 0
      do i = 1, f%n
         m = corners_of(model%mesh%ndim, f%nnode(i))
         do k = 1, m
            n = n + 1
            edge(:, n) = f%node(k, i)
            if (model%mesh%ndim == 3) edge(2, n) = f%node(1 + mod(k, m), i)
         end do
      end do
      do i = 1, n
         k = count(edge(1, :n) == edge(1, i) .and. edge(2, :n) == edge(2, i) &
            & .or. edge(1, :n) == edge(2, i) .and. edge(2, :n) == edge(1, i))
         if (k == 1) on_edge(edge(:, i)) = .true.
      end do
   end subroutine find_edge

   !> Corners of a facet of so many nodes.
   pure integer function corners_of(ndim, nnode) result(m)
      integer, intent(in) :: ndim, nnode

      m = 2
      if (ndim == 3) m = merge(nnode, nnode/2, nnode <= 4)
   end function corners_of
end module lopin_edge_advice
