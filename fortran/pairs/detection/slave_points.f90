!> The nodes of a slave surface: tributary area, normal, and size of the facets.
module lopin_slave_points
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, facet_rule_type, new_facets, new_facet_rules, &
      & nodal_weights, nodal_normals, middle_share
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_model, only : model_type, surface_data_type, surface_of, kind_of
   use lopin_flat_elements, only : is_flat
   implicit none
   private
   public :: slave_type, new_slave

   !> The slave points of a surface before they are paired.
   type :: slave_type
      integer, allocatable :: node(:)        !! (n)
      real(wp), allocatable :: weight(:)     !! (n) tributary area; 1 if unknown [length^2]
      real(wp), allocatable :: normal(:, :)  !! (3, n) outward; 0 if unknown
      real(wp), allocatable :: size(:)       !! (n) of the facets there [length]
      integer, allocatable :: corner(:, :)   !! (2, n) mid-side: places of the ends of its edge in
                                             !! `node`; else 0
      real(wp), allocatable :: share(:)      !! (n) of its function that each end gets; else 0
      type(facets_type) :: facets            !! none of a surface of nodes
      integer, allocatable :: local(:, :)    !! (8, facets) places of their nodes in `node`
      real(wp), allocatable :: thickness(:)  !! (facets) 1 unless plane [length]
   end type slave_type

contains

   !> Slave nodes of a surface with tributary areas, normals and facet sizes.
   subroutine new_slave(self, model, cells, surface, error)
      type(slave_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      type(surface_data_type), intent(in) :: surface
      type(error_type), allocatable, intent(out) :: error
      type(facets_type) :: facets
      type(facet_rule_type), allocatable :: rules(:)
      type(surface_type) :: shape
      real(wp), allocatable :: weight(:), normal(:, :), thickness(:), length(:)
      integer :: i, k
      logical :: ring

      if (surface%kind == surface_of%nodes) then
         self%node = surface%node
         self%weight = merge(surface%area, 1.0_wp, surface%area > 0.0_wp)
         allocate (self%normal(3, size(self%node)), self%size(size(self%node)), source=0.0_wp)
         self%size = typical_size(model)
         allocate (self%corner(2, size(self%node)), source=0)
         allocate (self%share(size(self%node)), source=0.0_wp)
         return
      end if
      call new_facets(facets, model%mesh, cells, surface%element, surface%face)
      call new_surface(shape, model%mesh%ndim, facets)
      call update_surface(shape, model%mesh%x, error)
      if (allocated(error)) return
      allocate (rules(6), weight(model%mesh%nnode), normal(model%mesh%ndim, model%mesh%nnode))
      call new_facet_rules(rules)
      thickness = spread(1.0_wp, 1, facets%n)
      ring = model%kind == kind_of%axisymmetric .and. .not. surface%flat
      do i = 1, facets%n
         if (model%mesh%section(facets%element(i)) == 0) cycle
         if (.not. is_flat(model, facets%element(i))) cycle
         thickness(i) = model%section(model%mesh%section(facets%element(i)))%thickness
      end do
      call nodal_weights(facets, rules, model%mesh%x, ring, thickness, weight)
      call nodal_normals(facets, rules, model%mesh%x, ring, normal)
      allocate (length(model%mesh%nnode), source=0.0_wp)
      do i = 1, facets%n
         do k = 1, facets%nnode(i)
            length(facets%node(k, i)) = max(length(facets%node(k, i)), shape%size(i))
         end do
      end do
      self%node = shape%node
      self%facets = facets
      self%local = shape%local
      self%thickness = thickness
      self%weight = weight(shape%node)
      self%size = length(shape%node)
      allocate (self%normal(3, shape%nnode), source=0.0_wp)
      self%normal(:model%mesh%ndim, :) = normal(:, shape%node)
      call find_edges(self, shape, rules, model%mesh%x, ring)
   end subroutine new_slave

   !> The transformed basis: what a mid-side node takes from the ends of its edge.
   pure subroutine find_edges(self, surface, rules, x, axisymmetric)
      type(slave_type), intent(inout) :: self
      type(surface_type), intent(in) :: surface
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)          !! (ndim, mesh nodes) at the start [length]
      logical, intent(in) :: axisymmetric
      real(wp) :: share
      integer :: i, k, m

      allocate (self%corner(2, surface%nnode), source=0)
      allocate (self%share(surface%nnode), source=0.0_wp)
      do i = 1, surface%facets%n
         associate (rule => rules(surface%facets%cell(i)), cell => &
            & rules(surface%facets%cell(i))%cell, local => surface%local(:, i))
            m = cell%nnode
            share = middle_share(rule, x(:, surface%facets%node(:m, i)), axisymmetric)
            if (.not. share > 0.0_wp) cycle
            do k = 1, m - cell%ncorner
               self%corner(:, local(cell%ncorner + k)) = local(cell%edge(:, k))
               self%share(local(cell%ncorner + k)) = share
            end do
         end associate
      end do
   end subroutine find_edges

   !> A length for nodes without facets: the scene's, over the root of its elements.
   pure real(wp) function typical_size(model) result(length)
      type(model_type), intent(in) :: model
      length = maxval(maxval(model%mesh%x, dim=2) - minval(model%mesh%x, dim=2)) &
         & /max(1, model%mesh%nelement)**(1.0_wp/model%mesh%ndim)
   end function typical_size
end module lopin_slave_points
