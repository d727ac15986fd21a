!> Surface-to-surface pairs of a model: search, integrate, couple.
module lopin_mortar_pairs
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, facet_rule_type, new_facets, new_facet_rules, facet_point
   use lopin_narrow_master, only : narrowest_part
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type, build_tree
   use lopin_mortar_overlap, only : overlap_list_type, overlap_limits_type, area_measure_type
   use lopin_mortar_overlaps_2d, only : find_overlaps_2d
   use lopin_slave_pieces, only : split_slave, piece_normals, whole_weights
   use lopin_mortar_cover, only : cover_type, new_cover
   use lopin_mortar_cells_3d, only : mortar_kernel_type, new_mortar_kernel
   use lopin_mortar_overlaps_3d, only : find_overlaps_3d
   use lopin_mortar, only : mortar_coupling_type, couple
   use lopin_model, only : model_type, pair_type, surface_of
   use lopin_flat_elements, only : is_flat, is_ring
   use lopin_wall_depth, only : depths_of_facets
   use lopin_tilting, only : rows_needed
   implicit none
   private
   public :: coupled_pair_type, couple_pair, is_mortar, shape_of, thickness_of

   !> A pair as it is coupled.
   type :: coupled_pair_type
      type(mortar_coupling_type) :: rows
      type(surface_type) :: slave              !! in smooth pieces
      real(wp), allocatable :: side(:, :)      !! (3, slave%nnode) outward normals
      real(wp) :: width = huge(1.0_wp)   !! of the narrowest part of the master, in facets; huge:
                                         !! wide
   end type coupled_pair_type

   !> n_slave.n_master must be below this for the two to face each other.
   real(wp), parameter :: facing = -0.2_wp

contains

   !> The pair is enforced on the whole surface: both sides have faces. A rigid analytic tool has no
   !> mesh to couple with: its gap is taken at the nodes, weighted by their areas, which passes
   !> forces on exactly.
   pure logical function is_mortar(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      is_mortar = pair%surface_to_surface &
         & .and. model%surface(pair%slave)%kind == surface_of%faces &
         & .and. model%surface(pair%master)%kind == surface_of%faces
   end function is_mortar

   !> The coupling of a pair on the shape at the start, or at other places of the nodes.
   subroutine couple_pair(self, model, cells, number, tied, error, places)
      type(coupled_pair_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: number            !! of the pair
      logical, intent(in) :: tied
      type(error_type), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: places(:, :)     !! (ndim, nnode) [length]
      type(surface_type) :: master
      real(wp), allocatable :: x(:, :)
      type(facet_rule_type) :: rules(6)
      type(area_measure_type) :: measure
      type(overlap_list_type) :: list
      type(cover_type) :: cover
      real(wp), allocatable :: full(:), share(:)
      integer, allocatable :: piece(:)
      integer :: i

      x = model%mesh%x
      if (present(places)) x = places
      call shape_of(self%slave, model, cells, model%pair(number)%slave, error)
      if (allocated(error)) return
      call shape_of(master, model, cells, model%pair(number)%master, error)
      if (allocated(error)) return
      if (present(places)) then
         call update_surface(self%slave, x, error)
         if (.not. allocated(error)) call update_surface(master, x, error)
         if (allocated(error)) return
      end if
      call new_facet_rules(rules)
      call split_slave(self%slave, rules, x, piece)
      associate (slave => self%slave)
         measure = area_measure_type(is_ring(model, model%pair(number)%slave), &
            & thickness_of(model, slave%facets))
         allocate (self%side(3, slave%nnode), full(slave%nnode), source=0.0_wp)
         call piece_normals(slave, rules, x, measure%axisymmetric, self%side(:model%mesh%ndim, :))
         allocate (share(slave%facets%n))
         call whole_weights(slave, rules, x, measure%axisymmetric, measure%thickness, full, share)
         call find_overlaps(self, model, number, master, x, measure, list, error)
         if (allocated(error)) return
         call new_cover(cover, full, share, tied, rows_needed(model, number))
         call couple(self%rows, rules, slave, master, x, measure, list, cover)
         if (.not. tied) self%width = narrowest_part(slave, [(area_of(rules, slave, x, measure, &
            & i), i=1, slave%facets%n)], list, cover)
      end associate
   end subroutine couple_pair

   real(wp) function area_of(rules, slave, x, measure, i) result(area)
      type(facet_rule_type), intent(in) :: rules(:)
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      type(area_measure_type), intent(in) :: measure
      integer, intent(in) :: i                 !! facet
      real(wp) :: normal(3), own
      integer :: k

      area = 0.0_wp
      associate (rule => rules(slave%facets%cell(i)), &
         & own_x => x(:, slave%facets%node(:slave%facets%nnode(i), i)))
         do k = 1, rule%npoint
            call facet_point(rule, k, own_x, measure%axisymmetric, normal(:size(x, 1)), own)
            area = area + measure%thickness(i)*own
         end do
      end associate
   end function area_of

   !> The overlaps of a pair whose slave and normals are known.
   subroutine find_overlaps(self, model, number, master, x, measure, list, error)
      type(coupled_pair_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: number            !! of the pair
      type(surface_type), intent(in) :: master
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      type(area_measure_type), intent(in) :: measure
      type(overlap_list_type), intent(inout) :: list
      type(error_type), allocatable, intent(out) :: error
      type(mortar_kernel_type) :: kernel
      type(overlap_limits_type) :: limits
      type(tree_type) :: tree

      call build_tree(tree, master%low, master%high)
      associate (slave => self%slave)
         limits%reach = norm2(max(maxval(slave%high, 2), maxval(master%high, 2)) &
            & - min(minval(slave%low, 2), minval(master%low, 2)))
         limits%facing = facing
         allocate (limits%depth(slave%facets%n))
         call depths_of_facets(slave, limits%depth)
         if (model%mesh%ndim == 2) then
            call find_overlaps_2d(slave, self%side, master, tree, x, measure, limits, list)
            return
         end if
         call new_mortar_kernel(kernel, model%mortar_degree)
         call find_overlaps_3d(kernel, slave, self%side, master, tree, x, limits, list)
         if (list%lost > 0) call raise(error, error_code%deck, 'E0316', 'a point of face S'// &
            & to_text(slave%facets%face(list%lost))//' of element '// &
            & to_text(model%mesh%element_label(slave%facets%element(list%lost)))// &
            & ' of '//model%surface(model%pair(number)%slave)%name//' has no place on the face '// &
            & 'opposite', model%pair(number)%at, help='the faces are too distorted to be '// &
            & 'integrated: make them convex, or use TYPE=NODE TO SURFACE')
      end associate
   end subroutine find_overlaps

   !> A surface of faces at the start.
   subroutine shape_of(self, model, cells, number, error)
      type(surface_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: number
      type(error_type), allocatable, intent(out) :: error
      type(facets_type) :: facets

      call new_facets(facets, model%mesh, cells, model%surface(number)%element, &
         & model%surface(number)%face)
      call new_surface(self, model%mesh%ndim, facets)
      call update_surface(self, model%mesh%x, error)
   end subroutine shape_of

   !> Thickness of the elements behind the facets; 1 unless plane.
   function thickness_of(model, facets) result(thickness)
      type(model_type), intent(in) :: model
      type(facets_type), intent(in) :: facets
      real(wp) :: thickness(facets%n)
      integer :: i

      thickness = 1.0_wp
      if (model%mesh%ndim == 3) return
      do i = 1, facets%n
         if (model%mesh%section(facets%element(i)) == 0) cycle
         if (.not. is_flat(model, facets%element(i))) cycle
         thickness(i) = model%section(model%mesh%section(facets%element(i)))%thickness
      end do
   end function thickness_of
end module lopin_mortar_pairs
