!> The faces of slaves in smooth pieces: on a sharp edge a node has the area of the piece that faces
!> what presses it, not that of the side next to it.
module lopin_skins
   use lopin_kinds, only : wp
   use lopin_carried_force, only : skin_type, find_pieces, piece_areas
   use lopin_cells, only : cell_type
   use lopin_contact_points, only : contact_points_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : new_facets, new_facet_rules, middle_share
   use lopin_model, only : model_type, surface_of
   use lopin_flat_elements, only : is_ring
   use lopin_mortar_pairs, only : is_mortar, thickness_of
   use lopin_slave_pieces, only : split_slave
   use lopin_surface, only : surface_type, new_surface
   implicit none
   private
   public :: new_skins, weigh_sharp_nodes

contains

   !> The faces of all slaves that have some.
   subroutine new_skins(skin, model)
      type(skin_type), allocatable, intent(out) :: skin(:)
      type(model_type), intent(in) :: model
      type(cell_type), allocatable :: cells(:)
      integer :: pair

      allocate (skin(size(model%pair)))
      call cells_of_words(model%element_word, cells)
      do pair = 1, size(model%pair)
         if (model%surface(model%pair(pair)%slave)%kind == surface_of%faces) &
            & call new_skin(skin(pair), model, cells, pair)
      end do
   end subroutine new_skins

   subroutine new_skin(self, model, cells, pair)
      type(skin_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(surface_type) :: shape
      integer :: i, m

      associate (slave => model%surface(model%pair(pair)%slave))
         call new_facets(self%facets, model%mesh, cells, slave%element, slave%face)
      end associate
      if (self%facets%n == 0) return
      self%in_use = .true.
      self%axisymmetric = is_ring(model, model%pair(pair)%slave)
      self%integrated = is_mortar(model, model%pair(pair)) &
         & .and. model%pair(pair)%slave /= model%pair(pair)%master
      call new_surface(shape, model%mesh%ndim, self%facets)
      allocate (self%rules(6), self%share(self%facets%n))
      call new_facet_rules(self%rules)
      call split_slave(shape, self%rules, model%mesh%x, self%piece)
      self%is_sharp = maxval(self%piece) > 1
      self%thickness = thickness_of(model, self%facets)
      do i = 1, self%facets%n
         m = self%facets%nnode(i)
         self%share(i) = middle_share(self%rules(self%facets%cell(i)), &
            & model%mesh%x(:, self%facets%node(:m, i)), self%axisymmetric)
      end do
   end subroutine new_skin

   !> The points of a pair at the nodes, on the shape at the start.
   subroutine weigh_sharp_nodes(points, model, cells, pair)
      type(contact_points_type), intent(inout) :: points
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(skin_type) :: skin
      real(wp), allocatable :: area(:)
      integer, allocatable :: piece(:)

      if (model%surface(model%pair(pair)%slave)%kind /= surface_of%faces) return
      call new_skin(skin, model, cells, pair)
      if (.not. skin%is_sharp) return
      associate (first => points%first(pair), last => points%n)
         allocate (area(last - first + 1), piece(last - first + 1))
         call find_pieces(skin, model%mesh%x, points%node(first:last), &
            & points%normal(:model%mesh%ndim, first:last), points%facet(first:last) > 0, piece)
         call piece_areas(skin, model%mesh%x, points%node(first:last), piece, area)
         where (area > 0.0_wp) points%weight(first:last) = area
      end associate
   end subroutine weigh_sharp_nodes
end module lopin_skins
