!> Contact points of the nonlinear path: slave nodes of all pairs, with areas, sizes, moduli,
!> initial gaps.
module lopin_nonlinear_points
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type, severity
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_model, only : model_type, pair_type, surface_of
   use lopin_surface_material, only : slave_yields
   use lopin_slave_points, only : slave_type, new_slave
   use lopin_contact_points, only : contact_points_type, face_type
   use lopin_pairing, only : new_contact_points
   use lopin_mortar_pairs, only : is_mortar
   use lopin_initial_gaps, only : initial_gap_type, new_initial_gaps
   use lopin_surface_material, only : youngs_modulus, extreme_moduli
   implicit none
   private
   public :: nonlinear_points_type, growth_type, new_nonlinear_points, is_self_contact, stays_mortar

   !> Area of a point now over that at the start of the increment, and its slopes.
   type :: growth_type
      real(wp) :: ratio = 1.0_wp
      integer, allocatable :: dof(:)           !! of the nodes around; not allocated: slopes unused
      real(wp), allocatable :: slope(:)        !! [1/length]
   end type growth_type

   type :: nonlinear_points_type
      integer :: n = 0
      integer, allocatable :: pair(:), node(:)
      integer, allocatable :: entry(:)         !! 1, or 2 for the second wall of a concave corner
      real(wp), allocatable :: weight(:)       !! area at the start of the increment [length^2]
      real(wp), allocatable :: size(:)         !! of the slave's facets [length]
      real(wp), allocatable :: depth(:)        !! deeper is no contact [length]
      integer, allocatable :: corner(:, :)     !! (2, n), and
      real(wp), allocatable :: share(:)        !! (n) as in lopin_contact_points
      type(face_type), allocatable :: face(:)  !! of slaves whose tools have creases
      real(wp), allocatable :: side(:, :)      !! (3, n) slave's outward normal; 0: unknown
      real(wp), allocatable :: shift(:)        !! added to gaps: ADJUST, CLEARANCE [length]
      real(wp), allocatable :: overclosure(:)  !! at the start, ramped in [length]
      real(wp), allocatable :: early(:)        !! the same of rows where no node touches [length]
      logical, allocatable :: touches(:)       !! closed at the start
      real(wp), allocatable :: modulus(:)      !! of the softer side, 1D [stress]
      real(wp), allocatable :: slave_modulus(:)   !! of the slave side [stress]
      real(wp), allocatable :: yield(:)        !! at the slave; 0: unknown [stress]
      type(growth_type), allocatable :: growth(:)
   end type nonlinear_points_type

contains

   !> Slave points of all pairs for the nonlinear path.
   subroutine new_nonlinear_points(self, model, log, error)
      type(nonlinear_points_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(model_type) :: plain
      type(contact_points_type) :: points
      type(initial_gap_type) :: initial
      type(cell_type), allocatable :: cells(:)
      integer :: pair, i

      ! What the start says is said as for node to segment; a surface against itself starts free.
      do pair = 1, size(model%pair)
         if (.not. is_mortar(model, model%pair(pair))) cycle
         if (stays_mortar(model, model%pair(pair))) cycle
         call log%say(severity%note, 'N0304', 'pair ('// &
            & model%surface(model%pair(pair)%slave)%name//', '// &
            & model%surface(model%pair(pair)%master)%name//') of surface to surface is read as '// &
            & 'NODE TO SURFACE against itself', model%pair(pair)%at)
      end do
      plain = model
      do pair = 1, size(model%pair)
         plain%pair(pair)%surface_to_surface = stays_mortar(model, model%pair(pair))
      end do
      call new_contact_points(points, plain, log, error)
      if (allocated(error)) return
      call new_initial_gaps(initial, plain, points, log, error)
      if (allocated(error)) return
      self%n = points%n
      self%pair = points%pair(:self%n)
      self%node = points%node(:self%n)
      self%weight = points%weight(:self%n)
      self%size = points%size(:self%n)
      self%depth = points%depth(:self%n)
      self%side = points%side(:, :self%n)
      self%corner = points%corner(:, :self%n)
      self%share = points%share(:self%n)
      allocate (self%face(0))
      if (allocated(points%face)) self%face = points%face
      self%shift = initial%shift
      self%overclosure = initial%overclosure
      self%early = initial%early
      self%touches = initial%touches
      allocate (self%entry(self%n), source=1)
      do i = 2, self%n
         if (self%node(i) == self%node(i - 1) .and. self%pair(i) == self%pair(i - 1)) &
            & self%entry(i) = 2
      end do
      call cells_of_words(model%element_word, cells)
      do pair = 1, size(model%pair)
         if (.not. is_self_contact(model%pair(pair))) cycle
         call add_self(self, model, cells, pair, error)
         if (allocated(error)) return
      end do
      call find_moduli(self, model)
      allocate (self%growth(self%n))
   end subroutine new_nonlinear_points

   !> Surface to surface where bodies move far: not against itself.
   pure logical function stays_mortar(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair
      stays_mortar = is_mortar(model, pair) .and. .not. is_self_contact(pair)
   end function stays_mortar

   !> A surface against itself.
   elemental logical function is_self_contact(pair)
      type(pair_type), intent(in) :: pair
      is_self_contact = pair%slave == pair%master
   end function is_self_contact

   subroutine add_self(self, model, cells, pair, error)
      type(nonlinear_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: pair
      type(error_type), allocatable, intent(out) :: error
      type(slave_type) :: slave
      integer :: m

      call new_slave(slave, model, cells, model%surface(model%pair(pair)%slave), error)
      if (allocated(error)) return
      m = size(slave%node)
      self%pair = [self%pair, spread(pair, 1, m)]
      self%node = [self%node, slave%node]
      self%entry = [self%entry, spread(1, 1, m)]
      self%weight = [self%weight, slave%weight]
      self%size = [self%size, slave%size]
      self%depth = [self%depth, spread(huge(1.0_wp), 1, m)]
      self%side = reshape([self%side, slave%normal], [3, self%n + m])
      self%corner = reshape([self%corner, spread(0, 1, 2*m)], [2, self%n + m])
      self%share = [self%share, spread(0.0_wp, 1, m)]
      self%shift = [self%shift, spread(0.0_wp, 1, m)]
      self%overclosure = [self%overclosure, spread(0.0_wp, 1, m)]
      self%early = [self%early, spread(0.0_wp, 1, m)]
      self%touches = [self%touches, spread(.false., 1, m)]
      self%n = self%n + m
   end subroutine add_self

   !> The modulus at every point, the softer of the two sides, and the slave's yield stress.
   subroutine find_moduli(self, model)
      type(nonlinear_points_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp) :: own, other, typical
      integer :: i, pair
      real(wp) :: yield(model%mesh%nnode)
      real(wp), allocatable :: at_node(:)

      call nodal_moduli(model, at_node)
      typical = 1.0_wp
      if (any(at_node > 0.0_wp)) typical = minval(at_node, mask=at_node > 0.0_wp)
      allocate (self%modulus(self%n), self%slave_modulus(self%n), self%yield(self%n))
      do pair = 1, size(model%pair)
         call slave_yields(model, pair, yield)
         other = huge(1.0_wp)
         associate (master => model%surface(model%pair(pair)%master))
            if (master%kind == surface_of%faces .and. allocated(master%element)) &
               & call extreme_moduli(model, master%element, other, own)
         end associate
         do i = 1, self%n
            if (self%pair(i) /= pair) cycle
            own = at_node(self%node(i))
            if (.not. own > 0.0_wp) own = huge(1.0_wp)
            own = min(own, other)
            if (.not. own < huge(1.0_wp)) own = typical
            self%modulus(i) = own
            self%slave_modulus(i) = max(own, at_node(self%node(i)))
            self%yield(i) = yield(self%node(i))
         end do
      end do
   end subroutine find_moduli

   subroutine nodal_moduli(model, modulus)
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(out) :: modulus(:)
      integer :: e, k

      allocate (modulus(model%mesh%nnode), source=0.0_wp)
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         do k = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(k, e) == 0) exit
            modulus(model%mesh%conn(k, e)) = max(modulus(model%mesh%conn(k, e)), &
               & youngs_modulus(model, e))
         end do
      end do
   end subroutine nodal_moduli
end module lopin_nonlinear_points
