!> How much the surface of a slave has grown: present tributary area of its nodes per area at the
!> start.
module lopin_surface_stretch
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, facet_rule_type, new_facets, new_facet_rules, nodal_weights
   use lopin_model, only : model_type, surface_of, kind_of
   implicit none
   private
   public :: surface_stretch

contains

   !> 1 at nodes that are not on the surface, and on surfaces of nodes, whose area nobody knows.
   subroutine surface_stretch(model, surface, u, stretch)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface           !! index into model%surface
      real(wp), intent(in) :: u(:, :)          !! (>= ndim, nnode) displacements [length]
      real(wp), intent(out) :: stretch(:)      !! (nnode) [-]
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: facets
      type(facet_rule_type), allocatable :: rules(:)
      real(wp), dimension(model%mesh%nnode) :: before, now
      real(wp), allocatable :: thickness(:)

      stretch = 1.0_wp
      if (model%surface(surface)%kind /= surface_of%faces) return
      call cells_of_words(model%element_word, cells)
      call new_facets(facets, model%mesh, cells, model%surface(surface)%element, &
         & model%surface(surface)%face)
      allocate (rules(6), thickness(facets%n))
      call new_facet_rules(rules)
      thickness = 1.0_wp
      call nodal_weights(facets, rules, model%mesh%x, model%kind == kind_of%axisymmetric, &
         & thickness, before)
      call nodal_weights(facets, rules, model%mesh%x + u(:model%mesh%ndim, :), &
         & model%kind == kind_of%axisymmetric, thickness, now)
      where (before > 0.0_wp .and. now > 0.0_wp) stretch = now/before
   end subroutine surface_stretch
end module lopin_surface_stretch
