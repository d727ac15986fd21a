!> Mortar on the present shape: overlaps, rows with exact slopes; in the plane forces and tangents.
!>
!> Weights, normals and couplings follow the motion. Slip is the frame-indifferent increment of
!> the weighted positions: with the coefficients c of a row (lopin_mortar_node_2d) and those at the
!> start of the increment, s = P_n sum (c_start - c) x / D (Puso and Laursen 2004; Gitterle et al.
!> 2010).
module lopin_mortar_element
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, dual_width, variable, constant, dual_dot, operator(+), &
      & operator(-), operator(*), operator(/), assignment(=)
   use lopin_facets, only : facets_type, facet_rule_type
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_search, only : tree_type
   use lopin_error, only : error_type, error_code, raise
   use lopin_model, only : model_type
   use lopin_flat_elements, only : is_ring
   use lopin_wall_depth, only : depths_of_facets
   use lopin_tilting, only : rows_needed
   use lopin_dofs, only : dofs_type
   use lopin_contact_points, only : pair_is_tied, gaps_as_meshed
   use lopin_mortar_pairs, only : thickness_of
   use lopin_mortar_overlap, only : overlap_list_type, overlap_limits_type, area_measure_type
   use lopin_mortar_overlaps_2d, only : find_overlaps_2d
   use lopin_mortar_overlaps_3d, only : find_overlaps_3d
   use lopin_slave_pieces, only : split_slave, piece_normals, whole_weights
   use lopin_mortar, only : plan_rows
   use lopin_mortar_cover, only : cover_type, new_cover, has_row, taken_over
   use lopin_mortar_patch_2d, only : patch_type, met_row_type, basis_functions_type, new_patch
   use lopin_mortar_node_2d, only : mortar_row_type, mortar_row
   use lopin_plain_node_2d, only : plain_row_type => mortar_row_type, plain_row => mortar_row
   use lopin_plain, only : plain => constant
   use lopin_mortar_least, only : least_of_nodes, lift_of_row
   use lopin_nonlinear_points, only : stays_mortar
   use lopin_contact_row, only : row_type, point_state_type, point_law_type
   use lopin_row_element, only : begin_row, press_row, last_block, end_row
   use lopin_local_matrix, only : local_matrix_type
   use lopin_mortar_cells_3d, only : new_mortar_kernel
   use lopin_mortar_rows_3d, only : space_row_type => mortar_row_type
   use lopin_master_surfaces, only : masters_type
   use lopin_closest_feature, only : opposite_type
   use lopin_mortar_element_3d, only : space_mortar_type, update_space_mortar, evaluate_space_point
   use lopin_tie_element, only : tie_type, new_tie, evaluate_tie
   implicit none
   private
   public :: present_mortar_type, mortar_anchor_type, new_present_mortar
   public :: update_mortar, find_mortar_row, evaluate_mortar_point, lay_pieces

   !> n_slave.n_master must be below this for the two to face each other.
   real(wp), parameter :: facing = -0.2_wp

   !> A pair on the present shape.
   type :: present_mortar_type
      logical :: is_on = .false.
      type(surface_type) :: slave
      real(wp), allocatable :: thickness(:)    !! (slave facets) [length]
      real(wp), allocatable :: depth(:)        !! (slave facets) deeper is no contact [length]
      type(overlap_list_type) :: list
      logical :: axisymmetric = .false.
      integer, allocatable :: piece(:)         !! (slave facets) smooth piece, lopin_slave_pieces
      integer, allocatable :: piece_of(:)      !! (slave%nnode)
      type(cover_type) :: cover
      integer :: pair = 1                      !! of the model
      integer :: first = 1                     !! point of the pair that is the slave's first number
      logical :: in_space = .false.
      logical :: tied = .false.
      logical, allocatable :: lifts(:)         !! (slave%nnode) no gap is less than the least that
                                               !! it weighs
      integer, allocatable :: nearest(:)       !! (slave%nnode) overlap of that; plane
      logical :: renews = .false.              !! what that adds is found anew at these places
      logical :: is_ready = .false.            !! ties keep their first rows
      type(space_mortar_type) :: space
   end type present_mortar_type

   !> The row of a node when the increment began.
   type :: mortar_anchor_type
      logical :: set = .false.
      integer :: place = 0                     !! in space: number of the node on the slave
      integer, allocatable :: node(:)
      real(wp), allocatable :: coefficient(:)  !! [area]
      real(wp) :: lift = 0.0_wp                !! of the gap above the mean of the row now; plane
      type(tie_type) :: tie
   end type mortar_anchor_type

contains

   !> A surface-to-surface pair on the shape at the start.
   subroutine new_present_mortar(self, model, number, facets, rules, first, moved)
      type(present_mortar_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: number               !! of the pair
      type(facets_type), intent(in) :: facets     !! of the slave
      type(facet_rule_type), intent(in) :: rules(:)
      integer, intent(in) :: first                !! point of the pair
      logical, intent(in) :: moved(:)             !! (points) by ADJUST

      self%is_on = stays_mortar(model, model%pair(number))
      if (.not. self%is_on) return
      self%pair = number
      self%first = first
      call new_surface(self%slave, model%mesh%ndim, facets)
      self%thickness = thickness_of(model, facets)
      self%axisymmetric = is_ring(model, model%pair(number)%slave)
      self%in_space = model%mesh%ndim == 3
      self%tied = pair_is_tied(model, model%pair(number))
      if (self%in_space) call new_mortar_kernel(self%space%kernel, model%mortar_degree)
      call lay_pieces(self, rules, model%mesh%x)
      ! Pieces have points of their own where they meet.
      self%lifts = gaps_as_meshed(model, model%pair(number)) &
         & .and. .not. moved(first:first + self%slave%nnode - 1)
      self%space%lifts = self%lifts
      self%cover%least = rows_needed(model, number)
   end subroutine new_present_mortar

   !> Cut the slave at its sharp edges; nothing is covered yet.
   subroutine lay_pieces(self, rules, x)
      type(present_mortar_type), intent(inout) :: self
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)             !! (ndim, nnode) at the start [length]
      real(wp), allocatable :: full(:)
      real(wp) :: share(self%slave%facets%n)
      type(error_type), allocatable :: error
      integer :: i

      call split_slave(self%slave, rules, x, self%piece)
      allocate (full(self%slave%nnode), self%piece_of(self%slave%nnode))
      do i = 1, self%slave%facets%n
         self%piece_of(self%slave%local(:self%slave%facets%nnode(i), i)) = self%piece(i)
      end do
      call whole_weights(self%slave, rules, x, self%axisymmetric, self%thickness, full, &
         & share)
      call new_cover(self%cover, full, share, self%tied)
      allocate (self%depth(self%slave%facets%n), source=huge(1.0_wp))
      call update_surface(self%slave, x, error)
      if (.not. allocated(error)) call depths_of_facets(self%slave, self%depth)
   end subroutine lay_pieces

   !> The overlaps at present places.
   subroutine update_mortar(self, rules, master, tree, x, start, with_slopes, error)
      type(present_mortar_type), intent(inout) :: self
      type(facet_rule_type), intent(in) :: rules(:)
      type(surface_type), intent(in) :: master
      type(tree_type), intent(in) :: tree
      real(wp), intent(in) :: x(:, :)             !! (ndim, nnode) [length]
      logical, intent(in) :: start                !! of an increment
      logical, intent(in) :: with_slopes          !! of the rows in space: a tangent is wanted
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: normal(size(x, 1), self%slave%nnode), direction(3, self%slave%nnode)
      type(overlap_limits_type) :: limits

      if (self%tied .and. self%is_ready) return
      self%is_ready = .true.
      call update_surface(self%slave, x, error)
      if (allocated(error)) return
      if (start .or. .not. allocated(self%slave%outlook)) self%slave%outlook &
         & = self%slave%disc(4:6, :)
      call piece_normals(self%slave, rules, x, self%axisymmetric, normal)
      limits = overlap_limits_type(norm2(max(maxval(self%slave%high, 2), maxval(master%high, 2)) &
         & - min(minval(self%slave%low, 2), minval(master%low, 2))), facing, self%depth)
      self%list%n = 0
      if (self%in_space) then
         call find_overlaps_3d(self%space%kernel, self%slave, normal, master, tree, x, limits, &
            & self%list)
      else
         call find_overlaps_2d(self%slave, normal, master, tree, x, area_measure_type( &
            & self%axisymmetric, self%thickness), limits, self%list)
      end if
      if (self%list%lost > 0) then
         call raise(error, error_code%not_converged, 'E0316', 'a face of a surface-to-surface '// &
            & 'pair is too distorted to be integrated')
         return
      end if
      call plan_rows(self%cover, rules, self%slave, master, x, self%list, start, direction)
      if (self%in_space) then
         call update_space_mortar(self%space, self%cover, self%slave, master, x, self%list, start, &
            & with_slopes)
         return
      end if
      self%renews = start .or. with_slopes
      if (.not. allocated(self%nearest)) allocate (self%nearest(self%slave%nnode), source=0)
      if (.not. (any(self%lifts) .and. self%renews)) return
      call least_of_nodes(self%slave, self%list, self%nearest)
      where (.not. self%lifts) self%nearest = 0
   end subroutine update_mortar

   !> The row of a node by values, if enough of it is covered; the first one within an increment
   !> is the anchor of its slip.
   subroutine find_mortar_row(self, masters, point, start, patch, anchor, opposite)
      type(present_mortar_type), intent(in) :: self
      type(masters_type), intent(in) :: masters
      integer, intent(in) :: point
      logical, intent(in) :: start                !! of an increment
      type(patch_type), intent(out) :: patch
      type(mortar_anchor_type), intent(inout) :: anchor
      type(opposite_type), intent(inout) :: opposite   !! facet: 1 if enough is covered, else 0
      integer :: k

      k = point - self%first + 1
      opposite%facet = 1
      if (anchor%tie%set) return
      opposite%facet = 0
      opposite%normal = 0.0_wp
      opposite%found%gap = 0.0_wp
      opposite%foot%gap = 0.0_wp
      associate (surface => masters%of(self%pair)%surface)
         if (self%in_space) then
            anchor%place = k
            call take_space_row(self%space%row(k))
         else
            if (start) anchor%set = .false.
            if (has_row(self%cover, k)) call take_plane_row(surface)
         end if
      end associate
      opposite%foot%gap = opposite%found%gap

   contains

      subroutine take_space_row(own)
         type(space_row_type), intent(in) :: own

         if (own%node == 0 .or. .not. own%weight > 0.0_wp) return
         opposite%facet = 1
         opposite%normal = own%normal
         opposite%found%gap = own%gap
         if (self%tied) call new_tie(anchor%tie, self%slave%node(k), own%of, own%c, own%weight, &
            & self%slave%facets, masters%rules, masters%x)
      end subroutine take_space_row

      subroutine take_plane_row(master)
         type(surface_type), intent(in) :: master
         type(plain_row_type) :: row
         integer, allocatable :: also(:)
         real(wp), allocatable :: share(:)

         call taken_over(self%cover, k, also, share)
         call new_patch(patch, self%slave, master, self%list, basis_functions_type( &
            & self%slave%node([k, also]), [1.0_wp, share], self%piece_of([k, also])), self%piece, &
            & self%cover%share)
         call plain_row(row, patch, plain(masters%x(:2, patch%node)), self%axisymmetric, &
            & self%thickness(1))
         if (self%renews) then
            anchor%lift = 0.0_wp
            if (self%nearest(k) > 0 .and. row%weight%v > 0.0_wp) anchor%lift &
               & = lift_of_row(self%list%item(self%nearest(k)), self%slave, master, masters%x, &
               & row%normal%v, row%gap%v)
         end if
         patch%lift = anchor%lift
         patch%met = met_row_type(row%weight%v, row%normal%v, row%gap%v + patch%lift, &
            & row%coefficient%v)
         if (.not. row%weight%v > 0.0_wp) return
         opposite%facet = 1
         opposite%normal(:2) = row%normal%v
         opposite%found%gap = patch%met%gap
         if (self%tied) call new_tie(anchor%tie, self%slave%node(k), patch%node, &
            & row%coefficient%v, row%weight%v, self%slave%facets, masters%rules, masters%x)
         if (anchor%set) return
         anchor%set = .true.
         anchor%node = patch%node
         anchor%coefficient = row%coefficient%v
      end subroutine take_plane_row
   end subroutine find_mortar_row

   !> Forces and exact tangent of one node, as evaluate_point of lopin_contact_element.
   subroutine evaluate_mortar_point(state, local, self, dofs, x, patch, anchor, law)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(present_mortar_type), intent(in) :: self
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) present places [length]
      type(patch_type), intent(in) :: patch
      type(mortar_anchor_type), intent(in) :: anchor
      type(point_law_type), intent(in) :: law
      integer, allocatable :: node(:), input(:, :), of_anchor(:)
      type(dual_type), allocatable :: force(:)
      type(row_type) :: row
      integer :: n, bound                      !! columns; that of the bound of shear, if it follows

      if (law%enforcement%tied) then
         call evaluate_tie(state, local, anchor%tie, dofs, x, law)
         return
      end if
      if (self%in_space) then
         associate (own => self%space%row(anchor%place))
            call evaluate_space_point(state, local, own, self%space%before(anchor%place), dofs, x, &
               & law)
         end associate
         return
      end if
      call list_inputs()
      allocate (force(local%nu))
      row%ndim = 2
      row%shift = law%shift
      row%has_rows = law%first_row > 0
      bound = n + merge(1, 0, law%follows)
      call begin_row(row, local, bound, law%with_tangent)
      do
         call forces(row%from)
         if (last_block(row, local, force)) exit
      end do
      row%weight = state%weight
      call end_row(state, local, row, law%enforcement, force)
      if (law%follows) then
         local%by_bound = law%at%growth*local%k(:, bound)
         local%k = local%k(:, :n)
      end if

   contains

      !> Places of the patch, then those that only the anchor has; their free dofs are the inputs.
      subroutine list_inputs()
         integer :: all_nodes(size(patch%node) + size(anchor%node)), nnode
         integer :: dof(2*(size(patch%node) + size(anchor%node)) + 2), m, j

         nnode = size(patch%node)
         all_nodes(:nnode) = patch%node
         allocate (of_anchor(size(anchor%node)))
         do m = 1, size(anchor%node)
            of_anchor(m) = findloc(all_nodes(:nnode), anchor%node(m), 1)
            if (of_anchor(m) > 0) cycle
            nnode = nnode + 1
            all_nodes(nnode) = anchor%node(m)
            of_anchor(m) = nnode
         end do
         node = all_nodes(:nnode)
         allocate (input(2, nnode), source=0)
         local%nu = 0
         do m = 1, nnode
            do j = 1, 2
               if (dofs%id(j, node(m)) == 0) cycle
               local%nu = local%nu + 1
               dof(local%nu) = dofs%id(j, node(m))
               input(j, m) = local%nu
            end do
         end do
         n = local%nu
         if (law%first_row > 0) then
            dof(n + 1:n + 2) = dofs%n + law%first_row + [0, 1]
            n = n + 2
         end if
         local%dof = dof(:n)
      end subroutine list_inputs

      subroutine forces(from)
         integer, intent(in) :: from
         type(dual_type) :: place(2, size(node)), moved(2)
         type(mortar_row_type) :: own
         integer :: m, j

         do m = 1, size(node)
            do j = 1, 2
               place(j, m) = variable(x(j, node(m)), merge(input(j, m) - from, 0, input(j, m) > 0))
            end do
         end do
         do j = 1, 2
            row%multiplier(j) = variable(law%lambda(j), merge(local%nu + j - from, 0, &
               & law%first_row > 0))
         end do
         if (law%with_tangent) then
            call mortar_row(own, patch, place(:, :size(patch%node)), self%axisymmetric, &
               & self%thickness(1))
         else
            own = mortar_row_type(constant(patch%met%weight), constant(patch%met%normal), &
               & constant(patch%met%gap), constant(patch%met%coefficient))
         end if
         moved = constant([0.0_wp, 0.0_wp])
         do m = 1, size(anchor%node)
            moved = moved + place(:, of_anchor(m))*anchor%coefficient(m)
         end do
         do m = 1, size(patch%node)
            moved = moved - place(:, m)*own%coefficient(m)
         end do
         moved(1) = moved(1)/own%weight
         moved(2) = moved(2)/own%weight
         row%slip(:2) = moved - own%normal*dual_dot(moved, own%normal)
         row%normal(:2) = own%normal
         row%gap = own%gap
         if (law%follows) then
            call press_row(row, law, variable(law%at%growth, bound - from))
         else
            call press_row(row, law)
         end if
         force = constant(spread(0.0_wp, 1, local%nu))
         do m = 1, size(patch%node)
            do j = 1, 2
               if (input(j, m) > 0) force(input(j, m)) = force(input(j, m)) &
                  & + own%coefficient(m)*row%z(j)
            end do
         end do
         state%weight = own%weight%v
         state%normal = 0.0_wp
         state%normal(:2) = own%normal%v
         state%traction = 0.0_wp
         state%traction(:2) = row%z(:2)%v
      end subroutine forces
   end subroutine evaluate_mortar_point
end module lopin_mortar_element
