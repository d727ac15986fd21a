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
   use lopin_mortar_overlap, only : overlap_list_type
   use lopin_mortar_overlaps_2d, only : find_overlaps_2d
   use lopin_slave_pieces, only : split_slave, piece_normals, whole_weights
   use lopin_mortar_cover, only : cover_type, new_cover
   use lopin_mortar_cells_3d, only : mortar_kernel_type, new_mortar_kernel
   use lopin_mortar_overlaps_3d, only : find_overlaps_3d
   use lopin_mortar, only : mortar_coupling_type, couple
   use lopin_model, only : model_type, pair_type, surface_of, kind_of
   use lopin_wall_depth, only : depths_of_facets
   use lopin_tilting, only : rows_needed
   implicit none
   private
   public :: couple_pair, is_mortar, shape_of, thickness_of

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

   !> The coupling of a pair on the shape at the start, or at other places of the nodes; its slave
   !> in smooth pieces.
   subroutine couple_pair(self, model, cells, number, tied, slave, side, width, error, places)
      type(mortar_coupling_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: number            !! of the pair
      logical, intent(in) :: tied
      type(surface_type), intent(out) :: slave
      real(wp), allocatable, intent(out) :: side(:, :)   !! (3, slave%nnode) outward
      real(wp), intent(out) :: width   !! of the narrowest part of the master, in facets; huge: wide
      type(error_type), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: places(:, :)     !! (ndim, nnode) [length]
      type(surface_type) :: master
      real(wp), allocatable :: x(:, :)
      type(facet_rule_type) :: rules(6)
      type(tree_type) :: tree
      type(overlap_list_type) :: list
      type(cover_type) :: cover
      real(wp), allocatable :: thickness(:), full(:), share(:)
      integer, allocatable :: piece(:)
      integer :: i
      logical :: axisymmetric

      width = huge(1.0_wp)
      x = model%mesh%x
      if (present(places)) x = places
      call shape_of(slave, model, cells, model%pair(number)%slave, error)
      if (allocated(error)) return
      call shape_of(master, model, cells, model%pair(number)%master, error)
      if (allocated(error)) return
      if (present(places)) then
         call update_surface(slave, x, error)
         if (.not. allocated(error)) call update_surface(master, x, error)
         if (allocated(error)) return
      end if
      call build_tree(tree, master%low, master%high)
      call new_facet_rules(rules)
      call split_slave(slave, rules, x, piece)
      thickness = thickness_of(model, slave%facets)
      axisymmetric = model%kind == kind_of%axisymmetric
      allocate (side(3, slave%nnode), full(slave%nnode), source=0.0_wp)
      call piece_normals(slave, rules, x, axisymmetric, side(:model%mesh%ndim, :))
      allocate (share(slave%facets%n))
      call whole_weights(slave, rules, x, axisymmetric, thickness, full, share)
      call find_overlaps(list, error)
      if (allocated(error)) return
      call new_cover(cover, full, share, tied, rows_needed(model, number))
      call couple(self, rules, slave, master, x, axisymmetric, thickness, list, cover)
      if (.not. tied) width = narrowest_part(slave, [(facet_area(i), i=1, slave%facets%n)], list, &
         & cover)

   contains

      real(wp) function facet_area(i) result(area)
         integer, intent(in) :: i
         real(wp) :: normal(3), own
         integer :: k

         area = 0.0_wp
         associate (rule => rules(slave%facets%cell(i)), &
            & own_x => x(:, slave%facets%node(:slave%facets%nnode(i), i)))
            do k = 1, rule%npoint
               call facet_point(rule, k, own_x, axisymmetric, normal(:size(x, 1)), own)
               area = area + thickness(i)*own
            end do
         end associate
      end function facet_area

      subroutine find_overlaps(list, error)
         type(overlap_list_type), intent(inout) :: list
         type(error_type), allocatable, intent(out) :: error
         type(mortar_kernel_type) :: kernel
         real(wp), allocatable :: depth(:)
         real(wp) :: reach
         integer :: lost

         reach = norm2(max(maxval(slave%high, 2), maxval(master%high, 2)) &
            & - min(minval(slave%low, 2), minval(master%low, 2)))
         allocate (depth(slave%facets%n))
         call depths_of_facets(slave, facing, depth)
         if (model%mesh%ndim == 2) then
            call find_overlaps_2d(slave, side, master, tree, x, axisymmetric, &
               & thickness, reach, facing, list, depth)
            return
         end if
         call new_mortar_kernel(kernel, model%mortar_degree)
         call find_overlaps_3d(kernel, slave, side, master, tree, x, reach, facing, &
            & list, lost, depth)
         if (lost > 0) call raise(error, error_code%deck, 'E0316', 'a point of face S'// &
            & to_text(slave%facets%face(lost))//' of element '// &
            & to_text(model%mesh%element_label(slave%facets%element(lost)))// &
            & ' of '//model%surface(model%pair(number)%slave)%name//' has no place on the face '// &
            & 'opposite', &
            & model%pair(number)%at, help='the faces are too distorted to be integrated: make '// &
            & 'them '// &
            & 'convex, or use TYPE=NODE TO SURFACE')
      end subroutine find_overlaps
   end subroutine couple_pair

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
      if (model%kind /= kind_of%plane_strain .and. model%kind /= kind_of%plane_stress) return
      do i = 1, facets%n
         if (model%mesh%section(facets%element(i)) == 0) cycle
         thickness(i) = model%section(model%mesh%section(facets%element(i)))%thickness
      end do
   end function thickness_of
end module lopin_mortar_pairs
