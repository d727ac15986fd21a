!> Areas of slave surfaces that are made of nodes, where a law needs them: a limit of the shear
!> stress is none of the force without one, and a pressure that the deck gives to a penetration
!> makes a force by the area alone.
!>
!> They are those of the free faces whose nodes all belong to the surface. Nodes without such a face
!> keep none, of which lopin_check_options warns.
module lopin_node_areas
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, facet_rule_type, boundary_facets, new_facet_rules, &
      & nodal_weights
   use lopin_element_type, only : cells_of_words
   use lopin_friction, only : friction_type, bounds_by_area
   use lopin_model, only : model_type, surface_of, overclosure_of
   use lopin_flat_elements, only : is_flat, is_ring
   implicit none
   private
   public :: find_node_areas

contains

   !> Areas of all slave surfaces of nodes whose friction has a limit of the shear stress.
   subroutine find_node_areas(model)
      type(model_type), intent(inout) :: model
      logical, allocatable :: wanted(:)
      real(wp), allocatable :: weight(:)
      integer :: pair, i, lacking

      allocate (wanted(size(model%surface)), source=.false.)
      do pair = 1, size(model%pair)
         associate (s => model%pair(pair)%slave)
            if (s == 0 .or. model%pair(pair)%interaction == 0) cycle
            if (model%surface(s)%kind /= surface_of%nodes .or. wanted(s)) cycle
            if (.not. any(model%surface(s)%area <= 0.0_wp)) cycle
            if (.not. (limits_stress(model, model%pair(pair)%interaction) &
               & .or. gives_pressure(model, model%pair(pair)%interaction))) cycle
            wanted(s) = .true.
            call weigh(model, model%surface(s)%node, is_ring(model, s), weight)
            associate (area => model%surface(s)%area, node => model%surface(s)%node)
               do i = 1, size(node)
                  if (.not. area(i) > 0.0_wp) area(i) = weight(node(i))
               end do
               lacking = count(.not. area > 0.0_wp)
               if (lacking < size(area)) call model%log%say(severity%note, 'N0318', &
                  & 'surface '//model%surface(s)%name//' of nodes stands for an area of '// &
                  & to_text(sum(area), 4)//', found from the free faces between its nodes: '// &
                  & trim(merge('its friction has a limit of the shear stress      ', &
                  & 'a slope or law of pressure is by area, not by node', limits_stress(model, &
                  & model%pair(pair)%interaction))), model%surface(s)%at)
               if (lacking > 0 .and. gives_pressure(model, model%pair(pair)%interaction)) &
                  & call model%log%say(severity%note, 'N0318', to_text(lacking)//' of '// &
                  & to_text(size(area))//' nodes of surface '//model%surface(s)%name// &
                  & ' have no area: their slope or law of pressure is that of a force', &
                  & model%surface(s)%at, help='node, area on each line, or a surface of faces')
            end associate
         end associate
      end do
   end subroutine find_node_areas

   !> The friction of an interaction, at the start or changed by a step, has a limit of its own.
   pure logical function limits_stress(model, interaction) result(limits)
      type(model_type), intent(in) :: model
      integer, intent(in) :: interaction
      integer :: s, i

      limits = bounds_by_area(model%interaction(interaction)%friction)
      do s = 1, size(model%step)
         if (.not. allocated(model%step(s)%friction_change)) cycle
         do i = 1, size(model%step(s)%friction_change)
            associate (change => model%step(s)%friction_change(i))
               if (change%interaction == interaction) &
                  & limits = limits .or. bounds_by_area(change%friction)
            end associate
         end do
      end do
   end function limits_stress

   !> The deck gives the pressure of a penetration.
   pure logical function gives_pressure(model, interaction) result(gives)
      type(model_type), intent(in) :: model
      integer, intent(in) :: interaction

      associate (way => model%interaction(interaction))
         gives = any(way%overclosure == [overclosure_of%exponential, overclosure_of%tabular])
         gives = gives .or. (way%slope > 0.0_wp .and. .not. way%method%is_exact())
      end associate
   end function gives_pressure

   !> Areas of the mesh's nodes by the free faces whose nodes are all in a list; zero elsewhere.
   subroutine weigh(model, node, ring, weight)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node(:)
      logical, intent(in) :: ring              !! areas go around the axis
      real(wp), allocatable, intent(out) :: weight(:)
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: free, facets
      type(facet_rule_type) :: rules(6)
      logical, allocatable :: shared(:), within(:)
      logical :: member(model%mesh%nnode)
      real(wp), allocatable :: thickness(:)
      integer :: i

      member = .false.
      member(node) = .true.
      call cells_of_words(model%element_word, cells)
      call boundary_facets(free, model%mesh, cells, pack([(i, i=1, model%mesh%nelement)], &
         & model%mesh%section > 0), ring, shared)
      allocate (within(free%n))
      do i = 1, free%n
         within(i) = all(member(free%node(:free%nnode(i), i)))
      end do
      facets%n = count(within)
      facets%element = pack(free%element, within)
      facets%cell = pack(free%cell, within)
      facets%nnode = pack(free%nnode, within)
      allocate (facets%node(8, facets%n))
      facets%node = free%node(:, pack([(i, i=1, free%n)], within))
      allocate (weight(model%mesh%nnode), thickness(facets%n))
      thickness = 1.0_wp
      do i = 1, facets%n
         if (is_flat(model, facets%element(i))) thickness(i) = &
            & model%section(model%mesh%section(facets%element(i)))%thickness
      end do
      call new_facet_rules(rules)
      call nodal_weights(facets, rules, model%mesh%x, ring, thickness, weight)
   end subroutine weigh
end module lopin_node_areas
