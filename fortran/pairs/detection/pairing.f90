!> What lies opposite the slave points of all pairs at the start: a tool, facets, or their mean.
!>
!> Small sliding: the projection is made on the shape at the start. Pairs that can never touch, or
!> were described the wrong way round, are named.
module lopin_pairing
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, new_facets
   use lopin_slave_points, only : slave_type, new_slave
   use lopin_element_type, only : cells_of_words
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projection, find_projections
   use lopin_joint_foot, only : share_joint
   use lopin_wall_depth, only : depths_of_nodes
   use lopin_mortar_pairs, only : coupled_pair_type, couple_pair, is_mortar, shape_of
   use lopin_model, only : model_type, surface_of
   use lopin_contact_points, only : contact_points_type, no_contact_points, reserve, add_point, &
      & facing, pair_is_tied, gaps_as_meshed
   use lopin_moves_away, only : check_moves_away
   use lopin_wrong_side, only : count_behind
   use lopin_skins, only : weigh_sharp_nodes
   use lopin_tool_points, only : pair_with_tool
   implicit none
   private
   public :: new_contact_points

contains

   !> Slave points of all pairs, and what lies opposite each at the start.
   subroutine new_contact_points(self, model, log, error)
      type(contact_points_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(cell_type), allocatable :: cells(:)
      type(slave_type) :: slave
      integer :: pair

      call cells_of_words(model%element_word, cells)
      call no_contact_points(self, size(model%pair))
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair))
            self%first(pair:pair + 1) = self%n + 1
            ! A surface meets itself on its present shape only, see lopin_nonlinear_points.
            if (p%slave == p%master) cycle
            call new_slave(slave, model, cells, model%surface(p%slave), error)
            if (allocated(error)) return
            if (model%surface(p%master)%kind == surface_of%tool) then
               self%tool(pair) = model%surface(p%master)%tool
               self%body(pair) = model%tool(self%tool(pair))%rigid_body
               call pair_with_tool(self, model, pair, slave)
               call weigh_sharp_nodes(self, model, cells, pair)
            else if (is_mortar(model, p)) then
               call pair_by_mortar(self, model, cells, pair, slave, log, error)
               if (allocated(error)) return
            else
               call pair_with_surface(self, model, cells, pair, slave, error)
               if (allocated(error)) return
               call weigh_sharp_nodes(self, model, cells, pair)
            end if
            self%first(pair + 1) = self%n + 1
            if (model%start%step == 0) call check_sides(self, model, pair, log, error)
            if (allocated(error)) return
         end associate
      end do
      call remember_start(self)
   end subroutine new_contact_points

   subroutine remember_start(self)
      type(contact_points_type), intent(inout) :: self

      self%start_facet = self%facet(:self%n)
      self%start_foot = self%foot(:, :self%n)
      self%start_normal = self%normal(:, :self%n)
   end subroutine remember_start

   subroutine pair_with_surface(self, model, cells, pair, slave, error)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(slave_type), intent(in) :: slave
      type(error_type), allocatable, intent(out) :: error
      type(facets_type) :: facets
      type(surface_type) :: master
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(projection_type), allocatable :: found(:)
      integer :: i, n, ndim
      type(surface_type) :: shape
      real(wp) :: depth(size(slave%node))
      logical :: tied

      ndim = model%mesh%ndim
      tied = pair_is_tied(model, model%pair(pair))
      depth = huge(1.0_wp)
      if (model%surface(model%pair(pair)%slave)%kind == surface_of%faces) then
         call shape_of(shape, model, cells, model%pair(pair)%slave, error)
         if (allocated(error)) return
         call depths_of_nodes(shape, model%mesh%x, slave%normal(:ndim, :), depth)
      end if
      associate (surface => model%surface(model%pair(pair)%master))
         call new_facets(facets, model%mesh, cells, surface%element, surface%face)
      end associate
      call new_surface(master, ndim, facets, model%pair(pair)%smooth)
      call update_surface(master, model%mesh%x, error)
      if (allocated(error)) return
      call build_tree(tree, master%low, master%high)
      limits%extension = model%pair(pair)%extension
      limits%cosine = facing
      allocate (found(size(slave%node)))
      call find_projections(master, tree, model%mesh%x(:, slave%node), slave%normal(:ndim, :), &
         & limits, found)
      do i = 1, size(slave%node)
         if (found(i)%facet == 0 .or. found(i)%gap >= -depth(i)) cycle
         limits%depth = depth(i)
         call find_projection(master, tree, model%mesh%x(:, slave%node(i)), &
            & slave%normal(:ndim, i), limits, found(i))
      end do
      do i = 1, size(slave%node)
         call add_point(self, pair, slave, i)
         n = self%n
         self%depth(n) = depth(i)
         if (found(i)%facet == 0) cycle
         if (.not. tied) call share_joint(master, model%mesh%x(:, slave%node(i)), found(i))
         self%facet(n) = found(i)%facet
         self%xi(:, n) = found(i)%xi
         self%normal(:, n) = found(i)%normal
         self%foot(:, n) = found(i)%point
         self%gap(n) = found(i)%gap
         self%shape(:size(found(i)%shape), n) = found(i)%shape
         self%master(:facets%nnode(found(i)%facet), &
            & n) = facets%node(:facets%nnode(found(i)%facet), found(i)%facet)
      end do
   end subroutine pair_with_surface

   !> How much too large the force of a part is, measured with stiff punches at every place on a
   !> mesh of quadrilaterals, 14, 7 and 5 % at a width of 1, 1.25 and 1.5 facets, and of triangles
   !> of constant strain, 29, 20 and 17 %.
   subroutine say_narrow(model, cells, pair, slave, width, log)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(surface_type), intent(in) :: slave
      real(wp), intent(in) :: width            !! in facets
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: text
      real(wp) :: more
      integer :: i

      associate (p => model%pair(pair))
         text = 'a part of '//model%surface(p%master)%name//' is narrower than the facets of '// &
            & model%surface(p%slave)%name//' opposite: force and pressure are those of a '// &
            & 'coarse facet'
         if (width >= 1.0_wp) then
            more = 14.0_wp*width**(-2.5_wp)
            do i = 1, slave%facets%n
               associate (cell => cells(model%mesh%etype(slave%facets%element(i))))
                  if (cell%nnode == cell%ndim + 1) more = 29.0_wp*width**(-1.4_wp)
               end associate
            end do
            text = 'a part of '//model%surface(p%master)%name//' is about '//to_text(width, 2)// &
               & ' facets of '//model%surface(p%slave)%name//' wide: at a given motion its '// &
               & 'force may be '//to_text(more, 1)//' % too large'
         end if
         call log%say(severity%warning, 'W0336', text, p%at, &
            & help='a finer mesh there, or the narrow side as slave')
      end associate
   end subroutine say_narrow

   !> Surface to surface: each slave node meets a weighted mean of the master. A node on a sharp
   !> edge has a point for each of its smooth pieces.
   subroutine pair_by_mortar(self, model, cells, pair, slave, log, error)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(slave_type), intent(in) :: slave
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(coupled_pair_type) :: coupled
      type(surface_type) :: opposite
      integer :: i, j, k, m
      logical :: tied

      tied = pair_is_tied(model, model%pair(pair))
      call couple_pair(coupled, model, cells, pair, tied, error)
      if (allocated(error)) return
      if (tied) call shape_of(opposite, model, cells, model%pair(pair)%master, error)
      if (allocated(error)) return
      if (coupled%width < 2.0_wp) call say_narrow(model, cells, pair, coupled%slave, &
         & coupled%width, log)
      associate (coupling => coupled%rows, shape => coupled%slave)
         m = size(self%master, 1)
         do j = 1, coupling%n
            m = max(m, coupling%first(j + 1) - coupling%first(j) + merge(8, 0, tied))
         end do
         call reserve(self, size(self%pair), m)
         j = 1
         i = 1
         do k = 1, shape%nnode
            if (slave%node(i) /= shape%node(k)) i = i + 1
            call add_point(self, pair, slave, i)
            self%side(:, self%n) = coupled%side(:, k)
            if (j > coupling%n) cycle
            if (coupling%place(j) /= k) cycle
            associate (n => self%n, from => coupling%first(j), to => coupling%first(j + 1) - 1)
               self%weight(n) = coupling%weight(j)
               self%facet(n) = coupling%facet(j)
               self%normal(:, n) = coupling%normal(:, j)
               self%gap(n) = coupling%gap(j)
               if (gaps_as_meshed(model, model%pair(pair))) self%above(n) = coupling%above(j)
               self%foot(:model%mesh%ndim, n) = model%mesh%x(:, shape%node(k))
               self%foot(:, n) = self%foot(:, n) - coupling%gap(j)*coupling%normal(:, j)
               self%master(:to - from + 1, n) = coupling%other(from:to)
               self%shape(:to - from + 1, n) = coupling%p(from:to)
               if (tied .and. coupling%facet(j) > 0) call name_facet(self%master(:, n), &
                  & opposite%facets%node(:, coupling%facet(j)), to - from + 1)
            end associate
            j = j + 1
         end do
      end associate
   end subroutine pair_by_mortar

   !> All nodes of the facet opposite stand in the list, those without a share too: they say how a
   !> tie across a gap turns.
   pure subroutine name_facet(master, node, n)
      integer, intent(inout) :: master(:)
      integer, intent(in) :: node(:), n        !! of the facet, zeros behind; in the list so far
      integer :: k, m

      m = n
      do k = 1, size(node)
         if (node(k) == 0) exit
         if (any(master(:m) == node(k))) cycle
         m = m + 1
         master(m) = node(k)
      end do
   end subroutine name_facet

   !> A pair that lies behind its master was described the wrong way round. Points that
   !> look away from what they lie in front of, as the outside of a tube over a mandrel, may meet
   !> another wall of it later.
   subroutine check_sides(self, model, pair, log, error)
      type(contact_points_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: lies
      integer :: nodes, behind
      logical :: wrong

      associate (p => model%pair(pair), slave => model%surface(model%pair(pair)%slave)%name, &
         & master => model%surface(model%pair(pair)%master)%name)
         if (any(self%facet(self%first(pair):self%n) > 0)) then
            if (self%tool(pair) > 0) call check_chord(self, model, pair, log)
            call check_moves_away(self, model, pair, log)
            return
         end if
         call count_behind(self, model, pair, nodes, behind, wrong)
         if (wrong) then
            lies = 'all '//to_text(nodes)
            if (behind < nodes) lies = to_text(behind)//' of '//to_text(nodes)
            lies = lies//' slave nodes of '//slave//' lie behind '//master
            if (behind < nodes) lies = lies//', and no other lies in front of it'
            call raise(error, error_code%deck, 'E0312', lies, p%at, &
               & help='reverse the order of its segments (the outward normal is on ' &
               & //'the left of the way) or the corners of its facets, or use the other side '// &
               & 'of its faces')
         else
            lies = ''
            if (behind > 0) lies = ', and '//to_text(behind)//' lie behind it'
            call log%say(severity%warning, 'W0315', 'no node of '//slave//' has a point of '// &
               & master//' opposite at the start'//lies//': the pair can never touch unless a '// &
               & 'motion brings them face to face', p%at, help='check the '// &
               & 'positions, and that slave and master look at each other: a profile has its '// &
               & 'outward side on the left of the way, a rigid mesh on SPOS or SNEG')
         end if
      end associate
   end subroutine check_sides

   !> Facets of a tool that are coarse beside those of the slave press their edges into it.
   subroutine check_chord(self, model, pair, log)
      type(contact_points_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      real(wp), parameter :: coarse = 0.02_wp
      real(wp) :: ratio
      integer :: i
      character(len=:), allocatable :: text

      associate (tool => model%tool(self%tool(pair)))
         if (.not. allocated(tool%shape%chord)) return
         ratio = 0.0_wp
         do i = self%first(pair), self%n
            if (self%facet(i) == 0 .or. self%gap(i) > self%size(i)) cycle
            ratio = max(ratio, tool%shape%chord(self%facet(i))/self%size(i))
         end do
         if (.not. ratio > coarse) return
         text = 'the facets of '//tool%name//' stand up to '//to_text(100.0_wp*ratio, 3)// &
            & ' % of a slave facet off the curved surface they mean'
         if (tool%shape%curved) then
            call log%say(severity%note, 'N0332', text//': they are curved by the normals of '// &
               & 'their corners', model%pair(pair)%at, &
               & help='SMOOTH=NO on *SURFACE if the facets are meant as they are')
         else
            call log%say(severity%warning, 'W0332', text, model%pair(pair)%at, &
               & help='finer triangles, SMOOTH=YES, or an analytical tool')
         end if
      end associate
   end subroutine check_chord
end module lopin_pairing
