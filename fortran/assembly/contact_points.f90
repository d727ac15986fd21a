!> Slave points of all pairs: what each weighs, what lies opposite, along which normal, how far.
!>
!> Small sliding: the projection is made on the shape at the start; a rigid tool is projected where
!> it stands at the end of the increment, so that its path may be long while the piece's is short. A
!> point in a concave corner of a tool has two entries, one a wall.
module lopin_contact_points
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_facets, only : facets_type, new_facets
   use lopin_slave_points, only : slave_type, new_slave
   use lopin_element_type, only : cells_of_words
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_feature, only : projection_type, limits_type
   use lopin_search, only : tree_type, build_tree, find_projections
   use lopin_tool, only : foot_type, project_all_moved
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_mortar, only : mortar_coupling_type
   use lopin_uneven_pressure, only : warn_of_uneven_pressure
   use lopin_mortar_pairs, only : couple_pair, is_mortar
   use lopin_model, only : model_type, pair_type, surface_of, kind_of, overclosure_of
   implicit none
   private
   public :: contact_points_type, new_contact_points, move_tool, pair_is_tied

   type :: contact_points_type
      integer :: n = 0
      integer, allocatable :: first(:)        !! (npair+1) first point of each pair
      integer, allocatable :: pair(:)         !! (n)
      integer, allocatable :: node(:)         !! (n) slave node
      integer, allocatable :: facet(:)   !! (n) facet of the master surface or segment of the tool;
                                         !! 0: none
      integer, allocatable :: master(:, :)   !! (>= 8, n) nodes opposite, zeros behind the last;
                                             !! none for a tool; may hold slave nodes: lopin_mortar
      real(wp), allocatable :: shape(:, :)    !! (the same) their shares; sum 1
      real(wp), allocatable :: xi(:, :)       !! (2, n)
      real(wp), allocatable :: normal(:, :)   !! (3, n) out of the master
      real(wp), allocatable :: side(:, :)     !! (3, n) slave's own outward normal; 0: unknown
      real(wp), allocatable :: foot(:, :)     !! (3, n) [length]
      real(wp), allocatable :: gap(:)         !! (n) geometric [length]
      real(wp), allocatable :: weight(:)      !! (n) [length^2]
      real(wp), allocatable :: size(:)        !! (n) of the slave's facets there [length]
      integer, allocatable :: start_facet(:)      !! (n) as found at the start, for tools that move
      real(wp), allocatable :: start_foot(:, :), start_normal(:, :)   !! (3, n)
      integer, allocatable :: tool(:)         !! (npair) 0: the master is a mesh
      integer, allocatable :: body(:)         !! (npair) rigid body that moves the tool; 0: fixed
   end type contact_points_type

   !> n_slave.n_master must be below this for the two to face each other.
   real(wp), parameter :: facing = -0.2_wp

contains

   subroutine new_contact_points(self, model, log, error)
      type(contact_points_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(cell_type), allocatable :: cells(:)
      type(slave_type) :: slave
      integer :: pair

      call cells_of_words(model%element_word, cells)
      call clear(self, size(model%pair))
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair))
            self%first(pair:pair + 1) = self%n + 1
            ! A surface meets itself on its present shape only, see lopin_finite_points.
            if (p%slave == p%master) cycle
            call new_slave(slave, model, cells, model%surface(p%slave), error)
            if (allocated(error)) return
            if (model%surface(p%master)%kind == surface_of%tool) then
               self%tool(pair) = model%surface(p%master)%tool
               self%body(pair) = model%tool(self%tool(pair))%rigid_body
               call pair_with_tool(self, model, pair, slave)
            else if (is_mortar(model, p)) then
               call pair_by_mortar(self, model, cells, pair, slave, error)
               if (allocated(error)) return
            else
               call pair_with_surface(self, model, cells, pair, slave, error)
               if (allocated(error)) return
               associate (from => self%first(pair), to => self%n)
                  call warn_of_uneven_pressure(model, cells, pair, self%facet(from:to), &
                     & self%master(:, from:to), self%shape(:, from:to), self%weight(from:to), &
                     & self%size(from:to), log)
               end associate
            end if
            self%first(pair + 1) = self%n + 1
            call check_sides(self, model, pair, log, error)
            if (allocated(error)) return
         end associate
      end do
      call remember_start(self)
   end subroutine new_contact_points

   subroutine clear(self, npair)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: npair

      allocate (self%first(npair + 1), source=1)
      allocate (self%tool(npair), self%body(npair), source=0)
      call reserve(self, 64, 8)
   end subroutine clear

   !> Room for more points or longer lists of masters; the old ones stay.
   subroutine reserve(self, capacity, masters)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: capacity, masters

      call grow_integers(self%pair, capacity)
      call grow_integers(self%node, capacity)
      call grow_integers(self%facet, capacity)
      call grow_table(self%master, masters, capacity)
      call grow_columns(self%shape, masters, capacity)
      call grow_columns(self%xi, 2, capacity)
      call grow_columns(self%normal, 3, capacity)
      call grow_columns(self%side, 3, capacity)
      call grow_columns(self%foot, 3, capacity)
      call grow_reals(self%gap, capacity)
      call grow_reals(self%weight, capacity)
      call grow_reals(self%size, capacity)
   end subroutine reserve

   subroutine grow_integers(array, capacity)
      integer, allocatable, intent(inout) :: array(:)
      integer, intent(in) :: capacity
      integer, allocatable :: longer(:)

      allocate (longer(capacity), source=0)
      if (allocated(array)) longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine grow_integers

   subroutine grow_table(array, rows, capacity)
      integer, allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: rows, capacity
      integer, allocatable :: longer(:, :)

      allocate (longer(rows, capacity), source=0)
      if (allocated(array)) longer(:size(array, 1), :size(array, 2)) = array
      call move_alloc(longer, array)
   end subroutine grow_table

   subroutine grow_reals(array, capacity)
      real(wp), allocatable, intent(inout) :: array(:)
      integer, intent(in) :: capacity
      real(wp), allocatable :: longer(:)

      allocate (longer(capacity), source=0.0_wp)
      if (allocated(array)) longer(:size(array)) = array
      call move_alloc(longer, array)
   end subroutine grow_reals

   subroutine grow_columns(array, rows, capacity)
      real(wp), allocatable, intent(inout) :: array(:, :)
      integer, intent(in) :: rows, capacity
      real(wp), allocatable :: longer(:, :)

      allocate (longer(rows, capacity), source=0.0_wp)
      if (allocated(array)) longer(:size(array, 1), :size(array, 2)) = array
      call move_alloc(longer, array)
   end subroutine grow_columns

   subroutine add_point(self, pair, slave, i)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: pair, i
      type(slave_type), intent(in) :: slave

      if (self%n == size(self%pair)) call reserve(self, 2*self%n, size(self%master, 1))
      self%n = self%n + 1
      self%pair(self%n) = pair
      self%node(self%n) = slave%node(i)
      self%weight(self%n) = slave%weight(i)
      self%size(self%n) = slave%size(i)
      self%side(:, self%n) = slave%normal(:, i)
   end subroutine add_point

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

      ndim = model%mesh%ndim
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
         call add_point(self, pair, slave, i)
         n = self%n
         if (found(i)%facet == 0) cycle
         self%facet(n) = found(i)%facet
         self%xi(:, n) = found(i)%xi
         self%normal(:, n) = found(i)%normal
         self%foot(:, n) = found(i)%point
         self%gap(n) = found(i)%gap
         self%shape(:, n) = found(i)%shape
         self%master(:facets%nnode(found(i)%facet), &
            & n) = facets%node(:facets%nnode(found(i)%facet), found(i)%facet)
      end do
   end subroutine pair_with_surface

   !> Surface to surface: each slave node meets a weighted mean of the master.
   subroutine pair_by_mortar(self, model, cells, pair, slave, error)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(slave_type), intent(in) :: slave
      type(error_type), allocatable, intent(out) :: error
      type(mortar_coupling_type) :: coupling
      integer :: i, j, m

      call couple_pair(coupling, model, cells, model%pair(pair), slave%normal, error)
      if (allocated(error)) return
      m = size(self%master, 1)
      do j = 1, coupling%n
         m = max(m, coupling%first(j + 1) - coupling%first(j))
      end do
      call reserve(self, size(self%pair), m)
      j = 1
      do i = 1, size(slave%node)
         call add_point(self, pair, slave, i)
         if (j > coupling%n) cycle
         if (coupling%node(j) /= slave%node(i)) cycle
         associate (n => self%n, from => coupling%first(j), to => coupling%first(j + 1) - 1)
            self%weight(n) = coupling%weight(j)
            self%facet(n) = coupling%facet(j)
            self%normal(:, n) = coupling%normal(:, j)
            self%gap(n) = coupling%gap(j)
            self%foot(:model%mesh%ndim, n) = model%mesh%x(:, slave%node(i))
            self%foot(:, n) = self%foot(:, n) - coupling%gap(j)*coupling%normal(:, j)
            self%master(:to - from + 1, n) = coupling%other(from:to)
            self%shape(:to - from + 1, n) = coupling%p(from:to)
         end associate
         j = j + 1
      end do
   end subroutine pair_by_mortar

   !> A tool at rest; in a concave corner a point meets both walls.
   subroutine pair_with_tool(self, model, pair, slave)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(slave_type), intent(in) :: slave
      type(rigid_motion_type) :: rest
      type(foot_type) :: feet(2)
      integer :: i, k, nfeet, ndim, entries

      ndim = model%mesh%ndim
      entries = 1
      call new_rigid_motion(rest, spread(0.0_wp, 1, ndim), spread(0.0_wp, 1, ndim), [real(wp) ::])
      associate (tool => model%tool(self%tool(pair))%shape)
         if (size(slave%node) > 0 .and. may_move(model, self%body(pair))) then
            ! A tool that moves may bring a concave corner to any node: room for its second wall.
            call project_all_moved(tool, rest, model%mesh%x(:, slave%node(1)), huge(1.0_wp), feet, &
               & nfeet)
            entries = max(1, nfeet)
         end if
         do i = 1, size(slave%node)
            call project_all_moved(tool, rest, model%mesh%x(:, slave%node(i)), slave%size(i), &
               & feet, nfeet)
            do k = 1, max(entries, nfeet)
               call add_point(self, pair, slave, i)
               if (k <= nfeet) call take_foot(self, self%n, feet(k), model%pair(pair)%extension)
            end do
         end do
      end associate
   end subroutine pair_with_tool

   !> A rigid body is free, or prescribed to go somewhere in some step.
   pure logical function may_move(model, body)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      integer :: i, k, dofs

      may_move = .false.
      if (body == 0) return
      dofs = 6
      if (model%mesh%ndim == 2) dofs = 3
      if (model%kind == kind_of%axisymmetric) dofs = 1
      associate (rigid => model%rigid_body(body))
         do i = 1, size(model%step)
            k = 0
            associate (p => model%step(i)%prescribed)
               may_move = may_move &
                  & .or. any((p%node == rigid%reference .or. p%node == rigid%rotation) &
                  & .and. abs(p%value) > 0.0_wp)
               k = count(p%node == rigid%reference) + count(p%node == rigid%rotation &
                  & .and. rigid%rotation > 0)
            end associate
            may_move = may_move .or. k < dofs
         end do
      end associate
   end function may_move

   !> A foot counts if it is not past the end of the tool and the slave faces it.
   subroutine take_foot(self, n, foot, extension)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: n
      type(foot_type), intent(in) :: foot
      real(wp), intent(in) :: extension

      self%facet(n) = 0
      if (.not. foot%found) return
      self%normal(:, n) = foot%normal
      self%foot(:, n) = foot%point
      self%gap(n) = foot%gap
      if (foot%overhang > extension*self%size(n)) return
      ! On a corner itself the slave's own side says which of the tool's directions meets it.
      if (foot%cone < 1.0_wp .and. -dot_product(self%side(:, n), foot%normal) >= &
         & foot%cone - 1.0e-6_wp) self%normal(:, n) = -self%side(:, n)
      if (any(abs(self%side(:, n)) > 0.0_wp)) then
         if (dot_product(self%side(:, n), foot%normal) > facing) return
      end if
      self%facet(n) = max(1, foot%segment)
   end subroutine take_foot

   subroutine remember_start(self)
      type(contact_points_type), intent(inout) :: self

      self%start_facet = self%facet(:self%n)
      self%start_foot = self%foot(:, :self%n)
      self%start_normal = self%normal(:, :self%n)
   end subroutine remember_start

   !> A point deep inside the moved tool may be nearest to a side that it does not face, as beside
   !> the corner of a punch: it keeps the face that it met at the start, wherever that is now.
   subroutine keep_start(self, i, motion, x)
      type(contact_points_type), intent(inout) :: self
      integer, intent(in) :: i
      type(rigid_motion_type), intent(in) :: motion
      real(wp), intent(in) :: x(:)             !! (ndim) the point [length]
      integer :: n

      if (self%facet(i) > 0 .or. self%start_facet(i) == 0 .or. self%gap(i) >= 0.0_wp) return
      n = size(x)
      self%facet(i) = self%start_facet(i)
      self%normal(:n, i) = motion%turn(self%start_normal(:n, i))
      self%foot(:n, i) = motion%to_global(self%start_foot(:n, i))
      self%gap(i) = dot_product(self%normal(:n, i), x - self%foot(:n, i))
   end subroutine keep_start

   !> Project the points of a pair on its tool in another place.
   subroutine move_tool(self, model, pair, displacement, rotation)
      type(contact_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: displacement(:), rotation(:)  !! of the reference node [length], [rad]
      type(rigid_motion_type) :: motion
      type(foot_type) :: feet(2)
      real(wp) :: reference(model%mesh%ndim)
      integer :: i, k, nfeet

      reference = model%mesh%x(:, model%rigid_body(self%body(pair))%reference)
      call new_rigid_motion(motion, reference, displacement, rotation)
      i = self%first(pair)
      do while (i < self%first(pair + 1))
         associate (tool => model%tool(self%tool(pair))%shape)
            call project_all_moved(tool, motion, model%mesh%x(:, self%node(i)), self%size(i), &
               & feet, nfeet)
         end associate
         do k = 1, 2
            if (k <= nfeet) then
               call take_foot(self, i, feet(k), model%pair(pair)%extension)
               if (feet(k)%overhang <= 0.0_wp) call keep_start(self, i, motion, &
                  & model%mesh%x(:, self%node(i)))
            end if
            i = i + 1
            if (i >= self%first(pair + 1)) exit
            if (self%node(i) /= self%node(i - 1)) exit
            self%facet(i) = 0
         end do
      end do
   end subroutine move_tool

   !> A pair whose points all lie behind their master was described the wrong way round.
   subroutine check_sides(self, model, pair, log, error)
      type(contact_points_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: i, behind

      associate (p => model%pair(pair), slave => model%surface(model%pair(pair)%slave)%name, &
         & master => model%surface(model%pair(pair)%master)%name)
         if (any(self%facet(self%first(pair):self%n) > 0)) then
            if (self%tool(pair) > 0) call check_chord(self, model, pair, log)
            return
         end if
         behind = 0
         do i = self%first(pair), self%n
            if (dot_product(self%side(:, i), self%normal(:, i)) > 0.2_wp) behind = behind + 1
         end do
         if (behind == self%n - self%first(pair) + 1 .and. behind > 0) then
            call raise(error, error_code%deck, 'E0312', 'all '//to_text(behind)// &
               & ' slave nodes of '//slave// &
               & ' lie behind '//master, p%at, &
               & help='reverse the order of its segments (the outward normal is on ' &
               & //'the left of the way) or the corners of its facets, or use the other side '// &
               & 'of its faces')
         else
            call log%say(severity%warning, 'W0315', 'no node of '//slave//' has a point of '// &
               & master// &
               & ' opposite: the pair can never touch', p%at, &
               & help='check the positions, and that the slave''s '// &
               & 'faces look at the master')
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

      associate (tool => model%tool(self%tool(pair)))
         if (.not. allocated(tool%shape%chord)) return
         ratio = 0.0_wp
         do i = self%first(pair), self%n
            if (self%facet(i) == 0 .or. self%gap(i) > self%size(i)) cycle
            ratio = max(ratio, tool%shape%chord(self%facet(i))/self%size(i))
         end do
         if (ratio > coarse) call log%say(severity%warning, 'W0332', 'the facets of '// &
            & tool%name//' stand up to '//to_text(100.0_wp*ratio)//' % of a slave facet off the '// &
            & 'curved surface they mean', model%pair(pair)%at, &
            & help='finer triangles, or an analytical tool')
      end associate
   end subroutine check_chord

   !> The pair glues: all directions, both ways.
   pure logical function pair_is_tied(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      pair_is_tied = pair%tied &
         & .or. model%interaction(pair%interaction)%overclosure == overclosure_of%tied
   end function pair_is_tied
end module lopin_contact_points
